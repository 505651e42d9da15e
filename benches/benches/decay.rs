//! One free decay of 30 periods: time per run and, through the throughput, per impact.
//!
//! `cargo bench -p iva-benches --bench decay`. Criterion reports elements (impacts) per second;
//! its inverse is the time per impact.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_core::absorber::Start;
use iva_core::measures::{Measures, Wanted};
use iva_core::run::run;
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;

/// μ, e, γ, ζ of the scenes: few strong impacts; a long chatter; many impacts with little loss.
const SCENES: [(&str, [f64; 4]); 3] = [
    ("wide gap", [0.15, 0.5, 0.6, 0.01]),
    ("chatter", [0.15, 0.5, 0.1, 0.01]),
    ("lively", [0.1, 0.9, 0.5, 0.01]),
];

fn decay(criterion: &mut Criterion) {
    let start = Start { displacement: 1.0, ..Start::default() };
    for (name, [mass_ratio, restitution, clearance, damping_ratio]) in SCENES {
        let Ok(siva) = Siva::new(mass_ratio, restitution, clearance, damping_ratio) else {
            continue;
        };
        let limits = Limits::new(30.0 * TAU, clearance);
        let Ok(whole) = run(&siva, &start, &limits) else { continue };
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(whole.tally.impacts));
        group.bench_function("motion", |bencher| {
            bencher.iter(|| simulate(black_box(&siva), &start, &limits, None, &mut ()));
        });
        group.bench_function("motion and measures", |bencher| {
            bencher.iter(|| {
                let mut measures = Measures::<Siva>::new(Wanted::ALL);
                simulate(black_box(&siva), &start, &limits, None, &mut measures)
            });
        });
        group.bench_function("everything recorded", |bencher| {
            bencher.iter(|| run(black_box(&siva), &start, &limits));
        });
        group.finish();
    }
}

criterion_group!(benches, decay);
criterion_main!(benches);
