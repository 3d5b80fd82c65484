//! Frames out of a byte stream.

use super::frame::{Frame, FrameError, MAX_FRAME};

/// What a [`Receiver`] has seen since it was made. Counts saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reception {
    /// Frames delivered.
    pub frames: u64,
    /// Bytes that belong to no frame delivered.
    pub skipped_bytes: u64,
    /// Candidates, complete from header to checksum, whose checksum was wrong.
    pub bad_checksums: u64,
}

/// Reassembles frames from a stream that may begin anywhere and contain anything.
///
/// Whatever fails to be a frame costs one byte: scanning resumes at the byte after its first, so a
/// good frame that begins inside a false one is still found. It is found late, though: a false header
/// withholds what follows until as many bytes have arrived as it claims, [`MAX_FRAME`] at most.
///
/// ```
/// use sidestep::arcos::Receiver;
///
/// let mut receiver = Receiver::new();
/// let mut input: &[u8] = &[0x00, 0xFA, 0xFB, 0x03, 0x1D, 0x00, 0x1D];
/// while let Some(frame) = receiver.next_frame(&mut input) {
///     assert_eq!(frame.number(), 29);
/// }
/// assert_eq!(receiver.reception().skipped_bytes, 1);
/// ```
pub type Receiver = BoundedReceiver<MAX_FRAME>;

/// A [`Receiver`] for frames of at most `LONGEST` bytes, which is at least 6: it takes less memory,
/// and a false header withholds less.
#[derive(Clone, Debug)]
pub struct BoundedReceiver<const LONGEST: usize> {
    buffer: [u8; LONGEST],
    /// Where the bytes not yet judged begin.
    start: usize,
    /// Where they end.
    end: usize,
    reception: Reception,
}

impl<const LONGEST: usize> Default for BoundedReceiver<LONGEST> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const LONGEST: usize> BoundedReceiver<LONGEST> {
    /// A receiver that holds no bytes.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(LONGEST >= 6, "the shortest frame has 6 bytes") };
        Self {
            buffer: [0; LONGEST],
            start: 0,
            end: 0,
            reception: Reception {
                frames: 0,
                skipped_bytes: 0,
                bad_checksums: 0,
            },
        }
    }

    /// The next frame. `None` means that `input` is used up: all that was in it has been delivered,
    /// skipped or kept as the beginning of a frame.
    //= arcos.INV-4
    //= arcos.INV-5
    pub fn next_frame(&mut self, input: &mut &[u8]) -> Option<Frame<'_>> {
        // Each turn takes bytes from `input` or skips one of those held.
        let length = loop {
            let held = self.buffer.get(self.start..self.end).unwrap_or_default();
            match Frame::new_checked(held) {
                Ok(frame) => break frame.as_bytes().len(),
                Err(FrameError::Truncated) if held.len() < LONGEST => {
                    if input.is_empty() {
                        return None;
                    }
                    self.fill(input);
                }
                Err(error) => {
                    if matches!(error, FrameError::Checksum { .. }) {
                        self.reception.bad_checksums =
                            self.reception.bad_checksums.saturating_add(1);
                    }
                    self.skip();
                }
            }
        };
        let begin = self.start;
        self.start += length;
        self.reception.frames = self.reception.frames.saturating_add(1);
        Frame::new_checked(self.buffer.get(begin..self.start)?).ok()
    }

    /// Forgets the bytes held, as after a change of baud rate. They count as skipped.
    pub fn clear(&mut self) {
        while self.start < self.end {
            self.skip();
        }
    }

    /// The counts so far.
    #[must_use]
    pub const fn reception(&self) -> Reception {
        self.reception
    }

    fn skip(&mut self) {
        self.start += 1;
        self.reception.skipped_bytes = self.reception.skipped_bytes.saturating_add(1);
    }

    /// Moves the bytes held to the front and as many of `input` behind them as there is room for.
    fn fill(&mut self, input: &mut &[u8]) {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let free = self.buffer.get_mut(self.end..).unwrap_or_default();
        let (taken, rest) = input.split_at(input.len().min(free.len()));
        if let Some(room) = free.get_mut(..taken.len()) {
            room.copy_from_slice(taken);
        }
        self.end += taken.len();
        *input = rest;
    }
}
