//! The parameters of a pendulum absorber.

use super::STEEP;
use crate::error::{Invalid, number};
use crate::number::real::Real;
use crate::range;
use crate::segment::taylor::{Pendulum, Spring};

/// The parameters of a pendulum absorber, in natural units (ωn = 1, primary mass 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<R = f64> {
    /// Mass ratio μ.
    pub mass_ratio: R,
    /// Restitution e on the gap velocity.
    pub restitution: R,
    /// One-sided clearance d.
    pub clearance: R,
    /// Damping ratio ζ of the primary.
    pub damping_ratio: R,
    /// r = ωp/ωn, frequency of the hanging pendulum over that of the primary; 0 without gravity.
    pub frequency_ratio: R,
    /// L, the distance from the pivot to the centre of mass.
    pub length: R,
    /// κ = I/(m L²) ≥ 1, 1 for a point bob.
    pub inertia_ratio: R,
    /// b, the distance from the pivot to the point of contact; L for a point bob.
    pub contact_distance: R,
    /// ζp, damping ratio of the pivot: that of the pendulum hanging without spring.
    pub pivot_damping_ratio: R,
    /// σ, the frequency of the pendulum on the torsional spring of its pivot alone, over that of the primary:
    /// σ² = k/(m κL²) in ωn². 0 without spring.
    pub spring_ratio: R,
    /// The equations of motion: exact, or linearised for small angles.
    pub angles: Angles,
    /// The impact law: consistent, or as the paper prints it.
    pub impact_law: ImpactLaw,
    /// Largest truncation error of a step of the flight, relative to the size of each variable; 0 for full
    /// double precision.
    pub tolerance: R,
}

/// The form in which the angle enters the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Angles {
    /// sinθ and cosθ: exact.
    #[default]
    Large,
    /// sinθ = θ, cosθ = 1: linear, y = b θ.
    Small,
}

/// The impact law for the velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ImpactLaw {
    /// Momentum is conserved, and restitution multiplies the gap velocity by −e.
    #[default]
    Consistent,
    /// The paper's Eqs. 16 (first part) and 17 as printed, for comparison only: momentum is not
    /// conserved, the energy "lost" may be negative, and rebounds shrink by 2μe/(1 + μ).
    Printed,
}

impl<R: Real> Parameters<R> {
    /// See [`super::Stops::steep`].
    pub(super) fn has_steep_walls(&self) -> bool {
        let Self { clearance, contact_distance, angles, .. } = *self;
        let near = contact_distance * STEEP <= clearance && clearance < contact_distance;
        near && angles == Angles::Large
    }

    /// A point bob on a string or a weightless rod of this length, in contact at the bob, without pivot
    /// damping. The frequency ratio is 1; set it as needed.
    pub fn point_bob(
        mass_ratio: R,
        restitution: R,
        clearance: R,
        damping_ratio: R,
        length: R,
    ) -> Self {
        Self {
            mass_ratio,
            restitution,
            clearance,
            damping_ratio,
            frequency_ratio: R::ONE,
            length,
            inertia_ratio: R::ONE,
            contact_distance: length,
            pivot_damping_ratio: R::ZERO,
            spring_ratio: R::ZERO,
            angles: Angles::Large,
            impact_law: ImpactLaw::Consistent,
            tolerance: R::ZERO,
        }
    }

    /// A free mass, as a point bob at small angles without gravity. The length has no effect.
    pub fn free_mass(mass_ratio: R, restitution: R, clearance: R, damping_ratio: R) -> Self {
        Self {
            frequency_ratio: R::ZERO,
            angles: Angles::Small,
            ..Self::point_bob(mass_ratio, restitution, clearance, damping_ratio, clearance)
        }
    }

    /// The constants of the equations of motion.
    pub(crate) fn pendulum(&self) -> Pendulum<R> {
        let small_angles = self.angles == Angles::Small;
        let lever = self.length / self.contact_distance;
        let spring = Spring::new(self.spring_ratio, small_angles);
        // At small angles spring and gravity are one.
        let held = if small_angles { spring.stiffness } else { R::ZERO };
        Pendulum {
            mass_ratio: self.mass_ratio,
            damping_ratio: self.damping_ratio,
            contact_distance: self.contact_distance,
            inertia_ratio: self.inertia_ratio,
            lever,
            coupling: R::ONE / (self.inertia_ratio * lever),
            frequency_squared: self.frequency_ratio * self.frequency_ratio + held,
            pivot_damping: self.pivot_damping_ratio * 2.0 * self.frequency_ratio,
            spring,
            small_angles,
            level: R::ONE,
            rise: R::ZERO,
        }
    }

    /// Checks every number's range.
    ///
    /// # Errors
    /// [`Invalid`] naming field, value and allowed range.
    pub fn check(&self) -> Result<(), Invalid> {
        range::mass_ratio("absorber.mass_ratio", self.mass_ratio)?;
        range::positive("absorber.clearance", self.clearance)?;
        range::restitution("absorber.restitution", self.restitution)?;
        range::damping_ratio("primary.damping_ratio", self.damping_ratio)?;
        if self.frequency_ratio != 0.0 {
            range::positive("absorber.frequency_ratio", self.frequency_ratio)?;
        }
        range::positive("absorber.length", self.length)?;
        range::positive("absorber.contact_distance", self.contact_distance)?;
        range::damping_ratio("absorber.pivot_damping_ratio", self.pivot_damping_ratio)?;
        range::tolerance("run.tolerance", self.tolerance)?;
        self.check_spring()?;
        if (1.0..=range::LARGEST_RATIO).contains(&self.inertia_ratio.double()) {
            return Ok(());
        }
        Err(Invalid::new(
            "absorber.inertia_ratio",
            number(self.inertia_ratio),
            format!("give a number from 1 to {:e}", range::LARGEST_RATIO),
        ))
    }

    /// A spring needs walls that the pendulum reaches, so that it cannot turn round its pivot.
    fn check_spring(&self) -> Result<(), Invalid> {
        if self.spring_ratio == 0.0 {
            return Ok(());
        }
        range::positive("absorber.spring_ratio", self.spring_ratio)?;
        let Self { clearance, contact_distance, angles, .. } = *self;
        if angles == Angles::Small || clearance < contact_distance {
            return Ok(());
        }
        let most = number(contact_distance);
        let rule = format!(
            "with a spring in its pivot the pendulum must reach its stops: give less than {most}"
        );
        Err(Invalid::new("absorber.clearance", number(clearance), rule))
    }
}
