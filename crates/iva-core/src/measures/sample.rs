//! The motion at given instants, evaluated exactly and never interpolated.

use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Angle, Clock, Point};
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::wall::presses;
use crate::engine::simulate::{Instant, Outcome, Tally};
use crate::number::clock::SLACK;
use crate::number::real::Real;
use crate::segment::flight::{GapPoint, Motion, Seen};

/// Primary and absorber at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<R = f64> {
    /// Instant, in 1/ωn.
    pub time: R,
    /// The index of the absorber: of several there is a state of each at every instant.
    pub absorber: u8,
    /// Displacement of the primary.
    pub displacement: R,
    /// Velocity of the primary.
    pub velocity: R,
    /// Absorber minus primary displacement.
    pub gap_displacement: R,
    /// Absorber minus primary velocity.
    pub gap_velocity: R,
    /// 0 in flight, ±1 while stuck on a wall. The tail of a chatter counts as stuck from the instant at which
    /// it is summed: its rebounds are only some 10⁻¹² A/ωn² high, with A the acceleration towards the wall.
    pub wall: i8,
    /// Absolute acceleration ẍ + a_g of the structure, without the jumps of velocity at impacts.
    pub acceleration: R,
    /// Absolute acceleration of the absorber's centre of mass along the motion, without the jumps at impacts.
    pub absorber_acceleration: R,
    /// Energy of structure and absorber, per primary mass in ωn² × length².
    pub energy: R,
    /// Angle and angular velocity of a pendulum; `None` for a free mass.
    pub angle: Option<Angle<R>>,
}

/// Absolute accelerations of structure and absorber at a state, with the absorber free in its gap.
fn accelerations<S: Absorber>(system: &S, state: &S::State) -> [S::Real; 2] {
    let flight = system.flight(state);
    let structure = flight.acceleration(S::Real::ZERO);
    let own = flight.acceleration_at(system.at_hand(state), S::Real::ZERO).unwrap_or(structure);
    // A state in contact may hold the acceleration of a state close by, so it is computed anew.
    [structure, own + beside(system, &flight.state(S::Real::ZERO), flight.gap(S::Real::ZERO))]
}

/// The acceleration beside the structure of an absorber free in its gap: the distance to a wall s is d − s y.
fn beside<S: Absorber>(system: &S, state: &S::State, gap: GapPoint<S::Real>) -> S::Real {
    let bend = -(system.distance(state).curvature * system.wall(state).sign());
    system.beside(system.at_hand(state), [gap.y, gap.w, bend])[2]
}

/// An observer that samples a run at increasing instants. At the instant of an impact it takes the state
/// after it.
#[derive(Debug, Clone)]
pub struct Sampler<R = f64> {
    times: Vec<R>,
    next: usize,
    events: bool,
    duration: R,
    /// Accelerations of structure and absorber, before and after the current impact.
    jumped: [[R; 2]; 2],
    /// Energy before and after it.
    energies: [R; 2],
    /// The structure before and after it, where a run sees another point of it than that of the impact.
    elsewhere: Option<[Point<R>; 2]>,
    /// True if nothing has come after the last impact.
    landed: bool,
    /// The samples taken so far, in order of time.
    pub states: Vec<State<R>>,
    /// q and q̇ of each mode of a structure with points at each sample, if they are wanted.
    pub modes: Option<Vec<Vec<Point<R>>>>,
}

impl<R: Real> Sampler<R> {
    /// Samples at `times`, which must not decrease.
    pub fn at(times: Vec<R>) -> Self {
        let states = Vec::with_capacity(times.len());
        Self {
            times,
            next: 0,
            events: false,
            duration: R::ZERO,
            jumped: [[R::ZERO; 2]; 2],
            energies: [R::ZERO; 2],
            elsewhere: None,
            landed: false,
            states,
            modes: None,
        }
    }

    /// Samples at `times` with q and q̇ of each mode.
    pub fn with_modes(times: Vec<R>) -> Self {
        Self { modes: Some(Vec::new()), ..Self::at(times) }
    }

    /// Samples at `times` and both states of every impact.
    pub fn with_events(times: Vec<R>) -> Self {
        Self { events: true, ..Self::at(times) }
    }

    /// Takes the next sample, a time h after the begin of a motion.
    fn take<S: Absorber<Real = R>, M: Motion<Real = R, State = S::State>>(
        &mut self,
        system: &S,
        motion: &M,
        time: R,
        h: R,
    ) {
        let Seen { state, primary, gap, acceleration } = motion.seen(h);
        let energy = system.energy(&state);
        if let Some(modes) = &mut self.modes {
            modes.push(system.modes_of(&state));
        }
        for absorber in 0..motion.absorbers().max(1) {
            let single = motion.absorbers() <= 1;
            let gap = if single { gap } else { motion.gap_of(absorber, h) };
            let (wall, state) = (motion.wall_of(absorber), system.turned_to(&state, absorber));
            let beside = match wall {
                Some(_) => R::ZERO,
                None => beside(system, &state, gap),
            };
            let own = motion.acceleration_at(absorber, h).unwrap_or(acceleration);
            self.states.push(State {
                time,
                absorber: absorber as u8,
                displacement: primary.x,
                velocity: primary.v,
                gap_displacement: gap.y,
                gap_velocity: gap.w,
                wall: wall.map_or(0, |wall| wall.number()),
                acceleration,
                absorber_acceleration: own + beside,
                energy,
                angle: system.angle(&state),
            });
        }
        self.next += 1;
    }
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Sampler<R> {
    fn start(&mut self, _system: &S, from: &Instant<S::State, R>, duration: R) {
        // A sample at the begin may be a rounding before it.
        let early = |time: &&R| **time + **time * SLACK < from.time.value;
        self.next = self.times.iter().take_while(early).count();
        self.duration = duration;
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        while let Some(time) = self.times.get(self.next).copied() {
            let h = -span.start.minus(time);
            // A sample at the end may be a rounding before it: nothing comes after to take it.
            let last = time + time * SLACK >= self.duration
                && span_ends(&span.start, span.length, self.duration);
            // With events recorded, a sample is not moved to the instant of an event.
            let slack = if self.events { 0.0 } else { SLACK };
            if h >= span.length - time * slack && !last {
                break;
            }
            // At the instant of an event: the state from which the run goes on.
            let h = if h <= time * slack { R::ZERO } else { h.clamp(0.0, span.length) };
            self.take(system, span.motion, time, h);
        }
        self.landed = false;
    }

    /// The second row of an impact that sticks at once is a state on the wall.
    fn stick(&mut self, system: &S, Instant { state: after, .. }: &Instant<S::State, R>) {
        let absorber = system.at_hand(after) as u8;
        let landed = |row: &&mut State<R>| row.absorber == absorber && row.gap_velocity == 0.0;
        let row = self.states.last_mut().filter(|row| self.landed && landed(row));
        if let Some(row) = row {
            let ride = system.ride(after);
            row.wall = system.wall(after).number();
            row.acceleration = ride.acceleration(R::ZERO);
            let own = ride.acceleration_at(absorber.into(), R::ZERO);
            row.absorber_acceleration = own.unwrap_or(row.acceleration);
        }
    }

    /// A sample at the end of a run that ended early takes the last state.
    fn end(&mut self, system: &S, tally: &Tally<S::State, R>) {
        let (state, end) = (&tally.state, tally.end_time);
        if tally.outcome == Outcome::NotFinite {
            return;
        }
        while let Some(time) = self.times.get(self.next).copied() {
            if time > end + end * SLACK {
                break;
            }
            let leave = system.distance(state);
            if leave.value == 0.0 && presses(&leave) {
                self.take(system, &system.ride(state), time, R::ZERO);
            } else {
                self.take(system, &system.flight(state), time, R::ZERO);
            }
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        if self.events {
            self.jumped = contact.states.map(|state| accelerations(system, state));
            self.energies = contact.states.map(|state| system.energy(state));
            let seen = || contact.states.map(|state| system.primary(state));
            self.elsewhere = system.has_points().then(seen);
        }
    }

    fn impact(&mut self, system: &S, impact: &Impact<R>) {
        if !self.events {
            return;
        }
        let angles = system.impact_angles(impact);
        let [[acceleration, absorber_acceleration], after] = self.jumped;
        let absorber = usize::from(impact.absorber);
        let (middle, d) = (system.offset_of(absorber), system.clearance_of(absorber));
        let here = |v| Point { x: impact.displacement, v };
        let here = [impact.velocity_before, impact.velocity_after].map(here);
        let [seen_before, seen_after] = self.elsewhere.unwrap_or(here);
        let before = State {
            time: impact.time,
            absorber: impact.absorber,
            displacement: seen_before.x,
            velocity: seen_before.v,
            gap_displacement: middle + d * impact.wall.sign(),
            gap_velocity: impact.gap_velocity_before,
            wall: 0,
            acceleration,
            absorber_acceleration,
            energy: self.energies[0],
            angle: angles.map(|[before, _]| before),
        };
        let after = State {
            velocity: seen_after.v,
            gap_velocity: impact.gap_velocity_after,
            acceleration: after[0],
            absorber_acceleration: after[1],
            energy: self.energies[1],
            angle: angles.map(|[_, after]| after),
            ..before
        };
        self.states.extend([before, after]);
        self.landed = true;
    }
}

pub(crate) fn span_ends<R: Real>(start: &Clock<R>, length: R, duration: R) -> bool {
    start.plus(length).minus(duration) >= -R::EPSILON * duration
}
