//! Is there room to act? Corridor, empty room, and a way that was blocked and is free again.
//!
//! `cargo run --release -p sidestep-hw --example claims -- [SEEDS] [KEY=VALUE …]`, where a key is a
//! configuration parameter as in the TOML file.

use sidestep_hw::base;
use sidestep_hw::config::{self, RobotConfig};
use sidestep_hw::demo::{Summary, run_in_memory};
use sidestep_hw::episodes::moving_again_ms;
use sidestep_hw::pilot::usual_law;
use sidestep_sim::Simulation;
use sidestep_sim::scenario::{Knobs, Scenario};
use std::error::Error;

/// Slower than this the robot does not count as moving again (m/s).
const MOVING: f64 = 0.02;

/// Within this time it is to do so (ms).
const PATIENCE: u64 = 5000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut seeds: u64 = 1000;
    let mut toml = String::new();
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            None => seeds = argument.parse()?,
            Some((key, value)) if value.parse::<f64>().is_ok() => {
                toml += &format!("{key} = {value}\n");
            }
            Some((key, value)) => toml += &format!("{key} = \"{}\"\n", value.trim_matches('"')),
        }
    }
    let config = config::parse(&toml, "arguments")?;
    corridor(&config)?;
    walker(&config, seeds / 10)?;
    empty_room(&config)?;
    blocked_way(&config, seeds)
}

fn ride(
    name: &str,
    knobs: &Knobs,
    config: &RobotConfig,
) -> Result<(Scenario, Summary, Simulation), Box<dyn Error>> {
    let mut scenario = Scenario::named(name, knobs)?;
    scenario.robot.base.radius = config.core.robot_radius.into();
    let law = usual_law(config.core, base::ring(config)?);
    let (summary, simulation) = run_in_memory(&scenario, config, law)?;
    Ok((scenario, summary, simulation))
}

fn knobs(seed: u64, courteous: bool) -> Knobs {
    let mut knobs = Knobs {
        seed,
        courteous,
        ..Knobs::default()
    };
    knobs.sonar_faults.dropout = 0.02;
    knobs
}

/// When the robot first moved (ms).
fn started(simulation: &Simulation) -> Option<u64> {
    let mut samples = simulation.trace().iter();
    samples
        .find(|sample| sample.speed > MOVING)
        .map(|sample| sample.time_ms)
}

fn corridor(config: &RobotConfig) -> Result<(), Box<dyn Error>> {
    let (_, summary, simulation) = ride("corridor", &knobs(1, true), config)?;
    let cruise = f64::from(config.core.cruise_speed);
    let outcome = &summary.outcome;
    let seconds = outcome
        .duration_ms
        .saturating_sub(started(&simulation).unwrap_or(0)) as f64
        / 1000.0;
    let speed = outcome.travelled / seconds;
    println!(
        "corridor: {:.1} m driven, {speed:.3} m/s from the first motion on = {:.0} % of the cruise \
         speed; arrived: {}; contacts while moving {}; stops {:?}",
        outcome.travelled,
        100.0 * speed / cruise,
        summary.tally.arrived.is_some(),
        summary.contacts_while_moving(),
        summary.tally.stops
    );
    Ok(())
}

fn walker(config: &RobotConfig, seeds: u64) -> Result<(), Box<dyn Error>> {
    for courteous in [true, false] {
        let (mut moving, mut resting, mut way) = (0, 0, 0.0);
        let mut failures = Vec::new();
        for seed in 0..seeds.max(1) {
            let (_, summary, _) = ride("corridor-walker", &knobs(seed, courteous), config)?;
            moving += summary.contacts_while_moving();
            resting += summary.outcome.contacts_at_rest.people;
            way += summary.outcome.travelled;
            if summary.contacts_while_moving() > 0 {
                failures.push(seed);
            }
        }
        println!(
            "corridor-walker, courteous {courteous}: {seeds} seeds, contacts while moving {moving} \
             (seeds {failures:?}), at rest {resting}, {:.1} m driven on average",
            way / seeds.max(1) as f64
        );
    }
    Ok(())
}

fn empty_room(config: &RobotConfig) -> Result<(), Box<dyn Error>> {
    let (scenario, summary, simulation) = ride("empty-room", &knobs(1, true), config)?;
    let core = &config.core;
    let (cruise, acceleration) = (f64::from(core.cruise_speed), f64::from(core.acceleration));
    let way = (scenario.goal - scenario.start.position).norm() - f64::from(core.goal_tolerance);
    // Speeding up costs v/2A over driving at v all the way.
    let ideal = way / cruise + cruise / (2.0 * acceleration);
    let begun = started(&simulation).unwrap_or(0);
    match summary.tally.arrived {
        Some(arrived) => {
            let seconds = (arrived - begun) as f64 / 1000.0;
            println!(
                "empty-room: {seconds:.1} s from the first motion to the goal; nothing but speeding \
                 up and cruising takes {ideal:.1} s: {:+.1} %",
                100.0 * (seconds / ideal - 1.0)
            );
        }
        None => println!("empty-room: not arrived, stops {:?}", summary.tally.stops),
    }
    Ok(())
}

fn blocked_way(config: &RobotConfig, seeds: u64) -> Result<(), Box<dyn Error>> {
    let (mut blocked, mut again, mut contacts, mut arrived) = (0, 0, 0, 0);
    let mut stuck = Vec::new();
    let mut touched = Vec::new();
    for seed in 0..seeds {
        let (scenario, summary, simulation) = ride("blocked-way", &knobs(seed, true), config)?;
        arrived += u64::from(summary.tally.arrived.is_some());
        if summary.contacts_while_moving() > 0 {
            contacts += 1;
            touched.push(seed);
        }
        let trace = simulation.trace();
        if scenario.way_free_ms(trace).is_none() {
            continue;
        }
        blocked += 1;
        match moving_again_ms(&scenario, trace, MOVING) {
            Some(ms) if ms <= PATIENCE => again += 1,
            _ => stuck.push(seed),
        }
    }
    stuck.truncate(20);
    touched.truncate(20);
    println!(
        "blocked-way: {seeds} seeds, in {blocked} somebody left the way; moving within 5 s after that \
         in {again}; not in {} (first seeds {stuck:?}); arrived in {arrived}; contacts while moving \
         in {contacts} (first seeds {touched:?})",
        blocked - again
    );
    Ok(())
}
