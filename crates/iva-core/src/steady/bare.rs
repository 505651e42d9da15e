//! The primary without absorber, to compare with.

use std::sync::atomic::AtomicBool;

use super::{Steady, SteadyWanted, Window};
use crate::error::Invalid;
use crate::force::{Force, Harmonic};
use crate::host::Alone;
use crate::real::Real;
use crate::simulate::{Limits, simulate};
use crate::system::Point;

impl<R: Real> Harmonic<R> {
    /// Amplitude of the steady state that it keeps up in an oscillator of damping ratio ζ:
    /// F/√((1 − Ω²)² + (2ζΩ)²); infinite at resonance without damping.
    pub fn response(&self, damping_ratio: R) -> R {
        let Self { amplitude, frequency, .. } = *self;
        let detuning = (R::ONE - frequency) * (R::ONE + frequency);
        (amplitude / detuning.hypot(damping_ratio * 2.0 * frequency)).abs()
    }
}

/// Largest |x| of the primary without absorber: of the steady state under a single harmonic force, in
/// closed form; else in the same window of a run from the same state. `None` if that was cancelled.
///
/// # Errors
/// [`Invalid`] for numbers out of [`crate::range`].
pub fn amplitude_without_absorber<R: Real>(
    force: &Force<R>,
    damping_ratio: R,
    from: Point<R>,
    window: &Window<R>,
    limits: &Limits<R>,
    cancel: Option<&AtomicBool>,
) -> Result<Option<R>, Invalid> {
    if let (Some(harmonic), true) = (force.harmonics().first(), force.is_single()) {
        return Ok(Some(harmonic.response(damping_ratio)));
    }
    let alone = Alone::new(damping_ratio)?.under(force.clone());
    let wanted = SteadyWanted { amplitude: true, ..SteadyWanted::default() };
    let mut steady = Steady::new(Window { cycle: None, ..*window }, wanted);
    simulate(&alone, &from, limits, cancel, &mut steady)?;
    Ok(steady.values().amplitude_max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::{Acts, Impulse};

    #[test]
    fn a_run_of_the_bare_primary_is_the_closed_form() {
        // An impulse of 1: x = sin(ωd τ) exp(−ζτ)/ωd, largest where tan(ωd τ) = ωd/ζ.
        let zeta = 0.2_f64;
        let omega = (1.0 - zeta * zeta).sqrt();
        let force =
            Force::new(Vec::new(), Vec::new(), &[Impulse { velocity: 1.0, time: 2.0 }]).unwrap();
        let at_rest = Point { x: 0.0, v: 0.0 };
        let limits = Limits::new(10.0, 1.0);
        let found =
            amplitude_without_absorber(&force, zeta, at_rest, &Window::default(), &limits, None);
        let time = (omega / zeta).atan() / omega;
        let truth = (omega * time).sin() * (-zeta * time).exp() / omega;
        let found = found.unwrap().unwrap();
        assert!((found - truth).abs() < 1e-15, "{found} {truth}");
    }

    #[test]
    fn resonance_without_damping_has_no_bound() {
        let harmonic = Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts: Acts::Base };
        assert_eq!(harmonic.response(0.0), f64::INFINITY);
        assert_eq!(harmonic.response(0.05), 1.0);
    }
}
