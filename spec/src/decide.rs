//! Chapter `decide`: S2.E6 to E30, its tables, and the invariants of filter, losses and binding. See
//! `spec/decide.md`.

use crate::avoid;

// ---------------------------------------------------------------- equations

/// S2.E6 as printed, which is S1.E1: θ_MO_R = 180° − (θ_R + θ_cam), degrees, not wrapped.
#[must_use]
pub fn e6_printed(heading_deg: f64, camera_deg: f64) -> f64 {
    avoid::e1_printed(heading_deg, camera_deg)
}

/// S2.E7 as printed, which is S1.E4 without its threshold: seconds.
#[must_use]
pub fn e7_printed(
    distance: f64,
    heading_deg: f64,
    camera_deg: f64,
    speed: f64,
    obstacle_speed: f64,
    direction_deg: f64,
) -> f64 {
    let never = f64::NEG_INFINITY;
    let terms = (distance, heading_deg, camera_deg);
    avoid::e4_printed(
        terms.0,
        terms.1,
        terms.2,
        speed,
        obstacle_speed,
        direction_deg,
        never,
    )
    .0
}

/// S2.E7 as read: of the bearing at which the obstacle is seen, without signs; infinite if never.
#[must_use]
pub fn e7(
    distance: f64,
    heading_deg: f64,
    bearing_deg: f64,
    speed: f64,
    obstacle_speed: f64,
    direction_deg: f64,
) -> f64 {
    let sin = |degrees: f64| degrees.to_radians().sin().abs();
    let closing = speed * sin(heading_deg) + obstacle_speed * sin(direction_deg);
    if closing == 0.0 {
        f64::INFINITY
    } else {
        distance * sin(heading_deg + bearing_deg) / closing
    }
}

/// S2.E8 as printed: θ_m = θ_R + (π/2)(k_θ/d_MO), radians, always to the left, not wrapped.
#[must_use]
pub fn e8_printed(distance: f64, turn_distance: f64, heading: f64) -> f64 {
    avoid::e5_printed(distance, turn_distance, heading, true).1
}

/// S2.E9: the heading is the reference heading, as S1.E6.
#[must_use]
pub fn e9(reference: f64) -> f64 {
    avoid::e6(reference)
}

/// S2.E10 as printed, with E8's turn: V_max(1 − |0.5 − Δθ_m/π|).
#[must_use]
pub fn e10_printed(distance: f64, turn_distance: f64, speed_max: f64) -> f64 {
    let turn = avoid::e5_printed(distance, turn_distance, 0.0, true).0;
    avoid::e7_printed(turn, speed_max)
}

/// S2.E11, E21, E25 and E27: the posterior p(θ|z) ∝ p(z|θ)p(θ). None if a likelihood or a prior is not
/// a finite number of 0 or more, or if none of the products is above 0.
#[must_use]
pub fn e21(likelihood: &[f64], prior: &[f64]) -> Option<Vec<f64>> {
    let usable = |value: &f64| value.is_finite() && *value >= 0.0;
    if !likelihood.iter().chain(prior).all(usable) {
        return None;
    }
    let products: Vec<f64> = likelihood.iter().zip(prior).map(|(l, p)| l * p).collect();
    let sum: f64 = products.iter().sum();
    (sum > 0.0).then(|| products.iter().map(|product| product / sum).collect())
}

/// S2.E13: E21 again and again with the same likelihood.
#[must_use]
pub fn e13(likelihood: &[f64], prior: &[f64], updates: usize) -> Option<Vec<f64>> {
    let mut belief = Some(prior.to_vec());
    for _ in 0..updates {
        belief = belief.and_then(|belief| e21(likelihood, &belief));
    }
    belief
}

/// S2.E16: b̄_j = Σ_i b_i·P_ij, with `transition[from][to]`.
#[must_use]
pub fn e16(belief: &[f64], transition: &[Vec<f64>]) -> Vec<f64> {
    let row = |to: usize| {
        belief
            .iter()
            .zip(transition)
            .map(move |(b, row)| b * row[to])
    };
    (0..belief.len()).map(|to| row(to).sum()).collect()
}

/// S2.E22, E29 and E30: B(p, a) = Σ_θ L(θ, a)·p(θ|z), with `loss[action][state]`.
#[must_use]
pub fn e22(loss: &[Vec<f64>], posterior: &[f64]) -> Vec<f64> {
    let expected = |row: &Vec<f64>| row.iter().zip(posterior).map(|(l, p)| l * p).sum();
    loss.iter().map(expected).collect()
}

/// The action of least expected loss; of several the last, which is the safest. None is the safest.
#[must_use]
pub fn choose(loss: &[Vec<f64>], posterior: Option<&[f64]>) -> usize {
    let Some(posterior) = posterior else {
        return loss.len() - 1;
    };
    let expected = e22(loss, posterior);
    let least = expected.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = expected.iter().fold(1.0, |most: f64, b| most.max(b.abs()));
    let tied = |b: &f64| *b <= least + 1e-12 * scale;
    expected.iter().rposition(tied).unwrap_or(loss.len() - 1)
}

/// S2.E18, E20: what the two actions of Table 2 are called.
pub const ACTIONS: [&str; 2] = ["maneuver", "stop"];

/// S2.T2 as printed: `[action][state]`, seconds.
pub const TABLE_2: [[f64; 2]; 2] = [[0.0, 5.0], [5.0, 10.0]];

/// What S2's text says of it: no loss for stopping before an obstacle.
pub const TABLE_2_TEXT: [[f64; 2]; 2] = [[0.0, 5.0], [0.0, 10.0]];

/// S2.E26 and E28 as printed; they do not add up to 1.
pub const POSTERIOR_PRINTED: [f64; 2] = [0.907, 0.019];

/// S2.E29 and E30 as printed.
pub const LOSSES_PRINTED: [f64; 2] = [0.095, 4.725];

/// S2.A1 as read, its inner condition: below d_safe, and a collision predicted.
#[must_use]
pub fn a1(distance: f64, safe_distance: f64, collision: bool) -> &'static str {
    if distance < safe_distance && collision {
        "maneuver"
    } else {
        "continue"
    }
}

// --------------------------------------------------------------- invariants

/// decide.INV-1: probabilities, in parts of `one`, are on the simplex: they add up to it exactly.
#[must_use]
pub fn on_simplex(parts: &[u32], one: u32) -> bool {
    let mut sum = 0;
    for part in parts {
        sum += u64::from(*part);
    }
    sum == u64::from(one)
}

/// decide.INV-2: what is not a finite number of 0 or more for each state, and above 0 for one, is no
/// belief.
#[must_use]
pub fn only_weights_are_beliefs(weights: &[f32], accepted: bool) -> bool {
    let (mut usable, mut some) = (true, false);
    for weight in weights {
        usable &= weight.is_finite() && *weight >= 0.0;
        some |= *weight > 0.0;
    }
    !accepted || (usable && some)
}

/// decide.INV-3: without a belief the action is the safest.
#[must_use]
pub fn no_belief_is_safest(believed: bool, action: usize, actions: usize) -> bool {
    believed || action + 1 == actions
}

/// decide.INV-4: the odds of two states are multiplied by the ratio of their likelihoods:
/// p₁'·ℓ₂p₂ = p₂'·ℓ₁p₁ to within `parts` of `one` in each posterior.
#[must_use]
pub fn odds_law(posterior: [f64; 2], likelihood: [f64; 2], prior: [f64; 2], error: f64) -> bool {
    let (one, two) = (likelihood[0] * prior[0], likelihood[1] * prior[1]);
    (posterior[0] * two - posterior[1] * one).abs() <= error * (one + two)
}

/// decide.INV-5: a likelihood ratio that favours a state more leaves it no less probable, up to
/// `rounding` parts.
#[must_use]
pub fn monotone_in_the_ratio(less: u32, more: u32, rounding: u32) -> bool {
    more.saturating_add(rounding) >= less
}

/// decide.INV-6: a matrix with an entry outside [0, 1] or a row that does not add up to 1 to within
/// 10⁻⁵ is refused.
#[must_use]
pub fn only_stochastic_is_accepted(row: &[f32], accepted: bool) -> bool {
    let (mut probabilities, mut sum) = (true, 0.0);
    for entry in row {
        if (0.0..=1.0).contains(entry) {
            sum += f64::from(*entry);
        } else {
            probabilities = false;
        }
    }
    // The sum in f32 is off by its own rounding.
    !accepted || (probabilities && (sum - 1.0).abs() <= 1.1e-5)
}

/// decide.INV-7: an expected loss (in units of loss times `one`) lies between the least and the
/// greatest loss of the action.
#[must_use]
pub fn between_losses(losses: &[i32], expected: i64, one: u32) -> bool {
    let (mut least, mut greatest) = (i32::MAX, i32::MIN);
    for loss in losses {
        least = least.min(*loss);
        greatest = greatest.max(*loss);
    }
    let one = i64::from(one);
    i64::from(least) * one <= expected && expected <= i64::from(greatest) * one
}

/// decide.INV-8: the action chosen is one of those whose loss exceeds the least by no more than `tie`,
/// and none that is safer is.
#[must_use]
pub fn safest_of_the_best(losses: &[i64], tie: i64, chosen: usize) -> bool {
    let mut least = i64::MAX;
    for loss in losses {
        least = least.min(*loss);
    }
    let mut holds = chosen < losses.len();
    for (action, loss) in losses.iter().enumerate() {
        let good = *loss <= least.saturating_add(tie);
        holds &= if action == chosen {
            good
        } else {
            action < chosen || !good
        };
    }
    holds
}

/// decide.INV-9: with Table 2 stopping costs exactly 5 s more than maneuvering, whatever is believed,
/// so it is never chosen. Losses in ms times `one`.
#[must_use]
pub fn table_2_never_stops(maneuver: i64, stop: i64, chosen: usize, one: u32) -> bool {
    stop - maneuver == 5_000 * i64::from(one) && chosen == 0
}

/// decide.INV-10: adding the same loss to all actions in a state, or measuring losses in another unit,
/// changes no decision.
#[must_use]
pub fn same_choice(before: usize, after: usize) -> bool {
    before == after
}

/// decide.INV-11: no accepted table has an action that another is never worse than.
#[must_use]
pub fn nothing_dominated(losses: &[[i32; 2]]) -> bool {
    let mut holds = true;
    for (a, one) in losses.iter().enumerate() {
        for (b, other) in losses.iter().enumerate() {
            let no_worse = other[0] <= one[0] && other[1] <= one[1];
            let equal = other[0] == one[0] && other[1] == one[1];
            // Of two that are alike the safer one makes the other pointless.
            holds &= a == b || !no_worse || (equal && b < a);
        }
    }
    holds
}

/// decide.INV-12: a nearer obstacle, or a more probable one, is never met more boldly. Actions are
/// ordered from the boldest.
#[must_use]
pub fn no_bolder(before: usize, after: usize) -> bool {
    after >= before
}

/// decide.INV-13: the decision never makes motion: where it stops, there is none ahead; where it does
/// not, the advice is the law's, to the bit.
#[must_use]
pub fn never_into_motion(stop: bool, law: [f32; 2], advice: [f32; 2]) -> bool {
    let same = |i: usize| law[i].to_bits() == advice[i].to_bits();
    let speed = if stop && law[0] > 0.0 {
        advice[0] == 0.0
    } else {
        same(0)
    };
    speed && same(1)
}

/// decide.INV-14: nothing but the obstacle is hidden from the law.
#[must_use]
pub fn only_the_obstacle_differs<V: PartialEq>(given_without: &V, shown_without: &V) -> bool {
    given_without == shown_without
}

/// decide.INV-15: without evidence for longer than the control period the decision is to stop.
#[must_use]
pub fn blind_is_stop(ms_without_evidence: u64, control_period: u64, stop: bool) -> bool {
    ms_without_evidence <= control_period || stop
}

/// decide.INV-16: of a sonar's readings no more than two in a row are withheld.
#[must_use]
pub fn withheld_at_most_twice(in_a_row: u32) -> bool {
    in_a_row <= 2
}

/// decide.INV-17: what is handed on is the latest reading, or the one that was handed on before, to the
/// bit. A reading is its range and its time.
#[must_use]
pub fn latest_or_before(
    handed_on: (f32, u64),
    latest: (f32, u64),
    before: Option<(f32, u64)>,
) -> bool {
    let same = |one: (f32, u64)| (one.0.to_bits(), one.1) == (handed_on.0.to_bits(), handed_on.1);
    same(latest) || before.is_some_and(same)
}

/// decide.INV-18: a reading that is no nearer than the last echo less what robot and thing, closing in
/// at `closing` (m/s), come nearer in `gap` ms counts at once. `range` and `echo` are in metres.
#[must_use]
pub fn explained_counts_at_once(
    range: f32,
    echo: f32,
    gap: u64,
    closing: f64,
    handed_on: bool,
) -> bool {
    f64::from(range) < f64::from(echo) - closing * gap as f64 / 1000.0 || handed_on
}
