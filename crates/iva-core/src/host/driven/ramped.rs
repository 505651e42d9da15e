//! A structure under a linear force and a linear acceleration of its base, in closed form.
//!
//! Under f/M = f + ḟ t and a_g = g + ġ t the motion in which the spring carries the load is uniform, of velocity
//! s = ḟ − ġ m. The motion about it is that without drive, from the velocity ẋ − s and the acceleration ẍ
//! ([`crate::host::oscillator`]):
//!
//! ```text
//! x(h) = x + ẋ h + curved,    ∬A = curved + g h²/2 + ġ h³/6.
//! ```

use super::Moment;
use crate::force::{Push, Pushes};
use crate::host::HostState;
use crate::host::oscillator::{Arrival, Equation, Oscillator, Primary};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// One mass on the spring and damper of a structure under a linear drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramped<R = f64> {
    oscillator: Oscillator<R>,
    /// The mass, m.
    mass: R,
}

impl<R: Real> Ramped<R> {
    /// A mass on the spring and damper of a structure of damping ratio ζ.
    pub(crate) fn new(mass: R, damping_ratio: R) -> Self {
        Self { oscillator: Oscillator::new(mass, damping_ratio), mass }
    }

    /// The structure without drive.
    pub(crate) fn oscillator(&self) -> &Oscillator<R> {
        &self.oscillator
    }

    /// The velocity and acceleration of the motion about the uniform one; `moves` is true if the base moves or gravity
    /// acts along the motion.
    #[inline(always)]
    fn about(&self, from: &HostState<Moment<R>, R>, moves: bool) -> [DoubleDouble<R>; 2] {
        let Pushes { primary: f, base: g } = &from.phase.pushes;
        if !moves {
            return [from.primary.v - f.rate, from.acceleration];
        }
        let carried = if self.mass == 1.0 { g.rate } else { g.rate.times(self.mass) };
        [from.primary.v - (f.rate - carried), from.acceleration - g.value]
    }

    /// Displacement and velocity after a motion of length h, and ∬A and ∫A.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(crate) fn moved(
        &self,
        from: &HostState<Moment<R>, R>,
        moves: bool,
        h: R,
    ) -> (Primary<R>, Arrival<R>) {
        let [velocity, acceleration] = self.about(from, moves);
        let mut gained = self.oscillator.arrive(velocity, acceleration, h);
        let Primary { x, v } = from.primary;
        let length = DoubleDouble::new(h);
        let primary =
            Primary { x: x.plus_both(v.product(length), gained.curved), v: v + gained.velocity };
        let Push { value, rate, .. } = from.phase.pushes.base;
        if moves {
            let Equation { third, .. } = self.oscillator.equation;
            let half_square = length.product(length).half();
            let sixth_cube = half_square.product(length).product(third);
            gained = Arrival {
                curved: gained
                    .curved
                    .plus_both(value.product(half_square), rate.product(sixth_cube)),
                velocity: gained
                    .velocity
                    .plus_both(value.product(length), rate.product(half_square)),
            };
        }
        (primary, gained)
    }

    /// ∬A, ∫A and A after a motion of length h, with the accuracy of plain numbers.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(crate) fn ahead(&self, from: &HostState<Moment<R>, R>, moves: bool, h: R) -> [R; 3] {
        let [v, a] = self.about(from, moves).map(|it| it.value);
        let [curved, gained, bend] = self.oscillator.ahead(v, a, h);
        let Push { value: g, rate, .. } = &from.phase.pushes.base;
        let (g, rate) = (g.value, rate.value * h);
        let square = h * h * 0.5;
        [
            square.mul_add(rate * (1.0 / 3.0) + g, curved),
            h.mul_add(rate * 0.5 + g, gained),
            bend + (g + rate),
        ]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::force::{Acts, Force, History, Record};
    use crate::host::{DrivenHost, Host, Source, Structure};
    use crate::number::clock::Clock;

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
    }

    /// A structure under a record, level or inclined, and a time at which a piece of it acts.
    fn planted(i: u32, acts: Acts) -> (DrivenHost, f64) {
        let u = |k| spread(i, k);
        let values = vec![2.0 * u(0) - 1.0, 2.0 * u(1) - 1.0, 0.0];
        let history = Arc::new(History::new(vec![0.0, 2.0, 3.0], values).unwrap());
        let record = Record { history, acts, rate: 1.0, scale: 1.0 };
        let force = Force::new(Vec::new(), vec![record], &[]).unwrap();
        let gravity = if u(2) < 0.5 { 0.0 } else { 0.3 };
        let damping_ratio = [0.0, 0.02, 0.3, 1.5][(4.0 * u(3)) as usize];
        (DrivenHost::new(damping_ratio, 0.3, force, gravity), u(4))
    }

    /// The motion by its power series: the reference is independent of the responses. Both round the terms from h⁴ on, of
    /// a motion of size 1, to doubles.
    #[test]
    fn the_motion_is_that_of_the_power_series() {
        for i in 1..2000 {
            let u = |k| spread(i, k);
            let acts = if u(5) < 0.5 { Acts::Primary } else { Acts::Base };
            let (host, time) = planted(i, acts);
            for structure in [host.free(), host.loaded()] {
                let phase = structure.source.renewed(&host.begin_at(Clock::new(time)));
                let [x, v] = [6, 7].map(|k| DoubleDouble::new(2.0 * u(k) - 1.0));
                let primary = Primary { x, v };
                let acceleration = structure.acceleration(&phase, &primary);
                let from = HostState { primary, acceleration, phase };
                let h = u(8) * structure.reach(&from);
                let ramped = structure.source.ramped().unwrap();
                let powers = structure.expanded(&from);
                let (reached, gained) = ramped.moved(&from, structure.moves_base(), h);
                let (expected, summed) = structure.summed(&from, &powers, h);
                let [curved, velocity, _] = ramped.ahead(&from, structure.moves_base(), h);
                let off = |a: DoubleDouble, b: DoubleDouble| (a - b).value.abs();
                let worst = off(reached.x, expected.x).max(off(reached.v, expected.v));
                assert!(worst < f64::EPSILON / 2.0, "{i}: {worst:e}");
                let worst = off(gained.curved, summed.curved);
                let worst = worst.max(off(gained.velocity, summed.velocity));
                assert!(worst < f64::EPSILON / 2.0, "{i}: {worst:e}");
                assert!((curved - summed.curved.value).abs() < 1e-15);
                assert!((velocity - summed.velocity.value).abs() < 1e-15);
            }
        }
    }
}
