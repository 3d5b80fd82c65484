//! Chapter `failsafe`: actions are a join-semilattice, latched stops hold.

#[cfg(not(kani))]
use super::kani;
use sidestep::failsafe::{Action, StopReason};
use sidestep::observation::SonarReading;
use sidestep::quantity::Instant;
use sidestep::view::View;
use sidestep_spec::failsafe as promise;

fn any_action() -> Action {
    Action::ALL[kani::any::<u8>() as usize % Action::ALL.len()]
}

fn any_reason() -> StopReason {
    StopReason::EACH[kani::any::<u8>() as usize % StopReason::EACH.len()]
}

/// Any three actions.
//= failsafe.INV-1
//= failsafe.INV-2
//= failsafe.INV-3
//= failsafe.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn actions_form_a_semilattice() {
    let (a, b, c) = (any_action(), any_action(), any_action());
    assert!(promise::commutative(a.join(b), b.join(a)));
    assert!(promise::associative(a.join(b).join(c), a.join(b.join(c))));
    assert!(promise::idempotent(a.join(a), a));
    assert!(promise::monotone(a.join(b), a));
    assert!(promise::monotone(a.join(b), b));
    if a <= c {
        assert!(promise::monotone(c.join(b), a.join(b)));
    }
    kani::cover!(
        a.join(b) == Action::LatchedStop && a == Action::Run,
        "joined"
    );
}

/// Any three causes, in any order.
//= failsafe.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(25))]
pub fn worst_cause_is_named() {
    let causes = [any_reason(), any_reason(), any_reason()];
    let mut named = None;
    for cause in causes {
        named = StopReason::worse(named, Some(cause));
    }
    for cause in causes {
        assert!(named.is_some_and(|named| promise::worst_is_named(named.action(), cause.action())));
    }
    kani::cover!(
        named == Some(causes[2]) && causes[2].action() > causes[0].action(),
        "the last is the worst"
    );
}

/// A latched stop holds whatever the next view and the next advice are.
//= failsafe.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(kani, kani::stub(crate::shield::Limits::fits, super::shield::any_fit))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::needed, super::shield::any_needed)
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::shield::Limits::contact_within_stop_time,
        super::shield::any_contact
    )
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, super::shield::any_plan))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Guard::admissible, super::shield::any_admission)
)]
pub fn latched_stop_holds() {
    let (mut shield, ring) = super::shield::at_rest();
    shield.refuse(any_reason(), Instant(1000));
    let was_latched = shield.is_latched();
    let view = super::view::any_view();
    shield.assess(&view, &ring);
    let advice = sidestep::law::Advice {
        speed: kani::any(),
        turn_rate: kani::any(),
    };
    let verdict = shield.admit(advice, &view, &ring);
    assert!(promise::latched_rests(
        was_latched,
        shield.is_latched(),
        verdict.command.speed(),
        verdict.command.turn_rate()
    ));
    kani::cover!(was_latched, "latched");
    kani::cover!(!was_latched && verdict.stop.is_none(), "free");
}

/// A sonar that goes stale and stays so, or comes back for a moment in between: the stop latches when it
/// has been away for the latch time, if it was there once. A reset lets the robot go on with the next clear
/// tick.
//= failsafe.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(70))]
#[cfg_attr(
    kani,
    kani::stub(crate::shield::Limits::fits, super::shield::always_fits)
)]
#[cfg_attr(kani, kani::stub(crate::shield::Guard::plan, super::shield::some_plan))]
pub fn what_is_overdue_latches() {
    let (mut shield, ring) = super::shield::at_rest();
    let clear = super::view::clear_view();
    let was_ready: bool = kani::any();
    if was_ready {
        shield.assess(&clear, &ring);
    }
    let at = |later: u64, reading| View {
        now: Instant(clear.now.0 + later),
        sonar: [reading],
        ..clear
    };
    let [away, since] = [0, 1].map(|_| u64::from(kani::any::<u16>()));
    assert!(shield.assess(&at(0, SonarReading::Stale), &ring).is_some());
    let back: bool = kani::any();
    if back {
        shield.assess(&at(away, clear.sonar[0]), &ring);
        shield.assess(&at(away, SonarReading::Stale), &ring);
    }
    shield.assess(&at(away + since, SonarReading::Stale), &ring);
    let lasted = if back { since } else { away + since };
    assert!(promise::overdue_latches(
        was_ready || back,
        lasted,
        5_000,
        shield.is_latched()
    ));
    shield.reset();
    assert!(!shield.is_latched());
    let stop = shield.assess(&at(away + since, clear.sonar[0]), &ring);
    assert!(stop.is_none());
    kani::cover!(lasted == 5_000 && was_ready, "just long enough");
    kani::cover!(lasted > 10_000 && !was_ready && !back, "never ready");
}
