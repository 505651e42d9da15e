//! A scene made of any bits: every number of both absorbers, of forces and limits.

use std::sync::Arc;

use arbitrary::Arbitrary;
use iva_core::absorber::Start;
use iva_core::error::Invalid;
use iva_core::force::{Acts, Force, Harmonic, History, Impulse, Record};
use iva_core::host::DrivenHost;
use iva_core::piva::{Angles, Given, ImpactLaw, Parameters, Piva, PivaStart};
use iva_core::simulate::Limits;
use iva_core::siva::Siva;
use iva_core::steady::Window;

/// More forces of one sort are left out.
const FORCES: usize = 3;
/// More points of a record are left out.
const POINTS: usize = 16;
/// A run of so many impacts, or segments, is as long as any.
const WORK: u64 = 300;

/// Numbers by the names of [`iva_core`].
#[derive(Debug, Arbitrary)]
pub struct Scene {
    pendulum: bool,
    small_angles: bool,
    printed_law: bool,
    place_is_angle: bool,
    rate_is_angle: bool,
    mass_ratio: f64,
    restitution: f64,
    clearance: f64,
    damping_ratio: f64,
    frequency_ratio: f64,
    length: f64,
    inertia_ratio: f64,
    contact_distance: f64,
    pivot_damping_ratio: f64,
    spring_ratio: f64,
    tolerance: f64,
    displacement: f64,
    velocity: f64,
    place: f64,
    rate: f64,
    duration: f64,
    chatter_floor: f64,
    max_impacts: u16,
    max_work: u16,
    discarded: f64,
    harmonics: Vec<AnyHarmonic>,
    impulses: Vec<AnyImpulse>,
    records: Vec<AnyRecord>,
}

#[derive(Debug, Arbitrary)]
struct AnyHarmonic {
    on_base: bool,
    amplitude: f64,
    frequency: f64,
    phase: f64,
}

#[derive(Debug, Arbitrary)]
struct AnyImpulse {
    velocity: f64,
    time: f64,
}

#[derive(Debug, Arbitrary)]
struct AnyRecord {
    on_base: bool,
    rate: f64,
    scale: f64,
    points: Vec<[f64; 2]>,
}

/// What is run.
#[derive(Debug)]
pub enum Absorber {
    /// A free mass in free decay.
    Siva(Box<Siva>, Start),
    /// A free mass under a force.
    DrivenSiva(Box<Siva<DrivenHost>>, Start),
    /// A pendulum.
    Piva(Box<Piva>, PivaStart),
    /// A pendulum under a force.
    DrivenPiva(Box<Piva<DrivenHost>>, PivaStart),
}

impl Scene {
    /// The absorber on its primary, with its start.
    ///
    /// # Errors
    /// [`Invalid`] for a number out of range.
    pub fn absorber(&self) -> Result<Absorber, Invalid> {
        let Self { mass_ratio, restitution, clearance, damping_ratio, .. } = *self;
        let force = self.force()?;
        if self.pendulum {
            let (piva, start) = (Piva::new(self.parameters())?, self.pendulum_start());
            return Ok(if force.is_none() {
                Absorber::Piva(Box::new(piva), start)
            } else {
                Absorber::DrivenPiva(Box::new(piva.under(force)), start)
            });
        }
        let siva = Siva::new(mass_ratio, restitution, clearance, damping_ratio)?;
        if force.is_none() {
            return Ok(Absorber::Siva(Box::new(siva), self.start()));
        }
        Ok(Absorber::DrivenSiva(Box::new(siva.under(force)), self.start()))
    }

    fn parameters(&self) -> Parameters {
        Parameters {
            mass_ratio: self.mass_ratio,
            restitution: self.restitution,
            clearance: self.clearance,
            damping_ratio: self.damping_ratio,
            frequency_ratio: self.frequency_ratio,
            length: self.length,
            inertia_ratio: self.inertia_ratio,
            contact_distance: self.contact_distance,
            pivot_damping_ratio: self.pivot_damping_ratio,
            spring_ratio: self.spring_ratio,
            angles: if self.small_angles { Angles::Small } else { Angles::Large },
            impact_law: if self.printed_law { ImpactLaw::Printed } else { ImpactLaw::Consistent },
            tolerance: self.tolerance,
        }
    }

    fn start(&self) -> Start {
        Start {
            displacement: self.displacement,
            velocity: self.velocity,
            gap_displacement: self.place,
            gap_velocity: self.rate,
        }
    }

    fn pendulum_start(&self) -> PivaStart {
        let given =
            |angle: bool, value| if angle { Given::Angle(value) } else { Given::Gap(value) };
        PivaStart {
            displacement: self.displacement,
            velocity: self.velocity,
            place: given(self.place_is_angle, self.place),
            rate: given(self.rate_is_angle, self.rate),
        }
    }

    /// The sum of the forces.
    ///
    /// # Errors
    /// [`Invalid`] for a number out of range.
    pub fn force(&self) -> Result<Force, Invalid> {
        let harmonics = self.harmonics.iter().take(FORCES).map(|it| Harmonic {
            amplitude: it.amplitude,
            frequency: it.frequency,
            phase: it.phase,
            acts: acts(it.on_base),
        });
        let impulses = self.impulses.iter().take(FORCES);
        let impulses: Vec<Impulse> =
            impulses.map(|it| Impulse { velocity: it.velocity, time: it.time }).collect();
        let records = self.records.iter().take(FORCES).map(AnyRecord::record);
        Force::new(harmonics.collect(), records.collect::<Result<_, _>>()?, &impulses)
    }

    /// How long to run: never for more than a moment.
    pub fn limits(&self) -> Limits {
        Limits {
            duration: self.duration,
            max_impacts: u64::from(self.max_impacts).min(WORK),
            max_work: u64::from(self.max_work).min(WORK),
            chatter_floor: self.chatter_floor,
        }
    }

    /// What a steady state is measured by, as in a sweep: some share of the run, and the first
    /// harmonic force.
    pub fn window(&self, force: &Force) -> Window {
        let share = self.discarded;
        let from = if (0.0..1.0).contains(&share) { share * self.duration } else { 0.0 };
        Window { from, cycle: force.harmonics().first().copied() }
    }
}

impl AnyRecord {
    fn record(&self) -> Result<Record, Invalid> {
        let mut points: Vec<[f64; 2]> = self.points.iter().take(POINTS).copied().collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (times, values) = points.into_iter().map(|[time, value]| (time, value)).unzip();
        let history = Arc::new(History::new(times, values)?);
        Ok(Record { history, acts: acts(self.on_base), rate: self.rate, scale: self.scale })
    }
}

fn acts(on_base: bool) -> Acts {
    if on_base { Acts::Base } else { Acts::Primary }
}
