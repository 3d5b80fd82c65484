//! Geometry against values computed by hand, and cones against dense sampling.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sidestep_sim::geometry::{Point, Pose, direction, heading_of, wrap};
use sidestep_sim::world::{Body, Cone, Shape};
use sidestep_sim::{Error, World};

const NEAR: f64 = 1e-5;

fn cone(x: f64, y: f64, heading: f64, half_angle_deg: f64) -> Cone {
    Cone {
        apex: Pose::new(x, y, heading),
        half_angle: half_angle_deg.to_radians(),
        range: 5.0,
    }
}

#[track_caller]
fn assert_hears(world: &World, cone: Cone, expected: Option<f64>) {
    let heard = world.nearest_in_cone(&cone).map(|nearest| nearest.distance);
    match (heard, expected) {
        (Some(heard), Some(expected)) if (heard - expected).abs() < NEAR => {}
        (None, None) => {}
        _ => panic!("heard {heard:?}, expected {expected:?}"),
    }
}

#[test]
fn a_wall_is_heard_at_its_foot_or_where_the_edge_meets_it() {
    let mut world = World::new();
    world
        .add_wall(Point::new(2.0, -10.0), Point::new(2.0, 10.0))
        .unwrap();
    assert_hears(&world, cone(0.0, 0.0, 0.0, 15.0), Some(2.0));
    // 10° off, the foot is still inside; 40° off, the edge at 25° meets the wall at 2/cos 25°.
    assert_hears(&world, cone(0.0, 0.0, 10_f64.to_radians(), 15.0), Some(2.0));
    let edge = 2.0 / 25_f64.to_radians().cos();
    assert_hears(
        &world,
        cone(0.0, 0.0, 40_f64.to_radians(), 15.0),
        Some(edge),
    );
    // Away from it, and too far along it.
    assert_hears(&world, cone(0.0, 0.0, PI, 15.0), None);
    assert_hears(&world, cone(0.0, 0.0, 88_f64.to_radians(), 15.0), None);
    // From the other side.
    assert_hears(&world, cone(3.0, 0.0, PI, 15.0), Some(1.0));
}

#[test]
fn the_end_of_a_wall_is_heard() {
    let mut world = World::new();
    // It begins at (1, 1) and leads away: the nearest point is the end itself, at 45°.
    world
        .add_wall(Point::new(1.0, 1.0), Point::new(3.0, 3.0))
        .unwrap();
    assert_hears(
        &world,
        cone(0.0, 0.0, FRAC_PI_4 - 0.2, 15.0),
        Some(2_f64.sqrt()),
    );
    assert_hears(&world, cone(0.0, 0.0, FRAC_PI_4 - 0.3, 15.0), None);
}

#[test]
fn discs_and_boxes_are_heard() {
    let mut world = World::new();
    world.add_disc(Point::new(3.0, 0.0), 0.25).unwrap();
    assert_hears(&world, cone(0.0, 0.0, 0.0, 15.0), Some(2.75));
    // 19° off: the edge at 4° cuts the disc at d cos a − √(r² − d² sin² a).
    let (sin, cos) = 4_f64.to_radians().sin_cos();
    let cut = 3.0 * cos - (0.0625 - 9.0 * sin * sin).sqrt();
    assert_hears(&world, cone(0.0, 0.0, 19_f64.to_radians(), 15.0), Some(cut));
    // A disc seen under ±asin(0.25/3) = ±4.78° is just missed.
    assert_hears(&world, cone(0.0, 0.0, 19.8_f64.to_radians(), 15.0), None);

    let mut world = World::new();
    let turned = Pose::new(0.0, 2.0, FRAC_PI_4);
    world.add_box(turned, 1.0, 1.0).unwrap();
    // Its corner points down.
    assert_hears(
        &world,
        cone(0.0, 0.0, FRAC_PI_2, 15.0),
        Some(2.0 - 0.5_f64.sqrt()),
    );
    // Inside a body there is no distance left.
    assert_hears(&world, cone(0.0, 2.0, 0.0, 15.0), Some(0.0));
}

#[test]
fn the_nearest_of_several_is_found() {
    let mut world = World::new();
    world
        .add_room(Point::new(-2.0, -1.0), Point::new(3.0, 4.0))
        .unwrap();
    world.add_disc(Point::new(0.0, 2.0), 0.5).unwrap();
    let nearest = world.nearest(Point::new(0.0, 0.0)).unwrap();
    assert_eq!(nearest.body, Body::Obstacle(0));
    assert!((nearest.distance - 1.0).abs() < NEAR);
    let nearest = world.nearest(Point::new(0.0, 1.2)).unwrap();
    assert_eq!(nearest.body, Body::Obstacle(4));
    assert!((nearest.distance - 0.3).abs() < NEAR);
    assert!((world.clearance(Point::new(0.0, 1.2), 0.4) + 0.1).abs() < NEAR);
    assert_eq!(
        world
            .touching(Point::new(0.0, 1.2), 0.4)
            .collect::<Vec<_>>(),
        [Body::Obstacle(4)]
    );
    assert_eq!(World::new().nearest(Point::new(0.0, 0.0)), None);
    assert_eq!(
        World::new().clearance(Point::new(0.0, 0.0), 0.3),
        f64::INFINITY
    );
}

/// Points on the outline of `shape`, at most `spacing` apart, as its definition has them.
fn outline(shape: &Shape, spacing: f64) -> Vec<Point> {
    let line = |from: Point, to: Point| {
        let count = ((to - from).norm() / spacing).ceil() as usize;
        (0..=count).map(move |i| from + (to - from) * (i as f64 / count as f64))
    };
    match *shape {
        Shape::Wall { from, to } => line(from, to).collect(),
        Shape::Box {
            pose,
            length,
            width,
        } => {
            let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| {
                let corner = Pose::new(x * length / 2.0, y * width / 2.0, 0.0);
                pose.compose(&corner).position
            });
            (0..4)
                .flat_map(|i| line(corners[i], corners[(i + 1) % 4]))
                .collect()
        }
        Shape::Disc { centre, radius } => {
            let count = (2.0 * PI * radius / spacing).ceil() as usize;
            (0..count)
                .map(|i| centre + direction(2.0 * PI * i as f64 / count as f64) * radius)
                .collect()
        }
    }
}

#[test]
fn a_cone_hears_what_dense_sampling_finds() {
    const SPACING: f64 = 0.001;
    const CLOSEST: f64 = 0.2;
    // A point of an outline and the sample next to it are seen under at most this angle.
    let blur = (SPACING / CLOSEST).asin();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut heard_something = 0;
    for case in 0..300 {
        let mut world = World::new();
        let place = |rng: &mut ChaCha8Rng| {
            Point::new(rng.random_range(-4.0..4.0), rng.random_range(-4.0..4.0))
        };
        for _ in 0..3 {
            let (a, b) = (place(&mut rng), place(&mut rng));
            world.add_wall(a, b).unwrap();
            let centre = place(&mut rng);
            world.add_disc(centre, rng.random_range(0.05..0.5)).unwrap();
            let pose = Pose {
                position: place(&mut rng),
                heading: rng.random_range(-PI..PI),
            };
            let sides = [(); 2].map(|()| rng.random_range(0.1..1.5));
            world.add_box(pose, sides[0], sides[1]).unwrap();
        }
        let cone = Cone {
            apex: Pose::new(0.0, 0.0, rng.random_range(-PI..PI)),
            half_angle: rng.random_range(0.05..0.8),
            range: rng.random_range(1.0..5.0),
        };
        if world.nearest(cone.apex.position).unwrap().distance < CLOSEST {
            continue;
        }
        let sampled = |half_angle: f64| {
            world
                .obstacles()
                .flat_map(|shape| outline(shape, SPACING))
                .map(|point| point - cone.apex.position)
                .filter(|to| wrap(heading_of(to) - cone.apex.heading).abs() <= half_angle)
                .map(|to| to.norm())
                .fold(f64::INFINITY, f64::min)
        };
        let heard = world
            .nearest_in_cone(&cone)
            .map_or(f64::INFINITY, |n| n.distance);
        let (over, under) = (sampled(cone.half_angle), sampled(cone.half_angle + blur));
        if heard.is_finite() {
            heard_something += 1;
            assert!(
                heard <= over + NEAR,
                "case {case}: heard {heard}, sampled {over}"
            );
            assert!(
                heard >= under - SPACING,
                "case {case}: heard {heard}, sampled {under}"
            );
            assert!(heard <= cone.range);
        } else {
            assert!(over >= cone.range - NEAR, "case {case}: deaf to {over}");
        }
    }
    assert!(
        heard_something > 100,
        "only {heard_something} cases heard anything"
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let mut world = World::new();
    let origin = Point::new(0.0, 0.0);
    assert!(world.add_wall(origin, origin).is_err());
    assert!(world.add_wall(origin, Point::new(f64::NAN, 0.0)).is_err());
    assert!(world.add_wall(origin, Point::new(1e5, 0.0)).is_err());
    assert!(world.add_disc(origin, -1.0).is_err());
    assert!(
        world
            .add_box(Pose::new(0.0, 0.0, f64::INFINITY), 1.0, 1.0)
            .is_err()
    );
    let error = world
        .add_box(Pose::new(0.0, 0.0, 0.0), 1.0, 0.0)
        .unwrap_err();
    assert_eq!(
        error,
        Error::OutOfRange {
            field: "box.width",
            value: 0.0,
            allowed: "0.001..=10000 m"
        }
    );
    assert_eq!(
        error.to_string(),
        "box.width = 0 is out of range: allowed 0.001..=10000 m"
    );
    assert_eq!(world.obstacles().len(), 0);
}

#[test]
fn poses_compose_and_angles_wrap() {
    let robot = Pose::new(1.0, 2.0, FRAC_PI_2);
    let sonar = robot.compose(&Pose::new(0.1, -0.2, -FRAC_PI_2));
    assert!((sonar.position - Point::new(1.2, 2.1)).norm() < 1e-12);
    assert!(sonar.heading.abs() < 1e-12);
    assert_eq!(wrap(PI), PI);
    assert_eq!(wrap(-PI), PI);
    assert!((wrap(3.0 * PI + 0.1) - (0.1 - PI)).abs() < 1e-12);
    // A quarter of a circle of radius 1.
    let end = Pose::new(0.0, 0.0, 0.0).along_arc(FRAC_PI_2, FRAC_PI_2);
    assert!((end.position - Point::new(1.0, 1.0)).norm() < 1e-12);
    assert!((end.heading - FRAC_PI_2).abs() < 1e-12);
}
