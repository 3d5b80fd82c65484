//! Bytes as arguments of every public function of `avoid` and `kinematics`, and as what S1's law
//! gets to see.

use super::bytes::Bytes;
use super::settings::{self, Shares};
use nalgebra::Vector2;
use sidestep::avoid::{
    self, Arrival, Avoid, Mode, ObstacleSpeed, QuarterTurns, Side, Situation, Trend,
};
use sidestep::config::Config;
use sidestep::failsafe::StopReason;
use sidestep::kinematics::{DifferentialDrive, Twist, WheelRates, velocity};
use sidestep::law::Law;
use sidestep::observation::{BaseStatus, Sighting, SonarReading};
use sidestep::preset;
use sidestep::quantity::{Instant, Length};
use sidestep::track::Obstacle;
use sidestep::view::{Class, GoalView, Hazard, Pose, View};
use sidestep_spec::{avoid as law, kinematics as drive};
use std::f32::consts::FRAC_PI_3;

/// Views that the law is shown at most.
const VIEWS: usize = 64;

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let config = if bytes.truth() {
        let shares: Shares = std::array::from_fn(|_| bytes.share());
        settings::config(&shares)
    } else {
        Config::new(preset::PIONEER_3DX).expect("the preset is good")
    };
    match bytes.u8() % 4 {
        0 => equations(&mut bytes),
        1 => modes(&config, &mut bytes),
        2 => advice(&config, &mut bytes),
        _ => kinematics(&mut bytes),
    }
}

fn any_sighting(bytes: &mut Bytes) -> Sighting {
    Sighting {
        displacement: bytes.number(),
        scale: bytes.number(),
        interval: bytes.number(),
        direction: bytes.number(),
        taken_at: Instant(bytes.u64()),
    }
}

/// E1 to E7, A1 and A3.
fn equations(bytes: &mut Bytes) {
    let (speed, speed_max, heading) = (bytes.speed(), bytes.speed(), bytes.angle());
    let sighting = any_sighting(bytes);
    let estimate = avoid::obstacle_speed(&sighting, speed, heading, speed_max);
    assert!(law::obstacle_speed_in_range(
        estimate.value.get(),
        speed_max.get()
    ));
    let usable = sighting.displacement >= 0.0
        && sighting.scale >= 0.0
        && sighting.interval > 0.0
        && (0.0..=FRAC_PI_3).contains(&sighting.direction);
    assert!(
        usable
            || law::unusable_is_fastest(estimate.value.get(), estimate.saturated, speed_max.get())
    );
    let own = speed.get() * sidestep::math::cos(heading.get());
    if let Ok(lateral) = avoid::lateral_speed(&sighting, speed, heading) {
        let seen = sighting.displacement * sighting.scale / sighting.interval;
        assert!(law::not_below_printed(lateral, seen, own));
    }

    let (distance, contact, bearing) = (bytes.length(), bytes.length(), bytes.angle());
    let direction = avoid::obstacle_robot_angle(heading, bearing);
    assert!(law::angle_in_range(direction.get()));
    let time =
        avoid::time_to_collision(distance, heading, bearing, speed, estimate.value, direction);
    assert!(law::is_time(time));
    assert!(law::is_time(avoid::contact_time_bound(
        distance,
        contact,
        speed,
        estimate.value
    )));

    if let Ok((folded, _)) = avoid::image_direction(bytes.number()) {
        assert!(law::folded_in_range(folded));
    }

    let (left, right) = (bytes.length(), bytes.length());
    let of_angle = QuarterTurns::of_angle(bytes.number());
    for turn in [Ok(QuarterTurns::at_distance(distance, contact)), of_angle]
        .into_iter()
        .flatten()
    {
        assert!(law::turn_in_range(turn.get()));
        assert!(law::angle_in_range(turn.angle().get()));
        let side = Side::away_from(bearing, left, right);
        let signed = match side {
            Side::Left => turn.get(),
            Side::Right => -turn.get(),
        };
        assert!(law::turns_away(signed, bearing.get()));
        let heading = avoid::maneuver_heading(heading, side, turn);
        assert!(law::angle_in_range(heading.get()));
        let speed = avoid::maneuver_speed(speed_max, turn);
        assert!(law::maneuver_speed_in_range(speed.get(), speed_max.get()));
    }

    let (goal, customer) = (bytes.truth(), bytes.truth());
    let arrival = avoid::arrival(distance, contact, goal, customer);
    assert!(law::arrived_only_at_goal(
        arrival == Arrival::Arrived,
        goal,
        customer
    ));
}

fn any_trend(bytes: &mut Bytes) -> Trend {
    [
        Trend::Closing,
        Trend::Steady,
        Trend::Receding,
        Trend::Unknown,
    ][usize::from(bytes.u8() % 4)]
}

/// M1 through any sequence of situations, each of which lasts for three steps.
fn modes(config: &Config, bytes: &mut Bytes) {
    let start = [
        Mode::Cruise,
        Mode::Maneuver,
        Mode::Reorient,
        Mode::Stop,
        Mode::Arrived,
    ];
    let mut mode = start[usize::from(bytes.u8() % 5)];
    for _ in 0..VIEWS {
        if bytes.is_empty() {
            break;
        }
        let flags = bytes.u8();
        let situation = Situation {
            distance: (flags & 1 == 0).then(|| bytes.length()),
            trend: any_trend(bytes),
            guard: flags & 2 != 0,
            corridor_free: flags & 4 != 0,
            aligned: flags & 8 != 0,
            at_goal: flags & 0xF0 == 0xF0,
        };
        let first = avoid::next_mode(mode, &situation, config);
        let second = avoid::next_mode(first, &situation, config);
        let third = avoid::next_mode(second, &situation, config);
        assert!(law::settled(second, third));
        assert!(law::stop_dominates(situation.guard, first.at_rest()));
        mode = third;
    }
}

fn any_obstacle(bytes: &mut Bytes) -> Obstacle {
    Obstacle {
        distance: bytes.length(),
        contact_range: i32::from(bytes.u16() as i16),
        direction: bytes.angle(),
        position: any_point(bytes),
        trend: any_trend(bytes),
        speed: ObstacleSpeed {
            value: bytes.speed(),
            saturated: bytes.truth(),
        },
        visible: bytes.truth(),
        seen_now: bytes.truth(),
    }
}

/// A point that odometry can give.
fn any_point(bytes: &mut Bytes) -> Vector2<f32> {
    let mut coordinate = || {
        let number = bytes.number();
        if number.is_nan() {
            0.0
        } else {
            number.clamp(-1e4, 1e4)
        }
    };
    Vector2::new(coordinate(), coordinate())
}

/// Nothing within 5 m.
const NOTHING: Hazard = Hazard {
    range: 5_000,
    clearance: 5_000,
    age: 0,
    way: [0; 2],
    turned: 0,
    class: Class::Unknown,
    too_fast: false,
    stuck: false,
};

/// S1's law, shown any views one after the other.
fn advice(config: &Config, bytes: &mut Bytes) {
    let mut avoid = Avoid::new(*config);
    for _ in 0..VIEWS {
        if bytes.is_empty() {
            break;
        }
        let flags = bytes.u8();
        let guard = (flags & 3 == 3).then_some(StopReason::Operator);
        let view = View::<3> {
            now: Instant(bytes.u64()),
            pose: Pose {
                position: any_point(bytes),
                heading: bytes.angle(),
            },
            speed: bytes.speed().get(),
            turn_rate: 0.0,
            odometry_age: 0,
            goal: GoalView {
                heading: bytes.angle(),
                distance: bytes.length().get(),
            },
            // The law asks neither for single readings nor for the status of the base.
            sonar: [SonarReading::NoEcho(Length::MAX); 3],
            hazard: [NOTHING; 3],
            obstacle: (flags & 4 == 0).then(|| any_obstacle(bytes)),
            ahead: bytes.length(),
            room: [bytes.length(), bytes.length()],
            beside: [bytes.length(), bytes.length()],
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
            guard,
        };
        let advice = avoid.advise(&view);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            config.speed_max,
            config.turn_rate_max
        ));
        assert!(law::stop_dominates(guard.is_some(), advice.speed == 0.0));
        assert!(law::stop_dominates(
            guard.is_some(),
            avoid.current().at_rest()
        ));
        assert!(!Law::<3>::mode(&avoid).is_empty());
    }
}

/// The differential drive.
fn kinematics(bytes: &mut Bytes) {
    let (speed, heading) = (bytes.speed(), bytes.angle());
    let plane = velocity(speed.get(), heading);
    assert!(drive::finite(plane.x, plane.y));

    let (radius, base) = (bytes.number(), bytes.number());
    let before = Twist {
        speed: bytes.number(),
        turn_rate: bytes.number(),
    };
    if let Ok(robot) = DifferentialDrive::new(radius, base)
        && let Ok(wheels) = robot.wheel_rates(before)
    {
        assert!(drive::finite(wheels.right, wheels.left));
        if let Ok(after) = robot.twist(wheels) {
            // Speed and turn share the wheels, so each is as exact as both together are large.
            let rim = before.turn_rate.abs() * base;
            let scale = before.speed.abs() + rim;
            assert!(drive::round_trip(before.speed, after.speed, scale));
            assert!(drive::round_trip(
                before.turn_rate,
                after.turn_rate,
                scale / base
            ));
        }
    }

    let wheels = WheelRates {
        right: bytes.number(),
        left: bytes.number(),
    };
    let swapped = WheelRates {
        right: wheels.left,
        left: wheels.right,
    };
    if let Ok(robot) = DifferentialDrive::new(0.0975, 0.33)
        && let (Ok(twist), Ok(mirror)) = (robot.twist(wheels), robot.twist(swapped))
    {
        assert!(drive::finite(twist.speed, twist.turn_rate));
        assert!(drive::swap_mirrors(
            twist.speed,
            twist.turn_rate,
            mirror.speed,
            mirror.turn_rate
        ));
    }
    let limit = bytes.number();
    if let Ok(limited) = wheels.limited(limit) {
        assert!(drive::wheels_within(limited.right, limited.left, limit));
        assert!(drive::limited_keeps_direction(wheels.right, limited.right));
        assert!(drive::limited_keeps_direction(wheels.left, limited.left));
    }
}
