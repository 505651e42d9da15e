//! Whether a step of flight meets a wall, as far as bounds decide it.
//!
//! Bounds from both ends of the step prove that the distance D stays off a wall, or that its rate keeps its
//! sign; then the values at the ends decide. In a flight that starts on a wall the bounds are applied to D/t,
//! which keeps its relative accuracy there. Undecided steps are searched by [`crate::segment::contact`].

use super::PivaState;
use super::step::{Ahead, Step, root_close_by, shifted};
use crate::number::real::Real;
use crate::segment::enclosure::Enclosure;
use crate::segment::quintic::{monomials, root};

/// What is proved about the contacts of a stretch of flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    /// True if it meets no wall.
    pub clear: bool,
    /// True if it meets the near wall, and that once.
    pub near: bool,
    /// True if it meets the far wall, and that once.
    pub far: bool,
}

impl<R: Real, P: Copy> Step<'_, P, R> {
    /// The contacts of a flight of length h to the state `end`; `doubt` bounds the error of y, over the
    /// clearance.
    #[inline(always)]
    pub fn gap<const N: usize>(&self, end: &PivaState<P, R>, h: R, doubt: R) -> Gap {
        let share = h / self.length;
        let (y, side, wide) = (&self.series.y, self.from.wall.sign(), self.from.clearance * 2.0);
        let Ahead { rate, fourth, .. } = Ahead::of::<N>(y, share);
        let (begin, end) = (self.from.distance.value, end.distance.value);
        let rates = [y[1] * -side, rate * -side];
        let slack = doubt * self.from.clearance;
        let distance = Enclosure::new([begin, end], rates, share, fourth);
        // The truncation error grows as tᴺ⁺¹ or faster, so its rate is larger by this factor.
        let steep = R::from((N + 2) as f64) / share;
        let (rises, falls) = (distance.rises(steep * slack), distance.falls(steep * slack));
        let one_way = rises | falls;

        // From a wall: bounds on G = D/t; |G⁗| is bounded by the terms of D⁗ from t on, over t.
        let on_wall = begin == 0.0;
        let slope = end / share;
        let g_rates = [y[2] * -side, (rates[1] - slope) / share];
        let g_fourth = (fourth - y[4].abs() * 24.0) / share;
        let over_time = Enclosure::new([rates[0], slope], g_rates, share, g_fourth);
        let g_slack = slack / share;
        let leaves = over_time.low > g_slack;
        let returns = (rates[0] > g_slack) & (end < -slack) & over_time.falls(steep * g_slack);

        let within = |at: R| (at > slack) & (at < wide - slack);
        let off_near = (end > slack) & (begin > slack) & (one_way | (distance.low > slack));
        let off_near = if on_wall { leaves } else { off_near };
        let below = (end < wide - slack) & (begin < wide - slack);
        let off_far = below & (one_way | (distance.high < wide - slack));
        let down = within(begin) & falls & (end < -slack);
        let near = if on_wall { returns & (distance.high < wide - slack) } else { down };
        let far = (on_wall | within(begin)) & rises & (end > wide + slack);
        Gap { clear: off_near & off_far, near, far }
    }

    /// The contact of a flight of length h with a wall that it meets once: its time, and whether that is
    /// exact.
    #[inline(always)]
    pub fn meeting<const N: usize>(&self, end: &PivaState<P, R>, h: R, far: bool) -> (R, bool) {
        let share = h / self.length;
        let (y, side, distance) = (&self.series.y, self.from.wall.sign(), self.from.distance);
        let wide = self.from.clearance * 2.0;
        let Ahead { rate, bend, .. } = Ahead::of::<N>(y, share);
        let rates = [y[1] * -side, rate * -side];
        let bends = [y[2] * -side, (bend * 0.5) * -side];
        let (here, there) = (distance.value, end.distance.value);
        let begin = if far { distance.minus(wide) } else { here };
        let end = if far { there - wide } else { there };
        let square = share * share;
        let c = monomials(
            &[begin, share * rates[0], square * bends[0]],
            &[end, share * rates[1], square * bends[1]],
        );
        // From the near wall back to it: the root at the begin is divided out.
        let returns = begin == 0.0;
        let quintic: [R; 6] = std::array::from_fn(|i| {
            let next = if i < 5 { c[i + 1] } else { R::ZERO };
            if returns { next } else { c[i] }
        });
        let guess = share * root(&quintic);
        // D = begin − side · t q(t): the coefficients of q about the guess, then those of t q.
        let q = shifted::<_, N>(y, 1, guess);
        let off_wall = |j: usize| {
            let before = if j > 0 { q[j - 1] } else { begin * -side };
            (guess * q[j] + before) * -side
        };
        let terms = std::array::from_fn(|j| if returns { q[j] } else { off_wall(j) });
        let (later, close) = root_close_by(terms, share, guess);
        let meeting = guess + later;
        (self.length * meeting, close & (meeting > 0.0) & (meeting <= share))
    }
}
