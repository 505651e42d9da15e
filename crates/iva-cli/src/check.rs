//! `iva check`: is the study valid, how large is it, how long will it take?

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use iva_store::table_file::encoded_size;
use iva_study::resolved::first_upper;
use iva_study::study_file::{StudyFile, read_study};
use iva_study::threads;
use iva_sweep::Invalid;
use iva_sweep::axis::Axis;
use iva_sweep::identity::Identity;
use iva_sweep::motion::{samples as samples_of_motion, trajectory};
use iva_sweep::plan::{Plan, Trial, spread};
use iva_sweep::sampling::{Rows, Sampling};
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Workers, sweep};
use iva_sweep::tables::schema;

use crate::args::CheckArgs;
use crate::cell::duration;
use crate::error::Error;
use crate::layout::wrap;
use crate::progress::Progress;
use crate::report::counted;
use crate::run_study::{size, warn, without_trajectory};
use crate::scene::describe;

/// Number of points run for the estimate; a study of up to twice as many is run whole.
const SAMPLES: u64 = 1024;
/// Number of points run in one batch, enough to fill the lanes of a worker.
const BATCH: usize = 64;
/// Time limit of the runs of the estimate; a batch that is not done by then is dropped.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time limit of the trial that finds into how many parts the study is divided.
const PLAN_PATIENCE: Duration = Duration::from_secs(3);
/// Largest number of points that are all checked; of a larger study this many are, spread over it.
const CHECKED: u64 = 1 << 19;
/// Largest number of samples of the trajectory that is computed for the estimate.
const TRAJECTORY_SAMPLES: f64 = 1e5;

/// Runs `iva check`; returns the text to print.
///
/// # Errors
/// Anything [`read_study`] and [`StudyFile::validate`] refuse.
pub(crate) fn check_command(args: &CheckArgs) -> Result<String, Error> {
    let file = read_study(&args.study)?;
    warn(&file, false);
    let located = |invalid| file.source.locate(&invalid);
    let points = file.study.points().map_err(located)?;
    check_points(&file, points)?;
    let units = file.study.units().map_err(located)?;
    let estimate = estimate(&file, points)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = points.min(cores as u64);
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{} is valid.", args.study.display());
    let sampling = &file.study.sampling;
    let grid = match sampling.is_empty() {
        true => "Points: 1 (no [sweep]: for `iva run`)".to_owned(),
        false => format!(
            "Points: {points} ({sampling}), in {}",
            estimate.plan.map_or("parts of a few points".to_owned(), |plan| format!(
                "{} of at most {}",
                counted(plan.parts(), "part"),
                counted(plan.part_points, "point")
            ))
        ),
    };
    let _ = writeln!(out, "{}", wrap(&grid));
    if points > CHECKED {
        let said = "Values are checked one by one, their combinations at some points; `iva sweep` checks \
                    every point before it runs any.";
        let _ = writeln!(out, "{}", wrap(said));
    }
    let _ = writeln!(out, "{}", wrap(&format!("{}.", first_upper(units.sentence()))));
    out.push_str(&describe(&file.study, points, units));
    let seconds = estimate.seconds / threads as f64;
    let about = if estimate.cut { "more than" } else { "about" };
    let time = match duration(seconds) {
        time if estimate.cut => format!("{about} {}", time.trim_start_matches("about ")),
        time => time,
    };
    let _ = writeln!(out, "Time: {time} on {}", counted(threads, "thread"));
    let total: f64 = estimate.sizes.iter().map(|(_, bytes)| bytes).sum();
    let _ = writeln!(out, "Size: {about} {} as Parquet", size(total));
    for (table, bytes) in &estimate.sizes {
        let _ = writeln!(out, "  {:12} {}", format!("{table}/"), size(*bytes));
    }
    let basis = if estimate.cut {
        "Time and size are those of a run that was stopped before its end; nothing was written."
            .to_owned()
    } else if estimate.samples == points {
        "Time and size are from a run of every point; nothing was written.".to_owned()
    } else {
        format!(
            "Time and size are scaled up from {} spread over the study; nothing was written.",
            counted(estimate.samples, "point")
        )
    };
    let _ = writeln!(out, "{}", wrap(&basis));
    Ok(out)
}

/// Checks every point of a study, or points spread over it if it has more than [`CHECKED`].
fn check_points(file: &StudyFile, points: u64) -> Result<(), Error> {
    if points <= CHECKED {
        let progress = Progress::new("checking", Some(points), false);
        let workers = threads::workers(None)?;
        file.validate(&workers, &AtomicBool::new(false), &|count| progress.add(count))?;
        progress.clear();
        return Ok(());
    }
    let located = |invalid| file.source.locate(&invalid);
    file.study.spec.distinct().map_err(located)?;
    let chosen = (0..CHECKED).map(|sample| spread(sample, CHECKED, points));
    for point in chosen.chain([points - 1]) {
        file.study.design(point).map_err(located)?;
    }
    Ok(())
}

/// A flag that is set once the given time has passed.
fn alarm(after: Duration) -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    thread::spawn(move || {
        thread::sleep(after);
        set.store(true, Ordering::Relaxed);
    });
    flag
}

/// Division, time and size of a study, estimated from some of its points.
struct Estimate {
    /// Division of the study into parts; `None` if finding it takes too long.
    plan: Option<Plan>,
    samples: u64,
    /// True if the only run was stopped, so that time and sizes are too small.
    cut: bool,
    /// Time of the whole study on one thread, in seconds.
    seconds: f64,
    /// Size of each table, in bytes.
    sizes: Vec<(Table, f64)>,
}

fn estimate(file: &StudyFile, points: u64) -> Result<Estimate, Error> {
    let study = without_trajectory(&file.study);
    let located = |invalid| file.source.locate(&invalid);
    let cancel = alarm(PATIENCE);
    let workers = Workers::caller();
    let control =
        Control { workers: &workers, chunk: Some(BATCH), cancel: &cancel, progress: &|_| {} };
    let is_over = || cancel.load(Ordering::Relaxed);
    let wanted = samples_of(points);
    let sampled = sampled(&study, wanted, points).map_err(located)?;
    let start = Instant::now();
    let (mut samples, mut seconds) = (0, 0.0);
    let mut batches = Vec::new();
    while samples < wanted {
        // As many points as the time left allows, at the mean time of those before.
        let each = start.elapsed().as_secs_f64() / samples as f64;
        let left = PATIENCE.saturating_sub(start.elapsed()).as_secs_f64();
        let batch = if samples == 0 { 1 } else { ((left / each) as u64).clamp(1, BATCH as u64) };
        let last = wanted.min(samples + batch);
        let tables = sweep(&sampled, samples..last, &control)
            .map_err(|error| file.source.locate_sweep(error))?;
        if is_over() && samples > 0 {
            // A run of the last batch may have been stopped.
            break;
        }
        batches.push(tables);
        samples = last;
        seconds = start.elapsed().as_secs_f64();
        if is_over() {
            break;
        }
    }
    let cut = is_over() && samples == 1;
    let factor = points as f64 / samples as f64;
    let located_sweep = |error| file.source.locate_sweep(error);
    let plan = if study.sampling.is_empty() {
        Some(Plan { points: 1, part_points: 1 })
    } else if cut {
        // The trial would run more points that take too long.
        None
    } else {
        let stop = alarm(PLAN_PATIENCE);
        let trial = Trial::run(&study, &threads::workers(None)?, &stop).map_err(located_sweep)?;
        let plan = Plan::new(&study, &trial).map_err(located)?;
        Some(plan).filter(|_| !stop.load(Ordering::Relaxed))
    };
    let parts = plan.map_or(1, |plan| plan.parts()) as f64;
    let identity = Identity::of(&study).map_err(located)?;
    let mut sizes = Vec::new();
    for table in &study.tables {
        let schema = schema(&study, *table, identity).map_err(located)?;
        let rows: Vec<_> = batches.iter().filter_map(|tables| tables.get(table).cloned()).collect();
        let empty = encoded_size(schema.clone(), &[])? as f64;
        let full = encoded_size(schema, &rows)? as f64;
        sizes.push((*table, parts * empty + factor * (full - empty)));
    }
    if file.study.tables.contains(&Table::Trajectory) {
        // Of a long trajectory fewer samples are computed, and the result is scaled up.
        let wanted = file.samples_per_period;
        let duration = file.study.spec.design().map_err(located)?.limits.duration;
        let count = samples_of_motion(duration, wanted).map_err(located)? as f64;
        let taken = (f64::from(wanted) * (TRAJECTORY_SAMPLES / count).min(1.0)).ceil();
        let more = f64::from(wanted) / taken;
        let stop = alarm(PATIENCE);
        let before = Instant::now();
        let rows = trajectory(&file.study.spec, taken as u32, &stop)
            .map_err(|error| file.source.locate_sweep(error))?;
        seconds += before.elapsed().as_secs_f64() * more;
        let schema = schema(&file.study, Table::Trajectory, identity).map_err(located)?;
        sizes.push((Table::Trajectory, encoded_size(schema, &[rows])? as f64 * more));
    }
    Ok(Estimate { plan, samples, cut, seconds: seconds * factor, sizes })
}

/// The study at points spread over it, in an order whose first points are spread over it as well.
fn sampled(study: &Study, wanted: u64, points: u64) -> Result<Study, Invalid> {
    if study.sampling.is_empty() {
        return Ok(study.clone());
    }
    let golden = (wanted as f64 * 0.618) as u64;
    let coprime = |step: &u64| gcd(*step, wanted) == 1;
    let step = (golden.max(1)..).find(coprime).unwrap_or(1);
    let chosen = (0..wanted).map(|sample| spread(sample * step % wanted, wanted, points));
    let rows: Vec<Vec<f64>> = chosen.map(|point| study.swept(point)).collect();
    let columns = study.sampling.keys().enumerate().map(|(column, swept)| {
        Axis::new(swept.key, rows.iter().map(|values| values[column]).collect())
    });
    let rows = Rows::new(columns.collect::<Result<_, _>>()?, 0)?;
    Ok(Study { sampling: Sampling::Rows(rows), ..study.clone() })
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn samples_of(points: u64) -> u64 {
    if points <= 2 * SAMPLES { points } else { SAMPLES }
}
