//! Points and records of a study made in a program, which are written beside the tables so that the resolved
//! study can name their files.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use iva_sweep::forces::History;
use iva_sweep::sampling::Rows;

use crate::directory::Directory;
use crate::error::Error;
use crate::points_file::write_points;

/// Name of the folder of inputs in the folder of a result.
pub const INPUTS: &str = "inputs";
/// Name of the file of points in the folder of inputs.
const POINTS_FILE: &str = "points.parquet";

/// True if `name`, relative to the folder of the result, is that of a file of points or of a record.
pub fn is_input_name(name: &str) -> bool {
    let Some(file) = name.strip_prefix(INPUTS).and_then(|rest| rest.strip_prefix('/')) else {
        return false;
    };
    let number = file.strip_prefix("record-").and_then(|rest| rest.strip_suffix(".csv"));
    let is_number = |digits: &str| {
        (1..=9).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    file == POINTS_FILE || number.is_some_and(is_number)
}

/// A file of points or of a record that is to be written into the folder of inputs.
pub struct Input {
    name: String,
    content: Content,
}

/// The numbers of an input.
enum Content {
    Points(Rows),
    Record(Arc<History>),
}

impl Input {
    /// The file of the points of a sweep.
    pub fn points(rows: Rows) -> Self {
        Self { name: format!("{INPUTS}/{POINTS_FILE}"), content: Content::Points(rows) }
    }

    /// The file of a recorded history, numbered from 0 among the records of the study.
    pub fn record(number: usize, history: Arc<History>) -> Self {
        Self { name: format!("{INPUTS}/record-{number}.csv"), content: Content::Record(history) }
    }

    /// Name of the file, relative to the folder of the result.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Writes the file into `work`, the folder of unfinished files, and renames it into place below `root`.
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

/// The CSV text of a history in the units of its study, with digits that read back as the same numbers.
fn record(history: &History) -> String {
    let mut text = "time,value (1)\n".to_owned();
    for (time, value) in history.times().iter().zip(history.values()) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time:?},{value:?}");
    }
    text
}
