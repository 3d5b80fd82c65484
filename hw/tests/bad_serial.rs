//! Pilot and simulated robot over lines that garble, die, come back or run at another rate, and with
//! robots that are stopped, switched off or left alone: in virtual time, with the real bytes.
//!
//! Whatever happens, the robot ends at rest, the reason is shown, and the log is whole and replays to
//! the same decisions ([`Rig::finish`] checks that in every test).
//!
//! The promise rests on commands that take effect one reaction time apart at most. A line that
//! swallows them breaks it, and no host can mend that: a robot that hears nothing drives on until its
//! own watchdog stops it, 2 s later. So contacts are judged apart: none may happen unless commands
//! came later than that.

mod common;

use common::{Mangle, Random, Rig, inconsiderate, moving_contacts, seeds};
use sidestep::arcos::{
    HostCommand, Identity, MAX_FRAME, Receiver, SonarReading, SonarReadings, StandardInformation,
    Tail, command,
};
use sidestep::failsafe::StopReason;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::log::{Log, Record};
use sidestep_hw::pilot::{Pilot, UsualLaw, settings};
use sidestep_sim::robot::{ArcosRobot, BAUDS, Session};
use sidestep_sim::scenario::Scenario;
use sidestep_sim::{STEP_MS, World};
use std::cell::Cell;
use std::rc::Rc;

/// How long the simulated robot drives on without a command, ms.
const WATCHDOG: u64 = 2000;
/// From an order to its effect, ms: the base's delay, and a step.
const DELAY: u64 = 50 + STEP_MS;
/// From the greatest speed to rest, ms: 0.4 m/s at 1 m/s².
const BRAKING: u64 = 400;

/// A robot with 4 m to go, and nobody there.
fn open_floor() -> Scenario {
    let mut scenario = inconsiderate("fig12-head-on", 0.0);
    scenario.world = World::new();
    scenario
}

fn rig(scenario: &Scenario) -> Rig<UsualLaw<16>> {
    let config = RobotConfig::default();
    Rig::new(scenario, &config, common::usual(&config))
}

/// A rig over a serial line whose rate has to be found out.
fn serial_rig(scenario: &Scenario) -> Rig<UsualLaw<16>> {
    let config = RobotConfig::default();
    let settings = settings(&config, true, None);
    Rig::with_settings(scenario, &config, common::usual(&config), settings)
}

fn frame(command: HostCommand<'_>) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME];
    command.encode(&mut buffer).unwrap().as_bytes().to_vec()
}

fn latest_stop(rig: &Rig<UsualLaw<16>>) -> Option<StopReason> {
    rig.pilot.latest().and_then(|decision| decision.stop)
}

fn cut() -> Mangle {
    Box::new(|_, _| Vec::new())
}

/// The log holds an event with this text.
fn logged(log: &Log, expected: &str) -> bool {
    log.records
        .iter()
        .any(|(_, record)| matches!(record, Record::Event { text, .. } if text.contains(expected)))
}

#[derive(Clone, Copy, Debug)]
enum Damage {
    /// Up to 20 bytes of anything appear somewhere.
    Garbage,
    /// The end is missing.
    Truncation,
    /// One bit is the other.
    BitFlip,
    /// Nothing arrives.
    Loss,
}

impl Damage {
    const ALL: [Self; 4] = [Self::Garbage, Self::Truncation, Self::BitFlip, Self::Loss];

    /// A line that does this to one of `1/share` writes, from 1 s on.
    fn with(self, share: f64, mut random: Random) -> Mangle {
        Box::new(move |mut bytes, now| {
            if now < 1000 || bytes.is_empty() || !random.chance(share) {
                return bytes;
            }
            let at = random.below(bytes.len());
            match self {
                Self::Garbage => {
                    for _ in 0..=random.below(20) {
                        bytes.insert(at, random.bits() as u8);
                    }
                }
                Self::Truncation => bytes.truncate(at),
                Self::BitFlip => bytes[at] ^= 1 << random.below(8),
                Self::Loss => bytes.clear(),
            }
            bytes
        })
    }
}

/// Notes when the robot was last given a speed through `line`.
fn with_watch(mut line: Mangle) -> (Mangle, Rc<Cell<u64>>) {
    let told = Rc::new(Cell::new(0));
    let mut receiver = Receiver::new();
    let noted = Rc::clone(&told);
    let watched = move |bytes, now| {
        let bytes = line(bytes, now);
        let mut input = bytes.as_slice();
        while let Some(frame) = receiver.next_frame(&mut input) {
            if frame.number() == command::VEL {
                noted.set(now);
            }
        }
        bytes
    };
    (Box::new(watched), told)
}

#[test]
fn damaged_bytes_are_rejected_and_nobody_is_touched_for_it() {
    let config = RobotConfig::default();
    // What the reaction time leaves between two commands, the base's delay being part of it.
    let patience = (config.core.reaction_time * 1000.0) as u64 - 50;
    for damage in Damage::ALL {
        for on_the_way_to_the_robot in [false, true] {
            let (mut arrived, mut rejected, mut excused, mut runs) = (0, 0, 0, 0);
            for seed in 0..seeds(50) {
                let scenario = inconsiderate("head-on-80", 0.1);
                let mut rig = rig(&scenario.randomised(seed, 0.8).unwrap());
                let line = damage.with(0.05, Random(seed));
                let (to_robot, told) = if on_the_way_to_the_robot {
                    with_watch(line)
                } else {
                    rig.to_host = line;
                    with_watch(common::good_line())
                };
                rig.to_robot = to_robot;
                let (mut touched, mut late) = (0, 0);
                while rig.now() < 60_000 && rig.pilot.tally().arrived.is_none() {
                    rig.step();
                    if rig.now() > told.get() + patience {
                        late = rig.now();
                    }
                    let now_touched = moving_contacts(&rig.simulation.outcome());
                    if now_touched > touched {
                        // A late command may still tell for as long as it takes to brake.
                        let lately = rig.now() < late + DELAY + BRAKING + 1000;
                        assert!(lately, "{damage:?} seed {seed} at {} ms", rig.now());
                        excused += now_touched - touched;
                    }
                    touched = now_touched;
                }
                arrived += u32::from(rig.pilot.tally().arrived.is_some());
                rejected += rig.pilot.tally().rejected;
                runs += 1;
                rig.finish();
            }
            println!(
                "{damage:?}, {}: {arrived} of {runs} arrived, {rejected} rejections, {excused} \
                 contacts after late commands",
                if on_the_way_to_the_robot {
                    "host to robot"
                } else {
                    "robot to host"
                }
            );
            assert!(arrived > runs / 2, "{damage:?}: {arrived} of {runs}");
            // What comes late from the robot is not waited for: only late commands may be excused.
            assert!(on_the_way_to_the_robot || excused == 0, "{excused}");
            // What does not arrive cannot be rejected, and the robot does not tell what it rejects.
            let seen = !on_the_way_to_the_robot && !matches!(damage, Damage::Loss);
            assert_eq!(rejected > 0, seen, "{damage:?}: {rejected} rejections");
        }
    }
}

#[test]
fn rejected_bytes_are_shown_and_logged() {
    let mut rig = rig(&open_floor());
    rig.to_host = Damage::BitFlip.with(0.2, Random(1));
    assert!(rig.drive(60_000));
    assert!(rig.was_shown("bad checksums"), "{:?}", rig.events);
    let rejected = rig.pilot.tally().rejected;
    let log = rig.finish();
    let notes = log.records.iter().filter(
        |(_, record)| matches!(record, Record::Event { text, .. } if text.starts_with("rejected")),
    );
    assert_eq!(notes.count() as u64, rejected);
}

/// The host hears nothing, but is heard: it tells the robot to stop.
#[test]
fn a_robot_that_is_not_heard_is_told_to_stop() {
    let config = RobotConfig::default();
    let timeout = (config.core.odometry_age_max * 1000.0) as u64;
    for name in ["fig12-head-on", "fig12-crossing", "fig12-from-side"] {
        let mut rig = rig(&inconsiderate(name, 0.1));
        rig.drive_to_cruise();
        rig.to_host = cut();
        let cut_at = rig.now();
        assert!(rig.run_until(cut_at + timeout + DELAY + BRAKING, Rig::at_rest));
        assert!(rig.now() < cut_at + WATCHDOG, "that was the watchdog");
        rig.wait(timeout);
        assert_eq!(latest_stop(&rig), Some(StopReason::LinkLost));
        assert!(rig.was_shown("link lost: no valid information packet for"));
        assert_eq!(rig.pilot.tally().stops.get("link lost"), Some(&1));
        // It goes on looking for the robot, which stays where it is.
        assert!(!rig.run_until(cut_at + 20_000, |rig| !rig.at_rest()));
        assert!(rig.was_shown("no robot answers"), "{:?}", rig.events);
        assert_eq!(moving_contacts(&rig.simulation.outcome()), 0);
        let log = rig.finish();
        assert!(logged(&log, "link lost"));
    }
}

/// Nobody hears anybody: the robot's own watchdog stops it.
#[test]
fn a_robot_that_hears_nothing_stops_by_itself() {
    let mut rig = rig(&open_floor());
    rig.drive_to_cruise();
    rig.to_host = cut();
    rig.to_robot = cut();
    let cut_at = rig.now();
    assert!(rig.run_until(cut_at + WATCHDOG + DELAY + BRAKING, Rig::at_rest));
    assert!(rig.simulation.robot().watchdog_tripped());
    assert!(rig.was_shown("link lost: no valid information packet for"));
    assert_eq!(latest_stop(&rig), Some(StopReason::LinkLost));
    assert!(!rig.run_until(cut_at + 10_000, |rig| !rig.at_rest()));
    let log = rig.finish();
    assert!(logged(&log, "link lost"));
}

#[test]
fn a_line_that_comes_back_is_used_again() {
    for [to_host, to_robot] in [[true, true], [true, false], [false, true]] {
        let mut rig = rig(&open_floor());
        rig.drive_to_cruise();
        if to_host {
            rig.to_host = cut();
        }
        if to_robot {
            rig.to_robot = cut();
        }
        rig.wait(5000);
        assert!(rig.at_rest());
        rig.to_host = common::good_line();
        rig.to_robot = common::good_line();
        assert!(rig.drive(60_000), "{:?}", rig.events);
        // Its odometry has gone on counting, so the goal is where it was.
        let goal = open_floor().goal;
        let reached = rig.simulation.robot().base().pose().position;
        assert!((goal - reached).norm() < 0.3, "at {reached:?}");
        let log = rig.finish();
        // A host that is not heard, but hears, does not know.
        assert_eq!(logged(&log, "link lost"), to_host);
        assert_eq!(logged(&log, "ready again"), to_host);
    }
}

#[test]
fn the_baud_rate_is_found_whatever_it_is() {
    for host_baud in BAUDS {
        let mut scenario = open_floor();
        scenario.robot.host_baud = host_baud;
        let mut rig = serial_rig(&scenario);
        assert!(rig.drive(60_000), "{host_baud}: {:?}", rig.events);
        // At 9600 a packet of 16 sonars takes the whole time to the next.
        assert_eq!(rig.simulation.robot().baud(), 38_400);
        rig.finish();
        assert_eq!(rig.simulation.robot().session(), Session::Unsynchronised);
    }
}

/// A robot at a rate that the host was not told of: nobody answers, and the host says so.
#[test]
fn a_wrong_baud_rate_is_reported_and_moves_nothing() {
    let mut scenario = open_floor();
    scenario.robot.host_baud = 115_200;
    let config = RobotConfig::default();
    let settings = settings(&config, true, Some(9600));
    let mut rig = Rig::with_settings(&scenario, &config, common::usual(&config), settings);
    assert!(!rig.drive(20_000));
    assert!(rig.was_shown("no robot answers at any of [9600] baud"));
    assert!(rig.at_rest());
    assert_eq!(rig.simulation.outcome().travelled, 0.0);
    rig.pilot.close(rig.now());
    // Without a robot there is nothing to log.
    assert!(rig.log.bytes().is_empty());
}

/// Nobody is there at first: the log begins where the robot answers, and replays from there.
#[test]
fn a_robot_that_answers_late_is_driven_all_the_same() {
    let mut rig = rig(&open_floor());
    rig.to_robot = cut();
    rig.wait(5000);
    assert!(rig.was_shown("no robot answers"), "{:?}", rig.events);
    rig.to_robot = common::good_line();
    assert!(rig.drive(60_000), "{:?}", rig.events);
    rig.finish();
}

/// Somebody else's session, with the robot under way: it is closed, which stops the robot, and the
/// robot is greeted as ever.
#[test]
fn a_robot_that_is_open_already_is_stopped_and_greeted_anew() {
    for baud in [9600, 38_400] {
        let mut rig = serial_rig(&open_floor());
        let robot = rig.simulation.robot_mut();
        for command in [
            HostCommand::plain(command::SYNC0),
            HostCommand::plain(command::SYNC1),
            HostCommand::plain(command::SYNC2),
            HostCommand::open(),
            HostCommand::enable_motors(true),
            HostCommand::enable_sonars(true),
            HostCommand::host_baud(baud).unwrap(),
            HostCommand::velocity(-300),
        ] {
            robot.receive(&frame(command));
        }
        for _ in 0..100 {
            rig.step_without_host();
        }
        assert!(rig.speed() < -0.2);
        assert!(rig.run_until(10_000, Rig::at_rest), "{:?}", rig.events);
        assert!(rig.drive(60_000), "{:?}", rig.events);
        assert!(rig.was_shown("closed a session that was open already"));
        rig.finish();
    }
}

/// A robot that lost its power has neither a session nor motors.
#[test]
fn a_robot_that_was_rebooted_is_greeted_anew() {
    let mut rig = rig(&inconsiderate("fig12-from-side", 0.1));
    rig.drive_to_cruise();
    let robot = rig.simulation.robot();
    let rebooted = ArcosRobot::new(robot.parameters().clone(), robot.base().pose(), 2).unwrap();
    *rig.simulation.robot_mut() = rebooted;
    let rebooted_at = rig.now();
    assert!(rig.run_until(rebooted_at + 1000, |rig| rig.was_shown("link lost")));
    assert_eq!(latest_stop(&rig), Some(StopReason::LinkLost));
    assert!(rig.run_until(20_000, |rig| rig.was_shown("ready again")));
    rig.wait(20_000);
    assert_eq!(moving_contacts(&rig.simulation.outcome()), 0);
    let log = rig.finish();
    assert!(logged(&log, "ready again"));
}

/// Whoever pressed the button had a reason: the robot stays at rest when it is let go again.
#[test]
fn an_emergency_stop_is_obeyed_shown_and_not_undone() {
    let mut rig = rig(&open_floor());
    rig.drive_to_cruise();
    rig.simulation.robot_mut().press_e_stop(true);
    let pressed_at = rig.now();
    assert!(rig.run_until(pressed_at + BRAKING, Rig::at_rest));
    rig.wait(500);
    assert_eq!(latest_stop(&rig), Some(StopReason::EmergencyStop));
    assert!(rig.was_shown("no longer ready: the emergency stop is pressed"));
    rig.wait(5000);
    rig.simulation.robot_mut().press_e_stop(false);
    assert!(!rig.run_until(rig.now() + 10_000, |rig| !rig.at_rest()));
    assert_eq!(latest_stop(&rig), Some(StopReason::EmergencyStop));
    assert!(!rig.simulation.robot().motors_enabled());
    // A reset does not switch the motors on.
    let now = rig.now();
    rig.pilot.reset(now);
    assert!(!rig.run_until(now + 10_000, |rig| !rig.at_rest()));
    assert_eq!(latest_stop(&rig), Some(StopReason::MotorsDisabled));
    let log = rig.finish();
    assert!(logged(&log, "the emergency stop is pressed"));
}

#[test]
fn motors_that_were_switched_off_stay_off() {
    let mut rig = rig(&open_floor());
    rig.drive_to_cruise();
    // As by the button on the robot.
    rig.simulation
        .robot_mut()
        .receive(&frame(HostCommand::enable_motors(false)));
    let disabled_at = rig.now();
    assert!(rig.run_until(disabled_at + BRAKING, Rig::at_rest));
    rig.wait(200);
    assert_eq!(latest_stop(&rig), Some(StopReason::MotorsDisabled));
    assert!(rig.was_shown("no longer ready: the motors are not enabled"));
    assert!(!rig.run_until(rig.now() + 10_000, |rig| !rig.at_rest()));
    rig.finish();
}

/// A loop that hangs sends nothing, and nothing else may feed the robot's watchdog for it.
#[test]
fn a_host_that_hangs_is_stopped_by_the_watchdog_and_not_before() {
    let mut rig = rig(&open_floor());
    rig.drive_to_cruise();
    rig.wait(2000);
    let cruising = rig.speed();
    assert!(cruising > 0.1);
    let hung_at = rig.now();
    // The last command may be up to a packet's time old.
    while rig.now() < hung_at + WATCHDOG - 100 {
        rig.step_without_host();
        assert!((rig.speed() - cruising).abs() < 0.01, "at {} ms", rig.now());
    }
    assert!(!rig.simulation.robot().watchdog_tripped());
    while rig.now() < hung_at + WATCHDOG + DELAY + BRAKING {
        rig.step_without_host();
    }
    assert!(rig.simulation.robot().watchdog_tripped());
    assert!(rig.at_rest());
    for _ in 0..1000 {
        rig.step_without_host();
        assert!(rig.at_rest());
    }
    // A loop that comes back finds what was sent meanwhile, and drives on.
    assert!(rig.drive(rig.now() + 60_000), "{:?}", rig.events);
    rig.finish();
}

/// A robot with motors and sonars on from the start, which answers after the host has given up once.
#[test]
fn a_link_lost_before_the_log_began_is_no_parting() {
    let config = RobotConfig::default();
    let shared = common::SharedLog::default();
    let mut pilot = Pilot::<_, 16>::new(
        config,
        [4.0, 0.0],
        settings(&config, false, None),
        Box::new(shared.clone()),
    )
    .unwrap();
    let mut now = 0;
    while pilot.lost().is_none() {
        now += 10;
        while pilot.poll(now).is_some() {}
    }
    let mut buffer = [0; MAX_FRAME];
    let mut said = vec![frame(HostCommand::plain(0)), frame(HostCommand::plain(1))];
    let identity = Identity {
        name: b"late",
        class: b"Pioneer",
        subclass: b"p3dx-sh",
    };
    said.push(identity.encode(&mut buffer).unwrap().as_bytes().to_vec());
    let mut sonars = SonarReadings::new();
    for index in 0..16 {
        sonars.push(SonarReading { index, range: 5000 });
    }
    let information = StandardInformation {
        kind: StandardInformation::MOTORS_STOPPED,
        x: 0,
        y: 0,
        heading: 0,
        left_velocity: 0,
        right_velocity: 0,
        battery_decivolts: 129,
        stalls_and_bumpers: 0,
        control: 0,
        flags: 0x1F,
        compass: 0,
        sonars,
        tail: Tail::standard(129, 0),
    };
    let sip = information.encode(&mut buffer).unwrap().as_bytes().to_vec();
    said.extend(std::iter::repeat_n(sip, 10));
    for bytes in said {
        now += 100;
        pilot.receive(&bytes, now);
        while pilot.poll(now).is_some() {}
    }
    let log = sidestep_hw::log::read(shared.bytes().as_slice()).unwrap();
    assert_eq!(sidestep_hw::replay::log(&log).unwrap().parting, None);
}
