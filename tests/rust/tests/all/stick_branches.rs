//! Branches of orbits with stick episodes, against runs that settle and the map over a period.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};

use iva_core::{
    absorber::{Absorber, Clock, Start},
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Cycle, Iterated, Request, Trajectory,
        branch::{Along, Branch, End, follow},
        chain::Chain,
        conditions::Kind,
        iterate,
        periodic::find,
    },
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    simulate::{Instant, Limits, resume},
    siva::Siva,
};
use iva_tests::rng::Rng;

/// μ, e, d, ζ, F and Ω.
type Scene = [f64; 6];
/// The scene of the record S1 of the references: chatter, stick and release on each wall.
const S1: Scene = [0.1, 0.5, 0.25, 0.02, 1.0, 0.7];
/// The place of a number in a scene.
const RESTITUTION: usize = 1;
const CLEARANCE: usize = 2;
const FORCE: usize = 4;

fn system(
    [mu, e, d, zeta, amplitude, frequency]: Scene,
) -> Result<(Siva<DrivenHost>, f64), Invalid> {
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic])?;
    Ok((Siva::new(mu, e, d, zeta)?.under(force), TAU / frequency))
}

fn with(scene: Scene, over: usize, value: f64) -> Scene {
    let mut changed = scene;
    changed[over] = value;
    changed
}

/// What a trajectory has come to after so many cycles, and the number of stick episodes in the last one.
fn settled<S: Iterated + Clone>(from: &Trajectory<S>, cycles: u32) -> (Trajectory<S>, u64) {
    let (mut count, mut last, mut rides) = (0, from.state, 0);
    iterate(std::slice::from_ref(from), Request::default(), &mut |_, image| {
        (count, last, rides) = (count + 1, image.state, image.rides);
        if count < cycles { Continue(()) } else { Break(()) }
    })
    .unwrap();
    (from.from(&last), rides)
}

/// A start in the middle of the gap.
fn begun(scene: Scene) -> Trajectory<Siva<DrivenHost>> {
    let (siva, period) = system(scene).unwrap();
    let start = Start { gap_velocity: 0.1, ..Start::default() };
    Trajectory::new(siva, &start, Cycle { begin: 0.0, length: period }).unwrap()
}

/// Follows what a run settles on; `None` if that is not periodic.
fn branch(scene: Scene, over: usize, between: [f64; 2], symmetric: bool) -> Option<Branch> {
    let orbit = find(&settled(&begun(scene), 300).0, symmetric, None).ok()?;
    let (chain, unknowns) = Chain::of(&orbit, 1).ok()?;
    let scenes = |values: &[f64]| system(with(scene, over, values[0]));
    follow(&scenes, (&chain, &unknowns), scene[over], Along::new(between))
}

/// Checks some orbits of a branch: a run comes back to them, the map finds them from nearby with the same multipliers, and
/// where they are stable a run from nearby settles on them. How many were stable.
fn judge<S: Coordinates + Iterated + Clone>(
    scenes: &dyn Fn(f64) -> Result<(S, f64), Invalid>,
    branch: &Branch,
    every: usize,
) -> usize {
    let (mut stable, mut worst) = (0, [0.0f64; 3]);
    for at in branch.points.iter().skip(2).step_by(every) {
        // Next to its end an impact is about to begin or to vanish, or rounding decides whether the absorber sticks.
        let brink = branch.special.iter().any(|it| (it.at.value - at.value).abs() < 1e-6);
        if at.margin < 1e-3 || at.slowest < 1e-2 || brink {
            continue;
        }
        let (system, period) = scenes(at.value).unwrap();
        let orbit = branch.chain.orbit(&system, period, &at.unknowns, 0.0).unwrap();
        let size = 1.0 + at.multipliers[0].norm();
        let on = system.coordinates(&orbit.trajectory.state);
        let moved = system.start_at(&(on * (1.0 + 1e-6))).unwrap();
        let nearby = Trajectory::new(system.clone(), &moved, orbit.trajectory.cycle).unwrap();
        let Ok(found) = find(&nearby, branch.chain.symmetric, None) else {
            // Next to a stick that begins a step of Newton's method may miss the chatter.
            assert!(!at.is_stable(), "{at:?}");
            continue;
        };
        let off = at.multipliers.iter().zip(found.multipliers).map(|(a, b)| (a - b).norm());
        worst[0] = worst[0].max(orbit.residual);
        worst[1] = worst[1].max(off.fold(0.0, f64::max) / size);
        if at.is_stable() && at.multipliers[0].norm() < 0.9 {
            let (settled, _) = settled(&nearby, 250);
            worst[2] = worst[2].max((system.coordinates(&settled.state) - on).amax());
            stable += 1;
        }
    }
    println!("{stable} stable, worst {worst:?}");
    assert!(worst[0] < 1e-13 && worst[1] < 1e-12 && worst[2] < 1e-10, "{worst:?}");
    stable
}

/// [`judge`] of a scene of a free mass with one of its numbers changed.
fn judge_mass(scene: Scene, over: usize, branch: &Branch, every: usize) -> usize {
    judge(&|value| system(with(scene, over, value)), branch, every)
}

/// Branches of the orbit of the references over clearance and force, by the half map and the map.
#[test]
fn orbits_of_a_branch_with_sticks_are_what_runs_settle_on() {
    for (over, between) in [(CLEARANCE, [0.2, 0.3]), (FORCE, [0.8, 1.25])] {
        for symmetric in [true, false] {
            let found = branch(S1, over, between, symmetric).unwrap();
            assert_eq!(found.ends, [End::Range; 2]);
            assert!(found.chain.sticks.iter().all(|sticks| *sticks));
            assert!(found.special.is_empty());
            assert!(judge_mass(S1, over, &found, 9) >= 5);
        }
    }
}

/// Where the stick of the orbit of the references begins: x scales with F and d, so that only d/F counts there, and the half
/// map and the map have it at the same place. On one side a run that has settled sticks, on the other it does not.
#[test]
fn a_branch_ends_where_its_stick_begins() {
    let mut ratios = Vec::new();
    for (over, between) in [(CLEARANCE, [0.24, 0.5]), (FORCE, [0.5, 1.1])] {
        for symmetric in [true, false] {
            let found = branch(S1, over, between, symmetric).unwrap();
            assert!(found.ends.contains(&End::StickBegins), "{:?}", found.ends);
            let [special] = found.special.as_slice() else { panic!("{:?}", found.special) };
            assert_eq!(special.condition.kind(), Kind::StickBegins);
            let scene = with(S1, over, special.at.value);
            println!("{over} {symmetric} {} {}", special.at.value, scene[CLEARANCE] / scene[FORCE]);
            ratios.push(scene[CLEARANCE] / scene[FORCE]);
        }
    }
    let [low, high] = [f64::min, f64::max].map(|of| ratios.iter().copied().reduce(of).unwrap());
    assert!(high - low < 1e-12, "{:e}", high - low);
    // Rebounds as low as 10⁻²⁵ decide it close by.
    for off in [1e-6, 1e-8, 1e-10, 1e-12] {
        for (off, sticks) in [(-off, true), (off, false)] {
            let (last, rides) = settled(&begun(with(S1, CLEARANCE, low + off)), 400);
            assert_eq!(rides > 0, sticks, "{off:e}");
            let Trajectory { system, state, cycle: Cycle { begin, length }, .. } = &last;
            let from = Instant { time: Clock::new(*begin), state: *state };
            let limits = Limits::new(begin + length, system.clearance());
            let tally = resume(system, &from, &limits, None, &mut ()).unwrap();
            assert_eq!(tally.undecided, 0, "{off:e}");
        }
    }
}

/// Plastic impacts stick at once while their wall presses.
#[test]
fn branches_of_plastic_impacts_are_made_of_orbits() {
    let scene = with(S1, RESTITUTION, 0.0);
    for symmetric in [true, false] {
        let found = branch(scene, CLEARANCE, [0.1, 1.0], symmetric).unwrap();
        println!("{:?} {:?} {} points", found.chain, found.ends, found.points.len());
        for special in &found.special {
            println!("   {:?} {}", special.condition, special.at.value);
        }
        assert!(judge_mass(scene, CLEARANCE, &found, 7) >= 5);
    }
}

/// Branches of random scenes with low restitution or a narrow gap, from what they settle on.
#[test]
fn random_branches_with_sticks_are_made_of_orbits() {
    let mut rng = Rng::new(82);
    let (mut count, mut stable, mut begins) = (0, 0, 0);
    for _ in 0..60 {
        let scene = [
            rng.range(0.02, 0.3),
            rng.range(0.1, 0.6),
            rng.range(0.05, 0.6),
            rng.range(0.01, 0.1),
            1.0,
            rng.range(0.5, 1.2),
        ];
        let between = [0.3 * scene[CLEARANCE], 2.0 * scene[CLEARANCE]];
        let Some(found) = branch(scene, CLEARANCE, between, false) else { continue };
        if !found.chain.sticks.contains(&true) {
            continue;
        }
        println!("{:?} {} points {:?}", found.chain, found.points.len(), found.ends);
        for special in &found.special {
            println!("   {:?} {}", special.condition, special.at.value);
        }
        stable += judge_mass(scene, CLEARANCE, &found, 10);
        begins += found.ends.iter().filter(|end| **end == End::StickBegins).count();
        count += 1;
        if count == 12 {
            break;
        }
    }
    println!("{count} branches, {stable} stable orbits, {begins} sticks that begin");
    assert!(count >= 8 && stable > 30 && begins > 3);
}

/// Branches of pendulums with small angles that stick to their stops.
#[test]
fn branches_of_pendulums_with_sticks_are_made_of_orbits() {
    let mut rng = Rng::new(83);
    let (mut count, mut stable) = (0, 0);
    for _ in 0..60 {
        let [mu, e, zeta] = [rng.range(0.02, 0.2), rng.range(0.1, 0.5), rng.range(0.02, 0.1)];
        let [ratio, frequency] = [rng.range(0.2, 0.8), rng.range(0.5, 1.1)];
        let first = rng.range(0.1, 0.5);
        let scenes = |values: &[f64]| {
            let parameters = Parameters {
                frequency_ratio: ratio,
                angles: Angles::Small,
                ..Parameters::point_bob(mu, e, values[0], zeta, values[0])
            };
            let harmonic = Harmonic { amplitude: 1.0, frequency, phase: 0.0, acts: Acts::Primary };
            let force = Force::harmonic(vec![harmonic])?;
            Ok((Piva::new(parameters)?.under(force), TAU / frequency))
        };
        let (piva, period) = scenes(&[first]).unwrap();
        let start = PivaStart {
            displacement: 0.0,
            velocity: 0.0,
            place: Given::Gap(0.0),
            rate: Given::Angle(0.1),
        };
        let cycle = Cycle { begin: 0.0, length: period };
        let begun = Trajectory::new(piva, &start, cycle).unwrap();
        let Ok(orbit) = find(&settled(&begun, 200).0, false, None) else { continue };
        let Ok((chain, unknowns)) = Chain::of(&orbit, 1) else { continue };
        if !chain.sticks.contains(&true) {
            continue;
        }
        let along = Along::new([0.7 * first, 1.5 * first]);
        let found = follow(&scenes, (&chain, &unknowns), first, along).unwrap();
        println!("{:?} {} points {:?}", found.chain, found.points.len(), found.ends);
        stable += judge(&|value| scenes(&[value]), &found, 20);
        count += 1;
        if count == 4 {
            break;
        }
    }
    assert!(count == 4 && stable > 4, "{count} {stable}");
}
