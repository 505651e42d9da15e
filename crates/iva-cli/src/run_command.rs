//! `iva run`: a single run with all its tables.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use arrow_array::RecordBatch;
use iva_store::manifest::Total;
use iva_store::output::Output;
use iva_store::table_file::part_schema;
use iva_study::error::Kept;
use iva_study::resolved::{first_upper, resolve, write};
use iva_study::study_file::{StudyFile, read_study};
use iva_study::threads::workers;
use iva_sweep::done::Done;
use iva_sweep::doubts::contacts;
use iva_sweep::identity::Identity;
use iva_sweep::motion::trajectory;
use iva_sweep::sampling::Sampling;
use iva_sweep::study::Table;
use iva_sweep::sweep::{Control, Tables, Workers, sweep};
use iva_sweep::tables::schema;
use iva_verify::{Verification, verify};
use serde_json::json;

use crate::args::RunPointArgs;
use crate::cell::number;
use crate::error::Error;
use crate::interrupt;
use crate::layout::wrap;
use crate::log::Log;
use crate::progress::Progress;
use crate::report::print_run;
use crate::run_study::{choose_tables, folder, log_start, print_written, warn, without_trajectory};
use crate::verified::{print_verified, write_errors};

/// Runs a study without a sweep, or one point of a sweep; returns the text to print.
///
/// # Errors
/// Anything [`read_study`], [`StudyFile::validate`] and [`Output`] refuse; a study with `[sweep]`
/// without `--point`; a fault while writing.
pub(crate) fn run_command(args: &RunPointArgs) -> Result<String, Error> {
    let log = Log::open(args.run.log.as_deref())?;
    let result = run(args, &log);
    log.end(&result);
    result
}

fn run(all: &RunPointArgs, log: &Log) -> Result<String, Error> {
    let RunPointArgs { point, verify: verified, run: args } = all;
    let mut file = read_study(&args.study)?;
    warn(&file, args.quiet);
    if let Some(point) = *point {
        single_out(&mut file, point)?;
    } else if !file.study.sampling.is_empty() {
        return Err(Error::Refused(format!(
            "{} has a [sweep] section; use `iva sweep`, or give --point N for one of its points",
            args.study.display()
        )));
    }
    choose_tables(&mut file, args)?;
    let style = args.style()?;
    let located = |invalid| file.source.locate(&invalid);
    let units = file.study.units().map_err(located)?;
    log_start(log, args, &file)?;
    let workers = workers(args.threads.map(usize::from))?;
    let cancel = interrupt::listen();
    file.validate(&workers, cancel, &|_| {})?;
    log.event("checked", json!({}));
    let text = write(&resolve(&file)?)?;
    let dir = folder(args);
    let mut output = Output::prepare(&dir, args.overwrite, style)?;
    let progress = Progress::new("running", Some(1), args.quiet);
    let computed = compute(&file, &workers, cancel);
    progress.clear();
    let (tables, failed) = computed?;
    let identity = Identity::of(&file.study).map_err(located)?;
    let mut written = Vec::new();
    for (table, rows) in &tables {
        written.push(write_table(&file, &mut output, identity, *table, rows)?);
    }
    let mut verification: Option<Verification> = None;
    if *verified {
        let found = verify(&without_trajectory(&file.study), cancel)
            .map_err(|error| file.source.locate_sweep(error))?;
        write_errors(&mut output, &found)?;
        verification = Some(found);
    }
    if cancel.load(Ordering::Relaxed) {
        return Err(iva_study::Error::Interrupted(Kept::nothing()).into());
    }
    output.commit(&file.study, identity, &text, failed)?;
    let mut out = String::new();
    if let Some(summary) = tables.get(&Table::Summary) {
        out.push_str(&print_run(summary, &file.study, units));
    }
    if let Some(impacts) = tables.get(&Table::Impacts) {
        let cell = |name, row| number(impacts, name, row);
        let hits = (0..impacts.num_rows())
            .filter_map(|row| Some((cell("time", row)?, cell("absorber", row)? as u64)));
        if let Some(verdict) = contacts::verdict(&file.study.spec, hits) {
            let _ = writeln!(out, "{}", wrap(&format!("{}.", first_upper(&verdict))));
        }
    }
    out.push_str(&print_written(&dir, &written));
    if let Some(verification) = &verification {
        out.push_str(&print_verified(verification, units, &dir));
    }
    Ok(out)
}

/// The tables of the run, with the trajectory if asked for, and the number of runs that did not finish.
fn compute(
    file: &StudyFile,
    workers: &Workers,
    cancel: &AtomicBool,
) -> Result<(Tables, u64), Error> {
    let located = |error| file.source.locate_sweep(error);
    let study = without_trajectory(&file.study);
    let failed = AtomicU64::new(0);
    let count = |done: Done| {
        failed.fetch_add(done.failed, Ordering::Relaxed);
    };
    let control = Control { workers, chunk: None, cancel, progress: &count };
    let mut tables = match study.tables.is_empty() {
        true => Tables::new(),
        false => sweep(&study, 0..1, &control).map_err(located)?,
    };
    if file.study.tables.contains(&Table::Trajectory) {
        let rows = trajectory(&file.study.spec, file.samples_per_period, cancel);
        tables.insert(Table::Trajectory, rows.map_err(located)?);
    }
    Ok((tables, failed.into_inner()))
}

fn write_table(
    file: &StudyFile,
    output: &mut Output,
    identity: Identity,
    table: Table,
    rows: &RecordBatch,
) -> Result<(String, Total), Error> {
    let schema =
        schema(&file.study, table, identity).map_err(|invalid| file.source.locate(&invalid))?;
    let contents = output.write_table(table, part_schema(&schema, &(0..1)), rows)?;
    let total = Total { files: 1, rows: contents.rows, bytes: contents.bytes };
    Ok((table.name().to_owned(), total))
}

/// Turns a sweep into a single run of one of its points, with every table.
fn single_out(file: &mut StudyFile, point: u64) -> Result<(), Error> {
    let points = file.points()?;
    if file.study.sampling.is_empty() || point >= points {
        let allowed = match points {
            1 => "the study has no [sweep]; leave --point out".to_owned(),
            _ => format!("give a number from 0 to {}", points - 1),
        };
        return Err(Error::Refused(format!("--point {point}: {allowed}")));
    }
    file.study.spec = file.study.spec(point).map_err(|invalid| file.source.locate(&invalid))?;
    file.study.sampling = Sampling::default();
    file.study.tables = Table::ALL.to_vec();
    Ok(())
}
