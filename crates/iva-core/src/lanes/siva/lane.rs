//! One lane: a run reduced to the numbers that strides change, and arrays of such lanes.

use crate::compensated::Sum;
use crate::impact;
use crate::lanes::arrays::arrays;
use crate::lanes::watch::{Watch, Watches};
use crate::measures::Measures;
use crate::oscillator::Primary;
use crate::real::Real;
use crate::settling::Crossing;
use crate::simulate::wall::Streak;
use crate::simulate::{Phase, Run, STOPS};
use crate::siva::{Siva, SivaState};
use crate::system::{System, Wall};

/// What to do at the end of the next stride.
pub(in crate::lanes) const SEARCH: Real = 0.0;
/// … close to the near wall,
pub(in crate::lanes) const NEAR: Real = 1.0;
/// … or the far one.
pub(in crate::lanes) const FAR: Real = 2.0;

/// Why a lane has stopped: at a stop of the run,
pub(in crate::lanes) const STOP: Real = 1.0;
/// or at a limit.
pub(in crate::lanes) const FULL: Real = 2.0;

arrays! {
    /// The numbers of one run.
    Lane,
    /// Lanes side by side: of every number an array.
    Lanes:
    /// The state.
    x, x_rest, v, v_rest, a, a_rest, distance, distance_rest, rate, rate_rest, side,
    /// The clock, and the instant of the next stop.
    time, time_rest, stop,
    /// What the next evaluation is for, where, within which length, and how often one was made close
    /// to the wall.
    aim, h, length, looks, first,
    /// The absorber.
    share, share_rest, restitution, clearance, loss_factor,
    /// Rebounds at or below are for the loop.
    floor,
    /// Counts and sums.
    impacts, max_impacts, effective, work, max_work, losses, losses_rest,
    /// Impacts on one wall in a row.
    streak_side, streak_start, streak_listed, streak_loss,
    /// The last passage of each level: the state and the clock at the begin of its flight, between
    /// which instants, and the level, signed; 0: none.
    level_1, x_1, v_1, a_1, time_1, time_rest_1, from_1, to_1,
    level_2, x_2, v_2, a_2, time_2, time_rest_2, from_2, to_2,
    level_3, x_3, v_3, a_3, time_3, time_rest_3, from_3, to_3,
    /// What the loop is called for: a stretch that is no stride, a stop.
    care, stopped;
    /// Measures.
    watch: Watch, Watches
}

impl Lane {
    #[inline(always)]
    pub fn state(&self) -> SivaState {
        let sum = |value, rest| Sum { value, rest };
        SivaState {
            primary: Primary { x: sum(self.x, self.x_rest), v: sum(self.v, self.v_rest) },
            acceleration: sum(self.a, self.a_rest),
            side: self.side,
            distance: sum(self.distance, self.distance_rest),
            rate: sum(self.rate, self.rate_rest),
        }
    }

    #[inline(always)]
    pub fn put_state(&mut self, state: &SivaState) {
        let Primary { x, v } = state.primary;
        (self.x, self.x_rest) = (x.value, x.rest);
        (self.v, self.v_rest) = (v.value, v.rest);
        (self.a, self.a_rest) = (state.acceleration.value, state.acceleration.rest);
        (self.distance, self.distance_rest) = (state.distance.value, state.distance.rest);
        (self.rate, self.rate_rest) = (state.rate.value, state.rate.rest);
        self.side = state.side;
    }

    #[inline(always)]
    pub fn clock(&self) -> Sum {
        Sum { value: self.time, rest: self.time_rest }
    }

    /// A lane without a run: at rest for ever.
    pub fn idle() -> Self {
        let never = Real::INFINITY;
        let at_rest = Lane { clearance: 1.0, distance: 1.0, side: 1.0, ..Lane::default() };
        let endless = Lane { stop: never, max_impacts: never, max_work: never, ..at_rest };
        Lane { watch: Watch::idle(), first: never, ..endless }
    }

    /// True if the run has reached a limit.
    #[inline(always)]
    pub fn full(&self) -> bool {
        (self.impacts >= self.max_impacts) | (self.work >= self.max_work)
    }

    /// A run that has come to where strides can go on.
    pub fn of(run: &Run<'_, Siva, Measures<Siva>>, first: Real, reach: Real) -> Self {
        let (siva, tally) = (run.system, &run.tally);
        let mut lane = Lane {
            time: run.clock.value,
            time_rest: run.clock.rest,
            stop: run.stop(),
            share: siva.impact_share.value,
            share_rest: siva.impact_share.rest,
            restitution: siva.restitution(),
            clearance: siva.clearance(),
            loss_factor: impact::energy_loss(siva.mass_ratio(), siva.restitution(), 1.0),
            floor: run.limits.chatter_floor,
            impacts: tally.impacts as Real,
            max_impacts: run.limits.max_impacts as Real,
            effective: tally.effective_impacts as Real,
            work: tally.work as Real,
            max_work: run.limits.max_work as Real,
            losses: run.losses.value,
            losses_rest: run.losses.rest,
            ..Lane::default()
        };
        lane.put_state(&tally.state);
        if let Some(streak) = &run.streak {
            lane.streak_side = streak.wall.sign();
            lane.streak_start = streak.start_time;
            lane.streak_listed = streak.listed_before as Real;
            lane.streak_loss = streak.energy_loss;
        }
        lane.watch = Watch::of(&run.observer);
        let remaining = -run.clock.minus(lane.stop);
        lane.first = first;
        lane.length = reach.min(remaining).min(first);
        lane.h = lane.length;
        lane
    }

    /// Puts the numbers back into the run.
    pub fn put_back(&self, run: &mut Run<'_, Siva, Measures<Siva>>) {
        run.tally.state = self.state();
        // At its end the run has set its clock itself.
        if run.stopped < STOPS {
            run.clock = self.clock();
        }
        run.tally.impacts = self.impacts as u64;
        run.tally.effective_impacts = self.effective as u64;
        run.tally.work = self.work as u64;
        run.losses = Sum { value: self.losses, rest: self.losses_rest };
        run.streak = (self.streak_side != 0.0).then_some(Streak {
            wall: if self.streak_side > 0.0 { Wall::Plus } else { Wall::Minus },
            start_time: self.streak_start,
            listed_before: self.streak_listed as u64,
            low: 0,
            low_effective: 0,
            energy_loss: self.streak_loss,
        });
        run.phase = Phase::Flight { first: self.first };
        self.put_measures(&mut run.observer);
    }

    fn put_measures(&self, measures: &mut Measures<Siva>) {
        self.watch.put_back(measures);
        let passages = [
            [
                self.level_1,
                self.x_1,
                self.v_1,
                self.a_1,
                self.time_1,
                self.time_rest_1,
                self.from_1,
                self.to_1,
            ],
            [
                self.level_2,
                self.x_2,
                self.v_2,
                self.a_2,
                self.time_2,
                self.time_rest_2,
                self.from_2,
                self.to_2,
            ],
            [
                self.level_3,
                self.x_3,
                self.v_3,
                self.a_3,
                self.time_3,
                self.time_rest_3,
                self.from_3,
                self.to_3,
            ],
        ];
        for (last, [level, x, v, a, time, rest, from, to]) in
            measures.settling.iter_mut().zip(passages)
        {
            // Where none was passed here, one before may have been.
            if level != 0.0 {
                let primary = Primary { x: Sum::new(x), v: Sum::new(v) };
                let origin = SivaState { primary, acceleration: Sum::new(a), ..self.state() };
                let start = Sum { value: time, rest };
                last.passed(Crossing { origin, riding: false, start, h: [from, to], level });
            }
        }
    }
}
