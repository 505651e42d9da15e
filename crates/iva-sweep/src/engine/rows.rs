//! Rows of the result tables, in the user's units. Their columns and cells are defined in
//! [`crate::columns::tables`].

use super::design::Design;
use super::scale::Scale;
use super::scene::Scene;
use iva_core::extremes::ExtremeValues;
use iva_core::impact::Impact;
use iva_core::lanes::Tier;
use iva_core::measures::MeasureValues;
use iva_core::observe::StickEpisode;
use iva_core::peaks::Peak;
use iva_core::real::Real;
use iva_core::simulate::Tally;
use iva_core::steady::{Bare, SteadyValues, Strobe};
use iva_core::system::{Angle, Wall};

use crate::columns::SUMMARY;
use crate::columns::tables as entries;
use crate::study::Study;
use crate::tables::{self, cells};

/// One value of a row.
pub(crate) type Cell<R = f64> = tables::Cell<R>;

/// A column of the summary of a study.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SummaryColumn {
    /// Its index among the entries of [`entries`].
    entry: usize,
    /// False if the column is not computed, so that its cells are null.
    asked: bool,
}

impl SummaryColumn {
    /// All columns except those of swept parameters.
    pub fn of(study: &Study) -> Vec<Self> {
        let kept = SUMMARY.iter().enumerate().filter(|(_, column)| !study.sweeps(column.name));
        kept.map(|(entry, _)| Self { entry, asked: study.measures.has(entry) }).collect()
    }
}

/// The data of a row of `summary`.
pub(crate) struct RunRow<'a, R: Real = f64> {
    pub tally: Tally<(), R>,
    pub values: &'a MeasureValues<R>,
    pub settled: Option<Settled<'a, R>>,
    pub extremes: Option<&'a ExtremeValues<R>>,
    pub condition: Option<R>,
    pub digits: Option<R>,
    pub tier: Tier,
    pub contact_rate: Option<R>,
    pub scene: &'a Scene<R>,
    pub scale: &'a Scale<R>,
}

impl<'a, R: Real> RunRow<'a, R> {
    /// A run in free decay, without extremes and estimates of errors.
    pub fn new(design: &'a Design<R>, tally: Tally<(), R>, values: &'a MeasureValues<R>) -> Self {
        let Design { scene, scale, contact_rate, .. } = design;
        let contact_rate = *contact_rate;
        let tier = match scene {
            Scene::Piva { .. } => design.tier,
            _ => Tier::Exact,
        };
        let (settled, extremes, condition, digits) = (None, None, None, None);
        Self {
            tally,
            values,
            settled,
            extremes,
            condition,
            digits,
            tier,
            contact_rate,
            scene,
            scale,
        }
    }

    /// Largest approach speed; `None` without absorber.
    fn approach_speed(&self) -> Option<R> {
        let [plus, minus] = self.tally.approach_speeds;
        self.scene.absorber().map(|_| R::larger(plus, minus))
    }

    /// Estimate of the largest force in an impact; `None` if neither contact time nor contact stiffness is
    /// given.
    fn peak_force(&self) -> Option<R> {
        Some(self.scale.force(self.gained()? * self.contact_rate?))
    }

    /// Largest impulse on the structure; `None` without absorber.
    fn impulse(&self) -> Option<R> {
        self.gained().map(|gained| self.scale.impulse(gained))
    }

    /// Largest velocity that the structure gains in an impact; `None` without absorber.
    fn gained(&self) -> Option<R> {
        self.scene.absorber()?;
        let gained = [Wall::Plus, Wall::Minus].map(|wall| {
            let speed = self.tally.approach_speeds[wall.index()];
            // A pendulum that cannot reach its stops has no impact law.
            if speed > 0.0 { self.scene.impact_gain(wall).abs() * speed } else { R::ZERO }
        });
        Some(R::larger(gained[0], gained[1]))
    }

    /// Largest acceleration: in the steady state under force, otherwise in the whole decay.
    fn acceleration(&self) -> Option<R> {
        let driven = self.settled(|it| it.values.acceleration_max);
        let found = driven.or_else(|| self.extremes.and_then(|it| it.acceleration));
        found.map(|acceleration| self.scale.acceleration(acceleration))
    }

    /// An extreme of the absorber; `None` without absorber.
    fn extreme(&self, read: fn(&ExtremeValues<R>) -> Option<R>) -> Option<R> {
        self.scene.absorber().and(self.extremes).and_then(read)
    }

    fn settled<T>(&self, read: impl Fn(&Settled<'a, R>) -> Option<T>) -> Option<T> {
        self.settled.as_ref().and_then(read)
    }

    /// The row: the point, the swept parameters, then the columns.
    pub fn cells(
        &self,
        columns: &[SummaryColumn],
        swept: &[f64],
        point: u64,
    ) -> impl Iterator<Item = Cell<R>> {
        let cells: &[fn(&Self) -> Cell<R>] = &entries::summary!(cells);
        let asked_for = columns.iter().map(|column| match column.asked {
            true => cells[column.entry](self),
            false => Cell::Null,
        });
        let swept = swept.iter().map(|value| Cell::Number(R::given(*value, false)));
        // `Study::points` ensures that points are below 2^32.
        std::iter::once(Cell::Point(point as u32)).chain(swept).chain(asked_for)
    }
}

/// The steady state of a driven run.
pub(crate) struct Settled<'a, R = f64> {
    pub values: &'a SteadyValues<R>,
    /// Amplitudes of the structure without absorber.
    pub bare: Option<Bare<R>>,
    pub moves_base: bool,
}

impl<R: Real> Settled<'_, R> {
    /// 1 − amplitude over that without absorber; null if the latter is 0 or unbounded.
    fn reduction(&self) -> Option<R> {
        reduced(self.values.amplitude_max?, self.bare?.amplitude)
    }

    /// 1 − root mean square over that without absorber.
    fn reduction_rms(&self) -> Option<R> {
        reduced(self.values.amplitude_rms?, self.bare?.rms)
    }

    fn transmissibility(&self) -> Option<R> {
        let base = self.values.base_max.filter(|base| self.moves_base && *base > 0.0)?;
        Some(self.values.acceleration_max? / base)
    }
}

/// The relative reduction of a size against that without absorber; `None` if the latter is 0 or unbounded.
fn reduced<R: Real>(size: R, bare: R) -> Option<R> {
    let share = Some(bare).filter(|bare| bare.is_finite()).map(|bare| size / bare)?;
    share.is_finite().then_some(R::ONE - share)
}

/// The estimated error of an impact.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Estimate<R = f64> {
    /// Error of its instant, in 1/ωn.
    pub time: Option<R>,
    pub near_grazing: Option<bool>,
}

/// A row of `impacts`.
pub(crate) struct ImpactRow<'a, R = f64> {
    pub index: usize,
    pub impact: &'a Impact<R>,
    /// Estimate of the largest force in the impact, over the primary mass.
    pub peak_force: Option<R>,
    /// Angles of a pendulum before and after the impact.
    pub angles: Option<[Angle<R>; 2]>,
    pub estimate: Estimate<R>,
    pub scale: &'a Scale<R>,
}

/// A row of `episodes`.
pub(crate) struct EpisodeRow<'a, R = f64> {
    pub index: usize,
    pub episode: &'a StickEpisode<R>,
    pub scale: &'a Scale<R>,
}

/// A row of `envelope`.
pub(crate) struct PeakRow<'a, R = f64> {
    pub index: usize,
    /// All peaks of the run.
    pub peaks: &'a [Peak<R>],
    pub scale: &'a Scale<R>,
}

impl<R: Real> PeakRow<'_, R> {
    fn peak(&self) -> &Peak<R> {
        &self.peaks[self.index]
    }

    fn log_decrement(&self) -> Option<R> {
        let earlier = self.peaks.get(self.index.checked_sub(2)?)?;
        let decrement = (earlier.displacement / self.peak().displacement).abs().ln();
        decrement.is_finite().then_some(decrement)
    }
}

/// A row of `stroboscope`.
pub(crate) struct StrobeRow<'a, R = f64> {
    pub strobe: &'a Strobe<R>,
    pub before: Option<&'a Strobe<R>>,
    pub has_absorber: bool,
    pub scale: &'a Scale<R>,
}

impl<R: Real> StrobeRow<'_, R> {
    /// A value of the absorber; `None` without absorber.
    fn gap(&self, read: fn(&Strobe<R>) -> R) -> Option<R> {
        self.has_absorber.then(|| read(self.strobe))
    }

    /// Number of listed impacts since the previous strobe.
    fn impacts(&self) -> u64 {
        self.strobe.impacts - self.before.map_or(0, |before| before.impacts)
    }
}

/// A row of a table of events.
pub(crate) trait Row<R>: Sized {
    /// The cells after `point`.
    fn cells(&self) -> impl Iterator<Item = Cell<R>>;
}

macro_rules! rows {
    ($($row:ident: $table:ident;)*) => {
        $(impl<R: Real> Row<R> for $row<'_, R> {
            fn cells(&self) -> impl Iterator<Item = Cell<R>> {
                let cells: &[fn(&Self) -> Cell<R>] = &entries::$table!(cells);
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
