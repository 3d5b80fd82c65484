//! S4 driven through the protocol, in virtual time: walls, boxes, ways that are wide enough and
//! ways that are not.

use sidestep::config::{Config, Parameters};
use sidestep::edge::{self, Event};
use sidestep::preset;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::demo::Options;
use sidestep_hw::drive::Status;
use sidestep_hw::edge::{
    Corridors, Course, NAME, corridor_base, demo, narrowed, random, robot_for,
};
use sidestep_sim::scenario::Knobs;
use sidestep_sim::{corridor, laser};

/// Corridors of every kind: no wall is an obstacle, every box is, and nothing is touched.
#[test]
fn walls_are_no_obstacles_and_boxes_are() {
    for with_box in [false, true] {
        let mut sum = Corridors::default();
        for seed in 0..150 {
            let course = random(seed, with_box, 0.42).expect("a course");
            sum.add(&course, &course.run().expect("a run"), with_box);
        }
        println!("{sum:?}");
        assert_eq!((sum.walls_detected, sum.contacts), (0, 0));
        assert_eq!(sum.boxes_missed + sum.out_of_time, 0);
        if with_box {
            let stood = sum.boxes_by_shield + sum.boxes_at_start;
            assert_eq!(sum.boxes_before_300 + stood, sum.runs);
            assert!(sum.boxes_before_300 * 100 > sum.runs * 99);
        } else {
            assert_eq!(sum.covered + sum.held_by_wall, sum.runs);
        }
        // The comparison is one: a threshold does take walls for obstacles here.
        assert!(sum.classical_false > 0);
    }
}

/// 601 mm are passed and 599 mm are reported.
#[test]
fn a_safe_path_is_passed_and_less_is_blocked() {
    let config = corridor_base().expect("a configuration");
    let run = |free| {
        narrowed(free, &config, 1)
            .and_then(|course| course.run())
            .expect("a run")
    };
    let wide = run(0.601);
    assert!(
        wide.summary.tally.arrived.is_some(),
        "{:?}",
        wide.happenings
    );
    assert_eq!(wide.summary.contacts_while_moving(), 0);
    let passed = wide
        .happenings
        .iter()
        .any(|happening| matches!(happening.event, Event::Measured(0, found) if found.passable));
    assert!(passed, "{:?}", wide.happenings);
    let narrow = run(0.599);
    let last = narrow.happenings.last().map(|happening| happening.event);
    assert_eq!(last, Some(Event::Blocked(0)));
    assert_eq!(narrow.summary.contacts_while_moving(), 0);
}

/// A P3-DX is wider than the paper's safe path: its shield does not let it in, and nothing is touched.
#[test]
fn who_does_not_fit_is_not_let_in() {
    let config = RobotConfig {
        core: Config::new(Parameters {
            min_distance: 0.05,
            turn_distance: 0.1,
            ..preset::PIONEER_3DX
        })
        .expect("a configuration"),
        ..corridor_base().expect("a configuration")
    };
    let run = narrowed(0.65, &config, 1)
        .and_then(|course| course.run())
        .expect("a run");
    let last = run.happenings.last().map(|happening| happening.event);
    assert_eq!(last, Some(Event::Blocked(0)), "{:?}", run.happenings);
    assert_eq!(run.summary.contacts_while_moving(), 0);
}

/// The run with three obstacles, with a scanner as it is: every edge covered, three obstacles, no
/// wall, no contact.
#[test]
fn three_obstacles_are_passed() {
    let config = corridor_base().expect("a configuration");
    for seed in 1..=5 {
        let course = Course {
            corridor: corridor::paper(seed, &robot_for(&config)).expect("a corridor"),
            laser: Some(laser::Parameters::default()),
            config,
            edge: edge::PAPER,
            classical: 0.42,
            until: |event| matches!(event, Event::Blocked(_)),
        };
        let run = course.run().expect("a run");
        let covered = |event: &Event| matches!(event, Event::Covered(_));
        let events: Vec<Event> = run.happenings.iter().map(|one| one.event).collect();
        assert_eq!(
            events.iter().filter(|event| covered(event)).count(),
            4,
            "{events:?}"
        );
        assert_eq!(run.summary.contacts_while_moving(), 0);
        let mut obstacles: Vec<_> = run
            .happenings
            .iter()
            .filter(|one| matches!(one.event, Event::Detected(..)))
            .map(|one| one.heard.expect("something was there").0)
            .collect();
        assert!(
            obstacles.iter().all(|body| !course.is_wall(*body)),
            "{events:?}"
        );
        obstacles.dedup();
        assert_eq!(obstacles.len(), 3, "{events:?}");
        assert!(!run.classical.is_empty());
    }
}

/// Without a scanner the robot stays where it would have looked.
#[test]
fn without_a_scanner_it_waits() {
    let config = corridor_base().expect("a configuration");
    let mut course = narrowed(0.75, &config, 1).expect("a course");
    course.laser = None;
    course.corridor.scenario.time_limit_ms = 30_000;
    let run = course.run().expect("a run");
    assert_eq!(run.summary.tally.arrived, None);
    let speeds = run
        .simulation
        .trace()
        .iter()
        .rev()
        .map(|sample| sample.speed);
    assert!(speeds.take(100).all(|speed| speed == 0.0));
}

/// The demonstration leaves what it says it leaves.
#[test]
fn demonstration_is_drawn() {
    let out = std::env::temp_dir().join(format!("sidestep-edge-{}", std::process::id()));
    let options = Options {
        scenario: NAME.to_owned(),
        data: None,
        start_time: 0.0,
        knobs: Knobs::default(),
        speed: 1.0,
        out: out.clone(),
        config: RobotConfig::default(),
    };
    let folder = demo(&options, &mut Status::default()).expect("a demonstration");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect(name);
    let summary = read("summary.txt");
    assert!(summary.contains("edge 4: covered"), "{summary}");
    assert!(summary.contains("before a wall"), "{summary}");
    for name in ["picture.svg", "classical.svg"] {
        assert!(
            read(name).contains("stroke-dasharray"),
            "{name} shows no way"
        );
    }
    std::fs::remove_dir_all(&out).expect("removed");
}
