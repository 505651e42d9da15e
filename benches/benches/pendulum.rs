//! Free decays of 30 periods with a pendulum: time per run at each tolerance and, through the
//! throughput, per step.
//!
//! `cargo bench -p iva-benches --bench pendulum`. Criterion reports elements (steps of the Taylor
//! series) per second; its inverse is the time per step. The scene is the reference case
//! `piva_gamma_1.4` of the tests: μ 0.12, e 0.5, γ 1.4, ζ 0, r 0.4, L/x₀ 10.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_core::absorber::Start;
use iva_core::measures::{Measures, Wanted};
use iva_core::piva::{Angles, Parameters, Piva, PivaStart};
use iva_core::simulate::{Limits, simulate};

/// Name, tolerance, angles and spring ratio of each bench.
const WAYS: [(&str, f64, Angles, f64); 6] = [
    ("full accuracy", 0.0, Angles::Large, 0.0),
    ("tolerance 1e-12", 1e-12, Angles::Large, 0.0),
    ("tolerance 1e-9", 1e-9, Angles::Large, 0.0),
    ("tolerance 1e-6", 1e-6, Angles::Large, 0.0),
    ("small angles", 0.0, Angles::Small, 0.0),
    ("torsional spring", 0.0, Angles::Large, 0.4),
];

fn pendulum(criterion: &mut Criterion) {
    let start = PivaStart::from(Start { displacement: 1.0, ..Start::default() });
    let limits = Limits::new(30.0 * TAU, 1.4);
    for (name, tolerance, angles, spring_ratio) in WAYS {
        let parameters = Parameters {
            frequency_ratio: 0.4,
            tolerance,
            angles,
            spring_ratio,
            ..Parameters::point_bob(0.12, 0.5, 1.4, 0.0, 10.0)
        };
        let Ok(piva) = Piva::new(parameters) else { continue };
        let Ok(tally) = simulate(&piva, &start, &limits, None, &mut ()) else { continue };
        let mut group = criterion.benchmark_group(format!("piva_gamma_1.4, {name}"));
        group.throughput(Throughput::Elements(tally.work));
        group.bench_function("motion", |bencher| {
            bencher.iter(|| simulate(black_box(&piva), &start, &limits, None, &mut ()));
        });
        group.bench_function("motion and measures", |bencher| {
            bencher.iter(|| {
                let mut measures = Measures::<Piva>::new(Wanted::ALL);
                simulate(black_box(&piva), &start, &limits, None, &mut measures)
            });
        });
        group.finish();
    }
}

criterion_group!(benches, pendulum);
criterion_main!(benches);
