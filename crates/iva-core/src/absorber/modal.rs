//! Free masses and pendulums on a structure with several modes, each in a gap of its own at a point of the structure.
//!
//! ```text
//! q̈ⱼ + Σᵢ Dⱼᵢ q̇ᵢ + ωⱼ² qⱼ = Σₚ φⱼ(p) fₚ(t) − Γⱼ a_g + Σₖ φⱼ(pₖ) (kₖ yₖ + cₖ ẏₖ + μₖ Gₖ),
//! u_p = Σ φⱼ(p) qⱼ,     yₖ = x₁ₖ − u at pₖ,     ẍ₁ₖ = −a_g − Gₖ − (kₖ yₖ + cₖ ẏₖ)/μₖ.
//! ```
//!
//! | symbol | name | here |
//! |---|---|---|
//! | ωⱼ, ζⱼ; D | modes; D = diag(2ζⱼωⱼ), or any full matrix that feeds no energy | [`ModalStructure`] |
//! | φⱼ(p) | mass-normalised shape of mode j at a named point p | [`ModalStructure::with_point`] |
//! | Γⱼ | how the base motion a_g takes part in mode j | [`ModalStructure::with_base`] |
//! | M, K, C | matrices that the modes are computed from | [`ModalStructure::from_matrices`] |
//! | μₖ, eₖ, dₖ | a free mass, and the point where it rides | [`FreeMass`], [`Modal::new`] |
//! | kₖ, cₖ | spring and dashpot between mass and point | [`Tie`], [`Modal::with_ties`] |
//! | Gₖ | gravity along the line of motion, which rises towards wall + | [`Modal::with_gravity`] |
//! | y = u | a stop on the ground at a point | [`FreeMass::on_ground`], `modal/ground.rs` |
//! | y = b sinθ | a pendulum at a point | [`Modal::with_pendulums`], `modal/pendulum.rs` |
//! | α | a line that rises, on which the pivot of a pendulum moves | [`Modal::with_rising_pivots`] |
//! | x₁ₖ | a mass that is a point itself, for forces, stops and other masses | [`ModalStructure::with_body`], [`Modal::with_bodies`] |
//! | Rₖ, Rₛₖ | deceleration of a slide by friction: G + s R in place of G, s the sign of ẏ; the largest at rest | [`Modal::with_friction`], [`Modal::with_static_friction`] |
//!
//! Natural units: the unit of time is 1/ω of a mode of reference, and the unit of mass one of reference; so a shape has
//! the unit 1. A structure that moves as one has one mode with ω = 1 and φ = 1 ([`ModalStructure::moving_as_one`]); its
//! motion is that of one oscillator (`modal/oscillation.rs`).
//!
//! **Gravity** acts like a drive that is 1 at all times (`modal/equations.rs`). Displacements are measured from where the structure rests under
//! the weight of all masses, so that each lifts its point by the constant μ G.
//!
//! **Stuck masses.** With the masses of a set S stuck to their points the structure has the mass matrix
//! M′ = I + Σ_S μ φφᵀ. Its inverse takes a system of as many equations as masses are stuck
//! (`modal/equations.rs`). Each stuck mass is released by itself, where A + G + k y/μ is 0, with the absolute acceleration A at its point.
//!
//! **Motion** (`modal/equations.rs`). Between events the equations are linear, so that the Taylor coefficients of all q
//! follow one from the other, whatever D and S are. The energy norm of (ωq, q̇) never grows without drive, and each
//! time derivative obeys the same equations: the n-th is bounded by Λⁿ, Λ = ‖D‖/2 + √(‖D‖²/4 + max ω²). A motion is
//! no longer than 1/Λ, so that the terms left out are below 1/21! = 2 · 10⁻²⁰ of the size of the motion. The
//! terms that matter to rounding are in double-double. A structure with very fast modes takes many short motions, but
//! where no wall is near (`modal/leaps.rs`).
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
//! Pendulums: `modal/pendulum.rs`; their series with those of the modes: `modal/swings.rs`; how long these hold: `modal/swinging.rs`. A structure that moves as one: `modal/oscillation.rs`. Impacts: `modal/impact_law.rs`. What drives the modes: `modal/drive.rs`. Friction: `modal/friction.rs`, and how slides end: `modal/slides.rs`. Springs and
//! dashpots in the gaps: `modal/ties.rs`. Flights far from all walls: `modal/leaps.rs`; rebounds that are very low: `modal/hops.rs`. One member by four numbers, for orbits: `modal/single.rs`. What both ends of a motion prove at once: `modal/sight.rs`.

use std::sync::{Arc, OnceLock};

use nalgebra::DMatrix;

use crate::absorber::Wall;
use crate::absorber::derivatives::masses::LinearStructure;
use crate::absorber::siva::FreeMass;
use crate::error::Invalid;
use crate::force::{Acts, Force};
use crate::host::{DrivenHost, Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::GapPoint;

pub use motion::ModalMotion;
pub use start::ModalStart;
pub use state::{ModalState, Modes, Place};
pub use structure::ModalStructure;
pub use ties::Tie;

use followed::Followed;
use pendulum::Hanging;
use propagator::Leaps;
use regime::Sets;
use ties::Tied;

mod absorber;
mod bounds;
mod columns;
mod drive;
mod equations;
mod flight;
mod followed;
mod forms;
mod friction;
mod ground;
mod hops;
pub mod impact_law;
mod leaps;
mod linear;
mod losses;
mod matrices;
mod motion;
mod on_structure;
mod oscillation;
mod pendulum;
mod point;
mod propagator;
mod regime;
mod series;
mod sight;
mod single;
mod slides;
mod start;
mod state;
mod structure;
mod swinging;
mod swings;
mod ties;

/// Largest number of absorbers.
pub const MOST: usize = 64;
/// Largest number of masses on a structure that moves as one whose motion is known in closed form: what it carries is kept for each set of them.
const MOST_OSCILLATING: usize = 8;
/// Largest number of modes.
pub const MOST_MODES: usize = 40;

/// Room for masses and for modes in systems of few.
pub const FEW: usize = 4;

/// Few masses on a structure of few modes: every step copies the whole state, which is a quarter of that of [`Modal`] as it stands.
pub type FewModes<H> = Modal<H, FEW, FEW>;

/// The name of the only point of a structure that moves as one.
pub const PRIMARY: &str = "primary";

/// Contacts closer to each other than this, in units of 2⁻⁵² of the unit of time, are one event.
pub(crate) const AT_ONCE_ULPS: f64 = 8.0;

/// The event loop takes the work of an impulse from the velocity of the point that it sees.
const KICKED: &str = "impulses act at the point that a run sees: let both be the same";

/// Free masses and pendulums on a structure with several modes: N of them and M modes at most, with masses that are tied among the modes.
#[derive(Debug, Clone)]
pub struct Modal<H: Host, const N: usize = MOST, const M: usize = MOST_MODES> {
    /// The structure as given.
    structure: Arc<ModalStructure<H::Real>>,
    /// The same, with masses that are coordinates of it.
    whole: Arc<ModalStructure<H::Real>>,
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
    /// φ·φ of the points of two masses, row by row: the velocity at one per impulse at the other.
    mobilities: Vec<DoubleDouble<H::Real>>,
    /// Of the masses that have a spring or a dashpot in their gap.
    tied: [Option<Tied<H::Real>>; N],
    /// Of the members that are pendulums; empty without any, for a system is moved often while it is built.
    pendulums: Vec<Option<Hanging<H::Real>>>,
    /// True if there are any.
    swings: bool,
    /// G along the line of motion of each mass.
    gravity: [H::Real; N],
    /// The same with the weight of what rides on a body, per mass of that.
    weights: [H::Real; N],
    /// The deceleration R of each mass that slides, by friction.
    friction: [H::Real; N],
    /// The largest deceleration Rₛ ≥ R that friction gives each mass at rest.
    static_friction: [H::Real; N],
    /// What sets of stuck or held masses need.
    sets: Sets<H::Real>,
    /// True if the structure moves as one oscillator, whose motion the host knows (`modal/oscillation.rs`).
    oscillates: bool,
    /// The oscillator with a set of stuck or held masses, made when the set first is.
    carrying: Vec<OnceLock<Box<H>>>,
    /// Longest motion, if the drive stays smooth.
    reach: H::Real,
    /// Made when the structure first leaps.
    leaps: OnceLock<Leaps<H::Real>>,
    /// What small differences obey, of systems of which it is the same in all states; made when a derivative is first asked for.
    differences: OnceLock<Box<LinearStructure>>,
    /// The derivative of all variables by the numbers of a state; made when it is first asked for.
    by_numbers: OnceLock<Box<(DMatrix<f64>, Vec<usize>)>>,
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
        Self::with_room(structure, masses)
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
        Self::with_room(structure, &masses)
    }
}

impl<R: Real, const N: usize, const M: usize> Modal<UndrivenHost<R>, N, M> {
    /// As [`Modal::of`], with room for N masses and M modes.
    ///
    /// # Errors
    /// As [`Modal::of`], and for more masses or modes than there is room for.
    pub fn with_room(
        structure: ModalStructure<R>,
        masses: &[(FreeMass<R>, &str)],
    ) -> Result<Self, Invalid> {
        let (count, most) = (masses.len(), MOST.min(N));
        if count > most || N == 0 {
            let rule = format!("give from 1 to {most} absorbers");
            return Err(Invalid::new("absorber", format!("a list of {count}"), rule));
        }
        if structure.count() > M {
            let given = format!("{} modes", structure.count());
            return Err(Invalid::new("structure.frequencies", given, format!("give {M} at most")));
        }
        let mut at = [0; N];
        for (k, (_, point)) in masses.iter().enumerate() {
            at[k] = structure.point(&format!("absorber.{k}.point"), point)?;
        }
        let damping_ratio = structure.damping_ratio(0).filter(|_| structure.moves_as_one());
        let total = masses.iter().fold(R::ZERO, |sum, (mass, _)| sum + mass.mass_ratio);
        let host = UndrivenHost::new(damping_ratio.unwrap_or(R::ZERO), total);
        let unused = FreeMass::new(R::ONE, R::ONE, R::ONE)?;
        let structure = Arc::new(structure);
        let modal = Self {
            whole: Arc::clone(&structure),
            structure: Arc::clone(&structure),
            masses: std::array::from_fn(|k| masses.get(k).map_or(unused, |(mass, _)| *mass)),
            at,
            count,
            seen: at[0],
            pushed: at[0],
            host,
            mobilities: vec![],
            tied: std::array::from_fn(|k| {
                let (mass, _) = masses.get(k)?;
                (mass.mass_ratio == 0.0).then(|| ties::Tied::on_ground(structure.shape(at[k])))
            }),
            pendulums: vec![],
            swings: false,
            gravity: [R::ZERO; N],
            weights: [R::ZERO; N],
            friction: [R::ZERO; N],
            static_friction: [R::ZERO; N],
            sets: Sets::new(),
            oscillates: false,
            carrying: vec![],
            reach: R::ZERO,
            leaps: OnceLock::new(),
            differences: OnceLock::new(),
            by_numbers: OnceLock::new(),
        };
        let modal = modal.completed();
        modal.check_stops().map(|()| modal)
    }

    /// The same masses with gravity G along the line of motion of each, which rises towards wall +.
    ///
    /// # Errors
    /// [`Invalid`] for a number out of [`crate::range`], and for numbers that are not as many as masses.
    pub fn with_gravity(mut self, gravity: &[R]) -> Result<Self, Invalid> {
        structure::same("absorber.gravity", gravity.len(), self.count())?;
        if gravity.iter().all(|it| *it == 0.0) && self.is_level() {
            return Ok(self);
        }
        for (k, (own, given)) in self.gravity.iter_mut().zip(gravity).enumerate() {
            range::size(&format!("absorber.{k}.gravity"), *given)?;
            *own = *given;
        }
        Ok(self.completed())
    }

    /// The same masses on the same structure under a force that acts at a named point, and where it says so at others, or on a base that it
    /// moves.
    ///
    /// # Errors
    /// [`Invalid`] for a point that the structure does not have, for impulses at another point than that which a run
    /// sees, whose work it would not know, and for a moving base of a structure that does not say how it takes part.
    pub fn under(
        &self,
        force: Force<R>,
        point: &str,
    ) -> Result<Modal<DrivenHost<R>, N, M>, Invalid> {
        let pushed = self.whole.point("force.point", point)?;
        force.elsewhere().iter().try_for_each(|(point, harmonic)| {
            let rule = "a harmonic part elsewhere acts at one of the points of the structure";
            let fits = *point < self.whole.points().count() && harmonic.acts == Acts::Primary;
            let wrong = || Invalid::new("force.elsewhere", point.to_string(), rule);
            if fits { Ok(()) } else { Err(wrong()) }
        })?;
        if force.kicks() > 0 && pushed != self.seen {
            return Err(Invalid::new("force.point", point, KICKED));
        }
        if force.moves_base() && self.whole.participation().is_none() {
            return Err(Invalid::missing(
                "structure.participation",
                "a moving base needs the participation of each mode",
            ));
        }
        let host = DrivenHost::new(self.host.damping_ratio(), self.total(), force, R::ZERO);
        let driven = Modal {
            structure: Arc::clone(&self.structure),
            whole: Arc::clone(&self.whole),
            masses: self.masses,
            at: self.at,
            count: self.count,
            seen: self.seen,
            pushed,
            host,
            mobilities: vec![],
            tied: self.tied.clone(),
            pendulums: self.pendulums.clone(),
            swings: self.swings,
            gravity: self.gravity,
            weights: self.weights,
            friction: self.friction,
            static_friction: self.static_friction,
            sets: Sets::new(),
            oscillates: false,
            carrying: vec![],
            reach: R::ZERO,
            leaps: OnceLock::new(),
            differences: OnceLock::new(),
            by_numbers: OnceLock::new(),
        };
        Ok(driven.completed())
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// Number of masses.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// True if there are pendulums.
    #[inline(always)]
    fn swings(&self) -> bool {
        self.swings
    }

    /// True if the structure moves as one oscillator, and nothing ties a mass to it.
    #[inline(always)]
    fn oscillates(&self) -> bool {
        self.oscillates
    }

    /// The system with what follows from its parts.
    fn completed(mut self) -> Self {
        self.number_stops();
        self.weights = self.weighed();
        let all = 0..self.count();
        let of = |k: usize| all.clone().map(move |l| (k, l));
        let mobilities = all.clone().flat_map(of);
        let shape = |k: usize| self.gap_shape(k);
        self.mobilities = mobilities.map(|(k, l)| mobility(shape(k), shape(l))).collect();
        let drive = self.host.force().map_or(R::ZERO, Force::fastest);
        self.sets = Sets::new();
        self.swings = self.pendulums.iter().any(Option::is_some);
        let linear = self.tied.iter().all(Option::is_none) && !self.swings;
        let untied = linear && self.whole.moves_as_one();
        let alone = self.host.force().is_none_or(|force| force.elsewhere().is_empty());
        let few = self.count() <= MOST_OSCILLATING;
        self.oscillates = untied && alone && few && (self.is_level() || !self.host.moves_base());
        let sets = if self.oscillates { 1_usize << self.count() } else { 0 };
        self.carrying = (0..sets).map(|_| OnceLock::new()).collect();
        self.reach = R::from(equations::LONGEST * R::STEP) / self.whole.growth().max(drive);
        self.leaps = OnceLock::new();
        self.differences = OnceLock::new();
        self.by_numbers = OnceLock::new();
        self
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

    /// Shares the tables of another system whose structure moves as the same oscillator.
    pub fn share(&self, like: &Self) {
        // Without a lasting force there are tables for whole steps.
        let of = |it: &Self| {
            let lasts = it.host.force().is_some_and(Force::lasts);
            (it.oscillates(), it.host.damping_ratio(), lasts)
        };
        if self.oscillates() && of(self) == of(like) {
            self.host.share(&like.host);
        }
    }

    /// The structure as given.
    pub fn structure(&self) -> &ModalStructure<R> {
        &self.structure
    }

    /// What ties a mass to its point.
    pub fn tie(&self, mass: usize) -> Tie<R> {
        self.tied.get(mass).and_then(Option::as_ref).map_or(Tie::NONE, |tied| tied.tie)
    }

    /// The deceleration R of a mass that slides, by friction; 0 without such a mass.
    pub fn friction_of(&self, mass: usize) -> R {
        self.friction.get(mass).copied().unwrap_or(R::ZERO)
    }

    /// G along the line of motion of a mass; `None` without such a mass.
    pub fn gravity_of(&self, mass: usize) -> Option<R> {
        let own = self.gravity[..self.count()].get(mass).copied();
        own.filter(|_| self.hanging(mass).is_none())
    }

    /// The masses.
    pub fn masses(&self) -> &[FreeMass<R>] {
        &self.masses[..self.count()]
    }

    /// The index of an absorber; without any that of a place which no wall is near.
    fn index(&self, absorber: usize) -> usize {
        absorber.min(self.count().max(1) - 1)
    }

    /// Gap displacement and velocity of each absorber.
    pub fn gaps(&self, state: &ModalState<H, N, M>) -> Vec<GapPoint<R>> {
        self.each_gap(state).collect()
    }

    fn each_gap(&self, state: &ModalState<H, N, M>) -> impl Iterator<Item = GapPoint<R>> {
        self.masses().iter().zip(state.places).map(|(mass, place)| place.gap(mass))
    }

    /// The shape at the point of a mass.
    fn shape(&self, k: usize) -> &[R] {
        self.whole.shape(self.at[k])
    }

    /// The shape of the gap of a mass: that at its point, unless the mass is a coordinate of the structure.
    fn gap_shape(&self, k: usize) -> &[R] {
        self.tied[k].as_ref().map_or_else(|| self.shape(k), |tied| tied.shape.as_slice())
    }

    /// The mass at hand, and its place in its gap.
    fn at_hand_of(&self, state: &ModalState<H, N, M>) -> (usize, &FreeMass<R>, Place<R>) {
        let k = self.index(state.at_hand.into());
        (k, &self.masses[k], state.places[k])
    }

    /// φ·φ of the points of two masses.
    #[inline(always)]
    fn mobility(&self, k: usize, l: usize) -> DoubleDouble<R> {
        self.mobilities[k * self.count() + l]
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
