//! The errors of the command, worded for the terminal, and their exit codes.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use iva_store::remedy::Words;
use iva_store::visible;
use iva_study::error::StudyError;
use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

use crate::layout::WIDTH;
use crate::{EXIT_BAD_INPUT, EXIT_FAULT, EXIT_INTERRUPTED};

/// Spelling of the options on the command line, for error messages.
pub const COMMAND: Words = Words {
    out: "with --out",
    overwrite: "--overwrite",
    resume: "--resume",
    overwrite_and_resume: "--overwrite --resume",
};

/// An error of the command; its `Display` is the message a user reads.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of a study file, a run or an output folder.
    #[error("{}", worded(.0))]
    Study(#[from] iva_study::Error),
    /// A request that cannot be served: one sentence with what to do instead.
    #[error("{0}")]
    Refused(String),
    /// A command that ended early by Ctrl-C, with something to keep.
    #[error("interrupted: {kept}")]
    Interrupted {
        /// What is printed of what it found.
        report: String,
        /// How much that is, and where it is written.
        kept: String,
    },
}

impl Error {
    /// The exit code: 2 for bad input, 1 for an I/O or internal fault, 130 for an interrupt.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Study(error) if error.is_interrupted() => EXIT_INTERRUPTED,
            Error::Interrupted { .. } => EXIT_INTERRUPTED,
            Error::Study(error) if !error.is_bad_input() => EXIT_FAULT,
            Error::Study(_) | Error::Refused(_) => EXIT_BAD_INPUT,
        }
    }

    /// The report for a terminal, with colours; for an error in a study file with the line in question.
    pub fn report(&self) -> String {
        match self {
            Error::Study(iva_study::Error::Study(error)) => picture(error),
            other => format!("error: {}", visible(&other.to_string())),
        }
    }
}

/// The message of an error with the command-line options that help.
fn worded(error: &iva_study::Error) -> String {
    use iva_study::Error;
    match error {
        Error::Store(error) => error.message(&COMMAND),
        Error::Incomplete { reason, kept } => {
            format!("{}; {}", worded(reason), kept.sentence(&COMMAND))
        }
        Error::Interrupted(kept) => format!("interrupted: {}", kept.sentence(&COMMAND)),
        other => other.to_string(),
    }
}

/// The message of an error in a study file with the line in question, the place underlined, in colours.
fn picture(error: &StudyError) -> String {
    let path = visible(&error.path.display().to_string());
    let message = visible(&error.message);
    let Some(place) = &error.place else {
        let title = format!("{path}: {message}");
        return rendered(&[Group::with_title(Level::ERROR.primary_title(title))]);
    };
    let snippet = Snippet::source(&place.text)
        .line_start(place.line)
        .path(path)
        .annotation(AnnotationKind::Primary.span(place.span.clone()));
    rendered(&[Level::ERROR.primary_title(message.as_str()).element(snippet)])
}

fn rendered(report: &[Group<'_>]) -> String {
    Renderer::styled().term_width(WIDTH).render(report).to_string()
}

impl From<iva_store::Error> for Error {
    fn from(error: iva_store::Error) -> Self {
        Error::Study(error.into())
    }
}

impl From<Invalid> for Error {
    fn from(error: Invalid) -> Self {
        Error::Study(error.into())
    }
}

impl From<SweepError> for Error {
    fn from(error: SweepError) -> Self {
        Error::Study(error.into())
    }
}

#[cfg(test)]
mod tests;
