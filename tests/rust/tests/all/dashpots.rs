//! Free masses with a dashpot in their gap.
//!
//! Numbers come from a closed form (a mass in a wide gap slows down by e^(−cτ/μ)), from masses without dashpot, from the
//! ledger of energies, and from twice the precision.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    flight::GapPoint,
    force::Acts,
    host::UndrivenHost,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome},
    siva::FreeMass,
};
use iva_tests::modal::{
    Mass, POINTS, Row, any_mass, any_start, any_structure, built, furthest, instants, push, reals,
    rows,
};
use iva_tests::rng::Rng;

/// One mass μ with e and d on one mode of damping ratio ζ, and the dashpot c.
fn system<R: Real>([mu, e, d, zeta, c]: [f64; 5]) -> Modal<UndrivenHost<R>, 1> {
    let n = R::from;
    let structure = ModalStructure::new(&[n(1.0)], &[n(zeta)]).unwrap();
    let structure = structure.with_point("top", &[n(1.0)]).unwrap();
    let structure = structure.with_base(&[n(1.0)]).unwrap();
    let mass = FreeMass::new(n(mu), n(e), n(d)).unwrap();
    Modal::new(structure, [(mass, "top")]).unwrap().with_dashpots(&[n(c)]).unwrap()
}

fn start<R: Real>([x, v, y, w]: [f64; 4]) -> ModalStart<R, 1> {
    let n = R::from;
    ModalStart::new(&[n(x)], &[n(v)], [GapPoint { y: n(y), w: n(w) }]).unwrap()
}

/// Far from its walls a mass on a heavy structure at rest slows down as w₀ e^(−cτ/μ), Stokes's law.
#[test]
fn a_slow_mass_creeps_through_its_gap() {
    let [mu, c, w] = [1e-12, 0.2e-12, 0.3];
    let system = system::<f64>([mu, 0.5, 5.0, 0.0, c]);
    let found = run(&system, &start([0.0, 0.0, -1.0, w]), &limits(8.0)).unwrap();
    let at = system.gaps(&found.tally.state)[0];
    let rate = c / mu;
    let speed = w * (-rate * 8.0_f64).exp();
    let way = (w - speed) / rate - 1.0;
    // The structure of mass 10¹² moves by as little.
    assert!((at.w - speed).abs() < 1e-11, "{} {speed}", at.w);
    assert!((at.y - way).abs() < 1e-11, "{} {way}", at.y);
}

fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(R::from(duration), R::from(0.3))
}

/// What a run has come to.
struct Told {
    impacts: Vec<Row>,
    episodes: usize,
    /// Lost in impacts, dampers of the structure and dashpots, and what is left of the ledger.
    energies: [f64; 4],
}

/// Three masses on three modes, of which the last two have a dashpot: in free decay, under a force, or on a moving base.
fn mixed<R: Real>(seed: u64) -> Told {
    let mut rng = Rng::new(900 + seed);
    let dashpots = [0.0, rng.log_range(1e-3, 0.1), rng.log_range(1e-3, 0.1)];
    let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
    let full = rng.unit() > 0.5;
    let structure = any_structure::<R>(&mut rng, 3, full);
    let at: [_; 3] = std::array::from_fn(|k| (built::<R>(masses[k]), POINTS[k]));
    let start = any_start::<R, 3>(&mut rng, 3, &masses);
    let system = Modal::new(structure, at).unwrap().with_dashpots(&reals(&dashpots)).unwrap();
    let acts = [None, Some(Acts::Primary), Some(Acts::Base)][seed as usize % 3];
    match acts {
        None => told(&run(&system, &start, &limits(20.0)).unwrap()),
        Some(acts) => {
            let driven = system.under(push(0.4, 0.9, acts), POINTS[1]).unwrap();
            told(&run(&driven, &start, &limits(20.0)).unwrap())
        }
    }
}

fn told<S, R: Real>(run: &Run<S, R>) -> Told {
    assert_eq!(run.tally.outcome, Outcome::Finished);
    let measures = &run.measures;
    let energies = [
        run.tally.energy_impacts,
        measures.energy_viscous,
        measures.energy_pivot,
        measures.energy_residual,
    ];
    let energies = energies.map(Real::double);
    Told { impacts: rows(&run.impacts), episodes: run.episodes.len(), energies }
}

/// The ledger closes, and doubles agree with twice the precision over few impacts.
#[test]
fn ledgers_close_and_doubles_agree_with_twice_the_precision() {
    let ([mut impacts, mut episodes], mut worst) = ([0, 0], 0.0_f64);
    for seed in 0..24 {
        let (plain, exact) = (mixed::<f64>(seed), mixed::<Twofold>(seed));
        let [struck, viscous, dashpots, residual] = plain.energies;
        assert!(dashpots > 0.0 && viscous > 0.0, "{seed}");
        assert!(residual.abs() < 1e-13 * (struck + viscous + dashpots), "{seed}: {residual:e}");
        assert!(exact.energies[3].abs() < 1e-25, "{seed}: {:e}", exact.energies[3]);
        for (a, b) in plain.impacts.iter().zip(&exact.impacts).take(8) {
            assert_eq!(a.0, b.0, "{seed}");
            worst = worst.max((a.1[0] - b.1[0]).abs());
        }
        impacts += plain.impacts.len();
        episodes += plain.episodes;
    }
    println!("{impacts} impacts, {episodes} episodes, {worst:e}");
    assert!(worst < 1e-12 && impacts > 300 && episodes > 20, "{worst:e} {impacts} {episodes}");
}

/// A dashpot of 10⁻³⁰ changes nothing that is not rounding, though its mass is a coordinate of the structure then.
#[test]
fn a_vanishing_dashpot_changes_nothing() {
    let mut rng = Rng::new(47);
    let [mut impacts, mut episodes] = [0, 0];
    for round in 0..20 {
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let structure = any_structure::<Twofold>(&mut rng, 3, round % 2 == 0);
        let at = std::array::from_fn(|k| (built::<Twofold>(masses[k]), POINTS[k]));
        let start = any_start::<Twofold, 2>(&mut rng, 3, &masses);
        let bare = Modal::new(structure, at).unwrap();
        let with = bare.clone().with_dashpots(&reals(&[1e-30, 1e-30])).unwrap();
        let acts = if round % 4 < 2 { Acts::Primary } else { Acts::Base };
        let of = |system: Modal<UndrivenHost<Twofold>, 2>| {
            let system = system.under(push(0.4, 0.9, acts), POINTS[3]).unwrap();
            run(&system, &start, &limits(12.0)).unwrap()
        };
        let [one, other] = [of(bare), of(with)];
        assert_eq!(one.episodes.len(), other.episodes.len(), "{round}");
        let off = furthest(&rows(&one.impacts), &rows(&other.impacts));
        assert!(off < 1e-15, "{round}: {off:e}");
        let sticks = |run: &Run<_, Twofold>| instants(run);
        for (a, b) in sticks(&one).iter().zip(&sticks(&other)) {
            assert!((a - b).abs() < 1e-13, "{round}: {a} {b}");
        }
        impacts += one.impacts.len();
        episodes += one.episodes.len();
    }
    println!("{impacts} impacts, {episodes} episodes");
    assert!(impacts > 200 && episodes > 10, "{impacts} {episodes}");
}

/// No dashpot is the structure without, to the bit; what is out of range is told.
#[test]
fn none_is_none_and_wrong_ones_are_refused() {
    let numbers = [0.1, 0.6, 0.4, 0.01, 0.0];
    let found = run(&system::<f64>(numbers), &start([1.0, 0.0, 0.0, 0.0]), &limits(20.0)).unwrap();
    assert!(!found.impacts.is_empty() && found.measures.energy_pivot == 0.0);
    let refused =
        |dashpots: &[f64]| system::<f64>(numbers).with_dashpots(dashpots).unwrap_err().to_string();
    assert_eq!(refused(&[-1.0]), "absorber.0.gap_damping = -1: give 0 or more");
    assert_eq!(refused(&[]), "absorber.gap_damping = 0 numbers: give 1");
}
