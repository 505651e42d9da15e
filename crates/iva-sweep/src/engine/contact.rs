//! The largest force in an impact, which takes no time here: an estimate from what is known of the contact.

use iva_core::real::Real;

/// What is known of the contacts of an absorber with its stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact<R> {
    /// How long a contact lasts, in 1/ωn. Its force is taken for a half sine in time.
    Lasts(R),
    /// √(k m), with the stiffness k of a stop and the reduced mass m of absorber and structure, over M ωn. The stop is
    /// taken for a spring with a dashpot beside it.
    Spring(R),
}

impl<R: Real> Contact<R> {
    /// The largest force over M ωn² in an impact of this impulse over M, approach speed and restitution.
    pub fn force(self, impulse: R, approach: R, restitution: R) -> R {
        match self {
            Self::Lasts(time) => impulse * (R::TURN.value * 0.25) / time,
            Self::Spring(impedance) => impedance * approach * relative_force(restitution),
        }
    }

    /// How long a contact of a reduced mass over M lasts, in 1/ωn.
    pub fn duration(self, reduced: R, restitution: R) -> R {
        match self {
            Self::Lasts(time) => time,
            Self::Spring(impedance) => reduced / impedance * relative_duration(restitution),
        }
    }
}

/// Steps of Newton's method that suffice for 30 digits.
const STEPS: usize = 8;

/// The largest force of a linear stop over v √(k m), where v is the approach speed and the contact ends when the force
/// is zero.
///
/// With the damping ratio cos α of the contact, the restitution is e = exp(−2 α cot α) and the force is largest at the
/// phase 3α − π, where it is exp(−(3α − π) cot α); above cos α = 1/2 at the first instant, where it is 2 cos α. Below
/// e⁻² the contact is damped more than critically: 2, the value at critical damping, is taken.
fn relative_force<R: Real>(restitution: R) -> R {
    let Some((angle, loss)) = phase(restitution) else { return R::from(2.0) };
    let (_, ratio) = angle.sincos();
    if ratio >= 0.5 {
        return ratio * 2.0;
    }
    exponential(loss * (R::TURN.value * 0.5 / angle - 3.0) * 0.5)
}

/// How long a contact with a linear stop lasts, times √(k/m): 2 α/sin α, and 2 at critical damping.
fn relative_duration<R: Real>(restitution: R) -> R {
    phase(restitution).map_or(R::from(2.0), |(angle, _)| angle * 2.0 / angle.sincos().0)
}

/// α of a contact of this restitution e, and −ln e; `None` where it is damped more than critically.
fn phase<R: Real>(restitution: R) -> Option<(R, R)> {
    let quarter_turn = R::TURN.value * 0.25;
    if restitution >= 1.0 {
        return Some((quarter_turn, R::ZERO));
    }
    let loss = -restitution.ln();
    if loss.is_nan() || loss >= 2.0 {
        return None;
    }
    // α cot α is concave and below 1 − α²/3, so Newton's steps come from above.
    let mut angle = ((R::ONE - loss * 0.5) * 3.0).sqrt().min(quarter_turn);
    for _ in 0..STEPS {
        let (sine, cosine) = angle.sincos();
        let cotangent = cosine / sine;
        let slope = cotangent - angle / (sine * sine);
        angle -= (angle * cotangent - loss * 0.5) / slope;
    }
    Some((angle, loss))
}

/// exp(y) for |y| below 1.
fn exponential<R: Real>(y: R) -> R {
    (0..STEPS).fold(R::ONE, |value, _| value * (R::ONE + y - value.ln()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use iva_core::real::twofold::Twofold;

    /// The restitution, the largest force and the end of z″ + 2ζ z′ + z = 0 from z = 0, z′ = 1 until the force is zero, sampled.
    fn sampled(ratio: f64) -> [f64; 3] {
        let omega = (1.0 - ratio * ratio).sqrt();
        let force = |t: f64| {
            let (sine, cosine) = (omega * t).sin_cos();
            let z = sine / omega;
            (-ratio * t).exp() * (z + 2.0 * ratio * (cosine - ratio * z))
        };
        let velocity = |t: f64| {
            let (sine, cosine) = (omega * t).sin_cos();
            (-ratio * t).exp() * (cosine - ratio * sine / omega)
        };
        let step = 1e-5;
        let end = (1..).map(|n| f64::from(n) * step).find(|t| force(*t) < 0.0).unwrap();
        let largest = (0..(end / step) as i32).map(|n| force(f64::from(n) * step));
        [-velocity(end), largest.fold(0.0, f64::max), end]
    }

    #[test]
    fn force_and_duration_are_those_of_a_spring_and_a_dashpot() {
        for ratio in [0.01, 0.1, 0.25, 0.4, 0.49, 0.51, 0.7, 0.9] {
            let [restitution, largest, end] = sampled(ratio);
            // The sampled contact ends up to a step too late.
            for (found, sampled) in
                [(relative_force(restitution), largest), (relative_duration(restitution), end)]
            {
                assert!((found / sampled - 1.0).abs() < 3e-5, "{ratio}: {found} for {sampled}");
            }
        }
    }

    #[test]
    fn ends_of_the_range_are_those_of_a_spring_and_of_critical_damping() {
        assert_eq!(relative_force(1.0), 1.0);
        assert_eq!(relative_force(0.0), 2.0);
        assert!((relative_force(1.0 - 1e-9) - 1.0).abs() < 1e-8);
        assert!((relative_force((-2.0f64).exp() * (1.0 + 1e-9)) - 2.0).abs() < 1e-8);
    }

    #[test]
    fn twice_the_precision_agrees() {
        for restitution in [0.14, 0.2, 0.3, 0.5, 0.8, 0.99] {
            let exact = f64::from(relative_force(Twofold::from(restitution)));
            assert!((relative_force(restitution) / exact - 1.0).abs() < 1e-14, "{restitution}");
        }
    }
}
