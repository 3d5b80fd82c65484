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
/// motion within the promise and scatter explain (mm), unless another sonar hears what was there.
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

/// view.INV-5: what happens after a thing was seen is never forgotten: its age and the robot's own
/// way and turn are at least what they are.
#[must_use]
pub fn nothing_forgotten(believed: [i64; 4], actual: [i64; 4]) -> bool {
    let mut i = 0;
    while i < 4 {
        if believed[i] < actual[i] {
            return false;
        }
        i += 1;
    }
    true
}

/// view.INV-6: a thing counts as still only after that many readings in a row that agreed with the
/// robot's own motion, the last of them recent.
#[must_use]
pub fn still_is_earned(still: bool, readings: u32, needed: u32, age: u64, age_max: u64) -> bool {
    !still || (readings > needed && age <= age_max)
}

/// view.INV-7: not to hear what is held makes it no less of a hazard: nearer or as near, older or
/// as old, and no more trusted.
#[must_use]
pub fn losing_sight_frees_nothing(clearance: [i32; 2], age: [i32; 2], unknown: [bool; 2]) -> bool {
    clearance[1] <= clearance[0] && age[1] >= age[0] && (unknown[1] || !unknown[0])
}

/// view.INV-4, for what a sonar's memory makes of a look: ranges and clearances (mm), age and ways, and
/// the turn (mrad) are within what the shield reckons with.
#[must_use]
pub fn within_reckoning(ranges: [i32; 2], since: [i32; 3], turned: i32) -> bool {
    (0..=20_000).contains(&ranges[0])
        && (-10_000..=20_000).contains(&ranges[1])
        && since.iter().all(|value| (0..=10_000).contains(value))
        && (0..=40_000).contains(&turned)
}
