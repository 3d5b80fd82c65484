//! Commands, host to robot.

use super::frame::{EncodeError, Frame, FrameWriter};

/// `SYNC0` while a session is being opened.
pub const SYNC0: u8 = 0;
/// `SYNC1` while a session is being opened.
pub const SYNC1: u8 = 1;
/// `SYNC2` while a session is being opened; answered with the robot's [`Identity`](super::Identity).
pub const SYNC2: u8 = 2;
/// Does nothing but feed the robot's watchdog.
pub const PULSE: u8 = 0;
/// Starts the servers, and with them the stream of SIPs. No argument, or 1.
pub const OPEN: u8 = 1;
/// Stops the robot and ends the session. No argument, or 1.
pub const CLOSE: u8 = 2;
/// Sets the order in which sonars fire; a string.
pub const POLLING: u8 = 3;
/// Disables (0) or enables (1) the motors.
pub const ENABLE: u8 = 4;
/// Translational acceleration if positive, deceleration if negative, mm/s².
pub const SETA: u8 = 5;
/// Largest translational speed, mm/s.
pub const SETV: u8 = 6;
/// Makes the present pose the origin of the odometry.
pub const SETO: u8 = 7;
/// Moves by a distance, mm.
pub const MOVE: u8 = 8;
/// Rotates at a rate, °/s; the older twin of [`RVEL`].
pub const ROTATE: u8 = 9;
/// Largest rotational speed, °/s.
pub const SETRV: u8 = 10;
/// Translational speed, mm/s, forward positive.
pub const VEL: u8 = 11;
/// Turns to a heading of the odometry, °, counter-clockwise positive.
pub const HEAD: u8 = 12;
/// Turns by an angle, °, counter-clockwise positive.
pub const DHEAD: u8 = 13;
/// Beeps; a string of durations and tones.
pub const SAY: u8 = 15;
/// Requests one [`Configuration`](super::Configuration) packet.
pub const CONFIG: u8 = 18;
/// Requests encoder packets: 0 none, 1 one, 2 a stream.
pub const ENCODER: u8 = 19;
/// Rotational speed, °/s, counter-clockwise positive.
pub const RVEL: u8 = 21;
/// Rotational acceleration if positive, deceleration if negative, °/s².
pub const SETRA: u8 = 23;
/// Disables (0) or enables (1) the sonars.
pub const SONAR: u8 = 28;
/// Decelerates to a stop; the motors stay enabled.
pub const STOP: u8 = 29;
/// Digital outputs: mask in the high byte, values in the low byte.
pub const DIGOUT: u8 = 30;
/// Wheel speeds: left in the high byte, right in the low byte, each a two's complement multiple of
/// [`BaseParameters::vel2_unit_mm_s`](super::BaseParameters::vel2_unit_mm_s).
pub const VEL2: u8 = 32;
/// Selects the analogue port reported by the SIP.
pub const ADSEL: u8 = 35;
/// Requests I/O packets: 0 none, 1 one, 2 a stream.
pub const IOREQUEST: u8 = 40;
/// Which bumpers count as a stall: 0 none, 1 front, 2 rear, 3 both.
pub const BUMPSTALL: u8 = 44;
/// Time between sonar pings, ms.
pub const SONARCYCLE: u8 = 48;
/// Baud rate of the host port: 0 to 4 for 9600, 19200, 38400, 57600 and 115200.
pub const HOSTBAUD: u8 = 50;
/// Stops with the largest deceleration.
pub const E_STOP: u8 = 55;
/// Requests gyroscope packets.
pub const GYRO: u8 = 58;
/// Requests battery information.
pub const BATTERYINFO: u8 = 62;
/// Simulator only: places the robot; an ignored type byte, then x, y in mm and heading in ° as
/// 32-bit integers.
pub const SIM_SET_POSE: u8 = 224;
/// Simulator only: returns the robot to where it began.
pub const SIM_RESET: u8 = 225;
/// Simulator only: controls the simulator.
pub const SIM_CTRL: u8 = 236;
/// Simulator only: requests the true pose.
pub const SIM_STAT: u8 = 237;
/// Simulator only: shows a message.
pub const SIM_MESSAGE: u8 = 238;
/// Simulator only: ends the simulator.
pub const SIM_EXIT: u8 = 239;

/// Type byte of a non-negative integer.
const POSITIVE: u8 = 0x3B;
/// Type byte of a negative integer, sent as its magnitude.
const NEGATIVE: u8 = 0x1B;
/// Type byte of a string.
const STRING: u8 = 0x2B;

/// The name by which the protocol knows a command number of an open session, for messages.
#[must_use]
pub const fn name(number: u8) -> Option<&'static str> {
    Some(match number {
        PULSE => "PULSE",
        OPEN => "OPEN",
        CLOSE => "CLOSE",
        POLLING => "POLLING",
        ENABLE => "ENABLE",
        SETA => "SETA",
        SETV => "SETV",
        SETO => "SETO",
        MOVE => "MOVE",
        ROTATE => "ROTATE",
        SETRV => "SETRV",
        VEL => "VEL",
        HEAD => "HEAD",
        DHEAD => "DHEAD",
        SAY => "SAY",
        CONFIG => "CONFIG",
        ENCODER => "ENCODER",
        RVEL => "RVEL",
        SETRA => "SETRA",
        SONAR => "SONAR",
        STOP => "STOP",
        DIGOUT => "DIGOUT",
        VEL2 => "VEL2",
        ADSEL => "ADSEL",
        IOREQUEST => "IOREQUEST",
        BUMPSTALL => "BUMPSTALL",
        SONARCYCLE => "SONARCYCLE",
        HOSTBAUD => "HOSTBAUD",
        E_STOP => "E_STOP",
        GYRO => "GYRO",
        BATTERYINFO => "BATTERYINFO",
        SIM_SET_POSE => "SIM_SET_POSE",
        SIM_RESET => "SIM_RESET",
        SIM_CTRL => "SIM_CTRL",
        SIM_STAT => "SIM_STAT",
        SIM_MESSAGE => "SIM_MESSAGE",
        SIM_EXIT => "SIM_EXIT",
        _ => return None,
    })
}

/// What follows a command's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument<'a> {
    /// Nothing.
    None,
    /// An integer in -65535..=65535: a type byte that carries the sign, then the magnitude.
    Integer(i32),
    /// Two bytes, of [`VEL2`] and [`DIGOUT`].
    Bytes {
        /// The byte transmitted last.
        high: u8,
        /// The byte transmitted first.
        low: u8,
    },
    /// A string of at most 255 bytes, preceded by its length.
    Text(&'a [u8]),
    /// A type byte without a value, as one host sends with `SETO`.
    Unvalued(u8),
    /// Anything else, as received: a negative zero, several values, a string of the wrong length.
    Raw(&'a [u8]),
}

/// One command, host to robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostCommand<'a> {
    /// The command number.
    pub number: u8,
    /// Its argument.
    pub argument: Argument<'a>,
}

impl<'a> HostCommand<'a> {
    /// Reads any frame as a command; encoding the result gives back the frame byte for byte.
    #[must_use]
    pub const fn decode(frame: Frame<'a>) -> Self {
        let number = frame.number();
        let argument = match frame.arguments() {
            [] => Argument::None,
            [kind @ (POSITIVE | NEGATIVE | STRING)] => Argument::Unvalued(*kind),
            [POSITIVE, low, high] if matches!(number, VEL2 | DIGOUT) => Argument::Bytes {
                high: *high,
                low: *low,
            },
            [POSITIVE, low, high] => Argument::Integer(u16::from_le_bytes([*low, *high]) as i32),
            [NEGATIVE, low, high] if *low != 0 || *high != 0 => {
                Argument::Integer(-(u16::from_le_bytes([*low, *high]) as i32))
            }
            [STRING, length, text @ ..] if *length as usize == text.len() => Argument::Text(text),
            raw => Argument::Raw(raw),
        };
        Self { number, argument }
    }

    /// Writes the command as a frame.
    ///
    /// # Errors
    /// [`EncodeError::Integer`] if an integer's magnitude exceeds 65535, [`EncodeError::TooLong`] if
    /// the frame does not fit; [`MAX_FRAME`](super::MAX_FRAME) bytes hold any that is legal.
    //= arcos.INV-6
    pub fn encode<'b>(&self, buffer: &'b mut [u8]) -> Result<Frame<'b>, EncodeError> {
        let writer = FrameWriter::new(buffer, self.number);
        match self.argument {
            Argument::None => writer,
            Argument::Integer(value) => {
                let magnitude =
                    u16::try_from(value.unsigned_abs()).map_err(|_| EncodeError::Integer(value))?;
                writer
                    .u8(if value < 0 { NEGATIVE } else { POSITIVE })
                    .u16(magnitude)
            }
            Argument::Bytes { high, low } => writer.u8(POSITIVE).u8(low).u8(high),
            Argument::Text(text) => {
                let length = u8::try_from(text.len()).map_err(|_| EncodeError::TooLong)?;
                writer.u8(STRING).u8(length).bytes(text)
            }
            Argument::Unvalued(kind) => writer.u8(kind),
            Argument::Raw(raw) => writer.bytes(raw),
        }
        .finish()
    }

    /// The integer carried, if any.
    #[must_use]
    pub const fn integer(&self) -> Option<i32> {
        match self.argument {
            Argument::Integer(value) => Some(value),
            _ => None,
        }
    }
}

impl<'a> HostCommand<'a> {
    /// [`SAY`]: beeps; pairs of a duration in units of 20 ms and a tone in half cycles.
    #[must_use]
    pub const fn say(tones: &'a [u8]) -> Self {
        Self {
            number: SAY,
            argument: Argument::Text(tones),
        }
    }
}

impl HostCommand<'static> {
    /// A command without an argument.
    #[must_use]
    pub const fn plain(number: u8) -> Self {
        Self {
            number,
            argument: Argument::None,
        }
    }

    /// A command with an integer argument in -65535..=65535.
    //= arcos.INV-7
    #[must_use]
    pub const fn with_integer(number: u8, value: i32) -> Self {
        Self {
            number,
            argument: Argument::Integer(value),
        }
    }

    /// [`PULSE`]: feeds the watchdog.
    #[must_use]
    pub const fn pulse() -> Self {
        Self::plain(PULSE)
    }

    /// [`OPEN`]: starts the servers.
    #[must_use]
    pub const fn open() -> Self {
        Self::with_integer(OPEN, 1)
    }

    /// [`CLOSE`]: stops the robot and ends the session.
    #[must_use]
    pub const fn close() -> Self {
        Self::plain(CLOSE)
    }

    /// [`STOP`]: decelerates to a stop.
    #[must_use]
    pub const fn stop() -> Self {
        Self::plain(STOP)
    }

    /// [`E_STOP`]: stops with the largest deceleration.
    #[must_use]
    pub const fn emergency_stop() -> Self {
        Self::plain(E_STOP)
    }

    /// [`ENABLE`]: enables or disables the motors.
    #[must_use]
    pub const fn enable_motors(on: bool) -> Self {
        Self::with_integer(ENABLE, on as i32)
    }

    /// [`SONAR`]: enables or disables the sonars.
    #[must_use]
    pub const fn enable_sonars(on: bool) -> Self {
        Self::with_integer(SONAR, on as i32)
    }

    /// [`VEL`]: translational speed, mm/s, forward positive.
    #[must_use]
    pub const fn velocity(mm_s: i32) -> Self {
        Self::with_integer(VEL, mm_s)
    }

    /// [`RVEL`]: rotational speed, °/s, counter-clockwise positive.
    #[must_use]
    pub const fn rotation(deg_s: i32) -> Self {
        Self::with_integer(RVEL, deg_s)
    }

    /// [`VEL2`]: wheel speeds, each in units of
    /// [`BaseParameters::vel2_unit_mm_s`](super::BaseParameters::vel2_unit_mm_s).
    #[must_use]
    pub const fn wheel_velocities(left: i8, right: i8) -> Self {
        let argument = Argument::Bytes {
            high: left.cast_unsigned(),
            low: right.cast_unsigned(),
        };
        Self {
            number: VEL2,
            argument,
        }
    }

    /// [`HEAD`]: turns to a heading of the odometry, °, counter-clockwise positive.
    #[must_use]
    pub const fn heading(deg: i32) -> Self {
        Self::with_integer(HEAD, deg)
    }

    /// [`SETA`]: translational acceleration, mm/s².
    #[must_use]
    pub const fn acceleration(mm_s2: u16) -> Self {
        Self::with_integer(SETA, mm_s2 as i32)
    }

    /// [`SETA`]: translational deceleration, mm/s², given as a magnitude.
    #[must_use]
    pub const fn deceleration(mm_s2: u16) -> Self {
        Self::with_integer(SETA, -(mm_s2 as i32))
    }

    /// [`SETRA`]: rotational acceleration, °/s².
    #[must_use]
    pub const fn rotational_acceleration(deg_s2: u16) -> Self {
        Self::with_integer(SETRA, deg_s2 as i32)
    }

    /// [`SETRA`]: rotational deceleration, °/s², given as a magnitude.
    #[must_use]
    pub const fn rotational_deceleration(deg_s2: u16) -> Self {
        Self::with_integer(SETRA, -(deg_s2 as i32))
    }

    /// [`SETV`]: largest translational speed, mm/s.
    #[must_use]
    pub const fn maximum_velocity(mm_s: u16) -> Self {
        Self::with_integer(SETV, mm_s as i32)
    }

    /// [`SETRV`]: largest rotational speed, °/s.
    #[must_use]
    pub const fn maximum_rotation(deg_s: u16) -> Self {
        Self::with_integer(SETRV, deg_s as i32)
    }

    /// [`SETO`]: makes the present pose the origin of the odometry.
    #[must_use]
    pub const fn zero_odometry() -> Self {
        Self::plain(SETO)
    }

    /// [`CONFIG`]: requests a configuration packet.
    #[must_use]
    pub const fn request_configuration() -> Self {
        Self::plain(CONFIG)
    }

    /// [`HOSTBAUD`]: changes the baud rate of the host port, if the protocol has a code for `baud`.
    #[must_use]
    pub const fn host_baud(baud: u32) -> Option<Self> {
        let code = match baud {
            9_600 => 0,
            19_200 => 1,
            38_400 => 2,
            57_600 => 3,
            115_200 => 4,
            _ => return None,
        };
        Some(Self::with_integer(HOSTBAUD, code))
    }
}
