//! Branches of periodic orbits and their special points: those of the 30-digit references, and what a run says of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::ops::ControlFlow::{Break, Continue};

use iva_core::{
    absorber::{Start, Wall},
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Request, Trajectory,
        branch::{Along, Branch, BranchPoint, End, follow, switch},
        chain::Chain,
        conditions::Condition,
        curve::{AlongCurve, curve},
        iterate,
        periodic::{Orbit, find},
    },
    piva::{Angles, Given, Parameters, Piva, PivaStart},
    siva::Siva,
};
use iva_tests::rng::Rng;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

fn records(text: &str) -> Vec<Value> {
    serde_json::from_str(text).unwrap()
}

/// The scene of a record with one of its numbers set.
fn scene(record: &Value, changed: &[(&str, f64)]) -> Result<(Siva<DrivenHost>, f64), Invalid> {
    let key = |name: &str| {
        let given = changed.iter().find(|(key, _)| *key == name);
        given.map_or_else(|| number(&record["scene"][name]), |(_, value)| *value)
    };
    let [mu, e, d, zeta] = ["mass_ratio", "restitution", "clearance", "damping_ratio"].map(key);
    let (amplitude, frequency) = (key("force_amplitude_per_mass"), key("frequency"));
    let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic])?;
    Ok((Siva::new(mu, e, d, zeta)?.under(force), TAU / frequency))
}

fn orbit_of(record: &Value, symmetric: bool) -> Orbit<Siva<DrivenHost>> {
    let (system, period) = scene(record, &[]).unwrap();
    let at = |name: &str| number(&record["state_at_time_0"][name]);
    let start = Start {
        displacement: at("displacement"),
        velocity: at("velocity"),
        gap_displacement: at("gap_displacement"),
        gap_velocity: at("gap_velocity"),
    };
    let cycles = record["forcing_periods"].as_f64().unwrap();
    let cycle = Cycle { begin: 0.0, length: cycles * period };
    find(&Trajectory::new(system, &start, cycle).unwrap(), symmetric, None).unwrap()
}

/// The branch of an orbit of the references over one of its numbers.
fn branch(name: &str, symmetric: bool, over: &str, between: [f64; 2]) -> Branch {
    let all = records(include_str!("../../../reference/orbits.json"));
    let record = all.iter().find(|record| record["id"] == name).unwrap();
    let orbit = orbit_of(record, symmetric);
    let cycles = record["forcing_periods"].as_u64().unwrap() as u32;
    let (chain, unknowns) = Chain::of(&orbit, cycles).unwrap();
    let scenes = |values: &[f64]| scene(record, &[(over, values[0])]);
    let value = number(&record["scene"][over]);
    follow(&scenes, (&chain, &unknowns), value, Along::new(between)).unwrap()
}

/// Beyond a coefficient of restitution of 0 or 1 there is no scene: the branch ends there exactly.
#[test]
fn branches_end_where_scenes_do() {
    for (name, between) in [("A1", [0.0, 1.0]), ("D1", [0.0, 1.0]), ("E1", [0.0, 1.0])] {
        let found = branch(name, name == "A1", "restitution", between);
        let ends = [found.points.first(), found.points.last()].map(|it| it.unwrap().value);
        println!("{name}: {:?} at {ends:?}", found.ends);
        for (end, value) in found.ends.into_iter().zip(ends) {
            assert!(end != End::Stalled, "{name}: {value}");
            assert_eq!(end == End::Range, between.contains(&value), "{name}: {value}");
        }
    }
}

/// All branches that begin at special points of a branch, with itself; and of these again, to a depth.
fn tree(record: &Value, over: &str, between: [f64; 2], from: Branch, depth: u32) -> Vec<Branch> {
    let scenes = |values: &[f64]| scene(record, &[(over, values[0])]);
    let mut all = Vec::new();
    for special in &from.special {
        if depth > 0
            && let Some(next) = switch(&scenes, &from.chain, special, Along::new(between))
        {
            assert!(
                (next.points[0].value - special.at.value).abs() < 1e-9
                    || next.ends[0] != End::Origin
            );
            all.extend(tree(record, over, between, next, depth - 1));
        }
    }
    all.push(from);
    all
}

/// Families of the references: the orbit that is followed, by the half map or not, the number, and its range.
const FAMILIES: [(&str, bool, &str, [f64; 2], u32); 8] = [
    ("A1", true, "clearance", [0.5, 13.0], 2),
    ("A5", false, "clearance", [0.5, 13.0], 0),
    ("D1", true, "force_amplitude_per_mass", [0.03, 0.3], 0),
    ("E1", false, "clearance", [0.5, 13.0], 1),
    ("G1", false, "clearance", [0.5, 13.0], 0),
    ("G1", false, "frequency", [0.5, 1.3], 0),
    ("A7", false, "clearance", [0.5, 13.0], 0),
    ("A3", false, "damping_ratio", [0.03, 0.07], 0),
];

/// Of the references every point whose scene is of a family lies on its branches, of its kind.
#[test]
fn the_branches_have_the_points_of_the_references() {
    let orbits = records(include_str!("../../../reference/orbits.json"));
    let mut worst = [0.0f64; 2];
    let mut open: Vec<Value> = records(include_str!("../../../reference/bifurcations.json"));
    for (name, symmetric, over, between, depth) in FAMILIES {
        let record = orbits.iter().find(|record| record["id"] == name).unwrap();
        let first = branch(name, symmetric, over, between);
        let all = tree(record, over, between, first, depth);
        open.retain(|point| {
            let (kind, truth) = (point["type"].as_str().unwrap(), number(&point["value"]));
            let same = |key: &str| key == over || point["scene"][key] == record["scene"][key];
            let alike = record["scene"].as_object().unwrap().keys().all(|key| same(key));
            if point["parameter"] != over || !alike {
                return true;
            }
            let impacts = point["impacts"].as_u64().unwrap() as usize;
            let of_it = |branch: &&Branch| branch.chain.impacts() == impacts;
            let special = all.iter().filter(of_it).flat_map(|branch| &branch.special);
            let off = special
                .filter(|special| special.condition.kind().name() == kind)
                .map(|special| (special.at.value - truth).abs())
                .fold(f64::INFINITY, f64::min);
            println!("{} {off:e}", point["id"]);
            let grazing = usize::from(kind == "grazing");
            if off < 1e-6 {
                worst[grazing] = worst[grazing].max(off);
            }
            off >= 1e-6
        });
        for branch in &all {
            judge(record, over, branch);
        }
    }
    println!("worst {worst:?}");
    assert!(open.is_empty(), "{:?}", open.iter().map(|it| &it["id"]).collect::<Vec<_>>());
    assert!(worst[0] < 1e-12 && worst[1] < 1e-11, "{worst:?}");
}

/// The special points of a branch are what a run finds there: its multipliers, a margin or a speed of 0. Between them the
/// orbits are those of runs, and are stable where their multipliers say so.
fn judge(record: &Value, over: &str, branch: &Branch) {
    let found = |at: &BranchPoint| {
        let (system, cycle) = scene(record, &[(over, at.value)]).unwrap();
        branch.chain.orbit(&system, cycle, &at.unknowns, 0.0)
    };
    for special in &branch.special {
        let at = &special.at;
        match special.condition {
            Condition::Grazing { .. } => {
                assert!(
                    at.margin.abs() < 1e-12 && at.slowest > -1e-12,
                    "{at:?} {:?}",
                    branch.chain
                );
            }
            Condition::ImpactVanishes { .. } => {
                assert!(at.slowest.abs() < 1e-12 && at.margin > -1e-12, "{at:?}")
            }
            condition => {
                let orbit = found(at).unwrap();
                let own = orbit.half_multipliers.as_ref().unwrap_or(&orbit.multipliers);
                let own: [_; 4] = own[..].try_into().unwrap();
                let off = match condition {
                    Condition::Fold => own.map(|it| (it - 1.0).norm()),
                    Condition::NeimarkSacker => own.map(|it| (it.norm() - 1.0).abs()),
                    // A branch that begins there has an orbit whose halves are alike.
                    _ => own.map(|it| (it + 1.0).norm().min((it - 1.0).norm())),
                };
                let off = off.into_iter().fold(f64::INFINITY, f64::min);
                assert!(off < 1e-7, "{condition:?} {off:e} {at:?}");
            }
        }
    }
    for (index, at) in branch.points.iter().enumerate() {
        // At its ends an impact is about to begin or to vanish.
        if index % 5 == 2 && at.margin > 1e-3 && at.slowest > 1e-2 {
            let orbit = found(at).unwrap_or_else(|missed| panic!("{missed:?} {at:?}"));
            assert_eq!(orbit.impacts as usize, branch.chain.impacts());
            let size = 1.0 + at.multipliers[0].norm();
            let off = at.multipliers.iter().zip(orbit.multipliers).map(|(a, b)| (a - b).norm());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-6 * size, "{off:e} {at:?}");
        }
    }
}

/// Curves over frequency and clearance have the points of the references.
#[test]
fn the_curves_are_those_of_the_references() {
    let bifurcations = records(include_str!("../../../reference/bifurcations.json"));
    let mut worst = 0.0f64;
    for truth in records(include_str!("../../../reference/bifurcation_curves.json")) {
        let first = match truth["id"].as_str().unwrap() {
            "T1" => ("A1", true, "pitchfork"),
            "T5" => ("G1", false, "grazing"),
            _ => ("E2", false, "fold"),
        };
        let (name, symmetric, kind) = first;
        let all = records(include_str!("../../../reference/orbits.json"));
        let record = all.iter().find(|record| record["id"] == name).unwrap();
        let found = branch(name, symmetric, "clearance", [0.5, 13.0]);
        let special = found.special.iter().find(|it| it.condition.kind().name() == kind).unwrap();
        let points: Vec<[f64; 2]> = truth["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|point| [number(&point[0]), number(&point[1])])
            .collect();
        let at: Vec<f64> = points.iter().map(|point| point[0]).collect();
        let scenes =
            |values: &[f64]| scene(record, &[("frequency", values[0]), ("clearance", values[1])]);
        let along = AlongCurve {
            between: [[at[0] - 0.01, at[at.len() - 1] + 0.01], [0.5, 13.0]],
            at: &at,
            most_points: 2000,
            longest: 0.05,
            cancel: None,
            done: None,
        };
        let values = [number(&record["scene"]["frequency"]), special.at.value];
        let found = curve(&scenes, &found.chain, special, values, along).unwrap();
        println!("{} {} points {:?}", truth["id"], found.points.len(), found.ends);
        for [frequency, clearance] in points {
            let off = found
                .points
                .iter()
                .filter(|point| point.values[0] == frequency)
                .map(|point| (point.values[1] - clearance).abs())
                .fold(f64::INFINITY, f64::min);
            println!("   {frequency} {off:e}");
            worst = worst.max(off);
        }
    }
    assert!(worst < 1e-12, "{worst:e}");
    assert!(bifurcations.len() > 20);
}

/// Beyond such a point two real multipliers have the product 1, which is no Neimark–Sacker point.
#[test]
fn a_curve_of_tori_ends_where_its_multipliers_become_real() {
    let all = records(include_str!("../../../reference/orbits.json"));
    let record = &all[0];
    let found = branch("A1", true, "clearance", [0.5, 13.0]);
    let torus = found.special.iter().find(|it| it.condition == Condition::NeimarkSacker).unwrap();
    let scenes =
        |values: &[f64]| scene(record, &[("frequency", values[0]), ("clearance", values[1])]);
    let along = AlongCurve {
        between: [[0.8, 1.2], [0.5, 20.0]],
        at: &[],
        most_points: 2000,
        longest: 0.05,
        cancel: None,
        done: None,
    };
    let found = curve(&scenes, &found.chain, torus, [1.0, torus.at.value], along).unwrap();
    assert!(found.ends.contains(&End::Resonance), "{:?}", found.ends);
    assert!(found.points.len() > 20);
    for point in &found.points {
        let mut pairs = point.multipliers.iter().filter(|it| it.im > 0.0);
        assert!(pairs.any(|it| (it.norm() - 1.0).abs() < 1e-5), "{:?}", point.multipliers);
    }
}

/// A pendulum with small angles: one impact a cycle on one wall.
#[test]
fn branches_of_pendulums_have_the_points_of_the_references() {
    let record = &records(include_str!("../../../reference/orbits_piva.json"))[0];
    let scenes = |values: &[f64]| {
        let key = |name: &str| number(&record["scene"][name]);
        let [mu, e, zeta] = ["mass_ratio", "restitution", "damping_ratio"].map(key);
        let parameters = Parameters {
            frequency_ratio: key("frequency_ratio"),
            angles: Angles::Small,
            ..Parameters::point_bob(mu, e, values[0], zeta, values[0])
        };
        let (amplitude, frequency) = (key("force_amplitude_per_mass"), key("frequency"));
        let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
        let force = Force::harmonic(vec![harmonic])?;
        Ok((Piva::new(parameters)?.under(force), TAU / frequency))
    };
    let clearance = number(&record["scene"]["clearance"]);
    let (piva, period) = scenes(&[clearance]).unwrap();
    let impact = |name: &str| number(&record["impact"][name]);
    let wall = record["impact"]["wall"].as_f64().unwrap();
    let start = PivaStart {
        displacement: impact("displacement"),
        velocity: impact("velocity_after"),
        place: Given::Gap(wall * clearance),
        rate: Given::Angle(impact("gap_velocity_after") / clearance),
    };
    let cycle = Cycle { begin: impact("time"), length: period };
    let orbit = find(&Trajectory::new(piva, &start, cycle).unwrap(), false, None).unwrap();
    let (chain, unknowns) = Chain::of(&orbit, 1).unwrap();
    let along = Along::new([1.0, 5.0]);
    let found = follow(&scenes, (&chain, &unknowns), clearance, along).unwrap();
    println!("{} points {:?}", found.points.len(), found.ends);
    for truth in records(include_str!("../../../reference/bifurcations_piva.json")) {
        let (kind, value) = (truth["type"].as_str().unwrap(), number(&truth["value"]));
        let off = found
            .special
            .iter()
            .filter(|special| special.condition.kind().name() == kind)
            .map(|special| (special.at.value - value).abs())
            .fold(f64::INFINITY, f64::min);
        println!("{} {off:e}", truth["id"]);
        assert!(off < 1e-11, "{off:e}");
    }
}

/// Branches of random scenes, from what they settle on: every special point is one, every orbit between them one that a run
/// makes, and none has impacts on one wall only.
#[test]
fn branches_of_random_scenes_are_made_of_orbits() {
    let mut rng = Rng::new(81);
    let (mut count, mut points, mut special) = (0, 0, 0);
    while count < 12 {
        let key = |name: &str, value: f64| (name.to_owned(), Value::from(value.to_string()));
        let given = [
            key("mass_ratio", rng.range(0.02, 0.3)),
            key("restitution", rng.range(0.3, 0.9)),
            key("clearance", rng.range(0.5, 4.0)),
            key("damping_ratio", rng.range(0.01, 0.1)),
            key("force_amplitude_per_mass", 1.0),
            key("frequency", rng.range(0.7, 1.4)),
        ];
        let record = serde_json::json!({ "scene": Value::Object(given.into_iter().collect()) });
        let (system, period) = scene(&record, &[]).unwrap();
        let clearance = number(&record["scene"]["clearance"]);
        let start = Start { gap_velocity: 0.3, ..Start::default() };
        let cycle = Cycle { begin: 0.0, length: period };
        let begun = Trajectory::new(system, &start, cycle).unwrap();
        let (mut cycles, mut last) = (0, begun.state);
        iterate(std::slice::from_ref(&begun), Request::default(), &mut |_, image| {
            (cycles, last) = (cycles + 1, image.state);
            if cycles < 150 { Continue(()) } else { Break(()) }
        })
        .unwrap();
        let Ok(orbit) = find(&begun.from(&last), false, None) else { continue };
        let Ok((chain, unknowns)) = Chain::of(&orbit, 1) else { continue };
        // Those with stick episodes have tests of their own.
        if chain.sticks.contains(&true) {
            continue;
        }
        let scenes = |values: &[f64]| scene(&record, &[("clearance", values[0])]);
        let along = Along::new([0.2, 6.0]);
        let Some(found) = follow(&scenes, (&chain, &unknowns), clearance, along) else { continue };
        let walls = |wall| found.chain.walls.contains(&wall);
        assert!(walls(Wall::Plus) && walls(Wall::Minus), "{record}");
        assert!(!found.ends.contains(&End::Points), "{record} {:?}", found.ends);
        judge(&record, "clearance", &found);
        (count, points) = (count + 1, points + found.points.len());
        special += found.special.len();
    }
    println!("{count} branches, {points} orbits, {special} special points");
    assert!(special > 20, "{special}");
}
