//! Chapter `decide`: S2's filter, losses and decision.

#[cfg(not(kani))]
use super::kani;
use sidestep::decide::{self, Belief, LossTable, ONE, Parameters, Response, TransitionMatrix};
use sidestep::law::Advice;
use sidestep_spec::decide as law;

/// Any belief in two states that there is.
pub fn any_belief() -> Belief<2> {
    let first: u32 = kani::any();
    kani::assume(first <= ONE);
    // Both weights are whole numbers up to 2²⁴ and so is their sum: nothing is rounded.
    match Belief::from_weights(&[first as f32, (ONE - first) as f32]) {
        Ok(belief) => belief,
        Err(_) => unreachable!(),
    }
}

/// A belief of any weights, also after an observation, is on the simplex to the last part, or there is
/// none.
//= decide.INV-1
//= decide.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(5))]
pub fn beliefs_are_on_the_simplex() {
    let weights: [f32; 3] = kani::any();
    let belief = Belief::from_weights(&weights);
    assert!(law::only_weights_are_beliefs(&weights, belief.is_ok()));
    if let Ok(belief) = belief {
        assert!(law::on_simplex(belief.parts(), ONE));
        kani::cover!(belief.parts()[0] == ONE, "certain");
        kani::cover!(belief.parts()[0] < belief.parts()[2], "undecided");
    }
    kani::cover!(belief.is_err() && weights[0] > 0.0, "refused");
}

/// An observation of any likelihoods leaves a belief on the simplex, or none.
//= decide.INV-1
//= decide.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn updates_stay_on_the_simplex() {
    let likelihood: [f32; 2] = kani::any();
    let updated = Belief::even().updated(&likelihood);
    assert!(law::only_weights_are_beliefs(&likelihood, updated.is_ok()));
    if let Ok(belief) = updated {
        assert!(law::on_simplex(belief.parts(), ONE));
        kani::cover!(belief.parts()[0] > belief.parts()[1], "for the first");
    }
    kani::cover!(likelihood[1].is_nan(), "NaN");
}

/// One step on, and with a floor, a belief stays on the simplex: whole-number arithmetic, for any
/// belief, any stochastic matrix and any floor.
//= decide.INV-1
//= decide.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn predictions_stay_on_the_simplex() {
    let rows: [f32; 4] = kani::any();
    let transition = TransitionMatrix::new(&[[rows[0], rows[1]], [rows[2], rows[3]]]);
    for row in [[rows[0], rows[1]], [rows[2], rows[3]]] {
        assert!(law::only_stochastic_is_accepted(&row, transition.is_ok()));
    }
    if let Ok(transition) = transition {
        let belief = any_belief();
        let later = belief.predicted(&transition);
        assert!(law::on_simplex(later.parts(), ONE));
        kani::cover!(later.parts()[0] > belief.parts()[0], "more probable");
        if let Ok(floored) = later.floored(kani::any()) {
            assert!(law::on_simplex(floored.parts(), ONE));
            kani::cover!(floored.parts()[0] == ONE / 2, "the greatest floor");
        }
    }
    kani::cover!(transition.is_err() && rows[0] == 1.0, "refused");
}

/// S2 Table 2: whatever is believed, stopping costs 5 s more, and is never chosen.
//= decide.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn table_2_never_stops() {
    let belief = any_belief();
    let [maneuver, stop] = LossTable::TABLE_2.expected(&belief);
    let chosen = LossTable::TABLE_2.choose(&belief);
    assert!(law::table_2_never_stops(maneuver, stop, chosen, ONE));
    kani::cover!(belief.parts()[0] == ONE, "an obstacle for certain");
    kani::cover!(belief.parts()[1] == ONE, "none for certain");
}

/// Expected losses lie between the losses of the action, for any belief and each table that is there to
/// be used: the paper's two, and the usual losses far and near. Tables of any losses multiply two
/// symbolic numbers, which does not close; they are `14e` of `spec/smt/`.
//= decide.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn expected_losses_are_between() {
    let belief = any_belief();
    for table in [LossTable::TABLE_2, LossTable::TEXT] {
        let expected = table.expected(&belief);
        for action in 0..2 {
            let losses = &table.milliseconds()[action];
            assert!(law::between_losses(losses, expected[action], ONE));
        }
    }
    for loss in [Parameters::USUAL.far_loss, Parameters::USUAL.near_loss] {
        if let Ok(table) = LossTable::with_dominated(&loss) {
            let expected = table.expected(&belief);
            for action in 0..3 {
                let losses = &table.milliseconds()[action];
                assert!(law::between_losses(losses, expected[action], ONE));
            }
            kani::cover!(
                expected[0] > expected[2],
                "going on costs more than stopping"
            );
        }
    }
}

/// Of the losses that are least, to within the tie, the safest is chosen; without a belief, the
/// safest of all.
//= decide.INV-3
//= decide.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(5))]
pub fn ties_go_to_the_safest() {
    let losses: [i64; 3] = kani::any();
    let tie: i64 = kani::any();
    kani::assume(tie >= 0);
    let chosen = decide::safest_of_the_least(&losses, tie);
    assert!(law::safest_of_the_best(&losses, tie, chosen));
    kani::cover!(chosen == 0, "the boldest");
    kani::cover!(chosen == 2 && losses[2] > losses[0], "a tie");
    let none = Belief::from_weights(&[kani::any(), kani::any()]);
    if none.is_err() {
        let action = LossTable::TABLE_2.respond(&none);
        assert!(law::no_belief_is_safest(none.is_ok(), action, 2));
        kani::cover!(action == 1, "stop");
    }
}

/// A table that is accepted has a use for each action.
//= decide.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn dominated_actions_are_refused() {
    let loss: [f32; 4] = kani::any();
    let table = LossTable::new(&[[loss[0], loss[1]], [loss[2], loss[3]]]);
    if let Ok(table) = table {
        assert!(law::nothing_dominated(table.milliseconds()));
        kani::cover!(loss[0] < loss[2], "bold for the first state");
        kani::cover!(loss[0] > loss[2], "safe for the first state");
    }
    kani::cover!(table.is_err() && loss[0] == 0.0, "refused");
}

/// The decision never makes motion of anything, whatever the law advises.
//= decide.INV-13
#[cfg_attr(kani, kani::proof)]
pub fn decisions_never_move() {
    let advice = Advice {
        speed: kani::any(),
        turn_rate: kani::any(),
    };
    let response = match kani::any::<u8>() % 3 {
        0 => Response::Continue,
        1 => Response::Maneuver,
        _ => Response::Stop,
    };
    let (given, overruled) = decide::overruled(advice, response);
    assert!(law::never_into_motion(
        response == Response::Stop,
        [advice.speed, advice.turn_rate],
        [given.speed, given.turn_rate],
    ));
    assert!(!overruled || response == Response::Stop);
    kani::cover!(overruled, "overruled");
    kani::cover!(advice.speed.is_nan() && response == Response::Stop, "NaN");
}
