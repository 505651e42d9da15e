//! A flight in the gap, or a stick episode on a wall.

use super::{Coupled, CoupledState, Coupling, jet};
use crate::absorber::siva::trial::fast_flight;
use crate::absorber::{Absorber, Wall};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::{Curve, FastFlight, GapPoint, Jet, Losses, Motion};
use crate::segment::polynomial::product_integral;
use crate::segment::taylor::{Row, horner};

/// A motion of a coupled mass: its power series.
#[derive(Debug)]
pub struct Segment<'a, C: Coupling, const STUCK: bool> {
    system: &'a Coupled<C>,
    from: CoupledState<C::Real>,
    series: [Row<C::Real>; 4],
}

impl<'a, C: Coupling, const STUCK: bool> Segment<'a, C, STUCK> {
    pub(super) fn new(system: &'a Coupled<C>, from: CoupledState<C::Real>) -> Self {
        let series = system.series(&from, STUCK);
        Self { system, from, series }
    }
}

impl<R: Real, C: Coupling<Real = R>, const STUCK: bool> Motion for Segment<'_, C, STUCK> {
    type Real = R;
    type State = CoupledState<R>;
    const RIDING: bool = STUCK;

    fn origin(&self) -> &CoupledState<R> {
        &self.from
    }

    fn reach(&self) -> R {
        self.system.reach()
    }

    fn state(&self, h: R) -> CoupledState<R> {
        self.system.later(&self.from, &self.series, STUCK, h)
    }

    fn fast_path(&self, length: R) -> Option<FastFlight<CoupledState<R>, R>> {
        if STUCK || !R::FAST_PATHS {
            return None;
        }
        fast_flight(self.system, &self.from, length, self.system.clearance())
    }

    fn primary(&self, h: R) -> Jet<R> {
        jet(&self.system.series::<R>(&self.state(h), STUCK)[0])
    }

    fn gap(&self, h: R) -> GapPoint<R> {
        let [_, _, y, w] = self.system.variables(&self.state(h));
        GapPoint { y, w }
    }

    fn wall(&self) -> Option<Wall> {
        STUCK.then(|| self.system.wall(&self.from))
    }

    fn losses(&self, h: R) -> Losses<R> {
        let square = |row: &Row<R>| product_integral(row, row, h);
        let ([viscous, pivot], [_, v, w, _]) = (self.system.coupling.dampers(), &self.series);
        Losses { viscous: viscous * square(v), pivot: pivot * square(w), work: R::ZERO }
    }
}

/// The distance to the wall in flight, the pressure on the wall if stuck.
impl<R: Real, C: Coupling<Real = R>, const STUCK: bool> Curve for Segment<'_, C, STUCK> {
    type Real = R;
    type Sample = CoupledState<R>;

    fn sample(&self, h: R) -> CoupledState<R> {
        self.state(h)
    }

    fn jet(&self, sample: &CoupledState<R>) -> Jet<R> {
        jet(&self.system.series::<R>(sample, STUCK)[3])
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let series = self.system.series::<DoubleDouble<R>>(&self.from, STUCK);
        horner(&series[3], DoubleDouble::new(h))
    }

    fn fourth(&self) -> R {
        self.system.most(&self.from) * self.system.growth.powi(5)
    }

    fn magnitude(&self) -> R {
        if STUCK {
            self.system.most(&self.from) * self.system.growth
        } else {
            self.system.clearance()
        }
    }
}
