//! The flights of lanes for observers that look within them: kept until their runs show them.

use super::round::Round;
use super::{FreeMasses, Stretch, Tier};
use crate::absorber::siva::trial::{FreeMass as _, Sight};
use crate::absorber::{Absorber, ImpactLaw, OnStructure};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, show_coast};
use crate::number::arrays::Lanes as _;

/// Number of flights after which a run shows them, so that a long run needs no more memory.
const MOST_FLIGHTS: usize = 256;

/// The state of a system in the lanes of a tier.
type State<T> = <<T as Tier>::System as OnStructure>::State;

impl<T: Tier, const W: usize> FreeMasses<T, W> {
    /// Keeps the flights of a lane from now on.
    pub fn keep(&mut self, i: usize) {
        self.flights.resize_with(W, || None);
        self.flights[i].get_or_insert_with(|| Vec::with_capacity(MOST_FLIGHTS));
    }

    /// Keeps the flights that the trials have completed; true if a lane has as many as it can keep.
    #[inline(never)]
    pub(super) fn keep_flights(&mut self) -> bool {
        let mut full = false;
        for (i, flights) in self.flights.iter_mut().enumerate() {
            let Round { passed, sight: Sight { h, far, .. }, later, hit, .. } = self.rounds.get(i);
            if let Some(flights) = flights.as_mut().filter(|_| passed) {
                let (clock, from) = (self.lanes.progress.clock.get(i), self.states.get(i));
                flights.push(Stretch { clock, from, h, later, hit, far, coasts: 0.0 });
                full |= flights.len() >= MOST_FLIGHTS;
            }
        }
        full
    }

    /// True if observers have to see the flights of a lane before it goes on.
    pub(super) fn must_show(&self, i: usize) -> bool {
        let flights = self.flights.get(i).and_then(Option::as_ref);
        flights.is_some_and(|flights| flights.len() >= MOST_FLIGHTS)
    }

    /// Shows an observer of the run of a lane its flights, computed again from the states at their begins.
    pub fn show(&mut self, i: usize, system: &T::System, observer: &mut impl Observer<T::System>) {
        let Some(mut flights) = self.flights.get_mut(i).and_then(Option::take) else { return };
        for flight in flights.drain(..) {
            let Stretch { clock, h, later, hit, coasts, .. } = flight;
            let [from, end] = self.ends(i, &flight, system);
            let motion = system.flight(&from);
            let span = Span {
                motion: &motion,
                start: clock,
                length: h + later,
                from: system.primary(&from),
                to: system.primary(&end),
                end: &end,
            };
            observer.span(system, &span);
            let time = clock.plus_parts(h, later);
            if hit {
                let (after, impact) = system.impact(&end, time.value);
                let states = [&end, &after];
                let contact = Contact { time: time.value, states, summed: false };
                observer.contact(system, &contact);
                observer.impact(system, &impact);
            } else if coasts > 0.0 {
                let steps = coasts as usize;
                let after = system.coasted(&end, steps);
                show_coast(system, &Instant { time, state: end }, (steps, after), observer);
            }
        }
        self.flights[i] = Some(flights);
    }

    /// The states at both ends of a flight, the latter before an impact.
    fn ends(&self, i: usize, flight: &Stretch<T::State>, system: &T::System) -> [State<T>; 2] {
        let Stretch { clock, from, h, later, hit, far, .. } = flight;
        let end = self.tier.with(
            i,
            from,
            #[inline(always)]
            |mass, from| mass.touching(&mass.nearly(from, *h), *hit, *far, *later),
        );
        let finish = clock.plus_parts(*h, *later);
        [self.tier.unload(from, system, *clock), self.tier.unload(&end, system, finish)]
    }
}

/// Keeps how many steps the lanes coast after their last flights.
pub(super) fn keep_coasts<S>(flights: &mut [Option<Vec<Stretch<S>>>], counts: &[f64]) {
    for (flights, count) in flights.iter_mut().zip(counts).filter(|(_, count)| **count > 0.0) {
        if let Some(flight) = flights.as_mut().and_then(|flights| flights.last_mut()) {
            flight.coasts = *count;
        }
    }
}
