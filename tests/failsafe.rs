//! Chapter `failsafe`: actions, causes, latches.

mod common;

use common::pioneer;
use proptest::prelude::*;
use sidestep::failsafe::{Action, StopReason, table};
use sidestep::quantity::Instant;
use sidestep::shield::Shield;
use sidestep_spec::failsafe as promise;
use std::collections::BTreeSet;

fn action() -> impl Strategy<Value = Action> {
    proptest::sample::select(Action::ALL.to_vec())
}

fn reason() -> impl Strategy<Value = StopReason> {
    proptest::sample::select(StopReason::EACH.to_vec())
}

proptest! {
    //= failsafe.INV-1
    //= failsafe.INV-2
    //= failsafe.INV-3
    //= failsafe.INV-4
    #[test]
    fn actions_form_a_semilattice(a in action(), b in action(), c in action()) {
        prop_assert!(promise::commutative(a.join(b), b.join(a)));
        prop_assert!(promise::associative(a.join(b).join(c), a.join(b.join(c))));
        prop_assert!(promise::idempotent(a.join(a), a));
        prop_assert!(promise::monotone(a.join(b), a));
        if a <= c {
            prop_assert!(promise::monotone(c.join(b), a.join(b)));
        }
    }

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
    for action in [Action::Limit, Action::Slow, Action::Stop, Action::LatchedStop] {
        assert!(table().any(|row| row.action == action), "{action}");
    }
    // Nothing that is latched, or overdue, lets the robot turn.
    for row in table().filter(|row| row.action == Action::LatchedStop || row.latches_in_time) {
        assert!(!row.may_turn, "{}", row.cause);
    }
}
