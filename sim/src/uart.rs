//! What a receiver makes of bytes sent at another baud rate than its own.

/// Bits of one byte on the line: a low start bit, eight data bits, a high stop bit (8N1).
const FRAME: usize = 10;

/// The bytes that a receiver at `heard_at` baud reads from the uninterrupted sending of `bytes` at
/// `sent_at` baud.
///
/// The receiver waits for a falling edge and samples the middle of each of its own bits. A byte
/// without a stop bit is read as 0, as by a serial driver that does not report framing errors.
/// Equal rates give back the bytes; a rate of 0 is a dead line.
#[must_use]
pub fn heard(bytes: &[u8], sent_at: u32, heard_at: u32) -> Vec<u8> {
    if sent_at == heard_at {
        return bytes.to_vec();
    }
    if sent_at == 0 || heard_at == 0 {
        return Vec::new();
    }
    // The line's level during the sender's `n`th bit; it idles high before and after.
    let level = |n: usize| match (bytes.get(n / FRAME), n % FRAME) {
        (Some(_), 0) => false,
        (Some(byte), data @ 1..=8) => byte >> (data - 1) & 1 == 1,
        _ => true,
    };
    // The receiver's bits, measured in the sender's.
    let bit = f64::from(sent_at) / f64::from(heard_at);
    let sample = |edge: usize, n: f64| level((edge as f64 + (n + 0.5) * bit) as usize);

    let mut heard = Vec::new();
    let mut from = 0;
    while let Some(edge) =
        (from..bytes.len() * FRAME).find(|&n| !level(n) && (n == 0 || level(n - 1)))
    {
        from = edge + 1;
        if sample(edge, 0.0) {
            continue; // too short for a start bit
        }
        let byte = (0..8).fold(0, |byte, n| {
            byte | u8::from(sample(edge, 1.0 + f64::from(n))) << n
        });
        let stopped = sample(edge, 9.0);
        heard.push(if stopped { byte } else { 0 });
        from = from.max((edge as f64 + 9.5 * bit) as usize);
    }
    heard
}

#[cfg(test)]
mod tests {
    use super::heard;

    const STOP: [u8; 6] = [0xFA, 0xFB, 3, 29, 0, 29];

    #[test]
    fn the_right_rate_hears_what_was_sent() {
        assert_eq!(heard(&STOP, 9600, 9600), STOP);
        // A rate that is off by 3 % samples every bit within its middle.
        assert_eq!(heard(&STOP, 9600, 9888), STOP);
    }

    #[test]
    fn a_wrong_rate_hears_no_frame() {
        for rates in [
            (9600, 38400),
            (38400, 9600),
            (9600, 115_200),
            (57600, 38400),
        ] {
            let bytes = heard(&STOP.repeat(5), rates.0, rates.1);
            assert!(
                !bytes.windows(2).any(|pair| pair == [0xFA, 0xFB]),
                "{bytes:x?}"
            );
        }
    }

    #[test]
    fn twice_the_rate_hears_each_bit_twice() {
        // 0x00 at half the rate: 18 low samples, then high. The first 10 lack a stop bit.
        assert_eq!(heard(&[0x00], 4800, 9600), [0]);
        // 0xFF: only the start bit is low, two samples of it.
        assert_eq!(heard(&[0xFF], 4800, 9600), [0xFE]);
    }

    #[test]
    fn a_dead_line_is_silent() {
        assert_eq!(heard(&STOP, 0, 9600), []);
    }
}
