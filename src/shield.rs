//! The shield: whatever a law advises, the robot is at rest before anything touches it.
//!
//! Integers only (millimetres, mm/s, milliradians/s, milliseconds), every rounding to the safe
//! side. Braking is always allowed; motion needs the guard of `spec/shield.md`: the clearance of
//! every sonar must be enough to react and brake, with the obstacle coming at its greatest speed
//! all the while. Proved for any advice in `proofs/shield.rs`.

use crate::config::Config;
use crate::law::Advice;
use crate::observation::SonarReading;
use crate::quantity::Instant;
use crate::ring::Ring;
use crate::view::View;
use core::fmt;

/// Why the robot is made to stand still. Distances in millimetres.
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
    /// There is not even room to react at rest.
    Clearance {
        /// Index of the sonar.
        sonar: usize,
        /// Clearance of the hull.
        clearance: i32,
        /// Clearance needed.
        required: i32,
    },
    /// There is no odometry, or it is too old.
    OdometryStale,
    /// The odometry is not a pose.
    OdometryInvalid,
    /// The clock went back.
    ClockWentBack,
    /// The law advised something that is not a number.
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
}

impl StopReason {
    /// The robot may turn on the spot meanwhile: a round robot that turns sweeps nothing new.
    /// Only where the sensors are in order and what is wrong is the distance.
    #[must_use]
    pub const fn may_turn(self) -> bool {
        matches!(
            self,
            Self::MinDistance { .. }
                | Self::ContactTime { .. }
                | Self::ObstacleTooFast
                | Self::Clearance { .. }
        )
    }
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
                clearance,
                required,
            } => write!(
                f,
                "sonar {sonar}: {clearance} mm clear, {required} mm needed"
            ),
            Self::OdometryStale => write!(f, "odometry is stale"),
            Self::OdometryInvalid => write!(f, "odometry is not a pose"),
            Self::ClockWentBack => write!(f, "clock went back"),
            Self::AdviceInvalid => write!(f, "the law's advice is not a number"),
            Self::MotorsDisabled => write!(f, "motors are disabled"),
            Self::Stalled => write!(f, "stall or bumper"),
            Self::EmergencyStop => write!(f, "emergency stop"),
            Self::LinkLost => write!(f, "link lost"),
            Self::Operator => write!(f, "operator"),
        }
    }
}

/// What the robot is told to do. Only the shield makes one that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command {
    speed: i32,
    turn_rate: i32,
}

impl Command {
    /// Stand still. Braking is always allowed.
    pub const REST: Self = Self {
        speed: 0,
        turn_rate: 0,
    };

    /// Forward speed in mm/s, never negative.
    #[must_use]
    pub const fn speed(self) -> i32 {
        self.speed
    }

    /// Turn rate in milliradians/s, counter-clockwise positive.
    #[must_use]
    pub const fn turn_rate(self) -> i32 {
        self.turn_rate
    }
}

/// A length in whole millimetres, rounded down. Saturates; NaN is 0.
#[must_use]
pub(crate) fn millimetres_down(metres: f32) -> i32 {
    // The cast truncates, which rounds down for the lengths of 0 m and more that come here.
    (metres * 1000.0) as i32
}

/// A length or speed in whole millimetres, rounded up. Saturates; NaN is 0.
#[must_use]
pub(crate) fn millimetres_up(metres: f32) -> i32 {
    let down = millimetres_down(metres);
    if (down as f32) < metres * 1000.0 {
        down.saturating_add(1)
    } else {
        down
    }
}

/// A time in whole milliseconds, rounded to the nearest. Saturates; NaN is 0.
#[must_use]
pub(crate) fn milliseconds(seconds: f32) -> u64 {
    (seconds * 1000.0 + 0.5) as u64
}

/// dividend/divisor rounded up, for dividend ≥ 0 and divisor > 0.
const fn divide_up(dividend: i32, divisor: i32) -> i32 {
    (dividend + (divisor - 1)) / divisor
}

/// The shield's numbers, as integers: what the base can do and what is promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    speed_max: i32,
    turn_rate_max: i32,
    acceleration: i32,
    braking: i32,
    turn_acceleration: i32,
    reaction_time: i32,
    obstacle_speed: i32,
    min_distance: i32,
    stop_time: i32,
    resume_clearance: i32,
    resume_samples: u32,
}

impl Limits {
    /// The limits of a configuration, rounded to the safe side.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            speed_max: millimetres_down(config.speed_max),
            turn_rate_max: millimetres_down(config.turn_rate_max),
            acceleration: millimetres_up(config.acceleration),
            braking: millimetres_down(config.braking),
            turn_acceleration: millimetres_down(config.turn_acceleration),
            reaction_time: millimetres_up(config.reaction_time),
            obstacle_speed: millimetres_up(config.obstacle_speed_max),
            min_distance: millimetres_up(config.min_distance),
            stop_time: millimetres_up(config.stop_time),
            resume_clearance: millimetres_up(config.resume_clearance),
            resume_samples: config.resume_samples as u32,
        }
    }

    /// Greatest forward speed in mm/s.
    #[must_use]
    pub const fn speed_max(&self) -> i32 {
        self.speed_max
    }

    /// Greatest turn rate in milliradians/s.
    #[must_use]
    pub const fn turn_rate_max(&self) -> i32 {
        self.turn_rate_max
    }

    /// The turn acceleration α in mrad/s².
    #[must_use]
    pub const fn turn_acceleration(&self) -> i32 {
        self.turn_acceleration
    }

    /// Greatest obstacle speed V for which the promise holds, mm/s.
    #[must_use]
    pub const fn obstacle_speed(&self) -> i32 {
        self.obstacle_speed
    }

    /// The reaction time ε in ms.
    #[must_use]
    pub const fn reaction_time(&self) -> i32 {
        self.reaction_time
    }

    /// The acceleration bound A in mm/s².
    #[must_use]
    pub const fn acceleration(&self) -> i32 {
        self.acceleration
    }

    /// The stop time T in ms.
    #[must_use]
    pub const fn stop_time(&self) -> i32 {
        self.stop_time
    }

    /// The braking bound b in mm/s².
    #[must_use]
    pub const fn braking(&self) -> i32 {
        self.braking
    }

    /// SH.2: distance in mm in which robot and obstacle close while the robot brakes from `speed`
    /// (mm/s, 0 to 12,000) to rest: v²/2b + V·v/b.
    #[must_use]
    pub const fn stopping_distance(&self, speed: i32) -> i32 {
        divide_up(speed * speed, 2 * self.braking)
            + divide_up(self.obstacle_speed * speed, self.braking)
    }

    /// The robot's own way to rest, in mm, if for one reaction time it is no faster than `speed`
    /// (mm/s, 0 to 12,000) and brakes then: v·ε + v²/2b.
    #[must_use]
    pub const fn way_to_rest(&self, speed: i32) -> i32 {
        divide_up(speed * self.reaction_time, 1000) + divide_up(speed * speed, 2 * self.braking)
    }

    /// Speed in mm/s by which the robot may gain on `speed` within one reaction time: A·ε.
    #[must_use]
    pub const fn speed_gain(&self) -> i32 {
        divide_up(self.acceleration * self.reaction_time, 1000)
    }

    /// SH.3: clearance in mm that is needed to be told to go `speed` (mm/s, 0 to 12,000 less one
    /// gain) for one reaction time: travel of robot and obstacle at the speed the robot may have
    /// by the end of it, then the stopping distance from that speed.
    #[must_use]
    pub const fn required_clearance(&self, speed: i32) -> i32 {
        let fastest = speed + self.speed_gain();
        divide_up((fastest + self.obstacle_speed) * self.reaction_time, 1000)
            + self.stopping_distance(fastest)
    }

    /// SH.4: contact is possible within the stop time: t_lb = distance/closing ≤ T, with the
    /// distance left before contact in mm (0 at least) and the closing speed in mm/s.
    #[must_use]
    pub const fn contact_within_stop_time(&self, distance: i32, closing: i32) -> bool {
        distance as i64 * 1000 <= self.stop_time as i64 * closing as i64
    }

    /// SH.5: the turn rate nearest to `advised` (mrad/s) within the greatest turn rate, within
    /// what SH.6 allows for the clearance (mm), and no farther beyond `last` than the base can
    /// gain in `elapsed` ms (0 to ε). Turning slower is always allowed.
    ///
    /// SH.6: the turn, too, ends before contact: after reacting for ε the robot stops turning in
    /// ω/α, and robot and obstacle have not closed the clearance by then:
    /// x + V(ε + ω/α) ≤ d, where x is the robot's own way to rest, see [`way_to_rest`].
    ///
    /// [`way_to_rest`]: Self::way_to_rest
    #[must_use]
    pub fn admissible_turn_rate(
        &self,
        last: i32,
        advised: i32,
        elapsed: i32,
        clearance: i32,
    ) -> i32 {
        // ω ≤ α·(d − V·ε)/V. Clearances beyond 10 m allow for no more than 10 m do.
        let spare =
            clearance.clamp(0, 10_000) - divide_up(self.obstacle_speed * self.reaction_time, 1000);
        let limit = if spare <= 0 {
            0
        } else if self.obstacle_speed == 0 {
            self.turn_rate_max
        } else {
            (self.turn_acceleration * spare / self.obstacle_speed).min(self.turn_rate_max)
        };
        let step = self.turn_acceleration * elapsed / 1000;
        advised
            .clamp(last.min(0) - step, last.max(0) + step)
            .clamp(-limit, limit)
    }

    /// SH.5: the greatest speed, in mm/s, of those from 0 to `advised` that the base reaches from
    /// `last` within `elapsed` ms (0 to ε) and that every guard admits.
    ///
    /// `speed_bound` is what the robot's speed may be now. SH.3 allows for one speed gain above the
    /// speed it is asked for, so a robot that may be faster than that is judged by what it may be
    /// at: if that much room is not there, it is told to brake to rest, not to a speed in between.
    #[must_use]
    pub fn admissible_speed(
        &self,
        last: i32,
        advised: i32,
        elapsed: i32,
        speed_bound: i32,
        room: Room,
    ) -> Admission {
        let reachable = last + self.acceleration * elapsed / 1000;
        let wish = advised.max(0).min(self.speed_max).min(reachable);
        let in_time = |v: i32| {
            room.ahead
                .is_none_or(|(distance, speed)| !self.contact_within_stop_time(distance, v + speed))
        };
        let in_space = |v: i32| self.required_clearance(v) <= room.clearance;
        let speed = greatest(wish, |v| in_space(v) && in_time(v));
        let limit = if speed < wish {
            Some(if in_space(speed + 1) {
                Limit::ContactTime
            } else {
                Limit::Clearance { sonar: room.sonar }
            })
        } else {
            (wish < advised).then_some(Limit::Base)
        };
        // Asked once more, so that what is returned does not rest on the search.
        let judged_at = speed.max(speed_bound - self.speed_gain());
        let required = self.required_clearance(judged_at);
        if required <= room.clearance {
            Admission {
                speed,
                judged_at,
                required,
                limit,
            }
        } else {
            Admission {
                speed: 0,
                judged_at,
                required,
                limit: (advised > 0).then_some(Limit::Clearance { sonar: room.sonar }),
            }
        }
    }
}

/// The room there is to move in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Least clearance of any sonar, mm.
    pub clearance: i32,
    /// The sonar that it is the clearance of.
    pub sonar: usize,
    /// Distance before contact (mm, at least 0) and speed (mm/s) of the obstacle that the law
    /// avoids.
    pub ahead: Option<(i32, i32)>,
}

impl Room {
    fn new<const N: usize>(view: &View<N>) -> Self {
        let mut room = Self {
            clearance: i32::MAX,
            sonar: 0,
            ahead: view.obstacle.as_ref().map(approach),
        };
        for (sonar, &clearance) in view.clearance.iter().enumerate() {
            if clearance < room.clearance {
                room.clearance = clearance;
                room.sonar = sonar;
            }
        }
        room
    }
}

/// A speed that the shield admits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Admission {
    /// The speed, mm/s.
    pub speed: i32,
    /// The speed it was judged at, mm/s: at least itself, and no less than one speed gain below
    /// what the robot's speed may be now.
    pub judged_at: i32,
    /// The clearance that needs, mm; no more than there is if the speed is not 0.
    pub required: i32,
    /// What made it less than advised, if anything did.
    pub limit: Option<Limit>,
}

/// What made the robot slower than the law advised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The greatest speed or the acceleration of the base.
    Base,
    /// The clearance in front of this sonar.
    Clearance {
        /// Index of the sonar.
        sonar: usize,
    },
    /// The time to contact with the obstacle that the law avoids.
    ContactTime,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Base => write!(f, "what the base can do"),
            Self::Clearance { sonar } => write!(f, "clearance of sonar {sonar}"),
            Self::ContactTime => write!(f, "time to contact"),
        }
    }
}

/// What the shield makes of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// What the robot is told.
    pub command: Command,
    /// Why it stands still, if the shield makes it.
    pub stop: Option<StopReason>,
    /// What made it slower than advised, if anything did.
    pub limit: Option<Limit>,
}

/// The shield and what it remembers: the last command, and whether the robot is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shield {
    limits: Limits,
    last: Command,
    last_tick: Option<Instant>,
    stop: Option<StopReason>,
    /// Ticks in a row in which nothing demanded a stop.
    clear: u32,
}

impl Shield {
    /// A shield at rest.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            limits: Limits::new(config),
            last: Command::REST,
            last_tick: None,
            stop: Some(StopReason::Starting),
            clear: 0,
        }
    }

    /// The limits.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Judges a view: the reason to stand still in this tick, if there is one. A stop once begun
    /// lasts until nothing has demanded it, with the resume clearance on top, for
    /// `resume_samples` ticks in a row.
    pub fn assess<const N: usize>(&mut self, view: &View<N>, ring: &Ring<N>) -> Option<StopReason> {
        if self.last_tick.is_some_and(|last| view.now < last) {
            return self.halt(StopReason::ClockWentBack);
        }
        let margin = if self.stop.is_some() {
            self.limits.resume_clearance
        } else {
            0
        };
        match self.demand(view, ring, margin) {
            Some(reason) => return self.halt(reason),
            None => self.clear = self.clear.saturating_add(1),
        }
        if self.clear >= self.limits.resume_samples {
            self.stop = None;
        }
        self.stop
    }

    /// Stops for `reason`: the command is rest from now on.
    pub fn halt(&mut self, reason: StopReason) -> Option<StopReason> {
        self.stop = Some(reason);
        self.clear = 0;
        self.stop
    }

    /// The first guard that demands a stop, with `margin` (mm) added to every distance needed.
    fn demand<const N: usize>(
        &self,
        view: &View<N>,
        ring: &Ring<N>,
        margin: i32,
    ) -> Option<StopReason> {
        if view.base.emergency_stop {
            return Some(StopReason::EmergencyStop);
        }
        if view.base.stalled {
            return Some(StopReason::Stalled);
        }
        if !view.base.motors_enabled {
            return Some(StopReason::MotorsDisabled);
        }
        for (sonar, reading) in view.sonar.iter().enumerate() {
            match reading {
                SonarReading::Stale => return Some(StopReason::SonarStale { sonar }),
                SonarReading::Invalid => return Some(StopReason::SonarInvalid { sonar }),
                SonarReading::TooNear => return Some(StopReason::TooNear { sonar }),
                SonarReading::Echo(_) | SonarReading::NoEcho(_) => {}
            }
        }
        let minimum = self.limits.min_distance + margin;
        for (sonar, at) in ring.sonars().iter().enumerate() {
            let range = view.range[sonar];
            if at.forward && range <= minimum {
                return Some(StopReason::MinDistance {
                    sonar,
                    range,
                    minimum,
                });
            }
        }
        if let Some(obstacle) = &view.obstacle {
            if obstacle.speed.saturated {
                return Some(StopReason::ObstacleTooFast);
            }
            let (distance, obstacle_speed) = approach(obstacle);
            let distance = (distance - margin).max(0);
            let closing = self.speed_bound(view) + obstacle_speed;
            if self.limits.contact_within_stop_time(distance, closing) {
                return Some(StopReason::ContactTime { distance, closing });
            }
        }
        // No margin here: what is admitted just above this is a creep, and something that stands
        // still this close must not hold the robot for ever.
        let required = self.limits.required_clearance(0);
        for (sonar, &clearance) in view.clearance.iter().enumerate() {
            if clearance < required {
                return Some(StopReason::Clearance {
                    sonar,
                    clearance,
                    required,
                });
            }
        }
        None
    }

    /// The robot is no faster than this, in mm/s: what was measured and it may have gained since,
    /// or what it was told last. At most 11,000: measured speeds go up to 10 m/s.
    fn speed_bound<const N: usize>(&self, view: &View<N>) -> i32 {
        let limits = &self.limits;
        let age = view.odometry_age.min(limits.reaction_time as u64) as i32;
        let gained = divide_up(limits.acceleration * age, 1000).min(1_000);
        (millimetres_up(view.speed.abs()) + gained).max(self.last.speed)
    }

    /// Turns a law's advice into a command, or into rest. To be called once per tick, after
    /// [`assess`](Self::assess) judged the same view. Any bit pattern of advice is allowed.
    pub fn admit<const N: usize>(&mut self, advice: Advice, view: &View<N>) -> Verdict {
        if !(advice.speed.is_finite() && advice.turn_rate.is_finite()) {
            self.halt(StopReason::AdviceInvalid);
        }
        // A pause between ticks gives no licence to leap.
        let elapsed = self
            .last_tick
            .and_then(|last| view.now.since(last))
            .unwrap_or(0)
            .min(self.limits.reaction_time as u64) as i32;
        self.last_tick = Some(view.now);
        let limits = &self.limits;
        let room = Room::new(view);
        let speed_bound = self.speed_bound(view);
        let (speed, limit) = if self.stop.is_none() {
            let advised = (advice.speed * 1000.0) as i32;
            // What is out of sight does not make the robot faster (ER-X1).
            let unseen = view.obstacle.is_some_and(|obstacle| !obstacle.seen_now);
            let gaining = if unseen { 0 } else { elapsed };
            let admission =
                limits.admissible_speed(self.last.speed, advised, gaining, speed_bound, room);
            (admission.speed, admission.limit)
        } else {
            (0, None)
        };
        let turn_rate = if self.stop.is_none_or(StopReason::may_turn) {
            let fastest = if speed == 0 {
                speed_bound
            } else {
                speed_bound.max(speed + limits.speed_gain())
            };
            limits.admissible_turn_rate(
                self.last.turn_rate,
                (advice.turn_rate * 1000.0) as i32,
                elapsed,
                room.clearance.saturating_sub(limits.way_to_rest(fastest)),
            )
        } else {
            0
        };
        self.verdict(Command { speed, turn_rate }, limit)
    }

    /// The verdict of a tick without a view: rest.
    pub fn refuse(&mut self, reason: StopReason, now: Instant) -> Verdict {
        self.halt(reason);
        if self.last_tick.is_none_or(|last| now > last) {
            self.last_tick = Some(now);
        }
        self.verdict(Command::REST, None)
    }

    fn verdict(&mut self, command: Command, limit: Option<Limit>) -> Verdict {
        self.last = command;
        Verdict {
            command,
            stop: self.stop,
            limit,
        }
    }
}

/// Distance left before contact (mm, at least 0) and speed (mm/s) of an obstacle.
fn approach(obstacle: &crate::track::Obstacle) -> (i32, i32) {
    let distance = millimetres_down(obstacle.distance.get()) - obstacle.contact_range;
    (distance.max(0), millimetres_up(obstacle.speed.value.get()))
}

/// The greatest speed in 0..=`wish` (at most 4095 mm/s) that is admitted, where admission only
/// gets harder with speed; 0 if none is. Twelve steps, whatever `admitted` says.
pub fn greatest(wish: i32, admitted: impl Fn(i32) -> bool) -> i32 {
    let mut speed = 0;
    let mut step = 2048;
    while step > 0 {
        let next = speed + step;
        if next <= wish && admitted(next) {
            speed = next;
        }
        step /= 2;
    }
    speed
}
