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
    pub fn new(
        flying: &[InFlight<'_, R>],
        structure: &Series<R>,
        (damping_ratio, stuck): (R, R),
        fastest: R,
        (driven, h, most): ([R; 2], R, R),
    ) -> Option<Self> {
        let (length, n) = (h * most, R::from(ORDER as f64));
        let sums: Vec<Sums<R>> =
            flying.iter().map(|it| Sums::new::<ORDER>(it.series, most)).collect();
        let of_structure = Sums::new::<ORDER>(structure, most);
        let own =
            |(it, sums): (&InFlight<'_, R>, &Sums<R>)| Own::new(it.pendulum, sums, length, ORDER);
        let own: Vec<Own<R>> = flying.iter().zip(&sums).map(own).collect();
        let freed = |it: &InFlight<'_, R>| {
            it.pendulum.mass_ratio * (R::ONE - R::ONE / it.pendulum.inertia_ratio)
        };
        let inertia = flying.iter().fold(R::ONE + stuck, |sum, it| sum + freed(it));
        let over_inertia = R::from(WIDER) / inertia;
        let residual = own.iter().fold(R::ZERO, |sum, it| sum + it.pulled)
            + of_structure.x_last
            + damping_ratio * 2.0 * of_structure.u_last
            + driven[0];
        let acceleration = residual * over_inertia;
        let pushed = (of_structure.a + acceleration, over_inertia);
        let slopes = |(it, sums): (&InFlight<'_, R>, &Sums<R>)| {
            Slopes::new(it.pendulum, sums, pushed, (fastest, length))
        };
        let slopes: Vec<Slopes<R>> = flying.iter().zip(&sums).map(slopes).collect();

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
        let mut kept: Vec<Vec<R>> = (0..count)
            .map(|row| {
                let one = |column: usize| if row == column { R::ONE } else { R::ZERO };
                (0..count).map(|column| one(column) - entry(row, column) * growth).collect()
            })
            .collect();
        let begin = R::larger(length * of_structure.u_last, length * (acceleration + driven[1]));
        let mut errors = vec![begin];
        errors.extend(
            flying
                .iter()
                .zip(&own)
                .map(|(it, own)| own.delta(it.pendulum, acceleration, length, fastest)),
        );
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
        for ((it, own), gap) in flying.iter().zip(&own).zip(&gaps) {
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

/// Solves K e = δ in the place of δ by elimination; `None` if a pivot is not positive.
fn solve<R: Real>(kept: &mut [Vec<R>], errors: &mut [R]) -> Option<()> {
    for k in 0..errors.len() {
        let (above, below) = kept.split_at_mut(k + 1);
        let pivots = &above[k];
        if pivots[k] <= 0.0 || pivots[k].is_nan() {
            return None;
        }
        for (row, entries) in below.iter_mut().enumerate() {
            let factor = entries[k] / pivots[k];
            for (entry, pivot) in entries.iter_mut().zip(pivots).skip(k + 1) {
                *entry -= factor * *pivot;
            }
            let part = factor * errors[k];
            errors[k + 1 + row] -= part;
        }
    }
    for k in (0..errors.len()).rev() {
        let known = kept[k].iter().zip(errors.iter()).skip(k + 1);
        let known = known.fold(errors[k], |sum, (entry, error)| sum - *entry * *error);
        errors[k] = known / kept[k][k];
    }
    Some(())
}
