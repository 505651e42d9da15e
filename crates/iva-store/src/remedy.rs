//! What a user can do about a folder that is refused, in the words of the front that shows it: the
//! terminal or Python.

/// How a front writes its options.
#[derive(Debug, Clone, Copy)]
pub struct Words {
    /// Names the folder.
    pub out: &'static str,
    /// Replaces what is there.
    pub overwrite: &'static str,
    /// Goes on with what is there.
    pub resume: &'static str,
    /// Goes on with what was to replace what is there.
    pub overwrite_and_resume: &'static str,
}

/// What can be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remedy {
    /// Choose another folder.
    OtherFolder,
    /// The same, or move what is in the way.
    MoveOrOtherFolder,
    /// The same, or wait for another process.
    WaitOrOtherFolder,
    /// The same, or replace the tables that are there.
    OtherFolderOrReplace,
    /// The same, or go on with the sweep that wrote them.
    OtherFolderReplaceOrGoOn,
    /// Choose another folder, or replace another sweep instead of going on with it.
    OtherFolderOrNotResume,
    /// Replace what is there.
    BeginAnew,
}

impl Remedy {
    /// An order to the user, without a stop.
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
