//! The program as a user has it: its words, its exit codes, its files, and real time over TCP and
//! pseudo-terminals.

use sidestep_hw::config::default_toml;
use sidestep_hw::drive::Clock;
use sidestep_hw::emulate::{Line, serve};
use sidestep_hw::log::{self, Record};
use sidestep_hw::replay;
use sidestep_sim::robot::Session;
use sidestep_sim::scenario::{Knobs, NAMES, Scenario};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Longer than anything here takes, on a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(90);

/// A folder of a test's own, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("sidestep-program-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir(&path).unwrap();
        Self(path)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// A file of this folder with this text.
    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    fn config(&self) -> PathBuf {
        self.file("robot.toml", &default_toml())
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

fn sidestep(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sidestep"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Runs the program to its end.
fn run(arguments: &[&str]) -> Output {
    sidestep(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The program while it runs, killed when dropped.
struct Running {
    child: Child,
    lines: Arc<Mutex<Vec<String>>>,
}

impl Running {
    fn start(arguments: &[&str]) -> Self {
        let mut child = sidestep(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = Arc::default();
        let streams: [Box<dyn Read + Send>; 2] = [
            Box::new(child.stdout.take().unwrap()),
            Box::new(child.stderr.take().unwrap()),
        ];
        for stream in streams {
            let lines: Arc<Mutex<Vec<String>>> = Arc::clone(&lines);
            std::thread::spawn(move || {
                for line in BufReader::new(stream).lines().map_while(Result::ok) {
                    lines.lock().unwrap().push(line);
                }
            });
        }
        Self { child, lines }
    }

    fn said(&self) -> Vec<String> {
        self.lines.lock().unwrap().clone()
    }

    /// The first line with `wanted` in it, once it is there.
    fn wait_for(&self, wanted: &str) -> String {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Some(line) = self.said().iter().find(|line| line.contains(wanted)) {
                return line.clone();
            }
            assert!(
                Instant::now() < deadline,
                "no {wanted:?} in {:#?}",
                self.said()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn is_running(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Sends a signal, such as `INT` for Ctrl-C.
    fn signal(&self, signal: &str) {
        let id = self.child.id().to_string();
        let sent = Command::new("kill")
            .args([&format!("-{signal}"), &id])
            .status();
        assert!(sent.unwrap().success());
    }

    fn wait(&mut self) -> ExitStatus {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(
                Instant::now() < deadline,
                "still running: {:#?}",
                self.said()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A simulated robot on a TCP port, with nobody near before the goals used here are reached, and the
/// port as `run` takes it.
fn emulator(address: &str) -> (Running, String) {
    // It ends by itself should this test not be there to end it.
    let running = Running::start(&[
        "emulate",
        "--tcp",
        address,
        "--scenario",
        "fig12-from-side",
        "--seconds",
        "120",
    ]);
    let line = running.wait_for("robot on tcp:");
    let port = line.strip_prefix("robot on ").unwrap().to_owned();
    (running, port)
}

/// A log is whole and replays to the same decisions, by the library and by the program.
fn assert_replays(log: &Path) -> log::Log {
    let read = log::read(BufReader::new(std::fs::File::open(log).unwrap())).unwrap();
    assert_eq!(read.cut, None);
    let replayed = replay::log(&read).unwrap();
    assert_eq!(replayed.parting, None);
    let output = run(&["replay", text(log)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let expected = format!("{} ticks, every command the same", replayed.ticks);
    assert!(stdout(&output).contains(&expected), "{}", stdout(&output));
    read
}

/// The last thing that the robot was told, with the reason.
fn last_stop(log: &log::Log) -> Option<&str> {
    let told = log
        .records
        .iter()
        .rev()
        .find_map(|(_, record)| match record {
            Record::Tick { told, .. } | Record::Halt { told, .. } => Some(told),
            Record::Origin { .. } | Record::Reset { .. } | Record::Event { .. } => None,
        });
    told.and_then(|told| told.stop.as_deref())
}

#[test]
fn help_teaches() {
    let cases: [(&[&str], &[&str]); 6] = [
        (
            &["--help"],
            &[
                "demo",
                "run",
                "emulate",
                "replay",
                "config",
                "sidestep demo",
                "sidestep config",
            ],
        ),
        (
            &["demo", "--help"],
            &[
                "picture.svg",
                "log.jsonl",
                "summary.txt",
                "--speed",
                "--seed",
                "--out",
                "--data",
                "hotel",
                "obsmat.txt",
                "fig12",
            ],
        ),
        (
            &["run", "--help"],
            &[
                "--port",
                "/dev/ttyUSB0",
                "tcp:HOST:PORT",
                "--config",
                "--goal",
                "metres",
                "--baud",
                "--log",
                "Ctrl-C",
            ],
        ),
        (
            &["emulate", "--help"],
            &[
                "--pty",
                "--tcp",
                "127.0.0.1:8101",
                "--scenario",
                "--seconds",
            ],
        ),
        (
            &["replay", "--help"],
            &[
                "log.jsonl",
                "CSV",
                "thirds",
                "ring",
                "--period",
                "exit code",
            ],
        ),
        (&["config", "--help"], &["default configuration"]),
    ];
    for (arguments, words) in cases {
        let output = run(arguments);
        assert!(output.status.success(), "{arguments:?}");
        let help = stdout(&output);
        for word in words {
            assert!(help.contains(word), "{arguments:?} lacks {word:?}:\n{help}");
        }
    }
    let demo = stdout(&run(&["demo", "--help"]));
    for name in NAMES {
        assert!(demo.contains(name), "{name}:\n{demo}");
    }
    let version = stdout(&run(&["--version"]));
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = Folder::new();
    let config = folder.config();
    let out = folder.path("runs");
    let cases: [(&[&str], &str); 9] = [
        (&[], "Usage"),
        (&["dance"], "dance"),
        (&["run", "--port", "x"], "--config"),
        (
            &[
                "run",
                "--port",
                "x",
                "--config",
                text(&config),
                "--goal",
                "3",
            ],
            "X,Y",
        ),
        (
            &[
                "run",
                "--port",
                "x",
                "--config",
                text(&config),
                "--goal",
                "3,NaN",
            ],
            "X,Y",
        ),
        (&["emulate"], "--tcp"),
        (
            &["emulate", "--tcp", "127.0.0.1:0", "--scenario", "moon"],
            "moon",
        ),
        (&["demo", "moon", "--out", text(&out)], "fig12-head-on"),
        (&["demo", "hotel", "--out", text(&out)], "--data"),
    ];
    for (arguments, expected) in cases {
        let output = run(arguments);
        assert!(!output.status.success(), "{arguments:?}");
        let message = stderr(&output);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    for speed in ["0", "-1", "1000", "NaN"] {
        let speed = format!("--speed={speed}");
        let output = run(&["demo", &speed, "--out", text(&out)]);
        assert!(!output.status.success());
        let message = stderr(&output);
        assert!(message.contains("allowed is 0.1 to 20"), "{message}");
    }
    assert_eq!(folder.names(), ["robot.toml"]);
}

#[test]
fn the_printed_configuration_is_one() {
    let output = run(&["config"]);
    assert!(output.status.success());
    let printed = stdout(&output);
    let folder = Folder::new();
    let config = folder.file("robot.toml", &printed);
    // Every line has its effect, and none has another than leaving it out.
    let row = "4.0,".repeat(23) + "4.0\n";
    let table = folder.file("table.csv", &(row.repeat(20) + &row.replace("4.0", "0.3")));
    let [with, without] = [&["--config", text(&config)][..], &[]].map(|arguments| {
        let output = run(&[&["replay", text(&table)], arguments].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    });
    assert_eq!(with, without);
    assert!(with.contains("rows: 21"), "{with}");
    // One changed line changes what comes of it.
    let faster = printed.replace("cruise_speed = \"0.2 m/s\"", "cruise_speed = \"0.3 m/s\"");
    assert_ne!(faster, printed);
    let config = folder.file("faster.toml", &faster);
    let output = run(&["replay", text(&table), "--config", text(&config)]);
    assert_ne!(stdout(&output), without);
}

#[test]
fn a_bad_configuration_starts_nothing() {
    let folder = Folder::new();
    let log = folder.path("log.jsonl");
    let out = folder.path("runs");
    for (line, parts) in [
        ("warp = \"9 m/s\"", ["unknown key warp", "sidestep config"]),
        (
            "speed_max = \"40 cm\"",
            ["speed_max is \"40 cm\"", "m/s, cm/s, mm/s"],
        ),
        ("speed_max = 0.4", ["speed_max is 0.4", "0.02 m/s to 2 m/s"]),
        (
            "speed_max = \"9 m/s\"",
            ["speed_max is 9 m/s", "0.02 m/s to 2 m/s"],
        ),
        ("stop_time = \"-1 s\"", ["stop_time is -1 s", "0 s to 5 s"]),
        (
            "near_distance = \"2 m\"",
            ["near_distance is 2 m", "to 1.2 m"],
        ),
        ("resume_samples = 2.5", ["resume_samples is 2.5", "1 to 50"]),
        ("sonars = \"p3dx-9\"", ["sonars is \"p3dx-9\"", "p3dx-16"]),
        ("speed_max \"40 cm/s\"", ["", ""]),
    ] {
        let config = folder.file("robot.toml", &format!("# The robot.\n\n{line}\n"));
        for arguments in [
            &[
                "run",
                "--port",
                "tcp:127.0.0.1:9",
                "--goal",
                "1,0",
                "--log",
                text(&log),
            ][..],
            &["demo", "--out", text(&out)],
            &["replay", "no.csv"],
        ] {
            let output = run(&[arguments, &["--config", text(&config)]].concat());
            assert!(!output.status.success(), "{line}: {arguments:?}");
            let message = stderr(&output);
            let place = format!("{}:3: ", text(&config));
            assert!(message.contains(&place), "{line}: {message}");
            for part in parts {
                assert!(message.contains(part), "{line}: {message} lacks {part:?}");
            }
        }
        assert_eq!(
            folder.names(),
            ["robot.toml"],
            "{line}: something was begun"
        );
    }
    let missing = folder.path("missing.toml");
    let output = run(&["replay", "no.csv", "--config", text(&missing)]);
    assert!(stderr(&output).contains("missing.toml"));
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let folder = Folder::new();
    let config = folder.config();
    // Nobody listens where somebody has just stopped listening.
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let closed = format!("tcp:{}", listener.local_addr().unwrap());
    drop(listener);
    let no_device = folder.path("ttyUSB9");
    for (number, port) in [
        text(&no_device),
        &closed,
        "tcp:",
        "tcp:no.such.host.invalid:1",
    ]
    .into_iter()
    .enumerate()
    {
        let log = folder.path(&format!("log-{number}.jsonl"));
        let output = run(&[
            "run",
            "--port",
            port,
            "--config",
            text(&config),
            "--goal",
            "1,0",
            "--log",
            text(&log),
        ]);
        assert!(!output.status.success(), "{port}");
        let message = stderr(&output);
        assert!(message.contains(port), "{port}: {message}");
    }
}

#[test]
fn a_log_is_never_written_over() {
    let folder = Folder::new();
    let config = folder.config();
    let log = folder.file("log.jsonl", "somebody's record\n");
    let output = run(&[
        "run",
        "--port",
        "tcp:127.0.0.1:9",
        "--config",
        text(&config),
        "--goal",
        "1,0",
        "--log",
        text(&log),
    ]);
    assert!(!output.status.success());
    assert!(stderr(&output).contains("log.jsonl"), "{}", stderr(&output));
    assert_eq!(
        std::fs::read_to_string(&log).unwrap(),
        "somebody's record\n"
    );
}

#[test]
fn a_robot_on_tcp_is_driven_to_its_goal() {
    let folder = Folder::new();
    let config = folder.config();
    let log = folder.path("log.jsonl");
    let (mut robot, port) = emulator("127.0.0.1:0");
    let begun = Instant::now();
    let mut host = Running::start(&[
        "run",
        "--port",
        &port,
        "--config",
        text(&config),
        "--goal",
        "0.5,0",
        "--log",
        text(&log),
    ]);
    let status = host.wait();
    println!("arrived after {:?}: {:#?}", begun.elapsed(), host.said());
    assert_eq!(status.code(), Some(0), "{:#?}", host.said());
    host.wait_for("connected to");
    host.wait_for("ended: Arrived");
    let log = assert_replays(&log);
    assert_eq!(last_stop(&log), Some("operator"));
    robot.signal("INT");
    assert_eq!(robot.wait().code(), Some(0));
    let said = robot.said().join("\n");
    assert!(said.contains("travelled: 0."), "{said}");
}

#[test]
fn a_robot_on_a_pseudo_terminal_is_driven_to_its_goal() {
    let folder = Folder::new();
    let config = folder.config();
    let log = folder.path("log.jsonl");
    let port = folder.path("robot");
    let mut robot = Running::start(&[
        "emulate",
        "--pty",
        text(&port),
        "--scenario",
        "fig12-from-side",
        "--seconds",
        "120",
    ]);
    robot.wait_for("robot on");
    let mut host = Running::start(&[
        "run",
        "--port",
        text(&port),
        "--config",
        text(&config),
        "--goal",
        "0.5,0",
        "--log",
        text(&log),
    ]);
    assert_eq!(host.wait().code(), Some(0), "{:#?}", host.said());
    assert_replays(&log);
    robot.signal("TERM");
    assert_eq!(robot.wait().code(), Some(0));
    assert!(!port.is_symlink(), "the link outlives the robot");
}

/// Ctrl-C and SIGTERM: the robot is stopped and told that the session is over.
#[test]
fn a_signal_stops_the_robot_and_ends_the_session() {
    let folder = Folder::new();
    let config = folder.config();
    for signal in ["INT", "TERM"] {
        let log = folder.path(&format!("{signal}.jsonl"));
        let scenario = Scenario::named("fig12-from-side", &Knobs::default()).unwrap();
        let simulation = scenario.simulate().unwrap();
        let (line, address) = Line::tcp("127.0.0.1:0").unwrap();
        let done = AtomicBool::new(false);
        let simulation = std::thread::scope(|scope| {
            let robot = scope.spawn(|| serve(simulation, line, Clock::new(1.0), &done));
            // Whatever fails here, the robot must not be waited for until it is told to end.
            let host = std::panic::catch_unwind(|| {
                let mut host = Running::start(&[
                    "run",
                    "--port",
                    &format!("tcp:{address}"),
                    "--config",
                    text(&config),
                    "--goal",
                    "100,0",
                    "--log",
                    text(&log),
                ]);
                host.wait_for("cruise");
                std::thread::sleep(Duration::from_millis(1500));
                host.signal(signal);
                assert_eq!(host.wait().code(), Some(2), "{:#?}", host.said());
                host.wait_for("ended: Operator");
                host.wait_for("closed");
            });
            // Braking from the cruising speed takes 0.2 s.
            std::thread::sleep(Duration::from_millis(500));
            done.store(true, Ordering::Relaxed);
            let simulation = robot.join().unwrap();
            host.unwrap();
            simulation
        });
        let robot = simulation.robot();
        assert_eq!(robot.session(), Session::Unsynchronised, "{signal}");
        assert_eq!(robot.base().speed(), 0.0, "{signal}");
        assert!(!robot.motors_enabled());
        assert!(
            simulation.outcome().travelled > 0.05,
            "{signal}: it never drove"
        );
        let log = assert_replays(&log);
        assert_eq!(last_stop(&log), Some("operator"), "{signal}");
    }
}

#[test]
fn a_port_that_vanishes_is_reported_and_tried_again() {
    let folder = Folder::new();
    let config = folder.config();
    let log = folder.path("log.jsonl");
    let (robot, port) = emulator("127.0.0.1:0");
    let mut host = Running::start(&[
        "run",
        "--port",
        &port,
        "--config",
        text(&config),
        "--goal",
        "100,0",
        "--log",
        text(&log),
    ]);
    host.wait_for("cruise");
    drop(robot);
    host.wait_for(&format!("link lost: {port}: cannot"));
    host.wait_for("STOP");
    std::thread::sleep(Duration::from_secs(3));
    assert!(host.is_running(), "{:#?}", host.said());
    // It is there again.
    let (robot, same_port) = emulator(port.strip_prefix("tcp:").unwrap());
    assert_eq!(same_port, port);
    host.wait_for("ready again");
    drop(robot);
    std::thread::sleep(Duration::from_secs(2));
    host.signal("INT");
    assert_eq!(host.wait().code(), Some(2), "{:#?}", host.said());
    let log = assert_replays(&log);
    let lost = log.records.iter().filter(
        |(_, record)| matches!(record, Record::Event { text, .. } if text.contains("link lost")),
    );
    assert_eq!(lost.count(), 2);
}

/// Starts the program, reads what it says up to a line with `wanted` in it, and looks away.
fn start_and_look_away(arguments: &[&str], wanted: &str) -> Running {
    let mut child = sidestep(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains(wanted)));
    Running {
        child,
        lines: Arc::default(),
    }
}

/// Whoever watches may stop watching (`sidestep … | head`, a terminal that is closed): the robot is
/// driven on, or stopped, as ever.
#[test]
fn a_robot_is_not_let_go_of_when_nobody_looks() {
    let folder = Folder::new();
    let config = folder.config();
    for (name, goal, signal, code) in [
        ("arrives", "0.5,0", None, 0),
        ("stopped", "100,0", Some("HUP"), 2),
    ] {
        let log = folder.path(&format!("{name}.jsonl"));
        let (_robot, port) = emulator("127.0.0.1:0");
        let mut host = start_and_look_away(
            &[
                "run",
                "--port",
                &port,
                "--config",
                text(&config),
                "--goal",
                goal,
                "--log",
                text(&log),
            ],
            "cruise",
        );
        if let Some(signal) = signal {
            std::thread::sleep(Duration::from_secs(1));
            host.signal(signal);
        }
        assert_eq!(host.wait().code(), Some(code), "{name}");
        let log = assert_replays(&log);
        assert_eq!(last_stop(&log), Some("operator"), "{name}");
    }
    let arguments = [
        "demo",
        "fig12-from-side",
        "--speed",
        "10",
        "--out",
        text(&folder.0),
    ];
    let mut demo = start_and_look_away(&arguments, "cruise");
    assert_eq!(demo.wait().code(), Some(0));
    assert!(folder.path("fig12-from-side-001/picture.svg").exists());
}

#[test]
fn the_demonstration_leaves_its_folder() {
    let folder = Folder::new();
    let output = run(&[
        "demo",
        "fig12-from-side",
        "--speed",
        "10",
        "--out",
        text(&folder.0),
    ]);
    println!("{}", stdout(&output));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(folder.names(), ["fig12-from-side-001"]);
    let run_folder = folder.path("fig12-from-side-001");
    let read = |name: &str| std::fs::read_to_string(run_folder.join(name)).expect(name);
    let picture = read("picture.svg");
    assert!(picture.contains("<svg") && picture.trim_end().ends_with("</svg>"));
    assert!(picture.contains("fig12-from-side"));
    let summary = read("summary.txt");
    for part in [
        "goal reached: after",
        "contacts while moving: 0",
        "least clearance while moving: people",
        "stops: ",
        "longest computation",
    ] {
        assert!(summary.contains(part), "{summary}");
    }
    assert!(stdout(&output).contains("picture.svg"));
    assert_replays(&run_folder.join("log.jsonl"));
    // A second run gets a folder of its own: checked with one that ends at once.
    std::fs::create_dir(folder.path("fig12-from-side-002")).unwrap();
    let mut again = Running::start(&["demo", "fig12-from-side", "--out", text(&folder.0)]);
    again.wait_for("fig12-from-side-003");
    again.signal("INT");
    assert_eq!(again.wait().code(), Some(0), "{:#?}", again.said());
}

/// A log with one decision, in which nothing happened.
fn short_log() -> String {
    let scenario = Scenario::named("lab", &Knobs::default()).unwrap();
    let mut simulation = scenario.simulate().unwrap();
    let config = sidestep_hw::config::RobotConfig::default();
    let folder = Folder::new();
    let path = folder.path("log.jsonl");
    let mut pilot = sidestep_hw::pilot::Pilot::<_, 16>::new(
        config,
        [1.0, 0.0],
        sidestep_hw::pilot::settings(&config, false, None),
        Box::new(std::fs::File::create(&path).unwrap()),
    )
    .unwrap();
    for now in (0..3000).step_by(10) {
        simulation.advance_to(now);
        pilot.receive(&simulation.robot_mut().transmit(), now);
        while let Some(output) = pilot.poll(now) {
            if let sidestep_hw::session::Output::Send(bytes) = output {
                simulation.robot_mut().receive(&bytes);
            }
        }
    }
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn replay_says_what_is_wrong_with_a_log() {
    let log = short_log();
    let folder = Folder::new();
    let whole = folder.file("whole.jsonl", &log);
    assert_replays(&whole);

    let cut = folder.file("cut.jsonl", &log[..log.len() - 20]);
    let output = run(&["replay", text(&cut)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let lines = log.lines().count();
    let expected = format!("the log ends in the middle of line {lines}");
    assert!(stdout(&output).contains(&expected), "{}", stdout(&output));
    assert!(stdout(&output).contains("every command the same"));

    let changed = log.replacen(
        "\"stop\":\"motors are disabled\"",
        "\"stop\":\"no reason\"",
        1,
    );
    assert_ne!(changed, log);
    let line = 1 + changed
        .lines()
        .position(|line| line.contains("no reason"))
        .unwrap();
    let changed = folder.file("changed.jsonl", &changed);
    let output = run(&["replay", text(&changed)]);
    assert_eq!(output.status.code(), Some(1));
    let expected = format!("they part at line {line}");
    assert!(stdout(&output).contains(&expected), "{}", stdout(&output));
    assert!(stdout(&output).contains("no reason"));

    let garbage = folder.file("garbage.jsonl", &log.replacen('\n', "\ngarbage\n", 1));
    let empty = folder.file("empty.jsonl", "");
    let uneven = folder.file("uneven.csv", "1,2,3\n1,2\n");
    let missing = folder.path("missing.jsonl");
    for (file, expected) in [
        (&garbage, "line 2: "),
        (&empty, "empty"),
        (&uneven, "line 2: "),
        (&missing, "missing.jsonl"),
    ] {
        let output = run(&["replay", text(file)]);
        assert_eq!(output.status.code(), Some(1), "{file:?}");
        let message = stderr(&output);
        assert!(message.contains(expected), "{message}");
        assert!(message.contains(text(file)), "{message}");
    }
}
