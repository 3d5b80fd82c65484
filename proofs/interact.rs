//! Chapter `interact`: the machine M2 and what it asks for.

use super::avoid::any_angle;
#[cfg(not(kani))]
use super::kani;
use super::view::{PIONEER, any_view};
use nalgebra::Vector2;
use sidestep::gesture::Gesture;
use sidestep::interact::{
    self, Choice, Commissioned, Drive, Frame, Interact, LateralAxis, Order, Orders, Path, Settings,
    Situation, State, Trial,
};
use sidestep::valley::Side;
use sidestep_spec::interact as law;

fn any_path() -> Path {
    let from = Vector2::new(kani::any(), kani::any());
    let path = Path::new(from, any_angle(), kani::any(), kani::any(), kani::any());
    kani::assume(path.is_ok());
    match path {
        Ok(path) => path,
        Err(_) => unreachable!(),
    }
}

fn any_side() -> Side {
    if kani::any() { Side::Left } else { Side::Right }
}

fn any_gesture() -> Gesture {
    Gesture::ALL[(kani::any::<u8>() % 7) as usize]
}

fn any_state() -> State {
    match kani::any::<u8>() % 12 {
        0 => State::Follow,
        1 => State::Announce,
        2 => State::Stop,
        3 => State::AskInteract,
        4 => State::Wait,
        5 => State::Master,
        6 => State::Plan(if kani::any() {
            Choice::Waypoint
        } else {
            Choice::Side(any_side())
        }),
        7 => State::Rotate(any_path()),
        8 => State::Traverse(any_path()),
        9 => State::Resume,
        10 => State::NoFreePath,
        _ => State::Arrived,
    }
}

fn any_situation() -> Situation {
    Situation {
        at_goal: kani::any(),
        camera: kani::any(),
        stop_shown: kani::any(),
        in_path: kani::any(),
        near: kani::any(),
        path_free: kani::any(),
        at_rest: kani::any(),
        master: kani::any(),
        order: if kani::any() {
            Some(Order {
                gesture: if kani::any() {
                    Some(any_gesture())
                } else {
                    None
                },
                side: if kani::any() { Some(any_side()) } else { None },
                bearing: any_angle(),
                nearest_ahead: kani::any(),
            })
        } else {
            None
        },
        overdue: kani::any(),
        plan: if kani::any() { Some(any_path()) } else { None },
        aligned: kani::any(),
        passed: kani::any(),
        intruded: kani::any(),
    }
}

/// The usual settings for a P3-DX, checked; sine and cosine by their contracts.
fn settings() -> Settings {
    let settings = Settings::new(interact::USUAL, &PIONEER);
    kani::assume(settings.is_ok());
    match settings {
        Ok(settings) => settings,
        Err(_) => unreachable!(),
    }
}

/// M2 for any state in any situation: a demanded stop is obeyed in the same cycle, only planned paths
/// are driven, the master's switch is a dead man's, what is overdue ends, and who has arrived stays.
//= interact.INV-1
//= interact.INV-2
//= interact.INV-3
//= interact.INV-4
//= interact.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn machine_keeps_its_promises() {
    let (state, now) = (any_state(), any_situation());
    let (limit, rear_sensing) = (kani::any(), kani::any());
    let next = interact::next_state(&state, &now);
    let asked = interact::drive(&next, &now, limit, rear_sensing);
    let demanded = now.stop_shown || !now.camera;
    assert!(law::stop_is_obeyed(demanded, asked == Drive::Rest));
    assert!(law::stop_is_obeyed(
        demanded,
        !next.moves() || (next == State::Master && now.camera)
    ));
    let found = match state {
        State::Plan(_) => now.plan,
        _ => None,
    };
    assert!(law::only_planned(state.path(), found.as_ref(), next.path()));
    let (turns, drives) = (
        matches!(asked, Drive::Turn(_)),
        matches!(asked, Drive::Along(_)),
    );
    assert!(!(turns || drives) || next.path().is_some());
    let shown = now.order.and_then(|order| order.gesture);
    let nearest = match now.order {
        Some(order) => order.nearest_ahead,
        None => 0.0,
    };
    assert!(law::leads_only_while_shown(
        [matches!(asked, Drive::Forward(_)), asked == Drive::Backward],
        [
            shown == Some(Gesture::Forward),
            shown == Some(Gesture::Backward)
        ],
        nearest,
        limit,
        rear_sensing,
    ));
    let waits = matches!(
        state,
        State::Wait | State::NoFreePath | State::Master | State::Rotate(_) | State::Traverse(_)
    ) && !(demanded && state == State::Master);
    let left = core::mem::discriminant(&next) != core::mem::discriminant(&state);
    assert!(law::ends_in_time(waits, now.overdue, left));
    assert!(law::arrived_for_good(
        state == State::Arrived,
        next == State::Arrived
    ));
    kani::cover!(matches!(asked, Drive::Along(_)), "through a valley");
    kani::cover!(asked == Drive::Backward, "led backward");
    kani::cover!(demanded && state.moves(), "stopped under way");
    kani::cover!(next.path().is_some() && state.path().is_none(), "planned");
}

/// A frame is taken into use only if a trial bears it out: any frame, any trial.
//= interact.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn frames_are_borne_out() {
    let frame = Frame {
        lateral_axis: if kani::any() {
            LateralAxis::Left
        } else {
            LateralAxis::Right
        },
        orders: if kani::any() {
            Orders::Robots
        } else {
            Orders::Persons
        },
    };
    let trial = Trial {
        stood: any_side(),
        lateral: kani::any(),
        gesture: any_gesture(),
        meant: any_side(),
    };
    if frame.commissioned(&trial).is_ok() {
        assert!(law::borne_out(
            frame.left(trial.lateral) > 0.0,
            trial.stood == Side::Left,
            frame.side(trial.gesture) == Some(Side::Left),
            trial.meant == Side::Left,
        ));
        kani::cover!(true, "borne out");
    } else {
        kani::cover!(trial.lateral > 1.0, "not borne out");
    }
}

/// Left is the camera's, and orders mean the robot's sides.
fn commissioned() -> Commissioned {
    let frame = Frame {
        lateral_axis: LateralAxis::Left,
        orders: Orders::Robots,
    };
    let trial = Trial {
        stood: Side::Left,
        lateral: 1.0,
        gesture: Gesture::Right,
        meant: Side::Right,
    };
    match frame.commissioned(&trial) {
        Ok(taken) => taken,
        Err(_) => unreachable!(),
    }
}

/// Whether somebody near is only remembered: either.
#[cfg(kani)]
fn any_memory<const N: usize>(_law_of_s3: &Interact, _view: &sidestep::view::View<N>) -> bool {
    kani::any()
}

/// Whatever a state asks for, the advice is within the limits, for any view and any path, whether somebody
/// near is only remembered or not. What left and right mean has no part in it.
//= interact.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(
    kani,
    kani::stub(crate::interact::Interact::somebody_unseen, any_memory)
)]
pub fn advice_is_within_limits() {
    let law_of_s3 = Interact::new(settings(), PIONEER, commissioned(), true);
    let asked = match kani::any::<u8>() % 6 {
        0 => Drive::Rest,
        1 => Drive::ToGoal,
        2 => Drive::Turn(any_path()),
        3 => Drive::Along(any_path()),
        4 => Drive::Forward(any_angle()),
        _ => Drive::Backward,
    };
    let advice = law_of_s3.advice(asked, &any_view());
    assert!(law::advice_in_range(
        advice.speed,
        advice.turn_rate,
        PIONEER.speed_max,
        PIONEER.reverse_speed_max,
        PIONEER.turn_rate_max,
    ));
    assert!(law::stop_is_obeyed(
        asked == Drive::Rest,
        advice.speed == 0.0 && advice.turn_rate == 0.0
    ));
    kani::cover!(advice.speed > 0.1, "forward");
    kani::cover!(advice.speed < 0.0, "backward");
    kani::cover!(
        asked == Drive::Backward && advice.speed > -PIONEER.reverse_speed_max,
        "backward, slower for who is remembered"
    );
    kani::cover!(advice.turn_rate < -0.1, "to the right");
}
