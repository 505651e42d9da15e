//! Structures under one harmonic force each, on the structure or on its base.

use super::Structures;
use crate::absorber::siva::exact::InFlight;
use crate::force::{Acts, Drive, Force, Harmonic, Push, Pushes, Smooth};
use crate::host::oscillator::Equation;
use crate::host::{
    self, DrivenHost, Excitation as _, Host as _, HostState, Moment, Source, Structure as _, Weight,
};
use crate::number::arrays::{Lanes as _, arrays};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;

arrays! {
    /// The structure of one driven lane.
    Scene, Scenes:
    /// The force: f/M or a_g = amplitude · cos(frequency · t + angle).
    amplitude, frequency, angle,
    /// Gravity along the motion.
    gravity,
    /// The constants of the structure ([`host::Driven`]).
    damping, growth, reach, step;
    /// The lift of the spring in flight.
    lift: DoubleDouble,
    excess: [f64; 7],
}

/// What acts on a lane: one harmonic force, on the structure or its base, and gravity along the motion if `HEAVY`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Single<const BASE: bool, const HEAVY: bool> {
    harmonic: Harmonic,
    weight: Weight,
}

impl<const BASE: bool, const HEAVY: bool> Single<BASE, HEAVY> {
    /// f/M, and a_g plus gravity along the motion, where the force is `push`.
    #[inline(always)]
    fn pushes_of(&self, push: Push) -> Pushes {
        let mut pushes = if BASE {
            Pushes { base: push, ..Pushes::NONE }
        } else {
            Pushes { primary: push, ..Pushes::NONE }
        };
        if HEAVY {
            pushes.base.value = pushes.base.value.plus(self.weight.gravity);
        }
        pushes
    }

    /// The same pushes, without those that are known to be 0: the compiler leaves out what is computed with them.
    #[inline(always)]
    fn known(&self, pushes: &Pushes) -> Pushes {
        match (BASE, HEAVY) {
            (true, _) => Pushes { base: pushes.base, ..Pushes::NONE },
            (false, false) => Pushes { primary: pushes.primary, ..Pushes::NONE },
            (false, true) => self.pushes_of(pushes.primary),
        }
    }
}

impl<const BASE: bool, const HEAVY: bool> Source for Single<BASE, HEAVY> {
    type Real = f64;
    #[inline(always)]
    fn pushes(&self, _from: &Moment, time: Clock) -> Pushes {
        self.pushes_of(self.harmonic.push(time))
    }

    #[inline(always)]
    fn plain_pushes(&self, _from: &Moment, time: Clock) -> Pushes {
        self.pushes_of(self.harmonic.plain_push(time))
    }

    #[inline(always)]
    fn drive(&self, moment: &Moment, h: f64) -> Drive<f64> {
        let Pushes { primary, mut base } = moment.pushes;
        if BASE {
            if HEAVY {
                base.value = base.value.plus(-self.weight.gravity);
            }
            Drive { base: self.harmonic.onwards(&base, h), ..Drive::NONE }
        } else {
            Drive { primary: self.harmonic.onwards(&primary, h), ..Drive::NONE }
        }
    }

    fn precise(&self, time: Clock, h: f64) -> Drive<DoubleDouble> {
        let mut drive = Drive::NOTHING;
        let row = if BASE { &mut drive.base } else { &mut drive.primary };
        self.harmonic.add_precise(row, time, h);
        if HEAVY {
            drive.base[0] = drive.base[0].plus(self.weight.gravity);
        }
        drive
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        BASE || HEAVY
    }

    fn bends(&self) -> bool {
        false
    }

    #[inline(always)]
    fn weight(&self) -> Option<Weight> {
        HEAVY.then_some(self.weight)
    }
}

/// Structures under one harmonic force each, on the structure or on its base, with gravity along the motion if `HEAVY`.
#[derive(Debug)]
pub(crate) struct SingleForce<const BASE: bool, const HEAVY: bool, const W: usize>(Scenes<W>);

impl<const BASE: bool, const HEAVY: bool, const W: usize> Structures
    for SingleForce<BASE, HEAVY, W>
{
    type Phase = Moment;
    type Host = DrivenHost;
    type One = host::Driven<Single<BASE, HEAVY>>;
    const STAGED: bool = false;

    fn new(_host: &DrivenHost) -> Self {
        Self(Scenes::new())
    }

    #[inline(always)]
    fn with<T>(
        &self,
        i: usize,
        from: &HostState<Moment>,
        act: impl FnOnce(&InFlight<'_, Self::One>, &HostState<Moment>) -> T,
    ) -> T {
        let Scene { amplitude, frequency, angle: phase, gravity, lift, .. } = self.0.get(i);
        let Scene { damping, growth, reach, step, excess, .. } = self.0.get(i);
        let third = DoubleDouble::new(1.0).over(3.0);
        let source = Single {
            harmonic: Harmonic { amplitude, frequency, phase, acts: Acts::Primary },
            weight: Weight { gravity, lift },
        };
        let equation = Equation { stiffness: 1.0, frequency: 1.0, damping, growth, third };
        let free = host::Driven { equation, source, base: [0.0; 5], reach, step, excess };
        let mut from = *from;
        from.phase.pushes = source.known(&from.phase.pushes);
        let course = free.course(&from);
        act(&InFlight { free: &free, course: &course }, &from)
    }

    #[inline(always)]
    fn longest(&self, i: usize) -> f64 {
        self.0.reach[i]
    }

    fn load(&mut self, i: usize, host: &DrivenHost, _from: &HostState<Moment>) -> bool {
        let host::Driven { equation, source, reach, step, excess, .. } = host.free();
        let Weight { gravity, lift } = source.weight().unwrap_or(Weight::NONE);
        let harmonics = host.force().map(Force::harmonics);
        let Some(harmonic) = harmonics.and_then(<[Harmonic]>::first) else { return false };
        let scene = Scene {
            amplitude: harmonic.amplitude,
            frequency: harmonic.frequency,
            angle: harmonic.phase,
            gravity,
            lift,
            damping: equation.damping,
            growth: equation.growth,
            reach: *reach,
            step: *step,
            excess: *excess,
        };
        self.0.set(i, &scene);
        true
    }

    fn idle(&mut self, i: usize) -> Moment {
        self.0.set(i, &Scene { step: 1.0, ..Scene::default() });
        Moment { time: Clock::ZERO, kicks: 0, smooth: Smooth::ALL, pushes: Pushes::NONE }
    }
}
