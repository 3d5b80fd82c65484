//! The promise, in thousands of encounters: the robot is at rest before anything touches it.
//!
//! People walk on regardless, into a robot that stands still if it is in their way: being touched at
//! rest is what passive safety leaves to them, and is counted apart. `SIDESTEP_SEEDS=10000 cargo test
//! --release -p sidestep-hw --test encounters -- --nocapture` is a long run.

mod common;

use common::{Random, Rig, inconsiderate, moving_contacts, seeds};
use nalgebra::Vector2;
use sidestep::arcos::BaseParameters;
use sidestep::avoid::Avoid;
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::quantity::Instant;
use sidestep::view::{Memory, View};
use sidestep_hw::base::{self, Base};
use sidestep_hw::config::RobotConfig;
use sidestep_hw::demo::{goal_from_start, run_in_memory};
use sidestep_hw::pilot::{UsualLaw, settings};
use sidestep_hw::session::{Event, Output, Session};
use sidestep_sim::STEP_MS;
use sidestep_sim::scenario::{Knobs, Scenario};
use sidestep_sim::simulation::Outcome;
use sidestep_sim::sonar::{Failure, Faults};
use std::fmt;

/// S1 Fig. 12, where people walk at up to 0.4 m/s, and the fastest person S1 allows for.
const ENCOUNTERS: [(&str, f64); 4] = [
    ("fig12-head-on", 0.4),
    ("fig12-crossing", 0.4),
    ("fig12-from-side", 0.4),
    ("head-on-80", 0.8),
];

/// What came of many runs.
#[derive(Clone, Copy, Debug)]
struct Figures {
    runs: u64,
    arrived: u64,
    while_driving: u32,
    while_turning: u32,
    at_rest: u32,
    /// Least clearance while driving, m.
    least: f64,
    travelled: f64,
}

impl Figures {
    const NONE: Self = Self {
        runs: 0,
        arrived: 0,
        while_driving: 0,
        while_turning: 0,
        at_rest: 0,
        least: f64::INFINITY,
        travelled: 0.0,
    };

    fn add(&mut self, outcome: &Outcome, arrived: bool) {
        self.runs += 1;
        self.arrived += u64::from(arrived);
        let driving = outcome.contacts_while_driving;
        self.while_driving += driving.people + driving.obstacles;
        let turning = outcome.contacts_while_turning;
        self.while_turning += turning.people + turning.obstacles;
        let resting = outcome.contacts_at_rest;
        self.at_rest += resting.people + resting.obstacles;
        let least = outcome.minimum_clearance_while_driving;
        self.least = self.least.min(least.people).min(least.obstacles);
        self.travelled += outcome.travelled;
    }

    /// No contact while moving, and not because nothing moved.
    fn assert_safe(&self, what: &str) {
        println!("{what}: {self}");
        assert_eq!(self.while_driving, 0, "{what}: contacts while driving");
        assert_eq!(self.while_turning, 0, "{what}: contacts while turning");
        assert!(self.travelled > 0.0, "{what}: the robot never moved");
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} runs, {} arrived, contacts while driving {}, while turning {}, at rest {}, least \
             clearance while driving {:.3} m, {:.0} m driven",
            self.runs,
            self.arrived,
            self.while_driving,
            self.while_turning,
            self.at_rest,
            self.least,
            self.travelled
        )
    }
}

/// Runs variations of a scenario with the program's own loop in virtual time.
fn sweep<L: Law<16>>(
    scenario: &Scenario,
    speed_limit: f64,
    seeds: u64,
    law: impl Fn(u64, &RobotConfig) -> L,
) -> Figures {
    let config = RobotConfig::default();
    let mut figures = Figures::NONE;
    for seed in 0..seeds {
        let scenario = scenario.clone().randomised(seed, speed_limit).unwrap();
        let (summary, _) = run_in_memory(&scenario, &config, law(seed, &config)).unwrap();
        if summary.contacts_while_moving() > 0 {
            println!("{} seed {seed}: {:?}", scenario.name, summary.outcome);
        }
        figures.add(&summary.outcome, summary.tally.arrived.is_some());
    }
    figures
}

fn s1(_seed: u64, config: &RobotConfig) -> UsualLaw<16> {
    common::usual(config)
}

#[test]
fn nobody_is_touched_by_a_moving_robot() {
    let mut all = Figures::NONE;
    for (name, speed_limit) in ENCOUNTERS {
        let figures = sweep(&inconsiderate(name, 0.1), speed_limit, seeds(250), s1);
        figures.assert_safe(name);
        all.runs += figures.runs;
        all.arrived += figures.arrived;
    }
    println!("{} of {} runs arrived", all.arrived, all.runs);
    // Safe and useless is not the goal.
    assert!(all.arrived > all.runs / 2, "{} arrived", all.arrived);
}

#[test]
fn nobody_is_touched_among_false_echoes() {
    for (name, speed_limit) in ENCOUNTERS {
        let mut scenario = inconsiderate(name, 0.1);
        scenario.sonar_faults.false_echo = 0.1;
        sweep(&scenario, speed_limit, seeds(100), s1)
            .assert_safe(&format!("{name}, false echoes 10 %"));
    }
}

#[test]
fn nothing_is_touched_in_the_laboratory() {
    for courteous in [true, false] {
        let mut scenario = inconsiderate("lab", 0.1);
        if courteous {
            let mut knobs = Knobs::default();
            knobs.sonar_faults.dropout = 0.1;
            scenario = Scenario::named("lab", &knobs).unwrap();
        }
        sweep(&scenario, 0.8, seeds(100), s1)
            .assert_safe(&format!("lab, people courteous: {courteous}"));
    }
}

/// Full speed ahead, whatever is there.
struct Reckless;

impl Law<16> for Reckless {
    fn advise(&mut self, _view: &View<16>) -> Advice {
        Advice {
            speed: 10.0,
            turn_rate: 0.0,
        }
    }

    fn mode(&self) -> &'static str {
        "reckless"
    }
}

/// Any bits at all: NaN, infinities, and every now and then a wish that can be granted.
struct AnyBits(Random);

impl Law<16> for AnyBits {
    fn advise(&mut self, _view: &View<16>) -> Advice {
        let mut any = || {
            let bits = self.0.bits();
            match bits >> 62 {
                0 => f32::from_bits(bits as u32),
                _ => (bits as i32) as f32 / i32::MAX as f32,
            }
        };
        Advice {
            speed: any(),
            turn_rate: any(),
        }
    }

    fn mode(&self) -> &'static str {
        "any bits"
    }
}

/// Not a number, ever.
struct NotANumber;

impl Law<16> for NotANumber {
    fn advise(&mut self, _view: &View<16>) -> Advice {
        Advice {
            speed: f32::NAN,
            turn_rate: f32::NAN,
        }
    }

    fn mode(&self) -> &'static str {
        "not a number"
    }
}

#[test]
fn no_law_at_all_can_touch_anybody() {
    for name in ["head-on-80", "fig12-crossing", "fig12-from-side", "lab"] {
        let scenario = inconsiderate(name, 0.1);
        sweep(&scenario, 0.8, seeds(50), |_, _| Reckless)
            .assert_safe(&format!("{name}, always full speed ahead"));
        sweep(&scenario, 0.8, seeds(50), |seed, _| AnyBits(Random(seed)))
            .assert_safe(&format!("{name}, any bits for advice"));
    }
    let figures = sweep(&inconsiderate("lab", 0.1), 0.8, 10, |_, _| NotANumber);
    assert_eq!(figures.travelled, 0.0, "NaN never yields motion");
}

/// A run in which the law's advice goes straight to the robot, past the shield: the law is told of
/// no guard, and its speed and turn rate are what the base is told.
fn without_the_shield(scenario: &Scenario, config: &RobotConfig) -> (Outcome, bool) {
    let mut simulation = scenario.simulate().unwrap();
    let mut session = Session::new(settings(config, false, None), 0);
    let mut base = Base::<16>::new(BaseParameters::P3DX_SH, config);
    let ring = base::ring::<16>(config).unwrap();
    let mut memory = Memory::<16>::default();
    let mut law = Avoid::new(config.core);
    let [x, y] = goal_from_start(scenario);
    let goal = Vector2::new(x, y);
    let arrived = |law: &Avoid| Law::<16>::mode(law) == "arrived";
    let mut now = 0;
    while now < scenario.time_limit_ms && !arrived(&law) {
        now += STEP_MS;
        simulation.advance_to(now);
        session.receive(&simulation.robot_mut().transmit(), now);
        while let Some(event) = session.next_event() {
            let Event::Information { information, .. } = event else {
                continue;
            };
            let observation = base.observe(&information, Instant(now));
            let view = memory.update(&observation, goal, &ring, &config.core);
            let advice = law.advise(&view.expect("the odometry is good"));
            let turn_rate = advice.turn_rate.to_degrees() as i32;
            session.command((advice.speed * 1000.0) as i32, turn_rate, now);
        }
        while let Some(output) = session.poll(now) {
            if let Output::Send(bytes) = output {
                simulation.robot_mut().receive(&bytes);
            }
        }
    }
    (simulation.outcome(), arrived(&law))
}

/// Readings §7e: the maneuvers as published, simulated for points, come as near as 39 cm to a person
/// at 0.4 m/s and 18 cm at 0.8 m/s; a robot and a person with bodies need 55 cm. (The stop rule with
/// the cap of 0.8 m/s cannot have been in force in the published maneuvers, so the law is given no
/// guard here.)
#[test]
fn it_is_the_shield_that_prevents_it() {
    let config = RobotConfig::default();
    for (name, speed_limit) in [("head-on-80", 0.8), ("fig12-head-on", 0.4)] {
        let scenario = inconsiderate(name, 0.1);
        let mut without = Figures::NONE;
        for seed in 0..seeds(250) {
            let scenario = scenario.clone().randomised(seed, speed_limit).unwrap();
            let (outcome, arrived) = without_the_shield(&scenario, &config);
            without.add(&outcome, arrived);
        }
        println!("{name}, without the shield: {without}");
        assert!(
            without.while_driving > 0,
            "{name}: the law alone touches nobody, so this shows nothing"
        );
        sweep(&scenario, speed_limit, seeds(250), s1)
            .assert_safe(&format!("{name}, with the shield"));
    }
}

/// A rig on a variation of a scenario with one broken sonar.
fn with_broken_sonar(
    name: &str,
    speed_limit: f64,
    seed: u64,
    sonar: usize,
    failure: Failure,
) -> Rig<UsualLaw<16>> {
    let config = RobotConfig::default();
    let scenario = inconsiderate(name, 0.1)
        .randomised(seed, speed_limit)
        .unwrap();
    let mut rig = Rig::new(&scenario, &config, common::usual(&config));
    break_sonar(&mut rig, sonar, failure);
    rig
}

fn break_sonar(rig: &mut Rig<UsualLaw<16>>, sonar: usize, failure: Failure) {
    let faults = Faults {
        failure: Some(failure),
        ..Faults::default()
    };
    let ring = rig.simulation.robot_mut().ring_mut();
    ring.set_faults_of(sonar, faults).unwrap();
}

/// A sonar that hears nothing cannot be told from free space, and one that is stuck at a range looks
/// like something that follows the robot: what saves the robot is that the cones of its neighbours
/// overlap with that of any one sonar.
#[test]
fn one_broken_sonar_is_made_up_for_by_its_neighbours() {
    for failure in [Failure::Deaf, Failure::Stuck(3000)] {
        let mut figures = Figures::NONE;
        for (name, speed_limit) in ENCOUNTERS {
            for sonar in 0..16 {
                for seed in 0..seeds(3) {
                    let mut rig = with_broken_sonar(name, speed_limit, seed, sonar, failure);
                    let arrived = rig.drive(60_000);
                    let outcome = rig.simulation.outcome();
                    if moving_contacts(&outcome) > 0 {
                        println!("{name} seed {seed}, sonar {sonar} {failure:?}: {outcome:?}");
                    }
                    figures.add(&outcome, arrived);
                }
            }
        }
        figures.assert_safe(&format!("one sonar {failure:?}"));
    }
}

/// The kinds of reading that are no range keep the robot where it is, whichever sonar gives them.
#[test]
fn a_sonar_that_gives_no_range_keeps_the_robot_at_rest() {
    for sonar in 0..16 {
        for (failure, reason) in [
            (Failure::Silent, StopReason::SonarStale { sonar }),
            (Failure::Stuck(0), StopReason::TooNear { sonar }),
            (Failure::Stuck(u16::MAX), StopReason::SonarInvalid { sonar }),
        ] {
            let mut rig = with_broken_sonar("fig12-crossing", 0.4, 1, sonar, failure);
            assert!(!rig.drive(20_000));
            assert_eq!(rig.simulation.outcome().travelled, 0.0, "{failure:?}");
            let decision = rig.pilot.latest().unwrap();
            assert_eq!(decision.stop, Some(reason));
            rig.finish();
        }
    }
}

#[test]
fn a_sonar_that_falls_silent_stops_the_robot_and_says_so() {
    let config = RobotConfig::default();
    let age_max = (config.core.sonar_age_max * 1000.0) as u64;
    let mut scenario = inconsiderate("head-on-80", 0.0);
    // Nobody is there: nothing but the silence stops this robot.
    scenario.world = sidestep_sim::World::new();
    for sonar in 0..16 {
        let mut rig = Rig::new(&scenario, &config, common::usual(&config));
        rig.drive_to_cruise();
        break_sonar(&mut rig, sonar, Failure::Silent);
        let silent_at = rig.now();
        // What was measured last is still good for a while: one lost ping is no reason to stop.
        rig.wait(age_max - 100);
        assert!(rig.speed() > 0.1, "sonar {sonar}: stopped too early");
        // A packet's time, the base's delay, and braking from 0.4 m/s at 1 m/s².
        assert!(rig.run_until(silent_at + age_max + 100 + 50 + 400, Rig::at_rest));
        rig.wait(5000);
        assert!(rig.at_rest());
        let reason = rig.pilot.latest().unwrap().stop;
        assert_eq!(reason, Some(StopReason::SonarStale { sonar }));
        assert_eq!(rig.pilot.tally().stops.get("sonar stale"), Some(&1));
        rig.finish();
    }
}
