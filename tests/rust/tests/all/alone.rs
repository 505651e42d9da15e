//! The structure without absorber, against closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{OnStructure, Point},
    force::{Acts, Force, Harmonic},
    propagation::Errors,
    real::twofold::Twofold,
    run::{run, states},
    simulate::{Limits, Outcome, simulate},
    steady::{Steady, SteadyWanted, Window},
};
use iva_tests::list::{begun, driven, list};

/// x and ẋ of ẍ + 2ζẋ + x = 0 from (1, 0), for ζ below, at and above 1.
fn decay(zeta: f64, t: f64) -> [f64; 2] {
    let square = 1.0 - zeta * zeta;
    let (c, s) = if square > 0.0 {
        let omega = square.sqrt();
        ((omega * t).cos(), (omega * t).sin() / omega)
    } else if square < 0.0 {
        let rate = (-square).sqrt();
        ((rate * t).cosh(), (rate * t).sinh() / rate)
    } else {
        (1.0, t)
    };
    let fading = (-zeta * t).exp();
    [fading * (c + zeta * s), -fading * s]
}

#[test]
fn a_structure_alone_decays_as_it_must() {
    for zeta in [0.0, 0.01, 0.3, 0.99, 1.0, 1.2] {
        let alone = list(zeta, &[]);
        let limits = Limits::new(40.0, 1.0);
        let start = begun(Point { x: 1.0, v: 0.0 }, &[]);
        let times: Vec<f64> = (0..=400).map(|k| 0.1 * f64::from(k)).collect();
        for state in states(&alone, &start, &limits, &times).unwrap() {
            let [x, v] = decay(zeta, state.time);
            let off = (state.displacement - x).abs().max((state.velocity - v).abs());
            // Allows for the rounding of the formula's arguments.
            assert!(off <= 4e-16 * (1.0 + state.time), "ζ {zeta}, {}: {off:e}", state.time);
            assert_eq!((state.wall, state.angle), (0, None));
        }
        let run = run(&alone, &start, &limits).unwrap();
        let m = run.measures;
        assert_eq!((run.tally.outcome, run.impacts.len()), (Outcome::Finished, 0));
        assert!(m.energy_residual.abs() < 1e-15, "{:e}", m.energy_residual);
        if zeta > 0.0 && zeta < 0.5 {
            assert!((m.damping_ratio_1.unwrap() - zeta).abs() < 1e-14, "{:?}", m.damping_ratio_1);
            assert!((m.damping_ratio_fit.unwrap() - zeta).abs() < 1e-13);
        }
    }
}

/// Without impacts there are none whose errors could be told.
#[test]
fn it_tells_no_errors_of_impacts() {
    let push = Harmonic { amplitude: 0.4, frequency: 0.7, phase: 0.2, acts: Acts::Primary };
    let driven = driven(&list(0.1, &[]), Force::harmonic(vec![push]).unwrap());
    let mut errors = Errors::default();
    let start = begun(Point { x: 0.3, v: 0.2 }, &[]);
    simulate(&driven, &start, &Limits::new(9.0, 1.0), None, &mut errors).unwrap();
    assert_eq!((errors.digits(), errors.condition()), (None, None));
}

#[test]
fn under_a_harmonic_force_it_settles_to_its_response() {
    for (zeta, frequency) in [(0.05, 0.6), (0.05, 1.0), (0.2, 1.7), (1.1, 0.9)] {
        let harmonic = Harmonic { amplitude: 0.4, frequency, phase: 0.7, acts: Acts::Primary };
        let force = Force::harmonic(vec![harmonic]).unwrap();
        let alone = driven(&list(zeta, &[]), force);
        let cycle = TAU / frequency;
        let limits = Limits::new(150.0 * cycle, 1.0);
        let window = Window { from: 140.0 * cycle, cycle: Some(harmonic) };
        let mut steady = Steady::new(window, SteadyWanted { regime: true, ..SteadyWanted::ALL });
        simulate(&alone, &begun(Point { x: 0.0, v: 0.0 }, &[]), &limits, None, &mut steady)
            .unwrap();
        let values = steady.values();
        let truth = harmonic.response(zeta);
        let amplitude = values.amplitude_max.unwrap();
        assert!((amplitude / truth - 1.0).abs() < 1e-13, "{amplitude} {truth}");
        let rms = values.amplitude_rms.unwrap();
        assert!((rms / truth * 2f64.sqrt() - 1.0).abs() < 1e-13, "{rms} {truth}");
        assert_eq!(values.impacts_per_cycle, Some(0.0));
    }
}

/// In numbers of twice the precision the error falls to their rounding.
#[test]
fn a_driven_structure_is_exact_to_rounding() {
    fn end<R: iva_core::real::Real>() -> Point<R> {
        let n = R::from;
        let harmonic = |acts, frequency| Harmonic {
            amplitude: n(0.4),
            frequency: n(frequency),
            phase: n(0.7),
            acts,
        };
        let force =
            Force::harmonic(vec![harmonic(Acts::Primary, 0.8), harmonic(Acts::Base, 2.3)]).unwrap();
        let alone = driven(&list(n(0.03), &[]), force);
        let start = begun(Point { x: n(1.0), v: n(0.0) }, &[]);
        let limits = Limits::new(n(100.0), n(1.0));
        let tally = simulate(&alone, &start, &limits, None, &mut ()).unwrap();
        alone.primary(&tally.state)
    }
    let (plain, exact) = (end::<f64>(), end::<Twofold>());
    let off = [exact.x - plain.x, exact.v - plain.v].map(|it| f64::from(it).abs());
    assert!(off[0].max(off[1]) < 1e-15, "{off:?}");
}
