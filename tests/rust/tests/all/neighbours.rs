//! A row of a sweep depends on its point alone: not on the points beside it, their order, the size of the
//! parts or the number of threads. In the fast tier a row differs from that of the exact tier in its last
//! digits, so a point that changed its tier would show.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use iva_sweep::axis::Axis;
use iva_sweep::choices::{Choices, Kind};
use iva_sweep::design::Spec;
use iva_sweep::fields::FieldId;
use iva_sweep::forces::ForceSpec;
use iva_sweep::sampling::{Rows, Sampling};
use iva_sweep::slot::Slot;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Workers, sweep};
use iva_tests::rng::Rng;

/// Number of points; each is compared in eight sweeps.
const POINTS: usize = 1250;

const COLUMNS: [&str; 9] = [
    "absorber.inclination_deg",
    "force.1.velocity",
    "force.0.amplitude",
    "force.0.frequency",
    "absorber.clearance",
    "absorber.restitution",
    "absorber.restitution_minus",
    "start.displacement",
    "run.tolerance",
];

/// Points of all kinds of a free mass, most of them with a tolerance.
fn points(rng: &mut Rng) -> Vec<[f64; 9]> {
    let mut point = |_| {
        let restitution = rng.pick(&[0.3, 0.5, 0.7, 0.9]);
        let common = rng.unit() < 0.8;
        [
            rng.pick(&[0.0, 0.0, 0.0, 45.0]),
            rng.pick(&[0.0, 0.0, 0.0, 0.1]),
            rng.pick(&[0.0, 0.1, 0.3]),
            rng.range(0.7, 1.3),
            rng.range(0.2, 1.2),
            restitution,
            if common { restitution } else { 0.6 },
            rng.range(-1.0, 1.0),
            rng.pick(&[0.0, 1e-9, 1e-9]),
        ]
    };
    (0..POINTS).map(&mut point).collect()
}

/// A study of points; with a harmonic force, which may be of amplitude 0, and an impulse, which may be 0; or
/// without any force.
fn study(points: &[[f64; 9]], driven: bool) -> Study {
    let mut spec = Spec::new(Choices { kind: Kind::Siva, ..Choices::default() });
    for (field, value) in [
        (FieldId::DampingRatio, 0.02),
        (FieldId::MassRatio, 0.1),
        (FieldId::Gravity, 0.3),
        (FieldId::GapDisplacement, 0.0),
        (FieldId::Periods, 6.0),
    ] {
        spec.set(field, value).unwrap();
    }
    if driven {
        spec.add_force(ForceSpec::new(None));
        spec.add_force(ForceSpec::new(None));
        spec.set(Slot::of_force(FieldId::ImpulseTime, 1, 2), 3.0).unwrap();
    }
    let axes = COLUMNS.iter().enumerate().filter(|(_, key)| driven || !key.starts_with("force"));
    let axes = axes.map(|(column, key)| {
        Axis::new(key, points.iter().map(|point| point[column]).collect()).unwrap()
    });
    let sampling = Sampling::Rows(Rows::new(axes.collect(), 0).unwrap());
    Study { sampling, tables: vec![Table::Summary], ..Study::single(spec) }
}

/// The columns of a summary after `point`.
fn summary(study: &Study, workers: &Workers, chunk: Option<usize>) -> RecordBatch {
    let (never, length) = (AtomicBool::new(false), study.points().unwrap());
    let control = Control { workers, chunk, cancel: &never, progress: &|_| {} };
    let table = sweep(study, 0..length, &control).unwrap().remove(&Table::Summary).unwrap();
    table.project(&(1..table.num_columns()).collect::<Vec<_>>()).unwrap()
}

#[test]
fn rows_do_not_depend_on_their_neighbours() {
    let workers = [1, 2].map(|threads| Workers::new(Some(threads)).unwrap());
    let mut rng = Rng::new(20_261_124);
    let mut compared = 0;
    for driven in [false, true] {
        let points = points(&mut rng);
        let points = if driven { &points[..] } else { &points[..POINTS / 5] };
        let here = study(points, driven);
        let alone = summary(&here, &workers[0], Some(1));
        let tiers = alone["tier"].as_string::<i32>();
        // Decays are in the exact tier whatever the tolerance.
        for tier in if driven { &["exact", "fast"][..] } else { &["exact"] } {
            let count = tiers.iter().filter(|it| *it == Some(*tier)).count();
            assert!(count > points.len() / 20, "{count} {tier}");
        }
        for (threads, chunk) in
            [(0, None), (0, Some(2)), (0, Some(64)), (1, None), (1, Some(7)), (1, Some(1))]
        {
            let found = summary(&here, &workers[threads], chunk);
            assert_eq!(found, alone, "chunks of {chunk:?}");
            compared += points.len();
        }
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|i| (i * 7919) % points.len());
        for order in [(0..points.len()).rev().collect(), order] {
            let moved: Vec<_> = order.iter().map(|i| points[*i]).collect();
            let found = summary(&study(&moved, driven), &workers[0], None);
            for (place, i) in order.iter().enumerate() {
                assert_eq!(found.slice(place, 1), alone.slice(*i, 1), "point {i} at {place}");
            }
            compared += points.len();
        }
    }
    println!("{compared} rows compared");
    assert!(compared >= 10_000);
}
