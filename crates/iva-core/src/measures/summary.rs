//! The observer of the summary of a run: its measures and those of its steady state.
//!
//! In doubles the measures of free masses are computed from a log, whether a run goes alone or in lanes:
//! those of a decay from the begins of its motions ([`crate::measures`]), those of a run under one harmonic
//! force from its flights (`measures/forced.rs`). All others are taken stretch by stretch.

use crate::absorber::impact::Impact;
use crate::absorber::plain::State;
use crate::absorber::{Absorber, Clock};
use crate::engine::observe::{Contact, Each, Observer, Span, StickEpisode};
use crate::engine::simulate::{Instant, OfAbsorber, Tally};
use crate::measures::forced::Forced;
use crate::measures::peaks::Peak;
use crate::measures::steady::{Steady, SteadyValues, SteadyWanted, Window};
use crate::measures::{MeasureValues, Measures, Wanted};
use crate::number::real::Real;
use crate::segment::flight::Motion;

/// An observer of the measures of a run, and of those of its steady state; beside it another one.
#[derive(Debug)]
pub struct Summary<S: Absorber, O = ()> {
    pub(crate) measures: Measures<S>,
    pub(crate) steady: Option<Steady<S::Real>>,
    /// The measures of the steady state that are wanted.
    asked: SteadyWanted,
    /// The log of a driven run; `None`: its measures are taken stretch by stretch.
    pub(crate) forced: Option<Box<Forced>>,
    /// What the run has come to for each of several absorbers.
    pub(crate) absorbers: Vec<OfAbsorber<S::Real>>,
    /// The observer beside it.
    pub(crate) beside: O,
}

impl<R: Real, S: Absorber<Real = R>> Summary<S> {
    /// Computes the wanted measures, and those of the steady state in a window if there is one.
    pub fn new(wanted: Wanted, steady: Option<(SteadyWanted, Window<R>)>) -> Self {
        Self::with(wanted, steady, ())
    }
}

impl<R: Real, S: Absorber<Real = R>, O> Summary<S, O> {
    /// Computes the wanted measures, with another observer beside it.
    pub(crate) fn with(
        wanted: Wanted,
        steady: Option<(SteadyWanted, Window<R>)>,
        beside: O,
    ) -> Self {
        let asked = steady.map(|(wanted, _)| wanted).unwrap_or_default();
        let steady = steady.map(|(wanted, window)| Steady::new(window, wanted));
        let measures = Measures::new(wanted);
        Self { measures, steady, asked, forced: None, absorbers: Vec::new(), beside }
    }

    /// The observer of the next run, in its memory.
    pub(crate) fn again(
        &mut self,
        wanted: Wanted,
        steady: Option<(SteadyWanted, Window<R>)>,
        beside: O,
    ) {
        let (decay, stretches) = (self.measures.decay.take(), self.measures.stretches.take());
        *self = Self { forced: self.forced.take(), ..Self::with(wanted, steady, beside) };
        (self.measures.decay, self.measures.stretches) = (decay, stretches);
    }

    /// The measures; complete once the run has ended.
    pub fn values(&self) -> &MeasureValues<R> {
        self.measures.values()
    }

    /// All peaks of x, if they were wanted; complete once the run has ended.
    pub fn envelope(&self) -> &[Peak<R>] {
        self.measures.envelope()
    }

    /// What the run has come to for each of several absorbers; empty with fewer.
    pub fn absorbers(&self) -> &[OfAbsorber<R>] {
        &self.absorbers
    }

    /// The steady state, if it was asked for; complete once the run has ended.
    pub fn steady(&self) -> Option<&Steady<R>> {
        self.steady.as_ref()
    }

    /// The measures of the steady state, if it was asked for; complete once the run has ended.
    pub fn steady_values(&self) -> Option<&SteadyValues<R>> {
        self.steady().map(Steady::values)
    }

    /// Computes the measures of what is in the log of a driven run.
    pub(crate) fn take_log(&mut self) {
        if let Some(forced) = &mut self.forced {
            let [lost, worked] = forced.take(self.steady.as_mut());
            self.measures.add(lost, worked);
        }
    }

    /// Logs a flight of a driven run, of this length, between two states.
    fn push(&mut self, system: &S, clock: Clock<R>, length: R, ends: [&S::State; 2]) {
        let Some(forced) = &mut self.forced else { return };
        let clock = Clock { value: clock.value.double(), rest: clock.rest.double() };
        let ends = ends.map(|state| in_doubles(system, state));
        forced.push(clock, length.double(), [0.0; 2], ends.each_ref());
    }
}

/// A state in flight in plain doubles, without its force.
fn in_doubles<S: Absorber>(system: &S, state: &S::State) -> State {
    let (primary, gap) = (system.primary(state), system.distance(state));
    State {
        x: primary.x.double(),
        v: primary.v.double(),
        distance: gap.value.double(),
        rate: gap.rate.double(),
        side: system.wall(state).sign(),
        ..State::default()
    }
}

impl<R: Real, S: Absorber<Real = R>, O: Observer<S>> Observer<S> for Summary<S, O> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        self.beside.start(system, from, duration);
        self.measures.start(system, from, duration);
        self.steady.start(system, from, duration);
        let begin = self.steady.as_ref().map_or(R::ZERO, Steady::begin);
        let (wanted, spare) = ((self.measures.wanted, self.asked), self.forced.take());
        let from = begin.double();
        self.forced = system.forced().and_then(|scene| Forced::new(&scene, spare, wanted, from));
    }

    fn span<M>(&mut self, system: &S, span: &Span<'_, M>)
    where
        M: Motion<Real = R, State = S::State>,
    {
        self.beside.span(system, span);
        let Some(forced) = &self.forced else {
            self.measures.span(system, span);
            return self.steady.span(system, span);
        };
        let wanted = forced.is_wanted();
        if !M::RIDING {
            self.measures.list_peaks(system, span);
        }
        if !wanted {
            return;
        }
        if M::RIDING {
            self.take_log();
            self.measures.span(system, span);
            return self.steady.span(system, span);
        }
        if forced.is_full() {
            self.take_log();
        }
        self.push(system, span.start, span.length, [span.motion.origin(), span.end]);
    }

    /// Only runs without a log of flights coast.
    fn coast<M>(&mut self, system: &S, whole: &Span<'_, M>, each: Each<'_, M>)
    where
        M: Motion<Real = R, State = S::State>,
    {
        self.beside.coast(system, whole, each);
        self.measures.coast(system, whole, each);
        self.steady.coast(system, whole, each);
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        self.beside.contact(system, contact);
        self.measures.contact(system, contact);
        self.steady.contact(system, contact);
    }

    fn stick(&mut self, system: &S, from: &Instant<S::State, R>) {
        self.beside.stick(system, from);
        self.measures.stick(system, from);
    }

    fn release(&mut self, system: &S, from: &Instant<S::State, R>) {
        self.beside.release(system, from);
        self.measures.release(system, from);
    }

    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        self.beside.impact(system, impact);
        match &mut self.forced {
            Some(forced) => forced.impact(impact),
            None => self.steady.impact(system, impact),
        }
    }

    fn impulse(&mut self, system: &S, state: &S::State, work: R) {
        self.beside.impulse(system, state, work);
        self.measures.impulse(system, state, work);
    }

    fn episode(&mut self, episode: &StickEpisode<R>) {
        self.beside.episode(episode);
    }

    fn unlist(&mut self, absorber: u8, first: u64, floor: R) {
        self.beside.unlist(absorber, first, floor);
        match &mut self.forced {
            Some(forced) => forced.unlist(floor.double()),
            None => Observer::<S>::unlist(&mut self.steady, absorber, first, floor),
        }
    }

    fn absorbers(&mut self, each: &[OfAbsorber<R>]) {
        self.absorbers = each.to_vec();
        self.beside.absorbers(each);
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        self.take_log();
        self.beside.end(system, tally);
        self.measures.end(system, tally);
        self.steady.end(system, tally);
    }
}
