//! The observer that estimates the errors of a run.

use nalgebra::{Matrix4, Vector4};

use super::lists::Grown;
use super::tangent::saltation;
use super::ways::{Estimated, Way as _};
use crate::absorber::derivatives::Differentiable;
use crate::absorber::impact::Impact;
use crate::absorber::{Point, Wall};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, Tally};
use crate::segment::flight::Motion;

/// Standard deviation of the rounding error of an increment, in units of 2⁻⁵³ of it.
pub(super) const ROUNDING: f64 = 0.7;
/// Standard deviation of the correlated rounding errors of rebounds on one wall, in units of 2⁻⁵³ of
/// [`Differentiable::sizes`]: each comes from several roundings.
pub(super) const ALIKE: f64 = 1.5;
/// The estimate in standard deviations.
pub(super) const DEVIATIONS: f64 = 4.0;
/// Half a unit in the last place of 1.
pub(super) const UNIT: f64 = 0.5 * f64::EPSILON;
/// Relative change of the approach speed by an error above which an impact counts as close to a grazing.
pub(super) const GRAZING: f64 = 0.01;

/// Error of an impact time in 1/ωn above which nothing more is estimated.
pub(super) const LOST: f64 = 1.0;

/// The estimated error of one impact time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeError {
    /// An estimate in 1/ωn that the true error rarely exceeds; `None` once it has reached 1/ωn.
    pub time: Option<f64>,
    /// True if errors of this size could turn the impact into a grazing, or remove it.
    pub grazing: bool,
    /// Its absorber and its approach speed, by which it is found if it is not to be listed after all.
    absorber: u8,
    speed: f64,
}

/// A motion of a linear system, from the event that it begins with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Begun {
    /// The instant, in 1/ωn.
    time: f64,
    /// The rates ż there.
    rates: Vector4<f64>,
    /// True if the absorber sticks to a wall.
    riding: bool,
}

/// An observer that estimates the errors of a run.
#[derive(Debug, Clone)]
pub struct Errors {
    pub(super) covariance: Matrix4<f64>,
    /// Correlated errors of the rebounds on one wall, a column for each rate: those up to the last impact on
    /// this wall, and those since; `None` if there are none.
    pub(super) alike: Option<[Matrix4<f64>; 2]>,
    /// Derivative of the state with respect to that at the begin of the run.
    pub(super) derivative: Matrix4<f64>,
    pub(super) wall: Option<Wall>,
    /// The length that a condition is relative to: |x| of the start, or the clearance.
    pub(super) unit: f64,
    pub(super) clearance: f64,
    /// The current motion of a linear system.
    pub(super) begun: Option<Begun>,
    /// The error of the last impact, and whether it is close to a grazing.
    pub(super) last: (f64, bool),
    /// The error of the rebounds of a summed tail that follow it, if they do.
    pub(super) tail: Option<f64>,
    /// True for a run whose states are carried in plain doubles.
    pub(super) plain: bool,
    /// True if it needs the states within motions.
    within: bool,
    /// True once the estimate has reached [`LOST`].
    pub(super) lost: bool,
    /// Those of several absorbers.
    pub(super) list: Option<Box<Grown>>,
    /// One estimate for each listed impact.
    pub impacts: Vec<TimeError>,
    pub(super) condition: f64,
    /// Largest error of an impact time τ over max(τ, 1).
    pub(super) relative: f64,
}

impl Default for Errors {
    fn default() -> Self {
        Self {
            covariance: Matrix4::zeros(),
            alike: None,
            derivative: Matrix4::identity(),
            wall: None,
            unit: 1.0,
            clearance: 1.0,
            begun: None,
            last: (0.0, false),
            tail: None,
            plain: false,
            within: false,
            lost: false,
            list: None,
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
        let digits = if self.lost { 0.0 } else { -libm::log10(self.relative.max(UNIT)) };
        (!self.impacts.is_empty()).then_some(digits)
    }

    /// Largest change of an impact time per unit change of a start value, both dimensionless; `None` without
    /// impacts, and once the start is forgotten, when it is unbounded.
    pub fn condition(&self) -> Option<f64> {
        (!self.impacts.is_empty() && !self.lost).then_some(self.condition)
    }

    /// Derivative of the state z with respect to that at the begin of the run: the product of the flows and
    /// saltation matrices so far; for a periodic orbit the monodromy matrix. That of a pendulum has some
    /// five digits; [`super::Tangent`] has all. `None` once the start is forgotten.
    pub fn derivative(&self) -> Option<&Matrix4<f64>> {
        (!self.lost).then_some(&self.derivative)
    }

    pub(super) fn carry(&mut self, map: &Matrix4<f64>) {
        self.covariance = map * self.covariance * map.transpose();
        self.alike = self.alike.map(|alike| alike.map(|errors| map * errors));
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
        let alike = self.alike.map_or(0.0, |[before, _]| before.row(i).norm_squared());
        (self.covariance[(i, i)] + alike).sqrt()
    }

    /// A motion begins at an event.
    pub(super) fn begin<S: Differentiable>(&mut self, from: (f64, Vector4<f64>), riding: bool) {
        let (time, rates) = from;
        self.begun = S::LINEAR.then_some(Begun { time, rates, riding });
    }

    /// The motion of a linear system ends at an instant, with these rates.
    pub(super) fn end_motion<S: Differentiable>(
        &mut self,
        system: &S,
        time: f64,
        end: &S::State,
        rates: Vector4<f64>,
    ) {
        let Some(Begun { time: begin, rates: first, riding }) = self.begun.take() else { return };
        if time > begin && !self.lost {
            self.moved(system, time - begin, riding, end, end, [first, rates]);
        }
    }

    /// A motion of length h has ended, with these rates at both ends.
    pub(super) fn moved<S: Differentiable>(
        &mut self,
        system: &S,
        h: f64,
        riding: bool,
        from: &S::State,
        end: &S::State,
        [first, last]: [Vector4<f64>; 2],
    ) {
        let [primary, gap] = system.truncation(from);
        let map = if riding { system.ride_tangent(from, h) } else { system.rough_tangent(from, h) };
        self.carry(&map);
        let sharpness = system.sharpness(end);
        let mut rates = first.abs().sup(&last.abs());
        if S::LINEAR {
            // A long motion may be fastest in between, up to the root mean square of its velocity.
            let Point { x, v } = system.primary(end);
            let most = (0.5 * (x * x + v * v)).sqrt();
            let changes = Vector4::new(rates[1], rates[0], rates[3], rates[0]) * (0.25 * h);
            rates = rates.sup(&changes.inf(&Vector4::repeat(most)));
        }
        if sharpness < 1.0 {
            rates[2] = sharpness * system.turning(from).max(system.turning(end));
        }
        let mut errors = UNIT * ROUNDING * h * rates;
        errors += Vector4::new(primary * h, primary, gap * h * sharpness, gap);
        if riding {
            (errors[2], errors[3]) = (0.0, 0.0);
        }
        self.add(errors);
        if self.plain {
            // Every stretch rounds the state; a stretch is about 1/ωn long.
            self.add(UNIT * ROUNDING * (1.0 + h).sqrt() * system.plain_state(end));
        }
        if riding {
            return;
        }
        let wrong = if self.plain {
            Some(system.plain_rates(end))
        } else {
            system.sizes(from).map(|mut sizes| {
                sizes[2] = sizes[2].min(rates[2]);
                sizes
            })
        };
        if let Some(sizes) = wrong {
            let wrong = UNIT * ALIKE * h * sizes;
            let [_, since] = self.alike.get_or_insert([Matrix4::zeros(); 2]);
            *since += Matrix4::from_diagonal(&wrong);
            // An error of the acceleration displaces as well.
            since[(0, 1)] += 0.5 * h * wrong[1];
            since[(2, 3)] += 0.5 * h * sharpness * wrong[3];
        }
    }

    /// Prepares for an impact: on the other wall, where other numbers are rounded, correlated errors join the
    /// covariance. `gap` is the rounding error of the gap.
    fn meet(&mut self, wall: Wall, gap: f64) {
        let again = self.wall == Some(wall);
        if let Some([before, since]) = self.alike {
            let sum = if again { before + since } else { Matrix4::zeros() };
            self.alike = Some([sum, Matrix4::zeros()]);
            if !again {
                self.covariance += before * before.transpose();
            }
        }
        if !again && self.wall.is_some() {
            self.add(Vector4::new(0.0, 0.0, gap, 0.0));
        }
        self.wall = Some(wall);
    }

    /// An impact at an instant, between these states.
    pub(crate) fn struck<S: Differentiable>(
        &mut self,
        system: &S,
        time: f64,
        [before, after]: [&S::State; 2],
    ) {
        if self.lost {
            return;
        }
        let (f, f_after) = (system.rates(before), system.rates(after));
        self.end_motion(system, time, before, f);
        self.begin::<S>((time, f_after), false);
        let wall = system.wall(before);
        self.meet(wall, UNIT * self.clearance * system.sharpness(before));
        let (approach, bend) = (f[2].abs(), system.bend(before));
        let distance = DEVIATIONS * self.deviation(2);
        let margin = approach * approach - 2.0 * bend * distance;
        let error = 2.0 * distance / (approach + margin.max(0.0).sqrt());
        let grazing = bend * distance > GRAZING * (approach * approach);
        // Also where the approach speed is 0, or a number has overflowed.
        self.lost |= !error.is_finite() || error >= LOST || approach == 0.0;
        (self.last, self.tail) = ((error, grazing), None);
        if self.lost {
            return;
        }
        let largest = self.derivative.row(2).amax();
        self.condition = self.condition.max((self.unit / approach) * largest);
        self.carry(&saltation(system, [before, after], [&f, &f_after]));
        let speeds = Vector4::new(0.0, f_after[0].abs(), 0.0, f_after[2].abs());
        self.add(UNIT * ROUNDING * speeds);
    }

    /// The error of all further rebounds of a chatter after the last impact, from this state: their times add up
    /// to T = 2u/(A(1 − e)).
    pub(super) fn of_tail<S: Differentiable>(&self, system: &S, after: &S::State) -> f64 {
        let leave = system.distance(after);
        let left = 1.0 - system.law_at(system.wall(after), leave.rate).rebound;
        let whole = 2.0 * leave.rate / (leave.curvature.abs() * left);
        let speed = self.deviation(3) / leave.rate;
        let pressure = (self.deviation(0) + self.deviation(1)) / leave.curvature.abs();
        let more = DEVIATIONS * whole * system.sharpness(after) * (speed + pressure);
        self.last.0 + if more.is_finite() { more } else { 0.0 }
    }

    /// Takes an impact into the list.
    pub(crate) fn list(&mut self, impact: &Impact) {
        let (last, grazing) = self.last;
        let (error, grazing) = self.tail.map_or((last, grazing), |tail| (tail, false));
        // The rounding of the instant to a double.
        let error = error + UNIT * impact.time;
        self.relative = self.relative.max(error / impact.time.max(1.0));
        let time = (!self.lost).then_some(error);
        let (absorber, speed) = (impact.absorber, impact.approach_speed());
        self.impacts.push(TimeError { time, grazing, absorber, speed });
    }

    /// Removes impacts that are not to be listed.
    pub(super) fn forget(&mut self, absorber: u8, first: u64, floor: f64) {
        let mut index = 0;
        self.impacts.retain(|impact| {
            let mine = impact.absorber == absorber;
            index += u64::from(mine);
            !mine || index <= first || impact.speed > floor
        });
    }
}

/// What the estimate is told of a run, by the way in which it is made.
impl<S: Estimated> Observer<S> for Errors {
    fn start(&mut self, system: &S, from: &Instant<S::State>, _duration: f64) {
        let within = S::Way::looks_within(system);
        *self = Self { plain: self.plain, within, ..Self::default() };
        S::Way::start(self, system, from);
    }

    fn looks_within(&self) -> bool {
        self.within
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        if self.within && !self.lost {
            S::Way::span(self, system, span);
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        let Contact { time, states, summed } = *contact;
        if !summed {
            S::Way::struck(self, system, time, states);
        } else if self.tail.is_none() {
            self.tail = S::Way::of_tail(self, system, states[1]);
        }
    }

    fn stick(&mut self, system: &S, from: &Instant<S::State>) {
        S::Way::stick(self, system, from);
    }

    fn release(&mut self, system: &S, from: &Instant<S::State>) {
        S::Way::release(self, system, from);
    }

    fn stop(&mut self, system: &S, time: f64, states: [&S::State; 2]) {
        S::Way::stop(self, system, time, states);
    }

    fn slip(&mut self, system: &S, from: &Instant<S::State>) {
        S::Way::slip(self, system, from);
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        self.list(impact);
    }

    fn unlist(&mut self, absorber: u8, first: u64, floor: f64) {
        self.forget(absorber, first, floor);
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        S::Way::end(self, system, tally);
    }
}
