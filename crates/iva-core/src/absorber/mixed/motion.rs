//! The motion of a structure and of free masses and pendulums between two events.

use super::{Mixed, MixedState, Placed};
use crate::absorber::piva::accuracy::Accuracy;
use crate::absorber::piva::fourth_bound;
use crate::absorber::piva::step::Step;
use crate::absorber::{Absorber, Point, Wall};
use crate::force::Drive;
use crate::host::oscillator::Primary;
use crate::host::{Host, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::contact::{keeps_pressing, stays_clear};
use crate::segment::flight::{
    Curve, GapPoint, Jet, Losses, Motion, Quantity, Rows, Seen, Side, Travel, Turns,
};
use crate::segment::quadrature::{mean_product, nodes, rates, values};
use crate::segment::taylor::{Member, ORDER, Series, horner, series_of_several};

/// Number of nodes of the integrals over a step.
const NODES: usize = 8;

/// The motion from one state. Its curve is that of the absorber at hand: the distance to the wall last touched, or the
/// pressure on that wall while it is stuck.
#[derive(Debug, Clone)]
pub struct MixedFlight<'a, H: Host> {
    system: &'a Mixed<H>,
    pub(super) from: MixedState<H>,
    /// Of each absorber with the structure, in powers of t over `step`.
    series: Vec<Series<H::Real>>,
    drive: Option<Drive<H::Real>>,
    step: H::Real,
    reach: H::Real,
    /// True if what the series leave out is bounded by full accuracy.
    proved: bool,
}

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// All absorbers at the begin of a motion.
    #[inline(always)]
    fn swings(&self, state: &MixedState<H>) -> Vec<Member<'_, R>> {
        let mut swings = Vec::with_capacity(self.members.len());
        for (k, member) in self.members.iter().enumerate() {
            let (pendulum, seen) = (&member.pendulum, self.seen(state, k));
            let Placed { stuck, released, .. } = state.places[k];
            swings.push(Member { pendulum, swing: seen.swing(pendulum), stuck, released });
        }
        swings
    }

    /// The same to twice the precision, and the cosines.
    #[inline(always)]
    fn precise_swings(
        &self,
        state: &MixedState<H>,
    ) -> (Vec<Member<'_, DoubleDouble<R>>>, Vec<DoubleDouble<R>>) {
        let count = self.members.len();
        let (mut swings, mut cosines) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, member) in self.members.iter().enumerate() {
            let (pendulum, seen) = (&member.pendulum, self.seen(state, k));
            let cosine = seen.precise_cosine(pendulum);
            let Placed { stuck, released, .. } = state.places[k];
            let swing = seen.precise_swing(pendulum, cosine);
            swings.push(Member { pendulum, swing, stuck, released });
            cosines.push(cosine);
        }
        (swings, cosines)
    }

    /// The first Taylor coefficients of the motion from a state of each absorber, in powers of t: four at most.
    pub(super) fn beginning<const LENGTH: usize>(
        &self,
        state: &MixedState<H>,
    ) -> Vec<Series<R, LENGTH>> {
        let zeta = self.host.damping_ratio();
        let (swings, drive) = (self.swings(state), self.host.drive_ahead(&state.phase));
        series_of_several(&swings, zeta, drive.as_ref(), (R::ONE, LENGTH - 1))
    }

    /// The distance of an absorber to its wall and its derivatives. One that is stuck stays: its derivatives are those with
    /// which the pressure would move it.
    pub(super) fn distance_of(&self, state: &MixedState<H>, k: usize) -> Jet<R> {
        let series = &self.beginning::<4>(state)[k];
        let place = &state.places[k];
        if !place.stuck {
            return crate::absorber::piva::distance(&self.seen(state, k), series);
        }
        let [factor, constant] = self.members[k].pressure(place.wall);
        let c = self.members[k].stops.cosine.value;
        let Series { a, .. } = series;
        let [curvature, jerk] = [-c * (factor * a[0] + constant), -c * (factor * a[1])];
        Jet { value: R::ZERO, rate: R::ZERO, curvature, jerk }
    }

    /// The pressure of a stuck absorber on its wall and its derivatives.
    pub(super) fn pressure_of(&self, state: &MixedState<H>, k: usize) -> Jet<R> {
        let zeta = self.host.damping_ratio();
        let series: Vec<Series<R, 5>> = {
            let swings = self.swings(state);
            let whole = self.host.drive(&state.phase, R::ONE);
            let drive = whole.as_ref().map(|it| Drive {
                primary: std::array::from_fn(|k| it.primary[k]),
                base: std::array::from_fn(|k| it.base[k]),
            });
            series_of_several(&swings, zeta, drive.as_ref(), (R::ONE, 4))
        };
        let [factor, constant] = self.members[k].pressure(state.places[k].wall);
        let a = &series[k].a;
        Jet {
            value: factor * a[0] + constant,
            rate: factor * a[1],
            curvature: factor * (a[2] * 2.0),
            jerk: factor * (a[3] * 6.0),
        }
    }
}

impl<'a, R: Real, H: Host<Real = R>> MixedFlight<'a, H> {
    pub(super) fn new(system: &'a Mixed<H>, from: MixedState<H>) -> Self {
        let longest = system.longest_step(&from);
        // A power of two: h/step is exact then, and the terms of the series belong to one instant.
        let step = R::power_of_two(longest);
        let zeta = system.host.damping_ratio();
        let (series, drive) = {
            let drive = system.host.drive(&from.phase, step);
            let swings = system.swings(&from);
            (series_of_several(&swings, zeta, drive.as_ref(), (step, ORDER)), drive)
        };
        let size = drive.as_ref().map_or(R::ZERO, Drive::size);
        let share = system.share_proved(&series, (step, longest / step), &from, size);
        let smooth = system.host.smooth_for(&from.phase);
        let reach = share.map_or(step, |share| smooth.min(share * step));
        Self { system, from, series, drive, step, reach, proved: share.is_some() }
    }

    /// The state at h, but that of the drive; `precise`: the linear terms to twice the precision.
    #[inline(always)]
    fn moved(&self, h: R, precise: bool) -> MixedState<H> {
        if h == 0.0 {
            return self.from;
        }
        let Self { system, from, series, step, .. } = self;
        let (length, mut to) = (*step, *from);
        let precise = precise.then(
            #[inline(always)]
            || {
                let (swings, cosines) = system.precise_swings(from);
                let (drive, zeta) =
                    (system.host.drive_now(&from.phase), system.host.damping_ratio());
                let first: Vec<Series<DoubleDouble<R>, 2>> =
                    series_of_several(&swings, zeta, drive.as_ref(), (R::ONE, 1));
                (first, cosines)
            },
        );
        for (k, member) in system.members.iter().enumerate() {
            let seen = system.seen(from, k);
            let series = &series[k];
            let step = Step { pendulum: &member.pendulum, from: &seen, series, length };
            let at = match &precise {
                Some((first, cosines)) => step.arrived::<ORDER>(h, cosines[k], &first[k]),
                None => step.state::<ORDER>(h),
            };
            to.primary = at.primary;
            to.places[k] = if from.places[k].stuck {
                Placed { released: false, ..from.places[k] }
            } else {
                from.places[k].moved_to(&at)
            };
        }
        to
    }

    fn share(&self, h: R) -> R {
        h / self.step
    }

    /// The absorber at hand, its index and place.
    fn at_hand(&self) -> (usize, &Placed<R>) {
        let (k, _) = self.system.at_hand(&self.from);
        (k, &self.from.places[k])
    }
}

impl<R: Real, H: Host<Real = R>> Motion for MixedFlight<'_, H> {
    type Real = R;
    type State = MixedState<H>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.reach
    }

    fn state(&self, h: R) -> Self::State {
        let (free, stuck) = (self.system.host.free(), self.at_hand().1.stuck);
        // A pressure is a small difference of the drive and what it moves, so that its zero asks for all
        // digits.
        let phase = if stuck {
            free.within(&self.from.phase, h)
        } else {
            free.nearly_within(&self.from.phase, h)
        };
        MixedState { phase, ..self.moved(h, false) }
    }

    fn arrival(&self, h: R) -> Self::State {
        let free = self.system.host.free();
        let phase = free.renewed(&free.within(&self.from.phase, h));
        MixedState { phase, ..self.moved(h, true) }
    }

    fn clears(&self, length: R, end: &Self::State) -> bool {
        if !self.proved {
            return false;
        }
        let (k, from) = self.at_hand();
        let (to, member) = (&end.places[k], &self.system.members[k]);
        if !from.stuck {
            let ends = [from, to].map(|it| [it.distance.value, it.rate()]);
            return stays_clear(ends, member.clearance, self.fourth(), length);
        }
        let (a, over_step) = (&self.series[k].a, R::ONE / self.step);
        let share = self.share(length);
        let [mut pulled, mut jerk] = [R::ZERO; 2];
        for k in (0..ORDER).rev() {
            jerk = jerk * share + pulled;
            pulled = pulled * share + a[k];
        }
        let [factor, constant] = member.pressure(from.wall);
        let ends = [[a[0], a[1]], [pulled, jerk]];
        let pressed = ends.map(|[a, jerk]| [factor * a + constant, factor * (jerk * over_step)]);
        keeps_pressing(pressed, self.magnitude(), self.fourth(), length)
    }

    fn meets(&self, length: R, end: &Self::State) -> Option<(R, Side)> {
        let (k, from) = self.at_hand();
        if from.stuck || !self.proved {
            return None;
        }
        let (seen, end) = (self.system.seen(&self.from, k), self.system.seen(end, k));
        let pendulum = &self.system.members[k].pendulum;
        let step = Step { pendulum, from: &seen, series: &self.series[k], length: self.step };
        let gap = step.gap::<ORDER>(&end, length, Accuracy::of(R::ZERO).doubt());
        let side = if gap.near { Side::Near } else { Side::Far };
        if !(gap.near || gap.far) {
            return None;
        }
        let (h, exact) = step.meeting::<ORDER>(&end, length, gap.far);
        exact.then_some((h, side))
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        if !R::FAST_PATHS || !self.proved {
            return Turns::Unknown;
        }
        let (system, end) = (self.system, self.system.seen(end, 0));
        let seen = system.seen(&self.from, 0);
        let pendulum = &system.members[0].pendulum;
        let step = Step { pendulum, from: &seen, series: &self.series[0], length: self.step };
        let turning = step.turning::<ORDER>(&end, length);
        turning.as_turns()
    }

    fn primary(&self, h: R) -> Jet<R> {
        let state = self.state(h);
        let Series { u, .. } = &self.system.beginning::<3>(&state)[0];
        let Point { x, v } = Point { x: state.primary.x.value, v: state.primary.v.value };
        Jet { value: x, rate: v, curvature: u[1], jerk: u[2] * 2.0 }
    }

    fn acceleration(&self, h: R) -> R {
        self.system.beginning::<3>(&self.state(h))[0].a[0]
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        self.gap_of(self.at_hand().0, h)
    }

    fn seen(&self, h: R) -> Seen<Self::State, R> {
        let state = self.state(h);
        let (k, member) = self.system.at_hand(&state);
        let primary = Point { x: state.primary.x.value, v: state.primary.v.value };
        let acceleration = self.system.beginning::<3>(&state)[0].a[0];
        Seen { state, primary, gap: state.places[k].gap(member), acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        self.wall_of(self.at_hand().0)
    }

    fn absorbers(&self) -> usize {
        self.system.absorbers()
    }

    fn gap_of(&self, absorber: usize, h: R) -> GapPoint<R> {
        let state = self.state(h);
        let gap = self.system.each(&state).nth(absorber).map(|(member, place)| place.gap(member));
        gap.unwrap_or(GapPoint { y: R::ZERO, w: R::ZERO })
    }

    fn wall_of(&self, absorber: usize) -> Option<Wall> {
        let place = self.from.places.get(absorber).filter(|place| place.stuck)?;
        Some(place.wall)
    }

    fn rows(&self) -> Option<Rows<R>> {
        let Series { x, mut a, .. } = self.series[0];
        a[ORDER] = R::ZERO;
        let base = self.drive.as_ref().map_or([R::ZERO; ORDER + 1], |drive| drive.base);
        Some(Rows { step: self.step, order: ORDER, x, acceleration: a, base })
    }

    fn travel(&self) -> Option<Travel<R>> {
        self.travel_of(self.at_hand().0)
    }

    fn travel_of(&self, absorber: usize) -> Option<Travel<R>> {
        let (rows, member) = (self.rows()?, self.system.members.get(absorber)?);
        let mut gap = self.series[absorber].y;
        gap[0] += member.offset;
        Some(Travel::new(rows, gap, member.pendulum.lever))
    }

    fn square(&self, h: [R; 2]) -> R {
        let ends = h.map(|h| self.share(h));
        let x = values::<ORDER, _, _, _>(&self.series[0].x, &nodes::<R, NODES>(ends));
        mean_product(&x, &x) * (h[1] - h[0])
    }

    fn largest(&self, _of: Quantity, _least: R, _length: R, _end: &Self::State) -> Option<R> {
        None
    }

    fn losses(&self, h: R) -> Losses<R> {
        self.taken(h)
    }
}

impl<R: Real, H: Host<Real = R>> MixedFlight<'_, H> {
    /// Energy lost and work up to h: ∫ 2ζ ẋ² dt, the losses in the pivots, and ∫ (f/M) ẋ − a_g ((1 + Σμ) ẋ + Σ μλ ẏ) dt.
    #[inline(always)]
    fn taken(&self, h: R) -> Losses<R> {
        let at = nodes::<R, NODES>([R::ZERO, self.share(h)]);
        let u = values::<ORDER, _, _, _>(&self.series[0].u, &at);
        let viscous = self.system.host.damping_ratio() * 2.0 * mean_product(&u, &u) * h;
        let mut pivot = R::ZERO;
        for (member, Series { w, .. }) in self.system.members.iter().zip(&self.series) {
            let is = &member.pendulum;
            if is.pivot_damping != 0.0 {
                let w = values::<ORDER, _, _, _>(w, &at);
                let inertia = is.mass_ratio * is.inertia_ratio * (is.lever * is.lever);
                pivot += inertia * is.pivot_damping * mean_product(&w, &w) * h;
            }
        }
        let Some(drive) = &self.drive else { return Losses { viscous, pivot, work: R::ZERO } };
        let mut work = mean_product(&values::<ORDER, _, _, _>(&drive.primary, &at), &u);
        if self.system.host.moves_base() {
            let mut momentum = u.map(|u| u * (R::ONE + super::total(&self.system.members)));
            for (member, Series { y, .. }) in self.system.members.iter().zip(&self.series) {
                let pull = member.pendulum.mass_ratio * member.pendulum.lever / self.step;
                let rates = rates::<ORDER, _, _, _>(y, &at);
                for (momentum, rate) in momentum.iter_mut().zip(rates) {
                    *momentum += pull * rate;
                }
            }
            work -= mean_product(&values::<ORDER, _, _, _>(&drive.base, &at), &momentum);
        }
        Losses { viscous, pivot, work: work * h }
    }
}

impl<R: Real, H: Host<Real = R>> Curve for MixedFlight<'_, H> {
    type Real = R;
    type Sample = MixedState<H>;

    fn sample(&self, h: R) -> Self::Sample {
        self.state(h)
    }

    fn jet(&self, sample: &Self::Sample) -> Jet<R> {
        let (k, place) = self.at_hand();
        if place.stuck {
            self.system.pressure_of(sample, k)
        } else {
            self.system.distance_of(sample, k)
        }
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let (k, place) = self.at_hand();
        if place.stuck {
            return DoubleDouble::new(self.jet(&self.state(h)).value);
        }
        let (swings, _) = self.system.precise_swings(&self.from);
        let drive = self.system.host.precise_drive(&self.from.phase, self.step);
        let zeta = self.system.host.damping_ratio();
        let series: Vec<Series<DoubleDouble<R>>> =
            series_of_several(&swings, zeta, drive.as_ref(), (self.step, ORDER));
        let t = DoubleDouble::new(h).over(self.step);
        let travelled = horner(&series[k].y[1..], t).times_sum(t);
        let s = place.wall.sign();
        place.distance.plus_parts(travelled.value * -s, travelled.rest * -s)
    }

    /// Those of the series themselves: their truncation errors are part of the doubt.
    fn fourth(&self) -> R {
        if !self.proved {
            return R::NAN;
        }
        let (k, place) = self.at_hand();
        let over_step = R::ONE / (self.step * self.step * self.step * self.step);
        let share = self.share(self.reach);
        if place.stuck {
            let [factor, _] = self.system.members[k].pressure(place.wall);
            return factor.abs() * fourth_bound(&self.series[k].a, share) * over_step;
        }
        fourth_bound(&self.series[k].y, share) * over_step
    }

    fn magnitude(&self) -> R {
        let (k, place) = self.at_hand();
        let member = &self.system.members[k];
        if !place.stuck {
            return member.clearance;
        }
        let [factor, constant] = member.pressure(place.wall);
        let a = self.series[k].a.iter().rev();
        let share = self.share(self.reach);
        let shaking = a.fold(R::ZERO, |sum, a| sum * share + a.abs());
        // A is a small difference of these.
        let Primary { x, v } = self.from.primary;
        let damped = self.system.host.damping_ratio() * 2.0 * v.value.abs();
        let driven = self.drive.as_ref().map_or(R::ZERO, Drive::size);
        factor.abs() * (shaking + x.value.abs() + damped + driven) + constant.abs()
    }
}
