//! Texts of a series are written here with the formats that they state; what is said is compared word by word.

use super::*;

fn said(text: &str) -> Option<String> {
    refuse(text).err().map(|fault| fault.message)
}

const BLOCK: &str = "   0.00100  -0.00200   0.00300   0.00050  -0.00100\n   0.00200   0.00400   0.00100   0.00000   0.00700\n";

#[test]
fn formats_are_found_in_words() {
    for (line, expected) in [
        ("(8F10.5)", Some((8, 10))),
        ("in cm/sec2. (8f10.6)", Some((8, 10))),
        ("Format=(10I8)", Some((10, 8))),
        ("EL CENTRO, 8F10.5", Some((8, 10))),
        ("(1P6E12.4)", Some((6, 12))),
        ("(5D15.7), dt = 0.01 s", Some((5, 15))),
        ("(1F10.5)", None),
        ("model X8F10.5", None),
        ("8F10", None),
        ("0F10.5", None),
        ("8F0.5", None),
        ("é8F10.5é (2F8.3)", Some((2, 8))),
        ("0.1 2E3.4", Some((2, 3))),
        ("1940", None),
    ] {
        assert_eq!(format_in(line), expected, "{line}");
    }
}

#[test]
fn a_series_with_several_numbers_a_line_is_no_table() {
    let short = "  -0.00900  -0.00100\n";
    for text in [
        format!("EL CENTRO\n(5F10.5), dt = 0.02 s, in g\n{BLOCK}"),
        format!("(5F10.5)\n{BLOCK}"),
        format!("{BLOCK}{short}"),
        format!("EL CENTRO 1940 NS\n{BLOCK}{short}"),
    ] {
        let said = said(&text).unwrap();
        assert!(
            said.starts_with(
                "a series with 5 numbers a line, which a study reads only below dt = …; "
            ),
            "{said}"
        );
    }
    let tight = "(3F8.5)\n 0.00100-0.00200 0.00300\n";
    assert!(said(tight).unwrap().starts_with("a series with 3 numbers a line"));
    assert!(said(BLOCK).is_none(), "two lines are too few to tell");
    let full = format!("{BLOCK}{BLOCK}");
    assert!(
        said(&full).unwrap().starts_with("its lines of 5 numbers may be one series or 5 columns; ")
    );
}

#[test]
fn pairs_are_no_columns() {
    let text = "0.0 1.5 0.1 2.5\n0.2 3.5 0.3 1.5\n0.4 0.5 0.5 0.2\n";
    let expected = "its lines seem to hold 2 pairs of a time and a value; write one pair a line";
    assert_eq!(said(text).as_deref(), Some(expected));
}

#[test]
fn tables_are_none_of_these() {
    for text in [
        "",
        "0 1\n1 2\n2 3\n",
        "a b c d e\n1 2 3 4 5\n6 5 4 3 2\n1 1 1 1 1\n",
        "0 1 2 3 4\n1 3 2 1 0\n2 1 1 1 1\n",
        "0,1,2,3,4\n0,3,2,1,0\n0,1,1,1,1\n",
        "9 1 2 3\n8 3 2 1\n7 1 1 1\n",
        "# (5F10.5)\n1 2\n2 3\n",
    ] {
        assert_eq!(said(text), None, "{text}");
    }
}
