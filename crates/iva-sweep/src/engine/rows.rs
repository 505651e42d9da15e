//! Rows of the result tables, in the user's units. Their columns and cells are defined in
//! [`crate::columns::tables`].

use std::iter;

use super::contact::Contact;
use super::design::Design;
use super::ended::Ended;
use super::scale::Scale;
use super::scene::Scene;
use iva_core::absorber::{Angle, Wall};
use iva_core::extremes::ExtremeValues;
use iva_core::impact::Impact;
use iva_core::observe::StickEpisode;
use iva_core::peaks::Peak;
use iva_core::real::Real;
use iva_core::simulate::OfAbsorber;
use iva_core::steady::{SteadyValues, Strobe};

use crate::cells::{Cell, cells};
use crate::columns::SUMMARY;
use crate::columns::tables as entries;
use crate::study::Study;

/// A column of the summary of a study.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SummaryColumn {
    /// Its index among the entries of [`entries`].
    entry: usize,
    /// False if the column is not computed, so that its cells are null.
    pub asked: bool,
}

/// The row of one point in the table `summary`: the point, the swept parameters, then the columns.
pub(crate) fn summary_row<R: Real>(
    study: &Study,
    point: u64,
    design: &Design<R>,
    ended: &Ended<R>,
    columns: &[SummaryColumn],
) -> Vec<Cell<R>> {
    let row = RunRow::new(design, ended);
    let swept = study.swept(point).into_iter().map(|value| Cell::Number(R::from(value)));
    let cells = columns.iter().map(|column| column.cell(&row));
    iter::once(Cell::point(point)).chain(swept).chain(cells).collect()
}

impl SummaryColumn {
    /// All columns except those of swept parameters.
    pub fn of(study: &Study) -> Vec<Self> {
        let kept = SUMMARY.iter().enumerate().filter(|(_, column)| !study.sweeps(column.name));
        kept.map(|(entry, _)| Self { entry, asked: study.measures.has(entry) }).collect()
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        SUMMARY[self.entry].name
    }

    /// Its cell in a row.
    pub fn cell<R: Real>(self, row: &RunRow<'_, R>) -> Cell<R> {
        if self.asked { row.cell(self.entry) } else { Cell::Null }
    }
}

/// A row of `summary`.
pub(crate) struct RunRow<'a, R: Real = f64> {
    pub ended: &'a Ended<R>,
    pub contacts: &'a [Option<Contact<R>>],
    pub scene: &'a Scene<R>,
    pub scale: &'a Scale<R>,
}

impl<'a, R: Real> RunRow<'a, R> {
    /// The row of a run.
    pub fn new(design: &'a Design<R>, ended: &'a Ended<R>) -> Self {
        let Design { scene, scale, contacts, .. } = design;
        Self { ended, contacts, scene, scale }
    }

    /// The cell of an entry of the table.
    fn cell(&self, entry: usize) -> Cell<R> {
        let cells: &[fn(&Self) -> Cell<R>] = &entries::summary!(cells);
        cells[entry](self)
    }

    /// Largest approach speed; `None` without absorber.
    fn approach_speed(&self) -> Option<R> {
        let [plus, minus] = self.ended.tally.approach_speeds;
        self.scene.absorber().map(|_| R::larger(plus, minus))
    }

    /// What the run has come to for each absorber.
    pub fn absorbers(&self) -> impl Iterator<Item = AbsorberRow<'a, R>> {
        let Self { ended, contacts, scene, scale } = *self;
        let single = ended.absorbers.is_empty() && scene.count() > 0;
        let alone = single.then(|| ended.tally.of_absorber(largest_impulse(ended, scene)));
        let all = alone.into_iter().chain(ended.absorbers.iter().copied());
        all.enumerate().map(move |(absorber, of)| AbsorberRow {
            absorber,
            of,
            extremes: ended.extremes.get(absorber),
            peak_force: contacts.get(absorber).copied().flatten().map(|contact| {
                let at = |wall: Wall, approach: R| {
                    let restitution = scene.restitution_of(absorber, wall, approach);
                    contact.force(of.impulse, approach, restitution)
                };
                let [plus, minus] = of.approach_speeds;
                R::larger(at(Wall::Plus, plus), at(Wall::Minus, minus))
            }),
            scale,
        })
    }

    /// Estimate of the largest force in an impact; `None` if neither contact time nor contact stiffness is
    /// given.
    fn peak_force(&self) -> Option<R> {
        self.absorbers().filter_map(|it| it.peak_force()).reduce(R::larger)
    }

    /// Largest impulse of an absorber on the structure; `None` without absorber.
    fn impulse(&self) -> Option<R> {
        let largest = self.absorbers().map(|it| it.of.impulse).reduce(R::larger);
        largest.map(|impulse| self.scale.impulse(impulse))
    }

    /// Largest acceleration: in the steady state under force, otherwise in the whole decay.
    fn acceleration(&self) -> Option<R> {
        let driven = self.steady(|it| it.acceleration_max);
        let found = driven.or_else(|| self.ended.extremes.first()?.acceleration);
        found.map(|acceleration| self.scale.acceleration(acceleration))
    }

    /// An extreme of the absorber, the largest of several; `None` without absorber.
    fn extreme(&self, read: fn(&ExtremeValues<R>) -> Option<R>) -> Option<R> {
        self.scene.absorber()?;
        self.ended.extremes.iter().filter_map(read).reduce(R::larger)
    }

    /// A measure with a pass of its own; `None` without absorber.
    fn named(&self, name: &str) -> Option<R> {
        self.scene.absorber()?;
        self.ended.named.iter().find(|it| it.0 == name)?.1
    }

    /// A measure of the steady state; `None` where there is none.
    fn steady<T>(&self, read: impl Fn(&SteadyValues<R>) -> Option<T>) -> Option<T> {
        self.ended.steady.as_ref().and_then(read)
    }

    /// 1 − amplitude over that without absorber; null if the latter is 0 or unbounded.
    fn reduction(&self) -> Option<R> {
        reduced(self.steady(|it| it.amplitude_max)?, self.ended.bare?.amplitude)
    }

    /// 1 − root mean square over that without absorber.
    fn reduction_rms(&self) -> Option<R> {
        reduced(self.steady(|it| it.amplitude_rms)?, self.ended.bare?.rms)
    }

    fn transmissibility(&self) -> Option<R> {
        let base = self.steady(|it| it.base_max);
        let base = base.filter(|base| self.scene.moves_base() && *base > 0.0)?;
        Some(self.steady(|it| it.acceleration_max)? / base)
    }
}

/// The relative reduction of a size against that without absorber; `None` if the latter is 0 or unbounded.
fn reduced<R: Real>(size: R, bare: R) -> Option<R> {
    let share = Some(bare).filter(|bare| bare.is_finite()).map(|bare| size / bare)?;
    share.is_finite().then_some(R::ONE - share)
}

/// The largest velocity that the structure gains in an impact of its only absorber.
fn largest_impulse<R: Real>(ended: &Ended<R>, scene: &Scene<R>) -> R {
    let gained = [Wall::Plus, Wall::Minus].map(|wall| {
        let speed = ended.tally.approach_speeds[wall.index()];
        // A pendulum that cannot reach its stops has no impact law.
        if speed > 0.0 { scene.impulse_at(wall, speed).abs() * speed } else { R::ZERO }
    });
    R::larger(gained[0], gained[1])
}

/// The estimated error of an impact.
#[derive(Debug, Clone, Copy, Default)]
pub struct Estimate<R = f64> {
    /// Error of its instant, in 1/ωn.
    pub time: Option<R>,
    /// Whether rounding could have made or unmade it.
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

/// A row of `absorbers`.
pub(crate) struct AbsorberRow<'a, R = f64> {
    pub absorber: usize,
    pub of: OfAbsorber<R>,
    pub extremes: Option<&'a ExtremeValues<R>>,
    /// Estimate of the largest force in an impact, over M ωn².
    pub peak_force: Option<R>,
    pub scale: &'a Scale<R>,
}

impl<R: Real> AbsorberRow<'_, R> {
    fn approach_speed(&self) -> R {
        let [plus, minus] = self.of.approach_speeds;
        R::larger(plus, minus)
    }

    fn peak_force(&self) -> Option<R> {
        self.peak_force.map(|force| self.scale.force(force))
    }
}

impl<R: Real> StrobeRow<'_, R> {
    /// A value of the absorber; `None` without absorber.
    fn gap(&self, read: fn(&Strobe<R>) -> R) -> Option<R> {
        self.has_absorber.then(|| read(self.strobe))
    }

    fn absorber(&self) -> Option<u64> {
        self.has_absorber.then_some(u64::from(self.strobe.absorber))
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
    AbsorberRow: absorbers;
}
