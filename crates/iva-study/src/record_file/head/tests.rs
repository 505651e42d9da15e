//! Expected numbers are those of the texts times the factor of the unit, which is exact by definition.

use std::path::Path;

use iva_sweep::forces::Selection;

use super::*;
use crate::Error;
use crate::record_file::{Unread, parse_record_in_si};

/// A record of three points below a head.
fn read(head: &str) -> RecordFile {
    let text = format!("{head}\n0,0\n1,0.5\n2,-1\n");
    parse_record_in_si(Path::new("a.csv"), text.as_bytes(), &Selection::default())
        .unwrap_or_else(|error| panic!("{error:?}\n{text}"))
}

fn said(head: &str) -> String {
    let text = format!("{head}\n0,0\n1,0.5\n2,-1\n");
    match parse_record_in_si(Path::new("a.csv"), text.as_bytes(), &Selection::default()) {
        Err(Unread::File(Error::Study(error))) => error.to_string(),
        other => panic!("expected an error, got {other:?}"),
    }
}

#[test]
fn units_that_heads_name_are_converted() {
    use RecordUnit::{MetresPerSecondSquared, Newtons, OfStudy, Unstated};
    let g = 9.806_65;
    for (head, seconds, factor, unit) in [
        ("time (s),acceleration (g)", 1.0, g, MetresPerSecondSquared),
        ("time (ms),acceleration (m/s^2)", 1e-3, 1.0, MetresPerSecondSquared),
        ("time_s,acceleration_mm_s2", 1.0, 1e-3, MetresPerSecondSquared),
        ("\"Zeit [ms]\";\"a [mm/s²]\"", 1e-3, 1e-3, MetresPerSecondSquared),
        ("# t in us, a / (cm/sec/sec)", 1e-6, 1e-2, MetresPerSecondSquared),
        ("# t [ms], a [g]\nx,y", 1e-3, g, MetresPerSecondSquared),
        ("t [s]   a1 [GAL]", 1.0, 1e-2, MetresPerSecondSquared),
        ("t,a (m s^-2)", 1.0, 1.0, MetresPerSecondSquared),
        ("t,a_in_per_s2", 1.0, 0.0254, MetresPerSecondSquared),
        ("t,a (mg)", 1.0, g * 1e-3, MetresPerSecondSquared),
        ("t,shaker [kN]", 1.0, 1e3, Newtons),
        ("t_ms,force_N", 1e-3, 1.0, Newtons),
        ("t,acc_N", 1.0, 1.0, Unstated),
        ("t,f/M", 1.0, 1.0, Unstated),
        ("t [ms],f/M", 1e-3, 1.0, Unstated),
        ("t [-],a (1)", 1.0, 1.0, OfStudy),
        ("# a remark (draft)", 1.0, 1.0, Unstated),
    ] {
        let record = read(head);
        assert_eq!(record.times, [0.0, seconds, 2.0 * seconds], "{head}");
        assert_eq!(record.values, [0.0, 0.5 * factor, -factor], "{head}");
        assert_eq!(record.unit, unit, "{head}");
    }
}

#[test]
fn a_comment_above_a_time_step_names_the_unit_of_the_values() {
    let text = "# made by hand (draft)\n# acceleration [g]\ndt = 0.5\n1 2\n";
    let record =
        parse_record_in_si(Path::new("a.txt"), text.as_bytes(), &Selection::default()).unwrap();
    assert_eq!(record.times, [0.0, 0.5]);
    assert_eq!(record.values, [9.806_65, 2.0 * 9.806_65]);
    assert_eq!(record.unit, RecordUnit::MetresPerSecondSquared);
}

#[test]
fn units_of_something_else_are_refused() {
    for (head, expected) in [
        ("t [min],a [g]", "a.csv:1:1: unit \"min\": give times in s, ms or us"),
        ("a [g],t [s]", "a.csv:1:1: unit \"g\": give times in s, ms or us"),
        (
            "t [s],x [mm]",
            "a.csv:1:1: unit \"mm\": give values in m/s^2, mm/s^2, g, N or kN, or in 1",
        ),
        ("t [s],v (mm/s)", "a.csv:1:1: unit \"mm/s\": give values in"),
        ("t [s],u (V)", "a.csv:1:1: unit \"V\": give values in"),
    ] {
        let message = said(head);
        assert!(message.starts_with(expected), "{head}: {message}");
    }
}
