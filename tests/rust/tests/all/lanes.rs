//! Runs side by side equal single runs bit for bit.
//!
//! Everything that `side_by_side::run` hands out is compared. Floats are printed with all their digits, so equal
//! texts are equal bits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use iva_core::absorber::{Absorber, Start};
use iva_core::force::{Acts, Force, Harmonic};
use iva_core::host::DrivenHost;
use iva_core::measures::Wanted;
use iva_core::piva::{Angles, Given, Parameters, Piva, PivaStart};
use iva_core::run::side_by_side::{self, Job, LANES, SideBySide, Tier};
use iva_core::simulate::{Limits, Outcome};
use iva_core::siva::Siva;
use iva_core::steady::{SteadyWanted, Window};
use iva_tests::case::{any_case, compound};
use iva_tests::cases;
use iva_tests::pendulum_list::still;
use proptest::prelude::*;

use crate::side_by_side::{alone, alone_wanting, together, together_wanting};

fn scene(mu: f64, e: f64, clearance: f64, zeta: f64, periods: f64) -> Job<Siva> {
    Job {
        begin: 0.0,
        system: Siva::new(mu, e, clearance, zeta).unwrap(),
        start: Start { displacement: 1.0, ..Start::default() },
        limits: Limits::new(periods * TAU, clearance),
        steady: None,
        tier: Tier::Exact,
    }
}

/// Wide and narrow gaps, chatter, plastic and elastic impacts, light and heavy damping.
fn grid() -> Vec<Job<Siva>> {
    let mut scenes = Vec::new();
    for zeta in [0.0, 0.01, 0.3, 1.0, 2.0] {
        for clearance in [0.05, 0.3, 0.6, 1.1, 1.9, 2.0, 2.5] {
            for e in [0.0, 0.3, 0.6, 0.95, 1.0] {
                scenes.push(scene(0.1, e, clearance, zeta, 15.0));
            }
        }
    }
    scenes
}

/// Pendulums that reach their walls often, rarely or never, with hard and soft walls, with and without pivot
/// damping.
fn pendulums(tolerance: f64) -> Vec<Job<Piva<DrivenHost>>> {
    let mut scenes = Vec::new();
    for (zeta, zeta_p) in [(0.0, 0.0), (0.02, 0.0), (0.02, 0.05), (1.2, 0.0)] {
        for clearance in [0.05, 0.4, 0.8, 1.4, 1.95, 3.0] {
            for e in [0.0, 0.4, 0.8, 1.0] {
                let parameters = Parameters {
                    frequency_ratio: 0.4 + 0.2 * e,
                    pivot_damping_ratio: zeta_p,
                    tolerance,
                    ..Parameters::point_bob(0.12, e, clearance, zeta, 2.5)
                };
                scenes.push(Job {
                    begin: 0.0,
                    system: still(&Piva::new(parameters).unwrap()),
                    start: Start { displacement: 1.0, ..Start::default() }.into(),
                    limits: Limits::new(15.0 * TAU, clearance),
                    steady: None,
                    tier: Tier::Exact,
                });
            }
        }
    }
    scenes
}

/// Lanes of decays do not measure a steady state: if one is wanted, the runs go one by one.
#[test]
fn decays_whose_steady_state_is_asked_for_are_the_same() {
    let steady = Some((SteadyWanted::ALL, Window { from: 3.0, cycle: None }));
    let masses: Vec<_> = grid().into_iter().map(|job| Job { steady, ..job }).collect();
    for (job, found) in masses.iter().zip(&together(&masses)).step_by(7) {
        assert_eq!(*found, alone(job));
    }
    let swinging: Vec<_> = pendulums(0.0).into_iter().map(|job| Job { steady, ..job }).collect();
    for (job, found) in swinging.iter().zip(&together(&swinging)).step_by(7) {
        assert_eq!(*found, alone(job));
    }
}

#[test]
fn pendulums_are_the_same_side_by_side() {
    // One tolerance for each order of the series.
    for tolerance in [0.0, 1e-12, 1e-9, 1e-6] {
        let scenes = pendulums(tolerance);
        let found = together(&scenes);
        for (scene, found) in scenes.iter().zip(&found) {
            assert_eq!(*found, alone(scene), "{:?}", scene.system.parameters());
        }
        let backwards: Vec<Job<Piva<DrivenHost>>> = scenes.iter().rev().cloned().collect();
        assert!(together(&backwards).iter().rev().eq(&found));
    }
    let mut linear = pendulums(0.0);
    for Job { system, .. } in &mut linear {
        let small = Parameters { angles: Angles::Small, ..*system.parameters() };
        *system = still(&Piva::new(small).unwrap());
    }
    for (scene, found) in linear.iter().zip(&together(&linear)) {
        assert_eq!(*found, alone(scene), "{:?}", scene.system.parameters());
    }
}

#[test]
fn pendulums_of_many_kinds_keep_apart() {
    // Different tolerances and small angles: these cannot all share lanes.
    let mut scenes: Vec<Job<Piva<DrivenHost>>> = [0.0, 1e-9]
        .into_iter()
        .flat_map(|tolerance| pendulums(tolerance).into_iter().step_by(5))
        .collect();
    for (i, scene) in scenes.iter_mut().enumerate() {
        let angles = if i % 4 == 1 { Angles::Small } else { Angles::Large };
        let parameters = Parameters { angles, ..*scene.system.parameters() };
        scene.system = still(&Piva::new(parameters).unwrap());
        let (max_impacts, max_work) =
            ([3, 10, 10_000_000][i % 3], [23, 1000, 100_000_000][i / 3 % 3]);
        let duration = [0.5, TAU, 2.0 * TAU, 2.0 * TAU + 1e-15, 9.0, 100.0][i % 6];
        scene.limits = Limits { duration, max_impacts, max_work, ..scene.limits };
    }
    let found = together(&scenes);
    for (scene, found) in scenes.iter().zip(&found) {
        assert_eq!(*found, alone(scene), "{:?}", scene.system.parameters());
    }
    for outcome in ["Finished", "ImpactLimit", "WorkLimit"] {
        assert!(found.iter().any(|run| run.contains(outcome)), "none is {outcome}");
    }
    // Two in three under a force, the others on a structure that could have one.
    let push = Harmonic { amplitude: 0.1, frequency: 0.9, phase: 0.2, acts: Acts::Primary };
    let forces = [vec![push], vec![]].map(|harmonics| Force::harmonic(harmonics).unwrap());
    let under = |(i, job): (usize, &Job<Piva<DrivenHost>>)| {
        let Job { begin, start, limits, steady, tier, .. } = *job;
        let piva = Piva::new(*job.system.parameters()).unwrap();
        let system = piva.under(forces[i % 3 / 2].clone());
        Job { system, begin, start, limits, steady, tier }
    };
    let driven: Vec<_> = scenes.iter().enumerate().map(under).collect();
    for (scene, found) in driven.iter().zip(&together(&driven)) {
        assert_eq!(*found, alone(scene), "{:?}", scene.system.parameters());
    }
}

#[test]
fn a_grid_is_the_same_side_by_side() {
    let scenes = grid();
    for (scene, found) in scenes.iter().zip(together(&scenes)) {
        assert_eq!(found, alone(scene), "{:?}", scene.limits);
    }
}

#[test]
fn losses_not_asked_for_change_nothing_else() {
    let wanted = Wanted { ledger: false, ..Wanted::ALL };
    let other = |run: &str| run.split("energy_initial").next().unwrap().to_owned();
    fn check<S: SideBySide>(scenes: &[Job<S>], wanted: Wanted, other: impl Fn(&str) -> String) {
        for (scene, found) in scenes.iter().zip(together_wanting(scenes, wanted)) {
            assert_eq!(found, alone_wanting(scene, wanted));
            // The rest of the summary, without the energies, is the same.
            assert_eq!(other(&found), other(&alone(scene)));
            assert!(found.contains("energy_viscous: 0.0, energy_pivot: 0.0,"));
        }
    }
    check(&grid(), wanted, other);
    check(&pendulums(1e-9), wanted, other);
}

/// Lanes of free decays without measures of the displacement, with losses and without; some start at x = 0.
#[test]
fn decays_of_which_little_is_asked_are_the_same() {
    for (ledger, first_period) in [(true, true), (true, false), (false, true), (false, false)] {
        let wanted = Wanted { ledger, first_period, ..Wanted::NONE };
        let mut scenes = grid();
        for scene in scenes.iter_mut().step_by(3) {
            scene.start = Start { velocity: 1.0, ..Start::default() };
        }
        for (scene, found) in scenes.iter().zip(together_wanting(&scenes, wanted)) {
            assert_eq!(found, alone_wanting(scene, wanted), "{:?}", scene.limits);
        }
    }
}

#[test]
fn neighbours_change_nothing() {
    let scenes = grid();
    let whole = together(&scenes);
    // In reverse order, and in groups of other sizes: other lanes, other neighbours.
    let backwards: Vec<Job<Siva>> = scenes.iter().rev().cloned().collect();
    assert!(together(&backwards).iter().rev().eq(&whole));
    for size in [1, 3, LANES, LANES + 1] {
        let parts = scenes.chunks(size).flat_map(together);
        assert!(parts.eq(whole.iter().cloned()), "groups of {size}");
    }
}

#[test]
fn limits_stop_each_run_where_it_is() {
    let mut scenes = Vec::new();
    for (i, decay) in grid().into_iter().enumerate() {
        let (max_impacts, max_work) =
            ([3, 10, 10_000_000][i % 3], [17, 1000, 100_000_000][i / 3 % 3]);
        // Some runs end close to the instants that the measures look at.
        let duration = [0.5, TAU, 2.0 * TAU, 2.0 * TAU + 1e-15, 9.0, 100.0][i % 6];
        let limits = Limits { duration, max_impacts, max_work, ..decay.limits };
        scenes.push(Job { limits, ..decay });
    }
    let found = together(&scenes);
    for (scene, found) in scenes.iter().zip(&found) {
        assert_eq!(*found, alone(scene), "{:?}", scene.limits);
    }
    for outcome in ["Finished", "ImpactLimit", "WorkLimit"] {
        assert!(found.iter().any(|run| run.contains(outcome)), "none is {outcome}");
    }
}

#[test]
fn cancelled_runs_come_back_as_they_are() {
    // Elastic and undamped runs, which end by the cancellation only: that of the first, when the others beside it have
    // come as far.
    let limits = |periods: f64, clearance| Limits {
        max_impacts: 1 << 53,
        max_work: 1 << 53,
        ..Limits::new(periods * TAU, clearance)
    };
    let runs: Vec<Job<Siva>> = (0..40)
        .map(|i| {
            let clearance = 0.01 + 0.001 * f64::from(i);
            let limits = limits(if i == 0 { 1.0 } else { 1e15 }, clearance);
            Job { limits, ..scene(0.1, 1.0, clearance, 0.0, 1.0) }
        })
        .collect();
    let cancel = AtomicBool::new(false);
    let mut found = Vec::new();
    side_by_side::run(&runs, Wanted::ALL, Some(&cancel), &mut |i, (tally, ..)| {
        cancel.store(true, Ordering::Relaxed);
        found.push((i, tally.outcome, tally.impacts));
    })
    .unwrap();
    // No more runs have begun than go side by side at most.
    assert!(found.len() > 1 && found.len() <= 2 * LANES, "{found:?}");
    for (i, outcome, impacts) in found {
        assert_eq!(outcome, if i == 0 { Outcome::Finished } else { Outcome::Cancelled });
        assert!(impacts > 0);
    }
}

#[test]
fn a_bad_start_is_refused_before_anything_runs() {
    let mut scenes = grid();
    scenes[7].start.gap_displacement = 100.0;
    let mut taken = 0;
    let error = side_by_side::run(&scenes, Wanted::ALL, None, &mut |_, _| taken += 1).unwrap_err();
    assert_eq!((error.field.as_str(), taken), ("start.gap_displacement", 0));
}

/// The restitution at wall −, if it is another one; the middle of the gap, in clearances; the begin of the run.
fn unlike() -> impl Strategy<Value = (Option<f64>, f64, f64)> {
    let either = |other: std::ops::Range<f64>| prop_oneof![Just(0.0), other];
    (proptest::option::of(0.0..=1.0), either(-1.5..1.5), either(0.0..9.0))
}

proptest! {
    #![proptest_config(cases(60))]

    /// For any start and parameters; the runs of a group have one damping ratio.
    #[test]
    fn random_runs_are_the_same_side_by_side(
        all in prop::collection::vec((any_case(1.0, 60.0), unlike()), 3 * LANES),
        zeta in prop_oneof![Just(0.0), 0.0..0.2, 0.0..3.0],
    ) {
        let scenes: Vec<Job<Siva>> = all
            .iter()
            .map(|(case, (e_minus, offset, begin))| {
                let siva = Siva::new(case.mu, case.e, case.clearance, zeta).unwrap();
                let offset = offset * case.clearance;
                let system = siva.with_offset(offset).unwrap();
                let system = system.with_restitution_minus(e_minus.unwrap_or(case.e)).unwrap();
                let gap_displacement = case.start.gap_displacement + offset;
                let start = Start { gap_displacement, ..case.start };
                let mut limits = case.limits();
                limits.duration += begin;
                Job { begin: *begin, system, start, limits, steady: None, tier: Tier::Exact }
            })
            .filter(|scene| scene.system.check_start(&scene.start).is_ok())
            .collect();
        for (scene, found) in scenes.iter().zip(together(&scenes)) {
            prop_assert_eq!(found, alone(scene));
        }
    }

    /// For any start and pendulum.
    #[test]
    fn random_pendulums_are_the_same_side_by_side(
        all in prop::collection::vec((compound(), any_case(1.0, 60.0), -3.1..3.1), 3 * LANES),
        tolerance in prop_oneof![2 => Just(0.0), 1 => Just(1e-9), 1 => Just(1e-6)],
    ) {
        let scenes: Vec<Job<Piva<DrivenHost>>> = all
            .iter()
            .map(|(parameters, case, angle)| {
                let system = still(&Piva::new(Parameters { tolerance, ..*parameters }).unwrap());
                let start = PivaStart::from(Start {
                    gap_displacement: case.start.gap_displacement / case.clearance,
                    ..case.start
                });
                let free = !system.stop_reachable();
                let start = if free { PivaStart { place: Given::Angle(*angle), ..start } } else { start };
                let limits = Limits::new(case.duration, system.clearance());
                Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Exact }
            })
            .filter(|scene| scene.system.check_start(&scene.start).is_ok())
            .collect();
        for (scene, found) in scenes.iter().zip(together(&scenes)) {
            prop_assert_eq!(found, alone(scene));
        }
    }
}
