//! The table of all numbers that a user can give: name, part, quantity and allowed range.
//!
//! The study file, the Python classes and the sweep axes all use this table, so that every name, range and
//! unit is defined once.

use std::f64::consts::{FRAC_PI_2, PI};

use iva_core::absorber::modal;
use iva_core::absorber::restitution::LARGEST_PART;
use iva_core::error::{Invalid, number};
use iva_core::range::{LARGEST_RATIO, LARGEST_TOLERANCE};
use iva_core::simulate::Limits;

use crate::choices::{CHOICES, Kind};

/// The section of a study (and the Python class) that a field belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Part {
    /// The damped linear oscillator whose vibration is to be reduced.
    Primary,
    /// The impact mass in its gap.
    Absorber,
    /// The excitation; free decay if left out.
    Force,
    /// The state at time zero.
    Start,
    /// The state at which the run begins.
    Run,
}

impl Part {
    /// All parts, in the order of a study file.
    pub const ALL: [Part; 5] = [Part::Primary, Part::Absorber, Part::Force, Part::Start, Part::Run];

    /// The section name of a study file.
    pub fn name(self) -> &'static str {
        match self {
            Part::Primary => "primary",
            Part::Absorber => "absorber",
            Part::Force => "force",
            Part::Start => "start",
            Part::Run => "run",
        }
    }
}

/// The physical quantity of a field or column; `units` turns it into a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A number without unit.
    Ratio,
    /// A whole number.
    Count,
    /// +1, −1 or 0: a wall, or none.
    Side,
    /// A text.
    Text,
    /// A truth value.
    Flag,
    /// Displacement, clearance.
    Length,
    /// A length given in millimetres.
    Millimetre,
    /// Velocity.
    Velocity,
    /// Time.
    Time,
    /// Angular frequency.
    AngularFrequency,
    /// Frequency in hertz.
    Hertz,
    /// Mass.
    Mass,
    /// Spring stiffness.
    Stiffness,
    /// Viscous damping constant.
    Damping,
    /// Energy.
    Energy,
    /// Angle.
    Angle,
    /// An angle given in degrees.
    Degree,
    /// Rate of an angle.
    AngularVelocity,
    /// Acceleration: of gravity, of the base, force over mass.
    Acceleration,
    /// Force.
    Force,
    /// Impulse: force times time.
    Impulse,
}

/// Smallest size of a number with a unit, other than 0.
const SMALLEST: f64 = 1e-30;
/// Largest size of a number with a unit. Quotients of two such numbers stay within
/// [`iva_core::range`].
const LARGEST: f64 = 1e30;

/// The set of numbers that a field accepts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Allowed {
    /// 0, or a size from 1e-30 to 1e30, of either sign.
    Size,
    /// A number from 1e-30 to 1e30.
    Positive,
    /// 0, or a number from 1e-30 to 1e30.
    NonNegative,
    /// A mass ratio, greater than 0.
    MassRatio,
    /// A damping ratio, at least 0.
    DampingRatio,
    /// A number from 0 to 1, both included.
    UnitInterval,
    /// An integer from 1 to 2⁵³.
    PositiveInteger,
    /// A quotient of whole numbers from 1 to 8, at most 1.
    Exponent,
    /// A number of units, from 1 to 64.
    Units,
    /// κ of a pendulum, at least 1.
    InertiaRatio,
    /// An angle in rad, from −π to π.
    Angle,
    /// The angle in rad between a line of motion and the horizontal, from 0 to π/2.
    Inclination,
    /// The angle in degrees between a line of motion and the horizontal, from 0 to 90.
    InclinationDeg,
    /// A phase in rad, from −4π to 4π: wide enough for a shift by a turn, too narrow for most phases in
    /// degrees.
    Phase,
    /// A tolerance, 0 for full accuracy.
    Tolerance,
}

impl Allowed {
    /// True if the value may be used.
    pub fn contains(self, value: impl Into<f64>) -> bool {
        let value = value.into();
        let sized = (SMALLEST..=LARGEST).contains(&value.abs());
        match self {
            Allowed::Size => value == 0.0 || sized,
            Allowed::Positive => value > 0.0 && sized,
            Allowed::NonNegative => value == 0.0 || (value > 0.0 && sized),
            Allowed::MassRatio => value > 0.0 && value <= LARGEST_RATIO,
            Allowed::DampingRatio => (0.0..=LARGEST_RATIO).contains(&value),
            Allowed::UnitInterval => (0.0..=1.0).contains(&value),
            Allowed::PositiveInteger => {
                (1.0..=9_007_199_254_740_992.0).contains(&value) && value.fract() == 0.0
            }
            Allowed::Exponent => quotient(value).is_some(),
            Allowed::Units => (1.0..=modal::MOST as f64).contains(&value) && value.fract() == 0.0,
            Allowed::InertiaRatio => (1.0..=LARGEST_RATIO).contains(&value),
            Allowed::Angle => value.abs() <= PI,
            Allowed::Inclination => (0.0..=FRAC_PI_2).contains(&value),
            Allowed::InclinationDeg => (0.0..=90.0).contains(&value),
            Allowed::Phase => value.abs() <= 4.0 * PI,
            Allowed::Tolerance => (0.0..=LARGEST_TOLERANCE).contains(&value),
        }
    }

    /// The range in words, to end the sentence "give …".
    pub fn words(self) -> &'static str {
        match self {
            Allowed::Size => "0 or a number of size 1e-30 to 1e30",
            Allowed::Positive => "a number greater than 0, from 1e-30 to 1e30",
            Allowed::NonNegative => "0 or a number from 1e-30 to 1e30",
            Allowed::MassRatio => "a number greater than 0, at most 1e9",
            Allowed::DampingRatio => "a number from 0 to 1e9",
            Allowed::UnitInterval => "a number from 0 to 1",
            Allowed::PositiveInteger => "a whole number from 1 to 2^53",
            Allowed::Exponent => {
                "a quotient of whole numbers from 1 to 8 that is at most 1, such as 0.2"
            }
            Allowed::Units => "a whole number from 1 to 64",
            Allowed::InertiaRatio => "a number from 1 (point bob) to 1e9",
            Allowed::Angle => "an angle in rad, from -π to π",
            Allowed::Inclination => "an angle in rad, from 0 (level) to π/2 (upright)",
            Allowed::InclinationDeg => "an angle in degrees, from 0 (level) to 90 (upright)",
            Allowed::Phase => "an angle in rad, from -4π to 4π",
            Allowed::Tolerance => "0 (full accuracy) or a number up to 1e-3",
        }
    }
}

/// Numerator and denominator of a quotient of whole numbers from 1 to [`LARGEST_PART`] that is at most 1, the smallest;
/// `None` if a number is none. (Above 1 the impulse of an impact could fall as its speed rises, and the largest would
/// not be that of the fastest impact.)
pub fn quotient(value: f64) -> Option<[u32; 2]> {
    let near = |[p, q]: &[u32; 2]| {
        let (exact, unit) = (f64::from(*p) / f64::from(*q), 4.0 * f64::EPSILON);
        (value - exact).abs() <= unit * exact
    };
    let all = (1..=LARGEST_PART).flat_map(|q| (1..=q).map(move |p| [p, q]));
    all.into_iter().find(near)
}

/// One field: a row of the table.
#[derive(Debug)]
pub struct Field {
    /// The part that it belongs to.
    pub part: Part,
    /// Its name within the part.
    pub name: &'static str,
    /// The quantity that it gives.
    pub quantity: Quantity,
    /// The numbers that it accepts.
    pub allowed: Allowed,
    /// Fields of one part with the same group are alternatives: an axis over one of them replaces the others.
    pub group: &'static str,
    /// The kinds of absorber that have it.
    pub kinds: &'static [Kind],
    /// One line of help.
    pub help: &'static str,
}

/// The kinds listed in a row of the table; all kinds if the list is empty.
const fn or_all(kinds: &'static [Kind]) -> &'static [Kind] {
    if kinds.is_empty() { &Kind::ALL } else { kinds }
}

/// Each row: identifier, part, name, quantity, allowed numbers, group, help, and the kinds that have it (all if none is said).
macro_rules! fields {
    ($($id:ident: $part:ident $name:literal $quantity:ident $allowed:ident $group:literal $help:literal $($kind:ident)*;)*) => {
        /// Index of a field in [`FIELDS`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(missing_docs)] // each is described by its `help`
        pub enum FieldId { $($id),* }

        /// The table of fields.
        pub static FIELDS: &[Field] = &[$(Field {
            part: Part::$part,
            name: $name,
            quantity: Quantity::$quantity,
            allowed: Allowed::$allowed,
            group: $group,
            kinds: or_all(&[$(Kind::$kind),*]),
            help: $help,
        }),*];

        /// Number of fields.
        pub const FIELD_COUNT: usize = [$(FieldId::$id),*].len();

        const IDS: [FieldId; FIELD_COUNT] = [$(FieldId::$id),*];
    };
}

fields! {
    DampingRatio: Primary "damping_ratio" Ratio DampingRatio "damping" "damping ratio of the bare primary system";
    Damping: Primary "damping" Damping NonNegative "damping" "viscous damping constant c; needs a mass";
    NaturalFrequency: Primary "natural_frequency" AngularFrequency Positive "frequency" "natural frequency of the bare primary system in rad/s";
    FrequencyHz: Primary "frequency_hz" Hertz Positive "frequency" "natural frequency of the bare primary system in Hz";
    Stiffness: Primary "stiffness" Stiffness Positive "frequency" "spring stiffness k; needs a mass";
    PrimaryMass: Primary "mass" Mass Positive "mass" "mass M of the primary system";
    MassRatio: Absorber "mass_ratio" Ratio MassRatio "mass" "absorber mass over primary mass" Siva Piva;
    AbsorberMass: Absorber "mass" Mass Positive "mass" "absorber mass m; needs a primary mass" Siva Piva;
    Restitution: Absorber "restitution" Ratio UnitInterval "restitution" "Newton's coefficient on the gap velocity" Siva Piva Stop;
    RestitutionMinus: Absorber "restitution_minus" Ratio UnitInterval "restitution_minus" "the same at the wall -, the lower stop where the line of motion rises (default: restitution)" Siva Piva Stop;
    ReferenceSpeed: Absorber "reference_speed" Velocity Positive "reference_speed" "makes the restitution a power law of the approach speed: that at which it is restitution" Siva Piva Stop;
    RestitutionExponent: Absorber "restitution_exponent" Ratio Exponent "restitution_exponent" "b of a power law 1 - a u^b of the restitution (default 0.2)" Siva Piva Stop;
    YieldSpeed: Absorber "yield_speed" Velocity Positive "restitution" "makes the restitution that of plastic spheres, in place of restitution: approach speed up to which impacts are elastic" Siva Piva Stop;
    RelativeClearance: Absorber "relative_clearance" Ratio Positive "clearance" "clearance over |start displacement|" Siva Piva Stop;
    Clearance: Absorber "clearance" Length Positive "clearance" "one-sided clearance, half of the total play" Siva Piva Stop;
    ClearanceMm: Absorber "clearance_mm" Millimetre Positive "clearance" "one-sided clearance in mm" Siva Piva Stop;
    Gap: Absorber "gap" Length Positive "clearance" "total play, twice the clearance" Siva Piva Stop;
    GapMm: Absorber "gap_mm" Millimetre Positive "clearance" "total play in mm" Siva Piva Stop;
    GapOffset: Absorber "gap_offset" Length Size "gap_offset" "gap displacement of the middle of the gap (of a stop on the ground: displacement of its point): the stops are at gap_offset ± clearance (default 0)" Siva Piva Stop;
    GapOffsetMm: Absorber "gap_offset_mm" Millimetre Size "gap_offset" "the same in mm" Siva Piva Stop;
    ContactTime: Absorber "contact_time" Time Positive "contact_time" "how long an impact lasts, to estimate its largest force; the motion does not depend on it" Siva Piva Stop;
    ContactStiffness: Absorber "contact_stiffness" Stiffness Positive "contact_time" "stiffness of a stop, to estimate how long an impact lasts; needs a primary mass" Siva Piva;
    Units: Absorber "units" Count Units "units" "number of equal units that share the mass, each in a gap of its own (default 1)" Siva Piva;
    ClearanceSpread: Absorber "clearance_spread" Ratio UnitInterval "clearance_spread" "how far the clearances of the units spread, evenly: from 1 - this to 1 + this times the clearance (default 0)" Siva Piva;
    FrequencyRatio: Absorber "frequency_ratio" Ratio Positive "frequency" "frequency of the hanging pendulum over that of the bare primary system" Piva;
    Length: Absorber "length" Length Positive "length" "from the pivot to the centre of mass" Piva;
    Friction: Absorber "friction" Ratio NonNegative "friction" "coefficient of Coulomb friction between the mass and its way (default 0), times gravity across the motion; needs gravity; of a pendulum the moment in its pivot over m g L, the sine of the angle up to which it is held" Siva Piva;
    StaticFriction: Absorber "static_friction" Ratio NonNegative "static_friction" "the same at rest, at least that of a slide (default: friction)" Siva Piva;
    GapDamping: Absorber "gap_damping" Damping NonNegative "gap_damping" "constant c of a linear dashpot between mass and structure, of all units together (default 0); needs a primary mass" Siva;
    GapDampingRatio: Absorber "gap_damping_ratio" Ratio NonNegative "gap_damping" "the same as c / (2 M ωn): the damping ratio that it would give a primary beside a mass at rest" Siva;
    Spring: Absorber "spring" Stiffness NonNegative "spring" "stiffness k of a linear spring between mass and structure, slack at gap displacement 0, of all units together (default 0); needs a primary mass" Siva;
    Inclination: Absorber "inclination" Angle Inclination "inclination" "angle by which the line of motion rises, in rad: 0 (default) level, pi/2 upright; of a pendulum the line on which structure and pivot move" Siva Piva;
    InclinationDeg: Absorber "inclination_deg" Degree InclinationDeg "inclination" "the same in degrees: 90 upright" Siva Piva;
    Gravity: Absorber "gravity" Acceleration Positive "gravity" "acceleration of gravity (default 9.80665 in SI units); of a pendulum it may follow from frequency_ratio and length, of a free mass it needs an inclination or friction" Siva Piva;
    InertiaRatio: Absorber "inertia_ratio" Ratio InertiaRatio "inertia" "moment of inertia about the pivot over m L²" Piva;
    ContactDistance: Absorber "contact_distance" Length Positive "contact" "from the pivot to the point that meets the stops (default: the length)" Piva;
    PivotDampingRatio: Absorber "pivot_damping_ratio" Ratio DampingRatio "pivot" "damping ratio of the hanging pendulum" Piva;
    SpringRatio: Absorber "spring_ratio" Ratio NonNegative "spring" "frequency of the mass on its spring alone, of a pendulum on a torsional spring in its pivot, over that of the bare primary system (default 0: no spring)" Siva Piva;
    Amplitude: Force "amplitude" Acceleration Size "amplitude" "amplitude of the force over the primary mass, f/M";
    ForceAmplitude: Force "force" Force Size "amplitude" "amplitude of the force on the primary; needs a mass";
    BaseAcceleration: Force "base_acceleration" Acceleration Size "amplitude" "amplitude of the acceleration of the base, instead of a force";
    BaseVelocity: Force "base_velocity" Velocity Size "amplitude" "amplitude of the velocity of the base";
    BaseDisplacement: Force "base_displacement" Length Size "amplitude" "amplitude of the displacement of the base";
    BaseDisplacementMm: Force "base_displacement_mm" Millimetre Size "amplitude" "the same in mm";
    ForceFrequency: Force "frequency" AngularFrequency Positive "frequency" "angular frequency of the force";
    RelativeFrequency: Force "relative_frequency" Ratio Positive "frequency" "frequency of the force over that of the bare primary system";
    ForceFrequencyHz: Force "frequency_hz" Hertz Positive "frequency" "frequency of the force in Hz";
    Phase: Force "phase" Angle Phase "phase" "phase of the cosine at time zero, in rad";
    ImpulseVelocity: Force "velocity" Velocity Size "impulse" "impulse on the primary over its mass";
    ImpulseMomentum: Force "impulse" Impulse Size "impulse" "impulse on the primary; needs a mass";
    ImpulseTime: Force "time" Time NonNegative "time" "instant of an impulse";
    RecordScale: Force "scale" Ratio Size "scale" "factor on the values of a record";
    Displacement: Start "displacement" Length Size "displacement" "displacement of the primary system";
    DisplacementMm: Start "displacement_mm" Millimetre Size "displacement" "displacement of the primary system in mm";
    Velocity: Start "velocity" Velocity Size "velocity" "velocity of the primary system";
    StartImpulse: Start "impulse" Impulse Size "impulse" "shock: impulse on the primary at time zero (default 0); needs a mass";
    StartImpulseVelocity: Start "impulse_velocity" Velocity Size "impulse" "the same over the mass of the primary";
    GapDisplacement: Start "gap_displacement" Length Size "gap_displacement" "absorber displacement minus primary displacement (default 0; on an inclined line of motion the lower stop)" Siva Piva;
    GapVelocity: Start "gap_velocity" Velocity Size "gap_velocity" "absorber velocity minus primary velocity" Siva Piva;
    Angle: Start "angle" Angle Angle "gap_displacement" "angle of the pendulum from hanging, in rad" Piva;
    AngularVelocity: Start "angular_velocity" AngularVelocity Size "gap_velocity" "angular velocity of the pendulum" Piva;
    StartTime: Start "time" Time NonNegative "time" "instant at which the run begins, on the clock of the forces (default 0)";
    Reference: Start "reference" Length Size "reference" "displacement that relative_clearance is a multiple of (default: displacement)" Siva Piva Stop;
    Periods: Run "periods" Ratio Positive "duration" "length of the run in periods 2π/ωn of the bare primary system";
    Duration: Run "duration" Time Positive "duration" "length of the run as a time";
    Cycles: Run "cycles" Ratio Positive "duration" "length of the run in cycles of the harmonic force (of several, the first)";
    Discard: Run "discard" Ratio NonNegative "discard" "cycles of the harmonic force that steady-state columns leave out (default 0)";
    MaxImpacts: Run "max_impacts" Count PositiveInteger "max_impacts" "stop after so many impacts (default 10 million)";
    MaxWork: Run "max_work" Count PositiveInteger "max_work" "stop after so many flight segments (default 100 million)";
    Tolerance: Run "tolerance" Ratio Tolerance "tolerance" "0 (default): full accuracy; above 0: a free mass under a harmonic force in the fast tier, a pendulum in steps that leave out so much" Siva Piva;
    ChatterFloor: Run "chatter_floor" Velocity Positive "chatter_floor" "rebounds of an episode at or below this approach speed are not listed (default 1e-6 ωn d)" Siva Piva Stop;
}

/// For each field the index of the first field that sets the same quantity. Computed at compile time, because
/// sweeps use it at every point.
static QUANTITIES: [usize; FIELD_COUNT] = {
    let mut first = [0; FIELD_COUNT];
    let mut id = 0;
    while id < FIELD_COUNT {
        let mut earlier = 0;
        while !same_group(&FIELDS[earlier], &FIELDS[id]) {
            earlier += 1;
        }
        first[id] = earlier;
        id += 1;
    }
    first
};

const fn same_group(one: &Field, other: &Field) -> bool {
    let (a, b) = (one.group.as_bytes(), other.group.as_bytes());
    let mut same = one.part as u8 == other.part as u8 && a.len() == b.len();
    let mut i = 0;
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}

impl FieldId {
    /// The row of the field in the table.
    pub fn info(self) -> &'static Field {
        &FIELDS[self as usize]
    }

    /// Every field.
    pub fn all() -> impl Iterator<Item = FieldId> {
        IDS.iter().copied()
    }

    /// True if it is a field of an absorber or of its start, of which each of several absorbers has its own.
    pub fn of_absorber(self) -> bool {
        let Field { part, kinds, .. } = self.info();
        match part {
            Part::Absorber => true,
            Part::Start => !kinds.contains(&Kind::None) && self != FieldId::Reference,
            _ => false,
        }
    }

    /// `part.name`, as error messages and study files write it.
    pub fn path(self) -> String {
        let field = self.info();
        format!("{}.{}", field.part.name(), field.name)
    }

    /// True if two fields set the same quantity, so that only one of them may be given.
    pub fn same_quantity(self, other: FieldId) -> bool {
        QUANTITIES[self as usize] == QUANTITIES[other as usize]
    }

    /// True if a name without part means this field.
    fn is_named(self, key: &str) -> bool {
        self.info().part != Part::Force && self.info().name == key
    }

    /// Finds a field by its part and name.
    pub fn find(part: Part, name: &str) -> Option<FieldId> {
        Self::all().find(|id| id.info().part == part && id.info().name == name)
    }

    /// The default of the field, where it is a number that does not depend on other fields.
    pub fn default(self) -> Option<f64> {
        use FieldId as F;
        match self {
            F::DampingRatio
            | F::PivotDampingRatio
            | F::Displacement
            | F::Velocity
            | F::GapDisplacement
            | F::GapVelocity
            | F::GapOffset
            | F::StartTime
            | F::Inclination
            | F::Phase
            | F::ImpulseTime
            | F::Discard
            | F::Tolerance => Some(0.0),
            F::InertiaRatio | F::RecordScale => Some(1.0),
            F::MaxImpacts => Some(Limits::MAX_IMPACTS as f64),
            F::MaxWork => Some(Limits::MAX_WORK as f64),
            _ => None,
        }
    }

    /// Checks a value against the field's range.
    ///
    /// # Errors
    /// [`Invalid`] with field, value and range.
    pub fn check(self, value: f64) -> Result<f64, Invalid> {
        if self.info().allowed.contains(value) {
            Ok(value)
        } else {
            Err(Invalid::new(
                self.path(),
                number(value),
                format!("give {}", self.info().allowed.words()),
            ))
        }
    }

    /// Reads a sweep key: a bare name where it is unique, otherwise `part.name`; for a force always
    /// `force.name`.
    ///
    /// # Errors
    /// [`Invalid`] that lists the candidates of an ambiguous name or the nearest known key.
    pub fn from_key(key: &str) -> Result<FieldId, Invalid> {
        let matches: Vec<FieldId> =
            Self::all().filter(|id| id.is_named(key) || id.path() == key).collect();
        match matches.as_slice() {
            [one] => Ok(*one),
            [] => {
                let bare = key.strip_prefix("absorber.").unwrap_or(key);
                if CHOICES.iter().any(|choice| choice.name == bare) {
                    let rule =
                        "it is chosen by a word, which cannot be swept; make a study for each";
                    return Err(Invalid::new("sweep key", format!("`{key}`"), rule));
                }
                let of_force = Self::find(Part::Force, key).map(FieldId::path);
                let known: Vec<String> = Self::all()
                    .flat_map(|id| [id.path(), id.info().name.to_owned()])
                    .filter(|name| name.contains('.') || Self::all().any(|id| id.is_named(name)))
                    .collect();
                let near =
                    of_force.as_deref().or_else(|| nearest(key, known.iter().map(String::as_str)));
                let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
                Err(Invalid::new("sweep key", format!("`{key}`"), format!("no such field{hint}")))
            }
            several => {
                let paths: Vec<String> =
                    several.iter().map(|id| format!("`{}`", id.path())).collect();
                Err(Invalid::new(
                    "sweep key",
                    format!("`{key}`"),
                    format!("the name is not unique, write {}", paths.join(" or ")),
                ))
            }
        }
    }
}

/// Least Jaro–Winkler similarity of a misspelt name and the name that is suggested for it.
const ALIKE: f64 = 0.75;

/// The known name most similar to a misspelt one, if any is similar enough.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(score, _)| *score > ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
