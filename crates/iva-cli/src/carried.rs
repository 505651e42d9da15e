//! Start velocities of the structure that carry its absorbers along, unless they are given velocities of their own.

use iva_sweep::choices::Kind;
use iva_sweep::design::Spec;
use iva_sweep::fields::FieldId;
use iva_sweep::structure::Entry;

/// A sentence on each start velocity that absorbers share, as `print(run)` of the Python package has it.
pub(crate) fn carried_along(spec: &Spec) -> Vec<String> {
    let stands = |it: &usize| matches!(spec.choices_of(*it).kind, Kind::Stop | Kind::None);
    let count = (0..spec.count()).filter(|it| !stands(it)).count();
    let of_its_own = [FieldId::GapVelocity, FieldId::AngularVelocity];
    if count == 0 || spec.given().any(|(slot, _)| of_its_own.contains(&slot.field)) {
        return Vec::new();
    }
    let (who, which) = match count {
        1 => ("the absorber", "it starts"),
        _ => ("the absorbers", "each starts"),
    };
    let mut lines = Vec::new();
    let of_points = spec.structure().is_some_and(|structure| {
        structure.entries().iter().any(|(name, entry)| match entry {
            Entry::Numbers(rates) => {
                *name == "start_velocities" && rates.iter().any(|it| *it != 0.0)
            }
            _ => false,
        })
    });
    if of_points {
        lines.push(format!(
            "start_velocities carry {who} along: {which} with the velocity of its point"
        ));
    }
    if spec.get(FieldId::Velocity).is_some_and(|velocity| velocity != 0.0) {
        lines.push(format!(
            "start.velocity carries {who} along: {which} with that of the structure"
        ));
    }
    lines
}
