//! The counts and sums of a run that change in simple flights, for lanes: stretches, impacts, and their
//! energy losses.

use super::pick;
use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::impact;
use crate::real::Real;
use crate::simulate::Run;
use crate::simulate::wall::Streak;
use crate::system::{System, Wall};

arrays! {
    /// The counts and sums of one run.
    Counts, ManyCounts:
    /// Impacts and their limit, effective impacts, stretches of motion (`work`) and their limit.
    impacts, max_impacts, effective, work, max_work,
    /// The largest approach speed on each wall.
    fastest_plus, fastest_minus,
    /// Energy lost in impacts, in double-double, and the loss of one impact over the square of its approach
    /// speed.
    losses, losses_rest, loss_factor,
    /// The current streak of impacts on one wall: sign of the wall (0: none), its first instant, the number
    /// of impacts before it, its energy loss.
    streak_side, streak_start, streak_listed, streak_loss,
}

/// An impact of a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub time: f64,
    /// Velocity of the structure just before.
    pub v: f64,
    /// Sign of the wall.
    pub side: f64,
    pub approach: f64,
}

impl Counts {
    /// The counts of a lane without a run.
    pub fn idle() -> Self {
        Self { max_impacts: f64::INFINITY, max_work: f64::INFINITY, ..Self::default() }
    }

    /// True if the run has reached a limit.
    #[inline(always)]
    pub fn full(&self) -> bool {
        (self.impacts >= self.max_impacts) | (self.work >= self.max_work)
    }

    /// The counts of a run of an absorber with this mass ratio and restitution; `None` if a limit is reached,
    /// or if the current streak holds impacts at or below the chatter floor, whose listing is not decided
    /// yet.
    pub fn of<S: System<Real = f64>, O>(
        run: &Run<'_, S, O>,
        [mass_ratio, restitution]: [f64; 2],
    ) -> Option<Self> {
        let (tally, limits) = (&run.tally, run.limits);
        let mut counts = Self {
            impacts: tally.impacts as f64,
            max_impacts: limits.max_impacts as f64,
            effective: tally.effective_impacts as f64,
            fastest_plus: tally.approach_speeds[0],
            fastest_minus: tally.approach_speeds[1],
            work: tally.work as f64,
            max_work: limits.max_work as f64,
            losses: run.losses.value,
            losses_rest: run.losses.rest,
            loss_factor: impact::energy_loss(mass_ratio, restitution, 1.0),
            ..Self::default()
        };
        if let Some(streak) = &run.streak {
            if streak.low > 0 {
                return None;
            }
            counts.streak_side = streak.wall.sign();
            counts.streak_start = streak.start_time;
            counts.streak_listed = streak.listed_before as f64;
            counts.streak_loss = streak.energy_loss;
        }
        (!counts.full()).then_some(counts)
    }

    /// Writes the counts back into the run.
    pub fn put_back<S: System<Real = f64>, O>(&self, run: &mut Run<'_, S, O>) {
        run.tally.impacts = self.impacts as u64;
        run.tally.effective_impacts = self.effective as u64;
        run.tally.approach_speeds = [self.fastest_plus, self.fastest_minus];
        run.tally.work = self.work as u64;
        run.losses = DoubleDouble { value: self.losses, rest: self.losses_rest };
        run.streak = (self.streak_side != 0.0).then_some(Streak {
            wall: if self.streak_side > 0.0 { Wall::Plus } else { Wall::Minus },
            start_time: self.streak_start,
            listed_before: self.streak_listed as u64,
            low: 0,
            low_effective: 0,
            energy_loss: self.streak_loss,
        });
    }

    /// The counts after a stretch that has ended, if `done`, with an impact, if `hit`.
    #[inline(always)]
    pub fn after(&self, done: bool, hit: bool, impact: &Hit) -> Self {
        let Hit { time, v, side, approach } = *impact;
        let loss = self.loss_factor * (approach * approach);
        let losses = DoubleDouble { value: self.losses, rest: self.losses_rest }.plus(loss);
        let absorber = v + side * approach;
        let fresh = hit & (self.streak_side != side);
        let mut next = *self;
        next.work = self.work + pick(done, 1.0, 0.0);
        next.losses = pick(hit, losses.value, self.losses);
        next.losses_rest = pick(hit, losses.rest, self.losses_rest);
        next.impacts = self.impacts + pick(hit, 1.0, 0.0);
        next.effective = self.effective + pick(hit & (v * absorber < 0.0), 1.0, 0.0);
        let faster = |wall: bool, so_far| pick(hit & wall, f64::larger(so_far, approach), so_far);
        next.fastest_plus = faster(side > 0.0, self.fastest_plus);
        next.fastest_minus = faster(side < 0.0, self.fastest_minus);
        next.streak_side = pick(hit, side, self.streak_side);
        next.streak_start = pick(fresh, time, self.streak_start);
        next.streak_listed = pick(fresh, self.impacts, self.streak_listed);
        next.streak_loss = pick(fresh, 0.0, self.streak_loss) + pick(hit, loss, 0.0);
        next
    }
}
