//! Resumed sweeps after ends of every kind: the files are those of an uninterrupted sweep.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::hostile::text as manifest_text;
use crate::process::Job;

/// What the native program heeds: the number of the system call before which it aborts.
const ABORT_AT: &str = "IVA_ABORT_AT";

/// A study of 10⁶ points in some ten parts.
const MILLION: &str = "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
    restitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\nperiods = 20\n\
    tables = [\"summary\"]\n[sweep]\n\
    relative_clearance = { start = 0.3, stop = 1.2, count = 400 }\n\
    mass_ratio = { start = 0.05, stop = 0.2, count = 2500 }\n";

/// A study of 1600 points in 7 parts of a twentieth of a second. The size of a part follows from the work of its
/// points, and for runs with errors that is taken for ten times of what it is.
const SMALL_PARTS: &str = "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
    restitution = 0.5\n[start]\ndisplacement = 1.0\n[run]\nperiods = 6000\nerrors = true\n\
    tables = [\"summary\"]\n[sweep]\n\
    relative_clearance = { start = 0.3, stop = 1.2, count = 400 }\n\
    mass_ratio = { start = 0.05, stop = 0.2, count = 4 }\n";

/// A study of a million points in such parts, which would take an hour.
fn endless() -> String {
    SMALL_PARTS
        .replace("periods = 6000", "periods = 20000")
        .replace("count = 4 }", "count = 2500 }")
}

/// The text that marks the hidden folders of iva.
const MARK: &str = "Made by iva-dynamics for unfinished files; iva removes it.\n";

struct Place(tempfile::TempDir);

impl Place {
    fn new(study: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write(study);
        place
    }

    fn write(&self, study: &str) {
        fs::write(self.0.path().join("my.toml"), study).unwrap();
    }

    fn out(&self) -> PathBuf {
        self.0.path().join("out")
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_iva"));
        command.current_dir(self.0.path()).args(["sweep", "my.toml", "--out", "out"]).args(more);
        command
    }

    fn start(&self, more: &[&str]) -> Job {
        Job::start(&mut self.command(more))
    }

    fn sweep(&self, more: &[&str]) -> Output {
        self.command(more).output().unwrap()
    }

    fn succeed(&self, more: &[&str]) -> String {
        let output = self.sweep(more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        said
    }

    /// Runs the sweep again, which must be refused and change no file; returns its message.
    fn refused(&self, more: &[&str]) -> String {
        let before = files(&self.out());
        let output = self.sweep(more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        assert!(files(&self.out()) == before, "something was touched");
        said
    }
}

/// Every file below a folder with its bytes.
fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            match entry.path() {
                path if path.is_dir() => folders.push(path),
                path => {
                    let name = path.strip_prefix(dir).unwrap().to_owned();
                    found.insert(name, fs::read(path).unwrap());
                }
            }
        }
    }
    found
}

/// Writes files into a folder.
fn put(dir: &Path, files: &BTreeMap<PathBuf, Vec<u8>>) {
    for (name, bytes) in files {
        fs::create_dir_all(dir.join(name).parent().unwrap()).unwrap();
        fs::write(dir.join(name), bytes).unwrap();
    }
}

fn parts(dir: &Path) -> usize {
    fs::read_dir(dir.join("summary")).into_iter().flatten().count()
}

/// Aborts a sweep at its calls of the system, one after the other, and resumes it each time: at every seventh call, or
/// at every call if `EVERY_FAULT` is set. With `earlier` it replaces tables.
fn aborted(earlier: bool) {
    let step = if std::env::var_os("EVERY_FAULT").is_some() { 1 } else { 7 };
    let more: &[&str] = if earlier { &["--overwrite", "--resume"] } else { &["--resume"] };
    // Two whole parts and one of few points.
    let study =
        SMALL_PARTS.replace("count = 400 }", "count = 260 }").replace("count = 4 }", "count = 2 }");
    let whole = Place::new(&study);
    whole.succeed(&["--quiet"]);
    let expected = files(&whole.out());
    assert_eq!(parts(&whole.out()), 3);
    let mut before = BTreeMap::new();
    if earlier {
        let other = Place::new(&small(21));
        other.succeed(&["--quiet"]);
        before = files(&other.out());
    }
    let mut aborts = 0;
    for at in (1_u32..).step_by(step) {
        let place = Place::new(&study);
        put(&place.out(), &before);
        let mut command = place.command(more);
        let output = Job::start(command.env(ABORT_AT, at.to_string())).end();
        if output.status.success() {
            break;
        }
        // SIGABRT is 6 everywhere.
        assert_eq!(output.status.signal(), Some(6), "{output:?}");
        aborts += 1;
        // Until the exchange begins the earlier tables are as they were.
        let (found, manifest) = (files(&place.out()), Path::new("manifest.json"));
        let exchange = place.out().join(".iva-new/exchange.json").exists()
            || found.get(manifest) == expected.get(manifest);
        let is_kept = |(name, bytes)| found.get(name) == Some(bytes);
        assert!(exchange || before.iter().all(is_kept), "call {at}: {:?}", found.keys());
        // What the manifest lists is there and whole.
        let said = place.succeed(more);
        assert!(!said.contains("is not what was written"), "call {at}: {said}");
        let found = files(&place.out());
        assert!(found.keys().eq(expected.keys()), "call {at}: {:?}", found.keys());
        assert!(found == expected, "call {at}: the same names, other bytes");
    }
    println!("{aborts} aborts");
    assert!(aborts > 100 / step, "{aborts}");
}

#[test]
fn aborted_at_any_step_a_sweep_that_is_resumed_gives_the_same_files() {
    aborted(false);
}

#[test]
fn aborted_at_any_step_a_sweep_that_replaces_tables_gives_the_same_files() {
    aborted(true);
}

#[test]
fn a_part_that_was_cut_off_altered_or_removed_is_found_and_computed_again() {
    for format in ["parquet", "csv"] {
        let place = Place::new(SMALL_PARTS);
        let format_args = ["--format", format];
        place.succeed(&[&["--quiet"][..], &format_args].concat());
        let expected = files(&place.out());
        let part = |number: usize| place.out().join(format!("summary/part-{number:05}.{format}"));
        let bytes = fs::read(part(0)).unwrap();
        fs::write(part(0), &bytes[..bytes.len() / 2]).unwrap();
        let mut bytes = fs::read(part(2)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(part(2), bytes).unwrap();
        fs::remove_file(part(3)).unwrap();
        let said = place.succeed(&[&["--resume"][..], &format_args].concat());
        for number in [0, 2, 3] {
            let name = format!("summary/part-{number:05}.{format} is not what was written");
            assert!(said.contains(&name), "{said}");
        }
        assert!(!said.contains("part-00001"), "{said}");
        assert!(files(&place.out()) == expected, "{format}");
    }
}

#[test]
fn best_points_are_those_of_all_parts() {
    // A part of two batches of rows, and a smaller one.
    let short = SMALL_PARTS.replace("periods = 6000", "periods = 3").replace("4 }", "90 }");
    let place = Place::new(&short);
    let whole = String::from_utf8(place.sweep(&[]).stdout).unwrap();
    for format in ["parquet", "arrow", "csv"] {
        let format_args = ["--overwrite", "--format", format];
        place.succeed(&[&["--quiet"][..], &format_args].concat());
        fs::remove_file(place.out().join(format!("summary/part-00001.{format}"))).unwrap();
        let output = place.sweep(&["--resume", "--format", format]);
        let resumed = String::from_utf8(output.stdout).unwrap();
        let table = |text: &str| text.split("\nWritten to").next().unwrap().to_owned();
        assert!(whole.starts_with("Best 10 of 36000 points"), "{whole}");
        assert_eq!(table(&resumed), table(&whole));
    }
}

#[test]
fn a_sweep_that_cannot_write_keeps_its_parts_and_goes_on() {
    // Gaps that are not crossed first, then more and more impacts: files of the first parts have at most 31 kB, those
    // of the others some hundred.
    let study = SMALL_PARTS
        .replace("start = 0.3, stop = 1.2", "start = 6.0, stop = 0.1")
        .replace("[\"summary\"]", "[\"summary\", \"impacts\"]");
    let whole = Place::new(&study);
    whole.succeed(&["--quiet"]);
    let expected = files(&whole.out());
    let place = Place::new(&study);
    // Files of at most 64 blocks, of 512 bytes or twice as many: every longer write fails, as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 64; exec \"$0\" sweep my.toml --out out --quiet";
    let mut command = Command::new("sh");
    command.current_dir(place.0.path()).args(["-c", script, env!("CARGO_BIN_EXE_iva")]);
    let output = Job::start(&mut command).end();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("File too large"), "{said}");
    assert!(said.contains("points are written to out; go on with --resume"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    let kept = files(&place.out());
    assert!(kept.keys().all(|name| !name.starts_with(".iva-work")), "{:?}", kept.keys());
    let is_part = |name: &&PathBuf| name.starts_with("summary") || name.starts_with("impacts");
    for name in kept.keys().filter(is_part) {
        assert!(kept[name] == expected[name], "{name:?}");
    }
    assert!(parts(&place.out()) >= 2, "{:?}", kept.keys());
    place.succeed(&["--quiet", "--resume"]);
    assert!(files(&place.out()) == expected);
}

fn small(periods: u32) -> String {
    MILLION
        .replace("400 }", "4 }")
        .replace("2500 }", "5 }")
        .replace("periods = 20", &format!("periods = {periods}"))
}

#[test]
fn another_sweep_is_refused_with_what_changed() {
    let place = Place::new(&small(20));
    place.succeed(&["--quiet"]);
    place.write(&small(21));
    let said = place.refused(&["--resume"]);
    assert!(said.contains("out holds another sweep: run.periods was 20.0, is 21.0;"), "{said}");
    assert!(said.contains("--overwrite without --resume"), "{said}");
    place.write(&small(20));
    let said = place.refused(&["--resume", "--tables", "summary,impacts"]);
    assert!(said.contains("the list of tables was summary, is summary, impacts"), "{said}");
    let said = place.refused(&["--resume", "--format", "csv"]);
    assert!(said.contains("the format was parquet, is csv"), "{said}");
    let said = place.refused(&[]);
    assert!(!said.contains("--resume"), "it is complete: {said}");
    // A change of the report, which is only printed, does not prevent resuming.
    place.write(&format!("{}[report]\ncount = 3\n", small(20)));
    place.succeed(&["--resume"]);
    let manifest = place.out().join("manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    let version = format!("\"iva\": \"{}\"", env!("CARGO_PKG_VERSION"));
    fs::write(&manifest, text.replace(&version, "\"iva\": \"0.0.1\"")).unwrap();
    let said = place.refused(&["--resume"]);
    assert!(said.contains("the version of iva-dynamics was 0.0.1"), "{said}");
}

#[test]
fn a_folder_of_which_nothing_is_known_begins_or_is_refused() {
    let place = Place::new(&small(20));
    // No folder at all.
    place.succeed(&["--quiet", "--resume"]);
    let expected = files(&place.out());
    // Without a manifest, with tables of the same study.
    fs::remove_file(place.out().join("manifest.json")).unwrap();
    place.succeed(&["--quiet", "--resume"]);
    assert!(files(&place.out()) == expected);
    // Without a manifest, with tables of another one.
    fs::remove_file(place.out().join("manifest.json")).unwrap();
    place.write(&small(21));
    let said = place.refused(&["--resume"]);
    assert!(said.contains("holds tables of another study and no manifest.json"), "{said}");
    // With a part in place whose process was killed before it entered the first one in the manifest.
    place.write(&small(20));
    let text = String::from_utf8(expected[Path::new("manifest.json")].clone()).unwrap();
    let mut manifest: Value = serde_json::from_str(&text).unwrap();
    manifest["parts"] = serde_json::json!({});
    fs::write(place.out().join("manifest.json"), manifest_text(&manifest)).unwrap();
    place.succeed(&["--quiet", "--resume"]);
    assert!(files(&place.out()) == expected);
    place.write(&small(21));
    // Unfinished files alone.
    fs::remove_dir_all(place.out()).unwrap();
    fs::create_dir_all(place.out().join(".iva-work/part-abc")).unwrap();
    fs::write(place.out().join(".iva-work/lock"), MARK).unwrap();
    fs::write(place.out().join(".iva-work/part-abc/summary.parquet"), "half").unwrap();
    place.succeed(&["--quiet", "--resume"]);
    assert_eq!(files(&place.out()).len(), 3);
    // Files in place of the manifest that are no valid manifest.
    let whole = fs::read_to_string(place.out().join("manifest.json")).unwrap();
    for (text, said) in [
        ("{\n  \"manifest\": 1", "it is no manifest of a result"),
        ("{\n  \"manifest\": 99}", "it is no manifest of a result"),
        (
            &whole.replace("\"manifest\": 1", "\"manifest\": 2"),
            "it has layout 2, this version of iva reads 1",
        ),
        (&whole.replace("\"summary\": {", "\"impacts\": {"), "its parts do not fit"),
        ("mine", "manifest.json is no manifest of a result and would be replaced"),
    ] {
        fs::write(place.out().join("manifest.json"), text).unwrap();
        let refused = place.refused(&["--resume"]);
        assert!(refused.contains(said), "{refused}");
    }
}

#[test]
fn two_sweeps_never_write_into_one_folder() {
    let place = Place::new(&endless());
    let mut first = place.start(&["--quiet"]);
    first.until(|| parts(&place.out()) >= 1);
    for option in ["--resume", "--overwrite"] {
        let output = place.sweep(&[option]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("another process is writing into out"), "{said}");
    }
    // The first goes on as if nothing had been.
    let before = parts(&place.out());
    first.until(|| parts(&place.out()) >= before + 2);
    let said = first.interrupt("-INT");
    assert!(said.contains("points are written to out; go on with --resume"), "{said}");
    assert_eq!(files(&place.out()).len(), parts(&place.out()) + 2);
}

/// Makes the first part so long that its check takes minutes: of zeros, which take no room on the disk.
fn lengthen(place: &Place) {
    let long = 1_u64 << 40;
    let part = place.out().join("summary/part-00000.parquet");
    fs::OpenOptions::new().write(true).open(&part).unwrap().set_len(long).unwrap();
    let path = place.out().join("manifest.json");
    let text = fs::read_to_string(&path).unwrap();
    let bytes = |text: &str| -> u64 {
        let manifest: Value = serde_json::from_str(text).unwrap();
        manifest["parts"]["0"]["tables"]["summary"]["bytes"].as_u64().unwrap()
    };
    let changed =
        text.replacen(&format!("\"bytes\": {}", bytes(&text)), &format!("\"bytes\": {long}"), 1);
    assert_eq!(bytes(&changed), long);
    fs::write(&path, changed).unwrap();
}

#[test]
fn an_interrupt_while_parts_are_checked_changes_nothing() {
    let place = Place::new(SMALL_PARTS);
    place.succeed(&["--quiet"]);
    lengthen(&place);
    let part = place.out().join("summary/part-00000.parquet");
    // It is moved away to see the others: to read it would take minutes too.
    let others = || {
        let aside = place.0.path().join("long");
        fs::rename(&part, &aside).unwrap();
        let found = (files(&place.out()), fs::metadata(&aside).unwrap().len());
        fs::rename(&aside, &part).unwrap();
        found
    };
    let before = others();
    let mut job = place.start(&["--quiet", "--resume"]);
    // The folder is locked just before.
    job.until(|| place.out().join(".iva-work/lock").exists());
    let said = job.interrupt("-INT");
    assert!(said.contains("points are written to out; go on with --resume"), "{said}");
    assert!(others() == before, "{:?}", others().0.keys());
}

#[test]
fn an_exchange_that_was_killed_is_ended_by_the_next_process() {
    let place = Place::new(&small(20));
    place.succeed(&["--quiet", "--tables", "summary,impacts"]);
    let old = files(&place.out());
    let other = Place::new(&small(21));
    other.succeed(&["--quiet"]);
    let new = files(&other.out());
    // The manifest is the last to go and the first to come.
    let order = |files: &BTreeMap<PathBuf, Vec<u8>>, comes: bool| {
        let mut names: Vec<PathBuf> = files.keys().cloned().collect();
        names.sort_by_key(|name| (name == Path::new("manifest.json")) != comes);
        names
    };
    let (out, into) = (order(&old, false), order(&new, true));
    let journal = serde_json::json!({ "exchange": 1, "out": out, "in": into }).to_string();
    let moves = out.len() + into.len();
    for done in 0..=moves {
        fs::remove_dir_all(place.out()).unwrap();
        let beside = place.out().join(".iva-new");
        let (mut here, mut gathered, mut aside) = (old.clone(), new.clone(), BTreeMap::new());
        for name in out.iter().take(done) {
            aside.insert(name.clone(), here.remove(name).unwrap());
        }
        for name in into.iter().take(done.saturating_sub(out.len())) {
            here.insert(name.clone(), gathered.remove(name).unwrap());
        }
        put(&place.out(), &here);
        put(&beside, &gathered);
        fs::create_dir_all(beside.join("earlier")).unwrap();
        put(&beside.join("earlier"), &aside);
        fs::write(beside.join("lock"), MARK).unwrap();
        fs::write(beside.join("exchange.json"), &journal).unwrap();
        place.write(&small(21));
        // The next command completes the exchange, even if it is itself refused.
        assert_eq!(place.sweep(&[]).status.code(), Some(2));
        assert!(files(&place.out()) == new, "after {done} of {moves} moves");
        place.succeed(&["--quiet", "--overwrite"]);
        assert!(files(&place.out()) == new, "after {done} of {moves} moves");
    }
}

#[test]
fn a_kept_overwrite_survives_a_study_that_is_refused() {
    let place = Place::new(&small(20));
    place.succeed(&["--quiet"]);
    place.write(&endless());
    let mut job = place.start(&["--quiet", "--overwrite"]);
    job.until(|| parts(&place.out().join(".iva-new")) >= 1);
    drop(job);
    place.write(&small(20).replace("displacement = 1.0", "displacement = 0.0"));
    assert_eq!(place.sweep(&["--overwrite"]).status.code(), Some(2));
    assert!(parts(&place.out().join(".iva-new")) >= 1);
}

/// What is not reached by waiting for something: kills and signals at random instants.
mod stress {
    use std::thread::sleep;
    use std::time::Instant;

    use super::*;

    /// Uniform numbers below 1 after Knuth's 64-bit linear congruential generator.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// Number of parts that the manifest lists. A part that was in place but not listed when its process was killed
    /// is computed again.
    fn listed(dir: &Path) -> usize {
        let Ok(text) = fs::read_to_string(dir.join("manifest.json")) else { return 0 };
        let manifest: Value = serde_json::from_str(&text).unwrap();
        manifest["parts"].as_object().unwrap().len()
    }

    #[test]
    #[ignore = "takes minutes"]
    fn killed_at_twenty_random_moments_a_sweep_of_a_million_points_gives_the_same_files() {
        let whole = Place::new(MILLION);
        let begin = Instant::now();
        whole.succeed(&["--quiet"]);
        let time = begin.elapsed();
        let expected = files(&whole.out());
        assert!(parts(&whole.out()) > 8, "{} parts", parts(&whole.out()));

        let place = Place::new(MILLION);
        let mut random = Random(20_261_122);
        let mut kept = Vec::new();
        let mut kills = 0;
        while kills < 20 {
            let job = place.start(&["--quiet", "--resume"]);
            // A random time in which a part is finished now and then, so that kills fall on every stage.
            sleep(time.mul_f64(0.25 * random.next()));
            kills += usize::from(job.kill());
            let now = listed(&place.out());
            assert!(kept.last().is_none_or(|before| now >= *before), "{kept:?}, {now}");
            kept.push(now);
            if now == expected.len() - 2 {
                fs::remove_dir_all(place.out()).unwrap();
                kept.clear();
            }
        }
        place.succeed(&["--quiet", "--resume"]);
        let found = files(&place.out());
        assert!(found.keys().eq(expected.keys()), "{:?}", found.keys());
        assert!(found == expected, "the same names, other bytes");
    }

    #[test]
    #[ignore = "takes a minute"]
    fn interrupted_at_random_moments_a_check_of_parts_changes_nothing() {
        // Files large enough (50 MB) that the signal may come while they are read.
        let place = Place::new(&MILLION.replace("2500 }", "1000 }"));
        place.succeed(&["--quiet"]);
        let expected = files(&place.out());
        let begin = Instant::now();
        place.succeed(&["--quiet", "--resume"]);
        let time = begin.elapsed();
        let mut random = Random(7);
        for _ in 0..20 {
            let job = place.start(&["--quiet", "--resume"]);
            sleep(time.mul_f64(random.next()));
            job.send("-INT");
            let status = job.end().status;
            assert!([Some(0), Some(130), None].contains(&status.code()), "{status}");
            let mut found = files(&place.out());
            found.retain(|name, _| !name.starts_with(".iva-work"));
            assert!(found == expected, "{:?}", found.keys());
        }
    }
}
