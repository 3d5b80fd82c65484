//! Small versions of the example `episodes`: nothing is touched by a moving robot while every
//! assumption holds, and where one does not the report says which.
//!
//! `SIDESTEP_SEEDS=100000 cargo test --release -p sidestep-hw --test episodes` is a long run.

mod common;

use common::seeds;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::demo::run_in_memory;
use sidestep_hw::episodes::{
    LawKind, Ride, Totals, assumptions, moving_again_ms, pilot, run, run_many,
};
use sidestep_hw::pilot::settings;
use sidestep_sim::episode::Options;
use sidestep_sim::link;
use sidestep_sim::scenario::{Knobs, Scenario};

fn many(law: LawKind, count: u64, options: &Options) -> Totals {
    let config = RobotConfig::default();
    let totals = run_many(0, count, 2, options, &config, law, |_| {}).unwrap();
    println!("{law:?}:\n{totals}");
    assert_eq!(totals.episodes, count);
    totals
}

fn promised() -> Options {
    let config = RobotConfig::default();
    Options {
        person_speed: assumptions(&config).person_speed,
        robot_radius: config.core.robot_radius.into(),
        ..Options::default()
    }
}

/// No contact while moving, no broken assumption, and not because nothing moved.
fn assert_safe(law: LawKind, count: u64) {
    let totals = many(law, count, &promised());
    assert_eq!(totals.failed, 0, "{law:?}");
    assert!(totals.broken.is_empty(), "{:?}", totals.broken);
    assert_eq!(
        totals.while_driving.people + totals.while_driving.obstacles,
        0
    );
    assert_eq!(
        totals.while_turning.people + totals.while_turning.obstacles,
        0
    );
    assert!(totals.travelled > 0.3 * count as f64, "hardly driven");
    assert!(totals.at_rest.people > 0, "nobody came near");
    assert_eq!(totals.kinds.len(), 4);
}

#[test]
fn nobody_is_touched_in_episodes_with_s1s_law() {
    assert_safe(LawKind::Avoid, seeds(250));
}

#[test]
fn nobody_is_touched_in_episodes_with_chaos() {
    assert_safe(LawKind::Chaos, seeds(250));
}

#[test]
fn nobody_is_touched_in_episodes_with_reckless_driving() {
    assert_safe(LawKind::Reckless, seeds(250));
}

#[test]
fn people_who_are_too_fast_are_named() {
    let options = Options {
        person_speed: 2.5,
        ..promised()
    };
    let totals = many(LawKind::Reckless, 250, &options);
    assert!(totals.failed > 0, "the check does not bite");
    assert_eq!(totals.failed_unexplained, 0);
    for report in totals.failures.values() {
        // Whoever stood still first and then was too fast broke two bounds at once.
        let broken: Vec<_> = report.broken.iter().map(|b| b.name()).collect();
        assert!(broken.contains(&"people's speed"), "seed {}", report.seed);
        let known = ["people's speed", "still things' speed"];
        assert!(broken.iter().all(|name| known.contains(name)), "{broken:?}");
    }
    assert!(totals.to_string().contains("broken: people's speed: "));
}

#[test]
fn a_line_that_is_too_slow_is_named() {
    let options = Options {
        delay_ms: 200,
        ..promised()
    };
    let totals = many(LawKind::Avoid, 60, &options);
    assert!(totals.broken.contains_key("reaction time"));
    assert_eq!(totals.broken.len(), 1);
}

#[test]
fn the_same_seed_is_the_same_run_whatever_ran_before() {
    let config = RobotConfig::default();
    let outcome = |seed, law| {
        let run = run(seed, &promised(), &config, law, None).unwrap();
        (
            run.report.outcome,
            run.report.stops,
            run.simulation.trace().to_vec(),
        )
    };
    for law in [LawKind::Avoid, LawKind::Chaos, LawKind::Reckless] {
        assert!(outcome(5, law) == outcome(5, law), "{law:?}");
        assert!(outcome(5, law) != outcome(6, law), "{law:?}");
    }
    // However many threads there are.
    let texts = [1, 2].map(|threads| {
        let options = promised();
        let totals = run_many(7, 12, threads, &options, &config, LawKind::Avoid, |_| {});
        let totals = totals.unwrap();
        (totals.stops, totals.at_rest, totals.kinds.len())
    });
    assert_eq!(texts[0], texts[1]);
}

#[test]
fn a_run_can_be_looked_at() {
    let config = RobotConfig::default();
    let mut lines = Vec::new();
    let mut tell = |line| lines.push(line);
    let run = run(3, &promised(), &config, LawKind::Avoid, Some(&mut tell)).unwrap();
    assert_eq!(lines.len() as u64, run.report.ticks);
    assert!(
        lines
            .iter()
            .any(|line| line.contains("told") && line.contains("person"))
    );
    assert!(run.picture().contains("<svg"));
}

/// With a good line the age of what a command rests on is what the parts make up: a packet's
/// period, and the base's delay with the step in which it ends.
#[test]
fn the_reaction_time_is_measured_truly() {
    let config = RobotConfig::default();
    let scenario = Scenario::named("empty-room", &Knobs::default()).unwrap();
    for (delay_ms, longest) in [(0, 150), (30, 210)] {
        let line = link::Faults {
            delay_ms,
            ..link::Faults::default()
        };
        let host = pilot(&scenario, &config, settings(&config, false, None), Forward).unwrap();
        let mut ride = Ride::new(scenario.simulate().unwrap(), host, line, 1).unwrap();
        while ride.now() < 10_000 {
            ride.step();
        }
        let was = ride.simulation.truth().longest_reaction_ms;
        assert!(
            was > longest - 40 && was <= longest + 10,
            "{delay_ms}: {was}"
        );
        assert!(
            ride.simulation
                .truth()
                .broken(&assumptions(&config))
                .is_empty()
        );
        // A loop that hangs adds what it hangs.
        ride.stall(500);
        for _ in 0..100 {
            ride.step();
        }
        let was = ride.simulation.truth().longest_reaction_ms;
        assert!((550..=750).contains(&was), "{was}");
    }
}

/// Slowly straight on.
struct Forward;

impl sidestep::law::Law<16> for Forward {
    fn advise(&mut self, _: &sidestep::view::View<16>) -> sidestep::law::Advice {
        sidestep::law::Advice {
            speed: 0.2,
            turn_rate: 0.0,
        }
    }

    fn mode(&self) -> &'static str {
        "forward"
    }
}

#[test]
fn the_empty_room_is_crossed_as_fast_as_cruising_takes() {
    let config = RobotConfig::default();
    let scenario = Scenario::named("empty-room", &Knobs::default()).unwrap();
    let law = sidestep::avoid::Avoid::new(config.core);
    let (summary, simulation) = run_in_memory(&scenario, &config, law).unwrap();
    let arrived = summary.tally.arrived.expect("nothing is in the way");
    let mut samples = simulation.trace().iter();
    let started = samples.find(|sample| sample.speed > 0.0).unwrap().time_ms;
    let seconds = (arrived - started) as f64 / 1000.0;
    let core = &config.core;
    let (speed, acceleration) = (f64::from(core.cruise_speed), f64::from(core.acceleration));
    let way = 4.0 - f64::from(core.goal_tolerance);
    let least = way / speed + speed / (2.0 * acceleration);
    assert!(seconds <= 1.05 * least, "{seconds} s, {least} s would do");
}

#[test]
fn moving_again_is_told_from_the_way_being_free() {
    let config = RobotConfig::default();
    let mut told = 0;
    for seed in 0..10 {
        let knobs = Knobs {
            seed,
            ..Knobs::default()
        };
        let scenario = Scenario::named("blocked-way", &knobs).unwrap();
        let law = sidestep::avoid::Avoid::new(config.core);
        let (_, simulation) = run_in_memory(&scenario, &config, law).unwrap();
        let trace = simulation.trace();
        let free = scenario.way_free_ms(trace).expect("they leave");
        if let Some(after) = moving_again_ms(&scenario, trace, 0.02) {
            told += 1;
            let moving = trace.iter().find(|s| s.time_ms == free + after).unwrap();
            assert!(moving.speed > 0.02);
        }
        assert_eq!(moving_again_ms(&scenario, trace, 5.0), None);
    }
    assert!(told >= 5, "{told} of 10");
}
