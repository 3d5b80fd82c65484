//! The telegrams of the SICK LMS200 laser scanner, both directions, as a codec.
//!
//! Everything here is a pure function of bytes, or a fixed buffer: no I/O, no clock, no allocation,
//! and no input of any kind can make it panic.
//!
//! - [`Telegram`]: a checked view over the bytes of one telegram, [`TelegramWriter`] to build one
//!   and [`Receiver`] to find them in a byte stream that may contain anything.
//! - [`Request`]: host to scanner. [`Reply`]: what the scanner answers.
//! - [`Scan`]: measured values, each a range or the reason why there is none. A missing range is
//!   never a large one.
//!
//! Facts and their sources are in the chapter `laser` of the law book, where each invariant named
//! `laser.INV-n` is stated. Besides telegrams the scanner sends lone bytes, [`ACKNOWLEDGED`] and
//! [`NOT_ACKNOWLEDGED`]; a receiver skips them, since the reply that follows says the same and has
//! a checksum.

use crate::quantity::Angle;
use crate::stream::{self, Framing, Judgement};
use core::fmt;

/// The first byte of every telegram.
const START: u8 = 0x02;
/// Start, address and length: what precedes the payload.
const HEADER: usize = 4;
/// The checksum's length in bytes.
const CHECKSUM: usize = 2;
/// The longest payload taken for one: command, values and status.
pub const MAX_PAYLOAD: usize = 812;
/// The longest telegram in bytes.
pub const MAX_TELEGRAM: usize = HEADER + MAX_PAYLOAD + CHECKSUM;
/// The bit that replies have in their address and requests have not.
const FROM_SCANNER: u8 = 0x80;

/// A lone byte: the request has arrived undamaged.
pub const ACKNOWLEDGED: u8 = 0x06;
/// A lone byte: the request has arrived damaged.
pub const NOT_ACKNOWLEDGED: u8 = 0x15;

/// The checksum over all that precedes it, which is transmitted low byte first.
///
/// A remainder by the polynomial 8005, but with one shift for each byte, and with the byte and the
/// one before it added as one word: neither of the CRC-16 in common use.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u16 {
    let mut sum = 0_u16;
    let mut before = 0;
    for byte in bytes {
        let carried = sum & 0x8000 != 0;
        sum <<= 1;
        if carried {
            sum ^= 0x8005;
        }
        sum ^= u16::from_be_bytes([before, *byte]);
        before = *byte;
    }
    sum
}

/// Why bytes are not a telegram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TelegramError {
    /// The bytes do not begin with 02.
    Start,
    /// The payload would be empty or longer than [`MAX_PAYLOAD`].
    Length(u16),
    /// The bytes may be the beginning of a telegram, but end before it does.
    Truncated,
    /// The checksum carried is not that of the telegram.
    Checksum {
        /// The checksum of what was received.
        computed: u16,
        /// The checksum that the telegram carries.
        carried: u16,
    },
}

impl fmt::Display for TelegramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => f.write_str("no telegram begins here"),
            Self::Length(length) => write!(f, "payload of {length} bytes, allowed is 1 to 812"),
            Self::Truncated => f.write_str("telegram truncated"),
            Self::Checksum { computed, carried } => write!(
                f,
                "telegram carries checksum {carried:04X}, its bytes have {computed:04X}"
            ),
        }
    }
}

impl core::error::Error for TelegramError {}

/// A telegram whose start, length and checksum have been checked, as a view over its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Telegram<'a> {
    bytes: &'a [u8],
    address: u8,
    command: u8,
    data: &'a [u8],
}

impl<'a> Telegram<'a> {
    /// Checks the telegram at the beginning of `bytes`; what follows it is left out of the view.
    ///
    /// # Errors
    /// [`TelegramError::Truncated`] as long as more bytes could still make `bytes` a telegram, any
    /// other error when none could.
    //= laser.INV-1
    //= laser.INV-2
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, TelegramError> {
        let (address, length) = match *bytes {
            [START, address, low, high, ..] => (address, u16::from_le_bytes([low, high])),
            [] | [START] | [START, _] | [START, _, _] => return Err(TelegramError::Truncated),
            _ => return Err(TelegramError::Start),
        };
        let payload_length = usize::from(length);
        if !(1..=MAX_PAYLOAD).contains(&payload_length) {
            return Err(TelegramError::Length(length));
        }
        let bytes = bytes
            .get(..HEADER + payload_length + CHECKSUM)
            .ok_or(TelegramError::Truncated)?;
        let (summed, carried) = bytes
            .split_last_chunk::<CHECKSUM>()
            .ok_or(TelegramError::Truncated)?;
        let (command, data) = summed
            .get(HEADER..)
            .and_then(<[u8]>::split_first)
            .ok_or(TelegramError::Truncated)?;
        let computed = checksum(summed);
        let carried = u16::from_le_bytes(*carried);
        if computed != carried {
            return Err(TelegramError::Checksum { computed, carried });
        }
        Ok(Self {
            bytes,
            address,
            command: *command,
            data,
        })
    }

    /// The scanner's address, 0 to 127. Requests to 0 are for every scanner.
    #[must_use]
    pub const fn address(&self) -> u8 {
        self.address & !FROM_SCANNER
    }

    /// Whether the scanner has sent it, rather than the host.
    #[must_use]
    pub const fn is_from_scanner(&self) -> bool {
        self.address & FROM_SCANNER != 0
    }

    /// The command, which is the first byte of the payload.
    #[must_use]
    pub const fn command(&self) -> u8 {
        self.command
    }

    /// The payload behind the command; in a reply its last byte is the status.
    #[must_use]
    pub const fn data(&self) -> &'a [u8] {
        self.data
    }

    /// The whole telegram, from start to checksum.
    #[must_use]
    pub const fn as_bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

/// The framing of [`Telegram`].
#[derive(Clone, Copy, Debug)]
pub enum LmsFraming {}

impl Framing for LmsFraming {
    type Frame<'a> = Telegram<'a>;

    const SHORTEST: usize = HEADER + 1 + CHECKSUM;

    fn judge(bytes: &[u8]) -> Judgement {
        match Telegram::new_checked(bytes) {
            Ok(telegram) => Judgement::Whole(telegram.as_bytes().len()),
            Err(TelegramError::Truncated) => Judgement::Truncated,
            Err(TelegramError::Checksum { .. }) => Judgement::BadChecksum,
            Err(TelegramError::Start | TelegramError::Length(_)) => Judgement::Not,
        }
    }

    fn view(bytes: &[u8]) -> Option<Telegram<'_>> {
        Telegram::new_checked(bytes).ok()
    }
}

/// Reassembles telegrams from a stream that may begin anywhere and contain anything.
///
/// ```
/// use sidestep::laser::{Receiver, Reply};
///
/// let mut receiver = Receiver::new();
/// // An acknowledgement, then the reply to a change of mode.
/// let mut input: &[u8] = &[0x06, 0x02, 0x80, 0x03, 0x00, 0xA0, 0x00, 0x10, 0x16, 0x0A];
/// while let Some(telegram) = receiver.next_frame(&mut input) {
///     assert!(matches!(Reply::decode(telegram), Ok((Reply::Mode { accepted: true }, _))));
/// }
/// assert_eq!(receiver.reception().skipped_bytes, 1);
/// ```
pub type Receiver = stream::Receiver<LmsFraming, MAX_TELEGRAM>;

/// The telegram would be longer than its buffer or than [`MAX_TELEGRAM`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "telegram longer than its buffer or than {MAX_TELEGRAM} bytes"
        )
    }
}

impl core::error::Error for TooLong {}

/// Builds one telegram in a caller's buffer, for which [`MAX_TELEGRAM`] bytes are always enough. One
/// that outgrows it is reported once, by [`finish`](Self::finish).
#[derive(Debug)]
#[must_use = "a telegram exists only after `finish`"]
pub struct TelegramWriter<'b> {
    buffer: &'b mut [u8],
    /// Bytes written, or that would have been had they fitted.
    length: usize,
}

impl<'b> TelegramWriter<'b> {
    /// Begins a request for the scanner at `address`, of which the uppermost bit is not used.
    pub fn request(buffer: &'b mut [u8], address: u8, command: u8) -> Self {
        Self::new(buffer, address & !FROM_SCANNER, command)
    }

    /// Begins a reply by the scanner at `address`, of which the uppermost bit is not used.
    pub fn reply(buffer: &'b mut [u8], address: u8, command: u8) -> Self {
        Self::new(buffer, address | FROM_SCANNER, command)
    }

    fn new(buffer: &'b mut [u8], address: u8, command: u8) -> Self {
        let writer = Self { buffer, length: 0 };
        writer.bytes(&[START, address, 0, 0, command])
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

    /// Appends a 16-bit unsigned integer, low byte first.
    pub fn u16(self, value: u16) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Writes length and checksum.
    ///
    /// # Errors
    /// [`TooLong`] if the telegram does not fit.
    //= laser.INV-3
    pub fn finish(self) -> Result<Telegram<'b>, TooLong> {
        let payload = self.length.saturating_sub(HEADER);
        if payload > MAX_PAYLOAD {
            return Err(TooLong);
        }
        let length = u16::try_from(payload).map_err(|_| TooLong)?;
        let bytes = self
            .buffer
            .get_mut(..self.length.saturating_add(CHECKSUM))
            .ok_or(TooLong)?;
        if let Some(slot) = bytes.get_mut(2..HEADER) {
            slot.copy_from_slice(&length.to_le_bytes());
        }
        let (summed, slot) = bytes.split_at_mut_checked(self.length).ok_or(TooLong)?;
        slot.copy_from_slice(&checksum(summed).to_le_bytes());
        Telegram::new_checked(bytes).map_err(|_| TooLong)
    }
}

/// How long what is measured is on the wire, and which bits above it are something else.
///
/// It is a setting of the scanner and not in the telegram: a host that reads it wrong reads wrong
/// ranges. Mode 3F, which sends echo amplitudes instead of ranges, is not here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeasuringMode {
    /// 00: 13 bits of range; then field A, field B, dazzled. The factory's setting.
    #[default]
    FieldsAbDazzled,
    /// 01: 13 bits of range; then 3 bits of reflector level.
    Reflector3,
    /// 02: 13 bits of range; then fields A, B and C.
    FieldsAbc,
    /// 03: 14 bits of range; then 2 bits of reflector level.
    Reflector2,
    /// 04: 14 bits of range; then fields A and B.
    FieldsAb,
    /// 05: 15 bits of range; then 1 bit of reflector level.
    Reflector1,
    /// 06: 15 bits of range; then field A.
    FieldA,
    /// 0F: 16 bits of range.
    RangeOnly,
}

impl MeasuringMode {
    /// All modes.
    pub const ALL: [Self; 8] = [
        Self::FieldsAbDazzled,
        Self::Reflector3,
        Self::FieldsAbc,
        Self::Reflector2,
        Self::FieldsAb,
        Self::Reflector1,
        Self::FieldA,
        Self::RangeOnly,
    ];

    /// The mode's number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::FieldsAbDazzled => 0x00,
            Self::Reflector3 => 0x01,
            Self::FieldsAbc => 0x02,
            Self::Reflector2 => 0x03,
            Self::FieldsAb => 0x04,
            Self::Reflector1 => 0x05,
            Self::FieldA => 0x06,
            Self::RangeOnly => 0x0F,
        }
    }

    /// The largest number that fits the bits of a range; it and the 8 below it are no ranges.
    #[must_use]
    pub const fn mask(self) -> u16 {
        match self {
            Self::FieldsAbDazzled | Self::Reflector3 | Self::FieldsAbc => 0x1FFF,
            Self::Reflector2 | Self::FieldsAb => 0x3FFF,
            Self::Reflector1 | Self::FieldA => 0x7FFF,
            Self::RangeOnly => 0xFFFF,
        }
    }

    /// What a word of a scan says.
    //= laser.INV-6
    #[must_use]
    pub const fn reading(self, word: u16, unit: Unit) -> Reading {
        let mask = self.mask();
        let value = word & mask;
        let dazzled = matches!(self, Self::FieldsAbDazzled) && word & 0x8000 != 0;
        match mask - value {
            _ if dazzled => Reading::Missing(Missing::Dazzled),
            0 => Reading::Missing(Missing::NoEcho),
            1 => Reading::Missing(Missing::Dazzled),
            2 => Reading::Missing(Missing::Overflow),
            4 => Reading::Missing(Missing::WeakEcho),
            5 => Reading::Missing(Missing::ChannelError),
            8 => Reading::Missing(Missing::TooFar),
            3 | 6 | 7 => Reading::Missing(Missing::Reserved),
            _ => Reading::Range(value as u32 * unit.millimetres()),
        }
    }
}

/// Unit of the values of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// 0: centimetres.
    Centimetre,
    /// 1: millimetres.
    Millimetre,
}

impl Unit {
    /// The unit's number on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Centimetre => 0,
            Self::Millimetre => 1,
        }
    }

    /// Its length in mm.
    #[must_use]
    pub const fn millimetres(self) -> u32 {
        match self {
            Self::Centimetre => 10,
            Self::Millimetre => 1,
        }
    }
}

/// Field of view and step, each a setting of its own in the scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// 100° by 1°.
    Degrees100Step1,
    /// 100° by 0.5°.
    Degrees100StepHalf,
    /// 100° by 0.25°.
    Degrees100StepQuarter,
    /// 180° by 1°.
    Degrees180Step1,
    /// 180° by 0.5°.
    Degrees180StepHalf,
}

impl Variant {
    /// All variants whose scans come in one telegram.
    pub const ALL: [Self; 5] = [
        Self::Degrees100Step1,
        Self::Degrees100StepHalf,
        Self::Degrees100StepQuarter,
        Self::Degrees180Step1,
        Self::Degrees180StepHalf,
    ];

    /// Field of view, degrees.
    #[must_use]
    pub const fn field_of_view(self) -> u16 {
        match self {
            Self::Degrees100Step1 | Self::Degrees100StepHalf | Self::Degrees100StepQuarter => 100,
            Self::Degrees180Step1 | Self::Degrees180StepHalf => 180,
        }
    }

    /// Angle between two values, in hundredths of a degree.
    #[must_use]
    pub const fn step(self) -> u16 {
        match self {
            Self::Degrees100Step1 | Self::Degrees180Step1 => 100,
            Self::Degrees100StepHalf | Self::Degrees180StepHalf => 50,
            Self::Degrees100StepQuarter => 25,
        }
    }

    /// Values in a scan; no two variants have as many.
    #[must_use]
    pub const fn count(self) -> u16 {
        self.field_of_view() * 100 / self.step() + 1
    }

    /// The variant whose scans have this many values.
    #[must_use]
    pub fn of_count(count: u16) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|variant| variant.count() == count)
    }

    /// Direction of value `index` from straight ahead, in hundredths of a degree, counter-clockwise
    /// positive: the first value is rightmost. None beyond the last.
    //= laser.INV-7
    #[must_use]
    pub fn bearing(self, index: u16) -> Option<i16> {
        if index >= self.count() {
            return None;
        }
        // At most 180° in hundredths: far from overflow.
        let from_rightmost = i32::from(index) * i32::from(self.step());
        i16::try_from(from_rightmost - i32::from(self.field_of_view()) * 50).ok()
    }

    /// The same as an angle.
    #[must_use]
    pub fn bearing_angle(self, index: u16) -> Option<Angle> {
        let hundredths = self.bearing(index)?;
        Angle::radians((f32::from(hundredths) / 100.0).to_radians()).ok()
    }
}

/// Why a value of a scan is not a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Missing {
    /// No echo came back: nothing there, or something that does not reflect.
    NoEcho,
    /// Another light source, or too bright a reflector.
    Dazzled,
    /// The calculation overflowed.
    Overflow,
    /// The echo is too weak to be told from noise.
    WeakEcho,
    /// A channel could not be read.
    ChannelError,
    /// Farther away than the largest range of the mode.
    TooFar,
    /// A code without a known meaning.
    Reserved,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoEcho => "no echo",
            Self::Dazzled => "dazzled",
            Self::Overflow => "overflow",
            Self::WeakEcho => "echo too weak",
            Self::ChannelError => "channel not readable",
            Self::TooFar => "too far",
            Self::Reserved => "reserved code",
        })
    }
}

/// One value of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// A range from the scanner's centre, mm.
    Range(u32),
    /// None, and why.
    Missing(Missing),
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// 0: nothing to report.
    Fine,
    /// 1.
    Information,
    /// 2.
    Warning,
    /// 3.
    Error,
    /// 4.
    Fatal,
    /// 5 to 7: not defined.
    Undefined,
}

/// The last byte of every reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u8);

impl Status {
    /// How bad it is.
    #[must_use]
    pub const fn severity(self) -> Severity {
        match self.0 & 0x07 {
            0 => Severity::Fine,
            1 => Severity::Information,
            2 => Severity::Warning,
            3 => Severity::Error,
            4 => Severity::Fatal,
            _ => Severity::Undefined,
        }
    }

    /// The scanner itself finds its measured values implausible.
    #[must_use]
    pub const fn is_implausible(self) -> bool {
        self.0 & 0x40 != 0
    }

    /// The front window is dirty.
    #[must_use]
    pub const fn is_polluted(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Whether values that come with it may be used: no error, and not implausible. Dirt is a
    /// warning.
    #[must_use]
    pub const fn is_usable(self) -> bool {
        matches!(
            self.severity(),
            Severity::Fine | Severity::Information | Severity::Warning
        ) && !self.is_implausible()
    }
}

/// Why a telegram with a good checksum is not what it is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplyError {
    /// A host has sent it.
    NotFromScanner,
    /// It carries another command.
    Command(u8),
    /// It ends before its last compulsory field, or goes on behind it.
    Size {
        /// Bytes behind the command.
        bytes: usize,
    },
    /// The unit's number is not known.
    Unit(u8),
    /// The values are a part of a scan, or interlaced with others: the number of the part.
    Partial(u8),
    /// No variant has this many values.
    Count(u16),
    /// The scanner reports an error, or that its values are implausible.
    Status(Status),
}

impl fmt::Display for ReplyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFromScanner => f.write_str("a host's telegram, not the scanner's"),
            Self::Command(command) => write!(f, "unexpected command {command:02X}"),
            Self::Size { bytes } => write!(f, "{bytes} bytes do not make this reply"),
            Self::Unit(unit) => write!(f, "unit {unit}, allowed is 0 (cm) or 1 (mm)"),
            Self::Partial(part) => write!(f, "part {part} of a scan, not a whole one"),
            Self::Count(count) => write!(f, "{count} values, which is the scan of no variant"),
            Self::Status(status) => write!(
                f,
                "the scanner reports {:?}{} (status {:02X})",
                status.severity(),
                if status.is_implausible() {
                    ", values implausible"
                } else {
                    ""
                },
                status.0
            ),
        }
    }
}

impl core::error::Error for ReplyError {}

/// The command of a telegram of measured values.
const VALUES: u8 = 0xB0;

/// A whole scan, as a view over its telegram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scan<'a> {
    words: &'a [[u8; 2]],
    unit: Unit,
    variant: Variant,
    mode: MeasuringMode,
    status: Status,
}

impl<'a> Scan<'a> {
    /// Checks that `telegram` is one whole scan with a usable status. `mode` is how the scanner has
    /// been set up.
    ///
    /// # Errors
    /// [`ReplyError`] says what is wrong.
    //= laser.INV-8
    pub fn new_checked(telegram: Telegram<'a>, mode: MeasuringMode) -> Result<Self, ReplyError> {
        let (command, data, status) = split_reply(telegram)?;
        if command != VALUES {
            return Err(ReplyError::Command(command));
        }
        let size = ReplyError::Size { bytes: data.len() };
        let (header, rest) = data.split_first_chunk::<2>().ok_or(size)?;
        let header = u16::from_le_bytes(*header);
        let unit = match header >> 14 {
            0 => Unit::Centimetre,
            1 => Unit::Millimetre,
            other => return Err(ReplyError::Unit(other as u8)),
        };
        if header & 0x3800 != 0 {
            return Err(ReplyError::Partial((header >> 11 & 0x03) as u8));
        }
        let count = header & 0x07FF;
        let variant = Variant::of_count(count).ok_or(ReplyError::Count(count))?;
        let (values, indices) = rest.split_at_checked(2 * usize::from(count)).ok_or(size)?;
        // A scan and a telegram index follow if the scanner has been told so.
        if indices.len() > 2 {
            return Err(size);
        }
        if !status.is_usable() {
            return Err(ReplyError::Status(status));
        }
        let (words, _) = values.as_chunks::<2>();
        Ok(Self {
            words,
            unit,
            variant,
            mode,
            status,
        })
    }

    /// Field of view and step.
    #[must_use]
    pub const fn variant(&self) -> Variant {
        self.variant
    }

    /// Unit of the values on the wire.
    #[must_use]
    pub const fn unit(&self) -> Unit {
        self.unit
    }

    /// What the scanner says of itself.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// Number of values.
    #[must_use]
    pub const fn count(&self) -> u16 {
        self.variant.count()
    }

    /// The word of value `index`, counted from the right, as it is on the wire. None beyond the last.
    #[must_use]
    pub fn word(&self, index: u16) -> Option<u16> {
        self.words
            .get(usize::from(index))
            .map(|word| u16::from_le_bytes(*word))
    }

    /// Value `index`, counted from the right. None beyond the last.
    #[must_use]
    pub fn reading(&self, index: u16) -> Option<Reading> {
        Some(self.mode.reading(self.word(index)?, self.unit))
    }

    /// Writes a scan as a scanner sends it; for simulators and tests. `words` gives the value of each
    /// index on the wire.
    ///
    /// # Errors
    /// [`TooLong`] if the buffer is shorter than the telegram.
    pub fn encode(
        buffer: &mut [u8],
        address: u8,
        variant: Variant,
        unit: Unit,
        status: Status,
        mut words: impl FnMut(u16) -> u16,
    ) -> Result<Telegram<'_>, TooLong> {
        let count = variant.count();
        let mut writer = TelegramWriter::reply(buffer, address, VALUES)
            .u16(u16::from(unit.code()) << 14 | count);
        for index in 0..count {
            writer = writer.u16(words(index));
        }
        writer.u8(status.0).finish()
    }
}

/// Command, data without the status, and status of a reply.
fn split_reply(telegram: Telegram<'_>) -> Result<(u8, &[u8], Status), ReplyError> {
    if !telegram.is_from_scanner() {
        return Err(ReplyError::NotFromScanner);
    }
    let (status, data) = telegram
        .data()
        .split_last()
        .ok_or(ReplyError::Size { bytes: 0 })?;
    Ok((telegram.command(), data, Status(*status)))
}

/// The longest configuration of any firmware, in bytes.
const MAX_CONFIGURATION: usize = 34;
/// The shortest.
const MIN_CONFIGURATION: usize = 32;

/// The scanner's settings of measuring, as it sends and takes them. What is not changed is kept as it
/// was: much of it is of no interest here, and some of it guards machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration {
    bytes: [u8; MAX_CONFIGURATION],
    length: usize,
}

impl Configuration {
    fn new(data: &[u8]) -> Result<Self, ReplyError> {
        let size = ReplyError::Size { bytes: data.len() };
        if data.len() < MIN_CONFIGURATION {
            return Err(size);
        }
        let mut bytes = [0; MAX_CONFIGURATION];
        bytes
            .get_mut(..data.len())
            .ok_or(size)?
            .copy_from_slice(data);
        Ok(Self {
            bytes,
            length: data.len(),
        })
    }

    /// The bytes as they are on the wire.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// The mode, if it is one that sends ranges.
    #[must_use]
    pub fn mode(&self) -> Option<MeasuringMode> {
        let code = self.bytes[5];
        MeasuringMode::ALL
            .into_iter()
            .find(|mode| mode.code() == code)
    }

    /// The same with this mode and unit.
    #[must_use]
    pub const fn with(mut self, mode: MeasuringMode, unit: Unit) -> Self {
        self.bytes[5] = mode.code();
        self.bytes[6] = unit.code();
        self
    }
}

/// What the scanner answers, apart from scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply<'a> {
    /// A0: to a change of operating mode or baud rate.
    Mode {
        /// Whether it was made.
        accepted: bool,
    },
    /// BB: to a change of variant.
    Variant {
        /// Whether it was made.
        accepted: bool,
        /// Field of view that is in force, degrees.
        field_of_view: u16,
        /// Step that is in force, hundredths of a degree.
        step: u16,
    },
    /// BA: what the scanner calls itself, in ASCII.
    Type(&'a [u8]),
    /// F4: the configuration in force.
    Configuration(Configuration),
    /// F7: to a new configuration.
    Configured {
        /// Whether it is in force.
        accepted: bool,
    },
    /// 92: the request makes no sense now.
    Refused,
    /// Another.
    Other {
        /// Its command.
        command: u8,
        /// What follows the command, without the status.
        data: &'a [u8],
    },
}

impl<'a> Reply<'a> {
    /// What `telegram` says, and the status that comes with it.
    ///
    /// # Errors
    /// [`ReplyError`] if a host has sent it, or if its size does not fit its command.
    pub fn decode(telegram: Telegram<'a>) -> Result<(Self, Status), ReplyError> {
        let (command, data, status) = split_reply(telegram)?;
        let size = Err(ReplyError::Size { bytes: data.len() });
        let reply = match (command, data) {
            (0xA0, [result]) => Self::Mode {
                accepted: *result == 0,
            },
            (0xBB, [result, low, high, step_low, step_high]) => Self::Variant {
                accepted: *result == 1,
                field_of_view: u16::from_le_bytes([*low, *high]),
                step: u16::from_le_bytes([*step_low, *step_high]),
            },
            (0xBA, name) => Self::Type(name),
            (0xF4, bytes) => Self::Configuration(Configuration::new(bytes)?),
            (0xF7, [result, ..]) => Self::Configured {
                accepted: *result == 1,
            },
            (0x92, []) => Self::Refused,
            (0xA0 | 0xBB | 0xF7 | 0x92, _) => return size,
            (command, data) => Self::Other { command, data },
        };
        Ok((reply, status))
    }
}

/// Speed of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Baud {
    /// 9600, the factory's setting.
    B9600,
    /// 19200.
    B19200,
    /// 38400.
    B38400,
    /// 500000, over RS-422 alone.
    B500000,
}

impl Baud {
    const fn code(self) -> u8 {
        match self {
            Self::B9600 => 0x42,
            Self::B19200 => 0x41,
            Self::B38400 => 0x40,
            Self::B500000 => 0x48,
        }
    }
}

/// The password of setup mode that every scanner leaves the factory with.
pub const FACTORY_PASSWORD: [u8; 8] = *b"SICK_LMS";

/// What a host asks of the scanner.
///
/// In order: [`Monitor`](Self::Monitor), since nothing is taken while scans are coming;
/// [`Setup`](Self::Setup); [`ReadConfiguration`](Self::ReadConfiguration) and
/// [`Configure`](Self::Configure) with the unit; [`Variant`](Self::Variant);
/// [`Continuous`](Self::Continuous).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// 20 25: no scans but on request.
    Monitor,
    /// 20 24: all scans, without being asked again.
    Continuous,
    /// 20 00: setup mode, in which the configuration can be changed, with the password.
    Setup([u8; 8]),
    /// 20 4x: another speed of the line.
    Baud(Baud),
    /// 30 01: one scan.
    OneScan,
    /// 31: the scanner's state.
    State,
    /// 3A: what the scanner calls itself.
    Type,
    /// 3B: field of view and step.
    Variant(Variant),
    /// 74: the configuration in force.
    ReadConfiguration,
    /// 77: another configuration.
    Configure(Configuration),
}

impl Request {
    /// Writes the request for the scanner at `address`, 0 for every scanner.
    ///
    /// # Errors
    /// [`TooLong`] if the buffer is shorter than the telegram.
    pub fn encode(self, buffer: &mut [u8], address: u8) -> Result<Telegram<'_>, TooLong> {
        let (command, data): (u8, &[u8]) = match &self {
            Self::Monitor => (0x20, &[0x25]),
            Self::Continuous => (0x20, &[0x24]),
            Self::Setup(_) => (0x20, &[0x00]),
            Self::Baud(_) => (0x20, &[]),
            Self::OneScan => (0x30, &[0x01]),
            Self::State => (0x31, &[]),
            Self::Type => (0x3A, &[]),
            Self::Variant(_) => (0x3B, &[]),
            Self::ReadConfiguration => (0x74, &[]),
            Self::Configure(configuration) => (0x77, configuration.as_bytes()),
        };
        let writer = TelegramWriter::request(buffer, address, command).bytes(data);
        match self {
            Self::Setup(password) => writer.bytes(&password),
            Self::Baud(baud) => writer.u8(baud.code()),
            Self::Variant(variant) => writer.u16(variant.field_of_view()).u16(variant.step()),
            _ => writer,
        }
        .finish()
    }
}
