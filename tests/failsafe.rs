//! Chapter `failsafe`: actions, causes, latches.

mod common;

use common::{in_order, observations, pioneer, pioneer_with, settings, usual_or_any_config};
use proptest::prelude::*;
use sidestep::controller::{Controller, Decision};
use sidestep::failsafe::{Action, StopReason, table};
use sidestep::law::{Advice, Law};
use sidestep::quantity::Instant;
use sidestep::shield::Shield;
use sidestep::view::{Memory, View};
use sidestep_spec::failsafe as promise;
use std::collections::BTreeSet;

fn reason() -> impl Strategy<Value = StopReason> {
    proptest::sample::select(StopReason::EACH.to_vec())
}

/// Any three actions.
//= failsafe.INV-1 (every input)
//= failsafe.INV-2 (every input)
//= failsafe.INV-3 (every input)
//= failsafe.INV-4 (every input)
#[test]
fn actions_form_a_semilattice() {
    let each = || Action::ALL.into_iter();
    let pairs = each().flat_map(|a| each().map(move |b| (a, b)));
    for ((a, b), c) in pairs.flat_map(|pair| each().map(move |c| (pair, c))) {
        assert!(promise::commutative(a.join(b), b.join(a)));
        assert!(promise::associative(a.join(b).join(c), a.join(b.join(c))));
        assert!(promise::idempotent(a.join(a), a));
        assert!(promise::monotone(a.join(b), a));
        assert!(a > c || promise::monotone(c.join(b), a.join(b)));
    }
}

proptest! {
    /// In whatever order the causes come, one with the most severe action is named.
    //= failsafe.INV-6
    #[test]
    fn worst_cause_is_named(causes in proptest::collection::vec(reason(), 1..8)) {
        let named = causes
            .iter()
            .fold(None, |named, cause| StopReason::worse(named, Some(*cause)))
            .expect("there is a cause");
        for cause in causes {
            prop_assert!(promise::worst_is_named(named.action(), cause.action()));
        }
    }

    /// Whatever comes after a latched stop, it holds, until it is reset.
    //= failsafe.INV-5
    #[test]
    fn latched_stop_holds(first in reason(), then in proptest::collection::vec(reason(), 0..20)) {
        let mut shield = Shield::new(&pioneer());
        shield.refuse(first, Instant(1000));
        let latched = shield.is_latched();
        prop_assert_eq!(latched, first.action() == Action::LatchedStop);
        for (i, reason) in then.into_iter().enumerate() {
            let verdict = shield.refuse(reason, Instant(1100 + 100 * i as u64));
            prop_assert!(promise::latched_rests(
                latched,
                shield.is_latched(),
                verdict.command.speed(),
                verdict.command.turn_rate()
            ));
            if latched {
                prop_assert_eq!(verdict.stop, Some(first));
                prop_assert_eq!(verdict.action, Action::LatchedStop);
            }
        }
        shield.reset();
        prop_assert!(!shield.is_latched());
    }
}

/// Every cause stands in the table once, and every action occurs.
#[test]
fn table_is_complete() {
    let causes: BTreeSet<_> = table().map(|row| row.cause).collect();
    assert_eq!(causes.len(), table().count());
    assert_eq!(causes.len(), StopReason::EACH.len() + 2);
    for action in [
        Action::Limit,
        Action::Slow,
        Action::Stop,
        Action::LatchedStop,
    ] {
        assert!(table().any(|row| row.action == action), "{action}");
    }
    // Nothing that is latched, or overdue, lets the robot turn.
    for row in table().filter(|row| row.action == Action::LatchedStop || row.latches_in_time) {
        assert!(!row.may_turn, "{}", row.cause);
    }
}

// ------------------------------------------------------------ two-stage timeouts

/// A tick of a shield: a cause, or none of them, some time after the tick before.
type Tick = (Option<StopReason>, u64);

fn ticks() -> impl Strategy<Value = Vec<Tick>> {
    let cause = prop_oneof![
        1 => Just(None),
        4 => proptest::sample::select(
            StopReason::EACH
                .into_iter()
                .filter(|reason| reason.action() == Action::Stop)
                .collect::<Vec<_>>()
        )
        .prop_map(Some),
    ];
    // One cause goes on for a while.
    let ticks = (cause, 1..15_usize, 20..400_u64);
    proptest::collection::vec(ticks, 1..12).prop_map(|runs| {
        let tick = |(cause, count, time)| std::iter::repeat_n((cause, time), count);
        runs.into_iter().flat_map(tick).collect()
    })
}

/// A view of a robot at rest in free space, at a time.
fn clear_view(now: u64) -> View<16> {
    let (config, ring) = pioneer_with::<16>();
    let view =
        Memory::default().update(&in_order(now, [5.0; 16]), [5.0, 0.0].into(), &ring, &config);
    view.expect("odometry")
}

proptest! {
    #![proptest_config(common::cases(400))]

    /// What is overdue latches once it has lasted for the latch time without a clear tick in between,
    /// and nothing else that stops does; what was never there has not been lost.
    //= failsafe.INV-5
    //= failsafe.INV-7
    #[test]
    fn what_lasts_is_latched(ready in any::<bool>(), ticks in ticks()) {
        let (config, ring) = pioneer_with::<16>();
        let latch_time = (config.latch_time * 1000.0) as u64;
        let mut shield = Shield::new(&config);
        let mut now = 10_000;
        let mut ready = ready;
        if ready {
            shield.assess(&clear_view(now), &ring);
        }
        let (mut since, mut latched) = (None, false);
        for (cause, time) in ticks {
            now += time;
            let Some(reason) = cause else {
                shield.assess(&clear_view(now), &ring);
                shield.admit(Advice::REST, &clear_view(now), &ring);
                (since, ready) = (None, true);
                prop_assert_eq!(shield.is_latched(), latched);
                continue;
            };
            let mut due = None;
            if reason.row().latches_in_time {
                let lasted = now - *since.get_or_insert(now);
                due = Some(lasted);
                latched |= ready && lasted >= latch_time;
            }
            let was_latched = shield.is_latched();
            let verdict = shield.refuse(reason, Instant(now));
            if let Some(lasted) = due.filter(|_| !was_latched) {
                let latches = shield.is_latched();
                prop_assert!(promise::overdue_latches(ready, lasted, latch_time, latches));
            }
            prop_assert_eq!(shield.is_latched(), latched, "{} at {}", reason, now);
            let (speed, turn_rate) = (verdict.command.speed(), verdict.command.turn_rate());
            prop_assert!(promise::latched_rests(latched, latched, speed, turn_rate));
            let due = if latched { Action::LatchedStop } else { Action::Stop };
            prop_assert_eq!(verdict.action, due);
        }
    }

    /// A latched stop holds through whatever is observed afterwards, and whatever the law advises.
    //= failsafe.INV-5
    #[test]
    fn latched_stop_outlasts_observations(
        config in usual_or_any_config(), then in observations::<8>(30),
        advice in proptest::collection::vec(common::advice(), 30),
    ) {
        let (config, ring) = settings::fitted::<8>(&config);
        let law = Advises(advice, 0);
        let goal = [6.0, 0.0].into();
        let mut controller = Controller::new(config, ring, law, goal).expect("a goal in range");
        controller.halt(StopReason::Operator, Instant(9_000));
        for observation in then {
            let Decision { command, action, stop, .. } = controller.tick(&observation);
            prop_assert!(promise::latched_rests(
                true, controller.shield().is_latched(), command.speed(), command.turn_rate()
            ));
            prop_assert_eq!((action, stop), (Action::LatchedStop, Some(StopReason::Operator)));
        }
        controller.reset();
        prop_assert!(!controller.shield().is_latched());
    }
}

/// A law that advises one thing after the other.
struct Advises(Vec<Advice>, usize);

impl<const N: usize> Law<N> for Advises {
    fn advise(&mut self, _view: &View<N>) -> Advice {
        self.1 += 1;
        self.0[self.1 % self.0.len()]
    }

    fn mode(&self) -> &'static str {
        "advises"
    }
}

// ------------------------------------------------- what latches at once, as it is seen

/// A robot that goes straight ahead through free space and does as it is told, all but `change` which
/// may alter its observation by the tick; the decisions.
fn drive(
    ticks: u64,
    change: impl Fn(u64, &mut sidestep::observation::Observation<16>),
) -> Vec<Decision<16>> {
    let (config, ring) = pioneer_with::<16>();
    let ahead = Advice {
        speed: 1.0,
        turn_rate: 0.0,
    };
    let law = Advises(vec![ahead], 0);
    let goal = [90.0, 0.0].into();
    let mut controller = Controller::new(config, ring, law, goal).expect("a goal in range");
    let (mut x, mut speed) = (0.0_f32, 0.0_f32);
    (0..ticks)
        .map(|tick| {
            let mut observation = in_order(10_000 + 100 * tick, [5.0; 16]);
            let odometry = observation.odometry.as_mut().expect("odometry");
            (odometry.x, odometry.speed) = (x, speed);
            change(tick, &mut observation);
            let decision = controller.tick(&observation);
            speed = decision.command.speed() as f32 / 1000.0;
            x += speed / 10.0;
            decision
        })
        .collect()
}

/// The first stop after the robot set off, and whether it is latched.
fn first_stop(decisions: &[Decision<16>]) -> Option<(StopReason, bool)> {
    let moving = decisions
        .iter()
        .position(|decision| decision.command.speed() > 0)?;
    let stopped = decisions[moving..]
        .iter()
        .find(|decision| decision.stop.is_some())?;
    Some((stopped.stop?, stopped.action == Action::LatchedStop))
}

/// A base that does not slow down when it is told to rest.
//= failsafe.INV-5
#[test]
fn weak_brakes_are_latched() {
    assert_eq!(first_stop(&drive(60, |_, _| {})), None);
    let decisions = drive(60, |tick, observation| {
        // Told to rest by a fault that clears, it rolls on.
        if tick == 30 {
            observation.base.motors_enabled = false;
        }
        if tick >= 30 {
            observation.odometry.as_mut().expect("odometry").speed = 0.4;
        }
    });
    let latched = decisions
        .iter()
        .find(|decision| decision.action == Action::LatchedStop);
    let latched = latched.expect("a latched stop").stop;
    assert!(matches!(
        latched,
        Some(StopReason::BrakesWeak {
            measured: 400..,
            ..
        })
    ));
}

/// Someone who runs at the robot's side at 2 m/s, where 0.8 m/s is promised.
//= failsafe.INV-5
#[test]
fn whoever_is_too_fast_is_latched() {
    let runner = |speed: f32| {
        drive(60, move |tick, observation| {
            let range = 4.9 - speed * (tick as f32 - 30.0).max(0.0) / 10.0;
            observation.sonar[0].as_mut().expect("a sample").range = range.max(0.5);
        })
    };
    let named = |decisions: &[Decision<16>]| {
        decisions
            .iter()
            .any(|decision| matches!(decision.stop, Some(StopReason::ClassExceeded { .. })))
    };
    assert!(named(&runner(2.0)));
    assert!(!named(&runner(0.3)));
}

/// A sonar that reads the same while the robot drives towards it.
//= failsafe.INV-5
#[test]
fn a_stuck_sonar_is_latched() {
    let decisions = drive(60, |_, observation| {
        observation.sonar[3].as_mut().expect("a sample").range = 3.0;
    });
    let (reason, latched) = first_stop(&decisions).expect("a stop");
    let stuck = StopReason::SensorStuck {
        sonar: 3,
        range: 3000,
    };
    assert_eq!((reason, latched), (stuck, true));
    // One beside it that looks across sees a wall that stays where it is.
    let decisions = drive(60, |_, observation| {
        observation.sonar[0].as_mut().expect("a sample").range = 2.0;
    });
    assert_eq!(first_stop(&decisions), None);
}
