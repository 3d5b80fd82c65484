//! What these tests share: a pilot and a simulated robot in virtual time, with a line between them
//! that can be made bad, and a log that is read back.
#![allow(dead_code)] // Each test uses some of it.

use sidestep::law::Law;
use sidestep_hw::base;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::demo::goal_from_start;
use sidestep_hw::log::{self, Log, Record};
use sidestep_hw::pilot::{Pilot, UsualLaw, settings, usual_law};
use sidestep_hw::replay;
use sidestep_hw::session::{Output, Settings};
use sidestep_sim::scenario::{Knobs, Scenario};
use sidestep_sim::simulation::Outcome;
use sidestep_sim::{STEP_MS, Simulation};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// How many seeds of a kind of run, of which there are ordinarily this many: more in proportion
/// where `SIDESTEP_SEEDS` asks for other than 250 of the kind of which there are most.
pub fn seeds(ordinary: u64) -> u64 {
    let most = match std::env::var("SIDESTEP_SEEDS") {
        Ok(text) => text.parse().expect("SIDESTEP_SEEDS is a number"),
        Err(_) => 250,
    };
    (most * ordinary / 250).max(1)
}

/// The folder that `variable` names, or a loud word that it names none.
pub fn folder(variable: &str, skipped: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        eprintln!("SKIPPED: {skipped} ({variable} is not set)");
    }
    folder
}

/// A scenario with people who walk on even into a robot that stands still, 1 % range noise and this
/// share of echoes lost.
pub fn inconsiderate(name: &str, dropout: f64) -> Scenario {
    let mut knobs = Knobs {
        courteous: false,
        sonar_noise: 0.01,
        ..Knobs::default()
    };
    knobs.sonar_faults.dropout = dropout;
    Scenario::named(name, &knobs).expect(name)
}

/// The law that drives unless another is asked for.
pub fn usual(config: &RobotConfig) -> UsualLaw<16> {
    let ring = base::ring(config).expect("the ring fits the configuration");
    usual_law(config.core, ring)
}

/// Contacts in which the robot moved: what must not be.
pub fn moving_contacts(outcome: &Outcome) -> u32 {
    let (driving, turning) = (
        outcome.contacts_while_driving,
        outcome.contacts_while_turning,
    );
    driving.people + driving.obstacles + turning.people + turning.obstacles
}

/// Numbers out of a seed (splitmix64).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A number below `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }
}

/// A log in memory, of which one end is written and the other read.
#[derive(Clone, Debug, Default)]
pub struct SharedLog(Arc<Mutex<Vec<u8>>>);

impl SharedLog {
    pub fn bytes(&self) -> Vec<u8> {
        self.0.lock().expect("nobody panics while writing").clone()
    }

    fn is_empty(&self) -> bool {
        let log = self.0.lock().expect("nobody panics while writing");
        log.is_empty()
    }
}

impl Write for SharedLog {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let mut log = self.0.lock().expect("nobody panics while writing");
        log.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Decisions in a log: ticks, and stops that no packet shows.
pub fn decisions(log: &Log) -> u64 {
    let decided = |record: &Record| matches!(record, Record::Tick { .. } | Record::Halt { .. });
    log.records
        .iter()
        .filter(|(_, record)| decided(record))
        .count() as u64
}

/// What a line makes of the bytes that are sent through it in one direction at a time (ms).
pub type Mangle = Box<dyn FnMut(Vec<u8>, u64) -> Vec<u8>>;

/// A line that leaves bytes as they are.
pub fn good_line() -> Mangle {
    Box::new(|bytes, _| bytes)
}

/// A pilot and a simulated robot in virtual time, and the line between them.
pub struct Rig<L> {
    pub simulation: Simulation,
    pub pilot: Pilot<L, 16>,
    pub log: SharedLog,
    /// What the robot sends on its way to the host.
    pub to_host: Mangle,
    /// What the host sends on its way to the robot.
    pub to_robot: Mangle,
    /// What was shown to the operator.
    pub events: Vec<(u64, String)>,
    /// The rate of the host's port, where it has one.
    baud: Option<u32>,
    now: u64,
    /// Decisions made before the robot said who it is, when no log can have begun.
    unlogged: u64,
}

impl<L: Law<16>> Rig<L> {
    /// A scenario over a line without baud rates.
    pub fn new(scenario: &Scenario, config: &RobotConfig, law: L) -> Self {
        Self::with_settings(scenario, config, law, settings(config, false, None))
    }

    pub fn with_settings(
        scenario: &Scenario,
        config: &RobotConfig,
        law: L,
        settings: Settings,
    ) -> Self {
        let log = SharedLog::default();
        let pilot = Pilot::with_law(
            law,
            *config,
            goal_from_start(scenario),
            settings,
            Box::new(log.clone()),
        );
        Self {
            simulation: scenario.simulate().expect("the scenario is valid"),
            pilot: pilot.expect("the goal is in range"),
            log,
            to_host: good_line(),
            to_robot: good_line(),
            events: Vec::new(),
            baud: None,
            now: 0,
            unlogged: 0,
        }
    }

    pub fn now(&self) -> u64 {
        self.now
    }

    /// The world and the robot move on by a step; the host does nothing.
    pub fn step_without_host(&mut self) {
        self.now += STEP_MS;
        self.simulation.advance_to(self.now);
    }

    /// Everything moves on by a step.
    pub fn step(&mut self) {
        self.step_without_host();
        let now = self.now;
        let robot = self.simulation.robot_mut();
        let sent = match self.baud {
            Some(baud) => robot.transmit_at(baud),
            None => robot.transmit(),
        };
        let heard = (self.to_host)(sent, now);
        if !heard.is_empty() {
            self.pilot.receive(&heard, now);
        }
        while let Some(output) = self.pilot.poll(now) {
            let robot = self.simulation.robot_mut();
            match output {
                Output::Send(bytes) => {
                    let bytes = (self.to_robot)(bytes, now);
                    match self.baud {
                        Some(baud) => robot.receive_at(baud, &bytes),
                        None => robot.receive(&bytes),
                    }
                }
                Output::SetBaud(baud) => self.baud = Some(baud),
                Output::Discard => drop(robot.transmit()),
            }
        }
        while let Some(event) = self.pilot.next_event() {
            self.events.push(event);
        }
        if self.log.is_empty() {
            self.unlogged = self.pilot.tally().ticks;
        }
    }

    /// Steps until `done`, and whether that came before `limit` (ms).
    pub fn run_until(&mut self, limit: u64, done: impl Fn(&Self) -> bool) -> bool {
        while self.now < limit {
            self.step();
            if done(self) {
                return true;
            }
        }
        false
    }

    /// Steps until the goal is reached, and whether that came before `limit` (ms).
    pub fn drive(&mut self, limit: u64) -> bool {
        self.run_until(limit, |rig| rig.pilot.tally().arrived.is_some())
    }

    /// Steps until the robot is as fast as it cruises.
    pub fn drive_to_cruise(&mut self) {
        let cruising = |rig: &Self| rig.speed() >= 0.15;
        assert!(self.run_until(20_000, cruising), "{:?}", self.events);
    }

    /// Steps on for `ms`.
    pub fn wait(&mut self, ms: u64) {
        self.run_until(self.now + ms, |_| false);
    }

    /// True forward speed of the robot (m/s).
    pub fn speed(&self) -> f64 {
        self.simulation.robot().base().speed()
    }

    /// Whether the robot truly neither drives nor turns.
    pub fn at_rest(&self) -> bool {
        let base = self.simulation.robot().base();
        base.speed() == 0.0 && base.turn_rate() == 0.0
    }

    /// Whether something shown contains `text`.
    pub fn was_shown(&self, text: &str) -> bool {
        self.events.iter().any(|(_, event)| event.contains(text))
    }

    /// Ends the session, and checks what must be true of every run, whatever happened: the robot is
    /// left at rest, and the log is whole and replays to the same decisions, all of them.
    pub fn finish(&mut self) -> Log {
        self.pilot.close(self.now);
        self.wait(4000);
        assert!(self.at_rest(), "left moving at {} m/s", self.speed());
        self.check_log()
    }

    /// Reads the log back, and checks that it is whole and replays to the same decisions.
    pub fn check_log(&self) -> Log {
        assert_eq!(self.pilot.log_error(), None);
        let log = log::read(self.log.bytes().as_slice()).expect("the log is readable");
        assert_eq!(log.cut, None);
        assert_eq!(decisions(&log) + self.unlogged, self.pilot.tally().ticks);
        let replayed = replay::log(&log).expect("the log is usable");
        assert_eq!(replayed.parting, None);
        assert_eq!(replayed.ticks as u64, decisions(&log));
        log
    }
}
