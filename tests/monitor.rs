//! Chapter `monitor`: a base that keeps its promise is never accused, a weak one soon.

mod common;

use common::{pioneer, usual_or_any_config};
use proptest::prelude::*;
use sidestep::config::{Config, Parameters};
use sidestep::monitor::Monitor;
use sidestep::preset;
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
        assert!(promise::allows_what_was_told(
            monitor.bound(&limits),
            *command
        ));
        for ms in 0..100 {
            let at = (100 * tick + ms)
                .checked_sub(delay)
                .map_or(0, |heard| heard / 100);
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

// --------------------------------------------------- any configuration, any delays

/// A command: at a share of the greatest speed, after a share of the longest time between two, heard
/// after a share of the longest delay, with odometry of a share of the greatest age.
type Order = (f64, f64, f64, f64);

fn orders() -> impl Strategy<Value = Vec<Order>> {
    let share = || prop_oneof![1 => Just(0.0), 1 => Just(1.0), 4 => 0.0..=1.0_f64];
    let speed = prop_oneof![2 => Just(0.0), 2 => Just(1.0), 3 => 0.0..=1.0_f64];
    proptest::collection::vec((speed, share(), share(), share()), 1..60)
}

/// A base by the millisecond, and the monitor that watches it.
struct Plant {
    limits: Limits,
    monitor: Monitor,
    /// Its speeds so far, mm/s.
    past: Vec<f64>,
    /// What it was told and has not heard yet: the command, and when it hears.
    on_the_way: Vec<(i32, usize)>,
    target: i32,
    /// The share of the promised braking that it has, and whether it goes beyond commands by a gain.
    braking: f64,
    hasty: bool,
}

impl Plant {
    fn new(config: &Config, braking: f64, hasty: bool) -> Self {
        Self {
            limits: Limits::new(config),
            monitor: Monitor::new(),
            past: vec![0.0],
            on_the_way: Vec::new(),
            target: 0,
            braking,
            hasty,
        }
    }

    fn now(&self) -> usize {
        self.past.len() - 1
    }

    fn millisecond(&mut self) {
        let now = self.now();
        let heard = self
            .on_the_way
            .iter()
            .take_while(|(_, at)| *at <= now)
            .count();
        if let Some((command, _)) = self.on_the_way.drain(..heard).next_back() {
            self.target = command;
        }
        let speed = *self.past.last().expect("a beginning");
        let mut target = f64::from(self.target);
        if self.hasty && self.target > 0 {
            // What is faster than it is told may stay so for a gain.
            target += f64::from(self.limits.speed_gain());
        }
        let most = f64::from(self.limits.acceleration()) / 1000.0;
        let least = self.braking * f64::from(self.limits.braking()) / 1000.0;
        self.past
            .push(target.clamp((speed - least).max(0.0), speed + most));
    }

    /// A tick: the speed of a while ago is measured, as it is or too low, and a command given that is
    /// heard after a delay. True if the base is accused.
    fn tick(&mut self, command: i32, delay: usize, age: usize) -> bool {
        let now = self.now();
        let measured = self.past[now.saturating_sub(age)];
        let at = Instant(1_000_000 + (now - age.min(now)) as u64);
        let accused = self
            .monitor
            .measured(measured.floor() as i32, at, &self.limits);
        self.monitor
            .told(command, Instant(1_000_000 + now as u64), &self.limits);
        // Commands do not overtake each other.
        let before = self.on_the_way.last().map_or(0, |(_, at)| *at);
        self.on_the_way.push((command, (now + delay).max(before)));
        accused
    }
}

proptest! {
    #![proptest_config(common::cases(600))]

    /// Any configuration, any commands, as long as a command is heard within the reaction time from
    /// what the tick before described: never accused, and never bound below what it was told.
    //= monitor.INV-1
    #[test]
    fn no_base_within_the_model_is_accused(
        config in usual_or_any_config(), orders in orders(), hasty in any::<bool>(),
    ) {
        let mut plant = Plant::new(&config, 1.0, hasty);
        let (mut gap, mut age) = (0, 0);
        let reaction = plant.limits.reaction_time() as usize;
        for (speed, until_next, delay, old) in orders {
            let command = (speed * f64::from(plant.limits.speed_max())).round() as i32;
            // From the odometry of the tick before to the effect of this command.
            let delay = (delay * (reaction - gap - age) as f64) as usize;
            age = (old * (reaction / 3) as f64) as usize;
            prop_assert!(!plant.tick(command, delay, age), "{:?}", plant.monitor);
            let bound = plant.monitor.bound(&plant.limits);
            prop_assert!(promise::allows_what_was_told(bound, command));
            gap = ((until_next * (reaction - age) as f64) as usize).max(1).min(reaction - age);
            for _ in 0..gap {
                plant.millisecond();
            }
        }
    }
}

/// When a base that is told to rest from its greatest speed is accused, ms: ticks every so many ms,
/// the command heard at once.
fn accused_after(parameters: Parameters, braking: f64, period: usize) -> Option<usize> {
    let config = Config::new(parameters).expect("a configuration");
    let mut plant = Plant::new(&config, braking, false);
    let full = plant.limits.speed_max();
    while *plant.past.last().expect("a beginning") < f64::from(full) {
        assert!(!plant.tick(full, 0, 0));
        for _ in 0..period {
            plant.millisecond();
        }
    }
    let told = plant.now();
    while plant.now() < told + 5_000 {
        if plant.tick(0, 0, 0) {
            return Some(plant.now() - told);
        }
        for _ in 0..period {
            plant.millisecond();
        }
    }
    None
}

/// A base that brakes at half is accused within a second where it is fast enough for that to show;
/// one that brakes at a quarter also with the presets' speeds; and one that keeps the promise never.
//= monitor.INV-3
#[test]
fn half_the_braking_is_noticed_in_time() {
    let fast = Parameters {
        speed_max: 1.0,
        ..preset::PIONEER_3DX
    };
    for period in [20, 50, 100] {
        let half = accused_after(fast, 0.5, period).expect("half the braking");
        assert!(half <= 1_400, "{half} ms at {period} ms");
        let quarter = accused_after(preset::PIONEER_3DX, 0.25, period).expect("a quarter");
        assert!(quarter <= 1_000, "{quarter} ms at {period} ms");
        for parameters in [fast, preset::PIONEER_3DX, preset::SRIKANDI_II_2012] {
            assert_eq!(accused_after(parameters, 1.0, period), None);
        }
    }
}
