use std::collections::BTreeMap;

use super::*;
use crate::folder::is_part;
use crate::resolved::HEADER;
use crate::table_file::Format;

/// Every file below a folder with its text; hidden leftovers would show up too.
fn contents(dir: &Path) -> BTreeMap<String, String> {
    let mut files = BTreeMap::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(dir).unwrap().display().to_string();
                files.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
    }
    files
}

fn stage_all(output: &mut Output, tables: &[Table], text: &str) {
    output.stage_study(&format!("{HEADER}: {text}")).unwrap();
    for table in tables {
        let path = output.stage_table(*table).unwrap();
        fs::write(path, format!("{table} {text}")).unwrap();
    }
}

fn write_run(dir: &Path, tables: &[Table], text: &str) {
    let mut output = Output::prepare(dir, true, Style::default()).unwrap();
    stage_all(&mut output, tables, text);
    output.commit().unwrap();
}

fn refusal(result: Result<Output, Error>) -> String {
    let error = result.unwrap_err();
    assert_eq!(error.exit_code(), 2, "{error}");
    error.to_string()
}

/// Where a failed commit says that the new tables are.
fn kept(error: Error) -> PathBuf {
    let Error::NotMoved { ref kept, .. } = error else { panic!("{error}") };
    assert!(error.to_string().contains(&kept.display().to_string()), "{error}");
    kept.clone()
}

const TABLES: [Table; 2] = [Table::Summary, Table::Impacts];

#[test]
fn a_new_folder_gets_the_layout_and_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("results/deep/one");
    let mut output = Output::prepare(&dir, false, Style::default()).unwrap();
    stage_all(&mut output, &TABLES, "new");
    let before = contents(&dir);
    assert!(before.keys().all(|name| name.starts_with(STAGING_PREFIX)), "{before:?}");
    output.commit().unwrap();
    let names: Vec<String> = contents(&dir).into_keys().collect();
    assert_eq!(names, ["impacts/part-00000.parquet", "study.toml", "summary/part-00000.parquet"]);
}

#[test]
fn a_folder_with_other_files_is_accepted_and_they_are_left_alone() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    fs::write(dir.join("notes.txt"), "mine").unwrap();
    fs::create_dir(dir.join("summary")).unwrap();
    fs::write(dir.join("summary/plot.py"), "mine too").unwrap();
    for text in ["first", "second"] {
        write_run(dir, &TABLES, text);
        let found = contents(dir);
        assert_eq!(found["notes.txt"], "mine");
        assert_eq!(found["summary/plot.py"], "mine too");
        assert_eq!(found["summary/part-00000.parquet"], format!("summary {text}"));
        assert_eq!(found.len(), 5, "{found:?}");
    }
}

#[test]
fn a_folder_with_tables_needs_overwrite() {
    let root = tempfile::tempdir().unwrap();
    write_run(root.path(), &TABLES, "old");
    let before = contents(root.path());
    let message = refusal(Output::prepare(root.path(), false, Style::default()));
    assert!(message.contains("--overwrite"), "{message}");
    assert!(message.contains(&root.path().display().to_string()), "{message}");
    assert_eq!(contents(root.path()), before);
}

#[test]
fn overwriting_leaves_no_table_of_the_earlier_run() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    write_run(dir, &Table::ALL, "old");
    fs::write(dir.join("summary/part-00001.parquet"), "old").unwrap();
    write_run(dir, &TABLES, "new");
    let found = contents(dir);
    assert!(found.values().all(|text| text.ends_with("new")), "{found:?}");
    assert_eq!(found.len(), 3);
    assert!(!dir.join("envelope").exists());
}

#[test]
fn until_the_commit_the_old_tables_stay() {
    let root = tempfile::tempdir().unwrap();
    write_run(root.path(), &TABLES, "old");
    let before = contents(root.path());
    let mut output = Output::prepare(root.path(), true, Style::default()).unwrap();
    stage_all(&mut output, &Table::ALL, "new");
    // As when writing fails midway.
    drop(output);
    assert_eq!(contents(root.path()), before);
}

#[test]
fn a_commit_that_fails_midway_is_undone() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path();
    write_run(dir, &TABLES, "old");
    fs::write(dir.join("notes.txt"), "mine").unwrap();
    let before = contents(dir);
    let mut output = Output::prepare(dir, true, Style::default()).unwrap();
    stage_all(&mut output, &TABLES, "new");
    // The last staged file has vanished: the moves before it have succeeded by then.
    let vanished = output.stage_table(Table::Episodes).unwrap();
    assert!(!vanished.exists());
    let error = output.commit().unwrap_err();
    assert_eq!(error.exit_code(), 1, "{error}");
    assert!(!dir.join("episodes").exists());
    let kept = kept(error);
    assert_eq!(
        fs::read_to_string(kept.join("new/summary/part-00000.parquet")).unwrap(),
        "summary new"
    );
    fs::remove_dir_all(kept).unwrap();
    assert_eq!(contents(dir), before);
}

#[test]
fn tables_that_appear_meanwhile_are_not_replaced() {
    let root = tempfile::tempdir().unwrap();
    let mut slow = Output::prepare(root.path(), false, Style::default()).unwrap();
    stage_all(&mut slow, &TABLES, "slow");
    let message = refusal(Output::prepare(root.path(), true, Style::default()));
    assert!(message.contains("another process is writing into"), "{message}");
    // Not by this program, which would have seen the lock.
    fs::create_dir(root.path().join("summary")).unwrap();
    fs::write(root.path().join("summary/part-00000.parquet"), "summary fast").unwrap();
    let error = slow.commit().unwrap_err();
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(error.to_string().contains("--overwrite"), "{error}");
    let kept = kept(error);
    assert_eq!(contents(&kept.join("new")).len(), 3);
    fs::remove_dir_all(kept).unwrap();
    let found = contents(root.path());
    assert!(found.values().all(|text| text.ends_with("fast")), "{found:?}");
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
