//! The counts and sums of the impacts of a run: those of the event loop, and of lanes.

use crate::absorber::impact::Impact;
use crate::absorber::{Clock, Wall};
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};

/// Counts and sums of a run. Whole numbers are held as doubles, as lanes hold them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts<R = f64> {
    /// Listed impacts; those at which the masses moved towards each other; stretches of motion.
    pub impacts: f64,
    pub effective: f64,
    pub work: f64,
    /// The largest approach speed on each wall.
    pub approach_speeds: [R; 2],
    /// Energy lost in impacts.
    pub losses: Clock<R>,
    /// The current streak.
    pub streak: Streak<R>,
}

laned!(
    Counts,
    ManyCounts {
        impacts: f64,
        effective: f64,
        work: f64,
        approach_speeds: [f64; 2],
        losses: DoubleDouble,
        streak: Streak,
    }
);

/// Consecutive impacts on one wall, which become part of a stick episode if they end in stick.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Streak<R = f64> {
    /// Sign of the wall; 0: there is none.
    pub side: f64,
    /// Its first instant, and the number of impacts listed before it.
    pub start_time: R,
    pub listed_before: f64,
    /// Number of its impacts at or below the chatter floor, and of those at which the masses moved towards each
    /// other: whether they stay listed is decided at its end.
    pub low: f64,
    pub low_effective: f64,
    /// Number of stops in the gap since the last impact above that floor: they count as the impacts after them do.
    pub stops: f64,
    /// Energy lost in it.
    pub energy_loss: R,
}

laned!(
    Streak,
    Streaks {
        side: f64,
        start_time: f64,
        listed_before: f64,
        low: f64,
        low_effective: f64,
        stops: f64,
        energy_loss: f64,
    }
);

/// An impact, as far as it is counted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Counted<R = f64> {
    pub time: R,
    /// Sign of the wall.
    pub side: f64,
    pub approach: R,
    pub energy_loss: R,
    /// True if the masses moved towards each other.
    pub effective: bool,
    /// True if it is at or below the floor of a chatter that dies out.
    pub low: bool,
}

impl<R: Real> From<&Impact<R>> for Counted<R> {
    /// As one that stays listed.
    #[inline(always)]
    fn from(impact: &Impact<R>) -> Self {
        Self {
            time: impact.time,
            side: impact.wall.sign(),
            approach: impact.approach_speed(),
            energy_loss: impact.energy_loss,
            effective: impact.effective(),
            low: false,
        }
    }
}

impl<R: Real> Counts<R> {
    /// Number of impacts that stay listed in any case: without the low rebounds of the current streak, which are
    /// removed if it ends in stick.
    #[inline(always)]
    pub fn listed(&self) -> f64 {
        self.impacts - self.streak.low
    }

    /// The counts after an impact, if there is one.
    #[inline(always)]
    pub fn after(&self, hit: bool, impact: &Counted<R>) -> Self {
        let Counted { time, side, approach, energy_loss, effective, low } = *impact;
        let Self { impacts, work, approach_speeds, losses, .. } = *self;
        let fresh = hit & (self.streak.side != side);
        let streak = &self.streak;
        let one = |which: bool| pick(which, 1.0, 0.0);
        let more = losses.plus(energy_loss);
        let faster = |wall: Wall| {
            let so_far = approach_speeds[wall.index()];
            pick(hit & (side == wall.sign()), R::larger(so_far, approach), so_far)
        };
        Self {
            impacts: impacts + one(hit),
            effective: self.effective + one(hit & effective),
            work,
            approach_speeds: [faster(Wall::Plus), faster(Wall::Minus)],
            losses: DoubleDouble {
                value: pick(hit, more.value, losses.value),
                rest: pick(hit, more.rest, losses.rest),
            },
            streak: Streak {
                side: pick(hit, side, streak.side),
                start_time: pick(fresh, time, streak.start_time),
                listed_before: pick(fresh, impacts, streak.listed_before),
                low: pick(fresh, 0.0, streak.low) + one(hit & low),
                low_effective: pick(fresh, 0.0, streak.low_effective) + one(hit & low & effective),
                stops: pick(hit & (fresh | !low), 0.0, streak.stops),
                energy_loss: pick(fresh, R::ZERO, streak.energy_loss)
                    + pick(hit, energy_loss, R::ZERO),
            },
        }
    }
}
