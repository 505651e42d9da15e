//! The entries of the tables: name, quantity and meaning of each column, and the value of its cell in a row.
//!
//! A new column is one entry here, at the end of its table. The first word after the name is the
//! [`Quantity`](crate::fields::Quantity), which determines the type of the cell, its unit and the conversion
//! from natural units. In `summary` follow the [`Group`](super::Group) that it is computed with and, for a
//! measure that points can be ranked by, whether smaller or larger is [`Better`](super::Better). The value is that
//! of a row, or `=>` names the pass over the motion that computes it ([`iva_core::measures::pass`]).
//!
//! Each table is a macro that passes its entries to another macro: `described!` makes their descriptions,
//! `cells!` the functions that compute the cells of a row ([`crate::engine::rows`]), for any number type.

/// Columns of `summary` after `point`: one row per point.
macro_rules! summary {
    ($build:ident) => {
        $build! {
            "outcome" Text [Run] |run| run.ended.tally.outcome.name(),
                "finished, impact_limit, work_limit, not_finite or cancelled";
            "impacts" Count [Run] |run| run.ended.tally.impacts,
                "listed impacts";
            "effective_impacts" Count [Run] |run| run.ended.tally.effective_impacts,
                "listed impacts at which the masses moved towards each other";
            "episodes" Count [Run] |run| run.ended.tally.episodes,
                "chatters that ended in stick, plastic sticks, starts at rest on a pressed wall";
            "undecided" Count [Run] |run| run.ended.tally.undecided,
                "extrema of the gap within rounding of a wall, counted as no contact";
            "time_stuck" Time [Run] |run| run.ended.tally.time_stuck,
                "total time on a wall";
            "damping_ratio_1" Ratio [Peaks Larger] |run| run.ended.measures.damping_ratio_1,
                "from the logarithmic decrement over 1 cycle";
            "damping_ratio_3" Ratio [Peaks Larger] |run| run.ended.measures.damping_ratio_3,
                "from the logarithmic decrement over 3 cycles";
            "damping_ratio_10" Ratio [Peaks Larger] |run| run.ended.measures.damping_ratio_10,
                "from the logarithmic decrement over 10 cycles";
            "damping_ratio_fit" Ratio [Peaks Larger] |run| run.ended.measures.damping_ratio_fit,
                "from the least-squares line of ln peak over time, down to 5 %";
            "damping_ratio_energy" Ratio [FirstPeriod Larger] |run| run.ended.measures.damping_ratio_energy,
                "from the energy lost in the first period";
            "settling_time_10" Time [Settling Smaller] |run| run.ended.measures.settling_time_10,
                "last instant at which |x| is 10 % of the reference amplitude";
            "settling_time_5" Time [Settling Smaller] |run| run.ended.measures.settling_time_5,
                "last instant at which |x| is 5 % of the reference amplitude";
            "settling_time_2" Time [Settling Smaller] |run| run.ended.measures.settling_time_2,
                "last instant at which |x| is 2 % of the reference amplitude";
            "residual_amplitude" Ratio [Residual Smaller] |run| run.ended.measures.residual_amplitude,
                "largest |x| of the last period over the reference amplitude";
            "energy_initial" Energy [Run] |run| run.ended.measures.energy_initial,
                "total energy at time zero";
            "energy_impacts" Energy [Run] |run| run.ended.tally.energy_impacts,
                "energy lost in impacts";
            "energy_viscous" Energy [Ledger] |run| run.ended.measures.energy_viscous,
                "energy lost in the damper, integrated along the flights";
            "energy_final" Energy [Run] |run| run.ended.measures.energy_final,
                "total energy at the end";
            "energy_residual" Energy [Ledger] |run| run.ended.measures.energy_residual,
                "initial + work − impacts − viscous − pivot − final";
            "energy_pivot" Energy [Ledger] |run| run.ended.measures.energy_pivot,
                "energy lost in the pivot of a pendulum or in dashpots in gaps, integrated along the flights; else 0";
            "stop_reachable" Flag [Run] |run| run.scene.stop_reachable(),
                "the absorber can reach its stops at all; null without absorber";
            "gravity" Acceleration [Run] |run| run.scene.gravity(),
                "acceleration of gravity: on a pendulum, given or following from frequency and length; on a free mass whose line of motion rises";
            "energy_work" Energy [Ledger] |run| run.ended.measures.energy_work,
                "work of force and base, integrated along the motion; 0 in free decay";
            "amplitude_max" Length [Amplitude Smaller] |run| run.steady(|it| it.amplitude_max),
                "largest |x| under force, after the discarded cycles";
            "amplitude_rms" Length [Rms Smaller] |run| run.steady(|it| it.amplitude_rms),
                "root mean square of x under force, after the discarded cycles";
            "reduction" Ratio [Reduction Larger] |run| run.reduction(),
                "1 - amplitude_max over that without absorber, under the same force; null without absorber";
            "transmissibility" Ratio [Acceleration Smaller] |run| run.transmissibility(),
                "largest absolute acceleration between impacts over the largest of the base";
            "impacts_per_cycle" Ratio [ImpactsPerCycle] |run| run.steady(|it| it.impacts_per_cycle),
                "listed impacts over cycles of the harmonic force, after the discarded ones";
            "regime" Text [Regime] |run| run.steady(|it| it.regime.map(|regime| regime.to_string())),
                "n:m, n impacts in m cycles if the state comes back; no_impacts or modulated";
            "condition" Ratio [Errors] |run| run.ended.condition,
                "largest change of an impact time per unit change of the start (errors asked for)";
            "digits" Ratio [Errors] |run| run.ended.digits,
                "-log10 of the largest time_error over the time or 1/ωn (errors asked for)";
            "tier" Text [Run] |run| run.ended.tier.name(),
                "exact, or fast where a tolerance was given and the fast tier made the row";
            "approach_speed_max" Velocity [Run Smaller] |run| run.approach_speed(),
                "largest approach speed of all impacts, 0 without any; null without absorber";
            "impulse_max" Impulse [Run Smaller] |run| run.impulse(),
                "largest impulse of an impact on the structure, 0 without any; null without absorber";
            "peak_force_estimate" Force [Run Smaller] |run| run.peak_force(),
                "largest force of an impact as a half sine of the contact time given; null without one";
            "reduction_rms" Ratio [RmsReduction Larger] |run| run.reduction_rms(),
                "1 - amplitude_rms over that without absorber, under the same force; null without absorber";
            "acceleration_max" Acceleration [Shaking Smaller] |run| run.acceleration(),
                "largest absolute acceleration of the structure between impacts, under force after the discarded cycles (asked for by name)";
            "gap_displacement_max" Length [Travel Smaller] |run| run.extreme(|it| it.gap_displacement),
                "largest |y|, of several absorbers the largest; under force after the discarded cycles (asked for by name)";
            "stroke" Length [Travel Smaller] |run| run.extreme(|it| it.stroke),
                "largest minus least y, of several absorbers the largest; under force after the discarded cycles (asked for by name)";
            "absorber_displacement_max" Length [Travel Smaller] |run| run.extreme(|it| it.absorber_displacement),
                "largest displacement of an absorber's centre of mass, measured as x is, under force after the discarded cycles (asked for by name)";
            "time_near_wall" Time [Named Smaller] => NearWall,
                "time within 1 % of the clearance of a wall, null with several absorbers; under force after the discarded cycles (asked for by name)";
            "energy_friction" Energy [Run] |run| run.ended.tally.friction.energy.value,
                "energy lost in friction in the gap, 0 without friction";
            "stops" Count [Run] |run| run.ended.tally.friction.stops,
                "times at which an absorber has come to a stop in its gap, to be held there or to turn round; 0 without friction";
            "time_held" Time [Run] |run| run.ended.tally.friction.time_held.value,
                "total time at which friction has held the absorber in its gap, of several the sum; 0 without friction";
        }
    };
}

/// Columns of `impacts` after `point`: one row per impact.
macro_rules! impacts {
    ($build:ident) => {
        $build! {
            "impact" Count |row| row.index,
                "index of the impact in its run";
            "time" Time |row| row.impact.time,
                "instant of the impact";
            "wall" Side |row| row.impact.wall.number(),
                "+1 (y = +d) or -1 (y = -d)";
            "displacement" Length |row| row.impact.displacement,
                "displacement of the primary system";
            "velocity_before" Velocity |row| row.impact.velocity_before,
                "primary velocity just before";
            "velocity_after" Velocity |row| row.impact.velocity_after,
                "primary velocity just after";
            "absorber_velocity_before" Velocity |row| row.impact.absorber_velocity_before(),
                "absolute velocity of the absorber's centre of mass just before";
            "absorber_velocity_after" Velocity |row| row.impact.absorber_velocity_after(),
                "absolute velocity of the absorber's centre of mass just after";
            "approach_velocity" Velocity |row| row.impact.gap_velocity_before,
                "signed gap velocity just before";
            "energy_loss" Energy |row| row.impact.energy_loss,
                "energy lost in the impact";
            "effective" Flag |row| row.impact.effective(),
                "the two masses moved towards each other";
            "angle" Angle |row| row.angles.map(|[before, _]| before.value),
                "angle of a pendulum";
            "angular_velocity_before" AngularVelocity |row| row.angles.map(|[before, _]| before.rate),
                "of a pendulum, just before";
            "angular_velocity_after" AngularVelocity |row| row.angles.map(|[_, after]| after.rate),
                "of a pendulum, just after";
            "time_error" Time |row| row.estimate.time,
                "estimated error of the time (errors asked for)";
            "near_grazing" Flag |row| row.estimate.near_grazing,
                "an error of that size could turn the impact into a grazing (errors asked for)";
            "peak_force_estimate" Force |row| row.peak_force.map(|force| row.scale.force(force)),
                "largest force as a half sine of the contact time given; null without one";
            "absorber" Count |row| usize::from(row.impact.absorber),
                "number of the absorber, from 0";
        }
    };
}

/// Columns of `episodes` after `point`: one row per chatter that ends in stick, plastic stick or start at
/// rest on a wall.
macro_rules! episodes {
    ($build:ident) => {
        $build! {
            "episode" Count |row| row.index,
                "index of the episode in its run";
            "wall" Side |row| row.episode.wall.number(),
                "+1 (y = +d) or -1 (y = -d)";
            "start_time" Time |row| row.episode.start_time,
                "first impact after which only this wall is met until the stick";
            "stick_time" Time |row| row.episode.stick_time,
                "end of the chatter, begin of the ride on the wall";
            "release_time" Time |row| row.episode.release_time,
                "end of the ride; null if still stuck at the end of the run";
            "impacts" Count |row| row.episode.impacts,
                "listed impacts of the episode";
            "energy_loss" Energy |row| row.episode.energy_loss,
                "energy lost in all its impacts, listed or summed";
            "absorber" Count |row| usize::from(row.episode.absorber),
                "number of the absorber, from 0";
        }
    };
}

/// Columns of `envelope` after `point`: one row per peak of the primary displacement.
macro_rules! envelope {
    ($build:ident) => {
        $build! {
            "peak" Count |row| row.index,
                "index of the peak in its run";
            "time" Time |row| row.peak().time,
                "instant of the peak";
            "displacement" Length |row| row.peak().displacement,
                "displacement at the peak, signed";
            "amplitude" Length |row| row.peak().displacement.abs(),
                "size of the displacement at the peak";
            "log_decrement" Ratio |row| row.log_decrement(),
                "ln(A[k-2]/A[k]); null for k < 2";
        }
    };
}

/// Columns of `stroboscope` after `point`: one row per cycle of the harmonic force.
macro_rules! stroboscope {
    ($build:ident) => {
        $build! {
            "cycle" Count |row| row.strobe.cycle,
                "number of the instant, 0 for the first of the run";
            "time" Time |row| row.strobe.time,
                "instant at which frequency · time + phase is a multiple of 2π";
            "displacement" Length |row| row.strobe.displacement,
                "displacement of the primary system";
            "velocity" Velocity |row| row.strobe.velocity,
                "velocity of the primary system";
            "gap_displacement" Length |row| row.gap(|it| it.gap_displacement),
                "absorber minus primary displacement; null without absorber";
            "gap_velocity" Velocity |row| row.gap(|it| it.gap_velocity),
                "absorber minus primary velocity; null without absorber";
            "amplitude" Length |row| row.strobe.amplitude,
                "largest |x| since the instant before (first row: since the window began)";
            "impacts" Count |row| row.impacts(),
                "listed impacts since the instant before (first row: since the window began)";
            "absorber" Count |row| row.absorber(),
                "number of the absorber, from 0: of several each has a row; null without absorber";
        }
    };
}

/// Columns of `absorbers` after `point`: one row per absorber.
macro_rules! absorbers {
    ($build:ident) => {
        $build! {
            "absorber" Count |row| row.absorber,
                "number of the absorber, from 0";
            "impacts" Count |row| row.of.impacts,
                "its listed impacts";
            "effective_impacts" Count |row| row.of.effective_impacts,
                "its listed impacts at which the masses moved towards each other";
            "episodes" Count |row| row.of.episodes,
                "its chatters that ended in stick, plastic sticks, starts at rest on a pressed wall";
            "time_stuck" Time |row| row.of.time_stuck,
                "its total time on a wall";
            "energy_impacts" Energy |row| row.of.energy_impacts,
                "energy lost in its impacts";
            "approach_speed_max" Velocity |row| row.approach_speed(),
                "largest approach speed of its impacts, 0 without any";
            "impulse_max" Impulse |row| row.scale.impulse(row.of.impulse),
                "its largest impulse on the structure, 0 without any";
            "peak_force_estimate" Force |row| row.peak_force(),
                "its largest force as a half sine of the contact time given; null without one";
            "gap_displacement_max" Length |row| row.extremes.and_then(|it| it.gap_displacement),
                "largest |y|; null unless the summary was asked for it by name";
            "stroke" Length |row| row.extremes.and_then(|it| it.stroke),
                "largest minus least y; null unless the summary was asked for it by name";
            "absorber_displacement_max" Length |row| row.extremes.and_then(|it| it.absorber_displacement),
                "largest displacement of its centre of mass, measured as x is; null unless the summary was asked for it by name";
        }
    };
}

/// Columns of `trajectory` after `point`: one row per sample of the motion.
macro_rules! trajectory {
    ($build:ident) => {
        $build! {
            "time" Time |row| row.time,
                "instant; an impact appears twice, before and after";
            "displacement" Length |row| row.state(|it| it.displacement),
                "displacement of the primary system";
            "velocity" Velocity |row| row.state(|it| it.velocity),
                "velocity of the primary system";
            "gap_displacement" Length |row| row.gap(|it| it.gap_displacement),
                "absorber minus primary displacement; null without absorber";
            "gap_velocity" Velocity |row| row.gap(|it| it.gap_velocity),
                "absorber minus primary velocity; null without absorber";
            "wall" Side |row| row.state(|it| it.wall),
                "0 in flight, +1 or -1 while stuck";
            "angle" Angle |row| row.angle().map(|angle| angle.value),
                "angle of a pendulum";
            "angular_velocity" AngularVelocity |row| row.angle().map(|angle| angle.rate),
                "angular velocity of a pendulum";
            "acceleration" Acceleration |row| row.acceleration(|it| it.acceleration),
                "absolute acceleration of the primary system, that of the base included; impacts apart";
            "absorber_acceleration" Acceleration |row| row.absorber_acceleration(),
                "the same of the absorber's centre of mass, along the motion; null without absorber";
            "absorber" Count |row| row.absorber(),
                "number of the absorber, from 0: of several each has a row at every instant; null without absorber";
        }
    };
}

pub(crate) use {absorbers, envelope, episodes, impacts, stroboscope, summary, trajectory};
