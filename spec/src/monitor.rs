//! Chapter `monitor`: is the base the one that the theorem is about? See `spec/monitor.md`.

/// monitor.INV-1: the bound is never below what the base was told last.
#[must_use]
pub fn allows_what_was_told(bound: i32, told: i32) -> bool {
    bound >= told
}

/// monitor.INV-2: once told to rest, a base that keeps its promise is at rest after the reaction
/// time and braking, and the bound is down to the gain and the error of measuring by then.
#[must_use]
pub fn falls_to_rest(bound: i32, gain: i32, speed_error: i32) -> bool {
    bound <= gain + speed_error
}

/// monitor.INV-3: three measurements in a row above the bound, and no fewer, are an accusation.
#[must_use]
pub fn accuses(above_in_a_row: u32, accused: bool) -> bool {
    accused == (above_in_a_row >= 3)
}
