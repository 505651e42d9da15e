use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, StringArray, UInt32Array, UInt64Array};
use iva_sweep::axis::Axis;
use iva_sweep::columns::Selection;
use iva_sweep::design::Spec;
use iva_sweep::sampling::Sampling;

use super::*;

const FINISHED: &str = "finished";

fn study() -> Study {
    let mut study = Study::single(Spec::default());
    study.sampling = Sampling::Grid(vec![
        Axis::linspace("relative_clearance", 0.1, 0.4, 4).unwrap(),
        Axis::new("mass_ratio", vec![0.1, 0.2]).unwrap(),
    ]);
    study
}

fn rows(name: &str, values: &[Option<f64>], outcomes: &[&str]) -> RecordBatch {
    rows_from(0, name, values, outcomes)
}

fn rows_from(first: u32, name: &str, values: &[Option<f64>], outcomes: &[&str]) -> RecordBatch {
    let points = UInt32Array::from_iter_values((first..).take(values.len()));
    let columns: [(&str, ArrayRef); 4] = [
        ("point", Arc::new(points)),
        ("outcome", Arc::new(StringArray::from(outcomes.to_vec()))),
        (name, Arc::new(Float64Array::from(values.to_vec()))),
        ("impacts", Arc::new(UInt64Array::from(vec![12; values.len()]))),
    ];
    RecordBatch::try_from_iter(columns).unwrap()
}

fn best(name: &'static str, count: usize) -> BestPoints {
    let report = Report { best_by: Some(name), count };
    BestPoints::new(&report, &study()).unwrap()
}

#[test]
fn settling_times_rise_and_damping_ratios_fall() {
    let values = [Some(3.0), Some(1.0), None, Some(2.0)];
    for (name, order) in [
        ("settling_time_2", [1, 3, 0, 2]),
        ("residual_amplitude", [1, 3, 0, 2]),
        ("damping_ratio_3", [0, 3, 1, 2]),
    ] {
        let mut best = best(name, 10);
        best.add(&rows(name, &values, &[FINISHED; 4]));
        assert_eq!(best.points().collect::<Vec<_>>(), order, "{name}");
    }
}

#[test]
fn batches_do_not_change_the_order_and_ties_keep_it() {
    let name = "settling_time_5";
    let values = [5.0, 4.0, 4.0, 1.0, 4.0, 0.5, 9.0, 1.0].map(Some);
    let mut whole = best(name, 5);
    whole.add(&rows(name, &values, &[FINISHED; 8]));
    let mut parts = best(name, 5);
    parts.add(&rows(name, &values[..3], &[FINISHED; 3]));
    parts.add(&rows_from(3, name, &values[3..], &[FINISHED; 5]));
    let order: Vec<u64> = whole.points().collect();
    assert_eq!(order, [5, 3, 7, 1, 2]);
    assert_eq!(parts.points().collect::<Vec<_>>(), order);
}

#[test]
fn what_is_not_ranked_is_said() {
    let name = "settling_time_5";
    let mut best = best(name, 2);
    let values = [Some(3.0), None, Some(0.1), Some(2.0), None];
    let outcomes = [FINISHED, FINISHED, "impact_limit", FINISHED, "work_limit"];
    best.add(&rows(name, &values, &outcomes));
    assert_eq!(best.points().collect::<Vec<_>>(), [3, 0]);
    let text = best.print(&study(), UnitSystem::Natural);
    assert!(text.contains("Best 2 of 5 points by settling_time_5 (smallest first)"), "{text}");
    assert!(text.contains("1 of 3 points that finished has no settling_time_5"), "{text}");
    assert!(
        text.contains("2 points did not finish and are not ranked: 1 impact_limit, 1 work_limit."),
        "{text}"
    );
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let first = text.lines().position(|line| line.contains("2.000")).unwrap();
    let cells: Vec<&str> = text.lines().nth(first).unwrap().split_whitespace().collect();
    assert_eq!(cells[..4], ["3", "0.2", "0.2", "2.000"], "{text}");
}

#[test]
fn points_without_any_impact_are_pointed_out() {
    let name = "settling_time_5";
    let columns: [(&str, ArrayRef); 3] = [
        ("outcome", Arc::new(StringArray::from(vec![FINISHED; 3]))),
        (name, Arc::new(Float64Array::from(vec![3.0, 1.0, 2.0]))),
        ("impacts", Arc::new(UInt64Array::from(vec![0, 7, 0]))),
    ];
    let mut best = best(name, 2);
    best.add(&RecordBatch::try_from_iter(columns).unwrap());
    let text = best.print(&study(), UnitSystem::Natural);
    assert!(text.contains("At 1 point of these the absorber never touches a wall"), "{text}");
}

#[test]
fn a_missing_value_is_explained_by_its_measure() {
    for (name, why) in [
        ("damping_ratio_10", "fewer peaks than it needs"),
        ("damping_ratio_fit", "fewer peaks than it needs"),
        ("damping_ratio_energy", "shorter than a period"),
        ("residual_amplitude", "shorter than a period"),
        ("settling_time_2", "not settled by the end"),
    ] {
        let mut best = best(name, 2);
        best.add(&rows(name, &[None, Some(1.0)], &[FINISHED; 2]));
        let text = best.print(&study(), UnitSystem::Natural).replace('\n', " ");
        assert!(text.contains(why), "{name}: {text}");
    }
}

#[test]
fn a_sweep_without_any_value_says_so() {
    let mut best = best("settling_time_5", 3);
    best.add(&rows("settling_time_5", &[None, None], &["not_finite"; 2]));
    let text = best.print(&study(), UnitSystem::Si);
    assert!(text.contains("2 points did not finish"), "{text}");
    assert!(!text.contains("Best"), "{text}");
}

#[test]
fn a_report_by_a_measure_that_is_not_computed_is_no_report() {
    let measures = Selection::from_names(["impacts"]).unwrap();
    assert_eq!(Report::new(measures, &study().spec).best_by, None);
    assert!(BestPoints::new(&Report::new(measures, &study().spec), &study()).is_none());
}
