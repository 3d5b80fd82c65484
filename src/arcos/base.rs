//! The bases known: units, dimensions and sonar ring.

use core::f32::consts::TAU;

/// Where a sonar sits on the robot, and where it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SonarPlacement {
    /// Forward of the robot's centre, mm.
    pub x_mm: i16,
    /// Left of the robot's centre, mm.
    pub y_mm: i16,
    /// Direction of the beam's axis, degrees counter-clockwise from forward, in -180..=180.
    pub heading_deg: i16,
}

const fn sonar(x_mm: i16, y_mm: i16, heading_deg: i16) -> SonarPlacement {
    SonarPlacement {
        x_mm,
        y_mm,
        heading_deg,
    }
}

/// The 16 sonars of a P3-DX by index; a robot with the front array only has the first eight.
pub const P3DX_SONARS: [SonarPlacement; 16] = [
    sonar(69, 136, 90),
    sonar(114, 119, 50),
    sonar(148, 78, 30),
    sonar(166, 27, 10),
    sonar(166, -27, -10),
    sonar(148, -78, -30),
    sonar(114, -119, -50),
    sonar(69, -136, -90),
    sonar(-157, -136, -90),
    sonar(-203, -119, -130),
    sonar(-237, -78, -150),
    sonar(-255, -27, -170),
    sonar(-255, 27, 170),
    sonar(-237, 78, 150),
    sonar(-203, 119, 130),
    sonar(-157, 136, 90),
];

/// What a base's raw units mean, and how large it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseParameters {
    /// The subclass under which the robot introduces itself.
    pub subclass: &'static str,
    /// A distance unit of the odometry, mm (`DistConv`).
    pub distance_mm: f32,
    /// An angle unit of the odometry, rad (`AngleConv`).
    pub angle_rad: f32,
    /// A velocity unit of the SIP, mm/s (`VelConv`).
    pub velocity_mm_s: f32,
    /// A range unit of the sonars, mm (`RangeConv`).
    pub range_mm: f32,
    /// Rotational speed for half the difference of the wheels' speeds, rad/mm (`DiffConv`).
    pub differential_rad_mm: f32,
    /// A velocity unit of [`VEL2`](super::command::VEL2), mm/s (`Vel2Divisor`).
    pub vel2_unit_mm_s: u8,
    /// Largest translational speed that the base is specified for, mm/s.
    pub max_velocity_mm_s: u16,
    /// Nominal radius, mm, as the parameter files state it. It does not cover the rear: a base that
    /// turns in place sweeps the farthest corner given by the dimensions below.
    pub radius_mm: u16,
    /// From the centre of rotation to the front, mm.
    pub front_mm: u16,
    /// From the centre of rotation to the rear, mm.
    pub rear_mm: u16,
    /// Width, mm.
    pub width_mm: u16,
    /// The sonars by index.
    pub sonars: &'static [SonarPlacement],
}

impl BaseParameters {
    /// P3-DX with the older controllers.
    pub const P3DX: Self = Self {
        subclass: "p3dx",
        distance_mm: 0.485,
        angle_rad: TAU / 4096.0,
        velocity_mm_s: 1.0,
        range_mm: 1.0,
        differential_rad_mm: 0.0056,
        vel2_unit_mm_s: 20,
        max_velocity_mm_s: 2200,
        radius_mm: 250,
        front_mm: 210,
        rear_mm: 301,
        width_mm: 425,
        sonars: &P3DX_SONARS,
    };

    /// P3-DX with the SH2 controller.
    pub const P3DX_SH: Self = Self {
        subclass: "p3dx-sh",
        distance_mm: 1.0,
        ..Self::P3DX
    };

    /// The parameters of the subclass a robot reports, letter case ignored. There is no fallback:
    /// the distance units of two robots that look alike differ by a factor of two.
    #[must_use]
    pub const fn for_subclass(subclass: &[u8]) -> Option<Self> {
        if subclass.eq_ignore_ascii_case(Self::P3DX.subclass.as_bytes()) {
            Some(Self::P3DX)
        } else if subclass.eq_ignore_ascii_case(Self::P3DX_SH.subclass.as_bytes()) {
            Some(Self::P3DX_SH)
        } else {
            None
        }
    }

    /// A heading of the SIP in radians, counter-clockwise positive.
    #[must_use]
    pub const fn heading_rad(&self, raw: i16) -> f32 {
        raw as f32 * self.angle_rad
    }

    /// The translational and rotational speed, mm/s and rad/s, of a SIP's wheel speeds.
    #[must_use]
    pub const fn twist(&self, left: i16, right: i16) -> (f32, f32) {
        let (left, right) = (
            left as f32 * self.velocity_mm_s,
            right as f32 * self.velocity_mm_s,
        );
        (
            (left + right) / 2.0,
            (right - left) / 2.0 * self.differential_rad_mm,
        )
    }

    /// A sonar's range in mm.
    #[must_use]
    pub const fn range_mm(&self, raw: u16) -> f32 {
        raw as f32 * self.range_mm
    }
}
