//! Which runs of each absorber go side by side, and in which lanes.

use std::sync::atomic::AtomicBool;

use super::decays::Decays;
use super::forced::ForcedRuns;
use super::free_mass::{ExactDecays, ExactDriven, FastDecays, FastDriven};
use super::group::{Group, grouped};
use super::{Job, LANES, Listing, SideBySide, TakeListed, Tier, WIDE};
use crate::absorber::alone::Alone;
use crate::absorber::piva::Piva;
use crate::absorber::plain::{BASE, FORCE};
use crate::absorber::siva::Siva;
use crate::absorber::system::System;
use crate::error::Invalid;
use crate::host::{DrivenHost, UndrivenHost};
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
    ($piva:expr, $lanes:ident => $body:expr) => {{
        use $crate::lanes::piva::Steps;
        use $crate::segment::taylor::{ORDER, with_order};
        let piva: &$crate::absorber::piva::Piva = $piva;
        let (order, driven) = (piva.accuracy.order, !piva.force().is_none());
        // At small angles the order is always the highest.
        match (driven, piva.pendulum.small_angles) {
            (false, false) => with_order!(order, N => {
                type $lanes = Steps<N, false, false>;
                $body
            }),
            (true, false) => with_order!(order, N => {
                type $lanes = Steps<N, true, false>;
                $body
            }),
            (false, true) => {
                type $lanes = Steps<ORDER, false, true>;
                $body
            }
            (true, true) => {
                type $lanes = Steps<ORDER, true, true>;
                $body
            }
        }
    }};
}
pub(crate) use with_steps;

/// True if a run is a free decay that lanes can make: they compute no measures but log the motion.
fn decays(job: &Job<Siva>) -> bool {
    job.system.sinusoidal().is_some() && job.steady.is_none()
}

impl SideBySide for Siva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let tier = if Self::tier(job) == Tier::Fast { 1.0 } else { 0.0 };
        decays(job).then(|| [job.system.damping_ratio(), tier])
    }

    fn tier(job: &Job<Self>) -> Tier {
        if decays(job) { job.tier } else { Tier::Exact }
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        match group.tier() {
            Tier::Fast => group.run::<Decays<FastDecays, WIDE>>(),
            Tier::Exact => group.run::<Decays<ExactDecays, WIDE>>(),
        }
    }
}

impl SideBySide for Alone<UndrivenHost> {
    run_jobs!();
}

impl SideBySide for Alone<DrivenHost> {
    run_jobs!();
}

impl SideBySide for Siva<DrivenHost> {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let force = job.system.force()?;
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let base = if force.moves_base() { 1.0 } else { 0.0 };
        let tier = if job.tier == Tier::Fast { 2.0 } else { 0.0 };
        let level = job.system.gravity() == 0.0;
        (level && force.is_single()).then(|| [f64::from(wanted.bits()), base + tier])
    }

    fn shared(job: &Job<Self>) -> f64 {
        let harmonic = job.system.force().and_then(|force| force.harmonics().first());
        harmonic.map_or(0.0, |harmonic| harmonic.frequency)
    }

    fn tier(job: &Job<Self>) -> Tier {
        if Self::common(job).is_some() { job.tier } else { Tier::Exact }
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        if group.tier() == Tier::Fast {
            if group.leader().moves_base() {
                group.run::<ForcedRuns<FastDriven<BASE, WIDE>, WIDE>>();
            } else {
                group.run::<ForcedRuns<FastDriven<FORCE, WIDE>, WIDE>>();
            }
        } else if group.leader().moves_base() {
            group.run::<ForcedRuns<ExactDriven<true, LANES>, LANES>>();
        } else {
            group.run::<ForcedRuns<ExactDriven<false, LANES>, LANES>>();
        }
    }
}

impl SideBySide for Piva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let (Piva { pendulum, accuracy, .. }, force) = (&job.system, job.system.force());
        let damped = if pendulum.pivot_damping == 0.0 { 0.0 } else { 1.0 };
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let driven = if force.is_none() { 0.0 } else { 2.0 + 2.0 * f64::from(wanted.bits()) };
        // Lanes record no strobes.
        let fits = match force.is_none() {
            true => job.steady.is_none(),
            false => force.is_single() && !wanted.strobes,
        };
        let small = if pendulum.small_angles { 1000.0 } else { 0.0 };
        fits.then_some([accuracy.tolerance, small + driven + damped])
    }

    fn tier(job: &Job<Self>) -> Tier {
        job.tier
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        with_steps!(group.leader(), L => group.run::<L>());
    }
}
