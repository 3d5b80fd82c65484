//! S3: asking people to make way, and doing as one of them says.
//!
//! [`Interact`] drives to its goal until somebody is in the way, announces itself, stops, asks, and
//! waits. A *master* may lead it forward and backward or send it to one side; if nobody does, it
//! chooses a [`crate::valley`] itself. [`next_state`] is the flow chart as the state machine M2 of
//! `spec/interact.md`, [`drive`] what a state asks for, [`Interact`] both of them as a [`Law`].
//!
//! The law sees people by [`Interact::observe_people`], from a depth camera. All of it is advice: the
//! [`crate::shield`] sees the same people by sonar and decides.

use crate::config::{Config, Field, is_count, parameters};
use crate::gesture::{self, Gesture, PEOPLE_MAX};
use crate::law::{Advice, Law};
use crate::math;
use crate::quantity::{Angle, Instant, OutOfRange, Speed, in_range, within};
use crate::shield::milliseconds;
use crate::valley::{Geometry, Person, Scene, Side};
use crate::view::{Pose, View};
use core::f32::consts::FRAC_PI_2;
use core::fmt;
use nalgebra::Vector2;

parameters! {
    view_half_angle: "rad", 0.1, 1.2,
        "Half the depth camera's angle of view, which looks straight ahead: 35 degrees, S3 section 3.";
    view_range_min: "m", 0.1, 3.0,
        "The camera sees nobody nearer than this.";
    view_range_max: "m", 1.0, 10.0,
        "The camera sees nobody farther away than this, S3 section 4.1.";
    camera_forward: "m", -1.0, 1.0,
        "How far the camera sits ahead of the centre of rotation.";
    person_radius: "m", 0.05, 1.0,
        "Least shoulder radius of a person: r_p, S3 E2, where it is not measured or measured less.";
    safety_distance: "m", 0.1, 2.0,
        "Safety distance: d, S3 E2. Half of it is kept on either side of the robot's hull.";
    notice_distance: "m", 0.5, 10.0,
        "Somebody in the way nearer than this is told that there is a robot.";
    stop_distance: "m", 0.3, 5.0,
        "Somebody in the way nearer than this makes the robot stop and ask, S3 section 3.";
    forward_distance: "m", 0.3, 5.0,
        "Led forward, the robot comes no nearer to anybody than this, centre to centre.";
    speed_max: "m/s", 0.02, 2.0,
        "Greatest speed through a valley: v_max, S3 E25.";
    turn_rate_max: "rad/s", 0.05, 4.0,
        "Greatest rate of the turn into a valley: omega_max, S3 E26.";
    lead_speed: "m/s", 0.0, 1.0,
        "Speed at which a master leads the robot forward; backward it is no faster than the base may be.";
    crowd_share: "share", 0.05, 1.0,
        "Share of the speed while there may be more people than the camera can track.";
    unseen_share: "share", 0.05, 1.0,
        "Share of the speed while somebody who is near is only remembered.";
    rotate_tolerance: "rad", 0.005, 0.3,
        "Heading error at which the turn into a valley is done.";
    announce_interval: "s", 0.5, 60.0,
        "\"Robot in the path\" is repeated after this time.";
    wait_time: "s", 0.5, 120.0,
        "How long the robot waits for somebody to take over before it plans for itself.";
    no_path_interval: "s", 0.5, 120.0,
        "After \"no free path\" the robot waits this long before it asks again.";
    master_lost_time: "s", 0.1, 60.0,
        "A master who is out of sight for this long is no master any more.";
    master_idle_time: "s", 0.5, 600.0,
        "A master who orders nothing for this long is no master any more.";
    rotate_time: "s", 1.0, 120.0,
        "A turn into a valley that takes longer is given up.";
    blocked_time: "s", 1.0, 120.0,
        "A robot that gets nowhere in a valley for this long gives it up.";
    camera_age_max: "s", 0.02, 2.0,
        "People are not known any more when the camera's last picture is older than this.";
    person_hold_time: "s", 0.5, 60.0,
        "How long somebody whose place is not looked at is believed to be there still.";
    gone_time: "s", 0.1, 10.0,
        "Somebody whose place is looked at and who is not seen there for this long has gone.";
}

/// The values of S3 where it gives them, ours where it does not, for a Pioneer-sized robot.
pub const USUAL: Parameters = Parameters {
    view_half_angle: 0.610_865_24,
    view_range_min: 0.5,
    view_range_max: 4.5,
    camera_forward: 0.0,
    person_radius: 0.25,
    safety_distance: 0.5,
    notice_distance: 4.0,
    stop_distance: 2.3,
    forward_distance: 2.0,
    speed_max: 0.3,
    turn_rate_max: 0.5,
    lead_speed: 0.2,
    crowd_share: 0.5,
    unseen_share: 0.6,
    rotate_tolerance: 0.03,
    announce_interval: 5.0,
    wait_time: 6.0,
    no_path_interval: 5.0,
    master_lost_time: 2.0,
    master_idle_time: 20.0,
    rotate_time: 20.0,
    blocked_time: 10.0,
    camera_age_max: 0.3,
    person_hold_time: 10.0,
    gone_time: 1.0,
};

/// Parameters that were checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    parameters: Parameters,
    geometry: Geometry,
}

impl core::ops::Deref for Settings {
    type Target = Parameters;

    fn deref(&self) -> &Parameters {
        &self.parameters
    }
}

/// It may take this far, m, to come to rest.
const STOPPING: f32 = 0.1;

impl Settings {
    /// Checks every parameter against its range, against the others and against the robot's.
    ///
    /// # Errors
    /// The first that is out of range, with the range.
    pub fn new(parameters: Parameters, config: &Config) -> Result<Self, OutOfRange> {
        let p = &parameters;
        let mut i = 0;
        while i < FIELDS.len() {
            let field = &FIELDS[i];
            let value = parameters.values()[i];
            in_range(field.name, value, field.min, field.max, field.unit)?;
            i += 1;
        }
        let (near, far) = (p.view_range_min, p.view_range_max);
        in_range("view_range_max", far, near, 10.0, "m")?;
        in_range("stop_distance", p.stop_distance, near, far, "m")?;
        in_range(
            "notice_distance",
            p.notice_distance,
            p.stop_distance,
            far,
            "m",
        )?;
        in_range("speed_max", p.speed_max, 0.02, config.speed_max, "m/s")?;
        in_range("lead_speed", p.lead_speed, 0.0, config.speed_max, "m/s")?;
        in_range(
            "turn_rate_max",
            p.turn_rate_max,
            0.05,
            config.turn_rate_max,
            "rad/s",
        )?;
        // Led forward, the robot stops before it touches.
        let touching = config.robot_radius + p.person_radius;
        in_range("forward_distance", p.forward_distance, touching, 5.0, "m")?;
        let geometry = Geometry::new(config.robot_radius, p.safety_distance, p.view_half_angle)?;
        // Where the robot stops, there is a valley on either side of somebody straight ahead.
        let least = geometry.least_range(p.person_radius) + STOPPING;
        in_range("stop_distance", p.stop_distance, least, far, "m")?;
        Ok(Self {
            parameters,
            geometry,
        })
    }

    /// Robot and camera as chapter valley takes them.
    #[must_use]
    pub const fn geometry(&self) -> &Geometry {
        &self.geometry
    }
}

/// Which way the camera's lateral coordinate counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LateralAxis {
    /// Positive to the camera's left, as a Kinect v2's.
    Left,
    /// Positive to the camera's right, as in S3's tables.
    Right,
}

/// Whose right it is that a gesture means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orders {
    /// The robot's.
    Robots,
    /// The person's who faces it: the robot's left.
    Persons,
}

/// What left and right mean (ER-S3-02). There is no default: getting it wrong sends the robot to the
/// wrong side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Of the camera.
    pub lateral_axis: LateralAxis,
    /// Of the gestures.
    pub orders: Orders,
}

/// What was seen when somebody stood beside the robot's axis and gave an order, to find out whether a
/// [`Frame`] is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// The side on which the person truly stood, seen by the robot.
    pub stood: Side,
    /// The lateral coordinate that the camera gave, m.
    pub lateral: f32,
    /// The gesture that was recognised.
    pub gesture: Gesture,
    /// The side, seen by the robot, to which the person wanted it to go.
    pub meant: Side,
}

/// Why a trial does not bear a frame out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommissioningError {
    /// The person did not stand clearly beside the axis.
    NotAside(OutOfRange),
    /// The camera's axis is the other one.
    LateralAxis,
    /// The gesture was neither right nor left.
    NoOrder(Gesture),
    /// The gesture means the other side.
    Orders,
}

impl fmt::Display for CommissioningError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAside(error) => error.fmt(f),
            Self::LateralAxis => f.write_str("the camera counts the other way than configured"),
            Self::NoOrder(gesture) => write!(f, "the gesture was {gesture}, not right or left"),
            Self::Orders => f.write_str("the gesture means the other side than configured"),
        }
    }
}

impl core::error::Error for CommissioningError {}

/// Nearer to the axis than this, m, a trial proves nothing.
const ASIDE: f32 = 0.3;

impl Frame {
    /// A lateral coordinate of the camera as metres to the robot's left.
    #[must_use]
    pub fn left(self, lateral: f32) -> f32 {
        match self.lateral_axis {
            LateralAxis::Left => lateral,
            LateralAxis::Right => -lateral,
        }
    }

    /// The side, seen by the robot, to which a gesture sends it; none if it is another gesture.
    #[must_use]
    pub const fn side(self, gesture: Gesture) -> Option<Side> {
        match (gesture, self.orders) {
            (Gesture::Right, Orders::Robots) | (Gesture::Left, Orders::Persons) => {
                Some(Side::Right)
            }
            (Gesture::Left, Orders::Robots) | (Gesture::Right, Orders::Persons) => Some(Side::Left),
            _ => None,
        }
    }

    /// Takes the frame into use, if a trial bears it out.
    ///
    /// # Errors
    /// [`CommissioningError`] if the person did not stand 0.3 m to 10 m beside the axis, or if camera
    /// or gesture mean the other side.
    //= interact.INV-6
    pub fn commissioned(self, trial: &Trial) -> Result<Commissioned, CommissioningError> {
        let aside = in_range(
            "lateral place in the trial",
            trial.lateral.abs(),
            ASIDE,
            10.0,
            "m",
        );
        aside.map_err(CommissioningError::NotAside)?;
        if (self.left(trial.lateral) > 0.0) != (trial.stood == Side::Left) {
            return Err(CommissioningError::LateralAxis);
        }
        match self.side(trial.gesture) {
            None => Err(CommissioningError::NoOrder(trial.gesture)),
            Some(side) if side != trial.meant => Err(CommissioningError::Orders),
            Some(_) => Ok(Commissioned(self)),
        }
    }
}

/// A [`Frame`] that a [`Trial`] has borne out: the only one that a robot drives with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commissioned(Frame);

/// One person in a picture: untrusted, as the camera gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Someone {
    /// The same person has the same number from picture to picture, as far as the camera can tell.
    pub id: u64,
    /// Lateral coordinate, m; which way it counts is [`LateralAxis`].
    pub lateral: f32,
    /// Depth, m.
    pub depth: f32,
    /// Distance between shoulder and neck, m, if it was measured.
    pub radius: Option<f32>,
    /// The gesture that counts.
    pub gesture: Option<Gesture>,
}

/// Everybody in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct People {
    /// When it was taken.
    pub taken_at: Instant,
    /// In any order and in any places.
    pub people: [Option<Someone>; PEOPLE_MAX],
}

impl People {
    /// The people of a picture with the gestures that count, each in its person's place. Somebody whose
    /// neck is not tracked has no place in the room, and is left out.
    #[must_use]
    pub fn of(frame: &gesture::Frame, gestures: &[Option<Gesture>; PEOPLE_MAX]) -> Self {
        let mut people = [None; PEOPLE_MAX];
        let mut i = 0;
        while i < PEOPLE_MAX {
            if let Some(skeleton) = &frame.people[i]
                && let Some(neck) = skeleton.neck
            {
                let breadth = |shoulder: Option<gesture::Point>| {
                    shoulder.map(|at| math::sqrt((at - neck).dot(&(at - neck))))
                };
                let shoulders = [
                    breadth(skeleton.left_shoulder),
                    breadth(skeleton.right_shoulder),
                ];
                people[i] = Some(Someone {
                    id: skeleton.id,
                    lateral: neck.x,
                    depth: neck.z,
                    radius: match shoulders {
                        [Some(one), Some(other)] => Some(one.max(other)),
                        [one, other] => one.or(other),
                    },
                    gesture: gestures[i],
                });
            }
            i += 1;
        }
        Self {
            taken_at: frame.taken_at,
            people,
        }
    }
}

/// What the robot says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Announcement {
    /// "Robot in the path".
    RobotInPath,
    /// "Interact".
    Interact,
    /// "No free path".
    NoFreePath,
}

impl Announcement {
    /// In words, as S3 has them.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::RobotInPath => "Robot in the path",
            Self::Interact => "Interact",
            Self::NoFreePath => "No free path",
        }
    }
}

/// A straight way through an accepted valley, in the odometry frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    from: Vector2<f32>,
    heading: Angle,
    length: f32,
    speed: f32,
    turn_rate: f32,
}

impl Path {
    /// A path from a point (m) in a direction, of a length in m, to be driven at a speed in m/s after
    /// a turn at a rate in rad/s.
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate is not within 10 km, or length, speed or turn rate not in 0 to
    /// 100 m, 0 to 10 m/s and 0 to 20 rad/s.
    pub fn new(
        from: Vector2<f32>,
        heading: Angle,
        length: f32,
        speed: f32,
        turn_rate: f32,
    ) -> Result<Self, OutOfRange> {
        in_range("x of a path", from.x, -1e4, 1e4, "m")?;
        in_range("y of a path", from.y, -1e4, 1e4, "m")?;
        Ok(Self {
            from,
            heading,
            length: in_range("length of a path", length, 0.0, 100.0, "m")?,
            speed: in_range("speed of a path", speed, 0.0, 10.0, "m/s")?,
            turn_rate: in_range("turn rate of a path", turn_rate, 0.0, 20.0, "rad/s")?,
        })
    }

    /// Where it begins, m.
    #[must_use]
    pub const fn from(&self) -> Vector2<f32> {
        self.from
    }

    /// Its direction.
    #[must_use]
    pub const fn heading(&self) -> Angle {
        self.heading
    }

    /// d_ca, m.
    #[must_use]
    pub const fn length(&self) -> f32 {
        self.length
    }

    /// E25: the speed along it, m/s.
    #[must_use]
    pub const fn speed(&self) -> f32 {
        self.speed
    }

    /// E26: the greatest rate of the turn into it, rad/s.
    #[must_use]
    pub const fn turn_rate(&self) -> f32 {
        self.turn_rate
    }

    /// A point's place along the path and to its left, m.
    fn coordinates(&self, point: Vector2<f32>) -> [f32; 2] {
        in_direction(point - self.from, self.heading)
    }
}

/// An offset along a direction and to its left.
fn in_direction(offset: Vector2<f32>, heading: Angle) -> [f32; 2] {
    let (sin, cos) = (math::sin(heading.get()), math::cos(heading.get()));
    [
        offset.x * cos + offset.y * sin,
        offset.y * cos - offset.x * sin,
    ]
}

/// How a valley is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The one nearest to the way to the goal.
    Waypoint,
    /// The one nearest to straight ahead on this side of the master.
    Side(Side),
}

/// The states of M2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// To the goal.
    Follow,
    /// Still on the way, with somebody ahead who is told so.
    Announce,
    /// Coming to rest, and staying there while somebody shows Stop or the camera gives nothing.
    Stop,
    /// "Interact".
    AskInteract,
    /// For somebody to take over or make way.
    Wait,
    /// Somebody gives the orders.
    Master,
    /// Choosing a valley.
    Plan(Choice),
    /// Turning into the valley.
    Rotate(Path),
    /// Driving through it.
    Traverse(Path),
    /// Back to the goal.
    Resume,
    /// There is no valley, and people are told so.
    NoFreePath,
    /// At the goal.
    Arrived,
}

impl State {
    /// Its name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Follow => "follow",
            Self::Announce => "announce",
            Self::Stop => "stop",
            Self::AskInteract => "ask-interact",
            Self::Wait => "wait",
            Self::Master => "master",
            Self::Plan(_) => "plan",
            Self::Rotate(_) => "rotate",
            Self::Traverse(_) => "traverse",
            Self::Resume => "resume",
            Self::NoFreePath => "no-free-path",
            Self::Arrived => "arrived",
        }
    }

    /// The robot may move in it.
    #[must_use]
    pub const fn moves(&self) -> bool {
        matches!(
            self,
            Self::Follow
                | Self::Announce
                | Self::Master
                | Self::Rotate(_)
                | Self::Traverse(_)
                | Self::Resume
        )
    }

    /// The plan that it carries out.
    #[must_use]
    pub const fn path(&self) -> Option<&Path> {
        match self {
            Self::Rotate(path) | Self::Traverse(path) => Some(path),
            _ => None,
        }
    }
}

/// What a master who is in sight orders in this very cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// The gesture, if any counts.
    pub gesture: Option<Gesture>,
    /// The side to which it sends the robot, if it is one of those.
    pub side: Option<Side>,
    /// Direction of the master.
    pub bearing: Angle,
    /// Distance of the nearest person ahead, centre to centre, m.
    pub nearest_ahead: f32,
}

/// What M2 needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// The robot is at its goal.
    pub at_goal: bool,
    /// The camera's picture is recent.
    pub camera: bool,
    /// Somebody shows Stop.
    pub stop_shown: bool,
    /// Somebody is in the way to the goal and near enough to be told.
    pub in_path: bool,
    /// Somebody is in the way to the goal and too near to drive on.
    pub near: bool,
    /// Nobody is in the way to the goal, and nobody nearly.
    pub path_free: bool,
    /// The robot does not move.
    pub at_rest: bool,
    /// There is a master.
    pub master: bool,
    /// The master is in sight and may order something.
    pub order: Option<Order>,
    /// The time that the state may last is over.
    pub overdue: bool,
    /// In Plan: the way that was found.
    pub plan: Option<Path>,
    /// The robot looks where the state wants it to.
    pub aligned: bool,
    /// In Traverse: the people are passed.
    pub passed: bool,
    /// In Rotate and Traverse: somebody has come too near to what is left of the way.
    pub intruded: bool,
}

/// M2: the state that follows. Total; a stop comes before everything but having arrived.
//= interact.INV-2
//= interact.INV-4
//= interact.INV-8
#[must_use]
pub fn next_state(state: &State, now: &Situation) -> State {
    if *state == State::Arrived || now.at_goal {
        return State::Arrived;
    }
    // Somebody shows Stop, or nobody can be seen to show it.
    if now.stop_shown || !now.camera {
        return match state {
            // A master's hold is kept; nothing moves meanwhile.
            State::Master if now.camera && now.master => State::Master,
            _ => State::Stop,
        };
    }
    match *state {
        State::Follow | State::Announce | State::Resume if now.near => State::Stop,
        State::Follow | State::Announce | State::Resume if now.in_path => State::Announce,
        State::Resume if !now.aligned => State::Resume,
        State::Follow | State::Announce | State::Resume => State::Follow,
        State::Stop if !now.at_rest => State::Stop,
        State::Stop if now.path_free => State::Resume,
        State::Stop => State::AskInteract,
        State::AskInteract => State::Wait,
        State::Wait if now.master => State::Master,
        // Not while the order lasts that could not be followed.
        State::NoFreePath if now.order.is_some_and(|order| order.side.is_none()) => State::Master,
        State::Wait | State::NoFreePath if now.path_free => State::Resume,
        State::Wait if now.overdue => State::Plan(Choice::Waypoint),
        State::Wait => State::Wait,
        State::NoFreePath if now.overdue => State::AskInteract,
        State::NoFreePath => State::NoFreePath,
        State::Master if !now.master || now.overdue => State::Wait,
        State::Master => match now.order.and_then(|order| order.side) {
            Some(side) => State::Plan(Choice::Side(side)),
            None => State::Master,
        },
        State::Plan(_) => now.plan.map_or(State::NoFreePath, State::Rotate),
        State::Rotate(_) | State::Traverse(_) if now.intruded || now.overdue => State::Stop,
        State::Rotate(path) if now.aligned => State::Traverse(path),
        State::Rotate(path) => State::Rotate(path),
        State::Traverse(_) if now.passed => State::Resume,
        State::Traverse(path) => State::Traverse(path),
        State::Arrived => State::Arrived,
    }
}

/// What a state asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Nothing moves.
    Rest,
    /// To the goal.
    ToGoal,
    /// Turn on the spot into the path.
    Turn(Path),
    /// Along the path.
    Along(Path),
    /// Towards the master, in this direction.
    Forward(Angle),
    /// Straight back.
    Backward,
}

/// What a state asks for in a situation. Forward and backward are a dead man's switch: they last no
/// longer than the gesture, the master and the camera's picture, and forward no nearer to anybody than
/// `forward_distance` (m).
//= interact.INV-1
//= interact.INV-3
#[must_use]
pub fn drive(state: &State, now: &Situation, forward_distance: f32, rear_sensing: bool) -> Drive {
    if now.stop_shown || !now.camera {
        return Drive::Rest;
    }
    match *state {
        State::Follow | State::Announce | State::Resume => Drive::ToGoal,
        State::Rotate(path) => Drive::Turn(path),
        State::Traverse(path) => Drive::Along(path),
        State::Master => match now.order {
            Some(order) if order.gesture == Some(Gesture::Forward) => {
                if order.nearest_ahead > forward_distance {
                    Drive::Forward(order.bearing)
                } else {
                    Drive::Rest
                }
            }
            Some(order) if order.gesture == Some(Gesture::Backward) && rear_sensing => {
                Drive::Backward
            }
            _ => Drive::Rest,
        },
        State::Stop
        | State::AskInteract
        | State::Wait
        | State::Plan(_)
        | State::NoFreePath
        | State::Arrived => Drive::Rest,
    }
}

/// Something that has happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The robot has something to say.
    Say(Announcement),
    /// Another state has begun.
    Entered(State),
    /// This person gives the orders now.
    MasterIs(u64),
    /// Nobody does any more.
    MasterLost,
}

/// Events that wait to be fetched.
const EVENTS: usize = 16;

/// Events in their order; the oldest is lost, and counted, where nobody fetches them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Events {
    waiting: [Option<Event>; EVENTS],
    lost: u32,
}

impl Events {
    const NONE: Self = Self {
        waiting: [None; EVENTS],
        lost: 0,
    };

    fn push(&mut self, event: Event) {
        let mut i = 0;
        while i < EVENTS {
            if self.waiting[i].is_none() {
                self.waiting[i] = Some(event);
                return;
            }
            i += 1;
        }
        self.pop();
        self.lost = self.lost.saturating_add(1);
        self.waiting[EVENTS - 1] = Some(event);
    }

    fn pop(&mut self) -> Option<Event> {
        let first = self.waiting[0].take();
        self.waiting.rotate_left(1);
        first
    }
}

/// People who are remembered: those in sight, and as many who are not.
const TRACKS: usize = 2 * PEOPLE_MAX;
/// Somebody without a number that is known is one who was this near, m.
const GATE: f32 = 0.6;

/// A person who is remembered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Their number.
    pub id: u64,
    /// Their place in the odometry frame, m.
    pub position: Vector2<f32>,
    /// Shoulder radius, m.
    pub radius: f32,
    /// When they were last seen.
    pub seen: Instant,
    /// Since when their place has been looked at without them.
    pub missed: Option<Instant>,
    /// They are in the camera's latest picture.
    pub in_sight: bool,
    /// The gesture that they show in it.
    pub gesture: Option<Gesture>,
}

/// Where the robot was, and when.
const POSES: usize = 8;

/// S3's law: M2, with valleys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interact {
    settings: Settings,
    config: Config,
    frame: Frame,
    rear_sensing: bool,
    state: State,
    since: Option<Instant>,
    said: Option<Instant>,
    tracks: [Option<Track>; TRACKS],
    latest: Option<People>,
    /// The picture that the tracks are from.
    taken_in: Option<Instant>,
    poses: [Option<(Instant, Pose)>; POSES],
    master: Option<u64>,
    /// When the master last ordered something.
    ordered: Option<Instant>,
    /// Where the robot was when it last got on.
    progress: Option<(Vector2<f32>, Instant)>,
    events: Events,
}

/// A robot that has gone this far, m, gets on.
const PROGRESS: f32 = 0.05;

impl Interact {
    /// The law, about to follow its way. `rear_sensing` says that the base may back off and sonars
    /// look where it does: [`crate::ring::Ring::looks_back`] and a `reverse_speed_max` above 0.
    #[must_use]
    pub const fn new(
        settings: Settings,
        config: Config,
        frame: Commissioned,
        rear_sensing: bool,
    ) -> Self {
        Self {
            settings,
            config,
            frame: frame.0,
            rear_sensing,
            state: State::Follow,
            since: None,
            said: None,
            tracks: [None; TRACKS],
            latest: None,
            taken_in: None,
            poses: [None; POSES],
            master: None,
            ordered: None,
            progress: None,
            events: Events::NONE,
        }
    }

    /// The camera has seen this. Any bit pattern is allowed; a picture that is no newer than the last
    /// is ignored.
    pub fn observe_people(&mut self, people: &People) {
        if self
            .latest
            .is_none_or(|latest| people.taken_at > latest.taken_at)
        {
            self.latest = Some(*people);
        }
    }

    /// The next thing that has happened, if anything has.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// Events that nobody fetched in time.
    #[must_use]
    pub const fn events_lost(&self) -> u32 {
        self.events.lost
    }

    /// The state it is in.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// The people it knows of.
    pub fn people(&self) -> impl Iterator<Item = &Track> {
        self.tracks.iter().flatten()
    }

    /// Who gives the orders.
    #[must_use]
    pub const fn master(&self) -> Option<u64> {
        self.master
    }

    /// The picture is recent at `now`. One from the future is not.
    fn camera(&self, now: Instant) -> bool {
        let age_max = milliseconds(self.settings.camera_age_max);
        self.latest
            .is_some_and(|people| now.since(people.taken_at).is_some_and(|age| age <= age_max))
    }

    /// Where the robot was at a time, as far as is remembered.
    fn pose_at(&self, time: Instant, now: &Pose) -> Pose {
        let mut best = *now;
        let mut least = u64::MAX;
        let mut i = 0;
        while i < POSES {
            if let Some((at, pose)) = self.poses[i] {
                let off = at.0.abs_diff(time.0);
                if off < least {
                    (best, least) = (pose, off);
                }
            }
            i += 1;
        }
        best
    }

    /// Takes in the latest picture, once.
    fn take_in<const N: usize>(&mut self, view: &View<N>) {
        self.poses.rotate_right(1);
        self.poses[0] = Some((view.now, view.pose));
        let Some(people) = self.latest else {
            return;
        };
        if self.taken_in != Some(people.taken_at) && self.camera(view.now) {
            let before = self.taken_in.replace(people.taken_at);
            let gap = before.and_then(|before| people.taken_at.since(before));
            let age_max = milliseconds(self.settings.camera_age_max);
            let looked_on = gap.is_some_and(|gap| gap <= age_max);
            let pose = self.pose_at(people.taken_at, &view.pose);
            let mut i = 0;
            while i < TRACKS {
                if let Some(track) = &mut self.tracks[i] {
                    track.in_sight = false;
                    track.gesture = None;
                    // In a longer pause nobody has looked: the time of looking begins anew.
                    if !looked_on {
                        track.missed = None;
                    }
                }
                i += 1;
            }
            // Whose number is known first, so that nobody new is taken for one of them.
            let known = people.people.map(|someone| {
                let number = someone.map(|someone| someone.id);
                self.people().any(|track| Some(track.id) == number)
            });
            for turn in [true, false] {
                for (someone, known) in people.people.iter().zip(known) {
                    if let Some(someone) = someone
                        && known == turn
                    {
                        self.see(someone, &pose, people.taken_at);
                    }
                }
            }
            self.miss(&pose, people.taken_at);
        }
        self.forget(view.now);
    }

    /// Somebody is in the picture.
    fn see(&mut self, someone: &Someone, pose: &Pose, taken_at: Instant) {
        let far = self.settings.view_range_max;
        let (Ok(left), Ok(depth)) = (
            in_range("lateral", self.frame.left(someone.lateral), -far, far, "m"),
            in_range("depth", someone.depth, 0.0, far, "m"),
        ) else {
            return;
        };
        let measured = in_range(
            "shoulder radius",
            someone.radius.unwrap_or(0.0),
            0.05,
            0.5,
            "m",
        );
        let radius = measured.unwrap_or(0.0).max(self.settings.person_radius);
        let place = pose.to_world(Vector2::new(self.settings.camera_forward + depth, left));
        let slot = self.slot(someone.id, place);
        let Some(held) = self.tracks.get_mut(slot) else {
            return;
        };
        // A number that is there twice is nobody's: neither is taken at their gesture.
        let twice = held.is_some_and(|track| track.in_sight && track.id == someone.id);
        let position = match &*held {
            // The mean of where they were and where they are seen, which halves the noise.
            Some(track) if !twice && math::norm(track.position - place) < GATE => {
                (track.position + place) / 2.0
            }
            _ => place,
        };
        *held = Some(Track {
            id: someone.id,
            position,
            radius,
            seen: taken_at,
            missed: None,
            in_sight: true,
            gesture: if twice { None } else { someone.gesture },
        });
    }

    /// Where somebody is remembered: under their number, or as the nearest who is not seen yet, or in
    /// an empty place, or in that of the one who has not been seen for longest.
    fn slot(&self, id: u64, place: Vector2<f32>) -> usize {
        let mut near: Option<(usize, f32)> = None;
        let mut empty = None;
        let mut oldest = 0;
        let mut i = 0;
        while i < TRACKS {
            match &self.tracks[i] {
                Some(track) if track.id == id => return i,
                Some(track) => {
                    let off = math::norm(track.position - place);
                    if !track.in_sight && off < GATE && near.is_none_or(|(_, least)| off < least) {
                        near = Some((i, off));
                    }
                    let other = self.tracks.get(oldest).copied().flatten();
                    if other.is_some_and(|other| track.seen < other.seen) {
                        oldest = i;
                    }
                }
                None => {
                    if empty.is_none() {
                        empty = Some(i);
                    }
                }
            }
            i += 1;
        }
        near.map(|(i, _)| i).or(empty).unwrap_or(oldest)
    }

    /// Notes who is not in the picture although it shows their place.
    fn miss(&mut self, pose: &Pose, taken_at: Instant) {
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = self.tracks[i]
                && !track.in_sight
            {
                let looked_at = self.looks_at(&track, pose);
                if let Some(track) = &mut self.tracks[i] {
                    track.missed = match (looked_at, track.missed) {
                        (false, _) => None,
                        (true, since) => since.or(Some(taken_at)),
                    };
                }
            }
            i += 1;
        }
    }

    /// The picture shows a track's place: in the angle of view, neither too near nor too far, and
    /// nobody stands before it.
    fn looks_at(&self, track: &Track, pose: &Pose) -> bool {
        let at =
            |position| pose.to_robot(position) - Vector2::new(self.settings.camera_forward, 0.0);
        let place = at(track.position);
        let range = math::norm(place);
        let (near, far) = (self.settings.view_range_min, self.settings.view_range_max);
        // Wholly in view, so that a place at the edge is not taken for an empty one.
        let side = place.y.abs() + track.radius;
        let mut shown = range > near && range < far && self.settings.geometry.sees(place.x, side);
        let mut i = 0;
        while i < TRACKS {
            if let Some(other) = &self.tracks[i]
                && other.in_sight
            {
                let before = at(other.position);
                let nearer = math::norm(before) < range;
                let along = before.dot(&place) / range.max(0.1);
                let aside = (before.x * place.y - before.y * place.x).abs() / range.max(0.1);
                if nearer && along > 0.0 && aside < other.radius + track.radius {
                    shown = false;
                }
            }
            i += 1;
        }
        shown
    }

    /// Lets go of whoever has been missed for long enough, or not been seen for too long (ER-X1).
    //= interact.INV-7
    fn forget(&mut self, now: Instant) {
        let (gone, hold) = (self.settings.gone_time, self.settings.person_hold_time);
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = &self.tracks[i] {
                // Up to the latest picture: since then nobody has looked.
                let missed = track.missed.and_then(|since| self.taken_in?.since(since));
                let left = missed.is_some_and(|time| time >= milliseconds(gone));
                let expired = now
                    .since(track.seen)
                    .is_none_or(|time| time > milliseconds(hold));
                if left || expired {
                    self.tracks[i] = None;
                }
            }
            i += 1;
        }
    }

    /// Follows who is master, by numbers.
    fn follow_master(&mut self, now: Instant, camera: bool) {
        let in_sight = |track: &Track| track.in_sight && camera;
        let mut seen = None;
        let mut claims = None;
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = &self.tracks[i] {
                if Some(track.id) == self.master {
                    seen = Some(*track);
                }
                let claim = in_sight(track) && track.gesture == Some(Gesture::MasterSelect);
                // Of two at once the lower number, so that the places do not matter.
                if claim && claims.is_none_or(|id| track.id < id) {
                    claims = Some(track.id);
                }
            }
            i += 1;
        }
        if self.master.is_some() {
            let lost = seen.is_none_or(|track| {
                now.since(track.seen)
                    .is_none_or(|time| time > milliseconds(self.settings.master_lost_time))
            });
            if lost {
                self.dismiss();
            }
        }
        let asked = matches!(self.state, State::Wait | State::NoFreePath);
        if self.master.is_none()
            && asked
            && let Some(id) = claims
        {
            self.master = Some(id);
            self.ordered = Some(now);
            self.events.push(Event::MasterIs(id));
        }
    }

    fn dismiss(&mut self) {
        if self.master.take().is_some() {
            self.events.push(Event::MasterLost);
        }
    }

    /// How far a person's centre must stay from a way that is being driven: half the margin that it
    /// was planned with, so that a step aside or a camera's noise does not end it.
    fn kept(&self, track: &Track) -> f32 {
        track.radius + self.config.robot_radius + self.settings.safety_distance / 4.0
    }

    /// What M2 needs to know of a view.
    fn situation<const N: usize>(&self, view: &View<N>) -> Situation {
        let camera = self.camera(view.now);
        let mut now = Situation {
            at_goal: view.goal.distance <= self.config.goal_tolerance,
            camera,
            stop_shown: false,
            in_path: false,
            near: false,
            path_free: true,
            at_rest: view.speed.abs() <= 0.01 && view.turn_rate.abs() <= 0.02,
            master: self.master.is_some(),
            order: None,
            overdue: self.overdue(view.now),
            plan: None,
            aligned: false,
            passed: false,
            intruded: false,
        };
        let to_goal = view.goal.heading.minus(view.pose.heading);
        now.aligned = match self.state {
            State::Rotate(path) => {
                let error = path.heading.minus(view.pose.heading).get();
                error.abs() <= self.settings.rotate_tolerance
            }
            _ => to_goal.get().abs() <= self.config.alignment,
        };
        now.passed = self.state.path().is_some_and(|path| {
            let [along, _] = path.coordinates(view.pose.position);
            along >= path.length
        });
        let mut nearest_ahead = f32::MAX;
        let mut master = None;
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = &self.tracks[i] {
                let offset = track.position - view.pose.position;
                let range = math::norm(offset);
                let [along, aside] = in_direction(offset, view.goal.heading);
                let (kept, wanted) = (self.kept(track), self.wanted(track));
                let before_goal = along > 0.0 && along < view.goal.distance + kept;
                if before_goal && range < self.settings.notice_distance {
                    now.in_path |= aside.abs() < kept;
                    now.near |= aside.abs() < kept && range <= self.settings.stop_distance;
                    now.path_free &= aside.abs() >= wanted;
                }
                let [ahead, _] = in_direction(offset, view.pose.heading);
                if ahead > 0.0 {
                    nearest_ahead = nearest_ahead.min(range);
                }
                if let Some(path) = self.state.path() {
                    now.intruded |= self.is_in(path, track, &view.pose);
                }
                now.stop_shown |= camera && track.gesture == Some(Gesture::Stop);
                if camera && track.in_sight && Some(track.id) == self.master {
                    master = Some(track);
                }
            }
            i += 1;
        }
        now.order = master.map(|track| {
            let offset = track.position - view.pose.position;
            Order {
                gesture: track.gesture,
                side: track.gesture.and_then(|gesture| self.frame.side(gesture)),
                bearing: Angle::radians(math::atan2(offset.y, offset.x)).unwrap_or(Angle::ZERO),
                nearest_ahead,
            }
        });
        if let State::Plan(choice) = self.state {
            now.plan = self.plan(choice, view);
        }
        now
    }

    /// c: how far a person's centre must stay from a way that is planned.
    fn wanted(&self, track: &Track) -> f32 {
        track.radius + self.config.robot_radius + self.settings.safety_distance / 2.0
    }

    /// Somebody is too near to what is left of a path.
    fn is_in(&self, path: &Path, track: &Track, pose: &Pose) -> bool {
        let [along, aside] = path.coordinates(track.position);
        let [here, _] = path.coordinates(pose.position);
        let end = path.length.max(here);
        // From where the robot is: what is behind does not matter.
        let beyond = if along < here {
            return false;
        } else if along > end {
            along - end
        } else {
            0.0
        };
        aside * aside + beyond * beyond < self.kept(track) * self.kept(track)
    }

    /// The state has lasted as long as it may.
    fn overdue(&self, now: Instant) -> bool {
        let over = |since: Option<Instant>, seconds: f32| {
            since.is_some_and(|since| {
                now.since(since)
                    .is_none_or(|time| time >= milliseconds(seconds))
            })
        };
        match self.state {
            State::Wait => over(self.since, self.settings.wait_time),
            State::NoFreePath => over(self.since, self.settings.no_path_interval),
            State::Master => over(self.ordered, self.settings.master_idle_time),
            State::Rotate(_) => over(self.since, self.settings.rotate_time),
            State::Traverse(_) => over(self.progress.map(|(_, at)| at), self.settings.blocked_time),
            _ => false,
        }
    }

    /// Everybody ahead, for chapter valley, and the master's place among them if they are there. None
    /// if they are more than can be judged, or if somebody is right beside the robot.
    fn scene<const N: usize>(&self, view: &View<N>) -> Option<(Scene, Option<usize>)> {
        let mut people = [None; PEOPLE_MAX];
        let mut count = 0;
        let mut master = None;
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = &self.tracks[i] {
                let place = view.pose.to_robot(track.position);
                if place.x > 0.0 {
                    let person = Person::at(place.x, place.y, track.radius).ok()?;
                    *people.get_mut(count)? = Some(person);
                    count += 1;
                    if Some(track.id) == self.master {
                        master = Some(person);
                    }
                } else if math::norm(place) < self.wanted(track) {
                    return None;
                }
            }
            i += 1;
        }
        let mut list = [Person::at(0.0, 0.0, self.settings.person_radius).ok()?; PEOPLE_MAX];
        let mut i = 0;
        while i < count {
            let (slot, person) = (list.get_mut(i)?, people.get(i)?);
            *slot = (*person)?;
            i += 1;
        }
        let scene = Scene::new(list.get(..count)?).ok()?;
        let place =
            master.and_then(|master| scene.people().iter().position(|person| *person == master));
        Some((scene, place))
    }

    /// The way that a choice gives, if there is any.
    fn plan<const N: usize>(&self, choice: Choice, view: &View<N>) -> Option<Path> {
        let (scene, master) = self.scene(view)?;
        let geometry = self.settings.geometry();
        let valleys = geometry.valleys(&scene);
        let valley = match choice {
            Choice::Waypoint => {
                let waypoint = view.goal.heading.minus(view.pose.heading);
                valleys.by_waypoint(-waypoint.get())
            }
            Choice::Side(side) => valleys.by_side(side, master?),
        }?;
        let speed_max = Speed::metres_per_second(self.settings.speed_max).unwrap_or(Speed::ZERO);
        let crowd = if scene.may_be_more() {
            self.settings.crowd_share
        } else {
            1.0
        };
        let turn_rate = valley.turn_rate(geometry, self.settings.turn_rate_max);
        Path::new(
            view.pose.position,
            view.pose.heading.plus(valley.turn()),
            valley.length,
            valley.speed(geometry, speed_max).scaled(crowd).get(),
            turn_rate.abs(),
        )
        .ok()
    }

    /// Goes on to the next state, and says what there is to say.
    fn advance(&mut self, next: State, now: Instant) {
        let another = core::mem::discriminant(&next) != core::mem::discriminant(&self.state);
        self.state = next;
        let repeat = self.said.is_none_or(|said| {
            now.since(said)
                .is_none_or(|time| time >= milliseconds(self.settings.announce_interval))
        });
        let say = match next {
            State::Announce if repeat => Some(Announcement::RobotInPath),
            State::AskInteract if another => Some(Announcement::Interact),
            State::NoFreePath if another => Some(Announcement::NoFreePath),
            _ => None,
        };
        if another || self.since.is_none() {
            self.since = Some(now);
            self.events.push(Event::Entered(next));
        }
        if let Some(announcement) = say {
            if next == State::Announce {
                self.said = Some(now);
            }
            self.events.push(Event::Say(announcement));
        }
    }

    /// Somebody near is remembered and not seen.
    fn somebody_unseen<const N: usize>(&self, view: &View<N>) -> bool {
        let mut i = 0;
        while i < TRACKS {
            if let Some(track) = &self.tracks[i]
                && !track.in_sight
                && math::norm(track.position - view.pose.position) < self.settings.stop_distance
            {
                return true;
            }
            i += 1;
        }
        false
    }

    /// What is asked for, as speed and turn rate.
    //= interact.INV-5
    #[must_use]
    pub fn advice<const N: usize>(&self, drive: Drive, view: &View<N>) -> Advice {
        let config = &self.config;
        let unseen = if self.somebody_unseen(view) {
            self.settings.unseen_share
        } else {
            1.0
        };
        // First turn, then go.
        let towards = |heading: Angle, speed: f32, limit: f32| {
            let error = heading.minus(view.pose.heading).get();
            Advice {
                speed: speed * unseen * (1.0 - error.abs() / FRAC_PI_2).clamp(0.0, 1.0),
                turn_rate: within(config.heading_gain * error, limit),
            }
        };
        match drive {
            Drive::Rest => Advice::REST,
            Drive::ToGoal => towards(view.goal.heading, config.cruise_speed, config.turn_rate_max),
            Drive::Turn(path) => Advice {
                speed: 0.0,
                ..towards(
                    path.heading,
                    0.0,
                    path.turn_rate.min(self.settings.turn_rate_max),
                )
            },
            Drive::Along(path) => {
                // Back to the line where the robot has left it.
                let [_, aside] = path.coordinates(view.pose.position);
                let back = Angle::radians((-2.0 * aside).clamp(-0.3, 0.3)).unwrap_or(Angle::ZERO);
                let speed = path.speed.min(self.settings.speed_max);
                towards(path.heading.plus(back), speed, self.settings.turn_rate_max)
            }
            Drive::Forward(bearing) => {
                let limit = self.settings.turn_rate_max;
                towards(bearing, self.settings.lead_speed, limit)
            }
            Drive::Backward => Advice {
                speed: -config.reverse_speed_max.min(self.settings.lead_speed) * unseen,
                turn_rate: 0.0,
            },
        }
    }
}

impl<const N: usize> Law<N> for Interact {
    fn advise(&mut self, view: &View<N>) -> Advice {
        self.take_in(view);
        self.follow_master(view.now, self.camera(view.now));
        if self
            .progress
            .is_none_or(|(place, _)| math::norm(view.pose.position - place) >= PROGRESS)
            || !matches!(self.state, State::Traverse(_))
        {
            self.progress = Some((view.pose.position, view.now));
        }
        let situation = self.situation(view);
        let ordering = situation.order.and_then(|order| order.gesture);
        if ordering.is_some_and(|gesture| !matches!(gesture, Gesture::Rest | Gesture::MasterSelect))
        {
            self.ordered = Some(view.now);
        }
        let next = next_state(&self.state, &situation);
        if self.state == State::Master && !matches!(next, State::Master | State::Plan(_)) {
            self.dismiss();
        }
        self.advance(next, view.now);
        let limit = self.settings.forward_distance;
        let asked = drive(&self.state, &situation, limit, self.rear_sensing);
        self.advice(asked, view)
    }

    fn mode(&self) -> &'static str {
        self.state.name()
    }
}
