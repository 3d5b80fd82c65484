//! Chapter `shield`: the guard, the limits, and that stopping is always possible.

#[cfg(not(kani))]
use super::kani;
use super::view::checked;
use sidestep::config::{Config, Parameters};
use sidestep::failsafe::{Action, StopReason};
use sidestep::law::Advice;
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::{Closing, Ring};
use sidestep::shield::{
    Admission, Guard, Limit, Limits, Motion, Plan, Shield, Surroundings, Twist, greatest,
};
use sidestep::view::{Class, Hazard, View};
use sidestep_spec::shield as promise;

/// The presets, checked.
const SRIKANDI_2012: Config = checked(preset::SRIKANDI_II_2012);
const SRIKANDI_2011: Config = checked(preset::SRIKANDI_II_2011);

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
    const LIMITS: Limits = Limits::new(&super::view::PIONEER);
    LIMITS
}

/// Any integer in a range.
pub fn any_in(from: i32, to: i32) -> i32 {
    let value = kani::any();
    kani::assume((from..=to).contains(&value));
    value
}

fn twist(speed: i32, turn_rate: i32) -> Twist {
    Twist { speed, turn_rate }
}

/// Any motion that can be measured or told.
fn any_motion() -> Motion {
    Motion {
        speed: any_in(0, 12_000),
        backward: kani::any(),
        turn_rate: any_in(0, 20_000),
    }
}

/// Any hazard that a view can hold.
pub fn any_hazard() -> Hazard {
    Hazard {
        range: any_in(0, 20_000),
        clearance: any_in(-10_000, 20_000),
        age: any_in(0, 10_000),
        way: [any_in(0, 10_000), any_in(0, 10_000)],
        turned: any_in(0, 40_000),
        class: any_class(),
        too_fast: kani::any(),
        stuck: kani::any(),
    }
}

fn any_class() -> Class {
    if kani::any() {
        Class::Still
    } else {
        Class::Unknown
    }
}

/// What limits the robot is rounded down: any greatest speed of backing off.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn limits_are_rounded_down() {
    let reverse: f32 = kani::any();
    let limits = limits_with(|p| p.reverse_speed_max = reverse);
    assert!(promise::rounded_down(
        limits.reverse_speed_max(),
        reverse.into()
    ));
    kani::cover!(
        limits.reverse_speed_max() == 0 && reverse > 0.0,
        "hardly any"
    );
    kani::cover!(limits.reverse_speed_max() == 500, "the fastest");
}

/// What is against it is rounded up: any error of the measured speed.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn limits_are_rounded_up() {
    let error: f32 = kani::any();
    let limits = limits_with(|p| p.speed_error = error);
    assert!(promise::rounded_up(limits.speed_error(), error.into()));
    kani::cover!(limits.speed_error() == 1, "hardly any");
    kani::cover!(limits.speed_error() == 500, "the most there may be");
}

/// Each limit of each preset is its own parameter, rounded to the safe side.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn limits_of_presets() {
    const WEAK: Config = checked(Parameters {
        braking_share: 0.7,
        still_speed_max: 0.25,
        ..preset::PIONEER_3DX
    });
    for config in [super::view::PIONEER, WEAK, SRIKANDI_2012, SRIKANDI_2011] {
        let limits = Limits::new(&config);
        for (limit, configured) in [
            (limits.speed_max(), config.speed_max.into()),
            (limits.reverse_speed_max(), config.reverse_speed_max.into()),
            (limits.turn_rate_max(), config.turn_rate_max.into()),
            (
                limits.braking(),
                f64::from(config.braking) * f64::from(config.braking_share),
            ),
            (limits.turn_acceleration(), config.turn_acceleration.into()),
        ] {
            assert!(promise::rounded_down(limit, configured));
        }
        let turning = |class, outlasts| limits.class_speed_turning(class, outlasts);
        for (limit, configured) in [
            (
                limits.class_speed(Class::Unknown),
                config.obstacle_speed_max,
            ),
            (turning(Class::Unknown, false), config.obstacle_speed_max),
            (turning(Class::Unknown, true), config.obstacle_speed_max),
            (limits.class_speed(Class::Still), config.still_speed_max),
            (turning(Class::Still, false), config.still_speed_max),
            (turning(Class::Still, true), config.still_speed_max_turning),
            (limits.acceleration(), config.acceleration),
            (limits.reaction_time(), config.reaction_time),
            (limits.speed_error(), config.speed_error),
            (limits.stop_time(), config.stop_time),
        ] {
            assert!(promise::rounded_up(limit, configured.into()));
        }
        kani::cover!(limits.braking() < 1000, "weak brakes");
    }
}

/// Way and time to rest are no less than the formula, for a preset and every speed it may have.
fn rest_is_covered(limits: Limits) {
    let fastest = any_in(0, limits.speed_max() + limits.speed_gain());
    assert!(promise::covers_rest(
        limits.way_to_rest(fastest),
        limits.time_to_rest(fastest),
        fastest,
        limits.braking(),
        limits.reaction_time(),
    ));
    kani::cover!(
        fastest == limits.speed_max() + limits.speed_gain(),
        "full speed and a gain"
    );
    kani::cover!(fastest == 0, "rest");
}

/// SH.2 for the Pioneer preset.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn rest_is_covered_pioneer() {
    rest_is_covered(pioneer());
}

/// SH.2 for the preset of S1.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn rest_is_covered_2012() {
    rest_is_covered(const { Limits::new(&SRIKANDI_2012) });
}

/// SH.2 for the preset of S2.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn rest_is_covered_2011() {
    rest_is_covered(const { Limits::new(&SRIKANDI_2011) });
}

/// No configuration needs a longer way than this, mm, or a longer time, ms.
const MOST: i32 = 3_000_000;

/// Ways and times to rest do not overflow for any configuration and any speed it may have.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn rest_does_not_overflow() {
    let limits = limits_with(|p| {
        p.speed_max = kani::any();
        p.acceleration = kani::any();
        p.braking = kani::any();
        p.braking_share = kani::any();
        p.reaction_time = kani::any();
        p.cruise_speed = 0.01;
    });
    let fastest = any_in(0, 23_000);
    assert!(limits.speed_max() + 2 * limits.speed_gain() + limits.speed_error() <= 23_000);
    let (way, time) = (limits.way_to_rest(fastest), limits.time_to_rest(fastest));
    assert!((0..=MOST).contains(&way));
    assert!((0..=MOST).contains(&time));
    kani::cover!(way > 500_000, "half a kilometre");
    kani::cover!(way > 0 && way < 100, "a decimetre");
}

/// A plan allows for the greatest speed that the robot may have: its way and time are those of one
/// of at least that speed. Pioneer preset, told any speed from rest.
//= shield.INV-11
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(70))]
pub fn plan_covers_command() {
    let guard = const { Guard::new(&super::view::PIONEER) };
    let limits = *guard.limits();
    let speed = any_in(1, limits.speed_max());
    match guard.plan(speed, 0, &Motion::REST) {
        Some(plan) => plan_covers(&limits, &plan, speed, 0),
        None => unreachable!("there is a plan for every speed that may be told"),
    }
    kani::cover!(speed == 400, "full speed");
}

/// The same for a robot that may be faster, whatever it is told; one that is faster than it may
/// ever be told has no plan, and so is not moved.
//= shield.INV-11
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(70))]
pub fn plan_covers_motion() {
    let guard = const { Guard::new(&super::view::PIONEER) };
    let limits = *guard.limits();
    let motion = Motion {
        speed: any_in(1, 12_000),
        ..Motion::REST
    };
    match guard.plan(0, 0, &motion) {
        Some(plan) => plan_covers(&limits, &plan, 0, motion.speed),
        None => assert!(motion.speed > limits.speed_max() + limits.speed_gain()),
    }
    kani::cover!(motion.speed == 466, "as fast as it may be");
    kani::cover!(motion.speed == 467, "faster");
}

fn plan_covers(limits: &Limits, plan: &Plan, speed: i32, motion: i32) {
    assert!(promise::plan_suffices(
        [plan.way[0], plan.time],
        [speed, limits.speed_gain(), motion],
        [limits.braking(), limits.reaction_time()],
    ));
}

/// A plan for a robot that may be moving either way and is told to move either way: the ways in both
/// directions. Pioneer preset.
//= shield.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(70))]
pub fn plan_covers_both_ways() {
    let guard = const { Guard::new(&super::view::PIONEER) };
    let limits = *guard.limits();
    let speed = any_in(-100, 400);
    let motion = Motion {
        speed: any_in(0, 466),
        backward: kani::any(),
        turn_rate: 0,
    };
    match guard.plan(speed, 0, &motion) {
        Some(plan) => assert!(promise::plan_suffices_both_ways(
            plan.way,
            plan.time,
            [speed, limits.speed_gain()],
            (motion.speed, motion.backward),
            [limits.braking(), limits.reaction_time()],
        )),
        None => unreachable!("it is no faster than it may be"),
    }
    kani::cover!(
        speed < 0 && motion.speed > 0 && !motion.backward,
        "reversed"
    );
}

/// How fast and how far a plan turns, for a robot that is told to drive at full speed or to stand, at any
/// turn rate, its own and what it is told. Pioneer preset.
//= shield.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
pub fn plan_covers_turn() {
    let guard = const { Guard::new(&super::view::PIONEER) };
    let speed = if kani::any() { 400 } else { 0 };
    let turn_rate = any_in(-20_000, 20_000);
    let motion = Motion {
        turn_rate: any_in(0, 20_000),
        ..Motion::REST
    };
    match guard.plan(speed, turn_rate, &motion) {
        Some(plan) => assert!(promise::turn_suffices(
            plan.turn,
            plan.turn_rate,
            plan.time,
            [turn_rate, motion.turn_rate]
        )),
        None => unreachable!("it is no faster than it may be"),
    }
    kani::cover!(speed == 0 && turn_rate < 0, "on the spot");
}

/// The clearance that is said to be needed, for the Pioneer preset and every speed that it may be told.
//= shield.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn clearance_is_covered() {
    let limits = pioneer();
    let speed = any_in(0, limits.speed_max());
    assert!(promise::covers_clearance(
        limits.required_clearance(speed),
        speed + limits.speed_gain(),
        limits.class_speed(Class::Unknown),
        [limits.braking(), limits.reaction_time()],
    ));
    kani::cover!(speed == 400, "full speed");
}

/// Passive safety is inductive: after any admitted plan, whatever robot and thing then do within
/// the model until the next command takes effect, braking ends before contact. The shield may see
/// less than the true clearance, never more. Straight at the thing, which is the worst; for other
/// cosines see `spec/smt`.
fn admitted_motion_stays_safe(limits: Limits, class: Class) {
    let fastest = any_in(0, limits.speed_max() + limits.speed_gain());
    let speed_of_thing = limits.class_speed(class);
    let clearance = any_in(0, 8_000);
    // What `Limits::fits` asks of a thing straight ahead that is seen now: see `fits_is_the_guard`.
    let way_to_rest = limits.way_to_rest(fastest);
    let time_to_rest = limits.time_to_rest(fastest);
    kani::assume(1000 * way_to_rest + speed_of_thing * time_to_rest <= 1000 * clearance);
    // Until the next command takes effect: no faster than that, and no longer than ε.
    let time = limits.reaction_time();
    let way = any_in(0, 5_000);
    kani::assume(1000 * way <= fastest * time);
    let after = any_in(0, fastest);
    let left = 1000 * (clearance - way) - speed_of_thing * time;
    assert!(promise::stays_safe(
        true,
        promise::safe_state(
            after,
            1000,
            i64::from(left),
            limits.braking(),
            speed_of_thing
        )
    ));
    kani::cover!(after == fastest && after > 300, "still at full speed");
    kani::cover!(left < 300_000, "near the end of the room");
}

/// What fits is what the guard says: term by term, each with the other factors fixed, for a thing
/// straight ahead. Together they are the assumption of `admitted_motion_stays_safe`.
fn fits_is_the_guard(vary: impl Fn(&mut Hazard, &mut Plan)) {
    let limits = pioneer();
    let mut hazard = Hazard {
        range: 2_000,
        clearance: 1_000,
        age: 0,
        way: [0; 2],
        turned: 0,
        class: Class::Unknown,
        too_fast: false,
        stuck: false,
    };
    let ahead = Closing {
        ahead: 1000,
        back: -1000,
        face: [-1000, 1000],
    };
    let mut plan = Plan {
        way: [100, 0],
        time: 500,
        turn: 0,
        turn_rate: 0,
    };
    vary(&mut hazard, &mut plan);
    let speed = limits.class_speed(hazard.class);
    let fits = limits.fits(&hazard, &ahead, &plan);
    let way = hazard.way[0] + plan.way[0];
    let needed = 1000 * way + speed * (hazard.age + plan.time);
    assert_eq!(fits, needed <= 1000 * hazard.clearance);
    kani::cover!(fits, "fits");
    kani::cover!(!fits, "does not fit");
}

/// The clearance.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn fits_by_clearance() {
    fits_is_the_guard(|hazard, _| hazard.clearance = any_in(-10_000, 20_000));
}

/// The age and the class.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn fits_by_age() {
    fits_is_the_guard(|hazard, _| {
        hazard.age = any_in(0, 10_000);
        hazard.class = any_class();
    });
}

/// The ways.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn fits_by_way() {
    fits_is_the_guard(|hazard, plan| {
        hazard.way[0] = any_in(0, 10_000);
        plan.way[0] = any_in(0, 10_000);
    });
}

/// The induction step for the Pioneer preset.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn admitted_motion_stays_safe_pioneer() {
    admitted_motion_stays_safe(pioneer(), Class::Unknown);
}

/// The induction step for the Pioneer preset and what stands still.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn admitted_motion_stays_safe_still() {
    admitted_motion_stays_safe(pioneer(), Class::Still);
}

/// The induction step for the preset of S1.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn admitted_motion_stays_safe_2012() {
    admitted_motion_stays_safe(const { Limits::new(&SRIKANDI_2012) }, Class::Unknown);
}

/// The induction step for the preset of S2.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn admitted_motion_stays_safe_2011() {
    admitted_motion_stays_safe(const { Limits::new(&SRIKANDI_2011) }, Class::Unknown);
}

/// Standing still is always possible, and needs nothing: rest is admitted in any state.
//= shield.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn rest_is_always_safe() {
    let left = i64::from(any_in(0, i32::MAX));
    assert!(promise::safe_state(
        0,
        any_in(0, 1000),
        left,
        any_in(1, 10_000),
        any_in(0, 3_000)
    ));
    assert!(promise::admitted(
        Twist::REST.speed,
        Twist::REST.turn_rate,
        false
    ));
    kani::cover!(left == 0, "in contact");
}

/// A shield of a robot with one sonar that has not moved yet, and its ring.
pub fn at_rest() -> (Shield, Ring<1>) {
    (
        const { Shield::new(&super::view::BLIND_PIONEER) },
        super::view::one_sonar(&super::view::BLIND_PIONEER),
    )
}

/// A robot at rest before one hazard.
fn before<'a>(hazard: &'a [Hazard; 1], ring: &'a Ring<1>) -> Surroundings<'a, 1> {
    Surroundings {
        hazard,
        ring,
        motion: Motion::REST,
        ahead: None,
    }
}

/// Whether there is room may be answered in any way.
pub fn any_fit(_limits: &Limits, _hazard: &Hazard, _closing: &Closing, _plan: &Plan) -> bool {
    kani::any()
}

/// Any clearance may be needed.
pub fn any_needed(
    _limits: &Limits,
    _hazard: &Hazard,
    _closing: &Closing,
    _plan: &Plan,
    _time: i32,
) -> i64 {
    i64::from(kani::any::<i32>())
}

/// Contact may be judged in any way.
pub fn any_contact(_limits: &Limits, _distance: i32, _closing: i32) -> bool {
    kani::any()
}

/// Something that the guard admits, whatever the advice, the command before, the room and the
/// search: the command before, what is admitted, the time the base had, ms, and whether it sees what
/// is behind.
fn any_admitted(advised: Twist) -> (Twist, Twist, i32, bool) {
    let config = super::view::BLIND_PIONEER;
    let guard = const { Guard::new(&super::view::BLIND_PIONEER) };
    let limits = guard.limits();
    let ring = super::view::one_sonar(&config);
    let last = twist(
        any_in(-limits.reverse_speed_max(), limits.speed_max()),
        any_in(-limits.turn_rate_max(), limits.turn_rate_max()),
    );
    let elapsed = any_in(0, limits.reaction_time());
    let hazard = [any_hazard()];
    let surroundings = Surroundings {
        hazard: &hazard,
        ring: &ring,
        motion: any_motion(),
        ahead: None,
    };
    let admission = guard.admissible(advised, last, [elapsed; 2], &surroundings);
    (last, admission.twist, elapsed, ring.looks_back())
}

/// Whatever is advised, what is admitted keeps the limits and the slew, and drives backward only
/// where it sees.
//= shield.INV-1
//= shield.INV-6
//= shield.INV-15
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Surroundings::admit, odd_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, any_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::greatest, any_found))]
pub fn any_advice_is_limited() {
    let limits = pioneer();
    let advised = twist(any_in(-10_000, 10_000), any_in(-20_000, 20_000));
    let (last, admitted, elapsed, looks_back) = any_admitted(advised);
    let (speed, turn_rate) = (admitted.speed, admitted.turn_rate);
    assert!(promise::within_limits(
        speed,
        turn_rate,
        limits.speed_max(),
        limits.reverse_speed_max(),
        limits.turn_rate_max()
    ));
    assert!(promise::slew_kept(
        last.speed,
        speed,
        limits.acceleration(),
        elapsed
    ));
    assert!(promise::slew_kept(
        last.turn_rate,
        turn_rate,
        limits.turn_acceleration(),
        elapsed
    ));
    assert!(promise::sees_where_it_goes(speed, looks_back));
    kani::cover!(speed > 300, "fast");
    kani::cover!(speed > 0 && turn_rate < 0, "a curve");
}

/// A search may find anything up to its wish: nothing rests on it.
pub fn any_found(_steps: u32, wish: i32, _admitted: impl Fn(i32) -> bool) -> i32 {
    let found = kani::any();
    kani::assume(found >= 0 && (found <= wish || found == 0));
    found
}

/// A plan may be anything, or nothing.
pub fn any_plan(_guard: &Guard, _speed: i32, turn_rate: i32, _motion: &Motion) -> Option<Plan> {
    kani::any::<bool>().then(|| Plan {
        way: [any_in(0, MOST), any_in(0, MOST)],
        time: any_in(0, MOST),
        turn: any_in(0, 10_000),
        turn_rate: turn_rate.saturating_abs(),
    })
}

/// What is admitted was admitted for just that command: guard and curvature are asked once more
/// about what is returned, however the search went.
//= shield.INV-9
//= shield.INV-13
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Surroundings::admit, odd_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, any_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::greatest, any_found))]
#[cfg_attr(kani, kani::stub(crate::shield::no_tighter, odd_curve))]
pub fn what_moves_was_admitted() {
    let config = super::view::BLIND_PIONEER;
    let guard = const { Guard::new(&super::view::BLIND_PIONEER) };
    let ring = super::view::one_sonar(&config);
    let hazard = [any_hazard()];
    let surroundings = before(&hazard, &ring);
    let advised = twist(any_in(-10_000, 10_000), any_in(-20_000, 20_000));
    let last = twist(any_in(-100, 400), 0);
    let admitted = guard
        .admissible(advised, last, [100; 2], &surroundings)
        .twist;
    #[cfg(kani)]
    let fits = odd_fits(&surroundings, &guard, admitted)
        && odd_curve(admitted.speed, admitted.turn_rate, advised);
    #[cfg(not(kani))]
    let fits = surroundings.admit(&guard, admitted)
        && sidestep::shield::no_tighter(admitted.speed, admitted.turn_rate, advised);
    assert!(promise::admitted(admitted.speed, admitted.turn_rate, fits));
    kani::cover!(admitted.speed > 0, "it drives");
    kani::cover!(admitted.speed == 0 && advised.speed > 300, "it does not");
}

/// A stand-in for plans: none for some speeds, else one by which its speed can be told.
pub fn odd_plan(_guard: &Guard, speed: i32, turn_rate: i32, _motion: &Motion) -> Option<Plan> {
    (speed % 3 != 0).then_some(Plan {
        way: [speed, 0],
        time: 0,
        turn: 0,
        turn_rate,
    })
}

/// A stand-in for room: what is nearer than the plan is fast leaves none.
pub fn odd_room(_limits: &Limits, hazard: &Hazard, _closing: &Closing, plan: &Plan) -> bool {
    hazard.clearance >= plan.way[0]
}

/// A stand-in for contact in time.
pub fn odd_contact(_limits: &Limits, distance: i32, closing: i32) -> bool {
    closing > distance
}

/// What is admitted has a plan, room for it before everything that is seen, and, if it drives forward, time
/// to contact.
//= shield.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, odd_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, odd_room))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, odd_contact)
)]
pub fn every_guard_is_asked() {
    let guard = const { Guard::new(&super::view::BLIND_PIONEER) };
    let ring = super::view::one_sonar(&super::view::BLIND_PIONEER);
    let hazard = [any_hazard()];
    let ahead = kani::any::<bool>().then(|| (any_in(0, 20_000), any_in(0, 10_000)));
    let surroundings = Surroundings {
        ahead,
        ..before(&hazard, &ring)
    };
    let told = twist(any_in(-500, 500), any_in(-2_000, 2_000));
    let admits = surroundings.admit(&guard, told);
    #[cfg(kani)]
    let (plan, fits, contact) = (odd_plan, odd_room, odd_contact);
    #[cfg(not(kani))]
    let (plan, fits, contact) = (Guard::plan, Limits::fits, Limits::contact_within_stop_time);
    let limits = guard.limits();
    let closing = &ring.sonars()[0].closing;
    let room = plan(&guard, told.speed, told.turn_rate, &Motion::REST)
        .is_some_and(|plan| fits(limits, &hazard[0], closing, &plan));
    let touches = told.speed > 0
        && ahead.is_some_and(|(distance, speed)| contact(limits, distance, told.speed + speed));
    assert!(promise::admitted(1, 0, !admits || (room && !touches)));
    assert!(admits || !room || touches);
    kani::cover!(admits && ahead.is_some(), "it drives");
    kani::cover!(!admits && room, "there is room, but not the time");
    kani::cover!(!admits && !room && !touches, "there is none");
}

/// What made it slower than advised is said, whatever there is room for: P3-DX preset, any command before.
//= shield.INV-20
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Surroundings::admit, odd_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, any_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, any_fit))]
#[cfg_attr(kani, kani::stub(crate::shield::no_tighter, any_curve))]
pub fn what_is_slower_has_a_reason() {
    let guard = const { Guard::new(&super::view::BLIND_PIONEER) };
    let ring = super::view::one_sonar(&super::view::BLIND_PIONEER);
    let hazard = [any_hazard()];
    let surroundings = before(&hazard, &ring);
    let advised = twist(any_in(-500, 500), any_in(-2_000, 2_000));
    let last = twist(any_in(-100, 400), any_in(-1_500, 1_500));
    let admission = guard.admissible(advised, last, [100; 2], &surroundings);
    assert!(promise::slower_has_a_reason(
        admission.twist.speed,
        advised.speed,
        admission.limit.is_some()
    ));
    kani::cover!(admission.limit.is_none() && advised.speed > 0, "as advised");
    kani::cover!(
        matches!(admission.limit, Some(Limit::Clearance { .. })),
        "for want of room"
    );
    kani::cover!(admission.limit == Some(Limit::Base), "as fast as it can");
}

/// Every curve is as wide as advised.
pub fn any_curve(_speed: i32, _turn_rate: i32, _advised: Twist) -> bool {
    true
}

/// The test of the curvature is the formula of the invariant, for any advice that is heeded and
/// anything that is not greater in either part.
//= shield.INV-13
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(kissat))]
pub fn curvature_is_kept() {
    let advised = twist(any_in(-10_000, 10_000), any_in(-20_000, 20_000));
    let (speed, turn_rate) = (any_in(-10_000, 10_000), any_in(-20_000, 20_000));
    kani::assume(speed.abs() <= advised.speed.abs());
    kani::assume(turn_rate.abs() <= advised.turn_rate.abs());
    if sidestep::shield::no_tighter(speed, turn_rate, advised) {
        assert!(promise::no_tighter(
            speed,
            turn_rate,
            advised.speed,
            advised.turn_rate
        ));
    }
    kani::cover!(turn_rate > 0 && speed < advised.speed, "a slower turn");
}

/// A stand-in for the test of the curvature.
pub fn odd_curve(_speed: i32, turn_rate: i32, advised: Twist) -> bool {
    turn_rate % 3 == 0 || turn_rate == advised.turn_rate
}

/// A stand-in for the room in which no search finds its way: odd speeds fit, if the range says so.
pub fn odd_fits<'a: 'a, const N: usize>(
    surroundings: &Surroundings<'a, N>,
    _guard: &Guard,
    twist: Twist,
) -> bool {
    twist.speed % 2 == 1 && twist.speed < surroundings.hazard[0].range
}

/// The search finds the greatest there is, for every wish and every threshold.
//= shield.INV-10
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn search_finds_the_greatest() {
    let wish = any_in(0, 4095);
    let threshold = any_in(0, 4095);
    let found = greatest(12, wish, |number| number <= threshold);
    assert!(promise::greatest(found, wish, threshold));
    kani::cover!(found == threshold && found < wish, "limited");
    kani::cover!(found == wish && found > 2048, "as wished");
}

/// A worse hazard leaves room for nothing more: nearer, older or of a faster class. Pioneer preset,
/// any plan that does not lead towards it; for ways and turns see the next two.
//= shield.INV-14
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn worse_is_no_easier() {
    let hazard = Hazard {
        way: [0; 2],
        turned: 0,
        ..any_hazard()
    };
    let worse = Hazard {
        clearance: any_in(-10_000, hazard.clearance),
        age: any_in(hazard.age, 10_000),
        class: if kani::any() {
            hazard.class
        } else {
            Class::Unknown
        },
        ..hazard
    };
    is_no_easier(&hazard, &worse, -1000, [0; 2]);
}

/// A hazard that was seen a while ago, at any clearance.
fn hazard_at(clearance: i32) -> Hazard {
    Hazard {
        range: 2_000,
        clearance,
        age: 100,
        way: [50; 2],
        turned: 0,
        class: Class::Unknown,
        too_fast: false,
        stuck: false,
    }
}

/// After a longer way, straight at the thing; forward or backward is the same sum.
//= shield.INV-14
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn farther_is_no_easier() {
    let hazard = Hazard {
        way: [any_in(0, 10_000), 0],
        ..hazard_at(any_in(-10_000, 20_000))
    };
    let way = [any_in(hazard.way[0], 10_000), 0];
    is_no_easier(&hazard, &Hazard { way, ..hazard }, 1000, [300; 2]);
}

/// After a wider turn, from any direction, for a way of 300 mm and 50 mm before.
//= shield.INV-14
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn turned_is_no_easier() {
    let hazard = Hazard {
        turned: any_in(0, 10_000),
        ..hazard_at(any_in(-1_000, 2_000))
    };
    let turned = any_in(hazard.turned, 10_000);
    let worse = Hazard { turned, ..hazard };
    is_no_easier(&hazard, &worse, any_in(-1000, 1000), [300, 0]);
}

fn is_no_easier(hazard: &Hazard, worse: &Hazard, cosine: i32, way: [i32; 2]) {
    let limits = pioneer();
    let closing = Closing {
        ahead: cosine,
        back: cosine,
        face: [-1000, 1000],
    };
    let plan = Plan {
        way,
        time: 500,
        turn: 0,
        turn_rate: 0,
    };
    let fits = limits.fits(hazard, &closing, &plan);
    let fits_worse = limits.fits(worse, &closing, &plan);
    assert!(promise::worse_is_no_easier(fits, fits_worse));
    kani::cover!(fits && !fits_worse, "worse");
}

/// SH.6: a turn on the spot that fits ends before contact with a person, whatever the thing's class;
/// not to turn asks for no more than the class's own speed. Pioneer preset, any turn rate, any
/// clearance, seen a tenth of a second ago.
//= shield.INV-12
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn turn_ends_before_contact() {
    let limits = pioneer();
    let hazard = Hazard {
        way: [0; 2],
        class: any_class(),
        ..hazard_at(any_in(-10_000, 20_000))
    };
    let closing = Closing {
        ahead: -1000,
        back: -1000,
        face: [-1000, 1000],
    };
    let plan = Plan {
        way: [0; 2],
        time: limits.reaction_time(),
        turn: 0,
        turn_rate: any_in(0, 20_000),
    };
    let class = if plan.turn_rate > 0 {
        Class::Unknown
    } else {
        hazard.class
    };
    let o = limits.class_speed(class);
    if limits.fits(&hazard, &closing, &plan) {
        assert!(promise::turn_ends_before_contact(
            plan.turn_rate,
            limits.turn_acceleration(),
            limits.reaction_time(),
            o,
            i64::from(1000 * hazard.clearance - o * hazard.age),
        ));
        kani::cover!(
            plan.turn_rate > 1_500 && hazard.class == Class::Still,
            "a fast turn beside what stands still"
        );
    }
}

/// Any bit pattern as advice.
fn any_advice() -> Advice {
    Advice {
        speed: kani::any(),
        turn_rate: kani::any(),
    }
}

/// Something may be admitted for any advice: within the limits, as `any_advice_is_limited` shows.
pub fn any_admission<const N: usize>(
    guard: &Guard,
    advised: Twist,
    _last: Twist,
    _elapsed: [i32; 2],
    _surroundings: &Surroundings<'_, N>,
) -> Admission {
    let limits = guard.limits();
    let speed = any_in(-limits.reverse_speed_max(), limits.speed_max());
    let turn_rate = any_in(-limits.turn_rate_max(), limits.turn_rate_max());
    // How tight the path bends is not needed, and costs a solver two products.
    kani::assume(speed.abs() <= advised.speed.abs());
    kani::assume(turn_rate.abs() <= advised.turn_rate.abs());
    kani::assume((advised.speed < 0) == (speed < 0) || speed == 0);
    Admission {
        twist: twist(speed, turn_rate),
        limit: None,
    }
}

/// A shield that is ready to go, with any view and any advice: limits are kept, a stop is kept,
/// and a view that cannot be trusted (a sonar stale, missing, not a number or in contact, motors
/// off, a stall, the emergency stop) yields no motion at all. That raw observations become such
/// views is `view::only_ranges_are_readings`.
//= shield.INV-1
//= shield.INV-4
//= shield.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, any_fit))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::needed, any_needed))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, any_contact)
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, any_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, any_admission))]
pub fn any_law_is_shielded() {
    let (mut shield, ring) = at_rest();
    let clear = super::view::clear_view();
    // The stand-ins may ask for any clearance: go on where they let the robot go.
    kani::assume(shield.assess(&clear, &ring).is_none());
    shield.admit(Advice::REST, &clear, &ring);
    let view = super::view::any_view();
    let stop = shield.assess(&view, &ring);
    let verdict = shield.admit(any_advice(), &view, &ring);
    let command = verdict.command;
    assert!(promise::within_limits(
        command.speed(),
        command.turn_rate(),
        shield.limits().speed_max(),
        shield.limits().reverse_speed_max(),
        shield.limits().turn_rate_max()
    ));
    assert!(promise::stop_is_kept(
        verdict.stop.is_some(),
        verdict.stop.is_some_and(|stop| stop.may_turn()),
        shield.is_latched(),
        command.speed(),
        command.turn_rate(),
    ));
    let signs = signs(&view, 400, 0, false);
    let trusted = !signs.base && !signs.untrusted;
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

/// Where these stand in for the guard it never says no.
const ROOM: bool = cfg!(kani);

/// There is room for everything.
pub fn always_fits(_limits: &Limits, _hazard: &Hazard, _closing: &Closing, _plan: &Plan) -> bool {
    true
}

/// Nothing comes within reach in time.
pub fn no_contact(_limits: &Limits, _distance: i32, _closing: i32) -> bool {
    false
}

/// A plan there is, whatever it says.
pub fn some_plan(guard: &Guard, speed: i32, turn_rate: i32, motion: &Motion) -> Option<Plan> {
    let plan = any_plan(guard, speed, turn_rate, motion);
    kani::assume(plan.is_some());
    plan
}

/// What a view of one sonar shows, for a robot that is to stand at `least` mm.
fn signs(view: &View<1>, least: i32, elapsed: i64, moving: bool) -> promise::Signs {
    promise::Signs {
        base: !view.base.motors_enabled || view.base.stalled || view.base.emergency_stop,
        untrusted: !matches!(
            view.sonar[0],
            SonarReading::Echo(_) | SonarReading::NoEcho(_)
        ),
        ahead: [view.hazard[0].range, least],
        saturated: view
            .obstacle
            .is_some_and(|obstacle| obstacle.speed.saturated),
        elapsed: [elapsed, 220],
        stuck: view.hazard[0].stuck,
        moving,
    }
}

/// Whether a view stops the robot: for any sign that demands it and, where there is room, for nothing else.
fn stopped_by(
    signs: &promise::Signs,
    (shield, ring): (&mut Shield, &Ring<1>),
    view: &View<1>,
) -> Option<StopReason> {
    let stop = shield.assess(view, ring);
    assert!(promise::every_cause_stops(signs, stop.is_some()));
    assert!(promise::nothing_else_stops(signs, ROOM, stop.is_some()));
    stop
}

/// A robot that was told to drive, turn or rest is stopped by any sign that demands it, and, where there
/// is room, by no other view; what is to be latched is latched at once.
//= shield.INV-16
//= shield.INV-17
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::needed, any_needed))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, no_contact)
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, any_admission))]
pub fn every_cause_stops() {
    let (mut shield, ring) = at_rest();
    let clear = super::view::clear_view();
    kani::assume(shield.assess(&clear, &ring).is_none());
    let advice = Advice {
        speed: 0.4,
        turn_rate: 1.0,
    };
    let told = shield.admit(advice, &clear, &ring).command;
    let moving = told.speed() != 0 || told.turn_rate() != 0;
    let mut view = super::view::any_view();
    let elapsed: i16 = kani::any();
    view.now = Instant(clear.now.0.saturating_add_signed(elapsed.into()));
    let elapsed = view.now.0 as i64 - clear.now.0 as i64;
    let signs = signs(&view, 400, elapsed, moving);
    let stop = stopped_by(&signs, (&mut shield, &ring), &view);
    let latches = stop.is_some_and(|stop| stop.action() == Action::LatchedStop);
    assert!(shield.is_latched() == latches);
    kani::cover!(stop.is_none() && moving, "it goes on");
    kani::cover!(latches, "latched");
    kani::cover!(matches!(stop, Some(StopReason::LoopLate { .. })), "late");
}

/// A robot that is stopped stays so for any sign, with more distance ahead asked for, and otherwise, where
/// there is room, one view ends it.
//= shield.INV-16
//= shield.INV-17
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::needed, any_needed))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, no_contact)
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
pub fn a_stop_ends() {
    let (mut shield, ring) = at_rest();
    let view = super::view::any_view();
    let signs = signs(&view, 450, 0, false);
    let stop = stopped_by(&signs, (&mut shield, &ring), &view);
    kani::cover!(stop.is_none(), "free");
    kani::cover!(
        matches!(stop, Some(StopReason::MinDistance { range: 450, .. })),
        "not far enough"
    );
}

/// Where these stand in for the guard, a tick shows what the guard is asked about.
const SHOWN: bool = cfg!(kani);

/// The advice upon which the stand-ins below admit any command within the limits.
const ANYTHING: Advice = Advice {
    speed: 0.4,
    turn_rate: 1.0,
};

fn any_command(guard: &Guard, advised: Twist) -> Option<Admission> {
    let limits = guard.limits();
    (advised.speed == 400).then(|| Admission {
        twist: twist(
            any_in(-limits.reverse_speed_max(), limits.speed_max()),
            any_in(-limits.turn_rate_max(), limits.turn_rate_max()),
        ),
        limit: None,
    })
}

/// In place of what is admitted: how the robot is taken to move.
pub fn motion_shown<const N: usize>(
    guard: &Guard,
    advised: Twist,
    _last: Twist,
    _elapsed: [i32; 2],
    surroundings: &Surroundings<'_, N>,
) -> Admission {
    let Motion {
        speed,
        backward,
        turn_rate,
    } = surroundings.motion;
    any_command(guard, advised).unwrap_or(Admission {
        twist: twist(speed, turn_rate),
        limit: backward.then_some(Limit::Base),
    })
}

/// In place of what is admitted: the thing ahead, nothing being a hundred kilometres away.
pub fn approach_shown<const N: usize>(
    guard: &Guard,
    advised: Twist,
    _last: Twist,
    _elapsed: [i32; 2],
    surroundings: &Surroundings<'_, N>,
) -> Admission {
    let (distance, speed) = surroundings.ahead.unwrap_or((100_000_000, 0));
    any_command(guard, advised).unwrap_or(Admission {
        twist: twist(distance, speed),
        limit: None,
    })
}

/// In place of what is admitted: how long the base had to gain speed and turn rate.
pub fn time_shown<const N: usize>(
    guard: &Guard,
    advised: Twist,
    _last: Twist,
    [gaining, turning]: [i32; 2],
    _surroundings: &Surroundings<'_, N>,
) -> Admission {
    any_command(guard, advised).unwrap_or(Admission {
        twist: twist(gaining, turning),
        limit: None,
    })
}

/// In place of what is admitted: what is advised.
pub fn advice_shown<const N: usize>(
    _guard: &Guard,
    advised: Twist,
    _last: Twist,
    _elapsed: [i32; 2],
    _surroundings: &Surroundings<'_, N>,
) -> Admission {
    Admission {
        twist: advised,
        limit: None,
    }
}

/// A robot that was told any command at 1 s, which is returned, and nothing stops.
fn told_anything() -> (Shield, Ring<1>, Twist) {
    let (mut shield, ring) = at_rest();
    let clear = super::view::clear_view();
    let stop = shield.assess(&clear, &ring);
    assert!(stop.is_none());
    let told = shield.admit(ANYTHING, &clear, &ring).command;
    (shield, ring, twist(told.speed(), told.turn_rate()))
}

/// A stand-in for rounding a length or speed up, which `limits_are_rounded_up` has proved: 0 for 0 alone, and
/// cheap for a solver.
pub fn odd_up(metres: f32) -> i32 {
    if metres == 0.0 {
        0
    } else {
        1 + (metres.to_bits() >> 23) as i32
    }
}

/// A stand-in for rounding down; both still let the ring be built.
pub fn odd_down(metres: f32) -> i32 {
    (metres.to_bits() >> 23) as i32
}

/// How a robot is taken to move that was told anything and measures anything.
//= shield.INV-19
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, motion_shown))]
#[cfg_attr(kani, kani::stub(crate::shield::millimetres_up, odd_up))]
pub fn motion_is_covered() {
    let (mut shield, ring, told) = told_anything();
    let view = View {
        speed: super::view::any_between(-10.0, 10.0),
        turn_rate: super::view::any_between(-20.0, 20.0),
        odometry_age: kani::any(),
        ..super::view::clear_view()
    };
    let limits = *shield.limits();
    let verdict = shield.admit(Advice::REST, &view, &ring);
    let shown = verdict.command;
    let backward = verdict.limit == Some(Limit::Base);
    let age = view.odometry_age.min(limits.reaction_time() as u64) as i32;
    assert!(
        !SHOWN
            || promise::motion_is_covered(
                promise::Moving {
                    speed: shown.speed(),
                    backward,
                    turn_rate: shown.turn_rate(),
                },
                promise::Moving {
                    speed: odd_up(view.speed.abs()),
                    backward: view.speed < 0.0,
                    turn_rate: odd_up(view.turn_rate.abs()),
                },
                [told.speed, told.turn_rate],
                [limits.acceleration(), age, limits.speed_error()],
            )
    );
    kani::cover!(
        !SHOWN || shown.speed() == told.speed && told.speed > 0,
        "as told"
    );
    kani::cover!(!SHOWN || shown.speed() > 150 && told.speed < 100, "faster");
    kani::cover!(!SHOWN || backward, "backward");
}

/// How a thing is taken to come that the law follows.
//= shield.INV-19
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, approach_shown))]
#[cfg_attr(kani, kani::stub(crate::shield::millimetres_up, odd_up))]
#[cfg_attr(kani, kani::stub(crate::shield::millimetres_down, odd_down))]
pub fn approach_is_covered() {
    let (mut shield, ring, _) = told_anything();
    let view = super::view::any_view();
    let shown = shield.admit(Advice::REST, &view, &ring).command;
    let shown = [shown.speed(), shown.turn_rate()];
    let Some(obstacle) = view.obstacle else {
        assert!(!SHOWN || shown == [100_000_000, 0]);
        return;
    };
    let measured = [
        odd_down(obstacle.distance.get()),
        odd_up(obstacle.speed.value.get()),
    ];
    assert!(!SHOWN || promise::approach_is_covered(shown, measured, obstacle.contact_range));
    kani::cover!(!SHOWN || shown[0] == 0, "within reach");
    kani::cover!(!SHOWN || shown[0] > 100, "farther away");
}

/// The time in which the base may gain speed: a pause gives no licence to leap.
//= shield.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, time_shown))]
pub fn a_pause_gives_no_licence() {
    let (mut shield, ring, _) = told_anything();
    let limits = *shield.limits();
    let mut before = 1_000_i64;
    // Another tick without a view in between, or none.
    if kani::any() {
        let now = u64::from(kani::any::<u16>());
        shield.refuse(StopReason::OdometryStale, Instant(now));
        before = before.max(now as i64);
        let clear = super::view::clear_view();
        let stop = shield.assess(&clear, &ring);
        assert!(stop.is_some() == (before > 1_000));
        kani::assume(stop.is_none());
    }
    let view = View {
        now: Instant(u64::from(kani::any::<u16>())),
        ..super::view::any_view()
    };
    let shown = shield.admit(Advice::REST, &view, &ring).command;
    let since = view.now.0 as i64 - before;
    let unseen = view.obstacle.is_some_and(|obstacle| !obstacle.seen_now);
    assert!(
        !SHOWN
            || promise::time_to_gain(
                [shown.speed(), shown.turn_rate()],
                since,
                limits.reaction_time(),
                unseen
            )
    );
    kani::cover!(!SHOWN || shown.speed() == 220, "all of a reaction time");
    kani::cover!(
        !SHOWN || (shown.turn_rate() > 0 && shown.speed() == 0),
        "out of sight"
    );
}

/// What is asked for is what was advised, in whole numbers; a robot that is stopped is not asked to drive
/// ahead; and advice that makes no sense stops it.
//= shield.INV-4
//= shield.INV-13
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(kissat))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, any_fit))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::needed, any_needed))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, advice_shown))]
pub fn advice_is_taken_whole() {
    let (mut shield, ring) = at_rest();
    let clear = super::view::clear_view();
    let stop = shield.assess(&clear, &ring);
    let advice = any_advice();
    let verdict = shield.admit(advice, &clear, &ring);
    let (speed, turn_rate) = (verdict.command.speed(), verdict.command.turn_rate());
    let sensible = promise::sensible(advice.speed, advice.turn_rate);
    assert!(verdict.stop.is_none() == (stop.is_none() && sensible));
    if stop.is_none() && sensible && SHOWN {
        assert!(promise::taken_whole(speed, advice.speed));
        assert!(promise::taken_whole(turn_rate, advice.turn_rate));
    }
    if stop.is_some() {
        assert!(promise::stop_is_kept(true, true, false, speed, turn_rate));
        // What it may still do, it may as far as advised.
        assert!(
            !SHOWN
                || !sensible
                || advice.speed > 0.0
                || promise::taken_whole(turn_rate, advice.turn_rate)
        );
    }
    kani::cover!(speed > 0, "ahead");
    kani::cover!(!SHOWN || (stop.is_some() && speed < 0), "it backs off");
    kani::cover!(!sensible && stop.is_none(), "nonsense");
}

/// Where nothing has room, every tick stops the robot, and while it moves something too fast latches it.
//= shield.INV-18
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, odd_room))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::needed, any_needed))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, odd_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::admissible, motion_shown))]
pub fn no_room_stops() {
    let (mut shield, ring, told) = told_anything();
    let hazard = any_hazard();
    let view = View {
        hazard: [Hazard {
            range: 4_000,
            stuck: false,
            ..hazard
        }],
        ..super::view::clear_view()
    };
    // The stand-in finds no room for the least speed, or for the greatest, where less is clear.
    let [room, ample] = [1, 400].map(|least| hazard.clearance >= least);
    let stop = shield.assess(&view, &ring);
    let moves = told != Twist::REST;
    let accused = moves && hazard.too_fast && !ample;
    let latched = shield.is_latched();
    if SHOWN {
        assert!(promise::no_room_stops(room, false, stop.is_some()));
        assert!(promise::too_fast_latches(
            moves,
            hazard.too_fast,
            ample,
            latched
        ));
        // Nothing else in this view stops the robot, or latches the stop.
        assert_eq!(stop.is_some(), !room || accused);
        assert_eq!(latched, accused);
    }
    kani::cover!(!SHOWN || (stop.is_some() && !accused), "no room");
    kani::cover!(!SHOWN || (accused && room), "too fast");
}

/// Contact that is possible within the stop time stops the robot, whether it moves or not, with the resume
/// clearance on top while it is stopped; otherwise it does not.
//= shield.INV-18
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, always_fits))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::contact_within_stop_time, odd_contact)
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, some_plan))]
#[cfg_attr(kani, kani::stub(crate::shield::millimetres_up, odd_up))]
#[cfg_attr(kani, kani::stub(crate::shield::millimetres_down, odd_down))]
pub fn contact_in_time_stops() {
    let (mut shield, ring) = at_rest();
    let clear = super::view::clear_view();
    let stopped: bool = kani::any();
    if !stopped {
        shield.assess(&clear, &ring);
    }
    let Some(mut obstacle) = super::view::any_view().obstacle else {
        return;
    };
    obstacle.speed.saturated = false;
    let view = View {
        speed: f32::from(kani::any::<i16>()) / 64.0,
        obstacle: Some(obstacle),
        ..clear
    };
    kani::assume(view.speed.abs() <= 10.0);
    // The robot's own share, told to rest: what was measured, and the error.
    let own = if view.speed > 0.0 {
        odd_up(view.speed) + 50
    } else {
        0
    };
    let closing = own + odd_up(obstacle.speed.value.get());
    let left = (odd_down(obstacle.distance.get()) - obstacle.contact_range).max(0);
    let left = (left - if stopped { 50 } else { 0 }).max(0);
    let stop = shield.assess(&view, &ring);
    if SHOWN {
        assert!(promise::no_room_stops(true, closing > left, stop.is_some()));
        assert!(stop.is_none() || closing > left);
    }
    kani::cover!(!SHOWN || (stop.is_some() && left > 0), "at a distance");
    kani::cover!(!SHOWN || stop.is_none(), "in time");
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
