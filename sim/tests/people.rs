//! People move as told, never faster, and the courteous ones not into a robot that stands.

use core::f64::consts::PI;

use sidestep_sim::STEP;
use sidestep_sim::geometry::{Point, Vector};
use sidestep_sim::person::{Habit, Motion, Person, Sample};
use sidestep_sim::world::{Footprint, World};

const ROBOT: Footprint = Footprint {
    centre: Point::new(0.0, 0.0),
    radius: 0.3,
    still: true,
};

const FAR: Footprint = Footprint {
    centre: Point::new(100.0, 100.0),
    ..ROBOT
};

fn line(x: f64, y: f64, heading: f64, speed: f64) -> Motion {
    Motion::Line {
        start: Point::new(x, y),
        heading,
        speed,
        delay: 0.0,
    }
}

fn world_with(person: Person) -> World {
    let mut world = World::new();
    world.add_person(person);
    world
}

fn position(world: &World) -> Point {
    world.people()[0].position().unwrap()
}

#[test]
fn waypoints_are_walked_at_the_speed_told() {
    let walk = |patrol| {
        world_with(
            Person::new(Motion::Path {
                start: Point::new(0.0, 0.0),
                waypoints: vec![Point::new(1.0, 0.0), Point::new(1.0, 1.0)],
                speed: 0.5,
                delay: 1.0,
                patrol,
            })
            .unwrap(),
        )
    };
    let mut world = walk(false);
    for (time, x, y) in [
        (1.0, 0.0, 0.0),
        (2.0, 0.5, 0.0),
        (4.0, 1.0, 0.5),
        (9.0, 1.0, 1.0),
    ] {
        while world.time() < time - STEP / 2.0 {
            world.step(&FAR);
        }
        assert!(
            (position(&world) - Point::new(x, y)).norm() < 1e-9,
            "at {time} s"
        );
    }
    // A patrol returns to its first waypoint: 1 s of waiting, 4 s of walking, 2 s back.
    let mut world = walk(true);
    for _ in 0..700 {
        world.step(&FAR);
    }
    assert!((position(&world) - Point::new(1.0, 0.0)).norm() < 1e-9);
}

#[test]
fn recorded_people_are_there_while_recorded() {
    let sample = |time, x| Sample {
        time,
        position: Point::new(x, 0.0),
    };
    let track = Motion::Track(vec![sample(1.0, 0.0), sample(2.0, 1.0), sample(4.0, 0.0)]);
    let world = world_with(Person::new(track).unwrap());
    for (time, x) in [
        (0.0, None),
        (0.99, None),
        (1.0, Some(0.0)),
        (1.25, Some(0.25)),
        (3.0, Some(0.5)),
        (4.0, Some(0.0)),
        (4.01, None),
    ] {
        let world = world.clone().starting_at(time).unwrap();
        assert_eq!(world.people()[0].position().map(|p| p.x), x, "at {time} s");
    }
}

#[test]
fn the_courteous_walk_round_a_standing_robot_at_the_same_speed() {
    for offset in [-0.4, -0.01, 0.0, 0.2, 0.6] {
        let motion = line(-2.0, offset, 0.0, 0.8);
        let mut world = world_with(Person::new(motion).unwrap().courteous(0.15).unwrap());
        let mut way = 0.0;
        let mut nearest = f64::INFINITY;
        for _ in 0..800 {
            let before = position(&world);
            world.step(&ROBOT);
            let step = (position(&world) - before).norm();
            assert!(step <= 0.8 * STEP + 1e-12);
            way += step;
            nearest = nearest.min((position(&world) - ROBOT.centre).norm());
        }
        assert!(nearest >= 0.3 + 0.25 + 0.15 - 0.008, "{offset}: {nearest}");
        assert!((way - 8.0 * 0.8).abs() < 1e-9, "{offset}: walked {way}");
        assert!(
            position(&world).x > 2.0,
            "{offset}: stuck at {}",
            position(&world)
        );
    }
}

#[test]
fn the_courteous_walk_away_from_a_robot_that_is_too_near() {
    let person = Person::new(line(0.5, 0.0, 0.3, 0.5)).unwrap();
    let mut world = world_with(person.courteous(0.15).unwrap());
    for _ in 0..100 {
        world.step(&ROBOT);
    }
    let expected = Point::new(0.5, 0.0) + sidestep_sim::geometry::direction(0.3) * 0.5;
    assert!((position(&world) - expected).norm() < 1e-9);
}

#[test]
fn straight_at_the_robot_the_courteous_keep_to_their_right() {
    let person = Person::new(line(2.0, 0.0, PI, 0.5))
        .unwrap()
        .courteous(0.15)
        .unwrap();
    let mut world = world_with(person);
    for _ in 0..400 {
        world.step(&ROBOT);
    }
    assert!(position(&world).y > 0.3);
}

#[test]
fn the_courteous_wait_if_the_robot_stands_where_they_are_going() {
    let motion = Motion::Path {
        start: Point::new(-2.0, 0.0),
        waypoints: vec![Point::new(0.1, 0.0)],
        speed: 1.0,
        delay: 0.0,
        patrol: false,
    };
    let mut world = world_with(Person::new(motion).unwrap().courteous(0.15).unwrap());
    for _ in 0..500 {
        world.step(&ROBOT);
    }
    assert!(
        (position(&world).x + 0.7).abs() < 0.011,
        "{}",
        position(&world)
    );
    assert_eq!(position(&world).y, 0.0);
}

#[test]
fn a_moving_robot_and_the_discourteous_are_not_given_way() {
    let moving = Footprint {
        still: false,
        ..ROBOT
    };
    let rude = Person::new(line(-2.0, 0.0, 0.0, 1.0)).unwrap();
    let courteous = rude.clone().courteous(0.15).unwrap();
    for (person, robot) in [(rude, ROBOT), (courteous, moving)] {
        let mut world = world_with(person);
        for _ in 0..200 {
            world.step(&robot);
        }
        assert!((position(&world) - Point::new(0.0, 0.0)).norm() < 1e-9);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(Person::new(line(0.0, 0.0, 0.0, -1.0)).is_err());
    assert!(Person::new(line(0.0, 0.0, 0.0, 5.1)).is_err());
    assert!(Person::new(line(f64::NAN, 0.0, 0.0, 1.0)).is_err());
    assert!(Person::new(line(0.0, 0.0, f64::INFINITY, 1.0)).is_err());
    let twice = Sample {
        time: 1.0,
        position: Point::new(0.0, 0.0),
    };
    assert!(Person::new(Motion::Track(vec![twice, twice])).is_err());
    let person = Person::new(line(0.0, 0.0, 0.0, 1.0)).unwrap();
    assert!(person.clone().with_radius(0.0).is_err());
    assert!(person.courteous(-0.1).is_err());
}

#[test]
fn a_path_without_length_does_not_hang() {
    let here = Point::new(1.0, 1.0);
    for waypoints in [vec![], vec![here], vec![here, here]] {
        let mut world = world_with(
            Person::new(Motion::Path {
                start: here,
                waypoints,
                speed: 1.0,
                delay: 0.0,
                patrol: true,
            })
            .unwrap(),
        );
        world.step(&FAR);
        assert_eq!(position(&world), here);
    }
}

fn walk(habit: Habit, speed: f64, acceleration: f64, seed: u64) -> Motion {
    Motion::Walk {
        start: Point::new(2.0, 1.0),
        speed,
        acceleration,
        delay: 0.5,
        habit,
        seed,
    }
}

#[test]
fn those_who_walk_about_keep_their_speed_and_acceleration() {
    for habit in [Habit::Wander, Habit::Charge] {
        for seed in 0..20 {
            let (speed, acceleration) = (0.8, 1.5);
            let mut world =
                world_with(Person::new(walk(habit, speed, acceleration, seed)).unwrap());
            let (mut fastest, mut before) = (0.0_f64, (position(&world), Vector::zeros()));
            for step in 0..2000 {
                // Far away: its hull stops nobody.
                world.step(&FAR);
                let velocity = (position(&world) - before.0) / STEP;
                let change = (velocity - before.1).norm() / STEP;
                assert!(velocity.norm() <= speed + 1e-9, "{habit:?} {seed}");
                assert!(change <= acceleration + 1e-6, "{habit:?} {seed}: {change}");
                assert!((world.people()[0].speed() - velocity.norm()).abs() < 1e-9);
                assert!(step >= 49 || velocity.norm() == 0.0, "before the delay");
                fastest = fastest.max(velocity.norm());
                before = (position(&world), velocity);
            }
            assert!(fastest > 0.5 * speed, "{habit:?} {seed}: {fastest}");
        }
    }
}

#[test]
fn who_charges_reaches_the_robot_and_comes_again() {
    for seed in 0..20 {
        let mut world = world_with(Person::new(walk(Habit::Charge, 0.8, 2.0, seed)).unwrap());
        let (mut touches, mut touching) = (0, false);
        for _ in 0..6000 {
            world.step(&ROBOT);
            let distance = (position(&world) - ROBOT.centre).norm();
            // The hull stops them.
            assert!(distance > 0.3 + 0.25 - 0.01, "{distance}");
            let touches_now = distance <= 0.3 + 0.25;
            touches += u32::from(touches_now && !touching);
            touching = touches_now;
        }
        assert!(touches >= 3, "seed {seed}: {touches} touches in a minute");
    }
}

#[test]
fn the_courteous_who_charge_keep_their_gap() {
    let person = Person::new(walk(Habit::Charge, 0.8, 2.0, 3)).unwrap();
    let mut world = world_with(person.courteous(0.15).unwrap());
    let mut nearest = f64::INFINITY;
    for _ in 0..6000 {
        world.step(&ROBOT);
        nearest = nearest.min((position(&world) - ROBOT.centre).norm());
    }
    assert!((nearest - 0.7).abs() < 0.01, "{nearest}");
}

#[test]
fn walls_stop_those_who_have_a_body() {
    let room = |person: Person| {
        let mut world = world_with(person);
        let low = Point::new(-1.0, -1.0);
        world.add_room(low, Point::new(3.0, 2.0)).unwrap();
        world.add_disc(Point::new(1.0, -0.4), 0.2).unwrap();
        world
    };
    let deepest = |mut world: World| {
        let mut least = f64::INFINITY;
        for _ in 0..3000 {
            world.step(&FAR);
            let obstacle = world.nearest_obstacle(position(&world)).unwrap();
            least = least.min(obstacle.distance - world.people()[0].radius());
        }
        least
    };
    for seed in 0..30 {
        let person = Person::new(walk(Habit::Wander, 1.5, 1000.0, seed)).unwrap();
        let least = deepest(room(person));
        assert!(least > -1e-3, "seed {seed}: {least} m deep");
    }
    let into_the_wall = Person::new(line(0.0, 0.0, 0.3, 1.0)).unwrap();
    assert!(deepest(room(into_the_wall.clone())) < -0.2);
    let stopped = into_the_wall.stopped_by_walls();
    assert!(deepest(room(stopped)) > -1e-3);
}

#[test]
fn the_same_seed_walks_the_same_way() {
    let end = |seed| {
        let mut world = world_with(Person::new(walk(Habit::Wander, 0.8, 1.0, seed)).unwrap());
        for _ in 0..1000 {
            world.step(&ROBOT);
        }
        position(&world)
    };
    assert_eq!(end(1), end(1));
    assert_ne!(end(1), end(2));
}

#[test]
fn no_walk_without_acceleration() {
    for acceleration in [0.0, -1.0, 1001.0, f64::NAN] {
        assert!(Person::new(walk(Habit::Wander, 0.8, acceleration, 0)).is_err());
    }
    assert!(Person::new(walk(Habit::Wander, 5.1, 1.0, 0)).is_err());
}
