//! The functions of the extension module.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use iva_sweep::Invalid;
use iva_sweep::choices::Choices;
use iva_sweep::columns::{Better, columns, ranked};
use iva_sweep::design::{Design, Spec};
use iva_sweep::fields::{FieldId, Quantity};
use iva_sweep::motion as paths;
use iva_sweep::sampling::Sampling;
use iva_sweep::scene::Angles;
use iva_sweep::slot::Slot;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{self as engine, SweepError};
use iva_sweep::units::UnitSystem;
use iva_verify as exact;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments;
use crate::arrow_table::ArrowTable;
use crate::errors::invalid;
use crate::worker;

/// Result tables by name.
pub(crate) type Tables = BTreeMap<&'static str, ArrowTable>;
type Units = BTreeMap<String, String>;

/// The numbers of a part that a kind of absorber has: (name, allowed values in words, help) in the
/// order of the table.
#[pyfunction]
pub fn fields(part: &str, kind: &str) -> PyResult<Vec<(&'static str, &'static str, &'static str)>> {
    let part = arguments::part(part)?;
    let mut choices = Choices::default();
    choices.choose("kind", kind).map_err(invalid)?;
    Ok(FieldId::all()
        .map(FieldId::info)
        .filter(|field| field.part == part)
        .filter(|field| field.kinds.contains(&choices.kind))
        .map(|field| (field.name, field.allowed.words(), field.help))
        .collect())
}

/// Checks the given fields of one part; raises ValueError for the first that cannot be used, or
/// that sets the same quantity as another.
#[pyfunction]
pub fn check(part: &str, values: Vec<(String, f64)>) -> PyResult<()> {
    arguments::check(arguments::part(part)?, &values).map_err(invalid)
}

/// Checks the table of a restitution, of points (approach speed, restitution), beside the numbers given for its absorber;
/// raises ValueError for the first point that does not fit, or a number that sets the restitution as well.
#[pyfunction]
pub fn check_restitution_table(points: Vec<[f64; 2]>, values: Vec<(String, f64)>) -> PyResult<()> {
    arguments::check_table(&points, &values).map_err(invalid)
}

/// Checks the words chosen for an absorber, its kind first; raises ValueError for the first that
/// cannot be used.
#[pyfunction]
pub fn check_choices(words: Vec<(String, String)>) -> PyResult<()> {
    let mut choices = Choices::default();
    words.iter().try_for_each(|(name, word)| choices.choose(name, word)).map_err(invalid)
}

/// Of each mode its frequency in rad/s and damping ratio; the shapes of all modes at each point; and whether the modes
/// exchange no energy. Of a structure with several modes, by its entries.
type Modes = (Vec<(f64, f64)>, Vec<(String, Vec<f64>)>, bool);

/// The modes of a structure.
#[pyfunction]
pub fn modes(entries: &Bound<'_, PyDict>) -> PyResult<Modes> {
    let modes = arguments::structure(entries)?.in_si().map_err(invalid)?;
    let of = |mode| Some((modes.frequency(mode)?, modes.damping_ratio(mode)?));
    let each = (0..modes.count()).filter_map(of).collect();
    let shapes = |name: &str| Some((name.to_owned(), modes.shapes(name)?.to_vec()));
    let points = modes.points().filter_map(shapes).collect();
    Ok((each, points, modes.is_separate()))
}

/// The measures of which the larger is the better.
#[pyfunction]
pub fn larger_is_better() -> Vec<&'static str> {
    let larger = ranked().filter(|column| column.better == Some(Better::Larger));
    larger.map(|column| column.name).collect()
}

/// The sentence of the units that the fields of a primary system set.
#[pyfunction]
pub fn primary_units(spec: &Bound<'_, PyDict>) -> PyResult<&'static str> {
    Ok(arguments::spec(spec)?.units().map_err(invalid)?.sentence())
}

/// The name of the units that the fields of a primary system set: si, seconds or natural.
#[pyfunction]
pub fn unit_system(spec: &Bound<'_, PyDict>) -> PyResult<&'static str> {
    Ok(arguments::spec(spec)?.units().map_err(invalid)?.name())
}

/// The numbers of a scene in the user's units, whatever alternatives they were given by; of a pendulum its own
/// besides, without length and contact distance where nothing depends on them. Of several absorbers those of one.
#[pyfunction]
#[pyo3(signature = (spec, absorber = 0))]
pub fn design<'py>(
    py: Python<'py>,
    spec: &Bound<'py, PyDict>,
    absorber: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let spec = arguments::spec(spec)?;
    let Design { scene, scale, .. } = spec.design().map_err(invalid)?;
    let numbers = PyDict::new(py);
    numbers.set_item("absorbers", scene.count())?;
    numbers.set_item("mass", scale.mass)?;
    numbers.set_item("natural_frequency", scale.natural_frequency)?;
    numbers.set_item("damping_ratio", scene.damping_ratio())?;
    let number = absorber;
    let absorber = scene.absorber_of(number);
    numbers.set_item("mass_ratio", absorber.map(|absorber| absorber.mass_ratio))?;
    numbers.set_item("clearance", absorber.map(|absorber| absorber.clearance))?;
    numbers.set_item("gap_offset", scene.gap_offset(number))?;
    let [minus, plus] = scene.walls_of(number).map(f64::is_finite);
    numbers.set_item("walls", (minus, plus))?;
    let stiffness = scale.natural_frequency * scale.natural_frequency;
    let along = scene.gravity_along(number).map(|along| along * stiffness);
    numbers.set_item("gravity_along", along.unwrap_or(0.0))?;
    let tie = scene.tie_of(number);
    numbers.set_item("spring", tie.spring * scale.mass * stiffness)?;
    numbers.set_item("gap_damping", tie.damping * scale.mass * scale.natural_frequency)?;
    let parameters = scene.pendulum_of(number);
    // I/(m b²), to which the deceleration of a pendulum at its point of contact belongs.
    let heavier = parameters.map_or(1.0, |it| {
        let lever = it.length / it.contact_distance;
        it.inertia_ratio * (lever * lever)
    });
    let inertia = absorber.map_or(0.0, |it| it.mass_ratio) * heavier;
    let friction = scene.friction_of(number) * stiffness;
    numbers.set_item("friction", friction * scale.mass * inertia)?;
    let pendulum = parameters.map(|pendulum| {
        let own = PyDict::new(py);
        let hangs = scene.has_angle();
        own.set_item("length", hangs.then_some(pendulum.length))?;
        own.set_item("contact_distance", hangs.then_some(pendulum.contact_distance))?;
        own.set_item("inertia_ratio", pendulum.inertia_ratio)?;
        own.set_item("frequency", pendulum.frequency_ratio * scale.natural_frequency)?;
        own.set_item("damping_ratio", pendulum.pivot_damping_ratio)?;
        own.set_item("spring_frequency", pendulum.spring_ratio * scale.natural_frequency)?;
        own.set_item("inclination", scene.inclination_of(number))?;
        own.set_item("small", pendulum.angles == Angles::Small)?;
        PyResult::Ok(own)
    });
    numbers.set_item("pendulum", pendulum.transpose()?)?;
    Ok(numbers)
}

/// What a scene, swept or not, has that was hardly meant, a sentence each.
#[pyfunction]
#[pyo3(signature = (spec, sampling = None))]
pub fn doubts(
    spec: &Bound<'_, PyDict>,
    sampling: Option<&Bound<'_, PyTuple>>,
) -> PyResult<Vec<String>> {
    let points = sampling.map(arguments::sampling).transpose()?.unwrap_or_default();
    Ok(iva_sweep::doubts::doubts(&arguments::spec(spec)?, &points))
}

/// What the contacts of a run amount to, from the instants of its impacts and the number of the absorber of each.
#[pyfunction]
pub fn verdict_on_contacts(
    spec: &Bound<'_, PyDict>,
    times: Vec<f64>,
    absorbers: Vec<u64>,
) -> PyResult<Option<String>> {
    let impacts = times.into_iter().zip(absorbers);
    Ok(iva_sweep::doubts::contacts::verdict(&arguments::spec(spec)?, impacts))
}

/// Sentence and table → column → unit in one of the unit systems, with the swept keys.
#[pyfunction]
pub fn column_units(
    system: &str,
    swept: Vec<String>,
) -> PyResult<(&'static str, BTreeMap<&'static str, Units>)> {
    let system =
        UnitSystem::ALL.into_iter().find(|units| units.name() == system).ok_or_else(|| {
            let rule = "give si, seconds or natural";
            invalid(Invalid::new("units", system, rule))
        })?;
    let mut tables = BTreeMap::new();
    for table in Table::ALL {
        let mut units = Units::new();
        let mut add = |name: &str, quantity| {
            units.insert(name.to_owned(), system.unit(quantity).to_owned());
        };
        add("point", Quantity::Count);
        for column in columns(table) {
            add(column.name, column.quantity);
        }
        if table == Table::Summary {
            for key in &swept {
                let slot = Slot::from_key(key).map_err(invalid)?;
                add(key, slot.info().quantity);
            }
        }
        tables.insert(table.name(), units);
    }
    Ok((system.sentence(), tables))
}

/// Runs one scene; returns its tables by name.
#[pyfunction]
#[pyo3(signature = (spec, measures = None, tables = None, errors = false))]
pub fn simulate(
    py: Python<'_>,
    spec: &Bound<'_, PyDict>,
    measures: Option<Vec<String>>,
    tables: Option<Vec<String>>,
    errors: bool,
) -> PyResult<Tables> {
    let study = single(spec, measures, tables, errors)?;
    match worker::at_once(py, || engine::run_inline(&study, BRIEF))? {
        Some(tables) => Ok(named(tables)),
        None => run(py, study),
    }
}

/// Number of stretches of motion, some milliseconds of work, above which a call gets its own thread.
const BRIEF: u64 = 5000;

/// A study of one scene, with the named tables (without names all) and always the summary, which
/// has the outcome of the run.
fn single(
    spec: &Bound<'_, PyDict>,
    measures: Option<Vec<String>>,
    tables: Option<Vec<String>>,
    errors: bool,
) -> PyResult<Study> {
    let all = || Table::SWEEP.map(|table| table.name().to_owned()).to_vec();
    let mut names = tables.unwrap_or_else(all);
    names.push(Table::Summary.name().to_owned());
    let spec = arguments::spec(spec)?;
    arguments::study(spec, Sampling::default(), &names, measures.as_deref(), errors)
}

/// A finding: table, rows, rows of the exact run, rows alike, largest error and its column.
type Found = (&'static str, usize, usize, usize, Option<f64>, Option<&'static str>);

/// Runs one scene in doubles and in numbers of twice the precision; returns tables of errors, and what
/// was found.
#[pyfunction]
#[pyo3(signature = (spec, measures = None, tables = None))]
pub fn verify(
    py: Python<'_>,
    spec: &Bound<'_, PyDict>,
    measures: Option<Vec<String>>,
    tables: Option<Vec<String>>,
) -> PyResult<(Tables, Vec<Found>)> {
    let study = single(spec, measures, tables, false)?;
    let verification = worker::run(py, None, move |shared| exact::verify(&study, &shared.cancel))?;
    let findings = verification.findings.iter().map(|finding| {
        let (error, column) = finding.largest.unzip();
        let [rows, exact] = finding.rows;
        (finding.table.name(), rows, exact, finding.alike, error, column)
    });
    Ok((named(verification.errors), findings.collect()))
}

/// Derivatives of the results of one scene, by runs in numbers of twice the precision; returns tables of them.
#[pyfunction]
#[pyo3(signature = (spec, key, measures = None, tables = None))]
pub fn gradients(
    py: Python<'_>,
    spec: &Bound<'_, PyDict>,
    key: String,
    measures: Option<Vec<String>>,
    tables: Option<Vec<String>>,
) -> PyResult<Tables> {
    let study = single(spec, measures, tables, false)?;
    worker::run(py, None, move |shared| exact::gradients(&study, &key, &shared.cancel)).map(named)
}

pub(crate) fn named(tables: engine::Tables) -> Tables {
    tables.into_iter().map(|(table, batch)| (table.name(), batch.into())).collect()
}

/// Runs a study of one point on a thread of its own.
fn run(py: Python<'_>, study: Study) -> PyResult<Tables> {
    let tables = worker::run(py, None, move |shared| {
        let workers = engine::Workers::caller();
        let control = engine::Control {
            workers: &workers,
            chunk: None,
            cancel: &shared.cancel,
            progress: &|_| {},
        };
        engine::sweep(&study, 0..1, &control)
    })?;
    Ok(named(tables))
}

/// The motion of one scene, equidistant samples and both states of every impact.
#[pyfunction]
pub fn trajectory(
    py: Python<'_>,
    spec: &Bound<'_, PyDict>,
    samples_per_period: &Bound<'_, PyAny>,
) -> PyResult<ArrowTable> {
    let spec = arguments::spec(spec)?;
    let samples = arguments::whole("samples_per_period", samples_per_period, 1_000_000_000)?;
    motion(py, move |cancel| paths::trajectory(&spec, samples as u32, cancel))
}

/// The state of one scene at given times, in the order given.
#[pyfunction]
pub fn states(py: Python<'_>, spec: &Bound<'_, PyDict>, times: Vec<f64>) -> PyResult<ArrowTable> {
    let spec: Spec = arguments::spec(spec)?;
    let field = |index| format!("times[{index}]");
    motion(py, move |cancel| paths::states(&spec, &times, &field, cancel))
}

/// The state of one scene at one time.
#[pyfunction]
pub fn state(py: Python<'_>, spec: &Bound<'_, PyDict>, time: f64) -> PyResult<ArrowTable> {
    let spec: Spec = arguments::spec(spec)?;
    motion(py, move |cancel| paths::states(&spec, &[time], &|_| "time".to_owned(), cancel))
}

/// Displacements and velocities of the modes or coordinates of a structure at an instant of a run; `None` if the run ends before.
#[pyfunction]
pub fn state_of_modes(
    py: Python<'_>,
    spec: &Bound<'_, PyDict>,
    time: f64,
) -> PyResult<Option<[Vec<f64>; 2]>> {
    let spec: Spec = arguments::spec(spec)?;
    worker::run(py, None, move |shared| paths::modes(&spec, time, &shared.cancel))
}

fn motion(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> Result<RecordBatch, SweepError> + Send + 'static,
) -> PyResult<ArrowTable> {
    worker::run(py, None, move |shared| work(&shared.cancel)).map(ArrowTable::from)
}

/// The command `iva`: takes the whole argument list, returns the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, argv: Vec<OsString>) -> i32 {
    py.detach(move || iva_cli::main_with_args(argv))
}
