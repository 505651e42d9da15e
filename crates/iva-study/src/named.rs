//! Names for the points and records of a study that no file holds.

use std::path::Path;
use std::sync::Arc;

use iva_store::inputs::{INPUTS, Input};
use iva_sweep::sampling::Sampling;

use crate::study_file::StudyFile;

/// More points than this are not written out in the study.
const FEW: usize = 1000;

/// The study with names for what has none, and the files of these names. What is among the inputs of the
/// folder already is written anew: it would go with the tables that are replaced.
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
