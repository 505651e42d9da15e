//! One lane: a driven run reduced to the numbers that fast flights change, and arrays of such lanes.

use crate::compensated::DoubleDouble;
use crate::force::{Acts, Drive, Force, Harmonic, Pushes};
use crate::host::{Driven, DrivenHost, Host, Moment, Source};
use crate::lanes::ScalarRun;
use crate::lanes::arrays::arrays;
use crate::lanes::siva::flying::{Flying, Flyings};
use crate::oscillator::Equation;
use crate::siva::{Siva, SivaState};
use crate::steady::{Kept, Steady};
use crate::system::Clock;

arrays! {
    /// The numbers of one run.
    Lane,
    /// Lanes side by side: of every number an array.
    Lanes:
    /// Where the drive stands.
    instant, instant_rest,
    /// The force, f/M = amplitude · cos(frequency · t + angle).
    amplitude, frequency, angle,
    /// The structure.
    damping, growth, reach, step, excess_0, excess_1, excess_2, excess_3, excess_4, excess_5,
    /// From when on it counts, and the next strobe to keep.
    from, strobe, strobe_rest,
    /// What counts: the largest displacement and acceleration, the integral of x², listed impacts.
    largest, acceleration, square, square_rest, counted,
    /// Losses and work.
    viscous, viscous_rest, worked, worked_rest;
    /// The flight.
    flying: Flying, Flyings
}

/// The force of a lane: one harmonic force on the structure.
#[derive(Debug, Clone, Copy)]
pub(super) struct Single(Harmonic);

impl Source for Single {
    type Real = f64;
    #[inline(always)]
    fn pushes(&self, _from: Clock, time: Clock) -> Pushes {
        Pushes::of(&self.0, time)
    }

    #[inline(always)]
    fn drive(&self, time: Clock, h: f64) -> Drive<f64> {
        let mut drive = Drive::NONE;
        self.0.add(&mut drive.primary, time, h);
        drive
    }

    fn precise(&self, time: Clock, h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        self.0.add_precise(&mut drive.primary, time, h);
        drive
    }

    #[inline(always)]
    fn until_bend(&self, _moment: &Moment, reach: f64) -> (f64, Option<Clock>) {
        (reach, None)
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        false
    }

    fn bends(&self) -> bool {
        false
    }
}

impl Lane {
    /// The structure under its force.
    #[inline(always)]
    pub fn structure(&self) -> Driven<Single> {
        let Self { amplitude, frequency, angle: phase, damping, growth, .. } = *self;
        let third = DoubleDouble::new(1.0).over(3.0);
        let excess = [
            self.excess_0,
            self.excess_1,
            self.excess_2,
            self.excess_3,
            self.excess_4,
            self.excess_5,
        ];
        Driven {
            equation: Equation { stiffness: 1.0, frequency: 1.0, damping, growth, third },
            source: Single(Harmonic { amplitude, frequency, phase, acts: Acts::Primary }),
            base: [0.0; 4],
            reach: self.reach,
            step: self.step,
            excess,
        }
    }

    #[inline(always)]
    pub fn state(&self, free: &Driven<Single>) -> SivaState<Moment> {
        let time = DoubleDouble { value: self.instant, rest: self.instant_rest };
        self.flying.state(Moment { time, kicks: 0, pushes: free.source.pushes(time, time) })
    }

    /// A lane without a run.
    pub fn idle() -> Self {
        let never = f64::INFINITY;
        Self { flying: Flying::idle(), strobe: never, from: never, step: 1.0, ..Self::default() }
    }

    /// A run that has come to where fast flights can go on; `None` if it has not.
    pub fn of(run: &ScalarRun<'_, Siva<DrivenHost>>) -> Option<Self> {
        let Driven { equation, reach, step, excess, .. } = run.system.host.free();
        let harmonic = run.system.force().map(Force::harmonics)?.first()?;
        let flying = Flying::of(run, *reach)?;
        let (measures, steady) = &run.observer;
        let Kept { from, largest, acceleration, square, impacts, strobe } =
            steady.as_ref().map_or(Kept::NOTHING, Steady::kept);
        let time = run.tally.state.host.phase.time;
        Some(Self {
            instant: time.value,
            instant_rest: time.rest,
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
            from,
            strobe: strobe.value,
            strobe_rest: strobe.rest,
            largest,
            acceleration,
            square: square.value,
            square_rest: square.rest,
            counted: impacts as f64,
            viscous: measures.viscous.value,
            viscous_rest: measures.viscous.rest,
            worked: measures.work.value,
            worked_rest: measures.work.rest,
            flying,
        })
    }

    /// Puts the numbers back into the run.
    pub fn put_back(&self, run: &mut ScalarRun<'_, Siva<DrivenHost>>) {
        let phase = self.state(&self.structure()).host.phase;
        self.flying.put_back(run, phase);
        let sum = |value, rest| DoubleDouble { value, rest };
        let wall = run.streak.as_ref().map(|streak| streak.wall);
        let (measures, steady) = &mut run.observer;
        measures.viscous = sum(self.viscous, self.viscous_rest);
        measures.work = sum(self.worked, self.worked_rest);
        measures.moving = true;
        if let Some(steady) = steady {
            let kept = Kept {
                largest: self.largest,
                acceleration: self.acceleration,
                square: sum(self.square, self.square_rest),
                impacts: self.counted as u64,
                ..steady.kept()
            };
            steady.put_back(kept, wall);
        }
    }
}
