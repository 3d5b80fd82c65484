//! Chapter `view`: judging and remembering. See `spec/view.md`.

/// view.INV-1: what is not a usable range is never an echo nor "no echo".
#[must_use]
pub fn unusable_is_refused(range: f32, age_ok: bool, usable: bool) -> bool {
    !usable || (range.is_finite() && range > 0.0 && age_ok)
}

/// view.INV-2: a nearer echo counts at once.
#[must_use]
pub fn nearer_counts(believed: i32, measured: i32) -> bool {
    believed <= measured
}

/// view.INV-3: one reading without an echo, or with a farther one, frees no more of a place than
/// motion within the promise and scatter explain (mm).
#[must_use]
pub fn not_freed_at_once(believed_before: i32, believed_after: i32, explained: i32) -> bool {
    believed_after <= believed_before + explained
}

/// view.INV-4: what is believed is made of numbers.
#[must_use]
pub fn judged(speed: f32, goal_distance: f32, obstacle_distance: Option<f32>) -> bool {
    speed.is_finite()
        && goal_distance >= 0.0
        && goal_distance.is_finite()
        && obstacle_distance.is_none_or(|distance| distance >= 0.0 && distance.is_finite())
}

/// view.INV-5: what may be reached by now is never farther than what was measured.
#[must_use]
pub fn reachable_is_nearer(range: i32, reachable: i32) -> bool {
    reachable <= range
}
