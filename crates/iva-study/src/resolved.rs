//! The resolved study: a study file with every default filled in, which reads back as the same study.

use std::fmt::Write;

use iva_store::folder::HEADER;
use iva_sweep::axis::Axis;
use iva_sweep::cube::Method;
use iva_sweep::design::Spec;
use iva_sweep::fields::{Allowed, FieldId, Part};
use iva_sweep::forces::ForceSpec;
use iva_sweep::restitution_table;
use iva_sweep::sampling::{Sample, Sampling};
use iva_sweep::slot::Slot;
use iva_sweep::study::Table;

use crate::error::Error;
use crate::selection;
use crate::structure;
use crate::study_file::{MOST_BYTES, STUDY_VERSION, StudyFile};

/// A study with its defaults filled in and without the base values that an axis replaces.
///
/// # Errors
/// If the first point of the study is invalid.
pub fn resolve(file: &StudyFile) -> Result<StudyFile, Error> {
    let located = |invalid| file.source.locate(&invalid);
    file.study.design(0).map_err(located)?;
    fill_in(file)
}

/// Fills in the defaults, but not that of the chatter floor, which depends on the clearance of each point.
fn fill_in(file: &StudyFile) -> Result<StudyFile, Error> {
    let mut resolved = file.clone();
    // Without the tables of the restitution that an axis replaces.
    let mut spec = file.study.spec(0)?.emptied();
    let absorbers = spec.count();
    let sampling = &file.study.sampling;
    // A force may be given by axes alone.
    let forces = file.study.spec(0)?.forces().to_vec();
    for force in &forces {
        spec.add_force(ForceSpec::new(force.record.clone()));
    }
    for (slot, value) in file.study.spec.given() {
        if !sampling.sets(slot) {
            spec.set(slot, value)?;
        }
    }
    for field in FieldId::all() {
        let Some(value) = file.study.default(field) else { continue };
        let slots: Vec<Slot> = if field.info().part == Part::Force {
            let own = (0..forces.len()).filter(|number| !forces[*number].is_foreign(field));
            own.map(|number| Slot::of_force(field, number, forces.len())).collect()
        } else if field.of_absorber() {
            (0..absorbers).map(|number| spec.slot(field, number)).collect()
        } else {
            vec![field.into()]
        };
        for slot in slots.into_iter().filter(|slot| file.study.spec.has(*slot)) {
            let given =
                spec.given().any(|(other, _)| other.same_quantity(slot)) || sampling.sets(slot);
            if !given {
                spec.set(slot, value)?;
            }
        }
    }
    resolved.study.spec = spec;
    Ok(resolved)
}

/// The text of a study after [`resolve`]; the same study always gives the same bytes.
///
/// # Errors
/// If the units of the study are invalid, or the text is larger than a study file may be.
pub fn write(file: &StudyFile) -> Result<String, Error> {
    let units = file.study.units().map_err(|invalid| file.source.locate(&invalid))?;
    let text = text_of(file, units.sentence());
    match text.len() as u64 {
        bytes if bytes <= MOST_BYTES => Ok(text),
        bytes => Err(Error::LargeResolved { bytes }),
    }
}

/// The sentence with a capital first letter.
pub fn first_upper(sentence: &str) -> String {
    let mut chars = sentence.chars();
    match chars.next() {
        // Only ASCII letters change, since "ωn" is a symbol.
        Some(first) => first.to_ascii_uppercase().to_string() + chars.as_str(),
        None => String::new(),
    }
}

/// The text of a resolved study, with the sentence `units` in its header.
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
        if part == Part::Absorber {
            write_absorbers(&mut text, &file.study.spec);
            continue;
        }
        if let (Part::Primary, Some(structure)) = (part, file.study.spec.structure()) {
            structure::write(&mut text, structure);
            continue;
        }
        let _ = writeln!(text, "\n[{}]", part.name());
        for (slot, value) in file.study.spec.given() {
            if slot.info().part == part && slot.number.is_none() {
                let _ = writeln!(text, "{} = {}", slot.info().name, literal(slot.field, value));
            }
        }
        if part == Part::Start {
            write_starts(&mut text, &file.study.spec);
        }
        if part == Part::Run {
            write_run(&mut text, file);
        }
    }
    write_sweep(&mut text, &file.study.sampling);
    text.push_str("\n[report]\n");
    if let Some(best_by) = file.report.best_by {
        let _ = writeln!(text, "best_by = \"{best_by}\"");
    }
    let _ = writeln!(text, "count = {}", file.report.count);
    text
}

/// Writes the sections of the absorbers.
fn write_absorbers(text: &mut String, spec: &Spec) {
    let heading = if spec.count() > 1 { "[[absorber]]" } else { "[absorber]" };
    for number in 0..spec.count() {
        let _ = writeln!(text, "\n{heading}");
        for (name, word) in spec.choices_of(number).words() {
            let _ = writeln!(text, "{name} = \"{word}\"");
        }
        for (slot, value) in spec.given().filter(|(slot, _)| slot.info().part == Part::Absorber) {
            if slot.number.unwrap_or(0) == number {
                let _ = writeln!(text, "{} = {}", slot.info().name, literal(slot.field, value));
            }
        }
        if let Some(table) = spec.restitution_table(number) {
            let points = table.points().iter().map(|[speed, e]| format!("[{speed:?}, {e:?}]"));
            let points: Vec<String> = points.collect();
            let _ = writeln!(text, "{} = [{}]", restitution_table::NAME, points.join(", "));
        }
    }
}

/// Writes what each of several absorbers or units has of its own in the start, as lists. What an axis sets for one of them has a 0.
fn write_starts(text: &mut String, spec: &Spec) {
    let listed = FieldId::all().filter(|field| field.info().part == Part::Start);
    for field in listed.filter(|field| field.of_absorber()) {
        let starts = spec.starts(field).into_iter().map(|value| literal(field, value));
        let list: Vec<String> = starts.collect();
        if !list.is_empty() {
            let _ = writeln!(text, "{} = [{}]", field.info().name, list.join(", "));
        }
    }
}

/// Writes the sections of the forces.
fn write_forces(text: &mut String, spec: &Spec) {
    let heading = if spec.forces().len() > 1 { "[[force]]" } else { "[force]" };
    for (number, force) in spec.forces().iter().enumerate() {
        let _ = writeln!(text, "\n{heading}");
        if let Some(recorded) = &force.record {
            let file = toml::Value::from(recorded.file.clone().unwrap_or_default());
            let _ = writeln!(text, "record = {file}\nkind = \"{}\"", recorded.kind.name());
            selection::write(text, &recorded.selection);
        }
        for (slot, value) in spec.given().filter(|(slot, _)| slot.info().part == Part::Force) {
            if slot.number.unwrap_or(0) == number {
                let _ = writeln!(text, "{} = {}", slot.info().name, literal(slot.field, value));
            }
        }
    }
}

/// Writes the keys of `[run]` that are not fields of the spec.
fn write_run(text: &mut String, file: &StudyFile) {
    let study = &file.study;
    let floor = FieldId::ChatterFloor;
    let listed = study.spec.has(floor.into());
    if listed && study.spec.get(floor).is_none() && !study.sampling.sets(floor.into()) {
        let _ = writeln!(text, "# chatter_floor: {}", floor.info().help);
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

/// Writes the sections `[sampling]` and `[sweep]`.
fn write_sweep(text: &mut String, sampling: &Sampling) {
    let axes = match sampling {
        Sampling::Grid(axes) => axes.as_slice(),
        Sampling::Rows(rows) => {
            if let Some(file) = &rows.file {
                let file = toml::Value::from(file.clone());
                let _ = writeln!(text, "\n[sampling]\npoints = {file}");
                return;
            }
            text.push_str("\n[sampling]\nmethod = \"zip\"\n");
            rows.axes()
        }
        Sampling::Sample(sample) => return write_sample(text, sample),
    };
    if !axes.is_empty() {
        text.push_str("\n[sweep]\n");
    }
    for axis in axes {
        write_axis(text, axis);
    }
}

/// Writes the sections of a sample of random variables.
fn write_sample(text: &mut String, sample: &Sample) {
    let Sample { method, count, seed, .. } = sample;
    let _ = writeln!(text, "\n[sampling]\nmethod = \"{}\"", method.name());
    let _ = writeln!(text, "count = {count}\nseed = {seed}");
    if *method == Method::Sobol {
        let _ = writeln!(text, "scramble = {}", sample.scramble);
    }
    text.push_str("\n[sweep]\n");
    for variable in sample.variables() {
        let (name, numbers) = variable.given();
        let numbers = numbers.iter().map(|(name, value)| format!("{name} = {value:?}"));
        let given: Vec<String> =
            std::iter::once(format!("distribution = \"{name}\"")).chain(numbers).collect();
        let _ = writeln!(text, "{} = {{ {} }}", key_of(&variable.key), given.join(", "));
    }
}

/// A key in TOML, quoted if necessary.
fn key_of(key: &str) -> String {
    let plain = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain { key.to_owned() } else { format!("\"{key}\"") }
}

/// Writes an axis as start, stop and count, or as a list of values.
fn write_axis(text: &mut String, axis: &Axis) {
    let key = key_of(&axis.key);
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

/// The ends of an axis whose values are bit for bit those computed from start, stop and count.
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

/// The shortest TOML number that reads back as the same value.
fn literal(field: FieldId, value: f64) -> String {
    match field.info().allowed {
        Allowed::PositiveInteger | Allowed::Units => format!("{value:.0}"),
        _ => format!("{value:?}"),
    }
}

#[cfg(test)]
mod tests;
