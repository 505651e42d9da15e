//! The motion at given instants, exact: read off the closed form, never interpolated.

use crate::flight::Motion;
use crate::impact::Impact;
use crate::observe::{Contact, Observer, Span};
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
    /// Absolute acceleration ẍ + a_g of the structure, without the impacts' own.
    pub acceleration: R,
    /// The same of the absorber's centre of mass along the motion.
    pub absorber_acceleration: R,
    /// Angle and angular velocity of a pendulum.
    pub angle: Option<Angle<R>>,
}

/// Absolute accelerations of structure and absorber, free in its gap, in a state.
fn accelerations<S: System>(system: &S, state: &S::State) -> [S::Real; 2] {
    let flight = system.flight(state);
    let structure = flight.acceleration(S::Real::ZERO);
    // A state in contact may carry the acceleration of one close by.
    let beside = gap_acceleration(system, &flight.state(S::Real::ZERO));
    [structure, structure + system.lever() * beside]
}

/// ÿ of an absorber free in its gap: the distance to a wall s is d − s y.
fn gap_acceleration<S: System>(system: &S, state: &S::State) -> S::Real {
    -(system.distance(state).curvature * system.wall(state).sign())
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
    /// Accelerations before and after the impact under way.
    jumped: [[R; 2]; 2],
    /// The samples taken so far, in the order of time.
    pub states: Vec<State<R>>,
}

impl<R: Real> Sampler<R> {
    /// Samples at `times`, which must not decrease.
    pub fn at(times: Vec<R>) -> Self {
        let states = Vec::with_capacity(times.len());
        let (duration, jumped) = (R::ZERO, [[R::ZERO; 2]; 2]);
        Self { times, next: 0, events: false, duration, jumped, states }
    }

    /// Samples at `times` and both states of every impact.
    pub fn with_events(times: Vec<R>) -> Self {
        Self { events: true, ..Self::at(times) }
    }
}

impl<R: Real, S: System<Real = R>> Observer<S> for Sampler<R> {
    fn start(&mut self, _system: &S, from: &Instant<S::State, R>, duration: R) {
        self.next = self.times.iter().take_while(|time| **time < from.time.value).count();
        self.duration = duration;
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
            // At the very instant of an event it is the state that the run goes on from.
            let h = if h <= time * slack { R::ZERO } else { h.clamp(0.0, span.length) };
            let (primary, gap) = (span.motion.primary(h), span.motion.gap(h));
            let state = span.motion.state(h);
            let acceleration = span.motion.acceleration(h);
            let beside = match span.motion.wall() {
                Some(_) => R::ZERO,
                None => system.lever() * gap_acceleration(system, &state),
            };
            self.states.push(State {
                time,
                displacement: primary.value,
                velocity: primary.rate,
                gap_displacement: gap.y,
                gap_velocity: gap.w,
                wall: span.motion.wall().map_or(0, |wall| wall.number()),
                acceleration,
                absorber_acceleration: acceleration + beside,
                angle: system.angle(&state),
            });
            self.next += 1;
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        if self.events {
            self.jumped = contact.states.map(|state| accelerations(system, state));
        }
    }

    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        if !self.events {
            return;
        }
        let angles = system.impact_angles(impact);
        let [[acceleration, absorber_acceleration], after] = self.jumped;
        let before = State {
            time: impact.time,
            displacement: impact.displacement,
            velocity: impact.velocity_before,
            gap_displacement: system.offset() + system.clearance() * impact.wall.sign(),
            gap_velocity: impact.gap_velocity_before,
            wall: 0,
            acceleration,
            absorber_acceleration,
            angle: angles.map(|[before, _]| before),
        };
        let after = State {
            velocity: impact.velocity_after,
            gap_velocity: impact.gap_velocity_after,
            acceleration: after[0],
            absorber_acceleration: after[1],
            angle: angles.map(|[_, after]| after),
            ..before
        };
        self.states.extend([before, after]);
    }
}

pub(crate) fn span_ends<R: Real>(start: &Clock<R>, length: R, duration: R) -> bool {
    start.plus(length).minus(duration) >= -R::EPSILON * duration
}
