//! Runs side by side against runs one by one, with each field of an absorber at a value that is not its default,
//! over enough cycles for a regime.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;

use arrow_array::cast::AsArray;
use iva_sweep::axis::Axis;
use iva_sweep::choices::Kind;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::sampling::Sampling;
use iva_sweep::slot::Slot;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::Workers;

use crate::every_field::{Drive, complete, run, scene, usual};

/// The tables of a sweep over six starts, run for 150 cycles of the force or 40 periods.
fn study(kind: Kind, drive: Drive, field: FieldId, tolerance: f64) -> Option<Study> {
    // Gravity on a free mass needs a line of motion that rises.
    let rises = kind == Kind::Siva && field == FieldId::Gravity;
    let mut spec = scene(kind, drive, rises);
    if drive == Drive::Nothing {
        spec.replace(Slot::from(FieldId::Periods), 40.0).unwrap();
    } else {
        spec.replace(Slot::from(FieldId::Cycles), 150.0).unwrap();
        spec.set(FieldId::Discard, 100.0).unwrap();
        spec.set(FieldId::DampingRatio, 0.1).unwrap();
    }
    complete(&mut spec, field);
    spec.replace(Slot::from(field), usual(field)).ok()?;
    spec.set(FieldId::Tolerance, tolerance).unwrap();
    let starts = Axis::new("displacement", (1..7).map(|k| 0.002 * f64::from(k)).collect()).unwrap();
    let study = Study { sampling: Sampling::Grid(vec![starts]), ..Study::single(spec) };
    study.design(0).ok().map(|_| study)
}

#[test]
fn runs_side_by_side_know_every_field_of_their_absorber() {
    let workers = Workers::new(Some(1)).unwrap();
    let mut regimes = 0;
    for kind in [Kind::Siva, Kind::Piva] {
        let of_absorber = |field: &FieldId| {
            let info = field.info();
            info.part == Part::Absorber && info.kinds.contains(&kind)
        };
        let mut tried = BTreeSet::new();
        for field in FieldId::all().filter(of_absorber) {
            for drive in [Drive::Nothing, Drive::Harmonic] {
                let Some(all) = study(kind, drive, field, 0.0) else { continue };
                tried.insert(field.path());
                let listed = run(&all, &workers, None, 0..6).remove(&Table::Summary).unwrap();
                let alone = Study { tables: vec![Table::Summary], ..all };
                let beside = run(&alone, &workers, None, 0..6).remove(&Table::Summary).unwrap();
                assert_eq!(beside, listed, "{} {drive:?}", field.path());
                // A point in a part of its own has no lane.
                for k in 0..6 {
                    let own =
                        run(&alone, &workers, None, k..k + 1).remove(&Table::Summary).unwrap();
                    assert_eq!(beside.slice(k as usize, 1), own, "{} {drive:?} {k}", field.path());
                }
                if drive == Drive::Nothing {
                    continue;
                }
                let fast = study(kind, drive, field, 1e-14).unwrap();
                let fast = Study { tables: vec![Table::Summary], ..fast };
                let fast = run(&fast, &workers, None, 0..6).remove(&Table::Summary).unwrap();
                let [exact, fast] =
                    [&beside, &fast].map(|table| table["regime"].as_string::<i32>());
                for (exact, fast) in exact.iter().zip(fast) {
                    if exact.is_some_and(|regime| regime.contains(':')) {
                        assert_eq!(fast, exact, "{}", field.path());
                        regimes += 1;
                    }
                }
            }
        }
        let fields = FieldId::all().filter(of_absorber).map(FieldId::path);
        assert_eq!(tried, fields.collect(), "all fields of the absorber of a {kind:?}");
    }
    println!("{regimes} regimes");
    assert!(regimes > 10);
}
