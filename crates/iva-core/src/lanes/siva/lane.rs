//! One lane: a free decay reduced to the numbers that fast flights change, and arrays of such lanes.

use super::flying::{Flying, Flyings};
use crate::compensated::DoubleDouble;
use crate::host::HostState;
use crate::lanes::ScalarRun;
use crate::lanes::arrays::arrays;
use crate::lanes::watch::{Watch, Watches};
use crate::measures::Measures;
use crate::oscillator::Primary;
use crate::settling::Crossing;
use crate::siva::{Siva, SivaState};

arrays! {
    /// The numbers of one run.
    Lane,
    /// Lanes side by side: of every number an array.
    Lanes:
    /// The last passage of each level: the state and the clock at the begin of its flight, between
    /// which instants, and the level, signed; 0: none.
    level_1, x_1, v_1, a_1, time_1, time_rest_1, from_1, to_1,
    level_2, x_2, v_2, a_2, time_2, time_rest_2, from_2, to_2,
    level_3, x_3, v_3, a_3, time_3, time_rest_3, from_3, to_3;
    /// The flight.
    flying: Flying, Flyings,
    /// Measures.
    watch: Watch, Watches
}

impl Lane {
    /// A lane without a run.
    pub fn idle() -> Self {
        Lane { flying: Flying::idle(), watch: Watch::idle(), ..Lane::default() }
    }

    /// A run that has come to where fast flights can go on; `None` if it has not.
    pub fn of(run: &ScalarRun<'_, Siva>, reach: f64) -> Option<Self> {
        let watch = Watch::of(&run.observer.0);
        Some(Lane { flying: Flying::of(run, reach)?, watch, ..Lane::default() })
    }

    /// Puts the numbers back into the run.
    pub fn put_back(&self, run: &mut ScalarRun<'_, Siva>) {
        self.flying.put_back(run, ());
        self.put_measures(&mut run.observer.0);
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
                let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
                let host = HostState { primary, acceleration: DoubleDouble::new(a), phase: () };
                let origin = SivaState { host, ..self.flying.state(()) };
                let start = DoubleDouble { value: time, rest };
                last.passed(Crossing { origin, riding: false, start, h: [from, to], level });
            }
        }
    }
}
