//! `iva check`: is the study valid, how large is it, how long will it take?

use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use iva_sweep::motion::trajectory;
use iva_sweep::study::Table;
use iva_sweep::sweep::{Control, Workers, sweep};
use iva_sweep::tables::schema;

use crate::args::CheckArgs;
use crate::cell::duration;
use crate::error::Error;
use crate::layout::{first_upper, wrap};
use crate::output::PART_POINTS;
use crate::progress::Progress;
use crate::report::counted;
use crate::run_study::{size, without_trajectory};
use crate::scene::describe;
use crate::study_file::{StudyFile, read_study};
use crate::table_file::encoded_size;

/// Points run for the estimate. A grid of up to twice as many is run whole.
const SAMPLES: u64 = 48;
/// No further sample is started after this time.
const PATIENCE: Duration = Duration::from_secs(3);

/// Returns what is to be printed.
///
/// # Errors
/// Anything [`read_study`] and [`StudyFile::validate`] refuse.
pub(crate) fn check_command(args: &CheckArgs) -> Result<String, Error> {
    let file = read_study(&args.study)?;
    let located = |invalid| file.source.locate(&invalid);
    let points = file.study.points().map_err(located)?;
    let progress = Progress::new("checking", points, false);
    file.validate(&Workers::new(None)?, &AtomicBool::new(false), &|count| progress.add(count))?;
    progress.clear();
    let units = file.study.units().map_err(located)?;
    let estimate = estimate(&file, points)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = points.min(cores as u64);
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{} is valid.", args.study.display());
    let lengths: Vec<String> =
        file.study.axes.iter().map(|axis| format!("{} {}", axis.values.len(), axis.key)).collect();
    let grid = match lengths.as_slice() {
        [] => "Points: 1 (no [sweep]: for `iva run`)".to_owned(),
        lengths => format!("Points: {points} ({})", lengths.join(" × ")),
    };
    let _ = writeln!(out, "{}", wrap(&grid));
    let _ = writeln!(out, "{}", wrap(&format!("{}.", first_upper(units.sentence()))));
    out.push_str(&describe(&file.study, points, units));
    let seconds = estimate.seconds / threads as f64;
    let _ = writeln!(out, "Time: {} on {}", duration(seconds), counted(threads, "thread"));
    let total: f64 = estimate.sizes.iter().map(|(_, bytes)| bytes).sum();
    let _ = writeln!(out, "Size: about {} as Parquet", size(total));
    for (table, bytes) in &estimate.sizes {
        let _ = writeln!(out, "  {:12} {}", format!("{table}/"), size(*bytes));
    }
    let basis = if estimate.samples == points {
        "Time and size are from a run of every point; nothing was written.".to_owned()
    } else {
        format!(
            "Time and size are scaled up from {} spread over the grid; nothing was written.",
            counted(estimate.samples, "point")
        )
    };
    let _ = writeln!(out, "{}", wrap(&basis));
    Ok(out)
}

struct Estimate {
    samples: u64,
    /// On one thread, for the whole study.
    seconds: f64,
    /// Bytes of each table.
    sizes: Vec<(Table, f64)>,
}

fn estimate(file: &StudyFile, points: u64) -> Result<Estimate, Error> {
    let study = without_trajectory(&file.study);
    let located = |invalid| file.source.locate(&invalid);
    let cancel = AtomicBool::new(false);
    let workers = Workers::new(Some(1))?;
    let control = Control { workers: &workers, chunk: None, cancel: &cancel, progress: &|_| {} };
    let wanted = samples_of(points);
    let start = Instant::now();
    let mut seconds = 0.0;
    let mut samples = 0;
    let mut batches = Vec::new();
    for sample in 0..wanted {
        let point = spread(sample, wanted, points);
        let before = Instant::now();
        batches.push(
            sweep(&study, point..point + 1, &control)
                .map_err(|error| file.source.locate_sweep(error))?,
        );
        seconds += before.elapsed().as_secs_f64();
        samples += 1;
        if start.elapsed() > PATIENCE {
            break;
        }
    }
    let factor = points as f64 / samples as f64;
    let parts = points.div_ceil(PART_POINTS) as f64;
    let mut sizes = Vec::new();
    for table in &study.tables {
        let schema = schema(&study, *table).map_err(located)?;
        let rows: Vec<_> = batches.iter().filter_map(|tables| tables.get(table).cloned()).collect();
        let empty = encoded_size(schema.clone(), &[])? as f64;
        let full = encoded_size(schema, &rows)? as f64;
        sizes.push((*table, parts * empty + factor * (full - empty)));
    }
    if file.study.tables.contains(&Table::Trajectory) {
        let before = Instant::now();
        let rows = trajectory(&file.study.spec, file.samples_per_period, &cancel)
            .map_err(|error| file.source.locate_sweep(error))?;
        seconds += before.elapsed().as_secs_f64();
        let schema = schema(&file.study, Table::Trajectory).map_err(located)?;
        sizes.push((Table::Trajectory, encoded_size(schema, &[rows])? as f64));
    }
    Ok(Estimate { samples, seconds: seconds * factor, sizes })
}

fn samples_of(points: u64) -> u64 {
    if points <= 2 * SAMPLES { points } else { SAMPLES }
}

/// The point of a sample: spread evenly, but off the period of any axis, and never the same twice.
fn spread(sample: u64, samples: u64, points: u64) -> u64 {
    if samples == points {
        return sample;
    }
    // A golden-ratio offset within each of the equal stretches of the grid.
    let offset = (sample as f64 * 0.618_033_988_749_894_9).fract();
    let stretch = points as f64 / samples as f64;
    (((sample as f64 + offset) * stretch) as u64).min(points - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_different_points_of_the_grid() {
        for points in [1, 2, 48, 95, 96, 97, 98, 444, 1 << 32] {
            let samples = samples_of(points);
            let chosen: Vec<u64> = (0..samples).map(|i| spread(i, samples, points)).collect();
            assert!(chosen.iter().all(|point| *point < points));
            assert!(chosen.windows(2).all(|pair| pair[0] < pair[1]), "{points}: {chosen:?}");
        }
    }
}
