//! Reading of the section `[sampling]`: the way in which the points of a sweep are chosen.

use std::collections::BTreeMap;
use std::ops::Range;

use iva_store::points_file::read_points;
use iva_sweep::axis::Axis;
use iva_sweep::cube::{MOST_POINTS, Method};
use iva_sweep::design::Spec;
use iva_sweep::fields::Allowed;
use iva_sweep::sampling::{Rows, Sample, Sampling};
use iva_sweep::variable::{DISTRIBUTIONS, Variable};
use toml::de::{DeTable, DeValue};

use crate::axes::{self, Entry};
use crate::error::Error;
use crate::forces::beside;
use crate::source::Source;
use crate::value::{
    Key, Value, at, entries, name, number, table, truth, unknown_key, whole_number,
};

/// Largest seed, up to which a double holds every whole number.
pub const MOST_SEED: u64 = 1 << 53;

/// Keys of the section.
const KEYS: [&str; 5] = ["method", "count", "seed", "scramble", "points"];
/// Words of the key `method`.
const METHODS: [&str; 5] = ["grid", "zip", "sobol", "latin_hypercube", "random"];

/// The values of the section `[sampling]`, with their places.
#[derive(Default)]
struct Asked {
    /// Way of choosing points; `None` means a grid.
    method: Option<Way>,
    count: Option<(u64, Range<usize>)>,
    seed: Option<(u64, Range<usize>)>,
    scramble: Option<(bool, Range<usize>)>,
    points: Option<(String, Range<usize>)>,
}

/// The ways of choosing points.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Grid,
    Zip,
    Sample(Method),
}

/// Reads the points of a study from the sections `[sampling]` and `[sweep]`.
///
/// # Errors
/// At the place of the first unknown key or invalid value.
pub(crate) fn read(
    source: &mut Source,
    root: &DeTable<'_>,
    spec: &Spec,
) -> Result<Sampling, Error> {
    let asked = match root.get_key_value("sampling") {
        Some((key, value)) => {
            source.note("sampling".to_owned(), key.span());
            read_section(source, key, value)?
        }
        None => Asked::default(),
    };
    let sweep = root.get_key_value("sweep");
    if let Some((file, span)) = &asked.points {
        if let Some((key, _)) = sweep {
            let rule = "the points are those of sampling.points; remove this section, or that key";
            return Err(source.error(key.span(), rule));
        }
        return from_file(source, file, span.clone(), spec);
    }
    let Some((key, value)) = sweep else {
        return match root.get_key_value("sampling") {
            None => Ok(Sampling::default()),
            Some((key, _)) => {
                let rule =
                    "give the section [sweep] with what is swept, or points, the name of a file";
                Err(source.error(key.span(), rule))
            }
        };
    };
    let entries = axes::read(source, key, value)?;
    let sampling = match asked.method.unwrap_or(Way::Grid) {
        Way::Grid => {
            axes::check_size(source, key.span(), &entries)?;
            Sampling::Grid(axes::values(source, &entries)?)
        }
        Way::Zip => {
            let rows = Rows::new(axes::values(source, &entries)?, 0);
            Sampling::Rows(rows.map_err(|invalid| source.locate(&invalid))?)
        }
        Way::Sample(method) => Sampling::Sample(sample(source, method, &asked, &entries)?),
    };
    sampling.check(spec).map_err(|invalid| source.locate(&invalid))?;
    Ok(sampling)
}

/// Reads the keys of the section `[sampling]`.
fn read_section(source: &mut Source, key: &Key<'_>, value: &Value<'_>) -> Result<Asked, Error> {
    let mut asked = Asked::default();
    for (key, value) in entries(table(source, "sampling", key, value)?) {
        let field = format!("sampling.{}", key.get_ref());
        let place = key.span().start..value.span().end;
        match key.get_ref().as_ref() {
            "method" => {
                let find = |name: &str| match name {
                    "grid" => Some(Way::Grid),
                    "zip" => Some(Way::Zip),
                    other => Method::from_name(other).map(Way::Sample),
                };
                asked.method = Some(name(source, &field, value, &METHODS, find)?);
            }
            "count" => {
                let count = whole_number(source, &field, value, (1, MOST_POINTS))?;
                asked.count = Some((count, place.clone()));
            }
            "seed" => {
                let seed = whole_number(source, &field, value, (0, MOST_SEED))?;
                asked.seed = Some((seed, place.clone()));
            }
            "scramble" => asked.scramble = Some((truth(source, &field, value)?, place.clone())),
            "points" => match value.get_ref() {
                DeValue::String(file) => asked.points = Some((file.to_string(), value.span())),
                _ => {
                    let rule = "give the name of a file, in quotes";
                    return Err(source.bad_value(&field, value.span(), rule));
                }
            },
            _ => return Err(unknown_key(source, "sampling", key, &KEYS)),
        }
        source.note(field, place);
    }
    refuse_strange(source, &asked)?;
    Ok(asked)
}

/// Refuses keys that do not go with the method.
fn refuse_strange(source: &Source, asked: &Asked) -> Result<(), Error> {
    let sample = matches!(asked.method, Some(Way::Sample(_)));
    let sobol = asked.method == Some(Way::Sample(Method::Sobol));
    let refused = |span: &Range<usize>, rule: &str| Err(source.error(span.clone(), rule));
    if let (Some(_), Some((_, span))) = (asked.method, &asked.points) {
        return refused(span, "sampling.points: a file has its own points; give it or method");
    }
    for (key, span) in [
        ("count", asked.count.as_ref().map(|it| &it.1)),
        ("seed", asked.seed.as_ref().map(|it| &it.1)),
    ] {
        if let (Some(span), false) = (span, sample) {
            let rule = format!(
                "sampling.{key}: only the methods \"sobol\", \"latin_hypercube\" and \"random\" have it"
            );
            return refused(span, &rule);
        }
    }
    match &asked.scramble {
        Some((_, span)) if !sobol => {
            refused(span, "sampling.scramble: only the method \"sobol\" has it")
        }
        _ => Ok(()),
    }
}

/// Reads the points from a file.
fn from_file(
    source: &Source,
    file: &str,
    span: Range<usize>,
    spec: &Spec,
) -> Result<Sampling, Error> {
    let path = beside(source.path(), file);
    let refused = |reason: String| {
        source.bad_value("sampling.points", span.clone(), &format!("{}: {reason}", path.display()))
    };
    let columns = read_points(&path).map_err(refused)?;
    let axes = columns.into_iter().map(|(key, values)| Axis::new(&key, values));
    let rows = axes.collect::<Result<Vec<_>, _>>().and_then(|axes| Rows::new(axes, 0));
    let mut rows = rows.map_err(|invalid| refused(invalid.to_string()))?;
    rows.file = Some(path.display().to_string());
    let sampling = Sampling::Rows(rows);
    sampling.check(spec).map_err(|invalid| refused(invalid.to_string()))?;
    Ok(sampling)
}

/// Reads a sample of random or low-discrepancy points.
fn sample(
    source: &mut Source,
    method: Method,
    asked: &Asked,
    entries: &[Entry<'_, '_>],
) -> Result<Sample, Error> {
    let Some((count, _)) = asked.count else {
        return Err(source.missing("sampling.count is missing: give the number of points"));
    };
    let mut variables = Vec::with_capacity(entries.len());
    for entry in entries {
        let variable = variable(source, entry)?;
        axes::note(source, entry, variable.slot);
        variables.push(variable);
    }
    let seed = asked.seed.as_ref().map_or(0, |it| it.0);
    let scramble = asked.scramble.as_ref().is_none_or(|it| it.0);
    Sample::new(method, count, seed, scramble, variables).map_err(|invalid| source.locate(&invalid))
}

/// Reads a random variable: `{ low = …, high = … }`, or
/// `{ distribution = "normal", mean = …, deviation = … }`.
fn variable(source: &Source, entry: &Entry<'_, '_>) -> Result<Variable, Error> {
    let field = format!("sweep.{}", entry.key);
    axes::slot(source, entry)?;
    let DeValue::Table(given) = entry.value.get_ref() else {
        let rule = "give a distribution: { low = …, high = … }, or { distribution = \"normal\", mean = \
                    …, deviation = … }";
        return Err(source.bad_value(&field, entry.value.span(), rule));
    };
    let mut distribution = "uniform".to_owned();
    let mut numbers = BTreeMap::new();
    let known = DISTRIBUTIONS.map(|(name, ..)| name);
    for (key, value) in entries(given) {
        let key_field = format!("{field}.{}", key.get_ref());
        if key.get_ref().as_ref() == "distribution" {
            let find = |word: &str| known.iter().find(|known| **known == word).copied();
            distribution = name(source, &key_field, value, &known, find)?.to_owned();
        } else {
            let value = number(source, &key_field, value, Allowed::Size)?;
            numbers.insert(key.get_ref().to_string(), value);
        }
    }
    Variable::new(&entry.key, &distribution, &numbers)
        .map_err(|invalid| at(source, entry.value.span(), &invalid))
}
