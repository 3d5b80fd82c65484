//! The proof ledger: what Kani said of each harness, and of which code.

use super::source::{self, Folder, Item, files, read, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Where it stands.
pub const PATH: &str = "proofs/LEDGER.md";

/// A harness as its source tells.
pub struct Harness {
    /// What its doc comment says: what it shows, and on which domain.
    pub shows: String,
    pub invariants: BTreeSet<String>,
    pub solver: String,
    pub unwind: String,
    /// Functions that something else stands in for.
    pub stubs: Vec<String>,
    /// Conditions that it assumes, and the helpers that bring more of them.
    pub assumes: Vec<String>,
    /// Cover properties in its text or in its helpers'.
    pub covers: usize,
    /// Of everything that Kani is given: the harness, its helpers, and the modules they lead to.
    pub digest: String,
}

/// A harness as Kani judged it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Verdict {
    /// `verified`, `FAILED`.
    pub result: String,
    pub seconds: String,
    /// `0 of 124`: failed of all.
    pub checks: String,
    /// `2 of 2`: satisfied of all.
    pub covers: String,
    /// That of the harness when it ran.
    pub digest: String,
}

impl Verdict {
    /// Whether it verified, and reached what the harness has to reach. Kani counts a cover property
    /// again where the compiler has copied its block, and the copy may be dead.
    pub fn is_good(&self, harness: &Harness) -> bool {
        let counts = self.covers.split_once(" of ");
        let reached = counts.is_some_and(|(met, all)| {
            met == all || met.parse().is_ok_and(|met: usize| met >= harness.covers)
        });
        self.result == "verified" && reached
    }

    /// The same, of the code as it is.
    pub fn holds(&self, harness: &Harness) -> bool {
        self.digest == harness.digest && self.is_good(harness)
    }
}

/// The text between two marks.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<&'a str> {
    let rest = &text[text.find(from)? + from.len()..];
    rest.find(to).map(|end| &rest[..end])
}

/// The arguments of each call of a function in a text.
fn arguments<'a>(text: &'a str, function: &str) -> Vec<&'a str> {
    let mut found = Vec::new();
    let open = format!("{function}(");
    for (at, _) in text.match_indices(&open) {
        let rest = &text[at + open.len()..];
        let mut depth = 1;
        for (end, letter) in rest.char_indices() {
            match letter {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                found.push(&rest[..end]);
                break;
            }
        }
    }
    found
}

/// A text on one line, with single blanks.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// FNV-1a: tells changes from none, and need not withstand anybody.
struct Digest(u64);

impl Digest {
    fn add(&mut self, code: &str) {
        for line in code.lines().map(str::trim) {
            // What is said of the code does not change it.
            if line.is_empty() || line.starts_with("//") {
                continue;
            }
            for byte in line.bytes().chain([b'\n']) {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
}

/// The modules of a source folder, each with its text.
fn modules(folder: &str) -> BTreeMap<String, String> {
    let mut found: BTreeMap<String, String> = BTreeMap::new();
    for path in files(folder, "rs") {
        let name = source::relative(&path);
        let name = name.strip_prefix(&format!("{folder}/")).unwrap_or(&name);
        let module = name.split('/').next().unwrap_or(name);
        let module = module.strip_suffix(".rs").unwrap_or(module);
        *found.entry(module.to_owned()).or_default() += &read(&path);
    }
    found.remove("lib");
    found
}

/// The modules that a text names after one of the roots.
fn named<'a>(
    text: &str,
    roots: &[&str],
    modules: &'a BTreeMap<String, String>,
) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    for root in roots {
        for (at, _) in text.match_indices(root) {
            let rest = &text[at + root.len()..];
            // A list of a `use`, or one path.
            let end = if rest.starts_with('{') {
                rest.find(';')
            } else {
                rest.find(|letter: char| !letter.is_alphanumeric() && letter != '_')
            };
            let part = &rest[..end.unwrap_or(rest.len())];
            let words = part.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
            for word in words {
                if let Some((module, _)) = modules.get_key_value(word) {
                    found.insert(module.as_str());
                }
            }
        }
    }
    found
}

/// Those modules with all that they lead to.
fn closure<'a>(
    begin: BTreeSet<&'a str>,
    modules: &'a BTreeMap<String, String>,
) -> BTreeSet<&'a str> {
    let mut found = begin;
    loop {
        let more: BTreeSet<&str> = found
            .iter()
            .flat_map(|module| named(&modules[*module], &["crate::", "super::"], modules))
            .filter(|module| !found.contains(module))
            .collect();
        if more.is_empty() {
            return found;
        }
        found.extend(more);
    }
}

/// Every harness of `proofs/` by name.
pub fn harnesses() -> BTreeMap<String, Harness> {
    let (code, book) = (modules("src"), modules("spec/src"));
    let folder = Folder::read("proofs", &source::predicates());
    let mut found = BTreeMap::new();
    for (at, item) in folder
        .items
        .iter()
        .enumerate()
        .filter(|(_, item)| item.is_proof())
    {
        let mut reached: Vec<&Item> = folder
            .reached(at)
            .iter()
            .map(|&at| &folder.items[at])
            .collect();
        // What stands in for something is part of it, although nothing calls it by name.
        for other in &folder.items {
            let stands_in = format!("::{})", other.name);
            let attributes: String = item.attributes.split_whitespace().collect();
            if attributes.contains(&stands_in)
                && !reached.iter().any(|known| known.name == other.name)
            {
                reached.push(other);
            }
        }
        let texts: BTreeSet<String> = reached.iter().map(|item| item.file.clone()).collect();
        let texts: String = texts.iter().map(|file| read(&root().join(file))).collect();

        let mut digest = Digest(0xcbf2_9ce4_8422_2325);
        let mut parts: Vec<String> = reached
            .iter()
            .map(|item| format!("{}\n{}", item.attributes, item.body))
            .collect();
        parts[1..].sort();
        parts.iter().for_each(|part| digest.add(part));
        let reached_modules = closure(named(&texts, &["crate::", "sidestep::"], &code), &code);
        for module in &reached_modules {
            digest.add(&code[*module]);
        }
        for module in named(&texts, &["sidestep_spec::"], &book) {
            digest.add(&book[module]);
        }

        let mut assumes = BTreeSet::new();
        for (order, part) in reached.iter().enumerate() {
            let brings = arguments(&part.body, "kani::assume");
            if part.name.starts_with("any_") && order > 0 {
                if !brings.is_empty() && part.name != "any_in" {
                    assumes.insert(part.name.clone());
                }
                continue;
            }
            assumes.extend(brings.into_iter().map(one_line));
            let ranges = arguments(&part.body, "any_in").into_iter().map(one_line);
            assumes.extend(ranges.map(|range| format!("any_in({range})")));
        }
        let stubs = arguments(&item.attributes, "kani::stub")
            .into_iter()
            .filter_map(|stub| stub.split(',').next())
            .map(|path| one_line(path).trim_start_matches("crate::").to_owned())
            .collect();
        found.insert(
            format!("{}::{}", item.chapter(), item.name),
            Harness {
                shows: item.doc.clone(),
                invariants: item.cites.clone(),
                solver: between(&item.attributes, "kani::solver(", ")")
                    .unwrap_or("default")
                    .to_owned(),
                unwind: between(&item.attributes, "kani::unwind(", ")")
                    .unwrap_or_default()
                    .to_owned(),
                stubs,
                assumes: assumes.into_iter().collect(),
                covers: reached
                    .iter()
                    .map(|item| item.body.matches("kani::cover!").count())
                    .sum(),
                digest: format!("{:08x}", (digest.0 >> 32) ^ (digest.0 & 0xffff_ffff)),
            },
        );
    }
    found
}

/// The columns of the table before the last, which is the harness's own words.
const COLUMNS: [&str; 9] = [
    "harness",
    "invariants",
    "result",
    "s",
    "failed checks",
    "covers",
    "code",
    "solver, unwind",
    "stands in, assumed",
];

/// The ledger as it stands: the line that says by what, and the verdicts by harness. Where a merge
/// has left two of a harness, the one on its present code counts.
pub fn read_ledger(harnesses: &BTreeMap<String, Harness>) -> (String, BTreeMap<String, Verdict>) {
    let text = std::fs::read_to_string(root().join(PATH)).unwrap_or_default();
    let mut found: BTreeMap<String, Verdict> = BTreeMap::new();
    let mut by = String::new();
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("Last run: ") {
            by = rest.to_owned();
        }
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        if cells.len() <= COLUMNS.len() || !cells[0].contains("::") || cells[2] == "NOT RUN" {
            continue;
        }
        let verdict = Verdict {
            result: cells[2].to_owned(),
            seconds: cells[3].to_owned(),
            checks: cells[4].to_owned(),
            covers: cells[5].to_owned(),
            digest: cells[6].to_owned(),
        };
        let present = harnesses
            .get(cells[0])
            .is_some_and(|harness| harness.digest == verdict.digest);
        if present || !found.contains_key(cells[0]) {
            found.insert(cells[0].to_owned(), verdict);
        }
    }
    (by, found)
}

/// The ledger as Markdown. Verdicts of harnesses that are no more are left out.
pub fn markdown(
    harnesses: &BTreeMap<String, Harness>,
    verdicts: &BTreeMap<String, Verdict>,
    by: &str,
) -> String {
    let known: Vec<(&Harness, &Verdict)> = harnesses
        .iter()
        .filter_map(|(name, harness)| Some((harness, verdicts.get(name)?)))
        .collect();
    let good = known
        .iter()
        .filter(|(harness, verdict)| verdict.holds(harness))
        .count();
    let seconds: f64 = known
        .iter()
        .filter_map(|(_, verdict)| verdict.seconds.parse::<f64>().ok())
        .sum();
    let mut text = format!(
        "# Proof ledger\n\n\
         Generated from a run of Kani by `cargo run --example assurance -- prove`; do not edit.\n\n\
         Last run: {by}\n\n\
         {good} of {} harnesses verified on the code as it is, {seconds:.0} s of solving in all.\n\n\
         *Code* is a digest of everything that the proof is about: the harness, its helpers, and the\n\
         modules they lead to, comments aside. Where it is no longer that of the sources, the proof has\n\
         to be run again, and `cargo test --test traceability` fails until it has been. *Covers* are\n\
         situations that must be reachable, so that no proof is empty. *Stands in* are functions that\n\
         the proof replaces by anything their contract allows; *assumed* is what narrows the inputs,\n\
         `any_…` being helpers in `proofs/` that give any valid value of a type.\n\n",
        harnesses.len()
    );
    let _ = writeln!(
        text,
        "| {} | what it shows, and on which domain |",
        COLUMNS.join(" | ")
    );
    let _ = writeln!(text, "|{}", "---|".repeat(COLUMNS.len() + 1));
    let escaped = |text: &str| text.replace('|', "\\|");
    for (name, harness) in harnesses {
        let not_run = Verdict {
            result: "NOT RUN".to_owned(),
            ..Verdict::default()
        };
        let verdict = verdicts.get(name).unwrap_or(&not_run);
        let invariants: Vec<&str> = harness.invariants.iter().map(String::as_str).collect();
        let list = |label: &str, words: &[String]| {
            let words: Vec<String> = words
                .iter()
                .map(|word| format!("`{}`", escaped(word)))
                .collect();
            let blank = if words.is_empty() { "" } else { label };
            format!("{blank}{}", words.join(", "))
        };
        let stands_in = list("in: ", &harness.stubs);
        let assumed = list("assumed: ", &harness.assumes);
        let between = if stands_in.is_empty() || assumed.is_empty() {
            ""
        } else {
            "; "
        };
        let unwind = if harness.unwind.is_empty() { "" } else { ", " };
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {}{unwind}{} | {stands_in}{between}{assumed} | {} |",
            invariants.join(", "),
            verdict.result,
            verdict.seconds,
            verdict.checks,
            verdict.covers,
            verdict.digest,
            harness.solver,
            harness.unwind,
            escaped(&harness.shows),
        );
    }
    text
}

/// What is wrong between the harnesses and the ledger.
pub fn wrong(
    harnesses: &BTreeMap<String, Harness>,
    verdicts: &BTreeMap<String, Verdict>,
) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, harness) in harnesses {
        if harness.covers == 0 {
            wrong.push(format!("{name} covers nothing: it may be empty"));
        }
        if harness.shows.is_empty() {
            wrong.push(format!("{name} does not say what it shows"));
        }
        match verdicts.get(name) {
            None => wrong.push(format!("{name} has not been run")),
            Some(verdict) if verdict.digest != harness.digest => {
                wrong.push(format!("{name} was run on other code"));
            }
            Some(verdict) if !verdict.is_good(harness) => wrong.push(format!(
                "{name}: {}, covers {}",
                verdict.result, verdict.covers
            )),
            Some(_) => {}
        }
    }
    let gone = verdicts
        .keys()
        .filter(|name| !harnesses.contains_key(*name));
    wrong.extend(gone.map(|name| format!("{name} is in the ledger and nowhere else")));
    wrong
}

/// Reads what Kani prints, line by line, of one harness or of several at a time.
#[derive(Default)]
pub struct Reader {
    /// The harness of each thread.
    of_thread: BTreeMap<String, String>,
    thread: String,
    verdicts: BTreeMap<String, Verdict>,
}

impl Reader {
    /// The next line; what is complete with it.
    pub fn line(&mut self, line: &str) -> Option<(String, Verdict)> {
        let mut line = line.trim();
        if let Some((thread, rest)) = line
            .strip_prefix("Thread ")
            .and_then(|rest| rest.split_once(':'))
        {
            self.thread = thread.to_owned();
            line = rest.trim();
        }
        if let Some(name) = between(line, "Checking harness proofs::", "...") {
            self.of_thread.insert(self.thread.clone(), name.to_owned());
            self.verdicts.insert(name.to_owned(), Verdict::default());
            return None;
        }
        let name = self.of_thread.get(&self.thread)?;
        let verdict = self.verdicts.get_mut(name)?;
        if let Some(covers) = between(line, "** ", " cover properties satisfied") {
            verdict.covers = covers.to_owned();
        } else if let Some(checks) = between(line, "** ", " failed") {
            verdict.checks = checks.to_owned();
        } else if let Some(result) = line.strip_prefix("VERIFICATION:- ") {
            let verified = result.starts_with("SUCCESSFUL");
            verdict.result = if verified { "verified" } else { "FAILED" }.to_owned();
        } else if let Some(seconds) = between(line, "Verification Time: ", "s") {
            let seconds: f64 = seconds.parse().unwrap_or(f64::NAN);
            verdict.seconds = format!("{seconds:.1}");
            return Some((name.clone(), verdict.clone()));
        }
        None
    }
}
