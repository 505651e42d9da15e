//! Largest sizes and integrals of a flight over several pieces of a record ([`super::pieces`]).

use super::motion::SivaFlight;
use super::pieces::{DOUBT, Drifting};
use super::{Siva, SivaState};
use crate::host::{Block, Host, Phase, Pieces, Structure, Sums};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Losses, Motion, Quantity};

/// Largest difference of two lengths that are the same, in units of 2⁻⁵² of them.
const SAME_ULPS: f64 = 16.0;

/// The flight of a free mass over some pieces of a record, of a given length.
pub(super) struct Passage<'a, H: Host> {
    siva: &'a Siva<H>,
    pieces: &'a Pieces<H::Real>,
    from: &'a SivaState<Phase<H>, H::Real>,
    begin: Drifting<H::Real>,
    length: H::Real,
}

impl<'a, R: Real, H: Host<Real = R>> Passage<'a, H> {
    /// The passage that a flight of this length is; `None` for one within the reach of its series, or beyond it by the
    /// rounding of a contact.
    pub fn of(flight: &'a SivaFlight<'a, H>, length: R) -> Option<Self> {
        if length <= flight.reach() {
            return None;
        }
        let (siva, from) = (flight.siva, &flight.from);
        let pieces = siva.host.pieces()?;
        let drifting = || Drifting::of(&siva.host, pieces, from);
        let begin = (*flight.drifting.get_or_init(drifting))?;
        Some(Self { siva, pieces, from, begin, length })
    }

    /// Calls `see` for each block with the free mass at the begin of the passage through it and the index of the point
    /// at its end.
    fn each(&self, mut see: impl FnMut(&Drifting<R>, &Block<R>, usize)) {
        let mut mass = self.begin;
        let end = self.length * (R::ONE + R::EPSILON * SAME_ULPS);
        while let Some(block) = self.pieces.block(mass.place.block) {
            let point = mass.place.point;
            let left = (mass.time - block.at(point).time).minus(end);
            let times = block.plain.time[point..block.count()].iter();
            let passed = times.take_while(|time| left + **time <= 0.0).count();
            if passed < 2 {
                return;
            }
            let to = point + passed - 1;
            see(&mass, block, to);
            mass = mass.moved(block, to);
            if to + 1 < block.count() {
                return;
            }
        }
    }

    /// Calls `see` for some pieces of a block one by one, with the flight and its length.
    fn one_by_one(
        &self,
        (mass, block): (&Drifting<R>, &Block<R>),
        points: impl Iterator<Item = usize>,
        mut see: impl FnMut(&SivaFlight<'_, H>, R, &SivaState<Phase<H>, R>),
    ) {
        let phase = &self.from.host.phase;
        let at = |k| self.siva.state_of(self.pieces, phase, &mass.moved(block, k));
        // The end of one piece is the begin of the next.
        let mut reached = None;
        for k in points {
            let from = reached.filter(|(there, _)| *there == k).map_or_else(|| at(k), |it| it.1);
            let end = at(k + 1);
            reached = Some((k + 1, end));
            let length = block.at(k + 1).time - block.at(k).time;
            let flight = SivaFlight::new(self.siva, from);
            // Rounding must not make a single piece longer than its series reaches: that would be a passage again.
            see(&flight, length.value.min(flight.reach()), &end);
        }
    }

    /// The larger of `least` and the largest size of a quantity. Where that may be exceeded between two points is
    /// looked at by itself.
    pub fn largest(&self, of: Quantity, mut least: R) -> R {
        let free = self.siva.host.free();
        let damping = free.equation().damping.double();
        self.each(|mass, block, to| {
            let start = &mass.start;
            let bend = match of {
                Quantity::Displacement => free.bound::<0>(start) + self.pieces.largest_base(),
                Quantity::Acceleration => free.bound::<2>(start),
            };
            let above = (block.plain.longest * block.plain.longest * 0.125) * bend.double();
            let [x, v] = [start.x, start.v].map(|it| it.value.double());
            let sizes = block.plain.sizes(of, [x, v, damping]);
            let within = &sizes[mass.place.point..=to];
            let most = within.iter().fold(least.double(), |most, size| most.max(*size));
            let least_there = most * (1.0 - DOUBT);
            let exceeds = |k: &usize| sizes[*k].max(sizes[k + 1]) + above > least_there;
            let points = (mass.place.point..to).filter(exceeds);
            self.one_by_one((mass, block), points, |flight, h, end| {
                least = flight.largest_of(of, least, h, end);
            });
        });
        least
    }

    /// ∫x².
    pub fn square(&self) -> R {
        let mut square = DoubleDouble::<R>::ZERO;
        self.sums(|_, sums, _| square = square.plus(sums.place));
        square.value
    }

    /// The energy lost ∫ 2ζ ẋ², and the work ∫ (f/M) ẋ − a_g p, where p is the momentum of structure and absorber.
    pub fn losses(&self) -> Losses<R> {
        let damping = self.siva.host.free().equation().damping;
        let mass_ratio = self.siva.mass.mass_ratio;
        let [mut viscous, mut work] = [DoubleDouble::<R>::ZERO; 2];
        self.sums(|speed, sums, base| {
            viscous = viscous.plus(damping * sums.speed);
            // With b = ∫a_g, ẋ + ẏ = speed − b, so ∫ a_g (ẋ + ẏ) = Δb (speed − the mean of b at both ends).
            let [from, to] = base;
            let carried = (to - from) * (speed - (from + to) * 0.5);
            work = work.plus(sums.work - mass_ratio * carried);
        });
        Losses { viscous: viscous.value, pivot: R::ZERO, work: work.value }
    }

    /// Calls `take` for each block with ṗ + ∫a_g, the integrals over its part of the passage, and ∫a_g at the ends
    /// of that part.
    fn sums(&self, mut take: impl FnMut(R, Sums<R>, [R; 2])) {
        self.each(|mass, block, to| {
            let ends = [mass.place.point, to];
            if let Some(sums) = self.pieces.sums(mass.place.block, ends, &mass.start) {
                take(mass.speed.value, sums, ends.map(|point| block.at(point).base.v.value));
            }
        });
    }
}
