//! The way from the core's natural units to the user's.

use super::core::real::Real;

/// Factors from the core's natural units to the user's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// ωn in rad per user time unit.
    pub natural_frequency: Real,
    /// Primary mass, 1 where energies are per unit mass.
    pub mass: Real,
}

impl Scale {
    /// Natural time → user time.
    pub fn time(&self, tau: Real) -> Real {
        tau / self.natural_frequency
    }

    /// Natural velocity → user velocity.
    pub fn velocity(&self, velocity: Real) -> Real {
        velocity * self.natural_frequency
    }

    /// Natural angular velocity → user angular velocity.
    pub fn angular_velocity(&self, rate: Real) -> Real {
        rate * self.natural_frequency
    }

    /// Natural energy → user energy.
    pub fn energy(&self, energy: Real) -> Real {
        energy * (self.mass * self.natural_frequency * self.natural_frequency)
    }
}
