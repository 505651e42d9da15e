//! Runs side by side equal single runs bit for bit.
//!
//! Everything that `lanes::run` hands out is compared. Floats are printed with all their digits, so equal
//! texts are equal bits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use iva_core::extremes::Extremes;
use iva_core::force::{Acts, Force, Harmonic, Impulse};
use iva_core::host::DrivenHost;
use iva_core::lanes::{self, Ended, Job, LANES, Listed, Listing, NewPass, SideBySide, Tier};
use iva_core::measures::near_wall::NearWall;
use iva_core::measures::pass::{Pass, Passes};
use iva_core::measures::{Measures, Wanted};
use iva_core::observe::Events;
use iva_core::piva::{Angles, Given, Parameters, Piva, PivaStart};
use iva_core::propagation::Errors;
use iva_core::simulate::{Limits, Outcome, simulate, simulate_from};
use iva_core::siva::Siva;
use iva_core::steady::{Steady, SteadyWanted, Window};
use iva_core::summary::Summary;
use iva_core::system::{Start, System};
use iva_tests::case::{any_case, compound};
use iva_tests::cases;
use proptest::prelude::*;

fn alone<S: SideBySide>(decay: &Job<S>) -> String {
    alone_wanting(decay, Wanted::ALL)
}

pub(crate) fn alone_wanting<S: SideBySide>(decay: &Job<S>, wanted: Wanted) -> String {
    let Job { system, start, begin, limits, steady, .. } = decay;
    let from = steady.map_or(*begin, |(_, window)| window.from);
    let looks = (Extremes::new(from), Passes::new(from, vec![near_wall()]));
    let observers = ((Events::default(), Errors::default()), looks);
    let wanted = Wanted { envelope: true, ..wanted };
    let mut watch = (Summary::<S>::new(wanted, decay.steady), observers);
    let tally = simulate_from(system, start, *begin, limits, None, &mut watch).unwrap();
    let (summary, ((events, errors), (extremes, passes))) = watch;
    let ended = (tally, *summary.values(), summary.steady_values().copied());
    let (peaks, strobes) = (summary.envelope(), summary.steady().and_then(Steady::all_strobes));
    let (extremes, passes) = (Some(*extremes.values()), passes.values().collect::<Vec<_>>());
    let seen = format!("{peaks:?} {strobes:?} {extremes:?} {passes:?}");
    format!("{ended:?} {events:?} {} {seen}", told(&errors))
}

fn near_wall() -> Box<dyn Pass<f64>> {
    Box::new(NearWall::default())
}

/// What users are told of errors.
fn told(errors: &Errors) -> String {
    format!("{:?} {:?} {:?}", errors.impacts, errors.condition(), errors.digits())
}

fn together<S: SideBySide>(scenes: &[Job<S>]) -> Vec<String> {
    together_wanting(scenes, Wanted::ALL)
}

pub(crate) fn together_wanting<S: SideBySide>(scenes: &[Job<S>], wanted: Wanted) -> Vec<String> {
    let mut found = vec![String::new(); scenes.len()];
    lanes::run(scenes, wanted, None, &mut |i, decayed: &Ended<S>| {
        assert!(found[i].is_empty(), "scene {i} came twice");
        found[i] = format!("{decayed:?}");
    })
    .unwrap();
    // The same runs with their impacts and stick episodes, and with errors, or peaks, or what looks within flights.
    let of = |events, errors, envelope, extremes| {
        let passes: Vec<NewPass> = if extremes { vec![near_wall] } else { Vec::new() };
        Listing { events, errors, envelope, extremes, passes }
    };
    let listings = [
        of(true, true, false, false),
        of(true, false, true, false),
        of(false, false, false, true),
        of(true, true, true, true),
    ];
    let mut listed = listings.map(|listing| {
        let mut listed = vec![Listed::default(); scenes.len()];
        lanes::run_listed(scenes, (wanted, &listing), None, &mut |i, ended: &Ended<S>, more| {
            assert_eq!(found[i], format!("{ended:?}"), "scene {i} by {listing:?}");
            listed[i] = more;
        })
        .unwrap();
        listed
    });
    for i in 0..scenes.len() {
        let [estimated, peaked, looked, all] =
            listed.each_mut().map(|listed| std::mem::take(&mut listed[i]));
        let seen = |it: &Listed| format!("{:?} {:?}", it.extremes, it.passes);
        assert_eq!(seen(&looked), seen(&all), "scene {i}");
        assert_eq!(looked.strobes, all.strobes, "scene {i}");
        assert_eq!(all.events, peaked.events, "scene {i}");
        assert_eq!(all.envelope, peaked.envelope, "scene {i}");
        assert_eq!(estimated.events, peaked.events, "scene {i}");
        let (events, errors) = (peaked.events.unwrap(), told(&estimated.errors.unwrap()));
        assert_eq!(told(&all.errors.unwrap()), errors, "scene {i}");
        let (peaks, strobes) = (peaked.envelope.unwrap(), peaked.strobes);
        assert_eq!(estimated.strobes, strobes, "scene {i}");
        let seen = format!("{peaks:?} {strobes:?} {}", seen(&looked));
        found[i] = format!("{} {events:?} {errors} {seen}", found[i]);
    }
    found
}

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
fn pendulums(tolerance: f64) -> Vec<Job<Piva>> {
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
                    system: Piva::new(parameters).unwrap(),
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

/// Free masses under force: light and heavy, slow and fast, with and without damping, some with chatter or
/// sticking, most with a transient that is left out; a third on a moving base, a few under two forces, or
/// with an impulse.
fn driven(steady: SteadyWanted) -> Vec<Job<Siva<DrivenHost>>> {
    let mut jobs = Vec::new();
    for (number, zeta) in [0.0, 0.02, 0.3, 1.1].into_iter().enumerate() {
        for clearance in [0.05, 0.4, 1.1, 30.0] {
            for (e, frequency) in [(0.0, 0.7), (0.3, 1.0), (0.7, 1.05), (0.95, 2.3), (1.0, 0.31)] {
                let i = jobs.len();
                let amplitude = [0.05, 0.3, 1.0][i % 3];
                let phase = [0.0, 0.8, -7.0][i / 3 % 3];
                let acts = if i % 3 == 1 { Acts::Base } else { Acts::Primary };
                let push = Harmonic { amplitude, frequency, phase, acts };
                let more = (i % 17 == 3).then_some(Harmonic { frequency: 1.7, ..push });
                let hit = (i % 19 == 4).then_some(Impulse { velocity: 0.3, time: 11.0 });
                let harmonics = [push].into_iter().chain(more).collect();
                let force = Force::new(harmonics, Vec::new(), hit.as_slice()).unwrap();
                let cycle = TAU / frequency;
                let from = [0.0, 5.0 * cycle, 7.3][i % 3];
                let siva = Siva::new(0.02 + 0.2 * number as f64, e, clearance, zeta).unwrap();
                jobs.push(Job {
                    begin: 0.0,
                    system: siva.under(force),
                    start: Start { displacement: [0.0, 0.5][i % 2], ..Start::default() },
                    limits: Limits::new(35.0 * cycle, clearance),
                    steady: Some((steady, Window { from, cycle: Some(push) })),
                    tier: Tier::Exact,
                });
            }
        }
    }
    jobs
}

/// The log of a driven run tells the measures that are taken stretch by stretch in the same run, to rounding:
/// both are computed from the same flights, by other formulas.
#[test]
fn measures_from_the_log_are_those_of_every_stretch() {
    let close = |log: f64, stretches: f64, size: f64, what: &str, i: usize| {
        let off = (log - stretches).abs();
        assert!(off <= 2e-13 * size, "scene {i}: {what} {log:e} {stretches:e}");
    };
    for (i, mut job) in driven(SteadyWanted::ALL).into_iter().enumerate() {
        // Some gaps are off centre.
        let offset = [0.0, 0.3][i % 2] * job.system.clearance();
        job.system = job.system.with_offset(offset).unwrap();
        let (wanted, window) = job.steady.unwrap();
        let stretches = (Measures::new(Wanted::ALL), Steady::new(window, wanted));
        let mut watch = (Summary::new(Wanted::ALL, job.steady), stretches);
        simulate(&job.system, &job.start, &job.limits, None, &mut watch).unwrap();
        let (summary, (measures, steady)) = watch;
        let (a, b) = (summary.values(), measures.values());
        let energy = b.energy_viscous + b.energy_work.abs() + b.energy_initial;
        close(a.energy_viscous, b.energy_viscous, energy, "loss", i);
        close(a.energy_work, b.energy_work, energy, "work", i);
        let (a, b) = (summary.steady_values().unwrap(), steady.values());
        let size = b.amplitude_max.unwrap();
        close(a.amplitude_max.unwrap(), size, size, "amplitude", i);
        close(a.amplitude_rms.unwrap(), b.amplitude_rms.unwrap(), size, "rms", i);
        let [shaken, truth] = [a, b].map(|it| it.acceleration_max.unwrap());
        close(shaken, truth, truth + size, "acceleration", i);
        assert_eq!((a.regime, a.impacts_per_cycle), (b.regime, b.impacts_per_cycle), "scene {i}");
        let found: Vec<_> = summary.steady().unwrap().strobes().collect();
        let truth: Vec<_> = steady.strobes().collect();
        assert_eq!(found.len(), truth.len(), "scene {i}");
        for (a, b) in found.into_iter().zip(truth) {
            assert_eq!((a.cycle, a.time, a.impacts), (b.cycle, b.time, b.impacts), "scene {i}");
            let size = 1.0 + size + job.system.clearance();
            close(a.displacement, b.displacement, size, "x", i);
            close(a.velocity, b.velocity, size, "v", i);
            close(a.gap_displacement, b.gap_displacement, size, "y", i);
            close(a.gap_velocity, b.gap_velocity, size, "w", i);
            close(a.amplitude, b.amplitude, size, "amplitude of the cycle", i);
        }
    }
}

/// An impact at the very begin of the window counts, whoever has found it: the window is put at impacts of the
/// same run.
#[test]
fn an_impact_at_the_begin_of_the_window_counts() {
    let impacts = SteadyWanted { impacts: true, ..SteadyWanted::default() };
    let mut counted = 0;
    for job in driven(impacts) {
        let (wanted, window) = job.steady.unwrap();
        let mut events = Events::default();
        simulate(&job.system, &job.start, &job.limits, None, &mut events).unwrap();
        let at = events.impacts.iter().map(|impact| impact.time).step_by(7).take(4);
        let jobs: Vec<_> = at
            .map(|from| Job { steady: Some((wanted, Window { from, ..window })), ..job.clone() })
            .collect();
        for (job, found) in jobs.iter().zip(together(&jobs)) {
            let (wanted, window) = job.steady.unwrap();
            assert_eq!(found, alone(job), "{window:?}");
            let mut stretches = Steady::new(window, wanted);
            let mut summary = Summary::new(Wanted::NONE, job.steady);
            let mut watch = (&mut stretches, &mut summary);
            simulate(&job.system, &job.start, &job.limits, None, &mut watch).unwrap();
            let truth = stretches.values().impacts_per_cycle;
            assert_eq!(summary.steady_values().unwrap().impacts_per_cycle, truth, "{window:?}");
            counted += 1;
        }
    }
    assert!(counted > 100, "{counted}");
}

#[test]
fn driven_free_masses_are_the_same_side_by_side() {
    let all = SteadyWanted::ALL;
    let rms = SteadyWanted { rms: true, ..SteadyWanted::default() };
    for (steady, wanted) in [
        (all, Wanted::ALL),
        (SteadyWanted { strobes: false, ..all }, Wanted::ALL),
        (SteadyWanted::default(), Wanted::ALL),
        (rms, Wanted { ledger: false, ..Wanted::ALL }),
        (SteadyWanted::default(), Wanted { ledger: false, ..Wanted::ALL }),
        (
            SteadyWanted { impacts: true, ..SteadyWanted::default() },
            Wanted { ledger: false, ..Wanted::ALL },
        ),
    ] {
        let mut jobs = driven(steady);
        let found = together_wanting(&jobs, wanted);
        for (job, found) in jobs.iter().zip(&found) {
            assert_eq!(*found, alone_wanting(job, wanted), "{:?}", job.system.force());
        }
        jobs.reverse();
        assert!(together_wanting(&jobs, wanted).iter().rev().eq(&found));
        // Neighbouring jobs with other wanted measures, or with none.
        for (job, other) in
            jobs.iter_mut().step_by(3).zip([Some(rms), None, Some(all)].iter().cycle())
        {
            job.steady = job.steady.and_then(|(_, window)| Some(((*other)?, window)));
        }
        for (job, found) in jobs.iter().zip(&together_wanting(&jobs, wanted)) {
            assert_eq!(*found, alone_wanting(job, wanted), "{:?}", job.steady);
        }
        for (i, job) in jobs.iter_mut().enumerate() {
            job.limits.max_impacts = [3, 10, 10_000_000][i % 3];
            job.limits.max_work = [23, 100, 100_000_000][i / 3 % 3];
        }
        for (job, found) in jobs.iter().zip(&together_wanting(&jobs, wanted)) {
            assert_eq!(*found, alone_wanting(job, wanted), "{:?}", job.limits);
        }
    }
}

/// The middle of the gap is part of the strobes, whoever takes them. Runs may begin at any instant, and walls may differ.
#[test]
fn driven_free_masses_between_unlike_walls_are_the_same_side_by_side() {
    let mut jobs = driven(SteadyWanted::ALL);
    for (i, job) in jobs.iter_mut().enumerate() {
        let d = job.system.clearance();
        let system = job.system.clone().with_offset([0.5, -0.3, 0.9][i % 3] * d).unwrap();
        job.system = system.with_restitution_minus([0.2, 0.9, 0.6, 0.0][i % 4]).unwrap();
        job.begin = [0.0, 3.0, 0.7][i / 2 % 3];
    }
    for (job, found) in jobs.iter().zip(&together(&jobs)) {
        assert_eq!(*found, alone(job), "{:?}", job.system.offset());
    }
}

/// The logs of long runs are measured and cleared several times on the way.
#[test]
fn long_driven_runs_are_the_same_side_by_side() {
    let mut jobs: Vec<_> = driven(SteadyWanted::ALL).into_iter().skip(1).step_by(6).collect();
    for job in &mut jobs {
        let cycle = job.steady.and_then(|(_, window)| window.cycle).unwrap();
        job.limits.duration = 2000.0 * TAU / cycle.frequency;
    }
    let found = together(&jobs);
    for (job, found) in jobs.iter().zip(&found) {
        assert_eq!(*found, alone(job), "{:?}", job.system.force());
    }
    // The log of a run holds 4096 flights.
    assert!(found.iter().filter(|run| work(run) > 3 * 4096).count() > 3);
}

/// Number of segments of a run, from its printed text.
fn work(run: &str) -> u64 {
    let (_, after) = run.split_once("work: ").unwrap();
    after.split(',').next().and_then(|number| number.parse().ok()).unwrap()
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
        let backwards: Vec<Job<Piva>> = scenes.iter().rev().cloned().collect();
        assert!(together(&backwards).iter().rev().eq(&found));
    }
    let mut linear = pendulums(0.0);
    for Job { system, .. } in &mut linear {
        *system = Piva::new(Parameters { angles: Angles::Small, ..*system.parameters() }).unwrap();
    }
    for (scene, found) in linear.iter().zip(&together(&linear)) {
        assert_eq!(*found, alone(scene), "{:?}", scene.system.parameters());
    }
}

#[test]
fn pendulums_of_many_kinds_keep_apart() {
    // Different tolerances and small angles: these cannot all share lanes.
    let mut scenes: Vec<Job<Piva>> = [0.0, 1e-9]
        .into_iter()
        .flat_map(|tolerance| pendulums(tolerance).into_iter().step_by(5))
        .collect();
    for (i, scene) in scenes.iter_mut().enumerate() {
        let angles = if i % 4 == 1 { Angles::Small } else { Angles::Large };
        scene.system = Piva::new(Parameters { angles, ..*scene.system.parameters() }).unwrap();
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
    let under = |(i, job): (usize, &Job<Piva>)| {
        let Job { begin, start, limits, steady, tier, .. } = *job;
        let system = job.system.under(forces[i % 3 / 2].clone());
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
    // Elastic and undamped runs, which would take a long time without the cancellation.
    let endless: Vec<Job<Siva>> =
        (0..40).map(|i| scene(0.1, 1.0, 0.01 + 0.001 * f64::from(i), 0.0, 1e6)).collect();
    let cancel = AtomicBool::new(false);
    let mut found = Vec::new();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(std::time::Duration::from_millis(20));
            cancel.store(true, Ordering::Relaxed);
        });
        lanes::run(&endless, Wanted::ALL, Some(&cancel), &mut |i, (tally, ..)| {
            found.push((i, tally.outcome, tally.impacts));
        })
        .unwrap();
    });
    // No more runs have begun than go side by side at most.
    assert!(!found.is_empty() && found.len() <= 2 * LANES, "{found:?}");
    for (_, outcome, impacts) in found {
        assert_eq!(outcome, Outcome::Cancelled);
        assert!(impacts > 0);
    }
}

#[test]
fn a_bad_start_is_refused_before_anything_runs() {
    let mut scenes = grid();
    scenes[7].start.gap_displacement = 100.0;
    let mut taken = 0;
    let error = lanes::run(&scenes, Wanted::ALL, None, &mut |_, _| taken += 1).unwrap_err();
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
        let scenes: Vec<Job<Piva>> = all
            .iter()
            .map(|(parameters, case, angle)| {
                let system = Piva::new(Parameters { tolerance, ..*parameters }).unwrap();
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
