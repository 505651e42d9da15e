//! How uncertain it is where a start ends: the entropy of basins (A. Daza et al., Scientific Reports 6 (2016) 31416).

/// The entropies of a grid of labels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entropy {
    /// The mean over all boxes of Σ −p ln p, p the share of an attractor in a box.
    pub basin: f64,
    /// The mean over the boxes that hold more than one attractor; `None` if there are none. Above ln 2 the boundary is
    /// fractal.
    pub boundary: Option<f64>,
    /// Number of boxes that hold more than one attractor.
    pub boundary_boxes: usize,
    /// Number of boxes.
    pub boxes: usize,
}

/// The entropies of a grid given row by row, in square boxes. Cells without a label do not count, nor boxes without any, nor what
/// is left over at the margins. `None` if no box counts.
pub fn entropy(labels: &[Option<usize>], columns: usize, side: usize) -> Option<Entropy> {
    if columns == 0 || side == 0 {
        return None;
    }
    let rows = labels.len() / columns;
    let (mut sum, mut boxes, mut boundary_boxes) = (0.0, 0, 0);
    for top in 0..rows / side {
        for left in 0..columns / side {
            let row = |r: usize| &labels[(top * side + r) * columns + left * side..][..side];
            let mut held: Vec<usize> = (0..side).flat_map(row).copied().flatten().collect();
            if held.is_empty() {
                continue;
            }
            held.sort_unstable();
            let all = held.len() as f64;
            let shares = held.chunk_by(|a, b| a == b).map(|same| same.len() as f64 / all);
            sum -= shares.map(|share| share * share.ln()).sum::<f64>();
            boxes += 1;
            boundary_boxes += usize::from(held[0] != held[held.len() - 1]);
        }
    }
    let boundary = (boundary_boxes > 0).then(|| sum / boundary_boxes as f64);
    (boxes > 0).then(|| Entropy { basin: sum / boxes as f64, boundary, boundary_boxes, boxes })
}
