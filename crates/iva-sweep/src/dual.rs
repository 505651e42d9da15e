//! Runs in numbers with a derivative by one field: gradients.

use std::sync::Arc;

pub use iva_core_dual as core;

use crate::error::Invalid;
use crate::forces::Recorded;

#[path = "engine/design.rs"]
pub mod design;
#[path = "engine/forces.rs"]
pub(crate) mod forces;
#[path = "engine/given.rs"]
pub mod given;
#[path = "engine/pendulum.rs"]
pub(crate) mod pendulum;
#[path = "engine/point.rs"]
pub(crate) mod point;
#[path = "engine/rows.rs"]
pub(crate) mod rows;
#[path = "engine/scale.rs"]
pub mod scale;
#[path = "engine/scene.rs"]
pub mod scene;

/// The points of a record.
fn history(recorded: &Recorded) -> Result<Arc<core::force::History>, Invalid> {
    let numbers = |numbers: &[f64]| numbers.iter().map(|number| (*number).into()).collect();
    let (times, values) = (recorded.history.times(), recorded.history.values());
    Ok(Arc::new(core::force::History::new(numbers(times), numbers(values))?))
}
