//! The sum of a chatter with friction.
//!
//! A rebound of speed u leaves a wall that it is pressed to with P = −D̈, stops in its gap, and returns with Q < P, as friction
//! has turned round. With constant P and Q it stops after u/P, returns after another u/√(PQ), and meets the wall with r u,
//! r = √(Q/P): consecutive rebounds are in the ratio ρ = e r. With Q ≤ 0 it does not return at all.
//!
//! To second order in u, let J and K be D⃛ on the way out and back, and let an impact of unit approach speed raise P and Q by β.
//! By perturbation of the two ways, with α = 1/P + 1/√(PQ),
//!
//! ```text
//! a rebound lasts  α u + σ u²,     σ = J/(2P³) + (J/(6P²) + J/(2PQ) + K/(6Q√(PQ)))/√(PQ),
//! returns with     r u (1 + κ u),  κ = J/(6P²) − J/(2PQ) − K/(3Q√(PQ)),
//! and changes P, Q by g u,         g = βr − J/P − K/√(PQ),
//! ```
//!
//! and what later rebounds have of these changes sums up to
//!
//! ```text
//! T = α u/(1−ρ) + u²/((1−ρ)²(1+ρ)) · (ρ (α κ + α′ g) + σ (1−ρ) + α λ g ρ²/(1−ρ)),
//! α′ = dα = −1/P² − (P+Q)/(2 PQ √(PQ)),    λ = d ln r = (1/Q − 1/P)/2.
//! ```
//!
//! With P = Q and J = K that is the sum without friction. As there, the error is estimated from the relative change of the smaller
//! pressure in the whole tail. Of the energy of the first rebound, ½ μ/(1+μ) u², friction takes (1 − r²)/(1 − ρ²), the impacts the rest.

use super::{Rebound, SAFETY};
use crate::number::real::Real;

/// How an absorber returns from the highest point of a rebound.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Back<R = f64> {
    /// Q: acceleration towards the wall on the way back, in ωn² × length; ≤ 0 if it does not return.
    pub pressure: R,
    /// K = D⃛ on the way back.
    pub jerk: R,
    /// By how much the pressure exceeds what holds the absorber at its highest point: Q without more friction at rest than in a slide.
    pub spare: R,
}

impl<R: Real> Back<R> {
    /// r = √(Q/P).
    fn slower(&self, rebound: &Rebound<R>) -> R {
        (self.pressure / rebound.pressure).sqrt()
    }

    /// Duration of the tail to second order.
    pub(super) fn tail(&self, rebound: &Rebound<R>) -> R {
        let Rebound { speed: u, pressure: p, jerk: j, gain, ratio, .. } = *rebound;
        let Self { pressure: q, jerk: k, .. } = *self;
        let one = R::ONE;
        let r = self.slower(rebound);
        let (rho, root) = (ratio * r, (p * q).sqrt());
        let alpha = one / p + one / root;
        let out = j / (p * p) * (1.0 / 6.0);
        let [fallen, back] = [j / (p * q) * 0.5, k / (q * root)];
        let sigma = j / (p * p * p) * 0.5 + (out + fallen + back * (1.0 / 6.0)) / root;
        let kappa = out - fallen - back * (1.0 / 3.0);
        let change = gain * r - j / p - k / root;
        let steeper = -one / (p * p) - (p + q) * 0.5 / (p * q * root);
        let lambda = (one / q - one / p) * 0.5;
        let left = one - rho;
        let second = rho * (alpha * kappa + steeper * change)
            + sigma * left
            + alpha * lambda * change * (rho * rho) / left;
        alpha * u / left + u * u * second / (left * left * (one + rho))
    }

    /// Estimate of the error of the tail.
    pub(super) fn error(&self, rebound: &Rebound<R>) -> R {
        let Rebound { speed: u, pressure: p, jerk: j, gain, fourth, ratio, spread, .. } = *rebound;
        let q = self.pressure;
        let r = self.slower(rebound);
        let least = p.min(q).min(self.spare);
        let each = u / p + u / (p * q).sqrt();
        let later = R::ONE / (R::ONE - ratio * r);
        let jerk = R::larger(j.abs(), self.jerk.abs());
        let epsilon = (each * jerk + gain * u) / least * later;
        let curved = each * each * (fourth / least) * (later * later);
        each * later * SAFETY * (epsilon * epsilon + curved + spread * r * later)
    }

    /// True if the rebounds become ever lower in a ratio that is known.
    pub(super) fn may_end(&self, rebound: &Rebound<R>) -> bool {
        let returns = self.spare > 0.0 && rebound.pressure > 0.0;
        returns && (rebound.ratio + rebound.spread) * self.slower(rebound) < 1.0
    }

    /// A bound on the duration of the tail with any restitution, twice that with e = 1 and constant pressures; infinite if the
    /// absorber does not return.
    pub(crate) fn longest(&self, rebound: &Rebound<R>) -> R {
        let Rebound { speed: u, pressure: p, .. } = *rebound;
        let r = self.slower(rebound);
        if !(self.spare > 0.0 && r < 1.0) {
            return R::INFINITY;
        }
        (u / p + u / (p * self.pressure).sqrt()) * 2.0 / (R::ONE - r)
    }

    /// The part of the energy of the tail that friction takes.
    pub(crate) fn rubbed(&self, rebound: &Rebound<R>) -> R {
        let r = self.slower(rebound);
        let rho = r * rebound.ratio;
        (R::ONE - r * r) / (R::ONE - rho * rho)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rebounds one by one: the two ways by Newton's method in P − J h + ½ R h² and Q likewise.
    fn one_by_one(mut tail: Rebound, mut back: Back) -> [f64; 2] {
        let (mut total, mut rubbed) = (0.0, 0.0);
        while tail.speed > 1e-20 {
            let Rebound { speed: u, pressure: p, jerk: j, gain, fourth, ratio, .. } = tail;
            let mut h = u / p;
            for _ in 0..60 {
                h = (u + h * h * (0.5 * j + fourth * h / 6.0)) / p;
            }
            let height = u * h - p * h * h / 2.0 + j * h.powi(3) / 6.0 + fourth * h.powi(4) / 24.0;
            let fallen = j * h + 0.5 * fourth * h * h;
            let (p, q) = (p - fallen, back.pressure - fallen);
            let k = back.jerk + fourth * h;
            let mut t = (2.0 * height / q).sqrt();
            for _ in 0..60 {
                t = ((2.0 * height + t * t * t * (k / 3.0 + fourth * t / 12.0)) / q).sqrt();
            }
            let approach = q * t - t * t * (0.5 * k + fourth * t / 6.0);
            total += h + t;
            rubbed += 2.0 * height * (p - q);
            let change = gain * approach - k * t - 0.5 * fourth * t * t;
            tail.speed = ratio * approach;
            tail.pressure = p + change;
            back.pressure = q + change;
            tail.jerk = j + fourth * (h + t);
            back.jerk = k + fourth * t;
        }
        [total, rubbed]
    }

    /// The sum is that of the rebounds one by one, but for terms of third order, and the estimate bounds them. Friction takes its
    /// part of the energy.
    #[test]
    fn the_sum_is_that_of_the_rebounds_to_second_order() {
        for (q, j, k, gain, fourth, ratio) in [
            (1.2, 0.7, 0.7, 0.0, 0.0, 0.5),
            (0.7, 0.0, 0.0, 0.0, 0.0, 0.8),
            (0.7, 0.9, 0.0, 0.0, 0.0, 0.8),
            (0.7, 0.0, -1.1, 0.0, 0.0, 0.8),
            (0.3, 0.4, 0.9, 0.8, 0.5, 0.9),
            (0.1, -0.3, -0.2, 0.3, 1.0, 1.0),
        ] {
            let seen = |speed: f64| {
                let back = Back { pressure: q, jerk: k, spare: q };
                let rebound = Rebound {
                    speed,
                    pressure: 1.2,
                    jerk: j,
                    gain,
                    fourth,
                    ratio,
                    back: Some(back),
                    ..Rebound::default()
                };
                let [total, rubbed] = one_by_one(rebound, back);
                // The energy of the rebound is ½ u² per reduced mass.
                let share = back.rubbed(&rebound) * speed * speed - rubbed;
                (rebound.tail() - total, rebound.tail_error(), share / (speed * speed))
            };
            let (coarse, estimate, share) = seen(1e-3);
            let (fine, _, finer) = seen(1e-4);
            // With constant pressures nothing but rounding of a sum of some 1e-2 is left.
            let rounding = 1e-17;
            assert!(
                coarse.abs() <= estimate + rounding,
                "{q} {j} {k}: {coarse:e} beyond {estimate:e}"
            );
            let exact = coarse.abs() < 1e-15;
            assert!(
                exact || (coarse / fine - 1000.0).abs() < 60.0,
                "{q} {j} {k}: {coarse:e} {fine:e}"
            );
            assert!(
                share.abs() < 0.1 && finer.abs() < 0.2 * share.abs() + 1e-12,
                "{share:e} {finer:e}"
            );
        }
    }
}
