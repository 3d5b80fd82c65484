//! Nothing is claimed that is not cited, run and current: the matrix, the ledger, the table of
//! fail-safe actions. The code that writes the first two is the example `assurance`.

#[path = "../examples/assurance/book.rs"]
mod book;
#[path = "../examples/assurance/ledger.rs"]
#[allow(dead_code, reason = "the example runs Kani, this only looks")]
mod ledger;
#[path = "../examples/assurance/matrix.rs"]
mod matrix;
#[path = "../examples/assurance/source.rs"]
mod source;

/// Every invariant is met somewhere, stated as a predicate, and verified by each engine or by none
/// for a reason.
#[test]
fn every_invariant_is_verified() {
    let wrong = matrix::Matrix::of_sources().wrong;
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// `cargo run --example assurance -- matrix` writes it anew.
#[test]
fn matrix_is_current() {
    let written = source::read(&source::root().join(matrix::PATH));
    let matrix = matrix::Matrix::of_sources().markdown();
    assert!(
        written == matrix,
        "{} is not what the sources say",
        matrix::PATH
    );
}

/// `cargo run --example assurance -- prove` runs what has changed, and writes it anew.
#[test]
fn ledger_is_current() {
    let harnesses = ledger::harnesses();
    let (by, verdicts) = ledger::read_ledger(&harnesses);
    let wrong = ledger::wrong(&harnesses, &verdicts);
    assert!(wrong.is_empty(), "{wrong:#?}");
    let written = source::read(&source::root().join(ledger::PATH));
    assert!(
        written == ledger::markdown(&harnesses, &verdicts, &by),
        "{} is not what harnesses and verdicts say",
        ledger::PATH
    );
}

/// The checks above find what they are for.
#[test]
fn the_book_is_read() {
    let (invariants, wrong) = book::invariants();
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(invariants.len() > 60, "{} invariants", invariants.len());
    let shield = invariants.iter().find(|known| known.id == "shield.INV-3");
    let theorems = shield.map(|known| known.theorems(&book::theorems()));
    let theorems = theorems.unwrap_or_default();
    assert!(
        ["01a", "02", "04d", "11e"]
            .iter()
            .all(|name| theorems.contains(&(*name).to_owned())),
        "{theorems:?}"
    );
    assert!(source::predicates().len() > 60);
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
