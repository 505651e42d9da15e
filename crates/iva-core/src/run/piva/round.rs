//! One round of every lane: a step, tried in stages that go through all lanes. The arithmetic is that of the event
//! loop, without branches.

use super::Shared;
use super::drive::Swinging;
use super::lane::{Lane, Lanes};
use super::rows::Rows;
use super::scene::{Scene, Scenes};
use crate::absorber::Clock;
use crate::absorber::chatter::{first_search, may_end};
use crate::absorber::impact::Impact;
use crate::absorber::piva::accuracy::Sizes;
use crate::absorber::piva::integrals::{self, Integrands};
use crate::absorber::piva::step::{Step, Turning};
use crate::absorber::piva::{PivaState, distance};
use crate::force::{Drive, Push};
use crate::number::arrays::{Laned, Lanes as _, any, laned};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::real::pick;
use crate::segment::flight::{Arc, Losses};
use crate::segment::taylor::{ORDER, Pendulum, Remainder, Series, Spring, unrolled};

/// The results of one round of a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round<P> {
    /// Value and rate of the force at the begin of the step.
    pub push: [DoubleDouble; 2],
    /// The unit of time of the series.
    pub step: f64,
    /// The largest share of it that the series may be used for.
    pub most: f64,
    /// The time up to which the series is to keep to the tolerance; `proved` if it does.
    pub reach: f64,
    pub proved: bool,
    /// The time to the end of the step or to the contact in it, and the state there.
    pub length: f64,
    pub end: PivaState<P>,
    /// True if the step is proved to meet no wall.
    pub clear: bool,
    /// True if it is proved to meet the near wall once, or the far wall.
    pub near: bool,
    pub far: bool,
    /// True if the contact is found, and if the impact is for the lane.
    pub exact: bool,
    pub simple: bool,
    /// The state in contact, the impact, the instant and the state after it; the longest step from there.
    pub touching: PivaState<P>,
    pub impact: Impact,
    pub clock: Clock,
    pub after: PivaState<P>,
    pub first: f64,
    /// The turning point of x, if it was asked for.
    pub turning: Turning,
    /// Losses, work and ∫x² over the step, and bounds on |x| and |ẍ + a_g| in it, if they were asked for.
    pub losses: Losses,
    pub square: f64,
    pub limits: [f64; 2],
    /// True if the step is completed; if it ends with an impact; if the run ends with it; if a part of it is tried
    /// next; if observers need not see it.
    pub passed: bool,
    pub hit: bool,
    pub whole: bool,
    pub again: bool,
    pub quiet: bool,
}

laned!(
    Round<P>,
    Rounds {
        push: [DoubleDouble; 2],
        step: f64,
        most: f64,
        reach: f64,
        proved: bool,
        length: f64,
        end: PivaState<P>,
        clear: bool,
        near: bool,
        far: bool,
        exact: bool,
        simple: bool,
        touching: PivaState<P>,
        impact: Impact,
        clock: Clock,
        after: PivaState<P>,
        first: f64,
        turning: Turning,
        losses: Losses,
        square: f64,
        limits: [f64; 2],
        passed: bool,
        hit: bool,
        whole: bool,
        again: bool,
        quiet: bool,
    }
);

/// The stages of a round of lanes whose series have the order N.
pub(super) struct Stages<
    'a,
    H: Swinging,
    const W: usize,
    const N: usize,
    const SMALL: bool,
    const SPRUNG: bool,
> {
    pub scenes: &'a Scenes<W>,
    pub lanes: &'a Lanes<H::Instant, W>,
    pub rounds: &'a mut Rounds<H::Instant, W>,
    pub rows: &'a mut Rows<W>,
    pub shared: &'a Shared,
}

impl<H: Swinging, const W: usize, const N: usize, const SMALL: bool, const SPRUNG: bool>
    Stages<'_, H, W, N, SMALL, SPRUNG>
{
    /// All stages.
    #[inline(always)]
    pub fn run(&mut self) {
        self.begin();
        self.expand();
        self.prove();
        self.arrive();
        if any(&self.rounds.near) || any(&self.rounds.far) {
            self.strike();
        }
        if self.shared.looks {
            self.turn();
        }
        if self.shared.ledger {
            self.lose();
        }
        if H::DRIVEN && self.shared.squares {
            self.square();
        }
        if H::DRIVEN && self.shared.extremes {
            self.limit();
        }
        self.decide();
    }

    #[inline(always)]
    fn scene(&self, i: usize) -> Scene {
        let scene = self.scenes.get(i);
        // Known to the compiler, so that nothing is computed for both.
        let spring = Spring { acts: SPRUNG, ..scene.pendulum.spring };
        Scene { pendulum: Pendulum { small_angles: SMALL, spring, ..scene.pendulum }, ..scene }
    }

    /// Value and rate of the force at the begin of the step.
    #[inline(always)]
    fn drive_now(&self, i: usize) -> Option<Drive<DoubleDouble, 2>> {
        let [value, rate] = self.rounds.push.get(i);
        let push = Push { value, rate, ..Push::NONE };
        if H::DRIVEN { Some(self.scene(i).pushes(&push).now()) } else { None }
    }

    /// Chooses the length of the step and computes the force over it.
    #[inline(always)]
    fn begin(&mut self) {
        for i in 0..W {
            let scene = self.scene(i);
            let swing = scene.pendulum.swing(self.lanes.state.w.value[i]);
            let longest = self.shared.longest / f64::larger(scene.fastest, swing);
            let step = f64::power_of_two(longest);
            self.rounds.step[i] = step;
            self.rounds.most[i] = longest / step;
        }
        if H::DRIVEN {
            for i in 0..W {
                let scene = self.scene(i);
                let push = H::push(&scene, self.lanes.state.get(i).phase);
                self.rows.set_drive(i, &scene.drive(&push, self.rounds.step[i]));
                self.rounds.push.set(i, &[push.value, push.rate]);
            }
        }
    }

    /// Computes the series of the step.
    #[inline(always)]
    fn expand(&mut self) {
        for i in 0..W {
            let (pendulum, state) = (self.scene(i).pendulum, self.lanes.state.get(i));
            let (swing, h) = (state.swing(&pendulum), self.rounds.step[i]);
            let drive = if H::DRIVEN { Some(self.rows.drive(i)) } else { None };
            let mut series: Series<f64> =
                pendulum.series_to::<_, { ORDER + 1 }, N>(&swing, drive.as_ref(), h);
            series.w[1] = pick(state.released, 0.0, series.w[1]);
            series.y[2] = pick(state.released, 0.0, series.y[2]);
            self.rows.set::<N>(i, &series);
        }
    }

    /// Proves up to which time of the step each series keeps to the tolerance.
    #[inline(always)]
    fn prove(&mut self) {
        for i in 0..W {
            let (scene, series) = (self.scene(i), self.rows.get::<N>(i));
            let (step, most) = (self.rounds.step[i], self.rounds.most[i]);
            let driven = if H::DRIVEN { scene.left_out::<N>(step * most) } else { [0.0; 2] };
            let Scene { pendulum, fastest, gap_size, .. } = scene;
            let remainder = Remainder::new::<N>(&pendulum, fastest, &series, driven, (step, most));
            let size = if H::DRIVEN { self.rows.drive(i).size() } else { 0.0 };
            let state = self.lanes.state.get(i);
            let sizes = Sizes::at(pendulum.mass_ratio, gap_size, &state).with(size);
            let (share, kept) = sizes.share(&remainder, self.shared.tolerance);
            self.rounds.reach[i] = share * step;
            self.rounds.proved.set(i, &kept);
        }
    }

    /// Goes to the end of the step.
    #[inline(always)]
    fn arrive(&mut self) {
        for i in 0..W {
            let (scene, series) = (self.scene(i), self.rows.get::<N>(i));
            let (lane, from) = (self.lanes.get(i), self.lanes.state.get(i));
            let h = self.rounds.reach[i].min(lane.progress.ahead()) * lane.part;
            let length = self.rounds.step[i];
            let step = Step { pendulum: &scene.pendulum, from: &from, series: &series, length };
            let drive = self.drive_now(i);
            let end = step.arrival::<N>(h, drive.as_ref());
            let end = PivaState { phase: H::later(from.phase, h), ..end };
            let gap = step.gap::<N>(&end, h, self.shared.doubt);
            let proved: bool = self.rounds.proved.get(i);
            self.rounds.length[i] = h;
            self.rounds.end.set(i, &end);
            self.rounds.clear.set(i, &gap.clear);
            self.rounds.near.set(i, &(proved & gap.near));
            self.rounds.far.set(i, &(proved & gap.far));
            self.rounds.exact.set(i, &false);
            self.rounds.first[i] = f64::INFINITY;
            self.rounds.clock.set(i, &lane.progress.clock.plus_parts(h, 0.0));
            self.rounds.after.set(i, &end);
        }
    }

    /// Goes to the contact instead, in the lanes that meet a wall, and applies the impact.
    #[inline(always)]
    fn strike(&mut self) {
        for i in 0..W {
            let (scene, series) = (self.scene(i), self.rows.get::<N>(i));
            let (lane, from) = (self.lanes.get(i), self.lanes.state.get(i));
            let length = self.rounds.step[i];
            let step = Step { pendulum: &scene.pendulum, from: &from, series: &series, length };
            let [near, far]: [bool; 2] = [self.rounds.near.get(i), self.rounds.far.get(i)];
            let (whole, end) = (self.rounds.length[i], self.rounds.end.get(i));
            let (h, exact) = step.meeting::<N>(&end, whole, far);
            let meets = (near | far) & exact;
            let drive = self.drive_now(i);
            let arrived = step.arrival::<N>(h, drive.as_ref());
            let arrived = PivaState { phase: H::later(from.phase, h), ..arrived };
            let wall = pick(far, from.wall.opposite(), from.wall);
            let ahead = scene.ahead::<H, 3>(&arrived);
            let (touching, later) = scene.stops.touching(&arrived, wall, &ahead);
            let touching = PivaState { phase: H::later(arrived.phase, later), ..touching };
            let clock = lane.progress.clock.plus_parts(h, 0.0).plus(later);
            let (after, impact) = scene.struck(&touching, clock.value);
            let leave = distance(&after, &scene.ahead::<H, 4>(&after));
            let pressure = -leave.curvature;
            let low = may_end(leave.rate, pressure, scene.law(wall).ratio)
                | (impact.approach_speed() <= lane.progress.floor);
            let search = first_search(leave.rate, pressure);
            let first = pick(pressure > 0.0, search, f64::INFINITY);
            self.rounds.exact.set(i, &meets);
            self.rounds.simple.set(i, &(!low & (clock.minus(lane.progress.stop) < 0.0)));
            self.rounds.length[i] = pick(meets, h, whole);
            self.rounds.end.set(i, &Laned::pick(meets, &arrived, &end));
            self.rounds.touching.set(i, &touching);
            self.rounds.impact.set(i, &impact);
            self.rounds.first[i] = pick(meets, first, f64::INFINITY);
            let (free, ended) = (self.rounds.clock.get(i), self.rounds.after.get(i));
            self.rounds.clock.set(i, &Laned::pick(meets, &clock, &free));
            self.rounds.after.set(i, &Laned::pick(meets, &after, &ended));
        }
    }

    /// Finds the turning point of x.
    #[inline(always)]
    fn turn(&mut self) {
        for i in 0..W {
            let (scene, series) = (self.scene(i), self.rows.get::<N>(i));
            let (from, length) = (self.lanes.state.get(i), self.rounds.step[i]);
            let step = Step { pendulum: &scene.pendulum, from: &from, series: &series, length };
            let turning = step.turning::<N>(&self.rounds.end.get(i), self.rounds.length[i]);
            self.rounds.turning.set(i, &turning);
        }
    }

    /// Losses in the dampers and work of the force over the step.
    #[inline(always)]
    fn lose(&mut self) {
        let (pivots, base) = (self.shared.pivots, H::DRIVEN && any(&self.scenes.moves_base));
        for i in 0..W {
            let series = self.rows.get::<N>(i);
            let Series { u, y, w, .. } = &series;
            let (pendulum, step) = (self.scene(i).pendulum, self.rounds.step[i]);
            let t = self.rounds.length[i] / step;
            let free = Integrands { u, y, w, drive: None, pivots, base };
            let losses = if H::DRIVEN {
                let drive = self.rows.drive(i);
                Integrands { drive: Some(&drive), ..free }.taken::<N>(&pendulum, t, step)
            } else {
                free.taken::<N>(&pendulum, t, step)
            };
            self.rounds.losses.set(i, &losses);
        }
    }

    /// ∫x² over the step.
    #[inline(always)]
    fn square(&mut self) {
        for i in 0..W {
            let (series, step) = (self.rows.get::<N>(i), self.rounds.step[i]);
            let share = self.rounds.length[i] / step;
            self.rounds.square[i] = integrals::square::<f64, N>(&series.x, [0.0, share], step);
        }
    }

    /// Bounds on |x| and |ẍ + a_g| in the step.
    #[inline(always)]
    fn limit(&mut self) {
        let mut share = [0.0; W];
        for (i, share) in share.iter_mut().enumerate() {
            *share = self.rounds.length[i] / self.rounds.step[i];
        }
        let [x, a] = self.rows.primary();
        let [most_x, most_a] = self.rounds.limits.0.each_mut();
        limits::<W, N>(x, &share, most_x);
        // The series of the acceleration has no coefficient of the order N.
        match N {
            10 => limits::<W, 9>(a, &share, most_a),
            16 => limits::<W, 15>(a, &share, most_a),
            _ => limits::<W, 19>(a, &share, most_a),
        }
    }

    /// Decides what follows.
    #[inline(always)]
    fn decide(&mut self) {
        for i in 0..W {
            let (lane, round): (Lane<_>, Round<_>) = (self.lanes.get(i), self.rounds.get(i));
            let Round { proved, clear, exact, simple, turning, .. } = round;
            let seen = !self.shared.looks | turning.decided;
            let hits = exact & simple;
            let passed = lane.live & proved & seen & (hits | (clear & !exact));
            let meets = round.near | round.far;
            let undecided = !clear & !meets | (meets & !exact);
            let ends = round.length == lane.progress.remaining();
            let clocks = [lane.progress.clock, round.clock];
            self.rounds.passed.set(i, &passed);
            self.rounds.hit.set(i, &(passed & exact));
            self.rounds.whole.set(i, &(passed & !exact & ends));
            self.rounds.again.set(i, &(lane.live & proved & undecided & lane.can_part()));
            self.rounds.quiet.set(i, &lane.quiet.covers(clocks, round.limits));
        }
    }
}

/// Bounds on the absolute values of polynomials of order N on shares of a step.
#[inline(always)]
fn limits<const W: usize, const N: usize>(
    row: &[[f64; W]; ORDER + 1],
    share: &[f64; W],
    limits: &mut [f64; W],
) {
    for i in 0..W {
        let t = share[i];
        let [mut value, mut rate, mut half, mut size, mut sixth] = [0.0_f64; 5];
        unrolled!(j < N + 1 => {
            let k = N - j;
            let coefficient = row[k][i];
            half = half.mul_add(t, rate);
            rate = rate.mul_add(t, value);
            value = value.mul_add(t, coefficient);
            size = size.mul_add(t, coefficient.abs());
            if k > 5 {
                let falling = k * (k - 1) * (k - 2) * (k - 3) * (k - 4) * (k - 5);
                sixth = sixth.mul_add(t, coefficient.abs() * (falling as f64));
            }
        });
        let begin = [row[0][i], row[1][i], row[2][i] * 2.0];
        let arc = Arc::new(begin, [value, rate, half * 2.0], sixth, t).doubted(size);
        limits[i] = arc.limit();
    }
}
