//! Momentum, energy and the rule of what is carried, of free masses on a structure with several modes; and what is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    absorber::restitution::RestitutionLaw,
    absorber::{Absorber, ImpactLaw, OnStructure, Point},
    error::Invalid,
    force::{Acts, Force, Impulse},
    host::{Host, UndrivenHost},
    run::run,
    simulate::Outcome,
    siva::FreeMass,
};
use iva_tests::list::{self, list};
use iva_tests::modal::{
    Mass, POINTS, any_mass, any_start, any_structure, built, furthest, gaps, instants, limits,
    push, rows,
};
use iva_tests::rng::Rng;

/// Momentum and energy of every event, in random scenes of 2 to 6 modes with 1 to 4 absorbers; no mass leaves its gap.
#[test]
fn momentum_and_energy_hold() {
    let mut rng = Rng::new(11);
    let [mut impacts, mut episodes] = [0, 0];
    for k in 0..40 {
        let (n, full) = (2 + k % 5, k % 3 == 1);
        let structure = any_structure(&mut rng, n, full);
        let told = match k % 4 {
            0 => held::<1>(&mut rng, structure, k),
            1 => held::<2>(&mut rng, structure, k),
            2 => held::<3>(&mut rng, structure, k),
            _ => held::<4>(&mut rng, structure, k),
        };
        (impacts, episodes) = (impacts + told[0], episodes + told[1]);
    }
    assert!(impacts > 1000 && episodes > 20, "{impacts} impacts, {episodes} episodes");
}

fn held<const N: usize>(rng: &mut Rng, structure: ModalStructure, k: usize) -> [usize; 2] {
    let masses: [Mass; N] = std::array::from_fn(|_| any_mass(rng));
    let start = any_start(rng, structure.count(), &masses);
    let at: [_; N] = std::array::from_fn(|k| (built(masses[k]), POINTS[k]));
    let free = Modal::new(structure, at).unwrap();
    match (k / 4) % 4 {
        0 => holds(&free, &start, &masses),
        1 => holds(&free.under(push(0.6, 0.9, Acts::Primary), "p3").unwrap(), &start, &masses),
        2 => holds(&free.under(push(0.4, 1.3, Acts::Base), "p0").unwrap(), &start, &masses),
        _ => {
            let kick = |time| Impulse { velocity: rng.range(-1.0, 1.0), time };
            let kicks: Vec<Impulse> = [1.0, 4.0, 9.0, 16.0].map(kick).to_vec();
            let harmonics = push::<f64>(0.3, 1.2, Acts::Primary).harmonics().to_vec();
            let force = Force::new(harmonics, vec![], &kicks).unwrap();
            holds(&free.under(force, "p0").unwrap(), &start, &masses)
        }
    }
}

fn holds<H: Host<Real = f64>, const N: usize>(
    system: &Modal<H, N>,
    start: &ModalStart<f64, N>,
    masses: &[Mass; N],
) -> [usize; 2] {
    let run = run(system, start, &limits(30.0)).unwrap();
    assert_eq!(run.tally.outcome, Outcome::Finished);
    let residual = run.measures.energy_residual;
    assert!(residual.abs() < 1e-12, "{residual:e} of {}", run.measures.energy_initial);
    for impact in &run.impacts {
        let e = masses[usize::from(impact.absorber)][1];
        let (w, after) = (impact.gap_velocity_before, impact.gap_velocity_after);
        assert!(w * impact.wall.sign() > 0.0 && (after + e * w).abs() <= 1e-15 * w.abs());
        // The structure yields where it is hit.
        let gained = impact.velocity_after - impact.velocity_before;
        assert!(gained * w >= -1e-15 && impact.energy_loss >= 0.0);
    }
    assert!(run.impacts.windows(2).all(|two| two[0].time <= two[1].time), "in order of time");
    for (gap, [_, _, d, offset, ..]) in system.gaps(&run.tally.state).iter().zip(masses) {
        assert!((gap.y - offset).abs() <= *d);
    }
    [run.impacts.len(), run.episodes.len()]
}

/// The rule of what is carried, in random scenes with three stuck masses that a fourth hits: walls push or the gap opens,
/// momentum holds by mode, and energy falls by the losses. The masses press on their walls at random.
#[test]
fn walls_push_what_they_carry() {
    let mut rng = Rng::new(61);
    let mut seen = [0; 4];
    for _ in 0..400 {
        let n = 2 + (rng.unit() * 5.0) as usize;
        let structure = any_structure::<f64>(&mut rng, n, false);
        let masses: [Mass; 4] = std::array::from_fn(|_| {
            let [mu, e, d, ..] = any_mass(&mut rng);
            let side = rng.sign();
            [mu, e, d, 0.0, side * d, 0.0]
        });
        let mut masses = masses;
        masses[3][5] = masses[3][4].signum() * rng.range(0.5, 2.0);
        let at: [_; 4] = std::array::from_fn(|k| (built(masses[k]), POINTS[k]));
        let system = Modal::new(structure.clone(), at).unwrap();
        let start = any_start(&mut rng, n, &masses);
        let mut state = system.begin(&start);
        for k in 0..3 {
            state = system.stick(&system.turned_to(&state, k)).0;
        }
        let state = system.turned_to(&state, 3);
        let (after, impact) = system.impact(&state, 0.0);
        let lost = system.energy(&state) - system.energy(&after);
        assert!((lost - impact.energy_loss).abs() < 1e-14 * system.energy(&state), "{lost}");
        // The impulse on each mass, from its absolute velocity.
        let speed = |state: &_, k: usize| {
            let shape = structure.shapes(POINTS[k]).unwrap();
            let v = state_velocity(&system, state, shape);
            v + system.gaps(state)[k].w
        };
        let impulses: [f64; 4] =
            std::array::from_fn(|k| masses[k][0] * (speed(&state, k) - speed(&after, k)));
        for (k, impulse) in impulses.iter().enumerate().take(3) {
            let side = masses[k][4].signum();
            let stuck = system.is_stuck(&system.turned_to(&after, k));
            let opens = -side * system.gaps(&after)[k].w;
            let off = 1e-14;
            let fits = if stuck {
                side * impulse >= -off && opens == 0.0
            } else {
                opens > 0.0 && impulse.abs() < off
            };
            assert!(fits, "{k}: stuck {stuck}, impulse {impulse:e}, opens with {opens:e}");
            seen[usize::from(stuck)] += 1;
        }
        for j in 0..n {
            let given: f64 =
                (0..4).map(|k| structure.shapes(POINTS[k]).unwrap()[j] * impulses[k]).sum();
            let [a, b] = [&state, &after].map(|it| it.modes().velocities[j].value);
            assert!((b - a - given).abs() < 1e-14, "mode {j}");
        }
        seen[2] += usize::from(impulses[3] * masses[3][4] > 0.0);
        seen[3] += 1;
    }
    assert!(seen[0] > 100 && seen[1] > 100 && seen[2] == seen[3], "{seen:?}");
}

fn state_velocity<const N: usize>(
    _system: &Modal<UndrivenHost, N>,
    state: &<Modal<UndrivenHost, N> as OnStructure>::State,
    shape: &[f64],
) -> f64 {
    shape.iter().zip(&state.modes().velocities).map(|(phi, v)| phi * v.value).sum()
}

/// Two masses on a spring that nothing holds, one of them with an absorber: the momentum of all stays.
#[test]
fn a_structure_that_nothing_holds_keeps_its_momentum() {
    let (mass, spring) = ([2.0, 0.0, 0.0, 1.0], [1.5, -1.5, -1.5, 1.5]);
    let dashpot = spring.map(|k| 0.02 * k);
    let structure = ModalStructure::from_matrices(&["a", "b"], &mass, &spring, &dashpot).unwrap();
    assert!(structure.is_separate() && structure.frequency(0).unwrap() < 1e-7);
    assert!((structure.frequency(1).unwrap() - 1.5).abs() < 1e-15);
    let it = [0.3, 0.5, 0.2, 0.0, 0.1, 0.4];
    let v = structure.modal(&mass, &[0.7, -0.2]).unwrap();
    let system = Modal::new(structure.clone(), [(built::<f64>(it), "b")]).unwrap();
    let start = ModalStart::new(&[], &v, gaps(&[it])).unwrap();
    let run = run(&system, &start, &limits(30.0)).unwrap();
    assert!(run.impacts.len() > 10 && run.tally.outcome == Outcome::Finished);
    let momentum = |state: &_| {
        let of = |name: &str| state_velocity(&system, state, structure.shapes(name).unwrap());
        let absorber = of("b") + system.gaps(state)[0].w;
        2.0 * of("a") + of("b") + 0.3 * absorber
    };
    // 2 · 0.7 − 0.2 + 0.3 (0.4 − 0.2)
    for state in [&system.begin(&start), &run.tally.state] {
        assert!((momentum(state) - 1.26).abs() < 2e-15, "{}", momentum(state));
    }
}

/// What cannot be used is refused with a sentence that says where and why.
#[test]
fn bad_input_is_refused() {
    let said = |it: Result<ModalStructure, Invalid>| it.unwrap_err().to_string();
    let two = || ModalStructure::new(&[1.0, 2.0], &[0.0, 0.01]).unwrap();
    let fails = [
        (said(ModalStructure::new(&[], &[])), "from 1 to 40 modes"),
        (said(ModalStructure::new(&[1.0], &[0.0, 0.0])), "structure.damping_ratios"),
        (said(ModalStructure::new(&[1.0, -2.0], &[0.0, 0.0])), "structure.frequencies[1] = -2"),
        (said(two().with_point("a", &[1.0])), "structure.points.a"),
        (said(two().with_damping(&[0.1, 0.2, 0.3, 0.1])), "symmetric"),
        (said(two().with_damping(&[0.1, 0.2, 0.2, 0.1])), "dampers feed no energy"),
    ];
    let names = ["x", "y"];
    let (unit, zero) = ([1.0, 0.0, 0.0, 1.0], [0.0; 4]);
    let matrices =
        |m: &[f64], k: &[f64], c: &[f64]| said(ModalStructure::from_matrices(&names, m, k, c));
    let more = [
        (matrices(&[1.0, 2.0, 2.0, 1.0], &unit, &zero), "positive definite"),
        (matrices(&unit, &[1.0, 2.0, 2.0, 1.0], &zero), "springs feed no energy"),
        (matrices(&unit, &[1.0, 0.5, 0.0, 1.0], &zero), "structure.stiffness[1][0] = 0"),
        (matrices(&unit, &unit, &[f64::NAN, 0.0, 0.0, 1.0]), "structure.damping"),
        (matrices(&unit[..3], &unit, &zero), "structure.mass = 3 numbers: give 4"),
    ];
    for (sentence, part) in fails.iter().chain(&more) {
        assert!(sentence.contains(part), "{sentence}");
    }
    let there = two().with_point("a", &[1.0, 0.5]).unwrap();
    let mass = built::<f64>([0.1, 0.5, 0.4, 0.0, 0.0, 0.0]);
    let error = Modal::new(there.clone(), [(mass, "b")]).unwrap_err().to_string();
    assert!(error.contains("absorber.0.point = b: give one of the points a"), "{error}");
    let system = Modal::new(there, [(mass, "a")]).unwrap();
    let error = system.under(push(0.1, 1.0, Acts::Base), "a").unwrap_err().to_string();
    assert!(error.contains("participation"), "{error}");
    let outside = ModalStart::new(&[1.0], &[], gaps(&[[0.1, 0.5, 0.4, 0.0, 0.5, 0.0]])).unwrap();
    let error = system.check_start(&outside).unwrap_err().to_string();
    assert!(error.contains("start.0.gap_displacement"), "{error}");
}

/// Random laws of restitution: power laws, of plastic spheres, and tables.
fn any_laws(rng: &mut Rng, kind: usize) -> [RestitutionLaw; 2] {
    [(); 2].map(|()| match kind % 4 {
        0 => RestitutionLaw::through(rng.range(0.1, 0.5), rng.range(0.3, 1.0), [1, 5]).unwrap(),
        1 => RestitutionLaw::through(rng.range(0.1, 0.5), rng.range(0.1, 0.3), [1, 5]).unwrap(),
        2 => RestitutionLaw::table(&[[0.0, rng.range(0.2, 0.6)], [1.0, rng.range(0.1, 0.2)]])
            .unwrap(),
        _ => RestitutionLaw::table(&[[0.1, 0.8], [0.4, rng.range(0.3, 0.6)]]).unwrap(),
    })
}

/// One mode is the list of masses that flies in closed form, with a restitution that depends on the approach speed: rows of
/// impacts, sticks and releases, over the first impacts, which conditioning has not yet spread.
#[test]
fn laws_on_one_mode_are_those_of_a_list() {
    let mut rng = Rng::new(97);
    let [mut impacts, mut episodes] = [0, 0];
    for k in 0..40 {
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let laws = any_laws(&mut rng, k);
        let lawful = masses.map(|mass| built::<f64>(mass).with_restitution_laws(laws));
        let (x, v, zeta) = (rng.range(0.5, 1.5), rng.range(-0.5, 0.5), rng.range(0.0, 0.05));
        let structure = ModalStructure::new(&[1.0], &[zeta]).unwrap();
        // With a point that moves half as far the structure does not move as one.
        let structure = structure.with_point("it", &[1.0]).unwrap();
        let structure = structure.with_point("below", &[0.5]).unwrap();
        let begun = ModalStart::new(&[x], &[v], gaps(&masses)).unwrap();
        let modal = Modal::new(structure, lawful.map(|mass| (mass, "it"))).unwrap();
        let list = list(zeta, &lawful);
        let starts = list::begun(Point { x, v }, &gaps::<f64, 2>(&masses));
        let (a, b) = if k % 3 == 0 {
            let force = || push(0.4, 0.9, Acts::Primary);
            let modal = modal.under(force(), "it").unwrap();
            let a = run(&modal, &begun, &limits(12.0)).unwrap();
            let b = run(&list::driven(&list, force()), &starts, &limits(12.0)).unwrap();
            ((rows(&a.impacts), instants(&a)), (rows(&b.impacts), instants(&b)))
        } else {
            let a = run(&modal, &begun, &limits(12.0)).unwrap();
            let b = run(&list, &starts, &limits(12.0)).unwrap();
            ((rows(&a.impacts), instants(&a)), (rows(&b.impacts), instants(&b)))
        };
        let first = a.0.len().min(12);
        assert!(first > 1, "{k}: {first}");
        let off = furthest(&a.0[..first], &b.0[..first]);
        assert!(off < 1e-11, "{k}: {off:e}");
        let alike = a.1.iter().zip(&b.1).take(3).all(|(one, other)| (one - other).abs() < 1e-7);
        assert!(alike, "{k}: {:?} {:?}", a.1, b.1);
        (impacts, episodes) = (impacts + first, episodes + a.1.len());
    }
    assert!(impacts > 200 && episodes > 15, "{impacts} {episodes}");
}

/// A law that is the same at all speeds is the number, to the bit; and energy holds with one that is not.
#[test]
fn a_constant_law_is_a_number_and_energy_holds_with_others() {
    let mut rng = Rng::new(101);
    for k in 0..12 {
        let structure: ModalStructure = any_structure(&mut rng, 2 + k % 3, k % 2 == 0);
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let start = any_start(&mut rng, structure.count(), &masses);
        let constant = |mass: Mass| {
            let law = RestitutionLaw::table(&[[0.5, mass[1]], [1.0, mass[1]]]).unwrap();
            built::<f64>(mass).with_restitution_laws([law; 2])
        };
        let told = |masses: [FreeMass; 2]| {
            let at = [(masses[0], "p0"), (masses[1], "p1")];
            let modal = Modal::new(structure.clone(), at).unwrap();
            let run = run(&modal, &start, &limits(15.0)).unwrap();
            assert!(run.measures.energy_residual.abs() < 1e-12, "{k}");
            rows(&run.impacts)
        };
        let number = told(masses.map(built));
        assert_eq!(number, told(masses.map(constant)));
        let laws = any_laws(&mut rng, k);
        let lawful = told(masses.map(|mass| built::<f64>(mass).with_restitution_laws(laws)));
        assert_ne!(number, lawful);
    }
}
