//! Numbers near the limits of doubles: refused by name, or a run like any other; and natural frequencies over
//! fifteen decades.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::AtomicBool;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch};
use iva_core::{
    absorber::{Absorber, Start},
    error::Invalid,
    force::{Acts, Force, Harmonic, Impulse},
    piva::{Parameters, Piva},
    run::run,
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_sweep::{
    choices::Choices,
    design::Spec,
    fields::FieldId,
    study::{Study, Table},
    sweep::{Control, Workers, sweep},
};

/// The smallest subnormal number, two others, and the smallest normal number.
const TINY: [f64; 4] = [5e-324, 1e-320, 2.2e-308, f64::MIN_POSITIVE];

fn refused<T: std::fmt::Debug>(result: Result<T, Invalid>, field: &str, value: f64) {
    let error = result.expect_err(&format!("{field} = {value:e} must be refused"));
    assert!(error.field.ends_with(field), "{field} = {value:e}: {error}");
    assert!(!error.value.is_empty() && !error.allowed.is_empty());
}

fn goes<S: Absorber<Real = f64>>(system: &S, start: &S::Start, what: &str)
where
    S::State: PartialEq,
{
    let run = run(system, start, &Limits::new(20.0, system.clearance())).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished, "{what}");
    let measures = &run.measures;
    assert!(measures.energy_residual.abs() <= 1e-12 * measures.energy_initial, "{what}");
    assert!(!run.impacts.is_empty(), "{what}");
}

fn from_one() -> Start {
    Start { displacement: 1.0, ..Start::default() }
}

#[test]
fn denormal_lengths_and_times_are_refused_by_name() {
    let siva = Siva::new(0.1, 0.5, 0.5, 0.01).unwrap();
    let piva = Piva::new(Parameters::point_bob(0.1, 0.5, 0.5, 0.01, 2.0)).unwrap();
    let fine = Limits::new(10.0, 0.5);
    for size in TINY {
        refused(Siva::new(0.1, 0.5, size, 0.01), "clearance", size);
        for value in [size, -size] {
            let starts = [
                ("displacement", Start { displacement: value, ..Start::default() }),
                ("velocity", Start { velocity: value, ..Start::default() }),
                ("gap_displacement", Start { gap_displacement: value, ..Start::default() }),
                ("gap_velocity", Start { gap_velocity: value, ..Start::default() }),
            ];
            for (field, start) in starts {
                refused(run(&siva, &start, &fine), field, value);
                refused(run(&piva, &start.into(), &fine), field, value);
            }
        }
        let limits = Limits { duration: size, ..fine };
        refused(run(&siva, &from_one(), &limits), "duration", size);
        let limits = Limits { chatter_floor: size, ..fine };
        refused(run(&siva, &from_one(), &limits), "chatter_floor", size);
        let p = *piva.parameters();
        refused(Piva::new(Parameters { clearance: size, ..p }), "clearance", size);
        refused(Piva::new(Parameters { length: size, ..p }), "length", size);
        refused(Piva::new(Parameters { contact_distance: size, ..p }), "contact_distance", size);
        refused(Piva::new(Parameters { frequency_ratio: size, ..p }), "frequency_ratio", size);
        let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.0, acts: Acts::Base };
        let of = |harmonic| Force::harmonic(vec![harmonic]);
        refused(of(Harmonic { amplitude: size, ..harmonic }), "amplitude", size);
        refused(of(Harmonic { frequency: size, ..harmonic }), "frequency", size);
        let kick = |velocity, time| Force::new(vec![], vec![], &[Impulse { velocity, time }]);
        refused(kick(size, 1.0), "velocity", size);
        refused(kick(1.0, size), "time", size);
    }
}

#[test]
fn denormal_ratios_and_angles_are_numbers_like_any_other() {
    for size in TINY {
        let name = |what: &str| format!("{what} = {size:e}");
        goes(&Siva::new(size, 0.5, 0.5, 0.01).unwrap(), &from_one(), &name("mass ratio"));
        goes(&Siva::new(0.1, size, 0.5, 0.01).unwrap(), &from_one(), &name("restitution"));
        goes(&Siva::new(0.1, 0.5, 0.5, size).unwrap(), &from_one(), &name("damping ratio"));
        let p = Parameters::point_bob(0.1, 0.5, 0.5, 0.01, 2.0);
        for (what, p) in [
            ("mass ratio", Parameters { mass_ratio: size, ..p }),
            ("restitution", Parameters { restitution: size, ..p }),
            ("damping ratio", Parameters { damping_ratio: size, ..p }),
            ("pivot damping ratio", Parameters { pivot_damping_ratio: size, ..p }),
            ("tolerance", Parameters { tolerance: size, ..p }),
        ] {
            goes(&Piva::new(p).unwrap(), &from_one().into(), &name(what));
        }
        let harmonic = Harmonic { amplitude: 0.3, frequency: 0.9, phase: 0.0, acts: Acts::Base };
        let driven = |phase| {
            let force = Force::harmonic(vec![Harmonic { phase, ..harmonic }]).unwrap();
            let piva = Piva::new(p).unwrap().under(force);
            run(&piva, &from_one().into(), &Limits::new(20.0, 0.5)).unwrap()
        };
        assert_eq!(driven(size).impacts, driven(0.0).impacts, "{}", name("phase"));
    }
}

fn table(natural_frequency: Option<f64>, pendulum: bool) -> RecordBatch {
    let mut choices = Choices::default();
    if pendulum {
        choices.choose("kind", "piva").unwrap();
    }
    let mut spec = Spec::new(choices);
    for (field, value) in [
        (FieldId::DampingRatio, 0.01),
        (FieldId::MassRatio, 0.1),
        (FieldId::Restitution, 0.5),
        (FieldId::RelativeClearance, 0.5),
        (FieldId::Displacement, 1.0),
        (FieldId::Periods, 60.0),
    ] {
        spec.set(field, value).unwrap();
    }
    if pendulum {
        spec.set(FieldId::FrequencyRatio, 0.2).unwrap();
        spec.set(FieldId::Length, 5.0).unwrap();
    }
    let omega = natural_frequency.unwrap_or(1.0);
    spec.set(FieldId::Velocity, 0.25 * omega).unwrap();
    spec.set(FieldId::GapVelocity, -0.125 * omega).unwrap();
    if let Some(frequency) = natural_frequency {
        spec.set(FieldId::NaturalFrequency, frequency).unwrap();
    }
    let study = Study::single(spec);
    let workers = Workers::new(Some(1)).unwrap();
    let control = Control {
        workers: &workers,
        chunk: None,
        cancel: &AtomicBool::new(false),
        progress: &|_| {},
    };
    sweep(&study, 0..1, &control).unwrap().remove(&Table::Summary).unwrap()
}

/// The same scene with another unit of time: one rounding of each start velocity at the input, one or two of
/// each number at the output. If ωn is a power of two, no bit changes.
#[test]
fn natural_frequencies_over_fifteen_decades() {
    let value = |table: &RecordBatch, name: &str| {
        let column = table.column_by_name(name).unwrap_or_else(|| panic!("{name}"));
        assert!(!column.is_null(0), "{name}");
        let count = || Some(column.as_primitive_opt::<Int64Type>()?.value(0) as f64);
        let number = || Some(column.as_primitive_opt::<Float64Type>()?.value(0));
        number().or_else(count).unwrap_or_else(|| panic!("{name}: {}", column.data_type()))
    };
    for pendulum in [false, true] {
        let natural = table(None, pendulum);
        let powers = [-20, -7, 3, 10, 29].map(|power| 2f64.powi(power));
        for omega in powers.into_iter().chain([1e-6, 1e-3, 0.7, 62.8, 1e5, 1e9]) {
            let other = table(Some(omega), pendulum);
            // The rounding of a start velocity changes events by its condition, some hundreds here.
            let exact = powers.contains(&omega);
            let allowed = if exact { 4.0 * f64::EPSILON } else { 1e-11 };
            for (name, scale) in [
                ("settling_time_5", omega.recip()),
                ("damping_ratio_fit", 1.0),
                ("residual_amplitude", 1.0),
                ("energy_initial", omega * omega),
                ("energy_impacts", omega * omega),
                ("impacts", 1.0),
            ] {
                let (expected, found) = (value(&natural, name) * scale, value(&other, name));
                let off = (found / expected - 1.0).abs();
                assert!(off <= allowed, "{name} at ωn = {omega:e}: {found} for {expected}");
            }
        }
    }
}
