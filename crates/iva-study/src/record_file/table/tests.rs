//! Values are those of the texts times the factor of the unit, which is exact by definition.

use std::path::Path;

use iva_sweep::forces::{Column, Selection};

use crate::record_file::{RecordFile, RecordUnit, parse_record_in_si};

/// What is read of a text.
fn read(text: &str, selection: &Selection) -> RecordFile {
    parse_record_in_si(Path::new("a.csv"), text.as_bytes(), selection)
        .unwrap_or_else(|error| panic!("{error:?}\n{text}"))
}

#[test]
fn units_in_a_line_below_the_names() {
    use RecordUnit::{MetresPerSecondSquared, Newtons};
    let pound = 0.453_592_37 * 9.806_65;
    for (head, seconds, factor, unit) in [
        ("time,force\ns,N", 1.0, 1.0, Newtons),
        ("time,force\ns,kN", 1.0, 1e3, Newtons),
        ("t;F\nms;kN", 1e-3, 1e3, Newtons),
        ("t,F\n[s],[lbf]", 1.0, pound, Newtons),
        ("# t,force\n# -,N", 1.0, 1.0, Newtons),
        ("time\tacc\ns\tm/s^2", 1.0, 1.0, MetresPerSecondSquared),
        ("time,acc\ns,mm/s²", 1.0, 1e-3, MetresPerSecondSquared),
    ] {
        let mark = head.chars().find(|c| ";\t".contains(*c)).unwrap_or(',');
        let rows = "0,0\n1,0.5\n2,-1\n".replace(',', &mark.to_string());
        let record = read(&format!("{head}\n{rows}"), &Selection::default());
        assert_eq!(record.times, [0.0, seconds, 2.0 * seconds], "{head}");
        assert_eq!(record.values, [0.0, 0.5 * factor, -factor], "{head}");
        assert_eq!(record.unit, unit, "{head}");
    }
}

#[test]
fn columns_of_something_else_may_have_units_too() {
    let text = "time,force,temperature\ns,kN,°C\n0,0,20\n1,0.5,21\n";
    let column = Some(Column::Named("force".to_owned()));
    let record = read(text, &Selection { column, ..Selection::default() });
    assert_eq!((record.values, record.unit), (vec![0.0, 500.0], RecordUnit::Newtons));
}

#[test]
fn north_is_no_force() {
    let text = "N,V\n0,1\n1,2\n2,4\n";
    let record = read(text, &Selection::default());
    assert_eq!((record.values, record.unit), (vec![1.0, 2.0, 4.0], RecordUnit::Unstated));
    let column = Some(Column::Named("N".to_owned()));
    let hz = Some(100.0);
    let north = read(
        "station\nN,E,V\n0,1,5\n1,2,5\n",
        &Selection { column, sampling_hz: hz, ..Selection::default() },
    );
    assert_eq!((north.values, north.unit), (vec![0.0, 1.0], RecordUnit::Unstated));
}
