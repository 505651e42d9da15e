use std::path::Path;

use iva_sweep::columns::Selection;
use iva_sweep::fields::FieldId;
use iva_sweep::sampling::Sampling;
use iva_sweep::study::Table;

use super::*;
use crate::error::{Error, StudyError};

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
tables = ["impacts", "summary"]
[sweep]
relative_clearance = { start = 0.1, stop = 1.2, count = 111 }
mass_ratio = [0.05, 0.1, 0.15, 0.2]
"#;

fn parse(text: &str) -> Result<StudyFile, Error> {
    parse_study(Path::new("my.toml"), text)
}

fn good(text: &str) -> StudyFile {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn bad(text: &str) -> StudyError {
    match parse(text) {
        Err(Error::Study(error)) => *error,
        other => panic!("expected an error in the study, got {other:?}\n{text}"),
    }
}

/// The good study without its section `[sweep]`, to which tests append another.
fn without_sweep() -> &'static str {
    &GOOD[..GOOD.find("[sweep]").unwrap()]
}

#[test]
#[allow(clippy::panic)]
fn the_example_reads() {
    let file = good(GOOD);
    let study = &file.study;
    assert_eq!(study.points().unwrap(), 444);
    let Sampling::Grid(axes) = &study.sampling else { panic!("{}", study.sampling) };
    assert_eq!(axes[0].key, "relative_clearance");
    assert_eq!(axes[0].values[110], 1.2);
    assert_eq!(axes[1].values, [0.05, 0.1, 0.15, 0.2]);
    assert_eq!(study.tables, [Table::Summary, Table::Impacts]);
    assert_eq!(study.measures, Selection::default());
    assert_eq!(study.spec.get(FieldId::Periods), Some(60.0));
    assert_eq!(file.samples_per_period, 200);
    assert_eq!(file.report.best_by, Some("settling_time_5"));
    assert_eq!(file.report.count, 10);
}

#[test]
fn axes_keep_the_order_of_the_file() {
    for (sweep, keys) in [
        (
            "restitution = [0.5]\nmass_ratio = [0.1]\ndamping_ratio = [0.0]",
            ["restitution", "mass_ratio", "damping_ratio"],
        ),
        (
            "restitution = [0.5]\nabsorber.mass = [0.1]\n\"start.velocity\" = [0]",
            ["restitution", "absorber.mass", "start.velocity"],
        ),
        (
            "absorber.restitution = [0.5]\nperiods = [9]\nabsorber.mass_ratio = [0.1]",
            ["absorber.restitution", "periods", "absorber.mass_ratio"],
        ),
    ] {
        let file = good(&format!("{}[sweep]\n{sweep}\n", without_sweep()));
        let read: Vec<&str> = file.study.sampling.keys().map(|swept| swept.key).collect();
        assert_eq!(read, keys);
    }
}

#[test]
fn whole_numbers_and_every_way_to_write_them_are_numbers() {
    let file = good(
        "version = 1\n[absorber]\nkind = 'siva'\nmass_ratio = 1\nrestitution = 0\nclearance = 0x10\n\
         [run]\nperiods = 1_000\nmax_impacts = 2_000.0\n[primary]\nfrequency_hz = 2e1",
    );
    let spec = &file.study.spec;
    assert_eq!(spec.get(FieldId::MassRatio), Some(1.0));
    assert_eq!(spec.get(FieldId::Clearance), Some(16.0));
    assert_eq!(spec.get(FieldId::Periods), Some(1000.0));
    assert_eq!(spec.get(FieldId::MaxImpacts), Some(2000.0));
    assert_eq!(spec.get(FieldId::FrequencyHz), Some(20.0));
    assert_eq!(file.study.tables, Table::ALL);
}

#[test]
fn report_and_run_settings_are_read() {
    let file = good(&format!(
        "{}measures = [\"damping_ratio_3\", \"impacts\"]\nsamples_per_period = 50\n\
         [report]\nbest_by = \"damping_ratio_3\"\ncount = 3\n",
        without_sweep()
    ));
    assert_eq!(file.samples_per_period, 50);
    assert_eq!(file.report.best_by, Some("damping_ratio_3"));
    assert_eq!(file.report.count, 3);
    assert!(file.study.measures.contains("impacts"));
    assert!(!file.study.measures.contains("settling_time_5"));
    let file = good(&format!("{}measures = []\n", without_sweep()));
    assert_eq!(file.report.best_by, None);
}

/// A bad study and its error: text to replace in the good study, replacement, line, column, parts of the
/// message.
type Case = (&'static str, &'static str, usize, usize, &'static [&'static str]);

#[rustfmt::skip]
const BAD: &[Case] = &[
    // Unknown or ambiguous keys.
    ("restitution", "restitutoin", 7, 1, &["absorber.restitutoin", "did you mean `restitution`?"]),
    ("[start]", "[strat]", 9, 2, &["strat", "did you mean `start`?"]),
    ("[start]", "[qqq]", 9, 2, &["qqq: no such key", "known keys: version, primary"]),
    ("damping_ratio", "mass_ratio", 3, 1, &["primary.mass_ratio", "it belongs in [absorber]"]),
    ("periods", "peroids", 12, 1, &["run.peroids", "did you mean `periods`?"]),
    ("stop", "end", 15, 37, &["sweep.relative_clearance.end", "an axis has start, stop, count"]),
    ("[sweep]\nrelative", "[sweep]\nrelativ", 15, 1, &["`relativ_clearance`", "did you mean `relative_clearance`?"]),
    ("mass_ratio = [", "mass = [", 16, 1, &["`mass`", "not unique", "`primary.mass` or `absorber.mass`"]),
    ("mass_ratio = [", "\"a\\nb\\u001b\" = [", 16, 1, &["sweep key = `a…`: no such field"]),
    ("mass_ratio = [", "\"force.0.a\\nb\" = [", 16, 1, &["sweep key = `force.0.a…`: no such field of a force"]),
    // Keys, quantities or names given twice.
    ("restitution = 0.5", "mass_ratio = 0.5", 7, 1, &["mass_ratio is given twice"]),
    ("[start]", "[absorber]", 9, 2, &["absorber is given twice"]),
    ("mass_ratio = [", "clearance = [", 16, 1, &["sweep.clearance", "sweep.relative_clearance sets the same quantity"]),
    ("[\"impacts\", \"summary\"]", "[\"impacts\", \"impacts\"]", 13, 22, &["run.tables[1] = \"impacts\"", "give each name once"]),
    // Values of the wrong type, and unknown names.
    ("0.1\nrest", "\"0.1\"\nrest", 6, 14, &["absorber.mass_ratio = \"0.1\"", "a number greater than 0", "not a text in quotes"]),
    ("60", "true", 12, 11, &["run.periods = true", "not a truth value"]),
    ("60", "[60, 70]", 12, 11, &["run.periods = [60, 70]", "not a list"]),
    ("\"siva\"", "3", 5, 8, &["absorber.kind = 3", "give one of \"siva\""]),
    ("\"siva\"", "\"sliva\"", 5, 8, &["absorber.kind = \"sliva\"", "did you mean \"siva\"?"]),
    ("[0.05, 0.1, 0.15, 0.2]", "0.05", 16, 14, &["sweep.mass_ratio = 0.05", "give a list of numbers or { start"]),
    ("0.15, 0.2]", "\"x\"]", 16, 26, &["sweep.mass_ratio[2] = \"x\"", "greater than 0"]),
    ("count = 111", "count = 11.5", 15, 57, &["sweep.relative_clearance.count = 11.5", "whole number from 1"]),
    ("[primary]\ndamping_ratio", "primary", 2, 11, &["primary = 0.01", "a line [primary]"]),
    ("[start]", "[[start]]", 9, 3, &["[start] once, in single brackets"]),
    ("[\"impacts\", \"summary\"]", "\"impacts\"", 13, 10, &["run.tables = \"impacts\"", "give a list of names, not a text"]),
    // Values that are not allowed.
    ("0.5", "1.5", 7, 15, &["absorber.restitution = 1.5", "a number from 0 to 1"]),
    ("0.5", "nan", 7, 15, &["absorber.restitution = nan", "a number from 0 to 1"]),
    ("0.6", "inf", 8, 22, &["absorber.relative_clearance = inf", "a number greater than 0, from 1e-30 to 1e30"]),
    ("0.6", "1e999", 8, 22, &["absorber.relative_clearance = 1e999", "a number greater than 0, from 1e-30 to 1e30"]),
    ("0.6", "-0.6", 8, 22, &["absorber.relative_clearance = -0.6", "greater than 0"]),
    ("0.01", "-0.01", 3, 17, &["primary.damping_ratio = -0.01", "a number from 0 to 1e9"]),
    ("0.05, ", "0, ", 16, 15, &["sweep.mass_ratio[0] = 0", "greater than 0"]),
    ("start = 0.1", "start = -1", 15, 32, &["sweep.relative_clearance.start = -1", "greater than 0"]),
    ("count = 111", "count = 0", 15, 57, &["sweep.relative_clearance.count = 0", "whole number from 1"]),
    ("count = 111", "count = 1", 15, 22, &["sweep.relative_clearance.count = 1", "give 2 or more"]),
    ("count = 111", "count = 4_000_000_000", 14, 2, &["4000000000 × 4", "at most 2^32 points"]),
    ("count = 111", "count = 1_000_000_000", 15, 57, &["sweep.relative_clearance.count = 1_000_000_000", "a whole number from 1 to 10000000"]),
    ("[0.05, 0.1, 0.15, 0.2]", "[]", 16, 14, &["sweep.mass_ratio = []", "at least one value"]),
    (", stop = 1.2", "", 15, 1, &["sweep.relative_clearance.stop is missing"]),
    ("version = 1", "version = 2", 1, 11, &["version = 2", "reads version 1"]),
    ("\"impacts\", ", "\"impact\", ", 13, 11, &["run.tables[0] = \"impact\"", "did you mean \"impacts\"?"]),
    ("\"impacts\", ", "\"trajectory\", ", 13, 10, &["run.tables", "a sweep has no trajectory"]),
    ("[\"impacts\", \"summary\"]", "[]", 13, 10, &["run.tables = []", "at least one of summary"]),
    ("tables = [\"impacts\", \"summary\"]", "measures = [\"damping_ratio_4\"]", 13, 13, &["damping_ratio_4", "did you mean \"damping_ratio_"]),
    ("tables = [\"impacts\", \"summary\"]", "max_impacts = 0.5", 13, 15, &["run.max_impacts = 0.5", "whole number"]),
    ("tables = [\"impacts\", \"summary\"]", "samples_per_period = 0", 13, 22, &["run.samples_per_period = 0", "whole number from 1"]),
    ("[sweep]", "[report]\nbest_by = \"settling_time_3\"\n[sweep]", 15, 11, &["report.best_by", "did you mean \"settling_time_"]),
    ("[sweep]", "[report]\ncount = 0\n[sweep]", 15, 9, &["report.count = 0", "whole number from 1"]),
    ("[sweep]", "[report]\nbest_by = \"impacts\"\n[sweep]", 15, 11, &["report.best_by", "neither less nor more"]),
    ("[sweep]", "measures = [\"impacts\"]\n[report]\nbest_by = \"settling_time_5\"\n[sweep]", 16, 11, &["report.best_by", "run.measures leaves this column out"]),
    ("damping_ratio = 0.01", "damping_ratio = 1e10", 3, 17, &["primary.damping_ratio = 1e10", "a number from 0 to 1e9"]),
    ("damping_ratio = 0.01", "damping = -1", 3, 11, &["primary.damping = -1", "0 or a number from 1e-30 to 1e30"]),
    ("damping_ratio = 0.01", "mass = 0", 3, 8, &["primary.mass = 0", "a number greater than 0, from 1e-30 to 1e30"]),
    ("damping_ratio = 0.01", "stiffness = -5.0", 3, 13, &["primary.stiffness = -5.0", "a number greater than 0, from 1e-30 to 1e30"]),
    ("damping_ratio = 0.01", "frequency_hz = 1e31", 3, 16, &["primary.frequency_hz = 1e31", "a number greater than 0, from 1e-30 to 1e30"]),
    ("damping_ratio = 0.01", "natural_frequency = nan", 3, 21, &["primary.natural_frequency = nan", "a number greater than 0, from 1e-30 to 1e30"]),
    ("0.1\nrest", "0.0\nrest", 6, 14, &["absorber.mass_ratio = 0.0", "a number greater than 0, at most 1e9"]),
    ("0.1\nrest", "2e9\nrest", 6, 14, &["absorber.mass_ratio = 2e9", "a number greater than 0, at most 1e9"]),
    ("relative_clearance = 0.6", "gap_mm = 1e-31", 8, 10, &["absorber.gap_mm = 1e-31", "a number greater than 0, from 1e-30 to 1e30"]),
    ("displacement = 1.0", "displacement = inf", 10, 16, &["start.displacement = inf", "0 or a number of size 1e-30 to 1e30"]),
    ("displacement = 1.0", "velocity = 1e-31", 10, 12, &["start.velocity = 1e-31", "0 or a number of size 1e-30 to 1e30"]),
    ("displacement = 1.0", "gap_velocity = -1e40", 10, 16, &["start.gap_velocity = -1e40", "0 or a number of size 1e-30 to 1e30"]),
    ("periods = 60", "periods = 0", 12, 11, &["run.periods = 0", "a number greater than 0, from 1e-30 to 1e30"]),
    ("periods = 60", "duration = -3", 12, 12, &["run.duration = -3", "a number greater than 0, from 1e-30 to 1e30"]),
    ("periods = 60", "chatter_floor = 0", 12, 17, &["run.chatter_floor = 0", "a number greater than 0, from 1e-30 to 1e30"]),
    ("periods = 60", "max_work = -1", 12, 12, &["run.max_work = -1", "whole number"]),
    // Text that is not TOML.
    ("0.01", "0.01.2", 3, 21, &["not valid TOML"]),
    ("kind = \"siva\"", "kind = siva", 5, 8, &["not valid TOML"]),
    ("damping_ratio = 0.01", "damping_ratio =", 3, 16, &["not valid TOML"]),
    // A missing key, with the error at its section.
    ("kind = \"siva\"", "", 4, 2, &["absorber.kind is missing", "give one of \"siva\""]),
];

#[test]
fn every_bad_study_says_where_what_and_what_is_allowed() {
    for (old, new, line, column, parts) in BAD {
        let text = GOOD.replacen(old, new, 1);
        assert_ne!(text, GOOD, "the case {old:?} changes nothing");
        let error = bad(&text);
        let message = error.to_string();
        for part in *parts {
            assert!(message.contains(part), "{part:?} is not in:\n{message}");
        }
        assert!(!message.contains(char::is_control), "{message:?}");
        assert!(message.starts_with(&format!("my.toml:{line}:{column}: ")), "{message}");
        let place = error.place.clone().unwrap_or_else(|| panic!("no place: {message}"));
        assert_eq!((place.line, place.column), (*line, *column), "{message}");
        assert_eq!(place.text, text.lines().nth(line - 1).unwrap());
    }
}

#[test]
fn what_is_missing_altogether_is_named() {
    for (section, part) in [
        ("", "version is missing: give version = 1"),
        ("version = 1\n[run]\nperiods = 1", "section [absorber] is missing"),
    ] {
        let error = bad(section);
        assert!(error.to_string().contains(part), "{error}");
        assert_eq!(error.place, None);
    }
    let empty = bad(&format!("{}[sweep]\n", without_sweep()));
    assert!(empty.message.contains("sweep is empty"), "{empty}");
    assert_eq!(empty.place.unwrap().line, 14);
}

#[test]
fn a_trajectory_with_too_many_samples_is_refused_before_the_run() {
    let text = without_sweep()
        .replace("periods = 60", "periods = 1e6\nsamples_per_period = 1000000")
        .replace("[\"impacts\", \"summary\"]", "[\"trajectory\"]");
    let error = match good(&text).validate(
        &Workers::new(Some(1)).unwrap(),
        &AtomicBool::new(false),
        &|_| {},
    ) {
        Err(Error::Study(error)) => error,
        other => panic!("{other:?}"),
    };
    assert!(error.message.contains("1e12 samples, at most 3e7"), "{error}");
    assert!(error.message.starts_with("run.samples_per_period = 1000000"), "{error}");
}

#[test]
fn windows_line_ends_and_wide_characters_are_counted_right() {
    let text = GOOD
        .replace("[primary]", "[primary] # Dämpfung ζ")
        .replace("0.6", "0.6 # γ")
        .replace("[0.05, ", "[0, ")
        .replace('\n', "\r\n");
    let place = bad(&text).place.unwrap();
    assert_eq!((place.line, place.column), (16, 15));
    assert_eq!(place.text, "mass_ratio = [0, 0.1, 0.15, 0.2]");
}

#[test]
fn an_error_between_the_two_characters_of_a_line_end_is_placed_before_them() {
    let error = bad("version = 1\r\nrun = [\"\r\r\r\n\r\n");
    let place = error.place.clone().unwrap();
    assert_eq!((place.line, place.text.as_str()), (2, "run = [\"\r\r"), "{error}");
    assert!(place.text.get(place.span.clone()).is_some(), "{place:?}");
}

#[test]
fn what_only_shows_together_is_pointed_at_its_line() {
    let line = |text: &str, field: &str| {
        let file = good(text);
        let invalid = iva_sweep::Invalid::new(field, 1.0, "no");
        match file.source.locate(&invalid) {
            Error::Study(error) => error.place.map(|place| place.line),
            other => panic!("{other}"),
        }
    };
    // The place is that of the field, the axis over it, another field for its quantity, its section, or none.
    assert_eq!(line(GOOD, "start.displacement"), Some(10));
    assert_eq!(line(GOOD, "absorber.relative_clearance"), Some(15));
    assert_eq!(line(GOOD, "absorber.clearance"), Some(15));
    assert_eq!(line(without_sweep(), "absorber.clearance"), Some(8));
    assert_eq!(line(GOOD, "primary.natural_frequency"), Some(2));
    assert_eq!(line(GOOD, "sweep.mass_ratio[2]"), Some(16));
    assert_eq!(line(GOOD, "sweep"), Some(14));
    assert_eq!(line(GOOD, "nowhere"), None);
}

#[test]
fn a_start_outside_the_gap_is_pointed_at_in_the_file() {
    let text = without_sweep().replace("[run]", "gap_displacement = 2.0\n[run]");
    match good(&text).validate(&Workers::new(Some(1)).unwrap(), &AtomicBool::new(false), &|_| {}) {
        Err(Error::Study(error)) => {
            assert_eq!(error.place.clone().unwrap().line, 11, "{error}");
            assert!(error.message.contains("start.gap_displacement = 2"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_field_missing_altogether_is_refused_with_what_to_give() {
    let text = without_sweep().replace("periods = 60\n", "");
    let error = good(&text)
        .validate(&Workers::new(Some(1)).unwrap(), &AtomicBool::new(false), &|_| {})
        .unwrap_err();
    assert!(error.is_bad_input());
    assert!(error.to_string().contains("run.periods is missing: give periods"), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_study(&folder.path().join("none.toml")).unwrap_err();
    assert!(error.is_bad_input());
    assert!(error.to_string().contains("none.toml"), "{error}");
    let latin = folder.path().join("latin.toml");
    std::fs::write(&latin, b"version = 1\n# D\xe4mpfung\n").unwrap();
    let error = read_study(&latin).unwrap_err();
    assert!(error.is_bad_input());
    assert!(error.to_string().contains("line 2 is not UTF-8"), "{error}");
}

const SEVERAL: &str = r#"version = 1
[primary]
damping_ratio = 0.01
[[absorber]]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[[absorber]]
kind = "siva"
mass_ratio = 0.05
restitution = 0.7
gap = 0.9
[start]
displacement = 1.0
gap_displacement = [0.1, -0.2]
gap_velocity = 0.3
[run]
periods = 20
"#;

#[test]
fn several_absorbers_have_their_own_numbers() {
    let file = good(&format!("{SEVERAL}[sweep]\n\"absorber.1.gap\" = [0.8, 1.0]\n"));
    let spec = file.study.spec(1).unwrap();
    let of = |absorber, field| spec.get_of(absorber, field);
    assert_eq!(spec.count(), 2);
    assert_eq!([0, 1].map(|k| of(k, FieldId::MassRatio)), [Some(0.1), Some(0.05)]);
    assert_eq!([0, 1].map(|k| of(k, FieldId::GapDisplacement)), [Some(0.1), Some(-0.2)]);
    assert_eq!([0, 1].map(|k| of(k, FieldId::GapVelocity)), [Some(0.3); 2]);
    assert_eq!([0, 1].map(|k| of(k, FieldId::Gap)), [None, Some(1.0)]);
    // Without quotes TOML reads nested tables.
    for key in ["absorber.1.clearance", "start.1.gap_velocity"] {
        let plain = good(&format!("{SEVERAL}[sweep]\n{key} = [0.3, 0.4]\n"));
        let quoted = good(&format!("{SEVERAL}[sweep]\n\"{key}\" = [0.3, 0.4]\n"));
        assert_eq!(plain.study, quoted.study);
    }
    let all = good(&format!("{SEVERAL}[sweep]\nclearance = [0.3, 0.4]\n"));
    let spec = all.study.spec(1).unwrap();
    assert_eq!([0, 1].map(|k| spec.get_of(k, FieldId::Clearance)), [Some(0.4); 2]);
    assert_eq!(spec.get_of(1, FieldId::Gap), None);
}

#[test]
fn units_have_starts_of_their_own() {
    let divided = SEVERAL
        .replace("restitution = 0.7", "restitution = 0.7\nunits = 2")
        .replace("[0.1, -0.2]", "[0.1, -0.2, 0.3]");
    let file = good(&divided);
    let spec = &file.study.spec;
    assert_eq!(spec.starts(FieldId::GapDisplacement), [0.1, -0.2, 0.3]);
    assert_eq!(spec.starts(FieldId::GapVelocity), [0.3, 0.3]);
    let error = bad(&divided.replace("[0.1, -0.2, 0.3]", "[0.1, -0.2, 0.3, 0.4]")).to_string();
    assert!(error.contains("a list of 2, one for each absorber, or of 3"), "{error}");
    let outside = good(&divided.replace("0.3]", "0.5]"));
    let invalid = outside.study.design(0).unwrap_err();
    let error = outside.source.locate(&invalid).to_string();
    assert!(error.starts_with("my.toml:17:"), "{error}");
    assert!(error.contains("start.1.1.gap_displacement = 0.5: it must lie in the gap"), "{error}");
    let all = good(&format!("{divided}[sweep]\ngap_displacement = [0.0, 0.1]\n"));
    assert_eq!(all.study.spec(1).unwrap().starts(FieldId::GapDisplacement), [0.1, 0.1]);
    let error = bad(&format!("{divided}[sweep]\n\"absorber.1.units\" = [2, 3]\n")).to_string();
    assert!(error.contains("a number for each unit; give one for all units"), "{error}");
}

#[test]
fn faults_of_several_absorbers_name_theirs() {
    let wrong = |from: &str, to: &str| {
        let text = SEVERAL.replace(from, to);
        assert_ne!(text, SEVERAL);
        match parse(&text).and_then(|file| {
            let never = std::sync::atomic::AtomicBool::new(false);
            file.validate(&Workers::new(Some(1)).unwrap(), &never, &|_| ())
        }) {
            Err(error) => error.to_string(),
            Ok(()) => panic!("it is valid\n{text}"),
        }
    };
    for (from, to, told) in [
        ("restitution = 0.7", "restitution = 1.7", "my.toml:12:15: absorber.1.restitution = 1.7"),
        ("restitution = 0.7\n", "", "my.toml:9:1: absorber.1.restitution is missing"),
        ("restitution = 0.7", "length = 0.7", "only a pendulum (kind \"piva\") has it"),
        ("gap = 0.9", "gap = 0.3", "start.1.gap_displacement = -0.2: it must lie in the gap"),
        ("[0.1, -0.2]", "[0.1]", "give a number, or a list of 2, one for each absorber"),
        ("gap = 0.9", "gap = 0.9\ninclination_deg = 90", "absorber.1.gravity is missing"),
        ("[run]", "[sweep]\n\"absorber.2.gap\" = [1, 2]\n[run]", "2 absorbers, numbered from 0"),
        (
            "[run]",
            "[sweep]\ngap = [1, 2]\n\"absorber.1.clearance\" = [1, 2]\n[run]",
            "sets the same quantity",
        ),
        ("mass_ratio = 0.05", "mass = 0.05", "absorber.1.mass = 0.05: give primary.mass"),
    ] {
        let error = wrong(from, to);
        assert!(error.contains(told), "{told}: {error}");
    }
    let one = GOOD.replace("displacement = 1.0", "displacement = 1.0\ngap_velocity = [0.1, 0.2]");
    assert!(bad(&one).to_string().contains("there is one absorber, so give one number"));
}
