//! What people tell the robot with their arms (S3 section 2).
//!
//! A depth camera's program gives [`Skeleton`]s. [`Features::of`] judges one and makes six
//! numbers of it that depend neither on how tall somebody is nor on where they stand nor on
//! which way they are turned. A [`Model`] says which [`Gesture`] they are, or that they are none.
//! A [`Recognizer`] follows people from frame to frame: a gesture counts once it has been seen in
//! several frames in a row, and is lost in the first frame in which it is not.
//!
//! The weights are data, written by `cargo run -p sidestep-hw --example train_gestures`.

mod weights;

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

impl Skeleton {
    /// Its joints: neck, left and right shoulder, left and right elbow, left and right wrist.
    #[must_use]
    pub const fn joints(&self) -> [Option<Point>; 7] {
        [
            self.neck,
            self.left_shoulder,
            self.right_shoulder,
            self.left_elbow,
            self.right_elbow,
            self.left_wrist,
            self.right_wrist,
        ]
    }

    /// Its joints in the order of [`Self::joints`], if every one is tracked and somewhere.
    ///
    /// # Errors
    /// [`Rejection::NotTracked`] if a joint is missing, [`Rejection::OutOfRange`] if a coordinate is
    /// not finite, farther away than 10 m, or behind the camera.
    //= gesture.INV-3
    pub fn whole(&self) -> Result<[Point; 7], Rejection> {
        Ok([
            judged("neck", self.neck)?,
            judged("left shoulder", self.left_shoulder)?,
            judged("right shoulder", self.right_shoulder)?,
            judged("left elbow", self.left_elbow)?,
            judged("right elbow", self.right_elbow)?,
            judged("left wrist", self.left_wrist)?,
            judged("right wrist", self.right_wrist)?,
        ])
    }
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

    /// Its code of three bits, which the net's outputs spell: 1 the right elbow is raised, 2 the left
    /// elbow is, 4 the right forearm points up. Each is a plane in the space of features.
    #[must_use]
    pub const fn code(self) -> usize {
        match self {
            Self::Rest => 0,
            Self::Right => 1,
            Self::Left => 2,
            Self::Backward => 3,
            Self::Forward => 4,
            Self::MasterSelect => 5,
            Self::Stop => 7,
        }
    }

    /// The gesture with this code, if one has it.
    #[must_use]
    pub const fn spelled(code: usize) -> Option<Self> {
        match code {
            0 => Some(Self::Rest),
            1 => Some(Self::Right),
            2 => Some(Self::Left),
            3 => Some(Self::Backward),
            4 => Some(Self::Forward),
            5 => Some(Self::MasterSelect),
            7 => Some(Self::Stop),
            _ => None,
        }
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
    /// Another skeleton of the frame has the same number: whose gesture would it be?
    NotUnique(u64),
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
            Self::NotUnique(id) => write!(f, "two people have the number {id}"),
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

/// What is looked at in a skeleton, in lengths of an arm: the same for any size, any place and any
/// turn about the vertical. Each number is finite and within [`Features::LIMIT`].
///
/// Six are S3's (section 2), and what a classifier gets: the height of the elbows and the wrists
/// over the neck, and the height and the advance of the neck over the middle of the shoulders.
/// Heights alone do not tell a bent arm from a straight one, nor an arm held out to the side from
/// one held out ahead; four more numbers do, and serve to reject: how far each wrist is from its
/// shoulder, and how far out to its own side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    six: [f32; Features::COUNT],
    arms: [f32; Features::ARMS],
}

/// The largest size of a coordinate, m.
const COORDINATE_MAX: f32 = 10.0;
/// Mean length of the arms, from shoulder to wrist, m: 0.33 of a height from 0.9 m to 2.2 m with
/// room for noise (Drillis and Contini 1966: upper arm 0.186, forearm 0.146 of the height).
const ARM: (f32, f32) = (0.25, 0.9);
/// How far shoulders are apart, m.
const SHOULDERS: (f32, f32) = (0.08, 0.8);
/// Tangent of the farthest that somebody may be turned away: 55°, which is 40° and what noise of
/// the shoulders can add.
const TURN_TANGENT: f32 = 1.43;

impl Features {
    /// How many a classifier gets.
    pub const COUNT: usize = 6;
    /// How many more there are.
    pub const ARMS: usize = 4;
    /// None is larger than this in size: nobody's wrist is three arms away from the neck.
    pub const LIMIT: f32 = 3.0;
    /// Names of the six, in order.
    pub const NAMES: [&'static str; Self::COUNT] = [
        "left elbow height",
        "right elbow height",
        "left wrist height",
        "right wrist height",
        "neck height",
        "neck advance",
    ];
    /// Names of the four, in order.
    pub const ARM_NAMES: [&'static str; Self::ARMS] = [
        "left wrist from shoulder",
        "right wrist from shoulder",
        "left wrist outward",
        "right wrist outward",
    ];

    /// Checks bare numbers: the six and the four.
    ///
    /// # Errors
    /// [`OutOfRange`] if one is not finite or beyond [`Self::LIMIT`].
    pub fn new(six: [f32; Self::COUNT], arms: [f32; Self::ARMS]) -> Result<Self, OutOfRange> {
        let mut i = 0;
        while i < Self::COUNT {
            within(Self::NAMES[i], six[i])?;
            i += 1;
        }
        let mut i = 0;
        while i < Self::ARMS {
            within(Self::ARM_NAMES[i], arms[i])?;
            i += 1;
        }
        Ok(Self { six, arms })
    }

    /// The six that a classifier gets.
    #[must_use]
    pub const fn six(&self) -> &[f32; Self::COUNT] {
        &self.six
    }

    /// The four that serve to reject.
    #[must_use]
    pub const fn arms(&self) -> &[f32; Self::ARMS] {
        &self.arms
    }

    /// The features of a skeleton.
    ///
    /// # Errors
    /// [`Rejection::NotTracked`] if a joint is missing, [`Rejection::OutOfRange`] if a coordinate
    /// is not finite or beyond 10 m, if the arms are not as long as a person's, or if the shoulders
    /// say that somebody is turned away by more than 55°.
    //= gesture.INV-1
    //= gesture.INV-2
    pub fn of(skeleton: &Skeleton) -> Result<Self, Rejection> {
        let [
            neck,
            left_shoulder,
            right_shoulder,
            left_elbow,
            right_elbow,
            left_wrist,
            right_wrist,
        ] = skeleton.whole()?;

        // Lengths in space do not change when somebody turns.
        let left = distance(left_shoulder, left_elbow) + distance(left_elbow, left_wrist);
        let right = distance(right_shoulder, right_elbow) + distance(right_elbow, right_wrist);
        let arm = in_range("arm length", 0.5 * (left + right), ARM.0, ARM.1, "m")?;

        // Which way somebody faces is across their shoulders; where the camera is, is where they
        // should face.
        let across = right_shoulder - left_shoulder;
        let width = math::sqrt(across.x * across.x + across.z * across.z);
        let width = in_range("shoulder width", width, SHOULDERS.0, SHOULDERS.1, "m")?;
        let ahead = across.x * neck.z - across.z * neck.x;
        let aside = across.x * neck.x + across.z * neck.z;
        let tangent = if ahead > 0.0 {
            aside / ahead
        } else {
            f32::INFINITY
        };
        in_range(
            "tangent of the turn away",
            tangent,
            -TURN_TANGENT,
            TURN_TANGENT,
            "",
        )?;

        // How far the neck is ahead of the shoulders, the way that the person faces.
        let middle = 0.5 * (left_shoulder + right_shoulder);
        let offset = neck - middle;
        let advance = (offset.x * across.z - offset.z * across.x) / width;

        let outward = |from: Point, to: Point| {
            ((to.x - from.x) * across.x + (to.z - from.z) * across.z) / width
        };
        Ok(Self::new(
            [
                (left_elbow.y - neck.y) / arm,
                (right_elbow.y - neck.y) / arm,
                (left_wrist.y - neck.y) / arm,
                (right_wrist.y - neck.y) / arm,
                offset.y / arm,
                advance / arm,
            ],
            [
                distance(left_shoulder, left_wrist) / arm,
                distance(right_shoulder, right_wrist) / arm,
                -outward(left_shoulder, left_wrist) / arm,
                outward(right_shoulder, right_wrist) / arm,
            ],
        )?)
    }
}

/// Refuses a feature that nobody can have.
fn within(name: &'static str, value: f32) -> Result<f32, OutOfRange> {
    in_range(
        name,
        value,
        -Features::LIMIT,
        Features::LIMIT,
        "arm lengths",
    )
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

/// Pairs of classes.
pub const PAIRS: usize = Gesture::COUNT * (Gesture::COUNT - 1) / 2;
/// A weight for each feature, and the constant after them.
pub type Weights = [f32; Features::COUNT + 1];
/// The largest size of a weight: with it and features within their limit every sum is finite.
const WEIGHT_MAX: f32 = 1e6;

/// A weighted sum of the six features, and the constant. Finite for weights up to ±10⁶.
//= gesture.INV-4
#[must_use]
pub fn weighted_sum(weights: &Weights, features: &Features) -> f32 {
    let mut sum = weights[Features::COUNT];
    let mut i = 0;
    while i < Features::COUNT {
        sum += weights[i] * features.six[i];
        i += 1;
    }
    sum
}

/// Refuses weights with which a sum might not be finite.
fn check(weights: &[f32]) -> Result<(), OutOfRange> {
    for weight in weights {
        in_range("weight", *weight, -WEIGHT_MAX, WEIGHT_MAX, "")?;
    }
    Ok(())
}

/// What a classifier makes of six features: the nearest class, and how clearly it is that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The class.
    pub gesture: Gesture,
    /// How clearly; its unit is that of [`Model`]'s threshold. Finite.
    pub margin: f32,
}

/// A linear support vector machine for seven classes: one plane for each pair of classes (S3's
/// "21 support vectors").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportVectorMachine {
    /// Pairs (0, 1), (0, 2) … (5, 6); positive is the first.
    planes: [Weights; PAIRS],
}

impl SupportVectorMachine {
    /// A machine with these planes, for the pairs (0, 1), (0, 2) … (5, 6) of [`Gesture::index`];
    /// the side of the first is positive.
    ///
    /// # Errors
    /// [`OutOfRange`] if a weight is not finite or beyond ±10⁶.
    pub fn new(planes: [Weights; PAIRS]) -> Result<Self, OutOfRange> {
        for plane in &planes {
            check(plane)?;
        }
        Ok(Self { planes })
    }

    /// The planes, in the order of [`Self::new`].
    #[must_use]
    pub const fn planes(&self) -> &[Weights; PAIRS] {
        &self.planes
    }

    /// The scores of the duels, in the order of the planes. Finite.
    #[must_use]
    pub fn scores(&self, features: &Features) -> [f32; PAIRS] {
        let mut scores = [0.0; PAIRS];
        let mut pair = 0;
        while pair < PAIRS {
            scores[pair] = weighted_sum(&self.planes[pair], features);
            pair += 1;
        }
        scores
    }

    /// The class nearest to the features; its margin is its closest duel, where 1 is how clearly
    /// the nearest training samples win and negative is a duel lost.
    #[must_use]
    pub fn nearest(&self, features: &Features) -> Nearest {
        winner(&self.scores(features))
    }
}

/// The class that wins most of its six duels, the first of those that win as many, by its closest
/// duel. Scores are those of the pairs (0, 1), (0, 2) … (5, 6); positive is the first's victory.
//= gesture.INV-6
#[must_use]
pub fn winner(scores: &[f32; PAIRS]) -> Nearest {
    let mut won = [0_u8; Gesture::COUNT];
    let mut closest = [f32::MAX; Gesture::COUNT];
    let mut pair = 0;
    let mut first = 0;
    while first < Gesture::COUNT {
        let mut second = first + 1;
        while second < Gesture::COUNT {
            let score = scores[pair];
            if score >= 0.0 {
                won[first] += 1;
            } else {
                won[second] += 1;
            }
            closest[first] = closest[first].min(score);
            closest[second] = closest[second].min(-score);
            second += 1;
            pair += 1;
        }
        first += 1;
    }
    let mut best = 0;
    let mut i = 1;
    while i < Gesture::COUNT {
        if won[i] > won[best] {
            best = i;
        }
        i += 1;
    }
    Nearest {
        gesture: Gesture::ALL[best],
        margin: closest[best],
    }
}

/// Hidden neurons of the net, as S3 chooses.
pub const HIDDEN: usize = 6;
/// Output neurons: a binary code of up to eight classes.
pub const OUTPUTS: usize = 3;

/// A net with a layer of [`HIDDEN`] neurons and [`OUTPUTS`] output neurons that spell the class's
/// [`Gesture::code`], the least bit first.
///
/// A neuron of the hidden layer gives x/(1 + |x|) of its sum x. An output neuron's bit is 1 where
/// its sum is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeuralNetwork {
    hidden: [Weights; HIDDEN],
    output: [[f32; HIDDEN + 1]; OUTPUTS],
}

impl NeuralNetwork {
    /// A net with these weights, for each neuron those of its inputs and then the constant.
    ///
    /// # Errors
    /// [`OutOfRange`] if a weight is not finite or beyond ±10⁶.
    pub fn new(
        hidden: [Weights; HIDDEN],
        output: [[f32; HIDDEN + 1]; OUTPUTS],
    ) -> Result<Self, OutOfRange> {
        for neuron in &hidden {
            check(neuron)?;
        }
        for neuron in &output {
            check(neuron)?;
        }
        Ok(Self { hidden, output })
    }

    /// The weights of the hidden and the output neurons, as in [`Self::new`].
    #[must_use]
    pub const fn weights(&self) -> (&[Weights; HIDDEN], &[[f32; HIDDEN + 1]; OUTPUTS]) {
        (&self.hidden, &self.output)
    }

    /// The sums of the output neurons. Finite.
    #[must_use]
    pub fn outputs(&self, features: &Features) -> [f32; OUTPUTS] {
        let mut hidden = [0.0; HIDDEN];
        let mut i = 0;
        while i < HIDDEN {
            hidden[i] = squashed(weighted_sum(&self.hidden[i], features));
            i += 1;
        }
        let mut outputs = [0.0; OUTPUTS];
        let mut o = 0;
        while o < OUTPUTS {
            let mut sum = self.output[o][HIDDEN];
            let mut i = 0;
            while i < HIDDEN {
                sum += self.output[o][i] * hidden[i];
                i += 1;
            }
            outputs[o] = sum;
            o += 1;
        }
        outputs
    }

    /// The class that the outputs spell, if any.
    #[must_use]
    pub fn nearest(&self, features: &Features) -> Option<Nearest> {
        spelled_by(&self.outputs(features))
    }
}

/// The class that the sums of the output neurons spell, if it is one of the seven, by the smallest
/// of their sizes.
//= gesture.INV-7
#[must_use]
pub fn spelled_by(outputs: &[f32; OUTPUTS]) -> Option<Nearest> {
    let mut code = 0;
    let mut margin = f32::MAX;
    let mut bit = 0;
    while bit < OUTPUTS {
        if !outputs[bit].is_finite() {
            return None;
        }
        if outputs[bit] > 0.0 {
            code |= 1 << bit;
        }
        margin = margin.min(outputs[bit].abs());
        bit += 1;
    }
    let gesture = Gesture::spelled(code)?;
    Some(Nearest { gesture, margin })
}

/// x/(1 + |x|), in [−1, 1] for every finite x: the activation of the hidden neurons.
#[must_use]
pub fn squashed(x: f32) -> f32 {
    x / (1.0 + x.abs())
}

/// Mean and standard deviation of a feature.
pub type Usual = (f32, f32);
/// The least standard deviation of a feature: what is closer together is a mistake.
const SPREAD_MIN: f32 = 0.01;

/// How a class usually is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prototype {
    /// S3's six.
    pub six: [Usual; Features::COUNT],
    /// The four more.
    pub arms: [Usual; Features::ARMS],
}

/// How each class usually is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prototypes([Prototype; Gesture::COUNT]);

impl Prototypes {
    /// The prototypes, by [`Gesture::index`].
    ///
    /// # Errors
    /// [`OutOfRange`] if a mean is beyond ±[`Features::LIMIT`], or a standard deviation outside 0.01
    /// to [`Features::LIMIT`].
    pub fn new(prototypes: [Prototype; Gesture::COUNT]) -> Result<Self, OutOfRange> {
        for prototype in &prototypes {
            let six = Features::NAMES.iter().zip(&prototype.six);
            let arms = Features::ARM_NAMES.iter().zip(&prototype.arms);
            for (name, (mean, spread)) in six.chain(arms) {
                within(name, *mean)?;
                in_range(name, *spread, SPREAD_MIN, Features::LIMIT, "arm lengths")?;
            }
        }
        Ok(Self(prototypes))
    }

    /// How unlike a class features are. Of the squared distances of all ten from the class's means,
    /// in standard deviations, it is the mean, or a quarter of the greatest if that is more: many
    /// that are somewhat off count, and so does one that is far off. 1 is usual. Finite and not
    /// negative.
    #[must_use]
    pub fn unlikeness(&self, gesture: Gesture, features: &Features) -> f32 {
        let prototype = &self.0[gesture.index()];
        let mut sum = 0.0_f32;
        let mut greatest = 0.0_f32;
        let mut i = 0;
        while i < Features::COUNT {
            let square = squared_deviation(prototype.six[i], features.six[i]);
            sum += square;
            greatest = greatest.max(square);
            i += 1;
        }
        let mut i = 0;
        while i < Features::ARMS {
            let square = squared_deviation(prototype.arms[i], features.arms[i]);
            sum += square;
            greatest = greatest.max(square);
            i += 1;
        }
        let mean = sum / (Features::COUNT + Features::ARMS) as f32;
        mean.max(0.25 * greatest)
    }

    /// The prototypes, by [`Gesture::index`].
    #[must_use]
    pub const fn get(&self) -> &[Prototype; Gesture::COUNT] {
        &self.0
    }
}

/// The squared distance from the mean, in standard deviations.
fn squared_deviation((mean, spread): Usual, value: f32) -> f32 {
    let deviation = (value - mean) / spread;
    deviation * deviation
}

/// What tells the classes apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "nothing here allocates, and there is one of them"
)]
pub enum Classifier {
    /// S3's linear support vector machine.
    SupportVectorMachine(SupportVectorMachine),
    /// S3's net, the one that it chooses.
    NeuralNetwork(NeuralNetwork),
}

/// A classifier with what makes it refuse a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    classifier: Classifier,
    margin: f32,
    unlikeness: f32,
    prototypes: Prototypes,
}

impl Model {
    /// The linear support vector machine as trained.
    pub const SUPPORT_VECTOR_MACHINE: Self = Self {
        classifier: Classifier::SupportVectorMachine(weights::SUPPORT_VECTOR_MACHINE),
        margin: Self::SVM_MARGIN,
        unlikeness: Self::UNLIKENESS,
        prototypes: weights::PROTOTYPES,
    };
    /// The net as trained.
    pub const NEURAL_NETWORK: Self = Self {
        classifier: Classifier::NeuralNetwork(weights::NEURAL_NETWORK),
        margin: Self::NET_MARGIN,
        unlikeness: Self::UNLIKENESS,
        prototypes: weights::PROTOTYPES,
    };
    /// The winner of a support vector machine has to win every duel by half of what separates the
    /// classes' nearest samples.
    pub const SVM_MARGIN: f32 = 0.5;
    /// Each output of the net has to be this far from undecided: as an activation ±½.
    pub const NET_MARGIN: f32 = 1.0;
    /// The greatest [`Prototypes::unlikeness`] with which a pose is of a class.
    pub const UNLIKENESS: f32 = 4.0;

    /// A classifier, the least margin by which a class has to be the nearest, the greatest
    /// unlikeness with which a pose is of it, and how the classes usually are.
    ///
    /// # Errors
    /// [`OutOfRange`] if the margin is not in [0, 10⁶] or the unlikeness not in [1, 100].
    pub fn new(
        classifier: Classifier,
        margin: f32,
        unlikeness: f32,
        prototypes: Prototypes,
    ) -> Result<Self, OutOfRange> {
        Ok(Self {
            classifier,
            margin: in_range("margin", margin, 0.0, WEIGHT_MAX, "")?,
            unlikeness: in_range("unlikeness", unlikeness, 1.0, 100.0, "")?,
            prototypes,
        })
    }

    /// The class nearest to the features, whether or not they are of it.
    #[must_use]
    pub fn nearest(&self, features: &Features) -> Option<Nearest> {
        match &self.classifier {
            Classifier::SupportVectorMachine(machine) => Some(machine.nearest(features)),
            Classifier::NeuralNetwork(net) => net.nearest(features),
        }
    }

    /// The gesture that the features are.
    ///
    /// # Errors
    /// [`Rejection::Ambiguous`] if no class is nearest; else as [`Self::judge`].
    pub fn classify(&self, features: &Features) -> Result<Gesture, Rejection> {
        let nearest = self.nearest(features).ok_or(Rejection::Ambiguous)?;
        let unlikeness = self.prototypes.unlikeness(nearest.gesture, features);
        self.judge(&nearest, unlikeness)
    }

    /// Whether a pose is of the class that is nearest to it, as unlike it as it is.
    ///
    /// # Errors
    /// [`Rejection::Ambiguous`] if the margin is less than the least; [`Rejection::Unlike`] if the
    /// unlikeness is more than the greatest.
    //= gesture.INV-5
    pub fn judge(&self, nearest: &Nearest, unlikeness: f32) -> Result<Gesture, Rejection> {
        // Comparisons with NaN are false: it is neither clear nor like.
        let clear = nearest.margin >= self.margin;
        let like = unlikeness <= self.unlikeness;
        match (clear, like) {
            (false, _) => Err(Rejection::Ambiguous),
            (true, false) => Err(Rejection::Unlike(nearest.gesture)),
            (true, true) => Ok(nearest.gesture),
        }
    }

    /// The gesture that a skeleton shows.
    ///
    /// # Errors
    /// As [`Features::of`] and [`Self::classify`].
    pub fn recognize(&self, skeleton: &Skeleton) -> Result<Gesture, Rejection> {
        self.classify(&Features::of(skeleton)?)
    }

    /// The classifier.
    #[must_use]
    pub const fn classifier(&self) -> &Classifier {
        &self.classifier
    }

    /// The least margin by which a class has to be the nearest.
    #[must_use]
    pub const fn margin(&self) -> f32 {
        self.margin
    }

    /// The greatest unlikeness with which a pose is of a class.
    #[must_use]
    pub const fn unlikeness(&self) -> f32 {
        self.unlikeness
    }

    /// How the classes usually are.
    #[must_use]
    pub const fn prototypes(&self) -> &Prototypes {
        &self.prototypes
    }
}

impl Default for Model {
    /// The net, as S3 has it.
    fn default() -> Self {
        Self::NEURAL_NETWORK
    }
}

/// How often in a row a pose has been seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Debounce {
    /// The pose of the last frame, if it was one.
    pub pose: Option<Gesture>,
    /// In how many frames in a row it has been seen.
    pub frames: u32,
}

impl Debounce {
    /// After one more frame that shows `pose`.
    //= gesture.INV-8
    #[must_use]
    pub fn after(self, pose: Option<Gesture>) -> Self {
        let frames = match pose {
            None => 0,
            Some(_) if pose == self.pose => self.frames.saturating_add(1),
            Some(_) => 1,
        };
        Self { pose, frames }
    }

    /// The gesture that counts, if so many frames are asked for.
    //= gesture.INV-8
    //= gesture.INV-9
    #[must_use]
    pub fn gesture(self, frames: u32) -> Option<Gesture> {
        if self.frames >= frames {
            self.pose
        } else {
            None
        }
    }
}

/// How a [`Recognizer`] follows people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Frames in a row in which a gesture has to be seen before it counts, 1 to 60. An arm on its way
    /// up passes through other gestures: this has to be longer than that takes.
    pub frames: u32,
    /// The same for stop, 1 to `frames`: to stop is always allowed, so less will do.
    pub stop_frames: u32,
    /// Frames farther apart than this are not "in a row", ms, 20 to 1000.
    pub frame_age_max: u64,
}

impl Default for Settings {
    /// A third of a second of a camera with 30 frames a second, and a tenth for stop.
    fn default() -> Self {
        Self {
            frames: 10,
            stop_frames: 3,
            frame_age_max: 200,
        }
    }
}

impl Settings {
    /// Frames in a row after which a gesture counts.
    #[must_use]
    pub const fn frames_for(&self, gesture: Gesture) -> u32 {
        match gesture {
            Gesture::Stop => self.stop_frames,
            _ => self.frames,
        }
    }
}

/// One person of a frame, as recognised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// The number that the camera's program gave them.
    pub id: u64,
    /// What this frame alone shows.
    pub pose: Result<Gesture, Rejection>,
    /// What counts: a pose that has been shown for long enough and is shown in this frame.
    pub gesture: Option<Gesture>,
}

/// Follows the people of a camera's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recognizer {
    model: Model,
    settings: Settings,
    people: [Option<(u64, Debounce)>; PEOPLE_MAX],
    taken_at: Option<Instant>,
}

impl Recognizer {
    /// A recogniser that has seen nobody yet.
    ///
    /// # Errors
    /// [`OutOfRange`] if a setting is out of its range.
    pub fn new(model: Model, settings: Settings) -> Result<Self, OutOfRange> {
        let frames = in_range(
            "gesture frames",
            settings.frames as f32,
            1.0,
            60.0,
            "frames",
        )?;
        let stop_frames = settings.stop_frames as f32;
        in_range("gesture stop frames", stop_frames, 1.0, frames, "frames")?;
        in_range(
            "gesture frame age",
            settings.frame_age_max as f32,
            20.0,
            1000.0,
            "ms",
        )?;
        Ok(Self {
            model,
            settings,
            people: [None; PEOPLE_MAX],
            taken_at: None,
        })
    }

    /// Looks at the next frame. People are in the places in which the frame has them.
    ///
    /// A frame that is not later than the one before, or too much later, begins anew: no gesture
    /// counts until it has been seen often enough again.
    pub fn update(&mut self, frame: &Frame) -> [Option<Person>; PEOPLE_MAX] {
        let in_a_row = match self.taken_at {
            Some(before) => frame
                .taken_at
                .since(before)
                .is_some_and(|gap| gap > 0 && gap <= self.settings.frame_age_max),
            None => false,
        };
        let mut people = [None; PEOPLE_MAX];
        let mut seen = [None; PEOPLE_MAX];
        let mut i = 0;
        while i < PEOPLE_MAX {
            if let Some(skeleton) = &frame.people[i] {
                let pose = if alone(&frame.people, i) {
                    self.model.recognize(skeleton)
                } else {
                    Err(Rejection::NotUnique(skeleton.id))
                };
                let before = if in_a_row {
                    self.before(skeleton.id)
                } else {
                    Debounce::default()
                };
                let now = before.after(pose.ok());
                people[i] = Some((skeleton.id, now));
                seen[i] = Some(Person {
                    id: skeleton.id,
                    pose,
                    gesture: pose
                        .ok()
                        .and_then(|pose| now.gesture(self.settings.frames_for(pose))),
                });
            }
            i += 1;
        }
        self.people = people;
        self.taken_at = Some(frame.taken_at);
        seen
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> Settings {
        self.settings
    }

    fn before(&self, id: u64) -> Debounce {
        let mut i = 0;
        while i < PEOPLE_MAX {
            if let Some((other, debounce)) = self.people[i]
                && other == id
            {
                return debounce;
            }
            i += 1;
        }
        Debounce::default()
    }
}

/// Whether nobody else in the frame has the number of the person in place `at`.
fn alone(people: &[Option<Skeleton>; PEOPLE_MAX], at: usize) -> bool {
    let id = people[at].map(|person| person.id);
    let mut i = 0;
    while i < PEOPLE_MAX {
        if i != at && people[i].map(|person| person.id) == id {
            return false;
        }
        i += 1;
    }
    true
}
