//! Position out of counters that wrap.

use super::base::BaseParameters;

/// The displacement of a position counter between two SIPs, in its units: the shortest signed
/// difference modulo 2¹⁵, in -2¹⁴..2¹⁴.
///
/// Hosts disagree on whether the counter has 15 bits or 16; modulo 2¹⁵ serves both. At 2.2 m/s and a
/// SIP every 100 ms a base of 0.485 mm per unit moves 454 units between two.
//= arcos.INV-11
#[must_use]
pub const fn shortest_delta(previous: u16, current: u16) -> i16 {
    // Bit 15 is shifted out; the arithmetic shift back carries bit 14 as the sign.
    (current.wrapping_sub(previous) << 1).cast_signed() >> 1
}

/// The position a robot reports, unwrapped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odometry {
    x: i64,
    y: i64,
    last: Option<(u16, u16)>,
}

impl Odometry {
    /// At the origin, until a first SIP tells where the counters stand.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            x: 0,
            y: 0,
            last: None,
        }
    }

    /// Takes in the position counters of the next SIP. The first pair after [`new`](Self::new) or
    /// [`rebase`](Self::rebase) moves nothing: it only tells where the counters stand.
    //= arcos.INV-12
    pub const fn update(&mut self, x: u16, y: u16) {
        if let Some((last_x, last_y)) = self.last {
            self.x = self.x.saturating_add(shortest_delta(last_x, x) as i64);
            self.y = self.y.saturating_add(shortest_delta(last_y, y) as i64);
        }
        self.last = Some((x, y));
    }

    /// Keeps the position but forgets the counters, as after `SETO` or a robot's restart.
    pub const fn rebase(&mut self) {
        self.last = None;
    }

    /// The position in raw distance units.
    #[must_use]
    pub const fn units(&self) -> (i64, i64) {
        (self.x, self.y)
    }

    /// The position in mm in the frame of the robot's odometry: x forward and y left at its origin.
    #[must_use]
    pub const fn position_mm(&self, parameters: &BaseParameters) -> (f32, f32) {
        let scale = parameters.distance_mm;
        (self.x as f32 * scale, self.y as f32 * scale)
    }
}
