//! The absorber stuck on a wall: one mass 1 + μ on the primary's spring and damper, until the pressure on the
//! wall changes sign.

use super::{Siva, SivaState};
use crate::absorber::system::Wall;
use crate::host::{Host, HostState, Integrated, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Curve, GapPoint, Jet, Losses, Motion, Quantity, Rows, Travel};
use crate::segment::taylor::ORDER;

/// The stick episode from one state.
#[derive(Debug, Clone, Copy)]
pub struct SivaRide<'a, H: Host> {
    siva: &'a Siva<H>,
    from: SivaState<Phase<H>, H::Real>,
    /// The state of the structure, with A of the mass 1 + μ.
    begin: HostState<Phase<H>, H::Real>,
    course: <H::Structure as Structure>::Course,
}

impl<'a, R: Real, H: Host<Real = R>> SivaRide<'a, H> {
    pub(super) fn new(siva: &'a Siva<H>, from: SivaState<Phase<H>, R>) -> Self {
        let loaded = siva.host.loaded();
        let acceleration = loaded.acceleration(&from.host.phase, &from.host.primary);
        let begin = HostState { acceleration, ..from.host };
        let course = loaded.fast_course(&begin);
        Self { siva, from, begin, course }
    }

    fn structure(&self) -> &'a H::Structure {
        self.siva.host.loaded()
    }
}

impl<R: Real, H: Host<Real = R>> Motion for SivaRide<'_, H> {
    type Real = R;
    type State = SivaState<Phase<H>, R>;
    const RIDING: bool = true;

    fn origin(&self) -> &Self::State {
        &self.from
    }

    fn reach(&self) -> R {
        self.structure().reach(&self.begin)
    }

    fn state(&self, h: R) -> Self::State {
        let host = R::dispatched(
            #[inline(always)]
            || self.structure().flown(&self.begin, &self.course, h).to,
        );
        SivaState { host, ..self.from }
    }

    fn arrival(&self, h: R) -> Self::State {
        let mut state = self.state(h);
        self.siva.host.free().refresh(&mut state.host);
        state
    }

    fn primary(&self, h: R) -> Jet<R> {
        R::dispatched(
            #[inline(always)]
            || self.structure().jet(&self.begin, &self.course, h),
        )
    }

    fn acceleration(&self, h: R) -> R {
        let HostState { primary, phase, .. } = self.state(h).host;
        self.siva.host.absolute(self.structure().acceleration(&phase, &primary))
    }

    fn gap(&self, _h: R) -> GapPoint<R> {
        GapPoint { y: self.siva.offset + self.from.side * self.siva.clearance, w: R::ZERO }
    }

    fn wall(&self) -> Option<Wall> {
        Some(if self.from.side > 0.0 { Wall::Plus } else { Wall::Minus })
    }

    fn losses(&self, h: R) -> Losses<R> {
        let motion = Integrated {
            from: &self.begin,
            course: &self.course,
            mass_ratio: self.siva.mass_ratio,
            gap_velocity: None,
        };
        let [viscous, work] = R::dispatched(
            #[inline(always)]
            || self.structure().losses(&motion, h),
        );
        Losses { viscous, pivot: R::ZERO, work }
    }

    fn square(&self, h: [R; 2]) -> R {
        R::dispatched(
            #[inline(always)]
            || self.structure().square(&self.begin, &self.course, h),
        )
    }

    fn largest(&self, of: Quantity, least: R, length: R, end: &Self::State) -> Option<R> {
        R::dispatched(
            #[inline(always)]
            || self.structure().largest(of, least, (&self.begin, &self.course), &end.host, length),
        )
    }

    fn rows(&self) -> Option<Rows<R>> {
        R::dispatched(
            #[inline(always)]
            || self.structure().rows(&self.begin, &self.course),
        )
    }

    fn travel(&self) -> Option<Travel<R>> {
        let mut gap = [R::ZERO; ORDER + 1];
        gap[0] = self.siva.offset + self.from.side * self.siva.clearance;
        let rows = self.structure().series(&self.begin, &self.course);
        Some(Travel::new(rows, gap, R::ONE))
    }
}

impl<R: Real, H: Host<Real = R>> Curve for SivaRide<'_, H> {
    type Real = R;
    type Sample = SivaState<Phase<H>, R>;

    fn sample(&self, h: R) -> Self::Sample {
        self.state(h)
    }

    /// The pressure on the wall, which changes sign at the release.
    fn jet(&self, sample: &Self::Sample) -> Jet<R> {
        let factor = -sample.side;
        let HostState { primary, phase, .. } = &sample.host;
        let a = self.structure().acceleration(phase, primary).value;
        let [jerk, snap, crackle] = self.structure().derivatives(phase, primary.v.value, a);
        Jet {
            value: factor * a,
            rate: factor * jerk,
            curvature: factor * snap,
            jerk: factor * crackle,
        }
    }

    /// Plain evaluation suffices, because the magnitude is that of the terms.
    fn precise(&self, h: R) -> DoubleDouble<R> {
        DoubleDouble::new(self.jet(&self.state(h)).value)
    }

    fn fourth(&self) -> R {
        self.structure().bound::<4>(&self.begin.primary)
    }

    fn magnitude(&self) -> R {
        self.structure().bound::<0>(&self.begin.primary)
    }
}
