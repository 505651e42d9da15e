//! Losses, work and ∫x² of flights as integrals.
//!
//! The integrals are Gaussian quadratures of the four polynomials that the motion consists of, never
//! differences of energies, so that the energy ledger is an independent check. With [`NODES`] the square of a
//! motion over the longest flight is integrated with a relative error of some 10⁻¹⁶.

use super::{BLOCK, Block, Forced};
use crate::compensated::DoubleDouble;
use crate::plain::responses::{Responses, TERMS};
use crate::plain::{BASE, State, Structure};
use crate::taylor::unrolled;

/// Nodes and weights on [0, 1] (zeros of the Legendre polynomial of degree 9).
const NODES: [(f64, f64); 9] = [
    (0.015919880246186954, 0.040637194180787206),
    (0.0819844463366821, 0.0903240803474287),
    (0.1933142836497048, 0.13030534820146772),
    (0.33787328829809554, 0.15617353852000143),
    (0.5, 0.1651196775006299),
    (0.6621267117019045, 0.15617353852000143),
    (0.8066857163502952, 0.13030534820146772),
    (0.9180155536633179, 0.0903240803474287),
    (0.984080119753813, 0.040637194180787206),
];

/// Number of coefficients of a sum of P, Q, C, B and a linear function, in powers of t = h/longest.
const LENGTH: usize = TERMS + 4;

/// A polynomial for each flight of a block: coefficients in powers of t = h/longest.
type Course = [[f64; BLOCK]; LENGTH];

/// Nodes evaluated together: enough independent sums to hide the latency of each.
const AT_ONCE: usize = 3;

/// The polynomial first + second h + p P + q Q + c C + b B of each flight; `of` gives these coefficients.
#[allow(clippy::needless_range_loop, reason = "a flight is an index into every row")]
#[inline(always)]
fn combine(responses: &Responses, of: impl Fn(usize) -> ([f64; 2], [f64; 4])) -> Course {
    let &Responses { longest, terms, .. } = responses;
    let square = longest * longest;
    let [cube, fourth] = [square * longest, square * square];
    let mut course = [[0.0; BLOCK]; LENGTH];
    for i in 0..BLOCK {
        let ([first, second], [p, q, c, b]) = of(i);
        let (p, q, c, b) = (p * square, q * cube, c * fourth, b * cube);
        course[0][i] = first;
        course[1][i] = second * longest;
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
            course[k + 2][i] = sum;
        });
    }
    course
}

/// The values of a polynomial at some points of each flight.
#[inline(always)]
fn at(course: &Course, t: &[[f64; BLOCK]; AT_ONCE]) -> [[f64; BLOCK]; AT_ONCE] {
    let [mut first, mut second, mut third] = [course[LENGTH - 1]; AT_ONCE];
    for k in (0..LENGTH - 1).rev() {
        for i in 0..BLOCK {
            first[i] = f64::mul_add(first[i], t[0][i], course[k][i]);
            second[i] = f64::mul_add(second[i], t[1][i], course[k][i]);
            third[i] = f64::mul_add(third[i], t[2][i], course[k][i]);
        }
    }
    [first, second, third]
}

/// The nodes of one group, scaled to the lengths of the flights.
#[inline(always)]
fn nodes(group: usize, parts: &[f64; BLOCK]) -> [[f64; BLOCK]; AT_ONCE] {
    let mut t = [[0.0; BLOCK]; AT_ONCE];
    for (n, t) in t.iter_mut().enumerate() {
        let (node, _) = NODES[AT_ONCE * group + n];
        for i in 0..BLOCK {
            t[i] = node * parts[i];
        }
    }
    t
}

/// ẍ, Ω²f and Ωf̂ of a state, from which motion and force follow ([`crate::plain`]).
#[inline(always)]
fn drives(structure: &Structure, state: &State) -> [f64; 3] {
    let Structure { damping, frequency, .. } = *structure;
    let a = state.v.mul_add(-damping, state.force - state.x);
    [a, (frequency * frequency) * state.force, frequency * state.quadrature]
}

/// The polynomial of ẋ.
#[inline(always)]
fn velocity(structure: &Structure, responses: &Responses, block: &Block) -> Course {
    let Structure { damping, frequency, .. } = *structure;
    combine(
        responses,
        #[inline(always)]
        |i| {
            let state = block.begin(i);
            let [a, k, j] = drives(structure, &state);
            let p = a.mul_add(-damping, -(state.v + j));
            ([state.v, a], [p, a, -(j * (frequency * frequency)), -k])
        },
    )
}

/// The polynomial of x.
#[inline(always)]
fn displacement(structure: &Structure, responses: &Responses, block: &Block) -> Course {
    combine(
        responses,
        #[inline(always)]
        |i| {
            let state = block.begin(i);
            let [a, k, j] = drives(structure, &state);
            ([state.x, state.v], [a, state.v, k, -j])
        },
    )
}

/// The polynomial of f.
#[inline(always)]
fn force(structure: &Structure, responses: &Responses, block: &Block) -> Course {
    let Structure { damping, frequency, .. } = *structure;
    let rapid = frequency * frequency;
    combine(
        responses,
        #[inline(always)]
        |i| {
            let state = block.begin(i);
            let [_, k, j] = drives(structure, &state);
            let c = k.mul_add(1.0 - rapid, -(j * (damping * rapid)));
            let b = -k.mul_add(damping, j * (1.0 - rapid));
            ([state.force, -j], [-k, -j, c, b])
        },
    )
}

impl Forced {
    /// The energy lost in the damper, and the work of the force or base.
    #[inline(always)]
    pub(super) fn lose<const DRIVE: u8>(&self) -> [DoubleDouble; 2] {
        // By value, so that the compiler knows that no store changes them.
        let (structure, responses, mass_ratio) =
            (self.structure, self.responses, self.scene.mass_ratio);
        let [mut lost, mut worked] = [DoubleDouble::ZERO; 2];
        for (number, block) in self.blocks[..self.count.div_ceil(BLOCK)].iter().enumerate() {
            let parts = parts(&structure, block);
            let course = velocity(&structure, &responses, block);
            let push = force(&structure, &responses, block);
            let [mut squares, mut works, mut pushed] = [[0.0; BLOCK]; 3];
            for group in 0..NODES.len() / AT_ONCE {
                let t = nodes(group, &parts);
                let velocities = at(&course, &t);
                let forces = at(&push, &t);
                for (n, (velocity, force)) in velocities.iter().zip(&forces).enumerate() {
                    let (_, weight) = NODES[AT_ONCE * group + n];
                    for i in 0..BLOCK {
                        squares[i] = f64::mul_add(weight * velocity[i], velocity[i], squares[i]);
                        works[i] = f64::mul_add(weight * force[i], velocity[i], works[i]);
                        pushed[i] = f64::mul_add(weight, force[i], pushed[i]);
                    }
                }
            }
            for i in 0..BLOCK {
                let length = block.flights.length[i];
                squares[i] *= structure.damping * length;
                works[i] *= length;
                if DRIVE == BASE {
                    // ∫ f (ẋ + μ (ẋ + w)) with f = −a_g: the absorber is in free flight, so its velocity
                    // ẋ + w is the one at the begin + ∫f.
                    let state = block.begin(i);
                    let absorber = state.v - state.side * state.rate;
                    let pushed = pushed[i] * length;
                    works[i] += mass_ratio * (pushed * (0.5 * pushed + absorber));
                }
            }
            for i in 0..BLOCK.min(self.count - number * BLOCK) {
                lost = lost.plus(squares[i]);
                worked = worked.plus(works[i]);
            }
        }
        [lost, worked]
    }

    /// ∫x² of the flights in the window.
    #[inline(always)]
    pub(super) fn square(&self) -> DoubleDouble {
        let (structure, responses) = (self.structure, self.responses);
        let mut sum = DoubleDouble::ZERO;
        let first = self.before / BLOCK;
        let blocks = self.blocks.iter().enumerate().take(self.count.div_ceil(BLOCK));
        for (number, block) in blocks.skip(first) {
            let parts = parts(&structure, block);
            let course = displacement(&structure, &responses, block);
            let mut squares = [0.0; BLOCK];
            for group in 0..NODES.len() / AT_ONCE {
                let places = at(&course, &nodes(group, &parts));
                for (n, place) in places.iter().enumerate() {
                    let (_, weight) = NODES[AT_ONCE * group + n];
                    for i in 0..BLOCK {
                        squares[i] = f64::mul_add(weight * place[i], place[i], squares[i]);
                    }
                }
            }
            for (square, length) in squares.iter_mut().zip(&block.flights.length) {
                *square *= length;
            }
            let begin = self.before.saturating_sub(number * BLOCK).min(BLOCK);
            let end = BLOCK.min(self.count - number * BLOCK);
            for square in &squares[begin..end.max(begin)] {
                sum = sum.plus(*square);
            }
        }
        sum
    }
}

/// Lengths of flights in units of the longest one.
#[inline(always)]
fn parts(structure: &Structure, block: &Block) -> [f64; BLOCK] {
    std::array::from_fn(|i| block.flights.length[i] * structure.over_longest)
}
