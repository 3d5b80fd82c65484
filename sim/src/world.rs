//! The plane the robot drives in: still obstacles and people.
//!
//! Distances and rays are answered by `parry2d`, in the frame of the place that asks, so that
//! single precision costs less than a micrometre anywhere within range of a sensor.

use parry2d::math::{Pose as Isometry, Rot2, Vec2};
use parry2d::query::Ray;
use parry2d::shape::{Ball, Cuboid, Segment, SharedShape};

use crate::STEP;
use crate::error::{Error, require};
use crate::geometry::{Point, Pose, Vector, direction, heading_of};
use crate::person::{Moment, Person};

/// Outline of a still obstacle, in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A wall without thickness.
    Wall {
        /// One end (m).
        from: Point,
        /// The other end (m).
        to: Point,
    },
    /// A solid rectangle.
    Box {
        /// Its centre, and the direction of its length.
        pose: Pose,
        /// Extent along the heading (m).
        length: f64,
        /// Extent across the heading (m).
        width: f64,
    },
    /// A solid disc.
    Disc {
        /// Its centre (m).
        centre: Point,
        /// Its radius (m).
        radius: f64,
    },
}

/// A convex body about its own centre, as the geometry library wants it.
#[derive(Clone)]
pub(crate) struct Solid {
    convex: SharedShape,
    rotation: Rot2,
    /// Radius of the circle about the centre that holds the whole body (m).
    bound: f64,
}

impl Solid {
    pub(crate) fn disc(radius: f64) -> Self {
        Self {
            convex: SharedShape::new(Ball::new(radius as f32)),
            rotation: Rot2::IDENTITY,
            bound: radius,
        }
    }

    /// Distance from a point to the body's surface (m), 0 inside, when the centre lies at `offset`
    /// from the point.
    fn distance(&self, offset: Vector) -> f64 {
        let pose = Isometry::from_parts(single(offset), self.rotation);
        f64::from(self.convex.distance_to_point(&pose, Vec2::ZERO, true))
    }

    /// From a point to the nearest one of the body, zero inside, when the centre lies at `offset`
    /// from the point (m).
    fn nearest(&self, offset: Vector) -> Vector {
        let pose = Isometry::from_parts(single(offset), self.rotation);
        let nearest = self.convex.project_point(&pose, Vec2::ZERO, true).point;
        Vector::new(f64::from(nearest.x), f64::from(nearest.y))
    }
}

/// A still obstacle.
#[derive(Clone)]
struct Obstacle {
    shape: Shape,
    centre: Point,
    solid: Solid,
}

/// What stops people: the still obstacles.
#[derive(Clone, Copy)]
pub(crate) struct Walls<'a>(&'a [Obstacle]);

impl Walls<'_> {
    /// What is left of `step` (m) for a disc at `position`: what leads into an obstacle is taken
    /// away, what leads along it stays. Never longer than `step`.
    pub(crate) fn slide(self, position: Point, step: Vector, radius: f64) -> Vector {
        let Some((outward, depth)) = self.deepest(position + step, radius) else {
            return step;
        };
        let inward = -step.dot(&outward);
        let slid = step + outward * inward.clamp(0.0, depth);
        // Between two of them there may be no way at all.
        match self.deepest(position + slid, radius) {
            Some((_, left)) if left > TOLERANCE && left >= self.depth(position, radius) => {
                Vector::zeros()
            }
            _ => slid,
        }
    }

    fn depth(self, centre: Point, radius: f64) -> f64 {
        self.deepest(centre, radius).map_or(0.0, |(_, depth)| depth)
    }

    /// How deep a disc reaches into an obstacle (m), where it does most, and the direction out.
    fn deepest(self, centre: Point, radius: f64) -> Option<(Vector, f64)> {
        let mut deepest: Option<(Vector, f64)> = None;
        for obstacle in self.0 {
            let offset = obstacle.centre - centre;
            if offset.norm() >= radius + obstacle.solid.bound {
                continue;
            }
            let inward = obstacle.solid.nearest(offset);
            let depth = radius - inward.norm();
            if depth > 0.0
                && deepest.is_none_or(|(_, most)| depth > most)
                && let Some(inward) = inward.try_normalize(1e-6)
            {
                deepest = Some((-inward, depth));
            }
        }
        deepest
    }
}

/// What single precision makes of a touch (m).
const TOLERANCE: f64 = 1e-5;

/// Something that can be hit: the index says which one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Body {
    /// A still obstacle, by its place in [`World::obstacles`].
    Obstacle(usize),
    /// A person, by their place in [`World::people`].
    Person(usize),
}

/// The nearest body of those asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Distance to its surface (m); 0 inside it.
    pub distance: f64,
    /// Which body.
    pub body: Body,
}

/// The sector a range sensor listens to: everything within `range` and `half_angle` of its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The sensor's face, and its axis.
    pub apex: Pose,
    /// Half of the opening angle, in [0, π/2) (rad); 0 is a single ray.
    pub half_angle: f64,
    /// Reach (m).
    pub range: f64,
}

/// The robot as the people around it see it: a disc, standing or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Its centre (m).
    pub centre: Point,
    /// Its radius (m).
    pub radius: f64,
    /// Whether it stands still.
    pub still: bool,
}

/// Still obstacles, people, and the time they have reached.
#[derive(Clone, Default)]
pub struct World {
    obstacles: Vec<Obstacle>,
    people: Vec<Person>,
    time: f64,
}

impl World {
    /// An empty plane at time 0.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a wall between two different points (m).
    pub fn add_wall(&mut self, from: Point, to: Point) -> Result<(), Error> {
        check_place("wall.from", &from)?;
        check_place("wall.to", &to)?;
        let along = to - from;
        let length = check_size("wall.length", along.norm())?;
        let half = Vec2::new(length as f32 / 2.0, 0.0);
        self.obstacles.push(Obstacle {
            shape: Shape::Wall { from, to },
            centre: from + along / 2.0,
            solid: Solid {
                convex: SharedShape::new(Segment::new(-half, half)),
                rotation: Rot2::new(heading_of(&along) as f32),
                bound: length / 2.0,
            },
        });
        Ok(())
    }

    /// Adds the four walls of the room between two opposite corners (m).
    pub fn add_room(&mut self, low: Point, high: Point) -> Result<(), Error> {
        let corners = [
            low,
            Point::new(high.x, low.y),
            high,
            Point::new(low.x, high.y),
        ];
        for i in 0..4 {
            self.add_wall(corners[i], corners[(i + 1) % 4])?;
        }
        Ok(())
    }

    /// Adds a solid box: `length` along the heading of `pose`, `width` across it (m).
    pub fn add_box(&mut self, pose: Pose, length: f64, width: f64) -> Result<(), Error> {
        check_place("box.centre", &pose.position)?;
        require("box.heading", pose.heading, "finite rad", |_| true)?;
        check_size("box.length", length)?;
        check_size("box.width", width)?;
        let half = Vec2::new(length as f32 / 2.0, width as f32 / 2.0);
        self.obstacles.push(Obstacle {
            shape: Shape::Box {
                pose,
                length,
                width,
            },
            centre: pose.position,
            solid: Solid {
                convex: SharedShape::new(Cuboid::new(half)),
                rotation: Rot2::new(pose.heading as f32),
                bound: libm::hypot(length, width) / 2.0,
            },
        });
        Ok(())
    }

    /// Adds a solid disc (m).
    pub fn add_disc(&mut self, centre: Point, radius: f64) -> Result<(), Error> {
        check_place("disc.centre", &centre)?;
        check_size("disc.radius", radius)?;
        self.obstacles.push(Obstacle {
            shape: Shape::Disc { centre, radius },
            centre,
            solid: Solid::disc(radius),
        });
        Ok(())
    }

    /// Adds a person.
    pub fn add_person(&mut self, person: Person) {
        self.people.push(person);
    }

    /// The same world at `time` (s): recorded people are where they were recorded then.
    pub fn starting_at(mut self, time: f64) -> Result<Self, Error> {
        self.time = require("world.time", time, ">= 0 s", |t| t >= 0.0)?;
        for person in &mut self.people {
            person.place_at(time);
        }
        Ok(self)
    }

    /// Outlines of the still obstacles.
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = &Shape> {
        self.obstacles.iter().map(|obstacle| &obstacle.shape)
    }

    /// Everyone who is, was or will be there: see [`Person::position`].
    #[must_use]
    pub fn people(&self) -> &[Person] {
        &self.people
    }

    pub(crate) fn people_mut(&mut self) -> &mut [Person] {
        &mut self.people
    }

    /// The world's clock (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Moves the people on by one step, past a robot at `robot`.
    pub fn step(&mut self, robot: &Footprint) {
        self.time += STEP;
        let now = Moment {
            time: self.time,
            dt: STEP,
            robot: *robot,
            walls: Walls(&self.obstacles),
        };
        for person in &mut self.people {
            person.step(&now);
        }
    }

    /// The body nearest to `point`, if there is any.
    #[must_use]
    pub fn nearest(&self, point: Point) -> Option<Nearest> {
        nearest_to(point, self.bodies())
    }

    /// The person nearest to `point`, if anyone is there.
    #[must_use]
    pub fn nearest_person(&self, point: Point) -> Option<Nearest> {
        nearest_to(point, self.present())
    }

    /// The still obstacle nearest to `point`, if there is any.
    #[must_use]
    pub fn nearest_obstacle(&self, point: Point) -> Option<Nearest> {
        nearest_to(point, self.still())
    }

    /// The point of obstacle `index` that is nearest to `from` (m), if there is such an obstacle.
    #[must_use]
    pub fn nearest_point(&self, index: usize, from: Point) -> Option<Point> {
        let obstacle = self.obstacles.get(index)?;
        Some(from + obstacle.solid.nearest(obstacle.centre - from))
    }

    /// Distance from the hull of a disc at `centre` to the nearest body (m): negative where they
    /// overlap, infinite in an empty world.
    #[must_use]
    pub fn clearance(&self, centre: Point, radius: f64) -> f64 {
        self.nearest(centre)
            .map_or(f64::INFINITY, |nearest| nearest.distance - radius)
    }

    /// The bodies that a disc at `centre` touches or overlaps.
    pub fn touching(&self, centre: Point, radius: f64) -> impl Iterator<Item = Body> {
        self.bodies().filter_map(move |placed| {
            let offset = placed.centre - centre;
            let near = offset.norm() <= radius + placed.solid.bound;
            (near && placed.solid.distance(offset) <= radius).then_some(placed.body)
        })
    }

    /// The nearest surface inside `cone`: what an ideal sonar there hears first.
    ///
    /// The part of a convex body inside a cone narrower than π is convex: its nearest point is the
    /// body's own nearest point if that lies inside, and otherwise the place where an edge of the
    /// cone first meets the body.
    #[must_use]
    pub fn nearest_in_cone(&self, cone: &Cone) -> Option<Nearest> {
        let axis = single(direction(cone.apex.heading));
        let cos_half = libm::cos(cone.half_angle) as f32;
        let edges = [-cone.half_angle, cone.half_angle]
            .map(|side| Ray::new(Vec2::ZERO, single(direction(cone.apex.heading + side))));
        let apex = cone.apex.position;
        nearest_by(self.bodies(), apex, cone.range, |solid, offset, limit| {
            let pose = Isometry::from_parts(single(offset), solid.rotation);
            let nearest = solid.convex.project_point(&pose, Vec2::ZERO, true);
            let distance = nearest.point.length();
            if nearest.point.dot(axis) >= distance * cos_half {
                return Some(f64::from(distance));
            }
            edges
                .iter()
                .filter_map(|edge| solid.convex.cast_ray(&pose, edge, limit as f32, true))
                .reduce(f32::min)
                .map(f64::from)
        })
    }

    /// Everything that can be hit now.
    fn bodies(&self) -> impl Iterator<Item = Placed<'_>> {
        self.still().chain(self.present())
    }

    fn still(&self) -> impl Iterator<Item = Placed<'_>> {
        let obstacles = self.obstacles.iter().enumerate();
        obstacles.map(|(i, obstacle)| Placed {
            body: Body::Obstacle(i),
            centre: obstacle.centre,
            solid: &obstacle.solid,
        })
    }

    fn present(&self) -> impl Iterator<Item = Placed<'_>> {
        let people = self.people.iter().enumerate();
        people.filter_map(|(i, person)| {
            Some(Placed {
                body: Body::Person(i),
                centre: person.position()?,
                solid: person.solid(),
            })
        })
    }
}

/// A body where it is.
struct Placed<'a> {
    body: Body,
    centre: Point,
    solid: &'a Solid,
}

fn nearest_to<'a>(point: Point, bodies: impl Iterator<Item = Placed<'a>>) -> Option<Nearest> {
    nearest_by(bodies, point, f64::INFINITY, |solid, offset, _| {
        Some(solid.distance(offset))
    })
}

/// The nearest body by `distance`, which is told the body, where its centre lies from `origin`, and
/// the distance beyond which nothing matters any more.
fn nearest_by<'a>(
    bodies: impl Iterator<Item = Placed<'a>>,
    origin: Point,
    limit: f64,
    distance: impl Fn(&Solid, Vector, f64) -> Option<f64>,
) -> Option<Nearest> {
    let mut limit = limit;
    let mut best = None;
    for Placed {
        body,
        centre,
        solid,
    } in bodies
    {
        let offset = centre - origin;
        if offset.norm() - solid.bound > limit {
            continue;
        }
        if let Some(found) = distance(solid, offset, limit).filter(|found| *found <= limit) {
            limit = found;
            best = Some(Nearest {
                distance: found,
                body,
            });
        }
    }
    best
}

/// `vector` in the geometry library's single precision.
fn single(vector: Vector) -> Vec2 {
    Vec2::new(vector.x as f32, vector.y as f32)
}

/// Farthest that anything may be from the origin, and largest that it may be (m).
const FARTHEST: f64 = 10_000.0;

/// Smallest that anything may be (m).
const SMALLEST: f64 = 0.001;

pub(crate) fn check_place(field: &'static str, point: &Point) -> Result<(), Error> {
    for coordinate in [point.x, point.y] {
        require(field, coordinate, "-10000..=10000 m", |c| {
            c.abs() <= FARTHEST
        })?;
    }
    Ok(())
}

pub(crate) fn check_size(field: &'static str, size: f64) -> Result<f64, Error> {
    require(field, size, "0.001..=10000 m", |s| {
        (SMALLEST..=FARTHEST).contains(&s)
    })
}
