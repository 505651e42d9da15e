//! The motion of an oscillator without drive in closed form, for less than critical damping.
//!
//! With δ = c/2, ω² = k − δ² and s = (v + δx)/ω, every motion of ẍ + cẋ + kx = 0 is a damped sinusoid:
//!
//! ```text
//! x(h) = Re Z e^{λh},    Z = x − i s,    λ = −δ + iω,    |λ|² = k.
//! ```
//!
//! So its turning points follow each other after half a period π/ω, each smaller than the last by the factor
//! e^{−πδ/ω}, and |Z| bounds |x| at all later times. The series of [`crate::host::oscillator`] hold for short
//! flights and any damping; these formulas hold for any length. Gravity along the motion moves the middle of the
//! motion in flight from 0 to μG (`host/driven/weight.rs`); x then stands for what is left.

use std::any::TypeId;
use std::f64::consts::{FRAC_2_PI, LN_2, LOG2_E, PI};

use crate::number::real::{Real, pick};
use crate::number::trigonometry::{factorials, negated};
use crate::segment::taylor::unrolled;

pub(crate) use passage::Passage;

mod passage;

/// The largest damping ratio of a structure for which the closed form is used: close to critical damping it
/// loses digits, as s is a quotient of small numbers.
pub(crate) const MOST_DAMPED: f64 = 0.8;

/// Low part of π/2.
const QUARTER_REST: f64 = 6.123_233_995_736_766e-17;
/// Low part of ln 2.
const LN_2_REST: f64 = 2.319_046_813_846_299_6e-17;
/// 1.5 · 2⁵²: a number of moderate size added to it is rounded to an integer, which its low bits hold.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// The bits of an exponent in a double, for a value of 0.
const BIAS: u64 = 1023;

/// A structure whose motion between events is a damped sinusoid: no lasting force acts on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoidal {
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Mass ratio μ of the absorber.
    pub mass_ratio: f64,
    /// Gravity G along the motion, in ωn² × length.
    pub gravity: f64,
}

impl Sinusoidal {
    /// The structure of these ζ, μ and G; `None` in other numbers than doubles, and for ζ above [`MOST_DAMPED`].
    pub(super) fn of<R: Real>(numbers: [R; 3]) -> Option<Self> {
        let [damping_ratio, mass_ratio, gravity] = numbers.map(Real::double);
        let fits = TypeId::of::<R>() == TypeId::of::<f64>() && damping_ratio <= MOST_DAMPED;
        fits.then_some(Self { damping_ratio, mass_ratio, gravity })
    }

    /// The middle of the motion: of the structure alone, or with the absorber stuck to it.
    #[inline(always)]
    pub(crate) fn middle(&self, stuck: bool) -> f64 {
        pick(stuck, 0.0, self.gravity * self.mass_ratio)
    }
}

/// One oscillator: the constants of its sinusoids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sinusoid {
    stiffness: f64,
    /// δ, and its share δ/ω.
    decay: f64,
    share: f64,
    /// ω in double-double, and 1/ω.
    omega: f64,
    omega_rest: f64,
    over_omega: f64,
    /// Half a period.
    pub half: f64,
}

/// x and ẋ at one instant.
pub(crate) type Motion = [f64; 2];

impl Sinusoid {
    /// The oscillator of mass `mass` (1, or 1 + μ) on a structure of damping ratio ζ ≤ [`MOST_DAMPED`].
    pub fn new(mass: f64, damping_ratio: f64) -> Self {
        let (stiffness, decay) = (1.0 / mass, damping_ratio / mass);
        let square = decay * decay;
        let complement = stiffness - square;
        let rest = (stiffness - complement) - square - decay.mul_add(decay, -square);
        let omega = complement.sqrt();
        let omega_rest = (rest - omega.mul_add(omega, -complement)) / (2.0 * omega);
        let over_omega = 1.0 / omega;
        let (share, half) = (decay * over_omega, PI * over_omega);
        Self { stiffness, decay, share, omega, omega_rest, over_omega, half }
    }

    /// s of a state.
    #[inline(always)]
    fn side(&self, [x, v]: Motion) -> f64 {
        self.decay.mul_add(x, v) * self.over_omega
    }

    /// |Z|: a bound on |x| from a state on.
    #[inline(always)]
    pub fn radius(&self, [x, v]: Motion) -> f64 {
        let s = self.side([x, v]);
        s.mul_add(s, x * x).sqrt()
    }

    /// ẍ of a state.
    #[inline(always)]
    pub fn acceleration(&self, [x, v]: Motion) -> f64 {
        -(2.0 * self.decay).mul_add(v, self.stiffness * x)
    }

    /// The state after any time h ≥ 0.
    #[inline(always)]
    pub fn after(&self, [x, v]: Motion, h: f64) -> Motion {
        let Self { decay, share, over_omega, .. } = *self;
        let [sine, cosine] = self.turned(h);
        let [left, _] = fallen(-decay * h);
        // The responses to unit displacement and to unit velocity.
        let (displaced, pushed) = (left * share.mul_add(sine, cosine), (left * sine) * over_omega);
        let faster = (-2.0 * decay).mul_add(pushed, displaced);
        [x.mul_add(displaced, v * pushed), v.mul_add(faster, -(self.stiffness * x) * pushed)]
    }

    /// Sine and cosine of the angle ωh.
    #[inline(always)]
    fn turned(&self, h: f64) -> [f64; 2] {
        /// The coefficients of sin r/r − 1 and cos r − 1 in powers of r² from r² on.
        const SINE: [f64; 8] = negated(factorials(3));
        const COSINE: [f64; 8] = negated(factorials(2));
        let angle = self.omega * h;
        let angle_rest = self.omega.mul_add(h, -angle) + self.omega_rest * h;
        let shifted = angle.mul_add(FRAC_2_PI, TO_INTEGER);
        let (bits, quarters) = (shifted.to_bits(), shifted - TO_INTEGER);
        let r = (-quarters).mul_add(0.5 * PI, angle);
        let r = (-quarters).mul_add(QUARTER_REST, r) + angle_rest;
        let z = r * r;
        let (mut odd, mut even) = (SINE[7], COSINE[7]);
        unrolled!(k < 7 => {
            odd = odd.mul_add(z, SINE[6 - k]);
            even = even.mul_add(z, COSINE[6 - k]);
        });
        let (s, c) = (r + (r * z) * odd, 1.0 + z * even);
        let sign = |bits: u64| f64::from_bits(((bits & 2) << 62) | 1.0f64.to_bits());
        let odd = bits & 1 != 0;
        [pick(odd, c, s) * sign(bits), pick(odd, s, c) * sign(bits.wrapping_add(1))]
    }

    /// Time and displacement of the first turning point of x after a state.
    #[inline(always)]
    pub fn first_turn(&self, [x, v]: Motion) -> (f64, f64) {
        // The turn is where Z e^{λh} λ is real: the angle of the point (δv + kx, ωv) is turned back to 0 or π.
        let up = v.abs() * self.omega;
        // At rest x has just turned.
        let falls = (v < 0.0) | ((v == 0.0) & (x > 0.0));
        let right = pick(falls, -1.0, 1.0) * self.decay.mul_add(v, self.stiffness * x);
        let steep = up > right.abs();
        let (less, more) = (pick(steep, right.abs(), up), pick(steep, up, right.abs()));
        let t = arctangent(less / (more + f64::MIN_POSITIVE));
        let angle = pick(steep, 0.5 * PI - t, t);
        let h = pick(right < 0.0, PI - angle, angle) * self.over_omega;
        // One step of Halley's method on ẋ = 0 makes the five digits of the arctangent fifteen.
        let [there, speed] = self.after([x, v], h);
        let a = self.acceleration([there, speed]);
        let jerk = self.acceleration([speed, a]);
        let over = 1.0 / pick(a == 0.0, 1.0, a);
        let step = -speed * over;
        let step = step * (-0.5 * jerk * over).mul_add(step, 1.0);
        let h = (h + step).max(0.0);
        (h, step.mul_add((0.5 * a).mul_add(step, speed), there))
    }

    /// x at a turning point `count` half periods after one at which it is `x`.
    #[inline(always)]
    pub fn later_turn(&self, x: f64, count: u64) -> f64 {
        if count == 0 {
            return x;
        }
        let size = x * fallen(-self.decay * (count as f64 * self.half))[0];
        if count.is_multiple_of(2) { size } else { -size }
    }

    /// The energy lost in the structure's damper in a motion of this length between two states: the integral
    /// of cẋ²/k, of which the part of constant sign is summed by itself.
    #[inline(always)]
    pub fn lost(&self, from: Motion, to: Motion, length: f64) -> f64 {
        let [_, less] = fallen(-2.0 * self.decay * length);
        let turning = |[x, v]: Motion| {
            let s = self.side([x, v]);
            (2.0 * self.omega).mul_add(x * s, -(self.decay * (x - s) * (x + s)))
        };
        let (x, s) = (from[0], self.side(from));
        let swing = (0.5 * self.decay / self.stiffness) * (turning(to) - turning(from));
        (-0.5 * less).mul_add(s.mul_add(s, x * x), swing)
    }
}

/// e^w and e^w − 1 of w ≤ 0, without branches.
#[inline(always)]
fn fallen(w: f64) -> [f64; 2] {
    /// The coefficients of (e^q − 1 − q)/q² in powers of q.
    const TERMS: [f64; 12] = {
        let mut terms = [0.5; 12];
        let mut k = 1;
        while k < terms.len() {
            terms[k] = terms[k - 1] / (k + 2) as f64;
            k += 1;
        }
        terms
    };
    // Below this nothing is left.
    let w = w.max(-700.0);
    let shifted = w.mul_add(LOG2_E, TO_INTEGER);
    let (bits, halvings) = (shifted.to_bits(), shifted - TO_INTEGER);
    let q = (-halvings).mul_add(LN_2, w);
    let q = (-halvings).mul_add(LN_2_REST, q);
    let mut sum = TERMS[11];
    unrolled!(k < 11 => {
        sum = sum.mul_add(q, TERMS[10 - k]);
    });
    let less = q + (q * q) * sum;
    let scale = f64::from_bits(bits.wrapping_add(BIAS) << 52);
    let none = halvings == 0.0;
    [scale.mul_add(less, scale), pick(none, less, scale.mul_add(less, scale - 1.0))]
}

/// The arctangent of a number from 0 to 1 to five digits (C. Hastings, *Approximations for Digital Computers*,
/// 1955).
#[inline(always)]
fn arctangent(q: f64) -> f64 {
    const TERMS: [f64; 6] =
        [0.999_977_26, -0.332_623_47, 0.193_543_46, -0.116_432_87, 0.052_653_32, -0.011_721_2];
    let z = q * q;
    let mut sum = TERMS[5];
    unrolled!(k < 5 => {
        sum = sum.mul_add(z, TERMS[4 - k]);
    });
    q * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::oscillator::{Oscillator, Primary};
    use crate::number::compensated::DoubleDouble;

    /// The motion by the power series of the oscillator in double-double, step by step.
    fn by_series(mass: f64, damping_ratio: f64, from: Motion, h: f64) -> Motion {
        let oscillator = Oscillator::<f64>::new(mass, damping_ratio);
        let mut at = Primary { x: DoubleDouble::new(from[0]), v: DoubleDouble::new(from[1]) };
        // A power of two, so that the length of a step is exact.
        let steps = ((h / oscillator.reach).ceil().max(1.0) as usize).next_power_of_two();
        for _ in 0..steps {
            let a = oscillator.acceleration(&at);
            (at, _) = at.arrived(&oscillator, a, h / steps as f64);
        }
        [at.x.value, at.v.value]
    }

    fn scenes() -> impl Iterator<Item = (f64, f64, Motion, f64)> {
        let masses = [1.0, 1.1, 3.7];
        let ratios = [0.0, 1e-9, 0.0085, 0.3, MOST_DAMPED];
        let starts = [[1.0, 0.0], [0.0, -1.0], [-0.3, 0.7], [0.5, -0.5 * 0.0085], [0.0, 0.0]];
        let times = [0.0, 1e-9, 1e-3, 0.1, 0.7, 1.6, 3.1, 6.3, 47.0, 190.0];
        masses.into_iter().flat_map(move |mass| {
            ratios.into_iter().flat_map(move |ratio| {
                starts
                    .into_iter()
                    .flat_map(move |from| times.into_iter().map(move |h| (mass, ratio, from, h)))
            })
        })
    }

    #[test]
    fn motion_is_that_of_the_power_series() {
        for (mass, ratio, from, h) in scenes() {
            let sinusoid = Sinusoid::new(mass, ratio);
            let (found, truth) = (sinusoid.after(from, h), by_series(mass, ratio, from, h));
            let size = from[0].abs() + from[1].abs();
            for (found, truth) in found.iter().zip(truth) {
                let off = (found - truth).abs();
                assert!(off <= 6e-16 * size * mass, "{mass} {ratio} {from:?} {h}: {off:e}");
            }
        }
    }

    #[test]
    fn x_turns_where_its_velocity_is_zero_and_not_before() {
        for (mass, ratio, from, _) in scenes() {
            let sinusoid = Sinusoid::new(mass, ratio);
            let (h, x) = sinusoid.first_turn(from);
            let [there, speed] = by_series(mass, ratio, from, h);
            let size = sinusoid.radius(from);
            assert!(speed.abs() <= 3e-15 * size, "{mass} {ratio} {from:?}: {speed:e}");
            assert!((x - there).abs() <= 4e-16 * size, "{mass} {ratio} {from:?}");
            assert!(h <= sinusoid.half * (1.0 + 1e-15));
            let [next, _] = sinusoid.after(from, h + sinusoid.half);
            assert!((next - sinusoid.later_turn(x, 1)).abs() <= 1e-15 * size);
            assert!(sinusoid.radius(from) >= x.abs() * (1.0 - 1e-15));
        }
    }

    #[test]
    fn losses_are_those_of_the_series_and_close_the_energy() {
        for (mass, ratio, from, h) in scenes() {
            let (sinusoid, oscillator) =
                (Sinusoid::new(mass, ratio), Oscillator::<f64>::new(mass, ratio));
            let to = sinusoid.after(from, h);
            let lost = sinusoid.lost(from, to, h);
            let energy = |[x, v]: Motion| 0.5 * x.mul_add(x, mass * v * v);
            let size = energy(from);
            let off = (energy(from) - energy(to) - lost).abs();
            assert!(off <= 1e-15 * size, "{mass} {ratio} {from:?} {h}: {off:e} of {size}");
            if h <= oscillator.reach {
                let series = oscillator.viscous_loss(from[0], from[1], h);
                let off = (series - lost).abs();
                assert!(off <= 1e-15 * size, "{mass} {ratio} {from:?} {h}: {off:e}");
            }
        }
    }

    #[test]
    fn passages_lie_on_their_levels() {
        for (ratio, from) in [(0.0, [1.0, 0.2]), (0.05, [1.0, 0.2]), (0.8, [-0.3, 0.7])] {
            let sinusoid = Sinusoid::new(1.0, ratio);
            let turn = sinusoid.first_turn(from);
            // Between the first turn and the next one, and after some turns more.
            for later in [0, 1, 6] {
                let (before, x) =
                    (turn.0 + later as f64 * sinusoid.half, sinusoid.later_turn(turn.1, later));
                let most_beyond = 0.9 * sinusoid.later_turn(1.0, 1);
                for share in [0.999_999, 0.9, 0.5, 1e-3, 1e-9, 0.1, -1e-9, most_beyond] {
                    let between = [before, before + sinusoid.half];
                    let passage = Passage { from, level: share * x, sign: x, between, turn };
                    let [h, same] = sinusoid.passages(&[passage; 2]);
                    let [there, _] = by_series(1.0, ratio, from, h);
                    let off = (there - share * x).abs();
                    assert!(off < 4e-16 * (1.0 + x.abs() * h), "{ratio} {later} {share}: {off:e}");
                    assert!(
                        h == same && between[0] < h && h < between[1],
                        "{ratio} {later} {share}"
                    );
                }
            }
        }
    }
}
