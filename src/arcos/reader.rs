//! Bounds-checked reading of a packet's fields.

use core::fmt;

/// Why a frame with a good checksum is not the packet it is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketError {
    /// The frame carries a packet of another type.
    Type(u8),
    /// The packet ends before its last compulsory field.
    Truncated,
    /// The packet claims more sonar readings than it has bytes for.
    SonarsMissing {
        /// The number of readings claimed.
        claimed: u8,
        /// The number of bytes that follow the claim; each reading takes three.
        bytes: usize,
    },
    /// The packet claims more sonar readings than a robot has sonars.
    TooManySonars(u8),
    /// A reading is attributed to a sonar that no robot has.
    SonarIndex(u8),
}

impl fmt::Display for PacketError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Type(number) => write!(f, "unexpected packet type {number:#04X}"),
            Self::Truncated => f.write_str("packet ends before its last compulsory field"),
            Self::SonarsMissing { claimed, bytes } => {
                write!(f, "packet claims {claimed} sonar readings in {bytes} bytes")
            }
            Self::TooManySonars(claimed) => write!(f, "packet claims {claimed} sonar readings"),
            Self::SonarIndex(index) => write!(f, "packet names sonar {index}"),
        }
    }
}

impl core::error::Error for PacketError {}

/// What is left to read of a packet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) const fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next `length` bytes; on an error nothing is consumed.
    pub(super) fn bytes(&mut self, length: usize) -> Result<&'a [u8], PacketError> {
        let (bytes, rest) = self
            .rest
            .split_at_checked(length)
            .ok_or(PacketError::Truncated)?;
        self.rest = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], PacketError> {
        let (bytes, rest) = self
            .rest
            .split_first_chunk()
            .ok_or(PacketError::Truncated)?;
        self.rest = rest;
        Ok(*bytes)
    }

    pub(super) fn u8(&mut self) -> Result<u8, PacketError> {
        self.array().map(u8::from_le_bytes)
    }

    pub(super) fn i8(&mut self) -> Result<i8, PacketError> {
        self.array().map(i8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, PacketError> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn i16(&mut self) -> Result<i16, PacketError> {
        self.array().map(i16::from_le_bytes)
    }

    /// The next string. It ends at its NUL or, as hosts have always read it, with the packet.
    //= arcos.INV-14
    pub(super) fn text(&mut self) -> Result<&'a [u8], PacketError> {
        if self.rest.is_empty() {
            return Err(PacketError::Truncated);
        }
        let length = self
            .rest
            .iter()
            .position(|byte| *byte == 0)
            .unwrap_or(self.rest.len());
        let text = self.bytes(length)?;
        self.rest = self.rest.get(1..).unwrap_or_default();
        Ok(text)
    }
}
