//! Points and records that a study refers to and that no file holds. They are written beside the tables,
//! so that the resolved study can name them.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use iva_sweep::forces::History;
use iva_sweep::sampling::Rows;

use crate::directory::Directory;
use crate::error::Error;
use crate::points_file::write_points;

/// The name of the folder of inputs below that of the result.
pub const INPUTS: &str = "inputs";
/// The file of points in it.
const POINTS_FILE: &str = "points.parquet";

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

/// A file of points or of a record that is to be written below the folder of a result.
pub struct Input {
    name: String,
    content: Content,
}

enum Content {
    Points(Rows),
    Record(Arc<History>),
}

impl Input {
    /// The points of a sweep.
    pub fn points(rows: Rows) -> Self {
        Self { name: format!("{INPUTS}/{POINTS_FILE}"), content: Content::Points(rows) }
    }

    /// The record of the force of that number.
    pub fn record(number: usize, history: Arc<History>) -> Self {
        Self { name: format!("{INPUTS}/record-{number}.csv"), content: Content::Record(history) }
    }

    /// Its name, relative to the folder.
    pub fn name(&self) -> &str {
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
