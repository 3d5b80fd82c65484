//! One tick: observation in, command out. Data flows one way.

use crate::config::Config;
use crate::decide::SecondLook;
use crate::failsafe::{Action, StopReason};
use crate::law::Law;
use crate::observation::Observation;
use crate::quantity::{Instant, OutOfRange, in_range};
use crate::ring::Ring;
use crate::shield::{Command, Limit, Shield, Verdict};
use crate::view::{Memory, View};
use nalgebra::Vector2;

/// What came of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<const N: usize> {
    /// What the robot is told.
    pub command: Command,
    /// The most severe of what is done about anything.
    pub action: Action,
    /// Why the shield makes it stand still, if it does.
    pub stop: Option<StopReason>,
    /// What made it slower than advised, if anything did.
    pub limit: Option<Limit>,
    /// What the law is doing.
    pub mode: &'static str,
    /// The world as it was believed to be, if there was a usable observation.
    pub view: Option<View<N>>,
}

/// A law under the shield, for a robot with `N` sonars.
#[derive(Clone, Debug)]
pub struct Controller<L, const N: usize> {
    config: Config,
    ring: Ring<N>,
    goal: Vector2<f32>,
    second_look: SecondLook<N>,
    memory: Memory<N>,
    shield: Shield,
    law: L,
}

impl<L: Law<N>, const N: usize> Controller<L, N> {
    /// A controller at rest, with a goal in the odometry frame (metres).
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate of the goal is not within ±1000 m.
    pub fn new(
        config: Config,
        ring: Ring<N>,
        law: L,
        goal: Vector2<f32>,
    ) -> Result<Self, OutOfRange> {
        in_range("goal x", goal.x, -1e3, 1e3, "m")?;
        in_range("goal y", goal.y, -1e3, 1e3, "m")?;
        Ok(Self {
            config,
            ring,
            goal,
            second_look: SecondLook::default(),
            memory: Memory::default(),
            shield: Shield::new(&config),
            law,
        })
    }

    /// One tick.
    pub fn tick(&mut self, observation: &Observation<N>) -> Decision<N> {
        let observation = &self.second_look.judged(observation, &self.config);
        let updated = self
            .memory
            .update(observation, self.goal, &self.ring, &self.config);
        match updated {
            Err(reason) => {
                let verdict = self.shield.refuse(reason, observation.now);
                self.decision(verdict, None)
            }
            Ok(mut view) => {
                view.guard = self.shield.assess(&view, &self.ring);
                let advice = self.law.advise(&view);
                let verdict = self.shield.admit(advice, &view, &self.ring);
                self.decision(verdict, Some(view))
            }
        }
    }

    /// Lets the robot go on after a latched stop, once nothing demands a stop any more.
    pub fn reset(&mut self) {
        self.shield.reset();
    }

    /// Stops for a reason that no observation shows, such as a lost link. The stop lasts until
    /// observations have been clear for long enough, or is latched: see [`crate::failsafe`].
    pub fn halt(&mut self, reason: StopReason, now: Instant) -> Decision<N> {
        let verdict = self.shield.refuse(reason, now);
        self.decision(verdict, None)
    }

    fn decision(&self, verdict: Verdict, view: Option<View<N>>) -> Decision<N> {
        Decision {
            command: verdict.command,
            action: verdict.action,
            stop: verdict.stop,
            limit: verdict.limit,
            mode: self.law.mode(),
            view,
        }
    }

    /// The law.
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// The law, to tell it what no observation holds: a laser scan, another route. It only advises,
    /// so nothing done to it makes the robot unsafe.
    pub const fn law_mut(&mut self) -> &mut L {
        &mut self.law
    }

    /// The shield.
    pub const fn shield(&self) -> &Shield {
        &self.shield
    }
}
