//! Reading of records as lines of a time and a value, or as a time step `dt = …` and then values.

use iva_sweep::fields::Allowed;

use super::{Fault, RecordFile, RecordUnit, even_times, finite, number};
use crate::source::shortened;

/// Reads a record in columns or with a time step. Blank lines and lines that begin with `#` are skipped.
pub(super) fn read(text: &str) -> Result<RecordFile, Fault> {
    let mut lines = filled(text).peekable();
    let (times, values) = match lines.peek().and_then(|first| after_dt(first)) {
        Some(step) => {
            let dt = time_step(text, step)?;
            let values = read_values(text, lines.skip(1))?;
            (even_times(dt, values.len()), values)
        }
        None => {
            let header = lines.peek().is_some_and(|first| is_header(first));
            read_points(text, lines.skip(usize::from(header)))?
        }
    };
    Ok(RecordFile { times, values, unit: RecordUnit::Unstated })
}

/// The lines that count.
pub(super) fn filled(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// True if a text gives a time step, and then values.
pub(super) fn is_stepped(text: &str) -> bool {
    filled(text).next().is_some_and(|first| after_dt(first).is_some())
}

/// Reads a column.
pub(super) fn read_column(
    text: &str,
    rows: &[&str],
    (column, count): (usize, usize),
) -> Result<Vec<f64>, Fault> {
    let read = |line: &&str| {
        let found = cells(line).count();
        if found != count {
            let message = format!(
                "this line has {found} columns, those before it have {count}; give as many in each"
            );
            return Err(decimal_comma(text, line).unwrap_or_else(|| Fault::at(text, line, message)));
        }
        read_cell(text, line, cells(line).nth(column).unwrap_or_default())
    };
    rows.iter().map(read).collect()
}

/// Checks that the instants in a column increase.
pub(super) fn check_increase(text: &str, rows: &[&str], times: &[f64]) -> Result<(), Fault> {
    match times.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(at) => Err(not_increasing(text, rows[at + 1], times[at + 1], times[at])),
        None => Ok(()),
    }
}

fn not_increasing(text: &str, part: &str, at: f64, last: f64) -> Fault {
    let message = format!("time {at:?} follows {last:?}; times must increase strictly");
    Fault::at(text, part, message)
}

/// Reads lines of a time and a value.
fn read_points<'t>(
    text: &'t str,
    lines: impl Iterator<Item = &'t str>,
) -> Result<(Vec<f64>, Vec<f64>), Fault> {
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for line in lines {
        let mut cells = cells(line);
        let (Some(time), Some(value), None) = (cells.next(), cells.next(), cells.next()) else {
            return Err(decimal_comma(text, line).unwrap_or_else(|| wrong_count(text, line)));
        };
        let at = read_cell(text, line, time)?;
        if let Some(&last) = times.last()
            && at <= last
        {
            return Err(not_increasing(text, time, at, last));
        }
        times.push(at);
        values.push(read_cell(text, line, value)?);
    }
    Ok((times, values))
}

/// Reads lines of values only.
fn read_values<'t>(text: &'t str, lines: impl Iterator<Item = &'t str>) -> Result<Vec<f64>, Fault> {
    lines.flat_map(|line| cells(line).map(move |cell| read_cell(text, line, cell))).collect()
}

/// The error for a line with another number of columns than two.
fn wrong_count(text: &str, line: &str) -> Fault {
    let columns = match cells(line).count() {
        1 => "1 column".to_owned(),
        more => format!("{more} columns"),
    };
    let message = format!(
        "{columns}; give two, a time and a value with decimal points, or begin with dt = … and \
         give values only"
    );
    Fault::at(text, line, message)
}

/// Reads the number of a cell.
fn read_cell(text: &str, line: &str, cell: &str) -> Result<f64, Fault> {
    if cell.is_empty() {
        return Err(Fault::at(text, cell, "an empty column; give a number between separators"));
    }
    finite(text, cell).map_err(|fault| decimal_comma(text, line).unwrap_or(fault))
}

/// The cells of a line, separated by semicolons if it has any, otherwise by commas if it has any, otherwise by
/// blanks.
pub(super) fn cells(line: &str) -> impl Iterator<Item = &str> {
    let separator = [';', ','].into_iter().find(|mark| line.contains(*mark));
    line.split(move |c: char| separator.map_or(c.is_whitespace(), |mark| c == mark))
        .map(str::trim)
        .filter(move |cell| separator.is_some() || !cell.is_empty())
}

/// True if every cell of a line is a name. A number that cannot be read is not a name, so that its line is
/// refused instead of skipped.
fn is_header(line: &str) -> bool {
    let opening = |c: char| "\"'([{".contains(c);
    let begins = |cell: &str| {
        let first = cell.trim_start_matches(opening).chars().next();
        first.is_some_and(|c| c.is_alphabetic() || c == '_')
    };
    decimal_comma(line, line).is_none()
        && cells(line).all(|cell| number(cell).is_none() && begins(cell))
}

/// The error for a decimal comma, if a line that cannot be read seems to have one.
fn decimal_comma(text: &str, line: &str) -> Option<Fault> {
    line.split(|c: char| c == ';' || c.is_whitespace()).find_map(|word| {
        let (whole, decimals) = word.split_once(',')?;
        let pointed = format!("{whole}.{decimals}");
        let digits = whole.ends_with(|c: char| c.is_ascii_digit())
            && decimals.starts_with(|c: char| c.is_ascii_digit());
        let readable = number(&pointed).is_some_and(f64::is_finite);
        (digits && readable).then(|| {
            let message = format!(
                "\"{}\" seems to have a decimal comma; write a decimal point: {}",
                shortened(word),
                shortened(&pointed)
            );
            Fault::at(text, word, message)
        })
    })
}

/// The text after `dt =`, `dt,`, `dt;` or `dt`; `None` for a line that does not give the time step.
pub(super) fn after_dt(line: &str) -> Option<&str> {
    let (name, rest) = line.split_at_checked(2)?;
    let separator = |c: char| c.is_whitespace() || "=,;".contains(c);
    (name.eq_ignore_ascii_case("dt") && (rest.is_empty() || rest.starts_with(separator)))
        .then(|| rest.trim_start_matches(separator))
}

/// Reads the time step.
fn time_step(text: &str, step: &str) -> Result<f64, Fault> {
    match number(step) {
        Some(dt) if Allowed::Positive.contains(dt) => Ok(dt),
        _ => Err(decimal_comma(text, step).unwrap_or_else(|| {
            let message = format!(
                "dt = {}: give {}, and nothing else",
                shortened(step),
                Allowed::Positive.words()
            );
            Fault::at(text, step, message)
        })),
    }
}
