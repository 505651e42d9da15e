//! Any bytes as a recorded history, in columns or as PEER AT2.

#![no_main]

use std::path::Path;

use iva_core::force::History;
use iva_fuzz::refusal;
use iva_study::record_file::{RecordFile, parse_record};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for name in ["record.csv", "record.at2"] {
        match parse_record(Path::new(name), bytes) {
            Ok(record) => check(record),
            Err(error) => refusal::check(error),
        }
    }
});

fn check(record: RecordFile) {
    let RecordFile { times, values, .. } = record;
    assert!(times.len() >= 2 && times.len() == values.len());
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(times.iter().chain(&values).all(|number| number.is_finite()));
    if let Err(invalid) = History::new(times, values) {
        refusal::check_invalid(&invalid);
    }
}
