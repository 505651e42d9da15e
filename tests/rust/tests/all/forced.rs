//! Scenes under force and base motion: reference events, exact periodic answers, work.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use iva_core::{
    force::{Acts, Force, Harmonic},
    piva::{Given, Parameters, Piva, PivaStart},
    run::{run, states},
    simulate::{Limits, Outcome},
    system::Start,
};
use iva_tests::{
    U, UNITS_ALLOWED, case::compound, dd::Dd, reference::forced_scenes, timeline::marks, units,
};
use proptest::prelude::*;

/// Approach speed at or below which the reference leaves impacts out.
const FLOOR: f64 = 1e-9;

#[test]
fn every_forced_reference_event_is_found_and_none_added() {
    for scene in forced_scenes() {
        let piva = Piva::new(scene.parameters).unwrap().under(scene.force.clone());
        let clearance = scene.parameters.clearance;
        let limits = Limits { chatter_floor: FLOOR, ..Limits::new(scene.duration, clearance) };
        let start = Start { displacement: scene.displacement, ..Start::default() };
        let result = run(&piva, &start.into(), &limits).unwrap();
        assert_eq!((result.tally.outcome, result.tally.undecided), (Outcome::Finished, 0));
        let list = marks(&result, FLOOR);
        let found: Vec<_> = list.iter().map(|m| (m.kind, m.wall)).collect();
        let expected: Vec<_> = scene.events.iter().map(|e| (e.kind, e.wall)).collect();
        assert_eq!(found, expected, "{}", scene.name);
        let mut all: Vec<f64> = Vec::new();
        for (mark, event) in list.iter().zip(&scene.events) {
            let error = (Dd::from(mark.time) - event.time).value();
            all.push(units(error, event.condition, event.time.value()));
        }
        all.sort_by(f64::total_cmp);
        let worst = all[all.len() - 1];
        println!("{:22} median {:.2} worst {worst:.2} units", scene.name, all[all.len() / 2]);
        assert!(worst <= UNITS_ALLOWED, "{}: {worst} units", scene.name);
    }
}

fn on_primary(amplitude: f64, frequency: f64, phase: f64) -> Harmonic {
    Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
}

/// A symmetric motion with two impacts a cycle (Masri and Caughey 1966), at the impact on wall +.
struct Orbit {
    parameters: Parameters,
    force: Harmonic,
    /// Just before the impact.
    start: Start,
    half_period: f64,
}

/// μ, e, d, ζ, F, Ω, then s, x, ẋ before the impact and the phase a of F sin(Ωτ + a), all from the
/// closed form (evaluated with 40 digits).
fn orbit([mu, e, d, zeta, amplitude, frequency]: [f64; 6], [s, x, v, a]: [f64; 4]) -> Orbit {
    // The absorber moves with s between walls: before the impact on + its velocity is +s.
    Orbit {
        parameters: Parameters::free_mass(mu, e, d, zeta),
        force: on_primary(amplitude, frequency, a - 0.5 * PI),
        start: Start { displacement: x, velocity: v, gap_displacement: d, gap_velocity: s - v },
        half_period: PI / frequency,
    }
}

#[test]
fn the_stable_orbit_is_kept_for_ten_thousand_cycles() {
    let orbit = orbit(
        [0.05, 0.8, 2.0, 0.02, 0.1, 1.0],
        [1.452072978709073, 0.2809109011943361, -0.2420121631181788, 4.59047988735129],
    );
    let piva =
        Piva::new(orbit.parameters).unwrap().under(Force::harmonic(vec![orbit.force]).unwrap());
    let cycles = 10_000;
    let limits = Limits::new((f64::from(cycles) + 0.25) * TAU, 2.0);
    let result = run(&piva, &orbit.start.into(), &limits).unwrap();
    assert_eq!(result.tally.outcome, Outcome::Finished);
    assert_eq!(result.impacts.len(), 2 * cycles as usize + 1);
    let late = |(k, impact): (usize, &iva_core::impact::Impact)| {
        (impact.time - k as f64 * orbit.half_period).abs()
    };
    let worst = result.impacts.iter().enumerate().map(late).fold(0.0, f64::max);
    println!("kept within {worst:e}");
    assert!(worst < 1e-9, "{worst:e}");
    let m = &result.measures;
    assert!(m.energy_residual.abs() < 1e-10 * m.energy_work.abs(), "{:e}", m.energy_residual);
}

#[test]
fn from_rest_it_locks_to_the_stable_orbit() {
    let piva = Piva::new(Parameters::free_mass(0.05, 0.8, 2.0, 0.02))
        .unwrap()
        .under(Force::harmonic(vec![on_primary(0.1, 1.0, 0.0)]).unwrap());
    let result = run(&piva, &Start::default().into(), &Limits::new(600.0 * TAU, 2.0)).unwrap();
    let [.., last] = result.impacts.as_slice() else { panic!("no impacts") };
    let count = result.impacts.iter().filter(|i| i.time > last.time - 10.25 * TAU).count();
    assert_eq!(count, 21, "two impacts a cycle, both ends of ten cycles");
    let tail = result.peaks.iter().rev().skip(1).take(40);
    let highest = tail.map(|peak| peak.displacement.abs()).fold(0.0, f64::max);
    // The closed form's largest |x| between impacts.
    assert!((highest - 0.353_285_319_188_6).abs() < 1e-9, "{highest}");
}

#[test]
fn an_undamped_resonance_grows_with_time() {
    // x = (F/2) τ sin τ from rest, the secular term; the gap is out of reach.
    let piva = Piva::new(Parameters::free_mass(0.1, 0.5, 1e6, 0.0))
        .unwrap()
        .under(Force::harmonic(vec![on_primary(0.1, 1.0, 0.0)]).unwrap());
    let times = [1.0, 10.0, 100.0, 1e3, 1e4];
    let found = states(&piva, &Start::default().into(), &Limits::new(1e4, 1e6), &times).unwrap();
    for state in found {
        let truth = 0.05 * state.time * state.time.sin();
        // An error of the frequency of one rounding unit would be off by τ² of them.
        let allowed = 64.0 * U * 0.05 * state.time * state.time.sqrt().max(1.0);
        assert!((state.displacement - truth).abs() < allowed, "{state:?} {truth}");
    }
}

#[test]
fn the_unstable_orbit_is_left_at_the_rate_of_its_multiplier() {
    let orbit = orbit(
        [0.1, 0.6, 1.0, 0.01, 0.2, 1.0],
        [1.490992427985109, 1.342045429158013, -0.5591221604944157, 4.572987560392349],
    );
    let piva =
        Piva::new(orbit.parameters).unwrap().under(Force::harmonic(vec![orbit.force]).unwrap());
    let result = run(&piva, &orbit.start.into(), &Limits::new(15.0 * TAU, 1.0)).unwrap();
    // Off by what the start was rounded, each half cycle times −2.56749605.
    let off: Vec<f64> = result
        .impacts
        .iter()
        .enumerate()
        .map(|(k, impact)| impact.time - k as f64 * orbit.half_period)
        .collect();
    let grown: Vec<f64> = off
        .windows(2)
        .filter(|pair| (1e-10..1e-5).contains(&pair[0].abs()))
        .map(|pair| pair[1] / pair[0])
        .collect();
    assert!(grown.len() > 5, "{off:?}");
    for rate in &grown[grown.len() - 4..] {
        assert!((rate / -2.567_496_05 - 1.0).abs() < 0.01, "{grown:?}");
    }
}

proptest! {
    #![proptest_config(iva_tests::cases(300))]

    /// Seen from outside, a moving base is a force x_g + 2ζ ẋ_g on the primary, and the absorber feels
    /// nothing: with x_g = −(a/Ω²) cos(Ωτ + φ) the same impacts at the same times.
    #[test]
    fn a_moving_base_is_a_force_in_the_inertial_frame(
        p in compound(),
        free_mass in any::<bool>(),
        clearance in 0.2..1.5f64,
        amplitude in 0.05..0.5f64,
        frequency in 0.3..2.0f64,
        phase in -3.0..3.0f64,
        x in -1.0..1.0f64,
    ) {
        let p = if free_mass {
            Parameters::free_mass(p.mass_ratio, p.restitution, clearance, p.damping_ratio)
        } else {
            Parameters { clearance, ..p }
        };
        let base = Harmonic { amplitude, frequency, phase, acts: Acts::Base };
        let moved = -amplitude / (frequency * frequency);
        let seen = [
            on_primary(moved, frequency, phase),
            on_primary(-2.0 * p.damping_ratio * moved * frequency, frequency, phase - 0.5 * PI),
        ];
        let relative = Start { displacement: x, ..Start::default() };
        let outside = Start {
            displacement: x + moved * phase.cos(),
            velocity: -moved * frequency * phase.sin(),
            ..relative
        };
        let limits = Limits::new(12.0, clearance);
        let scene = |harmonics: Vec<Harmonic>, start: Start| {
            let piva = Piva::new(p).unwrap().under(Force::harmonic(harmonics).unwrap());
            run(&piva, &start.into(), &limits).unwrap()
        };
        let (one, other) = (scene(vec![base], relative), scene(seen.to_vec(), outside));
        // Rounding of the inputs, some ulp of 1 + a/Ω², grows by a factor of a few at each impact.
        let mut allowed = 64.0 * U * (1.0 + moved.abs());
        for (a, b) in one.impacts.iter().zip(&other.impacts) {
            allowed *= 4.0 / (a.approach_speed() / (0.3 + a.approach_speed()));
            if allowed > 1e-7 { break; }
            prop_assert_eq!(a.wall, b.wall);
            prop_assert!((a.time - b.time).abs() <= allowed, "{} {}", a.time, b.time);
        }
        let m = &one.measures;
        let size = m.energy_initial + m.energy_work.abs() + one.tally.energy_impacts + m.energy_viscous;
        prop_assert!(m.energy_residual.abs() <= 1e-11 * size, "{:e}", m.energy_residual / size);
    }

    /// A mirrored scene, and one whose phase is a turn further, are the same to the bit and to rounding.
    #[test]
    fn mirror_and_phase_change_nothing(
        p in compound(),
        clearance in 0.2..1.5f64,
        amplitude in 0.05..0.5f64,
        frequency in 0.3..2.0f64,
        phase in -3.0..0.0f64,
        x in 0.1..1.0f64,
    ) {
        let p = Parameters { clearance, ..p };
        let limits = Limits::new(20.0, clearance);
        let scene = |amplitude: f64, phase: f64, x: f64| {
            let force = Force::harmonic(vec![on_primary(amplitude, frequency, phase)]).unwrap();
            let start = PivaStart {
                displacement: x,
                velocity: 0.0,
                place: Given::Gap(0.0),
                rate: Given::Gap(0.0),
            };
            run(&Piva::new(p).unwrap().under(force), &start, &limits).unwrap()
        };
        let (one, mirrored) = (scene(amplitude, phase, x), scene(-amplitude, phase, -x));
        prop_assert_eq!(one.impacts.len(), mirrored.impacts.len());
        for (a, b) in one.impacts.iter().zip(&mirrored.impacts) {
            prop_assert_eq!(a.time.to_bits(), b.time.to_bits());
            prop_assert_eq!(a.wall.sign(), -b.wall.sign());
        }
        let turned = scene(amplitude, phase + TAU, x);
        if let (Some(a), Some(b)) = (one.impacts.first(), turned.impacts.first()) {
            let allowed = 64.0 * U * (1.0 + 1.0 / a.approach_speed());
            prop_assert!((a.time - b.time).abs() <= allowed, "{} {}", a.time, b.time);
        }
    }
}

#[test]
fn many_sticks_a_cycle_keep_the_ledger_and_look_the_same_from_outside() {
    let (amplitude, frequency, phase) = (0.3, 0.8, 0.4f64);
    let moved = -amplitude / (frequency * frequency);
    for (gravity, clearance, e) in [(0.0, 0.05, 0.1), (0.0, 0.1, 0.3), (0.3, 0.05, 0.2)] {
        let p = Parameters::free_mass(0.1, e, clearance, 0.02);
        let p = Parameters { frequency_ratio: gravity, ..p };
        let scene = |harmonics: Vec<Harmonic>, displacement: f64, velocity: f64| {
            let piva = Piva::new(p).unwrap().under(Force::harmonic(harmonics).unwrap());
            let start = Start { displacement, velocity, ..Start::default() };
            run(&piva, &start.into(), &Limits::new(40.0 * TAU, clearance)).unwrap()
        };
        let base = Harmonic { amplitude, frequency, phase, acts: Acts::Base };
        let one = scene(vec![base], 0.5, 0.0);
        let seen = vec![
            on_primary(moved, frequency, phase),
            on_primary(-2.0 * 0.02 * moved * frequency, frequency, phase - 0.5 * PI),
        ];
        let other = scene(seen, 0.5 + moved * phase.cos(), -moved * frequency * phase.sin());
        assert!(one.tally.episodes > 40, "{}", one.tally.episodes);
        for result in [&one, &other] {
            let m = &result.measures;
            let size = m.energy_initial + m.energy_work.abs() + m.energy_viscous;
            assert!(m.energy_residual.abs() < 1e-11 * size, "{:e}", m.energy_residual / size);
        }
        // Twenty sticks forget where they came from: an error does not grow through them.
        for (a, b) in one.episodes.iter().zip(&other.episodes).take(20) {
            assert_eq!(a.wall, b.wall);
            assert!((a.stick_time - b.stick_time).abs() < 1e-12 * (1.0 + a.stick_time));
            let (Some(a), Some(b)) = (a.release_time, b.release_time) else { continue };
            assert!((a - b).abs() < 1e-12 * (1.0 + a), "{a} {b}");
        }
    }
}
