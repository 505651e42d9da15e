//! The ways in which errors are estimated: what each event of a run makes of the estimate.

use super::errors::Errors;
use super::lists::Grown;
use super::tangent::released;
use crate::absorber::Absorber;
use crate::absorber::derivatives::Differentiable;
use crate::absorber::derivatives::lists::DifferentiableList;
use crate::engine::observe::Span;
use crate::engine::simulate::{Instant, Tally};
use crate::segment::flight::Motion;

/// A system that says in which way the errors of its runs are estimated.
pub trait Estimated: Absorber<Real = f64> {
    /// The way.
    type Way: Way<Self>;
}

/// A way in which errors are estimated: what the events of a run make of the estimate.
pub trait Way<S: Absorber<Real = f64> + ?Sized> {
    /// True if it needs the states within the motions of a system.
    fn looks_within(_system: &S) -> bool {
        false
    }
    /// At the start of a run.
    fn start(_errors: &mut Errors, _system: &S, _from: &Instant<S::State>) {}
    /// A motion; only if it looks within, and until the run has forgotten its start.
    fn span<M: Motion<Real = f64, State = S::State>>(
        _errors: &mut Errors,
        _system: &S,
        _span: &Span<'_, M>,
    ) {
    }
    /// An impact at an instant, between two states.
    fn struck(_errors: &mut Errors, _system: &S, _time: f64, _states: [&S::State; 2]) {}
    /// The error of the impacts of a summed chatter, from the state after its first rebound; `None` if it is not known.
    fn of_tail(_errors: &mut Errors, _system: &S, _after: &S::State) -> Option<f64> {
        None
    }
    /// The begin of a stick episode.
    fn stick(_errors: &mut Errors, _system: &S, _from: &Instant<S::State>) {}
    /// The end of a stick episode.
    fn release(_errors: &mut Errors, _system: &S, _from: &Instant<S::State>) {}
    /// A stop in the gap, between two states.
    fn stop(_errors: &mut Errors, _system: &S, _time: f64, _states: [&S::State; 2]) {}
    /// The end of a hold in the gap.
    fn slip(_errors: &mut Errors, _system: &S, _from: &Instant<S::State>) {}
    /// The end of the run.
    fn end(_errors: &mut Errors, _system: &S, _tally: &Tally<S::State>) {}
}

/// By the derivatives of the motion of one absorber ([`Differentiable`]).
#[derive(Debug)]
pub struct ByTangents;

impl<S: Differentiable> Way<S> for ByTangents {
    fn looks_within(_system: &S) -> bool {
        !S::LINEAR
    }

    fn start(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        let Instant { time, state } = from;
        errors.clearance = system.clearance();
        errors.wall = (system.distance(state).value == 0.0).then(|| system.wall(state));
        let x = system.primary(state).x.abs();
        errors.unit = if x > 0.0 { x } else { errors.clearance };
        errors.begin::<S>((time.value, system.rates(state)), false);
    }

    fn span<M: Motion<Real = f64, State = S::State>>(
        errors: &mut Errors,
        system: &S,
        span: &Span<'_, M>,
    ) {
        let from = span.motion.origin();
        let rates = [from, span.end].map(|state| system.rates(state));
        errors.moved(system, span.length, M::RIDING, from, span.end, rates);
    }

    fn struck(errors: &mut Errors, system: &S, time: f64, states: [&S::State; 2]) {
        errors.struck(system, time, states);
    }

    fn of_tail(errors: &mut Errors, system: &S, after: &S::State) -> Option<f64> {
        Some(errors.of_tail(system, after))
    }

    fn stick(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        let Instant { time, state } = from;
        // Stick follows an impact at once: the duration of a summed tail is left out.
        errors.carry(&system.stick_matrix(state));
        errors.begin::<S>((time.value, system.rates(state)), true);
    }

    fn release(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        let Instant { time, state } = from;
        let rates = system.rates(state);
        errors.end_motion(system, time.value, state, rates);
        errors.carry(&released());
        errors.begin::<S>((time.value, rates), false);
    }

    fn end(errors: &mut Errors, system: &S, tally: &Tally<S::State>) {
        let rates = system.rates(&tally.state);
        errors.end_motion(system, tally.end_time, &tally.state, rates);
    }
}

/// By the derivatives of the motion of several absorbers.
#[derive(Debug)]
pub struct ByLists;

impl<S: DifferentiableList> Way<S> for ByLists {
    fn looks_within(system: &S) -> bool {
        !system.is_linear()
    }

    fn start(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        errors.list = Some(Box::new(Grown::at(system, &from.state, from.time.value)));
    }

    fn struck(errors: &mut Errors, system: &S, time: f64, states: [&S::State; 2]) {
        let (Some(grown), false) = (&mut errors.list, errors.lost) else { return };
        (errors.last, errors.tail) = (grown.struck(system, time, states), None);
        (errors.lost, errors.condition) = (grown.lost, grown.condition);
    }

    fn span<M: Motion<Real = f64, State = S::State>>(
        errors: &mut Errors,
        system: &S,
        span: &Span<'_, M>,
    ) {
        if let Some(grown) = &mut errors.list {
            grown.spanned(system, span.length, [span.motion.origin(), span.end]);
        }
    }

    fn of_tail(errors: &mut Errors, system: &S, after: &S::State) -> Option<f64> {
        let grown = errors.list.as_ref().filter(|_| !errors.lost);
        grown.map(|grown| grown.of_tail(system, after))
    }

    fn stick(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        if let Some(grown) = &mut errors.list {
            grown.stick(system, &from.state);
        }
    }

    fn release(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        if let Some(grown) = &mut errors.list {
            grown.release(system, from.time.value, &from.state);
        }
    }

    fn stop(errors: &mut Errors, system: &S, time: f64, states: [&S::State; 2]) {
        if let Some(grown) = &mut errors.list {
            grown.stopped(system, time, states);
        }
    }

    fn slip(errors: &mut Errors, system: &S, from: &Instant<S::State>) {
        if let Some(grown) = &mut errors.list {
            grown.slipped(system, from.time.value, &from.state);
        }
    }
}
