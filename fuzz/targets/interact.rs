//! Bytes as pictures, views and situations: the machine M2 and S3's law.

use super::bytes::Bytes;
use nalgebra::Vector2;
use sidestep::config::Config;
use sidestep::gesture::{Gesture, PEOPLE_MAX};
use sidestep::interact::{
    self, Choice, Commissioned, Drive, FIELDS, Frame, Interact, LateralAxis, Order, Orders,
    Parameters, Path, People, Settings, Situation, Someone, State, Trial, USUAL,
};
use sidestep::law::Law;
use sidestep::observation::{BaseStatus, SonarReading};
use sidestep::preset;
use sidestep::quantity::{Instant, Length};
use sidestep::valley::Side;
use sidestep::view::{Class, GoalView, Hazard, Pose, View};
use sidestep_spec::interact as law;

/// Ticks of the law at most.
const TICKS: usize = 64;

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let config = Config::new(preset::PIONEER_3DX).expect("the preset is good");
    let mut values = USUAL.values();
    let at = usize::from(bytes.u8());
    if at < FIELDS.len() {
        values[at] = bytes.number();
    }
    let settings = Settings::new(Parameters::from_values(values), &config)
        .or_else(|_| Settings::new(USUAL, &config))
        .expect("the usual values are good");
    let frame = any_frame(&mut bytes);
    if bytes.truth() {
        machine(&settings, &mut bytes);
    } else {
        ticks(&settings, &config, frame, &mut bytes);
    }
}

fn any_side(bytes: &mut Bytes) -> Side {
    if bytes.truth() {
        Side::Left
    } else {
        Side::Right
    }
}

fn any_gesture(bytes: &mut Bytes) -> Option<Gesture> {
    Gesture::ALL.get(usize::from(bytes.u8() % 9)).copied()
}

/// A frame that a trial bears out: the one that the bytes give, or the one that the trial asks for.
fn any_frame(bytes: &mut Bytes) -> Commissioned {
    let flags = bytes.u8();
    let frame = Frame {
        lateral_axis: if flags & 1 == 0 {
            LateralAxis::Left
        } else {
            LateralAxis::Right
        },
        orders: if flags & 2 == 0 {
            Orders::Robots
        } else {
            Orders::Persons
        },
    };
    let trial = Trial {
        stood: any_side(bytes),
        lateral: bytes.number(),
        gesture: any_gesture(bytes).unwrap_or(Gesture::Rest),
        meant: any_side(bytes),
    };
    match frame.commissioned(&trial) {
        Ok(commissioned) => {
            assert!(law::borne_out(
                frame.left(trial.lateral) > 0.0,
                trial.stood == Side::Left,
                frame.side(trial.gesture) == Some(Side::Left),
                trial.meant == Side::Left,
            ));
            commissioned
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            let lateral = frame.left(1.0);
            let good = Trial {
                stood: Side::Left,
                lateral,
                gesture: Gesture::Left,
                meant: frame.side(Gesture::Left).expect("an order"),
            };
            frame.commissioned(&good).expect("it is as it says")
        }
    }
}

fn any_path(bytes: &mut Bytes) -> Option<Path> {
    let from = Vector2::new(bytes.number(), bytes.number());
    Path::new(
        from,
        bytes.angle(),
        bytes.number(),
        bytes.number(),
        bytes.number(),
    )
    .ok()
}

fn any_state(bytes: &mut Bytes) -> State {
    let kind = bytes.u8() % 12;
    let path = any_path(bytes);
    match (kind, path) {
        (0, _) => State::Announce,
        (1, _) => State::Stop,
        (2, _) => State::AskInteract,
        (3, _) => State::Wait,
        (4, _) => State::Master,
        (5, _) => State::Plan(Choice::Waypoint),
        (6, _) => State::Plan(Choice::Side(any_side(bytes))),
        (7, Some(path)) => State::Rotate(path),
        (8, Some(path)) => State::Traverse(path),
        (9, _) => State::Resume,
        (10, _) => State::NoFreePath,
        (11, _) => State::Arrived,
        _ => State::Follow,
    }
}

/// M2 through any sequence of situations.
fn machine(settings: &Settings, bytes: &mut Bytes) {
    let mut state = any_state(bytes);
    for _ in 0..TICKS {
        if bytes.is_empty() {
            break;
        }
        let (flags, more) = (bytes.u8(), bytes.u8());
        let flag = |bit: u8| flags & bit != 0;
        let order = (more & 1 != 0).then(|| Order {
            gesture: any_gesture(bytes),
            side: (more & 2 != 0).then(|| any_side(bytes)),
            bearing: bytes.angle(),
            nearest_ahead: bytes.number(),
        });
        let now = Situation {
            at_goal: more & 0xF0 == 0xF0,
            camera: !flag(1) || more & 4 != 0,
            stop_shown: flag(1) && flag(2),
            in_path: flag(4),
            near: flag(8),
            path_free: flag(16),
            at_rest: flag(32),
            master: more & 8 != 0,
            order,
            overdue: flag(64),
            plan: any_path(bytes),
            aligned: flag(128),
            passed: more & 16 != 0,
            intruded: more & 32 != 0,
        };
        let rear_sensing = more & 64 != 0;
        let next = interact::next_state(&state, &now);
        let asked = interact::drive(&next, &now, settings.forward_distance, rear_sensing);
        let demanded = now.stop_shown || !now.camera;
        assert!(law::stop_is_obeyed(demanded, asked == Drive::Rest));
        let found = match state {
            State::Plan(_) => now.plan,
            _ => None,
        };
        assert!(law::only_planned(state.path(), found.as_ref(), next.path()));
        let shown = now.order.and_then(|order| order.gesture);
        assert!(law::leads_only_while_shown(
            [matches!(asked, Drive::Forward(_)), asked == Drive::Backward],
            [
                shown == Some(Gesture::Forward),
                shown == Some(Gesture::Backward)
            ],
            now.order.map_or(0.0, |order| order.nearest_ahead),
            settings.forward_distance,
            rear_sensing,
        ));
        let waits = matches!(
            state,
            State::Wait | State::NoFreePath | State::Master | State::Rotate(_) | State::Traverse(_)
        ) && !(state == State::Master && demanded);
        let left = std::mem::discriminant(&next) != std::mem::discriminant(&state);
        assert!(law::ends_in_time(waits, now.overdue, left));
        assert!(law::arrived_for_good(
            state == State::Arrived,
            next == State::Arrived
        ));
        assert!(!next.name().is_empty());
        state = next;
    }
}

fn any_someone(bytes: &mut Bytes) -> Someone {
    Someone {
        id: u64::from(bytes.u8() % 8),
        lateral: bytes.number(),
        depth: bytes.number(),
        radius: bytes.truth().then(|| bytes.number()),
        gesture: any_gesture(bytes),
    }
}

/// The law, shown any views and pictures one after the other.
fn ticks(settings: &Settings, config: &Config, frame: Commissioned, bytes: &mut Bytes) {
    let mut law_of_s3 = Interact::new(*settings, *config, frame, bytes.truth());
    let mut now: u64 = 10_000;
    let mut latest: Option<u64> = None;
    let mut before = law_of_s3.people().count();
    for _ in 0..TICKS {
        if bytes.is_empty() {
            break;
        }
        let flags = bytes.u8();
        now = if flags & 0xE0 == 0xE0 {
            bytes.u64()
        } else {
            now.saturating_add(100)
        };
        if flags & 1 == 0 {
            let taken_at = if flags & 6 == 6 {
                bytes.u64()
            } else {
                now.saturating_sub(50)
            };
            let mut people = [None; PEOPLE_MAX];
            for place in people.iter_mut().take(usize::from(flags >> 3) % 7) {
                *place = Some(any_someone(bytes));
            }
            law_of_s3.observe_people(&People {
                taken_at: Instant(taken_at),
                people,
            });
            if latest.is_none_or(|latest| taken_at > latest) {
                latest = Some(taken_at);
            }
        }
        let mut coordinate = || {
            let number = bytes.number();
            if number.is_nan() {
                0.0
            } else {
                number.clamp(-1e4, 1e4)
            }
        };
        let position = Vector2::new(coordinate(), coordinate());
        let view = View::<1> {
            now: Instant(now),
            pose: Pose {
                position,
                heading: bytes.angle(),
            },
            speed: bytes.speed().get(),
            turn_rate: 0.0,
            odometry_age: 0,
            goal: GoalView {
                heading: bytes.angle(),
                distance: bytes.length().get(),
            },
            // The law asks for no sonar and for no status of the base.
            sonar: [SonarReading::NoEcho(Length::MAX)],
            hazard: [Hazard {
                range: 5_000,
                clearance: 5_000,
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
        };
        let advice = law_of_s3.advise(&view);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            config.speed_max,
            config.reverse_speed_max,
            config.turn_rate_max
        ));
        let age_max = (settings.camera_age_max * 1000.0) as u64 + 1;
        let recent = latest
            .and_then(|latest| now.checked_sub(latest))
            .is_some_and(|age| age <= age_max);
        assert!(law::stop_is_obeyed(
            !recent,
            advice.speed == 0.0 && advice.turn_rate == 0.0
        ));
        // Whoever is gone was out of sight for a while.
        let count = law_of_s3.people().count();
        assert!(count <= 2 * PEOPLE_MAX);
        before = before.max(count);
        while law_of_s3.next_event().is_some() {}
    }
    assert!(before <= 2 * PEOPLE_MAX);
}
