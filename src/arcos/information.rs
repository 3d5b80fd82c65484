//! The standard server information packet (SIP), robot to host.

use super::frame::{EncodeError, Frame, FrameWriter};
use super::reader::{PacketError, Reader};

/// The most sonars a robot can have: four arrays of eight.
pub const MAX_SONARS: usize = 32;
/// The raw range by which a sonar reports that nothing answered.
pub const NO_ECHO_RANGE: u16 = 5000;
/// Bytes of one sonar reading.
const READING: usize = 3;

/// One new sonar reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SonarReading {
    /// The sonar's index in the ring.
    pub index: u8,
    /// The range in raw units; [`NO_ECHO_RANGE`] and above mean that nothing answered.
    pub range: u16,
}

/// The sonar readings of one packet: those that are new since the one before, at most
/// [`MAX_SONARS`]. A sonar fired twice within a cycle appears twice.
#[derive(Clone, Copy, Debug, Default)]
pub struct SonarReadings {
    readings: [SonarReading; MAX_SONARS],
    count: usize,
}

impl SonarReadings {
    /// No readings.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            readings: [SonarReading { index: 0, range: 0 }; MAX_SONARS],
            count: 0,
        }
    }

    /// Appends a reading. Returns whether it was taken: it is not if there are [`MAX_SONARS`]
    /// already, or if its index is not below [`MAX_SONARS`].
    pub fn push(&mut self, reading: SonarReading) -> bool {
        match self.readings.get_mut(self.count) {
            Some(slot) if usize::from(reading.index) < MAX_SONARS => {
                *slot = reading;
                self.count += 1;
                true
            }
            _ => false,
        }
    }

    /// The readings in the order in which they were sent.
    #[must_use]
    pub fn as_slice(&self) -> &[SonarReading] {
        self.readings.get(..self.count).unwrap_or_default()
    }

    //= arcos.INV-9
    fn decode(reader: &mut Reader<'_>) -> Result<Self, PacketError> {
        let claimed = reader.u8()?;
        if usize::from(claimed) > MAX_SONARS {
            return Err(PacketError::TooManySonars(claimed));
        }
        let bytes = reader.remaining();
        let block = reader
            .bytes(READING * usize::from(claimed))
            .map_err(|_| PacketError::SonarsMissing { claimed, bytes })?;
        let mut readings = Self::new();
        for &[index, low, high] in block.as_chunks::<READING>().0 {
            if !readings.push(SonarReading {
                index,
                range: u16::from_le_bytes([low, high]),
            }) {
                return Err(PacketError::SonarIndex(index));
            }
        }
        Ok(readings)
    }
}

impl PartialEq for SonarReadings {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl Eq for SonarReadings {}

/// What follows the sonar readings. Firmware of different ages ends it at different fields, so each
/// is absent together with all after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tail {
    /// State of the gripper, or in older firmware the low byte of a timer.
    pub gripper: Option<u8>,
    /// The analogue port selected.
    pub analog_port: Option<u8>,
    /// The reading of that port.
    pub analog: Option<u8>,
    /// Digital inputs.
    pub digital_inputs: Option<u8>,
    /// Digital outputs.
    pub digital_outputs: Option<u8>,
    /// Battery voltage, decivolts, wider than the compulsory one.
    pub battery_decivolts: Option<u16>,
    /// 0 not charging, 1 bulk, 2 overcharge, 3 float, 4 balance; 255 not known.
    pub charge_state: Option<u8>,
    /// Rotational velocity, 0.1 °/s.
    pub rotational_velocity: Option<i16>,
    /// Fault flags.
    pub fault_flags: Option<u16>,
    /// Lateral velocity, mm/s.
    pub lateral_velocity: Option<i16>,
    /// Temperature, °C; -127 and -128 mean that there is no sensor.
    pub temperature: Option<i8>,
    /// State of charge, %.
    pub state_of_charge: Option<u8>,
}

impl Tail {
    /// The tail of recent firmware on a robot without gripper, analogue or digital devices.
    #[must_use]
    pub const fn standard(battery_decivolts: u16, rotational_velocity: i16) -> Self {
        Self {
            gripper: Some(0),
            analog_port: Some(0),
            analog: Some(0),
            digital_inputs: Some(0),
            digital_outputs: Some(0),
            battery_decivolts: Some(battery_decivolts),
            charge_state: Some(0),
            rotational_velocity: Some(rotational_velocity),
            fault_flags: Some(0),
            lateral_velocity: Some(0),
            temperature: Some(-127),
            state_of_charge: Some(0),
        }
    }

    fn decode(mut reader: Reader<'_>) -> Self {
        let mut tail = Self::default();
        // The first field that is missing ends the tail; what it lacks is not an error.
        let _ = tail.decode_fields(&mut reader);
        tail
    }

    fn decode_fields(&mut self, reader: &mut Reader<'_>) -> Result<(), PacketError> {
        self.gripper = Some(reader.u8()?);
        self.analog_port = Some(reader.u8()?);
        self.analog = Some(reader.u8()?);
        self.digital_inputs = Some(reader.u8()?);
        self.digital_outputs = Some(reader.u8()?);
        self.battery_decivolts = Some(reader.u16()?);
        self.charge_state = Some(reader.u8()?);
        self.rotational_velocity = Some(reader.i16()?);
        self.fault_flags = Some(reader.u16()?);
        self.lateral_velocity = Some(reader.i16()?);
        self.temperature = Some(reader.i8()?);
        self.state_of_charge = Some(reader.u8()?);
        Ok(())
    }

    fn encode<'b>(&self, writer: FrameWriter<'b>) -> FrameWriter<'b> {
        let Some(gripper) = self.gripper else {
            return writer;
        };
        let writer = writer.u8(gripper);
        let Some(analog_port) = self.analog_port else {
            return writer;
        };
        let writer = writer.u8(analog_port);
        let Some(analog) = self.analog else {
            return writer;
        };
        let writer = writer.u8(analog);
        let Some(digital_inputs) = self.digital_inputs else {
            return writer;
        };
        let writer = writer.u8(digital_inputs);
        let Some(digital_outputs) = self.digital_outputs else {
            return writer;
        };
        let writer = writer.u8(digital_outputs);
        let Some(battery_decivolts) = self.battery_decivolts else {
            return writer;
        };
        let writer = writer.u16(battery_decivolts);
        let Some(charge_state) = self.charge_state else {
            return writer;
        };
        let writer = writer.u8(charge_state);
        let Some(rotational_velocity) = self.rotational_velocity else {
            return writer;
        };
        let writer = writer.i16(rotational_velocity);
        let Some(fault_flags) = self.fault_flags else {
            return writer;
        };
        let writer = writer.u16(fault_flags);
        let Some(lateral_velocity) = self.lateral_velocity else {
            return writer;
        };
        let writer = writer.i16(lateral_velocity);
        let Some(temperature) = self.temperature else {
            return writer;
        };
        let writer = writer.i8(temperature);
        let Some(state_of_charge) = self.state_of_charge else {
            return writer;
        };
        writer.u8(state_of_charge)
    }
}

/// The standard server information packet: one per cycle, 100 ms by default.
///
/// Fields are raw; [`BaseParameters`](super::BaseParameters) holds the factors that give them units
/// and [`Odometry`](super::Odometry) unwraps the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StandardInformation {
    /// The packet type. [`MOTORS_STOPPED`](Self::MOTORS_STOPPED) and
    /// [`MOTORS_MOVING`](Self::MOTORS_MOVING) are the usual ones, but a simulator in wide use sends
    /// the former even while it moves: judge motion by the velocities.
    pub kind: u8,
    /// Odometry x, distance units modulo the wrap.
    pub x: u16,
    /// Odometry y, distance units modulo the wrap.
    pub y: u16,
    /// Odometry heading, angle units, counter-clockwise positive, ±2048 being ±180°.
    pub heading: i16,
    /// Speed of the left wheel, velocity units.
    pub left_velocity: i16,
    /// Speed of the right wheel, velocity units.
    pub right_velocity: i16,
    /// Battery voltage, decivolts.
    pub battery_decivolts: u8,
    /// Wheel stalls and bumper segments; see the accessors.
    pub stalls_and_bumpers: u16,
    /// The heading the robot is steering to, angle units. Not filled in by every robot.
    pub control: i16,
    /// Motor, sonar and emergency-stop state; see the accessors.
    pub flags: u16,
    /// The compass, raw; see [`compass_heading_deg`].
    pub compass: u8,
    /// The sonar readings that are new since the packet before.
    pub sonars: SonarReadings,
    /// What follows the sonar readings.
    pub tail: Tail,
}

impl StandardInformation {
    /// The packet type while the motors stand still.
    pub const MOTORS_STOPPED: u8 = 0x32;
    /// The packet type while the motors turn.
    pub const MOTORS_MOVING: u8 = 0x33;

    /// Bit of [`flags`](Self::flags): the motors are enabled.
    pub const FLAG_MOTORS: u16 = 1;
    /// Bits of [`flags`](Self::flags): one for each sonar array that is on.
    pub const FLAG_SONARS: u16 = 0b1_1110;
    /// Bit of [`flags`](Self::flags): the emergency stop is pressed.
    pub const FLAG_E_STOP: u16 = 1 << 5;

    /// Bit of [`stalls_and_bumpers`](Self::stalls_and_bumpers): the left wheel stalls.
    pub const STALL_LEFT: u16 = 1;
    /// Bit of [`stalls_and_bumpers`](Self::stalls_and_bumpers): the right wheel stalls.
    pub const STALL_RIGHT: u16 = 1 << 8;

    /// Whether `kind` is one of the types under which robots send this packet.
    #[must_use]
    pub const fn is_kind(kind: u8) -> bool {
        matches!(kind, 0x30..=0x34)
    }

    /// Reads a frame as this packet.
    ///
    /// # Errors
    /// A good checksum does not make a good packet: one simulator counts sonar readings that it then
    /// does not send. A packet is refused whole if it is of another type, ends before its last
    /// compulsory field, or claims sonar readings that are absent, too many, or of no sonar.
    //= arcos.INV-8
    //= arcos.INV-10
    pub fn decode(frame: Frame<'_>) -> Result<Self, PacketError> {
        let kind = frame.number();
        if !Self::is_kind(kind) {
            return Err(PacketError::Type(kind));
        }
        let mut reader = Reader::new(frame.arguments());
        Ok(Self {
            kind,
            x: reader.u16()?,
            y: reader.u16()?,
            heading: reader.i16()?,
            left_velocity: reader.i16()?,
            right_velocity: reader.i16()?,
            battery_decivolts: reader.u8()?,
            stalls_and_bumpers: reader.u16()?,
            control: reader.i16()?,
            flags: reader.u16()?,
            compass: reader.u8()?,
            sonars: SonarReadings::decode(&mut reader)?,
            tail: Tail::decode(reader),
        })
    }

    /// Writes the packet as a frame.
    ///
    /// # Errors
    /// [`EncodeError::TooLong`] if `buffer` is shorter than the frame, which cannot be with
    /// [`MAX_FRAME`](super::MAX_FRAME) bytes.
    pub fn encode<'b>(&self, buffer: &'b mut [u8]) -> Result<Frame<'b>, EncodeError> {
        let readings = self.sonars.as_slice();
        let count = u8::try_from(readings.len()).map_err(|_| EncodeError::TooLong)?;
        let mut writer = FrameWriter::new(buffer, self.kind)
            .u16(self.x)
            .u16(self.y)
            .i16(self.heading)
            .i16(self.left_velocity)
            .i16(self.right_velocity)
            .u8(self.battery_decivolts)
            .u16(self.stalls_and_bumpers)
            .i16(self.control)
            .u16(self.flags)
            .u8(self.compass)
            .u8(count);
        for reading in readings {
            writer = writer.u8(reading.index).u16(reading.range);
        }
        self.tail.encode(writer).finish()
    }

    /// Whether the motors are enabled.
    #[must_use]
    pub const fn motors_enabled(&self) -> bool {
        self.flags & Self::FLAG_MOTORS != 0
    }

    /// Whether any sonar array is on.
    #[must_use]
    pub const fn sonars_enabled(&self) -> bool {
        self.flags & Self::FLAG_SONARS != 0
    }

    /// Whether the emergency stop is pressed.
    #[must_use]
    pub const fn e_stop(&self) -> bool {
        self.flags & Self::FLAG_E_STOP != 0
    }

    /// Whether the left wheel stalls.
    #[must_use]
    pub const fn left_stalled(&self) -> bool {
        self.stalls_and_bumpers & Self::STALL_LEFT != 0
    }

    /// Whether the right wheel stalls.
    #[must_use]
    pub const fn right_stalled(&self) -> bool {
        self.stalls_and_bumpers & Self::STALL_RIGHT != 0
    }

    /// The rear bumper segments that are pressed, one bit each from bit 0.
    #[must_use]
    pub const fn rear_bumpers(&self) -> u8 {
        self.stalls_and_bumpers.to_le_bytes()[0] >> 1
    }

    /// The front bumper segments that are pressed, one bit each from bit 0.
    #[must_use]
    pub const fn front_bumpers(&self) -> u8 {
        self.stalls_and_bumpers.to_le_bytes()[1] >> 1
    }
}

/// How far [`compass_heading_deg`] can be from the heading the compass measured, degrees: 1 for the
/// convention not known and 1 for the resolution.
pub const COMPASS_UNCERTAINTY_DEG: u16 = 2;

/// The heading, degrees in 0..360 in the compass's own sense, of the SIP's compass byte; `None` if
/// the byte is one of those by which a robot without a compass, or with a failing one, is known.
///
/// The byte counts in steps of 2°, but hosts disagree on its origin: some read `2b`, others
/// `2(b − 1)`. This is the middle, `2b − 1`, which is within 1° of either.
//= arcos.INV-13
#[must_use]
pub const fn compass_heading_deg(byte: u8) -> Option<u16> {
    match byte {
        1..=180 => Some(2 * byte as u16 - 1),
        _ => None,
    }
}
