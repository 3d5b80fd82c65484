//! The drive keeps its limits, brakes as physics has it, and counts what it does.

use core::f64::consts::{FRAC_PI_2, PI};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sidestep_sim::base::{Activity, Base, Effort, Faults, Limits, Order, Parameters};
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::{STEP, World};

fn base(parameters: Parameters) -> Base {
    Base::new(parameters, Pose::new(0.0, 0.0, 0.0)).unwrap()
}

fn prompt() -> Parameters {
    Parameters {
        delay_ms: 0,
        ..Parameters::default()
    }
}

fn run(base: &mut Base, seconds: f64) {
    let world = World::new();
    for _ in 0..(seconds / STEP).round() as usize {
        base.step(&world);
    }
}

#[test]
fn braking_takes_v_squared_over_2b() {
    for (speed, deceleration) in [(0.2, 0.3), (0.4, 0.3), (0.75, 1.1), (1.0, 0.25)] {
        let mut base = base(prompt());
        let limits = Limits {
            deceleration,
            ..*base.limits()
        };
        base.set_limits(limits).unwrap();
        base.order(Order::Speed(speed));
        run(&mut base, 10.0);
        assert_eq!(base.speed(), speed);
        let from = base.pose().position.x;
        base.order(Order::Stop);
        run(&mut base, 10.0);
        assert_eq!(base.speed(), 0.0);
        let way = base.pose().position.x - from;
        assert!(
            (way - speed * speed / (2.0 * deceleration)).abs() < 1e-9,
            "{way}"
        );
    }
}

#[test]
fn an_emergency_stop_brakes_as_hard_as_the_motors_can() {
    let mut base = base(prompt());
    base.order(Order::Speed(1.0));
    run(&mut base, 5.0);
    let from = base.pose().position.x;
    base.order(Order::EmergencyStop);
    run(&mut base, 2.0);
    assert!((base.pose().position.x - from - 1.0 / (2.0 * 2.0)).abs() < 1e-9);
    // The next order obeys the ordinary limits again.
    base.order(Order::Speed(1.0));
    run(&mut base, 1.0);
    assert!((base.speed() - 0.3).abs() < 1e-9);
}

#[test]
fn orders_take_effect_after_the_delay() {
    let mut base = base(Parameters {
        delay_ms: 120,
        ..Parameters::default()
    });
    base.order(Order::Speed(0.5));
    run(&mut base, 0.12);
    assert_eq!(base.speed(), 0.0);
    run(&mut base, 0.01);
    assert!((base.speed() - 0.003).abs() < 1e-12);
}

#[test]
fn no_sequence_of_orders_breaks_a_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut base = base(Parameters::default());
    let world = World::new();
    let limits = *base.limits();
    let top = base.parameters().top;
    let mut before = (0.0, 0.0);
    let mut emergency_until = 0;
    for step in 0..200_000 {
        if rng.random_bool(0.02) {
            let x = rng.random_range(-5.0..5.0);
            let order = match rng.random_range(0..7) {
                0 => Order::Speed(x),
                1 => Order::Distance(x),
                2 => Order::TurnRate(x),
                3 => Order::Heading(x),
                4 => Order::Turn(x),
                5 => Order::Stop,
                _ => Order::EmergencyStop,
            };
            base.order(order);
            emergency_until = step + 1000;
        }
        let place = base.pose().position;
        base.step(&world);
        let (speed, turn_rate) = (base.speed(), base.turn_rate());
        assert!(speed.abs() <= limits.speed && turn_rate.abs() <= limits.turn_rate);
        // Slowing down may be as fast as an emergency stop, speeding up never faster than asked
        // for.
        let slowing = if step < emergency_until { top } else { limits };
        let rate = |now: f64, then: f64, up: f64, down: f64| {
            let allowed = if now.abs() < then.abs() || now * then < 0.0 {
                down.max(up)
            } else {
                up
            };
            (now - then).abs() <= allowed * STEP + 1e-9
        };
        assert!(rate(
            speed,
            before.0,
            limits.acceleration,
            slowing.deceleration
        ));
        assert!(rate(
            turn_rate,
            before.1,
            limits.turn_acceleration,
            slowing.turn_deceleration
        ));
        let fastest = speed.abs().max(before.0);
        assert!(
            (base.pose().position - place).norm() <= fastest.max(f64::abs(before.0)) * STEP + 1e-9
        );
        before = (speed, turn_rate);
    }
}

#[test]
fn distances_and_headings_are_reached_without_overshoot() {
    let mut driven = base(prompt());
    driven.order(Order::Distance(0.5));
    let mut farthest: f64 = 0.0;
    for _ in 0..60 {
        run(&mut driven, 0.1);
        farthest = farthest.max(driven.pose().position.x);
    }
    assert!(
        (driven.pose().position.x - 0.5).abs() < 1e-4,
        "{}",
        driven.pose().position.x
    );
    assert!(farthest < 0.501, "{farthest}");
    assert!(driven.speed().abs() < 1e-6, "{}", driven.speed());

    for (heading, reached) in [(FRAC_PI_2, FRAC_PI_2), (-3.0, -3.0), (3.5, 3.5 - 2.0 * PI)] {
        let mut turned = base(prompt());
        turned.order(Order::Heading(heading));
        run(&mut turned, 10.0);
        assert!(
            (turned.pose().heading - reached).abs() < 1e-4,
            "{}",
            turned.pose().heading
        );
        turned.order(Order::Turn(0.5));
        run(&mut turned, 5.0);
        let expected = sidestep_sim::geometry::wrap(reached + 0.5);
        assert!((turned.pose().heading - expected).abs() < 1e-4);
    }
}

#[test]
fn limits_are_cut_to_what_the_motors_can_do() {
    let mut base = base(prompt());
    let top = base.parameters().top;
    let beyond = Limits {
        speed: 10.0,
        turn_rate: 10.0,
        acceleration: 10.0,
        deceleration: 10.0,
        turn_acceleration: 10.0,
        turn_deceleration: 10.0,
    };
    base.set_limits(beyond).unwrap();
    assert_eq!(*base.limits(), top);
    assert!(base.set_limits(Limits { speed: 0.0, ..top }).is_err());
    assert_eq!(*base.limits(), top);
}

#[test]
fn a_circle_closes() {
    let mut base = base(prompt());
    let top = base.parameters().top;
    base.set_limits(top).unwrap();
    base.order(Order::Speed(0.5));
    base.order(Order::TurnRate(0.5));
    run(&mut base, 1.0);
    // Radius v/ω = 1 m: the centre is 1 m to the left.
    let from = base.pose();
    let left = sidestep_sim::geometry::direction(from.heading + FRAC_PI_2);
    let centre = from.position + left;
    for _ in 0..10 {
        run(&mut base, 1.0);
        assert!(((base.pose().position - centre).norm() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn odometry_drifts_as_asked_for() {
    let mut base = base(Parameters {
        odometry_scale: 1.02,
        odometry_turn_scale: 0.9,
        ..prompt()
    });
    base.order(Order::Distance(1.0));
    run(&mut base, 10.0);
    assert!((base.odometry().position.x - 1.02).abs() < 1e-4);
    base.order(Order::Heading(0.9));
    run(&mut base, 10.0);
    assert!((base.pose().heading - 1.0).abs() < 1e-4);
    base.reset_odometry();
    assert_eq!(base.odometry(), Pose::new(0.0, 0.0, 0.0));
}

#[test]
fn a_hull_stalls_at_a_wall() {
    let mut world = World::new();
    world
        .add_wall(Point::new(1.0, -5.0), Point::new(1.0, 5.0))
        .unwrap();
    let mut base = base(prompt());
    base.order(Order::Speed(0.5));
    for _ in 0..500 {
        base.step(&world);
    }
    assert!(base.stalled());
    assert_eq!(base.speed(), 0.0);
    assert_eq!(base.activity(), Activity::Resting);
    let depth = base.pose().position.x + base.parameters().radius - 1.0;
    assert!((0.0..0.5 * STEP).contains(&depth), "{depth}");
    // Away from the wall is free.
    base.order(Order::Speed(-0.2));
    for _ in 0..300 {
        base.step(&world);
    }
    assert!(!base.stalled() && base.speed() == -0.2);
}

#[test]
fn turning_in_place_is_neither_rest_nor_driving() {
    let mut base = base(prompt());
    base.order(Order::TurnRate(1.0));
    run(&mut base, 1.0);
    assert_eq!(base.activity(), Activity::Turning);
    assert!(base.footprint().still);
    base.order(Order::Speed(0.2));
    run(&mut base, 1.0);
    assert_eq!(base.activity(), Activity::Driving);
    assert!(!base.footprint().still);
    base.order(Order::Stop);
    // A step in which it comes to rest was driven.
    while base.speed() > 0.0 {
        run(&mut base, STEP);
    }
    assert_eq!(base.activity(), Activity::Driving);
    run(&mut base, 2.0);
    assert_eq!(base.activity(), Activity::Resting);
}

#[test]
fn what_cannot_be_is_refused_or_ignored() {
    for parameters in [
        Parameters {
            radius: 0.0,
            ..prompt()
        },
        Parameters {
            odometry_scale: f64::NAN,
            ..prompt()
        },
        Parameters {
            top: Limits {
                deceleration: 0.0,
                ..prompt().top
            },
            ..prompt()
        },
    ] {
        assert!(Base::new(parameters, Pose::new(0.0, 0.0, 0.0)).is_err());
    }
    assert!(Base::new(prompt(), Pose::new(f64::NAN, 0.0, 0.0)).is_err());
    let mut base = base(prompt());
    base.order(Order::Speed(f64::NAN));
    base.order(Order::Heading(f64::INFINITY));
    run(&mut base, 1.0);
    assert_eq!(base.pose(), Pose::new(0.0, 0.0, 0.0));
}

#[test]
fn a_faulty_drive_brakes_and_speeds_up_by_its_share() {
    for (braking_share, acceleration_share) in [(0.5, 1.0), (0.2, 2.0), (1.5, 0.7)] {
        let mut base = base(prompt());
        let faults = Faults {
            braking_share,
            acceleration_share,
        };
        base.set_faults(faults).unwrap();
        assert_eq!(base.effort(), Effort::default());
        let (speed, set) = (0.4, *base.limits());
        base.order(Order::Speed(speed));
        run(&mut base, 0.5);
        let acceleration = set.acceleration * acceleration_share;
        assert_eq!(base.effort().accelerating, Some(acceleration));
        assert!((base.speed() - (acceleration * 0.5).min(speed)).abs() < 1e-9);
        run(&mut base, 5.0);
        assert_eq!(base.effort(), Effort::default());
        let from = base.pose().position.x;
        base.order(Order::Stop);
        run(&mut base, 0.1);
        let braking = set.deceleration * braking_share;
        assert_eq!(base.effort().braking, Some(braking));
        run(&mut base, 20.0);
        let way = base.pose().position.x - from;
        assert!(
            (way - speed * speed / (2.0 * braking)).abs() < 1e-9,
            "{way}"
        );
    }
    let mut base = base(prompt());
    for share in [0.0, -1.0, 11.0, f64::NAN] {
        for faults in [
            Faults {
                braking_share: share,
                ..Faults::default()
            },
            Faults {
                acceleration_share: share,
                ..Faults::default()
            },
        ] {
            assert!(base.set_faults(faults).is_err());
        }
    }
}
