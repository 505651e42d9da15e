//! Free decays and driven runs of many absorbers: one by one, and side by side.
//!
//! `cargo bench -p iva-benches --bench lanes`. Criterion reports elements (points) per second, including a
//! summary with all measures.

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use iva_benches::{
    decays as scenes, decays_after_a_blow, driven_jobs, driven_pendulums, fast, swinging_decays,
    upright_decays,
};
use iva_core::force::Acts;
use iva_core::measures::{Measures, Wanted};
use iva_core::run::side_by_side::{self, Job, Listing, SideBySide};
use iva_core::simulate::simulate;

fn lanes(criterion: &mut Criterion) {
    for (name, narrowest) in [("wide gaps", 0.45), ("with chatter", 0.1)] {
        let Ok(scenes) = scenes(5, narrowest) else { continue };
        compare(criterion, &format!("free masses, {name}"), &scenes);
    }
    for (name, acts) in [("under force", Acts::Primary), ("on a moving base", Acts::Base)] {
        let Ok(jobs) = driven_jobs(acts) else { continue };
        driven(criterion, &format!("free masses {name}"), &jobs);
        driven(criterion, &format!("free masses {name}, fast"), &fast(jobs));
    }
    for tolerance in [0.0, 1e-9, 1e-6] {
        let Ok(scenes) = swinging_decays(5, 0.6, tolerance) else { continue };
        compare(criterion, &format!("pendulums, tolerance {tolerance:e}"), &scenes);
        let Ok(jobs) = driven_pendulums(Acts::Primary, tolerance) else { continue };
        driven(criterion, &format!("pendulums under force, tolerance {tolerance:e}"), &jobs);
    }
    if let Ok(scenes) = upright_decays(5, 0.45) {
        compare(criterion, "free masses, upright", &scenes);
    }
    if let Ok(scenes) = decays_after_a_blow(5, 0.45) {
        compare(criterion, "free masses after a blow", &scenes);
    }
}

/// Driven runs one by one, side by side with all measures, and side by side with counts of impacts only.
fn driven<S: SideBySide + Clone>(criterion: &mut Criterion, name: &str, jobs: &[Job<S>]) {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(jobs.len() as u64));
    group.sample_size(20);
    let few: Vec<_> = jobs.iter().map(|job| Job { steady: None, ..Job::clone(job) }).collect();
    let none = Wanted::NONE;
    // Fewer than three jobs go one by one.
    for (way, jobs, wanted, size) in [
        ("one by one", jobs, Wanted::ALL, 1),
        ("side by side", jobs, Wanted::ALL, jobs.len()),
        ("side by side, impacts", &few, none, jobs.len()),
    ] {
        group.bench_function(way, |bencher| {
            bencher.iter(|| {
                for jobs in black_box(jobs).chunks(size) {
                    let ended = side_by_side::run(jobs, wanted, None, &mut |_, ended| {
                        black_box(ended);
                    });
                    black_box(ended.is_ok());
                }
            });
        });
    }
    group.finish();
}

fn compare<S: SideBySide>(criterion: &mut Criterion, name: &str, scenes: &[Job<S>]) {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(scenes.len() as u64));
    group.sample_size(20);
    group.bench_function("one by one", |bencher| {
        bencher.iter(|| {
            for Job { system, start, limits, .. } in black_box(scenes) {
                let mut measures = Measures::<S>::new(Wanted::ALL);
                black_box(simulate(system, start, limits, None, &mut measures).is_ok());
            }
        });
    });
    beside(&mut group, scenes);
    group.finish();
}

fn beside<S: SideBySide>(group: &mut BenchmarkGroup<'_, WallTime>, scenes: &[Job<S>]) {
    let none = Wanted::NONE;
    for (way, wanted) in [
        ("side by side", Wanted::ALL),
        ("side by side, no losses", Wanted { ledger: false, ..Wanted::ALL }),
        ("side by side, impacts", none),
    ] {
        group.bench_function(way, |bencher| {
            bencher.iter(|| {
                side_by_side::run(black_box(scenes), wanted, None, &mut |_, decayed| {
                    black_box(decayed);
                })
            });
        });
    }
    let errors = Listing { errors: true, ..Listing::default() };
    group.bench_function("side by side, impacts and errors", |bencher| {
        bencher.iter(|| {
            side_by_side::run_listed(
                black_box(scenes),
                (none, &errors),
                None,
                &mut |_, decayed, listed| {
                    black_box((decayed, listed));
                },
            )
        });
    });
}

criterion_group!(benches, lanes);
criterion_main!(benches);
