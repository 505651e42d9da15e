//! How errors grow along a run: an estimate of the error of every impact time.
//!
//! A small error of the state z = (x, ẋ, y, ẏ) (of a pendulum W = b θ̇ in place of ẏ) is carried by the
//! derivative of the motion: of the flow along a segment, and of an impact by the saltation matrix
//!
//! ```text
//! S = J + (f⁺ − J f⁻) nᵀ/(nᵀ f⁻)
//! ```
//!
//! with J the derivative of the velocity jump, f the rates before and after, n the gradient of the gap
//! (P. C. Müller, Chaos, Solitons & Fractals 5 (1995) 1671–1681). What rounding and truncation add on
//! each segment is treated as independent random errors: their covariance P goes from segment to
//! segment as Φ P Φᵀ + Q. A summed chatter keeps momentum and centre of mass, a release is smooth.
//!
//! Rounding is not independent where a wall is hit again and again: a chatter takes the same rounded
//! constants at every rebound. What rounds alike is carried as columns that add up, and joins the
//! covariance when the other wall is met.
//!
//! The error of an impact time is that of the distance over the speed of approach, or, where that is
//! not small against it, as far as the curvature lets the instant move. Once it reaches 1/ωn the run
//! has forgotten its start: from there on nothing is estimated.

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
    /// ż in free flight.
    fn rates(&self, state: &Self::State) -> Vector4<f64>;
    /// Sizes of ẋ, ẍ, ẏ and ÿ (or Ẇ) before their terms cancel: what rounding takes from them at every
    /// rebound alike is a share of these. 0: they are computed to twice the precision.
    fn sizes(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// Derivative of the state after a time h of flight by the state before.
    fn flight_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// The same while stuck on a wall, where y and ẏ do not change.
    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// Derivative of the velocity jump of an impact on a wall.
    fn impact_matrix(&self, wall: Wall) -> Matrix4<f64>;
    /// Derivative of the state at the end of a chatter on a wall by that after one of its rebounds.
    fn stick_matrix(&self, wall: Wall) -> Matrix4<f64>;
    /// What a rounding of the place is worth in y at a state: 1, or cosθ where that tells the place.
    fn sharpness(&self, _state: &Self::State) -> f64 {
        1.0
    }
    /// How fast the place changes: |ẏ|, of a pendulum |W|.
    fn turning(&self, state: &Self::State) -> f64 {
        self.rates(state)[2].abs()
    }
    /// What a segment may leave out of its series, of x and ẋ and of y and ẏ.
    fn truncation(&self, _from: &Self::State) -> [f64; 2] {
        [0.0; 2]
    }
}

/// The matrix of an impact of a free mass, from the primary's share of the gap velocity and e.
pub fn free_mass_impact(share: f64, restitution: f64) -> Matrix4<f64> {
    let mut matrix = Matrix4::identity();
    (matrix[(1, 3)], matrix[(3, 3)]) = (share, -restitution);
    matrix
}

/// The matrix of a free mass that sticks, from the primary's share of the gap velocity, μ/(1 + μ).
pub fn free_mass_stick(share: f64) -> Matrix4<f64> {
    let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
    (matrix[(0, 2)], matrix[(1, 3)]) = (share, share);
    matrix
}

/// Standard deviation of what rounding takes from an increment, over 2⁻⁵³ of it.
const ROUNDING: f64 = 0.7;
/// The same of what is rounded alike at every rebound on one wall, over 2⁻⁵³ of [`Differentiable::sizes`]:
/// each is the result of several roundings.
const ALIKE: f64 = 1.5;
/// The estimate is so many standard deviations.
const DEVIATIONS: f64 = 4.0;
/// Half a unit in the last place of 1.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Share of the speed of approach that an error may change before the impact counts as close to a
/// grazing.
const GRAZING: f64 = 0.01;

/// An error as large as this says nothing any more, in 1/ωn.
const LOST: f64 = 1.0;

/// The estimated error of one impact time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeError {
    /// Estimate that the true error rarely exceeds, in 1/ωn; `None` once it has reached 1/ωn.
    pub time: Option<f64>,
    /// True if errors this large could make a grazing of the impact, or let it vanish.
    pub grazing: bool,
    /// Its approach speed, to find it again when it is taken back.
    speed: f64,
}

/// Follows the errors of a run.
#[derive(Debug, Clone)]
pub struct Errors {
    covariance: Matrix4<f64>,
    /// What is rounded alike at every rebound on a wall adds up: errors, a column for each rate, that it
    /// has made until the last impact on this wall, and since.
    alike: [Matrix4<f64>; 2],
    /// Derivative of the state by that at the begin of the run.
    derivative: Matrix4<f64>,
    wall: Option<Wall>,
    /// Lengths that a condition is relative to: of the start, or the clearance.
    unit: f64,
    clearance: f64,
    /// Of the impact under way, and whether it is close to a grazing.
    now: Option<(f64, bool)>,
    /// Of the rebounds of a summed tail that follow.
    tail: f64,
    /// The estimate has reached [`LOST`].
    lost: bool,
    /// One for each listed impact.
    pub impacts: Vec<TimeError>,
    condition: f64,
    /// Largest time_error over max(τ, 1).
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
            lost: false,
            impacts: Vec::new(),
            condition: 0.0,
            relative: 0.0,
        }
    }
}

impl Errors {
    /// −log₁₀ of the largest error over max(τ, 1); 0 once that has reached 1, `None` without impacts.
    pub fn digits(&self) -> Option<f64> {
        let digits = if self.lost { 0.0 } else { -self.relative.max(UNIT).log10() };
        (!self.impacts.is_empty()).then_some(digits)
    }

    /// Largest change of an impact time per unit change of a start value, both dimensionless; `None`
    /// without impacts, and where the start is forgotten: no number is large enough then.
    pub fn condition(&self) -> Option<f64> {
        (!self.impacts.is_empty() && !self.lost).then_some(self.condition)
    }

    /// Derivative of the state z by that at the begin of the run: the product of the flows and saltation matrices
    /// so far, of a periodic orbit its monodromy matrix. `None` once the start is forgotten.
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

    /// Standard deviation of a variable.
    fn deviation(&self, i: usize) -> f64 {
        (self.covariance[(i, i)] + self.alike[0].row(i).norm_squared()).sqrt()
    }

    /// An impact on the wall that was hit before, or on another, where other numbers are rounded; the gap
    /// itself is rounded by `gap`.
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
        // Also where nothing approaches, or a number has overflowed.
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

    /// The error of all rebounds that a chatter from here on still has: their times add up to
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
        *self = Self::default();
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
        if !M::RIDING {
            let mut wrong = UNIT * ALIKE * h * system.sizes(from);
            wrong[2] = wrong[2].min(UNIT * ALIKE * h * rates[2]);
            self.alike[1] += Matrix4::from_diagonal(&wrong);
            // A wrong acceleration displaces as well.
            self.alike[1][(0, 1)] += 0.5 * h * wrong[1];
            self.alike[1][(2, 3)] += 0.5 * h * sharpness * wrong[3];
        }
    }

    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        match jump {
            Jump::Impact { before, after } => Errors::impact(self, system, before, after),
            Jump::Stick => {
                // On the wall hit last; a plastic stick at the begin changes nothing.
                self.carry(&system.stick_matrix(self.wall.unwrap_or(Wall::Plus)));
            }
            Jump::Release => {
                self.carry(&Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0)));
            }
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        let (error, grazing) = self.now.take().unwrap_or((self.tail, false));
        // Written as a double, the instant is rounded once more.
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
