//! The contracts of `sidestep::math`. See `spec/math.md`. Exactly these stand in for the
//! functions in proofs, and exactly these are checked over every input.

/// math.INV-1: sine.
#[must_use]
pub fn sin(result: f32) -> bool {
    (-1.0..=1.0).contains(&result)
}

/// math.INV-2: cosine.
#[must_use]
pub fn cos(angle: f32, result: f32) -> bool {
    (-1.0..=1.0).contains(&result)
        && (angle.is_nan() || angle.abs() > std::f32::consts::FRAC_PI_3 || result >= 0.5 - 1e-6)
}

/// math.INV-3: square root.
#[must_use]
pub fn sqrt(x: f32, result: f32) -> bool {
    if x > 0.0 && x.is_finite() {
        result <= x.max(1.0) && result >= x.min(1.0)
    } else {
        result == 0.0
    }
}

/// math.INV-4: direction of a point.
#[must_use]
pub fn atan2(result: f32) -> bool {
    (-std::f32::consts::PI..=std::f32::consts::PI).contains(&result)
}

/// math.INV-5: natural logarithm.
#[must_use]
pub fn ln(x: f32, result: f32) -> bool {
    if x >= 1.0 && x.is_finite() {
        result >= 0.0 && result <= x - 1.0
    } else {
        result == 0.0
    }
}
