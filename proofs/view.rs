//! Chapter `view`: judging readings and remembering them.

use super::avoid::{any_angle, any_length, any_speed, any_trend};
#[cfg(not(kani))]
use super::kani;
use nalgebra::Vector2;
use sidestep::avoid::ObstacleSpeed;
use sidestep::config::{Config, Parameters};
use sidestep::failsafe::StopReason;
use sidestep::observation::{
    BaseStatus, Observation, OdometrySample, SonarReading, SonarSample, classify,
};
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length};
use sidestep::ring::{Placement, Ring, Sonar};
use sidestep::track::Obstacle;
use sidestep::view::{
    Class, EchoMemory, GoalView, Hazard, Look, Memory, Odometer, Pose, View, Witness,
};
use sidestep_spec::view as promise;

/// The configuration of parameters that are known to be good: checked as this is compiled.
pub const fn checked(parameters: Parameters) -> Config {
    match Config::new(parameters) {
        Ok(config) => config,
        Err(_) => panic!("parameters out of range"),
    }
}

/// The Pioneer preset.
pub const PIONEER: Config = checked(preset::PIONEER_3DX);

/// The Pioneer preset for a robot that need not see all round: with one sonar it could not move.
pub const BLIND_PIONEER: Config = checked(Parameters {
    blind_angle_max: 3.15,
    resume_samples: 1.0,
    ..preset::PIONEER_3DX
});

/// One sonar that looks straight ahead from the robot's edge.
pub fn one_sonar(config: &Config) -> Ring<1> {
    let ahead = Placement {
        x: 0.2,
        y: 0.0,
        heading: 0.0,
    };
    match Ring::new(&[ahead], config) {
        Ok(ring) => ring,
        Err(_) => unreachable!(),
    }
}

/// Any bit pattern as a sonar sample.
pub fn any_sample() -> SonarSample {
    SonarSample {
        range: kani::any(),
        taken_at: Instant(kani::any()),
    }
}

/// Any bit pattern as an observation of one sonar.
pub fn any_observation() -> Observation<1> {
    Observation {
        now: Instant(kani::any()),
        sonar: [if kani::any() {
            Some(any_sample())
        } else {
            None
        }],
        odometry: if kani::any() {
            Some(OdometrySample {
                x: kani::any(),
                y: kani::any(),
                heading: kani::any(),
                speed: kani::any(),
                turn_rate: kani::any(),
                taken_at: Instant(kani::any()),
            })
        } else {
            None
        },
        // Sightings go through S1 E3, which has its own proof for any bit pattern.
        sighting: None,
        base: BaseStatus {
            motors_enabled: kani::any(),
            stalled: kani::any(),
            emergency_stop: kani::any(),
        },
    }
}

/// A reading is an echo or "no echo" only where the raw range is a number above zero, measured in
/// time. Any bit pattern, any limits of range and age.
//= view.INV-1
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn only_ranges_are_readings() {
    let sample = any_sample();
    let now = Instant(kani::any());
    let (range_min, range_max) = (any_length(), any_length());
    let age_max = kani::any();
    let reading = classify(Some(sample), now, range_min, range_max, age_max);
    let usable = matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_));
    let in_time = now.since(sample.taken_at).is_some_and(|age| age <= age_max);
    assert!(promise::unusable_is_refused(sample.range, in_time, usable));
    assert!(!matches!(
        classify(None, now, range_min, range_max, age_max),
        SonarReading::Echo(_) | SonarReading::NoEcho(_)
    ));
    kani::cover!(matches!(reading, SonarReading::Echo(_)), "an echo");
    kani::cover!(matches!(reading, SonarReading::TooNear), "a contact");
    kani::cover!(matches!(reading, SonarReading::Invalid), "nonsense");
}

/// Any number of a range.
pub fn any_between(from: f32, to: f32) -> f32 {
    let value = kani::any();
    kani::assume((from..=to).contains(&value));
    value
}

/// Any point of the odometry frame.
fn any_point() -> Vector2<f32> {
    Vector2::new(any_between(-1e4, 1e4), any_between(-1e4, 1e4))
}

/// Any judged reading.
pub fn any_reading() -> SonarReading {
    match kani::any::<u8>() % 5 {
        0 => SonarReading::Echo(any_length()),
        1 => SonarReading::NoEcho(any_length()),
        2 => SonarReading::TooNear,
        3 => SonarReading::Stale,
        _ => SonarReading::Invalid,
    }
}

/// Nothing within four metres, the base in order, at 1 s.
pub fn clear_view() -> View<1> {
    View {
        now: Instant(1000),
        pose: Pose {
            position: Vector2::new(0.0, 0.0),
            heading: Angle::ZERO,
        },
        speed: 0.0,
        turn_rate: 0.0,
        odometry_age: 0,
        goal: GoalView {
            heading: Angle::ZERO,
            distance: 5.0,
        },
        sonar: [SonarReading::NoEcho(Length::MAX)],
        hazard: [Hazard {
            range: 4_000,
            clearance: 4_000,
            age: 0,
            way: [0; 2],
            turned: 0,
            class: Class::Unknown,
            too_fast: false,
            stuck: false,
        }],
        obstacle: None,
        ahead: Length::MAX,
        room: [Length::MAX; 2],
        beside: [Length::MAX; 2],
        base: BaseStatus {
            motors_enabled: true,
            stalled: false,
            emergency_stop: false,
        },
        guard: None,
    }
}

/// Any view that a robot with one sonar can have.
pub fn any_view() -> View<1> {
    let contact_range: i32 = super::shield::any_in(-4_000, 4_000);
    View {
        now: Instant(kani::any()),
        pose: Pose {
            position: any_point(),
            heading: any_angle(),
        },
        speed: any_between(-10.0, 10.0),
        turn_rate: any_between(-20.0, 20.0),
        odometry_age: kani::any(),
        goal: GoalView {
            heading: any_angle(),
            distance: any_between(0.0, 2e4),
        },
        sonar: [any_reading()],
        hazard: [super::shield::any_hazard()],
        obstacle: if kani::any() {
            Some(Obstacle {
                distance: any_length(),
                contact_range,
                direction: any_angle(),
                position: any_point(),
                trend: any_trend(),
                speed: ObstacleSpeed {
                    value: any_speed(),
                    saturated: kani::any(),
                },
                seen_now: kani::any(),
                visible: kani::any(),
            })
        } else {
            None
        },
        ahead: any_length(),
        room: [any_length(), any_length()],
        beside: [any_length(), any_length()],
        base: BaseStatus {
            motors_enabled: kani::any(),
            stalled: kani::any(),
            emergency_stop: kani::any(),
        },
        guard: None,
    }
}

/// A look of a robot that stands or has moved, a time after the start.
fn look(measured: Option<i32>, at: u64, odometer: Odometer, witness: Witness) -> Look {
    Look {
        measured,
        taken_at: Instant(at),
        now: Instant(at),
        odometer,
        pose: None,
        witness,
    }
}

/// Whatever other sonars say, but for having heard the thing: then it is theirs.
fn any_witness() -> Witness {
    Witness {
        covered: kani::any(),
        heard_there: false,
        known_still: kani::any(),
        on_wall: kani::any(),
        beside_still: kani::any(),
    }
}

fn any_range() -> Option<i32> {
    kani::any::<bool>().then(|| super::shield::any_in(0, 4_000))
}

/// An echo that is nearer counts at once; one reading that is farther, or is no echo, frees no
/// more than motion and scatter explain. Any two ranges up to 4 m or none; at once, a tenth and half a
/// second apart, whatever other sonars say short of hearing it; a robot at rest, Pioneer preset.
//= view.INV-2
//= view.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
pub fn echoes_are_held() {
    let config = BLIND_PIONEER;
    let ring = one_sonar(&config);
    let sonar = &ring.sonars()[0];
    let mut memory = EchoMemory::default();
    let (first, second) = (any_range(), any_range());
    let gap = [0, 100, 500][kani::any::<u8>() as usize % 3];
    let start = Odometer::default();
    let before = memory.update(&look(first, 1000, start, any_witness()), sonar, &config);
    let later = 1000 + gap as u64;
    let after = memory.update(&look(second, later, start, any_witness()), sonar, &config);
    if let Some(range) = second {
        assert!(promise::nearer_counts(after.range, range));
    }
    if first.is_some() {
        // 0.8 m/s for half a second, and scatter.
        assert!(promise::not_freed_at_once(
            before.range,
            after.range,
            400 + 100
        ));
    }
    kani::cover!(after.range < before.range, "nearer");
    kani::cover!(after.range > before.range, "a little farther");
}

/// Nothing that happens after a thing was seen is forgotten, and not to hear it makes it no less of
/// a hazard: any range, then nothing, up to half a second later, after any way and turn.
//= view.INV-5
//= view.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
pub fn nothing_is_forgotten() {
    let config = BLIND_PIONEER;
    let ring = one_sonar(&config);
    let sonar = &ring.sonars()[0];
    let mut memory = EchoMemory::default();
    let gap = super::shield::any_in(0, 500);
    let (ahead, back) = (super::shield::any_in(0, 300), super::shield::any_in(0, 300));
    let turned = super::shield::any_in(0, 1_000);
    let range = super::shield::any_in(0, 10_000);
    let start = Odometer::default();
    let before = memory.update(
        &look(Some(range), 1000, start, any_witness()),
        sonar,
        &config,
    );
    let odometer = Odometer {
        way: [ahead, back].map(i64::from),
        turned: i64::from(turned),
    };
    let later = 1000 + gap as u64;
    let after = memory.update(&look(None, later, odometer, any_witness()), sonar, &config);
    assert!(promise::nothing_forgotten(
        [after.age, after.way[0], after.way[1], after.turned].map(i64::from),
        [gap, ahead, back, turned].map(i64::from)
    ));
    assert!(promise::losing_sight_frees_nothing(
        [before.clearance, after.clearance],
        [before.age, after.age],
        [
            before.class == Class::Unknown,
            after.class == Class::Unknown
        ]
    ));
    kani::cover!(after.range < 1000 && gap == 500, "held without an echo");
}

/// Any hazard may come of a look: `any_look_is_taken_in`.
pub fn any_taken_in(
    _memory: &mut EchoMemory,
    _look: &Look,
    _sonar: &Sonar,
    _config: &Config,
) -> Hazard {
    super::shield::any_hazard()
}

/// A sonar's memory takes in any two looks, at any times, after any ways and turns, from anywhere,
/// without a panic or an overflow, and what comes of them is within what the shield reckons with.
//= view.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
pub fn any_look_is_taken_in() {
    let config = BLIND_PIONEER;
    let ring = one_sonar(&config);
    let sonar = &ring.sonars()[0];
    let mut memory = EchoMemory::default();
    for _ in 0..2 {
        let measured = kani::any::<bool>().then(|| super::shield::any_in(0, 20_000));
        let odometer = Odometer {
            way: [kani::any(), kani::any()],
            turned: kani::any(),
        };
        kani::assume(odometer.way.iter().all(|way| *way >= 0) && odometer.turned >= 0);
        let look = Look {
            measured,
            taken_at: Instant(kani::any()),
            now: Instant(kani::any()),
            odometer,
            pose: None,
            witness: Witness {
                heard_there: kani::any(),
                ..any_witness()
            },
        };
        let hazard = memory.update(&look, sonar, &config);
        assert!(promise::within_reckoning(
            [hazard.range, hazard.clearance],
            [hazard.age, hazard.way[0], hazard.way[1]],
            hazard.turned
        ));
        kani::cover!(hazard.range == 0, "a contact");
        kani::cover!(measured.is_none() && hazard.range < 1000, "held");
    }
}

/// Nobody is followed.
#[cfg(kani)]
pub(crate) fn nobody_followed<const N: usize>(
    _track: &mut Option<crate::track::Track>,
    _sonar: &[SonarReading; N],
    _fresh: &[bool; N],
    _pose: &Pose,
    _now: Instant,
    _ring: &Ring<N>,
    _config: &Config,
) {
}

/// No sonar says anything of another.
#[cfg(kani)]
pub(crate) fn no_witness<const N: usize>(
    _memory: &Memory<N>,
    _sonar: &[SonarReading; N],
    _observation: &Observation<N>,
    _pose: Option<Pose>,
    _ring: &Ring<N>,
    _config: &Config,
) -> [Witness; N] {
    [Witness::default(); N]
}

/// No wall beside the robot is looked for.
#[cfg(kani)]
pub(crate) fn no_walls<const N: usize>(
    _readings: &[SonarReading; N],
    _agrees: &[bool; N],
    _ring: &Ring<N>,
    _config: &Config,
) -> [Option<crate::wall::Wall>; 2] {
    [None; 2]
}

/// The room to either side is not measured.
#[cfg(kani)]
pub(crate) fn no_room<const N: usize>(
    _sonar: &[SonarReading; N],
    _ring: &Ring<N>,
    _config: &Config,
) -> [Length; 2] {
    [Length::ZERO; 2]
}

/// What comes of an observation of a robot with one sonar that has seen nothing yet.
fn is_judged(observation: &Observation<1>) -> Result<View<1>, StopReason> {
    let config = BLIND_PIONEER;
    let ring = one_sonar(&config);
    let goal = Vector2::new(5.0, 0.0);
    let view = Memory::default().update(observation, goal, &ring, &config);
    if let Ok(view) = view {
        assert!(promise::judged(
            view.speed,
            view.goal.distance,
            view.obstacle.map(|obstacle| obstacle.distance.get())
        ));
    }
    view
}

/// Judging any observation neither panics nor overflows nor makes NaN, whatever the bits. Who is
/// followed is `any_reading_is_followed`.
//= view.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::stub(crate::math::atan2, crate::proofs::math::any_atan2))]
#[cfg_attr(kani, kani::stub(crate::view::EchoMemory::update, any_taken_in))]
#[cfg_attr(kani, kani::stub(crate::track::follow, nobody_followed))]
pub fn any_observation_is_judged() {
    let view = is_judged(&any_observation());
    kani::cover!(
        view.is_ok_and(|view| view.hazard[0].range < 1000),
        "something near"
    );
    kani::cover!(view.is_err(), "no odometry");
}

/// The same for a robot at rest at the origin, whatever its sonar hears and whenever: what is heard ahead
/// is followed. Walls, room and witnesses are in `any_observation_is_judged`.
//= view.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(kani, kani::stub(crate::math::atan2, crate::proofs::math::any_atan2))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::stub(crate::view::EchoMemory::update, any_taken_in))]
#[cfg_attr(kani, kani::stub(crate::view::Memory::witnesses, no_witness))]
#[cfg_attr(kani, kani::stub(crate::wall::Wall::beside, no_walls))]
#[cfg_attr(kani, kani::stub(crate::view::beside, no_room))]
#[cfg_attr(kani, kani::stub(crate::view::room, no_room))]
pub fn any_reading_is_followed() {
    let now = Instant(1000);
    let view = is_judged(&Observation {
        now,
        sonar: [Some(any_sample())],
        odometry: Some(OdometrySample {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
            speed: 0.0,
            turn_rate: 0.0,
            taken_at: now,
        }),
        sighting: None,
        base: clear_view().base,
    });
    let followed = view.is_ok_and(|view| view.obstacle.is_some());
    kani::cover!(followed, "an obstacle");
    kani::cover!(!followed, "none");
}
