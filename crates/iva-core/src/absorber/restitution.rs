//! Laws by which the restitution e depends on the approach speed u of an impact.
//!
//! Speeds are in natural units, ωn × length. Each law gives e in [0, 1], so that no impact gains energy.
//!
//! | law | e | at low speeds |
//! |---|---|---|
//! | [`constant`](RestitutionLaw::constant) | e | e |
//! | [`power`](RestitutionLaw::power) | 1 − a uᵇ, at least 0 | → 1: a chatter ends in stick if b < 1, after infinitely many impacts |
//! | [`plastic`](RestitutionLaw::plastic) | falls from the yield speed on | 1: no chatter ends |
//! | [`table`](RestitutionLaw::table) | linear between points | that of the first point |
//!
//! Where e comes up to 1 as the speed falls, low rebounds are many. No chatter of a plastic law or of 1 − a uᵇ with b ≥ 1 ends
//! as long as the wall presses, and one of b < 1 is computed one by one until the proved sum of the rest takes over, some
//! 10⁻⁹ of its end in time in doubles. That takes of the order of 10³ rebounds at b = 1/5, 10⁴ to 10⁵ at b = 1/3 and more
//! than a run may have at b ≥ 1/2. A run that has more ends with its outcome, `impact_limit` or `work_limit`.

use crate::absorber::impact_law::LawAt;
use crate::error::{Invalid, number};
use crate::number::real::Real;
use crate::number::root::{power, root};
use crate::range;

/// Largest number of points of a table.
pub const MOST_POINTS: usize = 16;
/// Largest numerator and denominator of an exponent.
pub const LARGEST_PART: u32 = 8;

/// A law by which the restitution depends on the approach speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestitutionLaw<R = f64>(Kind<R>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind<R> {
    Constant(R),
    Power {
        coefficient: R,
        /// b as numerator and denominator.
        exponent: [u32; 2],
    },
    Plastic {
        yield_speed: R,
    },
    /// The points (speed, e) in order of speed, and their number.
    Table {
        points: [[R; 2]; MOST_POINTS],
        count: usize,
    },
}

/// A law at one approach speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AtSpeed<R> {
    /// e.
    pub restitution: R,
    /// u de/du.
    pub steepness: R,
    /// A bound on how far e is from this value at any lower speed; ∞ where e comes up to 1 and no power is known.
    pub spread: R,
    /// b < 1 of a law 1 − a uᵇ that holds at all lower speeds.
    pub power: Option<R>,
}

impl<R: Real> RestitutionLaw<R> {
    /// Newton's law: the same e at every speed.
    ///
    /// # Errors
    /// [`Invalid`] for e outside [0, 1].
    pub fn constant(restitution: R) -> Result<Self, Invalid> {
        range::restitution("absorber.restitution", restitution)?;
        Ok(Self(Kind::Constant(restitution)))
    }

    /// e = 1 − a uᵇ with b = p/q, and 0 from the speed a^(−1/b) on, where the formula would become negative.
    ///
    /// b = 1/5 is the law of viscoelastic spheres at low speeds (G. Kuwabara and K. Kono, Jpn. J. Appl. Phys. 26, 1230,
    /// 1987; N. V. Brilliantov, F. Spahn, J.-M. Hertzsch, T. Pöschel, Phys. Rev. E 53, 5382, 1996): the first term of
    /// their series, so that it is meant for speeds at which a uᵇ is small. Between 0 and its end the speed of the rebound
    /// falls with the approach speed from a uᵇ = 1/(1 + b) on. The unit of a is (ωn × length)^(−b).
    ///
    /// # Errors
    /// [`Invalid`] for a outside [`crate::range`], and unless p and q are whole numbers from 1 to [`LARGEST_PART`].
    pub fn power(coefficient: R, exponent: [u32; 2]) -> Result<Self, Invalid> {
        range::positive("absorber.restitution.coefficient", coefficient)?;
        let [p, q] = exponent;
        if exponent.iter().any(|part| !(1..=LARGEST_PART).contains(part)) {
            let rule = format!("give a quotient of whole numbers from 1 to {LARGEST_PART}");
            let field = "absorber.restitution.exponent";
            return Err(Invalid::new(field, format!("{p}/{q}"), rule));
        }
        Ok(Self(Kind::Power { coefficient, exponent }))
    }

    /// [`power`](RestitutionLaw::power) with the a for which a restitution is met at an approach speed.
    ///
    /// # Errors
    /// As [`power`](RestitutionLaw::power), and for e outside [0, 1].
    pub fn through(restitution: R, speed: R, exponent: [u32; 2]) -> Result<Self, Invalid> {
        range::restitution("absorber.restitution", restitution)?;
        range::positive("absorber.reference_speed", speed)?;
        if restitution == 1.0 {
            return Self::constant(restitution);
        }
        let [p, q] = exponent.map(|part| part.clamp(1, LARGEST_PART));
        Self::power((R::ONE - restitution) / power(root(speed, q), p), exponent)
    }

    /// Elastic up to the speed at which a sphere begins to yield, then the law of elastic and perfectly plastic spheres
    /// (C. Thornton, J. Appl. Mech. 64, 383, 1997): with q the yield speed over u,
    ///
    /// ```text
    /// e = (6√3/5)^½ (1 − q²/6)^½ (q/(q + 2 √(6/5 − q²/5)))^¼,
    /// ```
    ///
    /// which is 1 at the yield speed, with slope 0, and 1.18 q^¼ at high speeds: the fourth root of K. L. Johnson (Contact
    /// Mechanics, 1985, section 11.5). Rebounds of faster impacts are never slower than the yield speed, so that no chatter
    /// ends.
    ///
    /// # Errors
    /// [`Invalid`] for a yield speed outside [`crate::range`].
    pub fn plastic(yield_speed: R) -> Result<Self, Invalid> {
        range::positive("absorber.restitution.yield_speed", yield_speed)?;
        Ok(Self(Kind::Plastic { yield_speed }))
    }

    /// A table of points (speed, e), as measured: linear between them, and constant below the first and above the last.
    /// At a point the derivative is that of the side of higher speeds.
    ///
    /// # Errors
    /// [`Invalid`] for no point or more than [`MOST_POINTS`], for a speed that is negative, out of [`crate::range`] or not
    /// above the one before it, and for e outside [0, 1].
    pub fn table(given: &[[R; 2]]) -> Result<Self, Invalid> {
        let field = "absorber.restitution.points";
        let count = given.len();
        if !(1..=MOST_POINTS).contains(&count) {
            let rule = format!("give 1 to {MOST_POINTS} points (speed, restitution)");
            return Err(Invalid::new(field, format!("{count} points"), rule));
        }
        let mut before: Option<R> = None;
        for (index, [speed, restitution]) in given.iter().enumerate() {
            let of = |what: &str| format!("{field}[{index}].{what}");
            range::size(&of("speed"), *speed)?;
            range::restitution(&of("restitution"), *restitution)?;
            if *speed < 0.0 {
                let rule = "give a speed of 0 or more".to_owned();
                return Err(Invalid::new(of("speed"), number(*speed), rule));
            }
            if let Some(before) = before.filter(|before| speed <= before) {
                let rule =
                    format!("give a speed above {}, that of the point before", number(before));
                return Err(Invalid::new(of("speed"), number(*speed), rule));
            }
            before = Some(*speed);
        }
        let [_, first] = given[0];
        if given.iter().all(|[_, restitution]| *restitution == first) {
            return Ok(Self(Kind::Constant(first)));
        }
        let mut points = [[R::ZERO; 2]; MOST_POINTS];
        points[..count].copy_from_slice(given);
        Ok(Self(Kind::Table { points, count }))
    }

    /// e at an approach speed.
    pub fn restitution(&self, speed: R) -> R {
        self.at(speed).restitution
    }

    /// True if e is the same at every speed.
    pub fn is_constant(&self) -> bool {
        matches!(self.0, Kind::Constant(_))
    }

    /// The law at an approach speed.
    pub(crate) fn at(&self, speed: R) -> AtSpeed<R> {
        match &self.0 {
            Kind::Constant(restitution) => AtSpeed {
                restitution: *restitution,
                steepness: R::ZERO,
                spread: R::ZERO,
                power: None,
            },
            Kind::Power { coefficient, exponent } => falling(*coefficient, *exponent, speed),
            Kind::Plastic { yield_speed } => yielding(*yield_speed, speed),
            Kind::Table { points, count } => interpolated(&points[..*count], speed),
        }
    }

    /// The law of a free mass of mass ratio μ on a structure of damping ratio ζ, at an approach speed.
    pub(crate) fn of_free_mass(&self, mass_ratio: R, speed: R, damping_ratio: R) -> LawAt<R> {
        let AtSpeed { restitution, steepness, spread, power } = self.at(speed);
        let law = [restitution, R::ZERO, spread];
        let law = LawAt::of_free_mass(mass_ratio, law, speed, damping_ratio);
        LawAt { slope: restitution + steepness, power, ..law }
    }
}

/// 1 − a uᵇ, at least 0.
fn falling<R: Real>(coefficient: R, [p, q]: [u32; 2], speed: R) -> AtSpeed<R> {
    let exponent = R::from(f64::from(p)) / f64::from(q);
    let fall = coefficient * power(root(speed, q), p);
    let [restitution, steepness, spread] = if fall >= 1.0 {
        [R::ZERO, R::ZERO, R::ONE]
    } else {
        [R::ONE - fall, -(exponent * fall), fall]
    };
    if p < q {
        AtSpeed { restitution, steepness, spread, power: Some(exponent) }
    } else {
        AtSpeed { restitution, steepness, spread: R::INFINITY, power: None }
    }
}

/// The law of elastic and perfectly plastic spheres.
fn yielding<R: Real>(yield_speed: R, speed: R) -> AtSpeed<R> {
    let elastic =
        AtSpeed { restitution: R::ONE, steepness: R::ZERO, spread: R::INFINITY, power: None };
    if speed <= yield_speed {
        return elastic;
    }
    let q = yield_speed / speed;
    let square = q * q / 6.0;
    let s = ((R::from(6.0) - q * q) / 5.0).sqrt();
    let stored = q + s * 2.0;
    let restitution =
        (R::from(3.0).sqrt() * 6.0 / 5.0 * (R::ONE - square)).sqrt() * (q / stored).sqrt().sqrt();
    // −q d(ln e)/dq.
    let slope = square / (R::ONE - square) - (R::ONE - q * (R::ONE - q * 0.4 / s) / stored) * 0.25;
    // Next to the yield speed rounding may exceed 1.
    let restitution = restitution.min(R::ONE);
    AtSpeed { restitution, steepness: restitution * slope, ..elastic }
}

/// Linear between points, constant outside.
fn interpolated<R: Real>(points: &[[R; 2]], speed: R) -> AtSpeed<R> {
    let below = points.partition_point(|[at, _]| *at <= speed);
    let (lower, upper) = points.split_at(below);
    let (restitution, steepness) = match (lower.last(), upper.first()) {
        (Some([u, e]), Some([v, f])) => {
            let rate = (*f - *e) / (*v - *u);
            // Between the two, whatever is rounded.
            let [low, high] = if e < f { [*e, *f] } else { [*f, *e] };
            ((*e + rate * (speed - *u)).max(low).min(high), rate * speed)
        }
        (Some([_, e]), None) | (None, Some([_, e])) => (*e, R::ZERO),
        (None, None) => (R::NAN, R::ZERO),
    };
    // The first point tells e at all speeds below it.
    let at_lower = points.iter().take(below.max(1)).map(|[_, e]| *e);
    let spread = at_lower.fold(R::ZERO, |spread, e| {
        if e >= 1.0 { R::INFINITY } else { spread.max((e - restitution).abs()) }
    });
    let spread = if restitution >= 1.0 { R::INFINITY } else { spread };
    AtSpeed { restitution, steepness, spread, power: None }
}
