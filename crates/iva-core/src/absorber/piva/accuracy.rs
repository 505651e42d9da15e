//! Order and step length of the flight, from its tolerance.

use super::{Parameters, Piva, PivaState};
use crate::force::Force;
use crate::host::{Host, Phase};
use crate::number::real::Real;
use crate::segment::roots::DOUBT;
use crate::segment::taylor::{ORDER, Remainder, Series, with_order};
use std::f64::consts::LN_2;

/// How accurately a flight is computed, and at what cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy<R = f64> {
    /// Largest truncation error of a step, relative to the size of each variable.
    pub tolerance: R,
    /// Order of the series.
    pub order: usize,
    /// Longest step, over the fastest time scale of the motion.
    pub longest_step: f64,
}

impl<R: Real> Accuracy<R> {
    /// Order and step that are cheap for a tolerance; 0 means full accuracy.
    pub fn of(tolerance: R) -> Self {
        let tolerance = tolerance.max(R::LEFT_OUT);
        let (order, longest_step) = match tolerance {
            t if t >= 1e-7 => (10, 0.9),
            t if t >= 1e-10 => (16, 1.2),
            t if t >= 1e-13 => (16, 0.8),
            _ => (ORDER, 0.9),
        };
        Self { tolerance, order, longest_step }
    }

    /// Bound on the error of y relative to the clearance, from truncation and rounding.
    pub fn doubt(&self) -> R {
        self.tolerance + (R::EPSILON * 0.5) * DOUBT
    }
}

/// Factor of each further shortening of a step.
pub(crate) const SHORTER: f64 = 0.84;
/// Largest number of further shortenings of a step, down to 2⁻²⁰ of it.
pub(crate) const MOST_SHORTENINGS: u32 = 80;
/// Largest number of halvings of a step on which no bound can be proved, down to 2⁻²⁰ of it.
pub(crate) const MOST_HALVINGS: u32 = 20;

/// The share of a step on which its series leaves out no more than the tolerance.
pub(super) fn share_kept<R: Real>(
    remainder: &Remainder<R>,
    piva: &Piva<impl Host<Real = R>>,
    from: &PivaState<impl Copy, R>,
    driven: R,
) -> Option<R> {
    let sizes = Sizes::of(piva, from, driven);
    let tolerance = piva.accuracy.tolerance;
    let (mut share, mut kept) = sizes.share(remainder, tolerance);
    for _ in 0..MOST_SHORTENINGS {
        if kept {
            return Some(share);
        }
        share *= SHORTER;
        kept = sizes.keep(remainder, share, tolerance);
    }
    None
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    /// The share of a step, up to `most`, on which its series is proved to leave out no more than the tolerance;
    /// `None` if that can be proved of no share.
    pub(super) fn share_proved(
        &self,
        series: &Series<R>,
        (step, most): (R, R),
        from: &PivaState<Phase<H>, R>,
        driven: R,
    ) -> Option<R> {
        let (mut fastest, mut most) = (self.fastest(), most);
        for _ in 0..MOST_HALVINGS {
            let remainder = {
                with_order!(self.accuracy.order, N => {
                    let left_out = self.force().map_or([R::ZERO; 2], |it| it.left_out::<N>(step * most));
                    Remainder::new::<N>(&self.pendulum, fastest, series, left_out, (step, most))
                })
            };
            if remainder.proves() {
                return share_kept(&remainder, self, from, driven);
            }
            // A structure that moves many lengths of the pendulum swings it faster than its own rates tell.
            most *= 0.5;
            fastest *= 2.0;
        }
        None
    }

    /// The fastest rate in the equations but for the swing: of primary, pendulum and force.
    pub(crate) fn fastest(&self) -> R {
        self.pendulum.fastest().max(self.force().map_or(R::ZERO, Force::fastest))
    }
}

/// A little less than excess^(−1/order), but not less than a fifth.
#[inline(always)]
pub(crate) fn shortening<R: Real>(excess: R, order: usize) -> f64 {
    // e^(−z) by a series cut off at a negative term.
    let z = R::log2_above(excess) * (LN_2 / order as f64);
    let z = if z < 1.5 { z } else { 1.5 };
    let tail = 1.0 / 6.0 - z * (1.0 / 24.0 - z * (1.0 / 120.0));
    if excess > 1.0 { 1.0 - z * (1.0 - z * (0.5 - z * tail)) } else { 1.0 }
}

/// Sizes of the variables of primary and gap, which the tolerance is relative to.
pub(crate) struct Sizes<R = f64> {
    pub primary: R,
    pub gap: R,
}

impl<R: Real> Sizes<R> {
    /// The sizes at a state, under a force of size `driven`.
    pub(crate) fn of(
        piva: &Piva<impl Host<Real = R>>,
        state: &PivaState<impl Copy, R>,
        driven: R,
    ) -> Self {
        Self::at(piva.parameters.mass_ratio, piva.gap_size(), state).with(driven)
    }

    /// The sizes at a state without force, for an absorber with this mass ratio and gap.
    #[inline(always)]
    pub(crate) fn at(mass_ratio: R, gap: R, state: &PivaState<impl Copy, R>) -> Self {
        let moved = state.primary.x.value.abs() + state.primary.v.value.abs();
        Self { primary: moved.max(mass_ratio * gap), gap }
    }

    /// The sizes under a force of size `driven`.
    #[inline(always)]
    pub(crate) fn with(self, driven: R) -> Self {
        Self { primary: self.primary.max(driven), ..self }
    }

    /// The share of a step on which its series leaves out no more than the tolerance, if that is not far less than
    /// the share that the remainder was bounded for.
    #[inline(always)]
    pub(crate) fn share(&self, remainder: &Remainder<R>, tolerance: R) -> (R, bool) {
        let whole = remainder.most();
        let [primary, gap] = remainder.left_out(whole);
        let excess = R::larger(primary / (tolerance * self.primary), gap / (tolerance * self.gap));
        let excess = R::larger(remainder.within(whole), excess);
        let share = whole * shortening(excess, remainder.order() + 1);
        (share, self.keep(remainder, share, tolerance))
    }

    /// True if a series leaves out no more than the tolerance on a share of its step.
    #[inline(always)]
    pub(crate) fn keep(&self, remainder: &Remainder<R>, share: R, tolerance: R) -> bool {
        let [primary, gap] = remainder.left_out(share);
        (primary <= tolerance * self.primary)
            & (gap <= tolerance * self.gap)
            & (remainder.within(share) <= 1.0)
    }
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    /// The length that the tolerance on y is relative to: clearance, or contact distance if that is smaller.
    pub(crate) fn gap_size(&self) -> R {
        let Parameters { clearance, contact_distance, .. } = self.parameters;
        if self.stop_reachable() { clearance } else { clearance.min(contact_distance) }
    }
}
