//! Criterion benches live in `benches/*.rs` beside this file.
