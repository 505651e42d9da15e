//! The error for a value that cannot be used.

/// A value outside what the model allows: one sentence with field, value and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct Invalid {
    /// Name of the field as the user wrote it, for example `absorber.restitution`.
    pub field: String,
    /// The offending value, printed; empty where the field is missing.
    pub value: String,
    /// What is allowed instead.
    pub allowed: String,
}

impl Invalid {
    /// Builds the error from a field name, a printable value and the rule that it breaks.
    pub fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The error for a field that is missing.
    pub fn missing(field: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self::new(field, "", allowed)
    }

    fn sentence(&self) -> String {
        let Self { field, value, allowed } = self;
        if value.is_empty() {
            format!("{field} is missing: {allowed}")
        } else {
            format!("{field} = {value}: {allowed}")
        }
    }
}

/// A number as messages print it: the fewest digits that identify it, with an exponent where that is shorter
/// and the number very large or very small.
pub fn number(value: impl Into<f64>) -> String {
    let value = value.into();
    let (plain, scientific) = (value.to_string(), format!("{value:e}"));
    let usual = value == 0.0 || (1e-4..1e6).contains(&value.abs());
    if usual || !value.is_finite() || plain.len() <= scientific.len() { plain } else { scientific }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_printed_as_one_would_write_them() {
        for (value, text) in [
            (0.1, "0.1"),
            (-0.0, "-0"),
            (1000.0, "1000"),
            (1e12, "1e12"),
            (123456789.0, "123456789"),
            (5e-324, "5e-324"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
