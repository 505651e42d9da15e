//! An orbit to twice the precision, see [`iva_core::orbit::polish`].

use std::sync::atomic::AtomicBool;

use iva_core::error::Invalid;
use iva_core::force::Force;
use iva_core::orbit::polish::{Stretch, polish, shown};
use iva_core::orbit::{Coordinates, Numbered};
use iva_core::real::Real;
use iva_core::real::twofold::Twofold;
use iva_sweep::design::{Design, Spec};
use iva_sweep::dynamics::{Exact, InDoubles, Missed, Orbit, common_periods};
use iva_sweep::engine::given::Given;
use iva_sweep::fields::FieldId;
use iva_sweep::scene::Scene;

/// An orbit of so many periods that was found in doubles, to twice the precision, with its states after two numbers of
/// cycles.
///
/// # Errors
/// [`Missed`] if it is not one in these numbers.
pub fn exact_orbit(
    spec: &Spec,
    (orbit, periods): (InDoubles<'_>, u32),
    cycles: [f64; 2],
    cancel: Option<&AtomicBool>,
) -> Result<Exact, Missed> {
    let lost = Missed::Stalled(f64::INFINITY);
    let (scene, begin, period) = scene(spec)?.ok_or(lost.clone())?;
    let cycle = (begin, period * f64::from(periods));
    match (orbit, scene) {
        (InDoubles::Siva(orbit), Scene::DrivenSiva(it)) => {
            exact(orbit, &it.system, cycle, cycles, cancel)
        }
        (InDoubles::Piva(orbit), Scene::Piva(it)) => {
            exact(orbit, &it.system, cycle, cycles, cancel)
        }
        (InDoubles::System(orbit), Scene::Modal(it)) => {
            exact(orbit, &it.system, cycle, cycles, cancel)
        }
        _ => Err(lost),
    }
}

/// The scene of a spec with the instant of its start and the period of its drive. A pendulum runs at full accuracy.
fn scene(spec: &Spec) -> Result<Option<(Scene<Twofold>, Twofold, Twofold)>, Invalid> {
    let mut spec = spec.clone();
    if spec.get(FieldId::Tolerance).is_some() {
        spec.set(FieldId::Tolerance, 0.0)?;
    }
    spec.replace(FieldId::Cycles, 1.0)?;
    let Design { scene, begin, .. } = Given::<Twofold>::new(&spec).design()?;
    let harmonics = scene.force().map_or(&[][..], Force::harmonics);
    let frequencies: Vec<f64> = harmonics.iter().map(|it| it.frequency.into()).collect();
    let turn = Twofold::TURN.value + Twofold::TURN.rest;
    let period = common_periods(&frequencies)
        .map(|(count, _)| turn * f64::from(count) / harmonics[0].frequency);
    Ok(period.map(|period| (scene, begin, period)))
}

/// An orbit of a system, whose cycles have this length and are counted from an instant on.
fn exact<S: Coordinates, T: Numbered<Real = Twofold>>(
    orbit: &Orbit<S>,
    system: &T,
    (begin, length): (Twofold, Twofold),
    cycles: [f64; 2],
    cancel: Option<&AtomicBool>,
) -> Result<Exact, Missed> {
    let section = Twofold::from(orbit.trajectory.cycle.begin);
    let part = length * if orbit.symmetric { 0.5 } else { 1.0 };
    let stretch = Stretch { begin: section, length: part, mirrored: orbit.symmetric };
    let at = orbit.trajectory.system.point(&orbit.trajectory.state);
    let exact = polish(system, stretch, (&at, &orbit.derivative), cancel)?;
    let instants = cycles.map(|cycles| begin + length * cycles);
    let seen = shown(system, (section, &exact.at), length, &instants, cancel)?;
    let off = exact.at.iter().zip(&at).map(|(exact, at)| f64::from(*exact - *at).abs());
    let off = off.fold(0.0, f64::max);
    let error = off / at.amax().max(system.clearance().into());
    Ok(Exact { seen, residual: exact.residual, error })
}
