//! The obstacle that a law is told of: which echo it is, how it moves, how long it is remembered.

mod common;

use common::{in_order, pioneer_with, sonar_towards};
use nalgebra::Vector2;
use proptest::prelude::*;
use sidestep::avoid::Trend;
use sidestep::config::Config;
use sidestep::observation::{Observation, Sighting};
use sidestep::quantity::Instant;
use sidestep::ring::Ring;
use sidestep::track::Obstacle;
use sidestep::view::Memory;

/// Nothing is heard.
const SILENCE: f32 = 5.0;

/// A robot with sixteen sonars that is moved about, and what its law is told.
#[derive(Clone)]
struct Following {
    config: Config,
    ring: Ring<16>,
    memory: Memory<16>,
    now: u64,
    /// x, y, heading.
    pose: [f32; 3],
    speed: f32,
}

impl Following {
    fn new() -> Self {
        let (config, ring) = pioneer_with::<16>();
        Self {
            config,
            ring,
            memory: Memory::default(),
            now: 10_000,
            pose: [0.0; 3],
            speed: 0.0,
        }
    }

    /// An observation, so many milliseconds after the one before, in which these sonars hear something.
    fn hears(&mut self, ms: u64, echoes: &[(usize, f32)]) -> Observation<16> {
        self.now += ms;
        let mut ranges = [SILENCE; 16];
        for (sonar, range) in echoes {
            ranges[*sonar] = *range;
        }
        let mut observation = in_order(self.now, ranges);
        let odometry = observation.odometry.as_mut().expect("odometry");
        [odometry.x, odometry.y, odometry.heading] = self.pose;
        odometry.speed = self.speed;
        observation
    }

    /// What the law is told upon it.
    fn told(&mut self, observation: &Observation<16>) -> Option<Obstacle> {
        let goal = Vector2::new(9.0, 0.0);
        let view = self
            .memory
            .update(observation, goal, &self.ring, &self.config);
        view.expect("odometry").obstacle
    }

    fn tick(&mut self, ms: u64, echoes: &[(usize, f32)]) -> Option<Obstacle> {
        let observation = self.hears(ms, echoes);
        self.told(&observation)
    }

    fn near(&self, heading: f32) -> usize {
        sonar_towards(&self.ring, heading)
    }

    /// Where an echo of a sonar is, in the robot's frame.
    fn point(&self, sonar: usize, range: f32) -> Vector2<f32> {
        let at = &self.ring.sonars()[sonar];
        at.position + at.axis * range
    }
}

/// What is told of something straight ahead whose range changes at `rate` m/s, after so many ticks, while
/// the robot drives at `speed`.
fn moving(rate: f32, speed: f32, ms: u64, ticks: u16) -> Obstacle {
    let mut following = Following::new();
    following.speed = speed;
    let ahead = following.near(0.1);
    let mut told = None;
    for tick in 0..=ticks {
        let seconds = f32::from(tick) * ms as f32 / 1000.0;
        following.pose[0] = speed * seconds;
        told = following.tick(ms, &[(ahead, 2.0 + rate * seconds)]);
    }
    told.expect("an obstacle")
}

/// A trend takes 0.4 s, and a change of more than 0.1 m/s; the speed is what is left of the closing when the
/// robot's own is taken off, from 0 to v_o,max.
#[test]
fn trends_and_speeds_are_estimated() {
    let [young, old] = [3, 4].map(|ticks| moving(-0.5, 0.0, 100, ticks));
    assert_eq!((young.trend, old.trend), (Trend::Unknown, Trend::Closing));
    assert_eq!(young.speed.value.get(), 0.8);
    assert!(!young.speed.saturated);
    let cases = [
        (-0.5, 0.0, Trend::Closing, 0.5),
        (0.5, 0.0, Trend::Receding, 0.0),
        (-0.12, 0.0, Trend::Closing, 0.12),
        (0.12, 0.0, Trend::Receding, 0.0),
        (-0.08, 0.0, Trend::Steady, 0.08),
        (0.08, 0.0, Trend::Steady, 0.0),
        (-0.3, 0.3, Trend::Closing, 0.0),
        (-0.7, 0.3, Trend::Closing, 0.4),
    ];
    for (rate, speed, trend, expected) in cases {
        let told = moving(rate, speed, 100, 8);
        assert_eq!(told.trend, trend, "{rate}");
        assert!(
            (told.speed.value.get() - expected).abs() < 0.01,
            "{rate}: {told:?}"
        );
        assert!(!told.speed.saturated);
    }
    let fast = moving(-0.9, 0.0, 100, 8).speed;
    assert_eq!((fast.value.get(), fast.saturated), (0.8, true));
}

/// However often a sonar is heard (sound takes 30 ms to come back from 5 m), the past reaches back far
/// enough for a trend.
#[test]
fn quick_looks_have_a_trend_as_well() {
    for ms in [30, 40, 70, 130] {
        let ticks = 1_000 / ms as u16;
        let told = moving(-0.5, 0.0, ms, ticks);
        assert_eq!(told.trend, Trend::Closing, "{ms} ms");
        assert!(
            (told.speed.value.get() - 0.5).abs() < 0.02,
            "{ms} ms: {told:?}"
        );
    }
}

/// The robot's own share of the closing is what leads towards the obstacle.
#[test]
fn the_robots_own_share_is_by_the_bearing() {
    let mut following = Following::new();
    following.speed = 0.4;
    let sonar = following.near(0.52);
    let point = following.point(sonar, 2.0);
    let bearing = point.y.atan2(point.x);
    // It stays at the same range although the robot drives: nobody's doing but its own.
    let mut told = None;
    for _ in 0..6 {
        told = following.tick(100, &[(sonar, 2.0)]);
    }
    let told = told.expect("an obstacle");
    assert_eq!(told.trend, Trend::Steady);
    assert_eq!(told.speed.value.get(), 0.0);
    for tick in 1..7_u8 {
        let range = 2.0 - 0.05 * f32::from(tick);
        following.tick(100, &[(sonar, range)]);
    }
    let told = following.tick(100, &[(sonar, 1.65)]).expect("an obstacle");
    let expected = 0.5 - 0.4 * bearing.cos();
    assert!(
        (told.speed.value.get() - expected).abs() < 0.02,
        "{told:?} for {expected}"
    );
}

/// Its place and direction are in the odometry frame; out of sight its distance follows the robot's own way.
#[test]
fn its_place_is_remembered() {
    let mut following = Following::new();
    following.pose = [1.0, 2.0, 0.5];
    let sonar = following.near(0.3);
    let told = following.tick(100, &[(sonar, 1.5)]).expect("an obstacle");
    let point = following.point(sonar, 1.5);
    let expected = 0.5 + point.y.atan2(point.x);
    assert!((told.direction.get() - expected).abs() < 1e-5);
    let (sin, cos) = 0.5_f32.sin_cos();
    let place = Vector2::new(
        1.0 + cos * point.x - sin * point.y,
        2.0 + sin * point.x + cos * point.y,
    );
    assert!((told.position - place).amax() < 1e-5);
    assert!(told.seen_now && told.visible);
    // 0.3 m nearer along its direction, and not heard.
    let away = told.direction.get();
    following.pose = [1.0 + 0.3 * away.cos(), 2.0 + 0.3 * away.sin(), 0.5];
    let held = following.tick(100, &[]).expect("remembered");
    let inset = following.ring.sonars()[sonar].position;
    let distance = point.x.hypot(point.y) - 0.3 - inset.x.hypot(inset.y);
    assert!((held.distance.get() - distance).abs() < 1e-4, "{held:?}");
    assert_eq!(held.position, told.position);
    assert!(!held.seen_now && held.visible);
    // For half a second it counts as seen, for a second it is remembered.
    let later = |ms| following.clone().tick(ms, &[]);
    assert!(later(400).is_some_and(|obstacle| obstacle.visible));
    assert!(later(401).is_some_and(|obstacle| !obstacle.visible));
    assert!(later(900).is_some() && later(901).is_none());
}

proptest! {
    #![proptest_config(common::cases(1_000))]

    /// An echo is an obstacle in the angle of view, or where the robot will be: as wide as it is, and the
    /// margin.
    #[test]
    fn only_what_is_ahead_is_followed(sonar in 0..16_usize, range in 0.1_f32..4.0) {
        let mut following = Following::new();
        let point = following.point(sonar, range);
        let config = following.config;
        let off = f64::from(point.y.atan2(point.x)).abs() - f64::from(config.view_half_angle);
        let aside = f64::from(point.y.abs() - config.robot_radius - config.corridor_margin);
        prop_assume!(off.abs() > 1e-4 && aside.abs() > 1e-4 && point.x.abs() > 1e-4);
        let ahead = point.x > 0.0 && (off < 0.0 || aside < 0.0);
        prop_assert_eq!(following.tick(100, &[(sonar, range)]).is_some(), ahead);
    }
}

/// Beside the angle of view it is followed where the robot, as wide as it is and the margin, would touch it.
#[test]
fn what_the_robot_would_touch_is_ahead() {
    let mut following = Following::new();
    let sonar = following.near(0.87);
    let half = following.config.robot_radius + following.config.corridor_margin;
    let at = following.ring.sonars()[sonar];
    let range = (half - at.position.y) / at.axis.y;
    assert!(following.point(sonar, range).x < following.point(sonar, range).y);
    assert!(
        following
            .clone()
            .tick(100, &[(sonar, range - 0.01)])
            .is_some()
    );
    assert!(following.tick(100, &[(sonar, range + 0.01)]).is_none());
}

/// What has stood for a second does not move, whatever its echoes scatter meanwhile; what is not in sight any
/// more has no trend.
#[test]
fn what_stands_is_steady() {
    let mut following = Following::new();
    let ahead = following.near(0.17);
    let mut told = None;
    for tick in 0..16_u8 {
        // Half a second of 0.12 m/s at the end, within what a still thing's echoes may scatter.
        let range = 1.0 - 0.012 * f32::from(tick.saturating_sub(11));
        told = following.tick(100, &[(ahead, range)]);
    }
    let told = told.expect("an obstacle");
    assert_eq!((told.trend, told.speed.value.get()), (Trend::Steady, 0.0));
    let unseen = following.tick(600, &[]).expect("remembered");
    assert_eq!(unseen.trend, Trend::Unknown);
}

/// A camera's sighting says how fast it is, for the hold time.
#[test]
fn a_camera_says_how_fast() {
    let speed = |age: u64| {
        let mut following = Following::new();
        let ahead = following.near(0.17);
        let mut observation = following.hears(0, &[(ahead, 1.0)]);
        observation.sighting = Some(Sighting {
            displacement: 100.0,
            scale: 0.003,
            interval: 1.0,
            direction: 0.0,
            taken_at: Instant(following.now - age),
        });
        let told = following.told(&observation).expect("an obstacle");
        told.speed.value.get()
    };
    // 0.3 m in a second; without the camera nothing is known yet, which counts as v_o,max.
    assert!((speed(0) - 0.3).abs() < 0.01, "{}", speed(0));
    assert!((speed(1_000) - 0.3).abs() < 0.01);
    assert_eq!(speed(1_001), 0.8);
}

/// Of several the nearest is followed, and stays it, by whatever sonar hears it, until another is clearly
/// nearer.
#[test]
fn one_obstacle_is_followed() {
    let mut following = Following::new();
    let [left, right] = [0.17, -0.17].map(|heading| following.near(heading));
    let distance = |told: Option<Obstacle>| told.expect("an obstacle").distance.get();
    assert_eq!(
        distance(following.tick(100, &[(left, 2.0), (right, 1.5)])),
        1.5
    );
    // It is heard where it was, and something else is nearer, by less than 0.4 m and by more.
    let beside = |range| {
        distance(
            following
                .clone()
                .tick(100, &[(left, range), (right, 1.501)]),
        )
    };
    assert_eq!(beside(1.12), 1.501);
    assert_eq!(beside(1.08), 1.08);
    // It comes nearer, and then into the other's cone.
    assert_eq!(distance(following.tick(100, &[(right, 1.2)])), 1.2);
    assert_eq!(distance(following.tick(100, &[(left, 1.0)])), 1.0);
}

/// Of two echoes near its place the one nearer to the place is it, whichever sonar is asked first.
#[test]
fn the_echo_at_its_place_is_it() {
    for headings in [[0.17, -0.17], [-0.17, 0.17]] {
        let mut following = Following::new();
        let [sonar, other] = headings.map(|heading| following.near(heading));
        let apart = following.point(sonar, 0.8) - following.point(other, 0.85);
        assert!(apart.x.hypot(apart.y) < 0.4);
        following.tick(100, &[(sonar, 0.8)]);
        let told = following.tick(100, &[(sonar, 0.8), (other, 0.85)]);
        assert_eq!(told.expect("an obstacle").distance.get(), 0.8);
    }
}

/// What is not heard is remembered beside an echo from farther away, and not beside one from nearer.
#[test]
fn what_is_nearer_takes_over() {
    let mut following = Following::new();
    let [left, right] = [0.17, -0.52].map(|heading| following.near(heading));
    let distance = |told: Option<Obstacle>| told.map(|told| (told.distance.get() * 100.0).round());
    following.tick(100, &[(left, 1.5)]);
    let beside = |range| distance(following.clone().tick(100, &[(right, range)]));
    assert_eq!(beside(1.6), Some(150.0));
    assert_eq!(beside(1.4), Some(140.0));
}

/// Three looks past its place, by a sonar that covers it, are proof that it has gone; looks elsewhere or a
/// little behind it are none.
#[test]
fn it_is_gone_when_a_sonar_sees_past_it() {
    let looks = |heading: f32, turn: f32, range: f32| {
        let mut following = Following::new();
        let [ahead, other] = [0.17, heading].map(|heading| following.near(heading));
        following.tick(100, &[(ahead, 1.0)]);
        following.pose[2] = turn;
        let kept = |told: Option<Obstacle>| told.is_some_and(|told| told.distance.get() < 1.01);
        (0..5)
            .take_while(|_| kept(following.tick(100, &[(other, range)])))
            .count()
    };
    assert_eq!(looks(0.17, 0.0, 3.0), 2, "past it");
    assert_eq!(looks(0.17, 0.0, 1.45), 2, "just past it");
    assert_eq!(looks(-0.52, 0.0, 3.0), 5, "elsewhere");
    // 12° off the axis, and so too far aside from the echo to be what is heard.
    assert_eq!(looks(0.17, 0.21, 1.45), 2, "just past it");
    assert_eq!(looks(0.17, 0.21, 1.37), 5, "not past it by enough");
}

/// A look that stands is no new one: the time of the last one counts.
#[test]
fn a_reading_that_stands_is_not_heard_again() {
    let mut following = Following::new();
    let ahead = following.near(0.17);
    following.tick(100, &[(ahead, 1.0)]);
    let before = following.now;
    let mut observation = following.hears(100, &[(ahead, 1.0)]);
    let sample = observation.sonar[ahead].as_mut().expect("a sample");
    sample.taken_at = Instant(before);
    let told = following.told(&observation).expect("an obstacle");
    assert!(!told.seen_now && told.visible);
}
