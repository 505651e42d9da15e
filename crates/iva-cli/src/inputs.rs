//! What a study made in a program refers to and no file holds: points and records. They are written
//! beside the tables, so that the resolved study can name them.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use iva_sweep::forces::History;
use iva_sweep::sampling::{Rows, Sampling};

use crate::error::Error;
use crate::points_file::write_points;
use crate::study_file::StudyFile;

/// The folder of inputs below that of the result.
pub(crate) const INPUTS: &str = "inputs";
/// More points than this are not written out in the study.
const FEW: usize = 1000;

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
        let name = format!("{INPUTS}/points.parquet");
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

    /// Writes the file below a folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub(crate) fn write(&self, root: &Path) -> Result<(), Error> {
        let path = root.join(&self.name);
        let folder = root.join(INPUTS);
        fs::create_dir_all(&folder).map_err(|reason| Error::io("create", &folder, reason))?;
        match &self.content {
            Content::Points(rows) => write_points(&path, rows),
            Content::Record(history) => fs::write(&path, record(history))
                .and_then(|()| fs::File::open(&path)?.sync_all())
                .map_err(|reason| Error::io("write", &path, reason)),
        }
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
