//! The printed report: the best points of a sweep, or the measures of a single run.

mod neighbourhoods;

use std::collections::BTreeMap;
use std::fmt::Write;

use arrow_array::RecordBatch;
use iva_study::report::Report;
use iva_study::resolved::first_upper;
use iva_sweep::choices::Kind;
use iva_sweep::columns::{Better, Column, SUMMARY, ranked};
use iva_sweep::fields::{Part, Quantity};
use iva_sweep::sampling::Swept;
use iva_sweep::study::Study;
use iva_sweep::units::UnitSystem;

use self::neighbourhoods::Neighbourhoods;
use crate::cell::{aligned, number, short, significant, text};
use crate::layout::{TextTable, wrap};
use crate::scene::NOTHING_MOVES;
use crate::shown::Shown;

/// Advice under a table of several best points.
const LUCK: &str = "A single best row is often luck: look at its neighbours (iva.robust in Python), and sweep \
    restitution and the start as well.";
/// Most rows of the table of the best neighbourhoods.
const NEIGHBOURHOODS: usize = 5;

/// Columns shown beside the ranked one in a free decay, where there is room.
const BESIDE_DECAY: [&str; 4] =
    ["settling_time_5", "damping_ratio_3", "residual_amplitude", "impacts"];
/// Columns shown beside the ranked one under force, where there is room.
const BESIDE_DRIVEN: [&str; 4] = ["amplitude_max", "reduction", "impacts_per_cycle", "impacts"];

/// Columns that are left out for a structure without absorber.
const OF_ABSORBER: [&str; 3] = ["reduction", "impacts_per_cycle", "impacts"];

/// A row of the table of best points.
#[derive(Debug, Clone)]
struct Row {
    point: u64,
    value: Option<f64>,
    impacts: Option<f64>,
    beside: Vec<Option<f64>>,
}

/// The best points of a sweep, collected batch by batch.
#[derive(Debug)]
pub struct BestPoints {
    best_by: &'static str,
    better: Better,
    count: usize,
    beside: Vec<&'static Column>,
    rows: Vec<Row>,
    near: Option<Neighbourhoods>,
    points: u64,
    idle: u64,
    without_value: u64,
    unfinished: BTreeMap<String, u64>,
}

impl BestPoints {
    /// An empty collection; `None` if the report ranks by no measure.
    pub fn new(report: &Report, study: &Study) -> Option<Self> {
        let best_by = report.best_by?;
        let better = ranked().find(|column| column.name == best_by)?.better?;
        let driven = study.spec(0).is_ok_and(|spec| spec.is_driven());
        let shown = if driven { BESIDE_DRIVEN } else { BESIDE_DECAY };
        let alone = study.spec.choices().kind == Kind::None;
        let beside = SUMMARY
            .iter()
            .filter(|column| {
                shown.contains(&column.name)
                    && column.name != best_by
                    && !(alone && OF_ABSORBER.contains(&column.name))
                    && study.measures.contains(column.name)
            })
            .collect();
        Some(Self {
            best_by,
            better,
            count: report.count,
            beside,
            rows: Vec::new(),
            near: Neighbourhoods::of(&study.sampling, better).filter(|_| !alone),
            points: 0,
            idle: 0,
            without_value: 0,
            unfinished: BTreeMap::new(),
        })
    }

    /// Adds rows of the summary table.
    pub fn add(&mut self, summary: &RecordBatch) {
        for index in 0..summary.num_rows() {
            self.points += 1;
            let outcome = text(summary, "outcome", index).unwrap_or("finished");
            if outcome != "finished" {
                // A run that was cut short may look quiet only because it is short.
                *self.unfinished.entry(outcome.to_owned()).or_default() += 1;
                continue;
            }
            let value = number(summary, self.best_by, index).filter(|value| !value.is_nan());
            // A whole number below 2^32 is exact.
            let point = number(summary, "point", index).map_or(0, |point| point as u64);
            if let Some(near) = &mut self.near {
                near.set(point, value);
            }
            self.without_value += u64::from(value.is_none());
            let beside =
                self.beside.iter().map(|column| number(summary, column.name, index)).collect();
            let impacts = number(summary, "impacts", index);
            self.idle += u64::from(impacts == Some(0.0));
            self.rows.push(Row { point, value, impacts, beside });
        }
        let better = self.better;
        // Points without a value come last, equal values in the order of the points.
        self.rows.sort_by(|a, b| {
            let order = match (a.value, b.value, better) {
                (Some(a), Some(b), Better::Smaller) => a.total_cmp(&b),
                (Some(a), Some(b), Better::Larger) => b.total_cmp(&a),
                (a, b, _) => a.is_none().cmp(&b.is_none()),
            };
            order.then(a.point.cmp(&b.point))
        });
        self.rows.truncate(self.count);
    }

    /// The numbers of the best points, best first.
    pub fn points(&self) -> impl Iterator<Item = u64> + '_ {
        self.rows.iter().map(|row| row.point)
    }

    /// The table of best points with remarks on points it leaves out, in lines of at most 80 characters.
    pub fn print(&self, study: &Study, units: UnitSystem) -> String {
        let mut out = String::new();
        let ranked: u64 = self.points - self.unfinished.values().sum::<u64>();
        let order = match self.better {
            Better::Smaller => "smallest first",
            Better::Larger => "largest first",
        };
        if self.rows.iter().any(|row| row.value.is_some()) {
            let heading = format!(
                "Best {} of {} by {} ({order}):",
                self.rows.len(),
                counted(self.points, "point"),
                self.best_by
            );
            let _ = writeln!(out, "{}\n", wrap(&heading));
            let shown = Shown::of(study, units);
            out.push_str(&self.table(study, shown).print());
            out.push('\n');
            if self.rows.len() > 1 && study.spec.choices().kind != Kind::None {
                let _ = writeln!(out, "{}", wrap(LUCK));
            }
            self.print_neighbourhoods(study, shown, &mut out);
        }
        self.remark_idle(study, &mut out);
        if self.without_value > 0 {
            let sentence = format!(
                "{} of {} that finished {} no {}{}.",
                self.without_value,
                counted(ranked, "point"),
                if self.without_value == 1 { "has" } else { "have" },
                self.best_by,
                why_none(self.best_by)
            );
            let _ = writeln!(out, "{}", wrap(&sentence));
        }
        if self.unfinished.is_empty() {
            let _ = writeln!(out, "Every point finished.");
        } else {
            let outcomes: Vec<String> = self
                .unfinished
                .iter()
                .map(|(outcome, count)| format!("{count} {outcome}"))
                .collect();
            let sentence = format!(
                "{} did not finish and {} not ranked: {}.",
                counted(self.points - ranked, "point"),
                if self.points - ranked == 1 { "is" } else { "are" },
                outcomes.join(", ")
            );
            let _ = writeln!(out, "{}", wrap(&sentence));
        }
        let _ = writeln!(out, "{}", wrap(&format!("{}.", first_upper(units.sentence()))));
        out
    }

    /// Adds a remark if nothing moves or the absorber never touches a wall.
    fn remark_idle(&self, study: &Study, out: &mut String) {
        let shown = self.rows.iter().filter(|row| row.impacts == Some(0.0)).count() as u64;
        let sentence = if study.design(0).is_ok_and(|design| design.scene.at_rest()) {
            NOTHING_MOVES.to_owned()
        } else if study.spec.choices().kind == Kind::None {
            return;
        } else if self.idle > 0 && self.idle == self.points {
            "The absorber never touches a wall at any of the points: check the gap and the start."
                .to_owned()
        } else if shown > 0 {
            format!(
                "At {} of these the absorber never touches a wall: it does nothing there.",
                counted(shown, "point")
            )
        } else {
            return;
        };
        let _ = writeln!(out, "{}", wrap(&sentence));
    }

    /// Adds the points whose worst neighbour is the best, where the points are a grid.
    fn print_neighbourhoods(&self, study: &Study, shown: Shown, out: &mut String) {
        let Some(near) = &self.near else { return };
        let best = near.best(self.count.min(NEIGHBOURHOODS));
        if best.len() < 2 {
            return;
        }
        let starts = if near.has_starts() { ", at any start" } else { "" };
        let heading = format!(
            "Best {} by the worst {} among a point and those next to it on the axes{starts}:",
            best.len(),
            self.best_by
        );
        let _ = writeln!(out, "\n{}\n", wrap(&heading));
        let chosen = |swept: Swept<'_>| swept.slot.info().part != Part::Start;
        let mut table = swept(study, shown, best.iter().map(|(point, _)| *point), chosen);
        let values = best.iter().map(|(_, value)| cell(Some(*value), self.ranked(), shown));
        let heading = format!("worst {}", self.best_by);
        table.push(&heading, shown.unit(self.ranked()), values.collect());
        out.push_str(&table.print());
        out.push('\n');
    }

    /// The quantity of the ranked measure.
    fn ranked(&self) -> Quantity {
        let column = SUMMARY.iter().find(|column| column.name == self.best_by);
        column.map_or(Quantity::Ratio, |column| column.quantity)
    }

    fn table(&self, study: &Study, shown: Shown) -> TextTable {
        let mut table = swept(study, shown, self.points(), |_| true);
        let values = self.rows.iter().map(|row| cell(row.value, self.ranked(), shown));
        table.push(self.best_by, shown.unit(self.ranked()), values.collect());
        for (position, column) in self.beside.iter().enumerate() {
            let quantity = column.quantity;
            let values = self.rows.iter().map(|row| cell(row.beside[position], quantity, shown));
            table.push_optional(column.name, shown.unit(quantity), values.collect());
        }
        table
    }
}

/// A table of points with those of their swept values that are told.
fn swept(
    study: &Study,
    shown: Shown,
    points: impl Iterator<Item = u64>,
    told: impl Fn(Swept<'_>) -> bool,
) -> TextTable {
    let mut table = TextTable::default();
    let points: Vec<u64> = points.collect();
    table.push_optional("point", "", points.iter().map(u64::to_string).collect());
    let rows: Vec<Vec<f64>> = points.iter().map(|point| study.swept(*point)).collect();
    for (position, swept) in study.sampling.keys().enumerate() {
        if !told(swept) {
            continue;
        }
        let values: Vec<f64> = rows.iter().map(|values| values[position]).collect();
        let unit = shown.unit_of_axis(swept.slot.info().quantity);
        table.push(swept.key, unit, aligned(&values, 6));
    }
    table
}

/// A value of a measure as it is printed.
fn cell(value: Option<f64>, quantity: Quantity, shown: Shown) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if quantity == Quantity::Count => short(value, 15),
        Some(value) => significant(shown.value(quantity, value), 4),
    }
}

/// The reason why a finished run may have no value of a ranked measure, in brackets.
fn why_none(measure: &str) -> &'static str {
    match measure {
        "residual_amplitude" | "damping_ratio_energy" => {
            " (the run is shorter than a period, or under force)"
        }
        "transmissibility" => " (the base does not move)",
        "amplitude_max" | "amplitude_rms" | "reduction" => " (no force)",
        name if name.starts_with("settling_time") => " (not settled by the end of the run)",
        _ => " (fewer peaks than it needs)",
    }
}

/// The measures of a single run, one a line, then the names of those without a value.
pub fn print_run(summary: &RecordBatch, study: &Study, units: UnitSystem) -> String {
    let shown = Shown::of(study, units);
    let mut out = String::new();
    let mut undefined = Vec::new();
    for column in SUMMARY {
        if !study.measures.contains(column.name) {
            continue;
        }
        let value = match (number(summary, column.name, 0), text(summary, column.name, 0)) {
            (Some(value), _) if column.quantity == Quantity::Count => short(value, 15),
            (Some(value), _) => significant(shown.value(column.quantity, value), 6),
            (None, Some(text)) => text.to_owned(),
            (None, None) => {
                undefined.push(column.name);
                continue;
            }
        };
        let unit = shown.unit(column.quantity);
        let line = format!("{:22}{value:>14}  {unit}", column.name);
        let _ = writeln!(out, "{}", line.trim_end());
    }
    if !undefined.is_empty() {
        let sentence = format!("This run has no {}.", undefined.join(", "));
        let _ = writeln!(out, "\n{}", wrap(&sentence));
    }
    let _ = writeln!(out, "\n{}", wrap(&format!("{}.", first_upper(units.sentence()))));
    out
}

/// A count with its noun in the singular or plural: `1 point`, `2 points`.
pub(crate) fn counted(count: u64, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

#[cfg(test)]
mod tests;
