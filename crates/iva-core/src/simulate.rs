//! The event loop: flight → contact → impact → chatter or stick → release.
//!
//! It knows the absorber only as a [`System`] and whoever watches only as an [`Observer`].

use std::sync::atomic::{AtomicBool, Ordering};

use crate::chatter::Rebound;
use crate::contact::{Side, first_contact, first_release, free_stretch};
use crate::error::Invalid;
use crate::flight::{Curve, Jet, Motion};
use crate::impact::Impact;
use crate::observe::{Episode, Jump, Observer, Span};
use crate::real::{Real, ZERO};
use crate::system::{Clock, System, Wall};

pub use crate::limits::{Limits, Outcome, STOPS};

/// Counts and sums of a run, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally<State> {
    /// How it ended.
    pub outcome: Outcome,
    /// Listed impacts.
    pub impacts: u64,
    /// Listed impacts at which the masses moved towards each other.
    pub effective_impacts: u64,
    /// Chatters that ended in stick, plastic sticks, starts at rest on a pressed wall.
    pub episodes: u64,
    /// Grazing extrema within rounding of a wall, counted as no contact.
    pub undecided: u64,
    /// Total time on a wall.
    pub time_stuck: Real,
    /// Energy lost in all impacts, listed or summed.
    pub energy_impacts: Real,
    /// Instant at which the run ended, in 1/ωn.
    pub end_time: Real,
    /// Segments of flight and ride computed.
    pub work: u64,
    /// The last state.
    pub state: State,
}

/// Runs a system from a start and tells the observer what happens.
///
/// Numerics never fail: a run that cannot go on ends with its outcome and what it has.
///
/// # Errors
/// [`Invalid`] if the start does not lie in the gap or a limit is not usable.
pub fn simulate<S: System, O: Observer<S>>(
    system: &S,
    start: &S::Start,
    limits: &Limits,
    cancel: Option<&AtomicBool>,
    observer: &mut O,
) -> Result<Tally<S::State>, Invalid> {
    system.check_start(start)?;
    limits.check()?;
    let (state, touching) = system.begin(start);
    let mut run = Run {
        system,
        limits,
        cancel,
        observer,
        clock: Clock::ZERO,
        phase: Phase::Flight { first: Real::INFINITY },
        streak: None,
        riding: None,
        tally: Tally {
            outcome: Outcome::Finished,
            impacts: 0,
            effective_impacts: 0,
            episodes: 0,
            undecided: 0,
            time_stuck: ZERO,
            energy_impacts: ZERO,
            end_time: ZERO,
            work: 0,
            state,
        },
        losses: Clock::ZERO,
        stops: limits.stops(),
        stopped: 0,
    };
    run.observer.start(system, &state, limits.duration);
    if system.energy(&state).is_finite() {
        if touching {
            if system.distance(&state).rate < 0.0 {
                run.strike();
            } else {
                run.depart();
            }
        }
        run.until_end();
    } else {
        run.tally.outcome = Outcome::NotFinite;
    }
    Ok(run.finish())
}

/// What the absorber is doing; in flight, how far to look first.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Flight { first: Real },
    Ride,
}

/// Impacts on one wall in a row: what becomes an episode if it ends in stick.
#[derive(Debug, Clone, Copy)]
struct Streak {
    wall: Wall,
    start_time: Real,
    listed_before: u64,
    low: u64,
    low_effective: u64,
    energy_loss: Real,
}

struct Run<'a, S: System, O> {
    system: &'a S,
    limits: &'a Limits,
    cancel: Option<&'a AtomicBool>,
    observer: &'a mut O,
    clock: Clock,
    phase: Phase,
    streak: Option<Streak>,
    riding: Option<Episode>,
    tally: Tally<S::State>,
    losses: Clock,
    stops: [Real; STOPS],
    stopped: usize,
}

/// How often the loop looks whether it is to stop.
const CANCEL_EVERY: u64 = 1024;
/// How far a rebound is searched for its return, in u/A: that comes after 2u/A in the limit of low
/// rebounds, and what a higher one needs beyond this is one more segment.
const REBOUND_LOOK: f64 = 2.5;

impl<S: System, O: Observer<S>> Run<'_, S, O> {
    fn until_end(&mut self) {
        loop {
            let remaining = -self.clock.minus(self.stop());
            if remaining <= 0.0 {
                self.stopped += 1;
                if self.stopped < self.stops.len() {
                    continue;
                }
                self.tally.outcome = Outcome::Finished;
                return;
            }
            if self.listed() >= self.limits.max_impacts {
                self.tally.outcome = Outcome::ImpactLimit;
                return;
            }
            if self.tally.work >= self.limits.max_work {
                self.tally.outcome = Outcome::WorkLimit;
                return;
            }
            if self.tally.work.is_multiple_of(CANCEL_EVERY) && self.is_cancelled() {
                self.tally.outcome = Outcome::Cancelled;
                return;
            }
            self.tally.work += 1;
            if let Some(velocity) = self.system.due(&self.tally.state) {
                self.kick(velocity);
                continue;
            }
            let finite = match self.phase {
                Phase::Flight { first } => self.fly(remaining, first),
                Phase::Ride => self.ride(remaining),
            };
            if !finite {
                self.tally.outcome = Outcome::NotFinite;
                return;
            }
        }
    }

    /// The next instant that no stretch of motion runs across.
    fn stop(&self) -> Real {
        self.stops[self.stopped.min(STOPS - 1)]
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Impacts that are rows whatever follows: not the low rebounds of a chatter under way, which
    /// are taken back if it ends in stick.
    fn listed(&self) -> u64 {
        self.tally.impacts - self.streak.as_ref().map_or(0, |streak| streak.low)
    }

    /// One segment of free flight, ended by its length, a contact or the end of the run.
    fn fly(&mut self, remaining: Real, first: Real) -> bool {
        let system = self.system;
        let state = self.tally.state;
        let flight = system.flight(&state);
        let length = flight.reach().min(remaining).min(first);
        if let Some(stride) = system.stride(&state, length) {
            self.phase = Phase::Flight { first: Real::INFINITY };
            let whole = length == remaining && !stride.contact;
            self.arrive(&flight, [stride.length, stride.later], stride.end, whole);
            if stride.contact {
                self.strike();
            }
            return true;
        }
        if !is_finite(&flight.jet(&state), flight.fourth()) {
            return false;
        }
        let stretch = if system.walls_reachable() {
            first_contact(&flight, &state, system.clearance(), length)
        } else {
            free_stretch(&flight, length)
        };
        self.phase = Phase::Flight { first: Real::INFINITY };
        self.tally.undecided += stretch.undecided;
        self.advance(&flight, stretch.end.h, length == remaining);
        if let Some(side) = stretch.contact {
            let left = system.wall(&state);
            let wall = if side == Side::Near { left } else { left.opposite() };
            let (state, later) = system.touch(&self.tally.state, wall);
            self.tally.state = state;
            self.clock = self.clock.plus(later);
            self.strike();
        }
        true
    }

    /// One segment of riding on a wall, ended by its length, the release or the end of the run.
    fn ride(&mut self, remaining: Real) -> bool {
        let system = self.system;
        let state = self.tally.state;
        let ride = system.ride(&state);
        if !is_finite(&ride.jet(&state), ride.fourth()) {
            return false;
        }
        let length = ride.reach().min(remaining);
        let stretch = first_release(&ride, &state, length);
        self.tally.undecided += stretch.undecided;
        self.advance(&ride, stretch.end.h, length == remaining);
        if stretch.contact.is_some() {
            let (state, later) = system.release(&self.tally.state);
            self.tally.state = state;
            self.clock = self.clock.plus(later);
            self.observer.jump(system, &Jump::Release);
            self.end_episode(true);
            self.phase = Phase::Flight { first: Real::INFINITY };
        }
        true
    }

    fn advance<M>(&mut self, motion: &M, h: Real, to_the_end: bool)
    where
        M: Motion<State = S::State>,
    {
        let whole = to_the_end && h >= -self.clock.minus(self.stop());
        self.arrive(motion, [h, ZERO], motion.arrival(h), whole);
    }

    /// Ends a motion after a time given with what that lacks; `whole`: at the next stop.
    fn arrive<M>(&mut self, motion: &M, [h, later]: [Real; 2], end: S::State, whole: bool)
    where
        M: Motion<State = S::State>,
    {
        let finish = if whole { Clock::new(self.stop()) } else { self.clock.plus_parts(h, later) };
        let span = Span {
            motion,
            start: self.clock,
            length: h + later,
            from: self.system.primary(&self.tally.state),
            to: self.system.primary(&end),
            end: &end,
            finish,
        };
        self.observer.span(self.system, &span);
        self.clock = finish;
        self.tally.state = end;
    }

    /// An impulse from outside, or a jump of the force: what is stuck comes off if either pulls it
    /// from its wall, else both masses take the impulse together.
    fn kick(&mut self, velocity: Real) {
        let before = self.tally.state;
        let mut after = self.system.kick(&before, velocity, false);
        let riding = matches!(self.phase, Phase::Ride);
        if riding && self.system.distance(&after).rate <= 0.0 {
            after = self.system.kick(&before, velocity, true);
        }
        let [v_before, v_after] = [before, after].map(|state| self.system.primary(&state).v);
        self.observer.kick(self.system, &after, 0.5 * velocity * (v_before + v_after));
        self.tally.state = after;
        let leave = self.system.distance(&after);
        if riding {
            if !presses(&leave) {
                self.end_episode(true);
                self.phase = Phase::Flight { first: Real::INFINITY };
            }
        } else if leave.value > 0.0 {
            self.phase = Phase::Flight { first: Real::INFINITY };
        } else if leave.rate < 0.0 {
            self.strike();
        } else {
            self.depart();
        }
    }

    /// The impact law at the state in contact, then whatever follows.
    fn strike(&mut self) {
        let wall = self.system.wall(&self.tally.state);
        let (after, impact) = self.system.impact(&self.tally.state, self.clock.value);
        self.losses = self.losses.plus(impact.energy_loss);
        let streak = match &mut self.streak {
            Some(streak) if streak.wall == wall => streak,
            other => other.insert(Streak {
                wall,
                start_time: impact.time,
                listed_before: self.tally.impacts,
                low: 0,
                low_effective: 0,
                energy_loss: ZERO,
            }),
        };
        streak.energy_loss += impact.energy_loss;
        // With e = 1 nothing shrinks towards a stick: a low impact is a row at once.
        let dies_out = self.system.rebound_ratio() < 1.0 || impact.approach_speed() == 0.0;
        if dies_out && impact.approach_speed() <= self.limits.chatter_floor {
            streak.low += 1;
            streak.low_effective += u64::from(impact.effective());
        }
        let before = std::mem::replace(&mut self.tally.state, after);
        self.observer.jump(self.system, &Jump::Impact { before: &before, after: &after });
        self.list(&impact);
        self.depart();
    }

    fn list(&mut self, impact: &Impact) {
        self.tally.impacts += 1;
        self.tally.effective_impacts += u64::from(impact.effective());
        self.observer.impact(self.system, impact);
    }

    /// Leaves the wall, chatters on it or sticks to it.
    fn depart(&mut self) {
        let state = self.tally.state;
        let leave = self.system.distance(&state);
        if leave.rate > 0.0 {
            self.phase = Phase::Flight { first: Real::INFINITY };
            if leave.curvature < 0.0 {
                self.rebound(&state, &leave);
            }
        } else if presses(&leave) {
            self.stick(self.clock);
        } else {
            self.phase = Phase::Flight { first: Real::INFINITY };
        }
    }

    /// A rebound from a pressing wall: the rest of the chatter is summed where that is exact.
    fn rebound(&mut self, state: &S::State, leave: &Jet) {
        let rebound = Rebound {
            speed: leave.rate,
            pressure: -leave.curvature,
            jerk: leave.jerk,
            gain: self.system.pressure_gain(),
            fourth: self.system.flight(state).fourth(),
            ratio: self.system.rebound_ratio(),
        };
        let stick_clock = self.clock.plus(rebound.tail());
        let smooth = rebound.tail() < self.system.smooth_for(state);
        if smooth && rebound.summable() && stick_clock.minus(self.limits.duration) < 0.0 {
            self.list_tail(*state, stick_clock.value);
            self.stick(stick_clock);
        } else {
            // The return is expected after 2u/A: look a little further.
            self.phase = Phase::Flight { first: REBOUND_LOOK * leave.rate / rebound.pressure };
        }
    }

    /// Lists the rebounds of a summed tail that are above the floor, flown one by one beside the
    /// run: the motion does not depend on the floor.
    fn list_tail(&mut self, mut state: S::State, stick_time: Real) {
        let mut clock = self.clock;
        while self.system.rebound_ratio() * self.system.distance(&state).rate > 0.0
            && self.listed() < self.limits.max_impacts
        {
            if self.tally.impacts.is_multiple_of(CANCEL_EVERY) && self.is_cancelled() {
                return;
            }
            let leave = self.system.distance(&state);
            let flight = self.system.flight(&state);
            if !is_finite(&flight.jet(&state), flight.fourth()) {
                return;
            }
            let length = flight.reach().min(-REBOUND_LOOK * leave.rate / leave.curvature);
            let stretch = first_contact(&flight, &state, self.system.clearance(), length);
            if stretch.contact != Some(Side::Near) {
                return;
            }
            clock = clock.plus(stretch.end.h);
            let wall = self.system.wall(&state);
            let (touching, later) = self.system.touch(&flight.arrival(stretch.end.h), wall);
            clock = clock.plus(later);
            let (after, impact) = self.system.impact(&touching, clock.value.min(stick_time));
            if impact.approach_speed() <= self.limits.chatter_floor {
                return;
            }
            self.list(&impact);
            state = after;
        }
    }

    /// Begins an episode: the absorber rides on the wall it touches.
    fn stick(&mut self, stick_clock: Clock) {
        let wall = self.system.wall(&self.tally.state);
        let (state, loss) = self.system.stick(&self.tally.state);
        self.losses = self.losses.plus(loss);
        self.observer.jump(self.system, &Jump::Stick);
        self.tally.state = state;
        let mut episode = Episode {
            wall,
            start_time: stick_clock.value,
            stick_time: stick_clock.value,
            release_time: None,
            impacts: 0,
            energy_loss: loss,
        };
        if let Some(streak) = self.streak.take() {
            self.tally.impacts -= streak.low;
            self.tally.effective_impacts -= streak.low_effective;
            if streak.low > 0 {
                self.observer.unlist(streak.listed_before, self.limits.chatter_floor);
            }
            episode.start_time = streak.start_time;
            episode.impacts = self.tally.impacts - streak.listed_before;
            episode.energy_loss += streak.energy_loss;
        }
        self.tally.episodes += 1;
        self.riding = Some(episode);
        self.phase = Phase::Ride;
    }

    /// Ends the episode under way, by release or by the end of the run.
    fn end_episode(&mut self, released: bool) {
        if let Some(mut episode) = self.riding.take() {
            let now = self.clock.value;
            self.tally.time_stuck += (now - episode.stick_time).max(0.0);
            episode.release_time = released.then_some(now);
            self.observer.episode(&episode);
        }
    }

    fn finish(mut self) -> Tally<S::State> {
        self.end_episode(false);
        self.tally.end_time = self.clock.value;
        self.tally.energy_impacts = self.losses.value;
        self.observer.end(self.system, &self.tally);
        self.tally
    }
}

/// True if what touches a wall does not leave it: the sign of its velocity decides, then the
/// acceleration, then the jerk.
fn presses(leave: &Jet) -> bool {
    let Jet { rate, curvature, jerk, .. } = *leave;
    rate <= 0.0 && (curvature < 0.0 || (curvature == 0.0 && jerk < 0.0))
}

fn is_finite(jet: &Jet, fourth: Real) -> bool {
    jet.value.is_finite() && jet.rate.is_finite() && fourth.is_finite()
}
