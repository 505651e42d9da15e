//! What is measured along a motion under force.

use super::integral::{at_nodes, mean_product, nodes};
use super::{Course, Driven, Moment, Source};
use crate::flight::{Arc, Arcs};
use crate::host::turning::{Jets, Turned, guess, turned_once};
use crate::host::{HostState, Integrated, Structure};
use crate::real::Real;
use crate::taylor::{ORDER, Row, unrolled};

impl<R: Real, D: Source<Real = R>> Driven<D> {
    /// A row times (n + 1)/step, one power less: its derivative.
    #[inline(always)]
    pub(crate) fn derivative(&self, row: &Row<R>) -> Row<R> {
        let mut derivative = [R::ZERO; ORDER + 1];
        unrolled!(n < ORDER => {
            derivative[n] = (row[n + 1] / self.step) * ((n + 1) as f64);
        });
        derivative
    }

    /// A series and its derivatives after a time h.
    #[inline(always)]
    fn jets(&self, row: &Row<R>, h: R) -> Jets<R> {
        let t = h / self.step;
        let mut sums = [R::ZERO; 5];
        unrolled!(k < ORDER + 1 => {
            sums[4] = sums[4].mul_add(t, sums[3]);
            sums[3] = sums[3].mul_add(t, sums[2]);
            sums[2] = sums[2].mul_add(t, sums[1]);
            sums[1] = sums[1].mul_add(t, sums[0]);
            sums[0] = sums[0].mul_add(t, row[ORDER - k]);
        });
        let over = R::ONE / self.step;
        let [square, cube] = [over * over, over * over * over];
        let [x, v, a, j, s] = sums;
        [x, v * over, (a * square) * 2.0, (j * cube) * 6.0, (s * (square * square)) * 24.0]
    }

    /// A of this mass, and its derivative.
    #[inline(always)]
    fn pulled(&self, state: &HostState<Moment<R>, R>) -> [R; 2] {
        let a = self.acceleration(&state.phase, &state.primary).value;
        let [jerk, ..] = self.derivatives(&state.phase, state.primary.v.value, a);
        [a, jerk]
    }

    /// ẋ, ẍ and x⃛ of this mass.
    #[inline(always)]
    fn moved(&self, state: &HostState<Moment<R>, R>) -> [R; 3] {
        let [a, jerk] = self.pulled(state);
        let [base, base_rate, ..] = self.base(&state.phase);
        [state.primary.v.value, a - base, jerk - base_rate]
    }

    /// Coefficients of a_g.
    #[inline(always)]
    pub(crate) fn base_row(&self, course: &Course<R>) -> Row<R> {
        self.derivative(&self.derivative(&course.carried))
    }

    /// Coefficients of x.
    #[inline(always)]
    pub(crate) fn place(&self, from: &HostState<Moment<R>, R>, course: &Course<R>) -> Row<R> {
        let mut x = course.pulled;
        if self.source.moves_base() {
            for (place, carried) in x.iter_mut().zip(&course.carried) {
                *place -= *carried;
            }
        }
        (x[0], x[1]) = (from.primary.x.value, from.primary.v.value * self.step);
        x
    }

    /// Coefficients of A.
    #[inline(always)]
    pub(super) fn acceleration_row(&self, course: &Course<R>) -> Row<R> {
        self.derivative(&self.derivative(&course.pulled))
    }

    /// ∫ 2ζ ẋ², and ∫ (f/M) ẋ − a_g p with p the momentum of structure and absorber.
    #[inline(always)]
    pub(super) fn taken_and_given(&self, motion: &Integrated<'_, Self>, h: R) -> [R; 2] {
        let Integrated { from, course, mass_ratio, gap_velocity } = *motion;
        let t = nodes([R::ZERO, h / self.step]);
        let velocity = at_nodes(&self.derivative(&self.place(from, course)), &t);
        let viscous = self.equation.damping / self.equation.stiffness;
        let lost = viscous * mean_product(&velocity, &velocity) * h;
        let mut work = mean_product(&at_nodes(&course.pushed, &t), &velocity);
        if self.source.moves_base() {
            let gained = at_nodes(&self.derivative(&course.pulled), &t);
            let base = at_nodes(&self.base_row(course), &t);
            let momentum = std::array::from_fn(|i| {
                let absorber = gap_velocity.map_or(R::ZERO, |w| w - gained[i]);
                velocity[i] + mass_ratio * (velocity[i] + absorber)
            });
            work -= mean_product(&base, &momentum);
        }
        [lost, work * h]
    }

    /// What is known of a motion between its ends.
    #[inline(always)]
    pub(crate) fn known(
        &self,
        from: &HostState<Moment<R>, R>,
        end: &HostState<Moment<R>, R>,
    ) -> Arcs<R> {
        let (a, b) = (self.pulled(from), self.pulled(end));
        let primary = &from.primary;
        Arcs {
            displacement: Arc {
                values: [primary.x.value, end.primary.x.value],
                rates: [primary.v.value, end.primary.v.value],
                second: self.bound::<0>(primary) + self.base[0],
                third: self.bound::<1>(primary) + self.base[1],
            },
            acceleration: Arc {
                values: [a[0], b[0]],
                rates: [a[1], b[1]],
                second: self.bound::<2>(primary),
                third: self.bound::<3>(primary),
            },
        }
    }

    /// Where x turns round, if it does so once.
    #[inline(always)]
    pub(crate) fn displacement_turned(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        end: &HostState<Moment<R>, R>,
        h: R,
    ) -> Turned<R> {
        let bounds = [
            self.bound::<1>(&from.primary) + self.base[1],
            self.bound::<2>(&from.primary) + self.base[2],
            self.bound::<3>(&from.primary) + self.base[3],
        ];
        let (begin, at_end) = (self.moved(from), self.moved(end));
        let at = guess(begin, at_end, h);
        let jets = self.jets(&self.place(from, course), at);
        turned_once(begin, at_end, bounds, (at, jets), h)
    }

    /// Where A turns round, if it does so once.
    #[inline(always)]
    pub(crate) fn acceleration_turned(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        end: &HostState<Moment<R>, R>,
        h: R,
    ) -> Turned<R> {
        let primary = &from.primary;
        let bounds = [self.bound::<3>(primary), self.bound::<4>(primary), self.bound::<5>(primary)];
        let (begin, at_end) = (self.steepened(from), self.steepened(end));
        let at = guess(begin, at_end, h);
        let jets = self.jets(&self.acceleration_row(course), at);
        turned_once(begin, at_end, bounds, (at, jets), h)
    }

    /// The first three derivatives of A.
    #[inline(always)]
    fn steepened(&self, state: &HostState<Moment<R>, R>) -> [R; 3] {
        let a = self.acceleration(&state.phase, &state.primary).value;
        self.derivatives(&state.phase, state.primary.v.value, a)
    }
}
