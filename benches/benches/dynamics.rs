//! Orbits, branches, diagrams, exponents and basins of a driven free mass with some two impacts a cycle, on one core: the
//! scene of the orbits A of `tests/reference/orbits.json`.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use iva_core::{
    absorber::Start,
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Trajectory,
        attractors::{Search, attractors},
        basins::basins,
        branch::{Along, follow},
        chain::Chain,
        description::describe,
        diagram::{Direction, diagram},
        lyapunov::{Window, lyapunov},
        map,
        neighbourhood::neighbourhoods,
        periodic::find,
        spectrum::spectrum,
    },
    siva::Siva,
};

type Driven = Siva<DrivenHost>;

/// The scene with a clearance.
fn scene(clearance: f64) -> Result<Driven, Invalid> {
    let force = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    Ok(Siva::new(0.2, 0.7, clearance, 0.05)?.under(Force::harmonic(vec![force])?))
}

fn trajectory(clearance: f64, start: Start) -> Result<Trajectory<Driven>, Invalid> {
    Trajectory::new(scene(clearance)?, &start, Cycle { begin: 0.0, length: TAU })
}

/// A trajectory after some cycles, 1e-3 away from where it was then.
fn settled(clearance: f64, cycles: u32) -> Result<Trajectory<Driven>, Invalid> {
    let mut all = trajectory(clearance, Start { gap_velocity: 0.1, ..Start::default() })?;
    for _ in 0..cycles {
        all.state = map(&all, false, None)?.state;
    }
    Ok(all)
}

/// One cycle after the other, and an orbit with what is told of it.
fn orbits(criterion: &mut Criterion) {
    let Ok(begun) = settled(4.5, 20) else { return };
    for (name, tangents) in [("a map by itself", false), ("a map by itself, with derivative", true)]
    {
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| black_box(map(&begun, tangents, None).is_ok()));
        });
    }
    criterion.bench_function("an orbit", |bencher| {
        bencher.iter(|| black_box(find(&begun, false, None).is_ok()));
    });
    let Ok(orbit) = find(&begun, false, None) else { return };
    criterion.bench_function("its events and extremes", |bencher| {
        bencher.iter(|| black_box(describe(&orbit, None).is_ok()));
    });
    let Ok(description) = describe(&orbit, None) else { return };
    criterion.bench_function("its multipliers with their errors", |bencher| {
        bencher.iter(|| black_box(spectrum(&orbit, &description, None).is_ok()));
    });
}

/// The branch of that orbit over the clearance, a point.
fn branches(criterion: &mut Criterion) {
    let Ok(orbit) = settled(4.5, 200).map(|begun| find(&begun, true, None)) else { return };
    let Some((chain, unknowns)) = orbit.ok().and_then(|orbit| Chain::of(&orbit, 1).ok()) else {
        return;
    };
    let scenes = |values: &[f64]| Ok((scene(values[0])?, TAU));
    let branch = || follow(&scenes, (&chain, &unknowns), 4.5, Along::new([0.5, 13.0]));
    let Some(points) = branch().map(|branch| branch.points.len()) else { return };
    let mut group = criterion.benchmark_group("branch");
    group.throughput(Throughput::Elements(points as u64)).sample_size(10);
    group.bench_function("a point of it, with multipliers", |bencher| {
        bencher.iter(|| black_box(branch().is_some()));
    });
    group.finish();
}

/// Many cycles: a diagram upwards, exponents of chaos and a basin.
fn many(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cycles");
    group.sample_size(10).measurement_time(Duration::from_secs(3));
    let values = (0..60_u32).map(|k| 3.0 + 0.05 * f64::from(k));
    let Ok(columns) = values.map(|it| settled(it, 0)).collect::<Result<Vec<_>, _>>() else {
        return;
    };
    let window = Window { discard: 60, keep: 60 };
    group.throughput(Throughput::Elements(120 * columns.len() as u64));
    group.bench_function("of a diagram", |bencher| {
        bencher.iter(|| black_box(diagram(&columns, Direction::Up, window, None, None).is_ok()));
    });
    let starts = |count: u32, clearance: f64| -> Result<Vec<_>, Invalid> {
        let start = |k: u32| Start { displacement: 1e-3 * f64::from(k), ..Start::default() };
        (0..count).map(|k| trajectory(clearance, start(k))).collect()
    };
    let Ok(seeds) = starts(8, 3.85) else { return };
    let window = Window { discard: 100, keep: 1000 };
    group.throughput(Throughput::Elements(1100 * seeds.len() as u64));
    group.bench_function("of exponents", |bencher| {
        bencher.iter(|| black_box(lyapunov(&seeds, window, None).is_ok()));
    });
    let Ok(cells) = starts(1024, 4.5) else { return };
    let search = Search { most_periods: 4, most_cycles: 500, join_mirrored: false };
    let Ok(found) = attractors(&cells[..8], search, None) else { return };
    let around = neighbourhoods(&cells[0], &found.attractors, None);
    let count: u64 = basins(&cells, &around, 150, None)
        .map_or(1, |cells| cells.iter().map(|cell| cell.cycles).sum());
    group.throughput(Throughput::Elements(count));
    group.bench_function("of a basin", |bencher| {
        bencher.iter(|| black_box(basins(&cells, &around, 150, None).is_ok()));
    });
    group.finish();
}

criterion_group!(benches, orbits, branches, many);
criterion_main!(benches);
