//! Theory of steady motion for Python, in the user's units: two impacts a cycle, slow manifold.

use iva_sweep::theory::{self as engine, Answer, MasriCaughey, Orbit};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments;
use crate::errors::invalid;

/// The symmetric motions with two impacts a cycle: a dict of amplitude_without_absorber,
/// largest_clearance and orbits, a list of two dicts or None.
#[pyfunction]
pub fn masri_caughey<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = engine::masri_caughey(&arguments::spec(spec)?).map_err(invalid)?;
    let found = PyDict::new(py);
    found.set_item("amplitude_without_absorber", answer.theory.amplitude_without_absorber)?;
    found.set_item("largest_clearance", answer.theory.largest_clearance)?;
    let orbits = answer
        .theory
        .branches
        .map(|branch| branch.map(|found| orbit(py, &found, &answer)).transpose());
    let [one, other] = orbits;
    found.set_item("orbits", (one?, other?))?;
    Ok(found)
}

fn orbit<'py>(
    py: Python<'py>,
    orbit: &Orbit,
    Answer { scale, phase, middle, .. }: &Answer<MasriCaughey>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for (name, velocity) in [
        ("speed", orbit.speed),
        ("velocity_before", orbit.velocity_before),
        ("velocity_after", orbit.velocity_after),
        ("approach_speed", orbit.approach_speed),
    ] {
        found.set_item(name, scale.velocity(velocity))?;
    }
    found.set_item("phase", orbit.phase)?;
    found.set_item("displacement", orbit.displacement)?;
    found.set_item("amplitude", orbit.amplitude)?;
    found.set_item("admissible", orbit.admissible)?;
    found.set_item("stable", orbit.stable)?;
    found.set_item("multipliers", orbit.multipliers.map(|it| (it.re, it.im)))?;
    let start = orbit.at_phase(*phase);
    let state = [
        start.displacement,
        scale.velocity(start.velocity),
        middle + start.gap_displacement,
        scale.velocity(start.gap_velocity),
    ];
    found.set_item("start", state)?;
    Ok(found)
}

/// The slow invariant manifold: a dict of its numbers.
#[pyfunction]
pub fn slow_manifold<'py>(
    py: Python<'py>,
    spec: &Bound<'_, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let manifold = engine::slow_manifold(&arguments::spec(spec)?).map_err(invalid)?.theory;
    let found = PyDict::new(py);
    found.set_item("rho", manifold.rho)?;
    found.set_item("activation", manifold.activation)?;
    found.set_item("activation_amplitude", manifold.activation_amplitude)?;
    found.set_item("stable_theta", <(f64, f64)>::from(manifold.stable_theta))?;
    found.set_item("stable_amplitude", <(f64, f64)>::from(manifold.stable_amplitude))?;
    found.set_item("largest_added_damping", manifold.largest_added_damping)?;
    found.set_item("best_amplitude", manifold.best_amplitude)?;
    Ok(found)
}

/// At θ on the manifold: ξ, the added damping ratio, and whether the motion is admissible.
#[pyfunction]
pub fn on_slow_manifold(spec: &Bound<'_, PyDict>, theta: f64) -> PyResult<(f64, f64, bool)> {
    let manifold = engine::slow_manifold(&arguments::spec(spec)?).map_err(invalid)?.theory;
    Ok((manifold.amplitude(theta), manifold.added_damping(theta), manifold.admissible(theta)))
}
