//! Sweeps over every field, of every kind of scene: each row equals a run of that point alone, and the
//! summary has the same bits whatever else is computed, on any number of threads, and with any neighbours. A
//! sweep with only the summary runs its points side by side where it can.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use iva_sweep::axis::Axis;
use iva_sweep::choices::{Choices, Kind};
use iva_sweep::columns::{SUMMARY, Selection};
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::forces::{ForceSpec, History, RecordKind, Recorded};
use iva_sweep::sampling::Sampling;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Tables, Workers, sweep, validate};

/// The excitation of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Drive {
    Nothing,
    Harmonic,
    Impulse,
    Record,
}

/// A structure of 100 kg at 30 rad/s with its absorber, on a level or inclined line of motion.
pub(crate) fn scene(kind: Kind, drive: Drive, rises: bool) -> Spec {
    use FieldId as F;
    let mut spec = Spec::new(Choices { kind, ..Choices::default() });
    let mut fields = vec![
        (F::PrimaryMass, 100.0),
        (F::NaturalFrequency, 30.0),
        (F::DampingRatio, 0.02),
        (F::MassRatio, 0.1),
        (F::Restitution, 0.6),
        (F::Clearance, 0.005),
        (F::Displacement, 0.01),
        (F::Periods, 4.0),
    ];
    if kind == Kind::Piva {
        fields.push((F::Length, 0.4));
    }
    if rises {
        fields.extend([(F::InclinationDeg, 20.0), (F::Gravity, 9.81)]);
    }
    match drive {
        Drive::Nothing => {}
        Drive::Harmonic => fields.extend([(F::Amplitude, 2.0), (F::ForceFrequency, 29.0)]),
        Drive::Impulse => fields.push((F::ImpulseVelocity, 0.1)),
        Drive::Record => {
            let times = (0..200).map(|k| f64::from(k) * 0.01).collect();
            let values = (0..200).map(|k| (0.3 * f64::from(k)).sin()).collect();
            spec.add_force(ForceSpec::new(Some(Recorded {
                history: Arc::new(History::new(times, values).unwrap()),
                kind: RecordKind::BaseAcceleration,
                file: None,
                is_metric: true,
            })));
        }
    }
    for (field, value) in fields.into_iter().filter(|(field, _)| field.info().kinds.contains(&kind))
    {
        spec.set(field, value).unwrap();
    }
    spec
}

/// A typical value of a field for these scenes.
pub(crate) fn usual(field: FieldId) -> f64 {
    use FieldId as F;
    match field {
        F::DampingRatio | F::PivotDampingRatio => 0.02,
        F::Damping => 100.0,
        F::NaturalFrequency | F::ForceFrequency => 30.0,
        F::FrequencyHz | F::ForceFrequencyHz => 4.5,
        F::Stiffness => 9e4,
        F::PrimaryMass => 90.0,
        F::MassRatio => 0.1,
        F::AbsorberMass => 8.0,
        F::Restitution | F::RelativeClearance => 0.6,
        F::RestitutionMinus => 0.7,
        F::GapOffset => 0.001,
        F::GapOffsetMm => 1.0,
        F::ContactTime => 1e-3,
        F::ContactStiffness => 1e6,
        F::Clearance => 0.005,
        F::ClearanceMm => 5.0,
        F::Gap => 0.01,
        F::GapMm => 10.0,
        F::FrequencyRatio => 0.2,
        F::Length | F::ContactDistance => 0.4,
        F::Gravity => 9.0,
        F::Inclination => 0.3,
        F::InclinationDeg => 40.0,
        F::InertiaRatio | F::RelativeFrequency | F::RecordScale => 1.1,
        F::Amplitude | F::BaseAcceleration => 2.0,
        F::ForceAmplitude => 200.0,
        F::Phase => 0.3,
        F::ImpulseVelocity | F::Velocity => 0.1,
        F::ImpulseMomentum => 10.0,
        F::ImpulseTime | F::AngularVelocity => 0.05,
        F::Displacement => 0.01,
        F::DisplacementMm => 10.0,
        F::GapDisplacement => 0.002,
        F::GapVelocity => 0.04,
        F::Angle => 0.004,
        F::Periods | F::Cycles => 4.0,
        F::Duration => 0.8,
        F::StartTime => 0.3,
        F::Reference => 0.02,
        F::Discard => 1.0,
        F::MaxImpacts => 4.0,
        F::MaxWork => 30.0,
        F::Tolerance => 1e-9,
        F::ChatterFloor => 1e-3,
    }
}

/// The field as an axis over three values.
fn axis(field: FieldId) -> Axis {
    let whole = matches!(field, FieldId::MaxImpacts | FieldId::MaxWork);
    let factors = if whole { [1.0, 2.0, 3.0] } else { [1.0, 1.01, 1.1] };
    let values = factors.map(|factor| factor * usual(field)).to_vec();
    // Under its bare name where that is unique; it may also be the name of a column.
    let bare = field.info().name;
    let key = if FieldId::from_key(bare) == Ok(field) { bare } else { &field.path() };
    Axis::new(key, values).unwrap()
}

pub(crate) fn run(
    study: &Study,
    workers: &Workers,
    chunk: Option<usize>,
    points: Range<u64>,
) -> Tables {
    let never = AtomicBool::new(false);
    sweep(study, points, &Control { workers, chunk, cancel: &never, progress: &|_| {} }).unwrap()
}

/// Checks that the columns of a run of one point alone equal a row of a sweep over `key`, by their names.
fn assert_is_row(row: &RecordBatch, alone: &RecordBatch, key: &str, value: f64) {
    assert_eq!(row[key].as_primitive::<Float64Type>().value(0), value);
    for column in SUMMARY.iter().filter(|column| column.name != key) {
        assert_eq!(&row[column.name], &alone[column.name], "{} over {key} = {value}", column.name);
    }
}

/// True for a tolerance of a free mass: the fast tier makes its row only if nothing but the summary is
/// wanted.
fn is_tier_of_free_mass(study: &Study, field: FieldId) -> bool {
    field == FieldId::Tolerance && study.spec.choices().kind == Kind::Siva
}

/// Checks that the summary of a sweep over a field is the same beside other tables and when run in different
/// ways.
fn assert_same_bits(study: &Study, field: FieldId, workers: &[Workers; 2]) {
    let beside = [Table::Impacts, Table::Episodes, Table::Envelope, Table::Stroboscope];
    let summary = |study: &Study, workers, chunk| {
        run(study, workers, chunk, 0..3).remove(&Table::Summary).unwrap()
    };
    let alone = Study { tables: vec![Table::Summary], ..study.clone() };
    let reference = summary(&alone, &workers[0], None);
    let subsets = if is_tier_of_free_mass(study, field) { 1 } else { 1u32 << beside.len() };
    for subset in 0..subsets {
        let more = beside.iter().enumerate().filter(|(bit, _)| subset & (1 << bit) != 0);
        let tables = [Table::Summary].into_iter().chain(more.map(|(_, table)| *table)).collect();
        let study = Study { tables, ..study.clone() };
        assert_eq!(summary(&study, &workers[0], None), reference, "beside {:?}", study.tables);
    }
    for (workers, chunk) in [(&workers[0], Some(1)), (&workers[1], None), (&workers[1], Some(2))] {
        assert_eq!(summary(&alone, workers, chunk), reference, "chunks of {chunk:?}");
    }
    for point in 0..3 {
        let one = run(&alone, &workers[0], None, point..point + 1);
        assert_eq!(one[&Table::Summary], reference.slice(point as usize, 1), "point {point}");
    }
    // Measures computed one at a time have the bits that they have together, including those that are
    // computed only if asked for by name. With these a free mass is not of the fast tier.
    let usual = Selection::default();
    let (all, columns) = match is_tier_of_free_mass(study, field) {
        true => (usual, SUMMARY.iter().filter(|column| usual.contains(column.name)).collect()),
        false => (Selection::all(), Vec::from_iter(SUMMARY)),
    };
    let everything = summary(&Study { measures: all, ..alone.clone() }, &workers[0], None);
    for column in columns {
        if usual.contains(column.name) {
            assert_eq!(&everything[column.name], &reference[column.name], "{} of all", column.name);
        }
        let measures = Selection::from_names([column.name]).unwrap();
        let found = summary(&Study { measures, ..alone.clone() }, &workers[0], None);
        assert_eq!(&found[column.name], &everything[column.name], "{} alone", column.name);
    }
}

fn check(spec: &Spec, field: FieldId, workers: &[Workers; 2]) -> bool {
    let axis = axis(field);
    let (key, values) = (axis.key.clone(), axis.values.clone());
    let study = Study { sampling: Sampling::Grid(vec![axis]), ..Study::single(spec.clone()) };
    if validate(&study, &workers[0], &AtomicBool::new(false), &|_| {}).is_err() {
        return false;
    }
    let only = Study { tables: vec![Table::Summary], ..study.clone() };
    let rows = run(&only, &workers[0], None, 0..values.len() as u64);
    for (point, value) in values.into_iter().enumerate() {
        let mut single = Study::single(study.spec(point as u64).unwrap());
        if is_tier_of_free_mass(&study, field) {
            single.tables = vec![Table::Summary];
        }
        let alone = &run(&single, &workers[0], None, 0..1)[&Table::Summary];
        assert_is_row(&rows[&Table::Summary].slice(point, 1), alone, &key, value);
    }
    assert_same_bits(&study, field, workers);
    true
}

#[test]
fn a_sweep_over_any_field_has_the_rows_of_its_points() {
    let workers = [1, 2].map(|threads| Workers::new(Some(threads)).unwrap());
    for kind in Kind::ALL {
        let mut tried = BTreeSet::new();
        let mut scenes = vec![
            (Drive::Nothing, false),
            (Drive::Harmonic, false),
            (Drive::Impulse, false),
            (Drive::Record, false),
        ];
        if kind == Kind::Siva {
            scenes.extend([(Drive::Nothing, true), (Drive::Harmonic, true)]);
        }
        for (drive, rises) in scenes {
            let spec = scene(kind, drive, rises);
            for field in FieldId::all() {
                let of_force = field.info().part == Part::Force;
                if !(of_force && drive == Drive::Nothing) && check(&spec, field, &workers) {
                    tried.insert(field.path());
                }
            }
        }
        let fields = FieldId::all().filter(|field| field.info().kinds.contains(&kind));
        assert_eq!(tried, fields.map(FieldId::path).collect(), "all fields of a {kind:?}");
    }
}
