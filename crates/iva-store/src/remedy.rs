//! Advice to the user about a folder that is refused, with the option names of the front that shows it: the
//! command line or Python.

/// Names of a front's options, as messages show them.
#[derive(Debug, Clone, Copy)]
pub struct Words {
    /// Option that names the output folder.
    pub out: &'static str,
    /// Option that replaces the result in the folder.
    pub overwrite: &'static str,
    /// Option that resumes the sweep in the folder.
    pub resume: &'static str,
    /// Options that resume a sweep that is to replace the result in the folder.
    pub overwrite_and_resume: &'static str,
}

/// Advice to the user about a refused folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remedy {
    /// Choose another folder.
    OtherFolder,
    /// Move the file or folder that is in the way, or choose another folder.
    MoveOrOtherFolder,
    /// Wait for the end of the process that writes into the folder, or choose another folder.
    WaitOrOtherFolder,
    /// Choose another folder, or replace the tables in this one.
    OtherFolderOrReplace,
    /// Choose another folder, replace the tables in this one, or resume the sweep that wrote them.
    OtherFolderReplaceOrGoOn,
    /// Choose another folder, or replace the sweep in this one instead of resuming it.
    OtherFolderOrNotResume,
    /// Replace the result in the folder.
    BeginAnew,
}

impl Remedy {
    /// The advice as an imperative clause, without a full stop.
    pub fn sentence(self, words: &Words) -> String {
        let Words { out, overwrite, resume, .. } = words;
        let other = format!("choose another folder {out}");
        match self {
            Self::OtherFolder => other,
            Self::MoveOrOtherFolder => format!("move it or {other}"),
            Self::WaitOrOtherFolder => format!("wait for its end, or {other}"),
            Self::OtherFolderOrReplace => format!("{other}, or give {overwrite} to replace them"),
            Self::OtherFolderReplaceOrGoOn => format!(
                "{other}, or give {overwrite} to replace them, or {resume} to go on with the sweep that \
                 wrote them"
            ),
            Self::OtherFolderOrNotResume => {
                format!("{other}, or give {overwrite} without {resume} to replace it")
            }
            Self::BeginAnew => format!("give {overwrite} to begin anew"),
        }
    }
}
