//! One point of a study: its run, and the rows that it makes.

use std::sync::atomic::AtomicBool;

use super::core::measures::{Measures, Wanted};
use super::core::observe::{Events, Observer};
use super::core::peaks::Envelope;
use super::core::piva::Piva;
use super::core::simulate::{Tally, simulate};
use super::core::siva::Siva;
use super::core::steady::{Steady, SteadyWanted};
use super::core::system::System;
use super::design::Design;
use super::rows::{self, Cell};
use super::scale::Scale;
use super::scene::Scene;
use crate::done::Done;
use crate::error::Invalid;
use crate::study::{Study, Table};

/// What a study wants from each run.
#[derive(Debug)]
pub(crate) struct Request {
    pub summary: bool,
    pub impacts: bool,
    pub episodes: bool,
    pub envelope: bool,
    pub wanted: Wanted,
    pub steady: SteadyWanted,
    pub reduction: bool,
}

impl Request {
    pub fn new(study: &Study) -> Self {
        let asked = |table| study.tables.contains(&table);
        let any = |names: &[&str]| names.iter().any(|name| study.measures.contains(name));
        Self {
            summary: asked(Table::Summary),
            impacts: asked(Table::Impacts),
            episodes: asked(Table::Episodes),
            envelope: asked(Table::Envelope),
            wanted: Wanted {
                peaks: any(&[
                    "damping_ratio_1",
                    "damping_ratio_3",
                    "damping_ratio_10",
                    "damping_ratio_fit",
                ]),
                settling: any(&["settling_time_10", "settling_time_5", "settling_time_2"]),
                residual: any(&["residual_amplitude"]),
                ledger: any(&["energy_viscous", "energy_pivot", "energy_work", "energy_residual"]),
            },
            steady: SteadyWanted {
                amplitude: any(&["amplitude_max", "reduction"]),
                rms: any(&["amplitude_rms"]),
                acceleration: any(&["transmissibility"]),
                regime: any(&["regime"]),
                impacts: any(&["impacts_per_cycle"]),
                strobes: asked(Table::Stroboscope),
            },
            reduction: any(&["reduction"]),
        }
    }
}

impl Request {
    /// What is wanted of a driven run's steady state; `None` in free decay, and if nothing is.
    fn steady_of<S: System>(&self, system: &S) -> Option<SteadyWanted> {
        Some(self.steady).filter(|it| system.is_driven() && *it != SteadyWanted::default())
    }
}

/// An observer that has something to say of the exactness of a run.
pub(crate) trait Estimates<S: System>: Observer<S> {
    /// The last two cells of a row of `impacts`.
    fn of_impact(&self, index: usize, scale: &Scale) -> [Cell; 2];
    /// The last two cells of `summary`.
    fn of_run(&self) -> [Cell; 2];
}

/// Runs a point and hands out its rows, table by table; returns how it ended and what it took.
///
/// # Errors
/// [`Invalid`] if the core refuses the design.
pub(crate) fn run<E: Estimates<Siva> + Estimates<Piva>>(
    study: &Study,
    point: u64,
    design: &Design,
    request: &Request,
    cancel: &AtomicBool,
    estimates: E,
    take: &mut dyn FnMut(Table, &mut dyn Iterator<Item = Cell>),
) -> Result<Done, Invalid> {
    let point = Point { study, point, design, request, cancel };
    match &design.scene {
        Scene::Siva { system, start } => point.run(system, start, estimates, take),
        Scene::Piva { system, start, .. } => point.run(system, start, estimates, take),
    }
}

struct Point<'a> {
    study: &'a Study,
    point: u64,
    design: &'a Design,
    request: &'a Request,
    cancel: &'a AtomicBool,
}

/// What has watched a run.
struct Seen<S: System, E> {
    tally: Tally<S::State>,
    events: Option<Events>,
    envelope: Option<Envelope>,
    measures: Option<Measures<S>>,
    steady: Option<Steady>,
    estimates: E,
}

impl Point<'_> {
    fn run<S: System, E: Estimates<S>>(
        &self,
        system: &S,
        start: &S::Start,
        estimates: E,
        take: &mut dyn FnMut(Table, &mut dyn Iterator<Item = Cell>),
    ) -> Result<Done, Invalid> {
        let Self { study, design, request, cancel, .. } = *self;
        let mut observers = (
            (request.impacts || request.episodes).then(Events::default),
            (
                request.envelope.then(Envelope::default),
                (
                    request.summary.then(|| Measures::<S>::new(request.wanted)),
                    (
                        request.steady_of(system).map(|wanted| Steady::new(design.window, wanted)),
                        estimates,
                    ),
                ),
            ),
        );
        let tally = simulate(system, start, &design.limits, Some(cancel), &mut observers)?;
        let done = Done::run(tally.outcome.name(), tally.work);
        let (events, (envelope, (measures, (steady, estimates)))) = observers;
        let seen = Seen { tally, events, envelope, measures, steady, estimates };
        for table in &study.tables {
            self.rows(*table, system, &seen, take)?;
        }
        Ok(done)
    }

    fn rows<S: System, E: Estimates<S>>(
        &self,
        table: Table,
        system: &S,
        seen: &Seen<S, E>,
        take: &mut dyn FnMut(Table, &mut dyn Iterator<Item = Cell>),
    ) -> Result<(), Invalid> {
        let scale = &self.design.scale;
        // Points are counted below 2^32 by `Study::points`.
        let number = self.point as u32;
        let mut row = |cells: &mut dyn Iterator<Item = Cell>| take(table, cells);
        match table {
            Table::Summary => self.summary(system, seen, &mut row)?,
            Table::Impacts => {
                for (index, impact) in
                    seen.events.iter().flat_map(|events| &events.impacts).enumerate()
                {
                    let angles =
                        system.impact_angles(impact).filter(|_| self.design.scene.has_angle());
                    let estimated = seen.estimates.of_impact(index, scale);
                    row(&mut rows::impact(number, index, impact, angles, estimated, scale));
                }
            }
            Table::Episodes => {
                for (index, episode) in
                    seen.events.iter().flat_map(|events| &events.episodes).enumerate()
                {
                    row(&mut rows::episode(number, index, episode, scale).into_iter());
                }
            }
            Table::Envelope => {
                if let Some(envelope) = &seen.envelope {
                    for index in 0..envelope.peaks.len() {
                        row(&mut rows::peak(number, index, &envelope.peaks, scale).into_iter());
                    }
                }
            }
            Table::Stroboscope => {
                let mut before = None;
                for strobe in seen.steady.iter().flat_map(Steady::strobes) {
                    row(&mut rows::strobe(number, before, strobe, scale).into_iter());
                    before = Some(strobe);
                }
            }
            Table::Trajectory => {}
        }
        Ok(())
    }

    fn summary<S: System, E: Estimates<S>>(
        &self,
        system: &S,
        seen: &Seen<S, E>,
        row: &mut dyn FnMut(&mut dyn Iterator<Item = Cell>),
    ) -> Result<(), Invalid> {
        let Self { study, point, design, request, cancel } = *self;
        let Some(measures) = &seen.measures else { return Ok(()) };
        let bare = match request.reduction && system.is_driven() {
            true => design.amplitude_without_absorber(cancel)?,
            false => None,
        };
        let settled = seen.steady.as_ref().map(|steady| rows::Settled {
            values: steady.values(),
            bare,
            moves_base: design.scene.moves_base(),
        });
        let estimated = seen.estimates.of_run();
        let (tally, values) = (&seen.tally, measures.values());
        row(&mut rows::summary(study, point, design, tally, values, settled.as_ref(), estimated));
        Ok(())
    }
}
