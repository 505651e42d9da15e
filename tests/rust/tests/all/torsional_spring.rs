//! A pendulum with a torsional spring in its pivot, at large angles and small: closed forms, twice the precision, energies,
//! errors, derivatives, lanes and maps.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{Absorber, OnStructure, Start, Wall},
    force::{Acts, Force, Harmonic},
    host::{DrivenHost, UndrivenHost},
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    propagation::{Errors, Tangent},
    real::{Real, twofold::Twofold},
    run::{
        Run, run,
        side_by_side::{Job, SideBySide, Tier},
    },
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
};
use iva_tests::U;
use iva_tests::pendulum_list::still;

use crate::side_by_side::{alone, together};

/// μ, e, d, ζ, r, L, κ, b, ζp and σ of a compound pendulum that swings up to 60°.
const NUMBERS: [f64; 10] = [0.15, 0.6, 1.3, 0.02, 0.4, 1.2, 1.1, 1.5, 0.02, 0.7];

fn sprung<R: Real>(numbers: [R; 10]) -> Parameters<R> {
    let [mu, e, d, zeta, ratio, length, kappa, contact, pivot, spring] = numbers;
    Parameters {
        frequency_ratio: ratio,
        inertia_ratio: kappa,
        contact_distance: contact,
        pivot_damping_ratio: pivot,
        spring_ratio: spring,
        ..Parameters::point_bob(mu, e, d, zeta, length)
    }
}

fn start<R: Real>() -> PivaStart<R> {
    Start { displacement: R::from(3.0), ..Start::default() }.into()
}

fn force<R: Real>() -> Force<R> {
    let (amplitude, frequency) = (R::from(0.7), R::from(0.9));
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase: R::ZERO, acts: Acts::Primary }])
        .unwrap()
}

type Driven<R> = Run<iva_core::piva::PivaState<iva_core::host::Moment<R>, R>, R>;

fn driven<R: Real>(numbers: [R; 10], duration: f64) -> Driven<R> {
    let piva = Piva::new(sprung(numbers)).unwrap().under(force());
    run(&piva, &start(), &Limits::new(R::from(duration), numbers[2])).unwrap()
}

/// The bob is so light that the structure stays at rest, without gravity: θ = θ̇₀ sin(σt)/σ at any angle.
#[test]
fn alone_on_its_spring_it_swings_like_a_sine() {
    for (clearance, rate) in [(0.3, 0.5), (0.9, 1.2), (0.999, 2.0)] {
        let spring = 0.8;
        let parameters = Parameters {
            frequency_ratio: 0.0,
            spring_ratio: spring,
            ..Parameters::point_bob(1e-15, 0.5, clearance, 0.0, 1.0)
        };
        let piva = Piva::new(parameters).unwrap();
        let start = PivaStart { rate: Given::Angle(rate), ..Start::default().into() };
        let found = run(&piva, &start, &Limits::new(6.0, clearance)).unwrap();
        let expected = (clearance.asin() * spring / rate).asin() / spring;
        let off = found.impacts[0].time - expected;
        // The angle of the wall is known to rounding of its sine.
        let allowed = 8.0 * U / (1.0 - clearance * clearance).sqrt();
        assert!(off.abs() < allowed, "{clearance}: {off:e}");
        // It comes back with e times the rate, and passes from this wall to the other one around the middle.
        let wall = spring * clearance.asin();
        let swing = (0.5 * rate * (spring * expected).cos()).hypot(wall);
        let across = 2.0 * (wall / swing).asin() / spring;
        let off = found.impacts[1].time - found.impacts[0].time - across;
        assert!(off.abs() < 8.0 * allowed, "{clearance}: {off:e}");
    }
}

#[test]
fn at_small_angles_spring_and_gravity_add_up() {
    let [mu, e, d, zeta, ..] = NUMBERS;
    let bob = Parameters::point_bob(mu, e, d, zeta, 2.0);
    let small = Parameters { angles: Angles::Small, ..bob };
    let (ratio, spring) = (0.4, 0.3);
    let with = Parameters { frequency_ratio: ratio, spring_ratio: spring, ..small };
    let without = Parameters { frequency_ratio: 0.5, ..small };
    let limits = Limits::new(10.0 * TAU, d);
    let found = [with, without].map(|p| run(&Piva::new(p).unwrap(), &start(), &limits).unwrap());
    let [with, without] = found;
    assert!(with.impacts.len() > 10);
    assert_eq!(with.impacts.len(), without.impacts.len());
    for (a, b) in with.impacts.iter().zip(&without.impacts) {
        assert!(a.wall == b.wall && (a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
    }
    // Without gravity and spring it is a free mass.
    let free = Parameters { spring_ratio: 1e-12, ..Parameters::free_mass(mu, e, d, zeta) };
    let free = run(&Piva::new(free).unwrap(), &start(), &limits).unwrap();
    let siva = Siva::new(mu, e, d, zeta).unwrap();
    let mass = Start { displacement: 3.0, ..Start::default() };
    let siva = run(&siva, &mass, &limits).unwrap();
    for (a, b) in free.impacts.iter().zip(&siva.impacts) {
        assert!((a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
    }
}

/// Impacts, sticks and releases under a force against numbers of twice the precision.
#[test]
fn its_errors_are_what_is_estimated() {
    let mut episodes = 0;
    for (e, clearance) in [(0.0, 0.4), (0.3, 0.8), (0.6, 1.3), (0.3, 1.45)] {
        let mut numbers = NUMBERS;
        (numbers[1], numbers[2]) = (e, clearance);
        let duration = 6.0 * TAU;
        let plain = driven(numbers, duration);
        let exact = driven(numbers.map(Twofold::from), duration);
        let mut errors = Errors::default();
        let piva = Piva::new(sprung(numbers)).unwrap().under(force());
        let limits = Limits::new(duration, clearance);
        simulate(&piva, &start(), &limits, None, &mut errors).unwrap();
        assert_eq!(plain.impacts.len(), exact.impacts.len(), "{numbers:?}");
        assert_eq!(plain.episodes.len(), exact.episodes.len(), "{numbers:?}");
        for ((a, b), error) in plain.impacts.iter().zip(&exact.impacts).zip(&errors.impacts) {
            let (off, estimate) = (f64::from(b.time - a.time).abs(), error.time.unwrap());
            assert!(off <= 4.0 * estimate + 4.0 * U, "{e} {}: {off:e} {estimate:e}", a.time);
        }
        for (a, b) in plain.episodes.iter().zip(&exact.episodes) {
            let release = |from, to: Twofold| f64::from(to - from).abs();
            let off = a.release_time.zip(b.release_time).map_or(0.0, |(a, b)| release(a, b));
            assert!(off < 1e-12, "{e} {}: {off:e}", a.stick_time);
            episodes += 1;
        }
        let residual = plain.measures.energy_residual;
        assert!(plain.tally.outcome == Outcome::Finished && residual.abs() < 1e-13, "{residual:e}");
    }
    assert!(episodes > 3, "{episodes}");
}

/// x, ẋ, y and W at the end of a run from a start.
fn end<R: Real>(numbers: [R; 10], start: &Start<R>, duration: f64) -> [R; 4] {
    let piva = Piva::new(sprung(numbers)).unwrap();
    let limits = Limits::new(R::from(duration), numbers[2]);
    let state = simulate(&piva, &(*start).into(), &limits, None, &mut ()).unwrap().state;
    let (primary, gap) = (piva.primary(&state), piva.distance(&state));
    let sign = if piva.wall(&state) == Wall::Plus { R::ONE } else { -R::ONE };
    let rate = piva.angle(&state).unwrap().rate * numbers[7];
    [primary.x, primary.v, sign * (numbers[2] - gap.value), rate]
}

#[test]
fn the_derivative_of_a_run_is_that_of_differences() {
    let duration = 1.2 * TAU;
    let piva = Piva::new(sprung(NUMBERS)).unwrap();
    let mut tangent = Tangent::default();
    let limits = Limits::new(duration, NUMBERS[2]);
    let tally = simulate(&piva, &start(), &limits, None, &mut tangent).unwrap();
    assert!(tally.impacts > 2 && tally.episodes == 0);
    for varied in 0..4 {
        let moved = |by: f64| {
            let mut start =
                Start { displacement: Twofold::from(3.0), ..Start::<Twofold>::default() };
            let fields = [
                &mut start.displacement,
                &mut start.velocity,
                &mut start.gap_displacement,
                &mut start.gap_velocity,
            ];
            *fields.into_iter().nth(varied).unwrap() += by;
            end(NUMBERS.map(Twofold::from), &start, duration)
        };
        let (low, high) = (moved(-1e-9), moved(1e-9));
        for row in 0..4 {
            let truth = f64::from((high[row] - low[row]) / 2e-9);
            let off = (tangent.derivative()[(row, varied)] - truth).abs();
            assert!(off < 1e-9 * truth.abs().max(1.0), "{row} {varied}: {truth} {off:e}");
        }
    }
}

/// Sweeps go in lanes; their bits are those of single runs.
fn swept_alike<S: SideBySide<Real = f64>>(mount: impl Fn(Piva<UndrivenHost>) -> S)
where
    PivaStart: Into<S::Start>,
{
    let jobs: Vec<Job<S>> = (0..40)
        .map(|k| {
            let mut numbers = NUMBERS;
            (numbers[2], numbers[9]) = (0.3 + 0.03 * f64::from(k), 0.02 * f64::from(k + 1));
            let system = mount(Piva::new(sprung(numbers)).unwrap());
            let limits = Limits::new(10.0 * TAU, numbers[2]);
            let start = start::<f64>().into();
            Job { begin: 0.0, system, start, limits, steady: None, tier: Tier::Exact }
        })
        .collect();
    let impacts = jobs.iter().zip(together(&jobs)).map(|(job, found)| {
        assert_eq!(found, alone(job));
        run(&job.system, &job.start, &job.limits).unwrap().tally.impacts
    });
    assert!(impacts.sum::<u64>() > 300);
}

#[test]
fn sweeps_of_it_are_its_runs() {
    swept_alike::<Piva<DrivenHost>>(|piva| still(&piva));
    swept_alike::<Piva<DrivenHost>>(|piva| piva.under(force()));
}

#[test]
fn a_spring_needs_stops_in_reach() {
    let parameters = Parameters { clearance: 1.5, ..sprung(NUMBERS) };
    let error = Piva::new(parameters).unwrap_err().to_string();
    assert!(error.contains("absorber.clearance") && error.contains("less than 1.5"), "{error}");
    let error = Piva::new(Parameters { spring_ratio: -1.0, ..sprung(NUMBERS) }).unwrap_err();
    assert!(error.to_string().contains("absorber.spring_ratio"), "{error}");
}
