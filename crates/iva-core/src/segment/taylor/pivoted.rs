//! A pendulum whose pivot is accelerated, as Taylor series that grow with those of the acceleration.
//!
//! It obeys the equations of [`super`] for y, W and c, in which a is now any acceleration A of its pivot. What shakes the pivot is pulled by
//! −μ (A + λ ÿ), so that in the notation of `segment/taylor/recurrence.rs` each order of its pull is linear in that of A:
//!
//! ```text
//! −μ (1 − c₀²/κ) A_k − μλ ((k+1)/h B − c₀ R).
//! ```

use super::recurrence::convolutions;
use super::{Number, Pendulum, Spring};
use crate::number::real::Real;

/// A pendulum at an instant: y, W = b θ̇ and c = cosθ, and the arc φ.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Posture<T> {
    pub y: T,
    pub w: T,
    pub c: T,
    pub arc: T,
}

/// The series of a pendulum as they grow, with what does not change on the way.
#[derive(Debug, Clone)]
pub(crate) struct Growing<'a, R, T, const LENGTH: usize> {
    pub pendulum: &'a Pendulum<R>,
    pub y: [T; LENGTH],
    pub w: [T; LENGTH],
    pub c: [T; LENGTH],
    /// The acceleration of the pivot.
    pub a: [T; LENGTH],
    arc: [T; LENGTH],
    /// R, and (c W)_k of the order at hand.
    rest: T,
    swept: T,
    /// (c W)_k of the order at hand without c₀ W_k.
    swung: T,
    over_b2: T,
}

impl<'a, R: Real, T: Number<Real = R>, const LENGTH: usize> Growing<'a, R, T, LENGTH> {
    #[inline(always)]
    pub fn new(pendulum: &'a Pendulum<R>, begin: Posture<T>) -> Self {
        let zero = T::from_real(R::ZERO);
        let mut rows = [[zero; LENGTH]; 5];
        let Posture { y, w, c, arc } = begin;
        for (row, value) in rows.iter_mut().zip([y, w, c, arc]) {
            row[0] = value;
        }
        let [y, w, c, arc, a] = rows;
        let b = T::from_real(pendulum.contact_distance);
        let over_b2 = T::reciprocal(1) / (b * b);
        Self { pendulum, y, w, c, a, arc, rest: zero, swept: zero, swung: zero, over_b2 }
    }

    /// The same in other numbers, with room for more orders.
    #[inline(always)]
    pub fn map<Q: Number<Real = R>, const MORE: usize>(
        &self,
        number: impl Fn(T) -> Q,
    ) -> Growing<'a, R, Q, MORE> {
        let zero = Q::from_real(R::ZERO);
        let longer = |row: &[T; LENGTH]| {
            let mut longer = [zero; MORE];
            longer.iter_mut().zip(row).for_each(|(to, from)| *to = number(*from));
            longer
        };
        let [y, w, c, a, arc] = [&self.y, &self.w, &self.c, &self.a, &self.arc].map(longer);
        let [rest, swept] = [self.rest, self.swept].map(&number);
        let [swung, over_b2] = [self.swung, self.over_b2].map(&number);
        Growing { pendulum: self.pendulum, y, w, c, a, arc, rest, swept, swung, over_b2 }
    }

    /// All of order k but A_k, W_{k+1} and y_{k+1}; returns μλ ((k+1)/h B − c₀ R).
    #[inline(always)]
    pub fn prepare(&mut self, k: usize, (h, over_h): (T, T)) -> T {
        let n = T::from_real;
        let is = self.pendulum;
        let mut rest = n(is.frequency_squared) * self.y[k];
        if is.pivot_damping != 0.0 {
            rest = n(is.pivot_damping).fused(self.w[k], rest);
        }
        if is.spring.acts {
            if k > 0 {
                self.arc[k] = Spring::wound(h, k, self.w[k - 1]);
            }
            rest = n(is.spring.stiffness).fused(self.arc[k], rest);
        }
        let c0 = self.c[0];
        self.swept = c0.fused(self.w[k], self.swung);
        if is.small_angles {
            self.rest = rest;
            return n(is.mass_ratio * is.lever) * -(c0 * rest);
        }
        let (w0, w) = (self.w[0], self.w[k]);
        let [mut yw, mut cw, mut ca] = convolutions(&self.y, &self.w, &self.c, &self.a, k);
        yw = self.y[0].fused(w, yw);
        if k > 0 {
            yw = self.y[k].fused(w0, yw);
            ca = self.c[1].fused(self.a[k - 1], ca);
        }
        self.c[k + 1] = -(h * T::reciprocal(k + 1) * self.over_b2 * yw);
        cw = self.c[1].fused(w, cw);
        if k > 0 {
            cw = self.c[k + 1].fused(w0, cw);
        }
        self.swung = cw;
        self.rest = n(is.coupling).fused(ca, rest);
        let gained = n(R::from((k + 1) as f64)) * over_h * cw;
        n(is.mass_ratio * is.lever) * (gained - c0 * self.rest)
    }

    /// W_{k+1} and y_{k+1}, from A_k.
    #[inline(always)]
    pub fn raise(&mut self, k: usize, a: T, h: T) {
        self.a[k] = a;
        let over = h * T::reciprocal(k + 1);
        let beta = T::from_real(self.pendulum.coupling);
        self.w[k + 1] = -(over * (beta * self.c[0]).fused(a, self.rest));
        self.y[k + 1] = over * self.swept;
    }

    /// y_{k+1}, which W_k makes known before A_k.
    #[inline(always)]
    pub fn ahead(&self, k: usize, h: T) -> T {
        h * T::reciprocal(k + 1) * self.c[0].fused(self.w[k], self.swung)
    }
}
