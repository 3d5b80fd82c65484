//! How often sonars and cameras are wrong: where likelihoods come from.

use crate::quantity::{Angle, Instant};

/// What a sonar's reading says of a place in its cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hearing {
    /// An echo from there.
    There,
    /// An echo from nearby, of a sonar whose cone does not cover the place: of the same thing, perhaps,
    /// but this sonar would not have heard past it either.
    Beside,
    /// An echo from behind it, or none: the sonar heard past it.
    Past,
    /// An echo from before it, a thing that hides it or crosstalk; or no usable reading.
    Nothing,
}

/// How often a sonar is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarModel {
    /// Share of looks at a thing in which its echo is lost.
    pub miss: f32,
    /// Share of looks in which an echo comes out of nowhere, from crosstalk or noise.
    pub false_echo: f32,
    /// False echoes come from anywhere up to this range, metres: that of the walls.
    pub false_range: f32,
}

impl SonarModel {
    /// p(z|obstacle), p(z|nothing) of a hearing, where an echo counts as coming from a place if it is
    /// within `gate` metres of it.
    #[must_use]
    pub fn likelihood(&self, hearing: Hearing, gate: f32) -> [f32; 2] {
        // Of the false echoes as many come from the place as the gate takes up of the range.
        let by_chance = self.false_echo * (2.0 * gate / self.false_range).clamp(0.01, 1.0);
        match hearing {
            Hearing::There => {
                let heard = (1.0 - self.miss) * (1.0 - self.false_echo);
                [heard + by_chance, by_chance]
            }
            Hearing::Past => [self.miss, 1.0 - self.false_echo],
            Hearing::Beside | Hearing::Nothing => [1.0, 1.0],
        }
    }
}

/// How often a camera's detector of people is wrong, per image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraModel {
    /// Share of people in the picture that are detected.
    pub detection: f32,
    /// Share of pictures of nobody in which somebody is detected.
    pub false_alarm: f32,
}

impl CameraModel {
    /// p(z|obstacle), p(z|nothing) of a detection, or of none.
    #[must_use]
    pub fn likelihood(&self, detected: bool) -> [f32; 2] {
        if detected {
            [self.detection, self.false_alarm]
        } else {
            [1.0 - self.detection, 1.0 - self.false_alarm]
        }
    }
}

/// A look through a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraLook {
    /// Bearing of somebody, positive to the left; none if nobody was detected.
    pub detected: Option<Angle>,
    /// When the picture was taken.
    pub taken_at: Instant,
}
