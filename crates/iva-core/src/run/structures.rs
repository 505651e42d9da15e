//! The structures of lanes in the exact tier: what the motion of the structure of each lane depends on, whatever flies on it.

mod single;
mod undriven;

use std::fmt::Debug;

use crate::absorber::siva::exact::InFlight;
use crate::host::{Excitation, Host, HostState, Steps, Structure};
use crate::number::arrays::Laned;

pub(crate) use single::SingleForce;
pub(crate) use undriven::Undriven;

/// The structures of all lanes.
pub(crate) trait Structures: Debug + Sized + 'static {
    /// The state of the drive.
    type Phase: Laned + PartialEq;
    /// The structure of a run.
    type Host: Host<Real = f64> + Excitation<Phase = Self::Phase>;
    /// That of a lane without absorber.
    type One: Structure<Real = f64, Phase = Self::Phase>;
    /// True if the stages of a round go through all lanes one after the other, so that a processor can overlap
    /// them; false if too much would have to be stored in between.
    const STAGED: bool;

    /// Idle lanes for structures like this one.
    fn new(host: &Self::Host) -> Self;
    /// Uses the motion of a lane from a state.
    fn with<T>(
        &self,
        i: usize,
        from: &HostState<Self::Phase>,
        act: impl FnOnce(&InFlight<'_, Self::One>, &HostState<Self::Phase>) -> T,
    ) -> T;
    /// The longest stretch of a lane.
    fn longest(&self, i: usize) -> f64;
    /// The motion over whole steps, the same for all lanes; `None` if they have none.
    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        None
    }
    /// Loads the structure of a run into a lane; false if the lane cannot go on from this state.
    fn load(&mut self, i: usize, host: &Self::Host, from: &HostState<Self::Phase>) -> bool;
    /// Makes a lane idle; the state of its drive.
    fn idle(&mut self, i: usize) -> Self::Phase;
}
