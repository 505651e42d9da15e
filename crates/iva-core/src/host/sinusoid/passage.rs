//! The instants at which a damped sinusoid passes a level between two turning points, several side by side.

use std::f64::consts::PI;

use super::{Motion, Sinusoid, arctangent, fallen};
use crate::number::real::pick;

/// Largest number of steps to a passage: as many as halvings can be told apart.
const MOST_STEPS: usize = 100;
/// After a step of Halley's method that is shorter than this, and along which the velocity changes by a smaller
/// part than this, the error is of the size of the step's cube, which is below rounding.
const SHORT: f64 = 1e-6;

/// A passage that is to be found: x is monotonic between two times, and passes the level from the side of `sign`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passage {
    /// The state from which times count.
    pub from: Motion,
    /// The level.
    pub level: f64,
    /// Positive if x falls through the level, negative if it rises.
    pub sign: f64,
    /// The two times.
    pub between: [f64; 2],
    /// Time and displacement of a turning point of the motion.
    pub turn: (f64, f64),
}

impl Sinusoid {
    /// A time close to a passage: that of a cosine about the turning point before it, with the effect of damping
    /// to first order.
    #[inline(always)]
    fn guess(&self, passage: &Passage) -> f64 {
        let Passage { level, sign, between: [low, high], turn: (time, x), .. } = *passage;
        let middle = low.midpoint(high);
        let halves = ((middle - time) / self.half).floor();
        let less = fallen(-self.decay * self.half * halves.abs())[0];
        let size = x.abs() * pick(halves < 0.0, 1.0 / less, less);
        // x has the sign of `sign` at the turn.
        let beyond = (level > 0.0) != (sign > 0.0);
        let cosine = (level.abs() / size).min(1.0);
        let sine = (1.0 - cosine * cosine).sqrt();
        let steep = sine > cosine;
        let t = arctangent(pick(steep, cosine, sine) / pick(steep, sine, cosine));
        let angle = pick(steep, 0.5 * PI - t, t);
        let (angle, cosine) = (pick(beyond, PI - angle, angle), pick(beyond, -cosine, cosine));
        // x/size is e^(−sθ) (cos θ + s sin θ) after an angle θ, with s = δ/ω.
        let damped = angle + self.share * (1.0 - angle * cosine / (sine + f64::MIN_POSITIVE));
        let guess = damped.mul_add(self.over_omega, halves.mul_add(self.half, time));
        pick((guess > low) & (guess < high), guess, middle)
    }

    /// The times of some passages.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub fn passages<const N: usize>(&self, passages: &[Passage; N]) -> [f64; N] {
        let [mut from_x, mut from_v, mut level, mut sign] = [[0.0; N]; 4];
        let [mut low, mut high, mut h, mut open] = [[0.0; N]; 4];
        for (i, passage) in passages.iter().enumerate() {
            [from_x[i], from_v[i]] = passage.from;
            [low[i], high[i]] = passage.between;
            (level[i], sign[i]) = (passage.level, passage.sign);
            (h[i], open[i]) = (self.guess(passage), 1.0);
        }
        for _ in 0..MOST_STEPS {
            for i in 0..N {
                let [x, rate] = self.after([from_x[i], from_v[i]], h[i]);
                let (value, bend) = (x - level[i], self.acceleration([x, rate]));
                let early = (value > 0.0) == (sign[i] > 0.0);
                low[i] = pick(early, h[i], low[i]);
                high[i] = pick(early, high[i], h[i]);
                let step = -value * rate / rate.mul_add(rate, -0.5 * value * bend);
                let next = h[i] + step;
                let inside = (next > low[i]) & (next < high[i]);
                let short = (step.abs() <= SHORT) & ((step * bend).abs() <= SHORT * rate.abs());
                // Rounding may point beyond a bound that is the passage itself.
                let next = pick(short, next.max(low[i]).min(high[i]), next);
                let next = pick(inside | short, next, low[i].midpoint(high[i]));
                let still = (next - h[i]).abs() <= f64::EPSILON * high[i];
                let going = open[i] > 0.0;
                h[i] = pick(going & (value != 0.0), next, h[i]);
                open[i] = pick(going & !(short | still | (value == 0.0)), 1.0, 0.0);
            }
            if open.iter().sum::<f64>() == 0.0 {
                break;
            }
        }
        h
    }
}
