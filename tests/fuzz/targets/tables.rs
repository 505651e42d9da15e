//! Any text as a study whose first point is run.

#![no_main]

use iva_fuzz::{refusal, study, tables};
use libfuzzer_sys::{Corpus, fuzz_target};

fuzz_target!(|text: &str| -> Corpus {
    if study::names_other_files(text) {
        return Corpus::Reject;
    }
    if let Err(error) = study::read(text).and_then(|file| tables::judge(&file)) {
        refusal::check(error);
    }
    Corpus::Keep
});
