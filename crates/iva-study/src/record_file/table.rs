//! A text in columns: the lines of numbers, and the names and units above them.
//!
//! What a recorder writes above the names is skipped. The names stand in the last line before the numbers that has as many
//! cells as there are columns, or in the one above it where that one has nothing but units. Of several such lines it is the
//! last that states a known unit or the time. No line is looked for behind one of another number of cells, unless that is a
//! comment.

use super::Fault;
use super::columns::{cells, filled};
use super::head::{bare, is_clock, names, parted, plain, unit};
use super::number;

/// The lines of numbers, and what stands above them.
pub(super) struct Table<'t> {
    /// The lines of numbers.
    pub rows: Vec<&'t str>,
    /// Number of columns.
    pub count: usize,
    /// The line that units are taken from; that of the first numbers if there is none.
    pub head: &'t str,
    /// The names of the columns as the file has them, and the texts of their units; empty where it has none.
    pub heads: Vec<(String, String)>,
}

impl<'t> Table<'t> {
    /// The table of a text, by its last line: a line of numbers has as many cells, and numbers where that one has.
    pub fn new(text: &'t str) -> Result<Self, Fault> {
        let lines: Vec<&str> = filled(text).collect();
        let last: Vec<bool> = cells(lines.last().unwrap_or(&"")).map(is_number).collect();
        let is_data = |line: &str| {
            last.contains(&true)
                && cells(line).count() == last.len()
                && cells(line).zip(&last).all(|(cell, numeric)| !numeric || is_number(cell))
        };
        let begin = lines.windows(2).position(|two| two.iter().all(|line| is_data(line)));
        let Some(begin) = begin else {
            return Err(Fault::missing("no two lines of numbers in a row; give times and values"));
        };
        let (first, count) = (lines[begin], last.len());
        let above = text.lines().map(str::trim).take_while(|line| !std::ptr::eq(*line, first));
        let (head, heads) = heads(&above.collect::<Vec<_>>(), count)
            .unwrap_or_else(|| (first, vec![(String::new(), String::new()); count]));
        Ok(Self { rows: lines[begin..].to_vec(), count, head, heads })
    }
}

fn is_number(cell: &str) -> bool {
    number(cell).is_some()
}

/// Names and units of so many columns, with the line of the units, by the lines above the numbers.
fn heads<'t>(above: &[&'t str], count: usize) -> Option<(&'t str, Vec<(String, String)>)> {
    let mut fitting = Vec::new();
    for line in above.iter().rev().filter(|line| !line.is_empty()) {
        match divided(line.trim_start_matches('#').trim(), count) {
            Some(cells) => fitting.push((*line, cells)),
            None if line.starts_with('#') => {}
            None => break,
        }
    }
    let telling = fitting.iter().position(|(_, cells)| cells.iter().any(|cell| is_telling(cell)));
    let place = telling.unwrap_or(0);
    let (line, cells) = fitting.get(place)?;
    if !is_of_units(cells) {
        let parted = |cell: &String| (plain(cell), parted(cell).1);
        return Some((line, cells.iter().map(parted).collect()));
    }
    let named = fitting.get(place + 1);
    let name = |k: usize| named.map_or(String::new(), |(_, names)| plain(&names[k]));
    let stated = |cell: &String| bare(&plain(cell)).trim_matches('-').to_owned();
    Some((line, cells.iter().enumerate().map(|(k, cell)| (name(k), stated(cell))).collect()))
}

/// The cells of a line above the numbers; `None` if it has not as many as there are columns. Between tabs, or two blanks,
/// names may hold single blanks.
fn divided(line: &str, count: usize) -> Option<Vec<String>> {
    let owned = |parts: Vec<&str>| parts.into_iter().map(str::to_owned).collect::<Vec<_>>();
    if count == 1 {
        return (!line.is_empty()).then(|| vec![line.to_owned()]);
    }
    let spaced =
        |mark: &str| owned(line.split(mark).filter(|part| !part.trim().is_empty()).collect());
    [names(line), spaced("\t"), spaced("  ")].into_iter().find(|cells| cells.len() == count)
}

/// True if a cell is a known unit, states one, or is a name of the time.
fn is_telling(cell: &str) -> bool {
    let (_, stated) = parted(cell);
    let alone = plain(cell);
    unit(if stated.is_empty() { bare(&alone) } else { &stated }).is_some() || is_clock(cell)
}

/// True if cells are units and nothing else, one of them known at least.
fn is_of_units(cells: &[String]) -> bool {
    let known = |cell: &String| unit(bare(&plain(cell))).is_some();
    // Of one in brackets it is clear that it is a unit, whichever.
    let may_be = |cell: &String| {
        let plain = plain(cell);
        plain.is_empty() || plain == "-" || bare(&plain) != plain
    };
    cells.iter().any(known) && cells.iter().all(|cell| known(cell) || may_be(cell))
}
