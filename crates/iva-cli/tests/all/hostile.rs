//! Output folders with hostile contents: nothing outside them is touched.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

const STUDY: &str = "version = 1\n[absorber]\nkind = \"siva\"\nmass_ratio = 0.1\nrestitution = 0.5\n\
    [start]\ndisplacement = 1.0\n[run]\nperiods = 2\ntables = [\"summary\"]\n[sweep]\n\
    relative_clearance = [0.3, 0.6, 0.9]\n";
/// The text that marks the hidden folders of iva.
const MARK: &str = "Made by iva-dynamics for unfinished files; iva removes it.\n";

/// A temporary home with a hostile folder, `home/hostile`; everything else in it must stay untouched.
struct Home(tempfile::TempDir);

impl Home {
    fn new() -> Self {
        let home = Self(tempfile::tempdir().unwrap());
        fs::create_dir_all(home.path("precious/folder")).unwrap();
        fs::write(home.path("precious/folder/file.txt"), "mine").unwrap();
        fs::write(home.path("victim.txt"), "mine").unwrap();
        fs::write(home.path("my.toml"), STUDY).unwrap();
        fs::create_dir(home.out()).unwrap();
        home
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn out(&self) -> PathBuf {
        self.path("hostile")
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.out().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn link(&self, to: &str, name: &str) {
        let path = self.out().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        symlink(self.path(to), path).unwrap();
    }

    /// Runs a command; returns its exit code and its standard error.
    fn iva(&self, command: &[&str]) -> (Option<i32>, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_iva"))
            .current_dir(self.0.path())
            .args(command)
            .args(["my.toml", "--out", "hostile", "--quiet"])
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    }

    fn sweep(&self, more: &[&str]) -> (Option<i32>, String) {
        self.iva(&[&["sweep"][..], more].concat())
    }

    /// A home with a complete result in the hostile folder, and the manifest of that result.
    fn with_result() -> (Self, Value) {
        let home = Self::new();
        assert_eq!(home.sweep(&[]).0, Some(0));
        let text = fs::read_to_string(home.out().join("manifest.json")).unwrap();
        (home, serde_json::from_str(&text).unwrap())
    }
}

/// Names, kinds and contents of everything outside the hostile folder.
fn outside(home: &Home) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![home.0.path().to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path == home.out() {
                continue;
            }
            let kind = fs::symlink_metadata(&path).unwrap();
            if kind.is_dir() {
                found.insert(path.clone(), "a folder".to_owned());
                folders.push(path);
            } else {
                let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
                found.insert(path, text);
            }
        }
    }
    found
}

/// The text of a manifest as the program writes it.
pub fn text(manifest: &Value) -> String {
    // The first key marks the file as a manifest.
    let mut rest = manifest.as_object().unwrap().clone();
    let version = rest.remove("manifest").unwrap();
    let rest = serde_json::to_string(&rest).unwrap();
    format!("{{\n  \"manifest\": {version},{}", &rest[1..])
}

/// Runs every command that writes into a folder; none may touch anything outside it.
fn attack(home: &Home, told: &str) {
    let before = outside(home);
    for more in [&[][..], &["--resume"], &["--overwrite", "--resume"], &["--overwrite"]] {
        let (code, said) = home.sweep(more);
        assert!(matches!(code, Some(0..=2)), "{told} {more:?}: {code:?}, {said}");
        assert!(said.lines().count() <= 2 && !said.contains("panicked"), "{told} {more:?}: {said}");
        assert!(outside(home) == before, "{told} {more:?}: {:?}", outside(home));
    }
}

#[test]
fn hidden_folders_that_are_links_are_refused() {
    for hidden in [".iva-work", ".iva-new"] {
        let home = Home::new();
        home.link("precious", hidden);
        attack(&home, hidden);
        let (code, said) = home.sweep(&[]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(&format!("hostile/{hidden} is a symbolic link")), "{said}");
    }
}

#[test]
fn unfinished_files_that_are_links_are_replaced_not_written_through() {
    for name in ["study.toml", "manifest.json", "input", "part-of-0-0", "result", "lock"] {
        let home = Home::new();
        if name != "lock" {
            home.write(".iva-work/lock", MARK);
        }
        home.link("victim.txt", &format!(".iva-work/{name}"));
        attack(&home, name);
    }
}

#[test]
fn hidden_folders_without_the_mark_are_refused() {
    for hidden in [".iva-work", ".iva-new"] {
        let home = Home::new();
        home.write(&format!("{hidden}/part-of-0-0/thesis.tex"), "mine");
        let (code, said) = home.sweep(&[]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(&format!("hostile/{hidden} was not made by iva")), "{said}");
        attack(&home, hidden);
        let thesis = home.out().join(hidden).join("part-of-0-0/thesis.tex");
        assert_eq!(fs::read_to_string(thesis).unwrap(), "mine");
    }
}

#[test]
fn inputs_of_a_manifest_lead_nowhere_else() {
    let (source, manifest) = Home::with_result();
    for input in [
        "inputs/../../victim.txt",
        "inputs/../../../.config/autostart/x.desktop",
        "../victim.txt",
        "/etc/passwd",
        "inputs/./points.parquet",
        "inputs/record-0.csv/../../../victim.txt",
        "inputs",
        "",
        "study.toml",
        "inputs/notes.txt",
        "inputs/record--1.csv",
        "inputs/record-99999999999999999999.csv",
    ] {
        let mut hostile = manifest.clone();
        hostile["inputs"] = json!([input]);
        // The manifest's own place, and those where an overwrite or an exchange of tables looks for it.
        for place in ["manifest.json", ".iva-new/manifest.json", ".iva-new/earlier/manifest.json"] {
            let home = Home::new();
            copy(&source.out(), &home.out());
            home.write(".iva-new/lock", MARK);
            home.write(place, &text(&hostile));
            home.write("inputs/x.desktop", "enemy");
            attack(&home, &format!("{input:?} in {place}"));
        }
    }
}

#[test]
fn journals_lead_nowhere_else() {
    let (source, _) = Home::with_result();
    for name in ["../victim.txt", "inputs/../../victim.txt", "/etc/passwd", "summary", "", "."] {
        for (out, into) in [(vec![name], vec![]), (vec![], vec![name]), (vec![name], vec![name])] {
            let home = Home::new();
            copy(&source.out(), &home.out());
            home.write(".iva-new/lock", MARK);
            let journal = json!({ "exchange": 1, "out": out, "in": into });
            home.write(".iva-new/exchange.json", &journal.to_string());
            home.write(".iva-new/victim.txt", "enemy");
            attack(&home, &journal.to_string());
            let (code, said) = home.sweep(&["--overwrite"]);
            assert_eq!(code, Some(2), "{said}");
            assert!(said.contains("exchange.json is no list of files of a result"), "{said}");
        }
    }
}

#[test]
fn journals_of_another_layout_are_refused() {
    let (home, _) = Home::with_result();
    let study = fs::read(home.out().join("study.toml")).unwrap();
    home.write(".iva-new/lock", MARK);
    home.write(".iva-new/exchange.json", r#"{"exchange": 2, "out": ["study.toml"], "in": []}"#);
    let (code, said) = home.sweep(&["--overwrite"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("exchange.json is no list of files of a result"), "{said}");
    assert_eq!(fs::read(home.out().join("study.toml")).unwrap(), study);
}

#[test]
fn folders_of_tables_that_are_links_are_refused() {
    for name in ["summary", "inputs", "errors", "errors/summary", "impacts"] {
        let (home, _) = Home::with_result();
        let _ = fs::rename(home.out().join(name), home.path("precious/moved"));
        home.link("precious/moved", name);
        fs::create_dir_all(home.path("precious/moved")).unwrap();
        attack(&home, name);
        let (code, said) = home.sweep(&["--resume"]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(&format!("hostile/{name} is a symbolic link")), "{said}");
    }
}

#[test]
fn files_that_are_links_are_refused_and_stay() {
    for name in
        ["study.toml", "manifest.json", "summary/part-00000.parquet", "inputs/points.parquet"]
    {
        let (home, _) = Home::with_result();
        let _ = fs::remove_file(home.out().join(name));
        home.link("victim.txt", name);
        attack(&home, name);
        for more in ["--resume", "--overwrite"] {
            let (code, said) = home.sweep(&[more]);
            assert_eq!(code, Some(2), "{name}: {said}");
        }
    }
}

#[test]
fn pipes_are_refused_at_once() {
    for name in ["study.toml", "manifest.json", "summary/part-00000.parquet", ".iva-work/lock"] {
        let (home, _) = Home::with_result();
        let path = home.out().join(name);
        let _ = fs::remove_file(&path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        for more in [&["--resume"][..], &["--overwrite"]] {
            let (code, said) = home.sweep(more);
            assert!(matches!(code, Some(1 | 2)), "{name}: {code:?} {said}");
        }
    }
}

#[test]
fn tampered_manifests_are_refused() {
    let (home, manifest) = Home::with_result();
    let path = home.out().join("manifest.json");
    let set = |pointer: &str, value: Value| {
        let mut tampered = manifest.clone();
        *tampered.pointer_mut(pointer).unwrap() = value;
        tampered
    };
    let contents = manifest["parts"]["0"]["tables"]["summary"].clone();
    let part = manifest["parts"]["0"].clone();
    let mut refused: Vec<Value> = [
        ("/manifest", vec![json!(2), json!(-1), json!(null), json!("1")]),
        (
            "/iva",
            vec![json!(7), json!("\u{1b}[31m0.1.0"), json!("0.1.0\nerror"), json!("9".repeat(99))],
        ),
        ("/study", vec![json!(""), json!("../../../victim"), json!("0x12"), json!("g".repeat(16))]),
        ("/points", vec![json!(0), json!(4), json!(-3), json!(1e300), json!(u64::MAX)]),
        ("/part_points", vec![json!(0), json!(1), json!(u64::MAX)]),
        (
            "/tables",
            vec![
                json!(["../victim"]),
                json!([]),
                json!(["summary", "summary"]),
                json!(["impacts"]),
            ],
        ),
        ("/inputs", vec![json!(["inputs/points.parquet", "inputs/points.parquet"]), json!([".."])]),
        ("/format", vec![json!("exe"), json!("../parquet")]),
        (
            "/parts",
            vec![json!({ "1": part }), json!({ "-1": part }), json!({ "../0": part }), json!([])],
        ),
        ("/parts/0/first_point", vec![json!(1), json!(u64::MAX)]),
        ("/parts/0/points", vec![json!(2), json!(u64::MAX)]),
        ("/parts/0/failed", vec![json!(4), json!(-1)]),
        ("/parts/0/tables", vec![json!({}), json!({ "../victim": contents })]),
        (
            "/parts/0/tables/summary/sha256",
            vec![json!(""), json!("../".repeat(21) + "x"), json!("Z".repeat(64))],
        ),
    ]
    .into_iter()
    .flat_map(|(pointer, values)| values.into_iter().map(move |value| (pointer, value)))
    .map(|(pointer, value)| set(pointer, value))
    .collect();
    let mut with_errors = manifest.clone();
    with_errors["parts"]["0"]["errors"] = json!({ "../../victim": contents });
    refused.push(with_errors);
    assert!(refused.len() >= 37, "{}", refused.len());
    for tampered in refused {
        fs::write(&path, text(&tampered)).unwrap();
        let before = outside(&home);
        let (code, said) = home.sweep(&["--resume"]);
        assert_eq!(code, Some(2), "{tampered}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{tampered}: {said}");
        assert!(!said.contains('\u{1b}'), "{tampered}: {said:?}");
        assert!(outside(&home) == before, "{tampered}");
    }
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let target = to.join(entry.file_name().unwrap());
        if entry.is_dir() {
            fs::create_dir_all(&target).unwrap();
            copy(&entry, &target);
        } else {
            fs::copy(entry, target).unwrap();
        }
    }
}
