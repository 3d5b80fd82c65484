//! Chapter `shield`: the guard, for every configuration that can be constructed.
//!
//! Proofs settle these for the Pioneer preset, and some for all values (`proofs/shield.rs`); here
//! every parameter varies.

mod common;

use common::{advice, between, config, in_order, pioneer, settings, usual_or_any_config, view};
use proptest::prelude::*;
use sidestep::avoid::{ObstacleSpeed, Trend};
use sidestep::config::Config;
use sidestep::law::Advice;
use sidestep::observation::SonarReading;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::shield::{Limits, Room, Shield, StopReason, Verdict, greatest};
use sidestep::track::Obstacle;
use sidestep::view::{Memory, View};
use sidestep_spec::shield as promise;

/// A share of a whole, its ends more often than by chance.
fn share() -> impl Strategy<Value = f64> {
    between(0.0, 1.0).prop_map(f64::from)
}

/// The integer at a share of `0..=most`.
fn of(share: f64, most: i32) -> i32 {
    (share * f64::from(most)).round() as i32
}

/// The model of these limits.
fn model(limits: &Limits) -> promise::Model {
    promise::Model {
        acceleration: f64::from(limits.acceleration()),
        braking: f64::from(limits.braking()),
        reaction_time: f64::from(limits.reaction_time()),
        obstacle_speed: f64::from(limits.obstacle_speed()),
    }
}

fn safe(limits: &Limits, speed: i32, clearance: i32) -> bool {
    promise::safe_state(speed, clearance, limits.braking(), limits.obstacle_speed())
}

// ---------------------------------------------------------------- the formulas

proptest! {
    #![proptest_config(common::cases(4_000))]

    /// Limits are the configuration in integers, rounded to the safe side. The f32 product that
    /// converts them is itself rounded, by one part in ten million.
    //= shield.INV-2
    #[test]
    fn limits_are_rounded_to_the_safe_side(config in config()) {
        let limits = Limits::new(&config);
        let at_most = |limit: i32, parameter: f32| {
            let exact = 1000.0 * f64::from(parameter);
            let limit = f64::from(limit);
            limit <= exact * (1.0 + 1e-7) && limit > exact * (1.0 - 1e-7) - 1.0
        };
        let at_least = |limit: i32, parameter: f32| {
            let exact = 1000.0 * f64::from(parameter);
            let limit = f64::from(limit);
            limit >= exact * (1.0 - 1e-7) && limit < exact * (1.0 + 1e-7) + 1.0
        };
        prop_assert!(at_most(limits.speed_max(), config.speed_max));
        prop_assert!(at_most(limits.turn_rate_max(), config.turn_rate_max));
        prop_assert!(at_most(limits.braking(), config.braking));
        prop_assert!(at_most(limits.turn_acceleration(), config.turn_acceleration));
        prop_assert!(at_least(limits.acceleration(), config.acceleration));
        prop_assert!(at_least(limits.reaction_time(), config.reaction_time));
        prop_assert!(at_least(limits.obstacle_speed(), config.obstacle_speed_max));
        prop_assert!(at_least(limits.stop_time(), config.stop_time));
    }

    //= shield.INV-2
    #[test]
    fn guard_asks_enough(config in usual_or_any_config(), share in share()) {
        let limits = Limits::new(&config);
        let speed = of(share, limits.speed_max());
        prop_assert!(promise::asks_enough(
            limits.required_clearance(speed),
            speed,
            limits.acceleration(),
            limits.braking(),
            limits.reaction_time(),
            limits.obstacle_speed(),
        ));
    }

    /// The integers ask for what the published formula gives, with the robot at its greatest speed
    /// all through the reaction time, and for no more than their rounding explains: at most a
    /// millimetre for each of the three terms, and what follows from a gain of up to 1 mm/s more.
    //= shield.INV-2
    #[test]
    fn guard_asks_no_more_than_enough(config in usual_or_any_config(), share in share()) {
        let limits = Limits::new(&config);
        let model = model(&limits);
        let speed = of(share, limits.speed_max());
        let asked = f64::from(limits.required_clearance(speed));
        let seconds = model.reaction_time / 1000.0;
        let gain = model.acceleration * seconds;
        let exact = model.required_clearance(f64::from(speed)) + gain * seconds / 2.0;
        let by_then = f64::from(speed) + gain;
        let one_more = model.stopping_distance(by_then + 1.0) - model.stopping_distance(by_then)
            + seconds;
        prop_assert!(asked >= exact - 1e-6 * (1.0 + exact), "{asked} for {exact}");
        prop_assert!(asked <= exact + 3.0 + one_more, "{asked} for {exact}");

        let stopping = f64::from(limits.stopping_distance(speed));
        let exact = model.stopping_distance(f64::from(speed));
        prop_assert!(stopping >= exact - 1e-9 * (1.0 + exact) && stopping <= exact + 2.0);

        let way = f64::from(limits.way_to_rest(speed));
        let v = f64::from(speed);
        let exact = v * seconds + v * v / (2.0 * model.braking);
        prop_assert!(way >= exact - 1e-9 * (1.0 + exact) && way <= exact + 2.0);
    }

    /// The guard asks for no less at a greater speed.
    //= shield.INV-2
    //= shield.INV-10
    #[test]
    fn guard_is_monotone(config in usual_or_any_config(), shares in [share(), share()]) {
        let limits = Limits::new(&config);
        let speeds = shares.map(|share| of(share, limits.speed_max()));
        let (slow, fast) = (speeds[0].min(speeds[1]), speeds[0].max(speeds[1]));
        prop_assert!(limits.required_clearance(slow) <= limits.required_clearance(fast));
        prop_assert!(limits.stopping_distance(slow) <= limits.stopping_distance(fast));
        // So the search finds the greatest speed there is, whatever the clearance.
        let clearance = limits.required_clearance(slow);
        let found = greatest(fast, |speed| limits.required_clearance(speed) <= clearance);
        let threshold = (slow..=fast)
            .take_while(|&speed| limits.required_clearance(speed) <= clearance)
            .last()
            .expect("slow itself");
        prop_assert!(promise::greatest(found, fast, threshold));
    }

    //= shield.INV-10
    #[test]
    fn search_finds_the_greatest(wish in 0..=4095_i32, threshold in 0..=4095_i32) {
        let found = greatest(wish, |speed| speed <= threshold);
        prop_assert!(promise::greatest(found, wish, threshold));
    }

    /// The inductive step: from any state that has the clearance that a speed needs, whatever
    /// robot and obstacle do within the model for one reaction time, the state is safe.
    //= shield.INV-3
    #[test]
    fn admitted_motion_stays_safe(
        config in usual_or_any_config(),
        speed in share(), spare in prop_oneof![Just(0), 0..3_000],
        after in share(), robot in share(), obstacle in share(), time in share(),
    ) {
        let limits = Limits::new(&config);
        let gain = limits.speed_gain();
        // The speed that a command was judged at: see `speed_is_admitted`.
        let judged_at = of(speed, limits.speed_max() + gain);
        let clearance = limits.required_clearance(judged_at) + spare;
        // Any time up to the reaction time, any way up to the greatest that time allows.
        let time = of(time, limits.reaction_time());
        let robot = of(robot, (judged_at + gain) * time / 1000);
        let obstacle = of(obstacle, limits.obstacle_speed() * time / 1000);
        let after = of(after, judged_at + gain);
        let left = clearance - robot - obstacle;
        prop_assert!(promise::stays_safe(true, safe(&limits, after, left)));
    }

    /// Braking keeps a safe state safe. Down to millimetres: what the robot travels while it
    /// loses speed is a fraction of them, and the state is judged exactly.
    //= shield.INV-3
    #[test]
    fn braking_stays_safe(
        config in usual_or_any_config(),
        speed in share(), after in share(), robot in share(), obstacle in share(),
        spare in prop_oneof![Just(0), 0..3_000],
    ) {
        let limits = Limits::new(&config);
        let (b, o) = (limits.braking(), limits.obstacle_speed());
        let speed = of(speed, limits.speed_max() + limits.speed_gain());
        // The least clearance at which this is a safe state, and some more.
        let least = (i64::from(speed).pow(2) + 2 * i64::from(o) * i64::from(speed) + 2 * i64::from(b) - 1)
            / (2 * i64::from(b));
        let clearance = i32::try_from(least).expect("two kilometres at most") + spare;
        let before = safe(&limits, speed, clearance);
        prop_assert!(before);
        let after = of(after, speed);
        let robot = of(robot, (speed * speed - after * after) / (2 * b));
        let obstacle = of(obstacle, o * (speed - after) / b);
        let left = clearance - robot - obstacle;
        prop_assert!(promise::stays_safe(before, safe(&limits, after, left)));
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

    //= shield.INV-1
    //= shield.INV-6
    //= shield.INV-9
    //= shield.INV-11
    #[test]
    fn speed_is_admitted(
        config in usual_or_any_config(),
        last in share(), elapsed in share(), advised in prop_oneof![0..2_500_i32, any::<i32>()],
        speed_bound in prop_oneof![0..3_000_i32, 0..=11_000_i32],
        clearance in prop_oneof![0..3_000_i32, any::<i32>()],
        ahead in proptest::option::of((0..10_000_i32, 0..=3_000_i32)),
    ) {
        let limits = Limits::new(&config);
        let last = of(last, limits.speed_max());
        let elapsed = of(elapsed, limits.reaction_time());
        let room = Room { clearance, sonar: 0, ahead };
        let admission = limits.admissible_speed(last, advised, elapsed, speed_bound, room);
        let speed = admission.speed;
        prop_assert!(promise::within_limits(speed, 0, limits.speed_max(), 0));
        prop_assert!(promise::slew_kept(last, speed, limits.acceleration(), elapsed));
        prop_assert!(promise::admitted(speed, admission.required, clearance));
        prop_assert!(promise::admitted(speed, limits.required_clearance(speed), clearance));
        prop_assert!(promise::judged_at_what_it_may_be(
            speed, admission.judged_at, speed_bound, limits.speed_gain()
        ));
        let required = limits.required_clearance(admission.judged_at);
        prop_assert!(promise::admitted(speed, required, clearance));
        if let Some((distance, obstacle)) = ahead {
            prop_assert!(promise::sound(
                distance, speed + obstacle, limits.stop_time(), speed == 0
            ));
        }
        // Slower than advised, or for a reason.
        prop_assert!(speed >= advised || admission.limit.is_some());
        prop_assert!(speed < advised || admission.limit.is_none());
    }

    //= shield.INV-1
    //= shield.INV-6
    //= shield.INV-12
    #[test]
    fn turn_rate_is_limited(
        config in usual_or_any_config(),
        last in -1.0_f64..=1.0, elapsed in share(),
        advised in prop_oneof![-5_000..5_000_i32, any::<i32>()],
        clearance in prop_oneof![-100..3_000_i32, any::<i32>()],
    ) {
        let limits = Limits::new(&config);
        let last = of(last, limits.turn_rate_max());
        let elapsed = of(elapsed, limits.reaction_time());
        let rate = limits.admissible_turn_rate(last, advised, elapsed, clearance);
        prop_assert!(promise::within_limits(0, rate, 0, limits.turn_rate_max()));
        prop_assert!(promise::turn_slew_kept(last, rate, limits.turn_acceleration(), elapsed));
        prop_assert!(promise::turn_ends_before_contact(
            rate,
            limits.turn_acceleration(),
            limits.reaction_time(),
            limits.obstacle_speed(),
            clearance
        ));
    }
}

// ------------------------------------------------------------------ the promise

/// What a base that is told to move makes of the time until the next command.
#[derive(Clone, Copy, Debug)]
enum Base {
    /// It is as fast as it may be: it gathers speed beyond the command, or keeps what it has.
    Hasty,
    /// It goes to the commanded speed.
    Obedient,
}

/// A robot and what comes towards it, in mm and mm/s.
struct Encounter {
    limits: Limits,
    gap: f64,
    speed: f64,
    /// The robot moved when the gap closed.
    touched: bool,
}

impl Encounter {
    /// A millisecond of the obstacle coming as fast as it may. The robot goes to `target`.
    fn millisecond(&mut self, target: f64) {
        const STEP: f64 = 0.001;
        let (a, b) = (
            f64::from(self.limits.acceleration()),
            f64::from(self.limits.braking()),
        );
        let next = if self.speed > target {
            (self.speed - b * STEP).max(target)
        } else {
            (self.speed + a * STEP).min(target)
        };
        // The way at a speed that changes evenly; braking to rest may end within the step.
        let way = if next == 0.0 {
            self.speed * self.speed / (2.0 * b)
        } else {
            (self.speed + next) / 2.0 * STEP
        };
        self.speed = next;
        self.gap -= way + f64::from(self.limits.obstacle_speed()) * STEP;
        // A step in which the robot comes to rest may close the gap after that.
        self.touched |= self.gap < -1e-6 && self.speed > 0.0;
    }
}

/// One tick of an encounter: for how long, what the law advises, how the base takes it.
fn tick() -> impl Strategy<Value = (f64, i32, Base)> {
    let base = prop_oneof![Just(Base::Hasty), Just(Base::Obedient)];
    let advised = prop_oneof![Just(i32::MAX), 0..2_500_i32];
    (share(), advised, base)
}

proptest! {
    #![proptest_config(common::cases(500))]

    /// The theorem, driven: something comes at its greatest speed, the law advises anything, ticks
    /// come at any times up to ε apart, and the base makes the worst of every command that lets it
    /// move. The robot is at rest before the gap closes.
    //= shield.INV-3
    #[test]
    fn at_rest_before_contact(
        config in usual_or_any_config(),
        gap in 0.0_f64..8_000.0,
        ticks in proptest::collection::vec(tick(), 1..60),
    ) {
        let limits = Limits::new(&config);
        let mut encounter = Encounter { limits, gap, speed: 0.0, touched: false };
        let (mut last, mut elapsed) = (0, 0);
        for (time, advised, base) in ticks {
            if encounter.gap <= 0.0 {
                break;
            }
            let room = Room { clearance: encounter.gap.floor() as i32, sonar: 0, ahead: None };
            let bound = (encounter.speed.ceil() as i32).max(last);
            last = limits.admissible_speed(last, advised, elapsed, bound, room).speed;
            let command = f64::from(last);
            let target = match base {
                Base::Hasty if last > 0 => {
                    encounter.speed.max(command + f64::from(limits.speed_gain()))
                }
                _ => command,
            };
            elapsed = of(time, limits.reaction_time() - 1) + 1;
            for _ in 0..elapsed {
                encounter.millisecond(target);
            }
            prop_assert!(!encounter.touched, "at {} mm/s", encounter.speed);
        }
    }
}

// ------------------------------------------------------------- the whole shield

/// A tick of a shield: the view, the time since the one before, the advice.
fn any_tick() -> impl Strategy<Value = (View<3>, u64, Advice)> {
    let elapsed = prop_oneof![6 => Just(100_u64), 2 => 0..3_000_u64];
    (view::<3>(), elapsed, advice())
}

/// Views in which nothing is wrong but what the shield weighs: distances and speeds.
fn tick_in_order() -> impl Strategy<Value = (View<3>, u64, Advice)> {
    any_tick().prop_map(|(mut view, elapsed, advice)| {
        view.base.motors_enabled = true;
        view.base.stalled = false;
        view.base.emergency_stop = false;
        for (reading, range) in view.sonar.iter_mut().zip(&mut view.range) {
            if !matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_)) {
                *reading = SonarReading::NoEcho(Length::MAX);
            }
            *range += 1_000;
        }
        for clearance in &mut view.clearance {
            *clearance = clearance.abs() + 1_000;
        }
        view.speed %= 0.5;
        if let Some(obstacle) = &mut view.obstacle {
            obstacle.speed.saturated = false;
        }
        (view, elapsed, advice)
    })
}

/// The robot is no faster than this: what was measured, and gained since, or what it was told.
fn speed_bound(limits: &Limits, view: &View<3>, last: i32) -> i32 {
    let age = view.odometry_age.min(limits.reaction_time() as u64) as i32;
    let gained = (limits.acceleration() * age + 999) / 1000;
    ((view.speed.abs() * 1000.0).ceil() as i32 + gained.min(1_000)).max(last)
}

/// A tick through the shield, judged by every predicate that a view and a verdict fall under.
fn judged_tick(
    shield: &mut Shield,
    config: &Config,
    view: &View<3>,
    last: (i32, i32),
    elapsed: u64,
    advice: Advice,
) -> Verdict {
    let ring = settings::ring::<3>(config);
    let limits = *shield.limits();
    let speed_bound = speed_bound(&limits, view, last.0);
    shield.assess(view, &ring);
    let verdict = shield.admit(advice, view);
    let (speed, turn_rate) = (verdict.command.speed(), verdict.command.turn_rate());
    assert!(promise::within_limits(
        speed,
        turn_rate,
        limits.speed_max(),
        limits.turn_rate_max()
    ));
    assert!(promise::stop_has_no_speed(verdict.stop.is_some(), speed));
    let trusted = view
        .sonar
        .iter()
        .all(|reading| matches!(reading, SonarReading::Echo(_) | SonarReading::NoEcho(_)))
        && view.base.motors_enabled
        && !view.base.stalled
        && !view.base.emergency_stop
        && advice.speed.is_finite()
        && advice.turn_rate.is_finite();
    if !trusted {
        assert!(verdict.stop.is_some());
        assert!(promise::untrusted_rests(speed, turn_rate));
    }
    let elapsed = elapsed.min(limits.reaction_time() as u64) as i32;
    assert!(promise::slew_kept(
        last.0,
        speed,
        limits.acceleration(),
        elapsed
    ));
    assert!(promise::turn_slew_kept(
        last.1,
        turn_rate,
        limits.turn_acceleration(),
        elapsed
    ));
    let judged_at = speed.max(speed_bound - limits.speed_gain());
    let required = limits.required_clearance(judged_at);
    let fastest = match speed {
        0 => speed_bound,
        _ => speed_bound.max(speed + limits.speed_gain()),
    };
    for &clearance in &view.clearance {
        assert!(promise::admitted(speed, required, clearance));
        assert!(promise::turn_ends_before_contact(
            turn_rate,
            limits.turn_acceleration(),
            limits.reaction_time(),
            limits.obstacle_speed(),
            clearance.saturating_sub(limits.way_to_rest(fastest))
        ));
    }
    verdict
}

proptest! {
    #![proptest_config(common::cases(1_000))]

    //= shield.INV-1
    //= shield.INV-4
    //= shield.INV-5
    //= shield.INV-6
    //= shield.INV-9
    //= shield.INV-12
    #[test]
    fn any_law_is_shielded(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec(prop_oneof![any_tick(), tick_in_order()], 1..30),
    ) {
        let mut shield = Shield::new(&config);
        let (mut now, mut last) = (10_000, (0, 0));
        for (mut view, elapsed, advice) in ticks {
            now += elapsed;
            view.now = Instant(now);
            let verdict = judged_tick(&mut shield, &config, &view, last, elapsed, advice);
            last = (verdict.command.speed(), verdict.command.turn_rate());
        }
    }

    /// The same where nothing is wrong for long: here it moves.
    //= shield.INV-4
    //= shield.INV-6
    //= shield.INV-9
    #[test]
    fn any_law_is_shielded_on_the_move(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec(tick_in_order(), 60),
    ) {
        let mut shield = Shield::new(&config);
        let (mut now, mut last) = (10_000, (0, 0));
        for (mut view, elapsed, advice) in ticks {
            now += elapsed;
            view.now = Instant(now);
            let verdict = judged_tick(&mut shield, &config, &view, last, elapsed, advice);
            last = (verdict.command.speed(), verdict.command.turn_rate());
        }
    }
}

/// A stop for want of time ends when there is the resume clearance on top of what it demands, for
/// as many ticks in a row as it takes.
//= shield.INV-8
#[test]
fn time_to_contact_has_hysteresis() {
    let config = pioneer();
    let ring = settings::ring::<3>(&config);
    let mut shield = Shield::new(&config);
    let mut now = 10_000;
    let mut stop_at = |distance: f32| {
        now += 100;
        let observation = in_order(now, [5.0; 3]);
        let view = Memory::default().update(&observation, [5.0, 0.0].into(), &ring, &config);
        let mut view = view.expect("odometry");
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

/// Only what is a matter of distance lets the robot turn on the spot.
//= shield.INV-5
#[test]
fn no_turn_where_sensors_or_base_are_at_fault() {
    let sonar = 0;
    for reason in [
        StopReason::Starting,
        StopReason::SonarStale { sonar },
        StopReason::SonarInvalid { sonar },
        StopReason::TooNear { sonar },
        StopReason::OdometryStale,
        StopReason::OdometryInvalid,
        StopReason::ClockWentBack,
        StopReason::AdviceInvalid,
        StopReason::MotorsDisabled,
        StopReason::Stalled,
        StopReason::EmergencyStop,
        StopReason::LinkLost,
        StopReason::Operator,
    ] {
        assert!(!reason.may_turn(), "{reason}");
    }
    for reason in [
        StopReason::MinDistance {
            sonar,
            range: 300,
            minimum: 400,
        },
        StopReason::ContactTime {
            distance: 100,
            closing: 500,
        },
        StopReason::ObstacleTooFast,
        StopReason::Clearance {
            sonar,
            clearance: 10,
            required: 200,
        },
    ] {
        assert!(reason.may_turn(), "{reason}");
    }
}
