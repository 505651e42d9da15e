//! Members that are points of the structure as well: others ride on them, forces act on them, and stops stand there.
//!
//! Numbers come from the same scenes said otherwise, from the ledger of energies, and from runs in numbers of twice the precision.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    real::Real,
    run::run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::composed::{self, Composed, Scenes};
use iva_tests::modal::{
    Mass, POINTS, any_mass, any_start, any_structure, built, furthest, limits, push, reals, ties,
    told,
};
use iva_tests::rng::Rng;
use iva_tests::some;

/// A mass that others do not use is the same mass if it is a body.
#[test]
fn a_body_is_its_mass() {
    let (mut compared, mut sticks) = (0, 0);
    for seed in 0..some(90) as u64 {
        let of = |bodies: bool| {
            let mut rng = Rng::new(8800 + seed);
            let masses: [Mass; 2] = [any_mass(&mut rng), any_mass(&mut rng)];
            let mut structure = any_structure::<f64>(&mut rng, 2, seed.is_multiple_of(3));
            let mut any = || rng.log_range(1e-3, 0.2);
            let (rubs, rises) = ([any(), 0.0], [any(), any()]);
            let tied = [[0.0; 2], if seed % 4 < 2 { [any(), any()] } else { [0.0; 2] }];
            let start = any_start::<f64, 2>(&mut rng, 2, &masses);
            let names = ["one", "other"];
            if bodies {
                for k in 0..2 {
                    structure = structure.with_body(names[k], masses[k][0]).unwrap();
                }
            }
            let members = [(built(masses[0]), POINTS[0]), (built(masses[1]), POINTS[1])];
            let system = Modal::<_, 2>::new(structure, members).unwrap();
            let system = system.with_bodies(&names.map(|it| bodies.then_some(it))).unwrap();
            let system = system.with_ties(&ties(&tied)).unwrap().with_friction(&rubs).unwrap();
            let system = system.with_gravity(&rises).unwrap();
            let acts = [Acts::Primary, Acts::Base][seed as usize % 2];
            let driven = system.under(push(0.4, 0.9, acts), POINTS[2]).unwrap();
            let run = run(&driven, &start, &limits(12.0)).unwrap();
            assert!(run.measures.energy_residual.abs() < 1e-12, "{seed}");
            told(&run)
        };
        let [(one, sticking, _), (other, also, _)] = [true, false].map(of);
        let few = one.len().min(other.len()).min(8);
        let off = furthest(&one[..few], &other[..few]);
        assert!(off < 1e-11, "{seed}: {off:e}");
        compared += few;
        let begun = sticking.iter().zip(&also).take(3);
        for (a, b) in begun {
            assert!((a - b).abs() < 1e-9, "{seed}: {a} {b}");
            sticks += 1;
        }
    }
    assert!(compared > some(400) && sticks > some(10), "{compared} {sticks}");
}

/// A mass on a spring between stops on the ground is a coordinate of the structure between them.
#[test]
fn a_stop_at_a_member_is_one_at_its_coordinate() {
    let (mass, spring) = (0.3, 0.2);
    let stop = FreeMass::on_ground(0.7, 0.4).unwrap();
    let free = FreeMass::new(mass, 0.5, 50.0).unwrap();
    let rest = GapPoint { y: 0.0, w: 0.0 };
    let structure = ModalStructure::new(&[1.0], &[0.02]).unwrap().with_point("p", &[1.0]).unwrap();
    let structure = structure.with_body("it", mass).unwrap();
    let system = Modal::<_, 2>::new(structure, [(free, "p"), (stop, "it")]).unwrap();
    let system = system.with_bodies(&[Some("it"), None]).unwrap();
    let system = system.with_ties(&ties(&[[spring, 0.01], [0.0; 2]])).unwrap();
    let start = ModalStart::new(&[1.0], &[0.0], [GapPoint { y: -1.0, w: 0.0 }, rest]).unwrap();
    let one = run(&system, &start, &limits(40.0)).unwrap();

    let m = [1.0, 0.0, 0.0, mass];
    let k = [1.0 + spring, -spring, -spring, spring];
    let c = [0.04 + 0.01, -0.01, -0.01, 0.01];
    let matrices = ModalStructure::from_matrices(&["p", "it"], &m, &k, &c).unwrap();
    let begin = matrices.modal(&m, &[1.0, 0.0]).unwrap();
    let system = Modal::<_, 1>::new(matrices, [(stop, "it")]).unwrap();
    let start = ModalStart::new(&begin, &[0.0; 2], [rest]).unwrap();
    let other = run(&system, &start, &limits(40.0)).unwrap();
    assert!(one.impacts.len() > 8 && one.impacts.len() == other.impacts.len());
    for (a, b) in one.impacts.iter().zip(&other.impacts) {
        assert!((a.time - b.time).abs() < 1e-12, "{} {}", a.time, b.time);
        assert!((a.velocity_before - b.velocity_before).abs() < 1e-12);
    }
}

/// A mass on a spring, on which one rides that rubs, on which a third rides; and a fourth beside them or on the first. A force acts on the first.
struct Nested;

impl Scenes for Nested {
    fn scene<R: Real>(seed: u64) -> Composed<R> {
        let mut rng = Rng::new(6600 + seed);
        let masses: [Mass; 4] = std::array::from_fn(|_| any_mass(&mut rng));
        let structure = any_structure::<R>(&mut rng, 2, seed.is_multiple_of(3));
        let [first, second] = [0, 1].map(|k: usize| R::from(masses[k][0]));
        let structure = structure.with_body("first", first).unwrap();
        let structure = structure.with_body("second", second).unwrap();
        let at = [
            POINTS[0],
            "first",
            "second",
            if seed.is_multiple_of(2) { "first" } else { POINTS[2] },
        ];
        let members = std::array::from_fn(|k| (built::<R>(masses[k]), at[k]));
        let start = any_start::<R, 4>(&mut rng, 2, &masses);
        let mut any = || rng.log_range(1e-3, 0.1);
        let tied = [
            [any(), any()],
            [0.0; 2],
            if seed % 4 < 2 { [any(), any()] } else { [0.0; 2] },
            [0.0; 2],
        ];
        let rises: [f64; 4] =
            if seed.is_multiple_of(3) { [any(), any(), any(), any()] } else { [0.0; 4] };
        let rubs = [if seed % 5 < 2 { any() } else { 0.0 }, any(), 0.0, any()];
        let system = Modal::new(structure, members).unwrap();
        let system = system.with_bodies(&[Some("first"), Some("second"), None, None]).unwrap();
        let system = system.with_ties(&ties(&tied)).unwrap().with_gravity(&reals(&rises)).unwrap();
        let system = system.with_friction(&reals(&rubs)).unwrap();
        let acts = [None, Some(Acts::Primary), Some(Acts::Base)][seed as usize % 3];
        let force = acts.map(|acts| {
            let on_first = Harmonic {
                amplitude: R::from(0.1),
                frequency: R::from(1.3),
                phase: R::ZERO,
                acts: Acts::Primary,
            };
            let index = system.structure().points().position(|name| name == "first").unwrap();
            let force: Force<R> = push(0.4, 0.9, acts);
            force.with_elsewhere(vec![(index, on_first)]).unwrap()
        });
        (system, start, force)
    }
}

/// The ledger closes, to all digits of either numbers.
#[test]
fn ledgers_close() {
    let ([_, _, _, rubbed, _], counted) = composed::ledgers_close::<Nested>(some(60));
    assert!(rubbed > 0.0 && counted[0] > some(900) && counted[1] > some(10), "{counted:?}");
}

#[test]
fn doubles_agree_with_twice_the_precision() {
    let compared = composed::doubles_agree::<Nested>(some(150), some(1300));
    assert!(compared > some(600), "{compared}");
}

/// Masses that squeeze each other have fewer and fewer impacts in ever shorter times, and then rest: no run goes on at the last digits for ever.
#[test]
fn masses_that_chatter_on_each_other_come_to_rest() {
    let mut episodes = 0;
    for seed in 0..50 {
        let (system, start, force) = Nested::scene::<f64>(seed);
        let force = force.unwrap_or_else(|| Force::harmonic(vec![]).unwrap());
        let driven = system.under(force, POINTS[1]).unwrap();
        let run = run(&driven, &start, &Limits { max_work: 10_000, ..limits(9.0) }).unwrap();
        assert_eq!(run.tally.outcome, Outcome::Finished, "{seed}");
        episodes += run.episodes.len();
    }
    assert!(episodes > 60, "{episodes}");
}

/// A body of another mass, one that rides on itself, and one after what rides on it are refused.
#[test]
fn a_body_without_sense_is_refused() {
    let structure = ModalStructure::<f64>::new(&[1.0], &[0.0]).unwrap();
    let structure = structure.with_point("p", &[1.0]).unwrap().with_body("it", 0.3).unwrap();
    let mass = |mu: f64| FreeMass::new(mu, 0.5, 0.4).unwrap();
    let refused = |members: [(FreeMass, &str); 2], names: [Option<&str>; 2]| {
        let system = Modal::<_, 2>::new(structure.clone(), members).unwrap();
        system.with_bodies(&names).unwrap_err().to_string()
    };
    let error = refused([(mass(0.2), "p"), (mass(0.1), "it")], [Some("it"), None]);
    assert!(error.contains("absorber.0.point") && error.contains("mass"), "{error}");
    let error = refused([(mass(0.1), "it"), (mass(0.3), "p")], [None, Some("it")]);
    assert!(error.contains("before"), "{error}");
    let error = refused([(mass(0.3), "it"), (mass(0.3), "p")], [Some("it"), None]);
    assert!(error.contains("before"), "{error}");
    let error = refused([(mass(0.3), "p"), (mass(0.3), "p")], [Some("p"), None]);
    assert!(error.contains("mass"), "{error}");
}
