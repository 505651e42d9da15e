//! Reading of the section `[absorber]` or of several sections `[[absorber]]`, and of lists in `[start]`.

use iva_sweep::choices::{CHOICES, Choices, Kind};
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::restitution_table;
use iva_sweep::slot::Slot;
use toml::de::{DeTable, DeValue};

use crate::error::Error;
use crate::source::Source;
use crate::value::{Key, Value, as_number, at, entries, name, number, one_of, table, unknown_key};

/// A section of an absorber, with the place that is named if something is missing in it.
#[derive(Debug)]
pub(crate) struct Section<'a, 't> {
    table: &'a DeTable<'t>,
    span: std::ops::Range<usize>,
}

/// The sections of all absorbers.
///
/// # Errors
/// At the section that is none.
pub(crate) fn sections<'a, 't>(
    source: &Source,
    key: &'a Key<'t>,
    value: &'a Value<'t>,
) -> Result<Vec<Section<'a, 't>>, Error> {
    let name = Part::Absorber.name();
    let items = match value.get_ref() {
        DeValue::Array(items) if items.iter().all(|item| item.get_ref().is_table()) => &items[..],
        _ => {
            return Ok(vec![Section { table: table(source, name, key, value)?, span: key.span() }]);
        }
    };
    let section = |item: &'a Value<'t>| {
        let span = if items.len() > 1 { item.span() } else { key.span() };
        Ok(Section { table: table(source, name, key, item)?, span })
    };
    items.iter().map(section).collect()
}

/// Path of a key in the section of the absorber with this number, of so many.
fn path(name: &str, number: usize, count: usize) -> String {
    match count {
        1 => format!("{}.{name}", Part::Absorber.name()),
        _ => format!("{}.{number}.{name}", Part::Absorber.name()),
    }
}

/// Reads the choices given by words into a spec without numbers. The kind of an absorber comes first, since its other choices and
/// its numbers depend on it.
///
/// # Errors
/// For a missing kind, an unknown word, and a list that a spec does not take.
pub(crate) fn spec(source: &mut Source, sections: &[Section<'_, '_>]) -> Result<Spec, Error> {
    let count = sections.len();
    let mut all = Vec::with_capacity(count);
    for (number, section) in sections.iter().enumerate() {
        let mut choices = Choices::default();
        for choice in &CHOICES {
            let path = path(choice.name, number, count);
            let Some((key, value)) = section.table.get_key_value(choice.name) else {
                if choice.name == "kind" {
                    let rule = format!("{path} is missing: give {}", one_of(choice.words));
                    return Err(source.error(section.span.clone(), rule));
                }
                continue;
            };
            let find = |word: &str| choice.words.iter().find(|other| **other == word).copied();
            let word = name(source, &path, value, choice.words, find)?;
            choices
                .choose(choice.name, word)
                .map_err(|invalid| at(source, value.span(), &invalid))?;
            source.note(path, key.span().start..value.span().end);
        }
        all.push(choices);
    }
    Spec::several(&all).map_err(|invalid| source.locate(&invalid))
}

/// Reads the numbers of all absorbers into their spec.
///
/// # Errors
/// At the first unknown key or invalid value.
pub(crate) fn read(
    source: &mut Source,
    sections: &[Section<'_, '_>],
    spec: &mut Spec,
) -> Result<(), Error> {
    let (part, count) = (Part::Absorber, sections.len());
    for (absorber, section) in sections.iter().enumerate() {
        source.note(part.name().to_owned(), section.span.clone());
        if count > 1 {
            source.note(format!("{}.{absorber}", part.name()), section.span.clone());
        }
        for (key, value) in entries(section.table) {
            let bare = key.get_ref().as_ref();
            if CHOICES.iter().any(|choice| choice.name == bare) {
                continue;
            }
            if bare == restitution_table::NAME {
                let path = path(bare, absorber, count);
                read_table(source, &path, value, (&mut *spec, absorber))?;
                source.note(path, key.span().start..value.span().end);
                continue;
            }
            let Some(field) = FieldId::find(part, bare) else {
                let known = known_keys(part, spec.choices_of(absorber).kind);
                return Err(unknown_key(source, part.name(), key, &known));
            };
            let slot = Slot::of_absorber(field, absorber, count);
            let number = number(source, &slot.path(), value, field.info().allowed)?;
            spec.set(slot, number).map_err(|invalid| at(source, value.span(), &invalid))?;
            source.note(slot.path(), key.span().start..value.span().end);
        }
    }
    Ok(())
}

/// Reads the table of the restitution of an absorber.
///
/// # Errors
/// At what is no pair of numbers, and at a point that does not fit.
fn read_table(
    source: &Source,
    path: &str,
    value: &Value<'_>,
    (spec, absorber): (&mut Spec, usize),
) -> Result<(), Error> {
    let rule = "give a list of pairs [approach speed, restitution]";
    let DeValue::Array(items) = value.get_ref() else {
        return Err(source.bad_value(path, value.span(), rule));
    };
    let pair = |item: &Value<'_>| -> Option<[f64; 2]> {
        let numbers: Option<Vec<f64>> =
            item.get_ref().as_array()?.iter().map(|number| as_number(number.get_ref())).collect();
        numbers?.try_into().ok()
    };
    let mut points = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        let rule = "give a pair [approach speed, restitution]";
        let wrong = || source.bad_value(&format!("{path}[{index}]"), item.span(), rule);
        points.push(pair(item).ok_or_else(wrong)?);
    }
    spec.set_restitution_table(absorber, &points).map_err(|invalid| {
        let place = invalid.field.strip_prefix(path).and_then(|it| it.strip_prefix('['));
        let index = place.and_then(|it| it.split(']').next()?.parse::<usize>().ok());
        let item = index.and_then(|index| items.get(index)).unwrap_or(value);
        at(source, item.span(), &invalid)
    })
}

/// Reads a field of `[start]` that is given as a list with a number for each absorber, or for each unit.
///
/// # Errors
/// For a list of another length, and at an invalid number.
pub(crate) fn read_starts(
    source: &mut Source,
    field: FieldId,
    key: &Key<'_>,
    (value, items): (&Value<'_>, &[Value<'_>]),
    spec: &mut Spec,
) -> Result<(), Error> {
    let slots = spec.start_slots(field, items.len());
    let slots = slots.map_err(|rule| source.bad_value(&field.path(), value.span(), &rule))?;
    for (slot, item) in slots.into_iter().zip(items) {
        let Some(slot) = slot else { continue };
        let number = number(source, &slot.path(), item, field.info().allowed)?;
        spec.set(slot, number).map_err(|invalid| at(source, item.span(), &invalid))?;
        source.note(slot.path(), key.span().start..value.span().end);
    }
    Ok(())
}

/// The keys that the section of a part may have with a kind of absorber, numeric fields first.
pub(crate) fn known_keys(part: Part, kind: Kind) -> Vec<&'static str> {
    let numbers = FieldId::all()
        .map(FieldId::info)
        .filter(|info| info.part == part && info.kinds.contains(&kind))
        .map(|info| info.name);
    let words =
        CHOICES.iter().filter(|choice| part == Part::Absorber && choice.kinds.contains(&kind));
    let others: &[&str] = match part {
        Part::Absorber if kind != Kind::None => &[restitution_table::NAME],
        Part::Run => &["tables", "measures", "samples_per_period", "errors"],
        _ => &[],
    };
    numbers.chain(words.map(|choice| choice.name)).chain(others.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use iva_sweep::identity::Identity;

    use crate::error::Error;
    use crate::resolved::{resolve, write};
    use crate::study_file::parse_study;

    const ONE: &str = r#"version = 1
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution_table = [[0, 1], [0.5, 0.7], [2e0, 0.6]]
clearance = 0.5
[start]
displacement = 1
[run]
periods = 3
"#;

    const SEVERAL: &str = r#"version = 1
[[absorber]]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
clearance = 0.5
[[absorber]]
kind = "siva"
mass_ratio = 0.1
clearance = 0.4
restitution_table = [[0.1, 0.9], [1, 0.6]]
[start]
displacement = 1
[run]
periods = 3
"#;

    #[test]
    fn a_table_that_is_written_reads_back_the_same() {
        for (text, absorber, points) in [
            (ONE, 0, &[[0.0, 1.0], [0.5, 0.7], [2.0, 0.6]][..]),
            (SEVERAL, 1, &[[0.1, 0.9], [1.0, 0.6]]),
        ] {
            let file = resolve(&parse_study(Path::new("it.toml"), text).unwrap()).unwrap();
            let again = parse_study(Path::new("again.toml"), &write(&file).unwrap()).unwrap();
            assert_eq!(again.study, file.study);
            assert!(again.study.design(0).is_ok());
            let table = again.study.spec.restitution_table(absorber).unwrap();
            assert_eq!(table.points(), points);
            assert_eq!(again.study.spec.restitution_table(1 - absorber), None);
        }
    }

    #[test]
    fn an_axis_over_the_restitution_takes_the_place_of_a_table() {
        for key in ["restitution", "yield_speed"] {
            let text = format!("{ONE}[sweep]\n{key} = [0.5, 0.6]\n");
            let file = resolve(&parse_study(Path::new("it.toml"), &text).unwrap()).unwrap();
            assert_eq!(file.study.spec.restitution_table(0), None);
            assert!(file.study.design(1).is_ok());
        }
        let text = format!("{SEVERAL}[sweep]\n\"absorber.0.restitution\" = [0.5, 0.6]\n");
        let file = resolve(&parse_study(Path::new("it.toml"), &text).unwrap()).unwrap();
        assert!(file.study.spec.restitution_table(1).is_some());
    }

    #[test]
    fn another_table_makes_another_study() {
        let identity = |text: &str| {
            Identity::of(&parse_study(Path::new("it.toml"), text).unwrap().study).unwrap()
        };
        assert_eq!(identity(ONE), identity(&ONE.replace("2e0", "2.0")));
        assert_ne!(identity(ONE), identity(&ONE.replace("2e0", "2.1")));
        assert_ne!(identity(ONE), identity(&ONE.replace("0.7]", "0.71]")));
        assert_ne!(identity(ONE), identity(&ONE.replace(", [2e0, 0.6]", "")));
        assert_ne!(identity(SEVERAL), identity(&SEVERAL.replace("1, 0.6]", "1, 0.5]")));
    }

    #[test]
    #[allow(clippy::panic)]
    fn faults_of_a_table_are_told_at_their_places() {
        for (text, from, to, place, told) in [
            (
                ONE,
                "[[0, 1], [0.5, 0.7], [2e0, 0.6]]",
                "0.5",
                (5, 21),
                "= 0.5: give a list of pairs",
            ),
            (ONE, "[0.5, 0.7]", "[0.5]", (5, 30), "restitution_table[1] = [0.5]: give a pair"),
            (ONE, "[0.5, 0.7]", "[0.5, \"no\"]", (5, 30), "restitution_table[1] = "),
            (ONE, "[0.5, 0.7]", "[0.5, 7]", (5, 30), "[1].restitution = 7: give a number from 0"),
            (ONE, "[2e0", "[0.5", (5, 42), "[2].speed = 0.5: give a speed above 0.5"),
            (ONE, "[[0, 1], [0.5, 0.7], [2e0, 0.6]]", "[]", (5, 21), "give 1 to 16 points"),
            (ONE, "mass_ratio", "restitution = 0.5\nmass_ratio", (4, 1), "give one of them"),
            (ONE, "mass_ratio", "yield_speed = 0.5\nmass_ratio", (4, 1), "give one of them"),
            (ONE, "mass_ratio", "reference_speed = 1\nmass_ratio", (4, 1), "give one of them"),
            (
                ONE,
                "restitution_table",
                "restitution_tabel",
                (5, 1),
                "did you mean `restitution_table`",
            ),
            (
                SEVERAL,
                "0.9]",
                "1.9]",
                (11, 22),
                "absorber.1.restitution_table[0].restitution = 1.9",
            ),
            (
                SEVERAL,
                "clearance = 0.4",
                "clearance = 0.4\nreference_speed = 1",
                (11, 1),
                "absorber.1.restitution_table is",
            ),
        ] {
            let text = text.replacen(from, to, 1);
            let read = parse_study(Path::new("it.toml"), &text);
            let Err(Error::Study(error)) = read.and_then(|file| resolve(&file)) else {
                panic!("{to} is taken")
            };
            let shown = error.to_string();
            assert!(shown.contains(told), "{told}: {shown}");
            let found = error.place.as_ref().map(|place| (place.line, place.column));
            assert_eq!(found, Some(place), "{shown}");
        }
    }
}
