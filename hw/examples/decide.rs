//! S1 alone against S1 with S2's decision, and that with what appears heard twice, on the same seeds,
//! under bad sonars.
//!
//! `cargo run --release -p sidestep-hw --example decide -- [SEEDS] [KEY=VALUE …]`, where a key is a
//! configuration parameter as in the TOML file, or one of `scenario`, `false_echo`, `dropout`,
//! `courteous`, and `table_1` (S2's Table 1 for the robot: yes, the usual, or no). Without
//! `false_echo` a tenth of each sonar's readings are false echoes and a tenth of its echoes are lost.
//!
//! Ends with an error if the robot touched anything while it moved.

use sidestep_hw::{config, decide};
use sidestep_sim::scenario::{APPROACH, Knobs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let seeds = match arguments.peek() {
        Some(first) if !first.contains('=') => {
            let seeds = first.parse()?;
            arguments.next();
            seeds
        }
        _ => 1_000,
    };
    let mut knobs = Knobs::default();
    knobs.sonar_faults.false_echo = 0.1;
    knobs.sonar_faults.dropout = 0.1;
    let mut scenario = APPROACH.to_owned();
    let (mut table_1, mut toml) = (true, String::new());
    for argument in arguments {
        let (key, value) = argument.split_once('=').ok_or("KEY=VALUE")?;
        match key {
            "scenario" => scenario = value.to_owned(),
            "false_echo" => knobs.sonar_faults.false_echo = value.parse()?,
            "dropout" => knobs.sonar_faults.dropout = value.parse()?,
            "courteous" => knobs.courteous = value.parse()?,
            "table_1" => table_1 = value == "yes",
            _ => toml += &format!("{key} = \"{value}\"\n"),
        }
    }
    if table_1 {
        toml += decide::TABLE_1;
    }
    let config = config::parse(&toml, "arguments")?;
    let comparison = decide::compare(&scenario, seeds, &knobs, &config, |done| {
        if done.is_multiple_of(100) {
            eprintln!("{done} of {seeds} seeds");
        }
    })?;
    let faults = knobs.sonar_faults;
    println!(
        "{scenario}: {seeds} seeds, false echoes {}, lost echoes {} of each sonar's readings",
        faults.false_echo, faults.dropout
    );
    print!("{}", comparison.table());
    let counts = [comparison.alone, comparison.decided, comparison.heard_twice];
    match counts.iter().map(|count| count.contacts).sum() {
        0_u32 => Ok(()),
        contacts => Err(format!("{contacts} contacts while the robot moved").into()),
    }
}
