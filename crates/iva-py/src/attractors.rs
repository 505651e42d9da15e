//! What a driven scene settles on, for Python, in the user's units: diagrams, exponents, attractors and basins.

use iva_sweep::dynamics::attractors::Inventory;
use iva_sweep::dynamics::basins::{Asked, Basins, CUT, LeftOut, Plane};
use iva_sweep::dynamics::diagram::{Direction, Strobes, Window};
use iva_sweep::dynamics::lyapunov::Exponents;
use iva_sweep::dynamics::starts::{Bounds, Drawn, NAMES, Numbers, Within, name_of, place_of};
use iva_sweep::dynamics::{self as engine, Family, Outcome};
use iva_sweep::slot::Slot;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments;
use crate::dynamics::shown;
use crate::errors::{failed, invalid};
use crate::worker;

/// Starts as Python holds them: their number, the seed, and the box or whether they are close to the start of the scene.
type GivenStarts = (u64, u64, Option<Bounds>, bool);

fn drawn((count, seed, bounds, close): GivenStarts) -> Drawn {
    let within = match (bounds, close) {
        (_, true) => Within::Close,
        (Some(bounds), false) => Within::Given(bounds),
        (None, false) => Within::Usual,
    };
    Drawn { count, seed, within }
}

/// A bifurcation diagram: a dict of columns with one entry a strobe, and of lists with one entry a value and direction.
#[pyfunction]
pub fn diagram<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    over: &str,
    values: Vec<f64>,
    directions: Vec<String>,
    window: (u64, u64),
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let spec = arguments::spec(spec)?;
    let over = Slot::from_key(over).map_err(invalid)?;
    let directions: Vec<Direction> = directions
        .iter()
        .map(|it| if it == "down" { Direction::Down } else { Direction::Up })
        .collect();
    let window = Window { discard: window.0, keep: window.1 };
    let total = (values.len() * directions.len()) as u64;
    let progress = progress.map(|callback| worker::Progress { callback, total });
    let work = move |shared: &worker::Shared| {
        engine::diagram::diagram(&spec, (over, &values), &directions, window, shared.tracker())
    };
    let (parts, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    let parts = parts.map_err(failed)?;
    if let Some(raised) = cut.filter(|_| parts.iter().all(|it| it.states.is_empty())) {
        return Err(raised);
    }
    let dict = PyDict::new(py);
    let per_value = |of: fn(&Strobes) -> usize| parts.iter().map(of).collect::<Vec<_>>();
    dict.set_item("values", parts.iter().map(|it| it.value).collect::<Vec<_>>())?;
    let name = |it: &Strobes| if it.direction == Direction::Up { "up" } else { "down" };
    dict.set_item("directions", parts.iter().map(name).collect::<Vec<_>>())?;
    dict.set_item("outcomes", parts.iter().map(|it| it.outcome.name()).collect::<Vec<_>>())?;
    dict.set_item("counts", per_value(|it| it.states.len()))?;
    let count = parts.iter().flat_map(|it| &it.states).map(Vec::len).max().unwrap_or(NAMES.len());
    dict.set_item("names", (0..count).map(|axis| name_of(axis, count)).collect::<Vec<_>>())?;
    let states = parts.iter().flat_map(|it| it.states.iter().cloned());
    dict.set_item("states", states.collect::<Vec<_>>())?;
    let impacts = parts.iter().flat_map(|it| it.impacts.iter().copied());
    dict.set_item("impacts", impacts.collect::<Vec<_>>())?;
    Ok(dict)
}

/// Lyapunov exponents: a dict of what is told of them.
#[pyfunction]
pub fn lyapunov<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    starts: GivenStarts,
    window: (u64, u64),
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, starts) = (arguments::spec(spec)?, drawn(starts));
    let progress = progress.map(|callback| worker::Progress { callback, total: starts.count });
    let window = Window { discard: window.0, keep: window.1 };
    let Family { period, scale, .. } = Family::new(&spec, None, 1).map_err(invalid)?;
    let work = move |shared: &worker::Shared| {
        engine::lyapunov::lyapunov(&spec, &starts, window, shared.tracker())
    };
    let (found, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    let Exponents { spectrum, dimension, bounds } = found.map_err(failed)?;
    if let Some(raised) = cut.filter(|_| spectrum.cycles == 0) {
        return Err(raised);
    }
    let dict = PyDict::new(py);
    dict.set_item("exponents", spectrum.exponents)?;
    dict.set_item("standard_errors", spectrum.standard_errors)?;
    dict.set_item("sum_error", spectrum.sum_error)?;
    dict.set_item("dimension", dimension)?;
    dict.set_item("impacts_per_cycle", spectrum.impacts)?;
    dict.set_item("impacts_per_cycle_error", spectrum.impacts_error)?;
    dict.set_item("rides", spectrum.rides)?;
    dict.set_item("cycles", spectrum.cycles)?;
    dict.set_item("time", scale.time(period) * window.keep as f64)?;
    dict.set_item("outcome", spectrum.outcome.name())?;
    dict.set_item("box", bounds)?;
    Ok(dict)
}

/// What starts end in: a dict of orbits and counts.
#[pyfunction]
pub fn attractors<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    starts: GivenStarts,
    most_periods: u32,
    most_cycles: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, starts) = (arguments::spec(spec)?, drawn(starts));
    let count = starts.count;
    let progress = progress.map(|callback| worker::Progress { callback, total: count });
    let work = move |shared: &worker::Shared| {
        engine::attractors::attractors(
            &spec,
            &starts,
            (most_periods, most_cycles),
            shared.tracker(),
        )
    };
    let (found, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    let found = found.map_err(failed)?;
    let Inventory { attractors, no_impacts, aperiodic, aperiodic_start, unfinished, .. } = &found;
    let cancelled = unfinished.iter().filter(|it| **it == Outcome::Cancelled).count();
    if let Some(raised) = cut.filter(|_| cancelled as u64 == count) {
        return Err(raised);
    }
    let dict = PyDict::new(py);
    let orbits = attractors.iter().map(|it| shown(py, &it.found)).collect::<PyResult<Vec<_>>>()?;
    dict.set_item("orbits", orbits)?;
    dict.set_item("periods", attractors.iter().map(|it| it.periods).collect::<Vec<_>>())?;
    dict.set_item("pairs", attractors.iter().map(|it| it.pair).collect::<Vec<_>>())?;
    dict.set_item("counts", attractors.iter().map(|it| it.count).collect::<Vec<_>>())?;
    dict.set_item("no_impacts", no_impacts)?;
    dict.set_item("aperiodic", aperiodic)?;
    dict.set_item("aperiodic_start", aperiodic_start)?;
    let outcomes = unfinished.iter().map(|it| it.name());
    dict.set_item("unfinished", outcomes.collect::<Vec<_>>())?;
    dict.set_item("box", &found.bounds)?;
    dict.set_item("left_out", reasons(&found.left_out))?;
    Ok(dict)
}

/// Why orbits are left out.
fn reasons(left_out: &[LeftOut]) -> Vec<String> {
    left_out.iter().map(LeftOut::words).collect()
}

/// Basins over two numbers of the start: a dict of orbits, labels row by row, and entropies.
#[pyfunction]
pub fn basins<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    over: (String, String),
    values: (Vec<f64>, Vec<f64>),
    orbits: Option<Vec<Numbers>>,
    limits: (u32, u64, usize),
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let spec = arguments::spec(spec)?;
    let plane = Plane { axes: [axis(&over.0)?, axis(&over.1)?], values: values.into() };
    let (most_periods, most_cycles, side) = limits;
    let asked = Asked { orbits, most_periods, most_cycles, side };
    let total = plane.values.iter().map(|values| values.len() as u64).product();
    let progress = progress.map(|callback| worker::Progress { callback, total });
    let work = move |shared: &worker::Shared| {
        engine::basins::basins(&spec, &plane, &asked, shared.tracker())
    };
    let (found, cut) = worker::run_partly(py, progress.as_ref(), work)?;
    let Basins { attractors, periods, labels, likely, cycles, entropy, left_out } =
        found.map_err(failed)?;
    if let Some(raised) = cut.filter(|_| labels.iter().all(|label| *label == CUT)) {
        return Err(raised);
    }
    // Of a part of the cells it would say nothing.
    let entropy = entropy.filter(|_| !labels.contains(&CUT));
    let dict = PyDict::new(py);
    let orbits = attractors.iter().map(|it| shown(py, it)).collect::<PyResult<Vec<_>>>()?;
    dict.set_item("orbits", orbits)?;
    dict.set_item("periods", periods)?;
    dict.set_item("labels", labels)?;
    dict.set_item("likely", likely)?;
    dict.set_item("cycles", cycles)?;
    dict.set_item("entropy", entropy.map(|it| it.basin))?;
    dict.set_item("boundary_entropy", entropy.and_then(|it| it.boundary))?;
    dict.set_item("boundary_boxes", entropy.map_or(0, |it| it.boundary_boxes))?;
    dict.set_item("boxes", entropy.map_or(0, |it| it.boxes))?;
    dict.set_item("left_out", reasons(&left_out))?;
    Ok(dict)
}

/// The place of a number of the start.
fn axis(name: &str) -> PyResult<usize> {
    place_of(name).ok_or_else(|| {
        PyValueError::new_err(format!("over = {name}: give two of {}", NAMES.join(", ")))
    })
}
