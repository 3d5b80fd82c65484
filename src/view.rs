//! The world as it is believed to be: the observation, judged, with memory.
//!
//! Losing sight of something is no proof that it left (ER-X1). Two memories hold on to it: for
//! the shield, each sonar's last echo, moved towards the robot as fast as robot and obstacle may
//! close; for the law, the place of the one obstacle it avoids. Both let go only when the place
//! is seen to be free often enough, or when the hold time is over.

use crate::config::Config;
use crate::math;
use crate::observation::{BaseStatus, Observation, OdometrySample, SonarReading, classify};
use crate::quantity::{Angle, Instant, Length, in_range};
use crate::ring::Ring;
use crate::shield::{StopReason, millimetres_down, millimetres_up, milliseconds};
use crate::track::{self, Obstacle, Track};
use nalgebra::Vector2;

/// Where the robot is and which way it looks, in the odometry frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the centre of rotation in metres.
    pub position: Vector2<f32>,
    /// Heading.
    pub heading: Angle,
}

impl Pose {
    /// A point of the robot's frame in the odometry frame.
    #[must_use]
    pub fn to_world(&self, point: Vector2<f32>) -> Vector2<f32> {
        let (sin, cos) = (math::sin(self.heading.get()), math::cos(self.heading.get()));
        self.position + Vector2::new(cos * point.x - sin * point.y, sin * point.x + cos * point.y)
    }

    /// A point of the odometry frame in the robot's frame.
    #[must_use]
    pub fn to_robot(&self, point: Vector2<f32>) -> Vector2<f32> {
        let (sin, cos) = (math::sin(self.heading.get()), math::cos(self.heading.get()));
        let offset = point - self.position;
        Vector2::new(
            cos * offset.x + sin * offset.y,
            cos * offset.y - sin * offset.x,
        )
    }
}

/// The way to the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalView {
    /// Direction of the goal in the odometry frame.
    pub heading: Angle,
    /// Distance to the goal in metres.
    pub distance: f32,
}

/// The validated world of one tick, for a robot with `N` sonars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<const N: usize> {
    /// Time of the tick.
    pub now: Instant,
    /// The robot's pose.
    pub pose: Pose,
    /// Measured forward speed in m/s, −10 to 10.
    pub speed: f32,
    /// How long ago that was measured, ms.
    pub odometry_age: u64,
    /// The way to the goal.
    pub goal: GoalView,
    /// The judged reading of each sonar.
    pub sonar: [SonarReading; N],
    /// Least range that each sonar is believed to have in front of it, in millimetres.
    pub range: [i32; N],
    /// Least clearance of the hull from whatever each sonar saw, in millimetres, allowing for the
    /// time since it was seen. May be negative.
    pub clearance: [i32; N],
    /// The obstacle the law avoids, if there is one in sight or in memory.
    pub obstacle: Option<Obstacle>,
    /// Free range to the left and to the right of straight ahead.
    pub room: [Length; 2],
    /// The base's own status.
    pub base: BaseStatus,
    /// Why the shield will not let the robot move, if so.
    pub guard: Option<StopReason>,
}

/// The last echo of one sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    range: i32,
    seen: Instant,
    /// Echoes in a row from farther away.
    farther: u32,
    /// When the last of them was measured: one that is looked at twice counts once.
    counted: Instant,
}

impl Held {
    const fn new(range: i32, seen: Instant) -> Self {
        Self {
            range,
            seen,
            farther: 0,
            counted: seen,
        }
    }
}

/// What one sonar is believed to have in front of it, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound {
    /// Least range, as it was when it was measured.
    pub range: i32,
    /// Least range by now, if robot and obstacle have closed as fast as they may since.
    pub reachable: i32,
}

/// The memory of one sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EchoMemory {
    held: Option<Held>,
}

/// What is remembered from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory<const N: usize> {
    sonar: [EchoMemory; N],
    track: Option<Track>,
    /// Time of the tick before.
    last: Option<Instant>,
}

impl<const N: usize> Default for Memory<N> {
    fn default() -> Self {
        Self {
            sonar: [EchoMemory::default(); N],
            track: None,
            last: None,
        }
    }
}

impl<const N: usize> Memory<N> {
    /// Judges an observation and remembers what must be remembered.
    ///
    /// # Errors
    /// The reason to stop if there is no usable odometry: without a pose there is no view. What
    /// the sonars saw is remembered all the same.
    pub fn update(
        &mut self,
        observation: &Observation<N>,
        goal: Vector2<f32>,
        ring: &Ring<N>,
        config: &Config,
    ) -> Result<View<N>, StopReason> {
        let now = observation.now;
        let mut sonar = [SonarReading::Stale; N];
        let mut range = [0; N];
        let mut clearance = [0; N];
        // What was there in the tick before has been looked at.
        let mut fresh = [false; N];
        for i in 0..N {
            let sample = observation.sonar[i];
            sonar[i] = classify(
                sample,
                now,
                length(config.sonar_range_min),
                length(config.sonar_range_max),
                milliseconds(config.sonar_age_max),
            );
            let taken_at = sample.map_or(now, |sample| sample.taken_at);
            fresh[i] = self.last.is_none_or(|last| taken_at > last);
            let bound = self.sonar[i].update(measured(sonar[i]), taken_at, now, config);
            range[i] = bound.range;
            clearance[i] = bound.reachable - ring.sonars()[i].contact_range;
        }

        self.last = Some(now);

        let (pose, speed, odometry_age) = judge_odometry(observation.odometry, now, config)?;
        let to_goal = goal - pose.position;
        let goal = GoalView {
            heading: Angle::radians(math::atan2(to_goal.y, to_goal.x)).unwrap_or(Angle::ZERO),
            distance: math::norm(to_goal),
        };
        track::follow(&mut self.track, &sonar, &fresh, &pose, now, ring, config);
        let obstacle = self.track.map(|track| {
            track.obstacle(
                now,
                &pose,
                speed,
                observation.sighting.as_ref(),
                ring,
                config,
            )
        });
        Ok(View {
            now,
            pose,
            speed,
            odometry_age,
            goal,
            sonar,
            range,
            clearance,
            obstacle,
            room: room(&sonar, ring, config),
            base: observation.base,
            guard: None,
        })
    }
}

/// A length that a checked configuration is known to hold.
fn length(metres: f32) -> Length {
    Length::metres(metres).unwrap_or(Length::ZERO)
}

/// Echoes of one thing scatter by less than this, in millimetres.
const SCATTER: i32 = 100;

impl EchoMemory {
    /// Takes in a measured range (mm; none if no echo came back) and holds on to it until it is
    /// seen to be gone (view.INV-2, view.INV-3).
    pub fn update(
        &mut self,
        measured: Option<i32>,
        taken_at: Instant,
        now: Instant,
        config: &Config,
    ) -> Bound {
        let hold_time = milliseconds(config.hold_time);
        // The way that robot and obstacle can close, or part, in a time. Ages are at most the hold
        // time or the greatest age of a reading, 10 s; anything else counts as that.
        let closing = millimetres_up(config.obstacle_speed_max + config.speed_max);
        let way = |from: Instant, to: Instant| {
            let age = to.since(from).unwrap_or(10_000).min(10_000) as i32;
            (closing * age + 999) / 1000
        };
        // A reading from before the echo that is held says nothing of what came after it.
        let since = |old: &Held| {
            if taken_at < old.seen {
                0
            } else {
                way(old.seen, taken_at)
            }
        };
        self.held = match (self.held, measured) {
            // An echo from farther away than the same thing can have gone is another thing's: it
            // counts only when it keeps coming. Any other echo counts at once.
            (Some(old), Some(range)) if range > old.range + since(&old) + SCATTER => {
                let farther = old.farther + u32::from(taken_at > old.counted);
                let gone = farther >= config.confirm_samples as u32;
                let expired = now.since(old.seen).is_none_or(|age| age > hold_time);
                Some(if gone || expired {
                    Held::new(range, taken_at)
                } else {
                    Held {
                        farther,
                        counted: taken_at,
                        ..old
                    }
                })
            }
            (_, Some(range)) => Some(Held::new(range, taken_at)),
            // No echo is no proof: only time lets go.
            (Some(old), None) if now.since(old.seen).is_some_and(|age| age <= hold_time) => {
                Some(Held { farther: 0, ..old })
            }
            (_, None) => None,
        };
        let no_echo = millimetres_down(config.sonar_range_max);
        match self.held {
            None => Bound {
                range: no_echo,
                reachable: no_echo - way(taken_at, now),
            },
            Some(held) => Bound {
                range: held.range,
                reachable: held.range - way(held.seen, now),
            },
        }
    }
}

/// The range of a judged reading in millimetres, rounded down; none if no echo came back.
fn measured(reading: SonarReading) -> Option<i32> {
    match reading {
        SonarReading::Echo(range) => Some(millimetres_down(range.get())),
        SonarReading::TooNear => Some(0),
        SonarReading::NoEcho(_) | SonarReading::Stale | SonarReading::Invalid => None,
    }
}

/// Checks the odometry: pose, forward speed, and age in ms.
fn judge_odometry(
    sample: Option<OdometrySample>,
    now: Instant,
    config: &Config,
) -> Result<(Pose, f32, u64), StopReason> {
    let sample = sample.ok_or(StopReason::OdometryStale)?;
    let age = now
        .since(sample.taken_at)
        .ok_or(StopReason::OdometryInvalid)?;
    if age > milliseconds(config.odometry_age_max) {
        return Err(StopReason::OdometryStale);
    }
    let checked = || {
        let pose = Pose {
            position: Vector2::new(
                in_range("x", sample.x, -1e4, 1e4, "m")?,
                in_range("y", sample.y, -1e4, 1e4, "m")?,
            ),
            heading: Angle::radians(sample.heading)?,
        };
        in_range("turn rate", sample.turn_rate, -20.0, 20.0, "rad/s")?;
        let speed = in_range("speed", sample.speed, -10.0, 10.0, "m/s")?;
        Ok((pose, speed, age))
    };
    checked().map_err(|_: crate::quantity::OutOfRange| StopReason::OdometryInvalid)
}

/// Least range that the sonars to the left and to the right of straight ahead measure.
fn room<const N: usize>(sonar: &[SonarReading; N], ring: &Ring<N>, config: &Config) -> [Length; 2] {
    let mut room = [length(config.sonar_range_max); 2];
    for (reading, at) in sonar.iter().zip(ring.sonars()) {
        let range = match *reading {
            SonarReading::Echo(range) | SonarReading::NoEcho(range) => range,
            SonarReading::TooNear | SonarReading::Stale | SonarReading::Invalid => Length::ZERO,
        };
        let axis = at.axis;
        // Behind the robot there is nothing to choose.
        if axis.x >= -0.1 && axis.y > 0.0 {
            room[0] = room[0].min(range);
        } else if axis.x >= -0.1 && axis.y < 0.0 {
            room[1] = room[1].min(range);
        }
    }
    room
}
