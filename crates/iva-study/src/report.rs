//! The section `[report]`: which points a front shows at the end of a sweep, and the measure that ranks
//! them.

use iva_sweep::choices::Kind;
use iva_sweep::columns::Selection;
use iva_sweep::design::Spec;

/// Default of `report.best_by` in a decay.
pub const BEST_DECAY: &str = "settling_time_5";
/// Default of `report.best_by` under a harmonic or recorded force.
pub const BEST_DRIVEN: &str = "reduction";
/// The same without absorber, where there is nothing to compare with.
pub const BEST_ALONE: &str = "amplitude_max";
/// Default of `report.count`.
pub const DEFAULT_COUNT: usize = 10;

/// What the table of best points shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// The measure to rank by; `None` if it is the default one and the study leaves it out.
    pub best_by: Option<&'static str>,
    /// Rows shown.
    pub count: usize,
}

impl Report {
    /// The measure that points are ranked by unless the study says another.
    pub fn default_measure(spec: &Spec) -> &'static str {
        match (spec.is_driven(), spec.choices().kind) {
            (false, _) => BEST_DECAY,
            (true, Kind::None) => BEST_ALONE,
            (true, _) => BEST_DRIVEN,
        }
    }

    /// The default report of a study that computes these measures: in a decay, under a lasting force, or under one
    /// without absorber.
    pub fn new(measures: Selection, spec: &Spec) -> Self {
        let best_by = Self::default_measure(spec);
        Self { best_by: Some(best_by).filter(|name| measures.contains(name)), count: DEFAULT_COUNT }
    }
}
