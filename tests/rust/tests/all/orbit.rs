//! Maps over whole cycles of a drive: periodic orbits close, their multipliers are those of the 50-digit reference, and
//! lanes have the bits of single maps.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};

use iva_core::{
    absorber::{Absorber, Clock, OnStructure, Start, Wall},
    force::{Acts, Force, Harmonic},
    host::{DrivenHost, Host},
    orbit::{Cycle, Image, Iterated, Request, Trajectory, iterate, map},
    piva::{Angles, Parameters, Piva, PivaStart},
    run::side_by_side::Tier,
    simulate::{Instant, Limits, Outcome, resume},
    siva::Siva,
};
use iva_tests::pendulum_list::still;
use iva_tests::rng::Rng;
use nalgebra::{Complex, DMatrix};
use serde_json::Value;

type Mass = Siva<DrivenHost>;

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

/// A free mass under F cos(Ωτ + φ), or on a base with that acceleration.
fn mass([mu, e, d, zeta]: [f64; 4], harmonic: Harmonic) -> Mass {
    Siva::new(mu, e, d, zeta).unwrap().under(Force::harmonic(vec![harmonic]).unwrap())
}

fn pushed(amplitude: f64, frequency: f64) -> Harmonic {
    Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary }
}

/// The orbits of `tests/reference/orbits.json`: name, trajectory over one of its cycles, and the record.
fn orbits() -> Vec<(String, Trajectory<Mass>, Value)> {
    let file: Vec<Value> =
        serde_json::from_str(include_str!("../../../reference/orbits.json")).unwrap();
    let read = |record: Value| {
        let key = |name: &str| number(&record["scene"][name]);
        let given = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
        let siva = mass(given, pushed(key("force_amplitude_per_mass"), key("frequency")));
        let at = |name: &str| number(&record["state_at_time_0"][name]);
        let start = Start {
            displacement: at("displacement"),
            velocity: at("velocity"),
            gap_displacement: at("gap_displacement"),
            gap_velocity: at("gap_velocity"),
        };
        let periods = record["forcing_periods"].as_f64().unwrap();
        let cycle = Cycle { begin: 0.0, length: periods * TAU / key("frequency") };
        let trajectory = Trajectory::new(siva, &start, cycle).unwrap();
        (record["id"].as_str().unwrap().to_string(), trajectory, record)
    };
    file.into_iter().map(read).collect()
}

/// x, ẋ, y and ẏ of a state.
fn places(siva: &Mass, state: &<Mass as OnStructure>::State) -> [f64; 4] {
    let (primary, gap) = (siva.primary(state), siva.distance(state));
    let side = siva.wall(state).sign();
    [primary.x, primary.v, side * (siva.clearance() - gap.value), -side * gap.rate]
}

/// The multipliers, largest first.
fn multipliers(tangent: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let mut all: Vec<_> = tangent.complex_eigenvalues().iter().copied().collect();
    all.sort_by(|p, q| q.norm().total_cmp(&p.norm()).then(q.im.total_cmp(&p.im)));
    all
}

#[test]
fn orbits_close_and_have_their_multipliers() {
    for (name, trajectory, record) in orbits() {
        let image = map(&trajectory, true, None).unwrap();
        assert_eq!(image.outcome, Outcome::Finished);
        if let Some(impacts) = record["impacts"].as_u64() {
            assert_eq!(image.impacts, impacts, "{name}");
        }
        let tangent = image.tangent.unwrap().matrix;
        // Rounding of start and parameters grows by the derivative of the map.
        let growth = 1.0 + tangent.amax();
        let [from, to] =
            [&trajectory.state, &image.state].map(|state| places(&trajectory.system, state));
        for (from, to) in from.iter().zip(&to) {
            assert!((from - to).abs() <= 3e-15 * growth, "{name}: {from} {to}");
        }
        // Of the chatters of S1 the rest from a rebound on is summed, which lasts 10⁻⁶.
        let allowed = 1e-13;
        let truth = record["multipliers"].as_array().unwrap();
        for (found, truth) in multipliers(&tangent).iter().zip(truth) {
            let truth = Complex::new(number(&truth[0]), number(&truth[1]));
            assert!((found - truth).norm() <= allowed, "{name}: {found} {truth}");
        }
    }
}

/// Free masses under force or on a moving base, at any phase of it, some of them in chatter and stuck.
fn random_trajectories(count: usize) -> Vec<Trajectory<Mass>> {
    let mut rng = Rng::new(42);
    let mut uniform = |from, to| rng.range(from, to);
    let one = |_| {
        let frequency = uniform(0.5, 2.0);
        let acts = if uniform(0.0, 1.0) < 0.5 { Acts::Primary } else { Acts::Base };
        let (amplitude, phase) = (uniform(0.02, 0.3), uniform(-3.0, 3.0));
        let d = uniform(0.1, 0.8);
        let given = [uniform(0.02, 0.3), uniform(0.2, 0.9), d, uniform(0.0, 0.1)];
        let siva = mass(given, Harmonic { amplitude, frequency, phase, acts });
        let start = Start {
            displacement: uniform(-0.5, 0.5),
            velocity: uniform(-0.5, 0.5),
            gap_displacement: d * [uniform(-1.0, 1.0), 1.0][usize::from(uniform(0.0, 1.0) < 0.2)],
            gap_velocity: uniform(-0.3, 0.3),
        };
        let length = TAU / frequency * uniform(1.0, 3.0).floor();
        Trajectory::new(siva, &start, Cycle { begin: uniform(0.0, 9.0), length }).unwrap()
    };
    (0..count).map(one).collect()
}

/// Pendulums at large angles and small, some without force, some with a spring, in full accuracy and with a tolerance.
fn random_pendulums<H: Host<Real = f64>>(
    count: usize,
    under: impl Fn(Piva, Harmonic) -> Piva<H>,
) -> Vec<Trajectory<Piva<H>>> {
    let mut rng = Rng::new(43);
    let mut uniform = |from, to| rng.range(from, to);
    let one = |k: usize| {
        let (frequency, phase) = (uniform(0.5, 2.0), uniform(-3.0, 3.0));
        let acts = if uniform(0.0, 1.0) < 0.5 { Acts::Primary } else { Acts::Base };
        let d = uniform(0.1, 0.8);
        let bob = Parameters::point_bob(uniform(0.02, 0.3), uniform(0.2, 0.9), d, 0.02, 2.0);
        let angles = if k.is_multiple_of(3) { Angles::Small } else { Angles::Large };
        let (frequency_ratio, tolerance) = (uniform(0.1, 1.0), [0.0, 1e-9][k % 2]);
        let spring_ratio = [0.0, 0.0, 0.0, 0.4][k % 4];
        let parameters = Parameters { frequency_ratio, angles, tolerance, spring_ratio, ..bob };
        let harmonic = Harmonic { amplitude: uniform(0.02, 0.3), frequency, phase, acts };
        let piva = under(Piva::new(parameters).unwrap(), harmonic);
        let start = Start {
            displacement: uniform(-0.5, 0.5),
            velocity: uniform(-0.5, 0.5),
            gap_displacement: d * [uniform(-1.0, 1.0), 1.0][usize::from(uniform(0.0, 1.0) < 0.2)],
            gap_velocity: uniform(-0.3, 0.3),
        };
        let cycle = Cycle { begin: uniform(0.0, 9.0), length: TAU / frequency };
        Trajectory::new(piva, &PivaStart::from(start), cycle).unwrap()
    };
    (0..count).map(one).collect()
}

/// The number of impacts in the first images of some trajectories, which must be those of single maps.
fn impacts_alike<S: Iterated + Clone>(trajectories: &[Trajectory<S>]) -> u64
where
    S::State: PartialEq,
{
    let mut impacts = 0;
    for (trajectory, images) in trajectories.iter().zip(together(trajectories, 15, false)) {
        let mut at = trajectory.clone();
        assert_eq!(images.len(), 15);
        for image in images {
            assert_eq!(image, map(&at, false, None).unwrap());
            impacts += image.impacts;
            at = at.from(&image.state);
        }
    }
    impacts
}

/// The first images of some trajectories, all computed together.
fn together<S: Iterated>(
    trajectories: &[Trajectory<S>],
    count: usize,
    tangents: bool,
) -> Vec<Vec<Image<S::State>>> {
    let mut all: Vec<_> = trajectories.iter().map(|_| Vec::new()).collect();
    let request = Request { tangents, cancel: None };
    iterate(trajectories, request, &mut |index, image| {
        all[index].push(image.clone());
        if all[index].len() < count { Continue(()) } else { Break(()) }
    })
    .unwrap();
    all
}

#[test]
fn lanes_have_the_bits_of_single_maps() {
    let trajectories = random_trajectories(150);
    let mut impacts = 0;
    for (trajectory, images) in trajectories.iter().zip(together(&trajectories, 20, true)) {
        let mut at = trajectory.clone();
        assert_eq!(images.len(), 20);
        for image in images {
            let alone = map(&at, true, None).unwrap();
            assert_eq!((image.state, image.impacts), (alone.state, alone.impacts));
            assert_eq!(image.outcome, Outcome::Finished);
            // Lanes know the velocities before an impact as plain numbers.
            let [one, other] = [&image, &alone].map(|it| &it.tangent.as_ref().unwrap().matrix);
            assert!((one - other).amax() <= 1e-12 * other.amax());
            impacts += image.impacts;
            at = at.from(&image.state);
        }
    }
    assert!(impacts > 5000, "{impacts}");
}

#[test]
fn lanes_of_pendulums_have_the_bits_of_single_maps() {
    let driven = random_pendulums(100, |piva, harmonic| {
        piva.under(Force::harmonic(vec![harmonic]).unwrap())
    });
    let free = random_pendulums(40, |piva, _| still(&piva));
    let impacts = [impacts_alike(&driven), impacts_alike(&free)];
    assert!(impacts[0] > 1500 && impacts[1] > 300, "{impacts:?}");
}

#[test]
fn a_map_is_a_run_over_the_cycle() {
    for trajectory in random_trajectories(50) {
        let Trajectory { system, cycle, state, .. } = &trajectory;
        let image = map(&trajectory, false, None).unwrap();
        let limits = Limits::new(cycle.begin + cycle.length, system.clearance());
        let from = Instant { time: Clock::new(cycle.begin), state: *state };
        let tally = resume(system, &from, &limits, None, &mut ()).unwrap();
        assert_eq!(places(system, &tally.state), places(system, &image.state));
        assert_eq!(tally.impacts, image.impacts);
        assert_eq!(image.tangent, None);
    }
}

/// Without sticks the determinant is e²ᴺ exp(−2ζT), N impacts: each has e², and the flow loses what the damper does.
#[test]
fn the_determinant_is_that_of_impacts_and_damper() {
    let trajectories = random_trajectories(150);
    let mut seen = 0;
    for (trajectory, images) in trajectories.iter().zip(together(&trajectories, 5, true)) {
        let Trajectory { system, cycle, .. } = trajectory;
        let e = system.restitution(Wall::Plus);
        let flow = (-2.0 * system.damping_ratio() * cycle.length).exp();
        for image in images {
            let tangent = image.tangent.unwrap().matrix;
            let expected = flow * e.powi(2 * image.impacts as i32);
            let found = tangent.determinant();
            // A stick makes it 0, and rebounds that are summed are not counted.
            if found.abs() > 1e-3 * expected {
                // The determinant of large numbers that cancel.
                let scale = tangent.amax().powi(4);
                assert!(
                    (found - expected).abs() <= 1e-13 * (expected + scale),
                    "{found} {expected}"
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 300, "{seen}");
}

/// The derivative is the limit of differences of images.
#[test]
fn the_derivative_is_that_of_differences() {
    let mut seen = 0;
    for trajectory in random_trajectories(100) {
        let system = &trajectory.system;
        let image = map(&trajectory, true, None).unwrap();
        let tangent = image.tangent.unwrap().matrix;
        let step = 1e-6;
        let start = |by: [f64; 4]| {
            let [x, v, y, w] = places(system, &trajectory.state);
            let start = Start {
                displacement: x + by[0],
                velocity: v + by[1],
                gap_displacement: y + by[2],
                gap_velocity: w + by[3],
            };
            let there = Trajectory::new(system.clone(), &start, trajectory.cycle).ok()?;
            let image = map(&there, false, None).unwrap();
            Some((places(system, &image.state), image.impacts))
        };
        for k in 0..4 {
            let mut by = [0.0; 4];
            by[k] = step;
            let ahead = start(by);
            by[k] = -step;
            let (Some((ahead, more)), Some((behind, fewer))) = (ahead, start(by)) else { continue };
            // Not across a grazing or the begin of a stick, nor where the second difference is large.
            if more != fewer || more != image.impacts || tangent.amax() > 30.0 {
                continue;
            }
            for i in 0..4 {
                let difference = (ahead[i] - behind[i]) / (2.0 * step);
                let off = (difference - tangent[(i, k)]).abs();
                assert!(off <= 1e-4 * (1.0 + tangent.amax()), "{difference} {tangent}");
                seen += 1;
            }
        }
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn the_fast_tier_is_the_exact_one_to_rounding() {
    let exact = random_trajectories(100);
    let fast: Vec<_> =
        exact.iter().map(|it| Trajectory { tier: Tier::Fast, ..it.clone() }).collect();
    let (mut differing, pairs) =
        (0, together(&fast, 1, true).into_iter().zip(together(&exact, 1, true)));
    for (Trajectory { system, .. }, (fast, exact)) in exact.iter().zip(pairs) {
        let [fast, exact] = [&fast[0], &exact[0]];
        let tangent = &exact.tangent.as_ref().unwrap().matrix;
        let [x, y] = [fast, exact].map(|image| places(system, &image.state));
        for (x, y) in x.iter().zip(&y) {
            assert!((x - y).abs() <= 1e-14 * (1.0 + tangent.amax()), "{x} {y}");
            differing += u32::from(x != y);
        }
        assert_eq!(fast.impacts, exact.impacts);
        let off = (&fast.tangent.as_ref().unwrap().matrix - tangent).amax();
        assert!(off <= 1e-12 * (1.0 + tangent.amax().powi(2)), "{off:e}");
    }
    assert!(differing > 100, "{differing}");
}

#[test]
fn a_pendulum_is_mapped_and_its_determinant_is_known() {
    // At small angles as for a free mass (`the_determinant_is_that_of_impacts_and_damper`).
    let force = Force::harmonic(vec![pushed(1.0, 1.0)]).unwrap();
    let parameters =
        Parameters { frequency_ratio: 1.07, ..Parameters::free_mass(0.29, 0.59, 2.0, 0.08) };
    let piva = Piva::new(parameters).unwrap().under(force);
    let start = PivaStart::from(Start { displacement: 0.7, gap_velocity: 0.5, ..Start::default() });
    let cycle = Cycle { begin: 0.0, length: TAU };
    let mut at = Trajectory::new(piva, &start, cycle).unwrap();
    let mut impacts = 0;
    iterate(&[at.clone()], Request { tangents: true, cancel: None }, &mut |_, image| {
        assert_eq!(map(&at, true, None).unwrap(), *image);
        let expected = 0.59_f64.powi(2 * image.impacts as i32) * (-0.16 * TAU).exp();
        let tangent = &image.tangent.as_ref().unwrap().matrix;
        assert!((tangent.determinant() / expected - 1.0).abs() <= 1e-11, "{tangent}");
        impacts += image.impacts;
        at = at.from(&image.state);
        if impacts < 20 { Continue(()) } else { Break(()) }
    })
    .unwrap();
}

#[test]
fn what_cannot_go_on_ends_with_a_reason() {
    let trajectories = random_trajectories(20);
    let cancel = AtomicBool::new(true);
    let request = Request { tangents: false, cancel: Some(&cancel) };
    assert_eq!(map(&trajectories[0], false, Some(&cancel)).unwrap().outcome, Outcome::Cancelled);
    let mut images = 0;
    cancel.store(false, Ordering::Relaxed);
    iterate(&trajectories, request, &mut |_, _| {
        images += 1;
        cancel.store(images >= 1000, Ordering::Relaxed);
        Continue(())
    })
    .unwrap();
    assert!((1000..3000).contains(&images), "{images}");
    for (begin, length, field) in [
        (0.0, f64::NAN, "cycle.length"),
        (5.0, 0.0, "cycle.length"),
        (5.0, -1.0, "cycle.length"),
        (f64::INFINITY, 1.0, "cycle.begin"),
        (-1.0, 3.0, "cycle.begin"),
        (1e9, 1e-9, "cycle.begin"),
    ] {
        let mut bad = trajectories[0].clone();
        bad.cycle = Cycle { begin, length };
        let refused = [
            map(&bad, false, None).map(|_| ()),
            iterate(&[bad], Request::default(), &mut |_, _| Continue(())),
        ];
        for refused in refused {
            assert!(refused.unwrap_err().to_string().starts_with(field), "{begin} {length}");
        }
    }
}

/// Trajectories that no lane ever takes do not fill the stack.
#[test]
fn very_many_stuck_masses_are_mapped() {
    // A stuck mass presses on its wall with F, and the cycle is short.
    let siva = mass([0.1, 0.5, 0.2, 0.02], pushed(1.0, 1.0));
    let start = Start { gap_displacement: -0.2, ..Start::default() };
    let cycle = Cycle { begin: 0.0, length: 1e-3 };
    let stuck = Trajectory::new(siva, &start, cycle).unwrap();
    let all = vec![stuck; 100_000];
    let mut seen = 0;
    iterate(&all, Request::default(), &mut |_, image| {
        assert_eq!((image.impacts, image.outcome), (0, Outcome::Finished));
        assert_eq!(all[0].system.distance(&image.state).value, 0.0);
        seen += 1;
        Break(())
    })
    .unwrap();
    assert_eq!(seen, 100_000);
}
