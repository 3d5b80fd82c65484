//! Who the robot says it is.

use super::command;
use super::frame::{EncodeError, Frame, FrameWriter};
use super::reader::{PacketError, Reader};

/// The robot's answer to `SYNC2`: three strings, as bytes because a name is whatever was stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity<'a> {
    /// The name given to this robot.
    pub name: &'a [u8],
    /// The class, `Pioneer`.
    pub class: &'a [u8],
    /// The subclass, such as `p3dx`, which decides the units of what the robot reports.
    pub subclass: &'a [u8],
}

impl<'a> Identity<'a> {
    /// Reads a frame as the answer to `SYNC2`.
    ///
    /// # Errors
    /// [`PacketError::Type`] if the frame is something else, [`PacketError::Truncated`] if a string
    /// is missing.
    pub fn decode(frame: Frame<'a>) -> Result<Self, PacketError> {
        if frame.number() != command::SYNC2 {
            return Err(PacketError::Type(frame.number()));
        }
        let mut reader = Reader::new(frame.arguments());
        Ok(Self {
            name: reader.text()?,
            class: reader.text()?,
            subclass: reader.text()?,
        })
    }

    /// Writes the answer as a frame. A string is cut at a NUL within it.
    ///
    /// # Errors
    /// [`EncodeError::TooLong`] if the frame does not fit; [`MAX_FRAME`](super::MAX_FRAME) bytes hold
    /// any that is legal.
    pub fn encode<'b>(&self, buffer: &'b mut [u8]) -> Result<Frame<'b>, EncodeError> {
        FrameWriter::new(buffer, command::SYNC2)
            .text(self.name)
            .text(self.class)
            .text(self.subclass)
            .finish()
    }
}
