//! Common parts of `iva sweep` and `iva run`: study, output folder, and the list of written files.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use iva_store::manifest::Total;
use iva_study::study_file::{NO_TRAJECTORY, StudyFile, read_study};
use iva_sweep::doubts::doubts;
use iva_sweep::study::{Study, Table};
use serde_json::json;

use crate::args::RunArgs;
use crate::error::Error;
use crate::layout::wrap;
use crate::log::Log;
use crate::report::counted;

/// Reads the study of a command and applies `--tables`.
///
/// # Errors
/// Anything [`read_study`] refuses, and tables that do not go with the study.
pub(crate) fn load(args: &RunArgs) -> Result<StudyFile, Error> {
    let mut file = read_study(&args.study)?;
    choose_tables(&mut file, args)?;
    warn(&file, args.quiet);
    Ok(file)
}

/// Says on standard error what a study has that was hardly meant.
pub(crate) fn warn(file: &StudyFile, quiet: bool) {
    if quiet {
        return;
    }
    for doubt in doubts(&file.study.spec, &file.study.sampling) {
        // If standard error is closed there is nobody left to tell.
        let _ = writeln!(anstream::stderr(), "{}", wrap(&format!("warning: {doubt}")));
    }
}

/// Replaces `run.tables` of the study by `--tables`, if that is given.
///
/// # Errors
/// [`Error::Refused`] for the trajectory of a sweep.
pub(crate) fn choose_tables(file: &mut StudyFile, args: &RunArgs) -> Result<(), Error> {
    if let Some(tables) = &args.tables {
        let mut tables = tables.clone();
        tables.sort_unstable();
        tables.dedup();
        if !file.study.sampling.is_empty() && tables.contains(&Table::Trajectory) {
            return Err(Error::Refused(format!("--tables trajectory: {NO_TRAJECTORY}")));
        }
        file.study.tables = tables;
    }
    Ok(())
}

/// Logs the `start` event: version, study, points, threads and format.
///
/// # Errors
/// As [`StudyFile::points`].
pub(crate) fn log_start(log: &Log, args: &RunArgs, file: &StudyFile) -> Result<(), Error> {
    log.event(
        "start",
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            // A name need not be UTF-8.
            "study": args.study.to_string_lossy(),
            "points": file.points()?,
            "threads": args.threads,
            "format": args.format.name(),
        }),
    );
    Ok(())
}

/// The output folder of a command.
pub(crate) fn folder(args: &RunArgs) -> PathBuf {
    args.out.clone().unwrap_or_else(|| default_folder(&args.study))
}

/// The default output folder, `results/<stem of the study file>`; where the stem is `.` or `..` the
/// whole name takes its place.
fn default_folder(study: &Path) -> PathBuf {
    let stem = study.file_stem().filter(|stem| *stem != ".." && *stem != ".");
    Path::new("results").join(stem.or(study.file_name()).unwrap_or(study.as_os_str()))
}

/// The study without the trajectory table, which no sweep builds.
pub(crate) fn without_trajectory(study: &Study) -> Study {
    let mut study = study.clone();
    study.tables.retain(|table| *table != Table::Trajectory);
    study
}

/// A list of the written tables with their rows, sizes and numbers of files.
pub(crate) fn print_written(dir: &Path, written: &[(String, Total)]) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "\nWritten to {}:", dir.display());
    let _ = writeln!(out, "  study.toml   the study with every default filled in");
    for (table, Total { files, rows, bytes }) in written {
        let _ = writeln!(
            out,
            "  {:12} {}, {}, {}",
            format!("{table}/"),
            counted(*rows, "row"),
            size(*bytes as f64),
            counted(*files, "file")
        );
    }
    out
}

/// A size in bytes, kB, MB or GB, rounded for reading.
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
