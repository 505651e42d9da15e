//! Lets a kind of number stand beside doubles in a formula, as in `0.5 * x`.

/// Arithmetic and comparisons of a `Copy` type with doubles, from those with itself.
macro_rules! beside_doubles {
    ($number:ty $(, $size:ident)?) => {
        beside_doubles!(@operator $number, Add add AddAssign add_assign $(, $size)?);
        beside_doubles!(@operator $number, Sub sub SubAssign sub_assign $(, $size)?);
        beside_doubles!(@operator $number, Mul mul MulAssign mul_assign $(, $size)?);
        beside_doubles!(@operator $number, Div div DivAssign div_assign $(, $size)?);

        impl$(<const $size: usize>)? PartialEq<f64> for $number {
            fn eq(&self, other: &f64) -> bool {
                *self == Self::from(*other)
            }
        }
        impl$(<const $size: usize>)? PartialEq<$number> for f64 {
            fn eq(&self, other: &$number) -> bool {
                <$number>::from(*self) == *other
            }
        }
        impl$(<const $size: usize>)? PartialOrd<f64> for $number {
            fn partial_cmp(&self, other: &f64) -> Option<std::cmp::Ordering> {
                self.partial_cmp(&Self::from(*other))
            }
        }
        impl$(<const $size: usize>)? PartialOrd<$number> for f64 {
            fn partial_cmp(&self, other: &$number) -> Option<std::cmp::Ordering> {
                <$number>::from(*self).partial_cmp(other)
            }
        }
        impl$(<const $size: usize>)? std::iter::Sum for $number {
            fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
                numbers.fold(Self::from(0.0), |sum, number| sum + number)
            }
        }
        impl$(<const $size: usize>)? std::iter::Product for $number {
            fn product<I: Iterator<Item = Self>>(numbers: I) -> Self {
                numbers.fold(Self::from(1.0), |product, number| product * number)
            }
        }

        impl$(<const $size: usize>)? $number {
            /// As [`f64::abs`].
            pub fn abs(self) -> Self {
                if self < 0.0 { -self } else { self }
            }
            /// As [`f64::signum`]: ±1.
            pub fn signum(self) -> Self {
                Self::from(f64::from(self).signum())
            }
            /// As [`f64::copysign`].
            pub fn copysign(self, sign: Self) -> Self {
                self.abs() * sign.signum()
            }
            /// As [`f64::max`].
            pub fn max(self, other: impl Into<Self>) -> Self {
                let other = other.into();
                if other > self || self.is_nan() { other } else { self }
            }
            /// As [`f64::min`].
            pub fn min(self, other: impl Into<Self>) -> Self {
                let other = other.into();
                if other < self || self.is_nan() { other } else { self }
            }
            /// As [`f64::clamp`].
            pub fn clamp(self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
                self.max(low).min(high)
            }
            /// As [`f64::midpoint`].
            pub fn midpoint(self, other: Self) -> Self {
                0.5 * (self + other)
            }
            /// As [`f64::is_finite`].
            pub fn is_finite(self) -> bool {
                f64::from(self).is_finite()
            }
            /// As [`f64::is_nan`].
            pub fn is_nan(self) -> bool {
                f64::from(self).is_nan()
            }
            /// As [`f64::round`]; exact where the result is no larger than 2⁵³.
            pub fn round(self) -> Self {
                Self::from(f64::from(self).round())
            }
            /// As [`f64::ceil`]; exact where the result is no larger than 2⁵³.
            pub fn ceil(self) -> Self {
                let near = self.round();
                if near < self { near + 1.0 } else { near }
            }
            /// As [`f64::total_cmp`].
            pub fn total_cmp(&self, other: &Self) -> std::cmp::Ordering {
                let unordered = f64::from(*self).total_cmp(&f64::from(*other));
                self.partial_cmp(other).unwrap_or(unordered)
            }
        }
    };
    (@operator $number:ty, $operator:ident $method:ident $assign:ident $assign_method:ident $(, $size:ident)?) => {
        impl$(<const $size: usize>)? std::ops::$operator<f64> for $number {
            type Output = Self;
            #[inline]
            fn $method(self, other: f64) -> Self {
                std::ops::$operator::$method(self, Self::from(other))
            }
        }
        impl$(<const $size: usize>)? std::ops::$operator<$number> for f64 {
            type Output = $number;
            #[inline]
            fn $method(self, other: $number) -> $number {
                std::ops::$operator::$method(<$number>::from(self), other)
            }
        }
        impl$(<const $size: usize>)? std::ops::$assign for $number {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = std::ops::$operator::$method(*self, other);
            }
        }
        impl$(<const $size: usize>)? std::ops::$assign<f64> for $number {
            #[inline]
            fn $assign_method(&mut self, other: f64) {
                *self = std::ops::$operator::$method(*self, other);
            }
        }
    };
}

pub(crate) use beside_doubles;
