//! Skeletons from a depth camera's program, as lines of JSON.
//!
//! One line is one frame:
//!
//! ```json
//! {"t": 41730, "people": [{"id": 7, "neck": [0.12, 0.31, 2.4],
//!   "left_shoulder": [-0.05, 0.22, 2.4], "right_shoulder": [0.29, 0.23, 2.4],
//!   "left_elbow": [-0.08, -0.09, 2.4], "right_elbow": [0.33, -0.08, 2.4],
//!   "left_wrist": [-0.08, -0.33, 2.3], "right_wrist": [0.33, -0.32, 2.3]}]}
//! ```
//!
//! - `t`: when the picture was taken, ms of the camera's own clock, from any beginning.
//! - `people`: everybody seen, an empty list if nobody is. Send it: silence is a camera that failed.
//! - `id`: the same person has the same number from frame to frame.
//! - joints: metres in the camera's frame, x to its left, y straight up, z ahead (a Kinect v2's
//!   camera space; of an optical frame negate x and y). Left and right are the person's own. A joint
//!   that is not tracked, or only inferred, is left out or `null`.
//!
//! Other fields are passed over. In a frame with more than six people the six nearest are kept.

use serde::{Deserialize, Serialize};
use sidestep::gesture::{Frame, PEOPLE_MAX, Point, Skeleton};
use sidestep::quantity::Instant;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::net::TcpStream;

/// The longest line that is read, in bytes.
const LINE_MAX: u64 = 1 << 16;

/// A frame as a line has it.
#[derive(Serialize, Deserialize)]
struct Line {
    t: u64,
    people: Vec<Body>,
}

#[derive(Serialize, Deserialize)]
struct Body {
    id: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    neck: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_shoulder: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    right_shoulder: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_elbow: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    right_elbow: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    left_wrist: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    right_wrist: Option<[f32; 3]>,
}

impl From<&Body> for Skeleton {
    fn from(body: &Body) -> Self {
        let point = |joint: Option<[f32; 3]>| joint.map(Point::from);
        Self {
            id: body.id,
            neck: point(body.neck),
            left_shoulder: point(body.left_shoulder),
            right_shoulder: point(body.right_shoulder),
            left_elbow: point(body.left_elbow),
            right_elbow: point(body.right_elbow),
            left_wrist: point(body.left_wrist),
            right_wrist: point(body.right_wrist),
        }
    }
}

impl From<&Skeleton> for Body {
    fn from(skeleton: &Skeleton) -> Self {
        let array = |joint: Option<Point>| joint.map(|at| [at.x, at.y, at.z]);
        Self {
            id: skeleton.id,
            neck: array(skeleton.neck),
            left_shoulder: array(skeleton.left_shoulder),
            right_shoulder: array(skeleton.right_shoulder),
            left_elbow: array(skeleton.left_elbow),
            right_elbow: array(skeleton.right_elbow),
            left_wrist: array(skeleton.left_wrist),
            right_wrist: array(skeleton.right_wrist),
        }
    }
}

/// How far away somebody is by their nearest joint, m; nearest of all if no joint says.
fn nearest_depth(skeleton: &Skeleton) -> f32 {
    let depth = skeleton
        .joints()
        .into_iter()
        .flatten()
        .map(|at| at.z)
        .filter(|z| z.is_finite())
        .fold(f32::INFINITY, f32::min);
    if depth.is_finite() { depth } else { 0.0 }
}

/// The frame that a line is. Its time is the camera's.
///
/// # Errors
/// What is wrong with the line.
pub fn parse(line: &str) -> Result<Frame, String> {
    let line: Line = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let mut everybody: Vec<Skeleton> = line.people.iter().map(Skeleton::from).collect();
    if everybody.len() > PEOPLE_MAX {
        everybody.sort_by(|one, other| nearest_depth(one).total_cmp(&nearest_depth(other)));
    }
    let mut people = [None; PEOPLE_MAX];
    for (place, skeleton) in people.iter_mut().zip(everybody) {
        *place = Some(skeleton);
    }
    Ok(Frame {
        taken_at: Instant(line.t),
        people,
    })
}

/// A frame as a line, without the end of it.
///
/// # Errors
/// If a coordinate is not finite: JSON has no word for it.
pub fn to_line(frame: &Frame) -> Result<String, String> {
    let people: Vec<Body> = frame.people.iter().flatten().map(Body::from).collect();
    let joints = frame.people.iter().flatten().flat_map(Skeleton::joints);
    for joint in joints.flatten() {
        if !joint.iter().all(|x| x.is_finite()) {
            return Err(format!("a joint is at {joint:?}"));
        }
    }
    let line = Line {
        t: frame.taken_at.0,
        people,
    };
    serde_json::to_string(&line).map_err(|error| error.to_string())
}

/// Where lines come from.
pub struct Lines {
    input: BufReader<Box<dyn Read + Send>>,
    source: String,
    number: u64,
}

impl Lines {
    /// Opens a source: `-` is standard input, `tcp:HOST:PORT` a server to connect to, anything else
    /// a file or a named pipe.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(source: &str) -> Result<Self, String> {
        let named = |error: io::Error| format!("{source}: {error}");
        let input: Box<dyn Read + Send> = if source == "-" {
            Box::new(io::stdin())
        } else if let Some(address) = source.strip_prefix("tcp:") {
            Box::new(TcpStream::connect(address).map_err(named)?)
        } else {
            Box::new(File::open(source).map_err(named)?)
        };
        Ok(Self::new(input, source))
    }

    /// Lines of any reader; `source` is what to call it.
    pub fn new(input: Box<dyn Read + Send>, source: &str) -> Self {
        Self {
            input: BufReader::new(input),
            source: source.to_owned(),
            number: 0,
        }
    }
}

impl Iterator for Lines {
    type Item = Result<Frame, String>;

    /// The next frame, or what is wrong with the next line; none when the source has ended. After a
    /// bad line the next one may be good.
    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut bytes = Vec::new();
            self.number += 1;
            let wrong =
                |reason: String| Some(Err(format!("{}:{}: {reason}", self.source, self.number)));
            let mut limited = (&mut self.input).take(LINE_MAX);
            match limited.read_until(b'\n', &mut bytes) {
                Ok(0) => return None,
                Ok(_) => {}
                Err(error) => return wrong(error.to_string()),
            }
            if bytes.last() != Some(&b'\n') && bytes.len() as u64 == LINE_MAX {
                if let Err(error) = skip_line(&mut self.input) {
                    return wrong(error.to_string());
                }
                return wrong(format!("longer than {LINE_MAX} bytes"));
            }
            match std::str::from_utf8(&bytes) {
                Ok(line) if line.trim().is_empty() => {}
                Ok(line) => {
                    return Some(
                        parse(line.trim())
                            .map_err(|reason| format!("{}:{}: {reason}", self.source, self.number)),
                    );
                }
                Err(error) => return wrong(error.to_string()),
            }
        }
    }
}

/// Reads on to the end of a line, whatever its length.
fn skip_line(input: &mut impl BufRead) -> io::Result<()> {
    loop {
        let available = input.fill_buf()?;
        if available.is_empty() {
            return Ok(());
        }
        let end = available.iter().position(|byte| *byte == b'\n');
        let used = end.map_or(available.len(), |end| end + 1);
        input.consume(used);
        if end.is_some() {
            return Ok(());
        }
    }
}

/// Tells times of the camera's clock in a clock of ours.
///
/// The two clocks may begin anywhere. The frame that was quickest to arrive says how they differ;
/// one that takes longer was taken earlier, so frames that pile up on their way show their age. What
/// the quickest frame said is forgotten at 1 ms a second: clocks drift apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraClock {
    /// Ours less the camera's, as little as it has been, ms, and when it was, in our time.
    quickest: Option<(i64, u64)>,
}

impl CameraClock {
    /// When a frame that has arrived at `arrived` of our clock was taken, in our clock; never later
    /// than it arrived.
    pub fn taken(&mut self, camera: Instant, arrived: u64) -> Instant {
        let ours = i64::try_from(arrived).unwrap_or(i64::MAX);
        let theirs = i64::try_from(camera.0).unwrap_or(i64::MAX);
        let difference = ours.saturating_sub(theirs);
        let quickest = match self.quickest {
            Some((quickest, at)) => {
                let forgotten = (arrived.saturating_sub(at) / 1000) as i64;
                if difference <= quickest.saturating_add(forgotten) {
                    self.quickest = Some((difference, arrived));
                    difference
                } else {
                    quickest.saturating_add(forgotten)
                }
            }
            None => {
                self.quickest = Some((difference, arrived));
                difference
            }
        };
        let taken = theirs.saturating_add(quickest).clamp(0, ours);
        Instant(taken.unsigned_abs())
    }
}
