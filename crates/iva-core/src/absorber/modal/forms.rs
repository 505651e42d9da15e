//! What one shortest leap loses, as quadratic forms of its first state z = (q, q̇).
//!
//! While nothing drives or pulls, q̇ is linear in z, so that ∫ q̇ᵀ D q̇ dh over a known length is a form known beforehand. Its elements
//! are integrals of what unit vectors do, by quadrature: never differences of energies, so that the energy ledger stays a check.

use super::Modal;
use super::columns::units;
use super::propagator::Flown;
use super::regime::Regime;
use super::state::Place;
use super::structure::Damping;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::quadrature::{node, weight};
use crate::segment::taylor::ORDER;

/// Number of nodes: for a length of 1/Λ.
pub(super) const NODES: usize = 9;

/// The losses in all dampers, and in the dashpots of the gaps.
///
/// Of separate modes: the elements qq, qv and vv of each mode, one after the other. Of coupled ones: all elements, row by row.
#[derive(Debug, Clone)]
pub(super) struct Forms<R> {
    all: Vec<R>,
    gaps: Vec<R>,
}

impl<R: Real> Forms<R> {
    /// The losses from a state on: in all dampers, and in the gaps.
    pub(super) fn lost<const M: usize>(&self, n: usize, z: &Flown<R, M>) -> [R; 2] {
        let [z, _] = z.parts(2 * n);
        if self.all.len() == 3 * n {
            let (q, v) = z.split_at(n);
            let mut sum = R::ZERO;
            for (j, form) in self.all.chunks_exact(3).enumerate() {
                sum += q[j] * form[0].mul_add(q[j], form[1] * v[j]) + form[2] * v[j] * v[j];
            }
            return [sum, R::ZERO];
        }
        [&self.all, &self.gaps].map(|form| {
            form.chunks_exact(2 * n).zip(z).fold(R::ZERO, |sum, (row, part)| {
                let along = row.iter().zip(z);
                let along = along.fold(R::ZERO, |sum, (element, z)| element.mul_add(*z, sum));
                part.mul_add(along, sum)
            })
        })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The forms of a motion of this length.
    pub(super) fn forms(&self, length: R) -> Forms<R> {
        let n = self.whole.count();
        let mut free = self.regime(&[Place::FAR; N]);
        free.pulls = [DoubleDouble::ZERO; N];
        let still = [[DoubleDouble::ZERO; 3]; ORDER + 1];
        let unit = R::power_of_two(length);
        let instants: [R; NODES] =
            std::array::from_fn(|g| node::<R, NODES>(g, [R::ZERO, length / unit]));
        let weights: [R; NODES] = std::array::from_fn(|g| weight::<R, NODES>(g) * length);
        // Of each unit vector all q̇ at all nodes.
        let flown = |regime: &Regime<'_, R, N>, modes| {
            let rows = self.series_fed(&modes, regime, (&still, &[]), unit);
            instants.map(|t| rows.modes::<M>(n, t, unit).velocities.map(|v| v.value))
        };
        let separate = self.whole.is_separate();
        let speeds: Vec<[[R; M]; NODES]> =
            units::<R, M>(n, separate).map(|modes| flown(&free, modes)).collect();
        let mean = |of: &dyn Fn(usize) -> R| {
            (0..NODES).fold(R::ZERO, |sum, g| weights[g].mul_add(of(g), sum))
        };
        match &self.whole.damping {
            Damping::Separate(rates) => {
                let [q, v] = [&speeds[0], &speeds[1]];
                let of_mode = |j: usize| {
                    let c = rates[j].value;
                    let form =
                        |a: &[[R; M]; NODES], b: &[[R; M]; NODES]| c * mean(&|g| a[g][j] * b[g][j]);
                    [form(q, q), form(q, v) * 2.0, form(v, v)]
                };
                Forms { all: (0..n).flat_map(of_mode).collect(), gaps: vec![] }
            }
            Damping::Full(matrix) => {
                let damped = |speed: &[R; M]| -> [R; M] {
                    std::array::from_fn(|j| {
                        let row = matrix.get(j * n..(j + 1) * n).unwrap_or(&[]).iter().zip(speed);
                        row.fold(R::ZERO, |sum, (element, v)| element.mul_add(*v, sum))
                    })
                };
                let dot = |a: &[R], b: &[R]| {
                    a.iter().zip(b).fold(R::ZERO, |sum, (a, b)| a.mul_add(*b, sum))
                };
                let forces: Vec<_> = speeds.iter().map(|of| of.each_ref().map(damped)).collect();
                let ties: Vec<_> =
                    self.tied.iter().flatten().filter(|it| it.tie.damping != 0.0).collect();
                let pairs = || (0..2 * n).flat_map(|i| (0..2 * n).map(move |k| (i, k)));
                let all = pairs().map(|(i, k)| mean(&|g| dot(&speeds[i][g], &forces[k][g])));
                let gaps = pairs().map(|(i, k)| {
                    mean(&|g| {
                        ties.iter().fold(R::ZERO, |sum, it| {
                            let [a, b] = [i, k].map(|column| dot(&it.shape, &speeds[column][g]));
                            sum + it.tie.taken(a * b)
                        })
                    })
                });
                Forms { all: all.collect(), gaps: gaps.collect() }
            }
        }
    }
}
