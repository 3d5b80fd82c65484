//! Framing: `FA FB`, a count, the packet, a checksum.

use core::fmt;

/// The first byte of every frame.
const FIRST: u8 = 0xFA;
/// The second byte of every frame.
const SECOND: u8 = 0xFB;
/// Header and count: what precedes the counted bytes.
const PREFIX: usize = 3;
/// The checksum's length in bytes.
const CHECKSUM: usize = 2;

/// The smallest legal count: a packet number and the checksum.
pub const MIN_COUNT: u8 = 3;
/// The largest count taken for a frame. Robots stay near 200; hosts differ in the limit they
/// enforce, and 249 is the largest that any of them states.
pub const MAX_COUNT: u8 = 249;
/// The longest frame in bytes: header, count and [`MAX_COUNT`] counted bytes.
pub const MAX_FRAME: usize = PREFIX + MAX_COUNT as usize;

/// The checksum of a packet, that is of the bytes from its number to its last argument.
///
/// Big-endian pairs are added modulo 2¹⁶; a byte left over is exclusive-ored into the low byte.
/// It is transmitted high byte first, unlike every other integer of the protocol.
#[must_use]
pub fn checksum(packet: &[u8]) -> u16 {
    let (pairs, odd) = packet.as_chunks::<2>();
    let mut sum = 0_u16;
    for pair in pairs {
        sum = sum.wrapping_add(u16::from_be_bytes(*pair));
    }
    match odd {
        [last] => sum ^ u16::from(*last),
        _ => sum,
    }
}

/// Why bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// The bytes do not begin with `FA FB`.
    Header,
    /// The count is outside [`MIN_COUNT`]`..=`[`MAX_COUNT`].
    Count(u8),
    /// The bytes may be the beginning of a frame, but end before it does.
    Truncated,
    /// The checksum carried is not the checksum of the packet.
    Checksum {
        /// The checksum of the packet received.
        computed: u16,
        /// The checksum the frame carries.
        carried: u16,
    },
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header => f.write_str("no frame header FA FB"),
            Self::Count(count) => {
                write!(f, "frame count {count} outside {MIN_COUNT}..={MAX_COUNT}")
            }
            Self::Truncated => f.write_str("frame truncated"),
            Self::Checksum { computed, carried } => {
                write!(
                    f,
                    "frame carries checksum {carried:04X}, its packet has {computed:04X}"
                )
            }
        }
    }
}

impl core::error::Error for FrameError {}

/// A frame whose header, count and checksum have been checked, as a view over its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    bytes: &'a [u8],
    number: u8,
    arguments: &'a [u8],
}

impl<'a> Frame<'a> {
    /// Checks the frame at the beginning of `bytes`; what follows it is left out of the view.
    ///
    /// # Errors
    /// [`FrameError::Truncated`] as long as more bytes could still make `bytes` a frame, any other
    /// error when none could.
    //= arcos.INV-1
    //= arcos.INV-2
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, FrameError> {
        let count = match *bytes {
            [FIRST, SECOND, count, ..] => count,
            [] | [FIRST] | [FIRST, SECOND] => return Err(FrameError::Truncated),
            _ => return Err(FrameError::Header),
        };
        if !(MIN_COUNT..=MAX_COUNT).contains(&count) {
            return Err(FrameError::Count(count));
        }
        let bytes = bytes
            .get(..PREFIX + usize::from(count))
            .ok_or(FrameError::Truncated)?;
        let (packet, carried) = bytes
            .get(PREFIX..)
            .and_then(<[u8]>::split_last_chunk::<CHECKSUM>)
            .ok_or(FrameError::Truncated)?;
        let (number, arguments) = packet.split_first().ok_or(FrameError::Truncated)?;
        let computed = checksum(packet);
        let carried = u16::from_be_bytes(*carried);
        if computed != carried {
            return Err(FrameError::Checksum { computed, carried });
        }
        Ok(Self {
            bytes,
            number: *number,
            arguments,
        })
    }

    /// The command number (host to robot) or packet type (robot to host).
    #[must_use]
    pub const fn number(&self) -> u8 {
        self.number
    }

    /// What stands between the number and the checksum.
    #[must_use]
    pub const fn arguments(&self) -> &'a [u8] {
        self.arguments
    }

    /// The whole frame, from header to checksum.
    #[must_use]
    pub const fn as_bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

/// Why a packet cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The magnitude of an integer argument exceeds the 16 bits it has on the wire.
    Integer(i32),
    /// The frame would be longer than its buffer or than [`MAX_FRAME`], or a string longer than its
    /// length byte can tell.
    TooLong,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "integer argument {value} outside -65535..=65535"),
            Self::TooLong => write!(f, "frame longer than its buffer or than {MAX_FRAME} bytes"),
        }
    }
}

impl core::error::Error for EncodeError {}

/// Builds one frame in a caller's buffer, for which [`MAX_FRAME`] bytes are always enough. A packet
/// that outgrows it is reported once, by [`finish`](Self::finish).
#[derive(Debug)]
#[must_use = "a frame exists only after `finish`"]
pub struct FrameWriter<'b> {
    buffer: &'b mut [u8],
    /// Bytes written, or that would have been had they fitted.
    length: usize,
}

impl<'b> FrameWriter<'b> {
    /// Begins a frame with the given command number or packet type.
    pub fn new(buffer: &'b mut [u8], number: u8) -> Self {
        Self {
            buffer,
            length: PREFIX,
        }
        .u8(number)
    }

    /// Appends bytes as they are.
    pub fn bytes(mut self, bytes: &[u8]) -> Self {
        let end = self.length.saturating_add(bytes.len());
        if let Some(slot) = self.buffer.get_mut(self.length..end) {
            slot.copy_from_slice(bytes);
        }
        self.length = end;
        self
    }

    /// Appends one byte.
    pub fn u8(self, value: u8) -> Self {
        self.bytes(&[value])
    }

    /// Appends one two's complement byte.
    pub fn i8(self, value: i8) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Appends a 16-bit unsigned integer, low byte first.
    pub fn u16(self, value: u16) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Appends a 16-bit two's complement integer, low byte first.
    pub fn i16(self, value: i16) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Appends a 32-bit two's complement integer, low byte first.
    pub fn i32(self, value: i32) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Appends a string as robots send it, with a closing NUL. What follows a NUL within `text`
    /// would be read as the next field and is left out.
    pub fn text(self, text: &[u8]) -> Self {
        let text = match text.iter().position(|byte| *byte == 0) {
            Some(end) => text.get(..end).unwrap_or_default(),
            None => text,
        };
        self.bytes(text).u8(0)
    }

    /// Completes the frame with its count and checksum.
    ///
    /// # Errors
    /// [`EncodeError::TooLong`] if the frame does not fit.
    //= arcos.INV-3
    pub fn finish(self) -> Result<Frame<'b>, EncodeError> {
        let too_long = EncodeError::TooLong;
        let frame = self
            .buffer
            .get_mut(..self.length.saturating_add(CHECKSUM))
            .ok_or(too_long)?;
        let (prefix, counted) = frame.split_first_chunk_mut::<PREFIX>().ok_or(too_long)?;
        let count = u8::try_from(counted.len()).map_err(|_| too_long)?;
        let (packet, carried) = counted.split_last_chunk_mut::<CHECKSUM>().ok_or(too_long)?;
        *prefix = [FIRST, SECOND, count];
        *carried = checksum(packet).to_be_bytes();
        Frame::new_checked(frame).map_err(|_| too_long)
    }
}
