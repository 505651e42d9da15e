//! The structure that an absorber rides on: an oscillator, and what drives it.
//!
//! With x relative to the base, a_g the acceleration of the base and A = ẍ + a_g the absolute acceleration of
//! the structure, a mass m on the structure's spring and damper obeys
//!
//! ```text
//! m A + 2ζ ẋ + x = f/M,    A = ẍ + a_g,    m = 1 in flight, m = 1 + μ with the absorber stuck to it.
//! ```
//!
//! Where the line of motion is not level, A has gravity along it as well, and the spring what it lifts
//! (`host/driven/weight.rs`).
//!
//! A [`Structure`] is that equation for one mass: [`Oscillator`](crate::oscillator::Oscillator) without drive, in closed form
//! (`host/undriven.rs`), or [`Driven`], a power series of x (`host/driven.rs`). A [`Host`] has both masses, and says when
//! the drive bends, jumps or kicks. Absorbers are written for any host.

use crate::compensated::DoubleDouble;
use crate::flight::{Jet, Quantity, Rows, Turns};
use crate::force::Force;
use crate::oscillator::{Arrival, Equation, Primary};
use crate::real::Real;
use crate::system::Clock;

pub use alone::{Alone, AloneFlight};
pub use driven::{Course, Driven, DrivenHost, Forces, Moment, Source, Weight};
pub use undriven::UndrivenHost;

mod alone;
pub(crate) mod driven;
pub(crate) mod turning;
mod undriven;

/// The structure between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostState<Phase, R = f64> {
    /// Displacement and velocity.
    pub(crate) primary: Primary<R>,
    /// A in free motion, small against f/M, x and ẋ where these balance.
    pub(crate) acceleration: DoubleDouble<R>,
    /// Where the drive stands.
    pub(crate) phase: Phase,
}

/// What a motion of the structure comes to.
#[derive(Debug, Clone, Copy)]
pub struct Flown<Phase, R = f64> {
    /// The state at its end.
    pub to: HostState<Phase, R>,
    /// What it adds to the absolute displacement, beyond a uniform motion, and to the absolute velocity: ∬A and
    /// ∫A.
    pub gained: Arrival<R>,
}

/// One mass on the structure's spring and damper, and what drives it.
///
/// A motion is evaluated from its state and its *course*: what all evaluations of one motion share.
pub trait Structure: std::fmt::Debug {
    /// The numbers that its motion is carried in.
    type Real: Real;
    /// Where the drive stands.
    type Phase: Copy + std::fmt::Debug + PartialEq;
    /// What all evaluations of a motion share.
    type Course: Copy + std::fmt::Debug;

    /// Spring, damper and mass.
    fn equation(&self) -> &Equation<Self::Real>;
    /// The course of the motion from a state.
    fn course(&self, from: &HostState<Self::Phase, Self::Real>) -> Self::Course;
    /// The same with the best instructions of the machine, where that is worth it.
    #[inline(always)]
    fn fast_course(&self, from: &HostState<Self::Phase, Self::Real>) -> Self::Course {
        self.course(from)
    }
    /// True if A is not ẍ: the base moves, or gravity acts along the motion.
    fn moves_base(&self) -> bool;
    /// How far it may be followed.
    fn reach(&self, course: &Self::Course) -> Self::Real;
    /// The motion after h.
    fn flown(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> Flown<Self::Phase, Self::Real>;
    /// Makes the state at the end of a motion the one that the run goes on from: under the piece of the drive that
    /// acts from there on.
    #[inline(always)]
    fn refresh(&self, _state: &mut HostState<Self::Phase, Self::Real>) {}
    /// x and its derivatives after h, to some units in the last place.
    fn jet(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> Jet<Self::Real>;
    /// ∬A after h, to twice the precision: slow, and asked only where a grazing is to be decided.
    fn precise(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        h: Self::Real,
    ) -> DoubleDouble<Self::Real>;
    /// Where the drive stands a little later.
    fn later(&self, phase: &Self::Phase, h: Self::Real) -> Self::Phase;
    /// A of this mass.
    fn acceleration(
        &self,
        phase: &Self::Phase,
        primary: &Primary<Self::Real>,
    ) -> DoubleDouble<Self::Real>;
    /// The first three derivatives of A, from ẋ and A.
    fn derivatives(&self, phase: &Self::Phase, v: Self::Real, a: Self::Real) -> [Self::Real; 3];
    /// A − ẍ and its first three derivatives.
    fn base(&self, phase: &Self::Phase) -> [Self::Real; 4];
    /// A bound on the nth derivative of A in every motion from a state, n ≤ 6.
    fn bound<const N: usize>(&self, primary: &Primary<Self::Real>) -> Self::Real;
    /// Energy that the damper takes in a motion of length h, and the work of the drive on the structure and on
    /// an absorber of mass ratio μ that starts with a gap velocity w: integrals.
    fn losses(&self, motion: &Integrated<'_, Self>, h: Self::Real) -> [Self::Real; 2];
    /// Whether x turns round in a motion of length h to a state, if that is plain, where its velocity changes sign.
    fn turns(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        end: &HostState<Self::Phase, Self::Real>,
        h: Self::Real,
    ) -> Turns<Self::Real>;
    /// ∫x² from one h to another; asked under force.
    fn square(
        &self,
        _from: &HostState<Self::Phase, Self::Real>,
        _course: &Self::Course,
        _h: [Self::Real; 2],
    ) -> Self::Real {
        Self::Real::ZERO
    }
    /// The largest size of a quantity in a motion of length h to a state, or `least` if that is larger, if it is plain;
    /// asked under force.
    fn largest(
        &self,
        _of: Quantity,
        _least: Self::Real,
        _motion: (&HostState<Self::Phase, Self::Real>, &Self::Course),
        _end: &HostState<Self::Phase, Self::Real>,
        _h: Self::Real,
    ) -> Option<Self::Real> {
        None
    }
    /// The polynomials of a motion under force.
    fn rows(
        &self,
        _from: &HostState<Self::Phase, Self::Real>,
        _course: &Self::Course,
    ) -> Option<Rows<Self::Real>> {
        None
    }
    /// The polynomials of any motion.
    fn series(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
    ) -> Rows<Self::Real>;
}

/// A motion to integrate over.
#[derive(Debug)]
pub struct Integrated<'a, S: Structure + ?Sized> {
    /// Its begin.
    pub from: &'a HostState<S::Phase, S::Real>,
    /// Its course.
    pub course: &'a S::Course,
    /// μ.
    pub mass_ratio: S::Real,
    /// Gap velocity at its begin; `None`: the absorber is stuck to the structure.
    pub gap_velocity: Option<S::Real>,
}

/// A structure by itself and with an absorber stuck to it, and the instants of its drive.
pub trait Host: Clone + std::fmt::Debug {
    /// The numbers that its motion is carried in.
    type Real: Real;
    /// One of the two masses.
    type Structure: Structure<Real = Self::Real>;

    /// ζ.
    fn damping_ratio(&self) -> Self::Real;
    /// Takes over what is computed once for all structures like this one, which has the same ζ.
    fn share(&self, _like: &Self) {}
    /// The structure by itself.
    fn free(&self) -> &Self::Structure;
    /// With the absorber stuck to it.
    fn loaded(&self) -> &Self::Structure;
    /// Where the drive stands at an instant at which a run begins.
    fn begin_at(&self, time: Clock<Self::Real>) -> Phase<Self>;
    /// The displacement at which A = 0.
    fn balanced(
        &self,
        phase: &Phase<Self>,
        v: DoubleDouble<Self::Real>,
    ) -> DoubleDouble<Self::Real>;
    /// Derivatives of the drive at the begin: the first that is not 0 decides from which wall distances are measured, where
    /// the state leaves it open.
    fn leaning(&self, _phase: &Phase<Self>) -> [Self::Real; 3] {
        [Self::Real::ZERO; 3]
    }
    /// All that drives it; `None` where nothing can.
    fn force(&self) -> Option<&Force<Self::Real>> {
        None
    }
    /// Gravity G along the motion, in ωn² × length.
    fn gravity(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// The absolute acceleration ẍ + a_g that goes with A, which has gravity along the motion besides.
    fn absolute(&self, a: DoubleDouble<Self::Real>) -> Self::Real {
        a.minus(self.gravity())
    }
    /// How long the drive stays smooth.
    fn smooth_for(&self, _phase: &Phase<Self>) -> Self::Real {
        Self::Real::INFINITY
    }
    /// P/M of the impulse that is due; 0 where the force jumps.
    fn due(&self, _phase: &Phase<Self>) -> Option<Self::Real> {
        None
    }
    /// Where the drive stands after the impulse that was due.
    fn after_impulse(&self, phase: &Phase<Self>) -> Phase<Self> {
        *phase
    }
    /// The state of the structure after its velocity has jumped, with the acceleration computed anew.
    fn state(
        &self,
        phase: Phase<Self>,
        primary: Primary<Self::Real>,
    ) -> HostState<Phase<Self>, Self::Real> {
        HostState { primary, acceleration: self.free().acceleration(&phase, &primary), phase }
    }
}

/// Where the drive of a host stands.
pub type Phase<H> = <<H as Host>::Structure as Structure>::Phase;
