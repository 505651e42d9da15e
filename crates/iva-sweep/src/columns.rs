//! The columns of every table: name, quantity, meaning; and which summary columns to compute.

use crate::fields::Quantity;
use crate::study::Table;

/// Version of the table layout: columns are only added within a version.
pub const SCHEMA_VERSION: u32 = 1;

/// One column of a result table.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Name in the table.
    pub name: &'static str,
    /// What it measures; gives the unit.
    pub quantity: Quantity,
    /// One line of explanation, kept in the Arrow field metadata.
    pub help: &'static str,
}

const fn column(name: &'static str, quantity: Quantity, help: &'static str) -> Column {
    Column { name, quantity, help }
}

/// Summary columns after `point` and the swept parameters.
pub static SUMMARY: &[Column] = &[
    column(
        "outcome",
        Quantity::Text,
        "finished, impact_limit, work_limit, not_finite or cancelled",
    ),
    column("impacts", Quantity::Count, "listed impacts"),
    column(
        "effective_impacts",
        Quantity::Count,
        "listed impacts at which the masses moved towards each other",
    ),
    column(
        "episodes",
        Quantity::Count,
        "chatters that ended in stick, plastic sticks, starts at rest on a pressed wall",
    ),
    column(
        "undecided",
        Quantity::Count,
        "extrema of the gap within rounding of a wall, counted as no contact",
    ),
    column("time_stuck", Quantity::Time, "total time on a wall"),
    column("damping_ratio_1", Quantity::Ratio, "from the logarithmic decrement over 1 cycle"),
    column("damping_ratio_3", Quantity::Ratio, "from the logarithmic decrement over 3 cycles"),
    column("damping_ratio_10", Quantity::Ratio, "from the logarithmic decrement over 10 cycles"),
    column(
        "damping_ratio_fit",
        Quantity::Ratio,
        "from the least-squares line of ln peak over time, down to 5 %",
    ),
    column("damping_ratio_energy", Quantity::Ratio, "from the energy lost in the first period"),
    column(
        "settling_time_10",
        Quantity::Time,
        "last instant at which |x| is 10 % of the reference amplitude",
    ),
    column(
        "settling_time_5",
        Quantity::Time,
        "last instant at which |x| is 5 % of the reference amplitude",
    ),
    column(
        "settling_time_2",
        Quantity::Time,
        "last instant at which |x| is 2 % of the reference amplitude",
    ),
    column(
        "residual_amplitude",
        Quantity::Ratio,
        "largest |x| of the last period over the reference amplitude",
    ),
    column("energy_initial", Quantity::Energy, "total energy at time zero"),
    column("energy_impacts", Quantity::Energy, "energy lost in impacts"),
    column(
        "energy_viscous",
        Quantity::Energy,
        "energy lost in the damper, integrated along the flights",
    ),
    column("energy_final", Quantity::Energy, "total energy at the end"),
    column(
        "energy_residual",
        Quantity::Energy,
        "initial + work − impacts − viscous − pivot − final",
    ),
    column(
        "energy_pivot",
        Quantity::Energy,
        "energy lost in the pivot of a pendulum, integrated along the flights; 0 for a free mass",
    ),
    column("stop_reachable", Quantity::Flag, "the absorber can reach its stops at all"),
    column(
        "gravity",
        Quantity::Acceleration,
        "acceleration of gravity on a pendulum, given or following from frequency and length",
    ),
    column(
        "energy_work",
        Quantity::Energy,
        "work of force and base, integrated along the motion; 0 in free decay",
    ),
    column(
        "amplitude_max",
        Quantity::Length,
        "largest |x| under force, after the discarded cycles",
    ),
    column(
        "amplitude_rms",
        Quantity::Length,
        "root mean square of x under force, after the discarded cycles",
    ),
    column(
        "reduction",
        Quantity::Ratio,
        "1 - amplitude_max over that without absorber, under the same force",
    ),
    column(
        "transmissibility",
        Quantity::Ratio,
        "largest absolute acceleration between impacts over the largest of the base",
    ),
    column(
        "impacts_per_cycle",
        Quantity::Ratio,
        "listed impacts over cycles of the harmonic force, after the discarded ones",
    ),
    column(
        "regime",
        Quantity::Text,
        "n:m, n impacts in m cycles if the state comes back; no_impacts or modulated",
    ),
    column(
        "condition",
        Quantity::Ratio,
        "largest change of an impact time per unit change of the start (errors asked for)",
    ),
    column(
        "digits",
        Quantity::Ratio,
        "-log10 of the largest time_error over the time or 1/ωn (errors asked for)",
    ),
];

/// Columns of `impacts` after `point`.
pub static IMPACTS: &[Column] = &[
    column("impact", Quantity::Count, "index of the impact in its run"),
    column("time", Quantity::Time, "instant of the impact"),
    column("wall", Quantity::Side, "+1 (y = +d) or -1 (y = -d)"),
    column("displacement", Quantity::Length, "displacement of the primary system"),
    column("velocity_before", Quantity::Velocity, "primary velocity just before"),
    column("velocity_after", Quantity::Velocity, "primary velocity just after"),
    column(
        "absorber_velocity_before",
        Quantity::Velocity,
        "absolute velocity of the absorber's centre of mass just before",
    ),
    column(
        "absorber_velocity_after",
        Quantity::Velocity,
        "absolute velocity of the absorber's centre of mass just after",
    ),
    column("approach_velocity", Quantity::Velocity, "signed gap velocity just before"),
    column("energy_loss", Quantity::Energy, "energy lost in the impact"),
    column("effective", Quantity::Flag, "the two masses moved towards each other"),
    column("angle", Quantity::Angle, "angle of a pendulum"),
    column("angular_velocity_before", Quantity::AngularVelocity, "of a pendulum, just before"),
    column("angular_velocity_after", Quantity::AngularVelocity, "of a pendulum, just after"),
    column("time_error", Quantity::Time, "estimated error of the time (errors asked for)"),
    column(
        "near_grazing",
        Quantity::Flag,
        "an error of that size could turn the impact into a grazing (errors asked for)",
    ),
];

/// Columns of `episodes` after `point`.
pub static EPISODES: &[Column] = &[
    column("episode", Quantity::Count, "index of the episode in its run"),
    column("wall", Quantity::Side, "+1 (y = +d) or -1 (y = -d)"),
    column(
        "start_time",
        Quantity::Time,
        "first impact after which only this wall is met until the stick",
    ),
    column("stick_time", Quantity::Time, "end of the chatter, begin of the ride on the wall"),
    column(
        "release_time",
        Quantity::Time,
        "end of the ride; null if still stuck at the end of the run",
    ),
    column("impacts", Quantity::Count, "listed impacts of the episode"),
    column("energy_loss", Quantity::Energy, "energy lost in all its impacts, listed or summed"),
];

/// Columns of `envelope` after `point`.
pub static ENVELOPE: &[Column] = &[
    column("peak", Quantity::Count, "index of the peak in its run"),
    column("time", Quantity::Time, "instant of the peak"),
    column("displacement", Quantity::Length, "displacement at the peak, signed"),
    column("amplitude", Quantity::Length, "size of the displacement at the peak"),
    column("log_decrement", Quantity::Ratio, "ln(A[k-2]/A[k]); null for k < 2"),
];

/// Columns of `stroboscope` after `point`.
pub static STROBOSCOPE: &[Column] = &[
    column("cycle", Quantity::Count, "number of the instant, 0 for the first of the run"),
    column("time", Quantity::Time, "instant at which frequency · time + phase is a multiple of 2π"),
    column("displacement", Quantity::Length, "displacement of the primary system"),
    column("velocity", Quantity::Velocity, "velocity of the primary system"),
    column("gap_displacement", Quantity::Length, "absorber minus primary displacement"),
    column("gap_velocity", Quantity::Velocity, "absorber minus primary velocity"),
    column(
        "amplitude",
        Quantity::Length,
        "largest |x| since the instant before (first row: since the window began)",
    ),
    column(
        "impacts",
        Quantity::Count,
        "listed impacts since the instant before (first row: since the window began)",
    ),
];

/// Columns of the trajectory after `point`.
pub static TRAJECTORY: &[Column] = &[
    column("time", Quantity::Time, "instant; an impact appears twice, before and after"),
    column("displacement", Quantity::Length, "displacement of the primary system"),
    column("velocity", Quantity::Velocity, "velocity of the primary system"),
    column("gap_displacement", Quantity::Length, "absorber minus primary displacement"),
    column("gap_velocity", Quantity::Velocity, "absorber minus primary velocity"),
    column("wall", Quantity::Side, "0 in flight, +1 or -1 while stuck"),
    column("angle", Quantity::Angle, "angle of a pendulum"),
    column("angular_velocity", Quantity::AngularVelocity, "angular velocity of a pendulum"),
];

/// The columns of a table after `point` (and, in the summary, the swept parameters).
pub fn columns(table: Table) -> &'static [Column] {
    match table {
        Table::Summary => SUMMARY,
        Table::Impacts => IMPACTS,
        Table::Episodes => EPISODES,
        Table::Envelope => ENVELOPE,
        Table::Stroboscope => STROBOSCOPE,
        Table::Trajectory => TRAJECTORY,
    }
}

/// The set of summary columns to compute; the others are null. `outcome` is always there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selection(u64);

impl Selection {
    /// Every summary column.
    pub fn all() -> Self {
        Self((1 << SUMMARY.len()) - 1)
    }

    /// The named columns.
    ///
    /// # Errors
    /// The first unknown name.
    pub fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        names.into_iter().try_fold(Self(1), |set, name| {
            SUMMARY
                .iter()
                .position(|column| column.name == name)
                .map(|index| Self(set.0 | (1 << index)))
                .ok_or_else(|| name.to_owned())
        })
    }

    /// True if the column is to be computed.
    pub fn contains(self, name: &str) -> bool {
        SUMMARY.iter().position(|column| column.name == name).is_some_and(|index| self.has(index))
    }

    /// True if the column of that number is to be computed.
    pub(crate) fn has(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }

    /// The columns to compute, in table order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        SUMMARY
            .iter()
            .enumerate()
            .filter(move |(index, _)| self.has(*index))
            .map(|(_, column)| column.name)
    }
}
