//! Lyapunov exponents: the mean rates at which neighbouring motions separate, from the exact derivatives of cycle after cycle.
//!
//! As many small differences as a state has numbers are carried along a trajectory and made orthogonal after each cycle (QR), as G.
//! Benettin et al. (Meccanica 15 (1980) 9–30) do for smooth systems; impacts are in the derivatives. The last difference has what the
//! others leave of the determinant of the derivative, where that is known more exactly than the difference itself: next to a grazing.
//! Without rides the sum of the exponents of a free mass is
//! 2 ln e times the number of impacts per time, less 2 ζ, in every run however short: how far the sum found is from that is part
//! of the result.
//!
//! A ride takes two dimensions: the absorber leaves its wall at rest, wherever it has come from. With a ride in the
//! cycles that count two exponents are −∞, four where two absorbers ride at once. A plastic impact, after which the absorber leaves
//! at once, takes one, and so does friction that holds an absorber.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::AtomicBool;

use nalgebra::{DMatrix, DVector};

use super::{Derived, Image, Iterated, Request, Trajectory, iterate};
use crate::engine::simulate::Outcome;
use crate::error::Invalid;

/// Number of blocks that each trajectory is divided into, for standard errors.
const BLOCKS: u64 = 16;
/// Most cycles of a trajectory.
const MOST_CYCLES: u64 = 1 << 40;

/// Which cycles of a trajectory are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Number of cycles that are left out first.
    pub discard: u64,
    /// Number of cycles that follow.
    pub keep: u64,
}

/// The Lyapunov exponents of an attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// The exponents, in ωn, largest first, one of each number of a state; −∞ for what rides and plastic impacts take away. NaN if no
    /// cycle was completed.
    pub exponents: Vec<f64>,
    /// Their standard errors: from the means of blocks of cycles or, if that is larger, from those of whole trajectories. NaN from less
    /// than two blocks, 0 where the exponent is −∞.
    pub standard_errors: Vec<f64>,
    /// The sum of the exponents less 2 ln e times the number of impacts per time, plus 2 ζ: rounding. Of the trajectory
    /// where it is largest; `None` if there are rides, for plastic impacts, unlike walls, or a pendulum.
    pub sum_error: Option<f64>,
    /// Mean number of listed impacts in a cycle. Without rides all impacts are listed; with rides their number depends on
    /// the floor, [`Limits::chatter_floor`](crate::engine::simulate::Limits::chatter_floor).
    pub impacts: f64,
    /// Its standard error.
    pub impacts_error: f64,
    /// Number of rides in the cycles that count.
    pub rides: u64,
    /// Number of cycles that count, of all trajectories together.
    pub cycles: u64,
    /// How the first trajectory ended that did not come to the end of its window; else [`Outcome::Finished`].
    pub outcome: Outcome,
}

impl Spectrum {
    /// The dimension of the attractor in the section of the strobe after J. L. Kaplan and J. A. Yorke (1979): the number of exponents, largest
    /// first, whose sum is not yet negative, and the share of the next one that makes it zero.
    pub fn dimension(&self) -> f64 {
        let mut sum = 0.0;
        for (count, exponent) in self.exponents.iter().enumerate() {
            if sum + exponent < 0.0 {
                return count as f64 + sum / exponent.abs();
            }
            sum += exponent;
        }
        self.exponents.len() as f64
    }
}

/// Makes the columns of a matrix orthonormal, one after the other (E. Schmidt, modified); the logarithms of their lengths before.
fn orthonormal(matrix: &mut DMatrix<f64>) -> Vec<f64> {
    let mut logs = vec![f64::NEG_INFINITY; matrix.ncols()];
    for (j, log) in logs.iter_mut().enumerate() {
        let mut column: DVector<f64> = matrix.column(j).into();
        for i in 0..j {
            let other = matrix.column(i);
            column -= other * other.dot(&column);
        }
        let length = column.norm();
        if length > 0.0 {
            *log = length.ln();
            column /= length;
        }
        matrix.set_column(j, &column);
    }
    logs
}

/// Replaces the last columns of a matrix so that all are orthonormal.
fn complete(matrix: &mut DMatrix<f64>, last: usize) {
    let count = matrix.ncols();
    matrix.columns_mut(count - last, last).fill(0.0);
    for j in count - last..count {
        let left = DMatrix::identity(count, count) - &*matrix * matrix.transpose();
        // Of the unit vectors that with the longest part across the columns before.
        let column = left.column(left.diagonal().imax()).normalize();
        matrix.set_column(j, &column);
    }
}

/// Sums over cycles.
#[derive(Debug, Clone, Default)]
struct Sums {
    logs: Vec<f64>,
    impacts: u64,
    rides: u64,
    cycles: u64,
}

impl Sums {
    fn plus(mut self, other: &Self) -> Self {
        self.logs.resize(self.logs.len().max(other.logs.len()), 0.0);
        self.logs.iter_mut().zip(&other.logs).for_each(|(sum, log)| *sum += log);
        self.impacts += other.impacts;
        self.rides += other.rides;
        self.cycles += other.cycles;
        self
    }

    /// The means per time of so many logarithms, and per cycle of the impacts.
    fn means(&self, count: usize, length: f64) -> Vec<f64> {
        let cycles = self.cycles as f64;
        let mean = |k: usize| self.logs.get(k).map_or(f64::NAN, |log| log / (cycles * length));
        (0..count).map(mean).chain([self.impacts as f64 / cycles]).collect()
    }
}

/// What the differences of a trajectory have come to.
#[derive(Debug, Clone)]
pub struct Carried {
    differences: DMatrix<f64>,
    seen: u64,
    blocks: Vec<Sums>,
    /// The number of dimensions that rides or plastic impacts in a cycle that counts have taken.
    lost: usize,
    outcome: Outcome,
}

impl Carried {
    /// Of numbers that are those of fewer dimensions the last tell the others.
    fn new([numbers, dimension]: [usize; 2]) -> Self {
        let outcome = Outcome::Cancelled;
        let mut differences = DMatrix::zeros(numbers, numbers);
        for column in 0..numbers {
            differences[((column + dimension) % numbers, column)] = 1.0;
        }
        Self { differences, seen: 0, blocks: vec![], lost: 0, outcome }
    }

    /// Carries the differences through one more cycle.
    fn take<State>(
        &mut self,
        image: &Image<State>,
        window: Window,
        dimension: usize,
    ) -> ControlFlow<()> {
        self.outcome = image.outcome;
        let Image { tangent: Some(Derived { matrix, volume, lost }), outcome, .. } = image else {
            return Break(());
        };
        if *outcome != Outcome::Finished {
            return Break(());
        }
        self.differences = matrix * &self.differences;
        let mut logs = orthonormal(&mut self.differences);
        let count = logs.len();
        if let Some(volume) = volume.filter(|it| it.abs() >= f64::MIN_POSITIVE) {
            logs[count - 1] = volume.abs().ln() - logs[..count - 1].iter().sum::<f64>();
        }
        let counts = self.seen >= window.discard;
        let taken = count.min(count - dimension + lost);
        if counts {
            self.lost = self.lost.max(taken);
        }
        let lost = self.lost.max(taken);
        if lost > 0 {
            // What rounding has left of the differences that are lost.
            logs[count - lost..].fill(f64::NEG_INFINITY);
            complete(&mut self.differences, lost);
        }
        if counts {
            let Image { impacts, rides, .. } = *image;
            let block = (self.seen - window.discard) * BLOCKS / window.keep;
            self.blocks.resize(block as usize + 1, Sums::default());
            let one = Sums { logs, impacts, rides, cycles: 1 };
            let last = &mut self.blocks[block as usize];
            *last = std::mem::take(last).plus(&one);
        }
        self.seen += 1;
        if self.seen < window.discard + window.keep { Continue(()) } else { Break(()) }
    }

    fn total(&self) -> Sums {
        self.blocks.iter().fold(Sums::default(), Sums::plus)
    }
}

/// The standard error of the mean of numbers; NaN of less than two.
fn standard_error(numbers: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = numbers.clone().count() as f64;
    let mean = numbers.clone().sum::<f64>() / count;
    let squares: f64 = numbers.map(|number| (number - mean).powi(2)).sum();
    (squares / ((count - 1.0) * count)).sqrt()
}

/// The exponents along trajectories of one scene from several starts, which go side by side. Cycles that are left out turn
/// the differences into their directions.
///
/// # Errors
/// [`Invalid`] if nothing is to be kept, or a cycle has no length or begins before time zero.
pub fn lyapunov<S: Iterated>(
    trajectories: &[Trajectory<S>],
    window: Window,
    cancel: Option<&AtomicBool>,
) -> Result<Spectrum, Invalid> {
    Ok(spectrum(trajectories, &carried(trajectories, window, cancel)?))
}

/// The differences along trajectories of one scene, for [`spectrum`]. Trajectories may be divided among several calls in any way.
///
/// # Errors
/// As [`lyapunov`].
pub fn carried<S: Iterated>(
    trajectories: &[Trajectory<S>],
    window: Window,
    cancel: Option<&AtomicBool>,
) -> Result<Vec<Carried>, Invalid> {
    if window.keep == 0
        || window.discard.checked_add(window.keep).is_none_or(|all| all > MOST_CYCLES)
    {
        let rule = format!("keep at least 1 cycle, and run at most {MOST_CYCLES}");
        return Err(Invalid::new("window.keep", window.keep.to_string(), rule));
    }
    let dimension = |index: usize| trajectories[index].system.dimension();
    let numbers = |it: &Trajectory<S>| it.system.point(&it.state).len();
    let sizes = trajectories.iter().map(|it| [numbers(it), it.system.dimension()]);
    let mut all: Vec<Carried> = sizes.map(Carried::new).collect();
    let request = Request { tangents: true, cancel };
    iterate(trajectories, request, &mut |index, image| {
        all[index].take(image, window, dimension(index))
    })?;
    Ok(all)
}

/// The exponents of trajectories, with the differences that were carried along them in the same order.
pub fn spectrum<S: Iterated>(trajectories: &[Trajectory<S>], all: &[Carried]) -> Spectrum {
    let length = trajectories.first().map_or(f64::NAN, |first| first.cycle.length);
    let count = all.first().map_or(4, |first| first.differences.ncols());
    let total = all.iter().map(Carried::total).fold(Sums::default(), |sums, one| sums.plus(&one));
    let means = total.means(count, length);
    let blocks: Vec<_> =
        all.iter().flat_map(|one| &one.blocks).map(|sums| sums.means(count, length)).collect();
    let wholes: Vec<_> = all.iter().map(|one| one.total().means(count, length)).collect();
    let error = |k: usize| {
        if means[k] == f64::NEG_INFINITY {
            return 0.0;
        }
        let [within, between] =
            [&blocks, &wholes].map(|of| standard_error(of.iter().map(|it| it[k])));
        f64::max(within, between)
    };
    let begun = trajectories.iter().zip(all).filter(|(_, one)| one.total().cycles > 0);
    let sum_errors = begun.map(|(trajectory, one)| {
        let Sums { logs, impacts, rides, cycles } = one.total();
        let time = cycles as f64 * length;
        let known = trajectory.system.known_log_volume(time, impacts);
        let known = known.filter(|known| rides == 0 && known.is_finite())?;
        Some((logs.iter().sum::<f64>() - known) / time)
    });
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let sum_errors: Option<Vec<f64>> = sum_errors.collect();
    let mut ranked: Vec<_> = (0..count).map(|k| (means[k], error(k))).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let unfinished = all.iter().map(|one| one.outcome).find(|it| *it != Outcome::Finished);
    let (exponents, standard_errors) = ranked.into_iter().unzip();
    Spectrum {
        exponents,
        standard_errors,
        sum_error: sum_errors.and_then(|them| them.into_iter().reduce(larger)),
        impacts: means[count],
        impacts_error: error(count),
        rides: total.rides,
        cycles: total.cycles,
        outcome: unfinished.unwrap_or(Outcome::Finished),
    }
}
