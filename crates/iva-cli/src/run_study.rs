//! `iva sweep` and `iva run`: from a study file to tables in a folder and a few lines of report.

use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use arrow_array::RecordBatch;
use iva_sweep::motion::trajectory;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Workers, sweep};
use iva_sweep::tables::schema;
use iva_sweep::verify::verify;
use serde_json::{Map, Value, json};

use crate::args::{RunArgs, RunPointArgs};
use crate::error::Error;
use crate::interrupt;
use crate::log::Log;
use crate::output::{Output, PART_POINTS};
use crate::progress::Progress;
use crate::report::{BestPoints, counted, print_run};
use crate::resolved::{resolve, write};
use crate::study_file::{NO_TRAJECTORY, StudyFile, read_study};
use crate::table_file::{TableFile, part_schema};
use crate::verified::{print_verified, write_errors};

/// Points computed and held in memory at once. A constant that divides [`PART_POINTS`], so that
/// the rows reach the files in the same portions on every machine.
const BATCH_POINTS: u64 = 4096;

/// What was written of one table.
struct Written {
    table: Table,
    parts: u64,
    rows: u64,
    bytes: u64,
}

/// Runs the grid of a study; returns what is to be printed.
///
/// # Errors
/// Anything [`read_study`], [`StudyFile::validate`] and [`Output`] refuse; a study without
/// `[sweep]`; a fault while writing.
pub(crate) fn sweep_command(args: &RunArgs) -> Result<String, Error> {
    let log = Log::open(args.log.as_deref())?;
    let result = run_grid(args, &log);
    log.end(&result);
    result
}

fn run_grid(args: &RunArgs, log: &Log) -> Result<String, Error> {
    let file = load(args)?;
    if file.study.axes.is_empty() {
        return Err(Error::Refused(format!(
            "{} has no [sweep] section; add one, or use `iva run` for a single run",
            args.study.display()
        )));
    }
    let points = file.study.points().map_err(|invalid| file.source.locate(&invalid))?;
    let mut best = BestPoints::new(&file.report, &file.study);
    let progress = Progress::new("running", points, args.quiet);
    let mut add = |summary: &RecordBatch, first| {
        if let Some(best) = &mut best {
            best.add(summary, first);
        }
    };
    let (dir, written) = compute(&file, args, log, &progress, &mut add, &mut |_, _| Ok(()))?;
    let mut out = String::new();
    match &best {
        Some(best) if file.study.tables.contains(&Table::Summary) => {
            let units = file.study.units()?;
            out.push_str(&best.print(&file.study, units));
        }
        Some(_) => out.push_str("No summary table was asked for, so no best points are listed.\n"),
        None => out.push_str(
            "run.measures leaves out settling_time_5, so no best points are listed;\nset \
             report.best_by to another measure.\n",
        ),
    }
    out.push_str(&print_written(&dir, &written));
    Ok(out)
}

/// Runs a study without axes; returns what is to be printed.
///
/// # Errors
/// As [`sweep_command`]; a study with `[sweep]`.
pub(crate) fn run_command(args: &RunPointArgs) -> Result<String, Error> {
    let log = Log::open(args.run.log.as_deref())?;
    let result = run_single(args, &log);
    log.end(&result);
    result
}

fn run_single(all: &RunPointArgs, log: &Log) -> Result<String, Error> {
    let RunPointArgs { point, verify: verified, run: args } = all;
    let mut file = read_study(&args.study)?;
    if let Some(point) = *point {
        single_out(&mut file, point)?;
    } else if !file.study.axes.is_empty() {
        return Err(Error::Refused(format!(
            "{} has a [sweep] section; use `iva sweep`, or give --point N for one of its points",
            args.study.display()
        )));
    }
    choose_tables(&mut file, args)?;
    let units = file.study.units().map_err(|invalid| file.source.locate(&invalid))?;
    let progress = Progress::new("running", 1, args.quiet);
    let mut out = String::new();
    let mut verification = None;
    let (dir, written) = compute(
        &file,
        args,
        log,
        &progress,
        &mut |summary, _| out = print_run(summary, &file.study, units),
        &mut |output, cancel| {
            if *verified {
                let found = verify(&without_trajectory(&file.study), cancel)
                    .map_err(|error| file.source.locate_sweep(error))?;
                write_errors(output, &found)?;
                verification = Some(found);
            }
            Ok(())
        },
    )?;
    out.push_str(&print_written(&dir, &written));
    if let Some(verification) = &verification {
        out.push_str(&print_verified(verification, units, &dir));
    }
    Ok(out)
}

/// Makes a study of one point of a grid.
fn single_out(file: &mut StudyFile, point: u64) -> Result<(), Error> {
    let points = file.points()?;
    if file.study.axes.is_empty() || point >= points {
        let allowed = match points {
            1 => "the study has no [sweep]; leave --point out".to_owned(),
            _ => format!("give a number from 0 to {}", points - 1),
        };
        return Err(Error::Refused(format!("--point {point}: {allowed}")));
    }
    file.study.spec = file.study.spec(point).map_err(|invalid| file.source.locate(&invalid))?;
    file.study.axes.clear();
    file.study.tables = Table::ALL.to_vec();
    Ok(())
}

fn load(args: &RunArgs) -> Result<StudyFile, Error> {
    let mut file = read_study(&args.study)?;
    choose_tables(&mut file, args)?;
    Ok(file)
}

/// Puts `--tables` in the place of `run.tables`.
fn choose_tables(file: &mut StudyFile, args: &RunArgs) -> Result<(), Error> {
    if let Some(tables) = &args.tables {
        let mut tables = tables.clone();
        tables.sort_unstable();
        tables.dedup();
        if !file.study.axes.is_empty() && tables.contains(&Table::Trajectory) {
            return Err(Error::Refused(format!("--tables trajectory: {NO_TRAJECTORY}")));
        }
        file.study.tables = tables;
    }
    Ok(())
}

/// Validates, prepares the folder, computes, writes and moves into place.
fn compute(
    file: &StudyFile,
    args: &RunArgs,
    log: &Log,
    progress: &Progress,
    on_summary: &mut dyn FnMut(&RecordBatch, u64),
    at_end: &mut dyn FnMut(&mut Output, &AtomicBool) -> Result<(), Error>,
) -> Result<(PathBuf, Vec<Written>), Error> {
    let style = args.style()?;
    log.event(
        "start",
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "study": args.study,
            "points": file.points()?,
            "threads": args.threads,
            "format": style.format.name(),
        }),
    );
    let workers = Workers::new(args.threads.map(usize::from))?;
    let cancel = interrupt::listen();
    let checking = Progress::new("checking", file.points()?, args.quiet);
    file.validate(&workers, cancel, &|count| checking.add(count))?;
    checking.clear();
    log.event("checked", json!({}));
    let text = write(&resolve(file)?)?;
    let dir = match &args.out {
        Some(dir) => dir.clone(),
        None => default_folder(&args.study),
    };
    let mut output = Output::prepare(&dir, args.overwrite, style)?;
    output.stage_study(&text)?;
    let written = write_points(file, &mut output, log, &workers, cancel, progress, on_summary);
    progress.clear();
    let mut written = match written {
        Ok(written) => written,
        Err(reason) => {
            let kept = keep_finished(file, output)?;
            return Err(Error::Incomplete { reason: Box::new(reason), kept });
        }
    };
    if file.study.tables.contains(&Table::Trajectory) {
        written.push(write_trajectory(file, &mut output, cancel)?);
    }
    at_end(&mut output, cancel)?;
    if cancel.load(Ordering::Relaxed) {
        return Err(Error::Interrupted(keep_finished(file, output)?));
    }
    output.commit()?;
    Ok((dir, written))
}

/// Moves the finished parts of a sweep that stopped midway into place; returns what is to be said.
fn keep_finished(file: &StudyFile, output: Output) -> Result<String, Error> {
    let parts = output.parts();
    let dir = output.dir().display().to_string();
    if parts == 0 || file.study.axes.is_empty() {
        return Ok("nothing was finished, so nothing was written".to_owned());
    }
    if output.replaces_tables() {
        return Ok(format!("the earlier tables in {dir} are as they were"));
    }
    output.commit()?;
    Ok(format!("the first {} points are written to {dir}", parts * PART_POINTS))
}

/// `results/<name of the study file>`; of a name like `...toml` all of it, for its stem is `..`.
fn default_folder(study: &Path) -> PathBuf {
    let stem = study.file_stem().filter(|stem| *stem != ".." && *stem != ".");
    Path::new("results").join(stem.or(study.file_name()).unwrap_or(study.as_os_str()))
}

/// The study with the tables that a sweep builds.
pub(crate) fn without_trajectory(study: &Study) -> Study {
    let mut study = study.clone();
    study.tables.retain(|table| *table != Table::Trajectory);
    study
}

fn write_points(
    file: &StudyFile,
    output: &mut Output,
    log: &Log,
    workers: &Workers,
    cancel: &AtomicBool,
    progress: &Progress,
    on_summary: &mut dyn FnMut(&RecordBatch, u64),
) -> Result<Vec<Written>, Error> {
    let study = without_trajectory(&file.study);
    if study.tables.is_empty() {
        return Ok(Vec::new());
    }
    let located = |invalid| file.source.locate(&invalid);
    let points = study.points().map_err(located)?;
    let finished = |count| progress.add(count);
    let control = Control { workers, chunk: None, cancel, progress: &finished };
    let mut written: Vec<Written> = Vec::new();
    for table in &study.tables {
        written.push(Written { table: *table, parts: 0, rows: 0, bytes: 0 });
    }
    for part in 0..points.div_ceil(PART_POINTS) {
        let range = part * PART_POINTS..points.min((part + 1) * PART_POINTS);
        let whole = write_part(file, &study, output, &control, range, &mut written, on_summary);
        if !matches!(whole, Ok(true)) {
            output.forget_part(part)?;
            return whole.map(|_| written);
        }
        let rows: Map<String, Value> =
            written.iter().map(|w| (w.table.to_string(), w.rows.into())).collect();
        log.event("part", json!({ "part": part, "rows_so_far": rows }));
    }
    Ok(written)
}

/// Runs the points of one part and writes its files; false if it was cancelled midway.
fn write_part(
    file: &StudyFile,
    study: &Study,
    output: &mut Output,
    control: &Control<'_>,
    points: Range<u64>,
    written: &mut [Written],
    on_summary: &mut dyn FnMut(&RecordBatch, u64),
) -> Result<bool, Error> {
    let located = |invalid| file.source.locate(&invalid);
    let mut files = Vec::with_capacity(study.tables.len());
    for table in &study.tables {
        let part = points.start / PART_POINTS;
        let schema = part_schema(&*schema(study, *table).map_err(located)?, part);
        let path = output.stage_part(*table, part)?;
        files.push(TableFile::create(&path, schema, output.style())?);
    }
    let mut first = points.start;
    while first < points.end {
        let last = points.end.min(first + BATCH_POINTS);
        let tables =
            sweep(study, first..last, control).map_err(|error| file.source.locate_sweep(error))?;
        for (file, written) in files.iter_mut().zip(&mut *written) {
            if let Some(rows) = tables.get(&written.table) {
                file.append(rows)?;
                written.rows += rows.num_rows() as u64;
            }
        }
        if let Some(summary) = tables.get(&Table::Summary) {
            on_summary(summary, first);
        }
        first = last;
        if control.cancel.load(Ordering::Relaxed) {
            return Ok(false);
        }
    }
    for (file, written) in files.into_iter().zip(written) {
        written.bytes += file.finish()?;
        written.parts += 1;
    }
    Ok(true)
}

fn write_trajectory(
    file: &StudyFile,
    output: &mut Output,
    cancel: &AtomicBool,
) -> Result<Written, Error> {
    let located = |invalid| file.source.locate(&invalid);
    let rows = trajectory(&file.study.spec, file.samples_per_period, cancel)
        .map_err(|error| file.source.locate_sweep(error))?;
    let schema = part_schema(&*schema(&file.study, Table::Trajectory).map_err(located)?, 0);
    let path = output.stage_part(Table::Trajectory, 0)?;
    let mut part = TableFile::create(&path, schema, output.style())?;
    part.append(&rows)?;
    Ok(Written {
        table: Table::Trajectory,
        parts: 1,
        rows: rows.num_rows() as u64,
        bytes: part.finish()?,
    })
}

fn print_written(dir: &Path, written: &[Written]) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "\nWritten to {}:", dir.display());
    let _ = writeln!(out, "  study.toml   the study with every default filled in");
    for Written { table, parts, rows, bytes } in written {
        let _ = writeln!(
            out,
            "  {:12} {}, {}, {}",
            format!("{table}/"),
            counted(*rows, "row"),
            size(*bytes as f64),
            counted(*parts, "file")
        );
    }
    out
}

/// A size in bytes for reading, to two or three figures.
pub(crate) fn size(bytes: f64) -> String {
    let (value, unit) = match bytes {
        b if b < 1e3 => return format!("{b:.0} bytes"),
        b if b < 1e6 => (b / 1e3, "kB"),
        b if b < 1e9 => (b / 1e6, "MB"),
        b => (b / 1e9, "GB"),
    };
    if value < 10.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_go_below_results_whatever_the_name() {
        for (study, folder) in [
            ("my.toml", "results/my"),
            ("deep/my.study.toml", "results/my.study"),
            ("...toml", "results/...toml"),
            ("..toml", "results/..toml"),
            ("study", "results/study"),
        ] {
            assert_eq!(default_folder(Path::new(study)), Path::new(folder), "{study}");
        }
    }
}
