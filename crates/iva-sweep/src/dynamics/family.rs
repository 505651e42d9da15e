//! The system of a scene under one harmonic drive, at any value of any of its fields.

use std::f64::consts::TAU;
use std::sync::Arc;

use iva_core::absorber::Absorber;
use iva_core::absorber::modal::FewModes;
use iva_core::error::{Invalid, number};
use iva_core::force::{Force, Harmonic};
use iva_core::host::DrivenHost;
use iva_core::orbit::periodic::Orbit;
use iva_core::orbit::{Coordinates, Cycle, Trajectory};
use iva_core::piva::Piva;
use iva_core::siva::Siva;

use super::InDoubles;
use crate::choices::Kind;
use crate::design::{Design, Spec};
use crate::fields::{FieldId, Part};
use crate::forces::{ForceSpec, Nature};
use crate::scene::{Mounted, Scene};
use crate::slot::Slot;
use crate::structure::Structure;
use crate::units::{Scale, UnitSystem};

/// Most periods of the first of several harmonic forces after which all must repeat.
const MOST_COMMON: u32 = 64;
/// By how much rounding may keep the others from a whole number of their periods, over that number.
const WHOLE: f64 = 1e-12;

/// After how many periods of the first of some frequencies all of them repeat, and whether all change their signs after half of that time; `None` if that takes
/// more than 64.
pub fn common_periods(frequencies: &[f64]) -> Option<(u32, bool)> {
    let first = frequencies.first()?;
    let periods = |n: u32, frequency: &f64| frequency / first * f64::from(n);
    let repeats = |n: &u32| {
        let whole = |count: f64| (count - count.round()).abs() <= WHOLE * count && count >= 0.5;
        frequencies.iter().all(|it| whole(periods(*n, it)))
    };
    let count = (1..=MOST_COMMON).find(repeats)?;
    let odd = |frequency: &f64| periods(count, frequency).round() % 2.0 == 1.0;
    Some((count, frequencies.iter().all(odd)))
}

/// A system under one periodic drive, with its start, in natural units.
#[derive(Debug, Clone)]
pub struct Family {
    /// What it is made of.
    pub(super) spec: Spec,
    /// The system, and the trajectory from the start on: its cycle begins at the instant of the start.
    pub member: Member,
    /// The period of the drive.
    pub period: f64,
    /// The amplitude of the steady state of the structure without absorber; infinite for one without damping in resonance.
    pub amplitude: f64,
    /// True if the mirror image of a motion half a period later is a motion: the walls are alike, and the motion level.
    pub mirrors: bool,
    /// The middle of the gap of each absorber, as a value of y.
    pub middles: Vec<f64>,
    /// The structure, if it has several modes.
    pub structure: Option<Arc<Structure>>,
    /// Between which displacements the structure moves: any, but where it has a stop on the ground.
    pub within: [f64; 2],
    /// True if a pendulum has an angle to report.
    pub has_angle: bool,
    /// Factors from natural units to the user's.
    pub scale: Scale,
    /// The user's units.
    pub units: UnitSystem,
}

/// The trajectory of one kind of absorber.
#[derive(Debug, Clone)]
pub enum Member {
    /// A free mass.
    Siva(Box<Trajectory<Siva<DrivenHost>>>),
    /// A pendulum.
    Piva(Box<Trajectory<Piva<DrivenHost>>>),
    /// Members of any kind with any terms, on one mode or several.
    System(Box<Trajectory<FewModes<DrivenHost>>>),
}

/// A kind of absorber that a member can be of.
pub trait OfMember: Coordinates + Sized {
    /// The trajectory of a member; `None` if it is one of another kind.
    fn of(member: Member) -> Option<Trajectory<Self>>;

    /// An orbit as one of either kind.
    fn in_doubles(orbit: &Orbit<Self>) -> InDoubles<'_>;
}

impl OfMember for Siva<DrivenHost> {
    fn of(member: Member) -> Option<Trajectory<Self>> {
        if let Member::Siva(trajectory) = member { Some(*trajectory) } else { None }
    }

    fn in_doubles(orbit: &Orbit<Self>) -> InDoubles<'_> {
        InDoubles::Siva(orbit)
    }
}

impl OfMember for Piva<DrivenHost> {
    fn of(member: Member) -> Option<Trajectory<Self>> {
        if let Member::Piva(trajectory) = member { Some(*trajectory) } else { None }
    }

    fn in_doubles(orbit: &Orbit<Self>) -> InDoubles<'_> {
        InDoubles::Piva(orbit)
    }
}

impl OfMember for FewModes<DrivenHost> {
    fn of(member: Member) -> Option<Trajectory<Self>> {
        if let Member::System(trajectory) = member { Some(*trajectory) } else { None }
    }

    fn in_doubles(orbit: &Orbit<Self>) -> InDoubles<'_> {
        InDoubles::System(orbit)
    }
}

/// Code for the trajectory of a member of any kind.
macro_rules! with_member {
    ($member:expr, |$trajectory:ident| $body:expr) => {
        match $member {
            $crate::dynamics::family::Member::Siva($trajectory) => $body,
            $crate::dynamics::family::Member::Piva($trajectory) => $body,
            $crate::dynamics::family::Member::System($trajectory) => $body,
        }
    };
}
pub(crate) use with_member;

impl Family {
    /// True if its orbits are chains of impacts of one absorber on one mode: without friction, which may hold it.
    pub fn has_chain(&self) -> bool {
        let rubs = |field| self.spec.get(field).is_some_and(|value| value != 0.0);
        !self.is_several() && ![FieldId::Friction, FieldId::StaticFriction].into_iter().any(rubs)
    }

    /// The system of a spec with a cycle of so many periods of its drive; `at` is the value of a field that takes the place
    /// of what the spec has.
    ///
    /// # Errors
    /// [`Invalid`] if something is missing or out of range, the value is, there are too many absorbers or modes, or the scene is no
    /// absorber under harmonic forces or motions of the base with a common period.
    pub fn new(spec: &Spec, at: Option<(Slot, f64)>, periods: u32) -> Result<Self, Invalid> {
        let mut spec = spec.clone();
        if let Some((slot, value)) = at {
            spec.replace(slot, value)?;
        }
        check_kind(&spec)?;
        spec.replace(FieldId::Cycles, f64::from(periods))?;
        let Design { scene, begin, scale, units, .. } = spec.design()?;
        let harmonics = scene.force().map_or(&[][..], Force::harmonics);
        let frequencies: Vec<f64> = harmonics.iter().map(|it| it.frequency).collect();
        let first = frequencies.first().ok_or_else(|| not_periodic(&spec))?;
        let (count, odd) = common_periods(&frequencies).ok_or_else(|| without_period(&spec))?;
        let period = TAU / first * f64::from(count);
        let alone = |&Harmonic { amplitude, frequency, .. }: &Harmonic| {
            let damped = 2.0 * scene.damping_ratio() * frequency;
            amplitude.abs() / damped.hypot(1.0 - frequency * frequency)
        };
        let size = spec.structure().map_or(Ok(1.0), |it| it.natural_share())?;
        let amplitude = harmonics.iter().map(alone).sum::<f64>() * size;
        let cycle = Cycle { begin, length: f64::from(periods) * period };
        let owners: Vec<usize> = spec.owners().collect();
        // Where it depends on the speed as well, the walls are alike if they are given alike.
        let like = owners.iter().all(|owner| {
            let other = spec.get_of(*owner, FieldId::RestitutionMinus);
            other.is_none_or(|minus| Some(minus) == spec.get_of(*owner, FieldId::Restitution))
        });
        let level = |k: usize| {
            let along = scene.gravity_along(k).is_none_or(|along| along == 0.0);
            let across = scene.walls_of(k).iter().all(|wall| wall.is_finite());
            along && across && scene.inclination_of(k) == 0.0
        };
        let mirrors = like && odd && (0..owners.len()).all(level);
        let middles = (0..owners.len()).map(|k| scene.gap_offset(k)).collect();
        let structure = spec.structure().cloned();
        let has_angle = scene.has_angle();
        let mut within = [f64::NEG_INFINITY, f64::INFINITY];
        let scene_count = owners.len();
        let member = match scene {
            Scene::DrivenSiva(Mounted { system, start, .. }) => {
                Member::Siva(Box::new(Trajectory::new(system, &start, cycle)?))
            }
            Scene::Piva(mounted) => {
                let Mounted { system, start, .. } = *mounted;
                Member::Piva(Box::new(Trajectory::new(system, &start, cycle)?))
            }
            Scene::FewModes(mounted) => {
                let Mounted { system, start, .. } = *mounted;
                for k in (0..owners.len()).filter(|k| system.on_ground(*k)) {
                    let [low, high] = system.walls_of(k);
                    within = [within[0].max(low), within[1].min(high)];
                }
                Member::System(Box::new(Trajectory::new(system, &start, cycle)?))
            }
            Scene::Modal(mounted) => {
                let given =
                    format!("{} on {} modes", scene_count, mounted.system.structure().count());
                let rule = "orbits are those of at most four absorbers or units and four modes; a mass with a spring or a dashpot and a stop count as a mode too";
                return Err(Invalid::new("absorber", given, rule));
            }
            _ => return Err(not_periodic(&spec)),
        };
        Ok(Self {
            spec,
            member,
            period,
            amplitude,
            mirrors,
            middles,
            structure,
            within,
            has_angle,
            scale,
            units,
        })
    }
}

/// Checks that there is an absorber, and a drive of harmonic forces.
fn check_kind(spec: &Spec) -> Result<(), Invalid> {
    let shocks = [FieldId::StartImpulse, FieldId::StartImpulseVelocity];
    if let Some((field, value)) = shocks.iter().find_map(|it| Some((it, spec.get(*it)?))) {
        let rule = "an orbit has no shock at its start; leave it out";
        return Err(Invalid::new(field.path(), number(value), rule));
    }
    let kind = spec.choices().kind;
    if kind == Kind::None {
        let rule = "an orbit is one of an absorber; give a free mass, a pendulum or a stop";
        return Err(Invalid::new("absorber.kind", kind.name(), rule));
    }
    let periodic = |force: &ForceSpec| force.record.is_none() && force.nature() == Nature::Harmonic;
    let all = spec.forces();
    if !all.is_empty() && all.iter().all(periodic) { Ok(()) } else { Err(not_periodic(spec)) }
}

fn not_periodic(spec: &Spec) -> Invalid {
    let rule = "an orbit is one under harmonic forces or motions of the base";
    if spec.forces().is_empty() {
        return Invalid::missing("force", rule);
    }
    Invalid::new("force", "one that is not harmonic", rule)
}

fn without_period(spec: &Spec) -> Invalid {
    let given = format!("a list of {}", spec.forces().len());
    let rule = format!(
        "all repeat after at most {MOST_COMMON} periods of the first: give frequencies that are fractions of each other"
    );
    Invalid::new("force", given, rule)
}

/// The scene with each absorber in the middle of its gap, or the structure in the middle of that of a stop, where it fits any clearance.
pub(super) fn middled(spec: &Spec) -> Result<Spec, Invalid> {
    let mut spec = spec.clone();
    spec.clear(FieldId::GapDisplacement.into());
    for k in 0..spec.count() {
        let middle = spec.get_of(k, FieldId::GapOffset);
        let middle = middle.or(spec.get_of(k, FieldId::GapOffsetMm).map(|offset| offset / 1000.0));
        let slot = match spec.choices_of(k).kind {
            Kind::Stop => FieldId::Displacement.into(),
            _ => spec.slot(FieldId::GapDisplacement, k),
        };
        spec.replace(slot, middle.unwrap_or(0.0))?;
    }
    Ok(spec)
}

/// Checks that a field is one of the scene: steady states do not depend on the start, nor on the length of a run.
///
/// # Errors
/// [`Invalid`] if it is one of the start or of the run.
pub(super) fn changeable(over: Slot) -> Result<(), Invalid> {
    if matches!(over.info().part, Part::Start | Part::Run) {
        let rule = "give a number of the absorber, the primary system or the force";
        return Err(Invalid::new("over", over.path(), rule));
    }
    Ok(())
}
