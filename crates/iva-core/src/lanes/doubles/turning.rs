//! The extremum of a function of the motion within a stretch.

use super::motion::{State, Structure};
use super::responses::Tables;
use super::step::about;
use crate::host::turning::turn;
use crate::lanes::pick;
use crate::quintic::root_by;

/// A function of the state of a structure with its first five derivatives.
pub(super) type Jets = [f64; 6];

/// An extremum: the value there, and whether it is exact to rounding.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turned {
    pub value: f64,
    pub exact: bool,
}

/// The extremum of a function in a stretch of this length in which its first derivative changes sign; `sixth`
/// bounds its sixth derivative. Without such a change of sign the result is meaningless.
#[inline(always)]
pub(super) fn turned<const W: usize, const DRIVE: u8>(
    (structure, tables, i): (&Structure, &Tables<W>, usize),
    state: &State,
    (begin, end): (&Jets, &Jets),
    jets: impl Fn(&State) -> Jets,
    (sixth, length): (f64, f64),
) -> Turned {
    // In units of the rates at both ends, which keeps quotients in single precision in range.
    let over = 1.0 / (begin[1].abs() + end[1].abs());
    let rates = |at: &Jets| [at[1] * over, at[2] * over, at[3] * over];
    let quintic = turn(rates(begin), rates(end), length);
    let guess = length * root_by(&quintic, about);
    let guess = pick((guess > 0.0) & (guess < length), guess, 0.5 * length);
    let there = state.after::<W, DRIVE>(structure, tables, i, guess);
    let [value, rate, bend, third, fourth, fifth] = jets(&there);
    let (third, fourth, fifth) = (third * 0.5, fourth * (1.0 / 6.0), fifth * (1.0 / 24.0));
    let mut t = -about(rate * over, bend * over);
    for _ in 0..2 {
        let speed = fifth.mul_add(t, fourth).mul_add(t, third).mul_add(t, bend).mul_add(t, rate);
        let slope = (fifth * 4.0).mul_add(t, fourth * 3.0).mul_add(t, third * 2.0).mul_add(t, bend);
        t -= about(speed * over, slope * over);
    }
    let h = guess + t;
    let rise = (fifth * 0.2).mul_add(t, fourth * 0.25).mul_add(t, third * (1.0 / 3.0));
    let value = rise.mul_add(t, bend * 0.5).mul_add(t, rate).mul_add(t, value);
    // Compares the next term of the series with rounding.
    let square = t * t;
    let left_out = sixth * ((square * square) * (t.abs() * (1.0 / 120.0)));
    let close = left_out <= f64::EPSILON * (bend.abs() * h);
    let exact = close & (h > 0.0) & (h < length) & (bend != 0.0);
    Turned { value, exact }
}
