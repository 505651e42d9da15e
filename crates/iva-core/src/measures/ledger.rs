//! The energies that a run has exchanged with the outside.

use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Losses;

/// Sums of losses and work, in double-double.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ledger<R = f64> {
    /// Energy lost in the structure's damper.
    pub viscous: DoubleDouble<R>,
    /// Energy lost in the pivot of a pendulum.
    pub pivot: DoubleDouble<R>,
    /// Work of force, base and impulses.
    pub work: DoubleDouble<R>,
}

laned!(Ledger, Ledgers { viscous: DoubleDouble, pivot: DoubleDouble, work: DoubleDouble });

impl<R: Real> Default for Ledger<R> {
    fn default() -> Self {
        let nothing = DoubleDouble::ZERO;
        Self { viscous: nothing, pivot: nothing, work: nothing }
    }
}

impl<R: Real> Ledger<R> {
    /// The sums with those of one more motion.
    #[inline(always)]
    pub fn plus(&self, losses: &Losses<R>) -> Self {
        Self {
            viscous: self.viscous.plus(losses.viscous),
            pivot: self.pivot.plus(losses.pivot),
            work: self.work.plus(losses.work),
        }
    }
}
