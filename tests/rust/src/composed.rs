//! Composed scenes of up to four members: their ledgers, and doubles beside numbers of twice the precision.

use iva_core::{
    absorber::modal::{Modal, ModalStart},
    force::Force,
    host::{DrivenHost, UndrivenHost},
    observe::{Events, Observer},
    propagation::Errors,
    real::{Real, twofold::Twofold},
    run::{Run, run},
    simulate::{Limits, Outcome, simulate},
};

use crate::covered::Covered;
use crate::modal::{POINTS, furthest, limits, rows};

/// A system, how it begins, and what drives it at the second of [`POINTS`].
pub type Composed<R> = (Modal<UndrivenHost<R>, 4>, ModalStart<R, 4>, Option<Force<R>>);

/// A scene for each seed.
pub trait Scenes {
    /// That of a seed.
    fn scene<R: Real>(seed: u64) -> Composed<R>;
}

fn observed<R, O>((system, start, force): Composed<R>, duration: f64, mut observer: O) -> O
where
    R: Real,
    O: Observer<Modal<UndrivenHost<R>, 4>> + Observer<Modal<DrivenHost<R>, 4>>,
{
    let limits = few::<R>(duration);
    match force {
        None => simulate(&system, &start, &limits, None, &mut observer).map(|_| ()).unwrap(),
        Some(force) => {
            let driven = system.under(force, POINTS[1]).unwrap();
            simulate(&driven, &start, &limits, None, &mut observer).map(|_| ()).unwrap();
        }
    }
    observer
}

/// What is lost in impacts, in the structure, in dashpots and pivots and by friction, what is left of the ledger, and the numbers of impacts and sticks.
type Ledger = ([f64; 5], [usize; 2]);

/// Of so many impacts of a scene errors are compared with their estimates.
const MOST_COUNTED: usize = 40;

/// Members that chatter on each other have more impacts than tests have time.
fn few<R: Real>(duration: f64) -> Limits<R> {
    Limits { max_impacts: 2000, max_work: 3000, ..limits(duration) }
}

fn told<S, R: Real>(run: &Run<S, R>) -> Ledger {
    assert!(matches!(
        run.tally.outcome,
        Outcome::Finished | Outcome::ImpactLimit | Outcome::WorkLimit
    ));
    let measures = &run.measures;
    let all = [
        run.tally.energy_impacts,
        measures.energy_viscous,
        measures.energy_pivot,
        measures.energy_friction,
        measures.energy_residual,
    ];
    (all.map(Real::double), [run.impacts.len(), run.episodes.len()])
}

fn ledger<R: Real>((system, start, force): Composed<R>) -> Ledger {
    let limits = few::<R>(20.0);
    match force {
        None => told(&run(&system, &start, &limits).unwrap()),
        Some(force) => {
            told(&run(&system.under(force, POINTS[1]).unwrap(), &start, &limits).unwrap())
        }
    }
}

/// Checks that the ledgers of so many seeds close to all digits, of the first six in numbers of twice the precision as well. Returns what was lost in all of them.
pub fn ledgers_close<S: Scenes>(seeds: usize) -> Ledger {
    let (mut lost, mut counted) = ([0.0; 5], [0; 2]);
    for seed in 0..seeds as u64 {
        let (all, more) = ledger(S::scene::<f64>(seed));
        let (most, residual) = (all[..4].iter().sum::<f64>(), all[4]);
        assert!(residual.abs() < 1e-13 * most, "{seed}: {residual:e} of {most}");
        lost = std::array::from_fn(|k| lost[k] + all[k]);
        counted = [counted[0] + more[0], counted[1] + more[1]];
        if seed < 6 {
            let ([.., residual], _) = ledger(S::scene::<Twofold>(seed));
            // The quadrature of the losses leaves out 10⁻²⁰ of them.
            assert!(residual.abs() < 1e-20, "{seed}: {residual:e}");
        }
    }
    (lost, counted)
}

/// Checks the first impacts, which conditioning has not yet spread, of so many seeds against runs in numbers of twice the precision, and that more than so many estimates
/// of errors cover them. Returns the number of impacts compared.
pub fn doubles_agree<S: Scenes>(seeds: usize, least: usize) -> usize {
    let (mut covered, mut worst, mut compared) = (Covered::default(), 0.0_f64, 0);
    for seed in 0..seeds as u64 {
        let plain = observed(S::scene::<f64>(seed), 9.0, Events::default());
        let exact = observed(S::scene::<Twofold>(seed), 9.0, Events::default());
        let few = plain.impacts.len().min(exact.impacts.len()).min(6);
        let first = [rows(&plain.impacts[..few]), rows(&exact.impacts[..few])];
        worst = worst.max(furthest(&first[0], &first[1]));
        compared += few;
        let mut errors = observed(S::scene::<f64>(seed), 9.0, Errors::default());
        // No scene counts more than others that have fewer impacts.
        let most = plain.impacts.len().min(MOST_COUNTED);
        errors.impacts.truncate(most);
        covered.count(&plain.impacts[..most], &exact.impacts, &errors);
    }
    assert!(worst < 1e-12, "{worst:e}");
    covered.holds(least);
    compared
}
