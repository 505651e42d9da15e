//! The kind of motion to which a driven run settles.

use crate::number::real::Real;

use std::collections::VecDeque;
use std::fmt;

use super::Strobe;

/// Longest period that is tested, in cycles of the force.
const LONGEST: usize = 8;
/// Number of consecutive states that must return.
const RETURNS: usize = 20;
/// Number of states that are kept for the test.
pub(super) const RETURNS_KEPT: usize = LONGEST + RETURNS;
/// Largest distance between a state and the one a period before, over the amplitude.
const CLOSE: f64 = 1e-6;

/// The kind of a driven motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// No impact in the window.
    NoImpacts,
    /// The state returns after at most 8 cycles.
    Periodic {
        /// Number of listed impacts per period.
        impacts: u64,
        /// Number of cycles of the force per period.
        cycles: u64,
    },
    /// There are impacts, but the state does not return within 8 cycles.
    Modulated,
}

impl fmt::Display for Regime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Regime::NoImpacts => f.write_str("no_impacts"),
            Regime::Periodic { impacts, cycles } => write!(f, "{impacts}:{cycles}"),
            Regime::Modulated => f.write_str("modulated"),
        }
    }
}

/// The regime of the last strobes. The period is the shortest m for which each of the last 20 states equals
/// the one m cycles before within 1e-6 of the amplitude (velocities over Ω). `None` if there are fewer than
/// 28 strobes and no period is found. There is a strobe for each absorber at every instant.
pub(super) fn regime<R: Real>(
    strobes: &VecDeque<Strobe<R>>,
    absorbers: usize,
    impacts: u64,
    amplitude: R,
    frequency: R,
) -> Option<Regime> {
    if impacts == 0 {
        return Some(Regime::NoImpacts);
    }
    let instants = strobes.len() / absorbers.max(1);
    let of = |k: usize, absorber: usize| &strobes[(instants - 1 - k) * absorbers + absorber];
    let back = |k: usize| of(k, 0);
    for cycles in 1..=LONGEST.min(instants.saturating_sub(RETURNS)) {
        let comes_back = |k: usize| {
            let returns = |j| close(of(k, j), of(k + cycles, j), amplitude, frequency);
            (0..absorbers).all(returns)
        };
        if (0..RETURNS).all(comes_back) {
            // Counted over whole periods, because an impact at the instant of a strobe may fall on either
            // side.
            let periods = RETURNS.div_ceil(cycles);
            let listed = back(0).impacts - back(periods * cycles).impacts;
            let impacts = (listed as f64 / periods as f64).round() as u64;
            return Some(Regime::Periodic { impacts, cycles: cycles as u64 });
        }
    }
    (instants >= RETURNS_KEPT).then_some(Regime::Modulated)
}

fn close<R: Real>(a: &Strobe<R>, b: &Strobe<R>, amplitude: R, frequency: R) -> bool {
    let near = |one: R, other: R, size: R| (one - other).abs() <= size * CLOSE;
    near(a.displacement, b.displacement, amplitude)
        && near(a.gap_displacement, b.gap_displacement, amplitude)
        && near(a.velocity, b.velocity, amplitude * frequency)
        && near(a.gap_velocity, b.gap_velocity, amplitude * frequency)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strobes that go through `states` again and again, with this number of impacts per cycle.
    fn strobes(states: &[f64], impacts: u64, count: u64) -> VecDeque<Strobe> {
        let strobe = |cycle: u64| Strobe {
            cycle,
            absorber: 0,
            time: cycle as f64,
            displacement: states[cycle as usize % states.len()],
            velocity: 0.0,
            gap_displacement: 0.5,
            gap_velocity: 0.0,
            amplitude: 1.0,
            impacts: impacts * cycle,
        };
        (0..count).map(strobe).collect()
    }

    /// Of two absorbers the first comes back every cycle, the other every second one.
    #[test]
    fn all_absorbers_must_come_back() {
        let one = strobes(&[0.5], 2, 40);
        let both = one.iter().flat_map(|strobe| {
            let w = if strobe.cycle % 2 == 0 { 0.1 } else { 0.2 };
            [*strobe, Strobe { absorber: 1, gap_velocity: w, ..*strobe }]
        });
        let named = regime(&both.collect(), 2, 80, 1.0, 1.0).map(|regime| regime.to_string());
        assert_eq!(named.as_deref(), Some("4:2"));
    }

    #[test]
    fn the_shortest_period_is_named() {
        let named = |states: &[f64], impacts, count| {
            let strobes = strobes(states, impacts, count);
            regime(&strobes, 1, impacts * count, 1.0, 1.0).map(|regime| regime.to_string())
        };
        assert_eq!(named(&[0.5], 2, 28).as_deref(), Some("2:1"));
        assert_eq!(named(&[0.5], 2, 21).as_deref(), Some("2:1"));
        assert_eq!(named(&[0.5], 2, 20), None);
        assert_eq!(named(&[0.5, 0.6], 2, 28).as_deref(), Some("4:2"));
        assert_eq!(named(&[0.5, 0.6, 0.4], 3, 30).as_deref(), Some("9:3"));
        assert_eq!(named(&[0.5, 0.5 + 9e-7], 1, 28).as_deref(), Some("1:1"));
        let nine: Vec<f64> = (0..9).map(f64::from).collect();
        assert_eq!(named(&nine, 2, 28).as_deref(), Some("modulated"));
        assert_eq!(named(&nine, 2, 27), None);
        assert_eq!(named(&[0.5], 0, 28).as_deref(), Some("no_impacts"));
    }
}
