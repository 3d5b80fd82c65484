//! S4: telling obstacles from walls on a planned edge (Dilmen, Yazıcı and Parlaktuna).
//!
//! The robot follows the edges of a planned path, such as the edges of a generalised Voronoi
//! diagram, and asks of every sonar echo how much of it lies along the edge. A wall beside the way
//! never does enough (`spec/edge.md`, W1); an obstacle on it does. Then the robot stops, a laser
//! scan is taken, and it goes round where at least a safe path's width is free, or reports the
//! edge as blocked.
//!
//! Metres and radians, as everywhere in this crate; the paper's millimetres are in the reference.

use crate::config::Config;
use crate::law::{Advice, Law};
use crate::math;
use crate::observation::SonarReading;
use crate::quantity::{Angle, Instant, Length, OutOfRange, in_range, within};
use crate::ring::{Placement, Ring};
use crate::shield::milliseconds;
use crate::view::{Pose, View};
use core::f32::consts::{FRAC_PI_2, TAU};
use nalgebra::Vector2;

/// The numbers of S4's section 3 and those that the paper leaves open. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Range at which an echo begins to count, range_max of E1, m.
    pub range_max: f32,
    /// Distance from the edge up to which anything is detected, d_max of E2, m.
    pub distance_max: f32,
    /// A projection above this is an obstacle: the obstacle detection threshold value, 0 to 10.
    pub threshold: f32,
    /// No side wall is nearer to an edge than half of this, the width W of W1, m.
    pub corridor_width: f32,
    /// Width that must be free to go round an obstacle, m.
    pub safe_path_width: f32,
    /// Heading error against the actual edge above which the robot does not follow, rad (ours).
    pub heading_error_max: f32,
    /// An edge ends this much before its end point, m (ours): there the actual edge has no
    /// direction.
    pub end_distance: f32,
    /// The robot aims at the point of the edge this far ahead, m (ours).
    pub look_ahead: f32,
    /// Speed along an edge, m/s (ours).
    pub speed: f32,
    /// Speed round an obstacle and back to the edge, m/s (ours).
    pub slow_speed: f32,
    /// A robot that has stood this long although it was to go is held up by something, s (ours).
    pub held_time: f32,
}

/// The paper's numbers for its corridors of 1200 mm, with ours where it has none.
pub const PAPER: Parameters = Parameters {
    range_max: 0.6,
    distance_max: 0.3,
    threshold: 3.0,
    corridor_width: 1.2,
    safe_path_width: 0.6,
    heading_error_max: 0.872_664_6,
    end_distance: 0.1,
    look_ahead: 0.6,
    speed: 0.2,
    slow_speed: 0.1,
    held_time: 3.0,
};

/// Parameters that were checked. See [`EdgeConfig::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeConfig {
    parameters: Parameters,
}

impl core::ops::Deref for EdgeConfig {
    type Target = Parameters;

    fn deref(&self) -> &Parameters {
        &self.parameters
    }
}

impl EdgeConfig {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter that is out of range.
    pub const fn new(parameters: Parameters) -> Result<Self, OutOfRange> {
        let p = parameters;
        let checks = [
            in_range("range_max", p.range_max, 0.1, 5.0, "m"),
            in_range("distance_max", p.distance_max, 0.05, 2.0, "m"),
            in_range("threshold", p.threshold, 0.1, 10.0, "of 10"),
            in_range("corridor_width", p.corridor_width, 0.2, 10.0, "m"),
            in_range("safe_path_width", p.safe_path_width, 0.1, 3.0, "m"),
            in_range("heading_error_max", p.heading_error_max, 0.1, 1.5, "rad"),
            in_range("end_distance", p.end_distance, 0.02, 1.0, "m"),
            in_range("look_ahead", p.look_ahead, 0.1, 5.0, "m"),
            in_range("speed", p.speed, 0.01, 2.0, "m/s"),
            in_range("slow_speed", p.slow_speed, 0.01, p.speed, "m/s"),
            in_range("held_time", p.held_time, 0.5, 60.0, "s"),
        ];
        let mut i = 0;
        while i < checks.len() {
            if let Err(error) = checks[i] {
                return Err(error);
            }
            i += 1;
        }
        Ok(Self { parameters })
    }

    /// The corridor of W1: no side wall is between these lines along an edge.
    #[must_use]
    pub fn corridor(&self) -> Gap {
        let half_width = 0.5 * self.corridor_width;
        Gap {
            right: -half_width,
            left: half_width,
        }
    }
}

// ------------------------------------------------------------------------------ the equations

/// S4 E1: how near an echo is, for r ≤ R, else 0; 0 to 10.
///
/// $$N_1 = 10 \frac{R - r}{R}$$
//= edge.INV-1
//= edge.INV-4
#[must_use]
pub fn nearness(range: Length, config: &EdgeConfig) -> f32 {
    let left = config.range_max - range.get();
    if left > 0.0 {
        // In this order W2 holds at 0.7·R to the last bits; a range of 0 may round past 10.
        (10.0 * left / config.range_max).min(10.0)
    } else {
        0.0
    }
}

/// S4 E2: how near the edge the robot is, for d ≤ D, 0.4 to 1. `distance` is the robot's distance d
/// from the edge, either side, m.
///
/// $$N_2 = 1 - 0.6 \frac{d}{D}$$
///
/// Beyond D (and for NaN) there is no value: the detector is blind there, and blind is not free
/// (ER-S4-07).
//= edge.INV-2
#[must_use]
pub fn closeness(distance: f32, config: &EdgeConfig) -> Option<f32> {
    let part = distance.abs() / config.distance_max;
    (part <= 1.0).then_some(1.0 - 0.6 * part)
}

/// S4 E3 and E4: the projection of a sonar vector on the actual edge, 0 to 10·N2. `cosine` is that of
/// the angle α between the sonar's axis and the actual edge; what looks back counts as 0, and so does
/// NaN.
///
/// $$P = N_1 N_2 \max(0, \cos \alpha)$$
//= edge.INV-3
//= edge.INV-5
#[must_use]
pub fn projection(nearness: f32, closeness: f32, cosine: f32) -> f32 {
    let along = if cosine > 0.0 { cosine.min(1.0) } else { 0.0 };
    // Rounding keeps this bound by itself; like this a solver sees it.
    (nearness * closeness * along).min(10.0 * closeness)
}

/// The actual edge (AE): from the robot's centre to the end of the planned edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActualEdge {
    /// Unit vector towards the end, in the robot's frame.
    pub direction: Vector2<f32>,
    /// Distance of the end, m.
    pub length: f32,
    /// Distance d of the robot's centre from the line of the planned edge, m, left positive.
    pub distance: f32,
}

/// A sonar whose axis has a greater part backward than this looks back; what is less floats round.
const LOOKS_BACK: f32 = 0.01;

/// Shortest actual edge that has a direction, m.
const SHORTEST_ACTUAL: f32 = 0.001;

impl ActualEdge {
    /// The actual edge of a robot at `pose`; none at the very end, where it has no direction.
    #[must_use]
    pub fn new(pose: &Pose, edge: &PlannedEdge) -> Option<Self> {
        let offset = pose.to_robot(edge.end());
        let length = math::norm(offset);
        (length >= SHORTEST_ACTUAL).then(|| Self {
            direction: offset / length,
            length,
            distance: edge.to_edge(pose.position).y,
        })
    }

    /// cos α of every sonar of a ring: dot products of unit vectors. Sonars behind the centre of
    /// rotation, or that look back, take no part: 0. S4 has the front array, and W1 is about its
    /// reach.
    #[must_use]
    pub fn cosines<const N: usize>(&self, ring: &Ring<N>) -> [f32; N] {
        let mut cosines = [0.0; N];
        for (cosine, sonar) in cosines.iter_mut().zip(ring.sonars()) {
            if sonar.position.x >= 0.0 && sonar.axis.x >= -LOOKS_BACK {
                *cosine = sonar.axis.dot(&self.direction);
            }
        }
        cosines
    }

    /// Heading error: the turn that leads to the direction of the actual edge.
    #[must_use]
    pub fn heading_error(&self) -> Angle {
        let turn = math::atan2(self.direction.y, self.direction.x);
        Angle::radians(turn).unwrap_or(Angle::ZERO)
    }
}

/// What the detector makes of a ring of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detection {
    /// No projection is above the threshold. That is all it says: see `spec/edge.md` for what is
    /// not detected.
    Clear {
        /// The greatest projection.
        greatest: f32,
    },
    /// Something is on the edge.
    Obstacle {
        /// The sonar of the biggest valued point.
        sonar: usize,
        /// Its projection.
        greatest: f32,
    },
    /// The detector cannot tell, which is not "free".
    Blind(Blindness),
}

/// Why the detector cannot tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blindness {
    /// The robot is farther from the edge than d_max, or its distance is no number.
    OffEdge,
    /// The robot is at the very end of the edge, where the actual edge has no direction.
    AtEnd,
    /// A sonar's reading is stale or invalid.
    Sonar(usize),
}

/// S4 steps 2 to 5: E1 to E4 for every sonar, with the cosines of α and the robot's distance from
/// the edge (m); the greatest projection decides.
///
/// An obstacle is one although another sonar may be stale; a ring is only [`Detection::Clear`] if
/// every sonar is heard and the robot is within d_max of the edge.
//= edge.INV-6
#[must_use]
pub fn detect<const N: usize>(
    sonar: &[SonarReading; N],
    cosines: &[f32; N],
    distance: f32,
    config: &EdgeConfig,
) -> Detection {
    let Some(closeness) = closeness(distance, config) else {
        return Detection::Blind(Blindness::OffEdge);
    };
    let mut projections = [0.0; N];
    let mut silent = None;
    for i in 0..N {
        let range = match sonar[i] {
            SonarReading::Echo(range) => range,
            // As good as a contact.
            SonarReading::TooNear => Length::ZERO,
            SonarReading::NoEcho(_) => continue,
            SonarReading::Stale | SonarReading::Invalid => {
                silent = Some(i);
                continue;
            }
        };
        projections[i] = projection(nearness(range, config), closeness, cosines[i]);
    }
    judge(&projections, silent, config.threshold)
}

/// The detector beside the edge (ours): [`detect`], and what no side wall can give (`inside`, see
/// [`unexplained`]) is judged as if the robot were on the edge. N2 is there to let walls count less;
/// what is no wall it would only hide until it is near (ER-S4-08).
//= edge.INV-14
#[must_use]
pub fn detect_inside<const N: usize>(
    sonar: &[SonarReading; N],
    inside: &[SonarReading; N],
    cosines: &[f32; N],
    distance: f32,
    config: &EdgeConfig,
) -> Detection {
    let detection = detect(sonar, cosines, distance, config);
    if matches!(detection, Detection::Obstacle { .. }) {
        return detection;
    }
    match detect(inside, cosines, 0.0, config) {
        obstacle @ Detection::Obstacle { .. } => obstacle,
        _ => detection,
    }
}

/// S4 step 5: the greatest of the projections decides, if it exceeds the threshold; otherwise a sonar
/// that is not heard makes the detector blind.
//= edge.INV-7
#[must_use]
pub fn judge<const N: usize>(
    projections: &[f32; N],
    silent: Option<usize>,
    threshold: f32,
) -> Detection {
    let mut greatest = 0.0;
    let mut at = 0;
    for (i, projection) in projections.iter().enumerate() {
        if *projection > greatest {
            (greatest, at) = (*projection, i);
        }
    }
    if greatest > threshold {
        return Detection::Obstacle {
            sonar: at,
            greatest,
        };
    }
    match silent {
        Some(i) => Detection::Blind(Blindness::Sonar(i)),
        None => Detection::Clear { greatest },
    }
}

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
        in_range("scanner x", placement.x, -2.0, 2.0, "m")?;
        in_range("scanner y", placement.y, -2.0, 2.0, "m")?;
        Angle::radians(placement.heading)?;
        in_range("first angle", first_angle, -TAU, TAU, "rad")?;
        in_range("angle step", step, 1e-4, 0.1, "rad")?;
        in_range("reach", reach, 0.5, 100.0, "m")?;
        let beams = ranges.len().min(u16::MAX as usize) as f32;
        in_range("beams", beams, 2.0, BEAMS_MAX as f32, "beams")?;
        in_range(
            "angle of scan",
            (beams - 1.0) * step,
            0.0,
            TAU + step,
            "rad",
        )?;
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

// ------------------------------------------------------------------------------- the free way

/// A stretch across the way: what lies between two lines along the edge, m, left positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Its right side.
    pub right: f32,
    /// Its left side; not less than `right`.
    pub left: f32,
}

/// What floats round over a scan: the angles of its beams add up to some 10⁻⁶ rad, m.
const ROUNDING: f32 = 1e-4;

impl Gap {
    /// How wide it is, m.
    #[must_use]
    pub fn width(&self) -> f32 {
        self.left - self.right
    }

    /// Its middle, m: the line of the sub-route.
    #[must_use]
    pub fn middle(&self) -> f32 {
        0.5 * (self.left + self.right)
    }

    /// It is at least as wide as a safe path (m).
    #[must_use]
    pub fn is_passable(&self, safe_path_width: f32) -> bool {
        self.width() >= safe_path_width - ROUNDING
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
    /// nothing there. Then the point itself counts as an obstacle: a sonar heard it.
    pub obstacle: Option<Extent>,
    /// The widest free stretch across the corridor, past the obstacle, if there is any.
    pub gap: Option<Gap>,
    /// The gap is at least as wide as a safe path.
    pub passable: bool,
}

/// A sonar's echo and the thing as the laser sees it are no farther apart than this, m: a cone of
/// 15° either way is a chord of 0.16 m at 0.6 m.
const MATCH: f32 = 0.2;

/// Neighbouring points of one surface are no farther apart than this, m.
const JOIN: f32 = 0.1;

/// Nothing farther from the edge than this, m, is looked at for a way round.
const ACROSS: f32 = 1.5;

/// An obstacle is taken to be no longer than this from its front on, m: what is behind is found out
/// on the way past it.
const LENGTH_MAX: f32 = 1.0;

/// What one beam says, in the frame of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beam {
    /// Something is at this place and range.
    Hit(Vector2<f32>, f32),
    /// Nothing within reach.
    Nothing,
    /// It says nothing: whatever it looked at may be occupied.
    Unusable,
}

/// A scan in the frame of an edge.
struct Sight<'a> {
    scan: &'a Scan<'a>,
    /// Where the scanner is.
    origin: Vector2<f32>,
    /// Direction of beam 0, rad; not wrapped.
    first: f32,
}

impl<'a> Sight<'a> {
    fn new(scan: &'a Scan<'a>, pose: &Pose, edge: &PlannedEdge) -> Self {
        let at = Vector2::new(scan.placement.x, scan.placement.y);
        let course = math::atan2(edge.direction().y, edge.direction().x);
        let heading = pose.heading.get() - course + scan.placement.heading;
        Self {
            scan,
            origin: edge.to_edge(pose.to_world(at)),
            first: heading + scan.first_angle,
        }
    }

    fn beams(&self) -> usize {
        self.scan.ranges.len()
    }

    /// Unit vector of a beam.
    fn direction(&self, i: usize) -> Vector2<f32> {
        let angle = self.first + i as f32 * self.scan.step;
        Vector2::new(math::cos(angle), math::sin(angle))
    }

    fn beam(&self, i: usize) -> Beam {
        let range = self.scan.ranges[i];
        if range >= self.scan.reach {
            Beam::Nothing
        } else if range >= 0.0 {
            Beam::Hit(self.origin + self.direction(i) * range, range)
        } else {
            Beam::Unusable
        }
    }

    /// The hit nearest to a point, if one is within [`MATCH`].
    fn nearest(&self, point: Vector2<f32>) -> Option<usize> {
        let mut nearest = None;
        let mut least = MATCH;
        for i in 0..self.beams() {
            if let Beam::Hit(place, _) = self.beam(i) {
                let distance = math::norm(place - point);
                if distance <= least {
                    (nearest, least) = (Some(i), distance);
                }
            }
        }
        nearest
    }

    /// Two neighbouring beams hit one surface.
    fn joined(&self, i: usize, j: usize) -> bool {
        match (self.beam(i), self.beam(j)) {
            (Beam::Hit(a, _), Beam::Hit(b, _)) => math::norm(a - b) <= JOIN,
            _ => false,
        }
    }

    /// The surface that a hit belongs to, as far as it is joined and not too long.
    fn extent(&self, seed: usize, half_width: f32) -> Option<Extent> {
        let Beam::Hit(seen, _) = self.beam(seed) else {
            return None;
        };
        let (mut low, mut high) = (seed, seed);
        while low > 0 && self.joined(low, low - 1) {
            low -= 1;
        }
        while high + 1 < self.beams() && self.joined(high, high + 1) {
            high += 1;
        }
        let mut along = [seen.x; 2];
        for i in low..=high {
            if let Beam::Hit(place, _) = self.beam(i) {
                // A wall that it stands against reaches back to the robot, beside its way.
                if (place.y - seen.y).abs() <= half_width && place.y.abs() <= half_width {
                    along[0] = along[0].min(place.x);
                }
                along[1] = along[1].max(place.x);
            }
        }
        along[1] = along[1].min(along[0] + LENGTH_MAX);
        let mut across = [seen.y; 2];
        for i in low..=high {
            if let Beam::Hit(place, _) = self.beam(i)
                && place.x >= along[0] - ROUNDING
                && place.x <= along[1]
            {
                across = [across[0].min(place.y), across[1].max(place.y)];
            }
        }
        Some(Extent { along, across })
    }

    /// What beam `i` blocks of the way between `from` and `to` along the edge: a stretch across it.
    /// The faces of the obstacle itself, `own`, hide what is behind them, which is found out on the
    /// way past; what anything else hides is not free.
    fn blocks(&self, i: usize, from: f32, to: f32, own: Option<Extent>) -> Option<[f32; 2]> {
        let inside = |place: Vector2<f32>| place.x >= from && place.x <= to;
        match self.beam(i) {
            Beam::Nothing => None,
            Beam::Unusable => self.crossed(i, self.origin, from, to),
            Beam::Hit(place, range) => {
                let face = own.is_some_and(|own| {
                    place.x >= own.along[0] - 0.5 * JOIN
                        && place.x <= own.along[1]
                        && place.y >= own.across[0] - ROUNDING
                        && place.y <= own.across[1] + ROUNDING
                });
                let mut blocked = if !inside(place) {
                    None
                } else if face {
                    Some([place.y; 2])
                } else {
                    self.crossed(i, place, from, to)
                };
                // Where a surface ends, it may go on up to the beam that passes it: round the scanner,
                // or square across the way.
                for j in [i.wrapping_sub(1), i + 1] {
                    if j >= self.beams() {
                        continue;
                    }
                    let passes = match self.beam(j) {
                        Beam::Hit(_, other) => other > range + JOIN,
                        Beam::Nothing | Beam::Unusable => true,
                    };
                    if !passes {
                        continue;
                    }
                    let direction = self.direction(j);
                    let depth = place.x - self.origin.x;
                    let square = if direction.x > 0.1 && depth > 0.0 {
                        depth / direction.x
                    } else {
                        range
                    };
                    for range in [range, square.min(range + JOIN)] {
                        let end = self.origin + direction * range;
                        if inside(end) || inside(place) {
                            let [low, high] = blocked.unwrap_or([end.y; 2]);
                            blocked = Some([low.min(end.y), high.max(end.y)]);
                        }
                    }
                }
                blocked
            }
        }
    }

    /// The stretch across the way that a beam runs over from a place on it, until it leaves the way.
    fn crossed(&self, i: usize, place: Vector2<f32>, from: f32, to: f32) -> Option<[f32; 2]> {
        let direction = self.direction(i);
        let ahead = if direction.x > 0.0 { to } else { from } - place.x;
        let mut run = 2.0 * ACROSS / direction.y.abs().max(1e-3);
        if direction.x.abs() > 1e-3 {
            run = run.min((ahead / direction.x).max(0.0));
        }
        let end = place.y + run * direction.y;
        Some([place.y.min(end), place.y.max(end)])
    }

    /// How far across the scan looks at `front` along the edge.
    fn field(&self, front: f32) -> Gap {
        let span = (self.beams() - 1) as f32 * self.scan.step;
        if span >= TAU - 1.5 * self.scan.step {
            return Gap {
                right: -ACROSS,
                left: ACROSS,
            };
        }
        let middle = self.first + 0.5 * span;
        let middle = math::atan2(math::sin(middle), math::cos(middle));
        let depth = (front - self.origin.x).max(0.0);
        // Where a beam in this direction gets to.
        let across = |bearing: f32| {
            let across = if bearing >= FRAC_PI_2 {
                ACROSS
            } else if bearing <= -FRAC_PI_2 {
                -ACROSS
            } else {
                self.origin.y + depth * math::sin(bearing) / math::cos(bearing).max(1e-6)
            };
            across.clamp(-ACROSS, ACROSS)
        };
        Gap {
            right: across(middle - 0.5 * span),
            left: across(middle + 0.5 * span),
        }
    }
}

/// The free-way check: what lies across the way of a robot at `pose` on `edge`, given the biggest
/// valued point (odometry frame, m) and a scan taken there.
///
/// The obstacle is the surface that the laser sees at the point. The way past it reaches from the
/// robot to half a safe path beyond the obstacle. Every hit in there blocks its place across the
/// way, and so does what the scan does not show: what is hidden behind anything but the obstacle,
/// a beam that is not usable, what is outside the scanner's field of view, and the rest of the angle up
/// to the beam that first passes a surface. What the obstacle itself hides is found out on the way
/// past it. The gap is the widest stretch that nothing blocks, within 1.5 m of the edge.
//= edge.INV-13
#[must_use]
pub fn free_way(
    scan: &Scan<'_>,
    pose: &Pose,
    edge: &PlannedEdge,
    point: Vector2<f32>,
    safe_path_width: f32,
) -> FreeWay {
    let sight = Sight::new(scan, pose, edge);
    let point = edge.to_edge(point);
    let from = edge.to_edge(pose.position).x;
    let obstacle = sight
        .nearest(point)
        .and_then(|seed| sight.extent(seed, 0.5 * safe_path_width));
    let [front, far] = obstacle.map_or([point.x; 2], |extent| extent.along);
    let to = far + 0.5 * safe_path_width;
    let field = sight.field(front);
    let heard = obstacle
        .is_none()
        .then_some([point.y - MATCH, point.y + MATCH]);

    let mut gap: Option<Gap> = None;
    let mut widest = 0.0;
    // Blocked up to here, but for stretches no wider than the widest.
    let mut reached = field.right;
    loop {
        let mut next = field.left;
        let mut grown = false;
        for i in 0..=sight.beams() {
            let blocked = if i < sight.beams() {
                sight.blocks(i, from, to, obstacle)
            } else {
                heard
            };
            let Some([low, high]) = blocked else {
                continue;
            };
            if high > reached {
                if low <= reached + widest {
                    reached = high;
                    grown = true;
                } else {
                    next = next.min(low);
                }
            }
        }
        if grown {
            continue;
        }
        if next - reached > widest {
            widest = next - reached;
            gap = Some(Gap {
                right: reached,
                left: next,
            });
        }
        // Written so that it ends on a number that is none.
        if !(next > reached && next < field.left) {
            break;
        }
        reached = next;
    }
    FreeWay {
        obstacle,
        gap,
        passable: gap.is_some_and(|gap| gap.is_passable(safe_path_width)),
    }
}

// ------------------------------------------------------------------------------ the machine M3

/// The states of M3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Along the planned edge.
    FollowEdge,
    /// Something is on the edge, or holds the robot up: at rest, as soon as the base is.
    Stopped,
    /// At rest, waiting for a laser scan.
    Measure,
    /// At rest: the scan is judged.
    FreeWay,
    /// Round the obstacle, through the gap.
    SubRoute,
    /// Past it and back to the edge, which is near enough for the detector.
    Rejoin,
    /// Too far from the edge, or looking away from it: back to it, slowly.
    OffEdge,
    /// No free way: at rest until there is another route.
    Blocked,
    /// The last edge's end is reached.
    Done,
}

impl State {
    /// Every state.
    pub const EACH: [Self; 9] = [
        Self::FollowEdge,
        Self::Stopped,
        Self::Measure,
        Self::FreeWay,
        Self::SubRoute,
        Self::Rejoin,
        Self::OffEdge,
        Self::Blocked,
        Self::Done,
    ];

    /// The state asks for no motion, turning included.
    #[must_use]
    pub const fn at_rest(self) -> bool {
        matches!(
            self,
            Self::Stopped | Self::Measure | Self::FreeWay | Self::Blocked | Self::Done
        )
    }
}

/// What a look at the scan came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// There is room for a safe path.
    Passable,
    /// There is none, or the way has been tried too often.
    Closed,
    /// Nothing is there any more: no sonar on the edge and nothing where it was.
    Gone,
}

/// What the machine needs to know of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Situation {
    /// Something is on the way that is being driven, or the robot is held up by something.
    pub obstacle: bool,
    /// The robot stands.
    pub standing: bool,
    /// What the scan came to, once there is one.
    pub finding: Option<Finding>,
    /// The sub-route's end is reached.
    pub past: bool,
    /// The edge is within d_max, every sonar is heard, and the heading is within the limit.
    pub following: bool,
    /// The edge is well within that: near, and the robot looks along it.
    pub on_edge: bool,
    /// The last edge's end is reached.
    pub at_end: bool,
}

/// M3: the state that follows `state`.
//= edge.INV-10
//= edge.INV-11
//= edge.INV-12
#[must_use]
pub const fn next_state(state: State, situation: &Situation) -> State {
    match state {
        State::Blocked | State::Done => state,
        State::Stopped => {
            if situation.standing {
                State::Measure
            } else {
                State::Stopped
            }
        }
        State::Measure => {
            if situation.finding.is_some() {
                State::FreeWay
            } else {
                State::Measure
            }
        }
        State::FreeWay => match situation.finding {
            Some(Finding::Passable) => State::SubRoute,
            Some(Finding::Closed) => State::Blocked,
            // By way of the state that looks whether the edge can be followed.
            Some(Finding::Gone) => State::OffEdge,
            None => State::Measure,
        },
        _ if situation.obstacle => State::Stopped,
        State::SubRoute if situation.past => State::Rejoin,
        State::SubRoute => State::SubRoute,
        State::FollowEdge | State::Rejoin | State::OffEdge => {
            if situation.at_end {
                State::Done
            } else if situation.on_edge {
                State::FollowEdge
            } else if situation.following && !matches!(state, State::OffEdge) {
                state
            } else {
                State::OffEdge
            }
        }
    }
}

// -------------------------------------------------------------------------------------- the law

/// What a planner, and people, want to know of. The number is the edge's place in the route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The end of the edge is reached.
    Covered(usize),
    /// Something is on the edge, at this point of the odometry frame (the biggest valued point).
    Detected(usize, Vector2<f32>),
    /// The robot has stood for a while although it was to go: what it is held up by is here.
    HeldUp(usize, Vector2<f32>),
    /// What the laser says.
    Measured(usize, FreeWay),
    /// There is no free way along the edge: a new route is wanted.
    Blocked(usize),
}

/// Events that wait to be fetched; beyond that the oldest are dropped.
const EVENTS: usize = 8;

/// Looks at one place of an edge, without getting anywhere, after which it is blocked.
const LOOKS_MAX: u32 = 4;

/// Getting on by this much, m, is getting somewhere.
const PROGRESS: f32 = 0.3;

/// Heading error up to which a leg is driven; above it the robot turns on the spot, rad.
pub const TURNED: f32 = 0.15;

/// A leg ends this much before its end point, m.
const LEG_END: f32 = 0.03;

/// Legs shorter than this are left out, m.
const LEG_MIN: f32 = 0.05;

/// Speed at the end of a line, m/s.
const CREEP: f32 = 0.03;

/// A side of the gap is known to this much, m: noise of sonar and odometry.
const SIDE: f32 = 0.05;

/// The forward part of the axis of a sonar that looks across the way.
const ACROSS_AXIS: f32 = 0.26;

/// A side of an obstacle and an echo of it are no farther apart than this across the way, m.
const BESIDE: f32 = 0.1;

/// Slowest standing, m/s and rad/s.
const STANDING: [f32; 2] = [0.005, 0.02];

/// The way round an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SubRoute {
    /// To the line of the gap, and along it.
    legs: [Option<PlannedEdge>; 2],
    /// The gap, in the frame of the planned edge.
    gap: Gap,
    /// The side of the gap that is the obstacle's, across the edge, m, and whether it is the left.
    side: (f32, bool),
}

/// S4's law: along a route of planned edges for a robot with `N` sonars. A route is whatever lends
/// a slice of [`PlannedEdge`]s.
#[derive(Clone, Debug)]
pub struct Edge<R, const N: usize> {
    config: Config,
    edge: EdgeConfig,
    ring: Ring<N>,
    route: R,
    /// Place in the route.
    at: usize,
    state: State,
    pose: Option<Pose>,
    /// The biggest valued point, odometry frame.
    point: Vector2<f32>,
    finding: Option<FreeWay>,
    sub_route: Option<SubRoute>,
    /// The way back to the edge.
    way_back: Option<PlannedEdge>,
    /// Since when the robot has stood.
    standing_since: Option<Instant>,
    /// It was told to move.
    told_to_move: bool,
    /// Since when it has stood all the same.
    kept_since: Option<Instant>,
    /// How often it has looked at the scan without getting on.
    looks: u32,
    /// How far along the edge it has come, m.
    furthest: f32,
    events: [Option<Event>; EVENTS],
}

impl<R: AsRef<[PlannedEdge]>, const N: usize> Edge<R, N> {
    /// The law, about to follow `route`.
    ///
    /// # Errors
    /// As [`reroute`](Self::reroute).
    pub fn new(
        config: Config,
        edge: EdgeConfig,
        ring: Ring<N>,
        route: R,
    ) -> Result<Self, OutOfRange> {
        check_route(route.as_ref(), &edge)?;
        Ok(Self {
            config,
            edge,
            ring,
            route,
            at: 0,
            state: State::Rejoin,
            pose: None,
            point: Vector2::new(0.0, 0.0),
            finding: None,
            sub_route: None,
            way_back: None,
            standing_since: None,
            told_to_move: false,
            kept_since: None,
            looks: 0,
            furthest: f32::NEG_INFINITY,
            events: [None; EVENTS],
        })
    }

    /// Goes on with another route, from its first edge.
    ///
    /// # Errors
    /// [`OutOfRange`] if the route has no edge, more than 4096, or one that begins farther than
    /// d_max from the end of the one before.
    pub fn reroute(&mut self, route: R) -> Result<(), OutOfRange> {
        check_route(route.as_ref(), &self.edge)?;
        self.route = route;
        self.at = 0;
        self.state = State::Rejoin;
        self.finding = None;
        self.sub_route = None;
        self.way_back = None;
        self.begin_edge();
        Ok(())
    }

    /// The state it is in.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The place in the route of the edge that it follows.
    #[must_use]
    pub const fn current(&self) -> usize {
        self.at
    }

    /// The route.
    #[must_use]
    pub fn route(&self) -> &[PlannedEdge] {
        self.route.as_ref()
    }

    /// The robot stands and waits for a laser scan.
    #[must_use]
    pub const fn wants_scan(&self) -> bool {
        matches!(self.state, State::Measure) && self.finding.is_none()
    }

    /// Looks at a scan, if one is wanted and it was taken since the robot stands.
    pub fn take_scan(&mut self, scan: &Scan<'_>) {
        let since = self.standing_since;
        let (true, Some(pose), Some(since)) = (self.wants_scan(), self.pose, since) else {
            return;
        };
        if scan.taken_at < since {
            return;
        }
        let Some(edge) = self.edge_now() else {
            return;
        };
        let found = free_way(scan, &pose, &edge, self.point, self.edge.safe_path_width);
        self.finding = Some(found);
        self.tell(Event::Measured(self.at, found));
    }

    /// What has happened, in order.
    pub fn next_event(&mut self) -> Option<Event> {
        let event = self.events[0]?;
        self.events.rotate_left(1);
        self.events[EVENTS - 1] = None;
        Some(event)
    }

    fn tell(&mut self, event: Event) {
        let free = self.events.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| {
            self.events.rotate_left(1);
            EVENTS - 1
        });
        if let Some(slot) = self.events.get_mut(place) {
            *slot = Some(event);
        }
    }

    fn edge_now(&self) -> Option<PlannedEdge> {
        self.route.as_ref().get(self.at).copied()
    }

    fn begin_edge(&mut self) {
        self.looks = 0;
        self.furthest = f32::NEG_INFINITY;
    }

    /// The robot is level with the end of an edge, and near it.
    fn ended(&self, edge: &PlannedEdge, place: Vector2<f32>) -> bool {
        let distance = place.y.abs();
        distance <= self.edge.distance_max
            && edge.length() - place.x <= self.edge.end_distance + distance
    }

    /// The line that is driven now, and whether it is a leg of our own.
    fn line(&mut self, edge: &PlannedEdge, pose: &Pose) -> (PlannedEdge, bool) {
        match self.state {
            State::SubRoute => match self.sub_route.and_then(|way| way.legs[0].or(way.legs[1])) {
                Some(leg) => (leg, true),
                None => (*edge, false),
            },
            State::OffEdge => {
                let place = edge.to_edge(pose.position);
                if place.y.abs() <= BACK_SHARE * self.edge.distance_max {
                    self.way_back = None;
                    return (*edge, false);
                }
                let reached = |leg: &PlannedEdge| {
                    let place = leg.to_edge(pose.position);
                    leg.length() - place.x <= LEG_END || place.y.abs() > self.edge.distance_max
                };
                if self.way_back.is_none_or(|leg| reached(&leg)) {
                    // Half a right angle on, towards the edge.
                    let along = (place.x + place.y.abs()).max(0.0).min(edge.length());
                    let target = edge.to_world(Vector2::new(along, 0.0));
                    self.way_back = PlannedEdge::new(pose.position, target).ok();
                }
                self.way_back.map_or((*edge, false), |leg| (leg, true))
            }
            _ => (*edge, false),
        }
    }

    /// What is on the way that the robot is `distance` beside. On a sub-route the sides of the gap are
    /// known, and are nearer than walls may be; elsewhere they may be half a corridor's width off.
    fn detect(
        &self,
        view: &View<N>,
        edge: &PlannedEdge,
        cosines: &[f32; N],
        distance: f32,
    ) -> Detection {
        let gap = match (self.state, self.sub_route) {
            (State::SubRoute, Some(way)) => Some(way.gap),
            _ => None,
        };
        let inside = unexplained(
            &view.sonar,
            &self.ring,
            &view.pose,
            edge,
            &gap.unwrap_or(self.edge.corridor()),
            self.config.sonar_half_angle,
        );
        let heard = if gap.is_some() { &inside } else { &view.sonar };
        detect_inside(heard, &inside, cosines, distance, &self.edge)
    }

    /// What holds up a robot that was to go along `line`: the echo that lies most along it.
    fn hindrance(&self, view: &View<N>, cosines: &[f32; N]) -> Option<usize> {
        let mut hindrance = None;
        let mut least = f32::INFINITY;
        for (i, (cosine, reading)) in cosines.iter().zip(&view.sonar).enumerate() {
            let range = match reading {
                SonarReading::Echo(range) => range.get(),
                SonarReading::TooNear => 0.0,
                _ => continue,
            };
            // Nearer counts, and so does straight ahead.
            let weight = (0.1 + range) / cosine.max(1e-3);
            if *cosine > 0.0 && weight < least {
                (hindrance, least) = (Some(i), weight);
            }
        }
        hindrance
    }

    /// Where a sonar's vector ends, in the odometry frame.
    fn vector_end(&self, view: &View<N>, sonar: usize) -> Vector2<f32> {
        let Some(at) = self.ring.sonars().get(sonar) else {
            return view.pose.position;
        };
        let range = match view.sonar.get(sonar) {
            Some(SonarReading::Echo(range)) => range.get(),
            _ => 0.0,
        };
        view.pose.to_world(at.position + at.axis * range)
    }

    /// How long the obstacle is shows only beside it: the leg past it goes on for half a safe path
    /// beyond the last place where a sonar heard it across the way.
    fn go_on_past(&mut self, view: &View<N>, edge: &PlannedEdge) {
        let half = 0.5 * self.edge.safe_path_width;
        let Some(way) = &mut self.sub_route else {
            return;
        };
        let [None, Some(leg)] = way.legs else {
            return;
        };
        let (side, left) = way.side;
        let mut beside = false;
        for (reading, at) in view.sonar.iter().zip(self.ring.sonars()) {
            if at.axis.x.abs() < ACROSS_AXIS
                && (at.axis.y > 0.0) == left
                && let SonarReading::Echo(range) = *reading
            {
                let heard = view.pose.to_world(at.position + at.axis * range.get());
                beside |= (edge.to_edge(heard).y - side).abs() <= BESIDE;
            }
        }
        let here = edge.to_edge(view.pose.position).x;
        let end = edge.to_edge(leg.end());
        if beside && here + half > end.x {
            let end = edge.to_world(Vector2::new(here + half, end.y));
            way.legs[1] = PlannedEdge::new(leg.start(), end).ok().or(Some(leg));
        }
    }

    /// Drops the legs whose ends are reached; whether none is left.
    fn advance_legs(&mut self, pose: &Pose) -> bool {
        let Some(way) = &mut self.sub_route else {
            return true;
        };
        for leg in &mut way.legs {
            let Some(now) = *leg else {
                continue;
            };
            if now.length() - now.to_edge(pose.position).x > LEG_END {
                return false;
            }
            *leg = None;
        }
        true
    }

    /// What is done once, when a state begins.
    fn enter(
        &mut self,
        edge: &PlannedEdge,
        view: &View<N>,
        detected: Option<usize>,
        hindrance: Option<usize>,
    ) {
        match self.state {
            State::Stopped => {
                self.finding = None;
                self.looks = self.looks.saturating_add(1);
                if let Some(sonar) = detected {
                    self.point = self.vector_end(view, sonar);
                    self.tell(Event::Detected(self.at, self.point));
                } else if let Some(sonar) = hindrance {
                    self.point = self.vector_end(view, sonar);
                    self.tell(Event::HeldUp(self.at, self.point));
                }
            }
            State::SubRoute => {
                let found = self.finding.take();
                self.sub_route = found.and_then(|found| self.round(edge, &view.pose, &found));
            }
            State::OffEdge => {
                self.finding = None;
                self.way_back = None;
            }
            State::Blocked => self.tell(Event::Blocked(self.at)),
            State::Done => self.tell(Event::Covered(self.at)),
            State::FollowEdge | State::Rejoin | State::Measure | State::FreeWay => {}
        }
    }

    /// Along a line.
    fn drive(&self, line: &PlannedEdge, leg: bool, pose: &Pose) -> Advice {
        let p = &self.edge;
        let (speed, look_ahead, error_max) = match self.state {
            State::FollowEdge => (p.speed, p.look_ahead, p.heading_error_max),
            State::Rejoin => (p.slow_speed, p.look_ahead, p.heading_error_max),
            // Turn on the spot, then go.
            _ if leg => (p.slow_speed, 0.5 * p.look_ahead, TURNED),
            _ => (p.slow_speed, p.look_ahead, TURNED),
        };
        // Slower towards an end, so as not to run past it.
        let left = (line.length() - line.to_edge(pose.position).x).max(0.0);
        let speed = speed.min(left + CREEP);
        steer(
            turn_to(line, pose, look_ahead),
            speed,
            error_max,
            &self.config,
        )
    }

    /// The way through a gap, past what lies between `front` and `far` along the edge.
    fn round(&self, edge: &PlannedEdge, pose: &Pose, found: &FreeWay) -> Option<SubRoute> {
        let gap = found.gap?;
        let half = 0.5 * self.edge.safe_path_width;
        let here = edge.to_edge(pose.position);
        let heard = edge.to_edge(self.point).x;
        let [front, far] = found.obstacle.map_or([heard; 2], |extent| extent.along);
        let lane = gap.middle();
        let across = found.obstacle.map_or(edge.to_edge(self.point).y, |extent| {
            0.5 * (extent.across[0] + extent.across[1])
        });
        let left = across > lane;
        let side = (if left { gap.left } else { gap.right }, left);
        let enter = Vector2::new((front - half).max(here.x), lane);
        // Not past the end of the edge, if there is a choice.
        let leave = (far + half).min(edge.length().max(enter.x));
        let leave = Vector2::new(leave, lane);
        let leg = |from: Vector2<f32>, to: Vector2<f32>| {
            let long_enough = math::norm(to - from) >= LEG_MIN;
            long_enough
                .then(|| PlannedEdge::new(edge.to_world(from), edge.to_world(to)).ok())
                .flatten()
        };
        Some(SubRoute {
            legs: [leg(here, enter), leg(enter, leave)],
            gap,
            side,
        })
    }
}

/// Off the edge, the robot goes back to within this share of d_max of it.
const BACK_SHARE: f32 = 0.9;

/// A route has edges, and they follow each other.
fn check_route(route: &[PlannedEdge], config: &EdgeConfig) -> Result<(), OutOfRange> {
    let edges = route.len().min(u16::MAX as usize) as f32;
    in_range("edges of the route", edges, 1.0, 4096.0, "edges")?;
    for pair in route.windows(2) {
        let step = math::norm(pair[1].start() - pair[0].end());
        in_range("step to next edge", step, 0.0, config.distance_max, "m")?;
    }
    Ok(())
}

/// The readings, where an echo that may come from a side of the gap, for some ray of its cone, says no
/// more than that there is nothing nearer: what is left is certainly inside. The gap is a corridor, or
/// what a sub-route leads through, where walls are nearer than W1 allows for, but were seen.
//= edge.INV-15
#[must_use]
pub fn unexplained<const N: usize>(
    sonar: &[SonarReading; N],
    ring: &Ring<N>,
    pose: &Pose,
    edge: &PlannedEdge,
    gap: &Gap,
    half_angle: f32,
) -> [SonarReading; N] {
    let mut left = *sonar;
    let course = math::atan2(edge.direction().y, edge.direction().x);
    let straight_across = math::cos(half_angle);
    for i in 0..N {
        let SonarReading::Echo(range) = sonar[i] else {
            continue;
        };
        let at = &ring.sonars()[i];
        let face = edge.to_edge(pose.to_world(at.position)).y;
        let bearing = pose.heading.get() + at.heading.get() - course;
        let across = math::sin(bearing);
        let [one, other] = [bearing + half_angle, bearing - half_angle].map(math::sin);
        // How far across the cone reaches: to its edges, or straight across if that is inside.
        let reach = |side: f32| {
            if side * across >= straight_across {
                1.0
            } else {
                (side * one).max(side * other)
            }
        };
        let leftmost = face + range.get() * reach(1.0);
        let rightmost = face - range.get() * reach(-1.0);
        if leftmost >= gap.left - SIDE || rightmost <= gap.right + SIDE {
            left[i] = SonarReading::NoEcho(range);
        }
    }
    left
}

/// Steers by an error of heading in radians, no faster than `speed` in m/s: from `error_max` on, the
/// robot turns before it drives. Total: the turn rate is within ±ω_max and the speed in [0, `speed`],
/// whatever comes in.
//= edge.INV-8
#[must_use]
pub fn steer(error: f32, speed: f32, error_max: f32, config: &Config) -> Advice {
    let turn_rate_max = config.turn_rate_max;
    let turn_rate = config.heading_gain * error;
    if !turn_rate.is_finite() || speed.is_nan() {
        return Advice::REST;
    }
    let share = (1.0 - error.abs() / error_max).clamp(0.0, 1.0);
    Advice {
        speed: speed.max(0.0).min(config.speed_max) * if share > 0.0 { share } else { 0.0 },
        turn_rate: within(turn_rate, turn_rate_max),
    }
}

/// What a state lets through of a wish to move: nothing at all where it rests, or where the detector
/// is blind.
//= edge.INV-9
#[must_use]
pub fn permitted(state: State, sees: bool, wish: Advice) -> Advice {
    if state.at_rest() || !sees {
        Advice::REST
    } else {
        wish
    }
}

/// The turn, in the robot's frame, towards the point of `line` that is `look_ahead` (m) ahead of
/// where the robot is along it, or towards its end if that comes first.
fn turn_to(line: &PlannedEdge, pose: &Pose, look_ahead: f32) -> f32 {
    let along = line.to_edge(pose.position).x;
    let aim = (along + look_ahead).min(line.length());
    let offset = pose.to_robot(line.to_world(Vector2::new(aim, 0.0)));
    math::atan2(offset.y, offset.x)
}

impl<R: AsRef<[PlannedEdge]>, const N: usize> Law<N> for Edge<R, N> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        let pose = view.pose;
        self.pose = Some(pose);
        let standing = view.speed.abs() <= STANDING[0] && view.turn_rate.abs() <= STANDING[1];
        if !standing {
            self.standing_since = None;
        } else if self.standing_since.is_none() {
            self.standing_since = Some(view.now);
        }

        // On to the edge that is to be driven.
        let moves_on = matches!(
            self.state,
            State::FollowEdge | State::Rejoin | State::OffEdge
        );
        let edges = self.route.as_ref().len();
        if moves_on
            && self.at + 1 < edges
            && self
                .edge_now()
                .is_some_and(|edge| self.ended(&edge, edge.to_edge(pose.position)))
        {
            self.tell(Event::Covered(self.at));
            self.at += 1;
            self.way_back = None;
            self.begin_edge();
        }
        let Some(edge) = self.edge_now() else {
            return Advice::REST;
        };
        let place = edge.to_edge(pose.position);
        if place.x > self.furthest + PROGRESS {
            self.furthest = place.x;
            self.looks = 0;
        }

        if self.state == State::SubRoute {
            self.go_on_past(view, &edge);
        }
        let past = self.state == State::SubRoute && self.advance_legs(&pose);
        let (line, leg) = self.line(&edge, &pose);
        let actual = ActualEdge::new(&pose, &line);
        let cosines = actual.map_or([0.0; N], |actual| actual.cosines(&self.ring));
        let heading_error = actual.map_or(0.0, |actual| actual.heading_error().get().abs());
        // A robot that turns on the spot first asks what is ahead when it looks there.
        let looks_along = heading_error <= self.edge.heading_error_max;
        let detection = match actual {
            Some(actual) => self.detect(view, &edge, &cosines, actual.distance),
            None => Detection::Blind(Blindness::AtEnd),
        };
        let detected = match detection {
            Detection::Obstacle { sonar, .. } if looks_along => Some(sonar),
            _ => None,
        };
        let hears = !matches!(detection, Detection::Blind(_));
        // Beside a leg of our own: another one is needed.
        let astray = leg && detection == Detection::Blind(Blindness::OffEdge);

        // Held up: told to go, and standing all the same, for no reason but distance.
        let waits = view.guard.is_some_and(|reason| !reason.may_turn());
        let kept = self.told_to_move && standing && !waits;
        self.kept_since = kept.then(|| self.kept_since.unwrap_or(view.now));
        let held = self.kept_since.is_some_and(|since| {
            let stood = view.now.since(since).unwrap_or(0);
            stood >= milliseconds(self.edge.held_time)
        });
        let hindrance = if held {
            self.hindrance(view, &cosines)
        } else {
            None
        };

        let along_edge = turn_to(&edge, &pose, self.edge.look_ahead);
        let situation = Situation {
            obstacle: detected.is_some() || hindrance.is_some() || astray,
            standing,
            finding: self.finding.map(|found| {
                let gone = found.obstacle.is_none() && hears && detected.is_none();
                if self.looks > LOOKS_MAX {
                    Finding::Closed
                } else if gone {
                    Finding::Gone
                } else if found.passable {
                    Finding::Passable
                } else {
                    Finding::Closed
                }
            }),
            past,
            following: !leg && hears && looks_along,
            on_edge: !leg
                && hears
                && place.y.abs() <= BACK_SHARE * self.edge.distance_max
                && along_edge.abs() <= TURNED,
            at_end: self.at + 1 == edges && self.ended(&edge, place),
        };
        let before = self.state;
        self.state = next_state(before, &situation);
        if self.state != before {
            self.enter(&edge, view, detected, hindrance);
        }
        // Where the line is another now, look along it first.
        let same_line = self.state == before || !(leg || self.state == State::SubRoute);
        let wish = self.drive(&line, leg, &pose);
        let advice = permitted(self.state, hears && same_line, wish);
        self.told_to_move = advice != Advice::REST;
        advice
    }

    fn mode(&self) -> &'static str {
        match self.state {
            State::FollowEdge => "follow edge",
            State::Stopped => "stopped",
            State::Measure => "measure",
            State::FreeWay => "free way",
            State::SubRoute => "sub-route",
            State::Rejoin => "rejoin",
            State::OffEdge => "off edge",
            State::Blocked => "blocked",
            State::Done => "arrived",
        }
    }
}
