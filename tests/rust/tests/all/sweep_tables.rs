//! Tables of a sweep: independent of threads and chunks, complete, in the order of `point`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt32Type};
use arrow_array::{Array, RecordBatch};
use iva_core::absorber::Absorber;
use iva_core::simulate::{Limits, simulate};
use iva_sweep::axis::Axis;
use iva_sweep::choices::{Choices, Kind};
use iva_sweep::columns::{SUMMARY, Selection, columns};
use iva_sweep::design::Spec;
use iva_sweep::done::Done;
use iva_sweep::fields::FieldId;
use iva_sweep::forces::ForceSpec;
use iva_sweep::sampling::Sampling;
use iva_sweep::scene::Scene;
use iva_sweep::slot::Slot;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, DESIGNED_FIRST, Tables, Workers, run_inline, sweep, validate};

fn spec() -> Spec {
    with_scene(Spec::default())
}

/// The scene with a pendulum, which has a value in every column.
fn pendulum() -> Spec {
    let mut choices = Choices::default();
    choices.choose("kind", "piva").unwrap();
    let mut spec = with_scene(Spec::new(choices));
    spec.set(FieldId::FrequencyRatio, 0.2).unwrap();
    spec.set(FieldId::Length, 5.0).unwrap();
    spec.set(FieldId::PivotDampingRatio, 0.01).unwrap();
    spec
}

fn with_scene(mut spec: Spec) -> Spec {
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
    spec
}

/// The scene with a pendulum on a moving base.
fn shaken() -> Spec {
    let mut spec = pendulum();
    spec.set(FieldId::BaseAcceleration, 0.3).unwrap();
    spec.set(FieldId::RelativeFrequency, 0.9).unwrap();
    spec
}

/// The grid of `studies/siva_clearance.toml`, with every table.
fn clearance_study() -> Study {
    Study {
        sampling: Sampling::Grid(vec![
            Axis::linspace("relative_clearance", 0.1, 1.2, 111).unwrap(),
            Axis::new("mass_ratio", vec![0.05, 0.1, 0.15, 0.2]).unwrap(),
        ]),
        ..Study::single(spec())
    }
}

fn run(study: &Study, threads: usize, chunk: Option<usize>, cancel: bool) -> (Tables, u64) {
    let done = AtomicU64::new(0);
    let workers = Workers::new(Some(threads)).unwrap();
    let points = study.points().unwrap();
    let tables = sweep(
        study,
        0..points,
        &Control {
            workers: &workers,
            chunk,
            cancel: &AtomicBool::new(cancel),
            progress: &|more| {
                done.fetch_add(more.points, Ordering::Relaxed);
            },
        },
    );
    (tables.unwrap(), done.into_inner())
}

fn refusal(study: &Study) -> String {
    let workers = Workers::new(Some(2)).unwrap();
    let cancel = AtomicBool::new(false);
    let refused = validate(study, &workers, &cancel, &|_| {}).unwrap_err().to_string();
    // A sweep of few points says the same before it runs any of them.
    if let Some(points) = study.points().ok().filter(|points| *points <= DESIGNED_FIRST) {
        let ran = AtomicU64::new(0);
        let progress = |more: Done| _ = ran.fetch_add(more.points, Ordering::Relaxed);
        for chunk in [None, Some(1), Some(3)] {
            let control =
                Control { workers: &workers, chunk, cancel: &cancel, progress: &progress };
            assert_eq!(sweep(study, 0..points, &control).unwrap_err().to_string(), refused);
        }
        assert_eq!(ran.into_inner(), 0);
    }
    refused
}

fn numbers(table: &RecordBatch, name: &str) -> Vec<Option<f64>> {
    table.column_by_name(name).unwrap().as_primitive::<Float64Type>().iter().collect()
}

#[test]
fn threads_and_chunks_change_nothing() {
    let study = clearance_study();
    let (reference, done) = run(&study, 1, None, false);
    assert_eq!(done, 444);
    for (threads, chunk) in [(1, Some(1)), (2, None), (2, Some(7)), (7, Some(100)), (7, None)] {
        let (tables, done) = run(&study, threads, chunk, false);
        assert_eq!(done, 444);
        assert_eq!(tables, reference, "{threads} threads, chunks of {chunk:?}");
    }
}

#[test]
fn rows_stand_in_the_order_of_point_last_axis_fastest() {
    let (tables, _) = run(&clearance_study(), 2, Some(5), false);
    let summary = &tables[&Table::Summary];
    let points: Vec<u32> = summary["point"].as_primitive::<UInt32Type>().values().to_vec();
    assert_eq!(points, (0..444).collect::<Vec<u32>>());
    let mass_ratios = numbers(summary, "mass_ratio");
    assert_eq!(mass_ratios[..5], [0.05, 0.1, 0.15, 0.2, 0.05].map(Some));
    let clearances = numbers(summary, "relative_clearance");
    assert_eq!((clearances[3], clearances[443]), (Some(0.1), Some(1.2)));
    let impacts = tables[&Table::Impacts]["point"].as_primitive::<UInt32Type>().values().to_vec();
    assert!(impacts.is_sorted());
}

/// True for columns that are defined in a decay only.
fn of_a_decay(column: &str) -> bool {
    column.starts_with("damping_ratio")
        || column.starts_with("settling_time")
        || column == "residual_amplitude"
}

/// True for columns that are defined under force only.
fn of_a_steady_state(column: &str) -> bool {
    let driven = ["reduction", "reduction_rms", "transmissibility", "impacts_per_cycle", "regime"];
    column.starts_with("amplitude_") || driven.contains(&column)
}

/// A cell of the wrong type would become null: in a scene with chatter every column of every table has
/// values, except those that are null by definition.
#[test]
fn rows_fit_their_columns() {
    for (mut study, driven) in [
        (Study::single(spec()), false),
        (Study::single(pendulum()), false),
        (Study { errors: true, ..Study::single(shaken()) }, true),
    ] {
        study.spec.replace(FieldId::RelativeClearance, 0.1).unwrap();
        study.spec.replace(FieldId::DampingRatio, 0.02).unwrap();
        study.measures = Selection::all();
        let without_angle = study.spec.choices().kind == Kind::Siva;
        if without_angle {
            study.spec.set(FieldId::ContactTime, 1e-3).unwrap();
        }
        let (tables, _) = run(&study, 1, None, false);
        for (table, batch) in &tables {
            assert_eq!(batch.num_rows() > 0, driven || *table != Table::Stroboscope, "{table}");
            assert_eq!(batch.num_columns(), columns(*table).len() + 1);
            for (field, column) in batch.schema().fields().iter().zip(batch.columns()) {
                let by_definition = match field.name().as_str() {
                    "log_decrement" => 2,
                    "release_time" => 1,
                    "gravity" | "angle" | "angular_velocity_before" | "angular_velocity_after"
                        if without_angle =>
                    {
                        batch.num_rows()
                    }
                    // A column of free masses only.
                    "peak_force_estimate" if !without_angle => batch.num_rows(),
                    "condition" | "digits" | "time_error" | "near_grazing" if !study.errors => {
                        batch.num_rows()
                    }
                    name if of_a_decay(name) && driven => 1,
                    name if of_a_steady_state(name) && !driven => 1,
                    _ => 0,
                };
                assert!(column.null_count() <= by_definition, "{table}.{}", field.name());
            }
        }
    }
}

/// Gravity is both a parameter and a column: if swept, it appears once, with the values of the axis.
#[test]
fn a_swept_parameter_is_no_column_besides() {
    let axis = Axis::new("gravity", vec![0.2, 0.20000000001]).unwrap();
    let study = Study { sampling: Sampling::Grid(vec![axis]), ..Study::single(pendulum()) };
    let (tables, _) = run(&study, 1, None, false);
    let summary = &tables[&Table::Summary];
    assert_eq!(summary.num_columns(), 1 + SUMMARY.len());
    assert_eq!(numbers(summary, "gravity"), [Some(0.2), Some(0.20000000001)]);
    // The next column still has its own values.
    assert_eq!(numbers(summary, "energy_work"), [Some(0.0); 2]);
}

/// Columns that are not asked for are null; the others keep their bits.
#[test]
fn measures_not_asked_for_are_null() {
    for (spec, foreign) in [
        (pendulum(), of_a_steady_state as fn(&str) -> bool),
        (shaken(), of_a_decay as fn(&str) -> bool),
    ] {
        let measures = Selection::all();
        let mut study = Study { errors: true, measures, ..Study::single(spec) };
        let (all, _) = run(&study, 1, None, false);
        for asked in SUMMARY.iter().map(|column| column.name) {
            study.measures = Selection::from_names([asked]).unwrap();
            let (some, _) = run(&study, 1, None, false);
            let (all, some) = (&all[&Table::Summary], &some[&Table::Summary]);
            for column in SUMMARY {
                let asked_for = column.name == asked || column.name == "outcome";
                // The contacts of a pendulum have no known duration.
                let foreign = foreign(column.name) || column.name == "peak_force_estimate";
                let there = asked_for && !foreign;
                assert_eq!(some[column.name].is_null(0), !there, "{} of {asked}", column.name);
                if asked_for {
                    assert_eq!(&some[column.name], &all[column.name], "{asked}");
                }
            }
        }
    }
}

#[test]
fn points_not_begun_when_cancelled_are_left_out() {
    let (tables, done) = run(&clearance_study(), 2, None, true);
    assert_eq!(done, 0);
    assert!(tables.values().all(|table| table.num_rows() == 0));
    assert_eq!(tables.len(), Table::SWEEP.len());
}

/// Cancellation: the first report of progress cancels a sweep with one point per chunk; the long point of the
/// second thread then has the outcome `cancelled` and no measures of the whole run.
#[test]
fn a_point_under_way_when_cancelled_says_so() {
    let mut study = clearance_study();
    study.sampling = Sampling::Grid(vec![Axis::new("periods", vec![1.0, 1e7, 1.0]).unwrap()]);
    let workers = Workers::new(Some(2)).unwrap();
    let cancel = AtomicBool::new(false);
    let tables = sweep(
        &study,
        0..3,
        &Control {
            workers: &workers,
            chunk: Some(1),
            cancel: &cancel,
            progress: &|_| cancel.store(true, Ordering::Relaxed),
        },
    )
    .unwrap();
    let summary = &tables[&Table::Summary];
    let outcomes: Vec<&str> = summary["outcome"].as_string::<i32>().iter().flatten().collect();
    assert!(outcomes.contains(&"finished"), "{outcomes:?}");
    for (row, outcome) in outcomes.iter().enumerate() {
        let whole = *outcome == "finished";
        assert!(whole || *outcome == "cancelled");
        assert!(whole || summary["settling_time_5"].is_null(row));
    }
}

#[test]
fn a_bad_point_is_named_before_anything_runs() {
    let mut study = clearance_study();
    study.spec.set(FieldId::GapDisplacement, 0.3).unwrap();
    let message = refusal(&study);
    assert!(message.contains("start.gap_displacement = 0.3"), "{message}");
    assert!(message.contains("point 0"), "{message}");
}

#[test]
fn two_axes_over_one_quantity_are_refused() {
    let mut study = clearance_study();
    let Sampling::Grid(axes) = &mut study.sampling else { unreachable!() };
    axes.push(Axis::new("gap", vec![1.0]).unwrap());
    let message = refusal(&study);
    assert!(message.contains("sweep.gap") && message.contains("sweep.relative_clearance"));
}

#[test]
fn too_many_points_are_refused_without_allocating() {
    let many = vec![0.5; 70_000];
    let study = Study {
        sampling: Sampling::Grid(vec![
            Axis::new("relative_clearance", many.clone()).unwrap(),
            Axis::new("mass_ratio", many).unwrap(),
        ]),
        ..Study::single(spec())
    };
    let message = refusal(&study);
    assert!(message.contains("70000 × 70000") && message.contains("2^32"), "{message}");
}

/// A scene under two harmonics, so that `reduction` needs a run without absorber.
fn beaten() -> Spec {
    let mut spec = shaken();
    spec.add_force(ForceSpec::new(None));
    let slot = |field: FieldId| Slot { number: Some(1), ..field.into() };
    spec.set(slot(FieldId::BaseAcceleration), 0.2).unwrap();
    spec.set(slot(FieldId::RelativeFrequency), 1.3).unwrap();
    spec
}

#[test]
fn a_brief_run_has_the_rows_of_a_sweep_or_none() {
    for spec in [spec(), pendulum(), shaken()] {
        let study = Study { errors: true, ..Study::single(spec) };
        let (whole, _) = run(&study, 1, None, false);
        let spent = work_of(&study);
        assert_eq!(run_inline(&study, spent).unwrap().as_ref(), Some(&whole));
        assert_eq!(run_inline(&study, spent - 1).unwrap(), None);
    }
}

/// A run must not be cut short if it ends at the user's own limit, or if it needs a run without absorber,
/// which may take longer than the run itself.
#[test]
fn a_brief_run_is_never_cut_in_what_it_shows() {
    let mut study = Study::single(spec());
    study.spec.set(FieldId::MaxWork, 10.0).unwrap();
    let (whole, _) = run(&study, 1, None, false);
    assert_eq!(whole[&Table::Summary]["outcome"].as_string::<i32>().value(0), "work_limit");
    assert_eq!(run_inline(&study, 10).unwrap(), Some(whole));
    let study = Study::single(beaten());
    let (whole, _) = run(&study, 1, None, false);
    assert!(numbers(&whole[&Table::Summary], "reduction")[0].is_some());
    assert_eq!(run_inline(&study, 1_000_000).unwrap(), None);
}

/// Number of stretches of motion of a study of one point.
fn work_of(study: &Study) -> u64 {
    let design = study.design(0).unwrap();
    match design.scene {
        Scene::Siva(it) => tally(&it.system, &it.start, &design.limits),
        Scene::DrivenSiva(it) => tally(&it.system, &it.start, &design.limits),
        Scene::Modal(it) => tally(&it.system, &it.start, &design.limits),
        Scene::FewModes(it) => tally(&it.system, &it.start, &design.limits),
        Scene::Piva(it) => tally(&it.system, &it.start, &design.limits),
    }
}

fn tally<S: Absorber<Real = f64>>(system: &S, start: &S::Start, limits: &Limits) -> u64 {
    simulate(system, start, limits, None, &mut ()).unwrap().work
}
