//! What a file is that studies do not read, by its content, whatever its name ends with. The Python package asks here
//! too, and reads most of these files.

use super::columns::is_stepped;
use super::{Fault, at2};

/// A kind of file that has no times and values as text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// MATLAB's file of version 5 to 7.
    Mat,
    /// MATLAB's file of version 7.3, which is HDF5.
    MatInHdf5,
    /// LabVIEW's binary file.
    Tdms,
    /// Samples of a sound card.
    Wave,
    /// A universal file.
    Universal,
    /// LabVIEW's measurement file, a text.
    LabViewText,
    /// A processed record of CSMIP or in the COSMOS format.
    StrongMotion,
    /// One that is not processed.
    RawStrongMotion,
    /// HDF5.
    Hdf5,
    /// A ZIP archive.
    Zip,
    /// An array of NumPy.
    Npy,
    /// An old workbook of Excel.
    OldWorkbook,
}

use FileKind::{
    Hdf5, LabViewText, Mat, MatInHdf5, Npy, OldWorkbook, RawStrongMotion, StrongMotion, Tdms,
    Universal, Wave, Zip,
};

/// What files begin with. Those of MATLAB have a text of their own in front of HDF5's mark.
const MARKS: [(&[u8], FileKind); 9] = [
    (b"MATLAB 5.0 MAT-file", Mat),
    (b"MATLAB 7.3 MAT-file", MatInHdf5),
    (b"TDSm", Tdms),
    (b"RIFF", Wave),
    (b"LabVIEW Measurement", LabViewText),
    (b"\x89HDF", Hdf5),
    (b"PK\x03\x04", Zip),
    (b"\x93NUMPY", Npy),
    (b"\xd0\xcf\x11\xe0", OldWorkbook),
];

/// Numbers of the datasets that universal files begin with.
const DATASETS: [&str; 12] =
    ["15", "55", "58", "58b", "82", "151", "164", "2411", "2412", "2414", "2420", "2429"];

/// The first block of a record of strong motion begins within so many lines, and these within so many bytes.
const HEADER_LINES: usize = 250;
const HEADER_BYTES: usize = 1 << 16;

/// What a record of strong motion begins with that was not processed.
const RAW: [&str; 2] = ["uncorrected accel", "raw accel"];

/// What the words begin with that name a quantity.
const QUANTITIES: [&str; 3] = ["accel", "veloc", "displ"];

impl FileKind {
    /// One word, the same in each version.
    pub fn name(self) -> &'static str {
        match self {
            Mat => "mat",
            MatInHdf5 => "mat in hdf5",
            Tdms => "tdms",
            Wave => "wave",
            Universal => "universal",
            LabViewText => "labview text",
            StrongMotion => "strong motion",
            RawStrongMotion => "raw strong motion",
            Hdf5 => "hdf5",
            Zip => "zip",
            Npy => "npy",
            OldWorkbook => "old workbook",
        }
    }

    /// What it is, for a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Mat => "a MAT file",
            MatInHdf5 => "a MAT file of version 7.3, which is HDF5",
            Tdms => "a TDMS file of LabVIEW",
            Wave => "a WAV file",
            Universal => "a universal file",
            LabViewText => "a LabVIEW measurement file (LVM)",
            StrongMotion => "a strong-motion record of CSMIP or COSMOS",
            RawStrongMotion => "a strong-motion record that was not processed (volume 1)",
            Hdf5 => "an HDF5 file",
            Zip => "an Excel workbook, NPZ or other ZIP archive",
            Npy => "an array of NumPy",
            OldWorkbook => "an Excel workbook",
        }
    }

    /// True if the Python package reads such files.
    pub fn is_read_in_python(self) -> bool {
        !matches!(self, MatInHdf5 | RawStrongMotion | Hdf5 | Zip | Npy | OldWorkbook)
    }

    /// Why a study does not read it, and what makes a file of it that a study reads.
    fn refusal(self) -> Fault {
        let words = self.words();
        Fault::missing(match self {
            MatInHdf5 => format!("{words}; save it in MATLAB with '-v7', then {IN_PYTHON}"),
            RawStrongMotion => format!("{words}; give that of volume 2, of which {IN_PYTHON}"),
            _ if self.is_read_in_python() => {
                format!("{words}, which a study does not read; {IN_PYTHON}")
            }
            _ => format!("{words}; save it as text with a time and a value a line"),
        })
    }
}

/// How another file is brought into a study.
pub(super) const IN_PYTHON: &str =
    "iva.Recorded.read(…).write(\"record.csv\") in Python makes a text of it that a study reads";

/// Refuses the contents of a file that is of one of these kinds.
pub(super) fn refuse(contents: &[u8]) -> Result<(), Fault> {
    kind_of_file(contents).map_or(Ok(()), |kind| Err(kind.refusal()))
}

/// The kind of a file with these contents, of which the first lines are enough; `None` for any other text.
pub fn kind_of_file(contents: &[u8]) -> Option<FileKind> {
    let marked = MARKS.iter().find(|(mark, _)| contents.starts_with(mark));
    if let Some((_, kind)) = marked {
        return Some(*kind);
    }
    let begin = String::from_utf8_lossy(&contents[..contents.len().min(HEADER_BYTES)]);
    let mut lines = begin.split(['\n', '\r']).filter(|line| !line.trim().is_empty());
    if is_universal(&begin) {
        return Some(Universal);
    }
    if at2::has_sampling(&begin) || is_stepped(&begin) {
        return None;
    }
    if lines.clone().take(HEADER_LINES).any(is_above_block) {
        return Some(StrongMotion);
    }
    let first = lines.next().unwrap_or_default().trim_start().to_lowercase();
    RAW.iter().any(|words| first.starts_with(words)).then_some(RawStrongMotion)
}

/// True for a mark that ends in column 6, and the number of a dataset below it.
fn is_universal(begin: &str) -> bool {
    let mut lines = begin.lines();
    let is_mark = lines.next().is_some_and(|line| line.trim_end() == "    -1");
    let below = lines.next().filter(|line| line.starts_with(' ')).unwrap_or_default();
    let number = below.split_whitespace().next().unwrap_or_default();
    is_mark && DATASETS.contains(&number)
}

/// True for the line above a block of numbers, of CSMIP: `800 points of accel data equally spaced at .005 sec, …`, or of
/// COSMOS: `800 acceleration pts, approx 4 secs, units=cm/sec2 (04), Format=(8F10.5)`.
fn is_above_block(line: &str) -> bool {
    let line = line.to_lowercase();
    let words: Vec<&str> = line.split_whitespace().collect();
    let quantity = |word: &str| QUANTITIES.iter().any(|begin| word.starts_with(begin));
    let count = |word: &str| word.len() < 10 && word.bytes().all(|c| c.is_ascii_digit());
    match words[..] {
        [number, "points", "of", what, "data", "equally", "spaced", ..] => {
            let step = line.split_once("spaced at").map_or("", |(_, step)| step.trim_start());
            let behind = step.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
            count(number)
                && quantity(what)
                && behind.len() < step.len()
                && behind.trim_start().starts_with("sec")
        }
        [number, what, points, ..] => {
            let stated = |name: &str, text: &str| {
                let mut found = text.match_indices(name).map(|(at, _)| at + name.len());
                found.find(|at| text[*at..].trim_start().starts_with('='))
            };
            let behind = stated("units", &line).map(|at| &line[at..]);
            count(number)
                && quantity(what)
                && points.starts_with("pts,")
                && behind.is_some_and(|text| stated("format", text).is_some())
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests;
