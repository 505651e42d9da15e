//! How errors grow along a run: an estimate of the error of every impact time.
//!
//! A small error of the state z = (x, ẋ, y, ẏ) (with W = b θ̇ in place of ẏ for a pendulum) is multiplied by
//! the derivative of the motion: of the flow along a segment, and of an impact by the saltation matrix
//!
//! ```text
//! S = J + (f⁺ − J f⁻) nᵀ/(nᵀ f⁻)
//! ```
//!
//! with J the derivative of the velocity jump, f the rates before and after, n the gradient of the gap (P. C.
//! Müller, Chaos, Solitons & Fractals 5 (1995) 1671–1681). The rounding and truncation errors of each segment
//! are treated as independent random errors: their covariance P changes over a segment to Φ P Φᵀ + Q. A
//! summed chatter conserves momentum and centre of mass, a release is smooth.
//!
//! Rounding errors are not independent where a wall is hit again and again: a chatter uses the same rounded
//! constants at every rebound. Such correlated errors are columns that add up, and join the covariance when
//! the other wall is met.
//!
//! The error of an impact time is the error of the distance over the approach speed. Close to a grazing it is
//! the largest change of the instant that the curvature allows. Once the error reaches 1/ωn the run has
//! forgotten its start, and nothing is estimated from there on.

use nalgebra::{Matrix4, Vector4};

use crate::flight::Motion;
use crate::impact::Impact;
use crate::observe::{Jump, Observer, Span};
use crate::simulate::Instant;
use crate::system::{System, Wall};

mod piva;
mod siva;
mod structure;

/// A system whose motion can be differentiated.
pub trait Differentiable: System<Real = f64> {
    /// The rates ż in free flight.
    fn rates(&self, state: &Self::State) -> Vector4<f64>;
    /// Sizes of the terms of ẋ, ẍ, ẏ and ÿ (or Ẇ) before they cancel: the rounding errors that are the same
    /// at every rebound are proportional to these. 0: the rates are computed in double-double.
    fn sizes(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// Derivative of the state after a flight of length h with respect to the state before it.
    fn flight_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// Derivative of the state after a time h stuck on a wall, where y and ẏ do not change, with respect to
    /// that before it.
    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// Derivative of the velocity jump of an impact on a wall.
    fn impact_matrix(&self, wall: Wall) -> Matrix4<f64>;
    /// Derivative of the state at the end of a chatter on a wall with respect to that after one of its
    /// rebounds.
    fn stick_matrix(&self, wall: Wall) -> Matrix4<f64>;
    /// Error of y per rounding of the position at a state: 1, or cosθ where the position is computed from
    /// cosθ.
    fn sharpness(&self, _state: &Self::State) -> f64 {
        1.0
    }
    /// Sizes of x, ẋ, the distance to a wall and ẏ: a state carried in plain doubles is rounded in proportion
    /// to these. 0: no tier carries it so.
    fn plain_state(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// As [`Differentiable::sizes`], for a motion in plain doubles.
    fn plain_rates(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// Rate of the position: |ẏ|, for a pendulum |W|.
    fn turning(&self, state: &Self::State) -> f64 {
        self.rates(state)[2].abs()
    }
    /// Largest truncation error of a segment, of x and ẋ and of y and ẏ.
    fn truncation(&self, _from: &Self::State) -> [f64; 2] {
        [0.0; 2]
    }
}

/// The derivative of an impact of a free mass, from the primary's share of the gap velocity and e.
pub fn free_mass_impact(share: f64, restitution: f64) -> Matrix4<f64> {
    let mut matrix = Matrix4::identity();
    (matrix[(1, 3)], matrix[(3, 3)]) = (share, -restitution);
    matrix
}

/// The derivative of a stick of a free mass, from the primary's share μ/(1 + μ) of the gap velocity.
pub fn free_mass_stick(share: f64) -> Matrix4<f64> {
    let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
    (matrix[(0, 2)], matrix[(1, 3)]) = (share, share);
    matrix
}

/// Standard deviation of the rounding error of an increment, in units of 2⁻⁵³ of it.
const ROUNDING: f64 = 0.7;
/// Standard deviation of the correlated rounding errors of rebounds on one wall, in units of 2⁻⁵³ of
/// [`Differentiable::sizes`]: each comes from several roundings.
const ALIKE: f64 = 1.5;
/// The estimate in standard deviations.
const DEVIATIONS: f64 = 4.0;
/// Half a unit in the last place of 1.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Relative change of the approach speed by an error above which an impact counts as close to a grazing.
const GRAZING: f64 = 0.01;

/// Error of an impact time in 1/ωn above which nothing more is estimated.
const LOST: f64 = 1.0;

/// The estimated error of one impact time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeError {
    /// An estimate in 1/ωn that the true error rarely exceeds; `None` once it has reached 1/ωn.
    pub time: Option<f64>,
    /// True if errors of this size could turn the impact into a grazing, or remove it.
    pub grazing: bool,
    /// Its approach speed, by which it is found if it is not to be listed after all.
    speed: f64,
}

/// An observer that estimates the errors of a run.
#[derive(Debug, Clone)]
pub struct Errors {
    covariance: Matrix4<f64>,
    /// Correlated errors of the rebounds on one wall, a column for each rate: those up to the last impact on
    /// this wall, and those since.
    alike: [Matrix4<f64>; 2],
    /// Derivative of the state with respect to that at the begin of the run.
    derivative: Matrix4<f64>,
    wall: Option<Wall>,
    /// The length that a condition is relative to: |x| of the start, or the clearance.
    unit: f64,
    clearance: f64,
    /// The error of the current impact, and whether it is close to a grazing.
    now: Option<(f64, bool)>,
    /// The error of the rebounds of a summed tail that follow.
    tail: f64,
    /// True for a run whose states are carried in plain doubles.
    plain: bool,
    /// True once the estimate has reached [`LOST`].
    lost: bool,
    /// One estimate for each listed impact.
    pub impacts: Vec<TimeError>,
    condition: f64,
    /// Largest error of an impact time τ over max(τ, 1).
    relative: f64,
}

impl Default for Errors {
    fn default() -> Self {
        Self {
            covariance: Matrix4::zeros(),
            alike: [Matrix4::zeros(); 2],
            derivative: Matrix4::identity(),
            wall: None,
            unit: 1.0,
            clearance: 1.0,
            now: None,
            tail: 0.0,
            plain: false,
            lost: false,
            impacts: Vec::new(),
            condition: 0.0,
            relative: 0.0,
        }
    }
}

impl Errors {
    /// Estimates the errors of a free mass in the fast tier, whose states are carried in plain doubles: every
    /// flight rounds the state itself, not only what it gains.
    pub fn in_doubles() -> Self {
        Self { plain: true, ..Self::default() }
    }

    /// −log₁₀ of the largest error over max(τ, 1); 0 once the error has reached 1, `None` without impacts.
    pub fn digits(&self) -> Option<f64> {
        let digits = if self.lost { 0.0 } else { -self.relative.max(UNIT).log10() };
        (!self.impacts.is_empty()).then_some(digits)
    }

    /// Largest change of an impact time per unit change of a start value, both dimensionless; `None` without
    /// impacts, and once the start is forgotten, when it is unbounded.
    pub fn condition(&self) -> Option<f64> {
        (!self.impacts.is_empty() && !self.lost).then_some(self.condition)
    }

    /// Derivative of the state z with respect to that at the begin of the run: the product of the flows and
    /// saltation matrices so far; for a periodic orbit the monodromy matrix. `None` once the start is
    /// forgotten.
    pub fn derivative(&self) -> Option<&Matrix4<f64>> {
        (!self.lost).then_some(&self.derivative)
    }

    fn carry(&mut self, map: &Matrix4<f64>) {
        self.covariance = map * self.covariance * map.transpose();
        self.alike = self.alike.map(|errors| map * errors);
        self.derivative = map * self.derivative;
    }

    /// Adds independent errors of this standard deviation to each variable.
    fn add(&mut self, deviations: Vector4<f64>) {
        for (i, deviation) in deviations.iter().enumerate() {
            self.covariance[(i, i)] += deviation * deviation;
        }
    }

    /// Standard deviation of variable i.
    fn deviation(&self, i: usize) -> f64 {
        (self.covariance[(i, i)] + self.alike[0].row(i).norm_squared()).sqrt()
    }

    /// Prepares for an impact: on the other wall, where other numbers are rounded, correlated errors join the
    /// covariance. `gap` is the rounding error of the gap.
    fn meet(&mut self, wall: Wall, gap: f64) {
        let [before, since] = self.alike;
        let again = self.wall == Some(wall);
        self.alike = [if again { before + since } else { Matrix4::zeros() }, Matrix4::zeros()];
        if !again {
            self.covariance += before * before.transpose();
        }
        if !again && self.wall.is_some() {
            self.add(Vector4::new(0.0, 0.0, gap, 0.0));
        }
        self.wall = Some(wall);
    }

    fn impact<S: Differentiable>(&mut self, system: &S, before: &S::State, after: &S::State) {
        let (wall, f) = (system.wall(before), system.rates(before));
        self.meet(wall, UNIT * self.clearance * system.sharpness(before));
        let approach = f[2].abs();
        let curvature = system.distance(before).curvature.abs();
        let distance = DEVIATIONS * self.deviation(2);
        let margin = approach * approach - 2.0 * curvature * distance;
        let time = 2.0 * distance / (approach + margin.max(0.0).sqrt());
        let grazing = curvature * distance > GRAZING * (approach * approach);
        // Also where the approach speed is 0, or a number has overflowed.
        self.lost |= !time.is_finite() || time >= LOST || approach == 0.0;
        self.now = Some((time, grazing));
        if self.lost {
            return;
        }
        for column in 0..4 {
            let scale = self.unit / approach;
            self.condition = self.condition.max((scale * self.derivative[(2, column)]).abs());
        }
        let jump = system.impact_matrix(system.wall(before));
        let (f_after, normal) = (system.rates(after), Vector4::new(0.0, 0.0, 1.0 / f[2], 0.0));
        self.carry(&(jump + (f_after - jump * f) * normal.transpose()));
        let speeds = Vector4::new(0.0, f_after[0].abs(), 0.0, f_after[2].abs());
        self.add(UNIT * ROUNDING * speeds);
        self.tail = self.of_tail(system, after, time);
    }

    /// The error of all further rebounds of a chatter from this impact on: their times add up to
    /// T = 2u/(A(1 − e)).
    fn of_tail<S: Differentiable>(&self, system: &S, after: &S::State, time: f64) -> f64 {
        let leave = system.distance(after);
        let left = 1.0 - system.rebound_ratio(system.wall(after));
        let whole = 2.0 * leave.rate / (leave.curvature.abs() * left);
        let speed = self.deviation(3) / leave.rate;
        let pressure = (self.deviation(0) + self.deviation(1)) / leave.curvature.abs();
        let more = DEVIATIONS * whole * system.sharpness(after) * (speed + pressure);
        time + if more.is_finite() { more } else { 0.0 }
    }
}

impl<S: Differentiable> Observer<S> for Errors {
    fn start(&mut self, system: &S, Instant { state, .. }: &Instant<S::State>, _duration: f64) {
        *self = Self { plain: self.plain, ..Self::default() };
        self.clearance = system.clearance();
        self.wall = (system.distance(state).value == 0.0).then(|| system.wall(state));
        let x = system.primary(state).x.abs();
        self.unit = if x > 0.0 { x } else { self.clearance };
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        if self.lost {
            return;
        }
        let (from, h) = (span.motion.origin(), span.length);
        let end = span.motion.state(h);
        let [primary, gap] = system.truncation(from);
        let map =
            if M::RIDING { system.ride_tangent(from, h) } else { system.flight_tangent(from, h) };
        self.carry(&map);
        let sharpness = system.sharpness(&end);
        let mut rates = system.rates(from).abs().sup(&system.rates(&end).abs());
        if sharpness < 1.0 {
            rates[2] = sharpness * system.turning(from).max(system.turning(&end));
        }
        let mut errors = UNIT * ROUNDING * h * rates;
        errors += Vector4::new(primary * h, primary, gap * h * sharpness, gap);
        if M::RIDING {
            (errors[2], errors[3]) = (0.0, 0.0);
        }
        self.add(errors);
        if self.plain {
            self.add(UNIT * ROUNDING * system.plain_state(&end));
        }
        if !M::RIDING {
            let mut wrong = UNIT * ALIKE * h * system.sizes(from);
            wrong[2] = wrong[2].min(UNIT * ALIKE * h * rates[2]);
            if self.plain {
                wrong = UNIT * ALIKE * h * system.plain_rates(&end);
            }
            self.alike[1] += Matrix4::from_diagonal(&wrong);
            // An error of the acceleration displaces as well.
            self.alike[1][(0, 1)] += 0.5 * h * wrong[1];
            self.alike[1][(2, 3)] += 0.5 * h * sharpness * wrong[3];
        }
    }

    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        match jump {
            Jump::Impact { before, after } => Errors::impact(self, system, before, after),
            Jump::Stick { .. } => {
                // On the wall hit last; a plastic stick at the begin of a run changes nothing.
                self.carry(&system.stick_matrix(self.wall.unwrap_or(Wall::Plus)));
            }
            Jump::Release => {
                self.carry(&Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0)));
            }
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        let (error, grazing) = self.now.take().unwrap_or((self.tail, false));
        // The rounding of the instant to a double.
        let error = error + UNIT * impact.time;
        self.relative = self.relative.max(error / impact.time.max(1.0));
        let time = (!self.lost).then_some(error);
        self.impacts.push(TimeError { time, grazing, speed: impact.approach_speed() });
    }

    fn unlist(&mut self, first: u64, floor: f64) {
        let mut index = 0;
        self.impacts.retain(|impact| {
            index += 1;
            index <= first || impact.speed > floor
        });
    }
}
