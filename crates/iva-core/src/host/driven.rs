//! A structure under force and base motion: its motion as a power series.
//!
//! From a state with A known in double-double,
//!
//! ```text
//! A = k (f/M − x) − c ẋ,    ẍ = A − a_g,    k = 1/m, c = 2ζ/m,
//! ```
//!
//! gives the coefficients of ∬A and of x one by one from those of f/M and a_g ([`crate::force`]). Unlike a
//! closed form it has no special case at resonance. Where the force is linear there is no resonance, and the motion is
//! that of the structure without drive about a uniform one (`host/driven/ramped.rs`). Gravity along the motion adds a constant to f/M and to
//! a_g (`host/driven/weight.rs`). Powers are those of t/`step`; `step` is a power of two, so that scaling is
//! exact. Terms up to h³ are computed in double-double, as in [`crate::host::oscillator`].
//!
//! The larger functions are inlined into their callers, so that these are compiled for the instructions of the machine; not
//! for WebAssembly, where a copy in every caller would only make the module larger.

use super::{Flown, HostState, Integrated, Structure};
use crate::force::Pushes;
use crate::host::oscillator::{Equation, Primary};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Jet, Quantity, Rows, Turns};
use crate::segment::quadrature::{mean_product, nodes, values};
use crate::segment::taylor::{ORDER, unrolled};

use bounds::bounds;

pub use host::DrivenHost;
pub use moment::Moment;
pub(crate) use pieces::{Block, Plain, Sums};
pub use pieces::{Pieces, Place};
pub use ramped::Ramped;
pub(crate) use series::Powers;
pub use source::{Forces, Source};
pub use weight::Weight;

mod bounds;
mod host;
mod measured;
mod moment;
mod pieces;
mod ramped;
mod series;
mod source;
mod weight;

/// Longest step in units of 1/(fastest rate of oscillator and force): the first dropped term is below
/// 1.2²¹/21! = 9e-19 of the motion.
const LONGEST: f64 = 1.2;

/// Number of nodes of the integrals over a step.
const NODES: usize = 8;

/// One mass on the spring and damper of a driven structure.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven<D: Source = Forces> {
    pub(crate) equation: Equation<D::Real>,
    pub(crate) source: D,
    /// Bounds on a_g and its first four derivatives.
    pub(crate) base: [D::Real; 5],
    pub(crate) reach: D::Real,
    /// Unit of time in the powers: a power of two.
    pub(crate) step: D::Real,
    /// Contribution of the drive to the bounds on A and its first six derivatives.
    pub(crate) excess: [D::Real; 7],
}

/// The power series of a motion; `None` where its ends are known in closed form, until they are needed.
#[derive(Debug, Clone, Copy)]
pub struct Course<R = f64>(Option<Powers<R>>);

impl<R: Real> Driven<Forces<R>> {
    fn new(mass: R, damping_ratio: R, source: &Forces<R>) -> Self {
        let equation = Equation::new(mass, damping_ratio);
        let force = &source.force;
        let reach = R::from(LONGEST * R::STEP) / equation.growth.max(force.fastest());
        let (base, excess) = bounds(&equation, source, reach);
        let step = R::power_of_two(reach);
        let source = source.on_mass(mass, damping_ratio);
        Self { equation, source, base, reach, step, excess }
    }
}

impl<R: Real, D: Source<Real = R>> Driven<D> {
    /// A motion of length h, with the drive at its end by `pushes`.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn moved(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        h: R,
        pushes: impl Fn(&Moment<R>, Clock<R>) -> Pushes<R>,
    ) -> Flown<Moment<R>, R> {
        let (primary, gained) = match self.source.ramped() {
            Some(ramped) => ramped.moved(from, self.source.moves_base(), h),
            None => self.summed(from, self.series_of(from, course, &mut None), h),
        };
        let time = from.phase.after(h);
        let phase = Moment { time, pushes: pushes(&from.phase, time), ..from.phase };
        let acceleration = self.acceleration(&phase, &primary);
        Flown { to: HostState { primary, acceleration, phase }, gained }
    }

    /// The absolute acceleration that belongs to A: A without gravity along the motion.
    #[inline(always)]
    pub(crate) fn without_gravity(&self, a: DoubleDouble<R>) -> DoubleDouble<R> {
        match self.source.weight() {
            None => a,
            Some(Weight { gravity, .. }) => a.plus(-gravity),
        }
    }

    /// ẍ = A − a_g − G. With gravity along the motion it may be small against A, so the difference is taken
    /// in double-double.
    #[inline(always)]
    pub(crate) fn relative(&self, a: DoubleDouble<R>, phase: &Moment<R>) -> R {
        let base = phase.pushes.base.value;
        match self.source.weight() {
            None => a.value - base.value,
            Some(_) => (a - base).value,
        }
    }

    /// The state of the drive at a later instant of the same smooth piece.
    #[inline(always)]
    fn at(&self, from: &Moment<R>, time: Clock<R>) -> Moment<R> {
        Moment { time, pushes: self.source.pushes(from, time), ..*from }
    }
}

impl<R: Real, D: Source<Real = R>> Structure for Driven<D> {
    type Real = R;
    type Phase = Moment<R>;
    type Course = Course<R>;

    fn equation(&self) -> &Equation<R> {
        &self.equation
    }

    #[inline]
    fn fast_course(&self, from: &HostState<Moment<R>, R>) -> Course<R> {
        if self.source.ramped().is_some() {
            return Course(None);
        }
        self.course(from)
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        self.source.moves_base()
    }

    #[inline(always)]
    fn course(&self, from: &HostState<Moment<R>, R>) -> Course<R> {
        // No closure: it would not be compiled for the instructions of its caller.
        Course(if self.source.ramped().is_none() { Some(self.expanded(from)) } else { None })
    }

    fn measured(&self, from: &HostState<Moment<R>, R>, course: &Course<R>) -> Option<Course<R>> {
        let missing = course.0.is_none();
        missing.then(|| Course(Some(self.expanded(from))))
    }

    #[inline(always)]
    fn reach(&self, from: &HostState<Moment<R>, R>) -> R {
        from.phase.smooth_for(self.reach)
    }

    #[inline(always)]
    fn flown(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        h: R,
    ) -> Flown<Moment<R>, R> {
        self.moved(
            from,
            course,
            h,
            #[inline(always)]
            |from, time| self.source.pushes(from, time),
        )
    }

    #[inline(always)]
    fn nearly_flown(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        h: R,
    ) -> Flown<Moment<R>, R> {
        self.moved(
            from,
            course,
            h,
            #[inline(always)]
            |from, time| self.source.plain_pushes(from, time),
        )
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn ahead(&self, from: &HostState<Moment<R>, R>, course: &Course<R>, h: R) -> [R; 3] {
        if let Some(ramped) = self.source.ramped() {
            return ramped.ahead(from, self.source.moves_base(), h);
        }
        let t = h / self.step;
        let series = self.series_of(from, course, &mut None).pulled;
        // ∬A, its derivative, and half the second one, in powers of t.
        let (mut sum, mut slope, mut bend) = (R::ZERO, R::ZERO, R::ZERO);
        unrolled!(k < ORDER - 1 => {
            bend = bend.mul_add(t, slope);
            slope = slope.mul_add(t, sum);
            sum = sum.mul_add(t, series[ORDER - k]);
        });
        // Of series = t² sum.
        let (twice, square) = (t + t, t * t);
        let rate = square.mul_add(slope, twice * sum);
        let second = square.mul_add(bend + bend, (twice + twice).mul_add(slope, sum + sum));
        let over = R::ONE / self.step;
        let gravity = self.source.weight().map_or(R::ZERO, |weight| weight.gravity);
        let fallen = gravity * h;
        let curved = (fallen * 0.5).mul_add(h, square * sum);
        [curved, rate.mul_add(over, fallen), second.mul_add(over * over, gravity)]
    }

    #[inline(always)]
    fn refresh(&self, state: &mut HostState<Moment<R>, R>) {
        if self.source.bends() {
            state.phase = self.renewed(&state.phase);
            state.acceleration = self.acceleration(&state.phase, &state.primary);
        }
    }

    fn jet(&self, from: &HostState<Moment<R>, R>, course: &Course<R>, h: R) -> Jet<R> {
        let Flown { to: HostState { primary, acceleration, phase }, .. } =
            self.flown(from, course, h);
        let [jerk, ..] = self.derivatives(&phase, primary.v.value, acceleration.value);
        let [_, base_rate, ..] = self.base(&phase);
        Jet {
            value: primary.x.value,
            rate: primary.v.value,
            curvature: self.relative(acceleration, &phase),
            jerk: jerk - base_rate,
        }
    }

    fn precise(&self, from: &HostState<Moment<R>, R>, h: R) -> DoubleDouble<R> {
        let Primary { x, v } = from.primary;
        let drive = self.source.precise(from.phase.time, h);
        let [pulled, _] = self.powers([x, v, from.acceleration], &drive, h);
        pulled[2..].iter().rev().fold(DoubleDouble::ZERO, |sum, term| sum + *term)
    }

    #[inline(always)]
    fn acceleration(&self, phase: &Moment<R>, primary: &Primary<R>) -> DoubleDouble<R> {
        let force = phase.pushes.primary.value;
        match self.source.weight() {
            None => self.equation.pull(force - primary.x, primary.v),
            Some(Weight { gravity, lift }) => {
                self.equation.pull(force + lift - primary.x, primary.v).plus(gravity)
            }
        }
    }

    #[inline(always)]
    fn derivatives(&self, phase: &Moment<R>, v: R, a: R) -> [R; 3] {
        let Equation { stiffness: k, damping: c, .. } = self.equation;
        let Pushes { primary: f, base: g } = &phase.pushes;
        let jerk = k * (f.rate.value - v) - c * (a - g.value.value);
        let snap = k * (f.second.value - (a - g.value.value)) - c * (jerk - g.rate.value);
        [jerk, snap, k * (f.third - (jerk - g.rate.value)) - c * (snap - g.second.value)]
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn later(&self, phase: &Moment<R>, h: R) -> Moment<R> {
        let later = self.at(phase, phase.time.plus(h));
        if later.is_over() { self.source.renewed(&later) } else { later }
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn within(&self, phase: &Moment<R>, h: R) -> Moment<R> {
        self.at(phase, phase.after(h))
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn nearly_within(&self, phase: &Moment<R>, h: R) -> Moment<R> {
        let time = phase.after(h);
        Moment { time, pushes: self.source.plain_pushes(phase, time), ..*phase }
    }

    #[inline(always)]
    fn renewed(&self, phase: &Moment<R>) -> Moment<R> {
        if self.source.bends() { self.source.renewed(phase) } else { *phase }
    }

    #[inline(always)]
    fn base(&self, phase: &Moment<R>) -> [R; 4] {
        let base = &phase.pushes.base;
        [base.value.value, base.rate.value, base.second.value, base.third]
    }

    #[inline(always)]
    fn largest_base(&self) -> R {
        self.base[0]
    }

    #[inline(always)]
    fn bound<const N: usize>(&self, primary: &Primary<R>) -> R {
        self.equation.bound::<N>(primary) + self.excess[N]
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn losses(&self, motion: &Integrated<'_, Self>, h: R) -> [R; 2] {
        self.taken_and_given(motion, h)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn square(&self, from: &HostState<Moment<R>, R>, course: &Course<R>, h: [R; 2]) -> R {
        let row = self.place(from, self.series_of(from, course, &mut None));
        let x = values::<ORDER, _, _, NODES>(&row, &nodes(h.map(|h| h / self.step)));
        mean_product(&x, &x) * (h[1] - h[0])
    }

    fn rows(&self, from: &HostState<Moment<R>, R>, course: &Course<R>) -> Option<Rows<R>> {
        Some(self.series(from, course))
    }

    fn series(&self, from: &HostState<Moment<R>, R>, course: &Course<R>) -> Rows<R> {
        let mut room = None;
        let powers = self.series_of(from, course, &mut room);
        let acceleration = self.acceleration_row(powers);
        let (x, base) = (self.place(from, powers), self.base_row(powers));
        Rows { step: self.step, order: ORDER, x, acceleration, base }
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn largest(
        &self,
        of: Quantity,
        least: R,
        (from, course): (&HostState<Moment<R>, R>, &Course<R>),
        end: &HostState<Moment<R>, R>,
        h: R,
    ) -> Option<R> {
        if self.at_most(of, [from, end], h) < least {
            return Some(least);
        }
        let [begin, end] = self.ends_of(from, end);
        let ends = [&begin, &end];
        let arc = self.arc(of, ends, &from.primary, h);
        if arc.limit() < least {
            return Some(least);
        }
        let mut room = None;
        let powers = self.series_of(from, course, &mut room);
        let row = match of {
            Quantity::Displacement => self.place(from, powers),
            Quantity::Acceleration => self.acceleration_row(powers),
        };
        self.extreme(of, ends, &from.primary, &row, h).largest(least)
    }

    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn turns(
        &self,
        from: &HostState<Moment<R>, R>,
        course: &Course<R>,
        end: &HostState<Moment<R>, R>,
        h: R,
    ) -> Turns<R> {
        let [begin, end] = self.ends_of(from, end);
        let ends = [&begin, &end];
        let (of, primary) = (Quantity::Displacement, &from.primary);
        let arc = self.arc(of, ends, primary, h);
        let row = self.place(from, self.series_of(from, course, &mut None));
        self.turned(of, &arc, ends, primary, &row, h).turns()
    }
}
