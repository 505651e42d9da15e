//! What the values at both ends of a motion prove at once.

use super::state::{Modes, Place};
use super::{ModalMotion, ModalState};
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::contact::{keeps_pressing, meeting, only_contact, stays_clear_by};
use crate::segment::flight::{Curve as _, Side};

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// True if it is proved that nothing happens to the absorber at hand on its way to a state.
    #[inline(always)]
    pub(super) fn surely_clears(&self, length: R, end: &ModalState<H, N, M>) -> bool {
        let (k, from) = self.begun();
        let to = &end.places[k];
        let friction = self.system.friction[k];
        if from.carried() {
            let friction = self.system.held_up_to(k, from);
            let signs = if from.stuck { [-from.side; 2] } else { [R::ONE, -R::ONE] };
            return signs.into_iter().all(|sign| {
                let carries = |[a, jerk, ..]: [R; 4]| [sign.mul_add(a, friction), sign * jerk];
                let ends = [self.felt_first(), self.felt(k, length)].map(carries);
                keeps_pressing(ends, self.magnitude(), self.fourth(), length)
            });
        }
        if friction != 0.0 && !self.keeps_sliding([from, to], length) {
            return false;
        }
        let ends = [from, to].map(|place| [place.distance.value, place.rate.value]);
        let wide = self.system.masses[k].half_play();
        stays_clear_by(ends, wide, self.size(k, end, length), self.fourth_of(3), length)
    }

    /// The only contact of the absorber at hand on its way to a state, where both ends tell that there is one.
    pub(super) fn sure_contact(&self, length: R, end: &ModalState<H, N, M>) -> Option<(R, Side)> {
        let (k, from) = self.begun();
        if from.carried() || self.system.friction[k] != 0.0 {
            return None;
        }
        let to = &end.places[k];
        let ends = [[from.distance.value, to.distance.value], [from.rate.value, to.rate.value]];
        let (wide, size) = (self.system.masses[k].half_play(), self.size(k, end, length));
        let (side, level) = only_contact(ends, wide, size, self.fourth_of(3), length)?;
        let [bend, end_bend] = [R::ZERO, length].map(|h| self.approach(k, h)[2]);
        let h = {
            meeting(
                ends,
                [bend, end_bend],
                level,
                length,
                #[inline(always)]
                |h| {
                    let [distance, rate, _] = self.approach(k, h);
                    [distance - level, rate]
                },
            )
        }?;
        Some((h, side))
    }

    /// The size of the numbers that the distance of a mass ahead is a difference of, over a motion of this length to a state.
    #[inline(always)]
    fn size(&self, k: usize, end: &ModalState<H, N, M>, length: R) -> R {
        let of = |Modes { places, velocities }: &Modes<R, M>, j: usize| {
            velocities[j].value.abs().mul_add(length, places[j].value.abs())
        };
        let both = |j: usize| of(&self.from.modes, j) + of(&end.modes, j);
        let clearance = self.system.masses[k].size_at(self.from.places[k].distance.value);
        if self.system.hanging(k).is_some() {
            return clearance * 2.0;
        }
        if self.oscillation().is_some() {
            return clearance + both(0);
        }
        let shape = self.system.gap_shape(k).iter().enumerate();
        shape.fold(clearance, |size, (j, phi)| phi.abs().mul_add(both(j), size))
    }

    /// The distance of a mass in flight from its wall with two derivatives, in plain numbers.
    #[inline(always)]
    pub(super) fn approach(&self, k: usize, h: R) -> [R; 3] {
        if let Some(it) = self.oscillation() {
            return self.approached(k, h, it.ahead(h));
        }
        let (Place { side, distance, rate, .. }, over) = (&self.from.places[k], R::ONE / self.unit);
        let [bent, gained, bend] = self.curved(k).plainly(self.share(h));
        let travelled = side.mul_add(bent, rate.value * h);
        let rate = (*side * over).mul_add(gained, rate.value);
        [distance.value + travelled, rate, *side * over * over * bend]
    }

    /// True if it is proved that the point which the run sees does not turn in this length of a motion in which pendulums swing.
    pub(super) fn surely_never_turns(&self, length: R) -> bool {
        if !R::FAST_PATHS {
            return false;
        }
        let (x, over) = (self.x(), R::ONE / self.unit);
        let at = |h: R| {
            let [_, rate, bend] = x.plainly(self.share(h));
            [rate * over, bend * over * over]
        };
        let [begin, end] = [at(R::ZERO), at(length)];
        let sign = begin[0].signum();
        let size = |[rate, bend]: [R; 2]| bend.abs().mul_add(length, rate.abs());
        let ends = [begin, end].map(|end| end.map(|it| sign * it));
        keeps_pressing(ends, size(begin) + size(end), self.largest_of_series(x, 5), length)
    }

    /// The third derivative of that distance.
    pub(super) fn turned(&self, k: usize, h: R) -> R {
        let side = self.from.places[k].side;
        if let Some(it) = self.oscillation() {
            return side * it.jerk(h);
        }
        let [_, jerk] = self.curved(k).bends(self.share(h));
        side * jerk / (self.unit * self.unit * self.unit)
    }
}
