//! The estimated errors of runs of lists with a pendulum: against true errors, which are those against runs in numbers of
//! twice the precision, against the estimates for a single pendulum, and against differences of runs.
#![allow(clippy::unwrap_used, clippy::panic)]

use iva_core::{
    absorber::Point,
    force::Acts,
    impact::Impact,
    observe::Events,
    propagation::Errors,
    real::{Real, twofold::Twofold},
    simulate::simulate,
};
use iva_tests::covered::Covered;
use iva_tests::list::{Starts, begun, driven};
use iva_tests::pendulum_list::{
    Any, any, any_list, by_itself, gaps, limits, mixed, piva, push, start,
};
use iva_tests::rng::Rng;
use iva_tests::some;

/// A list and what drives it.
struct Scene {
    all: Vec<Any>,
    at: [f64; 2],
    zeta: f64,
    acts: Option<Acts>,
}

impl Scene {
    fn random(rng: &mut Rng, count: usize, acts: Option<Acts>) -> Self {
        let all = any_list(rng, count);
        let at = [rng.range(0.5, 2.0), rng.range(-1.0, 1.0)];
        Self { all, at, zeta: rng.range(0.0, 0.05), acts }
    }

    /// The impacts of a run from a start, and the errors of one in doubles.
    fn events<R: Real>(&self, begun: &Starts<R>, duration: f64) -> Events<R> {
        let (system, limits) = (mixed::<R>(&self.all, self.zeta), limits::<R>(duration));
        let mut events = Events::default();
        match self.acts {
            Some(acts) => {
                let system = driven(&system, push(0.4, 0.9, acts));
                simulate(&system, begun, &limits, None, &mut events).unwrap();
            }
            None => {
                simulate(&system, begun, &limits, None, &mut events).unwrap();
            }
        }
        events
    }

    fn errors(&self, duration: f64) -> Errors {
        let (system, limits) = (mixed::<f64>(&self.all, self.zeta), limits::<f64>(duration));
        let (begun, mut errors) = (start(self.at, &self.all), Errors::default());
        match self.acts {
            Some(acts) => {
                let system = driven(&system, push(0.4, 0.9, acts));
                simulate(&system, &begun, &limits, None, &mut errors).unwrap();
            }
            None => {
                simulate(&system, &begun, &limits, None, &mut errors).unwrap();
            }
        }
        errors
    }
}

fn drive(k: usize) -> Option<Acts> {
    [None, Some(Acts::Primary), None, Some(Acts::Base)][k % 4]
}

/// True errors exceed their estimates as rarely as those of a single pendulum do, and estimates are of their size.
#[test]
fn estimates_cover_the_errors() {
    let mut rng = Rng::new(71);
    let (mut covered, mut episodes) = (Covered::default(), 0);
    for k in 0..some(48) {
        let scene = Scene::random(&mut rng, 1 + k % 4, drive(k));
        let events = scene.events::<f64>(&start(scene.at, &scene.all), 20.0);
        let exact = scene.events::<Twofold>(&start(scene.at, &scene.all), 20.0);
        let errors = scene.errors(20.0);
        episodes += events.episodes.len();
        covered.count(&events.impacts, &exact.impacts, &errors);
    }
    assert!(episodes > some(10), "{episodes} episodes");
    covered.holds(some(800));
}

/// One pendulum in a list has estimates of the size of those of the pendulum alone, whose formulas are others.
#[test]
fn one_in_a_list_has_those_of_a_pendulum() {
    let mut rng = Rng::new(73);
    let mut compared = 0;
    for _ in 0..40 {
        let one = any(&mut rng, true);
        let scene =
            Scene { all: vec![one], at: [rng.range(0.5, 2.0), 0.3], zeta: 0.01, acts: None };
        let listed = scene.errors(12.0);
        let by_itself = by_itself::<f64>(scene.at, &one);
        let (alone, mut errors) = (piva::<f64>(&one, scene.zeta), Errors::default());
        simulate(&alone, &by_itself, &limits(12.0), None, &mut errors).unwrap();
        for (one, other) in listed.impacts.iter().zip(&errors.impacts).take(8) {
            let (Some(one), Some(other)) = (one.time, other.time) else { break };
            assert!((0.5..2.0).contains(&(one / other)), "{one} {other}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

/// The start with a small difference of one variable.
fn varied(scene: &Scene, variable: usize, by: Twofold) -> Starts<Twofold> {
    let [mut x, mut v] = scene.at.map(Twofold::from);
    let mut gaps = gaps::<Twofold>(&scene.all);
    match variable {
        0 => x += by,
        1 => v += by,
        _ if variable.is_multiple_of(2) => gaps[variable / 2 - 1].y += by,
        _ => gaps[variable / 2 - 1].w += by,
    }
    begun(Point { x, v }, &gaps)
}

/// The condition is the largest change of an impact time per change of a start value, by differences in twice the precision:
/// of all variables, so that a wrong derivative of a flight or an impact shows.
#[test]
fn the_condition_is_that_of_differences() {
    let mut rng = Rng::new(79);
    let [mut compared, mut impacts] = [0, 0];
    for k in 0..24 {
        let count = 1 + k % 3;
        let scene = Scene::random(&mut rng, count, drive(k));
        let duration = 6.0;
        let events = scene.events(&start::<f64>(scene.at, &scene.all), duration);
        let errors = scene.errors(duration);
        let Some(condition) = errors.condition() else { continue };
        // Rebounds of a chatter after the last that is listed have their part in it.
        if !events.episodes.is_empty() || condition > 1e6 {
            continue;
        }
        let small = Twofold::from(1e-12);
        let mut largest = 0.0_f64;
        for variable in 0..2 + 2 * count {
            let [below, above] = [-small, small]
                .map(|by| scene.events(&varied(&scene, variable, by), duration).impacts);
            let change = |(a, b): (&Impact<Twofold>, &Impact<Twofold>)| {
                f64::from((b.time - a.time) / (small + small)).abs()
            };
            largest = below.iter().zip(&above).map(change).fold(largest, f64::max);
        }
        let expected = largest * scene.at[0];
        assert!((condition / expected - 1.0).abs() < 1e-4, "{k}: {condition} {expected}");
        compared += 1;
        impacts += events.impacts.len();
    }
    assert!(compared > 12 && impacts > 60, "{compared} {impacts}");
}
