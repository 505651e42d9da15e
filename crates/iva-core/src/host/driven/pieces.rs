//! A structure under a record, from point to point, by responses that are computed once: the piecewise exact
//! method (N. C. Nigam, P. C. Jennings, Bull. Seismol. Soc. Am. 59, 1969).
//!
//! Between two points of a record the force is linear, and the motion is known in closed form. The points are
//! gathered in blocks. For each point of a block the table holds the motion from rest at its first point, X and Ẋ,
//! the responses C and S to unit displacement and unit velocity there, and the motion of a moving base,
//! G = ∬a_g. The motion from any state (x₀, v₀) at the first point is then
//!
//! ```text
//! x = X + C x₀ + S v₀,    ẋ = Ẋ − k S x₀ + Ṡ v₀,    Ṡ = C − c S,
//! ```
//!
//! and a state at another point is traced back to the first one. The structure is that of mass 1 (k = 1); all
//! numbers are in double-double, with plain copies to look through.

use std::sync::OnceLock;

use crate::force::{Acts, Record};
use crate::host::oscillator::{Equation, Oscillator, Primary};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Quantity;

pub(crate) use integrals::{Forms, Sums};

mod integrals;

/// Largest number of points of a block, its end included.
pub(crate) const POINTS: usize = 32;
/// Largest relative difference of two lengths of pieces of which the second one's responses follow from the first
/// one's: what is left out is below 10⁻³⁰ of them.
const ALIKE: f64 = 1e-10;

/// A structure under one record, of which the blocks are made when they are first asked for.
#[derive(Debug)]
pub struct Pieces<R = f64> {
    oscillator: Oscillator<R>,
    record: Record<R>,
    /// The longest block, in 1/ωn.
    reach: R,
    /// Indices of the first points of the blocks, and of the last point of all.
    begins: Vec<usize>,
    blocks: Vec<OnceLock<Box<Block<R>>>>,
}

/// The motion over consecutive pieces of a record.
#[derive(Debug)]
pub(crate) struct Block<R = f64> {
    points: Vec<At<R>>,
    pub plain: Plain,
    /// The integrals up to each point, made when they are first asked for.
    forms: OnceLock<Vec<Forms<R>>>,
}

/// The responses from the first point of a block to one of its points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct At<R = f64> {
    /// The time since the first point.
    pub time: DoubleDouble<R>,
    /// X and Ẋ: the motion from rest.
    forced: Primary<R>,
    /// C and S.
    c: DoubleDouble<R>,
    s: DoubleDouble<R>,
    /// Ṡ.
    slope: DoubleDouble<R>,
    /// 1/(C Ṡ + S²).
    over: DoubleDouble<R>,
    /// ∬a_g and ∫a_g.
    pub base: Primary<R>,
    /// f/M.
    force: DoubleDouble<R>,
}

/// The points of a block in plain numbers, of which the first `count` are in use.
#[derive(Debug, Clone)]
pub(crate) struct Plain {
    pub count: usize,
    /// The longest piece.
    pub longest: f64,
    /// The largest time and the largest |G|.
    pub reach: [f64; 2],
    pub time: [f64; POINTS],
    pub c: [f64; POINTS],
    pub s: [f64; POINTS],
    pub slope: [f64; POINTS],
    /// X and Ẋ, and X + G.
    pub x: [f64; POINTS],
    pub v: [f64; POINTS],
    pub both: [f64; POINTS],
    /// f/M.
    pub force: [f64; POINTS],
}

/// The responses of the structure over one piece of length h.
#[derive(Debug, Clone, Copy)]
struct Responses<R> {
    h: DoubleDouble<R>,
    /// P, Q and S of [`crate::host::oscillator`].
    p: DoubleDouble<R>,
    q: DoubleDouble<R>,
    s: DoubleDouble<R>,
}

/// A place in a record: a block, and the index of one of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Index of the block.
    pub block: usize,
    /// Index of its point.
    pub point: usize,
}

impl<R: Real> Pieces<R> {
    /// The pieces of a record on a structure of this damping ratio, in blocks that are no longer than `reach`.
    pub(crate) fn new(damping_ratio: R, record: &Record<R>, reach: R) -> Self {
        let (oscillator, last) = (Oscillator::new(R::ONE, damping_ratio), record.points() - 1);
        let mut begins = vec![0];
        let mut first = record.knot(0);
        for index in 1..=last {
            let block = begins[begins.len() - 1];
            let too_long = (record.knot(index) - first).value > reach;
            if index > block + 1 && (too_long || index - block == POINTS) {
                begins.push(index - 1);
                first = record.knot(index - 1);
            }
        }
        begins.push(last);
        let blocks = (1..begins.len()).map(|_| OnceLock::new()).collect();
        Self { oscillator, record: record.apart(), reach, begins, blocks }
    }

    /// True if these are the pieces of this record on a structure of this damping ratio, of the same history.
    pub(crate) fn fits(&self, damping_ratio: R, record: &Record<R>) -> bool {
        self.oscillator.equation.damping == damping_ratio * 2.0 && self.record.is_alike(record)
    }

    /// The place of an instant that is exactly a point of the record, but not the last one; `passed`: the number of
    /// points up to that instant.
    pub(crate) fn place(&self, time: Clock<R>, passed: u32) -> Option<Place> {
        let index = (passed as usize).checked_sub(1)?;
        let last = self.begins[self.begins.len() - 1];
        let there = index < last && (self.record.knot(index) - time).value == 0.0;
        there.then(|| {
            let block = self.begins.partition_point(|begin| *begin <= index) - 1;
            Place { block, point: index - self.begins[block] }
        })
    }

    /// The number of points up to a place.
    pub(crate) fn passed(&self, place: Place) -> u32 {
        (self.begins[place.block] + place.point + 1) as u32
    }

    /// The instant of a place.
    pub(crate) fn instant(&self, place: Place) -> Clock<R> {
        self.record.knot(self.begins[place.block] + place.point)
    }

    /// A block; `None` after the last one, and for one that is longer than the reach: a single piece.
    pub(crate) fn block(&self, index: usize) -> Option<&Block<R>> {
        let cell = self.blocks.get(index)?;
        let block = cell.get_or_init(|| Box::new(self.made(index)));
        (block.points.len() > 1).then_some(block)
    }

    /// Integrals between two points of a block, from the state at its first point.
    pub(crate) fn sums(
        &self,
        index: usize,
        ends: [usize; 2],
        start: &Primary<R>,
    ) -> Option<Sums<R>> {
        let block = self.block(index)?;
        let forms = block.forms.get_or_init(|| self.integrated(index, &block.points));
        Some(Forms::between(ends.map(|point| &forms[point]), start))
    }

    fn made(&self, index: usize) -> Block<R> {
        let (first, end) = (self.begins[index], self.begins[index + 1]);
        let begin = self.record.knot(first);
        let zero = DoubleDouble::ZERO;
        let rest = Primary { x: zero, v: zero };
        let one = DoubleDouble::new(R::ONE);
        let force = self.force(first);
        let mut at = At {
            time: zero,
            forced: rest,
            c: one,
            s: zero,
            slope: one,
            over: one,
            base: rest,
            force,
        };
        let mut points = vec![at];
        let mut responses: Option<Responses<R>> = None;
        for k in first..end {
            let h = self.record.knot(k + 1) - self.record.knot(k);
            if h.value > self.reach {
                break;
            }
            let by = Responses::over(&self.oscillator, h, responses.as_ref());
            responses = Some(by);
            let [value, next] = [k, k + 1].map(|k| self.record.value(k));
            let slope = (next - value) / h;
            let equation = &self.oscillator.equation;
            at = by.next(equation, &at, [value, slope], self.record.acts);
            (at.time, at.force) = (self.record.knot(k + 1) - begin, self.force(k + 1));
            points.push(at);
        }
        let plain = Plain::of(&points);
        Block { points, plain, forms: OnceLock::new() }
    }

    /// Largest |a_g|.
    pub(crate) fn largest_base(&self) -> R {
        match self.record.acts {
            Acts::Primary => R::ZERO,
            Acts::Base => self.record.largest(0),
        }
    }

    /// f/M at a point.
    fn force(&self, index: usize) -> DoubleDouble<R> {
        match self.record.acts {
            Acts::Primary => self.record.value(index),
            Acts::Base => DoubleDouble::ZERO,
        }
    }
}

impl<R: Real> Responses<R> {
    /// The responses over a piece, from those over one that is nearly as long if there are such.
    fn over(oscillator: &Oscillator<R>, h: DoubleDouble<R>, like: Option<&Self>) -> Self {
        let Equation { damping, .. } = oscillator.equation;
        let differs = |like: &&Self| (h - like.h).value.abs() <= h.value * ALIKE;
        if let Some(like) = like.filter(differs) {
            return like.longer(damping, h);
        }
        let (one, zero) = (DoubleDouble::new(R::ONE), DoubleDouble::ZERO);
        let p = oscillator.precise(zero, one, h.value);
        let q = oscillator.precise(one, zero, h.value);
        let plain = DoubleDouble::new(h.value);
        Self { h: plain, p, q, s: plain - p.times(damping) + q }.longer(damping, h)
    }

    /// The responses over a piece that is longer or shorter by very little, by their Taylor series.
    fn longer(&self, damping: R, h: DoubleDouble<R>) -> Self {
        let Self { p, q, s, .. } = *self;
        let by = h - self.h;
        let half = by.half();
        let even = DoubleDouble::new(R::ONE) - p;
        let slope = even - s.times(damping);
        Self {
            h,
            p: p + (s + slope * half) * by,
            q: q - (p + s * half) * by,
            s: s + (slope - (s + slope.times(damping)) * half) * by,
        }
    }

    /// The responses at the end of a piece in which f/M or a_g is linear.
    fn next(
        &self,
        equation: &Equation<R>,
        at: &At<R>,
        [value, slope]: [DoubleDouble<R>; 2],
        acts: Acts,
    ) -> At<R> {
        let Self { h, p, q, s } = *self;
        let c = DoubleDouble::new(R::ONE) - p;
        let damped = |c: DoubleDouble<R>, s: DoubleDouble<R>| c - s.times(equation.damping);
        let s_slope = damped(c, s);
        let moved = |x: DoubleDouble<R>, v: DoubleDouble<R>| Primary {
            x: c * x + s * v,
            v: s_slope * v - s * x,
        };
        // From rest under a load that begins with `value`: P and S; −Q = ∫P.
        let Primary { x, v } = moved(at.forced.x, at.forced.v);
        let (by_load, faster) = (value * p - slope * q, value * s + slope * p);
        let (forced, mut base) = match acts {
            Acts::Primary => (Primary { x: x + by_load, v: v + faster }, at.base),
            Acts::Base => (Primary { x: x - by_load, v: v - faster }, at.base),
        };
        if acts == Acts::Base {
            let (half, third) = (h.half(), equation.third);
            let gained = (value + slope * half) * h;
            let bent = (value + slope * h * third) * h * half;
            base = Primary { x: base.x + base.v * h + bent, v: base.v + gained };
        }
        let (even, odd) = (moved(at.c, -at.s), moved(at.s, at.slope));
        let (c, s) = (even.x, odd.x);
        let slope = damped(c, s);
        let over = DoubleDouble::new(R::ONE) / (c * slope + s * s);
        At { forced, c, s, slope, over, base, ..*at }
    }
}

impl<R: Real> Block<R> {
    /// The number of its points, its end included.
    pub(crate) fn count(&self) -> usize {
        self.points.len()
    }

    /// The responses to one of its points.
    #[inline(always)]
    pub(crate) fn at(&self, point: usize) -> &At<R> {
        &self.points[point]
    }
}

impl<R: Real> At<R> {
    /// Displacement and velocity at the point, from those at the first point.
    #[inline(always)]
    pub(crate) fn reached(&self, from: &Primary<R>) -> Primary<R> {
        let Primary { x, v } = *from;
        let Self { forced, c, s, slope, .. } = self;
        Primary { x: forced.x + (*c * x + *s * v), v: forced.v + (*slope * v - *s * x) }
    }

    /// Displacement and velocity at the first point that lead to these at the point.
    #[inline(always)]
    pub(crate) fn traced(&self, to: &Primary<R>) -> Primary<R> {
        let Self { forced, c, s, slope, over, .. } = self;
        let (x, v) = (to.x - forced.x, to.v - forced.v);
        Primary { x: (*slope * x - *s * v) * *over, v: (*c * v + *s * x) * *over }
    }
}

impl Plain {
    /// The points in plain numbers.
    fn of<R: Real>(points: &[At<R>]) -> Self {
        let column = |of: &dyn Fn(&At<R>) -> DoubleDouble<R>| {
            std::array::from_fn(|k| points.get(k).map_or(0.0, |at| of(at).value.double()))
        };
        let time = column(&|at| at.time);
        let base = column(&|at| at.base.x);
        let largest =
            |all: &[f64; POINTS]| all.iter().fold(0.0, |most: f64, it| most.max(it.abs()));
        let pieces = time.windows(2).map(|ends| ends[1] - ends[0]);
        Self {
            count: points.len(),
            longest: pieces.fold(0.0, f64::max),
            reach: [&time, &base].map(largest),
            time,
            c: column(&|at| at.c),
            s: column(&|at| at.s),
            slope: column(&|at| at.slope),
            x: column(&|at| at.forced.x),
            v: column(&|at| at.forced.v),
            both: column(&|at| at.forced.x + at.base.x),
            force: column(&|at| at.force),
        }
    }
}

impl Plain {
    /// The sizes of a quantity at all points, from x and ẋ at the first one; `damping` is 2ζ.
    #[inline(always)]
    pub fn sizes(&self, of: Quantity, [x, v, damping]: [f64; 3]) -> [f64; POINTS] {
        let mut sizes = [0.0; POINTS];
        for (k, size) in sizes.iter_mut().enumerate() {
            let place = self.c[k].mul_add(x, self.s[k].mul_add(v, self.x[k]));
            let speed = self.slope[k].mul_add(v, (-self.s[k]).mul_add(x, self.v[k]));
            *size = match of {
                Quantity::Displacement => place.abs(),
                Quantity::Acceleration => (self.force[k] - damping.mul_add(speed, place)).abs(),
            };
        }
        sizes
    }
}
