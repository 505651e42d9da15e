//! Conversion of errors into Python exceptions.

use std::fmt::Display;
use std::path::Path;

use iva_store::remedy::Words;
use iva_store::visible;
use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;
use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};

create_exception!(
    iva,
    IvaError,
    PyRuntimeError,
    "A fault that no argument explains: files that cannot be read, or a defect of the program."
);

/// The exception for an invalid value: `ValueError` with field, value and what is allowed.
pub fn invalid(error: Invalid) -> PyErr {
    PyValueError::new_err(visible(&error.to_string()))
}

/// The exception for a failed run: `ValueError` where the user can mend it, else `IvaError`.
pub fn failed(error: SweepError) -> PyErr {
    match error {
        SweepError::Invalid(error) => invalid(error),
        fault => IvaError::new_err(visible(&fault.to_string())),
    }
}

/// The exception for a result file that cannot be read.
pub fn unreadable(error: iva_store::Error) -> PyErr {
    match error {
        iva_store::Error::Io { action: "read", path, source } => cannot_be_read(&path, source),
        other => IvaError::new_err(visible(&other.to_string())),
    }
}

/// The exception for a study or record file that cannot be read.
pub fn unreadable_study(error: iva_study::Error) -> PyErr {
    match error {
        iva_study::Error::Store(error) => unreadable(error),
        iva_study::Error::UnreadableRecord { path, reason } => cannot_be_read(&path, reason),
        other => IvaError::new_err(visible(&other.to_string())),
    }
}

fn cannot_be_read(path: &Path, reason: impl Display) -> PyErr {
    IvaError::new_err(visible(&format!("{} cannot be read: {reason}", path.display())))
}

/// Spelling of the options in Python, for error messages.
pub const PYTHON: Words = Words {
    out: "as out",
    overwrite: "overwrite=True",
    resume: "resume=True",
    overwrite_and_resume: "overwrite=True, resume=True",
};

/// The exception for a sweep into a folder that did not finish.
pub fn refused(error: iva_study::Error) -> PyErr {
    let sentence = visible(&worded(&error));
    match error.is_bad_input() {
        true => PyValueError::new_err(sentence),
        false => IvaError::new_err(sentence),
    }
}

/// The exception for a study file, at the line of what is wrong in it.
pub fn refused_study(error: &iva_study::Error) -> PyErr {
    let sentence = visible(&error.to_string());
    match error.is_bad_input() {
        true => PyValueError::new_err(sentence),
        false => IvaError::new_err(sentence),
    }
}

/// The message of an error with the Python arguments that help; it points at no line of a study file.
pub fn worded(error: &iva_study::Error) -> String {
    use iva_study::Error;
    match error {
        Error::Study(error) => error.message.clone(),
        Error::Store(error) => error.message(&PYTHON),
        Error::Incomplete { reason, kept } => {
            format!("{}; {}", worded(reason), kept.sentence(&PYTHON))
        }
        Error::Interrupted(kept) => format!("interrupted: {}", kept.sentence(&PYTHON)),
        other => other.to_string(),
    }
}

/// The exception for a defect of the program, with a description.
pub fn internal(what: &str) -> PyErr {
    IvaError::new_err(format!("internal error, please report it: {what}"))
}
