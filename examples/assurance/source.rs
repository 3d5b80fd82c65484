//! The Rust files of the project as the assurance case sees them: functions, what stands above
//! them, what they call, and which invariants they cite. The files are formatted by `rustfmt`, so
//! lines and indentation are enough.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The root of the project.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file.
///
/// # Panics
/// If there is none.
pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files below a folder with an extension, sorted; none where there is no folder.
pub fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else {
            continue;
        };
        for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
            if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// A path as the project writes it.
pub fn relative(path: &Path) -> String {
    path.strip_prefix(root())
        .unwrap_or(path)
        .to_string_lossy()
        .replace('\\', "/")
}

/// Every id of the form `chapter.INV-n` in a text.
pub fn ids(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, _) in text.match_indices(".INV-") {
        let before = &text[..at];
        let begin = before
            .trim_end_matches(|letter: char| letter.is_ascii_lowercase())
            .len();
        let number: String = text[at + 5..]
            .chars()
            .take_while(char::is_ascii_digit)
            .collect();
        if begin < at && !number.is_empty() {
            found.insert(format!("{}.INV-{number}", &before[begin..]));
        }
    }
    found
}

/// A function, a match arm or whatever else stands below a citation.
#[derive(Debug, Clone, Default)]
pub struct Item {
    /// The file, relative to the root.
    pub file: String,
    /// The function's name; of what is no function, the first string in it.
    pub name: String,
    pub is_function: bool,
    /// The doc comment, joined.
    pub doc: String,
    /// Attributes, joined.
    pub attributes: String,
    /// Invariants cited above it, with `//=`.
    pub cites: BTreeSet<String>,
    /// It says that it tries every input, as in `//= arcos.INV-13 (every input)`.
    pub exhaustive: bool,
    /// From its first line to its last.
    pub body: String,
}

impl Item {
    /// The last part of the file's name without extension: the chapter.
    pub fn chapter(&self) -> &str {
        let name = self.file.rsplit('/').next().unwrap_or(&self.file);
        name.strip_suffix(".rs").unwrap_or(name)
    }

    pub fn is_proof(&self) -> bool {
        self.attributes.contains("kani::proof")
    }
}

/// The name of the function that a line declares.
fn function_name(line: &str) -> Option<&str> {
    let mut rest = line.trim_start();
    loop {
        if let Some(name) = rest.strip_prefix("fn ") {
            let end = name.find(|letter: char| !letter.is_alphanumeric() && letter != '_')?;
            return Some(&name[..end]);
        }
        let word = rest.split(' ').next()?;
        let modifier = matches!(
            word,
            "pub" | "pub(crate)" | "pub(super)" | "const" | "unsafe" | "extern" | "\"C\""
        );
        if !modifier {
            return None;
        }
        rest = rest[word.len()..].trim_start();
    }
}

/// Every function of a file, and whatever else has a citation above it.
pub fn items(path: &Path) -> Vec<Item> {
    let text = read(path);
    let file = relative(path);
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    let mut above = Item::default();
    let mut inside_attribute = false;
    for (at, line) in lines.iter().enumerate() {
        let trimmed = line.trim();
        if let Some(doc) = trimmed.strip_prefix("///") {
            if !above.doc.is_empty() {
                above.doc.push(' ');
            }
            above.doc += doc.trim();
        } else if let Some(cited) = trimmed.strip_prefix("//= ") {
            above.cites.extend(ids(cited));
            above.exhaustive |= cited.contains("(every input)");
        } else if trimmed.starts_with("//") {
            // A comment between says nothing to us.
        } else if inside_attribute || trimmed.starts_with("#[") {
            above.attributes += trimmed;
            inside_attribute = !trimmed.ends_with(")]") && !trimmed.ends_with("]");
        } else {
            let name = function_name(line);
            if name.is_some() || !above.cites.is_empty() {
                let body = lines[at..=end_of_item(&lines, at)].join("\n");
                found.push(Item {
                    file: file.clone(),
                    name: name
                        .or_else(|| body.split('"').nth(1))
                        .unwrap_or(trimmed)
                        .to_owned(),
                    is_function: name.is_some(),
                    body,
                    ..std::mem::take(&mut above)
                });
            }
            above = Item::default();
        }
    }
    found
}

/// The line that closes what begins at a line: the first of the same indentation that begins with a
/// closing bracket.
fn end_of_item(lines: &[&str], at: usize) -> usize {
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let own = indentation(lines[at]);
    let one_line = lines[at].ends_with(';') || lines[at].ends_with('}') || lines[at].ends_with(',');
    if one_line {
        return at;
    }
    (at + 1..lines.len())
        .find(|&i| {
            indentation(lines[i]) == own
                && lines[i].trim_start().starts_with(['}', ')', ']'])
                && !lines[i].trim_end().ends_with('{')
        })
        .unwrap_or(at)
}

/// Names that stand as words in a text and are followed by a bracket, or by type arguments: what it
/// calls, and more.
pub fn calls(text: &str) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    let word = |letter: char| letter.is_alphanumeric() || letter == '_';
    for (at, _) in text.match_indices('(').chain(text.match_indices("::<")) {
        let before = &text[..at];
        let begin = before.trim_end_matches(word).len();
        if begin < at {
            found.insert(&before[begin..]);
        }
    }
    found
}

/// The modules of the law book's code that a file names, by the name it gives them there.
fn aliases(text: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (at, _) in text.match_indices("use sidestep_spec") {
        let rest = &text[at + "use sidestep_spec".len()..];
        let Some(end) = rest.find(';') else { continue };
        let used = rest[..end].trim_start_matches("::").trim();
        if let Some(alias) = used.strip_prefix("as ") {
            found.insert(alias.trim().to_owned(), String::new());
            continue;
        }
        let list = used.trim_start_matches('{').trim_end_matches('}');
        for part in list
            .split(',')
            .map(str::trim)
            .filter(|part| !part.is_empty())
        {
            let (module, alias) = part.split_once(" as ").unwrap_or((part, part));
            found.insert(alias.trim().to_owned(), module.trim().to_owned());
        }
    }
    found
}

/// Predicates of the law book, as `chapter::name`, with the invariants they state.
pub type Predicates = BTreeMap<String, BTreeSet<String>>;

/// Every predicate: a function of `spec/src/` whose doc comment begins with ids.
pub fn predicates() -> Predicates {
    files("spec/src", "rs")
        .iter()
        .flat_map(|path| items(path))
        .filter(|item| item.is_function)
        .map(|item| (format!("{}::{}", item.chapter(), item.name), ids(&item.doc)))
        .filter(|(_, ids)| !ids.is_empty())
        .collect()
}

/// The predicates that a text names, where a file's text says what its names mean.
fn named_predicates(body: &str, file: &str, predicates: &Predicates) -> BTreeSet<String> {
    let aliases = aliases(file);
    let word = |letter: char| letter.is_alphanumeric() || letter == '_';
    predicates
        .keys()
        .filter(|predicate| {
            let (chapter, name) = predicate.split_once("::").unwrap_or(("", predicate));
            let mut paths = vec![format!("sidestep_spec::{predicate}")];
            for (alias, module) in &aliases {
                if module.is_empty() {
                    paths.push(format!("{alias}::{predicate}"));
                } else if module == chapter {
                    paths.push(format!("{alias}::{name}"));
                }
            }
            paths.iter().any(|path| {
                body.match_indices(path.as_str()).any(|(at, _)| {
                    !body[..at].ends_with(word) && !body[at + path.len()..].starts_with(word)
                })
            })
        })
        .cloned()
        .collect()
}

/// A folder's functions with what each reaches, through functions of the same folder.
pub struct Folder {
    pub items: Vec<Item>,
    /// Names that each item calls, and predicates it names itself.
    direct: Vec<(BTreeSet<String>, BTreeSet<String>)>,
    by_name: BTreeMap<String, Vec<usize>>,
}

impl Folder {
    pub fn read(folder: &str, predicates: &Predicates) -> Self {
        let mut items = Vec::new();
        let mut direct = Vec::new();
        for path in files(folder, "rs") {
            let text = read(&path);
            for item in self::items(&path) {
                let calls = calls(&item.body).into_iter().map(str::to_owned).collect();
                direct.push((calls, named_predicates(&item.body, &text, predicates)));
                items.push(item);
            }
        }
        let mut by_name: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, item) in items.iter().enumerate() {
            by_name.entry(item.name.clone()).or_default().push(at);
        }
        Self {
            items,
            direct,
            by_name,
        }
    }

    /// The items that one reaches, itself first: a name means its own file's function where there
    /// is one, else any of the folder.
    pub fn reached(&self, from: usize) -> Vec<usize> {
        let mut reached = vec![from];
        let mut next = 0;
        while let Some(&at) = reached.get(next) {
            next += 1;
            for called in &self.direct[at].0 {
                let known = self.by_name.get(called).map_or(&[][..], Vec::as_slice);
                let own = known
                    .iter()
                    .filter(|&&to| self.items[to].file == self.items[at].file);
                let own: Vec<usize> = own.copied().collect();
                for to in if own.is_empty() { known.to_vec() } else { own } {
                    if !reached.contains(&to) {
                        reached.push(to);
                    }
                }
            }
        }
        reached
    }

    /// The predicates that an item names itself.
    pub fn own_predicates(&self, at: usize) -> &BTreeSet<String> {
        &self.direct[at].1
    }

    /// The predicates that an item reaches.
    pub fn predicates(&self, from: usize) -> BTreeSet<String> {
        self.reached(from)
            .into_iter()
            .flat_map(|at| self.direct[at].1.iter().cloned())
            .collect()
    }
}
