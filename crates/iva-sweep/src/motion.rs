//! The motion of a single design as a table: sampled at equal intervals, or at any instants.
//!
//! Setting `cancel` ends a run early; its table then ends where the run did.

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use iva_core::absorber::Angle;
use iva_core::error::{Invalid, number};
use iva_core::sample::{Sampler, State};
use iva_core::simulate::simulate_from;

use crate::columns::tables as entries;

use crate::design::{Design, Spec};
use crate::engine::scale::Scale;
use crate::engine::scene::with_system;
use crate::study::{Study, Table};
use crate::sweep::SweepError;
use crate::tables::{Cell, TableBuilder, cells, schema_in};

/// Largest number of samples: while their table is built they take some 4 GB.
pub const MAX_SAMPLES: f64 = 3e7;

/// Number of whole sampling steps in a run of this duration (in 1/ωn).
///
/// # Errors
/// [`Invalid`] for a sampling of 0, or one with more than [`MAX_SAMPLES`].
pub fn samples(duration: f64, samples_per_period: u32) -> Result<u64, Invalid> {
    let invalid = |allowed| Invalid::new("run.samples_per_period", samples_per_period, allowed);
    if samples_per_period == 0 {
        return Err(invalid("give a whole number, 1 or greater".to_owned()));
    }
    let count = (duration * f64::from(samples_per_period) / std::f64::consts::TAU).floor();
    if count > MAX_SAMPLES {
        let most = number(MAX_SAMPLES);
        return Err(invalid(format!(
            "the run would have {} samples, at most {most} are kept",
            number(count)
        )));
    }
    Ok(count as u64)
}

/// The motion of one design: `samples_per_period` equidistant samples per period 2π/ωn, the end of the run,
/// and both states of every impact.
///
/// # Errors
/// [`SweepError`] for an invalid design or sampling.
pub fn trajectory(
    spec: &Spec,
    samples_per_period: u32,
    cancel: &AtomicBool,
) -> Result<RecordBatch, SweepError> {
    let design = spec.design()?;
    let (begin, duration) = (design.begin, design.limits.duration);
    let count = samples(duration - begin, samples_per_period)?;
    let step = std::f64::consts::TAU / f64::from(samples_per_period);
    let sample = |k: u64| (begin + k as f64 * step).min(duration);
    let mut times: Vec<f64> = (0..=count).map(sample).collect();
    if times.last().is_some_and(|last| *last < duration) {
        times.push(duration);
    }
    let mut sampler = Sampler::with_events(times);
    watch(&design, cancel, &mut sampler)?;
    let mut states = std::mem::take(&mut sampler.states);
    // Frees the times, which are large too.
    drop(sampler);
    // The listed rebounds of a summed tail lie within the stick episode that follows, so the samples are
    // sorted.
    if !states.is_sorted_by(|a, b| a.time.total_cmp(&b.time).is_le()) {
        states.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
    let rows = states.iter().map(|state| (design.scale.time(state.time), Some(state)));
    table(spec, &design, rows)
}

/// The state of one design at given times (user units, any order), exact at any instant; at an impact the
/// state after it. Times after an early end of the run give nulls. `field` gives the name of a time in a
/// message, from its index.
///
/// # Errors
/// [`SweepError`] for an invalid design or a time outside the run.
pub fn states(
    spec: &Spec,
    times: &[f64],
    field: &dyn Fn(usize) -> String,
    cancel: &AtomicBool,
) -> Result<RecordBatch, SweepError> {
    let design = spec.design()?;
    let duration = design.limits.duration;
    let mut order: Vec<usize> = (0..times.len()).collect();
    order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
    let mut instants = Vec::with_capacity(times.len());
    for &index in &order {
        let tau = times[index] * design.scale.natural_frequency;
        let slack = 4.0 * f64::EPSILON;
        if !(design.begin * (1.0 - slack)..=duration * (1.0 + slack)).contains(&tau) {
            let [begin, end] = [design.begin, duration].map(|tau| number(design.scale.time(tau)));
            return Err(Invalid::new(
                field(index),
                number(times[index]),
                format!(
                    "give {} from {begin} to {end}",
                    if times.len() > 1 { "times" } else { "a time" }
                ),
            )
            .into());
        }
        instants.push(tau.clamp(design.begin, duration));
    }
    let mut sampler = Sampler::at(instants);
    watch(&design, cancel, &mut sampler)?;
    let mut found: Vec<Option<&State>> = vec![None; times.len()];
    for (&index, state) in order.iter().zip(&sampler.states) {
        found[index] = Some(state);
    }
    table(spec, &design, times.iter().copied().zip(found))
}

fn watch(design: &Design, cancel: &AtomicBool, sampler: &mut Sampler) -> Result<(), Invalid> {
    let (limits, cancel) = (&design.limits, Some(cancel));
    with_system!(&design.scene, |it| {
        simulate_from(&it.system, &it.start, design.begin, limits, cancel, sampler).map(|_| ())
    })
}

fn table<'a>(
    spec: &Spec,
    design: &Design,
    states: impl ExactSizeIterator<Item = (f64, Option<&'a State>)>,
) -> Result<RecordBatch, SweepError> {
    let schema = schema_in(&Study::single(spec.clone()), Table::Trajectory, design.units);
    let mut builder = TableBuilder::new(schema, states.len());
    for (time, state) in states {
        let cells: &[fn(&MotionRow<'_>) -> Cell] = &entries::trajectory!(cells);
        let row = MotionRow { time, state, design, scale: AsGiven(&design.scale) };
        builder.row(std::iter::once(Cell::Point(0)).chain(cells.iter().map(|cell| cell(&row))));
    }
    Ok(builder.finish()?)
}

/// A row of the trajectory.
struct MotionRow<'a> {
    /// Instant, in the user's unit.
    time: f64,
    /// The state at that instant; `None` if the run had already ended.
    state: Option<&'a State>,
    design: &'a Design,
    scale: AsGiven<'a>,
}

/// A scale that leaves times unchanged: they are in the user's unit already, and are returned exactly as
/// given.
struct AsGiven<'a>(&'a Scale);

impl AsGiven<'_> {
    fn time(&self, time: f64) -> f64 {
        time
    }

    fn velocity(&self, velocity: f64) -> f64 {
        self.0.velocity(velocity)
    }

    fn angular_velocity(&self, rate: f64) -> f64 {
        self.0.angular_velocity(rate)
    }
}

impl MotionRow<'_> {
    fn state<T>(&self, read: fn(&State) -> T) -> Option<T> {
        self.state.map(read)
    }

    /// A value of the absorber; `None` without absorber.
    fn gap(&self, read: fn(&State) -> f64) -> Option<f64> {
        self.design.scene.absorber().and(self.state(read))
    }

    fn acceleration(&self, read: fn(&State) -> f64) -> Option<f64> {
        self.state(read).map(|acceleration| self.scale.0.acceleration(acceleration))
    }

    fn absorber_acceleration(&self) -> Option<f64> {
        self.design.scene.absorber().and(self.acceleration(|it| it.absorber_acceleration))
    }

    fn angle(&self) -> Option<Angle> {
        self.state.and_then(|state| state.angle).filter(|_| self.design.scene.has_angle())
    }
}
