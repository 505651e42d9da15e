//! Structures at the borders of what a mode can be: free to move, of two equal frequencies, damped critically or more.
//!
//! Numbers come from closed forms: two bodies in free space that collide; the two modes of one frequency as one mode, whose shape is the
//! root of the sum of the squares; and sums of exponentials.
#![allow(clippy::unwrap_used)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure, Tie},
    flight::GapPoint,
    host::UndrivenHost,
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::rng::Rng;

fn system(
    frequencies: &[f64],
    damping_ratios: &[f64],
    shape: &[f64],
    [mu, e, d]: [f64; 3],
) -> Modal<UndrivenHost, 1> {
    let structure = ModalStructure::new(frequencies, damping_ratios).unwrap();
    let structure = structure.with_point("p", shape).unwrap();
    Modal::new(structure, [(FreeMass::new(mu, e, d).unwrap(), "p")]).unwrap()
}

fn start(q: &[f64], v: &[f64], y: f64, w: f64) -> ModalStart<f64, 1> {
    ModalStart::new(q, v, [GapPoint { y, w }]).unwrap()
}

/// At a node of all modes but that of frequency 0 the structure is a body of mass 1/φ² in free space: each impact turns the gap velocity round
/// with the factor −e, momentum stays, and the next wall is 2d away. With a spring between both the gap swings with the reduced mass.
#[test]
fn a_structure_that_is_free_to_move_is_a_body_in_space() {
    let mut rng = Rng::new(131);
    for _ in 0..100 {
        let (phi, mu) = (rng.log_range(0.3, 3.0), rng.log_range(1e-3, 10.0));
        let [e, d] = [rng.range(0.3, 0.95), rng.log_range(0.1, 10.0)];
        let [v, w] = [rng.range(-1.0, 1.0), rng.sign() * rng.range(0.2, 1.0)];
        let zeta = rng.range(0.0, 0.1);
        let free = system(&[1.0, 0.0], &[zeta, 0.0], &[0.0, phi], [mu, e, d]);
        let begin = start(&[0.3, 0.0], &[0.0, v / phi], 0.0, w);
        let duration = 12.0 * d / w.abs();
        let found = run(&free, &begin, &Limits::new(duration, d)).unwrap();
        assert_eq!(found.tally.outcome, Outcome::Finished);
        let momentum = v / (phi * phi) + mu * (v + w);
        let (mut time, mut gap) = (d / w.abs(), w);
        let mut count = 0;
        for impact in found.impacts.iter().take(5) {
            assert!((impact.time / time - 1.0).abs() < 1e-13, "{} {time}", impact.time);
            let before = (momentum - mu * gap) / (1.0 / (phi * phi) + mu);
            assert!((impact.velocity_before - before).abs() < 1e-13, "{impact:?} {before}");
            assert!((impact.gap_velocity_before / gap - 1.0).abs() < 1e-13, "{impact:?} {gap}");
            gap *= -e;
            time += 2.0 * d / gap.abs();
            count += 1;
        }
        assert!(count > 1, "{count}");
        let tie = Tie { spring: rng.log_range(0.1, 4.0), damping: 0.0 };
        let tied = free.with_ties(&[tie]).unwrap();
        // y = (w/ω) sin ω t, ω² = k (1/μ + φ²): the wall is met if w/ω > d.
        let omega = (tie.spring * (1.0 / mu + phi * phi)).sqrt();
        let share = d * omega / w.abs();
        let found = run(&tied, &begin, &Limits::new(40.0 / omega, d)).unwrap();
        if share < 0.999 {
            let time = share.asin() / omega;
            let steep = 1.0 / (1.0 - share * share);
            let off = (found.impacts[0].time - time).abs() * omega;
            assert!(off < 2e-14 * steep, "{off:e} {share}");
        } else if share > 1.001 {
            assert!(found.impacts.is_empty());
            let y = tied.gaps(&found.tally.state)[0].y;
            assert!((y - w / omega * f64::sin(40.0)).abs() < 1e-12 * d, "{y}");
        }
    }
}

/// Two modes of one frequency and damping, of which only the direction along the shape is ever pushed, are one mode.
#[test]
fn two_equal_frequencies_are_one_mode() {
    let mut rng = Rng::new(132);
    let mut impacts = 0;
    for _ in 0..40 {
        let [a, b] = [rng.range(0.2, 1.0), rng.range(-1.0, 1.0)];
        let whole = f64::hypot(a, b);
        let zeta = rng.range(0.0, 0.1);
        let mass = [rng.log_range(0.02, 0.3), rng.range(0.3, 0.9), rng.range(0.2, 0.8)];
        let one = system(&[1.0], &[zeta], &[whole], mass);
        let two = system(&[1.0; 2], &[zeta; 2], &[a, b], mass);
        let x = 1.0 / whole;
        let limits = Limits::new(15.0, 0.3);
        let found = run(&one, &start(&[x], &[], 0.0, 0.0), &limits).unwrap();
        let other = [x * a / whole, x * b / whole];
        let other = run(&two, &start(&other, &[], 0.0, 0.0), &limits).unwrap();
        for (a, b) in found.impacts.iter().zip(&other.impacts).take(8) {
            assert!((a.time - b.time).abs() < 1e-11, "{} {}", a.time, b.time);
            assert!((a.velocity_after - b.velocity_after).abs() < 1e-11, "{a:?} {b:?}");
            impacts += 1;
        }
    }
    assert!(impacts > 150, "{impacts}");
}

/// The first contact over a structure that creeps back: x = (1 + t) exp(−t) of critical damping, a difference of exponentials beyond it,
/// also with a frequency so high that its fast part is over at once.
#[test]
fn a_creeping_structure_meets_its_mass_in_closed_form() {
    for zeta in [1.0, 1.0 + 1e-9, 1.3, 5.0, 40.0] {
        for omega in [1.0, 7.0] {
            let d = 0.6;
            let system = system(&[omega], &[zeta], &[1.0], [1e-28, 0.5, d]);
            let found = run(&system, &start(&[1.0], &[0.0], 0.0, 0.0), &Limits::new(400.0, 1e-9));
            let x = |t: f64| {
                let root = omega * f64::sqrt(zeta * zeta - 1.0);
                let half = (root * t).min(300.0);
                // exp(−ζωt) (cosh rt + ζω sinh rt/r), with r → 0 at critical damping.
                let shc =
                    if half < 1e-3 { t * (1.0 + half * half / 6.0) } else { half.sinh() / root };
                if half > 250.0 {
                    let slow = omega / (zeta + f64::sqrt(zeta * zeta - 1.0));
                    return 0.5 * (1.0 + zeta * omega / root) * (-slow * t).exp();
                }
                (-zeta * omega * t).exp() * (half.cosh() + zeta * omega * shc)
            };
            let (mut from, mut to) = (0.0, 400.0);
            for _ in 0..100 {
                let middle = 0.5 * (from + to);
                if x(middle) > 1.0 - d { from = middle } else { to = middle }
            }
            let impact = &found.unwrap().impacts[0];
            let off = (impact.time / to - 1.0).abs();
            assert!(off < 2e-13, "{zeta} {omega}: {} {to} {off:e}", impact.time);
        }
    }
}
