//! Study files in TOML: the study, its tables and measures, and the report.
//!
//! ```toml
//! version = 1
//! [primary]
//! damping_ratio = 0.01
//! [absorber]
//! kind = "siva"
//! mass_ratio = 0.1
//! restitution = 0.5
//! relative_clearance = 0.6
//! [start]
//! displacement = 1.0
//! [run]
//! periods = 60
//! [sweep]
//! relative_clearance = { start = 0.1, stop = 1.2, count = 111 }
//! mass_ratio = [0.05, 0.1, 0.15, 0.2]
//! ```
//!
//! The fields of `[primary]`, `[absorber]`, `[force]`, `[start]` and `[run]` and their ranges are those of
//! [`iva_sweep::fields::FIELDS`]; every error names file, line and column.

use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use iva_store::regular_file;
use iva_sweep::columns::{SUMMARY, Selection, ranked};
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::motion::samples;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Workers, validate};
use toml::de::{DeTable, DeValue};

use crate::absorbers;
use crate::error::Error;
use crate::forces;
use crate::report::Report;
use crate::sampling;
use crate::source::Source;
use crate::structure;
use crate::value::{
    Key, Value, entries, name, names, number, one_of, table, truth, unknown_key, whole_number,
};

/// Version of the study file's schema.
pub const STUDY_VERSION: u64 = 1;

/// Default of `run.samples_per_period`, the rows of the trajectory in a period 2π/ωn.
pub const SAMPLES_PER_PERIOD: u32 = 200;

/// The tables of a sweep if the study names none.
pub const SWEEP_TABLES: [Table; 2] = [Table::Summary, Table::Impacts];

/// Largest size of a study file in bytes; its text takes about 70 times as much memory while it is read.
pub(crate) const MOST_BYTES: u64 = 10_000_000;

/// Keys and sections of a study file.
const SECTIONS: [&str; 10] = [
    "version",
    "primary",
    "structure",
    "absorber",
    "force",
    "start",
    "run",
    "sampling",
    "sweep",
    "report",
];
/// The section of `iva optimise`, which the other commands cannot do anything with.
const OPTIMISE: &str = "optimise";
/// Allowed range of `run.samples_per_period`.
const SAMPLES_RANGE: (u64, u64) = (1, 1_000_000);
/// Allowed range of `report.count`.
const COUNT_RANGE: (u64, u64) = (1, 1_000_000);

/// The contents of a study file.
#[derive(Debug, Clone)]
pub struct StudyFile {
    /// Study; without a sweep its `tables` may contain the trajectory.
    pub study: Study,
    /// Rows of the trajectory in a period 2π/ωn, for single runs only.
    pub samples_per_period: u32,
    /// Settings of the table of best points.
    pub report: Report,
    /// Text of the file, for the places of errors found later.
    pub source: Source,
}

/// Reads a study file. The points of a grid are checked by [`StudyFile::validate`], not here.
///
/// # Errors
/// [`Error::UnreadableStudy`] if the file cannot be read or is not a regular one, [`Error::LargeStudy`] if it is
/// too large, [`Error::NotText`] if it is not UTF-8, and the errors of [`parse_study`].
pub fn read_study(path: &Path) -> Result<StudyFile, Error> {
    parse_study(path, &text_of(path)?)
}

/// Reads a study file that has a section `[optimise]`, all but that section.
///
/// # Errors
/// As [`read_study`], and [`Error::Study`] if the section is missing or something is swept beside it.
pub fn read_optimised(path: &Path) -> Result<StudyFile, Error> {
    let file = parse(path, &text_of(path)?, Some(OPTIMISE))?;
    if !file.study.sampling.is_empty() {
        return Err(file.source.missing(format!(
            "[sweep] beside [{OPTIMISE}]: give the distributions in [{OPTIMISE}.over], or leave one section out"
        )));
    }
    Ok(file)
}

/// Reads the text of a study file.
fn text_of(path: &Path) -> Result<String, Error> {
    let failed = |reason: io::Error| Error::UnreadableStudy { path: path.to_owned(), reason };
    let file = regular_file::open(path).map_err(failed)?;
    let mut size = file.metadata().map_err(failed)?.len();
    let mut bytes = Vec::new();
    if size <= MOST_BYTES {
        // The file may grow while it is read.
        file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
        size = bytes.len() as u64;
    }
    if size > MOST_BYTES {
        return Err(Error::LargeStudy { path: path.to_owned(), bytes: size });
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        Error::NotText { path: path.to_owned(), line }
    })
}

/// Reads the text of a study file; `path` is the name in messages, and files that the study names are relative
/// to its folder.
///
/// # Errors
/// [`Error::Study`], with line and column where there are any, for invalid contents, also of a record, and
/// [`Error::LargeRecord`] for a file of a record that is too large.
pub fn parse_study(path: &Path, text: &str) -> Result<StudyFile, Error> {
    parse(path, text, None)
}

/// Reads the text of a study file but for the section `aside`, which must be there.
fn parse(path: &Path, text: &str, aside: Option<&str>) -> Result<StudyFile, Error> {
    let mut source = Source::new(path, text);
    let document = DeTable::parse(text).map_err(|error| match error.span() {
        Some(span) if error.message() == "duplicate key" => {
            let key = source.literal(&span);
            source.error(span, format!("{key} is given twice; give it once"))
        }
        Some(span) => source.error(span, format!("not valid TOML: {}", error.message())),
        None => source.missing(format!("not valid TOML: {}", error.message())),
    })?;
    let root = document.get_ref();
    check_version(&source, root)?;
    if let Some(section) = aside.filter(|section| !root.contains_key(*section)) {
        return Err(source.missing(format!("the section [{section}] is missing")));
    }
    for (key, _) in entries(root) {
        let name = key.get_ref().as_ref();
        if name == OPTIMISE && aside.is_none() {
            let rule = format!("[{OPTIMISE}]: this section is for the command iva {OPTIMISE}");
            return Err(source.error(key.span(), rule));
        }
        if !SECTIONS.contains(&name) && aside != Some(name) {
            return Err(unknown_key(&source, "", key, &SECTIONS));
        }
    }
    let absorbers = match root.get_key_value(Part::Absorber.name()) {
        Some((key, value)) => absorbers::sections(&source, key, value)?,
        None => {
            return Err(source.missing(
                "the section [absorber] is missing: give kind = \"siva\", mass_ratio, \
                 restitution and relative_clearance, or kind = \"none\"",
            ));
        }
    };
    let mut spec = absorbers::spec(&mut source, &absorbers)?;
    if let Some((key, value)) = root.get_key_value(iva_sweep::structure::SECTION) {
        spec = structure::read(&mut source, key, value, spec)?;
    }
    let mut settings = Settings::default();
    for part in Part::ALL {
        match root.get_key_value(part.name()) {
            Some((key, value)) if part == Part::Force => {
                forces::read(&mut source, key, value, &mut spec)?;
            }
            Some(_) if part == Part::Absorber => {
                absorbers::read(&mut source, &absorbers, &mut spec)?;
            }
            Some((key, value)) => {
                read_part(&mut source, part, key, value, &mut spec, &mut settings)?;
            }
            None => {}
        }
    }
    let sampling = sampling::read(&mut source, root, &spec)?;
    let tables = tables_or_default(&source, &settings, !sampling.is_empty())?;
    let measures = settings.measures.unwrap_or_default();
    let study = Study { spec, sampling, tables, measures, errors: settings.errors };
    let report = Report::new(measures, &study.spec(0).unwrap_or_else(|_| study.spec.clone()));
    let report = match root.get_key_value("report") {
        Some((key, value)) => read_report(&source, key, value, report, measures)?,
        None => report,
    };
    Ok(StudyFile {
        study,
        samples_per_period: settings.samples_per_period.unwrap_or(SAMPLES_PER_PERIOD),
        report,
        source,
    })
}

impl StudyFile {
    /// The study file of a study made in a program, with default settings for trajectory and report.
    pub fn of(study: Study) -> Self {
        let spec = study.spec(study.sampling.first()).unwrap_or_else(|_| study.spec.clone());
        let report = Report::new(study.measures, &spec);
        let source = Source::new(Path::new("study"), "");
        Self { study, samples_per_period: SAMPLES_PER_PERIOD, report, source }
    }

    /// Number of points of the sweep; 1 without a sweep.
    ///
    /// # Errors
    /// [`Error::Study`] if there are too many points.
    pub fn points(&self) -> Result<u64, Error> {
        self.study.points().map_err(|invalid| self.source.locate(&invalid))
    }

    /// Checks every point, without running any; setting `cancel` ends the check early. `progress` is called with
    /// the number of points checked since the last call.
    ///
    /// # Errors
    /// [`Error::Study`] for the first invalid point, at the line of the field that causes it, for too many points,
    /// and for a trajectory with too many samples.
    pub fn validate(
        &self,
        workers: &Workers,
        cancel: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(), Error> {
        let located = |invalid| self.source.locate(&invalid);
        validate(&self.study, workers, cancel, progress).map_err(located)?;
        if self.study.tables.contains(&Table::Trajectory) {
            let design = self.study.design(0).map_err(located)?;
            samples(design.limits.duration, self.samples_per_period).map_err(located)?;
        }
        Ok(())
    }
}

/// The values of the keys of `[run]` that are not fields of the spec.
#[derive(Default)]
struct Settings {
    tables: Option<(Vec<Table>, std::ops::Range<usize>)>,
    measures: Option<Selection>,
    samples_per_period: Option<u32>,
    errors: bool,
}

fn check_version(source: &Source, root: &DeTable<'_>) -> Result<(), Error> {
    let Some(value) = root.get("version") else {
        return Err(source.missing(format!(
            "version is missing: give version = {STUDY_VERSION} on the first line"
        )));
    };
    let version = whole_number(source, "version", value, (1, u64::from(u32::MAX)))?;
    if version == STUDY_VERSION {
        Ok(())
    } else {
        let allowed = format!("this program reads version {STUDY_VERSION}");
        Err(source.bad_value("version", value.span(), &allowed))
    }
}

/// Reads the section of a part: its fields into `spec`, and other keys of `[run]` into `settings`.
fn read_part(
    source: &mut Source,
    part: Part,
    key: &Key<'_>,
    value: &Value<'_>,
    spec: &mut Spec,
    settings: &mut Settings,
) -> Result<(), Error> {
    let section = table(source, part.name(), key, value)?;
    source.note(part.name().to_owned(), key.span());
    for (key, value) in entries(section) {
        let bare = key.get_ref().as_ref();
        let path = format!("{}.{bare}", part.name());
        match (part, bare) {
            (Part::Run, "tables") => {
                settings.tables = Some((read_tables(source, &path, value)?, value.span()));
            }
            (Part::Run, "measures") => {
                settings.measures = Some(read_measures(source, &path, value)?);
            }
            (Part::Run, "errors") => settings.errors = truth(source, &path, value)?,
            (Part::Run, "samples_per_period") => {
                let samples = whole_number(source, &path, value, SAMPLES_RANGE)?;
                settings.samples_per_period = u32::try_from(samples).ok();
            }
            _ => {
                let Some(field) = FieldId::find(part, bare) else {
                    let known = absorbers::known_keys(part, spec.choices().kind);
                    return Err(unknown_key(source, part.name(), key, &known));
                };
                if let (true, DeValue::Array(items)) = (field.of_absorber(), value.get_ref()) {
                    absorbers::read_starts(source, field, key, (value, items), spec)?;
                    continue;
                }
                let number = number(source, &path, value, field.info().allowed)?;
                spec.set(field, number)
                    .map_err(|invalid| crate::value::at(source, value.span(), &invalid))?;
                source.note(path, key.span().start..value.span().end);
            }
        }
    }
    Ok(())
}

fn read_tables(source: &Source, field: &str, value: &Value<'_>) -> Result<Vec<Table>, Error> {
    let known = Table::ALL.map(Table::name);
    let mut tables = names(source, field, value, &known, Table::from_name)?;
    if tables.is_empty() {
        let allowed = format!("give at least one of {}", known.join(", "));
        return Err(source.bad_value(field, value.span(), &allowed));
    }
    tables.sort_unstable();
    Ok(tables)
}

/// The tables that the study names, or the default ones of a sweep or single run.
fn tables_or_default(
    source: &Source,
    settings: &Settings,
    swept: bool,
) -> Result<Vec<Table>, Error> {
    match &settings.tables {
        Some((tables, span)) if swept && tables.contains(&Table::Trajectory) => {
            Err(source.bad_value("run.tables", span.clone(), NO_TRAJECTORY))
        }
        Some((tables, _)) => Ok(tables.clone()),
        None if swept => Ok(SWEEP_TABLES.to_vec()),
        None => Ok(Table::ALL.to_vec()),
    }
}

/// Message for a sweep whose study names the table `trajectory`.
pub const NO_TRAJECTORY: &str = "a sweep has no trajectory table, only a single run \
     (`iva run`) has; give summary, impacts, episodes, envelope, stroboscope or absorbers";

fn read_measures(source: &Source, field: &str, value: &Value<'_>) -> Result<Selection, Error> {
    let known: Vec<&str> = SUMMARY.iter().map(|column| column.name).collect();
    let find = |name: &str| known.iter().position(|other| *other == name);
    let chosen = names(source, field, value, &known, find)?;
    Selection::from_names(chosen.into_iter().map(|index| known[index]))
        .map_err(|name| source.bad_value(field, value.span(), &format!("{name}: no such measure")))
}

fn read_report(
    source: &Source,
    key: &Key<'_>,
    value: &Value<'_>,
    mut report: Report,
    measures: Selection,
) -> Result<Report, Error> {
    for (key, value) in entries(table(source, "report", key, value)?) {
        match key.get_ref().as_ref() {
            "best_by" => {
                let known: Vec<&str> = ranked().map(|column| column.name).collect();
                let find = |name: &str| known.iter().find(|other| **other == name).copied();
                let text = value.get_ref().as_str().unwrap_or_default();
                if find(text).is_none() && SUMMARY.iter().any(|column| column.name == text) {
                    let rule =
                        format!("neither less nor more of it is better; give {}", one_of(&known));
                    return Err(source.bad_value("report.best_by", value.span(), &rule));
                }
                let best_by = name(source, "report.best_by", value, &known, find)?;
                if !measures.contains(best_by) {
                    return Err(source.bad_value(
                        "report.best_by",
                        value.span(),
                        "run.measures leaves this column out; add it there",
                    ));
                }
                report.best_by = Some(best_by);
            }
            "count" => {
                report.count = whole_number(source, "report.count", value, COUNT_RANGE)? as usize;
            }
            _ => return Err(unknown_key(source, "report", key, &["best_by", "count"])),
        }
    }
    Ok(report)
}

#[cfg(test)]
mod tests;
