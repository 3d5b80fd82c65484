//! Readers of recorded people and cluttered worlds, on small texts, and on the real files where
//! `SIDESTEP_DATA` and `SIDESTEP_TRACES` say where they are.

mod common;

use std::path::{Path, PathBuf};

use common::{frame, open};
use sidestep::arcos::HostCommand;
use sidestep_sim::geometry::Point;
use sidestep_sim::person::Motion;
use sidestep_sim::robot::{Parameters, Session};
use sidestep_sim::scenario::Knobs;
use sidestep_sim::{Error, Scenario, barn, eth};

const PEOPLE: &str = "
  1.0e+00  7.0e+00   1.0e+00  0.0e+00  -2.0e+00   0.5e+00  0.0e+00  0.0e+00
  1.0e+00  2.0e+00   0.0e+00  0.0e+00   0.0e+00   0.0e+00  0.0e+00  0.0e+00\r
 11.0e+00  7.0e+00   1.2e+00  0.0e+00  -2.0e+00   0.5e+00  0.0e+00  0.0e+00

 26.0e+00  7.0e+00   2.0e+00  0.0e+00  -2.0e+00   0.5e+00  0.0e+00  0.0e+00
";

fn file() -> &'static Path {
    Path::new("people.txt")
}

/// The folder that `variable` names, or a loud word that it does not.
fn folder(variable: &str, skipped: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        eprintln!("SKIPPED: {skipped} ({variable} is not set)");
    }
    folder
}

#[test]
fn recorded_people_are_read() {
    let people = eth::parse(PEOPLE, file()).unwrap();
    assert_eq!(people.len(), 2);
    let Motion::Track(track) = people[1].motion() else {
        panic!("no track");
    };
    let times: Vec<f64> = track.iter().map(|sample| sample.time).collect();
    assert_eq!(times, [0.0, 0.4, 1.0]);
    assert_eq!(track[1].position, Point::new(1.2, -2.0));
    assert!(people[1].courtesy().is_none());
    assert_eq!(people[0].position(), Some(Point::new(0.0, 0.0)));
    assert_eq!(eth::parse("", file()).unwrap().len(), 0);
}

#[test]
fn errors_name_file_and_line() {
    for (text, line, word) in [
        ("1 1 0 0 0 0 0", 1, "expected 8 numbers, found 7"),
        ("\n1 1 0 0 x 0 0 0", 2, "\"x\""),
        ("1 1 0 0 nan 0 0 0", 1, "\"nan\""),
        ("1 1.5 0 0 0 0 0 0", 1, "person, found 1.5"),
        ("1 -1 0 0 0 0 0 0", 1, "person, found -1"),
        ("2 1 0 0 0 0 0 0\n2 1 0 0 0 0 0 0", 2, "frame 2 of person 1"),
    ] {
        let error = eth::parse(text, file()).err().unwrap();
        let message = error.to_string();
        assert!(
            message.starts_with(&format!("people.txt:{line}: ")),
            "{message}"
        );
        assert!(message.contains(word), "{message}");
    }
    let error = eth::read(Path::new("/no/such/file")).err().unwrap();
    assert!(matches!(error, Error::Unreadable { .. }));
    assert!(error.to_string().starts_with("/no/such/file: "), "{error}");
}

#[test]
fn cells_are_read() {
    let worlds = barn::parse("world,x_m,y_m\n0,-0.075,0.075\n6,1.5,2\n6,1.65,2\n", file()).unwrap();
    assert_eq!(worlds.keys().copied().collect::<Vec<_>>(), [0, 6]);
    let world = barn::world(&worlds[&6]).unwrap();
    assert_eq!(world.obstacles().len(), 2);
    assert!((world.clearance(Point::new(1.0, 2.0), 0.3) - 0.125).abs() < 1e-6);
    for (text, start) in [
        ("world,x,y\n", "people.txt:1: expected the header"),
        ("", "people.txt:1: expected the header"),
        ("world,x_m,y_m\n0,1\n", "people.txt:2: expected 3 numbers"),
        (
            "world,x_m,y_m\n0.5,1,1\n",
            "people.txt:2: expected a whole number for world",
        ),
    ] {
        let message = barn::parse(text, file()).err().unwrap().to_string();
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn the_whole_hotel_recording_is_walked() {
    let Some(data) = folder("SIDESTEP_DATA", "the whole of eth-hotel-obsmat.txt") else {
        return;
    };
    let path = data.join("eth-hotel-obsmat.txt");
    let people = eth::read(&path).unwrap();
    let samples: usize = people
        .iter()
        .map(|person| match person.motion() {
            Motion::Track(track) => track.len(),
            _ => 0,
        })
        .sum();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(samples, text.lines().count());
    assert_eq!(people.len(), 390);

    let scenario = Scenario::hotel(&path, 0.0, &Knobs::default()).unwrap();
    assert_eq!(scenario.time_limit_ms, 722_400);
    let mut simulation = scenario.simulate().unwrap();
    simulation.advance_to(scenario.time_limit_ms);
    let most = simulation
        .trace()
        .iter()
        .map(|sample| sample.people.len())
        .max();
    println!(
        "{} people, at most {most:?} at once: {:?}",
        people.len(),
        simulation.outcome()
    );
    // They know of no robot, but one that stands only ever is touched at rest.
    assert_eq!(simulation.outcome().contacts_while_driving.people, 0);

    let late = Scenario::hotel(&path, 700.0, &Knobs::default()).unwrap();
    assert_eq!(late.time_limit_ms, 22_400);
    assert!(Scenario::hotel(&path, 723.0, &Knobs::default()).is_err());
}

#[test]
fn all_barn_worlds_are_built() {
    let Some(data) = folder("SIDESTEP_DATA", "the whole of barn-even.csv") else {
        return;
    };
    let worlds = barn::read(&data.join("barn-even.csv")).unwrap();
    assert_eq!(worlds.len(), 150);
    let mut cells = 0;
    for (number, places) in &worlds {
        let world = barn::world(places).unwrap();
        cells += world.obstacles().len();
        // Each is an arena with a free middle line at one end to start from.
        assert!(
            world.nearest(Point::new(0.0, 0.0)).is_some(),
            "world {number}"
        );
    }
    assert_eq!(cells, 39_725);
}

/// The bytes sent by the host in a trace as `socat -x` writes it, in order.
fn host_bytes(trace: &str) -> Vec<Vec<u8>> {
    let mut sent = Vec::new();
    let mut from_host = false;
    for line in trace.lines() {
        if line.starts_with('>') || line.starts_with('<') {
            from_host = line.starts_with('>');
        } else if from_host {
            let bytes = line.split_ascii_whitespace();
            sent.push(
                bytes
                    .filter_map(|byte| u8::from_str_radix(byte, 16).ok())
                    .collect(),
            );
        }
    }
    sent
}

#[test]
fn real_hosts_open_a_session() {
    let Some(traces) = folder("SIDESTEP_TRACES", "the recorded sessions of real hosts") else {
        return;
    };
    let mut replayed = 0;
    for entry in std::fs::read_dir(traces).unwrap() {
        let path = entry.unwrap().path();
        let mut simulation = common::robot(Parameters::default());
        let mut opened = false;
        for bytes in host_bytes(&std::fs::read_to_string(&path).unwrap()) {
            simulation.robot_mut().receive(&bytes);
            let next = simulation.now_ms() + 100;
            simulation.advance_to(next);
            opened |= simulation.robot().session() == Session::Open;
        }
        println!(
            "{}: drove {:.2} m",
            path.display(),
            simulation.outcome().travelled
        );
        assert!(opened, "{}", path.display());
        assert!(simulation.outcome().travelled > 0.0, "{}", path.display());
        replayed += 1;
    }
    assert!(replayed > 0, "no traces there");
}

#[test]
fn a_robot_drives_in_a_cluttered_world() {
    let cells: Vec<Point> = (0..20)
        .map(|i| Point::new(1.0, f64::from(i) * 0.15 - 1.5))
        .collect();
    let mut simulation = common::in_world(barn::world(&cells).unwrap(), Parameters::default());
    open(&mut simulation);
    simulation
        .robot_mut()
        .receive(&frame(&HostCommand::velocity(300)));
    common::drive_to(&mut simulation, 6000);
    let reached = simulation.robot().base().pose().position.x;
    assert!((reached - (1.0 - 0.075 - 0.301)).abs() < 0.005, "{reached}");
}
