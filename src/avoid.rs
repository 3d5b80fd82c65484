//! S1: the avoidance law of Budiharto, Santoso, Purwanto and Jazidie.
//!
//! The equations E1 to E7 in the reading of `spec/avoid.md`, the mode machine M1, and [`Avoid`],
//! which puts them together as a [`Law`]. Everything here is total and its outputs are bounded by
//! type or by proof (`proofs/avoid.rs`); nothing here is relied on for safety, which is the
//! [`crate::shield`]'s.

use crate::config::Config;
use crate::law::{Advice, Law};
use crate::math;
use crate::observation::Sighting;
use crate::quantity::{Angle, Instant, Length, OutOfRange, Speed, in_range, within};
use crate::track::Obstacle;
use crate::view::View;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_3, PI};

/// S1 E1: the angle between the line to the obstacle and the robot's direction of travel, wrapped.
/// `bearing` is the measured bearing β; the paper uses half the camera's angle of view for it.
///
/// $$\theta_{OR} = \pi - (\theta_R + \beta)$$
#[must_use]
pub fn obstacle_robot_angle(heading: Angle, bearing: Angle) -> Angle {
    Angle::HALF_TURN.minus(heading.plus(bearing))
}

/// An obstacle's speed as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleSpeed {
    /// The speed as estimated, at most v_o,max.
    pub value: Speed,
    /// The measurement reached v_o,max or could not be made: the true speed may be greater than
    /// `value`.
    pub saturated: bool,
}

/// S1 E2, as an upper bound for an obstacle on either side:
/// |v_o cos θ_o| ≤ |p₂ − p₁|·s/t + v_R·|cos θ_R|, in m/s.
///
/// # Errors
/// [`OutOfRange`] if the displacement is not in 0 to 10⁵ px, the scale not in 0 to 1 m/px or the
/// interval not in 1 ms to 60 s.
pub fn lateral_speed(sighting: &Sighting, speed: Speed, heading: Angle) -> Result<f32, OutOfRange> {
    let displacement = in_range("displacement", sighting.displacement, 0.0, 1e5, "px")?;
    let scale = in_range("scale", sighting.scale, 0.0, 1.0, "m/px")?;
    let interval = in_range("interval", sighting.interval, 0.001, 60.0, "s")?;
    Ok(lateral_bound(
        displacement * scale / interval,
        speed.get() * math::cos(heading.get()),
    ))
}

/// S1 E2's two terms, the speed seen and the robot's own (signed) share, put together so that the
/// result is a bound whichever side the obstacle comes from (triangle inequality, ER-S1-07).
//= avoid.INV-2
#[must_use]
pub fn lateral_bound(seen: f32, own: f32) -> f32 {
    seen + own.abs()
}

/// S1 E3: speed of a moving obstacle from a camera, clamped to `speed_max` = v_o,max.
///
/// $$v_o = \min\left(v_{o,max}, \frac{v_{E2}}{\cos \theta_o}\right)$$
///
/// with E2's speed v_E2, for θ_o in [0, 60°]; v_o,max, saturated, for every other θ_o and for every
/// sighting that is not usable. Total: any bit pattern gives a speed in [0, v_o,max].
//= avoid.INV-1
//= avoid.INV-3
#[must_use]
pub fn obstacle_speed(
    sighting: &Sighting,
    speed: Speed,
    heading: Angle,
    speed_max: Speed,
) -> ObstacleSpeed {
    let unknown = ObstacleSpeed {
        value: speed_max,
        saturated: true,
    };
    let Ok(lateral) = lateral_speed(sighting, speed, heading) else {
        return unknown;
    };
    let Ok(direction) = in_range("direction", sighting.direction, 0.0, FRAC_PI_3, "rad") else {
        return unknown;
    };
    match Speed::metres_per_second(lateral / math::cos(direction)) {
        Ok(value) if value < speed_max => ObstacleSpeed {
            value,
            saturated: false,
        },
        _ => unknown,
    }
}

/// S1 A3: the image-plane angle θ_o in (0, 2π] folded to [0, π/2] for E3 and E4, and whether the
/// obstacle approaches (moves down the image). `global_orientation` is the motion template's
/// angle in radians, 0 to 2π.
///
/// # Errors
/// [`OutOfRange`] if the angle is not in [0, 2π].
//= avoid.INV-14
pub fn image_direction(global_orientation: f32) -> Result<(f32, bool), OutOfRange> {
    let orientation = in_range(
        "global orientation",
        global_orientation,
        0.0,
        core::f32::consts::TAU,
        "rad",
    )?;
    // θ_o = 360° − orientation points down the image exactly where the orientation is in (0, π).
    let approaching = orientation > 0.0 && orientation < PI;
    let half = if orientation > PI {
        orientation - PI
    } else {
        orientation
    };
    let folded = if half > FRAC_PI_2 { PI - half } else { half };
    Ok((folded.clamp(0.0, FRAC_PI_2), approaching))
}

/// S1 E4, for reporting: seconds until robot and obstacle are level along the axis of travel, where m
/// is the least |sin(θ_R + β)| over the bearings |β| ≤ `half_angle`. `None` if they never are.
///
/// $$t = \frac{d_o m}{v_R |\sin \theta_R| + v_o |\sin \theta_o|}$$
///
/// This is not what decides: see [`contact_time_bound`].
#[must_use]
pub fn time_to_collision(
    distance: Length,
    heading: Angle,
    half_angle: Angle,
    speed: Speed,
    obstacle_speed: Speed,
    direction: Angle,
) -> Option<f32> {
    let (heading, half_angle) = (heading.get(), half_angle.get().abs());
    // |sin| is zero at 0 and ±π and concave between them: over an interval without a zero it is
    // least at an end.
    let level = heading.abs() <= half_angle || PI - heading.abs() <= half_angle;
    let least = if level {
        0.0
    } else {
        let left = math::sin(heading + half_angle).abs();
        let right = math::sin(heading - half_angle).abs();
        left.min(right)
    };
    quotient(
        distance.get() * least,
        speed.get() * math::sin(heading).abs()
            + obstacle_speed.get() * math::sin(direction.get()).abs(),
    )
}

/// The sound bound on S1 E4, in seconds: no contact can happen before it, whatever the directions,
/// while the robot is no faster than `speed` and the obstacle no faster than `obstacle_speed`. `None`
/// is "never".
///
/// $$t_{lb} = \frac{\max(0, d_o - R_c)}{v_R + v_o}$$
#[must_use]
pub fn contact_time_bound(
    distance: Length,
    contact: Length,
    speed: Speed,
    obstacle_speed: Speed,
) -> Option<f32> {
    quotient(
        (distance.get() - contact.get()).max(0.0),
        speed.get() + obstacle_speed.get(),
    )
}

/// Quotient of two numbers ≥ 0 that are not NaN: `None` if the divisor is zero, or so small that
/// the quotient is not finite.
//= avoid.INV-4
fn quotient(dividend: f32, divisor: f32) -> Option<f32> {
    if divisor > 0.0 {
        let quotient = dividend / divisor;
        quotient.is_finite().then_some(quotient)
    } else {
        None
    }
}

/// The size of the maneuver's turn, |Δθ_m| in quarter turns, in [0, 2]. In this unit S1 E5 is
/// k_θ/d_o and E7 is rational: neither needs π.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct QuarterTurns(f32);

impl QuarterTurns {
    /// S1 E5, at most half a turn; half a turn at distance 0:
    ///
    /// $$\Delta\theta = \frac{\pi}{2} \frac{k_\theta}{d_o}$$
    //= avoid.INV-6
    #[must_use]
    pub fn at_distance(distance: Length, turn_distance: Length) -> Self {
        if distance.get() * 2.0 <= turn_distance.get() {
            return Self(2.0);
        }
        // Here d > k/2 ≥ 0: no division by zero, and the quotient is at most 2 up to rounding.
        Self((turn_distance.get() / distance.get()).min(2.0))
    }

    /// The turn |Δθ| of a signed angle in radians, at most half a turn.
    ///
    /// # Errors
    /// [`OutOfRange`] if the angle is not finite or exceeds 1000 rad.
    pub fn of_angle(angle: f32) -> Result<Self, OutOfRange> {
        let angle = in_range("turn", angle, -1e3, 1e3, "rad")?;
        Ok(Self((angle.abs() / FRAC_PI_2).min(2.0)))
    }

    /// The bare number, in [0, 2].
    #[must_use]
    pub const fn get(self) -> f32 {
        self.0
    }

    /// The turn as an angle in [0, π].
    #[must_use]
    pub fn angle(self) -> Angle {
        Angle::radians(self.0 * FRAC_PI_2).unwrap_or(Angle::ZERO)
    }
}

/// The side to which the maneuver turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Counter-clockwise, σ = +1.
    Left,
    /// Clockwise, σ = −1.
    Right,
}

impl Side {
    /// The other side.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The side away from an obstacle at `bearing` from the reference heading. Straight ahead
    /// (or unknown) it is the side with more measured clearance, and left on a tie.
    //= avoid.INV-7
    #[must_use]
    pub fn away_from(bearing: Angle, clearance_left: Length, clearance_right: Length) -> Self {
        if bearing.get() > 0.0 {
            Self::Right
        } else if bearing.get() < 0.0 || clearance_left >= clearance_right {
            Self::Left
        } else {
            Self::Right
        }
    }
}

/// S1 E5: heading of the maneuver, wrapped. The reference is the goal heading latched when the maneuver
/// began, not the current heading (ER-S1-03). σ is 1 to the left and −1 to the right.
///
/// $$\theta_m = \theta_{ref} + \sigma \Delta\theta$$
//= avoid.INV-8
#[must_use]
pub fn maneuver_heading(reference: Angle, side: Side, turn: QuarterTurns) -> Angle {
    match side {
        Side::Left => reference.plus(turn.angle()),
        Side::Right => reference.minus(turn.angle()),
    }
}

/// S1 E7: speed of the maneuver, in [v_max/2, v_max].
///
/// $$v_R = v_{max} \left(1 - \left|\frac{1}{2} - \frac{|\Delta\theta|}{\pi}\right|\right)$$
//= avoid.INV-9
#[must_use]
pub fn maneuver_speed(speed_max: Speed, turn: QuarterTurns) -> Speed {
    let half = turn.get() / 2.0;
    speed_max.scaled(if half <= 0.5 { 0.5 + half } else { 1.5 - half })
}

/// What an errand with a customer has come to (S1 A1, ER-S1-13).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Under way.
    Continue,
    /// At the goal, customer confirmed, within reach.
    Arrived,
    /// Something is within reach that is not the customer at the goal.
    Stop,
}

/// S1 A1: being near something is not having arrived.
//= avoid.INV-12
#[must_use]
pub fn arrival(
    front: Length,
    min_distance: Length,
    goal_reached: bool,
    customer_confirmed: bool,
) -> Arrival {
    if front > min_distance {
        Arrival::Continue
    } else if goal_reached && customer_confirmed {
        Arrival::Arrived
    } else {
        Arrival::Stop
    }
}

/// How an obstacle's distance changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trend {
    /// It comes nearer.
    Closing,
    /// It keeps its distance.
    Steady,
    /// It goes away.
    Receding,
    /// Not known long enough to say.
    Unknown,
}

/// The driving modes of M1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// To the goal at cruise speed.
    Cruise,
    /// Around an obstacle: E5 and E7.
    Maneuver,
    /// Back to the goal heading: E6.
    Reorient,
    /// At rest because a guard demands it.
    Stop,
    /// At the goal.
    Arrived,
}

impl Mode {
    /// The mode asks for no motion.
    #[must_use]
    pub const fn at_rest(self) -> bool {
        matches!(self, Self::Stop | Self::Arrived)
    }
}

/// What the mode machine needs to know of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// Distance of the obstacle, `None` if there is none in sight or in memory.
    pub distance: Option<Length>,
    /// How it changes, confirmed over enough samples.
    pub trend: Trend,
    /// A guard of the shield demands a stop.
    pub guard: bool,
    /// The path along the goal heading does not run into the obstacle.
    pub corridor_free: bool,
    /// The robot's heading is the goal heading, within tolerance.
    pub aligned: bool,
    /// The robot is at its goal.
    pub at_goal: bool,
}

/// M1: the mode that follows `mode`. A guard comes before everything else; for an unchanging
/// situation the machine is at rest after at most two steps.
//= avoid.INV-10
//= avoid.INV-11
#[must_use]
pub fn next_mode(mode: Mode, situation: &Situation, config: &Config) -> Mode {
    if mode == Mode::Arrived || situation.at_goal {
        return Mode::Arrived;
    }
    if situation.guard {
        return Mode::Stop;
    }
    let Some(distance) = situation.distance else {
        return match mode {
            Mode::Cruise => Mode::Cruise,
            _ if situation.aligned => Mode::Cruise,
            _ => Mode::Reorient,
        };
    };
    let inside = distance.get() < config.safe_distance;
    // d_n may equal d_safe: near is inside all the same, or the modes would alternate there.
    let near = inside && distance.get() <= config.near_distance;
    let receding = situation.trend == Trend::Receding;
    match mode {
        Mode::Cruise => {
            let approaching = matches!(situation.trend, Trend::Closing | Trend::Unknown);
            if inside && (approaching || near) {
                Mode::Maneuver
            } else {
                Mode::Cruise
            }
        }
        Mode::Maneuver => {
            let passed = receding && !near && situation.corridor_free;
            if inside && !passed {
                Mode::Maneuver
            } else {
                Mode::Reorient
            }
        }
        Mode::Reorient => {
            if near || (inside && situation.trend == Trend::Closing) {
                Mode::Maneuver
            } else if situation.aligned && !inside {
                Mode::Cruise
            } else {
                Mode::Reorient
            }
        }
        Mode::Stop => {
            if !inside || (receding && !near) {
                Mode::Reorient
            } else {
                Mode::Maneuver
            }
        }
        Mode::Arrived => Mode::Arrived,
    }
}

/// The reference that a maneuver holds on to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Latch {
    reference: Angle,
    side: Side,
    /// Stopped, it looks at its goal for a change.
    facing_goal: bool,
}

/// How long a stopped robot looks one way, in ms, before it looks another: E5's heading, the goal,
/// E5's heading on the other side, and so on.
const LOOK_TIME: u64 = 2500;

/// An obstacle that comes nearer no faster than this, in m/s, stands still: sonar noise over the
/// time of a trend looks like this much.
const STILL: f32 = 0.15;

/// Things whose distances to the side differ by no more than this, in m, may be one wall.
const SAME_WALL: f32 = 0.1;

/// S1's avoidance law: M1 with E5, E6 and E7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Avoid {
    config: Config,
    mode: Mode,
    latch: Option<Latch>,
    /// Ticks in a row in which the obstacle receded.
    receding: u32,
    /// Since when a stopped robot has looked where it looks.
    looking_since: Option<Instant>,
}

impl Avoid {
    /// The law, about to cruise.
    #[must_use]
    pub const fn new(config: Config) -> Self {
        Self {
            config,
            mode: Mode::Cruise,
            latch: None,
            receding: 0,
            looking_since: None,
        }
    }

    /// The mode it is in.
    #[must_use]
    pub const fn current(&self) -> Mode {
        self.mode
    }

    /// What the mode machine needs to know of a view.
    fn situation<const N: usize>(&self, view: &View<N>) -> Situation {
        let heading_error = view.goal.heading.minus(view.pose.heading);
        let mut situation = Situation {
            distance: None,
            trend: Trend::Unknown,
            guard: view.guard.is_some(),
            corridor_free: true,
            aligned: heading_error.get().abs() <= self.config.alignment,
            at_goal: view.goal.distance <= self.config.goal_tolerance,
        };
        if let Some(obstacle) = self.in_the_way(view) {
            situation.corridor_free = !self.in_corridor(obstacle, view, view.goal.heading);
            situation.distance = Some(obstacle.distance);
            // Receding that is not confirmed yet is neither closing nor gone.
            let confirmed = self.receding >= self.config.confirm_samples as u32;
            situation.trend = match obstacle.trend {
                Trend::Receding if !confirmed => Trend::Steady,
                trend => trend,
            };
        }
        situation
    }

    /// The obstacle, unless it is seen to stand still beside the way to the goal: then it is none.
    fn in_the_way<'a, const N: usize>(&self, view: &'a View<N>) -> Option<&'a Obstacle> {
        view.obstacle.as_ref().filter(|obstacle| {
            let moving = obstacle.trend != Trend::Unknown && obstacle.speed.value.get() > STILL;
            moving || !obstacle.visible || self.in_corridor(obstacle, view, view.goal.heading)
        })
    }

    /// The obstacle is ahead in direction `heading`, within the corridor the robot would sweep.
    fn in_corridor<const N: usize>(
        &self,
        obstacle: &Obstacle,
        view: &View<N>,
        heading: Angle,
    ) -> bool {
        let offset = obstacle.position - view.pose.position;
        let bearing = obstacle.direction.minus(heading).get();
        let distance = math::norm(offset);
        let mut lateral = distance * math::sin(bearing.abs());
        // A sonar does not say where in its cone a thing is. If it can be as far to the side as what
        // stands right beside the robot, it is the same wall.
        let outward = (bearing.abs() + self.config.sonar_half_angle).min(FRAC_PI_2);
        let beside = view.beside[usize::from(bearing < 0.0)].get();
        if (distance * math::sin(outward) - beside).abs() <= SAME_WALL {
            lateral = lateral.max(beside);
        }
        bearing.abs() < FRAC_PI_2
            && lateral <= self.config.robot_radius + self.config.corridor_margin
    }

    /// Holds reference and side of a maneuver from its beginning to its end.
    fn hold_latch<const N: usize>(&mut self, view: &View<N>) {
        match (self.mode, self.in_the_way(view)) {
            (Mode::Cruise | Mode::Reorient | Mode::Arrived, _) => self.latch = None,
            // A robot at rest can wait and see what it is that it turns away from.
            (Mode::Stop, Some(obstacle))
                if self.latch.is_none() && obstacle.trend == Trend::Unknown => {}
            (Mode::Maneuver | Mode::Stop, Some(obstacle)) if self.latch.is_none() => {
                let reference = view.goal.heading;
                let bearing = obstacle.direction.minus(reference);
                let [left, right] = view.room;
                self.latch = Some(Latch {
                    reference,
                    side: Side::away_from(bearing, left, right),
                    facing_goal: false,
                });
            }
            (Mode::Maneuver | Mode::Stop, _) => {}
        }
    }

    /// Makes a robot look round that cannot go where it looks.
    fn look_round<const N: usize>(&mut self, view: &View<N>) {
        let stuck = match self.mode {
            Mode::Stop => true,
            Mode::Maneuver => self.pace(view) == 0.0,
            _ => false,
        };
        let Some(latch) = self.latch.as_mut().filter(|_| stuck) else {
            self.looking_since = None;
            return;
        };
        let since = *self.looking_since.get_or_insert(view.now);
        if view.now.since(since).is_some_and(|time| time >= LOOK_TIME) {
            if latch.facing_goal {
                latch.side = latch.side.other();
            }
            latch.facing_goal = !latch.facing_goal;
            self.looking_since = Some(view.now);
        }
    }

    /// The share of its speed that a maneuver has room for straight ahead: none at d_n, where there
    /// still is room to turn, all of it at d_safe.
    fn pace<const N: usize>(&self, view: &View<N>) -> f32 {
        let (near, safe) = (self.config.near_distance, self.config.safe_distance);
        if view.ahead.get() >= safe {
            1.0
        } else {
            // Not reached with d_n = d_safe, unless there is nothing left.
            ((view.ahead.get() - near) / (safe - near).max(f32::MIN_POSITIVE)).max(0.0)
        }
    }

    /// Heading and speed of the mode.
    fn target<const N: usize>(&self, view: &View<N>) -> (Angle, f32) {
        let config = &self.config;
        let cruise = config.cruise_speed;
        let around = match (self.in_the_way(view), self.latch) {
            (Some(obstacle), Some(latch)) if obstacle.distance.get() < config.safe_distance => {
                let reach = Length::metres(config.turn_distance).unwrap_or(Length::ZERO);
                let turn = QuarterTurns::at_distance(obstacle.distance, reach);
                let speed_max = Speed::metres_per_second(config.speed_max).unwrap_or(Speed::ZERO);
                let heading = if latch.facing_goal {
                    view.goal.heading
                } else {
                    maneuver_heading(latch.reference, latch.side, turn)
                };
                Some((heading, maneuver_speed(speed_max, turn).get(), obstacle))
            }
            _ => None,
        };
        match (self.mode, around) {
            (Mode::Cruise, _) => (view.goal.heading, cruise),
            // E7 makes the robot faster the nearer the obstacle is. That is right once it looks
            // past the obstacle, and only while it sees it (ER-S1-20, ER-X1).
            (Mode::Maneuver, Some((heading, speed, obstacle))) => {
                let past = obstacle.visible && !self.in_corridor(obstacle, view, view.pose.heading);
                let speed = if past { speed } else { speed.min(cruise) };
                (heading, speed * self.pace(view))
            }
            (Mode::Maneuver, None) => (view.goal.heading, cruise / 2.0),
            (Mode::Reorient, _) => {
                let seen = view.obstacle.is_some_and(|obstacle| obstacle.visible);
                (view.goal.heading, if seen { cruise } else { cruise / 2.0 })
            }
            (Mode::Stop, Some((heading, _, _))) => (heading, 0.0),
            // With nothing to turn away from, the goal is where to look.
            (Mode::Stop, None) => (view.goal.heading, 0.0),
            (Mode::Arrived, _) => (view.pose.heading, 0.0),
        }
    }
}

impl<const N: usize> Law<N> for Avoid {
    //= avoid.INV-13
    fn advise(&mut self, view: &View<N>) -> Advice {
        let receding = view
            .obstacle
            .is_some_and(|obstacle| obstacle.trend == Trend::Receding);
        self.receding = if receding {
            self.receding.saturating_add(1)
        } else {
            0
        };
        self.mode = next_mode(self.mode, &self.situation(view), &self.config);
        self.hold_latch(view);
        self.look_round(view);
        let (heading, speed) = self.target(view);
        let error = heading.minus(view.pose.heading).get();
        let turn_rate_max = self.config.turn_rate_max;
        Advice {
            // First turn, then go.
            speed: speed * (1.0 - error.abs() / FRAC_PI_2).max(0.0),
            turn_rate: within(self.config.heading_gain * error, turn_rate_max),
        }
    }

    fn mode(&self) -> &'static str {
        match self.mode {
            Mode::Cruise => "cruise",
            Mode::Maneuver => "maneuver",
            Mode::Reorient => "reorient",
            Mode::Stop => "stop",
            Mode::Arrived => "arrived",
        }
    }
}
