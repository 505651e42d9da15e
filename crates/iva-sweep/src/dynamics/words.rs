//! Why there is no orbit or no branch, or why an orbit is left out, in words.

use iva_core::error::number;
use iva_core::orbit::attractors::Class;

use super::basins::LeftOut;
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
                        isolated where an absorber without spring may stand anywhere in its gap";
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
        Missed::NoStick => (
            "no_stick",
            "a run leaves a wall here before its chatter has ended: this is where a stick begins"
                .to_owned(),
        ),
    }
}

impl NoBranch {
    /// The reason as a word, and a sentence.
    pub fn words(&self) -> (&'static str, String) {
        let (reason, message) = match self {
            NoBranch::Missed(missed) => return words(missed),
            NoBranch::Lost => (
                "lost",
                "the equations of the orbit with its sequence of impacts were not solved, or no branch begins at this \
                 kind of point",
            ),
        };
        (reason, message.to_owned())
    }
}

impl LeftOut {
    /// The reason as a sentence; an orbit goes by its label.
    pub fn words(&self) -> String {
        match self {
            LeftOut::Elsewhere { index, class } => {
                let why = match class {
                    Class::Periodic(_) => "a run from it comes to another orbit".to_owned(),
                    Class::NoImpacts => {
                        "a run from it comes to a motion without impacts".to_owned()
                    }
                    Class::Aperiodic => "the strobes of a run from it do not repeat".to_owned(),
                    Class::Unfinished(outcome) => words(&Missed::Cycle(*outcome)).1,
                };
                format!("attractor {index}: {why}")
            }
            LeftOut::Again { index, label } => {
                format!("attractor {index}: it is the same orbit as attractor {label}")
            }
            LeftOut::Untold { start, periods, why } => {
                let all: Vec<String> = start.iter().map(|it| number(*it)).collect();
                let (at, why) = (all.join(", "), words(why).1);
                format!("an orbit of {periods} periods through ({at}): {why}")
            }
            LeftOut::NoNeighbourhood { label } => {
                format!("attractor {label}: no neighbourhood was found that runs stay in")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orbit_that_is_left_out_has_a_reason() {
        let start = [0.5, -1.0, 0.0, 2.0];
        let untold = LeftOut::Untold { start: start.to_vec(), periods: 3, why: Missed::Singular };
        let told = untold.words();
        assert!(
            told.starts_with("an orbit of 3 periods through (0.5, -1, 0, 2): the orbit is not")
        );
        let class = Class::Unfinished(Outcome::ImpactLimit);
        let told = LeftOut::Elsewhere { index: 2, class }.words();
        assert_eq!(told, "attractor 2: a run over one cycle has more impacts than a run may have");
    }
}
