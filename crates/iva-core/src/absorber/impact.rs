//! The impact law of two masses (paper, Eqs. 9–14): momentum is conserved and the gap velocity w
//! turns into −e w.
//!
//! This file holds the formulas. The event loop asks each absorber for its law by the trait
//! [`ImpactLaw`](crate::absorber::ImpactLaw). The law of a free mass at one wall, with the energy lost, is `Law` in
//! `absorber/siva/impact_law.rs`, which also has the trait. It is applied by `collided` (`absorber/siva/state.rs`) in
//! double-double, and by `struck` in `absorber/plain/mass.rs` in the fast tier; the energy that it takes by `commit` in
//! `run/free_mass/round.rs` and the record of an impact by `run/free_mass/listing.rs`, both for lanes. The law of a pendulum is `Law` in `absorber/piva/impact_law.rs`, applied in
//! `absorber/piva/contact.rs`. Sticks are impacts with e = 0, in `stick` of the same files. The derivatives are in
//! `absorber/derivatives`.
//!
//! The e of a free mass may depend on the approach speed, by a [`RestitutionLaw`](crate::absorber::restitution::RestitutionLaw)
//! at each wall: `FreeMass::law_for` gives the `Law` of an impact, `FreeMass::law_at` tells it to chatters and derivatives
//! ([`LawAt`](crate::absorber::LawAt)). The sum of a chatter waits until e changes by less than rounding, or until what is
//! proved of a power law is below it ([`crate::absorber::chatter::power`]). Lanes read a constant e; such masses run in the
//! event loop. `tests/rust/src/speed_law.rs` is a law outside the core: a free mass in another coat, with its own
//! `ImpactLaw`, which hands everything else on.
//!
//! The primary gains [`primary_share`] · w, and the pair loses [`energy_loss`]. The paper's conditions for an
//! impact (Eqs. 7, 8) lack the approach condition wall · w > 0; the event loop requires it.

use crate::absorber::{Point, Wall};
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};

/// μ(1 + e)/(1 + μ): the share of the gap velocity that the primary gains (Eq. 13), in double-double.
///
/// At e = 1 an error of half a unit in the last place of the share would make the energy drift from impact to
/// impact.
pub fn primary_share<R: Real>(mass_ratio: R, restitution: R) -> DoubleDouble<R> {
    share_of(mass_ratio, restitution, DoubleDouble::new(R::ONE).plus(mass_ratio))
}

/// μ(1 + e) over a mass: [`primary_share`], where all that moves together during the impact has that mass.
pub(crate) fn share_of<R: Real>(
    mass_ratio: R,
    restitution: R,
    together: DoubleDouble<R>,
) -> DoubleDouble<R> {
    DoubleDouble::new(R::ONE).plus(restitution).times(mass_ratio).over_sum(together)
}

/// Energy lost in an impact, ½ μ/(1 + μ) (1 − e²) w², per primary mass.
#[inline]
pub fn energy_loss<R: Real>(mass_ratio: R, restitution: R, approach: R) -> R {
    mass_ratio * 0.5 / (R::ONE + mass_ratio)
        * ((R::ONE - restitution) * (R::ONE + restitution))
        * (approach * approach)
}

/// Time in 1/ωn in which the small distance left over by rounding is covered at constant rate; 0 if the rate
/// would change noticeably in that time, as in a grazing.
#[inline(always)]
pub fn delay<R: Real>(left: R, rate: R, curvature: R) -> R {
    let delay = -left / rate;
    let steady = ((curvature * delay).abs() <= rate.abs() * SHORT) & (rate != 0.0);
    pick(steady, delay, R::ZERO)
}

/// Largest relative change of the rate for which [`delay`] is used.
const SHORT: f64 = 1e-6;

/// One impact of a run, in natural units: time in 1/ωn, velocities in ωn × length, energies per
/// primary mass in ωn² × length².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact<R = f64> {
    /// Instant of the impact.
    pub time: R,
    /// The index of the absorber.
    pub absorber: u8,
    /// The wall that was hit.
    pub wall: Wall,
    /// Displacement of the primary.
    pub displacement: R,
    /// Primary velocity just before.
    pub velocity_before: R,
    /// Primary velocity just after.
    pub velocity_after: R,
    /// Gap velocity just before: the signed approach velocity.
    pub gap_velocity_before: R,
    /// Gap velocity just after.
    pub gap_velocity_after: R,
    /// Velocity of the absorber's centre of mass per gap velocity: 1 for a free mass, L/b for a
    /// pendulum.
    pub lever: R,
    /// Energy lost in the impact.
    pub energy_loss: R,
}

laned!(
    Impact,
    Impacts {
        time: f64,
        wall: Wall,
        displacement: f64,
        velocity_before: f64,
        velocity_after: f64,
        gap_velocity_before: f64,
        gap_velocity_after: f64,
        lever: f64,
        energy_loss: f64,
    }
    absorber = 0
);

impl<R: Real> Impact<R> {
    /// The impact of a free mass of mass ratio μ with restitution e, from the state of the primary and the
    /// gap velocity w before the impact.
    pub fn of_free_mass(
        [mass_ratio, restitution]: [R; 2],
        time: R,
        wall: Wall,
        Point { x, v }: Point<R>,
        w: R,
    ) -> Self {
        Self {
            time,
            absorber: 0,
            wall,
            displacement: x,
            velocity_before: v,
            velocity_after: v + primary_share(mass_ratio, restitution).value * w,
            gap_velocity_before: w,
            gap_velocity_after: -restitution * w,
            lever: R::ONE,
            energy_loss: energy_loss(mass_ratio, restitution, w),
        }
    }

    /// Absolute horizontal velocity of the absorber's centre of mass just before.
    #[inline]
    pub fn absorber_velocity_before(&self) -> R {
        self.velocity_before + self.lever * self.gap_velocity_before
    }

    /// Absolute horizontal velocity of the absorber's centre of mass just after.
    pub fn absorber_velocity_after(&self) -> R {
        self.velocity_after + self.lever * self.gap_velocity_after
    }

    /// Size of the gap velocity just before.
    #[inline]
    pub fn approach_speed(&self) -> R {
        self.gap_velocity_before.abs()
    }

    /// True if the two masses moved towards each other (paper, section 4.1).
    #[inline]
    pub fn effective(&self) -> bool {
        self.velocity_before * self.absorber_velocity_before() < 0.0
    }
}
