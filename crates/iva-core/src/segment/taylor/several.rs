//! The motion of several pendulums on one structure as Taylor series.
//!
//! Each obeys the equations of [`super`]; the structure carries the masses of those that are stuck to it, of mass ratio m
//! together, and is pulled by the others:
//!
//! ```text
//! (1 + m + Σ μ) a + Σ μλ ÿ = f/M − x − 2ζ u
//! ```
//!
//! So the pendulums are coupled by a alone, and each order of a is the solution of one linear equation, in the notation of
//! `segment/taylor/recurrence.rs`:
//!
//! ```text
//! D a_k = f_k − x_k − 2ζ u_k − Σ μλ ((k+1)/h B − c₀ R),     D = 1 + m + Σ μ (1 − c₀²/κ).
//! ```
//!
//! A free mass is a pendulum at small angles without gravity, with κ = λ = β = 1: it adds nothing to D and pulls nothing.

use super::recurrence::convolutions;
use super::{Number, Pendulum, Series, Spring, Swing};
use crate::force::Drive;
use crate::number::real::Real;

/// A pendulum at the begin of a motion; x and u of its swing are those of the structure.
pub(crate) struct Member<'a, T: Number> {
    pub pendulum: &'a Pendulum<T::Real>,
    pub swing: Swing<T>,
    /// True if it is stuck to the structure.
    pub stuck: bool,
    /// True just after a release, where W and Ẇ are exactly 0.
    pub released: bool,
}

/// The series of the gap of one pendulum as they grow, with what does not change on the way.
struct Growing<'a, T: Number, const LENGTH: usize> {
    member: &'a Member<'a, T>,
    y: [T; LENGTH],
    w: [T; LENGTH],
    c: [T; LENGTH],
    arc: [T; LENGTH],
    /// B, R, and (c W)_k of the order at hand.
    gained: T,
    rest: T,
    swept: T,
    /// (c W)_k of the order before without c₀ W_k.
    swung: T,
    over_b2: T,
}

impl<'a, R: Real, T: Number<Real = R>, const LENGTH: usize> Growing<'a, T, LENGTH> {
    #[inline(always)]
    fn new(member: &'a Member<'a, T>) -> Self {
        let zero = T::from_real(R::ZERO);
        let mut rows = [[zero; LENGTH]; 4];
        let Swing { y, w, c, arc, .. } = member.swing;
        for (row, value) in rows.iter_mut().zip([y, w, c, arc]) {
            row[0] = value;
        }
        let [y, w, c, arc] = rows;
        let b = T::from_real(member.pendulum.contact_distance);
        let over_b2 = T::reciprocal(1) / (b * b);
        let (gained, rest, swept, swung) = (zero, zero, zero, zero);
        Self { member, y, w, c, arc, gained, rest, swept, swung, over_b2 }
    }

    /// All of order k but a_k, W_{k+1} and y_{k+1}; returns μλ ((k+1)/h B − c₀ R).
    #[inline(always)]
    fn prepare(&mut self, k: usize, a: &[T; LENGTH], (h, over_h): (T, T)) -> T {
        let n = T::from_real;
        let is = self.member.pendulum;
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
        let [mut yw, mut cw, mut ca] = convolutions(&self.y, &self.w, &self.c, a, k);
        yw = self.y[0].fused(w, yw);
        if k > 0 {
            yw = self.y[k].fused(w0, yw);
            ca = self.c[1].fused(a[k - 1], ca);
        }
        self.c[k + 1] = -(h * T::reciprocal(k + 1) * self.over_b2 * yw);
        cw = self.c[1].fused(w, cw);
        if k > 0 {
            cw = self.c[k + 1].fused(w0, cw);
        }
        self.swung = cw;
        self.rest = n(is.coupling).fused(ca, rest);
        self.gained = n(R::from((k + 1) as f64)) * over_h * cw;
        n(is.mass_ratio * is.lever) * (self.gained - c0 * self.rest)
    }

    /// W_{k+1} and y_{k+1}.
    #[inline(always)]
    fn raise(&mut self, k: usize, a: T, h: T) {
        let over = h * T::reciprocal(k + 1);
        let beta = T::from_real(self.member.pendulum.coupling);
        self.w[k + 1] = -(over * (beta * self.c[0]).fused(a, self.rest));
        self.y[k + 1] = over * self.swept;
    }
}

/// The series of each of several pendulums on a structure with this damping ratio, of a step of length h, up to `order` of
/// x, u, y, W and c.
#[inline(always)]
pub(crate) fn series_of_several<R: Real, T: Number<Real = R>, const LENGTH: usize>(
    members: &[Member<'_, T>],
    damping_ratio: R,
    drive: Option<&Drive<T, LENGTH>>,
    (h, order): (R, usize),
) -> Vec<Series<T, LENGTH>> {
    let n = T::from_real;
    let zero = n(R::ZERO);
    let Some(first) = members.first() else { return Vec::new() };
    let mut inertia = zero;
    for Member { pendulum, swing, stuck, .. } in members {
        let own = if *stuck { n(pendulum.mass_ratio) } else { pendulum.own_inertia(swing.y) };
        inertia = inertia + own;
    }
    let over_inertia = T::reciprocal(1) / (T::reciprocal(1) + inertia);
    let (step, over_step) = (n(h), T::over(h));
    let mut growing: Vec<Growing<'_, T, LENGTH>> = Vec::with_capacity(members.len());
    for member in members {
        growing.push(Growing::new(member));
    }
    let [mut x, mut u, mut a] = [[zero; LENGTH]; 3];
    (x[0], u[0]) = (first.swing.x, first.swing.u);
    for k in 0..order {
        let [driven, base] = drive.map_or([zero; 2], |it| [it.primary[k], it.base[k]]);
        let mut push = driven - x[k] - n(damping_ratio * 2.0) * u[k];
        for it in &mut growing {
            if !it.member.stuck {
                push = push - it.prepare(k, &a, (step, over_step));
            }
        }
        a[k] = push * over_inertia;
        for it in &mut growing {
            if !it.member.stuck {
                it.raise(k, a[k], step);
            }
        }
        let over = step * T::reciprocal(k + 1);
        u[k + 1] = over * (a[k] - base);
        x[k + 1] = over * u[k];
    }
    let series = |it: Growing<'_, T, LENGTH>| {
        let Growing { member, mut y, mut w, c, .. } = it;
        if member.released && LENGTH > 2 {
            (w[1], y[2]) = (zero, zero);
        }
        Series { x, u, a, y, w, c }
    };
    growing.into_iter().map(series).collect()
}
