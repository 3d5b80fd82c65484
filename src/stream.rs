//! Frames out of a byte stream, whatever their format.

/// A format of frames that begin with something to recognise them by and carry a checksum.
pub trait Framing {
    /// A frame whose bytes have been checked, as a view over them.
    type Frame<'a>;

    /// Length of the shortest frame in bytes.
    const SHORTEST: usize;

    /// Judges what `bytes` begin with.
    fn judge(bytes: &[u8]) -> Judgement;

    /// The frame that `bytes` are, which [`judge`](Self::judge) has found whole.
    fn view(bytes: &[u8]) -> Option<Self::Frame<'_>>;
}

/// What bytes begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judgement {
    /// A frame of this many bytes.
    Whole(usize),
    /// What more bytes could still make a frame.
    Truncated,
    /// No frame, whatever follows.
    Not,
    /// What would be a frame if its checksum were right.
    BadChecksum,
}

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

/// Reassembles frames of at most `LONGEST` bytes from a stream that may begin anywhere and contain
/// anything.
///
/// Whatever fails to be a frame costs one byte: scanning resumes at the byte after its first, so a
/// good frame that begins inside a false one is still found. It is found late, though: a false header
/// withholds what follows until as many bytes have arrived as it claims, `LONGEST` at most.
#[derive(Clone, Debug)]
pub struct Receiver<F, const LONGEST: usize> {
    buffer: [u8; LONGEST],
    /// Where the bytes not yet judged begin.
    start: usize,
    /// Where they end.
    end: usize,
    reception: Reception,
    framing: core::marker::PhantomData<F>,
}

impl<F: Framing, const LONGEST: usize> Default for Receiver<F, LONGEST> {
    fn default() -> Self {
        Self::new()
    }
}

impl<F: Framing, const LONGEST: usize> Receiver<F, LONGEST> {
    /// A receiver that holds no bytes.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(LONGEST >= F::SHORTEST, "no frame is that short") };
        Self {
            buffer: [0; LONGEST],
            start: 0,
            end: 0,
            reception: Reception {
                frames: 0,
                skipped_bytes: 0,
                bad_checksums: 0,
            },
            framing: core::marker::PhantomData,
        }
    }

    /// The next frame. `None` means that `input` is used up: all that was in it has been delivered,
    /// skipped or kept as the beginning of a frame.
    //= arcos.INV-4
    //= arcos.INV-5
    //= laser.INV-4
    //= laser.INV-5
    pub fn next_frame(&mut self, input: &mut &[u8]) -> Option<F::Frame<'_>> {
        // Each turn takes bytes from `input` or skips one of those held.
        let length = loop {
            let held = self.buffer.get(self.start..self.end).unwrap_or_default();
            match F::judge(held) {
                Judgement::Whole(length) => break length,
                Judgement::Truncated if held.len() < LONGEST => {
                    if input.is_empty() {
                        return None;
                    }
                    self.fill(input);
                }
                judgement => {
                    if judgement == Judgement::BadChecksum {
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
        F::view(self.buffer.get(begin..self.start)?)
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
