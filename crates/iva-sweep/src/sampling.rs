//! The points of a study: the swept quantities, and the combinations of their values.

use std::fmt;
use std::sync::Arc;

use iva_core::error::Invalid;

use crate::axis::Axis;
use crate::cube::{Cube, CubeError, Method};
use crate::fields::{FieldId, Part};
use crate::slot::Slot;
use crate::spec::Spec;
use crate::variable::Variable;

/// Largest number of points, because `point` is a 32-bit column.
pub const MAX_POINTS: u64 = 1 << 32;

/// The points of a study.
#[derive(Debug, Clone, PartialEq)]
pub enum Sampling {
    /// All combinations of the values of some axes, the last axis varying fastest; one point without axes.
    Grid(Vec<Axis>),
    /// The rows of a table with one column for each swept quantity: one point per row.
    Rows(Rows),
    /// Points drawn from distributions.
    Sample(Sample),
}

/// Points given one by one as rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The columns, one for each swept quantity, of equal length.
    axes: Vec<Axis>,
    /// Number of the first point: not 0 if the rows before it are elsewhere.
    first: u64,
    /// The file they were read from, if any, in the form in which a study file names it.
    pub file: Option<String>,
}

impl Rows {
    /// The rows of some columns; the first is that of point `first`.
    ///
    /// # Errors
    /// [`Invalid`] if there is no column, or they are not of one length.
    pub fn new(axes: Vec<Axis>, first: u64) -> Result<Self, Invalid> {
        let Some((one, others)) = axes.split_first() else {
            return Err(Invalid::new("sweep", "", "give at least one column"));
        };
        if let Some(other) = others.iter().find(|axis| axis.values.len() != one.values.len()) {
            return Err(Invalid::new(
                format!("sweep.{}", other.key),
                format!("{} values", other.values.len()),
                format!(
                    "sweep.{} has {}: what is read in step must be of one length",
                    one.key,
                    one.values.len()
                ),
            ));
        }
        Ok(Self { axes, first, file: None })
    }

    /// The columns.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    fn length(&self) -> u64 {
        self.axes.first().map_or(0, |axis| axis.values.len() as u64)
    }
}

/// Points drawn from distributions: each coordinate of a sample of the unit cube is mapped to a value by the
/// quantile function of its quantity.
#[derive(Debug, Clone)]
pub struct Sample {
    /// The method by which the points are placed.
    pub method: Method,
    /// Number of points.
    pub count: u64,
    /// Seed of its random numbers.
    pub seed: u64,
    /// True if Sobol' points are scrambled.
    pub scramble: bool,
    variables: Vec<Variable>,
    cube: Arc<Cube>,
}

impl PartialEq for Sample {
    // The cube is determined by the other fields.
    fn eq(&self, other: &Self) -> bool {
        let settings = |it: &Self| (it.method, it.count, it.seed, it.scramble);
        settings(self) == settings(other) && self.variables == other.variables
    }
}

impl Sample {
    /// Places the points.
    ///
    /// # Errors
    /// [`Invalid`] for no variables or too many, no points or too many, or plain Sobol' points of an
    /// unbounded distribution: the first point is all zeros.
    pub fn new(
        method: Method,
        count: u64,
        seed: u64,
        scramble: bool,
        variables: Vec<Variable>,
    ) -> Result<Self, Invalid> {
        let cube = Cube::new(method, count, seed, scramble, variables.len()).map_err(|error| {
            let (field, value) = match error {
                CubeError::Count { count, .. } => ("sampling.count", count.to_string()),
                CubeError::Axes { axes, .. } => ("sweep", format!("{axes} variables")),
            };
            let rule = match error {
                CubeError::Count { most, .. } => format!("give a whole number from 1 to {most}"),
                CubeError::Axes { most, .. } => format!("{} takes 1 to {most}", method.name()),
            };
            Invalid::new(field, value, rule)
        })?;
        let endless = |variable: &&Variable| !variable.distribution.quantile(0.0).is_finite();
        if let Some(variable) =
            variables.iter().find(|it| method == Method::Sobol && !scramble && endless(it))
        {
            return Err(Invalid::new(
                format!("sweep.{}.low", variable.key),
                "",
                "the first of the plain Sobol points has only zeros, for which this distribution has \
                 no value; give low, or leave scramble at true",
            ));
        }
        Ok(Self { method, count, seed, scramble, variables, cube: Arc::new(cube) })
    }

    /// The variables, in the order of the columns of the summary.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn values(&self, point: u64) -> impl Iterator<Item = f64> {
        let variables = self.variables.iter().enumerate();
        variables.map(move |(axis, variable)| {
            variable.distribution.quantile(self.cube.coordinate(point, axis))
        })
    }
}

/// A swept quantity.
#[derive(Debug, Clone, Copy)]
pub struct Swept<'a> {
    /// The key as the user wrote it: the name of its column in the summary.
    pub key: &'a str,
    /// The field it sets.
    pub slot: Slot,
    /// The form in which it is given, for messages.
    given: Given,
}

#[derive(Debug, Clone, Copy)]
enum Given {
    Values(usize),
    Distribution(&'static str),
}

impl Swept<'_> {
    fn refused(&self, allowed: String) -> Invalid {
        let value = match self.given {
            Given::Values(count) => format!("{count} values"),
            Given::Distribution(name) => format!("\"{name}\""),
        };
        Invalid::new(format!("sweep.{}", self.key), value, allowed)
    }
}

impl<'a> From<&'a Axis> for Swept<'a> {
    fn from(axis: &'a Axis) -> Self {
        Self { key: &axis.key, slot: axis.slot, given: Given::Values(axis.values.len()) }
    }
}

impl<'a> From<&'a Variable> for Swept<'a> {
    fn from(variable: &'a Variable) -> Self {
        let given = Given::Distribution(variable.given().0);
        Self { key: &variable.key, slot: variable.slot, given }
    }
}

impl Default for Sampling {
    fn default() -> Self {
        Sampling::Grid(Vec::new())
    }
}

impl Sampling {
    /// True if nothing is swept: a single run.
    pub fn is_empty(&self) -> bool {
        self.keys().next().is_none()
    }

    /// The axes of a grid or of rows, none of a sample.
    pub fn axes(&self) -> &[Axis] {
        match self {
            Sampling::Grid(axes) | Sampling::Rows(Rows { axes, .. }) => axes,
            Sampling::Sample(_) => &[],
        }
    }

    /// The variables of a sample.
    pub fn variables(&self) -> &[Variable] {
        match self {
            Sampling::Sample(sample) => &sample.variables,
            Sampling::Grid(_) | Sampling::Rows(_) => &[],
        }
    }

    /// The swept quantities, in the order of the columns of the summary.
    pub fn keys(&self) -> impl Iterator<Item = Swept<'_>> {
        let (axes, variables) = (self.axes(), self.variables());
        axes.iter().map(Swept::from).chain(variables.iter().map(Swept::from))
    }

    /// True if a quantity is swept, under this or another name.
    pub fn sets(&self, slot: Slot) -> bool {
        self.keys().any(|swept| swept.slot.same_quantity(slot))
    }

    /// Number of the first point.
    pub fn first(&self) -> u64 {
        match self {
            Sampling::Rows(rows) => rows.first,
            Sampling::Grid(_) | Sampling::Sample(_) => 0,
        }
    }

    /// Number of points, including those before [`Sampling::first`].
    ///
    /// # Errors
    /// [`Invalid`] beyond 2³² points.
    pub fn points(&self) -> Result<u64, Invalid> {
        let product = |axes: &[Axis]| {
            axes.iter().try_fold(1u64, |all, axis| all.checked_mul(axis.values.len() as u64))
        };
        let points = match self {
            Sampling::Grid(axes) => product(axes),
            Sampling::Rows(rows) => rows.first.checked_add(rows.length()),
            Sampling::Sample(sample) => Some(sample.count),
        };
        points.filter(|points| *points <= MAX_POINTS).ok_or_else(|| {
            let lengths: Vec<String> = match self {
                Sampling::Grid(axes) => axes.iter().map(|it| it.values.len().to_string()).collect(),
                Sampling::Rows(rows) => vec![rows.length().to_string()],
                Sampling::Sample(sample) => vec![sample.count.to_string()],
            };
            Invalid::new("sweep", lengths.join(" × "), "a sweep has at most 2^32 points")
        })
    }

    /// The swept values of a point, in the order of [`Sampling::keys`].
    pub fn values(&self, point: u64) -> Vec<f64> {
        let mut values = Vec::new();
        self.push_values(point, &mut values);
        values
    }

    /// Appends the swept values of a point, in the order of [`Sampling::keys`].
    pub(crate) fn push_values(&self, point: u64, values: &mut Vec<f64>) {
        match self {
            Sampling::Grid(axes) => push_combination(axes, point, values),
            Sampling::Rows(rows) => {
                let row = (point - rows.first) as usize;
                values.extend(rows.axes.iter().map(|axis| axis.values[row]));
            }
            Sampling::Sample(sample) => values.extend(sample.values(point)),
        }
    }

    /// Checks that no two axes sweep the same quantity, because the later one would replace the earlier one,
    /// that an absorber has the swept fields, and that no list of the start has a number for each of a swept number of units.
    ///
    /// # Errors
    /// [`Invalid`] naming the axis, the later of two.
    pub fn check(&self, spec: &Spec) -> Result<(), Invalid> {
        for (index, swept) in self.keys().enumerate() {
            let mut before = self.keys().take(index);
            if let Some(earlier) = before.find(|it| it.slot.same_quantity(swept.slot)) {
                let key = earlier.key;
                return Err(
                    swept.refused(format!("sweep.{key} sets the same quantity; give one of them"))
                );
            }
        }
        for swept in self.keys() {
            if swept.slot.info().part != Part::Force {
                spec.check(swept.slot).map_err(|rule| swept.refused(rule))?;
            }
            if swept.slot.field == FieldId::Units && spec.starts_units() {
                let rule = "the start has a number for each unit; give one for all units";
                return Err(swept.refused(rule.to_owned()));
            }
        }
        Ok(())
    }
}

/// The swept quantities and the number of their values, on one line.
impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = match self {
            Sampling::Grid(axes) => {
                axes.iter().map(|axis| format!("{} {}", axis.values.len(), axis.key)).collect()
            }
            _ => self.keys().map(|swept| swept.key.to_owned()).collect(),
        };
        match self {
            Sampling::Grid(_) => f.write_str(&words.join(" × ")),
            Sampling::Rows(_) => write!(f, "{} row by row", words.join(", ")),
            Sampling::Sample(sample) => {
                write!(f, "{} sample of {}", sample.method.name(), words.join(", "))
            }
        }
    }
}

/// Appends the values of a point of a grid; the last axis varies fastest.
fn push_combination(axes: &[Axis], point: u64, values: &mut Vec<f64>) {
    let (mut rest, first) = (point, values.len());
    values.resize(first + axes.len(), 0.0);
    for (value, axis) in values[first..].iter_mut().zip(axes).rev() {
        let length = axis.values.len() as u64;
        *value = axis.values[(rest % length) as usize];
        rest /= length;
    }
}
