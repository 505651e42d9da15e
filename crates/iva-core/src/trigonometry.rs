//! Sine and cosine to whatever precision a number carries, twice that of doubles at most.

use crate::real::ZERO;
use crate::taylor::Number;

/// Sine and cosine of an angle within [−2π, 2π], from their series at a 64th of it.
pub fn sine_cosine<T: Number>(angle: T) -> (T, T) {
    const HALVINGS: u32 = 6;
    let one = T::reciprocal(1);
    let two = one + one;
    let small = (0..HALVINGS).fold(angle, |angle, _| angle * T::reciprocal(2));
    let square = small * small;
    let (mut versine, mut sine) = (T::from_real(ZERO), T::from_real(ZERO));
    for k in (1..=9).rev() {
        let n = 2 * k;
        versine = ((one - versine) * square) * T::reciprocal(n * (n - 1));
        sine = ((one - sine) * square) * T::reciprocal(n * (n + 1));
    }
    sine = small * (one - sine);
    for _ in 0..HALVINGS {
        // sin 2α = 2 sinα (1 − (1 − cosα)), 1 − cos 2α = 2 sin²α
        let twice = (sine * (one - versine)) * two;
        versine = (sine * sine) * two;
        sine = twice;
    }
    (sine, one - versine)
}
