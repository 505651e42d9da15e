//! The impact law of primary and pendulum: conservation of momentum and restitution, or the law as the paper
//! prints it.

use super::parameters::{ImpactLaw, Parameters};
use super::{Piva, PivaState};
use crate::absorber::impact::{Impact, primary_share};
use crate::absorber::{Absorber, LawAt, Wall};
use crate::host::Host;
use crate::host::oscillator::Primary;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::segment::flight::Jet;
use crate::segment::taylor::Pendulum;

/// The impact law at one wall, in terms of W = b θ̇.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law<R = f64> {
    /// Newton's coefficient e on the gap velocity.
    pub restitution: R,
    mass_ratio: R,
    /// μλ, λ = L/b
    pull: R,
    /// μκλ²
    inertia: R,
    /// μκλ² − (μλ cosθ)²/(1 + μ), the effective inertia in an impact.
    effective: R,
    /// cosθ at the walls.
    cosine: R,
    /// W⁺ = −ratio · W⁻: e, or 2μe/(1 + μ) as printed in Eq. 17.
    pub ratio: R,
    /// `ratio` in double-double.
    pub rebound: DoubleDouble<R>,
    /// Velocity that the primary gains in an impact, per W⁻.
    impact_gain: DoubleDouble<R>,
    /// Velocity that the primary gains in a whole tail of rebounds, per W at its begin.
    stick_gain: DoubleDouble<R>,
    /// Velocity of the centre of mass that the printed law removes in a whole tail, per W at its begin; 0
    /// where momentum is conserved.
    surplus: DoubleDouble<R>,
    /// True for the printed law, whose energy losses need the general formula.
    printed: bool,
    /// See [`crate::absorber::LawAt`].
    pub pressure_gain: R,
}

laned!(
    Law,
    Laws {
        restitution: f64,
        mass_ratio: f64,
        pull: f64,
        inertia: f64,
        effective: f64,
        cosine: f64,
        ratio: f64,
        rebound: DoubleDouble,
        impact_gain: DoubleDouble,
        stick_gain: DoubleDouble,
        surplus: DoubleDouble,
        printed: bool,
        pressure_gain: f64,
    }
);

impl<R: Real> Law<R> {
    /// The law with restitution e.
    pub fn new(
        p: &Parameters<R>,
        e: R,
        pendulum: &Pendulum<R>,
        wall_cosine: DoubleDouble<R>,
    ) -> Self {
        let (mu, lever) = (p.mass_ratio, pendulum.lever);
        let share = |e| primary_share(mu, e).times(lever);
        let (rebound, impact_gain, surplus) = match p.impact_law {
            ImpactLaw::Consistent => {
                (DoubleDouble::new(e), share(e).times_sum(wall_cosine), DoubleDouble::ZERO)
            }
            ImpactLaw::Printed => {
                // Each rebound changes the momentum; the first impact of the tail is with −W.
                let one = DoubleDouble::new(R::ONE);
                let ratio = DoubleDouble::new(mu * 2.0).times(e).over_sum(one.plus(mu));
                let over = one.plus(e) - wall_cosine * (one + ratio);
                (ratio, share(e), share(R::ZERO) * over / (one - ratio))
            }
        };
        let cosine = wall_cosine.value;
        // In this form nothing cancels, however heavy the absorber: κ − cos²θ is exact.
        let sine = if pendulum.small_angles { R::ZERO } else { p.clearance / p.contact_distance };
        let free = (p.inertia_ratio - 1.0) + if cosine > 0.0 { sine * sine } else { R::ONE };
        let effective = mu * (lever * lever) * ((p.inertia_ratio + mu * free) / (R::ONE + mu));
        let law = Self {
            restitution: e,
            effective,
            mass_ratio: mu,
            pull: mu * lever,
            inertia: mu * p.inertia_ratio * (lever * lever),
            cosine,
            ratio: rebound.value,
            rebound,
            impact_gain,
            stick_gain: share(R::ZERO).times_sum(wall_cosine) - surplus,
            surplus,
            printed: p.impact_law == ImpactLaw::Printed,
            pressure_gain: R::ZERO,
        };
        Self { pressure_gain: law.pressure_gain(pendulum), ..law }
    }

    /// Velocity that the primary gains in an impact, per W.
    pub fn impact_gain(&self) -> R {
        self.impact_gain.value
    }

    /// Velocity that the primary gains in a whole tail of rebounds, per W at its begin.
    pub fn stick_gain(&self) -> R {
        self.stick_gain.value
    }

    /// Velocity that the primary gains in an impact with W.
    #[inline(always)]
    pub fn impact(&self, w: DoubleDouble<R>) -> DoubleDouble<R> {
        w.times_sum(self.impact_gain)
    }

    /// Velocity that the primary gains in the whole tail of rebounds that begins with W.
    pub fn stick(&self, w: DoubleDouble<R>) -> DoubleDouble<R> {
        w.times_sum(self.stick_gain)
    }

    /// Corrections of the displacement and velocity of the primary after the tail of rebounds that begins
    /// with W, beyond [`Law::stick`], to second order in W: the printed law removes momentum rebound by
    /// rebound, and not at once as in a stick.
    ///
    /// A rebound of speed u lasts 2u/A, during which the surplus momentum of it and of all later rebounds is
    /// still present, and returns with u (1 − ⅔ J u/A²) (see [`crate::absorber::chatter`]); meanwhile `damping` acts on
    /// it.
    pub fn surplus_of_tail(&self, w: DoubleDouble<R>, leave: &Jet<R>, damping: R) -> [R; 2] {
        if self.surplus.value == 0.0 || w.value == 0.0 {
            return [R::ZERO; 2];
        }
        let (pressure, squares) = (-leave.curvature, (R::ONE - self.ratio) * (R::ONE + self.ratio));
        let farther = self.surplus.value * w.value * (leave.rate * 2.0 / (pressure * squares));
        [farther, farther * (leave.jerk / (pressure * 3.0) - damping)]
    }

    /// Energy lost in an impact with W at primary velocity v.
    #[inline(always)]
    pub fn impact_loss(&self, v: R, w: R) -> R {
        let printed = self.difference(v, w, self.impact_gain.value, self.ratio);
        pick(self.printed, printed, self.consistent_loss(w, self.restitution))
    }

    /// Energy lost in the whole tail of rebounds that begins with W.
    pub fn stick_loss(&self, v: R, w: R) -> R {
        if self.printed {
            self.difference(v, w, self.stick_gain.value, R::ZERO)
        } else {
            self.consistent_loss(w, R::ZERO)
        }
    }

    /// The loss ½ μ (1 − e²)(λ W)² [κ − μ c²/(1 + μ)] of the consistent law.
    #[inline(always)]
    fn consistent_loss(&self, w: R, e: R) -> R {
        ((R::ONE - e) * (R::ONE + e)) * 0.5 * (w * w) * self.effective
    }

    /// Kinetic energy before minus kinetic energy after the change v → v + gain W, W → −ratio W.
    #[inline(always)]
    fn difference(&self, v: R, w: R, gain: R, ratio: R) -> R {
        let (total, pull) = (R::ONE + self.mass_ratio, self.pull * self.cosine);
        let linear = pull * (R::ONE + ratio) - total * gain;
        let square = pull * gain * ratio - total * 0.5 * (gain * gain)
            + self.inertia * 0.5 * ((R::ONE - ratio) * (R::ONE + ratio));
        w * (v * linear + w * square)
    }

    /// Rise of the pressure on the wall at an impact of unit approach speed: the dampers of primary and pivot
    /// respond to the jumps of u and W.
    fn pressure_gain(&self, pendulum: &Pendulum<R>) -> R {
        let Pendulum { damping_ratio, coupling, pivot_damping, .. } = *pendulum;
        let c = self.cosine;
        if c == 0.0 {
            return R::ZERO;
        }
        let jump_u = self.impact_gain.value / c;
        let jump_w = -(R::ONE + self.ratio) / c;
        let inertia = R::ONE + self.mass_ratio - self.pull * coupling * (c * c);
        let jump_a =
            (-damping_ratio * 2.0 * jump_u + self.pull * c * pivot_damping * jump_w) / inertia;
        -c * (coupling * c * jump_a + pivot_damping * jump_w)
    }
}

impl<R: Real, H: Host<Real = R>> crate::absorber::ImpactLaw for Piva<H> {
    /// The gain of the law is per W; divided by cosθ it is per gap velocity W cosθ.
    fn law_of(&self, _absorber: usize, wall: Wall, _approach: R) -> LawAt<R> {
        let law = self.law(wall);
        let gain = law.impact_gain() / self.stops.cosine.value;
        LawAt::constant(law.restitution, law.ratio, gain, law.pressure_gain)
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        self.law(state.wall).struck(state, time, self.pendulum.lever)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        let (v, law) = (state.primary.v, self.law(state.wall));
        let gained = law.stick(state.w);
        let Parameters { mass_ratio, damping_ratio, .. } = self.parameters;
        let damping = damping_ratio * 2.0 / (R::ONE + mass_ratio);
        let [farther, faster] = law.surplus_of_tail(state.w, &self.distance(state), damping);
        let stuck = PivaState {
            primary: Primary { x: state.primary.x.plus(farther), v: (v + gained).plus(faster) },
            distance: DoubleDouble::ZERO,
            w: DoubleDouble::ZERO,
            ..*state
        };
        (stuck, law.stick_loss(v.value, state.w.value))
    }
}
