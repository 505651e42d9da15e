//! Rows of the result tables, in the user's units.

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

use crate::columns::columns;
use crate::study::{Study, Table};
use crate::tables;

/// One value of a row.
pub(crate) type Cell = tables::Cell<Real>;

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

/// A row of `summary`: the point, the swept parameters, then all columns but those that are swept; columns not
/// asked for are null.
pub(crate) fn summary<S>(
    study: &Study,
    point: u64,
    design: &Design,
    tally: &Tally<S>,
    values: &MeasureValues,
    settled: Option<&Settled<'_>>,
    estimated: [Cell; 2],
) -> impl Iterator<Item = Cell> {
    let (scale, scene) = (&design.scale, &design.scene);
    let time = |tau: Option<Real>| Cell::from(tau.map(|tau| scale.time(tau)));
    let energy = |energy: Real| Cell::Number(scale.energy(energy));
    let cells = [
        Cell::Text(tally.outcome.name().into()),
        Cell::Count(tally.impacts),
        Cell::Count(tally.effective_impacts),
        Cell::Count(tally.episodes),
        Cell::Count(tally.undecided),
        time(Some(tally.time_stuck)),
        values.damping_ratio_1.into(),
        values.damping_ratio_3.into(),
        values.damping_ratio_10.into(),
        values.damping_ratio_fit.into(),
        values.damping_ratio_energy.into(),
        time(values.settling_time_10),
        time(values.settling_time_5),
        time(values.settling_time_2),
        values.residual_amplitude.into(),
        energy(values.energy_initial),
        energy(tally.energy_impacts),
        energy(values.energy_viscous),
        energy(values.energy_final),
        energy(values.energy_residual),
        energy(values.energy_pivot),
        Cell::Flag(scene.stop_reachable()),
        scene.gravity().into(),
        energy(values.energy_work),
        settled.and_then(|it| it.values.amplitude_max).into(),
        settled.and_then(|it| it.values.amplitude_rms).into(),
        settled.and_then(Settled::reduction).into(),
        settled.and_then(Settled::transmissibility).into(),
        settled.and_then(|it| it.values.impacts_per_cycle).into(),
        settled
            .and_then(|it| it.values.regime)
            .map_or(Cell::Null, |regime| Cell::Text(regime.to_string().into())),
    ];
    let columns =
        columns(Table::Summary).iter().zip(cells.into_iter().chain(estimated)).enumerate();
    let kept = columns.filter(|(_, (column, _))| !study.sweeps(column.name));
    let asked_for =
        kept.map(|(index, (_, cell))| if study.measures.has(index) { cell } else { Cell::Null });
    let swept = study.swept(point).into_iter().map(|value| Cell::Number(given(value, false)));
    // Points are counted below 2^32 by `Study::points`.
    std::iter::once(Cell::Point(point as u32)).chain(swept).chain(asked_for)
}

/// A row of `impacts`.
pub(crate) fn impact(
    point: u32,
    index: usize,
    impact: &Impact,
    angles: Option<[Angle; 2]>,
    estimated: [Cell; 2],
    scale: &Scale,
) -> impl Iterator<Item = Cell> {
    let velocity = |v: Real| Cell::Number(scale.velocity(v));
    let rate = |side: usize| -> Cell {
        angles.map(|angles| scale.angular_velocity(angles[side].rate)).into()
    };
    [
        Cell::Point(point),
        Cell::Count(index as u64),
        Cell::Number(scale.time(impact.time)),
        Cell::Side(impact.wall.number()),
        Cell::Number(impact.displacement),
        velocity(impact.velocity_before),
        velocity(impact.velocity_after),
        velocity(impact.absorber_velocity_before()),
        velocity(impact.absorber_velocity_after()),
        velocity(impact.gap_velocity_before),
        Cell::Number(scale.energy(impact.energy_loss)),
        Cell::Flag(impact.effective()),
        angles.map(|[before, _]| before.value).into(),
        rate(0),
        rate(1),
    ]
    .into_iter()
    .chain(estimated)
}

/// A row of `episodes`.
pub(crate) fn episode(point: u32, index: usize, episode: &Episode, scale: &Scale) -> [Cell; 8] {
    [
        Cell::Point(point),
        Cell::Count(index as u64),
        Cell::Side(episode.wall.number()),
        Cell::Number(scale.time(episode.start_time)),
        Cell::Number(scale.time(episode.stick_time)),
        episode.release_time.map(|tau| scale.time(tau)).into(),
        Cell::Count(episode.impacts),
        Cell::Number(scale.energy(episode.energy_loss)),
    ]
}

/// A row of `envelope`; `peaks[index]` is its peak.
pub(crate) fn peak(point: u32, index: usize, peaks: &[Peak], scale: &Scale) -> [Cell; 6] {
    let Peak { time, displacement } = peaks[index];
    let decrement = index
        .checked_sub(2)
        .map(|earlier| (peaks[earlier].displacement / displacement).abs().ln())
        .filter(|decrement| decrement.is_finite());
    [
        Cell::Point(point),
        Cell::Count(index as u64),
        Cell::Number(scale.time(time)),
        Cell::Number(displacement),
        Cell::Number(displacement.abs()),
        decrement.into(),
    ]
}

/// A row of `stroboscope`; `before` is the strobe before it.
pub(crate) fn strobe(
    point: u32,
    before: Option<&Strobe>,
    strobe: &Strobe,
    scale: &Scale,
) -> [Cell; 9] {
    [
        Cell::Point(point),
        Cell::Count(strobe.cycle),
        Cell::Number(scale.time(strobe.time)),
        Cell::Number(strobe.displacement),
        Cell::Number(scale.velocity(strobe.velocity)),
        Cell::Number(strobe.gap_displacement),
        Cell::Number(scale.velocity(strobe.gap_velocity)),
        Cell::Number(strobe.amplitude),
        Cell::Count(strobe.impacts - before.map_or(0, |before| before.impacts)),
    ]
}
