//! A scene with extreme numbers, and its images.

use super::watch::Watch;
use crate::rng::Rng;
use iva_core::{
    absorber::{Absorber, Start},
    error::Invalid,
    force::{Acts, Force, Harmonic},
    piva::{Angles, Parameters, Piva},
    run::states,
    sample::State,
    simulate::{Limits, simulate},
    siva::Siva,
};
use std::f64::consts::TAU;

/// A scene: a free mass or a pendulum.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The absorber on its primary; for a free mass only the first four numbers are used.
    pub parameters: Parameters,
    /// True for a free mass, whose motion without force is in closed form.
    pub free_mass: bool,
    /// The force that drives it; `None` for free decay.
    pub harmonic: Option<Harmonic>,
    /// State at the start.
    pub start: Start,
    /// Length of the run, in 1/ωn.
    pub duration: f64,
    /// Largest number of impacts.
    pub max_impacts: u64,
    /// Largest number of segments.
    pub max_work: u64,
}

impl Scene {
    /// A free mass in free decay, with limits that soon end the run.
    pub fn siva(mu: f64, e: f64, clearance: f64, zeta: f64, start: Start, duration: f64) -> Self {
        Self {
            parameters: Parameters::free_mass(mu, e, clearance, zeta),
            free_mass: true,
            harmonic: None,
            start,
            duration,
            max_impacts: 1000,
            max_work: 4000,
        }
    }

    /// The same scene with a pendulum.
    pub fn with_pendulum(self, length: f64, frequency_ratio: f64) -> Self {
        let Parameters { mass_ratio, restitution, clearance, damping_ratio, .. } = self.parameters;
        let bob = Parameters::point_bob(mass_ratio, restitution, clearance, damping_ratio, length);
        Self {
            parameters: Parameters { frequency_ratio, ..bob },
            free_mass: false,
            max_impacts: 100,
            max_work: 400,
            ..self
        }
    }

    /// The scene with all lengths times a factor; a negative factor gives the mirror image.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scene = self.clone();
        let size = factor.abs();
        scene.parameters.clearance *= size;
        scene.parameters.length *= size;
        scene.parameters.contact_distance *= size;
        let Start { displacement, velocity, gap_displacement, gap_velocity } = &mut scene.start;
        for length in [displacement, velocity, gap_displacement, gap_velocity] {
            *length *= factor;
        }
        if let Some(harmonic) = &mut scene.harmonic {
            harmonic.amplitude *= factor;
        }
        scene
    }

    /// The scene restarted from a state in flight; `None` if the pendulum is not below its pivot.
    pub fn again(&self, state: &State, duration: f64) -> Option<Self> {
        let below = state.angle.is_none_or(|angle| angle.value.abs() < 1.57);
        let start = Start {
            displacement: state.displacement,
            velocity: state.velocity,
            gap_displacement: state.gap_displacement,
            gap_velocity: state.gap_velocity,
        };
        let max_work = 10 * self.max_work;
        below.then(|| Self { start, duration, max_impacts: 1, max_work, ..self.clone() })
    }

    fn limits(&self) -> Limits {
        Limits {
            max_impacts: self.max_impacts,
            max_work: self.max_work,
            ..Limits::new(self.duration, self.parameters.clearance)
        }
    }

    fn mass(&self) -> Result<Siva, Invalid> {
        let Parameters { mass_ratio, restitution, clearance, damping_ratio, .. } = self.parameters;
        Siva::new(mass_ratio, restitution, clearance, damping_ratio)
    }

    fn pendulum(&self) -> Result<Piva, Invalid> {
        Piva::new(self.parameters)
    }

    fn force(&self) -> Result<Force, Invalid> {
        Force::harmonic(self.harmonic.into_iter().collect())
    }

    /// Runs the scene and watches it; lengths enter the digest times `factor`.
    ///
    /// # Errors
    /// The error of the simulator.
    pub fn watch(&self, factor: f64) -> Result<Watch, Invalid> {
        match (self.free_mass, self.harmonic) {
            (true, None) => self.watched(&self.mass()?, &self.start, factor),
            (true, Some(_)) => {
                self.watched(&self.mass()?.under(self.force()?), &self.start, factor)
            }
            (false, None) => self.watched(&self.pendulum()?, &self.start.into(), factor),
            (false, Some(_)) => {
                let driven = self.pendulum()?.under(self.force()?);
                self.watched(&driven, &self.start.into(), factor)
            }
        }
    }

    fn watched<S: Absorber<Real = f64>>(
        &self,
        system: &S,
        start: &S::Start,
        factor: f64,
    ) -> Result<Watch, Invalid> {
        let mut watch = Watch::new(&self.parameters, factor);
        simulate(system, start, &self.limits(), None, &mut watch)?;
        Ok(watch)
    }

    /// The states of the scene at some instants.
    ///
    /// # Errors
    /// The error of the simulator.
    pub fn states(&self, times: &[f64]) -> Result<Vec<State>, Invalid> {
        let limits = self.limits();
        match (self.free_mass, self.harmonic) {
            (true, None) => states(&self.mass()?, &self.start, &limits, times),
            (true, Some(_)) => {
                states(&self.mass()?.under(self.force()?), &self.start, &limits, times)
            }
            (false, None) => states(&self.pendulum()?, &self.start.into(), &limits, times),
            (false, Some(_)) => {
                let driven = self.pendulum()?.under(self.force()?);
                states(&driven, &self.start.into(), &limits, times)
            }
        }
    }
}

/// Extreme parameters and starts: μ 1e-9 … 1e3, γ 1e-9 … 3, e 0 … 1, ζ 0 … 100, x₀ 1e-12 … 1e6,
/// L/x₀ 1.0000001 γ … 1e9.
pub fn extreme(rng: &mut Rng) -> Scene {
    let x0 = rng.log_range(1e-12, 1e6) * rng.sign();
    let size = x0.abs();
    let mu = rng.log_range(1e-9, 1e3);
    let any = rng.unit();
    let e = rng.pick(&[0.0, 1.0, 1e-12, 1.0 - 1e-12, any, any, any, any]);
    let any = rng.log_range(1e-9, 100.0);
    let zeta = rng.pick(&[0.0, 0.01, any, any, any, 1.0, 1.0 - 1e-15, 1.0 + 1e-15]);
    let least = rng.pick(&[1e-9, 0.03]);
    let gamma = rng.log_range(least, 3.0);
    let clearance = gamma * size;
    let any = rng.range(-1.0, 1.0);
    let place = rng.pick(&[0.0, any, any, 1.0, -1.0, 1.0 - f64::EPSILON]);
    let speeds = [rng.range(-1.0, 1.0), rng.log_range(1e-12, 3.0) * rng.sign()];
    let start = Start {
        displacement: rng.pick(&[x0, x0, x0, 0.0]),
        velocity: size * rng.pick(&[0.0, speeds[0]]),
        gap_displacement: clearance * place,
        gap_velocity: size * rng.pick(&[0.0, speeds[1]]),
    };
    let duration = rng.range(5.0, 30.0) / (1.0 + zeta);
    let mut scene = Scene::siva(mu, e, clearance, zeta, start, duration);
    if rng.unit() < 0.35 {
        let shortest = 1.000_000_1 * clearance;
        let length = rng.log_range(shortest, 1e9 * size.max(clearance));
        let any = rng.log_range(1e-3, 3.0);
        scene = scene.with_pendulum(length, rng.pick(&[0.0, any, any]));
        let p = &mut scene.parameters;
        if rng.unit() < 0.3 {
            p.inertia_ratio = rng.range(1.0, 1.5);
            p.contact_distance = length * rng.range(1.0, 1.4);
            let any = rng.log_range(1e-6, 1.0);
            p.pivot_damping_ratio = rng.pick(&[0.0, any]);
        }
        if rng.unit() < 0.25 {
            p.angles = Angles::Small;
        }
        if rng.unit() < 0.25 && clearance < p.contact_distance {
            p.spring_ratio = rng.log_range(1e-3, 3.0);
        }
    }
    if rng.unit() < 0.15 {
        (scene.max_impacts, scene.max_work) = (100, 400);
        scene.harmonic = Some(Harmonic {
            amplitude: size * rng.log_range(1e-3, 10.0),
            frequency: rng.log_range(0.01, 10.0),
            phase: rng.range(0.0, TAU),
            acts: if rng.sign() > 0.0 { Acts::Primary } else { Acts::Base },
        });
    }
    scene
}
