//! A small version of `sidestep faults`.

use sidestep_hw::faults::{CASES, MODES, PRESETS, run_all};
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn every_fault_in_every_mode_with_every_preset() {
    let told = AtomicUsize::new(0);
    let table = run_all(2, 2, |done, count| {
        assert!(done < count);
        told.fetch_add(1, Ordering::Relaxed);
    })
    .unwrap();
    let count = PRESETS.len() * CASES.len() * MODES.len();
    assert_eq!(told.into_inner(), count);
    let text = table.markdown();
    println!("{text}");

    // Nothing is touched by a moving robot as long as what the shield counts on is so, or is seen
    // not to be.
    assert_eq!(table.failures(), 0, "see the findings above");
    let mut struck = 0;
    for (preset, case, mode, cell) in table.cells() {
        let what = format!("{preset}, {}, {mode}", case.name);
        struck += cell.struck;
        if cell.failed > 0 {
            assert!(cell.first.is_some(), "{what}");
            assert!(!cell.broken.is_empty(), "{what}: no assumption is named");
        }
        if cell.refused.is_some() {
            assert_eq!(cell.struck, 0);
        }
    }
    assert!(struck > count as u64, "most modes are reached: {struck}");

    // The check bites: who hears nothing runs into people, and the table says why.
    let deaf = |mode| table.cell(PRESETS[0], "all sonars deaf", mode).unwrap();
    assert!(
        ["cruise", "maneuver"]
            .iter()
            .any(|mode| deaf(mode).failed > 0)
    );
    assert!(text.contains("broken: sonars in order"));

    // One row for each fault in each table, and every finding is referred to and listed.
    for case in CASES {
        let rows = text
            .lines()
            .filter(|l| l.starts_with(&format!("| {} |", case.name)));
        assert_eq!(rows.count(), PRESETS.len(), "{}", case.name);
    }
    let findings = table.cells().filter(|(.., cell)| cell.first.is_some());
    for number in 1..=findings.count() {
        assert!(text.contains(&format!("finding {number}: ")), "{number}");
        assert!(text.contains(&format!("\n{number}. ")), "{number}");
    }
}
