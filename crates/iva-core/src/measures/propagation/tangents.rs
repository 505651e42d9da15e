//! The derivative of a run of several members: the product of its flows and of the jumps at its events.

use nalgebra::DMatrix;

use super::{Derivative, jumps};
use crate::absorber::Clock;
use crate::absorber::derivatives::lists::{DifferentiableList, place, slip};
use crate::absorber::derivatives::maps::{Map, map_columns};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, Tally};
use crate::segment::flight::Motion;

/// An observer of the derivative of the state with respect to that at the begin of the run, or since its factor was last taken: of all
/// variables of a list, by the numbers of a state.
///
/// As [`super::Tangent`] it counts who ends a chatter as stuck from the last impact before the sum.
#[derive(Debug, Clone, Default)]
pub struct Tangents {
    product: DMatrix<f64>,
    /// The members that the structure carries along.
    carried: Vec<bool>,
    /// The instant at which the current motion of a linear system has begun; `None` of another, whose motions are taken part by part.
    begun: Option<Clock>,
    /// How many numbers were lost at one instant, at the most.
    lost: usize,
}

impl Tangents {
    /// The motion of a linear system ends in a state at an instant.
    fn end_motion<S: DifferentiableList>(&mut self, system: &S, state: &S::State, time: Clock) {
        let h = self.begun.map_or(0.0, |begun| (time - begun).value);
        if h > 0.0 {
            map_columns(&mut self.product, &mut system.fine_flow(state, &self.carried, h));
            self.begun = Some(time);
        }
    }

    fn carry<S: DifferentiableList>(&mut self, system: &S, mut map: Map<'_>, after: &S::State) {
        map_columns(&mut self.product, &mut map);
        self.hold(system, after, system.carried(after, false));
    }

    /// These members are carried from a state on.
    fn hold<S: DifferentiableList>(&mut self, system: &S, state: &S::State, carried: Vec<bool>) {
        self.lost = self.lost.max(held(system, state, &carried));
        self.carried = carried;
    }
}

/// How many numbers carried members have lost: the rate of each and, on a wall, the place.
fn held<S: DifferentiableList>(system: &S, state: &S::State, carried: &[bool]) -> usize {
    let held = (0..carried.len()).filter(|k| carried[*k]);
    held.map(|k| if system.approach_of(state, k)[0] == 0.0 { 2 } else { 1 }).sum()
}

/// True if an impact of a member in a state takes all of its gap velocity.
fn is_plastic<S: DifferentiableList>(system: &S, before: &S::State, member: usize) -> bool {
    let wall = system.wall(&system.turned_to(before, member));
    system.law_of(member, wall, -system.approach_of(before, member)[1]).restitution == 0.0
}

impl<S: DifferentiableList> Derivative<S> for Tangents {
    fn factor(&mut self, system: &S) -> DMatrix<f64> {
        let (begin, numbers) = system.by_numbers();
        std::mem::replace(&mut self.product, begin.clone()).select_rows(numbers)
    }

    fn lost(&self, _rides: u64) -> usize {
        self.lost
    }
}

impl<S: DifferentiableList> Observer<S> for Tangents {
    fn start(&mut self, system: &S, from: &Instant<S::State>, _duration: f64) {
        let carried = system.carried(&from.state, false);
        let begun = system.is_linear().then_some(from.time);
        let (mut product, _) = system.by_numbers().clone();
        for k in (0..carried.len()).filter(|k| carried[*k]) {
            // Who is carried has no rate of its own, and on a wall no place either.
            let [y, w] = place(system.coordinates(), k);
            product.row_mut(w).fill(0.0);
            if system.approach_of(&from.state, k)[0] == 0.0 {
                product.row_mut(y).fill(0.0);
            }
        }
        *self = Self { product, begun, ..Self::default() };
        self.hold(system, &from.state, carried);
    }

    fn looks_within(&self) -> bool {
        self.begun.is_none()
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        if self.begun.is_some() {
            return;
        }
        let from = span.motion.origin();
        let carried = system.carried(from, false);
        map_columns(&mut self.product, &mut system.fine_flow(from, &carried, span.length));
        self.hold(system, from, carried);
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        let Contact { time, states, summed } = *contact;
        let struck = jumps::struck(system, states[0], &self.carried);
        if !(summed || struck.is_empty()) {
            self.end_motion(system, states[0], Clock::new(time));
            let plastic = struck.iter().filter(|k| is_plastic(system, states[0], **k)).count();
            self.lost = self.lost.max(held(system, states[0], &self.carried) + plastic);
            let freed = system.carried(states[1], false);
            let carried = [self.carried.as_slice(), &freed];
            let (mut map, _) = jumps::saltation(system, &struck, states, carried);
            map_columns(&mut self.product, &mut map);
            drop(map);
            self.hold(system, states[1], freed);
        }
    }

    fn stick(&mut self, system: &S, from: &Instant<S::State>) {
        let carried = system.carried(&from.state, true);
        map_columns(&mut self.product, &mut system.stick_map(&from.state, &carried));
        self.hold(system, &from.state, carried);
    }

    fn release(&mut self, system: &S, from: &Instant<S::State>) {
        self.end_motion(system, &from.state, from.time);
        let map = jumps::release(system, &from.state, &self.carried);
        self.carry(system, map, &from.state);
    }

    fn stop(&mut self, system: &S, time: f64, states: [&S::State; 2]) {
        self.end_motion(system, states[0], Clock::new(time));
        let map = jumps::stop(system, states, &self.carried);
        self.carry(system, map, states[1]);
    }

    fn slip(&mut self, system: &S, from: &Instant<S::State>) {
        self.end_motion(system, &from.state, from.time);
        let map = slip(system, &from.state, &self.carried);
        self.carry(system, map, &from.state);
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        self.end_motion(system, &tally.state, tally.clock);
    }
}
