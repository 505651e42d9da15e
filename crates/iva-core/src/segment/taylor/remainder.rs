//! Bound on the truncation error of a series, from the defects of its polynomials in the equations of motion.
//!
//! In the notation of [`super`], let x, u, y, W, c, φ and a be the polynomials of a step of length H, of order N (a: N − 1), in
//! powers of s = t/H up to s = 1.
//! The recurrences cancel the equations up to order N − 1, so that each equation is left with terms from sᴺ on.
//! With S_g(m) = Σ_{j≥m} |g_j|, the coefficients of a product f g from order N on sum to at most
//!
//! ```text
//! U(f, g) = Σ_i |f_i| S_g(N − i)          Σ_{j>N} j |(c W)_j| ≤ V = Σ_i |c_i| Σ_{m>N−i} (i + m) |W_m|
//! ```
//!
//! and the defects, divided by H and by sᴺ, are at most
//!
//! ```text
//! ẋ: |u_N|          ẏ: U(c, W)          b ċ: U(y, W)/b          Ẇ: β U(c, a) + r² |y_N| + σ² |φ_N| + ν |W_N|
//! φ̇: |W_N|
//! momentum: ρ = μλ (V/H + S_W(0) defect(ċ) + defect(Ẇ)) + |x_N| + 2ζ |u_N| + what is left out of f/M
//! u̇: ρ/D + what is left out of the base's acceleration          Ẇ, through a: β ρ/D
//! ```
//!
//! The error e of (x, u) and of (y, W/F, b c, φ), F at least the fastest rate of the equations, obeys e′ ≤ Λ e + δ sᴺ from
//! e(0) = 0: Λ is a matrix of two by two bounds on sums of partial derivatives of the equations, δ the defects. The series of
//! the solution of e′ = Λ e + δ sᴺ gives
//!
//! ```text
//! e(s) ≤ sᴺ⁺¹/(N+1) (δ + Λδ/(N+2) + Λ²δ/((N+2)(N+3)) + …) ≤ sᴺ⁺¹/(N+1) (1 − Λ/(N+2))⁻¹ δ,
//! ```
//!
//! as the comparison theorem for quasimonotone systems allows (W. Walter, *Differential and integral inequalities*,
//! 1970). A defect that sets in so late leaves the growth e^Λ no time. Λ holds on a neighbourhood of the polynomials
//! that the bound must turn out to stay within ([`Remainder::within`]); |c| ≤ 1 and |y| ≤ b hold there up to a factor of 1.01, because c² + y²/b² = 1 is left by no
//! more than the defects; |φ| grows by no more than H |W| from its begin.
//!
//! The rounding of the coefficients is no part of the bound; a margin covers that of its own sums.

use super::{ORDER, Pendulum, Series, unrolled};
use crate::number::real::Real;

/// Bound on the truncation error of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder<R = f64> {
    order: usize,
    /// The share of the step for which it was found.
    most: R,
    /// Bounds on the error of (x, u) and of (y, W/F) there; infinite if nothing is proved.
    left_out: [R; 2],
    /// How much of the neighbourhood of the polynomials they need: the bounds hold where it is at most 1.
    within: R,
}

/// Room for the rounding of the sums and of the coefficients.
const MARGIN: f64 = 1.1;
/// The neighbourhood of the polynomials on which Λ holds, relative to b, and to κL in accelerations.
const NEIGHBOURHOOD: f64 = 1e-3;
/// By how much |c|, |y| and 1/D may exceed their bounds there.
const WIDER: f64 = 1.01;

impl<R: Real> Remainder<R> {
    /// The bound for the series of a step of length h, up to `most` of it; `fastest`: F, at least the fastest rate of
    /// the equations; `driven`: what is
    /// left out of f/M and of the base's acceleration up to there ([`crate::force::Force::left_out`]).
    #[inline(always)]
    pub fn new<const N: usize>(
        pendulum: &Pendulum<R>,
        fastest: R,
        series: &Series<R>,
        driven: [R; 2],
        (h, most): (R, R),
    ) -> Self {
        let Series { x, u, a, y, w, c } = series;
        let sums = Sums::new::<N, _>(Swung { y, w, c, a, lean: c }, most);
        let lasts = [x, u].map(|row| row[N].abs() * power(most, N));
        let defects = Defects::new(pendulum, (&sums, lasts), driven, h * most, N);
        let [primary, gap, within] = defects.grown(pendulum, fastest, &sums, N as f64);
        Self { order: N, most, left_out: [primary, gap], within }
    }

    /// The order of the series.
    #[inline(always)]
    pub(crate) fn order(&self) -> usize {
        self.order
    }

    /// True if anything is proved.
    #[inline(always)]
    pub fn proves(&self) -> bool {
        self.within < R::INFINITY
    }

    /// The share of the step for which the bound was found.
    #[inline(always)]
    pub fn most(&self) -> R {
        self.most
    }

    /// Bounds on what is left out up to a share of the step, not above [`Self::most`]: of (x, u) and of (y, W/F).
    #[inline(always)]
    pub fn left_out(&self, share: R) -> [R; 2] {
        let part = self.part(share);
        self.left_out.map(|bound| bound * part)
    }

    /// How much of the neighbourhood of the polynomials the bounds need up to a share: they hold if at most 1.
    #[inline(always)]
    pub fn within(&self, share: R) -> R {
        self.within * self.part(share)
    }

    /// The errors up to a share over those at `most`.
    #[inline(always)]
    fn part(&self, share: R) -> R {
        power(share / self.most, self.order + 1)
    }
}

/// pⁿ of an n < 256 by multiplications alone.
#[inline(always)]
fn power<R: Real>(p: R, n: usize) -> R {
    let (mut product, mut square) = (R::ONE, p);
    for bit in 0..8 {
        if n >> bit == 0 {
            break;
        }
        if n >> bit & 1 == 1 {
            product *= square;
        }
        square *= square;
    }
    product
}

/// Sums over the coefficients of a series in powers of s.
struct Sums<R> {
    /// |y_N|.
    y_last: R,
    /// |W_N| and |W_{N−1}|.
    w_last: R,
    w_before: R,
    /// S_W(0).
    w: R,
    /// S_a(0).
    a: R,
    /// U(c, W).
    cw: R,
    /// U(y, W).
    yw: R,
    /// U(γ, a).
    ca: R,
    /// V, of γ and W.
    cw_rate: R,
}

/// The series of a pendulum, and that of the acceleration of its pivot.
#[derive(Clone, Copy)]
struct Swung<'a, R, const LENGTH: usize> {
    y: &'a [R; LENGTH],
    w: &'a [R; LENGTH],
    c: &'a [R; LENGTH],
    a: &'a [R; LENGTH],
    /// γ, which is c where the pivot moves level.
    lean: &'a [R; LENGTH],
}

impl<R: Real> Sums<R> {
    #[inline(always)]
    fn new<const N: usize, const LENGTH: usize>(series: Swung<'_, R, LENGTH>, most: R) -> Self {
        let mut scales = [R::ONE; ORDER + 1];
        let mut scale = R::ONE;
        #[allow(unused_assignments)] // after the last
        {
            unrolled!(k < N + 1 => {
                scales[k] = scale;
                scale *= most;
            });
        }
        let size = |row: &[R; LENGTH], k: usize| row[k].abs() * scales[k];
        let zero = R::ZERO;
        let [mut w, mut w_rate, mut a] = [zero; 3]; // S_W(m), Σ_{j≥m} j |W_j| and S_a(m)
        let [mut cw, mut yw, mut ca, mut cw_rate] = [zero; 4];
        unrolled!(i < N + 1 => {
            // V needs the sums from m + 1 on, the others from m = N − i on.
            let m = N - i;
            let [c, lean] = [size(series.c, i), size(series.lean, i)];
            cw_rate = lean.mul_add(w.mul_add(R::from(i as f64), w_rate), cw_rate);
            let term = size(series.w, m);
            w += term;
            #[allow(unused_assignments)] // after the last
            {
                w_rate = term.mul_add(R::from(m as f64), w_rate);
            }
            if m < N {
                a += size(series.a, m);
            }
            cw = c.mul_add(w, cw);
            ca = lean.mul_add(a, ca);
            yw = size(series.y, i).mul_add(w, yw);
        });
        Self {
            y_last: size(series.y, N),
            w_last: size(series.w, N),
            w_before: size(series.w, N - 1),
            w,
            a,
            cw,
            yw,
            ca,
            cw_rate,
        }
    }
}

/// Bounds on the defects of the polynomials in the equations of one pendulum, over sᴺ.
struct Own<R> {
    y: R,
    bc: R,
    /// That of Ẇ over H, but for what comes through a.
    w: R,
    /// μλ times what is missing in ÿ: its part of ρ.
    pulled: R,
    arc: R,
}

impl<R: Real> Own<R> {
    #[inline(always)]
    fn new(pendulum: &Pendulum<R>, sums: &Sums<R>, length: R, order: usize) -> Self {
        let Pendulum { mass_ratio, contact_distance: b, lever, coupling, level, rise, .. } =
            *pendulum;
        let y = length * sums.cw;
        let bc = if pendulum.small_angles { R::ZERO } else { length * sums.yw / b };
        let arc_last = length * sums.w_before / (order as f64);
        let w = coupling * sums.ca
            + pendulum.frequency_squared * sums.y_last
            + pendulum.spring.defect(arc_last)
            + pendulum.pivot_damping * sums.w_last;
        // That of γ, times b.
        let bent = if rise == 0.0 { bc } else { level.abs() * bc + rise.abs() * y };
        let through_gap = sums.cw_rate / length + sums.w * bent / (length * b) + w;
        let arc = if pendulum.spring.acts { length * sums.w_last } else { R::ZERO };
        Self { y, bc, w, pulled: mass_ratio * lever * through_gap, arc }
    }

    /// δ of the gap: those of y, W/F, b c and φ together, where the acceleration has this defect.
    #[inline(always)]
    fn delta(&self, pendulum: &Pendulum<R>, acceleration: R, length: R, fastest: R) -> R {
        let w = length * (self.w + pendulum.coupling * acceleration);
        let turned = R::larger(w / fastest, self.arc);
        R::larger(R::larger(self.y, self.bc), turned)
    }

    /// How far c² + y²/b² is from 1, as a share of what the bounds allow; `mobility`: φ·φ at the pivot.
    #[inline(always)]
    fn off_circle(&self, pendulum: &Pendulum<R>, mobility: R) -> R {
        let over_b = R::ONE / pendulum.contact_distance;
        let circle = (self.y + self.bc) * over_b * 4.0;
        circle * pendulum.mass_ratio.mul_add(mobility, R::ONE) / (WIDER - 1.0)
    }
}

/// Bounds on partial derivatives in the equations of one pendulum, on the neighbourhood.
struct Slopes<R> {
    /// Of its pull at the pivot by the gap.
    pull: R,
    /// Of ẏ and b ċ.
    swung: R,
    /// Of Ẇ by the gap, but for what comes through a.
    own: R,
}

impl<R: Real> Slopes<R> {
    /// `defect`: that of a.
    #[inline(always)]
    fn new(pendulum: &Pendulum<R>, sums: &Sums<R>, defect: R, (fastest, length): (R, R)) -> Self {
        let Pendulum {
            mass_ratio,
            contact_distance: b,
            lever,
            coupling,
            frequency_squared: r2,
            pivot_damping: nu,
            spring,
            small_angles,
            level,
            rise,
            ..
        } = *pendulum;
        let over_b = R::ONE / b;
        // By how much γ, and sin(θ − α), change at most with b c and y.
        let bent = level.abs() + rise.abs();
        // Bounds on θ̇ = W/b and on β a/b on the neighbourhood; at small angles neither has an effect.
        let nonlinear = |size: R| if small_angles { R::ZERO } else { size };
        let turning = nonlinear((sums.w * over_b + NEIGHBOURHOOD) * WIDER);
        let pull = coupling * (sums.a + defect) * over_b;
        let pulled = nonlinear((pull + NEIGHBOURHOOD) * WIDER) * bent;
        let wide = R::from(WIDER);
        let centrifugal = turning * (turning + fastest * wide * 2.0 + nu);
        let wound = spring.steepness(length * turning);
        let hanging = (r2 + nonlinear(r2) + wound + fastest * nu) * wide;
        let pull = ((centrifugal + hanging) * bent + pulled * wide * 2.0) * (mass_ratio * lever);
        Self { pull, swung: turning + fastest * wide, own: pulled + r2 + wound }
    }
}

/// Partial derivatives of a by x and u together.
#[inline(always)]
fn by_primary<R: Real>(damping_ratio: R, over_inertia: R) -> R {
    (R::ONE + damping_ratio * 2.0) * over_inertia
}

/// Bounds on the defects of the polynomials in the equations of motion, over sᴺ.
struct Defects<R> {
    /// H, the length of the step times the share that the bound is for.
    length: R,
    /// Upper bound on 1/D.
    over_inertia: R,
    /// Bound on ρ/D, the defect of the acceleration.
    acceleration: R,
    x: R,
    u: R,
    own: Own<R>,
}

impl<R: Real> Defects<R> {
    #[inline(always)]
    fn new(
        pendulum: &Pendulum<R>,
        (sums, [x_last, u_last]): (&Sums<R>, [R; 2]),
        driven: [R; 2],
        length: R,
        order: usize,
    ) -> Self {
        let Pendulum { mass_ratio, damping_ratio, .. } = *pendulum;
        let own = Own::new(pendulum, sums, length, order);
        // D = 1 + μ − (μ/κ) c².
        let freed = R::ONE + mass_ratio * (R::ONE - R::ONE / pendulum.inertia_ratio);
        let over_inertia = R::from(WIDER) / freed;
        let residual = own.pulled + x_last + damping_ratio * 2.0 * u_last + driven[0];
        let acceleration = residual * over_inertia;
        let (x, u) = (length * u_last, length * (acceleration + driven[1]));
        Self { length, over_inertia, acceleration, x, u, own }
    }

    /// Bounds on the error at s = 1, and the share of the neighbourhood that they need; ∞ if nothing is proved.
    #[inline(always)]
    fn grown(&self, pendulum: &Pendulum<R>, fastest: R, sums: &Sums<R>, order: f64) -> [R; 3] {
        let Pendulum { damping_ratio, contact_distance, coupling, pivot_damping: nu, .. } =
            *pendulum;
        let Self { length, over_inertia, acceleration, .. } = *self;
        let over_b = R::ONE / contact_distance;
        let wide = R::from(WIDER);
        let by_primary = by_primary(damping_ratio, over_inertia);
        let Slopes { pull, swung, own } =
            Slopes::new(pendulum, sums, acceleration, (fastest, length));
        let by_gap = pull * over_inertia;
        let growth = length / (order + 2.0);
        let own = coupling * by_gap * wide + own;
        let gap = R::larger(swung, own / fastest + nu) * growth;
        let primary = R::larger(R::ONE, by_primary) * growth;
        let to_primary = by_gap * growth;
        let to_gap = coupling * by_primary * wide / fastest * growth;
        // (1 − Λ/(N+2))⁻¹ δ/(N+1)
        let [kept_primary, kept_gap] = [R::ONE - primary, R::ONE - gap];
        let determinant = kept_primary * kept_gap - to_primary * to_gap;
        let grown = (R::from(MARGIN) / (order + 1.0)) / determinant;
        let delta =
            [R::larger(self.x, self.u), self.own.delta(pendulum, acceleration, length, fastest)];
        let of_primary = (kept_gap * delta[0] + to_primary * delta[1]) * grown;
        let of_gap = (kept_primary * delta[1] + to_gap * delta[0]) * grown;
        // Within the neighbourhood: y, W and c, a, and D by how far c² + y²/b² is from 1.
        let acceleration = by_primary * of_primary + by_gap * of_gap;
        let within = [of_gap * fastest * over_b, acceleration * coupling * over_b]
            .map(|it| it / NEIGHBOURHOOD)
            .into_iter()
            .fold(self.own.off_circle(pendulum, R::ONE), R::larger);
        let bounded = (kept_primary > 0.0) & (kept_gap > 0.0) & (determinant > 0.0);
        [of_primary, of_gap, within].map(|it| if bounded { it } else { R::INFINITY })
    }
}

pub(super) mod several;
#[cfg(test)]
mod tests;
