//! Reading of the section `[force]` or of several sections `[[force]]`.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use iva_store::inputs::is_input_name;
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::forces::{ForceSpec, History, RecordKind, Recorded, Selection};
use iva_sweep::slot::Slot;
use toml::de::{DeTable, DeValue};

use crate::error::Error;
use crate::record_file::{RecordFile, RecordUnit, Unread, read_record_in_si};
use crate::selection;
use crate::source::Source;
use crate::value::{Key, Value, as_number, at, entries, name, number, table, unknown_key};

/// Keys of a recorded force that are no fields of a scene, besides those of [`selection`].
const OF_A_RECORD: [&str; 2] = ["record", "kind"];

/// Base accelerations without a unit of at most that size may be in g: hardly an earthquake exceeds 2 g.
const AS_G: f64 = 2.0;

/// Larger ones are hardly in m/s²: the ground never reached 5 g.
const AS_MILLIMETRES: f64 = 50.0;

/// Factors that make an earthquake weaker or stronger; others turn a unit into another one.
const STRENGTHS: RangeInclusive<f64> = 0.1..=8.0;

/// Reads all forces of a study into its spec.
///
/// # Errors
/// At the place of the first unknown key or invalid value; for invalid contents of a record, at their place in
/// the file of the record.
pub(crate) fn read(
    source: &mut Source,
    key: &Key<'_>,
    value: &Value<'_>,
    spec: &mut Spec,
) -> Result<(), Error> {
    source.note(Part::Force.name().to_owned(), key.span());
    let items = match value.get_ref() {
        DeValue::Array(items) if items.iter().all(|item| item.get_ref().is_table()) => &items[..],
        _ => std::slice::from_ref(value),
    };
    let mut sections = Vec::with_capacity(items.len());
    for item in items {
        let section = table(source, Part::Force.name(), key, item)?;
        check_keys(source, section)?;
        spec.add_force(ForceSpec::new(read_recorded(source, section)?));
        sections.push(section);
    }
    for (number, section) in sections.iter().enumerate() {
        if sections.len() > 1 {
            source.note(format!("force.{number}"), items[number].span());
        }
        read_numbers(source, section, number, sections.len(), spec)?;
    }
    Ok(())
}

/// Reads the numeric fields of force number `force` of `count`.
fn read_numbers(
    source: &mut Source,
    section: &DeTable<'_>,
    force: usize,
    count: usize,
    spec: &mut Spec,
) -> Result<(), Error> {
    for (key, value) in entries(section) {
        let bare = key.get_ref().as_ref();
        let selects = section.contains_key("record") && selection::KEYS.contains(&bare);
        let Some(field) = FieldId::find(Part::Force, bare).filter(|_| !selects) else { continue };
        let slot = Slot::of_force(field, force, count);
        let number = number(source, &slot.path(), value, field.info().allowed)?;
        spec.set(slot, number).map_err(|invalid| at(source, value.span(), &invalid))?;
        source.note(slot.path(), key.span().start..value.span().end);
    }
    Ok(())
}

/// Checks that a section of a force has only keys that there are.
fn check_keys(source: &Source, section: &DeTable<'_>) -> Result<(), Error> {
    let known = known_keys();
    match entries(section).iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref())) {
        Some((key, _)) => Err(unknown_key(source, Part::Force.name(), key, &known)),
        None => Ok(()),
    }
}

/// The keys that a section of a force may have.
fn known_keys() -> Vec<&'static str> {
    let fields = FieldId::all().map(FieldId::info).filter(|info| info.part == Part::Force);
    let mut known: Vec<_> = fields.map(|info| info.name).chain(OF_A_RECORD).collect();
    known.extend(selection::KEYS.iter().filter(|key| FieldId::find(Part::Force, key).is_none()));
    known
}

/// The recorded force of a section, if the section names a record.
fn read_recorded(source: &Source, section: &DeTable<'_>) -> Result<Option<Recorded>, Error> {
    let Some((_, value)) = section.get_key_value("record") else {
        // The time is that of an impulse.
        let keys = ["kind", "column", "unit", "sampling_hz"];
        return match keys.iter().find_map(|key| section.get_key_value(*key)) {
            Some((key, _)) => {
                let name = key.get_ref();
                let rule =
                    format!("force.{name} is one of a record: give record, the name of a file");
                Err(source.error(key.span(), rule))
            }
            None => Ok(None),
        };
    };
    let DeValue::String(file) = value.get_ref() else {
        let rule = "give the name of a file, in quotes";
        return Err(source.bad_value("force.record", value.span(), rule));
    };
    let kinds = RecordKind::ALL.map(RecordKind::name);
    let kind = match section.get_key_value("kind") {
        Some((_, kind)) => name(source, "force.kind", kind, &kinds, RecordKind::from_name)?,
        None => {
            let rule = format!("force.kind is missing: give one of \"{}\"", kinds.join("\", \""));
            return Err(source.error(value.span(), rule));
        }
    };
    let path = beside(source.path(), file.as_ref());
    let mut selection = selection::read(source, section)?;
    // Those of earlier versions do not say that they are in the units of the study.
    if source.is_resolved() && is_input_name(file) && selection == Selection::default() {
        selection.unit = Some("1".to_owned());
    }
    let read = read_record_in_si(&path, &selection).map_err(|unread| match unread {
        Unread::File(Error::UnreadableRecord { reason, .. }) => {
            source.bad_value("force.record", value.span(), &format!("it cannot be read: {reason}"))
        }
        Unread::File(other) => other,
        Unread::Key { key, message } => {
            let place = section.get_key_value(key).map_or(value, |(_, given)| given);
            source.error(place.span(), message)
        }
    })?;
    if let Some(rule) = doubt(section, kind, &read) {
        return Err(source.error(value.span(), format!("{}: {rule}", path.display())));
    }
    let is_metric = read.unit == RecordUnit::MetresPerSecondSquared;
    let history = History::new(read.times, read.values)
        .map_err(|invalid| source.error(value.span(), format!("{}: {invalid}", path.display())))?;
    let file = Some(path.display().to_string());
    Ok(Some(Recorded { history: Arc::new(history), kind, file, selection, is_metric }))
}

/// Why the values of a record may not be what `kind` says, by their unit or their size.
fn doubt(section: &DeTable<'_>, kind: RecordKind, read: &RecordFile) -> Option<String> {
    if read.unit == RecordUnit::Newtons && kind != RecordKind::ForceNewtons {
        let fitting = RecordKind::ForceNewtons.name();
        return Some(format!("its values are forces in N: give force.kind = \"{fitting}\""));
    }
    if read.unit != RecordUnit::Unstated || kind != RecordKind::BaseAcceleration {
        return None;
    }
    let given = section.get_key_value("scale").and_then(|(_, scale)| as_number(scale.get_ref()));
    let scale = given.map_or(1.0, f64::abs);
    let peak = scale * read.values.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    let others = match peak {
        _ if !STRENGTHS.contains(&scale) || peak == 0.0 => return None,
        _ if peak <= AS_G => "g",
        _ if peak > AS_MILLIMETRES => "mm/s^2 or Gal",
        _ => return None,
    };
    Some(format!(
        "it states no unit, and accelerations of up to {peak} may be in m/s^2 or in {others}; give force.unit, \
         or \"1\" for that of the study, or write it behind the name of the column: \"acceleration (g)\""
    ))
}

/// The path of a file that a study names, relative to the folder of the study unless the name is absolute.
pub(crate) fn beside(study: &Path, file: &str) -> PathBuf {
    let path = study.parent().unwrap_or(Path::new("")).join(file);
    // The resolved study is in another folder, so the path must be absolute.
    path.canonicalize().unwrap_or(path)
}
