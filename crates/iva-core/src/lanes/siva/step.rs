//! One evaluation of a free decay: its flight, and the measures along it.
//!
//! The operations and their order are those of [`Measures`](crate::measures::Measures), without branches.

use super::lane::Lane;
use super::look::look;
use crate::host::turning::{turn, turning};
use crate::lanes::pick;
use crate::lanes::watch::Stretch;
use crate::oscillator::{Oscillator, Primary};
use crate::siva::SivaState;

/// The lane after one evaluation.
#[inline(always)]
pub(super) fn step<const LEDGER: bool, const DECAY: bool>(free: &Oscillator, lane: &Lane) -> Lane {
    let flying = &lane.flying;
    if !DECAY {
        let nowhere = |_: &SivaState, _: &SivaState, _| [1.0, -1.0, 0.0, 0.0, 0.0, 0.0];
        let look = look(free, &(), flying, flying.state(()), nowhere);
        let mut next = *lane;
        next.flying = look.next(flying, free.reach, look.passed);
        if LEDGER {
            let Primary { x, v } = look.from.host.primary;
            let loss = free.viscous_loss_series(x.value, v.value, look.length);
            next.decay.watch = lane.decay.watch.losing(loss, look.passed);
        }
        return next;
    }
    let turns = |from: &SivaState, end: &SivaState, length: f64| {
        turn(free.leading(&from.host), free.leading(&end.host), length)
    };
    let look = look(free, &(), flying, flying.state(()), turns);
    let (length, part) = (look.length, look.part);
    let span = Span::of::<LEDGER>(free, lane, &look.from, &look.end, [length, length * part]);
    let done = look.passed & span.simple;
    let mut next = *lane;
    next.flying = look.next(flying, free.reach, done);
    next.decay = lane.decay.after(&span.stretch, span.origin, flying.clock(), done);
    next
}

/// A stretch of motion, x, ẋ and ẍ at its begin, and whether its measures need no event loop.
struct Span {
    origin: [f64; 3],
    stretch: Stretch,
    simple: bool,
}

impl Span {
    #[inline(always)]
    fn of<const LEDGER: bool>(
        free: &Oscillator,
        lane: &Lane,
        from: &SivaState,
        end: &SivaState,
        [length, turn]: [f64; 2],
    ) -> Self {
        let (x, v) = (from.host.primary.x.value, from.host.primary.v.value);
        let turns = v * end.host.primary.v.value < 0.0;
        let fifth = free.equation.bound::<3>(&from.host.primary);
        let (h_turn, x_turn, exact) = turning(free.jets(&from.host, turn), fifth, turn, length);
        let (h_turn, x_turn) = (pick(turns, h_turn, 0.0), pick(turns, x_turn, x));
        let loss = if LEDGER { free.viscous_loss_series(x, v, length) } else { 0.0 };
        let (x_end, h) = (end.host.primary.x.value, [0.0, h_turn, length]);
        let stretch = Stretch { x: [x, x_turn, x_end], h, turns, loss };
        let simple = (exact | !turns) & stretch.ends(lane.decay.watch.peak_sign).simple();
        Self { origin: [x, v, from.host.acceleration.value], stretch, simple }
    }
}
