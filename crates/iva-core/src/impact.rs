//! The impact law of two masses (paper, Eqs. 9–14): momentum is conserved and the gap velocity w
//! turns into −e w.
//!
//! The primary gains [`primary_share`] · w, and the pair loses [`energy_loss`]. Of the printed
//! conditions for an impact (Eqs. 7, 8) the approach (wall · w > 0) is missing; the event loop
//! demands it.

use crate::compensated::Sum;
use crate::real::{ONE, Real, ZERO};
use crate::system::Wall;

/// μ(1 + e)/(1 + μ): the share of the gap velocity that the primary gains (Eq. 13).
///
/// With its rounding rest: at e = 1 a share off by half a unit in the last place would make the
/// energy drift from impact to impact.
pub fn primary_share(mass_ratio: Real, restitution: Real) -> Sum {
    let gain = Sum::new(ONE).plus(restitution).times(mass_ratio);
    gain.over_sum(Sum::new(ONE).plus(mass_ratio))
}

/// ½ μ/(1 + μ) (1 − e²) w², per primary mass.
#[inline]
pub fn energy_loss(mass_ratio: Real, restitution: Real, approach: Real) -> Real {
    0.5 * mass_ratio / (1.0 + mass_ratio)
        * ((1.0 - restitution) * (1.0 + restitution))
        * (approach * approach)
}

/// The time in which something that rounding has left over is gone, at this rate and with this second
/// derivative; 0 where the rate would change meanwhile, as in a grazing.
#[inline]
pub fn delay(left: Real, rate: Real, curvature: Real) -> Real {
    let delay = -left / rate;
    let steady = (curvature * delay).abs() <= SHORT * rate.abs() && rate != 0.0;
    if steady { delay } else { ZERO }
}

/// Share of the rate that may change meanwhile.
const SHORT: f64 = 1e-6;

/// One impact of a run, in natural units: time in 1/ωn, velocities in ωn × length, energies per
/// primary mass in ωn² × length².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Instant.
    pub time: Real,
    /// The wall that was hit.
    pub wall: Wall,
    /// Displacement of the primary.
    pub displacement: Real,
    /// Primary velocity just before.
    pub velocity_before: Real,
    /// Primary velocity just after.
    pub velocity_after: Real,
    /// Gap velocity just before: the signed approach velocity.
    pub gap_velocity_before: Real,
    /// Gap velocity just after.
    pub gap_velocity_after: Real,
    /// Velocity of the absorber's centre of mass per gap velocity: 1 for a free mass, L/b for a
    /// pendulum.
    pub lever: Real,
    /// Energy lost.
    pub energy_loss: Real,
}

impl Impact {
    /// Absolute horizontal velocity of the absorber's centre of mass just before.
    pub fn absorber_velocity_before(&self) -> Real {
        self.velocity_before + self.lever * self.gap_velocity_before
    }

    /// Absolute horizontal velocity of the absorber's centre of mass just after.
    pub fn absorber_velocity_after(&self) -> Real {
        self.velocity_after + self.lever * self.gap_velocity_after
    }

    /// Size of the gap velocity just before.
    pub fn approach_speed(&self) -> Real {
        self.gap_velocity_before.abs()
    }

    /// True if the two masses moved towards each other (paper, section 4.1).
    pub fn effective(&self) -> bool {
        self.velocity_before * self.absorber_velocity_before() < 0.0
    }
}
