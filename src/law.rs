//! What a law is: something that looks at a [`View`] and gives [`Advice`].
//!
//! A law may be as clever or as wrong as it likes: it only advises. The [`crate::shield`]
//! decides, and is proved for any advice at all.

use crate::view::View;

/// What a law would like the robot to do. Any bit pattern is allowed; the shield judges it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advice {
    /// Forward speed in m/s.
    pub speed: f32,
    /// Turn rate in rad/s, counter-clockwise positive.
    pub turn_rate: f32,
}

impl Advice {
    /// Stand still.
    pub const REST: Self = Self {
        speed: 0.0,
        turn_rate: 0.0,
    };
}

/// A collision-avoidance law for a robot with `N` sonars.
pub trait Law<const N: usize> {
    /// Looks at the world as it is known now and advises. Called once per tick.
    fn advise(&mut self, view: &View<N>) -> Advice;

    /// One word for what the law is doing, for people to read.
    fn mode(&self) -> &'static str;
}
