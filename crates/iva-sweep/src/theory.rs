//! Exact steady states of a given scene, see [`iva_core::theory`].

use iva_core::error::{Invalid, number};
pub use iva_core::theory::{Complex, MasriCaughey, Orbit, SlowManifold};
use iva_core::theory::{SymmetricScene, masri_caughey as symmetric, slow_manifold as manifold};

use crate::choices::{Kind, only};
use crate::design::Spec;
use crate::engine::given::Given;
use crate::engine::pendulum::Common;
use crate::engine::{forces, free_mass, ties};
use crate::fields::FieldId;
use crate::units::Scale;

/// The result of a theory in natural units, with the scale to the user's units.
#[derive(Debug, Clone, Copy)]
pub struct Answer<T> {
    /// The result of the theory.
    pub theory: T,
    /// Factors from natural units to the user's.
    pub scale: Scale,
    /// Phase of the force as given, in rad.
    pub phase: f64,
    /// Gap displacement of the middle of the gap, from which the theory counts.
    pub middle: f64,
}

/// What is to be told of what the theory does not have.
const ALIKE: &str =
    "the theory is of one mass between two walls alike, with one restitution; leave it out";

fn common(spec: &Spec) -> Result<(Common, Scale, f64), Invalid> {
    if spec.choices().kind != Kind::Siva {
        return Err(Invalid::new("absorber.kind", spec.choices().kind.name(), only(&[Kind::Siva])));
    }
    let given = Given::new(spec);
    let (scale, units) = given.scale()?;
    if free_mass::weight(&given, &scale)?.is_some() {
        let fields = [FieldId::Friction, FieldId::Inclination, FieldId::InclinationDeg];
        let given = fields.into_iter().find_map(|field| Some((field, spec.get(field)?)));
        let (field, angle) = given.unwrap_or((FieldId::Inclination, 0.0));
        let rule = "the theory is of a level motion without friction; leave it out";
        return Err(Invalid::new(field.path(), number(angle), rule));
    }
    if let Some((path, value)) = ties::given(&given) {
        let rule = "the theory is of a mass without spring or dashpot; leave it out";
        return Err(Invalid::new(path, number(value), rule));
    }
    let common = given.common(&scale, units)?;
    if let Some((path, table)) = spec.tables().next() {
        return Err(Invalid::new(path, table.shown(), ALIKE));
    }
    let same = spec.get(FieldId::Restitution);
    let other = spec.get(FieldId::RestitutionMinus).filter(|e| Some(*e) != same);
    let asymmetric = [
        (FieldId::ReferenceSpeed, spec.get(FieldId::ReferenceSpeed)),
        (FieldId::YieldSpeed, spec.get(FieldId::YieldSpeed)),
        (FieldId::Units, spec.get(FieldId::Units).filter(|units| *units != 1.0)),
        (FieldId::RestitutionMinus, other),
    ];
    match asymmetric.into_iter().find_map(|(field, value)| Some((field, value?))) {
        None => {
            let middle = given.length(FieldId::GapOffset, FieldId::GapOffsetMm, units)?;
            Ok((common, scale, middle.unwrap_or(0.0)))
        }
        Some((field, value)) => Err(Invalid::new(field.path(), number(value), ALIKE)),
    }
}

/// The symmetric motions with two impacts a cycle under the harmonic force of a spec.
///
/// # Errors
/// [`Invalid`] if something is missing, or the theory does not apply.
pub fn masri_caughey(spec: &Spec) -> Result<Answer<MasriCaughey>, Invalid> {
    let (common, scale, middle) = common(spec)?;
    let sum = forces::force(&Given::new(spec), &scale, spec.units()?)?;
    let harmonic = sum.harmonics().first().copied().filter(|_| sum.is_single());
    let force = harmonic.ok_or_else(|| {
        Invalid::new("force", spec.forces().len(), "the theory is of one harmonic force")
    })?;
    let Common { mass_ratio, restitution, clearance, damping_ratio } = common;
    let scene = SymmetricScene { mass_ratio, restitution, clearance, damping_ratio, force };
    Ok(Answer { theory: symmetric(&scene)?, scale, phase: force.phase, middle })
}

/// The slow invariant manifold of the absorber of a spec.
///
/// # Errors
/// [`Invalid`] if something is missing or out of range.
pub fn slow_manifold(spec: &Spec) -> Result<Answer<SlowManifold>, Invalid> {
    let (common, scale, middle) = common(spec)?;
    let theory = manifold(common.mass_ratio, common.restitution, common.clearance)?;
    Ok(Answer { theory, scale, phase: 0.0, middle })
}
