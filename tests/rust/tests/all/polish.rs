//! Orbits to twice the precision: the digits of the references, from orbits that doubles gave.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Absorber,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Numbered,
        periodic::{Missed, find},
        polish::{Polished, Stretch, polish},
    },
    real::{Real, twofold::Twofold},
    simulate::{Instant, Limits, resume},
    siva::Siva,
};
use iva_tests::dd::Dd;
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use crate::periodic::{cycle, mass, records, trajectory, truth};

const NAMES: [&str; 4] = ["displacement", "velocity", "gap_displacement", "gap_velocity"];

fn twofold(value: &Value) -> Twofold {
    let Dd { hi, lo } = Dd::parse(value.as_str().unwrap());
    Twofold::new(hi, lo)
}

/// The scene of a record, in its decimals, and the period of its force.
fn scene(record: &Value) -> (Siva<DrivenHost<Twofold>>, Twofold) {
    let key = |name: &str| twofold(&record["scene"][name]);
    let [mu, e, d, zeta] = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
    let (amplitude, frequency) = (key("force_amplitude_per_mass"), key("frequency"));
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0.into(), acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let period = (Twofold::TURN.value + Twofold::TURN.rest) / frequency;
    (Siva::new(mu, e, d, zeta).unwrap().under(force), period)
}

/// Series of order 20 leave some 1e-26 a stretch, which an orbit multiplies in these numbers, the sum of a chatter some 1e-22.
#[test]
fn the_digits_of_the_references_are_found() {
    for record in records(include_str!("../../../reference/orbits.json")) {
        let name = record["id"].as_str().unwrap();
        let symmetric = record["symmetric"] == true;
        let begun = trajectory(mass(&record), &truth(&record), cycle(&record, 0.0));
        let orbit = find(&begun, symmetric, None).unwrap();
        let (system, period) = scene(&record);
        let periods = record["forcing_periods"].as_f64().unwrap();
        let length = period * periods;
        let part = length * if symmetric { 0.5 } else { 1.0 };
        let begin = Twofold::from(orbit.trajectory.cycle.begin);
        let stretch = Stretch { begin, length: part, mirrored: symmetric };
        let from = orbit.trajectory.system.point(&orbit.trajectory.state);
        let Polished { at, residual } =
            polish(&system, stretch, (&from, &orbit.derivative), None).unwrap();
        // On to the phase of the references.
        let start = system.all_numbered(&at).unwrap();
        let cycles = (f64::from(begin) / f64::from(length)).ceil();
        let limits = Limits::new(length * cycles.max(1.0), system.clearance());
        let instant = Instant::at(&system, &start, begin);
        let tally = resume(&system, &instant, &limits, None, &mut ()).unwrap();
        let found = system.numbers(&tally.state);
        let off = |k: usize| f64::from(found[k] - twofold(&record["state_at_time_0"][NAMES[k]]));
        let worst = (0..4).map(|k| off(k).abs()).fold(0.0, f64::max);
        println!("{name}: residual {residual:.1e}, state {worst:.1e}");
        let allowed = if name == "S1" { 1e-20 } else { 1e-23 };
        assert!(residual < 1e-26 && worst < allowed, "{name}: {residual:e}, {worst:e}");
    }
}

/// With a derivative of no use the error does not fall, and that is told.
#[test]
fn what_does_not_converge_is_told() {
    let record = &records(include_str!("../../../reference/orbits.json"))[0];
    let (system, length) = scene(record);
    let from = DVector::from_column_slice(truth(record).add_scalar(1e-3).as_slice());
    let stretch = Stretch { begin: 0.0.into(), length, mirrored: false };
    let told = polish(&system, stretch, (&from, &(DMatrix::identity(4, 4) * -3.0)), None);
    assert!(matches!(told, Err(Missed::Stalled(residual)) if residual > 1e-6), "{told:?}");
    let singular = polish(&system, stretch, (&from, &DMatrix::identity(4, 4)), None);
    assert_eq!(singular, Err(Missed::Singular));
}
