//! A fast flight: a stretch of flight that is decided by about two evaluations.
//!
//! Nearly every stretch of flight is simple: it meets no wall, or one wall once and at a finite rate. A fast
//! flight proves that it is simple or gives up; then the stretch is searched by [`crate::contact`]. The code
//! has no branches, so that many flights can go side by side ([`crate::lanes`]).
//!
//! **Proof.** Distance, rate and curvature at both ends of a stretch of length L define a quintic H. With
//! M = L⁶ max |D⁽⁶⁾|, [`crate::quintic`] bounds the error D − H. In a flight that starts on the wall the
//! bounds apply to H/t, with the coefficients 5b₁, 5b₂/2, 5b₃/3, 5b₄/4, b₅: |D − H|/t ≤ M t² (L−t)³/(720
//! L⁶) ≤ M/20833 L, and L² |(D/t)′ − (H/t)′| ≤ ½ M/1920, as t e′ − e = ∫ t e″ dt for the error e.
//!
//! **Root.** Where H − level changes sign and its slope keeps its own, D has one root. The motion is
//! evaluated at the root of H, and the Taylor series about that instant gives the contact.

use super::SivaState;
use super::motion::{SivaFlight, arrived};
use crate::compensated::DoubleDouble;
use crate::flight::{FastFlight, Meets};
use crate::host::{Host, HostState, Phase, Structure};
use crate::oscillator::Primary;
use crate::quintic::{OFF, SLOPE_OFF, bernstein, monomials, root};
use crate::real::Real;
use crate::roots::DOUBT;

/// Bound on the error of H/t, over M: the maximum of t² (1−t)³/720.
const RISE_OFF: f64 = 4.8001e-5;
/// Bound on the error of the derivative of H/t, over M: ½/1920.
const RISE_SLOPE_OFF: f64 = 2.605e-4;
/// Largest relative change of the rate on the way to the wall; its fifth power is neglected.
const STRAIGHT: f64 = 1e-4;
/// Largest number of evaluations near a root.
pub(crate) const LOOKS: usize = 3;

/// The quintic H of the distance to the wall between two states.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quintic<R = f64> {
    /// Distance, L × rate, ½ L² × curvature at the begin.
    begin: [R; 3],
    /// Distance, L × rate, ½ L² × curvature at the end.
    end: [R; 3],
    /// M, the bound on L⁶ |D⁽⁶⁾|.
    sixth: R,
    /// The distance 2d at which the far wall is met.
    far: R,
}

/// What the quintic proves about a stretch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Proof {
    /// True if no wall is met.
    pub free: bool,
    /// True for the near wall, or for the far wall, if it alone is met, and once.
    pub meets: [bool; 2],
}

impl<R: Real> Quintic<R> {
    #[inline(always)]
    pub fn new<S: Structure<Real = R>>(
        free: &S,
        from: &SivaState<S::Phase, R>,
        to: &SivaState<S::Phase, R>,
        clearance: R,
        length: R,
    ) -> Self {
        let half_square = (length * length) * 0.5;
        let ends = |state: &SivaState<S::Phase, R>| {
            let curvature = state.side * state.host.acceleration.value;
            [state.distance.value, length * state.rate.value, half_square * curvature]
        };
        let cube = length * length * length;
        let sixth = free.bound::<4>(&from.host.primary) * (cube * cube);
        Self::of([ends(from), ends(to)], sixth, clearance)
    }

    /// The quintic from distance, L × rate and ½ L² × curvature at both ends, M and the clearance.
    #[inline(always)]
    pub fn of([begin, end]: [[R; 3]; 2], sixth: R, clearance: R) -> Self {
        Self { begin, end, sixth, far: clearance * 2.0 }
    }

    #[inline(always)]
    pub fn proof(&self) -> Proof {
        let b = bernstein(&self.begin, &self.end);
        let steps = [b[1] - b[0], b[2] - b[1], b[3] - b[2], b[4] - b[3], b[5] - b[4]];
        let m = self.sixth;
        // Bounds on rounding errors; those of a flight that starts on the wall are in proportion to its own
        // height over the wall.
        let height = ((R::EPSILON * 0.5) * DOUBT) * size(&self.begin, &self.end);
        let doubt = self.far.mul_add((R::EPSILON * 0.5) * DOUBT, height);
        let level = m.mul_add(R::from(OFF), doubt);
        let slope = m.mul_add(R::from(SLOPE_OFF), doubt);
        let fifth = slope * -0.2;
        let (low, high) = (least(&b), most(&b));
        let rises = [b[1] * 5.0, b[2] * 2.5, b[3] * (5.0 / 3.0), b[4] * 1.25, b[5]];
        let turn = |b: R, factor: f64, before: R| b.mul_add(R::from(factor), -before);
        let turns = [
            turn(b[2], 2.5, rises[0]),
            turn(b[3], 5.0 / 3.0, rises[1]),
            turn(b[4], 1.25, rises[2]),
            b[5] - rises[3],
        ];
        let rise = m.mul_add(R::from(RISE_OFF), height);
        let on_wall = self.begin[0] == 0.0;
        let above = if on_wall { least(&rises) > rise } else { low > level };
        let below = high < self.far - level;
        let falls = if on_wall {
            (rises[0] > height)
                & (most(&turns) < -m.mul_add(R::from(0.25 * RISE_SLOPE_OFF), height))
                & (b[5] < -height)
        } else {
            (b[0] > doubt) & (most(&steps) < fifth) & (b[5] < -doubt)
        };
        let climbs =
            (b[0] < self.far - doubt) & (least(&steps) > -fifth) & (b[5] > self.far + doubt);
        Proof { free: above & below, meets: [falls & below, climbs & above] }
    }

    /// A quintic on [0, 1] whose only root is the contact of H with the wall that it meets once.
    #[inline(always)]
    pub fn meeting(&self, far: bool) -> [R; 6] {
        let c = monomials(&self.begin, &self.end);
        // At the wall that the flight starts from, the root at the begin is divided out.
        let returns = !far & (c[0] == 0.0);
        let level = if far { self.far } else { R::ZERO };
        let last = if returns { R::ZERO } else { c[5] };
        let pick = |i: usize| if returns { c[i + 1] } else { c[i] };
        let first = if returns { c[1] } else { c[0] - level };
        [first, pick(1), pick(2), pick(3), pick(4), last]
    }
}

/// The time from a state close to a wall to the contact, and whether the Taylor series gives it to the last
/// bit.
#[inline(always)]
pub(crate) fn to_wall<R: Real, S: Structure<Real = R>>(
    free: &S,
    state: &SivaState<S::Phase, R>,
    clearance: R,
    far: bool,
    h: R,
) -> (R, bool) {
    let left = if far { state.distance.minus(clearance * 2.0) } else { state.distance.value };
    let rate = state.rate.value;
    let HostState { primary, acceleration, phase } = &state.host;
    let [jerk, ..] = free.derivatives(phase, primary.v.value, acceleration.value);
    let (curvature, jerk) = (state.side * acceleration.value, state.side * jerk);
    // Solves left + rate t + ½ curvature t² + ⅙ jerk t³ = 0 by reversion of the series.
    let slowness = R::ONE / rate;
    let first = -left * slowness;
    let (p, q) = ((slowness * 0.5) * curvature, (slowness * (1.0 / 6.0)) * jerk);
    let bend = p * first;
    let later = first - bend * first
        + first * first * first * ((p * 2.0 * p - q) - bend * 5.0 * (p * p - q));
    let fourth = free.bound::<2>(primary);
    let square = later * later;
    // Compares the next term of the series with the rounding of rate and distance.
    let close = fourth * (square * square) <= R::EPSILON * (rate.abs() * h);
    let converged = bend.abs() <= STRAIGHT;
    (later, close & converged & (later.abs() < h * 0.5))
}

/// The state in contact with the wall, a time `later` after a state close to it.
#[inline(always)]
pub(crate) fn at_wall<R: Real, S: Structure<Real = R>>(
    free: &S,
    state: &SivaState<S::Phase, R>,
    far: bool,
    later: R,
) -> SivaState<S::Phase, R> {
    let HostState { primary: Primary { x, v }, acceleration, phase } = state.host;
    let a = acceleration.value;
    let [jerk, snap, fifth] = free.derivatives(&phase, v.value, a);
    let t = later;
    // One term more than in the search for the contact: the errors of many impacts would add up.
    let raised = |[a, jerk, snap, fifth]: [R; 4]| {
        t * (a + t * (jerk * 0.5 + t * (snap * (1.0 / 6.0) + t * (fifth * (1.0 / 24.0)))))
    };
    let gained = raised([a, jerk, snap, fifth]);
    let (mut faster, mut moved) = (gained, raised([v.value, a, jerk, snap]));
    if free.moves_base() {
        let [base, rate, second, third] = free.base(&phase);
        faster -= raised([base, rate, second, third]);
        moved = raised([v.value, a - base, jerk - rate, snap - second]);
    }
    let primary = Primary { x: x.plus(moved), v: v.plus(faster) };
    let turn = if far { -R::ONE } else { R::ONE };
    let rate = state.rate.plus(state.side * gained);
    SivaState {
        host: HostState { primary, acceleration, phase: free.later(&phase, later) },
        side: turn * state.side,
        distance: DoubleDouble::ZERO,
        rate: DoubleDouble { value: turn * rate.value, rest: turn * rate.rest },
    }
}

impl<R: Real, H: Host<Real = R>> SivaFlight<'_, H> {
    /// The fast flight of this length; `None` if it is not proved simple.
    #[inline(always)]
    pub(super) fn fast_flight(&self, length: R) -> Option<FastFlight<SivaState<Phase<H>, R>, R>> {
        let (free, course, state) = (self.structure(), &self.course, &self.from);
        let clearance = self.siva.clearance;
        let mut end = arrived(free, course, state, length);
        let quintic = Quintic::new(free, state, &end, clearance, length);
        let proof = quintic.proof();
        if proof.free {
            free.refresh(&mut end.host);
            return Some(FastFlight { length, later: R::ZERO, end, meets: Meets::Nothing });
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
                return Some(FastFlight { length: h, later, end, meets: Meets::Wall });
            }
            h += later;
        }
        None
    }
}

#[inline(always)]
fn least<R: Real, const N: usize>(values: &[R; N]) -> R {
    values[1..].iter().fold(values[0], |least, value| if *value < least { *value } else { least })
}

#[inline(always)]
fn most<R: Real, const N: usize>(values: &[R; N]) -> R {
    values[1..].iter().fold(values[0], |most, value| if *value > most { *value } else { most })
}

#[inline(always)]
fn size<R: Real>(begin: &[R; 3], end: &[R; 3]) -> R {
    begin.iter().chain(end).fold(R::ZERO, |sum, value| sum + value.abs())
}

#[cfg(test)]
mod tests;
