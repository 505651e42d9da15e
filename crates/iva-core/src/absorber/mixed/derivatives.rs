//! The derivatives of the motion of free masses and pendulums on one structure: their Taylor series, evaluated in numbers with
//! derivatives, and those of their impacts.
//!
//! With the notation of [`super::impact_law`], where a pendulum in flight follows the structure by ΔW = −β c Δv, the velocity
//! gained Δv depends on W of those that have their impact, and by T on y of those in flight:
//!
//! ```text
//! ∂Δv/∂W_i = μ λ c (1 + e)/T,    ∂Δv/∂y = −Δv/T · 2μλβ y/b².
//! ```

use nalgebra::{DMatrix, DVector};

use super::{Mixed, MixedState};
use crate::absorber::ImpactLaw as _;
use crate::absorber::derivatives::lists::{DifferentiableList, Moved, place, tail_of};
use crate::absorber::derivatives::piva::{ROUGH, Terms, begun, sharpness};
use crate::force::Drive;
use crate::host::Host;
use crate::number::real::dual::Dual;
use crate::segment::taylor::{Member, Pendulum, Series, series_of_several};

/// The structure has one coordinate, x.
const COORDINATES: usize = 1;

/// The indices of y and W of an absorber.
fn of(absorber: usize) -> [usize; 2] {
    place(COORDINATES, absorber)
}

impl<H: Host<Real = f64>> Mixed<H> {
    fn variables(&self) -> usize {
        2 * (COORDINATES + self.members.len())
    }

    /// The same state, where these absorbers are stuck.
    fn carrying(state: &MixedState<H>, carried: &[bool]) -> MixedState<H> {
        let mut carrying = *state;
        for (place, carried) in carrying.places.iter_mut().zip(carried) {
            place.stuck = *carried;
        }
        carrying
    }

    /// The derivatives of a flight with respect to the four variables from an index on, row by row.
    #[inline(always)]
    fn swung(&self, from: &MixedState<H>, h: f64, first: usize) -> Vec<[f64; 4]> {
        let mut pendulums: Vec<Pendulum<Dual<4>>> = Vec::with_capacity(self.members.len());
        for member in &self.members {
            pendulums.push(member.pendulum.map(Dual::constant));
        }
        let mut swings = Vec::with_capacity(self.members.len());
        for (k, pendulum) in pendulums.iter().enumerate() {
            let [own, _] = of(k);
            let swing = begun(pendulum, &self.seen(from, k), own, first);
            // Just after a release Ẇ is 0, but not its derivatives.
            let (stuck, released) = (from.places[k].stuck, false);
            swings.push(Member { pendulum, swing, stuck, released });
        }
        let drive = self.host.drive(&from.phase, h).map(|drive| Drive {
            primary: std::array::from_fn(|k| Dual::constant(drive.primary[k])),
            base: std::array::from_fn(|k| Dual::constant(drive.base[k])),
        });
        let zeta = Dual::constant(self.host.damping_ratio());
        let series: Vec<Series<Dual<4>, { ROUGH + 1 }>> =
            series_of_several(&swings, zeta, drive.as_ref(), (h.into(), ROUGH));
        let mut rows = vec![[0.0; 4]; self.variables()];
        for (k, series) in series.iter().enumerate() {
            let [y, w] = of(k);
            let each = [(0, &series.x), (1, &series.u), (y, &series.y), (w, &series.w)];
            for (row, coefficients) in each {
                // At t = 1 a polynomial is the sum of its coefficients; small ones are added first.
                let mut sum = [0.0; 4];
                for coefficient in coefficients.iter().rev() {
                    for (sum, slope) in sum.iter_mut().zip(coefficient.slopes) {
                        *sum += slope;
                    }
                }
                rows[row] = sum;
            }
        }
        rows
    }

    /// Adds to the derivatives with respect to a variable that the structure gains a velocity, and that those in flight after
    /// an event follow it.
    fn faster(
        &self,
        map: &mut DMatrix<f64>,
        variable: usize,
        gained: f64,
        flying: &[(usize, f64)],
    ) {
        map[(1, variable)] += gained;
        for (k, follows) in flying {
            let [_, w] = of(*k);
            map[(w, variable)] -= follows * gained;
        }
    }

    /// Those that are in flight after an event, but for some, with β c of each, by which it follows the structure.
    fn flying(&self, after: &MixedState<H>, but: &[usize]) -> Vec<(usize, f64)> {
        let each = self.each(after).enumerate();
        each.filter(|(k, (_, place))| !place.stuck && !but.contains(k))
            .map(|(k, (member, place))| (k, member.pendulum.coupling * place.cosine.value))
            .collect()
    }
}

impl<H: Host<Real = f64>> DifferentiableList for Mixed<H> {
    const LINEAR: bool = false;

    fn coordinates(&self) -> usize {
        COORDINATES
    }

    fn derivative_at_begin(&self) -> DMatrix<f64> {
        DMatrix::identity(self.variables(), self.variables())
    }

    fn carried(&self, state: &MixedState<H>, _sticks: bool) -> Vec<bool> {
        self.each(state).map(|(_, place)| place.stuck).collect()
    }

    fn rates(&self, state: &MixedState<H>, carried: &[bool]) -> DVector<f64> {
        let series = self.beginning::<3>(&Self::carrying(state, carried));
        let mut rates = DVector::zeros(self.variables());
        for (k, series) in series.iter().enumerate() {
            let [y, w] = of(k);
            (rates[0], rates[1]) = (series.x[1], series.u[1]);
            if !carried[k] {
                (rates[y], rates[w]) = (series.y[1], series.w[1]);
            }
        }
        rates
    }

    fn flow(&self, from: &MixedState<H>, carried: &[bool], h: f64) -> DMatrix<f64> {
        let from = Self::carrying(from, carried);
        let size = self.variables();
        let mut flow = DMatrix::zeros(size, size);
        for first in (0..size).step_by(4) {
            let rows = self.swung(&from, h, first);
            for (row, slopes) in rows.iter().enumerate() {
                for (column, slope) in (first..size).zip(slopes) {
                    flow[(row, column)] = *slope;
                }
            }
        }
        flow
    }

    fn roundings(&self, moved: &Moved<'_, MixedState<H>>) -> DVector<f64> {
        let Moved { states, rates: [first, last], carried, length } = *moved;
        let mut sizes = first.abs().sup(&last.abs());
        for k in (0..carried.len()).filter(|k| !carried[*k]) {
            let [y, _] = of(k);
            let sharpness = self.sharpness(states[1], k);
            if sharpness < 1.0 {
                let [one, other] = states.map(|state| state.places[k].w.value.abs());
                sizes[y] = sharpness * one.max(other);
            }
        }
        sizes * length
    }

    fn sizes(&self, state: &MixedState<H>, carried: &[bool]) -> Option<DVector<f64>> {
        let state = Self::carrying(state, carried);
        let driven = self.host.drive_ahead::<3>(&state.phase).as_ref().map_or(0.0, Drive::size);
        let (x, u) = (state.primary.x.value.abs(), state.primary.v.value.abs());
        let terms: Vec<Terms> = (0..carried.len())
            .map(|k| Terms::of(&self.members[k].pendulum, &self.seen(&state, k)))
            .collect();
        let mut on_structure = driven + x + 2.0 * self.host.damping_ratio() * u;
        for (k, Terms { swing, turning, .. }) in
            terms.iter().enumerate().filter(|(k, _)| !carried[*k])
        {
            let Pendulum { mass_ratio, lever, .. } = self.members[k].pendulum;
            on_structure += mass_ratio * lever * (turning + swing);
        }
        let structure = on_structure / self.together(&state, |_| false).value;
        let mut sizes = DVector::zeros(self.variables());
        (sizes[0], sizes[1]) = (u, structure);
        for (k, Terms { swing, steep, .. }) in
            terms.iter().enumerate().filter(|(k, _)| !carried[*k])
        {
            let ([y, w], place) = (of(k), &state.places[k]);
            sizes[y] = place.rate().abs();
            sizes[w] = self.members[k].pendulum.coupling * structure * steep + swing;
        }
        Some(sizes)
    }

    fn sharpness(&self, state: &MixedState<H>, absorber: usize) -> f64 {
        sharpness(&self.members[absorber].pendulum, &self.seen(state, absorber))
    }

    fn impact_matrix(
        &self,
        struck: &[usize],
        [before, after]: [&MixedState<H>; 2],
        carried: [&[bool]; 2],
    ) -> DMatrix<f64> {
        let mut jump = self.derivative_at_begin();
        let [was_carried, is_carried] = carried;
        for k in (0..is_carried.len()).filter(|k| was_carried[*k] && !is_carried[*k]) {
            let [_, w] = of(k);
            jump[(w, w)] = 0.0;
        }
        let together = self.together(after, |k| struck.contains(&k)).value;
        let flying = self.flying(after, struck);
        for &k in struck {
            let (place, [_, w]) = (&before.places[k], of(k));
            let slope = self.law_of(k, place.wall, -place.rate()).slope;
            let Pendulum { mass_ratio, lever, .. } = self.members[k].pendulum;
            let push = mass_ratio * lever * place.cosine.value * (1.0 + slope);
            self.faster(&mut jump, w, push / together, &flying);
            jump[(w, w)] = -slope;
        }
        let gained = (after.primary.v - before.primary.v).value;
        for (k, _) in flying.iter().filter(|(k, _)| !self.members[*k].pendulum.small_angles) {
            let Pendulum { mass_ratio, lever, coupling, contact_distance, .. } =
                self.members[*k].pendulum;
            let ([y, w], sine) = (of(*k), self.seen(after, *k).y().value / contact_distance);
            let heavier = 2.0 * mass_ratio * lever * coupling * sine / contact_distance;
            self.faster(&mut jump, y, -gained * heavier / together, &flying);
            let cosine = after.places[*k].cosine.value;
            if cosine != 0.0 {
                jump[(w, y)] += coupling * gained * sine / (contact_distance * cosine);
            }
        }
        jump
    }

    /// The centre of mass is conserved.
    fn stick_matrix(&self, state: &MixedState<H>, _carried: &[bool]) -> DMatrix<f64> {
        let mut map = self.derivative_at_begin();
        let (at_hand, member) = self.at_hand(state);
        let [y, w] = of(at_hand);
        let together = self.together(state, |_| false).value;
        let share = member.pendulum.mass_ratio * member.pendulum.lever / together;
        (map[(y, y)], map[(w, w)]) = (0.0, 0.0);
        let flying = self.flying(state, &[at_hand]);
        map[(0, y)] = share;
        for (k, follows) in &flying {
            map[(of(*k)[0], y)] = -state.places[*k].cosine.value * follows * share;
        }
        self.faster(&mut map, w, share * state.places[at_hand].cosine.value, &flying);
        map
    }

    fn tail(&self, after: &MixedState<H>) -> f64 {
        tail_of(self, after)
    }

    fn pressing(&self, absorber: usize, changes: &dyn Fn(usize) -> f64) -> f64 {
        self.members[absorber].pendulum.coupling * (changes(0) + changes(1))
    }
}
