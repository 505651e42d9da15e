//! Free masses on a structure with several modes, each in a gap of its own at a point of the structure.
//!
//! ```text
//! q̈ⱼ + Σᵢ Dⱼᵢ q̇ᵢ + ωⱼ² qⱼ = φⱼ(p) f(t) − Γⱼ a_g,     u_p = Σ φⱼ(p) qⱼ,     yₖ = x₁ₖ − u at pₖ,     ẍ₁ₖ = −a_g.
//! ```
//!
//! | symbol | name | here |
//! |---|---|---|
//! | ωⱼ, ζⱼ; D | modes; D = diag(2ζⱼωⱼ), or any full matrix that feeds no energy | [`ModalStructure`] |
//! | φⱼ(p) | mass-normalised shape of mode j at a named point p | [`ModalStructure::with_point`] |
//! | Γⱼ | how the base motion a_g takes part in mode j | [`ModalStructure::with_base`] |
//! | M, K, C | matrices that the modes are computed from | [`ModalStructure::from_matrices`] |
//! | μₖ, eₖ, dₖ | a free mass, and the point where it rides | [`FreeMass`], [`Modal::new`] |
//!
//! Natural units: the unit of time is 1/ω of a mode of reference, and the unit of mass one of reference; so a shape has
//! the unit 1, and one mode with ω = 1 and φ = 1 is the structure of [`crate::absorber::several`].
//!
//! **Stuck masses.** With the masses of a set S stuck to their points the structure has the mass matrix
//! M′ = I + Σ_S μ φφᵀ. Its inverse takes a system of as many equations as masses are stuck
//! (`modal/equations.rs`). Each stuck mass is released by itself, where the absolute acceleration at its point is 0.
//!
//! **Motion** (`modal/equations.rs`). Between events the equations are linear, so that the Taylor coefficients of all q
//! follow one from the other, whatever D and S are. The energy norm of (ωq, q̇) never grows without drive, and each
//! time derivative obeys the same equations: the n-th is bounded by Λⁿ, Λ = ‖D‖/2 + √(‖D‖²/4 + max ω²). A motion is
//! no longer than 1/Λ, so that the terms left out are below 1/21! = 2 · 10⁻²⁰ of the size of the motion. The
//! terms that matter to rounding are in double-double. A structure with very fast modes takes many short motions, but
//! where it is undriven and no wall is near.
//!
//! **Bounds** that the search for contacts needs are those of the energies of derivatives: for separate modes
//! Σ |φⱼ| √((qⱼ⁽ⁿ⁺¹⁾)² + ωⱼ²(qⱼ⁽ⁿ⁾)²) bounds the derivative n + 1 of u from an instant on; where modes exchange energy
//! it is |φ| times the root of the whole energy of the n-th derivative.
//!
//! **Chatter** is summed where no other mass is stuck or can meet a wall before its end ([`others_wait`](crate::absorber::Absorber::others_wait)), and
//! where it is so short that also the fastest mode does nothing to it that is not rounding. Elsewhere its impacts are
//! computed one by one.
//!
//! **What a run sees of the structure** is the motion at one point, by default that of the first mass
//! ([`Modal::seen_at`]). The energy is that of all modes and masses. An impact tells displacement and velocity of the
//! structure at the point of its mass.
//!
//! Impacts: `modal/impact_law.rs`. Dashpots in the gaps: `modal/dashpot.rs`. Flights far from all walls: `modal/leaps.rs`.

use std::sync::OnceLock;

use crate::absorber::Wall;
use crate::absorber::siva::FreeMass;
use crate::error::Invalid;
use crate::force::Force;
use crate::host::{DrivenHost, Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

pub use motion::ModalMotion;
pub use start::ModalStart;
pub use state::{ModalState, Modes, Place};
pub use structure::ModalStructure;

use dashpot::Dashpot;
use equations::Stuck;
use leaps::Leaps;

mod absorber;
mod dashpot;
mod equations;
pub mod impact_law;
mod leaps;
mod linear;
mod matrices;
mod motion;
mod on_structure;
mod series;
mod start;
mod state;
mod structure;

/// Largest number of absorbers.
pub const MOST: usize = 8;
/// Largest number of modes.
pub const MOST_MODES: usize = 40;

/// Contacts closer to each other than this, in units of 2⁻⁵² of the unit of time, are one event.
const AT_ONCE_ULPS: f64 = 8.0;

/// The event loop takes the work of an impulse from the velocity of the point that it sees.
const KICKED: &str = "impulses act at the point that a run sees: let both be the same";

/// Free masses on a structure with several modes, N at most.
#[derive(Debug, Clone)]
pub struct Modal<H: Host, const N: usize = MOST> {
    /// The structure as given.
    structure: ModalStructure<H::Real>,
    /// The same, with masses that are coordinates of it.
    whole: ModalStructure<H::Real>,
    /// Those in use first; the others mean nothing.
    masses: [FreeMass<H::Real>; N],
    /// The index of the point of each mass.
    at: [usize; N],
    count: usize,
    /// The point that a run sees, and that on which the force acts.
    seen: usize,
    pushed: usize,
    /// What drives the structure; its oscillator is not used.
    host: H,
    /// φ·φ of the points of two masses: the velocity at one per impulse at the other.
    mobility: [[DoubleDouble<H::Real>; N]; N],
    /// Of the masses that have a dashpot in their gap.
    dashpots: [Option<Dashpot<H::Real>>; N],
    /// What a set of stuck masses needs, made when the set first is.
    stuck: Vec<OnceLock<Stuck<H::Real>>>,
    /// Longest motion, if the drive stays smooth.
    reach: H::Real,
    /// Made when the structure first leaps.
    leaps: OnceLock<Leaps<H::Real>>,
}

impl<R: Real> Modal<UndrivenHost<R>> {
    /// A list of masses that ride at named points of a structure without drive. With an empty list it is the structure
    /// alone, of which a run sees the first point.
    ///
    /// # Errors
    /// [`Invalid`] for a point that the structure does not have, and for more than [`MOST`] masses.
    pub fn of(
        structure: ModalStructure<R>,
        masses: &[(FreeMass<R>, &str)],
    ) -> Result<Self, Invalid> {
        Self::with(structure, masses)
    }
}

impl<R: Real, const N: usize> Modal<UndrivenHost<R>, N> {
    /// N masses that ride at named points of a structure without drive.
    ///
    /// # Errors
    /// [`Invalid`] for a point that the structure does not have, and for more than [`MOST`] masses or none.
    pub fn new(
        structure: ModalStructure<R>,
        masses: [(FreeMass<R>, &str); N],
    ) -> Result<Self, Invalid> {
        Self::with(structure, &masses)
    }

    fn with(structure: ModalStructure<R>, masses: &[(FreeMass<R>, &str)]) -> Result<Self, Invalid> {
        let count = masses.len();
        if count > MOST || N == 0 {
            let rule = format!("give from 1 to {MOST} absorbers");
            return Err(Invalid::new("absorber", format!("a list of {count}"), rule));
        }
        let mut at = [0; N];
        for (k, (_, point)) in masses.iter().enumerate() {
            at[k] = structure.point(&format!("absorber.{k}.point"), point)?;
        }
        let host = UndrivenHost::new(R::ZERO, R::ZERO);
        let unused = FreeMass::new(R::ONE, R::ONE, R::ONE)?;
        let all = std::array::from_fn(|k| masses.get(k).map_or(unused, |(mass, _)| *mass));
        let none = std::array::from_fn(|_| None);
        Ok(Self::on(host, structure, (all, at, count), none, [at[0]; 2]))
    }

    /// The same masses on the same structure under a force that acts at a named point, or on a base that it moves.
    ///
    /// # Errors
    /// [`Invalid`] for a point that the structure does not have, for impulses at another point than that which a run
    /// sees, whose work it would not know, and for a moving base of a structure that does not say how it takes part.
    pub fn under(&self, force: Force<R>, point: &str) -> Result<Modal<DrivenHost<R>, N>, Invalid> {
        let pushed = self.whole.point("force.point", point)?;
        if force.kicks() > 0 && pushed != self.seen {
            return Err(Invalid::new("force.point", point, KICKED));
        }
        if force.moves_base() && self.whole.participation().is_none() {
            return Err(Invalid::missing(
                "structure.participation",
                "a moving base needs the participation of each mode",
            ));
        }
        let host = DrivenHost::new(R::ZERO, R::ZERO, force, R::ZERO);
        let of = (self.masses, self.at, self.count);
        let points = [self.seen, pushed];
        let on = Modal::on(host, self.whole.clone(), of, self.dashpots.clone(), points);
        Ok(Modal { structure: self.structure.clone(), ..on })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Modal<H, N> {
    fn on(
        host: H,
        whole: ModalStructure<R>,
        (masses, at, count): ([FreeMass<R>; N], [usize; N], usize),
        dashpots: [Option<Dashpot<R>>; N],
        [seen, pushed]: [usize; 2],
    ) -> Self {
        let shapes: [&[R]; N] = std::array::from_fn(|k| match &dashpots[k] {
            Some(dashpot) => dashpot.shape.as_slice(),
            None => whole.shape(at[k]),
        });
        let mobility = shapes.map(|k| shapes.map(|l| mobility(k, l)));
        let stuck = (0..1_usize << count).map(|_| OnceLock::new()).collect();
        let drive = host.force().map_or(R::ZERO, Force::fastest);
        let reach = R::from(equations::LONGEST * R::STEP) / whole.growth().max(drive);
        let structure = whole.clone();
        Self {
            structure,
            whole,
            masses,
            at,
            count,
            seen,
            pushed,
            host,
            mobility,
            dashpots,
            stuck,
            reach,
            leaps: OnceLock::new(),
        }
    }

    /// The same system, of which a run sees the motion at another named point.
    ///
    /// # Errors
    /// [`Invalid`] for a point that the structure does not have, and for one at which impulses do not act, if there are any.
    pub fn seen_at(mut self, point: &str) -> Result<Self, Invalid> {
        self.seen = self.whole.point("structure.seen_at", point)?;
        let kicked = self.host.force().is_some_and(|force| force.kicks() > 0);
        if kicked && self.pushed != self.seen {
            return Err(Invalid::new("structure.seen_at", point, KICKED));
        }
        Ok(self)
    }

    /// The structure as given.
    pub fn structure(&self) -> &ModalStructure<R> {
        &self.structure
    }

    /// True if a mass has a dashpot in its gap.
    pub fn has_dashpots(&self) -> bool {
        self.dashpots.iter().any(Option::is_some)
    }

    /// The masses.
    pub fn masses(&self) -> &[FreeMass<R>] {
        &self.masses[..self.count]
    }

    /// The index of an absorber; without any that of a place which no wall is near.
    fn index(&self, absorber: usize) -> usize {
        absorber.min(self.count.max(1) - 1)
    }

    /// Gap displacement and velocity of each absorber.
    pub fn gaps(&self, state: &ModalState<H, N>) -> Vec<GapPoint<R>> {
        self.each_gap(state).collect()
    }

    fn each_gap(&self, state: &ModalState<H, N>) -> impl Iterator<Item = GapPoint<R>> {
        self.masses().iter().zip(state.places).map(|(mass, place)| place.gap(mass))
    }

    /// The shape at the point of a mass.
    fn shape(&self, k: usize) -> &[R] {
        self.whole.shape(self.at[k])
    }

    /// The shape of the gap of a mass: that at its point, unless the mass is a coordinate of the structure.
    fn gap_shape(&self, k: usize) -> &[R] {
        self.dashpots[k].as_ref().map_or_else(|| self.shape(k), |dashpot| dashpot.shape.as_slice())
    }

    /// The shape of which the curve of a mass is made, and whether the acceleration of the base is part of it: that of the gap
    /// in flight, that of the point which has to carry the mass while it is stuck.
    fn followed(&self, k: usize, stuck: bool) -> (&[R], bool) {
        if stuck { (self.shape(k), true) } else { (self.gap_shape(k), self.dashpots[k].is_none()) }
    }

    /// The mass at hand, and its place in its gap.
    fn at_hand_of(&self, state: &ModalState<H, N>) -> (usize, &FreeMass<R>, Place<R>) {
        let k = self.index(state.at_hand.into());
        (k, &self.masses[k], state.places[k])
    }

    /// What the masses that are stuck in a state need.
    fn stuck_in(&self, places: &[Place<R>; N]) -> &Stuck<R> {
        let stuck = |k: &usize| places[*k].stuck;
        let set: usize = (0..self.count).filter(stuck).map(|k| 1 << k).sum();
        self.stuck[set].get_or_init(|| self.stuck_set((0..self.count).filter(stuck).collect()))
    }

    /// The mass ratio of all masses together.
    fn total(&self) -> R {
        self.masses().iter().fold(R::ZERO, |sum, mass| sum + mass.mass_ratio)
    }
}

/// φ·φ of two shapes.
fn mobility<R: Real>(one: &[R], other: &[R]) -> DoubleDouble<R> {
    let both = one.iter().zip(other);
    both.fold(DoubleDouble::ZERO, |sum, (a, b)| sum + DoubleDouble::new(*a).times(*b))
}

/// The wall with this sign.
fn wall_of<R: Real>(side: R) -> Wall {
    if side > 0.0 { Wall::Plus } else { Wall::Minus }
}
