//! The destination of a number of a study: a field, and for one of several forces its number.

use iva_core::error::Invalid;

use crate::fields::{Field, FieldId, Part};

/// A field, and for a field of a force in a list the number of the force, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Slot {
    /// The field.
    pub field: FieldId,
    /// Number of the force in a list; `None` for all other parts, and for a single force.
    pub force: Option<usize>,
}

impl From<FieldId> for Slot {
    fn from(field: FieldId) -> Self {
        Self { field, force: None }
    }
}

impl Slot {
    /// A field of the force with this number, of so many.
    pub fn of_force(field: FieldId, number: usize, count: usize) -> Self {
        Self { field, force: (count > 1).then_some(number) }
    }

    /// Reads a sweep key: as [`FieldId::from_key`], or `force.0.frequency` for a list of forces.
    ///
    /// # Errors
    /// As [`FieldId::from_key`].
    pub fn from_key(key: &str) -> Result<Self, Invalid> {
        let numbered = key.strip_prefix("force.").and_then(|rest| rest.split_once('.'));
        let numbered = numbered.and_then(|(number, name)| Some((number.parse().ok()?, name)));
        match numbered {
            Some((number, name)) => match FieldId::find(Part::Force, name) {
                Some(field) => Ok(Self { field, force: Some(number) }),
                None => {
                    let rule = "no such field of a force";
                    Err(Invalid::new("sweep key", format!("`{key}`"), rule))
                }
            },
            None => FieldId::from_key(key).map(Self::from),
        }
    }

    /// The row of the field in the table of fields.
    pub fn info(self) -> &'static Field {
        self.field.info()
    }

    /// `part.name`, with the number of a force between them, as error messages and study files write it.
    pub fn path(self) -> String {
        match self.force {
            Some(number) => format!("{}.{number}.{}", self.info().part.name(), self.info().name),
            None => self.field.path(),
        }
    }

    /// True if two slots set the same quantity, of the same force if it is one of a force.
    pub fn same_quantity(self, other: Slot) -> bool {
        let number = |slot: Slot| slot.force.unwrap_or(0);
        self.field.same_quantity(other.field) && number(self) == number(other)
    }

    /// Checks a value against the field's range.
    ///
    /// # Errors
    /// [`Invalid`] with field, value and range.
    pub fn check(self, value: f64) -> Result<f64, Invalid> {
        self.field.check(value).map_err(|error| Invalid { field: self.path(), ..error })
    }
}
