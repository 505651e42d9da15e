//! The destination of a number of a study: a field, and for one of several forces or absorbers its number.

use iva_core::error::Invalid;

use crate::fields::{Field, FieldId, Part, nearest};

/// A field, and for a field of a force or of an absorber in a list its number there, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Slot {
    /// The field.
    pub field: FieldId,
    /// Number of the force or of the absorber in a list; `None` for all other parts, for a single force, and for an
    /// absorber that is alone or for all of several.
    pub number: Option<usize>,
    /// Number of the unit of that absorber whose start it is; `None` for all its units, and for all other fields.
    pub unit: Option<usize>,
}

impl From<FieldId> for Slot {
    fn from(field: FieldId) -> Self {
        Self { field, number: None, unit: None }
    }
}

impl Slot {
    /// A field of the force with this number, of so many.
    pub fn of_force(field: FieldId, number: usize, count: usize) -> Self {
        Self { number: (count > 1).then_some(number), ..field.into() }
    }

    /// A field of the start of one unit of the absorber with this number.
    pub fn of_unit(field: FieldId, absorber: usize, unit: usize) -> Self {
        Self { field, number: Some(absorber), unit: Some(unit) }
    }

    /// A field of the absorber with this number, of so many.
    pub fn of_absorber(field: FieldId, number: usize, count: usize) -> Self {
        Self::of_force(field, number, count)
    }

    /// Reads a sweep key: as [`FieldId::from_key`], or with the number of a force or of an absorber in a list, as in
    /// `force.0.frequency`, `absorber.1.clearance` and `start.1.gap_displacement`.
    ///
    /// # Errors
    /// As [`FieldId::from_key`].
    pub fn from_key(key: &str) -> Result<Self, Invalid> {
        let Some((part, number, name)) = numbered(key) else {
            return FieldId::from_key(key).map(Self::from);
        };
        let listed = |field: &FieldId| part == Part::Force || field.of_absorber();
        match FieldId::find(part, name).filter(listed) {
            Some(field) => Ok(Self { number: Some(number), ..field.into() }),
            None => {
                let of = if part == Part::Force { "a force" } else { "an absorber" };
                let known = FieldId::all().filter(|id| id.info().part == part && listed(id));
                let near = nearest(name, known.map(|id| id.info().name));
                let near =
                    near.map(|near| format!("; did you mean `{}.{number}.{near}`?", part.name()));
                let rule = format!("no such field of {of}{}", near.unwrap_or_default());
                Err(Invalid::new("sweep key", format!("`{key}`"), rule))
            }
        }
    }

    /// The row of the field in the table of fields.
    pub fn info(self) -> &'static Field {
        self.field.info()
    }

    /// `part.name`, with the number in a list between them, and that of a unit, as error messages and study files write it.
    pub fn path(self) -> String {
        let (part, name) = (self.info().part.name(), self.info().name);
        match (self.number, self.unit) {
            (Some(number), Some(unit)) => format!("{part}.{number}.{unit}.{name}"),
            (Some(number), None) => format!("{part}.{number}.{name}"),
            _ => self.field.path(),
        }
    }

    /// True if two slots set the same quantity, of the same force, absorber or unit if it is one of these.
    pub fn same_quantity(self, other: Slot) -> bool {
        if !self.field.same_quantity(other.field) {
            return false;
        }
        match (self.number, other.number) {
            (None, _) | (_, None) if self.field.of_absorber() => true,
            (one, other) if one.unwrap_or(0) != other.unwrap_or(0) => false,
            _ => self.unit.is_none() || other.unit.is_none() || self.unit == other.unit,
        }
    }

    /// Checks a value against the field's range.
    ///
    /// # Errors
    /// [`Invalid`] with field, value and range.
    pub fn check(self, value: f64) -> Result<f64, Invalid> {
        self.field.check(value).map_err(|error| Invalid { field: self.path(), ..error })
    }
}

/// Part, number and name of a key `part.number.name` of a part that can be a list.
fn numbered(key: &str) -> Option<(Part, usize, &str)> {
    let (part, rest) = key.split_once('.')?;
    let part = [Part::Force, Part::Absorber, Part::Start].into_iter().find(|it| it.name() == part);
    let (digits, name) = rest.split_once('.')?;
    let number: usize = digits.parse().ok()?;
    // One key for each field: no 01.
    (number.to_string() == digits).then_some((part?, number, name))
}
