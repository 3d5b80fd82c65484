//! Are walls ever taken for obstacles, and boxes seen in time? Corridors by the thousand.
//!
//! `cargo run --release -p sidestep-hw --example corridors -- [RUNS] [classical=0.42]`: `classical`
//! is the range (m) below which the classical detector stops, which looks on in the same runs. Ends
//! with an error if a wall was detected, a box was not in time, or anything was touched.

use sidestep::config::{Config, Parameters};
use sidestep::preset;
use sidestep_hw::config::RobotConfig;
use sidestep_hw::edge::{Corridors, corridor_base, narrowest, random};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut runs: u64 = 1000;
    let mut classical = 0.42;
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            None => runs = argument.parse()?,
            Some(("classical", metres)) => classical = metres.parse()?,
            Some((key, _)) => return Err(format!("unknown {key}").into()),
        }
    }
    let mut wrong = 0;
    for with_box in [false, true] {
        let sum = drive(runs, with_box, classical)?;
        wrong += sum.walls_detected + sum.boxes_nearer + sum.boxes_missed + sum.contacts;
        println!("{}", text(&sum, with_box, classical));
    }
    passages()?;
    if wrong > 0 {
        return Err(format!("{wrong} walls detected, boxes not in time or things touched").into());
    }
    Ok(())
}

/// What the shield lets through.
fn passages() -> Result<(), Box<dyn Error>> {
    let corridor = corridor_base()?;
    let pioneer = Parameters {
        min_distance: 0.05,
        turn_distance: 0.1,
        ..preset::PIONEER_3DX
    };
    let trusting = Parameters {
        still_speed_max: preset::CORRIDOR_BASE.still_speed_max,
        still_speed_max_turning: preset::CORRIDOR_BASE.still_speed_max_turning,
        range_error: preset::CORRIDOR_BASE.range_error,
        resume_clearance: preset::CORRIDOR_BASE.resume_clearance,
        ..pioneer
    };
    println!("narrowest way past an obstacle in a corridor of 1200 mm:");
    for (name, core) in [
        (
            "a base of 0.2 m radius, still things up to 0.05 m/s",
            *corridor.core.parameters(),
        ),
        ("a P3-DX (0.301 m), still things up to 0.05 m/s", trusting),
        ("a P3-DX, still things up to 0.3 m/s", pioneer),
    ] {
        let config = RobotConfig {
            core: Config::new(core)?,
            ..corridor
        };
        let narrowest = narrowest(&config)?;
        let width = narrowest.map_or("none".to_owned(), |mm| format!("{mm} mm"));
        println!("  {name}: {width}");
    }
    Ok(())
}

/// As many corridors as asked for, shared out over two threads.
fn drive(runs: u64, with_box: bool, classical: f64) -> Result<Corridors, Box<dyn Error>> {
    const THREADS: u64 = 2;
    let share = |first: u64| -> Result<Corridors, String> {
        let mut sum = Corridors::default();
        for seed in (first..runs).step_by(THREADS as usize) {
            let wrong = |error: Box<dyn Error>| format!("seed {seed}: {error}");
            let course = random(seed, with_box, classical).map_err(wrong)?;
            sum.add(&course, &course.run().map_err(wrong)?, with_box);
            if sum.runs.is_multiple_of(500) {
                eprintln!("{} of {}", sum.runs, runs / THREADS);
            }
        }
        Ok(sum)
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..THREADS)
            .map(|first| scope.spawn(move || share(first)))
            .collect();
        let mut sum = Corridors::default();
        for worker in workers {
            let part = worker.join().map_err(|_| "a worker failed")??;
            sum = sum.plus(part);
        }
        Ok(sum)
    })
}

fn text(sum: &Corridors, with_box: bool, classical: f64) -> String {
    let share = |count: u64| 100.0 * count as f64 / sum.runs.max(1) as f64;
    let mut lines = vec![
        format!(
            "{} corridors 1200 to 2400 mm wide, {}:",
            sum.runs,
            if with_box {
                "with a box of 100 to 600 mm on the edge"
            } else {
                "nothing in them"
            }
        ),
        format!("  walls taken for obstacles: {}", sum.walls_detected),
    ];
    if with_box {
        lines.extend([
            format!(
                "  box detected, 300 mm or more before the sonar: {} ({:.2} %)",
                sum.boxes_before_300,
                share(sum.boxes_before_300)
            ),
            format!(
                "  stopped by the shield before that: {} ({:.2} %)",
                sum.boxes_by_shield,
                share(sum.boxes_by_shield)
            ),
            format!(
                "  box nearer when the robot began, which did not set off: {} ({:.2} %)",
                sum.boxes_at_start,
                share(sum.boxes_at_start)
            ),
            format!(
                "  driven nearer than that before it was detected: {}",
                sum.boxes_nearer
            ),
            format!("  drove past it: {}", sum.boxes_missed),
        ]);
    } else {
        lines.push(format!("  edge covered: {}", sum.covered));
    }
    lines.extend([
        format!("  held up by the shield, beside a wall: {}", sum.held_by_wall),
        format!("  stopped for good by a latched stop of the shield: {}", sum.latched),
        format!("  nothing happened in 60 s: {}", sum.out_of_time),
        format!("  contacts while moving: {}", sum.contacts),
        format!(
            "  a classical detector ({:.0} mm on any forward sonar) stops for a wall in {} ({:.1} %)",
            1000.0 * classical,
            sum.classical_false,
            share(sum.classical_false)
        ),
    ]);
    lines.join("\n")
}
