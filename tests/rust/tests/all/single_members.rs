//! One member with any terms on an oscillator: maps, orbits and branches.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use iva_core::{
    absorber::{
        Absorber, Clock, Start, Wall,
        modal::{FewModes, ModalStructure, PRIMARY, Tie},
    },
    compensated::DoubleDouble,
    error::Invalid,
    force::{Acts, Force, Harmonic},
    host::DrivenHost,
    orbit::{
        Coordinates, Cycle, Numbered, Trajectory,
        branch::{Along, End, follow},
        chain::Chain,
        conditions::Kind,
        description::describe,
        map,
        periodic::find,
        spectrum::spectrum,
    },
    piva::{Parameters, Piva},
    simulate::Outcome,
    siva::{FreeMass, Siva},
};
use iva_tests::rng::Rng;
use nalgebra::Vector4;

type One = FewModes<DrivenHost>;

/// A member with these terms on an oscillator under F cos Ωτ.
struct Scene {
    mass: FreeMass,
    tie: Tie<f64>,
    pendulum: Option<(Parameters, f64)>,
    gravity: f64,
    friction: [f64; 2],
    damping_ratio: f64,
    harmonic: Harmonic,
}

impl Scene {
    fn of(mass: FreeMass, damping_ratio: f64, amplitude: f64, frequency: f64) -> Self {
        let harmonic = Harmonic { amplitude, frequency, phase: 0.0, acts: Acts::Primary };
        let (tie, pendulum, gravity, friction) = (Tie::NONE, None, 0.0, [0.0; 2]);
        Self { mass, tie, pendulum, gravity, friction, damping_ratio, harmonic }
    }

    fn system(&self) -> Result<One, Invalid> {
        let structure = ModalStructure::moving_as_one(self.damping_ratio)?;
        let (pendulum, rising) = self.pendulum.unzip();
        FewModes::with_room(structure, &[(self.mass, PRIMARY)])?
            .with_pendulums(&[pendulum])?
            .with_rising_pivots(&[DoubleDouble::new(rising.unwrap_or(0.0))])?
            .with_ties(&[self.tie])?
            .with_gravity(&[self.gravity])?
            .with_friction(&[self.friction[0]])?
            .with_static_friction(&[self.friction[1]])?
            .under(Force::harmonic(vec![self.harmonic])?, PRIMARY)
    }

    fn trajectory(&self, start: Start) -> Trajectory<One> {
        let cycle = Cycle { begin: 0.0, length: TAU / self.harmonic.frequency };
        Trajectory::new(self.system().unwrap(), &start.into(), cycle).unwrap()
    }
}

/// One of each kind that is a system of its own: a mass with spring and dashpot, one with a single wall on a line that rises, a stop on the ground, a
/// pendulum whose pivot moves up and down, and a mass that rubs.
fn kinds(rng: &mut Rng) -> [Scene; 5] {
    let drive = |rng: &mut Rng| (rng.range(0.2, 1.0), rng.range(0.6, 1.6));
    let (e, d) = (rng.range(0.05, 0.9), rng.range(0.3, 1.0));
    let [(f, w), (f1, w1), (f2, w2), (f3, w3)] = [(); 4].map(|()| drive(rng));
    let mass = FreeMass::new(rng.range(0.02, 0.3), e, d).unwrap();
    let tied = Scene {
        tie: Tie { spring: rng.range(0.0, 0.05), damping: rng.range(0.0, 0.02) },
        ..Scene::of(mass, 0.02, f, w)
    };
    let single = Scene { gravity: 0.3, ..Scene::of(mass.with_only(Wall::Minus), 0.02, f1, w1) };
    let stop = FreeMass::on_ground(e, d).unwrap().with_offset(0.1).unwrap();
    let stop = Scene::of(stop, 0.05, f2, w2);
    let hung = Parameters {
        frequency_ratio: rng.range(0.3, 1.2),
        ..Parameters::point_bob(0.1, e, d, 0.0, d * rng.range(1.5, 4.0))
    };
    let rises = rng.range(0.2, 1.5);
    let mass = FreeMass::new(0.1, e, d).unwrap();
    let pendulum = Scene { pendulum: Some((hung, rises)), ..Scene::of(mass, 0.02, f3, w3) };
    let friction = rng.range(0.05, 0.3);
    let rubs = Scene {
        friction: [friction, friction * rng.pick(&[1.0, 1.3])],
        ..Scene::of(mass, 0.02, f, w)
    };
    [tied, single, stop, pendulum, rubs]
}

/// Central differences of the images of two starts; those whose impacts differ are passed over.
#[test]
fn maps_have_the_derivatives_of_differences() {
    let (mut rng, mut rides, mut worst, mut compared) = (Rng::new(7), 0, [0.0_f64; 5], [0; 5]);
    for _ in 0..40 {
        for (kind, scene) in kinds(&mut rng).into_iter().enumerate() {
            let start = Start {
                displacement: 0.2 * rng.range(-1.0, 1.0),
                velocity: rng.range(-1.0, 1.0),
                gap_displacement: 0.2 * rng.range(0.0, 1.0),
                gap_velocity: rng.range(-1.0, 1.0),
            };
            let trajectory = scene.trajectory(start);
            let system = &trajectory.system;
            let at = system.coordinates(&trajectory.state);
            let image = map(&trajectory, true, None).unwrap();
            if image.outcome != Outcome::Finished {
                continue;
            }
            rides += image.rides;
            let tangent = image.tangent.unwrap().matrix;
            let moved = |by: Vector4<f64>| {
                let start = system.start_at(&(at + by))?;
                let state = system.begin_at(&start, Clock::ZERO);
                let moved = map(&trajectory.from(&state), false, None).unwrap();
                let alike = moved.impacts == image.impacts && moved.rides == image.rides;
                alike.then(|| system.coordinates(&moved.state))
            };
            for column in 0..4 {
                let off = |size: f64| {
                    let by = Vector4::ith(column, size);
                    let off = (moved(by)? - moved(-by)?) / (2.0 * size) - tangent.column(column);
                    Some(off.amax() / tangent.amax().max(1.0).powi(2))
                };
                // Where an impact is slow a small difference is better, elsewhere a larger one.
                let (Some(coarse), Some(fine)) = (off(1e-6), off(1e-7)) else { continue };
                worst[kind] = worst[kind].max(coarse.min(fine));
                compared[kind] += 1;
            }
        }
    }
    assert!(rides > 20 && compared.iter().all(|count| *count > 60), "{rides} {compared:?}");
    assert!(worst.iter().all(|off| *off < 1e-8), "{worst:?}");
}

/// A plain mass is that of [`Siva`], and a pendulum on a level line that of [`Piva`], whose multipliers do not depend on the coordinates.
#[test]
fn plain_members_have_the_orbits_of_one_absorber() {
    let start = Start { displacement: 1.0, ..Start::default() };
    let cycle = Cycle { begin: 0.0, length: TAU };
    let scene = Scene::of(FreeMass::new(0.2, 0.7, 4.5).unwrap(), 0.05, 1.0, 1.0);
    let force = || Force::harmonic(vec![scene.harmonic]).unwrap();
    let siva = Siva::new(0.2, 0.7, 4.5, 0.05).unwrap().under(force());
    let start = Start { gap_velocity: 0.1, ..start };
    let settled = |mut trajectory: Trajectory<One>| {
        for _ in 0..200 {
            trajectory.state = map(&trajectory, false, None).unwrap().state;
        }
        trajectory
    };
    let one = find(&settled(scene.trajectory(start)), true, None).unwrap();
    let system = &one.trajectory.system;
    let like = siva.numbered(system.numbers(&one.trajectory.state));
    let cycle = Cycle { begin: one.trajectory.cycle.begin, ..cycle };
    let other = find(&Trajectory::new(siva, &like, cycle).unwrap(), true, None).unwrap();
    for (a, b) in one.multipliers.iter().zip(&other.multipliers) {
        assert!((a - b).norm() < 1e-11, "{a} {b}");
    }
    let described = describe(&one, None).unwrap();
    let known = spectrum(&one, &described, None).unwrap();
    let like = spectrum(&other, &describe(&other, None).unwrap(), None).unwrap();
    assert_eq!(known.rank, like.rank);
    assert!(known.determinant_error.unwrap().abs() < 1e-13, "{known:?}");

    let parameters = Parameters {
        frequency_ratio: 0.4,
        damping_ratio: 0.05,
        ..Parameters::point_bob(0.1, 0.6, 1.0, 0.05, 3.0)
    };
    let scene = Scene {
        pendulum: Some((parameters, 0.0)),
        ..Scene::of(FreeMass::new(0.1, 0.6, 1.0).unwrap(), 0.05, 0.5, 1.0)
    };
    let piva = Piva::new(parameters).unwrap().under(force_of(&scene));
    let one = find(&settled(scene.trajectory(start)), false, None).unwrap();
    let [x, v, y, rate] = one.trajectory.system.numbers(&one.trajectory.state);
    let w = rate / (1.0 - (y / 3.0).powi(2)).sqrt();
    let cycle = Cycle { begin: one.trajectory.cycle.begin, ..cycle };
    let like = piva.numbered([x, v, y, w]);
    let other = find(&Trajectory::new(piva, &like, cycle).unwrap(), false, None).unwrap();
    assert!(one.impacts > 0 && one.impacts == other.impacts);
    for (a, b) in one.multipliers.iter().zip(&other.multipliers) {
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
}

fn force_of(scene: &Scene) -> Force {
    Force::harmonic(vec![scene.harmonic]).unwrap()
}

/// ẍ + x = cos ωt with a wall at x = σ, in closed form (S. W. Shaw and P. J. Holmes, J. Sound Vib. 90, 1983): the orbits with one impact in a period: its phase, the speed of the impact, and 1 + tr + e², which vanishes where the period doubles.
struct Shaw {
    phase: f64,
    velocity: f64,
    flip: f64,
}

fn shaw(sigma: f64, e: f64, omega: f64) -> Shaw {
    let (period, gain) = (TAU / omega, 1.0 / (1.0 - omega * omega));
    let k = (0.5 * period).tan();
    // −γω S = −(σ − γC) k (1 − e)/(1 + e), for the phase φ of the impact.
    let lost = k * (1.0 - e) / (1.0 + e);
    let size = gain.abs() * omega.hypot(lost);
    let phase = (gain * omega).atan2(lost * gain) - (lost * sigma / size).acos();
    let (sine, cosine) = phase.sin_cos();
    let approach = -(sigma - gain * cosine) * k - gain * omega * sine;
    let pull = cosine - sigma;
    let trace = -2.0 * e * period.cos() + (1.0 + e) * pull * period.sin() / approach;
    Shaw { phase, velocity: approach, flip: 1.0 + trace + e * e }
}

/// The value between two at which a function vanishes.
fn root(mut low: f64, mut high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let sign = of(low).signum();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if of(middle).signum() == sign { low = middle } else { high = middle }
    }
    low
}

/// Its period doubles where the closed form says so, and it ends in the grazing of the motion without impacts, whose amplitude is 1/(ω² − 1).
#[test]
fn the_impact_oscillator_doubles_its_period_and_grazes_where_the_closed_form_does() {
    let (e, omega) = (0.8, 2.4);
    let scene = |sigma: f64| {
        let mass = FreeMass::on_ground(e, sigma)?.with_only(Wall::Plus);
        Ok(Scene::of(mass, 0.0, 1.0, omega))
    };
    let made = |values: &[f64]| Ok((scene(values[0])?.system()?, TAU / omega));
    let sigma = 0.1;
    let Shaw { phase, velocity, .. } = shaw(sigma, e, omega);
    let start = Start { displacement: sigma, velocity: -e * velocity, ..Start::default() };
    let cycle = Cycle { begin: phase.rem_euclid(TAU) / omega, length: TAU / omega };
    let system = made(&[sigma]).unwrap().0;
    let trajectory = Trajectory::new(system, &start.into(), cycle).unwrap();
    let orbit = find(&trajectory, false, None).unwrap();
    assert_eq!(orbit.impacts, 1);
    assert!((orbit.multipliers[2].norm(), orbit.multipliers[3].norm()) == (0.0, 0.0));
    let (chain, unknowns) = Chain::of(&orbit, 1).unwrap();
    let branch = follow::<One>(&made, (&chain, &unknowns), sigma, Along::new([0.02, 0.4])).unwrap();
    let flip = root(sigma, 0.2, |sigma| shaw(sigma, e, omega).flip);
    let found: Vec<_> =
        branch.special.iter().map(|it| (it.condition.kind(), it.at.value)).collect();
    let [(Kind::Flip, doubled), (Kind::ImpactVanishes, vanished)] = found[..] else {
        panic!("{found:?} {:?}", branch.ends)
    };
    assert!((doubled - flip).abs() < 1e-11, "{doubled} {flip}");
    assert!((vanished - 1.0 / (omega * omega - 1.0)).abs() < 1e-9, "{vanished}");
    assert_eq!(branch.ends, [End::Range, End::ImpactVanishes]);
    for point in &branch.points {
        let speed = shaw(point.value, e, omega).velocity;
        assert!((point.slowest - speed).abs() < 1e-11, "{} {speed}", point.slowest);
    }
}
