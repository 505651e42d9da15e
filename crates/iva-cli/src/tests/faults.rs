//! Faults and kills at every system call: one whole result is there at the end in every case.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use iva_store::faults;

use crate::args::Cli;
use crate::run_command_line;

type Files = BTreeMap<String, Vec<u8>>;

/// Every file below a folder with its bytes.
fn files(dir: &Path) -> Files {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(dir).unwrap().display().to_string();
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

/// The files below a folder with their bytes, without hidden ones.
fn visible(dir: &Path) -> Files {
    let mut found = files(dir);
    found.retain(|name, _| !name.starts_with(".iva-"));
    found
}

fn copy(files: &Files, dir: &Path) {
    for (name, bytes) in files {
        fs::create_dir_all(dir.join(name).parent().unwrap()).unwrap();
        fs::write(dir.join(name), bytes).unwrap();
    }
}

const STUDY: &str = "version = 1\n[absorber]\nkind = \"siva\"\nmass_ratio = 0.1\n\
    restitution = 0.5\nrelative_clearance = 0.6\n[start]\ndisplacement = 1.0\n[run]\nperiods = 2\n";
const SWEEP: &str = "tables = [\"summary\", \"impacts\"]\n[sweep]\n\
    relative_clearance = [1.0, 1.5, 2.0]\n";

/// A temporary folder with a study and folders for results.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let sweep = STUDY.replace("relative_clearance = 0.6\n", "") + SWEEP;
        fs::write(place.path("run.toml"), STUDY).unwrap();
        fs::write(place.path("sweep.toml"), sweep).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn iva(&self, command: &str, more: &[&str], out: &str) -> i32 {
        let mut args: Vec<OsString> = vec!["iva".into(), command.into()];
        args.push(self.path(&format!("{command}.toml")).into());
        args.extend(["--quiet".into(), "--threads".into(), "1".into(), "--out".into()]);
        args.push(self.path(out).into());
        args.extend(more.iter().map(OsString::from));
        let cli = Cli::try_parse_from(args).unwrap();
        // Errors are not printed: thousands of messages would bury the one of a failed test.
        run_command_line(&cli.command).map_or_else(|error| error.exit_code(), |_| 0)
    }

    /// The files that a command writes into an empty folder.
    fn made(&self, command: &str) -> Files {
        assert_eq!(self.iva(command, &["--overwrite"], "made"), 0);
        files(&self.path("made"))
    }
}

/// Lets a command over the tables of an earlier one fail or be killed at a system call, and checks the files
/// then, after the next command, and after the same command again; for every fifth call, or for every
/// call if `EVERY_FAULT` is set.
fn attack(earlier: Option<&str>, command: &str, more: &[&str]) {
    let step = if std::env::var_os("EVERY_FAULT").is_some() { 1 } else { 5 };
    let place = Place::new();
    let (old, new) = (earlier.map(|it| place.made(it)).unwrap_or_default(), place.made(command));
    let (out, mut faults_made) = (place.path("out"), 0);
    for killed in [false, true] {
        for at in (1..).step_by(step) {
            let told = format!("{earlier:?} {command}, killed: {killed}, call {at}");
            let _ = fs::remove_dir_all(&out);
            fs::create_dir(&out).unwrap();
            copy(&old, &out);
            fs::write(out.join("notes.txt"), "mine").unwrap();
            let with_notes = |files: &Files| {
                let mut files = files.clone();
                files.insert("notes.txt".to_owned(), b"mine".to_vec());
                files
            };
            let (old, new) = (with_notes(&old), with_notes(&new));
            let (code, calls) = faults::with(&out, at, killed, || place.iva(command, more, "out"));
            if calls < at {
                assert_eq!((code, files(&out)), (0, new), "{told}");
                break;
            }
            faults_made += 1;
            let found = visible(&out);
            if code == 0 {
                assert!(found == new, "success without the new tables: {told}");
            } else {
                assert!(code == 1 || code == 2, "{code}: {told}");
            }
            if !killed && earlier.is_some() {
                assert!(found == old || found == new, "{:?}: {told}", found.keys());
            }
            // The next command completes an unfinished exchange of files, even if it is itself refused.
            let refused = place.iva("run", &[], "out");
            let found = visible(&out);
            if earlier.is_some() {
                assert!(found == old || found == new, "{:?}: {told}", found.keys());
                assert_eq!(refused, 2, "{told}");
            } else if refused == 0 {
                // Nothing was there, so this command has written its own.
                continue;
            }
            assert_eq!(place.iva(command, &["--overwrite"], "out"), 0, "{told}");
            assert!(files(&out) == new, "{:?}: {told}", files(&out).keys());
        }
    }
    println!("{earlier:?}, {command} {more:?}: {faults_made} faults");
    assert!(faults_made > 200 / step, "{faults_made}");
}

#[test]
fn a_run_over_a_sweep_survives_any_fault() {
    attack(Some("sweep"), "run", &["--overwrite"]);
}

#[test]
fn a_sweep_over_a_run_survives_any_fault() {
    attack(Some("run"), "sweep", &["--overwrite"]);
}

#[test]
fn a_sweep_over_a_sweep_survives_any_fault() {
    attack(Some("sweep"), "sweep", &["--overwrite"]);
}

#[test]
fn a_first_run_survives_any_fault() {
    attack(None, "run", &[]);
}

#[test]
fn a_first_sweep_survives_any_fault() {
    attack(None, "sweep", &[]);
}
