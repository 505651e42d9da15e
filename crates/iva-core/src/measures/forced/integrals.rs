//! Losses, work and ∫x² of flights as integrals.
//!
//! The integrals are Gaussian quadratures of the polynomial of ẋ ([`crate::absorber::plain`]), of its integral x, and of
//! the force, never differences of energies, so that the energy ledger is an independent check. With [`NODES`]
//! the square of a motion over the longest flight is integrated with a relative error of some 10⁻¹⁶.

use super::flights::turned;
use super::{BLOCK, Block, Forced};
use crate::absorber::plain::responses::{Responses, TERMS};
use crate::absorber::plain::{BASE, Structure};
use crate::number::compensated::DoubleDouble;
use crate::segment::taylor::unrolled;

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

/// A polynomial for each flight of a block: its coefficients in powers of t = h/longest.
type Course<const N: usize = LENGTH> = [[f64; BLOCK]; N];

/// Nodes evaluated together: enough independent sums to hide the latency of each.
const AT_ONCE: usize = 3;

/// The polynomial of ẋ: the sum of ẋ + ẍ h and of P, Q, C and B with coefficients from the state at the begin.
#[allow(clippy::needless_range_loop, reason = "a flight is an index into every row")]
#[inline(always)]
fn velocity(structure: &Structure, responses: &Responses, block: &Block) -> Course {
    let &Responses { longest, terms, .. } = responses;
    let Structure { damping, frequency, .. } = *structure;
    let (rapid, square) = (frequency * frequency, longest * longest);
    let [cube, fourth] = [square * longest, square * square];
    let mut course = [[0.0; BLOCK]; LENGTH];
    for i in 0..BLOCK {
        let state = block.begin(i);
        let a = state.v.mul_add(-damping, state.force - state.x);
        let (k, j) = (rapid * state.force, frequency * state.quadrature);
        let (p, q) = (a.mul_add(-damping, -(state.v + j)) * square, a * cube);
        let (c, b) = (-(j * rapid) * fourth, -k * cube);
        course[0][i] = state.v;
        course[1][i] = a * longest;
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

/// The polynomial of x: the integral of that of ẋ.
#[inline(always)]
fn displacement(velocity: &Course, longest: f64, block: &Block) -> Course<{ LENGTH + 1 }> {
    let mut course = [[0.0; BLOCK]; LENGTH + 1];
    for i in 0..BLOCK {
        course[0][i] = block.flights.x[i];
        unrolled!(k < LENGTH => {
            course[k + 1][i] = velocity[k][i] * (longest * (1.0 / (k + 1) as f64));
        });
    }
    course
}

/// f at the nodes of each flight: turned back and on from the middle by the same angles.
#[inline(always)]
fn forces(structure: &Structure, block: &Block) -> [[f64; BLOCK]; NODES.len()] {
    let last = NODES.len() - 1;
    let [force, quadrature] = &block.middle;
    let mut forces = [*force; NODES.len()];
    for (n, (node, _)) in NODES.iter().enumerate().take(NODES.len() / 2) {
        let rate = structure.frequency * (0.5 - node);
        for i in 0..BLOCK {
            let [sine, cosine] = turned(rate * block.flights.length[i]);
            let (along, across) = (force[i] * cosine, quadrature[i] * sine);
            forces[n][i] = along + across;
            forces[last - n][i] = along - across;
        }
    }
    forces
}

/// The values of a polynomial at some points of each flight.
#[inline(always)]
fn at<const N: usize>(course: &Course<N>, t: &[[f64; BLOCK]; AT_ONCE]) -> [[f64; BLOCK]; AT_ONCE] {
    let [mut first, mut second, mut third] = [course[N - 1]; AT_ONCE];
    for k in (0..N - 1).rev() {
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

/// Integrals over many flights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Integrals {
    /// The energy lost in the damper.
    pub lost: DoubleDouble,
    /// The work of the force or base.
    pub worked: DoubleDouble,
    /// ∫x² of the flights in the window.
    pub square: DoubleDouble,
}

impl Forced {
    /// The integrals that are wanted.
    #[inline(always)]
    pub(super) fn integrate<const DRIVE: u8>(&self) -> Integrals {
        // By value, so that the compiler knows that no store changes them.
        let (structure, responses) = (self.structure, self.responses);
        let zero = DoubleDouble::ZERO;
        let mut sums = Integrals { lost: zero, worked: zero, square: zero };
        let (ledger, rms) = (self.wanted.ledger, self.steady.rms);
        if !(ledger || rms) {
            return sums;
        }
        let first = if ledger { 0 } else { self.before / BLOCK };
        let blocks = self.blocks.iter().enumerate().take(self.count.div_ceil(BLOCK));
        for (number, block) in blocks.skip(first) {
            let parts = block.flights.length.map(|length| length * structure.over_longest);
            let course = velocity(&structure, &responses, block);
            let end = BLOCK.min(self.count - number * BLOCK);
            if ledger {
                let [lost, worked] = self.lose::<DRIVE>(block, &course, &parts);
                for i in 0..end {
                    sums.lost = sums.lost.plus(lost[i]);
                    sums.worked = sums.worked.plus(worked[i]);
                }
            }
            let begin = self.before.saturating_sub(number * BLOCK);
            if rms && begin < end {
                let squares = self.square(block, &course, &parts);
                for square in &squares[begin..end] {
                    sums.square = sums.square.plus(*square);
                }
            }
        }
        sums
    }

    /// The energy lost in the damper, and the work of the force or base, of each flight.
    #[inline(always)]
    fn lose<const DRIVE: u8>(
        &self,
        block: &Block,
        course: &Course,
        parts: &[f64; BLOCK],
    ) -> [[f64; BLOCK]; 2] {
        let (structure, mass_ratio) = (self.structure, self.scene.mass_ratio);
        let forces = forces(&structure, block);
        let [mut squares, mut works, mut pushed] = [[0.0; BLOCK]; 3];
        for group in 0..NODES.len() / AT_ONCE {
            let velocities = at(course, &nodes(group, parts));
            for (n, velocity) in velocities.iter().enumerate() {
                let (_, weight) = NODES[AT_ONCE * group + n];
                let force = &forces[AT_ONCE * group + n];
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
                // ∫ f (ẋ + μ (ẋ + w)) with f = −a_g: the absorber is in free flight, so its velocity ẋ + w is
                // the one at the begin + ∫f.
                let state = block.begin(i);
                let absorber = state.v - state.side * state.rate;
                let pushed = pushed[i] * length;
                works[i] += mass_ratio * (pushed * (0.5 * pushed + absorber));
            }
        }
        [squares, works]
    }

    /// ∫x² of each flight.
    #[inline(always)]
    fn square(&self, block: &Block, velocity: &Course, parts: &[f64; BLOCK]) -> [f64; BLOCK] {
        let course = displacement(velocity, self.structure.longest, block);
        let mut squares = [0.0; BLOCK];
        for group in 0..NODES.len() / AT_ONCE {
            let places = at(&course, &nodes(group, parts));
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
        squares
    }
}
