//! Every fault in every mode with every preset: is the robot at rest before anything touches it?
//!
//! A fault strikes when the law has got into the mode in question, while somebody charges at the
//! robot again and again in a small room, and lasts to the end of the run.

use crate::base::{self, Base};
use crate::config::{self, RobotConfig};
use crate::demo::goal_from_start;
use crate::episodes::{Host, Random, Ride, assumptions, describe, pilot};
use crate::pilot::settings;
use crate::session::{Event, Output, Session};
use nalgebra::Vector2;
use sidestep::arcos::BaseParameters;
use sidestep::avoid::Avoid;
use sidestep::config::{Config, Parameters};
use sidestep::controller::Controller;
use sidestep::observation::Observation;
use sidestep::quantity::{Instant, OutOfRange};
use sidestep_sim::base::Activity;
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::person::{Habit, Motion, Person};
use sidestep_sim::scenario::{Knobs, Scenario};
use sidestep_sim::sonar::{self, Failure};
use sidestep_sim::{World, base as drive, link};
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The presets by name.
pub const PRESETS: [&str; 3] = ["pioneer_3dx", "srikandi_ii_2012", "srikandi_ii_2011"];

/// The modes of S1's law.
pub const MODES: [&str; 5] = ["cruise", "maneuver", "reorient", "stop", "arrived"];

/// A mode that is not reached in this time is not reached in a run (ms).
const PATIENCE: u64 = 25_000;

/// How long a run goes on after the fault has struck (ms).
const AFTERMATH: u64 = 8_000;

/// Time between two stalls of the loop (ms).
const STALL_PERIOD: u64 = 700;

/// What breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// Every sonar gets these faults.
    Sonars(sonar::Faults),
    /// One sonar, by the seed, breaks for good.
    OneSonar(Failure),
    /// All of them do.
    AllSonars(Failure),
    /// What the core is given is not a number.
    NotANumber(Corruption),
    /// The line, to the host and to the robot.
    Line(link::Faults, link::Faults),
    /// The control loop hangs for so long (ms), every [`STALL_PERIOD`].
    Stall(u64),
    /// The drive.
    Drive(drive::Faults),
    /// The drive brakes with this share of what it is set to, and the configuration allows for it.
    DeclaredBraking(f64),
    /// Whoever charges at the robot is faster than anyone is to be, so many times (from the
    /// beginning).
    Haste(f64),
}

/// What is not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Corruption {
    /// The range of one sonar, by the seed.
    Range,
    /// The robot's position.
    Position,
    /// The robot's speed.
    Speed,
}

/// A fault and its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// What breaks, for people to read.
    pub name: &'static str,
    /// Every assumption of the shield holds all the same, or the core can see that something is
    /// wrong: nothing may be touched.
    pub within_bounds: bool,
    fault: Fault,
}

const fn within(name: &'static str, fault: Fault) -> Case {
    Case {
        name,
        within_bounds: true,
        fault,
    }
}

const fn beyond(name: &'static str, fault: Fault) -> Case {
    Case {
        name,
        within_bounds: false,
        fault,
    }
}

const GOOD_SONAR: sonar::Faults = sonar::Faults {
    dropout: 0.0,
    false_echo: 0.0,
    zero: 0.0,
    failure: None,
};

const GOOD_LINE: link::Faults = link::Faults {
    loss: 0.0,
    duplication: 0.0,
    delay_ms: 0,
    reordering: 0.0,
    hold_ms: 0,
};

const fn lost(loss: f64) -> link::Faults {
    link::Faults { loss, ..GOOD_LINE }
}

const fn delayed(delay_ms: u64) -> link::Faults {
    link::Faults {
        delay_ms,
        ..GOOD_LINE
    }
}

const DUPLICATED: link::Faults = link::Faults {
    duplication: 0.5,
    ..GOOD_LINE
};

const REORDERED: link::Faults = link::Faults {
    reordering: 0.3,
    hold_ms: 250,
    ..GOOD_LINE
};

const fn braking(braking_share: f64) -> Fault {
    Fault::Drive(drive::Faults {
        braking_share,
        acceleration_share: 1.0,
    })
}

/// Every fault.
pub const CASES: [Case; 29] = [
    within(
        "10 % of the echoes lost",
        Fault::Sonars(sonar::Faults {
            dropout: 0.1,
            ..GOOD_SONAR
        }),
    ),
    beyond(
        "half of the echoes lost",
        Fault::Sonars(sonar::Faults {
            dropout: 0.5,
            ..GOOD_SONAR
        }),
    ),
    within(
        "20 % false echoes",
        Fault::Sonars(sonar::Faults {
            false_echo: 0.2,
            ..GOOD_SONAR
        }),
    ),
    within(
        "10 % readings of zero",
        Fault::Sonars(sonar::Faults {
            zero: 0.1,
            ..GOOD_SONAR
        }),
    ),
    within("one sonar silent", Fault::OneSonar(Failure::Silent)),
    within("all sonars silent", Fault::AllSonars(Failure::Silent)),
    beyond("one sonar deaf", Fault::OneSonar(Failure::Deaf)),
    beyond("all sonars deaf", Fault::AllSonars(Failure::Deaf)),
    within(
        "one sonar stuck at 0.15 m",
        Fault::OneSonar(Failure::Stuck(150)),
    ),
    beyond(
        "one sonar stuck at 3 m",
        Fault::OneSonar(Failure::Stuck(3000)),
    ),
    within(
        "one sonar stuck at no range",
        Fault::OneSonar(Failure::Stuck(u16::MAX)),
    ),
    within("a range is NaN", Fault::NotANumber(Corruption::Range)),
    within(
        "the position is NaN",
        Fault::NotANumber(Corruption::Position),
    ),
    within("the speed is NaN", Fault::NotANumber(Corruption::Speed)),
    within(
        "30 % of the robot's packets lost",
        Fault::Line(lost(0.3), GOOD_LINE),
    ),
    beyond(
        "30 % of the host's packets lost",
        Fault::Line(GOOD_LINE, lost(0.3)),
    ),
    beyond("the line is dead", Fault::Line(lost(1.0), lost(1.0))),
    within(
        "packets delayed up to 20 ms",
        Fault::Line(delayed(20), delayed(20)),
    ),
    beyond(
        "packets delayed up to 300 ms",
        Fault::Line(delayed(300), delayed(300)),
    ),
    within(
        "half of the packets twice",
        Fault::Line(DUPLICATED, DUPLICATED),
    ),
    beyond("packets out of order", Fault::Line(REORDERED, REORDERED)),
    within("the loop hangs for 40 ms", Fault::Stall(40)),
    beyond("the loop hangs for 400 ms", Fault::Stall(400)),
    beyond("the loop hangs for good", Fault::Stall(60_000)),
    within("half braking, declared", Fault::DeclaredBraking(0.5)),
    beyond("half braking, not declared", braking(0.5)),
    beyond("a tenth of the braking", braking(0.1)),
    beyond(
        "twice the acceleration",
        Fault::Drive(drive::Faults {
            braking_share: 1.0,
            acceleration_share: 2.0,
        }),
    ),
    beyond("a person twice as fast", Fault::Haste(2.0)),
];

/// What came of one fault in one mode with one preset.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Runs in which the mode was reached and the fault struck.
    pub struck: u64,
    /// Those of them in which the robot was touched at rest and at no other time.
    pub touched_at_rest: u64,
    /// Those in which it was in contact while it moved.
    pub failed: u64,
    /// Those of them in which it did no more than turn in place.
    pub turning_only: u64,
    /// Those in which it was although every assumption held.
    pub failed_unexplained: u64,
    /// The first of the failures: its seed, and what happened.
    pub first: Option<(u64, String)>,
    /// Assumptions that did not hold, with the number of runs.
    pub broken: BTreeMap<&'static str, u64>,
    /// Way driven after the fault struck (m).
    pub driven: f64,
    /// Why there were no runs, if there were none.
    pub refused: Option<String>,
}

/// A host without the program's care for late packets, whose core is told what is not a number.
struct Bare {
    session: Session,
    base: Base<16>,
    controller: Controller<Avoid, 16>,
    corruption: Option<(Corruption, usize)>,
    mode: Option<&'static str>,
}

impl Bare {
    fn new(scenario: &Scenario, config: &RobotConfig) -> Result<Self, OutOfRange> {
        let [x, y] = goal_from_start(scenario);
        let (ring, law) = (base::ring(config)?, Avoid::new(config.core));
        Ok(Self {
            session: Session::new(settings(config, false, None), 0),
            base: Base::new(BaseParameters::P3DX_SH, config),
            controller: Controller::new(config.core, ring, law, Vector2::new(x, y))?,
            corruption: None,
            mode: None,
        })
    }

    fn corrupt(&self, observation: &mut Observation<16>) {
        let odometry = observation.odometry.as_mut();
        match self.corruption {
            None => {}
            Some((Corruption::Range, sonar)) => {
                if let Some(Some(sample)) = observation.sonar.get_mut(sonar) {
                    sample.range = f32::NAN;
                }
            }
            Some((Corruption::Position, _)) => {
                if let Some(odometry) = odometry {
                    odometry.x = f32::NAN;
                }
            }
            Some((Corruption::Speed, _)) => {
                if let Some(odometry) = odometry {
                    odometry.speed = f32::NAN;
                }
            }
        }
    }
}

impl Host for Bare {
    fn receive(&mut self, bytes: &[u8], now: u64) {
        self.session.receive(bytes, now);
        while let Some(event) = self.session.next_event() {
            let Event::Information { information, .. } = event else {
                continue;
            };
            let mut observation = self.base.observe(&information, Instant(now));
            self.corrupt(&mut observation);
            let decision = self.controller.tick(&observation);
            self.mode = Some(decision.mode);
            let (speed, turn) = (decision.command.speed(), decision.command.turn_rate());
            let degrees = (f64::from(turn) / 1000.0).to_degrees() as i32;
            self.session.command(speed, degrees, now);
        }
    }

    fn poll(&mut self, now: u64) -> Option<Output> {
        self.session.poll(now)
    }

    fn mode(&self) -> Option<&'static str> {
        self.mode
    }
}

/// A room in which somebody comes at the robot again and again, as `seed` has it.
fn scenario(
    seed: u64,
    mode: &str,
    haste: f64,
    config: &RobotConfig,
) -> Result<Scenario, Box<dyn Error>> {
    let mut random = Random(seed);
    let mut between =
        |low: f64, high: f64| low + (high - low) * (f64::from(random.signed()) + 1.0) / 2.0;
    let knobs = Knobs {
        seed,
        ..Knobs::default()
    };
    let mut scenario = Scenario::named("empty-room", &knobs)?;
    let mut world = World::new();
    world.add_room(Point::new(-2.5, -2.5), Point::new(4.5, 2.5))?;
    let bearing = between(-0.8, 0.8);
    let distance = between(2.0, 3.5);
    world.add_person(Person::new(Motion::Walk {
        start: Point::new(distance * bearing.cos(), distance * bearing.sin()),
        speed: f64::from(config.core.obstacle_speed_max) * between(0.5, 1.0) * haste,
        acceleration: between(0.5, 4.0),
        delay: between(2.0, 7.0),
        habit: Habit::Charge,
        seed,
    })?);
    scenario.world = world;
    scenario.start = Pose::new(0.0, 0.0, 0.0);
    let way = if mode == "arrived" { 0.7 } else { 3.4 };
    scenario.goal = Point::new(way, between(-0.3, 0.3));
    scenario.robot.base.radius = config.core.robot_radius.into();
    Ok(scenario)
}

/// Runs one fault in one mode with one seed.
fn run(
    case: &Case,
    mode: &str,
    preset: &RobotConfig,
    seed: u64,
    cell: &mut Cell,
) -> Result<(), Box<dyn Error>> {
    let mut told = settings(preset, false, None);
    let mut config = *preset;
    if let Fault::DeclaredBraking(share) = case.fault {
        // The base is set as ever, and brakes less: the configuration says so.
        let parameters = Parameters {
            braking: (f64::from(preset.core.braking) * share) as f32,
            ..*preset.core.parameters()
        };
        match Config::new(parameters) {
            Ok(core) => config.core = core,
            Err(error) => {
                cell.refused = Some(error.to_string());
                return Ok(());
            }
        }
        let braking = settings(preset, false, None).deceleration_mm_s2;
        told = settings(&config, false, None);
        told.deceleration_mm_s2 = braking;
    }
    let haste = match case.fault {
        Fault::Haste(haste) => haste,
        _ => 1.0,
    };
    let scenario = scenario(seed, mode, haste, &config)?;
    if let Fault::NotANumber(_) = case.fault {
        let host = Bare::new(&scenario, &config)?;
        let ride = Ride::new(scenario.simulate()?, host, GOOD_LINE, seed)?;
        strike_and_judge(ride, case, mode, &config, seed, cell, |ride| {
            if let Fault::NotANumber(corruption) = case.fault {
                ride.host.corruption = Some((corruption, one_of_16(seed)));
            }
        })
    } else {
        let host = pilot(&scenario, &config, told, Avoid::new(config.core))?;
        let ride = Ride::new(scenario.simulate()?, host, GOOD_LINE, seed)?;
        strike_and_judge(ride, case, mode, &config, seed, cell, |_| {})
    }
}

fn one_of_16(seed: u64) -> usize {
    (seed % 16) as usize
}

fn strike_and_judge<H: Host>(
    mut ride: Ride<H>,
    case: &Case,
    mode: &str,
    config: &RobotConfig,
    seed: u64,
    cell: &mut Cell,
    strike_host: impl Fn(&mut Ride<H>),
) -> Result<(), Box<dyn Error>> {
    // Not always at the very beginning of the mode.
    let mut wait = Random(!seed).below(60);
    while ride.host.mode() != Some(mode) || wait > 0 {
        if ride.now() >= PATIENCE {
            return Ok(());
        }
        ride.step();
        if ride.host.mode() == Some(mode) {
            wait = wait.saturating_sub(1);
        }
    }
    strike(&mut ride, case.fault, seed)?;
    strike_host(&mut ride);
    let struck = ride.now();
    let driven = ride.simulation.outcome().travelled;
    let mut stall_at = struck;
    while ride.now() < struck + AFTERMATH {
        if let Fault::Stall(ms) = case.fault
            && ride.now() >= stall_at
        {
            ride.stall(ms);
            stall_at = ride.now() + ms + STALL_PERIOD;
        }
        ride.step();
    }
    let outcome = ride.simulation.outcome();
    cell.struck += 1;
    cell.driven += outcome.travelled - driven;
    let broken = ride.simulation.truth().broken(&assumptions(config));
    for assumption in &broken {
        *cell.broken.entry(assumption.name()).or_default() += 1;
    }
    let contacts = ride.simulation.moving_contacts();
    let driving = contacts
        .iter()
        .find(|contact| contact.activity == Activity::Driving);
    if let Some(contact) = driving.or(contacts.first()) {
        cell.failed += 1;
        cell.turning_only += u64::from(driving.is_none());
        cell.failed_unexplained += u64::from(broken.is_empty());
        if cell.first.is_none() {
            let mut what = format!(
                "struck at {:.2} s; {}",
                struck as f64 / 1000.0,
                describe(contact)
            );
            for assumption in &broken {
                let _ = write!(what, "; broken: {assumption}");
            }
            cell.first = Some((seed, what));
        }
    } else if outcome.contacts_at_rest.people > 0 {
        cell.touched_at_rest += 1;
    }
    Ok(())
}

/// Breaks what is to break on the robot's side and on the line.
fn strike<H: Host>(ride: &mut Ride<H>, fault: Fault, seed: u64) -> Result<(), sidestep_sim::Error> {
    let broken = |failure| sonar::Faults {
        failure: Some(failure),
        ..GOOD_SONAR
    };
    let ring = ride.simulation.robot_mut().ring_mut();
    match fault {
        Fault::Sonars(faults) => ring.set_faults(faults),
        Fault::OneSonar(failure) => ring.set_faults_of(one_of_16(seed), broken(failure)),
        Fault::AllSonars(failure) => ring.set_faults(broken(failure)),
        Fault::Line(to_host, to_robot) => ride.set_line(to_host, to_robot),
        Fault::Drive(faults) => ride.simulation.robot_mut().base_mut().set_faults(faults),
        Fault::DeclaredBraking(braking_share) => {
            let faults = drive::Faults {
                braking_share,
                ..drive::Faults::default()
            };
            ride.simulation.robot_mut().base_mut().set_faults(faults)
        }
        Fault::NotANumber(_) | Fault::Stall(_) | Fault::Haste(_) => Ok(()),
    }
}

/// The results, by preset, fault and mode in the order of [`PRESETS`], [`CASES`] and [`MODES`].
#[derive(Clone, Debug)]
pub struct Table {
    /// Runs tried for each cell.
    pub seeds: u64,
    cells: Vec<Cell>,
}

/// The place of a cell: preset, fault, mode.
fn place(index: usize) -> (usize, usize, usize) {
    let row = index / MODES.len();
    (row / CASES.len(), row % CASES.len(), index % MODES.len())
}

/// Runs every fault in every mode with every preset, each with `seeds` seeds, in `threads` threads;
/// `progress` is told how many of how many cells are done.
///
/// # Errors
/// If a run could not be made.
pub fn run_all(
    seeds: u64,
    threads: usize,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<Table, Box<dyn Error>> {
    let mut presets = Vec::new();
    for name in PRESETS {
        let parameters = config::preset(name).ok_or("a preset is missing")?;
        presets.push(RobotConfig {
            core: Config::new(parameters)?,
            ..RobotConfig::default()
        });
    }
    let count = PRESETS.len() * CASES.len() * MODES.len();
    let next = AtomicUsize::new(0);
    let cells = Mutex::new(vec![Cell::default(); count]);
    let work = || -> Result<(), String> {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return Ok(());
            }
            progress(index, count);
            let (preset, case, mode) = place(index);
            let mut cell = Cell::default();
            for seed in 0..seeds {
                run(&CASES[case], MODES[mode], &presets[preset], seed, &mut cell)
                    .map_err(|error| format!("{}: {error}", CASES[case].name))?;
            }
            let mut cells = cells.lock().map_err(|_| "a run failed")?;
            cells[index] = cell;
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| {
            let done = worker.join().map_err(|_| "a run failed".to_owned());
            done.and_then(|result| result)
        })
    })?;
    let cells = cells.into_inner().map_err(|_| "a run failed")?;
    Ok(Table { seeds, cells })
}

impl Table {
    /// The cell of a preset, a fault and a mode, by name.
    #[must_use]
    pub fn cell(&self, preset: &str, fault: &str, mode: &str) -> Option<&Cell> {
        self.cells().find_map(|(p, case, m, cell)| {
            (p == preset && case.name == fault && m == mode).then_some(cell)
        })
    }

    /// Every cell with its preset, fault and mode.
    pub fn cells(
        &self,
    ) -> impl Iterator<Item = (&'static str, &'static Case, &'static str, &Cell)> {
        self.cells.iter().enumerate().map(|(index, cell)| {
            let (preset, case, mode) = place(index);
            (PRESETS[preset], &CASES[case], MODES[mode], cell)
        })
    }

    /// Runs in which the robot was in contact while it moved although the fault was within the
    /// bounds, or although every assumption held: what must not be.
    #[must_use]
    pub fn failures(&self) -> u64 {
        let failures = self.cells().map(|(_, case, _, cell)| {
            if case.within_bounds {
                cell.failed
            } else {
                cell.failed_unexplained
            }
        });
        failures.sum()
    }

    /// The table in Markdown, with the findings under it.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!(
            "# Faults\n\n\
             Each fault strikes while the law is in a mode and lasts; somebody charges at the robot \
             again and again in a small room. A cell tells of up to {} runs, those in which the mode \
             was reached. *At rest before contact*: in none of them was the robot, moving, in contact \
             with anything; in brackets the runs, and those in which it was touched at rest. Under \
             *bounds* stands whether the shield's assumptions hold in spite of the fault, or the \
             core can see it.\n",
            self.seeds
        );
        let mut findings: Vec<String> = Vec::new();
        for (index, (preset, case, mode, cell)) in self.cells().enumerate() {
            if index % (CASES.len() * MODES.len()) == 0 {
                let _ = write!(text, "\n## {preset}\n\n| fault | bounds |");
                for mode in MODES {
                    let _ = write!(text, " {mode} |");
                }
                text += "\n|---|---|---|---|---|---|---|\n";
            }
            if mode == MODES[0] {
                let bounds = if case.within_bounds {
                    "within"
                } else {
                    "beyond"
                };
                let _ = write!(text, "| {} | {bounds} |", case.name);
            }
            let _ = write!(text, " {} |", show(cell, findings.len() + 1));
            if let Some((seed, what)) = &cell.first {
                let bounds = match (case.within_bounds, cell.failed_unexplained) {
                    (true, _) => " (within the bounds)".to_owned(),
                    (false, 0) => String::new(),
                    (false, n) => format!(" ({n} with every assumption held)"),
                };
                findings.push(format!(
                    "{preset}, {}, {mode}: {}{bounds}. Seed {seed}: {what}",
                    case.name,
                    in_contact(cell)
                ));
            }
            if mode == MODES[MODES.len() - 1] {
                text += "\n";
            }
        }
        text += "\n## Findings\n\n";
        if findings.is_empty() {
            text += "None.\n";
        }
        for (finding, number) in findings.iter().zip(1..) {
            let _ = writeln!(text, "{number}. {finding}");
        }
        text
    }
}

/// How often the robot was in contact while it moved.
fn in_contact(cell: &Cell) -> String {
    format!(
        "of {} runs {} in contact while driving, {} while turning in place",
        cell.struck,
        cell.failed - cell.turning_only,
        cell.turning_only
    )
}

fn show(cell: &Cell, finding: usize) -> String {
    if let Some(reason) = &cell.refused {
        return format!("configuration refused: {reason}");
    }
    if cell.struck == 0 {
        return "mode not reached".to_owned();
    }
    if cell.failed > 0 {
        return format!("finding {finding}: {}", in_contact(cell));
    }
    format!(
        "at rest before contact ({}, {} touched)",
        cell.struck, cell.touched_at_rest
    )
}
