//! The resolved study: every default filled in, written as a study file that reads back the same.

use std::fmt::Write;

use iva_sweep::design::Spec;
use iva_sweep::fields::{Allowed, FieldId, Part};
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
    for (field, value) in file.study.spec.given() {
        if !axes.iter().any(|axis| axis.field.same_quantity(field)) {
            spec.set(field, value)?;
        }
    }
    let of_force = |field: FieldId| field.info().part == Part::Force;
    let driven = spec.given().any(|(field, _)| of_force(field))
        || axes.iter().any(|axis| of_force(axis.field));
    for field in FieldId::all() {
        let default = if field == FieldId::Gravity { gravity } else { field.default() };
        let fits = field.info().kind.is_none_or(|kind| kind == choices.kind)
            && (!of_force(field) || driven);
        let Some(value) = default.filter(|_| fits) else { continue };
        let given = spec.given().any(|(other, _)| other.same_quantity(field))
            || axes.iter().any(|axis| axis.field.same_quantity(field));
        if !given {
            spec.set(field, value)?;
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
    let driven = file.study.spec.given().any(|(field, _)| field.info().part == Part::Force);
    for part in Part::ALL {
        if part == Part::Force && !driven {
            continue;
        }
        let _ = writeln!(text, "\n[{}]", part.name());
        if part == Part::Absorber {
            for (name, word) in file.study.spec.choices().words() {
                let _ = writeln!(text, "{name} = \"{word}\"");
            }
        }
        for (field, value) in file.study.spec.given() {
            if field.info().part == part {
                let _ = writeln!(text, "{} = {}", field.info().name, literal(field, value));
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

fn write_run(text: &mut String, file: &StudyFile) {
    let study = &file.study;
    let swept = |axis: &Axis| axis.field == FieldId::ChatterFloor;
    if study.spec.get(FieldId::ChatterFloor).is_none() && !study.axes.iter().any(swept) {
        let _ = writeln!(text, "# chatter_floor: {}", FieldId::ChatterFloor.info().help);
    }
    let _ = writeln!(text, "samples_per_period = {}", file.samples_per_period);
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
    let literal = |value: f64| literal(axis.field, value);
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
