//! One evaluation of a driven flight in each lane.

use super::lane::Lanes;
use super::log::{End, Flight, Flights};
use crate::host::Structure;
use crate::lanes::pick;
use crate::lanes::siva::look::look;

/// One evaluation of each lane; `ended` takes the flights that it completes.
#[inline(always)]
pub(super) fn steps<const W: usize, const BASE: bool, const EXTREMES: bool>(
    lanes: &mut Lanes<W>,
    ended: &mut Flights<W>,
) {
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
        let begin = End::new(&free, &look.from.host, EXTREMES);
        let end = End::new(&free, &look.end.host, EXTREMES);
        let flight = Flight::new(&look.from, flying.clock(), length, [begin, end]);
        let (impact_time, impact_wall, approach) = look.impact(&next.flying);
        ended.set(i, &Flight { impact_time, impact_wall, approach, ..flight });
    }
}
