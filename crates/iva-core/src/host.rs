//! The primary structure: an oscillator, and the excitation that drives it.
//!
//! With x relative to the base, a_g the acceleration of the base and A = ẍ + a_g the absolute acceleration of
//! the structure, a mass m on the structure's spring and damper obeys
//!
//! ```text
//! m A + 2ζ ẋ + x = f/M,    A = ẍ + a_g,    m = 1 in flight, m = 1 + μ with the absorber stuck to it.
//! ```
//!
//! Where the line of motion is inclined, A includes gravity along it, and a constant lift of the spring is
//! added to f/M (`host/driven/weight.rs`).
//!
//! A [`Structure`] is that equation for one mass m: [`Oscillator`](crate::host::oscillator::Oscillator) without
//! drive, in closed form (`host/undriven.rs`), or [`Driven`], a power series of x (`host/driven.rs`). A
//! [`Host`] has the structures for both masses. The instants at which the drive bends, jumps or has an impulse are
//! those of its [`Excitation`]. Absorbers are generic over the host.

use crate::force::Drive;
use crate::host::oscillator::{Arrival, Equation, Primary};
use crate::number::arrays::laned;
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Jet, Quantity, Rows, Turns};
use crate::segment::polynomial::product_integral;

pub(crate) use driven::{Block, Plain, Sums};
pub use driven::{
    Course, Driven, DrivenHost, Forces, Moment, Pieces, Place, Ramped, Source, Weight,
};
pub use excitation::{Excitation, Still};
pub use sinusoid::Sinusoidal;
pub use steps::Steps;
pub use undriven::UndrivenHost;

pub(crate) mod driven;
mod excitation;
pub mod oscillator;
pub(crate) mod sinusoid;
pub(crate) mod steps;
pub(crate) mod turning;
mod undriven;

/// The state of the structure at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostState<Phase, R = f64> {
    /// Displacement x and velocity ẋ.
    pub(crate) primary: Primary<R>,
    /// A in double-double, as it may be a small difference of f/M, x and ẋ: for mass 1, in a ride for mass 1 + μ.
    pub(crate) acceleration: DoubleDouble<R>,
    /// The state of the drive.
    pub(crate) phase: Phase,
}

laned!(HostState<P>, HostStates { primary: Primary, acceleration: DoubleDouble, phase: P });

/// The result of a motion of the structure.
#[derive(Debug, Clone, Copy)]
pub struct Flown<Phase, R = f64> {
    /// The state at its end.
    pub to: HostState<Phase, R>,
    /// ∬A and ∫A over the motion: the gain of the absolute displacement beyond a uniform motion, and of the
    /// absolute velocity.
    pub gained: Arrival<R>,
}

/// One mass on the structure's spring and damper, with its drive.
///
/// A motion is evaluated from its first state and its *course*: data computed once for all evaluations of the
/// motion.
pub trait Structure: std::fmt::Debug {
    /// The number type of the motion.
    type Real: Real;
    /// The state of the drive at one instant.
    type Phase: Copy + std::fmt::Debug + PartialEq;
    /// Data computed once for all evaluations of a motion.
    type Course: Copy + std::fmt::Debug;

    /// Spring, damper and mass.
    fn equation(&self) -> &Equation<Self::Real>;
    /// The course of the motion from a state.
    fn course(&self, from: &HostState<Self::Phase, Self::Real>) -> Self::Course;
    /// The course with all that measures need; `None` if that is the course itself.
    fn measured(
        &self,
        _from: &HostState<Self::Phase, Self::Real>,
        _course: &Self::Course,
    ) -> Option<Self::Course> {
        None
    }
    /// [`Structure::course`] compiled for the widest vector instructions of the machine, where that is worth
    /// it.
    #[inline(always)]
    fn fast_course(&self, from: &HostState<Self::Phase, Self::Real>) -> Self::Course {
        self.course(from)
    }
    /// True if A is not ẍ: the base moves, or gravity acts along the motion.
    fn moves_base(&self) -> bool;
    /// The longest motion from a state for which its course is exact.
    fn reach(&self, from: &HostState<Self::Phase, Self::Real>) -> Self::Real;
    /// The motion of length h.
    fn flown(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> Flown<Self::Phase, Self::Real>;
    /// [`Structure::flown`] with the drive, and so A at its end, to the accuracy of plain numbers.
    #[inline(always)]
    fn nearly_flown(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> Flown<Self::Phase, Self::Real> {
        self.flown(from, course, h)
    }
    /// ∬A, ∫A and A after a motion of length h, with the accuracy of plain numbers.
    fn ahead(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> [Self::Real; 3];
    /// Prepares the state at the end of a motion for the next one: evaluates the drive with the piece that
    /// acts from there on.
    #[inline(always)]
    fn refresh(&self, _state: &mut HostState<Self::Phase, Self::Real>) {}
    /// x and its derivatives after h, with errors of some units in the last place.
    fn jet(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: Self::Real,
    ) -> Jet<Self::Real>;
    /// ∬A after h in double-double. Slow: called only where a grazing is to be decided.
    fn precise(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        h: Self::Real,
    ) -> DoubleDouble<Self::Real>;
    /// The state of the drive a time h later.
    fn later(&self, phase: &Self::Phase, h: Self::Real) -> Self::Phase;
    /// The state of the drive a time h later, with the piece that acts now.
    fn within(&self, phase: &Self::Phase, h: Self::Real) -> Self::Phase;
    /// [`Structure::within`] with the accuracy of plain numbers, to look at.
    #[inline(always)]
    fn nearly_within(&self, phase: &Self::Phase, h: Self::Real) -> Self::Phase {
        self.within(phase, h)
    }
    /// The state of the drive at the end of a motion, with the piece that acts from there on.
    #[inline(always)]
    fn renewed(&self, phase: &Self::Phase) -> Self::Phase {
        *phase
    }
    /// A of this mass at a state of the drive and of the structure.
    fn acceleration(
        &self,
        phase: &Self::Phase,
        primary: &Primary<Self::Real>,
    ) -> DoubleDouble<Self::Real>;
    /// The first three derivatives of A, from ẋ and A.
    fn derivatives(&self, phase: &Self::Phase, v: Self::Real, a: Self::Real) -> [Self::Real; 3];
    /// A − ẍ and its first three derivatives.
    fn base(&self, phase: &Self::Phase) -> [Self::Real; 4];
    /// A bound on |a_g|.
    #[inline(always)]
    fn largest_base(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// A bound on the Nth derivative of A in every motion from a state, N ≤ 6.
    fn bound<const N: usize>(&self, primary: &Primary<Self::Real>) -> Self::Real;
    /// The energy lost in the damper in a motion of length h, and the work of the drive on structure and
    /// absorber, both as integrals.
    fn losses(&self, motion: &Integrated<'_, Self>, h: Self::Real) -> [Self::Real; 2];
    /// The extremum of x in a motion of length h to the state `end`, if ẋ changes sign in it and the extremum
    /// is found without a search.
    fn turns(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        end: &HostState<Self::Phase, Self::Real>,
        h: Self::Real,
    ) -> Turns<Self::Real>;
    /// ∫x² dh between two values of h, by default from the power series.
    fn square(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
        h: [Self::Real; 2],
    ) -> Self::Real {
        let Rows { step, order, x, .. } = self.series(from, course);
        let until = |h: Self::Real| product_integral(&x[..=order], &x[..=order], h / step);
        (until(h[1]) - until(h[0])) * step
    }
    /// The larger of `least` and the largest size of a quantity in a motion of length h to a state; `None` if
    /// it is not known. Called for driven structures only.
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
    /// The power series of a motion; `None` if the structure is not driven.
    fn rows(
        &self,
        _from: &HostState<Self::Phase, Self::Real>,
        _course: &Self::Course,
    ) -> Option<Rows<Self::Real>> {
        None
    }
    /// The power series of a motion, of any structure.
    fn series(
        &self,
        from: &HostState<Self::Phase, Self::Real>,
        course: &Self::Course,
    ) -> Rows<Self::Real>;
}

/// A motion to integrate over.
#[derive(Debug)]
pub struct Integrated<'a, S: Structure + ?Sized> {
    /// The state at its begin.
    pub from: &'a HostState<S::Phase, S::Real>,
    /// The course of the motion.
    pub course: &'a S::Course,
    /// Mass ratio μ of the absorber.
    pub mass_ratio: S::Real,
    /// Gap velocity w at its begin; `None` if the absorber is stuck to the structure.
    pub gap_velocity: Option<S::Real>,
}

/// A structure without and with an absorber stuck to it, and the events of its drive.
pub trait Host: Excitation + Clone {
    /// The structure with one of the two masses.
    type Structure: Structure<Real = Self::Real, Phase = Self::Phase>;

    /// The damping ratio ζ.
    fn damping_ratio(&self) -> Self::Real;
    /// The structure in doubles, if no lasting force acts on it and its motion is a damped sinusoid in closed form
    /// (`host/sinusoid.rs`).
    fn sinusoidal(&self) -> Option<Sinusoidal> {
        None
    }
    /// Shares the tables of another structure that has the same ζ, if they are worth sharing.
    fn share(&self, _like: &Self) {}
    /// The same structure with the same drive, for absorbers of another mass ratio, whose weight does not act along the
    /// motion.
    fn carrying(&self, mass_ratio: Self::Real) -> Self;
    /// The structure without absorber, mass 1.
    fn free(&self) -> &Self::Structure;
    /// The motion over whole steps of a structure without drive, where flights are decided in closed form.
    fn steps(&self) -> Option<&Steps<Self::Real>> {
        None
    }
    /// The state of the drive some steps later, which take this time.
    fn waited(&self, phase: &Phase<Self>, _time: Clock<Self::Real>) -> Phase<Self> {
        *phase
    }
    /// The instant of a state of the drive; `None` of a structure that cannot be driven.
    fn time(&self, _phase: &Phase<Self>) -> Option<Clock<Self::Real>> {
        None
    }
    /// The motion from point to point of a record that drives the structure.
    fn pieces(&self) -> Option<&Pieces<Self::Real>> {
        None
    }
    /// The place in the record of a state of the drive, if it is at a point.
    fn place(&self, _phase: &Phase<Self>) -> Option<Place> {
        None
    }
    /// The state of the drive at a place in the record, no impulse having acted in between.
    fn at(&self, phase: &Phase<Self>, _place: Place) -> Phase<Self> {
        *phase
    }
    /// The structure with the absorber stuck to it, mass 1 + μ.
    fn loaded(&self) -> &Self::Structure;
    /// The state of the drive at the instant at which a run begins.
    fn begin_at(&self, time: Clock<Self::Real>) -> Phase<Self>;
    /// The displacement at which A = 0 for a given velocity.
    fn balanced(
        &self,
        phase: &Phase<Self>,
        v: DoubleDouble<Self::Real>,
    ) -> DoubleDouble<Self::Real>;
    /// What moves the structure after a start at rest: rate and second derivative of f/M, the velocity of the first
    /// impulse, and a_g with its rate and second derivative. Distances are measured from the wall on the side of the
    /// first that is not 0.
    fn leaning(&self, _phase: &Phase<Self>) -> [Self::Real; 6] {
        [Self::Real::ZERO; 6]
    }
    /// Taylor coefficients of f/M and a_g from a state of the drive on, in powers of t/h; `None` without a lasting
    /// force.
    #[inline(always)]
    fn drive(&self, _phase: &Phase<Self>, _h: Self::Real) -> Option<Drive<Self::Real>> {
        None
    }
    /// The first Taylor coefficients of f/M and a_g, four at most, in powers of t.
    #[inline(always)]
    fn drive_ahead<const LENGTH: usize>(
        &self,
        _phase: &Phase<Self>,
    ) -> Option<Drive<Self::Real, LENGTH>> {
        None
    }
    /// Value and rate of f/M, and of a_g plus gravity along the motion, in double-double.
    #[inline(always)]
    fn drive_now(&self, _phase: &Phase<Self>) -> Option<Drive<DoubleDouble<Self::Real>, 2>> {
        None
    }
    /// [`Host::drive`] in double-double, with gravity along the motion added to a_g.
    fn precise_drive(
        &self,
        _phase: &Phase<Self>,
        _h: Self::Real,
    ) -> Option<Drive<DoubleDouble<Self::Real>>> {
        None
    }
    /// Acceleration of gravity G along the motion, in ωn² × length.
    fn gravity(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// The absolute acceleration ẍ + a_g that belongs to A: A without gravity along the motion.
    fn absolute(&self, a: DoubleDouble<Self::Real>) -> Self::Real {
        a.minus(self.gravity())
    }
    /// The state of the structure from drive, displacement and velocity, with A computed anew.
    #[inline(always)]
    fn state(
        &self,
        phase: Phase<Self>,
        primary: Primary<Self::Real>,
    ) -> HostState<Phase<Self>, Self::Real> {
        HostState { primary, acceleration: self.free().acceleration(&phase, &primary), phase }
    }
}

/// The state of the drive of a host.
pub type Phase<H> = <H as Excitation>::Phase;
