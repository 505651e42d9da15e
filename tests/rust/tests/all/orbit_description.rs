//! Events, extremes, multipliers with errors and the exact identity of periodic orbits: those of the 50-digit references, and
//! closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    force::{Acts, Force, Harmonic},
    orbit::{
        Coordinates, Cycle, Trajectory,
        description::{Description, describe},
        periodic::{Orbit, find},
        spectrum::{Spectrum, spectrum},
    },
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    siva::Siva,
    theory::{SymmetricScene, masri_caughey},
};
use iva_tests::rng::Rng;
use nalgebra::Complex;
use serde_json::Value;

use crate::periodic::{complex, cycle, mass, number, records, swinging, trajectory, truth};

fn described<S: Coordinates + Clone>(orbit: &Orbit<S>) -> (Description, Spectrum) {
    let description = describe(orbit, None).unwrap();
    let spectrum = spectrum(orbit, &description, None).unwrap();
    (description, spectrum)
}

/// The largest true error of a multiplier over its bound; each is compared with a true one of its own.
fn over_bound(found: &[Complex<f64>], errors: &[f64], truth: &Value) -> f64 {
    let mut left = complex(truth);
    let mut worst = 0.0f64;
    for (found, error) in found.iter().zip(errors) {
        let apart = |it: &Complex<f64>| (it - found).norm();
        let nearest = (0..left.len()).min_by(|a, b| apart(&left[*a]).total_cmp(&apart(&left[*b])));
        let off = apart(&left.swap_remove(nearest.unwrap()));
        assert!(off <= 1e-13, "{found} {off:e}");
        worst = worst.max(if off == 0.0 { 0.0 } else { off / error });
    }
    worst
}

/// Checks all multipliers against a record; the largest error over its bound, and the largest bound.
fn judge(name: &str, spectrum: &Spectrum, record: &Value) -> [f64; 2] {
    let mut worst = over_bound(&spectrum.multipliers, &spectrum.errors, &record["multipliers"]);
    let mut largest = spectrum.errors.iter().copied().fold(0.0, f64::max);
    if let Some((half, errors)) = &spectrum.half {
        worst = worst.max(over_bound(half, errors, &record["half_map_multipliers"]));
        largest = errors.iter().copied().fold(largest, f64::max);
    }
    assert!(worst <= 1.0, "{name}: {worst}");
    [worst, largest]
}

#[test]
fn the_reference_orbits_are_described() {
    let mut rng = Rng::new(61);
    for record in records(include_str!("../../../reference/orbits.json")) {
        let name = record["id"].as_str().unwrap();
        let cycle = cycle(&record, 0.0);
        let mut worst = [0.0f64; 2];
        for symmetric in [false, true] {
            if symmetric && record["symmetric"] == false {
                continue;
            }
            for _ in 0..5 {
                let near = truth(&record).map(|z| z + rng.range(-1e-3, 1e-3));
                let orbit =
                    find(&trajectory(mass(&record), &near, cycle), symmetric, None).unwrap();
                let (description, spectrum) = described(&orbit);
                let description = description.seen_from(0.0, cycle.length);
                let [share, bound] = judge(name, &spectrum, &record);
                worst = [worst[0].max(share), worst[1].max(bound)];
                let listed = record["impact_list"].as_array().unwrap();
                let impacts: Vec<_> = description
                    .impacts
                    .iter()
                    .filter(|it| record["episodes"].is_null() || it.approach_speed() > 1e-3)
                    .collect();
                assert_eq!(impacts.len(), listed.len(), "{name}");
                for (impact, truth) in impacts.iter().zip(listed) {
                    assert_eq!(i64::from(impact.wall.number()), truth[1].as_i64().unwrap());
                    assert!((impact.time - number(&truth[0])).abs() < 1e-12, "{name}");
                    assert!(
                        (impact.gap_velocity_before - number(&truth[2])).abs() < 1e-12,
                        "{name}"
                    );
                }
                let speeds = description.approach_speeds;
                if let Some(episodes) = record["episodes"].as_array() {
                    assert_eq!(description.walls(cycle.length), "(+)(-)");
                    assert_eq!((spectrum.rank, spectrum.determinant_error), (2, None));
                    assert!(speeds[0].is_none() && speeds[1].is_some());
                    assert_eq!(spectrum.multipliers[2].norm() + spectrum.errors[3], 0.0);
                    for (found, truth) in description.episodes.iter().zip(episodes) {
                        assert!((found.stick_time - number(&truth[0])).abs() < 1e-12);
                        let release = found.release_time.unwrap();
                        assert!((release - number(&truth[1])).abs() < 1e-12, "{name}");
                    }
                    continue;
                }
                assert_eq!(description.walls(cycle.length), record["walls"].as_str().unwrap());
                let truths = listed.iter().map(|it| number(&it[2]).abs());
                assert!((speeds[0].unwrap() - truths.clone().fold(9.0, f64::min)).abs() < 1e-12);
                assert!((speeds[1].unwrap() - truths.fold(0.0, f64::max)).abs() < 1e-12);
                let amplitude = number(&record["amplitude"]);
                assert!((description.amplitude.unwrap() - amplitude).abs() < 1e-12, "{name}");
                let margin = record["margin"].as_str().map(|it| it.parse::<f64>().unwrap());
                match (margin, description.grazing_margin) {
                    (Some(truth), Some(found)) => {
                        assert!((found - truth).abs() < 2e-6, "{name} {found}")
                    }
                    (truth, found) => assert_eq!(truth, found, "{name}"),
                }
                let off = spectrum.determinant_error.unwrap();
                assert!(off.abs() < 1e-14 && spectrum.rank == 4, "{name}: {off:e}");
            }
        }
        println!("{name}: error / bound {:.3}, bound {:.1e}", worst[0], worst[1]);
    }
}

#[test]
fn the_reference_orbits_of_pendulums_are_described() {
    let mut rng = Rng::new(62);
    for record in records(include_str!("../../../reference/orbits_piva.json")) {
        let name = record["id"].as_str().unwrap();
        let mut worst = [0.0f64; 2];
        for symmetric in [false, true] {
            if symmetric && record["symmetric"] == false {
                continue;
            }
            for _ in 0..5 {
                let begun = swinging(&record, || rng.range(-1e-3, 1e-3));
                let orbit = find(&begun, symmetric, None).unwrap();
                let (_, spectrum) = described(&orbit);
                let [share, bound] = judge(name, &spectrum, &record);
                worst = [worst[0].max(share), worst[1].max(bound)];
                let off = spectrum.determinant_error.unwrap();
                assert!(off.abs() < 1e-14, "{name}: {off:e}");
            }
        }
        println!("{name}: error / bound {:.3}, bound {:.1e}", worst[0], worst[1]);
    }
}

/// Half multipliers of S. F. Masri and T. K. Caughey (J. Appl. Mech. 33, 1966) in closed form: their errors are below the
/// bounds, and the bounds are of some use.
#[test]
fn errors_of_multipliers_hold_for_the_closed_form() {
    let mut rng = Rng::new(63);
    let (mut count, mut worst, mut bounds) = (0, 0.0f64, Vec::new());
    for _ in 0..200 {
        let [mass_ratio, restitution] = [rng.range(0.02, 0.3), rng.range(0.3, 0.9)];
        let [clearance, damping_ratio] = [rng.range(0.3, 4.0), rng.range(0.005, 0.1)];
        let (amplitude, frequency) = (1.0, rng.range(0.7, 1.4));
        let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
        let scene =
            SymmetricScene { mass_ratio, restitution, clearance, damping_ratio, force: harmonic };
        for known in masri_caughey(&scene).unwrap().branches.into_iter().flatten() {
            if !known.admissible || known.approach_speed < 0.05 {
                continue;
            }
            let siva = Siva::new(mass_ratio, restitution, clearance, damping_ratio).unwrap();
            let force = Force::harmonic(vec![Harmonic { phase: known.phase, ..harmonic }]).unwrap();
            let cycle = Cycle { begin: 0.0, length: TAU / frequency };
            let begun = Trajectory::new(siva.under(force), &known.start, cycle).unwrap();
            let orbit = find(&begun, true, None).unwrap();
            let (description, spectrum) = described(&orbit);
            let (half, errors) = spectrum.half.unwrap();
            for truth in &known.multipliers {
                let pairs =
                    half.iter().zip(&errors).map(|(it, error)| ((it - truth).norm(), error));
                let (off, error) = pairs.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
                // The closed form has rounding errors of its own.
                worst = worst.max((off - 4e-16) / error);
            }
            let off = spectrum.determinant_error.unwrap();
            assert!(off.abs() < 1e-13 * (1.0 + half[0].norm_sqr().powi(2)), "{off:e}");
            assert!((description.amplitude.unwrap() - known.amplitude).abs() < 1e-11);
            bounds.push(errors[0] / (1.0 + half[0].norm()));
            count += 1;
        }
    }
    bounds.sort_by(f64::total_cmp);
    let median = bounds[count / 2];
    println!(
        "{count} orbits, worst {worst}, median bound {median:e}, largest {:e}",
        bounds[count - 1]
    );
    assert!(count > 100 && worst < 1.0 && median < 1e-12, "{count} {worst} {median:e}");
}

/// Unlike walls, a compound pendulum with a damped pivot, and an elastic one: the product of the multipliers is that of the
/// exact identity.
#[test]
fn the_product_of_multipliers_obeys_its_identity() {
    let drive = |frequency| {
        Force::harmonic(vec![Harmonic { amplitude: 1.0, frequency, phase: 0.0, acts: Acts::Base }])
            .unwrap()
    };
    let mut rng = Rng::new(64);
    let mut found = [0; 2];
    for _ in 0..60 {
        let frequency = rng.range(0.8, 1.2);
        let cycle = Cycle { begin: 0.0, length: TAU / frequency };
        let siva = Siva::new(0.15, 0.6, 2.0, 0.04).unwrap().with_restitution_minus(0.4).unwrap();
        let siva = siva.with_offset(0.3).unwrap().under(drive(frequency));
        let start =
            iva_core::absorber::Start { velocity: rng.range(0.0, 3.0), ..Default::default() };
        let begun = Trajectory::new(siva, &start, cycle).unwrap();
        if let Ok(orbit) = find(&begun, false, None) {
            let off = described(&orbit).1.determinant_error;
            assert!(off.is_none_or(|off| off.abs() < 1e-12), "{off:?}");
            found[0] += usize::from(off.is_some());
        }
        let parameters = Parameters {
            frequency_ratio: 1.05,
            angles: Angles::Large,
            inertia_ratio: 1.3,
            contact_distance: 6.0,
            pivot_damping_ratio: 0.03,
            ..Parameters::point_bob(0.2, 0.6, 1.6, 0.05, 5.0)
        };
        let piva = Piva::new(parameters).unwrap().under(drive(frequency));
        let start = PivaStart {
            displacement: 0.0,
            velocity: rng.range(0.0, 3.0),
            place: Given::Gap(0.0),
            rate: Given::Angle(rng.range(-0.5, 0.5)),
        };
        let begun = Trajectory::new(piva, &start, cycle).unwrap();
        if let Ok(orbit) = find(&begun, false, None) {
            let off = described(&orbit).1.determinant_error;
            assert!(off.is_none_or(|off| off.abs() < 1e-12), "{off:?}");
            found[1] += usize::from(off.is_some());
        }
    }
    println!("{found:?}");
    assert!(found[0] > 10 && found[1] > 10, "{found:?}");
}
