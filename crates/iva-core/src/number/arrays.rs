//! Values of many runs side by side: structs of arrays over the lanes.
//!
//! [`Laned`] says how a type is held over W lanes: a number as an array, a mark as an array of ones and zeros, which
//! vector instructions select by, a struct as a struct of such arrays ([`laned!`]). So what is written for one run
//! can be done for all lanes in a loop.

use std::fmt::Debug;

use crate::number::real::pick;

/// A value that can be held over lanes.
pub(crate) trait Laned: Copy + Debug {
    /// The values of W lanes.
    type Lanes<const W: usize>: Lanes<Self>;
    /// `yes` if `which`, else `no`, without a branch.
    fn pick(which: bool, yes: &Self, no: &Self) -> Self;
}

/// The values of all lanes.
pub(crate) trait Lanes<T>: Debug {
    fn new() -> Self;
    fn get(&self, i: usize) -> T;
    fn set(&mut self, i: usize, one: &T);
}

impl Laned for f64 {
    type Lanes<const W: usize> = [f64; W];

    #[inline(always)]
    fn pick(which: bool, yes: &f64, no: &f64) -> f64 {
        pick(which, *yes, *no)
    }
}

impl<const W: usize> Lanes<f64> for [f64; W] {
    fn new() -> Self {
        [0.0; W]
    }

    #[inline(always)]
    fn get(&self, i: usize) -> f64 {
        self[i]
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: &f64) {
        self[i] = *one;
    }
}

impl Laned for bool {
    type Lanes<const W: usize> = [f64; W];

    #[inline(always)]
    fn pick(which: bool, yes: &bool, no: &bool) -> bool {
        (which & *yes) | (!which & *no)
    }
}

impl<const W: usize> Lanes<bool> for [f64; W] {
    fn new() -> Self {
        [0.0; W]
    }

    #[inline(always)]
    fn get(&self, i: usize) -> bool {
        self[i] > 0.0
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: &bool) {
        self[i] = pick(*one, 1.0, 0.0);
    }
}

impl<T: Laned, const N: usize> Laned for [T; N] {
    type Lanes<const W: usize> = Several<T, N, W>;

    #[inline(always)]
    fn pick(which: bool, yes: &[T; N], no: &[T; N]) -> [T; N] {
        let mut picked = *no;
        for (n, picked) in picked.iter_mut().enumerate() {
            *picked = T::pick(which, &yes[n], &no[n]);
        }
        picked
    }
}

/// N values over lanes.
#[derive(Debug)]
pub(crate) struct Several<T: Laned, const N: usize, const W: usize>(pub [T::Lanes<W>; N]);

impl<T: Laned, const N: usize, const W: usize> Lanes<[T; N]> for Several<T, N, W> {
    fn new() -> Self {
        Self(std::array::from_fn(|_| Lanes::new()))
    }

    #[inline(always)]
    fn get(&self, i: usize) -> [T; N] {
        // Not by `from_fn`, of which a call may be left that keeps a loop over lanes from becoming vectors.
        let mut one = [self.0[0].get(i); N];
        for (one, lanes) in one.iter_mut().zip(&self.0) {
            *one = lanes.get(i);
        }
        one
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: &[T; N]) {
        for (lanes, one) in self.0.iter_mut().zip(one) {
            lanes.set(i, one);
        }
    }
}

impl Laned for () {
    type Lanes<const W: usize> = ();

    #[inline(always)]
    fn pick(_which: bool, _yes: &(), _no: &()) {}
}

impl Lanes<()> for () {
    fn new() {}

    #[inline(always)]
    fn get(&self, _i: usize) {}

    #[inline(always)]
    fn set(&mut self, _i: usize, _one: &()) {}
}

/// Declares how a struct is held over lanes: a struct of the lanes of its fields. A field with a value is the same
/// in all lanes.
macro_rules! laned {
    (
        $one:ident $(<$part:ident>)?,
        $many:ident { $($field:ident: $type:ty),* $(,)? } $($fixed:ident = $value:expr),*
    ) => {
        #[doc = concat!("[`", stringify!($one), "`] over lanes.")]
        #[derive(Debug)]
        #[repr(align(64))]
        pub(crate) struct $many<$($part: $crate::number::arrays::Laned,)? const W: usize> {
            $(pub $field: <$type as $crate::number::arrays::Laned>::Lanes<W>,)*
        }

        impl<$($part: $crate::number::arrays::Laned,)? const W: usize>
            $crate::number::arrays::Lanes<$one $(<$part>)?> for $many<$($part,)? W>
        {
            fn new() -> Self {
                Self { $($field: $crate::number::arrays::Lanes::<$type>::new(),)* }
            }

            #[inline(always)]
            fn get(&self, i: usize) -> $one $(<$part>)? {
                $one {
                    $($field: $crate::number::arrays::Lanes::<$type>::get(&self.$field, i),)*
                    $($fixed: $value,)*
                }
            }

            #[inline(always)]
            fn set(&mut self, i: usize, one: &$one $(<$part>)?) {
                $($crate::number::arrays::Lanes::<$type>::set(&mut self.$field, i, &one.$field);)*
            }
        }

        impl $(<$part: $crate::number::arrays::Laned>)? $crate::number::arrays::Laned
            for $one $(<$part>)?
        {
            type Lanes<const W: usize> = $many<$($part,)? W>;

            #[inline(always)]
            fn pick(which: bool, yes: &Self, no: &Self) -> Self {
                Self {
                    $($field: $crate::number::arrays::Laned::pick(which, &yes.$field, &no.$field),)*
                    $($fixed: $value,)*
                }
            }
        }
    };
}
pub(crate) use laned;

/// Declares a struct of numbers, and of other values that can be held over lanes, and how it is held over lanes.
macro_rules! arrays {
    (
        $(#[$doc:meta])* $one:ident, $many:ident:
        $($(#[$field_doc:meta])* $field:ident),* $(,)?
        $(; $($(#[$part_doc:meta])* $part:ident: $type:ty),* $(,)?)?
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default)]
        pub(crate) struct $one {
            $($(#[$field_doc])* pub $field: f64,)*
            $($($(#[$part_doc])* pub $part: $type,)*)?
        }

        $crate::number::arrays::laned!($one, $many { $($field: f64,)* $($($part: $type,)*)? });
    };
}
pub(crate) use arrays;

/// True if a mark is set in any lane: a number other than 0.
#[inline(always)]
pub(crate) fn any<const W: usize>(marks: &[f64; W]) -> bool {
    // Bits are combined in any order, which a sum of doubles is not.
    marks.iter().fold(0, |bits, mark| bits | mark.to_bits()) != 0
}

/// The largest of some sizes, of which those that are not positive do not count.
#[inline(always)]
pub(crate) fn largest<const W: usize>(sizes: &[f64; W]) -> f64 {
    // The bits of positive numbers are in order; their largest is found in any order, which that of doubles is not.
    let bits = sizes.iter().map(|size| if *size > 0.0 { size.to_bits() } else { 0 });
    f64::from_bits(bits.fold(0, u64::max))
}
