//! Where a test says so, the bytes are those of arrow-csv 59.3.2, which wrote and read these files before.

use std::io::BufReader;
use std::slice;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{
    ArrayRef, BooleanArray, Float32Array, Float64Array, Int8Array, Int64Array, RecordBatch,
    StringArray, UInt32Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};

use super::*;

fn batch(columns: Vec<ArrayRef>) -> RecordBatch {
    let names = ["a", "b", "c", "d", "e", "f"].into_iter();
    RecordBatch::try_from_iter_with_nullable(names.zip(columns).map(|(name, it)| (name, it, true)))
        .unwrap()
}

fn written(columns: Vec<ArrayRef>) -> String {
    let mut text = Vec::new();
    write_rows(&mut text, &batch(columns)).unwrap();
    String::from_utf8(text).unwrap()
}

fn schema(kinds: &[DataType]) -> SchemaRef {
    let fields = kinds.iter().zip(["a", "b", "c", "d", "e", "f"]);
    let fields = fields.map(|(kind, name)| Field::new(name, kind.clone(), true));
    Arc::new(Schema::new(fields.collect::<Vec<_>>()))
}

/// All rows of a text in one batch, or the message of the first fault.
fn rows(text: &[u8], schema: &SchemaRef) -> Result<RecordBatch, String> {
    let mut reader = Reader::new(text, schema.clone(), 1000);
    let rows = reader.next().unwrap_or_else(|| Ok(RecordBatch::new_empty(schema.clone())));
    rows.map_err(said)
}

fn said(fault: ArrowError) -> String {
    match fault {
        ArrowError::CsvError(said) | ArrowError::ParseError(said) => said,
        other => other.to_string(),
    }
}

/// The cells of a text of that many columns, a missing one as an empty text.
fn texts(text: &[u8], columns: usize) -> Result<Vec<Vec<String>>, String> {
    let rows = rows(text, &schema(&vec![DataType::Utf8; columns]))?;
    let cell = |row: usize, column: &ArrayRef| column.as_string::<i32>().value(row).to_owned();
    let row = |row| rows.columns().iter().map(|column| cell(row, column)).collect();
    Ok((0..rows.num_rows()).map(row).collect())
}

fn floats(text: &[u8]) -> Result<Vec<Option<f64>>, String> {
    let rows = rows(text, &schema(&[DataType::Float64]))?;
    Ok(rows.column(0).as_primitive::<Float64Type>().iter().collect())
}

#[test]
fn numbers_are_as_short_as_they_read_back() {
    // As arrow-csv wrote them. 2^50 + 1/4 lies midway between two numbers of 17 digits, and takes the even one; so
    // does 2^50 + 3/4.
    let cases = [
        (0.0, "0.0"),
        (-0.0, "-0.0"),
        (-2.5, "-2.5"),
        (0.1, "0.1"),
        (1.0 / 3.0, "0.3333333333333333"),
        (1e-4, "0.0001"),
        (1e-5, "0.00001"),
        (9.999999999999999e-6, "9.999999999999999e-6"),
        (1e-7, "1e-7"),
        (123456789.0, "123456789.0"),
        (1e15, "1000000000000000.0"),
        (9999999999999998.0, "9999999999999998.0"),
        (1e16, "1e16"),
        (-1.5e300, "-1.5e300"),
        (f64::MAX, "1.7976931348623157e308"),
        (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
        (5e-324, "5e-324"),
        (2f64.powi(50) + 0.25, "1125899906842624.2"),
        (2f64.powi(50) + 0.75, "1125899906842624.8"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (f64::NEG_INFINITY, "-inf"),
    ];
    let values: Float64Array = cases.iter().map(|(value, _)| Some(*value)).collect();
    let text = written(vec![Arc::new(values)]);
    assert_eq!(text.lines().collect::<Vec<_>>(), cases.map(|(_, text)| text));
    for (read, (value, _)) in floats(text.as_bytes()).unwrap().into_iter().zip(cases) {
        assert_eq!(read.map(f64::to_bits), Some(value.to_bits()));
    }
}

#[test]
fn any_bits_of_a_number_are_read_back() {
    // A linear congruential sequence with Knuth's multiplier: all exponents occur.
    let mut bits = 1u64;
    let mut next = || {
        bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        f64::from_bits(bits)
    };
    let values: Vec<f64> = (0..1000).map(|_| next()).filter(|value| !value.is_nan()).collect();
    let text = written(vec![Arc::new(Float64Array::from(values.clone()))]);
    let read = floats(text.as_bytes()).unwrap();
    assert_eq!(read.len(), values.len());
    for (read, value) in read.into_iter().zip(values) {
        assert_eq!(read.map(f64::to_bits), Some(value.to_bits()));
    }
}

#[test]
fn every_type_of_a_table_is_written_and_read_back() {
    let columns: Vec<ArrayRef> = vec![
        Arc::new(UInt32Array::from(vec![Some(0), Some(u32::MAX), None])),
        Arc::new(Int64Array::from(vec![Some(i64::MIN), None, Some(i64::MAX)])),
        Arc::new(Int8Array::from(vec![None, Some(-128), Some(127)])),
        Arc::new(BooleanArray::from(vec![Some(true), Some(false), None])),
        Arc::new(Float64Array::from(vec![None, Some(0.5), None])),
        Arc::new(StringArray::from(vec![None, Some(" a b "), Some("é")])),
    ];
    let text = written(columns.clone());
    assert_eq!(
        text,
        "0,-9223372036854775808,,true,,\n\
         4294967295,,-128,false,0.5, a b \n\
         ,9223372036854775807,127,,,é\n"
    );
    let rows = rows(text.as_bytes(), &batch(columns.clone()).schema()).unwrap();
    assert_eq!(rows, batch(columns));
}

#[test]
fn a_text_is_in_quotes_only_where_it_must_be() {
    // Sections 2.6 and 2.7 of RFC 4180; a text in one column that is empty would be an empty line.
    let values = ["a", "a b", "#;'\t", "a,b", "a\nb", "\r", "a\"b", "\"", ""];
    let text = written(vec![Arc::new(StringArray::from(values.to_vec()))]);
    let quoted = "a\na b\n#;'\t\n\"a,b\"\n\"a\nb\"\n\"\r\"\n\"a\"\"b\"\n\"\"\"\"\n\"\"\n";
    assert_eq!(text, quoted);
    assert_eq!(texts(text.as_bytes(), 1).unwrap().concat(), values);
}

#[test]
fn many_rows_are_written_in_pieces() {
    let rows: StringArray = (0..5000).map(|row| Some(format!("row {row}"))).collect();
    let expected: String = (0..5000).map(|row| format!("row {row}\n")).collect();
    assert_eq!(written(vec![Arc::new(rows)]), expected);
    assert_eq!(written(vec![Arc::new(Float64Array::from(Vec::<f64>::new()))]), "");
}

#[test]
fn other_types_are_refused() {
    let mut text = Vec::new();
    let single = batch(vec![Arc::new(Float32Array::from(vec![1.0]))]);
    let fault = write_rows(&mut text, &single).unwrap_err();
    assert_eq!(fault.to_string(), "a column of Float32 cannot be written as text with commas");
    let fault = rows(b"1\n", &schema(&[DataType::Float32])).unwrap_err();
    assert_eq!(fault, "Unsupported data type Float32");
}

#[test]
fn the_examples_of_rfc_4180_are_read() {
    let expected = vec![vec!["aaa", "bbb", "ccc"], vec!["zzz", "yyy", "xxx"]];
    // Sections 2.1, 2.2 and 2.5; then line breaks of other systems and empty lines, as arrow-csv read them.
    for text in [
        "aaa,bbb,ccc\r\nzzz,yyy,xxx\r\n",
        "aaa,bbb,ccc\r\nzzz,yyy,xxx",
        "\"aaa\",\"bbb\",\"ccc\"\r\nzzz,yyy,xxx",
        "aaa,bbb,ccc\nzzz,yyy,xxx\n",
        "aaa,bbb,ccc\rzzz,yyy,xxx\r",
        "\u{feff}aaa,bbb,ccc\nzzz,yyy,xxx\n",
        "\n\r\naaa,bbb,ccc\n\n\r\n\rzzz,yyy,xxx\n\n",
    ] {
        assert_eq!(texts(text.as_bytes(), 3).unwrap(), expected, "{text:?}");
    }
    // Sections 2.6 and 2.7.
    let broken = texts(b"\"aaa\",\"b\r\nbb\",\"ccc\"\r\nzzz,yyy,xxx", 3).unwrap();
    assert_eq!(broken, vec![vec!["aaa", "b\r\nbb", "ccc"], vec!["zzz", "yyy", "xxx"]]);
    let doubled = texts(b"\"aaa\",\"b\"\"bb\",\"ccc\"", 3).unwrap();
    assert_eq!(doubled, vec![vec!["aaa", "b\"bb", "ccc"]]);
}

#[test]
fn quotes_in_odd_places_are_read_as_before() {
    // What RFC 4180 does not allow, as arrow-csv read it.
    for (text, expected) in [
        ("a\"b\",c", ["a\"b\"", "c"]),
        ("\"a\"b,c", ["ab", "c"]),
        ("\"a\"b\"c\",d", ["ab\"c\"", "d"]),
        (" \"a\",b", [" \"a\"", "b"]),
        ("a,\"b\nc", ["a", "b\nc"]),
        ("a,", ["a", ""]),
        ("\"\",\"\"\"", ["", "\""]),
        (",", ["", ""]),
    ] {
        assert_eq!(texts(text.as_bytes(), 2).unwrap(), [expected], "{text:?}");
    }
    assert!(texts(b"", 2).unwrap().is_empty());
    assert!(texts(b"\xef\xbb\xbf", 2).unwrap().is_empty());
}

#[test]
fn a_source_in_pieces_is_read_as_a_whole() {
    let text = b"\"a\"\"b\",\r\n\n\"c,d\re\",f\"g\r\"\",h";
    let kinds = schema(&[DataType::Utf8, DataType::Utf8]);
    let whole = rows(text, &kinds).unwrap();
    assert_eq!(whole.num_rows(), 3);
    for size in 1..text.len() {
        let source = BufReader::with_capacity(size, &text[..]);
        let batches: Vec<RecordBatch> =
            Reader::new(source, kinds.clone(), 1000).collect::<Result<_, _>>().unwrap();
        assert_eq!(batches, slice::from_ref(&whole), "{size}");
    }
}

#[test]
fn numbers_are_read_in_the_syntax_of_before() {
    // As arrow-csv read them.
    for (text, value) in [
        ("1", 1.0),
        ("+1.", 1.0),
        ("-.5e-3", -0.5e-3),
        ("1E+05", 1e5),
        (" \t1 ", 1.0),
        ("1e400", f64::INFINITY),
        ("-Infinity", f64::NEG_INFINITY),
        ("INF", f64::INFINITY),
        ("1e-400", 0.0),
        ("9007199254740993", 9007199254740992.0),
    ] {
        assert_eq!(floats(text.as_bytes()).unwrap(), [Some(value)], "{text:?}");
    }
    assert!(floats(b"nAn").unwrap()[0].unwrap().is_nan());
    for text in
        [".", "+", "e5", "1e", "1e+", "1 2", "1_000", "0x1F", "1d5", "--1", "\u{a0}1", "\u{b}1"]
    {
        let fault = floats(text.as_bytes()).unwrap_err();
        assert!(fault.contains("as type 'Float64'"), "{text:?}: {fault}");
    }
}

#[test]
fn other_values_are_read_in_the_syntax_of_before() {
    // As arrow-csv read them: whole numbers within their type, truths in any case of letters.
    let read = |text: &str, kind| rows(text.as_bytes(), &schema(&[kind])).is_ok();
    for (kind, good, bad) in [
        (DataType::Int8, ["-128", "+127 "], ["128", "1.0"]),
        (DataType::UInt32, ["-0", "4294967295"], ["-1", "4294967296"]),
        (DataType::Int64, ["9223372036854775807", " 007"], ["9223372036854775808", "-"]),
        (DataType::Boolean, ["TRUE", "false"], ["1", "true "]),
    ] {
        for text in good {
            assert!(read(text, kind.clone()), "{text:?}");
        }
        for text in bad {
            assert!(!read(text, kind.clone()), "{text:?}");
        }
    }
}

#[test]
fn a_fault_is_told_with_its_place() {
    // In the words and with the counts of arrow-csv: lines from 1 in the first three, from 0 in the others.
    let two = schema(&[DataType::Float64, DataType::Float64]);
    for (text, expected) in [
        ("1,2\n3\n", "incorrect number of fields for line 2, expected 2 got 1"),
        ("1,2\n3,4,5,6\n", "incorrect number of fields for line 2, expected 2 got 4"),
        ("x,2\n3\n", "incorrect number of fields for line 2, expected 2 got 1"),
        (
            "1,2\n3,x\n",
            "Error while parsing value 'x' as type 'Float64' for column 1 at line 1. Row data: '[3,x]'",
        ),
        (
            "1,y\nx,2\n",
            "Error while parsing value 'x' as type 'Float64' for column 0 at line 1. Row data: '[x,2]'",
        ),
    ] {
        assert_eq!(rows(text.as_bytes(), &two).unwrap_err(), expected, "{text:?}");
    }
    let fault = rows(b"1,2\n3,\xff\n", &two).unwrap_err();
    assert_eq!(fault, "Encountered invalid UTF-8 data for line 2 and field 2");
    // Half a letter in one field, the other half in the next.
    let fault = texts(b"a,b\n\xc3,\xa9\n", 2).unwrap_err();
    assert_eq!(fault, "Encountered invalid UTF-8 data for line 2 and field 1");
    let needed = Schema::new(vec![Field::new("a", DataType::Float64, false)]);
    let fault = rows(b"1\n\"\"\n", &Arc::new(needed)).unwrap_err();
    assert!(fault.contains("Column 'a' is declared as non-nullable"), "{fault}");
}

#[test]
fn lines_are_counted_through_all_batches() {
    let mut reader = Reader::new(&b"1\n2\n3\n4\nx\n"[..], schema(&[DataType::Float64]), 2);
    let read = |rows: Option<Result<RecordBatch, ArrowError>>| rows.unwrap().map_err(said);
    assert_eq!(read(reader.next()).unwrap().num_rows(), 2);
    assert_eq!(read(reader.next()).unwrap().num_rows(), 2);
    let fault = read(reader.next()).unwrap_err();
    assert!(fault.contains("value 'x'") && fault.contains("at line 4."), "{fault}");
}

#[test]
fn the_first_record_names_columns_of_numbers() {
    let mut reader =
        Reader::of_numbers(&b"\n mass ,\"x,y\"\r\n0.5,1\n2,x\n"[..], 1).map_err(said).unwrap();
    let named = reader.schema();
    let names: Vec<&String> = named.fields().iter().map(|field| field.name()).collect();
    assert_eq!(names, ["mass", "x,y"]);
    let rows = reader.next().unwrap().unwrap();
    assert_eq!(rows.column(0).as_primitive::<Float64Type>().values(), &[0.5]);
    // The header counts as a line.
    let fault = reader.next().unwrap().map_err(said).unwrap_err();
    assert!(fault.contains("for column 1 at line 2."), "{fault}");
    for text in ["", "\n\n", "a,b", "a,b\n"] {
        let mut reader = Reader::of_numbers(text.as_bytes(), 1).map_err(said).unwrap();
        assert_eq!(reader.schema().fields().len(), if text.contains('a') { 2 } else { 0 });
        assert!(reader.next().is_none(), "{text:?}");
    }
    let Err(fault) = Reader::of_numbers(&b"a,b\xff\n1,2\n"[..], 1) else { panic!("a name") };
    assert_eq!(
        said(fault),
        "Encountered UTF-8 error while reading CSV file: invalid utf-8: invalid UTF-8 in field 1 near \
         byte index 1 at line 1"
    );
}
