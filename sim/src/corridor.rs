//! Planned ways through corridors, as S4 drives them.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::Error;
use crate::geometry::{Point, Pose};
use crate::robot;
use crate::scenario::Scenario;
use crate::sonar::Faults;
use crate::world::World;

/// A situation with a way through it.
#[derive(Clone)]
pub struct Corridor {
    /// World, start and robot; the goal is the end of the way.
    pub scenario: Scenario,
    /// The corners of the way (m).
    pub way: Vec<Point>,
    /// How many of the world's obstacles, the first ones, are walls.
    pub walls: usize,
}

/// A straight corridor made up from a seed: 1200 to 2400 mm wide, its edge in the middle and 3 m
/// long, the robot up to 300 mm beside it and up to 50° off; with a box of 100 to 600 mm on the
/// edge, if asked for.
pub fn random(seed: u64, with_box: bool, robot: &robot::Parameters) -> Result<Corridor, Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // Streams from 0 up belong to the sonars.
    rng.set_stream(u64::MAX - 2);
    let half_width = rng.random_range(1.2..=2.4) / 2.0;
    let offset = rng.random_range(-0.3..=0.3);
    let heading = rng.random_range(-50.0..=50.0_f64).to_radians();
    let mut world = World::new();
    for y in [-half_width, half_width] {
        world.add_wall(Point::new(-2.0, y), Point::new(6.0, y))?;
    }
    if with_box {
        let size = rng.random_range(0.1..=0.6);
        let x = rng.random_range(0.8..=2.4);
        // The edge runs through it.
        let y = rng.random_range(-0.5..=0.5) * size;
        let turned = rng.random_range(-30.0..=30.0_f64).to_radians();
        world.add_box(Pose::new(x, y, turned), size, size)?;
    }
    let way = vec![Point::new(0.0, 0.0), Point::new(3.0, 0.0)];
    let description = format!("a corridor {:.0} mm wide", 2000.0 * half_width);
    let start = Pose::new(0.0, offset, heading);
    Ok(corridor(
        "corridor",
        description,
        world,
        start,
        way,
        2,
        robot,
        seed,
    ))
}

/// A corridor 1200 mm wide whose obstacle leaves `free` m on the left, up to the wall, for the robot
/// in its middle: what S4 measures before it decides.
pub fn narrowed(free: f64, seed: u64, robot: &robot::Parameters) -> Result<Corridor, Error> {
    let mut world = World::new();
    for y in [-0.6, 0.6] {
        world.add_wall(Point::new(-2.0, y), Point::new(6.0, y))?;
    }
    let width = 1.2 - free;
    world.add_box(Pose::new(1.925, width / 2.0 - 0.6, 0.0), 0.25, width)?;
    let way = vec![Point::new(0.0, 0.0), Point::new(3.5, 0.0)];
    let description = format!("an obstacle leaves {:.0} mm", 1000.0 * free);
    let start = Pose::new(0.0, 0.0, 0.0);
    Ok(corridor(
        "narrowed",
        description,
        world,
        start,
        way,
        2,
        robot,
        seed,
    ))
}

/// S4's corridors of 1200 mm with its obstacle, (1800, 2400) to (2050, 2850), on its edge from (1000,
/// 3000) to (3000, 3000), and two more round two corners. Where corners and the others stand is not
/// in the paper's text. The robot begins beside the edge and looks askance, as it does in practice.
pub fn paper(seed: u64, robot: &robot::Parameters) -> Result<Corridor, Error> {
    let mut world = World::new();
    // Outside and inside of a U that opens to the left.
    let outside = [(0.0, 2.4), (5.6, 2.4), (5.6, 7.6), (0.0, 7.6)];
    let inside = [(0.0, 3.6), (4.4, 3.6), (4.4, 6.4), (0.0, 6.4)];
    for line in [outside, inside] {
        for pair in line.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|(x, y)| Point::new(x, y));
            world.add_wall(from, to)?;
        }
    }
    let obstacles = [
        (1.925, 2.625, 0.25, 0.45),
        (5.375, 4.9, 0.45, 0.25),
        (2.6, 6.6, 0.3, 0.4),
    ];
    for (x, y, length, width) in obstacles {
        world.add_box(Pose::new(x, y, 0.0), length, width)?;
    }
    let way = [(1.0, 3.0), (3.0, 3.0), (5.0, 3.0), (5.0, 7.0), (1.0, 7.0)];
    let way = way.map(|(x, y)| Point::new(x, y)).to_vec();
    let description = "S4's corridors, 1200 mm wide, with three obstacles".to_owned();
    let start = Pose::new(1.0, 3.25, -0.35);
    Ok(corridor(
        "edge",
        description,
        world,
        start,
        way,
        6,
        robot,
        seed,
    ))
}

#[expect(clippy::too_many_arguments, reason = "what a corridor consists of")]
fn corridor(
    name: &'static str,
    description: String,
    world: World,
    start: Pose,
    way: Vec<Point>,
    walls: usize,
    robot: &robot::Parameters,
    seed: u64,
) -> Corridor {
    let goal = way.last().copied().unwrap_or(start.position);
    Corridor {
        scenario: Scenario {
            name,
            description,
            world,
            start,
            goal,
            time_limit_ms: 240_000,
            robot: robot.clone(),
            sonar_faults: Faults::default(),
            seed,
        },
        way,
        walls,
    }
}
