//! What a scene has that was hardly meant: a slip of units, or contacts that last too long for impacts.

use crate::engine::given::Given;
use crate::error::number;
use crate::fields::FieldId;
use crate::sampling::Sampling;
use crate::spec::Spec;
use crate::units::UnitSystem;

pub mod contacts;
mod lengths;

/// One sentence for each doubt about a scene, swept or not.
pub fn doubts(spec: &Spec, sampling: &Sampling) -> Vec<String> {
    let mut doubts = lengths::doubts(spec, sampling);
    doubts.extend(damping(spec));
    doubts.extend(contacts::doubts(spec));
    doubts
}

/// A damping ratio of a machine from which on it may be one in percent.
const IN_PERCENT: f64 = 0.4;

/// A doubt about a damping ratio that seems to be given in percent.
fn damping(spec: &Spec) -> Option<String> {
    let ratio = spec.get(FieldId::DampingRatio).filter(|ratio| *ratio >= IN_PERCENT)?;
    let (_, units) = Given::<f64>::new(spec).scale().ok()?;
    (units != UnitSystem::Natural).then(|| {
        format!(
            "primary.damping_ratio = {ratio} is {} % of critical damping: where {ratio} % is meant, give {}",
            number(lengths::rounded(ratio * 100.0)),
            number(lengths::rounded(ratio / 100.0))
        )
    })
}
