//! A scene of free masses and pendulums on a structure, with all terms that one of them alone on a structure that moves as one does not have.

use iva_core::absorber::Absorber as _;
use iva_core::absorber::Start;
use iva_core::absorber::modal::{FEW, Modal, ModalStart, ModalStructure, PRIMARY, Tie};
use iva_core::compensated::DoubleDouble;
use iva_core::flight::GapPoint;
use iva_core::force::Force;
use iva_core::host::DrivenHost;
use iva_core::piva::Parameters;
use iva_core::real::Real;
use iva_core::siva::FreeMass;

use super::free_mass;
use super::given::Given;
use super::scale::Scale;
use super::scene::{FEW_APART, Mounted, Scene};
use super::several::{self, Member};
use super::ties;
use crate::choices::{Choices, Kind};
use crate::error::{Invalid, number};
use crate::fields::{FieldId, FieldId as F, Part};
use crate::forces::RecordKind;
use crate::slot::Slot;
use crate::structure::{Structure, path};
use crate::units::UnitSystem;

/// The unit of time is that of the natural mode, the unit of mass 1 kg.
pub(super) fn scale<R: Real>(structure: &Structure) -> (Scale<R>, UnitSystem) {
    let natural_frequency = R::from(structure.natural_frequency());
    (Scale { natural_frequency, mass: R::ONE }, UnitSystem::Si)
}

/// The scene of all absorbers of a list, or of none, on a structure.
///
/// # Errors
/// [`Invalid`] for what the structure has already or does not take, and as of several absorbers.
pub(super) fn scene<R: Real>(
    given: &Given<'_, R>,
    structure: &Structure,
    start: Start<R>,
    force: Force<R>,
    scale: &Scale<R>,
) -> Result<Scene<R>, Invalid> {
    fits(given)?;
    let omega = structure.natural_frequency();
    let mut modes = structure.modes::<R>(omega)?;
    let absorbers = given.spec.count();
    let at = |absorber| structure.absorber_at(absorber, absorbers);
    let mut riding = Riding::all(given, scale, UnitSystem::Si, at)?;
    let primary = [start.displacement, start.velocity];
    let begin = structure.begin(&modes, primary, omega)?;
    for body in structure.bodies() {
        let name = format!("absorber.{body}");
        let owners = given.spec.owners().enumerate().filter(|(_, owner)| *owner == body);
        let units: Vec<usize> = owners.map(|(unit, _)| unit).collect();
        let is_mass = body < absorbers && given.of(body).choices().kind == Kind::Siva;
        let [unit] = units.as_slice() else {
            let rule = "a point is the mass of one absorber of the list, without units";
            return Err(Invalid::new(path("absorber_at"), format!("\"{name}\""), rule));
        };
        if !is_mass {
            let rule = "a point of the structure is the mass of a free mass (kind \"siva\")";
            return Err(Invalid::new(path("absorber_at"), format!("\"{name}\""), rule));
        }
        modes = modes.with_body(&name, riding.masses[*unit].0.mass_ratio())?;
        riding.bodies.resize(riding.masses.len(), None);
        riding.bodies[*unit] = Some(name);
    }
    let (modes, seen) = structure.seen_of(modes)?;
    if let Some(mode) = structure.seen_mode().filter(|_| force.impulses().next().is_some()) {
        let rule = "with impulses a run sees all of the motion of its point; leave it out";
        return Err(Invalid::new(path("seen_mode"), mode.to_string(), rule));
    }
    let pushed = structure.pushed(given.spec.forces())?;
    mounted(given, modes, riding, begin, [&seen, pushed], force)
}

/// True if the absorbers of a structure that moves as one are run as those of a structure with modes, for what they have: a spring or a dashpot,
/// friction, in a list an inclination, for a pendulum an offset of its gap, friction in its pivot, an inclination or a restitution that depends on the speed, one wall only, and a
/// stop on the ground.
pub(super) fn needed<R: Real>(given: &Given<'_, R>) -> bool {
    let of_pendulum = [
        F::GapOffset,
        F::GapOffsetMm,
        F::ReferenceSpeed,
        F::YieldSpeed,
        F::Friction,
        F::Inclination,
        F::InclinationDeg,
    ];
    let several = given.spec.count() > 1 || given.spec.units_of(0) > 1;
    let needs = |own: Given<'_, R>| {
        let Choices { kind, walls, .. } = own.choices();
        let value = |field: &F| own.spec.get_of(own.absorber, *field).unwrap_or(0.0);
        walls.only().is_some()
            || match kind {
                Kind::Piva => {
                    own.spec.restitution_table(own.absorber).is_some()
                        || of_pendulum.iter().any(|field| value(field) != 0.0)
                }
                Kind::Siva => free_mass::weighs(&own, several),
                Kind::Stop => true,
                Kind::None => false,
            }
    };
    given.spec.is_one_system()
        || ties::given(given).is_some()
        || (0..given.spec.count()).any(|absorber| needs(given.of(absorber)))
}

/// The scene of all absorbers of a list, or of none, on a structure that moves as one.
///
/// # Errors
/// [`Invalid`] as of several absorbers, and for a law of restitution.
pub(super) fn on_primary<R: Real>(
    given: &Given<'_, R>,
    start: Start<R>,
    force: Force<R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Scene<R>, Invalid> {
    let modes = ModalStructure::moving_as_one(given.damping_ratio(scale, units)?)?;
    let riding = Riding::all(given, scale, units, |_| Ok(PRIMARY))?;
    let begin = [vec![start.displacement], vec![start.velocity]];
    mounted(given, modes, riding, begin, [PRIMARY; 2], force)
}

/// Absorbers at points of a structure, with their places in their gaps, what ties them to their points, and gravity along their lines of
/// motion, and friction.
struct Riding<'a, R> {
    masses: Vec<(FreeMass<R>, &'a str)>,
    gaps: Vec<GapPoint<R>>,
    ties: Vec<Tie<R>>,
    pendulums: Vec<Option<Parameters<R>>>,
    rising: Vec<DoubleDouble<R>>,
    /// Names of the masses that are points of the structure; empty if there are none.
    bodies: Vec<Option<String>>,
    along: Vec<R>,
    friction: Vec<R>,
    static_friction: Vec<R>,
    /// In the user's unit, where it acts along a line of motion; `None` also where it is not the same for all.
    gravity: Option<R>,
}

impl<'a, R: Real> Riding<'a, R> {
    fn none() -> Self {
        Self {
            masses: vec![],
            gaps: vec![],
            ties: vec![],
            pendulums: vec![],
            rising: vec![],
            bodies: vec![],
            along: vec![],
            friction: vec![],
            static_friction: vec![],
            gravity: None,
        }
    }

    /// All units of all absorbers of a list; none of a structure alone.
    fn all(
        given: &Given<'_, R>,
        scale: &Scale<R>,
        units: UnitSystem,
        at: impl Fn(usize) -> Result<&'a str, Invalid>,
    ) -> Result<Self, Invalid> {
        let mut all = Self::none();
        if given.spec.choices().kind == Kind::None {
            return Ok(all);
        }
        let mut gravities = vec![];
        let mut hung = vec![];
        several::each(given, scale, units, |absorber, member| {
            let Member { mass, hanging, gap, rising, weight } = member;
            let share = 1.0 / given.spec.units_of(absorber) as f64;
            let of_all = mass.mass_ratio() / share;
            let Tie { spring, damping } = match hanging {
                None => ties::tie(&given.of(absorber), of_all, scale, units)?,
                Some(_) => Tie::NONE,
            };
            all.pendulums.push(hanging.map(|(parameters, _)| parameters));
            all.rising.push(rising);
            hung.extend(hanging.map(|(_, gravity)| gravity));
            all.masses.push((mass, at(absorber)?));
            all.gaps.push(gap);
            all.ties.push(Tie { spring: spring * share, damping: damping * share });
            all.along.push(weight.map_or(R::ZERO, |weight| weight.along));
            let friction = weight.and_then(|weight| weight.friction).unwrap_or(R::ZERO);
            let at_rest = weight.and_then(|weight| weight.static_friction);
            all.friction.push(friction);
            all.static_friction.push(at_rest.unwrap_or(friction));
            gravities.extend(weight.map(|weight| weight.gravity));
            Ok(())
        })?;
        let alike = gravities.iter().all(|one| *one == gravities[0]);
        all.gravity = match hung.first() {
            None => gravities.first().copied().filter(|_| alike),
            Some(first) => first.filter(|_| !hung.contains(&None)),
        };
        Ok(all)
    }
}

/// The scene of absorbers on a structure that begins with these q and q̇, is seen at one point, and pushed at another.
fn mounted<R: Real>(
    given: &Given<'_, R>,
    modes: ModalStructure<R>,
    riding: Riding<'_, R>,
    begin: [Vec<R>; 2],
    points: [&str; 2],
    force: Force<R>,
) -> Result<Scene<R>, Invalid> {
    let tied = riding.ties.iter().filter(|tie| **tie != Tie::NONE).count();
    let stops = riding.masses.iter().filter(|(mass, _)| mass.mass_ratio() == 0.0).count();
    let bodies = riding.bodies.iter().flatten().count();
    let few = riding.masses.len() <= FEW && modes.count() + tied + stops + bodies <= FEW;
    if R::FAST_PATHS && FEW_APART && few {
        let few = with_room(given, modes, riding, begin, points, force)?;
        return Ok(Scene::FewModes(Box::new(few)));
    }
    with_room(given, modes, riding, begin, points, force).map(|it| Scene::Modal(Box::new(it)))
}

/// The same system with room for N masses and M modes.
fn with_room<R: Real, const N: usize, const M: usize>(
    given: &Given<'_, R>,
    modes: ModalStructure<R>,
    riding: Riding<'_, R>,
    [displacements, velocities]: [Vec<R>; 2],
    [seen, pushed]: [&str; 2],
    force: Force<R>,
) -> Result<Mounted<Modal<DrivenHost<R>, N, M>>, Invalid> {
    let Riding { masses, gaps, ties, pendulums, rising, bodies, .. } = riding;
    let Riding { along, friction, static_friction, gravity, .. } = riding;
    let unused = GapPoint { y: R::ZERO, w: R::ZERO };
    let gaps = std::array::from_fn(|k| gaps.get(k).copied().unwrap_or(unused));
    let start = ModalStart::new(&displacements, &velocities, gaps)?;
    let mut system = Modal::with_room(modes, &masses)?.seen_at(seen)?;
    if !bodies.is_empty() {
        let names: Vec<Option<&str>> = bodies.iter().map(Option::as_deref).collect();
        let misplaced = |error| Invalid { field: path("absorber_at"), ..error };
        system = system.with_bodies(&names).map_err(misplaced)?;
    }
    let system = system.with_pendulums(&pendulums).and_then(|it| it.with_rising_pivots(&rising));
    let system = system.map_err(|error| several::of_unit(given, error))?;
    let system = system.with_ties(&ties)?.with_gravity(&along)?.with_friction(&friction)?;
    let system = system.with_static_friction(&static_friction)?;
    system.check_start(&start).map_err(|error| several::of_owner(given, error))?;
    let system = system.under(force, pushed).map_err(named)?;
    Ok(Mounted { system, start, gravity })
}

/// An error of the core with the name that the user knows.
fn named(error: Invalid) -> Invalid {
    match error.field.as_str() {
        "force.point" => Invalid { field: path("force_at"), ..error },
        "structure.participation" => Invalid {
            field: path("base"),
            allowed: "a moving base needs how each mode takes part in it (Γ), or for matrices how far each \
                      coordinate moves with it (1 where all of its motion is that of the base)"
                .to_owned(),
            ..error
        },
        _ => error,
    }
}

/// Checks that a scene has nothing that a structure with several modes does not take.
fn fits<R: Real>(given: &Given<'_, R>) -> Result<(), Invalid> {
    let of_primary = |slot: Slot| slot.info().part == Part::Primary;
    let of_mass = |slot: Slot| given.spec.choices_of(slot.number.unwrap_or(0)).kind == Kind::Siva;
    for (slot, value) in given.spec.given() {
        let rule = match slot.field {
            _ if of_primary(slot) => "the structure has it already; leave it out",
            FieldId::MassRatio => "on a structure with several modes give mass (kg)",
            FieldId::GapDampingRatio => {
                "on a structure with several modes give gap_damping (N s/m)"
            }
            FieldId::SpringRatio if of_mass(slot) => {
                "on a structure with several modes give spring (N/m)"
            }
            FieldId::ContactStiffness => "on a structure with several modes give contact_time",
            FieldId::Amplitude => {
                "on a structure with several modes give force (N) or base_acceleration"
            }
            FieldId::ImpulseVelocity | FieldId::StartImpulseVelocity => {
                "on a structure with several modes give impulse (N s)"
            }
            _ => continue,
        };
        return Err(Invalid::new(slot.path(), number(value), rule));
    }
    let mut records = given.spec.forces().iter().filter_map(|force| force.record.as_ref());
    if records.any(|record| record.kind == RecordKind::Force) {
        let rule =
            "on a structure with several modes give \"force_newtons\" or \"base_acceleration\"";
        return Err(Invalid::new("force.kind", "\"force\"", rule));
    }
    Ok(())
}
