//! Proof kill: for each mutant of a module, do the proofs alone notice?
//!
//! Mutants come from `cargo mutants`; each is made in a copy of the project, and the harnesses of the
//! module's chapter are run on it, quick ones first, until one fails or reaches less than it should.
//! What survives all of them is listed: a mistake that they would not notice.

use super::ledger::{self, Harness, Reader};
use super::source::root;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
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

/// `kill MODULE [PATTERN] [N [SKIP]]`: N mutants of the module or all of them, only those whose names have
/// the pattern, without as many at the beginning as an earlier run has judged. However many, they are
/// spread evenly.
pub fn run(module: &str, words: &[&str]) -> Outcome {
    let (pattern, numbers) = match words {
        [pattern, numbers @ ..] if pattern.parse::<usize>().is_err() => (*pattern, numbers),
        _ => ("", words),
    };
    let mutants = mutants(module, pattern)?;
    let wanted = numbers
        .first()
        .map_or(Ok(mutants.len()), |word| word.parse())?;
    let skipped = numbers.get(1).map_or(Ok(0), |word| word.parse())?;
    let chosen = spread(&mutants).into_iter().take(wanted).skip(skipped);
    let chosen: Vec<&Value> = chosen.collect();
    let harnesses = ledger::harnesses();
    let rounds = rounds(module, &harnesses)?;
    let copy = copy()?;
    let reached = reached(&copy, &rounds)?;
    eprintln!(
        "{} of {} mutants of `{module}`, {} harnesses",
        chosen.len(),
        mutants.len(),
        rounds.iter().map(Vec::len).sum::<usize>()
    );
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    // What noticed one mistake is likely to notice the next in that function, or any.
    let mut noticed: Vec<(&str, String)> = Vec::new();
    println!(
        "## Mutants of `{module}`, judged by proofs alone\n\n| mutant | noticed by |\n|---|---|"
    );
    for (number, mutant) in chosen.iter().enumerate() {
        let name = mutant["name"].as_str().unwrap_or_default();
        let begun = Instant::now();
        let file = mutant["file"].as_str().ok_or("a mutant without a file")?;
        let original = std::fs::read_to_string(root().join(file))?;
        std::fs::write(copy.join(file), mutated(&original, mutant)?)?;
        let function = mutant["function"]["function_name"].as_str().map(last_name);
        let asked = |name: &&String| function.is_none_or(|f| reached[*name].contains(f));
        let function = function.unwrap_or_default();
        let first = noticed
            .iter()
            .filter(|(_, name)| asked(&name))
            .max_by_key(|(of, _)| *of == function)
            .map(|(_, name)| name.clone());
        let others = rounds.iter().map(|round| {
            let others = round.iter().filter(|name| Some(*name) != first.as_ref());
            others.filter(asked).collect()
        });
        let rounds: Vec<Vec<&String>> = std::iter::once(first.iter().collect())
            .chain(others)
            .collect();
        let fate = judge(&copy, &rounds, &harnesses)?;
        std::fs::write(copy.join(file), &original)?;
        let (kind, shown) = match &fate {
            Fate::Noticed(by) => ("noticed", by.clone()),
            Fate::Unviable => ("unviable", "does not compile".to_owned()),
            Fate::Undecided(by) => ("undecided", format!("no verdict in time: {by}")),
            Fate::Survived => ("survived", "**nothing**".to_owned()),
        };
        *counts.entry(kind).or_default() += 1;
        if let Fate::Noticed(by) = fate {
            noticed.push((function, by));
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

/// In such an order that any number of them, from the beginning, is spread evenly: by the fractional
/// part of each one's number times the golden ratio.
fn spread(mutants: &[Value]) -> Vec<&Value> {
    let mut numbers: Vec<u32> = (0..).take(mutants.len()).collect();
    let key = |number: &u32| number.wrapping_mul(0x9E37_79B9);
    numbers.sort_by_key(key);
    numbers
        .iter()
        .map(|&number| &mutants[number as usize])
        .collect()
}

/// The mutants of a module, as `cargo mutants` lists them, whose names have that pattern.
fn mutants(module: &str, pattern: &str) -> Outcome<Vec<Value>> {
    let [file, folder] = [format!("src/{module}.rs"), format!("src/{module}/**/*.rs")];
    let output = Command::new("cargo")
        .args(["mutants", "--list", "--json"])
        .args(["--file", &file, "--file", &folder, "--re", pattern])
        .current_dir(root())
        .output()?;
    if !output.status.success() {
        return Err("cargo mutants is not installed: cargo install --locked cargo-mutants".into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Seconds up to which harnesses are run together: quick ones before any that take longer.
const ROUNDS: [f64; 4] = [3.0, 8.0, 16.0, f64::INFINITY];

/// The chapter's own harnesses, quick ones first. What other chapters' proofs would notice as well is not
/// asked, or each survivor would take the whole ledger.
fn rounds(
    module: &str,
    harnesses: &BTreeMap<String, Harness>,
) -> Outcome<[Vec<String>; ROUNDS.len()]> {
    let (_, verdicts) = ledger::read_ledger(harnesses);
    let mut rounds = [const { Vec::new() }; ROUNDS.len()];
    let own = format!("{module}::");
    for (name, harness) in harnesses.iter().filter(|(name, _)| name.starts_with(&own)) {
        // One that fails without a mistake would notice every one.
        let verdict = verdicts.get(name).filter(|verdict| verdict.holds(harness));
        let verdict = verdict.ok_or_else(|| format!("{name} is not verified: prove it first"))?;
        let seconds = verdict.seconds.parse().unwrap_or(f64::INFINITY);
        let round = ROUNDS.iter().take_while(|most| seconds > **most).count();
        rounds[round].push(name.clone());
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

/// The names of the functions that each harness's program has: a mutant of any other leaves that proof
/// as it is, so it need not be run. (A function that only the compiler runs, for a constant, is in no
/// program: its mutants may be called survivors without being any.)
fn reached(copy: &Path, rounds: &[Vec<String>]) -> Outcome<BTreeMap<String, BTreeSet<String>>> {
    let names = rounds.concat();
    let status = kani(copy, &names)
        .arg("--only-codegen")
        .stdout(Stdio::null())
        .status()?;
    if !status.success() {
        return Err("cargo kani does not compile the harnesses".into());
    }
    let mut written = Vec::new();
    for target in std::fs::read_dir(copy.join("target/kani"))? {
        let folder = target?.path().join("debug/deps");
        for file in std::fs::read_dir(folder).into_iter().flatten() {
            let file = file?;
            if file
                .path()
                .to_string_lossy()
                .ends_with(".kani-metadata.json")
            {
                written.push((file.metadata()?.modified()?, file.path()));
            }
        }
    }
    let (_, newest) = written.into_iter().max().ok_or("no metadata of Kani's")?;
    let metadata: Value = serde_json::from_slice(&std::fs::read(newest)?)?;
    let mut reached = BTreeMap::new();
    for harness in metadata["proof_harnesses"].as_array().into_iter().flatten() {
        let text = |what: &str| harness[what].as_str().ok_or("metadata of another kind");
        let name = text("pretty_name")?.trim_start_matches("proofs::");
        let map = text("goto_file")?.replace(".symtab.out", ".pretty_name_map.json");
        let map: BTreeMap<String, Option<String>> = serde_json::from_slice(&std::fs::read(map)?)?;
        let names = map
            .values()
            .flatten()
            .flat_map(|name| name.split(|letter: char| letter != '_' && !letter.is_alphanumeric()));
        reached.insert(name.to_owned(), names.map(str::to_owned).collect());
    }
    match names.iter().find(|name| !reached.contains_key(*name)) {
        Some(name) => Err(format!("no program of {name} in Kani's metadata").into()),
        None => Ok(reached),
    }
}

/// `admit` of `Surroundings<'_, N>::admit`.
fn last_name(function: &str) -> &str {
    function.rsplit("::").next().unwrap_or(function)
}

/// `cargo kani` on the copy, for these harnesses.
fn kani(copy: &Path, names: &[impl AsRef<str>]) -> Command {
    let mut command = Command::new("cargo");
    command.args(["kani", "--output-format", "terse", "--exact"]);
    for name in names {
        command.args(["--harness", &format!("proofs::{}", name.as_ref())]);
    }
    command.current_dir(copy).env_remove("CARGO_TARGET_DIR");
    command.stderr(Stdio::null());
    command
}

/// Runs round after round on the copy until something is not as it should be.
fn judge(
    copy: &Path,
    rounds: &[Vec<&String>],
    harnesses: &BTreeMap<String, Harness>,
) -> Outcome<Fate> {
    for round in rounds.iter().filter(|round| !round.is_empty()) {
        let limit = format!("{}s", LIMIT.as_secs());
        let mut run = kani(copy, round)
            .args(["-Z", "unstable-options", "--harness-timeout", &limit])
            .stdout(Stdio::piped())
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
