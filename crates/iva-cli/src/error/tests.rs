use std::path::Path;

use iva_study::parse_study;
use iva_study::record_file::parse_record;

use super::*;

const GOOD: &str = r#"version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 60
[sweep]
relative_clearance = { start = 0.1, stop = 1.2, count = 111 }
mass_ratio = [0.05, 0.1, 0.15, 0.2]
"#;

/// The report of an error for the terminal, without colours.
fn plain(error: iva_study::Error) -> String {
    anstream::adapter::strip_str(&Error::from(error).report()).to_string()
}

fn terminal(text: &str) -> String {
    plain(parse_study(Path::new("my.toml"), text).unwrap_err())
}

#[test]
fn the_place_and_the_line_are_shown() {
    for (old, new, place) in [
        ("restitution = 0.5", "restitution = 7", "--> my.toml:7:15"),
        ("periods = 60", "periods = 0", "--> my.toml:12:11"),
        ("0.01", "0.01.2", "--> my.toml:3:21"),
        ("kind = \"siva\"", "", "--> my.toml:4:2"),
    ] {
        let text = GOOD.replacen(old, new, 1);
        let shown = terminal(&text);
        assert!(shown.contains(place), "{shown}");
        let number: usize = place.split(':').nth(1).unwrap().parse().unwrap();
        assert!(shown.contains(text.lines().nth(number - 1).unwrap()), "{shown}");
    }
    assert!(terminal("version = 1\r\nrun = [\"\r\r\r\n\r\n").contains("--> my.toml:2:"));
}

#[test]
fn the_marks_stand_under_the_text_they_are_about() {
    let text = GOOD.replace("restitution = 0.5", "\trestitution = 7 # é");
    let shown = terminal(&text);
    let lines: Vec<&str> = shown.lines().collect();
    assert!(lines[0].starts_with("error: absorber.restitution = 7: give"), "{shown}");
    let marks = lines[4].find('^').unwrap();
    assert_eq!(&lines[3][marks..=marks], "7", "{shown}");
    let values = vec!["0.25"; 100].join(", ");
    let text = GOOD.replace("[0.05, 0.1, 0.15, 0.2]", &format!("[{values}, -3]"));
    let shown = terminal(&text);
    assert!(shown.lines().skip(1).all(|line| line.chars().count() <= 80), "{shown}");
    assert!(shown.contains("-3]"), "{shown}");
}

#[test]
fn control_characters_of_a_study_do_not_reach_the_terminal() {
    let text = GOOD.replace("[run]", "[\"run\\u001b[31m\"]");
    let shown = terminal(&text);
    assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{shown:?}");
    let long = "x".repeat(5000);
    let shown = terminal(&GOOD.replace("damping_ratio", &long));
    assert!(shown.lines().skip(1).all(|line| line.chars().count() <= 80), "{shown}");
}

#[test]
fn the_place_in_a_record_is_shown() {
    let record = parse_record(Path::new("a.csv"), b"t;a\n0;1\n0,5;2\n");
    assert_eq!(
        plain(record.unwrap_err()),
        "error: \"0,5\" seems to have a decimal comma; write a decimal point: 0.5\n \
         --> a.csv:3:1\n  |\n3 | 0,5;2\n  | ^^^"
    );
}
