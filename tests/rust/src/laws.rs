//! Laws of restitution by their numbers, and free masses that have them.

use iva_core::{
    absorber::{Absorber, Start, restitution::RestitutionLaw},
    force::{Acts, Force, Harmonic},
    host::UndrivenHost,
    real::Real,
    run::{Run, run},
    simulate::Limits,
    siva::{Siva, SivaState},
};

/// A law by its numbers.
#[derive(Debug, Clone, Copy)]
pub enum Law {
    /// e.
    Constant(f64),
    /// a and the exponent p/q.
    Power(f64, [u32; 2]),
    /// The yield speed.
    Plastic(f64),
    /// The points.
    Table(&'static [[f64; 2]]),
}

/// Of every kind; some chatters end in stick, some do not.
pub const LAWS: [Law; 8] = [
    Law::Constant(0.5),
    Law::Power(0.4, [1, 5]),
    Law::Power(1.1, [1, 5]),
    Law::Power(2.0, [1, 4]),
    Law::Power(0.5, [1, 1]),
    Law::Plastic(0.02),
    Law::Table(&[[0.01, 0.8], [0.1, 0.6], [0.3, 0.65], [1.5, 0.2]]),
    Law::Table(&[[0.0, 1.0], [0.5, 0.7]]),
];

impl Law {
    /// The law of the core.
    pub fn made<R: Real>(self) -> RestitutionLaw<R> {
        match self {
            Law::Constant(e) => RestitutionLaw::constant(R::from(e)),
            Law::Power(a, b) => RestitutionLaw::power(R::from(a), b),
            Law::Plastic(speed) => RestitutionLaw::plastic(R::from(speed)),
            Law::Table(points) => {
                let points: Vec<_> = points.iter().map(|point| point.map(R::from)).collect();
                RestitutionLaw::table(&points)
            }
        }
        .unwrap()
    }

    /// e by other functions than those of the core.
    pub fn expected(self, u: f64) -> f64 {
        match self {
            Law::Constant(e) => e,
            Law::Power(a, [p, q]) => (1.0 - a * u.powf(f64::from(p) / f64::from(q))).max(0.0),
            Law::Plastic(speed) => {
                let q = speed / u;
                let stored = q / (q + 2.0 * (1.2 - 0.2 * q * q).sqrt());
                let law = (1.2 * 3f64.sqrt() * (1.0 - q * q / 6.0)).sqrt() * stored.powf(0.25);
                if q >= 1.0 { 1.0 } else { law }
            }
            Law::Table(points) => {
                let at = points.iter().position(|[speed, _]| u < *speed).unwrap_or(points.len());
                match (at.checked_sub(1).map(|k| points[k]), points.get(at)) {
                    (Some([u0, e0]), Some([u1, e1])) => e0 + (e1 - e0) * (u - u0) / (u1 - u0),
                    (Some([_, e]), None) => e,
                    (None, above) => above.unwrap()[1],
                }
            }
        }
    }

    /// True if a chatter can end in stick.
    pub fn sticks(self) -> bool {
        match self {
            Law::Constant(e) => e < 1.0,
            Law::Power(_, [p, q]) => p < q,
            Law::Plastic(_) => false,
            Law::Table(points) => points[0][1] < 1.0,
        }
    }
}

/// A free mass on a structure without drive.
pub type Free<R = f64> = Siva<UndrivenHost<R>>;

/// A free mass of μ, d, ζ with a law at both walls.
pub fn mass<R: Real>([mu, d, zeta]: [f64; 3], law: Law) -> Free<R> {
    let [mu, d, zeta] = [mu, d, zeta].map(R::from);
    Siva::new(mu, R::ONE, d, zeta).unwrap().with_restitution_law(law.made())
}

/// A structure that is let go.
pub fn start<R: Real>() -> Start<R> {
    Start { displacement: R::ONE, ..Start::default() }
}

/// A harmonic force.
pub fn push<R: Real>(amplitude: f64, frequency: f64, acts: Acts) -> Force<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, 0.3].map(R::from);
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase, acts }]).unwrap()
}

/// A decay from [`start`].
pub fn decay<R: Real>(system: &Free<R>, duration: f64) -> Run<SivaState<(), R>, R> {
    let limits = Limits::new(R::from(duration), system.clearance());
    run(system, &start(), &limits).unwrap()
}
