//! The numbers of the law book's chapter shield are those of the code.

use sidestep::arcos::BaseParameters;
use sidestep::config::{Config, Parameters};
use sidestep::preset;
use sidestep::ring::{Closing, Placement, Ring};
use sidestep::shield::{Guard, Limits, Motion, greatest};
use sidestep::view::{Class, Hazard};

const PRESETS: [(&str, Parameters); 3] = [
    ("PIONEER_3DX", preset::PIONEER_3DX),
    ("SRIKANDI_II_2012", preset::SRIKANDI_II_2012),
    ("SRIKANDI_II_2011", preset::SRIKANDI_II_2011),
];

const AHEAD: Closing = Closing {
    ahead: 1000,
    back: 0,
    face: [0, 1000],
};

const BESIDE: Closing = Closing {
    ahead: 260,
    ..AHEAD
};

/// A thing with this clearance (mm) that is seen now.
fn seen(clearance: i32, class: Class) -> Hazard {
    Hazard {
        range: clearance,
        clearance,
        age: 0,
        way: [0; 2],
        turned: 0,
        class,
        too_fast: false,
        stuck: false,
    }
}

fn config(parameters: Parameters) -> Config {
    Config::new(parameters).expect("a preset")
}

fn fits(guard: &Guard, speed: i32, turn_rate: i32, hazard: &Hazard, closing: &Closing) -> bool {
    guard
        .plan(speed, turn_rate, &Motion::REST)
        .is_some_and(|plan| guard.limits().fits(hazard, closing, &plan))
}

/// The least clearance (mm) with which a command is admitted.
fn needed(guard: &Guard, speed: i32, turn_rate: i32, class: Class, closing: &Closing) -> i32 {
    (0..10_000)
        .find(|&clearance| fits(guard, speed, turn_rate, &seen(clearance, class), closing))
        .expect("there is enough at ten metres")
}

/// The greatest speed (mm/s) that a clearance admits.
fn admitted(guard: &Guard, class: Class, clearance: i32) -> i32 {
    greatest(12, guard.limits().speed_max(), |speed| {
        fits(guard, speed, 0, &seen(clearance, class), &AHEAD)
    })
}

/// The greatest steady speed (mm/s) along the middle of a corridor, with the P3-DX's sixteen sonars.
fn in_corridor(config: &Config, guard: &Guard, class: Class, width: f32) -> i32 {
    let placements: [Placement; 16] = BaseParameters::P3DX
        .sonars
        .iter()
        .map(|at| Placement::from_mm_deg(at.x_mm, at.y_mm, at.heading_deg))
        .collect::<Vec<_>>()
        .try_into()
        .expect("sixteen sonars");
    let ring = Ring::new(&placements, config).expect("the P3-DX's ring");
    greatest(12, guard.limits().speed_max(), |speed| {
        ring.sonars().iter().all(|sonar| {
            let (axis, half) = (sonar.heading.get().abs(), config.sonar_half_angle);
            // The part of the cone that is nearest to straight across.
            let across = (core::f32::consts::FRAC_PI_2 - axis).abs();
            let cosine = (across - half).max(0.0).cos();
            let range = (width / 2.0 - sonar.position.y.abs()) / cosine;
            let clearance = (range * 1000.0) as i32
                - sonar.contact_range
                - (config.range_error * 1000.0) as i32;
            fits(guard, speed, 0, &seen(clearance, class), &sonar.closing)
        })
    })
}

/// The lines of the chapter, as the code has them.
fn lines() -> Vec<String> {
    let mut lines = Vec::new();
    for (name, parameters) in PRESETS {
        let config = config(parameters);
        let guard = Guard::new(&config);
        let limits = Limits::new(&config);
        let contact = if name == "PIONEER_3DX" { 140 } else { 89 };
        let cruise = (config.cruise_speed * 1000.0).round() as i32;
        for (speed, text) in [
            (1, "creep".to_owned()),
            (cruise, format!("{cruise} (cruise)")),
            (
                limits.speed_max(),
                format!("{} (v_max)", limits.speed_max()),
            ),
        ] {
            let need = |class, closing| needed(&guard, speed, 0, class, closing);
            let ahead = need(Class::Unknown, &AHEAD);
            let first = if speed == 1 {
                format!(
                    "`{name}` | {} ms, {}, {}, {} mm/s",
                    limits.reaction_time(),
                    limits.speed_gain(),
                    limits.class_speed(Class::Unknown),
                    limits.class_speed(Class::Still),
                )
            } else {
                "|".to_owned()
            };
            let unit = if speed == 1 { " mm" } else { "" };
            lines.push(format!(
                "| {first} | {text} | {ahead}{unit} | {}{unit} | {}{unit} | {}{unit} | {}{unit} |",
                ahead + contact + 20,
                need(Class::Still, &AHEAD),
                need(Class::Unknown, &BESIDE),
                need(Class::Still, &BESIDE),
            ));
        }
    }
    for (name, parameters) in PRESETS {
        let guard = Guard::new(&config(parameters));
        for (class, word) in [(Class::Unknown, "unknown"), (Class::Still, "still")] {
            let speeds = [300, 400, 500, 600, 700, 800, 1000]
                .map(|clearance| admitted(&guard, class, clearance).to_string());
            let name = if class == Class::Unknown {
                format!("`{name}`")
            } else {
                String::new()
            };
            lines.push(
                format!("| {name} | {word} | {} |", speeds.join(" | ")).replace("|  |", "| |"),
            );
        }
    }
    let turn = PRESETS.map(|(_, parameters)| {
        let guard = Guard::new(&config(parameters));
        let rate = guard.limits().turn_rate_max();
        let [person, still] =
            [Class::Unknown, Class::Still].map(|class| needed(&guard, 0, rate, class, &BESIDE));
        assert_eq!(person, still);
        person.to_string()
    });
    lines.push(format!("| turn | {} |", turn.join(" | ")));
    for (class, width) in [
        (Class::Still, 1.2),
        (Class::Unknown, 1.2),
        (Class::Unknown, 1.5),
        (Class::Unknown, 2.0),
    ] {
        let speeds = PRESETS.map(|(_, parameters)| {
            let config = config(parameters);
            in_corridor(&config, &Guard::new(&config), class, width).to_string()
        });
        lines.push(format!("| {width} m, {class} | {} |", speeds.join(" | ")));
    }
    lines
}

#[test]
fn the_numbers_of_the_law_book_are_the_codes() {
    let book = include_str!("../spec/shield.md");
    let lines = lines();
    let missing: Vec<_> = lines.iter().filter(|line| !book.contains(*line)).collect();
    assert!(
        missing.is_empty(),
        "not in spec/shield.md: {missing:#?}\nall of them:\n{}",
        lines.join("\n")
    );
}
