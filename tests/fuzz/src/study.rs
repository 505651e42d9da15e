//! A study from its text, taken as far as `iva check` takes it before anything is run.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use iva_cli::scene::describe;
use iva_study::resolved::{resolve, write};
use iva_study::{Error, StudyFile, parse_study};
use iva_sweep::identity::Identity;
use iva_sweep::study::Table;
use iva_sweep::sweep::Workers;
use iva_sweep::tables::schema;

/// Beside it stands the record that a study may name.
const NAME: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../studies/any.toml");
/// A grid of more points is looked at in some places only.
const FEW: u64 = 2000;

/// Reads a text.
///
/// # Errors
/// Whatever is refused.
pub fn read(text: &str) -> Result<StudyFile, Error> {
    parse_study(Path::new(NAME), text)
}

/// Checks a study; if it is valid, its resolved form must say the same.
///
/// # Errors
/// Whatever is refused.
pub fn expand(file: &StudyFile) -> Result<(), Error> {
    check(file)?;
    let resolved = resolve(file)?;
    let text = write(&resolved)?;
    let again = match read(&text).and_then(|again| resolve(&again)) {
        Ok(again) => again,
        Err(error) => unreachable!("the resolved study cannot be read: {error}\n{text}"),
    };
    assert_eq!(again.study, resolved.study, "{text}");
    assert_eq!(write(&again)?, text);
    Ok(())
}

fn check(file: &StudyFile) -> Result<(), Error> {
    let points = file.points()?;
    if points <= FEW {
        file.validate(&Workers::new(Some(1))?, &AtomicBool::new(false), &|_| {})?;
    } else {
        for point in (0..points).step_by((points / FEW) as usize).chain([points - 1]) {
            file.study.design(point).map_err(|invalid| file.source.locate(&invalid))?;
        }
    }
    let identity = Identity::of(&file.study)?;
    for table in Table::ALL {
        schema(&file.study, table, identity)?;
    }
    let text = describe(&file.study, points, file.study.units()?);
    let printable = |c: char| c == '\n' || !c.is_control();
    assert!(text.ends_with('\n') && text.chars().all(printable), "{text:?}");
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    Ok(())
}

/// True if a text may name a file to be read: none but those beside the studies are to be opened.
pub fn names_other_files(text: &str) -> bool {
    text.contains("record") && text.contains(['/', '\\'])
}
