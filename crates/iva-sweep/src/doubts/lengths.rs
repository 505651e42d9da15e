//! Lengths in metres where millimetres were meant.

use crate::cube::Distribution;
use crate::engine::given::Given;
use crate::error::number;
use crate::fields::{FieldId, Part, Quantity};
use crate::sampling::Sampling;
use crate::slot::Slot;
use crate::spec::Spec;
use crate::units::UnitSystem;

/// Fields that say how wide the gap is.
const GAP: [FieldId; 4] = [FieldId::Clearance, FieldId::Gap, FieldId::ClearanceMm, FieldId::GapMm];
/// Fields that say how far the structure is displaced at the start.
const START: [FieldId; 2] = [FieldId::Displacement, FieldId::DisplacementMm];
/// From how many times the other a length is a slip: with a start of 4 mm, 2 m for 2 mm.
const LEAST: f64 = 500.0;
/// And up to how many times: a gap that is wider still is one without stops, on purpose.
const MOST: f64 = 1e5;
/// The least length in m that can be such a slip: fewer tenths of a millimetre are seldom given.
const SHORTEST: f64 = 0.1;
/// The largest gap in m that can be one in metres given as millimetres.
const THINNEST: f64 = 1e-4;
/// Fields that set the structure off with a speed.
const PUSH: [FieldId; 3] =
    [FieldId::Velocity, FieldId::StartImpulseVelocity, FieldId::StartImpulse];
/// A structure that is let go and passes its rest faster than this, in m/s, has no start in metres.
const FASTEST: f64 = 100.0;

/// A length of a scene as it was given, or the middle of an axis over it.
struct Length {
    slot: Slot,
    value: f64,
    is_swept: bool,
}

impl Length {
    fn is_metric(&self) -> bool {
        self.slot.info().quantity == Quantity::Length
    }

    fn metres(&self) -> f64 {
        if self.is_metric() { self.value.abs() } else { self.value.abs() / 1000.0 }
    }

    /// Field, value and unit.
    fn told(&self) -> String {
        let value = number(rounded(self.value));
        let unit = if self.is_metric() { "m" } else { "mm" };
        match self.is_swept {
            true => {
                let name = self.slot.info().name;
                format!("sweep.{name} = {value} {unit} (the middle of the axis)")
            }
            false => format!("{} = {value} {unit}", self.slot.path()),
        }
    }
}

/// A number to six digits.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// One sentence for each length of a scene in SI units that seems to be meant in another unit, or for a speed that no
/// machine has: a gap and a start that differ as metres and millimetres do, or a structure that would be too fast.
pub(super) fn doubts(spec: &Spec, sampling: &Sampling) -> Vec<String> {
    let swept = |field: FieldId| sampling.keys().any(|key| key.slot.field == field);
    let has_mass = spec.structure().is_some()
        || spec.get(FieldId::PrimaryMass).is_some()
        || swept(FieldId::PrimaryMass);
    // A start that goes on from another run, which has a reference, is as small as that run left it.
    if !has_mass || spec.get(FieldId::Reference).is_some() {
        return Vec::new();
    }
    let given = if spec.structure().is_some() { "a structure" } else { "the primary mass" };
    let start = length(&START, 0, spec, sampling).filter(|start| start.value != 0.0);
    let push = push(spec, sampling);
    if let Some((told, speed)) = push.as_ref().filter(|(_, speed)| *speed > FASTEST) {
        return vec![format!(
            "{told} sets the structure off with {speed:.0} m/s: speeds are in m/s where {given} is given"
        )];
    }
    // How far the structure swings: in m, and by what it is given.
    let far = match (&start, push) {
        (Some(start), _) => Some((start.metres(), start.told())),
        (None, Some((told, speed))) => {
            rate(spec).map(|rate| (speed / rate, format!("the swing of {told}")))
        }
        (None, None) => None,
    };
    let Some((far, by)) = far.filter(|(far, _)| *far > 0.0) else { return Vec::new() };
    for gap in (0..spec.count()).filter_map(|k| length(&GAP, k, spec, sampling)) {
        let (size, name) = (gap.metres(), gap.slot.info().name);
        let slip = |times: f64| (LEAST..=MOST).contains(&times);
        if gap.is_metric() && size >= SHORTEST && slip(size / far) {
            let doubt = format!("{} is {:.0} times {by}", gap.told(), size / far);
            return vec![in_metres(&doubt, given, name)];
        }
        if !gap.is_metric() && size > 0.0 && size <= THINNEST && slip(far / size) {
            let name = name.trim_end_matches("_mm");
            return vec![format!(
                "{} is {:.0} times as small as {by}: where metres are meant, give {name}",
                gap.told(),
                far / size
            )];
        }
        if let Some(start) = start.as_ref().filter(|start| start.is_metric())
            && far >= SHORTEST
            && slip(far / size)
        {
            let doubt = format!("{by} is {:.0} times {}", far / size, gap.told());
            return vec![in_metres(&doubt, given, start.slot.info().name)];
        }
    }
    let doubt = |start: &Length| {
        let doubt = format!("{} {}", start.told(), too_fast(start, spec)?);
        Some(in_metres(&doubt, given, start.slot.info().name))
    };
    start.as_ref().and_then(doubt).into_iter().collect()
}

/// A doubt about a length in metres, with the field that takes millimetres.
fn in_metres(doubt: &str, given: &str, name: &str) -> String {
    format!(
        "{doubt}: lengths are in metres where {given} is given; where millimetres are meant, give {name}_mm"
    )
}

/// The natural frequency, where the scene has SI units.
fn rate(spec: &Spec) -> Option<f64> {
    let (scale, units) = Given::<f64>::new(spec).scale().ok()?;
    (units == UnitSystem::Si).then_some(scale.natural_frequency)
}

/// What sets the structure off, in words, and the speed that this gives it, in m/s.
fn push(spec: &Spec, sampling: &Sampling) -> Option<(String, f64)> {
    let mass = spec.get(FieldId::PrimaryMass);
    PUSH.into_iter().find_map(|field| {
        let swept = middles(sampling).find(|(slot, _)| slot.field == field);
        let value = swept.map(|(_, value)| value).or_else(|| spec.get(field))?;
        let (speed, unit) = match field {
            FieldId::StartImpulse => (value / mass?, "N s"),
            _ => (value, "m/s"),
        };
        let path =
            if swept.is_some() { format!("sweep.{}", field.info().name) } else { field.path() };
        Some((format!("{path} = {} {unit}", number(rounded(value))), speed.abs()))
    })
}

/// How fast a structure passes its rest that is let go from a start in metres, if that is no speed of a machine.
fn too_fast(start: &Length, spec: &Spec) -> Option<String> {
    if !start.is_metric() || start.metres() < SHORTEST {
        return None;
    }
    let speed = start.metres() * rate(spec)?;
    (speed > FASTEST).then(|| format!("swings through its rest with {speed:.0} m/s"))
}

/// The length that one of some fields gives, of the absorber of this number or of the start. An axis replaces all of
/// them.
fn length(fields: &[FieldId], absorber: usize, spec: &Spec, sampling: &Sampling) -> Option<Length> {
    let first = fields.first()?;
    let slot = spec.slot(*first, absorber);
    if let Some((swept, value)) = middles(sampling).find(|(swept, _)| swept.same_quantity(slot)) {
        let known = fields.contains(&swept.field);
        return known.then_some(Length { slot: swept, value, is_swept: true });
    }
    let value = |field: &FieldId| Some((*field, spec.get_of(absorber, *field)?));
    let (field, value) = fields.iter().find_map(value)?;
    Some(Length { slot: spec.slot(field, absorber), value, is_swept: false })
}

/// What is swept, each with the median of its values by their size, or the middle of its distribution.
fn middles(sampling: &Sampling) -> impl Iterator<Item = (Slot, f64)> + '_ {
    let wanted = |slot: Slot| matches!(slot.info().part, Part::Absorber | Part::Start);
    let axes = sampling.axes().iter().filter(move |axis| wanted(axis.slot));
    let axes = axes.filter_map(|axis| {
        let mut values = axis.values.clone();
        values.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        Some((axis.slot, *values.get(values.len() / 2)?))
    });
    let variables = sampling.variables().iter().map(|variable| {
        let middle = match variable.distribution {
            Distribution::Uniform { low, high } => (low + high) / 2.0,
            Distribution::Normal { mean, .. } => mean,
            Distribution::LogNormal { median, .. } => median,
        };
        (variable.slot, middle)
    });
    axes.chain(variables)
}
