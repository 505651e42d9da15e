//! What a refusal must be: one sentence that can be shown in a terminal.

use iva_cli::EXIT_BAD_INPUT;
use iva_core::error::Invalid;
use iva_study::Error;

/// Checks the error of something that cannot be used.
pub fn check(error: Error) {
    if let Error::Study(fault) = &error
        && let Some(place) = &fault.place
    {
        assert!(place.line > 0 && place.column > 0, "{place:?}");
        assert!(place.text.get(place.span.clone()).is_some(), "{place:?}");
    }
    let error = iva_cli::Error::from(error);
    assert_eq!(error.exit_code(), EXIT_BAD_INPUT, "{error:?}");
    sentence(&error.to_string());
    assert!(!error.report().is_empty());
}

/// Checks the error of a number out of range.
pub fn check_invalid(invalid: &Invalid) {
    assert!(!invalid.field.is_empty() && !invalid.allowed.is_empty(), "{invalid:?}");
    sentence(&invalid.to_string());
}

fn sentence(message: &str) {
    assert!(!message.is_empty() && !message.contains(char::is_control), "{message:?}");
}
