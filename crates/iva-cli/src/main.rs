//! The native `iva` binary.

use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(sentence) = iva_cli::processor::lacking() {
        eprintln!("{sentence}");
        return ExitCode::FAILURE;
    }
    let code = iva_cli::main_with_args(std::env::args_os().collect());
    ExitCode::from(u8::try_from(code).unwrap_or(1))
}
