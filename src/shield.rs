//! The shield: whatever a law advises, the robot is at rest before anything touches it.
//!
//! Integers only (millimetres, mm/s, milliradians/s, milliseconds), every rounding to the safe
//! side. Braking is always allowed; motion needs the guard of `spec/shield.md`: whatever each sonar
//! saw, and whatever that may have done since, there must be room to react and brake. The guard is
//! a comparison of sums of products; the ways and times to rest that go into it are computed once,
//! with the limits. Proved for any advice in `proofs/shield.rs`.

use crate::config::Config;
use crate::failsafe::{Action, StopReason};
use crate::law::Advice;
use crate::monitor::Monitor;
use crate::observation::SonarReading;
use crate::quantity::Instant;
use crate::ring::{Closing, Ring};
use crate::view::{Class, Hazard, View};
use core::fmt;

/// Speed and turn rate in whole numbers: what is wished for, asked about, or was told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Twist {
    /// mm/s, forward positive.
    pub speed: i32,
    /// Milliradians/s, counter-clockwise positive.
    pub turn_rate: i32,
}

impl Twist {
    /// No motion.
    pub const REST: Self = Self {
        speed: 0,
        turn_rate: 0,
    };
}

/// What the robot is told to do. Only the shield makes one that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command(Twist);

impl Command {
    /// Stand still. Braking is always allowed.
    pub const REST: Self = Self(Twist::REST);

    /// Speed in mm/s, forward positive.
    #[must_use]
    pub const fn speed(self) -> i32 {
        self.0.speed
    }

    /// Turn rate in milliradians/s, counter-clockwise positive.
    #[must_use]
    pub const fn turn_rate(self) -> i32 {
        self.0.turn_rate
    }
}

/// A length in whole millimetres, rounded down. Saturates; NaN is 0.
#[must_use]
pub(crate) const fn millimetres_down(metres: f32) -> i32 {
    // The cast truncates, which rounds down for the lengths of 0 m and more that come here.
    (metres * 1000.0) as i32
}

/// A length or speed in whole millimetres, rounded up. Saturates; NaN is 0.
#[must_use]
pub(crate) const fn millimetres_up(metres: f32) -> i32 {
    let down = millimetres_down(metres);
    if (down as f32) < metres * 1000.0 {
        down.saturating_add(1)
    } else {
        down
    }
}

/// A time in whole milliseconds, rounded to the nearest. Saturates; NaN is 0.
#[must_use]
pub(crate) const fn milliseconds(seconds: f32) -> u64 {
    (seconds * 1000.0 + 0.5) as u64
}

/// dividend/divisor rounded up, for dividend ≥ 0 and divisor > 0. A braking of 0 would never end.
const fn divide_up(dividend: i32, divisor: i32) -> i32 {
    match (dividend + (divisor - 1)).checked_div(divisor) {
        Some(quotient) => quotient,
        None => i32::MAX,
    }
}

/// Ways and times to rest are known for this many speeds.
const RUNGS: usize = 64;

/// A command is scaled down by this many steps.
const SHARES: i32 = 64;

/// What it takes to come to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rung {
    /// For a robot that is no faster than this until it begins to brake, mm/s.
    fastest: i32,
    /// Its way, mm.
    way: i32,
    /// Its time, ms.
    time: i32,
}

/// The shield's numbers, as integers: what the base can do and what is promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    speed_max: i32,
    reverse_speed_max: i32,
    turn_rate_max: i32,
    acceleration: i32,
    braking: i32,
    turn_acceleration: i32,
    reaction_time: i32,
    obstacle_speed: i32,
    still_speed: i32,
    still_speed_turning: i32,
    speed_error: i32,
    min_distance: i32,
    stop_time: i32,
    latch_time: u64,
    resume_clearance: i32,
    resume_samples: u32,
}

impl Limits {
    /// The limits of a configuration, rounded to the safe side.
    #[must_use]
    pub const fn new(config: &Config) -> Self {
        let config = config.parameters();
        let braking = millimetres_down(config.braking * config.braking_share);
        Self {
            speed_max: millimetres_down(config.speed_max),
            reverse_speed_max: millimetres_down(config.reverse_speed_max),
            turn_rate_max: millimetres_down(config.turn_rate_max),
            acceleration: millimetres_up(config.acceleration),
            // At least 100 mm/s², whatever floats round.
            braking: if braking < 99 { 99 } else { braking },
            turn_acceleration: millimetres_down(config.turn_acceleration),
            reaction_time: millimetres_up(config.reaction_time),
            obstacle_speed: millimetres_up(config.obstacle_speed_max),
            still_speed: millimetres_up(config.still_speed_max),
            still_speed_turning: millimetres_up(config.still_speed_max_turning),
            speed_error: millimetres_up(config.speed_error),
            min_distance: millimetres_up(config.min_distance),
            stop_time: millimetres_up(config.stop_time),
            latch_time: milliseconds(config.latch_time),
            resume_clearance: millimetres_up(config.resume_clearance),
            resume_samples: config.resume_samples as u32,
        }
    }

    /// Greatest forward speed in mm/s.
    #[must_use]
    pub const fn speed_max(&self) -> i32 {
        self.speed_max
    }

    /// Greatest speed backward in mm/s, as a positive number.
    #[must_use]
    pub const fn reverse_speed_max(&self) -> i32 {
        self.reverse_speed_max
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

    /// The speed bound of a class in mm/s: V for people and the unknown.
    #[must_use]
    pub const fn class_speed(&self, class: Class) -> i32 {
        match class {
            Class::Still => self.still_speed,
            Class::Unknown => self.obstacle_speed,
        }
    }

    /// The speed bound of a class in mm/s for a turn: if that ends on the spot, what stands still has a
    /// bound of its own, since to turn gets the robot nowhere and is not worth betting on its staying
    /// there.
    #[must_use]
    pub const fn class_speed_turning(&self, class: Class, ends_on_the_spot: bool) -> i32 {
        match class {
            Class::Still if ends_on_the_spot => self.still_speed_turning,
            _ => self.class_speed(class),
        }
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

    /// The braking bound b in mm/s²: what is left of the brakes at their worst.
    #[must_use]
    pub const fn braking(&self) -> i32 {
        self.braking
    }

    /// By how much a measured speed may be too low, mm/s.
    #[must_use]
    pub const fn speed_error(&self) -> i32 {
        self.speed_error
    }

    /// SH.2: the robot's own way to rest, in mm, if for one reaction time it is no faster than
    /// `speed` (mm/s, 0 to 12,000) and brakes then: v·ε + v²/2b.
    //= shield.INV-2
    #[must_use]
    pub const fn way_to_rest(&self, speed: i32) -> i32 {
        divide_up(speed * self.reaction_time, 1000) + divide_up(speed * speed, 2 * self.braking)
    }

    /// SH.2: the time to rest, in ms, from `speed` (mm/s, 0 to 12,000): ε + v/b.
    //= shield.INV-2
    #[must_use]
    pub const fn time_to_rest(&self, speed: i32) -> i32 {
        self.reaction_time + divide_up(1000 * speed, self.braking)
    }

    /// Speed in mm/s by which the robot may gain on `speed` within one reaction time: A·ε.
    #[must_use]
    pub const fn speed_gain(&self) -> i32 {
        divide_up(self.acceleration * self.reaction_time, 1000)
    }

    /// SH.3, for people of whom nothing but the present clearance is known, straight ahead: the
    /// clearance in mm that is needed to be told to go `speed` (mm/s, 0 to 12,000 less one gain).
    #[must_use]
    pub const fn required_clearance(&self, speed: i32) -> i32 {
        let fastest = speed + self.speed_gain();
        self.way_to_rest(fastest)
            + divide_up(self.obstacle_speed * self.time_to_rest(fastest), 1000)
    }

    /// SH.3: the clearance that a plan needs from a thing, in thousandths of a millimetre, if all
    /// motion ends within `time` ms from now: the robot's own way since the thing was seen and to
    /// rest, as far as it can lead towards the thing, and the thing's way in that time.
    #[must_use]
    pub fn needed(&self, hazard: &Hazard, closing: &Closing, plan: &Plan, time: i32) -> i64 {
        self.needed_at(self.class_speed(hazard.class), hazard, closing, plan, time)
    }

    /// The same from a thing that may be as fast as `speed`, mm/s.
    fn needed_at(
        &self,
        speed: i32,
        hazard: &Hazard,
        closing: &Closing,
        plan: &Plan,
        time: i32,
    ) -> i64 {
        let turned = hazard.turned.saturating_add(plan.turn);
        let share = |cosine: i32| i64::from(cosine.saturating_add(turned).clamp(0, 1000));
        let way = |i: usize| i64::from(hazard.way[i]) + i64::from(plan.way[i]);
        share(closing.ahead) * way(0)
            + share(closing.back) * way(1)
            + i64::from(speed) * (i64::from(hazard.age) + i64::from(time))
    }

    /// SH.3 and SH.6: driving and turning both end before contact with the thing.
    //= shield.INV-3
    //= shield.INV-12
    //= shield.INV-14
    #[must_use]
    pub fn fits(&self, hazard: &Hazard, closing: &Closing, plan: &Plan) -> bool {
        let there = 1000 * i64::from(hazard.clearance);
        if self.needed(hazard, closing, plan, plan.time) > there {
            return false;
        }
        // The turn ends |ω|/α after the reaction time; both sides multiplied by α.
        let driving = i64::from(plan.time - self.reaction_time);
        let outlasts =
            1000 * i64::from(plan.turn_rate) > i64::from(self.turn_acceleration) * driving;
        let speed = self.class_speed_turning(hazard.class, outlasts);
        let left = there - self.needed_at(speed, hazard, closing, plan, self.reaction_time);
        1000 * i64::from(speed) * i64::from(plan.turn_rate)
            <= i64::from(self.turn_acceleration) * left
    }

    /// SH.4: contact is possible within the stop time: t_lb = distance/closing ≤ T, with the
    /// distance left before contact in mm (0 at least) and the closing speed in mm/s.
    //= shield.INV-7
    //= shield.INV-8
    #[must_use]
    pub const fn contact_within_stop_time(&self, distance: i32, closing: i32) -> bool {
        distance as i64 * 1000 <= self.stop_time as i64 * closing as i64
    }
}

/// The limits, with the ways and times to rest that follow from them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guard {
    limits: Limits,
    rungs: [Rung; RUNGS + 1],
}

impl Guard {
    /// The guard of a configuration.
    #[must_use]
    pub const fn new(config: &Config) -> Self {
        let limits = Limits::new(config);
        // As fast as the robot may be told, or measured at that speed, and a gain on top.
        let top = limits.speed_max + 2 * limits.speed_gain() + limits.speed_error;
        let mut rungs = [Rung {
            fastest: 0,
            way: 0,
            time: 0,
        }; RUNGS + 1];
        let mut k = 0;
        while k <= RUNGS {
            let fastest = divide_up(top * k as i32, RUNGS as i32);
            rungs[k] = Rung {
                fastest,
                way: limits.way_to_rest(fastest),
                time: limits.time_to_rest(fastest),
            };
            k += 1;
        }
        Self { limits, rungs }
    }

    /// The limits.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The first rung that is no slower than `fastest`; none if the robot is faster than it may
    /// ever be told.
    fn rung(&self, fastest: i32) -> Option<Rung> {
        // How many are slower: bisection, seven steps.
        let below = greatest(7, RUNGS as i32 + 1, |k| {
            self.rungs[(k - 1).clamp(0, RUNGS as i32) as usize].fastest < fastest
        });
        self.rungs.get(below as usize).copied()
    }

    /// What the robot may do from now until it rests, if it is told `speed` and `turn_rate` (mm/s,
    /// mrad/s) for one reaction time and rest then. None if it is faster than it may ever be told.
    //= shield.INV-11
    #[must_use]
    pub fn plan(&self, speed: i32, turn_rate: i32, motion: &Motion) -> Option<Plan> {
        let told = speed.saturating_abs().min(12_000);
        let same = (speed < 0) == motion.backward || speed == 0;
        // What it rolls on with, and what it is told: the first alone if it is told to rest.
        let rolling = if same && speed != 0 {
            motion.speed.max(told + self.limits.speed_gain())
        } else {
            motion.speed
        };
        let mut plan = Plan {
            way: [0; 2],
            time: self.limits.reaction_time,
            turn: 0,
            turn_rate: turn_rate.saturating_abs().max(motion.turn_rate),
        };
        if rolling > 0 {
            let rung = self.rung(rolling)?;
            plan.way[usize::from(motion.backward)] = rung.way;
            plan.time = rung.time;
        }
        if !same {
            let rung = self.rung(told + self.limits.speed_gain())?;
            plan.way[usize::from(speed < 0)] = rung.way;
            plan.time = plan.time.max(rung.time);
        }
        let turn = (i64::from(plan.turn_rate) * i64::from(plan.time) + 999) / 1000;
        plan.turn = turn.min(10_000) as i32;
        Some(plan)
    }

    /// SH.5: of the commands that scale the advice down (mm/s, mrad/s) the fastest that the base
    /// reaches from `last` and for which there is room; rest if there is none. The curvature is
    /// that of the advice or less. The advice is at most 10 m/s and 20 rad/s either way; the base
    /// has `elapsed` ms (0 to ε each) to gain speed and turn rate.
    //= shield.INV-1
    //= shield.INV-6
    //= shield.INV-9
    //= shield.INV-15
    //= shield.INV-20
    #[must_use]
    pub fn admissible<const N: usize>(
        &self,
        advised: Twist,
        last: Twist,
        elapsed: [i32; 2],
        surroundings: &Surroundings<'_, N>,
    ) -> Admission {
        let limits = &self.limits;
        let [gaining, elapsed] = elapsed;
        let backward = advised.speed < 0;
        let wanted = advised.speed.abs();
        let most = if !backward {
            limits.speed_max
        } else if surroundings.ring.looks_back() {
            limits.reverse_speed_max
        } else {
            0
        };
        let kept = if (last.speed < 0) == backward {
            last.speed.saturating_abs()
        } else {
            0
        };
        let reachable = kept.saturating_add(limits.acceleration * gaining / 1000);
        let speed = wanted.min(most).min(reachable);

        let step = limits.turn_acceleration * elapsed / 1000;
        let wish = advised
            .turn_rate
            .max(last.turn_rate.min(0).saturating_sub(step))
            .min(last.turn_rate.max(0).saturating_add(step))
            .max(-limits.turn_rate_max)
            .min(limits.turn_rate_max);
        let turn_rate = greatest(12, wish.abs(), |rate| no_tighter(speed, rate, advised));

        // That, and smaller ones by 64ths: speeds rounded up, turn rates down.
        let scaled = |k: i32| {
            let speed = (speed * k + (SHARES - 1)) / SHARES;
            let turn_rate = turn_rate * k / SHARES;
            Twist {
                speed: if backward { -speed } else { speed },
                turn_rate: if wish < 0 { -turn_rate } else { turn_rate },
            }
        };
        let share = greatest(7, SHARES, |k| surroundings.admit(self, scaled(k)));
        let mut admitted = scaled(share);
        // Asked once more, so that what is returned does not rest on the search.
        let fits = surroundings.admit(self, admitted)
            && no_tighter(admitted.speed, admitted.turn_rate, advised);
        if !fits {
            admitted = Twist::REST;
        }
        let limit = if share < SHARES && (speed > 0 || turn_rate > 0) {
            Some(surroundings.obstruction(self, scaled(share + 1)))
        } else {
            (speed < wanted).then_some(Limit::Base)
        };
        Admission {
            twist: admitted,
            limit,
        }
    }
}

/// Turning at `turn_rate` while driving at `speed` bends the path no tighter than advised:
/// |ω|/|v| ≤ |ω*|/|v*|, multiplied out.
//= shield.INV-13
#[must_use]
pub const fn no_tighter(speed: i32, turn_rate: i32, advised: Twist) -> bool {
    turn_rate.abs() * advised.speed.abs() <= advised.turn_rate.abs() * speed.abs()
}

/// How the robot may be moving now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    /// It is no faster than this, mm/s.
    pub speed: i32,
    /// It rolls backward.
    pub backward: bool,
    /// It turns no faster than this, mrad/s.
    pub turn_rate: i32,
}

impl Motion {
    /// At rest.
    pub const REST: Self = Self {
        speed: 0,
        backward: false,
        turn_rate: 0,
    };
}

/// What the robot may do from now until it rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Ways forward and backward, mm.
    pub way: [i32; 2],
    /// Time until it has stopped driving, ms.
    pub time: i32,
    /// By how much it may turn while it drives, mrad.
    pub turn: i32,
    /// How fast it may turn, mrad/s.
    pub turn_rate: i32,
}

/// What there is to run into, and how the robot moves among it.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a, const N: usize> {
    /// What each sonar is believed to have in front of it.
    pub hazard: &'a [Hazard; N],
    /// Where the sonars look.
    pub ring: &'a Ring<N>,
    /// How the robot moves now.
    pub motion: Motion,
    /// Distance before contact (mm, at least 0) and speed (mm/s) of the obstacle that the law
    /// avoids.
    pub ahead: Option<(i32, i32)>,
}

impl<const N: usize> Surroundings<'_, N> {
    /// Whether there is room for a command.
    #[must_use]
    pub fn admit(&self, guard: &Guard, twist: Twist) -> bool {
        let limits = &guard.limits;
        guard
            .plan(twist.speed, twist.turn_rate, &self.motion)
            .is_some_and(|plan| self.tight(limits, &plan).is_none())
            && !self.touches_in_time(limits, twist.speed)
    }

    /// The first sonar with too little room for a plan.
    fn tight(&self, limits: &Limits, plan: &Plan) -> Option<usize> {
        for sonar in 0..N {
            let closing = &self.ring.sonars()[sonar].closing;
            if !limits.fits(&self.hazard[sonar], closing, plan) {
                return Some(sonar);
            }
        }
        None
    }

    /// SH.4 for a robot that drives forward.
    fn touches_in_time(&self, limits: &Limits, speed: i32) -> bool {
        speed > 0
            && self.ahead.is_some_and(|(distance, obstacle_speed)| {
                limits.contact_within_stop_time(distance, speed.saturating_add(obstacle_speed))
            })
    }

    /// Why there is no room for a command.
    fn obstruction(&self, guard: &Guard, twist: Twist) -> Limit {
        let limits = &guard.limits;
        let plan = guard.plan(twist.speed, twist.turn_rate, &self.motion);
        match plan.and_then(|plan| self.tight(limits, &plan)) {
            Some(sonar) => Limit::Clearance { sonar },
            None if plan.is_none() => Limit::Base,
            None => Limit::ContactTime,
        }
    }
}

/// What the guard admits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Admission {
    /// What the robot may be told.
    pub twist: Twist,
    /// What made it slower than advised, if anything did.
    pub limit: Option<Limit>,
}

/// What made the robot slower than the law advised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The greatest speed or the acceleration of the base.
    Base,
    /// The clearance of what this sonar saw.
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
    /// The most severe of what is done about anything.
    pub action: Action,
    /// Why it stands still, if the shield makes it.
    pub stop: Option<StopReason>,
    /// What made it slower than advised, if anything did.
    pub limit: Option<Limit>,
}

/// The shield and what it remembers: the last command, and whether the robot is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shield {
    guard: Guard,
    monitor: Monitor,
    last: Command,
    last_tick: Option<Instant>,
    stop: Option<StopReason>,
    /// The stop holds until it is reset.
    latched: bool,
    /// Since when something has been overdue.
    overdue_since: Option<Instant>,
    /// Nothing demanded a stop at least once.
    ready: bool,
    /// Ticks in a row in which nothing demanded a stop.
    clear: u32,
}

impl Shield {
    /// A shield at rest.
    #[must_use]
    pub const fn new(config: &Config) -> Self {
        Self {
            guard: Guard::new(config),
            monitor: Monitor::new(),
            last: Command::REST,
            last_tick: None,
            stop: Some(StopReason::Starting),
            latched: false,
            overdue_since: None,
            ready: false,
            clear: 0,
        }
    }

    /// The limits.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.guard.limits
    }

    /// The stop holds until it is reset.
    #[must_use]
    pub const fn is_latched(&self) -> bool {
        self.latched
    }

    /// Somebody has looked at what latched the stop, and lets the robot go on once nothing demands
    /// a stop any more. What is still wrong latches it again.
    //= failsafe.INV-5
    pub fn reset(&mut self) {
        self.latched = false;
        self.overdue_since = None;
        self.clear = 0;
        self.monitor = Monitor::new();
    }

    /// Judges a view: the reason to stand still in this tick, if there is one. A stop once begun
    /// lasts until nothing has demanded it, with the resume clearance on top, for
    /// `resume_samples` ticks in a row; a latched one until it is reset as well.
    //= shield.INV-17
    pub fn assess<const N: usize>(&mut self, view: &View<N>, ring: &Ring<N>) -> Option<StopReason> {
        let margin = if self.stop.is_some() {
            self.guard.limits.resume_clearance
        } else {
            0
        };
        let measured_at = Instant(view.now.0.saturating_sub(view.odometry_age));
        let measured = millimetres_up(view.speed.abs());
        let weak = self
            .monitor
            .measured(measured, measured_at, &self.guard.limits);
        let cause = StopReason::worse(
            weak.then(|| StopReason::BrakesWeak {
                measured,
                bound: self.monitor.bound(&self.guard.limits),
            }),
            self.demand(view, ring, margin),
        );
        let Some(reason) = cause else {
            self.ready = true;
            self.overdue_since = None;
            if !self.latched {
                self.clear = self.clear.saturating_add(1);
                if self.clear >= self.guard.limits.resume_samples {
                    self.stop = None;
                }
            }
            return self.stop;
        };
        self.halt(reason, view.now)
    }

    /// Stops for `reason`: the command is rest from now on.
    //= failsafe.INV-5
    //= failsafe.INV-7
    fn halt(&mut self, reason: StopReason, now: Instant) -> Option<StopReason> {
        self.clear = 0;
        // Another cause in between does not make what is overdue arrive: only a clear tick does.
        let overdue = reason.row().latches_in_time && {
            let since = *self.overdue_since.get_or_insert(now);
            let lasted = now.since(since).unwrap_or(0);
            lasted >= self.guard.limits.latch_time
        };
        if !self.latched {
            self.stop = Some(reason);
            // Before everything was there for the first time, nothing has been lost.
            self.latched = reason.action() == Action::LatchedStop || (overdue && self.ready);
        }
        self.stop
    }

    /// What demands a stop, the worst of it, with `margin` (mm) added to every distance needed.
    //= shield.INV-5
    //= shield.INV-16
    //= shield.INV-18
    fn demand<const N: usize>(
        &self,
        view: &View<N>,
        ring: &Ring<N>,
        margin: i32,
    ) -> Option<StopReason> {
        let limits = &self.guard.limits;
        let moving = self.last != Command::REST;
        let motion = self.motion(view);
        let mut worst = None;
        let mut demand = |reason| worst = StopReason::worse(worst, Some(reason));
        if view.base.emergency_stop {
            demand(StopReason::EmergencyStop);
        }
        if view.base.stalled {
            demand(StopReason::Stalled);
        }
        let fast = self.guard.plan(limits.speed_max, 0, &motion);
        for sonar in 0..N {
            let hazard = &view.hazard[sonar];
            let closing = &ring.sonars()[sonar].closing;
            let near = fast.is_none_or(|plan| !limits.fits(hazard, closing, &plan));
            if moving && hazard.too_fast && near {
                demand(StopReason::ClassExceeded {
                    sonar,
                    bound: limits.class_speed(Class::Unknown),
                });
            }
            if moving && hazard.stuck {
                demand(StopReason::SensorStuck {
                    sonar,
                    range: hazard.range,
                });
            }
        }
        if let Some(last) = self.last_tick {
            match view.now.since(last) {
                None => demand(StopReason::ClockWentBack),
                Some(elapsed) if moving && elapsed > limits.reaction_time as u64 => {
                    demand(StopReason::LoopLate {
                        elapsed: elapsed.min(i32::MAX as u64) as i32,
                        bound: limits.reaction_time,
                    });
                }
                Some(_) => {}
            }
        }
        if !view.base.motors_enabled {
            demand(StopReason::MotorsDisabled);
        }
        for (sonar, reading) in view.sonar.iter().enumerate() {
            match reading {
                SonarReading::Stale => demand(StopReason::SonarStale { sonar }),
                SonarReading::Invalid => demand(StopReason::SonarInvalid { sonar }),
                SonarReading::TooNear => demand(StopReason::TooNear { sonar }),
                SonarReading::Echo(_) | SonarReading::NoEcho(_) => {}
            }
        }
        let minimum = limits.min_distance + margin;
        for (sonar, at) in ring.sonars().iter().enumerate() {
            let range = view.hazard[sonar].range;
            if at.forward && range <= minimum {
                demand(StopReason::MinDistance {
                    sonar,
                    range,
                    minimum,
                });
            }
        }
        if let Some(obstacle) = &view.obstacle {
            if obstacle.speed.saturated {
                demand(StopReason::ObstacleTooFast);
            }
            let (distance, obstacle_speed) = Self::approach(obstacle);
            let distance = (distance - margin).max(0);
            let own = if motion.backward { 0 } else { motion.speed };
            let closing = own.saturating_add(obstacle_speed);
            if limits.contact_within_stop_time(distance, closing) {
                demand(StopReason::ContactTime { distance, closing });
            }
        }
        // No margin here: what is admitted just above this is a creep, and something that stands
        // still this close must not hold the robot for ever.
        if let Some(plan) = self.guard.plan(1, 0, &Motion::REST) {
            for (sonar, at) in ring.sonars().iter().enumerate() {
                let hazard = &view.hazard[sonar];
                if !limits.fits(hazard, &at.closing, &plan) {
                    let needed = limits.needed(hazard, &at.closing, &plan, plan.time);
                    demand(StopReason::Clearance {
                        sonar,
                        bearing: at.heading.get().to_degrees() as i32,
                        clearance: hazard.clearance,
                        required: ((needed + 999) / 1000).clamp(0, i64::from(i32::MAX)) as i32,
                        class: hazard.class,
                    });
                }
            }
        }
        worst
    }

    /// How the robot may be moving now. What was measured is at most 10 m/s and 20 rad/s.
    //= shield.INV-19
    fn motion<const N: usize>(&self, view: &View<N>) -> Motion {
        let limits = &self.guard.limits;
        let turn_rate = millimetres_up(view.turn_rate.abs()).max(self.last.0.turn_rate.abs());
        // Wheels that turn are measured as turning: after a command to rest, 0 is rest.
        if view.speed == 0.0 && self.last.0.speed == 0 {
            return Motion {
                speed: 0,
                backward: false,
                turn_rate,
            };
        }
        let age = view.odometry_age.min(limits.reaction_time as u64) as i32;
        let gained = divide_up(limits.acceleration * age, 1000);
        let measured = millimetres_up(view.speed.abs()) + limits.speed_error + gained;
        Motion {
            speed: measured.max(self.last.0.speed.abs()),
            backward: view.speed < 0.0 || (view.speed == 0.0 && self.last.0.speed < 0),
            turn_rate,
        }
    }

    /// Distance left before contact (mm, at least 0) and speed (mm/s) of an obstacle.
    //= shield.INV-19
    fn approach(obstacle: &crate::track::Obstacle) -> (i32, i32) {
        let distance = millimetres_down(obstacle.distance.get()) - obstacle.contact_range;
        (distance.max(0), millimetres_up(obstacle.speed.value.get()))
    }

    /// Turns a law's advice into a command, or into rest. To be called once per tick, after
    /// [`assess`](Self::assess) judged the same view. Any bit pattern of advice is allowed.
    //= shield.INV-4
    //= shield.INV-5
    pub fn admit<const N: usize>(
        &mut self,
        advice: Advice,
        view: &View<N>,
        ring: &Ring<N>,
    ) -> Verdict {
        let advised = whole(advice);
        if advised.is_none() {
            // A stop that is there already keeps its name.
            self.clear = 0;
            if self.stop.is_none() {
                self.halt(StopReason::AdviceInvalid, view.now);
            }
        }
        // A pause between ticks gives no licence to leap.
        let elapsed = self
            .last_tick
            .and_then(|last| view.now.since(last))
            .unwrap_or(0)
            .min(self.guard.limits.reaction_time as u64) as i32;
        self.last_tick = Some(view.now);
        let free = self.stop.is_none();
        let turns = !self.latched && self.stop.is_none_or(StopReason::may_turn);
        let unseen = view.obstacle.is_some_and(|obstacle| !obstacle.seen_now);
        let mut advised = advised.unwrap_or(Twist::REST);
        // A stopped robot may turn on the spot and back off, if that is what the law advises.
        if !free && advised.speed > 0 {
            advised = Twist::REST;
        }
        let mut admission = Admission {
            twist: Twist::REST,
            limit: None,
        };
        if turns {
            let surroundings = Surroundings {
                hazard: &view.hazard,
                ring,
                motion: self.motion(view),
                ahead: view.obstacle.as_ref().map(Self::approach),
            };
            // What is out of sight does not make the robot faster (ER-X1).
            let gaining = if unseen { 0 } else { elapsed };
            admission =
                self.guard
                    .admissible(advised, self.last.0, [gaining, elapsed], &surroundings);
        }
        let limited = matches!(
            admission.limit,
            Some(Limit::Clearance { .. } | Limit::ContactTime)
        );
        let action = Action::Run
            .join(if limited { Action::Limit } else { Action::Run })
            .join(if unseen { Action::Slow } else { Action::Run });
        self.verdict(admission, action, view.now)
    }

    /// The verdict of a tick without a view: rest.
    pub fn refuse(&mut self, reason: StopReason, now: Instant) -> Verdict {
        self.halt(reason, now);
        if self.last_tick.is_none_or(|last| now > last) {
            self.last_tick = Some(now);
        }
        let admission = Admission {
            twist: Twist::REST,
            limit: None,
        };
        self.verdict(admission, Action::Run, now)
    }

    fn verdict(&mut self, admission: Admission, action: Action, now: Instant) -> Verdict {
        let Admission { twist, limit } = admission;
        let command = Command(twist);
        self.monitor
            .told(twist.speed.saturating_abs(), now, &self.guard.limits);
        self.last = command;
        let stopped = self.stop.map_or(Action::Run, |_| Action::Stop);
        let latched = if self.latched {
            Action::LatchedStop
        } else {
            Action::Run
        };
        Verdict {
            command,
            action: action.join(stopped).join(latched),
            stop: self.stop,
            limit,
        }
    }
}

/// The greatest speed, m/s, and turn rate, rad/s, that make sense as advice.
const ADVICE_MAX: Advice = Advice {
    speed: 10.0,
    turn_rate: 20.0,
};

/// Advice in whole numbers; none if it is no number, or far beyond what any base can do.
fn whole(advice: Advice) -> Option<Twist> {
    let sensible =
        advice.speed.abs() <= ADVICE_MAX.speed && advice.turn_rate.abs() <= ADVICE_MAX.turn_rate;
    sensible.then_some(Twist {
        speed: (advice.speed * 1000.0) as i32,
        turn_rate: (advice.turn_rate * 1000.0) as i32,
    })
}

/// The greatest number in 0..=`wish` that is admitted, where admission only gets harder with size;
/// 0 if none is. Looks at `steps` numbers (up to 30), whatever `admitted` says, and finds those
/// below 2 to the power of `steps`.
//= shield.INV-10
pub fn greatest(steps: u32, wish: i32, admitted: impl Fn(i32) -> bool) -> i32 {
    let mut found = 0;
    let mut step = 1 << steps.min(30);
    for _ in 0..steps.min(30) {
        step /= 2;
        let next = found + step;
        if next <= wish && admitted(next) {
            found = next;
        }
    }
    found
}
