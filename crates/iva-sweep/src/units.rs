//! Units of inputs and results, in three systems that are never mixed.
//!
//! The core computes with time in 1/ωn and energy per primary mass; a [`Scale`] converts its results to the
//! user's units. Lengths are not scaled.

use crate::fields::Quantity;

pub use crate::engine::scale::Scale;

/// Standard acceleration of gravity in m/s² (CGPM 1901): the unit g of records, and the default of gravity in
/// SI units.
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// The unit system of the numbers of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitSystem {
    /// Mass and stiffness (or frequency) are given: kg, N/m, N s/m, m, s, J.
    Si,
    /// Only a natural frequency is given: seconds; lengths in the unit of clearance and displacement;
    /// energies per unit primary mass.
    Seconds,
    /// Neither is given: ωn = 1, time in 1/ωn; lengths in the unit of clearance and displacement; energies
    /// per unit primary mass.
    Natural,
}

impl UnitSystem {
    /// All of them.
    pub const ALL: [UnitSystem; 3] = [UnitSystem::Si, UnitSystem::Seconds, UnitSystem::Natural];

    /// The unit of a quantity, as written into Arrow field metadata and `repr`.
    pub fn unit(self, quantity: Quantity) -> &'static str {
        use Quantity as Q;
        match (quantity, self) {
            (Q::Ratio | Q::Count | Q::Side, _) => "1",
            (Q::Text | Q::Flag, _) => "",
            (Q::Angle, _) => "rad",
            (Q::Degree, _) => "°",
            (Q::AngularVelocity, Self::Natural) => "rad · ωn",
            (Q::AngularVelocity, _) => "rad/s",
            (Q::Acceleration, Self::Si) => "m/s²",
            (Q::Acceleration, Self::Seconds) => "length of displacement / s²",
            (Q::Acceleration, Self::Natural) => "length of displacement · ωn²",
            (Q::Hertz, _) => "Hz",
            (Q::Millimetre, _) => "mm",
            (Q::Mass, _) => "kg",
            (Q::Force, Self::Si) => "N",
            (Q::Force, Self::Seconds) => "length of displacement / s² per unit primary mass",
            (Q::Force, Self::Natural) => "length of displacement · ωn² per unit primary mass",
            (Q::Impulse, Self::Si) => "N s",
            (Q::Impulse, Self::Seconds) => "length of displacement / s per unit primary mass",
            (Q::Impulse, Self::Natural) => "length of displacement · ωn per unit primary mass",
            (Q::Stiffness, _) => "N/m",
            (Q::Damping, _) => "N s/m",
            (Q::AngularFrequency, Self::Natural) => "ωn",
            (Q::AngularFrequency, _) => "rad/s",
            (Q::Length, Self::Si) => "m",
            (Q::Length, _) => "length of displacement",
            (Q::Velocity, Self::Si) => "m/s",
            (Q::Velocity, Self::Seconds) => "length of displacement / s",
            (Q::Velocity, Self::Natural) => "length of displacement · ωn",
            (Q::Time, Self::Natural) => "1/ωn",
            (Q::Time, _) => "s",
            (Q::Energy, Self::Si) => "J",
            (Q::Energy, Self::Seconds) => "(length of displacement / s)² per unit primary mass",
            (Q::Energy, Self::Natural) => "(length of displacement · ωn)² per unit primary mass",
        }
    }

    /// One sentence on the units, for `repr`, reports and file metadata.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Si => "SI units: kg, N/m, N s/m, m, s, J",
            Self::Seconds => {
                "time in s, lengths in the unit of clearance and displacement, energies per unit primary mass"
            }
            Self::Natural => {
                "ωn = 1: time in 1/ωn, lengths in the unit of clearance and displacement, energies per unit primary mass"
            }
        }
    }

    /// Short name for metadata: `si`, `seconds` or `natural`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "si",
            Self::Seconds => "seconds",
            Self::Natural => "natural",
        }
    }
}
