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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::absorber::plain::FORCE;
    use crate::force::{Acts, Harmonic};
    use crate::host::oscillator::Equation;
    use crate::segment::taylor::horner;

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from([2, 3, 5, 7, 11, 13, 17, 19][k as usize]).sqrt()).fract()
    }

    /// The largest difference between the polynomials of x and of the acceleration and the states all along flights, over
    /// the size of the motion.
    fn off<const DRIVE: u8>(acts: Acts) -> [f64; 2] {
        let mut worst = [0.0f64; 2];
        for i in 1..2000 {
            let u = |k| spread(i, k);
            let equation = Equation::new(1.0, [0.0, 0.02, 0.3, 1.5][(4.0 * u(0)) as usize]);
            let frequency = 10f64.powf(2.0 * u(1) - 1.0);
            let responses = Responses::new(equation.damping, equation.growth, frequency);
            let harmonic = Harmonic { amplitude: u(2), frequency, phase: 6.0 * u(3), acts };
            let structure = Structure::driven(&equation, &responses, &harmonic);
            let [force, quadrature] = structure.force_at(Default::default());
            let (x, v) = (2.0 * u(4) - 1.0, 2.0 * u(5) - 1.0);
            let from = State { x, v, force, quadrature, side: 1.0, ..State::default() };
            let [place, shaken] = [Quantity::Displacement, Quantity::Acceleration]
                .map(|of| course::<DRIVE>(of, &structure, &responses, &from));
            for part in 0..=16 {
                let t = f64::from(part) / 16.0;
                let there = from.after::<DRIVE>(&structure, &responses, t * structure.longest);
                let [[a, ..], _] = structure.derivatives::<DRIVE>(&there);
                let pairs = [(horner(&place, t), there.x), (horner(&shaken, t), a)];
                for (worst, (found, truth)) in worst.iter_mut().zip(pairs) {
                    *worst = worst.max((found - truth).abs());
                }
            }
        }
        worst
    }

    /// The motion is of size 1, its acceleration up to 6. The reference is independent: the closed form of the state at
    /// an instant, and its derivatives.
    #[test]
    fn courses_pass_through_the_states() {
        for worst in [off::<FORCE>(Acts::Primary), off::<BASE>(Acts::Base)] {
            assert!(worst.iter().all(|worst| *worst < 6e-15), "{worst:?}");
        }
    }
}
