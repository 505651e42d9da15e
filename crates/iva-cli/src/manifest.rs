//! `manifest.json`: what a sweep is, and which of its parts are complete.
//!
//! It is written anew, aside and then renamed, after every part. A part that it lists is complete and
//! has the checksums that it states; a part that it does not list is not there, whatever the folder
//! holds.

use std::collections::BTreeMap;

use iva_sweep::identity::Identity;
use iva_sweep::plan::Plan;
use iva_sweep::study::{Study, Table};
use serde::{Deserialize, Serialize};

use crate::table_file::{Contents, Style};

/// Version of the manifest's layout.
pub const MANIFEST_VERSION: u32 = 1;

/// The manifest of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of this layout.
    pub manifest: u32,
    /// Version of the program.
    pub iva: String,
    /// Digest of all that decides the values, as files carry it under `iva.study`.
    pub study: String,
    /// What is swept.
    pub swept: Vec<String>,
    /// Points of the sweep.
    pub points: u64,
    /// Points of a part; the last may have fewer.
    pub part_points: u64,
    /// Tables that are written.
    pub tables: Vec<String>,
    /// Files of points and records that were written along, relative to the folder.
    pub inputs: Vec<String>,
    /// How they are written.
    #[serde(flatten)]
    pub style: Style,
    /// The complete parts by number.
    pub parts: BTreeMap<u64, Part>,
}

/// A complete part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Its first point.
    pub first_point: u64,
    /// Points that it covers.
    pub points: u64,
    /// Those with another outcome than `finished`.
    pub failed: u64,
    /// Its files by the name of the table.
    pub tables: BTreeMap<String, Contents>,
}

impl Manifest {
    /// The manifest of a sweep of which no part is complete.
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

    /// Reads the text of a manifest.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let found: Self = serde_json::from_str(text)
            .map_err(|reason| format!("it is no manifest of a sweep ({reason})"))?;
        if found.manifest != MANIFEST_VERSION {
            return Err(format!(
                "it has layout {}, this version of iva reads {MANIFEST_VERSION}",
                found.manifest
            ));
        }
        let plan = found.plan();
        let fits = plan.part_points > 0
            && found.parts.iter().all(|(number, part)| {
                *number < plan.parts()
                    && part
                        .first_point
                        .checked_add(part.points)
                        .is_some_and(|end| plan.range(*number) == (part.first_point..end))
                    && part.tables.len() == found.tables.len()
                    && found.tables.iter().all(|table| part.tables.contains_key(table))
            });
        if fits { Ok(found) } else { Err("its parts do not fit its points".to_owned()) }
    }

    /// The text of the file.
    pub fn text(&self) -> String {
        // Strings as keys and plain numbers: there is nothing in it that JSON cannot say.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// What its files are told by.
    ///
    /// A digest that is no hexadecimal number is that of no study.
    pub fn identity(&self) -> Identity {
        let digest = u64::from_str_radix(&self.study, 16).unwrap_or(0);
        Identity { digest, points: self.points }
    }

    /// How the sweep is divided.
    pub fn plan(&self) -> Plan {
        Plan { points: self.points, part_points: self.part_points }
    }

    /// The parts that are not complete, in order.
    pub fn missing(&self) -> impl Iterator<Item = u64> + '_ {
        (0..self.plan().parts()).filter(|part| !self.parts.contains_key(part))
    }

    /// True if every part is complete.
    pub fn is_complete(&self) -> bool {
        self.parts.len() as u64 == self.plan().parts()
    }

    /// Points of the complete parts.
    pub fn done(&self) -> u64 {
        self.parts.values().map(|part| part.points).sum()
    }

    /// Files, rows and bytes of a table.
    pub fn total(&self, table: &str) -> Total {
        let mut total = Total::default();
        for contents in self.parts.values().filter_map(|part| part.tables.get(table)) {
            total.files += 1;
            total.rows += contents.rows;
            total.bytes += contents.bytes;
        }
        total
    }

    /// What differs between two sweeps beside their studies; nothing if they are one.
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

/// Files, rows and bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Total {
    /// Number of files.
    pub files: u64,
    /// Rows in them.
    pub rows: u64,
    /// Their size.
    pub bytes: u64,
}

/// The tables of a study that a sweep writes.
pub(crate) fn sweep_tables(study: &Study) -> impl Iterator<Item = Table> + '_ {
    study.tables.iter().copied().filter(|table| Table::SWEEP.contains(table))
}
