//! Errors of event times on the reference scenes, in rounding units |Δτ| / (2⁻⁵³ (max(condition, 1) + τ)),
//! beside the least possible errors: those of the exact times rounded to doubles.
//!
//! `cargo bench -p iva-benches --bench accuracy`. The exact times are those of `tests/reference`, to 30
//! digits, for the decimals given there; the run has the nearest doubles as input.

use iva_core::absorber::{Absorber, Start};
use iva_core::piva::{Piva, PivaStart};
use iva_core::run::run;
use iva_core::simulate::Limits;
use iva_tests::dd::Dd;
use iva_tests::reference::{Expected, forced_scenes, piva_scenes, scenes};
use iva_tests::{timeline::marks, units};

/// Approach speed at or below which impacts are missing in the references.
const FLOOR: f64 = 1e-9;

/// Errors of the events of one scene, and of their exact times rounded to doubles.
struct Scene {
    name: String,
    errors: Vec<f64>,
    rounded: Vec<f64>,
}

fn scene<S: Absorber<Real = f64>>(
    name: &str,
    system: &S,
    start: &S::Start,
    duration: f64,
    events: &[Expected],
) -> Scene {
    let limits = Limits { chatter_floor: FLOOR, ..Limits::new(duration, system.clearance()) };
    let (mut errors, mut rounded) = (Vec::new(), Vec::new());
    if let Ok(run) = run(system, start, &limits) {
        let found = marks(&run, FLOOR);
        let same = found.len() == events.len();
        for (mark, event) in found.iter().zip(events).filter(|_| same) {
            let of = |time: f64| {
                let off = (Dd::from(time) - event.time).value();
                units(off, event.condition, event.time.value())
            };
            errors.push(of(mark.time));
            rounded.push(of(event.time.value()));
        }
    }
    Scene { name: name.to_owned(), errors, rounded }
}

fn all() -> Vec<Scene> {
    let mut all = Vec::new();
    for reference in scenes() {
        let (system, start) = (reference.scene.absorber(), reference.scene.begin());
        let duration = reference.scene.duration;
        all.push(scene(&reference.name, &system, &start, duration, &reference.events));
    }
    for reference in piva_scenes().into_iter().chain(forced_scenes()) {
        let start = Start { displacement: reference.displacement, ..Start::default() };
        let (name, duration, events) = (&reference.name, reference.duration, &reference.events);
        if let Some(siva) = reference.mass() {
            all.push(scene(name, &siva, &start, duration, events));
        } else if let Ok(piva) = Piva::new(reference.parameters) {
            let piva = piva.under(reference.force.clone());
            all.push(scene(name, &piva, &PivaStart::from(start), duration, events));
        }
    }
    all
}

fn worst(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn main() {
    println!("Errors of event times in rounding units\n");
    println!(
        "{:26}{:>7}{:>7}{:>8}{:>8}{:>16}",
        "scene", "events", "worst", "mean", "median", "rounded (worst)"
    );
    let all = all();
    for scene in &all {
        let Scene { name, errors, rounded } = scene;
        if errors.is_empty() {
            println!("{name:26}{:>7}", 0);
            continue;
        }
        println!(
            "{name:26}{:7}{:7.2}{:8.2}{:8.2}{:16.2}",
            errors.len(),
            worst(errors),
            mean(errors),
            median(errors.clone()),
            worst(rounded)
        );
    }
    let most: Vec<f64> =
        all.iter().filter(|it| !it.errors.is_empty()).map(|it| worst(&it.errors)).collect();
    println!("\nmedian of the worst {:.2}, worst of all {:.2}", median(most.clone()), worst(&most));
}
