//! Coasting: steps of a flight too far from the walls to meet one.

use super::{Instant, Run};
use crate::absorber::{Absorber, Coasted};
use crate::engine::observe::{Observer, Span};
use crate::number::real::Real;

impl<R: Real, S: Absorber<Real = R>, O: Observer<S>> Run<'_, S, O> {
    /// Coasts before a flight, if flights at walls do so; the time that remains.
    pub(super) fn coasted_first(&mut self, remaining: R) -> R {
        if !S::LEAPS {
            return remaining;
        }
        self.coast();
        self.progress.remaining()
    }

    /// Coasts after a flight that met no wall, if the next does not do so by itself.
    pub(super) fn coast_after(&mut self) {
        if !S::LEAPS {
            self.coast();
        }
    }

    /// Lets an absorber that is too far from its walls to meet one fly on for some steps.
    pub(super) fn coast(&mut self) {
        let system = self.system;
        let coasts = system.coasts(&self.tally.state, self.progress.remaining());
        if let Some((count, end)) = coasts {
            let begin = Instant { time: self.progress.clock, state: self.tally.state };
            show_coast(system, &begin, (count, end), &mut self.observer);
            self.progress = self.progress.later(end.1);
            if S::LEAPS {
                // A step of a leap is a segment that a series would have taken.
                self.progress.counts.work += count as f64;
            }
            self.tally.state = end.0;
            self.rub(&begin.state, R::ZERO);
        }
    }
}

/// Shows an observer some steps of a coast from an instant on, with the state after them.
pub(crate) fn show_coast<'a, R: Real, S: Absorber<Real = R>, O: Observer<S>>(
    system: &'a S,
    begin: &Instant<S::State, R>,
    (count, end): (usize, Coasted<S::State, R>),
    observer: &mut O,
) {
    let later = |(state, by): Coasted<S::State, R>| Instant {
        time: begin.time.plus_parts(by.value, by.rest),
        state,
    };
    let end = later(end);
    let each = |see: &mut dyn FnMut(&Span<'_, S::Flight<'a>>)| {
        let mut from = *begin;
        for steps in 1..=count {
            let to = if steps == count {
                end
            } else if S::LEAPS {
                // In double-double a step from the one before is as exact as many at once, and one product.
                let (state, step) = system.coasted(&from.state, 1);
                later((state, step.times(S::Real::from(steps as f64))))
            } else {
                later(system.coasted(&begin.state, steps))
            };
            see(&Span::between(system, &system.flight(&from.state), [&from, &to]));
            from = to;
        }
    };
    let flight = system.flight(&begin.state);
    let whole = Span::between(system, &flight, [begin, &end]);
    observer.coast(system, &whole, &each);
}
