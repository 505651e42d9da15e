//! One series of numbers written several a line, such as 8F10.5, which looks like a table: in each of its columns every
//! eighth number would stand. The Python package reads such a series; here it is known and refused.

use super::recognised::IN_PYTHON;
use super::table::heads;
use super::{Fault, number};

/// With fewer numbers a line, a text without names is taken for a table; with fewer than the second number it is not
/// looked through for pairs.
const FEWEST_A_LINE: usize = 5;
const FEWEST_OF_PAIRS: usize = 4;

/// A format stands within so many lines.
const HEADER_LINES: usize = 60;

/// What lines that hold no numbers begin with.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

/// Refuses a text that is such a series, or may be one.
pub(super) fn refuse(text: &str) -> Result<(), Fault> {
    if let Some(a_line) = stated(text) {
        return Err(refused(a_line));
    }
    unstated(text).map_or(Ok(()), Err)
}

fn refused(a_line: usize) -> Fault {
    let words = format!("a series with {a_line} numbers a line");
    Fault::missing(format!("{words}, which a study reads only below dt = …; {IN_PYTHON}"))
}

/// How many numbers a line has, if a line above them states it by a format of Fortran, and one has as many.
fn stated(text: &str) -> Option<usize> {
    let mut lines = text.lines();
    let formats = lines.by_ref().take(HEADER_LINES).find_map(format_in)?;
    let (fields, width) = formats;
    lines.any(|line| is_full(line, fields, width)).then_some(fields)
}

/// Number and width of the fields of the first format with several fields in a line: `(8F10.5)`, `(1P6E12.4)`.
fn format_in(line: &str) -> Option<(usize, usize)> {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    line.char_indices().find_map(|(at, letter)| {
        let (before, behind) = (&line[..at], line.get(at + 1..)?);
        let repeated = before.len() - before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let head = &before[..before.len() - repeated];
        let scaled = head
            .strip_suffix(['P', 'p'])
            .is_some_and(|head| head.ends_with(|c: char| c.is_ascii_digit()));
        let is_apart = !head.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.');
        let width = digits(behind);
        let is_real = "FEGDfegd".contains(letter)
            && behind[width..].strip_prefix('.').is_some_and(|text| digits(text) > 0);
        let known = (is_apart || scaled) && (is_real || "Ii".contains(letter));
        let fields: usize = before[before.len() - repeated..].parse().ok()?;
        let width: usize = behind[..width].parse().ok()?;
        (known && (2..1000).contains(&fields) && (1..100).contains(&width))
            .then_some((fields, width))
    })
}

/// True if a line is made of as many numbers as its format says.
fn is_full(line: &str, fields: usize, width: usize) -> bool {
    let line = line.trim_end();
    let field = |index: usize| line.get(index * width..line.len().min((index + 1) * width));
    line.len().div_ceil(width) == fields
        && (0..fields).all(|index| field(index).is_some_and(|text| is_number(text.trim())))
}

/// Why a text whose head states no format is, or may be, a series or pairs; `None` for any other one.
fn unstated(text: &str) -> Option<Fault> {
    let is_filled = |line: &&str| {
        let line = line.trim_start();
        !line.is_empty() && !COMMENTS.iter().any(|mark| line.starts_with(mark))
    };
    let mut from_end = text.lines().rev().filter(is_filled);
    let last = from_end.next()?;
    let a_line = from_end.next()?.split_whitespace().count();
    if a_line < FEWEST_OF_PAIRS || from_end.next().is_none() {
        return None;
    }
    let rows: Vec<&str> = text.lines().filter(is_filled).collect();
    let begin = rows.iter().position(|row| is_row(row, a_line))?;
    let block = &rows[begin..];
    let first = block[0];
    let above: Vec<&str> =
        text.lines().take_while(|line| !std::ptr::eq(*line, first)).map(str::trim).collect();
    // Words of a title, with a year among them, are no names.
    if let Some((_, names)) = heads(&above, a_line)
        && names.iter().any(|(name, _)| !name.is_empty())
        && !names.iter().any(|(name, _)| is_number(name.trim_matches([',', ';'])))
    {
        return None;
    }
    let in_last = last.split_whitespace().count();
    let (full, _) = block.split_at(block.len() - 1);
    if !full.iter().all(|row| is_row(row, a_line)) || in_last > a_line || !is_row(last, in_last) {
        return None;
    }
    let numbers: Vec<f64> =
        block.iter().flat_map(|row| row.split_whitespace()).filter_map(number).collect();
    if a_line % 2 == 0 && increases(numbers.iter().step_by(2)) {
        let pairs = a_line / 2;
        return Some(Fault::missing(format!(
            "its lines seem to hold {pairs} pairs of a time and a value; write one pair a line"
        )));
    }
    if a_line < FEWEST_A_LINE || increases(numbers.iter().step_by(a_line)) {
        return None;
    }
    if in_last < a_line {
        return Some(refused(a_line));
    }
    Some(Fault::missing(format!(
        "its lines of {a_line} numbers may be one series or {a_line} columns; write names above columns, or dt = … above \
         a series"
    )))
}

/// True if a line is made of so many numbers.
fn is_row(line: &str, count: usize) -> bool {
    line.split_whitespace().count() == count && line.split_whitespace().all(is_number)
}

fn is_number(word: &str) -> bool {
    number(word).is_some_and(f64::is_finite)
}

/// True if numbers are those of a clock: three or more, each larger than the last.
fn increases<'n>(numbers: impl Iterator<Item = &'n f64>) -> bool {
    let numbers: Vec<f64> = numbers.copied().collect();
    numbers.len() > 2 && numbers.windows(2).all(|pair| pair[0] < pair[1])
}

#[cfg(test)]
mod tests;
