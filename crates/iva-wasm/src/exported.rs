//! The functions that JavaScript calls.
//!
//! A name that a linker can find needs the word `unsafe` in Rust, because two libraries could export the same one. No
//! function reads memory that it does not own: texts come through a buffer of this module.
#![allow(unsafe_code)]

use std::sync::{Mutex, PoisonError};

use iva_sweep::Invalid;

use crate::fused::rounds_once;
use crate::json::object;
use crate::map::map;
use crate::run::{Columns, placed, run};
use crate::scene::{Scene, checked, error};
use crate::words::described;

/// What stays in memory between two calls.
struct Kept {
    given: Vec<u8>,
    answer: String,
    columns: Columns,
}

static KEPT: Mutex<Kept> =
    Mutex::new(Kept { given: Vec::new(), answer: String::new(), columns: Vec::new() });

/// Answers with what is made of the text that was given.
fn answer(make: impl FnOnce(&str) -> Result<(String, Columns), Invalid>) {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let given = String::from_utf8_lossy(&kept.given).into_owned();
    (kept.answer, kept.columns) = match make(&given) {
        Ok(made) => made,
        Err(invalid) => (object([("error", error(&invalid))]), Columns::new()),
    };
}

/// The place to which a text of so many bytes is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn iva_given(length: usize) -> *mut u8 {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    kept.given.clear();
    kept.given.resize(length, 0);
    kept.given.as_mut_ptr()
}

/// The place of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn iva_answer() -> *const u8 {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).answer.as_ptr()
}

/// The number of bytes of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn iva_answer_length() -> usize {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner).answer.len()
}

/// Answers whether products and sums are rounded once: 1, or 0 if what the page has put in the place of `fma` does not.
#[unsafe(no_mangle)]
pub extern "C" fn iva_rounds_once() -> u32 {
    u32::from(rounds_once())
}

/// Answers with all fields, choices and measures.
#[unsafe(no_mangle)]
pub extern "C" fn iva_describe() {
    answer(|_| Ok((described(), Columns::new())));
}

/// Checks the scene that was given, and answers with its units, its natural frequency and its absorbers.
#[unsafe(no_mangle)]
pub extern "C" fn iva_check() {
    answer(|given| Ok((checked(&Scene::read(given)?.spec)?, Columns::new())));
}

/// Runs the scene that was given, and answers with its tables; `errors` ≠ 0: with the estimated errors of its impact times.
#[unsafe(no_mangle)]
pub extern "C" fn iva_run(samples_per_period: u32, errors: u32) {
    answer(|given| run(&Scene::read(given)?, samples_per_period, errors != 0));
}

/// Answers with the measure of the scene that was given at all points of its axes, and where it is.
#[unsafe(no_mangle)]
pub extern "C" fn iva_map() {
    answer(|given| {
        let mut columns = Columns::new();
        let place = placed(map(Scene::read(given)?)?, &mut columns);
        Ok((object([("map", place)]), columns))
    });
}
