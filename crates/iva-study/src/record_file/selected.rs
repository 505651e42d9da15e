//! Records of which a study says what is read: one column of many, or samples without instants; as
//! `iva.Recorded.read` of the Python package takes them, with its sentences.

use std::path::Path;

use iva_sweep::fields::nearest;
use iva_sweep::forces::{Column, Selection};

use super::columns::{check_increase, read_column};
use super::head::{Head, Measures, Unit, head, is_clock_in, parted, plain, unit};
use super::table::Table;
use super::{Fault, RecordFile, RecordUnit, at2, columns, long_enough};
use crate::source::shortened;

/// So many names are listed in a message.
const FEW: usize = 12;

/// The unit of numbers that are in those of the study.
const OF_STUDY: &str = "1";

/// Units for messages, in a spelling that is common.
const COMMON: &str =
    "m/s^2, mm/s^2, g or Gal of acceleration, N or kN of force, or \"1\" for those of the study";

/// A column of a file.
struct Channel {
    /// As the file has it, empty if it has no names.
    name: String,
    /// The name without its unit.
    bare: String,
    /// The text of the unit behind the name, empty if there is none.
    stated: String,
    is_clock: bool,
}

impl Channel {
    /// A column with its unit behind the name.
    fn named(name: &str) -> Self {
        let (_, stated) = parted(name);
        Self::new(&plain(name), &stated)
    }

    fn new(name: &str, stated: &str) -> Self {
        let (bare, _) = parted(name);
        let is_clock = is_clock_in(&bare, stated);
        Self { name: name.to_owned(), bare, stated: stated.to_owned(), is_clock }
    }

    /// The unit that the file states.
    fn unit(&self) -> Option<Unit> {
        unit(&self.stated)
    }

    /// True if a text stands for a unit, known or not.
    fn states_one(&self) -> bool {
        !["", "-", OF_STUDY].contains(&self.stated.as_str())
    }
}

/// The numbers of a file.
enum Numbers<'t> {
    /// One series that has instants of its own.
    Series(RecordFile),
    /// Lines with so many columns.
    Rows(Vec<&'t str>, usize),
}

/// True if a study says what is read of a text, or has to.
pub(super) fn is_needed(path: &Path, text: &str, selection: &Selection) -> bool {
    let is_table = || !at2::is_at2(path, text) && !columns::is_stepped(text);
    let has_others =
        || Table::new(text).is_ok_and(|table| table.count != 2 || table.has_units_below);
    *selection != Selection::default() || (is_table() && has_others())
}

/// Reads what is selected of a text.
pub(super) fn read(path: &Path, text: &str, selection: &Selection) -> Result<RecordFile, Fault> {
    let (line, channels, numbers) = opened(path, text)?;
    let (column, clock) = chosen(&channels, selection)?;
    let channel = &channels[column];
    let (factor, unit) = unit_of(channel, selection).map_err(|rule| match rule {
        Refused::InFile(rule) => Fault::at(text, line, rule),
        Refused::Given(rule) => Fault::of_key("unit", rule),
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let refused = |rule: String| Err(Fault::of_key("sampling_hz", rule));
    let has_own = matches!(numbers, Numbers::Series(_)) || clock.is_some();
    let hz = match selection.sampling_hz {
        Some(hz) if has_own => {
            return refused(format!(
                "force.sampling_hz = {hz}: {name} has instants of its own; leave it out"
            ));
        }
        None if !has_own => {
            return refused(format!(
                "force.sampling_hz is missing: {name} has no column of time; give force.sampling_hz, or name the \
                 column with time"
            ));
        }
        hz => hz,
    };
    let (times, values) = match numbers {
        Numbers::Series(mut record) => {
            // Those of AT2 are in m/s² already.
            let factor = if record.unit == RecordUnit::Unstated { factor } else { 1.0 };
            record.values.iter_mut().for_each(|value| *value *= factor);
            (record.times, record.values)
        }
        Numbers::Rows(rows, count) => {
            let values = read_column(text, &rows, (column, count))?;
            let times = match clock {
                Some(clock) => {
                    let times = read_column(text, &rows, (clock, count))?;
                    check_increase(text, &rows, &times)?;
                    let seconds = channels[clock].unit().map_or(1.0, |unit| unit.factor);
                    times.iter().map(|time| time * seconds).collect()
                }
                None => (0..values.len()).map(|k| k as f64 / hz.unwrap_or(1.0)).collect(),
            };
            (times, values.iter().map(|value| value * factor).collect())
        }
    };
    long_enough(RecordFile { times, values, unit })
}

/// The line that names the columns of a text, what is known of each, and its numbers.
fn opened<'t>(path: &Path, text: &'t str) -> Result<(&'t str, Vec<Channel>, Numbers<'t>), Fault> {
    if text.trim().is_empty() {
        return Err(Fault::missing("the file is empty; give times and values"));
    }
    if at2::is_at2(path, text) {
        let channel = Channel::named("acceleration [g]");
        return Ok((text, vec![channel], Numbers::Series(at2::read(text)?)));
    }
    if columns::is_stepped(text) {
        let record = columns::read(text)?;
        let (line, name) = match head(text, 1) {
            Some(Head { line, names }) => (line, names.concat()),
            None => (text, String::new()),
        };
        return Ok((line, vec![Channel::named(&name)], Numbers::Series(record)));
    }
    let Table { rows, count, head, heads, .. } = Table::new(text)?;
    let channels = heads.iter().map(|(name, stated)| Channel::new(name, stated)).collect();
    Ok((head, channels, Numbers::Rows(rows, count)))
}

/// The column of the values and that of their instants, if there is one. Of two columns of which none is known to be
/// the time, the first one is.
fn chosen(all: &[Channel], selection: &Selection) -> Result<(usize, Option<usize>), Fault> {
    let Selection { column, time, .. } = selection;
    let column = column.as_ref().map(|column| found("column", column, all)).transpose()?;
    if all.len() == 2
        && !all.iter().any(|one| one.is_clock)
        && time.is_none()
        && column.is_none_or(|column| column == 1)
    {
        return Ok((1, Some(0)));
    }
    let column = match column {
        Some(column) if all[column].is_clock => {
            return Err(refused("column", selection, "this column holds the time, not a force"));
        }
        Some(column) => column,
        None => only(all, |one| !one.is_clock).ok_or_else(|| {
            let rule =
                format!("force.column is missing: name one column; there is {}", listed(all));
            Fault::of_key("column", rule)
        })?,
    };
    let Some(time) = time else {
        let clocks = all.iter().filter(|one| one.is_clock).count();
        if clocks > 1 {
            let clocks = all.iter().filter(|one| one.is_clock);
            let rule =
                format!("force.time is missing: name one column; there is {}", listed(clocks));
            return Err(Fault::of_key("time", rule));
        }
        return Ok((column, only(all, |one| one.is_clock)));
    };
    let clock = found("time", time, all)?;
    if clock == column {
        return Err(refused("time", selection, "this is the column of the values"));
    }
    if all[clock].states_one() && !all[clock].is_clock {
        let stated = shortened(&all[clock].stated);
        let rule = format!("this column is in \"{stated}\"; give one in s, ms or us");
        return Err(refused("time", selection, &rule));
    }
    Ok((column, Some(clock)))
}

/// The index of the only column of a kind.
fn only(all: &[Channel], is_one: impl Fn(&Channel) -> bool) -> Option<usize> {
    let mut fitting = (0..all.len()).filter(|index| is_one(&all[*index]));
    fitting.next().filter(|_| fitting.next().is_none())
}

/// The index of the column that a name, with or without its unit, or an index means.
fn found(key: &'static str, column: &Column, all: &[Channel]) -> Result<usize, Fault> {
    let error =
        |rule: &str| Err(Fault::of_key(key, format!("force.{key} = {}: {rule}", shown(column))));
    let name = match column {
        Column::At(index) if *index < all.len() => return Ok(*index),
        Column::At(_) => {
            let last = all.len() - 1;
            return error(&format!("give an index from 0 to {last}; there is {}", listed(all)));
        }
        Column::Named(name) => plain(name),
    };
    let among = |of: fn(&Channel) -> &String| -> Vec<usize> {
        (0..all.len()).filter(|index| !name.is_empty() && *of(&all[*index]) == name).collect()
    };
    let full = among(|one| &one.name);
    let same = if full.is_empty() { among(|one| &one.bare) } else { full };
    match same[..] {
        [one] => Ok(one),
        [] => {
            let known = all.iter().flat_map(|one| [one.name.as_str(), one.bare.as_str()]);
            let near = nearest(&name, known.filter(|known| !known.is_empty()));
            let hint = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            error(&format!("no such column{hint}; there is {}", listed(all)))
        }
        _ => {
            let places: Vec<String> = same.iter().map(usize::to_string).collect();
            error(&format!("columns {} have this name, give an index", places.join(", ")))
        }
    }
}

/// The error of a column that is there.
fn refused(key: &'static str, selection: &Selection, rule: &str) -> Fault {
    let column = if key == "time" { &selection.time } else { &selection.column };
    let shown = column.as_ref().map(shown).unwrap_or_default();
    Fault::of_key(key, format!("force.{key} = {shown}: {rule}"))
}

fn shown(column: &Column) -> String {
    match column {
        Column::Named(name) => format!("\"{}\"", shortened(name)),
        Column::At(index) => index.to_string(),
    }
}

/// The names of columns for a message, or their indices if they have none.
fn listed<'a>(all: impl IntoIterator<Item = &'a Channel>) -> String {
    let names: Vec<&str> = all.into_iter().map(|one| one.name.as_str()).collect();
    let last = names.len() - 1;
    if names.iter().all(|name| name.is_empty()) {
        let to = if last > 0 { format!(" to {last}") } else { String::new() };
        return format!("columns without names, 0{to}");
    }
    let few: Vec<String> =
        names.iter().take(FEW).map(|name| format!("\"{}\"", shortened(name))).collect();
    let more = match names.len().saturating_sub(FEW) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    few.join(", ") + &more
}

/// Why a unit is refused: that of the file, or the one that is given.
enum Refused {
    InFile(String),
    Given(String),
}

/// The factor on the values of a column, and the unit that they have then.
fn unit_of(channel: &Channel, selection: &Selection) -> Result<(f64, RecordUnit), Refused> {
    let stated = channel.unit();
    let Some(given) = &selection.unit else {
        if channel.states_one() && stated.and_then(of_force).is_none() {
            let rule = format!(
                "unit \"{}\": it is none of a force; give force.unit, such as {COMMON}",
                shortened(&channel.stated)
            );
            return Err(Refused::InFile(rule));
        }
        let unstated = match channel.stated.as_str() {
            "" => RecordUnit::Unstated,
            _ => RecordUnit::OfStudy,
        };
        return Ok(stated.and_then(of_force).unwrap_or((1.0, unstated)));
    };
    let error = |rule: String| {
        Err(Refused::Given(format!("force.unit = \"{}\": {rule}", shortened(given))))
    };
    let wanted = unit(given);
    if given != OF_STUDY && wanted.and_then(of_force).is_none() {
        return error(format!("give a unit of a force, such as {COMMON}"));
    }
    if stated.is_some() && stated != wanted {
        return error(format!(
            "the file says that \"{}\" is in {}; leave unit out, or correct the file",
            shortened(&channel.name),
            shortened(&channel.stated)
        ));
    }
    Ok(wanted.and_then(of_force).unwrap_or((1.0, RecordUnit::OfStudy)))
}

/// The factor of a unit of acceleration or force, and what it is turned into.
fn of_force(unit: Unit) -> Option<(f64, RecordUnit)> {
    match unit.measures {
        Measures::Acceleration => Some((unit.factor, RecordUnit::MetresPerSecondSquared)),
        Measures::Force => Some((unit.factor, RecordUnit::Newtons)),
        Measures::Time | Measures::Motion => None,
    }
}
