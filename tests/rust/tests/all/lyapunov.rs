//! Lyapunov exponents: those of the references, which runs of ten times a million cycles gave in another way; the logarithms of the
//! multipliers on a periodic orbit; the sum, which is known exactly; and what a ride does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Trajectory,
        lyapunov::{Spectrum, Window, carried, lyapunov, spectrum},
        multipliers::multipliers,
        periodic::find,
    },
    simulate::Outcome,
    siva::Siva,
};
use iva_tests::rng::Rng;
use serde_json::Value;

/// A free mass under a harmonic force of amplitude F and frequency Ω: μ, e, d, ζ, F, Ω.
fn mass([mu, e, d, zeta, amplitude, frequency]: [f64; 6]) -> (Siva<DrivenHost>, Cycle) {
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let cycle = Cycle { begin: 0.0, length: TAU / frequency };
    (Siva::new(mu, e, d, zeta).unwrap().under(force), cycle)
}

/// The numbers of a scene of the references.
fn scene(record: &Value) -> [f64; 6] {
    let names = ["mass_ratio", "restitution", "clearance", "damping_ratio"];
    let force = ["force_amplitude_per_mass", "frequency"];
    let mut numbers =
        names.into_iter().chain(force).map(|name| record["scene"][name].as_f64().unwrap());
    [0; 6].map(|_| numbers.next().unwrap())
}

/// Trajectories from starts that are drawn with |x|, |ẋ| < 2, |y| < .95 d, |ẏ| < 2 d.
fn drawn(rng: &mut Rng, given: [f64; 6], count: usize) -> Vec<Trajectory<Siva<DrivenHost>>> {
    let (siva, cycle) = mass(given);
    let d = given[2];
    let one = |_| {
        let start = Start {
            displacement: rng.range(-2.0, 2.0),
            velocity: rng.range(-2.0, 2.0),
            gap_displacement: 0.95 * d * rng.range(-1.0, 1.0),
            gap_velocity: 2.0 * d * rng.range(-1.0, 1.0),
        };
        Trajectory::new(siva.clone(), &start, cycle).unwrap()
    };
    (0..count).map(one).collect()
}

/// Trajectories from starts around the strobe of an unstable orbit: a torus is around it.
fn around(given: [f64; 6], centre: &[Value]) -> Vec<Trajectory<Siva<DrivenHost>>> {
    let (siva, cycle) = mass(given);
    let at = [0, 1, 2, 3].map(|k| centre[k].as_f64().unwrap());
    let one = |seed| {
        let [displacement, velocity, gap_displacement, gap_velocity] = at;
        let displacement = displacement + 0.02 * f64::from(seed);
        let start = Start { displacement, velocity, gap_displacement, gap_velocity };
        Trajectory::new(siva.clone(), &start, cycle).unwrap()
    };
    (1..=8).map(one).collect()
}

fn is_zero(sum_error: Option<f64>) -> bool {
    sum_error.is_some_and(|error| error.abs() <= 1e-12)
}

/// 8 trajectories of 3,000 cycles, in lanes.
#[test]
fn exponents_are_those_of_the_references() {
    let records = serde_json::from_str(include_str!("../../../reference/exponents.json"));
    let records: Vec<Value> = records.unwrap();
    for record in &records {
        let name = record["id"].as_str().unwrap();
        let given = scene(record);
        let mut rng = Rng::new(61);
        let starts = match record["centre_strobe"].as_array() {
            Some(centre) => around(given, centre),
            None => drawn(&mut rng, given, 8),
        };
        let found = lyapunov(&starts, Window { discard: 300, keep: 3000 }, None).unwrap();
        assert_eq!((found.outcome, found.rides, found.cycles), (Outcome::Finished, 0, 24_000));
        assert!(is_zero(found.sum_error), "{name}: {:?}", found.sum_error);
        for k in 0..4 {
            let truth = record["spectrum"][k].as_f64().unwrap();
            let known = record["standard_error"][k].as_f64().unwrap_or(0.0);
            let error = found.standard_errors[k].hypot(known);
            let off = (found.exponents[k] - truth).abs();
            // The exponents of a torus fall with the number of cycles, not with its root.
            let slow = if name.starts_with('Q') { 10.0 / (3000.0 * TAU) } else { 0.0 };
            assert!(off <= 4.0 * error + slow, "{name} {k}: {off} {error}");
            assert!(error < 0.003, "{name} {k}: {error}");
        }
        let truth = record["impacts_per_period"].as_f64().unwrap();
        let error =
            found.impacts_error.hypot(record["impacts_per_period_error"].as_f64().unwrap_or(1e-6));
        assert!((found.impacts - truth).abs() <= 4.0 * error, "{name}: {} {error}", found.impacts);
        if let Some(truth) = record["kaplan_yorke_dimension_of_the_stroboscopic_map"].as_f64() {
            assert!((found.dimension() - truth).abs() < 0.05, "{name}: {}", found.dimension());
        }
    }
    assert_eq!(records.len(), 3);
}

/// Trajectories that are divided among two calls have the spectrum of one call, to the bit.
#[test]
fn divided_trajectories_have_the_same_spectrum() {
    let starts = drawn(&mut Rng::new(64), [0.2, 0.7, 3.85, 0.05, 1.0, 1.0], 6);
    let window = Window { discard: 50, keep: 300 };
    let parts = [&starts[..1], &starts[1..]].map(|part| carried(part, window, None).unwrap());
    assert_eq!(spectrum(&starts, &parts.concat()), lyapunov(&starts, window, None).unwrap());
}

/// On a stable orbit they are ln |λ| of its multipliers over the time of a cycle.
#[test]
fn exponents_of_an_orbit_are_those_of_its_multipliers() {
    let given = [0.2, 0.7, 4.5, 0.05, 1.0, 1.0];
    let starts = drawn(&mut Rng::new(62), given, 2);
    let window = Window { discard: 400, keep: 4000 };
    let found = lyapunov(&starts, window, None).unwrap();
    let (siva, cycle) = mass(given);
    // Near orbit A1 of the references.
    let near =
        Start { displacement: -1.1, velocity: 0.33, gap_displacement: -4.04, gap_velocity: 3.26 };
    let orbit = find(&Trajectory::new(siva, &near, cycle).unwrap(), true, None).unwrap();
    let known = multipliers(&orbit.monodromy);
    let known: Vec<f64> = known.iter().map(|it| it.norm().ln() / cycle.length).collect();
    for (found, known) in found.exponents.iter().zip(&known) {
        // Of a pair the sum is found at once, each of the two to the angle between the differences over the time.
        assert!((found - known).abs() < 4.0 / (4000.0 * cycle.length), "{found} {known}");
    }
    let pair = found.exponents[0] + found.exponents[1] - known[0] - known[1];
    assert!(pair.abs() < 1.0 / (4000.0 * cycle.length), "{pair}");
    assert!(is_zero(found.sum_error));
    assert_eq!((found.impacts, found.rides), (2.0, 0));
}

/// Of 100 scenes, with few impacts and many, wherever there is no ride. Next to a grazing, and with many impacts at a low e,
/// the determinant of the derivative itself is lost in its rounding errors.
#[test]
fn the_sum_is_exact_without_rides() {
    let mut rng = Rng::new(63);
    let (mut count, mut worst, mut rides) = (0, 0.0f64, 0);
    for _ in 0..100 {
        let given = [
            rng.range(0.01, 0.5),
            rng.range(0.2, 0.95),
            rng.range(0.3, 6.0),
            rng.range(0.0, 0.1),
            1.0,
            rng.range(0.5, 2.0),
        ];
        let starts = drawn(&mut rng, given, 1);
        let found = lyapunov(&starts, Window { discard: 20, keep: 200 }, None).unwrap();
        match found.sum_error {
            Some(error) => {
                (count, worst) = (count + 1, worst.max(error.abs()));
                assert!(found.exponents.iter().all(|it| it.is_finite()));
            }
            None => {
                rides += 1;
                assert!(found.rides > 0);
                assert_eq!(found.exponents[2..], [f64::NEG_INFINITY; 2]);
                assert!(found.exponents[1] <= 1.0 && found.exponents[1].is_finite(), "{found:?}");
            }
        }
    }
    println!("{count} without rides, worst {worst:e}; {rides} with");
    assert!(count > 50 && rides > 5 && worst <= 1e-12, "{count} {rides} {worst:e}");
}

/// Scene S1 of the references: the absorber rides on each wall in each cycle, and the multipliers that are not 0 are
/// those of its record.
#[test]
fn a_ride_takes_two_exponents() {
    let given = [0.1, 0.5, 0.25, 0.02, 1.0, 0.7];
    let starts = drawn(&mut Rng::new(64), given, 1);
    let found = lyapunov(&starts, Window { discard: 200, keep: 100 }, None).unwrap();
    assert_eq!(found.exponents[2..], [f64::NEG_INFINITY; 2]);
    assert_eq!(found.standard_errors[2..], [0.0; 2]);
    assert_eq!((found.sum_error, found.rides), (None, 200));
    // Both multipliers of the pair have this exponent; the sum is found at once.
    let known = -0.021_946_893_691_856_27;
    let off = found.exponents[0] + found.exponents[1] - 2.0 * known;
    assert!(off.abs() < 1e-3 && (found.exponents[0] - known).abs() < 5e-3, "{found:?}");
}

#[test]
fn what_is_not_possible_is_said() {
    let starts = drawn(&mut Rng::new(65), [0.2, 0.7, 4.5, 0.05, 1.0, 1.0], 2);
    assert!(lyapunov(&starts, Window { discard: 3, keep: 0 }, None).is_err());
    assert!(lyapunov(&starts, Window { discard: u64::MAX, keep: 1 }, None).is_err());
    let cancelled = true.into();
    let found = lyapunov(&starts, Window { discard: 3, keep: 9 }, Some(&cancelled)).unwrap();
    assert_eq!((found.outcome, found.cycles), (Outcome::Cancelled, 0));
    assert!(found.exponents.iter().all(|it| it.is_nan()));
    let none: Spectrum = lyapunov(&starts[..0], Window { discard: 3, keep: 9 }, None).unwrap();
    assert_eq!(none.cycles, 0);
}
