//! One run: its tables, and where their columns are in memory.

use iva_sweep::Invalid;
use iva_sweep::columns::Selection;
use iva_sweep::study::{Study, Table};
use iva_sweep::watched::{Points, Value, watched};

use crate::json::{self, list, object, text};
use crate::scene::Scene;

/// The columns of numbers that an answer points to.
pub type Columns = Vec<Vec<f64>>;

/// Runs a scene and describes its tables; the numbers are in the columns, which the description points to.
///
/// Errors of impact times take longer than the run itself, so they are estimated only if asked for.
///
/// # Errors
/// [`Invalid`] for a scene that cannot be run.
pub fn run(scene: &Scene, samples: u32, errors: bool) -> Result<(String, Columns), Invalid> {
    let study = Study { measures: Selection::all(), errors, ..Study::single(scene.spec.clone()) };
    let ran = watched(&study, samples)?;
    let mut columns = Columns::new();
    let summary = ran.summary.into_iter().map(|(name, value)| (name, shown(&value)));
    let summary: Vec<_> = summary.collect();
    let mut parts = vec![
        ("units", text(study.units()?.name())),
        ("energies", object([("total", placed(ran.energies, &mut columns))])),
        (Table::Summary.name(), object(summary)),
    ];
    let Points { times, motions } = ran.points;
    parts.push(("samples", object([("time", placed(times, &mut columns))])));
    let mut named = |all: Vec<(String, Vec<f64>)>| {
        let placed = all.into_iter().map(|(name, values)| (name, placed(values, &mut columns)));
        let placed: Vec<(String, String)> = placed.collect();
        object(placed.iter().map(|(name, place)| (name.as_str(), place.clone())))
    };
    let split = motions.into_iter().map(|(name, [x, v])| ((name.clone(), x), (name, v)));
    let (points, speeds) = split.unzip();
    parts.extend([("points", named(points)), ("point_velocities", named(speeds))]);
    for (table, columns) in ran.tables {
        let columns = columns.into_iter().map(|(name, values)| (name.to_owned(), values));
        parts.push((table.name(), named(columns.collect())));
    }
    Ok((object(parts), columns))
}

/// Where numbers are that stay in memory: their place, and how many there are.
pub fn placed(values: Vec<f64>, columns: &mut Columns) -> String {
    let place = [values.as_ptr() as usize, values.len()].map(|it| it.to_string());
    columns.push(values);
    list(place)
}

fn shown(value: &Value) -> String {
    match value {
        Value::Number(value) => json::number(*value),
        Value::Text(word) => text(word),
        Value::Missing => "null".to_owned(),
    }
}
