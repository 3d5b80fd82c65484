//! A discrete Bayes filter: S2 E11 to E16, E21, and what E23 to E28 work out.

use crate::quantity::{OutOfRange, in_range};
use core::fmt;

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
    /// The belief in proportion to some weights. Each probability is within S + 1 parts of [`ONE`] of
    /// the exact quotient, the greatest within S·(S + 1): S roundings in f32 and a cut.
    ///
    /// # Errors
    /// [`NoBelief`] if a weight is not a number from 0 to 10³⁰, or all are 0.
    //= decide.INV-2
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

    /// The belief of these parts; none if they do not add up to [`ONE`].
    #[must_use]
    pub fn from_parts(parts: [u32; S]) -> Option<Self> {
        let mut sum = 0;
        for part in parts {
            sum += u64::from(part);
        }
        (sum == u64::from(ONE)).then_some(Self(parts))
    }

    /// Each state as probable as any other.
    #[must_use]
    pub fn even() -> Self {
        Self(completed([ONE / S as u32; S]))
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

    /// S2 E16: the belief one step later.
    ///
    /// $$\bar b_j = \sum_i b_i P_{ij}$$
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

    /// S2 E13 and E21: the belief after an observation with these likelihoods ℓ. The odds of two states
    /// are multiplied by the ratio of their likelihoods. Rounded like
    /// [`from_weights`](Self::from_weights), twice more.
    ///
    /// $$b_j = \eta \ell_j \bar b_j$$
    ///
    /// # Errors
    /// [`NoBelief`] if a likelihood is not a number from 0 to 10³⁰, or no state that is possible
    /// allows the observation.
    //= decide.INV-4
    //= decide.INV-5
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

    /// The belief with no state less probable than `floor`: (1 − S·ε)·b + ε. Without it a belief that
    /// has come to 1 could never be changed by any evidence.
    ///
    /// # Errors
    /// [`OutOfRange`] if the floor is not in 0 to 1/S.
    pub fn floored(&self, floor: f32) -> Result<Self, OutOfRange> {
        let floor = in_range("floor", floor, 0.0, 1.0 / S as f32, "share")?;
        let parts = (floor * ONE as f32) as u32;
        Ok(self.raised(parts.min(ONE / S as u32)))
    }

    /// The same for a floor in parts of [`ONE`], at most [`ONE`]/S.
    pub(super) fn raised(&self, least: u32) -> Self {
        let kept = u64::from(ONE - least * S as u32);
        let mut parts = [0; S];
        for (part, held) in parts.iter_mut().zip(self.0) {
            *part = (u64::from(held) * kept / u64::from(ONE)) as u32 + least;
        }
        Self(completed(parts))
    }
}

/// Parts that add up to [`ONE`]: what rounding lost goes to the greatest, what it gained is taken from
/// it.
//= decide.INV-1
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
        if let Some(part) = parts.get_mut(greatest) {
            *part += (one - sum) as u32;
        }
        return parts;
    }
    let mut excess = sum - one;
    let mut take = |part: &mut u32| {
        let taken = excess.min(u64::from(*part));
        *part -= taken as u32;
        excess -= taken;
    };
    if let Some(part) = parts.get_mut(greatest) {
        take(part);
    }
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
        Self::check(rows)?;
        let mut checked = [Belief([0; S]); S];
        for (from, row) in rows.iter().enumerate() {
            checked[from] =
                Belief::from_weights(row).map_err(|_| NotStochastic::Row { from, sum: 0.0 })?;
        }
        Ok(Self { rows: checked })
    }

    /// Whether rows are those of a transition matrix.
    ///
    /// # Errors
    /// [`NotStochastic`], as [`new`](Self::new) has it.
    //= decide.INV-6
    pub fn check(rows: &[[f32; S]; S]) -> Result<(), NotStochastic> {
        for (from, row) in rows.iter().enumerate() {
            let mut sum = 0.0;
            for (to, &value) in row.iter().enumerate() {
                if !(0.0..=1.0).contains(&value) {
                    return Err(NotStochastic::Entry { from, to, value });
                }
                sum += value;
            }
            if (sum - 1.0).abs() > ROW_ERROR {
                return Err(NotStochastic::Row { from, sum });
            }
        }
        Ok(())
    }

    /// A matrix of rows that are distributions already.
    #[must_use]
    pub const fn from_rows(rows: [Belief<S>; S]) -> Self {
        Self { rows }
    }

    /// Whatever was before, each state is as probable as any other.
    #[must_use]
    pub fn even() -> Self {
        Self {
            rows: [Belief::even(); S],
        }
    }

    /// The row of a state, as a belief.
    #[must_use]
    pub fn row(&self, from: usize) -> Option<&Belief<S>> {
        self.rows.get(from)
    }
}
