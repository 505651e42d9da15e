//! What a truncated series leaves out: a proof by induction over the recurrences.
//!
//! Let N be the order, coefficients those of powers of t/h, S = y W/b² and R = β c a + r² y + ν W, so
//! that ċ = −S, Ẇ = −R and the momentum equation reads
//! (1 + μ) a = −x − 2ζ u + μλ (S W + c R). Claim: for every j ≥ J = ⌊N/2⌋
//!
//! ```text
//! |z_j| ≤ Z qʲ/(j+1)²   for z = x, u, y, c, W          |v_j| ≤ V qʲ/(j+1)   for v = a, R, S
//! ```
//!
//! The computed coefficients show it up to N. Beyond, in a product of two series, of each pair of
//! factors i and k − i the one with the smaller index is known, or obeys the claim beyond N as the
//! other does; with k ≥ N and K = max(N, 2i)
//!
//! ```text
//! (k+1)/(k+1−i) ≤ θ_i = (K+1)/(K+1−i)     H₁(z) = Σ_{i≤N} |z_i| q⁻ⁱ θ_i     H₂(z) = Σ_{i≤N} |z_i| q⁻ⁱ θ_i²
//! Σ 1/((i+1)²(k−i+1)²) ≤ σ₂/(k+1)     Σ 1/((i+1)²(k−i+1)) ≤ σ₁/(k+1)     over N ≤ i ≤ k − N
//! |(z z′)_k| ≤ qᵏ/(k+1) · { [Z′ H₂(z) + Z H₂(z′)]/(N+1) + σ₂ Z Z′ }
//! |(z v)_k|  ≤ qᵏ/(k+1) · { V H₁(z) + Z H₂(v)/(N+1) + σ₁ Z V }
//! ```
//!
//! so that the recurrences carry the claim from k to k + 1 if the constants satisfy one inequality
//! each ([`Proof::next`]). Force and base motion obey a claim like a's ([`Force::tail`]). They contain h and q as h/q only: where no small q will do, a larger one is
//! a claim about a shorter step. The sums are σ₂ = (2/N + 4 ln(n/N)/n)/n with n = 2N + 2, falling in n
//! and by ln p ≤ p − 1, and σ₁ = (1 + 2/e)/N, both from 1/(m(n−m)) = (1/m + 1/(n−m))/n.

use super::{ORDER, Pendulum, Row, Series};
use crate::force::Force;
use crate::real::Real;

/// Constants of the claim.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Tail<R = f64> {
    x: R,
    u: R,
    y: R,
    c: R,
    w: R,
    a: R,
    r: R,
    s: R,
}

/// Bounds on every coefficient beyond the order of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder<R = f64> {
    order: usize,
    ratio: R,
    tail: Tail<R>,
}

/// Ratios tried at most, each [`COARSER`] than the one before.
const RATIOS: u32 = 100;
pub(crate) const COARSER: f64 = 1.15;
/// The first, over the decay of the coefficients: as often as not it is enough, and a larger one shortens
/// steps.
const fn first(order: usize) -> f64 {
    match order {
        ..12 => 1.8,
        12..18 => 1.6,
        _ => 1.45,
    }
}
/// Smallest ratio tried.
const FINEST: f64 = 0.03;
/// Margin of the constants over what the known coefficients need: room for the inequalities to
/// hold with, and for the rounding of the coefficients.
const MARGIN: f64 = 2.0;
/// Enlargements of the constants that are tried for each ratio.
pub(crate) const ATTEMPTS: usize = 6;
/// The longest share of a step that a claim with ratio q is used for, times q.
const WITHIN: f64 = 0.5;

impl<R: Real> Remainder<R> {
    /// Proves bounds for the series of a step of length h; `None` if the state is not finite or
    /// its series converges nowhere near the step.
    pub fn prove(
        pendulum: &Pendulum<R>,
        series: &Series<R>,
        force: &Force<R>,
        h: R,
        order: usize,
    ) -> Option<Remainder<R>> {
        R::dispatched(
            #[inline(always)]
            || with_order!(order, N => Self::proved::<N>(pendulum, series, force, h)),
        )
    }

    #[inline(always)]
    fn proved<const N: usize>(
        pendulum: &Pendulum<R>,
        series: &Series<R>,
        force: &Force<R>,
        h: R,
    ) -> Option<Remainder<R>> {
        let mut ratio = first_ratio::<_, N>(series);
        for _ in 0..RATIOS {
            let driven = force.tail::<N>(h, ratio);
            let proof = Proof::new::<N>(pendulum, series, driven, h, ratio);
            let mut tail = proof.first();
            for _ in 0..ATTEMPTS {
                match proof.tried(&tail) {
                    (true, _) => return Some(Remainder::proven::<N>(ratio, tail)),
                    (false, larger) => tail = larger,
                }
            }
            ratio *= COARSER;
        }
        None
    }

    /// The bounds that a proof has come to.
    #[inline(always)]
    pub(crate) fn proven<const N: usize>(ratio: R, tail: Tail<R>) -> Self {
        Self { order: N, ratio, tail }
    }

    /// The order of the series.
    #[inline(always)]
    pub(crate) fn order(&self) -> usize {
        self.order
    }

    /// The longest share of the step, up to `most`, on which the bounds mean anything.
    #[inline(always)]
    pub fn reach(&self, most: R) -> R {
        -R::larger(-(R::from(WITHIN) / self.ratio), -most)
    }

    /// Bounds on what is left out up to a share of the step: of primary (x, u) and gap (y, W).
    #[inline(always)]
    pub fn left_out(&self, share: R) -> [R; 2] {
        let beyond = (self.order + 2) as f64;
        let p = self.ratio * share;
        let sum = power(p, self.order + 1) / ((R::ONE - WITHIN) * (beyond * beyond));
        let Tail { x, u, y, w, .. } = self.tail;
        [R::larger(x, u) * sum, R::larger(y, w) * sum]
    }

    /// Bound on the fourth derivative of the part of y that is left out, in steps.
    pub fn fourth(&self, share: R) -> R {
        // k(k−1)(k−2)(k−3)/(k+1)² < k², and Σ_{k>N} k² pᵏ < 3 (N+1)² p^(N+1) for p ≤ 1/2, N ≥ 10.
        let first = (self.order + 1) as f64;
        let p = self.ratio * share;
        let share = share * share * share * share;
        power(p, self.order + 1) * (first * 3.0 * first) / share * self.tail.y
    }
}

/// The first ratio to try.
#[inline(always)]
pub(crate) fn first_ratio<R: Real, const N: usize>(series: &Series<R>) -> R {
    R::larger(decay::<_, N>(series) * first(N), R::ONE * FINEST)
}

/// By what factor the coefficients fall from one to the next: the eighth root of eight of them.
#[inline(always)]
fn decay<R: Real, const N: usize>(series: &Series<R>) -> R {
    let of = |row: &Row<R>| {
        let size = |k: usize| R::larger(row[k].abs(), row[k - 1].abs());
        let (last, earlier) = (size(N), size(N - 8));
        if earlier > 0.0 { last / earlier } else { R::ZERO }
    };
    let most =
        R::larger(R::larger(of(&series.x), of(&series.u)), R::larger(of(&series.y), of(&series.w)));
    most.sqrt().sqrt().sqrt()
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

impl<R: Real> Tail<R> {
    #[inline(always)]
    pub fn map(&self, other: &Tail<R>, f: impl Fn(R, R) -> R) -> Tail<R> {
        Tail {
            x: f(self.x, other.x),
            u: f(self.u, other.u),
            y: f(self.y, other.y),
            c: f(self.c, other.c),
            w: f(self.w, other.w),
            a: f(self.a, other.a),
            r: f(self.r, other.r),
            s: f(self.s, other.s),
        }
    }

    #[inline(always)]
    fn larger(&self, other: &Tail<R>) -> Tail<R> {
        self.map(other, R::larger)
    }

    #[inline(always)]
    fn times(&self, factor: f64) -> Tail<R> {
        self.map(self, |value, _| value * factor)
    }

    /// False where anything is not finite.
    #[inline(always)]
    fn within(&self, other: &Tail<R>) -> bool {
        let Tail { x, u, y, c, w, a, r, s } = *self;
        let pairs = [x, u, y, c, w, a, r, s]
            .into_iter()
            .zip([other.x, other.u, other.y, other.c, other.w, other.a, other.r, other.s]);
        pairs
            .into_iter()
            .fold(true, |all, (value, bound)| all & (value <= bound) & (bound.abs() < R::INFINITY))
    }
}

/// Sums over the heads of the series.
pub(crate) struct Proof<'a, R = f64> {
    pendulum: &'a Pendulum<R>,
    /// h/q · ((N+2)/(N+1))²
    step: R,
    /// 1/(N+1)
    beyond: R,
    sigma_1: R,
    sigma_2: R,
    /// Constants of f/M and a_g; infinite if q is too small for them.
    driven: [R; 2],
    /// |c₀|
    cosine: R,
    /// 1/D of the momentum equation.
    over_inertia: R,
    /// 1/b²
    over_b2: R,
    /// H₁ of c without its first term, of W.
    c_1: R,
    w_1: R,
    /// H₂
    y_2: R,
    c_2: R,
    w_2: R,
    a_2: R,
    r_2: R,
    s_2: R,
    /// The smallest constants for J ≤ j ≤ N.
    known: Tail<R>,
}

impl<'a, R: Real> Proof<'a, R> {
    /// What a proof with a ratio starts from; `driven` bounds the series of f/M and a_g.
    #[inline(always)]
    pub fn new<const N: usize>(
        pendulum: &'a Pendulum<R>,
        series: &Series<R>,
        driven: [R; 2],
        h: R,
        ratio: R,
    ) -> Self {
        let m = R::from((N + 1) as f64);
        let (beyond, n, order) = (R::ONE / m, m * 2.0, N as f64);
        let grown = (m + 1.0) * beyond;
        let mut proof = Self {
            pendulum,
            step: h / ratio * (grown * grown),
            beyond,
            sigma_1: R::ONE * 1.74 / order,
            sigma_2: (R::from(2.0) / order + (n / order - 1.0) * 4.0 / n) / n,
            driven,
            cosine: series.c[0].abs(),
            over_inertia: R::ONE / pendulum.inertia(series.y[0]),
            over_b2: R::ONE / (pendulum.contact_distance * pendulum.contact_distance),
            c_1: R::ZERO,
            w_1: R::ZERO,
            y_2: R::ZERO,
            c_2: R::ZERO,
            w_2: R::ZERO,
            a_2: R::ZERO,
            r_2: R::ZERO,
            s_2: R::ZERO,
            known: Tail::default(),
        };
        let mut scale = R::ONE; // q⁻ʲ
        let (over_h, over_ratio) = (R::ONE / h, R::ONE / ratio);
        // y, c, W, a, R, S, x, u: one operation for all.
        let (mut sums, mut most) = ([R::ZERO; 8], [R::ZERO; 8]);
        unrolled!(j < N + 1 => {
            // a, R and S are known up to N − 1; at N they follow as all later ones do.
            let next = if j < N { over_h * ((j + 1) as f64) } else { R::ZERO };
            let following = (j + 1).min(ORDER);
            let Series { x, u, y, w, c, a } = series;
            let rates = [w[following].abs() * next, c[following].abs() * next];
            let a = if j < N { a[j].abs() } else { R::ZERO };
            let [r, s] = rates;
            let sizes = [y[j].abs(), c[j].abs(), w[j].abs(), a, r, s, x[j].abs(), u[j].abs()]
                .map(|size| size * scale);
            let first = N.max(2 * j) + 1;
            let theta = R::reciprocal(first - j) * (first as f64);
            let square = theta * theta;
            for (sum, size) in sums.iter_mut().zip(sizes) {
                *sum += size * square;
            }
            proof.w_1 += sizes[2] * theta;
            if j > 0 {
                proof.c_1 += sizes[1] * theta;
            }
            if j >= N / 2 {
                let k = (j + 1) as f64;
                let powers = [k * k, k * k, k * k, k, k, k, k * k, k * k];
                for ((most, size), power) in most.iter_mut().zip(sizes).zip(powers) {
                    let bound = size * power;
                    *most = R::larger(bound, *most);
                }
            }
            #[allow(unused_assignments)] // after the last
            {
                scale *= over_ratio;
            }
        });
        [proof.y_2, proof.c_2, proof.w_2, proof.a_2, proof.r_2, proof.s_2, _, _] = sums;
        let [y, c, w, a, r, s, x, u] = most;
        proof.known = Tail { x, u, y, c, w, a, r, s };
        proof
    }

    /// The constants to try first.
    #[inline(always)]
    pub fn first(&self) -> Tail<R> {
        self.known.times(MARGIN)
    }

    /// Whether the constants prove themselves, and larger ones to try next.
    #[inline(always)]
    pub fn tried(&self, tail: &Tail<R>) -> (bool, Tail<R>) {
        let next = self.next(tail);
        (next.within(tail), tail.larger(&next.times(MARGIN)))
    }

    /// The constants that the recurrences give beyond N if those of the claim hold before.
    #[inline(always)]
    fn next(&self, t: &Tail<R>) -> Tail<R> {
        let Pendulum {
            mass_ratio,
            damping_ratio,
            lever,
            coupling: beta,
            frequency_squared: r2,
            pivot_damping: nu,
            small_angles,
            ..
        } = *self.pendulum;
        let Self { step, beyond, sigma_1, sigma_2, cosine, .. } = *self;
        let pull = mass_ratio * lever;
        let s = if small_angles {
            R::ZERO
        } else {
            let yw = (t.w * self.y_2 + t.y * self.w_2) * beyond + sigma_2 * t.y * t.w;
            yw * self.over_b2
        };
        let c_a = t.a * self.c_1 + t.c * self.a_2 * beyond + sigma_1 * t.c * t.a;
        let c_r = t.r * self.c_1 + t.c * self.r_2 * beyond + sigma_1 * t.c * t.r;
        let s_w = t.s * self.w_1 + t.w * self.s_2 * beyond + sigma_1 * t.w * t.s;
        let linear = (r2 * t.y + nu * t.w) * beyond;
        let [driven, base] = self.driven;
        let force = driven + (t.x + damping_ratio * 2.0 * t.u) * beyond;
        let a = (force + pull * (s_w + c_r + cosine * (beta * c_a + linear))) * self.over_inertia;
        let r = beta * (cosine * t.a + c_a) + linear;
        let c_w = (t.w * self.c_2 + t.c * self.w_2) * beyond + sigma_2 * t.c * t.w;
        Tail {
            x: step * beyond * t.u,
            u: step * (t.a + base),
            y: step * c_w,
            c: step * t.s,
            w: step * t.r,
            a,
            r,
            s,
        }
    }
}
#[cfg(test)]
mod tests;
