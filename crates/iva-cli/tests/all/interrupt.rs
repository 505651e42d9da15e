//! Signals to the native program: it ends with exit code 130, keeps what is finished, and leaves nothing
//! half-written. The sweeps would take hours: they end because of the signal.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::Job;

/// Writes a study into a folder: a million points, which would take an hour, in parts of a tenth of a second.
fn study(dir: &Path) -> PathBuf {
    let path = dir.join("long.toml");
    let text = "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
         restitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\nperiods = 20000\nerrors = true\n\
         tables = [\"summary\"]\n[sweep]\n\
         relative_clearance = { start = 0.3, stop = 1.2, count = 400 }\n\
         mass_ratio = { start = 0.05, stop = 0.2, count = 2500 }\n";
    fs::write(&path, text).unwrap();
    path
}

/// Writes a study with a change into a folder.
fn changed(dir: &Path, name: &str, changes: &[(&str, &str)]) -> PathBuf {
    let mut text = fs::read_to_string(study(dir)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = dir.join(name);
    fs::write(&path, text).unwrap();
    path
}

fn start(dir: &Path, study: &Path, more: &[&str]) -> Job {
    let mut command = Command::new(env!("CARGO_BIN_EXE_iva"));
    command.current_dir(dir).args(["sweep", "--out", "out"]).args(more).arg(study);
    Job::start(&mut command)
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
        // The last run never ends, so that the part is not finished before the signal, however late that comes. The
        // trial that finds the size of a part takes the 16 others.
        let endless = [
            ("damping_ratio = 0.01", "damping_ratio = 0.0"),
            ("restitution = 0.5", "restitution = 1.0\nmass_ratio = 0.1\nrelative_clearance = 0.5"),
            ("periods = 20000", "max_impacts = 9e15\nmax_work = 9e15"),
            ("relative_clearance = { start = 0.3, stop = 1.2, count = 400 }\n", ""),
            (
                "mass_ratio = { start = 0.05, stop = 0.2, count = 2500 }",
                "periods = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 1e15]",
            ),
        ];
        let mut job = start(dir.path(), &changed(dir.path(), "endless.toml", &endless), &[]);
        job.until(|| staged(dir.path()) >= 1);
        let said = job.interrupt(signal);
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
    let mut job = start(dir.path(), &study(dir.path()), &[]);
    job.until(|| complete(&out) >= 2);
    let said = job.interrupt("-INT");
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

/// That the new tables replace the earlier ones once they are complete is a test of `resume`.
#[test]
fn earlier_tables_survive_an_interrupted_overwrite() {
    let dir = tempfile::tempdir().unwrap();
    let few = [("400 }", "4 }"), ("2500 }", "2 }"), ("periods = 20000", "periods = 20")];
    let small = changed(dir.path(), "small.toml", &few);
    assert!(start(dir.path(), &small, &[]).end().status.success());
    let out = dir.path().join("out");
    let tables = |name: &str| fs::read(out.join(name).join("summary/part-00000.parquet")).unwrap();
    let earlier = tables("");
    let new = out.join(".iva-new");
    let mut kept = 0;
    let mut first = None;
    for more in [&["--overwrite"][..], &["--overwrite", "--resume"]] {
        let mut job = start(dir.path(), &study(dir.path()), more);
        job.until(|| complete(&new) >= kept + 2);
        let said = job.interrupt("-INT");
        assert!(said.contains("the earlier tables in out are as they were"), "{said}");
        assert!(said.contains("go on with --overwrite --resume"), "{said}");
        assert_eq!(tables(""), earlier);
        // It has gone on with the parts that were kept.
        assert!(complete(&new) >= kept + 2);
        kept = complete(&new);
        assert!(*first.get_or_insert_with(|| tables(".iva-new")) == tables(".iva-new"));
    }
}

#[test]
fn an_interrupt_while_points_are_checked_is_heard() {
    // As many points as a study may have, or nearly so, take minutes to check.
    let dir = tempfile::tempdir().unwrap();
    let huge = changed(dir.path(), "huge.toml", &[("400 }", "1700000 }")]);
    let mut job = start(dir.path(), &huge, &[]);
    // The folder is locked just before, and gets a manifest after it.
    job.until(|| dir.path().join("out/.iva-work/lock").exists());
    assert!(!dir.path().join("out/manifest.json").exists(), "the check was over too soon");
    let said = job.interrupt("-INT");
    assert!(said.contains("interrupted: nothing was finished"), "{said}");
    assert!(!dir.path().join("out").exists());
}
