//! The decision of a grazing: the distance in double-double, and that the search uses it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{Absorber, ImpactLaw, Start, Wall},
    compensated::DoubleDouble,
    contact::first_contact,
    flight::{Curve, Jet, Motion, Side},
    piva::{Parameters, Piva},
    siva::Siva,
};
use iva_tests::{
    U,
    dd::Dd,
    flight::free,
    pendulum::{sine_cosine, swing},
};

/// A parabola over a wall whose plain evaluation has an error of a hundred roundings, of either sign.
struct Noisy {
    lowest: f64,
    noise: f64,
}

impl Curve for Noisy {
    type Real = f64;

    fn first(&self) -> Jet {
        self.jet(0.0)
    }

    fn jet(&self, h: f64) -> Jet {
        let t = h - 0.4;
        Jet { value: t * t + self.lowest + self.noise, rate: 2.0 * t, curvature: 2.0, jerk: 0.0 }
    }

    fn precise(&self, h: f64) -> DoubleDouble {
        DoubleDouble::new((h - 0.4) * (h - 0.4)).plus(self.lowest)
    }

    fn fourth(&self) -> f64 {
        0.0
    }

    fn magnitude(&self) -> f64 {
        1.0
    }
}

#[test]
fn the_precise_distance_decides_not_the_plain_one() {
    for noise in [-100.0 * U, 100.0 * U] {
        for (lowest, contact, undecided) in [
            (40.0 * U, None, 0),
            (17.0 * U, None, 0),
            (15.0 * U, None, 1),
            (-15.0 * U, None, 1),
            (-17.0 * U, Some(Side::Near), 0),
            (-40.0 * U, Some(Side::Near), 0),
        ] {
            let curve = Noisy { lowest, noise };
            let found = first_contact(&curve, 1.0, 1.0);
            let place = format!("lowest {} U, noise {} U", lowest / U, noise / U);
            assert_eq!((found.contact, found.undecided), (contact, undecided), "{place}");
        }
    }
}

#[test]
fn the_precise_distance_of_a_free_mass_leaves_out_a_ten_thousandth_of_a_rounding() {
    // The first truncated term of the series is below 2/22! = 2e-21 = 2e-5 U of the motion.
    for (zeta, x, v, y, w) in
        [(0.0, 1.0, 0.3, 0.1, -0.2), (0.7, -0.98, 0.7, 0.0, 1e-3), (3.0, -6.0, 1.0, 0.2, -0.4)]
    {
        let clearance = 0.5;
        let siva = Siva::new(0.1, 0.5, clearance, zeta).unwrap();
        let start = Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w };
        let state = siva.begin(&start);
        let flight = siva.flight(&state);
        let s = siva.wall(&state).sign();
        for share in [0.01, 0.3, 0.77, 1.0] {
            let h = share * flight.reach();
            let (later, _) = free(x.into(), v.into(), zeta.into(), h.into());
            let gap = Dd::sum(x, y) + Dd::sum(v, w) * h - later;
            let found = flight.precise(h);
            let error = (Dd::from(clearance) - gap * s - found.value - found.rest).abs().hi;
            assert!(error < 1e-4 * U * clearance, "ζ = {zeta}, h = {h}: {:e} U", error / U);
        }
    }
}

#[test]
fn the_precise_distance_of_a_pendulum_leaves_out_less_than_the_band() {
    // The series is truncated where its terms are 1e-17 of the clearance, a tenth of a rounding.
    let p = Parameters {
        frequency_ratio: 0.6,
        inertia_ratio: 1.2,
        contact_distance: 3.0,
        ..Parameters::point_bob(0.2, 0.5, 1.5, 0.05, 2.5)
    };
    let piva = Piva::new(p).unwrap();
    let start =
        Start { displacement: 1.0, velocity: -0.4, gap_displacement: 0.75, gap_velocity: 0.3 };
    let state = piva.begin(&start.into());
    let flight = piva.flight(&state);
    let s = piva.wall(&state).sign();
    // The start in the variables of the simulator: sinθ = y/b, and the rate from ẏ = b cosθ θ̇.
    let sine = Dd::from(0.75) / 3.0;
    let cosine = (Dd::ONE - sine * sine).sqrt();
    let mut angle = Dd::from(sine.value().asin());
    for _ in 0..3 {
        let (value, slope) = sine_cosine(angle);
        angle = angle - (value - sine) / slope;
    }
    let rate = Dd::from(0.3) / cosine / 3.0;
    for share in [0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0] {
        let h = share * flight.reach();
        let [_, _, later, _] = swing(&p, [1.0.into(), Dd::from(-0.4), angle, rate], h);
        let (sine, _) = sine_cosine(later);
        let found = flight.precise(h);
        let error = (Dd::from(1.5) - sine * 3.0 * s - found.value - found.rest).abs().hi;
        assert!(error < 0.1 * U * p.clearance, "h = {h}: {} U", error / U);
    }
}

#[test]
fn the_pressure_gain_is_the_rise_of_the_pressure_at_a_slow_impact() {
    fn rise<S: Absorber<Real = f64, Start: From<Start>>>(
        system: &S,
        clearance: f64,
        approach: f64,
    ) -> f64 {
        let start = Start {
            displacement: 1.0,
            velocity: 0.2,
            gap_displacement: clearance,
            gap_velocity: approach,
        };
        let state = system.begin(&start.into());
        assert_eq!(system.distance(&state).value, 0.0);
        let (after, _) = system.impact(&state, 0.0);
        (system.distance(&state).curvature - system.distance(&after).curvature) / approach
    }
    // The rise per speed has an error of first order in the speed: 1e-7 of order 1.
    let approach = 1e-7;
    let siva = Siva::new(0.2, 0.6, 0.5, 0.3).unwrap();
    let pendulum = |pivot_damping_ratio, damping_ratio| {
        Piva::new(Parameters {
            frequency_ratio: 0.6,
            inertia_ratio: 1.2,
            contact_distance: 1.4,
            pivot_damping_ratio,
            ..Parameters::point_bob(0.2, 0.6, 0.5, damping_ratio, 1.1)
        })
        .unwrap()
    };
    let error = (rise(&siva, 0.5, approach) - siva.law_at(Wall::Plus, approach).pressure).abs();
    assert!(siva.law_at(Wall::Plus, approach).pressure > 0.1 && error < 1e-6, "{error:e}");
    for (pivot, zeta) in [(0.0, 0.3), (0.4, 0.0), (0.2, 0.1)] {
        let piva = pendulum(pivot, zeta);
        let (found, gain) =
            (rise(&piva, 0.5, approach), piva.law_at(Wall::Plus, approach).pressure);
        assert!(gain > 0.05, "{gain}");
        assert!((found - gain).abs() < 1e-6, "pivot {pivot}, ζ {zeta}: {found} for {gain}");
    }
}
