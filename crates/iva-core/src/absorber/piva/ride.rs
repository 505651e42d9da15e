//! The pendulum stuck on a wall: one mass 1 + μ on the primary's spring and damper,
//! (1 + μ) A + 2ζ ẋ + x = f/M with A = ẍ + a_g, until the pressure −s β cosθ A − r² d changes sign.
//!
//! The equation is linear, so the power series is its solution: with steps of [`LONGEST`] its truncation
//! error after [`ORDER`] terms is below 10⁻²¹ of it.

use super::integrals::{Integrands, square};
use super::{Parameters, Piva, PivaState};
use crate::absorber::impact::delay;
use crate::absorber::system::{Clock, Wall};
use crate::force::Drive;
use crate::host::oscillator::Primary;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Curve, GapPoint, Jet, Losses, Motion, Rows, Travel};
use crate::segment::taylor::{ORDER, Pendulum, Row, horner};

/// Longest step in units of 1/(fastest rate of oscillator and force).
const LONGEST: f64 = 0.75;

/// The stick episode from one state.
#[derive(Debug, Clone)]
pub struct PivaRide<'a, R = f64> {
    piva: &'a Piva<R>,
    from: PivaState<R>,
    drive: Drive<R>,
    /// Coefficients of x in powers of t over `step`.
    x: Row<R>,
    /// Coefficients of ẋ.
    u: Row<R>,
    /// Coefficients of the absolute acceleration A.
    a: Row<R>,
    step: R,
    reach: R,
    /// The instant at which the reach ends, if the force bends, jumps or has an impulse there.
    bend: Option<Clock<R>>,
}

impl<'a, R: Real> PivaRide<'a, R> {
    pub(super) fn new(piva: &'a Piva<R>, from: PivaState<R>) -> Self {
        let mass = R::ONE + piva.parameters.mass_ratio;
        let damping = piva.parameters.damping_ratio * 2.0;
        let half = damping * 0.5 / mass;
        let fastest = half + (half * half + R::ONE / mass).sqrt();
        let step = R::from(LONGEST) / fastest.max(piva.force.fastest());
        let drive = piva.force.drive(from.time, from.time, step);
        let (reach, bend) = piva.until_bend(&from, step);
        let row = [R::ZERO; ORDER + 1];
        let (mut x, mut u, mut a) = (row, row, row);
        (x[0], u[0]) = (from.primary.x.value, from.primary.v.value);
        let rest = -(damping * from.primary.v.rest + from.primary.x.rest);
        for k in 0..=ORDER {
            let rest = if k == 0 { rest } else { R::ZERO };
            a[k] = (drive.primary[k] - damping * u[k] - x[k] + rest) / mass;
            if k < ORDER {
                let over = step / (k + 1) as f64;
                u[k + 1] = over * (a[k] - drive.base[k]);
                x[k + 1] = over * u[k];
            }
        }
        Self { piva, from, drive, x, u, a, step, reach, bend }
    }

    fn share(&self, h: R) -> R {
        h / self.step
    }

    /// The factor β cosθ of A in the pressure on the wall.
    fn leverage(&self) -> R {
        self.piva.pendulum.coupling * self.piva.stops.cosine.value
    }

    /// The share r² d of gravity in the pressure; it pulls the pendulum off the wall.
    fn weight(&self) -> R {
        self.piva.pendulum.frequency_squared * self.piva.parameters.clearance
    }
}

impl<R: Real> Piva<R> {
    /// The primary at the release, where the wall stops pressing, from a state there apart from rounding; and
    /// the time from that state to the release.
    pub(super) fn without_pressure(&self, state: &PivaState<R>) -> (Primary<R>, R) {
        let Primary { x, v } = state.primary;
        let damping = self.parameters.damping_ratio * 2.0;
        let acceleration = self.release_acceleration(state.wall);
        let mass = DoubleDouble::new(R::ONE).plus(self.parameters.mass_ratio);
        let rest = DoubleDouble::new(self.driven(state.time)) - acceleration * mass;
        let balanced = |v: DoubleDouble<R>| rest - v.times(damping);
        // A force changes the pressure as well, and much faster than x does, so the correction of x says
        // nothing about the instant then.
        let left = if self.force.lasts() { R::ZERO } else { (x - balanced(v)).value };
        let rate = v.value + damping * acceleration.value;
        let later = delay(left, rate, acceleration.value);
        let v = v.plus(acceleration.value * later);
        (Primary { x: balanced(v), v }, later)
    }

    /// f/M at an instant.
    fn driven(&self, time: Clock<R>) -> R {
        self.force.drive::<1>(time, time, R::ONE).primary[0]
    }

    /// A at the release from a wall: Ẇ = 0 there, so β c A + r² y = 0.
    fn release_acceleration(&self, wall: Wall) -> DoubleDouble<R> {
        let Pendulum { coupling, frequency_squared, .. } = self.pendulum;
        let pull =
            DoubleDouble::new(frequency_squared * -wall.sign()).times(self.parameters.clearance);
        pull.over_sum(self.stops.cosine.times(coupling))
    }
}

impl<R: Real> Motion for PivaRide<'_, R> {
    type Real = R;
    type State = PivaState<R>;
    const RIDING: bool = true;

    fn origin(&self) -> &PivaState<R> {
        &self.from
    }

    fn reach(&self) -> R {
        self.reach
    }

    fn state(&self, h: R) -> PivaState<R> {
        let (t, from) = (self.share(h), &self.from);
        let increment = |row: &Row<R>| t * horner(&row[1..], t);
        PivaState {
            time: self.bend.filter(|_| h == self.reach).unwrap_or(from.time.plus(h)),
            primary: Primary {
                x: from.primary.x.plus(increment(&self.x)),
                v: from.primary.v.plus(increment(&self.u)),
            },
            ..*from
        }
    }

    fn primary(&self, h: R) -> Jet<R> {
        let state = self.state(h);
        let [_, curvature, jerk, _] = derivatives(&self.u, self.share(h), self.step);
        Jet { value: state.primary.x.value, rate: state.primary.v.value, curvature, jerk }
    }

    fn acceleration(&self, h: R) -> R {
        horner(&self.a, self.share(h))
    }

    fn gap(&self, _h: R) -> GapPoint<R> {
        GapPoint { y: self.from.clearance * self.from.wall.sign(), w: R::ZERO }
    }

    fn wall(&self) -> Option<Wall> {
        Some(self.from.wall)
    }

    fn rows(&self) -> Option<Rows<R>> {
        let Self { step, x, a: acceleration, drive: Drive { base, .. }, .. } = *self;
        Some(Rows { step, order: ORDER, x, acceleration, base })
    }

    fn travel(&self) -> Option<Travel<R>> {
        let mut gap = [R::ZERO; ORDER + 1];
        gap[0] = self.from.clearance * self.from.wall.sign();
        Some(Travel::new(self.rows()?, gap, self.piva.pendulum.lever))
    }

    fn square(&self, h: [R; 2]) -> R {
        square::<R, ORDER>(&self.x, h.map(|h| self.share(h)), self.step)
    }

    fn losses(&self, h: R) -> Losses<R> {
        let Self { piva, u, drive, .. } = self;
        let (still, base) = ([R::ZERO; ORDER + 1], piva.force.moves_base());
        let (y, w, drive) = (&still, &still, Some(drive));
        let integrands = Integrands { u, y, w, drive, pivots: false, base };
        integrands.taken::<ORDER>(&piva.pendulum, self.share(h), self.step)
    }
}

/// Value and first three derivatives of a polynomial in t over `step`.
fn derivatives<R: Real>(row: &Row<R>, t: R, step: R) -> [R; 4] {
    let mut factors = *row;
    let mut scale = R::ONE;
    std::array::from_fn(|order| {
        let count = ORDER + 1 - order;
        let value = horner(&factors[..count], t) / scale;
        for k in 1..count {
            factors[k - 1] = factors[k] * (k as f64);
        }
        scale *= step;
        value
    })
}

/// The curve of a stick episode: the pressure on the wall, which changes sign at the release.
impl<R: Real> Curve for PivaRide<'_, R> {
    type Real = R;
    type Sample = PivaState<R>;

    fn sample(&self, h: R) -> PivaState<R> {
        self.state(h)
    }

    fn jet(&self, sample: &PivaState<R>) -> Jet<R> {
        let t = self.share((sample.time - self.from.time).value);
        let factor = self.leverage() * -self.from.wall.sign();
        let [value, rate, curvature, jerk] = derivatives(&self.a, t, self.step);
        Jet {
            value: factor * value - self.weight(),
            rate: factor * rate,
            curvature: factor * curvature,
            jerk: factor * jerk,
        }
    }

    /// Plain evaluation suffices, because the magnitude is that of the terms.
    fn precise(&self, h: R) -> DoubleDouble<R> {
        DoubleDouble::new(self.jet(&self.state(h)).value)
    }

    /// The sum of the terms of A⁗, doubled to cover the truncated terms.
    fn fourth(&self) -> R {
        let sum = (4..=ORDER).rev().fold(R::ZERO, |sum, k| {
            let k_ = k as f64;
            sum + self.a[k].abs() * (k_ * (k_ - 1.0) * (k_ - 2.0) * (k_ - 3.0))
        });
        self.leverage() * 2.0 * sum / (self.step * self.step * self.step * self.step)
    }

    /// The magnitude of the terms of A, which may nearly cancel.
    fn magnitude(&self) -> R {
        let Parameters { mass_ratio, damping_ratio, .. } = self.piva.parameters;
        let size = |row: &Row<R>| row.iter().map(|coefficient| coefficient.abs()).sum::<R>();
        let terms = size(&self.drive.primary) + size(&self.x) + damping_ratio * 2.0 * size(&self.u);
        self.leverage() * terms / (R::ONE + mass_ratio) + self.weight()
    }
}
