//! Chapter `kinematics`: the differential drive.

mod common;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use common::{any_f32, between};
use proptest::prelude::*;
use sidestep::kinematics::{DifferentialDrive, Twist, WheelRates, velocity};
use sidestep::quantity::Angle;
use sidestep_spec::kinematics as law;
use std::f32::consts::PI;

/// Any drive there is, with its radius and base.
fn any_drive() -> impl Strategy<Value = (DifferentialDrive, f32, f32)> {
    (between(0.005, 1.0), between(0.02, 3.0)).prop_map(|(radius, base)| {
        let drive = DifferentialDrive::new(radius, base).expect("in range");
        (drive, radius, base)
    })
}

/// Any motion that a drive takes.
fn any_twist() -> impl Strategy<Value = Twist> {
    (between(-10.0, 10.0), between(-20.0, 20.0))
        .prop_map(|(speed, turn_rate)| Twist { speed, turn_rate })
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// Both wheels carry speed and turn, so each of the two is as exact as both together are
    /// large: that is the scale.
    //= kinematics.INV-1
    #[test]
    fn wheels_and_back((drive, _, base) in any_drive(), before in any_twist()) {
        let wheels = drive.wheel_rates(before).expect("in range");
        // Small wheels cannot turn fast enough for every motion.
        prop_assume!(wheels.right.abs() <= 1e3 && wheels.left.abs() <= 1e3);
        let after = drive.twist(wheels).expect("in range");
        let scale = before.speed.abs() + before.turn_rate.abs() * base;
        prop_assert!(law::round_trip(before.speed, after.speed, scale));
        prop_assert!(law::round_trip(before.turn_rate, after.turn_rate, scale / base));
    }

    //= kinematics.INV-2
    #[test]
    fn swapping_the_wheels_mirrors(
        (drive, _, _) in any_drive(),
        right in between(-1e3, 1e3),
        left in between(-1e3, 1e3),
    ) {
        let twist = drive.twist(WheelRates { right, left }).expect("in range");
        let swapped = drive.twist(WheelRates { right: left, left: right }).expect("in range");
        prop_assert!(law::swap_mirrors(
            twist.speed, twist.turn_rate, swapped.speed, swapped.turn_rate
        ));
    }

    //= kinematics.INV-3
    //= kinematics.INV-4
    #[test]
    fn wheels_are_limited(right in any_f32(), left in any_f32(), limit in any_f32()) {
        if let Ok(limited) = (WheelRates { right, left }).limited(limit) {
            prop_assert!(law::wheels_within(limited.right, limited.left, limit));
            prop_assert!(law::limited_keeps_direction(right, limited.right));
            prop_assert!(law::limited_keeps_direction(left, limited.left));
        }
    }

    /// Limiting bends no path: the wheels keep their ratio.
    //= kinematics.INV-4
    #[test]
    fn limiting_keeps_the_curvature(
        right in between(-1e4, 1e4),
        left in between(-1e4, 1e4),
        limit in 0.1_f32..1e3,
    ) {
        let limited = WheelRates { right, left }.limited(limit).expect("in range");
        let fastest = right.abs().max(left.abs());
        // The cross product of two parallel vectors is zero, up to the rounding of its two terms.
        let [r, l, lr, ll] = [right, left, limited.right, limited.left].map(f64::from);
        assert_abs_diff_eq!(r * ll, l * lr, epsilon = 4e-7 * f64::from(fastest * limit));
        if fastest <= limit {
            prop_assert_eq!((limited.right, limited.left), (right, left));
        }
    }

    /// Any bit pattern gives finite numbers or an error that names what was wrong.
    //= kinematics.INV-5
    #[test]
    fn conversions_are_finite_or_refused(
        drive in [any_f32(), any_f32()],
        motion in [any_f32(), any_f32()],
    ) {
        let drive = match DifferentialDrive::new(drive[0], drive[1]) {
            Ok(drive) => drive,
            Err(refused) => {
                prop_assert!(["wheel_radius", "wheel_base"].contains(&refused.field));
                return Ok(());
            }
        };
        match drive.wheel_rates(Twist { speed: motion[0], turn_rate: motion[1] }) {
            Ok(wheels) => prop_assert!(law::finite(wheels.right, wheels.left)),
            Err(refused) => prop_assert!(["speed", "turn rate"].contains(&refused.field)),
        }
        match drive.twist(WheelRates { right: motion[0], left: motion[1] }) {
            Ok(twist) => prop_assert!(law::finite(twist.speed, twist.turn_rate)),
            Err(refused) => {
                prop_assert!(["right wheel rate", "left wheel rate"].contains(&refused.field));
            }
        }
    }

    /// S2.E5 and the yaw relation, against the reference. The tolerance is a few units in the last
    /// place of the terms, not of their difference, which may cancel.
    #[test]
    fn twist_is_the_reference(
        (drive, radius, base) in any_drive(),
        right in between(-1e3, 1e3),
        left in between(-1e3, 1e3),
    ) {
        let twist = drive.twist(WheelRates { right, left }).expect("in range");
        let [radius, base, right, left] = [radius, base, right, left].map(f64::from);
        let scale = 5e-7 * radius * (right.abs() + left.abs());
        let speed = law::e5(radius, right, left);
        assert_abs_diff_eq!(f64::from(twist.speed), speed, epsilon = scale);
        let yaw = law::yaw(radius, base, right, left);
        assert_abs_diff_eq!(f64::from(twist.turn_rate), yaw, epsilon = scale / base);
    }

    /// S2.E1 and E2, against the reference; the robot does not move sideways, and is as fast as
    /// its speed.
    #[test]
    fn velocity_is_the_reference(speed in between(-10.0, 10.0), heading in -PI..PI) {
        let found = velocity(speed, Angle::radians(heading).expect("an angle"));
        let heading_deg = f64::from(heading).to_degrees();
        let (x, y, _) = law::e1_e3(f64::from(speed), heading_deg, 0.0);
        let rounding = 3e-7 * (f64::from(speed).abs() + 1e-6);
        assert_abs_diff_eq!(f64::from(found.x), x, epsilon = rounding);
        assert_abs_diff_eq!(f64::from(found.y), y, epsilon = rounding);
        assert_relative_eq!(found.x.hypot(found.y), speed.abs(), max_relative = 1e-6, epsilon = 1e-12);
        let sideways = found.x * heading.sin() - found.y * heading.cos();
        assert_abs_diff_eq!(sideways, 0.0, epsilon = 3e-6);
    }
}
