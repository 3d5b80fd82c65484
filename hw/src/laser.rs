//! Laser scans: from the LMS200's telegrams, and as JSON lines.
//!
//! One object on each line, as the chapter `laser` of the law book has it:
//!
//! ```json
//! {"t": 1200, "first": -90.0, "step": 0.5, "reach": 8000, "ranges": [605, null, 8000]}
//! ```
//!
//! `t` is ms since the recording began and does not fall. `first` is the direction of the first range
//! from straight ahead, and `step` the angle to each next one, both in degrees, counter-clockwise
//! positive. `ranges` are whole mm; `reach` or more says that nothing came back from within reach, and
//! `null` that nothing is known.

use serde::{Deserialize, Serialize};
use sidestep::edge;
use sidestep::laser::{Missing, Reading, Scan};
use sidestep::quantity::{Instant, OutOfRange};
use sidestep::ring::Placement;
use std::fmt;
use std::io::{self, BufRead, Write};

/// Most ranges in a scan: half a turn by quarters of a degree.
pub const MOST_RANGES: usize = 721;

/// A scan with its geometry, as a line of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaserScan {
    /// When, ms.
    pub t: u64,
    /// Direction of the first range, degrees.
    pub first: f32,
    /// Angle from each to the next, degrees.
    pub step: f32,
    /// From here on nothing is seen, mm.
    pub reach: u32,
    /// Ranges in mm: [`reach`](Self::reach) or more if nothing came back from within reach, none if
    /// nothing is known.
    pub ranges: Vec<Option<u32>>,
}

impl LaserScan {
    /// A scan of the LMS200, which is taken to reach `reach` mm.
    ///
    /// Of all that is no range only [`Missing::TooFar`] says something: that nothing is nearer than
    /// the scanner reaches.
    #[must_use]
    pub fn of_lms200(scan: &Scan<'_>, t: u64, reach: u32) -> Self {
        let variant = scan.variant();
        let readings = (0..scan.count()).filter_map(|index| scan.reading(index));
        Self {
            t,
            first: -f32::from(variant.field_of_view()) / 2.0,
            step: f32::from(variant.step()) / 100.0,
            reach,
            ranges: readings
                .map(|reading| match reading {
                    Reading::Range(range) => Some(range.min(reach)),
                    Reading::Missing(Missing::TooFar) => Some(reach),
                    Reading::Missing(_) => None,
                })
                .collect(),
        }
    }

    /// Ranges in metres as the law takes them: infinity beyond reach, NaN where nothing is known.
    #[must_use]
    pub fn metres(&self) -> Vec<f32> {
        let metres = |range: &Option<u32>| match range {
            Some(range) if *range >= self.reach => f32::INFINITY,
            Some(range) => *range as f32 / 1000.0,
            None => f32::NAN,
        };
        self.ranges.iter().map(metres).collect()
    }

    /// The scan as the law takes it, of a scanner at `placement`; `metres` are its
    /// [`metres`](Self::metres).
    ///
    /// # Errors
    /// [`OutOfRange`] names what the law refuses.
    pub fn view<'a>(
        &self,
        placement: Placement,
        metres: &'a [f32],
    ) -> Result<edge::Scan<'a>, OutOfRange> {
        edge::Scan::new(
            placement,
            self.first.to_radians(),
            self.step.to_radians(),
            self.reach as f32 / 1000.0,
            metres,
            Instant(self.t),
        )
    }

    fn check(&self) -> Result<(), String> {
        let angle = |field, value: f32, max| {
            if value.abs() <= max {
                Ok(())
            } else {
                Err(format!("{field} is {value}°, allowed is -{max}° to {max}°"))
            }
        };
        angle("first", self.first, 360.0)?;
        angle("step", self.step, 5.0)?;
        if self.step <= 0.0 {
            return Err(format!("step is {}°, allowed is more than 0°", self.step));
        }
        if !(500..=100_000).contains(&self.reach) {
            return Err(format!(
                "reach is {} mm, allowed is 500 mm to 100000 mm",
                self.reach
            ));
        }
        if !(2..=MOST_RANGES).contains(&self.ranges.len()) {
            return Err(format!(
                "{} ranges, allowed is 2 to {MOST_RANGES}",
                self.ranges.len()
            ));
        }
        Ok(())
    }
}

/// Why a recording cannot be read.
#[derive(Debug)]
pub enum ReadError {
    /// The input failed.
    Input(io::Error),
    /// A line is no scan: its number, from 1, and why.
    Line(usize, String),
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Line(line, reason) => write!(f, "line {line}: {reason}"),
        }
    }
}

impl std::error::Error for ReadError {}

/// Reads a recording; lines of nothing but spaces are passed over.
///
/// # Errors
/// [`ReadError`] at the first line that is no scan, or earlier than the one before.
pub fn read(input: impl BufRead) -> Result<Vec<LaserScan>, ReadError> {
    let mut scans: Vec<LaserScan> = Vec::new();
    for (i, line) in input.lines().enumerate() {
        let line = line.map_err(ReadError::Input)?;
        if line.trim().is_empty() {
            continue;
        }
        let wrong = |reason| ReadError::Line(i + 1, reason);
        let scan: LaserScan =
            serde_json::from_str(&line).map_err(|error| wrong(error.to_string()))?;
        scan.check().map_err(wrong)?;
        if let Some(last) = scans.last()
            && scan.t < last.t
        {
            return Err(wrong(format!("t is {} ms after {} ms", scan.t, last.t)));
        }
        scans.push(scan);
    }
    Ok(scans)
}

/// Appends a scan to a recording.
///
/// # Errors
/// If the output fails.
pub fn write(output: &mut impl Write, scan: &LaserScan) -> io::Result<()> {
    serde_json::to_writer(&mut *output, scan)?;
    output.write_all(b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidestep::laser::{MAX_TELEGRAM, MeasuringMode, Status, Unit, Variant};

    #[test]
    fn a_telegram_becomes_a_line_and_a_view() {
        let mut buffer = [0; MAX_TELEGRAM];
        let words = |index| match index {
            0 => 0x1FFF,
            1 => 0x1FF7,
            2 => 8100,
            index => 500 + index,
        };
        let variant = Variant::Degrees180Step1;
        let telegram = Scan::encode(
            &mut buffer,
            0,
            variant,
            Unit::Millimetre,
            Status(0x10),
            words,
        );
        let scan = Scan::new_checked(telegram.expect("it fits"), MeasuringMode::default());
        let scan = LaserScan::of_lms200(&scan.expect("a scan"), 40, 8000);
        assert_eq!(scan.ranges[..4], [None, Some(8000), Some(8000), Some(503)]);
        let mut line = Vec::new();
        write(&mut line, &scan).expect("written");
        assert_eq!(read(&line[..]).expect("read"), std::slice::from_ref(&scan));
        let metres = scan.metres();
        assert!(metres[0].is_nan() && metres[1].is_infinite() && metres[2].is_infinite());
        assert_eq!(metres[3], 0.503);
        let placement = Placement {
            x: 0.1,
            y: 0.0,
            heading: 0.0,
        };
        let view = scan.view(placement, &metres).expect("a view");
        assert_eq!(view.taken_at(), Instant(40));
        assert_eq!(view.ranges().len(), 181);
    }

    #[test]
    fn what_is_no_scan_is_named() {
        let refused = |text: &str| read(text.as_bytes()).expect_err("refused").to_string();
        let good = r#"{"t": 5, "first": -90, "step": 90, "reach": 8000, "ranges": [605, null]}"#;
        assert_eq!(refused(good), "line 1: step is 90°, allowed is -5° to 5°");
        let good = good.replace("\"step\": 90", "\"step\": 1");
        assert_eq!(read(good.as_bytes()).expect("a scan").len(), 1);
        for (from, to, reason) in [
            ("605, null", "605", "1 ranges, allowed is 2 to 721"),
            ("8000", "0", "reach is 0 mm, allowed is 500 mm to 100000 mm"),
            ("-90", "999", "first is 999°, allowed is -360° to 360°"),
            (
                "\"step\": 1",
                "\"step\": 0",
                "step is 0°, allowed is more than 0°",
            ),
        ] {
            assert_eq!(
                refused(&good.replace(from, to)),
                format!("line 1: {reason}")
            );
        }
        let earlier = good.replace("\"t\": 5", "\"t\": 4");
        assert_eq!(
            refused(&format!("{good}\n\n{earlier}")),
            "line 3: t is 4 ms after 5 ms"
        );
        assert!(refused(&good.replace("605", "-1")).contains("line 1"));
        assert!(refused(&good.replace("605", "6.5")).contains("line 1"));
        assert!(refused("[]").contains("line 1"));
    }
}
