//! The robot's side of the ARCOS protocol, sans I/O: bytes in, bytes out, time as an argument.
//!
//! What it does is what the protocol's fact sheet (chapter `arcos` of the law book) demands of a
//! robot. In particular, and unlike a simulator in wide use, it ignores everything but `SYNC0`
//! before a session, starts with the motors disabled, and **stops by itself** when no command has
//! arrived for the time of its watchdog.
//!
//! Not known from any source, and chosen so that a host cannot rely on it: sonars start switched
//! off, and `CLOSE` takes the port back to the baud rate it started with.

use sidestep::arcos::{
    Argument, BaseParameters, Configuration, EncodeError, Frame, FrameWriter, HostCommand,
    Identity, MAX_FRAME, Receiver, SonarReading, SonarReadings, StandardInformation, Tail, command,
};

use crate::STEP_MS;
use crate::base::{self, Activity, Base, Order};
use crate::compass::{self, Compass};
use crate::error::{Error, require};
use crate::geometry::Pose;
use crate::sonar::{self, Ring};
use crate::uart;
use crate::world::World;

/// The rates the host port can be set to, by the code of `HOSTBAUD` (baud).
pub const BAUDS: [u32; 5] = [9600, 19_200, 38_400, 57_600, 115_200];

/// Bytes that wait for a host that does not read; more are lost.
const OUTGOING_LIMIT: usize = 64 * 1024;

/// Sonars of one array; each array fires its sonars one after the other.
const ARRAY: usize = 8;

/// Battery voltage reported, and the one at which such a robot complains (dV).
const BATTERY: u8 = 129;
const LOW_BATTERY: u16 = 115;

/// The class of robot that it introduces itself as.
const CLASS: &[u8] = b"Pioneer";

/// Where the number of sonar readings stands among the arguments of an SIP.
const SONAR_COUNT: usize = 18;

/// When the sonars fire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firing {
    /// All of them right before each SIP, as simulators do.
    All,
    /// In each array one after the other, as real bases do: an SIP holds those that fired since the
    /// last.
    RoundRobin {
        /// Time between two pings of an array, in whole steps of [`STEP_MS`] (ms).
        ping_ms: u64,
    },
}

/// What kind of robot it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// The name given to this robot, at most 64 bytes.
    pub name: String,
    /// Its subclass, units and sonar placements.
    pub units: BaseParameters,
    /// Sonars fitted: the front array of 8, or 16 all round.
    pub sonars: usize,
    /// When they fire.
    pub firing: Firing,
    /// What they are like.
    pub sonar: sonar::Parameters,
    /// The drive.
    pub base: base::Parameters,
    /// The compass, if fitted.
    pub compass: Option<compass::Parameters>,
    /// Silence after which the robot stops itself, in 100..=65535 (ms).
    pub watchdog_ms: u16,
    /// Time between SIPs, in 20..=250, in whole steps of [`STEP_MS`] (ms).
    pub sip_cycle_ms: u8,
    /// The rate at which the host port starts: one of [`BAUDS`].
    pub host_baud: u32,
    /// Whether the first SIP after the sonars were switched from off to on claims readings that it
    /// does not hold, with a good checksum, as observed of a simulator in wide use.
    pub hollow_sip: bool,
}

impl Default for Parameters {
    /// A P3-DX with the SH2 controller, 16 sonars and a compass.
    fn default() -> Self {
        Self {
            name: "sidestep".to_owned(),
            units: BaseParameters::P3DX_SH,
            sonars: 16,
            firing: Firing::All,
            sonar: sonar::Parameters::default(),
            base: base::Parameters::default(),
            compass: Some(compass::Parameters::default()),
            watchdog_ms: 2000,
            sip_cycle_ms: 100,
            host_baud: 9600,
            hollow_sip: false,
        }
    }
}

impl Parameters {
    fn check(&self) -> Result<(), Error> {
        require(
            "robot.name",
            self.name.len() as f64,
            "at most 64 bytes",
            |n| n <= 64.0,
        )?;
        require(
            "robot.sonars",
            self.sonars as f64,
            "8 or 16, as placed",
            |n| (n == 8.0 || n == 16.0) && self.sonars <= self.units.sonars.len(),
        )?;
        require(
            "robot.watchdog_ms",
            self.watchdog_ms.into(),
            "100..=65535 ms",
            |t| t >= 100.0,
        )?;
        require(
            "robot.sip_cycle_ms",
            self.sip_cycle_ms.into(),
            "20..=250 ms, in steps of 10",
            |t| (20.0..=250.0).contains(&t) && t % 10.0 == 0.0,
        )?;
        if let Firing::RoundRobin { ping_ms } = self.firing {
            require(
                "robot.ping_ms",
                ping_ms as f64,
                "10..=1000 ms, in steps of 10",
                valid_ping,
            )?;
        }
        baud_code(self.host_baud).map(|_| ())
    }
}

fn valid_ping(ms: f64) -> bool {
    (10.0..=1000.0).contains(&ms) && ms % STEP_MS as f64 == 0.0
}

fn baud_code(baud: u32) -> Result<u8, Error> {
    match BAUDS.iter().zip(0..).find(|(known, _)| **known == baud) {
        Some((_, code)) => Ok(code),
        None => Err(Error::OutOfRange {
            field: "robot.host_baud",
            value: baud.into(),
            allowed: "9600, 19200, 38400, 57600 or 115200 baud",
        }),
    }
}

/// How far a host has got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Session {
    /// Nothing but `SYNC0` is answered.
    Unsynchronised,
    /// `SYNC0` was echoed.
    Synchronised0,
    /// `SYNC1` was echoed.
    Synchronised1,
    /// `SYNC2` was answered with the robot's identity; `OPEN` is next.
    Identified,
    /// Commands are obeyed and SIPs are sent.
    Open,
}

/// A robot that speaks ARCOS.
#[derive(Debug, Clone)]
pub struct ArcosRobot {
    parameters: Parameters,
    base: Base,
    ring: Ring,
    compass: Option<Compass>,
    session: Session,
    receiver: Receiver,
    outgoing: Vec<u8>,
    baud: u32,
    now_ms: u64,
    last_command_ms: u64,
    watchdog_tripped: bool,
    /// When the session was opened, from which SIPs are counted (ms).
    opened_ms: u64,
    motors: bool,
    e_stop: bool,
    /// Which arrays are switched on.
    arrays: [bool; 2],
    /// Whether the next SIP is to be hollow.
    hollow: bool,
    /// Pings since the sonars were switched on.
    pings: usize,
    last_ping_ms: u64,
    readings: SonarReadings,
}

impl ArcosRobot {
    /// A robot at rest at `pose`, without a session; all its noise follows from `seed`.
    pub fn new(parameters: Parameters, pose: Pose, seed: u64) -> Result<Self, Error> {
        parameters.check()?;
        let placements = parameters.units.sonars.get(..parameters.sonars);
        let ring = Ring::new(placements.unwrap_or_default(), parameters.sonar, seed)?;
        // A seed of its own: the same one would repeat the first sonar's noise.
        let compass = parameters
            .compass
            .map(|compass| Compass::new(compass, !seed))
            .transpose()?;
        Ok(Self {
            base: Base::new(parameters.base, pose)?,
            ring,
            compass,
            session: Session::Unsynchronised,
            receiver: Receiver::new(),
            outgoing: Vec::new(),
            baud: parameters.host_baud,
            now_ms: 0,
            last_command_ms: 0,
            watchdog_tripped: false,
            opened_ms: 0,
            motors: false,
            e_stop: false,
            arrays: [false; 2],
            hollow: false,
            pings: 0,
            last_ping_ms: 0,
            readings: SonarReadings::new(),
            parameters,
        })
    }

    /// What kind of robot it is.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The drive: true pose, odometry, speeds.
    #[must_use]
    pub fn base(&self) -> &Base {
        &self.base
    }

    /// The drive, to give it faults.
    pub fn base_mut(&mut self) -> &mut Base {
        &mut self.base
    }

    /// The sonars.
    #[must_use]
    pub fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The sonars, to give them faults.
    pub fn ring_mut(&mut self) -> &mut Ring {
        &mut self.ring
    }

    /// How far the host has got.
    #[must_use]
    pub fn session(&self) -> Session {
        self.session
    }

    /// Whether the motors are enabled.
    #[must_use]
    pub fn motors_enabled(&self) -> bool {
        self.motors
    }

    /// Whether the robot stopped itself because the host was silent, and has heard nothing since.
    #[must_use]
    pub fn watchdog_tripped(&self) -> bool {
        self.watchdog_tripped
    }

    /// The rate at which the host port listens and sends (baud).
    #[must_use]
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// Presses or releases the emergency stop button, which disables the motors.
    pub fn press_e_stop(&mut self, pressed: bool) {
        self.e_stop = pressed;
        if pressed {
            self.disable_motors();
        }
    }

    /// Takes bytes from a host that sends at the right rate.
    pub fn receive(&mut self, bytes: &[u8]) {
        let mut input = bytes;
        // The receiver is set aside while the robot answers the frames that it lends.
        let mut receiver = std::mem::take(&mut self.receiver);
        while let Some(frame) = receiver.next_frame(&mut input) {
            self.last_command_ms = self.now_ms;
            self.watchdog_tripped = false;
            self.obey(&HostCommand::decode(frame));
        }
        self.receiver = receiver;
    }

    /// Takes bytes that a host sends at `baud`.
    pub fn receive_at(&mut self, baud: u32, bytes: &[u8]) {
        self.receive(&uart::heard(bytes, baud, self.baud));
    }

    /// The bytes sent since the last call.
    #[must_use]
    pub fn transmit(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// What a host that listens at `baud` makes of the bytes sent since the last call.
    #[must_use]
    pub fn transmit_at(&mut self, baud: u32) -> Vec<u8> {
        uart::heard(&self.transmit(), self.baud, baud)
    }

    /// The host's end of the line was closed: what was under way is lost. The robot does not notice
    /// otherwise.
    pub fn hang_up(&mut self) {
        self.receiver.clear();
        self.outgoing.clear();
    }

    /// Moves on by one step of [`STEP_MS`].
    pub fn step(&mut self, world: &World) {
        let silence = self.now_ms - self.last_command_ms;
        if self.session == Session::Open
            && !self.watchdog_tripped
            && silence >= u64::from(self.parameters.watchdog_ms)
        {
            self.watchdog_tripped = true;
            self.base.order(Order::Stop);
        }
        self.now_ms += STEP_MS;
        self.base.step(world);
        if self.session == Session::Open {
            self.ping(world);
            let cycle = u64::from(self.parameters.sip_cycle_ms);
            if (self.now_ms - self.opened_ms).is_multiple_of(cycle) {
                self.send_information(world);
            }
        }
    }

    fn obey(&mut self, command: &HostCommand<'_>) {
        match (self.session, command.number) {
            // In an open session these three numbers mean something else.
            (Session::Open, _) => self.obey_open(command),
            (_, command::SYNC0) => {
                self.session = Session::Synchronised0;
                self.echo(command::SYNC0);
            }
            (Session::Synchronised0, command::SYNC1) => {
                self.session = Session::Synchronised1;
                self.echo(command::SYNC1);
            }
            (Session::Synchronised1, command::SYNC2) => {
                self.session = Session::Identified;
                self.introduce();
            }
            (Session::Identified, command::OPEN) => {
                self.session = Session::Open;
                self.opened_ms = self.now_ms;
            }
            (Session::Identified, command::CLOSE) => self.close(),
            _ => {}
        }
    }

    fn obey_open(&mut self, command: &HostCommand<'_>) {
        let value = match command.argument {
            Argument::Integer(value) => Some(value),
            // A negative zero is a zero.
            Argument::Raw(&[_, 0, 0]) => Some(0),
            _ => None,
        };
        match (command.number, value) {
            (command::CLOSE, _) => self.close(),
            (command::ENABLE, Some(0)) => self.disable_motors(),
            (command::ENABLE, Some(_)) => self.motors = !self.e_stop,
            (command::SONAR, Some(value)) => self.switch_sonars(value),
            (command::SONARCYCLE, Some(ms)) => {
                if let Firing::RoundRobin { ping_ms } = &mut self.parameters.firing
                    && valid_ping(ms.into())
                {
                    *ping_ms = ms.unsigned_abs().into();
                }
            }
            (command::CONFIG, _) => self.send_configuration(),
            (command::HOSTBAUD, Some(code)) => {
                if let Some(baud) = usize::try_from(code).ok().and_then(|code| BAUDS.get(code)) {
                    self.baud = *baud;
                }
            }
            (command::SETO, _) => self.base.reset_odometry(),
            (command::SETA | command::SETV | command::SETRV | command::SETRA, Some(value)) => {
                self.set_limit(command.number, value.into());
            }
            (command::STOP, _) => self.base.order(Order::Stop),
            (command::E_STOP, _) => self.base.order(Order::EmergencyStop),
            _ if !self.motors => {}
            (command::VEL, Some(mm_s)) => self.base.order(Order::Speed(metres(mm_s))),
            (command::MOVE, Some(mm)) => self.base.order(Order::Distance(metres(mm))),
            (command::RVEL | command::ROTATE, Some(deg_s)) => {
                self.base.order(Order::TurnRate(radians(deg_s)));
            }
            (command::HEAD, Some(deg)) => self.base.order(Order::Heading(radians(deg))),
            (command::DHEAD, Some(deg)) => self.base.order(Order::Turn(radians(deg))),
            (command::VEL2, _) => {
                if let Argument::Bytes { high, low } = command.argument {
                    let unit = i32::from(self.parameters.units.vel2_unit_mm_s);
                    let [left, right] =
                        [high, low].map(|byte| metres(i32::from(byte.cast_signed()) * unit));
                    self.base.order(Order::Speed((left + right) / 2.0));
                    self.base
                        .order(Order::TurnRate((right - left) / 2.0 / self.half_track()));
                }
            }
            // PULSE, and whatever this robot does not know, only feeds the watchdog.
            _ => {}
        }
    }

    fn set_limit(&mut self, number: u8, value: f64) {
        let mut limits = *self.base.limits();
        let (translational, rotational) = (value.abs() / 1000.0, value.abs().to_radians());
        match number {
            command::SETV => limits.speed = translational,
            command::SETRV => limits.turn_rate = rotational,
            command::SETA if value > 0.0 => limits.acceleration = translational,
            command::SETA => limits.deceleration = translational,
            command::SETRA if value > 0.0 => limits.turn_acceleration = rotational,
            _ => limits.turn_deceleration = rotational,
        }
        // A limit of 0 is refused, and a refusal is silent like every other.
        let _ = self.base.set_limits(limits);
    }

    /// `SONAR`: bit 0 switches, bits 1 to 3 select an array, 0 meaning all.
    fn switch_sonars(&mut self, value: i32) {
        let (on, selected) = (value & 1 == 1, value >> 1 & 0b111);
        let before = self.arrays;
        let fitted = self.parameters.sonars / ARRAY;
        for (array, number) in self.arrays.iter_mut().take(fitted).zip(1..) {
            if selected == 0 || selected == number {
                *array = on;
            }
        }
        if before == [false; 2] && self.arrays != before {
            self.hollow = self.parameters.hollow_sip;
            self.pings = 0;
            self.last_ping_ms = self.now_ms;
        }
    }

    fn disable_motors(&mut self) {
        self.motors = false;
        self.base.cut_power();
    }

    fn close(&mut self) {
        self.disable_motors();
        self.session = Session::Unsynchronised;
        self.arrays = [false; 2];
        self.readings = SonarReadings::new();
        self.baud = self.parameters.host_baud;
    }

    /// Lets the sonars fire that are due.
    fn ping(&mut self, world: &World) {
        let Firing::RoundRobin { ping_ms } = self.parameters.firing else {
            return;
        };
        if self.now_ms - self.last_ping_ms < ping_ms {
            return;
        }
        self.last_ping_ms = self.now_ms;
        for array in 0..self.arrays.len() {
            self.measure(array * ARRAY + self.pings % ARRAY, world);
        }
        self.pings += 1;
    }

    /// Notes what sonar `index` reads now, if it is switched on.
    fn measure(&mut self, index: usize, world: &World) {
        let on = self.arrays.get(index / ARRAY).is_some_and(|on| *on);
        let number = u8::try_from(index).ok().filter(|_| on);
        if let Some(number) = number
            && let Some(range) = self.ring.measure(index, world, &self.base.pose())
        {
            self.readings.push(SonarReading {
                index: number,
                range,
            });
        }
    }

    fn send_information(&mut self, world: &World) {
        if self.parameters.firing == Firing::All {
            for index in 0..self.ring.len() {
                self.measure(index, world);
            }
        }
        let units = self.parameters.units;
        let odometry = self.base.odometry();
        let angle = |radians: f64| (radians / f64::from(units.angle_rad)).round() as i16;
        let place = |metres: f64| {
            let units = (metres * 1000.0 / f64::from(units.distance_mm)).round();
            (units as i64) as u16
        };
        let [left, right] = [-1.0, 1.0].map(|side| {
            let speed = self.base.speed() + side * self.base.turn_rate() * self.half_track();
            (speed * 1000.0 / f64::from(units.velocity_mm_s)).round() as i16
        });
        let stall = StandardInformation::STALL_LEFT | StandardInformation::STALL_RIGHT;
        let mut flags = 0;
        for (flag, on) in [
            (StandardInformation::FLAG_MOTORS, self.motors),
            (1 << 1, self.arrays[0]),
            (1 << 2, self.arrays[1]),
            (StandardInformation::FLAG_E_STOP, self.e_stop),
        ] {
            flags |= if on { flag } else { 0 };
        }
        let information = StandardInformation {
            kind: if self.base.activity() == Activity::Resting {
                StandardInformation::MOTORS_STOPPED
            } else {
                StandardInformation::MOTORS_MOVING
            },
            x: place(odometry.position.x),
            y: place(odometry.position.y),
            heading: angle(odometry.heading),
            left_velocity: left,
            right_velocity: right,
            battery_decivolts: BATTERY,
            stalls_and_bumpers: if self.base.stalled() { stall } else { 0 },
            control: angle(self.base.heading_setpoint()),
            flags,
            compass: match &mut self.compass {
                Some(compass) => compass.measure(self.base.pose().heading),
                None => compass::ABSENT,
            },
            sonars: std::mem::take(&mut self.readings),
            tail: Tail::standard(
                BATTERY.into(),
                (self.base.turn_rate().to_degrees() * 10.0).round() as i16,
            ),
        };
        let mut buffer = [0; MAX_FRAME];
        let frame = information.encode(&mut buffer);
        if std::mem::take(&mut self.hollow) {
            let claimed = self.parameters.sonars as u8;
            let mut buffer = [0; MAX_FRAME];
            if let Ok(frame) = frame {
                send(&mut self.outgoing, hollow(frame, claimed, &mut buffer));
            }
        } else {
            send(&mut self.outgoing, frame);
        }
    }

    fn echo(&mut self, number: u8) {
        let mut buffer = [0; MAX_FRAME];
        send(
            &mut self.outgoing,
            HostCommand::plain(number).encode(&mut buffer),
        );
    }

    fn introduce(&mut self) {
        let identity = Identity {
            name: self.parameters.name.as_bytes(),
            class: CLASS,
            subclass: self.parameters.units.subclass.as_bytes(),
        };
        let mut buffer = [0; MAX_FRAME];
        send(&mut self.outgoing, identity.encode(&mut buffer));
    }

    fn send_configuration(&mut self) {
        let Parameters {
            name,
            units,
            sonars,
            firing,
            base,
            watchdog_ms,
            sip_cycle_ms,
            host_baud,
            ..
        } = &self.parameters;
        let (top, set) = (&base.top, self.base.limits());
        let thousandths = |metres: f64| (metres * 1000.0).round() as u16;
        let degrees = |radians: f64| radians.to_degrees().round() as u16;
        let configuration = Configuration {
            class: CLASS,
            subclass: units.subclass.as_bytes(),
            serial: b"SIM",
            rotational_velocity_top: degrees(top.turn_rate),
            translational_velocity_top: thousandths(top.speed),
            rotational_acceleration_top: degrees(top.turn_acceleration),
            translational_acceleration_top: thousandths(top.acceleration),
            name: name.as_bytes(),
            sip_cycle_ms: *sip_cycle_ms,
            host_baud: baud_code(*host_baud).unwrap_or_default(),
            front_sonars: true,
            rear_sonars: *sonars > ARRAY,
            low_battery_decivolts: LOW_BATTERY,
            watchdog_ms: *watchdog_ms,
            rotational_velocity_max: degrees(set.turn_rate),
            translational_velocity_max: thousandths(set.speed),
            rotational_acceleration: degrees(set.turn_acceleration),
            rotational_deceleration: degrees(set.turn_deceleration),
            translational_acceleration: thousandths(set.acceleration),
            translational_deceleration: thousandths(set.deceleration),
            sonar_cycle_ms: match firing {
                Firing::All => *sip_cycle_ms,
                Firing::RoundRobin { ping_ms } => (*ping_ms).try_into().unwrap_or(u8::MAX),
            },
            autobaud: Some(Configuration::SWITCHABLE_BAUD),
            firmware: Some(b"S.1"),
        };
        let mut buffer = [0; MAX_FRAME];
        send(&mut self.outgoing, configuration.encode(&mut buffer));
    }

    /// Half the distance between the wheels (m).
    fn half_track(&self) -> f64 {
        1.0 / (f64::from(self.parameters.units.differential_rad_mm) * 1000.0)
    }
}

/// Appends a frame to what the host will read, unless the host has long stopped reading.
fn send(outgoing: &mut Vec<u8>, frame: Result<Frame<'_>, EncodeError>) {
    // Names are bounded, so nothing that a robot sends is too long to encode.
    if let Ok(frame) = frame
        && outgoing.len() < OUTGOING_LIMIT
    {
        outgoing.extend_from_slice(frame.as_bytes());
    }
}

/// The SIP in `frame` with its sonar readings left out but `claimed` of them counted.
fn hollow<'b>(
    frame: Frame<'_>,
    claimed: u8,
    buffer: &'b mut [u8; MAX_FRAME],
) -> Result<Frame<'b>, EncodeError> {
    let (before, block) = frame.arguments().split_at(SONAR_COUNT);
    let present = block.first().copied().unwrap_or_default();
    let after = block
        .get(1 + 3 * usize::from(present)..)
        .unwrap_or_default();
    FrameWriter::new(buffer, frame.number())
        .bytes(before)
        .u8(claimed)
        .bytes(after)
        .finish()
}

/// `mm` in m.
fn metres(mm: i32) -> f64 {
    f64::from(mm) / 1000.0
}

/// `degrees` in rad.
fn radians(degrees: i32) -> f64 {
    f64::from(degrees).to_radians()
}
