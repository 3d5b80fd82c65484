//! Scenarios hold what they say, differ by seed, and come out the same for the same one.

mod common;

use std::collections::VecDeque;

use common::{frame, open, plain};
use sidestep::arcos::HostCommand;
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::robot::Parameters;
use sidestep_sim::scenario::{Knobs, NAMES};
use sidestep_sim::simulation::ByKind;
use sidestep_sim::sonar::Faults;
use sidestep_sim::{ArcosRobot, Error, Scenario, Simulation, World};

fn named(name: &str) -> Scenario {
    Scenario::named(name, &Knobs::default()).unwrap()
}

/// Drives straight on at 0.2 m/s; returns all that the robot said.
fn drive(simulation: &mut Simulation, until_ms: u64) -> Vec<u8> {
    open(simulation);
    let velocity = frame(&HostCommand::velocity(200));
    let mut said = Vec::new();
    while simulation.now_ms() < until_ms {
        simulation.robot_mut().receive(&velocity);
        let next = simulation.now_ms() + 100;
        simulation.advance_to(next);
        said.extend(simulation.robot_mut().transmit());
    }
    said
}

#[test]
fn encounters_meet_the_robot_at_its_cruise() {
    for name in [
        "fig12-head-on",
        "fig12-crossing",
        "fig12-from-side",
        "head-on-80",
    ] {
        let scenario = named(name);
        let mut simulation = scenario.simulate().unwrap();
        assert!(simulation.clearance() > 1.0, "{name}");
        drive(&mut simulation, 12_000);
        let contacts = simulation.outcome().contacts_while_driving;
        assert_eq!(
            contacts,
            ByKind {
                people: 1,
                obstacles: 0
            },
            "{name}"
        );
    }
}

#[test]
fn whoever_stands_is_not_touched_by_the_courteous() {
    for name in NAMES {
        for seed in 0..50 {
            let scenario = named(name).randomised(seed, 0.8).unwrap();
            let mut simulation = scenario.simulate().unwrap();
            simulation.advance_to(40_000);
            let outcome = simulation.outcome();
            assert_eq!(outcome.contacts_at_rest, ByKind::default(), "{name} {seed}");
            assert_eq!(outcome.travelled, 0.0);
        }
    }
    // The same people without manners do touch it.
    let knobs = Knobs {
        courteous: false,
        ..Knobs::default()
    };
    let mut simulation = Scenario::named("fig12-head-on", &knobs)
        .unwrap()
        .simulate()
        .unwrap();
    simulation.advance_to(40_000);
    let outcome = simulation.outcome();
    assert_eq!(
        outcome.contacts_at_rest,
        ByKind {
            people: 1,
            obstacles: 0
        }
    );
    assert_eq!(outcome.contacts_while_driving, ByKind::default());
}

#[test]
fn people_keep_to_the_speed_limit() {
    for name in NAMES {
        for seed in 0..20 {
            let limit = 0.8;
            let mut simulation = named(name)
                .randomised(seed, limit)
                .unwrap()
                .simulate()
                .unwrap();
            drive(&mut simulation, 20_000);
            for pair in simulation.trace().windows(2) {
                let seconds = (pair[1].time_ms - pair[0].time_ms) as f64 / 1000.0;
                for ((_, then), (_, now)) in pair[0].people.iter().zip(&pair[1].people) {
                    assert!(
                        (now - then).norm() <= limit * seconds + 1e-9,
                        "{name} {seed}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_same_seed_says_the_same_bytes() {
    let knobs = Knobs {
        sonar_faults: Faults {
            dropout: 0.1,
            false_echo: 0.05,
            ..Faults::default()
        },
        ..Knobs::default()
    };
    for name in NAMES {
        let said = |seed| {
            let scenario = Scenario::named(name, &knobs).unwrap();
            let mut simulation = scenario.randomised(seed, 0.8).unwrap().simulate().unwrap();
            (drive(&mut simulation, 15_000), simulation.trace().to_vec())
        };
        assert!(said(1) == said(1), "{name}");
        assert!(said(1).0 != said(2).0, "{name}");
    }
    // However the time is cut.
    let scenario = named("lab");
    let [mut whole, mut cut] = [(); 2].map(|()| scenario.simulate().unwrap());
    for simulation in [&mut whole, &mut cut] {
        open(simulation);
        simulation
            .robot_mut()
            .receive(&frame(&HostCommand::rotation(10)));
    }
    whole.advance_to(5000);
    for time in (0..=5000).step_by(7) {
        cut.advance_to(time);
    }
    cut.advance_to(5000);
    assert!(whole.robot_mut().transmit() == cut.robot_mut().transmit());
}

#[test]
fn variations_begin_with_room_and_lead_to_encounters() {
    for name in &NAMES[..4] {
        let mut met = 0;
        for seed in 0..200 {
            let scenario = named(name).randomised(seed, 0.8).unwrap();
            let mut simulation = scenario.simulate().unwrap();
            assert!(simulation.clearance() >= 0.6 - 1e-9, "{name} {seed}");
            drive(&mut simulation, 15_000);
            met += u32::from(simulation.outcome().contacts_while_driving.people > 0);
        }
        // A robot that looks at nothing runs into most of them.
        println!("{name}: {met} of 200 variations touch a robot that drives blindly on");
        assert!(met > 100, "{name}: {met}");
    }
}

#[test]
fn the_lab_has_a_way_with_room_on_both_sides() {
    const CELL: f64 = 0.02;
    let scenario = named("lab");
    let wanted = scenario.robot.base.radius + 0.45;
    let cell = |p: Point| ((p.x / CELL).round() as i32, (p.y / CELL).round() as i32);
    let free = |(i, j): (i32, i32)| {
        let point = Point::new(f64::from(i) * CELL, f64::from(j) * CELL);
        let obstacle = scenario.world.nearest_obstacle(point).unwrap();
        obstacle.distance >= wanted
            && (0.0..5.0).contains(&point.x)
            && (0.0..4.0).contains(&point.y)
    };
    let (from, to) = (cell(scenario.start.position), cell(scenario.goal));
    assert!(free(from) && free(to));
    let mut seen = std::collections::BTreeSet::from([from]);
    let mut queue = VecDeque::from([from]);
    while let Some((i, j)) = queue.pop_front() {
        for next in [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)] {
            if free(next) && seen.insert(next) {
                queue.push_back(next);
            }
        }
    }
    assert!(seen.contains(&to));
    // And the straight way is barred.
    let mut simulation = scenario.simulate().unwrap();
    drive(&mut simulation, 15_000);
    assert_eq!(simulation.outcome().contacts_while_driving.obstacles, 1);
}

#[test]
fn contacts_count_once_under_the_worst_that_happened() {
    let mut world = World::new();
    world.add_disc(Point::new(0.5, 0.0), 0.25).unwrap();
    world
        .add_wall(Point::new(-1.0, -9.0), Point::new(-1.0, 9.0))
        .unwrap();
    let robot = ArcosRobot::new(Parameters::default(), Pose::new(0.0, 0.0, 0.0), 0).unwrap();
    let mut simulation = Simulation::new(world, robot);
    // It begins 51 mm inside the disc, at rest.
    assert!((simulation.clearance() + 0.051).abs() < 1e-5);
    simulation.advance_to(1000);
    let one = ByKind {
        people: 0,
        obstacles: 1,
    };
    assert_eq!(simulation.outcome().contacts_at_rest, one);
    // Turning in place there is worse, and driving away worst.
    open(&mut simulation);
    simulation
        .robot_mut()
        .receive(&frame(&HostCommand::rotation(20)));
    simulation.advance_to(2000);
    assert_eq!(simulation.outcome().contacts_while_turning, one);
    simulation.robot_mut().receive(&frame(&HostCommand::stop()));
    simulation
        .robot_mut()
        .receive(&frame(&HostCommand::velocity(-100)));
    simulation.advance_to(4000);
    simulation.robot_mut().receive(&plain(0));
    let outcome = simulation.outcome();
    assert_eq!(outcome.contacts_while_driving, one);
    assert_eq!(outcome.contacts_while_turning, ByKind::default());
    assert_eq!(outcome.contacts_at_rest, ByKind::default());
    // Clear of the disc and into the wall: a second one.
    for time in (5000..20_000).step_by(1000) {
        simulation.robot_mut().receive(&plain(0));
        simulation.advance_to(time);
    }
    assert_eq!(simulation.outcome().contacts_while_driving.obstacles, 2);
}

#[test]
fn unknown_names_and_bad_knobs_are_refused() {
    let error = Scenario::named("fig13", &Knobs::default()).err().unwrap();
    assert!(matches!(error, Error::UnknownScenario { .. }));
    assert!(
        error.to_string().contains("fig12-head-on, fig12-crossing"),
        "{error}"
    );
    for knobs in [
        Knobs {
            person_speed: Some(-1.0),
            ..Knobs::default()
        },
        Knobs {
            person_speed: Some(f64::NAN),
            ..Knobs::default()
        },
    ] {
        assert!(Scenario::named("lab", &knobs).is_err());
        assert!(Scenario::named("head-on-80", &knobs).is_err());
    }
    let knobs = Knobs {
        sonar_noise: 2.0,
        ..Knobs::default()
    };
    assert!(Scenario::named("lab", &knobs).unwrap().simulate().is_err());
    assert!(named("lab").randomised(0, 0.0).is_err());
}

#[test]
fn an_empty_room_is_empty() {
    let scenario = named("empty-room");
    let way = scenario.goal - scenario.start.position;
    assert!((way.norm() - 4.0).abs() < 1e-9);
    for part in 0..=40 {
        let place = scenario.start.position + way * (f64::from(part) / 40.0);
        assert!(scenario.world.nearest(place).unwrap().distance >= 3.0);
    }
}

#[test]
fn a_corridor_is_as_narrow_as_it_says() {
    for name in ["corridor", "corridor-walker"] {
        let scenario = named(name);
        for x in 0..=10 {
            let place = Point::new(f64::from(x), 0.0);
            let wall = scenario.world.nearest_obstacle(place).unwrap();
            assert!((wall.distance - 0.6).abs() < 1e-6);
        }
        // Somebody who walks it stays between the walls, and does not touch who stands, or does.
        for courteous in [true, false] {
            let knobs = Knobs {
                courteous,
                ..Knobs::default()
            };
            let mut simulation = Scenario::named(name, &knobs).unwrap().simulate().unwrap();
            simulation.advance_to(20_000);
            for (_, place) in simulation.trace().iter().flat_map(|sample| &sample.people) {
                assert!(place.y.abs() <= 0.6 - 0.25 + 1e-3, "{place}");
            }
            let touched = simulation.outcome().contacts_at_rest.people;
            let someone = name == "corridor-walker";
            assert_eq!(touched, u32::from(someone && !courteous), "{name}");
        }
    }
}

#[test]
fn who_blocks_the_way_leaves_it() {
    let mut frees = Vec::new();
    for seed in 0..100 {
        let knobs = Knobs {
            seed,
            ..Knobs::default()
        };
        let scenario = Scenario::named("blocked-way", &knobs).unwrap();
        let mut simulation = scenario.simulate().unwrap();
        simulation.advance_to(scenario.time_limit_ms);
        let trace = simulation.trace();
        let free = scenario.way_free_ms(trace).expect("they leave");
        assert!((10_000..40_000).contains(&free), "seed {seed}: {free}");
        frees.push(free);
        // Nobody has left as long as they are there.
        let before = trace.iter().position(|s| s.time_ms == free).unwrap();
        assert_eq!(scenario.way_free_ms(&trace[..before]), None);
        // A robot that drives on meets them.
        let mut blind = scenario.simulate().unwrap();
        drive(&mut blind, 12_000);
        let touched = blind.outcome().contacts_while_driving.people;
        assert!(touched > 0, "seed {seed}: nobody is in the way");
    }
    frees.dedup();
    assert!(frees.len() > 50);
    let nobody = named("corridor");
    let mut simulation = nobody.simulate().unwrap();
    simulation.advance_to(1000);
    assert_eq!(nobody.way_free_ms(simulation.trace()), None);
}
