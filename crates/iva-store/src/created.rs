//! Folders that are created for a result.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folders created for the output, which are removed on drop where they are empty.
#[derive(Debug, Default)]
pub(crate) struct CreatedFolders(Vec<PathBuf>);

impl CreatedFolders {
    /// Creates a folder with its missing parent folders.
    ///
    /// # Errors
    /// The error of the operating system.
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
            // The call fails for a folder that is not empty, as intended.
            let _ = fs::remove_dir(folder);
        }
    }
}
