//! A swept quantity whose values are drawn from a distribution.

use std::collections::BTreeMap;

use iva_core::error::Invalid;

use crate::cube::Distribution;
use crate::error::number;
use crate::fields::{Allowed, nearest};
use crate::slot::Slot;

/// The distributions with the names of their required parameters and of their optional ones.
pub const DISTRIBUTIONS: [(&str, &[&str], &[&str]); 3] = [
    ("uniform", &["low", "high"], &[]),
    ("normal", &["mean", "deviation"], &["low", "high"]),
    ("lognormal", &["median", "sigma"], &["low", "high"]),
];

/// A quantity and its distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// The key as the user wrote it: the name of its column in the summary.
    pub key: String,
    /// The field it sets.
    pub slot: Slot,
    /// The distribution of its values.
    pub distribution: Distribution,
}

impl Variable {
    /// Reads the key, the name of the distribution and its parameters.
    ///
    /// # Errors
    /// [`Invalid`] for an unknown key, distribution or parameter, for a missing parameter, and for parameters
    /// out of range.
    pub fn new(key: &str, name: &str, given: &BTreeMap<String, f64>) -> Result<Self, Invalid> {
        let slot = Slot::from_key(key)?;
        let field = |name: &str| format!("sweep.{key}.{name}");
        let known = DISTRIBUTIONS.map(|(name, ..)| name);
        let Some((_, required, optional)) = DISTRIBUTIONS.into_iter().find(|it| it.0 == name)
        else {
            let rule = match nearest(name, known.into_iter()) {
                Some(near) => format!("no such distribution; did you mean \"{near}\"?"),
                None => format!("give one of \"{}\"", known.join("\", \"")),
            };
            return Err(Invalid::new(field("distribution"), format!("\"{name}\""), rule));
        };
        let has = |wanted: &str| required.iter().chain(optional).any(|known| *known == wanted);
        if let Some((strange, value)) = given.iter().find(|(given, _)| !has(given)) {
            let all: Vec<&str> = required.iter().chain(optional).copied().collect();
            let rule = format!("no such number; the distribution {name} has {}", all.join(", "));
            return Err(Invalid::new(field(strange), number(*value), rule));
        }
        if let Some(missing) = required.iter().find(|wanted| !given.contains_key(**wanted)) {
            let rule = format!("the distribution {name} needs {}", required.join(" and "));
            return Err(Invalid::new(field(missing), "", rule));
        }
        if let Some((name, value)) =
            given.iter().find(|(_, value)| !Allowed::Size.contains(**value))
        {
            let rule = format!("give {}", Allowed::Size.words());
            return Err(Invalid::new(field(name), number(*value), rule));
        }
        let value = |name: &str, default: f64| given.get(name).copied().unwrap_or(default);
        let (low, high) = (value("low", f64::NEG_INFINITY), value("high", f64::INFINITY));
        let distribution = match name {
            "uniform" => Distribution::Uniform { low, high },
            "normal" => Distribution::Normal {
                mean: value("mean", 0.0),
                deviation: value("deviation", 0.0),
                low,
                high,
            },
            _ => Distribution::LogNormal {
                median: value("median", 0.0),
                sigma: value("sigma", 0.0),
                low,
                high,
            },
        };
        distribution.check().map_err(|unfit| {
            Invalid::new(field(unfit.field), number(unfit.value), unfit.allowed)
        })?;
        Ok(Self { key: key.to_owned(), slot, distribution })
    }

    /// Name of the distribution and its parameters, without infinite bounds.
    pub fn given(&self) -> (&'static str, Vec<(&'static str, f64)>) {
        let (name, all) = match self.distribution {
            Distribution::Uniform { low, high } => ("uniform", vec![("low", low), ("high", high)]),
            Distribution::Normal { mean, deviation, low, high } => (
                "normal",
                vec![("mean", mean), ("deviation", deviation), ("low", low), ("high", high)],
            ),
            Distribution::LogNormal { median, sigma, low, high } => (
                "lognormal",
                vec![("median", median), ("sigma", sigma), ("low", low), ("high", high)],
            ),
        };
        (name, all.into_iter().filter(|(_, value)| value.is_finite()).collect())
    }
}
