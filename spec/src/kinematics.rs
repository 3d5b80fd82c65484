//! Chapter `kinematics`: S2.E1 to E5. See `spec/kinematics.md`.

/// S2.E1 to E3: (ẋ, ẏ, θ̇) from speed, heading (degrees) and turn rate.
#[must_use]
pub fn e1_e3(speed: f64, heading_deg: f64, turn_rate: f64) -> (f64, f64, f64) {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    (speed * cos, speed * sin, turn_rate)
}

/// S2.E5: v_R = R(ω_r + ω_l)/2.
#[must_use]
pub fn e5(wheel_radius: f64, right: f64, left: f64) -> f64 {
    wheel_radius * (right + left) / 2.0
}

/// The yaw relation that the paper leaves out: ω_R = R(ω_r − ω_l)/L.
#[must_use]
pub fn yaw(wheel_radius: f64, wheel_base: f64, right: f64, left: f64) -> f64 {
    wheel_radius * (right - left) / wheel_base
}

/// kinematics.INV-1: going to wheel rates and back changes a motion by no more than rounding.
#[must_use]
pub fn round_trip(before: f32, after: f32, scale: f32) -> bool {
    (before - after).abs() <= 1e-5 * (1.0 + scale)
}

/// kinematics.INV-2: swapping the wheels mirrors the turn and leaves the speed.
#[must_use]
pub fn swap_mirrors(speed: f32, turn: f32, swapped_speed: f32, swapped_turn: f32) -> bool {
    speed == swapped_speed && turn == -swapped_turn
}

/// kinematics.INV-3: no limited wheel is faster than the limit.
#[must_use]
pub fn wheels_within(right: f32, left: f32, limit: f32) -> bool {
    right.abs() <= limit && left.abs() <= limit
}

/// kinematics.INV-4: limiting keeps each wheel's direction and never makes it faster.
#[must_use]
pub fn limited_keeps_direction(before: f32, after: f32) -> bool {
    after.abs() <= before.abs() && (after == 0.0 || (after > 0.0) == (before > 0.0))
}

/// kinematics.INV-5: what comes out is finite.
#[must_use]
pub fn finite(first: f32, second: f32) -> bool {
    first.is_finite() && second.is_finite()
}
