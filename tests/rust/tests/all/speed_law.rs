//! An impact law outside the core whose restitution depends on the approach speed (`iva_tests::speed_law`): impacts, the
//! sum of its chatter, errors and derivatives. The truth is the same run in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{Absorber, OnStructure, Start, Wall},
    measures::Wanted,
    observe::Events,
    propagation::{Errors, Tangent},
    real::{Real, twofold::Twofold},
    run::side_by_side::{self, Job, Listing, Tier},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::{Siva, SivaState},
};
use iva_tests::{U, speed_law::Softening};

/// μ, e₀, d, ζ and w₀.
const NUMBERS: [f64; 5] = [0.15, 0.8, 0.4, 0.02, 0.7];

fn start<R: Real>() -> Start<R> {
    Start { displacement: R::ONE, ..Start::default() }
}

fn decay<R: Real>(numbers: [R; 5], duration: f64) -> Run<SivaState<(), R>, R> {
    let limits = Limits::new(R::from(duration), numbers[2]);
    run(&Softening::new(numbers).unwrap(), &start(), &limits).unwrap()
}

#[test]
fn at_a_speed_beyond_all_others_it_is_newtons_law() {
    let [mu, _, _, zeta, _] = NUMBERS;
    let (e, d) = (0.3, 0.1);
    let found = decay([mu, e, d, zeta, f64::INFINITY], 20.0 * TAU);
    let siva = Siva::new(mu, e, d, zeta).unwrap();
    let mut events = Events::default();
    simulate(&siva, &start(), &Limits::new(20.0 * TAU, d), None, &mut events).unwrap();
    assert!(found.impacts.len() > 20 && found.episodes.len() > 1);
    assert_eq!(found.impacts.len(), events.impacts.len());
    assert_eq!(found.episodes.len(), events.episodes.len());
    // A free mass far from its walls coasts, which rounds in another way.
    for (a, b) in found.impacts.iter().zip(&events.impacts) {
        assert!(a.wall == b.wall && (a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
    }
}

#[test]
fn each_rebound_has_the_restitution_of_its_speed() {
    let [_, e, _, _, speed] = NUMBERS;
    for impact in decay(NUMBERS, 20.0 * TAU).impacts {
        let approach = impact.approach_speed();
        let expected = e / (1.0 + approach / speed) * approach;
        let off = (impact.gap_velocity_after.abs() - expected).abs();
        assert!(off <= 4.0 * U * approach, "{off:e}");
    }
}

/// Impacts and sticks of a chatter whose ratio grows from rebound to rebound. The sum of a chatter as if the ratio were
/// constant would be wrong in the seventh digit.
#[test]
fn its_errors_are_what_is_estimated_and_a_chatter_is_summed_in_time() {
    let mut sticks = 0;
    for clearance in [0.05, 0.1, 0.2, 0.4] {
        for e in [0.3, 0.8] {
            let numbers = [0.15, e, clearance, 0.02, 0.7];
            let plain = decay(numbers, 3.0 * TAU);
            let exact = decay(numbers.map(Twofold::from), 3.0 * TAU);
            let mut errors = Errors::default();
            let limits = Limits::new(3.0 * TAU, clearance);
            let system = Softening::new(numbers).unwrap();
            simulate(&system, &start(), &limits, None, &mut errors).unwrap();
            assert_eq!(plain.impacts.len(), exact.impacts.len(), "{numbers:?}");
            for ((a, b), error) in plain.impacts.iter().zip(&exact.impacts).zip(&errors.impacts) {
                let (off, estimate) = (f64::from(b.time - a.time).abs(), error.time.unwrap());
                assert!(off <= 4.0 * estimate + 4.0 * U, "{}: {off:e} {estimate:e}", a.time);
            }
            for (a, b) in plain.episodes.iter().zip(&exact.episodes) {
                let off = f64::from(b.stick_time - a.stick_time).abs();
                assert!(off <= 1e-13, "{numbers:?} {}: {off:e}", a.stick_time);
                sticks += 1;
            }
        }
    }
    assert!(sticks > 10, "{sticks}");
}

#[test]
fn its_energies_add_up() {
    let found = decay(NUMBERS, 20.0 * TAU);
    assert_eq!(found.tally.outcome, Outcome::Finished);
    let residual = found.measures.energy_residual;
    assert!(residual.abs() < 1e-14, "{residual:e}");
}

/// x, ẋ, y and ẏ at the end of a run from a start.
fn end<R: Real>(numbers: [R; 5], start: &Start<R>, duration: f64) -> [R; 4] {
    let system = Softening::new(numbers).unwrap();
    let limits = Limits::new(R::from(duration), numbers[2]);
    let state = simulate(&system, start, &limits, None, &mut ()).unwrap().state;
    let (primary, gap) = (system.primary(&state), system.distance(&state));
    let sign = if system.wall(&state) == Wall::Plus { R::ONE } else { -R::ONE };
    [primary.x, primary.v, sign * (numbers[2] - gap.value), -(sign * gap.rate)]
}

#[test]
fn the_derivative_of_a_run_is_that_of_differences() {
    let duration = 1.2 * TAU;
    let system = Softening::new(NUMBERS).unwrap();
    let mut tangent = Tangent::default();
    let limits = Limits::new(duration, NUMBERS[2]);
    let tally = simulate(&system, &start(), &limits, None, &mut tangent).unwrap();
    assert!(tally.impacts > 3 && tally.episodes == 0);
    let numbers = NUMBERS.map(Twofold::from);
    for varied in 0..4 {
        let moved = |by: f64| {
            let mut start = start::<Twofold>();
            let fields = [
                &mut start.displacement,
                &mut start.velocity,
                &mut start.gap_displacement,
                &mut start.gap_velocity,
            ];
            *fields.into_iter().nth(varied).unwrap() += by;
            end(numbers, &start, duration)
        };
        let (low, high) = (moved(-1e-9), moved(1e-9));
        for row in 0..4 {
            let truth = f64::from((high[row] - low[row]) / 2e-9);
            let off = (tangent.derivative()[(row, varied)] - truth).abs();
            assert!(off < 1e-9 * truth.abs().max(1.0), "{row} {varied}: {truth} {off:e}");
        }
    }
}

#[test]
fn sweeps_of_it_are_its_runs() {
    let jobs: Vec<Job<Softening>> = (0..20)
        .map(|k| {
            let clearance = 0.1 + 0.05 * f64::from(k);
            let system = Softening::new([0.15, 0.7, clearance, 0.02, 0.5]).unwrap();
            let limits = Limits::new(10.0 * TAU, clearance);
            Job { begin: 0.0, system, start: start(), limits, steady: None, tier: Tier::Exact }
        })
        .collect();
    let (mut seen, all) = (0, Listing { events: true, errors: true, ..Listing::default() });
    side_by_side::run_listed(
        &jobs,
        (Wanted::ALL, &all),
        None,
        &mut |i, (tally, measures, _), listed| {
            let Job { system, start, limits, .. } = &jobs[i];
            let alone = run(system, start, limits).unwrap();
            assert_eq!((*tally, *measures), (alone.tally, alone.measures), "{i}");
            assert_eq!(listed.events.unwrap().impacts, alone.impacts, "{i}");
            assert_eq!(listed.errors.unwrap().impacts.len(), alone.impacts.len(), "{i}");
            seen += 1;
        },
    )
    .unwrap();
    assert_eq!(seen, jobs.len());
}
