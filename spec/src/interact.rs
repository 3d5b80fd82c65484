//! Chapter `interact`: invariants of the machine M2 and of the law. See `spec/interact.md`.

/// interact.INV-1: while somebody shows Stop, or no recent picture says that nobody does, nothing is
/// to move, in the same cycle.
#[must_use]
pub fn stop_is_obeyed(demanded: bool, at_rest: bool) -> bool {
    !demanded || at_rest
}

/// interact.INV-2: a path is only driven if it was planned: it is the one that was being driven, or
/// the one that planning has just found.
#[must_use]
pub fn only_planned<P: PartialEq>(
    before: Option<&P>,
    found: Option<&P>,
    after: Option<&P>,
) -> bool {
    after.is_none() || after == before || after == found
}

/// interact.INV-3: the master's switch is a dead man's: it leads no longer than it is shown in the
/// cycle's own picture, forward no nearer to anybody than the limit (m), backward only with sensors
/// that look back.
#[must_use]
pub fn leads_only_while_shown(
    [forward, backward]: [bool; 2],
    [forward_shown, backward_shown]: [bool; 2],
    nearest: f32,
    limit: f32,
    rear_sensing: bool,
) -> bool {
    (!forward || (forward_shown && nearest > limit))
        && (!backward || (backward_shown && rear_sensing))
}

/// interact.INV-4: a state that waits for something is left when its time is over.
#[must_use]
pub fn ends_in_time(waits: bool, overdue: bool, left: bool) -> bool {
    !(waits && overdue) || left
}

/// interact.INV-5: the advice is made of numbers within what robot and settings allow; backward no
/// faster than the base may.
#[must_use]
pub fn advice_in_range(
    speed: f32,
    turn_rate: f32,
    speed_max: f32,
    reverse_speed_max: f32,
    turn_rate_max: f32,
) -> bool {
    (-reverse_speed_max..=speed_max).contains(&speed)
        && (-turn_rate_max..=turn_rate_max).contains(&turn_rate)
}

/// interact.INV-6: left and right are only taken into use if they were found right: the person stood
/// where the camera had them, and the gesture means what the person meant. Sides: true is left.
#[must_use]
pub fn borne_out(seen_left: bool, stood_left: bool, sent_left: bool, meant_left: bool) -> bool {
    seen_left == stood_left && sent_left == meant_left
}

/// interact.INV-7: somebody who is not seen is let go only if their place was looked at for long
/// enough, or if they were not seen for too long (ms).
#[must_use]
pub fn let_go_with_reason(missed: u64, unseen: u64, gone_time: u64, hold_time: u64) -> bool {
    missed >= gone_time || unseen > hold_time
}

/// interact.INV-8: who has arrived stays.
#[must_use]
pub fn arrived_for_good(was_there: bool, is_there: bool) -> bool {
    !was_there || is_there
}
