//! Reading and writing of the section `[structure]`.

use std::fmt::Write;
use std::sync::Arc;

use iva_sweep::design::Spec;
use iva_sweep::structure::{ENTRIES, Entry, MODES, SECTION, Structure};
use toml::de::DeValue;

use crate::error::Error;
use crate::source::Source;
use crate::value::{Key, Value, as_number, entries, table, unknown_key};

/// Reads the structure with several modes into a spec.
///
/// # Errors
/// At the entry that is unknown, of another form, or does not fit the others.
pub(crate) fn read(
    source: &mut Source,
    key: &Key<'_>,
    value: &Value<'_>,
    spec: Spec,
) -> Result<Spec, Error> {
    let section = table(source, SECTION, key, value)?;
    source.note(SECTION.to_owned(), key.span());
    let mut all = Vec::new();
    for (key, value) in entries(section) {
        let name = key.get_ref().as_ref();
        if !ENTRIES.contains(&name) {
            return Err(unknown_key(source, SECTION, key, &ENTRIES));
        }
        let path = format!("{SECTION}.{name}");
        source.note(path.clone(), key.span().start..value.span().end);
        let entry = if MODES.contains(&name) {
            mode(source, &path, value)?
        } else {
            entry(source, &path, value)?
        };
        all.push((name.to_owned(), entry));
    }
    let structure = Structure::new(all).map_err(|invalid| source.locate(&invalid))?;
    Ok(spec.with_structure(Arc::new(structure)))
}

/// The number of a mode.
fn mode(source: &Source, path: &str, value: &Value<'_>) -> Result<Entry, Error> {
    let number = as_number(value.get_ref()).filter(|it| it.fract() == 0.0 && *it >= 0.0);
    let wrong = || source.bad_value(path, value.span(), "give the number of a mode, from 1");
    number.map(|it| Entry::Mode(it as usize)).ok_or_else(wrong)
}

/// The value of an entry.
fn entry(source: &Source, path: &str, value: &Value<'_>) -> Result<Entry, Error> {
    match value.get_ref() {
        DeValue::String(name) => Ok(Entry::Name(name.to_string())),
        DeValue::Array(items)
            if items.iter().all(|it| it.get_ref().is_str()) && !items.is_empty() =>
        {
            let name = |it: &Value<'_>| it.get_ref().as_str().map(str::to_owned);
            Ok(Entry::Names(items.iter().filter_map(name).collect()))
        }
        DeValue::Array(items) if items.iter().any(|it| it.get_ref().is_array()) => {
            let rows = items.iter().map(|row| numbers(source, path, row));
            Ok(Entry::Rows(rows.collect::<Result<_, _>>()?))
        }
        DeValue::Table(named) => {
            let of = |(key, value): (&Key<'_>, &Value<'_>)| {
                let name = key.get_ref().to_string();
                let numbers = numbers(source, &format!("{path}.{name}"), value)?;
                Ok((name, numbers))
            };
            Ok(Entry::Named(entries(named).into_iter().map(of).collect::<Result<_, Error>>()?))
        }
        _ => Ok(Entry::Numbers(numbers(source, path, value)?)),
    }
}

/// A list of numbers.
fn numbers(source: &Source, path: &str, value: &Value<'_>) -> Result<Vec<f64>, Error> {
    let wrong = |at: &Value<'_>| source.bad_value(path, at.span(), "give a list of numbers");
    let DeValue::Array(items) = value.get_ref() else { return Err(wrong(value)) };
    let of = |item: &Value<'_>| as_number(item.get_ref()).ok_or_else(|| wrong(item));
    items.iter().map(of).collect()
}

/// Writes the section.
pub(crate) fn write(text: &mut String, structure: &Structure) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\n[{SECTION}]");
    for (name, entry) in structure.entries() {
        let quoted = |text: &String| toml::Value::from(text.as_str()).to_string();
        let numbers = |all: &Vec<f64>| {
            let all: Vec<String> = all.iter().map(|value| format!("{value:?}")).collect();
            format!("[{}]", all.join(", "))
        };
        let shown = match entry {
            Entry::Mode(mode) => mode.to_string(),
            Entry::Name(one) => quoted(one),
            Entry::Names(all) => {
                format!("[{}]", all.iter().map(quoted).collect::<Vec<_>>().join(", "))
            }
            Entry::Numbers(all) => numbers(all),
            Entry::Rows(rows) => {
                format!("[{}]", rows.iter().map(numbers).collect::<Vec<_>>().join(", "))
            }
            Entry::Named(all) => {
                let one = |(name, all): &(String, Vec<f64>)| {
                    format!("{} = {}", quoted(name), numbers(all))
                };
                format!("{{ {} }}", all.iter().map(one).collect::<Vec<_>>().join(", "))
            }
        };
        let _ = writeln!(text, "{name} = {shown}");
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::error::Error;
    use crate::resolved::{resolve, write};
    use crate::study_file::parse_study;

    const FRAME: &str = r#"version = 1
[structure]
points = ["first", "a \"quoted\" top"]
mass = [[2000, 0], [0, 1e3]]
stiffness = [[300e3, -100e3], [-100e3, 100e3]]
absorber_at = "first"
base = [1, 1]
[absorber]
kind = "siva"
mass = 60
restitution = 0.5
clearance = 0.01
[start]
displacement = 0.05
[run]
periods = 3
"#;

    const FRAME_BY_MODES: &str = r#"version = 1
[structure]
frequencies_hz = [1, 2.5]
damping_ratios = [0.01]
absorber_at = ["top", "top"]
seen_mode = 2
natural_mode = 2
start_velocities = [0, 0.1]
[structure.points]
top = [0.03, -0.02]
"1st floor" = [0.01, 0.02]
[[absorber]]
kind = "siva"
mass = 60
restitution = 0.5
clearance = 0.01
[[absorber]]
kind = "siva"
mass = 30
restitution = 0.5
clearance = 0.02
[run]
periods = 3
"#;

    #[test]
    fn what_is_written_reads_back_the_same() {
        for text in [FRAME, FRAME_BY_MODES] {
            let file = resolve(&parse_study(Path::new("it.toml"), text).unwrap()).unwrap();
            let again = parse_study(Path::new("again.toml"), &write(&file).unwrap()).unwrap();
            assert_eq!(again.study, file.study);
            assert!(again.study.design(0).is_ok());
        }
    }

    #[test]
    #[allow(clippy::panic)]
    fn faults_are_told_at_their_lines() {
        for (text, from, to, line, told) in [
            (FRAME, "stiffness = [[300e3", "stifness = [[300e3", 5, "did you mean `stiffness`?"),
            (FRAME, "[300e3, -100e3]", "[300e3, 1]", 5, "give a symmetric matrix"),
            (FRAME, "[300e3, -100e3]", "[300e3, \"no\"]", 5, "give a list of numbers"),
            (FRAME, "\"first\"\nbase", "\"roof\"\nbase", 6, "give one of the points first"),
            (FRAME, "mass = 60", "mass_ratio = 0.1", 10, "give mass (kg)"),
            (
                FRAME,
                "[absorber]",
                "[primary]\nmass = 1\n[absorber]",
                9,
                "the structure has it already",
            ),
            (FRAME_BY_MODES, "[1, 2.5]", "[1, 2.5, 3]", 9, "give 3, one for each mode"),
            (
                FRAME_BY_MODES,
                "[\"top\", \"top\"]",
                "[\"top\", \"top\", \"top\"]",
                5,
                "one for each absorber",
            ),
            (
                FRAME_BY_MODES,
                "seen_mode = 2",
                "seen_mode = 3",
                6,
                "3: give the number of a mode, from 1 to 2",
            ),
            (
                FRAME_BY_MODES,
                "seen_mode = 2",
                "seen_mode = 0.5",
                6,
                "0.5: give the number of a mode",
            ),
            (
                FRAME_BY_MODES,
                "seen_mode = 2",
                "seen_mode = \"top\"",
                6,
                "give the number of a mode",
            ),
            (FRAME_BY_MODES, "[0.03, -0.02]", "[0.03]", 9, "give 2, one for each mode"),
        ] {
            let text = text.replacen(from, to, 1);
            let read = parse_study(Path::new("it.toml"), &text);
            let read = read.and_then(|file| resolve(&file));
            let Err(Error::Study(error)) = read else { panic!("{to} is taken") };
            let shown = error.to_string();
            assert!(shown.contains(told), "{told}: {shown}");
            assert_eq!(error.place.as_ref().map(|place| place.line), Some(line), "{shown}");
        }
    }
}
