//! Signals to the native program: it ends soon with exit code 130, keeps what is finished, and leaves
//! nothing half-written.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Writes a study of 10⁶ points into a folder; `periods` is the length of each run.
fn study(dir: &Path, periods: f64) -> PathBuf {
    let path = dir.join("long.toml");
    let text = format!(
        "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
         restitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\nperiods = {periods}\n\
         tables = [\"summary\"]\n[sweep]\n\
         relative_clearance = {{ start = 0.3, stop = 1.2, count = 400 }}\n\
         mass_ratio = {{ start = 0.05, stop = 0.2, count = 2500 }}\n"
    );
    fs::write(&path, text).unwrap();
    path
}

fn start(dir: &Path, study: &Path, more: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_iva"))
        .current_dir(dir)
        .args(["sweep", "--out", "out"])
        .args(more)
        .arg(study)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Sends a signal and waits for the end; returns the output and the time from signal to end.
fn interrupt(child: Child, signal: &str) -> (Output, Duration) {
    let sent = Instant::now();
    let kill = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    (output, sent.elapsed())
}

fn wait_for(what: impl Fn() -> bool) {
    let start = Instant::now();
    while !what() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing happened for a minute");
        sleep(Duration::from_millis(10));
    }
}

/// Paths of the files below a folder, relative to it, with hidden ones.
fn files(dir: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(dir).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|file| {
                entry.file_name().into_string().map(|name| Path::new(&name).join(file)).unwrap()
            }));
        } else {
            found.push(PathBuf::from(entry.file_name()));
        }
    }
    found.sort();
    found
}

/// The number of staged parts of a sweep under way.
fn staged(dir: &Path) -> usize {
    files(&dir.join("out"))
        .iter()
        .filter(|file| file.extension().is_some_and(|end| end == "parquet"))
        .count()
}

#[test]
fn a_sweep_interrupted_in_its_first_part_writes_nothing() {
    for signal in ["-INT", "-TERM"] {
        let dir = tempfile::tempdir().unwrap();
        let child = start(dir.path(), &study(dir.path(), 6000.0), &[]);
        wait_for(|| staged(dir.path()) >= 1);
        let (output, time) = interrupt(child, signal);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{said}");
        // The program promises one second; a busy machine may take longer.
        assert!(time < Duration::from_secs(5), "{time:?}");
        assert!(said.contains("interrupted: nothing was finished"), "{said}");
        assert!(!dir.path().join("out").exists());
    }
}

/// The number of complete parts of the summary table.
fn complete(dir: &Path) -> usize {
    fs::read_dir(dir.join("summary")).into_iter().flatten().count()
}

#[test]
fn finished_parts_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let child = start(dir.path(), &study(dir.path(), 20.0), &[]);
    wait_for(|| complete(&out) >= 2);
    let (output, time) = interrupt(child, "-INT");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(time < Duration::from_secs(5), "{time:?}");
    let parts = complete(&out);
    assert!(parts >= 2);
    let written = files(&out);
    assert_eq!(written.len(), parts + 2, "{written:?}");
    for name in ["study.toml", "manifest.json"] {
        assert!(written.contains(&PathBuf::from(name)), "{written:?}");
    }
    let kept = "of 1000000 points are written to out; go on with --resume";
    assert!(said.contains(kept), "{said}");
}

#[test]
fn earlier_tables_survive_an_interrupted_overwrite() {
    let dir = tempfile::tempdir().unwrap();
    let small = dir.path().join("small.toml");
    let text = fs::read_to_string(study(dir.path(), 20.0)).unwrap();
    fs::write(&small, text.replace("400 }", "4 }").replace("2500 }", "2 }")).unwrap();
    assert!(start(dir.path(), &small, &[]).wait().unwrap().success());
    let table = dir.path().join("out/summary/part-00000.parquet");
    let before = fs::read(&table).unwrap();
    let child = start(dir.path(), &study(dir.path(), 20.0), &["--overwrite"]);
    let new = dir.path().join("out/.iva-new");
    wait_for(|| complete(&new) >= 2);
    let (output, _) = interrupt(child, "-INT");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("the earlier tables in out are as they were"), "{said}");
    assert!(said.contains("go on with --overwrite --resume"), "{said}");
    assert_eq!(fs::read(&table).unwrap(), before);
    let kept = complete(&new);
    assert!(kept >= 2);
    let again = start(dir.path(), &study(dir.path(), 20.0), &["--overwrite", "--resume"]);
    assert!(again.wait_with_output().unwrap().status.success());
    assert_ne!(fs::read(&table).unwrap(), before);
    assert!(!new.exists());
    assert_eq!(files(&dir.path().join("out")).len(), complete(&dir.path().join("out")) + 2);
}

#[test]
fn an_interrupt_while_points_are_checked_is_heard() {
    // A thousand million points take half a minute to check.
    let dir = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(study(dir.path(), 20.0)).unwrap();
    let huge = dir.path().join("huge.toml");
    fs::write(&huge, text.replace("400 }", "400000 }")).unwrap();
    let child = start(dir.path(), &huge, &[]);
    sleep(Duration::from_secs(1));
    assert!(!dir.path().join("out/manifest.json").exists(), "the check was over too soon");
    let (output, time) = interrupt(child, "-INT");
    assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(time < Duration::from_secs(5), "{time:?}");
    assert!(!dir.path().join("out").exists());
}
