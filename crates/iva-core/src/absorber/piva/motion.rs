//! The flight of a pendulum absorber: swinging in its gap.

use super::gap::Gap;
use super::integrals::{Integrands, square};
use super::step::Step;
use super::{Piva, PivaState, at_rest_on_release};
use crate::absorber::{Absorber, Point, Wall};
use crate::force::Drive;
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{
    Curve, FastFlight, GapPoint, Jet, Losses, Meets, Motion, Quantity, Rows, Seen, Side, Travel,
    Turns,
};
use crate::segment::taylor::{ORDER, Row, Series, horner, with_order};

/// The pendulum free in its gap.
#[derive(Debug, Clone)]
pub struct PivaFlight<'a, H: Host> {
    piva: &'a Piva<H>,
    from: PivaState<Phase<H>, H::Real>,
    /// Coefficients in powers of t over `step`.
    series: Series<H::Real>,
    drive: Option<Drive<H::Real>>,
    step: H::Real,
    reach: H::Real,
    /// True if what the series leaves out is bounded by the tolerance.
    proved: bool,
    /// Integrals and bounds over the whole reach, if lanes have computed them.
    known: Option<Known<H::Real>>,
}

/// Integrals and bounds over the whole length of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known<R = f64> {
    pub losses: Losses<R>,
    /// ∫x²
    pub square: R,
    /// Bounds on |x| and |ẍ + a_g|.
    pub limits: [R; 2],
}

impl<'a, R: Real, H: Host<Real = R>> PivaFlight<'a, H> {
    pub(crate) fn new(piva: &'a Piva<H>, from: PivaState<Phase<H>, R>) -> Self {
        let order = piva.accuracy.order;
        let longest = piva.longest_step(&from);
        // A power of two: h/step is exact then, and the terms of the series belong to one instant.
        let step = R::power_of_two(longest);
        let most = longest / step;
        let drive = piva.host.drive(&from.phase, step);
        let series = piva.pendulum.series(&from.swing(&piva.pendulum), drive.as_ref(), step, order);
        let series = at_rest_on_release(&from, series);
        let size = drive.as_ref().map_or(R::ZERO, Drive::size);
        let Some(share) = piva.share_proved(&series, (step, most), &from, size) else {
            // Without a proved bound [`Curve::fourth`] is NaN, which ends the run as not finite.
            return Self {
                piva,
                from,
                series,
                drive,
                step,
                reach: step,
                proved: false,
                known: None,
            };
        };
        let smooth = piva.host.smooth_for(&from.phase);
        let reach = if smooth <= share * step { smooth } else { share * step };
        Self { piva, from, series, drive, step, reach, proved: true, known: None }
    }

    /// A flight that lanes have proved and flown to its end, to be measured.
    pub(crate) fn flown(
        piva: &'a Piva<H>,
        from: PivaState<Phase<H>, R>,
        (series, drive): (Series<R>, Option<Drive<R>>),
        step: R,
        (reach, known): (R, Known<R>),
    ) -> Self {
        let known = Some(known);
        Self { piva, from, series, drive, step, reach, proved: true, known }
    }

    /// The time h as a share of the step.
    fn share(&self, h: R) -> R {
        h / self.step
    }

    /// The step of this flight.
    fn step(&self) -> Step<'_, Phase<H>, R> {
        let Self { piva, from, series, step, .. } = self;
        Step { pendulum: &piva.pendulum, from, series, length: *step }
    }

    /// The state at h, the linear terms to twice the precision.
    #[inline(always)]
    fn arrived(&self, h: R) -> PivaState<Phase<H>, R> {
        if h == 0.0 {
            return self.from;
        }
        let drive = self.piva.host.drive_now(&self.from.phase);
        let order = self.piva.accuracy.order;
        let state = with_order!(order, N => self.step().arrival::<N>(h, drive.as_ref()));
        let free = self.piva.host.free();
        PivaState { phase: free.renewed(&free.within(&self.from.phase, h)), ..state }
    }

    /// The first coefficients of the flight from a state.
    fn beginning(&self, state: &PivaState<Phase<H>, R>) -> Series<R, 3> {
        self.piva.beginning(state)
    }

    /// The series to twice the precision, from an angle with this cosine.
    fn precise_series(
        &self,
        cosine: DoubleDouble<R>,
        h: R,
        order: usize,
    ) -> Series<DoubleDouble<R>> {
        let from = &self.from;
        let start = from.precise_swing(&self.piva.pendulum, cosine);
        let drive = self.piva.host.precise_drive(&from.phase, h);
        self.piva.pendulum.series(&start, drive.as_ref(), h, order)
    }
}

impl<R: Real, H: Host<Real = R>> PivaFlight<'_, H> {
    /// The flight of a length that is shown to meet no wall, or the flight to the wall that it meets within it.
    fn decided(&self, length: R) -> Option<FastFlight<PivaState<Phase<H>, R>, R>> {
        let (order, doubt) = (self.piva.accuracy.order, self.piva.accuracy.doubt());
        let (end, gap) = {
            let end = self.arrived(length);
            (end, with_order!(order, N => self.step().gap::<N>(&end, length, doubt)))
        };
        let contact = match gap {
            Gap { clear: true, .. } => {
                return Some(FastFlight { length, later: R::ZERO, end, meets: Meets::Nothing });
            }
            Gap { near: true, .. } => Side::Near,
            Gap { far: true, .. } => Side::Far,
            _ => return None,
        };
        let (h, exact) = {
            let far = contact == Side::Far;
            with_order!(order, N => self.step().meeting::<N>(&end, length, far))
        };
        exact.then(|| FastFlight {
            length: h,
            later: R::ZERO,
            end: self.arrival(h),
            meets: Meets::Near(contact),
        })
    }
}

/// Number of lengths of a flight that are tried without a search, each half of the one before.
pub(crate) const PARTS: u32 = 4;

/// Bound on |y⁗| of the series itself over a share of a step, in steps.
pub(crate) fn fourth_bound<R: Real>(y: &Row<R>, share: R) -> R {
    (4..=ORDER).rev().fold(R::ZERO, |sum, k| {
        let k_ = k as f64;
        sum * share + y[k].abs() * (k_ * (k_ - 1.0) * (k_ - 2.0) * (k_ - 3.0))
    })
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    /// A step short against every time scale: of the primary, of the pendulum, of its swing.
    fn longest_step(&self, state: &PivaState<Phase<H>, R>) -> R {
        R::from(self.accuracy.longest_step)
            / R::larger(self.fastest(), self.pendulum.swing(state.w.value))
    }
}

/// Gap displacement and velocity of a state, within the gap.
fn gap_of<P, R: Real>(state: &PivaState<P, R>) -> GapPoint<R> {
    let d = state.clearance;
    GapPoint { y: state.y().value.clamp(-d, d), w: state.gap_velocity() }
}

impl<R: Real, H: Host<Real = R>> Motion for PivaFlight<'_, H> {
    type Real = R;
    type State = PivaState<Phase<H>, R>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.reach
    }

    fn state(&self, h: R) -> Self::State {
        if h == 0.0 {
            return self.from;
        }
        let order = self.piva.accuracy.order;
        let state = with_order!(order, N => self.step().state::<N>(h));
        let phase = self.piva.host.free().nearly_within(&self.from.phase, h);
        PivaState { phase, ..state }
    }

    fn arrival(&self, h: R) -> Self::State {
        self.arrived(h)
    }

    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        if !R::FAST_PATHS || !self.proved {
            return None;
        }
        // Where bounds over the whole length decide nothing, those over a part of it may.
        let mut length = length;
        for _ in 0..PARTS {
            let flight = self.decided(length);
            if flight.is_some() {
                return flight;
            }
            length *= 0.5;
        }
        None
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        if !R::FAST_PATHS || !self.proved {
            return Turns::Unknown;
        }
        let order = self.piva.accuracy.order;
        let turning = with_order!(order, N => self.step().turning::<N>(end, length));
        turning.as_turns()
    }

    fn primary(&self, h: R) -> Jet<R> {
        let state = self.state(h);
        let series = self.beginning(&state);
        Jet {
            value: state.primary.x.value,
            rate: state.primary.v.value,
            curvature: series.u[1],
            jerk: series.u[2] * 2.0,
        }
    }

    fn acceleration(&self, h: R) -> R {
        self.beginning(&self.state(h)).a[0]
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        gap_of(&self.state(h))
    }

    fn seen(&self, h: R) -> Seen<Self::State, R> {
        let state = self.state(h);
        let Primary { x, v } = state.primary;
        let primary = Point { x: x.value, v: v.value };
        let acceleration = self.beginning(&state).a[0];
        Seen { state, primary, gap: gap_of(&state), acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn rows(&self) -> Option<Rows<R>> {
        let order = self.piva.accuracy.order;
        let base = self.drive.as_ref().map_or([R::ZERO; ORDER + 1], |drive| drive.base);
        let mut acceleration = self.series.a;
        acceleration[order] = R::ZERO;
        Some(Rows { step: self.step, order, x: self.series.x, acceleration, base })
    }

    fn travel(&self) -> Option<Travel<R>> {
        Some(Travel::new(self.rows()?, self.series.y, self.piva.pendulum.lever))
    }

    fn square(&self, h: [R; 2]) -> R {
        if let Some(known) = self.known.filter(|_| h == [R::ZERO, self.reach]) {
            return known.square;
        }
        let (ends, order) = (h.map(|h| self.share(h)), self.piva.accuracy.order);
        with_order!(order, N => square::<R, N>(&self.series.x, ends, self.step))
    }

    fn largest(&self, of: Quantity, least: R, length: R, _end: &Self::State) -> Option<R> {
        let known = self.known.filter(|_| length == self.reach)?;
        let limit = match of {
            Quantity::Displacement => known.limits[0],
            Quantity::Acceleration => known.limits[1],
        };
        (limit < least).then_some(least)
    }

    fn losses(&self, h: R) -> Losses<R> {
        if let Some(known) = self.known.filter(|_| h == self.reach) {
            return known.losses;
        }
        let (piva, order) = (self.piva, self.piva.accuracy.order);
        let Series { u, y, w, .. } = &self.series;
        let (pivots, base) = (piva.pendulum.pivot_damping != 0.0, piva.host.moves_base());
        let drive = self.drive.as_ref();
        let integrands = Integrands { u, y, w, drive, pivots, base };
        let (t, step) = (self.share(h), self.step);
        with_order!(order, N => integrands.taken::<N>(&piva.pendulum, t, step))
    }
}

impl<R: Real, H: Host<Real = R>> Curve for PivaFlight<'_, H> {
    type Real = R;

    fn jet(&self, h: R) -> Jet<R> {
        self.piva.distance(&self.state(h))
    }

    fn first(&self) -> Jet<R> {
        self.piva.distance(&self.from)
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let from = &self.from;
        let order = self.piva.accuracy.order;
        let cosine = self.step().precise_cosine();
        let mut series: Series<DoubleDouble<R>> = self.precise_series(cosine, self.step, order);
        if from.released {
            (series.w[1], series.y[2]) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
        }
        let t = DoubleDouble::new(h).over(self.step);
        let travelled = horner(&series.y[1..=order], t).times_sum(t);
        let s = from.wall.sign();
        from.distance.plus_parts(travelled.value * -s, travelled.rest * -s)
    }

    fn fourth(&self) -> R {
        let share = self.share(self.reach);
        // The bound is that of the series itself; its truncation error is part of the doubt.
        let fourth = fourth_bound(&self.series.y, share);
        let fourth = fourth / (self.step * self.step * self.step * self.step);
        if self.proved { fourth } else { R::NAN }
    }

    fn magnitude(&self) -> R {
        self.from.clearance
    }
}
