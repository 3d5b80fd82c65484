//! Chapter `avoid`: S1's equations, its mode machine, and the law as a whole.

mod common;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use common::{
    angle, any_f32, config, in_order, length, settings, sighting, speed, trend, usable_sighting,
    usual_or_any_config, view,
};
use proptest::prelude::*;
use proptest::sample::select;
use sidestep::avoid::{
    self, Arrival, Avoid, Mode, ObstacleSpeed, QuarterTurns, Side, Situation, Trend,
};
use sidestep::config::{Config, Parameters};
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::math;
use sidestep::observation::Sighting;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::track::Obstacle;
use sidestep::view::{Memory, View};
use sidestep_spec::avoid as law;
use std::f32::consts::{FRAC_PI_2, PI};

fn metres(metres: f32) -> Length {
    Length::metres(metres).expect("a length")
}

fn radians(radians: f32) -> Angle {
    Angle::radians(radians).expect("an angle")
}

fn metres_per_second(speed: f32) -> Speed {
    Speed::metres_per_second(speed).expect("a speed")
}

fn centimetres(metres: f32) -> f64 {
    100.0 * f64::from(metres)
}

fn degrees(angle: f32) -> f64 {
    f64::from(angle).to_degrees()
}

fn s1() -> Config {
    Config::new(preset::SRIKANDI_II_2012).expect("the preset is good")
}

/// Two directions are the same, up to `tolerance` radians.
fn same_direction(found: f32, expected: f64, tolerance: f64) -> bool {
    law::wrap(f64::from(found) - expected).abs() <= tolerance
}

// ------------------------------------------------------------- the equations

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// S1.E1 is as printed, wrapped, with the measured bearing for the camera's half angle.
    #[test]
    fn obstacle_robot_angle_is_the_reference(heading in angle(), bearing in angle()) {
        let found = avoid::obstacle_robot_angle(heading, bearing).get();
        prop_assert!(law::angle_in_range(found));
        let printed = law::e1_printed(degrees(heading.get()), degrees(bearing.get()));
        prop_assert!(same_direction(found, printed.to_radians(), 2e-6));
    }

    //= avoid.INV-1
    //= avoid.INV-3
    #[test]
    fn obstacle_speed_is_clamped_for_any_bits(
        sighting in sighting(), own in speed(), heading in angle(), speed_max in speed(),
    ) {
        let estimate = avoid::obstacle_speed(&sighting, own, heading, speed_max);
        prop_assert!(law::obstacle_speed_in_range(estimate.value.get(), speed_max.get()));
        let usable = sighting.displacement >= 0.0
            && sighting.scale >= 0.0
            && sighting.interval > 0.0
            && (0.0..=std::f32::consts::FRAC_PI_3).contains(&sighting.direction);
        prop_assert!(
            usable || law::unusable_is_fastest(
                estimate.value.get(), estimate.saturated, speed_max.get()
            )
        );
    }

    /// What is refused is named.
    //= avoid.INV-3
    #[test]
    fn unusable_terms_are_named(sighting in sighting(), own in speed(), heading in angle()) {
        if let Err(refused) = avoid::lateral_speed(&sighting, own, heading) {
            let (name, value) = match refused.field {
                "displacement" => ("displacement", sighting.displacement),
                "scale" => ("scale", sighting.scale),
                name => (name, sighting.interval),
            };
            prop_assert!(["displacement", "scale", "interval"].contains(&name));
            prop_assert_eq!(refused.value.to_bits(), value.to_bits());
            prop_assert!(!(refused.min..=refused.max).contains(&value));
        }
    }

    /// S1.E3 as read is never below S1.E3 as printed, cap included, wherever the printed one is a
    /// speed. In f32, for the same terms, without any tolerance: adding |own| in place of own,
    /// dividing by the same cosine and capping are monotone, and so is their rounding.
    //= avoid.INV-2
    #[test]
    fn obstacle_speed_is_not_below_printed(
        sighting in usable_sighting(), own in speed(), heading in angle(), speed_max in speed(),
    ) {
        let seen = sighting.displacement * sighting.scale / sighting.interval;
        let share = own.get() * math::cos(heading.get());
        let bound = avoid::lateral_speed(&sighting, own, heading).expect("usable");
        prop_assert!(law::not_below_printed(bound, seen, share));

        let found = avoid::obstacle_speed(&sighting, own, heading, speed_max).value.get();
        let printed = ((seen + share) / math::cos(sighting.direction)).min(speed_max.get());
        prop_assert!(found >= printed, "{found} < {printed}");
    }

    /// The same against the printed formula in f64. Here the terms are rounded too: six roundings
    /// of terms that are all positive, hence the one part in a million.
    //= avoid.INV-2
    #[test]
    fn obstacle_speed_is_the_reference(
        sighting in usable_sighting(), own in speed(), heading in angle(), speed_max in speed(),
    ) {
        let estimate = avoid::obstacle_speed(&sighting, own, heading, speed_max);
        let found = centimetres(estimate.value.get());
        // The f32 next to 60° is a little more than 60°, where the reference has left the branch.
        let direction = degrees(sighting.direction).min(60.0);
        let terms = (
            f64::from(sighting.displacement),
            centimetres(sighting.scale),
            f64::from(sighting.interval),
            direction,
            centimetres(own.get()),
            degrees(heading.get()),
            centimetres(speed_max.get()),
        );
        let (dp, s, t, direction, v, heading, max) = terms;
        let (expected, saturated) = law::e3(dp, s, t, direction, v, heading, max);
        let on_the_cap = (expected - max).abs() <= 1e-6 * max;
        prop_assert!(estimate.saturated == saturated || on_the_cap);
        // Beyond 10 m/s the core has no speeds, but then it has no v_o,max either.
        assert_relative_eq!(found, expected, max_relative = 1e-6, epsilon = 1e-9);
        let printed = law::e3_printed(dp, s, t, direction, v, heading, max);
        prop_assert!(printed < 0.0 || found >= printed * (1.0 - 1e-6));
    }

    //= avoid.INV-4
    #[test]
    fn times_are_times(
        distances in [length(), length()], directions in [angle(), angle(), angle()],
        speeds in [speed(), speed()],
    ) {
        let time = avoid::time_to_collision(
            distances[0], directions[0], directions[1], speeds[0], speeds[1], directions[2],
        );
        prop_assert!(law::is_time(time));
        let bound = avoid::contact_time_bound(distances[0], distances[1], speeds[0], speeds[1]);
        prop_assert!(law::is_time(bound));
    }

    /// S1.E4 in both readings, against the reference. The sines are exact to a unit in the last
    /// place, so the numerator is off by that much of the distance even where it should be zero.
    //= avoid.INV-4
    #[test]
    fn times_are_the_reference(
        distances in [length(), length()], directions in [angle(), angle(), angle()],
        speeds in [speed(), speed()],
    ) {
        let [distance, contact] = distances;
        let [heading, half_angle, direction] = directions;
        let [own, other] = speeds;
        let time = avoid::time_to_collision(distance, heading, half_angle, own, other, direction);
        let expected = law::e4(
            centimetres(distance.get()),
            degrees(heading.get()),
            degrees(half_angle.get()).abs(),
            centimetres(own.get()),
            centimetres(other.get()),
            degrees(direction.get()),
        );
        let closing = f64::from(own.get()) * f64::from(heading.get()).sin().abs()
            + f64::from(other.get()) * f64::from(direction.get()).sin().abs();
        match time {
            Some(time) => assert_abs_diff_eq!(
                f64::from(time),
                expected,
                epsilon = 4e-7 * f64::from(distance.get()) / closing + 1e-6 * expected
            ),
            None => prop_assert!(closing < 1e-30, "never, but {expected} s"),
        }

        let bound = avoid::contact_time_bound(distance, contact, own, other);
        let (expected, _) = law::e4_bound(
            centimetres(distance.get()),
            centimetres(contact.get()),
            centimetres(own.get()),
            centimetres(other.get()),
            1.0,
        );
        match bound {
            Some(bound) => {
                assert_relative_eq!(f64::from(bound), expected, max_relative = 1e-6);
            }
            None => prop_assert!(expected > f64::from(f32::MAX)),
        }
    }

    /// The bound on the time to contact falls with nearness and with either speed. Exactly: the
    /// rounding of a difference, a sum and a quotient is monotone.
    #[test]
    fn contact_time_is_monotone(
        near in length(), far in length(), contact in length(),
        slow in speed(), fast in speed(), other in speed(),
    ) {
        let bound = |distance: Length, own: Speed, other: Speed| {
            avoid::contact_time_bound(distance, contact, own, other).unwrap_or(f32::INFINITY)
        };
        let (near, far) = (near.min(far), if near < far { far } else { near });
        let (slow, fast) = (slow.min(fast), if slow < fast { fast } else { slow });
        prop_assert!(bound(near, slow, other) <= bound(far, slow, other));
        prop_assert!(bound(near, fast, other) <= bound(near, slow, other));
        prop_assert!(bound(near, other, fast) <= bound(near, other, slow));
        // What is on contact has no time left, unless nobody moves.
        let on_contact = avoid::contact_time_bound(contact, contact, slow, other);
        prop_assert!(on_contact.is_none_or(|time| time == 0.0));
    }

    //= avoid.INV-6
    #[test]
    fn turn_is_at_most_half(distance in length(), reach in length(), radians in any_f32()) {
        let turn = QuarterTurns::at_distance(distance, reach);
        prop_assert!(law::turn_in_range(turn.get()));
        if let Ok(turn) = QuarterTurns::of_angle(radians) {
            prop_assert!(law::turn_in_range(turn.get()));
            let wrong = f64::from(turn.angle().get()) - f64::from(radians.abs().min(PI));
            prop_assert!(wrong.abs() <= 1e-6);
        }
    }

    /// S1.E5: the nearer, the greater the turn; strictly, up to the clamp at half a turn, for
    /// distances that differ by more than the quotient is rounded.
    //= avoid.INV-6
    #[test]
    fn turn_falls_with_distance(near in length(), farther in 0.0_f32..2.0, reach in length()) {
        let far = near.get() * (1.0 + farther);
        prop_assume!(far <= 1000.0);
        let turn = |distance: f32| QuarterTurns::at_distance(metres(distance), reach).get();
        prop_assert!(turn(far) <= turn(near.get()));
        let free = turn(near.get()) < 2.0 && turn(far) > f32::MIN_POSITIVE;
        if farther > 1e-6 && free {
            prop_assert!(turn(far) < turn(near.get()));
        }
    }

    //= avoid.INV-7
    //= avoid.INV-8
    #[test]
    fn maneuver_turns_away(
        reference in angle(), bearing in angle(), room in [length(), length()],
        distance in length(), reach in length(),
    ) {
        let turn = QuarterTurns::at_distance(distance, reach);
        let side = Side::away_from(bearing, room[0], room[1]);
        let signed = if side == Side::Left { turn.get() } else { -turn.get() };
        prop_assert!(law::turns_away(signed, bearing.get()));
        let heading = avoid::maneuver_heading(reference, side, turn).get();
        prop_assert!(law::angle_in_range(heading));

        // Straight ahead it is the side with more room; the reference knows of no room.
        if bearing == Angle::ZERO {
            prop_assert_eq!(side == Side::Left, room[0] >= room[1]);
        } else {
            let (expected_turn, sign, expected) = law::e5(
                centimetres(distance.get()),
                centimetres(reach.get()),
                f64::from(reference.get()),
                f64::from(bearing.get()),
            );
            assert_abs_diff_eq!(f64::from(turn.angle().get()), expected_turn, epsilon = 1e-6);
            prop_assert_eq!(f64::from(signed.signum()), if turn.get() == 0.0 {
                f64::from(signed.signum())
            } else {
                sign
            });
            prop_assert!(same_direction(heading, expected, 2e-6));
        }
    }

    /// The two sides are mirror images: θ_m(σ) − θ_ref = −(θ_m(−σ) − θ_ref).
    //= avoid.INV-8
    #[test]
    fn sides_are_mirror_images(reference in angle(), radians in 0.0_f32..PI) {
        let turn = QuarterTurns::of_angle(radians).expect("a turn");
        let left = avoid::maneuver_heading(reference, Side::Left, turn).minus(reference);
        let right = avoid::maneuver_heading(reference, Side::Right, turn).minus(reference);
        prop_assert!(same_direction(left.get(), -f64::from(right.get()), 2e-6));
        prop_assert!(same_direction(left.get(), f64::from(radians), 2e-6));
    }

    //= avoid.INV-9
    #[test]
    fn maneuver_speed_is_bounded(
        speed_max in speed(), distance in length(), reach in length(), radians in -1e3_f32..1e3,
    ) {
        let turns = [
            QuarterTurns::at_distance(distance, reach),
            QuarterTurns::of_angle(radians).expect("a turn"),
        ];
        for turn in turns {
            let speed = avoid::maneuver_speed(speed_max, turn).get();
            prop_assert!(law::maneuver_speed_in_range(speed, speed_max.get()));
            let angle = f64::from(turn.get()) * std::f64::consts::FRAC_PI_2;
            let expected = law::e7(angle, centimetres(speed_max.get()));
            assert_relative_eq!(centimetres(speed), expected, max_relative = 1e-6);
        }
    }

    /// S1.E7 with E5 is rational in the distance: ½ + k/2d for d ≥ k, 3/2 − k/2d for d ≤ k.
    //= avoid.INV-9
    #[test]
    fn maneuver_speed_is_rational(
        speed_max in speed(), reach in 0.01_f32..5.0, quotient in 0.5_f32..20.0,
    ) {
        let distance = metres(reach * quotient);
        let turn = QuarterTurns::at_distance(distance, metres(reach));
        let found = f64::from(avoid::maneuver_speed(speed_max, turn).get());
        let half = f64::from(reach) / (2.0 * f64::from(distance.get()));
        let share = if half <= 0.5 { 0.5 + half } else { 1.5 - half };
        let expected = f64::from(speed_max.get()) * share;
        assert_relative_eq!(found, expected, max_relative = 1e-6);
    }

    /// S1.E7 rises up to the quarter turn, falls beyond it, alike on both sides, and changes by no
    /// more than v_max/π per radian, that is v_max/2 per quarter turn. Up to one rounding of a
    /// speed.
    //= avoid.INV-9
    #[test]
    fn maneuver_speed_is_a_tent(speed_max in speed(), a in 0.0_f32..=1.0, b in 0.0_f32..=1.0) {
        let at = |quarters: f32| {
            let turn = QuarterTurns::of_angle(quarters * FRAC_PI_2).expect("a turn");
            avoid::maneuver_speed(speed_max, turn).get()
        };
        let rounding = 3e-7 * speed_max.get();
        let (less, more) = (a.min(b), a.max(b));
        prop_assert!(at(less) <= at(more) + rounding);
        prop_assert!(at(2.0 - less) <= at(2.0 - more) + rounding);
        prop_assert!((at(1.0 - a) - at(1.0 + a)).abs() <= rounding);
        for (x, y) in [(a, b), (a, 1.0 + b), (1.0 + a, 1.0 + b)] {
            let slope = speed_max.get() / 2.0;
            prop_assert!((at(x) - at(y)).abs() <= slope * (x - y).abs() + rounding);
        }
        prop_assert!((at(1.0) - speed_max.get()).abs() <= rounding);
    }

    //= avoid.INV-14
    #[test]
    fn image_direction_is_folded(orientation in prop_oneof![any_f32(), 0.0_f32..6.3]) {
        match avoid::image_direction(orientation) {
            Ok((folded, approaching)) => {
                prop_assert!(law::folded_in_range(folded));
                let (_, expected, expected_approaching) = law::a3(degrees(orientation));
                assert_abs_diff_eq!(f64::from(folded), expected.to_radians(), epsilon = 2e-6);
                // On the horizon itself, a rounding decides between the two.
                let horizon = f64::from(folded) < 1e-6;
                prop_assert!(approaching == expected_approaching || horizon);
            }
            Err(refused) => {
                prop_assert_eq!(refused.field, "global orientation");
                prop_assert!(!(0.0..=std::f32::consts::TAU).contains(&orientation));
            }
        }
    }

    //= avoid.INV-12
    #[test]
    fn arrival_is_not_proximity(
        front in length(), minimum in length(), goal in any::<bool>(), customer in any::<bool>(),
    ) {
        let found = avoid::arrival(front, minimum, goal, customer);
        prop_assert!(law::arrived_only_at_goal(found == Arrival::Arrived, goal, customer));
        let expected = law::a1(
            f64::from(front.get()), f64::from(minimum.get()), goal, customer,
        );
        prop_assert_eq!(format!("{found:?}"), expected);
    }
}

/// A measurement that just reaches v_o,max is saturated (ER-S1-06).
//= avoid.INV-1
#[test]
fn reaching_the_cap_is_saturated() {
    let at = |displacement: f32| {
        let sighting = Sighting {
            displacement,
            scale: 0.1,
            interval: 1.0,
            direction: 0.0,
            taken_at: Instant(0),
        };
        avoid::obstacle_speed(&sighting, Speed::ZERO, Angle::ZERO, metres_per_second(0.8))
    };
    assert!(at(8.0).saturated);
    assert_eq!(at(8.0).value.get(), 0.8);
    assert!(!at(7.999).saturated);
    assert!(at(8.001).saturated);
}

/// The sweep of Table 1: k_θ = 60 cm, θ_ref = 90°, v_max = 40 cm/s (S1) and 30 cm/s (S2).
#[test]
fn table_1_sweep() {
    // d_o in cm; Δθ and θ_m to the left and to the right in degrees; v/v_max; v of S1 and of S2 in
    // cm/s; and to how many digits that is printed.
    let rows = [
        (40.0, 135.0, 225.0, -45.0, 0.75, 30.0, 22.5, 1e-9),
        (60.0, 90.0, 180.0, 0.0, 1.0, 40.0, 30.0, 1e-9),
        (80.0, 67.5, 157.5, 22.5, 0.875, 35.0, 26.25, 1e-9),
        (90.0, 60.0, 150.0, 30.0, 0.8333, 33.33, 25.0, 5e-3),
        (100.0, 54.0, 144.0, 36.0, 0.8, 32.0, 24.0, 1e-9),
        (
            119.9, 45.0375, 135.0375, 44.9625, 0.750209, 30.008, 22.506, 5e-4,
        ),
    ];
    let reach = metres(0.6);
    for (distance, turn, left, right, share, s1, s2, digits) in rows {
        let quarter = std::f64::consts::FRAC_PI_2;
        // As printed, and not wrapped.
        for (right_of_obstacle, heading) in [(true, left), (false, right)] {
            let printed = law::e5_printed(distance, 60.0, quarter, right_of_obstacle);
            assert_abs_diff_eq!(printed.0.to_degrees(), turn, epsilon = digits);
            assert_abs_diff_eq!(printed.1.to_degrees(), heading, epsilon = digits);
            assert_abs_diff_eq!(law::e7_printed(printed.0, 1.0), share, epsilon = digits);
        }
        // The core, to the digits of f32.
        let digits = digits.max(2e-5);
        let found = QuarterTurns::at_distance(metres((distance / 100.0) as f32), reach);
        assert_abs_diff_eq!(degrees(found.angle().get()), turn, epsilon = digits);
        for (side, heading) in [(Side::Left, left), (Side::Right, right)] {
            let found = avoid::maneuver_heading(radians(FRAC_PI_2), side, found).get();
            assert!(same_direction(found, f64::to_radians(heading), 2e-6));
        }
        for (speed_max, speed) in [(0.4, s1), (0.3, s2), (1.0, 100.0 * share)] {
            let found = avoid::maneuver_speed(metres_per_second(speed_max), found);
            let digits = digits.max(100.0 * 5e-5 * f64::from(speed_max >= 1.0));
            assert_abs_diff_eq!(centimetres(found.get()), speed, epsilon = digits);
        }
    }
}

/// What the sweep says of the ends: as printed, E5 passes half a turn and E7 reverses.
#[test]
fn printed_maneuver_leaves_its_range() {
    let printed = |distance| law::e5_printed(distance, 60.0, 0.0, true).0;
    assert!(printed(29.9) > std::f64::consts::PI);
    assert!(law::e7_printed(printed(20.0), 40.0).abs() < 1e-9);
    assert!(law::e7_printed(printed(19.0), 40.0) < 0.0);
    // Signed turns, E5's left branch: 0.25 v_max at 120 cm, nothing at 60 cm.
    assert_abs_diff_eq!(law::e7_printed(-printed(120.0), 40.0), 10.0, epsilon = 1e-9);
    assert_abs_diff_eq!(law::e7_printed(-printed(60.0), 40.0), 0.0, epsilon = 1e-9);
    for distance in [0.0, 0.19, 0.2, 0.299] {
        let turn = QuarterTurns::at_distance(metres(distance), metres(0.6));
        let speed = avoid::maneuver_speed(metres_per_second(0.4), turn).get();
        assert!(law::turn_in_range(turn.get()));
        assert!(law::maneuver_speed_in_range(speed, 0.4));
    }
}

/// Headings near the seam of the circle, from either side.
#[test]
fn maneuver_heading_wraps() {
    for reference in [3.1, -3.1, PI, 0.01, -0.01] {
        for quarters in [0.01, 0.5, 1.0, 1.5, 2.0] {
            let turn = QuarterTurns::of_angle(quarters * FRAC_PI_2).expect("a turn");
            for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
                let heading = avoid::maneuver_heading(radians(reference), side, turn).get();
                assert!(law::angle_in_range(heading));
                let exact = f64::from(reference) + sign * f64::from(quarters * FRAC_PI_2);
                assert!(
                    same_direction(heading, exact, 2e-6),
                    "{reference}, {quarters}"
                );
            }
        }
    }
}

// ----------------------------------------------------------- the mode machine

fn any_situation() -> impl Strategy<Value = Situation> {
    let flags = [any::<bool>(); 3];
    let rarely = prop_oneof![7 => Just(false), 1 => Just(true)];
    (
        proptest::option::weighted(0.8, length()),
        trend(),
        flags,
        rarely,
    )
        .prop_map(
            |(distance, trend, [guard, corridor_free, aligned], at_goal)| Situation {
                distance,
                trend,
                guard,
                corridor_free,
                aligned,
                at_goal,
            },
        )
}

fn any_mode() -> impl Strategy<Value = Mode> {
    select(
        &[
            Mode::Cruise,
            Mode::Maneuver,
            Mode::Reorient,
            Mode::Stop,
            Mode::Arrived,
        ][..],
    )
}

/// An obstacle beside the way, at this distance; nothing else of note.
fn at(distance: f32, trend: Trend) -> Situation {
    Situation {
        distance: Some(metres(distance)),
        trend,
        guard: false,
        corridor_free: true,
        aligned: true,
        at_goal: false,
    }
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    //= avoid.INV-10
    //= avoid.INV-11
    #[test]
    fn modes_settle_and_stop_dominates(
        mode in any_mode(), situation in any_situation(), config in usual_or_any_config(),
    ) {
        let first = avoid::next_mode(mode, &situation, &config);
        let second = avoid::next_mode(first, &situation, &config);
        let mut third = avoid::next_mode(second, &situation, &config);
        prop_assert!(law::settled(second, third));
        prop_assert!(law::stop_dominates(situation.guard, first.at_rest()));
        for _ in 0..10 {
            third = avoid::next_mode(third, &situation, &config);
            prop_assert!(law::settled(second, third));
        }
    }

    /// At the thresholds themselves, where a careless comparison would alternate, equal thresholds
    /// included.
    //= avoid.INV-10
    #[test]
    fn modes_settle_on_the_thresholds(
        mode in any_mode(), situation in any_situation(), config in config(),
        equal in any::<bool>(), on_safe in any::<bool>(),
    ) {
        let mut parameters = *config.parameters();
        if equal {
            parameters.near_distance = parameters.safe_distance;
        }
        let config = Config::new(parameters).expect("d_n may be d_safe");
        let distance = if on_safe { config.safe_distance } else { config.near_distance };
        let situation = Situation { distance: Some(metres(distance)), ..situation };
        let first = avoid::next_mode(mode, &situation, &config);
        let second = avoid::next_mode(first, &situation, &config);
        let third = avoid::next_mode(second, &situation, &config);
        prop_assert!(law::settled(second, third));
    }

    /// S1.A4 as read, against the reference: driving modes, way to the goal free, not aligned yet.
    //= avoid.INV-10
    #[test]
    fn modes_are_the_reference(
        mode in any_mode(), distance in 0.0_f32..2.0, trend in trend(),
        time in 0.0_f32..3.0, fresh in any::<bool>(),
    ) {
        prop_assume!(mode != Mode::Arrived);
        let config = s1();
        let guard = !fresh || distance <= config.min_distance || time <= config.stop_time;
        let situation = Situation { guard, aligned: false, ..at(distance, trend) };
        let found = avoid::next_mode(mode, &situation, &config);
        let trend = format!("{trend:?}").to_lowercase();
        // The thresholds as the core has them: 0.8_f32 is not quite 80 cm.
        let centimetres = (centimetres(distance) * 1e4).round() / 1e4;
        let expected = law::a4(
            &format!("{mode:?}"), centimetres, &trend, f64::from(time), fresh,
        );
        prop_assert_eq!(format!("{found:?}"), expected);
    }
}

/// S1.A4 as printed (L266 to L290): the first block begins the maneuver, the second ends it.
fn maneuvers_as_printed(distance: f32, safe_distance: f32, near_distance: f32) -> bool {
    let mut maneuver = false;
    if distance < safe_distance {
        maneuver = true;
    }
    if safe_distance > distance && distance > near_distance {
        maneuver = false;
    }
    maneuver
}

fn with_safe_distance(safe_distance: f32) -> Config {
    Config::new(Parameters {
        safe_distance,
        ..preset::SRIKANDI_II_2012
    })
    .expect("a configuration")
}

/// ER-S1-01: as printed, d_safe makes no difference at any distance; as read, it is where the
/// maneuver begins.
#[test]
fn safe_distance_has_an_effect() {
    let near = s1().near_distance;
    let mut differs = 0;
    for millimetres in 401..2_000_u16 {
        let distance = f32::from(millimetres) / 1000.0;
        let printed = |safe| maneuvers_as_printed(distance, safe, near);
        assert_eq!(printed(1.0), distance <= near);
        assert_eq!(printed(1.0), printed(1.2));
        assert_eq!(printed(1.0), printed(1.6));

        let read = |safe| {
            let config = with_safe_distance(safe);
            avoid::next_mode(Mode::Cruise, &at(distance, Trend::Closing), &config)
        };
        for safe in [1.0, 1.2, 1.6] {
            assert_eq!(read(safe) == Mode::Maneuver, distance < safe);
        }
        differs += u32::from(read(1.0) != read(1.6));
    }
    assert_eq!(differs, 600, "between 1.0 m and 1.6 m");
}

/// ER-S1-01: in the band between d_n and d_safe both printed conditions hold. A machine without
/// memory takes turns there; M1 stays where it is, whatever mode it comes from.
//= avoid.INV-10
#[test]
fn inverted_hysteresis_does_not_oscillate() {
    let config = s1();
    for trend in [
        Trend::Closing,
        Trend::Steady,
        Trend::Receding,
        Trend::Unknown,
    ] {
        for from in [Mode::Cruise, Mode::Maneuver, Mode::Reorient, Mode::Stop] {
            for centimetres in 81..120_u8 {
                let situation = at(f32::from(centimetres) / 100.0, trend);
                let mut modes = vec![from];
                for _ in 0..20 {
                    let last = modes[modes.len() - 1];
                    modes.push(avoid::next_mode(last, &situation, &config));
                }
                let changes = modes.windows(2).filter(|pair| pair[0] != pair[1]).count();
                assert!(changes <= 2, "{from:?}, {trend:?}: {modes:?}");
                assert!(law::settled(modes[2], modes[20]));
            }
        }
    }
}

/// Someone comes, is passed, and goes: one maneuver, one turn back, and on.
#[test]
fn an_encounter_takes_each_mode_once() {
    let config = s1();
    let coming = (45..150_u8).rev().map(|cm| (cm, Trend::Closing));
    let going = (45..150_u8).map(|cm| (cm, Trend::Receding));
    let mut modes = vec![Mode::Cruise];
    for (centimetres, trend) in coming.chain(going) {
        let situation = at(f32::from(centimetres) / 100.0, trend);
        let last = modes[modes.len() - 1];
        modes.push(avoid::next_mode(last, &situation, &config));
    }
    modes.dedup();
    let expected = [Mode::Cruise, Mode::Maneuver, Mode::Reorient, Mode::Cruise];
    assert_eq!(modes, expected);
}

/// A maneuver does not end while the obstacle stands in the way to the goal, nor near it, however
/// it moves.
#[test]
fn maneuver_ends_only_past_the_obstacle() {
    let config = s1();
    let next = |situation: &Situation| avoid::next_mode(Mode::Maneuver, situation, &config);
    let passed = at(1.0, Trend::Receding);
    assert_eq!(next(&passed), Mode::Reorient);
    let in_the_way = Situation {
        corridor_free: false,
        ..passed
    };
    assert_eq!(next(&in_the_way), Mode::Maneuver);
    assert_eq!(next(&at(0.8, Trend::Receding)), Mode::Maneuver);
    assert_eq!(next(&at(1.0, Trend::Steady)), Mode::Maneuver);
    // ER-X1: not knowing is not receding.
    assert_eq!(next(&at(1.0, Trend::Unknown)), Mode::Maneuver);
}

// ------------------------------------------------------------- the whole law

/// What a robot at the origin with the goal ahead sees of something at this distance and bearing.
fn sees(distance: f32, bearing: f32) -> View<3> {
    let config = s1();
    let (config, ring) = settings::fitted::<3>(&config);
    let mut view = Memory::default()
        .update(
            &in_order(10_000, [5.0; 3]),
            [5.0, 0.0].into(),
            &ring,
            &config,
        )
        .expect("odometry");
    let (sin, cos) = bearing.sin_cos();
    view.obstacle = Some(Obstacle {
        distance: metres(distance),
        contact_range: 50,
        direction: radians(bearing),
        position: [distance * cos, distance * sin].into(),
        trend: Trend::Closing,
        speed: ObstacleSpeed {
            value: metres_per_second(0.4),
            saturated: false,
        },
        visible: true,
        seen_now: true,
    });
    view
}

proptest! {
    #![proptest_config(common::cases(1_000))]

    /// Any configuration, and any view after any view.
    //= avoid.INV-11
    //= avoid.INV-13
    #[test]
    fn advice_is_within_limits(
        config in usual_or_any_config(),
        views in proptest::collection::vec((view::<3>(), any::<bool>()), 1..20),
    ) {
        let mut avoid = Avoid::new(config);
        for (mut view, guard) in views {
            view.guard = guard.then_some(StopReason::Operator);
            let advice = avoid.advise(&view);
            prop_assert!(law::advice_in_range(
                advice.speed, advice.turn_rate, config.speed_max, config.turn_rate_max
            ));
            prop_assert!(law::stop_dominates(guard, advice.speed == 0.0));
            prop_assert!(law::stop_dominates(guard, avoid.current().at_rest()));
        }
    }

    /// The side of a maneuver is the one chosen at its beginning, however the obstacle moves while
    /// it stays inside d_safe: the robot does not change its mind half-way.
    //= avoid.INV-7
    #[test]
    fn side_is_latched(
        first in prop_oneof![0.01_f32..0.5, -0.5_f32..-0.01],
        sights in proptest::collection::vec((0.41_f32..1.19, -0.5_f32..0.5), 1..20),
    ) {
        let mut avoid = Avoid::new(s1());
        let begin = avoid.advise(&sees(1.1, first));
        prop_assert_eq!(avoid.current(), Mode::Maneuver);
        prop_assert!(law::turns_away(begin.turn_rate, first));
        for (distance, bearing) in sights {
            let advice = avoid.advise(&sees(distance, bearing));
            prop_assert_eq!(avoid.current(), Mode::Maneuver);
            prop_assert!(law::turns_away(advice.turn_rate, first), "{:?}", advice);
        }
    }

    /// ER-S1-03: the heading of a maneuver is that from the goal's heading when it began. A robot
    /// that has it has turned enough, wherever the goal is by then; as printed it would turn by as
    /// much again, cycle after cycle.
    //= avoid.INV-7
    #[test]
    fn reference_is_latched(
        bearing in 0.01_f32..0.5, distance in 0.5_f32..1.19, goal in -0.5_f32..0.5,
    ) {
        let mut avoid = Avoid::new(s1());
        avoid.advise(&sees(1.1, bearing));
        let mut view = sees(distance, bearing);
        let turn = QuarterTurns::at_distance(metres(distance), metres(s1().turn_distance));
        view.pose.heading = avoid::maneuver_heading(Angle::ZERO, Side::Right, turn);
        view.goal.heading = radians(goal);
        for _ in 0..5 {
            let advice = avoid.advise(&view);
            prop_assert_eq!(avoid.current(), Mode::Maneuver);
            prop_assert!(advice.turn_rate.abs() < 1e-5, "{:?}", advice);
        }
    }

    /// ER-X1, I14: E7 may be faster than the cruise speed, but not past someone who is not seen;
    /// and where nothing is known the robot is slower still.
    //= avoid.INV-13
    #[test]
    fn out_of_sight_is_no_faster_than_cruise(
        config in usual_or_any_config(),
        views in proptest::collection::vec(view::<3>(), 1..20),
    ) {
        let mut avoid = Avoid::new(config);
        for view in views {
            let Advice { speed, .. } = avoid.advise(&view);
            let seen = view.obstacle.is_some_and(|obstacle| obstacle.visible);
            let most = match avoid.current() {
                Mode::Reorient if !seen => config.cruise_speed / 2.0,
                Mode::Maneuver if view.obstacle.is_none() => config.cruise_speed / 2.0,
                Mode::Maneuver if seen => config.speed_max,
                _ => config.cruise_speed,
            };
            prop_assert!(law::advice_in_range(
                speed, 0.0, most, config.turn_rate_max
            ));
        }
    }
}

/// S1.E6: once the obstacle is past, back to the goal, and at rest at the goal.
#[test]
fn reorients_to_the_goal_and_arrives() {
    let config = s1();
    let mut avoid = Avoid::new(config);
    avoid.advise(&sees(1.0, 0.1));
    assert_eq!(avoid.current(), Mode::Maneuver);
    let mut view = sees(1.0, 0.1);
    view.obstacle = None;
    view.pose.heading = radians(-0.8);
    let advice = avoid.advise(&view);
    assert_eq!(avoid.current(), Mode::Reorient);
    assert!(advice.turn_rate > 0.0, "back to the left");
    // Nothing is seen, so nothing is known: half speed at most.
    assert!(advice.speed <= config.cruise_speed / 2.0);

    view.goal.distance = 0.1;
    let advice = avoid.advise(&view);
    assert_eq!(avoid.current(), Mode::Arrived);
    assert_eq!(advice.speed, 0.0);
}

/// Once receding is not gone: it takes as many ticks in a row as are configured.
#[test]
fn receding_is_confirmed() {
    let mut avoid = Avoid::new(s1());
    avoid.advise(&sees(1.0, 0.5));
    let mut receding = sees(1.0, 0.5);
    if let Some(obstacle) = &mut receding.obstacle {
        obstacle.trend = Trend::Receding;
    }
    for _ in 0..3 {
        avoid.advise(&receding);
        avoid.advise(&receding);
        assert_eq!(avoid.current(), Mode::Maneuver);
        // And then it comes after all.
        avoid.advise(&sees(1.0, 0.5));
        assert_eq!(avoid.current(), Mode::Maneuver);
    }
    for mode in [Mode::Maneuver, Mode::Maneuver, Mode::Reorient] {
        avoid.advise(&receding);
        assert_eq!(avoid.current(), mode);
    }
}

/// E7 makes the robot faster the nearer the obstacle is; not before it looks past it (ER-S1-20).
#[test]
fn maneuver_first_turns_then_goes() {
    let config = s1();
    let mut avoid = Avoid::new(config);
    let towards = avoid.advise(&sees(0.6, 0.05));
    assert_eq!(avoid.current(), Mode::Maneuver);
    assert!(towards.speed <= config.cruise_speed, "{towards:?}");

    let mut turned = sees(0.6, 0.05);
    turned.pose.heading = radians(-FRAC_PI_2);
    let away = avoid.advise(&turned);
    assert_relative_eq!(away.speed, config.speed_max, max_relative = 1e-5);
}

/// What stands beside the way to the goal is no obstacle; what moves there, or is out of sight, is.
#[test]
fn what_stands_beside_the_way_is_none() {
    // Half a robot and its margin are 0.4 m.
    let mode = |bearing: f32, trend: Trend, speed: f32, visible: bool| {
        let mut view = sees(1.0, bearing);
        let offset = nalgebra::Vector2::new(2.0, 1.0);
        view.pose.position += offset;
        if let Some(obstacle) = &mut view.obstacle {
            obstacle.position += offset;
            obstacle.trend = trend;
            obstacle.speed.value = metres_per_second(speed);
            obstacle.visible = visible;
        }
        let mut avoid = Avoid::new(s1());
        avoid.advise(&view);
        avoid.current()
    };
    for side in [-1.0, 1.0] {
        assert_eq!(mode(0.38 * side, Trend::Closing, 0.1, true), Mode::Maneuver);
        assert_eq!(mode(0.45 * side, Trend::Closing, 0.1, true), Mode::Cruise);
        assert_eq!(mode(0.45 * side, Trend::Unknown, 0.4, true), Mode::Cruise);
        assert_eq!(mode(0.45 * side, Trend::Closing, 0.4, true), Mode::Maneuver);
        assert_eq!(
            mode(0.45 * side, Trend::Closing, 0.1, false),
            Mode::Maneuver
        );
    }
}

/// An echo that may be as far to the side as what stands right beside the robot is the same wall, and
/// that is beside the way.
#[test]
fn a_wall_beside_the_robot_is_not_ahead() {
    let mode = |bearing: f32, beside: [f32; 2]| {
        let mut view = sees(1.0, bearing);
        view.beside = beside.map(metres);
        if let Some(obstacle) = &mut view.obstacle {
            obstacle.speed.value = Speed::ZERO;
        }
        let mut avoid = Avoid::new(s1());
        avoid.advise(&view);
        avoid.current()
    };
    // At the edge of the cone, 15° farther out, it is 0.53 m to the side.
    assert_eq!(mode(0.3, [0.55, 5.0]), Mode::Cruise);
    assert_eq!(mode(-0.3, [5.0, 0.55]), Mode::Cruise);
    assert_eq!(mode(0.3, [5.0, 0.55]), Mode::Maneuver);
    assert_eq!(mode(-0.3, [0.55, 5.0]), Mode::Maneuver);
    assert_eq!(mode(0.3, [0.65, 5.0]), Mode::Maneuver);
    assert_eq!(mode(0.3, [0.42, 5.0]), Mode::Maneuver);
}

/// A maneuver is as fast as there is room ahead: not at all at d_n, and its own speed from d_safe on.
#[test]
fn a_maneuver_keeps_pace_with_the_room() {
    let speed = |ahead: f32| {
        let mut view = sees(0.6, 0.05);
        view.pose.heading = radians(-FRAC_PI_2);
        view.ahead = metres(ahead);
        Avoid::new(s1()).advise(&view).speed
    };
    assert_eq!(speed(0.7), 0.0);
    assert_eq!(speed(0.8), 0.0);
    assert_relative_eq!(speed(1.0), s1().speed_max / 2.0, max_relative = 1e-4);
    assert_relative_eq!(speed(1.2), s1().speed_max, max_relative = 1e-4);
    assert_relative_eq!(speed(3.0), s1().speed_max, max_relative = 1e-4);
}

/// A maneuver that cannot go where it looks faces the goal after a while, and then looks to the other
/// side.
#[test]
fn a_maneuver_without_room_looks_round() {
    let mut avoid = Avoid::new(s1());
    let mut turn_at = |now: u64, ahead: f32| {
        let mut view = sees(1.0, 0.1);
        view.now = Instant(now);
        view.ahead = metres(ahead);
        let advice = avoid.advise(&view);
        assert_eq!(avoid.current(), Mode::Maneuver);
        advice.turn_rate
    };
    assert!(turn_at(10_000, 0.7) < 0.0, "away, to the right");
    assert!(turn_at(12_499, 0.7) < 0.0);
    assert_eq!(turn_at(12_500, 0.7), 0.0, "the goal is straight ahead");
    assert_eq!(turn_at(14_999, 0.7), 0.0);
    assert!(turn_at(15_000, 0.7) > 0.0, "the other side");
    // With room there is nothing to look for.
    assert!(turn_at(17_499, 1.2) > 0.0);
    assert!(turn_at(20_000, 0.7) > 0.0);
    assert_eq!(turn_at(22_500, 0.7), 0.0);
}

/// The robot cruises again once it looks at the goal and nothing is inside d_safe, and no sooner; only
/// standing is rest.
#[test]
fn aligned_it_cruises() {
    let config = s1();
    let next = |mode, distance: Option<f32>, aligned| {
        let distance = distance.map(metres);
        let situation = Situation {
            distance,
            aligned,
            ..at(1.0, Trend::Steady)
        };
        avoid::next_mode(mode, &situation, &config)
    };
    for mode in [Mode::Maneuver, Mode::Reorient, Mode::Stop] {
        assert_eq!(next(mode, None, true), Mode::Cruise);
        assert_eq!(next(mode, None, false), Mode::Reorient);
    }
    assert_eq!(next(Mode::Cruise, None, false), Mode::Cruise);
    assert_eq!(next(Mode::Reorient, Some(1.3), true), Mode::Cruise);
    assert_eq!(next(Mode::Reorient, Some(1.3), false), Mode::Reorient);
    assert_eq!(next(Mode::Reorient, Some(1.1), true), Mode::Reorient);
    for mode in [Mode::Cruise, Mode::Maneuver, Mode::Reorient] {
        assert!(!mode.at_rest());
    }
    assert!(Mode::Stop.at_rest() && Mode::Arrived.at_rest());
}

/// Where nothing is seen any more the robot goes at half its cruise speed until it looks at the goal; with
/// something in sight, far away, at all of it.
#[test]
fn reorients_with_care() {
    let config = s1();
    let speed = |seen: bool| {
        let mut avoid = Avoid::new(config);
        avoid.advise(&sees(1.0, 0.1));
        let mut view = sees(3.0, 0.0);
        if !seen {
            view.obstacle = None;
        }
        // Off by little more than it takes to be aligned.
        view.pose.heading = radians(-0.11);
        let advice = avoid.advise(&view);
        assert_eq!(avoid.current(), Mode::Reorient);
        advice.speed
    };
    let turning = 1.0 - 0.11 / FRAC_PI_2;
    assert_relative_eq!(
        speed(true),
        config.cruise_speed * turning,
        max_relative = 1e-4
    );
    assert_relative_eq!(
        speed(false),
        config.cruise_speed * turning / 2.0,
        max_relative = 1e-4
    );
}

/// A robot that stands does not choose a side before it knows how the thing moves; then it does.
#[test]
fn a_side_is_chosen_with_a_trend() {
    let mut avoid = Avoid::new(s1());
    let mut view = sees(1.0, 0.1);
    view.guard = Some(StopReason::Operator);
    if let Some(obstacle) = &mut view.obstacle {
        obstacle.trend = Trend::Unknown;
    }
    assert_eq!(avoid.advise(&view).turn_rate, 0.0);
    assert_eq!(avoid.current(), Mode::Stop);
    if let Some(obstacle) = &mut view.obstacle {
        obstacle.trend = Trend::Closing;
    }
    assert!(avoid.advise(&view).turn_rate < 0.0, "away, to the right");
}

/// Each mode is named on the status line and in the log.
#[test]
fn modes_have_names() {
    let mut avoid = Avoid::new(s1());
    let mut far = sees(1.0, 0.1);
    far.obstacle = None;
    let name = |avoid: &Avoid| Law::<3>::mode(avoid);
    avoid.advise(&far);
    assert_eq!(name(&avoid), "cruise");
    avoid.advise(&sees(1.0, 0.1));
    assert_eq!(name(&avoid), "maneuver");
    far.pose.heading = radians(-0.8);
    avoid.advise(&far);
    assert_eq!(name(&avoid), "reorient");
    far.guard = Some(StopReason::Operator);
    avoid.advise(&far);
    assert_eq!(name(&avoid), "stop");
    far.goal.distance = 0.1;
    avoid.advise(&far);
    assert_eq!(name(&avoid), "arrived");
}

/// An orientation along the image is neither up nor down it.
//= avoid.INV-14
#[test]
fn along_the_image_nothing_approaches() {
    for (orientation, approaches) in [(0.0, false), (0.01, true), (3.0, true), (PI, false)] {
        let found = avoid::image_direction(orientation).expect("an orientation");
        assert_eq!(found.1, approaches, "{orientation}");
    }
}

/// Presets are S1's and S2's tables.
#[test]
fn presets_are_the_tables() {
    let s1 = preset::SRIKANDI_II_2012;
    let found = [
        s1.safe_distance,
        s1.near_distance,
        s1.min_distance,
        s1.turn_distance,
        s1.stop_time,
        s1.speed_max,
        s1.cruise_speed,
        s1.obstacle_speed_max,
    ];
    assert_eq!(found, [1.2, 0.8, 0.4, 0.6, 1.0, 0.4, 0.2, 0.8]);
    assert_relative_eq!(s1.view_half_angle, 30_f32.to_radians());
    // d_safe is the stop threshold at the greatest closing speed.
    let threshold = s1.stop_time * (s1.speed_max + s1.obstacle_speed_max);
    assert_relative_eq!(s1.safe_distance, threshold);
    let s2 = preset::SRIKANDI_II_2011;
    let found = [s2.near_distance, s2.speed_max, s2.obstacle_speed_max];
    assert_eq!(found, [0.9, 0.3, 0.3]);
}
