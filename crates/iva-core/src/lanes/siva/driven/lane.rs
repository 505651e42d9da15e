//! One lane: the variables of a driven run that fast flights change, and arrays of such lanes.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::force::{Acts, Drive, Force, Harmonic, Push, Pushes};
use crate::host::{Driven, DrivenHost, Host, Moment, Source};
use crate::lanes::ScalarRun;
use crate::lanes::siva::flying::{Flying, Flyings};
use crate::oscillator::Equation;
use crate::siva::{Siva, SivaState};
use crate::system::Clock;

arrays! {
    /// The variables of one run.
    Lane,
    /// [`Lane`] of many runs: every field an array over the lanes.
    Lanes:
    /// The instant of the drive, and f/M or a_g there with its first three derivatives.
    instant, instant_rest,
    push, push_rest, push_rate, push_rate_rest, push_second, push_second_rest, push_third,
    /// The force: f/M or a_g = amplitude · cos(frequency · t + angle).
    amplitude, frequency, angle,
    /// The constants of the structure ([`Driven`]).
    damping, growth, reach, step, excess_0, excess_1, excess_2, excess_3, excess_4, excess_5, excess_6;
    /// The flight.
    flying: Flying, Flyings
}

/// The force of a lane: one harmonic force, on the structure or its base.
#[derive(Debug, Clone, Copy)]
pub(super) struct Single<const BASE: bool>(pub Harmonic);

impl<const BASE: bool> Single<BASE> {
    /// f/M and a_g, one of which is `push`.
    #[inline(always)]
    fn pushes_of(push: Push) -> Pushes {
        if BASE {
            Pushes { base: push, ..Pushes::NONE }
        } else {
            Pushes { primary: push, ..Pushes::NONE }
        }
    }
}

impl<const BASE: bool> Source for Single<BASE> {
    type Real = f64;
    #[inline(always)]
    fn pushes(&self, _from: Clock, time: Clock) -> Pushes {
        Self::pushes_of(self.0.push(time))
    }

    #[inline(always)]
    fn drive(&self, moment: &Moment, h: f64) -> Drive<f64> {
        let Pushes { primary, base } = &moment.pushes;
        if BASE {
            Drive { base: self.0.onwards(base, h), ..Drive::NONE }
        } else {
            Drive { primary: self.0.onwards(primary, h), ..Drive::NONE }
        }
    }

    fn precise(&self, time: Clock, h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        let row = if BASE { &mut drive.base } else { &mut drive.primary };
        self.0.add_precise(row, time, h);
        drive
    }

    #[inline(always)]
    fn until_bend(&self, _moment: &Moment, reach: f64) -> (f64, Option<Clock>) {
        (reach, None)
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        BASE
    }

    fn bends(&self) -> bool {
        false
    }
}

impl Lane {
    /// The structure under its force.
    #[inline(always)]
    pub fn structure<const BASE: bool>(&self) -> Driven<Single<BASE>> {
        let Self { amplitude, frequency, angle: phase, damping, growth, .. } = *self;
        let third = DoubleDouble::new(1.0).over(3.0);
        let excess = [
            self.excess_0,
            self.excess_1,
            self.excess_2,
            self.excess_3,
            self.excess_4,
            self.excess_5,
            self.excess_6,
        ];
        Driven {
            equation: Equation { stiffness: 1.0, frequency: 1.0, damping, growth, third },
            source: Single(Harmonic { amplitude, frequency, phase, acts: Acts::Primary }),
            base: [0.0; 5],
            reach: self.reach,
            step: self.step,
            excess,
        }
    }

    #[inline(always)]
    pub fn state<const BASE: bool>(&self) -> SivaState<Moment> {
        let sum = |value, rest| DoubleDouble { value, rest };
        let push = Push {
            value: sum(self.push, self.push_rest),
            rate: sum(self.push_rate, self.push_rate_rest),
            second: sum(self.push_second, self.push_second_rest),
            third: self.push_third,
        };
        let time = sum(self.instant, self.instant_rest);
        self.flying.state(Moment { time, kicks: 0, pushes: Single::<BASE>::pushes_of(push) })
    }

    /// Stores the state of the drive.
    #[inline(always)]
    pub fn put_moment<const BASE: bool>(&mut self, moment: &Moment) {
        let Pushes { primary, base } = moment.pushes;
        let Push { value, rate, second, third } = if BASE { base } else { primary };
        (self.instant, self.instant_rest) = (moment.time.value, moment.time.rest);
        (self.push, self.push_rest) = (value.value, value.rest);
        (self.push_rate, self.push_rate_rest) = (rate.value, rate.rest);
        (self.push_second, self.push_second_rest) = (second.value, second.rest);
        self.push_third = third;
    }

    /// A lane without a run.
    pub fn idle() -> Self {
        Self { flying: Flying::idle(), step: 1.0, ..Self::default() }
    }

    /// The lane of a run in flight; `None` if the event loop has to go on with the run.
    pub fn of<const BASE: bool>(run: &ScalarRun<'_, Siva<DrivenHost>>) -> Option<Self> {
        let Driven { equation, reach, step, excess, .. } = run.system.host.free();
        let harmonic = run.system.force().map(Force::harmonics)?.first()?;
        let flying = Flying::of(run, *reach)?;
        let mut lane = Self {
            amplitude: harmonic.amplitude,
            frequency: harmonic.frequency,
            angle: harmonic.phase,
            damping: equation.damping,
            growth: equation.growth,
            reach: *reach,
            step: *step,
            excess_0: excess[0],
            excess_1: excess[1],
            excess_2: excess[2],
            excess_3: excess[3],
            excess_4: excess[4],
            excess_5: excess[5],
            excess_6: excess[6],
            flying,
            ..Self::default()
        };
        lane.put_moment::<BASE>(&run.tally.state.host.phase);
        Some(lane)
    }

    /// Writes the variables back into the run.
    pub fn put_back<const BASE: bool>(&self, run: &mut ScalarRun<'_, Siva<DrivenHost>>) {
        let phase = self.state::<BASE>().host.phase;
        self.flying.put_back(run, phase);
    }
}
