//! A free mass that is coupled to its structure in its gap, by a dashpot, a spring or both: any linear
//! coupling.
//!
//! A [`Coupling`] tells the accelerations, linear in x, ẋ, y and w = ẏ, and the constants of mass and walls:
//!
//! ```text
//! ẍ = a(x, ẋ, y, w),    ẇ = b(x, ẋ, y, w).
//! ```
//!
//! All else follows: the flight is the power series of these equations; the mass stuck to a wall moves with the
//! structure by the momentum of both, ẍ = a + μ/(1 + μ) b, and presses on the wall by s b; impacts are those of a
//! free mass. [`Coupled`] runs alone and in lanes, is verified and differentiated, and its errors are estimated.
//! States are plain numbers, so runs are less accurate than those of [`crate::absorber::siva`].

use crate::absorber::impact::{self, Impact};
use crate::absorber::siva::check_start;
use crate::absorber::{Absorber, Clock, ImpactLaw, LawAt, OnStructure, Point, Start, Wall};
use crate::error::Invalid;
use crate::host::Still;
use crate::number::arrays::laned;
use crate::number::real::Real;
use crate::segment::flight::Jet;
use crate::segment::taylor::{Number, ORDER, Row, horner};

pub use segment::Segment;

mod segment;
mod trial;

/// The equations of a free mass on its structure. Natural units: ωn = 1, M = 1.
pub trait Coupling: Copy + std::fmt::Debug {
    /// The number type.
    type Real: Real;
    /// μ, e and d.
    fn constants(&self) -> [Self::Real; 3];
    /// ẍ and ẇ in flight, linear in x, ẋ, y and w.
    fn rates<T: Number<Real = Self::Real>>(&self, z: [T; 4]) -> [T; 2];
    /// Damping coefficients in units of M ωn: of the structure (lost power over ẋ²) and of the gap (over w²).
    fn dampers(&self) -> [Self::Real; 2];
    /// The stiffness of a spring in the gap over that of the structure.
    fn spring(&self) -> Self::Real {
        Self::Real::ZERO
    }
}

/// A free mass with a coupling, on its structure.
#[derive(Debug, Clone, Copy)]
pub struct Coupled<C: Coupling> {
    /// Its equations.
    pub coupling: C,
    /// A bound on the rates of the variables over the largest of them.
    growth: C::Real,
    /// 1 if the accelerations depend on y, else 0.
    sprung: C::Real,
}

/// The state of structure and gap between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledState<R = f64> {
    x: R,
    v: R,
    /// Sign of the wall that distances are measured from.
    side: R,
    distance: R,
    rate: R,
}

laned!(CoupledState, CoupledStates { x: f64, v: f64, side: f64, distance: f64, rate: f64 });

/// Value and derivatives at the begin of a series.
fn jet<R: Real>(row: &[R]) -> Jet<R> {
    Jet { value: row[0], rate: row[1], curvature: row[2] * 2.0, jerk: row[3] * 6.0 }
}

impl<R: Real, C: Coupling<Real = R>> Coupled<C> {
    /// A free mass with these equations.
    pub fn new(coupling: C) -> Self {
        let [mut first, mut second] = [R::ONE; 2];
        let mut sprung = R::ZERO;
        for i in 0..4 {
            let unit = std::array::from_fn(|j| if i == j { R::ONE } else { R::ZERO });
            let [a, b] = coupling.rates::<R>(unit).map(R::abs);
            (first, second) = (first + a, second + b);
            if i == 2 && a + b > 0.0 {
                sprung = R::ONE;
            }
        }
        Self { coupling, growth: R::larger(first, second), sprung }
    }

    /// The state at rest in the middle of the gap.
    pub(crate) fn at_rest(&self) -> CoupledState<R> {
        let ([_, _, distance], zero) = (self.coupling.constants(), R::ZERO);
        CoupledState { x: zero, v: zero, side: R::ONE, distance, rate: zero }
    }

    /// x, ẋ, y and w.
    #[inline(always)]
    pub(crate) fn variables(&self, at: &CoupledState<R>) -> [R; 4] {
        let [_, _, clearance] = self.coupling.constants();
        let CoupledState { x, v, side, distance, rate } = *at;
        [x, v, side * (clearance - distance), -side * rate]
    }

    /// A bound on the variables that the accelerations depend on, within the reach of a motion: there none grows
    /// by more than the factor e.
    #[inline(always)]
    fn most(&self, from: &CoupledState<R>) -> R {
        let [x, v, y, w] = self.variables(from).map(R::abs);
        R::larger(R::larger(x, v), R::larger(w, y * self.sprung)) * 2.72
    }

    /// Coefficients of x, ẋ, w and the distance in powers of time; if stuck, those of both masses together, with
    /// the pressure on the wall in place of the distance.
    #[inline(always)]
    fn series<T: Number<Real = R>>(&self, from: &CoupledState<R>, stuck: bool) -> [Row<T>; 4] {
        let n = T::from_real;
        let [mu, _, clearance] = self.coupling.constants();
        let (side, nothing) = (n(from.side), n(R::ZERO));
        let share = n(mu) / (n(R::ONE) + n(mu));
        let mut s = [[nothing; ORDER + 1]; 4];
        (s[0][0], s[1][0], s[3][0]) = (n(from.x), n(from.v), n(from.distance));
        s[2][0] = if stuck { nothing } else { -side * n(from.rate) };
        let mut y = side * (n(clearance) - n(from.distance));
        for k in 0..=ORDER {
            let [a, b] = self.coupling.rates([s[0][k], s[1][k], y, s[2][k]]);
            let over = T::reciprocal(k + 1);
            y = if stuck { nothing } else { s[2][k] * over };
            if stuck {
                s[3][k] = side * b;
            }
            if k < ORDER {
                let a = if stuck { a + share * b } else { a };
                (s[0][k + 1], s[1][k + 1]) = (s[1][k] * over, a * over);
                s[2][k + 1] = if stuck { nothing } else { b * over };
                s[3][k + 1] = -side * y;
            }
        }
        s
    }

    /// The state a time h later.
    #[inline(always)]
    fn later(
        &self,
        from: &CoupledState<R>,
        series: &[Row<R>; 4],
        stuck: bool,
        h: R,
    ) -> CoupledState<R> {
        let [x, v, w, distance] = series.each_ref().map(
            #[inline(always)]
            |row| horner(row, h),
        );
        let distance = if stuck { R::ZERO } else { distance };
        CoupledState { x, v, distance, rate: -from.side * w, ..*from }
    }
}

impl<R: Real, C: Coupling<Real = R>> OnStructure for Coupled<C> {
    type Real = R;
    type Excitation = Still<R>;
    type State = CoupledState<R>;

    fn excitation(&self) -> &Still<R> {
        Still::NONE
    }

    fn phase(_state: &CoupledState<R>) -> &() {
        &()
    }

    fn mass_ratio(&self) -> R {
        self.coupling.constants()[0]
    }

    fn primary(&self, state: &CoupledState<R>) -> Point<R> {
        Point { x: state.x, v: state.v }
    }

    fn energy(&self, state: &CoupledState<R>) -> R {
        let ([mu, ..], [x, v, y, w]) = (self.coupling.constants(), self.variables(state));
        (x * x + v * v + mu * (v + w) * (v + w) + self.coupling.spring() * (y * y)) * 0.5
    }
}

impl<R: Real, C: Coupling<Real = R>> ImpactLaw for Coupled<C> {
    fn law_of(&self, _absorber: usize, _wall: Wall, _approach: R) -> LawAt<R> {
        let [mu, rebound, _] = self.coupling.constants();
        let gain = impact::primary_share(mu, rebound).value;
        let [_, pressure] = self.coupling.rates([R::ZERO, gain, R::ZERO, -(rebound + 1.0)]);
        LawAt::constant(rebound, rebound, gain, pressure)
    }

    fn impact(&self, state: &CoupledState<R>, time: R) -> (CoupledState<R>, Impact<R>) {
        let ([mu, e, _], wall) = (self.coupling.constants(), self.wall(state));
        let [x, v, _, w] = self.variables(state);
        let impact = Impact::of_free_mass([mu, e], time, wall, Point { x, v }, w);
        (CoupledState { v: impact.velocity_after, rate: -e * state.rate, ..*state }, impact)
    }

    fn stick(&self, state: &CoupledState<R>) -> (CoupledState<R>, R) {
        let ([mu, ..], wall) = (self.coupling.constants(), self.wall(state));
        let [x, v, _, w] = self.variables(state);
        let impact = Impact::of_free_mass([mu, R::ZERO], R::ZERO, wall, Point { x, v }, w);
        let v = impact.velocity_after;
        (CoupledState { v, distance: R::ZERO, rate: R::ZERO, ..*state }, impact.energy_loss)
    }
}

impl<R: Real, C: Coupling<Real = R>> Absorber for Coupled<C> {
    type Start = Start<R>;
    type Flight<'a>
        = Segment<'a, C, false>
    where
        Self: 'a;
    type Ride<'a>
        = Segment<'a, C, true>
    where
        Self: 'a;

    fn clearance(&self) -> R {
        self.coupling.constants()[2]
    }

    fn check_start(&self, start: &Start<R>) -> Result<(), Invalid> {
        check_start(self.clearance(), self.offset(), start)
    }

    fn begin_at(&self, start: &Start<R>, _time: Clock<R>) -> CoupledState<R> {
        let Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w } = *start;
        let first = [y, w, x, v].into_iter().find(|it| *it != 0.0);
        let side = R::from(if first < Some(R::ZERO) { -1.0 } else { 1.0 });
        CoupledState { x, v, side, distance: self.clearance() - side * y, rate: -side * w }
    }

    fn flight(&self, state: &CoupledState<R>) -> Self::Flight<'_> {
        Segment::new(self, *state)
    }

    fn ride(&self, state: &CoupledState<R>) -> Self::Ride<'_> {
        Segment::new(self, *state)
    }

    fn wall(&self, state: &CoupledState<R>) -> Wall {
        if state.side > 0.0 { Wall::Plus } else { Wall::Minus }
    }

    fn distance(&self, state: &CoupledState<R>) -> Jet<R> {
        jet(&self.series::<R>(state, false)[3])
    }

    fn touch(&self, state: &CoupledState<R>, wall: Wall) -> (CoupledState<R>, R) {
        let Jet { value, rate, curvature, .. } = self.distance(state);
        let far = wall != self.wall(state);
        let (left, sign) = if far { (self.clearance() * 2.0 - value, -1.0) } else { (value, 1.0) };
        let later = impact::delay(left, rate * sign, curvature * sign);
        let end = self.later(state, &self.series(state, false), false, later);
        let (side, rate) = (end.side * sign, end.rate * sign);
        (CoupledState { side, distance: R::ZERO, rate, ..end }, later)
    }

    fn release(&self, state: &CoupledState<R>) -> (CoupledState<R>, R) {
        // At the release the pressure is 0; x is set to the displacement for that.
        let [_, pressure] = self.coupling.rates(self.variables(state));
        let [_, per_x] = self.coupling.rates([R::ONE, R::ZERO, R::ZERO, R::ZERO]);
        let x = if per_x == 0.0 { state.x } else { state.x - pressure / per_x };
        (CoupledState { x, ..*state }, R::ZERO)
    }
}
