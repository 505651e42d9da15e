//! `iva orbit` and `iva branch`: periodic orbits of the scene of a study, and how they change with one of its fields.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use iva_study::error::Kept;
use iva_study::study_file::{StudyFile, read_study};
use iva_sweep::dynamics::branches::{Complex, End, Followed, Row, Special, Way, follow};
use iva_sweep::dynamics::words::words;
use iva_sweep::dynamics::{Asked, Found, ToTwice, orbit};
use iva_sweep::fields::Quantity;
use iva_sweep::slot::Slot;
use iva_sweep::units::UnitSystem;

use crate::args::{BranchArgs, OrbitArgs};
use crate::cell::short;
use crate::changed_field::ChangedField;
use crate::error::Error;
use crate::interrupt;
use crate::progress::watched;
use crate::run_study::warn;

/// Significant digits of what is printed; of where a special point is, and of multipliers.
const DIGITS: usize = 6;
const ALL_DIGITS: usize = 15;

/// The scene of a study without a sweep, and its units.
pub(crate) fn scene(study: &Path) -> Result<(StudyFile, UnitSystem), Error> {
    let file = read_study(study)?;
    warn(&file, false);
    if !file.study.sampling.is_empty() {
        let study = study.display();
        let rule = format!("{study} has a [sweep] section; give one with a single scene");
        return Err(Error::Refused(rule));
    }
    let units = file.study.units().map_err(|invalid| file.source.locate(&invalid))?;
    Ok((file, units))
}

/// # Errors
/// If Ctrl-C was pressed.
pub(crate) fn unless_interrupted(cancel: &AtomicBool) -> Result<(), Error> {
    if cancel.load(Ordering::Relaxed) {
        return Err(iva_study::Error::Interrupted(Kept::nothing()).into());
    }
    Ok(())
}

/// Finds the orbit that is asked for.
fn found(file: &StudyFile, args: &OrbitArgs, cancel: &AtomicBool) -> Result<Found, Error> {
    let OrbitArgs { periods, settle, symmetric, verify, .. } = *args;
    let verify = verify.then_some(iva_verify::exact_orbit as ToTwice);
    let asked = Asked { periods, symmetric: symmetric.then_some(true), settle, verify };
    let answer = orbit(&file.study.spec, asked, cancel);
    unless_interrupted(cancel)?;
    answer
        .map_err(|invalid| file.source.locate(&invalid))?
        .map_err(|missed| Error::Refused(format!("no orbit: {}", words(&missed).1)))
}

/// Finds a periodic orbit; returns the text to print.
///
/// # Errors
/// What [`read_study`] refuses, a scene that has no orbits, or the reason why none was found.
pub(crate) fn orbit_command(args: &OrbitArgs) -> Result<String, Error> {
    let (file, units) = scene(&args.study)?;
    Ok(described(&found(&file, args, interrupt::listen())?, units))
}

/// A number with its unit.
fn measured(value: f64, quantity: Quantity, units: UnitSystem) -> String {
    match units.unit(quantity) {
        "1" => short(value, DIGITS),
        unit => format!("{} {unit}", short(value, DIGITS)),
    }
}

fn complex(value: &Complex<f64>) -> String {
    if value.im == 0.0 {
        return short(value.re, DIGITS);
    }
    let sign = if value.im < 0.0 { '-' } else { '+' };
    format!("{} {sign} {}i", short(value.re, DIGITS), short(value.im.abs(), DIGITS))
}

/// So many of the marks of walls fit into a line.
const MOST_WALLS: usize = 24;

/// An orbit, for the terminal.
fn described(found: &Found, units: UnitSystem) -> String {
    let Found { course, spectrum, .. } = found;
    let kind = if found.stable { "stable" } else { "unstable" };
    let shape = if found.symmetric { "symmetric" } else { "asymmetric" };
    let mut walls: String = course.walls.chars().take(MOST_WALLS).collect();
    if walls.len() < course.walls.len() {
        walls.push('…');
    }
    let mut out = format!(
        "{kind}, {shape} orbit: {} impacts {walls} in {}\n\n",
        course.impacts.len(),
        measured(found.length, Quantity::Time, units)
    );
    let mut line = |name: &str, text: String| {
        let _ = writeln!(out, "  {name:<24}{text}");
    };
    for (k, multiplier) in spectrum.multipliers.iter().enumerate() {
        line(if k == 0 { "multipliers" } else { "" }, complex(multiplier));
    }
    line("rank", spectrum.rank.to_string());
    if let Some(amplitude) = found.amplitude {
        line("amplitude", measured(amplitude, Quantity::Length, units));
    }
    if let Some(margin) = found.grazing_margin {
        line("grazing margin", measured(margin, Quantity::Length, units));
    }
    line("residual", short(found.residual, 3));
    if let Some(error) = found.error {
        line("error in doubles", short(error, 3));
    }
    let state = course.state();
    for (name, value, quantity) in [
        ("at time", state.time, Quantity::Time),
        ("displacement", state.displacement, Quantity::Length),
        ("velocity", state.velocity, Quantity::Velocity),
    ] {
        let unit = units.unit(quantity);
        line(name, format!("{} {unit}", short(value, ALL_DIGITS)));
    }
    for state in &course.states {
        let number = match course.states.len() {
            1 => String::new(),
            _ => format!(" {}", state.absorber),
        };
        for (name, value, quantity) in [
            ("gap displacement", state.gap_displacement, Quantity::Length),
            ("gap velocity", state.gap_velocity, Quantity::Velocity),
        ] {
            let unit = units.unit(quantity);
            line(&format!("{name}{number}"), format!("{} {unit}", short(value, ALL_DIGITS)));
        }
    }
    out
}

/// Follows the branch of an orbit; returns the text to print.
///
/// # Errors
/// As [`orbit_command`]; for a field that the study does not give, or a range that it does not allow.
pub(crate) fn branch_command(args: &BranchArgs) -> Result<String, Error> {
    refuse_existing(args.csv.as_deref())?;
    let field = ChangedField::new(&args.over, [args.from, args.to], false)?;
    if !(args.step > 0.0 && args.step <= 1.0) {
        let rule = "give a number above 0, up to 1";
        return Err(Error::Refused(format!("--step {}: {rule}", args.step)));
    }
    let (file, units) = scene(&args.orbit.study)?;
    let cancel = interrupt::listen();
    let start = found(&file, &args.orbit, cancel)?;
    let over = field.over;
    let between = [args.from, args.to];
    let way = Way { over, between, longest: args.step, most_points: args.points as usize };
    let on_orbit = start.course.begun(&file.study.spec);
    let spec = on_orbit.map_err(|invalid| file.source.locate(&invalid))?;
    let shape = (start.least_periods, start.symmetric);
    let followed =
        watched("following", None, cancel, |tracker| follow(&spec, shape, &way, tracker))
            .map_err(|invalid| field.blame(&file, &invalid))?;
    if !followed.as_ref().is_ok_and(|branch| branch.rows.len() > 1) {
        unless_interrupted(cancel)?;
    }
    let followed =
        followed.map_err(|none| Error::Refused(format!("no branch: {}", none.words().1)))?;
    let report = told(&followed, over, units);
    write_new(args.csv.as_deref(), &table(&followed, &args.over), &report)?;
    match followed.ends.contains(&End::Cancelled) {
        true => {
            let points = format!("{} points of the branch", followed.rows.len());
            Err(interrupted(report, &points, args.csv.as_deref()))
        }
        false => Ok(report),
    }
}

/// The error of a command that was interrupted when it had found something, which is written if there is a file.
pub(crate) fn interrupted(report: String, found: &str, csv: Option<&Path>) -> Error {
    let kept = match csv {
        Some(path) => format!("{found} are written to {}", path.display()),
        None => format!("{found} were found"),
    };
    Error::Interrupted { report, kept }
}

/// Refuses a file that is there already, before anything is computed.
pub(crate) fn refuse_existing(path: Option<&Path>) -> Result<(), Error> {
    match path.filter(|path| path.symlink_metadata().is_ok()) {
        Some(path) => {
            let shown = path.display();
            Err(Error::Refused(format!("--csv {shown}: it exists; give the name of a new file")))
        }
        None => Ok(()),
    }
}

/// Writes a new file; where that fails, what was computed is told with the error.
pub(crate) fn write_new(path: Option<&Path>, text: &str, report: &str) -> Result<(), Error> {
    let Some(path) = path else { return Ok(()) };
    let written = File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|reason| {
        let shown = path.display();
        Error::Refused(format!("--csv {shown}: it cannot be written: {reason}\n\n{report}"))
    })
}

/// A branch, for the terminal.
fn told(followed: &Followed, over: Slot, units: UnitSystem) -> String {
    let Followed { chain, rows, special, ends, .. } = followed;
    let stable = rows.iter().filter(|row| row.stable).count();
    let shape = if chain.symmetric { "symmetric" } else { "asymmetric" };
    let values = || rows.iter().map(|row| row.value);
    let name = over.path();
    let mut out = format!(
        "{} {shape} orbits with {} impacts in {} periods, {stable} of them stable\n\n  {name} from {} to {}; \
         ends: {}, {}\n\n",
        rows.len(),
        followed.impacts(),
        chain.cycles,
        short(values().fold(f64::INFINITY, f64::min), DIGITS),
        measured(values().fold(f64::NEG_INFINITY, f64::max), over.info().quantity, units),
        ends[0].name(),
        ends[1].name(),
    );
    for Special { condition, row } in special {
        let kind = condition.kind().name();
        let _ = writeln!(
            out,
            "  {kind:<16} {:<24} multiplier {}",
            short(row.value, ALL_DIGITS),
            complex(&row.multipliers[0])
        );
    }
    out
}

/// The rows of a branch as CSV.
fn table(followed: &Followed, over: &str) -> String {
    let mut out = format!("{over},arclength,amplitude,stable,grazing_margin,approach_speed_min");
    for k in 1..=followed.rows.first().map_or(0, |row| row.multipliers.len()) {
        let _ = write!(out, ",multiplier_{k}_re,multiplier_{k}_im");
    }
    out.push('\n');
    for row in &followed.rows {
        let Row { value, arclength, amplitude, stable, grazing_margin, .. } = row;
        let _ = write!(
            out,
            "{value},{arclength},{amplitude},{stable},{grazing_margin},{}",
            row.approach_speed_min
        );
        for multiplier in &row.multipliers {
            let _ = write!(out, ",{},{}", multiplier.re, multiplier.im);
        }
        out.push('\n');
    }
    out
}
