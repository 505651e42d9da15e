//! The polynomials of a flight under one harmonic force, in powers of t = h/longest.

use crate::absorber::plain::responses::{Responses, TERMS};
use crate::absorber::plain::{BASE, State, Structure};
use crate::number::series::unrolled;
use crate::segment::flight::Quantity;

/// The order of the polynomial of ẋ: a sum of P, Q, C, B and a linear function ([`crate::absorber::plain`]).
pub(super) const ORDER: usize = TERMS + 3;

/// A polynomial of ẋ.
pub(super) type Velocity = [f64; ORDER + 1];

/// The polynomial of ẋ: the sum of ẋ + ẍ h and of P, Q, C and B with coefficients from the state at the begin.
#[inline(always)]
pub(super) fn velocity(structure: &Structure, responses: &Responses, state: &State) -> Velocity {
    let &Responses { longest, terms, .. } = responses;
    let Structure { damping, frequency, .. } = *structure;
    let (rapid, square) = (frequency * frequency, longest * longest);
    let [cube, fourth] = [square * longest, square * square];
    let a = state.v.mul_add(-damping, state.force - state.x);
    let (k, j) = (rapid * state.force, frequency * state.quadrature);
    let (p, q) = (a.mul_add(-damping, -(state.v + j)) * square, a * cube);
    let (c, b) = (-(j * rapid) * fourth, -k * cube);
    let mut course = [0.0; ORDER + 1];
    (course[0], course[1]) = (state.v, a * longest);
    unrolled!(k < TERMS + 2 => {
        let mut sum = 0.0;
        if k < TERMS {
            sum = p * terms[0][k];
        }
        if k > 0 && k <= TERMS {
            sum = q.mul_add(terms[1][k - 1], sum);
            sum = b.mul_add(terms[3][k - 1], sum);
        }
        if k > 1 {
            sum = c.mul_add(terms[2][k - 2], sum);
        }
        course[k + 2] = sum;
    });
    course
}

/// The polynomial of x: the integral of that of ẋ.
#[inline(always)]
pub(super) fn displacement(x: f64, velocity: &Velocity, longest: f64) -> [f64; ORDER + 2] {
    let mut course = [0.0; ORDER + 2];
    course[0] = x;
    unrolled!(k < ORDER + 1 => {
        course[k + 1] = velocity[k] * (longest * (1.0 / (k + 1) as f64));
    });
    course
}

/// The polynomial of a quantity.
#[inline(always)]
pub(super) fn course<const DRIVE: u8>(
    of: Quantity,
    structure: &Structure,
    responses: &Responses,
    state: &State,
) -> [f64; ORDER + 2] {
    let velocity = velocity(structure, responses, state);
    let place = displacement(state.x, &velocity, structure.longest);
    if of == Quantity::Displacement {
        return place;
    }
    let mut acceleration = [0.0; ORDER + 2];
    if DRIVE == BASE {
        // ẍ + a_g = −x − 2ζẋ.
        for (sum, x) in acceleration.iter_mut().zip(place) {
            *sum = -x;
        }
        for (sum, v) in acceleration.iter_mut().zip(velocity) {
            *sum = v.mul_add(-structure.damping, *sum);
        }
    } else {
        for (k, sum) in acceleration.iter_mut().enumerate().take(ORDER) {
            *sum = velocity[k + 1] * ((k + 1) as f64 * structure.over_longest);
        }
    }
    acceleration
}
