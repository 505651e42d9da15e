//! The rest of a chatter whose restitution rises to 1 at low speeds, e = 1 − a uᵇ with b < 1: its sum, with a proof.
//!
//! **At constant pressure A.** A rebound of speed u₀ = u lasts 2u/A, and the next ones have uₖ₊₁ = uₖ (1 − gₖ) with
//! gₖ = a uₖᵇ. All last 2S/A together, S = Σ uₖ. As S(u) − S(u₁) = u and g₁ = g (1 − g)ᵇ, the ansatz
//! S = (u/g) Σ cₙ gⁿ gives, with αₙ = 1 + (n − 1) b,
//!
//! ```text
//! Σ cₙ gⁿ (1 − (1 − g)^αₙ) = g:     c₀ = 1/(1 − b),  c₁ = −b/2,  c₂ = −b/6, …
//! ```
//!
//! The sides of it, with five terms, differ by ρ(g) ≤ K g⁶ with K = 6 Σ|cₙ|/(1 − g), because the binomial coefficients of
//! 0 ≤ αₙ < 4 are no larger than 6. So the five terms differ from S by Σ (uₖ/gₖ) ρ(gₖ) ≤ K g⁵ Σ uₖ: by K g⁵ of it at
//! most. At any g ≤ 1 the first term alone is an upper bound of S, as (1 − g)^(1 − b) ≤ 1 − (1 − b) g. For b ≥ 1 the
//! sum has no end.
//!
//! **At the pressure of the motion.** Let the rate of A be J̄ at most in flight, and A rise by β w at an impact of approach
//! speed w. Let T be the sum at constant pressure and η = (J̄/A + β) T ≤ 1/100. Suppose that the rest of the chatter
//! lasts no longer than 1.1 T; then A changes by less than 1.1 J̄ T + 0.7 β A T. With a rate of J̄, a rebound of
//! length h returns with a speed w that differs from u by J̄ h²/4 at most, so by 1.25 J̄ u²/A². Over g that is largest
//! at the first rebound, as b < 1. So all rebounds are between those of two chatters at constant pressure with a (1 ± δ) in
//! place of a, δ = 1.3 · 1.25 J̄ u/(A² g) ≤ 0.9 J̄ T/A, and S lies within a share of 1.1 δ. Together the rest of the
//! chatter lasts T within a share of 2.2 J̄ T/A + 0.7 β T < 4 η, hence less than 1.1 T; and as η is small, the wall presses
//! until its end. So the absorber sticks, and the error of T is 4 η T + K g⁵ T at most. The sum replaces the simulation
//! once that is below rounding ([`Real::NEGLIGIBLE`]). Until then each rebound is a flight of its own.
//!
//! J̄ = |J| + 2T (2R + κ A): R bounds D⁗, twice as the impacts change the motion a little, and an impact changes J by
//! κ w at most, with κ = γ + β²/γ for a structure that gains γ w and whose damper then takes β = 2ζγ. The common velocity
//! of the stick follows from momentum, its place from the centre of mass, up to a time of the third order in T.

use super::Rebound;
use crate::number::real::Real;
use crate::number::root;

/// The number of terms of the sum.
const TERMS: u32 = 5;
/// Largest 1 − e at which it is used.
const LARGEST_FALL: f64 = 0.1;
/// Largest change of the pressure, over the pressure, at which its bound holds.
const LARGEST_CHANGE: f64 = 0.01;
/// The largest binomial coefficient of numbers up to 4.
const BINOMIAL: f64 = 6.0;
/// The bound over the change of the pressure.
const SAFETY: f64 = 4.0;

/// How e = 1 − a uᵇ goes on at lower speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power<R = f64> {
    /// b, from 0 to less than 1.
    pub exponent: R,
    /// κ: bound on the change of J at an impact of unit approach speed.
    pub kick: R,
}

impl<R: Real> Power<R> {
    /// Duration of the rest of the chatter after a rebound, in 1/ωn. Where 1 − e is large, an upper bound.
    pub(super) fn tail(&self, rebound: &Rebound<R>) -> R {
        let fall = R::ONE - rebound.ratio;
        let first = rebound.speed * 2.0 / (rebound.pressure * fall);
        if fall > LARGEST_FALL {
            return first / (R::ONE - self.exponent);
        }
        let sum = self.terms().into_iter().rev().fold(R::ZERO, |sum, term| sum * fall + term);
        first * sum
    }

    /// True if the bound of [`Power::error`] may be below rounding, at a glance: the sum is no shorter than 2u/(A g).
    pub(super) fn may_end(&self, rebound: &Rebound<R>) -> bool {
        let Rebound { speed, pressure, jerk, gain, ratio, .. } = *rebound;
        let least = speed * 2.0 / (pressure * (R::ONE - ratio));
        least * least * (jerk.abs() / pressure + gain) <= R::NEGLIGIBLE
    }

    /// A bound on the error of [`Power::tail`]; ∞ where none is proved.
    pub(super) fn error(&self, rebound: &Rebound<R>) -> R {
        let Rebound { pressure, jerk, gain, fourth, ratio, .. } = *rebound;
        let fall = R::ONE - ratio;
        let change = jerk.abs() / pressure + gain;
        if fall > LARGEST_FALL || fall.is_nan() {
            return R::INFINITY;
        }
        let tail = self.tail(rebound);
        let faster = tail * 2.0 * (fourth * 2.0 + self.kick * pressure);
        let change = tail * (change + faster / pressure);
        if change > LARGEST_CHANGE || change.is_nan() {
            return R::INFINITY;
        }
        let sizes = self.terms().into_iter().fold(R::ZERO, |sum, term| sum + term.abs());
        let left_out = sizes * BINOMIAL / (R::ONE - fall) * root::power(fall, TERMS);
        tail * (change * SAFETY + left_out)
    }

    /// c₀, c₁, …
    fn terms(&self) -> [R; TERMS as usize] {
        let alpha = |n: usize| R::ONE + self.exponent * (n as f64 - 1.0);
        let mut terms = [R::ZERO; TERMS as usize];
        for m in 0..terms.len() {
            let mut left = if m == 0 { R::ONE } else { R::ZERO };
            for (n, term) in terms.iter().enumerate().take(m) {
                // The coefficient of gʲ in 1 − (1 − g)^α.
                let coefficient = (1..m + 1 - n).fold(alpha(n), |coefficient, j| {
                    coefficient * (R::from(j as f64) - alpha(n)) / (j as f64 + 1.0)
                });
                left -= *term * coefficient;
            }
            terms[m] = left / alpha(m);
        }
        terms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::root::{power, root};

    fn rebound(speed: f64, coefficient: f64, [p, q]: [u32; 2]) -> Rebound {
        let ratio = 1.0 - coefficient * power(root(speed, q), p);
        let exponent = f64::from(p) / f64::from(q);
        let zero = Rebound { speed, pressure: 1.3, ratio, ..Rebound::default() };
        Rebound { power: Some(Power { exponent, kick: 0.0 }), ..zero }
    }

    /// At constant pressure, against the sum of millions of rebounds one by one and the two bounds of what is left of it:
    /// the first term from above, and u/g · (1/(1 − b) − 1) from below.
    #[test]
    fn the_sum_is_that_of_rebounds_one_by_one() {
        for (speed, coefficient, [p, q]) in [
            (1e-6, 0.4, [1, 5]),
            (1e-9, 0.4, [1, 5]),
            (1e-3, 0.3, [1, 5]),
            (1e-8, 1.0, [1, 3]),
            (1e-4, 4.0, [1, 2]),
            (1e-7, 9.0, [1, 2]),
        ] {
            let begin = rebound(speed, coefficient, [p, q]);
            let b = f64::from(p) / f64::from(q);
            let (mut u, mut sum) = (speed, 0.0);
            let fall = |u: f64| coefficient * power(root(u, q), p);
            for _ in 0..1_000_000 {
                sum += u;
                u *= 1.0 - fall(u);
            }
            let left = u / fall(u);
            let [low, high] = [1.0 / (1.0 - b) - fall(u), 1.0 / (1.0 - b)];
            let [low, high] = [low, high].map(|by| (sum + left * by) * 2.0 / 1.3);
            let (tail, error) = (begin.tail(), begin.tail_error());
            // Rounding of a million terms.
            let rounding = 1e-12 * tail;
            assert!((high - low) < 1e-5 * tail, "{speed} {b}: {low} {high}");
            let within = error + rounding;
            assert!(
                tail >= low - within && tail <= high + within,
                "{speed} {b}: {low} {tail} {high}"
            );
            let fall = 1.0 - begin.ratio;
            assert!(error < tail * 200.0 * fall.powi(5), "{speed} {b}: {error:e}");
        }
    }

    /// The sum obeys S(u) = u + S(u (1 − g)) within the bounds of both errors, which are what g⁵ makes of them.
    #[test]
    fn the_sum_goes_on_from_rebound_to_rebound() {
        for [p, q] in [[1, 5], [1, 8], [1, 4], [2, 5], [1, 2], [3, 4], [7, 8]] {
            for fall in [0.1, 0.03, 0.01] {
                let exponent = f64::from(p) / f64::from(q);
                let speed = 1e-3;
                let coefficient = fall / power(root(speed, q), p);
                let this = rebound(speed, coefficient, [p, q]);
                let next = rebound(speed * this.ratio, coefficient, [p, q]);
                let off = this.tail() - next.tail() - 2.0 * speed / 1.3;
                let bound = this.tail_error() - next.tail_error();
                assert!(off.abs() <= bound + 4e-16 * this.tail(), "{exponent} {fall}: {off:e}");
                assert!(bound < 600.0 * fall.powi(6) * this.tail(), "{exponent} {fall}");
            }
        }
    }
}
