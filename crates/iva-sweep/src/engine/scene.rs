//! What the core runs, whichever absorber it is.

use iva_core::force::Force;
pub use iva_core::force::{Acts, Harmonic};
use iva_core::host::{DrivenHost, UndrivenHost};
use iva_core::piva::{self, Piva, PivaStart};
use iva_core::real::Real;
use iva_core::siva::Siva;
use iva_core::system::{Start, System};

/// What the core runs. It lives on the stack, once a run.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub enum Scene<R: Real = f64> {
    /// A free mass in free decay.
    Siva {
        /// The absorber.
        system: Siva<UndrivenHost<R>>,
        /// State at time zero.
        start: Start<R>,
    },
    /// A free mass under force.
    DrivenSiva {
        /// The absorber.
        system: Siva<DrivenHost<R>>,
        /// State at time zero.
        start: Start<R>,
    },
    /// A pendulum.
    Piva {
        /// The absorber.
        system: Piva<R>,
        /// State at time zero.
        start: PivaStart<R>,
        /// Acceleration of gravity in the user's unit; `None` where angles count as small and no
        /// length was given: then nothing depends on it, and there is no angle to report.
        gravity: Option<R>,
    },
}

impl<R: Real> Scene<R> {
    /// μ = m/M.
    pub fn mass_ratio(&self) -> R {
        match self {
            Scene::Siva { system, .. } => system.mass_ratio(),
            Scene::DrivenSiva { system, .. } => system.mass_ratio(),
            Scene::Piva { system, .. } => system.parameters().mass_ratio,
        }
    }

    /// Newton's coefficient e on the gap velocity.
    pub fn restitution(&self) -> R {
        match self {
            Scene::Siva { system, .. } => system.restitution(),
            Scene::DrivenSiva { system, .. } => system.restitution(),
            Scene::Piva { system, .. } => system.parameters().restitution,
        }
    }

    /// One-sided clearance d.
    pub fn clearance(&self) -> R {
        match self {
            Scene::Siva { system, .. } => system.clearance(),
            Scene::DrivenSiva { system, .. } => system.clearance(),
            Scene::Piva { system, .. } => system.clearance(),
        }
    }

    /// ζ of the bare primary.
    pub fn damping_ratio(&self) -> R {
        match self {
            Scene::Siva { system, .. } => system.damping_ratio(),
            Scene::DrivenSiva { system, .. } => system.damping_ratio(),
            Scene::Piva { system, .. } => system.parameters().damping_ratio,
        }
    }

    /// What a pendulum is made of.
    pub fn pendulum(&self) -> Option<&piva::Parameters<R>> {
        match self {
            Scene::Siva { .. } | Scene::DrivenSiva { .. } => None,
            Scene::Piva { system, .. } => Some(system.parameters()),
        }
    }

    /// Velocity of the primary at time zero.
    pub fn velocity(&self) -> R {
        match self {
            Scene::Siva { start, .. } | Scene::DrivenSiva { start, .. } => start.velocity,
            Scene::Piva { start, .. } => start.velocity,
        }
    }

    /// Displacement of the primary at time zero.
    pub fn displacement(&self) -> R {
        match self {
            Scene::Siva { start, .. } | Scene::DrivenSiva { start, .. } => start.displacement,
            Scene::Piva { start, .. } => start.displacement,
        }
    }

    /// True if the start holds no energy: nothing will ever move.
    pub fn at_rest(&self) -> bool {
        match self {
            Scene::Siva { system, start } => system.energy(&system.begin(start).0) == 0.0,
            Scene::DrivenSiva { .. } => false,
            Scene::Piva { system, start, .. } => {
                system.force().is_none() && system.energy(&system.begin(start).0) == 0.0
            }
        }
    }

    /// True if the absorber can reach its walls at all.
    pub fn stop_reachable(&self) -> bool {
        match self {
            Scene::Siva { .. } | Scene::DrivenSiva { .. } => true,
            Scene::Piva { system, .. } => system.stop_reachable(),
        }
    }

    /// The sum of all that drives it; `None` in free decay.
    pub fn force(&self) -> Option<&Force<R>> {
        match self {
            Scene::Siva { .. } => None,
            Scene::DrivenSiva { system, .. } => system.force(),
            Scene::Piva { system, .. } => Some(system.force()).filter(|force| !force.is_none()),
        }
    }

    /// True if the base moves.
    pub fn moves_base(&self) -> bool {
        self.force().is_some_and(Force::moves_base)
    }

    /// Acceleration of gravity on a pendulum, in the user's unit.
    pub fn gravity(&self) -> Option<R> {
        match self {
            Scene::Siva { .. } | Scene::DrivenSiva { .. } => None,
            Scene::Piva { gravity, .. } => *gravity,
        }
    }

    /// True if the absorber has an angle to report.
    pub fn has_angle(&self) -> bool {
        self.gravity().is_some()
    }
}
