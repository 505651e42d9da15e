//! Folders that are made on the way to a result.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folders made for the output, removed again if nothing was put into them.
#[derive(Debug, Default)]
pub(crate) struct CreatedFolders(Vec<PathBuf>);

impl CreatedFolders {
    /// Makes a folder that the user named, and those above it.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn create(dir: &Path) -> io::Result<Self> {
        let mut missing: Vec<PathBuf> = dir
            .ancestors()
            .take_while(|path| !path.as_os_str().is_empty() && !path.exists())
            .map(Path::to_owned)
            .collect();
        missing.reverse();
        let created = Self(missing);
        fs::create_dir_all(dir)?;
        Ok(created)
    }
}

impl Drop for CreatedFolders {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // Fails, as it should, for a folder that holds something.
            let _ = fs::remove_dir(folder);
        }
    }
}
