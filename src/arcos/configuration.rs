//! The robot's stored parameters.

use super::frame::{EncodeError, Frame, FrameWriter};
use super::reader::{PacketError, Reader};

/// The parameters a host needs from the configuration packet. Speeds are mm/s and °/s,
/// accelerations mm/s² and °/s².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration<'a> {
    /// The class, `Pioneer`.
    pub class: &'a [u8],
    /// The subclass, such as `p3dx`.
    pub subclass: &'a [u8],
    /// The serial number.
    pub serial: &'a [u8],
    /// The rotational speed that no setting can exceed.
    pub rotational_velocity_top: u16,
    /// The translational speed that no setting can exceed.
    pub translational_velocity_top: u16,
    /// The rotational acceleration that no setting can exceed.
    pub rotational_acceleration_top: u16,
    /// The translational acceleration that no setting can exceed.
    pub translational_acceleration_top: u16,
    /// The name given to this robot.
    pub name: &'a [u8],
    /// The time between SIPs, ms.
    pub sip_cycle_ms: u8,
    /// The code of the baud rate at which the host port starts.
    pub host_baud: u8,
    /// Whether front sonars are fitted.
    pub front_sonars: bool,
    /// Whether rear sonars are fitted.
    pub rear_sonars: bool,
    /// The battery voltage at which the robot complains, decivolts.
    pub low_battery_decivolts: u16,
    /// The silence after which the robot stops its motors, ms.
    pub watchdog_ms: u16,
    /// The largest rotational speed set.
    pub rotational_velocity_max: u16,
    /// The largest translational speed set.
    pub translational_velocity_max: u16,
    /// The rotational acceleration set.
    pub rotational_acceleration: u16,
    /// The rotational deceleration set.
    pub rotational_deceleration: u16,
    /// The translational acceleration set.
    pub translational_acceleration: u16,
    /// The translational deceleration set.
    pub translational_deceleration: u16,
    /// The time between sonar pings, ms.
    pub sonar_cycle_ms: u8,
    /// [`SWITCHABLE_BAUD`](Self::SWITCHABLE_BAUD) if the host may change the baud rate; absent in
    /// older firmware.
    pub autobaud: Option<u8>,
    /// The firmware's version; absent in older firmware.
    pub firmware: Option<&'a [u8]>,
}

impl<'a> Configuration<'a> {
    /// The packet type.
    pub const NUMBER: u8 = 0x20;
    /// The value of [`autobaud`](Self::autobaud) that lets a host change the baud rate.
    pub const SWITCHABLE_BAUD: u8 = 2;

    /// Reads a frame as a configuration packet.
    ///
    /// # Errors
    /// [`PacketError::Type`] if the frame is something else, [`PacketError::Truncated`] if it ends
    /// before the time between sonar pings.
    pub fn decode(frame: Frame<'a>) -> Result<Self, PacketError> {
        if frame.number() != Self::NUMBER {
            return Err(PacketError::Type(frame.number()));
        }
        let mut reader = Reader::new(frame.arguments());
        let mut configuration = Self {
            class: reader.text()?,
            subclass: reader.text()?,
            serial: reader.text()?,
            rotational_velocity_top: after(&mut reader, 1)?.u16()?,
            translational_velocity_top: reader.u16()?,
            rotational_acceleration_top: reader.u16()?,
            translational_acceleration_top: reader.u16()?,
            // Largest pulse width of the motor drive.
            name: after(&mut reader, 2)?.text()?,
            sip_cycle_ms: reader.u8()?,
            host_baud: reader.u8()?,
            // Auxiliary baud rate, gripper.
            front_sonars: after(&mut reader, 3)?.u16()? != 0,
            rear_sonars: reader.u8()? != 0,
            low_battery_decivolts: reader.u16()?,
            // Encoder ticks of half a turn in place.
            watchdog_ms: after(&mut reader, 2)?.u16()?,
            // Packet version, stall pulse width and count, joystick speeds.
            rotational_velocity_max: after(&mut reader, 9)?.u16()?,
            translational_velocity_max: reader.u16()?,
            rotational_acceleration: reader.u16()?,
            rotational_deceleration: reader.u16()?,
            // Rotational controller gains.
            translational_acceleration: after(&mut reader, 6)?.u16()?,
            translational_deceleration: reader.u16()?,
            // Translational controller gains, bumpers, charger.
            sonar_cycle_ms: after(&mut reader, 9)?.u8()?,
            autobaud: None,
            firmware: None,
        };
        configuration.autobaud = reader.u8().ok();
        // Gyroscope and its drift, two auxiliary baud rates, ticks per mm, shutdown voltage.
        configuration.firmware = after(&mut reader, 9).and_then(Reader::text).ok();
        Ok(configuration)
    }

    /// Writes the packet as a frame, with zero for all that this type does not hold.
    ///
    /// # Errors
    /// [`EncodeError::TooLong`] if the frame does not fit; [`MAX_FRAME`](super::MAX_FRAME) bytes hold
    /// any that is legal.
    pub fn encode<'b>(&self, buffer: &'b mut [u8]) -> Result<Frame<'b>, EncodeError> {
        let writer = FrameWriter::new(buffer, Self::NUMBER)
            .text(self.class)
            .text(self.subclass)
            .text(self.serial)
            .bytes(&[0; 1])
            .u16(self.rotational_velocity_top)
            .u16(self.translational_velocity_top)
            .u16(self.rotational_acceleration_top)
            .u16(self.translational_acceleration_top)
            .bytes(&[0; 2])
            .text(self.name)
            .u8(self.sip_cycle_ms)
            .u8(self.host_baud)
            .bytes(&[0; 3])
            .u16(u16::from(self.front_sonars))
            .u8(u8::from(self.rear_sonars))
            .u16(self.low_battery_decivolts)
            .bytes(&[0; 2])
            .u16(self.watchdog_ms)
            .bytes(&[0; 9])
            .u16(self.rotational_velocity_max)
            .u16(self.translational_velocity_max)
            .u16(self.rotational_acceleration)
            .u16(self.rotational_deceleration)
            .bytes(&[0; 6])
            .u16(self.translational_acceleration)
            .u16(self.translational_deceleration)
            .bytes(&[0; 9])
            .u8(self.sonar_cycle_ms);
        let Some(autobaud) = self.autobaud else {
            return writer.finish();
        };
        let writer = writer.u8(autobaud);
        let Some(firmware) = self.firmware else {
            return writer.finish();
        };
        // Two gyroscope scales and the kinematics delay close the part that hosts agree on.
        writer.bytes(&[0; 9]).text(firmware).bytes(&[0; 5]).finish()
    }
}

/// The reader behind `length` bytes of fields that are not needed.
fn after<'r, 'a>(
    reader: &'r mut Reader<'a>,
    length: usize,
) -> Result<&'r mut Reader<'a>, PacketError> {
    reader.bytes(length)?;
    Ok(reader)
}
