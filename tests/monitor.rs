//! Chapter `monitor`: a base that keeps its promise is never accused, a weak one soon.

mod common;

use common::pioneer;
use proptest::prelude::*;
use sidestep::monitor::Monitor;
use sidestep::quantity::Instant;
use sidestep::shield::Limits;
use sidestep_spec::monitor as promise;

/// Drives a base that brakes and speeds up at shares of the promised rates, and hears of each command
/// `delay` ms late, through commands that are given every 100 ms; the first time that the monitor
/// accuses it, ms.
fn accused(commands: &[i32], delay: usize, braking: f64) -> Option<u64> {
    let limits = Limits::new(&pioneer());
    let mut monitor = Monitor::new();
    let mut speed = 0.0_f64;
    let mut told = Vec::new();
    for (tick, command) in commands.iter().enumerate() {
        told.push(*command);
        let now = 1000 + 100 * tick as u64;
        if monitor.measured(speed.round() as i32, Instant(now), &limits) {
            return Some(now - 1000);
        }
        monitor.told(*command, Instant(now), &limits);
        assert!(promise::allows_what_was_told(monitor.bound(&limits), *command));
        for ms in 0..100 {
            let at = (100 * tick + ms).checked_sub(delay).map_or(0, |heard| heard / 100);
            let target = f64::from(told[at]);
            let most = f64::from(limits.acceleration()) / 1000.0;
            let least = braking * f64::from(limits.braking()) / 1000.0;
            speed = target.clamp(speed - least, speed + most);
        }
    }
    None
}

proptest! {
    #![proptest_config(common::cases(2_000))]

    /// Any commands, any delay that leaves a command 100 ms before the reaction time is over.
    //= monitor.INV-1
    #[test]
    fn base_that_keeps_its_promise_is_not_accused(
        commands in proptest::collection::vec((0..=400_i32, 1..20_usize), 1..12),
        delay in 0..=120_usize,
    ) {
        let commands: Vec<i32> = commands
            .into_iter()
            .flat_map(|(speed, ticks)| std::iter::repeat_n(speed, ticks))
            .collect();
        prop_assert_eq!(accused(&commands, delay, 1.0), None);
    }

    /// Once told to rest long enough ago, nothing but the gain and the error of measuring is left.
    //= monitor.INV-2
    #[test]
    fn bound_falls_to_rest(
        commands in proptest::collection::vec(0..=400_i32, 1..30),
        longer in 0..5_000_u64,
    ) {
        let limits = Limits::new(&pioneer());
        let mut monitor = Monitor::new();
        let mut now = 1000;
        for command in commands {
            monitor.told(command, Instant(now), &limits);
            now += 100;
        }
        monitor.told(0, Instant(now), &limits);
        monitor.told(0, Instant(now + 220 + 400 + longer), &limits);
        prop_assert!(promise::falls_to_rest(
            monitor.bound(&limits),
            limits.speed_gain(),
            limits.speed_error()
        ));
    }

    //= monitor.INV-3
    #[test]
    fn three_in_a_row_accuse(speeds in proptest::collection::vec(0..300_i32, 1..30)) {
        let limits = Limits::new(&pioneer());
        let mut monitor = Monitor::new();
        let mut above = 0;
        for (i, speed) in speeds.into_iter().enumerate() {
            above = if speed > monitor.bound(&limits) { above + 1 } else { 0 };
            let accused = monitor.measured(speed, Instant(100 * (i as u64 + 1)), &limits);
            prop_assert!(promise::accuses(above, accused));
        }
    }
}

/// Full speed, then rest: a base with a fifth of the braking is accused within a second and a half
/// of being told to rest, one with all of it never.
#[test]
fn weak_brakes_are_noticed() {
    let mut commands = vec![400; 30];
    commands.extend([0; 40]);
    assert_eq!(accused(&commands, 100, 1.0), None);
    let noticed = accused(&commands, 100, 0.2).expect("weak brakes");
    assert!((3000..4500).contains(&noticed), "{noticed} ms");
}
