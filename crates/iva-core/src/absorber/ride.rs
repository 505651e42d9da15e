//! An absorber stuck on a wall: one mass 1 + μ on the spring and damper of its structure, until the pressure on the wall
//! changes sign.

use crate::absorber::{Absorber, Point, Wall};
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Integrated, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Curve, GapPoint, Jet, Losses, Motion, Quantity, Rows, Seen, Travel};
use crate::segment::taylor::ORDER;

/// An absorber that can stick to a host.
pub trait Stuck: Absorber<Excitation = <Self as Stuck>::Host> {
    /// The host.
    type Host: Host<Real = Self::Real>;
    /// Displacement and velocity of the structure in a state.
    fn structure_of(state: &Self::State) -> Primary<Self::Real>;
    /// The same state of the absorber, with this state of the structure.
    fn with_structure(
        state: &Self::State,
        structure: HostState<Phase<Self::Host>, Self::Real>,
    ) -> Self::State;
    /// The pressure on a wall per unit mass of the absorber: a factor of A, and a constant.
    fn pressure(&self, wall: Wall) -> [Self::Real; 2];
}

/// The part of the weight that is counted on, because of rounding.
const HELD: f64 = 1.0 - 1e-9;

/// The structure of a host, with the absorber stuck to it.
type Loaded<S> = <<S as Stuck>::Host as Host>::Structure;

/// The stick episode from one state.
#[derive(Debug, Clone)]
pub struct Ride<'a, S: Stuck> {
    system: &'a S,
    from: S::State,
    /// The state of the structure, with A of the mass 1 + μ.
    begin: HostState<Phase<S::Host>, S::Real>,
    course: <Loaded<S> as Structure>::Course,
}

impl<'a, R: Real, S: Stuck<Real = R>> Ride<'a, S> {
    pub(super) fn new(system: &'a S, from: S::State) -> Self {
        let (phase, primary) = (S::phase(&from), S::structure_of(&from));
        let loaded = system.excitation().loaded();
        let acceleration = loaded.acceleration(phase, &primary);
        let begin = HostState { primary, acceleration, phase: *phase };
        let course = loaded.fast_course(&begin);
        Self { system, from, begin, course }
    }

    fn structure(&self) -> &'a Loaded<S> {
        self.system.excitation().loaded()
    }

    /// The structure after a time h.
    fn flown(&self, h: R) -> HostState<Phase<S::Host>, R> {
        self.structure().flown(&self.begin, &self.course, h).to
    }

    /// The displacement of the absorber in its gap.
    fn place(&self) -> R {
        let wall = self.system.wall(&self.from);
        self.system.offset() + self.system.clearance() * wall.sign()
    }
}

impl<R: Real, S: Stuck<Real = R>> Motion for Ride<'_, S> {
    type Real = R;
    type State = S::State;
    const RIDING: bool = true;

    fn origin(&self) -> &S::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.structure().reach(&self.begin)
    }

    fn state(&self, h: R) -> S::State {
        S::with_structure(&self.from, self.flown(h))
    }

    fn arrival(&self, h: R) -> S::State {
        let mut structure = self.flown(h);
        self.system.excitation().free().refresh(&mut structure);
        S::with_structure(&self.from, structure)
    }

    fn primary(&self, h: R) -> Jet<R> {
        self.structure().jet(&self.begin, &self.course, h)
    }

    fn acceleration(&self, h: R) -> R {
        let HostState { primary, phase, .. } = self.flown(h);
        self.system.excitation().absolute(self.structure().acceleration(&phase, &primary))
    }

    fn gap(&self, _h: R) -> GapPoint<R> {
        GapPoint { y: self.place(), w: R::ZERO }
    }

    fn seen(&self, h: R) -> Seen<S::State, R> {
        let structure = self.flown(h);
        let HostState { primary, phase, .. } = structure;
        let pulled = self.structure().acceleration(&phase, &primary);
        Seen {
            state: S::with_structure(&self.from, structure),
            primary: Point { x: primary.x.value, v: primary.v.value },
            gap: self.gap(h),
            acceleration: self.system.excitation().absolute(pulled),
        }
    }

    fn wall(&self) -> Option<Wall> {
        Some(self.system.wall(&self.from))
    }

    fn losses(&self, h: R) -> Losses<R> {
        let motion = Integrated {
            from: &self.begin,
            course: &self.course,
            mass_ratio: self.system.mass_ratio(),
            gap_velocity: None,
        };
        let [viscous, work] = self.structure().losses(&motion, h);
        Losses { viscous, pivot: R::ZERO, work }
    }

    fn square(&self, h: [R; 2]) -> R {
        self.structure().square(&self.begin, &self.course, h)
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &S::State) -> Option<R> {
        let (phase, primary) = (S::phase(end), S::structure_of(end));
        let end = HostState { primary, phase: *phase, ..self.begin };
        self.structure().largest(of, least, (&self.begin, &self.course), &end, length)
    }

    fn rows(&self) -> Option<Rows<R>> {
        self.structure().rows(&self.begin, &self.course)
    }

    fn travel(&self) -> Option<Travel<R>> {
        let mut gap = [R::ZERO; ORDER + 1];
        gap[0] = self.place();
        let rows = self.structure().series(&self.begin, &self.course);
        Some(Travel::new(rows, gap, self.system.lever()))
    }
}

impl<R: Real, S: Stuck<Real = R>> Ride<'_, S> {
    /// The pressure on the wall in a state, with its derivatives.
    fn pressure(&self, sample: &S::State) -> Jet<R> {
        let [factor, constant] = self.system.pressure(self.system.wall(sample));
        let (phase, primary) = (S::phase(sample), S::structure_of(sample));
        let a = self.structure().acceleration(phase, &primary).value;
        let [jerk, snap, crackle] = self.structure().derivatives(phase, primary.v.value, a);
        Jet {
            value: factor * a + constant,
            rate: factor * jerk,
            curvature: factor * snap,
            jerk: factor * crackle,
        }
    }
}

/// The pressure on the wall.
impl<R: Real, S: Stuck<Real = R>> Curve for Ride<'_, S> {
    type Real = R;

    fn jet(&self, h: R) -> Jet<R> {
        self.pressure(&self.state(h))
    }

    fn first(&self) -> Jet<R> {
        self.pressure(&self.from)
    }

    /// Plain evaluation suffices, because the magnitude is that of the terms.
    fn precise(&self, h: R) -> DoubleDouble<R> {
        DoubleDouble::new(self.jet(h).value)
    }

    fn fourth(&self) -> R {
        let [factor, _] = self.system.pressure(self.system.wall(&self.from));
        factor.abs() * self.structure().bound::<4>(&self.begin.primary)
    }

    fn magnitude(&self) -> R {
        let [factor, constant] = self.system.pressure(self.system.wall(&self.from));
        factor.abs() * self.structure().bound::<0>(&self.begin.primary) + constant.abs()
    }

    /// The weight of the absorber holds it on its wall as long as the structure shakes less than that.
    fn stays_positive(&self) -> bool {
        let [factor, constant] = self.system.pressure(self.system.wall(&self.from));
        let gravity = self.system.excitation().gravity();
        let held = factor * gravity + constant;
        let shaking = || self.structure().bound::<0>(&self.begin.primary) - gravity.abs();
        held > 0.0 && held * HELD > factor.abs() * shaking()
    }
}
