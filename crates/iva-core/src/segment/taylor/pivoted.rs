//! A pendulum whose pivot is accelerated, as Taylor series that grow with those of the acceleration.
//!
//! It obeys the equations of [`super`] for y, W and c, in which a is now any acceleration A of its pivot. The pivot moves along a line that rises by α. With
//!
//! ```text
//! γ = cos(θ − α) = c cos α + (y/b) sin α,     p = b sin(θ − α) + b sin α,     ṗ = γ W,     Ẇ = −(β A γ + r² y + …)
//! ```
//!
//! the pendulum pulls along that line with −μ (A + λ p̈); of a level line γ is c and p is y. So in the notation of
//! `segment/taylor/recurrence.rs`, with G for (γ W)_{k+1} without γ₀ W_{k+1}, each order of its pull is linear in that of A:
//!
//! ```text
//! −μ (1 − γ₀²/κ) A_k − μλ ((k+1)/h G − γ₀ R).
//! ```
//!
//! The weight of the pendulum along the line does not change, and displacements are measured from where the structure rests under it.

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

/// The length of rows that hold all orders.
pub(crate) const ROOM: usize = 24;

/// The series of a pendulum as they grow, with what does not change on the way.
#[derive(Debug, Clone)]
pub(crate) struct Growing<'a, R, T, const LENGTH: usize> {
    pub pendulum: &'a Pendulum<R>,
    pub y: [T; LENGTH],
    pub w: [T; LENGTH],
    pub c: [T; LENGTH],
    /// The acceleration of the pivot.
    pub a: [T; LENGTH],
    /// W and A with the last order first, W₀ at [`Growing::LAST`] and A₀ before it, so that sums over both ends of a product run one way.
    w_back: [T; LENGTH],
    a_back: [T; LENGTH],
    /// c from the first order on, and γ where it is not c.
    c_later: [T; LENGTH],
    lean_later: [T; LENGTH],
    /// γ of order 0.
    lean: T,
    arc: [T; LENGTH],
    /// R, and (c W)_k of the order at hand.
    rest: T,
    swept: T,
    /// (c W)_k of the order at hand without c₀ W_k.
    swung: T,
    over_b2: T,
    /// s R of the friction in the pivot.
    rubbed: R,
}

impl<'a, R: Real, T: Number<Real = R>, const LENGTH: usize> Growing<'a, R, T, LENGTH> {
    /// The place of W₀: rows have a length that is a multiple of four.
    const LAST: usize = LENGTH - 4;

    #[inline(always)]
    pub fn new(pendulum: &'a Pendulum<R>, begin: Posture<T>, rubbed: R) -> Self {
        let zero = T::from_real(R::ZERO);
        let row = [zero; LENGTH];
        let b = T::from_real(pendulum.contact_distance);
        let over_b2 = T::reciprocal(1) / (b * b);
        let mut growing = Self {
            pendulum,
            y: row,
            w: row,
            c: row,
            a: row,
            w_back: row,
            a_back: row,
            c_later: row,
            lean_later: row,
            lean: pendulum.lean(begin.y, begin.c),
            arc: row,
            rest: zero,
            swept: zero,
            swung: zero,
            over_b2,
            rubbed,
        };
        let Posture { y, w, c, arc } = begin;
        (growing.y[0], growing.w[0], growing.c[0], growing.arc[0]) = (y, w, c, arc);
        growing.w_back[Self::LAST] = w;
        growing
    }

    /// Goes on from orders up to some, which other numbers have.
    #[inline(always)]
    pub fn from_first<Q: Number<Real = R>, const FIRST: usize>(
        first: &Growing<'a, R, Q, FIRST>,
        order: usize,
        number: impl Fn(Q) -> T,
    ) -> Self {
        let [y, w, c, arc] = [first.y[0], first.w[0], first.c[0], first.arc[0]].map(&number);
        let mut own = Self::new(first.pendulum, Posture { y, w, c, arc }, first.rubbed);
        for k in 1..=order {
            (own.y[k], own.c[k]) = (number(first.y[k]), number(first.c[k]));
            (own.w[k], own.a[k - 1]) = (number(first.w[k]), number(first.a[k - 1]));
            (own.arc[k], own.c_later[k - 1]) = (number(first.arc[k]), own.c[k]);
            (own.w_back[Self::LAST - k], own.a_back[Self::LAST - k]) = (own.w[k], own.a[k - 1]);
        }
        own.lean_later = std::array::from_fn(|k| {
            if k < order {
                own.pendulum.lean(own.y[k + 1], own.c[k + 1])
            } else {
                T::from_real(R::ZERO)
            }
        });
        own.swung = number(first.swung);
        own
    }

    /// All of order k but A_k, W_{k+1} and y_{k+1}; returns μλ ((k+1)/h G − γ₀ R).
    #[inline(always)]
    pub fn prepare(&mut self, k: usize, (h, over_h): (T, T)) -> T {
        let n = T::from_real;
        let is = self.pendulum;
        let mut rest = n(is.frequency_squared) * self.y[k];
        if k == 0 {
            rest = rest + n(self.rubbed);
        }
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
        let [yw, cw, mut shaken] = self.products(k, &self.c_later);
        let over = h * T::reciprocal(k + 1);
        let c = -(over * self.over_b2 * yw);
        self.c[k + 1] = c;
        self.c_later[k] = c;
        self.swung = c.fused(self.w[0], cw);
        let mut along = self.swung;
        if is.rise != 0.0 {
            self.lean_later[k] = is.lean(over * self.swept, c);
            [_, along, shaken] = self.products(k, &self.lean_later);
        }
        self.rest = n(is.coupling).fused(shaken, rest);
        let gained = n(R::from((k + 1) as f64)) * over_h * along;
        n(is.mass_ratio * is.lever) * (gained - self.lean * self.rest)
    }

    /// γ of all orders.
    pub fn leans(&self) -> [T; LENGTH] {
        if self.pendulum.rise == 0.0 {
            return self.c;
        }
        std::array::from_fn(|k| if k == 0 { self.lean } else { self.lean_later[k - 1] })
    }

    /// p of an order.
    pub fn beside(&self, k: usize) -> T {
        let one = if k == 0 { R::ONE } else { R::ZERO };
        self.pendulum.beside(self.y[k], T::from_real(one) - self.c[k])
    }

    /// Σ y_i W_{k−i}, and of c or γ Σ c_{i+1} W_{k−i} and Σ c_{i+1} A_{k−1−i} over what is known: rows are 0 beyond, so that the sums run in whole fours.
    #[inline(always)]
    fn products(&self, k: usize, later: &[T; LENGTH]) -> [T; 3] {
        let mut parts = [[T::from_real(R::ZERO); 4]; 3];
        let fours = k / 4 + 1;
        let [y, c] = [&self.y, later].map(|row| row.as_chunks::<4>().0);
        let [w, a] =
            [&self.w_back, &self.a_back].map(|row| row[Self::LAST - k..].as_chunks::<4>().0);
        for (((y, c), w), a) in y.iter().zip(c).zip(w).zip(a).take(fours) {
            for i in 0..4 {
                parts[0][i] = y[i].fused(w[i], parts[0][i]);
                parts[1][i] = c[i].fused(w[i], parts[1][i]);
                parts[2][i] = c[i].fused(a[i], parts[2][i]);
            }
        }
        parts.map(|[a, b, c, d]| (a + b) + (c + d))
    }

    /// W_{k+1} and y_{k+1}, from A_k.
    #[inline(always)]
    pub fn raise(&mut self, k: usize, a: T, h: T) {
        self.a[k] = a;
        let over = h * T::reciprocal(k + 1);
        let beta = T::from_real(self.pendulum.coupling);
        let w = -(over * (beta * self.lean).fused(a, self.rest));
        self.w[k + 1] = w;
        self.y[k + 1] = over * self.swept;
        if let Some(at) = Self::LAST.checked_sub(k + 1) {
            (self.w_back[at], self.a_back[at]) = (w, a);
        }
    }

    /// y_{k+1}, which W_k makes known before A_k.
    #[inline(always)]
    pub fn ahead(&self, k: usize, h: T) -> T {
        h * T::reciprocal(k + 1) * self.c[0].fused(self.w[k], self.swung)
    }
}
