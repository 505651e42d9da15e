//! Free decays of many free masses: one by one, and side by side.
//!
//! `cargo bench -p iva-benches --bench lanes`. Criterion reports elements (points) per second, summary
//! with all measures included.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_benches::decays as scenes;
use iva_core::lanes::{Decay, decays};
use iva_core::measures::{Measures, Wanted};
use iva_core::simulate::simulate;
use iva_core::siva::Siva;

fn lanes(criterion: &mut Criterion) {
    for (name, narrowest) in [("wide gaps", 0.45), ("with chatter", 0.1)] {
        let Ok(scenes) = scenes(5, narrowest) else { continue };
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(scenes.len() as u64));
        group.bench_function("one by one", |bencher| {
            bencher.iter(|| {
                for Decay { system, start, limits } in black_box(&scenes) {
                    let mut measures = Measures::<Siva>::new(Wanted::ALL);
                    black_box(simulate(system, start, limits, None, &mut measures).is_ok());
                }
            });
        });
        group.bench_function("side by side", |bencher| {
            bencher.iter(|| {
                decays(black_box(&scenes), Wanted::ALL, None, &mut |_, decayed| {
                    black_box(decayed);
                })
            });
        });
        group.finish();
    }
}

criterion_group!(benches, lanes);
criterion_main!(benches);
