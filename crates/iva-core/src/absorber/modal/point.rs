//! The state of a system as a point: numbers that are independent of each other.
//!
//! They are q and q̇ of the modes of the structure, then y from the middle of the gap and ẏ of each member. A stop on the ground has none, and
//! a mass with a spring or a dashpot, or one that others ride on, has them in the place of its coordinate of the structure.

use nalgebra::DMatrix;

use super::{Modal, ModalStart, ModalState};
use crate::absorber::derivatives::lists::DifferentiableList;
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The coordinates that are no member's.
    fn modes_alone(&self) -> impl Iterator<Item = usize> {
        let tied = self.tied.iter().flatten().filter(|it| !it.grounded);
        let members: Vec<usize> = tied.map(|it| it.coordinate).collect();
        (0..self.whole.count()).filter(move |j| !members.contains(j))
    }

    /// The members that have a place of their own.
    fn placed_members(&self) -> impl Iterator<Item = usize> {
        (0..self.count()).filter(|k| !self.on_ground(*k))
    }

    /// The indices of these numbers among q, q̇, y and ẏ of all coordinates and members.
    pub(crate) fn independent(&self) -> Vec<usize> {
        let n = self.whole.count();
        let modes = self.modes_alone().chain(self.modes_alone().map(|j| n + j));
        let gaps = self.placed_members().flat_map(|k| [2 * (n + k), 2 * (n + k) + 1]);
        modes.chain(gaps).collect()
    }

    /// Which of them are y from the middle of a gap, each with its member.
    pub(crate) fn gaps_of_point(&self) -> Vec<(usize, usize)> {
        let modes = 2 * self.modes_alone().count();
        self.placed_members().enumerate().map(|(i, k)| (modes + 2 * i, k)).collect()
    }

    /// The point of a state.
    pub(crate) fn point_of(&self, state: &ModalState<H, N, M>) -> Vec<R> {
        let of_modes = |all: &[_]| -> Vec<R> { self.modes_alone().map(|j| all[j]).collect() };
        let [q, rates] = [&state.modes.places, &state.modes.velocities]
            .map(|all| of_modes(&all.map(|it| it.value)));
        let gaps = self.placed_members().flat_map(|k| {
            let GapPoint { y, w } = state.places[k].gap(&self.masses[k]);
            [y - self.masses[k].offset, w]
        });
        q.into_iter().chain(rates).chain(gaps).collect()
    }

    /// The start at a point; `None` if that has more or fewer numbers.
    pub(crate) fn start_of_point(&self, point: &[R]) -> Option<ModalStart<R, N, M>> {
        let modes = self.modes_alone().count();
        let (q, rest) = point.split_at_checked(modes)?;
        let (rates, gaps) = rest.split_at_checked(modes)?;
        let mut all = [[R::ZERO; M]; 2];
        for (given, all) in [q, rates].into_iter().zip(&mut all) {
            for (j, value) in self.modes_alone().zip(given) {
                all[j] = *value;
            }
        }
        let (pairs, []) = gaps.as_chunks::<2>() else { return None };
        if pairs.len() != self.placed_members().count() {
            return None;
        }
        let mut places = [GapPoint { y: R::ZERO, w: R::ZERO }; N];
        for (k, [y, w]) in self.placed_members().zip(pairs) {
            places[k] = GapPoint { y: *y + self.masses[k].offset, w: *w };
        }
        ModalStart::new(&all[0], &all[1], places).ok()
    }
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> Modal<H, N, M> {
    /// True if a spring or its weight holds a member at a place in its gap, or it is a stop.
    pub(crate) fn rests_in_gap(&self, k: usize) -> bool {
        let hangs = self.hanging(k).is_some_and(|is| is.frequency_squared > 0.0);
        hangs || self.tie(k).spring > 0.0 || self.grounded(k).is_some() || self.on_ground(k)
    }

    /// The derivative of all variables by these numbers.
    pub(super) fn by_point(&self) -> DMatrix<f64> {
        self.derivative_at_begin().select_columns(&self.independent())
    }
}
