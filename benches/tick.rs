//! What a control tick costs, and the codec: on the wall clock, and in instructions where valgrind is
//! installed (Debian: `apt-get install valgrind`). A P3-DX with sixteen sonars among echoes at all
//! ranges.
//!
//! ```sh
//! cargo bench                          # everything
//! cargo bench --bench tick -- shield   # what has this in its name
//! ```
//!
//! Times depend on the machine and on what else runs there; instructions hardly do, so compare those.
//! They are the difference between two runs of this program under `valgrind --tool=callgrind`, over the
//! difference in calls: what is done once cancels out.

use nalgebra::Vector2;
use sidestep::arcos::{self, HostCommand, Receiver, SonarReadings, StandardInformation, Tail};
use sidestep::avoid::Avoid;
use sidestep::config::Config;
use sidestep::controller::Controller;
use sidestep::decide::{self, Decide};
use sidestep::edge::{self, Edge, EdgeConfig, PlannedEdge};
use sidestep::escape::Escape;
use sidestep::interact;
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarSample};
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use sidestep::shield::Shield;
use sidestep::valley::{Person, Scene};
use sidestep::view::{Memory, View};
use std::borrow::Cow;
use std::hint::black_box;
use std::process::Command;

/// Faces and directions of sixteen sonars round a robot, in mm and degrees.
fn ring(config: &Config) -> Ring<16> {
    let mut placements = [Placement::from_mm_deg(0, 0, 0); 16];
    for (i, placement) in placements.iter_mut().enumerate() {
        let heading = 11.25 + 22.5 * i as f32;
        let heading = if heading > 180.0 {
            heading - 360.0
        } else {
            heading
        }
        .to_radians();
        *placement = Placement {
            x: 0.16 * heading.cos(),
            y: 0.16 * heading.sin(),
            heading,
        };
    }
    Ring::new(&placements, config).expect("the ring fits the preset")
}

/// A robot on its way, with a moving echo in every cone.
fn observation(tick: u64) -> Observation<16> {
    let now = Instant(1_000 + 100 * tick);
    let mut sonar = [None; 16];
    for (i, sample) in sonar.iter_mut().enumerate() {
        let phase = (tick * 7 + i as u64 * 131) % 400;
        *sample = Some(SonarSample {
            range: 0.7 + phase as f32 / 200.0,
            taken_at: now,
        });
    }
    Observation {
        now,
        sonar,
        odometry: Some(OdometrySample {
            x: 0.02 * (tick % 1000) as f32,
            y: 0.0,
            heading: 0.0,
            speed: 0.2,
            turn_rate: 0.0,
            taken_at: now,
        }),
        sighting: None,
        base: BaseStatus {
            motors_enabled: true,
            stalled: false,
            emergency_stop: false,
        },
    }
}

/// Something that is measured: it does its `i`-th piece of work.
type Work = Box<dyn FnMut(usize)>;

/// A case that is measured.
struct Case {
    name: &'static str,
    /// Bytes that a call goes through, where that is what matters.
    bytes: usize,
    make: fn() -> Work,
}

/// The laws and what they run under, one tick each; then the codec; then what others offer.
const CASES: &[Case] = &[
    case("view: 16 sonars", view),
    case("law: avoid (S1)", || law(Avoid::new(config()))),
    case("law: escape round avoid", || {
        let config = config();
        law(Escape::new(Avoid::new(config), config, ring(&config)))
    }),
    case("law: decide round avoid (S2)", || {
        let config = config();
        let settings = decide::Settings::new(decide::Parameters::USUAL, &config);
        let settings = settings.expect("the defaults fit the preset");
        law(Decide::new(
            Avoid::new(config),
            config,
            ring(&config),
            settings,
        ))
    }),
    case("law: edge (S4)", || {
        let config = config();
        let edge = EdgeConfig::new(edge::PAPER).expect("the paper's values are good");
        let way = PlannedEdge::new(Vector2::new(0.0, 0.0), GOAL).expect("an edge");
        law(Edge::new(config, edge, ring(&config), [way]).expect("a route"))
    }),
    case("S3: valleys between six people", valleys),
    case("shield: 16 sonars", shield),
    case("controller: view, avoid, shield", controller),
    Case {
        name: "codec: read a stream of SIPs",
        bytes: STREAM,
        make: decode,
    },
    case("codec: write a command", encode),
    case("peer: ORCA of dodgy_2d, 5 neighbours", orca),
];

const fn case(name: &'static str, make: fn() -> Work) -> Case {
    Case {
        name,
        bytes: 0,
        make,
    }
}

fn config() -> Config {
    Config::new(preset::PIONEER_3DX).expect("the preset is valid")
}

const GOAL: Vector2<f32> = Vector2::new(50.0, 0.0);

/// Fifty seconds of a robot on its way.
fn observations() -> Vec<Observation<16>> {
    (0..500).map(observation).collect()
}

fn views() -> Vec<View<16>> {
    let (config, mut memory) = (config(), Memory::default());
    let ring = ring(&config);
    observations()
        .iter()
        .map(|observation| {
            let view = memory.update(observation, GOAL, &ring, &config);
            view.expect("there is odometry")
        })
        .collect()
}

fn view() -> Work {
    let (config, observations) = (config(), observations());
    let (ring, mut memory) = (ring(&config), Memory::default());
    Box::new(move |i| {
        let observation = black_box(&observations[i % observations.len()]);
        let _ = black_box(memory.update(observation, GOAL, &ring, &config));
    })
}

fn law(mut law: impl Law<16> + 'static) -> Work {
    let views = views();
    Box::new(move |i| {
        black_box(law.advise(black_box(&views[i % views.len()])));
    })
}

/// What S3's law asks for while it plans.
fn valleys() -> Work {
    let settings = interact::Settings::new(interact::USUAL, &config());
    let settings = settings.expect("the usual values fit the preset");
    let people: Vec<Person> = (0..6)
        .map(|i| {
            let (depth, lateral) = (2.0 + 0.3 * (i % 3) as f32, 0.5 * i as f32 - 1.2);
            Person::at(depth, lateral, 0.22).expect("a place")
        })
        .collect();
    let scene = Scene::new(&people).expect("six people");
    Box::new(move |_| {
        black_box(settings.geometry().valleys(black_box(&scene)));
    })
}

fn shield() -> Work {
    let (config, views) = (config(), views());
    let (ring, mut shield) = (ring(&config), Shield::new(&config));
    let advice = Advice {
        speed: 0.3,
        turn_rate: 0.4,
    };
    Box::new(move |i| {
        let view = black_box(&views[i % views.len()]);
        black_box(shield.assess(view, &ring));
        black_box(shield.admit(advice, view, &ring));
    })
}

fn controller() -> Work {
    let (config, observations) = (config(), observations());
    let ring = ring(&config);
    let controller = Controller::new(config, ring, Avoid::new(config), GOAL);
    let mut controller = controller.expect("the goal is a place");
    println!(
        "a controller for 16 sonars takes {} bytes",
        size_of_val(&controller)
    );
    Box::new(move |i| {
        black_box(controller.tick(black_box(&observations[i % observations.len()])));
    })
}

/// Bytes of the stream that [`decode`] reads in a call: ten SIPs with three readings each.
const STREAM: usize = 10 * 50;

fn decode() -> Work {
    let mut readings = SonarReadings::new();
    for index in 0..3 {
        readings.push(arcos::SonarReading { index, range: 1200 });
    }
    let sip = StandardInformation {
        kind: StandardInformation::MOTORS_MOVING,
        sonars: readings,
        tail: Tail::standard(124, 0),
        ..StandardInformation::default()
    };
    let mut buffer = [0; arcos::MAX_FRAME];
    let frame = sip
        .encode(&mut buffer)
        .expect("it fits")
        .as_bytes()
        .to_vec();
    let stream = frame.repeat(10);
    assert_eq!(stream.len(), STREAM, "a SIP is {} bytes", frame.len());
    let mut receiver = Receiver::new();
    Box::new(move |_| {
        let mut input = black_box(stream.as_slice());
        while let Some(frame) = receiver.next_frame(&mut input) {
            let _ = black_box(StandardInformation::decode(frame));
        }
    })
}

fn encode() -> Work {
    let mut buffer = [0; arcos::MAX_FRAME];
    Box::new(move |i| {
        let command = HostCommand::velocity((i % 400) as i32);
        let _ = black_box(command.encode(black_box(&mut buffer)));
    })
}

/// Another way to avoid: reciprocal velocity obstacles, which take positions and velocities of all
/// others as known. Two sides of a corridor and five people, the robot of the other cases.
fn orca() -> Work {
    let agent = |x, y, vx, vy| dodgy_2d::Agent {
        position: dodgy_2d::Vec2::new(x, y),
        velocity: dodgy_2d::Vec2::new(vx, vy),
        radius: 0.25,
        avoidance_responsibility: 1.0,
    };
    let robot = agent(0.0, 0.0, 0.2, 0.0);
    let people: Vec<Cow<dodgy_2d::Agent>> = (0..5)
        .map(|i| Cow::Owned(agent(1.0 + i as f32, 0.4 * (i % 3) as f32 - 0.4, -0.8, 0.1)))
        .collect();
    let options = dodgy_2d::AvoidanceOptions {
        obstacle_margin: 0.25,
        time_horizon: 3.0,
        obstacle_time_horizon: 1.0,
    };
    Box::new(move |i| {
        let wish = dodgy_2d::Vec2::new(0.4, 0.001 * (i % 100) as f32);
        black_box(robot.compute_avoiding_velocity(
            black_box(&people),
            &[],
            wish,
            0.4,
            0.1,
            &options,
        ));
    })
}

/// Mean time of a call in ns, the best of five rounds.
fn nanoseconds(work: &mut Work) -> f64 {
    const CALLS: usize = 50_000;
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let begun = std::time::Instant::now();
        (0..CALLS).for_each(&mut *work);
        best = best.min(begun.elapsed().as_secs_f64() * 1e9 / CALLS as f64);
    }
    best
}

/// Instructions of a call; none without valgrind.
fn instructions(name: &str) -> Option<f64> {
    const CALLS: [u32; 2] = [500, 2_500];
    let collected = CALLS.map(|calls| {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe().ok()?)
            .args(["--calls", &calls.to_string(), name])
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let collected = text
            .lines()
            .find_map(|line| line.split("Collected : ").nth(1))?;
        collected.trim().parse::<f64>().ok()
    });
    Some((collected[1]? - collected[0]?) / f64::from(CALLS[1] - CALLS[0]))
}

fn main() {
    // Cargo passes --bench along.
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    if let [flag, calls, name] = &words[..]
        && flag == "--calls"
    {
        let case = CASES.iter().find(|case| case.name == name);
        let mut work = (case.expect("a case of that name").make)();
        (0..calls.parse().expect("a number")).for_each(&mut work);
        return;
    }
    println!(
        "{:40} {:>10} {:>14} {:>10}",
        "", "ns", "instructions", "MB/s"
    );
    for case in CASES {
        if !words.is_empty() && !words.iter().any(|word| case.name.contains(word.as_str())) {
            continue;
        }
        let time = nanoseconds(&mut (case.make)());
        let count = instructions(case.name).map_or_else(String::new, |n| format!("{n:.0}"));
        let rate = if case.bytes > 0 {
            format!("{:.0}", case.bytes as f64 * 1000.0 / time)
        } else {
            String::new()
        };
        println!("{:40} {time:10.0} {count:>14} {rate:>10}", case.name);
    }
}
