//! Lists of free masses side by side: each run has the bits that it has alone. Pairs go in lanes, the other lists one by one.
//!
//! The numbers come from the event loop, which is tested in `several.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Point,
    absorber::several::{Several, Starts},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    host::{DrivenHost, UndrivenHost},
    measures::Wanted,
    run::side_by_side::{Job, SideBySide, Tier},
    simulate::Limits,
    siva::FreeMass,
    steady::{SteadyWanted, Window},
};
use iva_tests::rng::Rng;

use super::side_by_side::{alone, alone_wanting, together, together_wanting};

/// The number of masses of the k-th list: mostly two.
fn count(k: usize) -> usize {
    if k % 8 == 7 { 1 + k / 8 % 8 } else { 2 }
}

/// A random list of so many masses, elastic and plastic ones among them, on a structure of this damping ratio.
fn any_list(
    rng: &mut Rng,
    count: usize,
    damping_ratio: f64,
) -> (Several<UndrivenHost>, Starts<f64>) {
    let (mut masses, mut gaps) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let (d, offset) = (rng.range(0.2, 1.5), rng.range(-0.2, 0.2));
        let e = [0.0, 1.0, rng.range(0.2, 0.95)][(rng.range(0.0, 6.0) as usize).min(2)];
        let mass = FreeMass::new(rng.log_range(0.01, 0.5), e, d).unwrap();
        masses.push(mass.with_offset(offset).unwrap());
        // Some start at a wall, some in the same place.
        let y =
            offset + d * [-1.0, 0.0, rng.range(-0.9, 0.9)][(rng.range(0.0, 6.0) as usize).min(2)];
        gaps.push(GapPoint { y, w: rng.range(-0.5, 0.5) });
    }
    let primary = Point { x: rng.range(-2.0, 2.0), v: rng.range(-2.0, 2.0) };
    (Several::of(damping_ratio, &masses).unwrap(), Starts::of(primary, &gaps))
}

fn limits(rng: &mut Rng) -> Limits {
    let limits =
        Limits::new(rng.range(20.0, 90.0), [1e-9, 1e-3, 0.3][rng.range(0.0, 3.0) as usize]);
    let (impacts, work) = (rng.range(1.0, 60.0) as u64, rng.range(1.0, 200.0) as u64);
    match rng.range(0.0, 8.0) as usize {
        0 => Limits { max_impacts: impacts, ..limits },
        1 => Limits { max_work: work, ..limits },
        _ => limits,
    }
}

fn decays(rng: &mut Rng, number: usize) -> Vec<Job<Several<UndrivenHost>>> {
    (0..number)
        .map(|k| {
            let damping_ratio = [0.0, 0.01, 0.01, 0.7][k % 4];
            let (system, start) = any_list(rng, count(k), damping_ratio);
            let limits = limits(rng);
            Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Exact }
        })
        .collect()
}

fn driven(rng: &mut Rng, number: usize, acts: Acts) -> Vec<Job<Several<DrivenHost>>> {
    (0..number)
        .map(|k| {
            let damping_ratio = rng.range(0.0, 0.1);
            let (system, start) = any_list(rng, count(k), damping_ratio);
            let [amplitude, frequency, phase] =
                [rng.range(0.05, 0.5), rng.range(0.3, 2.0), rng.range(0.0, 6.0)];
            let harmonic = Harmonic { amplitude, frequency, phase, acts };
            let system = system.under(Force::harmonic(vec![harmonic]).unwrap());
            let limits = limits(rng);
            let window = Window { from: 0.3 * limits.duration, cycle: Some(harmonic) };
            let wanted = SteadyWanted::ALL;
            let steady = [None, Some((wanted, window))][k / 8 % 2];
            Job { system, start, begin: 0.0, limits, steady, tier: Tier::Exact }
        })
        .collect()
}

fn alike<S: SideBySide>(jobs: &[Job<S>]) {
    for (job, found) in jobs.iter().zip(together(jobs)) {
        assert_eq!(found, alone(job));
    }
    for (job, found) in jobs.iter().zip(together_wanting(jobs, Wanted::NONE)) {
        assert_eq!(found, alone_wanting(job, Wanted::NONE));
    }
}

#[test]
fn decays_have_the_bits_that_they_have_alone() {
    alike(&decays(&mut Rng::new(71), 96));
}

#[test]
fn forced_runs_have_the_bits_that_they_have_alone() {
    alike(&driven(&mut Rng::new(72), 40, Acts::Primary));
}

#[test]
fn runs_on_a_moving_base_have_the_bits_that_they_have_alone() {
    alike(&driven(&mut Rng::new(73), 40, Acts::Base));
}
