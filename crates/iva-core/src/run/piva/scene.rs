//! What the run of a lane does not change: pendulum, walls and force.

use super::drive::{Laid, Swinging};
use crate::absorber::Wall;
use crate::absorber::impact::Impact;
use crate::absorber::piva::{Law, Piva, PivaState, Stops};
use crate::force::{Acts, Drive, Harmonic, Push, Pushes};
use crate::host::{DrivenHost, Excitation as _};
use crate::number::arrays::{Laned, laned};
use crate::number::real::pick;
use crate::segment::taylor::{ORDER, Pendulum, Series, unrolled};

/// A pendulum under one harmonic force, which may be 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene {
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
    }
);

impl Scene {
    pub fn of(piva: &Piva<DrivenHost>) -> Self {
        let pendulum = piva.pendulum;
        let still = Harmonic { amplitude: 0.0, frequency: 0.0, phase: 0.0, acts: Acts::Primary };
        let Harmonic { amplitude, frequency, phase, .. } =
            piva.force().and_then(|force| force.harmonics().first()).copied().unwrap_or(still);
        Self {
            pendulum,
            stops: piva.stops,
            laws: [Wall::Plus, Wall::Minus].map(|wall| *piva.law(wall)),
            gap_size: piva.gap_size(),
            fastest: piva.fastest(),
            amplitude,
            frequency,
            phase,
            moves_base: piva.host.moves_base(),
        }
    }

    /// The harmonic force, as one that acts on the primary.
    #[inline(always)]
    pub fn harmonic(&self) -> Harmonic {
        let Self { amplitude, frequency, phase, .. } = *self;
        Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
    }

    /// A number of the force as the pair for f/M and a_g, one of which is 0.
    #[inline(always)]
    fn acting(&self, number: f64) -> [f64; 2] {
        [pick(self.moves_base, 0.0, number), pick(self.moves_base, number, 0.0)]
    }

    /// f/M and a_g of a value of the force.
    #[inline(always)]
    pub fn pushes(&self, push: &Push) -> Pushes {
        Pushes {
            primary: Push::pick(self.moves_base, &Push::NONE, push),
            base: Push::pick(self.moves_base, push, &Push::NONE),
        }
    }

    /// Coefficients of the force in powers of time over h, from value and rate at an instant.
    #[inline(always)]
    pub fn drive(&self, push: &Push, h: f64) -> Drive<f64> {
        let row = self.harmonic().onwards(push, h);
        let mut drive = Drive::NONE;
        unrolled!(k < ORDER + 1 => {
            [drive.primary[k], drive.base[k]] = self.acting(row[k]);
        });
        drive
    }

    /// Bounds on what is left out of the force ([`crate::force::Force::left_out`]).
    #[inline(always)]
    pub fn left_out<const N: usize>(&self, h: f64) -> [f64; 2] {
        self.acting(self.harmonic().left_out::<N>(h))
    }

    /// The first coefficients of the flight from a state.
    #[inline(always)]
    pub fn ahead<H: Swinging, const LENGTH: usize>(&self, state: &Laid<H>) -> Series<f64, LENGTH> {
        let push = H::plain_push(self, state.phase);
        let drive = if H::DRIVEN { Some(self.pushes(&push).ahead()) } else { None };
        self.pendulum.beginning(&state.swing(&self.pendulum), drive.as_ref())
    }

    /// The impact at an instant, and the state after it.
    #[inline(always)]
    pub fn struck<P: Copy>(&self, touching: &PivaState<P>, time: f64) -> (PivaState<P>, Impact) {
        self.law(touching.wall).struck(touching, time, self.pendulum.lever)
    }

    /// The impact law at a wall.
    #[inline(always)]
    pub fn law(&self, wall: Wall) -> Law {
        let [plus, minus] = &self.laws;
        Law::pick(wall == Wall::Plus, plus, minus)
    }
}
