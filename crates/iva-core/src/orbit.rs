//! State → state: whole cycles of a drive, from any state at any phase.
//!
//! Periodic orbits, their multipliers, basins, diagrams and exponents are all made of one map ([`map`]): from the
//! state at one phase of the drive to the state one or more cycles later. Each cycle begins on the same clock, so
//! that equal states at its begin have equal states at its end, to the bit. No table is made and nothing is measured
//! but the number of impacts. The derivative of the map ([`Derived`]) is the monodromy matrix of a periodic orbit.
//!
//! [`periodic::find`] finds a periodic orbit near a trajectory, [`multipliers`] are the eigenvalues of its monodromy matrix,
//! with errors and an exact identity in [`spectrum`]; [`polish`] finds it to twice the precision; [`description`] has the events and extremes of one cycle of it, and
//! [`symmetry`] chooses between the map and the half map.
//! [`branch::follow`] follows an orbit over a number of its scene and locates the special points ([`conditions`]) on the way,
//! [`branch::switch`] goes from such a point to the branch that begins there, [`curve::curve`] follows the point over two numbers.
//! [`iterate`] goes on from image to image for many trajectories, those of free masses under one harmonic force and those
//! of pendulums side by side in lanes ([`crate::run::side_by_side`]), with the bits of [`map`] in the exact tier.
//!
//! [`lyapunov`] has the exponents along trajectories, [`diagram`] follows steady states from one value of a parameter to the next,
//! [`attractors`] finds what many starts end in, [`basins`] which start ends where: there a trajectory is decided once
//! it is in the [`neighbourhood`] of an orbit; [`basin_entropy`] tells how uncertain that is.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use nalgebra::DMatrix;

use crate::absorber::modal::Modal;
use crate::absorber::piva::Piva;
use crate::absorber::plain::{BASE, FORCE};
use crate::absorber::siva::Siva;
use crate::absorber::{Absorber, Clock, OnStructure};
use crate::engine::simulate::{Instant, Limits, Outcome, Run, Tally};
use crate::error::{Invalid, number};
use crate::force::Force;
use crate::host::{DrivenHost, Excitation};
use crate::measures::propagation::Derivative;
use crate::range;
use crate::run::free_mass::{ExactDriven, FastDriven, FreeMasses};
use crate::run::piva::{Pushed, Still};
use crate::run::side_by_side::{LANES, SideBySide, Tier, WIDE, with_steps};

pub mod attractors;
pub mod basin_entropy;
pub mod basins;
pub mod branch;
pub mod chain;
pub mod conditions;
mod continuation;
mod coordinates;
pub mod curve;
pub mod description;
pub mod diagram;
mod episode;
mod family;
mod in_lanes;
pub mod lyapunov;
mod margins;
pub mod multipliers;
pub mod neighbourhood;
pub mod periodic;
pub mod polish;
mod rounding;
pub mod sequence;
pub mod spectrum;
pub mod symmetry;

pub use coordinates::{Coordinates, Numbered, Strobe};
pub use family::Scenes;

/// The stretch of time that a map covers, in 1/ωn: whole cycles of the drive, from one of its phases on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// The instant at which it begins, on the clock of the drive.
    pub begin: f64,
    /// Its length.
    pub length: f64,
}

/// The image of a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<State> {
    /// The state at the end of the cycle, with the drive set back to the begin of the cycle.
    pub state: State,
    /// Number of impacts in the cycle that are listed ([`Limits::chatter_floor`]).
    pub impacts: u64,
    /// Number of rides in it: stick episodes, with that which it begins in.
    pub rides: u64,
    /// How the cycle has ended; unless it is [`Outcome::Finished`], the state is that where it ended.
    pub outcome: Outcome,
    /// The derivative of its state, if it was asked for.
    pub tangent: Option<Derived>,
}

/// The derivative of the state at the end of a cycle with respect to that at the begin.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// In all numbers of a state ([`Coordinates::point`]).
    pub matrix: DMatrix<f64>,
    /// Its determinant, of the same sign and more exact than that computed from it, where that is known; 0 with a ride.
    pub volume: Option<f64>,
    /// How many of the numbers were lost at one instant, at the most ([`Derivative::lost`]).
    pub lost: usize,
}

/// A trajectory: the state that it begins with, and the cycle that is repeated.
#[derive(Debug, Clone)]
pub struct Trajectory<S: Absorber> {
    /// The absorber on its structure.
    pub system: S,
    /// The state at the begin of the first cycle, with the drive of that instant.
    pub state: S::State,
    /// The cycle.
    pub cycle: Cycle,
    /// The accuracy tier: [`Tier::Fast`] counts for free masses in lanes only.
    pub tier: Tier,
}

impl<S: Absorber<Real = f64>> Trajectory<S> {
    /// A trajectory from a start at the begin of a cycle.
    ///
    /// # Errors
    /// [`Invalid`] if the start does not lie in the gap.
    pub fn new(system: S, start: &S::Start, cycle: Cycle) -> Result<Self, Invalid> {
        system.check_start(start)?;
        let state = system.begin_at(start, Clock::new(cycle.begin));
        Ok(Self { system, state, cycle, tier: Tier::Exact })
    }

    /// The same trajectory from another state.
    #[must_use]
    pub fn from(&self, state: &S::State) -> Self
    where
        S: Clone,
    {
        let state = self.system.with_drive_of(state, &self.state);
        Self { state, ..self.clone() }
    }

    /// The end of a cycle, with the default limits on impacts and work.
    fn limits(&self) -> Result<Limits, Invalid> {
        let Cycle { begin, length } = self.cycle;
        range::size("cycle.begin", begin)?;
        range::positive("cycle.length", length)?;
        if begin < 0.0 || begin + length <= begin {
            let rule =
                "give a number from 0 on, to which the length of the cycle makes a difference";
            return Err(Invalid::new("cycle.begin", number(begin), rule));
        }
        let limits = Limits::new(begin + length, self.system.clearance());
        limits.check()?;
        Ok(limits)
    }
}

/// The run of one cycle.
type Turn<'a, S> = Run<'a, S, Option<<S as Coordinates>::Derivative>>;

/// A cycle from a state, begun.
fn begun<'a, S: Coordinates>(
    trajectory: &'a Trajectory<S>,
    state: &S::State,
    limits: &'a Limits,
    (tangents, cancel): (bool, Option<&'a AtomicBool>),
) -> Turn<'a, S> {
    let system = &trajectory.system;
    let time = Clock::new(trajectory.cycle.begin);
    let from = Instant { time, state: system.with_drive_of(state, &trajectory.state) };
    let mut run = Run::new(system, &from, limits, cancel, tangents.then(S::Derivative::default));
    run.begin();
    run
}

/// The derivative at the end of a cycle with so many rides, if it is computed.
fn derivative<S: Coordinates>(run: &mut Turn<'_, S>, rides: u64) -> Option<Derived> {
    let seen = run.observer.as_mut()?;
    let (volume, lost) = (seen.volume(), seen.lost(rides));
    Some(Derived { matrix: seen.factor(run.system), volume, lost })
}

/// The image at the end of a cycle, with the drive of a state at its begin.
fn image<S: Coordinates>(run: &mut Turn<'_, S>, begin: &S::State) -> Image<S::State> {
    let tally = run.finish();
    let state = run.system.with_drive_of(&tally.state, begin);
    let Tally { impacts, episodes: rides, outcome, .. } = tally;
    let tangent = derivative(run, rides);
    Image { state, impacts, rides, outcome, tangent }
}

/// The image of the first state of a trajectory, with the derivative of the map or without.
///
/// # Errors
/// [`Invalid`] if the cycle has no length, or begins before time zero.
pub fn map<S: Coordinates>(
    trajectory: &Trajectory<S>,
    tangents: bool,
    cancel: Option<&AtomicBool>,
) -> Result<Image<S::State>, Invalid> {
    let limits = trajectory.limits()?;
    let mut run = begun(trajectory, &trajectory.state, &limits, (tangents, cancel));
    while run.step() {}
    Ok(image(&mut run, &trajectory.state))
}

/// The receiver of images: the index of a trajectory, and its next image. Where it breaks, that trajectory ends.
pub type See<'a, S> =
    &'a mut dyn FnMut(usize, &Image<<S as OnStructure>::State>) -> ControlFlow<()>;

/// What is computed of trajectories.
#[derive(Debug, Clone, Copy, Default)]
pub struct Request<'a> {
    /// True if the derivatives are wanted.
    pub tangents: bool,
    /// A flag that ends all of them.
    pub cancel: Option<&'a AtomicBool>,
}

/// An absorber whose trajectories may go side by side.
pub trait Iterated: SideBySide + Coordinates {
    /// Goes on with those of a group, which fit together; by default one after the other. The limits are those of one
    /// cycle of each trajectory.
    fn iterate_group(
        (trajectories, limits): (&[Trajectory<Self>], &[Limits]),
        group: &[usize],
        request: Request<'_>,
        see: See<'_, Self>,
    ) {
        for index in group {
            one_by_one((&trajectories[*index], &limits[*index]), *index, request, see);
        }
    }

    /// Trajectories with equal keys fit together; `None`: it goes by itself.
    fn key(_trajectory: &Trajectory<Self>, _request: &Request<'_>) -> Option<[u64; 2]> {
        None
    }
}

/// Goes on from image to image until `see` breaks or a cycle does not end.
fn one_by_one<S: Iterated>(
    (trajectory, limits): (&Trajectory<S>, &Limits),
    index: usize,
    Request { tangents, cancel }: Request<'_>,
    see: See<'_, S>,
) {
    let mut state = trajectory.state;
    loop {
        let mut run = begun(trajectory, &state, limits, (tangents, cancel));
        while run.step() {}
        let image = image(&mut run, &trajectory.state);
        let ends = image.outcome == Outcome::Cancelled
            || see(index, &image).is_break()
            || image.outcome != Outcome::Finished;
        if ends {
            return;
        }
        state = image.state;
    }
}

/// Goes on from image to image for many trajectories; those that fit together go side by side. Each ends where `see`
/// breaks, or at an image whose outcome is not [`Outcome::Finished`]. Once cancelled, all end soon.
///
/// # Errors
/// [`Invalid`] if a cycle has no length or begins before time zero, before anything runs.
pub fn iterate<S: Iterated>(
    trajectories: &[Trajectory<S>],
    request: Request<'_>,
    see: See<'_, S>,
) -> Result<(), Invalid> {
    let limits: Result<Vec<_>, _> = trajectories.iter().map(Trajectory::limits).collect();
    let limits = limits?;
    let key = |index: &usize| S::key(&trajectories[*index], &request);
    let mut order: Vec<usize> = (0..trajectories.len()).collect();
    order.sort_by_key(key);
    for group in order.chunk_by(|a, b| key(a) == key(b)) {
        // One alone is faster without lanes; in the exact tier the bits are the same.
        let alone = group.len() == 1 && trajectories[group[0]].tier == Tier::Exact;
        if key(&group[0]).is_some() && !alone {
            S::iterate_group((trajectories, &limits), group, request, see);
        } else {
            for index in group {
                one_by_one((&trajectories[*index], &limits[*index]), *index, request, see);
            }
        }
    }
    Ok(())
}

impl Iterated for Siva {}

impl<const N: usize, const M: usize> Iterated for Modal<DrivenHost, N, M> {}

impl Iterated for Siva<DrivenHost> {
    fn key(trajectory: &Trajectory<Self>, _request: &Request<'_>) -> Option<[u64; 2]> {
        let Trajectory { system, tier, .. } = trajectory;
        let force = system.force()?;
        let level = system.gravity() == 0.0 && !system.varies();
        let fast = u64::from(*tier == Tier::Fast);
        (level && force.is_single()).then(|| [fast, u64::from(force.moves_base())])
    }

    fn iterate_group(
        all: (&[Trajectory<Self>], &[Limits]),
        group: &[usize],
        request: Request<'_>,
        see: See<'_, Self>,
    ) {
        let Trajectory { system, tier, .. } = &all.0[group[0]];
        let go_on = match (tier, system.excitation().moves_base()) {
            (Tier::Fast, true) => in_lanes::iterate::<_, FreeMasses<FastDriven<BASE, WIDE>, WIDE>>,
            (Tier::Fast, false) => {
                in_lanes::iterate::<_, FreeMasses<FastDriven<FORCE, WIDE>, WIDE>>
            }
            (Tier::Exact, true) => {
                in_lanes::iterate::<_, FreeMasses<ExactDriven<true, false, LANES>, LANES>>
            }
            (Tier::Exact, false) => {
                in_lanes::iterate::<_, FreeMasses<ExactDriven<false, false, LANES>, LANES>>
            }
        };
        go_on(all, group, request, see);
    }
}

impl Iterated for Piva<DrivenHost> {
    fn key(trajectory: &Trajectory<Self>, request: &Request<'_>) -> Option<[u64; 2]> {
        let Piva { pendulum, accuracy, .. } = &trajectory.system;
        let force = trajectory.system.force();
        let still = force.is_none_or(Force::is_none);
        let fits = still || force.is_some_and(Force::is_single);
        let key = 2 * pendulum.equations() as u64 + u64::from(still);
        // Lanes compute no derivatives.
        (fits && !request.tangents).then_some([accuracy.tolerance.to_bits(), key])
    }

    fn iterate_group(
        all: (&[Trajectory<Self>], &[Limits]),
        group: &[usize],
        request: Request<'_>,
        see: See<'_, Self>,
    ) {
        let leader = &all.0[group[0]].system;
        if leader.excitation().is_driven() {
            with_steps!(leader, Pushed, L => in_lanes::iterate::<_, L>(all, group, request, see));
        } else {
            with_steps!(leader, Still, L => in_lanes::iterate::<_, L>(all, group, request, see));
        }
    }
}
