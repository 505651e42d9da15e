//! Order and step of the flight, from its tolerance.

use super::{Parameters, Piva, PivaState};
use crate::real::{LEFT_OUT, Real};
use crate::roots::DOUBT;
use crate::taylor::{ORDER, Remainder};

/// How accurately a flight is computed, and at what cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// What a step may leave out, relative to the size of each variable.
    pub tolerance: Real,
    /// Order of the series.
    pub order: usize,
    /// Longest step, over the fastest time scale of the motion.
    pub longest_step: f64,
}

impl Accuracy {
    /// Order and step that are cheap for a tolerance; 0 means full accuracy.
    pub fn of(tolerance: Real) -> Self {
        let tolerance = tolerance.max(LEFT_OUT);
        let (order, longest_step) = match tolerance {
            t if t >= 1e-7 => (10, 0.9),
            t if t >= 1e-10 => (16, 1.2),
            t if t >= 1e-13 => (18, 1.0),
            _ => (ORDER, 0.75),
        };
        Self { tolerance, order, longest_step }
    }

    /// What y may be off relative to the clearance: what a step leaves out, and rounding.
    pub fn doubt(&self) -> Real {
        self.tolerance + DOUBT * (0.5 * Real::EPSILON)
    }
}

/// Steps are shortened by this factor, about 2^(−1/4), until they keep to the tolerance.
const SHORTER: f64 = 0.84;
/// At most this often, to 2⁻²⁰.
const MOST_SHORTENINGS: u32 = 80;

/// The share of a step, up to `most`, on which its series leaves out no more than the tolerance.
pub(super) fn share_kept(
    remainder: &Remainder,
    most: Real,
    piva: &Piva,
    from: &PivaState,
    driven: Real,
) -> Option<Real> {
    let sizes = Sizes::of(piva, from, driven);
    let tolerance = piva.accuracy.tolerance;
    let mut share = remainder.reach(most);
    for _ in 0..MOST_SHORTENINGS {
        let [primary, gap] = remainder.left_out(share);
        if primary <= tolerance * sizes.primary && gap <= tolerance * sizes.gap {
            return Some(share);
        }
        share *= SHORTER;
    }
    None
}

/// Sizes that truncation is measured against.
pub(crate) struct Sizes {
    pub primary: Real,
    pub gap: Real,
}

impl Sizes {
    /// At a state, under a force of size `driven`.
    pub(crate) fn of(piva: &Piva, state: &PivaState, driven: Real) -> Self {
        let Parameters { clearance, contact_distance, .. } = piva.parameters;
        let gap = if piva.stop_reachable() { clearance } else { clearance.min(contact_distance) };
        let moved = state.primary.x.value.abs() + state.primary.v.value.abs();
        let moved = moved.max(piva.parameters.mass_ratio * gap).max(driven);
        Self { primary: moved, gap }
    }
}
