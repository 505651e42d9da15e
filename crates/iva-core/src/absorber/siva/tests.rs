//! Symmetry under reflection, to the last bit.

use super::*;
use crate::engine::simulate::Limits;
use crate::run::run;

/// A mirrored start gives the same bits with opposite signs.
#[test]
fn mirror_image_has_the_same_bits() {
    let siva = Siva::new(0.1, 0.7, 0.2, 0.02).unwrap();
    let limits = Limits::new(100.0, 0.2);
    for (x, v, y, w) in [(1.0, 0.0, 0.0, 0.0), (0.3, -1.0, 0.1, 0.4), (0.0, 1.0, 0.2, 0.0)] {
        let start = Start { displacement: x, velocity: v, gap_displacement: y, gap_velocity: w };
        let mirror =
            Start { displacement: -x, velocity: -v, gap_displacement: -y, gap_velocity: -w };
        let (run, image) =
            (run(&siva, &start, &limits).unwrap(), run(&siva, &mirror, &limits).unwrap());
        assert!(run.tally.impacts > 20);
        assert_eq!(run.impacts.len(), image.impacts.len());
        for (impact, mirrored) in run.impacts.iter().zip(&image.impacts) {
            assert_eq!(impact.time.to_bits(), mirrored.time.to_bits());
            assert_eq!(impact.wall, mirrored.wall.opposite());
            assert_eq!(impact.velocity_after, -mirrored.velocity_after);
        }
    }
}
