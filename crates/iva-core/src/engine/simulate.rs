//! The event loop: flight → contact → impact → chatter or stick → release.
//!
//! With friction a flight also ends where the absorber stops in its gap, from where it slides back or is held for a while
//! (`engine/simulate/slide.rs`). A run with one absorber goes on by `fly` and `ride`, one with several by `move_together` (`engine/simulate/together.rs`).
//!
//! It knows the absorber only as an [`Absorber`] and its observers only as an [`Observer`].

use std::sync::atomic::{AtomicBool, Ordering};

use crate::absorber::{Absorber, Clock};
use crate::engine::counts::Counts;
use crate::engine::observe::{Observer, Span, StickEpisode};
use crate::engine::progress::Progress;
use crate::error::{Invalid, number};
use crate::host::Excitation;
use crate::number::real::Real;
use crate::segment::contact::{first_contact, first_release};
use crate::segment::flight::Side;
use crate::segment::flight::{Curve, FastFlight, Jet, Meets, Motion};

pub use crate::engine::limits::{Limits, Outcome};
pub use crate::engine::tally::{Instant, OfAbsorber, Rubbed, Tally};
use together::{Own, Waiting};
use wall::presses;

mod coast;
mod slide;
mod together;
pub(crate) mod wall;

pub(crate) use coast::show_coast;

/// Runs a system from a start and notifies the observer of every event.
///
/// Numerical trouble is no error: a run that cannot go on ends with its outcome and the results so far.
///
/// # Errors
/// [`Invalid`] if the start does not lie in the gap or a limit is not usable.
pub fn simulate<R: Real, S: Absorber<Real = R>, O: Observer<S>>(
    system: &S,
    start: &S::Start,
    limits: &Limits<R>,
    cancel: Option<&AtomicBool>,
    observer: &mut O,
) -> Result<Tally<S::State, R>, Invalid> {
    simulate_from(system, start, R::ZERO, limits, cancel, observer)
}

/// [`simulate`] from a start at an instant other than zero, in 1/ωn: the drive is evaluated on the same
/// clock, on which `limits.duration` is the end of the run.
///
/// # Errors
/// As [`simulate`], and if the run would end before it begins.
pub fn simulate_from<R: Real, S: Absorber<Real = R>, O: Observer<S>>(
    system: &S,
    start: &S::Start,
    time: R,
    limits: &Limits<R>,
    cancel: Option<&AtomicBool>,
    observer: &mut O,
) -> Result<Tally<S::State, R>, Invalid> {
    system.check_start(start)?;
    resume(system, &Instant::at(system, start, time), limits, cancel, observer)
}

/// Goes on from an instant of a run, to `limits.duration` on the same clock; `tally` counts from there.
///
/// A state at rest that touches its wall sticks if it presses on it; otherwise it leaves the wall or has an
/// impact. A stick episode that is divided in two counts as two, the second from the division on. Impacts of
/// a chatter that an earlier run has listed stay listed if the chatter ends in stick here. Observers see the
/// motion from the instant on: [`crate::measures`] of a decay are defined for runs from time zero, the window
/// of [`crate::measures::steady`] begins no earlier than the run, and samples before it are left out. A run that was
/// stopped between the sum of a chatter and its stick goes on stuck: `time_stuck` of both parts then includes
/// the rest of the chatter. The state is not checked to lie in the gap.
///
/// # Errors
/// [`Invalid`] if a limit is not usable, or does not lie after the instant.
pub fn resume<S: Absorber, O: Observer<S>>(
    system: &S,
    from: &Instant<S::State, S::Real>,
    limits: &Limits<S::Real>,
    cancel: Option<&AtomicBool>,
    observer: &mut O,
) -> Result<Tally<S::State, S::Real>, Invalid> {
    limits.check()?;
    let before = from.time.minus(limits.duration) < 0.0;
    if !before {
        let rule =
            format!("give more than {}, the instant that it goes on from", number(from.time.value));
        return Err(Invalid::new("run.duration", number(limits.duration), rule));
    }
    let mut run = Run::new(system, from, limits, cancel, observer);
    run.begin();
    while run.step() {}
    Ok(run.finish())
}

/// A run in progress.
pub(crate) struct Run<'a, S: Absorber, O> {
    pub system: &'a S,
    pub limits: &'a Limits<S::Real>,
    pub cancel: Option<&'a AtomicBool>,
    pub observer: O,
    pub progress: Progress<S::Real>,
    /// The stick episode that the run is in; `None` in flight.
    pub riding: Option<StickEpisode<S::Real>>,
    pub tally: Tally<S::State, S::Real>,
    /// True once the end of the run is reached, or if its start is not finite.
    pub ended: bool,
    /// True if the run starts at a wall.
    touching: bool,
    /// True at the begin of a rebound so short and low that it is searched from the wall on, in one piece.
    short: bool,
    /// What is kept of each absorber while another one is at hand; empty for a single absorber.
    waiting: Vec<Waiting<S::Real>>,
    /// Number of listed impacts of all absorbers but the one at hand.
    others: f64,
    /// The sums of all absorbers when the one at hand was taken at hand.
    since: Own<S::Real>,
    /// True if an absorber rubs.
    rubs: bool,
    /// Which absorbers friction holds, a bit each, as observers know it.
    held: u64,
}

/// Number of segments between two checks of the cancel flag.
const CANCEL_EVERY: u64 = 1024;
/// Largest pressure at a release, in units of 2⁻⁵² of the terms that cancel in it. A state with more is not
/// at a release, and the run ends as `not_finite`.
const PRESSURE_ULPS: f64 = 1024.0;

impl<S: Absorber, O> Run<'_, S, O> {
    /// True if the run is in a flight that a lane can take over. Low impacts of a streak wait for the decision whether
    /// they are listed, short rebounds for their search.
    pub(crate) fn is_for_lanes(&self) -> bool {
        let Self { progress, .. } = self;
        let flies = !self.ended && self.riding.is_none();
        let decided = progress.counts.streak.low == 0.0;
        flies && decided && !self.short && progress.remaining() > 0.0 && !progress.is_full()
    }

    /// Ends the run at its whole duration.
    pub(crate) fn reach_end(&mut self) {
        self.ended = true;
        self.progress.clock = Clock::new(self.progress.stop);
    }
}

impl<'a, R: Real, S: Absorber<Real = R>, O: Observer<S>> Run<'a, S, O> {
    /// A run that has not begun.
    pub(crate) fn new(
        system: &'a S,
        from: &Instant<S::State, R>,
        limits: &'a Limits<R>,
        cancel: Option<&'a AtomicBool>,
        observer: O,
    ) -> Self {
        let Instant { time, state } = *from;
        Self {
            system,
            limits,
            cancel,
            observer,
            touching: system.distance(&state).value == 0.0,
            progress: Progress::new(time, limits),
            riding: None,
            tally: Tally {
                outcome: Outcome::Finished,
                impacts: 0,
                effective_impacts: 0,
                episodes: 0,
                undecided: 0,
                approach_speeds: [R::ZERO; 2],
                time_stuck: R::ZERO,
                energy_impacts: R::ZERO,
                friction: Rubbed::default(),
                end_time: R::ZERO,
                work: 0,
                state,
                clock: time,
            },
            ended: false,
            short: false,
            waiting: Waiting::all(system.absorbers()),
            others: 0.0,
            since: Own::default(),
            rubs: (0..system.absorbers()).any(|absorber| system.rubs(absorber)),
            held: 0,
        }
    }

    /// Handles the start: notifies the observer, and applies an impact or a stick at a wall.
    pub(crate) fn begin(&mut self) {
        let (system, state) = (self.system, self.tally.state);
        let from = Instant { time: self.progress.clock, state };
        self.observer.start(system, &from, self.limits.duration);
        self.held = self.held_now();
        if !system.energy(&state).is_finite() {
            self.tally.outcome = Outcome::NotFinite;
            self.ended = true;
        } else if self.system.absorbers() > 1 {
            self.begin_together();
        } else if self.touching {
            if system.distance(&state).rate < 0.0 {
                self.apply_impact();
            } else {
                self.leave_or_stick();
            }
        } else {
            self.coast();
        }
    }

    /// Advances by one stretch of motion; false if the run has ended.
    pub(crate) fn step(&mut self) -> bool {
        let remaining = self.progress.remaining();
        if remaining <= 0.0 {
            // An impact has come at the instant of the end.
            self.reach_end();
        }
        if self.ended {
            return false;
        }
        let work = self.progress.counts.work as u64;
        let stopped = || {
            // Leaps count many segments at once, so that no multiple may come.
            let asks = S::LEAPS || work.is_multiple_of(CANCEL_EVERY);
            if asks && self.is_cancelled() {
                Some(Outcome::Cancelled)
            } else {
                self.observer.is_done().then_some(Outcome::Stopped)
            }
        };
        if let Some(outcome) = self.progress.limit().or_else(stopped) {
            self.tally.outcome = outcome;
            return false;
        }
        if let Some(velocity) = self.due() {
            self.impulse(velocity);
            return true;
        }
        let finite = if self.system.absorbers() > 1 {
            self.move_together(remaining)
        } else if self.riding.is_some() {
            self.ride(remaining)
        } else {
            self.fly(remaining)
        };
        if !finite {
            self.tally.outcome = Outcome::NotFinite;
        }
        finite
    }

    /// P/M of the impulse that is due, if one is.
    fn due(&self) -> Option<R> {
        self.system.excitation().due(S::phase(&self.tally.state))
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// One segment of free flight, ended by its length, a contact or the end of the run.
    fn fly(&mut self, remaining: R) -> bool {
        let system = self.system;
        let remaining = self.coasted_first(remaining);
        let state = self.tally.state;
        if system.rubs(system.at_hand(&state)) {
            return if system.is_held(&state) {
                self.hold(remaining)
            } else {
                self.slide(remaining)
            };
        }
        let flight = system.flight(&state);
        let length = flight.reach().min(self.progress.ahead());
        let fast = if std::mem::take(&mut self.short) { None } else { flight.fast_path(length) };
        if let Some(FastFlight { length: h, later, end, meets }) = fast {
            self.arrive(&flight, [h, later], &end, h == remaining && meets == Meets::Nothing);
            match meets {
                Meets::Nothing => self.coast_after(),
                Meets::Wall => self.apply_impact(),
                Meets::Near(side) => self.meet(side),
            }
            return true;
        }
        if !is_finite(&flight.first(), flight.fourth()) {
            return false;
        }
        let (mut end, mut contact) = (length, None);
        if system.walls_reachable() {
            let stretch = first_contact(&flight, system.half_play_of(0), length);
            self.tally.undecided += stretch.undecided;
            (end, contact) = (stretch.end, stretch.contact);
        }
        self.advance(&flight, end, length == remaining);
        match contact {
            Some(side) => self.meet(side),
            None => self.coast_after(),
        }
        true
    }

    /// Applies the contact with a wall that the state has reached within rounding.
    pub(crate) fn meet(&mut self, side: Side) {
        let left = self.system.wall(&self.tally.state);
        let wall = if side == Side::Near { left } else { left.opposite() };
        let (state, later) = self.system.touch(&self.tally.state, wall);
        self.tally.state = state;
        self.progress = self.progress.later(Clock::new(later));
        if self.system.absorbers() > 1 {
            self.strike_all();
        } else {
            self.apply_impact();
        }
    }

    /// One segment of a stick episode, ended by its length, the release or the end of the run.
    fn ride(&mut self, remaining: R) -> bool {
        let system = self.system;
        let state = self.tally.state;
        let ride = system.ride(&state);
        if !is_finite(&ride.first(), ride.fourth()) {
            return false;
        }
        let length = ride.reach().min(remaining);
        let (ridden, leaves) = if ride.stays_positive() {
            (length, false)
        } else {
            let stretch = first_release(&ride, length);
            self.tally.undecided += stretch.undecided;
            (stretch.end, stretch.contact.is_some())
        };
        self.advance(&ride, ridden, length == remaining);
        !leaves || self.release(&ride, ridden)
    }

    /// Releases a stuck absorber at the end of a ride of this length; false if the state is not at a release.
    fn release<M>(&mut self, ride: &M, ridden: R) -> bool
    where
        M: Motion<Real = R, State = S::State> + Curve<Real = R>,
    {
        // Where the force jumps or has an impulse at the release, that decides whether the absorber leaves.
        if self.due().is_some() {
            return true;
        }
        let (state, later) = self.system.release(&self.tally.state);
        let pressure = ride.jet(ridden).value.abs();
        let without_pressure = pressure <= ride.magnitude() * (R::EPSILON * PRESSURE_ULPS);
        let close_by = later >= -ridden && later <= ride.reach();
        if !(without_pressure && close_by) {
            return false;
        }
        self.tally.state = state;
        self.progress = self.progress.later(Clock::new(later));
        if self.system.absorbers() > 1 {
            self.let_go_all();
        } else {
            self.let_go();
        }
        true
    }

    /// Ends the stick episode of an absorber that flies from now on.
    fn let_go(&mut self) {
        let from = Instant { time: self.progress.clock, state: self.tally.state };
        self.observer.release(self.system, &from);
        self.end_episode(true);
    }

    fn advance<M>(&mut self, motion: &M, h: R, to_the_end: bool)
    where
        M: Motion<Real = R, State = S::State>,
    {
        self.advance_to(motion, h, &motion.arrival(h), to_the_end);
    }

    /// Advances by a motion of length h to the state after it.
    fn advance_to<M>(&mut self, motion: &M, h: R, end: &S::State, to_the_end: bool)
    where
        M: Motion<Real = R, State = S::State>,
    {
        let whole = to_the_end && h >= self.progress.remaining();
        self.arrive(motion, [h, R::ZERO], end, whole);
    }

    /// Ends a motion after the time h + later, high and low part; `whole` if it ends at the end of the run.
    fn arrive<M>(&mut self, motion: &M, [h, later]: [R; 2], end: &S::State, whole: bool)
    where
        M: Motion<Real = R, State = S::State>,
    {
        let Progress { clock, .. } = self.progress;
        let span = Span {
            motion,
            start: clock,
            length: h + later,
            from: self.system.primary(&self.tally.state),
            to: self.system.primary(end),
            end,
        };
        self.observer.span(self.system, &span);
        self.progress = self.progress.moved(true, clock.plus_parts(h, later), R::INFINITY);
        self.tally.state = *end;
        if whole {
            self.reach_end();
        }
    }

    /// Applies an impulse from outside, or a jump of the force. A stuck absorber leaves its wall if the
    /// impulse or the changed force pulls it off; otherwise both masses take the impulse together.
    fn impulse(&mut self, velocity: R) {
        let before = self.tally.state;
        let mut after = self.system.apply_impulse(&before, velocity, false);
        let riding = self.riding.is_some();
        if riding && self.system.distance(&after).rate <= 0.0 {
            after = self.system.apply_impulse(&before, velocity, true);
        }
        let [v_before, v_after] = [before, after].map(|state| self.system.primary(&state).v);
        self.observer.impulse(self.system, &after, velocity * 0.5 * (v_before + v_after));
        self.tally.state = after;
        self.tell_slips();
        self.progress = self.progress.moved(true, self.progress.clock, R::INFINITY);
        if self.system.absorbers() > 1 {
            return self.settle();
        }
        let leave = self.system.distance(&after);
        if riding {
            if !presses(&leave) {
                self.tally.state = self.system.freed(&self.tally.state);
                self.let_go();
            }
        } else if leave.value > 0.0 {
            // It flies on.
        } else if leave.rate < 0.0 {
            self.apply_impact();
        } else {
            self.leave_or_stick();
        }
    }

    /// Ends the run as cancelled.
    pub(crate) fn cancelled(&mut self) -> Tally<S::State, R> {
        self.tally.outcome = Outcome::Cancelled;
        self.finish()
    }

    /// Ends the run and returns its tally.
    pub(crate) fn finish(&mut self) -> Tally<S::State, R> {
        if self.system.absorbers() > 1 {
            self.end_all();
        }
        self.close();
        if self.system.absorbers() > 1 {
            self.tell_each();
        }
        let Progress { clock, counts, .. } = self.progress;
        (self.tally.end_time, self.tally.clock) = (clock.value, clock);
        let Counts { impacts, effective, work, approach_speeds, losses, .. } = counts;
        let whole = [impacts, effective, work].map(|count| count as u64);
        [self.tally.impacts, self.tally.effective_impacts, self.tally.work] = whole;
        (self.tally.approach_speeds, self.tally.energy_impacts) = (approach_speeds, losses.value);
        self.observer.end(self.system, &self.tally);
        self.tally
    }
}

fn is_finite<R: Real>(jet: &Jet<R>, fourth: R) -> bool {
    jet.value.is_finite() && jet.rate.is_finite() && fourth.is_finite()
}
