//! Random decays and pendulums for the property tests.

use crate::{Run, dd::Dd, oracle::Scene};
use iva_core::{absorber::Start, piva::Parameters, run::run, simulate::Limits, siva::Siva};
use proptest::prelude::*;

/// A random decay, natural units.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Mass ratio.
    pub mu: f64,
    /// Restitution.
    pub e: f64,
    /// One-sided clearance.
    pub clearance: f64,
    /// Damping ratio.
    pub zeta: f64,
    /// State at the start.
    pub start: Start,
    /// Length of the run, in 1/ωn.
    pub duration: f64,
}

impl Case {
    /// The absorber.
    pub fn siva(&self) -> Siva {
        Siva::new(self.mu, self.e, self.clearance, self.zeta).expect("a valid case")
    }

    /// The default limits.
    pub fn limits(&self) -> Limits {
        Limits::new(self.duration, self.clearance)
    }

    /// The run under the default limits.
    pub fn run(&self) -> Run {
        run(&self.siva(), &self.start, &self.limits()).expect("a valid case")
    }

    /// The same decay for the oracle.
    pub fn scene(&self) -> Scene {
        let start = &self.start;
        Scene {
            start: [start.displacement, start.velocity, start.gap_displacement, start.gap_velocity]
                .map(Dd::from),
            ..Scene::decay(self.mu, self.e, self.clearance, self.zeta, self.duration)
        }
    }
}

prop_compose! {
    /// Decays over the whole range of parameters and starts, including degenerate ones.
    pub fn any_case(shortest: f64, longest: f64)(
        mu in (0.01_f64.ln()..3.0_f64.ln()).prop_map(f64::exp),
        e in prop_oneof![8 => 0.0..1.0, 1 => Just(0.0), 1 => Just(1.0)],
        clearance in (0.03_f64.ln()..2.2_f64.ln()).prop_map(f64::exp),
        zeta in prop_oneof![2 => Just(0.0), 2 => Just(0.01), 3 => 0.0..1.5, 1 => Just(1.0)],
        x in prop_oneof![2 => Just(1.0), 1 => Just(0.0), 4 => -1.0..1.0],
        v in prop_oneof![2 => Just(0.0), 3 => -1.0..1.0],
        place in prop_oneof![2 => Just(0.0), 4 => -1.0..1.0, 1 => Just(1.0), 1 => Just(-1.0)],
        w in prop_oneof![2 => Just(0.0), 3 => -1.0..1.0],
        duration in shortest..longest,
    ) -> Case {
        let start = Start {
            displacement: x,
            velocity: v,
            gap_displacement: place * clearance,
            gap_velocity: w,
        };
        Case { mu, e, clearance, zeta, start, duration }
    }
}

prop_compose! {
    /// Pendulums, point bob and compound, with a clearance of 1, some of them with a spring in the pivot.
    pub fn compound()(
        mu in 0.01..0.4,
        e in 0.0..0.95,
        zeta in prop_oneof![Just(0.0), 0.0..0.2],
        r in 0.1..1.2,
        length in 1.5..20.0,
        kappa in prop_oneof![Just(1.0), 1.0..1.5],
        contact in prop_oneof![Just(1.0), 0.8..1.5],
        spring in prop_oneof![2 => Just(0.0), 1 => 0.1..1.2],
    ) -> Parameters {
        Parameters {
            frequency_ratio: r,
            inertia_ratio: kappa,
            contact_distance: contact * length,
            spring_ratio: spring,
            ..Parameters::point_bob(mu, e, 1.0, zeta, length)
        }
    }
}
