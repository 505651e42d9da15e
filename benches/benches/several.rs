//! Free decays and driven runs of what real structures have, 30 periods, alone in the event loop, as time per impact: several
//! free masses, pendulums beside them, several modes with one mass or five, friction and a dashpot in the gap, beside one free
//! mass or one pendulum on one mode.
//!
//! `cargo bench -p iva-benches --bench several`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use iva_core::absorber::modal::{MOST, Modal, ModalStart, ModalStructure, PRIMARY, Tie};
use iva_core::absorber::{Absorber, Start};
use iva_core::error::Invalid;
use iva_core::flight::GapPoint;
use iva_core::force::{Acts, Force, Harmonic};
use iva_core::piva::{Parameters, Piva};
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::{FreeMass, Siva};

const DAMPING_RATIO: f64 = 0.01;
/// Mass ratio of all masses together.
const MASS_RATIO: f64 = 0.1;
const RESTITUTION: f64 = 0.6;

/// Equal shares of the mass in gaps whose clearances spread by a tenth.
fn masses(count: usize) -> Result<Vec<FreeMass>, Invalid> {
    let place = |k: usize| 2.0 * k as f64 / (count.max(2) - 1) as f64 - 1.0;
    let clearance = |k: usize| 0.6 * (1.0 + 0.1 * place(k));
    let mass = |k| FreeMass::new(MASS_RATIO / count as f64, RESTITUTION, clearance(k));
    (0..count).map(mass).collect()
}

fn limits() -> Limits {
    Limits::new(30.0 * std::f64::consts::TAU, 0.5)
}

fn push() -> Result<Force, Invalid> {
    let acts = Acts::Primary;
    Force::harmonic(vec![Harmonic { amplitude: 0.1, frequency: 1.0, phase: 0.0, acts }])
}

/// Times one run, per impact.
fn run<S: Absorber<Real = f64>>(
    criterion: &mut Criterion,
    (kind, count): (&str, usize),
    system: &S,
    start: &S::Start,
) -> Result<(), Invalid> {
    let impacts = simulate(system, start, &limits(), None, &mut ())?.impacts;
    let mut group = criterion.benchmark_group(format!("several, {kind}"));
    group.throughput(Throughput::Elements(impacts));
    group.bench_function(BenchmarkId::from_parameter(count), |bencher| {
        bencher.iter(|| simulate(black_box(system), start, &limits(), None, &mut ()));
    });
    group.finish();
    Ok(())
}

fn all(criterion: &mut Criterion) -> Result<(), Invalid> {
    let one = Siva::new(MASS_RATIO, RESTITUTION, 0.6, DAMPING_RATIO)?;
    let start = Start { displacement: 1.0, ..Start::default() };
    run(criterion, ("decay", 1), &one, &start)?;
    run(criterion, ("driven", 1), &one.under(push()?), &start)?;
    for count in [2, 5, 8] {
        let masses: Vec<_> = masses(count)?.into_iter().map(|mass| (mass, PRIMARY)).collect();
        let system = Modal::of(ModalStructure::moving_as_one(DAMPING_RATIO)?, &masses)?;
        let start = ModalStart::new(&[1.0], &[], [GapPoint { y: 0.0, w: 0.0 }; MOST])?;
        run(criterion, ("decay", count), &system, &start)?;
        run(criterion, ("driven", count), &system.under(push()?, PRIMARY)?, &start)?;
    }
    Ok(())
}

/// A structure of so many modes, ωⱼ = j, with five points.
fn structure(modes: usize) -> Result<ModalStructure, Invalid> {
    let frequencies: Vec<f64> = (1..=modes).map(|j| j as f64).collect();
    let mut structure = ModalStructure::new(&frequencies, &vec![DAMPING_RATIO; modes])?;
    for (k, name) in POINTS.into_iter().enumerate() {
        let place = (k as f64 + 1.0) / 6.0 * std::f64::consts::PI;
        let shapes: Vec<f64> = (1..=modes).map(|j| (j as f64 * place).sin()).collect();
        structure = structure.with_point(name, &shapes)?;
    }
    Ok(structure)
}

const POINTS: [&str; 5] = ["a", "b", "c", "d", "e"];

fn modes(criterion: &mut Criterion) -> Result<(), Invalid> {
    let rest = GapPoint { y: 0.0, w: 0.0 };
    for (modes, count) in [(1, 1), (2, 1), (20, 1), (20, 5)] {
        let masses = masses(count)?;
        let at: Vec<_> = masses.into_iter().zip(POINTS).collect();
        let system = Modal::of(structure(modes)?, &at)?;
        let start = ModalStart::new(&[1.0], &[], [rest; MOST])?;
        run(criterion, (&format!("{modes} modes, decay"), count), &system, &start)?;
    }
    Ok(())
}

/// Pendulums and masses in turn, as many as asked for, beside one pendulum in the loop for one.
fn pendulums(criterion: &mut Criterion) -> Result<(), Invalid> {
    let parameters = |mass_ratio, clearance| Parameters {
        frequency_ratio: 0.4,
        ..Parameters::point_bob(mass_ratio, RESTITUTION, clearance, DAMPING_RATIO, 5.0)
    };
    let one = Piva::new(parameters(MASS_RATIO, 0.6))?;
    let start = Start { displacement: 1.0, ..Start::default() }.into();
    run(criterion, ("pendulum, decay", 1), &one, &start)?;
    run(criterion, ("pendulum, driven", 1), &one.under(push()?), &start)?;
    for count in [2, 4, 8] {
        let (masses, mut pendulums) = (masses(count)?, Vec::new());
        for (k, mass) in masses.iter().enumerate() {
            let parameters = parameters(MASS_RATIO / count as f64, mass.clearance());
            pendulums.push((k % 2 == 0).then_some(parameters));
        }
        let members: Vec<_> = masses.into_iter().map(|mass| (mass, PRIMARY)).collect();
        let system = Modal::of(ModalStructure::moving_as_one(DAMPING_RATIO)?, &members)?;
        let system = system.with_pendulums(&pendulums)?;
        let start = ModalStart::new(&[1.0], &[], [GapPoint { y: 0.0, w: 0.0 }; MOST])?;
        run(criterion, ("pendulums and masses, decay", count), &system, &start)?;
        let driven = system.under(push()?, PRIMARY)?;
        run(criterion, ("pendulums and masses, driven", count), &driven, &start)?;
    }
    Ok(())
}

/// A mass with a dashpot in its gap, which is a coordinate of the structure.
fn dashpot(criterion: &mut Criterion) -> Result<(), Invalid> {
    for damping in [0.0, 0.004] {
        let structure = ModalStructure::new(&[1.0], &[DAMPING_RATIO])?;
        let structure = structure.with_point("primary", &[1.0])?;
        let masses = [(FreeMass::new(MASS_RATIO, RESTITUTION, 0.6)?, "primary")];
        let system = Modal::of(structure, &masses)?.with_ties(&[Tie { spring: 0.0, damping }])?;
        let start = ModalStart::new(&[1.0], &[], [GapPoint { y: 0.0, w: 0.0 }; MOST])?;
        run(criterion, (&format!("dashpot {damping}, decay"), 1), &system, &start)?;
        let driven = system.under(push()?, "primary")?;
        run(criterion, (&format!("dashpot {damping}, driven"), 1), &driven, &start)?;
    }
    Ok(())
}

/// A mass that rubs, with its stops and slips.
fn friction(criterion: &mut Criterion) -> Result<(), Invalid> {
    let structure = ModalStructure::new(&[1.0], &[DAMPING_RATIO])?;
    let structure = structure.with_point("primary", &[1.0])?;
    let masses = [(FreeMass::new(MASS_RATIO, RESTITUTION, 0.6)?, "primary")];
    let system = Modal::of(structure, &masses)?.with_friction(&[0.02])?;
    let start = ModalStart::new(&[1.0], &[], [GapPoint { y: 0.0, w: 0.0 }; MOST])?;
    run(criterion, ("friction, driven", 1), &system.under(push()?, "primary")?, &start)
}

fn several(criterion: &mut Criterion) {
    // Invalid scenes would show as missing benches.
    let _ = all(criterion);
    let _ = modes(criterion);
    let _ = friction(criterion);
    let _ = pendulums(criterion);
    let _ = dashpot(criterion);
}

criterion_group!(benches, several);
criterion_main!(benches);
