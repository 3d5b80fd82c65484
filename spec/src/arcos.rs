//! Chapter `arcos`: the serial protocol of the Pioneer bases. See `spec/arcos.md`.

/// The sum over a packet, number to last argument. Bytes at even places weigh 256, those at odd
/// places 1, modulo 2¹⁶; the last byte of an odd number is not added but exclusive-ored.
#[must_use]
pub fn checksum(packet: &[u8]) -> u16 {
    let paired = packet.len() / 2 * 2;
    let mut sum = 0_u32;
    let mut place = 0;
    while place < paired {
        let weight = if place % 2 == 0 { 256 } else { 1 };
        sum = (sum + weight * u32::from(packet[place])) % 65_536;
        place += 1;
    }
    if paired < packet.len() {
        sum ^= u32::from(packet[paired]);
    }
    sum as u16
}

/// arcos.INV-1: whether `bytes` are one frame, no more and no less.
#[must_use]
pub fn is_frame(bytes: &[u8]) -> bool {
    let length = bytes.len();
    length >= 6
        && bytes[0] == 0xFA
        && bytes[1] == 0xFB
        && bytes[2] <= 249
        && usize::from(bytes[2]) + 3 == length
        && checksum(&bytes[3..length - 2])
            == u16::from(bytes[length - 2]) * 256 + u16::from(bytes[length - 1])
}

/// arcos.INV-1: whether `bytes` begin with a frame.
#[must_use]
pub fn begins_with_frame(bytes: &[u8]) -> bool {
    bytes.len() >= 3
        && bytes.len() >= usize::from(bytes[2]) + 3
        && is_frame(&bytes[..usize::from(bytes[2]) + 3])
}

/// arcos.INV-2: whether a frame found in `bytes` is their beginning, and its arguments are all of it
/// but five bytes of frame and one of number.
#[must_use]
pub fn is_view(bytes: &[u8], frame: &[u8], arguments: &[u8]) -> bool {
    bytes.starts_with(frame)
        && frame.len() >= 6
        && frame[4..].starts_with(arguments)
        && frame.len() == arguments.len() + 6
}

/// arcos.INV-3: whether `bytes` are a frame with this number and these arguments.
#[must_use]
pub fn is_frame_of(bytes: &[u8], number: u8, arguments: &[u8]) -> bool {
    is_frame(bytes) && bytes[3] == number && bytes[4..bytes.len() - 2] == *arguments
}

/// arcos.INV-4: whether every frame in `stream` that begins before `held` was delivered or lies
/// under one that was. `delivered` holds the place and length of each frame delivered, in order.
#[must_use]
pub fn nothing_is_lost(stream: &[u8], delivered: &[(usize, usize)], held: usize) -> bool {
    nothing_is_lost_of(begins_with_frame, stream, delivered, held)
}

/// The same for any kind of frame, which `begins` recognises at the beginning of bytes.
pub(crate) fn nothing_is_lost_of(
    begins: fn(&[u8]) -> bool,
    stream: &[u8],
    delivered: &[(usize, usize)],
    held: usize,
) -> bool {
    let mut next = 0;
    let mut place = 0;
    while place < held {
        if next < delivered.len() && delivered[next].0 == place {
            if !begins(&stream[place..]) {
                return false;
            }
            place += delivered[next].1;
            next += 1;
        } else if begins(&stream[place..]) {
            return false;
        } else {
            place += 1;
        }
    }
    place == held && next == delivered.len()
}

/// arcos.INV-5: whether all bytes taken in are delivered, skipped or held, the last being less than
/// a frame.
#[must_use]
pub fn all_bytes_are_accounted_for(
    taken: usize,
    delivered: usize,
    skipped: usize,
    held: usize,
) -> bool {
    taken == delivered + skipped + held && held < 252
}

/// arcos.INV-6: whether a frame that was decoded and encoded again is the same.
#[must_use]
pub fn is_unchanged(before: &[u8], after: &[u8]) -> bool {
    before == after
}

/// arcos.INV-7: whether an integer argument's three bytes mean `value`.
#[must_use]
pub fn is_integer_argument(value: i32, bytes: [u8; 3]) -> bool {
    let magnitude = i32::from(bytes[1]) + 256 * i32::from(bytes[2]);
    match bytes[0] {
        0x3B => value == magnitude,
        0x1B => value == -magnitude && magnitude != 0,
        _ => false,
    }
}

/// arcos.INV-7: whether the protocol has an encoding for `value`.
#[must_use]
pub fn is_integer_encodable(value: i32) -> bool {
    (-65_535..=65_535).contains(&value)
}

/// arcos.INV-8 and arcos.INV-9: whether what follows the packet type is that of a SIP.
#[must_use]
pub fn is_information(kind: u8, arguments: &[u8]) -> bool {
    if !(0x30..=0x34).contains(&kind) || arguments.len() < 19 {
        return false;
    }
    let claimed = usize::from(arguments[18]);
    if claimed > 32 || arguments.len() < 19 + 3 * claimed {
        return false;
    }
    let mut reading = 0;
    while reading < claimed {
        if arguments[19 + 3 * reading] >= 32 {
            return false;
        }
        reading += 1;
    }
    true
}

/// arcos.INV-11: whether `delta` is the shortest way from one counter to the other, modulo 2¹⁵.
#[must_use]
pub fn is_shortest_delta(previous: u16, current: u16, delta: i16) -> bool {
    let remainder = (i32::from(current) - i32::from(previous) - i32::from(delta)) % 32_768;
    remainder == 0 && (-16_384..16_384).contains(&delta)
}

/// arcos.INV-12: whether a position moved no further than one SIP can move it.
#[must_use]
pub fn is_one_step(before: i64, after: i64) -> bool {
    let moved = i128::from(after) - i128::from(before);
    (-16_384..16_384).contains(&moved)
}

/// arcos.INV-13: whether `heading` is what a compass byte says to hosts of either convention.
#[must_use]
pub fn is_compass_heading(byte: u8, heading: Option<u16>) -> bool {
    match heading {
        None => byte == 0 || byte > 180,
        Some(heading) => {
            let doubled = 2 * i32::from(byte);
            let heading = i32::from(heading);
            (1..=180).contains(&byte)
                && (0..360).contains(&heading)
                && (heading - doubled).abs() <= 1
                && (heading - (doubled - 2)).abs() <= 1
        }
    }
}

/// arcos.INV-14: whether a string holds no NUL.
#[must_use]
pub fn is_text(bytes: &[u8]) -> bool {
    let mut place = 0;
    while place < bytes.len() {
        if bytes[place] == 0 {
            return false;
        }
        place += 1;
    }
    true
}

/// arcos.INV-10: whether a SIP's arguments hold these words at their places: x, y, heading, left and
/// right wheel speed, control, flags.
#[must_use]
pub fn holds_words(arguments: &[u8], words: [u16; 7]) -> bool {
    let places = [0, 2, 4, 6, 8, 13, 15];
    arguments.len() >= 19
        && places.iter().zip(words).all(|(&place, word)| {
            u16::from(arguments[place]) + 256 * u16::from(arguments[place + 1]) == word
        })
}
