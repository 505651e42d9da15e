//! One evaluation of a driven flight in each lane.

use super::lane::Lanes;
use crate::arrays::arrays;
use crate::host::Structure;
use crate::lanes::pick;
use crate::lanes::siva::look::look;
use crate::plain::{State, States};
use crate::siva::SivaState;

arrays! {
    /// A flight that an evaluation has completed.
    Ended,
    /// [`Ended`] of many runs: every field an array over the lanes.
    Ends:
    /// The clock at its begin, its length (0: there is none), and the approach speed of the impact at its end
    /// (0: none).
    time, time_rest, length, approach;
    /// The states at both ends, in plain doubles.
    begin: State, States,
    end: State, States
}

/// One evaluation of each lane; `ended` takes the flights that it completes.
#[inline(always)]
pub(super) fn steps<const W: usize, const BASE: bool>(lanes: &mut Lanes<W>, ended: &mut Ends<W>) {
    for i in 0..W {
        let lane = lanes.get(i);
        let free = lane.structure::<BASE>();
        let from = lane.state::<BASE>();
        let course = free.course(&from.host);
        let flying = &lane.flying;
        let look = look(&free, &course, flying, from);
        let state = look.next_state();
        let mut next = lane;
        next.put_moment::<BASE>(&state.host.phase);
        next.flying = look.next(flying, lane.reach);
        lanes.set(i, &next);

        let length = pick(look.passed, look.length, 0.0);
        let (begin, end) = (in_doubles(&look.from), in_doubles(&look.end));
        let (time, time_rest, approach) = (flying.time, flying.time_rest, look.approach_speed());
        ended.set(i, &Ended { time, time_rest, length, approach, begin, end });
    }
}

/// A state in plain doubles, without its force.
#[inline(always)]
fn in_doubles<P>(state: &SivaState<P>) -> State {
    State {
        x: state.host.primary.x.value,
        v: state.host.primary.v.value,
        distance: state.distance.value,
        rate: state.rate.value,
        side: state.side,
        ..State::default()
    }
}
