//! Runs in doubles: what users get.

use std::sync::Arc;

pub use iva_core as core;

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
    Ok(Arc::clone(&recorded.history))
}
