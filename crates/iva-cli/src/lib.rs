//! The `iva` command as a library.
//!
//! [`main_with_args`] is the one command line that the native binary and the Python console script
//! share. Below it, in the order of a run: [`args`] (what was asked) → `sweep_command`, `run_command` and
//! `check`, `orbits`, `diagrams` (what each command does, by [`iva_study`] and [`iva_store`], with what they share in
//! `run_study`) → [`report`] (the best points, the measures of a run), [`scene`] (what a study is about)
//! and `verified` (the errors of a run). While it runs, `progress` shows how far it is, `log` writes it
//! down, and `interrupt` listens to Ctrl-C. [`error`] words what went wrong, with the options that help.

pub mod args;
mod carried;
mod cell;
mod changed_field;
mod check;
mod diagrams;
pub mod error;
mod examples;
mod interrupt;
mod layout;
mod log;
mod orbits;
pub mod processor;
mod progress;
pub mod report;
mod run_command;
mod run_study;
pub mod scene;
mod shown;
mod sweep_command;
#[cfg(test)]
mod tests;
mod verified;

use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use clap::Parser;
use iva_store::visible;

pub use error::Error;

use args::{Cli, Command};

/// Exit code of a command that succeeds.
pub const EXIT_OK: i32 = 0;
/// Exit code of a failed read or write, or of an internal fault.
pub const EXIT_FAULT: i32 = 1;
/// Exit code of a bad study, argument or output folder.
pub const EXIT_BAD_INPUT: i32 = 2;
/// Exit code after Ctrl-C or a request to terminate.
pub const EXIT_INTERRUPTED: i32 = 130;

/// Message of `iva reproduce` in the native binary, which has no Python.
const NO_PLOTS: &str = "reproduce draws with Python: pip install 'iva-dynamics[paper]', then run iva \
                        reproduce from there";

/// Message of `iva explore` in the native binary, which has no page.
const NO_PAGE: &str = "explore makes its page with Python: pip install iva-dynamics, then run iva explore \
                       from there";

/// Message of `iva optimise` in the native binary, whose search is SciPy's.
const NO_SEARCH: &str = "optimise searches with SciPy: pip install 'iva-dynamics[optimise]', then run iva optimise \
                         from there";

/// Message of `iva identify` in the native binary, which has no sampler.
const NO_SAMPLER: &str = "identify samples with dynesty: pip install 'iva-dynamics[fit]', then run iva identify \
                          from there";

/// Runs the command line; `args` begins with the program's name. Prints results on standard
/// output, errors and progress on standard error, and returns the exit code: 0 done, 1 I/O or
/// internal fault, 2 bad input, 130 interrupted. Never exits the process itself.
pub fn main_with_args(args: Vec<OsString>) -> i32 {
    // A panic is a fault of this program: it must neither look like bad input nor unwind into a
    // caller of another language.
    catch_unwind(AssertUnwindSafe(|| parse_and_run(args))).unwrap_or(EXIT_FAULT)
}

fn parse_and_run(args: Vec<OsString>) -> i32 {
    // Usage errors quote the arguments, so control characters in these are made visible.
    let shown: Vec<OsString> =
        args.iter().map(|arg| visible(&arg.to_string_lossy()).into()).collect();
    let parsed = Cli::try_parse_from(args)
        .map_err(|usage| Cli::try_parse_from(shown).err().unwrap_or(usage));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version are also such "errors", with exit code 0.
            return match usage.print() {
                Ok(()) => usage.exit_code(),
                Err(reason) if reason.kind() == ErrorKind::BrokenPipe => usage.exit_code(),
                Err(_) => EXIT_FAULT,
            };
        }
    };
    let quiet = match &cli.command {
        Command::Sweep(args) => args.run.quiet,
        Command::Run(args) => args.run.quiet,
        Command::Check(_)
        | Command::Orbit(_)
        | Command::Branch(_)
        | Command::Diagram(_)
        | Command::Basins(_)
        | Command::Optimise(_)
        | Command::Identify(_)
        | Command::Explore(_)
        | Command::Examples(_)
        | Command::Reproduce(_) => false,
    };
    let result = run_command_line(&cli.command);
    match result {
        Ok(_) if quiet => EXIT_OK,
        Ok(text) => print(&text),
        Err(error) => {
            if let Error::Interrupted { report, .. } = &error {
                print(report);
            }
            // If standard error is closed there is nobody left to tell.
            let _ = writeln!(anstream::stderr(), "{}", error.report());
            error.exit_code()
        }
    }
}

/// Runs a command; returns the text to print.
fn run_command_line(command: &Command) -> Result<String, Error> {
    match command {
        Command::Sweep(args) => sweep_command::sweep_command(args),
        Command::Run(args) => run_command::run_command(args),
        Command::Check(args) => check::check_command(args),
        Command::Orbit(args) => orbits::orbit_command(args),
        Command::Branch(args) => orbits::branch_command(args),
        Command::Diagram(args) => diagrams::diagram_command(args),
        Command::Basins(args) => diagrams::basins_command(args),
        Command::Examples(args) => examples::examples_command(args),
        // The console script of the Python package handles these commands before it calls this function.
        Command::Optimise(_) => Err(Error::Refused(NO_SEARCH.to_owned())),
        Command::Identify(_) => Err(Error::Refused(NO_SAMPLER.to_owned())),
        Command::Explore(_) => Err(Error::Refused(NO_PAGE.to_owned())),
        Command::Reproduce(_) => Err(Error::Refused(NO_PLOTS.to_owned())),
    }
}

/// Prints a report. A reader that went away (`iva sweep … | head`) is no fault.
fn print(text: &str) -> i32 {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(visible(text).as_bytes()).and_then(|()| stdout.flush()) {
        Ok(()) => EXIT_OK,
        Err(reason) if reason.kind() == ErrorKind::BrokenPipe => EXIT_OK,
        Err(reason) => {
            let _ = writeln!(std::io::stderr(), "error: cannot print the report: {reason}");
            EXIT_FAULT
        }
    }
}
