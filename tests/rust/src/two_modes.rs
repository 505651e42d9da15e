//! A free mass on a structure with two modes: a host that the core does not have, in one file. The engine needs no
//! more of it than of any other system.
//!
//! With mass-normalised modes q̈ᵢ + 2ζᵢωᵢ q̇ᵢ + ωᵢ² qᵢ = 0 and x = Σ φᵢqᵢ at the absorber, a flight is two damped
//! sinusoids in closed form, and the gap obeys ÿ = −ẍ. An impulse P at the absorber changes q̇ᵢ by φᵢP.

use iva_core::{
    absorber::{Absorber, Clock, ImpactLaw, LawAt, OnStructure, Point, Start, Wall},
    compensated::DoubleDouble,
    error::Invalid,
    flight::{Curve, GapPoint, Jet, Losses, Motion},
    host::Still,
    impact::Impact,
    siva::check_start,
    taylor::{Number, ORDER, Row, horner},
};

/// The structure and its absorber.
#[derive(Debug, Clone, Copy)]
pub struct TwoModes {
    /// ωᵢ.
    pub frequencies: [f64; 2],
    /// ζᵢ.
    pub damping_ratios: [f64; 2],
    /// φᵢ.
    pub shapes: [f64; 2],
    /// Mass of the absorber, its restitution, and its clearance.
    pub absorber: [f64; 3],
}

/// The state between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// qᵢ and q̇ᵢ.
    pub modes: [[f64; 2]; 2],
    side: f64,
    distance: f64,
    rate: f64,
}

impl TwoModes {
    /// The state at rest in the middle of the gap, with these modal displacements.
    pub fn displaced(&self, places: [f64; 2]) -> State {
        let modes = places.map(|q| [q, 0.0]);
        State { modes, side: 1.0, distance: self.absorber[2], rate: 0.0 }
    }

    /// Σ φᵢ² over the mass of the structure at the absorber.
    fn mobility(&self) -> f64 {
        self.shapes.iter().map(|phi| phi * phi).sum()
    }

    /// x of values of both modes.
    fn seen(&self, modes: impl Fn(usize) -> f64) -> f64 {
        self.shapes[0] * modes(0) + self.shapes[1] * modes(1)
    }

    /// qᵢ and its first four derivatives, in flight or with the absorber stuck.
    fn derivatives(&self, at: &State, stuck: bool) -> [[f64; 5]; 2] {
        let mut all = at.modes.map(|[q, v]| [q, v, 0.0, 0.0, 0.0]);
        for n in 2..5 {
            let below = [0, 1].map(|i| [all[i][n - 2], all[i][n - 1]]);
            let next = self.accelerations(below, stuck);
            (all[0][n], all[1][n]) = (next[0], next[1]);
        }
        all
    }

    /// q̈ᵢ: with the absorber stuck, (I + m φφᵀ) q̈ has the forces of springs and dampers.
    fn accelerations<T: Number<Real = f64>>(&self, modes: [[T; 2]; 2], stuck: bool) -> [T; 2] {
        let n = T::from_real;
        let own = [0, 1].map(|i| {
            let (w, zeta) = (n(self.frequencies[i]), n(self.damping_ratios[i]));
            let [q, v] = modes[i];
            n(0.0) - w * (w * q + n(2.0) * zeta * v)
        });
        if !stuck {
            return own;
        }
        let [mass, ..] = self.absorber;
        let carried = n(mass / (1.0 + mass * self.mobility()))
            * (n(self.shapes[0]) * own[0] + n(self.shapes[1]) * own[1]);
        [0, 1].map(|i| own[i] - n(self.shapes[i]) * carried)
    }

    /// The power series of both modes.
    fn series<T: Number<Real = f64>>(&self, from: &State, stuck: bool) -> [Row<T>; 2] {
        let n = T::from_real;
        let [mut first, mut second] = [[n(0.0); ORDER + 1]; 2];
        let mut term = from.modes.map(|mode| mode.map(n));
        for (k, (first, second)) in first.iter_mut().zip(&mut second).enumerate() {
            (*first, *second) = (term[0][0], term[1][0]);
            let a = self.accelerations(term, stuck);
            let over = T::reciprocal(k + 1);
            term = [0, 1].map(|i| [term[i][1] * over, a[i] * over]);
        }
        [first, second]
    }

    /// A mode in free motion a time h later.
    fn swung(&self, i: usize, [q, v]: [f64; 2], h: f64) -> [f64; 2] {
        let (w, zeta) = (self.frequencies[i], self.damping_ratios[i]);
        let (rate, damped) = (zeta * w, w * (1.0 - zeta * zeta).sqrt());
        let ((sine, cosine), decay) = ((damped * h).sin_cos(), (-rate * h).exp());
        [
            decay * (q * cosine + (v + rate * q) / damped * sine),
            decay * (v * cosine - (w * w * q + rate * v) / damped * sine),
        ]
    }

    /// The structure with an impulse P at the absorber.
    fn pushed(&self, modes: [[f64; 2]; 2], impulse: f64) -> [[f64; 2]; 2] {
        [0, 1].map(|i| [modes[i][0], modes[i][1] + self.shapes[i] * impulse])
    }

    /// The state after an impact with restitution e, and the energy lost.
    fn struck(&self, at: &State, e: f64) -> (State, f64) {
        let reduced = 1.0 / (1.0 / self.absorber[0] + self.mobility());
        let impulse = (1.0 + e) * reduced * (-at.side * at.rate);
        let after = State { modes: self.pushed(at.modes, impulse), rate: -e * at.rate, ..*at };
        (after, 0.5 * reduced * (1.0 - e * e) * at.rate * at.rate)
    }
}

/// A flight, or a stick episode.
#[derive(Debug)]
pub struct Segment<'a, const STUCK: bool> {
    system: &'a TwoModes,
    from: State,
}

impl<const STUCK: bool> Segment<'_, STUCK> {
    fn modes(&self, h: f64) -> [[f64; 2]; 2] {
        let Self { system, from } = self;
        if !STUCK {
            return [0, 1].map(|i| system.swung(i, from.modes[i], h));
        }
        system.series::<f64>(from, true).map(|row| {
            let rate: Vec<f64> = (1..=ORDER).map(|k| row[k] * k as f64).collect();
            [horner(&row, h), horner(&rate, h)]
        })
    }
}

impl<const STUCK: bool> Motion for Segment<'_, STUCK> {
    type Real = f64;
    type State = State;
    const RIDING: bool = STUCK;

    fn origin(&self) -> &State {
        &self.from
    }

    fn reach(&self) -> f64 {
        0.6 / self.system.frequencies[1].max(self.system.frequencies[0])
    }

    fn state(&self, h: f64) -> State {
        let (system, from, modes) = (self.system, &self.from, self.modes(h));
        if STUCK {
            return State { modes, ..*from };
        }
        let x = system.seen(|i| modes[i][0] - from.modes[i][0] - from.modes[i][1] * h);
        let v = system.seen(|i| modes[i][1] - from.modes[i][1]);
        let distance = from.distance + from.rate * h + from.side * x;
        State { modes, distance, rate: from.rate + from.side * v, ..*from }
    }

    fn primary(&self, h: f64) -> Jet {
        let all = self.system.derivatives(&self.state(h), STUCK);
        let [value, rate, curvature, jerk] = [0, 1, 2, 3].map(|n| self.system.seen(|i| all[i][n]));
        Jet { value, rate, curvature, jerk }
    }

    fn gap(&self, h: f64) -> GapPoint {
        let State { side, distance, rate, .. } = self.state(h);
        GapPoint { y: side * (self.system.absorber[2] - distance), w: -side * rate }
    }

    fn wall(&self) -> Option<Wall> {
        STUCK.then(|| self.system.wall(&self.from))
    }

    /// Σ ∫ 2ζᵢωᵢ q̇ᵢ² by Simpson's rule over short parts: a ledger of twelve digits.
    fn losses(&self, h: f64) -> Losses {
        let parts = 64;
        let mut viscous = 0.0;
        for k in 0..=parts {
            let weight = if k % parts == 0 { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
            let modes = self.modes(h * f64::from(k) / f64::from(parts));
            let lost = |i: usize| {
                2.0 * self.system.damping_ratios[i]
                    * self.system.frequencies[i]
                    * modes[i][1].powi(2)
            };
            viscous += weight * (lost(0) + lost(1));
        }
        Losses { viscous: viscous * h / (3.0 * f64::from(parts)), pivot: 0.0, work: 0.0 }
    }
}

impl<const STUCK: bool> Segment<'_, STUCK> {
    /// The curve at a state.
    fn seen_at(&self, at: &State) -> Jet {
        let mut later = *at;
        if STUCK {
            // The pressure is −s ẍ, with the accelerations in place of the places.
            let all = self.system.derivatives(at, true);
            later.modes = all.map(|mode| [mode[2], mode[3]]);
            let all = self.system.derivatives(&later, true);
            let [value, rate, curvature, jerk] =
                [0, 1, 2, 3].map(|n| -at.side * self.system.seen(|i| all[i][n]));
            return Jet { value, rate, curvature, jerk };
        }
        self.system.distance(at)
    }
}

/// The distance to the wall in flight, the pressure on it if stuck.
impl<const STUCK: bool> Curve for Segment<'_, STUCK> {
    type Real = f64;

    fn jet(&self, h: f64) -> Jet {
        self.seen_at(&self.state(h))
    }

    fn first(&self) -> Jet {
        self.seen_at(&self.from)
    }

    fn precise(&self, h: f64) -> DoubleDouble {
        let Self { system, from } = self;
        if STUCK {
            return DoubleDouble::new(self.jet(h).value);
        }
        let series = system.series::<DoubleDouble>(from, false);
        let t = DoubleDouble::new(h);
        let bent = [0, 1].map(|i| horner(&series[i][2..], t).times(system.shapes[i]));
        let moved = (bent[0] + bent[1]) * t * t;
        DoubleDouble::new(from.distance) + t.times(from.rate) + moved.times(from.side)
    }

    /// The energy of each derivative of a mode decreases, and bounds the next one.
    fn fourth(&self) -> f64 {
        let shift = if STUCK { 2 } else { 0 };
        let mut at = self.from;
        for _ in 0..shift {
            let all = self.system.derivatives(&at, STUCK);
            at.modes = all.map(|mode| [mode[1], mode[2]]);
        }
        let all = self.system.derivatives(&at, STUCK);
        let size = |i: usize| all[i][4].hypot(self.system.frequencies[i] * all[i][3]);
        // Stuck, the modes exchange energy.
        let [a, b] = [size(0), size(1)];
        let both = if STUCK { [a + b; 2] } else { [a, b] };
        let exchange =
            if STUCK { 1.0 + self.system.absorber[0] * self.system.mobility() } else { 1.0 };
        self.system.shapes[0].abs() * both[0] * exchange
            + self.system.shapes[1].abs() * both[1] * exchange
    }

    fn magnitude(&self) -> f64 {
        if STUCK { self.system.frequencies[1].powi(2) } else { self.system.absorber[2] }
    }
}

impl OnStructure for TwoModes {
    type Real = f64;
    type Excitation = Still;
    type State = State;

    fn excitation(&self) -> &Still {
        Still::NONE
    }

    fn phase(_state: &State) -> &() {
        &()
    }

    fn mass_ratio(&self) -> f64 {
        self.absorber[0]
    }

    fn primary(&self, state: &State) -> Point {
        Point { x: self.seen(|i| state.modes[i][0]), v: self.seen(|i| state.modes[i][1]) }
    }

    fn energy(&self, state: &State) -> f64 {
        let mode = |i: usize| {
            let [q, v] = state.modes[i];
            0.5 * (v * v + (self.frequencies[i] * q).powi(2))
        };
        let absorber = self.primary(state).v - state.side * state.rate;
        mode(0) + mode(1) + 0.5 * self.absorber[0] * absorber * absorber
    }
}

impl ImpactLaw for TwoModes {
    /// The dampers of both modes respond to the jumps of their velocities.
    fn law_of(&self, _absorber: usize, _wall: Wall, _approach: f64) -> LawAt {
        let [mass, rebound, _] = self.absorber;
        let impulse = (1.0 + rebound) / (1.0 / mass + self.mobility());
        let rise = |i: usize| 2.0 * self.damping_ratios[i] * self.frequencies[i] * self.shapes[i];
        LawAt::constant(rebound, rebound, impulse * self.mobility(), impulse * self.seen(rise))
    }

    fn impact(&self, state: &State, time: f64) -> (State, Impact) {
        let [_, e, _] = self.absorber;
        let (after, energy_loss) = self.struck(state, e);
        let impact = Impact {
            time,
            absorber: 0,
            wall: self.wall(state),
            displacement: self.primary(state).x,
            velocity_before: self.primary(state).v,
            velocity_after: self.primary(&after).v,
            gap_velocity_before: -state.side * state.rate,
            gap_velocity_after: -after.side * after.rate,
            lever: 1.0,
            energy_loss,
        };
        (after, impact)
    }

    fn stick(&self, state: &State) -> (State, f64) {
        let (stuck, lost) = self.struck(state, 0.0);
        (State { distance: 0.0, rate: 0.0, ..stuck }, lost)
    }
}

impl Absorber for TwoModes {
    /// The start of the absorber, and the modal displacements.
    type Start = [f64; 2];
    type Flight<'a> = Segment<'a, false>;
    type Ride<'a> = Segment<'a, true>;

    fn clearance(&self) -> f64 {
        self.absorber[2]
    }

    fn check_start(&self, _start: &[f64; 2]) -> Result<(), Invalid> {
        check_start(self.absorber[2], 0.0, &Start::default())
    }

    fn begin_at(&self, start: &[f64; 2], _time: Clock) -> State {
        self.displaced(*start)
    }

    fn flight(&self, state: &State) -> Segment<'_, false> {
        Segment { system: self, from: *state }
    }

    fn ride(&self, state: &State) -> Segment<'_, true> {
        Segment { system: self, from: *state }
    }

    fn wall(&self, state: &State) -> Wall {
        if state.side > 0.0 { Wall::Plus } else { Wall::Minus }
    }

    fn distance(&self, state: &State) -> Jet {
        let all = self.derivatives(state, false);
        let [curvature, jerk] = [2, 3].map(|n| state.side * self.seen(|i| all[i][n]));
        Jet { value: state.distance, rate: state.rate, curvature, jerk }
    }

    fn touch(&self, state: &State, wall: Wall) -> (State, f64) {
        let turn = if wall == self.wall(state) { 1.0 } else { -1.0 };
        let left =
            if turn > 0.0 { state.distance } else { 2.0 * self.absorber[2] - state.distance };
        let later = if state.rate == 0.0 { 0.0 } else { -left / (turn * state.rate) };
        let end = self.flight(state).state(later);
        (State { side: turn * end.side, distance: 0.0, rate: turn * end.rate, ..end }, later)
    }

    fn release(&self, state: &State) -> (State, f64) {
        (*state, 0.0)
    }
}
