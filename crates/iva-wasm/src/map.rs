//! A measure over the values of some fields.

use iva_sweep::Invalid;
use iva_sweep::columns::Selection;
use iva_sweep::sampling::Sampling;
use iva_sweep::study::Study;
use iva_sweep::watched::measured;

use crate::scene::Scene;

/// The measure of a scene at all points of its axes, the last axis fastest; NaN where it is not defined.
///
/// # Errors
/// [`Invalid`] for a scene that cannot be run, and for a measure that there is not.
pub fn map(scene: Scene) -> Result<Vec<f64>, Invalid> {
    let Scene { spec, axes, measure } = scene;
    let name = measure.unwrap_or_default();
    let unknown = |name: String| Invalid::new("measure", name, "no such measure");
    let study = Study {
        sampling: Sampling::Grid(axes),
        measures: Selection::from_names([name.as_str()]).map_err(unknown)?,
        ..Study::single(spec)
    };
    measured(&study, &name)
}
