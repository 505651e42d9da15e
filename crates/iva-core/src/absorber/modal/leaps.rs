//! Leaps: the motion of a structure over lengths each of which is twice the one before, of which everything but the
//! state is known beforehand.
//!
//! While no mass is stuck or held, z = (q, q̇) moves by z(t + h) = Φ(h) z(t) + Σ pₖ cₖ(h), where cₖ is what a mass that is pulled with an acceleration 1 does to a structure
//! at rest, and pₖ = Gₖ + sₖ Rₖ. Φ and c of the shortest length are power series of `modal/equations.rs`, Φ from each unit vector without pulls; of twice the length they are
//! Φ² and Φ c + c. All are in double-double. Modes that exchange no energy have
//! blocks of 2 × 2.
//!
//! **A harmonic drive** is a linear system as well: a cos(Ωt + θ) is a sum of cos Ωt and sin Ωt, whose factors turn by Ωh in a leap, and each of the two has a column
//! as a pull has. A base that moves is one more coordinate that the modes do not feel, b̈ = a_g. So resonance is no special case.
//! Records, whose points are closer than a leap is long, are left to the power series.
//!
//! **Proof that a leap meets no wall** ([`Modal::coasts`]). The distance of a mass to its wall is D = L + s φ·q, with L linear in t, or quadratic where gravity acts on the mass alone.
//! From D and Ḋ at both ends and a bound on D⁗ follows whether it stays between the walls ([`stays_clear_by`]). The bound is that of the
//! energy of the third derivative, which never grows without drive: it holds for all leaps of a coast, and a fast mode that hardly moves does not
//! shorten them. Under a drive each leap has a bound of its own, with what the drive may add meanwhile. Where it proves nothing a leap of half the length is tried. A leap begins at a multiple of its length, so
//! that a length that failed is not tried again at once.
//!
//! Φ is made in `modal/propagator.rs`. Where the shortest leap proves nothing, a wall is near: the power series of [`super::ModalMotion`] finds the contact.

use super::propagator::{Feed, Flown};
use super::regime::Regime;
use super::state::{Modes, Place};
use super::structure::Damping;
use super::{Followed, Modal, ModalState};
use crate::absorber::{Clock, Coasted, Coasts};
use crate::force::Force;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::contact::{keeps_pressing, stays_clear_by};

/// Largest number of leaps in one coast: whoever looks within one is shown each of its steps from its begin.
const MOST_LEAPS: usize = 16;
/// A coast of so many steps is long enough: where a stiff spring or a fast mode makes them short, each still has to be shown.
const MOST_STEPS: usize = 1024;

/// What the distance of a mass is, beside the motion of its point: L with its two derivatives, and the sign of its wall.
#[derive(Clone, Copy, Default)]
struct Line<R> {
    begin: R,
    rate: R,
    bend: R,
    side: R,
    /// 1 if the base takes part in the distance, else 0.
    based: R,
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

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The derivatives 2 to K + 1 of all modes while no mass is stuck or held.
    #[inline(always)]
    pub(super) fn bent<const K: usize>(&self, z: &Flown<R, M>, feed: &Feed<R, N>) -> [[R; M]; K] {
        let n = self.whole.count();
        let [(q, v), _] = z.parts(2 * n).map(|part| part.split_at(n));
        let mut all = [[R::ZERO; M]; K];
        for order in 0..K {
            let mut bent = match order {
                0 => self.accelerated(q, v),
                1 => self.accelerated(v, &all[0]),
                _ => self.accelerated(&all[order - 2], &all[order - 1]),
            };
            let pulled = feed.pulls.iter().enumerate();
            for (k, pull) in pulled.filter(|(_, pull)| order == 0 && pull.value != 0.0) {
                let weight = self.masses[k].mass_ratio * pull.value;
                for (bent, phi) in bent.iter_mut().zip(self.gap_shape(k)) {
                    *bent = phi.mul_add(weight, *bent);
                }
            }
            self.push_by(&feed.waves, order, &mut bent);
            all[order] = bent;
        }
        all
    }

    /// What springs and dampers make of a derivative of all q and of the next one.
    fn accelerated(&self, low: &[R], high: &[R]) -> [R; M] {
        let n = self.whole.count();
        let mut bent = [R::ZERO; M];
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
    }

    /// True if speeds and accelerations at both ends of a free flight prove that the point which a run sees does not turn in it.
    pub(super) fn never_turns(
        &self,
        Regime { stuck, pulls }: &Regime<'_, R, N>,
        [from, to]: [&ModalState<H, N, M>; 2],
        length: R,
    ) -> bool {
        let driven = self.host.force().is_some_and(Force::lasts);
        if !R::FAST_PATHS || driven || from.places[..self.count()].iter().any(Place::carried) {
            return false;
        }
        let (n, shape, feed) =
            (self.whole.count(), self.whole.shape(self.seen), self.feed(from, *pulls));
        let [begin, end] = [from, to].map(|state| Flown::of(&state.modes, n));
        let bent = self.bent::<4>(&begin, &feed);
        let [later] = self.bent::<1>(&end, &feed);
        let at = |z: &Flown<R, M>, second: &[R; M]| {
            let [(_, v), _] = z.parts(2 * n).map(|part| part.split_at(n));
            summed(n, |j| {
                let [rate, bend] = [shape[j] * v[j], shape[j] * second[j]];
                [rate, bend, bend.abs().mul_add(length, rate.abs())]
            })
        };
        let [[speed, bend, size], [last, last_bend, last_size]] =
            [at(&begin, &bent[0]), at(&end, &later)];
        let sign = speed.signum();
        let ends = [[speed, bend], [last, last_bend]].map(|end| end.map(|it| sign * it));
        let (factor, constant) = (R::ONE, DoubleDouble::ZERO);
        let followed = Followed { shape, factor, with_base: false, constant };
        let fifth = self.bound(|j| [bent[2][j], bent[3][j]], stuck, followed, 4, length);
        keeps_pressing(ends, size + last_size, fifth, length)
    }

    /// Bounds on the third derivatives of the distances of masses that rub, and on the fourth ones of all, in a motion of this length.
    fn bounds(
        &self,
        state: &ModalState<H, N, M>,
        z: &Flown<R, M>,
        feed: &Feed<R, N>,
        length: R,
    ) -> [[R; N]; 2] {
        let derivatives = self.bent::<3>(z, feed);
        let free = self.regime(&[Place::FAR; N]).stuck;
        let bound = |k: usize, n: usize| {
            let of = |j: usize| [derivatives[n - 2][j], derivatives[n - 1][j]];
            self.bound(of, &free, self.followed(k, &state.places[k]), n, length)
        };
        let [mut thirds, mut fourths] = [[R::ZERO; N]; 2];
        for k in 0..self.count() {
            fourths[k] = bound(k, 3);
            if self.friction[k] != 0.0 {
                thirds[k] = bound(k, 2);
            }
        }
        [thirds, fourths]
    }

    /// A mass at an instant of a coast.
    #[inline(always)]
    fn sight(&self, shape: &[R], line: &Line<R>, time: R, z: &Flown<R, M>) -> Sight<R> {
        let n = shape.len();
        let [(q, v), _] = z.parts(2 * n).map(|part| part.split_at(n));
        let of = |j: usize| {
            let [u, rate] = [shape[j] * q[j], shape[j] * v[j]];
            [u, rate, u.abs(), rate.abs()]
        };
        let [u, rate, size, speed] = summed(n, of);
        let [sums, sizes] = [[u, rate], [size, speed]];
        let gained = line.bend * time;
        let straight = [(gained * 0.5 + line.rate).mul_add(time, line.begin), line.rate + gained];
        let moved = z.base.map(|part| part.value * line.based);
        let along = |i: usize| line.side.mul_add(sums[i] + moved[i], straight[i]);
        let size = |i: usize| sizes[i] + straight[i].abs() + moved[i].abs();
        Sight { distance: [along(0), along(1)], sizes: [size(0), size(1)] }
    }

    /// How many of the shortest leaps are proved to meet no wall, and the state after them; `None` of none.
    pub(super) fn leap(
        &self,
        state: &ModalState<H, N, M>,
        remaining: R,
    ) -> Coasts<ModalState<H, N, M>, R> {
        // Before all else, so that nothing of it is compiled for numbers that take every step.
        if !R::FAST_PATHS {
            return None;
        }
        let carried = self.swings() || state.places[..self.count()].iter().any(Place::carried);
        let leaps = self.leaps().filter(|_| !carried)?;
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        // Begin and end of a leap, in turns.
        let mut flown = [Flown::of(&state.modes, n); 2];
        let [mut z, mut to] = flown.each_mut();
        let mut feed = self.feed(state, self.regime(&state.places).pulls);
        let driven = self.host.force().is_some_and(Force::lasts);
        let remaining = remaining.min(self.host.smooth_for(&state.phase));
        let mut lines = [Line::default(); N];
        let [mut thirds, mut fourths] =
            if driven { [[R::ZERO; N]; 2] } else { self.bounds(state, z, &feed, R::ZERO) };
        let mut now = [Sight::default(); N];
        for k in 0..self.count() {
            let (place, shape) = (&state.places[k], self.gap_shape(k));
            let still = Line {
                side: place.side,
                bend: place.side * self.falling(k, place).value,
                based: if self.tied[k].is_none() { R::ONE } else { R::ZERO },
                ..Line::default()
            };
            let Sight { distance: [u, rate], sizes } = self.sight(shape, &still, R::ZERO, z);
            let distance = [place.distance.value, place.rate.value];
            lines[k] = Line { begin: distance[0] - u, rate: distance[1] - rate, ..still };
            now[k] = Sight { distance, sizes };
        }
        let mut then = now;
        let top = leaps.levels.len() - 1;
        let (mut count, mut level) = (0_usize, top);
        for _ in 0..MOST_LEAPS {
            if count >= MOST_STEPS {
                break;
            }
            if driven {
                [thirds, fourths] =
                    self.bounds(state, z, &feed, leaps.shortest * (1_u64 << level) as f64);
            }
            let found = loop {
                let length = leaps.shortest * (1_u64 << level) as f64;
                let end = leaps.shortest * (count + (1 << level)) as f64;
                if end < remaining {
                    leaps.levels[level].apply((n, separate), z, to, &feed);
                    let clear = (0..self.count()).all(|k| {
                        then[k] = self.sight(self.gap_shape(k), &lines[k], end, to);
                        let ends = [now[k].distance, then[k].distance];
                        let mass = &self.masses[k];
                        let size = mass.size_at(ends[0][0]) + now[k].size(&then[k], length);
                        stays_clear_by(ends, mass.half_play(), size, fourths[k], length)
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
            feed = leaps.levels[level].turned(&feed);
            now = then;
            count += 1 << level;
            level = top.min(count.trailing_zeros() as usize);
        }
        let time = leaps.time(count);
        (count > 0).then(|| (count, (self.landed(state, z, time), time)))
    }

    /// The state after some of the shortest leaps.
    pub(super) fn leapt(
        &self,
        state: &ModalState<H, N, M>,
        steps: usize,
    ) -> Coasted<ModalState<H, N, M>, R> {
        if !R::FAST_PATHS {
            return (*state, Clock::ZERO);
        }
        let Some(leaps) = self.leaps() else { return (*state, Clock::ZERO) };
        let mut feed = self.feed(state, self.regime(&state.places).pulls);
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        let mut flown = [Flown::of(&state.modes, n); 2];
        let [mut z, mut to] = flown.each_mut();
        let mut left = steps;
        while left > 0 {
            let level = (leaps.levels.len() - 1).min(left.ilog2() as usize);
            leaps.levels[level].apply((n, separate), z, to, &feed);
            feed = leaps.levels[level].turned(&feed);
            std::mem::swap(&mut z, &mut to);
            left -= 1 << level;
        }
        let time = leaps.time(steps);
        (self.landed(state, z, time), time)
    }

    /// The state at a later instant of a flight in which no mass is stuck, with these modes.
    fn landed(
        &self,
        from: &ModalState<H, N, M>,
        z: &Flown<R, M>,
        time: Clock<R>,
    ) -> ModalState<H, N, M> {
        let modes = z.modes(self.whole.count());
        let phase = self.host.waited(&from.phase, time);
        let mut state = ModalState { modes, phase, felt: None, ..*from };
        for k in 0..self.count() {
            state.places[k] = self.place_after(from, k, (&modes, z.base), time);
        }
        state
    }

    /// The place of a mass in flight at a later instant, at which the modes are these, and the base has moved so far beyond a uniform motion.
    pub(super) fn place_after(
        &self,
        from: &ModalState<H, N, M>,
        k: usize,
        (modes, base): (&Modes<R, M>, [DoubleDouble<R>; 2]),
        time: Clock<R>,
    ) -> Place<R> {
        let (place, shape) = (&from.places[k], self.gap_shape(k));
        let ([mut u, mut v], [u0, v0]) = (modes.of_point(shape), from.modes.of_point(shape));
        if self.tied[k].is_none() {
            (u, v) = (u + base[0], v + base[1]);
        }
        let sided = |part: DoubleDouble<R>| if place.side > 0.0 { part } else { part.negated() };
        let fallen = time * self.falling(k, place);
        let curved = sided(u - (u0 + v0 * time) + (fallen * time).half());
        let distance = place.distance + place.rate * time + curved;
        Place { distance, rate: place.rate + sided(v - v0 + fallen), leaves: false, ..*place }
    }

    /// G + s R of a mass in flight that nothing ties to its point; of others it is in their coordinates.
    pub(super) fn falling(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        if self.tied[k].is_none() { self.pull(k, place) } else { DoubleDouble::ZERO }
    }
}
