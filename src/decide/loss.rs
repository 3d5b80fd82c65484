//! Losses and the action of least expected loss: S2 E19, E20, E22, Table 2, and what E29 and E30 work
//! out.

use super::belief::{Belief, NoBelief, ONE};
use crate::quantity::{Length, OutOfRange, in_range};
use crate::shield::{millimetres_down, millimetres_up};
use core::fmt;

/// The greatest loss, in seconds.
const LOSS_MAX: f32 = 1e5;

/// Parts of [`ONE`] by which rounding may move a probability in a decision.
const ROUNDING: i64 = 8;

/// Why a table of losses is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BadLoss {
    /// A loss is not a number of seconds from 0 to 10⁵.
    NotALoss {
        /// Index of the action.
        action: usize,
        /// Index of the state.
        state: usize,
        /// The value given.
        value: f32,
    },
    /// An action can never be chosen.
    Dominated(Dominated),
    /// The distance at which the near table holds is not below that of the far one.
    Distance(OutOfRange),
}

/// An action that another one makes pointless: in no state is the other one worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dominated {
    /// Index of the action that is never worth choosing.
    pub action: usize,
    /// Index of the action that is at least as good in every state.
    pub by: usize,
}

impl fmt::Display for BadLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotALoss {
                action,
                state,
                value,
            } => write!(
                f,
                "loss of action {action} in state {state} is {value} s, allowed is 0 s to {LOSS_MAX} s"
            ),
            Self::Dominated(Dominated { action, by }) => write!(
                f,
                "action {action} is dominated: action {by} is no worse in any state, so action \
                 {action} would not be chosen"
            ),
            Self::Distance(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BadLoss {}

/// L(θ, a): the loss of each of `A` actions in each of `S` states (S2 Table 2), in milliseconds.
///
/// Actions are ordered from the boldest to the safest: a tie goes to the last of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LossTable<const A: usize, const S: usize>([[i32; S]; A]);

impl LossTable<2, 2> {
    /// S2 Table 2 as printed: maneuver, then stop; obstacle, then none. Stopping is dominated: with
    /// this table the robot never stops.
    //= decide.INV-9
    pub const TABLE_2: Self = Self([[0, 5_000], [5_000, 10_000]]);

    /// S2's text has no loss for stopping before an obstacle. Stopping is still dominated, and chosen
    /// only where an obstacle is certain.
    pub const TEXT: Self = Self([[0, 5_000], [0, 10_000]]);
}

impl<const A: usize, const S: usize> LossTable<A, S> {
    /// A table of losses in seconds, `loss[action][state]`, in which every action has its use.
    ///
    /// # Errors
    /// [`BadLoss`] if a loss is not a number from 0 to 10⁵ s, or naming an action that another one
    /// dominates, and the other one.
    //= decide.INV-11
    pub fn new(loss: &[[f32; S]; A]) -> Result<Self, BadLoss> {
        let table = Self::with_dominated(loss)?;
        match table.dominated() {
            Some(dominated) => Err(BadLoss::Dominated(dominated)),
            None => Ok(table),
        }
    }

    /// The same for somebody who wants a table with actions that are never chosen, such as S2's.
    ///
    /// # Errors
    /// [`BadLoss`] if a loss is not a number from 0 to 10⁵ s.
    pub fn with_dominated(loss: &[[f32; S]; A]) -> Result<Self, BadLoss> {
        const { assert!(A > 0, "a decision needs an action") };
        let mut table = [[0; S]; A];
        for action in 0..A {
            for state in 0..S {
                let value = loss[action][state];
                if !(0.0..=LOSS_MAX).contains(&value) {
                    return Err(BadLoss::NotALoss {
                        action,
                        state,
                        value,
                    });
                }
                table[action][state] = (value * 1000.0 + 0.5) as i32;
            }
        }
        Ok(Self(table))
    }

    /// Losses in milliseconds, `[action][state]`.
    #[must_use]
    pub const fn milliseconds(&self) -> &[[i32; S]; A] {
        &self.0
    }

    /// The first action that another one dominates, if any does.
    #[must_use]
    pub fn dominated(&self) -> Option<Dominated> {
        for action in 0..A {
            for by in 0..A {
                if self.dominates(by, action) {
                    return Some(Dominated { action, by });
                }
            }
        }
        None
    }

    /// Action `by` is never worse than `action`, and better somewhere, or as good and safer.
    fn dominates(&self, by: usize, action: usize) -> bool {
        let mut better = by > action;
        for state in 0..S {
            let (one, other) = (self.0[by][state], self.0[action][state]);
            if one > other {
                return false;
            }
            better |= one < other;
        }
        by != action && better
    }

    /// S2 E22: the posterior expected loss of each action, exactly, in milliseconds times [`ONE`].
    ///
    /// $$B(p, a) = \sum_\theta L(\theta, a) p(\theta \mid z)$$
    //= decide.INV-7
    #[must_use]
    pub fn expected(&self, belief: &Belief<S>) -> [i64; A] {
        let mut expected = [0; A];
        for (sum, losses) in expected.iter_mut().zip(&self.0) {
            for (&loss, &part) in losses.iter().zip(belief.parts()) {
                *sum += i64::from(loss) * i64::from(part);
            }
        }
        expected
    }

    /// The same in seconds.
    #[must_use]
    pub fn expected_seconds(&self, belief: &Belief<S>) -> [f32; A] {
        self.expected(belief)
            .map(|loss| loss as f32 / (ONE as f32 * 1000.0))
    }

    /// The action with the least expected loss, by index. Of several, and of those that the rounding
    /// of the belief cannot tell from it, the last: the safest.
    //= decide.INV-10
    #[must_use]
    pub fn choose(&self, belief: &Belief<S>) -> usize {
        safest_of_the_least(&self.expected(belief), ROUNDING * self.spread())
    }

    /// The same for a belief that there may not be: without one, the safest action.
    //= decide.INV-3
    #[must_use]
    pub fn respond(&self, belief: &Result<Belief<S>, NoBelief>) -> usize {
        match belief {
            Ok(belief) => self.choose(belief),
            Err(_) => A - 1,
        }
    }

    /// By how much actions can differ: the sum over states of greatest less least loss.
    fn spread(&self) -> i64 {
        let mut sum = 0;
        for state in 0..S {
            let (mut least, mut greatest) = (self.0[0][state], self.0[0][state]);
            for action in 0..A {
                least = least.min(self.0[action][state]);
                greatest = greatest.max(self.0[action][state]);
            }
            sum += i64::from(greatest) - i64::from(least);
        }
        sum
    }
}

/// The last of the losses that exceed the least by no more than `tie` (0 at least), by index.
//= decide.INV-8
#[must_use]
pub fn safest_of_the_least<const A: usize>(losses: &[i64; A], tie: i64) -> usize {
    let mut least = i64::MAX;
    for &loss in losses {
        least = least.min(loss);
    }
    let most = least.saturating_add(tie);
    let mut chosen = 0;
    for (action, &loss) in losses.iter().enumerate() {
        if loss <= most {
            chosen = action;
        }
    }
    chosen
}

/// Losses that depend on the distance of the obstacle: one table from a distance on, another one up to
/// a smaller distance, and between them in proportion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistanceLoss<const A: usize, const S: usize> {
    far: LossTable<A, S>,
    near: LossTable<A, S>,
    /// mm.
    far_distance: i32,
    /// mm.
    near_distance: i32,
}

impl<const A: usize, const S: usize> DistanceLoss<A, S> {
    /// `far` holds from `far_distance` on, `near` up to `near_distance`.
    ///
    /// # Errors
    /// [`BadLoss`] if the distances are not at least 1 cm apart, or naming an action that the same
    /// other one dominates in both tables, and hence at every distance.
    pub fn new(
        far: LossTable<A, S>,
        far_distance: Length,
        near: LossTable<A, S>,
        near_distance: Length,
    ) -> Result<Self, BadLoss> {
        let loss = Self::with_dominated(far, far_distance, near, near_distance)?;
        for action in 0..A {
            for by in 0..A {
                if far.dominates(by, action) && near.dominates(by, action) {
                    return Err(BadLoss::Dominated(Dominated { action, by }));
                }
            }
        }
        Ok(loss)
    }

    /// The same for somebody who wants actions that are never chosen.
    ///
    /// # Errors
    /// [`BadLoss`] if the distances are not at least 1 cm apart.
    pub fn with_dominated(
        far: LossTable<A, S>,
        far_distance: Length,
        near: LossTable<A, S>,
        near_distance: Length,
    ) -> Result<Self, BadLoss> {
        let (most, least) = (far_distance.get(), near_distance.get());
        in_range("near_distance", least, 0.0, most - 0.01, "m").map_err(BadLoss::Distance)?;
        Ok(Self {
            far,
            near,
            far_distance: millimetres_up(most),
            near_distance: millimetres_down(least),
        })
    }

    /// The table at a distance.
    #[must_use]
    pub fn at(&self, distance: Length) -> LossTable<A, S> {
        let span = i64::from(self.far_distance) - i64::from(self.near_distance);
        // Rounded down: no obstacle counts as farther than it is.
        let beyond = i64::from(millimetres_down(distance.get())) - i64::from(self.near_distance);
        let beyond = beyond.max(0).min(span);
        let mut table = self.near;
        for action in 0..A {
            for state in 0..S {
                let near = i64::from(self.near.0[action][state]);
                let far = i64::from(self.far.0[action][state]);
                table.0[action][state] = (near + (far - near) * beyond / span.max(1)) as i32;
            }
        }
        table
    }
}
