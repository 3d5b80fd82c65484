//! Getting away from where a law is stuck: another law round it.
//!
//! Whatever the law advises, a robot that has not moved for a while and is not at its goal turns to
//! where its sonars see most room, and drives there for a little way; or, where there is no room to
//! turn, it backs off. Then the law has its say again. All of this is advice like any other: the
//! shield decides.

use crate::config::Config;
use crate::law::{Advice, Law};
use crate::math;
use crate::quantity::{Angle, Instant, within};
use crate::ring::Ring;
use crate::shield::{Guard, Motion};
use crate::view::View;
use core::f32::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6};
use nalgebra::Vector2;

/// A robot that has not gone this far, in metres, has not moved.
const MOVED: f32 = 0.1;
/// It is stuck after this time, in ms.
const PATIENCE: u64 = 14_000;
/// An attempt to get away takes no longer than this, in ms.
const ATTEMPT: u64 = 6_000;
/// An attempt goes this far, in metres.
const WAY: f32 = 0.6;
/// Range, in metres, that counts: more is no better.
const FAR: f32 = 2.0;
/// With this much room, in metres, a way is open.
const OPEN: f32 = 1.0;
/// It has opened if it was less by this, in metres.
const OPENED: f32 = 0.5;
/// The way has to be free by this much more than a stop demands, in metres.
const BEYOND: f32 = 0.1;
/// How much worse a direction is, in metres, for having been tried in vain.
const TRIED: f32 = 0.7;
/// Directions that have been tried, the latest of them.
const REMEMBERED: usize = 4;

/// An attempt to get away.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Attempt {
    heading: Angle,
    begun: Instant,
    from: Vector2<f32>,
    /// It is under way, no longer turning.
    driving: bool,
    /// The room towards the goal as it began, in metres.
    room: f32,
}

/// A law with a way out of where it is stuck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape<L, const N: usize> {
    law: L,
    config: Config,
    guard: Guard,
    ring: Ring<N>,
    /// Where the robot was when it last moved, and when that was.
    rested: Option<(Vector2<f32>, Instant)>,
    attempt: Option<Attempt>,
    tried: [Option<Angle>; REMEMBERED],
}

impl<L, const N: usize> Escape<L, N> {
    /// Puts a way out round a law.
    #[must_use]
    pub fn new(law: L, config: Config, ring: Ring<N>) -> Self {
        Self {
            law,
            config,
            guard: Guard::new(&config),
            ring,
            rested: None,
            attempt: None,
            tried: [None; REMEMBERED],
        }
    }

    /// The law.
    #[must_use]
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// How long the robot has not moved, in ms.
    fn rest(&mut self, view: &View<N>) -> u64 {
        match self.rested {
            Some((place, since)) if math::norm(view.pose.position - place) < MOVED => {
                view.now.since(since).unwrap_or(0)
            }
            _ => {
                self.rested = Some((view.pose.position, view.now));
                0
            }
        }
    }

    /// The direction with most room, with those that were tried counting less and the goal's more.
    fn way_out(&self, view: &View<N>) -> Angle {
        let mut best = (f32::NEG_INFINITY, view.pose.heading);
        for sonar in self.ring.sonars() {
            let heading = view.pose.heading.plus(sonar.heading);
            let towards = math::cos(view.goal.heading.minus(heading).get());
            let room = self.room(view, sonar.heading);
            let near = |tried: &Option<Angle>| {
                tried.is_some_and(|tried| tried.minus(heading).get().abs() < FRAC_PI_2 / 2.0)
            };
            let tried = self.tried.iter().filter(|tried| near(tried)).count();
            let score = room + 0.2 * towards - TRIED * tried as f32;
            if score > best.0 {
                best = (score, heading);
            }
        }
        best.1
    }

    /// Room in metres for driving in a direction of the robot's frame: the least clearance there,
    /// none if it would begin with a stop for the minimum distance.
    fn room(&self, view: &View<N>, direction: Angle) -> f32 {
        let stop = self.config.min_distance + self.config.resume_clearance;
        let mut room = FAR;
        for (sonar, hazard) in self.ring.sonars().iter().zip(&view.hazard) {
            let aside = sonar.heading.minus(direction).get().abs();
            if aside <= FRAC_PI_3 && hazard.range as f32 / 1000.0 <= stop + BEYOND {
                return -FAR;
            }
            if aside <= FRAC_PI_6 {
                room = room.min(hazard.clearance as f32 / 1000.0);
            }
        }
        room
    }

    /// The room in the direction of the goal.
    fn room_to_goal(&self, view: &View<N>) -> f32 {
        self.room(view, view.goal.heading.minus(view.pose.heading))
    }

    /// What an attempt asks for, or none if it is over.
    fn pursue(&mut self, view: &View<N>) -> Option<Advice> {
        // While it turns, the way to the goal may open: then there is no need to get away.
        let opened = self.attempt.is_some_and(|attempt| {
            !attempt.driving && self.room_to_goal(view) >= OPEN.max(attempt.room + OPENED)
        });
        let attempt = self.attempt.as_mut()?;
        let gone = math::norm(view.pose.position - attempt.from) >= WAY;
        let late = view
            .now
            .since(attempt.begun)
            .is_none_or(|time| time >= ATTEMPT);
        if gone || late || opened {
            self.attempt = None;
            return None;
        }
        let error = attempt.heading.minus(view.pose.heading).get();
        attempt.driving |= error.abs() <= self.config.alignment;
        let limit = self.config.turn_rate_max;
        let turn_rate = within(self.config.heading_gain * error, limit);
        if attempt.driving {
            return Some(Advice {
                speed: self.config.cruise_speed / 2.0,
                // Driving in a stop is not admitted, turning is.
                turn_rate: turn_rate / 2.0,
            });
        }
        // Where there is no room to turn, backing off makes some, or else driving on.
        let cramped = self.cramped(view);
        Some(match cramped {
            Some(ahead) => Advice {
                speed: if ahead {
                    -self.config.reverse_speed_max
                } else {
                    self.config.cruise_speed / 4.0
                },
                turn_rate: 0.0,
            },
            None => Advice {
                speed: 0.0,
                turn_rate,
            },
        })
    }

    /// There is no room to turn: whether what is in the way is ahead.
    fn cramped(&self, view: &View<N>) -> Option<bool> {
        let limits = self.guard.limits();
        let slow = limits.turn_rate_max() / 8;
        let plan = self.guard.plan(0, slow, &Motion::REST)?;
        let sonars = self.ring.sonars().iter().zip(&view.hazard);
        sonars
            .filter(|(sonar, hazard)| !limits.fits(hazard, &sonar.closing, &plan))
            .min_by_key(|(_, hazard)| hazard.clearance)
            .map(|(sonar, _)| sonar.heading.get().abs() < FRAC_PI_2)
    }
}

impl<L: Law<N>, const N: usize> Law<N> for Escape<L, N> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        let advice = self.law.advise(view);
        let arrived = view.goal.distance <= self.config.goal_tolerance;
        let may_move = view.guard.is_none_or(|guard| guard.may_turn());
        let resting = self.rest(view);
        if arrived || !may_move {
            // Whatever holds the robot is no business of a law's.
            self.rested = None;
            self.attempt = None;
            return advice;
        }
        if self.attempt.is_none() && resting >= PATIENCE {
            let heading = self.way_out(view);
            self.tried.rotate_right(1);
            self.tried[0] = Some(heading);
            self.attempt = Some(Attempt {
                heading,
                begun: view.now,
                from: view.pose.position,
                driving: false,
                room: self.room_to_goal(view),
            });
        }
        self.pursue(view).unwrap_or(advice)
    }

    fn mode(&self) -> &'static str {
        if self.attempt.is_some() {
            "escape"
        } else {
            self.law.mode()
        }
    }
}
