//! Two symmetric impacts a cycle under harmonic force or base motion (Masri and Caughey 1966).

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix4, Vector4};

use super::Complex;
use super::half_cycle::{FreeMotion, HalfCycle};
use crate::absorber::Start;
use crate::absorber::piva::Parameters;
use crate::error::{Invalid, number};
use crate::force::{Acts, Harmonic};
use crate::orbit::multipliers;
use crate::range;

/// Frequencies Ω that are accepted, in ωn; outside, an angle of the half cycle loses its digits.
const FREQUENCIES: std::ops::RangeInclusive<f64> = 1e-3..=1e3;
/// Largest ζ that is accepted; above, motion and bounds are of very different size.
const LARGEST_DAMPING: f64 = 100.0;
/// det(1 + Φ) of the free half cycle below which the impacts resonate even without a force.
const RESONANT: f64 = 1e-20;

/// A free mass in its gap on a primary system under one harmonic, in natural units (ωn = 1, primary
/// mass 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetricScene {
    /// Mass ratio μ.
    pub mass_ratio: f64,
    /// Restitution e on the gap velocity.
    pub restitution: f64,
    /// One-sided clearance d.
    pub clearance: f64,
    /// Damping ratio ζ of the primary, at most 100.
    pub damping_ratio: f64,
    /// Force on the primary or motion of the base. Its phase is not used: orbits have their own.
    pub force: Harmonic,
}

/// The symmetric motions with two impacts a cycle of one scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MasriCaughey {
    /// Largest |x| (relative to the base) of the steady vibration of the primary without absorber, length.
    pub amplitude_without_absorber: f64,
    /// d_max, the largest clearance at which such motions exist; infinite if they always do.
    pub largest_clearance: f64,
    /// The two motions, the one with the larger speed first. `None` where d > d_max, or where the speed would
    /// not be positive, so that there are no impacts.
    pub branches: [Option<Orbit>; 2],
}

/// One symmetric motion with two impacts a cycle. Where the base moves, displacements and velocities of the
/// primary are relative to the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// s > 0, absolute velocity of the absorber between impacts.
    pub speed: f64,
    /// Phase of the force (the argument of its cosine) at the impact on wall +, in (−π, π] rad.
    pub phase: f64,
    /// Displacement x of the primary at the impact on wall +.
    pub displacement: f64,
    /// Velocity of the primary just before that impact.
    pub velocity_before: f64,
    /// Velocity of the primary just after that impact.
    pub velocity_after: f64,
    /// Approach speed of every impact, 2 s (1 + μ)/(1 + e).
    pub approach_speed: f64,
    /// The largest |x| of the cycle.
    pub amplitude: f64,
    /// True if the absorber touches no wall between the impacts (proven, not sampled; touching within
    /// rounding counts as touching). Otherwise the formulas describe no motion.
    pub admissible: bool,
    /// Multipliers of the half cycle: the eigenvalues of the derivative of the state just after the next
    /// impact, mirrored, with respect to the state just after an impact. Largest first; those of the whole
    /// cycle are their squares. Their product is e² exp(−2ζπ/Ω).
    pub multipliers: [Complex<f64>; 4],
    /// True if all multipliers are smaller than 1, so that small disturbances decay. Without any loss (e = 1,
    /// ζ = 0) they are neutral at best, and rounding decides.
    pub stable: bool,
    /// State just after the impact on wall +, leaving it with e times the approach speed. A run that starts
    /// here, with [`Orbit::phase`] as phase of its force, stays on the orbit.
    pub start: Start,
    half: HalfCycle,
}

/// The symmetric steady motions with two impacts a cycle, in closed form.
///
/// The force is F cos(Ωτ + phase) per primary mass, or a_g has this form; time zero is the impact
/// on wall + (y = +d), after which the absorber moves with −s for half a cycle, T = π/Ω. The free
/// motion of the primary over it is the 2 × 2 map Φ (for ζ ≥ 1 as well), the forced one Re(Z e^{iΩτ}):
///
/// ```text
/// (h0, h1) = (1 + Φ)⁻¹ (0, 1)          x = Re(Z e^{iΩτ}) + 2μs h(τ), h(0) = h0, ḣ(0) = h1
/// X = |Z| = F/√((1−Ω²)² + (2ζΩ)²)
/// A = π/(2Ω) − 2μ h0,  B = [(1−e−2μe)/(1+e) + 2μ h1]/Ω
/// s = [A d ± √(X²(A²+B²) − d²B²)]/(A²+B²),  Z = (sA − d) + i sB
/// x = πs/(2Ω) − d,  ẋ = −s(1−e+2μ)/(1+e) before, −s(1−e−2μe)/(1+e) after the impact
/// d_max = X √(A²+B²)/|B|,  phase = arg Z + arg(1 − Ω² + 2iζΩ)
/// ```
///
/// A moving base is the force x_g + 2ζẋ_g in the inertial frame, where the absorber feels nothing
/// between impacts: the same formulas with X = A_g √(1+(2ζΩ)²)/Ω² /√((1−Ω²)² + (2ζΩ)²).
///
/// The map of the half cycle is exact: the flow of (x, ẋ, x₁, ẋ₁) over T, then the saltation matrix of the
/// impact, J + (f⁺ − J f⁻) nᵀ/(nᵀf⁻) with J the velocity jump, f the vector field before and after, n the
/// gradient of the gap; then the reflection.
///
/// Sources: S. F. Masri and T. K. Caughey, On the stability of the impact damper, J. Appl. Mech. 33
/// (1966) 586–592 (motion and stability); P. C. Müller, Calculation of Lyapunov exponents for
/// dynamic systems with discontinuities, Chaos, Solitons & Fractals 5 (1995) 1671–1681, and M. di
/// Bernardo et al., Piecewise-smooth Dynamical Systems, Springer 2008 (saltation).
///
/// The accuracy is some 2⁻⁵³ of X: where a nearly undamped primary is driven at resonance and the absorber
/// keeps its motion x far below X, x loses that many digits.
///
/// # Errors
/// [`Invalid`] for a number out of [`range`], a force of amplitude 0, ζ > 100, Ω outside 10⁻³ … 10³, and
/// without damping Ω = 1, where force and impacts both resonate, and Ω = 1/3, 1/5, …, where the
/// impacts do.
pub fn masri_caughey(scene: &SymmetricScene) -> Result<MasriCaughey, Invalid> {
    let SymmetricScene { mass_ratio, restitution: e, clearance: d, damping_ratio: zeta, force } =
        *scene;
    Parameters::free_mass(mass_ratio, e, d, zeta).check()?;
    if zeta > LARGEST_DAMPING {
        let rule = format!("give at most {LARGEST_DAMPING} for this closed form");
        return Err(Invalid::new("primary.damping_ratio", number(zeta), rule));
    }
    range::positive("force.amplitude", force.amplitude.abs())?;
    let omega = force.frequency;
    if !FREQUENCIES.contains(&omega) {
        let rule = format!("give {:e} to {:e} times ωn", FREQUENCIES.start(), FREQUENCIES.end());
        return Err(Invalid::new("force.frequency", number(omega), rule));
    }
    let response = Response::new(zeta, &force);
    let period = FreeMotion::new(zeta, PI / omega);
    if response.drive.norm() == 0.0 || period.antiperiodic < RESONANT {
        let rule = "without damping the closed form has no value at ωn and its odd fractions; \
                    give damping or another frequency";
        return Err(Invalid::new("force.frequency", number(omega), rule));
    }
    let amplitude = force.amplitude.abs() / response.drive.norm();
    let h0 = -period.pushed / period.antiperiodic;
    let h1 = (1.0 + period.displaced) / period.antiperiodic;
    let a = 0.5 * PI / omega - 2.0 * mass_ratio * h0;
    let b = ((1.0 - e - 2.0 * mass_ratio * e) / (1.0 + e) + 2.0 * mass_ratio * h1) / omega;
    let branch = |speed: f64| {
        let push = 2.0 * mass_ratio * speed;
        let forced = Complex::new(speed * a - d, speed * b);
        let half = HalfCycle {
            duration: PI / omega,
            frequency: omega,
            damping_ratio: zeta,
            clearance: d,
            speed,
            forced,
            relative: forced * response.relative,
            free: [push * h0, push * h1],
        };
        Orbit::new(scene, half, forced * response.drive)
    };
    Ok(MasriCaughey {
        amplitude_without_absorber: amplitude * response.relative.norm(),
        largest_clearance: amplitude * (a.hypot(b) / b.abs()),
        branches: speeds(amplitude, d, a, b).map(|speed| speed.map(branch)),
    })
}

/// Both roots s of (A² + B²) s² − 2Ad s + d² − X² = 0, the larger first; `None` if not positive.
fn speeds(amplitude: f64, clearance: f64, a: f64, b: f64) -> [Option<f64>; 2] {
    let size = a.hypot(b);
    let (along, across) = (clearance * (a / size), clearance * (b.abs() / size));
    // Negative, so that its root is NaN, where d > d_max.
    let root = (amplitude - across).sqrt() * (amplitude + across).sqrt();
    // One of the two roots is free of cancellation; the other follows from their product.
    let far = along + root.copysign(along);
    let near = (clearance - amplitude) / far * (clearance + amplitude);
    let roots = if far > near { [far, near] } else { [near, far] };
    roots.map(|root| Some(root / size).filter(|speed| *speed > 0.0 && speed.is_finite()))
}

/// The response of the primary alone to the drive.
struct Response {
    /// Complex amplitude of the drive over that of the forced motion in the inertial frame.
    drive: Complex<f64>,
    /// Forced motion relative to the base over forced motion in the inertial frame.
    relative: Complex<f64>,
}

impl Response {
    fn new(damping_ratio: f64, force: &Harmonic) -> Self {
        let omega = force.frequency;
        let damper = 2.0 * damping_ratio * omega;
        let stiffness = Complex::new((1.0 - omega) * (1.0 + omega), damper);
        let relative = match force.acts {
            Acts::Primary => Complex::new(1.0, 0.0),
            Acts::Base => Complex::new(omega * omega, 0.0) / Complex::new(1.0, damper),
        };
        // Relative to the base, the base motion acts as the force −a_g.
        let drive = match force.acts {
            Acts::Primary => stiffness,
            Acts::Base => -stiffness * relative,
        };
        Self { drive, relative }
    }
}

impl Orbit {
    /// The orbit of a half cycle under a drive whose complex amplitude is given up to its sign.
    fn new(scene: &SymmetricScene, half: HalfCycle, drive: Complex<f64>) -> Self {
        let SymmetricScene { mass_ratio, restitution: e, force, .. } = *scene;
        let HalfCycle { speed, frequency, forced, relative, .. } = half;
        let base_velocity = -frequency * (forced.im - relative.im);
        let rebound = -speed / (1.0 + e);
        let before = rebound * (1.0 - e + 2.0 * mass_ratio);
        let after = rebound * (1.0 - e - 2.0 * mass_ratio * e);
        let approach_speed = 2.0 * speed * (1.0 + mass_ratio) / (1.0 + e);
        let displacement = relative.re + half.free[0];
        let multipliers = multipliers(scene, &half, before, after);
        let start = Start {
            displacement,
            velocity: after - base_velocity,
            gap_displacement: half.clearance,
            gap_velocity: -e * approach_speed,
        };
        Self {
            speed,
            phase: within_a_turn((drive * force.amplitude.signum()).arg()),
            displacement,
            velocity_before: before - base_velocity,
            velocity_after: start.velocity,
            approach_speed,
            amplitude: half.amplitude(),
            admissible: half.stays_in_the_gap(),
            multipliers,
            stable: multipliers.iter().all(|multiplier| multiplier.norm() < 1.0),
            start,
            half,
        }
    }

    /// State at an instant at which the force has this phase, in rad: the start of a run on the orbit under a
    /// force of that phase.
    pub fn at_phase(&self, phase: f64) -> Start {
        let turned = (phase - self.phase).rem_euclid(TAU);
        if turned == 0.0 {
            return self.start;
        }
        // The second half of a cycle is the mirror image of the first.
        let (sign, turned) = if turned < PI { (1.0, turned) } else { (-1.0, turned - PI) };
        let time = turned / self.half.frequency;
        let [x, v, _] = self.half.primary(time);
        let [y, w, _] = self.half.gap(time);
        let d = self.half.clearance;
        Start {
            displacement: sign * x,
            velocity: sign * v,
            gap_displacement: sign * y.clamp(-d, d),
            gap_velocity: sign * w,
        }
    }
}

/// An angle of [−π, π] in (−π, π].
fn within_a_turn(angle: f64) -> f64 {
    if angle == -PI { PI } else { angle }
}

/// Eigenvalues of the half cycle's map of (x, ẋ, x₁, ẋ₁) in the inertial frame, from just after an
/// impact to just after the next, mirrored; `before` and `after` are ẋ at the impact on wall +.
fn multipliers(
    scene: &SymmetricScene,
    half: &HalfCycle,
    before: f64,
    after: f64,
) -> [Complex<f64>; 4] {
    let SymmetricScene { mass_ratio, restitution, damping_ratio, .. } = *scene;
    let FreeMotion { displaced: c, pushed: s, pushed_rate, .. } =
        FreeMotion::new(damping_ratio, half.duration);
    #[rustfmt::skip]
    let flow = Matrix4::new(
        c,   s,           0.0, 0.0,
        -s,  pushed_rate, 0.0, 0.0,
        0.0, 0.0,         1.0, half.duration,
        0.0, 0.0,         0.0, 1.0,
    );
    // Shares of the approach velocity that the primary gains and the absorber loses.
    let lost = (1.0 + restitution) / (1.0 + mass_ratio);
    let gained = mass_ratio * lost;
    #[rustfmt::skip]
    let jump = Matrix4::new(
        1.0, 0.0,          0.0, 0.0,
        0.0, 1.0 - gained, 0.0, gained,
        0.0, 0.0,          1.0, 0.0,
        0.0, lost,         0.0, 1.0 - lost,
    );
    let [h, rate] = half.free;
    let acceleration_after =
        -half.frequency * half.frequency * half.forced.re - h - 2.0 * damping_ratio * rate;
    let acceleration_before = acceleration_after + 2.0 * damping_ratio * (after - before);
    let field_before = Vector4::new(before, acceleration_before, half.speed, 0.0);
    let field_after = Vector4::new(after, acceleration_after, -half.speed, 0.0);
    let gap = Vector4::new(-1.0, 0.0, 1.0, 0.0);
    let approach = half.speed - before;
    let saltation = jump + (field_after - jump * field_before) * gap.transpose() / approach;
    eigenvalues(&-(saltation * flow), half.frequency)
}

/// Eigenvalues of a map of displacements and velocities, the largest first.
fn eigenvalues(map: &Matrix4<f64>, frequency: f64) -> [Complex<f64>; 4] {
    // In time units of 1/Ω displacements and velocities are of one size.
    let units = Vector4::new(frequency, 1.0, frequency, 1.0);
    let scaled = Matrix4::from_fn(|row, column| units[row] * map[(row, column)] / units[column]);
    multipliers::of_four(&scaled)
}
