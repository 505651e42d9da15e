//! Reading of PEER's format of accelerograms: four header lines, then accelerations in g, several a line.

use std::path::Path;

use iva_sweep::fields::Allowed;
use iva_sweep::units::STANDARD_GRAVITY;

use super::{Fault, RecordFile, RecordUnit, even_times, finite, number};
use crate::source::shortened;

/// Number of header lines.
const HEADER_LINES: usize = 4;

/// True if the name ends in `.at2`, or one of the first four lines that is not a comment contains NPTS.
pub(super) fn is_at2(path: &Path, text: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("at2"))
        || has_sampling(text)
}

/// True if one of the first four lines that is not a comment contains NPTS.
pub(super) fn has_sampling(text: &str) -> bool {
    text.lines()
        .take(HEADER_LINES)
        .any(|line| !line.trim_start().starts_with('#') && has_word(line, "NPTS"))
}

/// Reads the accelerations and converts them to m/s².
pub(super) fn read(text: &str) -> Result<RecordFile, Fault> {
    let mut lines = text.lines();
    let [Some(_), Some(_), Some(units), Some(sampling)] = [(); HEADER_LINES].map(|()| lines.next())
    else {
        return Err(Fault::missing(
            "ends within its header; a PEER AT2 file has four header lines and the values below",
        ));
    };
    check_units(text, units.trim())?;
    let (count, dt) = read_sampling(text, sampling.trim())?;
    let mut values = Vec::new();
    for word in lines.flat_map(str::split_whitespace) {
        for part in numbers(word) {
            // A part without a point may be the exponent of Fortran's `.5-100`, so the whole word is refused.
            let whole = if part.len() == word.len() || part.contains('.') { part } else { word };
            let value = finite(text, whole)? * STANDARD_GRAVITY;
            if !value.is_finite() {
                let message = format!("\"{}\" g is too large in m/s²", shortened(part));
                return Err(Fault::at(text, part, message));
            }
            values.push(value);
        }
    }
    if values.len() != count {
        let message =
            format!("NPTS is {count}, but {} values follow; the two must agree", values.len());
        return Err(Fault::at(text, sampling.trim(), message));
    }
    let times = even_times(dt, count);
    Ok(RecordFile { times, values, unit: RecordUnit::MetresPerSecondSquared })
}

/// True if the line contains `word`, which is in capitals, in any case.
fn has_word(line: &str, word: &str) -> bool {
    line.to_ascii_uppercase().contains(word)
}

/// Checks that the third header line states accelerations in g.
fn check_units(text: &str, line: &str) -> Result<(), Fault> {
    for other in ["VELOCITY", "DISPLACEMENT"] {
        if has_word(line, other) {
            let message = format!(
                "a record of {}; give the record of acceleration, in units of g",
                other.to_ascii_lowercase()
            );
            return Err(Fault::at(text, line, message));
        }
    }
    let upper = line.to_ascii_uppercase();
    let unit = upper.split_once("UNITS OF").map_or("", |(_, unit)| unit.trim_start());
    let unit = unit.split(|c: char| c.is_whitespace() || ".,;".contains(c)).next();
    if upper.contains("ACCELERATION") && unit == Some("G") {
        Ok(())
    } else {
        let message = format!(
            "\"{}\": the third line of a PEER AT2 file must read ACCELERATION TIME SERIES IN \
             UNITS OF G",
            shortened(line)
        );
        Err(Fault::at(text, line, message))
    }
}

/// Reads the number of values and the time step from the fourth header line:
/// `NPTS=  4000, DT=   .0050 SEC`, or in older files `4000    0.0050    NPTS, DT`.
fn read_sampling(text: &str, line: &str) -> Result<(usize, f64), Fault> {
    let separator = |c: char| c.is_whitespace() || "=,".contains(c);
    let words: Vec<&str> = line.split(separator).filter(|word| !word.is_empty()).take(6).collect();
    let is = |word: &str, name: &str| word.eq_ignore_ascii_case(name);
    let seconds = |unit: &[&str]| match unit {
        [] => true,
        [unit] => unit.get(..3).is_some_and(|unit| is(unit, "SEC")),
        _ => false,
    };
    let (count, step) = match words[..] {
        [npts, count, dt, step, ref unit @ ..]
            if is(npts, "NPTS") && is(dt, "DT") && seconds(unit) =>
        {
            (count, step)
        }
        [count, step, npts, dt] if is(npts, "NPTS") && is(dt, "DT") => (count, step),
        _ => {
            let message = format!(
                "\"{}\": the fourth line of a PEER AT2 file must read NPTS= 4000, DT= .0050 SEC, \
                 or in the old form 4000 .0050 NPTS, DT",
                shortened(line)
            );
            return Err(Fault::at(text, line, message));
        }
    };
    let Ok(npts) = count.parse() else {
        let message = format!("NPTS = {}: give a whole number, at least 2", shortened(count));
        return Err(Fault::at(text, count, message));
    };
    match number(step) {
        Some(dt) if Allowed::Positive.contains(dt) => Ok((npts, dt)),
        _ => {
            let message = format!("DT = {}: give {}", shortened(step), Allowed::Positive.words());
            Err(Fault::at(text, step, message))
        }
    }
}

/// The numbers in a word. In Fortran's columns of fixed width a sign may directly follow the digits of the
/// previous number, and begins a new one unless it follows E or D.
fn numbers(word: &str) -> impl Iterator<Item = &str> {
    let mut rest = word;
    std::iter::from_fn(move || {
        let sign = |pair: &[u8]| b"+-".contains(&pair[1]) && !b"EeDd".contains(&pair[0]);
        let end = rest.as_bytes().windows(2).position(sign).map_or(rest.len(), |at| at + 1);
        let (part, after) = rest.split_at(end);
        rest = after;
        (!part.is_empty()).then_some(part)
    })
}
