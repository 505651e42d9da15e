//! The observer of a run side by side: its measures and those of its steady state, computed from a log where
//! that is possible.

use crate::flight::Motion;
use crate::impact::Impact;
use crate::measures::forced::{Forced, Scene};
use crate::measures::{Measures, Wanted};
use crate::observe::{Contact, Jump, Observer, Span};
use crate::plain::State;
use crate::simulate::{Instant, Tally};
use crate::steady::{Steady, SteadyWanted, Window};
use crate::system::{Clock, System};

/// The measures of a run in doubles.
#[derive(Debug)]
pub(crate) struct Summary<S: System<Real = f64>> {
    pub measures: Measures<S>,
    pub steady: Option<Steady>,
    steady_wanted: SteadyWanted,
    /// The scene whose driven runs are logged; `None`: measures are taken stretch by stretch.
    scene: Option<Scene>,
    /// The log of a driven run.
    pub forced: Option<Box<Forced>>,
}

impl<S: System<Real = f64>> Summary<S> {
    /// Computes the wanted measures; those of driven runs from a log, if a scene is given.
    pub fn of(
        wanted: Wanted,
        steady: Option<(SteadyWanted, Window)>,
        scene: Option<Scene>,
        spare: Option<Self>,
    ) -> Self {
        let steady_wanted = steady.map(|(wanted, _)| wanted).unwrap_or_default();
        let steady = steady.map(|(wanted, window)| Steady::new(window, wanted));
        let (measures, forced) = spare.map_or((None, None), |it| (Some(it.measures), it.forced));
        let measures = Measures::new(wanted).in_memory_of(measures);
        Self { measures, steady, steady_wanted, scene, forced }
    }

    /// Computes the measures of what is in the log of a driven run.
    pub fn take_log(&mut self) {
        if let Some(forced) = &mut self.forced {
            let [lost, worked] = forced.take(self.steady.as_mut());
            self.measures.add(lost, worked);
        }
    }

    /// Logs a flight of a driven run, of this length, between two states.
    fn push(&mut self, system: &S, clock: Clock, length: f64, ends: [&S::State; 2]) {
        let Some(forced) = &mut self.forced else { return };
        let ends = ends.map(|state| in_doubles(system, state));
        forced.push(&forced.flight(clock, length, ends));
    }
}

/// A state in flight in plain doubles, without its force.
fn in_doubles<S: System<Real = f64>>(system: &S, state: &S::State) -> State {
    let (primary, gap) = (system.primary(state), system.distance(state));
    State {
        x: primary.x,
        v: primary.v,
        distance: gap.value,
        rate: gap.rate,
        side: system.wall(state).sign(),
        ..State::default()
    }
}

impl<S: System<Real = f64>> Observer<S> for Summary<S> {
    fn start(&mut self, system: &S, from: &Instant<S::State>, duration: f64) {
        self.measures.start(system, from, duration);
        self.steady.start(system, from, duration);
        let begin = self.steady.as_ref().map_or(0.0, |steady| Steady::begin(steady));
        let wanted = (self.measures.wanted, self.steady_wanted);
        let spare = self.forced.take();
        self.forced =
            self.scene.and_then(|scene| Forced::new(&scene, spare, wanted, [begin, duration]));
    }

    fn span<M>(&mut self, system: &S, span: &Span<'_, M>)
    where
        M: Motion<Real = f64, State = S::State>,
    {
        let Some(forced) = &self.forced else {
            self.measures.span(system, span);
            return self.steady.span(system, span);
        };
        if !forced.is_wanted() {
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

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        self.steady.contact(system, contact);
    }

    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        self.measures.jump(system, jump);
    }

    fn impact(&mut self, system: &S, impact: &Impact) {
        match &mut self.forced {
            Some(forced) => forced.impact(impact),
            None => self.steady.impact(system, impact),
        }
    }

    fn impulse(&mut self, system: &S, state: &S::State, work: f64) {
        self.measures.impulse(system, state, work);
    }

    fn unlist(&mut self, first: u64, floor: f64) {
        match &mut self.forced {
            Some(forced) => forced.unlist(floor),
            None => Observer::<S>::unlist(&mut self.steady, first, floor),
        }
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        self.take_log();
        self.measures.end(system, tally);
        self.steady.end(system, tally);
    }
}
