//! The choices that a user makes by a word: the kind of absorber, or none, and the model of a pendulum.

use iva_core::absorber::Wall;
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
    /// A stop on the ground, between whose walls a point of the structure moves.
    Stop,
    /// No absorber: the structure alone.
    None,
}

/// The walls that there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Walls {
    /// Both of them.
    #[default]
    Both,
    /// That at the upper end of the gap only.
    Plus,
    /// That at the lower end of the gap only.
    Minus,
}

impl Walls {
    /// Every choice, in the order of its words.
    const ALL: [Walls; 3] = [Walls::Both, Walls::Plus, Walls::Minus];

    /// The only wall, if there is one only.
    pub(crate) fn only(self) -> Option<Wall> {
        match self {
            Walls::Both => None,
            Walls::Plus => Some(Wall::Plus),
            Walls::Minus => Some(Wall::Minus),
        }
    }
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 4] = [Kind::Siva, Kind::Piva, Kind::Stop, Kind::None];

    /// The word for it in studies.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Siva => "siva",
            Kind::Piva => "piva",
            Kind::Stop => "stop",
            Kind::None => "none",
        }
    }

    /// A description for messages.
    pub fn what(self) -> &'static str {
        match self {
            Kind::Siva => "a free mass (kind \"siva\")",
            Kind::Piva => "a pendulum (kind \"piva\")",
            Kind::Stop => "a stop on the ground (kind \"stop\")",
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
pub static CHOICES: [Choice; 4] = [
    Choice {
        name: "kind",
        words: &["siva", "piva", "stop", "none"],
        kinds: &Kind::ALL,
        help: "a free mass in a gap, a pendulum between two stops, a stop on the ground, or no absorber",
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
    Choice {
        name: "walls",
        words: &["both", "plus", "minus"],
        kinds: &[Kind::Siva, Kind::Piva, Kind::Stop],
        help: "both walls of the gap, or that at its upper or lower end only",
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
    /// The walls of the gap.
    pub walls: Walls,
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
        let place = choice.words.iter().position(|known| *known == word).unwrap_or(0);
        let first = place == 0;
        match name {
            "walls" => self.walls = Walls::ALL[place],
            "kind" => self.kind = Kind::from_name(word).unwrap_or_default(),
            "angles" => self.angles = if first { Angles::Large } else { Angles::Small },
            _ => {
                self.impact_law = if first { ImpactLaw::Consistent } else { ImpactLaw::Printed };
            }
        }
        Ok(())
    }

    /// Name and word of every choice that the chosen kind has; walls if there is one only.
    pub fn words(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let of = |index: usize, place: usize| {
            let choice = &CHOICES[index];
            (choice.name, choice.words[place])
        };
        let all = [
            ("kind", self.kind.name()),
            of(1, usize::from(self.angles != Angles::Large)),
            of(2, usize::from(self.impact_law != ImpactLaw::Consistent)),
            of(3, self.walls as usize),
        ];
        let kind = self.kind;
        let told = |word: &str| word != CHOICES[3].words[0];
        let each = all.into_iter().zip(&CHOICES);
        each.filter(move |((_, word), choice)| choice.kinds.contains(&kind) && told(word))
            .map(|(word, _)| word)
    }
}

/// The message for a field or choice that only these kinds have, given for another kind.
pub(crate) fn only(kinds: &[Kind]) -> String {
    match kinds {
        [kind] => format!("only {} has it; leave it out", kind.what()),
        [.., Kind::Stop] => "there is no absorber (kind \"none\"); leave it out".to_owned(),
        _ => "only an absorber with a mass (kind \"siva\" or \"piva\") has it; leave it out"
            .to_owned(),
    }
}
