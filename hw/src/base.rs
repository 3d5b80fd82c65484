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

/// What is known of the base from its packets so far.
#[derive(Clone, Debug)]
pub struct Base<const N: usize> {
    parameters: BaseParameters,
    source: HeadingSource,
    odometry: Odometry,
    sonar: [Option<SonarSample>; N],
    /// Compass heading less odometry heading when the compass first gave one, in radians.
    compass_offset: Option<f32>,
}

impl<const N: usize> Base<N> {
    /// A base of which nothing is known yet.
    #[must_use]
    pub const fn new(parameters: BaseParameters, source: HeadingSource) -> Self {
        Self {
            parameters,
            source,
            odometry: Odometry::new(),
            sonar: [None; N],
            compass_offset: None,
        }
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
        let (speed, turn_rate) = self
            .parameters
            .twist(packet.left_velocity, packet.right_velocity);
        Observation {
            now,
            sonar: self.sonar,
            odometry: self.heading(packet).map(|heading| OdometrySample {
                x: x / 1000.0,
                y: y / 1000.0,
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
