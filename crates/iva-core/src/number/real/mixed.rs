//! Mixed arithmetic of a number type with doubles, as in `0.5 * x`.

/// Implements arithmetic and comparisons of a `Copy` type with doubles by those of the type.
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
