//! Reading of the section `[sweep]`: the swept quantities, in the order of the file, and the values of axes.

use std::ops::Range;

use iva_sweep::Invalid;
use iva_sweep::axis::{Axis, MAX_VALUES};
use iva_sweep::fields::{Allowed, Part};
use iva_sweep::sampling::MAX_POINTS;
use iva_sweep::slot::Slot;

use toml::de::{DeTable, DeValue};

use crate::error::Error;
use crate::source::{Source, shortened};
use crate::value::{Key, Value, at, entries, number, table, whole_number};

/// An entry of the section `[sweep]`, before its values are computed.
pub(crate) struct Entry<'a, 't> {
    /// Key as the user wrote it, with dots for nested tables (`part.name`).
    pub key: String,
    span: Range<usize>,
    /// Value of the key.
    pub value: &'a Value<'t>,
}

/// Reads the keys of the section.
///
/// # Errors
/// At the place of the first unknown or ambiguous key; also for an empty section.
pub(crate) fn read<'a, 't>(
    source: &mut Source,
    key: &Key<'t>,
    value: &'a Value<'t>,
) -> Result<Vec<Entry<'a, 't>>, Error> {
    let section = table(source, "sweep", key, value)?;
    source.note("sweep".to_owned(), key.span());
    let entries = flatten(section);
    if entries.is_empty() {
        return Err(source.error(
            key.span(),
            "sweep is empty: give at least one axis, for example mass_ratio = [0.05, 0.1], or \
             remove the section",
        ));
    }
    check_fields(source, &entries)?;
    Ok(entries)
}

/// Reads the axes with their values.
///
/// # Errors
/// At the place of the first wrong type or value out of range.
pub(crate) fn values(source: &mut Source, entries: &[Entry<'_, '_>]) -> Result<Vec<Axis>, Error> {
    let mut axes = Vec::with_capacity(entries.len());
    for entry in entries {
        let axis = read_axis(source, entry)?;
        note(source, entry, axis.slot);
        axes.push(axis);
    }
    Ok(axes)
}

/// Records the place of an entry.
pub(crate) fn note(source: &mut Source, entry: &Entry<'_, '_>, slot: Slot) {
    source.note(format!("sweep.{}", entry.key), entry.span.clone());
    source.note_axis(slot, entry.span.clone());
}

/// The entries in the order of the file. TOML parses `absorber.mass = …` or `absorber.1.mass = …` as nested
/// tables, which become entries with dotted keys again.
fn flatten<'a, 't>(section: &'a DeTable<'t>) -> Vec<Entry<'a, 't>> {
    let mut flat = Vec::new();
    push_entries(&mut flat, "", section);
    flat.sort_by_key(|entry| entry.span.start);
    flat
}

/// Adds the entries of a table with the key `outer`, and of tables nested in it.
fn push_entries<'a, 't>(flat: &mut Vec<Entry<'a, 't>>, outer: &str, table: &'a DeTable<'t>) {
    for (key, value) in entries(table) {
        let inner = key.get_ref().as_ref();
        let name = if outer.is_empty() { inner.to_owned() } else { format!("{outer}.{inner}") };
        let is_part = outer.is_empty() && Part::ALL.iter().any(|part| part.name() == inner);
        let lists = [Part::Force, Part::Absorber, Part::Start];
        let is_list = lists.iter().any(|part| part.name() == outer);
        let is_number = is_list && inner.parse::<usize>().is_ok();
        match value.get_ref() {
            DeValue::Table(table) if is_part || is_number => push_entries(flat, &name, table),
            _ => flat.push(Entry { key: name, span: key.span(), value }),
        }
    }
}

/// Checks that every key names a field.
fn check_fields(source: &Source, entries: &[Entry<'_, '_>]) -> Result<(), Error> {
    entries.iter().try_for_each(|entry| slot(source, entry).map(drop))
}

/// The field that a key names.
///
/// # Errors
/// At the place of an unknown or ambiguous key.
pub(crate) fn slot(source: &Source, entry: &Entry<'_, '_>) -> Result<Slot, Error> {
    Slot::from_key(&entry.key).map_err(|invalid| {
        let value = format!("`{}`", shortened(&entry.key));
        at(source, entry.span.clone(), &Invalid { value, ..invalid })
    })
}

/// Refuses a grid with too many points before its values are computed.
///
/// # Errors
/// At the place of the section.
pub(crate) fn check_size(
    source: &Source,
    span: Range<usize>,
    entries: &[Entry<'_, '_>],
) -> Result<(), Error> {
    let lengths: Vec<f64> = entries.iter().filter_map(length).collect();
    let points: f64 = lengths.iter().product();
    if points <= MAX_POINTS as f64 {
        return Ok(());
    }
    let lengths: Vec<String> = lengths.iter().map(f64::to_string).collect();
    Err(source
        .error(span, format!("sweep = {}: a grid has at most 2^32 points", lengths.join(" × "))))
}

/// The number of values of an axis; `None` if it cannot be read or is larger than a whole grid may be.
fn length(entry: &Entry<'_, '_>) -> Option<f64> {
    match entry.value.get_ref() {
        DeValue::Array(items) => Some(items.len() as f64),
        DeValue::Table(range) => range
            .get("count")?
            .get_ref()
            .as_integer()?
            .as_str()
            .parse::<f64>()
            .ok()
            .filter(|count| *count <= MAX_POINTS as f64),
        _ => None,
    }
}

/// Reads an axis from a list of values, or from start, stop and count.
fn read_axis(source: &Source, entry: &Entry<'_, '_>) -> Result<Axis, Error> {
    let name = format!("sweep.{}", entry.key);
    let allowed = slot(source, entry)?.info().allowed;
    let place = entry.value.span();
    let axis = match entry.value.get_ref() {
        DeValue::Array(items) => {
            if items.is_empty() {
                return Err(source.bad_value(&name, place, "give at least one value"));
            }
            let mut values = Vec::with_capacity(items.len());
            for (index, item) in items.iter().enumerate() {
                values.push(number(source, &format!("{name}[{index}]"), item, allowed)?);
            }
            Axis::new(&entry.key, values)
        }
        DeValue::Table(range) => {
            let (start, stop, count) = read_range(source, entry, &name, range, allowed)?;
            Axis::linspace(&entry.key, start, stop, count)
        }
        _ => {
            return Err(source.bad_value(
                &name,
                place,
                "give a list of numbers or { start = …, stop = …, count = … }",
            ));
        }
    };
    axis.map_err(|invalid| at(source, place, &invalid))
}

/// Reads start, stop and count of an axis.
fn read_range(
    source: &Source,
    entry: &Entry<'_, '_>,
    name: &str,
    range: &DeTable<'_>,
    allowed: Allowed,
) -> Result<(f64, f64, u64), Error> {
    const KEYS: [&str; 3] = ["start", "stop", "count"];
    for (key, _) in entries(range) {
        if !KEYS.contains(&key.get_ref().as_ref()) {
            let key_name = shortened(key.get_ref());
            let message =
                format!("{name}.{key_name}: no such key; an axis has {}", KEYS.join(", "));
            return Err(source.error(key.span(), message));
        }
    }
    let part = |key: &str| {
        range.get(key).ok_or_else(|| {
            source.error(
                entry.span.clone(),
                format!("{name}.{key} is missing: give start, stop and count"),
            )
        })
    };
    let (start, stop, count) = (part("start")?, part("stop")?, part("count")?);
    Ok((
        number(source, &format!("{name}.start"), start, allowed)?,
        number(source, &format!("{name}.stop"), stop, allowed)?,
        whole_number(source, &format!("{name}.count"), count, (1, MAX_VALUES))?,
    ))
}
