//! A stride: a stretch of flight that two evaluations or so decide.
//!
//! Nearly every stretch of flight is simple: it meets no wall, or one wall once and not flatly. A stride
//! proves that it is simple or gives up; what it gives up is searched by [`crate::contact`]. It goes
//! without branches, so that many can go side by side ([`crate::lanes`]).
//!
//! **Proof.** Distance, rate and curvature at both ends of a stretch of length L define a quintic H,
//! and with M = L⁶ max |D⁽⁶⁾| the distance obeys (G. Birkhoff and A. Priver, J. Math. Phys. 46, 1967)
//!
//! ```text
//! |D − H| ≤ M/46080,    L |D′ − H′| ≤ M √5/30000,    L² |D″ − H″| ≤ M/1920.
//! ```
//!
//! H lies within the range of its Bernstein coefficients and L H′ within five times that of their
//! differences. In a flight that starts on the wall it is H/t that counts, with the coefficients 5b₁, 5b₂/2,
//! 5b₃/3, 5b₄/4, b₅: |D − H|/t ≤ M t² (L−t)³/(720 L⁶) ≤ M/20833 L, and
//! L² |(D/t)′ − (H/t)′| ≤ ½ M/1920, as t e′ − e = ∫ t e″ dt for the error e.
//!
//! **Root.** Where H − level changes sign and its slope keeps its own, D has one root. The distance is
//! evaluated at the root of H, and the rest of the way gone by the Taylor series of the motion
//! there.

use super::SivaState;
use super::motion::{SivaFlight, arrived};
use crate::compensated::Sum;
use crate::flight::{Glide, Meets};
use crate::host::{Host, HostState, Phase, Structure};
use crate::oscillator::Primary;
use crate::quintic::{monomials, root};
use crate::real::{ONE, Real, ZERO};
use crate::roots::DOUBT;

/// M/46080 bounds what H is off.
const OFF: f64 = 1.0 / 46080.0;
/// √5/30000, for the slope.
const SLOPE_OFF: f64 = 7.454e-5;
/// For H/t: max of t² (1−t)³/720, and ½/1920.
const RISE_OFF: f64 = 4.8001e-5;
const RISE_SLOPE_OFF: f64 = 2.605e-4;
/// Share of the rate that may change on the way to the wall: the fifth power of it is left out.
const STRAIGHT: f64 = 1e-4;
/// Evaluations near a root.
pub(crate) const LOOKS: usize = 3;

/// The quintic through two states on their distance to the wall.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quintic {
    /// Distance, L × rate, ½ L² × curvature at the begin.
    begin: [Real; 3],
    /// The same at the end.
    end: [Real; 3],
    /// M.
    sixth: Real,
    /// D = 2d: the far wall.
    far: Real,
}

/// What the quintic proves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Proof {
    /// No wall is met.
    pub free: bool,
    /// One wall is met once: the near one, the far one.
    pub meets: [bool; 2],
}

impl Quintic {
    #[inline(always)]
    pub fn new<S: Structure>(
        free: &S,
        from: &SivaState<S::Phase>,
        to: &SivaState<S::Phase>,
        clearance: Real,
        length: Real,
    ) -> Self {
        let half_square = 0.5 * (length * length);
        let ends = |state: &SivaState<S::Phase>| {
            let curvature = state.side * state.host.acceleration.value;
            [state.distance.value, length * state.rate.value, half_square * curvature]
        };
        let cube = length * length * length;
        Self {
            begin: ends(from),
            end: ends(to),
            sixth: free.bound::<4>(&from.host.primary) * (cube * cube),
            far: 2.0 * clearance,
        }
    }

    /// The Bernstein coefficients.
    #[inline(always)]
    fn bernstein(&self) -> [Real; 6] {
        let ([f, g, k], [u, v, w]) = (self.begin, self.end);
        [f, f + 0.2 * g, f + (0.4 * g + 0.1 * k), u - (0.4 * v - 0.1 * w), u - 0.2 * v, u]
    }

    #[inline(always)]
    pub fn proof(&self) -> Proof {
        let b = self.bernstein();
        let steps = [b[1] - b[0], b[2] - b[1], b[3] - b[2], b[4] - b[3], b[5] - b[4]];
        let m = self.sixth;
        // What rounding could change; a flight that starts on the wall is exact to rounding of its own
        // height over it.
        let height = (DOUBT * (0.5 * Real::EPSILON)) * size(&self.begin, &self.end);
        let doubt = height + (DOUBT * (0.5 * Real::EPSILON)) * self.far;
        let level = OFF * m + doubt;
        let slope = SLOPE_OFF * m + doubt;
        let (low, high) = (least(&b), most(&b));
        let rises = [5.0 * b[1], 2.5 * b[2], (5.0 / 3.0) * b[3], 1.25 * b[4], b[5]];
        let turns =
            [rises[1] - rises[0], rises[2] - rises[1], rises[3] - rises[2], rises[4] - rises[3]];
        let rise = RISE_OFF * m + height;
        let on_wall = self.begin[0] == 0.0;
        let above = if on_wall { least(&rises) > rise } else { low > level };
        let below = high < self.far - level;
        let falls = if on_wall {
            (rises[0] > height)
                & (4.0 * most(&turns) < -(RISE_SLOPE_OFF * m + 4.0 * height))
                & (b[5] < -height)
        } else {
            (b[0] > doubt) & (5.0 * most(&steps) < -slope) & (b[5] < -doubt)
        };
        let climbs =
            (b[0] < self.far - doubt) & (5.0 * least(&steps) > slope) & (b[5] > self.far + doubt);
        Proof { free: above & below, meets: [falls & below, climbs & above] }
    }

    /// A quintic on [0, 1] whose only root is where H meets a wall that it meets once.
    #[inline(always)]
    pub fn meeting(&self, far: bool) -> [Real; 6] {
        let c = monomials(&self.begin, &self.end);
        // At the wall that the flight starts from, the root at the begin is divided out.
        let returns = !far & (c[0] == 0.0);
        let level = if far { self.far } else { ZERO };
        let last = if returns { ZERO } else { c[5] };
        let pick = |i: usize| if returns { c[i + 1] } else { c[i] };
        let first = if returns { c[1] } else { c[0] - level };
        [first, pick(1), pick(2), pick(3), pick(4), last]
    }
}

/// A state close to a wall: how much later it is met, and whether the Taylor series says so to the last
/// bit.
#[inline(always)]
pub(crate) fn to_wall<S: Structure>(
    free: &S,
    state: &SivaState<S::Phase>,
    clearance: Real,
    far: bool,
    h: Real,
) -> (Real, bool) {
    let left = if far { state.distance.minus(2.0 * clearance) } else { state.distance.value };
    let rate = state.rate.value;
    let HostState { primary, acceleration, phase } = &state.host;
    let [jerk, ..] = free.derivatives(phase, primary.v.value, acceleration.value);
    let (curvature, jerk) = (state.side * acceleration.value, state.side * jerk);
    // left + rate t + ½ curvature t² + ⅙ jerk t³ = 0 by reversion of the series.
    let slowness = 1.0 / rate;
    let first = -left * slowness;
    let (p, q) = ((0.5 * slowness) * curvature, ((1.0 / 6.0) * slowness) * jerk);
    let bend = p * first;
    let later = first - bend * first
        + first * first * first * ((2.0 * p * p - q) - 5.0 * bend * (p * p - q));
    let fourth = free.bound::<2>(primary);
    let square = later * later;
    // The next term of the series against the rounding of rate and distance.
    let close = fourth * (square * square) <= Real::EPSILON * (rate.abs() * h);
    let converged = bend.abs() <= STRAIGHT;
    (later, close & converged & (later.abs() < 0.5 * h))
}

/// The state at the wall that it meets so much later, in contact with it.
#[inline(always)]
pub(crate) fn at_wall<S: Structure>(
    free: &S,
    state: &SivaState<S::Phase>,
    far: bool,
    later: Real,
) -> SivaState<S::Phase> {
    let HostState { primary: Primary { x, v }, acceleration, phase } = state.host;
    let a = acceleration.value;
    let [jerk, snap, fifth] = free.derivatives(&phase, v.value, a);
    let t = later;
    // One term more than the search for the wall takes: what every impact lacks would add up.
    let raised = |[a, jerk, snap, fifth]: [Real; 4]| {
        t * (a + t * (0.5 * jerk + t * ((1.0 / 6.0) * snap + t * ((1.0 / 24.0) * fifth))))
    };
    let gained = raised([a, jerk, snap, fifth]);
    let (mut faster, mut moved) = (gained, raised([v.value, a, jerk, snap]));
    if free.moves_base() {
        let [base, rate, second, third] = free.base(&phase);
        faster -= raised([base, rate, second, third]);
        moved = raised([v.value, a - base, jerk - rate, snap - second]);
    }
    let primary = Primary { x: x.plus(moved), v: v.plus(faster) };
    let turn = if far { -ONE } else { ONE };
    let rate = state.rate.plus(state.side * gained);
    SivaState {
        host: HostState { primary, acceleration, phase: free.later(&phase, later) },
        side: turn * state.side,
        distance: Sum::ZERO,
        rate: Sum { value: turn * rate.value, rest: turn * rate.rest },
    }
}

impl<H: Host> SivaFlight<'_, H> {
    /// A stride of this length, if it is one.
    #[inline(always)]
    pub(super) fn stride(&self, length: Real) -> Option<Glide<SivaState<Phase<H>>>> {
        let (free, course, state) = (self.structure(), &self.course, &self.from);
        let clearance = self.siva.clearance;
        let mut end = arrived(free, course, state, length);
        let quintic = Quintic::new(free, state, &end, clearance, length);
        let proof = quintic.proof();
        if proof.free {
            free.refresh(&mut end.host);
            return Some(Glide { length, later: ZERO, end, meets: Meets::Nothing });
        }
        let far = proof.meets[1];
        if !(far || proof.meets[0]) {
            return None;
        }
        let mut h = length * root(&quintic.meeting(far));
        for _ in 0..LOOKS {
            if !(h > 0.0 && h <= length) {
                return None;
            }
            let near = arrived(free, course, state, h);
            let (later, close) = to_wall(free, &near, clearance, far, h);
            if close {
                let end = at_wall(free, &near, far, later);
                return Some(Glide { length: h, later, end, meets: Meets::Wall });
            }
            h += later;
        }
        None
    }
}

#[inline(always)]
fn least<const N: usize>(values: &[Real; N]) -> Real {
    values[1..].iter().fold(values[0], |least, value| if *value < least { *value } else { least })
}

#[inline(always)]
fn most<const N: usize>(values: &[Real; N]) -> Real {
    values[1..].iter().fold(values[0], |most, value| if *value > most { *value } else { most })
}

#[inline(always)]
fn size(begin: &[Real; 3], end: &[Real; 3]) -> Real {
    begin.iter().chain(end).fold(ZERO, |sum, value| sum + value.abs())
}

#[cfg(test)]
mod tests;
