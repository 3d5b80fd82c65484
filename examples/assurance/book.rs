//! The law book: its MUST sentences, and the reasons it gives for what does not verify them.

use super::source::{files, ids, read};
use std::collections::BTreeMap;

/// What may verify an invariant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Engine {
    Kani,
    Property,
    Fuzz,
    Golden,
    Exhaustive,
    Smt,
}

impl Engine {
    pub const ALL: [Self; 6] = [
        Self::Kani,
        Self::Property,
        Self::Fuzz,
        Self::Golden,
        Self::Exhaustive,
        Self::Smt,
    ];

    /// The heading of its column.
    pub const fn heading(self) -> &'static str {
        match self {
            Self::Kani => "Kani proof",
            Self::Property => "property test",
            Self::Fuzz => "fuzz target",
            Self::Golden => "worked cases",
            Self::Exhaustive => "exhaustive",
            Self::Smt => "exact arithmetic",
        }
    }

    /// How the book says why it is not there.
    pub const fn excuse(self) -> &'static str {
        match self {
            Self::Kani => "Not proved by Kani:",
            Self::Property => "No property test:",
            Self::Fuzz => "Not fuzzed:",
            Self::Golden => "No worked cases:",
            Self::Exhaustive => "Not exhaustive:",
            Self::Smt => "Not in exact arithmetic:",
        }
    }
}

/// One MUST sentence.
#[derive(Debug, Clone)]
pub struct Invariant {
    pub id: String,
    /// `avoid` of `spec/avoid.md`.
    pub chapter: String,
    /// The sentence, without its id.
    pub sentence: String,
    /// What follows it, up to the next.
    pub text: String,
    /// Why an engine is missing: said below the sentence, else elsewhere in the chapter, else in the
    /// README of the book.
    pub reasons: BTreeMap<Engine, String>,
}

impl Invariant {
    /// For sorting: chapters by name, numbers as numbers.
    pub fn key(&self) -> (String, u32) {
        let number = self.id.rsplit('-').next().unwrap_or_default();
        (self.chapter.clone(), number.parse().unwrap_or(0))
    }
}

/// The excuses of a text: paragraphs that begin with one.
fn reasons(text: &str) -> BTreeMap<Engine, String> {
    text.split("\n\n")
        .filter_map(|paragraph| {
            let paragraph = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
            Engine::ALL.into_iter().find_map(|engine| {
                let reason = paragraph.strip_prefix(engine.excuse())?.trim();
                Some((engine, reason.to_owned()))
            })
        })
        .collect()
}

/// What stands under a heading of level two.
fn under<'a>(text: &'a str, heading: &str) -> &'a str {
    let rest = text
        .split_once(&format!("\n{heading}\n"))
        .map_or("", |part| part.1);
    rest.split("\n## ").next().unwrap_or(rest)
}

/// Every MUST sentence of the book, and what is wrong with the book itself.
pub fn invariants() -> (Vec<Invariant>, Vec<String>) {
    let mut found: Vec<Invariant> = Vec::new();
    let mut wrong = Vec::new();
    let chapters = files("spec", "md");
    let readme = chapters
        .iter()
        .find(|path| path.ends_with("spec/README.md"));
    let of_book = reasons(under(
        &readme.map_or_else(String::new, |path| read(path)),
        "## Where an engine is missing",
    ));
    for path in &chapters {
        let chapter = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let text = read(path);
        let first = found.len();
        let mut around = String::new();
        let mut current = None;
        for line in text.lines() {
            let stated = line
                .strip_prefix("**")
                .and_then(|rest| rest.split_once("** "))
                .filter(|(id, _)| ids(id).contains(*id));
            if let Some((id, sentence)) = stated {
                if !id.starts_with(&format!("{chapter}.")) {
                    wrong.push(format!("{id} is stated in chapter {chapter}"));
                }
                if !sentence.contains("MUST") {
                    wrong.push(format!("{id} has no MUST"));
                }
                if found.iter().any(|invariant| invariant.id == id) {
                    wrong.push(format!("{id} is stated twice"));
                }
                current = Some(found.len());
                found.push(Invariant {
                    id: id.to_owned(),
                    chapter: chapter.clone(),
                    sentence: sentence.to_owned(),
                    text: String::new(),
                    reasons: of_book.clone(),
                });
                continue;
            } else if line.starts_with('#') {
                current = None;
            }
            let text = current.map_or(&mut around, |at: usize| &mut found[at].text);
            text.push_str(line);
            text.push('\n');
        }
        let of_chapter = reasons(&around);
        for invariant in &mut found[first..] {
            invariant.reasons.extend(of_chapter.clone());
            let own = reasons(&invariant.text);
            invariant.reasons.extend(own);
        }
    }
    found.sort_by_key(Invariant::key);
    (found, wrong)
}

/// The names of theorems in exact arithmetic: `05a` of `05a_slower_is_admitted.smt2`, sorted.
pub fn theorems() -> Vec<String> {
    let mut found: Vec<String> = files("spec/smt", "smt2")
        .iter()
        .filter_map(|path| path.file_stem())
        .map(|stem| stem.to_string_lossy().into_owned())
        .filter(|stem| !stem.ends_with(".broken"))
        .filter_map(|stem| stem.split('_').next().map(str::to_owned))
        .collect();
    found.sort();
    found
}

impl Invariant {
    /// The theorems that its paragraph names, as `05a` or as `01a` to `04d`.
    pub fn theorems(&self, all: &[String]) -> Vec<String> {
        let mut found = Vec::new();
        let words: Vec<&str> = self.text.split('`').collect();
        // Every second piece is in backticks.
        for at in (1..words.len()).step_by(2) {
            let Some(index) = all.iter().position(|name| name == words[at]) else {
                continue;
            };
            let last = words
                .get(at + 1)
                .filter(|between| between.split_whitespace().eq(["to"]))
                .and_then(|_| words.get(at + 2))
                .and_then(|last| all.iter().position(|name| name == last));
            found.extend_from_slice(&all[index..=last.unwrap_or(index).max(index)]);
        }
        found.sort();
        found.dedup();
        found
    }
}
