//! The choices that a user makes by a word: the kind of absorber, or none, and the model of a pendulum.

use iva_core::error::Invalid;
pub use iva_core::piva::{Angles, ImpactLaw};

use crate::fields::Part;

/// The kinds of absorber.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// A free mass in a gap.
    #[default]
    Siva,
    /// A pendulum between two stops.
    Piva,
    /// No absorber: the structure alone.
    None,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 3] = [Kind::Siva, Kind::Piva, Kind::None];

    /// The word for it in studies.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Siva => "siva",
            Kind::Piva => "piva",
            Kind::None => "none",
        }
    }

    /// A description for messages.
    pub fn what(self) -> &'static str {
        match self {
            Kind::Siva => "a free mass (kind \"siva\")",
            Kind::Piva => "a pendulum (kind \"piva\")",
            Kind::None => "a structure without absorber (kind \"none\")",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Kind> {
        Kind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// One choice.
#[derive(Debug)]
pub struct Choice {
    /// Its name in the part [`Part::Absorber`], to which all choices belong.
    pub name: &'static str,
    /// The words to choose from, the default first.
    pub words: &'static [&'static str],
    /// The kinds of absorber that have this choice.
    pub kinds: &'static [Kind],
    /// One line of help.
    pub help: &'static str,
}

/// The table of choices.
pub static CHOICES: [Choice; 3] = [
    Choice {
        name: "kind",
        words: &["siva", "piva", "none"],
        kinds: &Kind::ALL,
        help: "a free mass in a gap, a pendulum between two stops, or no absorber",
    },
    Choice {
        name: "angles",
        words: &["large", "small"],
        kinds: &[Kind::Piva],
        help: "exact, or linearised: sin θ = θ, cos θ = 1",
    },
    Choice {
        name: "impact_law",
        words: &["consistent", "printed"],
        kinds: &[Kind::Piva],
        help: "momentum and restitution, or the paper's Eqs. 16 and 17 as printed, for comparison",
    },
];

/// The words chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Choices {
    /// The kind of absorber.
    pub kind: Kind,
    /// The equations of motion of a pendulum: exact, or linearised for small angles.
    pub angles: Angles,
    /// The impact law of a pendulum.
    pub impact_law: ImpactLaw,
}

impl Choices {
    /// Chooses by name and word. The kind must be chosen first, because other choices may not fit it.
    ///
    /// # Errors
    /// [`Invalid`] for an unknown name or word, or a choice that the kind does not have.
    pub fn choose(&mut self, name: &str, word: &str) -> Result<(), Invalid> {
        let path = format!("{}.{name}", Part::Absorber.name());
        let shown = format!("\"{word}\"");
        let Some(choice) = CHOICES.iter().find(|choice| choice.name == name) else {
            return Err(Invalid::new(path, shown, "no such field"));
        };
        if !choice.kinds.contains(&self.kind) {
            return Err(Invalid::new(path, shown, only(choice.kinds)));
        }
        if !choice.words.contains(&word) {
            let words: Vec<String> = choice.words.iter().map(|w| format!("\"{w}\"")).collect();
            return Err(Invalid::new(path, shown, format!("give {}", words.join(" or "))));
        }
        let first = word == choice.words[0];
        match name {
            "kind" => self.kind = Kind::from_name(word).unwrap_or_default(),
            "angles" => self.angles = if first { Angles::Large } else { Angles::Small },
            _ => {
                self.impact_law = if first { ImpactLaw::Consistent } else { ImpactLaw::Printed };
            }
        }
        Ok(())
    }

    /// Name and word of every choice that the chosen kind has.
    pub fn words(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let of = |index: usize, first: bool| {
            let choice = &CHOICES[index];
            (choice.name, choice.words[usize::from(!first)])
        };
        let all = [
            ("kind", self.kind.name()),
            of(1, self.angles == Angles::Large),
            of(2, self.impact_law == ImpactLaw::Consistent),
        ];
        let kind = self.kind;
        all.into_iter()
            .zip(&CHOICES)
            .filter_map(move |(word, choice)| choice.kinds.contains(&kind).then_some(word))
    }
}

/// The message for a field or choice that only these kinds have, given for another kind.
pub(crate) fn only(kinds: &[Kind]) -> String {
    match kinds {
        [kind] => format!("only {} has it; leave it out", kind.what()),
        _ => "there is no absorber (kind \"none\"); leave it out".to_owned(),
    }
}
