//! A third absorber, in one file: a free mass in a gap, with a linear dashpot between it and the structure.
//!
//! ```text
//! ẍ + 2ζẋ + x = μγw,    ẇ = −ẍ − γw,    w = ẏ,
//! ```
//!
//! with γ the constant of the dashpot over the absorber's mass. The flight is a power series; impacts are
//! those of a free mass. States are plain numbers, so runs are less accurate than those of `iva_core::siva`.

use iva_core::compensated::DoubleDouble;
use iva_core::flight::{Curve, GapPoint, Jet, Losses, Motion};
use iva_core::impact::{self, Impact};
use iva_core::lanes::SideBySide;
use iva_core::polynomial::product_integral;
use iva_core::propagation::{Differentiable, free_mass_impact, free_mass_stick};
use iva_core::real::Real;
use iva_core::system::{Clock, Point, Start, System, Wall};
use iva_core::taylor::{Number, ORDER, Row, horner};
use nalgebra::{Matrix4, Vector4};

/// The absorber on its structure: μ, e, d, ζ and γ.
#[derive(Debug, Clone, Copy)]
pub struct Dashpot<R = f64>(pub [R; 5]);

/// The state of structure and gap between events; `side` is the sign of the wall that distances are measured
/// from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<R = f64> {
    x: R,
    v: R,
    side: R,
    distance: R,
    rate: R,
}

/// Value and derivatives at the begin of a series.
fn jet<R: Real>(row: &[R]) -> Jet<R> {
    Jet { value: row[0], rate: row[1], curvature: row[2] * 2.0, jerk: row[3] * 6.0 }
}

impl<R: Real> Dashpot<R> {
    /// Coefficients of x, v, w and the distance in powers of time; if stuck, of the mass 1 + μ, with the
    /// pressure s (x + 2ζv) in place of the distance.
    fn series<T: Number<Real = R>>(&self, from: &State<R>, stuck: bool) -> [Row<T>; 4] {
        let n = T::from_real;
        let [mu, _, _, zeta, gamma] = self.0.map(n);
        let (side, mut s) = (n(from.side), [[n(R::ZERO); ORDER + 1]; 4]);
        (s[0][0], s[1][0], s[3][0]) = (n(from.x), n(from.v), n(from.distance));
        s[2][0] = if stuck { n(R::ZERO) } else { -side * n(from.rate) };
        let mass = if stuck { n(R::ONE) + mu } else { n(R::ONE) };
        for k in 0..=ORDER {
            let (drag, over) = (gamma * s[2][k], T::reciprocal(k + 1));
            let pull = s[0][k] + (zeta + zeta) * s[1][k];
            let a = (mu * drag - pull) / mass;
            if k < ORDER {
                (s[0][k + 1], s[1][k + 1]) = (s[1][k] * over, a * over);
                s[2][k + 1] = if stuck { s[2][k] } else { -(a + drag) * over };
                s[3][k + 1] = -side * s[2][k] * over;
            }
            if stuck {
                s[3][k] = side * pull;
            }
        }
        s
    }

    /// A bound on the rates of x, v and w, over the largest of them.
    fn growth(&self) -> R {
        let [mu, _, _, zeta, gamma] = self.0;
        R::ONE + zeta * 2.0 + (R::ONE + mu) * gamma
    }
}

/// A flight in the gap, or a stick episode on a wall.
#[derive(Debug)]
pub struct Segment<'a, R: Real, const STUCK: bool> {
    system: &'a Dashpot<R>,
    from: State<R>,
    series: [Row<R>; 4],
}

impl<R: Real, const STUCK: bool> Motion for Segment<'_, R, STUCK> {
    type Real = R;
    type State = State<R>;
    const RIDING: bool = STUCK;
    fn origin(&self) -> &State<R> {
        &self.from
    }
    fn reach(&self) -> R {
        R::ONE / self.system.growth()
    }
    fn state(&self, h: R) -> State<R> {
        let [x, v, w, distance] = [0, 1, 2, 3].map(|i| horner(&self.series[i], h));
        let distance = if STUCK { R::ZERO } else { distance };
        State { x, v, distance, rate: -self.from.side * w, ..self.from }
    }
    fn primary(&self, h: R) -> Jet<R> {
        jet(&self.system.series::<R>(&self.state(h), STUCK)[0])
    }
    fn gap(&self, h: R) -> GapPoint<R> {
        let State { side, distance, rate, .. } = self.state(h);
        GapPoint { y: side * (self.system.clearance() - distance), w: -side * rate }
    }
    fn wall(&self) -> Option<Wall> {
        STUCK.then(|| self.system.wall(&self.from))
    }
    fn losses(&self, h: R) -> Losses<R> {
        let square = |row: &Row<R>| product_integral(row, row, h);
        let ([mu, _, _, zeta, gamma], [_, v, w, _]) = (self.system.0, &self.series);
        Losses { viscous: zeta * 2.0 * square(v), pivot: mu * gamma * square(w), work: R::ZERO }
    }
}

/// The distance to the wall in flight, the pressure on the wall if stuck.
impl<R: Real, const STUCK: bool> Curve for Segment<'_, R, STUCK> {
    type Real = R;
    type Sample = State<R>;
    fn sample(&self, h: R) -> State<R> {
        self.state(h)
    }
    fn jet(&self, sample: &State<R>) -> Jet<R> {
        jet(&self.system.series::<R>(sample, STUCK)[3])
    }
    fn precise(&self, h: R) -> DoubleDouble<R> {
        horner(&self.system.series::<DoubleDouble<R>>(&self.from, STUCK)[3], DoubleDouble::new(h))
    }
    /// Within the reach no variable grows by more than the factor e.
    fn fourth(&self) -> R {
        let State { x, v, rate, .. } = self.from;
        x.abs().max(v.abs()).max(rate.abs()) * self.system.growth().powi(5) * 2.72
    }
    fn magnitude(&self) -> R {
        let pressure = (self.from.x.abs() + self.from.v.abs()) * self.system.growth();
        if STUCK { pressure } else { self.system.clearance() }
    }
}

impl<R: Real> System for Dashpot<R> {
    type Real = R;
    type State = State<R>;
    type Start = Start<R>;
    type Flight<'a> = Segment<'a, R, false>;
    type Ride<'a> = Segment<'a, R, true>;
    fn clearance(&self) -> R {
        self.0[2]
    }
    fn rebound_ratio(&self, _wall: Wall) -> R {
        self.0[1]
    }
    fn impact_gain(&self, _wall: Wall) -> R {
        impact::primary_share(self.0[0], self.0[1]).value
    }
    fn pressure_gain(&self, _wall: Wall) -> R {
        let [mu, e, _, zeta, gamma] = self.0;
        zeta * 2.0 * impact::primary_share(mu, e).value + (R::ONE + mu) * gamma * (e + 1.0)
    }
    fn begin_at(&self, start: &Start<R>, _time: Clock<R>) -> State<R> {
        let Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w } = *start;
        let first = [y, w, x, v].into_iter().find(|it| *it != 0.0);
        let side = R::from(if first < Some(R::ZERO) { -1.0 } else { 1.0 });
        State { x, v, side, distance: self.clearance() - side * y, rate: -side * w }
    }
    fn flight(&self, state: &State<R>) -> Self::Flight<'_> {
        Segment { system: self, from: *state, series: self.series(state, false) }
    }
    fn ride(&self, state: &State<R>) -> Self::Ride<'_> {
        Segment { system: self, from: *state, series: self.series(state, true) }
    }
    fn wall(&self, state: &State<R>) -> Wall {
        if state.side > 0.0 { Wall::Plus } else { Wall::Minus }
    }
    fn distance(&self, state: &State<R>) -> Jet<R> {
        jet(&self.series::<R>(state, false)[3])
    }
    fn touch(&self, state: &State<R>, wall: Wall) -> (State<R>, R) {
        let Jet { value, rate, curvature, .. } = self.distance(state);
        let far = wall != self.wall(state);
        let (left, sign) = if far { (self.0[2] * 2.0 - value, -1.0) } else { (value, 1.0) };
        let later = impact::delay(left, rate * sign, curvature * sign);
        let end = self.flight(state).state(later);
        (State { side: end.side * sign, distance: R::ZERO, rate: end.rate * sign, ..end }, later)
    }
    fn impact(&self, state: &State<R>, time: R) -> (State<R>, Impact<R>) {
        let ([mu, e, ..], wall, before) = (self.0, self.wall(state), self.primary(state));
        let impact = Impact::of_free_mass([mu, e], time, wall, before, -state.side * state.rate);
        (State { v: impact.velocity_after, rate: -e * state.rate, ..*state }, impact)
    }
    fn stick(&self, state: &State<R>) -> (State<R>, R) {
        let plastic = Dashpot([self.0[0], R::ZERO, self.0[2], self.0[3], self.0[4]]);
        let (stuck, impact) = plastic.impact(state, R::ZERO);
        (State { distance: R::ZERO, rate: R::ZERO, ..stuck }, impact.energy_loss)
    }
    fn release(&self, state: &State<R>) -> (State<R>, R) {
        // At the release the pressure is 0; x is set to the displacement for that.
        (State { x: -self.0[3] * 2.0 * state.v, ..*state }, R::ZERO)
    }
    fn primary(&self, state: &State<R>) -> Point<R> {
        Point { x: state.x, v: state.v }
    }
    fn energy(&self, state: &State<R>) -> R {
        let absorber = state.v - state.side * state.rate;
        (state.x * state.x + state.v * state.v + self.0[0] * (absorber * absorber)) * 0.5
    }
}

impl SideBySide for Dashpot {}

impl Differentiable for Dashpot {
    fn rates(&self, state: &State) -> Vector4<f64> {
        let [_, v, w, _] = self.series::<f64>(state, false);
        Vector4::new(v[0], v[1], w[0], w[1])
    }
    fn flight_tangent(&self, _from: &State, h: f64) -> Matrix4<f64> {
        self.tangent(h, false)
    }
    fn ride_tangent(&self, _from: &State, h: f64) -> Matrix4<f64> {
        self.tangent(h, true)
    }
    fn impact_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        free_mass_impact(impact::primary_share(self.0[0], self.0[1]).value, self.0[1])
    }
    fn stick_matrix(&self, _wall: Wall) -> Matrix4<f64> {
        free_mass_stick(impact::primary_share(self.0[0], 0.0).value)
    }
}

impl Dashpot {
    /// The motion is linear, so its derivative consists of the motions from the unit states of (x, v, y, w).
    fn tangent(&self, h: f64, stuck: bool) -> Matrix4<f64> {
        Matrix4::from_columns(&[0, 1, 2, 3].map(|i| {
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            let from =
                State { x: unit(0), v: unit(1), side: -1.0, distance: unit(2), rate: unit(3) };
            let [x, v, w, y] = self.series::<f64>(&from, stuck).map(|row| horner(&row, h));
            if stuck { Vector4::new(x, v, 0.0, 0.0) } else { Vector4::new(x, v, y, w) }
        }))
    }
}
