//! File names for points and records of a study made in a program.

use std::path::Path;
use std::sync::Arc;

use iva_store::inputs::{INPUTS, Input};
use iva_sweep::forces::Selection;
use iva_sweep::sampling::Sampling;

use crate::study_file::StudyFile;

/// Largest number of points that are written out in the study itself.
const FEW: usize = 1000;

/// The study with file names for its unnamed points and records, and these files. Inputs that are read from
/// the folder of the result itself are written again, since they are removed with the tables they replace.
pub(crate) fn named(file: &StudyFile, dir: &Path) -> (StudyFile, Vec<Input>) {
    let mut named = file.clone();
    let mut inputs = Vec::new();
    let own = dir.canonicalize().map(|dir| dir.join(INPUTS));
    let unnamed = |file: &Option<String>| match (file, &own) {
        (None, _) => true,
        (Some(file), Ok(own)) => Path::new(file).starts_with(own),
        _ => false,
    };
    for (number, recorded) in named.study.spec.records_mut().enumerate() {
        if unnamed(&recorded.file) {
            let input = Input::record(number, Arc::clone(&recorded.history));
            recorded.file = Some(input.name().to_owned());
            recorded.selection = Selection::default();
            inputs.push(input);
        }
    }
    if let Sampling::Rows(rows) = &mut named.study.sampling
        && unnamed(&rows.file)
        && rows.axes().iter().any(|axis| axis.values.len() > FEW)
    {
        let input = Input::points(rows.clone());
        rows.file = Some(input.name().to_owned());
        inputs.push(input);
    }
    (named, inputs)
}
