//! Steady states: strobes, amplitudes and regimes compared with closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use iva_core::{
    absorber::{Absorber, Start},
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    piva::{Parameters, Piva},
    run::{run, states},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
    steady::{Regime, Steady, SteadyWanted, Window},
    theory::{SymmetricScene, masri_caughey},
};
use iva_tests::driven::mass;

fn watch(siva: &Siva<DrivenHost>, start: &Start, duration: f64, from: f64) -> Steady {
    let cycle = siva.force().unwrap().harmonics().first().copied();
    let mut steady = Steady::new(Window { from, cycle }, SteadyWanted::ALL);
    let limits = Limits::new(duration, siva.clearance());
    let tally = simulate(siva, start, &limits, None, &mut steady).unwrap();
    assert_eq!(tally.outcome, Outcome::Finished);
    steady
}

fn start(displacement: f64, velocity: f64) -> Start {
    Start { displacement, velocity, gap_velocity: -velocity, ..Start::default() }
}

/// A window of a decay has an amplitude and a mean square too: those of samples of it, by Simpson's rule, which err by less
/// than the fourth power of their distance. Flights, coasts and stick episodes.
#[test]
fn decays_have_amplitudes_too() {
    fn check<S: Absorber<Real = f64>>(system: &S, start: &S::Start, from: f64) {
        let (duration, count) = (from + 12.0, 24_000);
        let wanted = SteadyWanted { amplitude: true, rms: true, ..SteadyWanted::default() };
        let mut steady = Steady::new(Window { from, cycle: None }, wanted);
        let limits = Limits::new(duration, system.clearance());
        simulate(system, start, &limits, None, &mut steady).unwrap();
        let step = 12.0 / f64::from(count);
        let times: Vec<f64> =
            (0..=count).map(|k| (from + step * f64::from(k)).min(duration)).collect();
        let sampled = states(system, start, &limits, &times).unwrap();
        let x: Vec<f64> = sampled.iter().map(|state| state.displacement).collect();
        let most = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let weight = |k: usize| [2.0, 4.0][k % 2] - f64::from(u8::from(k == 0));
        let sum: f64 = x.iter().enumerate().map(|(k, x)| weight(k) * x * x).sum();
        let last = x[x.len() - 1];
        let rms = ((sum - last * last) / (3.0 * f64::from(count))).sqrt();
        let found = steady.values();
        let [largest, mean] = [found.amplitude_max, found.amplitude_rms].map(Option::unwrap);
        assert!(largest >= most && largest < most + 1e-6, "{from}: {largest} {most}");
        // Where an impact bends x, Simpson's rule errs by the square of the step.
        assert!((mean - rms).abs() < 1e-6, "{from}: {mean} {rms}");
    }
    let begin = Start { displacement: 1.0, ..Start::default() };
    for from in [0.0, 7.3, 40.0] {
        for d in [0.1, 0.6, 30.0] {
            check(&Siva::new(0.15, 0.4, d, 0.01).unwrap(), &begin, from);
            let bob = Parameters::point_bob(0.15, 0.4, d, 0.01, 40.0);
            let piva = Piva::new(Parameters { frequency_ratio: 0.1, ..bob }).unwrap();
            check(&piva, &begin.into(), from);
        }
    }
}

#[test]
fn without_impacts_it_is_the_oscillators_steady_state() {
    // f/M = F cos(Ωτ + φ): x = Re X e^{i(Ωτ + φ)}, X = F/(1 − Ω² + 2iζΩ). The walls are out of reach.
    let [zeta, amplitude, frequency, phase] = [0.05_f64, 0.3, 0.8, 0.7];
    let (re, im) = (1.0 - frequency * frequency, 2.0 * zeta * frequency);
    let size = amplitude / re.hypot(im);
    let lag = im.atan2(re);
    let x = |time: f64| size * (frequency * time + phase - lag).cos();
    let v = |time: f64| -size * frequency * (frequency * time + phase - lag).sin();
    for acts in [Acts::Primary, Acts::Base] {
        let sign = if acts == Acts::Primary { 1.0 } else { -1.0 };
        let force = Harmonic { amplitude: sign * amplitude, frequency, phase, acts };
        let siva = mass(1e-3, 0.5, 1e6, zeta)(Force::harmonic(vec![force]).unwrap());
        let cycle = TAU / frequency;
        // 20.5 cycles, without the first 3.25.
        let steady = watch(&siva, &start(x(0.0), v(0.0)), 20.5 * cycle, 3.25 * cycle);
        let values = steady.values();
        assert!((values.amplitude_max.unwrap() - size).abs() < 1e-14);
        // The mean of cos² over 17.25 cycles, a quarter cycle more than an integer number of half cycles.
        let (from, to) = (3.25 * cycle, 20.5 * cycle);
        let integral = |time: f64| {
            let angle = frequency * time + phase - lag;
            0.5 * time + (2.0 * angle).sin() / (4.0 * frequency)
        };
        let mean = size * size * (integral(to) - integral(from)) / (to - from);
        assert!((values.amplitude_rms.unwrap() - mean.sqrt()).abs() < 1e-14);
        let (acceleration, base) = if acts == Acts::Primary {
            (size * frequency * frequency, 0.0)
        } else {
            // A = −x − 2ζẋ
            (size * 1f64.hypot(2.0 * zeta * frequency), amplitude)
        };
        assert!((values.acceleration_max.unwrap() - acceleration).abs() < 1e-14);
        assert!((values.base_max.unwrap() - base).abs() < 1e-15);
        assert_eq!(values.impacts_per_cycle, Some(0.0));
        assert_eq!(values.regime, Some(Regime::NoImpacts));
        let strobes: Vec<_> = steady.strobes().collect();
        assert_eq!(strobes[0].cycle, 3, "Ωτ + φ = 2π · 4 is the fourth instant after 0");
        assert_eq!(strobes.len(), 17);
        for strobe in strobes {
            let time = (TAU * (strobe.cycle as f64 + 1.0) - phase) / frequency;
            assert!((strobe.time - time).abs() < 1e-13);
            assert!((strobe.displacement - x(time)).abs() < 1e-13);
            assert!((strobe.velocity - v(time)).abs() < 1e-13);
        }
    }
}

#[test]
fn the_symmetric_orbit_is_two_impacts_a_cycle() {
    // Masri and Caughey 1966: μ .05, e .8, d 2, ζ .02, F .1, Ω 1; largest |x| from the closed form.
    let force = Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let siva = mass(0.05, 0.8, 2.0, 0.02)(Force::harmonic(vec![force]).unwrap());
    let steady = watch(&siva, &start(0.0, 0.0), 700.0 * TAU, 600.0 * TAU);
    let values = steady.values();
    assert!((values.amplitude_max.unwrap() - 0.353_285_319_188_6).abs() < 1e-9);
    assert_eq!(values.regime, Some(Regime::Periodic { impacts: 2, cycles: 1 }));
    assert!((values.impacts_per_cycle.unwrap() - 2.0).abs() < 1e-12);
    let strobes: Vec<_> = steady.strobes().collect();
    // Strobes 600 to 700; the last is at the end of the run.
    assert_eq!(strobes.len(), 101);
    for pair in strobes.windows(2) {
        assert_eq!(pair[1].impacts - pair[0].impacts, 2);
        assert!((pair[1].amplitude - 0.353_285_319_188_6).abs() < 1e-9);
    }
}

#[test]
fn the_counts_of_a_chattering_scene_are_those_of_its_list() {
    // Many chatters and stick episodes a cycle; some of their low rebounds are unlisted later.
    let force = Harmonic { amplitude: 0.8, frequency: 0.35, phase: -1.0, acts: Acts::Base };
    let siva = mass(0.3, 0.3, 0.4, 0.01)(Force::harmonic(vec![force]).unwrap());
    let duration = 60.0 * TAU / 0.35;
    let cycle = Some(force);
    let mut watching = (
        Steady::new(Window { from: 0.0, cycle }, SteadyWanted::ALL),
        iva_core::observe::Events::default(),
    );
    let limits = Limits::new(duration, 0.4);
    let tally = simulate(&siva, &start(0.0, 0.0), &limits, None, &mut watching).unwrap();
    let (steady, events) = watching;
    assert!(tally.episodes > 50, "{}", tally.episodes);
    let strobes: Vec<_> = steady.strobes().collect();
    for strobe in &strobes {
        let listed = events.impacts.iter().filter(|impact| impact.time <= strobe.time).count();
        assert_eq!(strobe.impacts, listed as u64, "cycle {}", strobe.cycle);
    }
    let per_cycle = steady.values().impacts_per_cycle.unwrap();
    assert!((per_cycle - tally.impacts as f64 / 60.0).abs() < 1e-9);
    assert!(matches!(steady.values().regime, Some(Regime::Periodic { impacts: 26, cycles: 1 })));
}

#[test]
fn a_phase_beyond_a_turn_strobes_at_the_same_instants() {
    for turns in [-3.0, 0.0, 2.0] {
        let force = Harmonic {
            amplitude: 0.1,
            frequency: 2.0,
            phase: 0.5 + turns * TAU,
            acts: Acts::Primary,
        };
        let siva = mass(0.1, 0.5, 1.0, 0.1)(Force::harmonic(vec![force]).unwrap());
        let steady = watch(&siva, &start(0.0, 0.0), 10.0, 0.0);
        let first = steady.strobes().next().unwrap();
        assert!((first.time - (PI - 0.25)).abs() < 1e-14, "{turns}: {}", first.time);
        assert_eq!(first.cycle, 0);
    }
}

#[test]
fn a_peak_between_two_others_within_a_step_is_seen() {
    // After an impact on this exact orbit (Masri and Caughey 1966) x has two extrema within a step; the
    // largest |x|, from the closed form, lies inside the step.
    let force = Harmonic {
        amplitude: 0.41294499696887355,
        frequency: 1.8893676707352416,
        phase: 0.0,
        acts: Acts::Primary,
    };
    let scene = SymmetricScene {
        mass_ratio: 0.26144501046633917,
        restitution: 0.6589609523811075,
        clearance: 0.8208158572747248,
        damping_ratio: 0.0916776627071865,
        force,
    };
    let orbit = masri_caughey(&scene).unwrap().branches[0].unwrap();
    let SymmetricScene { mass_ratio, restitution, clearance, damping_ratio, .. } = scene;
    let absorber = mass(mass_ratio, restitution, clearance, damping_ratio);
    let siva = absorber(Force::harmonic(vec![force]).unwrap());
    let start = orbit.at_phase(0.0);
    let duration = 10.0 * TAU / force.frequency;
    let steady = watch(&siva, &start, duration, 0.0);
    assert!((steady.values().amplitude_max.unwrap() - orbit.amplitude).abs() < 1e-12);
    let peaks = run(&siva, &start, &Limits::new(duration, clearance)).unwrap().peaks;
    assert!(peaks.len() > 15);
    for peak in &peaks[1..] {
        assert!((peak.displacement.abs() - orbit.amplitude).abs() < 1e-12, "{peak:?}");
    }
}
