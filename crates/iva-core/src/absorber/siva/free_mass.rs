//! A free mass in its gap, without the structure that it is on.

use super::Law;
use crate::absorber::restitution::RestitutionLaw;
use crate::absorber::{LawAt, Wall};
use crate::error::{Invalid, number};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// A start within this distance of a wall, over the clearance, counts as on the wall: it is given in doubles, whatever the numbers of the run.
pub(crate) const ON_WALL: f64 = 4.0 * f64::EPSILON;

/// A free mass between two walls: checked parameters in natural units, and constants derived from them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeMass<R = f64> {
    pub(crate) mass_ratio: R,
    pub(crate) clearance: R,
    /// The middle of the gap, as a value of y.
    pub(crate) offset: R,
    /// The only wall, if there is one only.
    pub(crate) only: Option<Wall>,
    /// The impact laws at wall + and at wall −.
    pub(crate) laws: [Law<R>; 2],
    /// The laws by which e depends on the approach speed there; `None` if e is constant at both walls. Then `laws` are those of
    /// speed 0.
    varying: Option<[RestitutionLaw<R>; 2]>,
}

impl<R: Real> FreeMass<R> {
    /// Mass ratio μ > 0, restitution e in [0, 1] and one-sided clearance d > 0, within the bounds of [`crate::range`].
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn new(mass_ratio: R, restitution: R, clearance: R) -> Result<Self, Invalid> {
        range::mass_ratio("absorber.mass_ratio", mass_ratio)?;
        range::positive("absorber.clearance", clearance)?;
        range::restitution("absorber.restitution", restitution)?;
        Ok(Self::checked(mass_ratio, restitution, clearance))
    }

    /// A stop on the ground, which has no mass: its walls are met by the point of a structure ([`crate::absorber::modal`]).
    ///
    /// # Errors
    /// As [`FreeMass::new`].
    pub fn on_ground(restitution: R, clearance: R) -> Result<Self, Invalid> {
        let like = Self::new(R::ONE, restitution, clearance)?;
        Ok(Self { mass_ratio: R::ZERO, laws: [Law::new(R::ZERO, restitution); 2], ..like })
    }

    /// [`FreeMass::new`] from checked parameters.
    pub(super) fn checked(mass_ratio: R, restitution: R, clearance: R) -> Self {
        let laws = [Law::new(mass_ratio, restitution); 2];
        Self { mass_ratio, clearance, offset: R::ZERO, only: None, laws, varying: None }
    }

    /// The same mass with another restitution at the wall −.
    ///
    /// # Errors
    /// [`Invalid`] for one outside [0, 1].
    pub fn with_restitution_minus(mut self, restitution: R) -> Result<Self, Invalid> {
        range::restitution("absorber.restitution_minus", restitution)?;
        self.laws[1] = Law::new(self.mass_ratio, restitution);
        if let Some([plus, _]) = self.varying {
            return Ok(self.with_restitution_laws([plus, RestitutionLaw::constant(restitution)?]));
        }
        Ok(self)
    }

    /// The same mass with a restitution that depends on the approach speed, at wall + and at wall −.
    pub fn with_restitution_laws(self, laws: [RestitutionLaw<R>; 2]) -> Self {
        let at_rest = laws.map(|law| Law::new(self.mass_ratio, law.restitution(R::ZERO)));
        let constant = laws.iter().all(RestitutionLaw::is_constant);
        Self { laws: at_rest, varying: (!constant).then_some(laws), ..self }
    }

    /// The same mass in a gap whose middle is at y = `offset`.
    ///
    /// # Errors
    /// [`Invalid`] for an offset out of [`crate::range`].
    pub fn with_offset(self, offset: R) -> Result<Self, Invalid> {
        range::size("absorber.gap_offset", offset)?;
        Ok(Self { offset, ..self })
    }

    /// The same mass with this wall only: on the other side nothing limits its way.
    pub fn with_only(self, wall: Wall) -> Self {
        Self { only: Some(wall), ..self }
    }

    /// Half of the way from wall to wall: d, or ∞ with one wall only.
    #[inline(always)]
    pub(crate) fn half_play(&self) -> R {
        if self.only.is_none() { self.clearance } else { R::INFINITY }
    }

    /// Between which values of y it moves.
    pub(crate) fn walls(&self) -> [R; 2] {
        let [low, high] = [self.offset - self.clearance, self.offset + self.clearance];
        match self.only {
            None => [low, high],
            Some(Wall::Plus) => [-R::INFINITY, high],
            Some(Wall::Minus) => [low, R::INFINITY],
        }
    }

    /// The size of a distance that is measured from a wall.
    #[inline(always)]
    pub(crate) fn size_at(&self, distance: R) -> R {
        if self.only.is_none() { self.clearance } else { self.clearance + distance.abs() }
    }

    /// Mass ratio μ.
    pub fn mass_ratio(&self) -> R {
        self.mass_ratio
    }

    /// The middle of the gap, as a value of y.
    pub fn offset(&self) -> R {
        self.offset
    }

    /// One-sided clearance d.
    pub fn clearance(&self) -> R {
        self.clearance
    }

    /// The impact law at the wall with this sign.
    #[inline(always)]
    pub(crate) fn law(&self, side: R) -> &Law<R> {
        let [plus, minus] = &self.laws;
        if side > 0.0 { plus } else { minus }
    }

    /// True if e depends on the approach speed at a wall.
    #[inline(always)]
    pub(crate) fn varies(&self) -> bool {
        self.varying.is_some()
    }

    /// The law by which e depends on the approach speed at the wall with this sign; `None` if it does not at any wall.
    #[inline(always)]
    fn varying(&self, side: R) -> Option<&RestitutionLaw<R>> {
        let [plus, minus] = self.varying.as_ref()?;
        Some(if side > 0.0 { plus } else { minus })
    }

    /// The impact law at the wall with this sign, for an approach speed.
    #[inline(always)]
    pub(crate) fn law_for(&self, side: R, approach: R) -> Law<R> {
        match self.varying(side) {
            None => *self.law(side),
            Some(law) => Law::new(self.mass_ratio, law.restitution(approach)),
        }
    }

    /// [`crate::absorber::ImpactLaw::law_of`] this mass alone on a structure of a damping ratio.
    pub(crate) fn law_at(&self, wall: Wall, approach: R, damping_ratio: R) -> LawAt<R> {
        let side = R::from(wall.sign());
        if let Some(law) = self.varying(side) {
            return law.of_free_mass(self.mass_ratio, approach, damping_ratio);
        }
        let Law { restitution, share, .. } = *self.law(side);
        let pressure = damping_ratio * 2.0 * share.value;
        LawAt::constant(restitution, restitution, share.value, pressure)
    }

    /// The sign of the wall that the distance of a start is measured from, and the distance: of the wall that the mass is
    /// nearest to or moves towards, so that a mirrored start gives the same numbers with opposite signs. Where place
    /// and velocity do not tell, the first of `leaning` that is not 0 decides.
    pub(crate) fn begun(
        &self,
        (y, w): (DoubleDouble<R>, R),
        leaning: impl IntoIterator<Item = R>,
    ) -> (R, DoubleDouble<R>) {
        let place = y.plus(-self.offset);
        let seen = [place.value, w].into_iter().chain(leaning).find(|value| *value != 0.0);
        let nearest = if seen.unwrap_or(R::ONE) > 0.0 { R::ONE } else { -R::ONE };
        let s = self.only.map_or(nearest, |wall| R::from(wall.sign()));
        let distance =
            DoubleDouble::new(self.clearance).plus_parts(-s * place.value, -s * place.rest);
        let size = self.clearance + self.offset.abs();
        let touching = distance.value <= size * ON_WALL;
        (s, if touching { DoubleDouble::ZERO } else { distance })
    }
}

/// Checks that a gap displacement lies between these walls, of which one may be at ∞; rounding is that of a number of this size.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub(crate) fn check_place<R: Real>(
    field: &str,
    y: R,
    [low, high]: [R; 2],
    size: R,
) -> Result<(), Invalid> {
    if (low - y).max(y - high) > size * ON_WALL {
        let rule = match [low, high].map(|wall| wall.is_finite().then(|| number(wall))) {
            [Some(low), Some(high)] => format!("it must lie in the gap, from {low} to {high}"),
            [Some(low), None] => format!("it must lie before its stop, at {low} or above"),
            [_, high] => {
                format!("it must lie before its stop, at {} or below", high.unwrap_or_default())
            }
        };
        return Err(Invalid::new(field, number(y), rule));
    }
    Ok(())
}
