//! The log of a decay whose motions have no closed form: its stretches in which x is monotonic.

use super::{Course, Measures, Passage, looks};
use crate::absorber::{Absorber, Clock};
use crate::engine::observe::Span;
use crate::measures::peaks::{Monotone, monotone};
use crate::number::real::Real;
use crate::segment::flight::Motion;

/// A stretch of a run in which x is monotonic.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch<State, R = f64> {
    /// The state at the begin of the motion that contains the stretch.
    pub origin: State,
    /// True if that motion is a stick episode.
    pub riding: bool,
    /// The instant of its begin.
    pub start: Clock<R>,
    /// Begin and end of the stretch, as times after that instant, and x there.
    pub part: Monotone<R>,
}

/// Number of stretches after which measures take them, so that a long run needs no more memory.
const FULL: usize = 128;

/// The stretches of a run in order of time, as far as no measure has taken them.
#[derive(Debug, Clone)]
pub(crate) struct Stretches<S: Absorber> {
    stretches: Vec<Stretch<S::State, S::Real>>,
    /// Number of stretches of a full log.
    full: usize,
}

impl<S: Absorber> Stretches<S> {
    /// An empty log, in the memory of another one.
    pub fn new(spare: Option<Self>) -> Self {
        let mut stretches = spare.map(|spare| spare.stretches).unwrap_or_default();
        stretches.clear();
        Self { stretches, full: FULL }
    }

    /// Logs a stretch.
    #[inline(always)]
    pub fn push(&mut self, stretch: Stretch<S::State, S::Real>) {
        self.stretches.push(stretch);
    }

    /// True if measures are to take the stretches.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.stretches.len() >= self.full
    }
}

impl<S: Absorber> Measures<S> {
    /// Logs the stretches of a span of a decay.
    pub(in crate::measures) fn log_stretches<M>(&mut self, system: &S, span: &Span<'_, M>)
    where
        M: Motion<Real = S::Real, State = S::State>,
    {
        let wanted = self.wanted;
        let Some(log) = &mut self.stretches else { return };
        if looks(wanted, span.start.value.double()) {
            let (origin, riding, start) = (*span.motion.origin(), M::RIDING, span.start);
            monotone::<_, S, M>(span, |part| {
                log.push(Stretch { origin, riding, start, part: *part });
            });
            self.make_room(system);
        }
    }

    /// Takes the stretches of a full log, unless the settling levels are not known yet.
    pub(crate) fn make_room(&mut self, system: &S) {
        let Some(log) = self.stretches.as_ref().filter(|log| log.is_full()) else { return };
        if self.settles(log.stretches.iter().map(|stretch| stretch.part.x[1])) {
            self.take_stretches(system);
        } else if let Some(log) = &mut self.stretches {
            log.full *= 2;
        }
    }

    /// Takes all stretches in the log.
    pub(in crate::measures) fn take_stretches(&mut self, system: &S) {
        if let Some(mut log) = self.stretches.take() {
            self.take_course(&Logged { system, log: &log.stretches });
            log.stretches.clear();
            log.full = FULL;
            self.stretches = Some(log);
        }
    }
}

/// The stretches of a system.
struct Logged<'a, S: Absorber> {
    system: &'a S,
    log: &'a [Stretch<S::State, S::Real>],
}

/// Does something with the motion of a stretch, flight or stick episode.
macro_rules! in_motion {
    ($system:expr, $stretch:expr, $motion:ident => $body:expr) => {
        if $stretch.riding {
            let $motion = $system.ride(&$stretch.origin);
            $body
        } else {
            let $motion = $system.flight(&$stretch.origin);
            $body
        }
    };
}
pub(crate) use in_motion;

impl<R: Real, S: Absorber<Real = R>> Course<S> for Logged<'_, S> {
    fn count(&self) -> usize {
        self.log.len()
    }

    fn start(&self, k: usize) -> Clock<R> {
        self.log[k].start
    }

    fn ends(&self, k: usize) -> [(R, R); 2] {
        let Monotone { h: [begin, end], x: [from, to] } = self.log[k].part;
        [(begin, from), (end, to)]
    }

    fn turns(&self, _k: usize) -> impl DoubleEndedIterator<Item = (R, R)> {
        std::iter::empty()
    }

    fn largest(&self, k: usize) -> R {
        let [from, to] = self.log[k].part.x;
        from.abs().max(to.abs())
    }

    fn displacement(&self, k: usize, h: R) -> R {
        in_motion!(self.system, self.log[k], motion => motion.primary(h).value)
    }

    fn energy(&self, k: usize, h: R) -> R {
        in_motion!(self.system, self.log[k], motion => self.system.energy(&motion.state(h)))
    }

    fn pass(&self, found: &[Option<Passage<R>>; 3], measures: &mut Measures<S>) {
        for (found, last) in found.iter().zip(&mut measures.settling) {
            if let Some(Passage { motion, stretch, level }) = found {
                last.passed(Stretch { part: *stretch, ..self.log[*motion] }, *level);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::FULL;
    use crate::absorber::Start;
    use crate::absorber::piva::{Parameters, Piva, PivaStart};
    use crate::engine::simulate::{Limits, simulate};
    use crate::error::Invalid;
    use crate::measures::{Measures, Wanted};

    /// Also where x is 0 at first, so that A₀ is not known at once.
    #[test]
    fn a_long_run_needs_no_more_memory() -> Result<(), Invalid> {
        let piva = Piva::new(Parameters::point_bob(0.1, 0.7, 0.5, 0.0, 10.0))?;
        for displacement in [0.0, 0.3] {
            let start = Start { displacement, velocity: 0.5, ..Start::default() };
            let mut measures = Measures::<Piva>::new(Wanted::ALL);
            let limits = Limits::new(3000.0, 0.5);
            simulate(&piva, &PivaStart::from(start), &limits, None, &mut measures)?;
            let room = measures.stretches.map_or(0, |log| log.stretches.capacity());
            assert!(room <= 2 * FULL, "{displacement}: {room}");
            assert!(
                measures.values.settling_time_2.is_some()
                    || measures.values.residual_amplitude.is_some()
            );
        }
        Ok(())
    }
}
