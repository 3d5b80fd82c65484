//! Writes the proof ledger from what Kani printed.
//!
//! `cargo kani --output-format terse | cargo run -p sidestep-spec --bin ledger -- VERSIONS > proofs/LEDGER.md`,
//! where VERSIONS is one line that names the tools and the machine. What each harness shows and
//! assumes is taken from its doc comment in `proofs/*.rs`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Read as _;

/// A harness as its source tells.
#[derive(Default)]
struct Harness {
    shows: String,
    invariants: Vec<String>,
    solver: String,
    unwind: String,
    stubs: usize,
}

/// A harness as Kani judged it.
#[derive(Default)]
struct Verdict {
    successful: bool,
    checks: String,
    covers: String,
    seconds: f64,
}

/// The text between two marks.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<&'a str> {
    let rest = &text[text.find(from)? + from.len()..];
    rest.find(to).map(|end| &rest[..end])
}

/// The harnesses of one file, by name.
fn harnesses(chapter: &str, text: &str, found: &mut BTreeMap<String, Harness>) {
    let mut harness = Harness::default();
    let mut proof = false;
    for line in text.lines() {
        if let Some(doc) = line.strip_prefix("/// ") {
            if !harness.shows.is_empty() {
                harness.shows.push(' ');
            }
            harness.shows += doc;
        } else if let Some(invariant) = line.strip_prefix("//= ") {
            harness.invariants.push(invariant.to_owned());
        } else if let Some(rest) = line.strip_prefix("pub fn ") {
            let name = rest.split('(').next().unwrap_or(rest);
            if proof {
                found.insert(format!("{chapter}::{name}"), std::mem::take(&mut harness));
            }
            harness = Harness::default();
            proof = false;
        } else {
            proof |= line.contains("kani::proof");
            harness.stubs += usize::from(line.contains("kani::stub("));
            if let Some(solver) = between(line, "kani::solver(", ")") {
                harness.solver = solver.to_owned();
            }
            if let Some(unwind) = between(line, "kani::unwind(", ")") {
                harness.unwind = unwind.to_owned();
            }
            if !line.trim_start().starts_with(['#', ' ', 'k', ')', ']']) && !line.is_empty() {
                harness = Harness::default();
            }
        }
    }
}

/// What Kani printed, by harness.
fn verdicts(output: &str) -> BTreeMap<String, Verdict> {
    let mut found = BTreeMap::new();
    let mut name = String::new();
    for line in output.lines() {
        let line = line.trim();
        if let Some(harness) = between(line, "Checking harness proofs::", "...") {
            name = harness.to_owned();
            found.insert(name.clone(), Verdict::default());
        }
        let Some(verdict) = found.get_mut(&name) else {
            continue;
        };
        if let Some(covers) = between(line, "** ", " cover properties satisfied") {
            verdict.covers = covers.to_owned();
        } else if let Some(checks) = between(line, "** ", " failed") {
            verdict.checks = checks.to_owned();
        } else if line == "VERIFICATION:- SUCCESSFUL" {
            verdict.successful = true;
        } else if let Some(seconds) = between(line, "Verification Time: ", "s") {
            verdict.seconds = seconds.parse().unwrap_or(f64::NAN);
        }
    }
    found
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let versions = std::env::args().nth(1).unwrap_or_default();
    let mut output = String::new();
    std::io::stdin().read_to_string(&mut output)?;
    let verdicts = verdicts(&output);
    let mut found = BTreeMap::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../proofs");
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let (Some(stem), Some(extension)) = (path.file_stem(), path.extension()) else {
            continue;
        };
        if extension == "rs" {
            let text = std::fs::read_to_string(&path)?;
            harnesses(&stem.to_string_lossy(), &text, &mut found);
        }
    }

    let total: f64 = verdicts.values().map(|verdict| verdict.seconds).sum();
    let proved = found
        .keys()
        .filter(|name| {
            verdicts
                .get(*name)
                .is_some_and(|verdict| verdict.successful)
        })
        .count();
    let mut text = format!(
        "# Proof ledger\n\n\
         Generated from a run of `cargo kani`; do not edit. See CONTRIBUTING for the command.\n\n\
         {versions}\n\n\
         {proved} of {} harnesses verified, {total:.0} s in all.\n\n\
         | harness | invariants | result | s | failed checks | covers | solver, unwind, stubs | what it shows, and on which domain |\n\
         |---|---|---|---|---|---|---|---|\n",
        found.len()
    );
    for (name, harness) in &found {
        let (result, seconds, checks, covers) = match verdicts.get(name) {
            Some(verdict) => (
                if verdict.successful {
                    "verified"
                } else {
                    "FAILED"
                },
                format!("{:.1}", verdict.seconds),
                verdict.checks.as_str(),
                verdict.covers.as_str(),
            ),
            None => ("NOT RUN", String::new(), "", ""),
        };
        let _ = writeln!(
            text,
            "| {name} | {} | {result} | {seconds} | {checks} | {covers} | {}{}{} | {} |",
            harness.invariants.join(", "),
            if harness.solver.is_empty() {
                "default"
            } else {
                &harness.solver
            },
            if harness.unwind.is_empty() {
                String::new()
            } else {
                format!(", {}", harness.unwind)
            },
            if harness.stubs == 0 {
                String::new()
            } else {
                format!(", {} stubs", harness.stubs)
            },
            harness.shows.replace('|', "\\|"),
        );
    }
    print!("{text}");
    if proved < found.len() {
        return Err(format!("{} harnesses are not verified", found.len() - proved).into());
    }
    Ok(())
}
