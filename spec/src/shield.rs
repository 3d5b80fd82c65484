//! Chapter `shield`: the guard. See `spec/shield.md`. Millimetres, mm/s, mm/s², ms, mrad/s;
//! cosines in thousandths.

/// The model's numbers.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Acceleration bound A, mm/s².
    pub acceleration: f64,
    /// Braking bound b, mm/s².
    pub braking: f64,
    /// Reaction time ε, ms.
    pub reaction_time: f64,
    /// Greatest speed V of the thing, mm/s.
    pub obstacle_speed: f64,
}

impl Model {
    /// SH.2: the way to rest, v·ε + v²/2b.
    #[must_use]
    pub fn way_to_rest(&self, speed: f64) -> f64 {
        speed * self.reaction_time / 1000.0 + speed * speed / (2.0 * self.braking)
    }

    /// SH.2: the time to rest in ms, ε + v/b.
    #[must_use]
    pub fn time_to_rest(&self, speed: f64) -> f64 {
        self.reaction_time + 1000.0 * speed / self.braking
    }

    /// SH.3 with the cosine κ (0 to 1), the way s since the thing was seen and its age: the
    /// clearance it had to have then. `fastest` is the robot's greatest speed until it brakes.
    #[must_use]
    pub fn needed(&self, fastest: f64, cosine: f64, way: f64, age: f64) -> f64 {
        cosine * (way + self.way_to_rest(fastest))
            + self.obstacle_speed * (age + self.time_to_rest(fastest)) / 1000.0
    }

    /// The published guard of Mitsch et al. 2017, Theorem 2:
    /// v²/2b + V·v/b + (A/b + 1)(A·ε²/2 + ε(v + V)).
    #[must_use]
    pub fn published(&self, speed: f64) -> f64 {
        let e = self.reaction_time / 1000.0;
        speed * speed / (2.0 * self.braking)
            + self.obstacle_speed * speed / self.braking
            + (self.acceleration / self.braking + 1.0)
                * (self.acceleration * e * e / 2.0 + e * (speed + self.obstacle_speed))
    }
}

// --------------------------------------------------------------- invariants

/// shield.INV-1: a command keeps the limits, forward and backward.
#[must_use]
pub fn within_limits(
    speed: i32,
    turn_rate: i32,
    speed_max: i32,
    reverse_speed_max: i32,
    turn_rate_max: i32,
) -> bool {
    (-reverse_speed_max..=speed_max).contains(&speed)
        && (-turn_rate_max..=turn_rate_max).contains(&turn_rate)
}

/// shield.INV-2: way and time to rest are no less than SH.2 gives exactly for a robot that is no
/// faster than `fastest` until it brakes, multiplied out so that nothing is rounded.
#[must_use]
pub fn covers_rest(way: i32, time: i32, fastest: i32, braking: i32, reaction_time: i32) -> bool {
    let [x, t, w, b, e] = [way, time, fastest, braking, reaction_time].map(i64::from);
    2000 * b * x >= 2 * b * w * e + 1000 * w * w && b * t >= b * e + 1000 * w
}

/// shield.INV-2: the clearance that is said to be needed to go at up to `fastest` towards a thing that is
/// no faster than `obstacle_speed` is no less than SH.3 gives exactly, and more by no more than the four
/// quotients round up: 1 mm each.
#[must_use]
pub fn covers_clearance(
    clearance: i32,
    fastest: i32,
    obstacle_speed: i32,
    [braking, reaction_time]: [i32; 2],
) -> bool {
    let [c, w, o, b, e] =
        [clearance, fastest, obstacle_speed, braking, reaction_time].map(i64::from);
    // vε + v²/2b + V(ε + v/b), multiplied by 2000·b.
    let exact = 2 * b * w * e + 1000 * w * w + 2 * o * (b * e + 1000 * w);
    (exact..=exact + 4 * 2000 * b).contains(&(2000 * b * c))
}

/// The f32 products that convert limits are themselves rounded, by one part in ten million each.
const ROUNDED: f64 = 2e-7;

/// shield.INV-2: a whole number of thousandths is no more than what is configured, and less by no
/// more than a whole one.
#[must_use]
pub fn rounded_down(thousandths: i32, configured: f64) -> bool {
    let (whole, exact) = (f64::from(thousandths), 1000.0 * configured);
    let slack = ROUNDED * exact.abs();
    // Sums that nothing small gets lost in: a speed of next to nothing is a whole one, rounded up.
    whole <= exact + slack && exact - slack < whole + 1.0
}

/// shield.INV-2: a whole number of thousandths is no less than what is configured, and more by no
/// more than a whole one.
#[must_use]
pub fn rounded_up(thousandths: i32, configured: f64) -> bool {
    rounded_down(-thousandths, -configured)
}

/// SH.1, the safe state, exactly: braking now ends before contact, κ·v²/2b + V·v/b ≤ r. Cosine in
/// thousandths, `left` in thousandths of a millimetre.
#[must_use]
pub fn safe_state(speed: i32, cosine: i32, left: i64, braking: i32, obstacle_speed: i32) -> bool {
    let [v, k, b, o] = [speed, cosine, braking, obstacle_speed].map(i64::from);
    k * v * v + 2000 * o * v <= 2 * b * left
}

/// shield.INV-3: a safe state stays safe through a step.
#[must_use]
pub fn stays_safe(before: bool, after: bool) -> bool {
    !before || after
}

/// shield.INV-4: a robot that is made to stop does not drive forward, and does not move at all
/// where the reason is not the distance, or the stop is latched.
#[must_use]
pub fn stop_is_kept(
    stopped: bool,
    may_turn: bool,
    latched: bool,
    speed: i32,
    turn_rate: i32,
) -> bool {
    !stopped || (speed <= 0 && ((may_turn && !latched) || untrusted_rests(speed, turn_rate)))
}

/// shield.INV-5: an observation that cannot be trusted yields no motion at all.
#[must_use]
pub fn untrusted_rests(speed: i32, turn_rate: i32) -> bool {
    speed == 0 && turn_rate == 0
}

/// shield.INV-6: a command's magnitude grows by no more than the base can gain in the time.
#[must_use]
pub fn slew_kept(before: i32, after: i32, acceleration: i32, elapsed_ms: i32) -> bool {
    let step = i64::from(acceleration) * i64::from(elapsed_ms) / 1000;
    let (before, after) = (i64::from(before), i64::from(after));
    (before.min(0) - step..=before.max(0) + step).contains(&after)
}

/// shield.INV-7: what stops at a distance and a closing speed also stops nearer and faster.
#[must_use]
pub fn monotone(stops: bool, nearer_and_faster_stops: bool) -> bool {
    !stops || nearer_and_faster_stops
}

/// shield.INV-8: contact at some time within the stop time makes the guard stop: at that time the
/// distance can shrink by closing·time.
#[must_use]
pub fn sound(distance: i32, closing: i32, time: i32, stops: bool) -> bool {
    let possible = i64::from(distance) * 1000 <= i64::from(closing) * i64::from(time);
    !possible || stops
}

/// shield.INV-9: a robot that moves was admitted by every guard for just that command.
#[must_use]
pub fn admitted(speed: i32, turn_rate: i32, fits: bool) -> bool {
    untrusted_rests(speed, turn_rate) || fits
}

/// shield.INV-10: the search finds the greatest number there is up to `wish` and `threshold`.
#[must_use]
pub fn greatest(found: i32, wish: i32, threshold: i32) -> bool {
    found == wish.min(threshold)
}

/// shield.INV-11: way and time of a plan are enough for the speed that the robot may have now
/// (`motion`), and, if it is told to move, for what it is told (`speed`) with one gain.
#[must_use]
pub fn plan_suffices(
    [way, time]: [i32; 2],
    [speed, gain, motion]: [i32; 3],
    [braking, reaction_time]: [i32; 2],
) -> bool {
    let fastest = if speed == 0 {
        motion
    } else {
        motion.max(speed.abs() + gain)
    };
    covers_rest(way, time, fastest, braking, reaction_time)
}

/// shield.INV-11: the way of a plan in each direction is enough for what the robot may do in it: for the
/// speed it may have now, `motion`, in its direction, and for what it is told, with one gain, in that one.
/// No way is taken in a direction in which it does neither.
#[must_use]
pub fn plan_suffices_both_ways(
    way: [i32; 2],
    time: i32,
    [speed, gain]: [i32; 2],
    (motion, backward): (i32, bool),
    bounds: [i32; 2],
) -> bool {
    [false, true].iter().all(|&back| {
        let rolls = if backward == back { motion } else { 0 };
        let told = if speed != 0 && (speed < 0) == back {
            speed
        } else {
            0
        };
        let way = way[usize::from(back)];
        plan_suffices([way, time], [told, gain, rolls], bounds)
            && (way == 0 || told != 0 || rolls != 0)
    })
}

/// shield.INV-11: a plan turns as fast as the robot is told or turns already, and as far as that takes it
/// in the plan's time; beyond ten radians it no longer matters.
#[must_use]
pub fn turn_suffices(turn: i32, turn_rate: i32, time: i32, [told, now]: [i32; 2]) -> bool {
    let far = i64::from(turn_rate) * i64::from(time);
    turn_rate == told.abs().max(now) && (turn == 10_000 || 1000 * i64::from(turn) >= far)
}

/// shield.INV-12: a turn ends before contact, V(ε + |ω|/α) ≤ left, multiplied by 1000·α; `left` is
/// what the robot's own way and the age leave of the clearance, in thousandths of a millimetre.
#[must_use]
pub fn turn_ends_before_contact(
    turn_rate: i32,
    acceleration: i32,
    reaction_time: i32,
    obstacle_speed: i32,
    left: i64,
) -> bool {
    let [w, a, e, v] = [turn_rate, acceleration, reaction_time, obstacle_speed].map(i64::from);
    v * (a * e + 1000 * w.abs()) <= a * left
}

/// shield.INV-13: the path bends no tighter than advised, |ω|/|v| ≤ |ω*|/|v*|, multiplied out, and
/// neither part is greater than advised.
#[must_use]
pub fn no_tighter(speed: i32, turn_rate: i32, advised_speed: i32, advised_turn_rate: i32) -> bool {
    // Up to 10,000 mm/s and 20,000 mrad/s: no product overflows.
    turn_rate.abs() * advised_speed.abs() <= advised_turn_rate.abs() * speed.abs()
        && speed.abs() <= advised_speed.abs()
        && turn_rate.abs() <= advised_turn_rate.abs()
}

/// shield.INV-14: a thing that is nearer, was seen longer ago, since when the robot has gone or
/// turned farther, or that may be faster, leaves room for nothing that it did not leave before.
#[must_use]
pub fn worse_is_no_easier(fits: bool, fits_worse: bool) -> bool {
    fits || !fits_worse
}

/// shield.INV-15: nothing drives backward where no sonar looks back.
#[must_use]
pub fn sees_where_it_goes(speed: i32, looks_back: bool) -> bool {
    speed >= 0 || looks_back
}

/// What a tick shows that stops the robot by itself.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// The base: the emergency stop, a stall, or motors that are off.
    pub base: bool,
    /// A sonar that is stale, invalid or in contact.
    pub untrusted: bool,
    /// The least range held ahead, mm, and the one at which the robot is to stand.
    pub ahead: [i32; 2],
    /// Something moves faster than can be measured.
    pub saturated: bool,
    /// The time since the tick before, ms, below zero if the clock went back, and the longest there may
    /// be while the robot moves.
    pub elapsed: [i64; 2],
    /// A sonar that is stuck.
    pub stuck: bool,
    /// The robot has been told to move.
    pub moving: bool,
}

impl Signs {
    /// Whether any of them demands a stop.
    #[must_use]
    pub fn demand_a_stop(&self) -> bool {
        let Self {
            ahead: [range, least],
            elapsed: [elapsed, longest],
            ..
        } = *self;
        self.base
            || self.untrusted
            || self.saturated
            || range <= least
            || elapsed < 0
            || (self.moving && (self.stuck || elapsed > longest))
    }
}

/// shield.INV-16: a tick that shows any of them stops the robot.
#[must_use]
pub fn every_cause_stops(signs: &Signs, stopped: bool) -> bool {
    stopped || !signs.demand_a_stop()
}

/// shield.INV-17: where there is room, nothing else stops a robot that drives, or keeps one stopped.
#[must_use]
pub fn nothing_else_stops(signs: &Signs, room: bool, stopped: bool) -> bool {
    !stopped || !room || signs.demand_a_stop()
}

/// shield.INV-18: a tick in which something leaves no room for the least speed, or in which contact is
/// possible within the stop time, stops the robot.
#[must_use]
pub fn no_room_stops(room: bool, contact: bool, stopped: bool) -> bool {
    stopped || (room && !contact)
}

/// shield.INV-18: while the robot moves, something that was seen to come too fast latches the stop where it
/// leaves no room for full speed.
#[must_use]
pub fn too_fast_latches(moves: bool, too_fast: bool, ample: bool, latched: bool) -> bool {
    latched || !(moves && too_fast && !ample)
}

/// How a robot moves.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Its speed, mm/s.
    pub speed: i32,
    /// It rolls backward.
    pub backward: bool,
    /// How fast it turns, mrad/s.
    pub turn_rate: i32,
}

/// shield.INV-19: the robot is taken to move as fast as it may: no slower than was measured, rounded up,
/// with the error and what it can have gained in the `age` of the measurement (ms, ε at most), nor than it
/// was told (mm/s, mrad/s); and no faster. It rests only if it was told to and rest was measured. Its
/// direction is the measured one, or that which it was told.
#[must_use]
pub fn motion_is_covered(
    taken: Moving,
    measured: Moving,
    told: [i32; 2],
    [acceleration, age, error]: [i32; 3],
) -> bool {
    let turns = taken.turn_rate == measured.turn_rate.max(told[1].abs());
    if measured.speed == 0 && told[0] == 0 {
        return turns && taken.speed == 0;
    }
    let gain = (acceleration * age + 999) / 1000;
    let rolls = taken.speed == (measured.speed + error + gain).max(told[0].abs());
    let backward = measured.backward || (measured.speed == 0 && told[0] < 0);
    turns && rolls && taken.backward == backward
}

/// shield.INV-19: a thing that the law follows is taken to be no farther from where it would touch (mm, 0 at
/// least), and no slower (mm/s), than was measured, rounded down and up.
#[must_use]
pub fn approach_is_covered(
    [distance, speed]: [i32; 2],
    [range, measured_speed]: [i32; 2],
    contact_range: i32,
) -> bool {
    distance == (range - contact_range).max(0) && speed == measured_speed
}

/// shield.INV-6: the time in which a base may have gained speed and turn rate is no longer than the time
/// since the tick before (below zero if the clock went back), nor than ε; what is out of sight gives it none
/// to gain speed.
#[must_use]
pub fn time_to_gain(
    [gaining, turning]: [i32; 2],
    since: i64,
    reaction_time: i32,
    unseen: bool,
) -> bool {
    let most = since.clamp(0, reaction_time.into());
    i64::from(turning) == most && gaining == if unseen { 0 } else { turning }
}

/// shield.INV-13: advice becomes whole thousandths that are no greater than its f32 product, and less by
/// less than one.
#[must_use]
pub fn taken_whole(thousandths: i32, advised: f32) -> bool {
    let whole = thousandths.unsigned_abs() as f32;
    let exact = (advised * 1000.0).abs();
    let same_side = thousandths == 0 || (thousandths < 0) == (advised < 0.0);
    same_side && whole <= exact && exact < whole + 1.0
}

/// Advice that makes sense: what is no number, or beyond 10 m/s or 20 rad/s, stops the robot.
#[must_use]
pub fn sensible(speed: f32, turn_rate: f32) -> bool {
    speed.abs() <= 10.0 && turn_rate.abs() <= 20.0
}

/// shield.INV-20: what is slower than advised comes with a reason.
#[must_use]
pub fn slower_has_a_reason(speed: i32, advised: i32, reason: bool) -> bool {
    reason || speed == advised
}
