//! Lanes in which trajectories go from cycle to cycle ([`crate::orbit`]).

use super::side_by_side::Loaded;
use crate::absorber::Absorber;
use crate::engine::simulate::Run;
use crate::measures::forced::Forced;
use crate::measures::propagation::Tangent;

/// A set of such lanes. A lane takes a run over, and can repeat
/// it from another state.
pub(crate) trait Cycling<S: Absorber<Real = f64>>: Sized {
    /// Number of lanes.
    const WIDTH: usize;
    /// Idle lanes for absorbers like this one.
    fn cycling(leader: &S) -> Self;
    /// Advances each lane by one evaluation; true if a lane needs something of its run.
    fn evaluate(&mut self) -> bool;
    /// True if a lane needs something of its run.
    fn requests(&self, i: usize) -> bool;
    /// True if a lane has come to the end of its run and needs nothing else.
    fn is_at_end(&self, i: usize) -> bool;
    /// The state of a lane; the derivatives of its force may be missing.
    fn shown(&self, i: usize, system: &S) -> S::State;
    /// The number of impacts of its run so far.
    fn impacts(&self, i: usize) -> u64;
    /// Keeps the impacts of a lane from now on, for [`Cycling::follow`].
    fn listen(&mut self, i: usize);
    /// Carries a derivative through the impacts kept so far, and forgets them.
    fn follow(&mut self, i: usize, system: &S, tangent: &mut Tangent);
    /// Loads a run into a lane; false if the event loop has to go on with it.
    fn take_cycle<O>(&mut self, i: usize, run: &Run<'_, S, O>, forced: Option<&Forced>) -> bool;
    /// Writes the variables of a lane back into its run.
    fn put_back_cycle<O>(&mut self, i: usize, run: &mut Run<'_, S, O>);
    /// Lets a lane make its run once more from another state; false if that is left to the event loop.
    fn repeat(&mut self, i: usize, from: &Loaded<'_, S>) -> bool;
    /// Makes a lane idle.
    fn rest(&mut self, i: usize);
}
