//! Free decays of many absorbers: one by one, and side by side.
//!
//! `cargo bench -p iva-benches --bench lanes`. Criterion reports elements (points) per second, summary
//! with all measures included.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_benches::{decays as scenes, swinging_decays};
use iva_core::lanes::{self, Job, SideBySide};
use iva_core::measures::{Measures, Wanted};
use iva_core::simulate::simulate;

fn lanes(criterion: &mut Criterion) {
    for (name, narrowest) in [("wide gaps", 0.45), ("with chatter", 0.1)] {
        let Ok(scenes) = scenes(5, narrowest) else { continue };
        compare(criterion, &format!("free masses, {name}"), &scenes);
    }
    for tolerance in [0.0, 1e-9, 1e-6] {
        let Ok(scenes) = swinging_decays(5, 0.6, tolerance) else { continue };
        compare(criterion, &format!("pendulums, tolerance {tolerance:e}"), &scenes);
    }
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
    for (way, ledger) in [("side by side", true), ("side by side, no losses", false)] {
        let wanted = Wanted { ledger, ..Wanted::ALL };
        group.bench_function(way, |bencher| {
            bencher.iter(|| {
                lanes::run(black_box(scenes), wanted, None, &mut |_, decayed| {
                    black_box(decayed);
                })
            });
        });
    }
    group.finish();
}

criterion_group!(benches, lanes);
criterion_main!(benches);
