//! Chapter `monitor`: what a base that keeps its promise may do is never held against it.

#[cfg(not(kani))]
use super::kani;
use super::shield::any_in;
use super::view::PIONEER;
use sidestep::monitor::Monitor;
use sidestep::quantity::Instant;
use sidestep::shield::Limits;
use sidestep_spec::monitor as promise;

/// Any two commands, any time apart: the bound is never below what was told, and once the robot
/// has been told to rest for the reaction time and as long as braking takes, it is down to what
/// cannot be measured.
//= monitor.INV-1
//= monitor.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn bound_follows_the_commands() {
    let limits = const { Limits::new(&PIONEER) };
    let mut monitor = Monitor::new();
    let first = any_in(0, limits.speed_max());
    let second = any_in(0, limits.speed_max());
    let begin: u64 = kani::any();
    let gap = any_in(0, 10_000) as u64;
    let later = begin.saturating_add(gap);
    monitor.told(first, Instant(begin), &limits);
    assert!(promise::allows_what_was_told(monitor.bound(&limits), first));
    monitor.told(second, Instant(later), &limits);
    assert!(promise::allows_what_was_told(
        monitor.bound(&limits),
        second
    ));
    // The reaction time, and 400 mm/s at 1 m/s².
    let rest = later.saturating_add(220);
    monitor.told(0, Instant(later), &limits);
    let end = rest.saturating_add(any_in(400, 10_000) as u64);
    monitor.told(0, Instant(end), &limits);
    kani::assume(end < u64::MAX);
    assert!(promise::falls_to_rest(
        monitor.bound(&limits),
        limits.speed_gain(),
        limits.speed_error()
    ));
    kani::cover!(first > second && gap == 100, "slower");
}

/// Any four measurements in a row.
//= monitor.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(40))]
pub fn three_in_a_row_accuse() {
    let limits = const { Limits::new(&PIONEER) };
    let mut monitor = Monitor::new();
    let bound = monitor.bound(&limits);
    let mut above = 0;
    for i in 0..4 {
        let speed: i32 = kani::any();
        above = if speed > bound { above + 1 } else { 0 };
        let accused = monitor.measured(speed, Instant(100 * (i + 1)), &limits);
        assert!(promise::accuses(above, accused));
        kani::cover!(accused && i == 2, "accused");
    }
}
