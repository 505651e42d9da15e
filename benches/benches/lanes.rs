//! Free decays of many free masses: one by one, and side by side.
//!
//! `cargo bench -p iva-benches --bench lanes`. Criterion reports elements (points) per second, summary
//! with all measures included.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_core::lanes::{Decay, decays};
use iva_core::measures::{Measures, Wanted};
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;
use iva_core::system::Start;

/// 5 mass ratios, 8 clearances from `narrowest` on, 5 coefficients of restitution; 30 periods.
fn grid(narrowest: f64) -> Vec<Decay> {
    let mut scenes = Vec::new();
    for mu in [0.02, 0.065, 0.11, 0.155, 0.2] {
        for step in 0..8 {
            for e in [0.4, 0.5125, 0.625, 0.7375, 0.85] {
                let clearance = narrowest + 0.125 * f64::from(step);
                let Ok(siva) = Siva::new(mu, e, clearance, 0.01) else { continue };
                let start = Start { displacement: 1.0, ..Start::default() };
                let limits = Limits::new(30.0 * TAU, clearance);
                scenes.push(Decay { siva, start, limits });
            }
        }
    }
    scenes
}

fn lanes(criterion: &mut Criterion) {
    for (name, narrowest) in [("wide gaps", 0.45), ("with chatter", 0.1)] {
        let scenes = grid(narrowest);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(scenes.len() as u64));
        group.bench_function("one by one", |bencher| {
            bencher.iter(|| {
                for Decay { siva, start, limits } in black_box(&scenes) {
                    let mut measures = Measures::<Siva>::new(Wanted::ALL);
                    black_box(simulate(siva, start, limits, None, &mut measures).is_ok());
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
