//! Runs a scene with everything that a sweep can observe, and judges what comes out: a run labelled
//! finished has numbers only, and no wall was passed.

use iva_core::absorber::Point;
use iva_core::error::Invalid;
use iva_core::force::Force;
use iva_core::measures::{MeasureValues, Measures, Wanted};
use iva_core::observe::Events;
use iva_core::piva::Parameters;
use iva_core::propagation::{Errors, Estimated};
use iva_core::sample::{Sampler, State};
use iva_core::simulate::{Limits, Outcome, Tally, simulate};
use iva_core::steady::{Steady, SteadyValues, SteadyWanted, Window, without_absorber};

use crate::scene::{Absorber, Scene};
use crate::walls::Walls;

/// Samples of the trajectory.
const SAMPLES: u32 = 8;

/// Runs a scene and judges it.
///
/// # Errors
/// [`Invalid`] for a number out of range.
pub fn examine(scene: &Scene) -> Result<(), Invalid> {
    let (limits, force) = (scene.limits(), scene.force()?);
    let window = scene.window(&force);
    match scene.absorber()? {
        Absorber::Siva(system, start) => {
            let walls = Walls::new(1.0 + 2.0 * system.damping_ratio());
            run(&*system, &start, &limits, window, walls)
        }
        Absorber::DrivenSiva(system, start) => {
            let damping_ratio = system.damping_ratio();
            let walls = Walls::new(1.0 + 2.0 * damping_ratio);
            run(&*system, &start, &limits, window, walls)?;
            let from = Point { x: start.displacement, v: start.velocity };
            bare(&force, damping_ratio, from, &window, &limits)
        }
        Absorber::Piva(system, start) => {
            let walls = hanging(system.parameters());
            run(&*system, &start, &limits, window, walls)
        }
        Absorber::DrivenPiva(system, start) => {
            let walls = hanging(system.parameters());
            let damping_ratio = system.parameters().damping_ratio;
            run(&*system, &start, &limits, window, walls)?;
            let (x, v) = (start.displacement, start.velocity);
            bare(&force, damping_ratio, Point { x, v }, &window, &limits)
        }
    }
}

/// The walls of a pendulum.
fn hanging(pendulum: &Parameters) -> Walls {
    let Parameters { damping_ratio, length, contact_distance, .. } = *pendulum;
    Walls::new(contact_distance / length * (1.0 + 2.0 * damping_ratio))
}

fn run<S: Estimated>(
    system: &S,
    start: &S::Start,
    limits: &Limits,
    window: Window,
    walls: Walls,
) -> Result<(), Invalid> {
    limits.check()?;
    let times = (0..=SAMPLES).map(|k| limits.duration * (f64::from(k) / f64::from(SAMPLES)));
    let mut observers = (
        Events::default(),
        (
            (Measures::<S>::new(Wanted { envelope: true, ..Wanted::ALL }), Errors::default()),
            (
                Steady::new(window, SteadyWanted::ALL),
                (Sampler::with_events(times.collect()), walls),
            ),
        ),
    );
    let tally = simulate(system, start, limits, None, &mut observers)?;
    if tally.outcome != Outcome::Finished {
        return Ok(());
    }
    let (events, ((measures, errors), (steady, (sampler, walls)))) = observers;
    judge_tally(system, &tally);
    judge_events(system, &events);
    for peak in measures.envelope() {
        finite("peak", [peak.time, peak.displacement]);
    }
    judge_measures(measures.values());
    judge_errors(&errors);
    judge_steady(&steady);
    sampler.states.iter().for_each(judge_state);
    assert!(walls.worst.share <= 1.0, "beyond a wall: {:?}", walls.worst);
    Ok(())
}

/// The structure without absorber in the same window.
fn bare(
    force: &Force,
    damping_ratio: f64,
    from: Point,
    window: &Window,
    limits: &Limits,
) -> Result<(), Invalid> {
    let bare = without_absorber(force, damping_ratio, (from, 0.0), window, limits, None)?;
    // Without bound at resonance.
    let sizes = bare.into_iter().flat_map(|bare| [bare.amplitude, bare.rms]);
    assert!(sizes.into_iter().all(|size| size >= 0.0), "bare: {bare:?}");
    Ok(())
}

fn judge_tally<S: Estimated>(system: &S, tally: &Tally<S::State>) {
    finite("tally", [tally.time_stuck, tally.energy_impacts, tally.end_time]);
    let last = system.primary(&tally.state);
    finite("last state", [last.x, last.v, system.energy(&tally.state)]);
}

fn judge_events<S: Estimated>(system: &S, events: &Events) {
    for impact in &events.impacts {
        finite(
            "impact",
            [
                impact.time,
                impact.displacement,
                impact.velocity_before,
                impact.velocity_after,
                impact.gap_velocity_before,
                impact.gap_velocity_after,
                impact.absorber_velocity_before(),
                impact.absorber_velocity_after(),
                impact.energy_loss,
            ],
        );
        for angle in system.impact_angles(impact).into_iter().flatten() {
            finite("angle of an impact", [angle.value, angle.rate]);
        }
    }
    for episode in &events.episodes {
        finite("episode", [episode.start_time, episode.stick_time, episode.energy_loss]);
        finite("release", episode.release_time);
    }
}

fn judge_measures(values: &MeasureValues) {
    finite("damping_ratio_1", values.damping_ratio_1);
    finite("damping_ratio_3", values.damping_ratio_3);
    finite("damping_ratio_10", values.damping_ratio_10);
    finite("damping_ratio_fit", values.damping_ratio_fit);
    finite("damping_ratio_energy", values.damping_ratio_energy);
    finite("settling_time_10", values.settling_time_10);
    finite("settling_time_5", values.settling_time_5);
    finite("settling_time_2", values.settling_time_2);
    finite("residual_amplitude", values.residual_amplitude);
    finite("energy_initial", [values.energy_initial]);
    finite("energy_viscous", [values.energy_viscous]);
    finite("energy_pivot", [values.energy_pivot]);
    finite("energy_final", [values.energy_final]);
    finite("energy_work", [values.energy_work]);
    finite("energy_residual", [values.energy_residual]);
}

fn judge_errors(errors: &Errors) {
    finite("condition", errors.condition());
    finite("digits", errors.digits());
    finite("time_error", errors.impacts.iter().filter_map(|error| error.time));
}

fn judge_steady(steady: &Steady) {
    let values: &SteadyValues = steady.values();
    finite("amplitude_max", values.amplitude_max);
    finite("amplitude_rms", values.amplitude_rms);
    finite("acceleration_max", values.acceleration_max);
    finite("base_max", values.base_max);
    finite("impacts_per_cycle", values.impacts_per_cycle);
    for strobe in steady.strobes() {
        finite("strobe", [strobe.time, strobe.displacement, strobe.velocity, strobe.amplitude]);
        finite("gap of a strobe", [strobe.gap_displacement, strobe.gap_velocity]);
    }
}

fn judge_state(state: &State) {
    finite("sample", [state.time, state.displacement, state.velocity]);
    finite("gap of a sample", [state.gap_displacement, state.gap_velocity]);
    if let Some(angle) = state.angle {
        finite("angle of a sample", [angle.value, angle.rate]);
    }
}

/// Every number that is there must be one.
fn finite(name: &str, numbers: impl IntoIterator<Item = f64>) {
    for number in numbers {
        assert!(number.is_finite(), "{name} = {number} in a run labelled finished");
    }
}
