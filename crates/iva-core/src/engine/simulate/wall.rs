//! Events at a wall: impact, chatter, stick, and leaving the wall.

use super::{CANCEL_EVERY, Instant, Outcome, Run, is_finite};
use crate::absorber::chatter::{Rebound, first_search};
use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Clock, LawAt};
use crate::engine::counts::{Counted, Streak};
use crate::engine::observe::{Contact, Observer, StickEpisode};
use crate::host::Excitation;
use crate::number::real::Real;
use crate::segment::contact::first_contact;
use crate::segment::flight::Side;
use crate::segment::flight::{Curve, Jet, Motion};

impl<R: Real, S: Absorber<Real = R>, O: Observer<S>> Run<'_, S, O> {
    /// Applies the impact law to the state in contact, and decides what follows.
    pub(super) fn apply_impact(&mut self) {
        let before = self.tally.state;
        self.strike(&before);
        self.leave_or_stick();
    }

    /// Applies the impact law to a state in contact, and counts and lists the impact.
    pub(super) fn strike(&mut self, before: &S::State) -> Impact<R> {
        let (after, impact) = self.system.impact(before, self.progress.clock.value);
        let approach = impact.approach_speed();
        // With e = 1 and without friction no chatter dies out, so low impacts are listed immediately.
        let falls = self.law(before, approach).dies_out() || self.rubs(before);
        let dies_out = falls || approach == 0.0;
        let low = dies_out && approach <= self.progress.floor;
        let counted = Counted { low, ..Counted::from(&impact) };
        self.progress = self.progress.struck(true, &counted);
        self.tally.state = after;
        self.list(&impact, [before, &after], false);
        impact
    }

    /// The impact law of the absorber at hand at its wall.
    fn law(&self, state: &S::State, approach: R) -> LawAt<R> {
        let system = self.system;
        system.law_of(system.at_hand(state), system.wall(state), approach)
    }

    /// True if the absorber at hand rubs in its gap.
    fn rubs(&self, state: &S::State) -> bool {
        self.system.rubs(self.system.at_hand(state))
    }

    /// True if the absorber leaves its wall with a speed with which it can return.
    fn returns(&self, state: &S::State) -> bool {
        let speed = self.system.distance(state).rate;
        self.law(state, speed).rebound * speed > 0.0
    }

    fn list(&mut self, impact: &Impact<R>, states: [&S::State; 2], summed: bool) {
        self.observer.contact(self.system, &Contact { time: impact.time, states, summed });
        self.observer.impact(self.system, impact);
    }

    /// Leaves the wall, continues a chatter on it, or sticks to it.
    pub(super) fn leave_or_stick(&mut self) {
        let state = self.tally.state;
        let leave = self.system.distance(&state);
        if leave.rate > 0.0 {
            if leave.curvature < 0.0 {
                self.rebound(&state, &leave);
            }
        } else if presses(&leave) {
            self.stick(self.progress.clock);
        }
    }

    /// A rebound from a pressing wall: the rest of the chatter is summed where the sum is exact to rounding.
    fn rebound(&mut self, state: &S::State, leave: &Jet<R>) {
        let law = self.law(state, leave.rate);
        let mut rebound = Rebound {
            speed: leave.rate,
            pressure: -leave.curvature,
            jerk: leave.jerk,
            gain: law.pressure,
            fourth: R::ZERO,
            ratio: law.rebound,
            spread: law.spread,
            power: law.falling(),
            back: self.system.back(state),
        };
        // Tests first without D⁗, which is expensive: most rebounds are far too high, or one of several.
        let mut low = rebound.summable() && !self.system.others_touch(state);
        if low {
            let flight = self.system.flight(state);
            rebound.fourth = flight.fourth();
            // Over a structure at rest high rebounds are summable too; those that are listed are flown in one piece each.
            low = self.rubs(state) || rebound.first_search() <= flight.reach();
        }
        let stick_clock = self.progress.clock.plus(rebound.tail());
        let smooth = low && rebound.tail() < self.system.excitation().smooth_for(S::phase(state));
        let summable = smooth && rebound.summable();
        let ends = summable && stick_clock.minus(self.progress.stop) < 0.0;
        if ends && self.system.others_wait(state, rebound.tail()) {
            self.list_tail(*state, stick_clock.value);
            self.stick_after(stick_clock, &rebound);
        } else if self.has_ended(&rebound) {
            self.stick_after(self.progress.clock, &rebound);
        } else {
            // The return is expected after 2u/A; the search goes a little further.
            self.progress.first = self.progress.first.min(rebound.first_search());
            self.short = rebound.is_short() && rebound.is_low(self.system.clearance_at_hand(state));
        }
    }

    /// Lists the rebounds of a summed tail that are above the chatter floor. They are computed one by one
    /// beside the run, so that the motion does not depend on the floor.
    fn list_tail(&mut self, mut state: S::State, stick_time: R) {
        let mut clock = self.progress.clock;
        let begin = Contact { time: clock.value, states: [&state; 2], summed: true };
        self.observer.contact(self.system, &begin);
        while self.returns(&state) && self.progress.counts.listed() < self.progress.max_impacts {
            if (self.progress.counts.impacts as u64).is_multiple_of(CANCEL_EVERY)
                && self.is_cancelled()
            {
                return;
            }
            if self.rubs(&state) {
                let Some((touching, later)) = self.slid_back(&state) else { return };
                clock = clock + later;
                let (after, impact) = self.system.impact(&touching, clock.value.min(stick_time));
                if impact.approach_speed() <= self.progress.floor {
                    return;
                }
                self.list_summed(&impact, [&touching, &after]);
                self.tally.friction.stops += 1;
                state = after;
                continue;
            }
            let leave = self.system.distance(&state);
            let flight = self.system.flight(&state);
            if !is_finite(&flight.first(), flight.fourth()) {
                return;
            }
            let length = flight.reach().min(first_search(leave.rate, -leave.curvature));
            let wide = self.system.half_play_of(self.system.at_hand(&state));
            let stretch = first_contact(&flight, wide, length);
            if stretch.contact != Some(Side::Near) {
                return;
            }
            clock = clock.plus(stretch.end);
            let wall = self.system.wall(&state);
            let (touching, later) = self.system.touch(&flight.arrival(stretch.end), wall);
            clock = clock.plus(later);
            let (after, impact) = self.system.impact(&touching, clock.value.min(stick_time));
            if impact.approach_speed() <= self.progress.floor {
                return;
            }
            self.list_summed(&impact, [&touching, &after]);
            state = after;
        }
    }

    /// Counts and lists a rebound of a summed tail.
    fn list_summed(&mut self, impact: &Impact<R>, states: [&S::State; 2]) {
        let counts = &mut self.progress.counts;
        counts.impacts += 1.0;
        counts.effective += if impact.effective() { 1.0 } else { 0.0 };
        self.list(impact, states, true);
    }

    /// Begins a stick episode at the end of a tail, of whose energy friction takes a part.
    fn stick_after(&mut self, stick_clock: Clock<R>, rebound: &Rebound<R>) {
        let share = rebound.back.map_or(R::ZERO, |back| back.rubbed(rebound));
        self.stick_with(stick_clock, share);
    }

    /// Begins a stick episode on the wall that the absorber touches.
    pub(super) fn stick(&mut self, stick_clock: Clock<R>) {
        self.stick_with(stick_clock, R::ZERO);
    }

    fn stick_with(&mut self, stick_clock: Clock<R>, rubbed: R) {
        let wall = self.system.wall(&self.tally.state);
        let (state, mut loss) = self.system.stick(&self.tally.state);
        if rubbed > 0.0 {
            let friction = &mut self.tally.friction;
            friction.energy = friction.energy.plus(loss * rubbed);
            loss -= loss * rubbed;
        }
        let counts = &mut self.progress.counts;
        counts.losses = counts.losses.plus(loss);
        self.observer.stick(self.system, &Instant { time: stick_clock, state });
        self.tally.state = state;
        let absorber = self.system.at_hand(&self.tally.state) as u8;
        let mut episode = StickEpisode {
            absorber,
            wall,
            start_time: stick_clock.value,
            stick_time: stick_clock.value,
            release_time: None,
            impacts: 0,
            energy_loss: loss,
        };
        let counts = &mut self.progress.counts;
        let streak = std::mem::take(&mut counts.streak);
        if streak.side != 0.0 {
            self.unlist_low(absorber, &streak);
            episode.start_time = streak.start_time;
            episode.impacts = (self.progress.counts.impacts - streak.listed_before) as u64;
            episode.energy_loss += streak.energy_loss;
        }
        self.tally.episodes += 1;
        self.riding = Some(episode);
    }

    /// Removes the low rebounds of a streak from the list and the counts, and stops after the last one that stays.
    fn unlist_low(&mut self, absorber: u8, streak: &Streak<R>) {
        self.tally.friction.stops -= streak.stops as u64;
        if streak.low > 0.0 {
            let counts = &mut self.progress.counts;
            counts.impacts -= streak.low;
            counts.effective -= streak.low_effective;
            let first = (streak.listed_before - self.others) as u64;
            self.observer.unlist(absorber, first, self.progress.floor);
        }
    }

    /// Closes the streak and the stick episode of the absorber at hand at the end of the run. Where the run ends by its
    /// limit of impacts, low rebounds that wait for the decision whether they are listed are not.
    pub(super) fn close(&mut self) {
        if self.tally.outcome == Outcome::ImpactLimit {
            let streak = std::mem::take(&mut self.progress.counts.streak);
            self.unlist_low(self.system.at_hand(&self.tally.state) as u8, &streak);
        }
        self.end_episode(false);
    }

    /// Ends the current stick episode, by release or at the end of the run.
    pub(super) fn end_episode(&mut self, released: bool) {
        if let Some(mut episode) = self.riding.take() {
            let now = self.progress.clock.value;
            self.tally.time_stuck += (now - episode.stick_time).max(0.0);
            episode.release_time = released.then_some(now);
            self.observer.episode(&episode);
        }
    }
}

/// True if an absorber that touches a wall stays on it: decided by the sign of its velocity, then the
/// acceleration, then the jerk.
pub(crate) fn presses<R: Real>(leave: &Jet<R>) -> bool {
    let Jet { rate, curvature, jerk, .. } = *leave;
    rate <= 0.0 && (curvature < 0.0 || (curvature == 0.0 && jerk < 0.0))
}
