//! The infinite tail of a chatter, summed.
//!
//! A rebound of speed u at a wall that presses with A = −D̈ > 0 lasts 2u/A and meets the wall again
//! with u; each further rebound is smaller by e. To second order in u, with J = D⃛ the change of
//! the pressure in flight and β its gain at an impact of unit speed, the whole tail lasts
//!
//! ```text
//! T = 2u/(A(1−e)) + (4/3) J u²/(A³(1−e)²) − 2βe u²/(A²(1−e)²(1+e)).
//! ```
//!
//! The tail replaces the simulation once the third-order terms, estimated from A, J, β and the
//! size R of D⁗, are below rounding ([`NEGLIGIBLE`]). Where the absorber then sticks, the common
//! velocity follows from momentum, and the ride starts at the switch: the centre of mass obeys the
//! equation of the ride through the whole tail up to terms of third order (rebounds are internal
//! forces), so the motion after it is as exact.

/// Largest estimated error of the summed duration, in 1/ωn, at which the tail is summed. Rounding of a time
/// of order 1 is ten times larger.
pub const NEGLIGIBLE: f64 = 1e-17;

/// A rebound at a pressing wall, right after the impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebound {
    /// u: speed away from the wall, > 0.
    pub speed: f64,
    /// A = −D̈: pressure per unit mass, > 0.
    pub pressure: f64,
    /// J = D⃛ in free motion.
    pub jerk: f64,
    /// β: rise of the pressure at an impact of unit approach speed.
    pub gain: f64,
    /// R: size of D⁗ and of the motion.
    pub fourth: f64,
    /// e: ratio of successive rebound speeds, < 1 for a tail.
    pub ratio: f64,
}

impl Rebound {
    /// Duration of the infinite tail, to second order in the speed.
    pub fn tail(&self) -> f64 {
        let Self { speed: u, pressure: a, jerk: j, gain: b, ratio: e, .. } = *self;
        let x = u / (a * (1.0 - e));
        2.0 * x + x * x * ((4.0 / 3.0) * (j / a) - 2.0 * b * e / (1.0 + e))
    }

    /// Estimate of the error of [`Rebound::tail`].
    pub fn tail_error(&self) -> f64 {
        let Self { speed: u, pressure: a, jerk: j, gain: b, fourth: r, ratio: e } = *self;
        let h = u / a;
        let spread = 1.0 / (1.0 - e);
        let epsilon = h * (j.abs() / a + b) * spread;
        let curved = h * h * (r / a) * (spread * spread);
        self.tail().abs() * (epsilon * epsilon + curved)
    }

    /// True if the tail can be summed with an error below rounding.
    pub fn summable(&self) -> bool {
        self.ratio < 1.0 && self.pressure > 0.0 && self.tail_error() <= NEGLIGIBLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball dropped from h bounces for √(2h/g)(1+e)/(1−e) in all (closed form).
    #[test]
    fn bouncing_ball_comes_to_rest_on_time() {
        let cases =
            [(10.0, 0.8, 9.81, 12.850_588_106_343_58), (1.0, 0.5, 9.81, 1.354_570_922_957_193)];
        for (height, e, g, rest_time) in cases {
            let fall = f64::sqrt(2.0 * height / g);
            let ball = Rebound {
                speed: e * (g * fall),
                pressure: g,
                jerk: 0.0,
                gain: 0.0,
                fourth: 0.0,
                ratio: e,
            };
            let total: f64 = fall + ball.tail();
            assert!((total - rest_time).abs() <= 4.0 * f64::EPSILON * rest_time, "{total}");
        }
    }
}
