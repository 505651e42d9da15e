//! Expected numbers are those in the texts, for AT2 files times g = 9.80665 m/s², which is exact by definition.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use iva_sweep::forces::{Column, Selection};
use proptest::prelude::*;

use super::*;
use crate::error::StudyError;

fn read(text: &str) -> RecordFile {
    read_as("record.txt", text)
}

fn read_as(name: &str, text: &str) -> RecordFile {
    parse_record(Path::new(name), text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn fault(name: &str, bytes: &[u8]) -> StudyError {
    match parse_record(Path::new(name), bytes) {
        Err(Error::Study(error)) => *error,
        other => panic!("expected an error, got {other:?}"),
    }
}

/// Line, column and message of the error for a text.
fn said(text: &str) -> String {
    said_as("record.txt", text)
}

fn said_as(name: &str, text: &str) -> String {
    fault(name, text.as_bytes()).to_string().strip_prefix(&format!("{name}:")).unwrap().to_owned()
}

#[test]
fn two_columns_with_any_separator() {
    let expected = RecordFile {
        times: vec![-0.5, 0.0, 0.25],
        values: vec![1.5, -2e-3, 4.0],
        unit: RecordUnit::Unstated,
    };
    for text in [
        "-0.5,1.5\n0,-2e-3\n.25,4.\n",
        "-0.5;1.5\n0;-2e-3\n.25;4.",
        "-0.5\t1.5\n0\t-2e-3\n.25\t4.\n",
        "  -0.5   1.5\n   0    -2e-3\n .25\t 4.   \n",
        "-0.5 , 1.5\n0 ;-2.0D-3\n+.25 +4d0\n",
        "-0.5,1.5\r\n0,-2e-3\r\n.25,4.\r\n",
        "\u{feff}-0.5,1.5\n0,-2e-3\n.25,4.\n",
        "# a record\n\nTime [s],Acceleration [m/s²]\n-0.5,1.5\n  # a remark\n\n0,-2e-3\n.25,4.\n\n",
        "\u{feff}time acc\r\n-0.5 1.5\r\n\r\n0 -2e-3\r\n.25 4.\r\n",
    ] {
        assert_eq!(read(text), expected, "{text}");
    }
}

#[test]
fn a_time_step_and_values() {
    for text in [
        "dt = 0.25\n1\n2\n3\n4\n",
        "DT=.25\r\n1 2 3\r\n4\r\n",
        "\u{feff}# shaker\n\ndt,0.25\n1,2\n# more\n3;4\n",
        "dt;2.5e-1\n1;2;3;4",
        "Dt 0.25\n 1\t2\n\n3 4",
    ] {
        let record = read(text);
        assert_eq!(record.times, [0.0, 0.25, 0.5, 0.75], "{text}");
        assert_eq!(record.values, [1.0, 2.0, 3.0, 4.0], "{text}");
        assert_eq!(record.unit, RecordUnit::Unstated);
    }
}

const HEADER: &str = "PEER STRONG MOTION\nSOMEWHERE\n\
    ACCELERATION TIME SERIES IN UNITS OF G\n";

#[test]
fn at2_in_both_forms_and_without_blanks_between_numbers() {
    let g = 9.80665;
    for sampling in [
        "NPTS=  5, DT=   .0050 SEC",
        "NPTS=5,DT=.005",
        "npts=   5, dt= 5.0E-03 seconds,",
        "  5    0.0050    NPTS, DT",
    ] {
        let text = format!(
            "{HEADER}{sampling}\n  .1234E-02 -.5D-3\n-.1234567E-02-.2345678E-03+.1D+01\n\n"
        );
        let record = read_as("quake.At2", &text);
        assert_eq!(record.times, [0.0, 0.005, 0.01, 3.0 * 0.005, 0.02], "{sampling}");
        let in_g = [0.1234e-2, -0.5e-3, -0.1234567e-2, -0.2345678e-3, 0.1e1];
        assert_eq!(record.values, in_g.map(|value| value * g), "{sampling}");
        assert_eq!(record.unit, RecordUnit::MetresPerSecondSquared);
        // The format is also recognised by the content, with a byte order mark and CRLF line ends.
        let other = format!("\u{feff}{text}").replace('\n', "\r\n");
        assert_eq!(read_as("quake.txt", &other), record, "{sampling}");
    }
    let filtered = HEADER.replace("SERIES IN UNITS OF G", "HISTORY IN UNITS OF G. FILTER: HP=0.1");
    let text = format!("{filtered}NPTS= 2, DT= .01 SEC\n-0.001-0.002");
    assert_eq!(read(&text).values, [-0.001 * g, -0.002 * g]);
}

#[test]
fn the_record_of_the_repository_reads() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let path = studies.join("synthetic_quake.at2");
    assert!(fs::read_to_string(&path).unwrap().starts_with("SYNTHETIC RECORD"));
    let RecordFile { times, values, unit } = read_record(&path).unwrap();
    assert_eq!(unit, RecordUnit::MetresPerSecondSquared);
    assert_eq!((times.len(), times[0], times[999]), (1000, 0.0, 999.0 * 0.02));
    assert_eq!((values[0], values[999]), (0.0, 0.0));
    let peak = values.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
    assert_eq!(peak, 0.3 * 9.80665);
    // The values are multiples of 1e-7 g whose sums for the final velocity and displacement are 0.
    let whole: Vec<i64> =
        values.iter().map(|value| (value / 9.80665 * 1e7).round() as i64).collect();
    let velocity: i64 = whole.iter().sum();
    let displacement: i64 = (0..).zip(&whole).map(|(step, value)| (999 - step) * value).sum();
    assert_eq!((velocity, displacement), (0, 0));
}

#[test]
fn faults_of_columns() {
    for (text, expected) in [
        ("", " the file is empty; give times and values"),
        // A line with a cell that is not a name is not a header.
        (" \r\n\u{feff}", "2:1: 1 column; give two, a time and a value with decimal points"),
        ("1.O,2\n1,2\n2,3\n", "1:1: \"1.O\" is not a number; give finite numbers"),
        ("--,--\n1,2\n2,3\n", "1:1: \"--\" is not a number; give finite numbers"),
        ("0,1e400\n1,2\n", "1:3: \"1e400\" is not finite; give finite numbers"),
        ("# only this\n", " no numbers in it; a record needs at least 2 points"),
        ("time,value\n", " no numbers in it; a record needs at least 2 points"),
        ("dt = 0.1\n", " no numbers in it; a record needs at least 2 points"),
        ("0,1\n", " 1 point in it; a record needs at least 2"),
        ("dt = 0.1\n7\n", " 1 point in it; a record needs at least 2"),
        ("t,a\n0,1\n\n 1, x1\n", "4:5: \"x1\" is not a number; "),
        ("t,a\nb,c\n", "2:1: \"b\" is not a number; "),
        ("time,7\n0,1\n", "1:1: \"time\" is not a number; "),
        ("0,1\n1,\n", "2:3: an empty column; "),
        ("0 1\n1 nan\n", "2:3: \"nan\" is not finite; "),
        ("nan 1\n1 2\n", "1:1: \"nan\" is not finite; "),
        ("0 1\ninf 2\n", "2:1: \"inf\" is not finite; "),
        ("0 1\n1 -1e999\n", "2:3: \"-1e999\" is not finite; "),
        ("0 1\n1 \u{1b}[2J\n", "2:3: \"\u{fffd}[2J\" is not a number; "),
        ("0,1\n2.5,1\n2.5,1\n", "3:1: time 2.5 follows 2.5; times must increase strictly"),
        ("0 1\n2 1\n 1e-3 1\n", "3:2: time 0.001 follows 2.0; times must increase strictly"),
        ("1,2,3\n", "1:1: 3 columns; give two, a time and a value with decimal points"),
        ("0,1\n1,2,\n", "2:1: 3 columns; "),
        ("0 1\n\n  5\n", "3:3: 1 column; "),
        ("0,01,0,5\n", "1:1: 4 columns; "),
        (
            "t;a\n0,0;1,5\n",
            "2:1: \"0,0\" seems to have a decimal comma; write a decimal point: 0.0",
        ),
        ("0,0;1,5\n", "1:1: \"0,0\" seems to have a decimal comma"),
        (
            "0;-1,5e-3\n",
            "1:3: \"-1,5e-3\" seems to have a decimal comma; write a decimal point: -1.5e-3",
        ),
        ("0\t1\n1\t1,5\n", "2:3: \"1,5\" seems to have a decimal comma"),
        ("0,01 1,5\n", "1:1: \"0,01\" seems to have a decimal comma"),
        ("dt = 0,01\n1\n2\n", "1:6: \"0,01\" seems to have a decimal comma"),
        ("dt;0.01\n1\n2;5,5\n", "3:3: \"5,5\" seems to have a decimal comma"),
        (
            "dt = 0\n1\n2\n",
            "1:6: dt = 0: give a number greater than 0, from 1e-30 to 1e30, and nothing else",
        ),
        ("dt = -0.01\n1\n2\n", "1:6: dt = -0.01: give a number greater than 0"),
        ("dt = nan\n1\n2\n", "1:6: dt = nan: give a number greater than 0"),
        ("# x\ndt = 0.01 s\n1\n2\n", "2:6: dt = 0.01 s: give a number greater than 0"),
        ("dt\n1\n2\n", "1:3: dt = : give a number greater than 0"),
        ("dt = 0.01\n1 2\n3 x\n", "3:3: \"x\" is not a number; "),
        ("dt = 0.01\n1,,2\n", "2:3: an empty column; "),
        ("dt = 0.01\n1 Infinity\n", "2:3: \"Infinity\" is not finite; "),
    ] {
        let message = said(text);
        assert!(message.starts_with(expected), "{text:?}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn faults_of_at2() {
    let sampled = format!("{HEADER}NPTS= 3, DT= .01 SEC\n");
    let of = |quantity: &str, unit: &str| {
        let kind = format!("{quantity} TIME SERIES IN UNITS OF {unit}");
        sampled.replace("ACCELERATION TIME SERIES IN UNITS OF G", &kind) + ".1 .2 .3\n"
    };
    for (text, expected) in [
        (HEADER.to_owned(), " ends within its header; a PEER AT2 file has four header lines"),
        (of("Velocity", "CM/S"), "3:1: a record of velocity; give the record of acceleration"),
        (of("DISPLACEMENT", "CM"), "3:1: a record of displacement; give the record of"),
        (
            of("ACCELERATION", "CM/S/S"),
            "3:1: \"ACCELERATION TIME SERIES IN UNITS OF CM/\u{2026}\": the ",
        ),
        (of("ACCELERATION", "GAL"), "3:1: \"ACCELERATION TIME SERIES IN UNITS OF GAL\": the third"),
        (of("PRESSURE", "G"), "3:1: \"PRESSURE TIME SERIES IN UNITS OF G\": the third line"),
        (format!("{HEADER}4000 POINTS\n"), "4:1: \"4000 POINTS\": the fourth line of a PEER AT2"),
        (sampled.replace("SEC", "MSEC"), "4:1: \"NPTS= 3, DT= .01 MSEC\": the fourth line"),
        (sampled.replace("= 3", "= 3.5"), "4:7: NPTS = 3.5: give a whole number, at least 2"),
        (sampled.replace("= 3", "= -3"), "4:7: NPTS = -3: give a whole number, at least 2"),
        (sampled.replace(".01", "0.0"), "4:14: DT = 0.0: give a number greater than 0"),
        (sampled.replace(".01", "x"), "4:14: DT = x: give a number greater than 0"),
        (format!("{sampled}.1 .2\n"), "4:1: NPTS is 3, but 2 values follow; the two must agree"),
        (
            format!("{sampled}.1 .2 .3 .4"),
            "4:1: NPTS is 3, but 4 values follow; the two must agree",
        ),
        (
            sampled.replace("= 3", "= 18446744073709551615"),
            "4:1: NPTS is 18446744073709551615, but 0",
        ),
        (sampled.replace("= 3", "= 0"), " no numbers in it; a record needs at least 2"),
        (sampled.replace("= 3", "= 1") + ".1", " 1 point in it; a record needs at least 2"),
        (format!("{sampled}.1 .2\n ***** .3"), "6:2: \"*****\" is not a number"),
        (format!("{sampled}.1 .2\n.1-.2E-01NaN"), "6:3: \"-.2E-01NaN\" is not a number"),
        // Fortran leaves out the E of an exponent of three digits; the word is not two numbers.
        (format!("{sampled}.1 .5-102"), "5:4: \".5-102\" is not a number"),
        (format!("{sampled}.1 .2 inf"), "5:7: \"inf\" is not finite"),
        (format!("{sampled}.1 .2 .9E308"), "5:7: \".9E308\" g is too large in m/s²"),
    ] {
        let message = said_as("quake.at2", &text);
        assert!(message.starts_with(expected), "{text:?}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
    // The extension alone selects the format AT2.
    let columns = "0 1\n1 2\n2 3\n3 4\n4 5\n";
    assert_eq!(read(columns).values.len(), 5);
    assert!(said_as("quake.AT2", columns).starts_with("3:1: \"2 3\": the third line of a PEER"));
    // A comment that contains NPTS does not select it.
    assert_eq!(read(&format!("# NPTS= 5, converted\n{columns}")).values.len(), 5);
}

#[test]
fn what_is_not_text_is_refused() {
    let zero = fault("a.csv", b"0,1\n1,2\n\0\0").to_string();
    assert_eq!(zero, "a.csv: a binary file or text in UTF-16; give a record as text in UTF-8");
    let latin = fault("a.csv", b"t,a\n0,1\n1,2 m/s\xb2\n").to_string();
    assert_eq!(latin, "a.csv:3:8: not UTF-8 text; give a record as text in UTF-8");
}

#[test]
fn files_that_cannot_be_read_or_are_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.csv");
    for path in [missing.as_path(), folder.path()] {
        let error = read_record(path).unwrap_err();
        assert!(matches!(error, Error::UnreadableRecord { .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("cannot read {}", path.display())));
    }
    let large = folder.path().join("large.csv");
    // The file is sparse and takes no space.
    fs::File::create(&large).unwrap().set_len(MOST_BYTES + 1).unwrap();
    let error = read_record(&large).unwrap_err();
    assert!(matches!(error, Error::LargeRecord { .. }), "{error}");
    assert!(error.to_string().contains("larger than 1 GiB"), "{error}");
    let good: PathBuf = folder.path().join("good.csv");
    fs::write(&good, "0 1\n1 2\n").unwrap();
    assert_eq!(read_record(&good).unwrap().values, [1.0, 2.0]);
}

/// Pieces of the texts of records, valid and invalid.
fn scraps() -> impl Strategy<Value = String> {
    let scrap = prop::sample::select(vec![
        "0",
        "1",
        "-.5D-3",
        "1e3",
        ".1E+01-.2E+01",
        "nan",
        "-inf",
        "1e999",
        "+",
        "-",
        ".",
        "E",
        "0,5",
        ",",
        ";",
        "\t",
        " ",
        "\n",
        "\n",
        "\n",
        "\r\n",
        "\r",
        "#",
        "dt",
        "dt = ",
        "DT=",
        "=",
        "NPTS=",
        "NPTS",
        " 3",
        "SEC",
        "ACCELERATION TIME SERIES IN UNITS OF G\n",
        "VELOCITY",
        "UNITS OF",
        "x",
        "é",
        "\u{feff}",
        "\u{a0}",
        "\u{2028}",
        "\u{1b}",
        "\u{301}",
        "字",
        "99999999999999999999",
        "\0",
    ]);
    prop::collection::vec(scrap, 0..60).prop_map(|scraps| scraps.concat())
}

/// Checks that reading gives a valid record, or an [`Error::Study`] whose message is one line for a terminal.
fn check_any(bytes: &[u8]) -> Result<(), TestCaseError> {
    for name in ["a.csv", "a.at2"] {
        match parse_record(Path::new(name), bytes) {
            Ok(RecordFile { times, values, .. }) => {
                prop_assert!(times.len() >= 2 && times.len() == values.len());
                prop_assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(times.iter().chain(&values).all(|number| number.is_finite()));
            }
            Err(error) => {
                prop_assert!(matches!(error, Error::Study(_)));
                prop_assert!(!error.to_string().contains(['\n', '\u{1b}']), "{error}");
            }
        }
        for selection in selections() {
            let message = match parse_record_in_si(Path::new(name), bytes, &selection) {
                Ok(RecordFile { times, values, .. }) => {
                    prop_assert!(times.len() >= 2 && times.len() == values.len());
                    continue;
                }
                Err(Unread::Key { message, .. }) => message,
                Err(Unread::File(error)) => {
                    prop_assert!(matches!(error, Error::Study(_)));
                    error.to_string()
                }
            };
            prop_assert!(!message.contains(['\n', '\u{1b}']), "{message}");
        }
    }
    Ok(())
}

/// Some of what a study may say of a file.
fn selections() -> [Selection; 4] {
    let none = Selection::default;
    let (unit, column) = (Some("g".to_owned()), Some(Column::At(0)));
    [
        none(),
        Selection { unit, ..none() },
        Selection { column, sampling_hz: Some(100.0), ..none() },
        Selection {
            column: Some(Column::Named("x".to_owned())),
            time: Some(Column::At(1)),
            ..none()
        },
    ]
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check_any(&bytes)?;
    }

    #[test]
    fn any_scraps_are_read_or_refused(text in scraps(), headed in any::<bool>()) {
        let header = if headed { format!("{HEADER}NPTS= 3, DT= .01\n") } else { String::new() };
        check_any(format!("{header}{text}").as_bytes())?;
    }

    #[test]
    fn damaged_records_are_read_or_refused(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        end in any::<prop::sample::Index>(),
    ) {
        for good in [
            format!("{HEADER}NPTS= 4, DT= .01 SEC\n .1E-02 .2E-02-.3E-02\n .4E-02\n"),
            "dt = 0.01\n1.5\n2.5 -3.5e-2\n".to_owned(),
            "# a record\nt [s];a [m/s²]\n0.0;1.5\n0.5;-2.5e-1\n".to_owned(),
        ] {
            let mut bytes = good.into_bytes();
            for (place, byte) in &places {
                let at = place.index(bytes.len());
                bytes[at] = *byte;
            }
            bytes.truncate(end.index(bytes.len()) + 1);
            check_any(&bytes)?;
        }
    }

    #[test]
    fn what_is_written_is_read_back_to_the_bit(
        steps in prop::collection::vec((1e-6..1e3, -1e300..1e300), 2..40),
        separator in prop::sample::select(vec![",", ";", "\t", "  ", " , "]),
        end in prop::sample::select(vec!["\n", "\r\n"]),
    ) {
        let mut text = String::new();
        let (mut times, mut values) = (Vec::new(), Vec::new());
        let mut time = -50.0;
        for (step, value) in steps {
            time += step;
            write!(text, "{time}{separator}{value:e}{end}").unwrap();
            times.push(time);
            values.push(value);
        }
        prop_assert_eq!(read(&text), RecordFile { times, values, unit: RecordUnit::Unstated });
    }
}
