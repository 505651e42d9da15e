//! The duration of the infinite tail of a chatter, as a sum in closed form.
//!
//! A rebound of speed u at a wall that presses with A = −D̈ > 0 lasts 2u/A and meets the wall again with u;
//! each further rebound is slower by the factor e. Let J = D⃛ be the rate at which the pressure A falls in
//! flight and β its rise at an impact of unit speed. To second order in u the whole tail lasts
//!
//! ```text
//! T = 2u/(A(1−e)) + (4/3) J u²/(A³(1−e)²) − 2βe u²/(A²(1−e)²(1+e)).
//! ```
//!
//! (By perturbation: a rebound lasts 2u/A + (4/3) J u²/A³ and returns with u (1 − ⅔ J u/A²) to a pressure
//! A − 2 J u/A, which the impact then raises by β u; the sums over all rebounds are geometric.) The sum
//! replaces the simulation once the third-order terms, estimated from A, J, β and the size R of D⁗, are below
//! rounding ([`Real::NEGLIGIBLE`]), and with them the effect of ratios that differ from e by up to δ, δ/(1 − e) of the
//! whole. That is an estimate, not an enclosure. Where the absorber then sticks,
//! the common velocity follows from momentum, and the stick episode starts at the instant of the switch:
//! rebounds are internal forces, so the centre of mass obeys the equation of the stuck pair through the whole
//! tail up to terms of third order, and the motion after it has the same accuracy. Rebounds of the impact law
//! as the paper prints it change the momentum as well; `absorber/piva/impact_law.rs` gives the effect on the stick
//! episode to second order.
//!
//! Where e rises to 1 at low speeds, the ratios have no such limit. For a power law the sum is another one, whose bound is
//! proved ([`power`]); for any other such law nothing is summed.
//!
//! With friction a rebound returns with another pressure than that with which it leaves, and its sum is that of
//! `absorber/chatter/sliding.rs`.

use crate::number::real::Real;

pub use power::Power;
pub use sliding::Back;

pub mod power;
mod sliding;

/// Safety factor of the estimated third-order terms, whose coefficients are of order 1.
const SAFETY: f64 = 4.0;

/// Length of the first search after a rebound in units of u/A: the return comes after 2u/A in the limit of
/// low rebounds; a higher rebound needs further segments.
pub(crate) const REBOUND_LOOK: f64 = 2.5;

/// Below this value of u/(A (1 − e)), half the duration of the chatter that remains, the event loop may sum the tail.
/// (The estimated error of the sum is at least 4 times the cube of this value.)
const LOW: f64 = 1e-4;

/// Twice the height of a low rebound, in units of 2⁻⁵² of the clearance.
const LOWEST: f64 = 1024.0;

/// Value of u J/A² from which on a rebound may last longer than the first search; J is the rate by which A falls.
const LATE: f64 = 0.1;

/// Length of the first search after a rebound with speed u from a wall that presses with A > 0.
#[inline(always)]
pub(crate) fn first_search<R: Real>(speed: R, pressure: R) -> R {
    speed * REBOUND_LOOK / pressure
}

/// True if a time is shorter than rounding of the clock at an instant, of which 1/ωn is the least.
pub(crate) fn is_nothing<R: Real>(time: R, clock: R) -> bool {
    time <= R::EPSILON * 0.5 * clock.max(R::ONE)
}

/// True if the tail of this rebound may be summed, or if the absorber does not leave the wall: lanes leave both to the
/// event loop.
#[inline(always)]
pub(crate) fn may_end(speed: f64, pressure: f64, ratio: f64) -> bool {
    ((pressure > 0.0) & (speed < pressure * (LOW * (1.0 - ratio)))) | (speed <= 0.0)
}

/// A rebound from a pressing wall, at the instant after the impact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rebound<R = f64> {
    /// u: speed away from the wall, > 0, in ωn × length.
    pub speed: R,
    /// A = −D̈: acceleration towards the wall, > 0, in ωn² × length.
    pub pressure: R,
    /// J = D⃛ in free motion.
    pub jerk: R,
    /// β: rise of A at an impact of unit approach speed.
    pub gain: R,
    /// R: bound on |D⁗|, of the size of the motion.
    pub fourth: R,
    /// e: ratio of successive rebound speeds, < 1 for a tail.
    pub ratio: R,
    /// A bound on how far the ratios of lower rebounds are from e.
    pub spread: R,
    /// How e goes on if it is a power law, which rises to 1 at low speeds.
    pub power: Option<Power<R>>,
    /// How the absorber returns from the highest point of a rebound, with friction; `None` if it returns as it left.
    pub back: Option<Back<R>>,
}

impl<R: Real> Rebound<R> {
    /// Duration of the infinite tail in 1/ωn: to second order in the speed, of a power law to first order.
    pub fn tail(&self) -> R {
        if let Some(back) = &self.back {
            return back.tail(self);
        }
        if let Some(power) = &self.power {
            return power.tail(self);
        }
        let Self { speed: u, pressure: a, jerk: j, gain: b, ratio: e, .. } = *self;
        let x = u / (a * (R::ONE - e));
        x * 2.0 + x * x * ((j / a) * (4.0 / 3.0) - b * 2.0 * e / (R::ONE + e))
    }

    /// Estimate of the error of [`Rebound::tail`]; of a power law a bound.
    pub fn tail_error(&self) -> R {
        if let Some(back) = &self.back {
            return back.error(self);
        }
        if let Some(power) = &self.power {
            return power.error(self);
        }
        let Self { speed: u, pressure: a, jerk: j, gain: b, fourth: r, ratio: e, .. } = *self;
        let h = u / a;
        let spread = R::ONE / (R::ONE - e);
        let epsilon = h * (j.abs() / a + b) * spread;
        let curved = h * h * (r / a) * (spread * spread);
        (h * 2.0 * spread) * SAFETY * (epsilon * epsilon + curved + self.spread * spread)
    }

    /// True if it is so short that lanes leave it to the event loop. If it is low as well, it is searched from the wall on in one piece:
    /// heights are exact there, while above the wall a return within the band of rounding would be undecided.
    pub(crate) fn is_short(&self) -> bool {
        self.speed < self.pressure * ((R::ONE - self.ratio) * LOW)
    }

    /// True if its height over the clearance, u²/2A, is some hundred bands of rounding at most.
    pub(crate) fn is_low(&self, clearance: R) -> bool {
        self.speed * self.speed < self.pressure * clearance * (R::EPSILON * LOWEST)
    }

    /// Length of the first search for its return. Where the wall soon stops to press, a short rebound may return late or not at
    /// all: then the search goes on beyond the instant at which the absorber would have left for good.
    pub(crate) fn first_search(&self) -> R {
        let Self { speed, pressure, jerk, .. } = *self;
        let usual = first_search(speed, pressure);
        // u h − A h²/2 + J h³/6 has its minimum before 2 A/J, and is positive from 3 A/J on.
        let late = speed * jerk > pressure * pressure * LATE;
        if self.is_short() && late { usual.max(pressure * 4.0 / jerk) } else { usual }
    }

    /// True if the tail can be summed with an error below rounding.
    pub fn summable(&self) -> bool {
        let falls = match (&self.back, &self.power) {
            (Some(back), _) => back.may_end(self),
            (None, Some(power)) => power.may_end(self),
            (None, None) => self.ratio + self.spread < 1.0,
        };
        falls && self.pressure > 0.0 && self.tail_error() <= R::NEGLIGIBLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second-order terms in the jerk and the gain agree with rebounds summed one by one, at a wall whose
    /// pressure falls by J h in flight and rises by β w at an impact. The difference is of third order in the
    /// speed.
    #[test]
    fn jerk_and_gain_enter_to_second_order() {
        let one_by_one = |mut tail: Rebound| {
            let mut total = 0.0;
            while tail.speed > 1e-20 {
                let Rebound { speed: u, pressure: a, jerk: j, gain, fourth: r, ratio, .. } = tail;
                // u h − A h²/2 + J h³/6 + R h⁴/24 = 0 by fixed-point iteration from 2u/A
                let h = (0..60)
                    .fold(2.0 * u / a, |h, _| (2.0 * u + h * h * (j / 3.0 + r * h / 12.0)) / a);
                let approach = a * h - u - h * h * (0.5 * j + r * h / 6.0);
                total += h;
                tail.speed = ratio * approach;
                tail.pressure = a - j * h - 0.5 * r * h * h + gain * approach;
                tail.jerk = j + r * h;
            }
            total
        };
        for (jerk, gain, fourth, ratio) in [
            (0.7, 0.0, 0.0, 0.5),
            (-1.3, 0.0, 0.0, 0.8),
            (0.0, 0.9, 0.0, 0.5),
            (0.0, 1.7, 0.0, 0.9),
            (-0.4, 0.6, 0.5, 0.3),
            (0.2, 0.1, 2.0, 0.6),
        ] {
            let error = |speed: f64| {
                let rebound = Rebound {
                    speed,
                    pressure: 1.2,
                    jerk,
                    gain,
                    fourth,
                    ratio,
                    ..Rebound::default()
                };
                (rebound.tail() - one_by_one(rebound), rebound.tail_error())
            };
            let (coarse, estimate) = error(1e-3);
            let (fine, _) = error(1e-4);
            let second_order = (1e-3 / (1.0 - ratio)).powi(2) * (jerk.abs() + gain);
            assert!(coarse.abs() < 0.1 * second_order, "{jerk} {gain} {ratio}: {coarse:e}");
            assert!((coarse / fine - 1000.0).abs() < 60.0, "third order: {coarse:e} {fine:e}");
            assert!(coarse.abs() <= estimate, "{coarse:e} is beyond the estimate {estimate:e}");
        }
    }

    /// A ball dropped from height h comes to rest after √(2h/g)(1+e)/(1−e) (closed form).
    #[test]
    fn bouncing_ball_comes_to_rest_on_time() {
        let cases =
            [(10.0, 0.8, 9.81, 12.850_588_106_343_58), (1.0, 0.5, 9.81, 1.354_570_922_957_193)];
        for (height, e, g, rest_time) in cases {
            let fall = f64::sqrt(2.0 * height / g);
            let ball =
                Rebound { speed: e * (g * fall), pressure: g, ratio: e, ..Rebound::default() };
            let total: f64 = fall + ball.tail();
            assert!((total - rest_time).abs() <= 4.0 * f64::EPSILON * rest_time, "{total}");
        }
    }
}
