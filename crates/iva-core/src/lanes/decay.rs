//! The measures of the displacement of a decay, for lanes: half cycles, late amplitudes, and the last passage
//! of each settling level.

use super::arrays::arrays;
use super::pick;
use super::watch::{Passage, Stretch, Watch, Watches};
use crate::compensated::DoubleDouble;
use crate::host::{Host, HostState, Phase};
use crate::measures::Measures;
use crate::oscillator::Primary;
use crate::settling::Crossing;
use crate::siva::{Siva, SivaState};
use crate::system::System;

arrays! {
    /// The measures of one decay.
    Decay,
    /// [`Decay`] of many runs: every field an array over the lanes.
    Decays:
    /// The last passage of each settling level: the level with the sign of x (0: no passage), x, ẋ and ẍ and
    /// the clock at the begin of the flight, and the times after it between which |x| passes the level.
    level_1, x_1, v_1, a_1, time_1, time_rest_1, from_1, to_1,
    level_2, x_2, v_2, a_2, time_2, time_rest_2, from_2, to_2,
    level_3, x_3, v_3, a_3, time_3, time_rest_3, from_3, to_3;
    /// Half cycles, late amplitudes and viscous loss.
    watch: Watch, Watches
}

impl Decay {
    /// The measures of a lane without a run.
    pub fn idle() -> Self {
        Self { watch: Watch::idle(), ..Self::default() }
    }

    /// The measures of a run, without passages.
    pub fn of<S: System<Real = f64>>(measures: &Measures<S>) -> Self {
        Self { watch: Watch::of(measures), ..Self::default() }
    }

    /// The measures after a stretch that begins with x, ẋ and ẍ at an instant, if it has ended (`done`).
    #[inline(always)]
    pub fn after(
        &self,
        stretch: &Stretch,
        [x, v, a]: [f64; 3],
        clock: DoubleDouble,
        done: bool,
    ) -> Self {
        let mut next = *self;
        next.watch = self.watch.after(stretch, clock, done);
        macro_rules! passage {
            ($share:expr, $level:ident, $x:ident, $v:ident, $a:ident, $time:ident, $rest:ident, $from:ident, $to:ident) => {
                let Passage { passes, h: [from, to], level } =
                    stretch.passage($share * self.watch.amplitude);
                let passes = passes & done;
                next.$level = pick(passes, level, self.$level);
                next.$x = pick(passes, x, self.$x);
                next.$v = pick(passes, v, self.$v);
                next.$a = pick(passes, a, self.$a);
                next.$time = pick(passes, clock.value, self.$time);
                next.$rest = pick(passes, clock.rest, self.$rest);
                next.$from = pick(passes, from, self.$from);
                next.$to = pick(passes, to, self.$to);
            };
        }
        passage!(0.10, level_1, x_1, v_1, a_1, time_1, time_rest_1, from_1, to_1);
        passage!(0.05, level_2, x_2, v_2, a_2, time_2, time_rest_2, from_2, to_2);
        passage!(0.02, level_3, x_3, v_3, a_3, time_3, time_rest_3, from_3, to_3);
        next
    }

    /// Writes the measures back into those of the run, whose state is given.
    pub fn put_back<H: Host<Real = f64>>(
        &self,
        measures: &mut Measures<Siva<H>>,
        host: &H,
        state: &SivaState<Phase<H>>,
    ) where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
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
            // If the lane saw no passage of this level, the run keeps the one it had.
            if level != 0.0 {
                let start = DoubleDouble { value: time, rest };
                let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
                let (acceleration, phase) = (DoubleDouble::new(a), host.begin_at(start));
                let host = HostState { primary, acceleration, phase };
                let origin = SivaState { host, ..*state };
                last.passed(Crossing { origin, riding: false, start, h: [from, to], level });
            }
        }
    }
}
