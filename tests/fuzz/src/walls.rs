//! The absorber stays between its walls.

use iva_core::absorber::Absorber;
use iva_core::flight::Motion;
use iva_core::observe::{Observer, Span};

/// Rounding of a distance, over the clearance: an extremum within 16 · 2⁻⁵³ of a wall counts as no
/// contact, and is evaluated with as much.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far the absorber was beyond a wall, at most.
#[derive(Debug)]
pub struct Walls {
    stiffness: f64,
    /// Where it was farthest.
    pub worst: Place,
}

/// A place in the gap.
#[derive(Debug, Default, Clone, Copy)]
pub struct Place {
    /// Beyond a wall by so much, over what rounding explains.
    pub share: f64,
    /// From the begin of the run.
    pub time: f64,
    /// Distance to the wall last touched.
    pub distance: f64,
    /// Speed away from it.
    pub rate: f64,
}

impl Walls {
    /// Nothing seen yet. A displacement and a velocity of the primary of size 1 accelerate the absorber
    /// in its gap by no more than `stiffness`.
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness, worst: Place::default() }
    }
}

impl<S: Absorber<Real = f64>> Observer<S> for Walls {
    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        let d = system.clearance();
        let pull = self.stiffness * (span.from.x.abs() + span.from.v.abs());
        for part in [0.0, 1e-9, 0.25, 0.5, 0.75, 1.0 - 1e-9, 1.0] {
            let h = part * span.length;
            let jet = system.distance(&span.motion.state(h));
            let beyond = (-jet.value).max(jet.value - 2.0 * d);
            // The instant of a contact is a double: right to its last place, in which it moves. The
            // acceleration is rounded as well, which counts where a gap is tiny beside the motion.
            let moved = jet.rate.abs() + h * (pull + jet.curvature.abs());
            let allowed = ROUNDING * d + f64::EPSILON * h * moved;
            let finite = jet.value.is_finite() && jet.rate.is_finite();
            let share = if finite { beyond / allowed } else { f64::INFINITY };
            if share > self.worst.share {
                let time = span.start.plus(h).value;
                self.worst = Place { share, time, distance: jet.value, rate: jet.rate };
            }
        }
    }
}
