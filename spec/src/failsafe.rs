//! Chapter `failsafe`: what is done about what goes wrong. See `spec/failsafe.md`. Actions by rank.

/// failsafe.INV-1: joining does not depend on the order.
#[must_use]
pub fn commutative<T: PartialEq>(a_with_b: T, b_with_a: T) -> bool {
    a_with_b == b_with_a
}

/// failsafe.INV-2: joining does not depend on the grouping.
#[must_use]
pub fn associative<T: PartialEq>(left_first: T, right_first: T) -> bool {
    left_first == right_first
}

/// failsafe.INV-3: an action joined with itself is itself.
#[must_use]
pub fn idempotent<T: PartialEq>(joined: T, itself: T) -> bool {
    joined == itself
}

/// failsafe.INV-4: a join is at least as severe as each of its parts, and as the join of milder
/// ones.
#[must_use]
pub fn monotone<T: PartialOrd>(join: T, part: T) -> bool {
    join >= part
}

/// failsafe.INV-5: a latched stop moves nothing until it is reset, and nothing else resets it.
#[must_use]
pub fn latched_rests(was_latched: bool, latched: bool, speed: i32, turn_rate: i32) -> bool {
    !was_latched || (latched && speed == 0 && turn_rate == 0)
}

/// failsafe.INV-6: of several causes one with the most severe action is named, whatever the order.
#[must_use]
pub fn worst_is_named<T: PartialOrd>(named: T, each: T) -> bool {
    named >= each
}

/// failsafe.INV-7: what has been overdue for `latch_time` (ms) without a pause latches the stop of a robot
/// that had everything once, not before.
#[must_use]
pub fn overdue_latches(was_ready: bool, lasted: u64, latch_time: u64, latched: bool) -> bool {
    latched == (was_ready && lasted >= latch_time)
}
