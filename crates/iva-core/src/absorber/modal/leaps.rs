//! Leaps: the motion of an undriven structure over lengths each of which is twice the one before, of which everything but the
//! state is known beforehand.
//!
//! While no mass is stuck or held, z = (q, q̇) moves by z(t + h) = Φ(h) z(t) + Σ pₖ cₖ(h), where cₖ is what a mass that is pulled with an acceleration 1 does to a structure
//! at rest, and pₖ = Gₖ + sₖ Rₖ. Φ and c of the shortest length are power series of `modal/equations.rs`, Φ from each unit vector without pulls; of twice the length they are
//! Φ² and Φ c + c. All are in double-double. Modes that exchange no energy have
//! blocks of 2 × 2.
//!
//! **Proof that a leap meets no wall** ([`Modal::coasts`]). The distance of a mass to its wall is D = L + s φ·q, with L linear in t, or quadratic where gravity acts on the mass alone.
//! From D and Ḋ at both ends and a bound on D⁗ follows whether it stays between the walls ([`stays_clear_by`]). The bound is that of the
//! energy of the third derivative, which never grows: it holds for all leaps of a coast, and a fast mode that hardly moves does not
//! shorten them. Where it proves nothing a leap of half the length is tried. A leap begins at a multiple of its length, so
//! that a length that failed is not tried again at once.
//!
//! Where the shortest leap proves nothing, a wall is near: the power series of [`super::ModalMotion`] finds the contact.

use super::equations::Regime;
use super::series::EXACT;
use super::state::{Modes, Place};
use super::structure::Damping;
use super::{MOST_MODES, Modal, ModalState};
use crate::absorber::{Clock, Coasted};
use crate::force::Force;
use crate::host::Host;
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::real::Real;
use crate::segment::contact::stays_clear_by;
use crate::segment::taylor::ORDER;

/// Longest leap, in units of 1/ω of the slowest mode.
const LONGEST: f64 = 1.5;
/// Largest number of lengths.
const LEVELS: usize = 12;
/// Largest number of coupled modes for which Φ is worth its price.
const MOST_COUPLED: usize = 8;
/// Largest number of leaps in one coast: whoever looks within one is shown each of its steps from its begin.
const MOST_LEAPS: usize = 16;

/// Φ of each length, the shortest first.
#[derive(Debug, Clone)]
pub(super) struct Leaps<R> {
    shortest: R,
    levels: Vec<Propagator<R>>,
}

/// Φ of one length, high and low parts: column by column, or, of separate modes, its four diagonals.
#[derive(Debug, Clone)]
struct Propagator<R> {
    high: Vec<R>,
    low: Vec<R>,
    /// c of each mass; empty of one that nothing pulls.
    falls: Vec<Vec<DoubleDouble<R>>>,
}

/// z: all q, then all q̇, in high and low parts.
#[derive(Clone, Copy)]
struct Flown<R> {
    high: [R; 2 * MOST_MODES],
    low: [R; 2 * MOST_MODES],
}

/// What the distance of a mass is, beside the motion of its point: L with its two derivatives, and the sign of its wall.
#[derive(Clone, Copy, Default)]
struct Line<R> {
    begin: R,
    rate: R,
    bend: R,
    side: R,
}

/// A mass at one instant: distance and rate, and the sizes of the terms that each of them is the sum of.
#[derive(Clone, Copy, Default)]
struct Sight<R> {
    distance: [R; 2],
    sizes: [R; 2],
}

impl<R: Real> Sight<R> {
    /// The size of what a leap of this length from here to there is judged by.
    #[inline(always)]
    fn size(&self, to: &Self, length: R) -> R {
        let larger = |i: usize| R::larger(self.sizes[i], to.sizes[i]);
        length.mul_add(larger(1), larger(0))
    }
}

impl<R: Real> Leaps<R> {
    /// The time that some of the shortest leaps take.
    fn time(&self, steps: usize) -> Clock<R> {
        DoubleDouble::new(self.shortest).times(steps as f64)
    }
}

impl<R: Real> Flown<R> {
    fn of(modes: &Modes<R>, n: usize) -> Self {
        let mut flown = Self { high: [R::ZERO; 2 * MOST_MODES], low: [R::ZERO; 2 * MOST_MODES] };
        let both = modes.places[..n].iter().chain(&modes.velocities[..n]);
        for ((high, low), part) in flown.high.iter_mut().zip(&mut flown.low).zip(both) {
            (*high, *low) = (part.value, part.rest);
        }
        flown
    }

    fn modes(&self, n: usize) -> Modes<R> {
        let mut modes = Modes::REST;
        for j in 0..n {
            modes.places[j] = DoubleDouble { value: self.high[j], rest: self.low[j] };
            modes.velocities[j] = DoubleDouble { value: self.high[n + j], rest: self.low[n + j] };
        }
        modes
    }
}

/// The sums of some numbers of each mode, in four parts that do not wait for each other.
#[inline(always)]
fn summed<R: Real, const K: usize>(n: usize, of: impl Fn(usize) -> [R; K]) -> [R; K] {
    let mut parts = [[R::ZERO; 4]; K];
    let whole = n - n % 4;
    for j in (0..whole).step_by(4).chain(whole..n) {
        for i in 0..if j < whole { 4 } else { 1 } {
            for (part, number) in parts.iter_mut().zip(of(j + i)) {
                part[i] += number;
            }
        }
    }
    parts.map(|[a, b, c, d]| (a + b) + (c + d))
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
    fn turn(&self, n: usize, z: &Flown<R>, to: &mut Flown<R>) {
        let of = |part: usize| (&self.high[part * n..][..n], &self.low[part * n..][..n]);
        let ([a, b], [c, d]) = ([of(0), of(1)], [of(2), of(3)]);
        let ((q, v), (ql, vl)) = (z.high[..2 * n].split_at(n), z.low[..2 * n].split_at(n));
        let ((to_q, to_v), (to_ql, to_vl)) =
            (to.high[..2 * n].split_at_mut(n), to.low[..2 * n].split_at_mut(n));
        for j in 0..n {
            let (q, v) = ([q[j], ql[j]], [v[j], vl[j]]);
            let at = |part: (&[R], &[R])| [part.0[j], part.1[j]];
            [to_q[j], to_ql[j]] = combined([at(a), q], [at(b), v]);
            [to_v[j], to_vl[j]] = combined([at(c), q], [at(d), v]);
        }
    }

    /// Φ z of coupled modes.
    #[inline(always)]
    fn product(&self, size: usize, z: &Flown<R>, to: &mut Flown<R>) {
        let mut sum = Flown { high: [R::ZERO; 2 * MOST_MODES], low: [R::ZERO; 2 * MOST_MODES] };
        let columns = self.high.chunks_exact(size).zip(self.low.chunks_exact(size));
        for (j, (high, low)) in columns.enumerate() {
            let [x, xl] = [z.high[j], z.low[j]];
            let (sums, rests) = (&mut sum.high[..size], &mut sum.low[..size]);
            for i in 0..size {
                let (p, lost) = two_product(high[i], x);
                let small = high[i].mul_add(xl, low[i] * x) + lost;
                let (s, rest) = two_sum(sums[i], p);
                (sums[i], rests[i]) = (s, rests[i] + (rest + small));
            }
        }
        for i in 0..size {
            let value = sum.high[i] + sum.low[i];
            (to.high[i], to.low[i]) = (value, sum.low[i] - (value - sum.high[i]));
        }
    }

    /// Φ(2h) from Φ(h).
    fn squared(&self, n: usize, separate: bool) -> Self {
        let mut square = self.clone();
        let rest = [R::ZERO; 2 * MOST_MODES];
        let (mut z, mut to) = (Flown { high: rest, low: rest }, Flown { high: rest, low: rest });
        // The columns of Φ are states; of separate modes all first columns are one state, and all second ones.
        let columns = if separate { 2 } else { 2 * n };
        for column in 0..columns {
            let place = |i: usize| match separate {
                true => (2 * (i / n) + column) * n + i % n,
                false => column * 2 * n + i,
            };
            for i in 0..2 * n {
                (z.high[i], z.low[i]) = (self.high[place(i)], self.low[place(i)]);
            }
            self.multiply(n, separate, &z, &mut to);
            for i in 0..2 * n {
                (square.high[place(i)], square.low[place(i)]) = (to.high[i], to.low[i]);
            }
        }
        for fall in square.falls.iter_mut().filter(|fall| !fall.is_empty()) {
            for (i, part) in fall.iter().enumerate() {
                (z.high[i], z.low[i]) = (part.value, part.rest);
            }
            self.multiply(n, separate, &z, &mut to);
            for (i, part) in fall.iter_mut().enumerate() {
                *part = *part + DoubleDouble { value: to.high[i], rest: to.low[i] };
            }
        }
        square
    }

    /// Φ z.
    #[inline(always)]
    fn multiply(&self, n: usize, separate: bool, z: &Flown<R>, to: &mut Flown<R>) {
        if separate { self.turn(n, z, to) } else { self.product(2 * n, z, to) }
    }

    /// Φ z + Σ p c.
    #[inline(always)]
    fn apply(
        &self,
        (n, separate): (usize, bool),
        z: &Flown<R>,
        to: &mut Flown<R>,
        pulls: &[DoubleDouble<R>],
    ) {
        self.multiply(n, separate, z, to);
        for (fall, pull) in self.falls.iter().zip(pulls).filter(|(_, pull)| pull.value != 0.0) {
            for ((high, low), part) in to.high.iter_mut().zip(&mut to.low).zip(fall) {
                let sum = *pull * *part + DoubleDouble { value: *high, rest: *low };
                (*high, *low) = (sum.value, sum.rest);
            }
        }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Modal<H, N> {
    /// Φ of all lengths; `None` where leaps are not worth their price.
    fn leaps(&self) -> Option<&Leaps<R>> {
        let n = self.whole.count();
        let free = self.host.force().is_none_or(Force::is_none);
        if !free || !(self.whole.is_separate() || n <= MOST_COUPLED) {
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
            let next = levels[levels.len() - 1].squared(n, separate);
            levels.push(next);
            length *= 2.0;
        }
        Leaps { shortest, levels }
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
        let mut whole = Propagator { high, low, falls: vec![vec![]; self.count] };
        let ends = |modes: &Modes<R>, regime: &Regime<'_, R, N>| {
            let gravity = |m: usize| DoubleDouble::new(if m == 0 { R::ONE } else { R::ZERO });
            let still = |m: usize| [DoubleDouble::ZERO, DoubleDouble::ZERO, gravity(m)];
            let rows = self.series(modes, regime, still, unit, (ORDER, EXACT));
            rows.modes(length / unit, unit)
        };
        for column in 0..columns {
            let mut modes = Modes::REST;
            for j in 0..n {
                let [q, v] = if separate {
                    [column == 0, column == 1]
                } else {
                    [column == j, column == n + j]
                };
                let one = |which: bool| DoubleDouble::new(if which { R::ONE } else { R::ZERO });
                (modes.places[j], modes.velocities[j]) = (one(q), one(v));
            }
            let ends = ends(&modes, &free);
            for j in 0..n {
                let (q, v) = (ends.places[j], ends.velocities[j]);
                for (i, end) in [(j, q), (n + j, v)] {
                    let at =
                        if separate { (2 * (i / n) + column) * n + j } else { column * 2 * n + i };
                    (whole.high[at], whole.low[at]) = (end.value, end.rest);
                }
            }
        }
        for k in (0..self.count).filter(|k| self.gravity[*k] != 0.0 || self.friction[*k] != 0.0) {
            let mut pulled = free;
            pulled.pulls[k] = DoubleDouble::new(R::ONE);
            let Modes { places, velocities } = ends(&Modes::REST, &pulled);
            whole.falls[k] = places[..n].iter().chain(&velocities[..n]).copied().collect();
        }
        whole
    }

    /// The derivatives 2 to 4 of all modes while no mass is stuck or held.
    fn bent(&self, z: &Flown<R>, pulls: &[DoubleDouble<R>; N]) -> [[R; MOST_MODES]; 3] {
        let n = self.whole.count();
        let next = |low: &[R], high: &[R]| -> [R; MOST_MODES] {
            let mut bent = [R::ZERO; MOST_MODES];
            for (j, bent) in bent[..n].iter_mut().enumerate() {
                let damped = match &self.whole.damping {
                    Damping::Separate(rates) => rates[j].value * high[j],
                    Damping::Full(matrix) => {
                        let row = matrix[j * n..(j + 1) * n].iter().zip(high);
                        row.fold(R::ZERO, |sum, (element, v)| element.mul_add(*v, sum))
                    }
                };
                *bent = -self.whole.stiffness[j].value.mul_add(low[j], damped);
            }
            for (spring, shape) in &self.whole.springs {
                let both = shape.iter().zip(low);
                let stretched = both.fold(R::ZERO, |sum, (phi, q)| phi.mul_add(*q, sum));
                for (bent, phi) in bent.iter_mut().zip(shape) {
                    *bent -= *spring * stretched * *phi;
                }
            }
            bent
        };
        let mut second = next(&z.high[..n], &z.high[n..2 * n]);
        for (k, pull) in pulls.iter().enumerate().filter(|(_, pull)| pull.value != 0.0) {
            let weight = self.masses[k].mass_ratio * pull.value;
            for (bent, phi) in second.iter_mut().zip(self.gap_shape(k)) {
                *bent = phi.mul_add(weight, *bent);
            }
        }
        let third = next(&z.high[n..2 * n], &second);
        [second, third, next(&second, &third)]
    }

    /// A mass at an instant of a coast.
    #[inline(always)]
    fn sight(&self, shape: &[R], line: &Line<R>, time: R, z: &Flown<R>) -> Sight<R> {
        let n = shape.len();
        let (q, v) = z.high[..2 * n].split_at(n);
        let of = |j: usize| {
            let [u, rate] = [shape[j] * q[j], shape[j] * v[j]];
            [u, rate, u.abs(), rate.abs()]
        };
        let [u, rate, size, speed] = summed(n, of);
        let [sums, sizes] = [[u, rate], [size, speed]];
        let gained = line.bend * time;
        let straight = [(gained * 0.5 + line.rate).mul_add(time, line.begin), line.rate + gained];
        let along = |i: usize| line.side.mul_add(sums[i], straight[i]);
        let size = |i: usize| sizes[i] + straight[i].abs();
        Sight { distance: [along(0), along(1)], sizes: [size(0), size(1)] }
    }

    /// How many of the shortest leaps are proved to meet no wall, and the state after them.
    pub(super) fn leap(
        &self,
        state: &ModalState<H, N>,
        remaining: R,
    ) -> (usize, Coasted<ModalState<H, N>, R>) {
        let none = (0, (*state, Clock::ZERO));
        // Before all else, so that nothing of it is compiled for numbers that take every step.
        if !R::FAST_PATHS {
            return none;
        }
        let carried = state.places[..self.count].iter().any(Place::carried);
        let Some(leaps) = self.leaps().filter(|_| !carried) else { return none };
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        // Begin and end of a leap, in turns.
        let mut flown = [Flown::of(&state.modes, n); 2];
        let [mut z, mut to] = flown.each_mut();
        let Regime { stuck: free, pulls } = self.regime(&state.places);
        let derivatives = self.bent(z, &pulls);
        let mut lines = [Line::default(); N];
        let [mut thirds, mut fourths] = [[R::ZERO; N]; 2];
        let mut now = [Sight::default(); N];
        for k in 0..self.count {
            let (place, shape) = (&state.places[k], self.gap_shape(k));
            let still = Line {
                side: place.side,
                bend: place.side * self.falling(k, place).value,
                ..Line::default()
            };
            let Sight { distance: [u, rate], sizes } = self.sight(shape, &still, R::ZERO, z);
            let distance = [place.distance.value, place.rate.value];
            lines[k] = Line { begin: distance[0] - u, rate: distance[1] - rate, ..still };
            now[k] = Sight { distance, sizes };
            let bound = |n: usize| {
                let of = |j: usize| [derivatives[n - 2][j], derivatives[n - 1][j]];
                self.bound(of, free, self.followed(k, place), n, R::ZERO)
            };
            fourths[k] = bound(3);
            if self.friction[k] != 0.0 {
                thirds[k] = bound(2);
            }
        }
        let mut then = now;
        let top = leaps.levels.len() - 1;
        let (mut count, mut level) = (0_usize, top);
        for _ in 0..MOST_LEAPS {
            let found = loop {
                let length = leaps.shortest * (1_u64 << level) as f64;
                let end = leaps.shortest * (count + (1 << level)) as f64;
                if end < remaining {
                    leaps.levels[level].apply((n, separate), z, to, &pulls);
                    let clear = (0..self.count).all(|k| {
                        then[k] = self.sight(self.gap_shape(k), &lines[k], end, to);
                        let ends = [now[k].distance, then[k].distance];
                        let clearance = self.masses[k].clearance;
                        let size = clearance + now[k].size(&then[k], length);
                        stays_clear_by(ends, clearance, size, fourths[k], length)
                            && (self.friction[k] == 0.0
                                || self.slides_on(k, &state.places[k], ends, [thirds[k], length]))
                    });
                    if clear {
                        break true;
                    }
                }
                if level == 0 {
                    break false;
                }
                level -= 1;
            };
            if !found {
                break;
            }
            std::mem::swap(&mut z, &mut to);
            now = then;
            count += 1 << level;
            level = top.min(count.trailing_zeros() as usize);
        }
        if count == 0 {
            return none;
        }
        let time = leaps.time(count);
        (count, (self.landed(state, z, time), time))
    }

    /// The state after some of the shortest leaps.
    pub(super) fn leapt(
        &self,
        state: &ModalState<H, N>,
        steps: usize,
    ) -> Coasted<ModalState<H, N>, R> {
        if !R::FAST_PATHS {
            return (*state, Clock::ZERO);
        }
        let Some(leaps) = self.leaps() else { return (*state, Clock::ZERO) };
        let Regime { pulls, .. } = self.regime(&state.places);
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        let mut flown = [Flown::of(&state.modes, n); 2];
        let [mut z, mut to] = flown.each_mut();
        let mut left = steps;
        while left > 0 {
            let level = (leaps.levels.len() - 1).min(left.ilog2() as usize);
            leaps.levels[level].apply((n, separate), z, to, &pulls);
            std::mem::swap(&mut z, &mut to);
            left -= 1 << level;
        }
        let time = leaps.time(steps);
        (self.landed(state, z, time), time)
    }

    /// The state at a later instant of a flight in which no mass is stuck, with these modes.
    fn landed(&self, from: &ModalState<H, N>, z: &Flown<R>, time: Clock<R>) -> ModalState<H, N> {
        let modes = z.modes(self.whole.count());
        let mut state = ModalState { modes, ..*from };
        for k in 0..self.count {
            state.places[k] = self.place_after(from, k, &modes, time);
        }
        state
    }

    /// The place of a mass in flight at a later instant, at which the modes are these. The base is at rest.
    pub(super) fn place_after(
        &self,
        from: &ModalState<H, N>,
        k: usize,
        modes: &Modes<R>,
        time: Clock<R>,
    ) -> Place<R> {
        let (place, shape) = (&from.places[k], self.gap_shape(k));
        let ([u, v], [u0, v0]) = (modes.of_point(shape), from.modes.of_point(shape));
        let sided = |part: DoubleDouble<R>| if place.side > 0.0 { part } else { part.negated() };
        let fallen = time * self.falling(k, place);
        let curved = sided(u - (u0 + v0 * time) + (fallen * time).half());
        let distance = place.distance + place.rate * time + curved;
        Place { distance, rate: place.rate + sided(v - v0 + fallen), shaken: None, ..*place }
    }

    /// G + s R of a mass in flight that nothing ties to its point; of others it is in their coordinates.
    pub(super) fn falling(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        if self.tied[k].is_none() { self.pull(k, place) } else { DoubleDouble::ZERO }
    }
}
