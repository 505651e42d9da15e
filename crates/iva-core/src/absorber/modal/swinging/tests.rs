//! The bounds on what series with pendulums leave out, against series of a much higher order.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::absorber::Absorber as _;
use crate::absorber::modal::{FewModes, ModalStart, ModalStructure};
use crate::absorber::piva::{Angles, Parameters};
use crate::absorber::siva::FreeMass;
use crate::flight::GapPoint;
use crate::host::UndrivenHost;
use crate::segment::taylor::Growing;

/// Longer than any series in use: rows of a multiple of four.
const LONG: usize = 124;
/// The last order of these.
const FAR: usize = LONG - 4;

/// Members of which the first is a pendulum, the others pendulums or masses, on up to three modes; some are stuck.
fn scene(
    part: &dyn Fn(u32, u32) -> f64,
    count: u32,
) -> (FewModes<UndrivenHost>, ModalState<UndrivenHost, 4, 4>) {
    let modes = 1 + (3.0 * part(83, 0)) as usize % 3;
    let frequencies = &[1.0, 1.0 + 3.0 * part(59, 0), 5.0][..modes];
    let structure = ModalStructure::new(frequencies, &[0.2 * part(3, 0); 3][..modes]).unwrap();
    let shapes = |n| [1.0, 0.8 - 1.6 * part(67, n), part(89, n) - 0.5];
    let names = ["a", "b", "c", "d"];
    let structure = (0..count).fold(structure, |structure, n| {
        structure.with_point(names[n as usize], &shapes(n)[..modes]).unwrap()
    });
    let hangs = |n| n == 0 || part(71, n) > 0.4;
    let mass = |n| FreeMass::new(0.01 + part(31, n) * part(5, n), 0.5, 1.9).unwrap();
    let members: Vec<_> = (0..count).map(|n| (mass(n), names[n as usize])).collect();
    let pendulum = |n| Parameters {
        frequency_ratio: 1.7 * part(11, n),
        inertia_ratio: 1.0 + part(13, n),
        contact_distance: 2.0,
        pivot_damping_ratio: 0.3 * part(23, n),
        spring_ratio: if n % 3 == 1 { part(61, n) } else { 0.0 },
        angles: if part(73, n) < 0.2 { Angles::Small } else { Angles::Large },
        ..Parameters::point_bob(0.1, 0.5, 1.9, 0.0, 2.0 * (0.6 + part(29, n)))
    };
    let pendulums: Vec<_> = (0..count).map(|n| hangs(n).then(|| pendulum(n))).collect();
    let system = FewModes::with_room(structure, &members).unwrap().with_pendulums(&pendulums);
    let gap = |n: u32| GapPoint {
        y: 2.0 * (1.6 * part(17, n) - 0.8).sin(),
        w: 3.0 * (part(43, n) - 0.5),
    };
    let gaps = std::array::from_fn(|n| gap(n as u32));
    let displacements: Vec<f64> = (0..modes).map(|j| part(37, j as u32) - 0.5).collect();
    let velocities: Vec<f64> = (0..modes).map(|j| part(41, j as u32) - 0.5).collect();
    let rises = |n: usize| match pendulums.get(n) {
        Some(Some(it)) if it.angles == Angles::Large && part(97, n as u32) < 0.5 => {
            2.0 * part(7, n as u32)
        }
        _ => 0.0,
    };
    let angles: Vec<_> =
        (0..count as usize).map(|n| DoubleDouble::new(rises(n).min(1.57))).collect();
    let system = system.and_then(|it| it.with_rising_pivots(&angles));
    let (system, start) =
        (system.unwrap(), ModalStart::new(&displacements, &velocities, gaps).unwrap());
    let mut state = system.begin(&start);
    for n in 1..count {
        if part(79, n) < 0.2 {
            let place = &mut state.places[n as usize];
            (place.stuck, place.distance, place.rate) =
                (true, DoubleDouble::ZERO, DoubleDouble::ZERO);
        }
    }
    (system, state)
}

/// The begin of series in plain numbers.
fn plain<'a>(
    Swing { index, shape, series }: &Swing<'a, f64, DoubleDouble, LONG>,
) -> Swing<'a, f64, f64, LONG> {
    Swing { index: *index, shape, series: Growing::from_first(series, 0, |number| number.value) }
}

/// No error exceeds its bound, which are not idle.
#[test]
fn no_series_leaves_out_more_than_its_bound() {
    let mut ratios = Vec::new();
    for index in 0..200u32 {
        let part = |k: u32, n: u32| f64::from(((index + 53 * n) * k + k / 2) % 101) / 100.0;
        let (system, from) = scene(&part, 1 + index % 4);
        let n = system.whole.count();
        let (growth, fastest) =
            (system.whole.growth(), system.swinging_rate(&from.places).max(1.0));
        for h in [0.125, 0.25, 0.5] {
            let regime = system.regime(&from.places);
            let pushes = system.pushes(&from.phase, h);
            let grown = system.grown(&from, &regime, (&pushes, &[]), h, (ORDER, ORDER));
            let fixed = system.fixed_at(&from.places);
            let feed = Feed { regime: &regime, fixed: &fixed, asides: &[], unit: h };
            let mut rows = system.begun(&from.modes, h, (FAR, 0));
            let begun: Vec<Swing<'_, f64, DoubleDouble, LONG>> = system.swinging_from(&from.places);
            let mut long: Vec<Swing<'_, f64, f64, LONG>> = begun.iter().map(plain).collect();
            for m in 0..=FAR - 2 {
                system.rise(&mut rows, &mut long, m, pushes(m), &feed);
            }
            let flying: Vec<InFlight<'_, f64>> = grown
                .swings
                .iter()
                .map(|swing| {
                    let shape = system.mobility(swing.index, swing.index).value.sqrt();
                    InFlight { series: &swing.series, shape }
                })
                .collect();
            let forces = system.forces_left_out(&grown, (h, 1.0), [0.0; 2]);
            let shaking = Shaking { growth, forces, base: 0.0 };
            let Some(bound) = RemainderOfSeveral::new(&flying, &shaking, fastest, (h, 1.0)) else {
                continue;
            };
            let unbounded = vec![f64::INFINITY; flying.len() + 1];
            if bound.excess(unbounded.iter().copied()) > 1.0 {
                continue;
            }
            let norm =
                |of: &dyn Fn(usize) -> f64| (0..n).map(|j| of(j).powi(2)).sum::<f64>().sqrt();
            let left = |j: usize, factor: &dyn Fn(usize) -> f64| {
                (ORDER + 1..=FAR).rev().fold(0.0, |sum, m| sum + factor(m) * rows.plain(j, m))
            };
            let place = norm(&|j| left(j, &|_| 1.0));
            let velocity = norm(&|j| left(j, &|m| m as f64 / h));
            let beyond = |row: &[f64; LONG]| {
                row[LAST + 1..FAR].iter().rev().fold(0.0, |sum, it| sum + it).abs()
            };
            let mut errors = vec![(growth * place).max(velocity)];
            errors.extend(long.iter().map(|Swing { series, .. }| {
                let turned = series.pendulum.contact_distance * beyond(&series.c);
                (beyond(&series.w) / fastest).max(turned).max(beyond(&series.y))
            }));
            // The errors themselves as what is allowed: each bound is at least that.
            for (k, error) in errors.iter().enumerate().filter(|(_, error)| **error > 0.0) {
                let mut allowed = unbounded.clone();
                allowed[k] = *error;
                let over = bound.excess(allowed.into_iter());
                assert!(over >= 1.0, "{index}, {h}: {k} {error:e} {over}");
                ratios.push(1.0 / over);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!(ratios.len() > 400 && median > 0.003, "{} bounds, median {median}", ratios.len());
}
