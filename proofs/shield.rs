//! Chapter `shield`: the guard, the limits, and that stopping is always possible.

#[cfg(not(kani))]
use super::kani;
use sidestep::config::{Config, Parameters};
use sidestep::law::Advice;
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::shield::{Limits, Room, Shield, greatest};
use sidestep_spec::shield as promise;

/// The limits of a configuration that differs from the Pioneer preset in whatever `vary` sets.
fn limits_with(vary: impl Fn(&mut Parameters)) -> Limits {
    let mut parameters = preset::PIONEER_3DX;
    vary(&mut parameters);
    let config = Config::new(parameters);
    kani::assume(config.is_ok());
    match config {
        Ok(config) => Limits::new(&config),
        Err(_) => unreachable!(),
    }
}

fn pioneer() -> Limits {
    limits_with(|_| {})
}

/// Any integer in a range.
pub fn any_in(from: i32, to: i32) -> i32 {
    let value = kani::any();
    kani::assume((from..=to).contains(&value));
    value
}

/// SH.3 as integers asks for no less than the formula, for the Pioneer preset and every speed;
/// it overflows for none.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn guard_asks_enough() {
    let limits = pioneer();
    let speed = any_in(0, limits.speed_max());
    assert!(promise::asks_enough(
        limits.required_clearance(speed),
        speed,
        limits.acceleration(),
        limits.braking(),
        limits.reaction_time(),
        limits.obstacle_speed(),
    ));
    kani::cover!(speed == limits.speed_max(), "full speed");
    kani::cover!(speed == 0, "rest");
}

/// No configuration asks for more clearance than this, in mm.
const MOST: i32 = 3_000_000;

/// The guard's arithmetic does not overflow for any configuration and any speed it may have.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn guard_does_not_overflow() {
    let limits = limits_with(|p| {
        p.speed_max = kani::any();
        p.obstacle_speed_max = kani::any();
        p.acceleration = kani::any();
        p.braking = kani::any();
        p.reaction_time = kani::any();
        p.cruise_speed = 0.01;
    });
    // Measured speeds go up to 10 m/s, and a little for their age.
    let speed = any_in(0, 11_000);
    let required = limits.required_clearance(speed);
    assert!(limits.way_to_rest(speed) >= 0);
    assert!((0..=MOST).contains(&required));
    kani::cover!(required > 500_000, "half a kilometre");
    kani::cover!(required < 100, "a decimetre");
}

/// Passive safety is inductive (Pioneer preset): from any safe state, whatever the shield admits,
/// whatever robot and obstacle then do within the model for one reaction time, the state is safe
/// again. `clearance` is the true clearance; the shield may see less, never more.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn admitted_motion_stays_safe() {
    let limits = pioneer();
    let clearance = any_in(0, 6_000);
    // What admissible_speed shows of a command that moves the robot (`speed_is_admitted`): it was
    // judged at a speed no less than the command, one gain below what the robot may be at.
    let judged_at = any_in(0, limits.speed_max() + limits.speed_gain());
    kani::assume(limits.required_clearance(judged_at) <= clearance);
    // One reaction time: the robot is never more than one gain above that.
    let gain = limits.speed_gain();
    let after = any_in(0, judged_at + gain);
    let e = limits.reaction_time();
    let robot = any_in(0, 5_000);
    let obstacle = any_in(0, 5_000);
    kani::assume(1000 * robot <= (judged_at + gain) * e);
    kani::assume(1000 * obstacle <= limits.obstacle_speed() * e);
    let left = clearance - robot - obstacle;
    let safe = |speed, clearance| {
        promise::safe_state(speed, clearance, limits.braking(), limits.obstacle_speed())
    };
    assert!(promise::stays_safe(true, safe(after, left)));
    kani::cover!(after > judged_at, "the robot ends faster than judged");
    kani::cover!(left < 600, "near the end of the room");
}

/// Braking keeps a safe state safe (Pioneer preset): speed after t is v − b·t, the robot travels
/// (v² − v'²)/2b and the obstacle V·t meanwhile.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn braking_stays_safe() {
    let limits = pioneer();
    let (b, o) = (limits.braking(), limits.obstacle_speed());
    let clearance = any_in(0, 6_000);
    let speed = any_in(0, limits.speed_max() + limits.speed_gain());
    kani::assume(promise::safe_state(speed, clearance, b, o));
    let after = any_in(0, speed);
    let robot = any_in(0, 3_000);
    let obstacle = any_in(0, 3_000);
    kani::assume(2 * b * robot <= speed * speed - after * after);
    kani::assume(b * obstacle <= o * (speed - after));
    let left = clearance - robot - obstacle;
    assert!(promise::stays_safe(
        true,
        promise::safe_state(after, left, b, o)
    ));
    kani::cover!(after == 0 && speed > 300, "to rest");
    kani::cover!(left == 0, "just in time");
}

/// Any clearance may be asked for, up to what `guard_does_not_overflow` shows.
pub fn any_clearance(_limits: &Limits, _speed: i32) -> i32 {
    any_in(0, MOST)
}

/// Contact may be judged in any way.
pub fn any_contact(_limits: &Limits, _distance: i32, _closing: i32) -> bool {
    kani::any()
}

/// What the shield lets through, for any advice, any room and any formula of the guard: limits,
/// slew, and no motion without the clearance that was asked for.
//= shield.INV-1
//= shield.INV-6
//= shield.INV-9
//= shield.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::required_clearance, any_clearance)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, any_contact)
)]
pub fn speed_is_admitted() {
    let limits = pioneer();
    let last = any_in(0, limits.speed_max());
    let elapsed = any_in(0, limits.reaction_time());
    let room = Room {
        clearance: kani::any(),
        sonar: 0,
        ahead: if kani::any() {
            Some((any_in(0, 1_000_000), any_in(0, 3_000)))
        } else {
            None
        },
    };
    let speed_bound = any_in(0, 10_000);
    let admission = limits.admissible_speed(last, kani::any(), elapsed, speed_bound, room);
    let speed = admission.speed;
    assert!(promise::within_limits(speed, 0, limits.speed_max(), 0));
    assert!(promise::slew_kept(
        last,
        speed,
        limits.acceleration(),
        elapsed
    ));
    assert!(promise::admitted(speed, admission.required, room.clearance));
    assert!(promise::judged_at_what_it_may_be(
        speed,
        admission.judged_at,
        speed_bound,
        limits.speed_gain()
    ));
    kani::cover!(speed > 300, "fast");
    kani::cover!(speed > 0 && speed < 100 && elapsed > 200, "slowed");
    kani::cover!(speed == 0 && last > 200, "braked");
}

/// The search for the greatest admitted speed finds it, for every wish and every threshold.
//= shield.INV-10
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn search_finds_the_greatest() {
    let wish = any_in(0, 4095);
    let threshold = any_in(0, 4095);
    let found = greatest(wish, |speed| speed <= threshold);
    assert!(promise::greatest(found, wish, threshold));
    kani::cover!(found == threshold && found < wish, "limited");
    kani::cover!(found == wish && found > 2048, "as wished");
}

/// Any bit pattern as advice.
fn any_advice() -> Advice {
    Advice {
        speed: kani::any(),
        turn_rate: kani::any(),
    }
}

/// A shield that is ready to go, with any view and any advice: limits are kept, a stop has no
/// speed, and a view that cannot be trusted (a sonar stale, missing, not a number or
/// in contact, motors off, a stall, the emergency stop) yields no motion at all. That raw
/// observations become such views is `view::only_ranges_are_readings`.
//= shield.INV-1
//= shield.INV-4
//= shield.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(40))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::required_clearance, any_clearance)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, any_contact)
)]
pub fn any_law_is_shielded() {
    let parameters = Parameters {
        resume_samples: 1.0,
        ..preset::PIONEER_3DX
    };
    let Ok(config) = Config::new(parameters) else {
        unreachable!()
    };
    let ring = super::view::one_sonar(&config);
    let mut shield = Shield::new(&config);
    let clear = super::view::clear_view();
    // The stand-ins may ask for any clearance: go on where they let the robot go.
    kani::assume(shield.assess(&clear, &ring).is_none());
    shield.admit(Advice::REST, &clear);
    let view = super::view::any_view();
    let stop = shield.assess(&view, &ring);
    let verdict = shield.admit(any_advice(), &view);
    let command = verdict.command;
    assert!(promise::within_limits(
        command.speed(),
        command.turn_rate(),
        shield.limits().speed_max(),
        shield.limits().turn_rate_max()
    ));
    assert!(promise::stop_has_no_speed(
        verdict.stop.is_some(),
        command.speed()
    ));
    let trusted = matches!(
        view.sonar[0],
        SonarReading::Echo(_) | SonarReading::NoEcho(_)
    ) && view.base.motors_enabled
        && !view.base.stalled
        && !view.base.emergency_stop;
    if !trusted {
        assert!(verdict.stop.is_some());
        assert!(promise::untrusted_rests(
            command.speed(),
            command.turn_rate()
        ));
    }
    kani::cover!(command.speed() > 0, "it moves");
    kani::cover!(command.turn_rate() < 0, "it turns");
    kani::cover!(stop.is_none() && verdict.stop.is_some(), "bad advice");
    kani::cover!(!trusted, "a bad view");
}

/// Turn rates keep their limit, gain no more than the base can, and end before contact, for any
/// advice, any clearance and any turn before; Pioneer preset.
//= shield.INV-1
//= shield.INV-6
//= shield.INV-12
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn turn_rate_is_limited() {
    let limits = pioneer();
    let last = any_in(-limits.turn_rate_max(), limits.turn_rate_max());
    let elapsed = any_in(0, limits.reaction_time());
    let clearance = kani::any();
    let turn_rate = limits.admissible_turn_rate(last, kani::any(), elapsed, clearance);
    assert!(promise::within_limits(
        0,
        turn_rate,
        0,
        limits.turn_rate_max()
    ));
    assert!(promise::turn_slew_kept(
        last,
        turn_rate,
        limits.turn_acceleration(),
        elapsed
    ));
    assert!(promise::turn_ends_before_contact(
        turn_rate,
        limits.turn_acceleration(),
        limits.reaction_time(),
        limits.obstacle_speed(),
        clearance
    ));
    kani::cover!(turn_rate < last, "clockwise");
    kani::cover!(turn_rate == limits.turn_rate_max(), "as fast as it may");
}

/// SH.4: if contact is possible at any time within the stop time, the guard stops. In integers:
/// the f32 quotient t_lb is for reporting only, the decision needs no division, and a product of
/// two bounded integers is exact. Stop time of the presets, any distance, speed and time.
//= shield.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn contact_time_is_sound() {
    let limits = pioneer();
    let distance = any_in(0, 1_000_000);
    let closing = any_in(0, 13_000);
    let stops = limits.contact_within_stop_time(distance, closing);
    let time = any_in(0, limits.stop_time());
    assert!(promise::sound(distance, closing, time, stops));
    kani::cover!(stops && distance > 0, "stops at a distance");
    kani::cover!(!stops && closing > 0, "goes on");
}

/// SH.4: what stops also stops nearer and faster. Stop time of the presets.
//= shield.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn stop_set_is_monotone() {
    let limits = pioneer();
    let distance = any_in(0, 1_000_000);
    let closing = any_in(0, 13_000);
    let stops = limits.contact_within_stop_time(distance, closing);
    let nearer = any_in(0, distance);
    let faster = any_in(closing, 13_000);
    assert!(promise::monotone(
        stops,
        limits.contact_within_stop_time(nearer, faster)
    ));
    kani::cover!(stops && distance > 0, "stops at a distance");
    kani::cover!(!stops && closing > 0, "goes on");
}
