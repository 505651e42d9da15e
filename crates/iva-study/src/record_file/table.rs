//! A text in columns: the lines of numbers, and the names and units above them.
//!
//! What a recorder writes above the names is skipped. The names stand in the last line before the numbers that has as many
//! cells as there are columns, or in the one above it where that one has nothing but units. Of several such lines it is the
//! last that states a known unit or the time. No line is looked for behind one of another number of cells, unless that is a
//! comment.

use super::Fault;
use super::columns::{cells, filled};
use super::head::{bare, is_clock, is_of_force, names, parted, plain, unit};
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
    /// True if the units stand in a line of their own below the names.
    pub has_units_below: bool,
}

/// What the columns of something else than forces and motions are in.
const OTHERS: [&str; 30] = [
    "°C", "degC", "K", "°F", "V", "mV", "uV", "µV", "A", "mA", "%", "Pa", "kPa", "MPa", "bar",
    "mbar", "Nm", "N m", "N*m", "rad", "deg", "°", "Hz", "kHz", "rpm", "1/min", "um/m", "µm/m",
    "W", "kg",
];

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
        let above: Vec<&str> = above.collect();
        let (head, heads) = heads(&above, count)
            .unwrap_or_else(|| (first, vec![(String::new(), String::new()); count]));
        let has_units_below = below(&above, count).is_some();
        Ok(Self { rows: lines[begin..].to_vec(), count, head, heads, has_units_below })
    }
}

fn is_number(cell: &str) -> bool {
    number(cell).is_some()
}

/// A line above the numbers, and its cells.
type Cells<'t> = (&'t str, Vec<String>);

/// The lines above the numbers that have so many cells, the last one first, from the one that tells most.
fn fitting<'t>(above: &[&'t str], count: usize) -> Vec<Cells<'t>> {
    let mut fitting = Vec::new();
    for line in above.iter().rev().filter(|line| !line.is_empty()) {
        match divided(line.trim_start_matches('#').trim(), count) {
            Some(cells) => fitting.push((*line, cells)),
            None if line.starts_with('#') => {}
            None => break,
        }
    }
    let telling = fitting.iter().position(|(_, cells)| cells.iter().any(|cell| is_telling(cell)));
    fitting.split_off(telling.unwrap_or(0))
}

/// The line of units alone, and the names above it, which may be none.
fn below<'t>(above: &[&'t str], count: usize) -> Option<(Cells<'t>, Vec<String>)> {
    let mut lines = fitting(above, count).into_iter();
    let units = lines.next()?;
    let names = lines.next().map_or(vec![String::new(); count], |(_, names)| names);
    is_of_units(&units.1, &names).then_some((units, names))
}

/// Names and units of so many columns, with the line of the units, by the lines above the numbers.
pub(super) fn heads<'t>(
    above: &[&'t str],
    count: usize,
) -> Option<(&'t str, Vec<(String, String)>)> {
    if let Some(((line, units), names)) = below(above, count) {
        let stated = |cell: &String| bare(&plain(cell)).trim_matches('-').to_owned();
        let names = names.iter().map(|name| plain(name));
        return Some((line, names.zip(units.iter().map(stated)).collect()));
    }
    let (line, cells) = fitting(above, count).into_iter().next()?;
    Some((line, cells.iter().map(|cell| (plain(cell), parted(cell).1)).collect()))
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

/// True if cells below names are units and nothing else, one of them known at least. N may be north as well, unless the
/// name above is that of a force, or another unit is known.
fn is_of_units(cells: &[String], names: &[String]) -> bool {
    let is_known = |cell: &String| unit(bare(&plain(cell))).is_some();
    let is_sure = |(cell, name): (&String, &String)| {
        is_known(cell) && (plain(cell) != "N" || is_of_force(name))
    };
    // Of one in brackets it is clear that it is a unit, whichever.
    let may_be = |cell: &String| {
        let plain = plain(cell);
        plain.is_empty() || plain == "-" || bare(&plain) != plain || OTHERS.contains(&&*plain)
    };
    cells.iter().zip(names).any(is_sure) && cells.iter().all(|cell| is_known(cell) || may_be(cell))
}

#[cfg(test)]
mod tests;
