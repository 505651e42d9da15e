//! The primary without absorber, for comparison.

use std::sync::atomic::AtomicBool;

use crate::absorber::Point;
use crate::absorber::modal::{FEW, MOST, MOST_MODES, Modal, ModalStart, ModalStructure, PRIMARY};
use crate::engine::simulate::{Limits, simulate_from};
use crate::error::Invalid;
use crate::force::{Force, Harmonic};
use crate::measures::steady::{Steady, SteadyValues, SteadyWanted, Window};
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

impl<R: Real> Harmonic<R> {
    /// Amplitude of the steady state of an oscillator of damping ratio ζ under this force:
    /// F/√((1 − Ω²)² + (2ζΩ)²); infinite at resonance without damping.
    pub fn response(&self, damping_ratio: R) -> R {
        let Self { amplitude, frequency, .. } = *self;
        let detuning = (R::ONE - frequency) * (R::ONE + frequency);
        (amplitude / detuning.hypot(damping_ratio * 2.0 * frequency)).abs()
    }
}

/// Amplitudes of the primary without absorber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bare<R = f64> {
    /// Largest |x|.
    pub amplitude: R,
    /// Root mean square of x.
    pub rms: R,
}

/// The amplitudes of the primary without absorber: those of the steady state under a single harmonic force,
/// in closed form; otherwise those in the same window of a run from the same state at the same instant.
/// `None` if that run was cancelled.
///
/// # Errors
/// [`Invalid`] for numbers out of [`crate::range`].
pub fn without_absorber<R: Real>(
    force: &Force<R>,
    damping_ratio: R,
    (from, begin): (Point<R>, R),
    window: &Window<R>,
    limits: &Limits<R>,
    cancel: Option<&AtomicBool>,
) -> Result<Option<Bare<R>>, Invalid> {
    if let (Some(harmonic), true) = (force.harmonics().first(), force.is_single()) {
        let amplitude = harmonic.response(damping_ratio);
        return Ok(Some(Bare { amplitude, rms: amplitude * R::from(0.5).sqrt() }));
    }
    let wanted = SteadyWanted { amplitude: true, rms: true, ..SteadyWanted::default() };
    let mut steady = Steady::new(Window { cycle: None, ..*window }, wanted);
    let run = (damping_ratio, (from, begin), limits, cancel);
    // The system with room for few modes is compiled in doubles alone.
    if R::FAST_PATHS {
        alone::<R, FEW, FEW>(force, run, &mut steady)?;
    } else {
        alone::<R, MOST, MOST_MODES>(force, run, &mut steady)?;
    }
    let SteadyValues { amplitude_max, amplitude_rms, .. } = *steady.values();
    Ok(amplitude_max.zip(amplitude_rms).map(|(amplitude, rms)| Bare { amplitude, rms }))
}

/// Damping ratio, state and instant of the begin, and limits of a run.
type Given<'a, R> = (R, (Point<R>, R), &'a Limits<R>, Option<&'a AtomicBool>);

/// Runs the primary alone, in a system with room for N absorbers and M modes.
fn alone<R: Real, const N: usize, const M: usize>(
    force: &Force<R>,
    (damping_ratio, (from, begin), limits, cancel): Given<'_, R>,
    steady: &mut Steady<R>,
) -> Result<(), Invalid> {
    let structure = ModalStructure::moving_as_one(damping_ratio)?;
    let alone = Modal::<_, N, M>::with_room(structure, &[])?.under(force.clone(), PRIMARY)?;
    let unused = GapPoint { y: R::ZERO, w: R::ZERO };
    let start = ModalStart::new(&[from.x], &[from.v], [unused; N])?;
    simulate_from(&alone, &start, begin, limits, cancel, steady).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::{Acts, Impulse};

    #[test]
    fn a_run_of_the_bare_primary_is_the_closed_form() {
        // An impulse of 1 gives x = sin(ωd τ) exp(−ζτ)/ωd, largest where tan(ωd τ) = ωd/ζ.
        let zeta = 0.2_f64;
        let omega = (1.0 - zeta * zeta).sqrt();
        let force =
            Force::new(Vec::new(), Vec::new(), &[Impulse { velocity: 1.0, time: 2.0 }]).unwrap();
        let at_rest = Point { x: 0.0, v: 0.0 };
        let limits = Limits::new(10.0, 1.0);
        let (from, window) = ((at_rest, 0.0), Window::default());
        let found = without_absorber(&force, zeta, from, &window, &limits, None);
        let time = (omega / zeta).atan() / omega;
        let truth = (omega * time).sin() * (-zeta * time).exp() / omega;
        let found = found.unwrap().unwrap();
        assert!((found.amplitude - truth).abs() < 1e-15, "{found:?} {truth}");
        // ∫x² from the impulse on, by Simpson's rule; all but a share exp(−3.2) of 1/(4ζ).
        let x = |tau: f64| (omega * tau).sin() * (-zeta * tau).exp() / omega;
        let steps = 2000;
        let sum: f64 = (0..=steps)
            .map(|k| {
                let weight = if k % steps == 0 { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
                weight * x(8.0 * f64::from(k) / f64::from(steps)).powi(2)
            })
            .sum();
        let mean = sum * 8.0 / (3.0 * f64::from(steps)) / 10.0;
        assert!((found.rms - mean.sqrt()).abs() < 1e-12, "{found:?} {mean}");
    }

    #[test]
    fn resonance_without_damping_has_no_bound() {
        let harmonic = Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts: Acts::Base };
        assert_eq!(harmonic.response(0.0), f64::INFINITY);
        assert_eq!(harmonic.response(0.05), 1.0);
    }
}
