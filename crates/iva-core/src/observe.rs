//! Who watches a run: measures, records and samplers see it through [`Observer`].

use crate::flight::Motion;
use crate::impact::Impact;
use crate::real::Real;
use crate::simulate::{Instant, Tally};
use crate::system::{Clock, Point, System, Wall};

/// Smooth motion between two neighbouring instants of the run.
#[derive(Debug)]
pub struct Span<'a, M: Motion> {
    /// The motion, exact for 0 ≤ h ≤ `length`.
    pub motion: &'a M,
    /// Instant at h = 0.
    pub start: Clock<M::Real>,
    /// Length of the span.
    pub length: M::Real,
    /// Primary at its begin.
    pub from: Point<M::Real>,
    /// Primary at its end.
    pub to: Point<M::Real>,
    /// The state at its end, before what may happen there.
    pub end: &'a M::State,
}

/// A chatter that ends in stick, a plastic stick, or a start at rest on a pressed wall. Times in
/// 1/ωn, energy per primary mass in ωn² × length².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StickEpisode<R = f64> {
    /// The wall.
    pub wall: Wall,
    /// Its first impact: the first after which only this wall is met until the stick.
    pub start_time: R,
    /// End of the chatter, begin of the ride.
    pub stick_time: R,
    /// End of the ride; `None` if still stuck at the end of the run.
    pub release_time: Option<R>,
    /// Listed impacts.
    pub impacts: u64,
    /// Energy lost in all its impacts, listed or summed.
    pub energy_loss: R,
}

/// What happens to a state in an instant.
#[derive(Debug)]
pub enum Jump<'a, State> {
    /// An impact: the states in contact, just before and just after.
    Impact {
        /// Before.
        before: &'a State,
        /// After.
        after: &'a State,
    },
    /// A chatter is summed to its end: the absorber sticks.
    Stick,
    /// The absorber leaves the wall it was stuck to.
    Release,
}

/// Where an impact happens.
#[derive(Debug)]
pub struct Contact<'a, State, R = f64> {
    /// Instant.
    pub time: R,
    /// The states just before and just after.
    pub states: [&'a State; 2],
    /// True of a rebound of a summed tail: the run does not go through these states.
    pub summed: bool,
}

impl<State, R: Real> Contact<'_, State, R> {
    /// The largest |ẍ + a_g| around it, or `least` if that is larger; of a rebound of a summed tail only. Between these
    /// the acceleration has no other extremes, for the damper feels their jumps, and all others are seen in the motion.
    pub fn hardest_shaking<S: System<Real = R, State = State>>(&self, system: &S, least: R) -> R {
        if !self.summed {
            return least;
        }
        let around = self.states.map(|state| system.flight(state).acceleration(R::ZERO).abs());
        around.into_iter().fold(least, R::max)
    }
}

/// Told of everything that happens in a run, in the order of time.
pub trait Observer<S: System> {
    /// The run begins and is to last until `duration`.
    fn start(&mut self, _system: &S, _from: &Instant<S::State, S::Real>, _duration: S::Real) {}
    /// Smooth motion.
    fn span<M: Motion<Real = S::Real, State = S::State>>(
        &mut self,
        _system: &S,
        _span: &Span<'_, M>,
    ) {
    }
    /// An impact.
    fn impact(&mut self, _system: &S, _impact: &Impact<S::Real>) {}
    /// The states around an impact, told before [`Observer::impact`]; first of all the one that a summed tail begins with.
    fn contact(&mut self, _system: &S, _contact: &Contact<'_, S::State, S::Real>) {}
    /// The state changes in an instant; of an impact before [`Observer::impact`].
    fn jump(&mut self, _system: &S, _jump: &Jump<'_, S::State>) {}
    /// An impulse from outside: the state after it, and the work it does (0 where the force only
    /// jumps).
    fn impulse(&mut self, _system: &S, _state: &S::State, _work: S::Real) {}
    /// Of the impacts from index `first` on, those not faster than `floor` are not to be listed:
    /// they turned out to belong to a chatter that ended in stick.
    fn unlist(&mut self, _first: u64, _floor: S::Real) {}
    /// An episode, told when it ends.
    fn episode(&mut self, _episode: &StickEpisode<S::Real>) {}
    /// True once it has seen enough: the run ends at the next instant between two motions.
    fn is_done(&self) -> bool {
        false
    }
    /// The run has ended.
    fn end(&mut self, _system: &S, _tally: &Tally<S::State, S::Real>) {}
}

impl<R: Real, S: System<Real = R>> Observer<S> for () {}

impl<R: Real, S: System<Real = R>, O: Observer<S>> Observer<S> for &mut O {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        (**self).start(system, from, duration);
    }
    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        (**self).span(system, span);
    }
    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        (**self).impact(system, impact);
    }
    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        (**self).contact(system, contact);
    }
    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        (**self).jump(system, jump);
    }
    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        (**self).impulse(system, state, work);
    }
    fn unlist(&mut self, first: u64, floor: R) {
        (**self).unlist(first, floor);
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        (**self).episode(episode);
    }
    fn is_done(&self) -> bool {
        (**self).is_done()
    }
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        (**self).end(system, tally);
    }
}

impl<R: Real, S: System<Real = R>, O: Observer<S>> Observer<S> for Option<O> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        if let Some(observer) = self {
            observer.start(system, from, duration);
        }
    }
    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        if let Some(observer) = self {
            observer.span(system, span);
        }
    }
    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        if let Some(observer) = self {
            observer.impact(system, impact);
        }
    }
    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        if let Some(observer) = self {
            observer.contact(system, contact);
        }
    }
    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        if let Some(observer) = self {
            observer.jump(system, jump);
        }
    }
    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        if let Some(observer) = self {
            observer.impulse(system, state, work);
        }
    }
    fn unlist(&mut self, first: u64, floor: R) {
        if let Some(observer) = self {
            observer.unlist(first, floor);
        }
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        if let Some(observer) = self {
            observer.episode(episode);
        }
    }
    fn is_done(&self) -> bool {
        self.as_ref().is_some_and(|observer| observer.is_done())
    }
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        if let Some(observer) = self {
            observer.end(system, tally);
        }
    }
}

impl<R: Real, S: System<Real = R>, A: Observer<S>, B: Observer<S>> Observer<S> for (A, B) {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        self.0.start(system, from, duration);
        self.1.start(system, from, duration);
    }
    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        self.0.span(system, span);
        self.1.span(system, span);
    }
    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        self.0.impact(system, impact);
        self.1.impact(system, impact);
    }
    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        self.0.contact(system, contact);
        self.1.contact(system, contact);
    }
    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        self.0.jump(system, jump);
        self.1.jump(system, jump);
    }
    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        self.0.impulse(system, state, work);
        self.1.impulse(system, state, work);
    }
    fn unlist(&mut self, first: u64, floor: R) {
        self.0.unlist(first, floor);
        self.1.unlist(first, floor);
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        self.0.episode(episode);
        self.1.episode(episode);
    }
    fn is_done(&self) -> bool {
        self.0.is_done() || self.1.is_done()
    }
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        self.0.end(system, tally);
        self.1.end(system, tally);
    }
}

/// Keeps the impacts and episodes of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Events<R = f64> {
    /// Listed impacts in the order of time.
    pub impacts: Vec<Impact<R>>,
    /// Episodes in the order of time.
    pub episodes: Vec<StickEpisode<R>>,
}

impl<R: Real, S: System<Real = R>> Observer<S> for Events<R> {
    fn impact(&mut self, _system: &S, impact: &Impact<R>) {
        self.impacts.push(*impact);
    }
    fn unlist(&mut self, first: u64, floor: R) {
        let mut index = 0;
        self.impacts.retain(|impact| {
            index += 1;
            index <= first || impact.approach_speed() > floor
        });
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        self.episodes.push(*episode);
    }
}
