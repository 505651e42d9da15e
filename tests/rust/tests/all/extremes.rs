//! Largest displacements of an absorber and accelerations of its structure, and runs that begin after time
//! zero.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::sync::Arc;

use iva_core::{
    absorber::{Absorber, Start},
    extremes::{ExtremeValues, Extremes},
    force::{Acts, Force, Harmonic, History, Record},
    measures::{Measures, Wanted},
    observe::Events,
    piva::{Parameters, Piva},
    sample::Sampler,
    simulate::{Limits, simulate, simulate_from},
    siva::Siva,
    steady::{Steady, SteadyWanted, Window},
};
use iva_tests::list::{begun, driven, list};
use iva_tests::{U, rng::Rng};

fn extremes<S: Absorber<Real = f64>>(system: &S, start: &S::Start, duration: f64) -> ExtremeValues {
    let mut found = Extremes::new(0.0);
    let limits = Limits::new(duration, system.clearance());
    simulate(system, start, &limits, None, &mut found).unwrap();
    found.values()[0]
}

#[test]
fn an_absorber_that_meets_nothing_rests_in_space() {
    // x = cos τ, and the absorber stays at x + y = 1, so y = 1 − cos τ.
    let siva = Siva::new(0.1, 0.5, 3.0, 0.0).unwrap();
    let start = Start { displacement: 1.0, ..Start::default() };
    let found = extremes(&siva, &start, 5.0);
    for (value, truth) in [
        (found.gap_displacement, 2.0),
        (found.stroke, 2.0),
        (found.absorber_displacement, 1.0),
        (found.acceleration, 1.0),
    ] {
        assert!((value.unwrap() - truth).abs() <= 8.0 * U, "{found:?}");
    }
    // Before the first extremum of x, the ends are the extremes.
    let found = extremes(&siva, &start, 2.0);
    let y = 1.0 - 2f64.cos();
    assert!((found.stroke.unwrap() - y).abs() <= 8.0 * U, "{found:?}");
    // With w = 1/4 from y = −1: x₁ = τ/4, and y = τ/4 − cos τ has its extremum where sin τ = −1/4.
    let drifting = Start { gap_displacement: -1.0, gap_velocity: 0.25, ..start };
    let found = extremes(&siva, &drifting, 6.0);
    let turn = std::f64::consts::PI + 0.25f64.asin();
    let most = turn / 4.0 - turn.cos();
    let least = -(0.25f64.asin()) / 4.0 - (-(0.25f64.asin())).cos();
    assert!(least > -1.1, "{least}");
    for (value, truth) in [
        (found.gap_displacement, most),
        (found.stroke, most + 1.0),
        (found.absorber_displacement, 1.5),
    ] {
        assert!((value.unwrap() - truth).abs() <= 16.0 * U, "{found:?} {truth}");
    }
}

#[test]
fn between_both_walls_the_stroke_is_the_play() {
    let start = Start { displacement: 1.0, ..Start::default() };
    let siva = Siva::new(0.1, 0.6, 0.3, 0.01).unwrap();
    let found = extremes(&siva, &start, 30.0);
    assert_eq!((found.gap_displacement, found.stroke), (Some(0.3), Some(0.6)));
    let beside = siva.with_offset(0.125).unwrap();
    let found = extremes(&beside, &start, 30.0);
    assert_eq!(found.gap_displacement, Some(0.425));
    assert!((found.stroke.unwrap() - 0.6).abs() <= 2.0 * U);
    let piva = Piva::new(Parameters::point_bob(0.1, 0.6, 0.3, 0.01, 5.0)).unwrap();
    let found = extremes(&piva, &start.into(), 30.0);
    assert_eq!((found.gap_displacement, found.stroke), (Some(0.3), Some(0.6)));
}

#[test]
fn without_absorber_there_is_an_acceleration() {
    // Released from x = 1 without damping: |ẍ| = 1 at the start. After a step a of the base acceleration
    // |A| = |x| reaches 2a.
    let alone = list(0.0, &[]);
    let found = extremes(&alone, &begun(iva_core::absorber::Point { x: 1.0, v: 0.0 }, &[]), 10.0);
    assert!((found.acceleration.unwrap() - 1.0).abs() <= 4.0 * U);
    let base = History::new(vec![0.0, 40.0], vec![0.25, 0.25]).unwrap();
    let base = Record { history: Arc::new(base), scale: 1.0, rate: 1.0, acts: Acts::Base };
    let shaken = driven(&alone, Force::new(Vec::new(), vec![base], &[]).unwrap());
    let found = extremes(&shaken, &begun(iva_core::absorber::Point { x: 0.0, v: 0.0 }, &[]), 10.0);
    assert!((found.acceleration.unwrap() - 0.5).abs() <= 8.0 * U, "{found:?}");
}

/// Samples of a run stay below its extremes, and come as close to them as the sampling interval allows.
fn assert_above_samples<S: Absorber<Real = f64>>(system: &S, start: &S::Start, gravity: f64) {
    let (duration, count) = (12.0, 24_000);
    let times = (0..=count).map(|k| duration * f64::from(k) / f64::from(count)).collect();
    let limits = Limits::new(duration, system.clearance());
    let mut seen = (Extremes::new(0.0), (Sampler::with_events(times), Events::default()));
    simulate(system, start, &limits, None, &mut seen).unwrap();
    let (extremes, (sampler, _)) = seen;
    let [found] = extremes.values() else { panic!("one absorber") };
    let largest = |value: &dyn Fn(&iva_core::sample::State) -> f64| {
        sampler.states.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
    };
    let most = largest(&|it| it.gap_displacement);
    let least = -largest(&|it| -it.gap_displacement);
    for (name, value, sampled) in [
        ("gap", found.gap_displacement, most.max(-least)),
        ("stroke", found.stroke, most - least),
        (
            "absorber",
            found.absorber_displacement,
            largest(&|it| (it.displacement + system.lever() * it.gap_displacement).abs()),
        ),
        ("acceleration", found.acceleration, largest(&|it| it.acceleration.abs())),
    ] {
        let value = value.unwrap();
        // Between samples h apart a function lies at most h²/8 of its second derivative above them.
        let rounding = 1e-13 * (1.0 + gravity) * value.max(1.0);
        assert!(sampled <= value + rounding, "{name}: {value} {sampled}");
        assert!(
            value - sampled <= 1e-6 * (1.0 + gravity) * value.max(1.0),
            "{name}: {value} {sampled}"
        );
    }
}

#[test]
fn samples_stay_below_and_come_close() {
    let mut rng = Rng::new(5);
    for _ in 0..25 {
        let (mu, e, d) = (rng.log_range(0.02, 0.3), rng.range(0.1, 0.9), rng.log_range(0.2, 3.0));
        let zeta = rng.pick(&[0.0, 0.02, 0.1]);
        let start = Start {
            displacement: rng.range(-1.5, 1.5),
            velocity: rng.range(-1.0, 1.0),
            gap_displacement: rng.range(-0.9, 0.9) * d,
            gap_velocity: rng.range(-0.5, 0.5),
        };
        let harmonic = |acts| {
            let (amplitude, frequency, phase) = (0.4, 1.3, 0.7);
            Force::new(vec![Harmonic { amplitude, frequency, phase, acts }], Vec::new(), &[])
                .unwrap()
        };
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        assert_above_samples(&siva, &start, 0.0);
        assert_above_samples(&siva.under(harmonic(Acts::Primary)), &start, 0.0);
        assert_above_samples(&siva.under(harmonic(Acts::Base)), &start, 0.0);
        let gravity = rng.log_range(0.1, 5.0);
        assert_above_samples(&siva.inclined(gravity, harmonic(Acts::Base)), &start, gravity);
        let point_bob = Parameters::point_bob(mu, e, d, zeta, 2.0 + 2.0 * d);
        let pendulum = Parameters { frequency_ratio: 0.4, contact_distance: 1.0 + d, ..point_bob };
        let piva = Piva::new(pendulum).unwrap();
        assert_above_samples(&piva, &start.into(), 0.0);
        assert_above_samples(&piva.under(harmonic(Acts::Base)), &start.into(), 0.0);
    }
}

#[test]
fn a_run_that_begins_later_meets_the_force_where_it_stands() {
    // cos(Ω(t₀ + τ)) is the cosine with phase Ω t₀.
    let (later, frequency) = (3.0, 1.3);
    let force = |phase| {
        let harmonic = Harmonic { amplitude: 0.4, frequency, phase, acts: Acts::Primary };
        Force::new(vec![harmonic], Vec::new(), &[]).unwrap()
    };
    let siva = Siva::new(0.1, 0.5, 0.6, 0.05).unwrap();
    let start = Start { displacement: 0.5, gap_velocity: 0.1, ..Start::default() };
    let observers = || {
        let window = Window { from: later, cycle: None };
        (
            Events::default(),
            Steady::new(window, SteadyWanted { rms: true, ..SteadyWanted::default() }),
        )
    };
    let (mut one, mut other) = (observers(), observers());
    let limits = Limits::new(later + 15.0, 0.6);
    simulate_from(&siva.under(force(0.0)), &start, later, &limits, None, &mut one).unwrap();
    other.1 = Steady::new(Window::default(), SteadyWanted { rms: true, ..SteadyWanted::default() });
    let limits = Limits::new(15.0, 0.6);
    simulate(&siva.under(force(frequency * later)), &start, &limits, None, &mut other).unwrap();
    assert!(one.0.impacts.len() > 5 && one.0.impacts.len() == other.0.impacts.len());
    for (a, b) in one.0.impacts.iter().zip(&other.0.impacts) {
        assert!((a.time - later - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
    }
    let [a, b] = [&one.1, &other.1].map(|steady| steady.values().amplitude_rms.unwrap());
    assert!((a - b).abs() < 1e-13, "{a} {b}");
}

#[test]
fn measures_of_a_decay_that_begins_later_count_from_there() {
    let siva = Siva::new(0.1, 0.5, 0.6, 0.05).unwrap();
    let start = Start { displacement: 1.0, ..Start::default() };
    let measured = |begin: f64, periods: f64| {
        let mut measures = Measures::new(Wanted::ALL);
        let limits = Limits::new(begin + periods * TAU, 0.6);
        simulate_from(&siva, &start, begin, &limits, None, &mut measures).unwrap();
        *measures.values()
    };
    let (one, other, short) = (measured(8.0, 9.0), measured(0.0, 9.0), measured(8.0, 0.9));
    let near = |a: Option<f64>, b: Option<f64>, shift: f64| {
        let (a, b) = (a.unwrap(), b.unwrap() + shift);
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    };
    near(one.damping_ratio_3, other.damping_ratio_3, 0.0);
    near(one.residual_amplitude, other.residual_amplitude, 0.0);
    // Settling times are instants on the clock of the force.
    near(one.settling_time_10, other.settling_time_10, 8.0);
    assert!(one.damping_ratio_energy.is_none() && other.damping_ratio_energy.is_some());
    // Nor is it defined for a run that begins within the first period of the clock.
    assert!(measured(2.0, 9.0).damping_ratio_energy.is_none());
    assert!(short.residual_amplitude.is_none());
    let end = Limits::new(8.0, 0.6);
    assert!(simulate_from(&siva, &start, 8.0, &end, None, &mut ()).is_err());
}
