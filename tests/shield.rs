//! Chapter `shield`: the guard, for every configuration that can be constructed.
//!
//! Proofs settle these for the presets, and some for all values (`proofs/shield.rs`); here every
//! parameter varies. The theorem itself is driven in `tests/passive_safety.rs`.

mod common;

use common::{
    advice, between, config, hazard, in_order, pioneer, pioneer_with, settings,
    usual_or_any_config, view,
};
use proptest::array::UniformArrayStrategy;
use proptest::prelude::*;
use sidestep::avoid::{ObstacleSpeed, Trend};
use sidestep::config::{Config, Parameters};
use sidestep::failsafe::StopReason;
use sidestep::law::Advice;
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::ring::{Closing, Placement, Ring};
use sidestep::shield::{
    Command, Guard, Limit, Limits, Motion, Plan, Shield, Surroundings, Twist, Verdict, greatest,
};
use sidestep::track::Obstacle;
use sidestep::view::{Class, Hazard, Memory, View};
use sidestep_spec::shield as promise;

#[path = "../fuzz/targets/reference.rs"]
mod reference;
use reference::{has_room, left_for_turn};

/// A share of a whole, its ends more often than by chance.
fn share() -> impl Strategy<Value = f64> {
    between(0.0, 1.0).prop_map(f64::from)
}

/// The integer at a share of `0..=most`.
fn of(share: f64, most: i32) -> i32 {
    (share * f64::from(most)).round() as i32
}

/// The greatest speed a command may ever come to: v_max and one gain.
fn top(limits: &Limits) -> i32 {
    limits.speed_max() + 2 * limits.speed_gain() + limits.speed_error()
}

/// Any cosines that a sonar may have.
fn closing() -> impl Strategy<Value = Closing> {
    (-1000..=1000_i32, -1000..=1000_i32).prop_map(|(ahead, back)| Closing {
        ahead,
        back,
        face: [-1000, 1000],
    })
}

/// Any motion, as a share of what the base can do, or beyond that.
fn motion() -> impl Strategy<Value = (f64, bool, f64)> {
    let speed = prop_oneof![2 => Just(0.0), 6 => share(), 1 => 1.0..4.0_f64];
    let turn_rate = prop_oneof![2 => Just(0.0), 6 => share(), 1 => 1.0..10.0_f64];
    (speed, any::<bool>(), turn_rate)
}

fn motion_of(limits: &Limits, (speed, backward, turn_rate): (f64, bool, f64)) -> Motion {
    Motion {
        speed: of(speed, top(limits)),
        backward,
        turn_rate: of(turn_rate, limits.turn_rate_max()),
    }
}

/// A twist that may have been told: speeds and turn rates as shares of their limits.
fn twist_of(limits: &Limits, (speed, turn_rate): (f64, f64)) -> Twist {
    let most = if speed < 0.0 {
        limits.reverse_speed_max()
    } else {
        limits.speed_max()
    };
    Twist {
        speed: of(speed, most),
        turn_rate: of(turn_rate, limits.turn_rate_max()),
    }
}

fn twist() -> impl Strategy<Value = (f64, f64)> {
    let share = || prop_oneof![1 => Just(0.0), 6 => -1.0..=1.0_f64];
    (share(), share())
}

/// Any advice that is asked about: up to 10 m/s and 20 rad/s either way.
fn advised() -> impl Strategy<Value = Twist> {
    let speed = prop_oneof![4 => -2_500..=2_500_i32, 1 => -10_000..=10_000_i32, 1 => Just(0)];
    let rate = prop_oneof![4 => -4_500..=4_500_i32, 1 => -20_000..=20_000_i32, 1 => Just(0)];
    (speed, rate).prop_map(|(speed, turn_rate)| Twist { speed, turn_rate })
}

// ---------------------------------------------------------------- the formulas

proptest! {
    #![proptest_config(common::cases(4_000))]

    /// Limits are the configuration in integers, rounded to the safe side.
    //= shield.INV-2
    #[test]
    fn limits_are_rounded_to_the_safe_side(config in config()) {
        let limits = Limits::new(&config);
        let wide = f64::from;
        for (limit, configured) in [
            (limits.speed_max(), wide(config.speed_max)),
            (limits.reverse_speed_max(), wide(config.reverse_speed_max)),
            (limits.turn_rate_max(), wide(config.turn_rate_max)),
            (limits.braking(), wide(config.braking) * wide(config.braking_share)),
            (limits.turn_acceleration(), wide(config.turn_acceleration)),
        ] {
            prop_assert!(promise::rounded_down(limit, configured), "{limit}, {configured}");
        }
        for (limit, configured) in [
            (limits.acceleration(), config.acceleration),
            (limits.reaction_time(), config.reaction_time),
            (limits.class_speed(Class::Unknown), config.obstacle_speed_max),
            (limits.class_speed_turning(Class::Unknown, true), config.obstacle_speed_max),
            (limits.class_speed(Class::Still), config.still_speed_max),
            (limits.class_speed_turning(Class::Still, false), config.still_speed_max),
            (limits.class_speed_turning(Class::Still, true), config.still_speed_max_turning),
            (limits.speed_error(), config.speed_error),
            (limits.stop_time(), config.stop_time),
        ] {
            prop_assert!(promise::rounded_up(limit, wide(configured)), "{limit}, {configured}");
        }
        prop_assert!(limits.class_speed(Class::Still) <= limits.class_speed(Class::Unknown));
    }

    //= shield.INV-2
    #[test]
    fn rest_is_covered(config in usual_or_any_config(), share in share()) {
        let limits = Limits::new(&config);
        let fastest = of(share, top(&limits));
        let (way, time) = (limits.way_to_rest(fastest), limits.time_to_rest(fastest));
        prop_assert!(promise::covers_rest(
            way, time, fastest, limits.braking(), limits.reaction_time()
        ));
        // And by no more than a millimetre for each term, and a millisecond.
        let model = reference::model(&limits, &FAR);
        prop_assert!(f64::from(way) < model.way_to_rest(f64::from(fastest)) + 2.0);
        prop_assert!(f64::from(time) < model.time_to_rest(f64::from(fastest)) + 1.0);
    }

    /// What is said to be needed straight ahead is what a plan needs of a thing that was seen just
    /// now, and it is at least what is published, for the same greatest speed.
    //= shield.INV-2
    #[test]
    fn required_clearance_is_what_a_plan_needs(
        config in usual_or_any_config(), share in share(),
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let speed = of(share, limits.speed_max()).max(1);
        let required = limits.required_clearance(speed);
        let model = reference::model(limits, &FAR);
        // The published guard counts V during ε and during braking from v + A·ε as well.
        let published = model.published(f64::from(speed));
        let seconds = model.reaction_time / 1000.0;
        let gain = model.acceleration * seconds;
        // Ours lets the robot have its greatest speed all through the reaction time.
        let exact = published + gain * seconds / 2.0;
        prop_assert!(f64::from(required) >= exact - 1e-9 * exact, "{required} for {exact}");
        let seen = |clearance| Hazard { clearance, ..FAR };
        let plan = guard.plan(speed, 0, &Motion::REST).expect("a speed that may be told");
        // A plan goes by one of 64 speeds, which is faster by one step at most.
        let step = top(limits) / 64 + 1;
        let slower = limits.required_clearance((speed + step).min(limits.speed_max() + step));
        prop_assert!(!limits.fits(&seen(required - 4), &AHEAD, &plan));
        prop_assert!(limits.fits(&seen(slower), &AHEAD, &plan));
    }

    //= shield.INV-10
    #[test]
    fn search_finds_the_greatest(
        steps in 1..=13_u32, wish in share(), threshold in share(),
    ) {
        let most = (1 << steps) - 1;
        let (wish, threshold) = (of(wish, most), of(threshold, most));
        let found = greatest(steps, wish, |number| number <= threshold);
        prop_assert!(promise::greatest(found, wish, threshold));
    }

    /// A plan allows for the speed that the robot may have and for the one it is told, in either
    /// direction, and for no more than the next of the 64 speeds it knows.
    //= shield.INV-2
    //= shield.INV-11
    #[test]
    fn plans_allow_for_what_is_told_and_what_is(
        config in usual_or_any_config(), motion in motion(), twist in twist(),
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let (motion, twist) = (motion_of(limits, motion), twist_of(limits, twist));
        let gain = limits.speed_gain();
        let told = usize::from(twist.speed < 0);
        let rolling = usize::from(motion.backward);
        let mut least = [0; 2];
        least[rolling] = motion.speed;
        if twist.speed != 0 {
            least[told] = least[told].max(twist.speed.abs() + gain);
        }
        let Some(plan) = guard.plan(twist.speed, twist.turn_rate, &motion) else {
            // Faster than it may ever be told.
            prop_assert!(least[0].max(least[1]) > top(limits));
            return Ok(());
        };
        for way in [0, 1] {
            let speed = if twist.speed != 0 && told == way { twist.speed } else { 0 };
            let moving = if rolling == way { motion.speed } else { 0 };
            prop_assert!(promise::plan_suffices(
                [plan.way[way], plan.time],
                [speed, gain, moving],
                [limits.braking(), limits.reaction_time()],
            ));
            let most = if least[way] == 0 { 0 } else { least[way] + top(limits) / 64 + 1 };
            prop_assert!(plan.way[way] <= limits.way_to_rest(most));
        }
        let rate = i64::from(twist.turn_rate.abs().max(motion.turn_rate));
        prop_assert_eq!(i64::from(plan.turn_rate), rate);
        let turn = (rate * i64::from(plan.time)).min(10_000_000);
        prop_assert!((turn..turn + 1000).contains(&(i64::from(plan.turn) * 1000)));
    }

    /// What fits in integers fits exactly.
    //= shield.INV-9
    //= shield.INV-12
    #[test]
    fn what_fits_has_room(
        config in usual_or_any_config(), motion in motion(), twist in twist(),
        hazard in hazard(), closing in closing(),
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let (motion, twist) = (motion_of(limits, motion), twist_of(limits, twist));
        let Some(plan) = guard.plan(twist.speed, twist.turn_rate, &motion) else {
            return Ok(());
        };
        let fits = limits.fits(&hazard, &closing, &plan);
        let room = has_room(limits, &hazard, &closing, &motion, twist);
        prop_assert!(!fits || room, "{plan:?}");
        if fits {
            let (bound, left) = left_for_turn(limits, &hazard, &closing, &motion, twist);
            prop_assert!(promise::turn_ends_before_contact(
                plan.turn_rate,
                limits.turn_acceleration(),
                limits.reaction_time(),
                bound,
                left,
            ));
        }
    }

    //= shield.INV-14
    #[test]
    fn worse_fits_no_better(
        config in usual_or_any_config(), motion in motion(), twist in twist(),
        hazard in hazard(), closing in closing(),
        nearer in 0..300_i32, older in 0..300_i32, farther in [0..100_i32, 0..100_i32],
        turned in 0..200_i32, unknown in any::<bool>(), what in 0..64_u8,
        slack in -3..200_i32,
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let (motion, twist) = (motion_of(limits, motion), twist_of(limits, twist));
        let Some(plan) = guard.plan(twist.speed, twist.turn_rate, &motion) else {
            return Ok(());
        };
        // Not far from where it just fits.
        let needed = limits.needed(&hazard, &closing, &plan, plan.time) / 1000;
        let clearance = needed as i32 + slack;
        let hazard = Hazard { clearance, ..hazard };
        let when = |bit: u8, more: i32| if what & bit == 0 { 0 } else { more };
        let worse = Hazard {
            clearance: hazard.clearance - when(1, nearer),
            age: hazard.age + when(2, older),
            way: [hazard.way[0] + when(4, farther[0]), hazard.way[1] + when(8, farther[1])],
            turned: hazard.turned + when(16, turned),
            class: if unknown { Class::Unknown } else { hazard.class },
            ..hazard
        };
        prop_assert!(promise::worse_is_no_easier(
            limits.fits(&hazard, &closing, &plan), limits.fits(&worse, &closing, &plan)
        ));
    }

    //= shield.INV-7
    //= shield.INV-8
    #[test]
    fn contact_time_is_sound_and_monotone(
        config in usual_or_any_config(),
        distance in prop_oneof![0..5_000_i32, 0..1_000_000_i32], closing in 0..13_000_i32,
        time in share(), nearer in share(), faster in share(),
    ) {
        let limits = Limits::new(&config);
        let stops = limits.contact_within_stop_time(distance, closing);
        let time = of(time, limits.stop_time());
        prop_assert!(promise::sound(distance, closing, time, stops));
        let (nearer, faster) = (of(nearer, distance), closing + of(faster, 13_000 - closing));
        let also = limits.contact_within_stop_time(nearer, faster);
        prop_assert!(promise::monotone(stops, also));
        // On the threshold itself it stops: t_lb ≤ T, not less than T.
        let way = i64::from(limits.stop_time()) * i64::from(closing);
        if way % 1000 == 0 && way / 1000 <= 1_000_000 {
            prop_assert!(limits.contact_within_stop_time((way / 1000) as i32, closing));
        }
    }
}

/// Far away, seen just now.
const FAR: Hazard = Hazard {
    range: 20_000,
    clearance: 20_000,
    age: 0,
    way: [0; 2],
    turned: 0,
    class: Class::Unknown,
    too_fast: false,
    stuck: false,
};

/// Straight ahead.
const AHEAD: Closing = Closing {
    ahead: 1000,
    back: -1000,
    face: [1000, 1000],
};

// --------------------------------------------------------------- the inductive step

/// How an admitted command is carried out within one reaction time, in shares of what may be.
#[derive(Clone, Copy, Debug)]
struct Carried {
    time: f64,
    robot: f64,
    thing: f64,
    after: f64,
}

fn carried() -> impl Strategy<Value = Carried> {
    (share(), share(), share(), share()).prop_map(|(time, robot, thing, after)| Carried {
        time,
        robot,
        thing,
        after,
    })
}

/// The cosine that a thing may be at by the end of a plan, thousandths.
fn turned(cosine: i32, hazard: &Hazard, plan: &Plan) -> i32 {
    (cosine + hazard.turned + plan.turn).clamp(0, 1000)
}

proptest! {
    #![proptest_config(common::cases(4_000))]

    /// From any state in which a plan fits, whatever robot and thing do within the model for one
    /// reaction time, the state is safe: braking then ends before contact.
    //= shield.INV-3
    #[test]
    fn admitted_motion_stays_safe(
        config in usual_or_any_config(), motion in motion(), twist in twist(),
        hazard in hazard(), closing in closing(), spare in prop_oneof![Just(0), 0..3_000_i32],
        carried in carried(),
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let motion = motion_of(limits, motion);
        // In one direction: a robot that turns back is a matter of two ways to rest.
        let mut twist = twist_of(limits, twist);
        if twist.speed != 0 && motion.speed != 0 {
            twist.speed = twist.speed.abs() * if motion.backward { -1 } else { 1 };
        }
        let backward = twist.speed < 0 || (twist.speed == 0 && motion.backward);
        let Some(plan) = guard.plan(twist.speed, twist.turn_rate, &motion) else {
            return Ok(());
        };
        // The least clearance for which there is room, and some more.
        let driving = limits.needed(&hazard, &closing, &plan, plan.time);
        let clearance = ((driving + 999) / 1000) as i32 + spare;
        let hazard = Hazard { clearance, ..hazard };
        prop_assume!(limits.fits(&hazard, &closing, &plan));
        let mut fastest = motion.speed;
        if twist.speed != 0 {
            fastest = fastest.max(twist.speed.abs() + limits.speed_gain());
        }
        let speed_of_thing = limits.class_speed(hazard.class);
        let time = of(carried.time, limits.reaction_time());
        let robot = of(carried.robot, fastest * time / 1000);
        // Since it was seen, and in the step.
        let thing = i64::from(speed_of_thing) * (i64::from(hazard.age) + i64::from(time));
        let thing = (carried.thing * thing as f64) as i64;
        let after = of(carried.after, fastest);
        let cosine = [closing.ahead, closing.back].map(|cosine| turned(cosine, &hazard, &plan));
        let own = usize::from(backward);
        let mut ways = hazard.way.map(i64::from);
        ways[own] += i64::from(robot);
        let left = 1000 * i64::from(hazard.clearance)
            - i64::from(cosine[0]) * ways[0]
            - i64::from(cosine[1]) * ways[1]
            - thing;
        let safe = promise::safe_state(
            after, cosine[own], left, limits.braking(), speed_of_thing
        );
        prop_assert!(promise::stays_safe(true, safe));
    }

    /// Braking keeps a safe state safe. Down to thousandths of a millimetre: what the robot travels
    /// while it loses speed is a fraction of them, and the state is judged exactly.
    //= shield.INV-3
    #[test]
    fn braking_stays_safe(
        config in usual_or_any_config(),
        speed in share(), carried in carried(), cosine in 0..=1000_i32, still in any::<bool>(),
        spare in prop_oneof![Just(0_i64), 0..3_000_000_i64],
    ) {
        let limits = Limits::new(&config);
        let class = if still { Class::Still } else { Class::Unknown };
        let (b, o) = (limits.braking(), limits.class_speed(class));
        let [wide_b, wide_o, k] = [b, o, cosine].map(i64::from);
        let speed = of(speed, top(&limits));
        let v = i64::from(speed);
        // The least clearance at which this is a safe state, and some more.
        let least = (k * v * v + 2000 * wide_o * v + 2 * wide_b - 1) / (2 * wide_b);
        let left = least + spare;
        prop_assert!(promise::safe_state(speed, cosine, left, b, o));
        let after = of(carried.after, speed);
        let w = i64::from(after);
        let robot = carried.robot * (k * (v * v - w * w) / (2 * wide_b)) as f64;
        let thing = carried.thing * (1000 * wide_o * (v - w) / wide_b) as f64;
        let left_after = left - robot.floor() as i64 - thing.floor() as i64;
        prop_assert!(promise::stays_safe(
            promise::safe_state(speed, cosine, left, b, o),
            promise::safe_state(after, cosine, left_after, b, o),
        ));
    }

    /// Standing still is always possible, and so is braking: whatever was admitted, its plan still
    /// fits when the robot is told to rest instead.
    //= shield.INV-3
    //= shield.INV-14
    #[test]
    fn rest_needs_no_more_than_what_was_admitted(
        config in usual_or_any_config(), motion in motion(), twist in twist(),
        hazard in hazard(), closing in closing(),
    ) {
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let (motion, twist) = (motion_of(limits, motion), twist_of(limits, twist));
        let Some(plan) = guard.plan(twist.speed, twist.turn_rate, &motion) else {
            return Ok(());
        };
        let rest = guard.plan(0, 0, &motion).map(|rest| Plan {
            // Judged by the bound that the command was judged by: for all of the time that it was
            // planned for.
            time: plan.time,
            ..rest
        });
        let fits = limits.fits(&hazard, &closing, &plan);
        prop_assert!(!fits || rest.is_some_and(|rest| limits.fits(&hazard, &closing, &rest)));
    }
}

// --------------------------------------------------------------- what is admitted

proptest! {
    #![proptest_config(common::cases(3_000))]

    //= shield.INV-1
    //= shield.INV-6
    //= shield.INV-8
    //= shield.INV-9
    //= shield.INV-12
    //= shield.INV-13
    //= shield.INV-15
    #[test]
    fn what_is_admitted_is_safe(
        config in usual_or_any_config(), whole_ring in any::<bool>(),
        hazards in UniformArrayStrategy::<_, [Hazard; 16]>::new(far_or_any_hazard().boxed()),
        motion in motion(), last in twist(), advised in advised(),
        elapsed in share(), gaining in any::<bool>(),
        ahead in proptest::option::of((0..10_000_i32, 0..=3_000_i32)),
    ) {
        let question = Question { motion, last, advised, elapsed, gaining, ahead };
        if whole_ring {
            question.ask::<16>(&config, &hazards)?;
        } else {
            question.ask::<8>(&config, &std::array::from_fn(|i| hazards[i]))?;
        }
    }
}

/// Someone 1 m ahead who comes at 800 mm/s leaves less than 200 mm/s for contact not to be possible
/// within a second, and it is said that they do.
//= shield.INV-8
#[test]
fn time_to_contact_limits_the_speed() {
    let (config, ring) = pioneer_with::<8>();
    let guard = Guard::new(&config);
    let ahead = |speed: i32| Twist {
        speed,
        turn_rate: 0,
    };
    let surroundings = Surroundings {
        hazard: &[FAR; 8],
        ring: &ring,
        motion: Motion::REST,
        ahead: Some((1000, 800)),
    };
    let admission = guard.admissible(ahead(400), ahead(400), [100; 2], &surroundings);
    assert_eq!(admission.limit, Some(Limit::ContactTime));
    let speed = admission.twist.speed;
    // In 64ths of 400 mm/s.
    assert!((190..200).contains(&speed), "{speed}");
    assert!(promise::sound(1000, speed + 800, 1000, speed == 0));
}

/// A hazard that is mostly too far away to matter.
fn far_or_any_hazard() -> impl Strategy<Value = Hazard> {
    prop_oneof![12 => Just(FAR), 1 => hazard()]
}

/// What the guard is asked.
struct Question {
    motion: (f64, bool, f64),
    last: (f64, f64),
    advised: Twist,
    elapsed: f64,
    gaining: bool,
    ahead: Option<(i32, i32)>,
}

impl Question {
    fn ask<const N: usize>(
        &self,
        config: &Config,
        hazard: &[Hazard; N],
    ) -> Result<(), TestCaseError> {
        let (config, ring) = settings::fitted::<N>(config);
        let guard = Guard::new(&config);
        let limits = guard.limits();
        let motion = motion_of(limits, self.motion);
        let last = twist_of(limits, self.last);
        let elapsed = of(self.elapsed, limits.reaction_time());
        let gaining = if self.gaining { elapsed } else { 0 };
        let surroundings = Surroundings {
            hazard,
            ring: &ring,
            motion,
            ahead: self.ahead,
        };
        let advised = self.advised;
        let admission = guard.admissible(advised, last, [gaining, elapsed], &surroundings);
        let Twist { speed, turn_rate } = admission.twist;
        prop_assert!(promise::within_limits(
            speed,
            turn_rate,
            limits.speed_max(),
            limits.reverse_speed_max(),
            limits.turn_rate_max()
        ));
        prop_assert!(promise::slew_kept(
            last.speed,
            speed,
            limits.acceleration(),
            gaining
        ));
        prop_assert!(promise::slew_kept(
            last.turn_rate,
            turn_rate,
            limits.turn_acceleration(),
            elapsed
        ));
        prop_assert!(promise::no_tighter(
            speed,
            turn_rate,
            advised.speed,
            advised.turn_rate
        ));
        prop_assert!(promise::sees_where_it_goes(speed, ring.looks_back()));
        if let Some((distance, obstacle)) = self.ahead {
            prop_assert!(promise::sound(
                distance,
                speed + obstacle,
                limits.stop_time(),
                speed <= 0
            ));
        }
        for (hazard, sonar) in hazard.iter().zip(ring.sonars()) {
            let closing = &sonar.closing;
            let room = has_room(limits, hazard, closing, &motion, admission.twist);
            prop_assert!(promise::admitted(speed, turn_rate, room));
            let (bound, left) = left_for_turn(limits, hazard, closing, &motion, admission.twist);
            prop_assert!(
                admission.twist == Twist::REST
                    || promise::turn_ends_before_contact(
                        turn_rate,
                        limits.turn_acceleration(),
                        limits.reaction_time(),
                        bound,
                        left,
                    )
            );
        }
        let reason = admission.limit.is_some();
        prop_assert!(promise::slower_has_a_reason(speed, advised.speed, reason));
        // And no reason if it is not, but for a robot that can only brake.
        let slower = speed.abs() < advised.speed.abs();
        let brakes = guard.plan(0, 0, &motion).is_none();
        prop_assert!(admission.limit != Some(Limit::Base) || slower || brakes);
        Ok(())
    }
}

// ------------------------------------------------------------- the whole shield

/// A tick of a shield: the view, the time since the one before, the advice.
fn any_tick() -> BoxedStrategy<(View<16>, u64, Advice)> {
    let elapsed = prop_oneof![6 => Just(100_u64), 2 => 0..3_000_u64];
    (view::<16>(), elapsed, advice()).boxed()
}

/// Views in which nothing is wrong but what the shield weighs: distances and speeds.
fn tick_in_order() -> BoxedStrategy<(View<16>, u64, Advice)> {
    let ticks = any_tick().prop_map(|(mut view, elapsed, advice)| {
        view.base.motors_enabled = true;
        view.base.stalled = false;
        view.base.emergency_stop = false;
        for (reading, hazard) in view.sonar.iter_mut().zip(&mut view.hazard) {
            if !matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_)) {
                *reading = SonarReading::NoEcho(Length::MAX);
            }
            hazard.range += 1_000;
            hazard.clearance = hazard.clearance.abs() + 1_000;
            hazard.age %= 200;
            hazard.way = hazard.way.map(|way| way % 100);
            hazard.turned %= 300;
            hazard.stuck = false;
            hazard.too_fast = false;
        }
        view.speed %= 0.5;
        view.turn_rate %= 1.0;
        view.odometry_age %= 200;
        if let Some(obstacle) = &mut view.obstacle {
            obstacle.speed.saturated = false;
        }
        let elapsed = elapsed.min(200);
        (view, elapsed, advice)
    });
    ticks.boxed()
}

/// Whether advice is something the shield asks its guard about.
fn sensible(advice: Advice) -> bool {
    promise::sensible(advice.speed, advice.turn_rate)
}

/// What a view shows to a robot that was last told this.
fn signs(
    config: &Config,
    ring: &Ring<16>,
    view: &View<16>,
    last: (i32, i32),
    elapsed: u64,
) -> promise::Signs {
    let thousandths = |value: f32| (value * 1000.0).ceil() as i32;
    let readable =
        |reading: &SonarReading| matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_));
    let ahead = ring.sonars().iter().zip(&view.hazard);
    let ahead = ahead.filter(|(at, _)| at.forward);
    promise::Signs {
        base: !view.base.motors_enabled || view.base.stalled || view.base.emergency_stop,
        untrusted: !view.sonar.iter().all(readable),
        ahead: [
            ahead
                .map(|(_, hazard)| hazard.range)
                .min()
                .expect("a sonar ahead"),
            thousandths(config.min_distance),
        ],
        saturated: view
            .obstacle
            .is_some_and(|obstacle| obstacle.speed.saturated),
        elapsed: [elapsed as i64, thousandths(config.reaction_time).into()],
        stuck: view.hazard.iter().any(|hazard| hazard.stuck),
        moving: last != (0, 0),
    }
}

/// A tick through the shield, judged by every predicate that a view and a verdict fall under.
fn judged_tick(
    shield: &mut Shield,
    config: &Config,
    ring: &Ring<16>,
    view: &View<16>,
    last: (i32, i32),
    elapsed: u64,
    advice: Advice,
) -> Verdict {
    let limits = *shield.limits();
    let was_latched = shield.is_latched();
    let signs = signs(config, ring, view, last, elapsed);
    let assessed = shield.assess(view, ring);
    assert!(promise::every_cause_stops(&signs, assessed.is_some()));
    let guard = Guard::new(config);
    let creep = guard.plan(1, 0, &Motion::REST).expect("the least speed");
    let mut seen = view.hazard.iter().zip(ring.sonars());
    let room = seen.all(|(hazard, at)| limits.fits(hazard, &at.closing, &creep));
    // Whatever the robot does itself.
    let contact = view.obstacle.is_some_and(|obstacle| {
        let distance = (obstacle.distance.get() * 1000.0) as i32 - obstacle.contact_range;
        let speed = (obstacle.speed.value.get() * 1000.0) as i32;
        limits.contact_within_stop_time(distance.max(0), speed)
    });
    assert!(promise::no_room_stops(room, contact, assessed.is_some()));
    let verdict = shield.admit(advice, view, ring);
    let (speed, turn_rate) = (verdict.command.speed(), verdict.command.turn_rate());
    assert!(promise::within_limits(
        speed,
        turn_rate,
        limits.speed_max(),
        limits.reverse_speed_max(),
        limits.turn_rate_max()
    ));
    let (stopped, latched) = (verdict.stop.is_some(), shield.is_latched());
    let may_turn = verdict.stop.is_some_and(StopReason::may_turn);
    assert!(promise::stop_is_kept(
        stopped, may_turn, latched, speed, turn_rate
    ));
    assert!(stopped || assessed.is_none());
    let trusted = !signs.base && !signs.untrusted && sensible(advice);
    if !trusted || was_latched {
        assert!(stopped);
        assert!(promise::untrusted_rests(speed, turn_rate));
    }
    let elapsed = elapsed.min(limits.reaction_time() as u64) as i32;
    assert!(promise::slew_kept(
        last.0,
        speed,
        limits.acceleration(),
        elapsed
    ));
    assert!(promise::slew_kept(
        last.1,
        turn_rate,
        limits.turn_acceleration(),
        elapsed
    ));
    assert!(promise::sees_where_it_goes(speed, ring.looks_back()));
    if sensible(advice) {
        assert!(promise::slower_has_a_reason(
            speed,
            (advice.speed * 1000.0) as i32,
            stopped || verdict.limit.is_some()
        ));
        assert!(promise::no_tighter(
            speed,
            turn_rate,
            (advice.speed * 1000.0) as i32,
            (advice.turn_rate * 1000.0) as i32
        ));
    }
    verdict
}

/// A shield through ticks; how often it let the robot drive.
fn through(config: &Config, ticks: Vec<(View<16>, u64, Advice)>) -> u32 {
    let (config, ring) = settings::fitted::<16>(config);
    let mut shield = Shield::new(&config);
    let (mut now, mut last, mut drives) = (10_000, (0, 0), 0);
    for (mut view, elapsed, advice) in ticks {
        now += elapsed;
        view.now = Instant(now);
        let verdict = judged_tick(&mut shield, &config, &ring, &view, last, elapsed, advice);
        last = (verdict.command.speed(), verdict.command.turn_rate());
        drives += u32::from(last.0 != 0);
        if now % 7 == 0 {
            shield.reset();
        }
    }
    drives
}

proptest! {
    #![proptest_config(common::cases(600))]

    //= shield.INV-1
    //= shield.INV-4
    //= shield.INV-5
    //= shield.INV-6
    //= shield.INV-13
    //= shield.INV-15
    //= shield.INV-16
    //= shield.INV-18
    //= shield.INV-20
    #[test]
    fn any_law_is_shielded(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec(prop_oneof![any_tick(), tick_in_order()], 1..30),
    ) {
        through(&config, ticks);
    }

    /// The same where nothing is wrong for long.
    //= shield.INV-4
    //= shield.INV-6
    //= shield.INV-13
    #[test]
    fn any_law_is_shielded_on_the_move(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec(tick_in_order(), 60),
    ) {
        through(&config, ticks);
    }
}

proptest! {
    #![proptest_config(common::cases(600))]

    /// Views with room all round: whatever else they say, a robot is stopped by a sign that demands it
    /// and by nothing else, and ticks without one free it.
    //= shield.INV-16
    //= shield.INV-17
    #[test]
    fn nothing_else_stops(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec(prop_oneof![any_tick(), tick_in_order()], 1..20),
    ) {
        let (config, ring) = settings::fitted::<16>(&config);
        let mut shield = Shield::new(&config);
        let (mut now, mut last) = (10_000, (0, 0));
        let mut free = 0;
        for (mut view, elapsed, advice) in ticks {
            now += elapsed;
            view.now = Instant(now);
            for hazard in &mut view.hazard {
                *hazard = Hazard { stuck: hazard.stuck, range: hazard.range, ..FAR };
            }
            if let Some(obstacle) = &mut view.obstacle {
                obstacle.distance = Length::MAX;
                obstacle.contact_range = 0;
                obstacle.speed.value = Speed::ZERO;
            }
            // At rest, as measured: brakes are the monitor's.
            view.speed = 0.0;
            let was_latched = shield.is_latched();
            let was_stopped = free < config.resume_samples as u32;
            let mut signs = signs(&config, &ring, &view, last, elapsed);
            if was_stopped {
                signs.ahead[1] += (config.resume_clearance * 1000.0).ceil() as i32;
            }
            free = if signs.demand_a_stop() { 0 } else { free + 1 };
            let stopped = shield.assess(&view, &ring).is_some();
            prop_assert!(promise::every_cause_stops(&signs, stopped));
            let freed = free >= config.resume_samples as u32;
            if !was_latched {
                prop_assert!(promise::nothing_else_stops(&signs, freed, stopped));
            }
            let command = shield.admit(advice, &view, &ring).command;
            last = (command.speed(), command.turn_rate());
            if !sensible(advice) {
                free = 0;
            }
        }
    }
}

/// A view of nothing at all, by a robot at rest.
fn in_the_open<const N: usize>(now: u64, config: &Config, ring: &Ring<N>) -> View<N> {
    let observation = in_order(now, [5.0; N]);
    let view = Memory::default().update(&observation, [5.0, 0.0].into(), ring, config);
    view.expect("odometry")
}

/// A view of nothing but somebody straight ahead who comes at 0.3 m/s, seen by a robot at rest; 100 mm
/// of the distance are not way.
fn approached<const N: usize>(now: u64, distance: f32, config: &Config, ring: &Ring<N>) -> View<N> {
    let mut view = in_the_open(now, config, ring);
    view.obstacle = Some(Obstacle {
        distance: Length::metres(distance).expect("a length"),
        contact_range: 100,
        direction: Angle::ZERO,
        position: [distance, 0.0].into(),
        trend: Trend::Closing,
        speed: ObstacleSpeed {
            value: Speed::metres_per_second(0.3).expect("a speed"),
            saturated: false,
        },
        visible: true,
        seen_now: true,
    });
    view
}

/// What the robot may have gained since its speed was measured counts, for no longer than the reaction
/// time, and so does the error of the measurement.
//= shield.INV-8
#[test]
fn an_old_speed_may_have_grown() {
    let (config, ring) = pioneer_with::<3>();
    let closing_at = |age: u64| {
        let mut view = approached(10_000, 0.2, &config, &ring);
        view.speed = 0.2;
        view.odometry_age = age;
        match Shield::new(&config).assess(&view, &ring) {
            Some(StopReason::ContactTime { closing, .. }) => closing,
            other => panic!("{other:?}"),
        }
    };
    // 300 of theirs, 200 of its own, 50 of error, and 300 mm/s² for so many ms.
    assert_eq!(closing_at(0), 550);
    assert_eq!(closing_at(100), 580);
    assert_eq!(closing_at(220), 616);
    assert_eq!(closing_at(400), 616);
}

/// What a shield makes of the same advice, in so many ticks from 10,000 ms on, to a robot at rest whose sonars
/// read these ranges.
fn advised_again<const N: usize>(
    ticks: u64,
    advice: Advice,
    ranges: [f32; N],
    config: &Config,
    ring: &Ring<N>,
) -> (Shield, Vec<Verdict>) {
    let mut shield = Shield::new(config);
    let mut memory = Memory::default();
    let verdicts = (0..ticks).map(|tick| {
        let observation = in_order(10_000 + 100 * tick, ranges);
        let view = memory.update(&observation, [5.0, 0.0].into(), ring, config);
        let view = view.expect("odometry");
        shield.assess(&view, ring);
        shield.admit(advice, &view, ring)
    });
    let verdicts = verdicts.collect();
    (shield, verdicts)
}

/// A shield that has let the robot set off in the open, as advised in m/s, and its last command, at 10,700 ms.
fn under_way<const N: usize>(advised: f32, config: &Config, ring: &Ring<N>) -> (Shield, Command) {
    let advice = Advice {
        speed: advised,
        turn_rate: 0.0,
    };
    let (shield, verdicts) = advised_again(8, advice, [5.0; N], config, ring);
    (shield, verdicts[7].command)
}

/// A robot under way is stopped by a tick later than the reaction time, and not by one just then.
//= shield.INV-16
//= shield.INV-17
#[test]
fn a_late_tick_stops() {
    let (config, ring) = pioneer_with::<8>();
    let stop_after = |pause: u64| {
        let (mut shield, command) = under_way(0.2, &config, &ring);
        assert!(command.speed() > 0);
        shield.assess(&in_the_open(10_700 + pause, &config, &ring), &ring)
    };
    assert_eq!(stop_after(220), None);
    let late = StopReason::LoopLate {
        elapsed: 221,
        bound: 220,
    };
    assert_eq!(stop_after(221), Some(late));
}

/// Somebody who is too fast is the robot's business where it could not drive at full speed for them.
//= shield.INV-17
#[test]
fn who_is_too_fast_stops_when_near() {
    let (config, ring) = pioneer_with::<8>();
    let stop_at = |clearance: i32| {
        let (mut shield, _) = under_way(0.1, &config, &ring);
        let mut view = in_the_open(10_800, &config, &ring);
        view.hazard[3] = Hazard {
            clearance,
            too_fast: true,
            ..FAR
        };
        shield.assess(&view, &ring)
    };
    assert_eq!(stop_at(3000), None);
    let exceeded = StopReason::ClassExceeded {
        sonar: 3,
        bound: 800,
    };
    assert_eq!(stop_at(600), Some(exceeded));
}

/// A stop for want of room tells how much is needed: to the millimetre, rounded up, what the law book
/// has for a creep.
//= shield.INV-3
#[test]
fn want_of_room_is_told() {
    let (config, ring) = pioneer_with::<8>();
    let stop_at = |clearance: i32| {
        let mut view = in_the_open(10_000, &config, &ring);
        view.hazard[3] = Hazard { clearance, ..FAR };
        Shield::new(&config).assess(&view, &ring)
    };
    let told = stop_at(254);
    assert!(
        matches!(
            told,
            Some(StopReason::Clearance {
                sonar: 3,
                clearance: 254,
                required: 255,
                class: Class::Unknown,
                ..
            })
        ),
        "{told:?}"
    );
    assert_eq!(stop_at(255), Some(StopReason::Starting));
}

/// A robot that drives back, or is told to, comes no nearer to what is ahead; one that is told to drive
/// forward does, although its wheels do not show it yet.
//= shield.INV-8
#[test]
fn only_driving_ahead_takes_time_to_contact() {
    let (config, ring) = pioneer_with::<16>();
    let closing_at = |advised: f32, measured: f32| {
        let (mut shield, command) = under_way(advised, &config, &ring);
        let mut view = approached(10_800, 0.2, &config, &ring);
        view.speed = measured;
        match shield.assess(&view, &ring) {
            Some(StopReason::ContactTime { closing, .. }) => (command.speed(), closing),
            other => panic!("{other:?}"),
        }
    };
    let (told, closing) = closing_at(-0.1, 0.0);
    assert!(told < 0 && closing == 300, "{told}, {closing}");
    let (told, closing) = closing_at(0.4, -0.1);
    assert!(told > 0 && closing == 300, "{told}, {closing}");
    let (told, closing) = closing_at(0.4, 0.0);
    assert!(told > 50 && closing == 300 + told, "{told}, {closing}");
    let (told, closing) = closing_at(-0.1, 0.2);
    assert!(told < 0 && closing == 550, "{told}, {closing}");
}

/// What was asked for and not admitted is put down to the sonar that refuses the next more; what was
/// not asked for is put down to nothing.
//= shield.INV-9
#[test]
fn what_limits_is_named() {
    let (config, ring) = pioneer_with::<8>();
    let guard = Guard::new(&config);
    let ask = |sonar: usize, clearance: i32, speed: i32, turn_rate: i32| {
        let mut hazard = [FAR; 8];
        hazard[sonar].clearance = clearance;
        let surroundings = Surroundings {
            hazard: &hazard,
            ring: &ring,
            motion: Motion::REST,
            ahead: None,
        };
        let twist = Twist { speed, turn_rate };
        guard
            .admissible(twist, twist, [100; 2], &surroundings)
            .limit
    };
    assert_eq!(ask(3, 300, 400, 0), Some(Limit::Clearance { sonar: 3 }));
    assert_eq!(ask(5, 300, 0, 1500), Some(Limit::Clearance { sonar: 5 }));
    assert_eq!(ask(3, -100, 400, 0), Some(Limit::Clearance { sonar: 3 }));
    assert_eq!(ask(3, -100, 0, 0), None);
    assert_eq!(ask(3, 20_000, 400, 1500), None);
    // A robot that is faster than any plan knows is held by what the base can do.
    let surroundings = Surroundings {
        hazard: &[FAR; 8],
        ring: &ring,
        motion: Motion {
            speed: 12_000,
            ..Motion::REST
        },
        ahead: None,
    };
    let twist = Twist {
        speed: 100,
        turn_rate: 0,
    };
    let admission = guard.admissible(twist, twist, [100; 2], &surroundings);
    assert_eq!(admission.limit, Some(Limit::Base));
}

/// A turn on the spot does not bring the robot nearer to anybody.
//= shield.INV-8
#[test]
fn a_turn_on_the_spot_takes_no_time_to_contact() {
    let (config, ring) = pioneer_with::<8>();
    let surroundings = Surroundings {
        hazard: &[FAR; 8],
        ring: &ring,
        motion: Motion::REST,
        ahead: Some((100, 800)),
    };
    let turn = Twist {
        speed: 0,
        turn_rate: 1000,
    };
    let admission = Guard::new(&config).admissible(turn, turn, [100; 2], &surroundings);
    assert_eq!((admission.twist, admission.limit), (turn, None));
}

/// A turn that ends with the driving, or before, is judged by the class; one that outlasts it by a
/// thousandth is not.
//= shield.INV-12
#[test]
fn only_a_turn_that_outlasts_the_driving_is_judged_apart() {
    let (config, _) = pioneer_with::<8>();
    let limits = Limits::new(&config);
    let still = |clearance| Hazard {
        clearance,
        class: Class::Still,
        ..FAR
    };
    let plan = |driving: i32, turn_rate| Plan {
        way: [0; 2],
        time: limits.reaction_time() + driving,
        turn: 0,
        turn_rate,
    };
    // What is needed at 500 mm/s until the robot is at rest leaves just enough for the turn to end.
    let alpha = limits.turn_acceleration();
    assert_eq!((alpha, limits.reaction_time()), (3141, 220));
    assert!(limits.fits(&still(610), &AHEAD, &plan(1000, alpha)));
    assert!(!limits.fits(&still(609), &AHEAD, &plan(1000, alpha)));
    assert!(!limits.fits(&still(610), &AHEAD, &plan(1000, alpha + 1)));
    // Somebody may come at 800 mm/s all through that turn.
    assert!(limits.fits(&still(977), &AHEAD, &plan(1000, alpha + 1)));
    assert!(!limits.fits(&still(976), &AHEAD, &plan(1000, alpha + 1)));
}

/// A tick without a view counts as a tick: what comes after it has no more time to gain speed in. One
/// that is older than the last does not.
//= shield.INV-6
#[test]
fn a_refused_tick_gives_no_time_to_gain_speed() {
    let (config, ring) = pioneer_with::<8>();
    for (refused, next, most) in [(10_100, 10_120, 6), (9_900, 10_020, 6)] {
        let mut shield = Shield::new(&config);
        let mut memory = Memory::default();
        let mut view_at = |now| {
            let observation = in_order(now, [5.0; 8]);
            let view = memory.update(&observation, [5.0, 0.0].into(), &ring, &config);
            view.expect("odometry")
        };
        let advice = Advice {
            speed: 0.4,
            turn_rate: 0.0,
        };
        shield.admit(advice, &view_at(10_000), &ring);
        shield.refuse(StopReason::OdometryStale, Instant(refused));
        let view = view_at(next);
        for _ in 0..3 {
            shield.assess(&view, &ring);
        }
        let speed = shield.admit(advice, &view, &ring).command.speed();
        assert_eq!(speed, most);
    }
}

/// A stop for want of time ends when there is the resume clearance on top of what it demands, for
/// as many ticks in a row as it takes.
//= shield.INV-8
#[test]
fn time_to_contact_has_hysteresis() {
    let (config, ring) = pioneer_with::<3>();
    let mut shield = Shield::new(&config);
    let mut now = 10_000;
    let mut stop_at = |distance: f32| {
        now += 100;
        let view = approached(now, distance, &config, &ring);
        shield.assess(&view, &ring)
    };
    assert_eq!(config.resume_clearance, 0.05);
    for _ in 0..2 {
        assert_eq!(stop_at(1.0), Some(StopReason::Starting));
    }
    assert_eq!(stop_at(1.0), None);
    // In a second 300 mm may close, and there are 100 mm that are not way.
    assert_eq!(stop_at(0.402), None);
    let too_near = stop_at(0.4);
    assert!(matches!(too_near, Some(StopReason::ContactTime { .. })));
    for _ in 0..5 {
        assert!(stop_at(0.449).is_some(), "not 50 mm more than demanded");
    }
    assert!(stop_at(0.452).is_some());
    assert!(stop_at(0.452).is_some());
    assert_eq!(stop_at(0.452), None);
}

/// A robot that looks back backs off from something still that is too near ahead, and one that does
/// not stays.
//= shield.INV-4
//= shield.INV-15
#[test]
fn backs_off_where_it_looks() {
    fn fastest_back<const N: usize>() -> i32 {
        let (config, ring) = pioneer_with::<N>();
        let advice = Advice {
            speed: -1.0,
            turn_rate: 0.0,
        };
        let mut ranges = [5.0; N];
        ranges[3] = 0.4;
        let (_, verdicts) = advised_again(30, advice, ranges, &config, &ring);
        let back = verdicts.iter().map(|verdict| {
            assert!(matches!(
                verdict.stop,
                Some(StopReason::MinDistance { sonar: 3, .. })
            ));
            verdict.command.speed()
        });
        back.min().expect("thirty ticks")
    }
    let most = (pioneer().reverse_speed_max * 1000.0) as i32;
    assert_eq!(fastest_back::<16>(), -most);
    assert_eq!(fastest_back::<8>(), 0);
}

/// A robot that is stopped for something ahead turns on the spot if that is what the law advises, and
/// does nothing if it would drive on.
//= shield.INV-4
#[test]
fn a_stopped_robot_turns_on_the_spot() {
    let (config, ring) = pioneer_with::<8>();
    let turned =
        |speed: f32| {
            let mut ranges = [5.0; 8];
            ranges[3] = 0.42;
            let advice = Advice {
                speed,
                turn_rate: 1.0,
            };
            let (_, verdicts) = advised_again(5, advice, ranges, &config, &ring);
            assert!(verdicts.iter().all(|verdict| matches!(
                verdict.stop,
                Some(StopReason::MinDistance { sonar: 3, .. })
            )));
            let command = verdicts[4].command;
            (command.speed(), command.turn_rate())
        };
    let (speed, turn_rate) = turned(0.0);
    assert!(speed == 0 && turn_rate > 0, "{turn_rate}");
    assert_eq!(turned(0.2), (0, 0));
}

/// With room all round a robot does what it is advised, either way, after it has come up to it.
#[test]
fn a_free_robot_does_as_advised() {
    let (config, ring) = pioneer_with::<16>();
    for (speed, turn_rate) in [(0.2, 0.5), (0.2, -0.5), (0.0, 0.5), (0.3, 0.0)] {
        let (mut shield, mut memory) = (Shield::new(&config), Memory::default());
        let mut told = (0, 0);
        for tick in 0..30 {
            let observation = in_order(10_000 + 100 * tick, [5.0; 16]);
            let view = memory.update(&observation, [5.0, 0.0].into(), &ring, &config);
            let view = view.expect("odometry");
            shield.assess(&view, &ring);
            let verdict = shield.admit(Advice { speed, turn_rate }, &view, &ring);
            told = (verdict.command.speed(), verdict.command.turn_rate());
        }
        let advised = ((speed * 1000.0) as i32, (turn_rate * 1000.0) as i32);
        assert_eq!(told, advised);
    }
}

/// Only what is a matter of distance lets the robot turn on the spot.
//= shield.INV-5
#[test]
fn no_turn_where_sensors_or_base_are_at_fault() {
    for reason in StopReason::EACH {
        let distance = matches!(
            reason,
            StopReason::MinDistance { .. }
                | StopReason::ContactTime { .. }
                | StopReason::ObstacleTooFast
                | StopReason::Clearance { .. }
        );
        assert_eq!(reason.may_turn(), distance, "{reason}");
    }
}

// ------------------------------------------------------------------------- rings

fn at(x: f32, y: f32, heading: f32) -> Placement {
    Placement { x, y, heading }
}

/// Rings that cannot see ahead, and placements off the robot, are refused by name; a gap with its
/// width and what is allowed.
#[test]
fn blind_rings_are_refused() {
    let config = pioneer();
    let refused = |placements: &[Placement; 2]| Ring::new(placements, &config).expect_err("blind");
    let ahead = at(0.1, 0.0, 0.0);
    assert_eq!(refused(&[ahead, at(2.1, 0.0, 0.0)]).field, "sonar x");
    assert_eq!(refused(&[ahead, at(0.0, f32::NAN, 0.0)]).field, "sonar y");
    assert_eq!(refused(&[ahead, at(0.0, 0.0, 10.0)]).field, "angle");
    // Cones of ±15° at 0° and 45°: 75° of the right side are unseen.
    let gap = refused(&[ahead, at(0.1, 0.1, core::f32::consts::FRAC_PI_4)]);
    assert_eq!(gap.field, "gap between sonars ahead");
    assert!((gap.value.to_degrees() - 75.0).abs() < 0.1, "{gap}");
    assert_eq!(gap.max, config.blind_angle_max);
    let said = gap.to_string();
    assert!(
        said.contains(&gap.value.to_string()) && said.contains(&gap.max.to_string()),
        "{said}"
    );
    // No sonar looks ahead at all.
    let gap = refused(&[at(-0.1, 0.0, 3.0), at(-0.1, 0.0, -3.0)]);
    assert!(gap.value > 3.0, "{gap}");
}

/// The Pioneer's ring of sixteen looks back, its front array does not.
//= shield.INV-15
#[test]
fn the_whole_ring_looks_back() {
    let config = pioneer();
    let whole = Ring::new(&settings::placements::<16>(), &config).expect("the preset's ring");
    assert!(whole.looks_back());
    let front = Ring::new(&settings::placements::<8>(), &config).expect("the preset's front array");
    assert!(!front.looks_back());
    // Two sonars less at the rear leave 30° unseen.
    let mut gap = settings::placements::<16>();
    gap[12] = gap[11];
    gap[13] = gap[11];
    let gap = Ring::new(&gap, &config).expect("the front is as it was");
    assert!(!gap.looks_back());
}

/// A base that brakes at 0.3 m/s² needs so much room that the shield would stop it before the law
/// avoids anything: refused, with both distances.
#[test]
fn a_shield_that_forestalls_the_law_is_refused() {
    let config = Config::new(Parameters {
        braking: 0.3,
        braking_share: 1.0,
        ..preset::PIONEER_3DX
    })
    .expect("good in itself");
    let refused = Ring::new(&settings::placements::<16>(), &config).expect_err("no room to avoid");
    assert_eq!(refused.field, "safe_distance");
    assert_eq!(refused.value, config.safe_distance);
    // What it takes at cruise speed straight ahead, and the contact range of a sonar there.
    let (_, ring) = pioneer_with::<16>();
    let cruise = Limits::new(&config).required_clearance(200);
    let contact = ring.sonars()[3].contact_range;
    assert!(
        // And the error of the range.
        (refused.min * 1000.0 - (cruise + contact + 20) as f32).abs() < 10.0,
        "{refused}"
    );
    assert!(refused.min > refused.value);
    let said = refused.to_string();
    assert!(
        said.contains(&refused.value.to_string()) && said.contains(&refused.min.to_string()),
        "{said}"
    );
}

/// Whether a direction (rad) of the half circle about `about` is in no cone.
fn is_unseen(placements: &[Placement], direction: f64, half_angle: f64) -> bool {
    placements.iter().all(|placement| {
        let off = sidestep_spec::avoid::wrap(direction - f64::from(placement.heading));
        off.abs() > half_angle
    })
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// The gap that a ring is refused for is as wide as the widest run of directions ahead in which
    /// no sonar looks, sampled each thousandth of a radian; and no such run behind is wider than
    /// allowed in a ring that looks back.
    //= shield.INV-15
    #[test]
    fn gaps_are_measured(
        config in config(), headings in proptest::array::uniform6(-3.1_f32..3.1),
        allowed in 0.0_f32..3.15,
    ) {
        let mut p = *config.parameters();
        // So that nothing but a gap is refused.
        p.obstacle_speed_max = 0.0;
        p.still_speed_max = 0.0;
        p.still_speed_max_turning = 0.0;
        p.reaction_time = 0.02;
        p.acceleration = 0.05;
        p.braking = 10.0;
        p.braking_share = 1.0;
        p.robot_radius = 0.05;
        p.range_error = 0.0;
        p.safe_distance = p.sonar_range_max.min(10.0);
        p.blind_angle_max = allowed;
        let config = Config::new(p).expect("still in range");
        let placements = headings.map(|heading| at(0.0, 0.0, heading));
        let half = f64::from(config.sonar_half_angle);
        let widest = |about: f64| {
            let (mut widest, mut run) = (0, 0);
            for step in -1570..=1570 {
                let unseen = is_unseen(&placements, about + f64::from(step) / 1000.0, half);
                run = if unseen { run + 1 } else { 0 };
                widest = widest.max(run);
            }
            f64::from(widest) / 1000.0
        };
        let (ahead, behind) = (widest(0.0), widest(std::f64::consts::PI));
        let allowed = f64::from(allowed);
        match Ring::new(&placements, &config) {
            Ok(ring) => {
                prop_assert!(ahead <= allowed + 3e-3);
                prop_assert!(!ring.looks_back() || behind <= allowed + 3e-3);
                prop_assert!(ring.looks_back() || behind >= allowed - 3e-3);
            }
            // Good as to its gaps: refused for other reasons.
            Err(refused) if refused.field == "safe_distance" => {
                prop_assert!(ahead <= allowed + 3e-3);
            }
            Err(refused) => {
                prop_assert_eq!(refused.field, "gap between sonars ahead");
                // π stands for "nothing is seen there".
                prop_assert!(
                    (f64::from(refused.value) - ahead).abs() <= 3e-3 || ahead > 3.1,
                    "{} is {}", refused, ahead
                );
            }
        }
    }
}
