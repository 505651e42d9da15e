//! The exit codes of the native program, by the same table as those of the Python console script.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use toml::Table;

use crate::process::Job;

#[test]
fn exit_codes_are_those_of_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/python/exit_codes.toml");
    let table: Table = fs::read_to_string(path).unwrap().parse().unwrap();
    let cases = table["case"].as_array().unwrap();
    let mut codes = Vec::new();
    for case in cases {
        let case = case.as_table().unwrap();
        run(case, table["studies"].as_table().unwrap());
        codes.push(case["exit_code"].as_integer().unwrap());
    }
    codes.sort_unstable();
    codes.dedup();
    assert_eq!(codes, [0, 1, 2, 130]);
}

fn run(case: &Table, studies: &Table) {
    let name = case["name"].as_str().unwrap();
    let stdout = match case.get("stdout") {
        // Only Linux has a device that is always full.
        Some(_) if !cfg!(target_os = "linux") => return,
        Some(path) => File::options().write(true).open(path.as_str().unwrap()).unwrap().into(),
        None => Stdio::null(),
    };
    let dir = tempfile::tempdir().unwrap();
    for (study, text) in studies {
        fs::write(dir.path().join(study).with_extension("toml"), text.as_str().unwrap()).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_iva"));
    command.current_dir(dir.path());
    command.args(case["arguments"].as_str().unwrap().split_whitespace());
    let output = if case.contains_key("interrupt") {
        let mut job = Job::start(&mut command);
        job.until(|| has_part(&dir.path().join("out")));
        job.send("-INT");
        job.end()
    } else {
        command.stdout(stdout).stderr(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap()
    };
    let said = String::from_utf8(output.stderr).unwrap();
    let code = output.status.code().map(i64::from);
    assert_eq!(code, case["exit_code"].as_integer(), "{name}: {said}");
    assert!(said.contains(case["says"].as_str().unwrap()), "{name}: {said}");
}

/// True if a part is being written somewhere below a folder.
fn has_part(dir: &Path) -> bool {
    fs::read_dir(dir).into_iter().flatten().flatten().any(|entry| {
        entry.file_name().to_string_lossy().starts_with("part-") || has_part(&entry.path())
    })
}
