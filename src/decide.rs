//! S2: the Bayesian decision of Budiharto, Purwanto and Jazidie.
//!
//! A recursive Bayes filter over a few states ([`Belief`], [`TransitionMatrix`]), the posterior
//! expected loss of each action ([`LossTable`], [`DistanceLoss`]), and [`Decide`], which puts them
//! round a law: it hides from the law what is probably a false echo, and turns the law's motion into
//! a stop where stopping costs less. See `spec/decide.md`.
//!
//! Beliefs and losses are whole numbers: a belief is a number of parts of [`ONE`] for each state, and
//! the parts of all states are [`ONE`] exactly; a loss is in milliseconds. Decisions are therefore
//! exact, ties included. Nothing here is relied on for safety, which is the [`crate::shield`]'s: it
//! judges what the sonars said, not what is believed of it.

use crate::config::Config;
use crate::law::{Advice, Law};
use crate::math;
use crate::observation::SonarReading;
use crate::quantity::{Angle, Instant, Length, OutOfRange, Speed, in_range};
use crate::ring::{Ring, Sonar};
use crate::shield::{millimetres_down, millimetres_up};
use crate::track::{self, Obstacle, Track};
use crate::view::{Pose, View};
use core::fmt;
use nalgebra::Vector2;

// ------------------------------------------------------------------ equations

/// S2 E7 with E6: seconds until robot and obstacle are level along the axis of travel, for an
/// obstacle that is seen at `bearing`, t = d·|sin(θ_R + β)|/(v_R|sin θ_R| + v_o|sin θ_o|). `None` if
/// they never are.
///
/// For people to read. No bound: see [`crate::avoid::contact_time_bound`].
#[must_use]
pub fn time_to_level(
    distance: Length,
    heading: Angle,
    bearing: Angle,
    speed: Speed,
    obstacle_speed: Speed,
    direction: Angle,
) -> Option<f32> {
    let across = distance.get() * math::sin(heading.plus(bearing).get()).abs();
    let closing = speed.get() * math::sin(heading.get()).abs()
        + obstacle_speed.get() * math::sin(direction.get()).abs();
    let time = across / closing;
    (closing > 0.0 && time.is_finite()).then_some(time)
}

// --------------------------------------------------------------------- beliefs

/// A probability of 1, in the parts in which a [`Belief`] is kept.
pub const ONE: u32 = 1 << 24;

/// Weights greater than this are no weights: their sum could not be computed.
const WEIGHT_MAX: f32 = 1e30;

/// Why there is no belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoBelief {
    /// A weight, probability or likelihood is not a number from 0 to 10³⁰.
    NotAWeight {
        /// Index of the state.
        state: usize,
        /// The value given.
        value: f32,
    },
    /// The evidence is impossible in every state that is possible: nothing is left to believe.
    NoEvidence,
}

impl fmt::Display for NoBelief {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAWeight { state, value } => write!(
                f,
                "weight of state {state} is {value}, allowed is 0 to {WEIGHT_MAX:e}"
            ),
            Self::NoEvidence => write!(f, "the weights of all states are 0"),
        }
    }
}

impl core::error::Error for NoBelief {}

/// A probability for each of `S` states (S2 E12): parts of [`ONE`] that add up to it exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Belief<const S: usize>([u32; S]);

impl<const S: usize> Belief<S> {
    /// The belief in proportion to some weights; each probability is within two parts of [`ONE`] of
    /// the exact quotient, the greatest within 2·S.
    ///
    /// # Errors
    /// [`NoBelief`] if a weight is not a number from 0 to 10³⁰, or all are 0.
    pub fn from_weights(weights: &[f32; S]) -> Result<Self, NoBelief> {
        let mut total = 0.0;
        for (state, &value) in weights.iter().enumerate() {
            // A comparison with NaN is false.
            if !(0.0..=WEIGHT_MAX).contains(&value) {
                return Err(NoBelief::NotAWeight { state, value });
            }
            total += value;
        }
        if total <= 0.0 {
            return Err(NoBelief::NoEvidence);
        }
        let mut parts = [0; S];
        for state in 0..S {
            // No weight is greater than the total, however that was rounded.
            parts[state] = (weights[state] / total * ONE as f32) as u32;
        }
        Ok(Self(completed(parts)))
    }

    /// The probability of a state, in [0, 1]; 0 for one that there is not.
    #[must_use]
    pub fn probability(&self, state: usize) -> f32 {
        // Exact: an f32 holds every whole number up to ONE.
        self.0
            .get(state)
            .map_or(0.0, |&part| part as f32 / ONE as f32)
    }

    /// The parts of [`ONE`], state by state.
    #[must_use]
    pub const fn parts(&self) -> &[u32; S] {
        &self.0
    }

    /// S2 E16: the belief one step later, b̄_j = Σ_i b_i·P_ij.
    #[must_use]
    pub fn predicted(&self, transition: &TransitionMatrix<S>) -> Self {
        let mut parts = [0; S];
        for (to, part) in parts.iter_mut().enumerate() {
            let mut sum = 0;
            for from in 0..S {
                sum += u64::from(self.0[from]) * u64::from(transition.rows[from].0[to]);
            }
            *part = (sum / u64::from(ONE)).min(u64::from(ONE)) as u32;
        }
        Self(completed(parts))
    }

    /// S2 E13 and E21: the belief after an observation with these likelihoods, b_j = η·ℓ_j·b̄_j. The
    /// odds of two states are multiplied by the ratio of their likelihoods.
    ///
    /// # Errors
    /// [`NoBelief`] if a likelihood is not a number from 0 to 10³⁰, or no state that is possible
    /// allows the observation.
    pub fn updated(&self, likelihood: &[f32; S]) -> Result<Self, NoBelief> {
        let mut weights = [0.0; S];
        for state in 0..S {
            let value = likelihood[state];
            if !(0.0..=WEIGHT_MAX).contains(&value) {
                return Err(NoBelief::NotAWeight { state, value });
            }
            weights[state] = value * self.probability(state);
        }
        Self::from_weights(&weights)
    }

    /// The belief with no state less probable than `floor` (0 to 1/S): (1 − S·ε)·b + ε. Without it a
    /// belief that has come to 1 could never be changed by any evidence. A floor that is out of range
    /// counts as the nearest that is not.
    #[must_use]
    pub fn floored(&self, floor: f32) -> Self {
        let least = ((floor * ONE as f32) as u32).min(ONE / (S as u32).max(1));
        let kept = u64::from(ONE - least * S as u32);
        let mut parts = [0; S];
        for state in 0..S {
            let part = u64::from(self.0[state]) * kept / u64::from(ONE);
            parts[state] = part as u32 + least;
        }
        Self(completed(parts))
    }
}

/// Parts that add up to [`ONE`]: what rounding lost goes to the greatest, what it gained is taken from
/// it.
fn completed<const S: usize>(mut parts: [u32; S]) -> [u32; S] {
    const { assert!(S > 0, "a belief needs a state") };
    let (mut greatest, mut sum) = (0, 0);
    for state in 0..S {
        sum += u64::from(parts[state]);
        if parts[state] > parts[greatest] {
            greatest = state;
        }
    }
    let one = u64::from(ONE);
    if sum <= one {
        parts[greatest] += (one - sum) as u32;
        return parts;
    }
    let mut excess = sum - one;
    let mut take = |part: &mut u32| {
        let taken = excess.min(u64::from(*part));
        *part -= taken as u32;
        excess -= taken;
    };
    take(&mut parts[greatest]);
    // Never needed for sums that are off by rounding alone.
    for part in &mut parts {
        take(part);
    }
    parts
}

/// Why a matrix is no transition matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotStochastic {
    /// An entry is no probability.
    Entry {
        /// Row: the state before.
        from: usize,
        /// Column: the state after.
        to: usize,
        /// The value given.
        value: f32,
    },
    /// A row does not add up to 1.
    Row {
        /// Row: the state before.
        from: usize,
        /// What it adds up to.
        sum: f32,
    },
}

impl fmt::Display for NotStochastic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entry { from, to, value } => write!(
                f,
                "transition from state {from} to {to} is {value}, allowed is 0 to 1"
            ),
            Self::Row { from, sum } => write!(
                f,
                "transitions from state {from} add up to {sum}, allowed is 1 to within {ROW_ERROR:e}"
            ),
        }
    }
}

impl core::error::Error for NotStochastic {}

/// A row of a transition matrix adds up to 1 to within this.
const ROW_ERROR: f32 = 1e-5;

/// P_ij = p(x_t = j | x_t−1 = i) of S2 E16. Each row is a [`Belief`], so it adds up to 1 exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransitionMatrix<const S: usize> {
    rows: [Belief<S>; S],
}

impl<const S: usize> TransitionMatrix<S> {
    /// A matrix by its rows: `rows[from][to]`.
    ///
    /// # Errors
    /// [`NotStochastic`], with the row, if an entry is not in [0, 1] or a row does not add up to 1.
    pub fn new(rows: &[[f32; S]; S]) -> Result<Self, NotStochastic> {
        let mut checked = [Belief([0; S]); S];
        for from in 0..S {
            let mut sum = 0.0;
            for to in 0..S {
                let value = rows[from][to];
                if !(0.0..=1.0).contains(&value) {
                    return Err(NotStochastic::Entry { from, to, value });
                }
                sum += value;
            }
            if (sum - 1.0).abs() > ROW_ERROR {
                return Err(NotStochastic::Row { from, sum });
            }
            checked[from] =
                Belief::from_weights(&rows[from]).map_err(|_| NotStochastic::Row { from, sum })?;
        }
        Ok(Self { rows: checked })
    }

    /// The row of a state, as a belief.
    #[must_use]
    pub fn row(&self, from: usize) -> Option<&Belief<S>> {
        self.rows.get(from)
    }
}

// ---------------------------------------------------------------------- losses

/// The greatest loss, in seconds.
const LOSS_MAX: f32 = 1e5;

/// Parts of [`ONE`] by which rounding may move a probability in a decision.
const ROUNDING: i64 = 4;

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
    /// this table the robot never stops (decide.INV-9).
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

    /// S2 E22: the posterior expected loss of each action, B(p, a) = Σ_θ L(θ, a)·p(θ|z), exactly, in
    /// milliseconds times [`ONE`].
    #[must_use]
    pub fn expected(&self, belief: &Belief<S>) -> [i64; A] {
        let mut expected = [0; A];
        for action in 0..A {
            for state in 0..S {
                expected[action] += i64::from(self.0[action][state]) * i64::from(belief.0[state]);
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
    #[must_use]
    pub fn choose(&self, belief: &Belief<S>) -> usize {
        let expected = self.expected(belief);
        let mut least = expected[0];
        for loss in expected {
            least = least.min(loss);
        }
        let tie = least + ROUNDING * self.spread();
        let mut chosen = 0;
        for action in 0..A {
            if expected[action] <= tie {
                chosen = action;
            }
        }
        chosen
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
        let beyond = beyond.clamp(0, span);
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

// --------------------------------------------------------------- sensor models

/// The states of S2 E18, as indices of beliefs, likelihoods and losses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// θ1: there is an obstacle.
    Obstacle,
    /// θ2: there is none.
    Nothing,
}

/// What a robot can do about it, from the boldest to the safest. S2 E20 has the last two; going on is
/// what its algorithm does where it predicts no collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Response {
    /// Go on as if there were nothing.
    Continue,
    /// a1: go round it.
    Maneuver,
    /// a2: drive no further.
    Stop,
}

impl Response {
    /// The actions of a table with three rows.
    const ALL: [Self; 3] = [Self::Continue, Self::Maneuver, Self::Stop];
}

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

/// What the decision rests on; plain numbers that [`Settings::new`] checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The sonars; shares of 0.001 to 0.5, a range of 0.8 to 20 m.
    pub sonar: SonarModel,
    /// The camera; shares of 0.001 to 0.999.
    pub camera: CameraModel,
    /// Probability that an echo from where nothing was expected is of a thing, 0.001 to 0.999.
    pub newcomer: f32,
    /// Probability per sonar period that a thing comes to a place where there was none, 0 to 0.5.
    pub appear: f32,
    /// Probability per sonar period that a thing leaves its place, 0 to 0.5.
    pub vanish: f32,
    /// Least probability of a state, ε, 0 to 0.1.
    pub floor: f32,
    /// Time between two looks of a sonar, 10 to 1000 ms: 100 ms in S2. A reading that stands counts
    /// again after it, not before.
    pub sonar_period: u64,
    /// Time between two pictures, 10 to 5000 ms: 500 ms in S2. Older looks are too late to count.
    pub vision_period: u64,
    /// Time between two commands, 10 to 1000 ms: 220 ms in S2. Without any evidence for longer the
    /// decision is to stop.
    pub control_period: u64,
    /// Losses far away, seconds: [`Response`] by [`State`].
    pub far_loss: [[f32; 2]; 3],
    /// Losses at the minimum distance.
    pub near_loss: [[f32; 2]; 3],
}

impl Parameters {
    /// Rates of sensors and losses that `spec/decide.md` gives reasons for.
    pub const USUAL: Self = Self {
        sonar: SonarModel {
            miss: 0.1,
            false_echo: 0.1,
            false_range: 2.5,
        },
        camera: CameraModel {
            detection: 0.93,
            false_alarm: 0.05,
        },
        newcomer: 0.1,
        appear: 0.001,
        vanish: 0.02,
        floor: 1e-3,
        sonar_period: 100,
        vision_period: 500,
        control_period: 220,
        far_loss: [[5.0, 0.0], [0.0, 5.0], [5.0, 10.0]],
        near_loss: [[40.0, 0.0], [6.0, 5.0], [5.0, 10.0]],
    };
}

/// Parameters that were checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    parameters: Parameters,
    transition: TransitionMatrix<2>,
    loss: DistanceLoss<3, 2>,
    /// What is believed of an echo from where nothing was expected.
    first: Belief<2>,
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BadSettings {
    /// A parameter.
    OutOfRange(OutOfRange),
    /// The losses.
    Loss(BadLoss),
}

impl fmt::Display for BadSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Loss(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BadSettings {}

impl From<OutOfRange> for BadSettings {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<BadLoss> for BadSettings {
    fn from(error: BadLoss) -> Self {
        Self::Loss(error)
    }
}

impl Settings {
    /// Checks parameters; the far losses hold at the configuration's `safe_distance`, the near ones at
    /// its `min_distance`.
    ///
    /// # Errors
    /// [`BadSettings`] naming what is out of range, or an action that is dominated at every distance.
    pub fn new(parameters: Parameters, config: &Config) -> Result<Self, BadSettings> {
        let p = &parameters;
        in_range("sonar.miss", p.sonar.miss, 1e-3, 0.5, "share")?;
        in_range("sonar.false_echo", p.sonar.false_echo, 1e-3, 0.5, "share")?;
        let false_range = p.sonar.false_range;
        in_range("sonar.false_range", false_range, 0.8, 20.0, "m")?;
        in_range("camera.detection", p.camera.detection, 1e-3, 0.999, "share")?;
        let false_alarm = p.camera.false_alarm;
        in_range("camera.false_alarm", false_alarm, 1e-3, 0.999, "share")?;
        let newcomer = in_range("newcomer", p.newcomer, 1e-3, 0.999, "share")?;
        let appear = in_range("appear", p.appear, 0.0, 0.5, "share")?;
        let vanish = in_range("vanish", p.vanish, 0.0, 0.5, "share")?;
        in_range("floor", p.floor, 0.0, 0.1, "share")?;
        in_range("sonar_period", p.sonar_period as f32, 10.0, 1e3, "ms")?;
        in_range("vision_period", p.vision_period as f32, 10.0, 5e3, "ms")?;
        in_range("control_period", p.control_period as f32, 10.0, 1e3, "ms")?;
        let far = LossTable::with_dominated(&p.far_loss)?;
        let near = LossTable::with_dominated(&p.near_loss)?;
        let at = |metres| Length::metres(metres).unwrap_or(Length::ZERO);
        let loss = DistanceLoss::new(far, at(config.safe_distance), near, at(config.min_distance))?;
        // None of these is refused, with the probabilities above.
        let even = Belief([ONE / 2; 2]);
        let transition = TransitionMatrix::new(&[[1.0 - vanish, vanish], [appear, 1.0 - appear]])
            .unwrap_or(TransitionMatrix { rows: [even; 2] });
        let first = Belief::from_weights(&[newcomer, 1.0 - newcomer]).unwrap_or(even);
        Ok(Self {
            parameters,
            transition,
            loss,
            first,
        })
    }

    /// The usual settings.
    ///
    /// # Errors
    /// [`BadSettings`] if the configuration's minimum distance is within 1 cm of its safe distance.
    pub fn usual(config: &Config) -> Result<Self, BadSettings> {
        Self::new(Parameters::USUAL, config)
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The losses by distance.
    #[must_use]
    pub const fn loss(&self) -> &DistanceLoss<3, 2> {
        &self.loss
    }

    /// What is best done about a thing at a distance that is there with this probability.
    #[must_use]
    pub fn respond(&self, belief: &Belief<2>, distance: Length) -> Response {
        let chosen = self.loss.at(distance).choose(belief);
        Response::ALL.get(chosen).copied().unwrap_or(Response::Stop)
    }
}

// -------------------------------------------------------------------- the law

/// Places where something may be that are kept in mind at once.
const PLACES: usize = 16;

/// Echoes within this distance of a place, in metres, may come from there: [`crate::track`] has the
/// same.
const GATE: f32 = 0.4;

/// Echoes of one thing scatter by no more than this, in metres, beyond what moved meanwhile.
const SCATTER: f32 = 0.15;

/// A place believed in less than this is forgotten.
const FORGOTTEN: f32 = 0.02;

/// Somebody whom a camera detected is within this angle of where it says, in radians.
const CAMERA_ANGLE: f32 = 0.26;

/// After this many steps a belief without evidence is what it is without any.
const STEPS_MAX: u64 = 200;

/// Where something may be.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// In the odometry frame.
    position: Vector2<f32>,
    belief: Belief<2>,
    /// When an echo came from there last.
    heard: Instant,
}

impl Place {
    /// An echo from the thing in this place differs from its distance by no more than this, m: by what
    /// echoes scatter and by how far it may have moved.
    fn gate(&self, now: Instant, config: &Config) -> f32 {
        let age = now.since(self.heard).unwrap_or(0).min(1_000) as f32 / 1000.0;
        (SCATTER + config.obstacle_speed_max * age).min(GATE)
    }
}

/// A usable reading of a sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sound {
    echo: bool,
    /// Of the echo, or up to which there was none, m.
    range: f32,
}

impl Sound {
    /// None if the reading is not usable.
    fn of(reading: SonarReading) -> Option<Self> {
        let (echo, range) = match reading {
            SonarReading::Echo(range) => (true, range.get()),
            SonarReading::TooNear => (true, 0.0),
            SonarReading::NoEcho(range) => (false, range.get()),
            SonarReading::Stale | SonarReading::Invalid => return None,
        };
        Some(Self { echo, range })
    }

    /// What it says of a place.
    fn of_place(
        &self,
        place: Vector2<f32>,
        gate: f32,
        sonar: &Sonar,
        pose: &Pose,
        config: &Config,
    ) -> Hearing {
        let offset = pose.to_robot(place) - sonar.position;
        let distance = math::norm(offset);
        let covered = offset.dot(&sonar.axis) >= distance * math::cos(config.sonar_half_angle);
        let level = (self.range - distance).abs() <= gate;
        let beside = math::norm(offset - sonar.axis * self.range) <= GATE;
        match (self.echo && level, covered) {
            (true, true) => Hearing::There,
            (true, false) if beside => Hearing::Beside,
            (false, true) if self.range > distance + gate => Hearing::Past,
            _ => Hearing::Nothing,
        }
    }
}

/// What was decided in a tick, for people to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// What is done.
    pub response: Response,
    /// There was no evidence for too long: that, and no belief, is why it is to stop.
    pub blind: bool,
    /// Probability that the obstacle is there, if there is one.
    pub probability: Option<f32>,
    /// Its distance.
    pub distance: Option<Length>,
    /// Expected losses at that distance, in seconds, by [`Response`].
    pub expected: Option<[f32; 3]>,
    /// Probability of the most probable place with an echo that is *not* believed.
    pub doubted: Option<f32>,
    /// The law advised to drive ahead, and is made to stand.
    pub overruled: bool,
}

impl Verdict {
    /// Nothing to decide.
    const IDLE: Self = Self {
        response: Response::Continue,
        blind: false,
        probability: None,
        distance: None,
        expected: None,
        doubted: None,
        overruled: false,
    };
}

/// S2's decision round a law.
///
/// The law is shown the obstacle that is believed in, not the one that an echo suggests; everything
/// else of the view is shown as it is. Where the decision is to stop, the law's advice to drive ahead
/// becomes advice to stand; otherwise its advice is passed on as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decide<L, const N: usize> {
    law: L,
    config: Config,
    ring: Ring<N>,
    settings: Settings,
    places: [Option<Place>; PLACES],
    track: Option<Track>,
    /// What each sonar said last that counted, and when.
    heard: [Option<(SonarReading, Instant)>; N],
    /// A camera's look that has not counted yet.
    look: Option<CameraLook>,
    /// The last tick.
    last: Option<Instant>,
    /// When there was evidence last.
    evidence: Option<Instant>,
    verdict: Verdict,
}

impl<L, const N: usize> Decide<L, N> {
    /// Puts the decision round a law.
    #[must_use]
    pub const fn new(law: L, config: Config, ring: Ring<N>, settings: Settings) -> Self {
        Self {
            law,
            config,
            ring,
            settings,
            places: [None; PLACES],
            track: None,
            heard: [None; N],
            look: None,
            last: None,
            evidence: None,
            verdict: Verdict::IDLE,
        }
    }

    /// The law.
    #[must_use]
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// What was decided last.
    #[must_use]
    pub const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Takes in a camera's look; it counts in the next tick, once, unless it is too old by then.
    pub const fn see(&mut self, look: CameraLook) {
        self.look = Some(look);
    }

    /// Which readings are new: those that changed, and those that have stood for a sonar period.
    fn fresh(&mut self, view: &View<N>) -> [bool; N] {
        let mut fresh = [false; N];
        for i in 0..N {
            let reading = view.sonar[i];
            let usable = !matches!(reading, SonarReading::Stale | SonarReading::Invalid);
            let stood = |since: Instant| {
                let period = self.settings.parameters.sonar_period;
                view.now.since(since).is_some_and(|time| time >= period)
            };
            let new = self.heard[i].is_none_or(|(before, at)| before != reading || stood(at));
            if usable && new {
                fresh[i] = true;
                self.heard[i] = Some((reading, view.now));
                self.evidence = Some(view.now);
            }
        }
        fresh
    }

    /// S2 E16, as many times as sonar periods have passed.
    fn predict(&mut self, now: Instant) {
        let elapsed = self.last.and_then(|last| now.since(last)).unwrap_or(0);
        // Half a period or more is one: ticks and looks need not keep step.
        let period = self.settings.parameters.sonar_period.max(1);
        let steps = ((elapsed + period / 2) / period).min(STEPS_MAX);
        for place in self.places.iter_mut().flatten() {
            for _ in 0..steps {
                place.belief = place.belief.predicted(&self.settings.transition);
            }
        }
        self.last = Some(now);
    }

    /// S2 E13: what the sonars say of the places, and places for echoes from where none was expected.
    fn update(&mut self, view: &View<N>, fresh: &[bool; N]) {
        let interest = self.config.safe_distance + GATE;
        for i in 0..N {
            let Some(sound) = Sound::of(view.sonar[i]).filter(|_| fresh[i]) else {
                continue;
            };
            let sonar = &self.ring.sonars()[i];
            let from = view
                .pose
                .to_world(sonar.position + sonar.axis * sound.range);
            // An echo is one thing's: that of the place it fits best.
            let source = self.source(&sound, sonar, view);
            for (k, slot) in self.places.iter_mut().enumerate() {
                let Some(place) = slot else { continue };
                let gate = place.gate(view.now, &self.config);
                let mut hearing =
                    sound.of_place(place.position, gate, sonar, &view.pose, &self.config);
                if hearing == Hearing::There && source != Some(k) {
                    hearing = Hearing::Nothing;
                }
                let likelihood = self.settings.parameters.sonar.likelihood(hearing, gate);
                // Likelihoods are positive, and so is each belief, by its floor: there is a posterior.
                if let Ok(belief) = place.belief.updated(&likelihood) {
                    place.belief = belief.floored(self.settings.parameters.floor);
                }
                if hearing == Hearing::There {
                    place.position = from;
                    place.heard = view.now;
                }
            }
            if sound.echo && source.is_none() && sound.range <= interest {
                self.add(
                    Place {
                        position: from,
                        belief: self.settings.first,
                        heard: view.now,
                    },
                    view.pose.position,
                );
            }
        }
    }

    /// The place that an echo fits best, if it fits any: one that the sonar covers before one beside,
    /// then the one at the most similar distance.
    fn source(&self, sound: &Sound, sonar: &Sonar, view: &View<N>) -> Option<usize> {
        let mut best: Option<(usize, bool, f32)> = None;
        for (k, slot) in self.places.iter().enumerate() {
            let Some(place) = slot else { continue };
            let gate = place.gate(view.now, &self.config);
            let hearing = sound.of_place(place.position, gate, sonar, &view.pose, &self.config);
            let covered = match hearing {
                Hearing::There => true,
                Hearing::Beside => false,
                Hearing::Past | Hearing::Nothing => continue,
            };
            let offset = view.pose.to_robot(place.position) - sonar.position;
            let off = (math::norm(offset) - sound.range).abs();
            let better = best.is_none_or(|(_, before, least)| {
                (covered && !before) || (covered == before && off < least)
            });
            if better {
                best = Some((k, covered, off));
            }
        }
        best.map(|(k, ..)| k)
    }

    /// What a camera says of the places in its field of view.
    fn look(&mut self, view: &View<N>) {
        let Some(look) = self.look.take() else { return };
        let vision = self.settings.parameters.vision_period;
        if view.now.since(look.taken_at).is_none_or(|age| age > vision) {
            return;
        }
        self.evidence = Some(view.now);
        for place in self.places.iter_mut().flatten() {
            let offset = view.pose.to_robot(place.position);
            let bearing = Angle::radians(math::atan2(offset.y, offset.x)).unwrap_or(Angle::ZERO);
            let likelihood = match look.detected {
                Some(at) if bearing.minus(at).get().abs() <= CAMERA_ANGLE => {
                    self.settings.parameters.camera.likelihood(true)
                }
                None if bearing.get().abs() <= self.config.view_half_angle => {
                    self.settings.parameters.camera.likelihood(false)
                }
                // Somebody else was detected: nothing is said of this one.
                _ => continue,
            };
            if let Ok(belief) = place.belief.updated(&likelihood) {
                place.belief = belief.floored(self.settings.parameters.floor);
            }
        }
    }

    /// Keeps a place in mind, instead of the farthest if there are too many.
    fn add(&mut self, place: Place, robot: Vector2<f32>) {
        let away = |place: &Place| math::norm(place.position - robot);
        let (mut farthest, mut most) = (None, away(&place));
        for i in 0..PLACES {
            let Some(held) = &self.places[i] else {
                self.places[i] = Some(place);
                return;
            };
            if away(held) > most {
                (farthest, most) = (Some(i), away(held));
            }
        }
        if let Some(i) = farthest {
            self.places[i] = Some(place);
        }
    }

    /// Forgets places that are not believed in, that are far away by now, or that have turned out to be
    /// another's.
    fn forget(&mut self, robot: Vector2<f32>) {
        for i in 0..PLACES {
            let Some(place) = self.places[i] else {
                continue;
            };
            let twin = self.places.iter().enumerate().any(|(k, other)| {
                other.is_some_and(|other| {
                    let near = math::norm(other.position - place.position) <= SCATTER;
                    let (one, two) = (place.belief.0[0], other.belief.0[0]);
                    k != i && near && (two > one || (two == one && k < i))
                })
            });
            let away = math::norm(place.position - robot);
            let far = away > self.config.safe_distance + self.config.robot_radius + 2.0 * GATE;
            if twin || far || place.belief.probability(0) < FORGOTTEN {
                self.places[i] = None;
            }
        }
    }

    /// The belief in the place nearest to a point, if one is within the gate.
    fn belief_at(&self, point: Vector2<f32>) -> Option<Belief<2>> {
        let mut found = None;
        let mut nearest = GATE;
        for place in self.places.iter().flatten() {
            let offset = math::norm(place.position - point);
            if offset <= nearest {
                (found, nearest) = (Some(place.belief), offset);
            }
        }
        found
    }

    /// The readings with only those echoes that are believed, and the greatest doubted probability.
    fn believed(&self, view: &View<N>) -> ([SonarReading; N], Option<f32>) {
        let silence = Length::metres(self.config.sonar_range_max).unwrap_or(Length::MAX);
        let mut readings = view.sonar;
        let mut doubted: Option<f32> = None;
        for i in 0..N {
            let SonarReading::Echo(range) = view.sonar[i] else {
                continue;
            };
            let sound = Sound {
                echo: true,
                range: range.get(),
            };
            // What is not kept in mind, being far away or one too many, is taken as it is.
            let source = self.source(&sound, &self.ring.sonars()[i], view);
            let Some(Place { belief, .. }) = source.and_then(|k| self.places[k]) else {
                continue;
            };
            if self.settings.respond(&belief, range) == Response::Continue {
                readings[i] = SonarReading::NoEcho(silence);
                let probability = belief.probability(0);
                doubted = Some(doubted.map_or(probability, |most| most.max(probability)));
            }
        }
        (readings, doubted)
    }

    /// The robot, driving as it looks, runs into the obstacle: it is ahead and within the corridor.
    fn collides(&self, obstacle: &Obstacle, pose: &Pose) -> bool {
        let offset = pose.to_robot(obstacle.position);
        offset.x > 0.0 && offset.y.abs() <= self.config.robot_radius + self.config.corridor_margin
    }

    /// S2 E22 and A1: what to do about the obstacle that is believed in.
    fn decide(&self, view: &View<N>, obstacle: Option<&Obstacle>, doubted: Option<f32>) -> Verdict {
        let late = |evidence| {
            let period = self.settings.parameters.control_period;
            view.now.since(evidence).is_none_or(|time| time > period)
        };
        let mut verdict = Verdict {
            doubted,
            ..Verdict::IDLE
        };
        if let Some(obstacle) = obstacle {
            let belief = self.belief_at(obstacle.position);
            let belief = belief.unwrap_or(self.settings.first);
            let collides = self.collides(obstacle, &view.pose);
            verdict.response = match self.settings.respond(&belief, obstacle.distance) {
                Response::Stop if collides => Response::Stop,
                // What is followed was believed in: losing sight of it is no reason to go on.
                _ => Response::Maneuver,
            };
            verdict.probability = Some(belief.probability(0));
            verdict.distance = Some(obstacle.distance);
            let table = self.settings.loss.at(obstacle.distance);
            verdict.expected = Some(table.expected_seconds(&belief));
        }
        if self.evidence.is_none_or(late) {
            verdict.response = Response::Stop;
            verdict.blind = true;
        }
        verdict
    }
}

impl<L: Law<N>, const N: usize> Law<N> for Decide<L, N> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        let fresh = self.fresh(view);
        self.predict(view.now);
        self.update(view, &fresh);
        self.look(view);
        let (readings, doubted) = self.believed(view);
        let (pose, now) = (&view.pose, view.now);
        track::follow(
            &mut self.track,
            &readings,
            &fresh,
            pose,
            now,
            &self.ring,
            &self.config,
        );
        let obstacle = self
            .track
            .map(|track| track.obstacle(now, pose, view.speed, None, &self.ring, &self.config));
        self.verdict = self.decide(view, obstacle.as_ref(), doubted);
        self.forget(pose.position);
        let advice = self.law.advise(&View { obstacle, ..*view });
        // Advice that is no number is passed on: the shield has a name for it.
        self.verdict.overruled = self.verdict.response == Response::Stop && advice.speed > 0.0;
        if self.verdict.overruled {
            return Advice {
                speed: 0.0,
                ..advice
            };
        }
        advice
    }

    fn mode(&self) -> &'static str {
        match (self.verdict.overruled, self.verdict.blind) {
            (true, true) => "no evidence",
            (true, false) => "decided to stop",
            (false, _) => self.law.mode(),
        }
    }
}
