//! Meetings with people in virtual time, under S3's law: contacts, stops, valleys driven through.
//!
//! `cargo run --release -p sidestep-hw --example meetings -- COUNT [KEY=VALUE …]`, where a key is
//! - `seed`: the first one; `threads`;
//! - `draw`: a folder for pictures of the first failures, or of all meetings if there are up to ten,
//!   each with a list of every decision;
//! - `speed`: the fastest that people are (m/s), the greatest speed of the promise unless given;
//! - `story`: `fig8`, `fig9` or `make-way` in place of random meetings.

use sidestep::interact;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::encounter::{self, Conduct};
use sidestep_hw::episodes::{Totals, assumptions};
use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count: u64 = arguments
        .next()
        .ok_or("give a number of meetings")?
        .parse()?;
    let config = RobotConfig::default();
    let (mut first, mut threads) = (0, 2);
    let mut speed = assumptions(&config).person_speed;
    let mut folder: Option<PathBuf> = None;
    let mut story: Option<String> = None;
    for argument in arguments {
        let (key, value) = argument.split_once('=').ok_or("KEY=VALUE")?;
        match key {
            "seed" => first = value.parse()?,
            "threads" => threads = value.parse()?,
            "draw" => folder = Some(value.into()),
            "speed" => speed = value.parse()?,
            "story" => story = Some(value.to_owned()),
            _ => return Err(format!("unknown key {key}").into()),
        }
    }
    let meeting = |seed| match &story {
        Some(name) => encounter::story(name, seed),
        None => encounter::random(seed, speed, &config),
    };
    let begun = Instant::now();
    let next = AtomicU64::new(0);
    let work = || -> Result<(Totals, Conduct), String> {
        let (mut totals, mut conduct) = (Totals::default(), Conduct::default());
        loop {
            let done = next.fetch_add(1, Ordering::Relaxed);
            if done >= count {
                return Ok((totals, conduct));
            }
            if done > 0 && done.is_multiple_of(1000) {
                let seconds = begun.elapsed().as_secs_f64();
                eprintln!("{done} of {count} after {seconds:.0} s");
            }
            let met = meeting(first + done)
                .and_then(|meeting| encounter::run(&meeting, &config, interact::USUAL, None))
                .map_err(|error| error.to_string())?;
            conduct.add(&met);
            totals.add(met.report);
        }
    };
    let (mut totals, mut conduct) = (Totals::default(), Conduct::default());
    std::thread::scope(|scope| -> Result<(), Box<dyn Error>> {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            let (part, manner) = worker.join().map_err(|_| "a meeting could not be run")??;
            totals.merge(part);
            conduct.merge(manner);
        }
        Ok(())
    })?;
    println!(
        "seeds {first} to {}, people up to {speed:.2} m/s",
        first + count.max(1) - 1
    );
    print!("{totals}");
    let [driven, passed] = conduct.valleys;
    println!("through a valley:            {driven} meetings, {passed} of them to its end");
    for (state, count) in &conduct.entered {
        println!("  {state:<18} {count:>9}");
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{seconds:.1} s, {:.0} meetings per second",
        count as f64 / seconds
    );
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
            let met = encounter::run(&meeting(seed)?, &config, interact::USUAL, Some(&mut tell))?;
            std::fs::write(folder.join(format!("seed-{seed}.svg")), met.picture())?;
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
