//! S3's law on a real base: what it has to know of camera and people, and people from a depth camera's
//! program.

use crate::announce::Announcer;
use crate::base;
use crate::config::{ConfigError, RobotConfig, quantity, text_of};
use crate::encounter::Happening;
use crate::pilot::Pilot;
use crate::skeletons::Lines;
use sidestep::config::Field;
use sidestep::gesture::{
    Frame as Picture, Gesture, Model, Recognizer, Settings as GestureSettings,
};
use sidestep::interact::{
    Event, FIELDS, Frame, Interact, LateralAxis, Orders, Parameters, People, Settings, Trial, USUAL,
};
use sidestep::quantity::Instant;
use sidestep::valley::Side;
use std::error::Error;
use std::fmt::Write as _;
use std::io::Write;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// What S3's law has to know beyond the robot's configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Its parameters.
    pub parameters: Parameters,
    /// What left and right mean.
    pub frame: Frame,
    /// What bears that out.
    pub trial: Trial,
}

/// The keys that have no default: name, what is allowed, meaning.
const REQUIRED: [(&str, &str, &str); 6] = [
    (
        "camera_lateral",
        "left or right",
        "Side to which the camera's lateral coordinate is positive: left for a Kinect v2.",
    ),
    (
        "gestures_mean",
        "robot or person",
        "Whose right a gesture to the right means: the robot's, or that of the person who faces it.",
    ),
    (
        "trial_stood",
        "left or right",
        "A trial: let somebody stand beside the camera's axis. The side, seen by the robot...",
    ),
    (
        "trial_lateral",
        "a length",
        "...and the lateral coordinate that `sidestep gestures` or the camera's program gave.",
    ),
    (
        "trial_gesture",
        "left or right",
        "Let them send the robot to one side. The gesture that was recognised...",
    ),
    (
        "trial_meant",
        "left or right",
        "...and the side, seen by the robot, to which they wanted it to go.",
    ),
];

/// The parameters as commented TOML. What has no default is commented out.
#[must_use]
pub fn default_toml() -> String {
    let mut text = String::from(
        "# Meetings with people: S3's law. The lines of the first part have no default. They say\n\
         # what left and right mean, and hold a trial that bears it out: the robot does not drive\n\
         # unless it does.\n",
    );
    for (name, allowed, meaning) in REQUIRED {
        let _ = write!(
            text,
            "\n# {meaning}\n# Allowed: {allowed}.\n# {name} = \"\"\n"
        );
    }
    for (field, value) in FIELDS.iter().zip(USUAL.values()) {
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

impl Meeting {
    /// Reads the parameters; `file` names them in errors.
    ///
    /// # Errors
    /// The first thing that is wrong or missing, with what is allowed.
    pub fn parse(text: &str, file: &str) -> Result<Self, ConfigError> {
        let fail = |message: String| ConfigError::new(format!("{file}: {message}"));
        let table: toml::Table = toml::from_str(text).map_err(|error| fail(error.to_string()))?;
        let mut values = USUAL.values();
        for (name, value) in &table {
            match FIELDS.iter().position(|field| field.name == name) {
                Some(index) => values[index] = quantity(&FIELDS[index], value).map_err(fail)?,
                None if REQUIRED.iter().any(|(known, ..)| known == name) => {}
                None => return Err(fail(format!("unknown key {name}"))),
            }
        }
        let word = |name: &str, one: &str, other: &str| -> Result<bool, ConfigError> {
            match table.get(name).and_then(toml::Value::as_str) {
                Some(word) if word == one => Ok(true),
                Some(word) if word == other => Ok(false),
                found => {
                    let found = found.map_or("missing".to_owned(), |word| format!("{word:?}"));
                    Err(fail(format!(
                        "{name} is {found}, allowed is {one} or {other}"
                    )))
                }
            }
        };
        let side = |name: &str| {
            word(name, "left", "right").map(|left| if left { Side::Left } else { Side::Right })
        };
        let lateral = Field {
            name: "trial_lateral",
            unit: "m",
            min: -10.0,
            max: 10.0,
            whole: false,
            meaning: "",
        };
        let missing =
            || fail("trial_lateral is missing, allowed is a length such as 0.8 m".to_owned());
        let measured = table.get("trial_lateral").ok_or_else(missing)?;
        Ok(Self {
            parameters: Parameters::from_values(values),
            frame: Frame {
                lateral_axis: if word("camera_lateral", "left", "right")? {
                    LateralAxis::Left
                } else {
                    LateralAxis::Right
                },
                orders: if word("gestures_mean", "robot", "person")? {
                    Orders::Robots
                } else {
                    Orders::Persons
                },
            },
            trial: Trial {
                stood: side("trial_stood")?,
                lateral: quantity(&lateral, measured).map_err(fail)?,
                gesture: if word("trial_gesture", "left", "right")? {
                    Gesture::Left
                } else {
                    Gesture::Right
                },
                meant: side("trial_meant")?,
            },
        })
    }

    /// The law, for a robot with `N` sonars.
    ///
    /// # Errors
    /// If the trial does not bear the frame out, a parameter is out of range, or the ring does not fit.
    pub fn law<const N: usize>(&self, config: &RobotConfig) -> Result<Interact, Box<dyn Error>> {
        let ring = base::ring::<N>(config)?;
        let rear_sensing = ring.looks_back() && config.core.reverse_speed_max > 0.0;
        let settings = Settings::new(self.parameters, &config.core)?;
        let frame = self.frame.commissioned(&self.trial)?;
        Ok(Interact::new(settings, config.core, frame, rear_sensing))
    }
}

/// People from a depth camera's program, as they come.
pub struct Watch {
    pictures: Receiver<Result<Picture, String>>,
    recognizer: Recognizer,
    /// The robot's clock less the camera's, ms: the least that was seen, which is that of the picture
    /// that came fastest.
    offset: Option<i128>,
    /// The camera's time of the last picture.
    last: Option<u64>,
    ended: bool,
}

impl Watch {
    /// Reads lines in a thread of its own until they end.
    ///
    /// # Errors
    /// If a setting of the recogniser is out of range.
    pub fn new(lines: Lines, model: Model) -> Result<Self, Box<dyn Error>> {
        let (sender, pictures) = channel();
        std::thread::spawn(move || {
            for line in lines {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Self {
            pictures,
            recognizer: Recognizer::new(model, GestureSettings::default())?,
            offset: None,
            last: None,
            ended: false,
        })
    }

    /// The people of the next picture that has come by `now` (ms of the robot's clock), or what was
    /// wrong with it; none if none has come.
    pub fn poll(&mut self, now: u64) -> Option<Result<People, String>> {
        match self.pictures.try_recv() {
            Ok(Ok(picture)) => Some(Ok(self.recognise(&picture, now))),
            Ok(Err(error)) => Some(Err(error)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) if self.ended => None,
            Err(TryRecvError::Disconnected) => {
                self.ended = true;
                Some(Err(
                    "there are no more pictures: the robot stays at rest".to_owned()
                ))
            }
        }
    }

    /// A picture with the gestures that count, at the robot's time.
    fn recognise(&mut self, picture: &Picture, now: u64) -> People {
        let taken_at = picture.taken_at.0;
        // A camera that begins anew has another clock.
        if self.last.is_some_and(|last| taken_at < last) {
            self.offset = None;
        }
        self.last = Some(taken_at);
        let offset = i128::from(now) - i128::from(taken_at);
        let offset = self.offset.map_or(offset, |least| least.min(offset));
        self.offset = Some(offset);
        let gestures = self
            .recognizer
            .update(picture)
            .map(|person| person.and_then(|person| person.gesture));
        let mut people = People::of(picture, &gestures);
        let time = (i128::from(taken_at) + offset).clamp(0, i128::from(now));
        people.taken_at = Instant(time as u64);
        people
    }
}

/// What is done beside driving: pictures are handed to the law, and what it has to say is said.
pub fn attend<const N: usize>(
    pilot: &mut Pilot<Interact, N>,
    watch: &mut Watch,
    announcer: &mut Announcer,
    out: &mut impl Write,
    now: u64,
) {
    while let Some(seen) = watch.poll(now) {
        match seen {
            Ok(people) => pilot.law_mut().observe_people(&people),
            Err(error) => pilot.note(now, error),
        }
    }
    while let Some(event) = pilot.law_mut().next_event() {
        pilot.note(now, Happening { t: now, event }.text());
        if let Event::Say(announcement) = event
            && let Some(tones) = announcer.say(announcement, now, out)
        {
            pilot.beep(tones, now);
        }
    }
    if let Some(tones) = announcer.poll() {
        pilot.beep(tones, now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidestep::interact::CommissioningError;

    const GOOD: &str = "camera_lateral = \"left\"\ngestures_mean = \"person\"\n\
        trial_stood = \"left\"\ntrial_lateral = \"80 cm\"\ntrial_gesture = \"left\"\n\
        trial_meant = \"right\"\n";

    #[test]
    fn a_good_file_is_read() {
        let meeting = Meeting::parse(&format!("{GOOD}wait_time = \"9 s\"\n"), "m").expect("good");
        assert_eq!(meeting.parameters.wait_time, 9.0);
        assert_eq!(meeting.frame.orders, Orders::Persons);
        assert_eq!(meeting.trial.lateral, 0.8);
        assert!(meeting.law::<16>(&RobotConfig::default()).is_ok());
    }

    /// The defaults read back, and what has none is asked for by name.
    #[test]
    fn what_has_no_default_is_asked_for() {
        let text = default_toml();
        let meeting = Meeting::parse(&format!("{GOOD}{text}"), "m").expect("good");
        assert_eq!(meeting.parameters, USUAL);
        for (name, ..) in REQUIRED {
            let without: String = GOOD
                .lines()
                .filter(|line| !line.starts_with(name))
                .map(|line| format!("{line}\n"))
                .collect();
            let error = Meeting::parse(&without, "m").expect_err(name).to_string();
            assert!(error.contains(name) && error.contains("missing"), "{error}");
            assert!(text.contains(&format!("# {name} = ")));
        }
    }

    #[test]
    fn bad_lines_are_named() {
        for (line, parts) in [
            ("speed = \"1 m/s\"", ["unknown key speed", "m:"]),
            ("wait_time = \"9 m\"", ["wait_time", "120 s"]),
        ] {
            let error = Meeting::parse(&format!("{GOOD}{line}\n"), "m").expect_err(line);
            for part in parts {
                assert!(error.to_string().contains(part), "{error}");
            }
        }
    }

    /// A trial that does not bear the frame out keeps the robot from driving.
    #[test]
    fn a_wrong_trial_is_refused() {
        let mirrored = GOOD.replace("80 cm", "-80 cm");
        let meeting = Meeting::parse(&mirrored, "m").expect("it reads");
        let error = meeting
            .law::<16>(&RobotConfig::default())
            .expect_err("mirrored");
        assert_eq!(
            error.to_string(),
            CommissioningError::LateralAxis.to_string()
        );
    }

    /// Pictures get the robot's time, whatever the camera's clock begins with, and in order.
    #[test]
    fn pictures_get_the_robots_time() {
        let lines = "{\"t\": 500000, \"people\": []}\nnonsense\n{\"t\": 500100, \"people\": []}\n\
            {\"t\": 7, \"people\": []}\n";
        let lines = Lines::new(Box::new(lines.as_bytes()), "camera");
        let mut watch = Watch::new(lines, Model::default()).expect("good");
        let mut seen = Vec::new();
        let mut now = 1_000;
        while !watch.ended {
            if let Some(picture) = watch.poll(now) {
                now += 130;
                seen.push(picture);
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let times: Vec<Option<u64>> = seen
            .iter()
            .map(|seen| seen.as_ref().ok().map(|people| people.taken_at.0))
            .collect();
        // The second took longer to come; a camera that begins anew begins anew.
        assert_eq!(times, [Some(1_000), None, Some(1_100), Some(1_390), None]);
        assert!(watch.poll(now).is_none());
    }
}
