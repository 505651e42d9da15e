//! The start of a structure with modes and of its masses.

use super::state::{Modes, Place};
use super::structure::same;
use super::{MOST, MOST_MODES, Modal, ModalState};
use crate::absorber::Clock;
use crate::absorber::siva::free_mass::check_place;
use crate::error::{Invalid, number};
use crate::host::{Host, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::GapPoint;

/// A start: q and q̇ of the modes, and the place of each mass in its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModalStart<R, const N: usize = MOST, const M: usize = MOST_MODES> {
    displacements: [R; M],
    velocities: [R; M],
    /// Of each absorber; those after the last absorber mean nothing.
    gaps: [GapPoint<R>; N],
}

impl<R: Real, const N: usize, const M: usize> ModalStart<R, N, M> {
    /// The start with these q and q̇, of which those left out are 0, and with this y and w of each mass.
    ///
    /// # Errors
    /// [`Invalid`] for more than M of one.
    pub fn new(
        displacements: &[R],
        velocities: &[R],
        gaps: [GapPoint<R>; N],
    ) -> Result<Self, Invalid> {
        let filled = |name: &str, given: &[R]| {
            let mut all = [R::ZERO; M];
            let room = all.get_mut(..given.len());
            let Some(room) = room else {
                return same(&format!("start.modes.{name}"), given.len(), M).map(|()| all);
            };
            room.copy_from_slice(given);
            Ok(all)
        };
        let displacements = filled("displacement", displacements)?;
        let velocities = filled("velocity", velocities)?;
        Ok(Self { displacements, velocities, gaps })
    }

    /// The start of one mode and one mass.
    pub(super) fn of_one([x, v]: [R; 2], gap: GapPoint<R>) -> Self {
        let first = |value| std::array::from_fn(|j| if j == 0 { value } else { R::ZERO });
        Self { displacements: first(x), velocities: first(v), gaps: [gap; N] }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// Checks a start.
    pub(super) fn check(&self, start: &ModalStart<R, N, M>) -> Result<(), Invalid> {
        let n = self.own_modes();
        for (name, all) in [("displacement", &start.displacements), ("velocity", &start.velocities)]
        {
            let given = all.iter().enumerate().filter(|(_, value)| **value != 0.0);
            for (j, value) in given {
                let field = format!("start.modes[{j}].{name}");
                range::size(&field, *value)?;
                if j >= n {
                    let rule = format!("the structure has {n} modes");
                    return Err(Invalid::new(field, number(*value), rule));
                }
            }
        }
        let modes = Modes {
            places: start.displacements.map(DoubleDouble::new),
            velocities: start.velocities.map(DoubleDouble::new),
        };
        for (k, (mass, GapPoint { y, w })) in self.masses().iter().zip(start.gaps).enumerate() {
            let size = mass.clearance + mass.offset.abs();
            if self.on_ground(k) {
                let [u, _] = self.placed(k, &modes, GapPoint { y, w });
                check_place("start.displacement", u.value, mass.walls(), size)?;
                continue;
            }
            let field = |name: &str| format!("start.{k}.{name}");
            range::size(&field("gap_displacement"), y)?;
            range::size(&field("gap_velocity"), w)?;
            check_place(&field("gap_displacement"), y, mass.walls(), size)?;
            let reach = self.hanging(k).filter(|is| !is.small_angles);
            if let Some(is) = reach.filter(|is| y.abs() >= is.contact_distance) {
                let rule = format!(
                    "a pendulum hangs below its pivot: give less than {} to either side",
                    number(is.contact_distance)
                );
                return Err(Invalid::new(field("gap_displacement"), number(y), rule));
            }
        }
        Ok(())
    }

    /// The gap displacement and velocity of a member at the start: those given, or of a stop on the ground those of its point.
    fn placed(&self, k: usize, modes: &Modes<R, M>, given: GapPoint<R>) -> [DoubleDouble<R>; 2] {
        match self.grounded(k) {
            Some(_) => modes.of_point(self.shape(k)),
            None => [given.y, given.w].map(DoubleDouble::new),
        }
    }

    /// The first state.
    pub(super) fn first(&self, start: &ModalStart<R, N, M>, time: Clock<R>) -> ModalState<H, N, M> {
        let phase: Phase<H> = self.host.begin_at(time);
        let mut places = start.displacements.map(DoubleDouble::new);
        let mut velocities = start.velocities.map(DoubleDouble::new);
        self.positions(&mut places, |k| DoubleDouble::new(start.gaps[k].y));
        self.positions(&mut velocities, |k| DoubleDouble::new(start.gaps[k].w));
        let modes = Modes { places, velocities };
        let mut state =
            ModalState { modes, places: [Place::FAR; N], phase, at_hand: 0, felt: None };
        for (k, GapPoint { y, w }) in start.gaps.into_iter().take(self.count()).enumerate() {
            let [_, v] = modes.of_point(self.shape(k));
            let shaken = self.shaken(&state, k);
            let leaning = [-shaken[0], v.value].into_iter().chain(self.host.leaning(&phase));
            let [y, w] = self.placed(k, &modes, GapPoint { y, w });
            let (side, distance) = self.masses[k].begun((y, w.value), leaning);
            let rate = if side > 0.0 { w.negated() } else { w };
            let held = self.friction[k] != 0.0;
            let place = Place { side, distance, rate, held, ..Place::FAR };
            state.places[k] = self.directed(k, &place);
        }
        self.settle(&mut state);
        state
    }
}
