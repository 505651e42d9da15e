//! Pendulums among the members.
//!
//! A pendulum hangs from its point between two stops. Its gap displacement y = b sinθ, its walls, its law of restitution and the place in its gap are those of
//! a mass; what it has beyond is how it swings ([`crate::segment::taylor`]):
//!
//! ```text
//! Ẇ = −(β A c + r² y + σ² φ + ν W + s R),    ẏ = c W,    W = b θ̇,    c = cosθ,    A = ü + a_g at its point,
//! ```
//!
//! with s R of the friction in its pivot (`modal/friction.rs`), and that it pulls at its point with −μ (A + λ ÿ), λ = L/b: as if a part η = μ (1 − c²/κ) of its mass were fixed to the point, and as a force beside.
//! Where an impact or an impulse changes u̇ by Δu̇, a pendulum in flight takes the part η of its mass along and follows by Δẏ = −β c² Δu̇.
//! On a wall all of its mass is carried, and what it would do if it were free, −ÿ = β c² A + c (r² y + σ² φ), takes the place of the acceleration of a mass.
//!
//! Where the structure and its base move along a line that rises by α, γ = cos(θ − α) takes the place of c beside A, and ṗ = γ W that of ẏ in its pull
//! (`segment/taylor/pivoted.rs`). So η = μ (1 − γ²/κ), a pendulum in flight follows by Δẏ = −β c γ Δu̇, and its lever is λ γ/c, which may be 0 or negative:
//! what presses a pendulum on its wall then is not what presses on the structure, and signs of impulses count with that of γ.

use super::state::Place;
use super::structure::same;
use super::{Modal, ModalState};
use crate::absorber::piva::{Angles, Parameters};
use crate::absorber::{Angle, Wall};
use crate::error::{Invalid, number};
use crate::host::{Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Pendulum, Posture};

/// A pendulum with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hanging<R> {
    pub parameters: Parameters<R>,
    pub pendulum: Pendulum<R>,
}

/// A share of an inertia below which nothing is fixed to the point: its reciprocal would overflow.
const NO_INERTIA: f64 = 1e-200;

impl<R: Real, const N: usize, const M: usize> Modal<UndrivenHost<R>, N, M> {
    /// The same members, some of which are pendulums: of their parameters all count but damping ratio of the structure, clearance, restitution and tolerance,
    /// which are those of the member.
    ///
    /// # Errors
    /// [`Invalid`] for a number out of its range, for stops that the pendulum cannot reach, for the impact law as the paper prints it, and for parameters that are not
    /// as many as members.
    pub fn with_pendulums(mut self, pendulums: &[Option<Parameters<R>>]) -> Result<Self, Invalid> {
        same("absorber.kind", pendulums.len(), self.count())?;
        if pendulums.iter().all(Option::is_none) {
            return Ok(self);
        }
        self.pendulums = vec![None; self.count()];
        for (k, parameters) in pendulums.iter().enumerate() {
            let Some(parameters) = parameters else { continue };
            let field = |name: &str| format!("absorber.{k}.{name}");
            let mass = &self.masses[k];
            if self.on_ground(k) {
                let rule = "a stop on the ground is no pendulum";
                return Err(Invalid::new(field("kind"), "piva", rule));
            }
            let parameters = Parameters {
                mass_ratio: mass.mass_ratio,
                clearance: mass.clearance,
                restitution: R::ZERO,
                damping_ratio: R::ZERO,
                tolerance: R::ZERO,
                ..*parameters
            };
            parameters.check().map_err(|error| {
                let name = error.field.strip_prefix("absorber.").unwrap_or(&error.field);
                Invalid { field: field(name), ..error }
            })?;
            if parameters.impact_law == crate::absorber::piva::ImpactLaw::Printed {
                let rule = "beside other absorbers, and on modes, pendulums have the consistent impact law";
                return Err(Invalid::new(field("impact_law"), "\"printed\"", rule));
            }
            let most = parameters.contact_distance - mass.offset.abs();
            let far = |wall: R| wall.is_finite() && wall.abs() >= parameters.contact_distance;
            if parameters.angles == Angles::Large && mass.walls().into_iter().any(far) {
                let rule = format!(
                    "beside other absorbers, and on modes, a pendulum must reach its stops: give less than {}",
                    number(most)
                );
                return Err(Invalid::new(field("clearance"), number(mass.clearance), rule));
            }
            let pendulum = parameters.pendulum();
            self.pendulums[k] = Some(Hanging { parameters, pendulum });
        }
        Ok(self.completed())
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The parameters of a pendulum; `None` of a mass.
    pub fn pendulum(&self, absorber: usize) -> Option<&Parameters<R>> {
        self.pendulums.get(absorber)?.as_ref().map(|it| &it.parameters)
    }

    /// The constants of a pendulum.
    #[inline(always)]
    pub(super) fn hanging(&self, k: usize) -> Option<&Pendulum<R>> {
        self.pendulums.get(k)?.as_ref().map(|it| &it.pendulum)
    }

    /// The pendulums that swing while the members have these places.
    pub(super) fn swinging<'a>(
        &'a self,
        places: &'a [Place<R>; N],
    ) -> impl Iterator<Item = (usize, &'a Pendulum<R>)> {
        let all = if self.swings() { self.count() } else { 0 };
        let flying = (0..all).filter(|k| !places[*k].carried());
        flying.filter_map(|k| Some((k, self.hanging(k)?)))
    }

    /// y in double-double.
    pub(super) fn gap_of_place(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        let mass = &self.masses[k];
        let left = DoubleDouble::new(mass.clearance) - place.distance;
        DoubleDouble { value: place.side * left.value, rest: place.side * left.rest }
            .plus(mass.offset)
    }

    /// How a pendulum hangs, to twice the precision.
    pub(super) fn posture(
        &self,
        k: usize,
        is: &Pendulum<R>,
        place: &Place<R>,
    ) -> Posture<DoubleDouble<R>> {
        let y = self.gap_of_place(k, place);
        let c = is.precise_cosine(y);
        let rate = place.rate.over_sum(c);
        let w = DoubleDouble { value: -place.side * rate.value, rest: -place.side * rate.rest };
        Posture { y, w, c, arc: is.arc(y, c) }
    }

    /// W in plain numbers.
    pub(super) fn turning(&self, k: usize, is: &Pendulum<R>, place: &Place<R>) -> R {
        -place.side * place.rate.value / self.cosine(k, is, place)
    }

    /// The same pendulums, where structure and base move along a line that rises by an angle, in rad, at the point of each.
    ///
    /// # Errors
    /// [`Invalid`] for an angle out of 0 to π/2, for a pendulum of small angles, and for numbers that are not as many as members. Those of masses, and of stops, have no effect.
    pub fn with_rising_pivots(mut self, angles: &[DoubleDouble<R>]) -> Result<Self, Invalid> {
        same("absorber.inclination", angles.len(), self.count())?;
        let bodies = || self.tied.iter().flatten().filter(|it| it.row.is_some());
        let on_bodies: Vec<bool> =
            (0..self.count()).map(|k| bodies().any(|body| self.rides_on(k, body))).collect();
        for (k, (own, angle)) in self.pendulums.iter_mut().zip(angles).enumerate() {
            let Some(Hanging { pendulum, .. }) = own else { continue };
            let wrong =
                |rule| Invalid::new(format!("absorber.{k}.inclination"), number(angle.value), rule);
            let from_upright = (R::TURN.over(4.0) - *angle).value;
            // Upright the cosine of an angle in degrees is a rounding error.
            let upright = from_upright.abs() <= R::EPSILON * 4.0;
            if !(angle.value >= 0.0 && (upright || from_upright > 0.0)) {
                return Err(wrong("give an angle from 0 (level) to π/2 (upright)"));
            }
            if angle.value != 0.0 && on_bodies[k] {
                return Err(wrong("a pendulum that hangs from another absorber moves level"));
            }
            if angle.value != 0.0 && pendulum.small_angles {
                return Err(wrong("give angles = \"large\" with it"));
            }
            let (sine, cosine) = R::precise_sincos(*angle);
            pendulum.level = if upright { R::ZERO } else { cosine.value };
            pendulum.rise = if angle.value == 0.0 { R::ZERO } else { sine.value };
        }
        Ok(self.completed())
    }

    /// The angle by which the line rises on which the pivot of a pendulum moves, in rad; 0 for any other member.
    pub fn inclination_of(&self, absorber: usize) -> R {
        let of = |it: &Hanging<R>| R::atan2(it.pendulum.rise, it.pendulum.level);
        self.pendulums.get(absorber).and_then(Option::as_ref).map_or(R::ZERO, of)
    }

    /// γ.
    pub(super) fn lean(&self, k: usize, is: &Pendulum<R>, place: &Place<R>) -> R {
        let y = self.gap_of_place(k, place).value;
        is.lean(y, is.cosine(y))
    }

    /// True if a pendulum has swung to the horizontal, which no stop keeps it from: beyond, its place is no longer told by its gap.
    pub(super) fn is_turned_level(&self, k: usize, is: &Pendulum<R>, c: R) -> bool {
        c <= 0.0 && !is.small_angles && self.masses[k].only.is_some()
    }

    /// c.
    fn cosine(&self, k: usize, is: &Pendulum<R>, place: &Place<R>) -> R {
        is.cosine(self.gap_of_place(k, place).value)
    }

    /// How far a member goes in its gap per arc of its stop: c of a pendulum, 1 of a mass.
    pub(super) fn turned_by(&self, k: usize, place: &Place<R>) -> R {
        self.hanging(k).map_or(R::ONE, |is| self.cosine(k, is, place))
    }

    /// By how much less a member accelerates away from its point than a free mass: β c γ of a pendulum.
    pub(super) fn follows(&self, k: usize, place: &Place<R>) -> R {
        self.hanging(k).map_or(R::ONE, |is| {
            let y = self.gap_of_place(k, place).value;
            let c = is.cosine(y);
            is.coupling * (c * is.lean(y, c))
        })
    }

    /// [`Modal::follows`] to twice the precision.
    pub(super) fn follows_precisely(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        self.hanging(k).map_or(DoubleDouble::new(R::ONE), |is| {
            let y = self.gap_of_place(k, place);
            let c = is.precise_cosine(y);
            (c * is.lean(y, c)).times(is.coupling)
        })
    }

    /// The place of a member that touches a wall.
    pub(super) fn at_wall(&self, k: usize, wall: Wall) -> Place<R> {
        let far = Place { side: R::from(wall.sign()), ..Place::FAR };
        debug_assert!(k < self.count(), "a wall of a member");
        Place { distance: DoubleDouble::ZERO, ..far }
    }

    /// c (r² y + σ² φ): how gravity and the spring in its pivot pull a pendulum back that is on a wall; 0 for a mass.
    pub(super) fn drawn(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        let Some(is) = self.hanging(k) else { return DoubleDouble::ZERO };
        let Posture { y, c, arc, .. } = self.posture(k, is, place);
        (y.times(is.frequency_squared) + arc.times(is.spring.acting())) * c
    }

    /// How much further than in its gap the centre of mass of a member moves along the line of its point: λ γ/c of a pendulum, λ = L/b.
    pub(super) fn lever(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        let Some(is) = self.hanging(k) else { return DoubleDouble::new(R::ONE) };
        let lever = DoubleDouble::new(is.lever);
        if is.rise == 0.0 {
            return lever;
        }
        let y = self.gap_of_place(k, place);
        let c = is.precise_cosine(y);
        lever * (is.lean(y, c) / c)
    }

    /// With which sign the push of its point presses a stuck member on wall +: that of γ.
    pub(super) fn pressed_with(&self, k: usize, place: &Place<R>) -> R {
        match self.hanging(k) {
            Some(is) if is.rise != 0.0 => self.lean(k, is, place),
            _ => R::ONE,
        }
    }

    /// The reciprocal of the inertia that moves with the point: that of a member which is carried along or has an impact, or of the part η of a pendulum in flight.
    /// `None` if there is no such inertia.
    pub(super) fn inertia_over(
        &self,
        k: usize,
        place: &Place<R>,
        whole: bool,
    ) -> Option<DoubleDouble<R>> {
        if whole {
            return Some(self.lightness(k));
        }
        let is = self.hanging(k)?;
        let y = self.gap_of_place(k, place);
        let c = if is.rise == 0.0 { DoubleDouble::new(R::ONE) } else { is.precise_cosine(y) };
        let own: DoubleDouble<R> = is.own_inertia(y, c);
        (own.value > NO_INERTIA).then(|| DoubleDouble::new(R::ONE) / own)
    }

    /// The energy of a pendulum in a place, whose point has a velocity v.
    pub(super) fn energy_of_pendulum(
        &self,
        k: usize,
        is: &Pendulum<R>,
        place: &Place<R>,
        v: R,
    ) -> R {
        let Posture { y, w, c, arc } = self.posture(k, is, place);
        let (y, w, c) = (y.value, w.value, c.value);
        let Pendulum { mass_ratio, inertia_ratio, lever, .. } = *is;
        let own = inertia_ratio * (lever * lever);
        let swept = v * v + v * 2.0 * lever * (is.lean(y, c) * w) + own * (w * w);
        // 1 − cosθ without cancellation; θ²/2 at small angles, where r² contains the spring.
        let risen = is.frequency_squared * (y * y) * 2.0 / (R::ONE + c);
        let wound = is.spring.acting() * (arc.value * arc.value);
        mass_ratio * 0.5 * (swept + own * (risen + wound))
    }

    /// Angle and angular velocity of a pendulum.
    pub(super) fn angle_of(&self, state: &ModalState<H, N, M>, k: usize) -> Option<Angle<R>> {
        self.angle_at(k, &state.places[k])
    }

    /// Those in a place.
    pub(super) fn angle_at(&self, k: usize, place: &Place<R>) -> Option<Angle<R>> {
        let is = self.hanging(k)?;
        let Posture { y, w, c, .. } = self.posture(k, is, place);
        let over_b = R::ONE / is.contact_distance;
        let sine = y.value * over_b;
        let value = if is.small_angles { sine } else { R::atan2(sine, c.value) };
        Some(Angle { value, rate: w.value * over_b })
    }
}
