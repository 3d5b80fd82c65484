//! Bytes as weights, likelihoods, matrices and losses of S2's filter and decision, and as what the law
//! round a law gets to see.

use super::bytes::Bytes;
use super::settings::{self, Shares};
use nalgebra::Vector2;
use sidestep::config::Config;
use sidestep::decide::{
    self, Belief, CameraLook, Decide, DistanceLoss, LossTable, NoBelief, ONE, Response, SecondLook,
    Settings, TransitionMatrix,
};
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, SonarReading, SonarSample};
use sidestep::preset;
use sidestep::quantity::{Instant, Length};
use sidestep::view::{Class, GoalView, Hazard, Pose, View};
use sidestep_spec::decide as law;

/// Observations and views at most.
const STEPS: usize = 64;

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    match bytes.u8() {
        0xe0.. => looks(&mut bytes),
        kind => match kind % 3 {
            0 => filter(&mut bytes),
            1 => losses(&mut bytes),
            _ => advice(&mut bytes),
        },
    }
}

fn numbers<const K: usize>(bytes: &mut Bytes) -> [f32; K] {
    // Any bits one time in four, and shares otherwise.
    std::array::from_fn(|_| match bytes.u8() % 4 {
        0 => bytes.number(),
        _ => bytes.share(),
    })
}

fn both(belief: &Belief<2>) -> [f64; 2] {
    [0, 1].map(|state| f64::from(belief.probability(state)))
}

/// A belief through any observations.
fn filter(bytes: &mut Bytes) {
    let weights = numbers::<3>(bytes);
    let belief = Belief::from_weights(&weights);
    assert!(law::only_weights_are_beliefs(&weights, belief.is_ok()));
    if let Ok(belief) = belief {
        assert!(law::on_simplex(belief.parts(), ONE));
    }
    let rows = [numbers::<2>(bytes), numbers::<2>(bytes)];
    let transition = TransitionMatrix::new(&rows);
    for row in &rows {
        assert!(law::only_stochastic_is_accepted(row, transition.is_ok()));
    }
    let share = bytes.share();
    let transition = transition.or_else(|_| {
        TransitionMatrix::new(&[[1.0 - share, share], [share / 2.0, 1.0 - share / 2.0]])
    });
    let mut belief = Belief::<2>::even();
    for _ in 0..STEPS {
        if bytes.is_empty() {
            break;
        }
        if let Ok(transition) = &transition {
            belief = belief.predicted(transition);
            assert!(law::on_simplex(belief.parts(), ONE));
        }
        let likelihood = numbers::<2>(bytes);
        let updated = belief.updated(&likelihood);
        let action = LossTable::TABLE_2.respond(&updated);
        assert!(law::no_belief_is_safest(updated.is_ok(), action, 2));
        match updated {
            Ok(updated) => {
                assert!(law::on_simplex(updated.parts(), ONE));
                let usual = |l: &f32| (1e-6..1e6).contains(l);
                if likelihood.iter().all(usual) {
                    let likelihood = likelihood.map(f64::from);
                    let error = 8.0 / f64::from(ONE);
                    assert!(law::odds_law(
                        both(&updated),
                        likelihood,
                        both(&belief),
                        error
                    ));
                    let more = [likelihood[0] as f32 * 2.0, likelihood[1] as f32];
                    if let Ok(more) = belief.updated(&more) {
                        let (less, more) = (updated.parts()[0], more.parts()[0]);
                        assert!(law::monotone_in_the_ratio(less, more, 8));
                    }
                }
                belief = updated;
            }
            Err(NoBelief::NotAWeight { state, value }) => {
                assert_eq!(likelihood[state].to_bits(), value.to_bits());
            }
            Err(NoBelief::NoEvidence) => {}
        }
        if let Ok(floored) = belief.floored(bytes.share() / 2.0) {
            assert!(law::on_simplex(floored.parts(), ONE));
            belief = floored;
        }
    }
}

/// Any readings of one sonar where what appears has to be heard twice, some of them looked at again.
fn looks(bytes: &mut Bytes) {
    let shares: Shares = std::array::from_fn(|_| bytes.share());
    let mut p = *settings::config(&shares).parameters();
    p.appear_samples = 2.0;
    let config = Config::new(p).expect("within every range");
    let mut look = SecondLook::<1>::default();
    let mut latest = None;
    let closing = f64::from(config.obstacle_speed_max) + f64::from(config.speed_max);
    let hold_time = (f64::from(config.hold_time) * 1000.0) as u64;
    let (mut before, mut in_a_row, mut now) = (None, 0, 0_u64);
    // The last echo that counted.
    let mut echo: Option<(f32, u64)> = None;
    for _ in 0..STEPS {
        if bytes.is_empty() {
            break;
        }
        let before_that = latest;
        if latest.is_none() || !bytes.u8().is_multiple_of(4) {
            now = match bytes.u8() {
                0xff => bytes.u64(),
                gap => now.saturating_add(u64::from(gap)),
            };
            latest = Some(SonarSample {
                range: bytes.number(),
                taken_at: Instant(now),
            });
        }
        // What is as it was, time included, is no new reading.
        let again = latest == before_that;
        let Some(latest) = latest else { break };
        let observation = Observation {
            now: Instant(now),
            sonar: [Some(latest)],
            odometry: None,
            sighting: None,
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
        };
        let handed_on = look.judged(&observation, &config).sonar[0].expect("a reading");
        let both = |sample: SonarSample| (sample.range, sample.taken_at.0);
        let (handed_on, latest) = (both(handed_on), both(latest));
        assert!(law::latest_or_before(handed_on, latest, before));
        in_a_row = match (handed_on.1 != latest.1, again) {
            (false, _) => 0,
            (true, true) => in_a_row,
            (true, false) => in_a_row + 1,
        };
        assert!(law::withheld_at_most_twice(in_a_row));
        let (range, at) = latest;
        let counts = handed_on == latest;
        if let Some((last, gap)) = echo.and_then(|(last, then)| Some((last, at.checked_sub(then)?)))
            && gap < hold_time
        {
            assert!(law::explained_counts_at_once(
                range,
                last,
                gap,
                closing,
                counts || range.is_nan()
            ));
        }
        if counts && range < config.sonar_range_max {
            echo = Some(latest);
        }
        before = Some(handed_on);
    }
}

/// Any losses, any belief.
fn losses(bytes: &mut Bytes) {
    let first = bytes.u32() % (ONE + 1);
    let weights = [first as f32, (ONE - first) as f32];
    let Ok(belief) = Belief::from_weights(&weights) else {
        panic!("whole numbers are weights");
    };
    let [maneuver, stop] = LossTable::TABLE_2.expected(&belief);
    let chosen = LossTable::TABLE_2.choose(&belief);
    assert!(law::table_2_never_stops(maneuver, stop, chosen, ONE));

    let rows: [[f32; 2]; 3] = std::array::from_fn(|_| numbers::<2>(bytes).map(|l| l * 20.0));
    if let Ok(table) = LossTable::new(&rows) {
        assert!(law::nothing_dominated(table.milliseconds()));
    }
    let Ok(table) = LossTable::with_dominated(&rows) else {
        return;
    };
    let expected = table.expected(&belief);
    for (row, expected) in table.milliseconds().iter().zip(expected) {
        assert!(law::between_losses(row, expected, ONE));
    }
    let tie = i64::from(bytes.u16());
    let chosen = decide::safest_of_the_least(&expected, tie);
    assert!(law::safest_of_the_best(&expected, tie, chosen));
    // The same in half milliseconds, with something added in each state.
    let [one, two] = [bytes.u16(), bytes.u16()].map(|extra| f32::from(extra) / 1000.0);
    let whole = table
        .milliseconds()
        .map(|row| row.map(|loss| (loss % 20_000) as f32 / 1000.0));
    let other = whole.map(|[a, b]| [2.0 * a + one, 2.0 * b + two]);
    if let (Ok(plain), Ok(other)) = (
        LossTable::with_dominated(&whole),
        LossTable::with_dominated(&other),
    ) {
        assert!(law::same_choice(
            plain.choose(&belief),
            other.choose(&belief)
        ));
    }

    let (far, near) = (bytes.length(), bytes.length());
    if let Ok(loss) = DistanceLoss::with_dominated(
        table,
        far,
        LossTable::with_dominated(&other).unwrap_or(table),
        near,
    ) {
        let at = loss.at(bytes.length());
        for (row, expected) in at.milliseconds().iter().zip(at.expected(&belief)) {
            assert!(law::between_losses(row, expected, ONE));
        }
    }
    let config = Config::new(preset::SRIKANDI_II_2011).expect("the preset is good");
    let settings = Settings::usual(&config).expect("usual");
    let (here, nearer) = (bytes.length(), bytes.share());
    let there = Length::metres(here.get() * nearer).unwrap_or(Length::ZERO);
    let [here, there] = [here, there].map(|at| settings.respond(&belief, at) as usize);
    assert!(law::no_bolder(here, there));
}

/// Advises what it is told to, and notes what it is shown.
struct Told {
    advice: Advice,
    shown: Option<View<3>>,
}

impl Law<3> for Told {
    fn advise(&mut self, view: &View<3>) -> Advice {
        self.shown = Some(*view);
        self.advice
    }

    fn mode(&self) -> &'static str {
        "told"
    }
}

fn reading(bytes: &mut Bytes) -> SonarReading {
    match bytes.u8() % 8 {
        0..=3 => SonarReading::Echo(bytes.length()),
        4 | 5 => SonarReading::NoEcho(bytes.length()),
        6 => SonarReading::TooNear,
        _ => [SonarReading::Stale, SonarReading::Invalid][usize::from(bytes.u8() % 2)],
    }
}

/// Nothing within 5 m.
const NOTHING: Hazard = Hazard {
    range: 5_000,
    clearance: 5_000,
    age: 0,
    way: [0; 2],
    turned: 0,
    class: Class::Unknown,
    too_fast: false,
    stuck: false,
};

/// The law round a law, shown any views one after the other.
fn advice(bytes: &mut Bytes) {
    let (config, ring) =
        settings::fitted::<3>(&Config::new(preset::PIONEER_3DX).expect("the preset is good"));
    let usual = Settings::usual(&config).expect("usual");
    let told = Told {
        advice: Advice::REST,
        shown: None,
    };
    let mut deciding = Decide::new(told, config, ring, usual);
    let control = usual.parameters().control_period;
    let mut now = 0_u64;
    let mut silent_since = None;
    for _ in 0..STEPS {
        if bytes.is_empty() {
            break;
        }
        let flags = bytes.u8();
        now = now.saturating_add(u64::from(bytes.u16() % 600));
        let position = Vector2::new(bytes.share() * 4.0 - 2.0, bytes.share() * 4.0 - 2.0);
        let view = View::<3> {
            now: Instant(now),
            pose: Pose {
                position,
                heading: bytes.angle(),
            },
            speed: bytes.share(),
            turn_rate: 0.0,
            odometry_age: 0,
            goal: GoalView {
                heading: bytes.angle(),
                distance: bytes.length().get(),
            },
            sonar: [reading(bytes), reading(bytes), reading(bytes)],
            hazard: [NOTHING; 3],
            obstacle: None,
            ahead: bytes.length(),
            room: [bytes.length(), bytes.length()],
            beside: [bytes.length(), bytes.length()],
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
            guard: (flags & 3 == 3).then_some(StopReason::Operator),
        };
        if flags & 4 != 0 {
            deciding.see(CameraLook {
                detected: (flags & 8 != 0).then(|| bytes.angle()),
                taken_at: Instant(now.saturating_sub(bytes.u16().into())),
            });
        }
        // The last that was told stays: what a law advises is its own business.
        let told = Advice {
            speed: bytes.number(),
            turn_rate: bytes.number(),
        };
        deciding.law_mut().advice = told;
        let given = deciding.advise(&view);
        let stop = deciding.verdict().response == Response::Stop;
        assert!(law::never_into_motion(
            stop,
            [told.speed, told.turn_rate],
            [given.speed, given.turn_rate]
        ));
        let without = |view: View<3>| View {
            obstacle: None,
            ..view
        };
        let shown = deciding.law().shown.expect("the law was asked");
        assert!(law::only_the_obstacle_differs(
            &without(view),
            &without(shown)
        ));
        let usable = |reading: &SonarReading| {
            !matches!(reading, SonarReading::Stale | SonarReading::Invalid)
        };
        if view.sonar.iter().any(usable) || flags & 4 != 0 {
            silent_since = Some(now);
        }
        let silence = silent_since.map_or(u64::MAX, |since| now - since);
        assert!(law::blind_is_stop(silence, control, stop));
        assert!(!Law::<3>::mode(&deciding).is_empty());
    }
}
