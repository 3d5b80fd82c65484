//! S4: telling obstacles from walls on a planned edge (Dilmen, Yazıcı and Parlaktuna).
//!
//! The robot follows the edges of a planned path, such as the edges of a generalised Voronoi
//! diagram, and asks of every sonar echo how much of it lies along the edge. A wall beside the way
//! never does enough (`spec/edge.md`, W1); an obstacle on it does. Then the robot stops, a laser
//! scan is taken, and it goes round where at least a safe path's width is free, or reports the
//! edge as blocked.
//!
//! Metres and radians, as everywhere in this crate; the paper's millimetres are in the reference.

use crate::quantity::{Angle, Instant, OutOfRange, in_range};
use crate::ring::Placement;
use crate::view::Pose;
use nalgebra::Vector2;

/// A planned edge, the paper's desired edge (DE): a directed straight piece of the way, in the
/// odometry frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedEdge {
    start: Vector2<f32>,
    end: Vector2<f32>,
    direction: Vector2<f32>,
    length: f32,
}

/// Shortest edge there is, m.
pub const SHORTEST_EDGE: f32 = 0.01;

impl PlannedEdge {
    /// The edge from `start` to `end`, metres in the odometry frame.
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate is not within ±1000 m, or the edge is shorter than
    /// [`SHORTEST_EDGE`].
    pub fn new(start: Vector2<f32>, end: Vector2<f32>) -> Result<Self, OutOfRange> {
        for (field, value) in [
            ("edge start x", start.x),
            ("edge start y", start.y),
            ("edge end x", end.x),
            ("edge end y", end.y),
        ] {
            in_range(field, value, -1e3, 1e3, "m")?;
        }
        let offset = end - start;
        let length = crate::math::norm(offset);
        in_range("edge length", length, SHORTEST_EDGE, 3e3, "m")?;
        Ok(Self {
            start,
            end,
            direction: offset / length,
            length,
        })
    }

    /// Where it begins, m.
    #[must_use]
    pub const fn start(&self) -> Vector2<f32> {
        self.start
    }

    /// Where it ends, m.
    #[must_use]
    pub const fn end(&self) -> Vector2<f32> {
        self.end
    }

    /// Unit vector from start to end.
    #[must_use]
    pub const fn direction(&self) -> Vector2<f32> {
        self.direction
    }

    /// Its length, m.
    #[must_use]
    pub const fn length(&self) -> f32 {
        self.length
    }

    /// A point in the frame of the edge, m: along it from its start, and to the left of it.
    #[must_use]
    pub fn to_edge(&self, point: Vector2<f32>) -> Vector2<f32> {
        let offset = point - self.start;
        Vector2::new(
            offset.dot(&self.direction),
            self.direction.x * offset.y - self.direction.y * offset.x,
        )
    }

    /// A point of the edge's frame in the odometry frame, m.
    #[must_use]
    pub fn to_world(&self, point: Vector2<f32>) -> Vector2<f32> {
        let across = Vector2::new(-self.direction.y, self.direction.x);
        self.start + self.direction * point.x + across * point.y
    }
}

/// One scan of a laser range finder, borrowed. Beam `i` looks in direction
/// `first_angle + i·step` of the scanner's frame, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan<'a> {
    placement: Placement,
    first_angle: f32,
    step: f32,
    reach: f32,
    ranges: &'a [f32],
    taken_at: Instant,
}

/// The most beams a scan may have.
pub const BEAMS_MAX: usize = 4096;

impl<'a> Scan<'a> {
    /// A scan of a scanner that sits at `placement` on the robot and reaches `reach` metres.
    ///
    /// A range in metres is an echo; anything at or beyond `reach`, infinity too, says that nothing
    /// came back from within reach. Whatever is not usable (NaN, negative; a beam that was dazzled,
    /// masked or refused) is never taken for free.
    ///
    /// # Errors
    /// [`OutOfRange`] if the placement is not within 2 m of the centre, the first angle not within
    /// ±2π, the step not in 0.0001 to 0.1 rad, the reach not in 0.5 to 100 m, or if there are fewer
    /// than 2 beams, more than [`BEAMS_MAX`], or more than go once round.
    pub fn new(
        placement: Placement,
        first_angle: f32,
        step: f32,
        reach: f32,
        ranges: &'a [f32],
        taken_at: Instant,
    ) -> Result<Self, OutOfRange> {
        use core::f32::consts::TAU;
        in_range("scanner x", placement.x, -2.0, 2.0, "m")?;
        in_range("scanner y", placement.y, -2.0, 2.0, "m")?;
        Angle::radians(placement.heading)?;
        in_range("first angle", first_angle, -TAU, TAU, "rad")?;
        in_range("angle step", step, 1e-4, 0.1, "rad")?;
        in_range("reach", reach, 0.5, 100.0, "m")?;
        let beams = ranges.len().min(u16::MAX as usize) as f32;
        in_range("beams", beams, 2.0, BEAMS_MAX as f32, "beams")?;
        in_range("angle of scan", (beams - 1.0) * step, 0.0, TAU + step, "rad")?;
        Ok(Self {
            placement,
            first_angle,
            step,
            reach,
            ranges,
            taken_at,
        })
    }

    /// When it was taken.
    #[must_use]
    pub const fn taken_at(&self) -> Instant {
        self.taken_at
    }

    /// The ranges, m.
    #[must_use]
    pub const fn ranges(&self) -> &'a [f32] {
        self.ranges
    }
}

/// A stretch across the way: what lies between two lines along the edge, m, left positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Its right side.
    pub right: f32,
    /// Its left side; not less than `right`.
    pub left: f32,
}

impl Gap {
    /// How wide it is, m.
    #[must_use]
    pub fn width(&self) -> f32 {
        self.left - self.right
    }

    /// Its middle, m.
    #[must_use]
    pub fn middle(&self) -> f32 {
        0.5 * (self.left + self.right)
    }
}

/// What the laser shows round the biggest valued point, in the frame of the planned edge: x along
/// it from its start, y to its left, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// From and to, along the edge.
    pub along: [f32; 2],
    /// From and to, across it.
    pub across: [f32; 2],
}

/// What came of the free-way check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeWay {
    /// The obstacle at the biggest valued point, as far as it is seen; none if the laser sees
    /// nothing there.
    pub obstacle: Option<Extent>,
    /// The widest free stretch across the corridor beside the obstacle, if there is any.
    pub gap: Option<Gap>,
    /// The gap is at least as wide as a safe path.
    pub passable: bool,
}

/// Says what lies across the way: [`FreeWay`] of a scan that was taken at `pose`, for the obstacle
/// at `point` (the biggest valued point, odometry frame, m) on `edge`.
#[must_use]
pub fn free_way(
    scan: &Scan<'_>,
    pose: &Pose,
    edge: &PlannedEdge,
    point: Vector2<f32>,
    safe_path_width: f32,
) -> FreeWay {
    let _ = (scan, pose, edge, point, safe_path_width);
    todo!("in the next commit")
}

/// The states of M3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Along the planned edge.
    FollowEdge,
    /// Something is on the edge: at rest, waiting for the base to stand.
    Stopped,
    /// At rest, waiting for a laser scan.
    Measure,
    /// At rest: the scan is judged.
    FreeWay,
    /// Round the obstacle.
    SubRoute,
    /// Past it and back to the edge.
    Rejoin,
    /// Too far from the edge, or looking away from it: back to it, slowly.
    OffEdge,
    /// No free way: at rest until there is another route.
    Blocked,
    /// The last edge's end is reached.
    Done,
}

/// What a planner, and people, want to know of. The number is the edge's place in the route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The end of the edge is reached.
    Covered(usize),
    /// Something is on the edge, at this point of the odometry frame (the biggest valued point).
    Detected(usize, Vector2<f32>),
    /// What the laser says.
    Measured(usize, FreeWay),
    /// There is no free way along the edge: a new route is wanted.
    Blocked(usize),
}
