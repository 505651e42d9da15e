//! One lane: a pendulum's run reduced to the numbers that steps of flight change.

use super::watch::Watch;
use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::force::{Acts, Drive, Force, Harmonic, Push};
use crate::lanes::ScalarRun;
use crate::lanes::pick;
use crate::oscillator::Primary;
use crate::piva::{Piva, PivaState};
use crate::simulate::Phase;
use crate::system::Wall;
use crate::taylor::{ORDER, Pendulum, unrolled};

/// Code for no wall.
pub(super) const NONE: f64 = 0.0;
/// Code for the near wall.
pub(super) const NEAR: f64 = 1.0;
/// Code for the far wall.
pub(super) const FAR: f64 = 2.0;

arrays! {
    /// A state in flight.
    Pose, Poses:
    x, x_rest, v, v_rest, side, clearance, distance, distance_rest, w, w_rest, cosine, cosine_rest,
    released, age, age_rest,
}

arrays! {
    /// The numbers of one run.
    Lane, Lanes:
    /// Constants of the pendulum, and the length that the tolerance on its gap is relative to.
    mass_ratio, damping_ratio, contact_distance, inertia_ratio, lever, coupling, frequency_squared,
    pivot_damping, gap_size,
    /// Fastest rate of primary, pendulum and force, without the swing.
    fastest,
    /// Harmonic force: amplitude, frequency, phase, and 1 if it moves the base.
    amplitude, frequency, angle, moves_base,
    /// Clock, instant at which the run ends, and longest first stretch.
    time, time_rest, stop, first,
    work, max_work,
    /// 1 for a lane with a run, 0 for one without.
    live,
    /// Losses in the dampers of primary and pivot.
    viscous, viscous_rest, pivot, pivot_rest,
    /// Losses, work and ∫x² over the step, and bounds on |x| and |ẍ + a_g| in it.
    lost, lost_in_pivot, worked, square, limit_x, limit_a,
    /// Length of the step, largest share of it to be proved, and proved time.
    step, most, reach,
    /// 1 if the truncation error up to `reach` is proved to be within the tolerance.
    proved,
    /// Length of the stretch searched for contact, distance at its end, time to the contact, and the wall.
    length, end_distance, until, meets,
    /// Share of the step that is done (0 if none), and the wall met at its end.
    share, met,
    /// Clock at the beginning of the step.
    start_time, start_time_rest,
    /// Settling levels that |x| falls below in the step, with the sign of x (0: none), and the instants
    /// between which it does.
    passed_1, from_1, to_1, passed_2, from_2, to_2, passed_3, from_3, to_3,
    /// Requests that call the run: those for impact or event loop, and those of any kind.
    request, requests;
    /// State of the run, and state at the beginning of the step.
    pose: Pose,
    origin: Pose,
    /// Measures of a decay.
    watch: Watch,
}

impl Pose {
    #[inline(always)]
    pub fn new(state: &PivaState) -> Self {
        let PivaState { time, primary, wall, distance, clearance, w, cosine, released, .. } =
            *state;
        Self {
            x: primary.x.value,
            x_rest: primary.x.rest,
            v: primary.v.value,
            v_rest: primary.v.rest,
            side: wall.sign(),
            clearance,
            distance: distance.value,
            distance_rest: distance.rest,
            w: w.value,
            w_rest: w.rest,
            cosine: cosine.value,
            cosine_rest: cosine.rest,
            released: if released { 1.0 } else { 0.0 },
            age: time.value,
            age_rest: time.rest,
        }
    }

    /// The state of a motion without impulses.
    #[inline(always)]
    pub fn state(&self) -> PivaState {
        let sum = |value, rest| DoubleDouble { value, rest };
        PivaState {
            time: sum(self.age, self.age_rest),
            kicks: 0,
            primary: Primary { x: sum(self.x, self.x_rest), v: sum(self.v, self.v_rest) },
            wall: if self.side > 0.0 { Wall::Plus } else { Wall::Minus },
            distance: sum(self.distance, self.distance_rest),
            clearance: self.clearance,
            w: sum(self.w, self.w_rest),
            cosine: sum(self.cosine, self.cosine_rest),
            released: self.released > 0.0,
        }
    }
}

impl Lane {
    #[inline(always)]
    pub fn pendulum<const SMALL: bool>(&self) -> Pendulum {
        Pendulum {
            mass_ratio: self.mass_ratio,
            damping_ratio: self.damping_ratio,
            contact_distance: self.contact_distance,
            inertia_ratio: self.inertia_ratio,
            lever: self.lever,
            coupling: self.coupling,
            frequency_squared: self.frequency_squared,
            pivot_damping: self.pivot_damping,
            small_angles: SMALL,
        }
    }

    /// The harmonic force, as one that acts on the primary.
    #[inline(always)]
    fn harmonic(&self) -> Harmonic {
        let Self { amplitude, frequency, angle: phase, .. } = *self;
        Harmonic { amplitude, frequency, phase, acts: Acts::Primary }
    }

    /// A number of the force as the pair for f/M and a_g, one of which is 0.
    #[inline(always)]
    fn acting(&self, number: f64) -> [f64; 2] {
        let base = self.moves_base > 0.0;
        [pick(base, 0.0, number), pick(base, number, 0.0)]
    }

    /// Coefficients of the force over a step of length h.
    #[inline(always)]
    pub fn drive(&self, h: f64) -> Drive<f64> {
        let mut row = [0.0; ORDER + 1];
        self.harmonic().add(&mut row, self.pose.state().time, h);
        let mut drive = Drive::NONE;
        unrolled!(k < ORDER + 1 => {
            [drive.primary[k], drive.base[k]] = self.acting(row[k]);
        });
        drive
    }

    /// The first two coefficients of the force in powers of time, to twice the precision.
    #[inline(always)]
    pub fn beginning(&self) -> Drive<DoubleDouble, 2> {
        let push: Push = self.harmonic().push(self.pose.state().time);
        let [value, rate] = push.beginning().map(|DoubleDouble { value, rest }| {
            let ([f, g], [f_rest, g_rest]) = (self.acting(value), self.acting(rest));
            [DoubleDouble { value: f, rest: f_rest }, DoubleDouble { value: g, rest: g_rest }]
        });
        Drive { primary: [value[0], rate[0]], base: [value[1], rate[1]] }
    }

    /// Bounds on what is left out of the force ([`Force::left_out`]).
    #[inline(always)]
    pub fn left_out<const N: usize>(&self, h: f64) -> [f64; 2] {
        self.acting(self.harmonic().left_out::<N>(h))
    }

    #[inline(always)]
    pub fn clock(&self) -> DoubleDouble {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// True if a step of this length passes an instant.
    #[inline(always)]
    pub fn passes(&self, instant: f64, length: f64) -> bool {
        let ahead = -self.clock().minus(instant);
        (ahead > 0.0) & (ahead <= length)
    }

    /// A lane without a run, at rest.
    pub fn idle() -> Self {
        let pose =
            Pose { side: 1.0, clearance: 1.0, distance: 1.0, cosine: 1.0, ..Pose::default() };
        let (never, one) = (f64::INFINITY, 1.0);
        let still =
            Self { contact_distance: one, inertia_ratio: one, lever: one, ..Self::default() };
        let still = Self { coupling: one, frequency_squared: one, gap_size: one, ..still };
        let endless = Self { stop: never, first: never, max_work: never, ..still };
        Self { pose, watch: Watch::idle(), ..endless }
    }

    /// The lane of a run in flight.
    pub fn of(run: &ScalarRun<'_, Piva>, first: f64) -> Self {
        let pendulum = run.system.pendulum;
        let force: &Force = run.system.force();
        let still = Harmonic { amplitude: 0.0, frequency: 0.0, phase: 0.0, acts: Acts::Primary };
        let harmonic = force.harmonics().first().copied().unwrap_or(still);
        Self {
            mass_ratio: pendulum.mass_ratio,
            damping_ratio: pendulum.damping_ratio,
            contact_distance: pendulum.contact_distance,
            inertia_ratio: pendulum.inertia_ratio,
            lever: pendulum.lever,
            coupling: pendulum.coupling,
            frequency_squared: pendulum.frequency_squared,
            pivot_damping: pendulum.pivot_damping,
            gap_size: run.system.gap_size(),
            fastest: pendulum.fastest().max(force.fastest()),
            amplitude: harmonic.amplitude,
            frequency: harmonic.frequency,
            angle: harmonic.phase,
            moves_base: pick(force.moves_base(), 1.0, 0.0),
            time: run.clock.value,
            time_rest: run.clock.rest,
            stop: run.limits.duration,
            first,
            live: 1.0,
            work: run.counts.work,
            max_work: run.limits.max_work as f64,
            viscous: run.observer.measures.viscous.value,
            viscous_rest: run.observer.measures.viscous.rest,
            pivot: run.observer.measures.pivot.value,
            pivot_rest: run.observer.measures.pivot.rest,
            pose: Pose::new(&run.tally.state),
            watch: Watch::of(&run.observer.measures),
            ..Self::default()
        }
    }

    /// Puts the numbers back into the run; the measures of a driven run have had every step shown already.
    pub fn put_back<const DRIVEN: bool>(&self, run: &mut ScalarRun<'_, Piva>) {
        run.tally.state = self.pose.state();
        run.counts.work = self.work;
        run.clock = self.clock();
        run.phase = Phase::Flight { first: self.first };
        if DRIVEN {
            return;
        }
        self.watch.put_back(&mut run.observer.measures);
        run.observer.measures.viscous =
            DoubleDouble { value: self.viscous, rest: self.viscous_rest };
        run.observer.measures.pivot = DoubleDouble { value: self.pivot, rest: self.pivot_rest };
    }
}
