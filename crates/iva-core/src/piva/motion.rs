//! The flight of a pendulum absorber: swinging in its gap.

use super::accuracy::share_kept;
use super::{Piva, PivaState, at_rest_on_release};
use crate::compensated::Sum;
use crate::flight::{Curve, GapPoint, Jet, Motion, Rows};
use crate::force::Drive;
use crate::oscillator::Primary;
use crate::polynomial::{horners, product_integral, square_integral};
use crate::real::{ONE, Real, STRIDES, ZERO, dispatched, power_of_two};
use crate::roots::DOUBT;
use crate::system::{Clock, Wall};
use crate::taylor::{ORDER, Pendulum, Remainder, Row, Series, Swing, horner};

/// Beyond this |sinθ| the cosine is taken from its own series: √(1 − sin²θ) loses digits there.
const STEEP: f64 = 0.7;

/// The pendulum free in its gap.
#[derive(Debug, Clone)]
pub struct PivaFlight<'a> {
    piva: &'a Piva,
    from: PivaState,
    /// In powers of t over `step`.
    series: Series<Real>,
    drive: Option<Drive<Real>>,
    step: Real,
    reach: Real,
    /// Where the reach ends because the force bends, jumps or kicks there.
    bend: Option<Clock>,
    /// What the series leaves out; `None` where nothing could be proved.
    remainder: Option<Remainder>,
}

impl<'a> PivaFlight<'a> {
    pub(crate) fn new(piva: &'a Piva, from: PivaState) -> Self {
        let order = piva.accuracy.order;
        let longest = piva.longest_step(&from);
        // A power of two: h/step is exact then, and the terms of the series belong to one instant.
        let step = power_of_two(longest);
        let most = longest / step;
        let drive = piva.drive(from.time, &from, step);
        let series = piva.pendulum.series(&piva.swing(&from), drive.as_ref(), step, order);
        let series = at_rest_on_release(&from, series);
        let size = drive.as_ref().map_or(ZERO, Drive::size);
        let share = Remainder::prove(&piva.pendulum, &series, &piva.force, step, order).and_then(
            |remainder| Some((share_kept(&remainder, most, piva, &from, size)?, remainder)),
        );
        let Some((share, remainder)) = share else {
            // What cannot be enclosed is not flown: the run ends there and says so.
            return Self {
                piva,
                from,
                series,
                drive,
                step,
                reach: step,
                bend: None,
                remainder: None,
            };
        };
        let (reach, bend) = piva.until_bend(&from, share * step);
        Self { piva, from, series, drive, step, reach, bend, remainder: Some(remainder) }
    }

    /// h in steps.
    fn share(&self, h: Real) -> Real {
        h / self.step
    }

    /// The state at h, with its angle from the distance; `own`: the cosine from its own series.
    #[inline(always)]
    fn reached(&self, h: Real, primary: Primary, distance: Sum, w: Sum, own: Real) -> PivaState {
        let from = &self.from;
        let y = PivaState { distance, ..*from }.y().value;
        let sine = y / self.piva.parameters.contact_distance;
        let gentle = sine.abs() < STEEP;
        let cosine = if gentle { self.piva.pendulum.cosine(y).copysign(own) } else { own };
        PivaState {
            time: self.bend.filter(|_| h == self.reach).unwrap_or(from.time.plus(h)),
            primary,
            distance,
            w,
            cosine,
            released: false,
            ..*from
        }
    }

    /// The state at h.
    #[inline(always)]
    fn evaluated(&self, h: Real) -> PivaState {
        if h == 0.0 {
            return self.from;
        }
        let (t, from, series) = (self.share(h), &self.from, &self.series);
        let rows = [&series.x, &series.u, &series.y, &series.w, &series.c];
        let [x, u, y, w, c] =
            horners(rows.map(|row| &row[1..=self.piva.accuracy.order]), t).map(|beyond| t * beyond);
        let primary = Primary { x: from.primary.x.plus(x), v: from.primary.v.plus(u) };
        let distance = from.distance.plus(-from.wall.sign() * y);
        self.reached(h, primary, distance, from.w.plus(w), series.c[0] + c)
    }

    /// The same, the linear terms to twice the precision, which leaves the rounding of those from h² on.
    #[inline(always)]
    fn arrived(&self, h: Real) -> PivaState {
        if h == 0.0 {
            return self.from;
        }
        let (t, from, series) = (self.share(h), &self.from, &self.series);
        let sine = from.y().over(self.piva.parameters.contact_distance);
        // Where the angle is steep the carried cosine knows it better than y does.
        let steep = self.piva.pendulum.small_angles || sine.value.abs() >= STEEP;
        let cosine = if steep { Sum::new(from.cosine) } else { precise_cosine(sine, from.cosine) };
        let start =
            Swing { x: from.primary.x, u: from.primary.v, y: from.y(), w: from.w, c: cosine };
        let force = &self.piva.force;
        let drive = force.lasts().then(|| force.precise(from.time, ONE));
        let first: Series<Sum, 2> = self.piva.pendulum.beginning(&start, drive.as_ref());
        let rows = [&series.x, &series.u, &series.y, &series.w, &series.c];
        let [x, u, y, w, c] = horners(rows.map(|row| &row[2..=self.piva.accuracy.order]), t);
        let increment = |first: Sum, beyond: Real| first.times(h).plus(t * t * beyond);
        let pull = if from.released { Sum::ZERO } else { first.w[1] };
        let primary = Primary {
            x: from.primary.x + increment(first.x[1], x),
            v: from.primary.v + increment(first.u[1], u),
        };
        let travelled = increment(first.y[1], y);
        let distance = match from.wall {
            Wall::Plus => from.distance - travelled,
            Wall::Minus => from.distance + travelled,
        };
        let own = series.c[0] + t * (series.c[1] + t * c);
        self.reached(h, primary, distance, from.w + increment(pull, w), own)
    }

    /// The series to twice the precision, from an angle with this cosine.
    fn precise_series<const LENGTH: usize>(
        &self,
        cosine: Sum,
        h: Real,
        order: usize,
    ) -> Series<Sum, LENGTH> {
        let from = &self.from;
        let start =
            Swing { x: from.primary.x, u: from.primary.v, y: from.y(), w: from.w, c: cosine };
        let force = &self.piva.force;
        let drive = force.lasts().then(|| force.precise(from.time, h));
        self.piva.pendulum.series(&start, drive.as_ref(), h, order)
    }

    /// What a damper takes: factor · ∫ f² up to h.
    fn loss(&self, factor: Real, f: &Row<Real>, h: Real) -> Real {
        let f = &f[..=self.piva.accuracy.order];
        if factor == 0.0 {
            return ZERO;
        }
        let t = self.share(h);
        let integral = dispatched(
            #[inline(always)]
            || square_integral(f, t),
        );
        factor * integral * self.step
    }
}

/// Bound on t² |y″| of the series itself over a share t of a step.
#[inline(always)]
fn bend(y: &Row<Real>, t: Real) -> Real {
    let mut sum = ZERO;
    for k in (2..=ORDER).rev() {
        sum = sum.mul_add(t, (k * (k - 1)) as f64 * y[k].abs());
    }
    sum * (t * t)
}

/// Bound on |y⁗| of the series itself over a share of a step, in steps.
fn fourth_bound(y: &Row<Real>, share: Real) -> Real {
    (4..=ORDER).rev().fold(ZERO, |sum, k| {
        let k_ = k as f64;
        sum * share + k_ * (k_ - 1.0) * (k_ - 2.0) * (k_ - 3.0) * y[k].abs()
    })
}

impl Piva {
    /// How far a motion goes that reaches so far: not beyond the next bend of the force, and then the
    /// instant of that.
    pub(crate) fn until_bend(&self, from: &PivaState, reach: Real) -> (Real, Option<Clock>) {
        let bend = self.force.smooth_until(from.time, from.kicks);
        let until = |bend: Clock| (bend - from.time).value;
        match bend.filter(|bend| until(*bend) <= reach) {
            Some(bend) => (until(bend), Some(bend)),
            None => (reach, None),
        }
    }

    /// A step short against every time scale: of the primary, of the pendulum, of its swing.
    fn longest_step(&self, state: &PivaState) -> Real {
        let pendulum = &self.pendulum;
        let zeta = pendulum.damping_ratio;
        let primary = zeta + (1.0 + zeta * zeta).sqrt();
        let hanging = (pendulum.frequency_squared * (1.0 + pendulum.mass_ratio)).sqrt();
        let swing = if pendulum.small_angles {
            ZERO
        } else {
            state.w.value.abs() / pendulum.contact_distance
        };
        self.accuracy.longest_step
            / primary.max(hanging).max(swing).max(pendulum.pivot_damping).max(self.force.fastest())
    }
}

impl Motion for PivaFlight<'_> {
    type State = PivaState;
    const RIDING: bool = false;

    fn origin(&self) -> &PivaState {
        &self.from
    }

    fn reach(&self) -> Real {
        self.reach
    }

    fn state(&self, h: Real) -> PivaState {
        dispatched(
            #[inline(always)]
            || self.evaluated(h),
        )
    }

    fn arrival(&self, h: Real) -> PivaState {
        dispatched(
            #[inline(always)]
            || self.arrived(h),
        )
    }

    /// Both ends of y and a bound on its second derivative enclose it.
    fn glide(&self, length: Real) -> Option<PivaState> {
        if !STRIDES || self.remainder.is_none() {
            return None;
        }
        let (end, bend) = dispatched(
            #[inline(always)]
            || (self.arrived(length), bend(&self.series.y, self.share(length))),
        );
        let d = self.from.clearance;
        let doubt = self.piva.accuracy.tolerance + DOUBT * (0.5 * Real::EPSILON);
        let slack = 0.125 * bend + doubt * d;
        // Compared one by one: what is not a number is not clear.
        let clear = |at: Real| at > slack && at < 2.0 * d - slack;
        (clear(self.from.distance.value) && clear(end.distance.value)).then_some(end)
    }

    fn primary(&self, h: Real) -> Jet {
        let state = self.state(h);
        let series = self.piva.beginning::<3>(self.from.time, &state);
        Jet {
            value: state.primary.x.value,
            rate: state.primary.v.value,
            curvature: series.u[1],
            jerk: 2.0 * series.u[2],
        }
    }

    fn gap(&self, h: Real) -> GapPoint {
        let state = self.state(h);
        let d = state.clearance;
        GapPoint { y: state.y().value.clamp(-d, d), w: state.gap_velocity() }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn rows(&self) -> Option<Rows<'_>> {
        let order = self.piva.accuracy.order;
        let base = self.drive.as_ref().map_or(&[][..], |drive| &drive.base[..=order]);
        let (x, a) = (&self.series.x[..=order], &self.series.a[..order]);
        Some(Rows { step: self.step, x, acceleration: a, base })
    }

    fn work(&self, h: Real) -> Real {
        self.drive.as_ref().map_or(ZERO, |drive| {
            work(self.piva, drive, &self.series.u, &self.series.y, self.share(h), self.step)
        })
    }

    fn viscous_loss(&self, h: Real) -> Real {
        self.loss(2.0 * self.piva.pendulum.damping_ratio, &self.series.u, h)
    }

    fn pivot_loss(&self, h: Real) -> Real {
        let Pendulum { mass_ratio, lever, pivot_damping, .. } = self.piva.pendulum;
        let inertia = mass_ratio * self.piva.parameters.inertia_ratio * (lever * lever);
        self.loss(inertia * pivot_damping, &self.series.w, h)
    }
}

/// Work of force and base over a share t of a step: ∫ (f/M) ẋ − a_g ((1 + μ) ẋ + μλ ẏ) dt, the
/// momentum of all masses along x behind a_g.
pub(crate) fn work(
    piva: &Piva,
    drive: &Drive<Real>,
    u: &Row<Real>,
    y: &Row<Real>,
    t: Real,
    step: Real,
) -> Real {
    let order = piva.accuracy.order;
    let mass = 1.0 + piva.parameters.mass_ratio;
    let pull = piva.parameters.mass_ratio * piva.pendulum.lever;
    // ẏ in powers of t/step, one order less.
    let rate = |k: usize| if k < order { (k + 1) as f64 * y[k + 1] / step } else { ZERO };
    let momentum: Row<Real> =
        std::array::from_fn(|k| if k <= order { mass * u[k] + pull * rate(k) } else { ZERO });
    let on_primary = product_integral(&drive.primary[..=order], &u[..=order], t);
    let on_base = product_integral(&drive.base[..=order], &momentum[..=order], t);
    (on_primary - on_base) * step
}

impl Curve for PivaFlight<'_> {
    type Sample = PivaState;

    fn sample(&self, h: Real) -> PivaState {
        self.state(h)
    }

    fn jet(&self, sample: &PivaState) -> Jet {
        self.piva.jet(self.from.time, sample)
    }

    fn precise(&self, h: Real) -> Sum {
        let from = &self.from;
        let order = self.piva.accuracy.order;
        let cosine = if self.piva.pendulum.small_angles {
            Sum::new(ONE)
        } else {
            precise_cosine(from.y().over(self.piva.parameters.contact_distance), from.cosine)
        };
        let mut series: Series<Sum> = self.precise_series(cosine, self.step, order);
        if from.released {
            (series.w[1], series.y[2]) = (Sum::ZERO, Sum::ZERO);
        }
        let t = Sum::new(h).over(self.step);
        let travelled = horner(&series.y[1..=order], t).times_sum(t);
        let s = from.wall.sign();
        from.distance.plus_parts(-s * travelled.value, -s * travelled.rest)
    }

    fn fourth(&self) -> Real {
        let share = self.share(self.reach);
        self.remainder.map_or(Real::NAN, |remainder| {
            let fourth = fourth_bound(&self.series.y, share) + remainder.fourth(share);
            fourth / (self.step * self.step * self.step * self.step)
        })
    }

    fn magnitude(&self) -> Real {
        self.from.clearance
    }
}

/// cosθ to twice the precision from sinθ and its double, by one step of Newton's method.
#[inline(always)]
fn precise_cosine(sine: Sum, cosine: Real) -> Sum {
    if cosine == 0.0 {
        return Sum::ZERO;
    }
    let c = Sum::new(cosine);
    let square = Sum::new(ONE) - sine * sine;
    c + (square - c * c) / c.times(2.0)
}
