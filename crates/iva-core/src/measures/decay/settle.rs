//! The last passages of the settling levels, looked for from the end of a log back.

use std::array::from_fn;

use super::{Decay, Measures, length, motions};
use crate::host::sinusoid::Passage;
use crate::log::Entry;
use crate::real::Real;
use crate::system::{Clock, System};

impl Decay {
    /// Finds the last passage of each settling level.
    #[inline(always)]
    pub(super) fn settle<S: System>(&self, measures: &mut Measures<S>, log: &[Entry]) {
        let amplitude = measures.reference.amplitude;
        let mut levels = measures.settling.each_ref().map(|it| Some(it.level(amplitude).double()));
        let mut found: [Option<(Clock, Passage)>; 3] = [None; 3];
        for (k, entry) in motions(log).iter().enumerate().rev() {
            let Some(least) = levels.iter().flatten().copied().reduce(f64::min) else { break };
            let structure = self.structure(entry);
            if structure.radius(entry.from()) <= least {
                continue;
            }
            let end = &log[k + 1];
            let mut right = (length(entry, end), end.x);
            let turns = self.turns_of(k, entry, right.0);
            for left in std::iter::once((0.0, entry.x)).chain(turns).rev() {
                for (i, level) in levels.iter_mut().enumerate() {
                    let passes = |level: &f64| left.1.abs() > *level && right.1.abs() <= *level;
                    let Some(size) = level.take_if(|level| passes(level)) else { continue };
                    let passage = Passage {
                        from: entry.from(),
                        level: size.copysign(left.1),
                        between: [left.0, right.0],
                        turn: self.turns[k],
                    };
                    if entry.stuck > 0.0 {
                        let [h] = structure.passages(&[passage]);
                        measures.settling[i].passed_at(entry.clock().plus(h).value.into());
                    } else {
                        found[i] = Some((entry.clock(), passage));
                    }
                }
                right = left;
            }
        }
        // Those of the structure alone are found side by side.
        let Some((_, any)) = found.iter().flatten().next() else { return };
        // One more than there are levels, for vectors of four.
        let passages: [Passage; 4] =
            from_fn(|i| found.get(i).copied().flatten().map_or(*any, |(_, it)| it));
        let times = self.free.passages(&passages);
        for ((found, h), last) in found.iter().zip(times).zip(&mut measures.settling) {
            if let Some((clock, _)) = found {
                last.passed_at(clock.plus(h).value.into());
            }
        }
    }
}
