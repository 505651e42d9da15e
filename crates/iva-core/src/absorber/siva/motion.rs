//! The flight of a free mass in its gap.

use std::cell::OnceCell;

use super::passage::Passage;
use super::pieces::Drifting;
use super::{Siva, SivaState};
use crate::absorber::{Absorber, OnStructure, Point, Wall};
use crate::host::{Flown, Host, Integrated, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{
    Accelerations, Curve, FastFlight, GapPoint, Jet, Losses, Motion, Quantity, Rows, Seen, Travel,
    Turns,
};
use crate::segment::taylor::ORDER;

/// The flight from one state: the absorber free in its gap.
#[derive(Debug, Clone)]
pub struct SivaFlight<'a, H: Host> {
    pub(super) siva: &'a Siva<H>,
    pub(super) from: SivaState<Phase<H>, H::Real>,
    pub(super) course: <H::Structure as Structure>::Course,
    /// The course with all that measures need, once it was needed; `None`: it is the course itself.
    measured: OnceCell<Option<Box<<H::Structure as Structure>::Course>>>,
    /// Its begin as a point of a record, once it was needed; `None` if it is none.
    pub(super) drifting: OnceCell<Option<Drifting<H::Real>>>,
}

impl<'a, R: Real, H: Host<Real = R>> SivaFlight<'a, H> {
    #[inline]
    pub(super) fn new(siva: &'a Siva<H>, from: SivaState<Phase<H>, R>) -> Self {
        let course = siva.host.free().fast_course(&from.host);
        Self { siva, from, course, measured: OnceCell::new(), drifting: OnceCell::new() }
    }

    fn measured(&self) -> &<H::Structure as Structure>::Course {
        let made = || self.structure().measured(&self.from.host, &self.course).map(Box::new);
        self.measured.get_or_init(made).as_deref().unwrap_or(&self.course)
    }

    #[inline(always)]
    pub(super) fn structure(&self) -> &'a H::Structure {
        self.siva.host.free()
    }
}

/// The state after a flight of length h.
#[inline(always)]
pub(crate) fn arrived<R: Real, S: Structure<Real = R>>(
    free: &S,
    course: &S::Course,
    from: &SivaState<S::Phase, R>,
    h: R,
) -> SivaState<S::Phase, R> {
    after(from, &free.flown(&from.host, course, h), h)
}

/// The state after a flight of length h in which the structure moves like this.
#[inline(always)]
pub(super) fn after<P: Copy, R: Real>(
    from: &SivaState<P, R>,
    flown: &Flown<P, R>,
    h: R,
) -> SivaState<P, R> {
    let Flown { to, gained } = *flown;
    let side = |sum: DoubleDouble<R>| DoubleDouble {
        value: from.side * sum.value,
        rest: from.side * sum.rest,
    };
    SivaState {
        host: to,
        side: from.side,
        distance: from
            .distance
            .plus_both(from.rate.product(DoubleDouble::new(h)), side(gained.curved)),
        rate: from.rate + side(gained.velocity),
    }
}

impl<R: Real, H: Host<Real = R>> Motion for SivaFlight<'_, H> {
    type Real = R;
    type State = SivaState<Phase<H>, R>;
    const RIDING: bool = false;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    #[inline]
    fn reach(&self) -> R {
        self.structure().reach(&self.from.host)
    }

    // A call, for six functions need it.
    #[inline(never)]
    fn state(&self, h: R) -> Self::State {
        arrived(self.structure(), &self.course, &self.from, h)
    }

    fn arrival(&self, h: R) -> Self::State {
        let mut state = self.state(h);
        self.structure().refresh(&mut state.host);
        state
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.structure().jet(&self.from.host, &self.course, h)
    }

    #[inline]
    fn fast_path(&self, length: R) -> Option<FastFlight<Self::State, R>> {
        if !R::FAST_PATHS {
            return None;
        }
        self.fast_flight(length)
    }

    fn acceleration(&self, h: R) -> R {
        self.siva.host.absolute(self.state(h).host.acceleration)
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        self.place(h).1
    }

    fn place(&self, h: R) -> (Point<R>, GapPoint<R>) {
        let state = self.state(h);
        (self.siva.primary(&state), self.siva.gap(&state))
    }

    fn seen(&self, h: R) -> Seen<Self::State, R> {
        let state = self.state(h);
        let (primary, gap) = (self.siva.primary(&state), self.siva.gap(&state));
        let acceleration = self.siva.host.absolute(state.host.acceleration);
        Seen { state, primary, gap, acceleration }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn losses(&self, h: R) -> Losses<R> {
        if let Some(passage) = Passage::of(self, h) {
            return passage.losses();
        }
        let motion = Integrated {
            from: &self.from.host,
            course: self.measured(),
            mass_ratio: self.siva.mass.mass_ratio,
            gap_velocity: Some(self.from.gap_velocity()),
        };
        let [viscous, work] = self.structure().losses(&motion, h);
        Losses { viscous, pivot: R::ZERO, work }
    }

    fn square(&self, h: [R; 2]) -> R {
        let whole = if h[0] == 0.0 { Passage::of(self, h[1]) } else { None };
        if let Some(passage) = whole {
            return passage.square();
        }
        self.structure().square(&self.from.host, self.measured(), h)
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &Self::State) -> Option<R> {
        if let Some(passage) = Passage::of(self, length) {
            return Some(passage.largest(of, least));
        }
        self.structure().largest(of, least, (&self.from.host, &self.course), &end.host, length)
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.structure().rows(&self.from.host, &self.course)
    }

    /// The series follow from ÿ = −A and ẍ₁ = −a_g. The series of A leaves gravity out, so it is added to both.
    fn travel(&self) -> Option<Travel<R>> {
        let rows = self.structure().series(&self.from.host, &self.course);
        let Rows { step, x, acceleration, base, .. } = &rows;
        let GapPoint { y, w } = self.siva.gap(&self.from);
        let (mut gap, mut absorber) = ([R::ZERO; ORDER + 1], [R::ZERO; ORDER + 1]);
        (gap[0], gap[1]) = (y, w * *step);
        (absorber[0], absorber[1]) = (x[0] + gap[0], x[1] + gap[1]);
        for k in 0..=ORDER - 2 {
            let gravity = if k == 0 { self.siva.host.gravity() } else { R::ZERO };
            let over = R::reciprocal(k + 1) * R::reciprocal(k + 2) * (*step * *step);
            gap[k + 2] = -(acceleration[k] + gravity) * over;
            absorber[k + 2] = -(base[k] + gravity) * over;
        }
        Some(Travel { rows, gap, absorber })
    }

    fn accelerations(&self, length: R) -> Option<Accelerations<R>> {
        // Without drive the bounds hold for any length.
        if self.siva.host.force().is_some() && length > self.reach() {
            return None;
        }
        let (free, gravity) = (self.structure(), self.siva.host.gravity().abs());
        let gap = free.bound::<0>(&self.from.host.primary);
        let absorber = free.largest_base() + gravity;
        Some(Accelerations { structure: gap + gravity, gap, absorber })
    }

    fn turns(&self, length: R, end: &Self::State) -> Turns<R> {
        let [v, v_end] = [&self.from, end].map(|state| state.host.primary.v.value);
        if !R::FAST_PATHS || v * v_end >= 0.0 {
            return Turns::Unknown;
        }
        self.structure().turns(&self.from.host, &self.course, &end.host, length)
    }
}

impl<R: Real, H: Host<Real = R>> Curve for SivaFlight<'_, H> {
    type Real = R;

    #[inline]
    fn jet(&self, h: R) -> Jet<R> {
        self.siva.distance(&self.state(h))
    }

    #[inline]
    fn first(&self) -> Jet<R> {
        self.siva.distance(&self.from)
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let SivaState { side: s, distance, rate, .. } = self.from;
        let travelled = rate.times(h);
        let curved = self.structure().precise(&self.from.host, h);
        distance
            .plus_parts(travelled.value, travelled.rest)
            .plus_parts(s * curved.value, s * curved.rest)
    }

    /// D⁗ = s Ä.
    #[inline]
    fn fourth(&self) -> R {
        self.structure().bound::<2>(&self.from.host.primary)
    }

    #[inline]
    fn magnitude(&self) -> R {
        self.siva.mass.clearance
    }
}
