//! A harmonic force: its Taylor coefficients, and a phase that does not drift.

use std::f64::consts::TAU;

use super::Acts;
use crate::compensated::Sum;
use crate::error::{Invalid, number};
use crate::range;

/// 2π − [`TAU`].
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;
/// 2π to twice the precision.
pub(crate) const WHOLE_TURN: Sum = Sum { value: TAU, rest: TAU_REST };

/// amplitude · cos(Ω t + phase), per unit mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// f/M or a_g, in ωn² × length.
    pub amplitude: f64,
    /// Ω in ωn.
    pub frequency: f64,
    /// Phase at time zero, in rad.
    pub phase: f64,
    /// On the primary or on the base.
    pub acts: Acts,
}

impl Harmonic {
    pub(super) fn check(&self) -> Result<(), Invalid> {
        range::size("force.amplitude", self.amplitude)?;
        range::positive("force.frequency", self.frequency)?;
        if self.phase.is_finite() {
            return Ok(());
        }
        Err(Invalid::new("force.phase", number(self.phase), "give a phase in rad"))
    }

    /// Adds the coefficients of powers of t/h from an instant on.
    pub(super) fn add(&self, row: &mut [f64], time: Sum, h: f64) {
        let angle = self.angle(time);
        let (s, c) = libm::sincos(angle.value);
        let (mut s, mut c) = (s + c * angle.rest, c - s * angle.rest);
        let turn = self.frequency * h;
        for (k, coefficient) in row.iter_mut().enumerate() {
            *coefficient += self.amplitude * c;
            let by = turn / (k + 1) as f64;
            (s, c) = (by * c, -(by * s));
        }
    }

    /// The same to twice the precision.
    pub(super) fn add_precise(&self, row: &mut [Sum], time: Sum, h: f64) {
        let (mut s, mut c) = sine_cosine(self.angle(time));
        let turn = Sum::new(self.frequency).times(h);
        for (k, coefficient) in row.iter_mut().enumerate() {
            *coefficient = *coefficient + c.times(self.amplitude);
            let by = turn.over((k + 1) as f64);
            (s, c) = (by * c, -(by * s));
        }
    }

    /// The bound F̂ of [`super::Force::tail`].
    pub(super) fn tail(&self, h: f64, order: usize, ratio: f64) -> Option<f64> {
        let n = (order + 1) as f64;
        // (Ωh/q)ᵏ (k+1)/k! falls from k = N on if Ωh/q < (N+1)²/(N+2).
        let turn = self.frequency * h / ratio;
        if turn * (n + 1.0) >= n * n {
            return None;
        }
        let first = (1..=order).fold(n, |product, k| product * (turn / k as f64));
        Some(self.amplitude.abs() * first)
    }

    /// Ω t + phase, reduced to [−π, π].
    fn angle(&self, time: Sum) -> Sum {
        let angle = time.times(self.frequency).plus(self.phase);
        let turns = (angle.value / TAU).round();
        angle - WHOLE_TURN.times(turns)
    }
}

/// Sine and cosine to twice the precision, from their series at a 64th of the angle.
fn sine_cosine(angle: Sum) -> (Sum, Sum) {
    const HALVINGS: i32 = 6;
    let small = angle.times(0.5f64.powi(HALVINGS));
    let square = small * small;
    let one = Sum::new(1.0);
    let (mut versine, mut sine) = (Sum::ZERO, Sum::ZERO);
    for k in (1..=9).rev() {
        let n = f64::from(2 * k);
        versine = ((one - versine) * square).over(n * (n - 1.0));
        sine = ((one - sine) * square).over(n * (n + 1.0));
    }
    sine = small * (one - sine);
    for _ in 0..HALVINGS {
        // sin 2α = 2 sinα (1 − (1 − cosα)), 1 − cos 2α = 2 sin²α
        let twice = (sine * (one - versine)).times(2.0);
        versine = (sine * sine).times(2.0);
        sine = twice;
    }
    (sine, one - versine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_lie_on_the_circle() {
        for k in -40..=40 {
            let angle = Sum::new(f64::from(k) * 0.0785);
            let (s, c) = sine_cosine(angle);
            let off = s * s + c * c - Sum::new(1.0);
            assert!(off.value.abs() < 1e-30, "{k}: {:e}", off.value);
            assert!((s.value - angle.value.sin()).abs() < 2e-16);
            assert!((c.value - angle.value.cos()).abs() < 2e-16);
        }
    }

    #[test]
    fn the_phase_does_not_drift() {
        // After a million whole periods, 2π to twice the precision, the angle is the phase again.
        let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.5, acts: Acts::Primary };
        let time = Sum { value: TAU, rest: TAU_REST }.times(1e6);
        assert!((harmonic.angle(time).value - 0.5).abs() < 2e-16);
    }
}
