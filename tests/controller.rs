//! The whole line, observation to command: any observations, any law, any configuration.
//!
//! What is judged at each tick is in `fuzz/targets/watch.rs`, which the fuzz target shares.

mod common;

use common::{
    advice, any_f32, config, in_order, observations, pioneer, settings, usual_or_any_config,
};
use proptest::prelude::*;
use sidestep::avoid::Avoid;
use sidestep::config::{Config, FIELDS, Parameters};
use sidestep::controller::{Controller, Decision};
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::observation::Observation;
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::shield::Limit;
use sidestep::view::Class;
use sidestep_spec::{avoid, shield, view as belief};

#[path = "../fuzz/targets/reference.rs"]
mod reference;
#[path = "../fuzz/targets/watch.rs"]
mod watch;
use watch::{Told, Watched};

/// The goal of every drive here: straight ahead.
const GOAL: [f32; 2] = [6.0, 0.0];

/// Full speed ahead.
const AHEAD: Advice = Advice {
    speed: 1.0,
    turn_rate: 0.0,
};

// ------------------------------------------------------------- anything at all

/// Puts a sequence of observations to a law that advises what it is told.
fn put_to_any_law<const N: usize>(config: Config, ticks: Vec<(Observation<N>, Advice)>) {
    let law = Told::new(Advice::REST);
    let (config, ring) = settings::fitted::<N>(&config);
    let mut watched = Watched::new(config, ring, law, GOAL);
    for (observation, advice) in ticks {
        watched.controller.law().advice.set(advice);
        watched.tick(&observation);
    }
}

/// Puts a sequence of observations to S1's law.
fn put_to_avoid<const N: usize>(config: Config, ticks: Vec<Observation<N>>) {
    let (config, ring) = settings::fitted::<N>(&config);
    let mut watched = Watched::new(config, ring, Avoid::new(config), GOAL);
    for observation in ticks {
        let (decision, advice) = watched.tick(&observation);
        let guarded = decision.view.is_some_and(|view| view.guard.is_some());
        if let Some(advice) = advice {
            assert!(avoid::advice_in_range(
                advice.speed,
                advice.turn_rate,
                config.speed_max,
                config.turn_rate_max
            ));
            assert!(avoid::stop_dominates(guarded, advice.speed == 0.0));
        }
    }
}

/// Observations with an advice for each.
fn with_advice<const N: usize>(
    ticks: usize,
) -> impl Strategy<Value = Vec<(Observation<N>, Advice)>> {
    (
        observations::<N>(ticks),
        proptest::collection::vec(advice(), ticks),
    )
        .prop_map(|(observations, advice)| observations.into_iter().zip(advice).collect())
}

proptest! {
    #![proptest_config(common::cases(400))]

    //= shield.INV-1
    //= shield.INV-4
    //= shield.INV-5
    //= shield.INV-6
    //= shield.INV-9
    //= shield.INV-11
    //= view.INV-4
    #[test]
    fn any_observations_any_law_three_sonars(
        config in usual_or_any_config(), ticks in with_advice::<3>(40),
    ) {
        put_to_any_law(config, ticks);
    }

    //= shield.INV-1
    //= shield.INV-4
    //= shield.INV-5
    //= shield.INV-6
    //= shield.INV-9
    //= shield.INV-12
    //= view.INV-4
    #[test]
    fn any_observations_any_law_eight_sonars(
        config in usual_or_any_config(), ticks in with_advice::<8>(20),
    ) {
        put_to_any_law(config, ticks);
    }

    //= avoid.INV-11
    //= avoid.INV-13
    //= shield.INV-5
    #[test]
    fn any_observations_s1_three_sonars(
        config in usual_or_any_config(), ticks in observations::<3>(40),
    ) {
        put_to_avoid(config, ticks);
    }

    //= avoid.INV-11
    //= avoid.INV-13
    //= shield.INV-5
    #[test]
    fn any_observations_s1_eight_sonars(
        config in usual_or_any_config(), ticks in observations::<8>(20),
    ) {
        put_to_avoid(config, ticks);
    }
}

// ------------------------------------------------ a world in which things work

/// A robot that does at once what it is told, and someone who walks along its axis.
struct Drive<L, const N: usize> {
    watched: Watched<L, N>,
    now: u64,
    /// Where the robot is, along the axis.
    x: f32,
    /// Where the other is, and how fast it comes.
    other: f32,
    coming: f32,
    /// What is heard where nothing is.
    silence: f32,
}

impl<L: Law<N> + Clone, const N: usize> Drive<L, N> {
    fn new(config: Config, law: L, other: f32, coming: f32) -> Self {
        let (config, ring) = settings::fitted(&config);
        Self {
            watched: Watched::new(config, ring, law, GOAL),
            now: 10_000,
            x: 0.0,
            other,
            coming,
            silence: config.sonar_range_max,
        }
    }

    /// What is seen now: all of it fresh, the other straight ahead as far as sonars hear, and the
    /// robot as fast as it was told.
    fn observe(&self) -> Observation<N> {
        let mut ranges = [self.silence; N];
        // Sonars 0 of one or three, and 3 and 4 of eight, look ahead from about here.
        let range = (self.other - self.x - 0.18).max(0.03);
        let ahead: &[usize] = if N == 8 { &[3, 4] } else { &[0] };
        for &sonar in ahead {
            ranges[sonar] = range.min(self.silence);
        }
        let mut observation = in_order(self.now, ranges);
        if let Some(odometry) = &mut observation.odometry {
            odometry.x = self.x;
            odometry.speed = self.watched.last().speed() as f32 / 1000.0;
        }
        observation
    }

    fn advance(&mut self) {
        self.now += 100;
        self.x += self.watched.last().speed() as f32 / 1e4;
        self.other -= self.coming / 10.0;
    }

    fn tick(&mut self) -> Decision<N> {
        let decision = self.watched.tick(&self.observe()).0;
        self.advance();
        decision
    }

    /// Ticks until the robot moves.
    fn set_off(&mut self) {
        for _ in 0..50 {
            if self.tick().command.speed() > 0 {
                return;
            }
        }
        panic!("does not set off");
    }
}

/// A robot with nothing around that is told to go.
fn under_way<const N: usize>(config: Config) -> Drive<Told, N> {
    let mut drive = Drive::new(config, Told::new(AHEAD), 100.0, 0.0);
    drive.set_off();
    for _ in 0..30 {
        drive.tick();
    }
    drive
}

/// With nothing wrong it does move, as fast as it may: or all of the above would be empty.
#[test]
fn it_moves() {
    let drive = under_way::<3>(pioneer());
    assert_eq!(drive.watched.last().speed(), 400);
    let drive = under_way::<8>(pioneer());
    assert_eq!(drive.watched.last().speed(), 400);
    let mut avoid = Drive::<_, 3>::new(pioneer(), Avoid::new(pioneer()), 100.0, 0.0);
    for _ in 0..40 {
        avoid.tick();
    }
    assert_eq!(avoid.watched.last().speed(), 200);
}

/// Something that goes wrong with an observation.
type Fault = fn(&mut Observation<3>);

/// Everything that can be at fault in one observation, and what the stop is then called.
fn faults() -> Vec<(&'static str, Fault)> {
    vec![
        ("sonar 1 is stale", |o| o.sonar[1] = None),
        ("sonar 1 is stale", |o| {
            o.sonar[1].as_mut().expect("a sample").taken_at = Instant(1);
        }),
        ("sonar 1 reads no valid range", |o| {
            o.sonar[1].as_mut().expect("a sample").range = f32::NAN;
        }),
        ("sonar 1 reads no valid range", |o| {
            o.sonar[1].as_mut().expect("a sample").range = f32::INFINITY;
        }),
        ("sonar 1 reads no valid range", |o| {
            o.sonar[1].as_mut().expect("a sample").taken_at = Instant(u64::MAX);
        }),
        ("sonar 1: something touches it", |o| {
            o.sonar[1].as_mut().expect("a sample").range = 0.0;
        }),
        ("odometry is stale", |o| o.odometry = None),
        ("odometry is not a pose", |o| {
            o.odometry.as_mut().expect("odometry").x = f32::NAN;
        }),
        ("odometry is not a pose", |o| {
            o.odometry.as_mut().expect("odometry").heading = 1e9;
        }),
        ("odometry is not a pose", |o| {
            o.odometry.as_mut().expect("odometry").turn_rate = f32::INFINITY;
        }),
        ("clock went back", |o| {
            *o = in_order(o.now.0 - 1_000, [5.0; 3]);
        }),
        ("motors are disabled", |o| o.base.motors_enabled = false),
    ]
}

/// What latches at once.
fn grave_faults() -> [(StopReason, Fault); 2] {
    [
        (StopReason::Stalled, |o| o.base.stalled = true),
        (StopReason::EmergencyStop, |o| o.base.emergency_stop = true),
    ]
}

/// A fault stops the robot in the tick in which it is seen, says why, and after it has cleared
/// the robot waits for exactly as many clear ticks as are configured.
//= shield.INV-4
//= shield.INV-5
#[test]
fn motion_resumes_only_after_clear_ticks() {
    for (reason, break_it) in faults() {
        for resume_samples in [1.0, 3.0, 7.0] {
            let config = Config::new(Parameters {
                resume_samples,
                ..preset::PIONEER_3DX
            })
            .expect("a configuration");
            let mut drive = under_way::<3>(config);
            let mut broken = drive.observe();
            break_it(&mut broken);
            let decision = drive.watched.tick(&broken).0;
            let said = decision.stop.expect("a stop").to_string();
            assert_eq!(said, reason);
            assert!(shield::untrusted_rests(
                decision.command.speed(),
                decision.command.turn_rate()
            ));
            drive.advance();
            // What was too near has to be forgotten first: its hold time is a second.
            if reason.contains("touches") {
                drive.now += 2_000;
            }
            for _ in 1..resume_samples as u32 {
                let decision = drive.tick();
                assert!(shield::stop_is_kept(
                    true,
                    false,
                    false,
                    decision.command.speed(),
                    decision.command.turn_rate()
                ));
                assert_eq!(decision.stop.expect("still").to_string(), reason);
            }
            let decision = drive.tick();
            assert_eq!(decision.stop, None, "after {reason}");
            assert!(decision.command.speed() > 0, "after {reason}");
        }
    }
}

/// A fault that comes back while the robot waits makes it wait anew.
//= shield.INV-5
#[test]
fn waiting_begins_again() {
    let mut drive = under_way::<3>(pioneer());
    for _ in 0..3 {
        let mut broken = drive.observe();
        broken.base.motors_enabled = false;
        drive.watched.tick(&broken);
        drive.advance();
        for _ in 0..2 {
            assert_eq!(drive.tick().command.speed(), 0);
        }
    }
    assert!(drive.tick().command.speed() > 0);
}

/// A lost link is a stop like any other; what the operator asked for holds until it is reset, and so
/// does what latches at once.
//= shield.INV-4
//= failsafe.INV-5
#[test]
fn halt_is_obeyed() {
    let mut drive = under_way::<3>(pioneer());
    let reason = StopReason::LinkLost;
    drive.watched.halt(reason, Instant(drive.now));
    drive.advance();
    assert_eq!(drive.tick().stop, Some(reason));
    assert_eq!(drive.tick().stop, Some(reason));
    assert!(drive.tick().command.speed() > 0);

    let reason = StopReason::Operator;
    drive.watched.halt(reason, Instant(drive.now));
    holds_until_reset(&mut drive, reason);
}

/// Clear ticks do not end a stop, and after a reset as many are awaited as ever.
fn holds_until_reset(drive: &mut Drive<Told, 3>, reason: StopReason) {
    drive.advance();
    for _ in 0..50 {
        assert_eq!(drive.tick().stop, Some(reason));
    }
    drive.watched.reset();
    assert_eq!(drive.tick().stop, Some(reason));
    assert_eq!(drive.tick().stop, Some(reason));
    assert!(drive.tick().command.speed() > 0);
}

//= failsafe.INV-5
#[test]
fn grave_faults_hold_until_they_are_reset() {
    for (reason, break_it) in grave_faults() {
        let mut drive = under_way::<3>(pioneer());
        let mut broken = drive.observe();
        break_it(&mut broken);
        assert_eq!(drive.watched.tick(&broken).0.stop, Some(reason));
        holds_until_reset(&mut drive, reason);
        // What is still wrong when it is reset latches again.
        let mut broken = drive.observe();
        break_it(&mut broken);
        drive.watched.tick(&broken);
        drive.advance();
        drive.watched.reset();
        let mut broken = drive.observe();
        break_it(&mut broken);
        drive.watched.tick(&broken);
        holds_until_reset(&mut drive, reason);
    }
}

/// A law that advises no number stops the robot.
//= shield.INV-5
#[test]
fn invalid_advice_stops() {
    for advice in [
        [f32::NAN, 0.0],
        [0.2, f32::NAN],
        [f32::INFINITY, 0.0],
        [0.2, f32::NEG_INFINITY],
    ] {
        let mut drive = under_way::<3>(pioneer());
        drive.watched.controller.law().advice.set(Advice {
            speed: advice[0],
            turn_rate: advice[1],
        });
        assert_eq!(drive.tick().stop, Some(StopReason::AdviceInvalid));
    }
}

/// A robot that is slowed says what slows it.
#[test]
fn limits_are_named() {
    // Someone walks beside the robot: no obstacle to the law, but one to the clearance.
    let config = Config::new(Parameters {
        still_samples: 100.0,
        ..preset::PIONEER_3DX
    })
    .expect("a configuration");
    let mut drive = Drive::<_, 3>::new(config, Told::new(AHEAD), 100.0, 0.0);
    let mut limits = Vec::new();
    for tick in 0..60 {
        let mut beside = drive.observe();
        beside.sonar[1].as_mut().expect("a sample").range = 0.46;
        let decision = drive.watched.tick(&beside).0;
        drive.advance();
        if tick >= 40 {
            limits.push(decision.limit);
            assert!((1..400).contains(&decision.command.speed()));
        }
    }
    assert!(
        limits.contains(&Some(Limit::Clearance { sonar: 1 })),
        "{limits:?}"
    );
    // And what the base can do.
    let mut drive = Drive::<_, 3>::new(pioneer(), Told::new(AHEAD), 100.0, 0.0);
    drive.set_off();
    assert_eq!(drive.tick().limit, Some(Limit::Base));
}

/// Measured faster than any command explains: the robot is told to rest, or has the room for what
/// it may be at; and it is said why it is not as fast as its law would have it.
//= shield.INV-11
#[test]
fn overspeed_is_judged_at_what_it_is() {
    for (beside, measured) in [
        (0.5, 0.6),
        (0.5, 2.0),
        (5.0, 2.0),
        (5.0, 10.0),
        (5.0, -10.0),
    ] {
        let mut drive = under_way::<3>(pioneer());
        let mut fast = drive.observe();
        fast.odometry.as_mut().expect("odometry").speed = measured;
        fast.sonar[1].as_mut().expect("a sample").range = beside;
        let decision = drive.watched.tick(&fast).0;
        assert!(decision.stop.is_some() || decision.limit.is_some());
    }
}

proptest! {
    #![proptest_config(common::cases(300))]

    /// ER-X1: someone who is no longer heard has not left. Neither the tick in which they vanish
    /// nor those within the hold time believe in more room than there was, and the robot's
    /// shield admits less from tick to tick.
    //= view.INV-3
    #[test]
    fn vanishing_is_not_clear(other in 1.0_f32..3.0, coming in 0.0_f32..0.5, before in 5..40_u32) {
        let config = pioneer();
        let mut drive = Drive::<_, 3>::new(config, Told::new(AHEAD), other, coming);
        let mut last = drive.tick();
        for _ in 0..before {
            last = drive.tick();
        }
        let mut last = last.view.expect("a view");
        prop_assume!(last.hazard[0].range < 3_000);
        drive.other = 100.0;
        for _ in 0..9 {
            let decision = drive.tick();
            let view = decision.view.expect("a view");
            let (before, after) = (&last.hazard[0], &view.hazard[0]);
            prop_assert!(belief::not_freed_at_once(before.range, after.range, 0));
            prop_assert!(belief::losing_sight_frees_nothing(
                [before.clearance, after.clearance],
                [before.age, after.age],
                [before.class == Class::Unknown, after.class == Class::Unknown]
            ));
            prop_assert!(view.obstacle.is_some());
            last = view;
        }
    }

    /// I14: losing sight of someone never makes the robot faster, in the tick in which the echo
    /// vanishes nor in any other while they are remembered, whatever the law advises.
    //= view.INV-3
    #[test]
    fn losing_an_echo_makes_no_faster(
        other in 0.8_f32..3.5, coming in 0.0_f32..0.8, before in 5..60_u32,
    ) {
        let config = pioneer();
        lose_the_echo(Drive::<_, 3>::new(config, Told::new(AHEAD), other, coming), before);
    }

    /// The same, for S1's law.
    //= view.INV-3
    #[test]
    fn losing_an_echo_makes_s1_no_faster(
        other in 0.8_f32..3.5, coming in 0.0_f32..0.8, before in 5..60_u32,
    ) {
        let config = pioneer();
        lose_the_echo(Drive::<_, 3>::new(config, Avoid::new(config), other, coming), before);
    }

    /// Passive safety, in the small world of these tests: whoever comes at up to the promised
    /// speed, the robot is at rest before it is reached, whatever its law would have.
    //= shield.INV-3
    #[test]
    fn at_rest_when_reached(other in 0.8_f32..4.0, coming in 0.0_f32..=0.8, s1 in any::<bool>()) {
        let config = pioneer();
        if s1 {
            meet(Drive::<_, 8>::new(config, Avoid::new(config), other, coming), &config);
        } else {
            meet(Drive::<_, 8>::new(config, Told::new(AHEAD), other, coming), &config);
        }
    }
}

fn lose_the_echo<L: Law<3> + Clone>(mut drive: Drive<L, 3>, before: u32) {
    for _ in 0..before {
        drive.tick();
    }
    if drive.observe().sonar[0].is_none_or(|sample| sample.range >= drive.silence) {
        return;
    }
    let mut speed = drive.watched.last().speed();
    drive.other = 100.0;
    // The hold time is a second, and they were seen in the tick before.
    for tick in 1..=9 {
        let now = drive.tick().command.speed();
        assert!(
            shield::slew_kept(speed, now, 0, 0),
            "{speed}, then {now} mm/s, tick {tick}"
        );
        speed = now;
    }
}

fn meet<L: Law<8> + Clone>(mut drive: Drive<L, 8>, config: &Config) {
    for _ in 0..150 {
        // Straight ahead, the hull's circle is what is reached.
        let gap = drive.other - drive.x - config.robot_radius;
        let speed = drive.watched.last().speed();
        assert!(gap > 0.0 || speed == 0, "reached at {speed} mm/s");
        if gap <= 0.0 {
            break;
        }
        drive.tick();
    }
}

/// Something within the minimum distance stops the robot, and lets it turn; it goes on when there
/// is the resume clearance on top.
//= shield.INV-4
#[test]
fn stops_at_the_minimum_distance_with_hysteresis() {
    let config = Config::new(Parameters {
        // A slow world, so that the minimum distance decides and not the time to contact.
        obstacle_speed_max: 0.3,
        still_speed_max: 0.3,
        still_speed_max_turning: 0.3,
        stop_time: 0.0,
        resume_clearance: 0.1,
        ..preset::PIONEER_3DX
    })
    .expect("a configuration");
    let mut drive = Drive::<_, 3>::new(config, Told::new(AHEAD), 100.0, 0.0);
    drive.set_off();
    let mut at = |range: f32| {
        let mut observation = drive.observe();
        observation.sonar[0].as_mut().expect("a sample").range = range;
        let decision = drive.watched.tick(&observation).0;
        drive.now += 100;
        decision
    };
    let stopped = at(0.4);
    assert!(matches!(
        stopped.stop,
        Some(StopReason::MinDistance { sonar: 0, .. })
    ));
    assert!(stopped.stop.is_some_and(StopReason::may_turn));
    for _ in 0..10 {
        assert!(at(0.45).stop.is_some(), "inside the hysteresis");
    }
    assert!(at(0.52).stop.is_some());
    assert!(at(0.52).stop.is_some());
    assert_eq!(at(0.52).stop, None, "the third clear tick");
}

/// Someone who comes as fast as the promise allows, or faster, stops the robot wherever they are
/// (ER-S1-06); someone a little slower does not, at that distance.
//= shield.INV-4
#[test]
fn too_fast_is_a_stop() {
    let stops = |coming: f32| {
        let mut drive = Drive::<_, 3>::new(pioneer(), Told::new(AHEAD), 5.0, coming);
        let stops = (0..25).filter_map(|_| drive.tick().stop);
        stops
            .filter(|&reason| reason == StopReason::ObstacleTooFast)
            .count()
    };
    assert!(stops(0.85) > 0);
    assert_eq!(stops(0.75), 0);
}

/// The same observations give the same decisions, bit for bit.
#[test]
fn decisions_are_repeatable() {
    let run = || {
        let config = pioneer();
        let mut drive = Drive::<_, 8>::new(config, Avoid::new(config), 3.0, 0.4);
        let decisions: Vec<_> = (0..60).map(|_| drive.tick()).collect();
        format!("{decisions:?}")
    };
    assert_eq!(run(), run());
}

/// A goal that is not on the map is refused by name.
#[test]
fn goals_are_checked() {
    let config = pioneer();
    let controller = |x: f32, y: f32| {
        let (config, ring) = settings::fitted::<3>(&config);
        Controller::new(config, ring, Avoid::new(config), [x, y].into())
    };
    assert!(controller(1e3, -1e3).is_ok());
    let refused = |x, y| controller(x, y).expect_err("no goal").field;
    assert_eq!(refused(1001.0, 0.0), "goal x");
    assert_eq!(refused(0.0, f32::NAN), "goal y");
}

// ------------------------------------------------------------ the configuration

/// A preset with one field changed.
fn with(field: usize, value: f32) -> Result<Config, sidestep::quantity::OutOfRange> {
    let mut values = preset::PIONEER_3DX.values();
    values[field] = value;
    Config::new(Parameters::from_values(values))
}

#[test]
fn presets_are_good() {
    for preset in [
        preset::SRIKANDI_II_2012,
        preset::SRIKANDI_II_2011,
        preset::PIONEER_3DX,
    ] {
        let config = Config::new(preset).expect("a preset");
        assert_eq!(*config.parameters(), preset);
        // The ring that comes with the robot, or S1's three, as they are.
        let (fitted, _) = settings::fitted::<16>(&config);
        assert_eq!(fitted, config);
    }
}

/// Every field that is out of range, or no number, is refused by its name, with the value and the
/// range that would do.
#[test]
fn every_field_is_checked() {
    for (i, field) in FIELDS.iter().enumerate() {
        let below = field.min - field.max.abs().max(1.0) * 1e-3;
        let above = field.max + field.max.abs().max(1.0) * 1e-3;
        for value in [
            below,
            above,
            -1.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
        ] {
            let refused = with(i, value).expect_err(field.name);
            assert_eq!(refused.field, field.name);
            assert_eq!(refused.value.to_bits(), value.to_bits());
            assert_eq!((refused.min, refused.max), (field.min, field.max));
            let said = refused.to_string();
            assert!(
                said.contains(field.name) && said.contains(field.unit),
                "{said}"
            );
        }
        assert!(!field.meaning.is_empty());
        if field.unit == "samples" {
            let refused = with(i, field.min + 0.5).expect_err("no whole number");
            assert_eq!(refused.field, field.name);
            assert!(refused.unit.contains("whole"));
        }
    }
}

/// Fields that depend on each other: the error names one of the two, and a range that does not
/// hold the value.
#[test]
fn fields_are_checked_against_each_other() {
    let refused = |change: fn(&mut Parameters)| {
        let mut parameters = preset::PIONEER_3DX;
        change(&mut parameters);
        let refused = Config::new(parameters).expect_err("contradictory");
        assert!(!(refused.min..=refused.max).contains(&refused.value));
        refused.field
    };
    assert_eq!(refused(|p| p.turn_distance = 0.81), "turn_distance");
    assert_eq!(refused(|p| p.near_distance = 1.3), "near_distance");
    assert_eq!(refused(|p| p.near_distance = 0.39), "near_distance");
    assert_eq!(refused(|p| p.safe_distance = 0.79), "near_distance");
    assert_eq!(refused(|p| p.safe_distance = 5.1), "safe_distance");
    assert_eq!(refused(|p| p.cruise_speed = 0.41), "cruise_speed");
    assert_eq!(refused(|p| p.sonar_range_min = 0.41), "min_distance");
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// Any bit patterns in any fields are a configuration within all ranges, or are refused by the
    /// name of a field.
    #[test]
    fn parameters_are_good_or_refused(
        base in config(),
        changes in proptest::collection::vec((0..FIELDS.len(), any_f32()), 1..4),
    ) {
        let mut values = base.values();
        for (field, value) in changes {
            values[field] = value;
        }
        match Config::new(Parameters::from_values(values)) {
            Ok(config) => {
                for (field, value) in FIELDS.iter().zip(config.values()) {
                    prop_assert!((field.min..=field.max).contains(&value), "{}", field.name);
                }
            }
            Err(refused) => {
                prop_assert!(FIELDS.iter().any(|field| field.name == refused.field));
                prop_assert!(!(refused.min..=refused.max).contains(&refused.value)
                    || refused.unit.contains("whole"));
            }
        }
    }
}
