//! What real sensors, real people and real robots gave: a table of sonar ranges from a SCITOS G5,
//! pedestrians recorded from above (ETH, sequence *hotel*), and bytes of real sessions.
//!
//! `SIDESTEP_DATA` and `SIDESTEP_TRACES` name the folders; without them small vectors of our own take
//! their place, and what was skipped is said loudly.

mod common;

use common::{Rig, SharedLog, folder, moving_contacts};
use nalgebra::Vector2;
use sidestep::arcos::{
    BaseParameters, Identity, PacketError, Receiver, StandardInformation, command,
};
use sidestep::controller::Controller;
use sidestep::quantity::Instant;
use sidestep_hw::base::{self, Base};
use sidestep_hw::config::{self, RobotConfig};
use sidestep_hw::log;
use sidestep_hw::pilot::{Pilot, settings};
use sidestep_hw::replay::{self, Columns, Table};
use sidestep_sim::base::Activity;
use sidestep_sim::eth;
use sidestep_sim::geometry::Point;
use sidestep_sim::person::Motion;
use sidestep_sim::scenario::{Knobs, Scenario};
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Runs a table in both mappings, and checks what holds for any: the thirds, then the ring.
fn both_mappings(text: &str, config: &RobotConfig) -> [Table; 2] {
    [Columns::Thirds, Columns::Ring].map(|columns| {
        let table = replay::table(text, columns, config, 100).expect("the table is readable");
        println!("{columns:?}: {table:#?}");
        assert_eq!(table.near_but_moving, 0, "{columns:?}");
        assert!(table.near <= table.stopped, "{columns:?}");
        assert!(table.greatest_speed <= (config.core.speed_max * 1000.0) as i32);
        table
    })
}

/// Made-up rows: far, near in front, near behind, nothing at all, too near, and no ranges.
#[test]
fn rows_of_ranges_are_judged() {
    let row = |front: &str, rest: &str| {
        let columns: Vec<&str> = (0..24)
            .map(|column| if column == 12 { front } else { rest })
            .collect();
        columns.join(",") + ",Move-Forward\n"
    };
    let mut text = String::from("S1,S2,OUTPUT\n");
    for (front, rest) in [
        ("3.0", "3.0"),
        ("0.3", "3.0"),
        ("0.4", "0.5"),
        ("5.0", "5.0"),
        ("0.01", "5.0"),
        ("0", "0"),
        ("NaN", "NaN"),
        ("-1", "3.0"),
        ("inf", "inf"),
        ("9999", "9999"),
    ] {
        text += &row(front, rest);
    }
    for table in both_mappings(&text, &RobotConfig::default()) {
        assert_eq!(table.rows, 10);
        // 0.3, 0.4, 0.01, 0 and −1 in front; the minimum distance is 0.4.
        assert_eq!(table.near, 5);
        assert_eq!(table.stopped, 10, "the first rows are not enough to start");
    }
    // Far enough for long enough, the robot would go: the rows above are not all there is to it.
    let free = row("4.0", "4.0").repeat(50);
    for table in both_mappings(&free, &RobotConfig::default()) {
        assert!(table.stopped < 10 && table.greatest_speed > 0);
    }
    assert!(replay::table("", Columns::Ring, &RobotConfig::default(), 100).is_err());
    let uneven = row("1", "1") + "1,2,3\n";
    let error = replay::table(&uneven, Columns::Ring, &RobotConfig::default(), 100);
    assert!(error.unwrap_err().starts_with("line 2:"));
}

/// In how many rows a range of the columns `front`, counted from 0, is at or under `minimum`.
fn rows_near(text: &str, front: std::ops::RangeInclusive<usize>, minimum: f32) -> usize {
    let near = |line: &&str| {
        let ranges: Vec<f32> = line
            .split(',')
            .map_while(|field| field.parse().ok())
            .collect();
        front
            .clone()
            .any(|column| ranges.get(column).is_some_and(|range| *range <= minimum))
    };
    text.lines().filter(near).count()
}

/// With the minimum distance of S1, and with one that the robot of the log often came under: it
/// followed walls, and kept 0.5 m in front.
#[test]
fn every_row_of_the_scitos_log_is_judged() {
    let Some(data) = folder("SIDESTEP_DATA", "all 5,456 rows of the SCITOS log") else {
        return;
    };
    let text = std::fs::read_to_string(data.join("scitos-g5-sonar24.csv")).unwrap();
    for toml in ["min_distance = \"40 cm\"", "min_distance = \"70 cm\""] {
        let config = config::parse(toml, "test").unwrap();
        let minimum = config.core.min_distance;
        let [thirds, ring] = both_mappings(&text, &config);
        for table in [&thirds, &ring] {
            assert_eq!(table.rows, 5456);
            assert!(table.greatest_speed > 0, "the robot never drove");
        }
        // Sonar 13 looks ahead; the next are 15° apart. Forward is ±60°: the axes of all three thirds,
        // which take in ±90° together.
        assert_eq!(thirds.near, rows_near(&text, 6..=18, minimum));
        assert_eq!(ring.near, rows_near(&text, 8..=16, minimum));
        assert!(ring.near > 0);
        assert!(thirds.near > 0 || minimum < 0.5);
    }
}

/// A recording in a file of its own, removed when dropped.
struct Recording(PathBuf);

impl Recording {
    fn new(name: &str, text: &str) -> Self {
        let file = format!("sidestep-{}-{name}.txt", std::process::id());
        let path = std::env::temp_dir().join(file);
        std::fs::write(&path, text).unwrap();
        Self(path)
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The greatest speed at which anyone in a recording ever walks, m/s.
fn fastest(path: &Path) -> f64 {
    let mut fastest: f64 = 0.0;
    for person in eth::read(path).unwrap() {
        let Motion::Track(samples) = person.motion() else {
            panic!("a recorded person has a track");
        };
        for pair in samples.windows(2) {
            let way = (pair[1].position - pair[0].position).norm();
            fastest = fastest.max(way / (pair[1].time - pair[0].time));
        }
    }
    fastest
}

/// The recording with time stretched by `factor`.
fn stretched(text: &str, factor: f64) -> String {
    let mut stretched = String::new();
    for line in text.lines() {
        let mut fields = line.split_ascii_whitespace();
        if let Some(frame) = fields.next() {
            let frame: f64 = frame.parse().unwrap();
            let rest: Vec<&str> = fields.collect();
            let _ = writeln!(stretched, "{} {}", frame * factor, rest.join(" "));
        }
    }
    stretched
}

/// Contacts among recorded people.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Contacts {
    /// While the robot moved, with people within the promise.
    promised: u32,
    /// While the robot moved, with people who lately walked faster than V.
    too_fast: u32,
    /// While the robot moved, with people who appeared out of nowhere lately: their recording begins
    /// there.
    sudden: u32,
    /// While the robot stood.
    at_rest: u32,
    /// Runs, and how many of them ended at the goal.
    runs: u32,
    arrived: u32,
    travelled: f64,
    /// Least clearance at any time, m; as deep as a person ever walked into the robot.
    nearest: f64,
}

/// How long before a contact a person's speed matters, ms: longer than reacting and braking take.
const LATELY: u64 = 2000;

/// The robot drives to and fro among the recorded people until the recording is over: whenever it has
/// arrived, or a minute is over, it begins again where it began.
fn drive_among(path: &Path) -> Contacts {
    let config = RobotConfig::default();
    let promised_speed = f64::from(config.core.obstacle_speed_max);
    let mut knobs = Knobs::default();
    knobs.sonar_faults.dropout = 0.1;
    let mut contacts = Contacts {
        nearest: f64::INFINITY,
        ..Contacts::default()
    };
    let mut start = 0.0;
    while let Ok(mut scenario) = Scenario::hotel(path, start, &knobs) {
        scenario.time_limit_ms = scenario.time_limit_ms.min(60_000);
        let mut rig = Rig::new(&scenario, &config, common::usual(&config));
        let people = rig.simulation.world().people().len();
        let mut before: Vec<VecDeque<Option<Point>>> = vec![VecDeque::new(); people];
        // Who is in contact, and what kind of contact it was while moving, if it ever was.
        let mut touching: BTreeMap<usize, (u8, bool)> = BTreeMap::new();
        let mut moving = [0; 3];
        while rig.now() < scenario.time_limit_ms && rig.pilot.tally().arrived.is_none() {
            rig.step();
            contacts.nearest = contacts.nearest.min(rig.simulation.clearance());
            let base = rig.simulation.robot().base();
            let radius = base.footprint().radius;
            for (i, person) in rig.simulation.world().people().iter().enumerate() {
                let places = &mut before[i];
                places.push_back(person.position());
                if places.len() as u64 > LATELY / sidestep_sim::STEP_MS {
                    places.pop_front();
                }
                let touches = person.position().is_some_and(|place| {
                    (place - base.pose().position).norm() <= radius + person.radius()
                });
                if !touches {
                    touching.remove(&i);
                    continue;
                }
                let (kind, counted) = touching
                    .entry(i)
                    .or_insert_with(|| (kind_of_contact(places, promised_speed), false));
                if base.activity() != Activity::Resting && !*counted {
                    *counted = true;
                    moving[usize::from(*kind)] += 1;
                }
            }
        }
        let outcome = rig.simulation.outcome();
        // The simulator's own count, which knows nothing of kinds.
        assert_eq!(moving.iter().sum::<u32>(), moving_contacts(&outcome));
        contacts.promised += moving[0];
        contacts.too_fast += moving[1];
        contacts.sudden += moving[2];
        contacts.at_rest += outcome.contacts_at_rest.people;
        contacts.runs += 1;
        contacts.arrived += u32::from(rig.pilot.tally().arrived.is_some());
        contacts.travelled += outcome.travelled;
        start += rig.now() as f64 / 1000.0;
    }
    contacts
}

/// 0 if the person was there and no faster than `promised` all the time, 1 if faster, 2 if not there.
fn kind_of_contact(places: &VecDeque<Option<Point>>, promised: f64) -> u8 {
    let complete = places.len() as u64 == LATELY / sidestep_sim::STEP_MS;
    let mut greatest: f64 = 0.0;
    for (earlier, later) in places.iter().zip(places.iter().skip(1)) {
        match (earlier, later) {
            (Some(earlier), Some(later)) => {
                greatest = greatest.max((later - earlier).norm() / sidestep_sim::STEP);
            }
            _ => return 2,
        }
    }
    match complete {
        false => 2,
        // Differences of positions do not give a speed back to the last bit.
        true => u8::from(greatest > promised + 1e-6),
    }
}

/// As recorded, and then slowly enough for the promise to hold for everyone.
///
/// Passive safety is promised for obstacles no faster than V = 0.8 m/s, which is S1's v_o,max. The
/// recorded people walk at 1.2 to 1.5 m/s and more: they outrun what the guard allows for, so a
/// contact with them while the robot brakes is outside the promise, and is counted and shown. (None
/// of them knows of a robot: they walk right through where it stands.) The same people with time
/// stretched until the fastest of them walks at 0.8 m/s are within it, and none of them may be
/// touched.
fn people_walk_round_the_robot(text: &str) -> [Contacts; 2] {
    let recording = Recording::new("recorded", text);
    let fastest_walk = fastest(&recording.0);
    let recorded = drive_among(&recording.0);
    println!("as recorded, up to {fastest_walk:.2} m/s: {recorded:?}");
    let promised_speed = f64::from(RobotConfig::default().core.obstacle_speed_max);
    let factor = (fastest_walk / promised_speed).max(1.0) * 1.001;
    let slow = Recording::new("stretched", &stretched(text, factor));
    assert!(fastest(&slow.0) <= promised_speed);
    let slowed = drive_among(&slow.0);
    println!("{factor:.2} times slower: {slowed:?}");
    for contacts in [recorded, slowed] {
        assert_eq!(contacts.promised, 0, "contacts within the promise");
        assert!(contacts.travelled > 0.0, "the robot never moved");
        assert!(contacts.nearest < 1.0, "nobody ever came near");
    }
    assert_eq!(slowed.too_fast, 0, "everybody is slow here");
    [recorded, slowed]
}

/// Three made-up people: one meets the robot head on at 1.5 m/s, one crosses at 0.5 m/s, one follows.
fn made_up_people() -> String {
    let mut text = String::new();
    for step in 0..60 {
        let frame = step * 10;
        let time = f64::from(step) * 0.4;
        for (person, x, y) in [
            (1, 10.0 - 1.5 * time, -3.1),
            (2, 0.5, 3.0 - 0.5 * time),
            (3, -9.0 + 0.6 * time, -2.8),
        ] {
            let _ = writeln!(text, "{frame} {person} {x} 0 {y} 0 0 0");
        }
    }
    text
}

#[test]
fn made_up_people_walk_round_the_robot() {
    people_walk_round_the_robot(&made_up_people());
}

#[test]
fn recorded_people_walk_round_the_robot() {
    let Some(data) = folder("SIDESTEP_DATA", "the 722 s of the ETH hotel recording") else {
        return;
    };
    let text = std::fs::read_to_string(data.join("eth-hotel-obsmat.txt")).unwrap();
    let [recorded, slowed] = people_walk_round_the_robot(&text);
    // 722 s at a minute each at most, and it does get somewhere among them.
    assert!(recorded.runs >= 13 && recorded.arrived > 0);
    assert!(slowed.arrived > 0);
}

/// What the robot sent in a trace as `socat -x` writes it, write by write.
fn robot_bytes(trace: &str) -> Vec<Vec<u8>> {
    let mut sent: Vec<Vec<u8>> = Vec::new();
    let mut from_robot = false;
    for line in trace.lines() {
        if line.starts_with(['>', '<']) {
            from_robot = line.starts_with('<');
            if from_robot {
                sent.push(Vec::new());
            }
        } else if from_robot && let Some(last) = sent.last_mut() {
            let bytes = line.split_ascii_whitespace();
            last.extend(bytes.map(|byte| u8::from_str_radix(byte, 16).expect("hexadecimal")));
        }
    }
    sent
}

/// What came of the packets of a session.
#[derive(Debug, Default)]
struct Packets {
    ticks: u64,
    refused: Vec<(Vec<u8>, PacketError)>,
    stops: BTreeMap<&'static str, u64>,
    modes: BTreeMap<&'static str, u64>,
    greatest_speed: i32,
}

/// Runs every packet through the controller, as fast as they came: ten a second.
fn tick_on_every_packet(writes: &[Vec<u8>]) -> Packets {
    let config = RobotConfig::default();
    let mut base = Base::<16>::new(BaseParameters::P3DX_SH, &config);
    let ring = base::ring::<16>(&config).unwrap();
    let law = common::usual(&config);
    let mut controller = Controller::new(config.core, ring, law, Vector2::new(4.0, 0.0)).unwrap();
    let mut receiver = Receiver::new();
    let mut packets = Packets::default();
    let bytes = writes.concat();
    let mut input = bytes.as_slice();
    let mut now = 0;
    while let Some(frame) = receiver.next_frame(&mut input) {
        if frame.number() == command::SYNC2
            && let Ok(identity) = Identity::decode(frame)
        {
            let parameters = BaseParameters::for_subclass(identity.subclass);
            base = Base::new(parameters.expect("a base that is known"), &config);
        }
        if !StandardInformation::is_kind(frame.number()) {
            continue;
        }
        now += 100;
        match StandardInformation::decode(frame) {
            Ok(information) => {
                let decision = controller.tick(&base.observe(&information, Instant(now)));
                packets.ticks += 1;
                *packets.modes.entry(decision.mode).or_default() += 1;
                if let Some(reason) = decision.stop {
                    *packets.stops.entry(reason.row().cause).or_default() += 1;
                    assert_eq!(decision.command.speed(), 0);
                }
                packets.greatest_speed = packets.greatest_speed.max(decision.command.speed());
            }
            Err(error) => packets.refused.push((frame.as_bytes().to_vec(), error)),
        }
    }
    let reception = receiver.reception();
    assert_eq!((reception.bad_checksums, reception.skipped_bytes), (0, 0));
    packets
}

/// The whole pilot on the robot's side of a conversation: it greets, and the recorded robot answers.
fn pilot_on(writes: &[Vec<u8>]) -> (u64, u64) {
    let config = RobotConfig::default();
    let shared = SharedLog::default();
    let mut pilot = Pilot::<_, 16>::new(
        config,
        [4.0, 0.0],
        settings(&config, false, None),
        Box::new(shared.clone()),
    )
    .unwrap();
    let mut now = 0;
    let mut connected = false;
    for bytes in writes {
        while pilot.poll(now).is_some() {}
        now += 100;
        pilot.receive(bytes, now);
        while let Some((_, text)) = pilot.next_event() {
            connected |= text.starts_with("connected");
        }
    }
    assert!(connected, "the robot was not recognised");
    let log = log::read(shared.bytes().as_slice()).unwrap();
    let replayed = replay::log(&log).unwrap();
    assert_eq!(replayed.parting, None);
    assert_eq!(replayed.ticks as u64, common::decisions(&log));
    (pilot.tally().ticks, pilot.tally().rejected)
}

/// Every packet decodes and ticks, but for those that claim readings they do not hold.
fn converse(name: &str, writes: &[Vec<u8>]) -> Packets {
    let packets = tick_on_every_packet(writes);
    let (ticks, rejected) = pilot_on(writes);
    println!(
        "{name}: {} ticks, {} refused, stops {:?}, modes {:?}, at most {} mm/s; pilot: {ticks} \
         ticks, {rejected} rejections",
        packets.ticks,
        packets.refused.len(),
        packets.stops,
        packets.modes,
        packets.greatest_speed,
    );
    assert!(packets.ticks > 0);
    for (frame, error) in &packets.refused {
        // 16 readings claimed, none there, and a good checksum: a simulator in wide use does this
        // when its sonars are switched on.
        let hollow =
            matches!(error, PacketError::SonarsMissing { claimed: 16, bytes } if *bytes < 48);
        assert!(hollow, "{name}: {error}: {frame:02x?}");
    }
    packets
}

#[test]
fn a_session_of_our_own_is_heard() {
    let mut scenario = Scenario::named("lab", &Knobs::default()).unwrap();
    scenario.robot.hollow_sip = true;
    let config = RobotConfig::default();
    let mut rig = Rig::new(&scenario, &config, common::usual(&config));
    let writes = Rc::new(RefCell::new(Vec::new()));
    let written = Rc::clone(&writes);
    rig.to_host = Box::new(move |bytes, _| {
        if !bytes.is_empty() {
            written.borrow_mut().push(bytes.clone());
        }
        bytes
    });
    rig.wait(20_000);
    let packets = converse("simulated", &writes.borrow());
    assert_eq!(packets.refused.len(), 1, "the hollow packet");
    assert_eq!(rig.pilot.tally().rejected, 1);
}

#[test]
fn recorded_sessions_are_heard() {
    let Some(traces) = folder(
        "SIDESTEP_TRACES",
        "the recorded sessions of real robots' hosts",
    ) else {
        return;
    };
    let (mut sessions, mut refused) = (0, 0);
    for entry in std::fs::read_dir(traces).unwrap() {
        let path = entry.unwrap().path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let trace = std::fs::read_to_string(&path).unwrap();
        refused += converse(&name, &robot_bytes(&trace)).refused.len();
        sessions += 1;
    }
    println!("{sessions} sessions, {refused} packets refused");
    assert!(sessions > 0, "no traces there");
    assert!(refused > 0, "the malformed packets are among them");
}
