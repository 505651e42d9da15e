//! Pendulums under one harmonic force, at large and small angles: runs side by side equal single runs bit for
//! bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic, Impulse},
    host::DrivenHost,
    measures::Wanted,
    piva::{Angles, Parameters, Piva},
    run::side_by_side::{Job, Tier},
    simulate::Limits,
    steady::{SteadyWanted, Window},
};
use iva_tests::rng::Rng;

use crate::side_by_side::{alone_wanting, together_wanting};

/// Random pendulums: light and heavy, with hard and soft walls, damped and undamped pivots and some with a spring, under a force
/// or on a moving base, with or without a transient that is left out; a few under two forces, or with an
/// impulse.
fn driven(rng: &mut Rng, steady: SteadyWanted, tolerance: f64) -> Vec<Job<Piva<DrivenHost>>> {
    let job = |i: usize| {
        let clearance = rng.log_range(0.05, 2.0);
        let length = rng.pick(&[1.1, 3.0, 20.0]) * clearance;
        let parameters = Parameters {
            frequency_ratio: rng.range(0.1, 1.5),
            pivot_damping_ratio: rng.pick(&[0.0, 0.03]),
            spring_ratio: [0.0, 0.7, 0.0][i % 3],
            angles: if i % 5 == 4 { Angles::Small } else { Angles::Large },
            tolerance,
            ..Parameters::point_bob(
                rng.log_range(0.01, 0.5),
                rng.pick(&[0.0, 0.4, 0.7, 0.95, 1.0]),
                clearance,
                rng.pick(&[0.0, 0.02, 1.2]),
                length,
            )
        };
        let push = Harmonic {
            amplitude: rng.range(-1.0, 1.0),
            frequency: rng.log_range(0.2, 4.0),
            phase: rng.range(-7.0, 7.0),
            acts: if i.is_multiple_of(2) { Acts::Primary } else { Acts::Base },
        };
        let more = (i % 17 == 3).then_some(Harmonic { frequency: 1.7, ..push });
        let hit = (i % 19 == 4).then_some(Impulse { velocity: 0.3, time: 11.0 });
        let harmonics = [push].into_iter().chain(more).collect();
        let force = Force::new(harmonics, Vec::new(), hit.as_slice()).unwrap();
        let cycle = TAU / push.frequency;
        let from = [0.0, 5.0 * cycle, 7.3][i % 3];
        Job {
            begin: 0.0,
            system: Piva::new(parameters).unwrap().under(force),
            start: Start { displacement: [0.0, 0.5][i % 2], ..Start::default() }.into(),
            limits: Limits::new((20.0 * cycle).min(90.0).max(from + 1.0), clearance),
            steady: Some((steady, Window { from, cycle: Some(push) })),
            tier: if tolerance > 0.0 { Tier::Fast } else { Tier::Exact },
        }
    };
    (0..iva_tests::some(60)).map(job).collect()
}

#[test]
fn driven_pendulums_are_the_same_side_by_side() {
    let mut rng = Rng::new(20_261_126);
    let all = SteadyWanted { strobes: false, ..SteadyWanted::ALL };
    let none = SteadyWanted::default();
    let little = Wanted { ledger: false, ..Wanted::ALL };
    for (steady, wanted) in [
        (all, Wanted::ALL),
        (none, Wanted::ALL),
        (none, little),
        (SteadyWanted { rms: true, ..none }, little),
        (SteadyWanted { amplitude: true, ..none }, little),
        (SteadyWanted { acceleration: true, ..none }, Wanted::ALL),
        (SteadyWanted { regime: true, ..none }, little),
        (SteadyWanted::ALL, Wanted::ALL),
    ] {
        for tolerance in [0.0, 1e-11, 1e-9, 1e-5] {
            let jobs = driven(&mut rng, steady, tolerance);
            let together = together_wanting(&jobs, wanted);
            for (job, together) in jobs.iter().zip(&together) {
                assert_eq!(&alone_wanting(job, wanted), together, "{job:?}");
            }
        }
    }
}

/// A run stopped by a number of impacts or of stretches ends at the same place side by side and alone.
#[test]
fn limits_stop_driven_pendulums_where_they_are() {
    let mut rng = Rng::new(20_261_127);
    let mut jobs = driven(&mut rng, SteadyWanted { strobes: false, ..SteadyWanted::ALL }, 0.0);
    for (i, job) in jobs.iter_mut().enumerate() {
        (job.limits.max_impacts, job.limits.max_work) =
            if i % 2 == 0 { (i as u64, u64::MAX) } else { (u64::MAX, 7 * i as u64) };
    }
    let together = together_wanting(&jobs, Wanted::ALL);
    for (job, together) in jobs.iter().zip(&together) {
        assert_eq!(&alone_wanting(job, Wanted::ALL), together, "{job:?}");
    }
}
