//! Driven free masses side by side equal single runs bit for bit, and the log of a run tells its measures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::absorber::{Absorber, Start};
use iva_core::force::{Acts, Force, Harmonic, Impulse};
use iva_core::host::DrivenHost;
use iva_core::measures::{Measures, Wanted};
use iva_core::observe::Events;
use iva_core::run::side_by_side::{Job, Tier};
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;
use iva_core::steady::{Steady, SteadyWanted, Window};
use iva_core::summary::Summary;

use crate::side_by_side::{alone, alone_wanting, together, together_wanting};

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
    // The log of a run holds 1024 flights.
    assert!(found.iter().filter(|run| work(run) > 3 * 4096).count() > 3);
}

/// Number of segments of a run, from its printed text.
fn work(run: &str) -> u64 {
    let (_, after) = run.split_once("work: ").unwrap();
    after.split(',').next().and_then(|number| number.parse().ok()).unwrap()
}
