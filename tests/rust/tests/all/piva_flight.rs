//! The motion of the pendulum absorber between impacts, and its limiting cases: exact periods, energy, modes,
//! Lagrange's equations, the free mass.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Start,
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    run::{run, states},
    simulate::{Limits, Outcome},
    siva::Siva,
    taylor::{Pendulum, Series, Spring, Swing, horner},
};
use iva_tests::{
    U, UNITS_ALLOWED,
    case::compound,
    pendulum::{sine_cosine, swing},
    timeline::marks,
};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Approach speed below which impacts are not compared.
const FLOOR: f64 = 1e-9;

fn released(displacement: f64) -> Start {
    Start { displacement, ..Start::default() }
}

/// T = 2π/(ωp · agm(1, cos(θ₀/2))): the exact period of a pendulum.
fn period(frequency: f64, amplitude: f64) -> f64 {
    let (mut a, mut g) = (1.0, (0.5 * amplitude).cos());
    while (a - g).abs() > 1e-15 * a {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    2.0 * PI / (frequency * a)
}

#[test]
fn pendulum_periods_are_those_of_the_arithmetic_geometric_mean() {
    // The bob is so light that the primary stays at rest; the walls are out of reach.
    for degrees in [1.0, 10.0, 30.0, 60.0, 89.0, 90.0, 91.0, 120.0, 150.0f64] {
        let amplitude = degrees.to_radians();
        let parameters =
            Parameters { frequency_ratio: 0.1, ..Parameters::point_bob(1e-12, 0.5, 2.0, 0.0, 1.0) };
        let piva = Piva::new(parameters).unwrap();
        assert!(!piva.stop_reachable());
        let start = PivaStart { place: Given::Angle(amplitude), ..Start::default().into() };
        let truth = period(0.1, amplitude);
        let limits = Limits::new(3.0 * truth, 2.0);
        // The pendulum passes θ = 0 after (k + 1/4) and (k + 3/4) periods.
        for quarters in [1.0, 3.0, 9.0, 11.0] {
            let time = 0.25 * quarters * truth;
            let state = states(&piva, &start, &limits, &[time]).unwrap()[0];
            let late = state.gap_displacement / state.gap_velocity;
            assert!((late / time).abs() < 1e-13, "{degrees}°, {quarters}: {:e}", late / time);
        }
    }
}

/// The bob is so light that the primary stays at rest, without gravity: it rotates at a constant rate, and
/// its angle gives the time of the contact. y = b sinθ would give the angle to 10⁻¹⁰ at best.
#[test]
fn a_start_by_its_angle_is_as_far_from_a_wall_near_the_horizontal_as_the_angle_says() {
    for k in [3, 6, 9, 12] {
        let clearance = 1.0 - 10f64.powi(-k);
        let parameters = Parameters {
            frequency_ratio: 0.0,
            ..Parameters::point_bob(1e-15, 0.5, clearance, 0.0, 1.0)
        };
        let piva = Piva::new(parameters).unwrap();
        let angle = piva.wall_angle() - 1e-7;
        let start = PivaStart {
            place: Given::Angle(angle),
            rate: Given::Angle(0.5),
            ..Start::default().into()
        };
        let impact = run(&piva, &start, &Limits::new(1e-6, clearance)).unwrap().impacts[0];
        let truth = (piva.wall_angle() - angle) / 0.5;
        // The angle of the wall is rounded to a double.
        let allowed = 2.0 * f64::EPSILON * piva.wall_angle() / 0.5;
        assert!((impact.time - truth).abs() < allowed, "{k}: {:e}", impact.time - truth);
    }
}

#[test]
fn a_slow_pendulum_on_a_long_rod_is_a_free_mass() {
    // For r → 0 only the curvature of the path has an effect, which decreases as 1/L².
    let (mu, e, d, zeta) = (0.1, 0.5, 0.6, 0.01);
    let limits = Limits::new(30.0, d);
    let siva = run(&Siva::new(mu, e, d, zeta).unwrap(), &released(1.0), &limits).unwrap();
    let difference = |length: f64| {
        let parameters =
            Parameters { frequency_ratio: 1e-12, ..Parameters::point_bob(mu, e, d, zeta, length) };
        let piva = run(&Piva::new(parameters).unwrap(), &released(1.0).into(), &limits).unwrap();
        assert_eq!(piva.impacts.len(), siva.impacts.len());
        let pairs = piva.impacts.iter().zip(&siva.impacts);
        pairs.map(|(a, b)| (a.time - b.time).abs()).fold(0.0, f64::max)
    };
    let (near, far) = (difference(1e2), difference(1e3));
    assert!((near / far - 100.0).abs() < 1.0, "{near:e} {far:e}");
    assert!(difference(1e9) < 1e-12);
}

#[test]
fn without_impacts_and_damping_the_energy_stays() {
    // Ten thousand periods of a large oscillation.
    for (kappa, contact) in [(1.0, 2.0), (1.3, 2.5)] {
        let parameters = Parameters {
            frequency_ratio: 0.7,
            inertia_ratio: kappa,
            contact_distance: contact,
            ..Parameters::point_bob(0.2, 0.5, 3.0, 0.0, 2.0)
        };
        let start = Start { gap_displacement: 1.5, ..released(0.8) };
        let limits = Limits::new(1e4 * 2.0 * PI, 3.0);
        let result = run(&Piva::new(parameters).unwrap(), &start.into(), &limits).unwrap();
        assert_eq!(result.tally.outcome, Outcome::Finished);
        let drift = result.measures.energy_final / result.measures.energy_initial - 1.0;
        println!("κ = {kappa}: drift {drift:e}");
        assert!(drift.abs() < 1e-13, "{drift:e}");
    }
}

#[test]
fn a_pendulum_that_turns_over_keeps_its_energy() {
    // Ten thousand periods of a primary with a rotating pendulum, walls out of reach.
    for (kappa, rate) in [(1.0, 2.5), (1.2, -3.0)] {
        let parameters = Parameters {
            frequency_ratio: 0.7,
            inertia_ratio: kappa,
            ..Parameters::point_bob(0.2, 0.5, 3.0, 0.0, 2.0)
        };
        let piva = Piva::new(parameters).unwrap();
        let start = PivaStart {
            place: Given::Angle(2.0),
            rate: Given::Angle(rate),
            ..released(0.1).into()
        };
        let end = 1e4 * 2.0 * PI;
        let result = run(&piva, &start, &Limits::new(end, 3.0)).unwrap();
        assert_eq!(result.tally.outcome, Outcome::Finished);
        assert!(result.impacts.is_empty());
        let drift = result.measures.energy_final / result.measures.energy_initial - 1.0;
        println!("κ = {kappa}, turning: drift {drift:e}");
        assert!(drift.abs() < 1e-13, "{drift:e}");
        // sin² + cos² = 1 throughout: the angle in the table agrees with the gap displacement.
        let times: Vec<f64> = (0..50).map(|k| 100.0 + f64::from(k) * 0.21).collect();
        let found = states(&piva, &start, &Limits::new(end, 3.0), &times).unwrap();
        let over = found.iter().filter(|s| s.angle.unwrap().value.abs() > 0.5 * PI).count();
        assert!(over > 5, "{over}");
        for state in found {
            let angle = state.angle.unwrap();
            assert!((2.0 * angle.value.sin() - state.gap_displacement).abs() < 1e-14);
            let rate = 2.0 * angle.value.cos() * angle.rate;
            assert!((rate - state.gap_velocity).abs() < 1e-13);
        }
    }
}

#[test]
fn the_order_of_the_series_is_the_one_it_says() {
    // With steps h the series of order N has a truncation error C h^(N+1): halving h divides it by 2^(N+1).
    // The exact values are those of the independent series.
    let p = Parameters {
        frequency_ratio: 0.9,
        inertia_ratio: 1.1,
        ..Parameters::point_bob(0.3, 0.5, 9.0, 0.05, 2.0)
    };
    let (x, u, angle, rate) = (1.0, -0.4, 0.7f64, 0.9);
    let pendulum = Pendulum {
        mass_ratio: 0.3,
        damping_ratio: 0.05,
        contact_distance: 2.0,
        inertia_ratio: 1.1,
        lever: 1.0,
        coupling: 1.0 / 1.1,
        frequency_squared: 0.9 * 0.9,
        pivot_damping: 0.0,
        spring: Spring::NONE,
        small_angles: false,
        level: 1.0,
        rise: 0.0,
    };
    let (sine, cosine) = sine_cosine(angle.into());
    let (y, c) = ((sine * 2.0).value(), cosine.value());
    let start = Swing { x, u, y, w: 2.0 * rate, c, arc: 0.0 };
    for order in [4, 6, 8] {
        let error = |h: f64| {
            let series: Series<f64> = pendulum.series(&start, None, h, order);
            let [_, _, later, _] = swing(&p, [x.into(), u.into(), angle.into(), rate.into()], h);
            let truth = sine_cosine(later).0 * 2.0;
            (truth - horner(&series.y[..=order], 1.0)).abs().value()
        };
        let measured = (error(0.2) / error(0.1)).log2();
        println!("order {order}: measured {measured}");
        assert!((measured - (order as f64 + 1.0)).abs() < 0.35, "order {order}: {measured}");
    }
}

proptest! {
    #![proptest_config(iva_tests::rejecting(400))]

    #[test]
    fn the_swing_is_that_of_lagranges_equations(
        p in compound(), x in -1.0..1.0f64, v in -1.0..1.0f64, angle in -1.2..1.2f64, rate in -0.5..0.5f64,
        time in 0.1..6.0f64, pivot in prop_oneof![Just(0.0), 0.0..0.3],
    ) {
        // The walls are out of reach, or not met; exact values from the independent double-double series.
        let away = if p.spring_ratio == 0.0 { 2.0 } else { 0.9999 };
        let clearance = away * p.contact_distance;
        let p = Parameters { clearance, pivot_damping_ratio: pivot, ..p };
        let (sine, cosine) = sine_cosine(angle.into());
        let y = (sine * p.contact_distance).value();
        let w = (cosine * p.contact_distance * rate).value();
        let start = Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w };
        let limits = Limits::new(6.0, p.clearance);
        let piva = Piva::new(p).unwrap();
        prop_assume!(run(&piva, &start.into(), &limits).unwrap().impacts.is_empty());
        let found = states(&piva, &start.into(), &limits, &[time]).unwrap()[0];
        let [true_x, true_u, true_angle, true_rate] =
            swing(&p, [x.into(), v.into(), angle.into(), rate.into()], time);
        let (sine, cosine) = sine_cosine(true_angle);
        let true_y = sine * p.contact_distance;
        let true_w = cosine * true_rate * p.contact_distance;
        // The rounding of the start grows over the time by a factor of some (1 + t)².
        let size = 1.0 + p.contact_distance;
        let allowed = 16.0 * U * size * (1.0 + time) * (1.0 + time);
        for (found, truth) in [
            (found.displacement, true_x),
            (found.velocity, true_u),
            (found.gap_displacement, true_y),
            (found.gap_velocity, true_w),
        ] {
            let error = (truth - found).abs().hi;
            prop_assert!(error <= allowed, "{error:e} of {allowed:e} at {time}");
        }
    }
}

#[test]
fn small_angles_swing_by_the_modes_of_the_linear_system() {
    // Exact values: the exponential of the 4 × 4 matrix of (x, y, ẋ, ẏ), walls out of reach.
    use nalgebra::{Matrix4, Vector4};
    for (mu, zeta, r, kappa, lever, pivot) in [
        (0.12, 0.0, 0.4, 1.0, 1.0, 0.0),
        (0.3, 0.02, 1.1, 1.2, 0.8, 0.0),
        (0.1, 0.1, 0.7, 1.0, 1.0, 0.05),
    ] {
        let contact = 3.0 / lever;
        let parameters = Parameters {
            frequency_ratio: r,
            inertia_ratio: kappa,
            contact_distance: contact,
            pivot_damping_ratio: pivot,
            angles: Angles::Small,
            ..Parameters::point_bob(mu, 0.5, 1e3, zeta, 3.0)
        };
        // (1+μ) ẍ + μλ ÿ = −x − 2ζẋ,   ÿ = −β ẍ − r² y − 2ζp r ẏ
        let beta = 1.0 / (kappa * lever);
        let inertia = 1.0 + mu - mu * lever * beta;
        let drag = 2.0 * pivot * r;
        let row = Vector4::new(-1.0, mu * lever * r * r, -2.0 * zeta, mu * lever * drag) / inertia;
        let gap = -beta * row + Vector4::new(0.0, -r * r, 0.0, -drag);
        let matrix = Matrix4::new(
            0.0, 0.0, 1.0, 0.0, //
            0.0, 0.0, 0.0, 1.0, //
            row[0], row[1], row[2], row[3], //
            gap[0], gap[1], gap[2], gap[3],
        );
        let start = Start { gap_displacement: 0.3, gap_velocity: -0.2, ..released(1.0) };
        let times: Vec<f64> = (1..=40).map(|k| f64::from(k) * 0.5).collect();
        let piva = Piva::new(parameters).unwrap();
        let found = states(&piva, &start.into(), &Limits::new(20.0, 1e3), &times).unwrap();
        for (state, time) in found.iter().zip(times) {
            let truth = (matrix * time).exp() * Vector4::new(1.0, 0.3, 0.0, -0.2);
            for (value, truth) in [
                (state.displacement, truth[0]),
                (state.gap_displacement, truth[1]),
                (state.velocity, truth[2]),
                (state.gap_velocity, truth[3]),
            ] {
                // The gap is computed as a distance to a wall 1000 away.
                assert!(
                    (value - truth).abs() < 1e-13 + 4.0 * U * 1e3,
                    "{value} for {truth} at {time}"
                );
            }
        }
    }
}

#[test]
fn small_and_large_angles_agree_as_the_square_of_the_angle() {
    let (mu, e, d, zeta) = (0.12, 0.5, 1.0, 0.01);
    let limits = Limits::new(12.0, d);
    let times = |length: f64, angles: Angles| -> Vec<f64> {
        let parameters = Parameters {
            frequency_ratio: 0.4,
            angles,
            ..Parameters::point_bob(mu, e, d, zeta, length)
        };
        let result = run(&Piva::new(parameters).unwrap(), &released(1.0).into(), &limits).unwrap();
        result.impacts.iter().map(|i| i.time).collect()
    };
    let difference = |length: f64| {
        let (small, large) = (times(length, Angles::Small), times(length, Angles::Large));
        assert_eq!(small.len(), large.len());
        small.iter().zip(&large).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let order = (difference(50.0) / difference(500.0)).log10();
    assert!((order - 2.0).abs() < 0.01, "order {order}");
    // At small angles the length has no effect.
    assert_eq!(times(5.0, Angles::Small).len(), times(50.0, Angles::Small).len());
}

#[test]
fn small_angles_without_gravity_are_the_single_mass() {
    for (mu, e, d, zeta) in [(0.15, 0.5, 0.6, 0.01), (0.15, 0.5, 0.1, 0.01), (0.1, 0.0, 0.4, 0.0)] {
        let limits = Limits::new(30.0, d);
        let parameters = Parameters {
            frequency_ratio: 1e-12,
            angles: Angles::Small,
            ..Parameters::point_bob(mu, e, d, zeta, 1.0)
        };
        let piva = run(&Piva::new(parameters).unwrap(), &released(1.0).into(), &limits).unwrap();
        let siva = run(&Siva::new(mu, e, d, zeta).unwrap(), &released(1.0), &limits).unwrap();
        let (list, expected) = (marks(&piva, FLOOR), marks(&siva, FLOOR));
        assert_eq!(list.len(), expected.len());
        // Both runs are within six units of the exact times; the conditions of these scenes are below 1e3.
        for (a, b) in list.iter().zip(&expected) {
            assert_eq!((a.kind, a.wall), (b.kind, b.wall));
            assert!(
                (a.time - b.time).abs() < 2.0 * UNITS_ALLOWED * U * (1e3 + a.time),
                "{}",
                a.time
            );
        }
    }
}
