use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::Int32Array;
use arrow_schema::{DataType, Field, Schema};
use iva_sweep::columns::SCHEMA_VERSION;
use iva_sweep::design::Spec;

use super::*;
use crate::folder::{HEADER, is_part};
use crate::remedy::Words;
use crate::table_file::Format;

/// Every file below a folder with its bytes, hidden files included.
fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(dir).unwrap().display().to_string();
                files.insert(name, fs::read(path).unwrap());
            }
        }
    }
    files
}

/// A table of one number, with the metadata that marks tables of the program.
fn table(value: i32) -> (SchemaRef, RecordBatch) {
    let mark = [("iva.schema_version".to_owned(), SCHEMA_VERSION.to_string())];
    let fields = vec![Field::new("value", DataType::Int32, false)];
    let schema = Arc::new(Schema::new_with_metadata(fields, mark.into()));
    let rows = RecordBatch::try_new(schema.clone(), vec![Arc::new(Int32Array::from(vec![value]))]);
    (schema, rows.unwrap())
}

fn write_all(output: &mut Output, tables: &[Table], value: i32) {
    let (schema, rows) = table(value);
    for table in tables {
        output.write_table(*table, schema.clone(), &rows).unwrap();
    }
}

fn commit(output: Output, value: i32) -> Result<(), Error> {
    let study = Study::single(Spec::default());
    let identity = Identity::of(&study).unwrap();
    output.commit(&study, identity, &format!("{HEADER}: {value}"), 0)
}

fn write_run(dir: &Path, tables: &[Table], value: i32) {
    let mut output = Output::prepare(dir, true, Style::default()).unwrap();
    write_all(&mut output, tables, value);
    commit(output, value).unwrap();
}

/// The files that a run writes into an empty folder.
fn expected(tables: &[Table], value: i32) -> BTreeMap<String, Vec<u8>> {
    let root = tempfile::tempdir().unwrap();
    write_run(root.path(), tables, value);
    contents(root.path())
}

/// Option names of an invented front.
const WORDS: Words =
    Words { out: "as o", overwrite: "-o", resume: "-r", overwrite_and_resume: "-o -r" };

fn refusal(result: Result<Output, Error>) -> String {
    let error = result.unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    error.message(&WORDS)
}

/// The folder of the new tables in the error of a failed commit.
fn kept(error: Error) -> PathBuf {
    let Error::NotMoved { ref kept, .. } = error else { panic!("{error}") };
    assert!(error.to_string().contains(&kept.display().to_string()), "{error}");
    kept.clone()
}

const TABLES: [Table; 2] = [Table::Summary, Table::Impacts];

#[test]
fn nothing_is_there_until_the_commit() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("out");
    let mut output = Output::prepare(&dir, false, Style::default()).unwrap();
    write_all(&mut output, &TABLES, 1);
    let before: Vec<String> = contents(&dir).into_keys().collect();
    assert!(before.iter().all(|name| name.starts_with(".iva-")), "{before:?}");
    commit(output, 1).unwrap();
    let names: Vec<String> = contents(&dir).into_keys().collect();
    let parts = ["impacts/part-00000.parquet", "manifest.json", "study.toml"];
    assert_eq!(names, [&parts[..], &["summary/part-00000.parquet"]].concat());
}

#[test]
fn a_folder_with_other_files_is_accepted_and_they_are_left_alone() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    fs::write(dir.join("notes.txt"), "mine").unwrap();
    fs::create_dir(dir.join("summary")).unwrap();
    fs::write(dir.join("summary/plot.py"), "mine too").unwrap();
    for value in [1, 2] {
        write_run(dir, &TABLES, value);
        let mut found = contents(dir);
        assert_eq!(found.remove("notes.txt").unwrap(), b"mine");
        assert_eq!(found.remove("summary/plot.py").unwrap(), b"mine too");
        assert_eq!(found, expected(&TABLES, value));
    }
}

#[test]
fn a_folder_with_tables_needs_overwrite() {
    let root = tempfile::tempdir().unwrap();
    write_run(root.path(), &TABLES, 1);
    let before = contents(root.path());
    let message = refusal(Output::prepare(root.path(), false, Style::default()));
    assert!(message.ends_with("give -o to replace them"), "{message}");
    assert!(message.contains(&root.path().display().to_string()), "{message}");
    assert_eq!(contents(root.path()), before);
}

#[test]
fn overwriting_leaves_no_table_of_the_earlier_run() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    write_run(dir, &Table::ALL, 1);
    // A part that the manifest does not list is recognised by the metadata in it.
    fs::copy(dir.join("summary/part-00000.parquet"), dir.join("summary/part-00001.parquet"))
        .unwrap();
    write_run(dir, &TABLES, 2);
    assert_eq!(contents(dir), expected(&TABLES, 2));
    assert!(!dir.join("envelope").exists());
}

#[test]
fn a_file_that_only_has_the_name_of_a_part_is_not_ours() {
    for name in ["summary/part-00001.parquet", "summary/part-00000.csv", "impacts/part-00007.arrow"]
    {
        let root = tempfile::tempdir().unwrap();
        let dir = root.path();
        write_run(dir, &TABLES, 1);
        fs::write(dir.join(name), "name,value\nmine,1\n").unwrap();
        let before = contents(dir);
        let message = refusal(Output::prepare(dir, true, Style::default()));
        assert!(message.contains(&format!("{name} was not written by iva")), "{message}");
        assert_eq!(contents(dir), before);
    }
}

#[test]
fn until_the_commit_the_old_tables_stay() {
    let root = tempfile::tempdir().unwrap();
    write_run(root.path(), &TABLES, 1);
    let before = contents(root.path());
    let mut output = Output::prepare(root.path(), true, Style::default()).unwrap();
    write_all(&mut output, &Table::ALL, 2);
    // A drop without a commit is what happens when writing fails midway.
    drop(output);
    assert_eq!(contents(root.path()), before);
}

#[test]
fn a_commit_without_all_its_files_moves_none() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    write_run(dir, &TABLES, 1);
    fs::write(dir.join("notes.txt"), "mine").unwrap();
    let before = contents(dir);
    let mut output = Output::prepare(dir, true, Style::default()).unwrap();
    write_all(&mut output, &TABLES, 2);
    fs::remove_file(dir.join(".iva-work/result/impacts/part-00000.parquet")).unwrap();
    let error = commit(output, 2).unwrap_err();
    assert!(!error.is_bad_input(), "{error}");
    let kept = kept(error);
    let summary = "summary/part-00000.parquet";
    assert_eq!(fs::read(kept.join(summary)).unwrap(), expected(&TABLES, 2)[summary]);
    fs::remove_dir_all(kept).unwrap();
    assert_eq!(contents(dir), before);
}

#[test]
fn tables_that_appear_meanwhile_are_not_replaced() {
    let root = tempfile::tempdir().unwrap();
    let mut slow = Output::prepare(root.path(), false, Style::default()).unwrap();
    write_all(&mut slow, &TABLES, 1);
    let message = refusal(Output::prepare(root.path(), true, Style::default()));
    assert!(message.contains("another process is writing into"), "{message}");
    // Another program writes the tables: this one would respect the lock.
    fs::create_dir(root.path().join("summary")).unwrap();
    fs::write(root.path().join("summary/part-00000.parquet"), "fast").unwrap();
    let error = commit(slow, 1).unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    assert!(error.message(&WORDS).contains("give -o to replace them; the new tables"), "{error}");
    let kept = kept(error);
    let mut found = contents(&kept);
    found.retain(|name, _| !name.starts_with("lock"));
    assert_eq!(found, expected(&TABLES, 1));
    fs::remove_dir_all(kept).unwrap();
    let found = contents(root.path());
    assert!(found.values().all(|bytes| bytes == b"fast"), "{found:?}");
}

#[test]
fn a_study_of_the_user_is_never_replaced() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("study.toml"), "version = 1 # mine").unwrap();
    for overwrite in [false, true] {
        let message = refusal(Output::prepare(root.path(), overwrite, Style::default()));
        assert!(message.contains("study.toml was not written by iva"), "{message}");
    }
}

#[test]
fn an_unwritable_folder_is_refused_at_once() {
    let root = tempfile::tempdir().unwrap();
    let file = root.path().join("file");
    fs::write(&file, "mine").unwrap();
    let message = refusal(Output::prepare(&file.join("below"), false, Style::default()));
    assert!(message.contains("cannot write into the folder"), "{message}");
    let message = refusal(Output::prepare(&file, true, Style::default()));
    assert!(message.contains("is a file"), "{message}");
    fs::create_dir(root.path().join("dir")).unwrap();
    fs::write(root.path().join("dir/impacts"), "mine").unwrap();
    let message = refusal(Output::prepare(&root.path().join("dir"), true, Style::default()));
    assert!(message.contains("impacts is a file"), "{message}");
}

#[test]
fn folders_made_for_nothing_are_removed() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("a/b/c");
    drop(Output::prepare(&dir, false, Style::default()).unwrap());
    assert!(!root.path().join("a").exists());
}

#[test]
fn part_names_are_recognised() {
    assert_eq!(part_name(7, Format::Parquet), "part-00007.parquet");
    assert!(is_part(&part_name(65_535, Format::Csv)));
    for other in ["part-7.parquet", "part-00007.xlsx", "part-0000x.parquet", "notes.txt"] {
        assert!(!is_part(other), "{other}");
    }
}
