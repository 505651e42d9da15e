//! `iva sweep`: runs a study into a folder, shows its progress and prints the best points.

use std::sync::Mutex;

use arrow_array::RecordBatch;
use iva_store::manifest::Manifest;
use iva_study::report::Report;
use iva_study::run_sweep::{Sweep, Watch};
use iva_study::threads::workers;
use iva_sweep::done::Done;
use iva_sweep::study::{Study, Table};
use serde_json::{Map, Value, json};

use crate::args::SweepArgs;
use crate::error::Error;
use crate::interrupt;
use crate::layout::wrap;
use crate::log::Log;
use crate::progress::Progress;
use crate::report::BestPoints;
use crate::run_study::{folder, load, log_start, print_written};

/// Runs the points of a study; returns the text to print.
///
/// # Errors
/// Anything [`iva_study::read_study`] and [`Sweep::run`] refuse; a study without `[sweep]`.
pub(crate) fn sweep_command(args: &SweepArgs) -> Result<String, Error> {
    let log = Log::open(args.run.log.as_deref())?;
    let result = run(args, &log);
    log.end(&result);
    result
}

fn run(all: &SweepArgs, log: &Log) -> Result<String, Error> {
    let SweepArgs { resume, run: args } = all;
    let file = load(args)?;
    if file.study.sampling.is_empty() {
        return Err(Error::Refused(format!(
            "{} has no [sweep] section; add one, or use `iva run` for a single run",
            args.study.display()
        )));
    }
    let points = file.points()?;
    let units = file.study.units().map_err(|invalid| file.source.locate(&invalid))?;
    let style = args.style()?;
    log_start(log, args, &file)?;
    let watch = Watching {
        study: &file.study,
        best: Mutex::new(BestPoints::new(&file.report, &file.study)),
        checking: Progress::new("checking", Some(points), args.quiet),
        running: Mutex::new(None),
        quiet: args.quiet,
        log,
    };
    let dir = folder(args);
    let sweep = Sweep {
        file: &file,
        dir: &dir,
        style,
        resume: *resume,
        overwrite: args.overwrite,
        elsewhere: false,
        workers: &workers(args.threads.map(usize::from))?,
        cancel: interrupt::listen(),
    };
    let ran = sweep.run(&watch);
    watch.clear();
    let manifest = ran?;
    let mut out = String::new();
    match watch.best.into_inner().ok().flatten() {
        Some(best) if file.study.tables.contains(&Table::Summary) => {
            out.push_str(&best.print(&file.study, units));
        }
        Some(_) => out.push_str("No summary table was asked for, so no best points are listed.\n"),
        None => {
            let spec = file.study.spec(0).unwrap_or_else(|_| file.study.spec.clone());
            let left_out = Report::default_measure(&spec);
            let sentence = format!(
                "run.measures leaves out {left_out}, so no best points are listed; set report.best_by to another measure."
            );
            out.push_str(&wrap(&sentence));
            out.push('\n');
        }
    }
    let written: Vec<_> =
        manifest.tables.iter().map(|table| (table.clone(), manifest.total(table))).collect();
    out.push_str(&print_written(&dir, &written));
    Ok(out)
}

/// Observer of a sweep that keeps the progress bars, the log and the best points so far.
struct Watching<'a> {
    study: &'a Study,
    best: Mutex<Option<BestPoints>>,
    checking: Progress,
    running: Mutex<Option<Progress>>,
    quiet: bool,
    log: &'a Log,
}

impl Watching<'_> {
    fn clear(&self) {
        self.checking.clear();
        self.with_bar(Progress::clear);
    }

    fn with_bar(&self, act: impl Fn(&Progress)) {
        if let Ok(running) = self.running.lock() {
            running.iter().for_each(act);
        }
    }
}

impl Watch for Watching<'_> {
    fn checked(&self, points: u64) {
        self.checking.add(points);
    }

    fn planned(&self, manifest: &Manifest) {
        self.checking.clear();
        let plan = manifest.plan();
        self.log.event(
            "checked",
            json!({ "parts": plan.parts(), "part_points": plan.part_points, "points_done": manifest.done() }),
        );
        let progress = Progress::new("running", Some(plan.points), self.quiet);
        let failed = manifest.parts.values().map(|part| part.failed).sum();
        progress.begin_at(manifest.done(), failed);
        if let Ok(mut running) = self.running.lock() {
            *running = Some(progress);
        }
    }

    fn damaged(&self, files: &[String]) {
        for file in files {
            self.log.event("damaged", json!({ "file": file }));
            if !self.quiet {
                let said = format!("{file} is not what was written and is computed again");
                self.checking.say(&said);
            }
        }
    }

    fn done(&self, done: Done) {
        self.with_bar(|bar| bar.done(done));
    }

    fn part(&self, number: u64, manifest: &Manifest) {
        let rows: Map<String, Value> = manifest
            .tables
            .iter()
            .map(|table| (table.clone(), manifest.total(table).rows.into()))
            .collect();
        self.log.event("part", json!({ "part": number, "rows_so_far": rows }));
    }

    fn wants_rows(&self) -> bool {
        self.best.lock().is_ok_and(|best| best.is_some())
            && self.study.tables.contains(&Table::Summary)
    }

    fn rows(&self, summary: &RecordBatch) {
        if let Ok(mut best) = self.best.lock()
            && let Some(best) = best.as_mut()
        {
            best.add(summary);
        }
    }
}
