//! Bound on the truncation error of the series of several pendulums on one structure, as in [`super`].
//!
//! The pendulums meet in the equation of a alone: its defect ρ is the sum of what each lacks, and the error of the gap of one
//! reaches that of another through a. So Λ has a row and a column for the structure and for each gap, and
//! (1 − Λ/(N+2))⁻¹ δ is found by elimination. Λ has no negative entry, so the bound holds where all pivots are positive:
//! then the matrix is an M-matrix (A. Berman and R. J. Plemmons, *Nonnegative matrices in the mathematical sciences*, 1979).
//! What is stuck to the structure adds to its mass.

use super::{MARGIN, NEIGHBOURHOOD, Own, Slopes, Sums, WIDER, by_primary, power};
use crate::number::real::Real;
use crate::segment::taylor::{ORDER, Pendulum, Series};

/// Bound on the truncation errors of the series of several pendulums, of order [`ORDER`].
#[derive(Debug, Clone)]
pub(crate) struct RemainderOfSeveral<R> {
    /// The share of the step for which it was found.
    most: R,
    /// Bound on the error of (x, u) there.
    structure: R,
    /// Bounds on the error of (y, W/F) there, of each gap.
    gaps: Vec<R>,
    /// How much of the neighbourhood of the polynomials they need.
    within: R,
}

/// A pendulum with its series; what is stuck has no equation.
pub(crate) struct InFlight<'a, R> {
    pub pendulum: &'a Pendulum<R>,
    pub series: &'a Series<R>,
}

impl<R: Real> RemainderOfSeveral<R> {
    /// The bound for the series of a step of length h, up to `most` of it, of a structure with damping ratio ζ to which
    /// absorbers of mass ratio m are stuck: `carried` is (ζ, m). The other arguments are those of
    /// [`super::Remainder::new`]. `None` if nothing is proved.
    #[inline(always)]
    pub fn new(
        flying: &[InFlight<'_, R>],
        structure: &Series<R>,
        (damping_ratio, stuck): (R, R),
        fastest: R,
        (driven, h, most): ([R; 2], R, R),
    ) -> Option<Self> {
        let (length, n) = (h * most, R::from(ORDER as f64));
        let of_structure = Sums::new::<ORDER>(structure, most);
        let mut seen = Vec::with_capacity(flying.len());
        for it in flying {
            let sums = Sums::new::<ORDER>(it.series, most);
            let own = Own::new(it.pendulum, &sums, length, ORDER);
            seen.push((sums, own));
        }
        let freed = |it: &InFlight<'_, R>| {
            it.pendulum.mass_ratio * (R::ONE - R::ONE / it.pendulum.inertia_ratio)
        };
        let inertia = flying.iter().fold(R::ONE + stuck, |sum, it| sum + freed(it));
        let over_inertia = R::from(WIDER) / inertia;
        let residual = seen.iter().fold(R::ZERO, |sum, (_, own)| sum + own.pulled)
            + of_structure.x_last
            + damping_ratio * 2.0 * of_structure.u_last
            + driven[0];
        let acceleration = residual * over_inertia;
        let pushed = (of_structure.a + acceleration, over_inertia);
        let mut slopes = Vec::with_capacity(flying.len());
        for (it, (sums, _)) in flying.iter().zip(&seen) {
            slopes.push(Slopes::new(it.pendulum, sums, pushed, (fastest, length)));
        }

        // Rows and columns: the structure, then the gaps.
        let count = flying.len() + 1;
        let growth = length / (n + 2.0);
        let by_primary = by_primary(damping_ratio, over_inertia);
        let wide = R::from(WIDER);
        let entry = |row: usize, column: usize| {
            let through_a = match column.checked_sub(1) {
                None => by_primary,
                Some(from) => slopes[from].by_gap,
            };
            let Some(to) = row.checked_sub(1) else {
                return if column == 0 { R::larger(R::ONE, by_primary) } else { through_a };
            };
            let pendulum = flying[to].pendulum;
            if row == column {
                let Slopes { swung, own, .. } = slopes[to];
                return R::larger(swung, own / fastest + pendulum.pivot_damping);
            }
            pendulum.coupling * through_a * wide / fastest
        };
        let mut kept = Vec::with_capacity(count * count);
        for row in 0..count {
            for column in 0..count {
                let one = if row == column { R::ONE } else { R::ZERO };
                kept.push(one - entry(row, column) * growth);
            }
        }
        let begin = R::larger(length * of_structure.u_last, length * (acceleration + driven[1]));
        let mut errors = Vec::with_capacity(count);
        errors.push(begin);
        for (it, (_, own)) in flying.iter().zip(&seen) {
            errors.push(own.delta(it.pendulum, acceleration, length, fastest));
        }
        solve(&mut kept, &mut errors)?;
        let scale = R::from(MARGIN) / (n + 1.0);
        let mut errors = errors.into_iter().map(|error| error * scale);
        let structure = errors.next()?;
        let gaps: Vec<R> = errors.collect();

        // Within the neighbourhood, as for one pendulum.
        let shaken = slopes
            .iter()
            .zip(&gaps)
            .fold(by_primary * structure, |sum, (slopes, gap)| sum + slopes.by_gap * *gap);
        let mut within = R::ZERO;
        let mut off_circle = R::ZERO;
        for ((it, (_, own)), gap) in flying.iter().zip(&seen).zip(&gaps) {
            let over_b = R::ONE / it.pendulum.contact_distance;
            off_circle += own.off_circle(it.pendulum);
            for size in [*gap * fastest * over_b, shaken * it.pendulum.coupling * over_b] {
                within = R::larger(within, size / NEIGHBOURHOOD);
            }
        }
        let within = R::larger(within, off_circle);
        (within < R::INFINITY).then_some(Self { most, structure, gaps, within })
    }

    /// The share of the step for which it was found.
    pub fn most(&self) -> R {
        self.most
    }

    /// By how much the bounds up to a share exceed what is allowed: of the error of (x, u), and of that of each gap. They hold,
    /// and nothing exceeds, where it is at most 1.
    pub fn excess(&self, share: R, structure: R, gaps: &[R]) -> R {
        let gaps = self.gaps.iter().zip(gaps).map(|(gap, allowed)| *gap / *allowed);
        let worst = gaps.fold(self.structure / structure, R::larger);
        R::larger(worst, self.within) * power(share / self.most, ORDER + 1)
    }
}

/// Solves K e = δ in the place of δ by elimination, the rows of K one after the other; `None` if a pivot is not positive.
fn solve<R: Real>(kept: &mut [R], errors: &mut [R]) -> Option<()> {
    let count = errors.len();
    for k in 0..count {
        let (above, below) = kept.split_at_mut((k + 1) * count);
        let pivots = &above[k * count..];
        if pivots[k] <= 0.0 || pivots[k].is_nan() {
            return None;
        }
        for (row, entries) in below.chunks_exact_mut(count).enumerate() {
            let factor = entries[k] / pivots[k];
            for (entry, pivot) in entries.iter_mut().zip(pivots).skip(k + 1) {
                *entry -= factor * *pivot;
            }
            let part = factor * errors[k];
            errors[k + 1 + row] -= part;
        }
    }
    for k in (0..count).rev() {
        let row = &kept[k * count..(k + 1) * count];
        let known = row.iter().zip(errors.iter()).skip(k + 1);
        let known = known.fold(errors[k], |sum, (entry, error)| sum - *entry * *error);
        errors[k] = known / row[k];
    }
    Some(())
}
