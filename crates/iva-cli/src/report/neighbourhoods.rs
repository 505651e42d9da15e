//! The values of a grid, each judged by the worst among its neighbours: what a small change of any swept quantity may
//! cost. A design does not choose its start, so on an axis of the start all values are neighbours.

use iva_sweep::axis::Axis;
use iva_sweep::columns::Better;
use iva_sweep::fields::Part;
use iva_sweep::sampling::Sampling;

/// Largest number of points whose values are kept, at 8 bytes each.
const MOST: u64 = 10_000_000;

/// The values of all points of a grid.
#[derive(Debug)]
pub(super) struct Neighbourhoods {
    /// For each axis its number of values, and whether all of them are neighbours; the last varies fastest.
    axes: Vec<(usize, bool)>,
    better: Better,
    /// For each point a number that is the larger the worse it is; infinite for one without a value.
    badness: Vec<f64>,
}

impl Neighbourhoods {
    /// A grid without values; `None` for points that are no grid, too many, or have no neighbours on any axis. On an
    /// axis neighbours are next to each other if its values rise or fall.
    pub fn of(sampling: &Sampling, better: Better) -> Option<Self> {
        let Sampling::Grid(axes) = sampling else { return None };
        let points = sampling.points().ok().filter(|points| *points <= MOST)?;
        let in_order =
            |values: &[f64]| values.is_sorted_by(|a, b| a < b) || values.is_sorted_by(|a, b| a > b);
        let wide = axes.iter().any(|axis| axis.values.len() > 2 && !is_of_start(axis));
        if !wide || !axes.iter().all(|axis| in_order(&axis.values)) {
            return None;
        }
        let axes = axes.iter().map(|axis| (axis.values.len(), is_of_start(axis))).collect();
        Some(Self { axes, better, badness: vec![f64::INFINITY; points as usize] })
    }

    /// Sets the value of a point; one without stays worse than any other.
    pub fn set(&mut self, point: u64, value: Option<f64>) {
        if let (Some(place), Some(value)) = (self.badness.get_mut(point as usize), value) {
            *place = match self.better {
                Better::Smaller => value,
                Better::Larger => -value,
            };
        }
    }

    /// True if it has an axis of the start.
    pub fn has_starts(&self) -> bool {
        self.axes.iter().any(|(_, is_of_start)| *is_of_start)
    }

    /// The points with the best neighbourhoods, the best first, each with the worst value among itself and those next
    /// to it on the axes, at any start. Of points that differ in their start alone there is the first. Neighbourhoods
    /// with a point without a value are left out.
    pub fn best(&self, count: usize) -> Vec<(u64, f64)> {
        let mut worst: Vec<(u64, f64)> = (0..).zip(self.worst()).collect();
        worst.retain(|(point, value)| value.is_finite() && self.is_first_start(*point as usize));
        worst.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        worst.truncate(count);
        let sign = if self.better == Better::Larger { -1.0 } else { 1.0 };
        worst.into_iter().map(|(point, value)| (point, sign * value)).collect()
    }

    /// True for the first of the points that differ in their start alone.
    fn is_first_start(&self, point: usize) -> bool {
        let mut stride = 1;
        self.axes.iter().rev().all(|(length, is_of_start)| {
            let place = point / stride % length;
            stride *= length;
            !is_of_start || place == 0
        })
    }

    /// The largest badness in each neighbourhood, of those that differ in their start for the first of them: that of the
    /// neighbours on one axis after the other.
    fn worst(&self) -> Vec<f64> {
        let mut values = self.badness.clone();
        let mut stride = 1;
        for (length, is_of_start) in self.axes.iter().rev() {
            let before = values.clone();
            for (index, value) in before.iter().enumerate() {
                let place = index / stride % length;
                if *is_of_start {
                    // The first of a line collects the worst of all.
                    let first = &mut values[index - place * stride];
                    *first = first.max(*value);
                } else {
                    if place > 0 {
                        values[index - stride] = values[index - stride].max(*value);
                    }
                    if place + 1 < *length {
                        values[index + stride] = values[index + stride].max(*value);
                    }
                }
            }
            stride *= length;
        }
        values
    }
}

/// True for an axis of the start, which a design does not choose.
pub(super) fn is_of_start(axis: &Axis) -> bool {
    axis.slot.info().part == Part::Start
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(lengths: &[u64]) -> Sampling {
        let keys = ["relative_clearance", "mass_ratio", "restitution"];
        let axes = lengths.iter().zip(keys).map(|(n, key)| Axis::linspace(key, 0.1, 0.9, *n));
        Sampling::Grid(axes.map(Result::unwrap).collect())
    }

    #[test]
    fn the_worst_of_a_neighbourhood_is_that_of_its_definition() {
        let lengths = [4, 3, 5];
        // Any numbers that differ, and one point without a value.
        let value = |point: u64| (point != 17).then_some((point as f64 * 0.618).fract());
        for better in [Better::Smaller, Better::Larger] {
            let mut kept = Neighbourhoods::of(&grid(&lengths), better).unwrap();
            (0..60).for_each(|point| kept.set(point, value(point)));
            let places = |point: u64| [point / 15, point / 5 % 3, point % 5];
            let near = |a: u64, b: u64| (0..3).all(|k| places(a)[k].abs_diff(places(b)[k]) <= 1);
            let worse =
                |a: f64, b: f64| if better == Better::Smaller { a.max(b) } else { a.min(b) };
            let mut found = kept.best(100);
            found.sort_by_key(|it| it.0);
            let expected: Vec<(u64, f64)> = (0..60)
                .filter_map(|point| {
                    let values = (0..60).filter(|other| near(point, *other)).map(value);
                    Some((point, values.collect::<Option<Vec<f64>>>()?.into_iter().reduce(worse)?))
                })
                .collect();
            assert!(expected.len() < 60 && expected.len() > 30);
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn luck_is_not_the_best_neighbourhood() {
        let mut kept = Neighbourhoods::of(&grid(&[7]), Better::Smaller).unwrap();
        for (point, value) in (0..).zip([9.0, 1.0, 9.0, 3.0, 2.0, 3.0, 8.0]) {
            kept.set(point, Some(value));
        }
        assert_eq!(kept.best(1), [(4, 3.0)]);
    }

    #[test]
    fn a_design_is_judged_at_its_worst_start() {
        let axes = [("gap", 3), ("displacement", 2)]
            .map(|(key, count)| Axis::linspace(key, 1.0, 2.0, count).unwrap());
        let mut kept = Neighbourhoods::of(&Sampling::Grid(axes.to_vec()), Better::Smaller).unwrap();
        // The last gap is the best at the first start, and bad at the other.
        for (point, value) in (0..).zip([4.0, 5.0, 3.0, 6.0, 1.0, 9.0]) {
            kept.set(point, Some(value));
        }
        assert!(kept.has_starts());
        assert_eq!(kept.best(9), [(0, 6.0), (2, 9.0), (4, 9.0)]);
    }

    #[test]
    fn only_a_grid_in_order_has_neighbours() {
        let unsorted = Axis::new("mass_ratio", vec![0.1, 0.3, 0.2]).unwrap();
        assert!(Neighbourhoods::of(&Sampling::Grid(vec![unsorted]), Better::Smaller).is_none());
        assert!(Neighbourhoods::of(&grid(&[2, 2]), Better::Smaller).is_none());
        assert!(Neighbourhoods::of(&grid(&[3, 2]), Better::Smaller).is_some());
    }
}
