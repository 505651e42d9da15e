//! Periodic orbits by Newton's method: those of the 50-digit references, from starts nearby and from settled runs, with their
//! multipliers; the closed form of Masri and Caughey; and what is no orbit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};

use iva_core::{
    absorber::{Clock, Start},
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Cycle, Request, Trajectory, iterate,
        periodic::{Missed, Orbit, find},
    },
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    simulate::{Instant, Limits, Outcome, resume},
    siva::Siva,
    theory::{SymmetricScene, masri_caughey},
};
use iva_tests::rng::Rng;
use nalgebra::{Complex, Vector4};
use serde_json::Value;

pub fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

pub fn force(amplitude: f64, frequency: f64) -> Force {
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary }])
        .unwrap()
}

/// The records of a file, with the number of their scene by name and the cycle from an instant on.
pub fn records(text: &str) -> Vec<Value> {
    serde_json::from_str(text).unwrap()
}

pub fn cycle(record: &Value, begin: f64) -> Cycle {
    let periods = record["forcing_periods"].as_f64().unwrap();
    Cycle { begin, length: periods * TAU / number(&record["scene"]["frequency"]) }
}

pub fn mass(record: &Value) -> Siva<DrivenHost> {
    let key = |name: &str| number(&record["scene"][name]);
    let [mu, e, d, zeta] = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
    let force = force(key("force_amplitude_per_mass"), key("frequency"));
    Siva::new(mu, e, d, zeta).unwrap().under(force)
}

/// x, ẋ, y and ẏ at time 0.
pub fn truth(record: &Value) -> Vector4<f64> {
    let at = |name: &str| number(&record["state_at_time_0"][name]);
    Vector4::new(at("displacement"), at("velocity"), at("gap_displacement"), at("gap_velocity"))
}

/// The trajectory from four numbers on.
pub fn trajectory<S: Coordinates>(system: S, at: &Vector4<f64>, cycle: Cycle) -> Trajectory<S> {
    let start = system.start_at(at).unwrap();
    Trajectory::new(system, &start, cycle).unwrap()
}

/// The coordinates of an orbit at a phase of the drive: at an instant that is not before its section.
pub fn at_instant<S: Coordinates>(orbit: &Orbit<S>, instant: f64) -> Vector4<f64> {
    let Trajectory { system, state, cycle, .. } = &orbit.trajectory;
    let from = Instant { time: Clock::new(cycle.begin), state: *state };
    let limits = Limits::new(instant, system.clearance());
    let tally = resume(system, &from, &limits, None, &mut ()).unwrap();
    system.coordinates(&tally.state)
}

pub fn complex(values: &Value) -> Vec<Complex<f64>> {
    let one = |pair: &Value| Complex::new(number(&pair[0]), number(&pair[1]));
    values.as_array().unwrap().iter().map(one).collect()
}

/// The largest distance of a multiplier from a true one of its own: their order is that of their sizes, which may be equal.
fn off(found: &[Complex<f64>], truth: &Value) -> f64 {
    let mut left = complex(truth);
    let mut worst = 0.0f64;
    for found in found {
        let apart = |it: &Complex<f64>| (it - found).norm();
        let nearest = (0..left.len()).min_by(|a, b| apart(&left[*a]).total_cmp(&apart(&left[*b])));
        worst = worst.max(apart(&left.swap_remove(nearest.unwrap())));
    }
    worst
}

/// Checks multipliers, stability and number of impacts of an orbit.
fn judge<S: Coordinates>(name: &str, orbit: &Orbit<S>, record: &Value) {
    assert_eq!(orbit.is_stable(), record["stable"].as_bool().unwrap(), "{name}");
    let impacts = record["impacts"].as_u64();
    assert!(impacts.is_none_or(|impacts| impacts == orbit.impacts), "{name}: {}", orbit.impacts);
    assert!(orbit.residual <= 50.0 * 0.5 * f64::EPSILON, "{name}: {:e}", orbit.residual);
    let worst = off(&orbit.multipliers, &record["multipliers"]);
    assert!(worst <= 1e-13, "{name}: {worst:e}");
    if let Some(half) = &orbit.half_multipliers {
        let worst = off(half, &record["half_map_multipliers"]);
        assert!(worst <= 1e-13, "{name}, half: {worst:e}");
    }
}

/// The trajectory from just after the impact of a record of a pendulum, off by something in each coordinate.
pub fn swinging(record: &Value, mut off: impl FnMut() -> f64) -> Trajectory<Piva<DrivenHost>> {
    let key = |name: &str| number(&record["scene"][name]);
    let [mu, e, d, zeta] = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
    let small = record["angles"] == "small";
    let length = record["length"].as_f64().unwrap_or(d);
    let parameters = Parameters {
        frequency_ratio: key("frequency_ratio"),
        angles: if small { Angles::Small } else { Angles::Large },
        ..Parameters::point_bob(mu, e, d, zeta, length)
    };
    let driven = force(key("force_amplitude_per_mass"), key("frequency"));
    let piva = Piva::new(parameters).unwrap().under(driven);
    let impact = |name: &str| number(&record["impact"][name]);
    let after = if small { "gap_velocity_after" } else { "angle_velocity_after" };
    let factor = if small { 1.0 } else { length };
    let wall = record["impact"]["wall"].as_f64().unwrap();
    let start = PivaStart {
        displacement: impact("displacement") + off(),
        velocity: impact("velocity_after") + off(),
        place: Given::Gap(wall * (d - off().abs())),
        rate: Given::Angle((factor * impact(after) + off()) / length),
    };
    Trajectory::new(piva, &start, cycle(record, impact("time"))).unwrap()
}

/// From the truth, off by up to 10⁻³ in each coordinate, by the map and, where it is symmetric, by the half map.
#[test]
fn the_reference_orbits_are_found_from_nearby() {
    let mut rng = Rng::new(51);
    let mut worst = 0.0f64;
    for record in records(include_str!("../../../reference/orbits.json")) {
        let name = record["id"].as_str().unwrap();
        let cycle = cycle(&record, 0.0);
        for symmetric in [false, true] {
            if symmetric && record["symmetric"] == false {
                continue;
            }
            for _ in 0..5 {
                let near = truth(&record).map(|z| z + rng.range(-1e-3, 1e-3));
                let begun = trajectory(mass(&record), &near, cycle);
                let orbit = find(&begun, symmetric, None).unwrap_or_else(|missed| {
                    panic!("{name} {symmetric}: {missed:?}");
                });
                judge(name, &orbit, &record);
                let off = (at_instant(&orbit, cycle.length) - truth(&record)).amax();
                worst = worst.max(off);
                assert!(off <= 1e-12, "{name} {symmetric}: {off:e}");
            }
        }
    }
    println!("worst {worst:e}");
}

/// From the state that 300 cycles from rest lead to, where the orbit is what they settle on.
#[test]
fn stable_orbits_are_found_from_a_run() {
    let mut found = 0;
    for record in records(include_str!("../../../reference/orbits.json")) {
        let cycle = cycle(&record, 0.0);
        let from = Vector4::new(0.0, 0.0, 0.0, 0.1);
        let begun = trajectory(mass(&record), &from, cycle);
        let (mut count, mut last) = (0, begun.state);
        iterate(std::slice::from_ref(&begun), Request::default(), &mut |_, image| {
            (count, last) = (count + 1, image.state);
            if count < 300 { Continue(()) } else { Break(()) }
        })
        .unwrap();
        let Ok(orbit) = find(&begun.from(&last), false, None) else { continue };
        // It may be another attractor, or the mirror image.
        let at = at_instant(&orbit, cycle.length);
        if (at - truth(&record)).amax() < 1e-6 {
            judge(record["id"].as_str().unwrap(), &orbit, &record);
            assert!((at - truth(&record)).amax() < 1e-12);
            found += 1;
        }
    }
    assert!(found >= 3, "{found}");
}

/// One impact a cycle, on one wall: a free mass has no such orbit.
#[test]
fn the_reference_orbits_of_pendulums_are_found_from_nearby() {
    let mut rng = Rng::new(52);
    for record in records(include_str!("../../../reference/orbits_piva.json")) {
        let name = record["id"].as_str().unwrap();
        for symmetric in [false, true] {
            if symmetric && record["symmetric"] == false {
                continue;
            }
            for _ in 0..5 {
                let begun = swinging(&record, || rng.range(-1e-3, 1e-3));
                let orbit = find(&begun, symmetric, None).unwrap_or_else(|missed| {
                    panic!("{name} {symmetric}: {missed:?}");
                });
                judge(name, &orbit, &record);
            }
        }
    }
}

/// The motions of S. F. Masri and T. K. Caughey (J. Appl. Mech. 33, 1966) are orbits, with the multipliers of the closed form.
#[test]
fn symmetric_orbits_are_those_of_the_closed_form() {
    let mut rng = Rng::new(54);
    let (mut count, mut worst) = (0, 0.0f64);
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
            assert_eq!((orbit.impacts, orbit.is_stable()), (2, known.stable), "{scene:?}");
            let half = orbit.half_multipliers.unwrap();
            let size = 1.0 + half[0].norm();
            for truth in &known.multipliers {
                let off = half.iter().map(|it| (it - truth).norm()).fold(f64::INFINITY, f64::min);
                worst = worst.max(off / size);
            }
            count += 1;
        }
    }
    println!("{count} orbits, worst {worst:e}");
    assert!(count > 100 && worst < 1e-11, "{count} {worst:e}");
}

#[test]
fn orbits_that_are_no_orbits_are_not_found() {
    // Of a cycle that is not one of the drive, and by the half map where the walls are unlike.
    let record = &records(include_str!("../../../reference/orbits.json"))[0];
    let whole = cycle(record, 0.0);
    let other = Cycle { length: 1.01 * whole.length, ..whole };
    let begun = trajectory(mass(record), &truth(record), other);
    assert!(find(&begun, false, None).is_err());
    let unlike = mass(record).with_restitution_minus(0.5).unwrap();
    let begun = trajectory(unlike, &truth(record), whole);
    let refused = find(&begun, true, None);
    assert!(matches!(refused, Err(Missed::NotPeriodic(_))), "{refused:?}");
    // Without an impact in the cycle.
    let siva = Siva::new(0.1, 0.6, 5.0, 0.05).unwrap().under(force(0.1, 1.3));
    let cycle = Cycle { begin: 0.0, length: TAU / 1.3 };
    let still = Trajectory::new(siva, &Start::default(), cycle).unwrap();
    assert_eq!(find(&still, false, None).err(), Some(Missed::NoImpacts));
    // A free mass that meets one wall only, from many starts.
    let mut rng = Rng::new(53);
    let mut count = [0; 2];
    for _ in 0..300 {
        let d = rng.range(0.2, 3.0);
        let given = [rng.range(0.02, 0.3), rng.range(0.3, 0.95), d, rng.range(0.005, 0.1)];
        let [mu, e, d, zeta] = given;
        let frequency = rng.range(0.6, 1.5);
        let siva = Siva::new(mu, e, d, zeta).unwrap().under(force(1.0, frequency));
        let start = Start {
            displacement: rng.range(-3.0, 3.0),
            velocity: rng.range(-3.0, 3.0),
            gap_displacement: d * rng.range(-1.0, 1.0),
            gap_velocity: rng.range(-2.0, 2.0),
        };
        let cycle = Cycle { begin: 0.0, length: TAU / frequency };
        let begun = Trajectory::new(siva, &start, cycle).unwrap();
        match find(&begun, false, None) {
            Ok(orbit) => {
                assert!(orbit.impacts >= 2, "{given:?} {frequency}: {}", orbit.impacts);
                assert!(orbit.residual < 1e-10);
                count[0] += 1;
            }
            Err(Missed::Cycle(outcome)) => assert_ne!(outcome, Outcome::NotFinite),
            Err(_) => count[1] += 1,
        }
    }
    println!("{count:?}");
    assert!(count[0] > 20, "{count:?}");
}
