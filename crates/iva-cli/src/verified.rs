//! `iva run --verify`: the errors of a run, printed and written.

use std::fmt::Write;
use std::path::Path;

use iva_store::output::Output;
use iva_store::table_file::part_schema;
use iva_sweep::columns::columns;
use iva_sweep::study::Table;
use iva_sweep::units::UnitSystem;
use iva_verify::{Finding, Verification};

use crate::cell::significant;
use crate::error::Error;
use crate::layout::wrap;

/// Writes a table of errors for each table of the run.
///
/// # Errors
/// [`Error::Study`] if one cannot be written.
pub(crate) fn write_errors(output: &mut Output, verification: &Verification) -> Result<(), Error> {
    for (table, errors) in &verification.errors {
        output.write_errors(*table, part_schema(&errors.schema(), &(0..1)), errors)?;
    }
    Ok(())
}

/// The report of a verification: agreement and largest error of each table.
pub(crate) fn print_verified(verification: &Verification, units: UnitSystem, dir: &Path) -> String {
    let mut out = String::from("\nVerified by a second run in numbers of twice the precision:\n");
    // Writing to a String cannot fail.
    let full = verification.findings.iter().filter(|finding| finding.rows != [0, 0]);
    for finding in full {
        let _ = writeln!(out, "{}", line(finding, units));
    }
    if let Some(differs) = verification.findings.iter().find(|finding| !finding.agrees()) {
        let [rows, exact] = differs.rows;
        let sentence = format!(
            "The runs differ in what happens: {} has {rows} rows, the second run {exact}, and the \
             first {} are alike. Beyond them rounding decides what comes next.",
            differs.table, differs.alike
        );
        let _ = writeln!(out, "{}", wrap(&sentence));
    }
    let errors = dir.join("errors");
    let _ = writeln!(out, "The errors of all numbers are in {}.", errors.display());
    out
}

fn line(finding: &Finding, units: UnitSystem) -> String {
    let name = format!("{}:", finding.table);
    let alike = format!("{} of {} rows alike", finding.alike, finding.rows[0]);
    let most = finding.largest.map_or_else(String::new, |(error, column)| {
        let unit = unit_of(finding.table, column, units);
        format!(", errors up to {} {unit}({column})", significant(error, 2))
    });
    format!("  {name:12} {alike}{most}")
}

/// The unit of a column and a blank, or nothing if it is 1 or too long for a line.
fn unit_of(table: Table, column: &str, units: UnitSystem) -> String {
    let quantity = columns(table).iter().find(|it| it.name == column).map(|it| it.quantity);
    match quantity.map(|quantity| units.unit(quantity)) {
        Some(unit) if unit != "1" && unit.chars().count() <= 8 => format!("{unit} "),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use arrow_array::cast::AsArray;
    use arrow_array::types::Float64Type;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use crate::main_with_args;

    const STUDY: &str = "version = 1\n[absorber]\nkind = \"siva\"\nmass_ratio = 0.1\n\
        restitution = 0.5\nrelative_clearance = 0.6\n[start]\ndisplacement = 1.0\n\
        [run]\nperiods = 5\n";

    #[test]
    fn errors_are_written_beside_the_tables_and_replaced_with_them() {
        let root = tempfile::tempdir().unwrap();
        let (study, out) = (root.path().join("my.toml"), root.path().join("out"));
        fs::write(&study, STUDY).unwrap();
        let run = |more: &[&str]| {
            let mut args: Vec<std::ffi::OsString> = vec!["iva".into(), "run".into()];
            args.extend([study.clone().into(), "--out".into(), out.clone().into()]);
            args.extend(["--quiet"].iter().chain(more).map(Into::into));
            main_with_args(args)
        };
        let part = |folder: &str| out.join(folder).join("part-00000.parquet");
        assert_eq!(run(&["--verify"]), 0);
        let times = |folder: &str| -> Vec<f64> {
            let file = fs::File::open(part(folder)).unwrap();
            let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
            let batch = reader.build().unwrap().next().unwrap().unwrap();
            let times = batch.column_by_name("time").unwrap();
            times.as_primitive::<Float64Type>().values().to_vec()
        };
        let errors = times("errors/impacts");
        assert_eq!(errors.len(), times("impacts").len());
        assert!(errors.iter().any(|error| *error != 0.0));
        assert!(errors.iter().all(|error| error.abs() < 1e-12), "{errors:?}");
        // Refused and untouched without --overwrite; with it errors of an old run do not stay.
        assert_eq!(run(&[]), 2);
        assert!(part("errors/summary").exists());
        assert_eq!(run(&["--overwrite"]), 0);
        assert!(part("summary").exists() && !out.join("errors").exists());
    }
}
