//! A list of free masses and pendulums on one structure.
//!
//! Lists of free masses alone are in [`crate::absorber::modal`]. A pendulum pulls at the structure while
//! it swings, so that with one in the list all move in one Taylor series ([`crate::segment::taylor`]), in which a free mass
//! is a pendulum at small angles without gravity. The truncation error of a step is bounded, and kept at full accuracy.
//!
//! * **Impacts at one instant** are resolved at once ([`impact_law`]), in no order. Contacts closer to each other than
//!   2⁻⁴⁹/ωn are one event.
//! * **A stuck absorber** is carried where an impact pushes its wall against it, and left behind where it pulls its wall
//!   away. It leaves its wall where the pressure on it has fallen to zero: a pendulum is also pulled off by gravity and its
//!   spring.
//! * **Chatter** is not summed, as no bound is known on how the others shake the structure during it: impacts are computed
//!   one by one, until the rest of the chatter is shorter than rounding of the clock.

use crate::absorber::modal::{AT_ONCE_ULPS, MOST};
use crate::absorber::piva::{self, Piva, PivaState, Stops};
use crate::absorber::siva::FreeMass;
use crate::absorber::{Absorber as _, Wall};
use crate::error::{Invalid, number};
use crate::force::Force;
use crate::host::{DrivenHost, Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::taylor::{Pendulum, Spring};

pub use motion::MixedFlight;
pub use start::{MixedStart, Posed};
pub use state::{MixedState, Placed};

mod absorber;
mod accuracy;
mod derivatives;
pub mod impact_law;
mod motion;
mod on_structure;
mod start;
mod state;

/// An absorber of a list.
#[derive(Debug, Clone)]
pub enum OneOf<R: Real = f64> {
    /// A free mass.
    Mass(FreeMass<R>),
    /// A pendulum; its structure is not used.
    Pendulum(Box<Piva<UndrivenHost<R>>>),
}

/// An absorber of a list, with the constants of its motion.
#[derive(Debug, Clone)]
pub(crate) struct Member<R: Real> {
    pub one: OneOf<R>,
    pub pendulum: Pendulum<R>,
    pub stops: Stops<R>,
    pub clearance: R,
    /// The middle of the gap, as a value of y.
    pub offset: R,
    /// How strongly gravity and the spring pull it off its wall.
    pull: R,
}

/// Free masses and pendulums on one structure, [`MOST`] at most.
#[derive(Debug, Clone)]
pub struct Mixed<H: Host> {
    pub(crate) members: Vec<Member<H::Real>>,
    pub(crate) host: H,
}

impl<R: Real> OneOf<R> {
    /// A pendulum.
    ///
    /// # Errors
    /// [`Invalid`] for one that cannot reach its stops, and for the impact law as the paper prints it.
    pub fn pendulum(piva: Piva<UndrivenHost<R>>) -> Result<Self, Invalid> {
        let piva::Parameters { clearance, contact_distance, impact_law, .. } = *piva.parameters();
        if impact_law == piva::ImpactLaw::Printed {
            let rule = "pendulums in a list have the consistent impact law";
            return Err(Invalid::new("absorber.impact_law", "\"printed\"", rule));
        }
        if !piva.stop_reachable() {
            let most = number(contact_distance);
            let rule = format!("a pendulum in a list must reach its stops: give less than {most}");
            return Err(Invalid::new("absorber.clearance", number(clearance), rule));
        }
        Ok(Self::Pendulum(Box::new(piva)))
    }
}

impl<R: Real> Member<R> {
    fn new(one: OneOf<R>) -> Self {
        match &one {
            OneOf::Mass(mass) => {
                let FreeMass { mass_ratio, clearance, offset, .. } = *mass;
                let pendulum = Pendulum {
                    mass_ratio,
                    damping_ratio: R::ZERO,
                    contact_distance: clearance,
                    inertia_ratio: R::ONE,
                    lever: R::ONE,
                    coupling: R::ONE,
                    frequency_squared: R::ZERO,
                    pivot_damping: R::ZERO,
                    spring: Spring::NONE,
                    small_angles: true,
                };
                let stops = Stops { cosine: DoubleDouble::new(R::ONE), steep: false };
                Self { one, pendulum, stops, clearance, offset, pull: R::ZERO }
            }
            OneOf::Pendulum(piva) => {
                let (pendulum, stops) = (piva.pendulum, piva.stops);
                let (clearance, pull) = (piva.clearance(), piva.pull().value);
                Self { one, pendulum, stops, clearance, offset: R::ZERO, pull }
            }
        }
    }

    /// e at a wall, of an impact with this approach speed.
    fn restitution(&self, wall: Wall, approach: R) -> R {
        match &self.one {
            OneOf::Mass(mass) => mass.law_for(R::from(wall.sign()), approach).restitution,
            OneOf::Pendulum(piva) => piva.restitution(wall),
        }
    }

    /// The pressure on a wall per unit mass is a factor of A, and a constant, as in [`crate::absorber::ride`].
    fn pressure(&self, wall: Wall) -> [R; 2] {
        [self.pendulum.coupling * self.stops.cosine.value * -wall.sign(), -self.pull]
    }
}

impl<R: Real> Mixed<UndrivenHost<R>> {
    /// A list on a structure of damping ratio ζ without drive.
    ///
    /// # Errors
    /// [`Invalid`] for a damping ratio out of [`crate::range`], for no absorber, and for more than [`MOST`].
    pub fn new(damping_ratio: R, absorbers: Vec<OneOf<R>>) -> Result<Self, Invalid> {
        let count = absorbers.len();
        if count == 0 || count > MOST {
            let rule = format!("give 1 to {MOST} absorbers");
            return Err(Invalid::new("absorber", format!("a list of {count}"), rule));
        }
        range::damping_ratio("primary.damping_ratio", damping_ratio)?;
        let members: Vec<Member<R>> = absorbers.into_iter().map(Member::new).collect();
        let host = UndrivenHost::new(damping_ratio, total(&members));
        Ok(Self { members, host })
    }

    /// The same list on the same structure under a force.
    pub fn under(&self, force: Force<R>) -> Mixed<DrivenHost<R>> {
        let members = self.members.clone();
        let host = DrivenHost::new(self.host.damping_ratio(), total(&members), force, R::ZERO);
        Mixed { members, host }
    }
}

/// The mass ratio of all together.
fn total<R: Real>(members: &[Member<R>]) -> R {
    members.iter().fold(R::ZERO, |sum, it| sum + it.pendulum.mass_ratio)
}

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// The pendulum of this index; `None` for a free mass.
    pub fn pendulum(&self, absorber: usize) -> Option<&Piva<UndrivenHost<R>>> {
        match &self.members.get(absorber)?.one {
            OneOf::Mass(_) => None,
            OneOf::Pendulum(piva) => Some(piva),
        }
    }

    /// The absorber at hand.
    fn at_hand(&self, state: &MixedState<H>) -> (usize, &Member<R>) {
        let k = usize::from(state.at_hand).min(self.members.len() - 1);
        (k, &self.members[k])
    }

    /// Each absorber, with its place in a state.
    fn each<'a>(
        &'a self,
        state: &'a MixedState<H>,
    ) -> impl Iterator<Item = (&'a Member<R>, &'a Placed<R>)> {
        self.members.iter().zip(&state.places)
    }

    /// The structure with the absorber of this index, as if it were the only one.
    fn seen(&self, state: &MixedState<H>, absorber: usize) -> PivaState<H::Phase, R> {
        let Placed { wall, distance, w, cosine, released, .. } = state.places[absorber];
        let clearance = self.members[absorber].clearance;
        let MixedState { phase, primary, .. } = *state;
        PivaState { phase, primary, wall, distance, clearance, w, cosine, released }
    }

    /// The mass ratio of those that are stuck to the structure.
    fn stuck_mass(&self, state: &MixedState<H>) -> R {
        let stuck = self.each(state).filter(|(_, place)| place.stuck);
        stuck.fold(R::ZERO, |sum, (member, _)| sum + member.pendulum.mass_ratio)
    }
}
