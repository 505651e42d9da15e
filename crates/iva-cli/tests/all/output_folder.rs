//! Output folders that cannot be written or that vanish: one clear message, nothing half-written.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::Job;

/// User id without privileges, for which permissions hold.
const NOBODY: u32 = 65_534;

fn study(dir: &Path, periods: f64, count: u32) {
    let text = format!(
        "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
         mass_ratio = 0.1\nrestitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\n\
         periods = {periods}\nerrors = true\ntables = [\"summary\"]\n[sweep]\n\
         relative_clearance = {{ start = 0.3, stop = 1.2, count = {count} }}\n"
    );
    fs::write(dir.join("my.toml"), text).unwrap();
}

fn allow(path: &Path, mode: u32) {
    fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
}

/// Paths of the entries of a folder, with hidden ones.
fn entries(dir: &Path) -> Vec<PathBuf> {
    fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_read_only_folder_is_refused_before_anything_is_run() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    study(dir.path(), 5.0, 3);
    fs::create_dir(&out).unwrap();
    // The program is copied for a user who may not look into the folder of the build.
    let program = dir.path().join("iva");
    fs::copy(env!("CARGO_BIN_EXE_iva"), &program).unwrap();
    allow(dir.path(), 0o755);
    allow(&out, 0o555);
    for folder in ["out", "out/deeper/still"] {
        let mut command = Command::new(&program);
        command.current_dir(dir.path()).args(["sweep", "my.toml", "--out", folder]);
        if fs::metadata(dir.path()).unwrap().uid() == 0 {
            command.uid(NOBODY);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.starts_with(&format!("error: cannot write into the folder {folder}: ")));
        assert!(said.contains("choose another folder with --out"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(output.stdout.is_empty());
        assert!(entries(&out).is_empty());
    }
}

/// Moves the output folder away once a number of parts were begun, and checks how the run ends, which would take
/// an hour otherwise.
fn vanish(parts: usize) {
    let dir = tempfile::tempdir().unwrap();
    study(dir.path(), 2e4, 1_000_000);
    let mut command = Command::new(env!("CARGO_BIN_EXE_iva"));
    command.current_dir(dir.path()).args(["sweep", "my.toml", "--out", "out", "--quiet"]);
    let mut job = Job::start(&mut command);
    let out = dir.path().join("out");
    job.until(|| {
        let complete = fs::read_dir(out.join("summary")).into_iter().flatten().count();
        let hidden = fs::read_dir(out.join(".iva-work")).into_iter().flatten();
        let staged = hidden.flatten().filter(|entry| entry.path().is_dir()).count();
        complete + staged >= parts
    });
    // A folder removed file by file would be filled again meanwhile; a rename moves it at once.
    fs::rename(&out, dir.path().join("gone")).unwrap();
    let output = job.end();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    let expected = "error: cannot write out: the folder vanished during the run";
    assert!(said.starts_with(expected), "{said}");
    assert!(!out.exists(), "{said}: {:?}", entries(&out));
}

#[test]
fn a_folder_that_vanishes_in_the_first_part_is_told() {
    vanish(1);
}

#[test]
fn a_folder_that_vanishes_in_a_later_part_is_told() {
    vanish(4);
}
