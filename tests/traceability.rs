//! Every MUST of the law book has a predicate, a property test, and a proof or a reason; every
//! harness has its line in the ledger.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder with an extension.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap_or_else(|error| panic!("{folder}: {error}"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .collect();
    files.sort();
    files
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every id of the form `chapter.INV-n` in a text.
fn ids(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, _) in text.match_indices(".INV-") {
        let chapter: String = text[..at]
            .chars()
            .rev()
            .take_while(char::is_ascii_lowercase)
            .collect();
        let number: String = text[at + 5..]
            .chars()
            .take_while(char::is_ascii_digit)
            .collect();
        if !chapter.is_empty() && !number.is_empty() {
            let chapter: String = chapter.chars().rev().collect();
            found.insert(format!("{chapter}.INV-{number}"));
        }
    }
    found
}

/// Ids in the lines of the files that begin with a mark.
fn cited(folder: &str, mark: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for path in files(folder, "rs") {
        for line in read(&path).lines() {
            if line.trim_start().starts_with(mark) {
                found.extend(ids(line));
            }
        }
    }
    found
}

/// The MUST sentences by id, with what follows each up to the next.
fn musts() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for path in files("spec", "md") {
        let mut current: Option<String> = None;
        for line in read(&path).lines() {
            if let Some(rest) = line.strip_prefix("**")
                && let Some(id) = ids(rest).into_iter().next()
                && rest.starts_with(&id)
            {
                assert!(line.contains("MUST"), "{}: {line}", path.display());
                assert!(
                    !found.contains_key(&id),
                    "{id} is stated twice: {}",
                    path.display()
                );
                current = Some(id.clone());
                found.insert(id, line.to_owned());
            } else if line.starts_with('#') {
                current = None;
            } else if let Some(text) = current.as_ref().and_then(|id| found.get_mut(id)) {
                text.push('\n');
                text.push_str(line);
            }
        }
    }
    found
}

#[test]
fn every_must_has_its_predicate_test_and_proof() {
    let musts = musts();
    assert!(
        musts.len() > 30,
        "only {} MUST sentences found",
        musts.len()
    );
    let predicates = cited("spec/src", "///");
    let mut tests = cited("tests", "//=");
    tests.extend(cited("hw/tests", "//="));
    let proofs = cited("proofs", "//=");
    let mut missing = Vec::new();
    for (id, text) in &musts {
        if !predicates.contains(id) {
            missing.push(format!("{id}: no predicate in spec/src"));
        }
        if !tests.contains(id) {
            missing.push(format!("{id}: no property test"));
        }
        if !proofs.contains(id) && !text.contains("Not proved by Kani:") {
            missing.push(format!(
                "{id}: no proof, and no reason (\"Not proved by Kani: …\")"
            ));
        }
    }
    for (where_, ids) in [
        ("spec/src", &predicates),
        ("tests", &tests),
        ("proofs", &proofs),
    ] {
        for id in ids {
            if !musts.contains_key(id) {
                missing.push(format!("{id} is cited in {where_} and stated nowhere"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn every_harness_is_in_the_ledger() {
    let ledger = read(&root().join("proofs/LEDGER.md"));
    let in_ledger: BTreeSet<&str> = ledger
        .lines()
        .filter_map(|line| line.strip_prefix("| "))
        .filter_map(|line| line.split(" | ").next())
        .filter(|name| name.contains("::"))
        .collect();
    let mut in_source = BTreeSet::new();
    for path in files("proofs", "rs") {
        let chapter = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let (mut proof, mut cites) = (false, false);
        for line in read(&path).lines() {
            proof |= line.contains("kani::proof");
            cites |= line.starts_with("//= ");
            if let Some(rest) = line.strip_prefix("pub fn ") {
                let name = rest.split('(').next().unwrap_or(rest);
                if proof {
                    assert!(cites, "{chapter}::{name} cites no invariant");
                    in_source.insert(format!("{chapter}::{name}"));
                }
                (proof, cites) = (false, false);
            }
        }
    }
    let in_source: BTreeSet<&str> = in_source.iter().map(String::as_str).collect();
    assert_eq!(
        in_ledger, in_source,
        "run the ledger again: see CONTRIBUTING"
    );
    let unproved: Vec<&str> = ledger
        .lines()
        .filter(|line| line.contains("| FAILED |") || line.contains("| NOT RUN |"))
        .collect();
    assert!(unproved.is_empty(), "{unproved:#?}");
}

/// The table of fail-safe actions as Markdown.
fn failsafe_table() -> String {
    let yes = |is: bool| if is { "yes" } else { "no" };
    let mut text = String::from(
        "| cause | action | latches in time | may turn | clears when | told |\n\
         |---|---|---|---|---|---|\n",
    );
    for row in sidestep::failsafe::table() {
        text += &format!(
            "| {} | {} | {} | {} | {} | {} |\n",
            row.cause,
            row.action,
            yes(row.latches_in_time),
            yes(row.may_turn),
            row.clears,
            row.told
        );
    }
    text
}

/// The chapter shows what the code does. With `SIDESTEP_WRITE_TABLES` set, the chapter is written
/// anew instead.
#[test]
fn failsafe_table_is_the_codes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/spec/failsafe.md");
    let chapter = std::fs::read_to_string(path).expect("the chapter");
    let (before, rest) = chapter
        .split_once("<!-- table -->\n")
        .expect("the table begins");
    let (table, after) = rest.split_once("<!-- /table -->").expect("the table ends");
    if std::env::var_os("SIDESTEP_WRITE_TABLES").is_some() {
        let chapter = format!(
            "{before}<!-- table -->\n{}<!-- /table -->{after}",
            failsafe_table()
        );
        std::fs::write(path, chapter).expect("the chapter is written");
    } else {
        assert_eq!(table.trim(), failsafe_table().trim());
    }
}
