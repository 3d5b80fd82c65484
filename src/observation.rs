//! What the sensors said: raw, untrusted, timed.
//!
//! Every number in an [`Observation`] may be anything, NaN included. [`SonarReading`] is what a
//! raw range becomes once it is judged: one of five things, never a bare number.

use crate::quantity::{Instant, Length};

/// A raw sonar range and when it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSample {
    /// Range from the sonar's face in metres; any bit pattern.
    pub range: f32,
    /// When it was measured.
    pub taken_at: Instant,
}

/// Raw odometry and when it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometrySample {
    /// Position of the centre of rotation in metres, x.
    pub x: f32,
    /// Position of the centre of rotation in metres, y.
    pub y: f32,
    /// Heading in radians, counter-clockwise from the x axis.
    pub heading: f32,
    /// Forward speed in m/s.
    pub speed: f32,
    /// Turn rate in rad/s.
    pub turn_rate: f32,
    /// When it was measured.
    pub taken_at: Instant,
}

/// A raw sighting of a moving obstacle by a camera, the input of S1 E2 and E3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Displacement |p₂ − p₁| between two images, in pixels.
    pub displacement: f32,
    /// Size of a pixel at the obstacle's distance, s, in metres per pixel.
    pub scale: f32,
    /// Time between the two images, t, in seconds.
    pub interval: f32,
    /// Direction of motion θ_o in radians, 0 to π/2; π/2 is straight at the robot.
    pub direction: f32,
    /// When the second image was taken.
    pub taken_at: Instant,
}

/// What the base says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseStatus {
    /// The motors have power.
    pub motors_enabled: bool,
    /// A wheel is stalled or a bumper pressed.
    pub stalled: bool,
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
}

/// Everything the sensors said up to one tick, for a robot with `N` sonars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<const N: usize> {
    /// Time of the tick.
    pub now: Instant,
    /// The latest sample of each sonar, if it ever gave one.
    pub sonar: [Option<SonarSample>; N],
    /// The latest odometry, if there ever was any.
    pub odometry: Option<OdometrySample>,
    /// The latest sighting of a moving obstacle, if there is a camera that gave one.
    pub sighting: Option<Sighting>,
    /// The base's own status.
    pub base: BaseStatus,
}

/// A judged sonar reading. None of the five means "free": [`NoEcho`](Self::NoEcho) says only
/// that no echo came back, as from glass, a slanted wall or a dead sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SonarReading {
    /// Something reflects at this range.
    Echo(Length),
    /// No echo came back from within this range.
    NoEcho(Length),
    /// Inside the blanking distance: as good as a contact.
    TooNear,
    /// Never measured, or measured too long ago.
    Stale,
    /// Not a range: NaN, infinite, negative, absurdly far, or from the future.
    Invalid,
}

/// Judges a raw range: the five kinds of reading.
///
/// `range_min` is the blanking distance and `range_max` where "no echo" begins, both in metres
/// with 0 ≤ range_min < range_max; `age_max` is in milliseconds. Readings beyond twice
/// `range_max` are invalid: sensors report saturation near their limit, not far past it.
//= view.INV-1
#[must_use]
pub fn classify(
    sample: Option<SonarSample>,
    now: Instant,
    range_min: Length,
    range_max: Length,
    age_max: u64,
) -> SonarReading {
    let Some(sample) = sample else {
        return SonarReading::Stale;
    };
    let Some(age) = now.since(sample.taken_at) else {
        return SonarReading::Invalid;
    };
    if age > age_max {
        return SonarReading::Stale;
    }
    match Length::metres(sample.range) {
        Err(_) => SonarReading::Invalid,
        Ok(range) if range.get() > 2.0 * range_max.get() => SonarReading::Invalid,
        Ok(range) if range < range_min || range == Length::ZERO => SonarReading::TooNear,
        Ok(range) if range >= range_max => SonarReading::NoEcho(range_max),
        Ok(range) => SonarReading::Echo(range),
    }
}
