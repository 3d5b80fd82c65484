//! Chapter `avoid`: S1's equations and the mode machine.

#[cfg(not(kani))]
use super::kani;
use sidestep::avoid::{self, Avoid, Mode, QuarterTurns, Side, Situation, Trend};
use sidestep::config::{Config, Parameters};
use sidestep::failsafe::StopReason;
use sidestep::law::Law;
use sidestep::observation::Sighting;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::track::Obstacle;
use sidestep::view::View;
use sidestep_spec::avoid as law;

/// Any length there is.
pub fn any_length() -> Length {
    let length = Length::metres(kani::any());
    kani::assume(length.is_ok());
    length.unwrap_or(Length::ZERO)
}

/// Any speed there is.
pub fn any_speed() -> Speed {
    let speed = Speed::metres_per_second(kani::any());
    kani::assume(speed.is_ok());
    speed.unwrap_or(Speed::ZERO)
}

/// Any angle there is.
pub fn any_angle() -> Angle {
    let angle = Angle::radians(kani::any());
    kani::assume(angle.is_ok());
    angle.unwrap_or(Angle::ZERO)
}

/// Any bit pattern as a sighting.
pub fn any_sighting() -> Sighting {
    Sighting {
        displacement: kani::any(),
        scale: kani::any(),
        interval: kani::any(),
        direction: kani::any(),
        taken_at: Instant(kani::any()),
    }
}

/// Any trend.
pub fn any_trend() -> Trend {
    match kani::any::<u8>() % 4 {
        0 => Trend::Closing,
        1 => Trend::Steady,
        2 => Trend::Receding,
        _ => Trend::Unknown,
    }
}

/// Any mode.
pub fn any_mode() -> Mode {
    match kani::any::<u8>() % 5 {
        0 => Mode::Cruise,
        1 => Mode::Maneuver,
        2 => Mode::Reorient,
        3 => Mode::Stop,
        _ => Mode::Arrived,
    }
}

/// S1 E3 for any bit pattern of the sighting, any speeds and heading.
//= avoid.INV-1
//= avoid.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
pub fn obstacle_speed_is_clamped() {
    let speed_max = any_speed();
    let sighting = any_sighting();
    let estimate = avoid::obstacle_speed(&sighting, any_speed(), any_angle(), speed_max);
    assert!(law::obstacle_speed_in_range(
        estimate.value.get(),
        speed_max.get()
    ));
    let usable = sighting.displacement >= 0.0
        && sighting.scale >= 0.0
        && sighting.interval > 0.0
        && (0.0..=core::f32::consts::FRAC_PI_3).contains(&sighting.direction);
    assert!(
        usable
            || law::unusable_is_fastest(estimate.value.get(), estimate.saturated, speed_max.get())
    );
    kani::cover!(!estimate.saturated, "a speed below v_o,max");
    kani::cover!(usable && estimate.saturated, "a measurement that saturates");
    kani::cover!(sighting.displacement.is_nan(), "NaN");
}

/// The bound on E2 is not below E2 as printed, for any two terms, whatever the sign of the
/// robot's own share. Dividing both by the same cos θ_o > 0 keeps the order, since the division
/// of IEEE 754 rounds monotonically, and so does the clamp: hence E3 as read is never below E3 as
/// printed.
//= avoid.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn lateral_speed_is_not_below_printed() {
    let (seen, own): (f32, f32) = (kani::any(), kani::any());
    kani::assume((0.0..=1e8).contains(&seen) && (-10.0..=10.0).contains(&own));
    let bound = avoid::lateral_bound(seen, own);
    assert!(law::not_below_printed(bound, seen, own));
    kani::cover!(seen + own < 0.0, "the printed formula is negative");
    kani::cover!(own > 0.0, "the printed formula is the bound");
}

/// Both readings of E4 give a time or "never", for any quantities.
//= avoid.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
pub fn times_are_times() {
    let collision = avoid::time_to_collision(
        any_length(),
        any_angle(),
        any_angle(),
        any_speed(),
        any_speed(),
        any_angle(),
    );
    assert!(law::is_time(collision));
    let bound = avoid::contact_time_bound(any_length(), any_length(), any_speed(), any_speed());
    assert!(law::is_time(bound));
    kani::cover!(collision.is_none(), "never");
    kani::cover!(collision == Some(0.0), "level now");
    kani::cover!(bound.is_some_and(|t| t > 1.0), "more than a second");
}

/// E5: the turn is at most half a turn, for any distances, zero included.
//= avoid.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn turn_is_at_most_half() {
    let (distance, reach) = (any_length(), any_length());
    let turn = QuarterTurns::at_distance(distance, reach);
    assert!(law::turn_in_range(turn.get()));
    kani::cover!(turn.get() == 2.0, "half a turn");
    kani::cover!(turn.get() < 0.5, "a small turn");
    kani::cover!(distance == Length::ZERO, "distance zero");
}

/// E5: the heading is a heading, and the turn is away from the bearing.
//= avoid.INV-7
//= avoid.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn maneuver_turns_away() {
    let (reference, bearing) = (any_angle(), any_angle());
    let turn = QuarterTurns::of_angle(kani::any());
    kani::assume(turn.is_ok());
    if let Ok(turn) = turn {
        let side = Side::away_from(bearing, any_length(), any_length());
        let heading = avoid::maneuver_heading(reference, side, turn);
        let signed = match side {
            Side::Left => turn.get(),
            Side::Right => -turn.get(),
        };
        assert!(law::turns_away(signed, bearing.get()));
        assert!(law::angle_in_range(heading.get()));
        kani::cover!(side == Side::Right, "to the right");
        kani::cover!(
            side == Side::Left && bearing == Angle::ZERO,
            "straight ahead"
        );
    }
}

/// E7 with E5: v_R stays in [v_max/2, v_max] for every v_max and every distance, in the rational
/// form that the law computes.
//= avoid.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn maneuver_speed_is_bounded() {
    let speed_max = any_speed();
    let turn = QuarterTurns::at_distance(any_length(), any_length());
    let speed = avoid::maneuver_speed(speed_max, turn);
    assert!(law::maneuver_speed_in_range(speed.get(), speed_max.get()));
    kani::cover!(turn.get() > 1.0, "beyond the quarter turn");
    kani::cover!(turn.get() < 1.0 && speed_max.get() > 0.3, "before it");
}

/// S1 with any thresholds that a configuration may have.
pub fn any_thresholds() -> Config {
    let parameters = Parameters {
        safe_distance: kani::any(),
        near_distance: kani::any(),
        ..preset::SRIKANDI_II_2012
    };
    let config = Config::new(parameters);
    kani::assume(config.is_ok());
    match config {
        Ok(config) => config,
        Err(_) => unreachable!(),
    }
}

/// Any situation.
pub fn any_situation() -> Situation {
    Situation {
        distance: if kani::any() {
            Some(any_length())
        } else {
            None
        },
        trend: any_trend(),
        guard: kani::any(),
        corridor_free: kani::any(),
        aligned: kani::any(),
        at_goal: kani::any(),
    }
}

/// M1: from any mode, in any unchanging situation, the machine is at rest after two steps.
//= avoid.INV-10
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn modes_settle() {
    let (mode, situation, config) = (any_mode(), any_situation(), any_thresholds());
    let first = avoid::next_mode(mode, &situation, &config);
    let second = avoid::next_mode(first, &situation, &config);
    let third = avoid::next_mode(second, &situation, &config);
    assert!(law::settled(second, third));
    kani::cover!(first != second, "two steps are needed");
    kani::cover!(second == Mode::Maneuver, "settles in a maneuver");
    kani::cover!(
        second == Mode::Cruise && mode == Mode::Stop,
        "from stop to cruise"
    );
}

/// M1: a guard leaves no mode that asks for motion.
//= avoid.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn stop_dominates() {
    let (mode, situation) = (any_mode(), any_situation());
    let next = avoid::next_mode(mode, &situation, &any_thresholds());
    assert!(law::stop_dominates(situation.guard, next.at_rest()));
    kani::cover!(
        situation.guard && mode == Mode::Maneuver,
        "a maneuver is stopped"
    );
    kani::cover!(!next.at_rest(), "without a guard it moves");
}

/// S1 A1: being near something is not having arrived.
//= avoid.INV-12
#[cfg_attr(kani, kani::proof)]
pub fn arrival_is_not_proximity() {
    let (goal, customer) = (kani::any(), kani::any());
    let result = avoid::arrival(any_length(), any_length(), goal, customer);
    assert!(law::arrived_only_at_goal(
        result == avoid::Arrival::Arrived,
        goal,
        customer
    ));
    kani::cover!(result == avoid::Arrival::Arrived, "arrived");
    kani::cover!(result == avoid::Arrival::Stop, "something else is near");
}

/// S1 A3: the folded direction is one that E3 and E4 take.
//= avoid.INV-14
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn image_direction_is_folded() {
    if let Ok((direction, approaching)) = avoid::image_direction(kani::any()) {
        assert!(law::folded_in_range(direction));
        kani::cover!(approaching, "approaching");
        kani::cover!(!approaching && direction > 1.0, "going away");
    }
}

/// What is in the robot's way may be judged in any way.
pub fn any_corridor<const N: usize>(
    _avoid: &Avoid,
    _obstacle: &Obstacle,
    _view: &View<N>,
    _heading: Angle,
) -> bool {
    kani::any()
}

/// S1's law advises within its limits, and no speed where a guard says no, whatever view follows
/// whatever view.
//= avoid.INV-11
//= avoid.INV-13
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::avoid::Avoid::in_corridor, any_corridor))]
pub fn advice_is_within_limits() {
    let Ok(config) = Config::new(preset::PIONEER_3DX) else {
        unreachable!()
    };
    let mut avoid = Avoid::new(config);
    for _ in 0..2 {
        let mut view = super::view::any_view();
        let guard = kani::any();
        view.guard = if guard {
            Some(StopReason::Operator)
        } else {
            None
        };
        let advice = avoid.advise(&view);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            config.speed_max,
            config.turn_rate_max
        ));
        assert!(law::stop_dominates(guard, advice.speed == 0.0));
        kani::cover!(avoid.current() == Mode::Maneuver, "a maneuver");
        kani::cover!(advice.turn_rate < -0.5, "a turn to the right");
    }
}
