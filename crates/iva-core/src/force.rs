//! What drives a scene from outside: harmonic force on the primary, harmonic motion of the base
//! (paper, f(t) of Eqs. 1 and 3).
//!
//! With x and the gap relative to the base, a_g the acceleration of the base and A = ẍ + a_g the
//! absolute acceleration of the primary, every equation of the free scene holds with A in place of
//! ẍ, the force f/M added on the right, and u̇ = A − a_g: the free absorber feels A, not ẍ. So base
//! motion is not the same as f/M = −a_g.
//!
//! A force is given to a flight as the Taylor coefficients of its time, exact but for rounding; its
//! phase is reduced to twice the precision, so that it does not drift in long runs.

use std::f64::consts::TAU;

use crate::compensated::Sum;
use crate::error::{Invalid, number};
use crate::range;
use crate::taylor::ORDER;

/// 2π − [`TAU`].
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;
/// Where a force acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// On the primary: the amplitude is f/M.
    Primary,
    /// On all masses, through the base: the amplitude is that of a_g.
    Base,
}

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

/// A sum of harmonic forces; the empty one is free decay.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Force {
    harmonics: Vec<Harmonic>,
}

/// Taylor coefficients of f/M and a_g over a step.
#[derive(Debug, Clone, Copy)]
pub struct Drive<T, const LENGTH: usize = { ORDER + 1 }> {
    /// Of f/M.
    pub primary: [T; LENGTH],
    /// Of a_g.
    pub base: [T; LENGTH],
}

impl Force {
    /// A sum of harmonic forces.
    ///
    /// # Errors
    /// [`Invalid`] naming the first number out of [`crate::range`].
    pub fn new(harmonics: Vec<Harmonic>) -> Result<Self, Invalid> {
        for harmonic in &harmonics {
            range::size("force.amplitude", harmonic.amplitude)?;
            range::positive("force.frequency", harmonic.frequency)?;
            if !harmonic.phase.is_finite() {
                let rule = "give a phase in rad";
                return Err(Invalid::new("force.phase", number(harmonic.phase), rule));
            }
        }
        Ok(Self { harmonics })
    }

    /// What it is the sum of.
    pub fn harmonics(&self) -> &[Harmonic] {
        &self.harmonics
    }

    /// True if nothing acts.
    pub fn is_none(&self) -> bool {
        self.harmonics.is_empty()
    }

    /// The highest frequency in it, 0 if nothing acts.
    pub fn fastest(&self) -> f64 {
        self.harmonics.iter().fold(0.0, |most, harmonic| most.max(harmonic.frequency))
    }

    /// Sum of the amplitudes: neither |f/M| nor |a_g| exceeds it.
    pub fn size(&self) -> f64 {
        self.harmonics.iter().map(|harmonic| harmonic.amplitude.abs()).sum()
    }

    /// Coefficients of powers of t/h from an instant on.
    pub fn drive<const LENGTH: usize>(&self, time: Sum, h: f64) -> Drive<f64, LENGTH> {
        let mut drive = Drive { primary: [0.0; LENGTH], base: [0.0; LENGTH] };
        for harmonic in &self.harmonics {
            let angle = harmonic.angle(time);
            let (s, c) = libm::sincos(angle.value);
            let (mut s, mut c) = (s + c * angle.rest, c - s * angle.rest);
            let row = drive.row(harmonic.acts);
            let turn = harmonic.frequency * h;
            for (k, coefficient) in row.iter_mut().enumerate() {
                *coefficient += harmonic.amplitude * c;
                let by = turn / (k + 1) as f64;
                (s, c) = (by * c, -(by * s));
            }
        }
        drive
    }

    /// The same to twice the precision.
    pub fn precise(&self, time: Sum, h: f64) -> Drive<Sum> {
        let mut drive = Drive { primary: [Sum::ZERO; ORDER + 1], base: [Sum::ZERO; ORDER + 1] };
        for harmonic in &self.harmonics {
            let (mut s, mut c) = sine_cosine(harmonic.angle(time));
            let row = drive.row(harmonic.acts);
            let turn = Sum::new(harmonic.frequency).times(h);
            for (k, coefficient) in row.iter_mut().enumerate() {
                *coefficient = *coefficient + c.times(harmonic.amplitude);
                let by = turn.over((k + 1) as f64);
                (s, c) = (by * c, -(by * s));
            }
        }
        drive
    }

    /// Bounds |F_k| ≤ F̂ qᵏ/(k+1) on the coefficients of f/M and of a_g for every k ≥ N; `None` if
    /// this q is too small.
    pub fn tail(&self, h: f64, order: usize, ratio: f64) -> Option<[f64; 2]> {
        let n = (order + 1) as f64;
        let mut tail = [0.0; 2];
        for harmonic in &self.harmonics {
            // (Ωh/q)ᵏ (k+1)/k! falls from k = N on if Ωh/q < (N+1)²/(N+2).
            let turn = harmonic.frequency * h / ratio;
            if turn * (n + 1.0) >= n * n {
                return None;
            }
            let first = (1..=order).fold(n, |product, k| product * (turn / k as f64));
            tail[usize::from(harmonic.acts == Acts::Base)] += harmonic.amplitude.abs() * first;
        }
        Some(tail)
    }
}

impl<T, const LENGTH: usize> Drive<T, LENGTH> {
    fn row(&mut self, acts: Acts) -> &mut [T; LENGTH] {
        match acts {
            Acts::Primary => &mut self.primary,
            Acts::Base => &mut self.base,
        }
    }
}

impl Harmonic {
    /// Ω t + phase, reduced to [−π, π].
    fn angle(&self, time: Sum) -> Sum {
        let angle = time.times(self.frequency).plus(self.phase);
        let turns = (angle.value / TAU).round();
        angle - Sum { value: TAU, rest: TAU_REST }.times(turns)
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
