//! A structure without drive: its motion in closed form ([`crate::host::oscillator`]).

use std::sync::{Arc, OnceLock};

use super::sinusoid::MOST_DAMPED;
use super::steps::Steps;
use super::turning::{Jets, guess, turning};
use super::{Excitation, Flown, Host, HostState, Integrated, Sinusoidal, Structure};
use crate::host::oscillator::{Equation, Oscillator, Primary};
use crate::number::clock::Clock;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Jet, Rows, Turns};
use crate::segment::taylor::ORDER;

impl<R: Real> Structure for Oscillator<R> {
    type Real = R;
    type Phase = ();
    type Course = ();

    fn equation(&self) -> &Equation<R> {
        &self.equation
    }

    #[inline(always)]
    fn moves_base(&self) -> bool {
        false
    }

    #[inline(always)]
    fn course(&self, _from: &HostState<(), R>) {}

    #[inline(always)]
    fn reach(&self, _from: &HostState<(), R>) -> R {
        self.reach
    }

    #[inline(always)]
    fn flown(&self, from: &HostState<(), R>, _course: &(), h: R) -> Flown<(), R> {
        let (primary, gained) = from.primary.arrived(self, from.acceleration, h);
        let acceleration = Oscillator::acceleration(self, &primary);
        Flown { to: HostState { primary, acceleration, phase: () }, gained }
    }

    #[inline(always)]
    fn ahead(&self, from: &HostState<(), R>, _course: &(), h: R) -> [R; 3] {
        Oscillator::ahead(self, from.primary.v.value, from.acceleration.value, h)
    }

    #[inline(always)]
    fn jet(&self, from: &HostState<(), R>, _course: &(), h: R) -> Jet<R> {
        let Primary { x, v } = from.primary;
        Oscillator::jet(self, x.value, v.value, from.acceleration.value, h)
    }

    fn precise(&self, from: &HostState<(), R>, h: R) -> DoubleDouble<R> {
        Oscillator::precise(self, from.primary.v, from.acceleration, h)
    }

    #[inline(always)]
    fn acceleration(&self, _phase: &(), primary: &Primary<R>) -> DoubleDouble<R> {
        Oscillator::acceleration(self, primary)
    }

    #[inline(always)]
    fn derivatives(&self, _phase: &(), v: R, a: R) -> [R; 3] {
        let jerk = self.equation.next_derivative(v, a);
        let snap = self.equation.next_derivative(a, jerk);
        [jerk, snap, self.equation.next_derivative(jerk, snap)]
    }

    #[inline(always)]
    fn later(&self, _phase: &(), _h: R) {}

    #[inline(always)]
    fn within(&self, _phase: &(), _h: R) {}

    #[inline(always)]
    fn base(&self, _phase: &()) -> [R; 4] {
        [R::ZERO; 4]
    }

    /// |x⁽ⁿ⁺²⁾| ≤ Λⁿ⁺¹ρ.
    #[inline(always)]
    fn bound<const N: usize>(&self, primary: &Primary<R>) -> R {
        self.equation.bound::<N>(primary)
    }

    #[inline(always)]
    fn turns(
        &self,
        from: &HostState<(), R>,
        _course: &(),
        end: &HostState<(), R>,
        h: R,
    ) -> Turns<R> {
        let guess = guess(self.leading(from), self.leading(end), h);
        let sixth = self.equation.bound::<4>(&from.primary);
        let (h, x, exact) = turning(self.jets(from, guess), sixth, guess, h);
        if exact { Turns::Once(h, x) } else { Turns::Unknown }
    }

    fn series(&self, from: &HostState<(), R>, _course: &()) -> Rows<R> {
        let Equation { stiffness, damping, .. } = self.equation;
        let zero = [R::ZERO; ORDER + 1];
        let (mut x, mut v, mut acceleration) = (zero, zero, zero);
        (x[0], v[0]) = (from.primary.x.value, from.primary.v.value);
        acceleration[0] = from.acceleration.value;
        for k in 0..ORDER {
            let over = R::reciprocal(k + 1);
            (x[k + 1], v[k + 1]) = (v[k] * over, acceleration[k] * over);
            acceleration[k + 1] = -(stiffness * x[k + 1] + damping * v[k + 1]);
        }
        Rows { step: R::ONE, order: ORDER, x, acceleration, base: zero }
    }

    #[inline(always)]
    fn losses(&self, motion: &Integrated<'_, Self>, h: R) -> [R; 2] {
        let Primary { x, v } = motion.from.primary;
        [self.viscous_loss(x.value, v.value, h), R::ZERO]
    }
}

impl<R: Real> Oscillator<R> {
    /// ẋ, ẍ and x⃛ of a state.
    #[inline(always)]
    pub(crate) fn leading(&self, state: &HostState<(), R>) -> [R; 3] {
        let (v, a) = (state.primary.v.value, state.acceleration.value);
        [v, a, self.equation.next_derivative(v, a)]
    }

    /// x and its first five derivatives a time h after a state.
    #[inline(always)]
    pub(crate) fn jets(&self, from: &HostState<(), R>, h: R) -> Jets<R> {
        let Jet { value, rate, curvature, jerk } = Structure::jet(self, from, &(), h);
        let snap = self.equation.next_derivative(curvature, jerk);
        [value, rate, curvature, jerk, snap, self.equation.next_derivative(jerk, snap)]
    }
}

/// A structure without drive, for an absorber of a given mass ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct UndrivenHost<R = f64> {
    damping_ratio: R,
    mass_ratio: R,
    /// The structure without absorber; made by the first flight, and shared between scenes that run side by
    /// side.
    free: OnceLock<Arc<Oscillator<R>>>,
    /// Its motion over whole steps; `None` if it has none.
    steps: OnceLock<Option<Arc<Steps<R>>>>,
    /// The structure of mass 1 + μ; made when the absorber first sticks.
    loaded: OnceLock<Box<Oscillator<R>>>,
}

impl<R: Real> UndrivenHost<R> {
    /// A structure of damping ratio ζ, for an absorber of mass ratio μ.
    pub(crate) fn new(damping_ratio: R, mass_ratio: R) -> Self {
        let (free, steps) = (OnceLock::new(), OnceLock::new());
        Self { damping_ratio, mass_ratio, free, steps, loaded: OnceLock::new() }
    }

    fn shared_steps(&self) -> &Option<Arc<Steps<R>>> {
        let steps = || {
            let has = R::FAST_PATHS && self.damping_ratio <= MOST_DAMPED;
            has.then(|| Arc::new(Steps::new(self.shared())))
        };
        self.steps.get_or_init(steps)
    }

    fn shared(&self) -> &Arc<Oscillator<R>> {
        self.free.get_or_init(|| Arc::new(Oscillator::new(R::ONE, self.damping_ratio)))
    }
}

impl<R: Real> Excitation for UndrivenHost<R> {
    type Real = R;
    type Phase = ();
}

impl<R: Real> Host for UndrivenHost<R> {
    type Structure = Oscillator<R>;

    fn share(&self, like: &Self) {
        // Made before the cell is initialised: a host may share with itself.
        let (free, steps) = (Arc::clone(like.shared()), like.shared_steps().clone());
        self.free.get_or_init(|| free);
        self.steps.get_or_init(|| steps);
    }

    fn damping_ratio(&self) -> R {
        self.damping_ratio
    }

    fn carrying(&self, mass_ratio: R) -> Self {
        Self::new(self.damping_ratio, mass_ratio)
    }

    fn sinusoidal(&self) -> Option<Sinusoidal> {
        Sinusoidal::of([self.damping_ratio, self.mass_ratio, R::ZERO])
    }

    #[inline(always)]
    fn free(&self) -> &Oscillator<R> {
        self.shared()
    }

    fn steps(&self) -> Option<&Steps<R>> {
        self.shared_steps().as_deref()
    }

    fn loaded(&self) -> &Oscillator<R> {
        self.loaded
            .get_or_init(|| Box::new(Oscillator::new(R::ONE + self.mass_ratio, self.damping_ratio)))
    }

    #[inline(always)]
    fn begin_at(&self, _time: Clock<R>) {}

    #[inline(always)]
    fn balanced(&self, _phase: &(), v: DoubleDouble<R>) -> DoubleDouble<R> {
        v.times(-self.free().equation.damping)
    }
}
