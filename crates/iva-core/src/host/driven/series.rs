//! The power series of a motion under force.

use super::{Course, Driven, Moment, Source};
use crate::force::{Drive, Pushes};
use crate::host::HostState;
use crate::host::oscillator::{Arrival, Equation, Primary};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Number, ORDER, Row, unrolled};

/// The power series of a motion, in powers of t/`step`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Powers<R = f64> {
    /// Coefficients of ∬A, 0 below the second order. They leave gravity along the motion out, whose rounding
    /// errors would show in a small motion.
    pub(crate) pulled: Row<R>,
    /// Coefficients of ∬a_g.
    pub(crate) carried: Row<R>,
    /// Coefficients of f/M.
    pub(crate) pushed: Row<R>,
}

impl<R: Real, D: Source<Real = R>> Driven<D> {
    /// A and its next two derivatives, in double-double.
    #[inline(always)]
    pub(super) fn leading(&self, from: &HostState<Moment<R>, R>) -> [DoubleDouble<R>; 3] {
        let Pushes { primary: f, base: g } = from.phase.pushes;
        let a = from.acceleration;
        let j = self.equation.pull(f.rate - from.primary.v, a - g.value);
        [a, j, self.equation.pull(f.second - (a - g.value), j - g.rate)]
    }

    /// The coefficients of ∬A and ∬a_g in powers of t/h, from x, ẋ and A.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn powers<T: Number<Real = R>>(
        &self,
        [x, v, a]: [T; 3],
        drive: &Drive<T>,
        h: R,
    ) -> [Row<T>; 2] {
        let Equation { stiffness, damping, .. } = self.equation;
        let h = T::from_real(h);
        let equation = [T::from_real(stiffness) * (h * h), T::from_real(damping) * h, h * h];
        let mut place = [T::from_real(R::ZERO); ORDER + 1];
        let [mut pulled, mut carried] = [place; 2];
        (place[0], place[1]) = (x, v * h);
        let half = (h * h) * T::reciprocal(2);
        (pulled[2], carried[2]) = (a * half, drive.base[0] * half);
        if T::UNROLLED {
            unrolled!(n < ORDER - 2 => {
                place[n + 2] = pulled[n + 2] - carried[n + 2];
                [pulled[n + 3], carried[n + 3]] = self.next(&equation, n + 1, &place, drive);
            });
        } else {
            for n in 0..ORDER - 2 {
                place[n + 2] = pulled[n + 2] - carried[n + 2];
                [pulled[n + 3], carried[n + 3]] = self.next(&equation, n + 1, &place, drive);
            }
        }
        [pulled, carried]
    }

    /// The coefficients of order n + 2 of ∬A and ∬a_g, from the coefficients of x up to order n + 1; the
    /// first argument is k h², c h, h².
    #[inline(always)]
    fn next<T: Number<Real = R>>(
        &self,
        [k, c, square]: &[T; 3],
        n: usize,
        x: &Row<T>,
        drive: &Drive<T>,
    ) -> [T; 2] {
        let over = T::reciprocal(n + 1) * T::reciprocal(n + 2);
        let damped = (*c * T::reciprocal(n + 2)) * x[n + 1];
        let pulled = (*k * over).fused(drive.primary[n] - x[n], -damped);
        let moves = self.source.moves_base();
        [pulled, if moves { (*square * over) * drive.base[n] } else { T::from_real(R::ZERO) }]
    }

    /// The gain of displacement beyond a uniform motion, and of velocity, in a motion of length h, from an
    /// acceleration with its first two derivatives, and the power series of its double integral.
    #[inline(always)]
    fn gained(&self, [a, j, s]: [DoubleDouble<R>; 3], series: &Row<R>, h: R) -> Arrival<R> {
        let length = DoubleDouble::new(h);
        let half_square = length.product(length).half();
        let sixth_cube = half_square.product(length).product(self.equation.third);
        let t = h / self.step;
        // Σ s_n tⁿ⁻⁵ for n ≥ 5, and its derivative.
        let (mut sum, mut slope) = (R::ZERO, R::ZERO);
        unrolled!(k < ORDER - 4 => {
            slope = slope.mul_add(t, sum);
            sum = sum.mul_add(t, series[ORDER - k]);
        });
        let fourth = (t * t) * (t * t);
        let bent = fourth * t.mul_add(sum, series[4]);
        let rate = fourth * t.mul_add(slope, sum * 5.0) / self.step;
        Arrival {
            curved: a
                .product(half_square)
                .plus_both(j.product(sixth_cube), DoubleDouble::new(bent)),
            velocity: a
                .product(length)
                .plus_both(j.product(half_square), s.product(sixth_cube))
                .plus(rate),
        }
    }

    /// Displacement and velocity after a motion of length h, and ∬A and ∫A, by its power series.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn summed(
        &self,
        from: &HostState<Moment<R>, R>,
        powers: &Powers<R>,
        h: R,
    ) -> (Primary<R>, Arrival<R>) {
        let gained = self.gained(self.leading(from), &powers.pulled, h);
        let Primary { x, v } = from.primary;
        let travelled = x.plus_both(v.product(DoubleDouble::new(h)), gained.curved);
        let mut primary = Primary { x: travelled, v: v + gained.velocity };
        if self.source.moves_base() {
            let base = from.phase.pushes.base;
            let carried = self.gained([base.value, base.rate, base.second], &powers.carried, h);
            primary = Primary { x: primary.x - carried.curved, v: primary.v - carried.velocity };
        }
        (primary, gained)
    }

    /// The power series of a motion.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn expanded(&self, from: &HostState<Moment<R>, R>) -> Powers<R> {
        let drive = self.source.drive(&from.phase, self.step);
        let Primary { x, v } = from.primary;
        let a = self.without_gravity(from.acceleration);
        let [pulled, carried] = self.powers([x.value, v.value, a.value], &drive, self.step);
        Powers { pulled, carried, pushed: drive.primary }
    }

    /// The power series of a motion with this course, which is made in `room` where the course has none.
    #[inline(always)]
    pub(crate) fn series_of<'a>(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &'a Course<R>,
        room: &'a mut Option<Powers<R>>,
    ) -> &'a Powers<R> {
        match &course.0 {
            Some(powers) => powers,
            None => room.insert(self.expanded(from)),
        }
    }
}
