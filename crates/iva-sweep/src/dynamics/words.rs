//! Why there is no orbit or no branch, in words.

use super::branches::NoBranch;
use super::{Missed, Outcome};

/// The reason why no orbit was found as a word, and a sentence.
pub fn words(missed: &Missed) -> (&'static str, String) {
    match missed {
        Missed::Invalid(invalid) => ("invalid", invalid.to_string()),
        Missed::Cycle(outcome) => {
            let why = match outcome {
                Outcome::ImpactLimit => "has more impacts than a run may have",
                Outcome::WorkLimit => "has more stretches of motion than a run may have",
                Outcome::NotFinite => "leaves the range of numbers",
                Outcome::Finished | Outcome::Cancelled | Outcome::Stopped => "was stopped",
            };
            (outcome.name(), format!("a run over one cycle {why}"))
        }
        Missed::NoImpacts => {
            let rule = "the motion has no impacts, or fewer than two in three cycles; without impacts no orbit is \
                        isolated, as the absorber may stand anywhere in its gap";
            ("no_impacts", rule.to_owned())
        }
        Missed::Singular => {
            let rule = "the orbit is not isolated: it has the multiplier 1, as at a fold or a pitchfork (a symmetric \
                        orbit at a pitchfork is found with symmetric=True)";
            ("singular", rule.to_owned())
        }
        Missed::Stalled(residual) => {
            let message = format!(
                "Newton's method ends {residual:.1e} of the size of the state from an orbit; give a start that is closer \
                 to one, more cycles to settle, or another number of periods"
            );
            ("stalled", message)
        }
        Missed::NotPeriodic(off) => {
            let message = format!(
                "a run from the point found does not come back to it, by {off:.1e} of the size of the state"
            );
            ("not_periodic", message)
        }
    }
}

impl NoBranch {
    /// The reason as a word, and a sentence.
    pub fn words(&self) -> (&'static str, String) {
        let (reason, message) = match self {
            NoBranch::Missed(missed) => return words(missed),
            NoBranch::Sticks => (
                "sticks",
                "the absorber sticks to a wall; only orbits of single impacts can be followed",
            ),
            NoBranch::Lost => (
                "lost",
                "the equations of the orbit with its sequence of impacts were not solved, or no branch begins at this \
                 kind of point",
            ),
        };
        (reason, message.to_owned())
    }
}
