//! An absorber outside the core, in one file (`iva_tests::dashpot`): it runs alone and in sweeps, its errors
//! are estimated, and its runs are verified and differentiated.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{Absorber, OnStructure, Start},
    coupled::{Coupled, CoupledState},
    measures::Wanted,
    observe::Events,
    piva::{Angles, Parameters, Piva},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::side_by_side::{self, Job, Listing, Tier},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
};
use iva_tests::{U, dashpot::Dashpot, rng::Rng};
use nalgebra::{Matrix4, Vector4};

/// μ, e, d, ζ, and the constants γ of the dashpot and κ of the spring.
const NUMBERS: [f64; 6] = [0.15, 0.6, 0.4, 0.02, 0.3, 0.5];

fn start<R: Real>() -> Start<R> {
    Start { displacement: R::ONE, ..Start::default() }
}

fn decay<R: Real>(numbers: [R; 6], duration: f64) -> Run<CoupledState<R>, R> {
    let limits = Limits::new(R::from(duration), numbers[2]);
    run(&Dashpot(numbers).mounted(), &start(), &limits).unwrap()
}

#[test]
fn without_dashpot_and_spring_it_is_a_free_mass() {
    let mut rng = Rng::new(5);
    let mut compared = 0;
    for _ in 0..200 {
        let [mu, e, d] =
            [rng.log_range(0.02, 0.4), rng.pick(&[0.0, 0.5, 0.8, 1.0]), rng.log_range(0.1, 1.5)];
        let zeta = rng.pick(&[0.0, 0.05, 0.3]);
        let found = decay([mu, e, d, zeta, 0.0, 0.0], 3.0 * TAU);
        let mut seen = (Events::default(), Errors::default());
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        simulate(&siva, &start(), &Limits::new(3.0 * TAU, d), None, &mut seen).unwrap();
        let (Events { impacts, episodes }, errors) = seen;
        for ((a, b), error) in found.impacts.iter().zip(&impacts).zip(&errors.impacts) {
            // The state in plain numbers loses some units in the last place at each event.
            let allowed = 64.0 * error.time.unwrap_or(f64::INFINITY);
            if allowed > 1e-9 {
                break;
            }
            assert_eq!(a.wall, b.wall);
            assert!((a.time - b.time).abs() <= allowed, "{} {} {allowed:e}", a.time, b.time);
            compared += 1;
        }
        if errors.digits().is_some_and(|digits| digits > 12.0) {
            assert_eq!(found.episodes.len(), episodes.len());
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn a_start_outside_its_gap_is_refused() {
    let outside = Start { gap_displacement: 0.5, ..start() };
    let error = run(&Dashpot(NUMBERS).mounted(), &outside, &Limits::new(1.0, 0.4)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "start.gap_displacement = 0.5: it must lie in the gap, from -0.4 to 0.4"
    );
}

#[test]
fn its_energies_add_up() {
    for gamma in [0.01, 0.3, 2.0] {
        for e in [0.0, 0.6, 1.0] {
            let found = decay([0.15, e, 0.4, 0.02, gamma, 0.5 * gamma], 15.0 * TAU);
            let m = found.measures;
            assert_eq!(found.tally.outcome, Outcome::Finished);
            assert!(m.energy_pivot > 0.0 && m.energy_viscous > 0.0);
            assert!(m.energy_residual.abs() < 1e-14, "{gamma} {e}: {:e}", m.energy_residual);
        }
    }
}

#[test]
fn its_errors_are_what_is_estimated() {
    let plain = decay(NUMBERS, 6.0 * TAU);
    let exact = decay(NUMBERS.map(Twofold::from), 6.0 * TAU);
    let mut errors = Errors::default();
    let limits = Limits::new(6.0 * TAU, NUMBERS[2]);
    simulate(&Dashpot(NUMBERS).mounted(), &start(), &limits, None, &mut errors).unwrap();
    assert_eq!(plain.impacts.len(), exact.impacts.len());
    assert!(plain.impacts.len() > 10);
    for ((a, b), error) in plain.impacts.iter().zip(&exact.impacts).zip(&errors.impacts) {
        let (off, estimate) = (f64::from(b.time - a.time).abs(), error.time.unwrap());
        assert!(off <= 16.0 * estimate + 4.0 * U, "{}: {off:e} {estimate:e}", a.time);
    }
}

/// Dashpots and springs from weak to strong, in gaps from narrow to wide, with and without chatter and sticking.
fn jobs() -> Vec<Job<Coupled<Dashpot>>> {
    let job = |k: u32| {
        let k = f64::from(k);
        let e = [0.0, 0.4, 0.6, 0.9, 1.0][k as usize % 5];
        let system = Dashpot([0.15, e, 0.1 + 0.02 * k, 0.02, 0.01 * k, 0.03 * (k % 9.0)]).mounted();
        Job {
            begin: 0.0,
            system,
            start: start(),
            limits: Limits::new(10.0 * TAU, system.clearance()),
            steady: None,
            tier: Tier::Exact,
        }
    };
    (0..45).map(job).collect()
}

/// Tally, measures, events and errors have the bits of a run alone.
#[test]
fn sweeps_of_it_are_its_runs() {
    let jobs = jobs();
    let mut seen = vec![false; jobs.len()];
    let all = Listing { events: true, errors: true, envelope: true, ..Listing::default() };
    side_by_side::run_listed(
        &jobs,
        (Wanted::ALL, &all),
        None,
        &mut |i, (tally, measures, _), listed| {
            let Job { system, start, limits, .. } = &jobs[i];
            let alone = run(system, start, limits).unwrap();
            assert_eq!((*tally, *measures), (alone.tally, alone.measures), "{i}");
            let events = listed.events.unwrap();
            assert_eq!((events.impacts, events.episodes), (alone.impacts, alone.episodes), "{i}");
            assert_eq!(listed.envelope.unwrap(), alone.peaks, "{i}");
            let mut truth = Errors::default();
            simulate(system, start, limits, None, &mut truth).unwrap();
            let told = |it: &Errors| format!("{:?} {:?}", it.impacts, it.condition());
            assert_eq!(told(&listed.errors.unwrap()), told(&truth), "{i}");
            seen[i] = true;
        },
    )
    .unwrap();
    assert!(seen.iter().all(|seen| *seen));
}

/// In a gap that it never crosses it is a tuned damper: the motion is e^{Mt} of its start. (A matrix exponential by
/// another library; here for 40 times the reach of one series.)
#[test]
fn a_spring_in_a_wide_gap_makes_it_a_tuned_damper() {
    let [mu, zeta, gamma, kappa] = [0.1, 0.02, 0.2, 0.8];
    let sprung = Dashpot([mu, 0.5, 100.0, zeta, gamma, kappa]).mounted();
    let duration = 30.0;
    let found = run(&sprung, &start(), &Limits::new(duration, 100.0)).unwrap();
    assert_eq!((found.tally.outcome, found.tally.impacts), (Outcome::Finished, 0));
    let on_x = Matrix4::new(
        0.0,
        1.0,
        0.0,
        0.0, //
        -1.0,
        -2.0 * zeta,
        mu * kappa,
        mu * gamma, //
        0.0,
        0.0,
        0.0,
        1.0, //
        1.0,
        2.0 * zeta,
        -(1.0 + mu) * kappa,
        -(1.0 + mu) * gamma,
    );
    let truth = (on_x * duration).exp() * Vector4::new(1.0, 0.0, 0.0, 0.0);
    let last = sprung.primary(&found.tally.state);
    assert!((last.x - truth[0]).abs() < 1e-13 && (last.v - truth[1]).abs() < 1e-13, "{last:?}");
    let m = found.measures;
    assert!(m.energy_residual.abs() < 1e-14, "{:e}", m.energy_residual);
    assert!(m.energy_pivot > 0.1, "{}", m.energy_pivot);
}

/// The energies of impacts, dashpot, spring and structure add up, also where the mass sticks to a wall.
#[test]
fn energies_with_a_spring_add_up() {
    let mut episodes = 0;
    for kappa in [0.05, 0.8, 4.0] {
        for (e, gamma) in [(0.0, 0.3), (0.6, 0.05), (0.6, 2.0), (1.0, 0.0)] {
            let sprung = Dashpot([0.15, e, 0.2, 0.02, gamma, kappa]).mounted();
            let found = run(&sprung, &start(), &Limits::new(15.0 * TAU, 0.2)).unwrap();
            assert_eq!(found.tally.outcome, Outcome::Finished, "{kappa} {e} {gamma}");
            assert!(found.tally.impacts > 0, "{kappa} {e} {gamma}");
            let residual = found.measures.energy_residual;
            assert!(residual.abs() < 3e-14, "{kappa} {e} {gamma}: {residual:e}");
            episodes += found.tally.episodes;
        }
    }
    assert!(episodes > 0);
}

/// A spring of stiffness r² and a dashpot of constant 2ζₚr make it a pendulum at small angles.
#[test]
fn with_a_spring_it_is_a_pendulum_at_small_angles() {
    let [mu, d, zeta, ratio, pivot] = [0.1, 0.3, 0.02, 0.6, 0.05];
    let mut events = [0; 2];
    for e in [0.0, 0.4, 0.8] {
        let sprung = Dashpot([mu, e, d, zeta, 2.0 * pivot * ratio, ratio * ratio]).mounted();
        let piva = Piva::new(Parameters {
            frequency_ratio: ratio,
            pivot_damping_ratio: pivot,
            angles: Angles::Small,
            ..Parameters::point_bob(mu, e, d, zeta, 2.0)
        })
        .unwrap();
        let limits = Limits::new(5.0 * TAU, d);
        let found = run(&sprung, &start(), &limits).unwrap();
        let expected = run(&piva, &start().into(), &limits).unwrap();
        assert_eq!(found.impacts.len(), expected.impacts.len(), "{e}");
        assert_eq!(found.episodes.len(), expected.episodes.len(), "{e}");
        for (a, b) in found.impacts.iter().zip(&expected.impacts) {
            assert_eq!(a.wall, b.wall);
            assert!((a.time - b.time).abs() < 1e-11, "{e}: {} {}", a.time, b.time);
        }
        for (a, b) in found.episodes.iter().zip(&expected.episodes) {
            let off = a.release_time.zip(b.release_time).map_or(0.0, |(a, b)| (a - b).abs());
            assert!(off < 1e-10, "{e}: {off:e}");
        }
        events[0] += found.impacts.len();
        events[1] += found.episodes.len();
    }
    assert!(events[0] > 20 && events[1] > 3, "{events:?}");
}
