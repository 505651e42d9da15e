//! Absorbers as functions of their force, so that one test can be run on free masses and pendulums.

use iva_core::{
    force::Force,
    host::DrivenHost,
    piva::{Parameters, Piva},
    siva::Siva,
};

/// A free mass of mass ratio μ, restitution e and clearance d on a primary of damping ratio ζ.
pub fn mass(mu: f64, e: f64, d: f64, zeta: f64) -> impl Fn(Force) -> Siva<DrivenHost> {
    let siva = Siva::new(mu, e, d, zeta).expect("a valid free mass");
    move |force| siva.under(force)
}

/// A pendulum with these parameters.
pub fn pendulum(parameters: Parameters) -> impl Fn(Force) -> Piva<DrivenHost> {
    let piva = Piva::new(parameters).expect("a valid pendulum");
    move |force| piva.under(force)
}
