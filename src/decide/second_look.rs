//! A second look at what appears out of nowhere.

use crate::config::Config;
use crate::observation::{Observation, SonarSample};
use crate::quantity::Instant;
use crate::shield::milliseconds;

/// Withholds an echo that is nearer than anything can have come since the sonar's last echo, until the
/// next reading bears it out: if `appear_samples` is 2, what appears has to be heard twice. Meanwhile
/// the reading before stands, and grows old. After two that are withheld, anything counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondLook<const N: usize> {
    sonar: [Ear; N],
}

/// What one sonar said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ear {
    /// The latest reading that was handed on.
    passed: Option<SonarSample>,
    /// The latest of these that was an echo.
    echo: Option<SonarSample>,
    /// The reading that is withheld.
    withheld: Option<SonarSample>,
    /// How many are, one after the other.
    count: u8,
}

/// So many readings of a sonar are withheld one after the other at the most.
const WITHHELD_MAX: u8 = 2;

impl<const N: usize> Default for SecondLook<N> {
    fn default() -> Self {
        Self {
            sonar: [Ear::default(); N],
        }
    }
}

impl<const N: usize> SecondLook<N> {
    /// The observation with the readings that count.
    //= decide.INV-16
    //= decide.INV-17
    //= decide.INV-18
    #[must_use]
    pub fn judged(&mut self, observation: &Observation<N>, config: &Config) -> Observation<N> {
        let mut judged = *observation;
        if config.appear_samples >= 2.0 {
            for (sample, ear) in judged.sonar.iter_mut().zip(&mut self.sonar) {
                *sample = sample.map(|latest| ear.judged(latest, observation.now, config));
            }
        }
        judged
    }
}

impl Ear {
    /// The reading that counts: the latest, or the one before.
    fn judged(&mut self, latest: SonarSample, now: Instant, config: &Config) -> SonarSample {
        if let Some(passed) = self.passed {
            if self.withheld == Some(latest) {
                return passed;
            }
            let borne_out = self
                .withheld
                .is_some_and(|first| agrees(first, latest, config));
            let withheld = self.count < WITHHELD_MAX
                && !borne_out
                && latest.taken_at > passed.taken_at
                && latest.taken_at <= now
                && self.appears(latest, config);
            if withheld {
                self.withheld = Some(latest);
                self.count += 1;
                return passed;
            }
        }
        (self.withheld, self.count) = (None, 0);
        self.passed = Some(latest);
        if latest.range < config.sonar_range_max {
            self.echo = Some(latest);
        }
        latest
    }

    /// A reading is an echo from nearer than anything can be that was heard last, or that was out of
    /// range if nothing was heard for `hold_time`. What is no range is none.
    fn appears(&self, latest: SonarSample, config: &Config) -> bool {
        let held = |echo: &SonarSample| {
            let gap = latest.taken_at.since(echo.taken_at)?;
            (gap <= milliseconds(config.hold_time)).then_some((echo.range, gap))
        };
        let (range, gap) = self
            .echo
            .as_ref()
            .and_then(held)
            .unwrap_or((config.sonar_range_max, 0));
        latest.range > 0.0 && latest.range < range - moved(gap, config)
    }
}

/// By how much the range of a thing may change in `gap` ms, and by how much its readings scatter, m.
fn moved(gap: u64, config: &Config) -> f32 {
    let closing = config.obstacle_speed_max + config.speed_max;
    closing * gap as f32 / 1000.0 + config.still_tolerance
}

/// Two readings may be of the same thing.
fn agrees(first: SonarSample, second: SonarSample, config: &Config) -> bool {
    let gap = second.taken_at.since(first.taken_at);
    gap.is_some_and(|gap| (second.range - first.range).abs() <= moved(gap, config))
}
