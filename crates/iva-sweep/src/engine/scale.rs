//! Conversion from natural units to the user's units.

use iva_core::real::Real;

/// Factors from natural units to the user's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale<R = f64> {
    /// ωn in rad per user time unit.
    pub natural_frequency: R,
    /// Primary mass; 1 if energies are per unit mass.
    pub mass: R,
}

impl<R: Real> Scale<R> {
    /// Natural time → user time.
    pub fn time(&self, tau: R) -> R {
        tau / self.natural_frequency
    }

    /// Natural velocity → user velocity.
    pub fn velocity(&self, velocity: R) -> R {
        velocity * self.natural_frequency
    }

    /// Natural angular velocity → user angular velocity.
    pub fn angular_velocity(&self, rate: R) -> R {
        rate * self.natural_frequency
    }

    /// Natural acceleration → user acceleration.
    pub fn acceleration(&self, acceleration: R) -> R {
        acceleration * (self.natural_frequency * self.natural_frequency)
    }

    /// Natural force over the primary mass → user force.
    pub fn force(&self, force: R) -> R {
        force * (self.mass * self.natural_frequency * self.natural_frequency)
    }

    /// Velocity gained by the structure → impulse on it.
    pub fn impulse(&self, velocity: R) -> R {
        velocity * (self.mass * self.natural_frequency)
    }

    /// Natural energy → user energy.
    pub fn energy(&self, energy: R) -> R {
        energy * (self.mass * self.natural_frequency * self.natural_frequency)
    }
}
