//! `iva examples`: copies the studies that come with the program into a folder.

use iva_study::examples::{FILES, copy_into};

use crate::args::ExamplesArgs;
use crate::error::Error;
use crate::layout::wrap;
use crate::report::counted;

/// Copies the files; returns the text to print.
///
/// # Errors
/// As [`copy_into`].
pub(crate) fn examples_command(args: &ExamplesArgs) -> Result<String, Error> {
    let written = copy_into(&args.folder)?.len() as u64;
    let folder = args.folder.display();
    let mut out = match written {
        0 => format!("All {} files are in {folder} already.\n", FILES.len()),
        _ => format!("Written to {folder}: {}.\n", counted(written, "file")),
    };
    let first = args.folder.join("siva_clearance.toml");
    let next =
        format!("Each study says at its top what it asks. Try: iva sweep {}", first.display());
    out.push_str(&wrap(&next));
    out.push('\n');
    Ok(out)
}
