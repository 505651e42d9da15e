//! One point of a study: its run, and the rows of its tables.

use std::sync::atomic::AtomicBool;

use iva_core::absorber::modal::{FewModes, Modal};
use iva_core::absorber::{Absorber, OnStructure};
use iva_core::extremes::Extremes;
use iva_core::host::{DrivenHost, Excitation, UndrivenHost};
use iva_core::impact::Impact;
use iva_core::measures::Wanted;
use iva_core::measures::near_wall::NearWall;
use iva_core::measures::pass::{Pass, Passes};
use iva_core::observe::Events;
use iva_core::peaks::Peak;
use iva_core::piva::Piva;
use iva_core::propagation::Errors;
use iva_core::real::Real;
use iva_core::real::twofold::Twofold;
use iva_core::run::observed::{Beside, Observed, Observers};
use iva_core::run::side_by_side::Listing;
use iva_core::simulate::{Limits, Tally, simulate_from};
use iva_core::siva::Siva;
use iva_core::steady::{Steady, SteadyWanted, Strobe};
use iva_core::summary::Summary;

use super::design::Design;
use super::ended::Ended;
use super::rows::{
    EpisodeRow, Estimate, ImpactRow, PeakRow, Row, RunRow, StrobeRow, SummaryColumn,
};
use super::scene::with_system;
use crate::cells::{Cell, passes};
use crate::columns::{Group, tables as entries};
use crate::error::Invalid;
use crate::study::{Study, Table};

/// Makes a pass over a run.
type NewPass<R> = fn() -> Box<dyn Pass<R>>;

/// The tables and measures that a study wants from each run.
#[derive(Debug)]
pub(crate) struct Request {
    pub summary: bool,
    pub impacts: bool,
    pub episodes: bool,
    pub envelope: bool,
    pub absorbers: bool,
    /// True if the errors of the run are to be estimated.
    pub errors: bool,
    pub wanted: Wanted,
    pub steady: SteadyWanted,
    pub reduction: bool,
    /// True if the extremes of every run are wanted.
    pub extremes: bool,
    /// True if the extremes of runs in free decay are wanted.
    pub extremes_of_decays: bool,
    /// The measures with passes of their own that are wanted.
    pub named: Vec<&'static str>,
    pub columns: Vec<SummaryColumn>,
}

impl Request {
    /// Neither table nor measure.
    #[cfg(feature = "sweeps")]
    pub fn nothing() -> Self {
        Self {
            summary: false,
            impacts: false,
            episodes: false,
            envelope: false,
            absorbers: false,
            errors: false,
            wanted: Wanted::NONE,
            steady: SteadyWanted::default(),
            reduction: false,
            extremes: false,
            extremes_of_decays: false,
            named: Vec::new(),
            columns: Vec::new(),
        }
    }

    pub fn new(study: &Study) -> Self {
        let asked = |table| study.tables.contains(&table);
        let needs = |group| study.measures.needs(group);
        Self {
            summary: asked(Table::Summary),
            impacts: asked(Table::Impacts),
            episodes: asked(Table::Episodes),
            envelope: asked(Table::Envelope),
            absorbers: asked(Table::Absorbers),
            errors: study.errors,
            wanted: Wanted {
                peaks: needs(Group::Peaks),
                settling: needs(Group::Settling),
                residual: needs(Group::Residual),
                ledger: needs(Group::Ledger),
                first_period: needs(Group::FirstPeriod),
                envelope: asked(Table::Envelope),
            },
            steady: SteadyWanted {
                amplitude: needs(Group::Amplitude) || needs(Group::Reduction),
                rms: needs(Group::Rms) || needs(Group::RmsReduction),
                acceleration: needs(Group::Acceleration) || needs(Group::Shaking),
                regime: needs(Group::Regime),
                impacts: needs(Group::ImpactsPerCycle),
                strobes: asked(Table::Stroboscope),
            },
            reduction: asked(Table::Summary)
                && (needs(Group::Reduction) || needs(Group::RmsReduction)),
            extremes: needs(Group::Travel),
            extremes_of_decays: needs(Group::Shaking),
            named: if asked(Table::Summary) {
                study.measures.of(Group::Named).map(|column| column.name).collect()
            } else {
                Vec::new()
            },
            columns: SummaryColumn::of(study),
        }
    }
}

impl Request {
    /// The measures with passes of their own, in order of their names in `named`.
    fn passes<R: Real>(&self) -> Vec<NewPass<R>> {
        let all: &[(&str, NewPass<R>)] = &entries::summary!(passes);
        let new = |name: &&str| all.iter().find(|it| it.0 == *name).map(|it| it.1);
        self.named.iter().filter_map(new).collect()
    }

    /// The measures with passes of their own, with their names.
    pub fn named<R: Real>(
        &self,
        values: impl IntoIterator<Item = Option<R>>,
    ) -> Vec<(&'static str, Option<R>)> {
        self.named.iter().copied().zip(values).collect()
    }

    /// The groups of measures that are wanted of a run.
    pub fn measures(&self) -> Wanted {
        let nothing = Wanted { envelope: self.envelope, ..Wanted::NONE };
        if self.summary { self.wanted } else { nothing }
    }

    /// True if a table beside the summary has rows of a run.
    pub fn has_rows(&self) -> bool {
        self.lists() || self.envelope || self.absorbers || self.steady.strobes
    }

    /// What is wanted of runs beside their measures, with their extremes or without.
    pub fn listing(&self, extremes: bool) -> Listing {
        Listing {
            events: self.lists(),
            errors: self.errors,
            envelope: self.envelope,
            extremes,
            passes: self.passes(),
        }
    }

    /// True if impacts or stick episodes are wanted.
    pub fn lists(&self) -> bool {
        self.impacts || self.episodes
    }

    /// True if the extremes of a run are wanted.
    pub fn wants_extremes<S: OnStructure>(&self, system: &S) -> bool {
        (self.summary || self.absorbers)
            && (self.extremes || (self.extremes_of_decays && !system.excitation().is_driven()))
    }

    /// Whether the extremes of runs are wanted: of all, of none, or of some.
    pub fn with_extremes(&self) -> &'static [bool] {
        let shown = self.summary || self.absorbers;
        match (shown && self.extremes, shown && self.extremes_of_decays) {
            (true, _) => &[true],
            (false, true) => &[false, true],
            (false, false) => &[false],
        }
    }

    /// The measures of the steady state that are wanted; `None` in free decay, and if nothing is taken from its window.
    pub fn steady_of<S: OnStructure>(&self, system: &S) -> Option<SteadyWanted> {
        let windowed = self.steady != SteadyWanted::default()
            || self.wants_extremes(system)
            || !self.named.is_empty();
        Some(self.steady).filter(|_| system.excitation().is_driven() && windowed)
    }
}

/// What a run tells of its errors.
pub trait Estimates<R> {
    /// The estimate for an impact.
    fn of_impact(&self, _index: usize) -> Estimate<R> {
        Estimate { time: None, near_grazing: None }
    }
    /// Condition number and correct digits of the run.
    fn of_run(&self) -> [Option<R>; 2] {
        [const { None }; 2]
    }
}

/// Runs whose errors are not asked for.
impl<R> Estimates<R> for () {}

impl Estimates<f64> for Option<Box<Errors>> {
    fn of_impact(&self, index: usize) -> Estimate {
        let error = self.as_ref().and_then(|errors| errors.impacts.get(index));
        let time = error.and_then(|error| error.time);
        Estimate { time, near_grazing: error.filter(|_| time.is_some()).map(|it| it.grazing) }
    }

    fn of_run(&self) -> [Option<f64>; 2] {
        let errors = self.as_ref();
        [errors.and_then(|it| it.condition()), errors.and_then(|it| it.digits())]
    }
}

impl<O> Estimates<f64> for (Option<Box<Errors>>, O) {
    fn of_impact(&self, index: usize) -> Estimate {
        self.0.of_impact(index)
    }

    fn of_run(&self) -> [Option<f64>; 2] {
        self.0.of_run()
    }
}

/// What observes runs of a system beside their tables, and the event loop that it goes through.
pub trait Observes<S: Absorber>: Estimates<S::Real> + Sized {
    /// As [`simulate_from`].
    ///
    /// # Errors
    /// As [`simulate_from`].
    fn simulate(
        system: &S,
        start: &S::Start,
        time: (S::Real, &Limits<S::Real>),
        cancel: &AtomicBool,
        observers: &mut Observers<S, S::Real, Self>,
    ) -> Result<Tally<S::State, S::Real>, Invalid>;
}

/// In doubles: by the loops that are compiled with the core.
impl<S: Observed> Observes<S> for Beside<'_> {
    fn simulate(
        system: &S,
        start: &S::Start,
        (begin, limits): (f64, &Limits),
        cancel: &AtomicBool,
        observers: &mut Observers<S, f64, Self>,
    ) -> Result<Tally<S::State>, Invalid> {
        system.observe(start, begin, limits, Some(cancel), observers)
    }
}

/// To twice the precision: by loops that are compiled where such runs are made.
impl<S: Absorber<Real = Twofold>> Observes<S> for () {
    fn simulate(
        system: &S,
        start: &S::Start,
        (begin, limits): (Twofold, &Limits<Twofold>),
        cancel: &AtomicBool,
        observers: &mut Observers<S, Twofold, Self>,
    ) -> Result<Tally<S::State, Twofold>, Invalid> {
        simulate_from(system, start, begin, limits, Some(cancel), observers)
    }
}

/// Declares an observer of runs of any kind of scene, which may tell of their errors.
macro_rules! observes_any {
    ($($system:ty),* $(,)?) => {
        /// An observer of runs of any kind of scene.
        pub trait ObservesAny<R: Real>: Estimates<R> $(+ Observes<$system>)* {}

        impl<R: Real, E: Estimates<R> $(+ Observes<$system>)*> ObservesAny<R> for E {}
    };
}

observes_any! {
    Siva<UndrivenHost<R>>,
    Siva<DrivenHost<R>>,
    Modal<DrivenHost<R>>,
    FewModes<DrivenHost<R>>,
    Piva<DrivenHost<R>>,
}

/// The receiver of the rows of each table.
pub type Take<'a, R> = dyn FnMut(Table, &mut dyn Iterator<Item = Cell<R>>) + 'a;

/// Runs a point and hands out the rows of its events, table by table; returns its result.
///
/// # Errors
/// [`Invalid`] if the core refuses the design.
pub(crate) fn run<R: Real, E>(
    study: &Study,
    point: u64,
    design: &Design<R>,
    request: &Request,
    cancel: &AtomicBool,
    estimates: E,
    take: &mut Take<'_, R>,
) -> Result<Ended<R>, Invalid>
where
    E: ObservesAny<R>,
{
    let point = Point { study, point, design, request, cancel };
    with_system!(&design.scene, |it| point.run(&it.system, &it.start, estimates, take))
}

/// Hands out the rows of the events of a run, table by table.
pub(crate) fn list<R: Real>(
    study: &Study,
    point: u64,
    design: &Design<R>,
    request: &Request,
    (ended, found): (&Ended<R>, &Seen<'_, R>),
    take: &mut Take<'_, R>,
) {
    let point = Point { study, point, design, request, cancel: &AtomicBool::new(false) };
    for table in &study.tables {
        with_system!(&design.scene, |it| point.rows(*table, &it.system, found, take));
    }
    point.absorbers(ended, take);
}

/// The impulse of an impact, over the mass of the structure.
fn gained<R: Real, S: Absorber<Real = R>>(system: &S, impact: &Impact<R>, approach: R) -> R {
    if system.absorbers() <= 1 {
        return system.impulse_at(impact.wall, approach) * approach;
    }
    system.impulse_of(impact)
}

struct Point<'a, R: Real> {
    study: &'a Study,
    point: u64,
    design: &'a Design<R>,
    request: &'a Request,
    cancel: &'a AtomicBool,
}

/// The events that a run has shown to its observers.
pub(crate) struct Seen<'a, R> {
    pub events: Option<Events<R>>,
    pub envelope: &'a [Peak<R>],
    pub strobes: &'a [Strobe<R>],
    pub estimates: &'a dyn Estimates<R>,
}

impl<R: Real> Point<'_, R> {
    fn run<S: Absorber<Real = R>, E: Observes<S>>(
        &self,
        system: &S,
        start: &S::Start,
        estimates: E,
        take: &mut Take<'_, R>,
    ) -> Result<Ended<R>, Invalid> {
        let Self { study, design, request, cancel, .. } = *self;
        // In free decay extremes count from the begin of the run.
        let from = if system.excitation().is_driven() { design.window.from } else { design.begin };
        let extremes = request.wants_extremes(system);
        let steady = request.steady_of(system).map(|wanted| (wanted, design.window));
        let wanted = request.measures();
        let passes = request.passes().into_iter().map(|new| new());
        let passes = Passes::new(from, passes.collect());
        let asked = request.summary || request.envelope || request.absorbers || steady.is_some();
        let summary = asked.then(|| Summary::<S>::new(wanted, steady));
        let mut observers = (
            request.lists().then(Events::default),
            (summary, ((extremes.then(|| Extremes::new(from)), passes), estimates)),
        );
        let length = (design.begin, &design.limits);
        let tally = E::simulate(system, start, length, cancel, &mut observers)?;
        let (events, (summary, ((extremes, passes), estimates))) = observers;
        let steady = summary.as_ref().and_then(Summary::steady);
        let envelope = summary.as_ref().map_or(&[][..], Summary::envelope);
        let strobes = steady.and_then(Steady::all_strobes).unwrap_or_default();
        let found = Seen { events, envelope, strobes: &strobes, estimates: &estimates };
        for table in &study.tables {
            self.rows(*table, system, &found, take);
        }
        let measures = summary.as_ref().map(Summary::values).copied().unwrap_or_default();
        let values = (tally.without_state(), measures, steady.map(Steady::values).copied());
        let tier = design.tier_alone();
        let ended = Ended::new(design, values, tier, request.reduction, cancel)?;
        let [condition, digits] = estimates.of_run();
        let extremes = extremes.map(|it| it.values().to_vec()).unwrap_or_default();
        let absorbers = summary.as_ref().map(|it| it.absorbers().to_vec()).unwrap_or_default();
        let named = request.named(passes.values());
        let ended = Ended { extremes, absorbers, named, condition, digits, ..ended };
        self.absorbers(&ended, take);
        Ok(ended)
    }

    /// The rows of the table of absorbers.
    fn absorbers(&self, ended: &Ended<R>, take: &mut Take<'_, R>) {
        if self.request.absorbers {
            for row in RunRow::new(self.design, ended).absorbers() {
                take(Table::Absorbers, &mut self.numbered(&row));
            }
        }
    }

    fn rows<S: Absorber<Real = R>>(
        &self,
        table: Table,
        system: &S,
        seen: &Seen<'_, R>,
        take: &mut Take<'_, R>,
    ) {
        let design = self.design;
        let (scale, events) = (&design.scale, seen.events.iter());
        let mut row = |cells: &mut dyn Iterator<Item = Cell<R>>| take(table, cells);
        match table {
            Table::Impacts => {
                let impacts = events.flat_map(|events| &events.impacts).enumerate();
                for (index, impact) in impacts {
                    let angles = system.impact_angles(impact).filter(|_| design.scene.has_angle());
                    let estimate = seen.estimates.of_impact(index);
                    let approach = impact.approach_speed();
                    let absorber = usize::from(impact.absorber);
                    let contact = design.contacts.get(absorber).copied().flatten();
                    let peak_force = contact.map(|contact| {
                        let law = system.law_of(absorber, impact.wall, approach);
                        contact.force(gained(system, impact, approach), approach, law.restitution)
                    });
                    let of_impact =
                        ImpactRow { index, impact, peak_force, angles, estimate, scale };
                    row(&mut self.numbered(&of_impact));
                }
            }
            Table::Episodes => {
                for (index, episode) in events.flat_map(|events| &events.episodes).enumerate() {
                    row(&mut self.numbered(&EpisodeRow { index, episode, scale }));
                }
            }
            Table::Envelope => {
                let peaks = seen.envelope;
                for index in 0..peaks.len() {
                    row(&mut self.numbered(&PeakRow { index, peaks, scale }));
                }
            }
            Table::Stroboscope => {
                let mut before = None;
                let has_absorber = design.scene.count() > 0;
                for at_once in seen.strobes.chunks(design.scene.count().max(1)) {
                    for strobe in at_once {
                        row(&mut self.numbered(&StrobeRow { strobe, before, has_absorber, scale }));
                    }
                    before = at_once.first();
                }
            }
            Table::Summary | Table::Absorbers | Table::Trajectory => {}
        }
    }

    /// The cells of a row, after the number of the point.
    fn numbered(&self, row: &impl Row<R>) -> impl Iterator<Item = Cell<R>> {
        std::iter::once(Cell::point(self.point)).chain(row.cells())
    }
}
