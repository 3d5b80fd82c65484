//! The session with a robot, as a state machine without I/O and without a clock.
//!
//! The caller moves bytes and tells the time; the session decides what to send. So the same code runs
//! in real time over a port and in virtual time inside a test:
//!
//! 1. [`Session::receive`] takes the bytes that arrived, [`Session::next_event`] tells what they meant;
//! 2. [`Session::command`] is called once per tick of the control loop, with what the robot shall do;
//! 3. [`Session::poll`] is called until it returns `None`, and each [`Output`] carried out in order.
//!
//! Once the robot is ready, [`Session::command`] is the only source of motion commands and pulses. A
//! loop that hangs sends nothing, and the robot's own watchdog stops the robot. Nothing here may ever
//! move to a thread or timer of its own: that would feed the watchdog on behalf of a loop that is dead.

use std::collections::VecDeque;
use std::fmt;

use sidestep::arcos::{
    BaseParameters, Configuration, EncodeError, Frame, HostCommand, Identity, MAX_FRAME,
    PacketError, Receiver, Reception, StandardInformation, command, shortest_delta,
};

/// Silence after a `CLOSE` that lets the robot finish its stream before it is greeted anew.
const SETTLE_MS: u64 = 200;
/// Pause before a lost robot is greeted anew.
const BACKOFF_MS: u64 = 1000;
/// Time for the first SIP and the configuration packet after `OPEN`.
const OPEN_MS: u64 = 1000;
/// Time between `HOSTBAUD` and the change of our own baud rate.
const HOSTBAUD_MS: u64 = 10;
/// Time for a first frame at a new baud rate.
const SWITCH_MS: u64 = 900;
/// Time between requests to enable motors and sonars.
const ENABLE_MS: u64 = 500;
/// Time between `CLOSE` commands, and without a SIP until the robot counts as closed.
const CLOSE_MS: u64 = 300;
/// How many `CLOSE` commands a robot that keeps streaming is sent.
const CLOSE_ATTEMPTS: u32 = 5;
/// How far from zero a position counter may be just after `SETO`, in its units.
const ORIGIN_UNITS: u16 = 20;
/// How far from zero the heading may be just after `SETO`: 2°, in its units.
const ORIGIN_ANGLE: u16 = 23;

/// What a session needs to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Baud rates in the order in which they are tried; empty for a transport that has none.
    pub bauds: Vec<u32>,
    /// The baud rate to change to where the robot allows it. A SIP of 16 sonars takes 93 of the 100 ms
    /// of a cycle at 9600.
    pub preferred_baud: Option<u32>,
    /// The base's parameters; `None` to go by the subclass the robot reports.
    pub parameters: Option<BaseParameters>,
    /// Largest translational speed commanded, mm/s.
    pub max_velocity_mm_s: u16,
    /// Largest rotational speed commanded, °/s.
    pub max_rotation_deg_s: u16,
    /// Translational acceleration, mm/s².
    pub acceleration_mm_s2: u16,
    /// Translational deceleration, mm/s².
    pub deceleration_mm_s2: u16,
    /// Rotational acceleration, °/s².
    pub rotational_acceleration_deg_s2: u16,
    /// Rotational deceleration, °/s².
    pub rotational_deceleration_deg_s2: u16,
    /// Time without a valid SIP after which the link counts as lost, ms.
    pub link_timeout_ms: u64,
    /// Time for the answer to a `SYNC`, ms.
    pub reply_timeout_ms: u64,
    /// Greetings without an answer after which the next baud rate is tried.
    pub attempts: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            bauds: vec![9_600, 19_200, 38_400, 57_600, 115_200],
            preferred_baud: Some(38_400),
            parameters: None,
            max_velocity_mm_s: 400,
            max_rotation_deg_s: 60,
            acceleration_mm_s2: 300,
            deceleration_mm_s2: 300,
            rotational_acceleration_deg_s2: 100,
            rotational_deceleration_deg_s2: 100,
            link_timeout_ms: 500,
            reply_timeout_ms: 500,
            attempts: 3,
        }
    }
}

/// What the caller is to do with the transport.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Write these bytes.
    Send(Vec<u8>),
    /// Change the baud rate, once all that was sent has left.
    SetBaud(u32),
    /// Throw away the bytes that have arrived and were not yet passed to [`Session::receive`].
    Discard,
}

/// Who answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Robot {
    /// The name given to this robot.
    pub name: String,
    /// The class, `Pioneer`.
    pub class: String,
    /// The subclass, such as `p3dx`.
    pub subclass: String,
}

/// What the robot has stored, as far as a host needs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stored {
    /// The serial number.
    pub serial: String,
    /// The firmware's version, if it tells.
    pub firmware: Option<String>,
    /// The time between SIPs, ms.
    pub sip_cycle_ms: u8,
    /// The silence after which the robot stops its motors, ms.
    pub watchdog_ms: u16,
    /// The translational speed that no setting can exceed, mm/s.
    pub translational_velocity_top: u16,
    /// The rotational speed that no setting can exceed, °/s.
    pub rotational_velocity_top: u16,
    /// Whether the host may change the baud rate.
    pub baud_switchable: bool,
}

/// Why the robot cannot be driven although it answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The motors are not enabled.
    MotorsDisabled,
    /// No sonar array is on.
    SonarsDisabled,
    /// The odometry has not been set to its origin.
    OdometryNotZeroed,
}

impl fmt::Display for Hindrance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::EmergencyStop => "the emergency stop is pressed",
            Self::MotorsDisabled => "the motors are not enabled",
            Self::SonarsDisabled => "the sonars are not enabled",
            Self::OdometryNotZeroed => "the odometry is not at its origin",
        })
    }
}

/// Why there is no link to a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkLoss {
    /// Nobody answered, at any baud rate (none listed for a transport that has none).
    NoAnswer {
        /// The rates tried.
        bauds: Vec<u32>,
    },
    /// No valid SIP came for this long.
    Silence {
        /// The time since the last one, ms.
        ms: u64,
    },
    /// No frame came after the baud rate was changed, nor after it was changed back.
    BaudSwitch {
        /// The rate that was to be used.
        baud: u32,
    },
    /// The robot's units are not known: name the base in the configuration.
    UnknownSubclass(String),
    /// The transport failed.
    Transport(String),
}

impl fmt::Display for LinkLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswer { bauds } if bauds.is_empty() => f.write_str("no robot answers"),
            Self::NoAnswer { bauds } => write!(f, "no robot answers at any of {bauds:?} baud"),
            Self::Silence { ms } => write!(f, "no valid information packet for {ms} ms"),
            Self::BaudSwitch { baud } => write!(f, "no frame after the change to {baud} baud"),
            Self::UnknownSubclass(subclass) => write!(
                f,
                "the robot is a {subclass:?}, whose units are not known: name its base"
            ),
            Self::Transport(reason) => f.write_str(reason),
        }
    }
}

/// Something received, or asked for, that was not used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// Bytes that belong to no good frame.
    Noise {
        /// How many.
        skipped_bytes: u64,
        /// How many of them began what would have been a frame but for its checksum.
        bad_checksums: u64,
    },
    /// A frame whose checksum is good and whose contents are not.
    Packet {
        /// The frame.
        frame: Vec<u8>,
        /// What is wrong with it.
        error: PacketError,
    },
    /// A command that the protocol cannot express.
    Command(EncodeError),
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Noise {
                skipped_bytes,
                bad_checksums,
            } => write!(
                f,
                "{skipped_bytes} bytes of no frame, {bad_checksums} bad checksums"
            ),
            Self::Packet { error, .. } => error.fmt(f),
            Self::Command(error) => error.fmt(f),
        }
    }
}

/// What happened.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A robot was found with a session of someone else, or of an earlier run, and told to close it.
    AlreadyOpen,
    /// A robot answered.
    Connected {
        /// Who it is.
        robot: Robot,
        /// What its raw units mean.
        parameters: BaseParameters,
    },
    /// The robot told what it has stored.
    Configured(Stored),
    /// The robot did not follow a change of baud rate and stays where it was.
    BaudKept {
        /// The rate it was asked for.
        asked: u32,
        /// The rate in use.
        kept: u32,
    },
    /// The robot streams, but cannot be driven yet. It is asked again and again.
    Waiting(Hindrance),
    /// Motors and sonars are on: [`Session::command`] takes effect.
    Ready {
        /// Whether there was a link before. The odometry's origin is then left alone: where its
        /// counters stand apart from where they stood, the robot's position is no longer known.
        resumed: bool,
    },
    /// A robot that was ready no longer is. It is not enabled again before [`Session::enable`] is
    /// called, because whoever stopped it may have had a reason.
    Disabled(Hindrance),
    /// A valid SIP.
    Information {
        /// Its frame.
        frame: Vec<u8>,
        /// Its contents.
        information: Box<StandardInformation>,
    },
    /// Something was not used.
    Rejected(Rejection),
    /// There is no link. The session tries again by itself, except after
    /// [`LinkLoss::Transport`], when it waits for [`Session::transport_restored`].
    LinkLost(LinkLoss),
    /// The robot no longer streams, or was never reached; the session has ended.
    Closed,
}

/// Which baud rate is being tried during a change of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Switch {
    /// The old one: the robot has just been told.
    Announced,
    /// The new one.
    Trying,
    /// The old one again.
    Reverting,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing is sent, and what arrives is ignored.
    Pausing { until: u64 },
    /// `SYNC` number `awaited` has been sent.
    Syncing {
        awaited: u8,
        attempt: u32,
        deadline: u64,
    },
    /// `OPEN` and `CONFIG` have been sent.
    Opening { deadline: u64 },
    /// `HOSTBAUD` has been sent.
    Switching {
        from: u32,
        to: u32,
        switch: Switch,
        deadline: u64,
    },
    /// Motors and sonars have been asked for.
    Enabling {
        again: u64,
        reported: Option<Hindrance>,
    },
    /// The robot obeys motion commands.
    Ready,
    /// The robot streams, and nothing is asked of it.
    Disabled,
    /// `CLOSE` has been sent.
    Closing {
        attempt: u32,
        heard: bool,
        deadline: u64,
    },
    /// The session has ended.
    Closed,
    /// The transport has failed.
    Detached,
}

/// A session with a robot; see the [module](self).
#[derive(Clone, Debug)]
pub struct Session {
    receiver: Receiver,
    machine: Machine,
}

/// All of the session but its receiver, so that frames can be lent from one to the other.
#[derive(Clone, Debug)]
struct Machine {
    settings: Settings,
    phase: Phase,
    /// Baud rates, those that have worked first.
    rates: Vec<u32>,
    /// Which of them is being tried.
    rate: usize,
    /// The baud rate in use.
    baud: Option<u32>,
    parameters: Option<BaseParameters>,
    /// When the last valid SIP came, or the phase that expects one began.
    heard: u64,
    /// A valid SIP has come since `OPEN`.
    streaming: bool,
    /// The configuration packet's word on changing the baud rate, once it has come.
    switchable: Option<bool>,
    /// What kept the robot from being driven according to the last SIP.
    hindrance: Option<Hindrance>,
    /// The robot was ready before, and so the odometry has its origin.
    resumed: bool,
    /// What has arrived so far is of no use to the present phase.
    stale: bool,
    outputs: VecDeque<Output>,
    events: VecDeque<Event>,
}

impl Session {
    /// A session that greets the robot at the first [`poll`](Self::poll).
    #[must_use]
    pub fn new(settings: Settings, now_ms: u64) -> Self {
        let machine = Machine {
            phase: Phase::Pausing { until: now_ms },
            rates: settings.bauds.clone(),
            rate: 0,
            baud: None,
            parameters: None,
            heard: now_ms,
            streaming: false,
            switchable: None,
            hindrance: None,
            resumed: false,
            stale: false,
            outputs: VecDeque::new(),
            events: VecDeque::new(),
            settings,
        };
        Self {
            receiver: Receiver::new(),
            machine,
        }
    }

    /// Takes in bytes that arrived.
    pub fn receive(&mut self, mut bytes: &[u8], now_ms: u64) {
        if std::mem::take(&mut self.machine.stale) {
            self.receiver.clear();
        }
        let before = self.receiver.reception();
        while let Some(frame) = self.receiver.next_frame(&mut bytes) {
            self.machine.frame(frame, now_ms);
            if self.machine.stale {
                break;
            }
        }
        let after = self.receiver.reception();
        if after.skipped_bytes != before.skipped_bytes {
            self.machine.reject(Rejection::Noise {
                skipped_bytes: after.skipped_bytes - before.skipped_bytes,
                bad_checksums: after.bad_checksums - before.bad_checksums,
            });
        }
    }

    /// What is to be done next with the transport; `None` if nothing for now.
    pub fn poll(&mut self, now_ms: u64) -> Option<Output> {
        self.machine.expire(now_ms);
        self.machine.outputs.pop_front()
    }

    /// What happened next; `None` if nothing more.
    pub fn next_event(&mut self) -> Option<Event> {
        self.machine.events.pop_front()
    }

    /// The control loop's word for this tick: translational speed, mm/s, forward positive, and
    /// rotational speed, °/s, counter-clockwise positive, each brought within the settings. Without
    /// effect unless the robot is ready, except that the watchdog of one that streams is fed.
    pub fn command(&mut self, speed_mm_s: i32, turn_deg_s: i32, now_ms: u64) {
        self.machine.command(speed_mm_s, turn_deg_s, now_ms);
    }

    /// Tells a robot that streams to decelerate to a stop. It stays ready.
    pub fn stop(&mut self, now_ms: u64) {
        self.machine.tell(HostCommand::stop(), now_ms);
    }

    /// Tells a robot that streams to stop with its largest deceleration. It stays ready.
    pub fn emergency_stop(&mut self, now_ms: u64) {
        self.machine.tell(HostCommand::emergency_stop(), now_ms);
    }

    /// Lets a robot that streams beep: pairs of a duration in units of 20 ms and a tone in half cycles.
    pub fn beep(&mut self, tones: &[u8], now_ms: u64) {
        self.machine.tell(HostCommand::say(tones), now_ms);
    }

    /// Asks for motors and sonars again after [`Event::Disabled`].
    pub fn enable(&mut self, now_ms: u64) {
        if self.machine.phase == Phase::Disabled {
            self.machine.enable(now_ms);
        }
    }

    /// Stops the robot and ends the session; [`Event::Closed`] tells when it has ended.
    pub fn close(&mut self, now_ms: u64) {
        self.machine.close(now_ms);
    }

    /// The transport failed: what was still to be sent is dropped.
    pub fn transport_lost(&mut self, reason: impl Into<String>) {
        self.machine.transport_lost(reason.into());
    }

    /// The transport was opened anew: the robot is greeted again.
    pub fn transport_restored(&mut self, now_ms: u64) {
        if self.machine.phase == Phase::Detached {
            self.machine.baud = None;
            self.machine.phase = Phase::Pausing { until: now_ms };
        }
    }

    /// Whether the robot obeys motion commands.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.machine.phase == Phase::Ready
    }

    /// Whether the session has ended.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.machine.phase == Phase::Closed
    }

    /// The baud rate in use, where there is one.
    #[must_use]
    pub fn baud(&self) -> Option<u32> {
        self.machine.baud
    }

    /// What the raw units of the robot that answered last mean.
    #[must_use]
    pub fn parameters(&self) -> Option<&BaseParameters> {
        self.machine.parameters.as_ref()
    }

    /// What was received since the session began.
    #[must_use]
    pub fn reception(&self) -> Reception {
        self.receiver.reception()
    }
}

impl Machine {
    /// Takes in one frame.
    fn frame(&mut self, frame: Frame<'_>, now: u64) {
        let information = StandardInformation::is_kind(frame.number());
        match &mut self.phase {
            Phase::Syncing { .. } if information => {
                self.events.push_back(Event::AlreadyOpen);
                self.send(&[HostCommand::close()]);
                self.pause(now, SETTLE_MS);
            }
            Phase::Syncing { awaited, .. } if *awaited == frame.number() => match *awaited {
                command::SYNC2 => self.identify(frame, now),
                sync => self.sync(sync + 1, now),
            },
            Phase::Closing { heard, .. } => *heard |= information,
            Phase::Opening { .. } | Phase::Enabling { .. } | Phase::Ready | Phase::Disabled => {
                self.listen(frame, now);
            }
            Phase::Switching {
                from, to, switch, ..
            } => {
                let (from, to) = (*from, *to);
                match switch {
                    Switch::Announced => return,
                    Switch::Trying => self.settle_baud(to),
                    Switch::Reverting => {
                        self.settings.preferred_baud = None;
                        self.events.push_back(Event::BaudKept {
                            asked: to,
                            kept: from,
                        });
                        self.settle_baud(from);
                    }
                }
                self.enable(now);
                self.listen(frame, now);
            }
            Phase::Syncing { .. } | Phase::Pausing { .. } | Phase::Closed | Phase::Detached => {}
        }
    }

    /// Takes in one frame of a robot that streams. Packets of other types are none of our business.
    fn listen(&mut self, frame: Frame<'_>, now: u64) {
        let result = match frame.number() {
            kind if StandardInformation::is_kind(kind) => StandardInformation::decode(frame)
                .map(|information| self.inform(frame, information, now)),
            Configuration::NUMBER => {
                Configuration::decode(frame).map(|configuration| self.configure(&configuration))
            }
            _ => Ok(()),
        };
        if let Err(error) = result {
            self.reject(Rejection::Packet {
                frame: frame.as_bytes().to_vec(),
                error,
            });
        }
        if matches!(self.phase, Phase::Opening { .. })
            && self.streaming
            && self.switchable.is_some()
        {
            self.opened(now);
        }
    }

    fn inform(&mut self, frame: Frame<'_>, information: StandardInformation, now: u64) {
        self.heard = now;
        self.streaming = true;
        let hindrance = self.hindrance_in(&information);
        self.hindrance = hindrance;
        self.events.push_back(Event::Information {
            frame: frame.as_bytes().to_vec(),
            information: Box::new(information),
        });
        match (self.phase, hindrance) {
            (Phase::Enabling { .. }, None) => {
                self.phase = Phase::Ready;
                self.events.push_back(Event::Ready {
                    resumed: self.resumed,
                });
                self.resumed = true;
            }
            (Phase::Ready, Some(hindrance)) => {
                self.phase = Phase::Disabled;
                self.events.push_back(Event::Disabled(hindrance));
            }
            _ => {}
        }
    }

    /// What keeps the robot from being driven.
    fn hindrance_in(&self, information: &StandardInformation) -> Option<Hindrance> {
        let near = |counter| shortest_delta(0, counter).unsigned_abs() <= ORIGIN_UNITS;
        let at_origin = near(information.x)
            && near(information.y)
            && information.heading.unsigned_abs() <= ORIGIN_ANGLE;
        if information.e_stop() {
            Some(Hindrance::EmergencyStop)
        } else if !information.motors_enabled() {
            Some(Hindrance::MotorsDisabled)
        } else if !information.sonars_enabled() {
            Some(Hindrance::SonarsDisabled)
        } else if !(self.resumed || at_origin) {
            Some(Hindrance::OdometryNotZeroed)
        } else {
            None
        }
    }

    fn configure(&mut self, configuration: &Configuration<'_>) {
        let baud_switchable = configuration.autobaud == Some(Configuration::SWITCHABLE_BAUD);
        self.switchable = Some(baud_switchable);
        self.events.push_back(Event::Configured(Stored {
            serial: text(configuration.serial),
            firmware: configuration.firmware.map(text),
            sip_cycle_ms: configuration.sip_cycle_ms,
            watchdog_ms: configuration.watchdog_ms,
            translational_velocity_top: configuration.translational_velocity_top,
            rotational_velocity_top: configuration.rotational_velocity_top,
            baud_switchable,
        }));
    }

    /// Does what has become due.
    fn expire(&mut self, now: u64) {
        match self.phase {
            Phase::Pausing { until } if now >= until => self.greet(1, now),
            Phase::Syncing {
                attempt, deadline, ..
            } if now >= deadline => self.retry(attempt, now),
            Phase::Opening { deadline } if now >= deadline => {
                if self.streaming {
                    self.opened(now);
                } else {
                    self.lose(LinkLoss::Silence { ms: OPEN_MS }, now);
                }
            }
            Phase::Switching {
                from,
                to,
                switch,
                deadline,
            } if now >= deadline => match switch {
                Switch::Announced => self.try_baud(from, to, Switch::Trying, now),
                Switch::Trying => self.try_baud(from, to, Switch::Reverting, now),
                Switch::Reverting => self.lose(LinkLoss::BaudSwitch { baud: to }, now),
            },
            Phase::Enabling { .. } | Phase::Ready | Phase::Disabled
                if now.saturating_sub(self.heard) >= self.settings.link_timeout_ms =>
            {
                let ms = now.saturating_sub(self.heard);
                self.lose(LinkLoss::Silence { ms }, now);
            }
            Phase::Enabling { again, reported } if now >= again => {
                if let Some(hindrance) = self.hindrance
                    && reported != self.hindrance
                {
                    self.events.push_back(Event::Waiting(hindrance));
                }
                self.ask_for_motors(now, self.hindrance);
            }
            Phase::Closing {
                attempt,
                heard,
                deadline,
            } if now >= deadline => {
                if heard && attempt < CLOSE_ATTEMPTS {
                    self.send_close(attempt + 1, now);
                } else {
                    self.finish();
                }
            }
            _ => {}
        }
    }

    /// Greets the robot at the baud rate whose turn it is.
    fn greet(&mut self, attempt: u32, now: u64) {
        if let Some(baud) = self.rates.get(self.rate).copied() {
            self.set_baud(baud);
        }
        self.discard();
        self.phase = Phase::Syncing {
            awaited: command::SYNC0,
            attempt,
            deadline: now,
        };
        self.sync(command::SYNC0, now);
    }

    fn sync(&mut self, number: u8, now: u64) {
        if let Phase::Syncing {
            awaited, deadline, ..
        } = &mut self.phase
        {
            *awaited = number;
            *deadline = now.saturating_add(self.settings.reply_timeout_ms);
            self.send(&[HostCommand::plain(number)]);
        }
    }

    /// Greets again, at the next baud rate if this one has been tried often enough.
    fn retry(&mut self, attempt: u32, now: u64) {
        if attempt < self.settings.attempts {
            return self.greet(attempt + 1, now);
        }
        self.rate += 1;
        if self.rate >= self.rates.len() {
            self.rate = 0;
            let bauds = self.rates.clone();
            self.events
                .push_back(Event::LinkLost(LinkLoss::NoAnswer { bauds }));
        }
        self.greet(1, now);
    }

    fn identify(&mut self, frame: Frame<'_>, now: u64) {
        let identity = match Identity::decode(frame) {
            Ok(identity) => identity,
            Err(error) => {
                let frame = frame.as_bytes().to_vec();
                return self.reject(Rejection::Packet { frame, error });
            }
        };
        let known = BaseParameters::for_subclass(identity.subclass);
        let Some(parameters) = self.settings.parameters.or(known) else {
            return self.lose(LinkLoss::UnknownSubclass(text(identity.subclass)), now);
        };
        self.parameters = Some(parameters);
        if let Some(baud) = self.baud {
            self.settle_baud(baud);
        }
        self.events.push_back(Event::Connected {
            robot: Robot {
                name: text(identity.name),
                class: text(identity.class),
                subclass: text(identity.subclass),
            },
            parameters,
        });
        self.streaming = false;
        self.switchable = None;
        self.hindrance = None;
        self.send(&[HostCommand::open(), HostCommand::request_configuration()]);
        self.phase = Phase::Opening {
            deadline: now.saturating_add(OPEN_MS),
        };
    }

    /// Goes on to a better baud rate, if there is one and the robot allows it.
    fn opened(&mut self, now: u64) {
        if let (Some(true), Some(from), Some(to)) =
            (self.switchable, self.baud, self.settings.preferred_baud)
            && from != to
            && let Some(command) = HostCommand::host_baud(to)
        {
            self.send(&[command]);
            let deadline = now.saturating_add(HOSTBAUD_MS);
            self.phase = Phase::Switching {
                from,
                to,
                switch: Switch::Announced,
                deadline,
            };
        } else {
            self.enable(now);
        }
    }

    fn try_baud(&mut self, from: u32, to: u32, switch: Switch, now: u64) {
        self.set_baud(if switch == Switch::Trying { to } else { from });
        self.discard();
        self.send(&[HostCommand::pulse()]);
        let deadline = now.saturating_add(SWITCH_MS);
        self.phase = Phase::Switching {
            from,
            to,
            switch,
            deadline,
        };
    }

    /// Remembers a baud rate that works: it is tried first when the robot is greeted again.
    fn settle_baud(&mut self, baud: u32) {
        self.rates.retain(|rate| *rate != baud);
        self.rates.insert(0, baud);
        self.rate = 0;
    }

    /// Asks for all that driving needs.
    fn enable(&mut self, now: u64) {
        self.heard = now;
        let settings = &self.settings;
        let limits = [
            HostCommand::acceleration(settings.acceleration_mm_s2),
            HostCommand::deceleration(settings.deceleration_mm_s2),
            HostCommand::rotational_acceleration(settings.rotational_acceleration_deg_s2),
            HostCommand::rotational_deceleration(settings.rotational_deceleration_deg_s2),
            HostCommand::maximum_velocity(settings.max_velocity_mm_s),
            HostCommand::maximum_rotation(settings.max_rotation_deg_s),
        ];
        self.send(&limits);
        self.ask_for_motors(now, None);
    }

    fn ask_for_motors(&mut self, now: u64, reported: Option<Hindrance>) {
        if !self.resumed {
            self.send(&[HostCommand::zero_odometry()]);
        }
        self.send(&[
            HostCommand::enable_sonars(true),
            HostCommand::enable_motors(true),
        ]);
        self.phase = Phase::Enabling {
            again: now.saturating_add(ENABLE_MS),
            reported,
        };
    }

    fn command(&mut self, speed: i32, turn: i32, now: u64) {
        self.expire(now);
        match self.phase {
            Phase::Ready => {
                let speed_limit = i32::from(self.settings.max_velocity_mm_s);
                let turn_limit = i32::from(self.settings.max_rotation_deg_s);
                self.send(&[
                    HostCommand::velocity(speed.clamp(-speed_limit, speed_limit)),
                    HostCommand::rotation(turn.clamp(-turn_limit, turn_limit)),
                ]);
            }
            Phase::Enabling { .. } | Phase::Disabled => self.send(&[HostCommand::pulse()]),
            _ => {}
        }
    }

    /// Sends a command that matters only to a robot that streams.
    fn tell(&mut self, command: HostCommand<'_>, now: u64) {
        self.expire(now);
        if self.is_open() {
            self.send(&[command]);
        }
    }

    /// Whether the robot has been told to open, and not since to close.
    const fn is_open(&self) -> bool {
        matches!(
            self.phase,
            Phase::Opening { .. }
                | Phase::Switching { .. }
                | Phase::Enabling { .. }
                | Phase::Ready
                | Phase::Disabled
        )
    }

    /// Tells a robot that may still hear us to stop, and begins anew after a pause.
    fn lose(&mut self, reason: LinkLoss, now: u64) {
        self.drop_unsent();
        if self.is_open() {
            self.send(&[HostCommand::emergency_stop(), HostCommand::close()]);
        }
        self.events.push_back(Event::LinkLost(reason));
        self.pause(now, BACKOFF_MS);
    }

    /// Drops commands given before things changed, but no change of the baud rate.
    fn drop_unsent(&mut self) {
        self.outputs
            .retain(|output| !matches!(output, Output::Send(_)));
    }

    fn pause(&mut self, now: u64, ms: u64) {
        self.stale = true;
        self.phase = Phase::Pausing {
            until: now.saturating_add(ms),
        };
    }

    fn transport_lost(&mut self, reason: String) {
        self.outputs.clear();
        self.stale = true;
        match self.phase {
            Phase::Closed | Phase::Detached => {}
            Phase::Closing { .. } => self.finish(),
            _ => {
                self.events
                    .push_back(Event::LinkLost(LinkLoss::Transport(reason)));
                self.phase = Phase::Detached;
            }
        }
    }

    fn close(&mut self, now: u64) {
        match self.phase {
            Phase::Closing { .. } | Phase::Closed => {}
            _ if self.is_open() => {
                self.drop_unsent();
                self.send(&[HostCommand::stop()]);
                self.send_close(1, now);
            }
            // To a robot that is being greeted, the number of CLOSE would mean SYNC2.
            _ => self.finish(),
        }
    }

    fn send_close(&mut self, attempt: u32, now: u64) {
        self.send(&[HostCommand::close()]);
        let deadline = now.saturating_add(CLOSE_MS);
        self.phase = Phase::Closing {
            attempt,
            heard: false,
            deadline,
        };
    }

    fn finish(&mut self) {
        self.phase = Phase::Closed;
        self.events.push_back(Event::Closed);
    }

    fn set_baud(&mut self, baud: u32) {
        if self.baud != Some(baud) {
            self.baud = Some(baud);
            self.outputs.push_back(Output::SetBaud(baud));
        }
    }

    fn discard(&mut self) {
        self.stale = true;
        self.outputs.push_back(Output::Discard);
    }

    /// Queues commands as one write.
    fn send(&mut self, commands: &[HostCommand<'_>]) {
        let mut bytes = Vec::new();
        for command in commands {
            match command.encode(&mut [0; MAX_FRAME]) {
                Ok(frame) => bytes.extend_from_slice(frame.as_bytes()),
                Err(error) => self.reject(Rejection::Command(error)),
            }
        }
        self.outputs.push_back(Output::Send(bytes));
    }

    fn reject(&mut self, rejection: Rejection) {
        self.events.push_back(Event::Rejected(rejection));
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
