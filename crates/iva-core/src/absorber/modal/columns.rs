//! What feeds a structure over one length: unit vectors of its state, and what each part of a drive does to it at rest.

use super::state::Modes;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Number, ORDER};

/// A harmonic part of the drive over one length.
#[derive(Debug, Clone)]
pub(super) struct Wave<R> {
    /// cos Ωh and sin Ωh.
    pub turn: [DoubleDouble<R>; 2],
    /// What cos Ωt and sin Ωt do meanwhile to a structure at rest.
    pub columns: [Column<R>; 2],
}

/// What a drive of size 1 does to a structure at rest: to all q and q̇, and to the base.
#[derive(Debug, Clone)]
pub(super) struct Column<R> {
    pub modes: Vec<DoubleDouble<R>>,
    pub base: [DoubleDouble<R>; 2],
}

/// cos Ωt and sin Ωt in powers of t over the unit of time, in which Ω is `turn`.
pub(super) fn turning<R: Real>(turn: DoubleDouble<R>) -> [[DoubleDouble<R>; ORDER + 1]; 2] {
    let square = -(turn * turn);
    [[DoubleDouble::new(R::ONE), DoubleDouble::ZERO], [DoubleDouble::ZERO, turn]].map(|begin| {
        let mut row = [DoubleDouble::ZERO; ORDER + 1];
        row[..2].copy_from_slice(&begin);
        for m in 0..ORDER - 1 {
            row[m + 2] =
                row[m] * square * <DoubleDouble<R> as Number>::reciprocal((m + 1) * (m + 2));
        }
        row
    })
}

/// The double integral over a length of what has these powers of t over the unit of time, and the single one.
pub(super) fn twice<R: Real>(row: &[DoubleDouble<R>], length: R, unit: R) -> [DoubleDouble<R>; 2] {
    let t = length / unit;
    let [mut way, mut rate] = [DoubleDouble::<R>::ZERO; 2];
    for (m, part) in row.iter().enumerate().rev() {
        let once = *part * <DoubleDouble<R> as Number>::reciprocal(m + 1);
        rate = rate.times(t) + once;
        way = way.times(t) + once * <DoubleDouble<R> as Number>::reciprocal(m + 2);
    }
    [way.times(length).times(length), rate.times(length)]
}

/// The unit vectors of z. Separate modes take one each at once: all q, then all q̇.
pub(super) fn units<R: Real, const M: usize>(
    n: usize,
    separate: bool,
) -> impl Iterator<Item = Modes<R, M>> {
    (0..if separate { 2 } else { 2 * n }).map(move |column| {
        let mut modes = Modes::REST;
        for j in 0..n {
            let [q, v] = if separate { [0, 1] } else { [j, n + j] };
            let one = |place| DoubleDouble::new(if column == place { R::ONE } else { R::ZERO });
            (modes.places[j], modes.velocities[j]) = (one(q), one(v));
        }
        modes
    })
}

/// All q, then all q̇.
pub(super) fn column<R: Real, const M: usize>(
    modes: &Modes<R, M>,
    n: usize,
) -> Vec<DoubleDouble<R>> {
    modes.places[..n].iter().chain(&modes.velocities[..n]).copied().collect()
}
