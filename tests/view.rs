//! Chapter `view`: judging readings and remembering them.

mod common;

use common::{
    any_f32, between, config, in_order, length, observations, pioneer, pioneer_with, settings,
    sonar_towards, usual_or_any_config,
};
use nalgebra::Vector2;
use proptest::prelude::*;
use sidestep::avoid::Trend;
use sidestep::config::Config;
use sidestep::failsafe::StopReason;
use sidestep::observation::{Observation, SonarReading, SonarSample, classify};
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::ring::{Placement, Ring, Sonar};
use sidestep::view::{Class, EchoMemory, Hazard, Look, Memory, Odometer, Pose, View, Witness};
use sidestep::wall::Wall;
use sidestep_spec::avoid as law;
use sidestep_spec::view as promise;

/// Echoes of one thing scatter by less than this, in mm.
const SCATTER: i32 = 100;

/// What the promise explains of a thing that is farther after a time: mm in ms, rounded up.
fn explained(config: &Config, milliseconds: u64) -> i32 {
    // The core rounds the speed up to whole mm/s first, and the f32 product before that.
    let speed = f64::from(config.obstacle_speed_max) * 1000.0 + 1.1;
    (speed * milliseconds as f64 / 1000.0).ceil() as i32
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

/// A sonar that looks ahead, of a robot with this configuration.
fn sonar_of(config: &Config) -> (Config, Sonar) {
    let (config, ring) = settings::fitted::<1>(config);
    (config, ring.sonars()[0])
}

/// One sonar with its memory, and a robot that has gone some way.
struct Hearing {
    config: Config,
    sonar: Sonar,
    memory: EchoMemory,
    odometer: Odometer,
}

impl Hearing {
    fn new(config: &Config) -> Self {
        let (config, sonar) = sonar_of(config);
        Self {
            config,
            sonar,
            memory: EchoMemory::default(),
            odometer: Odometer::default(),
        }
    }

    /// Takes in a reading that was taken at one time and looked at at another.
    fn look(&mut self, measured: Option<i32>, taken_at: u64, now: u64, covered: bool) -> Hazard {
        let look = Look {
            measured,
            taken_at: Instant(taken_at),
            now: Instant(now),
            odometer: self.odometer,
            pose: None,
            witness: Witness {
                covered,
                ..Witness::default()
            },
        };
        self.memory.update(&look, &self.sonar, &self.config)
    }

    /// An echo from `range` that is looked at when it is taken.
    fn hear(&mut self, range: i32, at: u64) -> Hazard {
        self.look(Some(range), at, at, true)
    }

    fn hold_time(&self) -> u64 {
        (self.config.hold_time * 1000.0).round() as u64
    }

    fn age_max(&self) -> u64 {
        (self.config.sonar_age_max * 1000.0).round() as u64
    }
}

/// One reading of a sonar: the range if there was an echo, how long after the last, how old when it
/// is read, and how far the robot went and turned meanwhile.
#[derive(Clone, Copy, Debug)]
struct Reading {
    measured: Option<i32>,
    later: u64,
    age: u64,
    way: [i64; 2],
    turned: i64,
    covered: bool,
}

fn any_reading() -> impl Strategy<Value = Reading> {
    let range = prop_oneof![0..6_000_i32, 0..20_000_i32];
    let echo = proptest::option::weighted(0.8, range);
    let age = prop_oneof![2 => Just(0_u64), 1 => 0..500_u64];
    let later = prop_oneof![4 => 0..300_u64, 1 => 0..3_000_u64];
    let way = || prop_oneof![1 => Just(0_i64), 2 => 0..100_i64];
    (echo, later, age, [way(), way()], way(), any::<bool>()).prop_map(
        |(measured, later, age, way, turned, covered)| Reading {
            measured,
            later,
            age,
            way,
            turned,
            covered,
        },
    )
}

impl Reading {
    /// The robot goes its way, and then this is looked at.
    fn arrive(&self, hearing: &mut Hearing, now: &mut u64) -> Hazard {
        *now += self.later;
        let odometer = &mut hearing.odometer;
        odometer.way = [0, 1].map(|i| odometer.way[i] + self.way[i]);
        odometer.turned += self.turned;
        let taken_at = *now - self.age.min(*now);
        hearing.look(self.measured, taken_at, *now, self.covered)
    }
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    //= view.INV-2
    #[test]
    fn nearer_echoes_count_at_once(
        config in usual_or_any_config(),
        readings in proptest::collection::vec(any_reading(), 1..40),
    ) {
        let mut hearing = Hearing::new(&config);
        let mut now = 10_000;
        for reading in readings {
            let hazard = reading.arrive(&mut hearing, &mut now);
            if let Some(measured) = reading.measured {
                prop_assert!(promise::nearer_counts(hazard.range, measured));
            }
            let loss = hearing.sonar.contact_range + (hearing.config.range_error * 1000.0) as i32;
            // One millimetre for rounding the error up.
            prop_assert!((0..=1).contains(&(hazard.range - loss - hazard.clearance)));
        }
    }

    /// Readings that come in order, each measured after the one before.
    //= view.INV-3
    #[test]
    fn one_reading_frees_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32, farther in proptest::option::of(0..20_000_i32),
        later in 0.0_f32..=1.0, age in prop_oneof![Just(0.0_f32), 0.0_f32..=1.0],
        way in [0..300_i64, 0..300_i64], covered in any::<bool>(),
    ) {
        let mut hearing = Hearing::new(&config);
        // Taken and read within the hold time.
        let hold_time = hearing.hold_time() as f32;
        let age = (age * (1.0 - later) * hold_time) as u64;
        let later = (later * hold_time) as u64;
        let before = hearing.hear(range, 10_000);
        hearing.odometer.way = way;
        let taken_at = 10_000 + later;
        let after = hearing.look(farther, taken_at, taken_at + age, covered);
        let own = (way[0] + way[1]) as i32;
        let explained = explained(&config, later) + own + SCATTER;
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
        let mut hearing = Hearing::new(&config);
        let before = hearing.hear(range, 10_000);
        let mut now = 10_000;
        let fewer = config.confirm_samples as usize - 1;
        for (count, (measured, later)) in readings.into_iter().take(fewer).enumerate() {
            now += later;
            prop_assume!(now - 10_000 <= hearing.hold_time());
            let after = hearing.look(measured, now, now, true);
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
        let mut hearing = Hearing::new(&config);
        let before = hearing.hear(range, 10_000);
        let after = hearing.look(Some(farther), 10_000 - earlier, 10_000 + later, true);
        prop_assert!(promise::not_freed_at_once(before.range, after.range, SCATTER));
    }

    /// A reading that is still the latest in the next ticks is one reading, however often it is
    /// looked at.
    //= view.INV-3
    #[test]
    fn one_reading_seen_again_frees_no_place(
        config in usual_or_any_config(),
        range in 0..6_000_i32, farther in 0..20_000_i32, looks in 1..10_u64,
    ) {
        let mut hearing = Hearing::new(&config);
        prop_assume!(100 * (looks + 1) <= hearing.hold_time());
        let before = hearing.hear(range, 10_000);
        for look in 0..looks {
            let after = hearing.look(Some(farther), 10_100, 10_100 + 100 * look, true);
            let explained = explained(&config, 100) + SCATTER;
            prop_assert!(promise::not_freed_at_once(before.range, after.range, explained));
        }
    }

    /// Echoes from farther away say nothing of a place that no sonar looks at: it is held for the
    /// hold time, however many there are.
    //= view.INV-3
    #[test]
    fn a_place_that_is_not_looked_at_is_held(
        config in usual_or_any_config(), range in 0..4_000_i32, period in 20..200_u64,
    ) {
        let mut hearing = Hearing::new(&config);
        let before = hearing.hear(range, 10_000);
        let farther = range + 2_000 + explained(&config, hearing.hold_time());
        let mut now = 10_000 + period;
        while now - 10_000 <= hearing.hold_time() {
            let after = hearing.look(Some(farther), now, now, false);
            prop_assert!(promise::not_freed_at_once(before.range, after.range, 0));
            now += period;
        }
        let after = hearing.look(Some(farther), now, now, false);
        prop_assert_eq!(after.range, farther);
    }

    /// ER-X1: no number of readings without an echo is proof; only time lets go, and that at the
    /// hold time.
    //= view.INV-3
    //= view.INV-7
    #[test]
    fn silence_is_no_proof(config in usual_or_any_config(), range in 0..6_000_i32) {
        let mut hearing = Hearing::new(&config);
        let mut before = hearing.hear(range, 10_000);
        let hold_time = hearing.hold_time();
        for later in (0..=hold_time).step_by(20) {
            let now = 10_000 + later;
            let after = hearing.look(None, now, now, true);
            prop_assert!(promise::not_freed_at_once(range, after.range, 0));
            prop_assert!(no_less_of_a_hazard(&before, &after));
            before = after;
        }
        let after = hearing.look(None, 10_001 + hold_time, 10_001 + hold_time, true);
        prop_assert_eq!(after.range, (hearing.config.sonar_range_max * 1000.0) as i32);
    }

    /// After any readings, not to hear what is held makes it no less of a hazard.
    //= view.INV-7
    #[test]
    fn losing_sight_frees_nothing(
        config in usual_or_any_config(),
        readings in proptest::collection::vec(any_reading(), 1..30),
        silences in proptest::collection::vec((0..300_u64, 0..100_i64), 1..10),
    ) {
        let mut hearing = Hearing::new(&config);
        let mut now = 10_000;
        let mut before = None;
        for reading in readings {
            before = Some(reading.arrive(&mut hearing, &mut now));
        }
        let mut before = before.expect("a reading");
        // Something is held that is not let go of yet.
        let nothing = (hearing.config.sonar_range_max * 1000.0) as i32;
        for (later, way) in silences {
            now += later;
            hearing.odometer.way[0] += way;
            let expired = before.age as u64 + later > hearing.hold_time();
            prop_assume!(before.range < nothing && !expired);
            let after = hearing.look(None, now, now, true);
            prop_assert!(no_less_of_a_hazard(&before, &after));
            prop_assert!(after.way[0] >= before.way[0] && after.turned >= before.turned);
            before = after;
        }
    }
}

/// view.INV-7 of two hazards.
fn no_less_of_a_hazard(before: &Hazard, after: &Hazard) -> bool {
    promise::losing_sight_frees_nothing(
        [before.clearance, after.clearance],
        [before.age, after.age],
        [
            before.class == Class::Unknown,
            after.class == Class::Unknown,
        ],
    )
}

/// What a robot does in a tick: for how many ms, at what share of its greatest speed and turn rate,
/// what its sonar hears and how late that is looked at.
#[derive(Clone, Copy, Debug)]
struct Move {
    time: u64,
    speed: f64,
    turn_rate: f64,
    heard: bool,
    late: u64,
}

fn any_move() -> impl Strategy<Value = Move> {
    let time = prop_oneof![4 => Just(100_u64), 1 => 1..300_u64];
    let share = || prop_oneof![1 => Just(0.0), 4 => -1.0..=1.0_f64];
    // Straight on, or on the spot: of an arc the way is not that of its chord.
    let twist = prop_oneof![
        share().prop_map(|speed| (speed, 0.0)),
        share().prop_map(|turn_rate| (0.0, turn_rate)),
    ];
    let late = prop_oneof![2 => Just(0_u64), 3 => 0..500_u64];
    (time, twist, prop::bool::weighted(0.7), late).prop_map(
        |(time, (speed, turn_rate), heard, late)| Move {
            time,
            speed,
            turn_rate,
            heard,
            late,
        },
    )
}

proptest! {
    #![proptest_config(common::cases(1_000))]

    /// A robot drives to and fro and turns, and hears this and that, sooner or later: whatever is
    /// held, the robot has not gone or turned farther since it was heard than is believed, nor
    /// was it heard earlier.
    //= view.INV-5
    #[test]
    fn nothing_is_forgotten(
        config in usual_or_any_config(),
        moves in proptest::collection::vec(any_move(), 1..40),
    ) {
        let mut hearing = Hearing::new(&config);
        let (speed_max, rate_max) = (
            f64::from(hearing.config.speed_max), f64::from(hearing.config.turn_rate_max),
        );
        // By the millisecond: way forward, way backward, mm; turn, mrad.
        let mut gone = vec![[0.0_f64; 3]; 10_001];
        let mut pose = Pose { position: Vector2::new(0.0, 0.0), heading: Angle::ZERO };
        let (mut at, mut heading) = ([0.0_f64; 2], 0.0_f64);
        let mut heard: Vec<(i32, u64)> = Vec::new();
        for (i, step) in moves.into_iter().enumerate() {
            let (speed, rate) = (step.speed * speed_max, step.turn_rate * rate_max);
            for _ in 0..step.time {
                let mut now = *gone.last().expect("a beginning");
                now[usize::from(speed < 0.0)] += speed.abs();
                now[2] += rate.abs();
                gone.push(now);
                at[0] += speed / 1000.0 * heading.cos();
                at[1] += speed / 1000.0 * heading.sin();
                heading = law::wrap(heading + rate / 1000.0);
            }
            let now = gone.len() as u64 - 1;
            let next = Pose {
                position: Vector2::new(at[0] as f32, at[1] as f32),
                heading: Angle::radians(heading as f32).expect("wrapped"),
            };
            hearing.odometer = hearing.odometer.advanced(&pose, &next);
            pose = next;
            let taken_at = now - step.late;
            // Each range once, so that what is held tells when it was heard.
            let range = 400 + 7 * i as i32 + 1_000 * (i as i32 % 3);
            prop_assume!(range != (hearing.config.sonar_range_max * 1000.0) as i32);
            let measured = step.heard.then_some(range);
            if step.heard {
                heard.push((range, taken_at));
            }
            let hazard = hearing.look(measured, taken_at, now, i % 2 == 0);
            let Some((_, since)) = heard.iter().find(|(range, _)| *range == hazard.range) else {
                continue;
            };
            let before = gone[*since as usize];
            let after = gone[now as usize];
            // Rounded down, and no more than counts: nothing is held for longer than 10 s. The
            // poses are f32: a thousandth of a millimetre.
            let actual = [0, 1, 2].map(|k| ((after[k] - before[k] - 1e-2).max(0.0) as i64).min(10_000));
            let believed = [hazard.age, hazard.way[0], hazard.way[1], hazard.turned];
            let actual = [(now - since) as i64, actual[0], actual[1], actual[2]];
            prop_assert!(
                promise::nothing_forgotten(believed.map(i64::from), actual),
                "{hazard:?} of {actual:?}"
            );
        }
    }
}

// -------------------------------------------------------------------- classes

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// Whatever is heard, nothing is still before it was heard often enough, nor for longer than a
    /// reading is fresh.
    //= view.INV-6
    #[test]
    fn still_is_earned(
        config in usual_or_any_config(),
        readings in proptest::collection::vec(any_reading(), 1..60), steady in any::<bool>(),
    ) {
        let mut hearing = Hearing::new(&config);
        let needed = config.still_samples as u32;
        let (mut now, mut count, mut latest) = (10_000, 0, 0);
        for mut reading in readings {
            if steady {
                // A wall, and a robot that stands.
                reading.measured = reading.measured.map(|_| 2_000);
                reading.way = [0; 2];
                reading.later = reading.later.clamp(1, 100);
                reading.age = 0;
            }
            let hazard = reading.arrive(&mut hearing, &mut now);
            let taken_at = now - reading.age.min(now);
            if reading.measured.is_some() && taken_at > latest {
                count += 1;
                latest = taken_at;
            }
            prop_assert!(promise::still_is_earned(
                hazard.class == Class::Still, count, needed, now - latest, hearing.age_max()
            ));
        }
    }

    /// Someone who walks towards the robot or away from it faster than a still thing may be is never
    /// taken for one, whether the robot stands or drives straight on, at any speed. Sonars within
    /// 60° of straight ahead, at ten readings a second.
    //= view.INV-6
    #[test]
    fn a_person_who_walks_is_not_still(
        walk in 0.31_f64..0.8, away in any::<bool>(), speed in between(0.0, 0.4),
        sonar in 1..7_usize, off_axis in between(-1.0, 1.0), from in 1.0_f64..4.0,
        scatter in proptest::collection::vec(0_i32..20, 60),
    ) {
        let (config, ring) = pioneer_with::<8>();
        let sonar = ring.sonars()[sonar];
        let mut hearing = Hearing { config, sonar, memory: EchoMemory::default(), odometer: Odometer::default() };
        let bearing = f64::from(sonar.heading.get()) + f64::from(off_axis * config.sonar_half_angle);
        let own = f64::from(speed) * bearing.cos();
        let closing = if away { own - walk } else { own + walk };
        for (tick, scatter) in scatter.into_iter().enumerate() {
            let seconds = tick as f64 / 10.0;
            let range = ((from - closing * seconds) * 1000.0) as i32 + scatter;
            if !(200..5_000).contains(&range) {
                break;
            }
            hearing.odometer.way[0] = (f64::from(speed) * seconds * 1000.0).ceil() as i64;
            let hazard = hearing.hear(range, 10_000 + 100 * tick as u64);
            prop_assert_eq!(hazard.class, Class::Unknown, "after {} readings", tick);
        }
    }
}

/// A point of the plane, seen by the sonars of a Pioneer that drives straight on.
fn ranges_of<const N: usize>(ring: &Ring<N>, half_angle: f64, point: [f64; 2], x: f64) -> [f32; N] {
    ring.sonars().map(|sonar| {
        let from = [x + f64::from(sonar.position.x), f64::from(sonar.position.y)];
        let to = [point[0] - from[0], point[1] - from[1]];
        let off = law::wrap(to[1].atan2(to[0]) - f64::from(sonar.heading.get()));
        if off.abs() <= half_angle {
            to[0].hypot(to[1]) as f32
        } else {
            5.0
        }
    })
}

proptest! {
    #![proptest_config(common::cases(500))]

    /// A post that stands still is seen to, by a robot that stands or drives straight on, as soon as
    /// one sonar has heard it often enough.
    //= view.INV-6
    #[test]
    fn a_post_is_still(
        x in 1.2_f64..4.0, y in -1.0_f64..1.0, speed in between(0.0, 0.4),
    ) {
        let (config, ring) = pioneer_with::<16>();
        let mut memory = Memory::default();
        let mut heard = [0_u32; 16];
        let mut still = 0;
        for tick in 0..25_u64 {
            let way = f64::from(speed) * tick as f64 / 10.0;
            let half_angle = f64::from(config.sonar_half_angle);
            let ranges = ranges_of(&ring, half_angle, [x, y], way);
            let mut observation = in_order(10_000 + 100 * tick, ranges);
            let odometry = observation.odometry.as_mut().expect("odometry");
            (odometry.x, odometry.speed) = (way as f32, speed);
            let view = memory.update(&observation, [9.0, 0.0].into(), &ring, &config);
            let view = view.expect("odometry");
            for i in 0..16 {
                heard[i] = if ranges[i] < 5.0 { heard[i] + 1 } else { 0 };
                if heard[i] > config.still_samples as u32 {
                    prop_assert_eq!(view.hazard[i].class, Class::Still, "sonar {}", i);
                    still += 1;
                }
            }
        }
        prop_assert!(still > 0 || speed > 0.1, "nothing was heard for a second");
    }
}

/// A person who begins to walk is no longer still at the next reading that tells them apart: within
/// the tolerance and their first steps.
//= view.INV-6
#[test]
fn whoever_begins_to_walk_is_unknown() {
    let mut hearing = Hearing::new(&pioneer());
    let mut hazard = hearing.hear(1_000, 10_000);
    for tick in 1..30 {
        hazard = hearing.hear(1_000, 10_000 + 100 * tick);
    }
    assert_eq!(hazard.class, Class::Still);
    // 0.8 m/s: 50 mm take less than a reading.
    let hazard = hearing.hear(920, 13_000);
    assert_eq!(hazard.class, Class::Unknown);
    // And they have to stand for as long again.
    for tick in 1..10 {
        assert_eq!(hearing.hear(920, 13_000 + 100 * tick).class, Class::Unknown);
    }
    assert_eq!(hearing.hear(920, 14_000).class, Class::Still);
    // What is not heard any more is not still for long.
    assert_eq!(hearing.look(None, 14_400, 14_400, true).class, Class::Still);
    assert_eq!(
        hearing.look(None, 14_600, 14_600, true).class,
        Class::Unknown
    );
}

/// Something that comes faster than anyone may is said to, and someone at the promised speed is not.
//= view.INV-6
#[test]
fn too_fast_is_noticed() {
    let too_fast = |step: i32| {
        let mut hearing = Hearing::new(&pioneer());
        (0..15)
            .map(|tick| hearing.hear(4_000 - step * tick, 10_000 + 100 * tick as u64))
            .any(|hazard| hazard.too_fast)
    };
    // V is 0.8 m/s, and a quarter more is allowed for.
    assert!(!too_fast(80));
    assert!(!too_fast(100));
    assert!(too_fast(200));
}

/// What a robot hears that drives past the corner of a box: its side slides through the edge of a cone,
/// faster than anybody runs, and the next sonar hears its front. The ranges are from a simulated corridor
/// with a box turned by a few degrees, as the P3-DX's sonar at −30° and the one at −10° heard them. Nobody
/// is named; somebody who comes as fast and nearer than what stands there is, and so is somebody
/// between things that do not agree with the robot's own motion.
//= view.INV-6
#[test]
fn the_side_of_a_box_is_nobody() {
    let (config, ring) = common::pioneer_with::<16>();
    let too_fast = |slanted: [f32; 6], beside: fn(f32) -> f32| {
        let mut memory = Memory::<16>::default();
        (0..18).any(|tick| {
            let x = 0.02 * tick as f32;
            let mut ranges = [5.0; 16];
            ranges[4] = beside(x);
            // It has heard the wall behind for a while.
            ranges[5] = slanted[usize::saturating_sub(tick, 12).min(5)];
            let mut observation = common::in_order(10_000 + 100 * tick as u64, ranges);
            let odometry = observation.odometry.as_mut().expect("odometry");
            (odometry.x, odometry.speed) = (x, 0.2);
            let view = memory.update(&observation, Vector2::new(9.0, 0.0), &ring, &config);
            view.expect("a view").hazard[5].too_fast
        })
    };
    let sliding = [1.297, 1.021, 0.791, 0.591, 0.448, 0.430];
    let front = |x| 0.76 - x;
    assert!(!too_fast(sliding, front));
    assert!(too_fast(sliding, |_| 5.0), "nothing stands there");
    assert!(too_fast(sliding, |x| 1.76 - x), "it stands farther away");
    assert!(too_fast(sliding, |x| 0.76 - 5.0 * x), "it moves as well");
}

// ------------------------------------------------- what stands still, backward and turning

/// What one sonar, straight ahead, says after each of these steps (way forward, way back, turn, range),
/// which are repeated 25 times: a mm, mrad or mm of range more each tenth of a second.
fn stepping(from: i32, [ahead, back, turned, range]: [i32; 4]) -> Vec<Hazard> {
    let mut hearing = Hearing::new(&pioneer());
    let mut tick = |k: i32| {
        hearing.odometer = Odometer {
            way: [ahead, back].map(|step| i64::from(step * k)),
            turned: i64::from(turned * k),
        };
        hearing.hear(from + range * k, 10_000 + 100 * k as u64)
    };
    (0..25).map(&mut tick).collect()
}

fn becomes_still(from: i32, steps: [i32; 4]) -> bool {
    let hazards = stepping(from, steps);
    hazards.iter().any(|hazard| hazard.class == Class::Still)
}

/// A thing that stands ahead is still whether the robot drives at it, backs off or turns a little; one that
/// keeps its distance meanwhile is not.
//= view.INV-6
#[test]
fn what_stands_is_still_backward_and_turning() {
    assert!(becomes_still(4_000, [100, 0, 0, -100]));
    assert!(becomes_still(1_000, [0, 100, 0, 100]));
    assert!(becomes_still(4_000, [100, 0, 30, -100]));
    assert!(!becomes_still(1_000, [100, 0, 0, 0]), "it recedes");
    assert!(!becomes_still(1_000, [0, 100, 0, 0]), "it follows");
}

/// A still thing is one until it was not heard for longer than a reading is fresh, to the millisecond.
//= view.INV-6
#[test]
fn a_pause_begins_anew() {
    for (pause, class) in [(500, Class::Still), (501, Class::Unknown)] {
        let mut hearing = Hearing::new(&pioneer());
        for tick in 0..=10 {
            hearing.hear(1_000, 10_000 + 100 * tick);
        }
        assert_eq!(
            hearing.hear(1_000, 11_000 + pause).class,
            class,
            "{pause} ms"
        );
    }
}

/// At which step something is said to be too fast.
fn too_fast_at(steps: [i32; 4]) -> Option<usize> {
    let hazards = stepping(4_500, steps);
    hazards.iter().position(|hazard| hazard.too_fast)
}

/// Too fast is what was so in more readings than confirm a thing, by more than twice the tolerance in all.
/// The robot's own way, forward or back, explains twice itself.
//= view.INV-6
#[test]
fn too_fast_takes_several_readings() {
    // 100 mm a reading are allowed, and 100 mm in all: the fifth excess of 25 mm is the first beyond.
    assert_eq!(too_fast_at([0, 0, 0, -125]), Some(5));
    assert_eq!(too_fast_at([0, 0, 0, -126]), Some(4));
    assert_eq!(too_fast_at([0, 0, 0, -200]), Some(4));
    // Up to 4 m/s and the tolerance it may be one thing that comes nearer; what leaps farther is another.
    assert_eq!(too_fast_at([0, 0, 0, -440]), Some(4));
    assert_eq!(too_fast_at([0, 0, 0, -460]), None);
    for way in [[50, 0], [0, 50]] {
        let [ahead, back] = way;
        assert_eq!(too_fast_at([ahead, back, 0, -200]), None);
        assert_eq!(too_fast_at([ahead, back, 0, -230]), Some(4));
    }
}

/// A sonar that reads the same while the robot drives at what it hears is stuck after 400 mm, if it looks
/// ahead; each change begins anew.
//= view.INV-5
#[test]
fn a_sonar_that_never_changes_is_stuck() {
    let stuck_at = |sonar: Sonar, changes: &[i32]| {
        let mut hearing = Hearing::new(&pioneer());
        hearing.sonar = sonar;
        (0..30).position(|k: i32| {
            hearing.odometer.way[0] = i64::from(50 * k);
            let range = 1_000 + changes.iter().filter(|at| k >= **at).count() as i32;
            hearing.hear(range, 10_000 + 100 * k as u64).stuck
        })
    };
    let ring = pioneer_with::<8>().1;
    let [ahead, aside] = [3, 0].map(|i| ring.sonars()[i]);
    assert!(ahead.closing.face[0] >= 500 && aside.closing.face[0] < 500);
    assert_eq!(stuck_at(ahead, &[]), Some(8));
    assert_eq!(stuck_at(ahead, &[4]), Some(12));
    assert_eq!(stuck_at(aside, &[]), None);
}

// ------------------------------------------------------------------------------------ walls

/// The direction of a wall on the side to which a sonar looks that leans forward by a share `along`.
fn wall_normal(along: f64, sonar: &Sonar) -> [f64; 2] {
    let across = f64::from(sonar.axis.y.signum());
    [along, across * (1.0 - along * along).sqrt()]
}

/// What a sonar hears of a wall on its side, `distance` m from the robot's centre, whose normal leans
/// forward by a share `along`, m: to the perpendicular's foot, where its axis meets the wall, and to the
/// nearest point in a cone of 15°.
fn hears_wall(along: f64, distance: f64, sonar: &Sonar) -> [f64; 3] {
    let normal = wall_normal(along, sonar);
    let [face, axis] = [sonar.position, sonar.axis].map(|v| [f64::from(v.x), f64::from(v.y)]);
    let dot = |a: [f64; 2]| normal[0] * a[0] + normal[1] * a[1];
    let off = distance - dot(face);
    let angle = dot(axis).clamp(-1.0, 1.0).acos();
    let nearest = (angle - f64::from(std::f32::consts::FRAC_PI_6) / 2.0).max(0.0);
    [off, off / angle.cos(), off / nearest.cos()]
}

proptest! {
    #![proptest_config(common::cases(1_000))]

    /// A wall is found from two sonars that look straight across, and explains what the slanted ones
    /// between them hear of it, from the nearest point of the cone to where the axis meets it; what is
    /// clearly nearer or farther it does not explain, nor what looks away from it.
    //= view.INV-6
    #[test]
    fn a_wall_explains_what_is_heard_of_it(
        along in -0.25_f64..0.25, distance in 0.4_f64..2.0, left in any::<bool>(), share in 0.0_f64..=1.0,
        aside in -0.1_f32..0.1,
    ) {
        let (config, ring) = pioneer_with::<16>();
        let sonars = ring.sonars();
        let is_left = |sonar: &&Sonar| (sonar.axis.y > 0.0) == left;
        let across: Vec<&Sonar> = sonars.iter().filter(is_left).filter(|s| s.axis.x.abs() < 0.26).collect();
        prop_assert_eq!(across.len(), 2);
        // One face is farther aside than the other.
        let [mut one, other] = [0, 1].map(|i| *across[i]);
        one.position.y += aside;
        let ranges = [one, other].map(|sonar| hears_wall(along, distance, &sonar)[0] as f32);
        prop_assume!(ranges.iter().all(|range| *range > 0.1));
        let wall = Wall::through([&one, &other], ranges, &config).expect("a wall");
        for sonar in sonars.iter().filter(is_left) {
            let [off, axis, nearest] = hears_wall(along, distance, sonar);
            let square_on = off / axis > 0.71 && sonar.axis.x.abs() > 0.26;
            let range = nearest + share * (axis - nearest);
            let explains = |range: f64| wall.explains(range as f32, sonar, &config);
            if square_on {
                prop_assert!(explains(range), "{range} of {nearest} to {axis}");
                prop_assert!(!explains(nearest - 0.08) && !explains(axis + 0.08));
            } else if off / axis < 0.69 || sonar.axis.x.abs() < 0.25 {
                prop_assert!(!explains(range));
            }
            // From just behind the wall nothing is heard of it.
            let mut behind = *sonar;
            let normal = wall_normal(along, sonar).map(|coordinate| coordinate as f32);
            behind.position += Vector2::from(normal) * (off as f32 + 0.01);
            prop_assert!(!wall.explains(0.01, &behind, &config));
        }
        for sonar in sonars.iter().filter(|sonar| !is_left(sonar)) {
            prop_assert!(!wall.explains(distance as f32, sonar, &config));
        }
        // Seen at more than a cone's half angle it would not have been heard like that.
        let [one, other] = [across[0], across[1]];
        let baseline = one.position.x - other.position.x;
        let steep = [ranges[0], ranges[0] + 0.27 * baseline];
        prop_assert!(Wall::through([one, other], steep, &config).is_none());
        prop_assert!(Wall::through([one, one], [ranges[0]; 2], &config).is_none());
    }
}

/// Faces 15 cm apart are far enough apart; a sonar 0.26 off straight across is slanted, and one at a cosine
/// of 0.7 square enough on.
#[test]
fn limits_of_a_wall_belong_to_it() {
    let (config, ring) = pioneer_with::<16>();
    let looking = |x: f32, axis: [f32; 2]| Sonar {
        position: [x, 0.2].into(),
        axis: axis.into(),
        ..ring.sonars()[0]
    };
    let [front, rear, nearer] = [0.15, 0.0, 0.01].map(|x| looking(x, [0.0, 1.0]));
    let through = |rear| Wall::through([&front, rear], [1.0, 1.0], &config);
    assert!(through(&nearer).is_none());
    let wall = through(&rear).expect("a wall");
    for (axis, range, explained) in [
        ([0.26, 0.9656], 1.0, true),
        ([0.259, 0.9659], 1.0, false),
        ([0.714, 0.7], 1.3, true),
        ([0.715, 0.699], 1.3, false),
    ] {
        let slanted = looking(0.0, axis);
        assert_eq!(
            wall.explains(range, &slanted, &config),
            explained,
            "{axis:?}"
        );
    }
}

/// Along a wall a slanted sonar hears the same all the time, as if somebody walked ahead: it is still where
/// the sonars that look straight across hear the same wall, and only there.
//= view.INV-6
#[test]
fn a_wall_along_the_way_is_still() {
    let (config, ring) = pioneer_with::<16>();
    for left in [true, false] {
        let side = |sonar: &&Sonar| (sonar.axis.y > 0.0) == left;
        let across: Vec<usize> = (0..16)
            .filter(|i| ring.sonars()[*i].axis.x.abs() < 0.26)
            .collect();
        let slanted = (0..16).find(|i| {
            let at = &ring.sonars()[*i];
            side(&at) && (0.5..0.7).contains(&at.axis.x)
        });
        let slanted = slanted.expect("a sonar at 50°");
        let class = |wall: [bool; 2], scatter: f32| {
            let mut memory = Memory::<16>::default();
            let mut class = Class::Unknown;
            for tick in 0..25_u16 {
                let mut ranges = [5.0; 16];
                for (i, range) in ranges.iter_mut().enumerate() {
                    let sonar = &ring.sonars()[i];
                    let [off, _, nearest] = hears_wall(0.0, 0.8, sonar);
                    if across.contains(&i) && wall[usize::from(!side(&sonar))] {
                        *range = off as f32 + scatter * f32::from(tick % 2);
                    } else if i == slanted {
                        *range = nearest as f32;
                    }
                }
                let mut observation = in_order(10_000 + 100 * u64::from(tick), ranges);
                let odometry = observation.odometry.as_mut().expect("odometry");
                (odometry.x, odometry.speed) = (0.04 * f32::from(tick), 0.4);
                let view = memory.update(&observation, Vector2::new(9.0, 0.0), &ring, &config);
                class = view.expect("a view").hazard[slanted].class;
            }
            class
        };
        assert_eq!(class([true, false], 0.01), Class::Still, "left {left}");
        assert_eq!(class([false, true], 0.0), Class::Unknown, "left {left}");
        // What comes and goes beside it is no wall.
        assert_eq!(class([true, false], 0.2), Class::Unknown, "left {left}");
    }
}

// ------------------------------------------------------------------ the view

/// Points go from the robot's frame to the odometry's and back.
#[test]
fn frames_are_turned_and_moved() {
    let pose = |heading: f32| Pose {
        position: Vector2::new(1.0, 2.0),
        heading: Angle::radians(heading).expect("an angle"),
    };
    let close = |a: Vector2<f32>, b: [f32; 2]| (a - Vector2::from(b)).amax() < 1e-5;
    let point = Vector2::new(3.0, 4.0);
    let left = pose(std::f32::consts::FRAC_PI_2);
    assert!(close(left.to_world(point), [-3.0, 5.0]));
    assert!(close(left.to_robot([-3.0, 5.0].into()), [3.0, 4.0]));
    let slanted = pose(std::f32::consts::FRAC_PI_6);
    let (sin, cos) = (0.5, 0.866_025_4);
    let world = [1.0 + 3.0 * cos - 4.0 * sin, 2.0 + 3.0 * sin + 4.0 * cos];
    assert!(close(slanted.to_world(point), world));
    assert!(close(slanted.to_robot(world.into()), [3.0, 4.0]));
}

/// What a view says of the room: ahead within the angle of view, to the sides, straight across.
#[test]
fn rooms_are_measured() {
    let (config, ring) = pioneer_with::<16>();
    let view = |near: &dyn Fn(&Sonar) -> Option<f32>| {
        let ranges = ring.sonars().map(|sonar| near(&sonar).unwrap_or(5.0));
        let view = watch(&config, &[in_order(10_000, ranges)])[0].expect("odometry");
        let both = |lengths: [Length; 2]| lengths.map(Length::get);
        (view.ahead.get(), both(view.room), both(view.beside))
    };
    let far = 5.0;
    assert_eq!(view(&|_| None), (far, [far; 2], [far; 2]));
    let angle = config.view_half_angle;
    let ahead = view(&|at| (at.heading.get().abs() <= angle).then_some(1.25));
    assert_eq!(ahead.0, 1.25);
    let slanted = view(&|at| (at.axis.x > 0.1 && at.axis.y > 0.0).then_some(1.25));
    assert_eq!(slanted.1, [1.25, far]);
    let slanted = view(&|at| (at.axis.x > 0.1 && at.axis.y < 0.0).then_some(1.25));
    assert_eq!(slanted.1, [far, 1.25]);
    // What is behind says nothing of the room to choose from.
    let behind = view(&|at| (at.axis.x < -0.2).then_some(1.25));
    assert_eq!(behind, (far, [far; 2], [far; 2]));
    for (left, expected) in [(true, [0, 1]), (false, [1, 0])] {
        let across = |at: &Sonar| at.axis.x.abs() < 0.1 && (at.axis.y > 0.0) == left;
        let (_, room, beside) = view(&|at| across(at).then_some(0.75));
        assert_eq!([room[expected[0]], room[expected[1]]], [0.75, far]);
        let face = ring.sonars().iter().find(|at| across(at)).expect("one");
        assert!((beside[expected[0]] - 0.75 - face.position.y.abs()).abs() < 1e-6);
        assert_eq!(beside[expected[1]], far);
    }
}

/// A reading that was there in the tick before is no news for the law.
#[test]
fn a_reading_of_the_last_tick_is_no_news() {
    for (taken_at, seen) in [(10_000, false), (10_001, true)] {
        let mut second = in_order(10_100, [1.0, 5.0, 5.0]);
        if let Some(sample) = &mut second.sonar[0] {
            sample.taken_at = Instant(taken_at);
        }
        let views = watch(&pioneer(), &[in_order(10_000, [5.0; 3]), second]);
        let view = views[1].as_ref().expect("odometry");
        assert_eq!(view.obstacle.is_some(), seen, "{taken_at}");
    }
}

/// The law is told that what has stood still for so long does not move, and not before.
#[test]
fn the_law_is_told_what_stands() {
    let views = ahead(&[1.0; 12]);
    let told = |tick: usize| views[tick].obstacle.expect("an obstacle");
    let speed_max = pioneer().obstacle_speed_max;
    assert_eq!(told(1).trend, Trend::Unknown);
    assert_eq!(told(1).speed.value.get(), speed_max);
    assert_eq!(told(11).trend, Trend::Steady);
    assert_eq!(told(11).speed.value.get(), 0.0);
}

/// A post that one sonar has heard for long, and then another after the robot has turned: `offset` m nearer
/// or farther, with samples that were taken so late, and has turned by so many times the angle that puts the
/// post where the first heard it. Returns what both sonars hold in the two ticks after.
/// Before, the other heard the wall behind.
fn handed_over(offset: f32, second: bool, taken: u64, turns: f32) -> [[Hazard; 2]; 2] {
    let (config, ring) = pioneer_with::<16>();
    let heading = |i: usize| ring.sonars()[i].heading.get();
    let [one, other] = [0.17, -0.17].map(|heading| sonar_towards(&ring, heading));
    let turn = turns * (heading(one) - heading(other));
    let mut memory = Memory::<16>::default();
    let mut tick = |t: u64, heard: [f32; 2], turned: f32| {
        let mut ranges = [5.0; 16];
        [ranges[one], ranges[other]] = heard;
        let mut observation = in_order(t, ranges);
        observation.odometry.as_mut().expect("odometry").heading = turned;
        if turned > 0.0 {
            let sample = observation.sonar[other].as_mut().expect("a sample");
            sample.taken_at = Instant(t - 100 + taken);
        }
        let view = memory.update(&observation, Vector2::new(9.0, 0.0), &ring, &config);
        let view = view.expect("a view");
        [view.hazard[one], view.hazard[other]]
    };
    for k in 0..=12 {
        tick(10_000 + 100 * k, [1.0, 3.0], 0.0);
    }
    let heard = if second { 1.0 + offset } else { 5.0 };
    [11_300, 11_400].map(|t| tick(t, [5.0, heard], turn))
}

/// What one sonar held is another's as soon as that hears it there: it is let go, and as still as it was.
/// What is heard elsewhere, not at all, or no later says nothing of it.
//= view.INV-3
//= view.INV-6
#[test]
fn what_another_sonar_hears_is_handed_over() {
    let [first, then] = handed_over(0.0, true, 100, 1.0);
    assert_eq!(first[0].range, 5_000, "let go");
    assert_eq!(first[1].range, 1_000);
    assert_eq!([first[1].class, then[1].class], [Class::Still; 2]);
    let [first, then] = handed_over(-0.3, true, 100, 1.0);
    assert_eq!(first[0].range, 5_000, "something nearer hides it");
    assert_eq!(then[1].class, Class::Unknown, "another thing");
    let [first, _] = handed_over(0.3, true, 100, 1.0);
    assert_eq!(first[0].range, 1_000, "heard behind it");
    let [first, _] = handed_over(0.0, false, 100, 1.0);
    assert_eq!(first[0].range, 1_000, "not heard");
    let [first, _] = handed_over(0.0, true, 0, 1.0);
    assert_eq!(first[0].range, 1_000, "heard no later");
    let [first, then] = handed_over(0.0, true, 100, 2.0);
    assert_eq!(first[0].range, 1_000, "heard beside it");
    assert_eq!(then[1].class, Class::Unknown, "another thing");
}

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
            assert!(promise::nearer_counts(view.hazard[i].range, measured));
        }
        let hazard = &view.hazard[i];
        assert!(hazard.clearance <= hazard.range - ring.sonars()[i].contact_range);
        assert!(hazard.age >= 0 && hazard.turned >= 0 && hazard.way.iter().all(|way| *way >= 0));
    }
}

/// Observations one after the other, as views.
fn watch<const N: usize>(
    config: &Config,
    observations: &[Observation<N>],
) -> Vec<Result<View<N>, StopReason>> {
    let (config, ring) = settings::fitted::<N>(config);
    let config = &config;
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
        let (config, ring) = pioneer_with::<8>();
        let views = watch(&config, &[in_order(10_000, ranges)]);
        let view = views[0].expect("odometry");
        for (i, sonar) in ring.sonars().iter().enumerate() {
            let measured = (ranges[i] * 1000.0) as i32;
            prop_assert_eq!(view.hazard[i].range, measured);
            // Less 20 mm, by which a range may be too long.
            prop_assert_eq!(view.hazard[i].clearance, measured - sonar.contact_range - 20);
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
/// the shield knows how long ago they were.
//= view.INV-3
//= view.INV-7
#[test]
fn someone_out_of_hearing_is_still_there() {
    let views = ahead(&[1.0, 5.0, 5.0, 5.0, 5.0]);
    for pair in views.windows(2) {
        let [before, after] = [&pair[0], &pair[1]];
        let (before, heard) = (&before.hazard[0], &after.hazard[0]);
        assert!(promise::not_freed_at_once(before.range, heard.range, 0));
        assert!(no_less_of_a_hazard(before, heard));
        assert_eq!(heard.age, before.age + 100);
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
    assert!(views[10].obstacle.is_some() && views[10].hazard[0].range == 1_000);
    assert!(views[11].obstacle.is_none() && views[11].hazard[0].range == 5_000);
}

/// An echo from behind their place, again and again, is proof that they have gone; once is not.
//= view.INV-3
#[test]
fn echoes_from_behind_are_proof() {
    let views = ahead(&[1.0, 3.0, 3.0, 3.0]);
    assert_eq!(views[1].hazard[0].range, 1_000);
    assert_eq!(views[2].hazard[0].range, 1_000);
    assert_eq!(views[3].hazard[0].range, 3_000);
    // For the law too: it is told of who was there until then.
    let distance = |view: &View<3>| {
        view.obstacle
            .map(|obstacle| obstacle.distance.get().round())
    };
    let distances: Vec<_> = views.iter().map(distance).collect();
    assert_eq!(distances, [Some(1.0), Some(1.0), Some(1.0), Some(3.0)]);
    // A silence in between, and the count begins again.
    let views = ahead(&[1.0, 3.0, 3.0, 5.0, 3.0, 3.0, 3.0]);
    let ranges: Vec<_> = views.iter().map(|view| view.hazard[0].range).collect();
    assert_eq!(ranges, [1_000, 1_000, 1_000, 1_000, 1_000, 1_000, 3_000]);
}

/// A contact is an echo at nothing.
//= view.INV-2
#[test]
fn a_contact_is_the_nearest_echo() {
    let views = ahead(&[1.0, 0.01, 5.0]);
    assert_eq!(views[1].hazard[0].range, 0);
    assert_eq!(views[2].hazard[0].range, 0);
}

/// Where a sonar may be, and which way it may look.
fn placement() -> impl Strategy<Value = Placement> {
    (between(-2.0, 2.0), between(-2.0, 2.0), -3.1_f32..3.1).prop_map(|(x, y, heading)| Placement {
        x,
        y,
        heading,
    })
}

/// A sonar at a place, and a point in its cone: at a range, and at a share of half its angle aside.
fn seen(config: &Config, at: Placement, range: f32, off_axis: f32) -> (Sonar, [f64; 2]) {
    let mut p = *config.parameters();
    // So that nothing is refused: a ring may be as blind as can be, and reacts at once.
    p.blind_angle_max = 3.15;
    p.obstacle_speed_max = 0.0;
    p.still_speed_max = 0.0;
    p.still_speed_max_turning = 0.0;
    p.reaction_time = 0.02;
    p.acceleration = 0.05;
    p.cruise_speed = 0.01;
    p.sonar_range_max = 20.0;
    p.safe_distance = 10.0;
    let config = Config::new(p).expect("still in range");
    let ring = Ring::new(&[at], &config).expect("a ring that sees what it sees");
    let direction = f64::from(at.heading) + f64::from(off_axis * config.sonar_half_angle);
    let range = f64::from(range);
    let point = [
        f64::from(at.x) + range * direction.cos(),
        f64::from(at.y) + range * direction.sin(),
    ];
    (ring.sonars()[0], point)
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// The contact range of a sonar: whatever is in its cone at a range is at least that range,
    /// less the contact range, away from the robot's circle. To a hundredth of a millimetre, which
    /// the f32 positions of the test may be off.
    #[test]
    fn contact_range_covers_the_hull(
        config in config(), at in placement(),
        range in between(0.0, 20.0), off_axis in between(-1.0, 1.0),
    ) {
        let (sonar, point) = seen(&config, at, range, off_axis);
        let from_hull = 1000.0 * (point[0].hypot(point[1]) - f64::from(config.robot_radius));
        let believed = 1000.0 * f64::from(range) - f64::from(sonar.contact_range);
        prop_assert!(believed <= from_hull + 0.01, "{believed} > {from_hull}");
    }

    /// The closing cosines of a sonar: whatever is in its cone, from its face on, lies in no direction
    /// from the robot's centre to which the robot closes more directly; and as seen from the face,
    /// within those of the cone. To a thousandth, which they are rounded by.
    //= shield.INV-9
    #[test]
    fn closing_covers_the_cone(
        config in config(), at in placement(),
        range in between(0.0, 20.0), off_axis in between(-1.0, 1.0),
    ) {
        let (sonar, point) = seen(&config, at, range, off_axis);
        let closing = sonar.closing;
        let away = point[0].hypot(point[1]);
        prop_assume!(away > 1e-3);
        let ahead = 1000.0 * point[0] / away;
        prop_assert!(f64::from(closing.ahead) >= ahead - 0.1, "{closing:?} of {ahead}");
        prop_assert!(f64::from(closing.back) >= -ahead - 0.1, "{closing:?} of {ahead}");
        let direction = f64::from(at.heading) + f64::from(off_axis * config.sonar_half_angle);
        let from_face = 1000.0 * direction.cos();
        prop_assert!(f64::from(closing.face[0]) <= from_face + 0.1);
        prop_assert!(f64::from(closing.face[1]) >= from_face - 0.1);
        // Not by more than it takes: a sonar in the middle closes as its cone does.
        prop_assert!(closing.ahead <= 1000 && closing.back <= 1000);
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

    /// A share of a speed is that share; what is no share, NaN too, leaves none.
    #[test]
    fn speeds_are_scaled(metres_per_second in 0.0_f32..=10.0, factor in prop_oneof![0.0_f32..=1.0, any_f32()]) {
        let speed = Speed::metres_per_second(metres_per_second).expect("a speed");
        let share = if (0.0..=1.0).contains(&factor) { factor } else { 0.0 };
        prop_assert_eq!(speed.scaled(factor).get(), metres_per_second * share);
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
