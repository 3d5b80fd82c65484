//! The world as it is believed to be: the observation, judged, with memory.
//!
//! Losing sight of something is no proof that it left (ER-X1). Two memories hold on to it: for
//! the shield, each sonar's last echo, with the way that the robot has gone since; for the law, the
//! place of the one obstacle it avoids. Both let go only when the place is seen to be free often
//! enough, or when the hold time is over.

use crate::config::Config;
use crate::failsafe::StopReason;
use crate::math;
use crate::observation::{BaseStatus, Observation, OdometrySample, SonarReading, classify};
use crate::quantity::{Angle, Instant, Length, in_range};
use crate::ring::{Ring, Sonar};
use crate::shield::{millimetres_down, millimetres_up, milliseconds};
use crate::track::{self, Obstacle, Track};
use crate::wall::{ACROSS, Wall};
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

/// How fast a thing may move, as far as its echoes tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// It has agreed with the robot's own motion for `still_samples` readings.
    Still,
    /// A person, or anything else.
    Unknown,
}

/// What one sonar is believed to have in front of it, and all that happened since it was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hazard {
    /// Least range when it was measured, mm.
    pub range: i32,
    /// Clearance of the hull then, less the error of the range, mm. May be negative.
    pub clearance: i32,
    /// Time since, ms.
    pub age: i32,
    /// The robot's own way since, forward and backward, mm.
    pub way: [i32; 2],
    /// By how much the robot has turned since, mrad.
    pub turned: i32,
    /// How fast it may be.
    pub class: Class,
    /// It comes nearer faster than anything the promise allows for.
    pub too_fast: bool,
    /// The sonar reads the same although the robot drives towards whatever it reads.
    pub stuck: bool,
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
    /// Measured turn rate in rad/s, −20 to 20.
    pub turn_rate: f32,
    /// How long ago these were measured, ms.
    pub odometry_age: u64,
    /// The way to the goal.
    pub goal: GoalView,
    /// The judged reading of each sonar.
    pub sonar: [SonarReading; N],
    /// What each sonar is believed to have in front of it.
    pub hazard: [Hazard; N],
    /// The obstacle the law avoids, if there is one in sight or in memory.
    pub obstacle: Option<Obstacle>,
    /// Least range held by the sonars that look within the angle of view of straight ahead.
    pub ahead: Length,
    /// Free range to the left and to the right of straight ahead.
    pub room: [Length; 2],
    /// Distance from the robot's centre line to what stands right beside it, left and right.
    pub beside: [Length; 2],
    /// The base's own status.
    pub base: BaseStatus,
    /// Why the shield will not let the robot move, if so.
    pub guard: Option<StopReason>,
}

/// How far the robot has gone altogether: sums that never shrink, rounded up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odometer {
    /// Ways forward and backward, mm.
    pub way: [i64; 2],
    /// Turns either way, mrad.
    pub turned: i64,
}

impl Odometer {
    /// Adds the way from one pose to the next.
    //= view.INV-5
    #[must_use]
    pub fn advanced(self, from: &Pose, to: &Pose) -> Self {
        let offset = to.position - from.position;
        let heading = from.heading.get();
        let along = offset.x * math::cos(heading) + offset.y * math::sin(heading);
        let way = i64::from(millimetres_up(math::norm(offset)));
        let turn = i64::from(millimetres_up(to.heading.minus(from.heading).get().abs()));
        let mut sum = self;
        let direction = &mut sum.way[usize::from(along < 0.0)];
        *direction = direction.saturating_add(way);
        sum.turned = sum.turned.saturating_add(turn);
        sum
    }
}

/// Ways and times longer than this count as this: no sonar reaches so far, nothing is held so long.
const LONGEST: i64 = 10_000;

/// The growth of a sum, at most [`LONGEST`].
fn grown(from: i64, to: i64) -> i32 {
    to.saturating_sub(from).clamp(0, LONGEST) as i32
}

/// Time from one instant to a later one in ms, at most [`LONGEST`]; out of order counts as that.
fn elapsed(from: Instant, to: Instant) -> i32 {
    to.since(from)
        .map_or(LONGEST as i32, |age| age.min(LONGEST as u64) as i32)
}

/// One reading that was an echo.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Echo {
    range: i32,
    taken_at: Instant,
    odometer: Odometer,
}

impl Echo {
    /// How much nearer a thing that stands still can have come at least and at most, mm, for the
    /// way that the robot has gone since.
    fn approach(&self, odometer: &Odometer, sonar: &Sonar) -> [i32; 2] {
        let [ahead, back] = [0, 1].map(|i| grown(self.odometer.way[i], odometer.way[i]));
        let turned = grown(self.odometer.turned, odometer.turned);
        let [least, most] = sonar.closing.face;
        let (least, most) = ((least - turned).max(-1000), (most + turned).min(1000));
        let lever = sonar.lever * turned.min(1000) / 1000;
        [
            (least * ahead - most * back) / 1000 - lever - 1,
            (most * ahead - least * back) / 1000 + lever + 1,
        ]
    }
}

/// The echo that a sonar's memory holds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    echo: Echo,
    /// Way and turn that the robot may have done between the reading and the odometer's time.
    lag: [i32; 2],
    /// Its place in the odometry frame, if the pose was known.
    place: Option<Vector2<f32>>,
    /// Echoes in a row from farther away.
    farther: u32,
    /// When the last of them was measured: one that is looked at twice counts once.
    counted: Instant,
}

/// The memory of one sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EchoMemory {
    held: Option<Held>,
    /// The latest echo, whatever came of it.
    latest: Option<Echo>,
    /// The echo with which later ones must agree if the thing is still.
    anchor: Option<Echo>,
    /// Echoes in a row that agreed with the robot's own motion.
    agreed: u32,
    /// By how much, mm, the thing has come nearer than the promise allows for, over the echoes that
    /// follow each other so closely that they are one thing's.
    excess: i32,
    /// How many echoes in a row added to it.
    excessive: u32,
    /// The way forward at which the sonar began to read what it reads.
    unchanged_since: i64,
}

/// What is remembered from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory<const N: usize> {
    sonar: [EchoMemory; N],
    track: Option<Track>,
    odometer: Odometer,
    /// The last pose.
    pose: Option<Pose>,
    /// Time of the tick before.
    last: Option<Instant>,
}

impl<const N: usize> Default for Memory<N> {
    fn default() -> Self {
        Self {
            sonar: [EchoMemory::default(); N],
            track: None,
            odometer: Odometer::default(),
            pose: None,
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
    //= view.INV-4
    pub fn update(
        &mut self,
        observation: &Observation<N>,
        goal: Vector2<f32>,
        ring: &Ring<N>,
        config: &Config,
    ) -> Result<View<N>, StopReason> {
        let now = observation.now;
        let odometry = judge_odometry(observation.odometry, now, config);
        let pose = odometry.as_ref().ok().map(|odometry| odometry.pose);
        if let Some(pose) = pose {
            if let Some(before) = self.pose {
                self.odometer = self.odometer.advanced(&before, &pose);
            }
            self.pose = Some(pose);
        }
        let sonar = observation.sonar.map(|sample| {
            classify(
                sample,
                now,
                length(config.sonar_range_min),
                length(config.sonar_range_max),
                milliseconds(config.sonar_age_max),
            )
        });
        let mut agrees = [false; N];
        let mut still = [false; N];
        for (i, memory) in self.sonar.iter().enumerate() {
            agrees[i] = memory.agreed > 0;
            still[i] = memory.is_still(now, config);
        }
        let walls = Wall::beside(&sonar, &agrees, ring, config);
        let witnesses = self.witnesses(&sonar, observation, pose, ring, config);
        // What was there in the tick before has been looked at.
        let mut fresh = [false; N];
        let mut hazard = [Hazard::NONE; N];
        for i in 0..N {
            let taken_at = observation.sonar[i].map_or(now, |sample| sample.taken_at);
            fresh[i] = self.last.is_none_or(|last| taken_at > last);
            let look = Look {
                measured: measured(sonar[i]),
                taken_at,
                now,
                odometer: self.odometer,
                pose,
                witness: Witness {
                    on_wall: is_wall(sonar[i], &ring.sonars()[i], &walls, config),
                    beside_still: is_beside_still(i, &sonar, &still, ring, config),
                    ..witnesses[i]
                },
            };
            hazard[i] = self.sonar[i].update(&look, &ring.sonars()[i], config);
        }
        self.last = Some(now);

        let Odometry {
            pose,
            speed,
            turn_rate,
            age: odometry_age,
        } = odometry?;
        let to_goal = goal - pose.position;
        let goal = GoalView {
            heading: Angle::radians(math::atan2(to_goal.y, to_goal.x)).unwrap_or(Angle::ZERO),
            distance: math::norm(to_goal),
        };
        track::follow(&mut self.track, &sonar, &fresh, &pose, now, ring, config);
        let obstacle = self.track.map(|track| {
            let look = track::Look {
                now,
                pose: &pose,
                speed,
                sighting: observation.sighting.as_ref(),
                still: hazard
                    .get(track.sonar())
                    .is_some_and(|hazard| hazard.class == Class::Still),
            };
            track.obstacle(&look, config)
        });
        Ok(View {
            now,
            pose,
            speed,
            turn_rate,
            odometry_age,
            goal,
            sonar,
            hazard,
            obstacle,
            ahead: ahead(&hazard, ring, config),
            room: room(&sonar, ring, config),
            beside: beside(&sonar, ring, config),
            base: observation.base,
            guard: None,
        })
    }
}

impl<const N: usize> Memory<N> {
    /// What the other sonars' echoes say of what each holds, and of what each hears.
    fn witnesses(
        &self,
        sonar: &[SonarReading; N],
        observation: &Observation<N>,
        pose: Option<Pose>,
        ring: &Ring<N>,
        config: &Config,
    ) -> [Witness; N] {
        let mut witnesses = [Witness::default(); N];
        let Some(pose) = pose else {
            return witnesses;
        };
        let least = math::cos(config.sonar_half_angle);
        let scatter = SCATTER as f32 / 1000.0;
        for i in 0..N {
            let Some((place, seen)) = self.sonar[i].place() else {
                continue;
            };
            let place = pose.to_robot(place);
            let still = self.sonar[i].is_still(observation.now, config);
            for j in 0..N {
                let SonarReading::Echo(range) = sonar[j] else {
                    continue;
                };
                let at = &ring.sonars()[j];
                let offset = place - at.position;
                let distance = math::norm(offset);
                if offset.dot(&at.axis) < distance * least {
                    continue;
                }
                witnesses[i].covered = true;
                let later = observation.sonar[j].is_some_and(|sample| sample.taken_at > seen);
                if j == i || !later {
                    continue;
                }
                let beyond = range.get() - distance;
                witnesses[i].heard_there |= beyond <= scatter;
                witnesses[j].known_still |= still && beyond.abs() <= config.still_tolerance;
            }
        }
        witnesses
    }
}

/// A length that a checked configuration is known to hold.
fn length(metres: f32) -> Length {
    Length::metres(metres).unwrap_or(Length::ZERO)
}

/// Echoes of one thing scatter by less than this, in millimetres.
const SCATTER: i32 = 100;

/// Turning by no more than this between two readings, mrad, a sonar looks in the same direction.
const SAME_DIRECTION: i32 = 30;

/// A still surface that is heard at 60° to its normal comes nearer by twice the way that the
/// robot's motion takes the cone along it.
const GRAZING: i32 = 2;

/// What is nearer by more than this explains, m/s, is another thing: nobody runs that fast indoors.
const FASTEST: f32 = 4.0;

/// A robot that drove this far, mm, towards what a sonar reads must see it change.
const STUCK_WAY: i64 = 400;

impl Hazard {
    /// Nothing seen, which is as bad as can be.
    const NONE: Self = Self {
        range: 0,
        clearance: 0,
        age: LONGEST as i32,
        way: [LONGEST as i32; 2],
        turned: LONGEST as i32,
        class: Class::Unknown,
        too_fast: false,
        stuck: false,
    };
}

/// What a sonar's memory is shown in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The measured range, mm; none if no echo came back.
    pub measured: Option<i32>,
    /// When it was measured.
    pub taken_at: Instant,
    /// The tick's time.
    pub now: Instant,
    /// How far the robot has gone.
    pub odometer: Odometer,
    /// Where the robot is, if that is known.
    pub pose: Option<Pose>,
    /// What the other sonars say.
    pub witness: Witness,
}

/// What the echoes of other sonars say of a sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Witness {
    /// Some sonar has an echo whose cone covers the place of what is held.
    pub covered: bool,
    /// Another one hears something there or nearer: from now on it is that one's.
    pub heard_there: bool,
    /// What is heard is where another one held a still thing.
    pub known_still: bool,
    /// The range is that of a wall that others hear as well.
    pub on_wall: bool,
    /// What is heard is no nearer than a still thing that a sonar next to it hears.
    pub beside_still: bool,
}

impl EchoMemory {
    /// Where what is held was seen, in the odometry frame, and when.
    fn place(&self) -> Option<(Vector2<f32>, Instant)> {
        let held = self.held?;
        Some((held.place?, held.echo.taken_at))
    }

    /// What is held has earned the class of still things, and was heard not long ago.
    fn is_still(&self, now: Instant, config: &Config) -> bool {
        let (Some(held), Some(latest)) = (self.held, self.latest) else {
            return false;
        };
        let age = elapsed(held.echo.taken_at, now);
        self.agreed >= config.still_samples as u32
            && latest.taken_at == held.echo.taken_at
            && u64::from(age.unsigned_abs()) <= milliseconds(config.sonar_age_max)
    }

    /// Takes in a look and holds on to what was heard until its place is seen to be free or the
    /// hold time is over (view.INV-2, view.INV-3).
    //= view.INV-2
    //= view.INV-3
    pub fn update(&mut self, look: &Look, sonar: &Sonar, config: &Config) -> Hazard {
        if let Some(range) = look.measured {
            self.compare(range, look, sonar, config);
        }
        self.hold(look, sonar, config);
        self.hazard(look, sonar, config)
    }

    /// Compares a new echo with those before it: does the thing stand still, is it too fast, does
    /// the sonar hear at all?
    //= view.INV-6
    fn compare(&mut self, range: i32, look: &Look, sonar: &Sonar, config: &Config) {
        let echo = Echo {
            range,
            taken_at: look.taken_at,
            odometer: look.odometer,
        };
        let Some(latest) = self.latest else {
            (self.latest, self.anchor) = (Some(echo), Some(echo));
            self.unchanged_since = look.odometer.way[0];
            return;
        };
        // A reading that is looked at twice counts once.
        if look.taken_at <= latest.taken_at {
            return;
        }
        // What has not been heard for a while may be another thing by now.
        let gap = elapsed(latest.taken_at, look.taken_at);
        if u64::from(gap.unsigned_abs()) > milliseconds(config.sonar_age_max) {
            self.agreed = 0;
            self.anchor = None;
            self.unchanged_since = look.odometer.way[0];
        }
        let tolerance = millimetres_up(config.still_tolerance);
        let anchor = self.anchor.unwrap_or(latest);
        let [least, most] = anchor.approach(&look.odometer, sonar);
        let nearer = anchor.range - range;
        let agrees = nearer >= least - tolerance && nearer <= most + tolerance;
        if agrees || look.witness.on_wall {
            self.agreed = self.agreed.saturating_add(1);
            // From time to time the comparison begins anew, or the robot's own way would explain
            // more and more.
            if self
                .agreed
                .is_multiple_of((config.still_samples as u32).max(1))
            {
                self.anchor = Some(echo);
            }
        } else {
            self.agreed = 0;
            self.anchor = Some(echo);
        }
        if look.witness.known_still {
            self.agreed = self.agreed.max(config.still_samples as u32);
        }

        // Something that comes nearer faster than the bound, and a quarter more, adds up; another
        // thing, which a jump or a turn brings into the cone, does not. Nor does the side of a box
        // that the next sonar hears the front of: it slides through the edge of this cone at any
        // speed as the robot drives.
        let [ahead, back] = [0, 1].map(|i| grown(latest.odometer.way[i], look.odometer.way[i]));
        let turned = grown(latest.odometer.turned, look.odometer.turned);
        let swept = ahead + back + range * turned / 1000;
        let nearer = latest.range - range - GRAZING * swept;
        let one_thing = turned <= SAME_DIRECTION && nearer <= way(FASTEST, gap) + tolerance;
        let slides = swept > 0 && look.witness.beside_still;
        let excess = nearer - way(config.obstacle_speed_max * 1.25, gap);
        if one_thing && !slides && excess > 0 {
            self.excess = self.excess.saturating_add(excess);
            self.excessive = self.excessive.saturating_add(1);
        } else {
            (self.excess, self.excessive) = (0, 0);
        }
        if range != latest.range {
            self.unchanged_since = look.odometer.way[0];
        }
        self.latest = Some(echo);
    }

    /// Holds the echo that counts.
    fn hold(&mut self, look: &Look, sonar: &Sonar, config: &Config) {
        let hold_time = milliseconds(config.hold_time);
        let new = |range| {
            let late = elapsed(look.taken_at, look.now);
            Held {
                echo: Echo {
                    range,
                    taken_at: look.taken_at,
                    odometer: look.odometer,
                },
                lag: [way(config.speed_max, late), way(config.turn_rate_max, late)],
                place: look.pose.map(|pose| {
                    pose.to_world(sonar.position + sonar.axis * (range as f32 / 1000.0))
                }),
                farther: 0,
                counted: look.taken_at,
            }
        };
        // A reading from before the echo that is held says nothing of what came after it.
        let receded = |old: &Held| {
            if look.taken_at < old.echo.taken_at {
                return 0;
            }
            let [ahead, back] =
                [0, 1].map(|i| grown(old.echo.odometer.way[i], look.odometer.way[i]));
            way(
                config.obstacle_speed_max,
                elapsed(old.echo.taken_at, look.taken_at),
            ) + ahead
                + back
        };
        let expired = |old: &Held| {
            look.now
                .since(old.echo.taken_at)
                .is_none_or(|age| age > hold_time)
        };
        self.held = match (self.held, look.measured) {
            // An echo from farther away than the same thing can have gone is another thing's: it
            // counts only when it keeps coming, and only while the place of the first is looked at.
            (Some(old), Some(range)) if range > old.echo.range + receded(&old) + SCATTER => {
                let counts = look.witness.covered && look.taken_at > old.counted;
                let farther = old.farther + u32::from(counts);
                let gone = farther >= config.confirm_samples as u32 || look.witness.heard_there;
                Some(if gone || expired(&old) {
                    new(range)
                } else {
                    Held {
                        farther,
                        counted: old.counted.max(look.taken_at),
                        ..old
                    }
                })
            }
            // Looked at again, it is the same reading, with the lag it had.
            (Some(old), Some(range))
                if range == old.echo.range && look.taken_at == old.echo.taken_at =>
            {
                Some(old)
            }
            (_, Some(range)) => Some(new(range)),
            // No echo is no proof: only time lets go, or another sonar that hears it.
            (Some(old), None) if !expired(&old) && !look.witness.heard_there => {
                Some(Held { farther: 0, ..old })
            }
            (_, None) => None,
        };
    }

    /// What follows for the shield.
    //= view.INV-5
    //= view.INV-7
    fn hazard(&self, look: &Look, sonar: &Sonar, config: &Config) -> Hazard {
        let loss = sonar.contact_range + millimetres_up(config.range_error);
        let Some(held) = self.held else {
            let range = millimetres_down(config.sonar_range_max);
            let age = elapsed(look.taken_at, look.now);
            return Hazard {
                range,
                clearance: range - loss,
                age,
                way: [way(config.speed_max, age); 2],
                turned: way(config.turn_rate_max, age),
                class: Class::Unknown,
                too_fast: false,
                stuck: false,
            };
        };
        let age = elapsed(held.echo.taken_at, look.now);
        let still = self.is_still(look.now, config);
        let confirmed = self
            .latest
            .is_some_and(|latest| latest.taken_at == held.echo.taken_at);
        let since = &held.echo.odometer;
        let longest = LONGEST as i32;
        Hazard {
            range: held.echo.range,
            clearance: held.echo.range - loss,
            age,
            way: [0, 1]
                .map(|i| (grown(since.way[i], look.odometer.way[i]) + held.lag[0]).min(longest)),
            turned: (grown(since.turned, look.odometer.turned) + held.lag[1]).min(longest),
            class: if still { Class::Still } else { Class::Unknown },
            too_fast: self.excess > 2 * millimetres_up(config.still_tolerance)
                && self.excessive > config.confirm_samples as u32,
            // Only where whatever is there must come nearer as the robot drives on.
            stuck: sonar.closing.face[0] >= 500
                && confirmed
                && look.odometer.way[0].saturating_sub(self.unchanged_since) >= STUCK_WAY,
        }
    }
}

/// The way in mm, rounded up, that `speed` (m/s or rad/s, at most 10) makes in `time` (ms, at most
/// [`LONGEST`]).
fn way(speed: f32, time: i32) -> i32 {
    (millimetres_up(speed) * time + 999) / 1000
}

/// A reading is the echo of one of these walls.
fn is_wall(
    reading: SonarReading,
    sonar: &Sonar,
    walls: &[Option<Wall>; 2],
    config: &Config,
) -> bool {
    let SonarReading::Echo(range) = reading else {
        return false;
    };
    let wall = &walls[usize::from(sonar.axis.y < 0.0)];
    wall.is_some_and(|wall| wall.explains(range.get(), sonar, config))
}

/// A sonar next to sonar `i` hears a still thing that is no farther away than what `i` hears. Next to it
/// is one if no other looks between them.
fn is_beside_still<const N: usize>(
    i: usize,
    sonar: &[SonarReading; N],
    still: &[bool; N],
    ring: &Ring<N>,
    config: &Config,
) -> bool {
    let SonarReading::Echo(range) = sonar[i] else {
        return false;
    };
    let reach = range.get() + config.still_tolerance;
    let heading = ring.sonars()[i].heading;
    let turn = |j: usize| ring.sonars()[j].heading.minus(heading).get();
    let is_next = |j: usize| {
        let between = |k: usize| turn(k) * turn(j) > 0.0 && turn(k).abs() < turn(j).abs();
        j != i && !(0..N).any(between)
    };
    (0..N).any(|j| {
        let nearer = matches!(sonar[j], SonarReading::Echo(other) if other.get() <= reach);
        still[j] && nearer && is_next(j)
    })
}

/// The range of a judged reading in millimetres, rounded down; none if no echo came back.
fn measured(reading: SonarReading) -> Option<i32> {
    match reading {
        SonarReading::Echo(range) => Some(millimetres_down(range.get())),
        SonarReading::TooNear => Some(0),
        SonarReading::NoEcho(_) | SonarReading::Stale | SonarReading::Invalid => None,
    }
}

/// Odometry that was checked; age in ms.
struct Odometry {
    pose: Pose,
    speed: f32,
    turn_rate: f32,
    age: u64,
}

/// Checks the odometry.
fn judge_odometry(
    sample: Option<OdometrySample>,
    now: Instant,
    config: &Config,
) -> Result<Odometry, StopReason> {
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
        Ok(Odometry {
            pose,
            speed: in_range("speed", sample.speed, -10.0, 10.0, "m/s")?,
            turn_rate: in_range("turn rate", sample.turn_rate, -20.0, 20.0, "rad/s")?,
            age,
        })
    };
    checked().map_err(|_: crate::quantity::OutOfRange| StopReason::OdometryInvalid)
}

/// Least range held by the sonars that look within the angle of view of straight ahead.
fn ahead<const N: usize>(hazard: &[Hazard; N], ring: &Ring<N>, config: &Config) -> Length {
    let mut least = length(config.sonar_range_max);
    for (hazard, at) in hazard.iter().zip(ring.sonars()) {
        if at.heading.get().abs() <= config.view_half_angle {
            least = least.min(length(hazard.range as f32 / 1000.0));
        }
    }
    least
}

/// Distance from the robot's centre line to what the sonars that look straight across hear, left
/// and right.
fn beside<const N: usize>(
    sonar: &[SonarReading; N],
    ring: &Ring<N>,
    config: &Config,
) -> [Length; 2] {
    let mut beside = [length(config.sonar_range_max); 2];
    for (reading, at) in sonar.iter().zip(ring.sonars()) {
        let SonarReading::Echo(range) = *reading else {
            continue;
        };
        if at.axis.x.abs() < ACROSS {
            let side = usize::from(at.axis.y < 0.0);
            beside[side] = beside[side].min(length(at.position.y.abs() + range.get()));
        }
    }
    beside
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
