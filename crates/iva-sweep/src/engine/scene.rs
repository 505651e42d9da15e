//! A scene: the system of the core that a run simulates, for any kind of absorber.

use iva_core::absorber::alone::Alone;
use iva_core::force::Force;
pub use iva_core::force::{Acts, Harmonic};
use iva_core::host::{DrivenHost, Excitation, UndrivenHost};
use iva_core::piva::{self, Piva, PivaStart};
use iva_core::real::Real;
use iva_core::siva::Siva;
use iva_core::system::{Point, Start, System, Wall};

/// The system of the core that a run simulates, with its start.
#[derive(Debug, Clone)]
pub enum Scene<R: Real = f64> {
    /// A free mass in free decay.
    Siva {
        /// The absorber.
        system: Siva<UndrivenHost<R>>,
        /// State at time zero.
        start: Start<R>,
    },
    /// A free mass under force, or with gravity along its motion.
    DrivenSiva {
        /// The absorber.
        system: Siva<DrivenHost<R>>,
        /// State at time zero.
        start: Start<R>,
        /// Acceleration of gravity in the user's unit; `None` where the motion is level.
        gravity: Option<R>,
    },
    /// A structure without absorber in free decay.
    Alone {
        /// The structure.
        system: Alone<UndrivenHost<R>>,
        /// State at time zero.
        start: Point<R>,
    },
    /// A structure without absorber under force.
    DrivenAlone {
        /// The structure.
        system: Alone<DrivenHost<R>>,
        /// State at time zero.
        start: Point<R>,
    },
    /// A pendulum in free decay.
    Piva {
        /// The absorber, which is much larger than all others.
        system: Box<Piva<UndrivenHost<R>>>,
        /// State at time zero.
        start: PivaStart<R>,
        /// Acceleration of gravity in the user's unit; `None` for small angles without a length: then the
        /// motion does not depend on it, and there is no angle to report.
        gravity: Option<R>,
    },
    /// A pendulum under force.
    DrivenPiva {
        /// The absorber, which is much larger than all others.
        system: Box<Piva<DrivenHost<R>>>,
        /// State at time zero.
        start: PivaStart<R>,
        /// Acceleration of gravity in the user's unit; `None` for small angles without a length: then the
        /// motion does not depend on it, and there is no angle to report.
        gravity: Option<R>,
    },
}

/// Code for the system and the start of a scene of any kind.
macro_rules! with_system {
    ($scene:expr, |$system:ident, $start:ident| $body:expr) => {
        match $scene {
            $crate::engine::scene::Scene::Siva { system: $system, start: $start } => $body,
            $crate::engine::scene::Scene::DrivenSiva { system: $system, start: $start, .. } => {
                $body
            }
            $crate::engine::scene::Scene::Alone { system: $system, start: $start } => $body,
            $crate::engine::scene::Scene::DrivenAlone { system: $system, start: $start } => $body,
            $crate::engine::scene::Scene::Piva { system, start: $start, .. } => {
                let $system = &**system;
                $body
            }
            $crate::engine::scene::Scene::DrivenPiva { system, start: $start, .. } => {
                let $system = &**system;
                $body
            }
        }
    };
}
pub(crate) use with_system;

/// The parameters that all absorbers have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Absorber<R = f64> {
    /// μ = m/M.
    pub mass_ratio: R,
    /// Newton's coefficient e on the gap velocity, at wall +.
    pub restitution: R,
    /// Newton's coefficient e on the gap velocity, at wall −.
    pub restitution_minus: R,
    /// One-sided clearance d.
    pub clearance: R,
}

const WALLS: [Wall; 2] = [Wall::Plus, Wall::Minus];

impl<R: Real> Scene<R> {
    /// The absorber; `None` for a structure alone.
    pub fn absorber(&self) -> Option<Absorber<R>> {
        let (mass_ratio, restitution): (R, [R; 2]) = match self {
            Scene::Siva { system, .. } => {
                (system.mass_ratio(), WALLS.map(|wall| system.restitution(wall)))
            }
            Scene::DrivenSiva { system, .. } => {
                (system.mass_ratio(), WALLS.map(|wall| system.restitution(wall)))
            }
            Scene::Alone { .. } | Scene::DrivenAlone { .. } => return None,
            Scene::Piva { system, .. } => {
                (system.parameters().mass_ratio, WALLS.map(|wall| system.restitution(wall)))
            }
            Scene::DrivenPiva { system, .. } => {
                (system.parameters().mass_ratio, WALLS.map(|wall| system.restitution(wall)))
            }
        };
        let clearance = with_system!(self, |system, _start| system.clearance());
        let [restitution, restitution_minus] = restitution;
        Some(Absorber { mass_ratio, restitution, restitution_minus, clearance })
    }

    /// Damping ratio ζ of the primary without absorber.
    pub fn damping_ratio(&self) -> R {
        match self {
            Scene::Siva { system, .. } => system.damping_ratio(),
            Scene::DrivenSiva { system, .. } => system.damping_ratio(),
            Scene::Alone { system, .. } => system.damping_ratio(),
            Scene::DrivenAlone { system, .. } => system.damping_ratio(),
            Scene::Piva { system, .. } => system.parameters().damping_ratio,
            Scene::DrivenPiva { system, .. } => system.parameters().damping_ratio,
        }
    }

    /// The parameters of a pendulum; `None` for any other scene.
    pub fn pendulum(&self) -> Option<&piva::Parameters<R>> {
        match self {
            Scene::Piva { system, .. } => Some(system.parameters()),
            Scene::DrivenPiva { system, .. } => Some(system.parameters()),
            _ => None,
        }
    }

    /// Displacement and velocity of the primary at time zero.
    pub fn primary(&self) -> Point<R> {
        with_system!(self, |system, start| system.primary(&system.begin(start)))
    }

    /// True if the start has no energy and no force acts, so that nothing moves.
    pub fn at_rest(&self) -> bool {
        self.force().is_none()
            && with_system!(self, |system, start| system.energy(&system.begin(start)) == 0.0)
    }

    /// True if the absorber can reach its walls at all; `None` without absorber.
    pub fn stop_reachable(&self) -> Option<bool> {
        self.absorber()?;
        Some(with_system!(self, |system, _start| system.walls_reachable()))
    }

    /// Velocity that the structure gains in an impact on a wall, per gap velocity.
    pub fn impact_gain(&self, wall: Wall) -> R {
        with_system!(self, |system, _start| system.law_at(wall).gain)
    }

    /// The force that drives it; `None` in free decay.
    pub fn force(&self) -> Option<&Force<R>> {
        let force = with_system!(self, |system, _start| system.excitation().force());
        force.filter(|force| !force.is_none())
    }

    /// The middle of the gap, as a value of y; 0 without absorber.
    pub fn gap_offset(&self) -> R {
        with_system!(self, |system, _start| system.offset())
    }

    /// True if the base moves.
    pub fn moves_base(&self) -> bool {
        with_system!(self, |system, _start| system.excitation().moves_base())
    }

    /// Acceleration of gravity on a pendulum, or along the motion of a free mass, in the user's unit.
    pub fn gravity(&self) -> Option<R> {
        match self {
            Scene::Piva { gravity, .. }
            | Scene::DrivenPiva { gravity, .. }
            | Scene::DrivenSiva { gravity, .. } => *gravity,
            _ => None,
        }
    }

    /// Gravity along the motion G = g sin α, in ωn² × length: 0 where the motion is level, `None` unless a
    /// free mass.
    pub fn gravity_along(&self) -> Option<R> {
        match self {
            Scene::Siva { .. } => Some(R::ZERO),
            Scene::DrivenSiva { system, .. } => Some(system.gravity()),
            _ => None,
        }
    }

    /// True if the absorber has an angle to report.
    pub fn has_angle(&self) -> bool {
        self.pendulum().is_some() && self.gravity().is_some()
    }
}
