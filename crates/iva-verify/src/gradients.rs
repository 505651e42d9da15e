//! Derivatives of results with respect to a given number: differences of runs to twice the precision.
//!
//! The number is changed by 2⁻⁵⁴ of itself, a quarter of a unit in the last place of a double. A difference of two runs
//! then leaves out 2⁻¹⁰⁸ of the third derivative, and keeps some 14 digits of the 30 that each run has (of pendulums 13):
//! so every number of every row comes with its derivative, in the user's units. Where an impact moves by 10¹² times what the
//! number is changed by, nine digits are left. What a formula for derivatives would tell of jumps at impacts (the
//! saltation matrix) and of summed chatters is in the difference. A measure that jumps (a settling time, where the last
//! crossing moves to another half cycle) has the derivative of its current branch.
//!
//! Three runs at equal steps tell whether there is a derivative: where a number jumps or has a corner at the very value of
//! the parameter (what refers to the amplitude at the start, of a structure that starts from 0), its two differences
//! are not alike, and the derivative is null.
//!
//! The rows are those of the run in doubles. From the first impact whose estimated error reaches 10⁻³/ωn on, and from
//! the first event that another run does not have, all derivatives are null.

use std::sync::atomic::AtomicBool;

use iva_core::error::Invalid;
use iva_core::measures::FIT_FLOOR;
use iva_core::real::Real;
use iva_core::real::twofold::Twofold;
use iva_sweep::choices::Kind;
use iva_sweep::columns::columns;
use iva_sweep::design::Spec;
use iva_sweep::engine::given::Given;
use iva_sweep::fields::{Allowed, FieldId, Part, Quantity};
use iva_sweep::listed::{Beside, Cell, Closeness, Content, Rows, rows, rows_in_doubles, table};
use iva_sweep::slot::Slot;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{SweepError, Tables};

use crate::verify::{alike, rows_of};

/// Relative change of the parameter (absolute for a parameter of 0) between two runs: 2⁻⁵⁴.
const STEP: f64 = 1.0 / (1u64 << 54) as f64;

/// Steps and weights of a difference quotient of second order: between both sides of the parameter or, where it lies at
/// an end of its range, or where other events begin (a structure let go at rest: with a velocity it has one more peak, or
/// none), from one side.
const QUOTIENTS: [[(f64, f64); 3]; 3] = [
    [(-1.0, -0.5), (0.0, 0.0), (1.0, 0.5)],
    [(0.0, -1.5), (1.0, 2.0), (2.0, -0.5)],
    [(-2.0, 0.5), (-1.0, -2.0), (0.0, 1.5)],
];

/// The part of itself by which a difference may change from one step to the next: what bends so much within 2⁻⁵⁴ has no
/// derivative.
const CORNER: f64 = 1e-2;

/// Rounding of runs to twice the precision, over the largest number of the same quantity in a row: differences below it
/// are taken for equal.
const ROUNDING: f64 = 1e-26;

/// Relative change of the parameter (absolute for a parameter of 0) that must be able to turn an impact into
/// a grazing, to first order, for the impact to count as close to one.
const GRAZING: f64 = 1e-3;

/// Estimated error of an impact time, in 1/ωn, from which on the motion is too sensitive for derivatives:
/// beyond it rounding decides which impacts follow.
const SENSITIVE: f64 = 1e-3;

/// Fields that decide when a run stops or what it lists: results are not differentiated with respect to them.
const NOT_PHYSICAL: [FieldId; 5] = [
    FieldId::MaxImpacts,
    FieldId::MaxWork,
    FieldId::Tolerance,
    FieldId::ChatterFloor,
    FieldId::Discard,
];

/// Fields that are 0 where a scene is of another kind, which a run does not have: without friction, spring or dashpot, or with an
/// impulse that is part of the start.
const OTHER_AT_ZERO: [FieldId; 5] = [
    FieldId::Friction,
    FieldId::Spring,
    FieldId::GapDamping,
    FieldId::GapDampingRatio,
    FieldId::ImpulseTime,
];

/// The tables of a study without axes, with derivatives in place of numbers. All else is as in the run,
/// except `near_grazing` of the impacts, which is true from the first impact on that is close to a grazing.
/// The summary has the additional column `sensitive_from`: the instant from which on derivatives are null
/// because rounding decides what happens.
///
/// `key` names the parameter as in a sweep.
///
/// # Errors
/// [`SweepError`] for an unknown key, a parameter that is not given and has no default, or an invalid
/// design.
pub fn gradients(study: &Study, key: &str, cancel: &AtomicBool) -> Result<Tables, SweepError> {
    let slot =
        Slot::from_key(key).map_err(|error| Invalid { field: "gradients".to_owned(), ..error })?;
    let mut spec = study.spec(0)?;
    let value = given(study, &mut spec, slot)?;
    let own = slot.field == FieldId::SpringRatio
        && spec.choices_of(slot.number.unwrap_or(0)).kind == Kind::Siva;
    if value == 0.0 && (own || OTHER_AT_ZERO.contains(&slot.field)) {
        let rule = "at 0 it has no derivative, as the scene is of another kind; give a number above 0, or sweep it";
        return Err(Invalid::new("gradients", format!("`{}`", slot.path()), rule).into());
    }
    let size = if value == 0.0 { 1.0 } else { value.abs() };
    // Events tell up to when the runs are alike, peaks whether they are those of one motion.
    let mut with_events = study.clone();
    for table in [Table::Impacts, Table::Episodes, Table::Envelope] {
        if !with_events.tables.contains(&table) {
            with_events.tables.push(table);
        }
    }
    let runs = Differentiated::new(&with_events, &spec, (slot, size), cancel)?;
    let content = Content::Derivatives { by: slot, key: key.to_owned() };
    let shown = study.tables.iter().filter(|table| Table::SWEEP.contains(table));
    shown.map(|&of| Ok((of, table(study, of, &content, runs.derivatives(of))?))).collect()
}

/// A run in doubles, and the runs of a difference quotient beside it.
struct Differentiated {
    /// The rows of the run in doubles.
    rows: Rows<f64>,
    /// How close its impacts are to being others.
    closeness: Closeness,
    /// The runs to twice the precision.
    beside: Vec<Weighted>,
    /// The size of the parameter, of which a step is a part.
    size: f64,
    /// The instant from which on derivatives are not known, in the user's unit.
    until: Option<f64>,
    /// A period 2π/ωn, in the user's unit.
    period: f64,
    /// |x| at the begin of the run.
    begun_at: f64,
}

/// A run in a difference quotient.
struct Weighted {
    weight: f64,
    natural_frequency: Twofold,
    rows: Rows<Twofold>,
}

/// A difference quotient that may be taken.
struct Chosen {
    /// Up to when its runs have the events of the run in doubles, and whether they have as many peaks.
    rank: (f64, bool),
    runs: Vec<Weighted>,
    parted: Option<f64>,
}

impl Differentiated {
    fn new(
        study: &Study,
        spec: &Spec,
        (slot, size): (Slot, f64),
        cancel: &AtomicBool,
    ) -> Result<Self, Invalid> {
        let plain = spec.design()?;
        let mut closeness = Closeness::default();
        let watched: Beside<'_> = (None, (None, Some(&mut closeness)));
        let found = rows_in_doubles(study, &plain, cancel, watched)?;
        let sensitive = sensitive_from(&closeness).map(|time| plain.scale.time(time));
        let (beside, parted) = quotient(study, spec, (slot, size), (&found, sensitive), cancel)?;
        let until = parted.into_iter().chain(sensitive).reduce(f64::min);
        let period = plain.scale.time(std::f64::consts::TAU);
        let begun_at = plain.scene.primary().x.abs();
        Ok(Self { rows: found, closeness, beside, size, until, period, begun_at })
    }

    /// The rows of a table with derivatives in place of numbers.
    fn derivatives(&self, table: Table) -> Vec<Vec<Cell>> {
        let rows = rows_of(&self.rows, table);
        let others: Vec<_> = self.beside.iter().map(|it| rows_of(&it.rows, table)).collect();
        let mut met = false;
        let row = |(index, row): (usize, &&[Cell])| {
            let others: Option<Vec<_>> =
                others.iter().map(|rows| rows.get(index).copied()).collect();
            // A row of events is one of the same event; what is known of a summary of other events, `is_known` tells.
            let others = others.filter(|others| {
                table == Table::Summary || others.iter().all(|other| alike(table, row, other))
            });
            let derivative = |place: usize| {
                let others = others.as_ref().filter(|_| self.is_known(table, row, place))?;
                let values = numbers(others, place, |_| Twofold::ONE)?;
                self.slope(values, scale(table, row, place))
            };
            let mut cells = row.to_vec();
            for (place, cell) in cells.iter_mut().enumerate() {
                if let Cell::Number(_) = cell {
                    *cell = derivative(place).map_or(Cell::Null, Cell::Number);
                }
            }
            match table {
                Table::Summary => cells.push(self.until.map_or(Cell::Null, Cell::Number)),
                Table::Impacts => {
                    met |= self.is_close(index, row, others.as_deref());
                    cells[place_of(table, "near_grazing")] = Cell::Flag(met);
                }
                _ => {}
            }
            cells
        };
        rows.iter().enumerate().map(row).collect()
    }

    /// The difference quotient of the values of the three runs; `None` where there is no derivative.
    fn slope(&self, values: [Twofold; 3], scale: f64) -> Option<f64> {
        let [first, second] = [0, 1].map(|k| f64::from(values[k + 1] - values[k]));
        let bend = (second - first).abs();
        if bend > CORNER * (first.abs() + second.abs()) + ROUNDING * scale {
            return None;
        }
        let sum = self.beside.iter().zip(values).map(|(run, value)| value * run.weight);
        let slope = f64::from(sum.sum::<Twofold>() / (STEP * self.size));
        slope.is_finite().then_some(slope)
    }

    /// True if a small change of the parameter could turn an impact into a grazing.
    fn is_close(&self, index: usize, row: &[Cell], others: Option<&[&[Cell<Twofold>]]>) -> bool {
        let time = place_of(Table::Impacts, "time");
        // In natural time: a change of ωn alone moves no impact towards another.
        let natural = |run: usize| self.beside[run].natural_frequency;
        let values = others.and_then(|others| numbers(others, time, natural));
        let scale = scale(Table::Impacts, row, time) * f64::from(natural(0));
        let slope = values.and_then(|values| self.slope(values, scale));
        let (Some(slope), Some(bend)) = (slope, self.closeness.1.impacts.get(index)) else {
            return true;
        };
        bend.is_grazing_within(slope * GRAZING * self.size)
    }

    /// True if a number of a row is decided before the instant from which on derivatives are not known.
    fn is_known(&self, table: Table, row: &[Cell], place: usize) -> bool {
        let Some(until) = self.until else { return true };
        let columns = columns(table);
        // The first cell is `point`, which has no column.
        let before = |place: usize| match (&row[place], columns[place - 1].quantity) {
            (Cell::Number(time), Quantity::Time) => *time < until,
            _ => true,
        };
        match (table, columns[place - 1].name) {
            (Table::Summary, "settling_time_10" | "settling_time_5" | "settling_time_2") => {
                before(place)
            }
            (Table::Summary, "energy_initial" | "gravity") => true,
            (Table::Summary, "damping_ratio_energy") => self.period < until,
            (Table::Summary, "damping_ratio_1") => self.has_peaks(3, until),
            (Table::Summary, "damping_ratio_3") => self.has_peaks(7, until),
            (Table::Summary, "damping_ratio_10") => self.has_peaks(21, until),
            (Table::Summary, "damping_ratio_fit") => self.fit_is_over(until),
            // All others depend on the whole run.
            (Table::Summary | Table::Absorbers, _) => false,
            // An event is known if all its instants are.
            _ => (1..row.len()).all(before),
        }
    }

    /// True if the half cycle whose peak ends the fit of the damping ratio is over before an instant: the next peak
    /// has come.
    fn fit_is_over(&self, until: f64) -> bool {
        let (peaks, place) =
            (rows_of(&self.rows, Table::Envelope), place_of(Table::Envelope, "amplitude"));
        let size = |row: &&[Cell]| if let Cell::Number(size) = row[place] { size } else { 0.0 };
        let reference =
            if self.begun_at > 0.0 { self.begun_at } else { peaks.first().map_or(0.0, size) };
        let last = peaks.iter().position(|row| size(row) < FIT_FLOOR * reference);
        last.is_some_and(|last| self.has_peaks(last + 2, until))
    }

    /// True if the run has so many peaks before an instant.
    fn has_peaks(&self, count: usize, until: f64) -> bool {
        let (envelope, time) = (Table::Envelope, place_of(Table::Envelope, "time"));
        let last = rows_of(&self.rows, envelope).get(count - 1).map(|row| &row[time]);
        matches!(last, Some(Cell::Number(time)) if *time < until)
    }
}

/// The runs of a difference quotient, and the instant from which on they do not have the events of the run in doubles: of
/// the first that always has, and as many peaks in each run, else of the one that has them longest.
fn quotient(
    study: &Study,
    spec: &Spec,
    (slot, size): (Slot, f64),
    (found, sensitive): (&Rows<f64>, Option<f64>),
    cancel: &AtomicBool,
) -> Result<(Vec<Weighted>, Option<f64>), Invalid> {
    let mut spec = spec.clone();
    if spec.get(FieldId::Tolerance).is_some() {
        spec.set(FieldId::Tolerance, 0.0)?;
    }
    let run = |&(step, weight): &(f64, f64)| {
        let step = Twofold::from(step * STEP * size);
        let design = Given::shifted(&spec, slot, step).design()?;
        let natural_frequency = design.scale.natural_frequency;
        Ok(Weighted { weight, natural_frequency, rows: rows(study, &design, cancel, ())? })
    };
    let (mut best, mut refused) = (None::<Chosen>, None);
    for quotient in QUOTIENTS {
        let runs = match quotient.iter().map(run).collect::<Result<Vec<_>, Invalid>>() {
            Ok(runs) => runs,
            Err(reason) => {
                refused = Some(reason);
                continue;
            }
        };
        let parted = runs.iter().filter_map(|it| parted(found, &it.rows)).reduce(f64::min);
        let peaks = |run: &Weighted| rows_of(&run.rows, Table::Envelope).len();
        let alike = runs.iter().all(|run| peaks(run) == peaks(&runs[0]));
        // What happens after it has become too sensitive does not matter.
        let whole = parted.is_none_or(|at| sensitive.is_some_and(|from| at >= from));
        let rank = (if whole { f64::INFINITY } else { parted.unwrap_or(0.0) }, alike);
        if best.as_ref().is_none_or(|best| rank > best.rank) {
            best = Some(Chosen { rank, runs, parted });
        }
        if whole && alike {
            break;
        }
    }
    let none =
        || Invalid::new("gradients", format!("`{}`", slot.path()), "it can be no other number");
    best.map(|it| (it.runs, it.parted)).ok_or_else(|| refused.unwrap_or_else(none))
}

/// The instant of the first impact that is too sensitive, in 1/ωn; `None` if there is none.
fn sensitive_from((errors, bends): &Closeness) -> Option<f64> {
    let sensitive = |time: Option<f64>| time.is_none_or(|error| error >= SENSITIVE);
    let first = errors.impacts.iter().position(|error| sensitive(error.time))?;
    Some(bends.impacts.get(first)?.time)
}

/// The instant of the first event that one of two runs does not have; `None` if they have the same.
fn parted(rows: &Rows<f64>, exact: &Rows<Twofold>) -> Option<f64> {
    let of = |table| {
        let (rows, exact) = (rows_of(rows, table), rows_of(exact, table));
        let same = rows.iter().zip(&exact).take_while(|(a, b)| alike(table, a, b)).count();
        if same == rows.len() && same == exact.len() {
            return None;
        }
        let first = columns(table).iter().position(|column| column.quantity == Quantity::Time)? + 1;
        let number = |cell: &Cell| if let Cell::Number(it) = cell { Some(*it) } else { None };
        let exactly = |cell: &Cell<Twofold>| match cell {
            Cell::Number(it) => Some(f64::from(*it)),
            _ => None,
        };
        let one = rows.get(same).and_then(|row| number(&row[first]));
        let other = exact.get(same).and_then(|row| exactly(&row[first]));
        Some(one.into_iter().chain(other).reduce(f64::min).unwrap_or(0.0))
    };
    [Table::Impacts, Table::Episodes].into_iter().filter_map(of).reduce(f64::min)
}

/// The numbers of three rows at a place, that of each run times a factor; `None` where one is missing.
fn numbers(
    rows: &[&[Cell<Twofold>]],
    place: usize,
    factor: impl Fn(usize) -> Twofold,
) -> Option<[Twofold; 3]> {
    let number = |run: usize| match rows.get(run)?[place] {
        Cell::Number(value) => Some(value * factor(run)),
        _ => None,
    };
    Some([number(0)?, number(1)?, number(2)?])
}

/// The largest number in a row of the quantity that stands at a place.
fn scale(table: Table, row: &[Cell], place: usize) -> f64 {
    let columns = columns(table);
    let same =
        columns.iter().zip(&row[1..]).filter(|it| it.0.quantity == columns[place - 1].quantity);
    let size = |cell: &Cell| if let Cell::Number(it) = cell { it.abs() } else { 0.0 };
    same.map(|(_, cell)| size(cell)).fold(0.0, f64::max)
}

/// The place of a column in a row, which begins with the point.
fn place_of(table: Table, name: &str) -> usize {
    1 + columns(table).iter().position(|column| column.name == name).unwrap_or(0)
}

/// The value of the parameter; if it was not given, its default is set in the spec.
fn given(study: &Study, spec: &mut Spec, slot: Slot) -> Result<f64, Invalid> {
    let refused = |rule: &str| Invalid::new("gradients", format!("`{}`", slot.path()), rule);
    if NOT_PHYSICAL.contains(&slot.field) {
        return Err(refused("the motion does not depend on it"));
    }
    if slot.info().part != Part::Force {
        spec.check(slot).map_err(|rule| refused(&rule))?;
    }
    if matches!(slot.info().allowed, Allowed::Units | Allowed::Exponent) {
        return Err(refused("it has values apart from each other; sweep it"));
    }
    let found =
        spec.given().find(|(other, _)| other.field == slot.field && other.same_quantity(slot));
    // The derivative at 0 does not exist: with any inclination the absorber starts elsewhere.
    let inclines = slot.field.same_quantity(FieldId::Inclination);
    let rubs = spec.get_of(0, FieldId::Friction).is_some_and(|friction| friction != 0.0);
    let weighs = slot.field == FieldId::Gravity && spec.choices().kind == Kind::Siva && !rubs;
    if (inclines || weighs) && !study.rises() {
        return Err(refused("the line of motion is level; give one that rises"));
    }
    if let Some((_, value)) = found {
        return Ok(value);
    }
    if let Some((other, _)) = spec.given().find(|(other, _)| other.same_quantity(slot)) {
        return Err(refused(&format!("{} is given in its place; give that name", other.path())));
    }
    match study.default(slot.field).filter(|_| slot.info().part != Part::Force) {
        Some(value) => spec.set(slot, value).map(|()| value),
        None => Err(refused("it is not given")),
    }
}
