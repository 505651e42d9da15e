//! The largest displacements of the absorber and the largest acceleration of the structure in a run.
//!
//! They are extrema of the power series of the motion, not of samples. The series are computed only where bounds on the
//! accelerations leave open whether anything grows.

use crate::absorber::impact::Impact;
use crate::absorber::{Absorber, Wall};
use crate::engine::observe::{Contact, Each, Observer, Span};
use crate::engine::simulate::{Instant, Outcome, Tally};
use crate::number::real::Real;
use crate::segment::flight::{Motion, Travel};
use crate::segment::polynomial::{largest, range};

/// The extremes of a run, those of the gap for one absorber, in natural units; `None` where the run does not define one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExtremeValues<R = f64> {
    /// Largest |y|.
    pub gap_displacement: Option<R>,
    /// Largest minus least y.
    pub stroke: Option<R>,
    /// Largest displacement of the absorber's centre of mass, in the coordinates of x.
    pub absorber_displacement: Option<R>,
    /// Largest |ẍ + a_g| between impacts.
    pub acceleration: Option<R>,
}

/// An observer that finds the extremes of a run from a given instant on.
#[derive(Debug, Clone)]
pub struct Extremes<R = f64> {
    from: R,
    /// What each absorber reaches; one without absorber.
    reaches: Vec<Reach<R>>,
    acceleration: R,
    /// False once a motion had no known series.
    known: bool,
    values: Vec<ExtremeValues<R>>,
}

/// What one absorber reaches.
#[derive(Debug, Clone)]
struct Reach<R> {
    /// Gap displacement y at wall − and wall +.
    walls: [R; 2],
    /// Least and largest y.
    gap: Option<[R; 2]>,
    absorber: R,
}

impl<R: Real> Reach<R> {
    fn take(&mut self, travel: &Travel<R>, t: [R; 2]) {
        let Travel { rows, gap, absorber } = travel;
        let terms = ..=rows.order;
        self.absorber = largest(&absorber[terms], t, self.absorber);
        let [low, high] = self.walls;
        if self.gap == Some(self.walls) {
            return;
        }
        let so_far = self.gap.unwrap_or([R::INFINITY, -R::INFINITY]);
        // The flight is proved to stay in the gap; rounding errors of the series could exceed it.
        self.gap = Some(range(&gap[terms], t, so_far).map(|y| y.max(low).min(high)));
    }
}

impl<R: Real> Extremes<R> {
    /// Starts to look at an instant, in 1/ωn.
    pub fn new(from: R) -> Self {
        let (reaches, values) = (Vec::new(), Vec::new());
        Self { from, reaches, acceleration: R::ZERO, known: true, values }
    }

    /// The extremes for each absorber, for one without absorber; complete once the run has ended.
    pub fn values(&self) -> &[ExtremeValues<R>] {
        &self.values
    }

    /// True if a span of length h surely raises no extreme: a displacement leaves its chord by at most h²/8 times its
    /// largest acceleration.
    fn covers<S: Absorber<Real = R>, M>(&self, system: &S, span: &Span<'_, M>) -> bool
    where
        M: Motion<Real = R, State = S::State>,
    {
        let [Reach { walls: [low, high], gap: Some([least, largest]), absorber }] =
            self.reaches[..]
        else {
            return false;
        };
        let Some(most) = span.motion.accelerations(span.length) else { return false };
        let bent = span.length * span.length * 0.125;
        let ends = [span.motion.origin(), span.end].map(|state| {
            let s = system.wall(state).sign();
            let y = system.offset_of(0) + (system.clearance() - system.distance(state).value) * s;
            (y, (system.primary(state).x + system.beside(0, [y, R::ZERO, R::ZERO])[0]).abs())
        });
        let [(from, p), (to, q)] = ends;
        let reach = bent * most.gap;
        (most.structure < self.acceleration)
            & (p.max(q) + bent * most.absorber < absorber)
            & (least <= (from.min(to) - reach).max(low))
            & (largest >= (from.max(to) + reach).min(high))
    }
}

impl<R: Real, S: Absorber<Real = R>> Observer<S> for Extremes<R> {
    fn start(&mut self, system: &S, _from: &Instant<S::State, R>, _duration: R) {
        let reaches = (0..system.absorbers().max(1)).map(|absorber| Reach {
            walls: system.walls_of(absorber),
            gap: None,
            absorber: R::ZERO,
        });
        *self = Self { reaches: reaches.collect(), ..Self::new(self.from) };
    }

    fn span<M: Motion<Real = R, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        let begin = (-span.start.minus(self.from)).max(0.0);
        if begin > span.length || (begin == 0.0 && self.covers(system, span)) {
            return;
        }
        for (absorber, reach) in self.reaches.iter_mut().enumerate() {
            let Some(travel) = span.motion.travel_of(absorber) else {
                self.known = false;
                return;
            };
            let t = [begin, span.length].map(|h| h / travel.rows.step);
            if absorber == 0 {
                let rows = &travel.rows;
                let accelerations = &rows.acceleration[..=rows.order];
                self.acceleration = largest(accelerations, t, self.acceleration);
            }
            reach.take(&travel, t);
        }
    }

    fn coast<M>(&mut self, system: &S, whole: &Span<'_, M>, each: Each<'_, M>)
    where
        M: Motion<Real = R, State = S::State>,
    {
        let counts = whole.start.minus(self.from) >= 0.0;
        if !(counts && self.covers(system, whole)) {
            each(&mut |span| self.span(system, span));
        }
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, R>) {
        if contact.time >= self.from {
            self.acceleration = contact.hardest_shaking(system, self.acceleration);
        }
    }

    /// At an impact y is set to the position of the wall, free of rounding errors.
    fn impact(&mut self, _system: &S, impact: &Impact<R>) {
        let absorber = usize::from(impact.absorber);
        if let Some(reach) = self.reaches.get_mut(absorber).filter(|_| impact.time >= self.from) {
            let [low, high] = reach.walls;
            let y = if impact.wall == Wall::Plus { high } else { low };
            let [least, most] = reach.gap.unwrap_or([y; 2]);
            reach.gap = Some([least.min(y), most.max(y)]);
        }
    }

    fn end(&mut self, _system: &S, tally: &Tally<S::State, R>) {
        if !self.known || tally.outcome != Outcome::Finished {
            return;
        }
        let of = |reach: &Reach<R>| {
            let [least, most] = reach.gap?;
            Some(ExtremeValues {
                gap_displacement: Some(most.max(-least)),
                stroke: Some(most - least),
                absorber_displacement: Some(reach.absorber),
                acceleration: Some(self.acceleration),
            })
        };
        self.values = self.reaches.iter().filter_map(of).collect();
    }
}
