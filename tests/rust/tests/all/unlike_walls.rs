//! Unequal stops: another restitution at wall −, and a gap whose middle is not at y = 0.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{Start, Wall},
    force::Force,
    measures::Wanted,
    observe::Events,
    piva::{Parameters, Piva},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::side_by_side::{self, Job, Tier},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::Siva,
};
use iva_tests::{U, rng::Rng};

/// A mass ratio so small that the absorber does not affect the structure.
const LIGHT: f64 = 1e-20;

/// A free mass with its restitutions at walls + and −, and the middle of its gap.
fn free_mass<R: Real>(
    mu: f64,
    e: [f64; 2],
    d: f64,
    offset: f64,
    zeta: f64,
) -> Siva<iva_core::host::UndrivenHost<R>> {
    let [plus, minus] = e.map(R::from);
    let siva = Siva::new(mu.into(), plus, d.into(), zeta.into()).unwrap();
    siva.with_restitution_minus(minus).unwrap().with_offset(offset.into()).unwrap()
}

#[test]
fn between_walls_at_rest_each_impact_takes_its_own_share() {
    // Without gravity the mass crosses the play 2d at its speed after the last impact: after n impacts that
    // is the product of their restitutions.
    for (e, offset) in [([0.5, 0.8], 0.0), ([0.9, 0.25], 0.125), ([1.0, 0.5], -0.25)] {
        let siva = free_mass(LIGHT, e, 0.5, offset, 0.02);
        let start = Start { gap_velocity: 1.0, ..Start::default() };
        let found = run(&siva, &start, &Limits::new(60.0, 0.5)).unwrap();
        assert!(found.impacts.len() >= 4, "{}", found.impacts.len());
        let (mut time, mut speed) = (0.5 + offset, 1.0);
        for (n, impact) in found.impacts.iter().enumerate() {
            let (wall, e) = if n % 2 == 0 { (Wall::Plus, e[0]) } else { (Wall::Minus, e[1]) };
            assert_eq!(impact.wall, wall);
            assert!((impact.time - time).abs() <= 8.0 * U * time, "{n}: {} {time}", impact.time);
            assert!((impact.approach_speed() - speed).abs() <= 8.0 * U * speed, "{n}");
            let loss = 0.5 * LIGHT * (1.0 - e * e) * speed * speed;
            assert!((impact.energy_loss - loss).abs() <= 16.0 * U * LIGHT, "{n}");
            speed *= e;
            time += 1.0 / speed;
        }
        let [plus, minus] = found.tally.approach_speeds;
        assert_eq!(plus, 1.0);
        assert!((minus - e[0]).abs() <= 4.0 * U, "{minus}");
    }
}

#[test]
fn on_the_lower_stop_a_ball_comes_to_rest_by_the_restitution_of_that() {
    // Leaving the lower stop with w, on a structure at rest, it returns after 2w/G, and sticks after 2w/(G
    // (1 − e)).
    for (below, above) in [(0.5, 0.9), (0.8, 0.1), (0.3, 1.0)] {
        let (gravity, w) = (2.0, 0.75);
        let siva =
            free_mass(LIGHT, [above, below], 1.0, 0.0, 0.0).inclined(gravity, Force::default());
        let start = Start { gap_displacement: -1.0, gap_velocity: w, ..Start::default() };
        let found = run(&siva, &start, &Limits::new(10.0, 1.0)).unwrap();
        assert_eq!(found.episodes.len(), 1);
        let rest = 2.0 * w / (gravity * (1.0 - below));
        let stick = found.episodes[0].stick_time;
        assert!((stick - rest).abs() <= 16.0 * U * rest, "{stick} {rest}");
        assert_eq!(found.episodes[0].wall, Wall::Minus);
    }
}

/// A random free mass and the start of its decay.
fn random(rng: &mut Rng) -> ([f64; 5], Start) {
    let numbers = [
        rng.log_range(0.02, 0.3),
        rng.range(0.2, 0.95),
        rng.range(0.2, 0.95),
        rng.log_range(0.1, 1.0),
        rng.pick(&[0.0, 0.01, 0.05]),
    ];
    let start = Start {
        displacement: rng.range(0.5, 2.0),
        velocity: rng.range(-1.0, 1.0),
        gap_displacement: rng.range(-0.9, 0.9) * numbers[3],
        gap_velocity: rng.range(-0.5, 0.5),
    };
    (numbers, start)
}

fn mirrored(start: &Start) -> Start {
    let Start { displacement, velocity, gap_displacement, gap_velocity } = *start;
    Start {
        displacement: -displacement,
        velocity: -velocity,
        gap_displacement: -gap_displacement,
        gap_velocity: -gap_velocity,
    }
}

/// Checks for the same impacts at the opposite walls, to the bit.
fn assert_mirrored<S>(one: &Run<S>, other: &Run<S>) {
    assert_eq!(one.impacts.len(), other.impacts.len());
    for (a, b) in one.impacts.iter().zip(&other.impacts) {
        assert_eq!((a.time, a.wall, a.energy_loss), (b.time, b.wall.opposite(), b.energy_loss));
        assert_eq!((a.velocity_after, a.displacement), (-b.velocity_after, -b.displacement));
    }
    assert_eq!(one.episodes.len(), other.episodes.len());
}

#[test]
fn exchanged_walls_mirror_the_motion_and_equal_ones_change_nothing() {
    let mut rng = Rng::new(11);
    let mut impacts = 0;
    for _ in 0..100 {
        let ([mu, e, f, d, zeta], start) = random(&mut rng);
        let limits = Limits::new(10.0 * TAU, d);
        let one = run(&free_mass(mu, [e, f], d, 0.0, zeta), &start, &limits).unwrap();
        let other = run(&free_mass(mu, [f, e], d, 0.0, zeta), &mirrored(&start), &limits).unwrap();
        assert_mirrored(&one, &other);
        impacts += one.impacts.len();
        let plain = run(&Siva::new(mu, e, d, zeta).unwrap(), &start, &limits).unwrap();
        assert_eq!(run(&free_mass(mu, [e, e], d, 0.0, zeta), &start, &limits).unwrap(), plain);

        let point_bob = Parameters::point_bob(mu, e, d, zeta, 5.0);
        let pendulum = |e: f64, f: f64| {
            let parameters = Parameters { restitution: e, frequency_ratio: 0.3, ..point_bob };
            Piva::new(parameters).unwrap().with_restitution_minus(f).unwrap()
        };
        let one = run(&pendulum(e, f), &start.into(), &limits).unwrap();
        let other = run(&pendulum(f, e), &mirrored(&start).into(), &limits).unwrap();
        assert_mirrored(&one, &other);
        let plain = Piva::new(Parameters { frequency_ratio: 0.3, ..point_bob }).unwrap();
        let plain = run(&plain, &start.into(), &limits).unwrap();
        assert_eq!(run(&pendulum(e, e), &start.into(), &limits).unwrap(), plain);
        for (impact, ratio) in
            one.impacts.iter().map(|it| (it, if it.wall == Wall::Plus { e } else { f }))
        {
            let [before, after] = [impact.gap_velocity_before, impact.gap_velocity_after];
            assert!((after + ratio * before).abs() <= 4.0 * U * before.abs());
        }
    }
    assert!(impacts > 2000, "{impacts}");
}

#[test]
fn an_offset_is_a_start_elsewhere_in_the_gap() {
    // The numbers have few digits: adding the offset is exact, and both runs are equal to the bit.
    for (offset, y) in [(0.25, 0.125), (-0.375, 0.0), (4.0, -0.25)] {
        let limits = Limits::new(10.0 * TAU, 0.5);
        let start = |y| Start {
            displacement: 1.0,
            gap_displacement: y,
            gap_velocity: 0.25,
            ..Start::default()
        };
        let middle = run(&free_mass(0.1, [0.6, 0.6], 0.5, 0.0, 0.01), &start(y), &limits).unwrap();
        let beside =
            run(&free_mass(0.1, [0.6, 0.6], 0.5, offset, 0.01), &start(offset + y), &limits);
        assert!(middle.impacts.len() > 5);
        assert_eq!(beside.unwrap(), middle);
    }
    let outside = Start { gap_displacement: 0.0, ..Start::default() };
    let refused =
        run(&free_mass(0.1, [0.6, 0.6], 0.5, 1.0, 0.01), &outside, &Limits::new(1.0, 0.5));
    let message = refused.unwrap_err().to_string();
    assert!(
        message.contains("start.gap_displacement") && message.contains("from 0.5 to 1.5"),
        "{message}"
    );
}

#[test]
fn its_errors_are_what_is_estimated_and_its_energies_add_up() {
    // The run in numbers of twice the precision gives the exact values.
    let mut rng = Rng::new(7);
    let (mut compared, mut beyond) = (0, 0);
    for _ in 0..60 {
        let ([mu, e, f, d, zeta], start) = random(&mut rng);
        let mut seen = (Events::default(), Errors::default());
        let siva = free_mass::<f64>(mu, [e, f], d, 0.0, zeta);
        let limits = Limits::new(8.0 * TAU, d);
        simulate(&siva, &start, &limits, None, &mut seen).unwrap();
        let found = run(&siva, &start, &limits).unwrap();
        assert_eq!(found.tally.outcome, Outcome::Finished);
        let energy = found.measures.energy_initial;
        assert!(found.measures.energy_residual.abs() <= 2e-14 * energy, "{found:?}");
        let of = Twofold::from;
        let precise = Start {
            displacement: of(start.displacement),
            velocity: of(start.velocity),
            gap_displacement: of(start.gap_displacement),
            gap_velocity: of(start.gap_velocity),
        };
        let limits = Limits::new(of(8.0 * TAU), of(d));
        let truth =
            run(&free_mass::<Twofold>(mu, [e, f], d, 0.0, zeta), &precise, &limits).unwrap();
        let (Events { impacts, .. }, errors) = seen;
        for ((impact, truth), error) in impacts.iter().zip(&truth.impacts).zip(&errors.impacts) {
            let Some(estimate) = error.time.filter(|error| *error < 1e-10) else { break };
            assert_eq!(impact.wall, truth.wall);
            let error = f64::from(Twofold::from(impact.time) - truth.time).abs();
            (compared, beyond) = (compared + 1, beyond + usize::from(error > estimate));
            assert!(error <= 3.0 * estimate, "{error:e} {estimate:e}");
        }
    }
    assert!(compared > 800 && beyond <= compared / 1000, "{beyond} of {compared}");
}

#[test]
fn beside_others_it_runs_as_alone() {
    let mut rng = Rng::new(3);
    let mut jobs = Vec::new();
    for index in 0..20 {
        let ([mu, e, f, d, zeta], start) = random(&mut rng);
        let e = if index % 3 == 0 { [e, e] } else { [e, f] };
        let system = free_mass(mu, e, d, 0.0, zeta);
        let limits = Limits::new(6.0 * TAU, d);
        jobs.push(Job { system, start, begin: 0.0, limits, steady: None, tier: Tier::Exact });
    }
    let mut seen = 0;
    side_by_side::run(&jobs, Wanted::ALL, None, &mut |index, (tally, measures, _)| {
        let alone = run(&jobs[index].system, &jobs[index].start, &jobs[index].limits).unwrap();
        assert_eq!((tally, measures), (&alone.tally, &alone.measures));
        seen += 1;
    })
    .unwrap();
    assert_eq!(seen, jobs.len());
}

#[test]
fn its_derivative_has_the_determinant_of_both_restitutions() {
    // Liouville's formula: a time T of flight gives exp(−2ζT), an impact with restitution e gives e².
    let (e, zeta, duration) = ([0.95, 0.8], 0.02, 12.0);
    let siva: Siva = free_mass(0.1, e, 0.4, 0.0, zeta);
    let start = Start { displacement: 1.0, ..Start::default() };
    let mut seen = (Events::default(), Errors::default());
    let tally = simulate(&siva, &start, &Limits::new(duration, 0.4), None, &mut seen).unwrap();
    let (events, errors) = seen;
    assert!(tally.episodes == 0 && tally.impacts > 8, "{tally:?}");
    let of_impact = |wall: Wall| siva.restitution(wall).powi(2);
    let impacts: f64 = events.impacts.iter().map(|impact| of_impact(impact.wall)).product();
    let truth = (-2.0 * zeta * duration).exp() * impacts;
    let found = errors.derivative().unwrap().determinant();
    assert!((found / truth - 1.0).abs() < 1e-9, "{found} {truth}");
}
