//! Chapter `view`: judging readings and remembering them.

mod common;

use common::{
    any_f32, between, config, in_order, length, observations, pioneer, settings,
    usual_or_any_config,
};
use proptest::prelude::*;
use sidestep::config::Config;
use sidestep::failsafe::StopReason;
use sidestep::observation::{Observation, SonarReading, SonarSample, classify};
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::ring::{Placement, Ring};
use sidestep::view::{Bound, EchoMemory, Memory, View};
use sidestep_spec::avoid as law;
use sidestep_spec::view as promise;

/// Echoes of one thing scatter by less than this, in mm.
const SCATTER: i32 = 100;

/// What motion within the promise explains in a time: mm in ms, rounded up.
fn explained(config: &Config, milliseconds: u64) -> i32 {
    let closing = f64::from(config.obstacle_speed_max) + f64::from(config.speed_max);
    // The core rounds the speed up to whole mm/s first, and the f32 product before that.
    ((closing * 1000.0 + 1.1) * milliseconds as f64 / 1000.0).ceil() as i32
}

// -------------------------------------------------------------------- judging

/// The judgement of a range that was measured `age` ms ago.
fn judged(range: f32, age: u64) -> SonarReading {
    let config = pioneer();
    let metres = |metres| Length::metres(metres).expect("a length");
    let sample = SonarSample {
        range,
        taken_at: Instant(10_000 - age),
    };
    let (least, most) = (config.sonar_range_min, config.sonar_range_max);
    classify(
        Some(sample),
        Instant(10_000),
        metres(least),
        metres(most),
        500,
    )
}

proptest! {
    #![proptest_config(common::cases(4_000))]

    //= view.INV-1
    #[test]
    fn only_ranges_are_readings(
        range in any_f32(), taken_at in any::<u64>(), later in prop_oneof![0..2_000_u64, any::<u64>()],
        limits in [length(), length()], age_max in prop_oneof![0..2_000_u64, any::<u64>()],
    ) {
        let now = Instant(taken_at.wrapping_add(later));
        let sample = SonarSample { range, taken_at: Instant(taken_at) };
        let reading = classify(Some(sample), now, limits[0], limits[1], age_max);
        let usable = matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_));
        let in_time = now.since(sample.taken_at).is_some_and(|age| age <= age_max);
        prop_assert!(promise::unusable_is_refused(range, in_time, usable));
        let never = classify(None, now, limits[0], limits[1], age_max);
        prop_assert!(promise::unusable_is_refused(range, false, never != SonarReading::Stale));
    }
}

/// The values that have meant "free" somewhere: none of them does here.
//= view.INV-1
#[test]
fn nothing_means_free() {
    for range in [0.0, -0.0, 0.029, 1e-45] {
        assert_eq!(judged(range, 0), SonarReading::TooNear, "{range}");
    }
    for range in [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -1.0,
        -0.1,
        10.1,
        5_000.0,
        f32::MAX,
    ] {
        assert_eq!(judged(range, 0), SonarReading::Invalid, "{range}");
    }
    assert!(matches!(judged(0.03, 0), SonarReading::Echo(_)));
    assert!(matches!(judged(4.999, 500), SonarReading::Echo(_)));
    assert!(matches!(judged(5.0, 0), SonarReading::NoEcho(_)));
    assert_eq!(judged(1.0, 501), SonarReading::Stale);
}

// ---------------------------------------------------------------- remembering

/// One reading of a sonar: the range if there was an echo, how long after the last, and how old
/// when it is read.
fn any_reading() -> impl Strategy<Value = (Option<i32>, u64, u64)> {
    let range = prop_oneof![0..6_000_i32, 0..20_000_i32];
    let echo = proptest::option::weighted(0.8, range);
    let age = prop_oneof![2 => Just(0_u64), 1 => 0..500_u64];
    (echo, prop_oneof![4 => 0..300_u64, 1 => 0..3_000_u64], age)
}

/// A memory that has heard an echo at `range` at `at`.
fn heard(range: i32, at: Instant, config: &Config) -> (EchoMemory, Bound) {
    let mut memory = EchoMemory::default();
    let bound = memory.update(Some(range), at, at, config);
    (memory, bound)
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    //= view.INV-2
    //= view.INV-5
    #[test]
    fn nearer_echoes_count_at_once(
        config in usual_or_any_config(),
        readings in proptest::collection::vec(any_reading(), 1..40),
    ) {
        let mut memory = EchoMemory::default();
        let mut now = 10_000;
        for (measured, later, age) in readings {
            now += later;
            let taken_at = Instant(now - age.min(now));
            let bound = memory.update(measured, taken_at, Instant(now), &config);
            if let Some(measured) = measured {
                prop_assert!(promise::nearer_counts(bound.range, measured));
            }
            prop_assert!(promise::reachable_is_nearer(bound.range, bound.reachable));
        }
    }

    /// Readings that come in order, each measured after the one before.
    //= view.INV-3
    #[test]
    fn one_reading_frees_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32, farther in proptest::option::of(0..20_000_i32),
        later in 0.0_f32..=1.0, age in prop_oneof![Just(0.0_f32), 0.0_f32..=1.0],
    ) {
        // Taken and read within the hold time.
        let hold_time = config.hold_time * 1000.0;
        let age = (age * (1.0 - later) * hold_time) as u64;
        let later = (later * hold_time) as u64;
        let (mut memory, before) = heard(range, Instant(10_000), &config);
        let taken_at = Instant(10_000 + later);
        let after = memory.update(farther, taken_at, Instant(10_000 + later + age), &config);
        let explained = explained(&config, later) + SCATTER;
        prop_assert!(promise::not_freed_at_once(before.range, after.range, explained));
    }

    /// As long as there are fewer of them than it takes to be sure, all readings together free no
    /// more than motion and the scatter of each explain.
    //= view.INV-3
    #[test]
    fn a_few_readings_free_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32,
        readings in proptest::collection::vec((proptest::option::of(0..20_000_i32), 0..200_u64), 20),
    ) {
        let (mut memory, before) = heard(range, Instant(10_000), &config);
        let mut now = 10_000;
        let fewer = config.confirm_samples as usize - 1;
        for (count, (measured, later)) in readings.into_iter().take(fewer).enumerate() {
            now += later;
            prop_assume!(now - 10_000 <= (config.hold_time * 1000.0) as u64);
            let after = memory.update(measured, Instant(now), Instant(now), &config);
            let explained = explained(&config, now - 10_000) + SCATTER * (count as i32 + 1);
            prop_assert!(promise::not_freed_at_once(before.range, after.range, explained));
        }
    }

    /// A reading that was measured before the echo that is held says nothing about what came
    /// after it.
    //= view.INV-3
    #[test]
    fn an_older_reading_frees_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32, farther in 0..20_000_i32, earlier in 1..500_u64, later in 0..100_u64,
    ) {
        let (mut memory, before) = heard(range, Instant(10_000), &config);
        let after = memory.update(
            Some(farther), Instant(10_000 - earlier), Instant(10_000 + later), &config,
        );
        let explained = explained(&config, earlier) + SCATTER;
        prop_assert!(promise::not_freed_at_once(before.range, after.range, explained));
    }

    /// A reading that is still the latest in the next ticks is one reading, however often it is
    /// looked at.
    //= view.INV-3
    #[test]
    fn one_reading_seen_again_frees_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32, farther in 0..20_000_i32, looks in 1..10_u64,
    ) {
        prop_assume!(100 * (looks + 1) <= (config.hold_time * 1000.0) as u64);
        let (mut memory, before) = heard(range, Instant(10_000), &config);
        let taken_at = Instant(10_100);
        for look in 0..looks {
            let now = Instant(10_100 + 100 * look);
            let after = memory.update(Some(farther), taken_at, now, &config);
            let explained = explained(&config, 100) + SCATTER;
            prop_assert!(promise::not_freed_at_once(before.range, after.range, explained));
        }
    }

    /// A reading is as old as it is: what may have closed since it was taken is not there any
    /// more, whether it was an echo or none.
    //= view.INV-5
    #[test]
    fn ages_are_taken_off(
        config in usual_or_any_config(), measured in proptest::option::of(0..6_000_i32),
        age in 0..10_000_u64,
    ) {
        let now = Instant(20_000);
        let mut memory = EchoMemory::default();
        let bound = memory.update(measured, Instant(20_000 - age), now, &config);
        let closing = f64::from(config.obstacle_speed_max) + f64::from(config.speed_max);
        // Rounded to the safe side, but for the f32 sum of the two speeds.
        let least = (closing * age as f64 * (1.0 - 1e-6)).floor() as i32;
        prop_assert!(promise::reachable_is_nearer(bound.range - least, bound.reachable));
        let most = bound.range - explained(&config, age);
        prop_assert!(promise::reachable_is_nearer(bound.reachable, most));
    }

    /// ER-X1: no number of readings without an echo is proof; only time lets go, and that at the
    /// hold time.
    //= view.INV-3
    #[test]
    fn silence_is_no_proof(config in usual_or_any_config(), range in 0..6_000_i32) {
        let (mut memory, before) = heard(range, Instant(10_000), &config);
        let hold_time = (config.hold_time * 1000.0).round() as u64;
        for later in (0..=hold_time).step_by(20) {
            let now = Instant(10_000 + later);
            let after = memory.update(None, now, now, &config);
            prop_assert!(promise::not_freed_at_once(before.range, after.range, 0));
            prop_assert!(promise::reachable_is_nearer(after.range, after.reachable));
        }
        let now = Instant(10_001 + hold_time);
        let after = memory.update(None, now, now, &config);
        prop_assert_eq!(after.range, (config.sonar_range_max * 1000.0) as i32);
    }
}

// ------------------------------------------------------------------ the view

/// What must hold of every view.
fn judge<const N: usize>(view: &View<N>, ring: &Ring<N>, config: &Config) {
    assert!(promise::judged(
        view.speed,
        view.goal.distance,
        view.obstacle.map(|obstacle| obstacle.distance.get())
    ));
    assert!(law::angle_in_range(view.pose.heading.get()));
    assert!(law::angle_in_range(view.goal.heading.get()));
    if let Some(obstacle) = &view.obstacle {
        assert!(obstacle.position.iter().all(|x| x.is_finite()));
        assert!(law::angle_in_range(obstacle.direction.get()));
        assert!(law::obstacle_speed_in_range(
            obstacle.speed.value.get(),
            config.obstacle_speed_max
        ));
    }
    for (i, reading) in view.sonar.iter().enumerate() {
        if let SonarReading::Echo(range) = reading {
            let measured = (range.get() * 1000.0) as i32;
            assert!(promise::nearer_counts(view.range[i], measured));
        }
        let reachable = view.clearance[i] + ring.sonars()[i].contact_range;
        assert!(promise::reachable_is_nearer(view.range[i], reachable));
    }
}

/// Observations one after the other, as views.
fn watch<const N: usize>(
    config: &Config,
    observations: &[Observation<N>],
) -> Vec<Result<View<N>, StopReason>> {
    let ring = settings::ring::<N>(config);
    let mut memory = Memory::default();
    observations
        .iter()
        .map(|observation| {
            let view = memory.update(observation, [5.0, 1.0].into(), &ring, config);
            if let Ok(view) = &view {
                judge(view, &ring, config);
            }
            view
        })
        .collect()
}

proptest! {
    #![proptest_config(common::cases(500))]

    //= view.INV-2
    //= view.INV-4
    //= view.INV-5
    #[test]
    fn any_observations_are_judged(
        config in usual_or_any_config(),
        three in observations::<3>(30), eight in observations::<8>(15),
    ) {
        for (view, observation) in watch(&config, &three).iter().zip(&three) {
            // Without a pose there is no view, and with one there is.
            let finite = observation.odometry.is_some_and(|odometry| {
                odometry.x.is_finite() && odometry.y.is_finite() && odometry.heading.is_finite()
            });
            prop_assert!(finite || view.is_err());
        }
        watch(&config, &eight);
    }

    /// What one sonar says is no business of another, and of no sonar less is believed than it
    /// says: the least clearance is that of the nearest thing that any sonar hears.
    //= view.INV-2
    #[test]
    fn every_sonar_counts(ranges in proptest::array::uniform8(0.1_f32..4.9)) {
        let config = pioneer();
        let views = watch(&config, &[in_order(10_000, ranges)]);
        let view = views[0].expect("odometry");
        let ring = settings::ring::<8>(&config);
        for (i, sonar) in ring.sonars().iter().enumerate() {
            let measured = (ranges[i] * 1000.0) as i32;
            prop_assert_eq!(view.range[i], measured);
            prop_assert_eq!(view.clearance[i], measured - sonar.contact_range);
        }
    }
}

/// Ticks of a robot at rest, 100 ms apart, with these ranges ahead.
fn ahead(ranges: &[f32]) -> Vec<View<3>> {
    let observations: Vec<_> = (0..)
        .zip(ranges)
        .map(|(tick, &range)| in_order(10_000 + 100 * tick, [range, 5.0, 5.0]))
        .collect();
    watch(&pioneer(), &observations)
        .into_iter()
        .map(|view| view.expect("odometry"))
        .collect()
}

/// ER-X1: someone ahead who is no longer heard is still there, for the law as for the shield, and
/// the shield takes them to come nearer all the while.
//= view.INV-3
#[test]
fn someone_out_of_hearing_is_still_there() {
    let views = ahead(&[1.0, 5.0, 5.0, 5.0, 5.0]);
    for pair in views.windows(2) {
        let [before, after] = [&pair[0], &pair[1]];
        assert!(promise::not_freed_at_once(
            before.range[0],
            after.range[0],
            0
        ));
        assert!(after.clearance[0] < before.clearance[0]);
        let obstacle = after.obstacle.expect("remembered");
        assert!((obstacle.distance.get() - 1.0).abs() < 1e-3);
    }
    // A reading counts as sight for half a second; the hold time is a second, and then nothing is
    // known of them.
    let mut ranges = [5.0; 13];
    ranges[0] = 1.0;
    let views = ahead(&ranges);
    let visible = |view: &View<3>| view.obstacle.is_some_and(|obstacle| obstacle.visible);
    assert!(visible(&views[5]) && !visible(&views[6]));
    assert!(views[10].obstacle.is_some() && views[10].range[0] == 1_000);
    assert!(views[11].obstacle.is_none() && views[11].range[0] == 5_000);
}

/// An echo from behind their place, again and again, is proof that they have gone; once is not.
//= view.INV-3
#[test]
fn echoes_from_behind_are_proof() {
    let views = ahead(&[1.0, 3.0, 3.0, 3.0]);
    assert_eq!(views[1].range[0], 1_000);
    assert_eq!(views[2].range[0], 1_000);
    assert_eq!(views[3].range[0], 3_000);
    // For the law too: it is told of who was there until then.
    let distance = |view: &View<3>| {
        view.obstacle
            .map(|obstacle| obstacle.distance.get().round())
    };
    let distances: Vec<_> = views.iter().map(distance).collect();
    assert_eq!(distances, [Some(1.0), Some(1.0), Some(1.0), Some(3.0)]);
    // A silence in between, and the count begins again.
    let views = ahead(&[1.0, 3.0, 3.0, 5.0, 3.0, 3.0, 3.0]);
    let ranges: Vec<_> = views.iter().map(|view| view.range[0]).collect();
    assert_eq!(ranges, [1_000, 1_000, 1_000, 1_000, 1_000, 1_000, 3_000]);
}

/// A contact is an echo at nothing.
//= view.INV-2
#[test]
fn a_contact_is_the_nearest_echo() {
    let views = ahead(&[1.0, 0.01, 5.0]);
    assert_eq!(views[1].range[0], 0);
    assert_eq!(views[2].range[0], 0);
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// The contact range of a sonar: whatever is in its cone at a range is at least that range,
    /// less the contact range, away from the robot's circle. To a hundredth of a millimetre, which
    /// the f32 positions of the test may be off.
    #[test]
    fn contact_range_covers_the_hull(
        config in config(),
        at in (between(-2.0, 2.0), between(-2.0, 2.0), -3.1_f32..3.1),
        range in between(0.0, 20.0), off_axis in between(-1.0, 1.0),
    ) {
        let (x, y, heading) = at;
        let ahead = Placement { x: 0.1, y: 0.0, heading: 0.0 };
        let ring = Ring::new(&[Placement { x, y, heading }, ahead], &config)
            .expect("placements in range");
        let direction = f64::from(heading) + f64::from(off_axis * config.sonar_half_angle);
        let range = f64::from(range);
        let point = (
            f64::from(x) + range * direction.cos(),
            f64::from(y) + range * direction.sin(),
        );
        let from_hull = 1000.0 * (point.0.hypot(point.1) - f64::from(config.robot_radius));
        let believed = 1000.0 * range - f64::from(ring.sonars()[0].contact_range);
        prop_assert!(believed <= from_hull + 0.01, "{believed} > {from_hull}");
    }

    /// Quantities exist only when they are in range, whatever the bits.
    #[test]
    fn quantities_are_valid(bits in any_f32()) {
        let inside = |from: f32, to: f32| (from..=to).contains(&bits);
        prop_assert_eq!(Length::metres(bits).is_ok(), inside(0.0, 1000.0));
        prop_assert_eq!(Speed::metres_per_second(bits).is_ok(), inside(0.0, 10.0));
        let three = 3.0 * std::f32::consts::PI;
        prop_assert_eq!(Angle::radians(bits).is_ok(), inside(-three, three));
        if let Err(refused) = Length::metres(bits) {
            prop_assert!(refused.to_string().contains("length"));
        }
    }

    /// Angles are added, taken from each other and mirrored on the circle.
    #[test]
    fn angles_are_on_the_circle(a in -9.4_f32..9.4, b in -9.4_f32..9.4) {
        let angle = |radians| Angle::radians(radians).expect("within three half turns");
        let same = |found: Angle, exact: f64| {
            law::angle_in_range(found.get())
                && law::wrap(f64::from(found.get()) - exact).abs() <= 4e-6
        };
        let (x, y) = (f64::from(a), f64::from(b));
        prop_assert!(same(angle(a), x));
        prop_assert!(same(angle(a).plus(angle(b)), x + y));
        prop_assert!(same(angle(a).minus(angle(b)), x - y));
        prop_assert!(same(angle(a).mirrored(), -x));
    }
}

/// Rings that cannot see ahead, and placements off the robot, are refused by name.
#[test]
fn blind_rings_are_refused() {
    let config = pioneer();
    let at = |x: f32, y: f32, heading: f32| Placement { x, y, heading };
    let refused = |placement: Placement| {
        Ring::new(&[placement], &config)
            .expect_err("not a ring")
            .field
    };
    assert_eq!(refused(at(0.0, 0.1, 1.6)), "sonars that look forward");
    assert_eq!(refused(at(2.1, 0.0, 0.0)), "sonar x");
    assert_eq!(refused(at(0.0, f32::NAN, 0.0)), "sonar y");
    assert_eq!(refused(at(0.0, 0.0, 10.0)), "angle");
}
