use sidestep_hw::edge::*;
use sidestep_sim::geometry::*;
use sidestep_sim::scenario::Scenario;
use sidestep_sim::world::World;
fn main() {
    let a: Vec<f64> = std::env::args()
        .skip(1)
        .map(|x| x.parse().unwrap())
        .collect();
    let (width, offset, heading, top) = (a[0], a[1], a[2], a[3]);
    let mut world = World::new();
    let h = width / 2.0;
    for y in [-h, h] {
        world
            .add_wall(Point::new(-1.0, y), Point::new(5.0, y))
            .unwrap();
    }
    if top > -h {
        world
            .add_box(Pose::new(1.8 + 0.125, (top - h) / 2.0, 0.0), 0.25, top + h)
            .unwrap();
    }
    let config = corridor_base().unwrap();
    let course = Course {
        scenario: Scenario {
            name: "try",
            description: String::new(),
            world,
            start: Pose::new(0.0, offset, heading.to_radians()),
            goal: Point::new(3.0, 0.0),
            time_limit_ms: 120_000,
            robot: robot_for(&config),
            sonar_faults: Default::default(),
            seed: 1,
        },
        corners: vec![Point::new(0.0, 0.0), Point::new(3.0, 0.0)],
        laser: Some(sidestep_sim::laser::Parameters {
            noise: a[4],
            step: a[5].to_radians(),
            ..Default::default()
        }),
        config,
        edge: sidestep::edge::PAPER,
        classical: 0.42,
        until: |_| false,
    };
    let t0 = std::time::Instant::now();
    let run = course.run().unwrap();
    println!("{:?} {:?}", run.summary.ending, run.summary.tally.stops);
    println!("{:?}", run.simulation.outcome());
    for h in &run.happenings {
        println!(
            "{:6} {:.3},{:.3} {:.1}° {:?} {:?}",
            h.t,
            h.pose.position.x,
            h.pose.position.y,
            h.pose.heading.to_degrees(),
            h.event,
            h.heard
        );
    }
    println!("classical {}", run.classical.len());
    for s in run.simulation.trace().iter().step_by(20) {
        println!(
            "{:6} {:.3},{:.3} {:.1}° v{:.3} w{:.2} c{:.3}",
            s.time_ms,
            s.pose.position.x,
            s.pose.position.y,
            s.pose.heading.to_degrees(),
            s.speed,
            s.turn_rate,
            s.clearance
        );
    }
    println!("{:?}", t0.elapsed());
}
