//! The motion of a single design: sampled at equal intervals, or at any instants.

use std::iter;

use iva_core::absorber::Angle;
use iva_core::error::{Invalid, number};
use iva_core::sample::{Sampler, State};

use crate::cells::{Cell, cells};
use crate::columns::tables as entries;
use crate::design::Design;
use crate::engine::scale::Scale;

#[cfg(feature = "sweeps")]
pub use tables::{modes, states, trajectory};

#[cfg(feature = "sweeps")]
mod tables;

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

/// The observer that samples a trajectory.
pub(crate) fn sampler(design: &Design, samples_per_period: u32) -> Result<Sampler, Invalid> {
    Ok(Sampler::with_events(times(design, samples_per_period)?))
}

/// The instants of the samples of a run, in 1/ωn.
pub(crate) fn times(design: &Design, samples_per_period: u32) -> Result<Vec<f64>, Invalid> {
    let (begin, duration) = (design.begin, design.limits.duration);
    let count = samples(duration - begin, samples_per_period)?;
    let step = std::f64::consts::TAU / f64::from(samples_per_period);
    let sample = |k: u64| (begin + k as f64 * step).min(duration);
    let mut times: Vec<f64> = (0..=count).map(sample).collect();
    if times.last().is_some_and(|last| *last < duration) {
        times.push(duration);
    }
    Ok(times)
}

/// The samples of a run in order of time.
pub(crate) fn in_order(mut sampler: Sampler) -> Vec<State> {
    let mut states = std::mem::take(&mut sampler.states);
    // Frees the times, which are large too.
    drop(sampler);
    // The listed rebounds of a summed tail lie within the stick episode that follows, so the samples are
    // sorted.
    if !states.is_sorted_by(|a, b| a.time.total_cmp(&b.time).is_le()) {
        states.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
    states
}

/// The cells of a row of the trajectory, with its instant in the user's unit.
pub(crate) fn row<'a>(
    design: &'a Design,
    time: f64,
    state: Option<&'a State>,
) -> impl Iterator<Item = Cell> + 'a {
    let cells: &[fn(&MotionRow<'a>) -> Cell] = &entries::trajectory!(cells);
    let row = MotionRow { time, state, design, scale: AsGiven(&design.scale) };
    iter::once(Cell::Point(0)).chain(cells.iter().map(move |cell| cell(&row)))
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

    /// The number of the absorber; `None` without absorber.
    fn absorber(&self) -> Option<u64> {
        let number = self.state.map(|state| u64::from(state.absorber));
        self.design.scene.absorber().and(number)
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
