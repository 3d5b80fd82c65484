//! Chapter `laser`: the telegrams of the SICK LMS200 laser scanner. See `spec/laser.md`.

use crate::arcos::nothing_is_lost_of;

/// The scanner's checksum, in numbers instead of bits: for each byte the sum is doubled; a carry out
/// of 16 bits is dropped, and 32 773 exclusive-ored for it; then 256 times the byte before and the
/// byte are.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u16 {
    let mut sum = 0_u32;
    let mut place = 0;
    while place < bytes.len() {
        sum *= 2;
        if sum >= 65_536 {
            sum = (sum - 65_536) ^ 32_773;
        }
        let before = if place > 0 { bytes[place - 1] } else { 0 };
        sum ^= u32::from(before) * 256 + u32::from(bytes[place]);
        place += 1;
    }
    sum as u16
}

/// laser.INV-1: whether `bytes` are one telegram, no more and no less.
#[must_use]
pub fn is_telegram(bytes: &[u8]) -> bool {
    let length = bytes.len();
    if length < 7 || bytes[0] != 2 {
        return false;
    }
    let payload = usize::from(bytes[2]) + 256 * usize::from(bytes[3]);
    payload <= 812
        && payload + 6 == length
        && u32::from(checksum(&bytes[..length - 2]))
            == u32::from(bytes[length - 2]) + 256 * u32::from(bytes[length - 1])
}

/// laser.INV-1: whether `bytes` begin with a telegram.
#[must_use]
pub fn begins_with_telegram(bytes: &[u8]) -> bool {
    if bytes.len() < 7 {
        return false;
    }
    let length = usize::from(bytes[2]) + 256 * usize::from(bytes[3]) + 6;
    bytes.len() >= length && is_telegram(&bytes[..length])
}

/// laser.INV-2: whether a telegram found in `bytes` is their beginning, and its data all of it but
/// four bytes of header, one of command and two of checksum.
#[must_use]
pub fn is_view(bytes: &[u8], telegram: &[u8], data: &[u8]) -> bool {
    bytes.starts_with(telegram)
        && telegram.len() >= 7
        && telegram[5..].starts_with(data)
        && telegram.len() == data.len() + 7
}

/// laser.INV-3: whether `bytes` are a telegram with this address byte, command and data.
#[must_use]
pub fn is_telegram_of(bytes: &[u8], address: u8, command: u8, data: &[u8]) -> bool {
    is_telegram(bytes)
        && bytes[1] == address
        && bytes[4] == command
        && bytes[5..bytes.len() - 2] == *data
}

/// laser.INV-4: whether every telegram in `stream` that begins before `held` was delivered or lies
/// under one that was. `delivered` holds the place and length of each one delivered, in order.
#[must_use]
pub fn nothing_is_lost(stream: &[u8], delivered: &[(usize, usize)], held: usize) -> bool {
    nothing_is_lost_of(begins_with_telegram, stream, delivered, held)
}

/// laser.INV-5: whether all bytes taken in are delivered, skipped or held, the last being less than
/// a telegram.
#[must_use]
pub fn all_bytes_are_accounted_for(
    taken: usize,
    delivered: usize,
    skipped: usize,
    held: usize,
) -> bool {
    taken == delivered + skipped + held && held < 818
}

/// laser.INV-6: whether `millimetres` is what a word means of which the lowest `bits` bits are the
/// value, in units of `unit` mm. `dazzled` says that the word has a bit for that, and it is set.
#[must_use]
pub fn is_reading(
    word: u16,
    bits: u32,
    unit: u32,
    dazzled: bool,
    millimetres: Option<u32>,
) -> bool {
    let values = 2_u32.pow(bits);
    let value = u32::from(word) % values;
    // The 9 highest values are codes.
    let is_range = !dazzled && value + 9 < values;
    match millimetres {
        Some(range) => is_range && range == value * unit,
        None => !is_range,
    }
}

/// laser.INV-7: whether value `index` of a scan over `field_of_view` degrees lies at `bearing`
/// hundredths of a degree: the first half a field of view to the right, each further `step`
/// hundredths to the left of the one before, the last half a field of view to the left.
#[must_use]
pub fn is_bearing(index: u32, field_of_view: u32, step: u32, bearing: Option<i64>) -> bool {
    let steps = field_of_view * 100 / step;
    match bearing {
        Some(bearing) => {
            index <= steps
                && bearing
                    == i64::from(index) * i64::from(step) - i64::from(field_of_view) * 100 / 2
        }
        None => index > steps,
    }
}

/// laser.INV-8: whether `telegram` is one whole scan that the scanner itself trusts: a reply with
/// values, as many as one of the five variants has, in cm or mm, with at most two index bytes behind
/// them, and a status of severity 0, 1 or 2 without the mark of implausible values.
#[must_use]
pub fn is_scan(telegram: &[u8]) -> bool {
    if !is_telegram(telegram) || telegram[1] < 128 || telegram[4] != 0xB0 {
        return false;
    }
    let data = &telegram[5..telegram.len() - 2];
    if data.len() < 3 {
        return false;
    }
    let header = u32::from(data[0]) + 256 * u32::from(data[1]);
    let count = header % 2048;
    let status = data[data.len() - 1];
    let indices = data.len() as i64 - 3 - 2 * i64::from(count);
    [101, 181, 201, 361, 401].contains(&count)
        && header / 2048 % 8 == 0
        && header / 16_384 < 2
        && (0..=2).contains(&indices)
        && status % 8 < 3
        && (status / 64).is_multiple_of(2)
}
