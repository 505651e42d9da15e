//! Observers of a run: measures, records and samplers implement [`Observer`].

use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Clock, OnStructure, Point, Wall};
use crate::engine::simulate::{Instant, OfAbsorber, Tally};
use crate::number::real::Real;
use crate::segment::flight::Motion;

/// Smooth motion between two consecutive events or step ends of the run.
#[derive(Debug)]
pub struct Span<'a, M: Motion> {
    /// The motion, exact for 0 ≤ h ≤ `length`.
    pub motion: &'a M,
    /// Instant at h = 0.
    pub start: Clock<M::Real>,
    /// Length of the span.
    pub length: M::Real,
    /// State of the primary at the begin of the span.
    pub from: Point<M::Real>,
    /// State of the primary at the end of the span.
    pub to: Point<M::Real>,
    /// State of the system at the end of the span, before an event there.
    pub end: &'a M::State,
}

impl<'a, M: Motion> Span<'a, M> {
    /// The span of a motion between two instants.
    pub(crate) fn between<S>(
        system: &S,
        motion: &'a M,
        [from, to]: [&'a Instant<M::State, M::Real>; 2],
    ) -> Self
    where
        S: OnStructure<Real = M::Real, State = M::State>,
    {
        Self {
            motion,
            start: from.time,
            length: (to.time - from.time).value,
            from: system.primary(&from.state),
            to: system.primary(&to.state),
            end: &to.state,
        }
    }
}

/// A stick episode: a chatter that ends in stick, a plastic stick, or a start at rest on a pressed wall.
/// Times in 1/ωn, energy per primary mass in ωn² × length².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StickEpisode<R = f64> {
    /// The index of the absorber.
    pub absorber: u8,
    /// The wall.
    pub wall: Wall,
    /// Its first impact: the first after which only this wall is met until the stick.
    pub start_time: R,
    /// End of the chatter: the absorber sticks.
    pub stick_time: R,
    /// Release from the wall; `None` if the absorber is still stuck at the end of the run.
    pub release_time: Option<R>,
    /// Number of its listed impacts.
    pub impacts: u64,
    /// Energy lost in all its impacts, listed or summed.
    pub energy_loss: R,
}

/// The contact at which an impact happens.
#[derive(Debug)]
pub struct Contact<'a, State, R = f64> {
    /// Instant of the contact, in 1/ωn.
    pub time: R,
    /// The states just before and just after.
    pub states: [&'a State; 2],
    /// True for a rebound of a summed tail, computed only to list it: the run jumps to the end of the chatter. Also
    /// true for the contact that announces a tail.
    pub summed: bool,
}

impl<State, R: Real> Contact<'_, State, R> {
    /// `least`, or the largest |ẍ + a_g| just before and after a rebound of a summed tail if that is larger. Between
    /// such rebounds nothing is larger: |ẍ + a_g| changes by the jumps of ẋ in the damper. Other contacts give
    /// `least`: the spans around them hold their accelerations.
    pub fn hardest_shaking<S: Absorber<Real = R, State = State>>(&self, system: &S, least: R) -> R {
        if !self.summed {
            return least;
        }
        let around = self.states.map(|state| system.flight(state).acceleration(R::ZERO).abs());
        around.into_iter().fold(least, R::max)
    }
}

/// Calls its argument for each of some spans, in order of time.
pub type Each<'a, M> = &'a dyn Fn(&mut dyn FnMut(&Span<'_, M>));

/// Notified of everything that happens in a run, in order of time.
pub trait Observer<S: Absorber> {
    /// The run begins, and will end at the instant `duration`.
    fn start(&mut self, _system: &S, _from: &Instant<S::State, S::Real>, _duration: S::Real) {}
    /// A span of smooth motion.
    fn span<M: Motion<Real = S::Real, State = S::State>>(
        &mut self,
        _system: &S,
        _span: &Span<'_, M>,
    ) {
    }
    /// A stretch of free flight without events, in several spans: `whole` is all of it as one span, which may be
    /// longer than its motion is exact; `each` calls its argument for each span.
    fn coast<M: Motion<Real = S::Real, State = S::State>>(
        &mut self,
        system: &S,
        whole: &Span<'_, M>,
        each: Each<'_, M>,
    ) {
        if self.looks_within() {
            each(&mut |span| self.span(system, span));
        } else {
            self.span(system, whole);
        }
    }
    /// True if the observer evaluates the motion within spans, so that it takes those of a coast one by one.
    fn looks_within(&self) -> bool {
        true
    }
    /// An impact.
    fn impact(&mut self, _system: &S, _impact: &Impact<S::Real>) {}
    /// The states around an impact, notified before [`Observer::impact`]. A summed tail is preceded by a
    /// contact with the state that it begins with.
    fn contact(&mut self, _system: &S, _contact: &Contact<'_, S::State, S::Real>) {}
    /// The absorber sticks to its wall from an instant on, at the end of a summed chatter or at once.
    fn stick(&mut self, _system: &S, _from: &Instant<S::State, S::Real>) {}
    /// A stuck absorber is released, by itself or by an impulse, and flies from an instant on.
    fn release(&mut self, _system: &S, _from: &Instant<S::State, S::Real>) {}
    /// An absorber with friction has stopped in its gap at an instant, between these states.
    fn stop(&mut self, _system: &S, _time: S::Real, _states: [&S::State; 2]) {}
    /// An absorber that friction held slides off from an instant on.
    fn slip(&mut self, _system: &S, _from: &Instant<S::State, S::Real>) {}
    /// An impulse from outside: the state after it, and its work (0 at a jump of the force).
    fn impulse(&mut self, _system: &S, _state: &S::State, _work: S::Real) {}
    /// Of the impacts of an absorber from its own index `first` on, those with an approach speed of at most `floor` are
    /// not to be listed: they turned out to belong to a chatter that ended in stick.
    fn unlist(&mut self, _absorber: u8, _first: u64, _floor: S::Real) {}
    /// A stick episode, notified when it ends.
    fn episode(&mut self, _episode: &StickEpisode<S::Real>) {}
    /// True if the observer needs no more: the run ends before its next motion.
    fn is_done(&self) -> bool {
        false
    }
    /// What the run has come to for each of several absorbers, notified before its end.
    fn absorbers(&mut self, _each: &[OfAbsorber<S::Real>]) {}
    /// The run has ended.
    fn end(&mut self, _system: &S, _tally: &Tally<S::State, S::Real>) {}
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for () {
    fn looks_within(&self) -> bool {
        false
    }
}

/// An observer behind a pointer is one.
macro_rules! pointed_to {
    ($($pointer:ty),*) => {$(
        impl<R: Real, S: Absorber<Real = R>, O: Observer<S>> Observer<S> for $pointer {
            fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
                (**self).start(system, from, duration);
            }
            fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
                (**self).span(system, span);
            }
            fn coast<M: Motion<Real = R, State = S::State>>(
                &mut self,
                system: &S,
                whole: &Span<'_, M>,
                each: Each<'_, M>,
            ) {
                (**self).coast(system, whole, each);
            }
            fn impact(&mut self, system: &S, impact: &Impact<R>) {
                (**self).impact(system, impact);
            }
            fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
                (**self).contact(system, contact);
            }
            fn stick(&mut self, system: &S, from: &Instant<S::State, R>) {
                (**self).stick(system, from);
            }
            fn release(&mut self, system: &S, from: &Instant<S::State, R>) {
                (**self).release(system, from);
            }
            fn stop(&mut self, system: &S, time: R, states: [&S::State; 2]) {
                (**self).stop(system, time, states);
            }
            fn slip(&mut self, system: &S, from: &Instant<S::State, R>) {
                (**self).slip(system, from);
            }
            fn impulse(&mut self, system: &S, state: &S::State, work: R) {
                (**self).impulse(system, state, work);
            }
            fn unlist(&mut self, absorber: u8, first: u64, floor: R) {
                (**self).unlist(absorber, first, floor);
            }
            fn episode(&mut self, episode: &StickEpisode<R>) {
                (**self).episode(episode);
            }
            fn is_done(&self) -> bool {
                (**self).is_done()
            }
            fn absorbers(&mut self, each: &[OfAbsorber<R>]) {
                (**self).absorbers(each);
            }
            fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
                (**self).end(system, tally);
            }
        }
    )*};
}
pointed_to!(&mut O, Box<O>);

impl<R: Real, S: Absorber<Real = R>, O: Observer<S>> Observer<S> for Option<O> {
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
    fn coast<M: Motion<Real = R, State = S::State>>(
        &mut self,
        system: &S,
        whole: &Span<'_, M>,
        each: Each<'_, M>,
    ) {
        if let Some(observer) = self {
            observer.coast(system, whole, each);
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
    fn stick(&mut self, system: &S, from: &Instant<S::State, R>) {
        if let Some(observer) = self {
            observer.stick(system, from);
        }
    }
    fn release(&mut self, system: &S, from: &Instant<S::State, R>) {
        if let Some(observer) = self {
            observer.release(system, from);
        }
    }
    fn stop(&mut self, system: &S, time: R, states: [&S::State; 2]) {
        if let Some(observer) = self {
            observer.stop(system, time, states);
        }
    }
    fn slip(&mut self, system: &S, from: &Instant<S::State, R>) {
        if let Some(observer) = self {
            observer.slip(system, from);
        }
    }
    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        if let Some(observer) = self {
            observer.impulse(system, state, work);
        }
    }
    fn unlist(&mut self, absorber: u8, first: u64, floor: R) {
        if let Some(observer) = self {
            observer.unlist(absorber, first, floor);
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
    fn absorbers(&mut self, each: &[OfAbsorber<R>]) {
        if let Some(observer) = self {
            observer.absorbers(each);
        }
    }
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        if let Some(observer) = self {
            observer.end(system, tally);
        }
    }
}

impl<R: Real, S: Absorber<Real = R>, A: Observer<S>, B: Observer<S>> Observer<S> for (A, B) {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        self.0.start(system, from, duration);
        self.1.start(system, from, duration);
    }
    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        self.0.span(system, span);
        self.1.span(system, span);
    }
    fn coast<M: Motion<Real = R, State = S::State>>(
        &mut self,
        system: &S,
        whole: &Span<'_, M>,
        each: Each<'_, M>,
    ) {
        self.0.coast(system, whole, each);
        self.1.coast(system, whole, each);
    }
    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        self.0.impact(system, impact);
        self.1.impact(system, impact);
    }
    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        self.0.contact(system, contact);
        self.1.contact(system, contact);
    }
    fn stick(&mut self, system: &S, from: &Instant<S::State, R>) {
        self.0.stick(system, from);
        self.1.stick(system, from);
    }
    fn release(&mut self, system: &S, from: &Instant<S::State, R>) {
        self.0.release(system, from);
        self.1.release(system, from);
    }
    fn stop(&mut self, system: &S, time: R, states: [&S::State; 2]) {
        self.0.stop(system, time, states);
        self.1.stop(system, time, states);
    }
    fn slip(&mut self, system: &S, from: &Instant<S::State, R>) {
        self.0.slip(system, from);
        self.1.slip(system, from);
    }
    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        self.0.impulse(system, state, work);
        self.1.impulse(system, state, work);
    }
    fn unlist(&mut self, absorber: u8, first: u64, floor: R) {
        self.0.unlist(absorber, first, floor);
        self.1.unlist(absorber, first, floor);
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        self.0.episode(episode);
        self.1.episode(episode);
    }
    fn is_done(&self) -> bool {
        self.0.is_done() || self.1.is_done()
    }
    fn absorbers(&mut self, each: &[OfAbsorber<R>]) {
        self.0.absorbers(each);
        self.1.absorbers(each);
    }
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        self.0.end(system, tally);
        self.1.end(system, tally);
    }
}

/// An observer that keeps the impacts and stick episodes of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Events<R = f64> {
    /// Listed impacts in order of time.
    pub impacts: Vec<Impact<R>>,
    /// Stick episodes in order of their ends.
    pub episodes: Vec<StickEpisode<R>>,
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Events<R> {
    fn looks_within(&self) -> bool {
        false
    }
    fn impact(&mut self, _system: &S, impact: &Impact<R>) {
        self.impacts.push(*impact);
    }
    fn unlist(&mut self, absorber: u8, first: u64, floor: R) {
        let mut index = 0;
        self.impacts.retain(|impact| {
            let mine = impact.absorber == absorber;
            index += u64::from(mine);
            !mine || index <= first || impact.approach_speed() > floor
        });
    }
    fn episode(&mut self, episode: &StickEpisode<R>) {
        self.episodes.push(*episode);
    }
}
