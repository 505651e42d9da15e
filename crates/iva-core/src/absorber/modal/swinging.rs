//! Motions in which pendulums swing: how long their power series hold, and bounds from their coefficients.
//!
//! What the series leave out is bounded ([`crate::segment::taylor::Remainder`]), and a motion is no longer than full accuracy allows. The bounds that the search
//! for contacts needs are those of the polynomials; their truncation errors are part of its doubt.

use super::series::Series;
use super::swings::{Feed, Grown, Swing};
use super::{Modal, ModalMotion, ModalState, Place};
use crate::absorber::piva::accuracy::{
    Accuracy, MOST_HALVINGS, MOST_SHORTENINGS, SHORTER, shortening,
};
use crate::force::{Drive, Force};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{InFlight, LAST, ORDER, Pendulum, ROOM, RemainderOfSeveral, Shaking};

/// How much of its rate Λ a structure of several modes counts with in the length of a motion: the fastest mode moves least.
const SLOWER: f64 = 0.5;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The fastest rate of all pendulums; 0 without any.
    pub(super) fn swinging_rate(&self, places: &[Place<R>; N]) -> R {
        let all = if self.swings() { self.count() } else { 0 };
        let hanging = (0..all).filter_map(|k| Some((k, self.hanging(k)?)));
        hanging.fold(R::ZERO, |most, (k, is)| {
            let stiffness = is.frequency_squared + is.spring.acting();
            let loaded = is.mass_ratio.mul_add(self.mobility(k, k).value, R::ONE);
            let own = R::larger((stiffness * loaded).sqrt(), is.pivot_damping);
            let turning = is.swing(self.turning(k, is, &places[k]));
            R::larger(most, R::larger(own, turning))
        })
    }

    /// A length that is short against every time scale: of the structure, the drive, the pendulums and their swings.
    pub(super) fn longest_swing(&self, from: &ModalState<H, N, M>) -> R {
        let drive = self.host.force().map_or(R::ZERO, Force::fastest);
        let share = if self.whole.count() == 1 { R::ONE } else { R::from(SLOWER) };
        let structure = self.whole.growth() * share;
        let fastest = R::larger(R::larger(drive, structure), self.swinging_rate(&from.places));
        R::from(Accuracy::<R>::of(R::ZERO).longest_step * R::STEP) / fastest
    }

    /// ‖φ‖ of a shape.
    fn length(shape: &[R]) -> R {
        shape.iter().fold(R::ZERO, |sum, phi| phi.mul_add(*phi, sum)).sqrt()
    }

    /// The size of what the equations of the modes leave out of the orders that the series do not know, in a length of so many units of time.
    fn forces_left_out(&self, grown: &Grown<'_, R>, (unit, most): (R, R), left_out: [R; 2]) -> R {
        let rows = &grown.rows;
        let none = [DoubleDouble::ZERO; 3];
        let (last, _) = self.forces::<R>(rows, LAST, &[DoubleDouble::ZERO; N], (none, &[]), unit);
        let (highest, _) = rows.power(ORDER);
        let power = (0..LAST).fold(R::ONE, |power, _| power * most);
        let growth = self.whole.growth();
        let own = Self::length(&last[..self.whole.count()]) / (unit * unit)
            + growth * growth * Self::length(highest) * most;
        let [f, a] = left_out;
        let elsewhere = self.host.force().map_or(&[][..], Force::elsewhere);
        let aside = elsewhere.iter().fold(R::ZERO, |sum, (point, harmonic)| {
            let shape = Self::length(self.whole.shape(*point));
            harmonic.left_out::<LAST>(unit * most).mul_add(shape, sum)
        });
        let based = || {
            let own = Self::length(self.whole.participation().unwrap_or(&[]));
            (0..self.count()).fold(own, |sum, k| {
                self.masses[k].mass_ratio.mul_add(self.mobility(k, k).value.sqrt(), sum)
            })
        };
        let base = if a == 0.0 { R::ZERO } else { a * based() };
        own * power + f * Self::length(self.whole.shape(self.pushed)) + aside + base
    }

    /// The share of a unit of time, up to `most`, on which series are proved to leave out no more than full accuracy allows; `None` if that
    /// can be proved of no share.
    pub(super) fn share_proved(
        &self,
        grown: &Grown<'_, R>,
        from: &ModalState<H, N, M>,
        (unit, most): (R, R),
    ) -> Option<R> {
        let tolerance = Accuracy::<R>::of(R::ZERO).tolerance;
        let shape = |k: usize| self.mobility(k, k).value.sqrt();
        let flying: Vec<InFlight<'_, R>> = grown
            .swings
            .iter()
            .map(|swing| InFlight { series: &swing.series, shape: shape(swing.index) })
            .collect();
        let n = self.whole.count();
        let moving = |all: &[DoubleDouble<R>; M]| {
            all[..n].iter().fold(R::ZERO, |sum, part| part.value.mul_add(part.value, sum)).sqrt()
        };
        let moved = moving(&from.modes.places) + moving(&from.modes.velocities);
        let drive = self.host.drive(&from.phase, unit);
        let driven = drive.as_ref().map_or(R::ZERO, Drive::size);
        let pulled = |size: R, k: usize| {
            let mass = &self.masses[k];
            R::larger(size, mass.mass_ratio * mass.clearance * shape(k))
        };
        let structure = (0..self.count()).fold(R::larger(moved, driven), pulled) * tolerance;
        let gaps = || grown.swings.iter().map(|swing| self.masses[swing.index].clearance);
        let growth = self.whole.growth();
        let rate = R::larger(self.swinging_rate(&from.places), growth);
        let (mut fastest, mut most) = (rate, most);
        for _ in 0..MOST_HALVINGS {
            let left_out = self.host.force();
            let left_out = left_out.map_or([R::ZERO; 2], |it| it.left_out::<LAST>(unit * most));
            let forces = self.forces_left_out(grown, (unit, most), left_out);
            let shaking = Shaking { growth, forces, base: left_out[1] };
            let bound = RemainderOfSeveral::new(&flying, &shaking, fastest, (unit, most));
            if let Some(bound) = bound {
                // That of W is what the rates of the system allow, whatever rate the bound counts with.
                let allowed = gaps().map(|gap| gap * tolerance * (rate / fastest));
                let whole = bound.excess(std::iter::once(structure).chain(allowed));
                let mut share = bound.most() * shortening(whole, LAST + 1);
                for _ in 0..MOST_SHORTENINGS {
                    if whole * bound.part(share) <= 1.0 {
                        return Some(share);
                    }
                    share *= SHORTER;
                }
                return None;
            }
            // A structure that moves many lengths of a pendulum swings it faster than its own rates tell.
            most *= 0.5;
            fastest *= 2.0;
        }
        None
    }

    /// The size of the terms of the pull of a pendulum in flight that come from its own motion.
    pub(super) fn pulling(&self, k: usize, is: &Pendulum<R>, place: &Place<R>) -> R {
        let posture = self.posture(k, is, place);
        let [y, w, c] = [posture.y, posture.w, posture.c].map(|part| part.value.abs());
        let rate = is.swing(w);
        let wound = is.spring.acting() * posture.arc.value.abs();
        let swings = c * (is.frequency_squared * y + wound + is.pivot_damping * w);
        is.mass_ratio * is.lever * (y * rate * rate + swings)
    }
}

/// m!/(m − n)! of all orders.
const fn falling(n: usize) -> [f64; ORDER + 1] {
    let mut all = [0.0; ORDER + 1];
    let mut m = n;
    while m <= ORDER {
        all[m] = 1.0;
        let mut i = 0;
        while i < n {
            all[m] *= (m - i) as f64;
            i += 1;
        }
        m += 1;
    }
    all
}

/// The factors of the derivatives 0 to 6.
static FALLING: [[f64; ORDER + 1]; 7] =
    [falling(0), falling(1), falling(2), falling(3), falling(4), falling(5), falling(6)];

/// A bound on a derivative with respect to t up to t.
fn largest_derivative<R: Real>(series: &Series<R>, n: usize, t: R) -> R {
    let factors = &FALLING[n];
    (n..=ORDER).rev().fold(R::ZERO, |sum, m| sum.mul_add(t, series.plain(m).abs() * factors[m]))
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// A bound on a derivative of a series of this motion; not a number where nothing is proved.
    pub(super) fn largest_of_series(&self, series: &Series<R>, n: usize) -> R {
        let over = (0..n).fold(R::ONE, |over, _| over / self.unit);
        let most = largest_derivative(series, n, self.share(self.reach)) * over;
        if self.sure { most } else { R::NAN }
    }

    /// The distance of a member to its wall in double-double.
    pub(super) fn precise_distance(&self, k: usize, h: R) -> DoubleDouble<R> {
        let (system, from, unit) = (self.system, &self.from, self.unit);
        let drive = system.host.precise_drive(&from.phase, unit);
        let pushes = |m: usize| {
            let one = DoubleDouble::new(if m == 0 { R::ONE } else { R::ZERO });
            let zero = DoubleDouble::ZERO;
            drive.as_ref().map_or([zero, zero, one], |it| [it.primary[m], it.base[m], one])
        };
        let fixed = system.fixed_at(&from.places);
        let feed = Feed { regime: &self.regime, fixed: &fixed, asides: self.asides(), unit };
        let mut rows = system.begun(&from.modes, unit, (ORDER, ORDER + 1));
        let mut swings: Vec<Swing<'_, R, DoubleDouble<R>, ROOM>> =
            system.swinging_from(&from.places);
        for m in 0..=ORDER - 2 {
            system.rise(&mut rows, &mut swings, m, pushes(m), &feed);
        }
        let place = &from.places[k];
        let swing = swings.iter().find(|swing| swing.index == k);
        let followed = system.followed(k, place);
        let square = DoubleDouble::new(unit).times(unit);
        let coefficient = |m: usize| {
            if let Some(swing) = swing {
                return -swing.series.y[m];
            }
            let mut moved = rows.summed(followed.shape, m);
            if followed.with_base {
                let over = DoubleDouble::new(R::ONE).over(((m - 1) * m) as f64);
                moved = moved + pushes(m - 2)[1] * square * over;
            }
            if m == 2 { moved + (followed.constant * square).half() } else { moved }
        };
        let t = DoubleDouble::new(h).over(unit);
        let bent = (2..=ORDER).rev().fold(DoubleDouble::ZERO, |sum, m| {
            let released = m == 2 && place.leaves;
            sum * t + if released { DoubleDouble::ZERO } else { coefficient(m) }
        });
        let bent = bent * t * t;
        let sided = DoubleDouble { value: place.side * bent.value, rest: place.side * bent.rest };
        place.distance + place.rate.times(h) + sided
    }
}

#[cfg(test)]
mod tests;
