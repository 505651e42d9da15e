//! What the run of a lane does not change: pendulum, walls, force and limits.

use crate::absorber::impact::Impact;
use crate::absorber::piva::{Law, Piva, PivaState, Stops};
use crate::absorber::system::{Clock, Wall};
use crate::engine::simulate::Limits;
use crate::force::{Acts, Drive, Harmonic};
use crate::lanes::pick;
use crate::number::arrays::{Laned, laned};
use crate::number::compensated::DoubleDouble;
use crate::segment::taylor::{ORDER, Pendulum, Series, unrolled};

/// A pendulum under one harmonic force, which may be 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene {
    pub pendulum: Pendulum,
    pub stops: Stops,
    /// The impact laws at wall + and at wall −.
    pub laws: [Law; 2],
    /// The length that the tolerance on its gap is relative to.
    pub gap_size: f64,
    /// Fastest rate of primary, pendulum and force, without the swing.
    pub fastest: f64,
    /// The force: amplitude, frequency and phase; true if it moves the base.
    pub amplitude: f64,
    pub frequency: f64,
    pub phase: f64,
    pub moves_base: bool,
    /// The instant at which the run ends, in 1/ωn; limits on the numbers of impacts and of stretches of motion.
    pub stop: f64,
    pub max_impacts: f64,
    pub max_work: f64,
    /// Chatter floor: impacts with an approach speed at or below it are left to the event loop.
    pub floor: f64,
}

laned!(
    Scene,
    Scenes {
        pendulum: Pendulum,
        stops: Stops,
        laws: [Law; 2],
        gap_size: f64,
        fastest: f64,
        amplitude: f64,
        frequency: f64,
        phase: f64,
        moves_base: bool,
        stop: f64,
        max_impacts: f64,
        max_work: f64,
        floor: f64,
    }
);

impl Scene {
    pub fn of(piva: &Piva, limits: &Limits) -> Self {
        let (force, pendulum) = (piva.force(), piva.pendulum);
        let still = Harmonic { amplitude: 0.0, frequency: 0.0, phase: 0.0, acts: Acts::Primary };
        let Harmonic { amplitude, frequency, phase, .. } =
            force.harmonics().first().copied().unwrap_or(still);
        Self {
            pendulum,
            stops: piva.stops,
            laws: [Wall::Plus, Wall::Minus].map(|wall| *piva.law(wall)),
            gap_size: piva.gap_size(),
            fastest: pendulum.fastest().max(force.fastest()),
            amplitude,
            frequency,
            phase,
            moves_base: force.moves_base(),
            stop: limits.duration,
            max_impacts: limits.max_impacts as f64,
            max_work: limits.max_work as f64,
            floor: limits.chatter_floor,
        }
    }

    /// The harmonic force, as one that acts on the primary.
    #[inline(always)]
    fn harmonic(&self) -> Harmonic {
        let Self { amplitude, frequency, phase, .. } = *self;
        Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
    }

    /// A number of the force as the pair for f/M and a_g, one of which is 0.
    #[inline(always)]
    fn acting(&self, number: f64) -> [f64; 2] {
        [pick(self.moves_base, 0.0, number), pick(self.moves_base, number, 0.0)]
    }

    /// Coefficients of the force in powers of time over h.
    #[inline(always)]
    pub fn drive<const LENGTH: usize>(&self, time: Clock, h: f64) -> Drive<f64, LENGTH> {
        let mut row = [0.0; LENGTH];
        self.harmonic().add(&mut row, time, h);
        let mut drive = Drive::NONE;
        unrolled!(k < if LENGTH > ORDER { ORDER + 1 } else { LENGTH } => {
            [drive.primary[k], drive.base[k]] = self.acting(row[k]);
        });
        drive
    }

    /// The first two coefficients of the force in powers of time, to twice the precision.
    #[inline(always)]
    pub fn beginning(&self, time: Clock) -> Drive<DoubleDouble, 2> {
        let [value, rate] = self.harmonic().push(time).beginning().map(
            #[inline(always)]
            |DoubleDouble { value, rest }| {
                let ([f, g], [f_rest, g_rest]) = (self.acting(value), self.acting(rest));
                let [f, g] = [(f, f_rest), (g, g_rest)];
                [f, g].map(|(value, rest)| DoubleDouble { value, rest })
            },
        );
        Drive { primary: [value[0], rate[0]], base: [value[1], rate[1]] }
    }

    /// Bounds on what is left out of the force ([`crate::force::Force::left_out`]).
    #[inline(always)]
    pub fn left_out<const N: usize>(&self, h: f64) -> [f64; 2] {
        self.acting(self.harmonic().left_out::<N>(h))
    }

    /// The first coefficients of the flight from a state.
    #[inline(always)]
    pub fn ahead<const DRIVEN: bool, const LENGTH: usize>(
        &self,
        state: &PivaState,
    ) -> Series<f64, LENGTH> {
        let drive = if DRIVEN { Some(self.drive(state.time, 1.0)) } else { None };
        self.pendulum.beginning(&state.swing(), drive.as_ref())
    }

    /// The impact at an instant, and the state after it.
    #[inline(always)]
    pub fn struck(&self, touching: &PivaState, time: f64) -> (PivaState, Impact) {
        self.law(touching.wall).struck(touching, time, self.pendulum.lever)
    }

    /// The impact law at a wall.
    #[inline(always)]
    pub fn law(&self, wall: Wall) -> Law {
        let [plus, minus] = &self.laws;
        Law::pick(wall == Wall::Plus, plus, minus)
    }
}
