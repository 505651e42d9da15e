//! `iva diagram` and `iva basins`: what steady states do over a field, and which start ends in which.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use iva_study::study_file::StudyFile;
use iva_sweep::Invalid;
use iva_sweep::dynamics::basins::{Asked, Basins, CUT, Plane, basins};
use iva_sweep::dynamics::diagram::{Direction, Strobes, Window, diagram};
use iva_sweep::dynamics::starts::{NAMES, Numbers, name_of};
use iva_sweep::dynamics::{Found, Outcome};
use iva_sweep::sweep::SweepError;

use crate::args::{AxisOfStarts, BasinsArgs, DiagramArgs};
use crate::cell::short;
use crate::changed_field::ChangedField;
use crate::error::Error;
use crate::interrupt;
use crate::orbits::{interrupted, refuse_existing, scene, unless_interrupted, write_new};
use crate::progress::watched;

/// Strobes that differ by less, over the size of all, are the same: those of a transient that is slow enough, too.
const SAME: f64 = 1e-6;
/// A steady state that takes more periods to repeat is printed as one that does not.
const MOST_PERIODS: usize = 16;
/// Side of the boxes of the entropies, in cells.
const SIDE: usize = 4;
/// Most cells of a plane.
const MOST_CELLS: usize = 10_000_000;

/// Numbers at equal distances.
fn spaced(low: f64, high: f64, count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|k| low + (high - low) * (k as f64 / last)).collect()
}

/// Follows steady states over a field, up and down; returns the text to print.
///
/// # Errors
/// What the study, the field or its values do not allow; a file that cannot be written.
pub(crate) fn diagram_command(args: &DiagramArgs) -> Result<String, Error> {
    refuse_existing(args.csv.as_deref())?;
    let field = ChangedField::new(&args.over, [args.from, args.to], args.count == 1)?;
    let (file, _) = scene(&args.study)?;
    let values = spaced(args.from, args.to, args.count as usize);
    let window = Window { discard: args.discard, keep: args.keep };
    let both = [Direction::Up, Direction::Down];
    let cancel: &AtomicBool = interrupt::listen();
    let found = watched("running", Some(2 * args.count), cancel, |tracker| {
        diagram(&file.study.spec, (field.over, &values), &both, window, tracker)
    });
    let mut found = found.map_err(|error| match error {
        SweepError::Invalid(invalid) => field.blame(&file, &invalid),
        error => error.into(),
    })?;
    let all = found.len();
    found.retain(|it| it.outcome != Outcome::Cancelled);
    if found.is_empty() {
        unless_interrupted(cancel)?;
    }
    let count = found.iter().flat_map(|it| &it.states).map(Vec::len).max().unwrap_or(NAMES.len());
    let names: Vec<String> = (0..count).map(|place| name_of(place, count)).collect();
    let mut table = format!("{},direction,{},impacts\n", args.over, names.join(","));
    for strobes in &found {
        for (state, impacts) in strobes.states.iter().zip(&strobes.impacts) {
            let way = name(strobes.direction);
            let numbers: Vec<String> = state.iter().map(f64::to_string).collect();
            let numbers = numbers.join(",");
            let _ = writeln!(table, "{},{way},{numbers},{impacts}", strobes.value);
        }
    }
    let report = both.map(|direction| ranges(&found, direction, &args.over)).concat();
    write_new(args.csv.as_deref(), &table, &report)?;
    if found.len() == all {
        return Ok(report);
    }
    let [up, down] = both.map(|way| found.iter().filter(|it| it.direction == way).count());
    let kept = format!("{up} of {} values upwards and {down} downwards", values.len());
    Err(interrupted(report, &kept, args.csv.as_deref()))
}

fn name(direction: Direction) -> &'static str {
    match direction {
        Direction::Up => "up",
        Direction::Down => "down",
    }
}

/// The number of periods after which the strobes repeat; `None` if they do not.
fn repeats(strobes: &Strobes) -> Option<usize> {
    let states = &strobes.states;
    let size = states.iter().flatten().fold(0.0, |size: f64, it| size.max(it.abs()));
    let same =
        |a: &Numbers, b: &Numbers| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * size);
    let after = |n: &usize| states.windows(n + 1).all(|some| same(&some[0], &some[*n]));
    (1..=MOST_PERIODS.min(states.len() / 2)).find(after)
}

/// The ranges of values whose steady states repeat alike, for the terminal.
fn ranges(found: &[Strobes], direction: Direction, over: &str) -> String {
    let own: Vec<_> = found.iter().filter(|it| it.direction == direction).collect();
    if own.is_empty() {
        return String::new();
    }
    let mut out = format!("{}\n", name(direction));
    for group in own.chunk_by(|a, b| repeats(a) == repeats(b)) {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
        let what = match repeats(first) {
            Some(1) => "repeats every period".to_owned(),
            Some(count) => format!("repeats every {count} periods"),
            None => "does not repeat".to_owned(),
        };
        let (from, to) = (short(first.value, 6), short(last.value, 6));
        let _ = writeln!(out, "  {over} {from:>10} to {to:<10} {what}");
    }
    out
}

/// Decides for each start of a plane which steady state it ends in; returns the text to print.
///
/// # Errors
/// What the study or the plane does not allow; a file that cannot be written.
pub(crate) fn basins_command(args: &BasinsArgs) -> Result<String, Error> {
    refuse_existing(args.csv.as_deref())?;
    check_plane(args)?;
    let (file, _) = scene(&args.study)?;
    let AxisOfStarts { place: across, low, high, count } = args.across;
    let columns = spaced(low, high, count);
    let AxisOfStarts { place: up, low, high, count } = args.up;
    let plane = Plane { axes: [across, up], values: [columns, spaced(low, high, count)] };
    let asked = Asked {
        orbits: None,
        most_periods: args.most_periods,
        most_cycles: args.most_cycles,
        side: SIDE,
    };
    let cancel: &AtomicBool = interrupt::listen();
    let starts = plane.values.iter().map(|values| values.len() as u64).product();
    let found = watched("running", Some(starts), cancel, |tracker| {
        basins(&file.study.spec, &plane, &asked, tracker)
    });
    let found = found.map_err(|error| match error {
        SweepError::Invalid(invalid) => blame(args, &file, &invalid),
        error => error.into(),
    })?;
    let finished = found.labels.iter().filter(|label| **label != CUT).count();
    if finished == 0 {
        unless_interrupted(cancel)?;
    }
    let names = [across, up].map(named);
    let mut table = format!("{},label,likely,cycles\n", names.join(","));
    let width = plane.values[0].len();
    for (index, label) in found.labels.iter().enumerate().filter(|(_, label)| **label != CUT) {
        let (x, y) = (plane.values[0][index % width], plane.values[1][index / width]);
        let _ = writeln!(table, "{x},{y},{label},{},{}", found.likely[index], found.cycles[index]);
    }
    let report = shares(&found);
    write_new(args.csv.as_deref(), &table, &report)?;
    let all = found.labels.len();
    if finished == all {
        return Ok(report);
    }
    let kept = format!("{finished} of {all} starts");
    Err(interrupted(report, &kept, args.csv.as_deref()))
}

/// The name of a number of the start, with the index of its absorber from the second one on.
fn named(place: usize) -> String {
    name_of(place, if place < NAMES.len() { NAMES.len() } else { place + 1 })
}

/// Checks that a plane has two numbers, and not too many cells.
fn check_plane(BasinsArgs { across, up, .. }: &BasinsArgs) -> Result<(), Error> {
    if across.place == up.place {
        let name = named(up.place);
        let rule = "it goes across already; give another number of the start";
        return Err(Error::Refused(format!("--up {name}: {rule}")));
    }
    if across.count.saturating_mul(up.count) > MOST_CELLS {
        let cells = format!("{} times {} starts", across.count, up.count);
        return Err(Error::Refused(format!(
            "--across and --up have {cells}: give at most {MOST_CELLS}"
        )));
    }
    Ok(())
}

/// The error for an invalid value: of a number of the plane, or of the study.
fn blame(args: &BasinsArgs, file: &StudyFile, invalid: &Invalid) -> Error {
    let of = |axis: &AxisOfStarts| format!("start.{}", named(axis.place)) == invalid.field;
    match [("--across", args.across), ("--up", args.up)].iter().find(|(_, axis)| of(axis)) {
        Some((option, axis)) => {
            let AxisOfStarts { place, low, high, count } = axis;
            let given = format!("{option} {},{low},{high},{count}", named(*place));
            Error::Refused(format!("{given}: {invalid}"))
        }
        None => file.source.locate(invalid).into(),
    }
}

/// What the cells end in, for the terminal.
fn shares(found: &Basins) -> String {
    let mut counts = BTreeMap::new();
    for label in found.labels.iter().filter(|label| **label != CUT) {
        *counts.entry(*label).or_insert(0usize) += 1;
    }
    let all: usize = counts.values().sum();
    let mut out = format!("{all} starts\n\n");
    for (label, count) in counts {
        let what = match usize::try_from(label).ok().and_then(|index| found.attractors.get(index)) {
            Some(orbit) => described(orbit),
            None if label == -2 => "a motion without impacts".to_owned(),
            None => "not decided".to_owned(),
        };
        let _ = writeln!(
            out,
            "  {label:>3}  {:>6} %  {what}",
            short(100.0 * count as f64 / all as f64, 3)
        );
    }
    for one in &found.left_out {
        let _ = writeln!(out, "\n  left out: {}", one.words());
    }
    // Of a part of the plane they would say nothing.
    if let Some(entropy) = found.entropy.as_ref().filter(|_| all == found.labels.len()) {
        let _ = writeln!(out, "\n  basin entropy           {}", short(entropy.basin, 4));
        if let Some(boundary) = entropy.boundary {
            let _ = writeln!(out, "  boundary basin entropy  {}", short(boundary, 4));
        }
    }
    out
}

fn described(orbit: &Found) -> String {
    let [x, v, y, w] = [
        orbit.course.state().displacement,
        orbit.course.state().velocity,
        orbit.course.state().gap_displacement,
        orbit.course.state().gap_velocity,
    ]
    .map(|number| short(number, 4));
    let count = orbit.course.impacts.len();
    format!("{count} impacts {} from ({x}, {v}, {y}, {w})", orbit.course.walls)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spaced_numbers_have_both_ends() {
        assert_eq!(spaced(-1.0, 1.0, 5), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(spaced(2.0, 3.0, 1), [2.0]);
    }
}
