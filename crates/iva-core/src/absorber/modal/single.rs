//! One member on a structure that moves as one, by four numbers: x, ẋ, y from the middle of its gap and ẏ.
//!
//! The derivatives of its motion are those of [`super::linear`], which may know more variables: a mass with a spring or a dashpot is a coordinate
//! of the structure as well. So a difference of four numbers is spread over all variables, carried, and read again. At a stop on the ground y and ẏ
//! tell x and ẋ, which are the same motion: the numbers are four, but the state has two dimensions.

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

use super::{Modal, ModalStart, ModalState};
use crate::absorber::Start;
use crate::absorber::derivatives::Differentiable;
use crate::absorber::derivatives::lists::{DifferentiableList, slip};
use crate::absorber::derivatives::maps::{Map, map_columns};
use crate::error::Invalid;
use crate::host::Host;
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

/// Length of the parts of a swing whose derivatives are to some twelve digits, in units of its fastest rate.
pub(super) const FINE: f64 = 0.05;

impl<R: Real, const N: usize, const M: usize> From<Start<R>> for ModalStart<R, N, M> {
    fn from(start: Start<R>) -> Self {
        let Start { displacement, velocity, gap_displacement: y, gap_velocity: w } = start;
        Self::of_one([displacement, velocity], GapPoint { y, w })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// True if four numbers tell the state.
    pub(crate) fn is_single(&self) -> bool {
        self.count() == 1 && self.structure.moves_as_one()
    }

    /// Checks that four numbers tell the state.
    ///
    /// # Errors
    /// [`Invalid`] if they do not.
    pub fn check_single(&self) -> Result<(), Invalid> {
        if !self.is_single() {
            let rule = "give one absorber on one mode";
            return Err(Invalid::new("absorber", format!("{} in all", self.count()), rule));
        }
        Ok(())
    }
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> Modal<H, N, M> {
    /// The indices of x, ẋ, y and ẏ among all variables.
    pub(super) fn four(&self) -> [usize; 4] {
        let n = self.whole.count();
        [0, n, 2 * n, 2 * n + 1]
    }

    /// All variables by the four numbers.
    pub(super) fn spread(&self) -> DMatrix<f64> {
        let (begin, four) = (self.derivative_at_begin(), self.four());
        let mut spread = begin.select_columns(&four);
        if self.on_ground(0) {
            // y = −φ₀ q.
            let over = -1.0 / self.gap_shape(0)[0];
            spread.fill(0.0);
            for (column, (own, of_point)) in
                [(four[2], four[0]), (four[3], four[1])].into_iter().enumerate()
            {
                (spread[(own, 2 + column)], spread[(of_point, 2 + column)]) = (1.0, over);
            }
        }
        spread
    }

    /// The four rows of a derivative, by the four numbers.
    fn folded(&self, mut derivative: Map<'_>) -> Matrix4<f64> {
        let (mut all, four) = self.by_numbers().clone();
        map_columns(&mut all, &mut derivative);
        all.select_rows(&four).fixed_view::<4, 4>(0, 0).into()
    }

    /// −div ż where nothing swings or rubs: the same in any state.
    pub(crate) fn shrinking(&self) -> Option<f64> {
        let rubs = self.friction.iter().any(|it| *it != 0.0);
        (self.is_linear() && !rubs).then(|| {
            let (spread, numbers) = self.by_numbers();
            let jacobian = self.jacobian(&self.at_rest(), &vec![false; self.count()]);
            -(jacobian * spread).select_rows(numbers).trace()
        })
    }

    fn read(&self, all: &DVector<f64>) -> Vector4<f64> {
        Vector4::from(self.four().map(|variable| all[variable]))
    }
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> Differentiable for Modal<H, N, M> {
    fn rates(&self, state: &ModalState<H, N, M>) -> Vector4<f64> {
        self.read(&DifferentiableList::rates(self, state, &[state.places[0].held]))
    }

    /// Of a motion of any kind: a ride and a hold are motions of the same type as a flight.
    fn flight_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        let carried = DifferentiableList::carried(self, from, false);
        self.folded(self.flow_in_parts(from, &carried, h, FINE))
    }

    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        self.flight_tangent(from, h)
    }

    fn impact_matrix(&self, states: [&Self::State; 2]) -> Matrix4<f64> {
        let flying: &[bool] = &[false];
        self.folded(self.impact_map(&[0], states, [flying; 2]))
    }

    fn stick_matrix(&self, stuck: &Self::State) -> Matrix4<f64> {
        self.folded(self.stick_map(stuck, &[true]))
    }

    fn slip_matrix(&self, sliding: &Self::State) -> Matrix4<f64> {
        self.folded(slip(self, sliding, &[true]))
    }
}
