//! From the base's packets to observations: units, odometry, sonars, heading.

use crate::config::{HeadingSource, RobotConfig};
use sidestep::arcos::{BaseParameters, Odometry, StandardInformation, compass_heading_deg};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarSample};
use sidestep::quantity::{Instant, OutOfRange};
use sidestep::ring::{Placement, Ring};
use std::f32::consts::TAU;

/// The ring of a P3-DX with `N` sonars, 8 or 16.
///
/// # Errors
/// [`OutOfRange`] if the ring does not fit the configuration.
pub fn ring<const N: usize>(config: &RobotConfig) -> Result<Ring<N>, OutOfRange> {
    let mut placements = [Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    }; N];
    for (placement, sonar) in placements.iter_mut().zip(BaseParameters::P3DX.sonars) {
        *placement = Placement::from_mm_deg(sonar.x_mm, sonar.y_mm, sonar.heading_deg);
    }
    Ring::new(&placements, &config.core)
}

/// Counters this near to zero are those of a base that has just started, in its units.
const ANEW: u16 = 20;
/// Packets farther apart than this are a gap in which the base may have been restarted, seconds.
const GAP: f32 = 0.5;
/// Changes of position smaller than this are no jump, metres.
const JUMP: f32 = 0.3;

/// What is known of the base from its packets so far.
#[derive(Clone, Debug)]
pub struct Base<const N: usize> {
    parameters: BaseParameters,
    source: HeadingSource,
    odometry: Odometry,
    sonar: [Option<SonarSample>; N],
    /// Compass heading less odometry heading when the compass first gave one, in radians.
    compass_offset: Option<f32>,
    /// Greatest speed of the robot, m/s.
    speed_max: f32,
    /// When and where the robot was last, metres.
    last: Option<(Instant, f32, f32)>,
    /// The counters have jumped: where the robot is, is no longer known.
    lost: bool,
}

impl<const N: usize> Base<N> {
    /// A base of which nothing is known yet.
    #[must_use]
    pub fn new(parameters: BaseParameters, config: &RobotConfig) -> Self {
        Self {
            parameters,
            source: config.heading,
            odometry: Odometry::new(),
            sonar: [None; N],
            compass_offset: None,
            speed_max: config.core.speed_max,
            last: None,
            lost: false,
        }
    }

    /// The robot stands at its origin: its counters have just been set to zero.
    pub fn restart(&mut self) {
        self.odometry = Odometry::new();
        self.compass_offset = None;
        self.last = None;
        self.lost = false;
    }

    /// The counters have jumped, as those of a base that was switched off and on: the robot is not
    /// where they say. From then on no observation has a pose.
    #[must_use]
    pub const fn is_lost(&self) -> bool {
        self.lost
    }

    /// Notices a jump: farther than the robot can have gone, or back at the origin after a gap.
    fn watch(&mut self, packet: &StandardInformation, now: Instant, x: f32, y: f32) {
        if let Some((then, last_x, last_y)) = self.last {
            let gap = now.since(then).unwrap_or(0) as f32 / 1000.0;
            let way = (x - last_x).hypot(y - last_y);
            let counters_anew = packet.x.cast_signed().unsigned_abs() <= ANEW
                && packet.y.cast_signed().unsigned_abs() <= ANEW;
            let reset = gap > GAP && counters_anew && way > JUMP;
            self.lost |= reset || way > 2.0 * self.speed_max * gap + JUMP;
        }
        self.last = Some((now, x, y));
    }

    /// The observation after a packet that arrived at `now`.
    pub fn observe(&mut self, packet: &StandardInformation, now: Instant) -> Observation<N> {
        self.odometry.update(packet.x, packet.y);
        for reading in packet.sonars.as_slice() {
            // A base may have more sonars than are configured.
            if let Some(sample) = self.sonar.get_mut(usize::from(reading.index)) {
                *sample = Some(SonarSample {
                    range: self.parameters.range_mm(reading.range) / 1000.0,
                    taken_at: now,
                });
            }
        }
        let (x, y) = self.odometry.position_mm(&self.parameters);
        let (x, y) = (x / 1000.0, y / 1000.0);
        self.watch(packet, now, x, y);
        let (speed, turn_rate) = self
            .parameters
            .twist(packet.left_velocity, packet.right_velocity);
        Observation {
            now,
            sonar: self.sonar,
            odometry: self.heading(packet).map(|heading| OdometrySample {
                x: if self.lost { f32::NAN } else { x },
                y,
                heading,
                speed: speed / 1000.0,
                turn_rate,
                taken_at: now,
            }),
            sighting: None,
            base: BaseStatus {
                motors_enabled: packet.motors_enabled(),
                stalled: packet.left_stalled()
                    || packet.right_stalled()
                    || packet.front_bumpers() != 0
                    || packet.rear_bumpers() != 0,
                emergency_stop: packet.e_stop(),
            },
        }
    }

    /// The heading in radians; none if it is to come from a compass that gives none.
    fn heading(&mut self, packet: &StandardInformation) -> Option<f32> {
        let odometry = self.parameters.heading_rad(packet.heading);
        let sense = match self.source {
            HeadingSource::Odometry => return Some(odometry),
            HeadingSource::Compass => 1.0,
            HeadingSource::CompassClockwise => -1.0,
        };
        let compass = sense * f32::from(compass_heading_deg(packet.compass)?).to_radians();
        let offset = *self.compass_offset.get_or_insert(compass - odometry);
        let heading = (compass - offset).rem_euclid(TAU);
        Some(if heading > TAU / 2.0 {
            heading - TAU
        } else {
            heading
        })
    }
}
