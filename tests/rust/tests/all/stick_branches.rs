//! Branches of orbits with stick episodes, against runs that settle and the map over a period.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};

use iva_core::{
    absorber::Start,
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Request, Trajectory,
        branch::{Along, Branch, BranchPoint, End, follow},
        chain::Chain,
        conditions::Kind,
        description::describe,
        iterate,
        periodic::{Orbit, find},
    },
    siva::Siva,
};

/// μ, e, d, ζ, F and Ω.
type Scene = [f64; 6];
/// The scene of the record S1 of the references: chatter, stick and release on each wall.
const S1: Scene = [0.1, 0.5, 0.25, 0.02, 1.0, 0.7];
/// The place of a number in a scene.
const RESTITUTION: usize = 1;
const CLEARANCE: usize = 2;
const FORCE: usize = 4;

fn system([mu, e, d, zeta, amplitude, frequency]: Scene) -> Result<(Siva<DrivenHost>, f64), Invalid> {
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic])?;
    Ok((Siva::new(mu, e, d, zeta)?.under(force), TAU / frequency))
}

fn with(scene: Scene, over: usize, value: f64) -> Scene {
    let mut changed = scene;
    changed[over] = value;
    changed
}

/// What a run from some start has come to after so many periods.
fn settled(scene: Scene, start: &Start, periods: u32) -> Trajectory<Siva<DrivenHost>> {
    let (siva, period) = system(scene).unwrap();
    let begun = Trajectory::new(siva, start, Cycle { begin: 0.0, length: period }).unwrap();
    let (mut count, mut last) = (0, begun.state);
    iterate(std::slice::from_ref(&begun), Request::default(), &mut |_, image| {
        (count, last) = (count + 1, image.state);
        if count < periods { Continue(()) } else { Break(()) }
    })
    .unwrap();
    begun.from(&last)
}

/// Follows what a run settles on.
fn branch(scene: Scene, over: usize, between: [f64; 2], symmetric: bool) -> Branch {
    let start = Start { gap_velocity: 0.1, ..Start::default() };
    let orbit = find(&settled(scene, &start, 300), symmetric, None).unwrap();
    let (chain, unknowns) = Chain::of(&orbit, 1).unwrap();
    let scenes = |values: &[f64]| system(with(scene, over, values[0]));
    follow(&scenes, (&chain, &unknowns), scene[over], Along::new(between)).unwrap()
}

#[test]
fn look() {
    for (over, between) in [(CLEARANCE, [0.05, 1.5]), (FORCE, [0.2, 4.0])] {
        for symmetric in [true, false] {
            let found = branch(S1, over, between, symmetric);
            println!("{over} {symmetric} {:?} {} {:?}", found.chain, found.points.len(), found.ends);
            for special in &found.special {
                println!("   {:?} {} {:?}", special.condition, special.at.value, special.at.multipliers[0]);
            }
        }
    }
}
