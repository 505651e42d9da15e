//! The motion of a single design as an Arrow table.
//!
//! Setting `cancel` ends a run early; its table then ends where the run did.

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use iva_core::error::{Invalid, number};
use iva_core::run::observed::Beside;
use iva_core::sample::{Sampler, State};

use super::{in_order, row, sampler};
use crate::design::{Design, Spec};
use crate::engine::point::{Request, run};
use crate::structure::SECTION;
use crate::study::{Study, Table};
use crate::sweep::SweepError;
use crate::tables::{TableBuilder, schema_in};

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
    let mut sampler = sampler(&design, samples_per_period)?;
    watch(spec, &design, cancel, &mut sampler)?;
    let states = in_order(sampler);
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
    watch(spec, &design, cancel, &mut sampler)?;
    // Of several absorbers each has a state at every instant.
    let each = design.scene.count().max(1);
    let mut found: Vec<(f64, Option<&State>)> =
        times.iter().flat_map(|time| vec![(*time, None); each]).collect();
    for (&index, at_once) in order.iter().zip(sampler.states.chunks(each)) {
        for ((_, found), state) in found[index * each..].iter_mut().zip(at_once) {
            *found = Some(state);
        }
    }
    table(spec, &design, found.into_iter())
}

/// Displacements and velocities of the modes or coordinates of a structure with several modes at an instant of a run (in s), as
/// its entries of the start have them; `None` if the run ends before.
///
/// # Errors
/// [`SweepError`] for an invalid design, and where the structure moves as one.
pub fn modes(
    spec: &Spec,
    time: f64,
    cancel: &AtomicBool,
) -> Result<Option<[Vec<f64>; 2]>, SweepError> {
    let design = spec.design()?;
    let Some(structure) = spec.structure() else {
        return Err(Invalid::missing(SECTION, "give a structure with several modes").into());
    };
    let tau = time * design.scale.natural_frequency;
    let mut sampler = Sampler::with_modes(vec![tau.clamp(design.begin, design.limits.duration)]);
    watch(spec, &design, cancel, &mut sampler)?;
    let found = sampler.modes.and_then(|mut modes| modes.pop());
    Ok(found.map(|modes| structure.started(&modes)).transpose()?)
}

fn watch(
    spec: &Spec,
    design: &Design,
    cancel: &AtomicBool,
    sampler: &mut Sampler,
) -> Result<(), Invalid> {
    let (study, request) = (Study::single(spec.clone()), Request::nothing());
    let beside: Beside<'_> = (None, (Some(sampler), None));
    run(&study, 0, design, &request, cancel, beside, &mut |_, _| {}).map(|_| ())
}

fn table<'a>(
    spec: &Spec,
    design: &Design,
    states: impl ExactSizeIterator<Item = (f64, Option<&'a State>)>,
) -> Result<RecordBatch, SweepError> {
    let schema = schema_in(&Study::single(spec.clone()), Table::Trajectory, design.units);
    let mut builder = TableBuilder::new(schema, states.len());
    for (time, state) in states {
        builder.row(row(design, time, state));
    }
    Ok(builder.finish()?)
}
