//! Where the property tests take their inputs from.
#![allow(dead_code, reason = "each test file needs a part of this")]

use nalgebra::Vector2;
use proptest::array::UniformArrayStrategy;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::RngSeed;
use sidestep::avoid::{ObstacleSpeed, Trend};
use sidestep::config::{Config, FIELDS, Parameters};
use sidestep::law::Advice;
use sidestep::observation::{
    BaseStatus, Observation, OdometrySample, Sighting, SonarReading, SonarSample,
};
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::ring::Ring;
use sidestep::track::Obstacle;
use sidestep::view::{Class, GoalView, Hazard, Pose, View};
use std::f32::consts::PI;

#[path = "../../fuzz/targets/settings.rs"]
pub mod settings;

/// How often a property is put to the test: `usual` times, with the same inputs in every run.
///
/// `PROPTEST_CASES` counts relative to its usual 256, so 25600 is a hundred times as many of each;
/// `PROPTEST_RNG_SEED` gives other inputs.
pub fn cases(usual: u32) -> ProptestConfig {
    let wanted = ProptestConfig::default();
    ProptestConfig {
        cases: (u64::from(usual) * u64::from(wanted.cases) / 256) as u32,
        rng_seed: match wanted.rng_seed {
            RngSeed::Random => RngSeed::Fixed(0),
            fixed => fixed,
        },
        // What fails fails again, and says with what.
        failure_persistence: None,
        max_global_rejects: 1 << 20,
        ..wanted
    }
}

/// The Pioneer preset.
pub fn pioneer() -> Config {
    Config::new(preset::PIONEER_3DX).expect("the preset is good")
}

/// The Pioneer preset for a robot with `N` sonars, and its ring.
pub fn pioneer_with<const N: usize>() -> (Config, Ring<N>) {
    settings::fitted(&pioneer())
}

/// The sonar of a ring that looks most nearly in a direction of the robot's frame, radians.
pub fn sonar_towards<const N: usize>(ring: &Ring<N>, heading: f32) -> usize {
    let off = |i: &usize| (ring.sonars()[*i].heading.get() - heading).abs();
    let nearest = (0..N).min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.expect("a sonar")
}

/// Any `f32`: numbers as sensors give them, values where something changes, any bit pattern.
pub fn any_f32() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -10.0_f32..10.0,
        2 => -1e3_f32..1e3,
        1 => select(&[0.0, -0.0, 1.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX,
            f32::MIN, f32::MIN_POSITIVE, 1e-45][..]),
        2 => any::<u32>().prop_map(f32::from_bits),
    ]
}

/// A number of a range, its ends more often than by chance.
pub fn between(least: f32, greatest: f32) -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => least..=greatest,
        1 => Just(least),
        1 => Just(greatest),
    ]
}

/// Any length: mostly one that a sonar measures.
pub fn length() -> impl Strategy<Value = Length> {
    prop_oneof![4 => between(0.0, 5.0), 1 => between(0.0, 1000.0), 1 => 0.0_f32..1e-3]
        .prop_map(|metres| Length::metres(metres).expect("a length"))
}

/// Any speed: mostly one of a person.
pub fn speed() -> impl Strategy<Value = Speed> {
    prop_oneof![4 => between(0.0, 2.0), 1 => between(0.0, 10.0)]
        .prop_map(|speed| Speed::metres_per_second(speed).expect("a speed"))
}

/// Any angle.
pub fn angle() -> impl Strategy<Value = Angle> {
    prop_oneof![
        8 => -PI..=PI,
        1 => select(&[0.0, PI, PI / 2.0, -PI / 2.0, PI / 3.0, 1e-7, -1e-7][..]),
    ]
    .prop_map(|radians| Angle::radians(radians).expect("an angle"))
}

/// Any configuration that can be constructed.
pub fn config() -> impl Strategy<Value = Config> {
    let share = prop_oneof![4 => 0.0_f32..=1.0, 2 => 0.0_f32..0.05, 1 => Just(0.0), 1 => Just(1.0)];
    UniformArrayStrategy::<_, [f32; FIELDS.len()]>::new(share)
        .prop_map(|shares| settings::config(&shares))
}

/// A preset as often as any other configuration.
pub fn usual_or_any_config() -> impl Strategy<Value = Config> {
    const PRESETS: &[Parameters] = &[
        preset::SRIKANDI_II_2012,
        preset::SRIKANDI_II_2011,
        preset::PIONEER_3DX,
    ];
    prop_oneof![
        select(PRESETS).prop_map(|preset| Config::new(preset).expect("the preset is good")),
        config(),
    ]
}

/// Any bit patterns as a sighting.
pub fn sighting() -> impl Strategy<Value = Sighting> {
    let fields = (any_f32(), any_f32(), any_f32(), any_f32(), 0..20_000_u64);
    fields.prop_map(
        |(displacement, scale, interval, direction, taken_at)| Sighting {
            displacement,
            scale,
            interval,
            direction,
            taken_at: Instant(taken_at),
        },
    )
}

/// A sighting that a camera can make.
pub fn usable_sighting() -> impl Strategy<Value = Sighting> {
    let degrees_60 = std::f32::consts::FRAC_PI_3;
    (
        0.0_f32..500.0,
        0.0_f32..0.05,
        0.05_f32..2.0,
        between(0.0, degrees_60),
    )
        .prop_map(|(displacement, scale, interval, direction)| Sighting {
            displacement,
            scale,
            interval,
            direction,
            taken_at: Instant(0),
        })
}

/// Any advice, any bit patterns included.
pub fn advice() -> impl Strategy<Value = Advice> {
    let number = || prop_oneof![3 => -3.0_f32..3.0, 1 => any_f32()];
    (number(), number()).prop_map(|(speed, turn_rate)| Advice { speed, turn_rate })
}

/// Any trend.
pub fn trend() -> impl Strategy<Value = Trend> {
    select(
        &[
            Trend::Closing,
            Trend::Steady,
            Trend::Receding,
            Trend::Unknown,
        ][..],
    )
}

/// Any judged reading.
pub fn reading() -> impl Strategy<Value = SonarReading> {
    prop_oneof![
        4 => length().prop_map(SonarReading::Echo),
        4 => length().prop_map(SonarReading::NoEcho),
        1 => Just(SonarReading::TooNear),
        1 => Just(SonarReading::Stale),
        1 => Just(SonarReading::Invalid),
    ]
}

/// A point of the odometry frame.
pub fn point() -> impl Strategy<Value = Vector2<f32>> {
    let coordinate = || prop_oneof![4 => -5.0_f32..5.0, 1 => between(-1e4, 1e4)];
    (coordinate(), coordinate()).prop_map(|(x, y)| Vector2::new(x, y))
}

/// Any obstacle.
pub fn obstacle() -> impl Strategy<Value = Obstacle> {
    let motion = (trend(), speed(), any::<bool>(), any::<bool>());
    (length(), -4_000..4_000, angle(), point(), motion).prop_map(
        |(distance, contact_range, direction, position, motion)| {
            let (trend, value, saturated, visible) = motion;
            Obstacle {
                distance,
                contact_range,
                direction,
                position,
                trend,
                speed: ObstacleSpeed { value, saturated },
                visible,
                seen_now: visible,
            }
        },
    )
}

/// The status of a base that is mostly in order.
pub fn base() -> impl Strategy<Value = BaseStatus> {
    prop_oneof![
        6 => Just([true, false, false]),
        1 => any::<[bool; 3]>(),
    ]
    .prop_map(|[motors_enabled, stalled, emergency_stop]| BaseStatus {
        motors_enabled,
        stalled,
        emergency_stop,
    })
}

/// Anything that a sonar may be believed to have in front of it.
pub fn hazard() -> impl Strategy<Value = Hazard> {
    let range = prop_oneof![4 => 0..5_000, 1 => 0..1_000_000];
    let clearance = prop_oneof![6 => -500..5_000, 1 => -1_000_000..1_000_000];
    let age = prop_oneof![2 => Just(0), 4 => 0..500, 1 => 0..=10_000];
    let way = || prop_oneof![2 => Just(0), 4 => 0..200, 1 => 0..=10_000];
    let turned = prop_oneof![2 => Just(0), 4 => 0..500, 1 => 0..=10_000];
    let class = prop_oneof![Just(Class::Still), Just(Class::Unknown)];
    let seldom = || prop::bool::weighted(0.02);
    let flags = (seldom(), seldom());
    (range, clearance, age, [way(), way()], turned, class, flags).prop_map(
        |(range, clearance, age, way, turned, class, (too_fast, stuck))| Hazard {
            range,
            clearance,
            age,
            way,
            turned,
            class,
            too_fast,
            stuck,
        },
    )
}

/// Any view that a robot with `N` sonars can have, of any time.
pub fn view<const N: usize>() -> impl Strategy<Value = View<N>> {
    let pose = (point(), angle());
    let goal = (angle(), prop_oneof![0.0_f32..10.0, 0.0_f32..2e4]);
    let readings = UniformArrayStrategy::<_, [SonarReading; N]>::new(reading().boxed());
    let hazards = UniformArrayStrategy::<_, [Hazard; N]>::new(hazard().boxed());
    let sonars = (readings, hazards);
    let obstacle = proptest::option::of(obstacle());
    let ages = prop_oneof![0..500_u64, 0..5_000_u64];
    let rates = prop_oneof![4 => -1.0_f32..1.0, 1 => between(-20.0, 20.0)];
    let motion = (between(-10.0, 10.0), rates, 0..100_000_u64, ages);
    let lengths = (length(), [length(), length()], [length(), length()]);
    (pose, motion, goal, sonars, obstacle, lengths, base()).prop_map(
        |(
            pose,
            (speed, turn_rate, now, odometry_age),
            goal,
            (sonar, hazard),
            obstacle,
            (ahead, room, beside),
            base,
        )| View {
            now: Instant(now),
            pose: Pose {
                position: pose.0,
                heading: pose.1,
            },
            speed,
            turn_rate,
            odometry_age,
            goal: GoalView {
                heading: goal.0,
                distance: goal.1,
            },
            sonar,
            hazard,
            obstacle,
            ahead,
            room,
            beside,
            base,
            guard: None,
        },
    )
}

/// A time near `now`: before it, the same, or after it, by milliseconds or by ages.
fn time(now: u64) -> impl Strategy<Value = Instant> {
    prop_oneof![
        6 => Just(now),
        3 => now.saturating_sub(1_500)..=now,
        1 => now..=now.saturating_add(500),
        1 => any::<u64>(),
    ]
    .prop_map(Instant)
}

/// Any observation at `now`: every number any bit pattern, every sample there or not, from any
/// time.
pub fn observation<const N: usize>(now: u64) -> impl Strategy<Value = Observation<N>> {
    let range = || prop_oneof![6 => 0.0_f32..6.0, 1 => any_f32()];
    let sample = (range(), time(now)).prop_map(|(range, taken_at)| SonarSample { range, taken_at });
    let sample = prop_oneof![12 => sample.prop_map(Some), 1 => Just(None)];
    let samples = UniformArrayStrategy::<_, [Option<SonarSample>; N]>::new(sample);
    let number = |usual: f32| prop_oneof![8 => -usual..usual, 1 => any_f32()];
    let pose = (number(3.0), number(3.0), number(PI));
    let odometry = (pose, number(0.5), number(1.0), time(now)).prop_map(
        |((x, y, heading), speed, turn_rate, taken_at)| OdometrySample {
            x,
            y,
            heading,
            speed,
            turn_rate,
            taken_at,
        },
    );
    let odometry = prop_oneof![12 => odometry.prop_map(Some), 1 => Just(None)];
    let sighting = prop_oneof![3 => Just(None), 1 => sighting().prop_map(Some)];
    (samples, odometry, sighting, base()).prop_map(move |(sonar, odometry, sighting, base)| {
        Observation {
            now: Instant(now),
            sonar,
            odometry,
            sighting,
            base,
        }
    })
}

/// Observations one after the other, from a clock that mostly goes on by a tick, but may stand,
/// leap, or go back.
pub fn observations<const N: usize>(ticks: usize) -> impl Strategy<Value = Vec<Observation<N>>> {
    let step = prop_oneof![
        12 => Just(100_i64),
        3 => 0_i64..1_000,
        1 => -2_000_i64..0,
        1 => any::<i64>(),
    ];
    proptest::collection::vec(step, 1..=ticks).prop_flat_map(|steps| {
        let mut now = 10_000_u64;
        let times = steps.into_iter().map(move |step| {
            now = now.saturating_add_signed(step);
            now
        });
        times.map(observation::<N>).collect::<Vec<_>>()
    })
}

/// An observation in which nothing is wrong, with these ranges, of a robot at rest at the origin.
pub fn in_order<const N: usize>(now: u64, ranges: [f32; N]) -> Observation<N> {
    let now = Instant(now);
    Observation {
        now,
        sonar: ranges.map(|range| {
            Some(SonarSample {
                range,
                taken_at: now,
            })
        }),
        odometry: Some(OdometrySample {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
            speed: 0.0,
            turn_rate: 0.0,
            taken_at: now,
        }),
        sighting: None,
        base: BaseStatus {
            motors_enabled: true,
            stalled: false,
            emergency_stop: false,
        },
    }
}
