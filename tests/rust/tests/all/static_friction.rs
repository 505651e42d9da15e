//! Free masses with more friction at rest than in a slide.
//!
//! Numbers come from closed forms: a mass of 10⁻²⁸ on a structure that swings as sin t is held until |sin t| = Rₛ, slides with the
//! deceleration R until the gap velocity is 0, and is held or slides back; and a mass that a structure at rest lets go uphill on a line that rises.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::Wall,
    absorber::modal::{Modal, ModalStart, ModalStructure},
    flight::GapPoint,
    host::UndrivenHost,
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::rng::Rng;

/// A mass of 10⁻²⁸ with R and Rₛ, in a gap of clearance d, on an undamped mode of frequency 1.
fn system(d: f64, e: f64, [sliding, at_rest]: [f64; 2], gravity: f64) -> Modal<UndrivenHost, 1> {
    let structure = ModalStructure::new(&[1.0], &[0.0]).unwrap();
    let structure = structure.with_point("p", &[1.0]).unwrap();
    let system = Modal::new(structure, [(FreeMass::new(1e-28, e, d).unwrap(), "p")]).unwrap();
    let system = system.with_gravity(&[gravity]).unwrap().with_friction(&[sliding]).unwrap();
    system.with_static_friction(&[at_rest]).unwrap()
}

/// The root of a function that changes its sign between two instants.
fn root(f: impl Fn(f64) -> f64, [mut from, mut to]: [f64; 2]) -> f64 {
    let sign = f(from).signum();
    for _ in 0..200 {
        let middle = 0.5 * (from + to);
        if f(middle) * sign > 0.0 { from = middle } else { to = middle }
    }
    to
}

/// When a mass stops that has slid off at an instant with the sign s: its gap velocity is −s R (t − t₁) − cos t + cos t₁.
fn stop([sliding, sign]: [f64; 2], begin: f64) -> f64 {
    let w = |t: f64| sign * (begin.cos() - t.cos()) - sliding * (t - begin);
    // The gap velocity grows at first.
    let mut later = begin + 0.05;
    while w(later) > 0.0 {
        later += 0.05;
    }
    root(w, [later - 0.05, later])
}

/// Slips and stops over three periods, with stops that hold and stops that turn the mass round, as often as not.
#[test]
fn a_mass_slips_at_the_larger_and_slides_at_the_smaller_friction() {
    let mut rng = Rng::new(78);
    let [mut slips, mut turns] = [0, 0];
    for scene in 0..300 {
        let at_rest = rng.range(0.1, 0.95);
        let sliding = at_rest * rng.range(0.05, 0.99);
        let duration = 18.0;
        let (mut time, mut held, mut stops) = (0.0, 0.0, 0);
        let mut since = Some(0.0);
        // How near a decision was.
        let mut nearest = f64::INFINITY;
        loop {
            // A = −sin t: the mass lags behind with the sign of sin t.
            let (begin, sign) = if let Some(begin) = since {
                let over = |t: f64| f64::sin(t).abs() - at_rest;
                let mut slip = time;
                while over(slip) < 0.0 && slip < duration {
                    slip += 1e-3;
                }
                let slip = if slip > time { root(over, [slip - 1e-3, slip]) } else { slip };
                if slip >= duration {
                    held += duration - begin;
                    break;
                }
                held += slip - begin;
                slips += 1;
                (slip, slip.sin().signum())
            } else {
                turns += 1;
                (time, time.sin().signum())
            };
            time = stop([sliding, sign], begin);
            nearest = nearest.min((time - duration).abs());
            if time >= duration {
                break;
            }
            stops += 1;
            let needed = time.sin().abs();
            nearest = nearest.min((needed - at_rest).abs());
            since = (needed <= at_rest).then_some(time);
        }
        if nearest < 1e-6 {
            continue;
        }
        let system = system(50.0, 0.5, [sliding, at_rest], 0.0);
        let start = ModalStart::new(&[0.0], &[1.0], [GapPoint { y: 0.0, w: 0.0 }]).unwrap();
        let found = run(&system, &start, &Limits::new(duration, 1e-9)).unwrap().tally;
        assert_eq!(found.outcome, Outcome::Finished);
        assert_eq!(found.friction.stops, stops, "scene {scene}: {sliding} {at_rest}");
        let off = found.friction.time_held.value - held;
        // A stop is where two speeds meet that differ in their rates by 1 − R/Rₛ at least.
        assert!(off.abs() < 1e-12 / (1.0 - sliding / at_rest), "scene {scene}: {off:e}");
    }
    println!("{slips} slips, {turns} turns");
    assert!(slips > 600 && turns > 100, "{slips} {turns}");
}

/// On a line that rises, over a structure at rest, a mass that is thrown uphill stays where it stops if G < Rₛ, though it would slide on if it
/// were moving, for G > R; with G > Rₛ it comes back to its stop, bounces, and what is left of its energy is that of the closed form.
#[test]
fn a_mass_rests_uphill_up_to_the_larger_friction() {
    let (d, w) = (1.0, 0.3);
    for (sliding, at_rest, gravity) in [(0.05, 0.2, 0.1), (0.05, 0.09, 0.1), (0.05, 0.05, 0.1)] {
        let system = system(d, 0.5, [sliding, at_rest], gravity);
        let start = ModalStart::new(&[0.0], &[0.0], [GapPoint { y: -d, w }]).unwrap();
        let found = run(&system, &start, &Limits::new(100.0, 1e-9)).unwrap();
        let up = w / (gravity + sliding);
        let height = 0.5 * w * up;
        if gravity < at_rest {
            assert!(found.impacts.is_empty());
            assert_eq!(found.tally.friction.stops, 1);
            assert!((found.tally.friction.time_held.value - (100.0 - up)).abs() < 1e-12);
            continue;
        }
        let down = (2.0 * height / (gravity - sliding)).sqrt();
        let first = found.impacts[0];
        assert_eq!(first.wall, Wall::Minus);
        assert!((first.time - (up + down)).abs() < 1e-13, "{} {}", first.time, up + down);
        // Each rebound is r e as fast as the one before, until the mass rests on its stop: all of them take what a geometric series sums to.
        let slower = ((gravity - sliding) / (gravity + sliding)).sqrt();
        let last = (up + down) / (1.0 - 0.5 * slower);
        let stick = found.episodes[0].stick_time;
        assert!((stick - last).abs() < 1e-11, "{stick} {last}");
    }
}
