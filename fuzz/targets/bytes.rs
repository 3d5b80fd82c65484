//! Reading values from bytes. Past their end every value is zero.

use sidestep::quantity::{Angle, Length, Speed};

/// Bytes that are read from front to back.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// All of `data`.
    #[must_use]
    pub const fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    /// Nothing is left.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let (now, later) = self.0.split_at(self.0.len().min(N));
        taken[..now.len()].copy_from_slice(now);
        self.0 = later;
        taken
    }

    /// The next byte.
    pub fn u8(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    /// The next two bytes.
    pub fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    /// The next four bytes.
    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    /// The next eight bytes.
    pub fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    /// One bit of the next byte.
    pub fn truth(&mut self) -> bool {
        self.u8() & 1 == 1
    }

    /// A number: mostly one that a sensor might give, now and then any bit pattern. Fuzzers
    /// rarely hit upon a plausible float by themselves.
    pub fn number(&mut self) -> f32 {
        match self.u8() {
            0..=0x7F => f32::from(self.u16() as i16) / 1000.0,
            0x80..=0xBF => f32::from(self.u16()) / 1000.0,
            0xC0..=0xDF => f32::from(self.u16() as i16) / 10.0,
            0xE0..=0xEF => {
                let corners = [
                    0.0,
                    -0.0,
                    1.0,
                    f32::NAN,
                    f32::INFINITY,
                    f32::MAX,
                    1e-45,
                    -1.0,
                ];
                corners[usize::from(self.u8()) % corners.len()]
            }
            0xF0..=0xFF => f32::from_bits(self.u32()),
        }
    }

    /// A share of something, from 0 to 1.
    pub fn share(&mut self) -> f32 {
        f32::from(self.u8()) / 255.0
    }

    /// A length: of a number its size, where that is a length.
    pub fn length(&mut self) -> Length {
        Length::metres(self.number().abs()).unwrap_or(Length::MAX)
    }

    /// A speed: of a number its size, where that is a speed.
    pub fn speed(&mut self) -> Speed {
        Speed::metres_per_second(self.number().abs()).unwrap_or(Speed::MAX)
    }

    /// An angle: a number, where that is an angle.
    pub fn angle(&mut self) -> Angle {
        Angle::radians(self.number()).unwrap_or(Angle::HALF_TURN)
    }
}
