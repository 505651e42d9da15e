//! A measure over the values of some fields.

use iva_sweep::Invalid;
use iva_sweep::columns::Selection;
use iva_sweep::sampling::Sampling;
use iva_sweep::study::{Study, Table};

use crate::run::{numbers, tables_of};
use crate::scene::Scene;

/// The measure of a scene at all points of its axes, the last axis fastest; NaN where it is not defined.
///
/// # Errors
/// [`Invalid`] for a scene that cannot be run, and for a measure that there is not.
pub fn map(scene: Scene) -> Result<Vec<f64>, Invalid> {
    let Scene { spec, axes, measure } = scene;
    let name = measure.unwrap_or_default();
    let unknown = |name: String| Invalid::new("measure", name, "no such measure");
    let mut study = Study::single(spec);
    study.measures = Selection::from_names([name.as_str()]).map_err(unknown)?;
    study.tables = vec![Table::Summary];
    let grid = Study { sampling: Sampling::Grid(axes), ..study.clone() };
    let value = |point: u64| {
        study.spec = grid.spec(point)?;
        let tables = tables_of(&study)?;
        let column = tables.get(&Table::Summary).and_then(|batch| batch.column_by_name(&name));
        column
            .and_then(|array| numbers(array.as_ref())?.first().copied())
            .ok_or_else(|| unknown(name.clone()))
    };
    (0..grid.points()?).map(value).collect()
}
