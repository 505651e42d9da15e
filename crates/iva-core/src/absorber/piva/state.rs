//! The state of a structure and its pendulum between events.

use super::STEEP;
use crate::absorber::Wall;
use crate::host::oscillator::Primary;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Pendulum, Swing, refined_cosine};

/// The state of primary and pendulum between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PivaState<P = (), R = f64> {
    /// The state of the drive.
    pub(crate) phase: P,
    pub(crate) primary: Primary<R>,
    pub(crate) wall: Wall,
    /// The distance d − s y ≥ 0 to the wall last touched.
    pub(crate) distance: DoubleDouble<R>,
    pub(crate) clearance: R,
    /// W = b θ̇.
    pub(crate) w: DoubleDouble<R>,
    /// cosθ.
    pub(crate) cosine: DoubleDouble<R>,
    /// True just after a release, where W and Ẇ are exactly 0.
    pub(crate) released: bool,
}

laned!(
    PivaState<P>,
    PivaStates {
        phase: P,
        primary: Primary,
        wall: Wall,
        distance: DoubleDouble,
        clearance: f64,
        w: DoubleDouble,
        cosine: DoubleDouble,
        released: bool,
    }
);

impl<R: Real, P> PivaState<P, R> {
    /// The same state with another one of the drive.
    #[inline(always)]
    pub(crate) fn with_phase<Q>(self, phase: Q) -> PivaState<Q, R> {
        let Self { primary, wall, distance, clearance, w, cosine, released, .. } = self;
        PivaState { phase, primary, wall, distance, clearance, w, cosine, released }
    }

    /// Gap displacement y.
    #[inline(always)]
    pub(crate) fn y(&self) -> DoubleDouble<R> {
        let s = self.wall.sign();
        DoubleDouble::new(self.clearance * s)
            .plus_parts(self.distance.value * -s, self.distance.rest * -s)
    }

    /// The variables of the Taylor series.
    #[inline(always)]
    pub(crate) fn swing(&self, pendulum: &Pendulum<R>) -> Swing<R> {
        let (y, c) = (self.y().value, self.cosine.value);
        let Primary { x, v } = self.primary;
        Swing { x: x.value, u: v.value, y, w: self.w.value, c, arc: pendulum.arc(y, c) }
    }

    /// The same to twice the precision, with this cosine.
    #[inline(always)]
    pub(crate) fn precise_swing(
        &self,
        pendulum: &Pendulum<R>,
        c: DoubleDouble<R>,
    ) -> Swing<DoubleDouble<R>> {
        let (y, Primary { x, v }) = (self.y(), self.primary);
        Swing { x, u: v, y, w: self.w, c, arc: pendulum.arc(y, c) }
    }

    /// cosθ to twice the precision.
    #[inline(always)]
    pub(crate) fn precise_cosine(&self, pendulum: &Pendulum<R>) -> DoubleDouble<R> {
        let sine = self.y().over(pendulum.contact_distance);
        // Where the angle is steep the carried cosine knows it better than y does.
        let steep = pendulum.small_angles || sine.value.abs() >= STEEP;
        let precise = refined_cosine(sine, self.cosine.value);
        if steep { self.cosine } else { precise }
    }

    /// Distance to a wall.
    #[inline(always)]
    pub(super) fn distance_to(&self, wall: Wall) -> R {
        if wall == self.wall {
            self.distance.value
        } else {
            -self.distance.minus(self.clearance * 2.0)
        }
    }

    /// Gap velocity ẏ = c W.
    #[inline(always)]
    pub(super) fn gap_velocity(&self) -> R {
        self.cosine.value * self.w.value
    }
}
