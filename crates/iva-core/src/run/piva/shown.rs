//! The steps of lanes of pendulums for the observers of their runs.

use super::Steps;
use super::drive::{Swinging, raised, seen};
use super::round::Round;
use crate::absorber::piva::{Known, Piva, PivaFlight};
use crate::absorber::{Absorber, OnStructure};
use crate::engine::observe::{Contact, Observer, Span};
use crate::host::DrivenHost;
use crate::number::arrays::Lanes as _;
use crate::run::side_by_side::ScalarRun;
use crate::segment::flight::Motion;

impl<H: Swinging, const N: usize, const SMALL: bool, const SPRUNG: bool>
    Steps<H, N, SMALL, SPRUNG>
{
    /// True if the observers of a lane are to see the step that it has done.
    pub(super) fn is_shown(&self, i: usize) -> bool {
        let shows = self.shared.shows_all || self.rounds.quiet[i] == 0.0;
        self.shared.shows && self.rounds.passed[i] > 0.0 && shows
    }

    /// Shows the observers of a run the step that its lane has done: those beside its measures only, if the step is
    /// quiet.
    pub(super) fn show(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) {
        let (round, system): (Round<_>, _) = (self.rounds.get(i), run.system);
        let scene = self.scenes.get(i);
        let own = round.hit.then(|| self.struck[i].pop()).flatten();
        self.tell(i, run);
        let (start, laid) = (self.begins.0[i], self.begins.1.get(i));
        let (from, end, contact) = {
            let [touching, after] = [&round.touching, &round.after];
            let contact = [seen::<H>(&scene, touching), seen::<H>(&scene, after)];
            (raised::<H>(&scene, &laid), seen::<H>(&scene, &round.end), contact)
        };
        let Round { losses, square, limits, length, .. } = round;
        let drive = H::DRIVEN.then(|| self.rows.drive(i));
        let series = (self.rows.get::<N>(i), drive);
        let known = Known { losses, square, limits };
        let motion = PivaFlight::flown(system, from, series, round.step, (length, known));
        let (from, to) = (system.primary(&from), system.primary(&end));
        let span = Span { motion: &motion, start, length, from, to, end: &end };
        let states = contact.each_ref();
        let contact = own.map(|impact| Contact { time: impact.time, states, summed: false });
        if round.quiet {
            show(system, &span, contact.as_ref(), &mut run.observer.beside);
        } else {
            self.lanes.get(i).put_back_sums(run);
            show(system, &span, contact.as_ref(), &mut run.observer);
            self.see(i, run);
        }
        if let Some(impact) = own {
            run.observer.impact(system, &impact);
        }
    }

    /// Reads sums and quiet steps of a run whose observers have seen a step.
    pub(super) fn see(&mut self, i: usize, run: &ScalarRun<'_, Piva<DrivenHost>>) {
        let mut lane = self.lanes.get(i);
        lane.see(run);
        self.lanes.set(i, &lane);
    }

    /// Tells the observers of a run of the impacts that they have not been told yet.
    pub(super) fn tell(&mut self, i: usize, run: &mut ScalarRun<'_, Piva<DrivenHost>>) {
        for impact in self.struck[i].drain(..) {
            run.observer.impact(run.system, &impact);
        }
    }
}

/// Shows an observer a step, with the contact that ends it.
fn show<S: Absorber, M: Motion<Real = S::Real, State = S::State>>(
    system: &S,
    span: &Span<'_, M>,
    contact: Option<&Contact<'_, S::State, S::Real>>,
    observer: &mut impl Observer<S>,
) {
    observer.span(system, span);
    if let Some(contact) = contact {
        observer.contact(system, contact);
    }
}
