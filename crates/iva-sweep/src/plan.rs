//! The division of a sweep into parts: pieces of a few seconds that are run and written one by one.
//!
//! The size of a part follows from the study alone, not from the machine: some points are run, and a fixed
//! time is assumed per unit of their work. So the same study has the same parts everywhere.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use crate::choices::Kind;
use crate::columns::columns;
use crate::done::Done;
use crate::error::Invalid;
use crate::fields::FieldId;
use crate::study::{Study, Table};
use crate::sweep::{Control, SweepError, Tables, Workers, sweep};

/// Largest number of points of a part: their summaries take some 70 MB in memory.
pub const MAX_PART_POINTS: u64 = 1 << 18;
/// Largest expected number of rows of a part in the tables other than the summary.
const PART_ROWS: f64 = (1 << 20) as f64;
/// Assumed time of a part on one core, in seconds.
const PART_SECONDS: f64 = 3.0;
/// Assumed time of a point, in seconds, apart from its motion.
const POINT_SECONDS: f64 = 4e-6;
/// Assumed time of a row in the tables other than the summary, in seconds.
const ROW_SECONDS: f64 = 0.4e-6;
/// Number of points that are run to estimate the work of a point.
const SAMPLES: u64 = 16;

/// Assumed time of a segment of motion, in seconds: as measured for each kind of scene.
fn segment_seconds(study: &Study) -> f64 {
    let spec = &study.spec;
    let absorbers: usize = (0..spec.count()).map(|number| spec.units_of(number)).sum();
    let sets = |field: FieldId| {
        let of_one = |number| spec.get_of(number, field).is_some_and(|it| it != 0.0);
        (0..spec.count()).any(of_one) || study.sampling.keys().any(|key| key.slot.field == field)
    };
    let pendulum = spec.choices().kind == Kind::Piva;
    let plain = if spec.structure().is_some()
        || sets(FieldId::GapDamping)
        || sets(FieldId::GapDampingRatio)
    {
        20e-6
    } else if absorbers > 1 && pendulum {
        8e-6
    } else if sets(FieldId::Friction) {
        5e-6
    } else if absorbers > 1 {
        2e-6
    } else if pendulum
        || spec.is_driven()
        || sets(FieldId::InclinationDeg)
        || sets(FieldId::Inclination)
    {
        1e-6
    } else {
        0.4e-6
    };
    if study.errors { 10.0 * plain } else { plain }
}

/// The results of a trial: some points spread over a study.
#[derive(Debug, Default)]
pub struct Trial {
    /// Points, failures and work.
    pub done: Done,
    /// The tables of each point.
    pub tables: Vec<Tables>,
}

impl Trial {
    /// Runs some points of a study. Unless `max_work` is swept, the work of a point is limited to that of a
    /// part: a point that exceeds it has the outcome `work_limit`.
    ///
    /// # Errors
    /// [`SweepError`] for an invalid point.
    pub fn run(study: &Study, workers: &Workers, cancel: &AtomicBool) -> Result<Self, SweepError> {
        let points = study.points()?;
        let samples = SAMPLES.min(points);
        let study = limited(study)?;
        let tried = workers
            .map(samples, |sample| one(&study, spread(sample, samples, points), workers, cancel));
        let mut trial = Self { done: Done::default(), tables: Vec::new() };
        for tried in tried {
            let (tables, done) = tried?;
            trial.done += done;
            trial.tables.push(tables);
        }
        Ok(trial)
    }

    /// Expected number of rows of a table per point.
    pub fn rows(&self, table: Table) -> f64 {
        let rows = |tables: &Tables| tables.get(&table).map_or(0, |rows| rows.num_rows());
        self.tables.iter().map(rows).sum::<usize>() as f64 / (self.done.points.max(1)) as f64
    }
}

/// Runs one point by itself.
fn one(
    study: &Study,
    point: u64,
    workers: &Workers,
    cancel: &AtomicBool,
) -> Result<(Tables, Done), SweepError> {
    let done = std::sync::Mutex::new(Done::default());
    let progress = |more: Done| {
        if let Ok(mut done) = done.lock() {
            *done += more;
        }
    };
    let control = Control { workers, chunk: Some(1), cancel, progress: &progress };
    let tables = sweep(study, point..point + 1, &control)?;
    Ok((tables, done.into_inner().unwrap_or_default()))
}

/// The study with the work of a point limited to that of a part.
fn limited(study: &Study) -> Result<Study, Invalid> {
    let mut study = study.clone();
    if !study.sampling.sets(FieldId::MaxWork.into()) {
        let most = (PART_SECONDS / segment_seconds(&study)).floor();
        let given = study.spec.get(FieldId::MaxWork).or(FieldId::MaxWork.default());
        study.spec.set(FieldId::MaxWork, given.map_or(most, |given| given.min(most)))?;
    }
    Ok(study)
}

/// The point of sample number `sample`: evenly spread, not in step with any axis, and each point at most
/// once.
pub fn spread(sample: u64, samples: u64, points: u64) -> u64 {
    if points < 2 * samples {
        // Too few points for an offset.
        return sample * points / samples;
    }
    // A golden-ratio offset within each of the equal parts of the study.
    let offset = (sample as f64 * 0.618_033_988_749_894_9).fract();
    let stretch = points as f64 / samples as f64;
    (((sample as f64 + offset) * stretch) as u64).min(points - 1)
}

/// The parts of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Number of points of the sweep.
    pub points: u64,
    /// Number of points of a part; the last part may have fewer.
    pub part_points: u64,
}

impl Plan {
    /// Parts of some seconds, from the results of a trial.
    ///
    /// # Errors
    /// As [`Study::points`].
    pub fn new(study: &Study, trial: &Trial) -> Result<Self, Invalid> {
        let tried = trial.done.points.max(1) as f64;
        let beside: f64 = Table::SWEEP[1..].iter().map(|table| trial.rows(*table)).sum();
        let seconds = POINT_SECONDS
            + segment_seconds(study) * trial.done.work as f64 / tried
            + ROW_SECONDS * beside;
        let wanted = (PART_SECONDS / seconds).min(PART_ROWS / beside);
        Ok(Self { points: study.points()?, part_points: part_points(wanted) })
    }

    /// Number of parts.
    pub fn parts(&self) -> u64 {
        self.points.div_ceil(self.part_points)
    }

    /// The points of a part.
    pub fn range(&self, part: u64) -> Range<u64> {
        let first = part * self.part_points;
        first..self.points.min(first + self.part_points)
    }
}

/// The largest power of two that is not above a number of points, so that similar studies have equal parts.
fn part_points(wanted: f64) -> u64 {
    let within = wanted.clamp(1.0, MAX_PART_POINTS as f64) as u64;
    1 << within.ilog2()
}

/// Memory of a row of a table, in bytes.
fn row_bytes(study: &Study, table: Table) -> u64 {
    let swept = if table == Table::Summary { study.sampling.keys().count() } else { 0 };
    // Eight bytes per number and one bit for null; flags and small numbers take less.
    let columns = columns(table).len() as u64 + swept as u64;
    // Polars keeps 16 more bytes for each text of a row; two texts are assumed in the summary.
    let words = if table == Table::Summary { 32 } else { 0 };
    4 + columns * 8 + columns.div_ceil(8) + words
}

/// Memory of the tables of a study, in bytes, estimated from a trial.
///
/// # Errors
/// As [`Study::points`].
pub fn memory(study: &Study, trial: &Trial) -> Result<f64, Invalid> {
    let points = study.points()? as f64;
    let rows = |table| if table == Table::Summary { 1.0 } else { trial.rows(table) };
    let bytes = |table: &Table| points * rows(*table) * row_bytes(study, *table) as f64;
    Ok(study.tables.iter().map(bytes).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_every_point_once() {
        for (points, part_points) in [(1, 1), (5, 2), (8, 4), (9, 4), (1 << 32, 1 << 18)] {
            let plan = Plan { points, part_points };
            assert_eq!(plan.range(0).start, 0);
            assert_eq!(plan.range(plan.parts() - 1).end, points);
            for part in 1..plan.parts().min(5) {
                assert_eq!(plan.range(part).start, plan.range(part - 1).end);
            }
        }
    }

    #[test]
    fn parts_have_powers_of_two_of_points() {
        for (wanted, points) in [
            (0.0, 1),
            (1.9, 1),
            (1000.0, 512),
            (1e9, MAX_PART_POINTS),
            (f64::INFINITY, MAX_PART_POINTS),
        ] {
            assert_eq!(part_points(wanted), points);
        }
    }

    #[test]
    fn samples_are_different_points() {
        for points in [1, 2, 15, 16, 17, 18, 444, 1 << 32] {
            let samples = SAMPLES.min(points);
            let chosen: Vec<u64> = (0..samples).map(|i| spread(i, samples, points)).collect();
            assert!(chosen.iter().all(|point| *point < points));
            assert!(chosen.windows(2).all(|pair| pair[0] < pair[1]), "{points}: {chosen:?}");
        }
    }
}
