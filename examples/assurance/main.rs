//! The assurance case, written and checked: what verifies what, and what Kani said.
//!
//! ```sh
//! cargo run --example assurance -- matrix           # writes spec/MATRIX.md, and the ledger
//! cargo run --example assurance -- prove            # runs the proofs whose code has changed
//! cargo run --example assurance -- prove --all -j 2 # all of them, two at a time
//! cargo run --example assurance -- prove shield::   # those whose names begin so
//! cargo run --example assurance -- check            # what is missing, stale or wrong
//! cargo run --example assurance -- kill shield      # do the proofs notice mistakes? (hours)
//! ```
//!
//! `prove` needs `cargo kani`, and writes `proofs/LEDGER.md` after every harness. `check` is what
//! `cargo test --test traceability` does.

mod book;
mod kill;
mod ledger;
mod matrix;
mod source;

use std::io::{BufRead as _, BufReader};
use std::process::{Command, ExitCode, Stdio};

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["matrix"] => write_matrix(),
        ["prove", ref rest @ ..] => prove(rest),
        ["check"] => check(),
        ["kill", module, ref rest @ ..] => kill::run(module, rest),
        _ => Err(
            "matrix, prove [--all] [-j N] [NAME…], check, or kill MODULE [PATTERN] [N [SKIP]]"
                .into(),
        ),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn write_matrix() -> Outcome {
    let matrix = matrix::Matrix::of_sources();
    std::fs::write(source::root().join(matrix::PATH), matrix.markdown())?;
    // The ledger keeps its verdicts; what it says of the harnesses follows the sources.
    let harnesses = ledger::harnesses();
    let (by, verdicts) = ledger::read_ledger(&harnesses);
    let text = ledger::markdown(&harnesses, &verdicts, &by);
    std::fs::write(source::root().join(ledger::PATH), text)?;
    report(&matrix.wrong)
}

fn check() -> Outcome {
    let harnesses = ledger::harnesses();
    let mut wrong = matrix::Matrix::of_sources().wrong;
    wrong.extend(ledger::wrong(
        &harnesses,
        &ledger::read_ledger(&harnesses).1,
    ));
    report(&wrong)
}

fn report(wrong: &[String]) -> Outcome {
    for line in wrong {
        println!("{line}");
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(format!("{} things are wrong", wrong.len()).into())
    }
}

/// The first line that a program prints about itself.
fn version(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = text.lines().next()?.trim();
    output.status.success().then(|| line.to_owned())
}

fn prove(words: &[&str]) -> Outcome {
    let mut all = false;
    let mut threads = "1";
    let mut names = Vec::new();
    let mut rest = words.iter();
    while let Some(&word) = rest.next() {
        match word {
            "--all" => all = true,
            "-j" => threads = rest.next().ok_or("-j needs a number")?,
            name => names.push(name),
        }
    }
    let kani = version("cargo", &["kani", "--version"]).ok_or(
        "cargo kani is not installed: cargo install --locked kani-verifier && cargo kani setup",
    )?;
    let harnesses = ledger::harnesses();
    let (mut by, mut verdicts) = ledger::read_ledger(&harnesses);
    let chosen: Vec<&String> = harnesses
        .iter()
        .filter(|(name, harness)| {
            let stale = verdicts
                .get(*name)
                .is_none_or(|verdict| !verdict.holds(harness));
            let named = names.iter().any(|begin| name.starts_with(begin));
            if names.is_empty() {
                all || stale
            } else {
                named
            }
        })
        .map(|(name, _)| name)
        .collect();
    println!(
        "{kani}: {} of {} harnesses to run",
        chosen.len(),
        harnesses.len()
    );
    if !chosen.is_empty() {
        let mut command = Command::new("cargo");
        command.args(["kani", "--output-format", "terse", "-j", threads, "--exact"]);
        for name in &chosen {
            command.args(["--harness", &format!("proofs::{name}")]);
        }
        let mut run = command
            .current_dir(source::root())
            .stdout(Stdio::piped())
            .spawn()?;
        let cbmc = version("cbmc", &["--version"]).map_or_else(String::new, |version| {
            format!(", CBMC {}", version.split(' ').next().unwrap_or(&version))
        });
        let rustc = version("rustc", &["--version"]).unwrap_or_default();
        by = format!("{kani}{cbmc}, {rustc}; {threads} at a time.");
        let mut reader = ledger::Reader::default();
        let output = run.stdout.take().ok_or("no output of cargo kani")?;
        let (mut done, begun) = (0, std::time::Instant::now());
        for line in BufReader::new(output).lines() {
            let line = line?;
            let Some((name, mut verdict)) = reader.line(&line) else {
                continue;
            };
            done += 1;
            println!(
                "{:5.0} s  {done}/{}  {name}: {} in {} s, covers {}",
                begun.elapsed().as_secs_f64(),
                chosen.len(),
                verdict.result,
                verdict.seconds,
                verdict.covers
            );
            if let Some(harness) = harnesses.get(&name) {
                verdict.digest.clone_from(&harness.digest);
            }
            verdicts.insert(name, verdict);
            let text = ledger::markdown(&harnesses, &verdicts, &by);
            std::fs::write(source::root().join(ledger::PATH), text)?;
        }
        let status = run.wait()?;
        if done < chosen.len() {
            return Err(format!("cargo kani ended early: {status}").into());
        }
    }
    let text = ledger::markdown(&harnesses, &verdicts, &by);
    std::fs::write(source::root().join(ledger::PATH), text)?;
    verdicts.retain(|name, _| harnesses.contains_key(name));
    report(&ledger::wrong(&harnesses, &verdicts))
}
