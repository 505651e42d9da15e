//! Measures that are computed from the motion stretch by stretch, if they are asked for by name.
//!
//! A [`Pass`] takes the polynomials of each stretch from [`Passes`], for any absorber and any number type. To offer a
//! pass to users, name it in a column of the table.

use crate::absorber::Absorber;
use crate::engine::observe::{Observer, Span};
use crate::engine::simulate::{Instant, Outcome, Tally};
use crate::number::real::Real;
use crate::segment::flight::{Motion, Travel};

/// A measure of a run, in natural units.
pub trait Pass<R: Real>: std::fmt::Debug {
    /// The run begins, with wall − and wall + at these values of y.
    fn begin(&mut self, walls: [R; 2]);
    /// A stretch of motion, between two values of h. Polynomials are in h/`step`, of which the coefficients up to `order`
    /// count.
    fn stretch(&mut self, travel: &Travel<R>, h: [R; 2]);
    /// The measure of all stretches so far.
    fn value(&self) -> R;
}

/// An observer that shows a run to passes, from a given instant on.
#[derive(Debug, Default)]
pub struct Passes<R: Real> {
    from: R,
    passes: Vec<Box<dyn Pass<R>>>,
    /// False if a motion had no known polynomials, or the run did not finish.
    known: bool,
}

impl<R: Real> Passes<R> {
    /// Shows the run from an instant on, in 1/ωn.
    pub fn new(from: R, passes: Vec<Box<dyn Pass<R>>>) -> Self {
        Self { from, passes, known: true }
    }

    /// True if there is no pass.
    pub(crate) fn is_empty(&self) -> bool {
        self.passes.is_empty()
    }

    /// The measures, in the order of the passes; `None` where the run does not define them, and with several absorbers.
    pub fn values(&self) -> impl Iterator<Item = Option<R>> {
        self.passes.iter().map(|pass| self.known.then(|| pass.value()))
    }
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Passes<R> {
    fn start(&mut self, system: &S, _from: &Instant<S::State, R>, _duration: R) {
        // What a pass measures is of one gap.
        self.known = system.absorbers() <= 1;
        self.passes.iter_mut().for_each(|pass| pass.begin(system.walls_of(0)));
    }

    fn looks_within(&self) -> bool {
        !self.passes.is_empty()
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, _system: &S, span: &Span<'_, M>) {
        let begin = (-span.start.minus(self.from)).max(0.0);
        if self.passes.is_empty() || begin > span.length {
            return;
        }
        match span.motion.travel() {
            Some(travel) => {
                let h = [begin, span.length];
                self.passes.iter_mut().for_each(|pass| pass.stretch(&travel, h));
            }
            None => self.known = false,
        }
    }

    fn end(&mut self, _system: &S, tally: &Tally<S::State, R>) {
        self.known &= tally.outcome == Outcome::Finished;
    }
}
