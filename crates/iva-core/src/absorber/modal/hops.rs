//! Hops: flights so low that a polynomial of the fourth degree is the motion.
//!
//! In a chatter most rebounds are lower than 10⁻⁶ of the clearance. A member that leaves its wall with a speed r is pressed back with −A and returns after
//! τ = 2r/|A|. While all that moves has rates of Λ at most, A changes in that time by less than Λτ of the size T of its terms, its third derivative is below
//! Λ³ T, and what the polynomial
//!
//! ```text
//! D(τ) = D + Ḋ τ + A τ²/2 + Ȧ τ³/6 + Ä τ⁴/24
//! ```
//!
//! leaves out is below Λ³ T τ⁵/120. Where that is less than the rounding of the hop itself, Ḋ τ, nothing of a longer series would be seen, for this member or for any
//! other. All others must be seen to stay clear of their walls, or on them, by these polynomials, or meet theirs; what is not seen at once is left to the search of
//! contacts.

use super::state::Place;
use super::swings::Grown;
use super::{Modal, ModalState};
use crate::absorber::Hop;
use crate::force::Force;
use crate::host::{Host, Structure as _};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// Largest speed that a hop begins with, in clearances times Λ: that of others is not looked at.
const FASTEST: f64 = 1e-4;
/// Room for what Λ³ T counts too small.
const SAFE: f64 = 8.0;
/// By how much later than the end of the hop another member may meet its wall and is clear of it at once, over its length.
const LATER: f64 = 1e-6;
/// Smallest share of Ḋ² that a discriminant may be, so that a grazing is left to the search.
const CERTAIN: f64 = 1e-3;
/// Steps of Newton's method from the root of the parabola, which is right to Λτ.
const STEPS: usize = 3;

/// The distance of a member from its wall in powers of time, or the pressure on it.
#[derive(Debug, Clone, Copy)]
struct Path<R> {
    powers: [R; 5],
    /// Λ³ T.
    third: R,
}

impl<R: Real> Path<R> {
    fn at(&self, t: R) -> R {
        self.powers.iter().rev().fold(R::ZERO, |sum, power| sum.mul_add(t, *power))
    }

    fn rate(&self, t: R) -> R {
        let [_, first, second, third, fourth] = self.powers;
        first + t * (second * 2.0 + t * (third * 3.0 + t * (fourth * 4.0)))
    }

    /// When the distance is 0 next: infinite if it is not, `None` if that is not seen.
    fn met(&self) -> Option<R> {
        let [distance, rate, bend, ..] = self.powers;
        let touching = distance == 0.0;
        if rate >= 0.0 && bend >= 0.0 {
            return (!touching || rate > 0.0).then_some(R::INFINITY);
        }
        let square = rate * rate - distance * bend * 4.0;
        if square.abs() < rate * rate * CERTAIN || rate == 0.0 {
            return None;
        }
        if square < 0.0 {
            return Some(R::INFINITY);
        }
        // The later root of a path that falls away from 0 at its begin, the first one of any other.
        let root = square.sqrt();
        let guess = if bend < 0.0 && rate > 0.0 {
            (rate + root) / (bend * -2.0)
        } else {
            distance * 2.0 / (root - rate)
        };
        Some(guess)
    }

    /// True if it is proved that the distance is not 0 up to a time.
    fn clears(&self, t: R) -> bool {
        let [distance, rate, bend, third, fourth] = self.powers;
        let square = t * t;
        let rest = square * (third.abs() + fourth.abs() * t + self.third * square);
        if distance == 0.0 {
            return rate + bend.min(R::ZERO) * t > rest;
        }
        let end = distance + t * (rate + bend * t);
        let turns = rate < 0.0 && -rate < bend * t * 2.0;
        let lowest = if turns { distance - rate * rate / (bend * 4.0) } else { end.min(distance) };
        lowest > rest * t + distance * (R::EPSILON * SAFE)
    }

    /// The root near a guess; of a path that begins at 0 the other one.
    fn refined(&self, guess: R) -> R {
        let touching = self.powers[0] == 0.0;
        (0..STEPS).fold(guess, |t, _| {
            if touching {
                let [_, a, b, c, d] = self.powers;
                let value = a + t * (b + t * (c + t * d));
                t - value / (b + t * (c * 2.0 + t * (d * 3.0)))
            } else {
                t - self.at(t) / self.rate(t)
            }
        })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// Which members are stuck and press on their walls by more than rounding, one bit each.
    pub(super) fn pressed_by(&self, state: &ModalState<H, N, M>) -> u64 {
        let stuck = |k: &usize| state.places[*k].stuck && self.friction[*k] == 0.0;
        let all = (0..self.count()).filter(stuck);
        if !R::FAST_PATHS || all.clone().count() < 2 {
            return 0;
        }
        let pushes = self.pushes(&state.phase, R::ONE);
        let asides = self.asides(&state.phase, R::ONE, 2);
        let regime = self.regime(&state.places);
        let grown = self.grown(state, &regime, (&pushes, asides.as_slice()), R::ONE, (2, 0));
        let presses = |k: &usize| {
            let place = &state.places[*k];
            let curved = self.curved(&grown, (*k, place), |m| pushes(m)[1], (R::ONE, 2));
            let least = self.terms(state, *k) * (R::EPSILON * SAFE * SAFE);
            -place.side * curved.plain(2) * 2.0 > least
        };
        all.filter(presses).fold(0, |set, k| set | 1 << k)
    }

    /// The next contact, if it is at the end of a hop.
    pub(super) fn hopped(
        &self,
        state: &ModalState<H, N, M>,
        remaining: R,
    ) -> Option<Hop<ModalState<H, N, M>, R>> {
        if !R::FAST_PATHS || self.oscillates() {
            return None;
        }
        let members = || state.places[..self.count()].iter().enumerate();
        let slow = |(k, place): (usize, &Place<R>)| {
            let leaves = place.distance.value == 0.0 && !place.carried() && place.rate.value > 0.0;
            leaves && place.rate.value <= self.masses[k].clearance * FASTEST
        };
        let plain = |(k, place): (usize, &Place<R>)| self.friction[k] == 0.0 && !place.leaves;
        if !members().any(slow) || !members().all(plain) {
            return None;
        }
        let (pushes, asides) =
            (self.pushes(&state.phase, R::ONE), self.asides(&state.phase, R::ONE, 4));
        let regime = self.regime(&state.places);
        let grown = self.grown(state, &regime, (&pushes, asides.as_slice()), R::ONE, (4, 0));
        let drive = self.host.force().map_or(R::ZERO, Force::fastest);
        let structure = R::larger(drive, self.whole.growth());
        let fastest = R::larger(structure, self.swinging_rate(&state.places));
        let cube = fastest * fastest * fastest * SAFE;
        let paths: [Path<R>; N] = std::array::from_fn(|k| {
            let place = &state.places[k.min(self.count() - 1)];
            if k >= self.count() {
                return Path { powers: [R::ZERO; 5], third: R::ZERO };
            }
            let curved = self.curved(&grown, (k, place), |m| pushes(m)[1], (R::ONE, 4));
            let [second, third, fourth] = [2, 3, 4].map(|m| curved.plain(m) * place.side);
            let powers = match place.stuck {
                true => [second * -2.0, third * -6.0, fourth * -24.0, R::ZERO, R::ZERO],
                false => [place.distance.value, place.rate.value, second, third, fourth],
            };
            let own = self
                .hanging(k)
                .map_or(R::ZERO, |is| self.pulling(k, is, place) / (is.mass_ratio * is.lever));
            Path { powers, third: cube * (self.terms(state, k) + own) }
        });
        let mut first: Option<(usize, R)> = None;
        for (k, _) in members().filter(|(_, place)| !place.stuck) {
            let at = paths[k].met()?;
            if first.is_none_or(|(_, time)| at < time) {
                first = Some((k, at));
            }
        }
        let (absorber, guess) = first?;
        let time = paths[absorber].refined(guess);
        let smooth = self.host.smooth_for(&state.phase).min(remaining);
        if !(time > 0.0 && time < smooth && (time - guess).abs() < guess * CERTAIN) {
            return None;
        }
        let later = time * (1.0 + LATER);
        let seen = |(k, place): (usize, &Place<R>)| {
            let Path { powers, third } = &paths[k];
            let [first, second, bend, ..] = powers.map(R::abs);
            if place.stuck {
                let lost = later * (second + later * (bend + later * *third));
                return powers[0] > lost + self.terms(state, k) * (R::EPSILON * SAFE);
            }
            let own = second + bend * time;
            let exact = *third * time.powi(4) <= own * (R::EPSILON * 120.0);
            // One that is there at the same instant touches its wall with it (`Absorber::touch`).
            let together = paths[k].at(time).abs() <= own * time * (R::EPSILON * SAFE)
                && paths[k].rate(time) < 0.0;
            let settled = k == absorber || together || paths[k].clears(later);
            exact && settled && self.masses[k].half_play() > first + own * later
        };
        if !members().all(seen) {
            return None;
        }
        let mut end = self.after_hop(state, &grown, &paths, time);
        // What the polynomial leaves of it is rounding.
        end.places[absorber].distance = DoubleDouble::ZERO;
        Some(Hop { time, absorber, end })
    }

    /// The state after a hop.
    fn after_hop(
        &self,
        state: &ModalState<H, N, M>,
        grown: &Grown<'_, R>,
        paths: &[Path<R>; N],
        time: R,
    ) -> ModalState<H, N, M> {
        let mut end = state.renewed();
        for j in 0..self.whole.count() {
            let [second, third, fourth] = [2, 3, 4].map(|m| grown.rows.plain(j, m));
            let bent = time * time * (second + time * (third + time * fourth));
            let gained = time * (second * 2.0 + time * (third * 3.0 + time * (fourth * 4.0)));
            let modes = &mut end.modes;
            modes.places[j] = modes.places[j] + modes.velocities[j].times(time).plus(bent);
            modes.velocities[j] = modes.velocities[j].plus(gained);
        }
        for (place, path) in end.places[..self.count()].iter_mut().zip(paths) {
            if place.stuck {
                continue;
            }
            let [_, _, second, third, fourth] = path.powers;
            let bent = time * time * (second + time * (third + time * fourth));
            let gained = path.rate(time) - path.powers[1];
            place.distance =
                place.distance.plus_both(place.rate.times(time), DoubleDouble::new(bent));
            place.rate = place.rate.plus(gained);
        }
        let free = self.host.free();
        end.phase = free.renewed(&free.within(&state.phase, time));
        end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
    }

    /// Paths that return to a planted instant t from their wall or from above it: found there, not before, and nothing is seen of another one.
    #[test]
    fn a_planted_contact_is_found_and_nothing_before_it() {
        for i in 1..4000 {
            let t = 10_f64.powf(-4.0 - 10.0 * spread(i, 0));
            let [second, third, fourth] = [1, 2, 3].map(|k| 2.0 * spread(i, k) - 1.0);
            // D/(t − τ) is a polynomial without another root up to t.
            let above = if i.is_multiple_of(2) { 0.0 } else { spread(i, 4) * t };
            let bend = -(0.2 + second.abs());
            let [third, fourth] = [third * 0.5, fourth * 0.5];
            // D = (t − τ)(a + b τ + c τ² + d τ³) with a + b τ > 0.
            let [a, b, c, d] = [above * 0.5, -bend, third, fourth];
            let powers = [a * t, b * t - a, c * t - b, d * t - c, -d];
            let path = Path { powers, third: 1.0 };
            let Some(guess) = path.met() else { continue };
            let found = path.refined(guess);
            assert!((found / t - 1.0).abs() < 1e-13, "{i}: {found} {t}");
            assert!(path.clears(t * 0.99), "{i}");
            assert!(!path.clears(t * 1.01), "{i}");
        }
    }

    /// Where a path is said to be clear it is above its wall at all instants.
    #[test]
    fn a_clear_path_meets_nothing() {
        let (mut clear, mut all) = (0, 0);
        for i in 1..20_000 {
            let t = 10_f64.powf(-6.0 * spread(i, 0));
            let [rate, bend, third, fourth] = [1, 2, 3, 4].map(|k| 2.0 * spread(i, k) - 1.0);
            let distance = if i.is_multiple_of(3) { 0.0 } else { spread(i, 5) * t };
            let path = Path { powers: [distance, rate, bend, third, fourth], third: 0.0 };
            all += 1;
            if path.clears(t) {
                clear += 1;
                let instants = (1..=400).map(|k| t * f64::from(k) / 400.0);
                assert!(instants.map(|at| path.at(at)).all(|distance| distance > 0.0), "{i}");
            }
        }
        assert!(clear > all / 4, "{clear} of {all}");
    }
}
