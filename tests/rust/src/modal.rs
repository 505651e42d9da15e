//! Random scenes of free masses on structures with several modes, and the numbers of their runs.

use iva_core::{
    absorber::modal::{ModalStart, ModalStructure, Tie},
    flight::GapPoint,
    force::{Acts, Force, Harmonic},
    impact::Impact,
    real::Real,
    run::Run,
    simulate::{Limits, Outcome},
    siva::FreeMass,
};

use crate::rng::Rng;

/// Parameters of a mass and its start: μ, e, d, offset, y and w.
pub type Mass = [f64; 6];

/// A random mass in a gap.
pub fn any_mass(rng: &mut Rng) -> Mass {
    let d = rng.range(0.2, 1.5);
    let offset = rng.range(-0.2, 0.2);
    let y = offset + d * rng.range(-0.9, 0.9);
    [rng.log_range(0.02, 0.5), rng.range(0.2, 0.95), d, offset, y, rng.range(-0.5, 0.5)]
}

/// The mass of these parameters.
pub fn built<R: Real>([mu, e, d, offset, ..]: Mass) -> FreeMass<R> {
    let mass = FreeMass::new(mu.into(), e.into(), d.into()).unwrap();
    mass.with_offset(offset.into()).unwrap()
}

/// The places of masses in their gaps.
pub fn gaps<R: Real, const N: usize>(masses: &[Mass; N]) -> [GapPoint<R>; N] {
    masses.map(|[.., y, w]| GapPoint { y: y.into(), w: w.into() })
}

/// Numbers of another type.
pub fn reals<R: Real>(numbers: &[f64]) -> Vec<R> {
    numbers.iter().map(|it| R::from(*it)).collect()
}

/// Springs and dashpots.
pub fn ties<R: Real>(given: &[[f64; 2]]) -> Vec<Tie<R>> {
    given.iter().map(|[k, c]| Tie { spring: R::from(*k), damping: R::from(*c) }).collect()
}

/// A harmonic force.
pub fn push<R: Real>(amplitude: f64, frequency: f64, acts: Acts) -> Force<R> {
    let [amplitude, frequency, phase] = [amplitude, frequency, 0.3].map(R::from);
    Force::harmonic(vec![Harmonic { amplitude, frequency, phase, acts }]).unwrap()
}

/// Limits of a run of this duration.
pub fn limits<R: Real>(duration: f64) -> Limits<R> {
    Limits::new(duration.into(), R::from(0.3))
}

/// An impact: the index of its absorber, and time, wall, velocities before and after.
pub type Row = (u8, [f64; 6]);

/// The numbers of all impacts.
pub fn rows<R: Real>(impacts: &[Impact<R>]) -> Vec<Row> {
    let row = |it: &Impact<R>| {
        let numbers = [it.time, it.velocity_before, it.velocity_after];
        let [time, before, after] = numbers.map(Real::double);
        let [w, to] = [it.gap_velocity_before, it.gap_velocity_after].map(Real::double);
        (it.absorber, [time, it.wall.sign(), before, after, w, to])
    };
    impacts.iter().map(row).collect()
}

/// Begin, stick and release of all episodes.
pub fn instants<S, R: Real>(run: &Run<S, R>) -> Vec<f64> {
    let each = run.episodes.iter().flat_map(|episode| {
        let release = episode.release_time.unwrap_or(R::ZERO);
        [episode.start_time, episode.stick_time, release].map(Real::double)
    });
    each.collect()
}

/// The largest difference of the numbers of as many impacts.
pub fn furthest(a: &[Row], b: &[Row]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many impacts");
    let off = |(a, b): (&Row, &Row)| (0..6).map(|k| (a.1[k] - b.1[k]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(off).fold(0.0, f64::max)
}

/// A structure of random modes, with four points, and any damping.
pub fn any_structure<R: Real>(rng: &mut Rng, n: usize, full: bool) -> ModalStructure<R> {
    let mut frequencies = vec![1.0];
    while frequencies.len() < n {
        frequencies.push(frequencies[frequencies.len() - 1] * rng.range(1.2, 2.0));
    }
    let ratios: Vec<f64> = frequencies.iter().map(|_| rng.range(0.0, 0.04)).collect();
    let mut structure = ModalStructure::new(&reals(&frequencies), &reals(&ratios)).unwrap();
    if full {
        // Two dashpots: c cᵀ is not negative.
        let dashpots: [Vec<f64>; 2] =
            std::array::from_fn(|_| (0..n).map(|_| rng.range(-0.2, 0.2)).collect());
        let element = |e: usize| dashpots.iter().map(|c| c[e / n] * c[e % n]).sum::<f64>();
        let matrix: Vec<f64> = (0..n * n).map(element).collect();
        structure = structure.with_damping(&reals(&matrix)).unwrap();
    }
    for name in ["p0", "p1", "p2", "p3"] {
        let shapes: Vec<f64> =
            (0..n).map(|j| rng.range(-1.0, 1.0) / (1.0 + j as f64 * 0.3)).collect();
        structure = structure.with_point(name, &reals(&shapes)).unwrap();
    }
    let parts: Vec<f64> = (0..n).map(|_| rng.range(-1.0, 1.0)).collect();
    structure.with_base(&reals(&parts)).unwrap()
}

/// Names of the points.
pub const POINTS: [&str; 4] = ["p0", "p1", "p2", "p3"];

/// A random start of as many modes.
pub fn any_start<R: Real, const N: usize>(
    rng: &mut Rng,
    n: usize,
    masses: &[Mass; N],
) -> ModalStart<R, N> {
    let mut all = |size: f64| -> Vec<f64> {
        (0..n).map(|j| size * rng.range(-1.0, 1.0) / (1.0 + j as f64)).collect()
    };
    let (q, v) = (all(2.0), all(0.5));
    ModalStart::new(&reals::<R>(&q), &reals::<R>(&v), gaps(masses)).unwrap()
}

/// Rows of impacts, instants of stick episodes, and the work of the drive.
pub type Told = (Vec<Row>, Vec<f64>, f64);

/// Those of a run that has finished.
pub fn told<S, R: Real>(run: &Run<S, R>) -> Told {
    assert_eq!(run.tally.outcome, Outcome::Finished);
    (rows(&run.impacts), instants(run), run.measures.energy_work.double())
}
