//! The matrix: which invariant is verified by what, and why not by the rest.

use super::book::{self, Engine, Invariant};
use super::source::{self, Folder, Item};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Where it stands.
pub const PATH: &str = "spec/MATRIX.md";

/// One place that verifies or implements an invariant, as a link.
type Link = (String, String);

/// The matrix with what is wrong with it.
pub struct Matrix {
    invariants: Vec<Invariant>,
    code: BTreeMap<String, BTreeSet<Link>>,
    /// What reaches a predicate of the invariant, or compares it case by case.
    cells: BTreeMap<(String, Engine), BTreeSet<Link>>,
    /// What cites the invariant besides, such as single cases.
    besides: BTreeMap<(String, Engine), usize>,
    /// Empty where every invariant has its code, its predicate, and for each engine a place or a
    /// reason, and every citation holds.
    pub wrong: Vec<String>,
}

fn link(item: &Item) -> Link {
    (item.name.clone(), item.file.clone())
}

impl Matrix {
    /// Reads book, code, proofs, tests and fuzz targets.
    pub fn of_sources() -> Self {
        let (invariants, wrong) = book::invariants();
        let mut matrix = Self {
            invariants,
            code: BTreeMap::new(),
            cells: BTreeMap::new(),
            besides: BTreeMap::new(),
            wrong,
        };
        let predicates = source::predicates();
        let stated: BTreeSet<&String> = predicates.values().flatten().collect();
        let missing: Vec<String> = matrix
            .invariants
            .iter()
            .filter(|invariant| !stated.contains(&invariant.id))
            .map(|invariant| format!("{}: no predicate in spec/src", invariant.id))
            .collect();
        matrix.wrong.extend(missing);

        for folder in ["src", "hw/src"] {
            for item in Folder::read(folder, &predicates).items {
                for id in &item.cites {
                    matrix
                        .code
                        .entry(id.clone())
                        .or_default()
                        .insert(link(&item));
                }
            }
        }
        for folder in ["proofs", "tests", "hw/tests", "sim/tests", "examples"] {
            matrix.add_cited(folder, &predicates);
        }
        matrix.add_fuzzed(&predicates);
        let theorems = book::theorems();
        for invariant in &matrix.invariants {
            for theorem in invariant.theorems(&theorems) {
                matrix
                    .cells
                    .entry((invariant.id.clone(), Engine::Smt))
                    .or_default()
                    .insert((format!("`{theorem}`"), "spec/smt/README.md".to_owned()));
            }
        }
        matrix.check();
        matrix
    }

    /// What a folder's functions cite. A function verifies an invariant only if it reaches a
    /// predicate of it: "stated once" would mean little otherwise.
    fn add_cited(&mut self, folder: &str, predicates: &source::Predicates) {
        let folder = Folder::read(folder, predicates);
        for (at, item) in folder.items.iter().enumerate() {
            if item.is_proof() && item.cites.is_empty() {
                self.wrong
                    .push(format!("{}: {} cites nothing", item.file, item.name));
            }
            if item.cites.is_empty() {
                continue;
            }
            let engine = if item.file.starts_with("proofs/") {
                Engine::Kani
            } else if item.file.ends_with("/golden.rs") {
                Engine::Golden
            } else if item.exhaustive {
                Engine::Exhaustive
            } else {
                Engine::Property
            };
            let reached: BTreeSet<&String> = folder
                .predicates(at)
                .iter()
                .filter_map(|predicate| predicates.get(predicate))
                .flatten()
                .collect();
            for id in &item.cites {
                let place = (id.clone(), engine);
                // Worked cases compare numbers, and what is no function is a table's row.
                if reached.contains(id) || !item.is_function {
                    self.cells.entry(place).or_default().insert(link(item));
                } else {
                    *self.besides.entry(place).or_default() += 1;
                }
            }
        }
    }

    /// Fuzz targets cite nothing: they call the predicates.
    fn add_fuzzed(&mut self, predicates: &source::Predicates) {
        let folder = Folder::read("fuzz/targets", predicates);
        for (at, item) in folder.items.iter().enumerate() {
            for predicate in folder.own_predicates(at) {
                for id in predicates.get(predicate).into_iter().flatten() {
                    self.cells
                        .entry((id.clone(), Engine::Fuzz))
                        .or_default()
                        .insert((item.chapter().to_owned(), item.file.clone()));
                }
            }
        }
    }

    /// Cells without a place or a reason, and citations of what is not stated.
    fn check(&mut self) {
        let known: BTreeSet<&String> = self.invariants.iter().map(|known| &known.id).collect();
        let cited = self.cells.keys().chain(self.besides.keys());
        let cited = self.code.keys().chain(cited.map(|(id, _)| id));
        let mut wrong: Vec<String> = cited
            .filter(|id| !known.contains(id))
            .map(|id| format!("{id} is cited and stated nowhere"))
            .collect();
        for invariant in &self.invariants {
            if !self.code.contains_key(&invariant.id) {
                wrong.push(format!("{}: not cited in src or hw/src", invariant.id));
            }
            for engine in Engine::ALL {
                if self.places(invariant, engine).is_none()
                    && self.reason(invariant, engine).is_none()
                {
                    wrong.push(format!(
                        "{}: no {}, and no reason (\"{} …\")",
                        invariant.id,
                        engine.heading(),
                        engine.excuse()
                    ));
                }
            }
        }
        self.wrong.extend(wrong);
    }

    fn places(&self, invariant: &Invariant, engine: Engine) -> Option<&BTreeSet<Link>> {
        self.cells.get(&(invariant.id.clone(), engine))
    }

    /// Why an engine is missing.
    fn reason<'a>(&'a self, invariant: &'a Invariant, engine: Engine) -> Option<&'a str> {
        let stated = invariant.reasons.get(&engine).map(String::as_str);
        let tried = self.places(invariant, Engine::Exhaustive).is_some();
        stated
            .filter(|reason| !reason.is_empty())
            .or((engine == Engine::Property && tried).then_some("Every input is tried."))
    }

    /// As Markdown.
    pub fn markdown(&self) -> String {
        let mut reasons: Vec<(Engine, &str)> = Vec::new();
        let mut text = format!(
            "# What verifies what\n\n\
             Generated by `cargo run --example assurance -- matrix`; do not edit. A number leads to the\n\
             reason why there is nothing. *Code* is where the invariant is met. A function that cites an\n\
             invariant is listed where it reaches the invariant's predicate; single cases that cite it\n\
             without are counted as more. How far a proof goes, on which domain and under which\n\
             assumptions, is in the [ledger](../proofs/LEDGER.md).\n\n\
             {} invariants. ",
            self.invariants.len()
        );
        let counts: Vec<String> = Engine::ALL
            .into_iter()
            .map(|engine| {
                let cells = self.cells.keys().filter(|(_, other)| *other == engine);
                format!("{}: {}", engine.heading(), cells.count())
            })
            .collect();
        let _ = writeln!(text, "{}.", counts.join(", "));
        let mut chapter = "";
        for invariant in &self.invariants {
            if chapter != invariant.chapter {
                chapter = &invariant.chapter;
                let _ = write!(
                    text,
                    "\n## [{chapter}]({chapter}.md)\n\n| invariant | code |"
                );
                for engine in Engine::ALL {
                    let _ = write!(text, " {} |", engine.heading());
                }
                text += "\n|---|---|";
                text += &"---|".repeat(Engine::ALL.len());
                text.push('\n');
            }
            let number = invariant.id.rsplit('.').next().unwrap_or_default();
            let code = self.code.get(&invariant.id).map_or_else(String::new, links);
            let _ = write!(text, "| {number}: {} | {code} |", cell(&invariant.sentence));
            for engine in Engine::ALL {
                let shown = match (
                    self.places(invariant, engine),
                    self.reason(invariant, engine),
                ) {
                    (Some(places), _) => {
                        let besides = self.besides.get(&(invariant.id.clone(), engine));
                        let besides =
                            besides.map_or_else(String::new, |n| format!(" and {n} more"));
                        format!("{}{besides}", links(places))
                    }
                    (None, Some(reason)) => {
                        let entry = (engine, reason);
                        let at = reasons.iter().position(|known| *known == entry);
                        let at = at.unwrap_or_else(|| {
                            reasons.push(entry);
                            reasons.len() - 1
                        });
                        format!("[{}](#reasons)", at + 1)
                    }
                    (None, None) => "**missing**".to_owned(),
                };
                let _ = write!(text, " {shown} |");
            }
            text.push('\n');
        }
        text += "\n## Reasons\n\n| no. | missing | why |\n|---|---|---|\n";
        for (at, (engine, reason)) in reasons.iter().enumerate() {
            let _ = writeln!(
                text,
                "| {} | {} | {} |",
                at + 1,
                engine.heading(),
                cell(reason)
            );
        }
        text
    }
}

/// A text inside a table's cell, where links lead from `spec/`.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn links(places: &BTreeSet<Link>) -> String {
    let links: Vec<String> = places
        .iter()
        .map(|(name, file)| {
            let file = file
                .strip_prefix("spec/")
                .map_or_else(|| format!("../{file}"), str::to_owned);
            format!("[{name}]({file})")
        })
        .collect();
    links.join(", ")
}
