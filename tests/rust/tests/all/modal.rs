//! Free masses on a structure with several modes.
//!
//! Numbers come from closed forms (one mode is the structure of old, in units of its own; a mode with a node at the
//! absorber moves as if there were none), from the mirror image of a scene, and from runs in numbers of twice the
//! precision. Momentum and energy: `modal_law.rs`; reference event lists: `modal_reference.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure, PRIMARY},
    absorber::{Absorber, OnStructure, Point, Start},
    force::{Acts, Force, Harmonic, Impulse},
    real::{Real, twofold::Twofold},
    run::run,
    simulate::{Limits, Outcome, simulate},
    siva::{FreeMass, Siva},
};
use iva_tests::list::{begun, driven, list};
use iva_tests::modal::{
    Mass, POINTS, Row, any_mass, any_start, any_structure, built, furthest, gaps, instants, limits,
    push, rows, told,
};
use iva_tests::rng::Rng;

/// A mode of frequency ω = 2 and shape φ = 1/2 is a structure of mass 4: in its own units the masses weigh φ² as much, and
/// velocities are those over ω. All are powers of two, so that nothing is rounded.
#[test]
fn one_mode_is_the_structure_of_old() {
    let mut rng = Rng::new(5);
    let [mut impacts, mut episodes] = [0, 0];
    for k in 0..16 {
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let (x, v, zeta) = (rng.range(0.3, 2.0), rng.range(-1.0, 1.0), rng.range(0.0, 0.1));
        let n = Twofold::from;
        let several = list(n(zeta), &masses.map(built));
        let start = begun(Point { x: n(x), v: n(v) }, &gaps::<Twofold, 2>(&masses));
        let mode = ModalStructure::new(&[n(2.0)], &[n(zeta)]).unwrap();
        let mode = mode.with_point("top", &[n(0.5)]).unwrap().with_base(&[n(2.0)]).unwrap();
        let heavy = masses.map(|[mu, rest @ .., w]| {
            let [e, d, offset, y] = rest;
            [4.0 * mu, e, d, offset, y, 2.0 * w]
        });
        let modal = Modal::new(mode, heavy.map(|mass| (built(mass), "top"))).unwrap();
        let started = ModalStart::new(&[n(2.0 * x)], &[n(4.0 * v)], gaps(&heavy)).unwrap();
        // The floor below which rebounds of a chatter are not listed is a velocity.
        let (long, short) = (limits(14.0), Limits::new(n(7.0), n(0.6)));
        let acts = if k % 4 == 1 { Acts::Base } else { Acts::Primary };
        let [old, new] = if k % 2 == 0 {
            [
                told(&run(&several, &start, &long).unwrap()),
                told(&run(&modal, &started, &short).unwrap()),
            ]
        } else {
            // A force f/M in ωn² × length is 4 · 4 times as large on mass 4, an acceleration 4 times.
            let size = if acts == Acts::Base { 4.0 } else { 16.0 };
            let old = driven(&several, push(0.4, 0.9, acts));
            let new = modal.under(push(0.4 * size, 1.8, acts), "top").unwrap();
            [told(&run(&old, &start, &long).unwrap()), told(&run(&new, &started, &short).unwrap())]
        };
        let scaled = |(k, [t, wall, a, b, c, d]): &Row| {
            (*k, [2.0 * t, *wall, a / 2.0, b / 2.0, c / 2.0, d / 2.0])
        };
        let off = furthest(&old.0, &new.0.iter().map(scaled).collect::<Vec<_>>());
        assert!(off < 1e-13, "scene {k}: {off:e}");
        assert_eq!(old.1.len(), new.1.len(), "scene {k}: episodes");
        for (a, b) in old.1.iter().zip(&new.1) {
            assert!((a - 2.0 * b).abs() < 1e-13, "scene {k}: {a} {b}");
        }
        assert!((old.2 - new.2 / 16.0).abs() < 1e-12, "scene {k}: work {} {}", old.2, new.2);
        (impacts, episodes) = (impacts + old.0.len(), episodes + old.1.len() / 3);
    }
    assert!(impacts > 100 && episodes > 8, "{impacts} impacts, {episodes} episodes");
}

/// A single mass is decided by itself, not beside others, and is the SIVA: in doubles to a few rounding units.
#[test]
fn one_mass_on_one_mode_is_the_siva() {
    let mut rng = Rng::new(17);
    let mut worst: f64 = 0.0;
    let mut episodes = 0;
    for k in 0..20 {
        let [mu, e, d, ..] = any_mass(&mut rng);
        let (x, zeta) = (rng.range(0.5, 2.0), rng.range(0.0, 0.1));
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        let start = Start { displacement: x, ..Start::default() };
        let mut mode = ModalStructure::moving_as_one(zeta).unwrap();
        if k % 2 == 0 {
            // With a point that moves half as far the structure does not move as one.
            mode = mode.with_point("below", &[0.5]).unwrap();
        }
        let modal = Modal::new(mode, [(FreeMass::new(mu, e, d).unwrap(), PRIMARY)]).unwrap();
        let started = ModalStart::new(&[x], &[], gaps(&[[mu, e, d, 0.0, 0.0, 0.0]])).unwrap();
        let [old, new] = [
            told(&run(&siva, &start, &limits(20.0)).unwrap()),
            told(&run(&modal, &started, &limits(20.0)).unwrap()),
        ];
        assert_eq!((old.0.len(), old.1.len()), (new.0.len(), new.1.len()));
        let [a, b] = [old.0, new.0].map(|rows| rows[..3.min(rows.len())].to_vec());
        worst = worst.max(furthest(&a, &b));
        episodes += old.1.len() / 3;
    }
    assert!(worst < 4e-15 && episodes > 4, "{worst:e}, {episodes} episodes");
}

/// Where all absorbers are at nodes of the second mode, that is free: a damped sinusoid through all their impacts.
#[test]
fn a_mode_with_a_node_at_the_absorbers_is_free() {
    let (w, zeta, q, v) = (2.7, 0.01, 0.3, -0.2);
    let structure = ModalStructure::new(&[1.0, w, 4.1], &[0.02, zeta, 0.03]).unwrap();
    let structure = structure.with_point("a", &[1.0, 0.0, 0.4]).unwrap();
    let structure = structure.with_point("b", &[-0.6, 0.0, 0.9]).unwrap();
    let masses = [[0.1, 0.3, 0.2, 0.0, 0.0, 0.0], [0.2, 0.6, 0.4, 0.0, 0.1, 0.0]];
    let [a, b] = masses.map(built);
    let system = Modal::new(structure, [(a, "a"), (b, "b")]).unwrap();
    let start = ModalStart::new(&[1.0, q, 0.1], &[0.0, v, 0.0], gaps(&masses)).unwrap();
    let t = 25.0;
    let run = run(&system, &start, &limits(t)).unwrap();
    assert!(run.impacts.len() > 20 && !run.episodes.is_empty());
    let (rate, damped) = (zeta * w, w * f64::sqrt(1.0 - zeta * zeta));
    let expected =
        (-rate * t).exp() * (q * (damped * t).cos() + (v + rate * q) / damped * (damped * t).sin());
    let found = run.tally.state.modes().places[1].value;
    assert!((found - expected).abs() < 3e-15, "{found} {expected}");
}

/// A list of masses on a structure is the same as an array of them, to the bit: in decays, under a force with an impulse, and on
/// a moving base. The impulse also meets masses that are stuck.
#[test]
fn a_list_is_an_array_to_the_bit() {
    let mut rng = Rng::new(31);
    let mut impacts = 0;
    for k in 0..12 {
        let structure = any_structure::<f64>(&mut rng, 3, k % 2 == 0);
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let at: [_; 2] = std::array::from_fn(|k| (built(masses[k]), POINTS[k]));
        let array = Modal::new(structure.clone(), at).unwrap();
        let list = Modal::of(structure, &at).unwrap();
        let mut values = || -> [f64; 3] { std::array::from_fn(|_| rng.range(-1.0, 1.0)) };
        let (q, v) = (values(), values());
        let start = ModalStart::new(&q, &v, gaps(&masses)).unwrap();
        let [one, other] = gaps(&masses);
        let room = std::array::from_fn(|k| if k == 0 { one } else { other });
        let longer = ModalStart::new(&q, &v, room).unwrap();
        let limits = limits(20.0);
        let [found, known] = if k % 3 == 0 {
            [
                run(&list, &longer, &limits).map(|it| told(&it)),
                run(&array, &start, &limits).map(|it| told(&it)),
            ]
        } else {
            let acts = if k % 3 == 1 { Acts::Base } else { Acts::Primary };
            let harmonic = Harmonic { amplitude: 0.4, frequency: 0.9, phase: 0.2, acts };
            let blows = [3.0, 7.5].map(|time| Impulse { velocity: 0.5, time });
            let force = Force::new(vec![harmonic], vec![], &blows).unwrap();
            let (a, b) = (
                list.under(force.clone(), POINTS[0]).unwrap(),
                array.under(force, POINTS[0]).unwrap(),
            );
            let found = run(&a, &longer, &limits).map(|it| {
                let m = &it.measures;
                let whole = m.energy_initial + m.energy_viscous + m.energy_work.abs();
                assert!(
                    m.energy_residual.abs() < 1e-13 * whole,
                    "{} of {whole}",
                    m.energy_residual
                );
                told(&it)
            });
            [found, run(&b, &start, &limits).map(|it| told(&it))]
        };
        let (found, known) = (found.unwrap(), known.unwrap());
        impacts += known.0.len();
        assert_eq!(found, known);
    }
    assert!(impacts > 200, "{impacts}");
}

/// The mirror image of a scene has the mirror image of its events, to the bit.
#[test]
fn a_mirrored_scene_is_mirrored_to_the_bit() {
    let mut rng = Rng::new(23);
    for k in 0..12 {
        let structure = any_structure::<f64>(&mut rng, 3, k % 2 == 0);
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let image = masses.map(|[mu, e, d, offset, y, w]| [mu, e, d, -offset, -y, -w]);
        let [q, v]: [[f64; 3]; 2] =
            std::array::from_fn(|_| std::array::from_fn(|_| rng.range(-1.0, 1.0)));
        let of = |masses: [Mass; 3], sign: f64| {
            let at: [_; 3] = std::array::from_fn(|k| (built(masses[k]), POINTS[k]));
            let system = Modal::new(structure.clone(), at).unwrap();
            let [q, v] = [q, v].map(|all| all.map(|it| sign * it));
            let start = ModalStart::new(&q, &v, gaps(&masses)).unwrap();
            run(&system, &start, &limits(20.0)).unwrap()
        };
        let (one, other) = (of(masses, 1.0), of(image, -1.0));
        let turned =
            |(index, [time, wall, v, v1, w, w1]): Row| (index, [time, -wall, -v, -v1, -w, -w1]);
        let back: Vec<_> = rows(&other.impacts).into_iter().map(turned).collect();
        assert_eq!(rows(&one.impacts), back);
        assert_eq!(instants(&one), instants(&other));
    }
}

/// In doubles, runs agree with those in numbers of twice the precision as far as conditioning allows: over few impacts.
#[test]
fn doubles_agree_with_twice_the_precision() {
    let (mut worst, mut compared): (f64, usize) = (0.0, 0);
    for seed in 0..8 {
        let of = |plain: bool| {
            let mut rng = Rng::new(157 + seed);
            let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
            if plain {
                impacts_of::<f64>(&mut rng, &masses)
            } else {
                impacts_of::<Twofold>(&mut rng, &masses)
            }
        };
        let [plain, precise] = [of(true), of(false)];
        for (a, b) in plain.iter().zip(&precise).take(8) {
            assert_eq!(a.0, b.0);
            worst = worst.max((a.1[0] - b.1[0]).abs());
            compared += 1;
        }
    }
    assert!(worst < 1e-12 && compared > 40, "{worst:e} in {compared}");
}

fn impacts_of<R: Real>(rng: &mut Rng, masses: &[Mass; 3]) -> Vec<Row> {
    let structure = any_structure::<R>(rng, 4, rng.clone().unit() > 0.5);
    let at: [_; 3] = std::array::from_fn(|k| (built::<R>(masses[k]), POINTS[k]));
    let start = any_start::<R, 3>(rng, 4, masses);
    rows(&run(&Modal::new(structure, at).unwrap(), &start, &limits(10.0)).unwrap().impacts)
}

/// Without damping and with e = 1 energy stays, over ten thousand periods of the slowest mode.
#[test]
fn energy_does_not_drift() {
    let structure = ModalStructure::new(&[1.0, 1.7], &[0.0, 0.0]).unwrap();
    let structure = structure.with_point("a", &[0.8, 0.6]).unwrap();
    let masses = [[0.1, 1.0, 0.9, 0.0, 0.1, 0.2]];
    let system = Modal::new(structure, [(built(masses[0]), "a")]).unwrap();
    let start = ModalStart::new(&[1.0, 0.4], &[0.0, 0.3], gaps(&masses)).unwrap();
    let begin = system.energy(&system.begin(&start));
    let limits = Limits::new(1e4 * std::f64::consts::TAU, 0.9);
    let tally = simulate(&system, &start, &limits, None, &mut ()).unwrap();
    assert_eq!(tally.outcome, Outcome::Finished);
    let drift = (system.energy(&tally.state) - begin) / (begin * f64::EPSILON);
    println!("{} impacts, {} segments: {drift} units of 2⁻⁵²", tally.impacts, tally.work);
    assert!(tally.impacts > 10_000 && drift.abs() < 32.0, "{drift} units");
}

/// Twenty modes with five absorbers, free and with a full damping matrix: what an impact costs. Not judged.
#[test]
#[ignore = "prints times"]
fn cost_of_twenty_modes() {
    for full in [false, true] {
        let mut rng = Rng::new(3);
        let mut structure =
            ModalStructure::new(&(1..=20).map(f64::from).collect::<Vec<_>>(), &[0.01; 20]).unwrap();
        if full {
            let c: Vec<f64> = (0..20).map(|_| rng.range(-0.1, 0.1)).collect();
            let matrix: Vec<f64> = (0..400).map(|e| c[e / 20] * c[e % 20]).collect();
            structure = structure.with_damping(&matrix).unwrap();
        }
        let names = ["a", "b", "c", "d", "e"];
        for (i, name) in names.iter().enumerate() {
            let place = (i as f64 + 1.0) / 6.0 * std::f64::consts::PI;
            let shapes: Vec<f64> = (1..=20).map(|j| (f64::from(j) * place).sin()).collect();
            structure = structure.with_point(name, &shapes).unwrap();
        }
        let masses: [Mass; 5] = std::array::from_fn(|_| any_mass(&mut rng));
        let at: [_; 5] = std::array::from_fn(|k| (built(masses[k]), names[k]));
        let system = Modal::new(structure, at).unwrap();
        let start = any_start(&mut rng, 20, &masses);
        let begin = std::time::Instant::now();
        let tally = simulate(&system, &start, &limits(40.0), None, &mut ()).unwrap();
        let took = begin.elapsed().as_secs_f64() * 1e6;
        let (impacts, work) = (tally.impacts as f64, tally.work as f64);
        println!(
            "full {full}: {impacts} impacts, {} episodes, {work} segments, {:.0} µs an impact, {:.1} µs a segment",
            tally.episodes,
            took / impacts,
            took / work
        );
        assert_eq!(tally.outcome, Outcome::Finished);
    }
}
