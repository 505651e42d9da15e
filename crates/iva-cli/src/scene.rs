//! A summary of a study in a few lines, in which mistaken units show before anything is run.

use std::fmt::Write;

use iva_sweep::choices::Kind;
use iva_sweep::design::Design;
use iva_sweep::fields::{FieldId, Quantity};
use iva_sweep::scene::{Absorber, Acts, Force, Harmonic, Parameters};
use iva_sweep::structure::Structure;
use iva_sweep::study::Study;
use iva_sweep::units::{STANDARD_GRAVITY, UnitSystem};

use crate::carried::carried_along;
use crate::cell::short;
use crate::layout::wrap;
use crate::report::counted;
use crate::shown::Shown;

/// Approximate number of points that the printed ranges are taken from.
const LOOKED_AT: u64 = 512;

/// Structure, absorber, forces and start of a valid study, as ranges where they are swept.
pub fn describe(study: &Study, points: u64, units: UnitSystem) -> String {
    let last = points.saturating_sub(1);
    let step = points.div_ceil(LOOKED_AT).max(1);
    let looked_at = (0..points).step_by(usize::try_from(step).unwrap_or(1)).chain([last]);
    let (designs, owners): (Vec<Design>, Vec<Vec<usize>>) = looked_at
        .filter_map(|point| {
            let owners = study.spec(point).ok()?.owners().collect();
            Some((study.design(point).ok()?, owners))
        })
        .unzip();
    let damping = range(&designs, |design| design.scene.damping_ratio());
    let mut out = String::new();
    let several = study.spec.structure();
    let structure = match units {
        _ if let Some(structure) = several => modes(structure),
        UnitSystem::Natural => format!("Structure: damping ratio {damping}"),
        _ => {
            let hertz =
                range(&designs, |design| design.scale.natural_frequency / std::f64::consts::TAU);
            format!("Structure: {hertz} Hz, damping ratio {damping}")
        }
    };
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", wrap(&structure));
    let count = study.spec.count();
    for number in 0..count {
        let kind = study.spec.choices_of(number).kind;
        let at = several.and_then(|structure| structure.absorber_at(number, count).ok());
        let units_of = Units { designs: &designs, owners: &owners, absorber: number };
        let told = absorber(&units_of, count, kind, (law(study, number), at));
        let _ = writeln!(out, "{}", wrap(&told));
        if kind == Kind::Piva {
            let _ = writeln!(out, "{}", wrap(&pendulum(&units_of, units)));
        }
    }
    for line in forces(&designs, units, Shown::of(study, units)) {
        let _ = writeln!(out, "{}", wrap(&line));
    }
    let _ = writeln!(out, "{}", wrap(&start(&designs, Shown::of(study, units))));
    let carried = study.spec(last).map(|spec| carried_along(&spec));
    for line in gravity(&designs, units).into_iter().chain(carried.unwrap_or_default()) {
        let _ = writeln!(out, "{}", wrap(&line));
    }
    if designs.iter().all(|design| design.scene.at_rest()) {
        let _ = writeln!(out, "{}", wrap(NOTHING_MOVES));
    }
    out
}

/// The line on a structure with several modes.
fn modes(structure: &Structure) -> String {
    let Ok(modes) = structure.in_si() else { return "Structure: several modes".to_owned() };
    let of = |read: &dyn Fn(usize) -> Option<f64>| {
        let values = (0..modes.count()).filter_map(read);
        let ends =
            values.fold([f64::INFINITY, 0.0_f64], |[low, high], it| [low.min(it), high.max(it)]);
        let [low, high] = ends.map(|it| short(it, 4));
        if low == high { low } else { format!("{low} … {high}") }
    };
    let hertz = of(&|mode| modes.frequency(mode).map(|it| it / std::f64::consts::TAU));
    let damping = of(&|mode| modes.damping_ratio(mode));
    let count = counted(modes.count() as u64, "mode");
    format!(
        "Structure: {count}, {hertz} Hz, damping ratio {damping}; seen at {}",
        structure.seen_in_words()
    )
}

/// The law of restitution of an absorber in words; `None` where it is a number.
fn law(study: &Study, number: usize) -> Option<&'static str> {
    let slot = |field| study.spec.slot(field, number);
    let given = |field| study.spec.get_of(number, field).is_some();
    let swept = |field: FieldId| {
        study.sampling.keys().any(|it| it.slot.field == field && it.slot.same_quantity(slot(field)))
    };
    // An axis over one of these takes the place of the others, and of a table.
    let [number_swept, yield_swept] = [FieldId::Restitution, FieldId::YieldSpeed].map(swept);
    if !(number_swept || yield_swept) && study.spec.restitution_table(number).is_some() {
        return Some("a table of the approach speed");
    }
    if yield_swept || (given(FieldId::YieldSpeed) && !number_swept) {
        return Some("that of plastic spheres");
    }
    let power = given(FieldId::ReferenceSpeed) || swept(FieldId::ReferenceSpeed);
    power.then_some("a power law of the approach speed")
}

/// The units of one absorber of a list in some designs, each with the absorbers that its units belong to.
struct Units<'a> {
    designs: &'a [Design],
    owners: &'a [Vec<usize>],
    absorber: usize,
}

impl Units<'_> {
    /// Each design with the places of the units.
    fn places(&self) -> impl Iterator<Item = (&Design, std::vec::IntoIter<usize>)> {
        let own = |owners: &Vec<usize>| {
            let places = owners.iter().enumerate().filter(|(_, owner)| **owner == self.absorber);
            places.map(|(place, _)| place).collect::<Vec<_>>().into_iter()
        };
        self.designs.iter().zip(self.owners.iter().map(own))
    }

    /// The values of all units.
    fn values(&self, value: fn(Absorber) -> f64) -> impl Iterator<Item = f64> {
        self.places().flat_map(move |(design, places)| {
            places.filter_map(move |place| design.scene.absorber_of(place).map(value))
        })
    }
}

/// The line on an absorber, of so many in a list: kind, mass ratio and restitution, of one of several the clearance too.
fn absorber(
    units: &Units<'_>,
    count: usize,
    kind: Kind,
    (law, at): (Option<&str>, Option<&str>),
) -> String {
    let name = match kind {
        Kind::Siva => "free mass",
        Kind::Piva => "pendulum",
        Kind::Stop => "stop on the ground",
        Kind::None => return "Absorber: none".to_owned(),
    };
    let of = |value: fn(Absorber) -> f64| extent(units.values(value));
    let mass = extent(units.places().map(|(design, places)| {
        places.filter_map(|place| design.scene.absorber_of(place)).map(|unit| unit.mass_ratio).sum()
    }));
    let divided = extent(units.places().map(|(_, places)| places.count() as f64));
    let restitution = match law {
        Some(law) => law.to_owned(),
        None => of(|absorber| absorber.restitution),
    };
    let minus = match of(|absorber| absorber.restitution_minus) {
        _ if law.is_some() => String::new(),
        minus if minus == restitution => String::new(),
        minus => format!(", at the wall - {minus}"),
    };
    let [which, clearance] = match count {
        1 => [String::new(), String::new()],
        _ => [format!(" {}", units.absorber), format!(", clearance {}", of(|it| it.clearance))],
    };
    let divided = if divided == "1" { String::new() } else { format!(" in {divided} units") };
    let mass = match (at, kind) {
        (Some(point), Kind::Stop) => format!(" at {point}"),
        (None, Kind::Stop) => String::new(),
        (Some(point), _) => format!(", {mass} kg at {point}"),
        (None, _) => format!(", mass ratio {mass}"),
    };
    format!("Absorber{which}: {name}{divided}{mass}, restitution {restitution}{minus}{clearance}")
}

/// The unit of a length behind its value, if it has one.
fn in_words(shown: Shown) -> String {
    match shown.unit(Quantity::Length) {
        "" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// The line on the start: initial displacement of the structure, and the clearance.
fn start(designs: &[Design], shown: Shown) -> String {
    let unit = in_words(shown);
    let length = |value| shown.value(Quantity::Length, value);
    let from = range(designs, |design| length(design.scene.primary().x));
    if designs.iter().all(|design| design.scene.count() != 1) {
        return format!("Start: displacement {from}{unit}");
    }
    let clearance = range_of(designs, |absorber| length(absorber.clearance));
    if designs.iter().any(|design| design.scene.primary().x == 0.0) {
        return format!("Start: displacement {from}{unit}; clearance {clearance}{unit}");
    }
    let relative = range(designs, |design| {
        let clearance = design.scene.absorber().map_or(f64::NAN, |absorber| absorber.clearance);
        clearance / design.scene.primary().x.abs()
    });
    format!(
        "Start: displacement {from}{unit}; clearance (half of the play) {clearance}{unit}, \
         {relative} of it"
    )
}

/// The line on gravity along the motion of a free mass, relative to the largest acceleration of the
/// structure; for a level motion it gives the ratio of an upright one.
fn gravity(designs: &[Design], units: UnitSystem) -> Option<String> {
    let along: Option<Vec<f64>> =
        designs.iter().map(|design| design.scene.gravity_along(0)).collect();
    let along = along.filter(|along| !along.is_empty())?;
    let level = along.iter().all(|along| *along == 0.0);
    if level && units != UnitSystem::Si {
        return None;
    }
    let share = |(design, along): (&Design, &f64)| {
        let frequency = design.scale.natural_frequency;
        let upright = STANDARD_GRAVITY / (frequency * frequency);
        let gravity = if level { upright } else { *along };
        Some(gravity / acceleration(design)?).filter(|share| share.is_finite())
    };
    let shares: Option<Vec<f64>> = designs.iter().zip(&along).map(share).collect();
    let line = if level { "The line of motion is level" } else { "The line of motion rises" };
    let Some(shares) = shares else { return Some(line.to_owned()) };
    let gravity = if level {
        "Upright (inclination_deg = 90) gravity would be"
    } else {
        "Gravity along it is"
    };
    let (least, most) = shares
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high), share| (share.min(low), share.max(high)));
    let share = span(least, most);
    Some(format!(
        "{line}. {gravity} {share} times the largest acceleration of the structure without absorber (ωn² A in a \
         decay from A); above 1 a mass that lies on its lower stop stays there"
    ))
}

/// Estimate of the structure's largest acceleration without absorber, in ωn² × length; `None` under
/// any force but a single harmonic one on the structure.
fn acceleration(design: &Design) -> Option<f64> {
    let from = design.scene.primary();
    let decaying = from.x.hypot(from.v);
    let Some(force) = design.scene.force() else { return Some(decaying) };
    let harmonic = force.harmonics().first().filter(|_| force.is_single())?;
    let whole = design.scene.moves_as_one() && force.elsewhere().is_empty();
    let forced = whole.then(|| harmonic.response(design.scene.damping_ratio()))?;
    let square = harmonic.frequency * harmonic.frequency;
    (!force.moves_base()).then_some(decaying + square * forced)
}

/// The range of a number of the absorber over some designs.
fn range_of(designs: &[Design], value: impl Fn(Absorber) -> f64) -> String {
    range(designs, |design| design.scene.absorber().map_or(f64::NAN, &value))
}

/// Remark on a study in which nothing moves.
pub(crate) const NOTHING_MOVES: &str =
    "Nothing moves: the start has neither displacement nor velocity. Give start.displacement.";

/// The range of a value over some designs.
fn range(designs: &[Design], value: impl Fn(&Design) -> f64) -> String {
    extent(designs.iter().map(value))
}

/// The range of some values.
fn extent(values: impl Iterator<Item = f64>) -> String {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    span(low, high)
}

fn span(low: f64, high: f64) -> String {
    let [low, high] = [low, high].map(|value| short(value, 4));
    if low == high { low } else { format!("{low} … {high}") }
}

/// The lines on forces: amplitude (as static displacement) and frequency of a harmonic force, extent
/// and largest value of a record, number of impulses.
fn forces(designs: &[Design], units: UnitSystem, shown: Shown) -> Vec<String> {
    let Some(first) = designs.first().and_then(|design| design.scene.force()) else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    let all = |force: &Force| -> Vec<Harmonic> {
        force
            .harmonics()
            .iter()
            .chain(force.elsewhere().iter().map(|(_, it)| it))
            .copied()
            .collect()
    };
    for (number, Harmonic { acts, .. }) in all(first).into_iter().enumerate() {
        let of = |read: &dyn Fn(&Harmonic) -> f64| {
            let harmonic = |design: &Design| all(design.scene.force()?).get(number).copied();
            range(designs, |design| harmonic(design).map_or(f64::NAN, |harmonic| read(&harmonic)))
        };
        let amplitude = of(&|harmonic| shown.value(Quantity::Length, harmonic.amplitude.abs()));
        let length = in_words(shown);
        let frequency = of(&|harmonic| harmonic.frequency);
        if designs.iter().all(|design| design.scene.has_modes()) {
            let on = if acts == Acts::Base { "the base" } else { "the structure" };
            lines.push(format!("Force on {on}, of {frequency} times the natural frequency"));
            continue;
        }
        lines.push(format!(
            "Force: {frequency} times the natural frequency; held still, its amplitude would move the \
             structure by {amplitude}{length}"
        ));
    }
    let unit = units.unit(Quantity::Time);
    for record in first.records() {
        let (times, values) = (record.history.times(), record.history.values());
        let (from, to) = (times.first().copied(), times.last().copied());
        let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let of = match record.acts {
            Acts::Base => "the base",
            Acts::Primary => "the structure",
        };
        lines.push(format!(
            "Force on {of}: a record of {} points from {} to {} {unit}, largest value {}",
            times.len(),
            short(from.unwrap_or_default(), 4),
            short(to.unwrap_or_default(), 4),
            short(largest, 4),
        ));
    }
    let impulses = first.impulses().count();
    if impulses > 0 {
        lines.push(format!("Force: {} on the structure", counted(impulses as u64, "impulse")));
    }
    lines
}

/// The line on a pendulum, of whose units the first stands for all: frequency ratio, spring, length, gravity, and stops out of
/// reach.
fn pendulum(these: &Units<'_>, units: UnitSystem) -> String {
    let designs = these.designs;
    let each = |read: fn(&Parameters) -> f64| {
        let first = |(design, mut places): (&Design, std::vec::IntoIter<usize>)| {
            places.next().and_then(|place| design.scene.pendulum_of(place)).map_or(f64::NAN, read)
        };
        these.places().map(first).collect::<Vec<_>>()
    };
    let of = |read| extent(each(read).into_iter());
    let ratio = of(|pendulum| pendulum.frequency_ratio);
    let mut text = format!("Pendulum: frequency ratio {ratio}");
    let springs = each(|pendulum| pendulum.spring_ratio);
    if springs.iter().any(|spring| *spring != 0.0) {
        let _ = write!(text, ", spring ratio {}", extent(springs.into_iter()));
    }
    if designs.iter().all(|design| design.scene.has_angle()) {
        let si = units == UnitSystem::Si;
        let (metre, gravity_unit) = if si { (" m", " m/s²") } else { ("", "") };
        let length = of(|pendulum| pendulum.length);
        let gravity = range(designs, |design| design.scene.gravity().unwrap_or(f64::NAN));
        let _ = write!(text, ", length {}{metre}, gravity {gravity}{gravity_unit}", length);
    }
    let out_of_reach =
        designs.iter().filter(|design| design.scene.stop_reachable() == Some(false)).count();
    if out_of_reach > 0 {
        let which = if out_of_reach == designs.len() {
            "The stops are"
        } else {
            "At some points the stops are"
        };
        let _ = write!(
            text,
            ". {which} out of reach: the clearance is not smaller than the contact distance"
        );
    }
    text
}
