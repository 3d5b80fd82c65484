//! Chapter `decide`: S2's filter, losses and sensor models, and the law round a law.

mod common;

use common::{any_f32, between, pioneer_with, view};
use nalgebra::Vector2;
use proptest::prelude::*;
use sidestep::avoid::Avoid;
use sidestep::config::{self, Config};
use sidestep::decide::{
    self, BadLoss, BadSettings, Belief, CameraLook, CameraModel, Decide, DistanceLoss, Dominated,
    Hearing, LossTable, NoBelief, NotStochastic, ONE, Parameters, Response, SecondLook, Settings,
    SonarModel, TransitionMatrix,
};
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length};
use sidestep::view::{Class, Memory, View};
use sidestep_spec::{avoid as motion, decide as law};

/// Parts by which rounding may move a probability.
const ROUNDING: u32 = 8;

fn metres(metres: f32) -> Length {
    Length::metres(metres).expect("a length")
}

fn table_1() -> Config {
    Config::new(preset::SRIKANDI_II_2011).expect("the preset is good")
}

fn usual() -> Settings {
    Settings::usual(&table_1()).expect("usual")
}

/// A weight as evidence gives it, or next to none.
fn weight() -> impl Strategy<Value = f32> {
    prop_oneof![6 => 0.0_f32..=1.0, 1 => Just(0.0), 1 => 0.0_f32..1e-6, 1 => 0.0_f32..1e30]
}

/// A likelihood that does not vanish.
fn likelihood() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0.001_f32..=1.0, 1 => 1e-6_f32..1e6]
}

/// Any belief in two states.
fn belief() -> impl Strategy<Value = Belief<2>> {
    prop_oneof![4 => 0..=ONE, 1 => Just(0), 1 => Just(ONE), 1 => 0..100_u32].prop_map(|first| {
        Belief::from_weights(&[first as f32, (ONE - first) as f32]).expect("weights")
    })
}

/// Losses in seconds, of a whole number of milliseconds.
fn seconds() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0..20_000_u32, 1 => 0..10_000_000_u32, 1 => Just(0)]
        .prop_map(|ms| ms as f32 / 1000.0)
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    //= decide.INV-1
    //= decide.INV-2
    #[test]
    fn beliefs_are_on_the_simplex(weights in [any_f32(), any_f32(), any_f32(), any_f32()]) {
        let belief = Belief::from_weights(&weights);
        prop_assert!(law::only_weights_are_beliefs(&weights, belief.is_ok()));
        match belief {
            Ok(belief) => {
                prop_assert!(law::on_simplex(belief.parts(), ONE));
                let sum: f32 = (0..4).map(|state| belief.probability(state)).sum();
                prop_assert!((sum - 1.0).abs() < 1e-6);
                prop_assert_eq!(belief.probability(4), 0.0);
            }
            Err(NoBelief::NotAWeight { state, value }) => {
                prop_assert_eq!(weights[state].to_bits(), value.to_bits());
                prop_assert!(!(0.0..=1e30).contains(&value));
            }
            Err(NoBelief::NoEvidence) => prop_assert!(weights.iter().all(|w| *w == 0.0)),
        }
    }

    /// Usable weights are always a belief, and nothing else is.
    //= decide.INV-2
    #[test]
    fn weights_are_beliefs(weights in [weight(), weight(), weight()]) {
        let belief = Belief::from_weights(&weights);
        prop_assert!(law::only_weights_are_beliefs(&weights, belief.is_ok()));
        prop_assert_eq!(belief.is_ok(), weights.iter().any(|weight| *weight > 0.0));
        if let Ok(belief) = belief {
            let total: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
            for (state, weight) in weights.iter().enumerate() {
                let exact = f64::from(*weight) / total;
                let found = f64::from(belief.probability(state));
                prop_assert!((found - exact).abs() <= 12.0 / f64::from(ONE));
            }
        }
    }

    /// Updates, predictions and floors of three states, again and again.
    //= decide.INV-1
    #[test]
    fn filtering_stays_on_the_simplex(
        start in [0.01_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0],
        steps in prop::collection::vec([likelihood(), likelihood(), likelihood()], 1..40),
        leave in 0.0_f32..0.5,
        floor in 0.0_f32..=0.33,
    ) {
        let rows = [
            [1.0 - leave, leave, 0.0],
            [leave / 2.0, 1.0 - leave, leave / 2.0],
            [0.0, leave, 1.0 - leave],
        ];
        let transition = TransitionMatrix::new(&rows).expect("stochastic");
        let mut belief = Belief::from_weights(&start).expect("weights");
        for step in &steps {
            let predicted = belief.predicted(&transition);
            prop_assert!(law::on_simplex(predicted.parts(), ONE));
            let updated = predicted.updated(step).expect("evidence");
            prop_assert!(law::on_simplex(updated.parts(), ONE));
            belief = updated.floored(floor).expect("a floor");
            prop_assert!(law::on_simplex(belief.parts(), ONE));
            let least = (floor * ONE as f32) as u32;
            prop_assert!(belief.parts().iter().all(|part| *part >= least));
        }
    }

    //= decide.INV-3
    #[test]
    fn without_a_belief_the_safest(first in any_f32(), second in any_f32(), prior in belief()) {
        let posterior = prior.updated(&[first, second]);
        for (table, actions) in [(LossTable::TABLE_2, 2), (LossTable::TEXT, 2)] {
            let action = table.respond(&posterior);
            prop_assert!(law::no_belief_is_safest(posterior.is_ok(), action, actions));
        }
    }

    //= decide.INV-4
    #[test]
    fn odds_are_multiplied(prior in belief(), l in [likelihood(), likelihood()]) {
        if let Ok(posterior) = prior.updated(&l) {
            let both = |belief: &Belief<2>| [0, 1].map(|i| f64::from(belief.probability(i)));
            let error = f64::from(ROUNDING) / f64::from(ONE);
            prop_assert!(law::odds_law(both(&posterior), l.map(f64::from), both(&prior), error));
            let reference = law::e21(&l.map(f64::from), &both(&prior)).expect("a posterior");
            prop_assert!((both(&posterior)[0] - reference[0]).abs() <= error);
        }
    }

    /// Likelihoods that are the same leave the belief as it is.
    //= decide.INV-4
    #[test]
    fn no_news_changes_nothing(prior in belief(), l in likelihood()) {
        let posterior = prior.updated(&[l, l]).expect("evidence");
        prop_assert!(posterior.parts()[0].abs_diff(prior.parts()[0]) <= ROUNDING);
        let both = |belief: &Belief<2>| [0, 1].map(|i| f64::from(belief.probability(i)));
        let error = f64::from(ROUNDING) / f64::from(ONE);
        prop_assert!(law::odds_law(both(&posterior), [1.0; 2], both(&prior), error));
    }

    //= decide.INV-5
    #[test]
    fn favour_makes_probable(
        prior in belief(), l in [likelihood(), likelihood()], more in 1.0_f32..10.0,
    ) {
        let less = prior.updated(&l).expect("evidence");
        let favoured = prior.updated(&[l[0] * more, l[1] / more]).expect("evidence");
        let (less, more) = (less.parts()[0], favoured.parts()[0]);
        prop_assert!(law::monotone_in_the_ratio(less, more, ROUNDING));
    }

    //= decide.INV-6
    #[test]
    fn only_stochastic_matrices(rows in [[any_f32(), any_f32()], [any_f32(), any_f32()]]) {
        let matrix = TransitionMatrix::new(&rows);
        for row in &rows {
            prop_assert!(law::only_stochastic_is_accepted(row, matrix.is_ok()));
        }
        match matrix {
            Ok(_) => {}
            Err(NotStochastic::Entry { from, to, value }) => {
                prop_assert_eq!(rows[from][to].to_bits(), value.to_bits());
                prop_assert!(!(0.0..=1.0).contains(&value));
            }
            Err(NotStochastic::Row { from, sum }) => {
                prop_assert_eq!(rows[from][0] + rows[from][1], sum);
            }
        }
    }

    /// Good matrices are taken, and their rows predict.
    //= decide.INV-6
    #[test]
    fn stochastic_matrices(vanish in 0.0_f32..=1.0, appear in 0.0_f32..=1.0, belief in belief()) {
        let rows = [[1.0 - vanish, vanish], [appear, 1.0 - appear]];
        let matrix = TransitionMatrix::new(&rows);
        for row in &rows {
            prop_assert!(law::only_stochastic_is_accepted(row, matrix.is_ok()));
        }
        let matrix = matrix.expect("stochastic");
        let before = [0, 1].map(|i| f64::from(belief.probability(i)));
        let exact = law::e16(&before, &rows.map(|row| row.map(f64::from).to_vec()));
        let found = belief.predicted(&matrix);
        prop_assert!((f64::from(found.probability(0)) - exact[0]).abs() < 1e-6);
        let row = matrix.row(0).expect("a row");
        prop_assert!((row.probability(1) - vanish).abs() < 1e-6);
        prop_assert!(matrix.row(2).is_none());
    }

    //= decide.INV-7
    #[test]
    fn expected_losses_are_between(
        losses in [[seconds(), seconds()], [seconds(), seconds()]], belief in belief(),
    ) {
        let table = LossTable::with_dominated(&losses).expect("losses");
        let rows = table.milliseconds();
        for (row, expected) in rows.iter().zip(table.expected(&belief)) {
            prop_assert!(law::between_losses(row, expected, ONE));
        }
    }

    /// Between the two distances the losses lie between those of the two tables.
    //= decide.INV-7
    #[test]
    fn losses_at_a_distance_are_between(
        far in [seconds(), seconds()], near in [seconds(), seconds()],
        distance in between(0.0, 3.0), least in 0.0_f32..1.0, span in 0.02_f32..3.0,
    ) {
        let [far, near] = [far, near].map(|row| LossTable::with_dominated(&[row]).expect("losses"));
        let loss = DistanceLoss::with_dominated(far, metres(least + span), near, metres(least))
            .expect("distances");
        let at = loss.at(metres(distance));
        for state in 0..2 {
            let ends = [far, near].map(|table| table.milliseconds()[0][state]);
            prop_assert!(law::between_losses(&ends, at.milliseconds()[0][state].into(), 1));
        }
        if distance >= least + span + 0.001 {
            prop_assert_eq!(at, far);
        }
        if distance <= least - 0.001 {
            prop_assert_eq!(at, near);
        }
    }

    //= decide.INV-8
    #[test]
    fn ties_go_to_the_safest(losses in [-5_i64..5, -5..5, -5..5, -5..5], tie in 0_i64..3) {
        let chosen = decide::safest_of_the_least(&losses, tie);
        prop_assert!(law::safest_of_the_best(&losses, tie, chosen));
    }

    /// The reference chooses the same, wherever rounding cannot matter.
    //= decide.INV-8
    #[test]
    fn the_reference_chooses_the_same(
        losses in [[seconds(), seconds()], [seconds(), seconds()], [seconds(), seconds()]],
        belief in belief(),
    ) {
        let table = LossTable::with_dominated(&losses).expect("losses");
        let rows: Vec<Vec<f64>> = losses.iter().map(|row| row.map(f64::from).to_vec()).collect();
        let posterior = [0, 1].map(|i| f64::from(belief.probability(i)));
        let expected = law::e22(&rows, &posterior);
        let chosen = table.choose(&belief);
        prop_assert!(law::safest_of_the_best(&table.expected(&belief), i64::MAX, 2));
        let reference = law::choose(&rows, Some(&posterior));
        let spread: f64 = rows.iter().flatten().copied().fold(0.0, f64::max);
        let off = expected[chosen] - expected[reference];
        prop_assert!(off <= 1e-5 * (1.0 + spread), "{off}");
    }

    //= decide.INV-9
    #[test]
    fn table_2_never_stops(belief in belief()) {
        let [maneuver, stop] = LossTable::TABLE_2.expected(&belief);
        let chosen = LossTable::TABLE_2.choose(&belief);
        prop_assert!(law::table_2_never_stops(maneuver, stop, chosen, ONE));
        // With the text's losses, only where an obstacle is certain.
        let certain = belief.parts()[1] <= ROUNDING;
        prop_assert_eq!(LossTable::TEXT.choose(&belief) == 1, certain);
    }

    //= decide.INV-10
    #[test]
    fn units_and_constants_do_not_matter(
        losses in [[0_u16.., 0_u16..], [0_u16.., 0_u16..], [0_u16.., 0_u16..]],
        scale in 1_u16..100, constants in [0_u16.., 0_u16..], belief in belief(),
    ) {
        let table = |f: &dyn Fn(u16, usize) -> u32| {
            let row = |row: [u16; 2]| [0, 1].map(|state| f(row[state], state) as f32 / 1000.0);
            LossTable::with_dominated(&losses.map(row)).expect("losses")
        };
        let plain = table(&|loss, _| loss.into());
        let other = table(&|loss, state| {
            u32::from(loss) * u32::from(scale) + u32::from(constants[state])
        });
        prop_assert!(law::same_choice(plain.choose(&belief), other.choose(&belief)));
    }

    //= decide.INV-11
    #[test]
    fn dominated_actions_are_refused(losses in [[seconds(), seconds()], [seconds(), seconds()]]) {
        let whole = LossTable::with_dominated(&losses).expect("losses");
        match LossTable::new(&losses) {
            Ok(table) => prop_assert!(law::nothing_dominated(table.milliseconds())),
            Err(BadLoss::Dominated(Dominated { action, by })) => {
                prop_assert!(!law::nothing_dominated(whole.milliseconds()));
                let rows = whole.milliseconds();
                prop_assert!((0..2).all(|state| rows[by][state] <= rows[action][state]));
            }
            Err(other) => prop_assert!(false, "{other}"),
        }
    }

    /// Other distances than the presets'.
    //= decide.INV-12
    #[test]
    fn nearer_is_never_bolder_elsewhere(
        least in 0.1_f32..1.0, span in 0.1_f32..2.0, near in 0.0_f32..3.0, farther in 0.0_f32..1.0,
        p in 0.0_f32..=1.0, more in 0.0_f32..=1.0,
    ) {
        let table = |rows: &[[f32; 2]; 3]| LossTable::with_dominated(rows).expect("losses");
        let far_loss = table(&Parameters::USUAL.far_loss);
        let near_loss = table(&Parameters::USUAL.near_loss);
        let loss = DistanceLoss::new(far_loss, metres(least + span), near_loss, metres(least))
            .expect("losses");
        let belief = |p: f32| Belief::from_weights(&[p, 1.0 - p]).expect("weights");
        let choice = |distance: f32, p: f32| loss.at(metres(distance)).choose(&belief(p));
        prop_assert!(law::no_bolder(choice(near + farther, p), choice(near, p)));
        let probable = p + more * (1.0 - p);
        prop_assert!(law::no_bolder(choice(near, p), choice(near, probable)));
    }

    //= decide.INV-13
    #[test]
    fn decisions_never_move(speed in any_f32(), turn_rate in any_f32(), which in 0..3_usize) {
        let response = [Response::Continue, Response::Maneuver, Response::Stop][which];
        let (given, overruled) = decide::overruled(Advice { speed, turn_rate }, response);
        let stop = response == Response::Stop;
        let bits = [given.speed, given.turn_rate];
        prop_assert!(law::never_into_motion(stop, [speed, turn_rate], bits));
        prop_assert_eq!(overruled, stop && speed > 0.0);
    }
}

/// Every belief in two states that there is: the theorem about the published rule, on the code.
//= decide.INV-9 (every input)
#[test]
fn table_2_never_stops_whatever_is_believed() {
    for first in 0..=ONE {
        let belief = Belief::from_parts([first, ONE - first]).expect("parts of one");
        let [maneuver, stop] = LossTable::TABLE_2.expected(&belief);
        let chosen = LossTable::TABLE_2.choose(&belief);
        assert!(law::table_2_never_stops(maneuver, stop, chosen, ONE));
    }
    assert_eq!(Belief::from_parts([1, ONE]), None);
}

/// Every distance in millimetres up to 2 m, 257 probabilities.
//= decide.INV-12
#[test]
fn nearer_is_never_bolder() {
    let settings = usual();
    let beliefs: Vec<Belief<2>> = (0..=256_u16)
        .map(|k| Belief::from_weights(&[f32::from(k), f32::from(256 - k)]).expect("weights"))
        .collect();
    let response = |mm: u16, belief: &Belief<2>| {
        settings.respond(belief, metres(f32::from(mm) / 1000.0)) as usize
    };
    for mm in 0..2_000 {
        for pair in beliefs.windows(2) {
            let here = response(mm, &pair[0]);
            assert!(law::no_bolder(response(mm + 1, &pair[0]), here), "{mm} mm");
            assert!(law::no_bolder(here, response(mm, &pair[1])), "{mm} mm");
        }
    }
}

/// What the chapter says of the usual losses.
#[test]
fn usual_losses_are_as_described() {
    let settings = usual();
    let respond = |p: f32, distance: f32| {
        let belief = Belief::from_weights(&[p, 1.0 - p]).expect("weights");
        settings.respond(&belief, metres(distance))
    };
    assert_eq!(respond(0.49, 1.2), Response::Continue);
    assert_eq!(respond(0.51, 1.2), Response::Maneuver);
    assert_eq!(respond(0.12, 0.4), Response::Continue);
    assert_eq!(respond(0.135, 0.4), Response::Maneuver);
    assert_eq!(respond(1.0, 0.55), Response::Maneuver);
    assert_eq!(respond(1.0, 0.53), Response::Stop);
    // A doubtful echo is heeded at no distance.
    assert_eq!(respond(Parameters::USUAL.newcomer, 0.0), Response::Continue);
}

/// Each parameter is refused by name, and so are losses that make an action pointless.
#[test]
fn settings_are_checked() {
    let config = table_1();
    let refused = |change: &dyn Fn(&mut Parameters)| {
        let mut parameters = Parameters::USUAL;
        change(&mut parameters);
        Settings::new(parameters, &config)
            .expect_err("refused")
            .to_string()
    };
    for (name, change) in [
        (
            "sonar.miss",
            &(|p: &mut Parameters| p.sonar.miss = 0.0) as &dyn Fn(&mut Parameters),
        ),
        ("sonar.false_echo", &|p| p.sonar.false_echo = f32::NAN),
        ("sonar.false_range", &|p| p.sonar.false_range = 0.1),
        ("camera.detection", &|p| p.camera.detection = 1.0),
        ("camera.false_alarm", &|p| p.camera.false_alarm = -0.1),
        ("newcomer", &|p| p.newcomer = 0.0),
        ("appear", &|p| p.appear = 0.6),
        ("vanish", &|p| p.vanish = f32::INFINITY),
        ("floor", &|p| p.floor = 0.2),
        ("sonar_period", &|p| p.sonar_period = 0),
        ("vision_period", &|p| p.vision_period = 9_000),
        ("control_period", &|p| p.control_period = 1),
        ("loss of action 1 in state 0 is NaN", &|p| {
            p.far_loss[1][0] = f32::NAN
        }),
    ] {
        let message = refused(change);
        assert!(message.contains(name), "{message:?} does not name {name}");
    }
    let message = refused(&|p| p.near_loss[2] = [6.5, 10.0]);
    assert!(
        message.contains("action 2 is dominated: action 1"),
        "{message}"
    );
    assert!(matches!(
        Settings::new(
            Parameters {
                near_loss: [[40.0, 0.0], [6.0, 5.0], [7.0, 10.0]],
                ..Parameters::USUAL
            },
            &config,
        ),
        Err(BadSettings::Loss(BadLoss::Dominated(Dominated {
            action: 2,
            by: 1
        })))
    ));
    // As good in one state and better in another is enough.
    let table = LossTable::with_dominated(&[[1.0, 2.0], [1.0, 1.0]]).expect("losses");
    assert_eq!(table.dominated(), Some(Dominated { action: 0, by: 1 }));
    // So is as good in every state, and safer.
    let table = LossTable::with_dominated(&[[1.0, 2.0], [1.0, 2.0]]).expect("losses");
    assert_eq!(table.dominated(), Some(Dominated { action: 0, by: 1 }));
    let same = |far: f32, near: f32| {
        let table = LossTable::TABLE_2;
        DistanceLoss::with_dominated(table, metres(far), table, metres(near))
    };
    assert!(same(1.0, 0.5).is_ok());
    assert!(matches!(same(0.5, 0.5), Err(BadLoss::Distance(_))));
    assert!(Belief::<2>::even().floored(0.6).is_err());
    assert!(Belief::<2>::even().floored(f32::NAN).is_err());
}

/// However much all losses have in common, a tenth of a millisecond tells actions apart.
//= decide.INV-10
#[test]
fn what_all_losses_have_in_common_makes_no_tie() {
    let probable = ONE / 20 * 11;
    let belief = Belief::from_parts([probable, ONE - probable]).expect("a belief");
    let choices = [0.0, 10.0, 100.0].map(|common| {
        let more = common + 0.001;
        let table = LossTable::with_dominated(&[[common, more], [more, common]]).expect("losses");
        table.choose(&belief)
    });
    assert!(
        choices
            .iter()
            .all(|choice| law::same_choice(*choice, choices[0]))
    );
    assert_eq!(choices[0], 0);
}

/// The three things that a sonar can say, in the rates of its model.
#[test]
fn sonars_hear_as_modelled() {
    let sonar = SonarModel {
        miss: 0.2,
        false_echo: 0.1,
        false_range: 2.0,
    };
    let [there, chance] = sonar.likelihood(Hearing::There, 0.2);
    assert!((chance - 0.02).abs() < 1e-6 && (there - (0.72 + 0.02)).abs() < 1e-6);
    assert_eq!(sonar.likelihood(Hearing::Past, 0.2), [0.2, 0.9]);
    for hearing in [Hearing::Beside, Hearing::Nothing] {
        assert_eq!(sonar.likelihood(hearing, 0.2), [1.0, 1.0]);
    }
    let camera = CameraModel {
        detection: 0.75,
        false_alarm: 0.125,
    };
    assert_eq!(camera.likelihood(true), [0.75, 0.125]);
    assert_eq!(camera.likelihood(false), [0.25, 0.875]);
}

/// What rounding loses goes to the most probable state, wherever that is.
#[test]
fn roundings_go_to_the_most_probable() {
    const { assert!(!ONE.is_multiple_of(6), "something is lost") };
    for greatest in 0..3 {
        let mut weights = [1.0; 3];
        weights[greatest] = 4.0;
        let belief = Belief::from_weights(&weights).expect("weights");
        let parts = belief.parts();
        assert_eq!(parts.iter().sum::<u32>(), ONE);
        for (state, part) in parts.iter().enumerate() {
            assert_eq!(state != greatest, *part == ONE / 6, "{belief:?}");
        }
    }
    let third = ONE / 3;
    assert_eq!(Belief::<3>::even().parts(), &[third + 1, third, third]);
}

// --------------------------------------------------------------------- the law

/// Advises what it is told to, and notes what it is shown.
#[derive(Clone, Debug)]
struct Told<const N: usize> {
    advice: Advice,
    shown: Option<View<N>>,
}

impl<const N: usize> Law<N> for Told<N> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        self.shown = Some(*view);
        self.advice
    }

    fn mode(&self) -> &'static str {
        "told"
    }
}

const AHEAD: Advice = Advice {
    speed: 0.3,
    turn_rate: 0.1,
};

fn deciding<const N: usize>(advice: Advice) -> (Decide<Told<N>, N>, Config) {
    deciding_by(Parameters::USUAL, advice)
}

fn deciding_by<const N: usize>(
    parameters: Parameters,
    advice: Advice,
) -> (Decide<Told<N>, N>, Config) {
    let (config, ring) = pioneer_with::<N>();
    let settings = Settings::new(parameters, &config).expect("in range");
    let told = Told {
        advice,
        shown: None,
    };
    (Decide::new(told, config, ring, settings), config)
}

proptest! {
    #![proptest_config(common::cases(300))]

    /// Any views one after the other, with pauses and readings that go stale.
    //= decide.INV-13
    //= decide.INV-14
    //= decide.INV-15
    #[test]
    fn the_law_round_a_law(
        views in prop::collection::vec((view::<3>(), 0..400_u64, 0..4_u8), 1..20),
        speed in any_f32(), turn_rate in any_f32(),
    ) {
        let advice = Advice { speed, turn_rate };
        let (mut decide, _) = deciding::<3>(advice);
        let control = Parameters::USUAL.control_period;
        let (mut now, mut evidence) = (0, None);
        for (mut view, pause, stale) in views {
            now += pause;
            view.now = Instant(now);
            if stale == 0 {
                view.sonar = [SonarReading::Stale; 3];
            }
            let given = decide.advise(&view);
            let verdict = *decide.verdict();
            let stop = verdict.response == Response::Stop;
            let bits = [given.speed, given.turn_rate];
            prop_assert!(law::never_into_motion(stop, [speed, turn_rate], bits));
            let shown = decide.law().shown.expect("the law was asked");
            let without = |view: View<3>| View { obstacle: None, ..view };
            prop_assert!(law::only_the_obstacle_differs(&without(view), &without(shown)));
            if stale != 0 && !view.sonar.iter().all(|reading| {
                matches!(reading, SonarReading::Stale | SonarReading::Invalid)
            }) {
                // There may be evidence: whether it is new is the law's business.
                evidence = evidence.max(Some(now));
            }
            let silent = evidence.map_or(u64::MAX, |at| now - at);
            prop_assert!(law::blind_is_stop(silent, control, stop));
        }
    }

    /// S1's law with the decision round it advises within the limits, and nothing with a guard.
    //= decide.INV-13
    #[test]
    fn advice_stays_within_limits(views in prop::collection::vec(view::<3>(), 1..20)) {
        let (config, ring) = pioneer_with::<3>();
        let settings = Settings::usual(&config).expect("usual");
        let mut decide = Decide::new(Avoid::new(config), config, ring, settings);
        for (tick, view) in views.into_iter().enumerate() {
            let guard = (tick % 3 == 2).then_some(StopReason::Operator);
            let view = View { now: Instant(100 * tick as u64), guard, ..view };
            let advice = decide.advise(&view);
            prop_assert!(motion::advice_in_range(
                advice.speed, advice.turn_rate, config.speed_max, config.turn_rate_max
            ));
            prop_assert!(motion::stop_dominates(view.guard.is_some(), advice.speed == 0.0));
            prop_assert!(!Law::<3>::mode(&decide).is_empty());
            let stop = decide.verdict().response == Response::Stop;
            let given = [advice.speed, advice.turn_rate];
            prop_assert!(!stop || law::never_into_motion(true, [0.0, given[1]], given));
        }
    }
}

/// The Pioneer preset where what appears has to be heard twice.
fn twice() -> Config {
    Config::new(config::Parameters {
        appear_samples: 2.0,
        ..*common::pioneer().parameters()
    })
    .expect("in range")
}

/// What is handed on of one sonar's reading at a time.
fn handed_on(look: &mut SecondLook<1>, range: f32, at: u64, config: &Config) -> (f32, u64) {
    let judged = look.judged(&common::in_order(at, [range]), config);
    let sample = judged.sonar[0].expect("a reading");
    (sample.range, sample.taken_at.0)
}

proptest! {
    #![proptest_config(common::cases(500))]

    /// A thing that comes and goes among false echoes and lost ones, with bits of any kind between.
    //= decide.INV-16
    //= decide.INV-17
    //= decide.INV-18
    #[test]
    fn what_appears_is_heard_twice(
        readings in prop::collection::vec(
            (prop_oneof![4 => 0.0_f32..6.0, 1 => any_f32()], 1..400_u64, 0..4_u8), 2..40,
        ),
    ) {
        let config = twice();
        let closing = f64::from(config.obstacle_speed_max) + f64::from(config.speed_max);
        let mut look = SecondLook::default();
        let (mut now, mut before, mut in_a_row) = (1_000, None, 0);
        // The last echo that was handed on.
        let mut echo: Option<(f32, u64)> = None;
        for (range, gap, again) in readings {
            now += gap;
            let handed = handed_on(&mut look, range, now, &config);
            prop_assert!(law::latest_or_before(handed, (range, now), before));
            let counts = handed.1 == now;
            in_a_row = if counts { 0 } else { in_a_row + 1 };
            prop_assert!(law::withheld_at_most_twice(in_a_row));
            if let Some((last, at)) = echo.filter(|(_, at)| now - at <= 1_000) {
                prop_assert!(
                    law::explained_counts_at_once(range, last, now - at, closing, counts),
                    "{range} m after {last} m"
                );
            }
            if again == 0 && range.is_finite() {
                let again = handed_on(&mut look, range, now, &config);
                prop_assert!(law::latest_or_before(again, handed, None));
            }
            if counts {
                echo = if range < config.sonar_range_max { Some((range, now)) } else { echo };
            }
            before = Some(handed);
        }
    }
}

/// One false echo is not handed on, and what was heard before grows old; a thing is handed on at its
/// second look, or the third if a false echo comes between. Who is followed counts at once, after a lost
/// echo too; and with one sample everything does.
#[test]
fn what_appears_is_looked_at_again() {
    let config = twice();
    let through = |ranges: &[f32], config: &Config| {
        let mut look = SecondLook::default();
        let mut at = 0;
        let mut step = |range: &f32| {
            at += 100;
            handed_on(&mut look, *range, at, config)
        };
        ranges.iter().map(&mut step).collect::<Vec<_>>()
    };
    let times = |ranges: &[f32]| {
        let handed = through(ranges, &config);
        handed.into_iter().map(|(_, at)| at).collect::<Vec<_>>()
    };
    assert_eq!(through(&[4.0, 1.0], &config), [(4.0, 100), (4.0, 100)]);
    assert_eq!(times(&[4.0, 1.0, 4.0]), [100, 100, 300]);
    // What is no range is not for it to judge.
    assert_eq!(times(&[4.0, 0.0, 4.0]), [100, 200, 300]);
    assert_eq!(times(&[4.0, 1.0, 0.95]), [100, 100, 300]);
    assert_eq!(times(&[4.0, 1.0, 2.0, 0.9]), [100, 100, 100, 400]);
    assert_eq!(times(&[1.0, 0.9, 5.0, 0.7, 0.6]), [100, 200, 300, 400, 500]);
    // What was taken no later than what was handed on is not new, and is not judged.
    let mut look = SecondLook::default();
    assert_eq!(handed_on(&mut look, 4.0, 100, &config), (4.0, 100));
    assert_eq!(handed_on(&mut look, 1.0, 100, &config), (1.0, 100));
    let once = common::pioneer();
    assert_eq!(through(&[4.0, 1.0], &once), [(4.0, 100), (1.0, 200)]);
}

/// A view of three sonars, the middle one of which looks ahead and reads this.
fn looking_at(reading: SonarReading, t: u64) -> View<3> {
    let (config, ring) = pioneer_with::<3>();
    let silent = SonarReading::NoEcho(metres(config.sonar_range_max));
    let free = common::in_order(1_000, [5.0; 3]);
    let view = Memory::default().update(&free, [5.0, 0.0].into(), &ring, &config);
    let mut view = view.expect("odometry");
    view.now = Instant(t);
    view.sonar = [silent; 3];
    view.sonar[ahead()] = reading;
    view.obstacle = None;
    view.guard = None;
    view
}

/// The sonar that looks most nearly straight ahead.
fn ahead() -> usize {
    common::sonar_towards(&pioneer_with::<3>().1, 0.0)
}

/// One false echo is not shown to the law; a thing is, from its second look on, and is held when it is
/// not heard for a moment.
#[test]
fn one_echo_is_doubted_and_two_are_believed() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    let silent = SonarReading::NoEcho(metres(5.0));
    let echo = SonarReading::Echo(metres(1.0));
    let mut shown = |reading, t| {
        decide.advise(&looking_at(reading, t));
        let law = decide.law().shown.expect("the law was asked");
        (law.obstacle.is_some(), *decide.verdict())
    };
    assert!(!shown(silent, 0).0);
    let (seen, verdict) = shown(echo, 100);
    assert!(
        !seen && verdict.doubted.is_some_and(|p| p < 0.2),
        "{verdict:?}"
    );
    assert!(!shown(silent, 200).0);
    assert!(!shown(silent, 300).0);
    assert!(!shown(echo, 1_000).0, "the next false echo");
    let (seen, verdict) = shown(SonarReading::Echo(metres(0.98)), 1_100);
    assert!(
        seen && verdict.response == Response::Maneuver,
        "{verdict:?}"
    );
    assert!(shown(silent, 1_200).0, "held");
}

/// A thing that stands close ahead is stopped for; turning stays allowed, and once the robot looks
/// past it the law's advice is passed on.
#[test]
fn what_is_close_ahead_is_stopped_for() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    let mut last = Advice::REST;
    for tick in 0..10 {
        let range = metres(0.45 + 0.001 * (tick % 2) as f32);
        last = decide.advise(&looking_at(SonarReading::Echo(range), 100 * tick));
    }
    assert_eq!(decide.verdict().response, Response::Stop);
    assert_eq!((last.speed, last.turn_rate), (0.0, 0.1));
    assert_eq!(Law::<3>::mode(&decide), "decided to stop");
    let mut away = looking_at(SonarReading::NoEcho(metres(5.0)), 1_000);
    away.pose.heading = Angle::radians(1.5).expect("an angle");
    let advice = decide.advise(&away);
    assert_eq!(advice.speed, AHEAD.speed, "{:?}", decide.verdict());
}

/// What is close and to the side of the way is stopped for as long as the robot's width would touch it.
#[test]
fn what_the_robot_would_touch_is_stopped_for() {
    let (_, ring) = pioneer_with::<3>();
    let response = |sonar: usize, range: f32| {
        let (mut decide, _) = deciding::<3>(AHEAD);
        for tick in 0..10 {
            let mut view = looking_at(SonarReading::NoEcho(metres(5.0)), 100 * tick);
            view.sonar[sonar] = SonarReading::Echo(metres(range + 0.001 * (tick % 2) as f32));
            decide.advise(&view);
        }
        decide.verdict().response
    };
    for sonar in (0..3).filter(|sonar| *sonar != ahead()) {
        let at = &ring.sonars()[sonar];
        // Robot and margin reach 0.55 m to the side.
        let aside = |range: f32| (at.position.y + at.axis.y * range).abs();
        let near = 0.25;
        assert!((0.1..0.5).contains(&aside(near)), "{}", aside(near));
        assert_eq!(response(sonar, near), Response::Stop, "{}", aside(near));
    }
}

/// A place that the robot has left far behind is forgotten: an echo from there is a first one again.
#[test]
fn what_is_far_behind_is_forgotten() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    let echo = SonarReading::Echo(metres(1.0));
    let silent = SonarReading::NoEcho(metres(5.0));
    let mut shown = |reading, t, x: f32| {
        let mut view = looking_at(reading, t);
        view.pose.position = Vector2::new(x, 0.0);
        decide.advise(&view);
        let law = decide.law().shown.expect("the law was asked");
        law.obstacle.is_some()
    };
    assert!(!shown(echo, 100, 0.0));
    assert!(!shown(silent, 200, -10.0));
    assert!(!shown(echo, 300, 0.0), "forgotten");
    assert!(shown(SonarReading::Echo(metres(1.001)), 400, 0.0));
}

/// A reading that stands is the same evidence until a sonar period has passed.
#[test]
fn a_reading_that_stands_counts_once() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    let echo = SonarReading::Echo(metres(1.0));
    for t in [0, 20, 40, 60, 80] {
        decide.advise(&looking_at(echo, t));
        let shown = decide.law().shown.expect("the law was asked");
        assert!(shown.obstacle.is_none(), "at {t} ms");
    }
    decide.advise(&looking_at(echo, 100));
    let shown = decide.law().shown.expect("the law was asked");
    assert!(shown.obstacle.is_some());
}

/// A camera that detects somebody where a first echo came from settles it; a look that is too old, or
/// elsewhere, does not.
#[test]
fn a_camera_confirms() {
    let echo = SonarReading::Echo(metres(0.9));
    let bearing = |radians| Some(Angle::radians(radians).expect("an angle"));
    let (_, ring) = pioneer_with::<3>();
    let at = ring.sonars()[ahead()].heading.get();
    for (detected, taken_at, believed) in [
        (bearing(at), 900, true),
        (bearing(at + 0.25), 900, true),
        (bearing(at + 0.27), 900, false),
        (bearing(at), 500, true),
        (bearing(at), 499, false),
        (bearing(at + 1.0), 900, false),
        (None, 900, false),
    ] {
        let (mut decide, _) = deciding::<3>(AHEAD);
        decide.advise(&looking_at(SonarReading::NoEcho(metres(5.0)), 900));
        decide.see(CameraLook {
            detected,
            taken_at: Instant(taken_at),
        });
        decide.advise(&looking_at(echo, 1_000));
        let shown = decide.law().shown.expect("the law was asked");
        assert_eq!(
            shown.obstacle.is_some(),
            believed,
            "{detected:?} at {taken_at}"
        );
    }
}

/// An echo from farther off than the thing can have come in the meantime is another thing's first.
#[test]
fn a_leap_is_another_thing() {
    let shown = |second: f32| {
        let (mut decide, _) = deciding::<3>(AHEAD);
        for (tick, range) in [(0, 1.0), (1, second)] {
            let echo = SonarReading::Echo(metres(range));
            decide.advise(&looking_at(echo, 1_000 + 100 * tick));
        }
        let law = decide.law().shown.expect("the law was asked");
        law.obstacle.is_some()
    };
    // 0.15 m of scatter and 0.08 m at 0.8 m/s.
    assert!(shown(0.8));
    assert!(!shown(0.75));
    assert!(!shown(0.5));
}

/// A camera that sees nobody where an echo came from makes it less probable.
#[test]
fn a_camera_refutes() {
    let doubted = |look: bool| {
        let (mut decide, _) = deciding::<3>(AHEAD);
        decide.advise(&looking_at(SonarReading::Echo(metres(1.0)), 1_000));
        if look {
            decide.see(CameraLook {
                detected: None,
                taken_at: Instant(1_000),
            });
        }
        decide.advise(&looking_at(SonarReading::Echo(metres(1.0)), 1_020));
        decide.verdict().doubted.expect("a first echo")
    };
    assert!(doubted(true) < doubted(false) / 2.0);
}

// ------------------------------------------------------- places, and what is believed of them

/// One tick: what one sonar alone says, with the robot turned by `heading` and `x` metres on.
fn verdict_on(
    decide: &mut Decide<Told<3>, 3>,
    reading: SonarReading,
    (heading, x): (f32, f32),
    t: u64,
) -> decide::Verdict {
    let mut view = looking_at(reading, t);
    view.sonar = [SonarReading::Stale; 3];
    view.sonar[ahead()] = reading;
    view.pose.heading = Angle::radians(heading).expect("an angle");
    view.pose.position = Vector2::new(x, 0.0);
    decide.advise(&view);
    *decide.verdict()
}

fn echo(range: f32) -> SonarReading {
    SonarReading::Echo(metres(range))
}

/// With sonars that are often wrong, so that a second echo is doubted as the first is, and says by the
/// probability which place it was taken to come from: 0.03 for a new one, some 0.14 for one heard before.
fn doubting() -> Decide<Told<3>, 3> {
    let parameters = Parameters {
        sonar: SonarModel {
            miss: 0.5,
            false_echo: 0.5,
            false_range: 2.5,
        },
        newcomer: 0.03,
        ..Parameters::USUAL
    };
    deciding_by(parameters, AHEAD).0
}

const NEW: std::ops::Range<f32> = 0.029..0.031;
const AGAIN: std::ops::Range<f32> = 0.08..0.2;

/// Plays echoes (heading, range) every 40 ms, which is too soon for a belief to fade, and returns what is
/// doubted in each tick.
fn doubts(decide: &mut Decide<Told<3>, 3>, echoes: &[(f32, f32)]) -> Vec<Option<f32>> {
    let mut t = 0;
    let mut tick = |(heading, range): &(f32, f32)| {
        t += 40;
        verdict_on(decide, echo(*range), (*heading, 0.0), t).doubted
    };
    echoes.iter().map(&mut tick).collect()
}

fn is(doubt: Option<f32>, of: &std::ops::Range<f32>) -> bool {
    doubt.is_some_and(|doubt| of.contains(&doubt))
}

proptest! {
    #![proptest_config(common::cases(500))]

    /// The belief in one place is that of the filter, in `f64`: prediction by sonar periods, the likelihood
    /// of an echo from there, of one from behind, and of a camera's look, and the floor.
    //= decide.INV-4
    #[test]
    fn the_belief_in_a_place_is_the_filters(
        steps in prop::collection::vec(
            (prop_oneof![6 => 100_u64..400, 1 => 400_u64..6_000], 0..4_u8, -0.1_f32..0.1, 0..6_u8),
            1..30,
        ),
    ) {
        let (mut decide, config) = deciding::<3>(AHEAD);
        let Parameters { sonar, camera, newcomer, appear, vanish, floor, .. } = Parameters::USUAL;
        let [appear, vanish, floor] = [appear, vanish, floor].map(f64::from);
        let transition = [vec![1.0 - vanish, vanish], vec![appear, 1.0 - appear]];
        let observed = |belief: f64, likelihood: [f32; 2]| {
            let posterior = law::e21(&likelihood.map(f64::from), &[belief, 1.0 - belief]);
            posterior.expect("evidence")[0] * (1.0 - 2.0 * floor) + floor
        };
        // Its probability, range, and when it was heard.
        let mut place: Option<(f64, f32, u64)> = None;
        let mut now = 0;
        for (gap, kind, off, look) in steps {
            now += gap;
            let range = place.map_or(1.0, |(_, range, _)| (range + off).clamp(0.8, 1.2));
            let heard = kind < 2;
            // Otherwise the sonar hears nothing, or the wall behind.
            let reading = match kind {
                0 | 1 => echo(range),
                2 => SonarReading::NoEcho(metres(5.0)),
                _ => echo(3.0 + off),
            };
            if let Some((belief, before, at)) = &mut place {
                for _ in 0..(gap + 50) / 100 {
                    *belief = law::e16(&[*belief, 1.0 - *belief], &transition)[0];
                }
                let age = (now - *at).min(1_000) as f32 / 1_000.0;
                let gate = (0.15 + config.obstacle_speed_max * age).min(0.4);
                let hearing = if heard { Hearing::There } else { Hearing::Past };
                *belief = observed(*belief, sonar.likelihood(hearing, gate));
                if heard {
                    (*before, *at) = (range, now);
                }
            } else if heard {
                place = Some((newcomer.into(), range, now));
            }
            if look < 2 {
                let detected = (look == 0).then_some(Angle::ZERO);
                decide.see(CameraLook { detected, taken_at: Instant(now) });
                if let Some((belief, ..)) = &mut place {
                    *belief = observed(*belief, camera.likelihood(look == 0));
                }
            }
            let verdict = verdict_on(&mut decide, reading, (0.0, 0.0), now);
            let shown = verdict.doubted.or(verdict.probability);
            prop_assert!(shown.is_some() || !heard, "{verdict:?}");
            if let (Some(shown), Some((belief, ..))) = (shown, place) {
                prop_assert!((f64::from(shown) - belief).abs() < 1e-5, "{shown} for {belief}");
            }
            place = place.filter(|(belief, ..)| *belief >= 0.02);
        }
    }
}

/// What a sonar hears beside a place that its cone does not cover is of the same thing, as probable as
/// before; farther beside it is another.
#[test]
fn what_is_heard_beside_a_place_is_the_same() {
    let turned = |heading| {
        let (mut decide, _) = deciding::<3>(AHEAD);
        verdict_on(&mut decide, echo(1.0), (0.0, 0.0), 100);
        let there = verdict_on(&mut decide, echo(1.01), (0.0, 0.0), 140);
        let beside = verdict_on(&mut decide, echo(1.0), (heading, 0.0), 180);
        (there, beside)
    };
    let (there, beside) = turned(0.3);
    assert_eq!(beside.doubted, None);
    let kept = beside.probability.zip(there.probability);
    // But for the floor, which is applied again.
    assert!(
        kept.is_some_and(|(now, before)| (now - before).abs() < 2e-3),
        "{kept:?}"
    );
    let (_, another) = turned(0.5);
    assert!(another.doubted.is_some(), "{another:?}");
}

/// What stands before a place hides it, and says nothing of it.
#[test]
fn a_hidden_place_is_as_probable_as_before() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    let [first, hiding, last] = [(1.0, 40), (0.5, 80), (1.01, 120)]
        .map(|(range, t)| verdict_on(&mut decide, echo(range), (0.0, 0.0), t));
    assert!(first.doubted.is_some() && hiding.doubted.is_some());
    assert!(
        last.doubted.is_none() && last.probability > Some(0.8),
        "{last:?}"
    );
}

/// The law round a law tells it, too, that what has stood for long does not move.
#[test]
fn the_law_is_told_what_stands() {
    for (class, speed) in [(Class::Still, 0.0), (Class::Unknown, 0.8)] {
        let (mut decide, _) = deciding::<3>(AHEAD);
        for tick in 1..3_u8 {
            let range = 1.0 + 0.001 * f32::from(tick);
            let mut view = looking_at(echo(range), 100 * u64::from(tick));
            view.hazard[ahead()].class = class;
            decide.advise(&view);
        }
        let shown = decide.law().shown.expect("the law was asked");
        let obstacle = shown.obstacle.expect("an obstacle");
        assert_eq!(obstacle.speed.value.get(), speed);
    }
}

/// An echo is that of the place which its cone covers, though another beside it is as far off as the echo.
#[test]
fn covered_places_come_first() {
    for (first, second) in [((0.0, 1.1), (0.45, 1.0)), ((0.45, 1.0), (0.0, 1.1))] {
        let doubt = doubts(&mut doubting(), &[first, second, (0.17, 1.005)]);
        assert!(is(doubt[0], &NEW) && is(doubt[1], &NEW), "{doubt:?}");
        assert!(is(doubt[2], &AGAIN), "{doubt:?}");
    }
}

/// Two places that have come together are one: the more probable. Those that are apart stay two, however
/// probable the other is.
#[test]
fn places_that_meet_are_one() {
    let meeting = [1.09, 1.17, 1.26].map(|range| (0.0, range));
    for two in [[1.3, 1.0], [1.0, 1.3]] {
        let mut decide = doubting();
        let doubt = doubts(
            &mut decide,
            &[two.map(|range| (0.0, range)).as_slice(), &meeting].concat(),
        );
        assert!(is(doubt[0], &NEW) && is(doubt[1], &NEW), "{doubt:?}");
        assert!(is(doubt[2], &AGAIN), "{doubt:?}");
        // The fourth echo from the nearer one.
        assert_eq!(doubt[4], None);
        let verdict = decide.verdict();
        assert!(verdict.probability.is_some_and(|p| p > 0.7), "{verdict:?}");
    }
    for apart in [[(0.0, 1.0), (0.6, 1.02)], [(0.6, 1.0), (0.0, 1.02)]] {
        let [often, once] = apart;
        let again = |(heading, range): (f32, f32)| (heading, range + 0.01);
        let doubt = doubts(&mut doubting(), &[often, once, again(often), again(once)]);
        assert!(is(doubt[2], &AGAIN) && is(doubt[3], &AGAIN), "{doubt:?}");
    }
}

/// A place is forgotten once the robot is too far away from it to come near it soon, not before.
#[test]
fn only_what_is_far_away_is_forgotten() {
    let (config, ring) = pioneer_with::<3>();
    let farthest = config.safe_distance + config.robot_radius + 0.8;
    let at = &ring.sonars()[ahead()];
    let place = at.position + at.axis;
    // So far back that the place is `away` metres from the robot.
    let back = |away: f32| place.x - (away * away - place.y * place.y).sqrt();
    for (away, expected) in [(farthest - 0.02, AGAIN), (farthest + 0.02, NEW)] {
        let mut decide = doubting();
        verdict_on(&mut decide, echo(1.0), (0.0, 0.0), 40);
        let silent = SonarReading::NoEcho(metres(0.5));
        verdict_on(&mut decide, silent, (0.0, back(away)), 80);
        let verdict = verdict_on(&mut decide, echo(1.0), (0.0, 0.0), 120);
        assert!(is(verdict.doubted, &expected), "{away}: {verdict:?}");
    }
}

/// Of more places than are kept in mind, sixteen, the farthest gives way to a nearer one, and is taken as
/// it is from then on: never doubted.
#[test]
fn the_nearest_places_are_kept() {
    let turned = |k: u8| 0.36 * f32::from(k);
    for farthest in [0, 5, 15] {
        let mut echoes: Vec<(f32, f32)> = (0..16)
            .map(|k| {
                (
                    turned(k),
                    if k == farthest {
                        1.6
                    } else {
                        1.5 - 0.001 * f32::from(k)
                    },
                )
            })
            .collect();
        let far = echoes[usize::from(farthest)];
        // The seventeenth, the farthest again, and one that was kept.
        let kept = echoes[8];
        echoes.extend([(turned(16), 1.2), (far.0, 1.61), (kept.0, kept.1 + 0.01)]);
        let doubt = doubts(&mut doubting(), &echoes);
        assert!(
            doubt[..17].iter().all(|doubt| is(*doubt, &NEW)),
            "{doubt:?}"
        );
        assert_eq!(doubt[17], None, "{farthest}");
        assert!(is(doubt[18], &AGAIN), "{doubt:?}");
    }
}

/// A camera that sees nobody says so of what is in its field of view only.
#[test]
fn a_camera_looks_only_ahead() {
    let doubted = |look: bool, heading: f32| {
        let mut decide = doubting();
        verdict_on(&mut decide, echo(1.0), (0.0, 0.0), 40);
        if look {
            decide.see(CameraLook {
                detected: None,
                taken_at: Instant(80),
            });
        }
        let silent = SonarReading::NoEcho(metres(0.5));
        verdict_on(&mut decide, silent, (heading, 0.0), 80);
        verdict_on(&mut decide, echo(1.01), (0.0, 0.0), 120).doubted
    };
    let half = common::pioneer().view_half_angle;
    let at = pioneer_with::<3>().1.sonars()[ahead()].heading.get();
    assert_eq!(
        doubted(true, at - half - 0.1),
        doubted(false, at - half - 0.1)
    );
    assert_eq!(
        doubted(true, at + half + 0.1),
        doubted(false, at + half + 0.1)
    );
    assert!(doubted(true, at - half + 0.1) != doubted(false, at - half + 0.1));
}

/// Evidence lasts for one control period, to the millisecond.
#[test]
fn evidence_lasts_for_a_control_period() {
    for (silent, blind) in [(220, false), (221, true)] {
        let (mut decide, _) = deciding::<3>(AHEAD);
        verdict_on(&mut decide, echo(1.0), (0.0, 0.0), 1_000);
        let mut stale = looking_at(SonarReading::Stale, 1_000 + silent);
        stale.sonar = [SonarReading::Stale; 3];
        decide.advise(&stale);
        assert_eq!(decide.verdict().blind, blind, "after {silent} ms");
    }
}

/// More places than are kept in mind: the nearest are, and what is not is taken as it is.
#[test]
fn many_places() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    for tick in 0..60_u64 {
        let mut view = looking_at(SonarReading::Echo(metres(1.5)), 100 * tick);
        view.pose.position = Vector2::new(0.0, 0.5 * tick as f32);
        decide.advise(&view);
    }
    assert!(decide.verdict().response != Response::Stop);
}

/// A clock that goes back, and one that leaps: no panic, no belief out of nowhere.
#[test]
fn clocks_that_are_wrong() {
    let (mut decide, _) = deciding::<3>(AHEAD);
    for t in [0, 100, 50, 10, u64::MAX, 0, 1_000_000] {
        let advice = decide.advise(&looking_at(SonarReading::Echo(metres(1.0)), t));
        assert!(advice.speed <= AHEAD.speed);
    }
}

/// What is no belief and no transition matrix says why, with the state and the value.
#[test]
fn errors_name_what_was_wrong() {
    let negative = Belief::from_weights(&[0.5, -1.0])
        .expect_err("negative")
        .to_string();
    assert!(negative.contains("state 1 is -1"), "{negative}");
    let nothing = Belief::from_weights(&[0.0, 0.0])
        .expect_err("nothing")
        .to_string();
    assert!(nothing.contains("all states are 0"), "{nothing}");
    let entry = TransitionMatrix::new(&[[0.5, 0.5], [1.5, -0.5]])
        .expect_err("entry")
        .to_string();
    assert!(entry.contains("from state 1 to 0 is 1.5"), "{entry}");
    let row = TransitionMatrix::new(&[[0.5, 0.25], [0.5, 0.5]])
        .expect_err("row")
        .to_string();
    assert!(row.contains("state 0 add up to 0.75"), "{row}");
}
