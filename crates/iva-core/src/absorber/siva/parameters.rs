//! The parameters of a free mass.

use crate::error::Invalid;
use crate::number::real::Real;
use crate::range;

/// Checked parameters of a SIVA on its primary system, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<R = f64> {
    pub(super) mass_ratio: R,
    pub(super) restitution: R,
    pub(super) clearance: R,
    pub(super) damping_ratio: R,
}

impl<R: Real> Parameters<R> {
    /// Mass ratio μ > 0, restitution e in [0, 1], one-sided clearance d > 0, and the damping ratio
    /// ζ ≥ 0 of the primary, within the bounds of [`crate::range`].
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn new(
        mass_ratio: R,
        restitution: R,
        clearance: R,
        damping_ratio: R,
    ) -> Result<Self, Invalid> {
        range::mass_ratio("absorber.mass_ratio", mass_ratio)?;
        range::positive("absorber.clearance", clearance)?;
        range::restitution("absorber.restitution", restitution)?;
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        Ok(Self { mass_ratio, restitution, clearance, damping_ratio })
    }

    /// μ = m/M.
    pub fn mass_ratio(&self) -> R {
        self.mass_ratio
    }

    /// Newton's coefficient e on the gap velocity.
    pub fn restitution(&self) -> R {
        self.restitution
    }

    /// One-sided clearance d.
    pub fn clearance(&self) -> R {
        self.clearance
    }

    /// Damping ratio ζ of the primary without absorber.
    pub fn damping_ratio(&self) -> R {
        self.damping_ratio
    }
}
