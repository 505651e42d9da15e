#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use super::*;

/// A folder to attack, and beside it a folder `outside` that must not be reached.
fn places() -> (tempfile::TempDir, Directory) {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir_all(root.path().join("inside/real")).unwrap();
    fs::create_dir_all(root.path().join("outside/precious")).unwrap();
    fs::write(root.path().join("outside/precious/file"), "mine").unwrap();
    fs::write(root.path().join("inside/file"), "ours").unwrap();
    let directory = Directory::open(&root.path().join("inside")).unwrap();
    (root, directory)
}

/// True if the folder `outside` and its file are unchanged.
fn is_untouched(root: &tempfile::TempDir) -> bool {
    let outside = root.path().join("outside");
    let names = |dir: &Path| fs::read_dir(dir).unwrap().count();
    fs::read_to_string(outside.join("precious/file")).unwrap() == "mine"
        && names(&outside) == 1
        && names(&outside.join("precious")) == 1
}

#[test]
fn no_name_leads_out_of_the_folder() {
    let (root, directory) = places();
    symlink("../outside", root.path().join("inside/link")).unwrap();
    symlink(root.path().join("outside"), root.path().join("inside/real/link")).unwrap();
    let absolute = root.path().join("outside/precious/file");
    for name in [
        "../outside/precious/file",
        "real/../../outside/precious/file",
        "link/precious/file",
        "real/link/precious/file",
        absolute.to_str().unwrap(),
    ] {
        let name = Path::new(name);
        assert!(directory.open_file(name).is_err(), "{name:?}");
        assert!(directory.write_new(name, b"enemy").is_err(), "{name:?}");
        assert!(directory.remove_file(name).is_err(), "{name:?}");
        assert!(directory.rename(Path::new("file"), &directory, name).is_err(), "{name:?}");
        assert!(directory.rename(name, &directory, Path::new("taken")).is_err(), "{name:?}");
        let parent = name.parent().unwrap();
        assert!(directory.remove_folder(&parent.join("x")).is_err(), "{name:?}");
        assert!(directory.make_folder(&parent.join("x")).is_err(), "{name:?}");
        assert!(is_untouched(&root), "{name:?}");
    }
}

#[test]
fn links_are_replaced_and_removed_themselves() {
    let (root, directory) = places();
    let target = root.path().join("outside/precious");
    symlink(&target, root.path().join("inside/real/folder")).unwrap();
    symlink(target.join("file"), root.path().join("inside/link")).unwrap();
    assert_eq!(directory.kind(Path::new("link")).unwrap(), Some(Kind::Link));
    let refused = directory.open_file(Path::new("link")).unwrap_err().to_string();
    assert!(refused.contains("it is a symbolic link"), "{refused}");
    directory.write_new(Path::new("new"), b"ours").unwrap();
    directory.replace(Path::new("new"), &directory, Path::new("link")).unwrap();
    assert_eq!(directory.kind(Path::new("link")).unwrap(), Some(Kind::File));
    directory.remove_folder(Path::new("real")).unwrap();
    assert_eq!(directory.kind(Path::new("real")).unwrap(), None);
    assert!(is_untouched(&root));
}

#[test]
fn a_pipe_is_not_waited_for() {
    let (root, directory) = places();
    let pipe = root.path().join("inside/pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let refused = directory.open_file(Path::new("pipe")).unwrap_err().to_string();
    assert!(refused.contains("it is not a regular file"), "{refused}");
    assert_eq!(directory.kind(Path::new("pipe")).unwrap(), Some(Kind::Other));
}

#[test]
fn a_folder_that_was_moved_or_exchanged_is_not_in_place() {
    let (root, directory) = places();
    assert!(directory.is_in_place());
    fs::rename(root.path().join("inside"), root.path().join("moved")).unwrap();
    assert!(!directory.is_in_place());
    fs::create_dir(root.path().join("inside")).unwrap();
    assert!(!directory.is_in_place());
}
