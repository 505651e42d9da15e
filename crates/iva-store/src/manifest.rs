//! The manifest `manifest.json`: the description of a result, and the list of its complete parts.
//!
//! A sweep rewrites it, under another name and then renamed, after every part of the first few hundred, and less
//! often after that. A listed part is complete and has the stated checksums; a part that is not listed counts
//! as missing, whatever the folder holds. A single run has one part. A manifest may come from any source, so
//! nothing in it is used before [`Manifest::parse`] has checked all of it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use iva_sweep::identity::Identity;
use iva_sweep::plan::{MAX_PART_POINTS, Plan};
use iva_sweep::study::{Study, Table};
use serde::{Deserialize, Serialize};

use crate::folder::{errors_folder, part_name};
use crate::inputs::is_input_name;
use crate::table_file::{Contents, Style};

/// Version of the manifest's layout.
pub const MANIFEST_VERSION: u32 = 1;
/// Largest number of parts of a sweep; at one second each they take half a year.
const MOST_PARTS: u64 = 1 << 24;

/// The manifest of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the manifest's layout.
    pub manifest: u32,
    /// Version of the program.
    pub iva: String,
    /// Digest of everything that determines the values, which files carry under `iva.study`.
    pub study: String,
    /// Keys of the swept quantities.
    pub swept: Vec<String>,
    /// Number of points of the sweep.
    pub points: u64,
    /// Number of points of a part; the last part may have fewer.
    pub part_points: u64,
    /// Names of the tables.
    pub tables: Vec<String>,
    /// Files of points and records beside the tables, relative to the folder.
    pub inputs: Vec<String>,
    /// File format of the tables.
    #[serde(flatten)]
    pub style: Style,
    /// Complete parts by number.
    pub parts: BTreeMap<u64, Part>,
}

/// The entry of a complete part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Number of the first point of the part.
    pub first_point: u64,
    /// Number of points of the part.
    pub points: u64,
    /// Number of points with another outcome than `finished`.
    pub failed: u64,
    /// Files of the tables, by the name of the table.
    pub tables: BTreeMap<String, Contents>,
    /// Files of the errors of a verified run, by the name of the table.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub errors: BTreeMap<String, Contents>,
}

impl Manifest {
    /// The manifest of a sweep without complete parts.
    pub fn new(study: &Study, identity: Identity, plan: Plan, style: Style) -> Self {
        Self {
            manifest: MANIFEST_VERSION,
            iva: env!("CARGO_PKG_VERSION").to_owned(),
            study: identity.to_string(),
            swept: study.sampling.keys().map(|swept| swept.key.to_owned()).collect(),
            points: plan.points,
            part_points: plan.part_points,
            tables: sweep_tables(study).map(|table| table.name().to_owned()).collect(),
            inputs: Vec::new(),
            style,
            parts: BTreeMap::new(),
        }
    }

    /// The manifest of a single run, whose one part lists all of its files.
    pub fn of_run(study: &Study, identity: Identity, style: Style, part: Part) -> Self {
        let tables = part.tables.keys().cloned().collect();
        let plan = Plan { points: 1, part_points: 1 };
        let parts = BTreeMap::from([(0, part)]);
        Self { tables, parts, ..Self::new(study, identity, plan, style) }
    }

    /// Reads and checks the text of a manifest.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let found: Self = serde_json::from_str(text)
            .map_err(|reason| format!("it is no manifest of a result ({reason})"))?;
        if found.manifest != MANIFEST_VERSION {
            return Err(format!(
                "it has layout {}, this version of iva reads {MANIFEST_VERSION}",
                found.manifest
            ));
        }
        match found.fault() {
            None => Ok(found),
            Some(fault) => Err(fault.to_owned()),
        }
    }

    /// A copy of the manifest with one part only.
    pub(crate) fn with_only(&self, number: u64, part: Part) -> Self {
        Self {
            manifest: self.manifest,
            iva: self.iva.clone(),
            study: self.study.clone(),
            swept: self.swept.clone(),
            points: self.points,
            part_points: self.part_points,
            tables: self.tables.clone(),
            inputs: self.inputs.clone(),
            style: self.style,
            parts: BTreeMap::from([(number, part)]),
        }
    }

    /// The first contradiction or impossible value in the manifest; `None` for a valid one.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let plan = self.plan();
        let plain =
            |text: &str| text.len() <= 64 && text.bytes().all(|byte| byte.is_ascii_graphic());
        let is_digest = |digits: &str, count| {
            digits.len() == count && digits.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
        };
        if !plain(&self.iva) || !is_digest(&self.study, 16) {
            return Some("its version of iva or its digest of the study is none");
        }
        let tables: BTreeSet<&str> = self.tables.iter().map(String::as_str).collect();
        if tables.len() != self.tables.len()
            || tables.iter().any(|it| Table::from_name(it).is_none())
        {
            return Some("its tables are not those of a result");
        }
        let inputs: BTreeSet<&String> = self.inputs.iter().collect();
        if inputs.len() != self.inputs.len() || !inputs.iter().all(|name| is_input_name(name)) {
            return Some("its inputs are not those of a result");
        }
        let divisible = (1..=MAX_PART_POINTS).contains(&plan.part_points);
        if !divisible || plan.points == 0 || plan.parts() > MOST_PARTS {
            return Some("its points cannot be divided as it says");
        }
        let fits = |(number, part): (&u64, &Part)| {
            let end = part.first_point.checked_add(part.points);
            let mut contents = part.tables.values().chain(part.errors.values());
            *number < plan.parts()
                && end.is_some_and(|end| plan.range(*number) == (part.first_point..end))
                && part.failed <= part.points
                && part.tables.keys().map(String::as_str).eq(tables.iter().copied())
                && part.errors.keys().all(|table| tables.contains(table.as_str()))
                && contents.all(|contents| is_digest(&contents.sha256, 64))
        };
        (!self.parts.iter().all(fits)).then_some("its parts do not fit its points")
    }

    /// The files of the complete parts, relative to the folder.
    pub(crate) fn files(&self) -> impl Iterator<Item = (PathBuf, &Contents)> {
        let format = self.style.format;
        self.parts.iter().flat_map(move |(number, part)| {
            let name = part_name(*number, format);
            let errors = part.errors.iter().map(|(table, it)| (errors_folder(table), it));
            let tables = part.tables.iter().map(|(table, it)| (Path::new(table).to_owned(), it));
            tables.chain(errors).map(move |(folder, contents)| (folder.join(&name), contents))
        })
    }

    /// The text of the manifest as JSON.
    pub fn text(&self) -> String {
        // Strings, numbers and maps with such keys are valid in JSON, so this cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The identity of the study, which the files of its tables carry; a digest that is not hexadecimal counts as 0.
    pub fn identity(&self) -> Identity {
        let digest = u64::from_str_radix(&self.study, 16).unwrap_or(0);
        Identity { digest, points: self.points }
    }

    /// The division of the sweep into parts.
    pub fn plan(&self) -> Plan {
        Plan { points: self.points, part_points: self.part_points }
    }

    /// Numbers of the parts that are not complete, in ascending order.
    pub fn missing(&self) -> impl Iterator<Item = u64> + '_ {
        (0..self.plan().parts()).filter(|part| !self.parts.contains_key(part))
    }

    /// True if every part is complete.
    pub fn is_complete(&self) -> bool {
        self.parts.len() as u64 == self.plan().parts()
    }

    /// Number of points of the complete parts.
    pub fn done(&self) -> u64 {
        self.parts.values().map(|part| part.points).sum()
    }

    /// Number of files, rows and bytes of a table in the complete parts.
    pub fn total(&self, table: &str) -> Total {
        let mut total = Total::default();
        for contents in self.parts.values().filter_map(|part| part.tables.get(table)) {
            total.files += 1;
            total.rows += contents.rows;
            total.bytes += contents.bytes;
        }
        total
    }

    /// Differences between two sweeps in version, tables and format, one sentence each; the studies are not compared.
    pub fn differences(&self, now: &Self) -> Vec<String> {
        let style = |style: Style| match style.units_row {
            true => format!("{} with a row of units", style.format),
            false => style.format.to_string(),
        };
        let mut found = Vec::new();
        let mut compare = |what: &str, was: String, is: String| {
            if was != is {
                found.push(format!("{what} was {was}, is {is}"));
            }
        };
        compare("the version of iva-dynamics", self.iva.clone(), now.iva.clone());
        compare("the list of tables", self.tables.join(", "), now.tables.join(", "));
        compare("the format", style(self.style), style(now.style));
        found
    }
}

/// Size of a table on disk.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Total {
    /// Number of files.
    pub files: u64,
    /// Number of rows.
    pub rows: u64,
    /// Size of the files in bytes.
    pub bytes: u64,
}

/// The tables of a study that a sweep writes.
pub(crate) fn sweep_tables(study: &Study) -> impl Iterator<Item = Table> + '_ {
    study.tables.iter().copied().filter(|table| Table::SWEEP.contains(table))
}
