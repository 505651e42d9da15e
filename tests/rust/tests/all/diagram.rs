//! Bifurcation diagrams: the strobes are those of runs from value to value; a pitchfork and a flip are where the references
//! have them; hysteresis.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Trajectory,
        diagram::{Column, Direction, diagram},
        lyapunov::Window,
    },
    simulate::Outcome,
    siva::Siva,
};
use nalgebra::Vector4;

/// Family A of the references (μ = .2, e = .7, ζ = .05, F = Ω = 1) with clearances, from one start.
fn family(clearances: impl Iterator<Item = f64>) -> Vec<Trajectory<Siva<DrivenHost>>> {
    let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let cycle = Cycle { begin: 0.0, length: TAU };
    let start = Start { displacement: 1.0, gap_velocity: 1.0, ..Start::default() };
    let one = |d| {
        let siva = Siva::new(0.2, 0.7, d, 0.05).unwrap().under(force.clone());
        Trajectory::new(siva, &start, cycle).unwrap()
    };
    clearances.map(one).collect()
}

/// Number of cycles after which the strobes of a column repeat, if they do.
fn period(column: &Column<Vector4<f64>>) -> Option<usize> {
    let strobes = &column.strobes;
    let off =
        |n: &usize| (strobes[strobes.len() - 1 - n].at - strobes[strobes.len() - 1].at).amax();
    (1..strobes.len()).find(|n| off(n) < 1e-4)
}

/// Upwards the period-doubled orbit 4:2 (from the flip at 4.0456 down to its own at 3.946) becomes 2:1, and the 2:1 orbits have two
/// impacts a cycle on both sides of the pitchfork at 4.2398.
#[test]
fn the_periods_change_at_the_flips() {
    let at = |index: usize| 3.96 + 0.02 * index as f64;
    let all = family((0..20).map(at));
    let window = Window { discard: 300, keep: 16 };
    for direction in [Direction::Up, Direction::Down] {
        let columns = diagram(&all, direction, window, None, None).unwrap();
        assert_eq!(columns.len(), 20);
        for (index, column) in columns.iter().enumerate() {
            let d = at(index);
            assert_eq!((column.outcome, column.strobes.len()), (Outcome::Finished, 16));
            // Transients are long next to a bifurcation.
            if (d - 4.0455692708588576).abs() < 0.012 || (d - 4.239_825_482_999_316).abs() < 0.012 {
                continue;
            }
            let doubled = d < 4.0455692708588576;
            assert_eq!(period(column), Some(if doubled { 2 } else { 1 }), "{direction:?} {d}");
            assert!(column.strobes.iter().all(|strobe| strobe.impacts == 2), "{direction:?} {d}");
        }
    }
}

/// Each value begins where the one before it has ended; where the gap is too narrow, at the wall.
#[test]
fn values_are_joined_to_each_other() {
    let all = family([4.5, 4.6, 1.0].into_iter());
    let window = Window { discard: 7, keep: 3 };
    let columns = diagram(&all, Direction::Up, window, None, None).unwrap();
    let last = columns[0].strobes[2].at;
    let start = Start {
        displacement: last[0],
        velocity: last[1],
        gap_displacement: last[2],
        gap_velocity: last[3],
    };
    let second = Trajectory::new(all[1].system.clone(), &start, all[1].cycle).unwrap();
    let alone = diagram(&[second], Direction::Down, window, None, None).unwrap();
    assert_eq!(alone[0], columns[1]);
    assert!(columns[1].strobes[2].at[2].abs() > 1.0, "the third does not fit");
    assert_eq!((columns[2].outcome, columns[2].strobes.len()), (Outcome::Finished, 3));
    // Downwards the last one begins from its own start.
    let down = diagram(&all, Direction::Down, window, None, None).unwrap();
    assert_eq!(down[2], diagram(&all[2..], Direction::Up, window, None, None).unwrap()[0]);
    let cancelled = true.into();
    let none = diagram(&all, Direction::Up, window, Some(&cancelled), None).unwrap();
    assert!(none.iter().all(|it| it.strobes.is_empty() && it.outcome == Outcome::Cancelled));
}

/// Scene E of the references (μ = .1, e = .5, ζ = .02, F = 1, Ω = .7) from a strobe of its stable 3:1 orbit at d = 2.7: upwards that is
/// followed to its fold at d = 2.804; downwards the 2:1 orbit, which exists beside it, is followed all the way.
#[test]
fn two_attractors_are_followed_each_in_its_direction() {
    let frequency = 0.7;
    let harmonic = Harmonic { amplitude: 1.0, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let cycle = Cycle { begin: 0.0, length: TAU / frequency };
    let start = Start {
        displacement: 2.0850660101,
        velocity: 0.2113571959,
        gap_displacement: 2.13377402,
        gap_velocity: 2.4375942102,
    };
    let at = |index: usize| 2.7 + 0.02 * index as f64;
    let one = |index| {
        let siva = Siva::new(0.1, 0.5, at(index), 0.02).unwrap().under(force.clone());
        Trajectory::new(siva, &start, cycle).unwrap()
    };
    let all: Vec<_> = (0..11).map(one).collect();
    let window = Window { discard: 150, keep: 4 };
    let [up, down] = [Direction::Up, Direction::Down].map(|it| {
        let columns = diagram(&all, it, window, None, None).unwrap();
        columns.iter().map(|it| (period(it), it.strobes[0].impacts)).collect::<Vec<_>>()
    });
    for index in 0..11 {
        let impacts = if at(index) < 2.803_971_797_723_619 { 3 } else { 2 };
        assert_eq!(up[index], (Some(1), impacts), "{}", at(index));
        assert_eq!(down[index], (Some(1), 2), "{}", at(index));
    }
}
