//! The largest |x| and |ẍ + a_g| of flights: bounds on all of them first, exact values only where a bound
//! exceeds the largest size known so far.

use super::{BLOCK, Block, Forced, Part};
use crate::absorber::plain::responses::Responses;
use crate::absorber::plain::{State, Structure};
use crate::host::turning::turn;
use crate::number::arrays::{self, any};
use crate::number::real::{Real, pick};
use crate::segment::flight::{Arc, Extreme};
use crate::segment::quintic::root;

/// A function of the state of a structure with its first five derivatives.
type Jets = [f64; 6];

/// Largest number of times that a flight is halved to find the largest size in it.
const HALVINGS: usize = 24;
/// A bound that exceeds the size at both ends by no more than this part of the terms of the function may exceed
/// it by rounding alone.
const NOISE: f64 = 256.0 * f64::EPSILON;

/// x, or the absolute acceleration, with its first five derivatives.
#[inline(always)]
fn jets<const DRIVE: u8, const ACCELERATION: bool>(structure: &Structure, at: &State) -> Jets {
    let [absolute, [bend, third, fourth, fifth, ..]] = structure.derivatives::<DRIVE>(at);
    if ACCELERATION { absolute } else { [at.x, at.v, bend, third, fourth, fifth] }
}

/// A bound on the sixth derivative in every motion from a state.
#[inline(always)]
fn sixth<const ACCELERATION: bool>(structure: &Structure, at: &State) -> f64 {
    if ACCELERATION {
        structure.bound::<6>(at)
    } else {
        structure.bound::<4>(at) + structure.base_4
    }
}

/// The size of the terms of the function in a flight from a state.
#[inline(always)]
fn size<const ACCELERATION: bool>(structure: &Structure, at: &State) -> f64 {
    let longest = structure.longest;
    if ACCELERATION {
        // A may be a small difference of large terms.
        structure.bound::<3>(at) * (longest * longest * longest)
    } else {
        at.x.abs() + at.v.abs() * longest
    }
}

/// The function in a flight of this length between two states, as far as they determine it.
#[inline(always)]
fn arc<const DRIVE: u8, const ACCELERATION: bool>(
    structure: &Structure,
    [begin, end]: [&State; 2],
    length: f64,
) -> Arc {
    let [a, b, c, ..] = jets::<DRIVE, ACCELERATION>(structure, begin);
    let [d, e, f, ..] = jets::<DRIVE, ACCELERATION>(structure, end);
    let bound = sixth::<ACCELERATION>(structure, begin);
    let arc = Arc::new([a, b, c], [d, e, f], bound, length);
    if ACCELERATION { arc.doubted(size::<ACCELERATION>(structure, begin)) } else { arc }
}

impl Forced {
    /// The larger of `least` and the largest |x| or |A| of the flights in the window.
    #[inline(always)]
    pub(super) fn largest<const DRIVE: u8, const ACCELERATION: bool>(&self, least: f64) -> f64 {
        let mut least = least;
        let blocks = self.blocks.iter().enumerate().take(self.count.div_ceil(BLOCK));
        for (number, block) in blocks.skip(self.before / BLOCK) {
            let begin = self.before.saturating_sub(number * BLOCK).min(BLOCK);
            let end = BLOCK.min(self.count - number * BLOCK);
            let [limit, most, known] = self.bounded::<DRIVE, ACCELERATION>(block);
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
            let [turned, once] = self.turned::<DRIVE, ACCELERATION>(block);
            for i in 0..BLOCK {
                let found = (asks[i] > 0.0) & (once[i] > 0.0);
                sizes[i] = pick(found, f64::larger(most[i], turned[i].abs()), 0.0);
                asks[i] = pick(found, 0.0, asks[i]);
            }
            least = least.max(arrays::largest(&sizes));
            if any(&asks) {
                for i in (begin..end).filter(|i| asks[*i] > 0.0) {
                    least = self.search::<DRIVE, ACCELERATION>(&block.part(i), least);
                }
            }
        }
        least
    }

    /// Bound, largest size, and 1 if that is known, for each flight of a block as far as its ends tell.
    #[inline(always)]
    fn bounded<const DRIVE: u8, const ACCELERATION: bool>(
        &self,
        block: &Block,
    ) -> [[f64; BLOCK]; 3] {
        let structure = self.structure;
        let [mut limit, mut most, mut known] = [[0.0; BLOCK]; 3];
        for i in 0..BLOCK {
            let Part { begin, end, length } = block.part(i);
            let arc = arc::<DRIVE, ACCELERATION>(&structure, [&begin, &end], length);
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
    fn turned<const DRIVE: u8, const ACCELERATION: bool>(
        &self,
        block: &Block,
    ) -> [[f64; BLOCK]; 2] {
        let (structure, responses) = (self.structure, self.responses);
        let [mut value, mut once] = [[0.0; BLOCK]; 2];
        for i in 0..BLOCK {
            let Part { begin, end, length } = block.part(i);
            let arc = arc::<DRIVE, ACCELERATION>(&structure, [&begin, &end], length);
            let (turned, exact) =
                extremum::<DRIVE, ACCELERATION>((&structure, &responses), [&begin, &end], length);
            value[i] = turned;
            once[i] = pick(exact & arc.turns_once(), 1.0, 0.0);
        }
        [value, once]
    }

    /// The larger of `least` and the largest size in a flight, which is halved until it is known.
    #[inline(always)]
    pub(super) fn search<const DRIVE: u8, const ACCELERATION: bool>(
        &self,
        part: &Part,
        least: f64,
    ) -> f64 {
        let noise = NOISE * size::<ACCELERATION>(&self.structure, &part.begin);
        match self.look::<DRIVE, ACCELERATION>(part, noise, least) {
            Ok(least) => least,
            Err(least) => self.halve::<DRIVE, ACCELERATION>(part, noise, least),
        }
    }

    /// The larger of `least` and the largest size in a flight; an error if only a lower bound of that is known.
    #[inline(always)]
    fn look<const DRIVE: u8, const ACCELERATION: bool>(
        &self,
        part: &Part,
        noise: f64,
        least: f64,
    ) -> Result<f64, f64> {
        let Part { begin, end, length } = part;
        let arc = arc::<DRIVE, ACCELERATION>(&self.structure, [begin, end], *length);
        let extreme = Extreme::new(&arc, false, 0.0);
        if extreme.limit < least {
            return Ok(least);
        }
        let least = least.max(arc.begin[0].abs()).max(arc.end[0].abs());
        // False as well where nothing is a number.
        let exceeds = extreme.limit > least + noise;
        if extreme.known || !exceeds {
            return Ok(least);
        }
        let shared = (&self.structure, &self.responses);
        let (value, exact) = extremum::<DRIVE, ACCELERATION>(shared, [begin, end], *length);
        if exact && arc.turns_once() { Ok(least.max(value.abs())) } else { Err(least) }
    }

    /// [`Forced::search`] in a flight whose largest size is not known at once.
    #[inline(always)]
    fn halve<const DRIVE: u8, const ACCELERATION: bool>(
        &self,
        part: &Part,
        noise: f64,
        mut least: f64,
    ) -> f64 {
        // The parts that are still to be looked at, the earliest last.
        let mut parts = [*part; HALVINGS + 2];
        let mut count = 1;
        let shortest = part.length * 0.5f64.powi(HALVINGS as i32);
        while count > 0 {
            count -= 1;
            let part = parts[count];
            match self.look::<DRIVE, ACCELERATION>(&part, noise, least) {
                Ok(most) => least = most,
                Err(most) => {
                    least = most;
                    if part.length > shortest {
                        let length = 0.5 * part.length;
                        let middle =
                            part.begin.after::<DRIVE>(&self.structure, &self.responses, length);
                        parts[count] = Part { begin: middle, length, ..part };
                        parts[count + 1] = Part { end: middle, length, ..part };
                        count += 2;
                    }
                }
            }
        }
        least
    }
}

/// The value at an extremum in a flight, and whether it is found to rounding. If there is none, or more than
/// one, it is meaningless.
#[inline(always)]
fn extremum<const DRIVE: u8, const ACCELERATION: bool>(
    (structure, responses): (&Structure, &Responses),
    [begin, end]: [&State; 2],
    length: f64,
) -> (f64, bool) {
    let [_, a, b, c, ..] = jets::<DRIVE, ACCELERATION>(structure, begin);
    let [_, d, e, f, ..] = jets::<DRIVE, ACCELERATION>(structure, end);
    let guess = length * root(&turn([a, b, c], [d, e, f], length));
    let guess = pick((guess > 0.0) & (guess < length), guess, 0.5 * length);
    let there = begin.after::<DRIVE>(structure, responses, guess);
    let [value, rate, bend, third, fourth, fifth] = jets::<DRIVE, ACCELERATION>(structure, &there);
    let (third, fourth, fifth) = (third * 0.5, fourth * (1.0 / 6.0), fifth * (1.0 / 24.0));
    let mut t = -rate / bend;
    for _ in 0..2 {
        let speed = fifth.mul_add(t, fourth).mul_add(t, third).mul_add(t, bend).mul_add(t, rate);
        let slope = (fifth * 4.0).mul_add(t, fourth * 3.0).mul_add(t, third * 2.0).mul_add(t, bend);
        t -= speed / slope;
    }
    let h = guess + t;
    let rise = (fifth * 0.2).mul_add(t, fourth * 0.25).mul_add(t, third * (1.0 / 3.0));
    let value = rise.mul_add(t, bend * 0.5).mul_add(t, rate).mul_add(t, value);
    // Compares the next term of the series with rounding.
    let square = t * t;
    let left_out =
        sixth::<ACCELERATION>(structure, begin) * ((square * square) * (t.abs() * (1.0 / 120.0)));
    let close = left_out <= f64::EPSILON * (bend.abs() * h);
    (value, close & (h > 0.0) & (h < length) & (bend != 0.0))
}
