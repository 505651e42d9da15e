//! Runs whose files cannot grow, as on a full disk: one clear message, exit code 1, nothing half-written.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::process::Command;

const STUDY: &str = "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
    mass_ratio = 0.1\nrestitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\nperiods = 20\n[sweep]\n\
    relative_clearance = { start = 0.1, stop = 1.2, count = 5000 }\n";

#[test]
fn a_disk_that_fills_up_is_told_and_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("my.toml"), STUDY).unwrap();
    // Files of at most 64 blocks: the impacts of 5000 points need some megabytes.
    let script = "trap '' XFSZ; ulimit -f 64; exec \"$0\" sweep my.toml";
    let output = Command::new("sh")
        .current_dir(dir.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_iva")])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: cannot write "), "{said}");
    assert!(said.contains(".parquet: File too large"), "{said}");
    assert!(said.contains("nothing was finished, so nothing was written"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(!dir.path().join("results").exists());
}

#[test]
fn a_report_that_cannot_be_printed_is_a_fault_but_the_tables_are_there() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("my.toml"), STUDY.replace("5000", "5")).unwrap();
    let full = fs::OpenOptions::new().write(true).open("/dev/full");
    let Ok(full) = full else {
        // Only Linux has a device that is always full.
        return;
    };
    let output = Command::new(env!("CARGO_BIN_EXE_iva"))
        .current_dir(dir.path())
        .args(["sweep", "my.toml"])
        .stdout(full)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot print the report"), "{said}");
    assert!(dir.path().join("results/my/summary/part-00000.parquet").exists());
}
