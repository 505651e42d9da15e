//! Opening of regular files only: reading a pipe without a writer would wait for ever, and a device may have
//! no end.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Opens a regular file for reading.
///
/// # Errors
/// As [`File::open`], and [`ErrorKind::InvalidInput`] for anything but a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    // Opening a pipe would already wait for its writer.
    refuse(&fs::metadata(path)?)?;
    let file = File::open(path)?;
    // The path may lead to another file by now.
    refuse(&file.metadata()?)?;
    Ok(file)
}

fn refuse(found: &fs::Metadata) -> io::Result<()> {
    let what = match found {
        it if it.is_file() => return Ok(()),
        it if it.is_dir() => "it is a folder; give a file",
        _ => "it is a pipe, a device or a socket; give a regular file",
    };
    Err(io::Error::new(ErrorKind::InvalidInput, what))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        assert_eq!(open(&file).unwrap_err().kind(), ErrorKind::NotFound);
        fs::write(&file, "text").unwrap();
        assert!(open(&file).is_ok());
        assert!(open(folder.path()).unwrap_err().to_string().contains("it is a folder"));
        if cfg!(unix) {
            let said = open(Path::new("/dev/null")).unwrap_err().to_string();
            assert!(said.contains("give a regular file"), "{said}");
        }
    }
}
