//! The motion at given instants, exact: read off the closed form, never interpolated.

use crate::flight::Motion;
use crate::impact::Impact;
use crate::observe::{Observer, Span};
use crate::real::Real;
use crate::simulate::Instant;
use crate::system::{Angle, Clock, System};

/// Primary and absorber at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<R = f64> {
    /// Instant, in 1/ωn.
    pub time: R,
    /// Displacement of the primary.
    pub displacement: R,
    /// Velocity of the primary.
    pub velocity: R,
    /// Absorber minus primary displacement.
    pub gap_displacement: R,
    /// Absorber minus primary velocity.
    pub gap_velocity: R,
    /// 0 in flight, ±1 while stuck on a wall (from the switch to the summed tail of a chatter on,
    /// within which the absorber is closer to the wall than rounding can tell).
    pub wall: i8,
    /// Angle and angular velocity of a pendulum.
    pub angle: Option<Angle<R>>,
}

/// An instant this close to an event, relative to it, is that of the event: times of tables have been
/// rounded to the user's unit, and come back through it.
pub(crate) const SLACK: f64 = 4.0 * f64::EPSILON;

/// Samples a run at increasing instants; at an impact the state after it counts.
#[derive(Debug, Clone)]
pub struct Sampler<R = f64> {
    times: Vec<R>,
    next: usize,
    events: bool,
    duration: R,
    clearance: R,
    /// The samples taken so far, in the order of time.
    pub states: Vec<State<R>>,
}

impl<R: Real> Sampler<R> {
    /// Samples at `times`, which must not decrease.
    pub fn at(times: Vec<R>) -> Self {
        let states = Vec::with_capacity(times.len());
        Self { times, next: 0, events: false, duration: R::ZERO, clearance: R::ZERO, states }
    }

    /// Samples at `times` and both states of every impact.
    pub fn with_events(times: Vec<R>) -> Self {
        Self { events: true, ..Self::at(times) }
    }
}

impl<R: Real, S: System<Real = R>> Observer<S> for Sampler<R> {
    fn start(&mut self, system: &S, from: &Instant<S::State, R>, duration: R) {
        self.next = self.times.iter().take_while(|time| **time < from.time.value).count();
        self.duration = duration;
        self.clearance = system.clearance();
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        while let Some(time) = self.times.get(self.next).copied() {
            let h = -span.start.minus(time);
            let last = time >= self.duration && span_ends(&span.start, span.length, self.duration);
            // Beside the states of the impacts themselves a sample keeps its own place.
            let slack = if self.events { 0.0 } else { SLACK };
            if h >= span.length - time * slack && !last {
                break;
            }
            let h = h.clamp(0.0, span.length);
            let (primary, gap) = (span.motion.primary(h), span.motion.gap(h));
            self.states.push(State {
                time,
                displacement: primary.value,
                velocity: primary.rate,
                gap_displacement: gap.y,
                gap_velocity: gap.w,
                wall: span.motion.wall().map_or(0, |wall| wall.number()),
                angle: system.angle(&span.motion.state(h)),
            });
            self.next += 1;
        }
    }

    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        if !self.events {
            return;
        }
        let angles = system.impact_angles(impact);
        let before = State {
            time: impact.time,
            displacement: impact.displacement,
            velocity: impact.velocity_before,
            gap_displacement: self.clearance * impact.wall.sign(),
            gap_velocity: impact.gap_velocity_before,
            wall: 0,
            angle: angles.map(|[before, _]| before),
        };
        let after = State {
            velocity: impact.velocity_after,
            gap_velocity: impact.gap_velocity_after,
            angle: angles.map(|[_, after]| after),
            ..before
        };
        self.states.extend([before, after]);
    }
}

pub(crate) fn span_ends<R: Real>(start: &Clock<R>, length: R, duration: R) -> bool {
    start.plus(length).minus(duration) >= -R::EPSILON * duration
}
