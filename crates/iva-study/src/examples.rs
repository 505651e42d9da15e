//! The studies that come with the program, and the records that they or the pages read.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::Error;

/// Names and contents of files of the folder `studies`.
macro_rules! files {
    ($($name:literal)*) => {
        &[$(($name, include_bytes!(concat!("../../../studies/", $name)).as_slice())),*]
    };
}

/// All of them, in the order of their names.
pub const FILES: &[(&str, &[u8])] = files! {
    "decay.csv"
    "earthquake.toml"
    "floor_upright.toml"
    "forced_response.toml"
    "forced_response_piva.toml"
    "frame_two_storeys.toml"
    "multi_unit.toml"
    "piva_clearance.toml"
    "piva_frequency_ratio.toml"
    "piva_restitution.toml"
    "piva_table1.toml"
    "siva_clearance.toml"
    "siva_restitution.toml"
    "synthetic_quake.at2"
};

/// Copies all of them into a folder, which is made if it is not there. Returns the files that were written; one that is
/// there already, with the same contents, is left as it is.
///
/// # Errors
/// [`Error::OtherContents`] for a file of that name with other contents, before anything is written; [`Error::Store`] if
/// one cannot be read or written.
pub fn copy_into(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut missing = Vec::new();
    for (name, contents) in FILES {
        let path = folder.join(name);
        if !is_there(&path, contents)? {
            missing.push((path, contents));
        }
    }
    fs::create_dir_all(folder).map_err(|reason| fault("create", folder.to_owned(), reason))?;
    for (path, contents) in &missing {
        // Follows no link: what is there by now is an error.
        let mut file =
            File::create_new(path).map_err(|reason| fault("write", path.clone(), reason))?;
        if let Err(reason) = file.write_all(contents) {
            // Half a file would be taken for one of the user.
            let _ = fs::remove_file(path);
            return Err(fault("write", path.clone(), reason));
        }
    }
    Ok(missing.into_iter().map(|(path, _)| path).collect())
}

/// True if a file with these contents is there, false if nothing is. Only a regular file of that size is opened, so that
/// neither a pipe nor a device makes the program wait.
///
/// # Errors
/// [`Error::OtherContents`] for anything else that is there; [`Error::Store`] if it cannot be read.
fn is_there(path: &Path, contents: &[u8]) -> Result<bool, Error> {
    let other = || Error::OtherContents { path: path.to_owned() };
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() || found.len() != contents.len() as u64 => Err(other()),
        Ok(_) => match fs::read(path).map_err(|reason| fault("read", path.to_owned(), reason))? {
            there if there == contents => Ok(true),
            _ => Err(other()),
        },
        Err(reason) if reason.kind() == ErrorKind::NotFound => Ok(false),
        Err(reason) => Err(fault("read", path.to_owned(), reason)),
    }
}

fn fault(action: &'static str, path: PathBuf, source: std::io::Error) -> Error {
    iva_store::Error::Io { action, path, source }.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_of_studies_comes_along() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, FILES.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    }

    #[test]
    fn what_is_there_is_never_replaced() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("new/studies");
        assert_eq!(copy_into(&folder).unwrap().len(), FILES.len());
        assert_eq!(copy_into(&folder).unwrap(), Vec::<PathBuf>::new());
        fs::remove_file(folder.join("earthquake.toml")).unwrap();
        assert_eq!(copy_into(&folder).unwrap(), [folder.join("earthquake.toml")]);
        fs::write(folder.join("multi_unit.toml"), "mine").unwrap();
        fs::remove_file(folder.join("earthquake.toml")).unwrap();
        let error = copy_into(&folder).unwrap_err();
        assert!(error.is_bad_input() && error.to_string().contains("multi_unit.toml"), "{error}");
        assert_eq!(fs::read_to_string(folder.join("multi_unit.toml")).unwrap(), "mine");
        assert!(!folder.join("earthquake.toml").exists());
    }
    #[cfg(unix)]
    #[test]
    fn no_link_is_followed_and_no_pipe_opened() {
        use std::os::unix::fs::symlink;
        use std::process::Command;

        let place = tempfile::tempdir().unwrap();
        let (folder, outside) = (place.path().join("studies"), place.path().join("outside"));
        fs::create_dir(&folder).unwrap();
        let link = folder.join("decay.csv");
        symlink(&outside, &link).unwrap();
        assert!(copy_into(&folder).unwrap_err().is_bad_input());
        fs::write(&outside, FILES[0].1).unwrap();
        assert!(copy_into(&folder).unwrap_err().is_bad_input(), "not even to the same contents");
        fs::remove_file(&link).unwrap();
        assert!(Command::new("mkfifo").arg(&link).status().unwrap().success());
        assert!(copy_into(&folder).unwrap_err().is_bad_input());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing was written");
    }
}
