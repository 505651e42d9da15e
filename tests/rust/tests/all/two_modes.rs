//! A host outside the core, in one file (`iva_tests::two_modes`): the engine runs it as it is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iva_core::{
    absorber::Start,
    run::run,
    simulate::{Limits, Outcome},
    siva::Siva,
};
use iva_tests::two_modes::TwoModes;

const HOST: TwoModes = TwoModes {
    frequencies: [1.0, 2.7],
    damping_ratios: [0.02, 0.03],
    shapes: [1.0, 0.6],
    absorber: [0.1, 0.7, 0.4],
};

/// The impacts were found by SciPy's DOP853, and their instants then solved to 30 digits (`tests/reference/two_modes.py`).
/// Errors of one rounding grow to some 10⁻¹² on the way.
#[test]
fn its_impacts_are_those_of_the_reference() {
    let text = include_str!("../../../reference/two_modes.json");
    let expected: Vec<[f64; 4]> = serde_json::from_str(text).unwrap();
    let found = run(&HOST, &[1.0, -0.3], &Limits::new(44.0, 0.4)).unwrap();
    assert_eq!(found.tally.outcome, Outcome::Finished);
    assert_eq!(found.impacts.len(), expected.len());
    for (impact, [time, wall, x, approach]) in found.impacts.iter().zip(expected) {
        let off = [impact.time - time, impact.displacement - x, impact.approach_speed() - approach];
        assert!(off.iter().all(|off| off.abs() < 1e-11), "{time}: {off:?}");
        assert_eq!(impact.wall.sign(), wall);
    }
    let m = found.measures;
    assert!(m.energy_residual.abs() < 1e-11 * m.energy_initial, "{:e}", m.energy_residual);
}

/// With one mode it is the host of the core: with chatter, stick episodes and releases.
#[test]
fn with_one_mode_it_is_the_structure_of_the_core() {
    let (mu, zeta, d) = (0.1, 0.02, 0.3);
    for e in [0.0, 0.3, 0.9] {
        let single = TwoModes { shapes: [1.0, 0.0], absorber: [mu, e, d], ..HOST };
        let limits = Limits::new(30.0, d);
        let found = run(&single, &[1.0, 0.0], &limits).unwrap();
        let siva = Siva::new(mu, e, d, zeta).unwrap();
        let start = Start { displacement: 1.0, ..Start::default() };
        let expected = run(&siva, &start, &limits).unwrap();
        assert_eq!(found.episodes.len(), expected.episodes.len(), "{e}");
        assert!(!found.episodes.is_empty() || e > 0.5, "{e}");
        assert_eq!(found.impacts.len(), expected.impacts.len());
        assert!(found.impacts.len() > 5, "{e}");
        for (a, b) in found.impacts.iter().zip(&expected.impacts) {
            assert!((a.time - b.time).abs() < 1e-10, "{e}: {} {}", a.time, b.time);
            assert_eq!(a.wall, b.wall);
        }
        for (a, b) in found.episodes.iter().zip(&expected.episodes) {
            assert!(
                (a.start_time - b.start_time).abs() < 1e-10
                    && (a.stick_time - b.stick_time).abs() < 1e-8
            );
        }
    }
}
