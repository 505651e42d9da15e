//! One round of a lane: a stretch in which all masses fly, and the impact at its end if there is one.

use super::Lane;
use crate::absorber::chatter::{first_search, may_end};
use crate::absorber::several::sight::{Ends, Met};
use crate::absorber::several::touching::soon;
use crate::absorber::several::{InGap, SeveralState};
use crate::absorber::siva::Law;
use crate::absorber::siva::exact::InFlight;
use crate::host::{Excitation, Flown, Host, HostState, Structure};
use crate::number::arrays::{Laned, Lanes, arrays};
use crate::number::compensated::DoubleDouble;
use crate::number::real::pick;
use crate::number::series::unrolled;

arrays! {
    /// What does not change of one mass of a lane.
    Mass, Masses:
    clearance;
    /// The impact laws at wall + and at wall −.
    laws: [Law; 2],
}

arrays! {
    /// The results of one round of a lane.
    Round, Rounds:
    /// The length of the stretch, how much later the impact is, the index of the mass that has it, and the longest first
    /// trial after it.
    h, later, which, first;
    /// True if the lane goes on by itself; if it does after an impact.
    passed: bool, hit: bool,
}

/// The state of a lane: that of the structure and of its masses.
#[derive(Debug, Clone, Copy)]
pub(super) struct State<P, const K: usize> {
    pub host: HostState<P>,
    pub places: [InGap; K],
}

/// The states of lanes.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct States<P: Laned, const K: usize, const W: usize> {
    host: <HostState<P> as Laned>::Lanes<W>,
    places: <[InGap; K] as Laned>::Lanes<W>,
}

impl<P: Laned, const K: usize> Laned for State<P, K> {
    type Lanes<const W: usize> = States<P, K, W>;

    #[inline(always)]
    fn pick(which: bool, yes: &Self, no: &Self) -> Self {
        Self {
            host: Laned::pick(which, &yes.host, &no.host),
            places: Laned::pick(which, &yes.places, &no.places),
        }
    }
}

impl<P: Laned, const K: usize, const W: usize> Lanes<State<P, K>> for States<P, K, W> {
    fn new() -> Self {
        Self { host: Lanes::new(), places: Lanes::new() }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> State<P, K> {
        State { host: self.host.get(i), places: self.places.get(i) }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: &State<P, K>) {
        self.host.set(i, &one.host);
        self.places.set(i, &one.places);
    }
}

impl<P: Copy, const K: usize> State<P, K> {
    /// Writes it into a state of a run.
    pub fn put_into<H: Host<Real = f64> + Excitation<Phase = P>>(
        &self,
        state: &mut SeveralState<H>,
    ) {
        state.host = self.host;
        state.masses[..K].copy_from_slice(&self.places);
    }
}

/// The end of a stretch of a length with this contact, and the decision about it: the states at its end, in contact, and after the impact; the last is that
/// at the end if there is none.
#[inline(always)]
pub(super) fn ended<S: Structure<Real = f64>, const K: usize>(
    flight: &InFlight<'_, S>,
    lane: &Lane,
    masses: &[Mass; K],
    from: &State<S::Phase, K>,
    (length, contact): (f64, &Contact),
) -> (Round, [State<S::Phase, K>; 3])
where
    S::Phase: Laned,
{
    let Contact { decided, h, .. } = *contact;
    let arrived = arrival(flight, from, h);
    let touch = touching(flight.free, masses, &arrived, contact);
    let Touching { state: touching, later, alone, met } = touch;
    let law = law_of(masses, contact.which, met.side);
    let after = struck(flight.free, &touching, contact, &met, &law);
    let pressure = -met.side * after.host.acceleration.value;
    let (approach, rebound) = (-met.rate.value, met.rebounded(law.restitution).rate.value);
    let high = (approach > lane.progress.floor) & !may_end(rebound, pressure, law.restitution);
    let clock = lane.progress.clock.plus_parts(h, 0.0).plus_parts(later, 0.0);
    let before_end = clock.minus(lane.progress.stop) < 0.0;
    let hit = decided & contact.hit & alone & high & before_end;
    let whole = length == lane.progress.remaining();
    let first = first_search(rebound, pressure);
    let round = Round {
        h,
        later: pick(hit, later, 0.0),
        which: contact.which,
        first: pick(hit & (pressure > 0.0), first, f64::INFINITY),
        passed: hit | (decided & !contact.hit & !whole),
        hit,
    };
    let end = State::pick(hit, &after, &arrived);
    (round, [arrived, touching, end])
}

arrays! {
    /// The first contact in a stretch.
    Contact, Contacts:
    /// The instant, or the end of the stretch, and the index of the mass.
    h, which;
    /// True if what each mass meets is decided; if one meets a wall; if that is the far one.
    decided: bool, hit: bool, far: bool,
}

/// The first contact in a stretch of a length.
#[inline(always)]
pub(super) fn first_contact<S: Structure<Real = f64>, const K: usize>(
    flight: &InFlight<'_, S>,
    masses: &[Mass; K],
    State { host: begin, places }: &State<S::Phase, K>,
    length: f64,
) -> Contact {
    let Flown { to: mut end, gained } = flight.free.flown(begin, flight.course, length);
    flight.free.refresh(&mut end);
    let ends = Ends { begin, end: &end, length };
    let mut first = Contact { decided: true, hit: false, far: false, h: length, which: 0.0 };
    // A loop left in this one over lanes would keep it from becoming vectors.
    unrolled!(k < K => {
        let (place, clearance) = (&places[k], masses[k].clearance);
        let reached = place.flown(&gained, length);
        let clear = place.clears(&reached, flight.free, &ends, clearance);
        let Met { sure, far, h } = place.meets(&reached, flight, &ends, clearance);
        let earlier = !clear & sure & (h < first.h);
        first = Contact {
            decided: first.decided & (clear | sure),
            hit: first.hit | earlier,
            far: (earlier & far) | (!earlier & first.far),
            h: pick(earlier, h, first.h),
            which: pick(earlier, k as f64, first.which),
        };
    });
    first
}

/// The state after a motion of length h.
#[inline(always)]
fn arrival<S: Structure<Real = f64>, const K: usize>(
    flight: &InFlight<'_, S>,
    from: &State<S::Phase, K>,
    h: f64,
) -> State<S::Phase, K> {
    let Flown { to: mut host, gained } = flight.free.flown(&from.host, flight.course, h);
    flight.free.refresh(&mut host);
    let mut places = from.places;
    unrolled!(k < K => places[k] = places[k].flown(&gained, h));
    State { host, places }
}

/// A state in contact.
#[derive(Debug, Clone, Copy)]
struct Touching<P, const K: usize> {
    state: State<P, K>,
    /// How much later it is.
    later: f64,
    /// True if no other mass touches a wall.
    alone: bool,
    /// The place of the mass that has its impact.
    met: InGap,
}

#[inline(always)]
fn touching<S: Structure<Real = f64>, const K: usize>(
    structure: &S,
    masses: &[Mass; K],
    State { host, places }: &State<S::Phase, K>,
    contact: &Contact,
) -> Touching<S::Phase, K>
where
    S::Phase: Laned,
{
    let (mut met, mut across) = (places[0], places[0].across(masses[0].clearance));
    unrolled!(k < K => {
        let this = contact.which == k as f64;
        met = InGap::pick(this, &places[k], &met);
        across = InGap::pick(this, &places[k].across(masses[k].clearance), &across);
    });
    met = InGap::pick(contact.far, &across, &met);
    let later = met.delay(host);
    let gained = host.acceleration.value * later;
    met = met.moved(later, gained).at_wall();
    let mut state = State { host: soon(structure, host, later), places: *places };
    let mut alone = true;
    unrolled!(k < K => {
        let this = contact.which == k as f64;
        let moved = places[k].moved(later, gained);
        let far = moved.across(masses[k].clearance);
        let touches = moved.meets_at_once() | far.meets_at_once() | (moved.distance.value == 0.0);
        alone &= this | !touches;
        state.places[k] = InGap::pick(this, &met, &moved);
    });
    Touching { state, later, alone, met }
}

/// The impact law of a mass at the wall with this sign.
#[inline(always)]
fn law_of<const K: usize>(masses: &[Mass; K], which: f64, side: f64) -> Law {
    let mut law = Law::default();
    unrolled!(k < K => {
        let [plus, minus] = &masses[k].laws;
        law = Law::pick(which == k as f64, &Law::pick(side > 0.0, plus, minus), &law);
    });
    law
}

/// The state after the impact of one mass.
#[inline(always)]
fn struck<S: Structure<Real = f64>, const K: usize>(
    structure: &S,
    State { host, places }: &State<S::Phase, K>,
    contact: &Contact,
    met: &InGap,
    law: &Law,
) -> State<S::Phase, K> {
    let gained = met.kicks(DoubleDouble::ZERO, law.share);
    let primary = host.primary.faster_by(gained);
    let acceleration = structure.acceleration(&host.phase, &primary);
    let mut after = *places;
    unrolled!(k < K => {
        let this = contact.which == k as f64;
        let rebounded = met.rebounded(law.restitution);
        after[k] = InGap::pick(this, &rebounded, &places[k].left_by(gained));
    });
    State { host: HostState { primary, acceleration, phase: host.phase }, places: after }
}
