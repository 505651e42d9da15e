//! Absorbers that rub in their gap: slides, stops, and being held.
//!
//! A slide is a flight that ends with a contact or with a stop. From a stop the absorber goes on one way or the other, or
//! friction holds it until it slips off.

use super::{Instant, Run, is_finite};
use crate::absorber::{Absorber, Clock};
use crate::engine::observe::Observer;
use crate::number::real::Real;
use crate::segment::flight::{Curve, Motion, Side};
use crate::segment::slide::{Ends, Slide, Slip};

/// Length of the first search for the return from a stop in units of the time that it takes under constant acceleration.
const LOOK: f64 = 1.25;
/// Largest number of segments of a rebound that is computed only to list it.
const MOST: usize = 1000;

impl<'a, R: Real, S: Absorber<Real = R>, O: Observer<S>> Run<'a, S, O> {
    /// One segment of a slide, ended by its length, a contact, a stop or the end of the run.
    pub(super) fn slide(&mut self, remaining: R) -> bool {
        let (system, state) = (self.system, self.tally.state);
        let flight = system.flight(&state);
        if !is_finite(&flight.first(), flight.fourth()) {
            return false;
        }
        let length = flight.reach().min(self.progress.ahead());
        let Some(Slide { h, ends, undecided }) = system.slide(&flight, length) else {
            return false;
        };
        self.tally.undecided += undecided;
        self.advance(&flight, h, length == remaining);
        self.rub(&state, h);
        match ends {
            Ends::Length => {}
            Ends::Wall(side) => self.meet(side),
            Ends::Stop => self.stop(),
        }
        true
    }

    /// Counts what friction takes in the motion of this length that began in a state, and for how long it held absorbers.
    pub(super) fn rub(&mut self, from: &S::State, length: R) {
        if self.rubs {
            let rubbed = self.system.rubbed([from, &self.tally.state]);
            let count = f64::from(self.held.count_ones());
            let friction = &mut self.tally.friction;
            friction.energy = friction.energy.plus(rubbed);
            friction.time_held = friction.time_held.plus(length * count);
        }
    }

    /// Which absorbers friction holds.
    pub(super) fn held_now(&self) -> u64 {
        let (system, state) = (self.system, &self.tally.state);
        let all = if self.rubs { system.absorbers() } else { 0 };
        let held = |k: &usize| system.is_held(&system.turned_to(state, *k));
        (0..all).filter(held).map(|k| 1 << k).sum()
    }

    /// Tells of the absorbers that friction held before an event and does not hold any more.
    pub(super) fn tell_slips(&mut self) {
        let (system, before) = (self.system, self.held);
        self.held = self.held_now();
        for absorber in (0..64).filter(|k| (before & !self.held) >> k & 1 == 1) {
            let state = system.turned_to(&self.tally.state, absorber);
            let from = Instant { time: self.progress.clock, state };
            self.observer.slip(system, &from);
        }
    }

    /// Decides how an absorber goes on that has stopped in its gap.
    pub(super) fn stop(&mut self) {
        let before = self.tally.state;
        let (state, later) = self.system.stopped(&before);
        self.tally.state = state;
        self.progress = self.progress.later(Clock::new(later));
        self.tally.friction.stops += 1;
        self.progress.counts.streak.stops += 1.0;
        self.observer.stop(self.system, self.progress.clock.value, [&before, &state]);
        if self.system.is_held(&state) {
            self.tally.friction.holds += 1;
        } else if self.system.distance(&state).value == 0.0 {
            // It has stopped at a wall, within rounding.
            self.leave_or_stick();
        } else {
            self.progress.first = self.progress.first.min(self.first_return(&state));
        }
        self.tell_slips();
    }

    /// Length of the first search for the wall last touched, from a stop on.
    fn first_return(&self, state: &S::State) -> R {
        let leave = self.system.distance(state);
        if leave.curvature < 0.0 {
            (leave.value * -2.0 / leave.curvature).sqrt() * LOOK
        } else {
            R::INFINITY
        }
    }

    /// One segment of being held, ended by its length, the slip or the end of the run.
    pub(super) fn hold(&mut self, remaining: R) -> bool {
        let (system, state) = (self.system, self.tally.state);
        let ride = system.ride(&state);
        if !is_finite(&ride.first(), ride.fourth()) {
            return false;
        }
        let length = ride.reach().min(remaining);
        let (held, slips) = if ride.stays_positive() {
            (length, None)
        } else {
            let Slip { h, direction, undecided } = system.first_slip(&ride, length);
            self.tally.undecided += undecided;
            (h, direction)
        };
        self.advance(&ride, held, length == remaining);
        self.rub(&state, held);
        match slips {
            Some(direction) => self.slip(&ride, held, direction),
            None => true,
        }
    }

    /// Lets an absorber slide off that friction has held in a ride of this length; false if the state is not at a slip.
    pub(super) fn slip(&mut self, ride: &S::Ride<'a>, held: R, direction: R) -> bool {
        let system = self.system;
        // Where the force jumps or has an impulse at the slip, that decides how the absorber goes on.
        if self.due().is_some() {
            return true;
        }
        let Some((state, later)) = system.slipped(ride, &self.tally.state, direction) else {
            return false;
        };
        if !(later >= -held && later <= ride.reach()) {
            return false;
        }
        self.tally.state = state;
        self.progress = self.progress.later(Clock::new(later));
        self.tally.friction.time_held = self.tally.friction.time_held.plus(later);
        self.tell_slips();
        true
    }

    /// The contact in which a low rebound ends that begins in a state, and the time until then; `None` if the absorber does not
    /// return to its wall at once.
    pub(super) fn slid_back(&self, state: &S::State) -> Option<(S::State, Clock<R>)> {
        let system = self.system;
        let (mut state, mut clock) = (*state, Clock::<R>::ZERO);
        let leave = system.distance(&state);
        let mut look = -leave.rate * 2.0 / leave.curvature;
        for _ in 0..MOST {
            let flight = system.flight(&state);
            let Slide { h, ends, .. } = system.slide(&flight, flight.reach().min(look))?;
            let there = flight.arrival(h);
            let (after, later) = match ends {
                Ends::Length => (there, R::ZERO),
                Ends::Stop => system.stopped(&there),
                Ends::Wall(Side::Near) => system.touch(&there, system.wall(&there)),
                Ends::Wall(Side::Far) => return None,
            };
            (state, clock) = (after, clock.plus(h).plus(later));
            match ends {
                Ends::Wall(_) => return Some((state, clock)),
                Ends::Stop if system.is_held(&state) => return None,
                Ends::Stop => look = self.first_return(&state),
                Ends::Length => {}
            }
        }
        None
    }
}
