//! Basins cell by cell: those of the references, which a program with up to 40 digits gave; the neighbourhoods in which a cell is
//! decided; entropies.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Cycle, Trajectory,
        attractors::{Attractor, Search, attractors},
        basin_entropy::entropy,
        basins::{Ending, basins},
        map,
        neighbourhood::neighbourhoods,
    },
    simulate::Outcome,
    siva::Siva,
};
use iva_tests::rng::Rng;
use nalgebra::Vector4;
use serde_json::Value;

/// A trajectory of the scene of a record, from a start.
fn trajectory(record: &Value, start: &Start) -> Trajectory<Siva<DrivenHost>> {
    let key = |name: &str| record["scene"][name].as_f64().unwrap();
    let (amplitude, frequency) = (key("force_amplitude_per_mass"), key("frequency"));
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let [mu, e, d, zeta] = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
    let cycle = Cycle { begin: 0.0, length: TAU / frequency };
    Trajectory::new(Siva::new(mu, e, d, zeta).unwrap().under(force), start, cycle).unwrap()
}

/// The attractors of a record, in its order.
fn known(record: &Value) -> Vec<Attractor<Siva<DrivenHost>>> {
    let strobes = record["attractors"].as_array().unwrap().iter().map(|it| {
        let strobe = [0, 1, 2, 3].map(|k| it["strobe_state"][k].as_f64().unwrap());
        let [displacement, velocity, gap_displacement, gap_velocity] = strobe;
        trajectory(record, &Start { displacement, velocity, gap_displacement, gap_velocity })
    });
    let search = Search { most_periods: 4, most_cycles: 500, join_mirrored: false };
    attractors(&strobes.collect::<Vec<_>>(), search, None).unwrap().attractors
}

/// The starts of a grid, a row for each displacement, with the velocities of the second axis.
fn grid(record: &Value) -> Vec<Trajectory<Siva<DrivenHost>>> {
    let axis = |name: &str| -> Vec<f64> {
        let of = |k: usize| record["grid"][name][k].as_f64().unwrap();
        let count = of(2) as usize;
        (0..count).map(|k| of(0) + (of(1) - of(0)) * k as f64 / (count - 1) as f64).collect()
    };
    let (first, second) = (axis("first_axis"), axis("second_axis"));
    let one = |velocity: f64, displacement: f64| {
        trajectory(record, &Start { displacement, velocity, ..Start::default() })
    };
    first.iter().flat_map(|x| second.iter().map(|v| one(*v, *x))).collect()
}

fn records() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../reference/basins.json")).unwrap()
}

/// 64 × 64 cells, but for the few that are hard to decide in double precision.
#[test]
fn basins_are_those_of_the_references() {
    for record in &records() {
        let name = record["id"].as_str().unwrap();
        let attractors = known(record);
        let cells = grid(record);
        let near = neighbourhoods(&cells[0], &attractors, None);
        assert_eq!(near.len(), attractors.len(), "{name}");
        let found = basins(&cells, &near, 150, None).unwrap();
        let labels = record["labels"].as_array().unwrap().iter();
        let truth: Vec<usize> = labels
            .flat_map(|row| row.as_str().unwrap().bytes().map(|label| usize::from(label - b'0')))
            .collect();
        let hard: Vec<usize> = record["hard_cells"]
            .as_array()
            .unwrap()
            .iter()
            .map(|cell| cell.as_u64().unwrap() as usize)
            .collect();
        let unsure: Vec<usize> = (0..4096).filter(|k| !found[*k].is_sure()).collect();
        for k in 0..4096 {
            let right = found[k].label().is_none_or(|label| label == truth[k]);
            assert!(right || hard.contains(&k), "{name} {k}: {:?}", found[k]);
        }
        println!("{name}: {} not sure, {} hard", unsure.len(), hard.len());
        assert!(unsure.len() <= 2 * hard.len(), "{name}: {}", unsure.len());
        // Counts, where also what is not sure has a label.
        for (label, count) in record["counts"].as_array().unwrap().iter().enumerate() {
            let count = count.as_f64().unwrap();
            let of = found.iter().filter(|cell| cell.ending == Ending::Attractor(label)).count();
            let apart = (of as f64 - count).abs();
            assert!(apart <= 3.0 * (unsure.len() as f64).sqrt(), "{name}: {of} {count}");
        }
        let given: Vec<_> = truth.iter().map(|label| Some(*label)).collect();
        let entropy = entropy(&given, 64, 4).unwrap();
        let known = ["basin_entropy_4x4_boxes", "boundary_basin_entropy"]
            .map(|key| record[key].as_f64().unwrap());
        assert!((entropy.basin - known[0]).abs() < 1e-8, "{name}: {entropy:?}");
        assert!((entropy.boundary.unwrap() - known[1]).abs() < 1e-8, "{name}: {entropy:?}");
        assert_eq!(
            (entropy.boundary_boxes, entropy.boxes),
            (record["boundary_boxes"].as_u64().unwrap() as usize, 256)
        );
    }
}

/// From points in them, 50 periods later the motion is at its orbit.
#[test]
fn neighbourhoods_hold_what_stays() {
    let mut rng = Rng::new(81);
    for record in &records() {
        let attractors = known(record);
        let scene = trajectory(record, &Start::default());
        let near = neighbourhoods(&scene, &attractors, None);
        for it in &near {
            assert!(it.radius > 1e-4, "{}", it.radius);
            let mut tried = 0;
            while tried < 200 {
                let off = Vector4::zeros().map(|_: f64| 2.0 * it.radius * rng.range(-1.0, 1.0));
                let at = Vector4::from_column_slice(it.centre.as_slice()) + off;
                let Some(start) = scene.system.start_at(&at).filter(|_| it.holds(at.as_slice()))
                else {
                    continue;
                };
                tried += 1;
                let mut one = Trajectory::new(scene.system.clone(), &start, scene.cycle).unwrap();
                for _ in 0..100 {
                    one.state = map(&one, false, None).unwrap().state;
                }
                let left = (scene.system.point(&one.state) - &it.centre).amax();
                assert!(left < 0.1 * it.radius, "{left} of {}", it.radius);
            }
        }
    }
}

#[test]
fn what_is_not_decided_is_said() {
    let record = &records()[0];
    let cells = &grid(record)[..20];
    let attractors = known(record);
    let near = neighbourhoods(&cells[0], &attractors, None);
    let soon = basins(cells, &near, 1, None).unwrap();
    assert!(soon.iter().all(|it| it.cycles == 1));
    assert!(
        soon.iter().any(|it| it.ending == Ending::Open(Outcome::Finished) && it.label().is_none())
    );
    let cancelled = true.into();
    let none = basins(cells, &near, 100, Some(&cancelled)).unwrap();
    assert!(none.iter().all(|it| it.ending == Ending::Open(Outcome::Cancelled)));
}

/// One box with halves of two labels has ln 2, one with one label 0; what has no label does not count.
#[test]
fn entropies_are_those_of_their_definition() {
    let row = [Some(0), Some(1), Some(2), None];
    let found = entropy(&[row, row].concat(), 4, 2).unwrap();
    assert!((found.basin - 0.5 * 2f64.ln()).abs() < 1e-15, "{found:?}");
    assert_eq!(found.boundary.map(|it| (it - 2f64.ln()).abs() < 1e-15), Some(true));
    assert_eq!((found.boundary_boxes, found.boxes), (1, 2));
    assert_eq!(entropy(&[None; 16], 4, 2), None);
    assert_eq!(entropy(&[Some(1); 4], 2, 2).unwrap().boundary, None);
}
