//! Following the one obstacle that the law avoids, over time and out of sight.

use crate::avoid::{ObstacleSpeed, Trend, obstacle_speed};
use crate::config::Config;
use crate::math;
use crate::observation::{Sighting, SonarReading};
use crate::quantity::{Angle, Instant, Length, Speed};
use crate::ring::{Ring, Sonar};
use crate::shield::milliseconds;
use crate::view::Pose;
use core::f32::consts::FRAC_PI_2;
use nalgebra::Vector2;

/// The obstacle the law avoids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Distance d_o from the sonar's face.
    pub distance: Length,
    /// Distance d_o at which it would touch the robot, in millimetres.
    pub contact_range: i32,
    /// Its direction in the odometry frame, seen from the robot.
    pub direction: Angle,
    /// Its place in the odometry frame.
    pub position: Vector2<f32>,
    /// How its distance changes.
    pub trend: Trend,
    /// Estimate of its speed: from a camera by S1 E3 if one saw it, else how fast it comes nearer.
    pub speed: ObstacleSpeed,
    /// A sonar saw it in this tick.
    pub seen_now: bool,
    /// It was seen within the greatest age of a sonar reading, not only remembered.
    pub visible: bool,
}

/// How many distances of the tracked obstacle are kept.
const HISTORY: usize = 8;
/// They are at least this far apart, in ms, but for the latest two.
const HISTORY_GAP: u64 = 70;
/// A trend is taken over at least this time, in ms: over less, noise outweighs motion.
const TREND_TIME: u64 = 400;
/// So the kept ones reach back far enough, however often a sonar is heard.
const _: () = assert!((HISTORY as u64 - 2) * HISTORY_GAP >= TREND_TIME);
/// Slower changes of distance than this count as none, in m/s. One per cent of range noise at
/// 1.2 m over the trend time is 0.04 m/s.
const TREND_RATE: f32 = 0.1;
/// Echoes within this distance of a tracked place, in metres, belong to it.
const GATE: f32 = 0.4;

/// The obstacle that is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Track {
    position: Vector2<f32>,
    distance: Length,
    sonar: usize,
    /// Of that sonar, as in [`Echo`].
    contact_range: i32,
    inset: f32,
    seen: Instant,
    /// Ticks in which a sonar saw past its place since it was seen there.
    absent: u32,
    /// Latest distances seen, newest first.
    history: [Option<(Instant, f32)>; HISTORY],
}

/// What an obstacle is judged by.
pub(crate) struct Look<'a> {
    pub(crate) now: Instant,
    pub(crate) pose: &'a Pose,
    /// The robot's own speed, m/s.
    pub(crate) speed: f32,
    pub(crate) sighting: Option<&'a Sighting>,
    /// The sonar that saw it last has something still in front of it.
    pub(crate) still: bool,
}

/// One echo, placed.
#[derive(Clone, Copy)]
struct Echo {
    /// Which sonar heard it.
    sonar: usize,
    /// Its contact range, mm.
    contact_range: i32,
    /// How far it is from the robot's centre, m.
    inset: f32,
    distance: Length,
    position: Vector2<f32>,
}

impl Track {
    fn new(echo: Echo, now: Instant) -> Self {
        let mut history = [None; HISTORY];
        history[0] = Some((now, echo.distance.get()));
        Self {
            position: echo.position,
            distance: echo.distance,
            sonar: echo.sonar,
            contact_range: echo.contact_range,
            inset: echo.inset,
            seen: now,
            absent: 0,
            history,
        }
    }

    fn seen_at(&self, echo: Echo, now: Instant) -> Self {
        let mut track = Self::new(echo, now);
        // Looks that follow each other closely replace each other, so that the history reaches
        // back far enough for a trend however often the robot looks.
        let close = match (self.history[0], self.history[1]) {
            (Some((newest, _)), Some((before, _))) => {
                newest.since(before).is_none_or(|gap| gap < HISTORY_GAP)
            }
            _ => false,
        };
        for i in 1..HISTORY {
            let from = i - 1 + usize::from(close);
            track.history[i] = self.history.get(from).copied().flatten();
        }
        track
    }

    /// The same obstacle, not seen this time: its distance follows from where it was.
    fn unseen(&self, seen_past: bool, pose: &Pose) -> Self {
        let offset = math::norm(self.position - pose.position);
        Self {
            absent: self.absent.saturating_add(u32::from(seen_past)),
            distance: Length::metres((offset - self.inset).max(0.0)).unwrap_or(self.distance),
            ..*self
        }
    }

    /// Change of the distance in m/s, negative when closing, once there is enough history.
    fn rate(&self) -> Option<f32> {
        let (newest, distance) = self.history[0]?;
        for entry in self.history.iter().skip(1) {
            let (time, before) = (*entry)?;
            let elapsed = newest.since(time)?;
            if elapsed >= TREND_TIME {
                return Some((distance - before) / (elapsed as f32 / 1000.0));
            }
        }
        None
    }

    /// The sonar that saw it last.
    pub(crate) const fn sonar(&self) -> usize {
        self.sonar
    }

    /// What the law is told of the obstacle.
    pub(crate) fn obstacle(&self, look: &Look<'_>, config: &Config) -> Obstacle {
        let Look { now, pose, .. } = *look;
        let offset = self.position - pose.position;
        let direction = Angle::radians(math::atan2(offset.y, offset.x)).unwrap_or(Angle::ZERO);
        let bearing = direction.minus(pose.heading);
        let rate = self.rate();
        // A ring whose sonars fire in turn takes some time to look everywhere.
        let visible = now
            .since(self.seen)
            .is_some_and(|age| age <= milliseconds(config.sonar_age_max));
        let trend = match rate {
            _ if visible && look.still => Trend::Steady,
            Some(rate) if visible && rate > TREND_RATE => Trend::Receding,
            Some(rate) if visible && rate < -TREND_RATE => Trend::Closing,
            Some(_) if visible => Trend::Steady,
            _ => Trend::Unknown,
        };
        let speed_max = Speed::metres_per_second(config.obstacle_speed_max).unwrap_or(Speed::MAX);
        let own = look.speed * math::cos(bearing.get());
        let estimate = match seen_by_camera(look, speed_max, config) {
            Some(estimate) => estimate,
            // What has agreed with the robot's own motion for so long does not move.
            None if visible && look.still => ObstacleSpeed {
                value: Speed::ZERO,
                saturated: false,
            },
            None => closing_speed(rate, own, speed_max),
        };
        Obstacle {
            distance: self.distance,
            contact_range: self.contact_range,
            direction,
            position: self.position,
            trend,
            speed: estimate,
            seen_now: self.seen == now,
            visible,
        }
    }
}

/// S1 E3 from a camera, if it saw something within the hold time.
fn seen_by_camera(look: &Look<'_>, speed_max: Speed, config: &Config) -> Option<ObstacleSpeed> {
    let sighting = look.sighting?;
    let fresh = look
        .now
        .since(sighting.taken_at)
        .is_some_and(|age| age <= milliseconds(config.hold_time));
    let robot_speed = Speed::metres_per_second(look.speed.abs()).ok()?;
    // A camera that looks ahead sees across the direction of travel: θ_R is 90° to it.
    let heading = Angle::radians(FRAC_PI_2).ok()?;
    fresh.then(|| obstacle_speed(sighting, robot_speed, heading, speed_max))
}

/// The sonars' counterpart of S1 E3: how fast the obstacle itself comes nearer, from the change
/// of its distance (m/s, negative when closing) and the robot's own share `own` of the closing.
/// Not known yet is v_o,max; v_o,max or faster is v_o,max, saturated.
fn closing_speed(rate: Option<f32>, own: f32, speed_max: Speed) -> ObstacleSpeed {
    let Some(rate) = rate else {
        return ObstacleSpeed {
            value: speed_max,
            saturated: false,
        };
    };
    match Speed::metres_per_second((-rate - own).max(0.0)) {
        Ok(value) if value < speed_max => ObstacleSpeed {
            value,
            saturated: false,
        },
        _ => ObstacleSpeed {
            value: speed_max,
            saturated: true,
        },
    }
}

/// Follows the obstacle that the law avoids through one tick: the nearest echo in the angle of
/// view or in the corridor ahead, kept in sight by any sonar, held in memory when it is not.
pub(crate) fn follow<const N: usize>(
    track: &mut Option<Track>,
    sonar: &[SonarReading; N],
    fresh: &[bool; N],
    pose: &Pose,
    now: Instant,
    ring: &Ring<N>,
    config: &Config,
) {
    let mut nearest: Option<Echo> = None;
    let mut matched: Option<(Echo, f32)> = None;
    let mut seen_past = false;
    for (i, ((reading, at), fresh)) in sonar.iter().zip(ring.sonars()).zip(fresh).enumerate() {
        let SonarReading::Echo(distance) = *reading else {
            continue;
        };
        if !fresh {
            continue;
        }
        let point = at.position + at.axis * distance.get();
        let echo = Echo {
            sonar: i,
            contact_range: at.contact_range,
            inset: math::norm(at.position),
            distance,
            position: pose.to_world(point),
        };
        if ahead(point, config) && nearest.is_none_or(|other| distance < other.distance) {
            nearest = Some(echo);
        }
        if let Some(track) = track {
            let offset = math::norm(echo.position - track.position);
            if offset <= GATE && matched.is_none_or(|(_, least)| offset < least) {
                matched = Some((echo, offset));
            }
            seen_past |= sees_past(track, at, distance, pose, config);
        }
    }

    let new = nearest.map(|echo| Track::new(echo, now));
    *track = match (*track, matched) {
        (None, _) => new,
        (Some(old), Some((echo, _))) => match nearest {
            // Something else is clearly nearer.
            Some(other) if other.distance.get() + GATE < echo.distance.get() => new,
            _ => Some(old.seen_at(echo, now)),
        },
        (Some(old), None) => {
            let old = old.unseen(seen_past, pose);
            let gone = old.absent >= config.confirm_samples as u32;
            let expired = now
                .since(old.seen)
                .is_none_or(|age| age > milliseconds(config.hold_time));
            let overtaken = nearest.is_some_and(|echo| echo.distance < old.distance);
            if gone || expired || overtaken {
                new
            } else {
                Some(old)
            }
        }
    };
}

/// A point of the robot's frame lies in the angle of view or in the corridor that the robot is
/// about to sweep.
fn ahead(point: Vector2<f32>, config: &Config) -> bool {
    let (sin, cos) = (
        math::sin(config.view_half_angle),
        math::cos(config.view_half_angle),
    );
    let side = point.y.abs();
    point.x > 0.0
        && (side * cos <= point.x * sin || side <= config.robot_radius + config.corridor_margin)
}

/// A sonar whose cone covers the place of the track measured something clearly behind it.
fn sees_past(track: &Track, sonar: &Sonar, distance: Length, pose: &Pose, config: &Config) -> bool {
    let offset = pose.to_robot(track.position) - sonar.position;
    let range = math::norm(offset);
    let covered = offset.dot(&sonar.axis) >= range * math::cos(config.sonar_half_angle);
    covered && distance.get() > range + GATE
}
