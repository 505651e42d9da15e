//! Losses, work and ∫x² of flights as integrals.
//!
//! The integrals are quadratures ([`crate::segment::quadrature`]) of the polynomial of ẋ, of its integral x, and of the
//! force.

use super::courses::{ORDER, Velocity, displacement, velocity};
use super::flights::{Flight, turned};
use super::{BLOCK, Block, Forced};
use crate::absorber::plain::{BASE, State, Structure};
use crate::number::arrays::{Laned, Lanes};
use crate::number::compensated::DoubleDouble;
use crate::number::real::pick;
use crate::segment::quadrature::{mean, mean_product, node, nodes, values};

/// Number of nodes of the integrals over a flight.
const NODES: usize = 9;

/// The polynomials of a block.
type Courses = <Velocity as Laned>::Lanes<BLOCK>;

/// Integrals over many flights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Integrals {
    /// The energy lost in the damper.
    pub lost: DoubleDouble,
    /// The work of the force or base.
    pub worked: DoubleDouble,
    /// ∫x² of the flights in the window.
    pub square: DoubleDouble,
}

/// Sums over the flights that have the same place in their blocks.
struct Sums(<DoubleDouble as Laned>::Lanes<BLOCK>);

impl Sums {
    /// Adds what the flights of a block at these places have.
    #[inline(always)]
    fn add(&mut self, each: &[f64; BLOCK], [begin, end]: [usize; 2]) {
        for (i, one) in each.iter().enumerate() {
            let counts = (i >= begin) & (i < end);
            self.0.set(i, &self.0.get(i).plus(pick(counts, *one, 0.0)));
        }
    }

    /// The sum over all flights.
    #[inline(always)]
    fn all(&self) -> DoubleDouble {
        (0..BLOCK).fold(DoubleDouble::ZERO, |sum, i| sum + self.0.get(i))
    }
}

impl Forced {
    /// The integrals that are wanted.
    #[inline(always)]
    pub(super) fn integrate<const DRIVE: u8>(&self) -> Integrals {
        let (ledger, rms) = (self.wanted.ledger, self.steady.rms);
        if !(ledger || rms) {
            return Integrals::default();
        }
        let [mut lost, mut worked, mut square] = [(); 3].map(|()| Sums(Lanes::new()));
        let first = if ledger { 0 } else { self.before / BLOCK };
        let blocks = self.blocks.iter().enumerate().take(self.count.div_ceil(BLOCK));
        for (number, block) in blocks.skip(first) {
            let end = BLOCK.min(self.count - number * BLOCK);
            let courses = self.courses(block);
            if ledger {
                let [losses, works] = self.lose::<DRIVE>(block, &courses);
                lost.add(&losses, [0, end]);
                worked.add(&works, [0, end]);
            }
            let begin = self.before.saturating_sub(number * BLOCK);
            if rms && begin < end {
                square.add(&self.square(block, &courses), [begin, end]);
            }
        }
        Integrals { lost: lost.all(), worked: worked.all(), square: square.all() }
    }

    /// The polynomials of ẋ in the flights of a block.
    #[inline(always)]
    fn courses(&self, block: &Block) -> Courses {
        // By value, so that the compiler knows that no store changes them.
        let (structure, responses) = (self.structure, self.responses);
        let mut courses = Courses::new();
        for i in 0..BLOCK {
            courses.set(i, &velocity(&structure, &responses, &block.begin(i)));
        }
        courses
    }

    /// The energy lost in the damper, and the work of the force or base, of each flight.
    #[inline(always)]
    fn lose<const DRIVE: u8>(&self, block: &Block, courses: &Courses) -> [[f64; BLOCK]; 2] {
        let (structure, mass_ratio) = (self.structure, self.scene.mass_ratio);
        let [mut lost, mut worked] = [[0.0; BLOCK]; 2];
        for i in 0..BLOCK {
            let length = block.flights.length[i];
            let t = nodes::<f64, NODES>([0.0, length * structure.over_longest]);
            let speed = values::<ORDER, _, _, _>(&courses.get(i), &t);
            let force = forces(&structure, block.middle(i), length);
            lost[i] = structure.damping * mean_product(&speed, &speed) * length;
            worked[i] = mean_product(&force, &speed) * length;
            if DRIVE == BASE {
                // ∫ f (ẋ + μ (ẋ + w)) with f = −a_g: the absorber is in free flight, so its velocity ẋ + w is
                // the one at the begin + ∫f.
                let State { v, side, rate, .. } = block.begin(i);
                let pushed = mean(&force) * length;
                worked[i] += mass_ratio * (pushed * (0.5 * pushed + (v - side * rate)));
            }
        }
        [lost, worked]
    }

    /// ∫x² of each flight.
    #[inline(always)]
    fn square(&self, block: &Block, courses: &Courses) -> [f64; BLOCK] {
        let structure = self.structure;
        let mut squares = [0.0; BLOCK];
        for (i, square) in squares.iter_mut().enumerate() {
            let Flight { x, length, .. } = block.flights.get(i);
            let course = displacement(x, &courses.get(i), structure.longest);
            let t = nodes::<f64, NODES>([0.0, length * structure.over_longest]);
            let place = values::<{ ORDER + 1 }, _, _, _>(&course, &t);
            *square = mean_product(&place, &place) * length;
        }
        squares
    }
}

/// f at the nodes of a flight: turned back and on from its middle by the same angles.
#[inline(always)]
fn forces(structure: &Structure, [force, quadrature]: [f64; 2], length: f64) -> [f64; NODES] {
    let mut forces = [force; NODES];
    for n in 0..NODES / 2 {
        let rate = structure.frequency * (0.5 - node::<f64, NODES>(n, [0.0, 1.0]));
        let [sine, cosine] = turned(rate * length);
        let (along, across) = (force * cosine, quadrature * sine);
        forces[n] = along + across;
        forces[NODES - 1 - n] = along - across;
    }
    forces
}
