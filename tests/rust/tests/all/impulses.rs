//! Impulses on the primary: their closed forms in flight and while stuck, and their work.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::{Absorber, OnStructure, Start},
    force::{Acts, Force, Harmonic, Impulse},
    host::DrivenHost,
    piva::{Given, Parameters, Piva, PivaStart},
    run::{Run, run, states},
    sample::State,
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_tests::{
    case::compound,
    driven::{mass, pendulum},
};
use proptest::{prelude::*, test_runner::TestCaseResult};

fn kicks(impulses: &[[f64; 2]]) -> Force {
    let impulse = |&[time, velocity]: &[f64; 2]| Impulse { velocity, time };
    Force::new(Vec::new(), Vec::new(), &Vec::from_iter(impulses.iter().map(impulse))).unwrap()
}

fn kicked<S>(system: &S, start: Start, duration: f64) -> Run<S::State>
where
    S: Absorber<Real = f64, Start: From<Start>>,
{
    let run = run(system, &start.into(), &Limits::new(duration, system.clearance())).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished);
    run
}

fn state_at(siva: &Siva<DrivenHost>, start: Start, duration: f64, time: f64) -> State {
    let limits = Limits::new(duration, siva.clearance());
    states(siva, &start, &limits, &[time]).unwrap()[0]
}

#[test]
fn an_impulse_at_time_zero_is_a_start_velocity() {
    let (mu, e, d, zeta, v) = (0.1, 0.6, 0.5, 0.01, 0.9);
    let run_ = kicked(&mass(mu, e, d, zeta)(kicks(&[[0.0, v]])), Start::default(), 60.0);
    // The absorber stays at rest: its gap velocity is −v.
    let start = Start { velocity: v, gap_velocity: -v, ..Start::default() };
    let siva = Siva::new(mu, e, d, zeta).unwrap();
    let free = run(&siva, &start, &Limits::new(60.0, d)).unwrap();
    assert_eq!(run_.impacts.len(), free.impacts.len());
    assert!(free.impacts.len() > 15);
    for (a, b) in run_.impacts.iter().zip(&free.impacts).take(10) {
        assert!((a.time - b.time).abs() < 1e-13 * (1.0 + b.time), "{} {}", a.time, b.time);
    }
    let (a, b) = (&run_.measures, &free.measures);
    assert_eq!(a.energy_initial, 0.0);
    assert_eq!(a.energy_work, 0.5 * v * v);
    // With impulses as the only force all measures of a decay are defined.
    for (one, other) in [
        (a.damping_ratio_1, b.damping_ratio_1),
        (a.damping_ratio_energy, b.damping_ratio_energy),
        (a.settling_time_10, b.settling_time_10),
        (a.damping_ratio_fit, b.damping_ratio_fit),
    ] {
        let (one, other) = (one.unwrap(), other.unwrap());
        assert!((one - other).abs() < 1e-9 * other, "{one} {other}");
    }
}

/// A plastic free mass that starts at rest on a wall that presses it; without impulse it is released at
/// τ = π/2.
fn riding(velocity: f64) -> (Siva<DrivenHost>, Start) {
    let siva = mass(0.25, 0.0, 0.5, 0.0)(kicks(&[[0.5, velocity]]));
    // For x > 0, ẍ < 0 presses wall + on the absorber.
    (siva, Start { displacement: 1.0, gap_displacement: 0.5, ..Start::default() })
}

#[test]
fn a_push_away_from_the_wall_sets_the_absorber_free() {
    // x = cos(ωτ) with ω² = 1/(1 + μ); the impulse v > 0 moves wall + away from the absorber.
    let (siva, start) = riding(0.3);
    let omega = 1.25f64.sqrt().recip();
    let truth = -omega * (omega * 0.5).sin() + 0.3;
    let after = state_at(&siva, start, 3.0, 0.5);
    assert!((after.velocity - truth).abs() < 1e-15);
    assert!((after.gap_velocity + 0.3).abs() < 1e-15);
    let run = run(&siva, &start, &Limits::new(3.0, 0.5)).unwrap();
    assert_eq!(run.episodes[0].release_time, Some(0.5));
}

#[test]
fn a_push_into_the_wall_moves_both_masses() {
    let (siva, start) = riding(-0.3);
    let omega = 1.25f64.sqrt().recip();
    let truth = -omega * (omega * 0.5).sin() - 0.3 / 1.25;
    let after = state_at(&siva, start, 3.0, 0.5);
    assert!((after.velocity - truth).abs() < 1e-15);
    assert_eq!((after.gap_velocity, after.wall), (0.0, 1));
    let run = run(&siva, &start, &Limits::new(3.0, 0.5)).unwrap();
    assert!(run.episodes[0].release_time.unwrap() > 0.6);
    // The work of the impulse is P(ẋ⁻ + ẋ⁺)/2.
    let work = -0.3 * (truth + 0.15 / 1.25);
    assert!((run.measures.energy_work - work).abs() < 1e-15);
    assert!(run.measures.energy_residual.abs() < 1e-15);
}

#[test]
fn a_damped_push_can_let_go_at_once() {
    // After an impulse into the wall the pair moves back so fast that the damper decides, not the spring:
    // A = −(x + 2ζẋ)/(1 + μ) changes sign, and the wall moves off the absorber.
    let siva = mass(0.25, 0.0, 0.5, 0.5)(kicks(&[[0.1, -2.0]]));
    let start = Start { displacement: 1.0, gap_displacement: 0.5, ..Start::default() };
    let run = run(&siva, &start, &Limits::new(1.0, 0.5)).unwrap();
    assert_eq!(run.episodes[0].release_time, Some(0.1));
}

#[test]
fn an_impulse_in_the_instant_of_an_impact_follows_it() {
    // The contact is at τ = arccos(1 − d): the impulse is placed at the nearest double, or just after it.
    let d = 0.5f64;
    let time = (1.0 - d).acos();
    let under = mass(0.1, 0.5, d, 0.0);
    let start = Start { displacement: 1.0, ..Start::default() };
    for shift in -3..=3 {
        let time = time + f64::from(shift) * f64::EPSILON;
        for velocity in [0.5, -0.5] {
            let run = kicked(&under(kicks(&[[time, velocity]])), start, 8.0);
            assert!(run.measures.energy_residual.abs() < 1e-14, "{shift} {velocity}");
            for impact in &run.impacts {
                assert!(impact.approach_speed() >= 0.0);
            }
        }
    }
}

fn closes_the_ledger<S: Absorber<Real = f64, Start: From<Start>>>(system: &S) -> TestCaseResult {
    let run = kicked(system, Start { displacement: 1.0, ..Start::default() }, 60.0);
    let m = &run.measures;
    let turned = m.energy_initial + m.energy_viscous + run.tally.energy_impacts + m.energy_pivot;
    prop_assert!(m.energy_residual.abs() < 1e-11 * turned, "{:e}", m.energy_residual);
    Ok(())
}

proptest! {
    #![proptest_config(iva_tests::cases(100))]

    #[test]
    fn momentum_and_energy_follow_the_impulse(
        parameters in compound(),
        angle in -0.9..0.9f64,
        velocity in -1.0..1.0f64,
        rate in -1.0..1.0f64,
    ) {
        let piva = Piva::new(parameters).unwrap().under(kicks(&[[0.0, velocity]]));
        let b = parameters.contact_distance;
        let start = PivaStart {
            displacement: 0.3,
            velocity: 0.2,
            place: Given::Gap(angle * parameters.clearance),
            rate: Given::Gap(rate),
        };
        let before = piva.begin(&start);
        let after = piva.apply_impulse(&before, velocity, false);
        // The momentum of all masses along x grows by P. The angular momentum of the pendulum about its
        // pivot, less the part from the motion of the pivot, does not change.
        let mass = parameters.mass_ratio;
        let cosine = (1.0 - (angle * parameters.clearance / b).powi(2)).sqrt();
        let of = |state| {
            let v = piva.primary(&state).v;
            let swing = piva.angle(&state).unwrap().rate;
            (
                (1.0 + mass) * v + mass * parameters.length * cosine * swing,
                parameters.inertia_ratio * parameters.length * swing + cosine * v,
            )
        };
        let ((p0, l0), (p1, l1)) = (of(before), of(after));
        prop_assert!((p1 - p0 - velocity).abs() < 1e-13 * (1.0 + p0.abs()));
        prop_assert!((l1 - l0).abs() < 1e-13 * (1.0 + l0.abs()));
        let gained = piva.energy(&after) - piva.energy(&before);
        let work = 0.5 * velocity * (piva.primary(&before).v + piva.primary(&after).v);
        prop_assert!((gained - work).abs() < 1e-12 * (1.0 + piva.energy(&before)));
    }

    #[test]
    fn the_ledger_closes_over_a_hail_of_impulses(
        parameters in compound(),
        hail in prop::collection::vec((0.0..50.0f64, -0.5..0.5f64), 1..30),
        amplitude in 0.0..0.3f64,
    ) {
        let impulses: Vec<Impulse> =
            hail.iter().map(|&(time, velocity)| Impulse { velocity, time }).collect();
        let harmonic = Harmonic { amplitude, frequency: 1.1, phase: 0.3, acts: Acts::Base };
        let force = Force::new(vec![harmonic], Vec::new(), &impulses).unwrap();
        let Parameters { mass_ratio, restitution, clearance, damping_ratio, .. } = parameters;
        closes_the_ledger(&pendulum(parameters)(force.clone()))?;
        closes_the_ledger(&mass(mass_ratio, restitution, clearance, damping_ratio)(force))?;
    }
}

#[test]
fn an_impulse_within_the_last_rebounds_of_a_chatter_comes_before_the_stick() {
    // The end of the chatter without impulse is known; a chatter must not be summed across an impulse just
    // before it, so there is no stick before the impulse.
    let under = mass(0.1, 0.5, 0.1, 0.0);
    let start = Start { displacement: 1.0, ..Start::default() };
    let end = kicked(&under(Force::default()), start, 20.0).episodes[0].stick_time;
    for exponent in 2..13 {
        let time = end - 10f64.powi(-exponent);
        let run = kicked(&under(kicks(&[[time, -0.3], [time, 0.3]])), start, 20.0);
        assert!(run.measures.energy_residual.abs() < 1e-14);
        for episode in &run.episodes {
            assert!(episode.release_time.is_none_or(|release| release >= episode.stick_time));
            assert!(episode.stick_time > time, "1e-{exponent}: {episode:?}");
        }
    }
}
