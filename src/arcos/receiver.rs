//! Frames out of a byte stream.

use super::frame::{Frame, FrameError, MAX_FRAME};
use crate::stream::{self, Framing, Judgement};

/// The framing of [`Frame`].
#[derive(Clone, Copy, Debug)]
pub enum ArcosFraming {}

impl Framing for ArcosFraming {
    type Frame<'a> = Frame<'a>;

    const SHORTEST: usize = 6;

    fn judge(bytes: &[u8]) -> Judgement {
        match Frame::new_checked(bytes) {
            Ok(frame) => Judgement::Whole(frame.as_bytes().len()),
            Err(FrameError::Truncated) => Judgement::Truncated,
            Err(FrameError::Checksum { .. }) => Judgement::BadChecksum,
            Err(FrameError::Header | FrameError::Count(_)) => Judgement::Not,
        }
    }

    fn view(bytes: &[u8]) -> Option<Frame<'_>> {
        Frame::new_checked(bytes).ok()
    }
}

/// Reassembles frames from a stream that may begin anywhere and contain anything: see
/// [`stream::Receiver`].
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
pub type BoundedReceiver<const LONGEST: usize> = stream::Receiver<ArcosFraming, LONGEST>;
