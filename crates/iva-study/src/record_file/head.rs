//! Units that the head of a record in columns names, spelt as the Python package takes them of sensors.
//!
//! Either stands behind the name of its column: `time (ms),acceleration (g)`, `t [s];a / (mm/s²)`,
//! `time_s force_kN`. The inch has 25.4 mm, the pound 0.45359237 kg (agreement of 1959).

use iva_sweep::units::STANDARD_GRAVITY;

use super::columns::{after_dt, cells};
use super::{Fault, RecordFile, RecordUnit, number};
use crate::source::shortened;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measures {
    Time,
    Acceleration,
    Force,
    /// A velocity or a displacement.
    Motion,
}

/// A unit with its factor to s, m/s² or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub measures: Measures,
    pub factor: f64,
}

/// Metres in a unit of length; none is the begin of one behind it.
const LENGTHS: [(&str, f64); 10] = [
    ("inch", 0.0254),
    ("mil", 0.0254e-3),
    ("dm", 1e-1),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("m", 1.0),
];

/// Accelerations that are not spelt as a length over seconds.
const ACCELERATIONS: [(&str, f64); 8] = [
    ("g", STANDARD_GRAVITY),
    ("gn", STANDARD_GRAVITY),
    ("g_n", STANDARD_GRAVITY),
    ("mg", STANDARD_GRAVITY * 1e-3),
    ("ug", STANDARD_GRAVITY * 1e-6),
    ("Gal", 1e-2),
    ("gal", 1e-2),
    ("N/kg", 1.0),
];

/// Newtons in a unit of force.
const FORCES: [(&str, f64); 5] =
    [("N", 1.0), ("mN", 1e-3), ("kN", 1e3), ("MN", 1e6), ("lbf", 0.453_592_37 * STANDARD_GRAVITY)];

/// Seconds in a unit of time.
const TIMES: [(&str, f64); 10] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("Sekunde", 1.0),
    ("Sekunden", 1.0),
    ("ms", 1e-3),
    ("msec", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
];

/// Words at the end of a name that mean something else more often.
const NO_SUFFIX: [&str; 3] = ["in", "mil", "g_n"];

/// Names of the time.
const CLOCKS: [&str; 7] = ["t", "time", "zeit", "temps", "tempo", "tiempo", "x_value"];

/// Parts of the names of forces, behind which N is no point of the compass.
const OF_FORCES: [&str; 3] = ["force", "kraft", "load"];

/// The line that names the columns, and these names.
pub(super) struct Head<'t> {
    pub line: &'t str,
    pub names: Vec<String>,
}

/// Converts a record from the units that the head of its text names; one of AT2 is left as it is.
pub(super) fn in_si(text: &str, record: RecordFile) -> Result<RecordFile, Fault> {
    if record.unit != RecordUnit::Unstated {
        return Ok(record);
    }
    let Some(Head { line, names }) = head(text, 2) else { return Ok(record) };
    // Above `dt = …` only the values have a name.
    let units: Vec<String> = names.iter().map(|name| stated(name)).collect();
    let (time, value) = match &units[..] {
        [time, value] => (time.clone(), value.clone()),
        _ => (String::new(), units.concat()),
    };
    let refused = |stated: &str, rule: &str| {
        Err(Fault::at(text, line, format!("unit \"{}\": {rule}", shortened(stated))))
    };
    let seconds = match (time.as_str(), unit(&time)) {
        ("" | "1" | "-", _) => 1.0,
        (_, Some(Unit { measures: Measures::Time, factor })) => factor,
        _ => return refused(&time, "give times in s, ms or us"),
    };
    let (factor, of_values) = match (value.as_str(), unit(&value)) {
        ("", _) => (1.0, RecordUnit::Unstated),
        ("1" | "-", _) => (1.0, RecordUnit::OfStudy),
        (_, Some(Unit { measures: Measures::Acceleration, factor })) => {
            (factor, RecordUnit::MetresPerSecondSquared)
        }
        (_, Some(Unit { measures: Measures::Force, factor })) => (factor, RecordUnit::Newtons),
        _ => {
            let rule =
                "give values in m/s^2, mm/s^2, g, N or kN, or in 1 for the unit of the study";
            return refused(&value, rule);
        }
    };
    let times = record.times.iter().map(|time| time * seconds).collect();
    let values = record.values.iter().map(|value| value * factor).collect();
    Ok(RecordFile { times, values, unit: of_values })
}

/// The head of a record of so many columns: the last line above its numbers that names a unit or the time, or else its
/// header. Above `dt = …` it is a comment that names the unit of the values.
pub(super) fn head(text: &str, count: usize) -> Option<Head<'_>> {
    let mut found = None;
    let mut of_values = None;
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let is_comment = line.starts_with('#');
        if !is_comment && after_dt(line).is_some() {
            return of_values;
        }
        let bare = line.trim_start_matches('#').trim();
        let names = if count == 1 { vec![bare.to_owned()] } else { names(bare) };
        if !is_comment && names.first().is_some_and(|name| number(name).is_some()) {
            break;
        }
        if is_comment && unit(&stated(bare)).is_some() {
            of_values = Some(Head { line, names: vec![bare.to_owned()] });
        }
        if names.len() != count {
            continue;
        }
        let is_telling = names.iter().any(|name| is_telling(name));
        if is_telling || (!is_comment && found.is_none()) {
            found = Some(Head { line, names });
        }
    }
    found
}

/// The names in a line, with the brackets behind them where blanks divide them.
pub(super) fn names(line: &str) -> Vec<String> {
    let by_blanks = !line.contains([';', ',']);
    let mut names: Vec<String> = Vec::new();
    for cell in cells(line) {
        match names.last_mut() {
            Some(name) if by_blanks && cell.starts_with(['[', '(', '{']) => {
                name.push(' ');
                name.push_str(cell);
            }
            _ => names.push(cell.to_owned()),
        }
    }
    names
}

/// True if a name has a known unit, or is one of the time.
fn is_telling(name: &str) -> bool {
    let bare = name.trim_matches(['"', '\'']).to_lowercase();
    unit(&stated(name)).is_some() || CLOCKS.contains(&bare.as_str())
}

/// The text of the unit behind a name, empty if there is none.
fn stated(name: &str) -> String {
    parted(name).1
}

/// A name as it stands, without the quotes around it and with single blanks.
pub(super) fn plain(name: &str) -> String {
    let name = name.trim().trim_matches(['"', '\'']);
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A name and the text of the unit behind it, empty if there is none. Brackets state a unit whether it is known or not,
/// all else only if it is known.
pub(super) fn parted(name: &str) -> (String, String) {
    let name = plain(name);
    for mark in [" / ", " in "] {
        if let Some((of, text)) = name.split_once(mark)
            && unit(bare(text)).is_some()
        {
            return (of.to_owned(), bare(text).to_owned());
        }
    }
    let inside = |open: char, close: char| name.strip_suffix(close)?.split_once(open);
    if let Some((of, text)) =
        inside('[', ']').or_else(|| inside('(', ')')).or_else(|| inside('{', '}'))
    {
        return (of.trim_end_matches([' ', '_']).to_owned(), text.trim().to_owned());
    }
    let longest_first = name.rmatch_indices('_').map(|(at, _)| at).take(3).collect::<Vec<_>>();
    for at in longest_first.into_iter().rev() {
        let (of, text) = (&name[..at], &name[at + 1..]);
        if !of.is_empty() && !of.ends_with('_') && is_suffix(of, text) {
            return (of.to_owned(), text.to_owned());
        }
    }
    (name, String::new())
}

/// True if a column with this header holds instants.
pub(super) fn is_clock(header: &str) -> bool {
    let (name, stated) = parted(header);
    is_clock_in(&name, &stated)
}

/// True if a column holds instants, by its unit or, without one, by its name.
pub(super) fn is_clock_in(name: &str, stated: &str) -> bool {
    let bare = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    match unit(stated) {
        Some(unit) => unit.measures == Measures::Time,
        None => stated.is_empty() && CLOCKS.contains(&bare.as_str()),
    }
}

/// True if `text` is a unit at the end of a name, behind `of`.
fn is_suffix(of: &str, text: &str) -> bool {
    match unit(text) {
        Some(Unit { measures: Measures::Force, .. }) => is_of_force(of),
        Some(_) => !NO_SUFFIX.contains(&text),
        None => false,
    }
}

/// True if a name is that of a force.
pub(super) fn is_of_force(name: &str) -> bool {
    let name = name.to_lowercase();
    OF_FORCES.iter().any(|word| name.contains(word))
}

/// A text without the brackets around it.
pub(super) fn bare(text: &str) -> &str {
    let text = text.trim();
    [('[', ']'), ('(', ')'), ('{', '}')]
        .into_iter()
        .find_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close))
        .map_or(text, str::trim)
}

/// The unit that a text spells, if it is known.
pub(super) fn unit(text: &str) -> Option<Unit> {
    let mut plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for (from, to) in [("²", "2"), ("−", "-"), ("µ", "u"), ("μ", "u"), ("**", "^"), ("·", "*")]
    {
        plain = plain.replace(from, to);
    }
    let of = |table: &[(&str, f64)], measures, text: &str| {
        let (_, factor) = table.iter().find(|(name, _)| *name == text)?;
        Some(Unit { measures, factor: *factor })
    };
    if let Some(force) = of(&FORCES, Measures::Force, &plain) {
        return Some(force);
    }
    // Old files have large letters only.
    if plain.chars().any(char::is_uppercase) && !plain.chars().any(char::is_lowercase) {
        plain = plain.to_lowercase();
    }
    for mark in ["/", "*", "^", "-"] {
        plain = plain.replace(&format!(" {mark}"), mark).replace(&format!("{mark} "), mark);
    }
    let plain = plain.replace(' ', "*");
    of(&ACCELERATIONS, Measures::Acceleration, &plain)
        .or_else(|| of(&TIMES, Measures::Time, &plain))
        .or_else(|| length_over_seconds(&plain))
}

/// The unit that is a length, alone or over seconds or their square.
fn length_over_seconds(plain: &str) -> Option<Unit> {
    LENGTHS.iter().find_map(|&(name, metres)| {
        let over = plain.strip_prefix(name)?;
        let measures = match power(over)? {
            2 => Measures::Acceleration,
            _ => Measures::Motion,
        };
        Some(Unit { measures, factor: metres })
    })
}

/// The power of the seconds that a length is over: `/s`, `_s`, `_per_s`, `*s^-1` with nothing, 2, ^2 or /s.
fn power(over: &str) -> Option<u8> {
    if over.is_empty() {
        return Some(0);
    }
    let seconds = |text: &'_ str| -> Option<String> {
        let behind = text.strip_prefix("sec").or_else(|| text.strip_prefix('s'))?;
        Some(behind.to_owned())
    };
    let divided = ["/", "_per_", "_"].into_iter().find_map(|mark| over.strip_prefix(mark));
    let divided = divided.map(|text| text.strip_prefix('(').unwrap_or(text));
    let divided = divided.map(|text| text.strip_suffix(')').unwrap_or(text));
    match divided.and_then(seconds).as_deref() {
        Some("") => return Some(1),
        Some("2" | "^2" | "/s" | "/sec" | "_2") => return Some(2),
        _ => {}
    }
    let times = over.strip_prefix(['*', '_', '.']).unwrap_or(over);
    match seconds(times)?.trim_start_matches('^') {
        "-1" => Some(1),
        "-2" => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
