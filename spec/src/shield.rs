//! Chapter `shield`: the guard. See `spec/shield.md`. Millimetres, mm/s, mm/s², ms.

/// The model's numbers.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Acceleration bound A, mm/s².
    pub acceleration: f64,
    /// Braking bound b, mm/s².
    pub braking: f64,
    /// Reaction time ε, ms.
    pub reaction_time: f64,
    /// Obstacle speed bound V, mm/s.
    pub obstacle_speed: f64,
}

impl Model {
    /// SH.2: v²/2b + V·v/b.
    #[must_use]
    pub fn stopping_distance(&self, speed: f64) -> f64 {
        speed * speed / (2.0 * self.braking) + self.obstacle_speed * speed / self.braking
    }

    /// SH.3, in the form of Mitsch et al. 2017, Theorem 2:
    /// v²/2b + V·v/b + (A/b + 1)(A·ε²/2 + ε(v + V)).
    #[must_use]
    pub fn required_clearance(&self, speed: f64) -> f64 {
        let e = self.reaction_time / 1000.0;
        self.stopping_distance(speed)
            + (self.acceleration / self.braking + 1.0)
                * (self.acceleration * e * e / 2.0 + e * (speed + self.obstacle_speed))
    }
}

// --------------------------------------------------------------- invariants

/// shield.INV-1: a command keeps the limits and never goes backward.
#[must_use]
pub fn within_limits(speed: i32, turn_rate: i32, speed_max: i32, turn_rate_max: i32) -> bool {
    (0..=speed_max).contains(&speed) && (-turn_rate_max..=turn_rate_max).contains(&turn_rate)
}

/// shield.INV-2: what the integer code asks for is never less than the exact formula of SH.3, both
/// multiplied by 2b·10⁶ so that nothing is rounded. Speed in mm/s.
#[must_use]
pub fn asks_enough(
    required: i32,
    speed: i32,
    acceleration: i32,
    braking: i32,
    reaction_time: i32,
    obstacle_speed: i32,
) -> bool {
    let [v, a, b, e, o] =
        [speed, acceleration, braking, reaction_time, obstacle_speed].map(i64::from);
    let exact = 1_000_000 * (v * v + 2 * o * v) + (a + b) * (a * e * e + 2000 * e * (v + o));
    i64::from(required) * 2 * b * 1_000_000 >= exact
}

/// SH.1, the safe state, exactly: braking now ends before contact, v²/2b + V·v/b ≤ d.
#[must_use]
pub fn safe_state(speed: i32, clearance: i32, braking: i32, obstacle_speed: i32) -> bool {
    let [v, d, b, o] = [speed, clearance, braking, obstacle_speed].map(i64::from);
    v * v + 2 * o * v <= 2 * b * d
}

/// shield.INV-3: a safe state stays safe through a step.
#[must_use]
pub fn stays_safe(before: bool, after: bool) -> bool {
    !before || after
}

/// shield.INV-4: a robot that is made to stop gets no forward speed.
#[must_use]
pub fn stop_has_no_speed(stopped: bool, speed: i32) -> bool {
    !stopped || speed == 0
}

/// shield.INV-5: an observation that cannot be trusted yields no motion at all.
#[must_use]
pub fn untrusted_rests(speed: i32, turn_rate: i32) -> bool {
    speed == 0 && turn_rate == 0
}

/// shield.INV-6: the command gains on the one before by no more than the base accelerates.
#[must_use]
pub fn slew_kept(before: i32, after: i32, acceleration: i32, elapsed_ms: i32) -> bool {
    i64::from(after) <= i64::from(before) + i64::from(acceleration) * i64::from(elapsed_ms) / 1000
}

/// shield.INV-7: the stop set is monotone: what stops at (d, v) stops nearer and faster.
#[must_use]
pub fn monotone(stops: bool, stops_nearer_or_faster: bool) -> bool {
    !stops || stops_nearer_or_faster
}

/// shield.INV-8: if contact is possible at a time within T, the guard stops. Distances in mm,
/// closing speed in mm/s, times in ms: in `time` the gap can shrink by closing·time.
#[must_use]
pub fn sound(distance: i32, closing: i32, time: i32, stops: bool) -> bool {
    let possible = i64::from(distance) * 1000 <= i64::from(closing) * i64::from(time);
    !possible || stops
}

/// shield.INV-9: a robot that moves has the clearance that its command needs, at every sonar.
#[must_use]
pub fn admitted(speed: i32, required: i32, clearance: i32) -> bool {
    speed == 0 || required <= clearance
}

/// shield.INV-11: a command that moves the robot was judged at no less than itself, and at no less
/// than what the robot may be at, less one speed gain.
#[must_use]
pub fn judged_at_what_it_may_be(
    speed: i32,
    judged_at: i32,
    speed_bound: i32,
    speed_gain: i32,
) -> bool {
    speed == 0 || (judged_at >= speed && speed_bound <= judged_at + speed_gain)
}

/// shield.INV-10: the search finds the greatest speed there is up to `wish` and `threshold`.
#[must_use]
pub fn greatest(found: i32, wish: i32, threshold: i32) -> bool {
    found == wish.min(threshold)
}

/// shield.INV-6, for turning: the magnitude grows by no more than the base can gain.
#[must_use]
pub fn turn_slew_kept(before: i32, after: i32, acceleration: i32, elapsed_ms: i32) -> bool {
    let step = i64::from(acceleration) * i64::from(elapsed_ms) / 1000;
    let (before, after) = (i64::from(before), i64::from(after));
    (before.min(0) - step..=before.max(0) + step).contains(&after)
}

/// shield.INV-12: a turn ends before contact, V(ε + |ω|/α) ≤ d, multiplied by 1000·α; d is the
/// clearance less the robot's own way to rest.
#[must_use]
pub fn turn_ends_before_contact(
    turn_rate: i32,
    acceleration: i32,
    reaction_time: i32,
    obstacle_speed: i32,
    clearance: i32,
) -> bool {
    let [w, a, e, v, d] = [
        turn_rate,
        acceleration,
        reaction_time,
        obstacle_speed,
        clearance,
    ]
    .map(i64::from);
    w == 0 || v * (a * e + 1000 * w.abs()) <= 1000 * a * d
}
