//! The cells of a row: what stands in one column of one row, and the macros that make them from the entries of
//! [`crate::columns`].

use std::borrow::Cow;

/// One value of a row.
#[derive(Debug, Clone)]
pub enum Cell<R = f64> {
    /// The number of a point.
    Point(u32),
    /// A number, in the user's unit.
    Number(R),
    /// A whole number.
    Count(u64),
    /// +1, −1 or 0: a wall, or none.
    Side(i8),
    /// A text.
    Text(Cow<'static, str>),
    /// A truth value.
    Flag(bool),
    /// Nothing.
    Null,
}

/// A text for a cell: constant, or made by a run and possibly missing.
pub(crate) trait Word {
    fn word(self) -> Option<Cow<'static, str>>;
}

impl Word for &'static str {
    fn word(self) -> Option<Cow<'static, str>> {
        Some(self.into())
    }
}

impl Word for Option<String> {
    fn word(self) -> Option<Cow<'static, str>> {
        self.map(Cow::from)
    }
}

/// A whole number for a cell, possibly missing.
pub(crate) trait Counted {
    fn counted(self) -> Option<u64>;
}

impl Counted for u64 {
    fn counted(self) -> Option<u64> {
        Some(self)
    }
}

impl Counted for usize {
    fn counted(self) -> Option<u64> {
        self.try_into().ok()
    }
}

impl Counted for Option<u64> {
    fn counted(self) -> Option<u64> {
        self
    }
}

/// Cells from values that may be missing.
impl<R> Cell<R> {
    /// The number of a point, which [`Study::points`] ensures to be below 2³².
    pub(crate) fn point(point: u64) -> Self {
        Self::Point(point as u32)
    }

    pub(crate) fn number(value: impl Into<Option<R>>, scaled: impl Fn(R) -> R) -> Self {
        value.into().map_or(Self::Null, |value| Self::Number(scaled(value)))
    }

    pub(crate) fn count(value: impl Counted) -> Self {
        value.counted().map_or(Self::Null, Self::Count)
    }

    pub(crate) fn side(value: impl Into<Option<i8>>) -> Self {
        value.into().map_or(Self::Null, Self::Side)
    }

    pub(crate) fn flag(value: impl Into<Option<bool>>) -> Self {
        value.into().map_or(Self::Null, Self::Flag)
    }

    pub(crate) fn text(value: impl Word) -> Self {
        value.word().map_or(Self::Null, Self::Text)
    }
}

/// The cell of a quantity, from a value in natural units that may be missing.
macro_rules! cell {
    (Text, $scale:expr, $value:expr) => {
        $crate::cells::Cell::text($value)
    };
    (Flag, $scale:expr, $value:expr) => {
        $crate::cells::Cell::flag($value)
    };
    (Count, $scale:expr, $value:expr) => {
        $crate::cells::Cell::count($value)
    };
    (Side, $scale:expr, $value:expr) => {
        $crate::cells::Cell::side($value)
    };
    (Time, $scale:expr, $value:expr) => {
        $crate::cells::Cell::number($value, |it| $scale.time(it))
    };
    (Velocity, $scale:expr, $value:expr) => {
        $crate::cells::Cell::number($value, |it| $scale.velocity(it))
    };
    (AngularVelocity, $scale:expr, $value:expr) => {
        $crate::cells::Cell::number($value, |it| $scale.angular_velocity(it))
    };
    (Energy, $scale:expr, $value:expr) => {
        $crate::cells::Cell::number($value, |it| $scale.energy(it))
    };
    // Lengths are in the user's unit already, and gravity is as given.
    ($quantity:ident, $scale:expr, $value:expr) => {
        $crate::cells::Cell::number($value, |it| it)
    };
}

/// The functions that compute the cells of a row, one for each entry of a table.
macro_rules! cells {
    ($($name:literal $quantity:ident $([$($group:ident)*])? $(|$row:ident| $value:expr)? $(=> $pass:ident)?, $help:literal;)*) => {
        [$(
            $(|$row| $crate::cells::cell!($quantity, $row.scale, $value))?
            $($crate::cells::named!($pass, $name, $quantity))?
        ),*]
    };
}

/// The function that computes the cell of a measure with a pass of its own.
macro_rules! named {
    ($pass:ident, $name:literal, $quantity:ident) => {
        |run| $crate::cells::cell!($quantity, run.scale, run.named($name))
    };
}

/// What makes the passes of a table, one for each entry that has one.
macro_rules! passes {
    ($($name:literal $quantity:ident $([$($group:ident)*])? $(|$row:ident| $value:expr)? $(=> $pass:ident)?, $help:literal;)*) => {
        [$($(($name, || Box::new($pass::default())),)?)*]
    };
}
pub(crate) use {cell, cells, named, passes};
