//! Periodic orbits for Python, in the user's units.

use iva_sweep::dynamics::branches::Complex;
use iva_sweep::dynamics::words::words;
use iva_sweep::dynamics::{
    self as engine, Asked, Course, Found, Impact, State, StickEpisode, ToTwice,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments;
use crate::errors::invalid;
use crate::worker;

/// The periodic orbit near the start of a scene: a dict of what is told of it, or of `reason` and `message`.
#[pyfunction]
pub fn orbit<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
    periods: u32,
    symmetric: Option<bool>,
    settle: u64,
    verify: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let spec = arguments::spec(spec)?;
    let verify = verify.then_some(iva_verify::exact_orbit as ToTwice);
    let asked = Asked { periods, symmetric, settle, verify };
    let work = move |shared: &worker::Shared| engine::orbit(&spec, asked, &shared.cancel);
    match worker::run_any(py, None, work)?.map_err(invalid)? {
        Ok(found) => shown(py, &found),
        Err(missed) => {
            let (reason, message) = words(&missed);
            let dict = PyDict::new(py);
            dict.set_item("reason", reason)?;
            dict.set_item("message", message)?;
            Ok(dict)
        }
    }
}

/// All that is told of an orbit.
pub(crate) fn shown<'py>(py: Python<'py>, found: &Found) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("course", course(py, &found.course)?)?;
    let mirrored = found.mirrored.as_ref().map(|it| course(py, it));
    dict.set_item("mirrored", mirrored.transpose()?)?;
    dict.set_item("period", found.length)?;
    dict.set_item("walls_of_start", &found.walls_of_start)?;
    dict.set_item("least_periods", found.least_periods)?;
    dict.set_item("symmetric", found.symmetric)?;
    let spectrum = &found.spectrum;
    let pairs =
        |all: &Vec<Complex<f64>>| -> Vec<_> { all.iter().map(|it| (it.re, it.im)).collect() };
    dict.set_item("multipliers", pairs(&spectrum.multipliers))?;
    dict.set_item("multiplier_errors", &spectrum.errors)?;
    let (half, errors) = spectrum.half.as_ref().map(|(half, errors)| (pairs(half), errors)).unzip();
    dict.set_item("half_multipliers", half)?;
    dict.set_item("half_multiplier_errors", errors)?;
    dict.set_item("rank", spectrum.rank)?;
    dict.set_item("determinant_error", spectrum.determinant_error)?;
    dict.set_item("stable", found.stable)?;
    dict.set_item("residual", found.residual)?;
    dict.set_item("state_error", found.error)?;
    dict.set_item("amplitude", found.amplitude)?;
    dict.set_item("grazing_margin", found.grazing_margin)?;
    let [slowest, fastest] = found.approach_speeds;
    dict.set_item("approach_speed_min", slowest)?;
    dict.set_item("approach_speed_max", fastest)?;
    Ok(dict)
}

/// One cycle: state, impacts, episodes and walls.
fn course<'py>(py: Python<'py>, course: &Course) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let states = course.states.iter().map(|it| state(py, it));
    dict.set_item("states", states.collect::<PyResult<Vec<_>>>()?)?;
    dict.set_item("modes", course.modes.as_ref())?;
    let impacts = course.impacts.iter().map(|it| impact(py, it));
    dict.set_item("impacts", impacts.collect::<PyResult<Vec<_>>>()?)?;
    let episodes = course.episodes.iter().map(|it| episode(py, it));
    dict.set_item("episodes", episodes.collect::<PyResult<Vec<_>>>()?)?;
    dict.set_item("walls", &course.walls)?;
    Ok(dict)
}

fn state<'py>(py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("time", state.time)?;
    dict.set_item("displacement", state.displacement)?;
    dict.set_item("velocity", state.velocity)?;
    dict.set_item("gap_displacement", state.gap_displacement)?;
    dict.set_item("gap_velocity", state.gap_velocity)?;
    dict.set_item("angle", state.angle.map(|angle| angle.value))?;
    dict.set_item("angular_velocity", state.angle.map(|angle| angle.rate))?;
    Ok(dict)
}

fn impact<'py>(py: Python<'py>, impact: &Impact) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("absorber", impact.absorber)?;
    dict.set_item("time", impact.time)?;
    dict.set_item("wall", impact.wall.number())?;
    dict.set_item("displacement", impact.displacement)?;
    dict.set_item("velocity_before", impact.velocity_before)?;
    dict.set_item("velocity_after", impact.velocity_after)?;
    dict.set_item("absorber_velocity_before", impact.absorber_velocity_before())?;
    dict.set_item("absorber_velocity_after", impact.absorber_velocity_after())?;
    dict.set_item("approach_velocity", impact.gap_velocity_before)?;
    dict.set_item("energy_loss", impact.energy_loss)?;
    Ok(dict)
}

fn episode<'py>(py: Python<'py>, episode: &StickEpisode) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("absorber", episode.absorber)?;
    dict.set_item("wall", episode.wall.number())?;
    dict.set_item("start_time", episode.start_time)?;
    dict.set_item("stick_time", episode.stick_time)?;
    dict.set_item("release_time", episode.release_time)?;
    dict.set_item("impacts", episode.impacts)?;
    dict.set_item("energy_loss", episode.energy_loss)?;
    Ok(dict)
}
