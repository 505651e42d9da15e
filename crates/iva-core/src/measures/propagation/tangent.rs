//! The derivative of a run: the product of the flows and saltation matrices along it.

use nalgebra::{DMatrix, Matrix4, Vector4};

use crate::absorber::derivatives::Differentiable;
use crate::absorber::{Absorber, Clock};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, Tally};
use crate::segment::flight::Motion;

/// The saltation matrix of an impact between two states, with the rates ż at both.
#[inline(always)]
pub(crate) fn saltation<S: Differentiable>(
    system: &S,
    states: [&S::State; 2],
    [before, after]: [&Vector4<f64>; 2],
) -> Matrix4<f64> {
    let jump = system.impact_matrix(states);
    let normal = Vector4::new(0.0, 0.0, 1.0 / before[2], 0.0);
    jump + (after - jump * before) * normal.transpose()
}

/// The derivative of the state after the release from a wall: the absorber is at rest on it.
pub(super) fn released() -> Matrix4<f64> {
    Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0))
}

/// An observer of the derivative of a run in the numbers of a state that are independent.
pub trait Derivative<S: Absorber<Real = f64>>: Observer<S> + Default {
    /// The derivative since this was last called, or since the begin of the run; from here on it is that of what follows.
    fn factor(&mut self, system: &S) -> DMatrix<f64>;
    /// The determinant since the begin of the run, where it is known more exactly than that of the derivative.
    fn volume(&self) -> Option<f64> {
        None
    }
    /// How many of the numbers are lost at one instant since the begin of the run, at the most: two of each absorber that rides, and one of
    /// another that friction holds or that has a plastic impact; `rides` is the number of rides.
    fn lost(&self, rides: u64) -> usize;
}

impl<S: Differentiable> Derivative<S> for Tangent {
    fn factor(&mut self, _system: &S) -> DMatrix<f64> {
        DMatrix::from_column_slice(4, 4, self.take().as_slice())
    }

    fn volume(&self) -> Option<f64> {
        Some(self.volume)
    }

    fn lost(&self, rides: u64) -> usize {
        if rides > 0 { 2 } else { usize::from(self.volume == 0.0) }
    }
}

/// An observer of the derivative of the state z = (x, ẋ, y, ẏ) (with W = b θ̇ in place of ẏ for a pendulum) with
/// respect to that at the begin of the run.
///
/// After a summed chatter the absorber counts as stuck from the last impact before the sum. The rest of the chatter
/// lasts some ε = 10⁻⁶, in 1/ωn; the error of the derivative is of the order of ε², for a pendulum of ε.
#[derive(Debug, Clone)]
pub struct Tangent {
    derivative: Matrix4<f64>,
    /// The product of the determinants of its factors.
    volume: f64,
    /// The instant at which the current motion of a linear system has begun, and whether the absorber is stuck.
    begun: (Clock, bool),
}

impl Default for Tangent {
    fn default() -> Self {
        Self { derivative: Matrix4::identity(), volume: 1.0, begun: (Clock::ZERO, false) }
    }
}

impl Tangent {
    /// The derivative; complete once the run has ended.
    pub fn derivative(&self) -> &Matrix4<f64> {
        &self.derivative
    }

    /// The derivative since this was last called, or since the begin of the run; from here on it is that of what follows.
    pub(crate) fn take(&mut self) -> Matrix4<f64> {
        std::mem::replace(&mut self.derivative, Matrix4::identity())
    }

    /// Its determinant, as the product of those of its factors: next to a grazing the determinant of the derivative itself
    /// is lost in rounding. 0 after a stick.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// At the begin of a run from a state at an instant.
    pub(crate) fn at(time: Clock) -> Self {
        Self { begun: (time, false), ..Self::default() }
    }

    #[inline(always)]
    fn carry(&mut self, map: &Matrix4<f64>) {
        self.derivative = map * self.derivative;
    }

    /// As [`Tangent::carry`], by a flight or a ride from a state.
    #[inline(always)]
    fn move_on<S: Differentiable>(&mut self, system: &S, from: &S::State, h: f64, riding: bool) {
        if riding {
            self.carry(&system.ride_tangent(from, h));
            self.volume = 0.0;
        } else {
            let map = system.flight_tangent(from, h);
            self.carry(&map);
            self.volume *= system.flight_volume(&map);
        }
    }

    /// The motion of a linear system ends at an instant, and another one begins.
    #[inline(always)]
    pub(crate) fn turn<S: Differentiable>(
        &mut self,
        system: &S,
        state: &S::State,
        time: Clock,
        riding: bool,
    ) {
        let (begin, was_riding) = self.begun;
        let h = (time - begin).value;
        if S::LINEAR && h > 0.0 {
            self.move_on(system, state, h, was_riding);
        }
        self.begun = (time, riding);
    }

    /// An impact at an instant, between these states.
    #[inline(always)]
    pub(crate) fn struck<S: Differentiable>(
        &mut self,
        system: &S,
        time: Clock,
        [before, after]: [&S::State; 2],
    ) {
        self.turn(system, before, time, false);
        let rates = [&system.rates(before), &system.rates(after)];
        self.carry(&saltation(system, [before, after], rates));
        // det S = det J nᵀJ⁻¹f⁺/(nᵀf⁻), and an impact does not move the absorber.
        let jump = system.impact_matrix([before, after]);
        self.volume *= system.impact_volume(&jump) * (rates[1][2] / rates[0][2]);
    }
}

impl<S: Differentiable> Observer<S> for Tangent {
    fn start(&mut self, _system: &S, from: &Instant<S::State>, _duration: f64) {
        *self = Self::at(from.time);
    }

    fn looks_within(&self) -> bool {
        !S::LINEAR
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        let from = span.motion.origin();
        if !S::LINEAR {
            self.move_on(system, from, span.length, M::RIDING);
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        let Contact { time, states, summed } = *contact;
        if !summed {
            self.struck(system, Clock::new(time), states);
        }
    }

    fn stick(&mut self, system: &S, from: &Instant<S::State>) {
        self.carry(&system.stick_matrix(&from.state));
        self.volume = 0.0;
        self.begun.1 = true;
    }

    fn release(&mut self, system: &S, from: &Instant<S::State>) {
        self.turn(system, &from.state, from.time, false);
        self.carry(&released());
        self.carry(&system.slip_matrix(&from.state));
    }

    fn stop(&mut self, system: &S, _time: f64, states: [&S::State; 2]) {
        self.carry(&system.stop_matrix(states));
        self.volume = 0.0;
    }

    fn slip(&mut self, system: &S, from: &Instant<S::State>) {
        self.carry(&system.slip_matrix(&from.state));
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        self.turn(system, &tally.state, tally.clock, false);
    }
}
