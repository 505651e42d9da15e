//! Quantities measured along a motion under force.

use super::{Driven, Moment, NODES, Powers, Source};
use crate::host::oscillator::Primary;
use crate::host::turning::{Jets, Turned, guess, turned_once};
use crate::host::{HostState, Integrated, Structure};
use crate::number::real::Real;
use crate::segment::flight::{Arc, Extreme, Quantity};
use crate::segment::quadrature::{mean_product, nodes, values};
use crate::segment::taylor::{ORDER, Row, unrolled};

impl<R: Real, D: Source<Real = R>> Driven<D> {
    /// The series of the derivative: each coefficient times (n + 1)/step, one power lower.
    #[inline(always)]
    pub(crate) fn derivative(&self, row: &Row<R>) -> Row<R> {
        // `step` is a power of two, so its reciprocal is exact.
        let over = R::ONE / self.step;
        let mut derivative = [R::ZERO; ORDER + 1];
        unrolled!(n < ORDER => {
            derivative[n] = (row[n + 1] * over) * ((n + 1) as f64);
        });
        derivative
    }

    /// A series and its first five derivatives after a time h.
    #[inline(always)]
    fn jets(&self, row: &Row<R>, h: R) -> Jets<R> {
        let t = h / self.step;
        let mut sums = [R::ZERO; 6];
        unrolled!(k < ORDER + 1 => {
            sums[5] = sums[5].mul_add(t, sums[4]);
            sums[4] = sums[4].mul_add(t, sums[3]);
            sums[3] = sums[3].mul_add(t, sums[2]);
            sums[2] = sums[2].mul_add(t, sums[1]);
            sums[1] = sums[1].mul_add(t, sums[0]);
            sums[0] = sums[0].mul_add(t, row[ORDER - k]);
        });
        let over = R::ONE / self.step;
        let [square, cube] = [over * over, over * over * over];
        let [x, v, a, j, s, fifth] = sums;
        let (jerk, snap) = ((j * cube) * 6.0, (s * (square * square)) * 24.0);
        [x, v * over, (a * square) * 2.0, jerk, snap, (fifth * (square * cube)) * 120.0]
    }

    /// x and the absolute acceleration at a state, each with its first three derivatives.
    #[inline(always)]
    pub(crate) fn leading_of(&self, state: &HostState<Moment<R>, R>) -> Leading<R> {
        let Primary { x, v } = state.primary;
        let a = self.acceleration(&state.phase, &state.primary);
        let [jerk, snap, third] = self.derivatives(&state.phase, v.value, a.value);
        let [_, base_rate, ..] = self.base(&state.phase);
        let bend = self.relative(a, &state.phase);
        Leading {
            displacement: [x.value, v.value, bend, jerk - base_rate],
            acceleration: [self.without_gravity(a).value, jerk, snap, third],
        }
    }

    /// [`Driven::leading_of`] both ends of a motion, with the piece of the drive that acts within the motion.
    #[inline(always)]
    pub(super) fn ends_of(
        &self,
        from: &HostState<Moment<R>, R>,
        end: &HostState<Moment<R>, R>,
    ) -> [Leading<R>; 2] {
        let mut end = *end;
        if self.source.bends() {
            end.phase = self.at(&from.phase, end.phase.time);
        }
        [self.leading_of(from), self.leading_of(&end)]
    }

    /// Coefficients of a_g.
    #[inline(always)]
    pub(crate) fn base_row(&self, powers: &Powers<R>) -> Row<R> {
        self.derivative(&self.derivative(&powers.carried))
    }

    /// Coefficients of x.
    #[inline(always)]
    pub(crate) fn place(&self, from: &HostState<Moment<R>, R>, powers: &Powers<R>) -> Row<R> {
        let mut x = powers.pulled;
        if self.source.moves_base() {
            for (place, carried) in x.iter_mut().zip(&powers.carried) {
                *place -= *carried;
            }
        }
        (x[0], x[1]) = (from.primary.x.value, from.primary.v.value * self.step);
        x
    }

    /// Coefficients of the absolute acceleration.
    #[inline(always)]
    pub(crate) fn acceleration_row(&self, powers: &Powers<R>) -> Row<R> {
        self.derivative(&self.derivative(&powers.pulled))
    }

    /// The energy lost ∫ 2ζ ẋ², and the work ∫ (f/M) ẋ − a_g p, where p is the momentum of structure and
    /// absorber.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn taken_and_given(&self, motion: &Integrated<'_, Self>, h: R) -> [R; 2] {
        let Integrated { from, course, mass_ratio, gap_velocity } = *motion;
        let mut room = None;
        let powers = self.series_of(from, course, &mut room);
        let t = nodes::<R, NODES>([R::ZERO, h / self.step]);
        let at_nodes = |row: &Row<R>| values::<ORDER, _, _, _>(row, &t);
        let velocity = at_nodes(&self.derivative(&self.place(from, powers)));
        let viscous = self.equation.damping / self.equation.stiffness;
        let lost = viscous * mean_product(&velocity, &velocity) * h;
        // Gravity does no work here: its potential is part of the energy of the absorber.
        let mut work = mean_product(&at_nodes(&powers.pushed), &velocity);
        if self.source.moves_base() {
            let gained = at_nodes(&self.derivative(&powers.pulled));
            let base = at_nodes(&self.base_row(powers));
            let fallen = self.source.weight().map_or(R::ZERO, |weight| weight.gravity * self.step);
            let momentum = std::array::from_fn(|i| {
                let absorber = gap_velocity.map_or(R::ZERO, |w| w - gained[i] - fallen * t[i]);
                velocity[i] + mass_ratio * (velocity[i] + absorber)
            });
            work -= mean_product(&base, &momentum);
        }
        [lost, work * h]
    }

    /// A bound on the size of a quantity in a motion, as far as it is known without the force at its end.
    #[inline(always)]
    pub(super) fn at_most(
        &self,
        of: Quantity,
        [from, to]: [&HostState<Moment<R>, R>; 2],
        h: R,
    ) -> R {
        let begin = &from.primary;
        match of {
            Quantity::Displacement => {
                let ends = begin.x.value.abs().max(to.primary.x.value.abs());
                (h * h * 0.125).mul_add(self.bound::<0>(begin) + self.base[0], ends)
            }
            Quantity::Acceleration => {
                let size = self.without_gravity(from.acceleration).value.abs();
                h.mul_add(self.bound::<1>(begin), size)
            }
        }
    }

    /// A bound on the sixth derivative of a quantity in every motion from a state.
    #[inline(always)]
    fn sixth(&self, of: Quantity, begin: &Primary<R>) -> R {
        match of {
            Quantity::Displacement => self.bound::<4>(begin) + self.base[4],
            Quantity::Acceleration => self.bound::<6>(begin),
        }
    }

    /// A quantity between the ends of a motion of this length that begins with the state `begin` of the
    /// primary.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(crate) fn arc(
        &self,
        of: Quantity,
        [from, to]: [&Leading<R>; 2],
        begin: &Primary<R>,
        h: R,
    ) -> Arc<R> {
        let sixth = self.sixth(of, begin);
        let jet = |at: &Leading<R>| {
            let [value, rate, second, _] = at.jet(of);
            [value, rate, second]
        };
        let arc = Arc::new(jet(from), jet(to), sixth, h);
        match of {
            Quantity::Displacement => arc,
            Quantity::Acceleration => {
                // A and its derivatives may be small differences of large terms.
                let size = self.bound::<0>(begin) + self.bound::<1>(begin) * h;
                arc.doubted(size)
            }
        }
    }

    /// The extremum of a quantity in a motion, if it is proved to be the only one; `row` has the coefficients
    /// of the quantity.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn turned(
        &self,
        of: Quantity,
        arc: &Arc<R>,
        [from, to]: [&Leading<R>; 2],
        begin: &Primary<R>,
        row: &Row<R>,
        h: R,
    ) -> Turned<R> {
        let rates = |at: &Leading<R>| {
            let [_, rate, second, third] = at.jet(of);
            [rate, second, third]
        };
        let at = guess(rates(from), rates(to), h);
        turned_once(arc, (at, self.jets(row, at)), self.sixth(of, begin), h)
    }

    /// The largest size of a quantity in a motion; `row` has the coefficients of the quantity.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(crate) fn extreme(
        &self,
        of: Quantity,
        ends: [&Leading<R>; 2],
        begin: &Primary<R>,
        row: &Row<R>,
        h: R,
    ) -> Extreme<R> {
        let arc = self.arc(of, ends, begin, h);
        let turned = self.turned(of, &arc, ends, begin, row, h);
        Extreme::new(&arc, turned.once & R::FAST_PATHS, turned.value)
    }
}

/// Displacement and absolute acceleration at one instant, each with its first three derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leading<R = f64> {
    pub displacement: [R; 4],
    pub acceleration: [R; 4],
}

impl<R: Copy> Leading<R> {
    /// A quantity and its first three derivatives.
    #[inline(always)]
    fn jet(&self, of: Quantity) -> [R; 4] {
        match of {
            Quantity::Displacement => self.displacement,
            Quantity::Acceleration => self.acceleration,
        }
    }
}
