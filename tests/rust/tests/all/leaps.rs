//! Leaps of masses on modes: flights of known length and matrix, with the proof that they meet no wall.
//!
//! Numbers come from closed forms: a mass that the structure hardly feels, over modes that swing as sines.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    absorber::{Absorber, OnStructure},
    flight::{GapPoint, Motion},
    host::UndrivenHost,
    observe::{Observer, Span},
    run::run,
    simulate::{Limits, simulate},
    siva::FreeMass,
};
use iva_tests::rng::Rng;

type System = Modal<UndrivenHost<f64>, 1>;

/// A mass of 10⁻²⁸ in a gap of clearance d, on undamped modes of these frequencies and shape 1.
fn system(frequencies: &[f64], d: f64) -> System {
    let still = vec![0.0; frequencies.len()];
    let structure = ModalStructure::new(frequencies, &still).unwrap();
    let structure = structure.with_point("p", &vec![1.0; frequencies.len()]).unwrap();
    Modal::new(structure, [(FreeMass::new(1e-28, 0.5, d).unwrap(), "p")]).unwrap()
}

/// The structure swings as sin(τ − φ) under a mass at rest, which comes within δ of its wall, or meets it where sin(τ − φ) = 1 + δ. However
/// the extremum lies in a leap, and however small δ is, the contact is found, or none is.
#[test]
fn an_extremum_within_a_leap_is_decided() {
    let mut rng = Rng::new(20);
    let [mut met, mut missed] = [0, 0];
    for _ in 0..2000 {
        let phase = rng.range(-1.4, 1.4);
        let beyond = rng.log_range(1e-13, 0.2) * if rng.unit() > 0.5 { 1.0 } else { -1.0 };
        let system = system(&[1.0], 1.0 + beyond);
        let (q, v) = ((-phase).sin(), phase.cos());
        if q.abs() > 0.999 + beyond {
            continue;
        }
        // At rest in space at 0: y = x₁ − x.
        let start = ModalStart::new(&[q], &[v], [GapPoint { y: -q, w: -v }]).unwrap();
        // The first extremum comes at φ + π/2, the next one, on the other wall, half a period later.
        let until = phase + std::f64::consts::PI;
        let found = run(&system, &start, &Limits::new(until, 1e-9)).unwrap();
        if beyond > 0.0 {
            assert!(found.impacts.is_empty(), "{phase} {beyond}");
            missed += 1;
            continue;
        }
        let time = (1.0 + beyond).asin() + phase;
        let first = found.impacts.first().unwrap_or_else(|| panic!("{phase} {beyond}"));
        // Near the extremum an error of the distance is one of its root in time.
        let condition = 1.0 / (2.0 * -beyond).sqrt();
        assert!((first.time - time).abs() < 1e-15 * (8.0 + 8.0 * condition), "{phase} {beyond}");
        met += 1;
    }
    println!("{met} met, {missed} missed");
    assert!(met > 600 && missed > 600, "{met} {missed}");
}

/// One of three modes swings through a whole period in the longest leap, begins and ends it at rest on the far side, and comes within δ of
/// the wall, or beyond it, in between. Distances and rates at the ends say nothing of that; only the bound does.
#[test]
fn a_period_within_a_leap_is_seen() {
    let mut rng = Rng::new(21);
    let [mut met, mut missed] = [0, 0];
    for _ in 0..400 {
        let beyond = rng.log_range(1e-10, 0.3) * if rng.unit() > 0.5 { 1.0 } else { -1.0 };
        // The shortest leap takes 1/16, the longest that the slowest mode allows 32 of it, 2.
        let frequency = std::f64::consts::PI * rng.range(0.999, 1.001);
        let structure = ModalStructure::new(&[0.5, frequency, 16.0], &[0.0; 3]).unwrap();
        let structure = structure.with_point("p", &[1.0; 3]).unwrap();
        // Walls at −1 − δ and at 2; the mass rests in space, y = cos(ω τ).
        let mass = FreeMass::new(1e-28, 0.5, (3.0 + beyond) / 2.0).unwrap();
        let mass = mass.with_offset((1.0 - beyond) / 2.0).unwrap();
        let system: System = Modal::new(structure, [(mass, "p")]).unwrap();
        let gap = [GapPoint { y: 1.0, w: 0.0 }];
        let start = ModalStart::new(&[0.0, -1.0, 0.0], &[], gap).unwrap();
        let found = run(&system, &start, &Limits::new(2.5, 1e-9)).unwrap();
        if beyond > 0.0 {
            assert!(found.impacts.is_empty(), "{beyond}");
            missed += 1;
            continue;
        }
        let time = (-1.0 - beyond).acos() / frequency;
        let first = found.impacts.first().unwrap_or_else(|| panic!("{beyond}"));
        let condition = 1.0 / (2.0 * -beyond).sqrt();
        assert!((first.time - time).abs() < 1e-15 * (8.0 + 8.0 * condition), "{beyond}");
        met += 1;
    }
    println!("{met} met, {missed} missed");
    assert!(met > 100 && missed > 100, "{met} {missed}");
}

/// Adds up what it is shown of coasts, and how far it is off the sines.
#[derive(Debug)]
struct Shown<'a> {
    frequencies: &'a [f64],
    spans: usize,
    shown: f64,
    off: f64,
}

impl Observer<System> for Shown<'_> {
    fn span<M: Motion<Real = f64, State = <System as OnStructure>::State>>(
        &mut self,
        _system: &System,
        span: &Span<'_, M>,
    ) {
        self.spans += 1;
        self.shown += span.length;
        let end = span.start.value + span.length;
        let sines = self.frequencies.iter().map(|w| (w * end).sin() / w);
        let x: f64 = sines.sum();
        self.off = self.off.max((span.to.x - x).abs());
    }
}

/// A mass that no wall is near coasts; an observer is shown every step of it, one after the other, and all of them follow the sines.
#[test]
fn every_step_of_a_coast_is_shown() {
    let (frequencies, duration) = ([1.0, 2.7, 9.1], 200.0);
    let system = system(&frequencies, 50.0);
    let start = ModalStart::new(&[0.0; 3], &[1.0; 3], [GapPoint { y: 0.0, w: -3.0 }]).unwrap();
    let begun = system.begin(&start);
    let (steps, (_, time)) = system.coasts(&begun, duration).expect("a coast");
    assert!(steps > 1 && time.value > 1.0, "{steps} {time:?}");
    let mut shown = Shown { frequencies: &frequencies, spans: 0, shown: 0.0, off: 0.0 };
    let tally = simulate(&system, &start, &Limits::new(duration, 1e-9), None, &mut shown).unwrap();
    assert_eq!(tally.impacts, 0);
    assert!((shown.shown - duration).abs() < 1e-11, "{shown:?}");
    assert!(shown.spans > 400, "{shown:?}");
    assert!(shown.off < 1e-12, "{shown:?}");
}
