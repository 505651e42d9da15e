//! Rows of the result tables, in the user's units. Which columns they have, and what stands in them, is told by
//! [`crate::columns::tables`].

use super::core::impact::Impact;
use super::core::measures::MeasureValues;
use super::core::observe::Episode;
use super::core::peaks::Peak;
use super::core::real::{Real, given};
use super::core::simulate::Tally;
use super::core::steady::{SteadyValues, Strobe};
use super::core::system::Angle;
use super::design::Design;
use super::scale::Scale;
use super::scene::Scene;

use crate::columns::tables as entries;
use crate::columns::{SUMMARY, columns};
use crate::study::{Study, Table};
use crate::tables::{self, cells};

/// One value of a row.
pub(crate) type Cell = tables::Cell<Real>;

/// A run, as a row of `summary` tells it.
pub(crate) struct RunRow<'a, S> {
    pub tally: &'a Tally<S>,
    pub values: &'a MeasureValues,
    pub settled: Option<Settled<'a>>,
    pub condition: Option<Real>,
    pub digits: Option<Real>,
    pub scene: &'a Scene,
    pub scale: &'a Scale,
}

impl<'a, S> RunRow<'a, S> {
    /// A run in free decay, without estimates of its errors.
    pub fn new(design: &'a Design, tally: &'a Tally<S>, values: &'a MeasureValues) -> Self {
        let Design { scene, scale, .. } = design;
        Self { tally, values, settled: None, condition: None, digits: None, scene, scale }
    }

    fn settled<R>(&self, read: impl Fn(&Settled<'a>) -> Option<R>) -> Option<R> {
        self.settled.as_ref().and_then(read)
    }

    /// The row: the point, the swept parameters, then all columns but those that are swept; columns not asked for
    /// are null.
    pub fn cells(&self, study: &Study, point: u64) -> impl Iterator<Item = Cell> {
        let cells: [fn(&Self) -> Cell; SUMMARY.len()] = entries::summary!(cells);
        let columns = columns(Table::Summary).iter().zip(cells).enumerate();
        let kept = columns.filter(|(_, (column, _))| !study.sweeps(column.name));
        let asked_for = kept.map(|(index, (_, cell))| match study.measures.has(index) {
            true => cell(self),
            false => Cell::Null,
        });
        let swept = study.swept(point).into_iter().map(|value| Cell::Number(given(value, false)));
        // Points are counted below 2^32 by `Study::points`.
        std::iter::once(Cell::Point(point as u32)).chain(swept).chain(asked_for)
    }
}

/// What a driven run settles to.
pub(crate) struct Settled<'a> {
    pub values: &'a SteadyValues,
    /// Largest |x| without absorber.
    pub bare: Option<Real>,
    pub moves_base: bool,
}

impl Settled<'_> {
    /// 1 − amplitude over that without absorber; null where the bare structure does not move, or
    /// without bound.
    fn reduction(&self) -> Option<Real> {
        let share = self.values.amplitude_max? / self.bare.filter(|bare| bare.is_finite())?;
        share.is_finite().then_some(1.0 - share)
    }

    fn transmissibility(&self) -> Option<Real> {
        let base = self.values.base_max.filter(|base| self.moves_base && *base > 0.0)?;
        Some(self.values.acceleration_max? / base)
    }
}

/// What is told of the exactness of an impact.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Estimate {
    /// Error of its instant, in natural units.
    pub time: Option<Real>,
    pub near_grazing: Option<bool>,
}

/// A row of `impacts`.
pub(crate) struct ImpactRow<'a> {
    pub index: usize,
    pub impact: &'a Impact,
    /// Of a pendulum, before and after.
    pub angles: Option<[Angle; 2]>,
    pub estimate: Estimate,
    pub scale: &'a Scale,
}

/// A row of `episodes`.
pub(crate) struct EpisodeRow<'a> {
    pub index: usize,
    pub episode: &'a Episode,
    pub scale: &'a Scale,
}

/// A row of `envelope`.
pub(crate) struct PeakRow<'a> {
    pub index: usize,
    /// All peaks of the run.
    pub peaks: &'a [Peak],
    pub scale: &'a Scale,
}

impl PeakRow<'_> {
    fn peak(&self) -> &Peak {
        &self.peaks[self.index]
    }

    fn log_decrement(&self) -> Option<Real> {
        let earlier = self.peaks.get(self.index.checked_sub(2)?)?;
        let decrement = (earlier.displacement / self.peak().displacement).abs().ln();
        decrement.is_finite().then_some(decrement)
    }
}

/// A row of `stroboscope`.
pub(crate) struct StrobeRow<'a> {
    pub strobe: &'a Strobe,
    pub before: Option<&'a Strobe>,
    pub scale: &'a Scale,
}

impl StrobeRow<'_> {
    /// Listed impacts since the strobe before.
    fn impacts(&self) -> u64 {
        self.strobe.impacts - self.before.map_or(0, |before| before.impacts)
    }
}

/// A row that is an entry of a table of events.
pub(crate) trait Row: Sized {
    /// The cells after `point`.
    fn cells(&self) -> impl Iterator<Item = Cell>;
}

macro_rules! rows {
    ($($row:ident: $table:ident;)*) => {
        $(impl Row for $row<'_> {
            fn cells(&self) -> impl Iterator<Item = Cell> {
                let cells: &[fn(&Self) -> Cell] = &entries::$table!(cells);
                cells.iter().map(|cell| cell(self))
            }
        })*
    };
}

rows! {
    ImpactRow: impacts;
    EpisodeRow: episodes;
    PeakRow: envelope;
    StrobeRow: stroboscope;
}
