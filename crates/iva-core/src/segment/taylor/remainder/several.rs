//! Bound on the truncation error of the series of several pendulums on one structure, as in [`super`], with the order N = [`LAST`].
//!
//! The structure has coordinates q with the velocities v. Their error is measured by max(Λ ‖q‖, ‖v‖), with a bound Λ on the growth of its
//! derivatives: ‖K q + D v‖ ≤ Λ max(Λ ‖q‖, ‖v‖), and pendulums only add to its inertia. A pendulum at a point of shape φ pulls at it with ‖φ‖ times the
//! defect of its own pull (`segment/taylor/pivoted.rs`, with γ in the place of c in what it feels of its pivot), and the error of the gap of one reaches that of another by the acceleration of its pivot.
//! So the matrix of the growth has a row and a column for the structure and for each gap, and (1 − Λ/(N+2))⁻¹ δ is found by elimination. It
//! has no negative entry, so the bound holds where all pivots are positive: then the matrix is an M-matrix
//! (A. Berman and R. J. Plemmons, *Nonnegative matrices in the mathematical sciences*, 1979).

use super::{MARGIN, NEIGHBOURHOOD, Own, Slopes, Sums, Swung, WIDER, power};
use crate::number::real::Real;
use crate::segment::taylor::{Growing, ORDER, ROOM};

/// The order of the bound: the structure, whose coordinates are known up to [`ORDER`], is known by its velocities up to this one.
pub(crate) const LAST: usize = ORDER - 1;

/// Bound on the truncation errors of the series of several pendulums.
#[derive(Debug, Clone)]
pub(crate) struct RemainderOfSeveral<R> {
    /// The share of the step for which it was found.
    most: R,
    /// Bounds on the error there: of the structure, then of (y, W/F) of each gap.
    errors: Vec<R>,
    /// How much of the neighbourhood of the polynomials they need.
    within: R,
}

/// A pendulum with its series, up to W of order [`LAST`].
pub(crate) struct InFlight<'a, R> {
    pub series: &'a Growing<'a, R, R, ROOM>,
    /// ‖φ‖ at its point.
    pub shape: R,
}

/// The structure as the bound sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaking<R> {
    /// Λ.
    pub growth: R,
    /// What its equations leave out of the forces on all coordinates beyond the orders below [`LAST`].
    pub forces: R,
    /// What is left out of the acceleration of the base.
    pub base: R,
}

impl<R: Real> RemainderOfSeveral<R> {
    /// The bound for the series of a step of length h, up to `most` of it; `fastest`: F, as in [`super::Remainder::new`]. `None` if nothing is proved.
    pub fn new(
        flying: &[InFlight<'_, R>],
        structure: &Shaking<R>,
        fastest: R,
        (h, most): (R, R),
    ) -> Option<Self> {
        let (length, n) = (h * most, R::from(LAST as f64));
        let of = |it: &InFlight<'_, R>| {
            let Growing { pendulum, y, w, c, a, .. } = it.series;
            let lean = &it.series.leans();
            let sums = Sums::new::<LAST, _>(Swung { y, w, c, a, lean }, most);
            let own = Own::new(pendulum, &sums, length, LAST);
            (sums, own)
        };
        let seen: Vec<(Sums<R>, Own<R>)> = flying.iter().map(of).collect();
        let wide = R::from(WIDER);
        let pulled = flying.iter().zip(&seen);
        let pulled = pulled.fold(R::ZERO, |sum, (it, (_, own))| it.shape.mul_add(own.pulled, sum));
        // That of all accelerations of the structure.
        let defect = (pulled + structure.forces) * wide;
        let at = |it: &InFlight<'_, R>| it.shape.mul_add(defect, structure.base);
        let each = flying.iter().zip(&seen);
        let slopes: Vec<Slopes<R>> = each
            .map(|(it, (sums, _))| Slopes::new(it.series.pendulum, sums, at(it), (fastest, length)))
            .collect();

        // Rows and columns: the structure, then the gaps.
        let count = flying.len() + 1;
        let growth = length / (n + 2.0);
        // Of the accelerations of the structure by its own error, and by that of a gap.
        let through = |column: usize| match column.checked_sub(1) {
            None => structure.growth * wide,
            Some(from) => flying[from].shape * slopes[from].pull * wide,
        };
        let entry = |row: usize, column: usize| {
            let Some(to) = row.checked_sub(1) else { return through(column) };
            let (pendulum, shape) = (flying[to].series.pendulum, flying[to].shape);
            let by = pendulum.coupling * shape * through(column) * wide;
            if row != column {
                return by / fastest;
            }
            let Slopes { swung, own, .. } = slopes[to];
            R::larger(swung, (by + own) / fastest + pendulum.pivot_damping)
        };
        let mut kept = Vec::with_capacity(count * count);
        for row in 0..count {
            for column in 0..count {
                let one = if row == column { R::ONE } else { R::ZERO };
                kept.push(one - entry(row, column) * growth);
            }
        }
        let mut errors = Vec::with_capacity(count);
        errors.push(length * defect);
        for (it, (_, own)) in flying.iter().zip(&seen) {
            errors.push(own.delta(it.series.pendulum, at(it), length, fastest));
        }
        solve(&mut kept, &mut errors)?;
        let scale = R::from(MARGIN) / (n + 1.0);
        errors.iter_mut().for_each(|error| *error *= scale);

        // Within the neighbourhood, as for one pendulum.
        let shaken = (0..count).fold(R::ZERO, |sum, k| through(k).mul_add(errors[k], sum));
        let [mut within, mut off_circle] = [R::ZERO; 2];
        for (k, (it, (_, own))) in flying.iter().zip(&seen).enumerate() {
            let pendulum = it.series.pendulum;
            let over_b = R::ONE / pendulum.contact_distance;
            off_circle += own.off_circle(pendulum, it.shape * it.shape);
            let swung = errors[k + 1] * fastest * over_b;
            let pulled = it.shape * shaken * pendulum.coupling * over_b;
            within = R::larger(within, R::larger(swung, pulled) / NEIGHBOURHOOD);
        }
        let within = R::larger(within, off_circle);
        (within < R::INFINITY).then_some(Self { most, errors, within })
    }

    /// The share of the step for which it was found.
    pub fn most(&self) -> R {
        self.most
    }

    /// By how much the bounds at [`Self::most`] exceed what is allowed: of the error of the structure, then of that of each gap.
    pub fn excess(&self, allowed: impl Iterator<Item = R>) -> R {
        let each = self.errors.iter().zip(allowed);
        each.fold(self.within, |most, (error, allowed)| R::larger(most, *error / allowed))
    }

    /// By how much less they exceed it up to another share.
    pub fn part(&self, share: R) -> R {
        power(share / self.most, LAST + 1)
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
