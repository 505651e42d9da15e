//! Branches of periodic orbits for Python, in the user's units.

use iva_sweep::dynamics::branches::{
    self as engine, Begin, Chain, Complex, Condition, CurveWay, Curved, End, Followed, NoBranch,
    Row, Wall, Way,
};
use iva_sweep::dynamics::words::words;
use iva_sweep::slot::Slot;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments;
use crate::dynamics::shown;
use crate::errors::invalid;
use crate::worker;

/// A chain as Python holds it: the walls, which impacts begin a stick episode, whether it is symmetric, and the number of cycles.
type GivenChain = (Vec<i8>, Vec<bool>, bool, u32);
/// A condition as Python holds it: kind, index of flight or impact, and wall.
type GivenCondition = (String, usize, i8);
/// A special point as Python holds it: the chain, the condition, the value of the field, and the unknowns.
type GivenPoint = (GivenChain, GivenCondition, f64, Vec<f64>);
/// A range and steps: the range, the longest step, most points.
type GivenWay = ((f64, f64), f64, usize);

fn wall(number: i8) -> Wall {
    if number > 0 { Wall::Plus } else { Wall::Minus }
}

fn chain((walls, sticks, symmetric, cycles): GivenChain) -> Chain {
    Chain { walls: walls.into_iter().map(wall).collect(), sticks, symmetric, cycles }
}

fn given_chain(chain: &Chain) -> GivenChain {
    let walls = chain.walls.iter().map(|wall| wall.number()).collect();
    (walls, chain.sticks.clone(), chain.symmetric, chain.cycles)
}

fn condition((kind, index, side): &GivenCondition) -> PyResult<Condition> {
    Ok(match kind.as_str() {
        "fold" => Condition::Fold,
        "pitchfork" => Condition::Pitchfork,
        "flip" => Condition::Flip,
        "neimark_sacker" => Condition::NeimarkSacker,
        "grazing" => Condition::Grazing { flight: *index, wall: wall(*side) },
        "impact_vanishes" => Condition::ImpactVanishes { impact: *index },
        "impacts_coincide" => Condition::ImpactsCoincide,
        "slide_changes" => Condition::SlideChanges,
        "stick_begins" => Condition::StickBegins { impact: *index },
        other => return Err(PyValueError::new_err(format!("kind = {other}: no such point"))),
    })
}

fn given_condition(condition: Condition) -> GivenCondition {
    let (index, side) = match condition {
        Condition::Grazing { flight, wall } => (flight, wall.number()),
        Condition::ImpactVanishes { impact } | Condition::StickBegins { impact } => (impact, 0),
        _ => (0, 0),
    };
    (condition.kind().name().to_owned(), index, side)
}

fn slot(key: &str) -> PyResult<Slot> {
    Slot::from_key(key).map_err(invalid)
}

fn way(over: &str, ((low, high), longest, most_points): GivenWay) -> PyResult<Way> {
    Ok(Way { over: slot(over)?, between: [low, high], longest, most_points })
}

/// Follows the branch of an orbit over a field: a dict of chain, rows, special points and ends, or of `reason` and `message`.
#[pyfunction]
pub fn follow<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    periods: u32,
    symmetric: bool,
    over: &str,
    steps: GivenWay,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, way) = (arguments::spec(spec)?, way(over, steps)?);
    let progress = told(progress);
    let work = move |shared: &worker::Shared| {
        engine::follow(&spec, (periods, symmetric), &way, shared.tracker())
    };
    let (followed, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    answer(py, followed.map_err(invalid)?, cut)
}

/// A callable for progress over a number of points that is not known.
fn told<'a, 'py>(callback: Option<&'a Bound<'py, PyAny>>) -> Option<worker::Progress<'a, 'py>> {
    callback.map(|callback| worker::Progress { callback, total: 0 })
}

/// Follows the branch that begins at a special point of another, which is given by its chain, condition, value of the field and
/// unknowns: as [`follow`].
#[pyfunction]
pub fn switch<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    point: GivenPoint,
    over: &str,
    steps: GivenWay,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, way, begin) = (arguments::spec(spec)?, way(over, steps)?, begin(point)?);
    let progress = told(progress);
    let work = move |shared: &worker::Shared| engine::switch(&spec, &begin, &way, shared.tracker());
    let (followed, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    answer(py, followed.map_err(invalid)?, cut)
}

fn begin((given, at, value, unknowns): GivenPoint) -> PyResult<Begin> {
    Ok(Begin { chain: chain(given), condition: condition(&at)?, value, unknowns })
}

/// The orbit at a point of a branch: as `orbit`.
#[pyfunction]
pub fn orbit_at<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    given: GivenChain,
    over: &str,
    value: f64,
    unknowns: Vec<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, over, chain) = (arguments::spec(spec)?, slot(over)?, chain(given));
    let work = move |shared: &worker::Shared| {
        engine::orbit_at(&spec, &chain, (over, value), &unknowns, &shared.cancel)
    };
    match worker::run_any(py, None, work)?.map_err(invalid)? {
        Ok(found) => shown(py, &found),
        Err(missed) => failed(py, words(&missed)),
    }
}

/// Follows the curve of a special point over two fields, of which it has these values: a dict of values, multipliers, unknowns
/// ends and values missed, or of `reason` and `message`.
#[pyfunction]
pub fn curve<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    point: GivenPoint,
    over: (String, String),
    ranges: ([f64; 2], [[f64; 2]; 2]),
    steps: (Vec<f64>, f64, usize),
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, begin, (at, longest, most_points)) = (arguments::spec(spec)?, begin(point)?, steps);
    let (values, between) = ranges;
    let over = [slot(&over.0)?, slot(&over.1)?];
    let way = CurveWay { over, between, at, longest, most_points };
    let progress = told(progress);
    let work = move |shared: &worker::Shared| {
        engine::follow_curve(&spec, &begin, values, &way, shared.tracker())
    };
    let (curved, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    let curved = curved.map_err(invalid)?;
    if let Some(raised) = cut.filter(|_| curved.as_ref().is_none_or(|it| it.points.len() < 2)) {
        return Err(raised);
    }
    let Some(Curved { points, ends, missed }) = curved else {
        return failed(py, NoBranch::Lost.words());
    };
    let dict = PyDict::new(py);
    dict.set_item("values", points.iter().map(|it| it.values).collect::<Vec<_>>())?;
    dict.set_item(
        "multipliers",
        points.iter().map(|it| pairs(&it.multipliers)).collect::<Vec<_>>(),
    )?;
    dict.set_item("unknowns", points.into_iter().map(|it| it.unknowns).collect::<Vec<_>>())?;
    dict.set_item("ends", ends.map(End::name))?;
    dict.set_item("missed", missed)?;
    Ok(dict)
}

fn pairs(multipliers: &[Complex<f64>]) -> Vec<(f64, f64)> {
    multipliers.iter().map(|it| (it.re, it.im)).collect()
}

fn failed<'py>(
    py: Python<'py>,
    (reason, message): (&'static str, String),
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("reason", reason)?;
    dict.set_item("message", message)?;
    Ok(dict)
}

fn answer<'py>(
    py: Python<'py>,
    followed: Result<Followed, NoBranch>,
    cut: Option<PyErr>,
) -> PyResult<Bound<'py, PyDict>> {
    let Followed { chain, sequence, rows, special, ends } = match (followed, cut) {
        (Ok(followed), None) => followed,
        (Ok(followed), Some(_)) if followed.rows.len() > 1 => followed,
        (_, Some(raised)) => return Err(raised),
        (Err(none), None) => return failed(py, none.words()),
    };
    let dict = PyDict::new(py);
    dict.set_item("chain", given_chain(&chain))?;
    dict.set_item("sequence", sequence)?;
    let rows = rows.iter().map(|it| row(py, it)).collect::<PyResult<Vec<_>>>()?;
    dict.set_item("rows", rows)?;
    let points = special.iter().map(|point| {
        let dict = row(py, &point.row)?;
        dict.set_item("condition", given_condition(point.condition))?;
        Ok(dict)
    });
    dict.set_item("points", points.collect::<PyResult<Vec<_>>>()?)?;
    dict.set_item("ends", ends.map(End::name))?;
    Ok(dict)
}

fn row<'py>(py: Python<'py>, row: &Row) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("value", row.value)?;
    dict.set_item("arclength", row.arclength)?;
    dict.set_item("amplitude", row.amplitude)?;
    dict.set_item("multipliers", pairs(&row.multipliers))?;
    dict.set_item("stable", row.stable)?;
    dict.set_item("grazing_margin", row.grazing_margin)?;
    dict.set_item("approach_speed_min", row.approach_speed_min)?;
    dict.set_item("unknowns", &row.unknowns)?;
    Ok(dict)
}
