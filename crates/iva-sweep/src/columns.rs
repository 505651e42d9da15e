//! The columns of the tables, and the selection of those to compute. The entries are in `columns/tables.rs`.

use crate::fields::Quantity;
use crate::study::Table;

pub(crate) mod tables;

/// Version of the table layout: columns are only added within a version.
pub const SCHEMA_VERSION: u32 = 1;

/// One column of a result table.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Name in the table.
    pub name: &'static str,
    /// The quantity that it measures, which determines the unit.
    pub quantity: Quantity,
    /// One line of explanation, kept in the Arrow field metadata.
    pub help: &'static str,
    /// The group of measures that must be computed for it.
    pub group: Group,
    /// For a measure that points can be ranked by, whether smaller or larger is better.
    pub better: Option<Better>,
}

/// Groups of columns of `summary` that are computed together: a run computes a group if one of its columns is
/// wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// The counts and sums of every run.
    Run,
    /// Peaks of the displacement.
    Peaks,
    /// Settling times.
    Settling,
    /// The largest displacement of the last period.
    Residual,
    /// Energies that are integrals along the motion.
    Ledger,
    /// The energy lost in the first period.
    FirstPeriod,
    /// Largest displacement under force.
    Amplitude,
    /// Root mean square of the displacement under force.
    Rms,
    /// The largest displacement, with and without absorber.
    Reduction,
    /// The root mean square of the displacement, with and without absorber.
    RmsReduction,
    /// Largest accelerations of primary and base.
    Acceleration,
    /// Largest acceleration of the structure, also in free decay. Computed only if asked for by name.
    Shaking,
    /// Largest displacements of the absorber. Computed only if asked for by name.
    Travel,
    /// Listed impacts in the window of the steady state.
    ImpactsPerCycle,
    /// The kind of the steady motion.
    Regime,
    /// Estimated errors.
    Errors,
    /// A measure with a pass of its own. Computed only if asked for by name.
    Named,
}

/// Whether a smaller or a larger value of a measure is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Smaller: for settling times, amplitudes.
    Smaller,
    /// Larger: for damping ratios, the reduction.
    Larger,
}

/// The descriptions of the entries of a table.
macro_rules! described {
    ($($name:literal $quantity:ident $([$group:ident $($better:ident)?])? $(|$row:ident| $value:expr)? $(=> $pass:ident)?, $help:literal;)*) => {
        &[$(Column {
            name: $name,
            quantity: Quantity::$quantity,
            help: $help,
            group: first(&[$(Group::$group,)? Group::Run]),
            better: sole(&[$($(Better::$better)?)?]),
        }),*]
    };
}

/// The group of an entry; [`Group::Run`] if it names none.
const fn first(groups: &[Group]) -> Group {
    groups[0]
}

const fn sole(better: &[Better]) -> Option<Better> {
    match better {
        [better] => Some(*better),
        _ => None,
    }
}

/// Summary columns after `point` and the swept parameters.
pub static SUMMARY: &[Column] = tables::summary!(described);
/// Columns of `impacts` after `point`.
pub static IMPACTS: &[Column] = tables::impacts!(described);
/// Columns of `episodes` after `point`.
pub static EPISODES: &[Column] = tables::episodes!(described);
/// Columns of `envelope` after `point`.
pub static ENVELOPE: &[Column] = tables::envelope!(described);
/// Columns of `stroboscope` after `point`.
pub static STROBOSCOPE: &[Column] = tables::stroboscope!(described);
/// Columns of `absorbers` after `point`.
pub static ABSORBERS: &[Column] = tables::absorbers!(described);
/// Columns of the trajectory after `point`.
pub static TRAJECTORY: &[Column] = tables::trajectory!(described);

/// The measures that points can be ranked by.
pub fn ranked() -> impl Iterator<Item = &'static Column> {
    SUMMARY.iter().filter(|column| column.better.is_some())
}

/// The columns of a table after `point` (and, in the summary, the swept parameters).
pub fn columns(table: Table) -> &'static [Column] {
    match table {
        Table::Summary => SUMMARY,
        Table::Impacts => IMPACTS,
        Table::Episodes => EPISODES,
        Table::Envelope => ENVELOPE,
        Table::Stroboscope => STROBOSCOPE,
        Table::Absorbers => ABSORBERS,
        Table::Trajectory => TRAJECTORY,
    }
}

/// The set of summary columns to compute; the others are null. `outcome` is always computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selection(u64);

impl Group {
    /// True if the group is so expensive that it is computed only if one of its columns is asked for by name.
    const fn by_name(self) -> bool {
        matches!(self, Self::Shaking | Self::Travel | Self::Named)
    }
}

impl Default for Selection {
    /// The default: all columns except those that must be asked for by name.
    fn default() -> Self {
        let usual = SUMMARY.iter().enumerate().filter(|(_, column)| !column.group.by_name());
        Self(usual.fold(0, |set, (index, _)| set | (1 << index)))
    }
}

impl Selection {
    /// Every summary column.
    pub fn all() -> Self {
        Self((1 << SUMMARY.len()) - 1)
    }

    /// The named columns.
    ///
    /// # Errors
    /// The first unknown name.
    pub fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        names.into_iter().try_fold(Self(1), |set, name| {
            SUMMARY
                .iter()
                .position(|column| column.name == name)
                .map(|index| Self(set.0 | (1 << index)))
                .ok_or_else(|| name.to_owned())
        })
    }

    /// True if the column is to be computed.
    pub fn contains(self, name: &str) -> bool {
        SUMMARY.iter().position(|column| column.name == name).is_some_and(|index| self.has(index))
    }

    /// True if a column of that group is to be computed.
    pub(crate) fn needs(self, group: Group) -> bool {
        self.of(group).next().is_some()
    }

    /// The columns of a group to compute.
    pub(crate) fn of(self, group: Group) -> impl Iterator<Item = &'static Column> {
        let all = SUMMARY.iter().enumerate();
        all.filter(move |(index, column)| column.group == group && self.has(*index)).map(|it| it.1)
    }

    /// True if the column with this index is to be computed.
    pub(crate) fn has(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }

    /// The columns to compute, in table order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        SUMMARY
            .iter()
            .enumerate()
            .filter(move |(index, _)| self.has(*index))
            .map(|(_, column)| column.name)
    }
}
