//! Maps over one cycle of a harmonic force with some three impacts in it, on one core: 256 trajectories of a free mass side by
//! side near the stable orbit A5 of `tests/reference/orbits.json`, and as many of a pendulum. Nanoseconds a map.

use std::hint::black_box;
use std::ops::ControlFlow::{Break, Continue};
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_core::{
    absorber::Start,
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{Cycle, Iterated, Request, Trajectory, iterate},
    piva::{Parameters, Piva, PivaStart},
    run::side_by_side::Tier,
    siva::Siva,
};

const TRAJECTORIES: usize = 256;
const CYCLES: usize = 40;

fn trajectory(index: usize, tier: Tier) -> Result<Trajectory<Siva<DrivenHost>>, Invalid> {
    let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic])?;
    let siva = Siva::new(0.2, 0.7, 3.4, 0.05)?.under(force);
    let start = Start {
        displacement: -2.225_471_662_1 + 1e-4 * index as f64 / TRAJECTORIES as f64,
        velocity: 1.377_709_279_3,
        gap_displacement: -2.161_628_140_6,
        gap_velocity: -0.293_273_920_8,
    };
    let cycle = Cycle { begin: 0.0, length: std::f64::consts::TAU };
    let trajectory = Trajectory::new(siva, &start, cycle)?;
    Ok(Trajectory { tier, ..trajectory })
}

/// A pendulum in full accuracy, or with a tolerance of 1e-9.
fn swinging(index: usize, tier: Tier) -> Result<Trajectory<Piva<DrivenHost>>, Invalid> {
    let harmonic = Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let tolerance = if tier == Tier::Fast { 1e-9 } else { 0.0 };
    let bob = Parameters::point_bob(0.08, 0.65, 0.4, 0.02, 10.0);
    let piva = Piva::new(Parameters { frequency_ratio: 0.4, tolerance, ..bob })?;
    let displacement = 0.3 + 1e-3 * index as f64;
    let start = Start { displacement, velocity: 0.1, gap_displacement: 0.1, gap_velocity: 0.2 };
    let cycle = Cycle { begin: 0.0, length: std::f64::consts::TAU };
    let piva = piva.under(Force::harmonic(vec![harmonic])?);
    Trajectory::new(piva, &PivaStart::from(start), cycle)
}

fn maps(criterion: &mut Criterion) {
    of("free mass", trajectory, criterion);
    of("pendulum", swinging, criterion);
}

fn of<S: Iterated>(
    absorber: &str,
    trajectory: fn(usize, Tier) -> Result<Trajectory<S>, Invalid>,
    criterion: &mut Criterion,
) {
    let mut group = criterion.benchmark_group(format!("maps of a driven {absorber}, 3 impacts"));
    group.throughput(Throughput::Elements((TRAJECTORIES * CYCLES) as u64));
    group.sample_size(20).measurement_time(Duration::from_secs(3));
    for tier in [Tier::Exact, Tier::Fast] {
        let all: Result<Vec<_>, _> =
            (0..TRAJECTORIES).map(|index| trajectory(index, tier)).collect();
        let Ok(all) = all else { return };
        for tangents in [false, true] {
            let name =
                format!("{}{}", tier.name(), if tangents { ", with derivatives" } else { "" });
            let request = Request { tangents, cancel: None };
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let mut cycles = [0; TRAJECTORIES];
                    iterate(&all, request, &mut |index, image| {
                        black_box(image);
                        cycles[index] += 1;
                        if cycles[index] < CYCLES { Continue(()) } else { Break(()) }
                    })
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, maps);
criterion_main!(benches);
