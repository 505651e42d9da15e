//! Derivatives of the motion of free masses and pendulums on a linear structure, of any number and at any points of it.
//!
//! With the shapes φ at the points of the masses and those of a set S carried along, the coordinates q of the structure obey
//!
//! ```text
//! M′q̈ + D q̇ + ω²q = forces,    M′ = I + Σ_S μ φφᵀ,
//! ```
//!
//! where friction of a mass that slides one way is a constant force. A small difference of a state is one of q and q̇, then
//! of y and ẏ of each member. A structure that moves as one has a single coordinate, x, and φ = 1.
//!
//! A pendulum in flight is carried with a part η of its mass, and follows the acceleration of its point by the factor −β c γ ([`Pull`]).

use nalgebra::{DMatrix, DVector};

use super::columns;
use super::lists::{Moved, place};
use crate::absorber::Point;
use crate::host::oscillator::Equation;

/// The linear structure and the masses on it.
#[derive(Debug, Clone)]
pub struct LinearStructure {
    /// ω² of each coordinate, and the springs between them.
    pub stiffness: DMatrix<f64>,
    /// D.
    pub damping: DMatrix<f64>,
    /// φ at the point of each mass.
    pub shapes: Vec<DVector<f64>>,
    /// 1/μ of each mass; 0 of one that is a coordinate of the structure.
    pub lightness: Vec<f64>,
    /// The masses that are coordinates of the structure, √μ (φq + y), and the indices of these.
    pub as_coordinates: Vec<(usize, usize)>,
    /// The stops on the ground, whose gap displacement is −φq.
    pub stops: Vec<usize>,
    /// How each member follows its point in flight.
    pub pulls: Vec<Pull>,
}

/// How a member in flight follows the acceleration A of its point, and pulls at it: ÿ = −f A − G and a force −η A + μ F.
#[derive(Debug, Clone, Copy)]
pub struct Pull {
    /// How much further than in its gap it moves along the line of its point: λ γ/c.
    pub lever: f64,
    /// f = β c γ, and its derivative with respect to y.
    pub follows: [f64; 2],
    /// η = μ (1 − γ²/κ), and its derivative with respect to y.
    pub inertia: [f64; 2],
    /// The derivatives of G with respect to y and ẏ.
    pub swing: [f64; 2],
    /// Those of F.
    pub pull: [f64; 2],
}

impl Pull {
    /// That of a free mass.
    pub const NONE: Self = Self {
        lever: 1.0,
        follows: [1.0, 0.0],
        inertia: [0.0; 2],
        swing: [0.0; 2],
        pull: [0.0; 2],
    };
}

impl LinearStructure {
    /// Number of coordinates.
    pub(in crate::absorber) fn coordinates(&self) -> usize {
        self.stiffness.nrows()
    }

    /// Number of variables of a difference.
    fn variables(&self) -> usize {
        2 * (self.coordinates() + self.shapes.len())
    }

    /// The indices of y and ẏ of a mass.
    pub(in crate::absorber) fn of(&self, mass: usize) -> [usize; 2] {
        place(self.coordinates(), mass)
    }

    /// The derivative of all variables with respect to q, q̇, y and ẏ at the begin, of which coordinates that are masses follow.
    pub(in crate::absorber) fn begin(&self) -> DMatrix<f64> {
        let mut begin = DMatrix::identity(self.variables(), self.variables());
        // Those of a body come before those of what rides on it.
        for (mass, coordinate) in &self.as_coordinates {
            let shape = &self.shapes[*mass];
            let root = -1.0 / shape[*coordinate];
            for (row, gap) in [0, self.coordinates()].into_iter().zip(self.of(*mass)) {
                let of_gap = begin.row(gap) * root;
                let others = shape.iter().enumerate().filter(|(j, _)| j != coordinate);
                let follows =
                    others.fold(of_gap, |sum, (j, phi)| sum + begin.row(row + j) * (root * phi));
                begin.set_row(row + coordinate, &follows);
            }
        }
        for stop in &self.stops {
            for (column, gap) in [0, self.coordinates()].into_iter().zip(self.of(*stop)) {
                let shape = self.shapes[*stop].iter().enumerate();
                let none = begin.row(gap) * 0.0;
                let follows = shape.fold(none, |sum, (j, phi)| sum - begin.row(column + j) * *phi);
                begin.set_row(gap, &follows);
            }
        }
        begin
    }

    /// The derivative of the acceleration of a point of this shape while these masses are carried.
    pub(in crate::absorber) fn pull_on(
        &self,
        shape: &DVector<f64>,
        carried: &[bool],
    ) -> DVector<f64> {
        let n = self.coordinates();
        let felt = self.compliance(|k| self.moves(k, carried)) * shape;
        let mut gradient = DVector::zeros(self.variables());
        gradient.rows_mut(0, n).copy_from(&(&self.stiffness * -&felt));
        gradient.rows_mut(n, n).copy_from(&(&self.damping * -&felt));
        gradient
    }

    /// The reciprocal of what moves with the point of a member: of all of it while it is carried, or of a part of a pendulum in flight.
    pub(super) fn moves(&self, k: usize, carried: &[bool]) -> Option<f64> {
        let [inertia, _] = self.pulls[k].inertia;
        let part = (inertia > 0.0).then(|| 1.0 / inertia);
        if carried[k] { Some(self.lightness[k]) } else { part }
    }

    /// The inverse of M′, by adding one mass after another (J. Sherman and W. J. Morrison, Ann. Math. Stat. 21, 1950).
    pub(super) fn compliance(&self, moves: impl Fn(usize) -> Option<f64>) -> DMatrix<f64> {
        let n = self.coordinates();
        let mut inverse = DMatrix::identity(n, n);
        for (k, shape) in self.shapes.iter().enumerate() {
            let Some(lightness) = moves(k) else { continue };
            let pushed = &inverse * shape;
            let share = lightness + shape.dot(&pushed);
            inverse -= &pushed * pushed.transpose() / share;
        }
        inverse
    }

    /// The derivative of all rates in a motion in which these members are carried, and the points of all have these accelerations.
    pub(in crate::absorber) fn jacobian(&self, carried: &[bool], felt: &[f64]) -> DMatrix<f64> {
        let (n, size) = (self.coordinates(), self.variables());
        let mut forces = DMatrix::zeros(n, size);
        forces.columns_mut(0, n).copy_from(&-&self.stiffness);
        forces.columns_mut(n, n).copy_from(&-&self.damping);
        let flying = || (0..carried.len()).filter(|k| !carried[*k]);
        for k in flying() {
            let Pull { inertia, pull, .. } = self.pulls[k];
            // A mass that is a coordinate pulls by the matrices.
            let mass = if self.lightness[k] > 0.0 { 1.0 / self.lightness[k] } else { 0.0 };
            let [y, w] = self.of(k);
            for (column, by) in [(y, mass * pull[0] - inertia[1] * felt[k]), (w, mass * pull[1])] {
                let mut forces = forces.column_mut(column);
                forces += &self.shapes[k] * by;
            }
        }
        let bent = self.compliance(|k| self.moves(k, carried)) * forces;
        let mut jacobian = DMatrix::zeros(size, size);
        jacobian.view_mut((0, n), (n, n)).fill_with_identity();
        jacobian.rows_mut(n, n).copy_from(&bent);
        for k in flying() {
            let Pull { follows, swing, .. } = self.pulls[k];
            let [y, w] = self.of(k);
            jacobian[(y, w)] = 1.0;
            let mut rate = self.shapes[k].transpose() * &bent * -follows[0];
            rate[y] -= follows[1] * felt[k] + swing[0];
            rate[w] -= swing[1];
            jacobian.row_mut(w).copy_from(&rate);
        }
        jacobian
    }

    /// The derivative of (q, q̇) after a time h.
    pub(super) fn flow_of_structure(&self, carried: &[bool], h: f64) -> DMatrix<f64> {
        let n = self.coordinates();
        let compliance = self.compliance(|k| self.moves(k, carried));
        if n == 1 {
            let [stiffness, damping] =
                [self.stiffness[(0, 0)], self.damping[(0, 0)]].map(|it| it * compliance[(0, 0)]);
            let [[xx, vx], [xv, vv]] = columns(&Equation::of(stiffness, damping), h);
            return DMatrix::from_row_slice(2, 2, &[xx, xv, vx, vv]);
        }
        let mut equation = DMatrix::zeros(2 * n, 2 * n);
        equation.view_mut((0, n), (n, n)).fill_with_identity();
        equation.view_mut((n, 0), (n, n)).copy_from(&(&compliance * -&self.stiffness));
        equation.view_mut((n, n), (n, n)).copy_from(&(&compliance * -&self.damping));
        (equation * h).exp()
    }

    /// What q̇ gains by impulses at the points of some masses that change their gap velocities by −(1 + slope) per unit of the
    /// gap velocity of each of these, column by column, where others give way like this.
    pub(super) fn blows(&self, struck: &[(usize, f64)], compliance: &DMatrix<f64>) -> DMatrix<f64> {
        // The impulses on the masses that have an impact, with the carried ones as part of the structure.
        let count = struck.len();
        let pushed: Vec<_> = struck.iter().map(|(k, _)| compliance * &self.shapes[*k]).collect();
        if let ([(k, slope)], [pushed]) = (struck, pushed.as_slice()) {
            let share = self.shapes[*k].dot(pushed) + self.lightness[*k];
            let blow = pushed * (self.pulls[*k].lever * (1.0 + slope) / share);
            return DMatrix::from_column_slice(self.coordinates(), 1, blow.as_slice());
        }
        let mut matrix =
            DMatrix::from_fn(count, count, |i, j| self.shapes[struck[i].0].dot(&pushed[j]));
        for (i, (k, _)) in struck.iter().enumerate() {
            matrix[(i, i)] += self.lightness[*k];
        }
        let changes = DMatrix::from_diagonal(&DVector::from_iterator(
            count,
            struck.iter().map(|(k, slope)| self.pulls[*k].lever * (1.0 + slope)),
        ));
        // Positive definite, unless numbers have overflowed: then nothing can be estimated from there on.
        let impulses = match matrix.cholesky() {
            Some(factor) => factor.solve(&changes),
            None => DMatrix::repeat(count, count, f64::NAN),
        };
        DMatrix::from_columns(&pushed) * impulses
    }

    /// What q gains per y of a mass that comes to rest on its wall, as if it were moved there, and what q̇ gains per y by the
    /// dampers on the way; `carried` with that mass.
    pub(super) fn stick(&self, mass: usize, carried: &[bool]) -> [DVector<f64>; 2] {
        let others = |k: usize| if k == mass { None } else { self.moves(k, carried) };
        let pushed = self.compliance(others) * &self.shapes[mass];
        let whole = self.lightness[mass] + self.shapes[mass].dot(&pushed);
        let share = &pushed * (self.pulls[mass].lever / whole);
        let damped = self.compliance(|k| self.moves(k, carried)) * (&self.damping * &share);
        [share, -damped]
    }

    /// As [`super::lists::DifferentiableList::roundings`]; x and ẋ of the structure at the end.
    pub(in crate::absorber) fn roundings<S>(
        &self,
        moved: &Moved<'_, S>,
        Point { x, v }: Point,
    ) -> DVector<f64> {
        let Moved { rates: [first, last], carried, length: h, .. } = *moved;
        let fastest = first.abs().sup(&last.abs());
        // A long motion may be fastest in between, up to the root mean square of its velocity.
        let n = self.coordinates();
        let whole = (0.5 * (x * x + v * v)).sqrt();
        let most = |j: usize| {
            let square = self.stiffness[(j, j)].max(f64::MIN_POSITIVE);
            let speed = (0.5 * (fastest[j].powi(2) + fastest[n + j].powi(2) / square)).sqrt();
            if n == 1 { whole } else { speed }
        };
        let most = DVector::from_fn(n, |j, _| most(j));
        let size =
            |fastest: f64, change: f64, most: f64| h * fastest.max((0.25 * h * change).min(most));
        let mut sizes = DVector::zeros(self.variables());
        for j in 0..n {
            let square = self.stiffness[(j, j)];
            let (speed, bend) = (fastest[j], fastest[n + j]);
            sizes[j] = size(speed, bend, most[j]);
            sizes[n + j] = size(bend, square * speed, square.sqrt() * most[j]);
        }
        for (k, shape) in self.shapes.iter().enumerate().filter(|(k, _)| !carried[*k]) {
            let [y, w] = self.of(k);
            let at_point = |of: &dyn Fn(usize) -> f64| {
                shape.iter().enumerate().map(|(j, phi)| phi.abs() * of(j)).sum::<f64>()
            };
            let frequency = |j: usize| self.stiffness[(j, j)].sqrt();
            let change = at_point(&|j| self.stiffness[(j, j)] * fastest[j]);
            let [slow, fast] = [at_point(&|j| most[j]), at_point(&|j| frequency(j) * most[j])];
            sizes[y] = size(fastest[y], fastest[w], slow);
            sizes[w] = size(fastest[w], change, fast);
        }
        sizes
    }
}
