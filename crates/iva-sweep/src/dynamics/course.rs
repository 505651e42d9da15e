//! One cycle of an orbit, in the user's units.

use std::sync::Arc;

use iva_core::absorber::{Angle, Point};
use iva_core::error::Invalid;
use iva_core::impact::Impact;
use iva_core::observe::StickEpisode;
use iva_core::orbit::description::Description;
use iva_core::sample::State;

use super::family::Family;
use crate::design::Spec;
use crate::fields::FieldId;
use crate::units::Scale;

/// One cycle of an orbit from the phase of the drive at the start on, in the user's units.
#[derive(Debug, Clone)]
pub struct Course {
    /// The state at that phase, one of each absorber.
    pub states: Vec<State>,
    /// Of a structure with several modes the displacements of its modes or coordinates there, and their rates.
    pub modes: Option<[Vec<f64>; 2]>,
    /// The impacts.
    pub impacts: Vec<Impact>,
    /// The stick episodes.
    pub episodes: Vec<StickEpisode>,
    /// The walls in order of time, see [`Description::walls`].
    pub walls: String,
}

impl Course {
    /// The state of the first absorber.
    pub fn state(&self) -> &State {
        &self.states[0]
    }

    /// The scene with its start at that phase.
    ///
    /// # Errors
    /// [`Invalid`] if the scene does not take the numbers.
    pub fn begun(&self, spec: &Spec) -> Result<Spec, Invalid> {
        let mut spec = spec.clone();
        match (&self.modes, spec.structure()) {
            (Some(modes), Some(structure)) => {
                let begun = structure.begun_at(modes)?;
                spec = spec.with_structure(Arc::new(begun));
            }
            _ => {
                spec.replace(FieldId::Displacement, self.state().displacement)?;
                spec.replace(FieldId::Velocity, self.state().velocity)?;
            }
        }
        spec.clear(FieldId::GapDisplacement.into());
        spec.clear(FieldId::GapVelocity.into());
        let angle = |of: fn(Angle) -> f64| self.states.iter().map(|it| it.angle.map(of)).collect();
        let gap = |of: fn(&State) -> f64| self.states.iter().map(of).collect::<Vec<f64>>();
        let angles: [Option<Vec<f64>>; 2] = [angle(|it| it.value), angle(|it| it.rate)];
        let [(place, at), (rate, with)] = match angles {
            [Some(at), Some(with)] => [(FieldId::Angle, at), (FieldId::AngularVelocity, with)],
            _ => [
                (FieldId::GapDisplacement, gap(|it| it.gap_displacement)),
                (FieldId::GapVelocity, gap(|it| it.gap_velocity)),
            ],
        };
        spec.set_starts(place, &at)?;
        spec.set_starts(rate, &with)?;
        Ok(spec)
    }
}

/// The states of all absorbers at an instant, and the motion of the modes of a structure with points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment<'a> {
    pub states: &'a [State],
    pub modes: &'a [Point],
}

impl Family {
    /// A cycle in the user's units from an instant on, at which the states are these, or their mirror images.
    pub(super) fn course(
        &self,
        begin: f64,
        (Moment { states, modes }, mirrors): (Moment<'_>, bool),
        cycle: &Description,
        length: f64,
    ) -> Result<Course, Invalid> {
        let seen = |state: &State| {
            let middle = self.middles.get(usize::from(state.absorber)).copied().unwrap_or(0.0);
            let state = if mirrors { mirrored(state, middle) } else { *state };
            given(&self.scale, self.has_angle, &State { time: begin, ..state })
        };
        let sign = if mirrors { -1.0 } else { 1.0 };
        let modes: Vec<_> =
            modes.iter().map(|it| Point { x: it.x * sign, v: it.v * sign }).collect();
        Ok(Course {
            states: states.iter().map(seen).collect(),
            modes: self.structure.as_ref().map(|it| it.started(&modes)).transpose()?,
            impacts: cycle.impacts.iter().map(|it| impact(&self.scale, it)).collect(),
            episodes: cycle.episodes.iter().map(|it| episode(&self.scale, it)).collect(),
            walls: cycle.walls(length),
        })
    }
}

/// The mirror image of a state, about the middle of the gap.
fn mirrored(state: &State, middle: f64) -> State {
    State {
        displacement: -state.displacement,
        velocity: -state.velocity,
        gap_displacement: 2.0 * middle - state.gap_displacement,
        gap_velocity: -state.gap_velocity,
        wall: -state.wall,
        acceleration: -state.acceleration,
        absorber_acceleration: -state.absorber_acceleration,
        angle: state.angle.map(|it| Angle { value: -it.value, rate: -it.rate }),
        ..*state
    }
}

/// A state in the user's units.
fn given(scale: &Scale, has_angle: bool, state: &State) -> State {
    let angle = state.angle.filter(|_| has_angle).map(|mut angle| {
        angle.rate = scale.angular_velocity(angle.rate);
        angle
    });
    State {
        time: scale.time(state.time),
        velocity: scale.velocity(state.velocity),
        gap_velocity: scale.velocity(state.gap_velocity),
        acceleration: scale.acceleration(state.acceleration),
        absorber_acceleration: scale.acceleration(state.absorber_acceleration),
        energy: scale.energy(state.energy),
        angle,
        ..*state
    }
}

/// An impact in the user's units.
fn impact(scale: &Scale, impact: &Impact) -> Impact {
    Impact {
        time: scale.time(impact.time),
        velocity_before: scale.velocity(impact.velocity_before),
        velocity_after: scale.velocity(impact.velocity_after),
        gap_velocity_before: scale.velocity(impact.gap_velocity_before),
        gap_velocity_after: scale.velocity(impact.gap_velocity_after),
        energy_loss: scale.energy(impact.energy_loss),
        ..*impact
    }
}

/// A stick episode in the user's units.
fn episode(scale: &Scale, episode: &StickEpisode) -> StickEpisode {
    StickEpisode {
        start_time: scale.time(episode.start_time),
        stick_time: scale.time(episode.stick_time),
        release_time: episode.release_time.map(|time| scale.time(time)),
        energy_loss: scale.energy(episode.energy_loss),
        ..*episode
    }
}
