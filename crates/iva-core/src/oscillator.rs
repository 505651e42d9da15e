//! The primary system between events: m ẍ + 2ζ ẋ + x = 0 in closed form (paper, Eq. 1 with f = 0).
//!
//! Natural units: time in 1/ωn, M = 1. The free primary has m = 1; with the absorber riding on a
//! wall m = 1 + μ. The motion is a combination of two unit solutions,
//!
//! ```text
//! x(h) = x C(h) + v S(h),    C(0) = 1, Ċ(0) = 0,    S(0) = 0, Ṡ(0) = 1,
//! Ċ = −k S,    Ṡ = C − c S,    k = 1/m, c = 2ζ/m.
//! ```
//!
//! C − 1 and S − h are summed from their power series, so that they keep *relative* accuracy down
//! to the smallest h: a rebound of 10⁻⁹ is as accurate as a flight of half a period. The series
//! needs no case for under-, critical and overdamping, and no library function.
//!
//! **Bounds.** ρ = √k |x| + |v| bounds √(k x² + v²), which never grows (ζ ≥ 0). The pair
//! (√k x, v) obeys a linear system of norm Λ = c/2 + √(c²/4 + k), and so do its derivatives. Hence
//! |x⁽ⁿ⁾| ≤ Λⁿ⁻¹ ρ for n ≥ 1 at every later time, for any ζ: no singularity at ζ = 1.

use crate::compensated::Sum;
use crate::flight::Jet;

/// Terms of the series of C − 1 and S − h, beginning with h².
const TERMS: usize = 20;
/// Terms whose coefficients are computed to twice the precision.
const EXACT_TERMS: usize = 8;
/// Terms whose coefficients' rounding rests matter to a flight: the next is below 10⁻¹⁹.
const RESTS: usize = 4;
/// Terms of the series of the viscous loss, beginning with h.
const LOSS_TERMS: usize = 24;

/// Coefficients of one oscillator; they depend on ζ and m only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// k = 1/m.
    pub stiffness: f64,
    /// c = 2ζ/m.
    pub damping: f64,
    /// Λ, the factor by which each further derivative can grow.
    pub growth: f64,
    /// Longest h for which the series are exact to rounding: 1/Λ, where the first dropped term is
    /// below 2/22! ≈ 2e-21 of the sum.
    pub reach: f64,
    unit_solutions: [[f64; 2]; TERMS],
    /// Rounding rests of the leading coefficients. They are the same in every flight: without them
    /// the energy of an undamped run would drift.
    coefficient_rests: [[f64; 2]; RESTS],
    /// What rounding takes from C − 1 and S − h at h = `reach`, a step taken again and again.
    full_step_rest: [f64; 2],
    loss: [[f64; 3]; LOSS_TERMS],
}

impl Oscillator {
    /// The oscillator of mass `mass` (1 or 1 + μ) on the primary's spring and damper.
    pub fn new(mass: f64, damping_ratio: f64) -> Self {
        let stiffness = 1.0 / mass;
        let damping = 2.0 * damping_ratio / mass;
        let growth = 0.5 * damping + (0.25 * damping * damping + stiffness).sqrt();
        let reach = 1.0 / growth;
        let exact = unit_solutions(stiffness, damping);
        let unit_solutions = exact.map(|pair| pair.map(|coefficient| coefficient.value));
        let coefficient_rests =
            std::array::from_fn(|n| exact[n].map(|coefficient| finite(coefficient.rest)));
        let rounded = kernels(&unit_solutions, reach);
        let full_step_rest =
            std::array::from_fn(|k| finite(full_step(&exact, k, reach).minus(rounded[k])));
        let loss = loss_series(stiffness, damping, 2.0 * damping_ratio);
        Self {
            stiffness,
            damping,
            growth,
            reach,
            unit_solutions,
            coefficient_rests,
            full_step_rest,
            loss,
        }
    }

    /// ẍ of a state.
    #[inline]
    pub fn acceleration(&self, x: f64, v: f64) -> f64 {
        -(self.stiffness * x + self.damping * v)
    }

    /// The derivative that follows two successive derivatives of x.
    #[inline]
    pub fn next_derivative(&self, lower: f64, upper: f64) -> f64 {
        -(self.stiffness * lower + self.damping * upper)
    }

    /// ρ of a state: bounds |v| and, times Λⁿ⁻¹, the n-th derivative of x at every later time.
    #[inline]
    pub fn radius(&self, x: f64, v: f64) -> f64 {
        self.stiffness.sqrt() * x.abs() + v.abs()
    }

    /// What a flight of length h ≤ `reach` adds to a state.
    #[inline]
    pub fn advance(&self, primary: &Primary, h: f64) -> Increment {
        let Primary { x: Sum { value: x, rest: dx }, v: Sum { value: v, rest: dv } } = *primary;
        let [c_minus_1, s_minus_h] = kernels(&self.unit_solutions, h);
        let [c_rest, s_rest] = if h == self.reach {
            self.full_step_rest
        } else {
            let z = h * h;
            interleaved(&self.coefficient_rests, h).map(|sum| z * sum)
        };
        // h + (S − h), with what its rounding loses.
        let s = h + s_minus_h;
        let s_lost = (h - s) + s_minus_h + s_rest;
        Increment {
            curved: x * c_minus_1 + v * s_minus_h,
            curved_rest: x * c_rest + v * s_rest + (dx * c_minus_1 + dv * s_minus_h),
            velocity: v * (c_minus_1 - self.damping * s) - self.stiffness * (x * s),
            velocity_rest: v * (c_rest - self.damping * s_lost) - self.stiffness * (x * s_lost)
                + (dv * (c_minus_1 - self.damping * s) - self.stiffness * (dx * s)),
        }
    }

    /// Energy lost in the damper over a flight of length h ≤ `reach`: ∫ 2ζ v² dt, summed from the
    /// power series of the integral (not a difference of energies).
    pub fn viscous_loss(&self, x: f64, v: f64, h: f64) -> f64 {
        if self.damping == 0.0 {
            return 0.0;
        }
        let sums = interleaved(&self.loss, h);
        h * (x * x * sums[0] + x * v * sums[1] + v * v * sums[2])
    }
}

/// What a flight adds to a state.
#[derive(Debug, Clone, Copy)]
pub struct Increment {
    /// x(h) − x − v h, the part of the displacement that the acceleration makes.
    pub curved: f64,
    /// What rounding takes from `curved`, where it is known.
    pub curved_rest: f64,
    /// v(h) − v.
    pub velocity: f64,
    /// What rounding takes from `velocity`, where it is known.
    pub velocity_rest: f64,
}

/// A state of the primary, carried with its rounding rests.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Primary {
    /// Displacement.
    pub x: Sum,
    /// Velocity.
    pub v: Sum,
}

impl Primary {
    /// The state a flight later, and what the flight added.
    #[inline]
    pub fn after(&self, oscillator: &Oscillator, h: f64) -> (Primary, Increment) {
        let increment = oscillator.advance(self, h);
        let later = Primary {
            x: self.x.plus_parts(
                self.v.value * h + increment.curved,
                self.v.rest * h + increment.curved_rest,
            ),
            v: self.v.plus_parts(increment.velocity, increment.velocity_rest),
        };
        (later, increment)
    }

    /// The state after its velocity has jumped by `sign` · `share` · `velocity`.
    #[inline]
    pub fn kicked(&self, sign: f64, velocity: Sum, share: Sum) -> Primary {
        let kick = share.value * (sign * velocity.value);
        let rest = sign * (share.value * velocity.rest + share.rest * velocity.value);
        Primary { x: self.x, v: self.v.plus_parts(kick, rest) }
    }

    /// Displacement and its derivatives.
    pub fn jet(&self, oscillator: &Oscillator) -> Jet {
        let (value, rate) = (self.x.value, self.v.value);
        let curvature = oscillator.acceleration(value, rate);
        Jet { value, rate, curvature, jerk: oscillator.next_derivative(rate, curvature) }
    }
}

/// C − 1 and S − h at h.
#[inline]
fn kernels(unit_solutions: &[[f64; 2]; TERMS], h: f64) -> [f64; 2] {
    let z = h * h;
    interleaved(unit_solutions, h).map(|sum| z * sum)
}

/// C − 1 (k = 0) or S − h (k = 1) at h to twice the precision.
fn full_step(unit_solutions: &[[Sum; 2]; TERMS], k: usize, h: f64) -> Sum {
    let mut sum = Sum::ZERO;
    for coefficients in unit_solutions.iter().rev() {
        sum = sum.times(h).plus_parts(coefficients[k].value, coefficients[k].rest);
    }
    sum.times(h).times(h)
}

/// A rounding rest, or nothing at damping ratios beyond 1e150, where it overflows.
fn finite(rest: f64) -> f64 {
    if rest.is_finite() { rest } else { 0.0 }
}

/// K polynomials with common argument, N a multiple of 4. The powers are summed in four classes
/// (exponent modulo 4) side by side: a single Horner chain would wait for each of its own products.
#[inline]
fn interleaved<const K: usize, const N: usize>(series: &[[f64; K]; N], h: f64) -> [f64; K] {
    const { assert!(N.is_multiple_of(4)) }
    let z = h * h;
    let w = z * z;
    let step = |sum: [f64; K], next: &[f64; K]| std::array::from_fn(|k| sum[k] * w + next[k]);
    let [mut c0, mut c1, mut c2, mut c3] =
        [series[N - 4], series[N - 3], series[N - 2], series[N - 1]];
    for block in (0..N / 4 - 1).rev() {
        let next = &series[4 * block..4 * block + 4];
        c0 = step(c0, &next[0]);
        c1 = step(c1, &next[1]);
        c2 = step(c2, &next[2]);
        c3 = step(c3, &next[3]);
    }
    std::array::from_fn(|k| (c0[k] + h * c1[k]) + z * (c2[k] + h * c3[k]))
}

/// Coefficients of h², h³, … of C − 1 and S − h, from y⁽ⁿ⁺²⁾ = −k y⁽ⁿ⁾ − c y⁽ⁿ⁺¹⁾; the leading ones
/// with their rests, the others too small for that to matter.
fn unit_solutions(stiffness: f64, damping: f64) -> [[Sum; 2]; TERMS] {
    let mut series = [[Sum::ZERO; 2]; TERMS];
    for (solution, start) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
        let [mut lower, mut upper] = start.map(Sum::new);
        for (n, coefficients) in series.iter_mut().enumerate() {
            let (p, q) = ((n + 1) as f64, (n + 2) as f64);
            let next = if n < EXACT_TERMS {
                let spring = lower.times(-stiffness).over(p * q);
                let damper = upper.times(-damping).over(q);
                spring.plus_parts(damper.value, damper.rest)
            } else {
                Sum::new(-(stiffness * lower.value / p + damping * upper.value) / q)
            };
            coefficients[solution] = next;
            (lower, upper) = (upper, next);
        }
    }
    series
}

/// Coefficients of h, h², … of ∫ 2ζ v² for the three products x², x v, v² of the starting state,
/// from (x²)˙ = 2 x v, (x v)˙ = v² − k x² − c x v, (v²)˙ = −2k x v − 2c v².
fn loss_series(stiffness: f64, damping: f64, viscous: f64) -> [[f64; 3]; LOSS_TERMS] {
    let mut series = [[0.0; 3]; LOSS_TERMS];
    for product in 0..3 {
        let mut y = [0.0; 3];
        y[product] = 1.0;
        for (n, coefficients) in series.iter_mut().enumerate() {
            let order = (n + 1) as f64;
            let [xx, xv, vv] = y;
            coefficients[product] = viscous * vv / order;
            y = [
                2.0 * xv / order,
                (vv - stiffness * xx - damping * xv) / order,
                -2.0 * (stiffness * xv + damping * vv) / order,
            ];
        }
    }
    series
}
