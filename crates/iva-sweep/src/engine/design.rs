//! One design point: from the fields a user gave to the scene the core runs.
//!
//! [`Spec`] holds fields as given. [`Given::design`] resolves the alternatives (mass or mass ratio;
//! clearance, gap or relative clearance; …) without guessing, and converts to natural units.

use std::sync::atomic::AtomicBool;

use super::contact::Contact;
use super::forces;
use super::free_mass::{self, Weight};
use super::given::Given;
use super::modal;
use super::pendulum::{self, Common};
use super::restitution;
use super::scale::Scale;
use super::scene::{Mounted, Scene};
use crate::choices::Kind;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::units::UnitSystem;
use iva_core::absorber::{Absorber, Start};
use iva_core::force::Force;
use iva_core::piva::Piva;
use iva_core::real::Real;
use iva_core::run::bare::{self, Bare};
use iva_core::run::side_by_side::Tier;
use iva_core::simulate::Limits;
use iva_core::siva::Siva;
use iva_core::steady::Window;

pub use crate::spec::{MOST_ABSORBERS, Spec};

/// A design point ready to run, in natural units, with the scale to the user's units.
#[derive(Debug, Clone)]
pub struct Design<R: Real = f64> {
    /// The absorber on its primary system, and its start.
    pub scene: Scene<R>,
    /// Duration, limits and chatter floor.
    pub limits: Limits<R>,
    /// The instant at which the run begins, in 1/ωn.
    pub begin: R,
    /// What is known of the contacts of each absorber, `None` of one of which neither contact time nor contact stiffness is given; empty if
    /// nothing is known of any.
    pub contacts: Vec<Option<Contact<R>>>,
    /// The window of the steady state.
    pub window: Window<R>,
    /// Factors from natural units to the user's.
    pub scale: Scale<R>,
    /// The user's units.
    pub units: UnitSystem,
    /// The accuracy tier of the run.
    pub tier: Tier,
}

impl<R: Real> Design<R> {
    /// The motion of the primary without absorber, see [`bare::without_absorber`]; `None` in free
    /// decay, and of a structure with several modes.
    ///
    /// # Errors
    /// [`Invalid`] for numbers that the core refuses.
    pub(crate) fn without_absorber(&self, cancel: &AtomicBool) -> Result<Option<Bare<R>>, Invalid> {
        let Self { scene, window, limits, .. } = self;
        let at_one_point = |force: &&Force<R>| force.elsewhere().is_empty();
        let force = scene.force().filter(|_| scene.moves_as_one()).filter(at_one_point);
        let Some(force) = force else { return Ok(None) };
        let zeta = scene.damping_ratio();
        let from = (scene.primary(), self.begin);
        bare::without_absorber(force, zeta, from, window, limits, Some(cancel))
    }

    /// The tier of a run that goes by itself: free masses have a fast one in lanes only.
    pub(crate) fn tier_alone(&self) -> Tier {
        self.scene.pendulum().map_or(Tier::Exact, |_| self.tier)
    }
}

impl<R: Real> Given<'_, R> {
    /// Resolves alternatives, checks fields against each other, and converts to natural units.
    ///
    /// # Errors
    /// [`Invalid`] if something is missing, given twice, or inconsistent (a start outside the gap).
    pub fn design(&self) -> Result<Design<R>, Invalid> {
        let (scale, units) = self.scale()?;
        let omega = scale.natural_frequency;
        let start = Start {
            displacement: self.displacement(units)?,
            velocity: self.get(FieldId::Velocity).unwrap_or(R::ZERO) / omega,
            gap_displacement: self.get(FieldId::GapDisplacement).unwrap_or(R::ZERO),
            gap_velocity: self.get(FieldId::GapVelocity).unwrap_or(R::ZERO) / omega,
        };
        let force = forces::force(self, &scale, units)?;
        let begin = self.get(FieldId::StartTime).unwrap_or(R::ZERO) * omega;
        let length = self.duration(omega, &force)?;
        let duration = begin + length;
        if duration <= begin {
            let length = number(length / omega);
            let rule = format!("a run of {length} from there has no length in doubles; give less");
            return Err(Invalid::new(FieldId::StartTime.path(), number(begin / omega), rule));
        }
        let window = self.window([begin, length], &force)?;
        let scene = self.scene(start, force, &scale, units)?;
        let mut contacts = vec![];
        for (place, owner) in self.spec.owners().enumerate() {
            if let Some(contact) = self.of(owner).contact((&scene, place), &scale, units)? {
                contacts.resize(place, None);
                contacts.push(Some(contact));
            }
        }
        let clearance = scene.clearance();
        let limits = Limits {
            duration,
            max_impacts: self
                .spec
                .get(FieldId::MaxImpacts)
                .map_or(Limits::MAX_IMPACTS, |n| n as u64),
            max_work: self.spec.get(FieldId::MaxWork).map_or(Limits::MAX_WORK, |n| n as u64),
            chatter_floor: self
                .get(FieldId::ChatterFloor)
                .map_or(clearance * Limits::CHATTER_FLOOR, |floor| floor / omega),
        };
        limits.check()?;
        let tolerance = self.get(FieldId::Tolerance).unwrap_or(R::ZERO);
        let tier = if tolerance > 0.0 { Tier::Fast } else { Tier::Exact };
        Ok(Design { scene, limits, begin, contacts, window, scale, units, tier })
    }

    /// The parameters that all absorbers have, with that of their primary, in natural units.
    pub(crate) fn common(&self, scale: &Scale<R>, units: UnitSystem) -> Result<Common<R>, Invalid> {
        let damping_ratio = self.damping_ratio(scale, units)?;
        let clearance = self.clearance(self.displacement(units)?, units)?;
        let restitution = restitution::restitution(self)?;
        let mass_ratio = self.mass_ratio(scale, units)?;
        Ok(Common { mass_ratio, restitution, clearance, damping_ratio })
    }

    pub(super) fn displacement(&self, units: UnitSystem) -> Result<R, Invalid> {
        Ok(self.length(FieldId::Displacement, FieldId::DisplacementMm, units)?.unwrap_or(R::ZERO))
    }

    /// What is known of the contacts of an absorber, which has this place in the scene.
    fn contact(
        &self,
        (scene, place): (&Scene<R>, usize),
        scale: &Scale<R>,
        units: UnitSystem,
    ) -> Result<Option<Contact<R>>, Invalid> {
        self.at_most_one(&[FieldId::ContactTime, FieldId::ContactStiffness])?;
        let omega = scale.natural_frequency;
        if let Some(time) = self.get(FieldId::ContactTime) {
            return Ok(Some(Contact::Lasts(time * omega)));
        }
        match (self.get(FieldId::ContactStiffness), scene.absorber_of(place)) {
            (Some(stiffness), Some(absorber)) if units == UnitSystem::Si => {
                let share = absorber.mass_ratio / (R::ONE + absorber.mass_ratio);
                Ok(Some(Contact::Spring((stiffness * share / scale.mass).sqrt() / omega)))
            }
            (Some(stiffness), Some(_)) => {
                Err(self.needs_mass(FieldId::ContactStiffness, stiffness, "or give contact_time"))
            }
            _ => Ok(None),
        }
    }

    fn scene(
        &self,
        start: Start<R>,
        force: Force<R>,
        scale: &Scale<R>,
        units: UnitSystem,
    ) -> Result<Scene<R>, Invalid> {
        if let Some(structure) = self.spec.structure() {
            return modal::scene(self, structure, start, force, scale);
        }
        if modal::needed(self) {
            return modal::on_primary(self, start, force, scale, units);
        }
        if self.spec.count() > 1 || self.spec.units_of(0) > 1 {
            return modal::on_primary(self, start, force, scale, units);
        }
        match self.spec.choices().kind {
            Kind::Siva => {
                let Common { mass_ratio, restitution, clearance, damping_ratio } =
                    self.common(scale, units)?;
                let offset = self.length(FieldId::GapOffset, FieldId::GapOffsetMm, units)?;
                let mut system = Siva::new(mass_ratio, restitution, clearance, damping_ratio)?
                    .with_offset(offset.unwrap_or(R::ZERO))?;
                if let Some(restitution) = self.get(FieldId::RestitutionMinus) {
                    system = system.with_restitution_minus(restitution)?;
                }
                if let Some(laws) = restitution::laws(self, scale.natural_frequency)? {
                    system = system.with_restitution_laws(laws);
                }
                let weight = free_mass::weight(self, scale)?;
                let start = match weight {
                    Some(Weight { along, .. }) if along != 0.0 => {
                        let lower_stop = system.offset() - clearance;
                        let place = start.gap_displacement;
                        let gap_displacement = free_mass::starting_place(self, place, lower_stop);
                        Start { gap_displacement, ..start }
                    }
                    _ => start,
                };
                system.check_start(&start).map_err(|error| free_mass::misplaced(self, error))?;
                let gravity = weight.map(|weight| weight.gravity);
                match weight {
                    Some(Weight { along, .. }) => {
                        let system = system.inclined(along, force);
                        Ok(Scene::DrivenSiva(Mounted { system, start, gravity }))
                    }
                    None if Scene::undriven(&force) => {
                        Ok(Scene::Siva(Mounted { system, start, gravity }))
                    }
                    None => {
                        let system = system.under(force);
                        Ok(Scene::DrivenSiva(Mounted { system, start, gravity }))
                    }
                }
            }
            Kind::Piva => {
                self.at_most_one(&[FieldId::GapDisplacement, FieldId::Angle])?;
                self.at_most_one(&[FieldId::GapVelocity, FieldId::AngularVelocity])?;
                let common = self.common(scale, units)?;
                let (parameters, gravity) = pendulum::parameters(self, common, scale)?;
                let mut system = Piva::new(parameters)?;
                if let Some(restitution) = self.get(FieldId::RestitutionMinus) {
                    system = system.with_restitution_minus(restitution)?;
                }
                let start = pendulum::start(self, start, scale);
                system.check_start(&start)?;
                let system = system.under(force);
                Ok(Scene::Piva(Box::new(Mounted { system, start, gravity })))
            }
            Kind::Stop | Kind::None => modal::on_primary(self, start, force, scale, units),
        }
    }

    pub(crate) fn scale(&self) -> Result<(Scale<R>, UnitSystem), Invalid> {
        if let Some(structure) = self.spec.structure() {
            return Ok(modal::scale(structure));
        }
        self.at_most_one(&[FieldId::NaturalFrequency, FieldId::FrequencyHz, FieldId::Stiffness])?;
        let mass = self.get(FieldId::PrimaryMass);
        let omega = self
            .get(FieldId::NaturalFrequency)
            .or_else(|| self.get(FieldId::FrequencyHz).map(|f| R::TURN.value * f));
        let (natural_frequency, units) = match (mass, self.get(FieldId::Stiffness), omega) {
            (Some(m), Some(k), _) => ((k / m).sqrt(), UnitSystem::Si),
            (Some(_), None, Some(w)) => (w, UnitSystem::Si),
            (Some(_), None, None) => {
                return Err(Invalid::missing(
                    "primary.stiffness",
                    "primary.mass is given, so give stiffness (N/m) or natural_frequency (rad/s) too",
                ));
            }
            (None, Some(_), _) => {
                return Err(Invalid::missing(
                    "primary.mass",
                    "primary.stiffness is given, so give mass (kg) too",
                ));
            }
            (None, None, Some(w)) => (w, UnitSystem::Seconds),
            (None, None, None) => (R::ONE, UnitSystem::Natural),
        };
        Ok((Scale { natural_frequency, mass: mass.unwrap_or(R::ONE) }, units))
    }

    pub(super) fn damping_ratio(&self, scale: &Scale<R>, units: UnitSystem) -> Result<R, Invalid> {
        self.at_most_one(&[FieldId::DampingRatio, FieldId::Damping])?;
        match self.get(FieldId::Damping) {
            Some(c) if units == UnitSystem::Si => {
                let ratio = c / (scale.mass * 2.0 * scale.natural_frequency);
                self.derived(FieldId::Damping, c, FieldId::DampingRatio, ratio)
            }
            Some(c) => Err(self.needs_mass(FieldId::Damping, c, "or give damping_ratio")),
            None => Ok(self.get(FieldId::DampingRatio).unwrap_or(R::ZERO)),
        }
    }

    fn mass_ratio(&self, scale: &Scale<R>, units: UnitSystem) -> Result<R, Invalid> {
        self.at_most_one(&[FieldId::MassRatio, FieldId::AbsorberMass])?;
        match (self.get(FieldId::MassRatio), self.get(FieldId::AbsorberMass)) {
            (Some(ratio), _) => Ok(ratio),
            (None, Some(m)) if units == UnitSystem::Si => {
                self.derived(FieldId::AbsorberMass, m, FieldId::MassRatio, m / scale.mass)
            }
            (None, Some(m)) => Err(self.needs_mass(FieldId::AbsorberMass, m, "or give mass_ratio")),
            (None, None) => Err(Invalid::missing(
                self.path(FieldId::MassRatio),
                "give mass_ratio, or mass with a primary mass",
            )),
        }
    }

    pub(super) fn clearance(&self, displacement: R, units: UnitSystem) -> Result<R, Invalid> {
        let alternatives = [
            FieldId::RelativeClearance,
            FieldId::Clearance,
            FieldId::ClearanceMm,
            FieldId::Gap,
            FieldId::GapMm,
        ];
        self.at_most_one(&alternatives)?;
        if let Some(relative) = self.get(FieldId::RelativeClearance) {
            let displacement = self.get(FieldId::Reference).unwrap_or(displacement);
            if displacement == 0.0 {
                return Err(Invalid::new(
                    self.path(FieldId::RelativeClearance),
                    number(relative),
                    "it is a multiple of |start.displacement|, which is 0; use clearance instead",
                ));
            }
            return Ok(relative * displacement.abs());
        }
        let clearance = self.length(FieldId::Clearance, FieldId::ClearanceMm, units)?;
        let gap = self.length(FieldId::Gap, FieldId::GapMm, units)?;
        clearance.or(gap.map(|total| total * 0.5)).ok_or_else(|| {
            Invalid::missing(
                self.path(FieldId::Clearance),
                "give clearance (half of the play), gap (all of it) or relative_clearance",
            )
        })
    }

    fn duration(&self, omega: R, force: &Force<R>) -> Result<R, Invalid> {
        self.at_most_one(&[FieldId::Periods, FieldId::Duration, FieldId::Cycles])?;
        if let Some(cycles) = self.get(FieldId::Cycles) {
            return Ok(cycles * cycle(FieldId::Cycles, cycles, force)?);
        }
        let periods = self.get(FieldId::Periods).map(|n| n * R::TURN.value);
        periods.or_else(|| self.get(FieldId::Duration).map(|t| t * omega)).ok_or_else(|| {
            Invalid::missing("run.periods", "give periods, duration or, under force, cycles")
        })
    }

    fn window(&self, [begin, duration]: [R; 2], force: &Force<R>) -> Result<Window<R>, Invalid> {
        let from = match self.get(FieldId::Discard).filter(|cycles| *cycles > 0.0) {
            Some(cycles) => {
                let length = cycle(FieldId::Discard, cycles, force)?;
                if cycles * length >= duration {
                    let all = number(duration / length);
                    let rule = format!("the run has {all} cycles; leave some of them");
                    return Err(Invalid::new(FieldId::Discard.path(), number(cycles), rule));
                }
                begin + cycles * length
            }
            None => begin,
        };
        Ok(Window { from, cycle: force.first_harmonic().copied() })
    }

    /// A ratio computed from a given field, if it is in its own range.
    fn derived(&self, given: FieldId, value: R, ratio: FieldId, derived: R) -> Result<R, Invalid> {
        if ratio.info().allowed.contains(derived) {
            return Ok(derived);
        }
        let (name, words) = (ratio.info().name, ratio.info().allowed.words());
        let rule = format!("it makes {name} {}; that must be {words}", number(derived));
        Err(Invalid::new(self.path(given), number(value), rule))
    }

    pub(super) fn needs_mass(&self, field: FieldId, value: R, alternative: &str) -> Invalid {
        Invalid::new(
            self.path(field),
            number(value),
            format!("give primary.mass with stiffness or natural_frequency as well, {alternative}"),
        )
    }

    pub(crate) fn length(
        &self,
        plain: FieldId,
        millimetres: FieldId,
        units: UnitSystem,
    ) -> Result<Option<R>, Invalid> {
        self.at_most_one(&[plain, millimetres])?;
        match self.get(millimetres) {
            Some(mm) if units != UnitSystem::Si => Err(Invalid::new(
                self.path(millimetres),
                number(mm),
                format!(
                    "millimetres need SI units (a primary mass with stiffness or frequency); else write {}",
                    plain.info().name
                ),
            )),
            Some(mm) => Ok(Some(mm / 1000.0)),
            None => Ok(self.get(plain)),
        }
    }
}

/// Length of a cycle of the harmonic force, in 1/ωn; `field` is given in such cycles.
fn cycle<R: Real>(field: FieldId, value: R, force: &Force<R>) -> Result<R, Invalid> {
    let harmonic = force.first_harmonic().ok_or_else(|| {
        let rule = "it counts cycles of a harmonic force, and there is none";
        Invalid::new(field.path(), number(value), rule)
    })?;
    Ok(R::TURN.value / harmonic.frequency)
}
