//! The few transcendental functions the laws need, each with a contract.
//!
//! A bit-precise solver cannot see through `libm`, so proofs replace each function here by
//! exactly the contract written above it. `cargo run --release --example math_exhaustive`
//! checks the contracts of the functions of one variable over all 2³² inputs.

/// Sine of a finite angle in radians, |angle| ≤ 3π.
///
/// Contract `math.INV-1`: the result is in [−1, 1] for every input; where the angle is not
/// finite the result is 0.
//= math.INV-1
#[must_use]
pub fn sin(angle: f32) -> f32 {
    if angle.is_finite() {
        libm::sinf(angle)
    } else {
        0.0
    }
}

/// Cosine of a finite angle in radians.
///
/// Contract `math.INV-2`: the result is in [−1, 1] for every input, and at least ½ less one part
/// in 10⁶ for |angle| ≤ π/3; where the angle is not finite the result is 0.
//= math.INV-2
#[must_use]
pub fn cos(angle: f32) -> f32 {
    if angle.is_finite() {
        libm::cosf(angle)
    } else {
        0.0
    }
}

/// Square root.
///
/// Contract `math.INV-3`: for x in [0, f32::MAX] the result r is finite, 0 ≤ r, r ≤ max(1, x) and
/// r ≥ min(1, x); for every other x, NaN too, it is 0.
//= math.INV-3
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    if x > 0.0 && x.is_finite() {
        libm::sqrtf(x)
    } else {
        0.0
    }
}

/// Direction of the point (x, y) in radians.
///
/// Contract `math.INV-4`: the result is in [−π, π] for finite x and y; for every other input it
/// is 0.
//= math.INV-4
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    if y.is_finite() && x.is_finite() {
        libm::atan2f(y, x)
    } else {
        0.0
    }
}

/// Natural logarithm.
///
/// Contract `math.INV-5`: for finite x ≥ 1 the result is in [0, x − 1]; for every other x, NaN too,
/// it is 0.
//= math.INV-5
#[must_use]
pub fn ln(x: f32) -> f32 {
    if x >= 1.0 && x.is_finite() {
        libm::logf(x)
    } else {
        0.0
    }
}

/// Length of a vector.
#[must_use]
pub fn norm(vector: nalgebra::Vector2<f32>) -> f32 {
    sqrt(vector.dot(&vector))
}
