//! Runs the points of a study in parallel; rows stand in the order of `point`.
//!
//! Each worker takes a chunk of neighbouring points and builds its rows; the chunks are joined in
//! order. So the tables do not depend on the number of threads or the size of the chunks.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use arrow_array::RecordBatch;
use arrow_schema::ArrowError;
use arrow_select::concat::concat_batches;
use iva_core::error::Invalid;
use iva_core::measures::{Measures, Wanted};
use iva_core::observe::Events;
use iva_core::peaks::Envelope;
use iva_core::propagation::{Differentiable, Errors};
use iva_core::simulate::simulate;
use iva_core::steady::{Steady, SteadyWanted};
use iva_core::system::System;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::design::Design;
use crate::rows;
use crate::scene::Scene;
use crate::study::{Study, Table, distinct, fitting};
use crate::tables::{Cell, TableBuilder, schema_in};
use crate::units::UnitSystem;

/// The tables of a range of points.
pub type Tables = BTreeMap<Table, RecordBatch>;

/// Why a sweep could not run.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A value that the user can mend.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// The workers could not be started.
    #[error("the worker threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A table could not be built.
    #[error("a result table could not be built: {0}")]
    Table(#[from] ArrowError),
}

/// The worker threads of one or more sweeps.
pub struct Workers(rayon::ThreadPool);

impl Workers {
    /// Starts `threads` workers; `None`: one a core.
    ///
    /// # Errors
    /// [`SweepError`] for a count of zero or threads that do not start.
    pub fn new(threads: Option<usize>) -> Result<Self, SweepError> {
        if threads == Some(0) {
            return Err(Invalid::new("threads", 0, "give a whole number, 1 or greater").into());
        }
        Ok(Self(rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?))
    }
}

/// How a sweep runs; nothing here changes a row.
pub struct Control<'a> {
    /// Who does the work.
    pub workers: &'a Workers,
    /// Points a worker takes at once; `None`: chosen from the range.
    pub chunk: Option<usize>,
    /// Set to stop early: a point under way comes back with outcome `cancelled`, points not begun
    /// are left out.
    pub cancel: &'a AtomicBool,
    /// Called with the number of points finished since the last call, from any worker.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl Control<'_> {
    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// Most points a worker takes at once unless told otherwise.
const CHUNK: u64 = 256;
/// Points a worker checks at once, some hundred microseconds' work.
const CHECKED: u64 = 4096;

/// Checks every point of a study without running it; a cancelled check ends early. `progress` is
/// called as in [`Control`].
///
/// # Errors
/// Axes over the same quantity, too many points, or the first invalid point.
pub fn validate(
    study: &Study,
    workers: &Workers,
    cancel: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<(), Invalid> {
    study.spec.distinct()?;
    distinct(&study.axes)?;
    fitting(study.spec.choices().kind, &study.axes)?;
    let points = study.points()?;
    // A cancelled check must find something, or the search would visit every point left.
    let first_fault = |chunk: u64| {
        if cancel.load(Ordering::Relaxed) {
            return Some(None);
        }
        let range = chunk * CHECKED..points.min((chunk + 1) * CHECKED);
        let count = range.end - range.start;
        let mut points = range.take_while(|_| !cancel.load(Ordering::Relaxed));
        let fault = points.find_map(|point| study.design(point).err()).map(Some);
        progress(count);
        fault
    };
    let chunks = points.div_ceil(CHECKED);
    let fault = workers.0.install(|| (0..chunks).into_par_iter().find_map_first(first_fault));
    fault.flatten().map_or(Ok(()), Err)
}

/// Runs a range of points and builds the tables of the study over them.
///
/// # Errors
/// [`SweepError`] for an invalid point.
pub fn sweep(
    study: &Study,
    points: Range<u64>,
    control: &Control<'_>,
) -> Result<Tables, SweepError> {
    let units = study.units()?;
    let length = points.end.saturating_sub(points.start);
    // Some chunks a worker, so that a small grid keeps all of them busy.
    let share = length.div_ceil(8 * control.workers.0.current_num_threads() as u64);
    let chunk = control.chunk.map_or(CHUNK.min(share), |chunk| chunk as u64).max(1);
    let parts: Vec<Result<Tables, SweepError>> = control.workers.0.install(|| {
        (0..length.div_ceil(chunk))
            .into_par_iter()
            .map(|index| {
                let first = points.start + index * chunk;
                let range = first..points.end.min(first + chunk);
                run_chunk(study, range, units, control)
            })
            .collect()
    });
    join(study, units, parts)
}

fn join(
    study: &Study,
    units: UnitSystem,
    parts: Vec<Result<Tables, SweepError>>,
) -> Result<Tables, SweepError> {
    let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut tables = Tables::new();
    for &table in study.tables.iter().filter(|table| Table::SWEEP.contains(table)) {
        let batches = parts.iter().filter_map(|part| part.get(&table));
        tables.insert(table, concat_batches(&schema_in(study, table, units), batches)?);
    }
    Ok(tables)
}

/// What a study wants from each run.
struct Request {
    summary: bool,
    impacts: bool,
    episodes: bool,
    envelope: bool,
    wanted: Wanted,
    steady: SteadyWanted,
    reduction: bool,
    errors: bool,
}

impl Request {
    fn new(study: &Study) -> Self {
        let asked = |table| study.tables.contains(&table);
        let any = |names: &[&str]| names.iter().any(|name| study.measures.contains(name));
        Self {
            summary: asked(Table::Summary),
            impacts: asked(Table::Impacts),
            episodes: asked(Table::Episodes),
            envelope: asked(Table::Envelope),
            wanted: Wanted {
                peaks: any(&[
                    "damping_ratio_1",
                    "damping_ratio_3",
                    "damping_ratio_10",
                    "damping_ratio_fit",
                ]),
                settling: any(&["settling_time_10", "settling_time_5", "settling_time_2"]),
                residual: any(&["residual_amplitude"]),
                ledger: any(&["energy_viscous", "energy_pivot", "energy_work", "energy_residual"]),
            },
            steady: SteadyWanted {
                amplitude: any(&["amplitude_max", "reduction"]),
                rms: any(&["amplitude_rms"]),
                acceleration: any(&["transmissibility"]),
                regime: any(&["regime"]),
                impacts: any(&["impacts_per_cycle"]),
                strobes: asked(Table::Stroboscope),
            },
            reduction: any(&["reduction"]),
            errors: study.errors,
        }
    }
}

impl Request {
    /// What is wanted of a driven run's steady state; `None` in free decay, and if nothing is.
    fn steady_of<S: System>(&self, system: &S) -> Option<SteadyWanted> {
        Some(self.steady).filter(|it| system.is_driven() && *it != SteadyWanted::default())
    }
}

fn run_chunk(
    study: &Study,
    points: Range<u64>,
    units: UnitSystem,
    control: &Control<'_>,
) -> Result<Tables, SweepError> {
    let request = Request::new(study);
    let mut builders: BTreeMap<Table, TableBuilder> = study
        .tables
        .iter()
        .filter(|table| Table::SWEEP.contains(table))
        .map(|&table| (table, TableBuilder::new(schema_in(study, table, units))))
        .collect();
    let begun = points.start;
    let mut end = begun;
    while end < points.end && !control.cancelled() {
        run_point(study, end, &request, control.cancel, &mut builders)?;
        end += 1;
    }
    (control.progress)(end - begun);
    builders.into_iter().map(|(table, builder)| Ok((table, builder.finish()?))).collect()
}

fn run_point(
    study: &Study,
    point: u64,
    request: &Request,
    cancel: &AtomicBool,
    builders: &mut BTreeMap<Table, TableBuilder>,
) -> Result<(), SweepError> {
    let design = study.design(point)?;
    match &design.scene {
        Scene::Siva { system, start } => {
            let run = Point { study, point, design: &design, system, request, builders };
            run.go(start, cancel)
        }
        Scene::Piva { system, start, .. } => {
            let run = Point { study, point, design: &design, system, request, builders };
            run.go(start, cancel)
        }
    }
}

/// One point of a study and where its rows go.
struct Point<'a, S> {
    study: &'a Study,
    point: u64,
    design: &'a Design,
    system: &'a S,
    request: &'a Request,
    builders: &'a mut BTreeMap<Table, TableBuilder>,
}

impl<S: Differentiable> Point<'_, S> {
    fn go(self, start: &S::Start, cancel: &AtomicBool) -> Result<(), SweepError> {
        let Self { study, point, design, system, request, builders } = self;
        let mut observers = (
            (request.impacts || request.episodes).then(Events::default),
            (
                request.envelope.then(Envelope::default),
                (
                    request.summary.then(|| Measures::<S>::new(request.wanted)),
                    (
                        request.steady_of(system).map(|wanted| Steady::new(design.window, wanted)),
                        request.errors.then(Errors::default),
                    ),
                ),
            ),
        );
        let tally = simulate(system, start, &design.limits, Some(cancel), &mut observers)?;
        let (events, (envelope, (measures, (steady, errors)))) = observers;
        let scale = &design.scale;
        // Points are counted below 2^32 by `Study::points`.
        let number = point as u32;
        for (table, builder) in builders {
            match table {
                Table::Summary => {
                    if let Some(measures) = &measures {
                        let swept = study.swept(point).map(Cell::Number);
                        let bare = match request.reduction && system.is_driven() {
                            true => design.amplitude_without_absorber(cancel)?,
                            false => None,
                        };
                        let settled = steady.as_ref().map(|steady| rows::Settled {
                            values: steady.values(),
                            bare,
                            moves_base: design.scene.moves_base(),
                        });
                        let row = rows::summary(
                            &tally,
                            measures.values(),
                            settled.as_ref(),
                            errors.as_ref(),
                            study.measures,
                            design,
                        );
                        builder.row(std::iter::once(Cell::Point(number)).chain(swept).chain(row));
                    }
                }
                Table::Impacts => {
                    for (index, impact) in
                        events.iter().flat_map(|events| &events.impacts).enumerate()
                    {
                        let angles =
                            system.impact_angles(impact).filter(|_| design.scene.has_angle());
                        let error = errors.as_ref().and_then(|errors| errors.impacts.get(index));
                        builder.row(rows::impact(number, index, impact, angles, error, scale));
                    }
                }
                Table::Episodes => {
                    for (index, episode) in
                        events.iter().flat_map(|events| &events.episodes).enumerate()
                    {
                        builder.row(rows::episode(number, index, episode, scale));
                    }
                }
                Table::Envelope => {
                    if let Some(envelope) = &envelope {
                        for index in 0..envelope.peaks.len() {
                            builder.row(rows::peak(number, index, &envelope.peaks, scale));
                        }
                    }
                }
                Table::Stroboscope => {
                    let mut before = None;
                    for strobe in steady.iter().flat_map(Steady::strobes) {
                        builder.row(rows::strobe(number, before, strobe, scale));
                        before = Some(strobe);
                    }
                }
                Table::Trajectory => {}
            }
        }
        Ok(())
    }
}
