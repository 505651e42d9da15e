//! The nine reference decays: every event found, none added, times and velocities within rounding.
//!
//! The numbers are those of `tests/reference` (50 digits, an independent program). The bound on
//! an event time is the contract of the project: six rounding units, with the condition number of
//! each event as the reference gives it. For velocities the reference gives no condition; it
//! comes from the double-double oracle of this crate, which the first test here checks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    run::run,
    simulate::{Limits, Outcome},
};
use iva_tests::{
    U, UNITS_ALLOWED,
    dd::Dd,
    oracle::{self, Event, Kind},
    reference::{Reference, scenes},
    timeline::{listed, marks},
    units,
};

/// Approach speed at or below which impacts of a chatter are missing in the lists.
const FLOOR: f64 = 1e-9;

/// The oracle's events of a reference scene, without the impacts that are missing in the reference.
fn oracle_events(reference: &Reference) -> Vec<Event> {
    oracle::events(&reference.scene, 5000)
}

#[test]
fn the_oracle_reproduces_the_reference() {
    for reference in scenes() {
        let all = oracle_events(&reference);
        let events: Vec<_> = all.iter().filter(|e| listed(e, FLOOR)).collect();
        assert_eq!(events.len(), reference.events.len(), "{}", reference.name);
        for (event, expected) in events.iter().zip(&reference.events) {
            assert_eq!((event.kind, event.wall), (expected.kind, expected.wall));
            let time = units(
                (event.time - expected.time).value(),
                expected.condition,
                expected.time.value(),
            );
            assert!(time < 0.005, "{}: {time} units at {}", reference.name, expected.time.value());
            if event.kind == Kind::Impact {
                let velocity = (event.velocity[0] - expected.velocity).value();
                let approach = (event.gap_velocity[0] - expected.approach).value();
                assert!(velocity.abs().max(approach.abs()) < 1e-17, "{}", reference.name);
            }
        }
    }
}

#[test]
fn every_event_is_found_none_added_and_times_are_right_to_six_units() {
    let mut failures = Vec::new();
    for reference in scenes() {
        let scene = &reference.scene;
        let limits =
            Limits { chatter_floor: FLOOR, ..Limits::new(scene.duration, scene.clearance.hi) };
        let result = run(&scene.absorber(), &scene.begin(), &limits).unwrap();
        assert_eq!(result.tally.outcome, Outcome::Finished);
        assert_eq!(result.tally.undecided, 0, "{}", reference.name);
        let list = marks(&result, FLOOR);
        let kinds: Vec<_> = list.iter().map(|f| (f.kind, f.wall)).collect();
        let expected: Vec<_> = reference.events.iter().map(|e| (e.kind, e.wall)).collect();
        if kinds != expected {
            let first = kinds.iter().zip(&expected).position(|(a, b)| a != b);
            failures.push(format!(
                "{}: {} events instead of {}, first difference {first:?}",
                reference.name,
                kinds.len(),
                expected.len()
            ));
            continue;
        }
        let all = oracle_events(&reference);
        let conditions = |measure: fn(&Event) -> Dd| -> Vec<f64> {
            let all_conditions = oracle::conditions(scene, &all, measure);
            all.iter()
                .zip(all_conditions)
                .filter(|(e, _)| listed(e, FLOOR))
                .map(|(_, c)| c)
                .collect()
        };
        let primary = conditions(|e| e.velocity[0]);
        let absorber = conditions(|e| e.velocity[0] + e.gap_velocity[0]);
        let gap = conditions(|e| e.gap_velocity[0]);
        let mut time_units = Vec::new();
        let mut velocity_units = Vec::new();
        for (k, (event, expected)) in list.iter().zip(&reference.events).enumerate() {
            let tau = expected.time.value();
            let error = (Dd::from(event.time) - expected.time).value();
            time_units.push(units(error, expected.condition, tau));
            if let Some(velocities) = event.velocities {
                let truth = [expected.velocity, expected.absorber_velocity, expected.approach];
                for ((value, truth), c) in
                    velocities.iter().zip(truth).zip([primary[k], absorber[k], gap[k]])
                {
                    velocity_units.push(units((Dd::from(*value) - truth).value(), c, tau));
                }
            }
        }
        println!(
            "{:24} {:4} events  time: median {:.2} worst {:.2} units  velocity: median {:.2} worst {:.2}",
            reference.name,
            list.len(),
            median(&time_units),
            worst(&time_units),
            median(&velocity_units),
            worst(&velocity_units)
        );
        for (what, list) in [("time", &time_units), ("velocity", &velocity_units)] {
            if worst(list) > UNITS_ALLOWED {
                failures.push(format!(
                    "{}: {what} off by {:.2} units",
                    reference.name,
                    worst(list)
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn approach_speeds_of_a_chatter_keep_their_relative_accuracy() {
    // The scene has 18 chatters, e = 0.5: over one rebound u⁺ = e u (1 − …), so down to 1e-9 the error of the
    // approach speed must be small relative to itself, not only absolutely. A relative change of 2⁻⁵³ of the
    // state at the first impact of a chatter changes u by condition · 2⁻⁵³; the low rebounds inherit this
    // change in proportion to their size.
    let reference = scenes().into_iter().find(|s| s.name == "siva_gamma_0.1_chatter").unwrap();
    let scene = &reference.scene;
    let limits = Limits { chatter_floor: FLOOR, ..Limits::new(scene.duration, scene.clearance.hi) };
    let result = run(&scene.absorber(), &scene.begin(), &limits).unwrap();
    let all = oracle_events(&reference);
    let conditions = oracle::conditions(scene, &all, |e| e.gap_velocity[0]);
    let truth: Vec<_> = all
        .iter()
        .zip(conditions)
        .filter(|(e, _)| e.kind == Kind::Impact && listed(e, FLOOR))
        .collect();
    assert_eq!(result.impacts.len(), truth.len());
    let mut rebounds = 0.0;
    for (impact, (event, condition)) in result.impacts.iter().zip(truth) {
        // Every rebound of the chain adds a few roundings relative to u itself.
        rebounds = if event.gap_velocity[0].abs().hi < 0.1 { rebounds + 1.0 } else { 0.0 };
        let u = event.gap_velocity[0].abs().hi;
        let error = (Dd::from(impact.gap_velocity_before) - event.gap_velocity[0]).abs().hi;
        let allowed = UNITS_ALLOWED * U * (condition + u * (rebounds + 1.0) + u * event.time.hi);
        assert!(error <= allowed, "t = {}: u = {u}, {error:e} > {allowed:e}", impact.time);
    }
}

fn worst(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
