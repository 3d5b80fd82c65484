//! Chapter `avoid`: S1's equations and invariants. See `spec/avoid.md`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

// ---------------------------------------------------------------- equations

/// S1.E1 as printed: θ_OR = 180° − (θ_R + θ_cam), degrees, not wrapped.
#[must_use]
pub fn e1_printed(heading_deg: f64, camera_deg: f64) -> f64 {
    180.0 - (heading_deg + camera_deg)
}

/// S1.E2 as printed: v_o cos θ_o = |p₂ − p₁|·s/t + v_R cos θ_R, cm/s.
#[must_use]
pub fn e2_printed(
    displacement_px: f64,
    scale_cm_px: f64,
    interval_s: f64,
    speed: f64,
    heading_deg: f64,
) -> f64 {
    displacement_px * scale_cm_px / interval_s + speed * heading_deg.to_radians().cos()
}

/// S1.E3 as printed, with the cap at v_o,max of the text (L61), cm/s.
#[must_use]
pub fn e3_printed(
    displacement_px: f64,
    scale_cm_px: f64,
    interval_s: f64,
    direction_deg: f64,
    speed: f64,
    heading_deg: f64,
    speed_max: f64,
) -> f64 {
    if direction_deg > 60.0 {
        return speed_max;
    }
    let cos = direction_deg.to_radians().cos();
    let seen = displacement_px * scale_cm_px / (interval_s * cos);
    let own = speed * heading_deg.to_radians().cos() / cos;
    if seen + own >= speed_max {
        speed_max
    } else {
        seen + own
    }
}

/// S1.E3 as read: (speed in cm/s, saturated).
#[must_use]
pub fn e3(
    displacement_px: f64,
    scale_cm_px: f64,
    interval_s: f64,
    direction_deg: f64,
    speed: f64,
    heading_deg: f64,
    speed_max: f64,
) -> (f64, bool) {
    let usable = (0.0..=60.0).contains(&direction_deg)
        && interval_s > 0.0
        && displacement_px >= 0.0
        && scale_cm_px >= 0.0;
    if !usable {
        return (speed_max, true);
    }
    let lateral =
        displacement_px * scale_cm_px / interval_s + speed * heading_deg.to_radians().cos().abs();
    let raw = lateral / direction_deg.to_radians().cos();
    if raw < speed_max {
        (raw, false)
    } else {
        (speed_max, true)
    }
}

/// S1.E4 as printed: (t in s, stop), stop iff t ≤ T.
#[must_use]
pub fn e4_printed(
    distance: f64,
    heading_deg: f64,
    camera_deg: f64,
    speed: f64,
    obstacle_speed: f64,
    direction_deg: f64,
    stop_time: f64,
) -> (f64, bool) {
    let or = e1_printed(heading_deg, camera_deg).to_radians();
    let t = distance * or.sin()
        / (speed * heading_deg.to_radians().sin()
            + obstacle_speed * direction_deg.to_radians().sin());
    (t, t <= stop_time)
}

/// S1.E4 as read for reporting: seconds, infinite if never.
#[must_use]
pub fn e4(
    distance: f64,
    heading_deg: f64,
    half_angle_deg: f64,
    speed: f64,
    obstacle_speed: f64,
    direction_deg: f64,
) -> f64 {
    // The least |sin| over the cone, by looking: its ends, and the zeros that lie between them.
    let (from, to) = (heading_deg - half_angle_deg, heading_deg + half_angle_deg);
    let zero_inside = (-2..=2).any(|k| (from..=to).contains(&(180.0 * f64::from(k))));
    let least = if zero_inside {
        0.0
    } else {
        from.to_radians()
            .sin()
            .abs()
            .min(to.to_radians().sin().abs())
    };
    let closing = speed * heading_deg.to_radians().sin().abs()
        + obstacle_speed * direction_deg.to_radians().sin().abs();
    if closing == 0.0 {
        f64::INFINITY
    } else {
        distance * least / closing
    }
}

/// The sound bound on S1.E4: (t_lb in s, infinite if never; stop), stop iff t_lb ≤ T.
#[must_use]
pub fn e4_bound(
    distance: f64,
    contact: f64,
    speed: f64,
    obstacle_speed: f64,
    stop_time: f64,
) -> (f64, bool) {
    let closing = speed + obstacle_speed;
    let bound = if closing == 0.0 {
        f64::INFINITY
    } else {
        (distance - contact).max(0.0) / closing
    };
    (bound, bound <= stop_time)
}

/// S1.E5 as printed: (Δθ, θ_m) in radians, not wrapped. `right_of_obstacle` is the paper's case
/// "robot at the right side of the obstacle".
#[must_use]
pub fn e5_printed(
    distance: f64,
    turn_distance: f64,
    heading: f64,
    right_of_obstacle: bool,
) -> (f64, f64) {
    let turn = FRAC_PI_2 * turn_distance / distance;
    let sign = if right_of_obstacle { 1.0 } else { -1.0 };
    (turn, heading + sign * turn)
}

/// S1.E5 as read: (Δθ ≤ π, σ, θ_m wrapped) in radians, for an obstacle at `bearing` (positive is
/// left; 0 turns left).
#[must_use]
pub fn e5(distance: f64, turn_distance: f64, reference: f64, bearing: f64) -> (f64, f64, f64) {
    let turn = (FRAC_PI_2 * turn_distance / distance).min(PI);
    let sign = if bearing > 0.0 { -1.0 } else { 1.0 };
    (turn, sign, wrap(reference + sign * turn))
}

/// S1.E6: the heading is the reference heading.
#[must_use]
pub fn e6(reference: f64) -> f64 {
    reference
}

/// S1.E7 as printed: v_R = v_max(1 − |0.5 − Δθ/π|).
#[must_use]
pub fn e7_printed(turn: f64, speed_max: f64) -> f64 {
    speed_max * (1.0 - (0.5 - turn / PI).abs())
}

/// S1.E7 as read: of |Δθ|, at most π.
#[must_use]
pub fn e7(turn: f64, speed_max: f64) -> f64 {
    e7_printed(turn.abs().min(PI), speed_max)
}

/// S1.A3: (θ_o in the image, folded θ_o, approaching), degrees, from the motion template's global
/// orientation.
#[must_use]
pub fn a3(global_orientation_deg: f64) -> (f64, f64, bool) {
    let image = 360.0 - global_orientation_deg;
    let (sin, cos) = image.to_radians().sin_cos();
    // atan2 of absolute values folds all four quadrants into the first.
    (image, sin.abs().atan2(cos.abs()).to_degrees(), sin < 0.0)
}

/// S1.A1 as read: what reading the front sonar at `front` means.
#[must_use]
pub fn a1(front: f64, min_distance: f64, goal_reached: bool, customer: bool) -> &'static str {
    match (front <= min_distance, goal_reached && customer) {
        (true, true) => "Arrived",
        (true, false) => "Stop",
        (false, _) => "Continue",
    }
}

/// S1.A4 as read, the driving part of M1, for an obstacle whose place does not block the way to
/// the goal and a robot that has not turned back yet. Thresholds of Table 1 in cm and s.
#[must_use]
pub fn a4(mode: &str, distance: f64, trend: &str, contact_time: f64, fresh: bool) -> &'static str {
    const SAFE: f64 = 120.0;
    const NEAR: f64 = 80.0;
    const MINIMUM: f64 = 40.0;
    const STOP_TIME: f64 = 1.0;
    if !fresh || distance <= MINIMUM || contact_time <= STOP_TIME {
        return "Stop";
    }
    let receding = trend == "receding";
    let approaching = trend == "closing" || trend == "unknown";
    match mode {
        "Cruise" if distance < SAFE && (approaching || distance <= NEAR) => "Maneuver",
        "Cruise" => "Cruise",
        "Maneuver" if distance < SAFE && (!receding || distance <= NEAR) => "Maneuver",
        "Maneuver" => "Reorient",
        "Reorient" if distance <= NEAR || (distance < SAFE && trend == "closing") => "Maneuver",
        "Reorient" => "Reorient",
        "Stop" if distance >= SAFE || (receding && distance > NEAR) => "Reorient",
        "Stop" => "Maneuver",
        _ => "Stop",
    }
}

/// Wraps radians to (−π, π].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

// --------------------------------------------------------------- invariants

/// avoid.INV-1: v_o lies in [0, v_o,max].
#[must_use]
pub fn obstacle_speed_in_range(speed: f32, speed_max: f32) -> bool {
    speed >= 0.0 && speed <= speed_max
}

/// avoid.INV-2: the bound on the lateral speed is never below the printed E2, for the same terms.
#[must_use]
pub fn not_below_printed(bound: f32, seen: f32, own_signed: f32) -> bool {
    bound >= seen + own_signed
}

/// avoid.INV-3: an unusable sighting gives v_o,max, saturated.
#[must_use]
pub fn unusable_is_fastest(speed: f32, saturated: bool, speed_max: f32) -> bool {
    speed == speed_max && saturated
}

/// avoid.INV-4: a time is not negative and not NaN; "never" is `None`.
#[must_use]
pub fn is_time(time: Option<f32>) -> bool {
    time.is_none_or(|time| time >= 0.0 && time.is_finite())
}

/// avoid.INV-6: the size of the turn lies in [0, 2] quarter turns, that is [0, π].
#[must_use]
pub fn turn_in_range(quarter_turns: f32) -> bool {
    (0.0..=2.0).contains(&quarter_turns)
}

/// avoid.INV-7: the turn (σ·|Δθ|, positive is left) is away from the obstacle's bearing.
#[must_use]
pub fn turns_away(signed_turn: f32, bearing: f32) -> bool {
    let towards = (signed_turn > 0.0 && bearing > 0.0) || (signed_turn < 0.0 && bearing < 0.0);
    !towards
}

/// avoid.INV-8: an angle lies in [−π, π] (in f32, where π itself is rounded up).
#[must_use]
pub fn angle_in_range(angle: f32) -> bool {
    (-std::f32::consts::PI..=std::f32::consts::PI).contains(&angle)
}

/// avoid.INV-9: v_R lies in [v_max/2, v_max].
#[must_use]
pub fn maneuver_speed_in_range(speed: f32, speed_max: f32) -> bool {
    speed >= speed_max / 2.0 && speed <= speed_max
}

/// avoid.INV-10: for an unchanging situation the third mode is the second.
#[must_use]
pub fn settled<M: PartialEq>(second: M, third: M) -> bool {
    second == third
}

/// avoid.INV-11: a guard leaves no mode that asks for motion.
#[must_use]
pub fn stop_dominates(guard: bool, at_rest: bool) -> bool {
    !guard || at_rest
}

/// avoid.INV-12: being near is not having arrived.
#[must_use]
pub fn arrived_only_at_goal(arrived: bool, goal_reached: bool, customer: bool) -> bool {
    !arrived || (goal_reached && customer)
}

/// avoid.INV-13: the law's advice is finite, forward, and within the limits of the base.
#[must_use]
pub fn advice_in_range(speed: f32, turn_rate: f32, speed_max: f32, turn_rate_max: f32) -> bool {
    (0.0..=speed_max).contains(&speed) && (-turn_rate_max..=turn_rate_max).contains(&turn_rate)
}

/// avoid.INV-14: the folded direction of motion lies in [0, π/2].
#[must_use]
pub fn folded_in_range(direction: f32) -> bool {
    (0.0..=std::f32::consts::FRAC_PI_2).contains(&direction)
}
