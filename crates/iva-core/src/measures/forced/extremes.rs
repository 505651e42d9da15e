//! The largest |x| and |ẍ + a_g| of flights: bounds on all of them first, values at extrema only where a bound
//! exceeds the largest size known so far, and the extrema of polynomials where bounds prove too little.

use super::courses::course;
use super::flights::Part;
use super::{BLOCK, Block, Forced};
use crate::absorber::plain::responses::Responses;
use crate::absorber::plain::{State, Structure};
use crate::host::turning::{Jets, Turned, guess, turned_once};
use crate::number::arrays::{self, any};
use crate::number::real::{Real, pick};
use crate::segment::flight::{Arc, Extreme, Quantity};
use crate::segment::polynomial;

/// x, or the absolute acceleration, at a state, with its first five derivatives.
#[inline(always)]
fn jets<const DRIVE: u8>(of: Quantity, structure: &Structure, at: &State) -> Jets<f64> {
    let [absolute, relative] = structure.derivatives::<DRIVE>(at);
    let [bend, third, fourth, fifth, ..] = relative;
    match of {
        Quantity::Displacement => [at.x, at.v, bend, third, fourth, fifth],
        Quantity::Acceleration => absolute,
    }
}

/// A bound on the sixth derivative of a quantity in every motion from a state.
#[inline(always)]
fn sixth(of: Quantity, structure: &Structure, at: &State) -> f64 {
    match of {
        Quantity::Displacement => structure.bound::<4>(at) + structure.base_4,
        Quantity::Acceleration => structure.bound::<6>(at),
    }
}

/// A quantity in a flight: value and two derivatives at both ends, and a bound on the sixth derivative.
#[inline(always)]
fn arc<const DRIVE: u8>(of: Quantity, structure: &Structure, part: &Part) -> Arc {
    let Part { begin, end, length } = part;
    let [a, b, c, ..] = jets::<DRIVE>(of, structure, begin);
    let [d, e, f, ..] = jets::<DRIVE>(of, structure, end);
    let arc = Arc::new([a, b, c], [d, e, f], sixth(of, structure, begin), *length);
    match of {
        Quantity::Displacement => arc,
        Quantity::Acceleration => {
            let longest = structure.longest;
            // A may be a small difference of large terms.
            arc.doubted(structure.bound::<3>(begin) * (longest * longest * longest))
        }
    }
}

/// The extremum of a quantity in a flight that is this arc, if it is proved to be the only one.
#[inline(always)]
fn turned<const DRIVE: u8>(
    of: Quantity,
    (structure, responses): (&Structure, &Responses),
    part: &Part,
    arc: &Arc,
) -> Turned {
    let Part { begin, end, length } = part;
    let rates = |at: &State| {
        let [_, rate, second, third, ..] = jets::<DRIVE>(of, structure, at);
        [rate, second, third]
    };
    let at = guess(rates(begin), rates(end), *length);
    let at = pick((at > 0.0) & (at < *length), at, 0.5 * length);
    let there = begin.after::<DRIVE>(structure, responses, at);
    let jets = jets::<DRIVE>(of, structure, &there);
    turned_once(arc, (at, jets), sixth(of, structure, begin), *length)
}

impl Forced {
    /// The larger of `least` and the largest size of a quantity in the flights in the window.
    #[inline(always)]
    pub(super) fn largest<const DRIVE: u8>(&self, of: Quantity, least: f64) -> f64 {
        let mut least = least;
        let blocks = self.blocks.iter().enumerate().take(self.count.div_ceil(BLOCK));
        for (number, block) in blocks.skip(self.before / BLOCK) {
            let begin = self.before.saturating_sub(number * BLOCK).min(BLOCK);
            let end = BLOCK.min(self.count - number * BLOCK);
            let [limit, most, known] = self.bounded::<DRIVE>(of, block);
            let [mut sizes, mut asks] = [[0.0; BLOCK]; 2];
            for i in 0..BLOCK {
                sizes[i] = pick((known[i] > 0.0) & (i >= begin) & (i < end), most[i], 0.0);
            }
            least = least.max(arrays::largest(&sizes));
            for i in 0..BLOCK {
                let unknown = (known[i] == 0.0) & (i >= begin) & (i < end);
                asks[i] = pick(unknown & (limit[i] >= least), 1.0, 0.0);
            }
            if !any(&asks) {
                continue;
            }
            let [turned, once] = self.turned::<DRIVE>(of, block);
            for i in 0..BLOCK {
                let found = (asks[i] > 0.0) & (once[i] > 0.0);
                sizes[i] = pick(found, f64::larger(most[i], turned[i].abs()), 0.0);
                asks[i] = pick(found, 0.0, asks[i]);
            }
            least = least.max(arrays::largest(&sizes));
            if any(&asks) {
                for i in (begin..end).filter(|i| asks[*i] > 0.0) {
                    least = self.searched::<DRIVE>(of, &block.part(i), least);
                }
            }
        }
        least
    }

    /// For each flight of a block, from its ends: a bound on the size, the largest size, and 1 if that is proved.
    #[inline(always)]
    fn bounded<const DRIVE: u8>(&self, of: Quantity, block: &Block) -> [[f64; BLOCK]; 3] {
        let structure = self.structure;
        let [mut limit, mut most, mut known] = [[0.0; BLOCK]; 3];
        for i in 0..BLOCK {
            let arc = arc::<DRIVE>(of, &structure, &block.part(i));
            let extreme = Extreme::new(&arc, false, 0.0);
            limit[i] = extreme.limit;
            most[i] = extreme.most;
            known[i] = pick(extreme.known, 1.0, 0.0);
        }
        [limit, most, known]
    }

    /// The value at the extremum in each flight of a block, and 1 if it is found to rounding and proved to be
    /// the only one.
    #[inline(always)]
    fn turned<const DRIVE: u8>(&self, of: Quantity, block: &Block) -> [[f64; BLOCK]; 2] {
        let (structure, responses) = (self.structure, self.responses);
        let [mut value, mut once] = [[0.0; BLOCK]; 2];
        for i in 0..BLOCK {
            let part = block.part(i);
            let arc = arc::<DRIVE>(of, &structure, &part);
            let turned = turned::<DRIVE>(of, (&structure, &responses), &part, &arc);
            value[i] = turned.value;
            once[i] = pick(turned.once, 1.0, 0.0);
        }
        [value, once]
    }

    /// The larger of `least` and the largest size of a quantity in a part of a flight.
    #[inline(always)]
    pub(super) fn largest_in<const DRIVE: u8>(&self, of: Quantity, part: &Part, least: f64) -> f64 {
        let Self { structure, responses, .. } = self;
        let arc = arc::<DRIVE>(of, structure, part);
        if arc.limit() < least {
            return least;
        }
        let turned = turned::<DRIVE>(of, (structure, responses), part, &arc);
        let known = Extreme::new(&arc, turned.once, turned.value).largest(least);
        known.unwrap_or_else(|| self.searched::<DRIVE>(of, part, least))
    }

    /// [`Forced::largest_in`] from the extrema of the polynomial.
    #[inline(never)]
    fn searched<const DRIVE: u8>(&self, of: Quantity, part: &Part, least: f64) -> f64 {
        let course = course::<DRIVE>(of, &self.structure, &self.responses, &part.begin);
        let end = part.length * self.structure.over_longest;
        polynomial::largest(&course, [0.0, end], least)
    }
}
