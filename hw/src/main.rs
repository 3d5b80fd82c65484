//! The program `sidestep`.

use clap::{Parser, Subcommand};
use sidestep::gesture::{self, Model};
use sidestep::law::Law;
use sidestep_hw::announce::Announcer;
use sidestep_hw::base;
use sidestep_hw::config::{self, RobotConfig, Sonars};
use sidestep_hw::coverage;
use sidestep_hw::decide;
use sidestep_hw::demo::{self, Options};
use sidestep_hw::drive::{self, Clock, Ending, Signals, Status};
use sidestep_hw::edge;
use sidestep_hw::emulate::{Line, Link, serve};
use sidestep_hw::faults;
use sidestep_hw::gestures;
use sidestep_hw::meet::{self, Meeting, Watch};
use sidestep_hw::pilot::{Pilot, settings, usual_law};
use sidestep_hw::replay::{self, Columns};
use sidestep_hw::skeletons::Lines;
use sidestep_hw::{log, transport};
use sidestep_sim::scenario::{Knobs, NAMES, Scenario};
use sidestep_sim::sonar::Faults;
use std::error::Error;
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;

/// Collision avoidance for a robot base with sonars, under a shield that is proved to stop in time.
///
/// Start with `sidestep demo`: it needs no hardware. Then `sidestep config > robot.toml`, read it,
/// measure your robot, and `sidestep run --port /dev/ttyUSB0 --config robot.toml --goal 3,0`.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Drive a simulated robot among simulated people, over a real pseudo-terminal.
    ///
    /// Leaves a folder with picture.svg, log.jsonl and summary.txt. Fails if the robot touched
    /// anything while it moved.
    ///
    /// Scenarios: fig12 (the three of S1's Figure 12, the default), fig12-head-on, fig12-crossing,
    /// fig12-from-side, head-on-80 (a person at 80 cm/s), lab (a room with chair and table),
    /// corridor (10 m between walls 1.2 m apart), corridor-walker (the same with somebody coming),
    /// empty-room, blocked-way (somebody in the way who leaves after a while), hotel (recorded
    /// people; needs --data), approach (somebody comes straight at the robot in S2's laboratory), decide
    /// (the same with S2's decision, its Table 1 and a noisy sonar; leaves timeline.svg too: belief,
    /// decision and distance over time), edge (S4: a planned way through
    /// corridors with three obstacles, and a classical detector on the same way; no pseudo-terminal
    /// and no log), coverage (every edge of a floor, some of them blocked, by S4 with a laser;
    /// likewise; --data FILE for a floor of your own), valley (S3's Figures 8 and 9: people are asked,
    /// lead the robot or let it choose, and are passed; in virtual time, without a log), gesture
    /// (somebody leads the robot by gestures, S3 Fig. 8).
    Demo {
        /// What to show.
        #[arg(default_value = demo::FIG12)]
        scenario: String,
        /// The ETH recording obsmat.txt, for the scenario hotel; a floor (TOML), for coverage.
        #[arg(long, value_name = "FILE")]
        data: Option<PathBuf>,
        /// Where in the recording to start, seconds.
        #[arg(long, default_value_t = 0.0)]
        start_time: f64,
        /// Seed of all noise.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Share of echoes that get lost, 0 to 1.
        #[arg(long, default_value_t = 0.02)]
        dropout: f64,
        /// Share of readings that are false echoes, 0 to 1: none, but 0.01 for decide.
        #[arg(long)]
        false_echo: Option<f64>,
        /// People walk on even into a robot that stands still.
        #[arg(long)]
        inconsiderate: bool,
        /// A command that speaks what the robot says, such as espeak-ng; it gets the words as its last
        /// argument.
        #[arg(long, value_name = "COMMAND")]
        speech: Option<String>,
        /// How much faster than real time.
        #[arg(long, default_value_t = 4.0)]
        speed: f64,
        /// Where to make the run folders.
        #[arg(long, default_value = "runs", value_name = "FOLDER")]
        out: PathBuf,
        /// The robot's configuration.
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
    },
    /// Drive a real base to a goal. Ctrl-C stops the robot and ends the session.
    Run {
        /// A serial port such as /dev/ttyUSB0, or tcp:HOST:PORT.
        #[arg(long)]
        port: String,
        /// The robot's configuration; see `sidestep config`.
        #[arg(long, value_name = "FILE")]
        config: PathBuf,
        /// The goal in metres, x forward and y left of where the robot starts.
        #[arg(long, value_name = "X,Y", value_parser = goal, allow_hyphen_values = true)]
        goal: [f32; 2],
        /// The serial port's baud rate; found out if not given.
        #[arg(long)]
        baud: Option<u32>,
        /// Where to write the log.
        #[arg(long, default_value = "sidestep-log.jsonl", value_name = "FILE")]
        log: PathBuf,
        /// Meet people by S3's law: where skeletons come from. - is standard input, tcp:HOST:PORT a
        /// server, else a file or a named pipe; one line of JSON a picture, see `sidestep gestures`.
        /// The log does not replay: it does not hold the pictures.
        #[arg(long, value_name = "SOURCE", requires = "meeting")]
        people: Option<String>,
        /// S3's parameters; see `sidestep config --meeting`.
        #[arg(long, value_name = "FILE")]
        meeting: Option<PathBuf>,
        /// What speaks: a command that gets the words as its last argument, such as "espeak-ng -s 130".
        #[arg(long, value_name = "COMMAND")]
        speech: Option<String>,
    },
    /// Be the robot: a simulated base for other hosts, on a pseudo-terminal or a TCP port.
    Emulate {
        /// Make PATH a link to a pseudo-terminal.
        #[arg(long, value_name = "PATH", conflicts_with = "tcp")]
        pty: Option<PathBuf>,
        /// Listen on ADDRESS, such as 127.0.0.1:8101.
        #[arg(long, value_name = "ADDRESS", required_unless_present = "pty")]
        tcp: Option<String>,
        /// The scenario around the robot; see `sidestep demo --help`.
        #[arg(long, default_value = NAMES[0])]
        scenario: String,
        /// Seed of all noise.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// End by itself after this many seconds.
        #[arg(long)]
        seconds: Option<f64>,
    },
    /// Run the controller again on a recorded log, or on a CSV of sonar ranges.
    ///
    /// A log must give the very same commands; if not, the first difference is shown and the exit
    /// code is 1. A CSV has one row of ranges in metres per sample.
    Replay {
        /// A log (log.jsonl) or a .csv file.
        file: PathBuf,
        /// How the columns of a CSV become sonars.
        #[arg(long, value_enum, default_value = "thirds")]
        columns: Columns,
        /// Pretended time between two rows of a CSV, ms.
        #[arg(long, default_value_t = 100)]
        period: u64,
        /// The configuration for a CSV.
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
    },
    /// Let every fault of sensors, line, loop and base strike in every mode with every preset.
    ///
    /// Prints a table: at rest before contact, or what happened. Fails if the robot was in contact
    /// while it moved although the shield's assumptions held.
    Faults {
        /// Runs for each fault in each mode with each preset.
        #[arg(long, default_value_t = 60)]
        seeds: u64,
        /// Write the table to FILE instead.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Recognise gestures in skeletons that a depth camera's program gives as lines of JSON.
    ///
    /// One line is one frame: {"t": 41730, "people": [{"id": 7, "neck": [0.12, 0.31, 2.4],
    /// "left_shoulder": [..], "right_shoulder": [..], "left_elbow": [..], "right_elbow": [..],
    /// "left_wrist": [..], "right_wrist": [..]}]}, with t in ms of the camera's clock and points in
    /// metres, x to the camera's left, y up, z ahead. Left and right are the person's own; a joint
    /// that is not tracked is left out.
    ///
    /// Prints a line of JSON whenever what somebody shows, or what counts, changes. `demo gesture`
    /// leaves a file to try.
    Gestures {
        /// Where skeletons come from: - is standard input, tcp:HOST:PORT a server, else a file.
        source: String,
        /// Which of S3's two models recognises.
        #[arg(long, value_enum, default_value = "net")]
        model: ModelName,
        /// Frames in a row after which a gesture counts, 1 to 60.
        #[arg(long, default_value_t = gesture::Settings::default().frames)]
        frames: u32,
        /// The same for stop.
        #[arg(long, default_value_t = gesture::Settings::default().stop_frames)]
        stop_frames: u32,
    },
    /// Print the default configuration, commented.
    Config {
        /// The parameters of S3's law instead.
        #[arg(long)]
        meeting: bool,
    },
}

/// S3's two models.
#[derive(Clone, Copy, clap::ValueEnum)]
enum ModelName {
    /// The back-propagation net.
    Net,
    /// The linear support vector machine.
    Svm,
}

impl From<ModelName> for gesture::Model {
    fn from(name: ModelName) -> Self {
        match name {
            ModelName::Net => Self::NEURAL_NETWORK,
            ModelName::Svm => Self::SUPPORT_VECTOR_MACHINE,
        }
    }
}

fn goal(text: &str) -> Result<[f32; 2], String> {
    let wrong = || format!("{text:?} is not X,Y in metres, each within ±1000");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| {
        text.trim()
            .parse::<f32>()
            .ok()
            .filter(|number| number.abs() <= 1000.0)
            .ok_or_else(wrong)
    };
    Ok([number(x)?, number(y)?])
}

fn read_config(file: Option<&Path>) -> Result<RobotConfig, Box<dyn Error>> {
    let Some(file) = file else {
        return Ok(RobotConfig::default());
    };
    let text =
        std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(config::parse(&text, &file.display().to_string())?)
}

/// Interrupted by Ctrl-C and by SIGTERM, reset by a line on standard input.
static SIGNALS: Signals = Signals::new();

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let handler = ctrlc::set_handler(|| SIGNALS.interrupted.store(true, Ordering::Relaxed));
    if let Err(error) = handler {
        // Without it Ctrl-C would end the program with the robot still under way.
        eprintln!("sidestep: cannot catch Ctrl-C: {error}");
        return ExitCode::FAILURE;
    }
    // Standard input may be what skeletons come from.
    let taken = match &arguments.command {
        Command::Gestures { .. } => true,
        Command::Run { people, .. } => people.as_deref() == Some("-"),
        _ => false,
    };
    if !taken {
        // Ends with the program.
        std::thread::spawn(|| SIGNALS.listen());
    }
    match run(arguments.command) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("sidestep: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<ExitCode, Box<dyn Error>> {
    match command {
        Command::Demo {
            scenario,
            data,
            start_time,
            seed,
            dropout,
            false_echo,
            inconsiderate,
            speech,
            speed,
            out,
            config,
        } => {
            if !(0.1..=20.0).contains(&speed) {
                return Err(format!("--speed is {speed}, allowed is 0.1 to 20").into());
            }
            let decides = scenario == decide::NAME;
            let knobs = Knobs {
                seed,
                courteous: !inconsiderate,
                sonar_faults: Faults {
                    dropout,
                    false_echo: false_echo.unwrap_or(if decides { 0.01 } else { 0.0 }),
                    ..Faults::default()
                },
                ..Knobs::default()
            };
            let options = Options {
                scenario,
                data,
                start_time,
                knobs,
                speed,
                out,
                config: match config {
                    None if decides => decide::table_1()?,
                    config => read_config(config.as_deref())?,
                },
            };
            if options.scenario == gestures::DEMO {
                gestures::demo(&options, speech.as_deref(), &SIGNALS)?;
                return Ok(ExitCode::SUCCESS);
            }
            run_demo(&options)
        }
        Command::Run {
            port,
            config,
            goal,
            baud,
            log,
            people,
            meeting,
            speech,
        } => {
            let config = read_config(Some(&config))?;
            let run = Errand {
                port,
                config,
                goal,
                baud,
                log,
            };
            let Some(source) = people else {
                return match config.sonars {
                    Sonars::Front8 => run_base::<8>(&run),
                    Sonars::All16 => run_base::<16>(&run),
                };
            };
            let file = meeting.ok_or("--people needs --meeting")?;
            let text = std::fs::read_to_string(&file)
                .map_err(|error| format!("{}: {error}", file.display()))?;
            let meeting = Meeting::parse(&text, &file.display().to_string())?;
            let speech = speech.as_deref();
            match config.sonars {
                Sonars::Front8 => meet_people::<8>(&run, &meeting, &source, speech),
                Sonars::All16 => meet_people::<16>(&run, &meeting, &source, speech),
            }
        }
        Command::Emulate {
            pty,
            tcp,
            scenario,
            seed,
            seconds,
        } => emulate(pty.as_deref(), tcp.as_deref(), &scenario, seed, seconds),
        Command::Replay {
            file,
            columns,
            period,
            config,
        } => {
            if file.extension().is_some_and(|extension| extension == "csv") {
                replay_table(&file, columns, period, &read_config(config.as_deref())?)
            } else {
                replay_log(&file)
            }
        }
        Command::Faults { seeds, out } => run_faults(seeds, out.as_deref()),
        Command::Gestures {
            source,
            model,
            frames,
            stop_frames,
        } => {
            let settings = gesture::Settings {
                frames,
                stop_frames,
                ..gesture::Settings::default()
            };
            let lines = Lines::open(&source)?;
            let clock = Clock::new(1.0);
            let mut out = std::io::stdout().lock();
            gestures::watch(lines, model.into(), settings, || clock.now(), &mut out)?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Config { meeting } => {
            if meeting {
                print!("{}", meet::default_toml());
            } else {
                print!("{}", config::default_toml());
            }
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Says where a run's picture is.
fn keep_picture(status: &mut Status, folder: &Path) {
    let picture = folder.join("picture.svg");
    status.keep(&format!("picture: {}\n", picture.display()));
}

fn run_demo(options: &Options) -> Result<ExitCode, Box<dyn Error>> {
    let mut status = Status::default();
    match options.scenario.as_str() {
        edge::NAME => {
            edge::demo(options, &mut status)?;
            return Ok(ExitCode::SUCCESS);
        }
        decide::NAME => {
            let (folder, contacts) = decide::demonstrate(options, &SIGNALS, &mut status)?;
            keep_picture(&mut status, &folder);
            return touched(contacts);
        }
        coverage::demo::NAME => {
            let (folder, run) = coverage::demo::run(options, &mut status)?;
            keep_picture(&mut status, &folder);
            return touched(run.summary.contacts_while_moving());
        }
        demo::VALLEY => return touched(demo::valley(options, &mut status)?),
        _ => {}
    }
    let mut contacts = 0;
    for scenario in demo::scenarios(options)? {
        let (folder, summary) = demo::run(&scenario, options, &SIGNALS, &mut status)?;
        contacts += summary.contacts_while_moving();
        keep_picture(&mut status, &folder);
        if summary.ending == Ending::Operator {
            break;
        }
    }
    touched(contacts)
}

/// Success if nothing was touched while the robot moved.
fn touched(contacts: u32) -> Result<ExitCode, Box<dyn Error>> {
    if contacts > 0 {
        return Err(format!("the robot touched something {contacts} times while it moved").into());
    }
    Ok(ExitCode::SUCCESS)
}

fn run_faults(seeds: u64, out: Option<&Path>) -> Result<ExitCode, Box<dyn Error>> {
    let table = faults::run_all(seeds, 2, |done, count| {
        if done.is_multiple_of(20) {
            eprintln!("{done} of {count} cells");
        }
    })?;
    let text = table.markdown();
    match out {
        Some(file) => {
            std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))?
        }
        None => print!("{text}"),
    }
    match table.failures() {
        0 => Ok(ExitCode::SUCCESS),
        failures => Err(format!(
            "the robot was in contact while it moved in {failures} runs in which that was not to be"
        )
        .into()),
    }
}

/// A drive of a real base.
struct Errand {
    port: String,
    config: RobotConfig,
    goal: [f32; 2],
    baud: Option<u32>,
    log: PathBuf,
}

impl Errand {
    /// Drives a pilot with this law; `attend` is called again and again.
    fn drive<L: Law<N>, const N: usize>(
        &self,
        law: L,
        attend: impl FnMut(&mut Pilot<L, N>, u64),
    ) -> Result<ExitCode, Box<dyn Error>> {
        let log = &self.log;
        // A log of an earlier run is somebody's record: never written over.
        let file =
            File::create_new(log).map_err(|error| format!("log {}: {error}", log.display()))?;
        let serial = !self.port.starts_with("tcp:");
        let mut pilot = Pilot::<L, N>::with_law(
            law,
            self.config,
            self.goal,
            settings(&self.config, serial, self.baud),
            Box::new(BufWriter::new(file)),
        )?;
        let mut status = Status::default();
        let ending = drive::run_attended(
            &mut pilot,
            || transport::open(&self.port),
            Clock::new(1.0),
            None,
            &SIGNALS,
            &mut status,
            attend,
        )
        .inspect_err(|_| {
            // Nothing was driven: an empty log would only stand in the way of the next try.
            let _ = std::fs::remove_file(log);
        })?;
        if let Some(error) = pilot.log_error() {
            return Err(format!("log {}: not complete: {error}", log.display()).into());
        }
        let tally = pilot.tally();
        let stops: Vec<String> = tally
            .stops
            .iter()
            .map(|(kind, count)| format!("{kind} {count}"))
            .collect();
        status.keep(&format!(
            "ended: {ending:?}; {} ticks; stops: {}; log: {}",
            tally.ticks,
            if stops.is_empty() {
                "none".to_owned()
            } else {
                stops.join(", ")
            },
            log.display()
        ));
        Ok(if ending == Ending::Arrived {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(2)
        })
    }
}

fn run_base<const N: usize>(errand: &Errand) -> Result<ExitCode, Box<dyn Error>> {
    let law = usual_law(errand.config.core, base::ring::<N>(&errand.config)?);
    errand.drive(law, |_, _| {})
}

/// Among people, by S3's law.
fn meet_people<const N: usize>(
    errand: &Errand,
    meeting: &Meeting,
    source: &str,
    speech: Option<&str>,
) -> Result<ExitCode, Box<dyn Error>> {
    let law = meeting.law::<N>(&errand.config)?;
    let mut watch = Watch::new(Lines::open(source)?, Model::default())?;
    let mut announcer = Announcer::new(speech);
    let mut out = std::io::stdout();
    errand.drive(law, |pilot: &mut Pilot<_, N>, now| {
        meet::attend(pilot, &mut watch, &mut announcer, &mut out, now);
    })
}

fn emulate(
    pty: Option<&Path>,
    tcp: Option<&str>,
    scenario: &str,
    seed: u64,
    seconds: Option<f64>,
) -> Result<ExitCode, Box<dyn Error>> {
    let knobs = Knobs {
        seed,
        ..Knobs::default()
    };
    let scenario = Scenario::named(scenario, &knobs)?;
    let simulation = scenario.simulate()?;
    let [x, y] = demo::goal_from_start(&scenario);
    let (line, _link) = match (pty, tcp) {
        (Some(path), _) => {
            let (line, name) = Line::pty()?;
            let link =
                Link::new(path, &name).map_err(|error| format!("{}: {error}", path.display()))?;
            println!("robot on {} ({name})", path.display());
            (line, Some(link))
        }
        (None, Some(address)) => {
            let (line, address) =
                Line::tcp(address).map_err(|error| format!("{address}: {error}"))?;
            println!("robot on tcp:{address}");
            (line, None)
        }
        (None, None) => return Err("give --pty PATH or --tcp ADDRESS".into()),
    };
    println!("{}; its goal is {x},{y}", scenario.description);
    let clock = Clock::new(1.0);
    let simulation = std::thread::scope(|scope| {
        let server = scope.spawn(|| serve(simulation, line, clock, &SIGNALS.interrupted));
        while !SIGNALS.interrupted.load(Ordering::Relaxed) {
            std::thread::sleep(std::time::Duration::from_millis(50));
            if seconds.is_some_and(|seconds| clock.now() as f64 >= seconds * 1000.0) {
                SIGNALS.interrupted.store(true, Ordering::Relaxed);
            }
        }
        server.join()
    })
    .map_err(|_| "the simulated robot failed")?;
    println!("{:#?}", simulation.outcome());
    Ok(ExitCode::SUCCESS)
}

fn replay_log(file: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let input = File::open(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let log =
        log::read(BufReader::new(input)).map_err(|error| format!("{}: {error}", file.display()))?;
    let replayed = replay::log(&log).map_err(|error| format!("{}: {error}", file.display()))?;
    if let Some(line) = log.cut {
        println!("the log ends in the middle of line {line}: replayed up to there");
    }
    match replayed.parting {
        None => {
            println!("{} ticks, every command the same", replayed.ticks);
            Ok(ExitCode::SUCCESS)
        }
        Some((line, logged, now)) => {
            println!(
                "they part at line {line}, tick {}:\n  logged {logged:?}\n  now    {now:?}",
                replayed.ticks
            );
            Ok(ExitCode::FAILURE)
        }
    }
}

fn replay_table(
    file: &Path,
    columns: Columns,
    period: u64,
    config: &RobotConfig,
) -> Result<ExitCode, Box<dyn Error>> {
    let text =
        std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let table = replay::table(&text, columns, config, period)
        .map_err(|error| format!("{}: {error}", file.display()))?;
    println!("{table:#?}");
    Ok(if table.near_but_moving == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
