//! The parts of a run one by one: a flight, a contact, an impact, a chatter.
//!
//! `cargo bench -p iva-benches --bench parts`.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use iva_benches::START;
use iva_core::absorber::{Absorber, Start};
use iva_core::contact::first_contact;
use iva_core::flight::Motion;
use iva_core::piva::{Parameters, Piva, PivaStart};
use iva_core::run::run;
use iva_core::simulate::{Limits, simulate};
use iva_core::siva::Siva;

/// Times a flight from a state to its end, the search of that flight for a contact, and the impact there.
fn of_a_run<S: Absorber<Real = f64>>(
    criterion: &mut Criterion,
    name: &str,
    system: &S,
    start: &S::Start,
) {
    let state = system.begin(start);
    let mut group = criterion.benchmark_group(name);
    group.bench_function("flight", |bencher| {
        bencher.iter(|| {
            let flight = system.flight(black_box(&state));
            flight.arrival(flight.reach())
        });
    });
    let flight = system.flight(&state);
    let (clearance, reach) = (system.clearance(), flight.reach());
    let contact = first_contact(&flight, clearance, reach);
    assert!(contact.contact.is_some(), "{name}: no contact within a flight");
    group.bench_function("contact", |bencher| {
        bencher.iter(|| first_contact(black_box(&flight), clearance, reach));
    });
    let (touching, _) = system.touch(&flight.arrival(contact.end), system.wall(&state));
    group.bench_function("impact", |bencher| {
        bencher.iter(|| system.impact(black_box(&touching), 1.0));
    });
    group.finish();
}

/// Times a whole chatter: the first impact on a pressing wall, and all that follow until it sticks.
fn chatter<S: Absorber<Real = f64>>(
    criterion: &mut Criterion,
    name: &str,
    system: &S,
    start: &S::Start,
) {
    let limits = Limits::new(0.5 * TAU, system.clearance());
    let Ok(seen) = run(system, start, &limits) else { return };
    let Some(stuck) = seen.episodes.first() else { return };
    let limits = Limits { duration: stuck.stick_time, ..limits };
    criterion.bench_function(&format!("{name}/chatter of {} impacts", stuck.impacts), |bencher| {
        bencher.iter(|| simulate(black_box(system), start, &limits, None, &mut ()));
    });
}

fn parts(criterion: &mut Criterion) {
    // Close to the wall and moving towards it.
    let near = Start { gap_displacement: 0.55, gap_velocity: 0.4, ..START };
    let pendulum = |e, clearance| {
        let pendulum = Parameters::point_bob(0.12, e, clearance, 0.01, 10.0);
        Piva::new(Parameters { frequency_ratio: 0.4, ..pendulum })
    };
    if let (Ok(siva), Ok(piva)) = (Siva::new(0.15, 0.5, 0.6, 0.01), pendulum(0.5, 0.6)) {
        of_a_run(criterion, "siva", &siva, &near);
        of_a_run(criterion, "piva", &piva, &PivaStart::from(near));
    }
    if let (Ok(siva), Ok(piva)) = (Siva::new(0.15, 0.5, 0.1, 0.01), pendulum(0.5, 0.1)) {
        chatter(criterion, "siva", &siva, &START);
        chatter(criterion, "piva", &piva, &START.into());
    }
}

criterion_group!(benches, parts);
criterion_main!(benches);
