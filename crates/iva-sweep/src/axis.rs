//! An axis: a quantity with the values that it takes.

use iva_core::error::Invalid;

use crate::slot::Slot;

/// Largest number of values of an equidistant axis, checked before they are computed: they take 80 MB.
pub const MAX_VALUES: u64 = 10_000_000;

/// One axis of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The key as the user wrote it: the name of its column in the summary.
    pub key: String,
    /// The field it sets.
    pub slot: Slot,
    /// Its values, in the order given.
    pub values: Vec<f64>,
}

impl Axis {
    /// Reads the key and checks every value against the field's range.
    ///
    /// # Errors
    /// [`Invalid`] for an unknown or ambiguous key, no values, or a value out of range.
    pub fn new(key: &str, values: Vec<f64>) -> Result<Self, Invalid> {
        let slot = Slot::from_key(key)?;
        if values.is_empty() {
            return Err(Invalid::new(format!("sweep.{key}"), "[]", "give at least one value"));
        }
        for (index, value) in values.iter().enumerate() {
            slot.check(*value)
                .map_err(|error| Invalid { field: format!("sweep.{key}[{index}]"), ..error })?;
        }
        Ok(Self { key: key.to_owned(), slot, values })
    }

    /// `count` equidistant values from `start` to `stop`, both included.
    ///
    /// # Errors
    /// As [`Axis::new`]; also for a `count` of zero or beyond [`MAX_VALUES`], or one value over an
    /// interval.
    pub fn linspace(key: &str, start: f64, stop: f64, count: u64) -> Result<Self, Invalid> {
        if count == 0 || count > MAX_VALUES {
            return Err(Invalid::new(
                format!("sweep.{key}.count"),
                count,
                format!("give a whole number from 1 to {MAX_VALUES}"),
            ));
        }
        if count == 1 && start != stop {
            return Err(Invalid::new(
                format!("sweep.{key}.count"),
                count,
                "one value cannot span start to stop; give 2 or more",
            ));
        }
        // Rounded as numpy.linspace rounds, so that a study and a Python sweep have equal values.
        let step = (stop - start) / (count.max(2) - 1) as f64;
        let mut values: Vec<f64> = (0..count).map(|i| i as f64 * step + start).collect();
        if let [_, .., last] = values.as_mut_slice() {
            *last = stop;
        }
        Self::new(key, values)
    }
}
