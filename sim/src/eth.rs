//! Reader of recorded pedestrians in the form of the ETH *Walking Pedestrians* data set
//! (`obsmat.txt`).
//!
//! Each line holds eight numbers: video frame, person, x, z, y (m), vx, vz, vy (m/s). z is 0. The
//! sequences *eth* and *hotel* are videos of 25 frames per second in which every 10th (hotel) frame
//! is annotated.
//!
//! Source: S. Pellegrini, A. Ess, K. Schindler, L. van Gool, *You'll Never Walk Alone: Modeling
//! Social Behavior for Multi-target Tracking*, ICCV 2009.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::Error;
use crate::geometry::Point;
use crate::person::{Motion, Person, Sample};
use crate::table;

/// Frames per second of the videos.
pub const FRAME_RATE: f64 = 25.0;

/// Everyone in the file at `path`, in the order of their numbers; the first frame of the file is at
/// time 0.
pub fn read(path: &Path) -> Result<Vec<Person>, Error> {
    parse(&table::load(path)?, path)
}

/// The same from text already read; `path` only names it in errors.
pub fn parse(text: &str, path: &Path) -> Result<Vec<Person>, Error> {
    let mut rows = Vec::new();
    for (line, row) in table::rows(text) {
        let fields: Vec<&str> = row.split_ascii_whitespace().collect();
        let [frame, id, x, _z, y, _vx, _vz, _vy] = table::numbers(&fields, path, line)?;
        let id = table::whole("person", id, path, line)?;
        rows.push((line, frame, id, Point::new(x, y)));
    }
    let first = rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min);
    let mut tracks: BTreeMap<u32, Vec<Sample>> = BTreeMap::new();
    for (line, frame, id, position) in rows {
        let track = tracks.entry(id).or_default();
        let time = (frame - first) / FRAME_RATE;
        if track.last().is_some_and(|last| time <= last.time) {
            return Err(table::malformed(
                path,
                line,
                format!("frame {frame} of person {id} does not come after the one before"),
            ));
        }
        track.push(Sample { time, position });
    }
    tracks
        .into_values()
        .map(|track| Person::new(Motion::Track(track)))
        .collect()
}
