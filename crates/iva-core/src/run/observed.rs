//! One run with all that a study can ask of it, compiled once for each system in doubles.
//!
//! The functions of a motion and the event loop around them take the longest to compile of all code. So runs that are
//! alone, watched, sampled or differentiated have one type of observer, and their loops are compiled here, beside those of
//! the lanes, which use the same functions.

use std::sync::atomic::AtomicBool;

use crate::absorber::Absorber;
use crate::absorber::modal::{FewModes, Modal};
use crate::absorber::piva::Piva;
use crate::absorber::siva::Siva;
use crate::engine::observe::Events;
use crate::engine::simulate::{Limits, Tally, simulate_from};
use crate::error::Invalid;
use crate::host::{DrivenHost, UndrivenHost};
use crate::measures::bends::Bends;
use crate::measures::extremes::Extremes;
use crate::measures::pass::Passes;
use crate::measures::propagation::Errors;
use crate::measures::sample::Sampler;
use crate::measures::summary::Summary;

/// What a run can show to its tables, each if it is wanted: events, measures, extremes and passes, and what else observes it.
pub type Observers<S, R, Beside> =
    (Option<Events<R>>, (Option<Summary<S>>, ((Option<Extremes<R>>, Passes<R>), Beside)));

/// What observes a run in doubles beside its tables, each if it is wanted: the errors that its rows tell, its motion, and how
/// close its impacts are to being others.
pub type Beside<'a> = (Option<Box<Errors>>, (Option<&'a mut Sampler>, Option<&'a mut Closeness>));

/// How close impacts are to being others: how wrong they are, and how near grazings.
pub type Closeness = (Errors, Bends);

/// A system in doubles whose loop is compiled here.
pub trait Observed: Absorber<Real = f64> {
    /// As [`simulate_from`].
    ///
    /// # Errors
    /// As [`simulate_from`].
    fn observe(
        &self,
        start: &Self::Start,
        begin: f64,
        limits: &Limits,
        cancel: Option<&AtomicBool>,
        observers: &mut Observers<Self, f64, Beside<'_>>,
    ) -> Result<Tally<Self::State>, Invalid>
    where
        Self: Sized;
}

macro_rules! observed {
    ($($system:ty),* $(,)?) => {$(
        impl Observed for $system {
            fn observe(
                &self,
                start: &Self::Start,
                begin: f64,
                limits: &Limits,
                cancel: Option<&AtomicBool>,
                observers: &mut Observers<Self, f64, Beside<'_>>,
            ) -> Result<Tally<Self::State>, Invalid> {
                simulate_from(self, start, begin, limits, cancel, observers)
            }
        }
    )*};
}

observed! {
    Siva<UndrivenHost>,
    Siva<DrivenHost>,
    Piva<DrivenHost>,
    Modal<DrivenHost>,
    FewModes<DrivenHost>,
}
