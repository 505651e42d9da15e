//! Statements about a function between the ends of an interval (`flight::Arc`, `flight::Extreme`), tested on
//! sums of two cosines, whose extremes are found by brute force.

use iva_core::flight::{Arc, Extreme};
use iva_tests::cases;
use proptest::prelude::*;

/// The function a cos(ω t + φ).
#[derive(Debug, Clone, Copy)]
struct Wave {
    size: f64,
    rate: f64,
    phase: f64,
}

impl Wave {
    fn derivative(&self, n: i32, t: f64) -> f64 {
        let turned = self.rate * t + self.phase + f64::from(n) * std::f64::consts::FRAC_PI_2;
        self.size * self.rate.powi(n) * turned.cos()
    }
}

fn wave() -> impl Strategy<Value = Wave> {
    (0.01..1.0f64, 0.2..2.0f64, 0.0..6.3f64).prop_map(|(size, rate, phase)| Wave {
        size,
        rate,
        phase,
    })
}

/// Number of samples of an interval; between two samples these waves change by at most 10⁻⁶.
const SAMPLES: usize = 4000;

proptest! {
    #![proptest_config(cases(400))]

    /// No statement is false, and on short intervals a statement is made.
    #[test]
    fn the_ends_tell_nothing_false(
        waves in (wave(), wave()), from in 0.0..10.0f64, length in 0.05..1.2f64,
    ) {
        let f = |n: i32, t: f64| waves.0.derivative(n, t) + waves.1.derivative(n, t);
        let jet = |t: f64| [f(0, t), f(1, t), f(2, t)];
        let sixth = [waves.0, waves.1].iter().map(|it| it.size * it.rate.powi(6)).sum();
        let arc = Arc::new(jet(from), jet(from + length), sixth, length);
        let at = |k: usize| from + length * k as f64 / SAMPLES as f64;
        let largest = (0..=SAMPLES).map(|k| f(0, at(k)).abs()).fold(0.0, f64::max);
        let rises: Vec<bool> = (0..=SAMPLES).map(|k| f(1, at(k)) > 0.0).collect();
        let turns = rises.windows(2).filter(|pair| pair[0] != pair[1]).count();

        prop_assert!(arc.limit() >= largest, "{} below {largest}", arc.limit());
        // The distance between coefficients and quintic is bounded by its second derivative.
        let bend: f64 = [waves.0, waves.1].iter().map(|it| it.size * it.rate.powi(2)).sum();
        prop_assert!(arc.limit() <= largest + 0.2 * bend * length * length, "{}", arc.limit());
        if arc.is_monotone() {
            prop_assert_eq!(turns, 0);
        }
        if arc.turns_once() {
            prop_assert_eq!(turns, 1);
        }
        if length < 0.3 && turns == 0 {
            let slowest = (0..=SAMPLES).map(|k| f(1, at(k)).abs()).fold(f64::INFINITY, f64::min);
            prop_assert!(arc.is_monotone() || slowest < 0.01);
        }
        if length < 0.3 && turns == 1 {
            let straightest =
                (0..=SAMPLES).map(|k| f(2, at(k)).abs()).fold(f64::INFINITY, f64::min);
            let ends = f(1, from).abs().min(f(1, from + length).abs());
            prop_assert!(arc.turns_once() || straightest < 0.05 || ends < 1e-12);
        }
        // With the value at the extremum the largest size is exact.
        if turns == 1 {
            let turn = (0..SAMPLES).find(|k| rises[*k] != rises[k + 1]).map(at);
            let value = turn.map_or(0.0, |t| f(0, t));
            let extreme = Extreme::new(&arc, true, value);
            let found = extreme.largest(0.0);
            prop_assert!(found.is_some_and(|found| (found - largest).abs() < 1e-6));
            prop_assert_eq!(extreme.largest(2.0 * arc.limit()), Some(2.0 * arc.limit()));
        }
    }
}

#[test]
fn a_rate_of_zero_at_an_end_and_numbers_that_are_none_leave_it_open() {
    // cos t from its maximum on: the derivative neither changes sign nor keeps one.
    let jet = |t: f64| [t.cos(), -t.sin(), -t.cos()];
    let arc = Arc::new(jet(0.0), jet(0.5), 1.0, 0.5);
    assert!(!arc.is_monotone() && !arc.turns_once());
    assert_eq!(Extreme::new(&arc, false, 0.0).largest(0.5), None);
    for sixth in [f64::INFINITY, f64::NAN] {
        let arc = Arc::new(jet(0.1), jet(0.5), sixth, 0.4);
        assert!(!arc.is_monotone() && !arc.turns_once());
        assert_eq!(Extreme::new(&arc, false, 0.0).largest(10.0), None);
    }
}
