//! S2's decision in the program's own loop: it spares S1 what it can, touches nobody, and its logs
//! replay.

mod common;

use common::{Rig, seeds};
use sidestep_hw::config::RobotConfig;
use sidestep_hw::{base, decide, log, replay};
use sidestep_sim::scenario::{APPROACH, Knobs, Scenario};
use std::io::BufReader;

/// A tenth of each sonar's readings are false echoes, a tenth of its echoes are lost.
fn bad_sonars() -> Knobs {
    let mut knobs = Knobs::default();
    knobs.sonar_faults.false_echo = 0.1;
    knobs.sonar_faults.dropout = 0.1;
    knobs
}

/// What S1 does about nothing is at least halved, nobody is touched, and nobody is driven on at more
/// often. In the chapter are the figures for a thousand seeds.
#[test]
fn unnecessary_maneuvers_and_stops_are_halved() {
    let config = decide::table_1().expect("S2's Table 1");
    for scenario in [APPROACH, "empty-room", "fig12-head-on"] {
        let compared = decide::compare(scenario, seeds(20), &bad_sonars(), &config, |_| ());
        let compared = compared.expect("a comparison");
        let (alone, decided) = (&compared.alone, &compared.decided);
        println!("{scenario}\n{}", compared.table());
        assert_eq!((alone.contacts, decided.contacts), (0, 0), "{scenario}");
        assert!(
            alone.unnecessary_by_law() > 20,
            "{scenario}: nothing to spare"
        );
        assert!(
            2 * decided.unnecessary_by_law() <= alone.unnecessary_by_law(),
            "{scenario}: {} of {}",
            decided.unnecessary_by_law(),
            alone.unnecessary_by_law()
        );
        assert!(2.0 * decided.unnecessary_turn <= alone.unnecessary_turn);
        // The shield's stops are spared where what appears has to be heard twice.
        let twice = &compared.heard_twice;
        assert_eq!(twice.contacts, 0, "{scenario}");
        assert!(2 * twice.unnecessary() <= alone.unnecessary(), "{scenario}");
        assert!(twice.arrived > alone.arrived, "{scenario}");
    }
}

/// Without faults it changes next to nothing: the same goals are reached, in about the same time.
#[test]
fn good_sonars_are_believed() {
    let config = decide::table_1().expect("S2's Table 1");
    let compared = decide::compare(APPROACH, seeds(20), &Knobs::default(), &config, |_| ());
    let compared = compared.expect("a comparison");
    let (alone, decided) = (&compared.alone, &compared.decided);
    assert_eq!((alone.contacts, decided.contacts), (0, 0));
    assert!(decided.arrived + 2 >= alone.arrived, "{}", compared.table());
    assert!(
        decided.seconds <= 1.2 * alone.seconds,
        "{}",
        compared.table()
    );
}

/// The log says which law drove, and a replay with that law makes the very same decisions.
#[test]
fn a_log_of_the_decision_replays() {
    let config = RobotConfig {
        core: decide::table_1().expect("S2's Table 1").core,
        ..RobotConfig::default()
    };
    let mut knobs = bad_sonars();
    knobs.sonar_faults.false_echo = 0.01;
    let scenario = Scenario::named(APPROACH, &knobs).expect("a scenario");
    let ring = base::ring::<16>(&config).expect("a ring");
    let settings = decide::settings(&config).expect("usual");
    let mut rig = Rig::new(&scenario, &config, decide::law(config.core, ring, settings));
    rig.pilot.set_law_name(decide::NAME);
    while rig.now() < 30_000 {
        rig.step();
    }
    let bytes = rig.log.bytes();
    let mut log = log::read(BufReader::new(&bytes[..])).expect("a log");
    assert_eq!(log.header.law, decide::NAME);
    let replayed = replay::log(&log).expect("a replay");
    assert!(
        replayed.ticks > 200 && replayed.parting.is_none(),
        "{replayed:?}"
    );
    // Another law decides otherwise, and one that there is not is refused by name.
    log.header.law = "avoid".to_owned();
    assert!(replay::log(&log).expect("a replay").parting.is_some());
    log.header.law = "nonsense".to_owned();
    let error = replay::log(&log).expect_err("refused");
    assert!(error.contains("nonsense"), "{error}");
}
