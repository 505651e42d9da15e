//! Pendulums on structures with modes, on points that move level or aslant, with friction in the pivot of one, beside masses that rub, are tied to their points or weigh.
//!
//! Numbers come from a structure that moves as one given in two ways, from the ledger of energies, from runs in numbers of twice the precision, and from
//! differences of these.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{FewModes, Modal, ModalStart, ModalStructure},
    compensated::DoubleDouble,
    flight::GapPoint,
    force::{Acts, Force},
    host::UndrivenHost,
    observe::Events,
    piva::{Given, Parameters},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
    siva::FreeMass,
};
use iva_tests::covered::Covered;
use iva_tests::modal::{
    Mass, POINTS, any_mass, any_start, any_structure, built, furthest, limits, push, reals, rows,
    ties,
};
use iva_tests::rng::Rng;
use iva_tests::some;

/// How a member hangs that has its gap: L and b over the widest place of the gap, r, κ, ζp and σ.
fn hanging<R: Real>(rng: &mut Rng, [_, _, d, offset, ..]: Mass) -> Parameters<R> {
    let widest = d + offset.abs();
    let length = widest * rng.range(1.2, 4.0);
    Parameters {
        frequency_ratio: R::from(rng.range(0.3, 1.4)),
        inertia_ratio: R::from(rng.range(1.0, 1.4)),
        contact_distance: R::from(widest * rng.range(1.2, 3.0)),
        pivot_damping_ratio: R::from(rng.pick(&[0.0, 0.05])),
        spring_ratio: R::from(rng.pick(&[0.0, 0.6])),
        ..Parameters::point_bob(R::ONE, R::ONE, R::ONE, R::ZERO, R::from(length))
    }
}

/// The system of a seed: two pendulums, a mass with a spring and a dashpot and one that rubs, on lines that may rise.
type System<R> = Modal<UndrivenHost<R>, 4>;
type Begin<R> = ModalStart<R, 4>;

fn scene<R: Real>(seed: u64) -> (System<R>, Begin<R>, Option<Force<R>>) {
    let mut rng = Rng::new(5100 + seed);
    let masses: [Mass; 4] = std::array::from_fn(|_| any_mass(&mut rng));
    let pendulums = [0, 1].map(|k| Some(hanging(&mut rng, masses[k])));
    let mut any = || rng.log_range(1e-3, 0.1);
    let tied = [[0.0; 2], [0.0; 2], [any(), any()], [0.0; 2]];
    let rubs = [0.0, if seed % 4 < 2 { any() } else { 0.0 }, 0.0, any()];
    let rises = if seed.is_multiple_of(2) { [0.0, 0.0, any(), any()] } else { [0.0; 4] };
    let structure = any_structure::<R>(&mut rng, 3, seed.is_multiple_of(3));
    let at: [_; 4] = std::array::from_fn(|k| (built::<R>(masses[k]), POINTS[k]));
    let start = any_start::<R, 4>(&mut rng, 3, &masses);
    let system = System::new(structure, at).unwrap();
    let [one, other] = pendulums;
    let system = system.with_pendulums(&[one, other, None, None]).unwrap();
    let steep = if seed % 5 < 3 { [rng.range(0.0, 1.5), rng.pick(&[0.0, 1.5])] } else { [0.0; 2] };
    let steep = [steep[0], steep[1], 0.0, 0.0].map(|angle| DoubleDouble::new(R::from(angle)));
    let system = system.with_rising_pivots(&steep).unwrap();
    let system = system.with_ties(&ties(&tied)).unwrap().with_gravity(&reals(&rises)).unwrap();
    let system = system.with_friction(&reals(&rubs)).unwrap();
    let acts = [None, Some(Acts::Primary), Some(Acts::Base)][seed as usize % 3];
    (system, start, acts.map(|acts| push(0.4, 0.9, acts)))
}

fn ran<R: Real>(seed: u64, duration: f64) -> Events<R> {
    let (system, start, force) = scene::<R>(seed);
    let (mut events, limits) = (Events::default(), limits::<R>(duration));
    match force {
        None => simulate(&system, &start, &limits, None, &mut events).map(|_| ()).unwrap(),
        Some(force) => {
            let driven = system.under(force, POINTS[1]).unwrap();
            simulate(&driven, &start, &limits, None, &mut events).map(|_| ()).unwrap();
        }
    }
    events
}

/// What is lost in impacts, in the structure, in dashpots and pivots and by friction, and what is left of the ledger.
fn energies<S, R: Real>(run: &Run<S, R>) -> [f64; 5] {
    assert_eq!(run.tally.outcome, Outcome::Finished);
    let measures = &run.measures;
    let all = [
        run.tally.energy_impacts,
        measures.energy_viscous,
        measures.energy_pivot,
        measures.energy_friction,
        measures.energy_residual,
    ];
    all.map(Real::double)
}

fn lost<R: Real>(seed: u64) -> ([f64; 5], [usize; 2]) {
    let (system, start, force) = scene::<R>(seed);
    let limits = limits::<R>(20.0);
    let counted = |impacts: usize, episodes: usize| [impacts, episodes];
    match force {
        None => {
            let run = run(&system, &start, &limits).unwrap();
            (energies(&run), counted(run.impacts.len(), run.episodes.len()))
        }
        Some(force) => {
            let run = run(&system.under(force, POINTS[1]).unwrap(), &start, &limits).unwrap();
            (energies(&run), counted(run.impacts.len(), run.episodes.len()))
        }
    }
}

/// The ledger closes, to all digits of either numbers.
#[test]
fn ledgers_close() {
    let mut counted = [0; 2];
    for seed in 0..some(36) as u64 {
        let ([struck, viscous, swung, rubbed, residual], more) = lost::<f64>(seed);
        assert!(swung > 0.0 && rubbed > 0.0, "{seed}");
        let most = struck + viscous + swung + rubbed;
        assert!(residual.abs() < 1e-13 * most, "{seed}: {residual:e} of {most}");
        counted = [counted[0] + more[0], counted[1] + more[1]];
        if seed < 6 {
            let ([.., residual], _) = lost::<Twofold>(seed);
            // The quadrature of the losses leaves out 10⁻²⁰ of them.
            assert!(residual.abs() < 1e-20, "{seed}: {residual:e}");
        }
    }
    assert!(counted[0] > some(800) && counted[1] > some(15), "{counted:?}");
}

/// Doubles against twice the precision: the first impacts, which conditioning has not yet spread; and the errors as they are estimated.
#[test]
fn doubles_agree_with_twice_the_precision() {
    let (mut covered, mut worst, mut compared) = (Covered::default(), 0.0_f64, 0);
    for seed in 0..some(150) as u64 {
        let (plain, exact) = (ran::<f64>(seed, 9.0), ran::<Twofold>(seed, 9.0));
        let few = plain.impacts.len().min(exact.impacts.len()).min(6);
        let first = [rows(&plain.impacts[..few]), rows(&exact.impacts[..few])];
        worst = worst.max(furthest(&first[0], &first[1]));
        compared += few;
        let (system, start, force) = scene::<f64>(seed);
        let mut errors = Errors::default();
        match force {
            None => {
                simulate(&system, &start, &limits(9.0), None, &mut errors).unwrap();
            }
            Some(force) => {
                let driven = system.under(force, POINTS[1]).unwrap();
                simulate(&driven, &start, &limits(9.0), None, &mut errors).unwrap();
            }
        }
        covered.count(&plain.impacts, &exact.impacts, &errors);
    }
    assert!(worst < 1e-12 && compared > some(600), "{worst:e} {compared}");
    covered.holds(some(1500));
}

/// A structure of one mode with φ = 1 at one point and 2 at another: a pendulum at the second is one of a quarter of L, b, d and κL's gravity at the first, by
/// similarity of all that moves there, with four times its mass.
#[test]
fn a_point_that_moves_twice_as_far_is_a_larger_scale() {
    let mut rng = Rng::new(91);
    let mut impacts = 0;
    for _ in 0..12 {
        let [mu, e, d] = [rng.log_range(0.02, 0.3), rng.range(0.1, 0.9), rng.range(0.2, 1.0)];
        let structure = ModalStructure::new(&[Twofold::ONE], &[Twofold::from(0.02)]).unwrap();
        let shape = |phi: f64| [Twofold::from(phi)];
        let structure = structure.with_point("a", &shape(1.0)).unwrap();
        let structure = structure.with_point("b", &shape(2.0)).unwrap();
        let length = d * rng.range(1.5, 4.0);
        let ratio = rng.range(0.3, 1.2);
        let pendulum = |length: f64| Parameters::<Twofold> {
            frequency_ratio: ratio.into(),
            ..Parameters::point_bob(
                Twofold::ONE,
                Twofold::ONE,
                Twofold::ONE,
                Twofold::ZERO,
                length.into(),
            )
        };
        let of = |mu: f64, size: f64, point: &str| {
            let [d, length] = [size * d, size * length];
            let mass = FreeMass::new(mu.into(), e.into(), d.into()).unwrap();
            let system = Modal::<_, 1>::new(structure.clone(), [(mass, point)]).unwrap();
            let system = system.with_pendulums(&[Some(pendulum(length))]).unwrap();
            let rest = [GapPoint { y: Twofold::ZERO, w: Twofold::ZERO }];
            let start = ModalStart::new(&[Twofold::from(1.3)], &[Twofold::ZERO], rest).unwrap();
            run(&system, &start, &Limits::new(15.0.into(), d.into())).unwrap()
        };
        let (one, other) = (of(4.0 * mu, 1.0, "a"), of(mu, 2.0, "b"));
        assert_eq!(one.impacts.len(), other.impacts.len());
        for (a, b) in one.impacts.iter().zip(&other.impacts) {
            let off = f64::from(a.time - b.time).abs();
            assert!(off < 1e-20, "{off:e}");
        }
        impacts += one.impacts.len();
    }
    assert!(impacts > 60, "{impacts}");
}

/// With an offset of its gap a pendulum between stops at o ± d is the one that swings about that place where gravity does not act: at small angles on no
/// spring.
#[test]
fn an_offset_moves_the_stops() {
    let structure = ModalStructure::<f64>::moving_as_one(0.01).unwrap();
    let floating = Parameters {
        frequency_ratio: 0.0,
        angles: iva_core::piva::Angles::Small,
        inertia_ratio: 1.2,
        ..Parameters::point_bob(0.1, 0.5, 0.4, 0.0, 3.0)
    };
    let with = |offset: f64| {
        let mass = FreeMass::new(0.1, 0.5, 0.4).unwrap().with_offset(offset).unwrap();
        let system = FewModes::with_room(structure.clone(), &[(mass, "primary")]).unwrap();
        let system = system.with_pendulums(&[Some(floating)]).unwrap();
        let mut gaps = [GapPoint { y: 0.0, w: 0.0 }; 4];
        gaps[0].y = offset;
        let start = ModalStart::new(&[1.0], &[], gaps).unwrap();
        run(&system, &start, &limits(30.0)).unwrap()
    };
    let (middle, moved) = (with(0.0), with(0.15));
    assert!(middle.impacts.len() > 8 && middle.impacts.len() == moved.impacts.len());
    for (a, b) in middle.impacts.iter().zip(&moved.impacts).take(8) {
        assert!((a.time - b.time).abs() < 1e-12 && a.wall == b.wall);
    }
}

/// Angles of a start become places in the gap, and those beyond the stops are refused.
#[test]
fn a_start_by_its_angle_is_one_by_its_gap() {
    let bob = Parameters::point_bob(0.1, 0.5, 0.4, 0.0, 2.0);
    let gap = FreeMass::new(0.1, 0.5, 0.4).unwrap().with_offset(0.05).unwrap();
    let GapPoint { y, w } = bob.gap(Given::Angle(0.1), Given::Angle(0.3), &gap).unwrap();
    assert!((y - 2.0 * 0.1_f64.sin()).abs() < 1e-15 && (w - 0.6 * 0.1_f64.cos()).abs() < 1e-15);
    let stop = (0.45_f64 / 2.0).asin();
    assert!(bob.gap(Given::Angle(stop - 1e-9), Given::Gap(0.0), &gap).is_ok());
    for angle in [stop + 1e-9, -0.2, f64::NAN, 3.0] {
        let error = bob.gap(Given::Angle(angle), Given::Gap(0.0), &gap).unwrap_err();
        assert_eq!(error.field, "start.angle");
    }
}
