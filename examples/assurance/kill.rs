//! Proof kill: for each mutant of a module, do the proofs alone notice?
//!
//! Mutants come from `cargo mutants`; each is made in a copy of the project, and the harnesses of the
//! module's chapter are run on it, quick ones first, until one fails or reaches less than it should.
//! What survives all of them is listed: a mistake that they would not notice.

use super::ledger::{self, Harness, Reader};
use super::source::root;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A harness that takes longer than this on a mutant has not verified it.
const LIMIT: Duration = Duration::from_secs(600);

/// What became of a mutant.
enum Fate {
    /// This harness failed, or did not reach what it covers.
    Noticed(String),
    /// It does not compile.
    Unviable,
    /// No verdict in time, which is no proof either.
    Undecided(String),
    Survived,
}

/// `kill MODULE [N [SKIP]]`: N mutants of the module, spread evenly, or all of them; without those at the
/// beginning that an earlier run has judged.
pub fn run(module: &str, words: &[&str]) -> Outcome {
    let mutants = mutants(module)?;
    let wanted = words
        .first()
        .map_or(Ok(mutants.len()), |word| word.parse())?;
    let step = (mutants.len() / wanted.clamp(1, mutants.len().max(1))).max(1);
    let skipped = words.get(1).map_or(Ok(0), |word| word.parse())?;
    let chosen = mutants.iter().step_by(step).take(wanted).skip(skipped);
    let chosen: Vec<&Value> = chosen.collect();
    let harnesses = ledger::harnesses();
    let rounds = rounds(module, &harnesses)?;
    let copy = copy()?;
    eprintln!(
        "{} of {} mutants of `{module}`, {} harnesses",
        chosen.len(),
        mutants.len(),
        rounds.iter().map(Vec::len).sum::<usize>()
    );
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    // What noticed one mistake is likely to notice the next, which is in the same function.
    let mut first: Option<String> = None;
    println!(
        "## Mutants of `{module}`, judged by proofs alone\n\n| mutant | noticed by |\n|---|---|"
    );
    for (number, mutant) in chosen.iter().enumerate() {
        let name = mutant["name"].as_str().unwrap_or_default();
        let begun = Instant::now();
        let file = mutant["file"].as_str().ok_or("a mutant without a file")?;
        let original = std::fs::read_to_string(root().join(file))?;
        std::fs::write(copy.join(file), mutated(&original, mutant)?)?;
        let fate = judge(&copy, first.as_ref(), &rounds, &harnesses)?;
        std::fs::write(copy.join(file), &original)?;
        let (kind, shown) = match &fate {
            Fate::Noticed(by) => ("noticed", by.clone()),
            Fate::Unviable => ("unviable", "does not compile".to_owned()),
            Fate::Undecided(by) => ("undecided", format!("no verdict in time: {by}")),
            Fate::Survived => ("survived", "**nothing**".to_owned()),
        };
        *counts.entry(kind).or_default() += 1;
        if let Fate::Noticed(by) = fate {
            first = Some(by);
        }
        println!("| {} | {shown} |", name.replace('|', "\\|"));
        eprintln!(
            "{}/{} {name}: {shown}, {:.0} s",
            number + 1,
            chosen.len(),
            begun.elapsed().as_secs_f64()
        );
    }
    let of = |kind| counts.get(kind).copied().unwrap_or(0);
    println!(
        "\n{} noticed, {} survived, {} undecided, {} do not compile; {} of {} mutants tried.",
        of("noticed"),
        of("survived"),
        of("undecided"),
        of("unviable"),
        chosen.len(),
        mutants.len()
    );
    Ok(())
}

/// The mutants of a module, as `cargo mutants` lists them.
fn mutants(module: &str) -> Outcome<Vec<Value>> {
    let [file, folder] = [format!("src/{module}.rs"), format!("src/{module}/**/*.rs")];
    let output = Command::new("cargo")
        .args(["mutants", "--list", "--json"])
        .args(["--file", &file, "--file", &folder])
        .current_dir(root())
        .output()?;
    if !output.status.success() {
        return Err("cargo mutants is not installed: cargo install --locked cargo-mutants".into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// The chapter's own harnesses, those that take a few seconds first. What other chapters' proofs
/// would notice as well is not asked, or each survivor would take the whole ledger.
fn rounds(module: &str, harnesses: &BTreeMap<String, Harness>) -> Outcome<[Vec<String>; 2]> {
    let (_, verdicts) = ledger::read_ledger(harnesses);
    let mut rounds = [const { Vec::new() }; 2];
    let own = format!("{module}::");
    for (name, harness) in harnesses.iter().filter(|(name, _)| name.starts_with(&own)) {
        // One that fails without a mistake would notice every one.
        let verdict = verdicts.get(name).filter(|verdict| verdict.holds(harness));
        let verdict = verdict.ok_or_else(|| format!("{name} is not verified: prove it first"))?;
        let slow = !verdict
            .seconds
            .parse()
            .is_ok_and(|seconds: f64| seconds <= 10.0);
        rounds[usize::from(slow)].push(name.clone());
    }
    Ok(rounds)
}

/// A copy of what is under version control, with a target folder of its own.
fn copy() -> Outcome<PathBuf> {
    let copy = root().join("target/kill");
    let listed = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .current_dir(root())
        .output()?;
    for name in String::from_utf8(listed.stdout)?.split('\0') {
        let from = root().join(name);
        if name.is_empty() || !from.is_file() {
            continue;
        }
        let to = copy.join(name);
        if let Some(folder) = to.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::copy(from, to)?;
    }
    Ok(copy)
}

/// The text with the mutant's piece replaced.
fn mutated(text: &str, mutant: &Value) -> Outcome<String> {
    let place = |end: &str| -> Option<usize> {
        let number = |what: &str| {
            let value = mutant["span"][end][what].as_u64()?;
            usize::try_from(value).ok()?.checked_sub(1)
        };
        let mut before = text.split_inclusive('\n');
        let mut offset = 0;
        for _ in 0..number("line")? {
            offset += before.next()?.len();
        }
        // Columns count characters.
        let column = before.next()?.char_indices().nth(number("column")?)?.0;
        Some(offset + column)
    };
    let (begin, end) = place("start")
        .zip(place("end"))
        .ok_or("a mutant without a place")?;
    let replacement = mutant["replacement"].as_str().ok_or("no replacement")?;
    Ok(format!("{}{replacement}{}", &text[..begin], &text[end..]))
}

/// Runs that harness first, then round after round on the copy until something is not as it should be.
fn judge(
    copy: &Path,
    first: Option<&String>,
    rounds: &[Vec<String>],
    harnesses: &BTreeMap<String, Harness>,
) -> Outcome<Fate> {
    let others = rounds.iter().map(|round| {
        let others = round.iter().filter(|name| Some(*name) != first);
        others.collect::<Vec<_>>()
    });
    for round in std::iter::once(first.into_iter().collect()).chain(others) {
        if round.is_empty() {
            continue;
        }
        let mut command = Command::new("cargo");
        command.args(["kani", "--output-format", "terse", "--exact"]);
        let limit = format!("{}s", LIMIT.as_secs());
        command.args(["-Z", "unstable-options", "--harness-timeout", &limit]);
        for name in &round {
            command.args(["--harness", &format!("proofs::{name}")]);
        }
        let mut run = command
            .current_dir(copy)
            .env_remove("CARGO_TARGET_DIR")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .process_group(0)
            .spawn()?;
        let output = run.stdout.take().ok_or("no output of cargo kani")?;
        let mut reader = Reader::default();
        let (mut done, mut timed_out, mut bad) = (0, false, None);
        for line in BufReader::new(output).lines() {
            let line = line?;
            timed_out |= line.contains("timed out");
            if let Some((name, verdict)) = reader.line(&line) {
                done += 1;
                let good = harnesses
                    .get(&name)
                    .is_some_and(|harness| verdict.is_good(harness));
                if !good {
                    bad = Some(name);
                    break;
                }
            }
        }
        // The next harness may be under way: everything of this run ends here.
        let group = format!("-{}", run.id());
        Command::new("kill")
            .args(["--", &group])
            .stderr(Stdio::null())
            .status()?;
        run.wait()?;
        match bad {
            Some(name) if timed_out => return Ok(Fate::Undecided(name)),
            Some(name) => return Ok(Fate::Noticed(name)),
            None if done == 0 => return Ok(Fate::Unviable),
            None if done < round.len() => return Err("cargo kani ended early".into()),
            None => {}
        }
    }
    Ok(Fate::Survived)
}
