//! What a study made in a program refers to and no file holds: points and records. They are written
//! beside the tables, so that the resolved study can name them.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use iva_sweep::forces::History;
use iva_sweep::sampling::{Rows, Sampling};

use crate::directory::Directory;
use crate::error::Error;
use crate::points_file::write_points;
use crate::study_file::StudyFile;

/// The folder of inputs below that of the result.
pub(crate) const INPUTS: &str = "inputs";
/// The file of points in it.
const POINTS_FILE: &str = "points.parquet";
/// More points than this are not written out in the study.
const FEW: usize = 1000;

/// True of a name that an input has, relative to the folder of the result.
pub(crate) fn is_input_name(name: &str) -> bool {
    let Some(file) = name.strip_prefix(INPUTS).and_then(|rest| rest.strip_prefix('/')) else {
        return false;
    };
    let number = file.strip_prefix("record-").and_then(|rest| rest.strip_suffix(".csv"));
    let is_number = |digits: &str| {
        (1..=9).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    file == POINTS_FILE || number.is_some_and(is_number)
}

/// A file to be written.
pub(crate) struct Input {
    name: String,
    content: Content,
}

enum Content {
    Points(Rows),
    Record(Arc<History>),
}

/// The study with names for what has none, and the files of these names. What is among the inputs of the
/// folder already is written anew: it would go with the tables that are replaced.
pub(crate) fn named(file: &StudyFile, dir: &Path) -> (StudyFile, Vec<Input>) {
    let mut named = file.clone();
    let mut inputs = Vec::new();
    let own = dir.canonicalize().map(|dir| dir.join(INPUTS));
    let unnamed = |file: &Option<String>| match (file, &own) {
        (None, _) => true,
        (Some(file), Ok(own)) => Path::new(file).starts_with(own),
        _ => false,
    };
    for (number, recorded) in named.study.spec.records_mut().enumerate() {
        if unnamed(&recorded.file) {
            let name = format!("{INPUTS}/record-{number}.csv");
            recorded.file = Some(name.clone());
            inputs.push(Input { name, content: Content::Record(Arc::clone(&recorded.history)) });
        }
    }
    if let Sampling::Rows(rows) = &mut named.study.sampling
        && unnamed(&rows.file)
        && rows.axes().iter().any(|axis| axis.values.len() > FEW)
    {
        let name = format!("{INPUTS}/{POINTS_FILE}");
        inputs.push(Input { name: name.clone(), content: Content::Points(rows.clone()) });
        rows.file = Some(name);
    }
    (named, inputs)
}

impl Input {
    /// Its name, relative to the folder.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Writes the file below a folder: first aside, in a folder of unfinished files, then into place.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub(crate) fn write(&self, work: &Directory, root: &Directory) -> Result<(), Error> {
        let aside = Path::new("input");
        work.remove_file(aside)?;
        match &self.content {
            Content::Points(rows) => write_points(work, aside, rows)?,
            Content::Record(history) => work.write_new(aside, record(history).as_bytes())?,
        }
        work.replace(aside, root, Path::new(&self.name))
    }
}

/// Times and values with the digits that read back the same.
fn record(history: &History) -> String {
    let mut text = "time,value\n".to_owned();
    for (time, value) in history.times().iter().zip(history.values()) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time:?},{value:?}");
    }
    text
}
