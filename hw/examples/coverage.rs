//! The floor of `demo coverage` with five boxes at random places: what is found blocked and what is not.
//!
//! `cargo run --release -p sidestep-hw --example coverage -- SEEDS [FROM_ENDS [FOLDER]]`, where no box
//! is nearer than `FROM_ENDS` (m, 0.9 if not given) to where passages meet or turn, and pictures of the
//! runs that did not end at home are left in `FOLDER`. Free is the wider of the two
//! ways beside a box; 600 mm is S4's safe path.

use sidestep_hw::coverage::{Floor, PassageId, Roadmap, Rules, demo, draw, drive, trial};
use sidestep_hw::edge::corridor_base;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Boxes in each run.
const BOXES: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().ok_or("give a number of seeds")?.parse()?;
    let from_ends: f64 = arguments.next().map_or(Ok(0.9), |text| text.parse())?;
    let folder = arguments.next().map(PathBuf::from);
    let mut floor = Floor::parse(demo::CORRIDORS, None)?;
    let roadmap = Roadmap::new(&floor, &Rules::default())?;
    let (mut home, mut stuck, mut late, mut contacts, mut wrong) = (0, 0, 0, 0, 0);
    // By the free width in steps of 100 mm: boxes, and how many of them were called blocked.
    let mut widths: BTreeMap<i64, (u64, u64)> = BTreeMap::new();
    let mut nearest = f64::INFINITY;
    for seed in 0..seeds {
        let trials = trial::boxes(&floor, &roadmap, BOXES, from_ends, seed);
        floor.surprises = trials.iter().map(|trial| trial.surprise).collect();
        let job = drive::Job {
            floor: &floor,
            roadmap: &roadmap,
            config: corridor_base()?,
            edge: sidestep::edge::PAPER,
            seed,
            sonar_faults: sidestep_sim::sonar::Faults::default(),
            time_limit_ms: 3_600_000,
        };
        let run = drive::run(&job, |_, _| {})?;
        let is_stuck = run
            .happenings
            .iter()
            .any(|(_, happening)| *happening == drive::Happening::Stuck);
        home += u64::from(run.is_home);
        stuck += u64::from(is_stuck);
        late += u64::from(!run.is_home && !is_stuck);
        contacts += u64::from(run.summary.contacts_while_moving() > 0);
        let outcome = run.simulation.outcome();
        nearest = nearest.min(outcome.minimum_clearance_while_driving.obstacles);
        if !run.is_home {
            println!(
                "seed {seed}: not home: {:?}, {:?}\n{}",
                run.summary.ending, run.summary.tally.stops, run.report
            );
            if let Some(folder) = &folder {
                let notes: Vec<String> = run
                    .happenings
                    .iter()
                    .rev()
                    .take(12)
                    .map(|(t, happening)| format!("{:.1} s {happening:?}", *t as f64 / 1000.0))
                    .collect();
                let picture = draw::draw(&draw::Picture {
                    title: &format!("seed {seed}; what happened last is first"),
                    notes: &notes,
                    floor: &floor,
                    roadmap: &roadmap,
                    planned: &[],
                    run: Some(&run),
                });
                std::fs::write(folder.join(format!("coverage-{seed}.svg")), picture)?;
            }
        }
        let boxed: BTreeSet<PassageId> = trials.iter().map(|trial| trial.passage).collect();
        let elsewhere = run.report.blocked.keys().filter(|id| !boxed.contains(id));
        for id in elsewhere {
            wrong += 1;
            println!("seed {seed}: {id} is called blocked, and no box stands in it");
        }
        for trial in &trials {
            let is_blocked = run.report.blocked.contains_key(&trial.passage);
            if is_blocked || run.report.covered.contains(&trial.passage) {
                let (boxes, blocked) = widths.entry((trial.free * 10.0) as i64).or_default();
                *boxes += 1;
                *blocked += u64::from(is_blocked);
            }
        }
    }
    println!(
        "{seeds} runs: {home} home, {stuck} stuck, {late} otherwise not home; {contacts} with a contact \
         while moving, least clearance {nearest:.3} m; {wrong} passages without a box called blocked"
    );
    println!("| free beside the box, mm | boxes | called blocked |\n|---|---|---|");
    for (width, (boxes, blocked)) in widths {
        println!(
            "| {} to {} | {boxes} | {blocked} |",
            width * 100,
            width * 100 + 100
        );
    }
    Ok(())
}
