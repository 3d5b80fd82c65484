//! Chapter `decide`: S2's filter, losses and decision.

#[cfg(not(kani))]
use super::kani;
use super::view::{any_sample, checked};
use sidestep::config::{self, Config};
use sidestep::decide::{
    self, Belief, LossTable, ONE, Parameters, Response, SecondLook, TransitionMatrix,
};
use sidestep::law::Advice;
use sidestep::observation::{BaseStatus, Observation, SonarSample};
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep_spec::decide as law;

/// Any belief in two states that there is.
pub fn any_belief() -> Belief<2> {
    let first: u32 = kani::any();
    kani::assume(first <= ONE);
    match Belief::from_parts([first, ONE - first]) {
        Some(belief) => belief,
        None => unreachable!(),
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
    let weights: [f32; 2] = kani::any();
    let belief = Belief::from_weights(&weights);
    assert!(law::only_weights_are_beliefs(&weights, belief.is_ok()));
    if let Ok(belief) = belief {
        assert!(law::on_simplex(belief.parts(), ONE));
        kani::cover!(belief.parts()[0] == ONE, "certain");
        kani::cover!(belief.parts()[0] < belief.parts()[1], "undecided");
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

/// What is no transition matrix is refused, for any bit patterns of two rows.
//= decide.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn only_stochastic_rows_pass() {
    let rows: [f32; 4] = kani::any();
    let rows = [[rows[0], rows[1]], [rows[2], rows[3]]];
    let accepted = TransitionMatrix::check(&rows).is_ok();
    for row in rows {
        assert!(law::only_stochastic_is_accepted(&row, accepted));
    }
    // Without short circuits, which would make two of each.
    kani::cover!(accepted & (rows[0][0] < rows[1][0]), "accepted");
    kani::cover!(!accepted & (rows[0][0] == 1.0), "refused");
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

/// The Pioneer preset where what appears has to be heard twice.
const TWICE: Config = checked(config::Parameters {
    appear_samples: 2.0,
    ..preset::PIONEER_3DX
});

/// What is handed on of a sonar's latest reading.
fn second_look(look: &mut SecondLook<1>, latest: SonarSample) -> SonarSample {
    let observation = Observation {
        now: latest.taken_at,
        sonar: [Some(latest)],
        odometry: None,
        sighting: None,
        base: BaseStatus {
            motors_enabled: true,
            stalled: false,
            emergency_stop: false,
        },
    };
    let judged = look.judged(&observation, &TWICE);
    match judged.sonar[0] {
        Some(handed_on) => handed_on,
        None => unreachable!(),
    }
}

const fn both(sample: SonarSample) -> (f32, u64) {
    (sample.range, sample.taken_at.0)
}

/// Any four readings one after the other, of any bits and at any times, some of them looked at twice.
//= decide.INV-16
//= decide.INV-17
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(6))]
pub fn little_is_withheld() {
    let mut look = SecondLook::default();
    let mut latest = any_sample();
    let mut before = both(second_look(&mut look, latest));
    let mut in_a_row = 0;
    for _ in 0..3 {
        // What is as it was, time included, is no new reading.
        let next = if kani::any() { latest } else { any_sample() };
        let again = next == latest;
        latest = next;
        let handed_on = both(second_look(&mut look, latest));
        assert!(law::latest_or_before(handed_on, both(latest), Some(before)));
        let withheld = handed_on.1 != latest.taken_at.0;
        in_a_row = match (withheld, again) {
            (false, _) => 0,
            (true, true) => in_a_row,
            (true, false) => in_a_row + 1,
        };
        assert!(law::withheld_at_most_twice(in_a_row));
        before = handed_on;
        kani::cover!(in_a_row == 2, "two in a row");
    }
}

/// A reading up to a second after an echo, with what the two may have come nearer.
//= decide.INV-18
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(6))]
pub fn explained_echoes_count_at_once() {
    let mut look = SecondLook::default();
    let gap = [1, 60, 100, 300, 1000][kani::any::<u8>() as usize % 5];
    let at = |range, ms| SonarSample {
        range,
        taken_at: Instant(ms),
    };
    let (first, second) = (at(kani::any(), 1000), at(kani::any(), 1000 + gap));
    kani::assume((0.0..5.0).contains(&first.range) && (0.0..5.0).contains(&second.range));
    second_look(&mut look, first);
    let handed_on = second_look(&mut look, second).taken_at == second.taken_at;
    let closing = f64::from(TWICE.obstacle_speed_max) + f64::from(TWICE.speed_max);
    assert!(law::explained_counts_at_once(
        second.range,
        first.range,
        gap,
        closing,
        handed_on
    ));
    kani::cover!(handed_on && second.range < first.range, "it came nearer");
    kani::cover!(!handed_on, "it appeared");
}
