//! Φ of the lengths of leaps, each twice the one before, and the columns of what feeds the structure: what they are made of, and their
//! products with a state.

use super::Modal;
use std::sync::OnceLock;

use super::columns::{Column, Wave, column, turning, twice, units};
use super::drive::{Aside, Pushed};
use super::forms::Forms;
use super::regime::Regime;
use super::state::{Modes, Place};
use crate::absorber::Clock;
use crate::force::Acts;
use crate::host::Host;
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::real::Real;
use crate::segment::taylor::ORDER;

/// Longest leap, in units of 1/ω of the slowest mode.
const LONGEST: f64 = 1.5;
/// Largest number of lengths.
const LEVELS: usize = 11;
/// Largest number of coupled modes for which Φ is worth its price.
const MOST_COUPLED: usize = 8;
/// Largest number of harmonic parts of a drive that leaps take.
pub(super) const MOST_WAVES: usize = 4;

/// Φ of each length, the shortest first.
#[derive(Debug, Clone)]
pub(super) struct Leaps<R> {
    pub shortest: R,
    pub levels: Vec<Propagator<R>>,
    /// Made when losses are first asked for.
    pub forms: OnceLock<Forms<R>>,
}

/// Φ of one length, high and low parts: column by column, or, of separate modes, its four diagonals.
#[derive(Debug, Clone)]
pub(super) struct Propagator<R> {
    length: R,
    high: Vec<R>,
    low: Vec<R>,
    /// c of each mass; empty of one that nothing pulls.
    falls: Vec<Vec<DoubleDouble<R>>>,
    waves: Vec<Wave<R>>,
}

/// What feeds a structure from an instant on.
#[derive(Clone, Copy)]
pub(super) struct Feed<R, const N: usize> {
    /// G + s R of each mass.
    pub pulls: [DoubleDouble<R>; N],
    /// a cos θ and −a sin θ of each harmonic part a cos(Ωt + θ) of the drive: the factors of cos Ωt and sin Ωt.
    pub waves: [[DoubleDouble<R>; 2]; MOST_WAVES],
}

/// z: all q, then all q̇ at once, in high and low parts; and how far the base has moved since the begin of a coast, beyond a uniform motion.
#[derive(Clone, Copy)]
pub(super) struct Flown<R, const M: usize> {
    high: [[R; M]; 2],
    low: [[R; M]; 2],
    pub base: [DoubleDouble<R>; 2],
}

impl<R: Real> Leaps<R> {
    /// The time that some of the shortest leaps take.
    pub(super) fn time(&self, steps: usize) -> Clock<R> {
        DoubleDouble::new(self.shortest).times(steps as f64)
    }
}

impl<R: Real, const M: usize> Flown<R, M> {
    const REST: Self =
        Self { high: [[R::ZERO; M]; 2], low: [[R::ZERO; M]; 2], base: [DoubleDouble::ZERO; 2] };

    pub(super) fn of(modes: &Modes<R, M>, n: usize) -> Self {
        let mut flown = Self::REST;
        let both = modes.places[..n].iter().chain(&modes.velocities[..n]);
        both.enumerate().for_each(|(i, part)| flown.set(i, *part));
        flown
    }

    pub(super) fn modes(&self, n: usize) -> Modes<R, M> {
        let mut modes = Modes::REST;
        for j in 0..n {
            (modes.places[j], modes.velocities[j]) = (self.get(j), self.get(n + j));
        }
        modes
    }

    /// High and low parts of so many numbers.
    #[inline(always)]
    pub(super) fn parts(&self, size: usize) -> [&[R]; 2] {
        [&self.high, &self.low].map(|part| &part.as_flattened()[..size])
    }

    #[inline(always)]
    fn parts_mut(&mut self, size: usize) -> [&mut [R]; 2] {
        [&mut self.high, &mut self.low].map(|part| &mut part.as_flattened_mut()[..size])
    }

    fn get(&self, i: usize) -> DoubleDouble<R> {
        let [high, low] = self.parts(2 * M);
        DoubleDouble { value: high[i], rest: low[i] }
    }

    fn set(&mut self, i: usize, part: DoubleDouble<R>) {
        let [high, low] = self.parts_mut(2 * M);
        (high[i], low[i]) = (part.value, part.rest);
    }
}

/// a x + b y in double-double.
#[inline(always)]
fn combined<R: Real>([a, x]: [[R; 2]; 2], [b, y]: [[R; 2]; 2]) -> [R; 2] {
    let ((p, p_lost), (r, r_lost)) = (two_product(a[0], x[0]), two_product(b[0], y[0]));
    let small =
        (a[0].mul_add(x[1], a[1] * x[0]) + p_lost) + (b[0].mul_add(y[1], b[1] * y[0]) + r_lost);
    let (sum, lost) = two_sum(p, r);
    let rest = lost + small;
    let value = sum + rest;
    [value, rest - (value - sum)]
}

impl<R: Real> Propagator<R> {
    /// Φ z of separate modes.
    #[inline(always)]
    fn turn<const M: usize>(&self, n: usize, z: &Flown<R, M>, to: &mut Flown<R, M>) {
        let of = |part: usize| (&self.high[part * n..][..n], &self.low[part * n..][..n]);
        let ([a, b], [c, d]) = ([of(0), of(1)], [of(2), of(3)]);
        let [(q, v), (ql, vl)] = z.parts(2 * n).map(|part| part.split_at(n));
        let [(to_q, to_v), (to_ql, to_vl)] = to.parts_mut(2 * n).map(|part| part.split_at_mut(n));
        for j in 0..n {
            let (q, v) = ([q[j], ql[j]], [v[j], vl[j]]);
            let at = |part: (&[R], &[R])| [part.0[j], part.1[j]];
            [to_q[j], to_ql[j]] = combined([at(a), q], [at(b), v]);
            [to_v[j], to_vl[j]] = combined([at(c), q], [at(d), v]);
        }
    }

    /// Φ z of coupled modes.
    #[inline(always)]
    fn product<const M: usize>(&self, size: usize, z: &Flown<R, M>, to: &mut Flown<R, M>) {
        let mut sum = Flown::<R, M>::REST;
        let [sums, rests] = sum.parts_mut(size);
        let [z, z_low] = z.parts(size);
        let columns = self.high.chunks_exact(size).zip(self.low.chunks_exact(size));
        for (j, (high, low)) in columns.enumerate() {
            let [x, xl] = [z[j], z_low[j]];
            for i in 0..size {
                let (p, lost) = two_product(high[i], x);
                let small = high[i].mul_add(xl, low[i] * x) + lost;
                let (s, rest) = two_sum(sums[i], p);
                (sums[i], rests[i]) = (s, rests[i] + (rest + small));
            }
        }
        for i in 0..size {
            let value = sums[i] + rests[i];
            to.set(i, DoubleDouble { value, rest: rests[i] - (value - sums[i]) });
        }
    }

    /// Φ(2h) from Φ(h).
    fn squared<const M: usize>(&self, n: usize, separate: bool) -> Self {
        let mut square = self.clone();
        let (mut z, mut to) = (Flown::<R, M>::REST, Flown::<R, M>::REST);
        // The columns of Φ are states; of separate modes all first columns are one state, and all second ones.
        let columns = if separate { 2 } else { 2 * n };
        for column in 0..columns {
            let place = |i: usize| match separate {
                true => (2 * (i / n) + column) * n + i % n,
                false => column * 2 * n + i,
            };
            for i in 0..2 * n {
                let (value, rest) = (self.high[place(i)], self.low[place(i)]);
                z.set(i, DoubleDouble { value, rest });
            }
            self.multiply(n, separate, &z, &mut to);
            for i in 0..2 * n {
                let DoubleDouble { value, rest } = to.get(i);
                (square.high[place(i)], square.low[place(i)]) = (value, rest);
            }
        }
        let mut carry = |column: &[DoubleDouble<R>]| -> Vec<DoubleDouble<R>> {
            column.iter().enumerate().for_each(|(i, part)| z.set(i, *part));
            self.multiply(n, separate, &z, &mut to);
            (0..2 * n).map(|i| to.get(i)).collect()
        };
        for fall in square.falls.iter_mut().filter(|fall| !fall.is_empty()) {
            let carried = carry(fall);
            fall.iter_mut().zip(carried).for_each(|(part, carried)| *part = *part + carried);
        }
        for (wave, half) in square.waves.iter_mut().zip(&self.waves) {
            let ([c, s], [cosine, sine]) = (half.turn, &half.columns);
            wave.turn = [c * c - s * s, (c * s).times(2.0)];
            // In the second half the drive is cos Ω(h + t) = c cos Ωt − s sin Ωt, or sin Ω(h + t) = s cos Ωt + c sin Ωt.
            for (column, first, by) in [(0, cosine, [c, -s]), (1, sine, [s, c])] {
                let second = |a, b| by[0] * a + by[1] * b;
                let column = &mut wave.columns[column];
                column.modes = carry(&first.modes);
                let both = cosine.modes.iter().zip(&sine.modes);
                for (part, (a, b)) in column.modes.iter_mut().zip(both) {
                    *part = *part + second(*a, *b);
                }
                let moved = [first.base[0] + first.base[1].times(self.length), first.base[1]];
                column.base =
                    std::array::from_fn(|i| moved[i] + second(cosine.base[i], sine.base[i]));
            }
        }
        square.length = self.length * 2.0;
        square
    }

    /// Φ z.
    #[inline(always)]
    fn multiply<const M: usize>(
        &self,
        n: usize,
        separate: bool,
        z: &Flown<R, M>,
        to: &mut Flown<R, M>,
    ) {
        if separate { self.turn(n, z, to) } else { self.product(2 * n, z, to) }
    }

    /// Φ z, and what the feed does.
    #[inline(always)]
    pub(super) fn apply<const M: usize, const N: usize>(
        &self,
        (n, separate): (usize, bool),
        z: &Flown<R, M>,
        to: &mut Flown<R, M>,
        feed: &Feed<R, N>,
    ) {
        self.multiply(n, separate, z, to);
        let mut add = |factor: DoubleDouble<R>, column: &[DoubleDouble<R>]| {
            for (i, part) in column.iter().enumerate() {
                to.set(i, factor * *part + to.get(i));
            }
        };
        let pulled = self.falls.iter().zip(&feed.pulls).filter(|(_, pull)| pull.value != 0.0);
        pulled.for_each(|(fall, pull)| add(*pull, fall));
        if self.waves.is_empty() {
            return;
        }
        let mut base = [z.base[0] + z.base[1].times(self.length), z.base[1]];
        for (wave, factors) in self.waves.iter().zip(feed.waves) {
            for (column, factor) in wave.columns.iter().zip(factors) {
                add(factor, &column.modes);
                base = std::array::from_fn(|i| base[i] + factor * column.base[i]);
            }
        }
        to.base = base;
    }

    /// The feed after this length.
    #[inline(always)]
    pub(super) fn turned<const N: usize>(&self, feed: &Feed<R, N>) -> Feed<R, N> {
        let mut later = *feed;
        for (wave, [cosine, sine]) in self.waves.iter().zip(&mut later.waves) {
            let [c, s] = wave.turn;
            (*cosine, *sine) = (*cosine * c + *sine * s, *sine * c - *cosine * s);
        }
        later
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// Φ of all lengths; `None` where leaps are not worth their price.
    pub(super) fn leaps(&self) -> Option<&Leaps<R>> {
        let n = self.whole.count();
        let smooth = self.host.force().is_none_or(|force| force.records().is_empty());
        let fits = smooth && self.waves().count() <= MOST_WAVES;
        if !fits || !(self.whole.is_separate() || n <= MOST_COUPLED) {
            return None;
        }
        Some(self.leaps.get_or_init(|| self.all_leaps()))
    }

    fn all_leaps(&self) -> Leaps<R> {
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        let shortest = self.reach;
        let stiffness = self.whole.stiffness.iter().map(|square| square.value);
        let slowest = stiffness.filter(|square| *square > 0.0).fold(R::INFINITY, R::min).sqrt();
        let longest = if slowest.is_finite() { R::from(LONGEST) / slowest } else { shortest };
        let mut levels = vec![self.shortest_leap(shortest, separate)];
        let mut length = shortest * 2.0;
        while length <= longest && levels.len() < LEVELS {
            let next = levels[levels.len() - 1].squared::<M>(n, separate);
            levels.push(next);
            length *= 2.0;
        }
        Leaps { shortest, levels, forms: OnceLock::new() }
    }

    /// Φ of one length from power series of the unit vectors.
    fn shortest_leap(&self, length: R, separate: bool) -> Propagator<R> {
        let n = self.whole.count();
        let mut free = self.regime(&[Place::FAR; N]);
        free.pulls = [DoubleDouble::ZERO; N];
        let unit = R::power_of_two(length);
        let columns = if separate { 2 } else { 2 * n };
        let size = columns * 2 * n;
        let (high, low) = (vec![R::ZERO; size], vec![R::ZERO; size]);
        let (falls, waves) = (vec![vec![]; self.count()], vec![]);
        let mut whole = Propagator { length, high, low, falls, waves };
        let ends = |modes: &Modes<R, M>,
                    regime: &Regime<'_, R, N>,
                    fed: &[Pushed<R>],
                    asides: &[Aside<R>]| {
            let rows = self.series_fed(modes, regime, (fed, asides), unit);
            rows.modes::<M>(n, length / unit, unit)
        };
        let mut still = [[DoubleDouble::ZERO; 3]; ORDER + 1];
        still[0][2] = DoubleDouble::new(R::ONE);
        for (column, modes) in units(n, separate).enumerate() {
            let ends = ends(&modes, &free, &still, &[]);
            for j in 0..n {
                let (q, v) = (ends.places[j], ends.velocities[j]);
                for (i, end) in [(j, q), (n + j, v)] {
                    let at =
                        if separate { (2 * (i / n) + column) * n + j } else { column * 2 * n + i };
                    (whole.high[at], whole.low[at]) = (end.value, end.rest);
                }
            }
        }
        for k in (0..self.count()).filter(|k| self.gravity[*k] != 0.0 || self.friction[*k] != 0.0) {
            let mut pulled = free.clone();
            pulled.pulls[k] = DoubleDouble::new(R::ONE);
            whole.falls[k] = column(&ends(&Modes::REST, &pulled, &still, &[]), n);
        }
        for (harmonic, point) in self.waves() {
            let based = harmonic.acts == Acts::Base;
            let columns = turning(DoubleDouble::new(harmonic.frequency).times(unit)).map(|row| {
                let zero = DoubleDouble::ZERO;
                let fed = row.map(|part| [zero, if based { part } else { zero }, zero]);
                let aside: &[Aside<R>] = if based { &[] } else { &[(point, row)] };
                let modes = column(&ends(&Modes::REST, &free, &fed, aside), n);
                let base = if based { twice(&row, length, unit) } else { [DoubleDouble::ZERO; 2] };
                Column { modes, base }
            });
            let (s, c) = R::precise_sincos(DoubleDouble::new(harmonic.frequency).times(length));
            whole.waves.push(Wave { turn: [c, s], columns });
        }
        whole
    }
}
