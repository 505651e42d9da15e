//! The measures of the displacement of a decay, applied to the stretch that each lane has completed.

use super::lane::Lanes;
use super::motion::{FREE, State};
use super::responses::Tables;
use super::step::Rounds;
use super::turning::{Turned, turned};
use crate::lanes::decay::Decays;
use crate::lanes::pick;
use crate::lanes::watch::Stretch;

/// Applies the measures to each completed stretch. A stretch whose extremum of x is not known is halved.
#[inline(always)]
pub(super) fn watch<const W: usize>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
    rounds: &mut Rounds<W>,
    decays: &mut Decays<W>,
) {
    for i in 0..W {
        let (state, structure, round) = (lanes.state.get(i), lanes.structure.get(i), rounds.get(i));
        let length = round.length + round.later;
        let jets = |at: &State| {
            let [_, [bend, third, fourth, fifth, ..]] = structure.derivatives::<FREE>(at);
            [at.x, at.v, bend, third, fourth, fifth]
        };
        let (begin, end) = (jets(&state), jets(&round.end));
        let Turned { h: turned, value: x_turned, exact } = turned::<W, FREE>(
            (&structure, tables, i),
            &state,
            (&begin, &end),
            jets,
            (structure.bound::<4>(&state), length),
        );
        let turns = state.v * round.end.v < 0.0;
        let (h, x) = (pick(turns, turned, 0.0), pick(turns, x_turned, state.x));
        let stretch =
            Stretch { x: [state.x, x, round.end.x], h: [0.0, h, length], turns, loss: 0.0 };
        let decay = decays.get(i);
        let simple = (exact | !turns) & stretch.ends(decay.watch.peak_sign).simple();
        let passed = round.passed > 0.0;
        let clock = lanes.clock(i);
        decays.set(i, &decay.after(&stretch, [state.x, state.v, begin[2]], clock, passed & simple));
        let asks = passed & !simple;
        rounds.passed[i] = pick(asks, 0.0, round.passed);
        rounds.hit[i] = pick(asks, 0.0, round.hit);
    }
}
