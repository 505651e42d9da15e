//! A fast flight: a stretch of flight that is decided by about two evaluations.
//!
//! Nearly every stretch of flight is simple: it meets no wall, or one wall once and at a finite rate. A fast
//! flight proves that it is simple or gives up; then the stretch is searched by [`crate::segment::contact`]. The code
//! has no branches, so that many flights can go side by side ([`crate::run::side_by_side`]).
//!
//! **Proof.** Distance, rate and curvature at both ends of a stretch of length L define a quintic H. With
//! M = L⁶ max |D⁽⁶⁾|, [`crate::segment::quintic`] bounds the error D − H. In a flight that starts on the wall the
//! bounds apply to H/t, with the coefficients 5b₁, 5b₂/2, 5b₃/3, 5b₄/4, b₅: |D − H|/t ≤ M t² (L−t)³/(720
//! L⁶) ≤ M/20833 L, and L² |(D/t)′ − (H/t)′| ≤ ½ M/1920, as t e′ − e = ∫ t e″ dt for the error e.
//!
//! **Root.** Where H − level changes sign and its slope keeps its own, D has one root. The motion is
//! evaluated at the root of H, and the Taylor series about that instant gives the contact.

use crate::number::real::Real;
use crate::segment::quintic::{OFF, SLOPE_OFF, bernstein, monomials};
use crate::segment::roots::DOUBT;

/// Bound on the error of H/t, over M: the maximum of t² (1−t)³/720.
const RISE_OFF: f64 = 4.8001e-5;
/// Bound on the error of the derivative of H/t, over M: ½/1920.
const RISE_SLOPE_OFF: f64 = 2.605e-4;
/// The quintic H of the distance to the wall between two states.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quintic<R = f64> {
    /// Distance, L × rate, ½ L² × curvature at the begin.
    begin: [R; 3],
    /// Distance, L × rate, ½ L² × curvature at the end.
    end: [R; 3],
    /// M, the bound on L⁶ |D⁽⁶⁾|.
    sixth: R,
}

/// The distance between the walls, in units of the clearance.
const FAR: f64 = 2.0;

/// What the quintic proves about a stretch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Proof {
    /// True if no wall is met.
    pub free: bool,
    /// True for the near wall, or for the far wall, if it alone is met, and once.
    pub meets: [bool; 2],
}

impl<R: Real> Quintic<R> {
    /// The quintic from distance, L × rate and ½ L² × curvature at both ends, and M, in units of the clearance.
    #[inline(always)]
    pub fn of([begin, end]: [[R; 3]; 2], sixth: R) -> Self {
        Self { begin, end, sixth }
    }

    #[inline(always)]
    pub fn proof(&self) -> Proof {
        let b = bernstein(&self.begin, &self.end);
        let steps = [b[1] - b[0], b[2] - b[1], b[3] - b[2], b[4] - b[3], b[5] - b[4]];
        let m = self.sixth;
        // Bounds on rounding errors; those of a flight that starts on the wall are in proportion to its own
        // height over the wall.
        let height = ((R::EPSILON * 0.5) * DOUBT) * size(&self.begin, &self.end);
        let far = R::from(FAR);
        let doubt = far.mul_add((R::EPSILON * 0.5) * DOUBT, height);
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
        let below = high < far - level;
        let falls = if on_wall {
            (rises[0] > height)
                & (most(&turns) < -m.mul_add(R::from(0.25 * RISE_SLOPE_OFF), height))
                & (b[5] < -height)
        } else {
            (b[0] > doubt) & (most(&steps) < fifth) & (b[5] < -doubt)
        };
        let climbs = (b[0] < far - doubt) & (least(&steps) > -fifth) & (b[5] > far + doubt);
        Proof { free: above & below, meets: [falls & below, climbs & above] }
    }

    /// A quintic on [0, 1] whose only root is the contact of H with the wall that it meets once.
    #[inline(always)]
    pub fn meeting(&self, far: bool) -> [R; 6] {
        let c = monomials(&self.begin, &self.end);
        // At the wall that the flight starts from, the root at the begin is divided out.
        let returns = !far & (c[0] == 0.0);
        let level = if far { R::from(FAR) } else { R::ZERO };
        let last = if returns { R::ZERO } else { c[5] };
        let pick = |i: usize| if returns { c[i + 1] } else { c[i] };
        let first = if returns { c[1] } else { c[0] - level };
        [first, pick(1), pick(2), pick(3), pick(4), last]
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
