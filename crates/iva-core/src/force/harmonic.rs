//! A harmonic force: its values, Taylor coefficients and bounds, with a phase that does not drift.

use super::{Acts, Push};
use crate::error::{Invalid, number};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::series::{ORDER, unrolled};
use crate::number::trigonometry::{plain_sine_cosine, sine_cosine};
use crate::range;

/// Largest phase in rad: reduced to one turn in double-double, it still has some 20 digits.
const LARGEST_PHASE: f64 = 1e9;

/// amplitude · cos(Ω t + phase), per unit mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic<R = f64> {
    /// f/M or a_g, in ωn² × length.
    pub amplitude: R,
    /// Ω in ωn.
    pub frequency: R,
    /// Phase at time zero, in rad.
    pub phase: R,
    /// The body that it acts on.
    pub acts: Acts,
}

impl<R: Real> Harmonic<R> {
    pub(super) fn check(&self) -> Result<(), Invalid> {
        range::size("force.amplitude", self.amplitude)?;
        range::positive("force.frequency", self.frequency)?;
        if self.phase.abs() <= LARGEST_PHASE {
            return Ok(());
        }
        let rule = format!("give a phase in rad, of size {LARGEST_PHASE:e} at most");
        Err(Invalid::new("force.phase", number(self.phase), rule))
    }

    /// Adds its Taylor coefficients about an instant, in powers of t/h.
    #[inline(always)]
    pub(crate) fn add<const LENGTH: usize>(
        &self,
        row: &mut [R; LENGTH],
        time: DoubleDouble<R>,
        h: R,
    ) {
        let (s, c) = R::precise_sincos(self.angle(time));
        let turns = [c.value, -s.value, -c.value, s.value];
        let turn = self.frequency * h;
        // power = amplitude · turnᵏ/k!.
        let mut power = self.amplitude;
        let mut term = |k: usize| {
            power *= if k > 0 { turn * R::reciprocal(k) } else { R::ONE };
            row[k] += power * turns[k % 4];
        };
        unrolled!(k < if LENGTH > ORDER { ORDER + 1 } else { LENGTH } => term(k));
        (ORDER + 1..LENGTH).for_each(term);
    }

    /// Its Taylor coefficients about an instant, in powers of t/h, from value and rate there.
    #[inline(always)]
    pub(crate) fn onwards(&self, push: &Push<R>, h: R) -> [R; ORDER + 1] {
        let turn = self.frequency * h;
        let square = -(turn * turn);
        let mut row = [R::ZERO; ORDER + 1];
        (row[0], row[1]) = (push.value.value, push.rate.value * h);
        unrolled!(k < ORDER - 1 => {
            row[k + 2] = row[k] * (square * (R::reciprocal(k + 1) * R::reciprocal(k + 2)));
        });
        row
    }

    /// Its value and derivatives at an instant.
    #[inline(always)]
    pub(crate) fn push(&self, time: DoubleDouble<R>) -> Push<R> {
        let (s, c) = R::precise_sincos(self.angle(time));
        let rate = DoubleDouble::new(self.frequency).times(self.amplitude);
        let second = rate.times(self.frequency);
        Push {
            value: c.times(self.amplitude),
            rate: -s.times_sum(rate),
            second: -c.times_sum(second),
            third: s.value * (second.value * self.frequency),
        }
    }

    /// [`Harmonic::push`] with the accuracy of plain numbers.
    #[inline(always)]
    pub(crate) fn plain_push(&self, time: DoubleDouble<R>) -> Push<R> {
        let ([value, quadrature], omega) = (self.turned(time), self.frequency);
        let square = omega * omega;
        Push {
            value: DoubleDouble::new(value),
            rate: DoubleDouble::new(-omega * quadrature),
            second: DoubleDouble::new(-square * value),
            third: square * (omega * quadrature),
        }
    }

    /// The same in doubles.
    pub(crate) fn in_doubles(&self) -> Harmonic {
        let Self { amplitude, frequency, phase, acts } = *self;
        let [amplitude, frequency, phase] = [amplitude, frequency, phase].map(R::double);
        Harmonic { amplitude, frequency, phase, acts }
    }

    /// amplitude · cos and amplitude · sin of its angle at an instant, in plain numbers.
    #[inline(always)]
    pub(crate) fn turned(&self, time: DoubleDouble<R>) -> [R; 2] {
        let (s, c) = plain_sine_cosine(self.angle(time));
        [self.amplitude * c, self.amplitude * s]
    }

    /// Its largest size between two instants: the amplitude if an extremum lies between them.
    pub(super) fn largest_between(&self, [from, to]: [R; 2]) -> R {
        let half_turns = |time: R| (self.frequency * time + self.phase) / (R::TURN.value * 0.5);
        let crests = half_turns(from).ceil() <= half_turns(to);
        let at = |time: R| self.push(DoubleDouble::new(time)).value.value.abs();
        if crests { self.amplitude.abs() } else { at(from).max(at(to)) }
    }

    /// The largest size of its derivative of this order.
    pub(crate) fn largest(&self, order: i32) -> R {
        (0..order).fold(self.amplitude.abs(), |size, _| size * self.frequency)
    }

    /// Adds its Taylor coefficients about an instant, in powers of t/h, in double-double.
    pub(crate) fn add_precise(&self, row: &mut [DoubleDouble<R>], time: DoubleDouble<R>, h: R) {
        let (mut s, mut c) = sine_cosine(self.angle(time));
        let turn = DoubleDouble::new(self.frequency).times(h);
        for (k, coefficient) in row.iter_mut().enumerate() {
            *coefficient = *coefficient + c.times(self.amplitude);
            let by = turn.over((k + 1) as f64);
            (s, c) = (by * c, -(by * s));
        }
    }

    /// The bound of [`super::Force::left_out`]: twice its first term, |amplitude| (Ωh)ᴺ/N!, as each term is at most
    /// half the one before; ∞ where that is not so.
    #[inline(always)]
    pub(crate) fn left_out<const N: usize>(&self, h: R) -> R {
        let turn = self.frequency * h;
        let mut first = R::from(2.0);
        unrolled!(k < N => first *= turn * R::reciprocal(k + 1));
        let halves = turn * 2.0 <= (N + 1) as f64;
        if halves { self.amplitude.abs() * first } else { R::INFINITY }
    }

    /// The angle Ω t + phase in rad, reduced to [−π, π].
    #[inline(always)]
    pub(crate) fn angle(&self, time: DoubleDouble<R>) -> DoubleDouble<R> {
        let angle = time.times(self.frequency).plus(self.phase);
        let turns = (angle.value / R::TURN.value).round();
        angle - R::TURN.times(turns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_lie_on_the_circle() {
        for k in -40..=40 {
            let angle = DoubleDouble::new(f64::from(k) * 0.0785);
            let (s, c) = sine_cosine(angle);
            let off = s * s + c * c - DoubleDouble::new(1.0);
            assert!(off.value.abs() < 1e-30, "{k}: {:e}", off.value);
            assert!((s.value - angle.value.sin()).abs() < 2e-16);
            assert!((c.value - angle.value.cos()).abs() < 2e-16);
        }
    }

    #[test]
    fn the_series_from_value_and_rate_is_that_of_the_angle() {
        for (frequency, phase, time) in [(1.3, 0.0, 0.0), (0.05, 2.0, 40.0), (7.0, -9.1, 0.3)] {
            let acts = Acts::Primary;
            let harmonic = Harmonic { amplitude: -0.3, frequency, phase, acts };
            let (time, h) = (DoubleDouble::new(time), 2.0 / frequency);
            let mut row = [0.0; ORDER + 1];
            harmonic.add(&mut row, time, h);
            let onwards = harmonic.onwards(&harmonic.push(time), h);
            for (k, (found, expected)) in onwards.iter().zip(row).enumerate() {
                assert!((found - expected).abs() < 4e-16 * 0.3 * 2.0, "{frequency} {k}");
                assert!((found / expected - 1.0).abs() < 1e-14 || expected.abs() < 1e-17, "{k}");
            }
        }
    }

    #[test]
    fn the_first_coefficients_are_those_of_the_series() {
        for (frequency, phase, time) in [(1.3, 0.0, 0.0), (0.05, 2.0, 40.0), (7.0, -9.1, 0.3)] {
            let harmonic = Harmonic { amplitude: -0.3, frequency, phase, acts: Acts::Primary };
            let time = DoubleDouble::new(time);
            let mut row = [0.0; 4];
            harmonic.add(&mut row, time, 1.0);
            let [push, plain] = [harmonic.push(time), harmonic.plain_push(time)];
            for ahead in [push.ahead::<4>(), plain.ahead()] {
                for (k, (found, expected)) in ahead.iter().zip(row).enumerate() {
                    let size = 0.3 * frequency.powi(k as i32);
                    assert!((found - expected).abs() < 4e-16 * size, "{frequency} {k}");
                }
            }
        }
    }

    #[test]
    fn plain_pushes_are_pushes_rounded() {
        let harmonic = Harmonic { amplitude: -0.3, frequency: 1.3, phase: 2.0, acts: Acts::Base };
        for k in -300..300 {
            let time = DoubleDouble::new(f64::from(k) * 0.37);
            let (plain, push) = (harmonic.plain_push(time), harmonic.push(time));
            let off = [
                plain.value.value - push.value.value,
                plain.rate.value - push.rate.value,
                plain.second.value - push.second.value,
                plain.third - push.third,
            ];
            assert!(off.iter().all(|off| off.abs() < 3e-16), "{k}: {off:?}");
        }
    }

    #[test]
    fn the_largest_size_is_that_of_a_crest_or_of_an_end() {
        // Samples fall short of an extremum by less than (0.005 · 1.3)²/2 of the amplitude.
        for (phase, amplitude) in [(0.0, 1.0), (-7.0, 0.3), (2.0, -0.5), (9.1, 2.0)] {
            let harmonic = Harmonic { amplitude, frequency: 1.3, phase, acts: Acts::Base };
            for (from, length) in [(0.0, 0.0), (0.0, 0.4), (1.7, 0.9), (0.3, 5.0), (40.0, 0.2)] {
                let at = |k: i32| {
                    let time = from + length * f64::from(k) / 1000.0;
                    (amplitude * (1.3 * time + phase).cos()).abs()
                };
                let sampled = (0..=1000).map(at).fold(0.0, f64::max);
                let found = harmonic.largest_between([from, from + length]);
                assert!((found - sampled).abs() < 2.2e-5 * amplitude.abs(), "{found} {sampled}");
                assert!(found >= sampled - 1e-15, "{phase} {from} {length}");
            }
        }
    }

    #[test]
    fn the_phase_does_not_drift() {
        // After a million whole periods (2π in double-double) the reduced angle equals the phase.
        let harmonic = Harmonic { amplitude: 1.0, frequency: 1.0, phase: 0.5, acts: Acts::Primary };
        let time = f64::TURN.times(1e6);
        assert!((harmonic.angle(time).value - 0.5).abs() < 2e-16);
    }
}
