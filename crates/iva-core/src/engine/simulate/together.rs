//! Runs with several absorbers on one structure.
//!
//! One absorber is at hand, and the bookkeeping of a run (its stick episode, its streak of impacts) is that one's; what is
//! known of the others waits. All absorbers move in one motion, which ends with the first event of any of them. Impacts
//! at one instant are resolved at once, in no order: the impact law takes all absorbers that touch their walls and
//! approach them. Whatever an event does to the others, such as pulling a stuck absorber off its wall, is decided after
//! it for each in turn.

use super::{Run, is_finite, presses};
use crate::absorber::chatter::{Rebound, is_nothing};
use crate::absorber::{Absorber, Clock, Hop};
use crate::engine::counts::{Counts, Streak};
use crate::engine::observe::{Observer, StickEpisode};
use crate::engine::tally::{OfAbsorber, Tally};
use crate::number::real::Real;
use crate::segment::contact::{Stretch, first_contact, first_release};
use crate::segment::flight::{Curve, Motion, Side};
use crate::segment::slide::{Ends, Slide, Slip};

/// A rebound this slow, in units of 2⁻⁵² of the velocities of the structure, is none.
const SLOWEST_ULPS: f64 = 4.0;

/// What a run keeps of an absorber that is not at hand.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Waiting<R> {
    /// The stick episode that it is in.
    riding: Option<StickEpisode<R>>,
    /// Its streak, in which impacts are numbered among its own.
    streak: Streak<R>,
    /// Number of its listed impacts.
    impacts: f64,
    /// Its other sums.
    own: Own<R>,
    /// Its largest impulse, over the mass of the structure.
    impulse: R,
}

/// Sums of one absorber, or of all.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Own<R> {
    effective: f64,
    episodes: u64,
    time_stuck: R,
    losses: Clock<R>,
    /// The largest approach speed on each wall.
    approach_speeds: [R; 2],
}

impl<R: Real> Own<R> {
    /// With what has come to the sums of all absorbers since an instant.
    fn grown(&self, [since, now]: [&Self; 2]) -> Self {
        Self {
            effective: self.effective + (now.effective - since.effective),
            episodes: self.episodes + (now.episodes - since.episodes),
            time_stuck: self.time_stuck + (now.time_stuck - since.time_stuck),
            losses: self.losses + (now.losses - since.losses),
            approach_speeds: now.approach_speeds,
        }
    }
}

impl<R: Real> Waiting<R> {
    /// Those of several absorbers; none for a single one.
    pub fn all(absorbers: usize) -> Vec<Self> {
        if absorbers > 1 { vec![Self::default(); absorbers] } else { Vec::new() }
    }
}

/// What ends a motion.
#[derive(Debug, Clone, Copy)]
enum Ending<R> {
    Contact(Side),
    /// A stuck absorber leaves its wall.
    Release,
    /// An absorber that rubs stops in its gap.
    Stop,
    /// Friction no longer holds an absorber, which slides off with this sign of its gap velocity.
    Slip(R),
}

/// The first event of an absorber in a motion, if there is one.
struct First<R> {
    ending: Option<Ending<R>>,
    at: R,
    undecided: u64,
}

impl<'a, R: Real, S: Absorber<Real = R>, O: Observer<S>> Run<'a, S, O> {
    /// Takes another absorber at hand.
    pub(crate) fn turn_to(&mut self, absorber: usize) {
        let at_hand = self.system.at_hand(&self.tally.state);
        if absorber == at_hand {
            return;
        }
        let counts = &self.progress.counts;
        let renumbered = |streak: Streak<R>, by: f64| Streak {
            listed_before: streak.listed_before + by,
            ..streak
        };
        let (streak, impacts) =
            (renumbered(counts.streak, -self.others), counts.impacts - self.others);
        let (own, riding) = (self.own(), self.riding.take());
        let impulse = self.waiting[at_hand].impulse;
        self.waiting[at_hand] = Waiting { riding, streak, impacts, own, impulse };
        let Waiting { riding, streak, impacts, own, .. } = self.waiting[absorber];
        let counts = &mut self.progress.counts;
        self.others = counts.impacts - impacts;
        (self.riding, counts.streak) = (riding, renumbered(streak, self.others));
        counts.approach_speeds = own.approach_speeds;
        self.since = self.sums();
        let undecided =
            |(k, it): (usize, &Waiting<R>)| if k == absorber { 0.0 } else { it.streak.low };
        let undecided: f64 = self.waiting.iter().enumerate().map(undecided).sum();
        // The low rebounds of all absorbers wait for the decision whether they count, not those of the one at hand alone.
        self.progress.max_impacts = self.limits.max_impacts as f64 + undecided;
        self.system.take_at_hand(&mut self.tally.state, absorber);
    }

    /// The sums of all absorbers, with the approach speeds of the one at hand.
    fn sums(&self) -> Own<R> {
        let Counts { effective, losses, approach_speeds, .. } = self.progress.counts;
        let Tally { episodes, time_stuck, .. } = self.tally;
        Own { effective, episodes, time_stuck, losses, approach_speeds }
    }

    /// The sums of the absorber at hand.
    fn own(&self) -> Own<R> {
        let at_hand = self.system.at_hand(&self.tally.state);
        self.waiting[at_hand].own.grown([&self.since, &self.sums()])
    }

    /// Tells the observer what the run has come to for each absorber, at its end.
    pub(super) fn tell_each(&mut self) {
        let counts = &self.progress.counts;
        let at_hand = self.system.at_hand(&self.tally.state);
        let mine = Waiting {
            impacts: counts.impacts - self.others,
            own: self.own(),
            ..self.waiting[at_hand]
        };
        let all = self.waiting.iter().enumerate();
        let all = all.map(|(k, it)| if k == at_hand { mine } else { *it });
        let each: Vec<OfAbsorber<R>> = all
            .map(|Waiting { impacts, own, impulse, .. }| OfAbsorber {
                impacts: impacts as u64,
                effective_impacts: own.effective as u64,
                episodes: own.episodes,
                approach_speeds: own.approach_speeds,
                time_stuck: own.time_stuck,
                energy_impacts: own.losses.value,
                impulse,
            })
            .collect();
        self.progress.counts.approach_speeds = [0, 1].map(|wall| {
            let speeds = each.iter().map(|it| it.approach_speeds[wall]);
            speeds.fold(R::ZERO, R::larger)
        });
        self.observer.absorbers(&each);
    }

    /// True if an absorber touches its wall and approaches it.
    fn strikes(&self, absorber: usize, state: &S::State) -> bool {
        let [distance, rate] = self.system.approach_of(state, absorber);
        distance == 0.0 && rate < 0.0
    }

    /// True if an absorber is in a stick episode.
    fn rides(&self, absorber: usize) -> bool {
        if absorber == self.system.at_hand(&self.tally.state) {
            return self.riding.is_some();
        }
        self.waiting[absorber].riding.is_some()
    }

    /// Decides what absorbers do that start at their walls.
    pub(super) fn begin_together(&mut self) {
        for absorber in 0..self.system.absorbers() {
            self.system.take_at_hand(&mut self.tally.state, absorber);
            self.tally.state = self.system.freed(&self.tally.state);
        }
        self.system.take_at_hand(&mut self.tally.state, 0);
        self.settle();
        self.coast();
    }

    /// One stretch of motion, ended by its length, the first event of an absorber, or the end of the run.
    pub(super) fn move_together(&mut self, remaining: R) -> bool {
        let system = self.system;
        if (0..system.absorbers()).any(|absorber| self.strikes(absorber, &self.tally.state)) {
            // As a stretch of no length, so that a run of impacts at one instant has an end.
            self.progress.counts.work += 1.0;
            self.strike_all();
            return true;
        }
        if let Some(Hop { time, absorber, end }) = system.hop(&self.tally.state, remaining) {
            let hop = system.hopping(&self.tally.state, time);
            self.turn_to(absorber);
            self.arrive(&hop, [time, R::ZERO], &system.turned_to(&end, absorber), false);
            self.meet(Side::Near);
            return true;
        }
        let remaining = self.coasted_first(remaining);
        let at_hand = system.at_hand(&self.tally.state);
        let mut flight = system.flight(&self.tally.state);
        let length = flight.reach().min(self.progress.ahead());
        let reached = R::FAST_PATHS.then(|| flight.ahead(length));
        let clears = |flight: &S::Flight<'_>| {
            reached.as_ref().is_some_and(|reached| flight.clears(length, reached))
        };
        let mut end = length;
        let mut met: Option<(usize, Ending<R>)> = None;
        let mut undecided = 0;
        for absorber in 0..system.absorbers() {
            system.turn(&mut flight, absorber);
            if clears(&flight) {
                continue;
            }
            if let Some((at, side)) = reached.as_ref().and_then(|it| flight.meets(length, it)) {
                if at < end {
                    (end, met) = (at, Some((absorber, Ending::Contact(side))));
                }
                continue;
            }
            if !is_finite(&flight.first(), flight.fourth()) {
                return false;
            }
            let Some(first) = self.first_event(&flight, end) else { return false };
            undecided += first.undecided;
            if let Some(ending) = first.ending {
                (end, met) = (first.at, Some((absorber, ending)));
            }
        }
        if undecided > 0 && met.is_some() {
            // Grazings after the event were counted as well.
            undecided = 0;
            for absorber in 0..system.absorbers() {
                system.turn(&mut flight, absorber);
                if clears(&flight) {
                    continue;
                }
                let first = self.first_event(&flight, end);
                undecided += first.map_or(0, |first| first.undecided);
            }
        }
        self.tally.undecided += undecided;
        let absorber = met.map_or(at_hand, |(absorber, _)| absorber);
        self.turn_to(absorber);
        system.turn(&mut flight, absorber);
        let arrived = match reached.as_ref().filter(|_| met.is_none()) {
            Some(ahead) => flight.completed(end, ahead),
            None => flight.arrival(end),
        };
        self.advance_to(&flight, end, &arrived, length == remaining);
        self.rub(flight.origin(), end);
        let Some((_, ending)) = met else {
            self.coast_after();
            return true;
        };
        match ending {
            Ending::Contact(side) => self.meet(side),
            Ending::Release => return self.release(&flight, end),
            Ending::Stop => {
                self.stop();
                self.settle();
            }
            Ending::Slip(direction) => {
                let ride = system.ride(flight.origin());
                if !self.slip(&ride, end, direction) {
                    return false;
                }
                self.settle();
            }
        }
        true
    }

    /// The first event of the absorber at hand within a length; `None` if its bounds are not finite.
    fn first_event(&self, flight: &S::Flight<'a>, length: R) -> Option<First<R>> {
        let (system, from) = (self.system, flight.origin());
        let of = |stretch: &Stretch<R>, ending: Option<Ending<R>>| First {
            ending,
            at: stretch.end,
            undecided: stretch.undecided,
        };
        if system.is_stuck(from) {
            let stretch = first_release(flight, length);
            return Some(of(&stretch, stretch.contact.map(|_| Ending::Release)));
        }
        if system.is_held(from) {
            let Slip { h, direction, undecided } = system.first_slip(&system.ride(from), length);
            return Some(First { ending: direction.map(Ending::Slip), at: h, undecided });
        }
        if system.rubs(system.at_hand(from)) {
            let Slide { h, ends, undecided } = system.slide(flight, length)?;
            let ending = match ends {
                Ends::Length => None,
                Ends::Wall(side) => Some(Ending::Contact(side)),
                Ends::Stop => Some(Ending::Stop),
            };
            return Some(First { ending, at: h, undecided });
        }
        let wide = system.half_play_of(system.at_hand(from));
        let stretch = first_contact(flight, wide, length);
        Some(of(&stretch, stretch.contact.map(Ending::Contact)))
    }

    /// The impacts of all absorbers that touch their walls and approach them, and what follows.
    pub(super) fn strike_all(&mut self) {
        let mut before = self.tally.state;
        let first = self.system.strikes_first(&before);
        for absorber in 0..self.system.absorbers() {
            if self.strikes(absorber, &before) && first.is_none_or(|it| it == absorber) {
                self.system.take_at_hand(&mut before, absorber);
                self.strike_by(absorber, &before);
            }
        }
        self.settle();
    }

    /// The impact of one absorber from a state in contact, in which it is at hand.
    fn strike_by(&mut self, absorber: usize, before: &S::State) {
        self.turn_to(absorber);
        let impact = self.strike(before);
        let impulse = self.system.impulse_of(&impact);
        self.waiting[absorber].impulse = R::larger(self.waiting[absorber].impulse, impulse);
    }

    /// After an event: frees absorbers that do not press on their walls any more, and lets those that touch a wall leave
    /// it, go on in their chatter, or stick. One that approaches its wall has an impact next.
    ///
    /// A mass that rubs and leaves its wall pulls at the structure otherwise than before, so that all are asked again.
    pub(super) fn settle(&mut self) {
        let mut asked = 0;
        while self.settle_each() && self.rubs && asked < self.system.absorbers() {
            asked += 1;
        }
        self.tell_slips();
    }

    /// Asks each absorber once; true if one has left its wall.
    fn settle_each(&mut self) -> bool {
        let mut left = false;
        let mut pressing = self.system.surely_pressing(&self.tally.state);
        for absorber in 0..self.system.absorbers() {
            if self.rides(absorber) {
                if pressing >> absorber & 1 == 1 {
                    continue;
                }
                self.turn_to(absorber);
                let state = self.tally.state;
                if self.system.is_stuck(&state) && presses(&self.system.distance(&state)) {
                    continue;
                }
                self.tally.state = self.system.freed(&state);
                self.let_go();
                left = true;
                pressing = self.system.surely_pressing(&self.tally.state);
            }
            let [distance, rate] = self.system.approach_of(&self.tally.state, absorber);
            if distance == 0.0 && rate >= 0.0 {
                self.turn_to(absorber);
                self.leave_or_stick();
            }
        }
        left
    }

    /// Ends the stick episodes of the absorbers that a release has freed.
    pub(super) fn let_go_all(&mut self) {
        for absorber in 0..self.system.absorbers() {
            if !self.rides(absorber) {
                continue;
            }
            self.turn_to(absorber);
            if !self.system.is_stuck(&self.tally.state) {
                self.let_go();
            }
        }
        self.tell_slips();
    }

    /// Closes the streaks and stick episodes of all absorbers at the end of the run.
    pub(super) fn end_all(&mut self) {
        for absorber in 0..self.system.absorbers() {
            self.turn_to(absorber);
            self.close();
        }
    }

    /// True if the whole tail of a chatter beside other absorbers, or with friction, is shorter than rounding of the clock, or beside another that may meet its wall meanwhile a
    /// rebound slower than rounding of the velocities. Such chatters are computed one by one where another absorber is in the way of their sum, or a restitution whose change is not
    /// bounded. Absorbers that chatter on each other, and with friction, have no sum.
    pub(super) fn has_ended(&self, rebound: &Rebound<R>) -> bool {
        let beside = self.system.absorbers() > 1 && rebound.is_short();
        let state = &self.tally.state;
        let slow = || rebound.speed <= self.system.speeds(state) * (R::EPSILON * SLOWEST_ULPS);
        // Two that chatter on each other, of which neither has a sum.
        if self.system.absorbers() > 1 && slow() && self.system.others_meet(state, rebound.tail()) {
            return true;
        }
        let short = |tail: R| is_nothing(tail, self.progress.clock.value);
        match &rebound.back {
            Some(back) => short(back.longest(rebound)),
            None => beside && short(rebound.tail()),
        }
    }
}
