//! An orbit to twice the precision, see [`iva_core::orbit::polish`].

use std::sync::atomic::AtomicBool;

use iva_core::absorber::Absorber as _;
use iva_core::force::Harmonic;
use iva_core::host::DrivenHost;
use iva_core::orbit::polish::{Seen, Stretch, polish, shown};
use iva_core::orbit::{Coordinates, Numbered};
use iva_core::piva::Piva;
use iva_core::real::Real;
use iva_core::real::twofold::Twofold;
use iva_core::siva::Siva;

use super::{Missed, Orbit, SeenAt};
use crate::engine::design::Design;
use crate::engine::given::Given;
use crate::engine::scene::{Mounted, Scene};
use crate::error::Invalid;
use crate::fields::FieldId;
use crate::spec::Spec;

/// An absorber whose scene can be made in numbers of twice the precision.
pub(super) trait Verified: Coordinates {
    /// It in these numbers.
    type Twofold: Numbered<Real = Twofold>;

    /// The system of a scene; `None` if it is one of another kind.
    fn of(scene: Scene<Twofold>) -> Option<Self::Twofold>;
}

impl Verified for Siva<DrivenHost> {
    type Twofold = Siva<DrivenHost<Twofold>>;

    fn of(scene: Scene<Twofold>) -> Option<Self::Twofold> {
        let Scene::DrivenSiva(Mounted { system, .. }) = scene else { return None };
        Some(system)
    }
}

impl Verified for Piva<DrivenHost> {
    type Twofold = Piva<DrivenHost<Twofold>>;

    fn of(scene: Scene<Twofold>) -> Option<Self::Twofold> {
        let Scene::DrivenPiva(mounted) = scene else { return None };
        Some(mounted.system)
    }
}

/// An orbit to twice the precision.
pub(super) struct Exact {
    /// Its events and states, rounded.
    pub seen: Seen,
    /// The largest difference between a coordinate and its image before they are rounded, over the size of the state.
    pub residual: f64,
    /// The largest error of a coordinate that doubles gave, over the size of the state.
    pub error: f64,
}

/// The scene of a spec with the instant of its start and the period of its drive. A pendulum runs at full accuracy.
fn scene(spec: &Spec) -> Result<Option<(Scene<Twofold>, Twofold, Twofold)>, Invalid> {
    let mut spec = spec.clone();
    if spec.get(FieldId::Tolerance).is_some() {
        spec.set(FieldId::Tolerance, 0.0)?;
    }
    spec.replace(FieldId::Cycles, 1.0)?;
    let Design { scene, begin, .. } = Given::<Twofold>::new(&spec).design()?;
    let frequency = scene.force().and_then(|force| {
        let &Harmonic { frequency, .. } = force.harmonics().first()?;
        Some(frequency)
    });
    let turn = Twofold::TURN.value + Twofold::TURN.rest;
    Ok(frequency.map(|frequency| (scene, begin, turn / frequency)))
}

/// An orbit that was found in doubles, to twice the precision.
///
/// # Errors
/// [`Missed`] if it is not one in these numbers.
pub(super) fn exact<S: Verified>(
    spec: &Spec,
    (orbit, periods): (&Orbit<S>, u32),
    seen_at: &SeenAt,
    cancel: Option<&AtomicBool>,
) -> Result<Exact, Missed> {
    let lost = Missed::Stalled(f64::INFINITY);
    let (scene, begin, period) = scene(spec)?.ok_or(lost.clone())?;
    let system = S::of(scene).ok_or(lost)?;
    let length = period * f64::from(periods);
    let section = Twofold::from(orbit.trajectory.cycle.begin);
    let part = length * if orbit.symmetric { 0.5 } else { 1.0 };
    let stretch = Stretch { begin: section, length: part, mirrored: orbit.symmetric };
    let at = orbit.trajectory.system.coordinates(&orbit.trajectory.state);
    let exact = polish(&system, stretch, (&at, &orbit.derivative), cancel)?;
    let [first, later] =
        [0.0, seen_at.shift].map(|shift| begin + length * (seen_at.cycles + shift));
    let seen = shown(&system, (section, exact.at), length, &[first, later], cancel)?;
    let off = (0..4).map(|k| f64::from(exact.at[k] - at[k]).abs()).fold(0.0, f64::max);
    let error = off / at.amax().max(system.clearance().into());
    Ok(Exact { seen, residual: exact.residual, error })
}
