//! One run of a driven free mass, 60 cycles: time per run, with and without measures.
//!
//! `cargo bench -p iva-benches --bench driven`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use iva_benches::{START, driven, driven_measures};
use iva_core::simulate::simulate;

fn forced(criterion: &mut Criterion) {
    let Ok((siva, limits, window)) = driven() else { return };
    let mut group = criterion.benchmark_group("driven free mass");
    group.bench_function("motion", |bencher| {
        bencher.iter(|| simulate(black_box(&siva), &START, &limits, None, &mut ()));
    });
    group.bench_function("motion and measures", |bencher| {
        bencher.iter(|| {
            simulate(black_box(&siva), &START, &limits, None, &mut driven_measures(window))
        });
    });
    group.finish();
}

criterion_group!(benches, forced);
criterion_main!(benches);
