//! The log of a run: JSON lines, complete enough to run the controller again on it.
//!
//! The first line is the [`Header`]. Every other line is a [`Record`]: a packet as it came over the
//! wire with what the controller made of it, or a stop that no packet shows, or an event to read.
//! Lines are written one by one and whole, so that a run that ends at once loses at most a line.

use crate::config::{HeadingSource, RobotConfig, Sonars};
use crate::pilot::USUAL_LAW;
use serde::{Deserialize, Serialize};
use sidestep::config::{Config, FIELDS, Parameters};
use std::collections::BTreeMap;
use std::io::{BufRead, Write};

/// What a run starts from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of the format, 1.
    pub log: u32,
    /// Version of the program that wrote it.
    pub program: String,
    /// The law that drove; in logs from before there were several, the usual one.
    #[serde(default = "usual_law")]
    pub law: String,
    /// The base's subclass, which says what its units are.
    pub subclass: String,
    /// The goal in the odometry frame, metres.
    pub goal: [f64; 2],
    /// Sonars fitted.
    pub sonars: Sonars,
    /// Where the heading comes from.
    pub heading: HeadingSource,
    /// Every parameter by name, in SI units.
    pub parameters: BTreeMap<String, f64>,
}

/// What the robot was told.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Told {
    /// Forward speed, mm/s.
    pub v: i32,
    /// Turn rate, milliradians/s.
    pub w: i32,
    /// What the law was doing.
    pub mode: String,
    /// The most severe of what was done about anything, if anything was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub action: Option<String>,
    /// Why the robot was made to stand still, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<String>,
    /// What made it slower than advised, if anything did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<String>,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Record {
    /// A valid information packet and the tick that it made.
    Tick {
        /// Milliseconds since the start.
        t: u64,
        /// The packet's frame, hexadecimal.
        sip: String,
        /// What the robot was told.
        told: Told,
    },
    /// A stop that no packet shows, such as a lost link.
    Halt {
        /// Milliseconds since the start.
        t: u64,
        /// Why.
        reason: Halt,
        /// What the robot was told.
        told: Told,
    },
    /// Somebody reset a latched stop.
    Reset {
        /// Milliseconds since the start.
        t: u64,
    },
    /// The base's counters were set to zero: the odometry frame begins here.
    Origin {
        /// Milliseconds since the start.
        t: u64,
    },
    /// Something to know.
    Event {
        /// Milliseconds since the start.
        t: u64,
        /// What happened.
        text: String,
    },
}

/// Stops that no packet shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Halt {
    /// The link to the base was lost.
    LinkLost,
    /// The operator ended the run.
    Operator,
}

fn usual_law() -> String {
    USUAL_LAW.to_owned()
}

impl Header {
    /// The header of a run with the usual law.
    #[must_use]
    pub fn new(config: &RobotConfig, subclass: &str, goal: [f32; 2]) -> Self {
        let values = config.core.values();
        Self {
            log: 1,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            law: usual_law(),
            subclass: subclass.to_owned(),
            goal: goal.map(f64::from),
            sonars: config.sonars,
            heading: config.heading,
            // An f64 holds every f32 and prints so that it reads back as the same.
            parameters: FIELDS
                .iter()
                .zip(values)
                .map(|(field, value)| (field.name.to_owned(), f64::from(value)))
                .collect(),
        }
    }

    /// The configuration of the run.
    ///
    /// # Errors
    /// What is missing, unknown or out of range.
    pub fn config(&self) -> Result<RobotConfig, String> {
        if self.log != 1 {
            return Err(format!("log is version {}, allowed is 1", self.log));
        }
        let known = |name: &String| FIELDS.iter().any(|field| field.name == name);
        if let Some(name) = self.parameters.keys().find(|name| !known(name)) {
            return Err(format!("unknown parameter {name}"));
        }
        let mut values = [0.0; FIELDS.len()];
        for (value, field) in values.iter_mut().zip(&FIELDS) {
            *value = *self
                .parameters
                .get(field.name)
                .ok_or_else(|| format!("parameter {} is missing", field.name))?
                as f32;
        }
        Ok(RobotConfig {
            core: Config::new(Parameters::from_values(values))
                .map_err(|error| error.to_string())?,
            sonars: self.sonars,
            heading: self.heading,
        })
    }
}

/// Bytes as hexadecimal digits.
#[must_use]
pub fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Bytes from hexadecimal digits.
#[must_use]
pub fn from_hex(text: &str) -> Option<Vec<u8>> {
    if !text.is_ascii() || !text.len().is_multiple_of(2) {
        return None;
    }
    (0..text.len())
        .step_by(2)
        .map(|i| u8::from_str_radix(&text[i..i + 2], 16).ok())
        .collect()
}

/// Writes one line and hands it to the system at once.
///
/// # Errors
/// If it cannot be written.
pub fn write_line(out: &mut dyn Write, line: &impl Serialize) -> std::io::Result<()> {
    let mut text = serde_json::to_string(line)?;
    text.push('\n');
    out.write_all(text.as_bytes())?;
    out.flush()
}

/// A log that was read, up to where it could be.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// What the run started from.
    pub header: Header,
    /// The records, with their line numbers.
    pub records: Vec<(usize, Record)>,
    /// The log ends in the middle of this line.
    pub cut: Option<usize>,
}

/// Reads a log. A last line that is not whole is reported in [`Log::cut`], not an error: a robot
/// that lost its power has such a log.
///
/// # Errors
/// The first line that is wrong, by number.
pub fn read(input: impl BufRead) -> Result<Log, String> {
    let mut lines = Vec::new();
    for (i, line) in input.split(b'\n').enumerate() {
        lines.push(line.map_err(|error| format!("line {}: {error}", i + 1))?);
    }
    let mut parse_header = lines.iter();
    let first = parse_header.next().ok_or("the log is empty")?;
    let header: Header =
        serde_json::from_slice(first).map_err(|error| format!("line 1: no header: {error}"))?;
    let mut records = Vec::new();
    let mut cut = None;
    for (i, line) in lines.iter().enumerate().skip(1) {
        match serde_json::from_slice(line) {
            Ok(record) => records.push((i + 1, record)),
            Err(error) if i + 1 == lines.len() && error.is_eof() => cut = Some(i + 1),
            Err(error) => return Err(format!("line {}: {error}", i + 1)),
        }
    }
    Ok(Log {
        header,
        records,
        cut,
    })
}
