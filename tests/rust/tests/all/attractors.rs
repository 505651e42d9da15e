//! Attractors from many starts: the inventories of the references, which 120 starts and 3,000 cycles each gave in another
//! way; mirror images; motions without impacts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::Start,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Cycle, Trajectory,
        attractors::{Class, Found, Search, attractors},
    },
    simulate::Outcome,
    siva::Siva,
};
use iva_tests::rng::Rng;
use serde_json::Value;

/// Family A of the references (μ = .2, e = .7, ζ = .05, F = Ω = 1), from starts that are drawn in the box of the inventories:
/// |x|, |ẋ| < 2, |y| < .95 d, |ẏ| < 2 d.
fn drawn(rng: &mut Rng, d: f64, count: usize) -> Vec<Trajectory<Siva<DrivenHost>>> {
    let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let siva = Siva::new(0.2, 0.7, d, 0.05).unwrap().under(force);
    let one = |_| {
        let start = Start {
            displacement: rng.range(-2.0, 2.0),
            velocity: rng.range(-2.0, 2.0),
            gap_displacement: 0.95 * d * rng.range(-1.0, 1.0),
            gap_velocity: 2.0 * d * rng.range(-1.0, 1.0),
        };
        Trajectory::new(siva.clone(), &start, Cycle { begin: 0.0, length: TAU }).unwrap()
    };
    (0..count).map(one).collect()
}

const SEARCH: Search = Search { most_periods: 16, most_cycles: 3000, join_mirrored: false };

/// The same attractors, and shares within four standard errors of both samples.
#[test]
fn inventories_are_those_of_the_references() {
    let records = serde_json::from_str(include_str!("../../../reference/attractors.json"));
    let records: Vec<Value> = records.unwrap();
    let mut rng = Rng::new(71);
    for record in &records {
        let name = record["id"].as_str().unwrap();
        let d = record["scene"]["clearance"].as_f64().unwrap();
        // Chaos takes all cycles of every start.
        let aperiodic = record["aperiodic_present"].as_bool().unwrap();
        let count = if aperiodic { 8 } else { 60 };
        let found = attractors(&drawn(&mut rng, d, count), SEARCH, None).unwrap();
        let mut kinds: Vec<String> = found
            .attractors
            .iter()
            .map(|it| format!("{}:{}", it.orbit.impacts, it.periods()))
            .collect();
        kinds.sort();
        let shares: Vec<_> = (0..found.attractors.len())
            .map(|index| found.share(|class| *class == Class::Periodic(index)))
            .collect();
        let known = record["periodic_attractors"].as_array().unwrap();
        let known: Vec<&str> = known.iter().map(|kind| kind.as_str().unwrap()).collect();
        assert_eq!(kinds, known, "{name}");
        let open = found.share(|class| *class == Class::Aperiodic);
        assert_eq!(open.count, if aperiodic { count } else { 0 }, "{name}: {:?}", found.classes);
        // Pairs are mirror images, in whatever order they were found.
        for share in &shares {
            let whole = 1.0 / shares.len() as f64;
            let error = share.standard_error.hypot((whole * (1.0 - whole) / 120.0).sqrt());
            assert!((share.share - whole).abs() <= 4.0 * error, "{name}: {share:?}");
        }
    }
    assert_eq!(records.len(), 12);
}

/// The strobes of what is found are those that a map of one cycle takes into each other, and those of an attractor that is
/// its own mirror image are among their mirror images.
#[test]
fn mirror_images_count_as_one() {
    let mut rng = Rng::new(72);
    for (d, periods) in [(3.98, 2), (3.4, 1), (4.5, 1)] {
        let starts = drawn(&mut rng, d, 24);
        let search = Search { join_mirrored: true, ..SEARCH };
        let joined = attractors(&starts, search, None).unwrap();
        assert_eq!(joined.attractors.len(), 1, "{d}");
        let one = &joined.attractors[0];
        let mirrored = one.mirrored.as_ref().unwrap();
        assert_eq!((one.periods(), mirrored.len()), (periods, periods), "{d}");
        let shared = joined.share(|class| *class == Class::Periodic(0));
        assert_eq!((shared.count, shared.share, shared.standard_error), (24, 1.0, 0.0));
        let apart = attractors(&starts, SEARCH, None).unwrap();
        let all = apart.attractors.iter().flat_map(|it| &it.strobes);
        for strobe in all {
            let known = one.strobes.iter().chain(mirrored);
            let off = known.map(|it| (it - strobe).amax()).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-9, "{d}: {off:e}");
        }
        let symmetric = (one.strobes[0] - mirrored[0]).amax() < 1e-9;
        assert_eq!(symmetric, apart.attractors.len() == 1, "{d}");
    }
}

/// Starts that are divided among two searches have the classes of one search of all, whichever finds an orbit first.
#[test]
fn searches_of_divided_starts_join() {
    let mut rng = Rng::new(74);
    for (d, pair) in [(3.98, true), (4.5, false)] {
        let starts = drawn(&mut rng, d, 24);
        for search in [SEARCH, Search { join_mirrored: true, ..SEARCH }] {
            let whole = attractors(&starts, search, None).unwrap();
            let mut joined = attractors(&starts[..9], search, None).unwrap();
            joined.join(attractors(&starts[9..], search, None).unwrap(), d);
            assert_eq!(joined.classes.len(), 24);
            assert_eq!(joined.attractors.len(), whole.attractors.len());
            for (class, other) in joined.classes.iter().zip(&whole.classes) {
                let strobes = |it: &Class, found: &Found<Siva<DrivenHost>>| match it {
                    Class::Periodic(index) => found.attractors[*index].strobes.clone(),
                    other => panic!("{other:?}"),
                };
                let (one, two) = (strobes(class, &joined), strobes(other, &whole));
                assert!(search.join_mirrored || one.iter().any(|it| (it - two[0]).amax() < 1e-9));
            }
            for attractor in &joined.attractors {
                assert_eq!(attractor.is_pair(d), search.join_mirrored && pair, "{d}");
            }
        }
    }
}

/// A force of .1 off resonance moves the structure less than the gap is wide.
#[test]
fn what_has_no_impacts_is_said() {
    let harmonic = Harmonic { amplitude: 0.1, frequency: 1.3, phase: 0.0, acts: Acts::Primary };
    let force = Force::harmonic(vec![harmonic]).unwrap();
    let siva = Siva::new(0.1, 0.6, 5.0, 0.05).unwrap().under(force);
    let cycle = Cycle { begin: 0.0, length: TAU / 1.3 };
    let quiet = Trajectory::new(siva, &Start::default(), cycle).unwrap();
    let found = attractors(&[quiet.clone(), quiet], SEARCH, None).unwrap();
    assert_eq!(found.classes, [Class::NoImpacts; 2]);
    assert!(found.attractors.is_empty());
    let cancelled = true.into();
    let starts = drawn(&mut Rng::new(73), 4.5, 3);
    let none = attractors(&starts, SEARCH, Some(&cancelled)).unwrap();
    assert_eq!(none.classes, [Class::Unfinished(Outcome::Cancelled); 3]);
    let impossible = Search { most_periods: 0, ..SEARCH };
    assert!(attractors(&starts, impossible, None).is_err());
}
