//! A free mass whose restitution falls with the approach speed, e = e₀/(1 + w/w₀): an impact law that the core does not
//! have, in one file. The rest is that of a free mass with Newton's law.

use iva_core::{
    absorber::{Absorber, Clock, ImpactLaw, LawAt, OnStructure, Point, Start, Wall},
    error::Invalid,
    flight::Jet,
    host::UndrivenHost,
    impact::Impact,
    propagation::{ByTangents, Differentiable, Estimated, free_mass_impact},
    real::Real,
    run::side_by_side::SideBySide,
    siva::{Siva, SivaState},
};
use nalgebra::{Matrix4, Vector4};

/// The absorber on its structure.
#[derive(Debug, Clone)]
pub struct Softening<R: Real = f64> {
    siva: Siva<UndrivenHost<R>>,
    /// w₀, in ωn × length.
    speed: R,
}

impl<R: Real> Softening<R> {
    /// From μ, e₀, d, ζ and w₀.
    ///
    /// # Errors
    /// As [`Siva::new`].
    pub fn new([mu, e, d, zeta, speed]: [R; 5]) -> Result<Self, Invalid> {
        Ok(Self { siva: Siva::new(mu, e, d, zeta)?, speed })
    }

    /// e, de/dw, and e₀ − e.
    fn restitution(&self, approach: R) -> [R; 3] {
        let slowest = self.siva.restitution(Wall::Plus);
        let lower = R::ONE / (R::ONE + approach / self.speed);
        let e = slowest * lower;
        [e, -(e * lower) / self.speed, slowest - e]
    }

    /// A free mass with the restitution of this approach speed.
    fn at(&self, approach: R) -> Siva<UndrivenHost<R>> {
        let [e, ..] = self.restitution(approach);
        let siva = &self.siva;
        let made = Siva::new(siva.mass_ratio(), e, siva.clearance(), siva.damping_ratio());
        made.unwrap_or_else(|_| siva.clone())
    }
}

impl<R: Real> OnStructure for Softening<R> {
    type Real = R;
    type Excitation = UndrivenHost<R>;
    type State = SivaState<(), R>;

    fn excitation(&self) -> &UndrivenHost<R> {
        self.siva.excitation()
    }

    fn phase(_state: &Self::State) -> &() {
        &()
    }

    fn mass_ratio(&self) -> R {
        self.siva.mass_ratio()
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        self.siva.primary(state)
    }

    fn energy(&self, state: &Self::State) -> R {
        self.siva.energy(state)
    }
}

impl<R: Real> ImpactLaw for Softening<R> {
    fn law_of(&self, _absorber: usize, _wall: Wall, approach: R) -> LawAt<R> {
        let (mu, zeta) = (self.siva.mass_ratio(), self.siva.damping_ratio());
        LawAt::of_free_mass(mu, self.restitution(approach), approach, zeta)
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        let approach = -self.siva.distance(state).rate;
        self.at(approach).impact(state, time)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        self.siva.stick(state)
    }
}

impl<R: Real> Absorber for Softening<R> {
    type Start = Start<R>;
    type Flight<'a> = <Siva<UndrivenHost<R>> as Absorber>::Flight<'a>;
    type Ride<'a> = <Siva<UndrivenHost<R>> as Absorber>::Ride<'a>;

    fn clearance(&self) -> R {
        self.siva.clearance()
    }

    fn check_start(&self, start: &Start<R>) -> Result<(), Invalid> {
        self.siva.check_start(start)
    }

    fn begin_at(&self, start: &Start<R>, time: Clock<R>) -> Self::State {
        self.siva.begin_at(start, time)
    }

    fn flight(&self, state: &Self::State) -> Self::Flight<'_> {
        self.siva.flight(state)
    }

    fn ride(&self, state: &Self::State) -> Self::Ride<'_> {
        self.siva.ride(state)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        self.siva.wall(state)
    }

    fn distance(&self, state: &Self::State) -> Jet<R> {
        self.siva.distance(state)
    }

    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        self.siva.touch(state, wall)
    }

    fn release(&self, state: &Self::State) -> (Self::State, R) {
        self.siva.release(state)
    }
}

impl Differentiable for Softening {
    const LINEAR: bool = true;

    fn impact_matrix(&self, [before, _]: [&Self::State; 2]) -> Matrix4<f64> {
        let approach = self.rates(before)[2].abs();
        free_mass_impact(&self.law_at(self.wall(before), approach))
    }

    fn rates(&self, state: &Self::State) -> Vector4<f64> {
        self.siva.rates(state)
    }
    fn flight_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        self.siva.flight_tangent(from, h)
    }
    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        self.siva.ride_tangent(from, h)
    }
    fn stick_matrix(&self, stuck: &Self::State) -> Matrix4<f64> {
        self.siva.stick_matrix(stuck)
    }
}

impl Estimated for Softening {
    type Way = ByTangents;
}

impl SideBySide for Softening {}
