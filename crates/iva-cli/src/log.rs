//! The log of `--log FILE`: the events of a run as lines of JSON.
//!
//! Every line is an object with `time` (seconds since 1970, UTC) and `event`: `start`, `checked`,
//! `damaged`, `part`, and at the end `finished` or `failed`.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use crate::error::Error;

/// The log of a command; without a file it writes nothing.
pub(crate) struct Log {
    file: Option<Mutex<File>>,
    start: Instant,
}

impl Log {
    /// Opens the log file for appending; without a path the log writes nothing.
    ///
    /// # Errors
    /// [`Error::Refused`] if it cannot be written.
    pub(crate) fn open(path: Option<&Path>) -> Result<Self, Error> {
        let open = |path: &Path| {
            if path.exists() && !path.is_file() {
                // A pipe without a reader would not even open.
                return Err(Error::Refused(format!(
                    "cannot write the log file {}: give a regular file",
                    path.display()
                )));
            }
            OpenOptions::new().create(true).append(true).open(path).map_err(|reason| {
                Error::Refused(format!("cannot write the log file {}: {reason}", path.display()))
            })
        };
        let file = path.map(open).transpose()?.map(Mutex::new);
        Ok(Self { file, start: Instant::now() })
    }

    /// Appends one event with its fields, which are a JSON object.
    pub(crate) fn event(&self, event: &str, fields: Value) {
        let Some(file) = &self.file else { return };
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let mut line = json!({ "time": now.as_secs_f64(), "event": event });
        if let (Value::Object(line), Value::Object(fields)) = (&mut line, fields) {
            line.extend(fields);
        }
        // A log that cannot be written, as on a full disk, must not end the run.
        if let Ok(mut file) = file.lock() {
            let _ = writeln!(file, "{line}");
        }
    }

    /// Appends the last event: `finished` or `failed`, with the exit code and the time in seconds.
    pub(crate) fn end<T>(&self, result: &Result<T, Error>) {
        let seconds = self.start.elapsed().as_secs_f64();
        match result {
            Ok(_) => self.event("finished", json!({ "seconds": seconds, "exit_code": 0 })),
            Err(error) => self.event(
                "failed",
                json!({
                    "seconds": seconds,
                    "exit_code": error.exit_code(),
                    "message": error.to_string(),
                }),
            ),
        }
    }
}
