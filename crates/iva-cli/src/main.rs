//! The native `iva` binary.

use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(sentence) = iva_cli::processor::lacking() {
        eprintln!("{sentence}");
        return ExitCode::FAILURE;
    }
    // For tests of what a kill leaves behind.
    if let Some(call) = std::env::var("IVA_ABORT_AT").ok().and_then(|at| at.parse().ok()) {
        iva_store::faults::abort_at(call);
    }
    let code = iva_cli::main_with_args(std::env::args_os().collect());
    ExitCode::from(u8::try_from(code).unwrap_or(1))
}
