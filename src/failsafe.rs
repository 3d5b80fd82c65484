//! What is done about what goes wrong: actions in order of severity, and every cause with its
//! action.
//!
//! Actions form a join-semilattice: whatever goes wrong at once, the worst of the actions is taken,
//! in whatever order the causes are looked at (`proofs/failsafe.rs`). [`table`] is what the code
//! does, as text; `spec/failsafe.md` holds a copy that a test compares with it.

use crate::view::Class;
use core::fmt;

/// What is done, from the mildest to the most severe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Action {
    /// The law's advice is taken.
    Run,
    /// No faster than the room allows.
    Limit,
    /// No faster than before.
    Slow,
    /// Rest, until the cause has been gone for a while.
    Stop,
    /// Rest, until the cause is gone and somebody resets it.
    LatchedStop,
}

impl Action {
    /// All of them, in order.
    pub const ALL: [Self; 5] = [
        Self::Run,
        Self::Limit,
        Self::Slow,
        Self::Stop,
        Self::LatchedStop,
    ];

    /// The more severe of two.
    //= failsafe.INV-1
    //= failsafe.INV-2
    //= failsafe.INV-3
    //= failsafe.INV-4
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        self.max(other)
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Run => "run",
            Self::Limit => "limit",
            Self::Slow => "slow",
            Self::Stop => "stop",
            Self::LatchedStop => "latched stop",
        })
    }
}

/// Why the robot is made to stand still. Distances in millimetres, speeds in mm/s, times in ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// Nothing has been observed yet.
    Starting,
    /// This sonar has not measured for too long.
    SonarStale {
        /// Index of the sonar.
        sonar: usize,
    },
    /// This sonar reported something that is not a range.
    SonarInvalid {
        /// Index of the sonar.
        sonar: usize,
    },
    /// This sonar sees something inside its blanking distance.
    TooNear {
        /// Index of the sonar.
        sonar: usize,
    },
    /// A forward sonar reads the minimum distance or less (S1 A1).
    MinDistance {
        /// Index of the sonar.
        sonar: usize,
        /// What it reads.
        range: i32,
        /// The minimum distance.
        minimum: i32,
    },
    /// Contact is possible within the stop time (S1 E4).
    ContactTime {
        /// Distance left before contact.
        distance: i32,
        /// Speed at which it may close, mm/s.
        closing: i32,
    },
    /// The obstacle is as fast as the promise allows, or faster (ER-S1-06).
    ObstacleTooFast,
    /// There is not even room for the least speed.
    Clearance {
        /// Index of the sonar.
        sonar: usize,
        /// Where the sonar looks, degrees to the left of straight ahead.
        bearing: i32,
        /// Clearance of the hull when it was seen.
        clearance: i32,
        /// Clearance needed, allowing for what happened since.
        required: i32,
        /// What the thing is taken for.
        class: Class,
    },
    /// There is no odometry, or it is too old.
    OdometryStale,
    /// The odometry is not a pose.
    OdometryInvalid,
    /// The clock went back.
    ClockWentBack,
    /// The law advised something that is not a number, or beyond 10 m/s or 20 rad/s.
    AdviceInvalid,
    /// The motors have no power.
    MotorsDisabled,
    /// A wheel is stalled or a bumper pressed.
    Stalled,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The link to the base is lost.
    LinkLost,
    /// The operator asked for it.
    Operator,
    /// The robot was moving and this tick came later than the reaction time allows.
    LoopLate {
        /// Time since the tick before.
        elapsed: i32,
        /// The reaction time.
        bound: i32,
    },
    /// The robot is faster than braking as promised, or its commands, can explain.
    BrakesWeak {
        /// Measured speed.
        measured: i32,
        /// The greatest it could have if the base kept the promise.
        bound: i32,
    },
    /// Something came nearer faster than the promise allows for, while the robot moved.
    ClassExceeded {
        /// Index of the sonar.
        sonar: usize,
        /// The greatest speed that the promise allows for.
        bound: i32,
    },
    /// The sonar reads the same although the robot drives towards what it reads.
    SensorStuck {
        /// Index of the sonar.
        sonar: usize,
        /// What it reads.
        range: i32,
    },
}

/// A cause, as the table of fail-safe actions has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The kind of cause, in a few words.
    pub cause: &'static str,
    /// What is done at once.
    pub action: Action,
    /// It becomes a latched stop once it has lasted for `latch_time`.
    pub latches_in_time: bool,
    /// The robot may turn on the spot, and back off, meanwhile.
    pub may_turn: bool,
    /// What ends it.
    pub clears: &'static str,
    /// Who has to know.
    pub told: &'static str,
}

impl StopReason {
    /// One of each kind.
    pub const EACH: [Self; 21] = [
        Self::EmergencyStop,
        Self::Stalled,
        Self::Operator,
        Self::BrakesWeak {
            measured: 0,
            bound: 0,
        },
        Self::ClassExceeded { sonar: 0, bound: 0 },
        Self::SensorStuck { sonar: 0, range: 0 },
        Self::LinkLost,
        Self::OdometryStale,
        Self::SonarStale { sonar: 0 },
        Self::LoopLate {
            elapsed: 0,
            bound: 0,
        },
        Self::OdometryInvalid,
        Self::ClockWentBack,
        Self::MotorsDisabled,
        Self::SonarInvalid { sonar: 0 },
        Self::TooNear { sonar: 0 },
        Self::AdviceInvalid,
        Self::MinDistance {
            sonar: 0,
            range: 0,
            minimum: 0,
        },
        Self::ObstacleTooFast,
        Self::ContactTime {
            distance: 0,
            closing: 0,
        },
        Self::Clearance {
            sonar: 0,
            bearing: 0,
            clearance: 0,
            required: 0,
            class: Class::Unknown,
        },
        Self::Starting,
    ];

    /// Its row in the table.
    #[must_use]
    pub const fn row(self) -> Row {
        const BROKEN: &str = "operator, log";
        const SEEN: &str = "law, log";
        let (cause, action, latches_in_time, may_turn, clears, told) = match self {
            Self::EmergencyStop => (
                "emergency stop",
                Action::LatchedStop,
                false,
                false,
                "released, and reset",
                BROKEN,
            ),
            Self::Stalled => (
                "stall or bumper",
                Action::LatchedStop,
                false,
                false,
                "no longer reported, and reset",
                BROKEN,
            ),
            Self::Operator => (
                "operator",
                Action::LatchedStop,
                false,
                false,
                "reset",
                BROKEN,
            ),
            Self::BrakesWeak { .. } => (
                "brakes weak",
                Action::LatchedStop,
                false,
                false,
                "reset",
                BROKEN,
            ),
            Self::ClassExceeded { .. } => (
                "class exceeded",
                Action::LatchedStop,
                false,
                false,
                "reset",
                BROKEN,
            ),
            Self::SensorStuck { .. } => (
                "sensor stuck",
                Action::LatchedStop,
                false,
                false,
                "reset",
                BROKEN,
            ),
            Self::LinkLost => (
                "link lost",
                Action::Stop,
                true,
                false,
                "the link is back",
                BROKEN,
            ),
            Self::OdometryStale => (
                "odometry stale",
                Action::Stop,
                true,
                false,
                "fresh odometry",
                BROKEN,
            ),
            Self::SonarStale { .. } => (
                "sonar stale",
                Action::Stop,
                true,
                false,
                "a fresh reading",
                BROKEN,
            ),
            Self::LoopLate { .. } => (
                "loop late",
                Action::Stop,
                true,
                false,
                "ticks in time",
                BROKEN,
            ),
            Self::OdometryInvalid => (
                "odometry invalid",
                Action::Stop,
                true,
                false,
                "a pose",
                BROKEN,
            ),
            Self::ClockWentBack => (
                "clock went back",
                Action::Stop,
                false,
                false,
                "ticks go forward again",
                BROKEN,
            ),
            Self::MotorsDisabled => (
                "motors disabled",
                Action::Stop,
                false,
                false,
                "enabled",
                BROKEN,
            ),
            Self::SonarInvalid { .. } => (
                "sonar invalid",
                Action::Stop,
                true,
                false,
                "a range",
                BROKEN,
            ),
            Self::TooNear { .. } => (
                "too near",
                Action::Stop,
                false,
                false,
                "a reading beyond the blanking distance",
                SEEN,
            ),
            Self::AdviceInvalid => (
                "advice invalid",
                Action::Stop,
                false,
                false,
                "sensible advice",
                BROKEN,
            ),
            Self::MinDistance { .. } => (
                "minimum distance",
                Action::Stop,
                false,
                true,
                "beyond it by resume_clearance",
                SEEN,
            ),
            Self::ObstacleTooFast => (
                "obstacle too fast",
                Action::Stop,
                false,
                true,
                "measured slower, or let go",
                SEEN,
            ),
            Self::ContactTime { .. } => (
                "contact time",
                Action::Stop,
                false,
                true,
                "not possible, with resume_clearance to spare",
                SEEN,
            ),
            Self::Clearance { .. } => (
                "clearance",
                Action::Stop,
                false,
                true,
                "room for the least speed",
                SEEN,
            ),
            Self::Starting => (
                "starting",
                Action::Stop,
                false,
                false,
                "the first clear ticks",
                SEEN,
            ),
        };
        Row {
            cause,
            action,
            latches_in_time,
            may_turn,
            clears,
            told,
        }
    }

    /// What is done about it at once.
    #[must_use]
    pub const fn action(self) -> Action {
        self.row().action
    }

    /// The robot may turn on the spot meanwhile, and back off over space that it sees: a round
    /// robot that turns sweeps nothing new. Only where the sensors are in order and what is wrong
    /// is the distance.
    #[must_use]
    pub const fn may_turn(self) -> bool {
        self.row().may_turn
    }

    /// The cause that counts of two: the one with the more severe action, the first if both have
    /// the same.
    //= failsafe.INV-6
    #[must_use]
    pub fn worse(first: Option<Self>, second: Option<Self>) -> Option<Self> {
        match (first, second) {
            (Some(a), Some(b)) if b.action() > a.action() => Some(b),
            (Some(a), _) => Some(a),
            (None, b) => b,
        }
    }
}

/// The causes that do not make the robot stand still, and [`StopReason::row`] of those that do.
pub fn table() -> impl Iterator<Item = Row> {
    let moving = [
        Row {
            cause: "obstacle out of sight",
            action: Action::Slow,
            latches_in_time: false,
            may_turn: true,
            clears: "seen again, or let go",
            told: "log",
        },
        Row {
            cause: "little room",
            action: Action::Limit,
            latches_in_time: false,
            may_turn: true,
            clears: "room for the speed advised",
            told: "log",
        },
    ];
    StopReason::EACH
        .into_iter()
        .map(StopReason::row)
        .chain(moving)
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Starting => write!(f, "nothing observed yet"),
            Self::SonarStale { sonar } => write!(f, "sonar {sonar} is stale"),
            Self::SonarInvalid { sonar } => write!(f, "sonar {sonar} reads no valid range"),
            Self::TooNear { sonar } => write!(f, "sonar {sonar}: something touches it"),
            Self::MinDistance {
                sonar,
                range,
                minimum,
            } => write!(f, "sonar {sonar}: {range} mm, minimum {minimum} mm"),
            Self::ContactTime { distance, closing } => {
                write!(f, "contact possible: {distance} mm at {closing} mm/s")
            }
            Self::ObstacleTooFast => write!(f, "obstacle faster than promised"),
            Self::Clearance {
                sonar,
                bearing,
                clearance,
                required,
                class,
            } => write!(
                f,
                "sonar {sonar} at {bearing}°: {clearance} mm clear, {required} mm needed ({class})"
            ),
            Self::OdometryStale => write!(f, "odometry is stale"),
            Self::OdometryInvalid => write!(f, "odometry is not a pose"),
            Self::ClockWentBack => write!(f, "clock went back"),
            Self::AdviceInvalid => write!(
                f,
                "the law's advice is no number, or beyond 10 m/s or 20 rad/s"
            ),
            Self::MotorsDisabled => write!(f, "motors are disabled"),
            Self::Stalled => write!(f, "stall or bumper"),
            Self::EmergencyStop => write!(f, "emergency stop"),
            Self::LinkLost => write!(f, "link lost"),
            Self::Operator => write!(f, "operator"),
            Self::LoopLate { elapsed, bound } => {
                write!(f, "{elapsed} ms between ticks, allowed {bound} ms")
            }
            Self::BrakesWeak { measured, bound } => write!(
                f,
                "brakes weaker than promised: {measured} mm/s, at most {bound} mm/s expected"
            ),
            Self::ClassExceeded { sonar, bound } => write!(
                f,
                "sonar {sonar}: something faster than the promised {bound} mm/s"
            ),
            Self::SensorStuck { sonar, range } => {
                write!(f, "sonar {sonar} is stuck at {range} mm")
            }
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Still => "still",
            Self::Unknown => "person or unknown",
        })
    }
}
