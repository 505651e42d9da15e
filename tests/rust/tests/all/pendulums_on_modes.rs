//! Pendulums on structures with modes, on points that move level or aslant, with friction in the pivot of one, beside masses that rub, are tied to their points or weigh.
//!
//! Numbers come from a structure that moves as one given in two ways, from the ledger of energies, from runs in numbers of twice the precision, and from
//! differences of these.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{FewModes, Modal, ModalStart, ModalStructure},
    compensated::DoubleDouble,
    flight::GapPoint,
    force::Acts,
    piva::{Given, Parameters},
    real::{Real, twofold::Twofold},
    run::run,
    simulate::Limits,
    siva::FreeMass,
};
use iva_tests::composed::{self, Composed, Scenes};
use iva_tests::modal::{
    Mass, POINTS, any_mass, any_start, any_structure, built, limits, push, reals, ties,
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

/// Two pendulums, a mass with a spring and a dashpot and one that rubs, on lines that may rise.
struct Pendulums;

impl Scenes for Pendulums {
    fn scene<R: Real>(seed: u64) -> Composed<R> {
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
        let system = Modal::new(structure, at).unwrap();
        let [one, other] = pendulums;
        let system = system.with_pendulums(&[one, other, None, None]).unwrap();
        let steep =
            if seed % 5 < 3 { [rng.range(0.0, 1.5), rng.pick(&[0.0, 1.5])] } else { [0.0; 2] };
        let steep = [steep[0], steep[1], 0.0, 0.0].map(|angle| DoubleDouble::new(R::from(angle)));
        let system = system.with_rising_pivots(&steep).unwrap();
        let system = system.with_ties(&ties(&tied)).unwrap().with_gravity(&reals(&rises)).unwrap();
        let system = system.with_friction(&reals(&rubs)).unwrap();
        let acts = [None, Some(Acts::Primary), Some(Acts::Base)][seed as usize % 3];
        (system, start, acts.map(|acts| push(0.4, 0.9, acts)))
    }
}

/// The ledger closes, to all digits of either numbers.
#[test]
fn ledgers_close() {
    let ([_, _, swung, rubbed, _], counted) = composed::ledgers_close::<Pendulums>(some(36));
    assert!(swung > 0.0 && rubbed > 0.0);
    assert!(counted[0] > some(800) && counted[1] > some(15), "{counted:?}");
}

#[test]
fn doubles_agree_with_twice_the_precision() {
    let compared = composed::doubles_agree::<Pendulums>(some(150), some(1500));
    assert!(compared > some(600), "{compared}");
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
