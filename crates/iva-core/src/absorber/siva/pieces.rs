//! A free mass on a structure under a record, from point to point while it is far from its walls.
//!
//! Between two impacts p = x + y moves uniformly but for the motion of the base, so that the distance to a wall is
//! known at all points of the record ([`crate::host::Pieces`]). As ÿ = −A, it stays within h²/8 · max|A| of its chord
//! between two points that are h apart: no wall is met between points that are farther from both walls than that.

use super::{Siva, SivaState};
use crate::absorber::Coasted;
use crate::host::oscillator::Primary;
use crate::host::{Block, Host, HostState, Phase, Pieces, Place, Plain, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// Largest number of blocks passed at once: observers that look within see each piece by itself, from a state that is
/// computed from the first one.
const BLOCKS: usize = 4;
/// Part of all sizes that is kept off the walls because of rounding.
pub(super) const DOUBT: f64 = 1e-12;

/// A free mass at a point of a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drifting<R = f64> {
    pub place: Place,
    pub primary: Primary<R>,
    /// Displacement and velocity at the begin of the block that lead there.
    pub start: Primary<R>,
    /// Distance to the wall last touched, and the sign of that wall.
    distance: DoubleDouble<R>,
    side: R,
    /// ṗ plus ∫a_g since the begin of the block.
    pub speed: DoubleDouble<R>,
    /// The time since the begin of the motion.
    pub time: DoubleDouble<R>,
}

impl<R: Real> Drifting<R> {
    /// The free mass of a state; `None` for one between two points.
    #[inline(always)]
    pub fn of<H: Host<Real = R>>(
        host: &H,
        pieces: &Pieces<R>,
        state: &SivaState<Phase<H>, R>,
    ) -> Option<Self> {
        let SivaState { host: HostState { primary, phase, .. }, side, distance, rate } = *state;
        let place = host.place(&phase)?;
        let at = pieces.block(place.block)?.at(place.point);
        let (start, time) = (at.traced(&primary), DoubleDouble::ZERO);
        let speed = primary.v - seen(side, rate) + at.base.v;
        Some(Self { place, primary, start, distance, side, speed, time })
    }

    /// The same free mass at a later point of the block.
    #[inline(always)]
    pub fn moved(&self, block: &Block<R>, point: usize) -> Self {
        let Self { place, primary, mut start, distance, side, mut speed, time } = *self;
        let [from, to] = [place.point, point].map(|point| block.at(point));
        let reached = to.reached(&start);
        let passed = to.time - from.time;
        let shifted = speed * passed - (to.base.x - from.base.x);
        let distance = distance + seen(side, (reached.x - primary.x) - shifted);
        let mut place = Place { point, ..place };
        if point + 1 == block.count() {
            place = Place { block: place.block + 1, point: 0 };
            (start, speed) = (reached, speed - to.base.v);
        }
        Self { place, primary: reached, start, distance, side, speed, time: time + passed }
    }

    /// The number of pieces, from its point to the end of the block, in which certainly no wall is met; at most those
    /// that the time `remaining` has. `bound` bounds |A| from a state of the structure on.
    #[inline(always)]
    fn clear(
        &self,
        block: &Block<R>,
        [clearance, remaining]: [R; 2],
        bound: impl Fn(&Primary<R>) -> R,
    ) -> usize {
        let at = block.at(self.place.point);
        let start = &self.start;
        let plain = |sum: &DoubleDouble<R>| sum.value.double();
        let (side, speed) = (self.side.double(), plain(&self.speed));
        let begin = speed * plain(&at.time) - plain(&at.base.x) - plain(&self.primary.x);
        let begin = plain(&self.distance) + side * begin;
        let Plain { count, longest, reach: [time, base], .. } = block.plain;
        let (clearance, structure) =
            (clearance.double(), start.x.value.abs() + start.v.value.abs());
        let size = begin.abs() + clearance + structure.double() + speed.abs() * time + base;
        let bent = longest * longest * 0.125 * bound(start).double();
        let band = bent + size * DOUBT;
        let from = [begin, side, plain(&start.x), plain(&start.v), speed];
        let free = inside(&block.plain, from, [band, clearance + clearance - band]);
        let points = (!(free >> self.place.point)).trailing_zeros() as usize;
        let mut end = (self.place.point + points).min(count).saturating_sub(1);
        let late = |end: usize| {
            let time = self.time + (block.at(end).time - at.time);
            time.minus(remaining) > 0.0
        };
        while end > self.place.point && late(end) {
            end -= 1;
        }
        end.saturating_sub(self.place.point)
    }
}

/// A quantity as seen from the wall with this sign.
#[inline(always)]
fn seen<R: Real>(side: R, sum: DoubleDouble<R>) -> DoubleDouble<R> {
    DoubleDouble { value: side * sum.value, rest: side * sum.rest }
}

/// The points at which the distance to the wall lies between two values, as bits.
#[inline(always)]
fn inside(plain: &Plain, [begin, side, x, v, speed]: [f64; 5], [low, high]: [f64; 2]) -> u64 {
    let mut free = 0;
    for k in 0..plain.c.len() {
        let structure = plain.c[k].mul_add(x, plain.s[k].mul_add(v, plain.both[k]));
        let distance = side.mul_add((-speed).mul_add(plain.time[k], structure), begin);
        free |= u64::from((distance > low) & (distance < high)) << k;
    }
    free
}

impl<R: Real, H: Host<Real = R>> Siva<H> {
    /// The number of pieces of a record from a state on in which certainly no wall is met, and the state after them with
    /// the time that they take.
    pub(super) fn drifts(
        &self,
        pieces: &Pieces<R>,
        state: &SivaState<Phase<H>, R>,
        remaining: R,
    ) -> (usize, Coasted<SivaState<Phase<H>, R>, R>) {
        let still = (0, (*state, DoubleDouble::ZERO));
        let Some(mut mass) = Drifting::of(&self.host, pieces, state) else { return still };
        let free = self.host.free();
        let bound = |start: &Primary<R>| free.bound::<0>(start);
        let mut count = 0;
        for _ in 0..BLOCKS {
            let Some(block) = pieces.block(mass.place.block) else { break };
            let clear = mass.clear(block, [self.mass.clearance, remaining], bound);
            if clear == 0 {
                break;
            }
            count += clear;
            let end = mass.place.point + clear;
            mass = mass.moved(block, end);
            if end + 1 < block.count() {
                break;
            }
        }
        if count == 0 {
            return still;
        }
        (count, (self.state_of(pieces, &state.host.phase, &mass), mass.time))
    }

    /// The state after some of these pieces, and the time that they take.
    pub(super) fn drifted(
        &self,
        pieces: &Pieces<R>,
        state: &SivaState<Phase<H>, R>,
        count: usize,
    ) -> Coasted<SivaState<Phase<H>, R>, R> {
        let Some(mut mass) = Drifting::of(&self.host, pieces, state) else {
            return (*state, DoubleDouble::ZERO);
        };
        let mut left = count;
        while let Some(block) = pieces.block(mass.place.block).filter(|_| left > 0) {
            let point = (mass.place.point + left).min(block.count() - 1);
            left -= point - mass.place.point;
            mass = mass.moved(block, point);
        }
        (self.state_of(pieces, &state.host.phase, &mass), mass.time)
    }

    /// The state of a free mass at a point.
    #[inline(always)]
    pub(super) fn state_of(
        &self,
        pieces: &Pieces<R>,
        phase: &Phase<H>,
        mass: &Drifting<R>,
    ) -> SivaState<Phase<H>, R> {
        let Drifting { place, primary, distance, side, speed, .. } = *mass;
        let here = pieces.block(place.block).map(|block| block.at(place.point).base.v);
        let speed = speed - here.unwrap_or(DoubleDouble::ZERO);
        let host = self.host.state(self.host.at(phase, place), primary);
        SivaState { host, side, distance, rate: seen(side, primary.v - speed) }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::absorber::siva::motion::SivaFlight;
    use crate::absorber::{Absorber, Clock, Start};
    use crate::force::{Acts, Force, History, Record};
    use crate::host::DrivenHost;
    use crate::segment::flight::{Losses, Motion, Quantity};

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
    }

    /// A record whose pieces are equal, or unequal with some too long for a block.
    fn history(equal: bool) -> Arc<History> {
        let mut time = 0.0;
        let mut next = |k: u32| {
            time +=
                if equal { 0.06 } else { [0.003, 0.06, 0.3, 2.5][(4.0 * spread(k, 7)) as usize] };
            time
        };
        let times = (0..400).map(&mut next).collect();
        let values = (0..400).map(|k| spread(k, 8) - 0.5).collect();
        Arc::new(History::new(times, values).unwrap())
    }

    /// A free mass at a point of the record, in a wide gap.
    fn planted(
        i: u32,
        history: &Arc<History>,
        rate: f64,
    ) -> (Siva<DrivenHost>, SivaState<Phase<DrivenHost>>) {
        let u = |k| spread(i, k);
        let acts = if u(0) < 0.5 { Acts::Primary } else { Acts::Base };
        let damping_ratio = [0.0, 0.02, 0.3, 1.5][(4.0 * u(1)) as usize];
        let record = Record { history: Arc::clone(history), acts, rate, scale: 1.0 };
        let siva = Siva::new(0.1, 0.5, 1.0, damping_ratio).unwrap();
        let siva = siva.under(Force::new(Vec::new(), vec![record], &[]).unwrap());
        let start = Start {
            displacement: 0.4 * u(2) - 0.2,
            velocity: 0.4 * u(3) - 0.2,
            gap_displacement: 1.8 * u(4) - 0.9,
            gap_velocity: 0.6 * u(5) - 0.3,
        };
        let point = (398.0 * u(6)) as usize;
        let state = siva.begin_at(&start, Clock::new(history.times()[point] * rate));
        (siva, state)
    }

    /// The motion piece by piece in closed form: the reference is independent of the responses of the blocks.
    #[test]
    fn pieces_are_those_of_the_series_and_meet_no_wall() {
        let (mut drifting, mut stopped) = (0, 0);
        for equal in [true, false] {
            let history = history(equal);
            for i in 1..1000 {
                let (siva, from) = planted(i, &history, 1.0);
                let pieces = siva.host.pieces().unwrap();
                let remaining = 12.0 * spread(i, 9);
                let (count, end) = siva.drifts(pieces, &from, remaining);
                assert_eq!(end, siva.drifted(pieces, &from, count));
                let mut at = from;
                for k in 1..=count {
                    let (jump, time) = siva.drifted(pieces, &from, k);
                    assert!(time.minus(remaining) <= 0.0);
                    let flight = SivaFlight::new(&siva, at);
                    let length = flight.reach();
                    for part in 1..=8 {
                        let there = flight.state(length * f64::from(part) / 8.0);
                        let inside = 0.0 < there.distance.value && there.distance.minus(2.0) < 0.0;
                        assert!(inside, "{i}: {there:?}");
                    }
                    at = flight.arrival(length);
                    assert_eq!(jump.host.phase, at.host.phase, "{i} {k}");
                    let off = |a: DoubleDouble, b: DoubleDouble| (a - b).value.abs();
                    let worst = off(jump.host.primary.x, at.host.primary.x)
                        .max(off(jump.host.primary.v, at.host.primary.v))
                        .max(off(jump.host.acceleration, at.host.acceleration))
                        .max(off(jump.distance, at.distance))
                        .max(off(jump.rate, at.rate));
                    assert!(worst < 3e-17 * k as f64, "{i} {k}: {worst:e}");
                }
                drifting += u32::from(count > 0);
                let (_, time) = siva.drifted(pieces, &from, count);
                stopped += u32::from(time.value + 2.5 < remaining);
            }
        }
        assert!(drifting > 500 && stopped > 300, "{drifting} {stopped}");
    }

    #[test]
    fn structures_of_one_damping_ratio_share_pieces_and_the_history_is_freed() {
        let history = history(true);
        let scene = |damping_ratio, scale| {
            let record =
                Record { history: Arc::clone(&history), acts: Acts::Base, rate: 1.0, scale };
            let force = Force::new(Vec::new(), vec![record], &[]).unwrap();
            Siva::new(0.1, 0.5, 1.0, damping_ratio).unwrap().under(force)
        };
        let shared = |a: &Siva<DrivenHost>, b: &Siva<DrivenHost>| {
            std::ptr::eq(a.host.pieces().unwrap(), b.host.pieces().unwrap())
        };
        let first = scene(0.02, 1.0);
        assert!(shared(&first, &scene(0.02, 1.0)));
        assert!(!shared(&first, &scene(0.02, 2.0)));
        assert!(!shared(&first, &scene(0.03, 1.0)));
        drop(first);
        let weak = Arc::downgrade(&history);
        drop(history);
        assert!(weak.upgrade().is_none());
    }

    /// The largest sizes are those of the pieces taken one by one, where points lie between doubles.
    #[test]
    fn the_largest_sizes_are_those_of_all_pieces() {
        let history = history(true);
        let mut more = 0;
        for i in 1..500 {
            let (siva, from) = planted(i, &history, 0.9);
            let pieces = siva.host.pieces().unwrap();
            let (count, _) = siva.drifts(pieces, &from, 12.0);
            if count < 2 {
                continue;
            }
            let (end, time) = siva.drifted(pieces, &from, count);
            for of in [Quantity::Displacement, Quantity::Acceleration] {
                for least in [0.0, 0.3] {
                    let whole =
                        SivaFlight::new(&siva, from).largest_of(of, least, time.value, &end);
                    let each = (0..count).fold(least, |most, k| {
                        let ends = [k, k + 1].map(|k| siva.drifted(pieces, &from, k));
                        let length = (ends[1].1 - ends[0].1).value;
                        SivaFlight::new(&siva, ends[0].0).largest_of(of, most, length, &ends[1].0)
                    });
                    assert!((whole - each).abs() <= 1e-15, "{i}: {whole} {each}");
                    more += u32::from(whole > least);
                }
            }
        }
        assert!(more > 200, "{more}");
    }

    /// ∫x², the energy lost and the work are those of the pieces taken one by one, by Gaussian quadrature of their
    /// power series: the reference is independent of the forms.
    #[test]
    fn the_integrals_are_those_of_all_pieces() {
        let mut seen = 0;
        for equal in [true, false] {
            let history = history(equal);
            for i in 1..500 {
                let (siva, from) = planted(i, &history, 0.9);
                let pieces = siva.host.pieces().unwrap();
                let (count, _) = siva.drifts(pieces, &from, 12.0);
                let (_, time) = siva.drifted(pieces, &from, count);
                let of = |flight: &SivaFlight<'_, DrivenHost>, h| {
                    let Losses { viscous, work, .. } = flight.losses(h);
                    [flight.square([0.0, h]), viscous, work]
                };
                let (mut each, mut size) = ([0.0; 3], 0.0);
                for k in 0..count {
                    let ends = [k, k + 1].map(|k| siva.drifted(pieces, &from, k));
                    let length = (ends[1].1 - ends[0].1).value;
                    let flight = SivaFlight::new(&siva, ends[0].0);
                    let one = of(&flight, length.min(flight.reach()));
                    size += one.iter().fold(0.0, |size: f64, it| size.max(it.abs()));
                    each = std::array::from_fn(|i| each[i] + one[i]);
                }
                let whole = of(&SivaFlight::new(&siva, from), time.value);
                for (whole, each) in whole.iter().zip(&each).filter(|_| count > 1) {
                    let off = (whole - each).abs();
                    assert!(off <= 1e-15 * size, "{i}: {whole:e} {each:e} {size:e}");
                    seen += u32::from(*each != 0.0);
                }
            }
        }
        assert!(seen > 1000, "{seen}");
    }

    /// A contact may end a flight later than the end of its piece, by a rounding.
    #[test]
    fn a_flight_between_points_that_is_longer_by_a_rounding_has_its_largest_sizes() {
        let history = history(true);
        for i in 1..200 {
            let (siva, from) = planted(i, &history, 1.0);
            let flight = SivaFlight::new(&siva, from);
            let from = flight.arrival(0.4 * flight.reach());
            let flight = SivaFlight::new(&siva, from);
            let (length, end) = (flight.reach(), flight.arrival(flight.reach()));
            for of in [Quantity::Displacement, Quantity::Acceleration] {
                let within = flight.largest_of(of, 0.0, length, &end);
                let beyond = flight.largest_of(of, 0.0, length * (1.0 + f64::EPSILON), &end);
                assert!(within > 0.0 && (within - beyond).abs() <= 1e-15, "{i}: {within} {beyond}");
            }
        }
    }
}
