//! Quantities that exist only when they are valid.
//!
//! A value of one of these types has been checked once, where it entered: it is finite and
//! inside its range. Code that holds one need not ask again. Everything is SI (metre, second,
//! radian); centimetres, degrees and protocol units are converted where they come in.

use core::f32::consts::{PI, TAU};
use core::fmt;

/// A value that was refused, with what would have been allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Name of the quantity or configuration field.
    pub field: &'static str,
    /// The value given; may be NaN or infinite.
    pub value: f32,
    /// Least allowed value.
    pub min: f32,
    /// Greatest allowed value.
    pub max: f32,
    /// Unit of the three numbers.
    pub unit: &'static str,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} is {} {unit}, allowed is {} {unit} to {} {unit}",
            self.field,
            self.value,
            self.min,
            self.max,
            unit = self.unit
        )
    }
}

impl core::error::Error for OutOfRange {}

/// Accepts `value` if it is finite and in `[min, max]`.
///
/// # Errors
/// [`OutOfRange`] naming the field, the value and the range; NaN is always out of range.
pub const fn in_range(
    field: &'static str,
    value: f32,
    min: f32,
    max: f32,
    unit: &'static str,
) -> Result<f32, OutOfRange> {
    // A comparison with NaN is false, so NaN cannot pass.
    if value >= min && value <= max {
        Ok(value)
    } else {
        Err(OutOfRange {
            field,
            value,
            min,
            max,
            unit,
        })
    }
}

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $constructor:ident, $field:literal, $unit:literal, $min:expr, $max:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
        pub struct $name(f32);

        impl $name {
            /// Zero.
            pub const ZERO: Self = Self(0.0);
            /// The greatest value this quantity can have.
            pub const MAX: Self = Self($max);

            /// Checks a bare number.
            ///
            /// # Errors
            /// [`OutOfRange`] if the number is not finite or outside the range of the type.
            pub fn $constructor(value: f32) -> Result<Self, OutOfRange> {
                in_range($field, value, $min, $max, $unit).map(Self)
            }

            /// The bare number, in the unit of the type.
            #[must_use]
            pub const fn get(self) -> f32 {
                self.0
            }

            /// The smaller of two.
            #[must_use]
            pub fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
        }
    };
}

quantity!(
    /// A distance in metres, 0 to 1000.
    Length,
    metres,
    "length",
    "m",
    0.0,
    1000.0
);
quantity!(
    /// A speed (magnitude) in metres per second, 0 to 10.
    Speed,
    metres_per_second,
    "speed",
    "m/s",
    0.0,
    10.0
);

impl Speed {
    /// This speed times a factor in `[0, 1]`; any other factor, NaN too, gives zero.
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        if (0.0..=1.0).contains(&factor) {
            Self(self.0 * factor)
        } else {
            Self::ZERO
        }
    }
}

/// A direction in radians, wrapped to (−π, π]; counter-clockwise is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle(f32);

impl Angle {
    /// Straight ahead, or along the x axis.
    pub const ZERO: Self = Self(0.0);
    /// Straight back.
    pub const HALF_TURN: Self = Self(PI);

    /// Checks and wraps a bare number of radians in [−3π, 3π], which is what a sum of any two
    /// directions, or a compass in any convention, can give.
    ///
    /// # Errors
    /// [`OutOfRange`] if the number is not finite or farther than one and a half turns from 0.
    pub fn radians(value: f32) -> Result<Self, OutOfRange> {
        in_range("angle", value, -3.0 * PI, 3.0 * PI, "rad").map(|value| Self(wrap(value)))
    }

    /// The bare number of radians, in (−π, π].
    #[must_use]
    pub const fn get(self) -> f32 {
        self.0
    }

    /// The direction `turn` further counter-clockwise.
    #[must_use]
    pub fn plus(self, turn: Self) -> Self {
        Self(wrap(self.0 + turn.0))
    }

    /// The turn that leads from `from` to this direction, the short way round.
    #[must_use]
    pub fn minus(self, from: Self) -> Self {
        Self(wrap(self.0 - from.0))
    }

    /// The mirror image: the same turn the other way.
    #[must_use]
    pub fn mirrored(self) -> Self {
        // −π is not in the range, π is: half a turn is its own mirror image.
        Self(if self.0 == PI { PI } else { -self.0 })
    }
}

/// `value`, cut off at ±`limit`. Unlike `clamp` it cannot panic, whatever the limit; what is no number
/// stays so.
pub(crate) const fn within(value: f32, limit: f32) -> f32 {
    let mut cut = value;
    if cut < -limit {
        cut = -limit;
    }
    if cut > limit {
        cut = limit;
    }
    cut
}

/// Wraps `angle` (finite, in [−3π, 3π]) to (−π, π].
fn wrap(angle: f32) -> f32 {
    let wrapped = if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    };
    // The last bit of the subtraction can land just outside.
    if wrapped > PI || wrapped <= -PI {
        PI
    } else {
        wrapped
    }
}

/// A point in time, in milliseconds of a clock that never goes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Instant(pub u64);

impl Instant {
    /// Milliseconds since `earlier`, or `None` if `earlier` is later than this.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Option<u64> {
        self.0.checked_sub(earlier.0)
    }
}
