//! A scene: the system of the core that a run simulates, for any kind of absorber.

use iva_core::absorber::modal::{FewModes, Modal, ModalStructure, Tie};
use iva_core::absorber::{self, Absorber as _, ImpactLaw as _, OnStructure as _, Point, Wall};
pub use iva_core::force::{Acts, Force, Harmonic};
use iva_core::host::{DrivenHost, Excitation, Host, UndrivenHost};
use iva_core::piva::{self, Piva};
pub use iva_core::piva::{Angles, Parameters};
use iva_core::real::Real;
use iva_core::siva::Siva;

/// A system of the core with its start.
#[derive(Debug, Clone)]
pub struct Mounted<S: absorber::Absorber> {
    /// The absorber on its structure, or the structure alone.
    pub system: S,
    /// State at time zero.
    pub start: S::Start,
    /// Acceleration of gravity on a pendulum or along the motion of a free mass, in the user's unit; `None` where the
    /// motion does not depend on it.
    pub gravity: Option<S::Real>,
}

/// The system of the core that a run simulates, with its start.
#[derive(Debug, Clone)]
pub enum Scene<R: Real = f64> {
    /// A free mass in free decay.
    Siva(Mounted<Siva<UndrivenHost<R>>>),
    /// A free mass under force, or with gravity along its motion.
    DrivenSiva(Mounted<Siva<DrivenHost<R>>>),
    /// A pendulum, under force or in free decay.
    Piva(Box<Mounted<Piva<DrivenHost<R>>>>),
    /// Any free masses and pendulums on any structure, with any terms; or none. Under force or in free decay.
    Modal(Box<Mounted<Modal<DrivenHost<R>>>>),
    /// The same with few masses and modes, in doubles.
    FewModes(Box<Mounted<FewModes<DrivenHost<R>>>>),
}

/// Whether systems of few masses and modes are a kind of scene of their own, which is faster: a program without sweeps is
/// kept small, and has one kind for all.
pub(crate) const FEW_APART: bool = cfg!(feature = "sweeps");

/// Code for the system of a scene of any kind, with its start, in numbers `R`.
macro_rules! with_system {
    ($scene:expr, |$mounted:ident| $body:expr) => {{
        use $crate::engine::scene::{FEW_APART, Scene};
        match $scene {
            Scene::Siva($mounted) if Scene::<R>::UNDRIVEN => $body,
            Scene::DrivenSiva($mounted) => $body,
            Scene::Piva($mounted) => $body,
            Scene::Modal($mounted) => $body,
            Scene::FewModes($mounted) if R::FAST_PATHS && FEW_APART => $body,
            _ => unreachable!("scenes of this kind are not built"),
        }
    }};
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

impl<R: Real> Scene<R> {
    /// Whether what nothing drives runs as a kind of scene of its own, which is faster. In other numbers than doubles
    /// it is a driven one without force, so that half as many event loops are compiled.
    pub(crate) const UNDRIVEN: bool = R::FAST_PATHS;

    /// Whether a scene with this force runs as one that nothing drives.
    pub(crate) fn undriven(force: &Force<R>) -> bool {
        Self::UNDRIVEN && force.is_none()
    }

    /// Shares the tables of a scene before it, where both are lists on the same structure that moves as one.
    pub(crate) fn share(&self, like: &Self) {
        if let (Scene::FewModes(own), Scene::FewModes(like)) = (self, like) {
            own.system.share(&like.system);
        }
    }

    /// Number of absorbers.
    pub fn count(&self) -> usize {
        with_system!(self, |it| it.system.absorbers())
    }

    /// The absorber, of several the first; `None` for a structure alone.
    pub fn absorber(&self) -> Option<Absorber<R>> {
        self.absorber_of(0)
    }

    /// The absorber of this number in a list; `None` if there is none.
    pub fn absorber_of(&self, absorber: usize) -> Option<Absorber<R>> {
        if absorber >= self.count() {
            return None;
        }
        Some(with_system!(self, |it| Absorber {
            mass_ratio: it.system.mass_ratio_of(absorber),
            restitution: it.system.law_of(absorber, Wall::Plus, R::ZERO).restitution,
            restitution_minus: it.system.law_of(absorber, Wall::Minus, R::ZERO).restitution,
            clearance: it.system.clearance_of(absorber),
        }))
    }

    /// The clearance, of several absorbers the smallest; 1 for a structure alone.
    pub fn clearance(&self) -> R {
        with_system!(self, |it| it.system.clearance())
    }

    /// Damping ratio ζ of the primary without absorber; of several modes that of the natural one.
    pub fn damping_ratio(&self) -> R {
        match self.modes() {
            Some(modes) => {
                let off = |mode: &usize| {
                    modes.frequency(*mode).map_or(f64::INFINITY, |it| (it - 1.0).abs().double())
                };
                let natural = (0..modes.count()).min_by(|a, b| off(a).total_cmp(&off(b)));
                natural.and_then(|mode| modes.damping_ratio(mode)).unwrap_or(R::ZERO)
            }
            None => with_system!(self, |it| it.system.excitation().damping_ratio()),
        }
    }

    /// The modes of the structure, where it is run by them.
    pub(crate) fn modes(&self) -> Option<&ModalStructure<R>> {
        match self {
            Scene::Modal(it) => Some(it.system.structure()),
            Scene::FewModes(it) => Some(it.system.structure()),
            _ => None,
        }
    }

    /// True if the structure moves as one: it is a primary.
    pub fn moves_as_one(&self) -> bool {
        self.modes().is_none_or(ModalStructure::moves_as_one)
    }

    /// The parameters of a pendulum; `None` for any other scene.
    pub fn pendulum(&self) -> Option<&piva::Parameters<R>> {
        match self {
            Scene::Piva(it) => Some(it.system.parameters()),
            _ => None,
        }
    }

    /// The parameters of the absorber of this number in a list, or of the only one; `None` if it is no pendulum.
    pub fn pendulum_of(&self, absorber: usize) -> Option<&piva::Parameters<R>> {
        match self {
            Scene::Modal(it) => it.system.pendulum(absorber),
            Scene::FewModes(it) => it.system.pendulum(absorber),
            _ => self.pendulum(),
        }
    }

    /// True if the structure is given by its modes or matrices.
    pub fn has_modes(&self) -> bool {
        !self.moves_as_one()
    }

    /// What ties an absorber to its point, in natural units: a spring and a dashpot.
    pub fn tie_of(&self, absorber: usize) -> Tie<R> {
        match self {
            Scene::Modal(it) => it.system.tie(absorber),
            Scene::FewModes(it) => it.system.tie(absorber),
            _ => Tie::NONE,
        }
    }

    /// True if an absorber rubs on its way.
    pub fn rubs(&self) -> bool {
        (0..self.count()).any(|absorber| self.friction_of(absorber) != 0.0)
    }

    /// The deceleration of an absorber by friction R = k g cos α, in ωn² × length; 0 without.
    pub fn friction_of(&self, absorber: usize) -> R {
        match self {
            Scene::Modal(it) => it.system.friction_of(absorber),
            Scene::FewModes(it) => it.system.friction_of(absorber),
            _ => R::ZERO,
        }
    }

    /// The angle by which the line rises on which the pivot of a pendulum moves, in rad; 0 for any other absorber.
    pub fn inclination_of(&self, absorber: usize) -> R {
        match self {
            Scene::Modal(it) => it.system.inclination_of(absorber),
            Scene::FewModes(it) => it.system.inclination_of(absorber),
            _ => R::ZERO,
        }
    }

    /// The walls of the gap of an absorber, as values of y; infinite where there is none.
    pub fn walls_of(&self, absorber: usize) -> [R; 2] {
        with_system!(self, |it| it.system.walls_of(absorber))
    }

    /// Displacement and velocity of the primary at time zero.
    pub fn primary(&self) -> Point<R> {
        with_system!(self, |it| it.system.primary(&it.system.begin(&it.start)))
    }

    /// True if the start has no energy and no force acts, so that nothing moves.
    pub fn at_rest(&self) -> bool {
        self.force().is_none()
            && with_system!(self, |it| it.system.energy(&it.system.begin(&it.start)) == 0.0)
    }

    /// True if the absorber can reach its walls at all; `None` without absorber.
    pub fn stop_reachable(&self) -> Option<bool> {
        self.absorber()?;
        Some(with_system!(self, |it| it.system.walls_reachable()))
    }

    /// The restitution of an absorber at a wall, of an approach speed.
    pub fn restitution_of(&self, absorber: usize, wall: Wall, approach: R) -> R {
        with_system!(self, |it| it.system.law_of(absorber, wall, approach).restitution)
    }

    /// The impulse of an impact of the only absorber on a wall, of an approach speed, over the mass of the structure,
    /// per gap velocity.
    pub fn impulse_at(&self, wall: Wall, approach: R) -> R {
        with_system!(self, |it| it.system.impulse_at(wall, approach))
    }

    /// The force that drives it; `None` in free decay.
    pub fn force(&self) -> Option<&Force<R>> {
        let force = with_system!(self, |it| it.system.excitation().force());
        force.filter(|force| !force.is_none())
    }

    /// The middle of the gap of an absorber, as a value of y; 0 without absorber.
    pub fn gap_offset(&self, absorber: usize) -> R {
        with_system!(self, |it| it.system.offset_of(absorber))
    }

    /// True if the base moves.
    pub fn moves_base(&self) -> bool {
        with_system!(self, |it| it.system.excitation().moves_base())
    }

    /// Acceleration of gravity on a pendulum, or along the motion of a free mass, in the user's unit.
    pub fn gravity(&self) -> Option<R> {
        with_system!(self, |it| it.gravity)
    }

    /// Gravity along the line of motion of an absorber, G = g sin α, in ωn² × length: 0 where that is level, `None` unless it is a
    /// free mass.
    pub fn gravity_along(&self, absorber: usize) -> Option<R> {
        match self {
            Scene::Siva(_) => Some(R::ZERO),
            Scene::DrivenSiva(it) => Some(it.system.gravity()),
            Scene::Modal(it) => it.system.gravity_of(absorber),
            Scene::FewModes(it) => it.system.gravity_of(absorber),
            _ => None,
        }
    }

    /// True if the absorber, or the pendulums of a list, have an angle to report.
    pub fn has_angle(&self) -> bool {
        let hangs = (0..self.count()).any(|absorber| self.pendulum_of(absorber).is_some());
        hangs && self.gravity().is_some()
    }
}
