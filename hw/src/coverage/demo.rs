//! `sidestep demo coverage`: a floor covered edge by edge, and what was in the way.

use super::draw::{Picture, draw};
use super::drive::{self, Happening, Job, Run};
use super::floor::Floor;
use super::progress::Progress;
use super::roadmap::{Roadmap, Rules};
use super::route::Step;
use crate::demo::{Options, run_folder};
use crate::drive::Status;
use crate::edge::corridor_base;
use crate::laser;
use std::error::Error;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::PathBuf;

/// What the scenario is called.
pub const NAME: &str = "coverage";

/// The floor of the demonstration: twenty edges, five boxes that its map does not have.
pub const CORRIDORS: &str = include_str!("../../floors/corridors.toml");

/// Slowest that a coverage may be on the whole, m/s: what takes longer is given up.
const SLOWEST: f64 = 0.04;

/// Covers the floor of `options.data`, or the one of the demonstration, in virtual time, and leaves a
/// run folder.
///
/// # Errors
/// If the floor cannot be read or covered, or the folder not be written.
pub fn run(options: &Options, status: &mut Status) -> Result<(PathBuf, Run), Box<dyn Error>> {
    let floor = match &options.data {
        Some(file) => Floor::read(file)?,
        None => Floor::parse(CORRIDORS, None)?,
    };
    let rules = Rules::default();
    let roadmap = Roadmap::new(&floor, &rules)?;
    let planned: Vec<Step> = Progress::new(&roadmap).plan().collect();
    let folder = run_folder(&options.out, NAME)?;
    status.keep(&format!(
        "== {NAME}: {}: {} edges, {:.1} m; the route is {:.1} m\n   picture and scans in {}",
        floor.name,
        roadmap.passages.len(),
        roadmap.length(),
        super::route::length(&roadmap, &planned),
        folder.display()
    ));
    let limit = 2.0 * roadmap.length() / SLOWEST;
    let job = Job {
        floor: &floor,
        roadmap: &roadmap,
        config: corridor_base()?,
        edge: sidestep::edge::PAPER,
        seed: options.knobs.seed,
        sonar_faults: options.knobs.sonar_faults,
        time_limit_ms: (limit * 1000.0) as u64,
    };
    let run = drive::run(&job, |t, happening| {
        status.keep(&format!("{:7.1} s  {}", t as f64 / 1000.0, said(happening)));
    })?;
    let text = summary(&run, &roadmap);
    fs::write(folder.join("summary.txt"), &text)?;
    let mut scans = BufWriter::new(File::create(folder.join("scans.jsonl"))?);
    for scan in &run.scans {
        laser::write(&mut scans, scan)?;
    }
    scans.flush()?;
    let notes: Vec<String> = text.lines().map(str::to_owned).collect();
    let picture = draw(&Picture {
        title: &format!("{NAME}: {}", floor.name),
        notes: &notes,
        floor: &floor,
        roadmap: &roadmap,
        planned: &planned,
        run: Some(&run),
    });
    fs::write(folder.join("picture.svg"), picture)?;
    status.keep(&text);
    Ok((folder, run))
}

fn said(happening: &Happening) -> String {
    match happening {
        Happening::Covered(id) => format!("{id} covered"),
        Happening::Detected(at) => format!("something on the edge at {:.2}, {:.2}", at.x, at.y),
        Happening::Passable => "room enough to pass".to_owned(),
        Happening::Blocked(id, at) => format!("{id} blocked at {:.2}, {:.2}", at.x, at.y),
        Happening::Stuck => "stuck: no way back".to_owned(),
    }
}

/// What came of a run, for people.
fn summary(run: &Run, roadmap: &Roadmap) -> String {
    let outcome = &run.simulation.outcome();
    let too_near = roadmap
        .passages
        .iter()
        .map(|p| p.too_near.len())
        .sum::<usize>();
    let mut text = format!("{}\n", run.report);
    text += &format!(
        "home again: {}; {:.0} s, {:.1} m by the wheels, {} scans\n",
        if run.is_home { "yes" } else { "no" },
        outcome.duration_ms as f64 / 1000.0,
        outcome.travelled,
        run.scans.len()
    );
    if roadmap.cut_off > 0.0 {
        text += &format!(
            "no way leads to {:.1} m of the diagram, insides of blocks among them\n",
            roadmap.cut_off
        );
    }
    text += &format!(
        "contacts while moving: {}; least clearance {:.2} m; ends with a wall too near ahead: {too_near}\n",
        run.summary.contacts_while_moving(),
        outcome.minimum_clearance_while_driving.obstacles
    );
    text
}
