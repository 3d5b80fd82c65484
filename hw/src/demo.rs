//! The demonstration: a simulated robot on a real pseudo-terminal, driven through the serial
//! stack, watched, and drawn.

use crate::base;
use crate::config::RobotConfig;
use crate::draw::{Picture, Stop, draw};
use crate::drive::{self, Clock, Ending, Signals, Status};
use crate::emulate::{Line, serve};
use crate::encounter;
use crate::log::Halt;
use crate::pilot::{Pilot, Tally, USUAL_LAW, settings, usual_law};
use crate::transport;
use sidestep::arcos::BaseParameters;
use sidestep::law::Law;
use sidestep_sim::scenario::{Knobs, NAMES, Scenario};
use sidestep_sim::simulation::{Outcome, Simulation};
use std::error::Error;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// What the set of S1's Figure 12 is called.
pub const FIG12: &str = "fig12";

/// What the stories of S3's Figures 8 and 9 are called.
pub const VALLEY: &str = "valley";

/// What is demonstrated, and how.
#[derive(Clone, Debug)]
pub struct Options {
    /// A scenario's name, or [`FIG12`].
    pub scenario: String,
    /// The ETH recording, for the scenario `hotel`.
    pub data: Option<PathBuf>,
    /// Where in the recording to start, s.
    pub start_time: f64,
    /// Seed and faults.
    pub knobs: Knobs,
    /// How much faster than the wall's the clock runs.
    pub speed: f64,
    /// Where run folders are made.
    pub out: PathBuf,
    /// The configuration.
    pub config: RobotConfig,
}

/// What came of a scenario.
#[derive(Clone, Debug)]
pub struct Summary {
    /// How the run ended.
    pub ending: Ending,
    /// What the controller did.
    pub tally: Tally,
    /// What happened in the world.
    pub outcome: Outcome,
}

impl Summary {
    /// Contacts while the robot moved: what must not be.
    #[must_use]
    pub fn contacts_while_moving(&self) -> u32 {
        let driving = self.outcome.contacts_while_driving;
        let turning = self.outcome.contacts_while_turning;
        driving.people + driving.obstacles + turning.people + turning.obstacles
    }

    /// What came of it, in lines.
    #[must_use]
    pub fn text(&self, scenario: &Scenario) -> String {
        let mut text = String::new();
        let least = self.outcome.minimum_clearance_while_driving;
        let clearance = |metres: f64| {
            if metres.is_finite() {
                format!("{metres:.2} m")
            } else {
                "none near".to_owned()
            }
        };
        let _ = writeln!(
            text,
            "scenario: {}: {}",
            scenario.name, scenario.description
        );
        let _ = match self.tally.arrived {
            Some(t) => writeln!(text, "goal reached: after {:.1} s", t as f64 / 1000.0),
            None => writeln!(text, "goal reached: no ({:?})", self.ending),
        };
        let _ = writeln!(
            text,
            "contacts while moving: {}; at rest: {}",
            self.contacts_while_moving(),
            self.outcome.contacts_at_rest.people + self.outcome.contacts_at_rest.obstacles
        );
        let _ = writeln!(
            text,
            "least clearance while moving: people {}, obstacles {}",
            clearance(least.people),
            clearance(least.obstacles)
        );
        let stops: Vec<String> = self
            .tally
            .stops
            .iter()
            .map(|(kind, count)| format!("{kind} {count}"))
            .collect();
        let stops = if stops.is_empty() {
            "none".to_owned()
        } else {
            stops.join(", ")
        };
        let _ = writeln!(text, "stops: {stops}");
        let _ = writeln!(
            text,
            "ticks: {}, longest pause between two {} ms, longest computation {} µs",
            self.tally.ticks, self.tally.worst_period, self.tally.worst_tick
        );
        text
    }
}

/// The scenarios that a name stands for.
///
/// # Errors
/// If there is none of that name, or its data cannot be read.
pub fn scenarios(options: &Options) -> Result<Vec<Scenario>, Box<dyn Error>> {
    let named = |name: &str| Scenario::named(name, &options.knobs);
    Ok(match options.scenario.as_str() {
        FIG12 => NAMES
            .iter()
            .filter(|name| name.starts_with(FIG12))
            .map(|name| named(name))
            .collect::<Result<_, _>>()?,
        "hotel" => {
            let data = options
                .data
                .as_deref()
                .ok_or("the scenario hotel needs --data FILE: the ETH recording obsmat.txt")?;
            vec![Scenario::hotel(data, options.start_time, &options.knobs)?]
        }
        name => vec![named(name)?],
    })
}

/// The goal of a scenario in the frame in which the robot starts.
#[must_use]
pub fn goal_from_start(scenario: &Scenario) -> [f32; 2] {
    let offset = scenario.goal - scenario.start.position;
    let (sin, cos) = scenario.start.heading.sin_cos();
    [
        (cos * offset.x + sin * offset.y) as f32,
        (cos * offset.y - sin * offset.x) as f32,
    ]
}

/// Tells S3's stories in virtual time: the robot meets people, speaks, waits, is told by a master or
/// chooses for itself, and passes. Leaves a folder with a picture and what happened for each, and
/// gives the number of contacts while the robot moved.
///
/// # Errors
/// If a story does not make a simulation, or the folder cannot be used.
pub fn valley(options: &Options, status: &mut Status) -> Result<u32, Box<dyn Error>> {
    let mut contacts = 0;
    for name in encounter::STORIES {
        let mut story = encounter::story(name, options.knobs.seed)?;
        story.scenario.sonar_faults = options.knobs.sonar_faults;
        let folder = run_folder(&options.out, &format!("valley-{name}"))?;
        status.keep(&format!("== {name}: {}", story.scenario.description));
        let met = encounter::run(&story, &options.config, sidestep::interact::USUAL, None)?;
        let mut text = String::new();
        for happening in &met.happenings {
            let seconds = happening.t as f64 / 1000.0;
            let _ = writeln!(text, "{seconds:7.1} s  {}", happening.text());
        }
        let outcome = &met.report.outcome;
        let least = outcome.minimum_clearance_while_driving.people;
        let touched = met.report.contacts.len() as u32;
        let _ = writeln!(
            text,
            "goal reached: {}; contacts while moving: {touched}; least clearance of people while \
             driving: {least:.2} m; stops of the shield: {}",
            if met.report.arrived { "yes" } else { "no" },
            met.stops.len()
        );
        status.keep(text.trim_end());
        fs::write(folder.join("summary.txt"), &text)?;
        let picture = folder.join("picture.svg");
        fs::write(&picture, met.picture())?;
        status.keep(&format!("picture: {}\n", picture.display()));
        contacts += touched;
    }
    Ok(contacts)
}

/// A folder that did not exist, named after a scenario and numbered.
///
/// # Errors
/// If no folder can be made.
pub fn run_folder(out: &Path, name: &str) -> std::io::Result<PathBuf> {
    fs::create_dir_all(out)?;
    let mut number = 1;
    loop {
        let folder = out.join(format!("{name}-{number:03}"));
        match fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(error),
        }
    }
}

/// Sets a flag when it goes out of scope.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A scenario that was run with some law.
pub struct Ran<L> {
    /// Its folder.
    pub folder: PathBuf,
    /// What came of it.
    pub summary: Summary,
    /// The world at the end.
    pub simulation: Simulation,
    /// The pilot at the end.
    pub pilot: Pilot<L, 16>,
}

/// Runs one scenario with the usual law in real time over a pseudo-terminal and leaves its run folder.
///
/// # Errors
/// If the pseudo-terminal, the port or the folder cannot be used.
pub fn run(
    scenario: &Scenario,
    options: &Options,
    signals: &Signals,
    status: &mut Status,
) -> Result<(PathBuf, Summary), Box<dyn Error>> {
    let law = usual_law(options.config.core, base::ring(&options.config)?);
    let ran = run_with(law, USUAL_LAW, scenario, options, signals, status)?;
    Ok((ran.folder, ran.summary))
}

/// The same with any law, which the log calls `name`.
///
/// # Errors
/// If the pseudo-terminal, the port or the folder cannot be used.
pub fn run_with<L: Law<16>>(
    law: L,
    name: &'static str,
    scenario: &Scenario,
    options: &Options,
    signals: &Signals,
    status: &mut Status,
) -> Result<Ran<L>, Box<dyn Error>> {
    let folder = run_folder(&options.out, scenario.name)?;
    let simulation = scenario.simulate()?;
    let (line, port) = Line::pty()?;
    status.keep(&format!(
        "== {}: {}\n   robot on {port}, log and picture in {}",
        scenario.name,
        scenario.description,
        folder.display()
    ));
    let log = BufWriter::new(File::create(folder.join("log.jsonl"))?);
    let mut pilot = Pilot::<_, 16>::with_law(
        law,
        options.config,
        goal_from_start(scenario),
        settings(&options.config, true, None),
        Box::new(log),
    )?;
    pilot.set_law_name(name);
    let clock = Clock::new(options.speed);
    let done = AtomicBool::new(false);
    let (ending, simulation) = std::thread::scope(|scope| {
        let server = scope.spawn(|| serve(simulation, line, clock, &done));
        // However driving ends, the simulated robot ends with it.
        let end = SetOnDrop(&done);
        let ending = drive::run(
            &mut pilot,
            || transport::open(&port),
            clock,
            Some(scenario.time_limit_ms),
            signals,
            status,
        );
        drop(end);
        (ending, server.join())
    });
    let simulation = simulation.map_err(|_| "the simulated robot failed")?;
    let summary = Summary {
        ending: ending?,
        tally: pilot.tally().clone(),
        outcome: simulation.outcome(),
    };
    leave(&folder, scenario, &simulation, &pilot, &summary)?;
    if let Some(error) = pilot.log_error() {
        return Err(format!("the log is not complete: {error}").into());
    }
    status.keep(&summary.text(scenario));
    Ok(Ran {
        folder,
        summary,
        simulation,
        pilot,
    })
}

/// Writes summary and picture.
fn leave<L: Law<16>>(
    folder: &Path,
    scenario: &Scenario,
    simulation: &Simulation,
    pilot: &Pilot<L, 16>,
    summary: &Summary,
) -> std::io::Result<()> {
    let text = summary.text(scenario);
    fs::write(folder.join("summary.txt"), &text)?;
    let stops: Vec<Stop> = pilot
        .stops()
        .iter()
        .map(|stop| Stop {
            t: stop.t,
            reason: stop.reason.to_string(),
        })
        .collect();
    let notes: Vec<String> = text.lines().skip(1).map(str::to_owned).collect();
    let picture = draw(&Picture {
        title: &format!("{}: {}", scenario.name, scenario.description),
        notes: &notes,
        world: simulation.world(),
        trace: simulation.trace(),
        goal: scenario.goal,
        robot_radius: f64::from(BaseParameters::P3DX.rear_mm) / 1000.0,
        stops: &stops,
    });
    fs::write(folder.join("picture.svg"), picture)
}

/// A scenario in virtual time: the same pilot and the same simulated robot, their bytes handed
/// over in memory. Gives the same result for the same seed, and a thousand of them take a minute.
///
/// # Errors
/// If the scenario does not make a simulation, or its goal is out of range.
pub fn run_in_memory<L: Law<16>>(
    scenario: &Scenario,
    config: &RobotConfig,
    law: L,
) -> Result<(Summary, Simulation), Box<dyn Error>> {
    run_watched(scenario, config, law, |_, _, _| false)
}

/// The same with a robot of `N` sonars and somebody who looks on, after every step: with the pilot,
/// the simulation, and the time in ms. The run ends when they say so.
///
/// # Errors
/// If the scenario does not make a simulation, or its goal is out of range.
pub fn run_watched<L: sidestep::law::Law<N>, const N: usize>(
    scenario: &Scenario,
    config: &RobotConfig,
    law: L,
    mut watch: impl FnMut(&mut Pilot<L, N>, &Simulation, u64) -> bool,
) -> Result<(Summary, Simulation), Box<dyn Error>> {
    let mut simulation = scenario.simulate()?;
    let mut pilot = Pilot::<L, N>::with_law(
        law,
        *config,
        goal_from_start(scenario),
        settings(config, false, None),
        Box::new(std::io::sink()),
    )?;
    let mut ending = Ending::TimeLimit;
    let mut now = 0;
    while now < scenario.time_limit_ms {
        now += sidestep_sim::STEP_MS;
        simulation.advance_to(now);
        let bytes = simulation.robot_mut().transmit();
        if !bytes.is_empty() {
            pilot.receive(&bytes, now);
        }
        while let Some(output) = pilot.poll(now) {
            if let crate::session::Output::Send(bytes) = output {
                simulation.robot_mut().receive(&bytes);
            }
        }
        while pilot.next_event().is_some() {}
        if watch(&mut pilot, &simulation, now) {
            break;
        }
        if pilot.tally().arrived.is_some() {
            ending = Ending::Arrived;
            break;
        }
    }
    pilot.halt(Halt::Operator, now);
    Ok((
        Summary {
            ending,
            tally: pilot.tally().clone(),
            outcome: simulation.outcome(),
        },
        simulation,
    ))
}
