//! The configuration file: TOML, one line per parameter, every value with its unit.
//!
//! The parameters, their ranges and their meanings are the core's ([`sidestep::config::FIELDS`]);
//! this file only reads and writes them. A value without a unit, with a unit of another kind, or
//! out of range is refused with file, line, field, value and range.

use sidestep::config::{Config, FIELDS, Field, Parameters};
use sidestep::preset;
use std::fmt;
use std::fmt::Write as _;
use toml::Spanned;

/// Units by the unit of the parameter they give, with what one of them is in it.
const UNITS: [(&str, &[(&str, f64)]); 8] = [
    ("m", &[("m", 1.0), ("cm", 0.01), ("mm", 0.001)]),
    ("m/s", &[("m/s", 1.0), ("cm/s", 0.01), ("mm/s", 0.001)]),
    (
        "m/s^2",
        &[("m/s^2", 1.0), ("cm/s^2", 0.01), ("mm/s^2", 0.001)],
    ),
    ("s", &[("s", 1.0), ("ms", 0.001)]),
    (
        "rad",
        &[("deg", std::f64::consts::PI / 180.0), ("rad", 1.0)],
    ),
    (
        "rad/s",
        &[("deg/s", std::f64::consts::PI / 180.0), ("rad/s", 1.0)],
    ),
    (
        "rad/s^2",
        &[("deg/s^2", std::f64::consts::PI / 180.0), ("rad/s^2", 1.0)],
    ),
    ("1/s", &[("1/s", 1.0)]),
];

/// Which sonars the robot has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Sonars {
    /// The P3-DX's front array of eight.
    #[serde(rename = "p3dx-8")]
    Front8,
    /// The P3-DX's sixteen, all round.
    #[default]
    #[serde(rename = "p3dx-16")]
    All16,
}

/// Where the heading comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HeadingSource {
    /// The base's odometry.
    #[default]
    Odometry,
    /// The base's compass, relative to where it pointed first, counting counter-clockwise.
    Compass,
    /// The base's compass, counting clockwise.
    #[serde(rename = "compass-clockwise")]
    CompassClockwise,
}

/// A robot's configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotConfig {
    /// The core's parameters, checked.
    pub core: Config,
    /// Which sonars the robot has.
    pub sonars: Sonars,
    /// Where the heading comes from.
    pub heading: HeadingSource,
}

/// Why a configuration was refused.
#[derive(Debug)]
pub struct ConfigError(String);

impl ConfigError {
    pub(crate) const fn new(message: String) -> Self {
        Self(message)
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for ConfigError {}

/// The presets by name.
#[must_use]
pub fn preset(name: &str) -> Option<Parameters> {
    match name {
        "pioneer_3dx" => Some(preset::PIONEER_3DX),
        "corridor_base" => Some(preset::CORRIDOR_BASE),
        "srikandi_ii_2012" => Some(preset::SRIKANDI_II_2012),
        "srikandi_ii_2011" => Some(preset::SRIKANDI_II_2011),
        _ => None,
    }
}

impl Default for RobotConfig {
    /// The Pioneer 3-DX with sixteen sonars.
    fn default() -> Self {
        let core = Config::new(preset::PIONEER_3DX);
        Self {
            core: core.expect("the preset is valid: a test shows it"),
            sonars: Sonars::default(),
            heading: HeadingSource::default(),
        }
    }
}

/// The units in which a parameter may be given, the one used for printing first.
fn units_of(field: &Field) -> &'static [(&'static str, f64)] {
    UNITS
        .iter()
        .find(|(unit, _)| *unit == field.unit)
        .map_or(&[], |(_, units)| units)
}

/// A parameter's value as text: the shortest that reads back as the same value.
pub(crate) fn text_of(field: &Field, value: f32) -> String {
    match units_of(field).first() {
        None => format!("{value}"),
        Some((unit, factor)) => {
            let number = f64::from(value) / factor;
            let text = (0..=9)
                .map(|digits| format!("{number:.digits$}"))
                .find(|text| {
                    text.parse::<f64>()
                        .is_ok_and(|rounded| (rounded * factor) as f32 == value)
                });
            format!("\"{} {unit}\"", text.unwrap_or_else(|| number.to_string()))
        }
    }
}

/// The default configuration as commented TOML.
#[must_use]
pub fn default_toml() -> String {
    let mut text = String::from(
        "# Configuration of sidestep. Every line shows its default and may be left out.\n\
         # Lengths: m, cm, mm. Speeds: m/s, cm/s, mm/s. Times: s, ms. Angles: deg, rad.\n\n\
         # Start from another robot's values: pioneer_3dx, corridor_base, srikandi_ii_2012, srikandi_ii_2011.\n\
         preset = \"pioneer_3dx\"\n\
         # Sonars fitted: p3dx-16, or p3dx-8 for the front array only. What no sonar sees is not\n\
         # guarded: with p3dx-8 the robot must not be approached from behind.\n\
         sonars = \"p3dx-16\"\n\
         # Where the heading comes from: odometry or compass.\n\
         heading = \"odometry\"\n",
    );
    let values = RobotConfig::default().core.values();
    for (field, value) in FIELDS.iter().zip(values) {
        let _ = write!(
            text,
            "\n# {}\n# Allowed: {} to {}.\n{} = {}\n",
            field.meaning,
            text_of(field, field.min).trim_matches('"'),
            text_of(field, field.max).trim_matches('"'),
            field.name,
            text_of(field, value),
        );
    }
    text
}

/// Reads a configuration; `file` names it in errors.
///
/// # Errors
/// The first thing that is wrong, with file, line, field, value and what is allowed.
pub fn parse(text: &str, file: &str) -> Result<RobotConfig, ConfigError> {
    let line_of = |offset: usize| {
        let before = text.get(..offset).unwrap_or(text);
        before.bytes().filter(|byte| *byte == b'\n').count() + 1
    };
    let fail = |offset: usize, message: String| {
        ConfigError(format!("{file}:{}: {message}", line_of(offset)))
    };
    let entries: std::collections::BTreeMap<Spanned<String>, Spanned<toml::Value>> =
        toml::from_str(text).map_err(|error| {
            let offset = error.span().map_or(0, |span| span.start);
            fail(offset, error.message().to_owned())
        })?;

    let mut parameters = preset::PIONEER_3DX;
    let (mut sonars, mut heading) = (Sonars::default(), HeadingSource::default());
    let mut lines = std::collections::BTreeMap::new();
    let word = |value: &Spanned<toml::Value>, field: &str, allowed: &str| {
        value
            .get_ref()
            .as_str()
            .map(str::to_owned)
            .ok_or_else(|| wrong_word(field, value.get_ref(), allowed))
            .map_err(|message| fail(value.span().start, message))
    };
    // The preset first: every other line changes it.
    for (key, value) in &entries {
        if key.get_ref() == "preset" {
            let allowed = "pioneer_3dx, corridor_base, srikandi_ii_2012 or srikandi_ii_2011";
            let name = word(value, "preset", allowed)?;
            parameters = preset(&name).ok_or_else(|| {
                fail(
                    value.span().start,
                    wrong_word("preset", value.get_ref(), allowed),
                )
            })?;
        }
    }
    let mut values = parameters.values();
    for (key, value) in &entries {
        let name = key.get_ref().as_str();
        let at = value.span().start;
        match name {
            "preset" => {}
            "sonars" => {
                sonars = match word(value, name, "p3dx-8 or p3dx-16")?.as_str() {
                    "p3dx-8" => Sonars::Front8,
                    "p3dx-16" => Sonars::All16,
                    _ => {
                        let message = wrong_word(name, value.get_ref(), "p3dx-8 or p3dx-16");
                        return Err(fail(at, message));
                    }
                };
            }
            "heading" => {
                let allowed = "odometry, compass or compass-clockwise";
                heading = match word(value, name, allowed)?.as_str() {
                    "odometry" => HeadingSource::Odometry,
                    "compass" => HeadingSource::Compass,
                    "compass-clockwise" => HeadingSource::CompassClockwise,
                    _ => {
                        let message = wrong_word(name, value.get_ref(), allowed);
                        return Err(fail(at, message));
                    }
                };
            }
            _ => {
                let Some(index) = FIELDS.iter().position(|field| field.name == name) else {
                    return Err(fail(
                        key.span().start,
                        format!("unknown key {name}; `sidestep config` lists all there are"),
                    ));
                };
                values[index] = quantity(&FIELDS[index], value.get_ref())
                    .map_err(|message| fail(at, message))?;
                lines.insert(name.to_owned(), at);
            }
        }
    }
    let core = Config::new(Parameters::from_values(values)).map_err(|error| {
        let field = FIELDS.iter().find(|field| field.name == error.field);
        let show = |value: f32| match field {
            Some(field) if value.is_finite() => text_of(field, value).trim_matches('"').to_owned(),
            _ => format!("{value} {}", error.unit),
        };
        fail(
            lines.get(error.field).copied().unwrap_or(text.len()),
            format!(
                "{} is {}, allowed is {} to {}",
                error.field,
                show(error.value),
                show(error.min),
                show(error.max)
            ),
        )
    })?;
    Ok(RobotConfig {
        core,
        sonars,
        heading,
    })
}

fn wrong_word(field: &str, value: &toml::Value, allowed: &str) -> String {
    format!("{field} is {value}, allowed is {allowed}")
}

/// A parameter's value in its own unit, from text such as `"40 cm/s"` or, for counts, a number.
pub(crate) fn quantity(field: &Field, value: &toml::Value) -> Result<f32, String> {
    let units = units_of(field);
    let names: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
    if units.is_empty() {
        return match value {
            toml::Value::Integer(count) => Ok(*count as f32),
            toml::Value::Float(number) => Ok(*number as f32),
            _ => Err(format!(
                "{} is {value}, allowed is a whole number from {} to {}",
                field.name, field.min, field.max
            )),
        };
    }
    let expected = || {
        format!(
            "{} is {value}, allowed is {} to {}, as text with a unit: {}",
            field.name,
            text_of(field, field.min).trim_matches('"'),
            text_of(field, field.max).trim_matches('"'),
            names.join(", ")
        )
    };
    let text = value.as_str().ok_or_else(expected)?.trim();
    let split = text
        .find(|c: char| c.is_ascii_alphabetic() || c == '/')
        .filter(|split| !text[..*split].trim().is_empty());
    // "1/s" begins like a number: the unit is what stands after the last blank.
    let (number, unit) = match text.rsplit_once(char::is_whitespace) {
        Some((number, unit)) => (number, unit),
        None => split.map_or((text, ""), |split| text.split_at(split)),
    };
    let factor = units
        .iter()
        .find(|(name, _)| *name == unit.trim())
        .map(|(_, factor)| *factor)
        .ok_or_else(expected)?;
    let number: f64 = number.trim().parse().map_err(|_| expected())?;
    Ok((number * factor) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_reads_back() {
        let parsed = parse(&default_toml(), "default").expect("the default is valid");
        assert_eq!(parsed, RobotConfig::default());
    }

    #[test]
    fn every_preset_is_valid() {
        for name in [
            "pioneer_3dx",
            "corridor_base",
            "srikandi_ii_2012",
            "srikandi_ii_2011",
        ] {
            let text = format!("preset = \"{name}\"\n");
            let parsed = parse(&text, name).expect(name);
            assert_eq!(Some(*parsed.core.parameters()), preset(name));
        }
    }

    /// What is refused, and what the refusal must name.
    #[test]
    fn bad_lines_are_named() {
        let cases = [
            (
                "\nspeed = \"1 m/s\"\n",
                vec!["robot.toml:2", "unknown key speed"],
            ),
            (
                "speed_max = \"40 cm\"\n",
                vec!["robot.toml:1", "speed_max", "40 cm", "0.02 m/s to 2 m/s"],
            ),
            (
                "speed_max = 0.4\n",
                vec!["robot.toml:1", "speed_max", "0.4", "unit"],
            ),
            (
                "\n\nspeed_max = \"9 m/s\"\n",
                vec!["robot.toml:3", "speed_max", "9 m/s", "0.02 m/s to 2 m/s"],
            ),
            (
                "speed_max = \"nan m/s\"\n",
                vec!["robot.toml:1", "speed_max", "NaN", "2 m/s"],
            ),
            (
                "near_distance = \"130 cm\"\n",
                vec!["robot.toml:1", "near_distance", "1.3 m", "0.4 m to 1.2 m"],
            ),
            (
                "resume_samples = 2.5\n",
                vec!["robot.toml:1", "resume_samples", "2.5", "1 to 50"],
            ),
            (
                "sonars = \"ring\"\n",
                vec!["robot.toml:1", "sonars", "p3dx-8"],
            ),
            ("heading = 3\n", vec!["robot.toml:1", "heading", "compass"]),
            (
                "preset = \"r2d2\"\n",
                vec!["robot.toml:1", "preset", "r2d2"],
            ),
            ("speed_max = \n", vec!["robot.toml:1"]),
            (
                "speed_max = \"1 m/s\"\nspeed_max = \"1 m/s\"\n",
                vec!["robot.toml:2", "duplicate"],
            ),
        ];
        for (text, parts) in cases {
            let message = parse(text, "robot.toml").expect_err(text).to_string();
            for part in parts {
                assert!(message.contains(part), "{message:?} lacks {part:?}");
            }
        }
    }

    #[test]
    fn units_convert() {
        let parsed = parse(
            "speed_max=\"35cm/s\"\nheading_gain = \"1.5 1/s\"\nview_half_angle = \"20 deg\"",
            "t",
        )
        .expect("valid");
        assert_eq!(parsed.core.speed_max, 0.35);
        assert_eq!(parsed.core.heading_gain, 1.5);
        assert!((parsed.core.view_half_angle - 20_f32.to_radians()).abs() < 1e-6);
    }
}
