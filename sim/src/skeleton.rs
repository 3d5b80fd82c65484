//! People as a depth camera sees them: bodies of any height, arms in any pose, and a camera that
//! is wrong about where the joints are.
//!
//! What they do with their arms is [`Pose`]; a [`Body`] in a [`Place`] gives a
//! [`sidestep::gesture::Skeleton`]. A [`SkeletonCamera`] sees the people of a world.

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sidestep::gesture::{Frame, Gesture, PEOPLE_MAX, Point, Skeleton};
use sidestep::quantity::Instant;

use crate::depth_camera::{self, DepthCamera};
use crate::error::{Error, require};
use crate::geometry;
use crate::world::World;

/// Directions of one arm's two parts (rad).
///
/// An elevation is 0 where the part hangs, π/2 where it is level, π where it points up. An azimuth
/// is 0 where it points the way the person faces, π/2 outward to the arm's own side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// Elevation of the upper arm.
    pub upper_elevation: f64,
    /// Azimuth of the upper arm.
    pub upper_azimuth: f64,
    /// Elevation of the forearm.
    pub fore_elevation: f64,
    /// Azimuth of the forearm.
    pub fore_azimuth: f64,
}

impl Arm {
    /// From degrees: elevation and azimuth of the upper arm, then of the forearm.
    #[must_use]
    pub const fn degrees(upper: (f64, f64), fore: (f64, f64)) -> Self {
        Self {
            upper_elevation: upper.0.to_radians(),
            upper_azimuth: upper.1.to_radians(),
            fore_elevation: fore.0.to_radians(),
            fore_azimuth: fore.1.to_radians(),
        }
    }

    fn angles(self) -> [f64; 4] {
        [
            self.upper_elevation,
            self.upper_azimuth,
            self.fore_elevation,
            self.fore_azimuth,
        ]
    }

    fn of_angles(angles: [f64; 4]) -> Self {
        let [upper_elevation, upper_azimuth, fore_elevation, fore_azimuth] = angles;
        Self {
            upper_elevation,
            upper_azimuth,
            fore_elevation,
            fore_azimuth,
        }
    }
}

/// Hangs.
const HANGING: Arm = Arm::degrees((8.0, 90.0), (12.0, 45.0));
/// Stretched out to the side.
const OUT: Arm = Arm::degrees((90.0, 90.0), (90.0, 90.0));
/// Stretched out ahead.
const AHEAD: Arm = Arm::degrees((88.0, 15.0), (90.0, 5.0));
/// Straight up.
const UP: Arm = Arm::degrees((172.0, 90.0), (176.0, 90.0));
/// Upper arm out to the side, hand up.
const HAND_UP: Arm = Arm::degrees((88.0, 70.0), (168.0, 60.0));
/// Elbow down, hand at the shoulder.
const HAND_AT_SHOULDER: Arm = Arm::degrees((20.0, 60.0), (162.0, 20.0));

/// What both arms do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The person's left arm.
    pub left: Arm,
    /// The person's right arm.
    pub right: Arm,
}

impl Pose {
    /// The pose that shows a gesture (`spec/gesture.md`, "The poses").
    #[must_use]
    pub const fn of(gesture: Gesture) -> Self {
        let (left, right) = match gesture {
            Gesture::Rest => (HANGING, HANGING),
            Gesture::Stop => (HAND_UP, HAND_UP),
            Gesture::Right => (HANGING, OUT),
            Gesture::Left => (OUT, HANGING),
            Gesture::Forward => (HAND_AT_SHOULDER, HAND_AT_SHOULDER),
            Gesture::Backward => (AHEAD, AHEAD),
            Gesture::MasterSelect => (HANGING, UP),
        };
        Self { left, right }
    }

    /// What people do with their arms all day, and is no gesture.
    pub const OTHERS: &[(&'static str, Self)] = &[
        (
            "hands on the hips",
            both(Arm::degrees((40.0, 100.0), (50.0, -60.0))),
        ),
        (
            "arms crossed",
            both(Arm::degrees((25.0, 30.0), (85.0, -75.0))),
        ),
        (
            "carrying a tray",
            both(Arm::degrees((15.0, 60.0), (88.0, 0.0))),
        ),
        (
            "phone at the right ear",
            right(Arm::degrees((40.0, 70.0), (160.0, -30.0))),
        ),
        (
            "phone at the left ear",
            left(Arm::degrees((40.0, 70.0), (160.0, -30.0))),
        ),
        (
            "looking at a phone",
            both(Arm::degrees((25.0, 40.0), (110.0, -40.0))),
        ),
        (
            "drinking",
            right(Arm::degrees((55.0, 45.0), (145.0, -35.0))),
        ),
        (
            "scratching the head",
            right(Arm::degrees((115.0, 70.0), (150.0, -60.0))),
        ),
        (
            "waving with the right hand",
            right(Arm::degrees((60.0, 80.0), (165.0, 80.0))),
        ),
        ("left arm up", left(UP)),
        ("both arms up", both(UP)),
        (
            "right arm half way up",
            right(Arm::degrees((135.0, 90.0), (135.0, 90.0))),
        ),
        (
            "right arm half way down",
            right(Arm::degrees((45.0, 90.0), (45.0, 90.0))),
        ),
        (
            "pointing at the floor",
            right(Arm::degrees((50.0, 10.0), (55.0, 10.0))),
        ),
        (
            "hands behind the head",
            both(Arm::degrees((120.0, 80.0), (120.0, -110.0))),
        ),
        (
            "reaching up with both hands ahead",
            both(Arm::degrees((130.0, 10.0), (140.0, 10.0))),
        ),
        ("one hand at the shoulder", right(HAND_AT_SHOULDER)),
        ("pointing ahead", right(AHEAD)),
        ("arms out to both sides", both(OUT)),
    ];

    /// This pose after every part of the arms has turned towards another by at most `angle` (rad).
    #[must_use]
    pub fn towards(self, to: Self, angle: f64) -> Self {
        let arm = |from: Arm, to: Arm| {
            let (from, to) = (from.angles(), to.angles());
            Arm::of_angles(core::array::from_fn(|i| {
                from[i] + (to[i] - from[i]).clamp(-angle, angle)
            }))
        };
        Self {
            left: arm(self.left, to.left),
            right: arm(self.right, to.right),
        }
    }

    /// How far the elevations of two poses are apart where they are farthest (rad): all that
    /// heights of joints can tell.
    #[must_use]
    pub fn difference(self, other: Self) -> f64 {
        let elevations = |pose: Self| {
            [
                pose.left.upper_elevation,
                pose.left.fore_elevation,
                pose.right.upper_elevation,
                pose.right.fore_elevation,
            ]
        };
        let (these, those) = (elevations(self), elevations(other));
        (0..4).fold(0.0, |most, i| f64::max(most, (these[i] - those[i]).abs()))
    }

    /// Arms in any directions.
    pub fn any(rng: &mut ChaCha8Rng) -> Self {
        let mut arm = || {
            Arm::degrees(
                (rng.random_range(0.0..180.0), rng.random_range(-30.0..110.0)),
                (rng.random_range(0.0..180.0), rng.random_range(-90.0..110.0)),
            )
        };
        Self {
            left: arm(),
            right: arm(),
        }
    }
}

const fn both(arm: Arm) -> Pose {
    Pose {
        left: arm,
        right: arm,
    }
}

const fn left(arm: Arm) -> Pose {
    Pose {
        left: arm,
        right: HANGING,
    }
}

const fn right(arm: Arm) -> Pose {
    Pose {
        left: HANGING,
        right: arm,
    }
}

/// Where somebody stands, seen from the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// To the camera's left (m).
    pub left: f64,
    /// Ahead of the camera (m).
    pub ahead: f64,
    /// How far they are turned, counter-clockwise, from facing the camera (rad).
    pub turn: f64,
}

impl Place {
    /// At `distance` (m) in the direction `bearing`, positive to the left (rad).
    #[must_use]
    pub fn at(distance: f64, bearing: f64, turn: f64) -> Self {
        Self {
            left: distance * libm::sin(bearing),
            ahead: distance * libm::cos(bearing),
            turn,
        }
    }

    /// The place, seen from a camera with this pose, of somebody at `position` who faces `heading`.
    #[must_use]
    pub fn seen_from(camera: &geometry::Pose, position: geometry::Point, heading: f64) -> Self {
        let offset = position - camera.position;
        let (sin, cos) = (libm::sin(camera.heading), libm::cos(camera.heading));
        let to_camera = libm::atan2(-offset.y, -offset.x);
        Self {
            left: cos * offset.y - sin * offset.x,
            ahead: cos * offset.x + sin * offset.y,
            turn: heading - to_camera,
        }
    }
}

/// What a depth camera gets wrong about joints, in the size that comparisons of the Kinect v2 with
/// motion capture report.
///
/// Wang, Kurillo, Ofli and Bajcsy (*Evaluation of pose tracking accuracy in the first and second
/// generations of Microsoft Kinect*, ICHI 2015) and Xu and McGorry (*The validity of the first and
/// second generation Microsoft Kinect for identifying joint center locations during static
/// postures*, Applied Ergonomics 49, 2015) find mean offsets of several centimetres, up to about
/// 10 cm, most of them the same from frame to frame; the former model what is left as Gaussian with
/// uniform outliers. How the offset splits into a constant part and noise, how both grow with
/// distance, and how often a joint is lost are assumptions of ours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraErrors {
    /// Standard deviation of a joint's constant offset on each axis (m).
    pub bias: f64,
    /// Standard deviation of what changes from frame to frame, on each axis, at 2 m (m). It grows
    /// in proportion to the distance.
    pub jitter: f64,
    /// Share of the positions of elbows and wrists that are outliers.
    pub outliers: f64,
    /// An outlier is off by up to this on each axis (m).
    pub outlier_size: f64,
    /// Share of the joints that are not tracked, for some frames in a row. Three times as many, and
    /// twice the jitter, where a forearm points at the camera and hides the arm behind its hand.
    pub dropout: f64,
}

impl CameraErrors {
    /// A camera that is always right.
    pub const NONE: Self = Self {
        bias: 0.0,
        jitter: 0.0,
        outliers: 0.0,
        outlier_size: 0.0,
        dropout: 0.0,
    };
}

impl Default for CameraErrors {
    fn default() -> Self {
        Self {
            bias: 0.02,
            jitter: 0.01,
            outliers: 0.002,
            outlier_size: 0.15,
            dropout: 0.005,
        }
    }
}

/// Height of the camera above the floor (m).
pub const CAMERA_HEIGHT: f64 = 1.2;
/// The least and the greatest height of S3's people (m).
pub const HEIGHTS: (f64, f64) = (1.52, 1.87);

/// Somebody's measures and ways, and what the camera makes of them.
#[derive(Debug, Clone)]
pub struct Body {
    height: f64,
    shoulder_height: f64,
    shoulder_half: f64,
    neck_over_shoulders: f64,
    neck_advance: f64,
    upper_arm: f64,
    forearm: f64,
    /// How this person's poses differ from others' (rad).
    habit: [f64; 8],
    /// How this pose differs from the person's others (rad).
    mood: [f64; 8],
    errors: CameraErrors,
    /// The constant offset of each joint (m).
    bias: [[f64; 3]; 7],
    /// Joints that are not tracked at the moment.
    lost: [bool; 7],
    rng: ChaCha8Rng,
}

/// A joint that is lost is found again in one of so many frames.
const FOUND_AGAIN: f64 = 5.0;
/// Standard deviation of a measure about its share of the height.
const MEASURE_SPREAD: f64 = 0.03;
/// Standard deviation of an arm's angles from person to person, and from pose to pose (rad).
const HABIT: f64 = 4.0_f64.to_radians();
const MOOD: f64 = 4.0_f64.to_radians();
/// The cosine of the angle to the line of sight within which a forearm hides its arm: 25°.
const HIDING: f64 = 0.906;

impl Body {
    /// Somebody who is `height` tall (m), otherwise made up from `seed`.
    ///
    /// The measures are shares of the height (R. Drillis, R. Contini, *Body segment parameters*,
    /// New York University 1966): shoulders at 0.818, chin and neck at 0.870, upper arm 0.186,
    /// forearm 0.146, half the width of the shoulders 0.129 at their edge and 0.11 here at the
    /// joint. Each varies by 3 %.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a height that nobody has, or errors of the camera that are not
    /// numbers of their kind.
    pub fn new(height: f64, errors: CameraErrors, seed: u64) -> Result<Self, Error> {
        require("body.height", height, "0.9..=2.2 m", |h| {
            (0.9..=2.2).contains(&h)
        })?;
        for (field, value) in [
            ("camera.bias", errors.bias),
            ("camera.jitter", errors.jitter),
            ("camera.outlier_size", errors.outlier_size),
        ] {
            require(field, value, ">= 0 m", |x| x >= 0.0)?;
        }
        for (field, value) in [
            ("camera.outliers", errors.outliers),
            ("camera.dropout", errors.dropout),
        ] {
            require(field, value, "0..=1", |x| (0.0..=1.0).contains(&x))?;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut measure = |share: f64| height * share * (1.0 + MEASURE_SPREAD * normal(&mut rng));
        let mut body = Self {
            height,
            shoulder_height: 0.818 * height,
            shoulder_half: measure(0.11),
            neck_over_shoulders: measure(0.052),
            neck_advance: measure(0.01),
            upper_arm: measure(0.186),
            forearm: measure(0.146),
            habit: [0.0; 8],
            mood: [0.0; 8],
            errors,
            bias: [[0.0; 3]; 7],
            lost: [false; 7],
            rng,
        };
        body.habit = core::array::from_fn(|_| HABIT * normal(&mut body.rng));
        for joint in &mut body.bias {
            *joint = core::array::from_fn(|_| errors.bias * normal(&mut body.rng));
        }
        Ok(body)
    }

    /// Somebody of a height between S3's least and greatest, made up from `seed`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn any(errors: CameraErrors, seed: u64) -> Result<Self, Error> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5EED);
        Self::new(rng.random_range(HEIGHTS.0..=HEIGHTS.1), errors, seed)
    }

    /// Height (m).
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Makes the next pose a little different from the one before, as people do.
    pub fn change_mood(&mut self) {
        self.mood = core::array::from_fn(|_| MOOD * normal(&mut self.rng));
    }

    /// What the camera reports: the person with the number `id`, in `pose`, at `place`.
    pub fn skeleton(&mut self, id: u64, pose: Pose, place: Place) -> Skeleton {
        let (left, right) = (self.own(pose.left, 0), self.own(pose.right, 4));
        let (sin, cos) = (libm::sin(place.turn), libm::cos(place.turn));
        // From the camera's point of view: x to its left, y up, z ahead. Turned by nothing, a
        // person faces −z and has their right at +x.
        let (to_camera, distance) = line_of_sight(place);
        let faced = turn(to_camera, sin, cos);
        let own_right = [-faced[2], 0.0, faced[0]];
        let chest = [
            place.left,
            self.shoulder_height - CAMERA_HEIGHT,
            place.ahead,
        ];
        let shoulder = |side: f64, arm: Arm| {
            // A raised arm lifts its shoulder, by up to 2.5 % of the height.
            let lift = 0.025 * self.height * (arm.upper_elevation / core::f64::consts::PI);
            let out = add(chest, own_right, side * self.shoulder_half);
            add(out, [0.0, 1.0, 0.0], lift)
        };
        let shoulders = [shoulder(-1.0, left), shoulder(1.0, right)];
        let mut hidden = [false; 2];
        let mut elbows = [[0.0; 3]; 2];
        let mut wrists = [[0.0; 3]; 2];
        for (i, (arm, side)) in [(left, -1.0), (right, 1.0)].into_iter().enumerate() {
            let outward = own_right.map(|x| side * x);
            let upper = direction(arm.upper_elevation, arm.upper_azimuth, faced, outward);
            let fore = direction(arm.fore_elevation, arm.fore_azimuth, faced, outward);
            elbows[i] = add(shoulders[i], upper, self.upper_arm);
            wrists[i] = add(elbows[i], fore, self.forearm);
            hidden[i] = dot(fore, to_camera) > HIDING;
        }
        let neck = add(
            add(chest, [0.0, 1.0, 0.0], self.neck_over_shoulders),
            faced,
            self.neck_advance,
        );
        Skeleton {
            id,
            neck: self.seen(0, neck, distance, false),
            left_shoulder: self.seen(1, shoulders[0], distance, false),
            right_shoulder: self.seen(2, shoulders[1], distance, false),
            left_elbow: self.seen(3, elbows[0], distance, hidden[0]),
            right_elbow: self.seen(4, elbows[1], distance, hidden[1]),
            left_wrist: self.seen(5, wrists[0], distance, hidden[0]),
            right_wrist: self.seen(6, wrists[1], distance, hidden[1]),
        }
    }

    /// The arm as this person holds it at the moment.
    fn own(&self, arm: Arm, first: usize) -> Arm {
        let angles = arm.angles();
        Arm::of_angles(core::array::from_fn(|i| {
            angles[i] + self.habit[first + i] + self.mood[first + i]
        }))
    }

    /// Where the camera sees a joint, if it does.
    fn seen(&mut self, joint: usize, at: [f64; 3], distance: f64, hidden: bool) -> Option<Point> {
        let worse = if hidden { 2.0 } else { 1.0 };
        let jitter = self.errors.jitter * worse * distance / 2.0;
        let dropout = self.errors.dropout * if hidden { 3.0 } else { 1.0 };
        let outlier = joint >= 3 && self.rng.random_bool(self.errors.outliers);
        // Lost or found in such a way that the share comes out.
        let lost = match self.lost[joint] {
            true if dropout < 1.0 => !self.rng.random_bool(1.0 / FOUND_AGAIN),
            true => true,
            false => {
                let odds = dropout / (1.0 - dropout.min(0.999));
                self.rng.random_bool((odds / FOUND_AGAIN).min(1.0))
            }
        };
        self.lost[joint] = lost;
        let mut position = [0.0; 3];
        for i in 0..3 {
            let mut error = self.bias[joint][i] + jitter * normal(&mut self.rng);
            if outlier {
                error += self.errors.outlier_size * self.rng.random_range(-1.0..=1.0);
            }
            position[i] = at[i] + error;
        }
        let [x, y, z] = position.map(|metres| metres as f32);
        (!lost).then(|| Point::new(x, y, z))
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The level direction from a place to the camera, and how far it is (m).
fn line_of_sight(place: Place) -> ([f64; 3], f64) {
    let distance = libm::hypot(place.left, place.ahead);
    if distance > 0.0 {
        (
            [-place.left / distance, 0.0, -place.ahead / distance],
            distance,
        )
    } else {
        ([0.0, 0.0, -1.0], 0.0)
    }
}

/// A level direction turned counter-clockwise, seen from above, where x is left of z.
fn turn(level: [f64; 3], sin: f64, cos: f64) -> [f64; 3] {
    [
        cos * level[0] + sin * level[2],
        0.0,
        cos * level[2] - sin * level[0],
    ]
}

fn direction(elevation: f64, azimuth: f64, faced: [f64; 3], outward: [f64; 3]) -> [f64; 3] {
    let (rise, reach) = (-libm::cos(elevation), libm::sin(elevation));
    let (out, ahead) = (libm::sin(azimuth), libm::cos(azimuth));
    let level = |i: usize| reach * (ahead * faced[i] + out * outward[i]);
    [level(0), rise, level(2)]
}

fn add(from: [f64; 3], direction: [f64; 3], length: f64) -> [f64; 3] {
    core::array::from_fn(|i| from[i] + length * direction[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// The fastest that a part of an arm turns: half a turn in 0.6 s (rad/s).
const ARM_RATE: f64 = core::f64::consts::PI / 0.6;
/// Who is slower than this stands, and faces the camera (m/s).
const STANDING: f64 = 0.1;
/// Standing people are turned away from the camera by up to this (rad).
const DEVIATION: f64 = 35.0_f64.to_radians();

/// Somebody whom a [`SkeletonCamera`] has seen.
#[derive(Debug, Clone)]
struct Figure {
    body: Body,
    pose: Pose,
    shows: Gesture,
    deviation: f64,
    last: geometry::Point,
    heading: f64,
}

/// A depth camera whose program gives skeletons of the people in a world, with the same view and
/// the same numbers for people as a [`DepthCamera`].
///
/// People who stand, or show something, face the camera, more or less; people who walk face where
/// they walk. Arms take their time.
#[derive(Debug, Clone)]
pub struct SkeletonCamera {
    camera: DepthCamera,
    parameters: depth_camera::Parameters,
    errors: CameraErrors,
    rng: ChaCha8Rng,
    figures: Vec<Figure>,
    next_ms: u64,
    under_way: VecDeque<(u64, Frame)>,
}

impl SkeletonCamera {
    /// A camera that looks as `parameters` say and is wrong about joints as `errors` say; people are
    /// made up from `seed`.
    ///
    /// # Errors
    /// As [`DepthCamera::new`] and [`Body::new`].
    pub fn new(
        parameters: depth_camera::Parameters,
        errors: CameraErrors,
        seed: u64,
    ) -> Result<Self, Error> {
        // Checks the errors, so that nobody has to later.
        Body::any(errors, seed)?;
        Ok(Self {
            camera: DepthCamera::new(parameters, seed)?,
            parameters,
            errors,
            rng: ChaCha8Rng::seed_from_u64(seed),
            figures: Vec::new(),
            next_ms: 0,
            under_way: VecDeque::new(),
        })
    }

    /// Takes a picture of `world` from `pose` if it is time to; `shows` says what a person, by index,
    /// shows or begins to show, none being rest.
    pub fn look(
        &mut self,
        now_ms: u64,
        world: &World,
        pose: &geometry::Pose,
        shows: impl Fn(usize) -> Option<Gesture>,
    ) {
        if now_ms < self.next_ms {
            return;
        }
        self.next_ms = now_ms + self.parameters.period_ms;
        let elapsed = self.parameters.period_ms as f64 / 1000.0;
        self.move_figures(world, elapsed, shows);
        let mut people = [None; PEOPLE_MAX];
        let mut count = 0;
        for (person, _, _, hidden) in self.camera.in_view(world, pose) {
            let lost = self.rng.random_bool(self.parameters.dropout);
            if hidden || lost || count == PEOPLE_MAX {
                continue;
            }
            let id = self.camera.number(person, now_ms);
            let Some(figure) = self.figures.get_mut(person) else {
                continue;
            };
            let standing = world.people()[person].speed() < STANDING;
            let place = if standing || figure.shows != Gesture::Rest {
                let mut place = Place::seen_from(pose, figure.last, 0.0);
                place.turn = figure.deviation;
                place
            } else {
                Place::seen_from(pose, figure.last, figure.heading)
            };
            people[count] = Some(figure.body.skeleton(id, figure.pose, place));
            count += 1;
        }
        let frame = Frame {
            taken_at: Instant(now_ms),
            people,
        };
        self.under_way
            .push_back((now_ms + self.parameters.delay_ms, frame));
    }

    /// The next picture that is there by now, if any is.
    pub fn arrival(&mut self, now_ms: u64) -> Option<Frame> {
        let there = |(due, _): &mut (u64, Frame)| *due <= now_ms;
        self.under_way.pop_front_if(there).map(|(_, frame)| frame)
    }

    /// The number under which the camera follows a person.
    #[must_use]
    pub fn number_of(&self, person: usize) -> Option<u64> {
        self.camera.number_of(person)
    }

    fn move_figures(
        &mut self,
        world: &World,
        elapsed: f64,
        shows: impl Fn(usize) -> Option<Gesture>,
    ) {
        for (person, there) in world.people().iter().enumerate() {
            if self.figures.len() == person {
                let Ok(body) = Body::any(self.errors, self.rng.random()) else {
                    return;
                };
                self.figures.push(Figure {
                    body,
                    pose: Pose::of(Gesture::Rest),
                    shows: Gesture::Rest,
                    deviation: self.rng.random_range(-DEVIATION..=DEVIATION),
                    last: there.position().unwrap_or_default(),
                    heading: 0.0,
                });
            }
            let figure = &mut self.figures[person];
            if let Some(position) = there.position() {
                let step = position - figure.last;
                if step.norm() > 1e-6 {
                    figure.heading = libm::atan2(step.y, step.x);
                }
                figure.last = position;
            }
            let shown = shows(person).unwrap_or(Gesture::Rest);
            if shown != figure.shows {
                figure.shows = shown;
                figure.body.change_mood();
            }
            figure.pose = figure.pose.towards(Pose::of(shown), ARM_RATE * elapsed);
        }
    }
}
