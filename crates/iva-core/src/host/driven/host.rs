//! A structure under force and base motion, with and without its absorber.

use std::sync::OnceLock;

use super::{Driven, Forces, Moment};
use crate::compensated::Sum;
use crate::force::Force;
use crate::host::Host;
use crate::real::{ONE, Real, ZERO};
use crate::system::Clock;

/// A structure under force and base motion.
#[derive(Debug, Clone)]
pub struct DrivenHost {
    damping_ratio: Real,
    mass_ratio: Real,
    forces: Forces,
    free: Driven,
    /// With the mass 1 + μ; made where the absorber sticks.
    loaded: OnceLock<Box<Driven>>,
}

impl DrivenHost {
    /// A structure of damping ratio ζ under a force, for an absorber of mass ratio μ.
    pub(crate) fn new(damping_ratio: Real, mass_ratio: Real, force: Force) -> Self {
        let forces = Forces::new(force);
        let free = Driven::new(ONE, damping_ratio, &forces);
        Self { damping_ratio, mass_ratio, forces, free, loaded: OnceLock::new() }
    }
}

impl Host for DrivenHost {
    type Structure = Driven;

    fn damping_ratio(&self) -> Real {
        self.damping_ratio
    }

    #[inline(always)]
    fn free(&self) -> &Driven {
        &self.free
    }

    fn loaded(&self) -> &Driven {
        let loaded = || Driven::new(1.0 + self.mass_ratio, self.damping_ratio, &self.forces);
        self.loaded.get_or_init(|| Box::new(loaded()))
    }

    fn begin(&self) -> Moment {
        self.free.moment(Clock::ZERO, Clock::ZERO, 0)
    }

    fn balanced(&self, phase: &Moment, v: Sum) -> Sum {
        phase.pushes.primary.value - v.times(self.free.equation.damping)
    }

    fn leaning(&self, phase: &Moment) -> [Real; 3] {
        let kicked = self.forces.force.impulses().next().map_or(ZERO, |impulse| impulse.velocity);
        [phase.pushes.primary.rate.value, phase.pushes.primary.second.value, kicked]
    }

    fn force(&self) -> Option<&Force> {
        Some(&self.forces.force)
    }

    fn smooth_for(&self, phase: &Moment) -> Real {
        let end = self.forces.force.smooth_until(phase.time, phase.kicks);
        end.map_or(Real::INFINITY, |end| (end - phase.time).value)
    }

    fn due(&self, phase: &Moment) -> Option<Real> {
        self.forces.force.due(phase.time, phase.kicks)
    }

    fn kicked(&self, phase: &Moment) -> Moment {
        self.free.moment(phase.time, phase.time, phase.kicks + 1)
    }
}
