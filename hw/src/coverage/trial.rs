//! Boxes at random places of a floor's passages, and what they truly leave free.

use super::floor::{Floor, Surprise};
use super::roadmap::{PassageId, Roadmap};
use crate::episodes::Random;
use sidestep_sim::geometry::{Point, Pose, heading_of};

/// A box in a passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// The box.
    pub surprise: Surprise,
    /// The passage that it stands in.
    pub passage: PassageId,
    /// The wider of the two ways that it leaves between itself and the walls, m.
    pub free: f64,
}

/// `count` boxes of 0.1 to 0.6 m along and 0.1 to 1.1 m across the straight legs of passages, each
/// anywhere between the walls, each in another passage, at least `from_ends` (m) from the ends of its
/// leg, where passages meet or turn. Fewer if there are not as many passages with a leg long enough.
#[must_use]
pub fn boxes(
    floor: &Floor,
    roadmap: &Roadmap,
    count: usize,
    from_ends: f64,
    seed: u64,
) -> Vec<Trial> {
    let mut random = Random(seed);
    let mut uniform =
        move |low: f64, high: f64| low + (high - low) * (f64::from(random.signed()) + 1.0) / 2.0;
    let mut legs: Vec<(PassageId, [Point; 2])> = Vec::new();
    for (i, passage) in roadmap.passages.iter().enumerate() {
        for pair in passage.points.windows(2) {
            if (pair[1] - pair[0]).norm() > 2.0 * from_ends {
                legs.push((PassageId(i), [pair[0], pair[1]]));
            }
        }
    }
    let mut trials: Vec<Trial> = Vec::new();
    while trials.len() < count && !legs.is_empty() {
        let chosen = (uniform(0.0, legs.len() as f64) as usize).min(legs.len() - 1);
        let (passage, [from, to]) = legs[chosen];
        legs.retain(|(other, _)| *other != passage);
        let along = to - from;
        let place = from + along.normalize() * uniform(from_ends, along.norm() - from_ends);
        let half = floor.clearance(place);
        let (length, width) = (uniform(0.1, 0.6), uniform(0.1, 1.1_f64.min(2.0 * half)));
        let aside = uniform(-1.0, 1.0) * (half - width / 2.0);
        let middle = Pose {
            position: place,
            heading: heading_of(&along),
        };
        trials.push(Trial {
            surprise: Surprise {
                pose: middle.compose(&Pose::new(0.0, aside, 0.0)),
                length,
                width,
            },
            passage,
            free: half - width / 2.0 + aside.abs(),
        });
    }
    trials
}
