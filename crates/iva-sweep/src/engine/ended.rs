//! The result of a run, from which its row of `summary` is made.

use std::sync::atomic::AtomicBool;

use iva_core::extremes::ExtremeValues;
use iva_core::measures::MeasureValues;
use iva_core::real::Real;
use iva_core::run::bare::Bare;
use iva_core::run::side_by_side::Tier;
use iva_core::simulate::{OfAbsorber, Tally};
use iva_core::steady::SteadyValues;

use super::design::Design;
use crate::done::Done;
use crate::error::Invalid;

/// The result of a run, for any kind of scene.
#[derive(Debug, Clone)]
pub(crate) struct Ended<R: Real = f64> {
    /// How it ended, and its counts.
    pub tally: Tally<(), R>,
    /// Its measures.
    pub measures: MeasureValues<R>,
    /// Those of its steady state; `None` where they were not asked for.
    pub steady: Option<SteadyValues<R>>,
    /// The motion without absorber; `None` where it was not asked for.
    pub bare: Option<Bare<R>>,
    /// Its extremes for each absorber; none where they were not asked for.
    pub extremes: Vec<ExtremeValues<R>>,
    /// What it has come to for each of several absorbers.
    pub absorbers: Vec<OfAbsorber<R>>,
    /// The measures with passes of their own that were asked for.
    pub named: Vec<(&'static str, Option<R>)>,
    /// Condition number of the run, where errors were asked for.
    pub condition: Option<R>,
    /// Correct digits of the run, where errors were asked for.
    pub digits: Option<R>,
    /// The tier that made it.
    pub tier: Tier,
}

/// What the core has found in a run.
type Found<R> = (Tally<(), R>, MeasureValues<R>, Option<SteadyValues<R>>);

impl<R: Real> Ended<R> {
    /// The result of a run, without extremes and estimates of errors; `reduction`: whether it is compared to
    /// the motion without absorber.
    ///
    /// # Errors
    /// As [`Design::without_absorber`].
    pub fn new(
        design: &Design<R>,
        (tally, measures, steady): Found<R>,
        tier: Tier,
        reduction: bool,
        cancel: &AtomicBool,
    ) -> Result<Self, Invalid> {
        let compared = reduction && steady.is_some() && design.scene.count() > 0;
        let bare = if compared { design.without_absorber(cancel)? } else { None };
        let [condition, digits] = [None; 2];
        let (extremes, absorbers, named) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self {
            tally,
            measures,
            steady,
            bare,
            extremes,
            absorbers,
            named,
            condition,
            digits,
            tier,
        })
    }

    /// The counts of the run.
    pub fn done(&self) -> Done {
        Done::run(self.tally.outcome.name(), self.tally.work)
    }
}
