//! Meetings with people under S3's law, in virtual time: stories told to their end, and nobody ever
//! touched by a robot that moves.

use sidestep::interact::{Announcement, Event, USUAL};
use sidestep_hw::config::RobotConfig;
use sidestep_hw::encounter::{self, Met, STORIES};
use sidestep_hw::episodes::assumptions;

/// Random meetings on an ordinary run; more with `SIDESTEP_SEEDS`.
const MEETINGS: u64 = 40;

fn told(name: &str) -> Met {
    let story = encounter::story(name, 1).expect("a story");
    let met = encounter::run(&story, &RobotConfig::default(), USUAL, None).expect("it runs");
    assert!(met.report.contacts.is_empty(), "{:?}", met.report.contacts);
    assert!(met.report.broken.is_empty(), "{:?}", met.report.broken);
    assert!(met.report.arrived, "{name} does not arrive");
    met
}

/// The states that were entered, in order.
fn states(met: &Met) -> Vec<&'static str> {
    let name = |event: &Event| match event {
        Event::Entered(state) => Some(state.name()),
        _ => None,
    };
    let events = met.happenings.iter().map(|happening| &happening.event);
    events.filter_map(name).collect()
}

fn said(met: &Met, announcement: Announcement) -> bool {
    let said = Event::Say(announcement);
    met.happenings
        .iter()
        .any(|happening| happening.event == said)
}

/// S3 Fig. 8: it asks, is led forward, is sent to one side, and passes.
#[test]
fn figure_8() {
    let met = told("fig8");
    let states = states(&met);
    let order = [
        "announce",
        "stop",
        "ask-interact",
        "wait",
        "master",
        "plan",
        "rotate",
        "traverse",
    ];
    let mut rest = states.iter();
    for state in order {
        assert!(
            rest.any(|found| *found == state),
            "no {state} in {states:?}"
        );
    }
    assert!(
        met.happenings
            .iter()
            .any(|h| matches!(h.event, Event::MasterIs(_)))
    );
    assert!(said(&met, Announcement::RobotInPath) && said(&met, Announcement::Interact));
    // To the right, as the person's left is meant.
    let turned = met
        .happenings
        .iter()
        .find_map(|happening| match happening.event {
            Event::Entered(state) => state.path().map(|path| path.heading().get()),
            _ => None,
        });
    assert!(turned.is_some_and(|heading| heading < 0.0), "{turned:?}");
}

/// S3 Fig. 9: nobody interacts; it chooses for itself, and passes.
#[test]
fn figure_9() {
    let met = told("fig9");
    let states = states(&met);
    assert!(!states.contains(&"master"));
    let passed = states.windows(2).any(|pair| pair == ["traverse", "resume"]);
    assert!(passed, "{states:?}");
}

/// Somebody makes way: it goes on without having planned anything.
#[test]
fn somebody_makes_way() {
    let states = states(&told("make-way"));
    assert!(
        states.contains(&"resume") && !states.contains(&"plan"),
        "{states:?}"
    );
}

/// The pictures show what was said.
#[test]
fn pictures_tell_the_story() {
    for name in STORIES {
        let picture = told(name).picture();
        for part in ["said and done", "Robot in the path", "Interact", "goal"] {
            assert!(picture.contains(part), "{name}: no {part:?}");
        }
    }
    assert!(encounter::story("fig10", 1).is_err());
}

/// Nobody is touched by a robot that moves, unless somebody breaks the promise's bound for what
/// stands still.
#[test]
fn nobody_is_touched_by_a_robot_that_moves() {
    let config = RobotConfig::default();
    let speed = assumptions(&config).person_speed;
    let count = std::env::var("SIDESTEP_SEEDS")
        .ok()
        .and_then(|seeds| seeds.parse().ok())
        .unwrap_or(MEETINGS);
    let (mut passed, mut arrived) = (0, 0);
    for seed in 0..count {
        let meeting = encounter::random(seed, speed, &config).expect("a meeting");
        let met = encounter::run(&meeting, &config, USUAL, None).expect("it runs");
        let report = &met.report;
        assert!(
            report.contacts.is_empty() || !report.broken.is_empty(),
            "seed {seed}: {:?}",
            report.contacts
        );
        passed += u32::from(states(&met).contains(&"traverse"));
        arrived += u32::from(report.arrived);
    }
    // A robot that never moves touches nobody either.
    assert!(passed > 10 && arrived > 5, "{passed} {arrived}");
}
