//! The resolved study: every default filled in, written as a study file that reads back the same.

use std::fmt::Write;

use iva_sweep::design::Spec;
use iva_sweep::fields::{Allowed, FieldId, Part};
use iva_sweep::forces::ForceSpec;
use iva_sweep::slot::Slot;
use iva_sweep::study::{Axis, Table};

use crate::error::Error;
use crate::layout::first_upper;
use crate::study_file::{STUDY_VERSION, StudyFile};

/// How the first line of every resolved study begins; a `study.toml` without it is the user's.
pub const HEADER: &str = "# Resolved by iva-dynamics";

/// The same study with its defaults written out, and without the base values that an axis replaces.
///
/// # Errors
/// If the first point of the study is invalid.
pub fn resolve(file: &StudyFile) -> Result<StudyFile, Error> {
    let located = |invalid| file.source.locate(&invalid);
    file.study.design(0).map_err(located)?;
    let gravity = file.study.spec(0).and_then(|spec| spec.standard_gravity()).map_err(located)?;
    fill_in(file, gravity)
}

/// The chatter floor is no plain number: it follows the clearance of each point.
fn fill_in(file: &StudyFile, gravity: Option<f64>) -> Result<StudyFile, Error> {
    let mut resolved = file.clone();
    let choices = *file.study.spec.choices();
    let mut spec = Spec::new(choices);
    let axes = &file.study.axes;
    // A force may be made of axes alone.
    let forces = file.study.spec(0)?.forces().to_vec();
    for force in &forces {
        spec.add_force(ForceSpec::new(force.record.clone()));
    }
    for (slot, value) in file.study.spec.given() {
        if !axes.iter().any(|axis| axis.slot.same_quantity(slot)) {
            spec.set(slot, value)?;
        }
    }
    let fits = |field: &FieldId| field.info().kind.is_none_or(|kind| kind == choices.kind);
    for field in FieldId::all().filter(fits) {
        let default = if field == FieldId::Gravity { gravity } else { field.default() };
        let Some(value) = default else { continue };
        let slots: Vec<Slot> = if field.info().part == Part::Force {
            let own = (0..forces.len()).filter(|number| !forces[*number].is_foreign(field));
            own.map(|number| Slot::of_force(field, number, forces.len())).collect()
        } else {
            vec![field.into()]
        };
        for slot in slots {
            let given = spec.given().any(|(other, _)| other.same_quantity(slot))
                || axes.iter().any(|axis| axis.slot.same_quantity(slot));
            if !given {
                spec.set(slot, value)?;
            }
        }
    }
    resolved.study.spec = spec;
    Ok(resolved)
}

/// The text of a study, after [`resolve`]: the same study reads the same bytes, always.
///
/// # Errors
/// If the first point of the study is invalid.
pub fn write(file: &StudyFile) -> Result<String, Error> {
    let units = file.study.units().map_err(|invalid| file.source.locate(&invalid))?;
    Ok(text_of(file, units.sentence()))
}

fn text_of(file: &StudyFile, units: &str) -> String {
    let mut text = String::new();
    let version = env!("CARGO_PKG_VERSION");
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{HEADER} {version}: every default is filled in.");
    let _ = writeln!(text, "# {}.\n", first_upper(units));
    let _ = writeln!(text, "version = {STUDY_VERSION}");
    for part in Part::ALL {
        if part == Part::Force {
            write_forces(&mut text, &file.study.spec);
            continue;
        }
        let _ = writeln!(text, "\n[{}]", part.name());
        if part == Part::Absorber {
            for (name, word) in file.study.spec.choices().words() {
                let _ = writeln!(text, "{name} = \"{word}\"");
            }
        }
        for (slot, value) in file.study.spec.given() {
            if slot.info().part == part {
                let _ = writeln!(text, "{} = {}", slot.info().name, literal(slot.field, value));
            }
        }
        if part == Part::Run {
            write_run(&mut text, file);
        }
    }
    if !file.study.axes.is_empty() {
        text.push_str("\n[sweep]\n");
        for axis in &file.study.axes {
            write_axis(&mut text, axis);
        }
    }
    text.push_str("\n[report]\n");
    if let Some(best_by) = file.report.best_by {
        let _ = writeln!(text, "best_by = \"{best_by}\"");
    }
    let _ = writeln!(text, "count = {}", file.report.count);
    text
}

fn write_forces(text: &mut String, spec: &Spec) {
    let heading = if spec.forces().len() > 1 { "[[force]]" } else { "[force]" };
    for (number, force) in spec.forces().iter().enumerate() {
        let _ = writeln!(text, "\n{heading}");
        if let Some(recorded) = &force.record {
            let file = toml::Value::from(recorded.file.clone().unwrap_or_default());
            let _ = writeln!(text, "record = {file}\nkind = \"{}\"", recorded.kind.name());
        }
        for (slot, value) in spec.given().filter(|(slot, _)| slot.info().part == Part::Force) {
            if slot.force.unwrap_or(0) == number {
                let _ = writeln!(text, "{} = {}", slot.info().name, literal(slot.field, value));
            }
        }
    }
}

fn write_run(text: &mut String, file: &StudyFile) {
    let study = &file.study;
    let swept = |axis: &Axis| axis.slot.field == FieldId::ChatterFloor;
    if study.spec.get(FieldId::ChatterFloor).is_none() && !study.axes.iter().any(swept) {
        let _ = writeln!(text, "# chatter_floor: {}", FieldId::ChatterFloor.info().help);
    }
    let _ = writeln!(text, "samples_per_period = {}", file.samples_per_period);
    let _ = writeln!(text, "errors = {}", study.errors);
    let tables: Vec<&str> = study.tables.iter().copied().map(Table::name).collect();
    let _ = writeln!(text, "tables = [\"{}\"]", tables.join("\", \""));
    text.push_str("measures = [\n");
    for name in study.measures.names() {
        let _ = writeln!(text, "    \"{name}\",");
    }
    text.push_str("]\n");
}

fn write_axis(text: &mut String, axis: &Axis) {
    let plain = axis.key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let key = if plain { axis.key.clone() } else { format!("\"{}\"", axis.key) };
    let literal = |value: f64| literal(axis.slot.field, value);
    if let Some((start, stop)) = equidistant(axis) {
        let _ = writeln!(
            text,
            "{key} = {{ start = {}, stop = {}, count = {} }}",
            literal(start),
            literal(stop),
            axis.values.len()
        );
    } else {
        let values: Vec<String> = axis.values.iter().copied().map(literal).collect();
        let _ = writeln!(text, "{key} = [{}]", values.join(", "));
    }
}

/// The ends of an axis whose values are, bit for bit, those of start, stop and count.
fn equidistant(axis: &Axis) -> Option<(f64, f64)> {
    let (start, stop) = (*axis.values.first()?, *axis.values.last()?);
    let count = axis.values.len();
    if count < 3 {
        return None;
    }
    let made = Axis::linspace(&axis.key, start, stop, count as u64).ok()?;
    let same = made.values.iter().zip(&axis.values).all(|(a, b)| a.to_bits() == b.to_bits());
    same.then_some((start, stop))
}

/// The shortest text that reads back as the same number.
fn literal(field: FieldId, value: f64) -> String {
    match field.info().allowed {
        Allowed::PositiveInteger => format!("{value:.0}"),
        _ => format!("{value:?}"),
    }
}

#[cfg(test)]
mod tests;
