//! The step length of the flight, so that its series leaves out no more than full accuracy asks for.

use super::{Mixed, MixedState};
use crate::absorber::piva::accuracy::{
    Accuracy, MOST_HALVINGS, MOST_SHORTENINGS, SHORTER, shortening,
};
use crate::force::Force;
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::taylor::{InFlight, ORDER, RemainderOfSeveral, Series};

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// The fastest rate in the equations but for the swings: of structure, pendulums and force.
    fn fastest(&self) -> R {
        let force = self.host.force().map_or(R::ZERO, Force::fastest);
        let zeta = self.host.damping_ratio();
        let structure = zeta + (R::ONE + zeta * zeta).sqrt();
        let each = self.members.iter().map(|it| it.pendulum.fastest());
        each.fold(force.max(structure), R::larger)
    }

    /// A step short against every time scale: of the structure, of the pendulums, of their swings.
    pub(super) fn longest_step(&self, state: &MixedState<H>) -> R {
        let swings = self.each(state).map(|(it, place)| it.pendulum.swing(place.w.value));
        let fastest = swings.fold(self.fastest(), R::larger);
        R::from(Accuracy::of(R::ZERO).longest_step) / fastest
    }

    /// The share of a step, up to `most`, on which its series is proved to leave out no more than full accuracy allows;
    /// `None` if that can be proved of no share. `driven`: the size of the force.
    pub(super) fn share_proved(
        &self,
        series: &[Series<R>],
        (step, most): (R, R),
        from: &MixedState<H>,
        driven: R,
    ) -> Option<R> {
        let tolerance = Accuracy::of(R::ZERO).tolerance;
        let of = |k: usize| InFlight { pendulum: &self.members[k].pendulum, series: &series[k] };
        let flying: Vec<usize> =
            (0..self.members.len()).filter(|k| !from.places[*k].stuck).collect();
        let in_flight: Vec<InFlight<'_, R>> = flying.iter().map(|k| of(*k)).collect();
        let moved = from.primary.x.value.abs() + from.primary.v.value.abs();
        let pulled = |size: R, k: usize| {
            let member = &self.members[k];
            size.max(member.pendulum.mass_ratio * member.clearance)
        };
        let structure = (0..self.members.len()).fold(moved.max(driven), pulled) * tolerance;
        let gaps: Vec<R> = flying.iter().map(|k| self.members[*k].clearance * tolerance).collect();
        let mass = (self.host.damping_ratio(), self.stuck_mass(from));
        let (mut fastest, mut most) = (self.fastest(), most);
        for _ in 0..MOST_HALVINGS {
            let left_out = self
                .host
                .force()
                .map_or([R::ZERO; 2], |force| force.left_out::<ORDER>(step * most));
            let bound = {
                let driven = (left_out, step, most);
                RemainderOfSeveral::new(&in_flight, series.first()?, mass, fastest, driven)
            };
            if let Some(bound) = bound {
                let excess = |share: R| bound.excess(share, structure, &gaps);
                let whole = bound.most();
                let mut share = whole * shortening(excess(whole), ORDER + 1);
                for _ in 0..MOST_SHORTENINGS {
                    if excess(share) <= 1.0 {
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
}
