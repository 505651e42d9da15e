//! Steps of pendulums, side by side, free or under one harmonic force; they have one tolerance, and large angles or small.
//!
//! A lane goes through steps of flight that meet no wall, or one in the simplest way; then it applies the impact. A
//! step about which nothing is decided is tried again in parts. Everything else (a hard search, a low rebound, a ride)
//! is for the event loop.
//!
//! Lanes take of each step what its series has at hand: turning points of x, losses, bounds. Of a decay they log the
//! stretches in which x is monotonic, from which its measures are computed. Of a driven run they add up losses
//! and ∫x², and show its measures the steps that may change more than that. Observers that look within flights are
//! shown every step.

mod drive;
mod lane;
mod round;
mod rows;
mod scene;
mod shown;

use super::side_by_side::{Cycling, Job, LANES, Listing, Loaded, Lockstep, ScalarRun, SideBySide};
use crate::absorber::impact::Impact;
use crate::absorber::piva::step::Turning;
use crate::absorber::piva::{Piva, PivaState, PivaStates};
use crate::absorber::{Absorber, Clock, Start};
use crate::engine::simulate::Run;
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Moment};
use crate::measures::forced::Forced;
use crate::measures::peaks::Monotone;
use crate::measures::propagation::Tangent;
use crate::measures::steady::SteadyWanted;
use crate::measures::{Stretch, Stretches, Wanted, looks};
use crate::number::arrays::{Lanes as _, any};
use crate::number::vectors::in_vectors;
use drive::{Laid, laid, raised};
pub(crate) use drive::{Pushed, Still, Swinging};
use lane::{Lane, Lanes};
use round::{Rounds, Stages};
use rows::Rows;
use scene::{Scene, Scenes};

/// Lanes side by side whose series have the order N.
#[derive(Debug)]
pub(crate) struct Steps<H: Swinging, const N: usize, const SMALL: bool, const SPRUNG: bool> {
    scenes: Scenes<LANES>,
    lanes: Lanes<H::Instant, LANES>,
    rounds: Rounds<H::Instant, LANES>,
    rows: Rows<LANES>,
    shared: Shared,
    /// The instants and states at the begin of the steps, if observers are to see them.
    begins: ([Clock; LANES], PivaStates<H::Instant, LANES>),
    /// The logs of decays; the impacts that observers have not been told yet.
    logs: Vec<Stretches<Piva<DrivenHost>>>,
    struck: Vec<Vec<Impact>>,
    /// The scene and the state of a lane without a run.
    idle: (Scene, Laid<H>),
}

/// The settings that all lanes share.
#[derive(Debug, Clone, Copy)]
struct Shared {
    /// Largest truncation error of a step, relative to the size of each variable.
    tolerance: f64,
    /// Longest step, over the fastest time scale.
    longest: f64,
    /// Bound on the error of y, relative to the clearance.
    doubt: f64,
    /// What is measured of a decay.
    wanted: Wanted,
    /// True if measures look at the displacement of a decay.
    looks: bool,
    /// True if losses are asked for.
    ledger: bool,
    /// True if pivots are damped.
    pivots: bool,
    /// True if mean squares of displacements are asked for.
    squares: bool,
    /// True if largest displacements or accelerations are asked for.
    extremes: bool,
    /// True if observers see steps: those that are not quiet, or all if `shows_all`.
    shows: bool,
    /// True if the observers beside the measures see quiet steps too.
    shows_all: bool,
    /// True if observers are told of impacts.
    tells: bool,
}

impl Shared {
    /// For runs of pendulums like this one of which nothing is measured.
    fn of(piva: &Piva<DrivenHost>) -> Self {
        Self {
            tolerance: piva.accuracy.tolerance,
            longest: piva.accuracy.longest_step,
            doubt: piva.accuracy.doubt(),
            wanted: Wanted::NONE,
            looks: false,
            ledger: false,
            pivots: piva.pendulum.pivot_damping != 0.0,
            squares: false,
            extremes: false,
            shows: false,
            shows_all: false,
            tells: false,
        }
    }
}

/// Number of impacts after which observers are told of them, so that a long run needs no more memory.
const MOST_STRUCK: usize = 256;

impl<H: Swinging, const N: usize, const SMALL: bool, const SPRUNG: bool>
    Steps<H, N, SMALL, SPRUNG>
{
    /// Idle lanes for pendulums like this one.
    fn with(piva: &Piva<DrivenHost>, shared: Shared) -> Self {
        let scene = Scene::of(piva);
        let state = laid::<H>(&piva.begin(&Start::default().into()));
        let mut lanes = Self {
            scenes: Scenes::new(),
            lanes: Lanes::new(),
            rounds: Rounds::new(),
            rows: Rows::new(),
            shared,
            begins: ([Clock::ZERO; LANES], PivaStates::new()),
            logs: (0..LANES).map(|_| Stretches::new(None)).collect(),
            struck: vec![Vec::new(); LANES],
            idle: (scene, state),
        };
        (0..LANES).for_each(|i| lanes.rest(i));
        lanes
    }

    /// One round of each lane; true if a lane needs something of its run. A function of its own, so that runs and
    /// trajectories, which begin with it alike, have its code once.
    #[inline(never)]
    fn round(&mut self) -> bool {
        in_vectors(
            #[inline(always)]
            || self.advance(),
        )
    }

    #[inline(always)]
    fn advance(&mut self) -> bool {
        let Self { scenes, lanes, rounds, rows, shared, .. } = self;
        Stages::<H, LANES, N, SMALL, SPRUNG> { scenes, lanes, rounds, rows, shared }.run();
        let full = self.log();
        let Self { lanes, rounds, shared, begins, .. } = self;
        let mut shown = false;
        if shared.shows {
            for i in 0..LANES {
                begins.0[i] = lanes.progress.clock.get(i);
                begins.1.set(i, &lanes.state.get(i));
                shown |= (rounds.passed[i] > 0.0) & (shared.shows_all | (rounds.quiet[i] == 0.0));
            }
        }
        for i in 0..LANES {
            let next = lanes.get(i).after(&rounds.get(i));
            lanes.set(i, &next);
        }
        full | shown | any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full)
    }

    /// True if a lane needs the event loop, or is at the end of its run.
    fn leaves(&self, i: usize) -> bool {
        let Lanes { request, stopped, full, .. } = &self.lanes;
        request[i] + stopped[i] + full[i] > 0.0
    }

    /// Logs the steps that the round has completed, and the impacts; true if a log is full.
    #[inline(always)]
    fn log(&mut self) -> bool {
        let mut full = false;
        if self.shared.looks {
            for i in 0..LANES {
                if self.rounds.passed[i] > 0.0 {
                    full |= self.log_step(i);
                }
            }
        }
        if self.shared.tells && any(&self.rounds.hit) {
            for (i, struck) in self.struck.iter_mut().enumerate() {
                if self.rounds.hit[i] > 0.0 {
                    struck.push(self.rounds.impact.get(i));
                    full |= struck.len() >= MOST_STRUCK;
                }
            }
        }
        full
    }

    /// Logs a step of a decay, divided at the turning point of x; true if the log is full.
    #[inline(always)]
    fn log_step(&mut self, i: usize) -> bool {
        let Self { scenes, lanes, rounds, logs, .. } = self;
        let (start, log) = (lanes.progress.clock.get(i), &mut logs[i]);
        if !looks(self.shared.wanted, start.value) {
            return false;
        }
        let origin = raised::<H>(&scenes.get(i), &lanes.state.get(i));
        let Turning { turns, h: turn, x: x_turn, .. } = rounds.turning.get(i);
        let end = (rounds.length[i], rounds.end.primary.x.value[i]);
        let mut begin = (0.0, origin.primary.x.value);
        let points = [(turn, x_turn), end];
        for to in points.into_iter().skip(usize::from(!turns)) {
            let part = Monotone { h: [begin.0, to.0], x: [begin.1, to.1] };
            log.push(Stretch { origin, riding: false, start, part });
            begin = to;
        }
        log.is_full()
    }

    /// True if the log of a lane is full, or the list of its impacts.
    fn is_full(&self, i: usize) -> bool {
        self.logs[i].is_full() || self.struck[i].len() >= MOST_STRUCK
    }

    /// Exchanges the log of a lane for that of its run.
    fn swap_logs(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) {
        if let Some(log) = &mut run.observer.measures.stretches {
            std::mem::swap(&mut self.logs[i], log);
        }
    }
}

impl<H: Swinging, const N: usize, const SMALL: bool, const SPRUNG: bool> Lockstep<Piva<DrivenHost>>
    for Steps<H, N, SMALL, SPRUNG>
where
    Piva<DrivenHost>: SideBySide,
{
    fn new(job: &Job<Piva<DrivenHost>>, wanted: Wanted, listing: &Listing) -> Self {
        let steady = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let bare = Shared::of(&job.system);
        Self::with(
            &job.system,
            Shared {
                wanted,
                looks: !H::DRIVEN && looks(wanted, 0.0),
                ledger: wanted.ledger,
                squares: steady.rms,
                extremes: steady.amplitude || steady.regime || steady.acceleration,
                shows: steady.any() || listing.errors || listing.looks(),
                shows_all: listing.errors || listing.looks(),
                tells: steady.any() || listing.errors || listing.events || listing.looks(),
                ..bare
            },
        )
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.round()
    }

    fn requests(&self, i: usize) -> bool {
        self.leaves(i) || self.is_shown(i) || self.is_full(i)
    }

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) -> bool {
        if self.is_shown(i) {
            self.show(i, run);
        }
        if self.is_full(i) {
            self.tell(i, run);
            self.swap_logs(i, run);
            run.observer.measures.make_room(run.system);
            self.swap_logs(i, run);
        }
        let leaves = self.leaves(i);
        if leaves {
            self.put_back(i, run);
        }
        !leaves
    }

    fn take(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) -> bool {
        let takes = self.take_cycle(i, run, None);
        if takes {
            self.see(i, run);
            self.swap_logs(i, run);
        }
        takes
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) {
        self.tell(i, run);
        self.swap_logs(i, run);
        self.lanes.get(i).put_back_sums(run);
        self.put_back_cycle(i, run);
    }

    fn idle(&mut self, i: usize) {
        self.rest(i);
    }
}

impl<H: Swinging, const N: usize, const SMALL: bool, const SPRUNG: bool> Cycling<Piva<DrivenHost>>
    for Steps<H, N, SMALL, SPRUNG>
{
    const WIDTH: usize = LANES;

    fn cycling(leader: &Piva<DrivenHost>) -> Self {
        Self::with(leader, Shared::of(leader))
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.round()
    }

    fn requests(&self, i: usize) -> bool {
        self.leaves(i)
    }

    fn is_at_end(&self, i: usize) -> bool {
        self.lanes.stopped[i] > 0.0 && self.lanes.full[i] == 0.0
    }

    fn shown(&self, i: usize, _system: &Piva<DrivenHost>) -> PivaState<Moment> {
        raised::<H>(&self.scenes.get(i), &self.lanes.state.get(i))
    }

    fn impacts(&self, i: usize) -> u64 {
        self.lanes.progress.counts.impacts[i] as u64
    }

    /// Lanes of pendulums compute no derivatives: trajectories that want them go one by one.
    fn listen(&mut self, _i: usize) {}

    fn follow(&mut self, _i: usize, _system: &Piva<DrivenHost>, _tangent: &mut Tangent) {}

    fn take_cycle<O>(
        &mut self,
        i: usize,
        run: &Run<'_, Piva<DrivenHost>, O>,
        _forced: Option<&Forced>,
    ) -> bool {
        let lane = Lane::of::<H, _>(run);
        if let Some(lane) = &lane {
            self.scenes.set(i, &Scene::of(run.system));
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back_cycle<O>(&mut self, i: usize, run: &mut Run<'_, Piva<DrivenHost>, O>) {
        self.lanes.get(i).put_back::<H, O>(&self.scenes.get(i), run);
    }

    fn repeat(&mut self, i: usize, from: &Loaded<'_, Piva<DrivenHost>>) -> bool {
        let Primary { x, v } = from.state.primary;
        let goes_on = from.state.distance.value > 0.0 && (x + v + from.state.w).value.is_finite();
        if goes_on {
            let progress = self.lanes.progress.get(i).repeated(from.clock);
            self.lanes.set(i, &Lane::at(progress, &laid::<H>(&from.state)));
        }
        goes_on
    }

    fn rest(&mut self, i: usize) {
        let (scene, state) = &self.idle;
        self.scenes.set(i, scene);
        self.lanes.set(i, &Lane::idle(state));
        // Results that a later round of other lanes may not write.
        self.rounds.passed[i] = 0.0;
    }
}
