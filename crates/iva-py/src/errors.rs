//! Which Python exception a failure becomes.

use iva_cli::remedy::Words;
use iva_cli::visible;
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

/// A value that cannot be used: `ValueError` with field, value and what is allowed.
pub fn invalid(error: Invalid) -> PyErr {
    PyValueError::new_err(visible(&error.to_string()))
}

/// A run that could not be made: `ValueError` where the user can mend it, else `IvaError`.
pub fn failed(error: SweepError) -> PyErr {
    match error {
        SweepError::Invalid(error) => invalid(error),
        fault => IvaError::new_err(visible(&fault.to_string())),
    }
}

/// A file of a result that cannot be read.
pub fn unreadable(error: iva_cli::Error) -> PyErr {
    let sentence = match &error {
        iva_cli::Error::Io { action: "read", path, source } => {
            format!("{} cannot be read: {source}", path.display())
        }
        other => other.to_string(),
    };
    IvaError::new_err(visible(&sentence))
}

/// How options are written in Python.
pub const PYTHON: Words = Words {
    out: "as out",
    overwrite: "overwrite=True",
    resume: "resume=True",
    overwrite_and_resume: "overwrite=True, resume=True",
};

/// A sweep into a folder that did not come to its end, in the words of Python.
pub fn refused(error: iva_cli::Error) -> PyErr {
    let sentence = visible(&error.message(&PYTHON));
    match error.exit_code() {
        2 => PyValueError::new_err(sentence),
        _ => IvaError::new_err(sentence),
    }
}

/// A defect of the program, with what is known of it.
pub fn internal(what: &str) -> PyErr {
    IvaError::new_err(format!("internal error, please report it: {what}"))
}
