//! The slow invariant manifold of the vibro-impact energy sink (Gendelman 2012, Gourc et al. 2015).

use std::f64::consts::PI;

use super::Complex;
use super::half_cycle::HalfCycle;
use crate::absorber::piva::Parameters;
use crate::error::Invalid;

/// θ where the manifold loses its stability by period doubling: π²/(π² − 4).
const PERIOD_DOUBLING: f64 = PI * PI / (PI * PI - 4.0);

/// The slow invariant manifold of one absorber: the amplitude of the primary's vibration at ωn for which the
/// absorber hits each wall once a cycle with a given stroke, and the damping that this gives the primary. To
/// first order in μ: it holds where the amplitude changes little during a cycle.
///
/// **θ** is the amplitude of the absorber's own motion over d. Between impacts it moves uniformly in the
/// inertial frame, a triangle wave of speed s and amplitude θ d, s = (2/π) θ d ωn. At θ = 1 its turning
/// points are the mean positions of the walls: each impact meets the primary at x = 0, where the primary
/// loses most energy. **ξ** is the amplitude of the primary over d.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowManifold {
    mass_ratio: f64,
    /// ρ = (2/π)(1−e)/(1+e), the measure of the loss in an impact; 0 for e = 1.
    pub rho: f64,
    /// ξ_min = ρ/√(1+ρ²), the smallest ξ on the manifold: below it the absorber cannot sustain two impacts a
    /// cycle, and a decaying primary leaves the manifold here.
    pub activation: f64,
    /// ξ_min d, the amplitude |x| below which the absorber is not active, length.
    pub activation_amplitude: f64,
    /// θ of the stable motions: from the fold at ξ_min, 1/(1+ρ²), to period doubling at π²/(π²−4) or, for e
    /// below about 0.09, to where the absorber touches the wall that it has just left (1 for e = 0). With
    /// e = 1 small disturbances neither decay nor grow.
    pub stable_theta: [f64; 2],
    /// ξ at both ends of the range `stable_theta`.
    pub stable_amplitude: [f64; 2],
    /// Largest damping ratio that the absorber adds, (2μ/π)(1+e)/(1−e), at θ = 1; infinite for
    /// e = 1.
    pub largest_added_damping: f64,
    /// Amplitude |x| at which the added damping is largest, ρ d = d (2/π)(1−e)/(1+e), length: for the most
    /// damping at an amplitude x choose d = x (π/2)(1+e)/(1−e).
    pub best_amplitude: f64,
}

/// The slow invariant manifold of a free mass of mass ratio μ, restitution e and one-sided clearance
/// d (length) on a primary system that vibrates at its natural frequency.
///
/// ```text
/// ρ = (2/π)(1−e)/(1+e),   ξ² = (θ−1)² + ρ²θ²
/// ```
///
/// It is the limit of the motion of Masri and Caughey (see [`super::masri_caughey`]) for μ → 0 at Ω = 1, with
/// the vibration of the primary given instead of the force: x at the impact is sA − d = (θ−1) d, and B/A = ρ.
///
/// Sources: O. V. Gendelman, Analytic treatment of a system with a vibro-impact nonlinear energy
/// sink, J. Sound Vib. 331 (2012) 4599–4608; E. Gourc, G. Michon, S. Seguy and A. Berlioz, Targeted
/// energy transfer under harmonic forcing with a vibro-impact nonlinear energy sink: analytical and
/// experimental developments, J. Vib. Acoust. 137 (2015) 031008.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn slow_manifold(
    mass_ratio: f64,
    restitution: f64,
    clearance: f64,
) -> Result<SlowManifold, Invalid> {
    Parameters::free_mass(mass_ratio, restitution, clearance, 0.0).check()?;
    let rho = 2.0 / PI * (1.0 - restitution) / (1.0 + restitution);
    let activation = rho / rho.hypot(1.0);
    let fold = 1.0 / (1.0 + rho * rho);
    let stable_theta = [fold, largest_admissible(rho, fold, PERIOD_DOUBLING)];
    Ok(SlowManifold {
        mass_ratio,
        rho,
        activation,
        activation_amplitude: activation * clearance,
        stable_theta,
        stable_amplitude: [activation, amplitude(rho, stable_theta[1])],
        largest_added_damping: 4.0 / (PI * PI) * mass_ratio / rho,
        best_amplitude: rho * clearance,
    })
}

/// ξ at a given θ.
fn amplitude(rho: f64, theta: f64) -> f64 {
    (theta - 1.0).hypot(rho * theta)
}

fn admissible(rho: f64, theta: f64) -> bool {
    let forced = Complex::new(theta - 1.0, rho * theta);
    let half = HalfCycle {
        duration: PI,
        frequency: 1.0,
        damping_ratio: 0.0,
        clearance: 1.0,
        speed: 2.0 / PI * theta,
        forced,
        relative: forced,
        free: [0.0; 2],
    };
    theta > 0.0 && half.stays_in_the_gap()
}

/// The largest admissible θ between `from`, which is admissible, and `to`, which may be.
fn largest_admissible(rho: f64, mut from: f64, mut to: f64) -> f64 {
    if admissible(rho, to) {
        return to;
    }
    loop {
        let middle = 0.5 * (from + to);
        if middle <= from || middle >= to {
            return from;
        }
        *(if admissible(rho, middle) { &mut from } else { &mut to }) = middle;
    }
}

impl SlowManifold {
    /// ξ, the amplitude of the primary over d, at which the absorber's amplitude is θ d.
    pub fn amplitude(&self, theta: f64) -> f64 {
        amplitude(self.rho, theta)
    }

    /// θ of the stable motion where the amplitude of the primary is ξ d; `None` outside the stable range.
    pub fn stable_theta_at(&self, amplitude: f64) -> Option<f64> {
        // The larger root of (1+ρ²) θ² − 2θ + 1 − ξ² = 0.
        let size = self.rho.hypot(1.0);
        let beyond = (amplitude - self.activation) * (amplitude + self.activation);
        let theta = (1.0 + size * beyond.sqrt()) / (size * size);
        (theta <= self.stable_theta[1]).then_some(theta)
    }

    /// Damping ratio that the absorber adds to the primary at a given θ, (4/π²) μ ρ θ²/ξ²: each of the two
    /// impacts a cycle removes 2μ s² (1−e)/(1+e) from its energy x²/2.
    pub fn added_damping(&self, theta: f64) -> f64 {
        let ratio = theta / self.amplitude(theta);
        // At ρ = 0 nothing is lost, except at ξ = 0, the limit of the maxima for e → 1.
        if ratio.is_infinite() {
            return self.largest_added_damping;
        }
        4.0 / (PI * PI) * self.mass_ratio * self.rho * (ratio * ratio)
    }

    /// True if at this θ > 0 the absorber touches no wall between the two impacts of a cycle
    /// (proven, as in [`super::Orbit::admissible`]); otherwise the manifold describes no motion.
    pub fn admissible(&self, theta: f64) -> bool {
        admissible(self.rho, theta)
    }
}
