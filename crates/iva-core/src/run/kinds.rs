//! Which runs of each absorber go side by side, and in which lanes.

use std::sync::atomic::AtomicBool;

use super::decays::Decays;
use super::forced::ForcedRuns;
use super::free_mass::{ExactDecays, ExactDriven, ExactUnforced, FastDriven};
use super::group::{Group, grouped};
use super::piva::{Pushed, Still};
use super::side_by_side::{Job, LANES, Listing, Logged, SideBySide, TakeListed, Tier, WIDE};
use crate::absorber::OnStructure;
use crate::absorber::modal::Modal;
use crate::absorber::piva::Piva;
use crate::absorber::plain::{BASE, FORCE};
use crate::absorber::siva::Siva;
use crate::error::Invalid;
use crate::force::Force;
use crate::host::{DrivenHost, Excitation};
use crate::measures::Wanted;
use crate::measures::steady::SteadyWanted;

/// [`SideBySide::run_jobs`] compiled in this crate.
macro_rules! run_jobs {
    () => {
        fn run_jobs(
            jobs: &[Job<Self>],
            wanted: (Wanted, &Listing),
            cancel: Option<&AtomicBool>,
            take: TakeListed<'_, Self>,
        ) -> Result<(), Invalid> {
            grouped(jobs, wanted, cancel, take)
        }
    };
}

/// Runs code with the kind of lanes for pendulums like this one.
macro_rules! with_steps {
    ($piva:expr, $drive:ty, $lanes:ident => $body:expr) => {{
        use $crate::run::piva::Steps;
        use $crate::segment::taylor::{Equations, ORDER, with_order};
        let piva: &$crate::absorber::piva::Piva<$crate::host::DrivenHost> = $piva;
        match piva.pendulum.equations() {
            Equations::Large => with_order!(piva.accuracy.order, N => {
                type $lanes = Steps<$drive, N, false, false>;
                $body
            }),
            // The order of the others is always the highest.
            Equations::Small => {
                type $lanes = Steps<$drive, ORDER, true, false>;
                $body
            }
            Equations::Sprung => {
                type $lanes = Steps<$drive, ORDER, false, true>;
                $body
            }
        }
    }};
}
pub(crate) use with_steps;

/// True if a run is a free decay that lanes can make: they compute no measures but log the motion.
fn decays<S: SideBySide>(job: &Job<S>) -> bool {
    job.system.sinusoidal().is_some() && job.steady.is_none()
}

/// True if gravity acts along the motion.
fn leans(siva: &Siva<DrivenHost>) -> bool {
    siva.gravity() != 0.0
}

/// Part of the key of runs of a structure that could be driven: of decays on a level line, beside their damping ratio;
/// and on an inclined line of decays, and of runs under a harmonic force, on the structure or its base.
const LEVEL: f64 = 4.0;
const INCLINED: f64 = 5.0;
const FORCED: f64 = 6.0;

impl SideBySide for Siva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let fits = decays(job) && !job.system.varies();
        fits.then(|| [job.system.damping_ratio(), 0.0])
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        group.run::<Decays<ExactDecays, WIDE>>();
    }
}

impl<const N: usize, const M: usize> SideBySide for Modal<DrivenHost, N, M> {}

impl SideBySide for Siva<DrivenHost> {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        // Lanes read a constant restitution.
        let force = job.system.force().filter(|_| !job.system.varies())?;
        if !force.lasts() {
            let line = if leans(&job.system) { INCLINED } else { LEVEL };
            return decays(job).then(|| [job.system.damping_ratio(), line]);
        }
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let base = if force.moves_base() { 1.0 } else { 0.0 };
        let tier = if Self::tier(job) == Tier::Fast { 2.0 } else { 0.0 };
        let inclined = if leans(&job.system) { FORCED } else { 0.0 };
        force.is_single().then(|| [f64::from(wanted.bits()), base + tier + inclined])
    }

    fn shared(job: &Job<Self>) -> f64 {
        let harmonic = job.system.force().and_then(|force| force.harmonics().first());
        harmonic.map_or(0.0, |harmonic| harmonic.frequency)
    }

    fn tier(job: &Job<Self>) -> Tier {
        let single = job.system.force().is_some_and(Force::is_single);
        let fits = single && !leans(&job.system) && !job.system.varies();
        if fits { job.tier } else { Tier::Exact }
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        let moves_base = group.leader().excitation().moves_base();
        let driven = group.leader().excitation().is_driven();
        let leans = leans(group.leader());
        if leans && driven && group.is_watched() {
            // Who sees flights would have them computed twice.
            group.one_by_one();
        } else if leans && driven && moves_base {
            group.run::<Logged<ExactDriven<true, true, LANES>, LANES>>();
        } else if leans && driven {
            group.run::<Logged<ExactDriven<false, true, LANES>, LANES>>();
        } else if leans {
            group.run::<Decays<ExactUnforced<true, LANES>, LANES>>();
        } else if !driven {
            group.run::<Decays<ExactUnforced<false, LANES>, LANES>>();
        } else if group.tier() == Tier::Fast {
            if moves_base {
                group.run::<ForcedRuns<FastDriven<BASE, WIDE>, WIDE>>();
            } else {
                group.run::<ForcedRuns<FastDriven<FORCE, WIDE>, WIDE>>();
            }
        } else if moves_base {
            group.run::<ForcedRuns<ExactDriven<true, false, LANES>, LANES>>();
        } else {
            group.run::<ForcedRuns<ExactDriven<false, false, LANES>, LANES>>();
        }
    }
}

/// Part of the key of pendulums that something drives.
const PUSHED: f64 = 500.0;

impl SideBySide for Piva<DrivenHost> {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let still = job.system.force().is_none_or(Force::is_none);
        let single = job.system.force().is_some_and(Force::is_single);
        // Lanes record no strobes, and without force no steady state.
        let fits = if still { job.steady.is_none() } else { single && !wanted.strobes };
        let Piva { pendulum, accuracy, .. } = &job.system;
        let damped = if pendulum.pivot_damping == 0.0 { 0.0 } else { 1.0 };
        let equations = 1000.0 * f64::from(pendulum.equations() as u8);
        let driven = if still { 0.0 } else { PUSHED };
        let kind = equations + driven + damped + 2.0 * f64::from(wanted.bits());
        fits.then_some([accuracy.tolerance, kind])
    }

    fn tier(job: &Job<Self>) -> Tier {
        job.tier
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        if group.leader().excitation().is_driven() {
            with_steps!(group.leader(), Pushed, L => group.run::<L>());
        } else {
            with_steps!(group.leader(), Still, L => group.run::<L>());
        }
    }
}
