//! The control loop without I/O: session, base, controller and log, advanced by bytes and time.
//!
//! The same code drives a robot in real time and a simulated one in virtual time.

use crate::base::{self, Base};
use crate::config::RobotConfig;
use crate::log::{Halt, Header, Record, Told, to_hex, write_line};
use crate::session::{Event, Output, Session, Settings};
use nalgebra::Vector2;
use sidestep::arcos::BaseParameters;
use sidestep::avoid::Avoid;
use sidestep::config::Config;
use sidestep::controller::{Controller, Decision};
use sidestep::escape::Escape;
use sidestep::failsafe::{Action, StopReason};
use sidestep::law::Law;
use sidestep::observation::Observation;
use sidestep::quantity::{Instant, OutOfRange};
use sidestep::ring::Ring;
use std::collections::{BTreeMap, VecDeque};
use std::io::Write;

/// What a run has come to so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Ticks of the controller.
    pub ticks: u64,
    /// Longest time between two ticks, ms.
    pub worst_period: u64,
    /// Longest computation of a tick, µs, as the caller measured it.
    pub worst_tick: u64,
    /// How often each reason made the robot stop: stops begun, by the kind of reason.
    pub stops: BTreeMap<String, u64>,
    /// Bytes that belong to no good frame, and packets that were refused.
    pub rejected: u64,
    /// The goal was reached at this time, ms.
    pub arrived: Option<u64>,
}

/// A stop as it began, to be shown.
#[derive(Clone, Debug, PartialEq)]
pub struct StopBegun {
    /// When, ms.
    pub t: u64,
    /// Where the robot believed to be, metres in the odometry frame; none without odometry.
    pub position: Option<[f32; 2]>,
    /// Why.
    pub reason: StopReason,
}

/// The control loop.
pub struct Pilot<L, const N: usize> {
    session: Session,
    config: RobotConfig,
    goal: Vector2<f32>,
    base: Base<N>,
    controller: Controller<L, N>,
    log: Box<dyn Write + Send>,
    log_error: Option<String>,
    /// What the log calls the law.
    law_name: &'static str,
    header_written: bool,
    events: VecDeque<(u64, String)>,
    /// Events from before the log began.
    before: Vec<(u64, String)>,
    last_tick: Option<u64>,
    stop: Option<StopReason>,
    latest: Option<Decision<N>>,
    tally: Tally,
    stops: Vec<StopBegun>,
    /// Why there is no link, if there was one.
    lost: Option<String>,
    /// The base's counters have jumped.
    position_lost: bool,
    /// Since when the robot has stood still although it is told to move.
    disobeys: Option<u64>,
}

/// The session's settings for a configuration: the base's own limits follow the shield's model.
#[must_use]
pub fn settings(config: &RobotConfig, serial: bool, baud: Option<u32>) -> Settings {
    let core = &config.core;
    let whole = |value: f32| value.clamp(1.0, 65_535.0) as u16;
    let defaults = Settings::default();
    Settings {
        bauds: match (serial, baud) {
            (false, _) => Vec::new(),
            (true, Some(baud)) => vec![baud],
            (true, None) => defaults.bauds,
        },
        preferred_baud: if serial {
            defaults.preferred_baud
        } else {
            None
        },
        max_velocity_mm_s: whole(core.speed_max * 1000.0),
        max_rotation_deg_s: whole(core.turn_rate_max.to_degrees().ceil()),
        acceleration_mm_s2: whole(core.acceleration * 1000.0),
        // The shield counts on this much; the base is told to brake that hard.
        deceleration_mm_s2: whole((core.braking * 1000.0).ceil()),
        rotational_acceleration_deg_s2: whole(core.turn_acceleration.to_degrees()),
        rotational_deceleration_deg_s2: whole(core.turn_acceleration.to_degrees()),
        link_timeout_ms: (core.odometry_age_max * 1000.0) as u64,
        ..defaults
    }
}

/// What a log calls the law that drives unless another is asked for.
pub const USUAL_LAW: &str = "avoid";

/// The law that drives unless another is asked for: S1's, with a way out of where it is stuck.
pub type UsualLaw<const N: usize> = Escape<Avoid, N>;

/// The usual law for a ring of sonars.
#[must_use]
pub fn usual_law<const N: usize>(config: Config, ring: Ring<N>) -> UsualLaw<N> {
    Escape::new(Avoid::new(config), config, ring)
}

impl<const N: usize> Pilot<UsualLaw<N>, N> {
    /// A pilot with the usual law, to a goal (metres) in the frame in which the robot starts at (0, 0)
    /// looking along x.
    ///
    /// # Errors
    /// [`OutOfRange`] if the goal is, or the ring does not fit.
    pub fn new(
        config: RobotConfig,
        goal: [f32; 2],
        settings: Settings,
        log: Box<dyn Write + Send>,
    ) -> Result<Self, OutOfRange> {
        let law = usual_law(config.core, base::ring(&config)?);
        Self::with_law(law, config, goal, settings, log)
    }
}

impl<L: Law<N>, const N: usize> Pilot<L, N> {
    /// A pilot with any law.
    ///
    /// # Errors
    /// [`OutOfRange`] if the goal is, or the ring does not fit.
    pub fn with_law(
        law: L,
        config: RobotConfig,
        goal: [f32; 2],
        settings: Settings,
        log: Box<dyn Write + Send>,
    ) -> Result<Self, OutOfRange> {
        let goal = Vector2::new(goal[0], goal[1]);
        Ok(Self {
            session: Session::new(settings, 0),
            config,
            goal,
            base: Base::new(BaseParameters::P3DX_SH, &config),
            controller: Controller::new(config.core, base::ring(&config)?, law, goal)?,
            log,
            log_error: None,
            law_name: USUAL_LAW,
            header_written: false,
            events: VecDeque::new(),
            before: Vec::new(),
            last_tick: None,
            stop: None,
            latest: None,
            tally: Tally::default(),
            stops: Vec::new(),
            lost: None,
            position_lost: false,
            disobeys: None,
        })
    }

    /// Says what the log is to call the law, so that a replay knows which one it was.
    pub const fn set_law_name(&mut self, name: &'static str) {
        self.law_name = name;
    }

    /// Takes in bytes from the robot, and ticks the controller for every packet among them.
    pub fn receive(&mut self, bytes: &[u8], now: u64) {
        self.session.receive(bytes, now);
        self.handle_events(now);
    }

    /// What is to be done with the transport next.
    pub fn poll(&mut self, now: u64) -> Option<Output> {
        // The promise counts on a command within the reaction time; the rest of it is the base's
        // delay and the sensors' age. A packet that is late is not waited for.
        let patience = (self.config.core.reaction_time * 700.0) as u64;
        let late = |last| now >= last + patience;
        if self.session.is_ready() && self.last_tick.is_some_and(late) {
            self.halt(Halt::LinkLost, now);
        }
        let output = self.session.poll(now);
        self.handle_events(now);
        output
    }

    fn handle_events(&mut self, now: u64) {
        while let Some(event) = self.session.next_event() {
            match event {
                Event::Information { frame, information } => {
                    let observation = self.base.observe(&information, Instant(now));
                    if self.base.is_lost() && !self.position_lost {
                        self.position_lost = true;
                        self.note(
                            now,
                            "the robot's counters have jumped: its position is no longer known; \
                             start again with a new goal"
                                .to_owned(),
                        );
                    }
                    self.watch_obedience(&observation, now);
                    let decision = self.controller.tick(&observation);
                    self.tick(now, &decision, |t, told| Record::Tick {
                        t,
                        sip: to_hex(&frame),
                        told,
                    });
                }
                Event::Connected { robot, parameters } => {
                    // After a lost link the robot is where its counters say, as before.
                    if !self.header_written {
                        self.base = Base::new(parameters, &self.config);
                        self.begin_log(parameters.subclass);
                    }
                    self.note(
                        now,
                        format!(
                            "connected to {} ({} {})",
                            robot.name, robot.class, robot.subclass
                        ),
                    );
                }
                Event::LinkLost(loss) => {
                    self.lost = Some(loss.to_string());
                    self.note(now, format!("link lost: {loss}"));
                    // Before the log begins nothing has been told to move, and a replay would not
                    // know of this stop.
                    if self.header_written {
                        self.halt(Halt::LinkLost, now);
                    }
                }
                Event::Rejected(rejection) => {
                    self.tally.rejected += 1;
                    self.note(now, format!("rejected: {rejection}"));
                }
                Event::Disabled(hindrance) => {
                    self.note(now, format!("no longer ready: {hindrance}"));
                }
                Event::Waiting(hindrance) => self.note(now, format!("waiting: {hindrance}")),
                Event::Ready { resumed } => {
                    self.lost = None;
                    if !resumed {
                        self.base.restart();
                        self.write(&Record::Origin { t: now });
                    }
                    self.note(
                        now,
                        if resumed { "ready again" } else { "ready" }.to_owned(),
                    );
                    self.note(now, promise(&self.config.core));
                }
                Event::AlreadyOpen => {
                    self.note(now, "closed a session that was open already".to_owned());
                }
                Event::Configured(stored) => {
                    self.note(
                        now,
                        format!(
                            "packets every {} ms, watchdog {} ms",
                            stored.sip_cycle_ms, stored.watchdog_ms
                        ),
                    );
                    if stored.watchdog_ms == 0 {
                        self.note(
                            now,
                            "the base's watchdog is off: set it, or nothing stops the robot when \
                             this program or the line fails"
                                .to_owned(),
                        );
                    }
                }
                Event::BaudKept { asked, kept } => {
                    self.note(now, format!("baud rate stays {kept}, asked for {asked}"));
                }
                Event::Closed => self.note(now, "closed".to_owned()),
            }
        }
    }

    /// Says so when the robot stands still although it is told to move: commands may not arrive.
    fn watch_obedience(&mut self, observation: &Observation<N>, now: u64) {
        let told = self
            .latest
            .as_ref()
            .is_some_and(|decision| decision.command.speed() > 20);
        let still = observation
            .odometry
            .is_some_and(|odometry| odometry.speed.abs() < 0.005);
        if !(told && still) {
            self.disobeys = None;
            return;
        }
        let since = *self.disobeys.get_or_insert(now);
        if since != u64::MAX && now >= since + 1000 {
            // Said once, until it moves again.
            self.disobeys = Some(u64::MAX);
            self.note(
                now,
                "the robot is told to move and stands still: do commands arrive?".to_owned(),
            );
        }
    }

    /// Carries out a decision and records it.
    fn tick(&mut self, now: u64, decision: &Decision<N>, record: impl FnOnce(u64, Told) -> Record) {
        let command = decision.command;
        self.session
            .command(command.speed(), degrees(command.turn_rate()), now);
        self.tally.ticks += 1;
        if let Some(last) = self.last_tick {
            self.tally.worst_period = self.tally.worst_period.max(now.saturating_sub(last));
        }
        self.last_tick = Some(now);
        if decision.mode == "arrived" && self.tally.arrived.is_none() {
            self.tally.arrived = Some(now);
        }
        // A stop begins where there was none, or where its kind changes.
        let kind = |reason: &StopReason| std::mem::discriminant(reason);
        if let Some(reason) = decision.stop
            && self.stop.as_ref().map(kind) != Some(kind(&reason))
        {
            *self
                .tally
                .stops
                .entry(reason.row().cause.to_owned())
                .or_default() += 1;
            let position = decision
                .view
                .map(|view| [view.pose.position.x, view.pose.position.y]);
            self.stops.push(StopBegun {
                t: now,
                position,
                reason,
            });
        }
        self.stop = decision.stop;
        self.latest = Some(*decision);
        let record = record(now, told(decision));
        self.write(&record);
    }

    /// Stops for something that no packet shows.
    pub fn halt(&mut self, reason: Halt, now: u64) {
        let decision = self.controller.halt(reason.into(), Instant(now));
        self.tick(now, &decision, |t, told| Record::Halt { t, reason, told });
    }

    /// Lets the robot go on after a latched stop, once nothing demands a stop any more.
    pub fn reset(&mut self, now: u64) {
        self.controller.reset();
        self.write(&Record::Reset { t: now });
        self.note(now, "reset by the operator".to_owned());
    }

    /// Lets the base beep; see [`crate::announce::beeps`].
    pub fn beep(&mut self, tones: &[u8], now: u64) {
        self.session.beep(tones, now);
    }

    /// Stops the robot and ends the session.
    pub fn close(&mut self, now: u64) {
        self.halt(Halt::Operator, now);
        self.session.stop(now);
        self.session.close(now);
    }

    /// The port failed.
    pub fn transport_lost(&mut self, reason: &str, now: u64) {
        self.session.transport_lost(reason);
        self.handle_events(now);
    }

    /// The port is open again.
    pub fn transport_restored(&mut self, now: u64) {
        self.session.transport_restored(now);
        self.handle_events(now);
    }

    /// Notes how long the caller measured a tick to take, in µs.
    pub fn measured(&mut self, micros: u64) {
        self.tally.worst_tick = self.tally.worst_tick.max(micros);
    }

    fn begin_log(&mut self, subclass: &str) {
        if !self.header_written {
            self.header_written = true;
            let header = Header {
                law: self.law_name.to_owned(),
                ..Header::new(&self.config, subclass, [self.goal.x, self.goal.y])
            };
            self.write(&header);
            // What happened before the robot said who it is.
            for (t, text) in std::mem::take(&mut self.before) {
                self.write(&Record::Event { t, text });
            }
        }
    }

    /// Shows and records something to know.
    pub fn note(&mut self, t: u64, text: String) {
        if self.header_written {
            self.write(&Record::Event {
                t,
                text: text.clone(),
            });
        } else {
            self.before.push((t, text.clone()));
        }
        self.events.push_back((t, text));
    }

    fn write(&mut self, line: &impl serde::Serialize) {
        if !self.header_written {
            return;
        }
        if let Err(error) = write_line(&mut self.log, line) {
            // The robot is still driven safely, but the run must not look recorded.
            self.log_error.get_or_insert_with(|| error.to_string());
        }
    }

    /// What happened since this was last asked, with times in ms.
    pub fn next_event(&mut self) -> Option<(u64, String)> {
        self.events.pop_front()
    }

    /// What the controller decided last.
    pub const fn latest(&self) -> Option<&Decision<N>> {
        self.latest.as_ref()
    }

    /// The law.
    pub const fn law(&self) -> &L {
        self.controller.law()
    }

    /// The law, to tell it what no packet holds: a laser scan, another route.
    pub const fn law_mut(&mut self) -> &mut L {
        self.controller.law_mut()
    }

    /// What the run has come to.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }

    /// The stops as they began.
    pub fn stops(&self) -> &[StopBegun] {
        &self.stops
    }

    /// Why the log is not complete, if it is not.
    pub fn log_error(&self) -> Option<&str> {
        self.log_error.as_deref()
    }

    /// The session.
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// Why there is no link, if there was one.
    pub fn lost(&self) -> Option<&str> {
        self.lost.as_deref()
    }
}

impl From<Halt> for StopReason {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::LinkLost => Self::LinkLost,
            Halt::Operator => Self::Operator,
        }
    }
}

/// The promise in force, in words.
#[must_use]
pub fn promise(config: &Config) -> String {
    let heard_twice = if config.appear_samples >= 2.0 {
        "; what appears out of nowhere from when it is heard twice"
    } else {
        ""
    };
    format!(
        "promise: at rest before contact with people and whatever is unknown up to {:.2} m/s, and \
         with what has been seen to stand still up to {:.2} m/s, {:.2} m/s while turning on the \
         spot{heard_twice}",
        config.obstacle_speed_max, config.still_speed_max, config.still_speed_max_turning,
    )
}

/// A decision as it is logged.
#[must_use]
pub fn told<const N: usize>(decision: &Decision<N>) -> Told {
    Told {
        v: decision.command.speed(),
        w: decision.command.turn_rate(),
        mode: decision.mode.to_owned(),
        action: (decision.action != Action::Run).then(|| decision.action.to_string()),
        stop: decision.stop.map(|reason| reason.to_string()),
        limit: decision.limit.map(|limit| limit.to_string()),
    }
}

/// Milliradians in whole degrees, towards zero: the protocol has no finer turn rates.
fn degrees(milliradians: i32) -> i32 {
    (f64::from(milliradians) / 1000.0).to_degrees() as i32
}
