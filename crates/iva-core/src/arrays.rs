//! A macro for structs of numbers and structs of arrays over lanes.

/// Declares a struct of numbers for one lane, and a struct with an array over the lanes for each of its
/// fields. A part is a field that is itself a struct declared by this macro.
macro_rules! arrays {
    (
        $(#[$doc:meta])* $one:ident, $(#[$many_doc:meta])* $many:ident:
        $($(#[$field_doc:meta])* $field:ident),* $(,)?
        $(; $($(#[$part_doc:meta])* $part:ident: $part_one:ident, $part_many:ident),*)?
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default)]
        pub(crate) struct $one {
            $($(#[$field_doc])* pub $field: f64,)*
            $($($(#[$part_doc])* pub $part: $part_one,)*)?
        }

        impl $one {
            /// `self` if `which`, else `other`.
            #[allow(dead_code)]
            #[inline(always)]
            pub fn if_else(&self, which: bool, other: &Self) -> Self {
                Self {
                    $($field: $crate::real::pick(which, self.$field, other.$field),)*
                    $($($part: self.$part.if_else(which, &other.$part),)*)?
                }
            }
        }

        $(#[$many_doc])*
        #[derive(Debug)]
        #[repr(align(64))]
        pub(crate) struct $many<const W: usize> {
            $(pub $field: [f64; W],)*
            $($(pub $part: $part_many<W>,)*)?
        }

        impl<const W: usize> $many<W> {
            pub const fn new() -> Self {
                Self { $($field: [0.0; W],)* $($($part: $part_many::new(),)*)? }
            }

            #[allow(dead_code)]
            #[inline(always)]
            pub fn get(&self, i: usize) -> $one {
                $one { $($field: self.$field[i],)* $($($part: self.$part.get(i),)*)? }
            }

            #[allow(dead_code)]
            #[inline(always)]
            pub fn set(&mut self, i: usize, one: &$one) {
                $(self.$field[i] = one.$field;)*
                $($(self.$part.set(i, &one.$part);)*)?
            }
        }
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
