//! The field that a command changes, as its options give it, and errors that name these options, not a line of the study.

use iva_study::study_file::StudyFile;
use iva_sweep::Invalid;
use iva_sweep::slot::Slot;

use crate::error::Error;

/// A field with its range: the options --over, --from and --to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChangedField<'a> {
    pub over: Slot,
    name: &'a str,
    range: [f64; 2],
}

impl<'a> ChangedField<'a> {
    /// # Errors
    /// If there is no such field, or the range has no length; it may have none where there is a single value.
    pub fn new(name: &'a str, range: [f64; 2], single: bool) -> Result<Self, Error> {
        let over = Slot::from_key(name)
            .map_err(|invalid| Error::Refused(format!("--over {name}: {}", invalid.allowed)))?;
        let [low, high] = range;
        let field = Self { over, name, range };
        let finite = low.is_finite() && high.is_finite();
        if !finite || low > high || (low == high && !single) {
            let rule = "give two numbers, the smaller one first";
            return Err(Error::Refused(format!("{}: {rule}", field.options())));
        }
        Ok(field)
    }

    fn options(&self) -> String {
        let [low, high] = self.range;
        format!("--from {low} --to {high}")
    }

    /// The error for an invalid value: of the field, or of another one of the study.
    pub fn blame(&self, file: &StudyFile, invalid: &Invalid) -> Error {
        let own = invalid.field == self.over.path();
        match invalid.field.as_str() {
            "over" => Error::Refused(format!("--over {}: {}", self.name, invalid.allowed)),
            "between" => Error::Refused(format!("{}: {}", self.options(), invalid.allowed)),
            _ if own && !invalid.value.is_empty() => {
                Error::Refused(format!("--over {} {}: {invalid}", self.name, self.options()))
            }
            _ => file.source.locate(invalid).into(),
        }
    }
}
