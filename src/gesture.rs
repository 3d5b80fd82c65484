//! What people tell the robot with their arms (S3 section 2).
//!
//! A depth camera's program gives [`Skeleton`]s; [`Features::of`] judges one and makes six
//! numbers of it that depend neither on how tall somebody is nor on where they stand nor on
//! which way they are turned.

use crate::math;
use crate::quantity::{Instant, OutOfRange, in_range};
use core::fmt;
use nalgebra::Vector3;

/// How many people a frame holds: a Kinect v2 follows six (S3 section 2). Six may be more.
pub const PEOPLE_MAX: usize = 6;

/// A point of the camera frame in metres: x to the camera's left, y straight up, z ahead.
///
/// This is right-handed and is the camera space of a Kinect v2. An optical frame (x to the right,
/// y down, z ahead) has x and y negated. In the frame of a robot whose camera looks straight
/// ahead, z is forward and x is left of the camera. A tilted camera's points are to be turned
/// level first.
pub type Point = Vector3<f32>;

/// One person as a camera's program reports them in one frame: untrusted.
///
/// A joint that is not tracked, or only inferred, has no position. Left and right are the
/// person's own.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Skeleton {
    /// The same person has the same number from frame to frame.
    pub id: u64,
    /// Base of the neck.
    pub neck: Option<Point>,
    /// Left shoulder.
    pub left_shoulder: Option<Point>,
    /// Right shoulder.
    pub right_shoulder: Option<Point>,
    /// Left elbow.
    pub left_elbow: Option<Point>,
    /// Right elbow.
    pub right_elbow: Option<Point>,
    /// Left wrist.
    pub left_wrist: Option<Point>,
    /// Right wrist.
    pub right_wrist: Option<Point>,
}

/// What a camera's program reports at one time: untrusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// When the picture was taken.
    pub taken_at: Instant,
    /// Everybody who is seen, in any order and in any places.
    pub people: [Option<Skeleton>; PEOPLE_MAX],
}

/// The seven classes (S3 section 2; the seventh: `spec/gesture.md`, ER-S3-13).
///
/// Left and right are the arms of the person who shows them. Which way the robot goes for them is
/// for chapter interact to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Gesture {
    /// Both arms hang: no order. The class that S3 does not list.
    Rest,
    /// Stop, as long as the gesture is raised. Both hands are up, the elbows bent.
    Stop,
    /// Pass on the right. The right arm is stretched out level.
    Right,
    /// Pass on the left. The left arm is stretched out level.
    Left,
    /// Come nearer, as long as the gesture is raised. Both hands are at the shoulders, the elbows
    /// down.
    Forward,
    /// Back off, as long as the gesture is raised. Both arms are stretched out level.
    Backward,
    /// Take orders from me. The right arm is straight up.
    MasterSelect,
}

impl Gesture {
    /// How many there are.
    pub const COUNT: usize = 7;
    /// All of them, each at its [`Self::index`].
    pub const ALL: [Self; Self::COUNT] = [
        Self::Rest,
        Self::Stop,
        Self::Right,
        Self::Left,
        Self::Forward,
        Self::Backward,
        Self::MasterSelect,
    ];

    /// Its number, from 0.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Stop => "stop",
            Self::Right => "right",
            Self::Left => "left",
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::MasterSelect => "master-select",
        }
    }
}

impl fmt::Display for Gesture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why a skeleton shows no gesture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// A joint that is needed is not tracked.
    NotTracked(&'static str),
    /// A number of the skeleton is not one of a person who faces the camera.
    OutOfRange(OutOfRange),
    /// The pose is not clearly of one class.
    Ambiguous,
    /// The pose is nearest to a class and yet not of it.
    Unlike(Gesture),
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotTracked(joint) => write!(f, "{joint} is not tracked"),
            Self::OutOfRange(error) => error.fmt(f),
            Self::Ambiguous => f.write_str("the pose is between two gestures"),
            Self::Unlike(gesture) => write!(f, "the pose is none; nearest is {gesture}"),
        }
    }
}

impl core::error::Error for Rejection {}

impl From<OutOfRange> for Rejection {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

/// Six numbers of a skeleton (S3 section 2): the height of the elbows and the wrists over the
/// neck, and the height and the advance of the neck over the middle of the shoulders; all in
/// lengths of an arm. The same for any size, any place and any turn about the vertical.
///
/// Each is finite and within [`Features::LIMIT`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features([f32; Features::COUNT]);

/// The largest size of a coordinate, m.
const COORDINATE_MAX: f32 = 10.0;
/// Mean length of the arms, from shoulder to wrist, m: 0.33 of a height from 0.9 m to 2.2 m with
/// room for noise (Drillis and Contini 1966: upper arm 0.186, forearm 0.146 of the height).
const ARM: (f32, f32) = (0.25, 0.9);
/// How much farther apart the shoulders are across the camera's view than the least, m.
const SHOULDERS: (f32, f32) = (0.08, 0.8);
/// Tangent of the farthest that somebody may be turned away: 55°, which is 40° and what noise of
/// the shoulders can add.
const TURN_TANGENT: f32 = 1.43;

impl Features {
    /// How many there are.
    pub const COUNT: usize = 6;
    /// None is larger than this in size: nobody's wrist is three arms away from the neck.
    pub const LIMIT: f32 = 3.0;
    /// Their names, in order.
    pub const NAMES: [&'static str; Self::COUNT] = [
        "left elbow height",
        "right elbow height",
        "left wrist height",
        "right wrist height",
        "neck height",
        "neck advance",
    ];

    /// Checks six bare numbers.
    ///
    /// # Errors
    /// [`OutOfRange`] if one is not finite or beyond [`Self::LIMIT`].
    pub fn new(values: [f32; Self::COUNT]) -> Result<Self, OutOfRange> {
        let mut i = 0;
        while i < Self::COUNT {
            in_range(
                Self::NAMES[i],
                values[i],
                -Self::LIMIT,
                Self::LIMIT,
                "arm lengths",
            )?;
            i += 1;
        }
        Ok(Self(values))
    }

    /// The bare numbers.
    #[must_use]
    pub const fn get(self) -> [f32; Self::COUNT] {
        self.0
    }

    /// The features of a skeleton.
    ///
    /// # Errors
    /// [`Rejection::NotTracked`] if a joint is missing, [`Rejection::OutOfRange`] if a coordinate
    /// is not finite or beyond 10 m, if the arms are not as long as a person's, or if the shoulders
    /// say that somebody is turned away by more than 55°.
    pub fn of(skeleton: &Skeleton) -> Result<Self, Rejection> {
        let neck = judged("neck", skeleton.neck)?;
        let left_shoulder = judged("left shoulder", skeleton.left_shoulder)?;
        let right_shoulder = judged("right shoulder", skeleton.right_shoulder)?;
        let left_elbow = judged("left elbow", skeleton.left_elbow)?;
        let right_elbow = judged("right elbow", skeleton.right_elbow)?;
        let left_wrist = judged("left wrist", skeleton.left_wrist)?;
        let right_wrist = judged("right wrist", skeleton.right_wrist)?;

        // Lengths in space do not change when somebody turns.
        let left = distance(left_shoulder, left_elbow) + distance(left_elbow, left_wrist);
        let right = distance(right_shoulder, right_elbow) + distance(right_elbow, right_wrist);
        let arm = in_range("arm length", 0.5 * (left + right), ARM.0, ARM.1, "m")?;

        // Whoever faces the camera has their right shoulder on its left.
        let across = right_shoulder.x - left_shoulder.x;
        let across = in_range("shoulder width", across, SHOULDERS.0, SHOULDERS.1, "m")?;
        let away = right_shoulder.z - left_shoulder.z;
        let limit = TURN_TANGENT * across;
        in_range(
            "difference of the shoulders' depth",
            away,
            -limit,
            limit,
            "m",
        )?;

        // How far the neck is ahead of the shoulders, the way that the person faces.
        let middle = 0.5 * (left_shoulder + right_shoulder);
        let offset = neck - middle;
        let width = math::sqrt(across * across + away * away);
        let advance = (offset.x * away - offset.z * across) / width;

        Ok(Self::new([
            (left_elbow.y - neck.y) / arm,
            (right_elbow.y - neck.y) / arm,
            (left_wrist.y - neck.y) / arm,
            (right_wrist.y - neck.y) / arm,
            offset.y / arm,
            advance / arm,
        ])?)
    }
}

/// The position of a joint that is tracked.
fn judged(joint: &'static str, position: Option<Point>) -> Result<Point, Rejection> {
    let position = position.ok_or(Rejection::NotTracked(joint))?;
    in_range(joint, position.x, -COORDINATE_MAX, COORDINATE_MAX, "m")?;
    in_range(joint, position.y, -COORDINATE_MAX, COORDINATE_MAX, "m")?;
    in_range(joint, position.z, 0.0, COORDINATE_MAX, "m")?;
    Ok(position)
}

fn distance(from: Point, to: Point) -> f32 {
    let way = to - from;
    math::sqrt(way.dot(&way))
}
