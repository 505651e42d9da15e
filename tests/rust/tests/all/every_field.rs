//! Sweeps over every field, of every kind of scene: each row equals a run of that point alone, and all tables have
//! the same bits by every [`Path`]: whatever else is computed, on any number of threads, in any order, and with any
//! neighbours. Points run side by side where they can. `tests/python/test_paths.py` does the same for the paths of the
//! command and of Python.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_select::concat::concat_batches;
use iva_sweep::axis::Axis;
use iva_sweep::choices::{Choices, Kind};
use iva_sweep::columns::{SUMMARY, Selection, columns};
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::forces::{ForceSpec, History, RecordKind, Recorded};
use iva_sweep::sampling::Sampling;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Tables, Workers, run_inline, sweep, validate};
use iva_tests::stride;

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
    if kind == Kind::Stop {
        // Its point begins between its walls.
        fields.push((F::GapOffset, 0.006));
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
                selection: Default::default(),
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

/// Gives what a field needs beside it.
pub(crate) fn complete(spec: &mut Spec, field: FieldId) {
    let kind = spec.choices().kind;
    if field == FieldId::RestitutionExponent && matches!(kind, Kind::Siva | Kind::Stop) {
        spec.set(FieldId::ReferenceSpeed, 0.5).unwrap();
    }
    if matches!(field, FieldId::GapOffset | FieldId::GapOffsetMm) && kind == Kind::Stop {
        spec.set(FieldId::Displacement, 0.003).unwrap();
    }
    if field == FieldId::StaticFriction && matches!(kind, Kind::Siva | Kind::Piva) {
        spec.set(FieldId::Friction, 0.1).unwrap();
    }
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
        F::ReferenceSpeed => 0.5,
        F::RestitutionExponent => 0.2,
        F::YieldSpeed | F::ClearanceSpread | F::Friction => 0.1,
        F::StaticFriction => 0.15,
        F::GapDamping => 20.0,
        F::Spring => 600.0,
        F::GapDampingRatio => 0.003,
        F::Units => 2.0,
        F::GapOffset => 0.001,
        F::GapOffsetMm => 1.0,
        F::ContactTime => 1e-3,
        F::ContactStiffness => 1e6,
        F::Clearance => 0.005,
        F::ClearanceMm => 5.0,
        F::Gap => 0.01,
        F::GapMm => 10.0,
        F::FrequencyRatio | F::SpringRatio => 0.2,
        F::Length | F::ContactDistance => 0.4,
        F::Gravity => 9.0,
        F::Inclination => 0.3,
        F::InclinationDeg => 40.0,
        F::InertiaRatio | F::RelativeFrequency | F::RecordScale => 1.1,
        F::Amplitude | F::BaseAcceleration => 2.0,
        F::BaseVelocity => 0.07,
        F::BaseDisplacement => 0.002,
        F::BaseDisplacementMm => 2.0,
        F::ForceAmplitude => 200.0,
        F::Phase => 0.3,
        F::ImpulseVelocity | F::StartImpulseVelocity | F::Velocity => 0.1,
        F::ImpulseMomentum | F::StartImpulse => 10.0,
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
    let whole = matches!(field, FieldId::MaxImpacts | FieldId::MaxWork | FieldId::Units);
    let factors = match field {
        // Exponents are quotients of small whole numbers.
        FieldId::RestitutionExponent => [1.0, 2.0, 5.0],
        _ if whole => [1.0, 2.0, 3.0],
        _ => [1.0, 1.01, 1.1],
    };
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
    let control = Control { workers, chunk, cancel: &never, progress: &|_| {} };
    assert_all_is_told(study, &control);
    sweep(study, points, &control).unwrap()
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

/// A way in which the points of a study can be run. No row depends on it.
#[derive(Debug, Clone, Copy)]
enum Path {
    /// Other tables beside the summary, as a set of bits.
    Beside(u32),
    /// With estimated errors, and these tables beside it.
    Errors(u32),
    /// On some threads, in chunks of some points.
    Threads(usize, Option<usize>),
    /// Point by point, in sweeps of their own.
    PointByPoint,
    /// In reversed order.
    Reversed,
    /// Each on the calling thread.
    Inline,
}

const BESIDE: [Table; 4] = [Table::Impacts, Table::Episodes, Table::Envelope, Table::Stroboscope];

impl Path {
    /// All of them. For a scene that only the summary is of the fast tier of, those that make only the summary.
    /// Of lists with a pendulum no errors are estimated.
    fn all(summary_only: bool, estimates: bool) -> Vec<Self> {
        let beside = if summary_only { 1..1 } else { 1..1u32 << BESIDE.len() };
        let errors = if estimates { vec![0, 1, 3, 15] } else { vec![] };
        let chunks = [(1, Some(1)), (2, None), (2, Some(2))];
        let others = [Self::PointByPoint, Self::Reversed, Self::Inline];
        let tables = beside.map(Self::Beside).chain(errors.into_iter().map(Self::Errors));
        tables
            .chain(chunks.map(|(threads, chunk)| Self::Threads(threads, chunk)))
            .chain(others)
            .collect()
    }

    /// The tables of a study over one axis by this path, the points in their order.
    fn tables(self, study: &Study, workers: &[Workers; 2]) -> Tables {
        let points = study.points().unwrap();
        let beside = |set: u32| {
            let more = BESIDE.iter().enumerate().filter(|(bit, _)| set & (1 << bit) != 0);
            [Table::Summary].into_iter().chain(more.map(|(_, table)| *table)).collect()
        };
        let joined = |parts: Vec<Tables>| {
            let of = |table| parts.iter().map(|part| &part[&table]).collect::<Vec<_>>();
            let join = |table| {
                let parts = of(table);
                (table, concat_batches(&parts[0].schema(), parts).unwrap())
            };
            study.tables.iter().map(|table| join(*table)).collect()
        };
        match self {
            Self::Beside(set) => {
                run(&Study { tables: beside(set), ..study.clone() }, &workers[0], None, 0..points)
            }
            Self::Errors(set) => {
                let study = Study { tables: beside(set), errors: true, ..study.clone() };
                run(&study, &workers[0], None, 0..points)
            }
            Self::Threads(threads, chunk) => run(study, &workers[threads - 1], chunk, 0..points),
            Self::PointByPoint => {
                joined((0..points).map(|k| run(study, &workers[0], None, k..k + 1)).collect())
            }
            Self::Reversed => {
                let mut reversed = study.clone();
                let Sampling::Grid(axes) = &mut reversed.sampling else { panic!() };
                axes[0].values.reverse();
                let whole = run(&reversed, &workers[0], None, 0..points);
                let row = |k: u64| whole[&Table::Summary].slice(k as usize, 1);
                let rows: Vec<_> = (0..points).rev().map(row).collect();
                let summary = concat_batches(&rows[0].schema(), &rows).unwrap();
                [(Table::Summary, summary)].into()
            }
            Self::Inline => joined(
                (0..points)
                    .map(|point| {
                        let single = Study { sampling: Sampling::Grid(vec![]), ..study.clone() };
                        let single = Study { spec: study.spec(point).unwrap(), ..single };
                        let inline = run_inline(&single, u64::MAX).unwrap();
                        // What it leaves to workers is a sweep of one point.
                        inline.unwrap_or_else(|| run(&single, &workers[0], None, 0..1))
                    })
                    .collect(),
            ),
        }
    }
}

/// Names all that a sweep is told. What comes to it has to become a path, or a part of the scenes, before this
/// compiles.
fn assert_all_is_told(study: &Study, control: &Control<'_>) {
    // Scenes and fields; paths.
    let Study { spec: _, sampling: _, tables: _, measures: _, errors: _ } = study;
    let Control { workers: _, chunk: _, cancel: _, progress: _ } = control;
}

/// Checks that the tables of a sweep over a field are the same by every path.
fn assert_same_bits(study: &Study, field: FieldId, workers: &[Workers; 2]) {
    let summary_only = is_tier_of_free_mass(study, field);
    let of = |study: &Study, path: Path| path.tables(study, workers);
    let alone = Study { tables: vec![Table::Summary], ..study.clone() };
    let reference = of(&alone, Path::Beside(if summary_only { 0 } else { 15 }));
    let units = matches!(field, FieldId::Units | FieldId::ClearanceSpread);
    let pendulums = units && study.spec.choices().kind == Kind::Piva;
    let estimates = !summary_only && !pendulums;
    let estimated = estimates.then(|| of(&alone, Path::Errors(15)));
    for path in Path::all(summary_only, estimates) {
        let truth = match path {
            Path::Errors(_) => estimated.as_ref().unwrap(),
            _ => &reference,
        };
        for (table, found) in of(&alone, path) {
            // Swept columns and numbers of points are those of the path.
            for column in columns(table) {
                let [found, truth] =
                    [&found, &truth[&table]].map(|it| it.column_by_name(column.name));
                assert!(
                    found.is_none() || found == truth,
                    "{} by {path:?} of {}: {found:?} {truth:?}",
                    column.name,
                    field.path()
                );
            }
        }
    }
    if let Some(estimated) = &estimated {
        for (table, truth) in &reference {
            let of_errors = ["condition", "digits", "time_error", "near_grazing"];
            for column in columns(*table).iter().filter(|it| !of_errors.contains(&it.name)) {
                let [found, truth] =
                    [&estimated[table], truth].map(|it| it.column_by_name(column.name));
                assert_eq!(found, truth, "{} beside errors", column.name);
            }
        }
    }
    // Measures computed one at a time have the bits that they have together, including those that are
    // computed only if asked for by name. With these a free mass is not of the fast tier.
    let summary = |study: &Study| of(study, Path::Beside(0)).remove(&Table::Summary).unwrap();
    let reference = &reference[&Table::Summary];
    let usual = Selection::default();
    let (all, columns) = match summary_only {
        true => (usual, SUMMARY.iter().filter(|column| usual.contains(column.name)).collect()),
        false => (Selection::all(), Vec::from_iter(SUMMARY)),
    };
    let everything = summary(&Study { measures: all, ..alone.clone() });
    // Others for each field.
    for column in columns.into_iter().skip(field as usize % stride()).step_by(stride()) {
        if usual.contains(column.name) {
            assert_eq!(&everything[column.name], &reference[column.name], "{} of all", column.name);
        }
        let measures = Selection::from_names([column.name]).unwrap();
        let found = summary(&Study { measures, ..alone.clone() });
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
                let mut spec = spec.clone();
                complete(&mut spec, field);
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
