//! One structure without drive, the same in all lanes.

use super::Structures;
use crate::absorber::siva::exact::InFlight;
use crate::host::oscillator::Oscillator;
use crate::host::{Host as _, HostState, Steps, UndrivenHost};

/// The structure of all lanes.
#[derive(Debug)]
pub(crate) struct Undriven {
    /// Held by value, so that the compiler knows that no store into a lane changes it.
    free: Oscillator,
    steps: Steps,
}

impl Structures for Undriven {
    type Phase = ();
    type Host = UndrivenHost;
    type One = Oscillator;
    const STAGED: bool = true;

    fn new(host: &UndrivenHost) -> Self {
        let free = host.free();
        Self { free: *free, steps: Steps::new(free) }
    }

    #[inline(always)]
    fn with<T>(
        &self,
        _i: usize,
        from: &HostState<()>,
        act: impl FnOnce(&InFlight<'_, Oscillator>, &HostState<()>) -> T,
    ) -> T {
        act(&InFlight { free: &self.free, course: &() }, from)
    }

    #[inline(always)]
    fn longest(&self, _i: usize) -> f64 {
        self.free.reach
    }

    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        Some(&self.steps)
    }

    fn load(&mut self, _i: usize, _host: &UndrivenHost, _from: &HostState<()>) -> bool {
        true
    }

    fn idle(&mut self, _i: usize) {}
}
