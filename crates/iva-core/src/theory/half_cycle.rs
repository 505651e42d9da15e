//! Half a cycle of a symmetric motion with two impacts, in closed form: from just after the impact on wall +
//! (time zero) to just before the impact on wall − (time T).

use crate::theory::Complex;

/// Bound on the rounding error of a distance to a wall, in units of 2⁻⁵² of the size of the motion.
const ROUNDING: f64 = 16.0;
/// Length of the shortest interval, as a share of the half cycle.
const FINEST: f64 = 1.0 / (1u64 << 45) as f64;
/// Number of intervals at the start of the search for the largest displacement.
const FIRST_INTERVALS: usize = 64;

/// Free motion of the primary, ẍ + 2ζẋ + x = 0, over a given time: x → C x + S ẋ, ẋ → −S x + Ṡ ẋ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FreeMotion {
    /// C, the response to a unit displacement.
    pub(super) displaced: f64,
    /// S, the response to a unit velocity.
    pub(super) pushed: f64,
    /// Ṡ
    pub(super) pushed_rate: f64,
    /// det(1 + Φ) of the map Φ above: 0 where Φ has the multiplier −1.
    pub(super) antiperiodic: f64,
}

impl FreeMotion {
    /// Over a time ≥ 0, for any ζ ≥ 0.
    pub(super) fn new(damping_ratio: f64, time: f64) -> Self {
        let zeta = damping_ratio;
        let square = (1.0 - zeta) * (1.0 + zeta);
        if square > 0.0 {
            let frequency = square.sqrt();
            let decay = libm::exp(-zeta * time);
            let (sine, cosine) = libm::sincos(frequency * time);
            let half = libm::cos(0.5 * frequency * time);
            let lost = libm::expm1(-zeta * time);
            let pushed = decay * sine / frequency;
            Self {
                displaced: decay * cosine + zeta * pushed,
                pushed,
                pushed_rate: decay * cosine - zeta * pushed,
                antiperiodic: lost * lost + 4.0 * decay * (half * half),
            }
        } else {
            // exp(λτ) of both real λ < 0, whose difference is computed without cancellation.
            let spread = (-square).sqrt();
            let slow = -1.0 / (zeta + spread);
            let [slowly, fast] = [slow, -(zeta + spread)].map(|rate| libm::exp(rate * time));
            let pushed = if spread * time == 0.0 {
                slowly * time
            } else {
                -slowly * libm::expm1(-2.0 * spread * time) / (2.0 * spread)
            };
            Self {
                displaced: slowly - slow * pushed,
                pushed,
                pushed_rate: fast + slow * pushed,
                antiperiodic: (1.0 + slowly) * (1.0 + fast),
            }
        }
    }

    /// Displacement and velocity after that time.
    pub(super) fn carry(&self, [x, v]: [f64; 2]) -> [f64; 2] {
        let Self { displaced, pushed, pushed_rate, .. } = *self;
        [displaced * x + pushed * v, pushed_rate * v - pushed * x]
    }
}

/// A function of time with its first two derivatives.
type Jet = [f64; 3];

/// The half cycle. In the inertial frame x = Re(Z e^{iΩτ}) + h(τ), where h is free motion, and the absorber
/// moves uniformly from sT/2 to −sT/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfCycle {
    /// T = π/Ω.
    pub(super) duration: f64,
    /// Ω
    pub(super) frequency: f64,
    /// ζ
    pub(super) damping_ratio: f64,
    /// d
    pub(super) clearance: f64,
    /// s > 0, the speed of the absorber between impacts.
    pub(super) speed: f64,
    /// Z, the forced part of x in the inertial frame.
    pub(super) forced: Complex<f64>,
    /// The forced part of x relative to the base; Z itself where the base is at rest.
    pub(super) relative: Complex<f64>,
    /// h and ḣ at time zero.
    pub(super) free: [f64; 2],
}

impl HalfCycle {
    /// Displacement of the primary relative to the base, with its derivatives.
    pub(super) fn primary(&self, time: f64) -> Jet {
        let free = self.free_part(time);
        let forced = self.harmonic(self.relative, time);
        std::array::from_fn(|k| free[k] + forced[k])
    }

    /// Gap displacement, with its derivatives.
    pub(super) fn gap(&self, time: f64) -> Jet {
        let free = self.free_part(time);
        let forced = self.harmonic(self.forced, time);
        let absorber = [self.speed * (0.5 * self.duration - time), -self.speed, 0.0];
        std::array::from_fn(|k| absorber[k] - free[k] - forced[k])
    }

    fn free_part(&self, time: f64) -> Jet {
        let [h, rate] = FreeMotion::new(self.damping_ratio, time).carry(self.free);
        [h, rate, -h - 2.0 * self.damping_ratio * rate]
    }

    fn harmonic(&self, of: Complex<f64>, time: f64) -> Jet {
        let (sine, cosine) = libm::sincos(self.frequency * time);
        let value = of.re * cosine - of.im * sine;
        let rate = -self.frequency * (of.re * sine + of.im * cosine);
        [value, rate, -self.frequency * self.frequency * value]
    }

    /// √(h² + ḣ²) at an instant. It never grows; multiplied by (1 + 2ζ) and (1 + 2ζ)² it bounds |ḧ| and |h⃛|
    /// at every later instant.
    fn free_size(&self, time: f64) -> f64 {
        let [h, rate, _] = self.free_part(time);
        h.hypot(rate)
    }

    /// True if |y| < d is proved inside the half cycle.
    ///
    /// On an interval of half width r around m the distance D to a wall is at least D(m) − |Ḋ(m)| r − K r²/2,
    /// K a bound on |D̈|. Next to an impact, where D = 0, it is sufficient that D is monotonic, or that it
    /// leaves the wall and is convex. Intervals for which neither is proved are halved. If an interval
    /// becomes too short, or a value lies beyond the wall, the wall counts as touched; so does a distance
    /// within rounding of zero, which is not decided.
    pub(super) fn stays_in_the_gap(&self) -> bool {
        [1.0, -1.0].into_iter().all(|wall| self.stays_off(wall))
    }

    fn stays_off(&self, wall: f64) -> bool {
        let size = self.clearance + self.speed * self.duration + self.forced.norm();
        let rounding = ROUNDING * f64::EPSILON * (size + self.free_size(0.0));
        let growth = 1.0 + 2.0 * self.damping_ratio;
        let mut open = vec![(0.0, self.duration)];
        while let Some((from, to)) = open.pop() {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let [y, rate, curvature] = self.gap(middle);
            let (distance, rate, curvature) =
                (self.clearance - wall * y, -wall * rate, -wall * curvature);
            let free = self.free_size(from) * growth;
            let forced = self.frequency * self.frequency * self.forced.norm();
            let bound = free + forced;
            let third = free * growth + forced * self.frequency;
            let leaves = wall > 0.0 && from == 0.0;
            let arrives = wall < 0.0 && to == self.duration;
            let clear = distance - rate.abs() * half - 0.5 * bound * half * half > rounding
                // The absorber leaves with e times the approach speed, so never into the wall.
                || leaves && (rate > bound * half || curvature > third * half)
                || arrives && rate < -bound * half;
            if clear {
                continue;
            }
            let touched = distance < -rounding || half < FINEST * self.duration;
            if touched {
                return false;
            }
            open.extend([(middle, to), (from, middle)]);
        }
        true
    }

    /// The largest |x| relative to the base, to rounding. Intervals whose bound
    /// |x(m)| + |ẋ(m)| r + K r²/2 exceeds the largest value found so far are halved.
    pub(super) fn amplitude(&self) -> f64 {
        let growth = 1.0 + 2.0 * self.damping_ratio;
        let forced = self.frequency * self.frequency * self.relative.norm();
        let rounding = f64::EPSILON * (self.relative.norm() + self.free_size(0.0));
        let step = self.duration / FIRST_INTERVALS as f64;
        let instants = (0..=FIRST_INTERVALS).map(|k| k as f64 * step);
        let mut largest =
            instants.clone().fold(0.0, |most: f64, t| most.max(self.primary(t)[0].abs()));
        let mut open: Vec<_> = instants.take(FIRST_INTERVALS).map(|t| (t, t + step)).collect();
        while let Some((from, to)) = open.pop() {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let [x, rate, _] = self.primary(middle);
            largest = largest.max(x.abs());
            let bound = self.free_size(from) * growth + forced;
            let most = x.abs() + rate.abs() * half + 0.5 * bound * half * half;
            if most > largest + rounding && half > FINEST * self.duration {
                open.extend([(middle, to), (from, middle)]);
            }
        }
        largest
    }
}
