//! The plant monitor: does the base brake and obey as the shield's theorem assumes?
//!
//! From the commands alone it follows how fast the base can be at most, if it keeps its promise:
//! that is the ceiling. A base that is measured to be faster, again and again, is not the base the
//! theorem is about.

use crate::quantity::Instant;
use crate::shield::Limits;

/// How fast the base may be at most, by what it was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Monitor {
    ceiling: i32,
    /// Until then the base may not have heard that it is to go slower.
    holds_until: Instant,
    last: Option<Instant>,
    told: i32,
    /// Fresh measurements in a row above the ceiling.
    above: u32,
    measured_at: Option<Instant>,
}

/// Measurements in a row above the ceiling that count as proof.
const PROOF: u32 = 3;

impl Monitor {
    /// A base at rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ceiling: 0,
            holds_until: Instant(0),
            last: None,
            told: 0,
            above: 0,
            measured_at: None,
        }
    }

    /// The greatest speed the base could have now, in mm/s, with the error of measuring it.
    #[must_use]
    pub const fn bound(&self, limits: &Limits) -> i32 {
        self.ceiling
            .saturating_add(limits.speed_gain())
            .saturating_add(limits.speed_error())
    }

    /// Takes in a measured speed (mm/s, magnitude) and when it was measured. True once it has been
    /// above the bound three times in a row: the base brakes more weakly, or is faster, than
    /// promised.
    //= monitor.INV-3
    pub fn measured(&mut self, speed: i32, at: Instant, limits: &Limits) -> bool {
        if self.measured_at.is_some_and(|before| at <= before) {
            return false;
        }
        self.measured_at = Some(at);
        self.above = if speed > self.bound(limits) {
            self.above.saturating_add(1)
        } else {
            0
        };
        self.above >= PROOF
    }

    /// Takes in what the base is told at `now` (mm/s, magnitude). The ceiling falls at the braking
    /// bound once the command has had its reaction time.
    //= monitor.INV-1
    //= monitor.INV-2
    pub fn told(&mut self, speed: i32, now: Instant, limits: &Limits) {
        let from = match self.last {
            Some(last) if last > self.holds_until => last,
            _ => self.holds_until,
        };
        let falling = now.since(from).unwrap_or(0).min(100_000) as i64;
        let fallen = (i64::from(limits.braking()) * falling / 1000).min(i64::from(i32::MAX)) as i32;
        self.ceiling = speed.max(self.ceiling.saturating_sub(fallen));
        if speed < self.told || speed >= self.ceiling {
            let reaction = limits.reaction_time().unsigned_abs();
            self.holds_until = Instant(now.0.saturating_add(u64::from(reaction)));
        }
        self.told = speed;
        self.last = Some(now);
    }
}

impl Default for Monitor {
    fn default() -> Self {
        Self::new()
    }
}
