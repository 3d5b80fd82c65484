//! Running the controller again on what was recorded: a log, or a table of sonar ranges.

use crate::base::{self, Base};
use crate::config::{RobotConfig, Sonars};
use crate::decide;
use crate::log::{Log, Record, Told, from_hex};
use crate::pilot::{USUAL_LAW, told, usual_law};
use nalgebra::Vector2;
use sidestep::arcos::{BaseParameters, Frame, StandardInformation};
use sidestep::config::{Config, Parameters};
use sidestep::controller::Controller;
use sidestep::law::Law;
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarSample};
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use std::collections::BTreeMap;

/// What came of running a log again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replayed {
    /// Ticks that were run.
    pub ticks: usize,
    /// Where command, mode, stop or limit differ first: the line, what the log says and what was
    /// decided now.
    pub parting: Option<(usize, Told, Told)>,
}

/// Runs a log through a fresh controller.
///
/// # Errors
/// What in the log cannot be used, with its line.
pub fn log(log: &Log) -> Result<Replayed, String> {
    let config = log
        .header
        .config()
        .map_err(|error| format!("line 1: {error}"))?;
    match config.sonars {
        Sonars::Front8 => run::<8>(log, &config),
        Sonars::All16 => run::<16>(log, &config),
    }
}

fn run<const N: usize>(log: &Log, config: &RobotConfig) -> Result<Replayed, String> {
    let core = config.core;
    let line_1 = |error: &dyn std::fmt::Display| format!("line 1: {error}");
    let ring = base::ring::<N>(config).map_err(|error| line_1(&error))?;
    match log.header.law.as_str() {
        USUAL_LAW => run_law(log, config, usual_law(core, ring)),
        decide::NAME => {
            let settings = decide::settings(config).map_err(|error| line_1(&error))?;
            run_law(log, config, decide::law(core, ring, settings))
        }
        other => Err(line_1(&format!("no law is called {other:?} here"))),
    }
}

fn run_law<L: Law<N>, const N: usize>(
    log: &Log,
    config: &RobotConfig,
    law: L,
) -> Result<Replayed, String> {
    let parameters = BaseParameters::for_subclass(log.header.subclass.as_bytes())
        .ok_or_else(|| format!("line 1: unknown subclass {:?}", log.header.subclass))?;
    let goal = log.header.goal.map(|coordinate| coordinate as f32);
    let ring = base::ring::<N>(config).map_err(|error| format!("line 1: {error}"))?;
    let mut base = Base::<N>::new(parameters, config);
    let mut controller = Controller::new(config.core, ring, law, Vector2::new(goal[0], goal[1]))
        .map_err(|error| format!("line 1: {error}"))?;
    let mut ticks = 0;
    for (line, record) in &log.records {
        let (decided, expected) = match record {
            Record::Tick { t, sip, told } => {
                let information = from_hex(sip)
                    .ok_or_else(|| "not hexadecimal".to_owned())
                    .and_then(|bytes| {
                        let frame =
                            Frame::new_checked(&bytes).map_err(|error| error.to_string())?;
                        StandardInformation::decode(frame).map_err(|error| error.to_string())
                    })
                    .map_err(|error| format!("line {line}: sip: {error}"))?;
                let observation = base.observe(&information, Instant(*t));
                (controller.tick(&observation), told)
            }
            Record::Halt { t, reason, told } => {
                (controller.halt((*reason).into(), Instant(*t)), told)
            }
            Record::Origin { .. } => {
                base.restart();
                continue;
            }
            Record::Reset { .. } => {
                controller.reset();
                continue;
            }
            Record::Event { .. } => continue,
        };
        ticks += 1;
        let decided = told(&decided);
        if decided != *expected {
            return Ok(Replayed {
                ticks,
                parting: Some((*line, expected.clone(), decided)),
            });
        }
    }
    Ok(Replayed {
        ticks,
        parting: None,
    })
}

/// How the columns of a table of ranges become sonars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Columns {
    /// Three wide sonars, left, front and right: the least range of the columns that look within
    /// 30° of straight ahead, and of those that look 30° to 90° to either side.
    Thirds,
    /// A ring: every column is a sonar.
    Ring,
}

/// What came of a table of ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Rows.
    pub rows: usize,
    /// Rows in which the robot was made to stand still.
    pub stopped: usize,
    /// Rows with an echo at or under the minimum distance in front.
    pub near: usize,
    /// Rows of those in which the robot was not stopped, or told to drive ahead: must be none. A stopped
    /// robot may turn and back off.
    pub near_but_moving: usize,
    /// Stops by kind.
    pub stops: BTreeMap<String, usize>,
    /// Rows by mode.
    pub modes: BTreeMap<String, usize>,
    /// Greatest speed told, mm/s.
    pub greatest_speed: i32,
}

/// Directions of the 24 sonars of a SCITOS G5, as the description of the recorded data gives them:
/// the first at 180°, from there clockwise in steps of 15° (the front is sonar 13, the thirteenth
/// column). Counter-clockwise positive here.
fn direction(column: usize, columns: usize) -> f32 {
    180.0 - 360.0 / columns as f32 * column as f32
}

/// Runs a table of sonar ranges (comma-separated, metres, one row a sample, header and text columns
/// skipped) through the controller at a pretended `period` (ms) per row, the base pretending to
/// stand at its start.
///
/// # Errors
/// The first row that is not of the form, by line.
pub fn table(
    text: &str,
    columns: Columns,
    config: &RobotConfig,
    period: u64,
) -> Result<Table, String> {
    let mut rows = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let numbers: Vec<f32> = line
            .split(',')
            .map_while(|field| field.trim().parse().ok())
            .collect();
        if numbers.is_empty() && i == 0 {
            continue;
        }
        rows.push((i + 1, numbers));
    }
    let width = rows.first().map_or(0, |(_, row)| row.len());
    if let Some((line, row)) = rows.iter().find(|(_, row)| row.len() != width) {
        return Err(format!(
            "line {line}: {} ranges where the first row has {width}",
            row.len()
        ));
    }
    match (columns, width) {
        (_, 0) => Err("no row of ranges".to_owned()),
        (Columns::Thirds, _) => feed(&rows, config, period, [60_f32, 0.0, -60.0], |row| {
            let mut least = [f32::INFINITY; 3];
            for (column, range) in row.iter().enumerate() {
                let bearing = direction(column, width);
                // Rounding would move a column on the boundary: half a degree decides.
                let third = match bearing {
                    b if b.abs() <= 30.5 => 1,
                    b if b > 0.0 && b <= 90.5 => 0,
                    b if (-90.5..0.0).contains(&b) => 2,
                    _ => continue,
                };
                // A range that is no number makes its whole third one.
                if range.is_nan() || *range < least[third] {
                    least[third] = *range;
                }
            }
            least
        }),
        (Columns::Ring, 24) => {
            let mut bearings = [0.0; 24];
            for (column, bearing) in bearings.iter_mut().enumerate() {
                *bearing = direction(column, 24);
            }
            feed(&rows, config, period, bearings, |row| {
                let mut ranges = [0.0; 24];
                ranges.copy_from_slice(row);
                ranges
            })
        }
        (Columns::Ring, width) => Err(format!("a ring of {width} sonars; 24 are supported")),
    }
}

fn feed<const N: usize>(
    rows: &[(usize, Vec<f32>)],
    config: &RobotConfig,
    period: u64,
    bearings: [f32; N],
    ranges: impl Fn(&[f32]) -> [f32; N],
) -> Result<Table, String> {
    // Side by side they see everything from the first to the last, whatever is configured.
    let between = (bearings[0] - bearings[1]).abs().to_radians();
    let config = Config::new(Parameters {
        sonar_half_angle: (between / 2.0).min(0.8),
        ..*config.core
    })
    .map_err(|error| error.to_string())?;
    // The sonars sit on the robot's edge and look straight out.
    let placements = bearings.map(|bearing| {
        let heading = bearing.to_radians();
        Placement {
            x: config.robot_radius * heading.cos(),
            y: config.robot_radius * heading.sin(),
            heading,
        }
    });
    let ring = Ring::new(&placements, &config).map_err(|error| error.to_string())?;
    let goal = Vector2::new(100.0, 0.0);
    let mut controller = Controller::new(config, ring, usual_law(config, ring), goal)
        .map_err(|error| error.to_string())?;
    let mut table = Table::default();
    for (i, (_, row)) in rows.iter().enumerate() {
        let now = Instant(1000 + i as u64 * period);
        let ranges = ranges(row);
        let observation = Observation {
            now,
            sonar: ranges.map(|range| {
                Some(SonarSample {
                    range,
                    taken_at: now,
                })
            }),
            odometry: Some(OdometrySample {
                x: 0.0,
                y: 0.0,
                heading: 0.0,
                speed: 0.0,
                turn_rate: 0.0,
                taken_at: now,
            }),
            sighting: None,
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
        };
        let decision = controller.tick(&observation);
        table.rows += 1;
        *table.modes.entry(decision.mode.to_owned()).or_default() += 1;
        if let Some(reason) = decision.stop {
            table.stopped += 1;
            let kind = reason.row().cause.to_owned();
            *table.stops.entry(kind).or_default() += 1;
        }
        let near = ring
            .sonars()
            .iter()
            .zip(ranges)
            .any(|(sonar, range)| sonar.forward && range <= config.min_distance);
        if near {
            table.near += 1;
            if decision.stop.is_none() || decision.command.speed() > 0 {
                table.near_but_moving += 1;
            }
        }
        table.greatest_speed = table.greatest_speed.max(decision.command.speed());
    }
    Ok(table)
}
