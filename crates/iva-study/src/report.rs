//! The section `[report]`: the number of best points that a front shows after a sweep, and the measure that
//! ranks them.

use iva_sweep::choices::Kind;
use iva_sweep::columns::Selection;
use iva_sweep::design::Spec;

/// Default of `report.best_by` for a free decay.
pub const BEST_DECAY: &str = "settling_time_5";
/// Default of `report.best_by` under a harmonic or recorded force.
pub const BEST_DRIVEN: &str = "reduction";
/// Default of `report.best_by` under a harmonic or recorded force without absorber.
pub const BEST_ALONE: &str = "amplitude_max";
/// Default of `report.count`.
pub const DEFAULT_COUNT: usize = 10;

/// The settings of the table of best points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// Measure that ranks the points; `None` if it is the default and the study does not compute it.
    pub best_by: Option<&'static str>,
    /// Number of rows.
    pub count: usize,
}

impl Report {
    /// The measure that ranks the points if the study names none.
    pub fn default_measure(spec: &Spec) -> &'static str {
        match (spec.is_driven(), spec.choices().kind) {
            (false, _) => BEST_DECAY,
            (true, Kind::None) => BEST_ALONE,
            (true, _) => BEST_DRIVEN,
        }
    }

    /// The default report of a study that computes the given measures.
    pub fn new(measures: Selection, spec: &Spec) -> Self {
        let best_by = Self::default_measure(spec);
        Self { best_by: Some(best_by).filter(|name| measures.contains(name)), count: DEFAULT_COUNT }
    }
}
