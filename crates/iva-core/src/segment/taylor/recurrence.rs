//! Recurrence of the series from order to order, arranged so that each order waits little for the last.
//!
//! With Y = (y W)_k, B = (c W)_{k+1} without c₀ W_{k+1} and A = (c a)_k without c₀ a_k (as sums over
//! coefficients up to the order k) the recurrences of [`super`] read
//!
//! ```text
//! c_{k+1} = −h/((k+1) b²) Y      R = β A + r² y_k + σ² φ_k + ν W_k      W_{k+1} = −h/(k+1) (β c₀ a_k + R)
//! D a_k = f_k − x_k − 2ζ u_k − μλ ((k+1)/h B − c₀ R),    D = 1 + μ − (μ/κ) c₀²
//! ```
//!
//! The coefficients known last are W_k and a_{k−1}. They stand in the sums as y₀ W_k, c₁ W_k and c₁ a_{k−1},
//! and W_k once more in c_{k+1}: with s = y₀ W₀/b², so that c₁ = −h s, the factor of W_k in D a_k is
//! μλ ((k+2) s + c₀ ν), for k = 0 with s once. Everything else is summed before, the constants are
//! multiplied and divided by D beforehand, and from a_{k−1} to a_k two fused multiply-adds are left. The
//! orders of a series in doubles are unrolled.

use super::{Number, Pendulum, Series, Spring, Swing};
use crate::force::Drive;
use crate::number::real::Real;

/// The constants of a step.
struct Constants<T> {
    step: T,
    over_step: T,
    over_b2: T,
    beta: T,
    beta_c0: T,
    r2: T,
    nu: T,
    c0: T,
    y0: T,
    w0: T,
    /// φ₀, σ², and the factor of φ_k in a_k: for a spring only.
    arc: T,
    stiffness: T,
    of_arc: T,
    /// 1/D.
    freed: T,
    /// Factor of u_k in a_k.
    of_u: T,
    /// Factor of B in a_k, without (k+1)/h.
    of_b: T,
    /// Factor of Y in a_k.
    of_y: T,
    /// Factor of A in a_k.
    of_a: T,
    /// Factor of y_k in a_k.
    of_gap: T,
    /// Factor of a_{k−1} in a_k.
    of_last: T,
    /// Factor of W_k in a_k, without the part from s.
    of_w: T,
    /// Factor of W_k in a_k from s, without its multiple k + 2.
    of_turn: T,
}

/// A series that grows by one order at a time.
pub(super) struct Recurrence<'a, T, const LENGTH: usize> {
    pub series: Series<T, LENGTH>,
    drive: Option<&'a Drive<T, LENGTH>>,
    constants: Constants<T>,
    small_angles: bool,
    sprung: bool,
    /// (c W)_k without c₀ W_k.
    swept: T,
}

impl<'a, R: Real, T: Number<Real = R>, const LENGTH: usize> Recurrence<'a, T, LENGTH> {
    #[inline(always)]
    pub fn new(
        pendulum: &Pendulum<R>,
        start: &Swing<T>,
        drive: Option<&'a Drive<T, LENGTH>>,
        h: R,
    ) -> Self {
        let n = T::from_real;
        let Pendulum { mass_ratio, damping_ratio, lever, coupling, pivot_damping, .. } = *pendulum;
        let (step, r2, nu, beta) =
            (n(h), n(pendulum.frequency_squared), n(pivot_damping), n(coupling));
        let one = T::reciprocal(1);
        let over_b2 = one / (n(pendulum.contact_distance) * n(pendulum.contact_distance));
        let (c0, y0, w0) = (start.c, start.y, start.w);
        let freed = one / pendulum.inertia(y0);
        let turn = if pendulum.small_angles { n(R::ZERO) } else { y0 * w0 * over_b2 };
        let pull = n(mass_ratio) * n(lever) * freed;
        let of_a = pull * c0 * beta;
        let over_step = T::over(h);
        let row = [n(R::ZERO); LENGTH];
        let mut series = Series { x: row, u: row, a: row, y: row, w: row, c: row };
        (series.x[0], series.u[0], series.y[0], series.w[0], series.c[0]) =
            (start.x, start.u, y0, w0, c0);
        let constants = Constants {
            step,
            over_step,
            over_b2,
            beta,
            beta_c0: beta * c0,
            r2,
            nu,
            c0,
            y0,
            w0,
            arc: start.arc,
            stiffness: n(pendulum.spring.stiffness),
            of_arc: pull * c0 * n(pendulum.spring.stiffness),
            freed,
            of_u: -(n(damping_ratio * 2.0) * freed),
            of_b: -pull,
            of_y: pull * w0 * over_b2,
            of_a,
            of_gap: pull * c0 * r2,
            of_last: -(of_a * step * turn),
            of_w: pull * c0 * nu,
            of_turn: pull * turn,
        };
        let (small_angles, sprung) = (pendulum.small_angles, pendulum.spring.acts);
        Self { series, drive, constants, small_angles, sprung, swept: n(R::ZERO) }
    }

    /// From order k to k + 1 (of a: to k).
    #[inline(always)]
    pub fn raise(&mut self, k: usize) {
        let n = T::from_real;
        let zero = n(R::ZERO);
        let (s, is) = (&mut self.series, &self.constants);
        let over = is.step * T::reciprocal(k + 1);
        let (x, u, y, w) = (s.x[k], s.u[k], s.y[k], s.w[k]);
        let last = if k > 0 { s.a[k - 1] } else { zero };
        let [driven, base] = self.drive.map_or([zero; 2], |it| [it.primary[k], it.base[k]]);

        // Everything but W_k and a_{k−1}.
        let mut a = is.of_gap.fused(y, is.freed * (driven - x));
        let mut rest = is.r2 * y;
        if self.sprung {
            let arc = if k > 0 { Spring::wound(is.step, k, s.w[k - 1]) } else { is.arc };
            a = is.of_arc.fused(arc, a);
            rest = is.stiffness.fused(arc, rest);
        }
        let (mut yw, mut cw) = (zero, zero);
        if !self.small_angles && k > 0 {
            let sums = convolutions(&s.y, &s.w, &s.c, &s.a, k);
            (yw, cw) = (y.fused(is.w0, sums[0]), sums[1]);
            let growing = n(R::from((k + 1) as f64)) * is.over_step * is.of_b;
            a = is.of_a.fused(sums[2], is.of_y.fused(yw, growing.fused(cw, a)));
            rest = is.beta.fused(sums[2], rest);
        }

        // The terms of W_k and a_{k−1}, which are known last.
        a = is.of_u.fused(u, is.of_last.fused(last, a));
        let mut of_w = is.of_w;
        if !self.small_angles {
            let times = n(R::from((if k > 0 { k + 2 } else { 1 }) as f64));
            of_w = times.fused(is.of_turn, of_w);
            rest = (is.beta * s.c[1]).fused(last, rest);
        }
        rest = is.nu.fused(w, rest);
        a = of_w.fused(w, a);

        s.a[k] = a;
        s.w[k + 1] = -(over * is.beta_c0.fused(a, rest));
        s.u[k + 1] = over * (a - base);
        s.x[k + 1] = over * u;
        s.y[k + 1] = over * is.c0.fused(w, self.swept);
        if !self.small_angles {
            s.c[k + 1] = -(over * is.over_b2 * is.y0.fused(w, yw));
            self.swept =
                if k > 0 { s.c[k + 1].fused(is.w0, s.c[1].fused(w, cw)) } else { s.c[1] * w };
        }
    }
}

/// Σ y_i W_{k−i}, Σ c_{i+1} W_{k−i} and Σ c_{i+1} a_{k−1−i} over 0 < i < k, the newest terms last, even and
/// odd ones apart.
#[inline(always)]
pub(super) fn convolutions<R: Real, T: Number<Real = R>>(
    y: &[T],
    w: &[T],
    c: &[T],
    a: &[T],
    k: usize,
) -> [T; 3] {
    let mut even = [T::from_real(R::ZERO); 3];
    let mut odd = even;
    let mut i = 2;
    while i + 1 < k {
        if i % 2 == 0 {
            even = with_term(even, [y, w, c, a], k, i);
        } else {
            odd = with_term(odd, [y, w, c, a], k, i);
        }
        i += 1;
    }
    if k > 2 {
        even = with_term(even, [y, w, c, a], k, k - 1);
    }
    if k > 1 {
        odd = with_term(odd, [y, w, c, a], k, 1);
    }
    [even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]]
}

/// The sums with the terms of one index.
#[inline(always)]
fn with_term<R: Real, T: Number<Real = R>>(
    sums: [T; 3],
    [y, w, c, a]: [&[T]; 4],
    k: usize,
    i: usize,
) -> [T; 3] {
    let (w, a) = (w[k - i], a[k - 1 - i]);
    [y[i].fused(w, sums[0]), c[i + 1].fused(w, sums[1]), c[i + 1].fused(a, sums[2])]
}
