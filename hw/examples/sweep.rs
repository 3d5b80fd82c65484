//! Seeds of a scenario in virtual time: contacts, arrivals, stops.
//!
//! `cargo run --release -p sidestep-hw --example sweep -- SCENARIO SEEDS [KEY=VALUE …]`, where a
//! key is a configuration parameter as in the TOML file, or one of the simulation's: `dropout`,
//! `false_echo`, `courteous`, `speed_limit` (m/s, of people), `ping_ms` (sonars one by one).

use sidestep_hw::pilot::usual_law;
use sidestep_hw::{base, config, demo};
use sidestep_sim::robot::Firing;
use sidestep_sim::scenario::{Knobs, Scenario};
use std::collections::BTreeMap;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("give a scenario")?;
    let seeds: u64 = arguments.next().ok_or("give a number of seeds")?.parse()?;
    let mut knobs = Knobs {
        courteous: false,
        ..Knobs::default()
    };
    let mut speed_limit = 0.8;
    let mut ping_ms = 0;
    let mut toml = String::new();
    for argument in arguments {
        let (key, value) = argument.split_once('=').ok_or("KEY=VALUE")?;
        match key {
            "dropout" => knobs.sonar_faults.dropout = value.parse()?,
            "false_echo" => knobs.sonar_faults.false_echo = value.parse()?,
            "ping_ms" => ping_ms = value.parse()?,
            "speed_limit" => speed_limit = value.parse()?,
            "courteous" => knobs.courteous = value.parse()?,
            _ => toml += &format!("{key} = {value}\n"),
        }
    }
    let config = config::parse(&toml, "arguments")?;
    let (mut moving, mut resting, mut arrived, mut seconds) = (0, 0, 0, 0.0);
    let mut nearest = f64::INFINITY;
    let mut stops: BTreeMap<String, u64> = BTreeMap::new();
    for seed in 0..seeds {
        knobs.seed = seed;
        let mut scenario = Scenario::named(&name, &knobs)?.randomised(seed, speed_limit)?;
        if ping_ms > 0 {
            scenario.robot.firing = Firing::RoundRobin { ping_ms };
        }
        let (summary, _) = demo::run_in_memory(
            &scenario,
            &config,
            usual_law(config.core, base::ring(&config)?),
        )?;
        if summary.contacts_while_moving() > 0 && moving < 10 {
            println!("seed {seed}: {:?}", summary.outcome);
        }
        moving += summary.contacts_while_moving();
        resting += summary.outcome.contacts_at_rest.people;
        if let Some(t) = summary.tally.arrived {
            arrived += 1;
            seconds += t as f64 / 1000.0;
        }
        let least = summary.outcome.minimum_clearance_while_driving;
        nearest = nearest.min(least.people).min(least.obstacles);
        for (kind, count) in summary.tally.stops {
            *stops.entry(kind).or_default() += count;
        }
    }
    println!(
        "{name}: {seeds} seeds, contacts while moving {moving}, at rest {resting}, arrived {arrived} \
         (mean {:.1} s), least clearance while driving {nearest:.3} m, stops {stops:?}",
        seconds / f64::from(arrived.max(1))
    );
    Ok(())
}
