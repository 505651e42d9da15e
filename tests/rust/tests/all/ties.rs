//! Free masses with a spring or a dashpot in their gap, on lines of motion that may rise.
//!
//! Numbers come from closed forms (in a wide gap a mass slows down by e^(−cτ/μ), swings with √(k/μ), and falls by G τ²/2), from masses
//! without ties and on one mode, from the ledger of energies, and from twice the precision.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::modal::{Modal, ModalStart, ModalStructure},
    absorber::{OnStructure as _, Start},
    flight::GapPoint,
    force::{Acts, Force},
    host::UndrivenHost,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome},
    siva::{FreeMass, Siva},
};
use iva_tests::modal::{
    Mass, POINTS, Row, any_mass, any_start, any_structure, built, furthest, instants, push, reals,
    rows, ties,
};
use iva_tests::rng::Rng;

/// One mass μ with e and d on one mode of damping ratio ζ, with a spring k and a dashpot c.
fn system<R: Real>([mu, e, d, zeta, k, c]: [f64; 6]) -> Modal<UndrivenHost<R>, 1> {
    let n = R::from;
    let structure = ModalStructure::new(&[n(1.0)], &[n(zeta)]).unwrap();
    let structure = structure.with_point("top", &[n(1.0)]).unwrap();
    let structure = structure.with_base(&[n(1.0)]).unwrap();
    let mass = FreeMass::new(n(mu), n(e), n(d)).unwrap();
    Modal::new(structure, [(mass, "top")]).unwrap().with_ties(&ties(&[[k, c]])).unwrap()
}

fn start<R: Real>([x, v, y, w]: [f64; 4]) -> ModalStart<R, 1> {
    let n = R::from;
    ModalStart::new(&[n(x)], &[n(v)], [GapPoint { y: n(y), w: n(w) }]).unwrap()
}

/// Far from its walls a mass on a heavy structure at rest slows down as w₀ e^(−cτ/μ), Stokes's law.
#[test]
fn a_slow_mass_creeps_through_its_gap() {
    let [mu, c, w] = [1e-12, 0.2e-12, 0.3];
    let system = system::<f64>([mu, 0.5, 5.0, 0.0, 0.0, c]);
    let found = run(&system, &start([0.0, 0.0, -1.0, w]), &limits(8.0)).unwrap();
    let at = system.gaps(&found.tally.state)[0];
    let rate = c / mu;
    let speed = w * (-rate * 8.0_f64).exp();
    let way = (w - speed) / rate - 1.0;
    // The structure of mass 10¹² moves by as little.
    assert!((at.w - speed).abs() < 1e-11, "{} {speed}", at.w);
    assert!((at.y - way).abs() < 1e-11, "{} {way}", at.y);
}

/// In a wide gap over a heavy structure at rest a mass on a spring swings with √(k/μ) about where it hangs, y = −μG/k, and one
/// without a spring falls.
#[test]
fn a_mass_swings_on_its_spring_and_falls_without() {
    let [mu, k, gravity, duration] = [1e-12_f64, 0.49e-12, 0.02, 9.0];
    let begin = start([0.0, 0.0, -0.5, 0.3]);
    let with = |k: f64| {
        let system = system::<f64>([mu, 0.5, 5.0, 0.0, k, 0.0]);
        let system = system.with_gravity(&[gravity]).unwrap();
        let found = run(&system, &begin, &limits(duration)).unwrap();
        assert!(found.impacts.is_empty());
        let residual = found.measures.energy_residual.abs();
        assert!(residual < 1e-15 * system.energy(&found.tally.state), "{residual:e}");
        system.gaps(&found.tally.state)[0]
    };
    let (swung, omega) = (with(k), (k / mu).sqrt());
    let (sine, cosine) = (omega * duration).sin_cos();
    let hanging = -gravity / (omega * omega);
    let y = hanging + (-0.5 - hanging) * cosine + 0.3 / omega * sine;
    let w = -omega * (-0.5 - hanging) * sine + 0.3 * cosine;
    assert!((swung.y - y).abs() < 1e-11 && (swung.w - w).abs() < 1e-11, "{swung:?} {y} {w}");
    let (fallen, way) = (with(0.0), 0.3 * duration - gravity * duration * duration * 0.5 - 0.5);
    assert!((fallen.y - way).abs() < 1e-11, "{fallen:?} {way}");
    assert!((fallen.w - (0.3 - gravity * duration)).abs() < 1e-11, "{fallen:?}");
}

/// On one mode and an inclined line a mass is the one of the equations of one mode, in decays and under forces, with its sticks.
#[test]
fn on_one_mode_gravity_is_that_of_one_mode() {
    let mut rng = Rng::new(74);
    let [mut impacts, mut episodes] = [0, 0];
    for round in 0..24 {
        let [mu, e, d] = [rng.log_range(0.02, 0.4), rng.range(0.1, 0.9), rng.range(0.2, 1.0)];
        let [zeta, gravity] = [rng.range(0.0, 0.05), rng.log_range(0.02, 0.5)];
        let force = match round % 3 {
            0 => Force::default(),
            1 => push(0.3, 0.8, Acts::Primary),
            _ => push(0.3, 0.8, Acts::Base),
        };
        let one = Siva::new(mu, e, d, zeta).unwrap().inclined(gravity, force.clone());
        let begin = Start { displacement: 1.0, gap_displacement: -d, ..Start::default() };
        let one = run(&one, &begin, &limits(15.0)).unwrap();
        let modal = system::<f64>([mu, e, d, zeta, 0.0, 0.0]).with_gravity(&[gravity]).unwrap();
        let begin = start([1.0, 0.0, -d, 0.0]);
        let modal = modal.under(force, "top").unwrap();
        let other = run(&modal, &begin, &limits(15.0)).unwrap();
        let both = one.impacts.iter().zip(&other.impacts);
        let apart: Vec<_> = both.map(|(a, b)| (a.time, a.time - b.time)).collect();
        let counts = [(&one.impacts, &one.episodes), (&other.impacts, &other.episodes)]
            .map(|(impacts, episodes)| (impacts.len(), episodes.len()));
        assert_eq!(counts[0], counts[1], "{round}: {apart:?}");
        let few = one.impacts.len().min(12);
        let off = furthest(&rows(&one.impacts[..few]), &rows(&other.impacts[..few]));
        assert!(off < 1e-12, "{round}: {off:e}");
        let lost = one.measures.energy_viscous - other.measures.energy_viscous;
        assert!(lost.abs() < 1e-11, "{round}: {lost:e}");
        episodes += one.episodes.len();
        impacts += one.impacts.len();
    }
    println!("{impacts} impacts, {episodes} episodes");
    assert!(impacts > 300 && episodes > 10, "{impacts} {episodes}");
}

fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(R::from(duration), R::from(0.3))
}

/// What a run has come to.
struct Told {
    impacts: Vec<Row>,
    episodes: usize,
    /// Lost in impacts, dampers of the structure, dashpots and friction, and what is left of the ledger.
    energies: [f64; 5],
}

/// Three masses on three modes, of which the last two have a dashpot and the last a spring, on lines that rise in every other
/// scene, with friction in every third: in free decay, under a force, or on a moving base.
fn mixed<R: Real>(seed: u64) -> Told {
    let mut rng = Rng::new(900 + seed);
    let mut any = || rng.log_range(1e-3, 0.1);
    let tied = [[0.0, 0.0], [0.0, any()], [any(), any()]];
    let gravity = [0.0, any(), any()].map(|along| if seed.is_multiple_of(2) { along } else { 0.0 });
    let friction = [0.0, any(), any()].map(|rubs| if seed % 3 == 1 { rubs } else { 0.0 });
    let masses: [Mass; 3] = std::array::from_fn(|_| any_mass(&mut rng));
    let full = rng.unit() > 0.5;
    let structure = any_structure::<R>(&mut rng, 3, full);
    let at: [_; 3] = std::array::from_fn(|k| (built::<R>(masses[k]), POINTS[k]));
    let start = any_start::<R, 3>(&mut rng, 3, &masses);
    let system = Modal::new(structure, at).unwrap().with_ties(&ties(&tied)).unwrap();
    let system = system.with_gravity(&reals(&gravity)).unwrap();
    let system = system.with_friction(&reals(&friction)).unwrap();
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
        measures.energy_friction,
        measures.energy_residual,
    ];
    let energies = energies.map(Real::double);
    Told { impacts: rows(&run.impacts), episodes: run.episodes.len(), energies }
}

/// The ledger closes, and doubles agree with twice the precision over few impacts.
#[test]
fn ledgers_close_and_doubles_agree_with_twice_the_precision() {
    let ([mut impacts, mut episodes], mut worst) = ([0, 0], 0.0_f64);
    for seed in 0..30 {
        let (plain, exact) = (mixed::<f64>(seed), mixed::<Twofold>(seed));
        let [struck, viscous, dashpots, rubbed, residual] = plain.energies;
        assert!(dashpots > 0.0 && viscous > 0.0, "{seed}");
        assert!((rubbed > 0.0) == (seed % 3 == 1), "{seed}");
        assert!(
            residual.abs() < 1e-13 * (struck + viscous + dashpots + rubbed),
            "{seed}: {residual:e}"
        );
        assert!(exact.energies[4].abs() < 1e-25, "{seed}: {:e}", exact.energies[4]);
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

/// A spring and a dashpot of 10⁻³⁰ change nothing that is not rounding, though its mass is a coordinate of the structure then.
#[test]
fn vanishing_ties_change_nothing() {
    let mut rng = Rng::new(47);
    let [mut impacts, mut episodes] = [0, 0];
    for round in 0..20 {
        let masses: [Mass; 2] = std::array::from_fn(|_| any_mass(&mut rng));
        let structure = any_structure::<Twofold>(&mut rng, 3, round % 2 == 0);
        let at = std::array::from_fn(|k| (built::<Twofold>(masses[k]), POINTS[k]));
        let start = any_start::<Twofold, 2>(&mut rng, 3, &masses);
        let bare = Modal::new(structure, at).unwrap();
        let with = bare.clone().with_ties(&ties(&[[0.0, 1e-30], [1e-30, 0.0]])).unwrap();
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

/// A mass on a spring that friction holds twice a period settles on an orbit and stays on it for 2,000 periods: what its place in the gap and its
/// coordinate of the structure differ by is rounding, and does not grow.
#[test]
fn a_mass_that_rubs_stays_on_its_orbit() {
    for mu in [1e-9, 1e-3, 0.1] {
        let frequency = 0.8;
        let system = system::<f64>([mu, 0.5, 50.0, 0.05, mu * 1.5625, 0.0]);
        let system = system.with_friction(&[1.18]).unwrap();
        let system = system.under(push(1.0, frequency, Acts::Primary), "top").unwrap();
        let after = |periods: f64| {
            let limits = limits(periods * std::f64::consts::TAU / frequency);
            let found = run(&system, &start([2.7, 0.0, 0.0, 0.3]), &limits).unwrap();
            assert_eq!(found.tally.outcome, Outcome::Finished);
            (system.gaps(&found.tally.state)[0], found.tally.friction)
        };
        let ((early, _), (late, seen)) = (after(200.0), after(2000.0));
        // Of a heavy mass friction slows the structure, so that nothing is held.
        assert!(seen.stops >= 3999 && (mu == 0.1 || seen.holds > 3900), "{seen:?}");
        assert!((early.y - late.y).abs() < 1e-11, "{mu}: {} {}", early.y, late.y);
        assert!((early.w - late.w).abs() < 1e-11, "{mu}: {} {}", early.w, late.w);
    }
}

/// No tie is the structure without, to the bit; what is out of range is told.
#[test]
fn none_is_none_and_wrong_ones_are_refused() {
    let numbers = [0.1, 0.6, 0.4, 0.01, 0.0, 0.0];
    let found = run(&system::<f64>(numbers), &start([1.0, 0.0, 0.0, 0.0]), &limits(20.0)).unwrap();
    assert!(!found.impacts.is_empty() && found.measures.energy_pivot == 0.0);
    let refused =
        |tied: &[[f64; 2]]| system::<f64>(numbers).with_ties(&ties(tied)).unwrap_err().to_string();
    assert_eq!(refused(&[[0.0, -1.0]]), "absorber.0.gap_damping = -1: give 0 or more");
    assert_eq!(refused(&[[-1.0, 0.0]]), "absorber.0.spring = -1: give 0 or more");
    assert_eq!(refused(&[]), "absorber.spring = 0 numbers: give 1");
}
