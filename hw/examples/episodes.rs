//! Randomised episodes in virtual time: contacts, stops, broken assumptions.
//!
//! `cargo run --release -p sidestep-hw --example episodes -- COUNT [KEY=VALUE …]`, where a key is
//! - `law`: `avoid` (the default), `chaos` or `reckless`;
//! - `seed`: the first one; `threads`;
//! - `draw`: a folder for pictures of the first failures, or of all episodes if there are up to ten,
//!   each with a list of every decision;
//! - `speed`: the fastest that people are (m/s), the greatest speed of the promise unless given;
//! - `dropout`, `false_echo`, `noise`, `delay_ms`, `time_limit_ms`: of the episodes;
//! - or a configuration parameter as in the TOML file.

use sidestep_hw::config;
use sidestep_hw::episodes::{LawKind, assumptions, run, run_many};
use sidestep_sim::episode::Options;
use std::path::PathBuf;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let count: u64 = arguments
        .next()
        .ok_or("give a number of episodes")?
        .parse()?;
    let mut options = Options::default();
    let (mut law, mut first, mut threads) = (LawKind::Avoid, 0, 2);
    let mut speed = None;
    let mut folder: Option<PathBuf> = None;
    let mut toml = String::new();
    for argument in arguments {
        let (key, value) = argument.split_once('=').ok_or("KEY=VALUE")?;
        match key {
            "law" => law = LawKind::named(value).ok_or("law is avoid, chaos or reckless")?,
            "seed" => first = value.parse()?,
            "threads" => threads = value.parse()?,
            "draw" => folder = Some(value.into()),
            "speed" => speed = Some(value.parse()?),
            "dropout" => options.dropout = value.parse()?,
            "false_echo" => options.false_echo = value.parse()?,
            "noise" => options.noise = value.parse()?,
            "delay_ms" => options.delay_ms = value.parse()?,
            "time_limit_ms" => options.time_limit_ms = value.parse()?,
            // Words and quantities are text in the file, and counts are not.
            _ if value.parse::<f64>().is_ok() => toml += &format!("{key} = {value}\n"),
            _ => toml += &format!("{key} = \"{}\"\n", value.trim_matches('"')),
        }
    }
    let config = config::parse(&toml, "arguments")?;
    let promise = assumptions(&config).person_speed;
    options.person_speed = speed.unwrap_or(promise);
    options.robot_radius = config.core.robot_radius.into();
    let begun = Instant::now();
    let totals = run_many(first, count, threads, &options, &config, law, |done| {
        if done > 0 && done.is_multiple_of(2000) {
            let seconds = begun.elapsed().as_secs_f64();
            eprintln!("{done} of {count} after {seconds:.0} s");
        }
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "law {law:?}, seeds {first} to {}, people up to {:.2} m/s (promise: {promise:.2})",
        first + count.max(1) - 1,
        options.person_speed
    );
    print!("{totals}");
    let rate = count as f64 / seconds;
    println!("{seconds:.1} s, {rate:.0} episodes per second");
    if let Some(folder) = folder {
        std::fs::create_dir_all(&folder)?;
        let failures: Vec<u64> = totals.failures.keys().copied().collect();
        let seeds = if count <= 10 {
            (first..first + count).collect()
        } else {
            failures
        };
        for seed in seeds {
            let mut lines = String::new();
            let mut tell = |line: String| lines += &(line + "\n");
            let run = run(seed, &options, &config, law, Some(&mut tell))?;
            std::fs::write(folder.join(format!("seed-{seed}.svg")), run.picture())?;
            std::fs::write(folder.join(format!("seed-{seed}.txt")), lines)?;
        }
    }
    if totals.failed_unexplained > 0 {
        return Err(
            "the robot was in contact while it moved, although every assumption held".into(),
        );
    }
    Ok(())
}
