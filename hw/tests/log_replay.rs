//! Logs: complete enough to replay a run to the last bit, and honest about what is wrong with them.

mod common;

use common::{Random, Rig, inconsiderate};
use serde_json::Value;
use sidestep::config::{Config, FIELDS, Parameters};
use sidestep_hw::config::{HeadingSource, RobotConfig, Sonars, parse};
use sidestep_hw::log::{self, Header, Log, Record};
use sidestep_hw::replay;

/// The log of a run with stops, limits, a lost link and an end.
fn run(config: &RobotConfig) -> Vec<u8> {
    let mut rig = Rig::new(
        &inconsiderate("fig12-crossing", 0.1),
        config,
        common::usual(config),
    );
    rig.wait(6000);
    rig.to_host = Box::new(|_, _| Vec::new());
    rig.wait(2000);
    rig.to_host = common::good_line();
    assert!(rig.drive(90_000));
    rig.finish();
    rig.log.bytes()
}

fn read(bytes: &[u8]) -> Log {
    log::read(bytes).expect("the log is readable")
}

/// The lines of a log as values, to be tampered with.
fn values(bytes: &[u8]) -> Vec<Value> {
    let text = std::str::from_utf8(bytes).unwrap();
    let parsed = text.lines().map(|line| serde_json::from_str(line).unwrap());
    parsed.collect()
}

fn lines(values: &[Value]) -> Vec<u8> {
    let lines = values.iter().map(|value| format!("{value}\n"));
    lines.collect::<String>().into_bytes()
}

#[test]
fn a_run_replays_bit_for_bit() {
    // S1's robot, and one with values that no decimal fraction hits.
    for toml in [
        "",
        "heading = \"compass\"\nspeed_max = \"33.3333 cm/s\"\nstop_time = \"0.7 s\"\n\
         hold_time = \"1234.5 ms\"\nview_half_angle = \"31 deg\"",
    ] {
        let bytes = run(&parse(toml, "test").unwrap());
        let log = read(&bytes);
        assert_eq!(log.cut, None);
        let replayed = replay::log(&log).unwrap();
        assert_eq!(replayed.parting, None);
        assert_eq!(replayed.ticks as u64, common::decisions(&log));
        assert!(replayed.ticks > 100);
        let has =
            |wanted: fn(&Record) -> bool| log.records.iter().any(|(_, record)| wanted(record));
        assert!(has(|record| matches!(record, Record::Halt { .. })));
        assert!(has(|record| matches!(record, Record::Event { .. })));
        assert!(has(
            |record| matches!(record, Record::Tick { told, .. } if told.v > 0)
        ));
        assert!(has(
            |record| matches!(record, Record::Tick { told, .. } if told.stop.is_some())
        ));
        assert!(has(
            |record| matches!(record, Record::Tick { told, .. } if told.limit.is_some())
        ));
        // Reading and writing again gives the same lines: nothing of a record is lost on the way.
        let mut written = Vec::new();
        for (_, record) in &log.records {
            log::write_line(&mut written, record).unwrap();
        }
        let header = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        assert!(written == bytes[header..], "the records change");
    }
}

#[test]
fn the_same_run_gives_the_same_log() {
    let config = RobotConfig::default();
    assert!(run(&config) == run(&config), "the logs differ");
}

#[test]
fn a_changed_decision_is_reported_where_it_is() {
    let bytes = run(&RobotConfig::default());
    let original = values(&bytes);
    let told = |value: &Value| value.get("told").is_some();
    let decided: Vec<usize> = (0..original.len())
        .filter(|i| told(&original[*i]))
        .collect();
    // The first, the last, and some between.
    let last = decided.len() - 1;
    for index in [0, 1, last / 3, last / 2, last] {
        let line = decided[index];
        for (field, change) in [
            ("v", Value::from(77_777)),
            ("w", Value::from(-77_777)),
            ("mode", Value::from("sleep")),
            ("stop", Value::from("no reason")),
            ("limit", Value::from("no limit")),
        ] {
            let mut changed = original.clone();
            changed[line]["told"][field] = change;
            let replayed = replay::log(&read(&lines(&changed))).unwrap();
            let (at, logged, decided) = replayed.parting.expect("the change is noticed");
            assert_eq!(at, line + 1, "{field}");
            assert_ne!(logged, decided);
            assert_eq!(replayed.ticks, index + 1);
        }
    }
}

#[test]
fn a_changed_packet_is_noticed() {
    let bytes = run(&RobotConfig::default());
    let original = values(&bytes);
    let line = original
        .iter()
        .position(|value| value["told"]["v"].as_i64() > Some(150))
        .expect("the robot drives");
    let sip = original[line]["sip"].as_str().unwrap();
    for (sip, error) in [
        (format!("0{sip}"), "not hexadecimal"),
        (sip.replace("fafb", "fbfa"), "header"),
        (sip[..sip.len() - 4].to_owned() + "0000", "checksum"),
        (sip[..sip.len() - 4].to_owned(), ""),
        ("é".repeat(20), "not hexadecimal"),
        (String::new(), ""),
    ] {
        let mut changed = original.clone();
        changed[line]["sip"] = Value::from(sip);
        let message = replay::log(&read(&lines(&changed))).expect_err("refused");
        assert!(
            message.starts_with(&format!("line {}: sip: ", line + 1)),
            "{message}"
        );
        assert!(message.to_lowercase().contains(error), "{message}");
    }
}

/// A robot that lost its power has such a log.
#[test]
fn a_log_that_ends_in_the_middle_of_a_line_replays_up_to_there() {
    let bytes = run(&RobotConfig::default());
    let whole = read(&bytes);
    let starts: Vec<usize> = [0]
        .into_iter()
        .chain(
            (0..bytes.len())
                .filter(|i| bytes[*i] == b'\n')
                .map(|i| i + 1),
        )
        .collect();
    // A line of every kind.
    let kinds: [fn(&Record) -> bool; 3] = [
        |record| matches!(record, Record::Tick { told, .. } if told.stop.is_some()),
        |record| matches!(record, Record::Halt { .. }),
        |record| matches!(record, Record::Event { .. }),
    ];
    for kind in kinds {
        let (line, _) = whole
            .records
            .iter()
            .find(|(_, record)| kind(record))
            .expect("there is one");
        let (start, end) = (starts[line - 1], starts[*line] - 1);
        for cut in start + 1..end {
            let log = read(&bytes[..cut]);
            assert_eq!(log.cut, Some(*line), "{cut}");
            assert_eq!(log.records.len(), line - 2);
            assert_eq!(log.records, whole.records[..line - 2]);
        }
        let replayed = replay::log(&read(&bytes[..end - 1])).unwrap();
        assert_eq!(replayed.parting, None);
        // Whole but for the line feed: nothing is missing.
        let log = read(&bytes[..end]);
        assert_eq!((log.cut, log.records.len()), (None, line - 1));
        let log = read(&bytes[..start]);
        assert_eq!((log.cut, log.records.len()), (None, line - 2));
    }
}

#[test]
fn garbage_is_an_error_that_names_its_line() {
    let bytes = run(&RobotConfig::default());
    let text = String::from_utf8(bytes).unwrap();
    let original: Vec<&str> = text.lines().collect();
    let half = original[9].split_at(original[9].len() / 2).0;
    for (garbage, line) in [
        ("garbage", 10),
        ("", 10),
        (half, 10),
        ("{}", 10),
        ("{\"kind\":\"tock\",\"t\":1}", 10),
        ("{\"kind\":\"event\",\"t\":1,\"text\":\"x\",\"more\":2}", 10),
        ("{\"kind\":\"event\",\"t\":-1,\"text\":\"x\"}", 10),
        ("\u{0}\u{0}\u{0}", 10),
    ] {
        let mut changed = original.clone();
        changed[line - 1] = garbage;
        let message = log::read(changed.join("\n").as_bytes()).expect_err(garbage);
        assert!(message.starts_with(&format!("line {line}: ")), "{message}");
    }
    // At the end, too, garbage is no line that was cut off.
    let with_garbage = text.clone() + "garbage\n";
    assert!(log::read(with_garbage.as_bytes()).is_err());
    let mut not_text = text.clone().into_bytes();
    not_text.extend([0xFF, 0xFE, b'\n']);
    assert!(log::read(not_text.as_slice()).is_err());
    for no_log in [
        "",
        "\n",
        "garbage\n",
        "{\"kind\":\"event\",\"t\":1,\"text\":\"x\"}\n",
    ] {
        assert!(log::read(no_log.as_bytes()).is_err(), "{no_log:?}");
    }
    let without_header = original[1..].join("\n");
    let message = log::read(without_header.as_bytes()).unwrap_err();
    assert!(message.starts_with("line 1: no header"), "{message}");
}

/// Something that is done to a header.
type Change<'a> = &'a dyn Fn(&mut Value);

#[test]
fn a_header_that_is_not_in_order_is_refused() {
    let bytes = run(&RobotConfig::default());
    let original = values(&bytes);
    let refusal = |change: Change<'_>| {
        let mut changed = original.clone();
        change(&mut changed[0]);
        let result = log::read(lines(&changed).as_slice()).and_then(|log| replay::log(&log));
        result.expect_err("refused")
    };
    let cases: [(Change<'_>, &str); 10] = [
        (
            &|header| header["parameters"]["warp"] = 9.into(),
            "unknown parameter warp",
        ),
        (
            &|header| {
                header["parameters"]
                    .as_object_mut()
                    .unwrap()
                    .remove("braking");
            },
            "parameter braking is missing",
        ),
        (
            &|header| header["parameters"]["speed_max"] = 50.into(),
            "speed_max is 50 m/s, allowed is",
        ),
        (
            &|header| header["parameters"]["near_distance"] = 1.3.into(),
            "near_distance is 1.3 m",
        ),
        // Too great for an f32.
        (
            &|header| header["parameters"]["speed_max"] = 1e300.into(),
            "speed_max is inf m/s",
        ),
        (&|header| header["log"] = 2.into(), "log is version 2"),
        (&|header| header["colour"] = "red".into(), "unknown field"),
        (&|header| header["sonars"] = "p3dx-9".into(), "p3dx-9"),
        (&|header| header["subclass"] = "r2d2".into(), "r2d2"),
        (&|header| header["goal"][0] = 1e9.into(), "goal x"),
    ];
    for (change, expected) in cases {
        let message = refusal(change);
        assert!(message.starts_with("line 1: "), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

/// Every value of every parameter comes back as the same bits, or the replay would part.
#[test]
fn a_header_keeps_every_bit() {
    let mut random = Random(7);
    let mut kept = 0;
    while kept < 1000 {
        let mut values = RobotConfig::default().core.values();
        // A few at a time: most of what is random altogether does not fit together.
        for _ in 0..4 {
            let index = random.below(FIELDS.len());
            let field = &FIELDS[index];
            values[index] = match field.unit {
                "samples" => random.below(field.max as usize) as f32 + 1.0,
                _ => {
                    let share = random.unit() as f32;
                    field.min + share * (field.max - field.min)
                }
            };
        }
        let Ok(core) = Config::new(Parameters::from_values(values)) else {
            continue;
        };
        let config = RobotConfig {
            core,
            sonars: [Sonars::Front8, Sonars::All16][random.below(2)],
            heading: [
                HeadingSource::Odometry,
                HeadingSource::Compass,
                HeadingSource::CompassClockwise,
            ][random.below(3)],
        };
        let goal = [0, 1].map(|_| (random.unit() as f32 - 0.5) * 2000.0);
        let header = Header::new(&config, "p3dx", goal);
        let mut line = Vec::new();
        log::write_line(&mut line, &header).unwrap();
        let back = log::read(line.as_slice()).unwrap().header;
        let bits = |config: &RobotConfig| config.core.values().map(f32::to_bits);
        let config_back = back.config().unwrap();
        assert_eq!(bits(&config_back), bits(&config));
        assert_eq!(
            (config_back.sonars, config_back.heading),
            (config.sonars, config.heading)
        );
        let goal_back = back.goal.map(|coordinate| (coordinate as f32).to_bits());
        assert_eq!(goal_back, goal.map(f32::to_bits));
        kept += 1;
    }
}
