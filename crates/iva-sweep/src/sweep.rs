//! Runs the points of a study in parallel; rows are in the order of `point`.
//!
//! Each worker takes a share of consecutive points, runs them chunk by chunk and builds their rows; the shares
//! are joined in order. So the tables do not depend on the number of threads, nor on the size of a share.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use arrow_array::RecordBatch;
use arrow_schema::{ArrowError, SchemaRef};
use arrow_select::concat::concat_batches;
use iva_core::error::Invalid;
use iva_core::propagation::Errors;
use iva_core::run::observed::Beside;
use iva_core::run::side_by_side::{Listed, Tier};
use iva_core::simulate::Outcome;

use crate::cells::Cell;
use crate::done::Done;
use crate::engine::design::Design;
use crate::engine::ended::Ended;
use crate::engine::point::{Request, Seen, list, run};
use crate::engine::rows::RunRow;
use crate::side_by_side;
use crate::study::{Study, Table};
use crate::tables::{TableBuilder, schema_in, write_summary};
pub use crate::workers::{MAX_THREADS, STACK, Workers};

/// The tables of a range of points.
pub type Tables = BTreeMap<Table, RecordBatch>;

/// The error for a sweep that could not run.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A value that the user can correct.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// The workers could not be started.
    #[error("the worker threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A table could not be built.
    #[error("a result table could not be built: {0}")]
    Table(#[from] ArrowError),
}

/// How a sweep runs; nothing here changes a result.
pub struct Control<'a> {
    /// The worker threads.
    pub workers: &'a Workers,
    /// Number of points that a worker takes at once; `None`: chosen from the range.
    pub chunk: Option<usize>,
    /// Set it to stop early: points in progress have the outcome `cancelled`, points not begun are left out.
    pub cancel: &'a AtomicBool,
    /// Called from any worker with the counts since its last call.
    pub progress: &'a (dyn Fn(Done) + Sync),
}

impl Control<'_> {
    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// Largest number of points that are designed and run at once.
const CHUNK: u64 = 256;
/// Largest number of points that are all designed before the first of them is run: some megabytes.
pub const DESIGNED_FIRST: u64 = 4096;
/// Largest default number of points that one of several workers takes at once.
const SHARE: u64 = 4096;
/// Number of points that a worker checks at once, some hundred microseconds of work.
const CHECKED: u64 = 4096;

/// Checks every point of a study without running it; a cancelled check ends early. `progress` is
/// called with the number of points checked since the last call.
///
/// # Errors
/// Axes over the same quantity, too many points, or the first invalid point.
pub fn validate(
    study: &Study,
    workers: &Workers,
    cancel: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<(), Invalid> {
    checked(study)?;
    let points = study.points()?;
    // A cancelled check must return a result, or the search would visit all remaining points.
    let first_fault = |chunk: u64| {
        if cancel.load(Ordering::Relaxed) {
            return Some(None);
        }
        let range = chunk * CHECKED..points.min((chunk + 1) * CHECKED);
        let count = range.end - range.start;
        let mut points = range.take_while(|_| !cancel.load(Ordering::Relaxed));
        let mut designer = study.designer();
        let fault = points.find_map(|point| designer.design(point).err()).map(Some);
        progress(count);
        fault
    };
    let chunks = points.div_ceil(CHECKED);
    let fault = workers.first(chunks, first_fault);
    fault.flatten().map_or(Ok(()), Err)
}

/// Checks a study as a whole, without its points.
fn checked(study: &Study) -> Result<(), Invalid> {
    study.spec.distinct()?;
    study.sampling.check(&study.spec)
}

/// Runs a range of points and builds the tables of the study over them. An invalid point among at most
/// [`DESIGNED_FIRST`] of them is reported before any point is run.
///
/// # Errors
/// [`SweepError`] for an invalid point, or a study that is invalid as a whole.
pub fn sweep(
    study: &Study,
    points: Range<u64>,
    control: &Control<'_>,
) -> Result<Tables, SweepError> {
    checked(study)?;
    let schemas = schemas(study)?;
    let length = points.end.saturating_sub(points.start);
    // Several shares per worker, so that all workers stay busy.
    let share = match control.workers.count() as u64 {
        1 => length,
        workers => length.div_ceil(8 * workers).min(SHARE),
    };
    let share = control.chunk.map_or(share, |chunk| chunk as u64).max(1);
    let shares = length.div_ceil(share);
    let points_of = |index: u64| {
        let first = points.start + index * share;
        first..points.end.min(first + share)
    };
    let workers = control.workers;
    let parts = if length <= DESIGNED_FIRST {
        let designed = workers.map(shares, |index| study.designs(points_of(index)));
        let designed = designed.into_iter().collect::<Result<Vec<_>, _>>()?;
        workers.map(shares, |index| {
            let designs = Some(designed[index as usize].as_slice());
            run_share(study, points_of(index), designs, &schemas, control)
        })
    } else {
        workers.map(shares, |index| run_share(study, points_of(index), None, &schemas, control))
    };
    join(&schemas, parts)
}

type Schemas = BTreeMap<Table, SchemaRef>;

/// The schemas of the tables of a study.
fn schemas(study: &Study) -> Result<Schemas, Invalid> {
    let units = study.units()?;
    let tables = study.tables.iter().filter(|table| Table::SWEEP.contains(table));
    Ok(tables.map(|&table| (table, schema_in(study, table, units))).collect())
}

fn join(schemas: &Schemas, parts: Vec<Result<Tables, SweepError>>) -> Result<Tables, SweepError> {
    let mut parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
    if parts.len() == 1 {
        return Ok(parts.swap_remove(0));
    }
    let mut tables = Tables::new();
    for (table, schema) in schemas {
        let batches = parts.iter().filter_map(|part| part.get(table));
        tables.insert(*table, concat_batches(schema, batches)?);
    }
    Ok(tables)
}

/// Runs some points, chunk by chunk, and builds their tables.
fn run_share(
    study: &Study,
    points: Range<u64>,
    designed: Option<&[Design]>,
    schemas: &Schemas,
    control: &Control<'_>,
) -> Result<Tables, SweepError> {
    let request = Request::new(study);
    let count = (points.end - points.start) as usize;
    let mut builders = builders(schemas, count, count.max(MANY_EVENTS));
    let mut first = points.start;
    while first < points.end && !control.cancelled() {
        let chunk = first..points.end.min(first + CHUNK);
        let place = |point: u64| (point - points.start) as usize;
        let designs = match designed {
            Some(all) => Cow::Borrowed(&all[place(first)..place(chunk.end)]),
            None => Cow::Owned(study.designs(chunk.clone())?),
        };
        first = chunk.end;
        let done = run_chunk(study, chunk, &designs, &request, control, &mut builders)?;
        (control.progress)(done);
    }
    finish(builders)
}

fn run_chunk(
    study: &Study,
    points: Range<u64>,
    designs: &[Design],
    request: &Request,
    control: &Control<'_>,
    builders: &mut Builders,
) -> Result<Done, SweepError> {
    let cancel = control.cancel;
    let mut done = Done::default();
    let mut all = Vec::with_capacity(designs.len());
    let ended = side_by_side::run(designs, request, cancel)?;
    for two in designs.windows(2) {
        two[1].scene.share(&two[0].scene);
    }
    for (point, (design, ended)) in points.clone().zip(designs.iter().zip(ended)) {
        let ended = match ended {
            Some((ended, listed)) if request.has_rows() => {
                let Listed { events, errors, envelope, strobes, .. } = listed;
                let envelope = envelope.as_deref().unwrap_or_default();
                let strobes = strobes.as_deref().unwrap_or_default();
                let found = Seen { events, envelope, strobes, estimates: &errors };
                list(study, point, design, request, (&ended, &found), &mut into(builders));
                ended
            }
            Some((ended, _)) => ended,
            None if control.cancelled() => break,
            // Lists, springs, dashpots, friction and modes go one by one.
            None => run_point(study, point, design, request, cancel, builders)?,
        };
        done += ended.done();
        all.push(ended);
    }
    let rows: Vec<_> =
        designs.iter().zip(&all).map(|(design, ended)| RunRow::new(design, ended)).collect();
    if let Some(table) = builders.get_mut(&Table::Summary) {
        write_summary(table, study, &request.columns, points.start, &rows);
    }
    Ok(done)
}

type Builders = BTreeMap<Table, TableBuilder>;

/// Number of rows of the events of one run for which there is room at once: as many as most runs have.
const MANY_EVENTS: usize = 64;

/// Empty tables, with room for this number of rows in the summary, and in the tables of events.
fn builders(schemas: &Schemas, points: usize, events: usize) -> Builders {
    let rows = |table| if table == Table::Summary { points } else { events };
    let builder = |(&table, schema): (&Table, &SchemaRef)| {
        (table, TableBuilder::new(SchemaRef::clone(schema), rows(table)))
    };
    schemas.iter().map(builder).collect()
}

fn finish(builders: Builders) -> Result<Tables, SweepError> {
    builders.into_iter().map(|(table, builder)| Ok((table, builder.finish()?))).collect()
}

/// Runs a study of one point, with its summary, on the calling thread if that takes no more than `work`
/// stretches of motion. `None`: it takes more, it is in the fast tier, or its force is not a single harmonic
/// one.
///
/// # Errors
/// [`SweepError`] for an invalid point.
pub fn run_inline(study: &Study, work: u64) -> Result<Option<Tables>, SweepError> {
    checked(study)?;
    let mut design = study.design(0)?;
    let force = design.scene.force();
    if design.tier == Tier::Fast || force.is_some_and(|force| !force.is_single()) {
        return Ok(None);
    }
    let cut = design.limits.max_work > work;
    design.limits.max_work = design.limits.max_work.min(work);
    let mut builders = builders(&schemas(study)?, 1, MANY_EVENTS);
    let request = Request::new(study);
    let ended = run_point(study, 0, &design, &request, &AtomicBool::new(false), &mut builders)?;
    if cut && ended.tally.outcome == Outcome::WorkLimit {
        return Ok(None);
    }
    if let Some(table) = builders.get_mut(&Table::Summary) {
        write_summary(table, study, &request.columns, 0, &[RunRow::new(&design, &ended)]);
    }
    finish(builders).map(Some)
}

/// Runs a point and hands the rows of its events to the builders.
fn run_point(
    study: &Study,
    point: u64,
    design: &Design,
    request: &Request,
    cancel: &AtomicBool,
    builders: &mut Builders,
) -> Result<Ended, SweepError> {
    let beside: Beside<'_> = (study.errors.then(Box::<Errors>::default), Default::default());
    Ok(run(study, point, design, request, cancel, beside, &mut into(builders))?)
}

/// Takes the rows of events into the tables.
fn into(builders: &mut Builders) -> impl FnMut(Table, &mut dyn Iterator<Item = Cell>) {
    |table, cells| {
        if let Some(builder) = builders.get_mut(&table) {
            builder.row(cells);
        }
    }
}
