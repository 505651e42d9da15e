//! Free masses on a structure with several modes.
//!
//! Numbers come from closed forms (one mode is the structure of old, in units of its own; a mode with a node at the
//! absorber moves as if there were none), from momentum, energy and the rule of what is carried, from the mirror image of
//! a scene, and from runs in numbers of twice the precision. Reference event lists: `modal_reference.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    absorber::several::{Several, Starts},
    absorber::{Absorber, ImpactLaw, OnStructure, Point, Start},
    error::Invalid,
    flight::GapPoint,
    force::{Acts, Force, Harmonic, Impulse},
    host::{Host, UndrivenHost},
    impact::Impact,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome},
    siva::{FreeMass, Siva},
};
use iva_tests::rng::Rng;

/// Parameters of a mass and its start: μ, e, d, offset, y and w.
type Mass = [f64; 6];

fn any_mass(rng: &mut Rng) -> Mass {
    let d = rng.range(0.2, 1.5);
    let offset = rng.range(-0.2, 0.2);
    let y = offset + d * rng.range(-0.9, 0.9);
    [rng.log_range(0.02, 0.5), rng.range(0.2, 0.95), d, offset, y, rng.range(-0.5, 0.5)]
}

fn built<R: Real>([mu, e, d, offset, ..]: Mass) -> FreeMass<R> {
    let mass = FreeMass::new(mu.into(), e.into(), d.into()).unwrap();
    mass.with_offset(offset.into()).unwrap()
}

fn gaps<R: Real, const N: usize>(masses: &[Mass; N]) -> [GapPoint<R>; N] {
    masses.map(|[.., y, w]| GapPoint { y: y.into(), w: w.into() })
}

fn reals<R: Real>(numbers: &[f64]) -> Vec<R> {
    numbers.iter().map(|it| R::from(*it)).collect()
}

fn push<R: Real>(amplitude: f64, frequency: f64, acts: Acts) -> Force<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, 0.3].map(R::from);
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase, acts }]).unwrap()
}

fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(duration.into(), R::from(0.3))
}

/// An impact: the index of its absorber, and time, wall, velocities before and after.
type Row = (u8, [f64; 6]);

fn rows<R: Real>(impacts: &[Impact<R>]) -> Vec<Row> {
    let row = |it: &Impact<R>| {
        let numbers = [it.time, it.velocity_before, it.velocity_after];
        let [time, before, after] = numbers.map(Real::double);
        let [w, to] = [it.gap_velocity_before, it.gap_velocity_after].map(Real::double);
        (it.absorber, [time, it.wall.sign(), before, after, w, to])
    };
    impacts.iter().map(row).collect()
}

fn instants<S, R: Real>(run: &Run<S, R>) -> Vec<f64> {
    let each = run.episodes.iter().flat_map(|episode| {
        let release = episode.release_time.unwrap_or(R::ZERO);
        [episode.start_time, episode.stick_time, release].map(Real::double)
    });
    each.collect()
}

fn furthest(a: &[Row], b: &[Row]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many impacts");
    let off = |(a, b): (&Row, &Row)| (0..6).map(|k| (a.1[k] - b.1[k]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(off).fold(0.0, f64::max)
}

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
        let several = Several::new(n(zeta), masses.map(built)).unwrap();
        let start = Starts { primary: Point { x: n(x), v: n(v) }, gaps: gaps(&masses) };
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
            [told(&run(&several, &start, &long).unwrap()), told(&run(&modal, &started, &short).unwrap())]
        } else {
            // A force f/M in ωn² × length is 4 · 4 times as large on mass 4, an acceleration 4 times.
            let size = if acts == Acts::Base { 4.0 } else { 16.0 };
            let old = several.under(push(0.4, 0.9, acts));
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

/// Rows of impacts, instants of stick episodes, and the work of the drive.
fn told<S, R: Real>(run: &Run<S, R>) -> (Vec<Row>, Vec<f64>, f64) {
    assert_eq!(run.tally.outcome, Outcome::Finished);
    (rows(&run.impacts), instants(run), run.measures.energy_work.double())
}

/// A single mass is decided by itself, not beside others, and is the SIVA: in doubles to a few rounding units.
#[test]
fn one_mass_on_one_mode_is_the_siva() {
    let mut rng = Rng::new(17);
    let mut worst: f64 = 0.0;
    let mut episodes = 0;
    for _ in 0..20 {
        let [mu, e, d, ..] = any_mass(&mut rng);
        let (x, zeta) = (rng.range(0.5, 2.0), rng.range(0.0, 0.1));
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        let start = Start { displacement: x, ..Start::default() };
        let mode = ModalStructure::new(&[1.0], &[zeta]).unwrap().with_point("it", &[1.0]).unwrap();
        let modal = Modal::new(mode, [(FreeMass::new(mu, e, d).unwrap(), "it")]).unwrap();
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
    let expected = (-rate * t).exp()
        * (q * (damped * t).cos() + (v + rate * q) / damped * (damped * t).sin());
    let found = run.tally.state.modes().places[1].value;
    assert!((found - expected).abs() < 3e-15, "{found} {expected}");
}

/// A structure of random modes, with four points, and any damping.
fn any_structure<R: Real>(rng: &mut Rng, n: usize, full: bool) -> ModalStructure<R> {
    let mut frequencies = vec![1.0];
    while frequencies.len() < n {
        frequencies.push(frequencies[frequencies.len() - 1] * rng.range(1.2, 2.0));
    }
    let ratios: Vec<f64> = frequencies.iter().map(|_| rng.range(0.0, 0.04)).collect();
    let mut structure = ModalStructure::new(&reals(&frequencies), &reals(&ratios)).unwrap();
    if full {
        // Two dashpots: c cᵀ is not negative.
        let dashpots: [Vec<f64>; 2] = std::array::from_fn(|_| (0..n).map(|_| rng.range(-0.2, 0.2)).collect());
        let element = |e: usize| dashpots.iter().map(|c| c[e / n] * c[e % n]).sum::<f64>();
        let matrix: Vec<f64> = (0..n * n).map(element).collect();
        structure = structure.with_damping(&reals(&matrix)).unwrap();
    }
    for name in ["p0", "p1", "p2", "p3"] {
        let shapes: Vec<f64> = (0..n).map(|j| rng.range(-1.0, 1.0) / (1.0 + j as f64 * 0.3)).collect();
        structure = structure.with_point(name, &reals(&shapes)).unwrap();
    }
    let parts: Vec<f64> = (0..n).map(|_| rng.range(-1.0, 1.0)).collect();
    structure.with_base(&reals(&parts)).unwrap()
}

const POINTS: [&str; 4] = ["p0", "p1", "p2", "p3"];

fn any_start<R: Real, const N: usize>(rng: &mut Rng, n: usize, masses: &[Mass; N]) -> ModalStart<R, N> {
    let mut all = |size: f64| -> Vec<f64> { (0..n).map(|j| size * rng.range(-1.0, 1.0) / (1.0 + j as f64)).collect() };
    let (q, v) = (all(2.0), all(0.5));
    ModalStart::new(&reals::<R>(&q), &reals::<R>(&v), gaps(masses)).unwrap()
}

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
            let fits = if stuck { side * impulse >= -off && opens == 0.0 } else { opens > 0.0 && impulse.abs() < off };
            assert!(fits, "{k}: stuck {stuck}, impulse {impulse:e}, opens with {opens:e}");
            seen[usize::from(stuck)] += 1;
        }
        for j in 0..n {
            let given: f64 = (0..4).map(|k| structure.shapes(POINTS[k]).unwrap()[j] * impulses[k]).sum();
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

/// The mirror image of a scene has the mirror image of its events, to the bit.
#[test]
fn a_mirrored_scene_is_mirrored_to_the_bit() {
    let mut rng = Rng::new(23);
    for k in 0..12 {
        let structure = any_structure::<f64>(&mut rng, 3, k % 2 == 0);
        let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
        let image = masses.map(|[mu, e, d, offset, y, w]| [mu, e, d, -offset, -y, -w]);
        let [q, v]: [[f64; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| rng.range(-1.0, 1.0)));
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
            if plain { impacts_of::<f64>(&mut rng, &masses) } else { impacts_of::<Twofold>(&mut rng, &masses) }
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
    let tally = iva_core::simulate::simulate(&system, &start, &limits, None, &mut ()).unwrap();
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
        let mut structure = ModalStructure::new(
            &(1..=20).map(f64::from).collect::<Vec<_>>(),
            &[0.01; 20],
        )
        .unwrap();
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
        let tally =
            iva_core::simulate::simulate(&system, &start, &limits(40.0), None, &mut ()).unwrap();
        let took = begin.elapsed().as_secs_f64() * 1e6;
        let (impacts, work) = (tally.impacts as f64, tally.work as f64);
        println!(
            "full {full}: {impacts} impacts, {} episodes, {work} segments, {:.0} µs an impact, {:.1} µs a segment",
            tally.episodes, took / impacts, took / work
        );
        assert_eq!(tally.outcome, Outcome::Finished);
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
    let matrices = |m: &[f64], k: &[f64], c: &[f64]| said(ModalStructure::from_matrices(&names, m, k, c));
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
    assert!(error.contains("absorber.1.point = b: give one of the points a"), "{error}");
    let system = Modal::new(there, [(mass, "a")]).unwrap();
    let error = system.under(push(0.1, 1.0, Acts::Base), "a").unwrap_err().to_string();
    assert!(error.contains("participation"), "{error}");
    let outside = ModalStart::new(&[1.0], &[], gaps(&[[0.1, 0.5, 0.4, 0.0, 0.5, 0.0]])).unwrap();
    let error = system.check_start(&outside).unwrap_err().to_string();
    assert!(error.contains("start.absorber.1.gap_displacement"), "{error}");
}
