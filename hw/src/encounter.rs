//! Meetings with people, in virtual time: a robot with S3's law and a depth camera, among people who
//! stand, walk, cross its way, show it something, or do not care.

use crate::base;
use crate::config::RobotConfig;
use crate::draw::{Picture, Stop, draw_with_events};
use crate::episodes::{Random, Report, Ride, Tell, describe, pilot, record};
use crate::pilot::settings;
use sidestep::gesture::Gesture;
use sidestep::interact::{
    Announcement, Commissioned, Event, Frame, Interact, LateralAxis, Orders, People, Settings,
    State, Trial,
};
use sidestep::valley::Side;
use sidestep_sim::depth_camera::{self, DepthCamera};
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::person::{Habit, Motion, Person, RADIUS};
use sidestep_sim::scenario::Scenario;
use sidestep_sim::simulation::Simulation;
use sidestep_sim::world::World;
use sidestep_sim::{link, robot, sonar};
use std::collections::BTreeMap;
use std::error::Error;

/// When somebody begins to show something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cue {
    /// At this time, ms.
    At(u64),
    /// So long after the robot has asked people to interact for the so-many-th time, ms; from 1.
    Asked(u32, u64),
    /// So long after the robot has begun to drive through a valley for the so-many-th time, ms.
    Traverses(u32, u64),
}

/// Something that somebody shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Showing {
    /// Who, by index in the world.
    pub person: usize,
    /// From when.
    pub cue: Cue,
    /// For how long, ms.
    pub lasts: u64,
    /// What.
    pub gesture: Gesture,
}

/// It takes this long, ms, until a gesture counts: raising the arm, and enough pictures of it.
const RECOGNISED: u64 = 400;

/// A meeting: a situation, and what people show in it.
#[derive(Clone)]
pub struct Encounter {
    /// The situation.
    pub scenario: Scenario,
    /// What people show.
    pub showings: Vec<Showing>,
    /// The camera.
    pub camera: depth_camera::Parameters,
    /// From when on the camera gives nothing, ms.
    pub camera_fails: Option<u64>,
    /// The line to the base.
    pub link: link::Faults,
}

/// What is said and done, as it happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Happening {
    /// When, ms.
    pub t: u64,
    /// What.
    pub event: Event,
}

impl Happening {
    /// In a few words.
    #[must_use]
    pub fn text(&self) -> String {
        match self.event {
            Event::Say(announcement) => format!("says \"{}\"", announcement.text()),
            Event::MasterIs(id) => format!("takes orders from person {id}"),
            Event::MasterLost => "takes orders from nobody any more".to_owned(),
            Event::Entered(state) => match state.path() {
                Some(path) => format!(
                    "{}: heading {:.0}°, {:.2} m at {:.2} m/s",
                    state.name(),
                    path.heading().get().to_degrees(),
                    path.length(),
                    path.speed()
                ),
                None => state.name().to_owned(),
            },
        }
    }
}

/// A meeting that is over.
pub struct Met {
    /// What came of it.
    pub report: Report,
    /// What it was.
    pub scenario: Scenario,
    /// The world at the end.
    pub simulation: Simulation,
    /// Stops of the shield.
    pub stops: Vec<Stop>,
    /// What the law said and did.
    pub happenings: Vec<Happening>,
}

impl Met {
    /// The meeting as a picture (SVG), with what was said and done.
    #[must_use]
    pub fn picture(&self) -> String {
        let contacts = self.report.contacts.iter().map(describe);
        let broken = self.report.broken.iter().map(ToString::to_string);
        let notes: Vec<String> = contacts.chain(broken).collect();
        let events: Vec<Stop> = self
            .happenings
            .iter()
            .map(|happening| Stop {
                t: happening.t,
                reason: happening.text(),
            })
            .collect();
        draw_with_events(
            &Picture {
                title: &format!("{}: {}", self.scenario.name, self.scenario.description),
                notes: &notes,
                world: self.simulation.world(),
                trace: self.simulation.trace(),
                goal: self.scenario.goal,
                robot_radius: self.scenario.robot.base.radius,
                stops: &self.stops,
            },
            &events,
        )
    }
}

/// The frame of the simulated camera, with gestures meaning the person's own sides, as it is found
/// right by a trial.
///
/// # Panics
/// If a trial that bears it out is refused.
#[must_use]
pub fn commissioned() -> Commissioned {
    let frame = Frame {
        lateral_axis: LateralAxis::Left,
        orders: Orders::Persons,
    };
    let trial = Trial {
        stood: Side::Left,
        lateral: 0.8,
        gesture: Gesture::Left,
        meant: Side::Right,
    };
    frame.commissioned(&trial).expect("the trial bears it out")
}

/// S3's law for a robot with sixteen sonars.
///
/// # Errors
/// If a parameter is out of range or the ring does not fit.
pub fn law(
    config: &RobotConfig,
    parameters: sidestep::interact::Parameters,
) -> Result<Interact, Box<dyn Error>> {
    let ring = base::ring::<16>(config)?;
    let rear_sensing = ring.looks_back() && config.core.reverse_speed_max > 0.0;
    let settings = Settings::new(parameters, &config.core)?;
    Ok(Interact::new(
        settings,
        config.core,
        commissioned(),
        rear_sensing,
    ))
}

/// What has happened that people go by.
#[derive(Default)]
struct Cues {
    asked: Vec<u64>,
    traverses: Vec<u64>,
}

impl Cues {
    fn take(&mut self, event: &Event, now: u64) {
        match event {
            Event::Say(Announcement::Interact) => self.asked.push(now),
            Event::Entered(State::Traverse(_)) => self.traverses.push(now),
            _ => {}
        }
    }

    /// When a cue is given, ms.
    fn time(&self, cue: Cue) -> Option<u64> {
        let nth = |times: &[u64], n: u32, after: u64| {
            let time = times.get((n as usize).checked_sub(1)?)?;
            Some(time + after)
        };
        match cue {
            Cue::At(time) => Some(time),
            Cue::Asked(n, after) => nth(&self.asked, n, after),
            Cue::Traverses(n, after) => nth(&self.traverses, n, after),
        }
    }

    /// What a person shows.
    fn shown(&self, showings: &[Showing], person: usize, now: u64) -> Option<Gesture> {
        let shows = |showing: &&Showing| {
            showing.person == person
                && self.time(showing.cue).is_some_and(|from| {
                    (from + RECOGNISED..from + showing.lasts.max(RECOGNISED)).contains(&now)
                })
        };
        showings.iter().find(shows).map(|showing| showing.gesture)
    }
}

/// What sees people for the robot.
pub trait Camera {
    /// Takes a picture of `world` from `pose` if it is time to; `shows` says what a person, by
    /// index, shows.
    fn look(
        &mut self,
        now_ms: u64,
        world: &World,
        pose: &Pose,
        shows: &dyn Fn(usize) -> Option<Gesture>,
    );

    /// The next picture that is there by now, if any is.
    fn arrival(&mut self, now_ms: u64) -> Option<People>;
}

impl Camera for DepthCamera {
    fn look(
        &mut self,
        now_ms: u64,
        world: &World,
        pose: &Pose,
        shows: &dyn Fn(usize) -> Option<Gesture>,
    ) {
        Self::look(self, now_ms, world, pose, shows);
    }

    fn arrival(&mut self, now_ms: u64) -> Option<People> {
        Self::arrival(self, now_ms)
    }
}

/// Runs a meeting to its end.
///
/// # Errors
/// If a parameter is out of range.
pub fn run(
    encounter: &Encounter,
    config: &RobotConfig,
    parameters: sidestep::interact::Parameters,
    tell: Tell<'_>,
) -> Result<Met, Box<dyn Error>> {
    let mut camera = DepthCamera::new(encounter.camera, encounter.scenario.seed)?;
    run_with(encounter, config, parameters, &mut camera, tell)
}

/// Runs a meeting to its end, seen by any camera.
///
/// # Errors
/// If a parameter is out of range.
pub fn run_with(
    encounter: &Encounter,
    config: &RobotConfig,
    parameters: sidestep::interact::Parameters,
    camera: &mut dyn Camera,
    tell: Tell<'_>,
) -> Result<Met, Box<dyn Error>> {
    let scenario = &encounter.scenario;
    let seed = scenario.seed;
    let law = law(config, parameters)?;
    let pilot = pilot(scenario, config, settings(config, false, None), law)?;
    let ride = Ride::new(scenario.simulate()?, pilot, encounter.link, seed)?;
    let mut cues = Cues::default();
    let mut happenings = Vec::new();
    let run = record(ride, scenario.clone(), config, tell, |ride| {
        let now = ride.now();
        if encounter.camera_fails.is_none_or(|fails| now < fails) {
            let pose = ride.simulation.robot().base().pose();
            camera.look(now, ride.simulation.world(), &pose, &|person| {
                cues.shown(&encounter.showings, person, now)
            });
        }
        while let Some(picture) = camera.arrival(now) {
            ride.host.law_mut().observe_people(&picture);
        }
        while let Some(event) = ride.host.law_mut().next_event() {
            cues.take(&event, now);
            happenings.push(Happening { t: now, event });
        }
    });
    Ok(Met {
        report: run.report,
        stops: run.stops,
        scenario: run.scenario,
        simulation: run.simulation,
        happenings,
    })
}

/// The stories of S3's Figures 8 and 9, and one in which people make way.
pub const STORIES: [&str; 3] = ["fig8", "fig9", "make-way"];

fn standing(x: f64, y: f64) -> Result<Person, sidestep_sim::Error> {
    let motion = Motion::Line {
        start: Point::new(x, y),
        heading: 0.0,
        speed: 0.0,
        delay: 0.0,
    };
    Person::new(motion)
}

/// A story by its name, one of [`STORIES`].
///
/// # Errors
/// If there is none of that name.
pub fn story(name: &str, seed: u64) -> Result<Encounter, Box<dyn Error>> {
    let mut world = World::new();
    let mut showings = Vec::new();
    let goal = Point::new(6.5, 0.0);
    let (name, description) = match name {
        "fig8" => {
            // Out of a narrow place into a wide one.
            for side in [-1.0, 1.0] {
                world.add_wall(Point::new(-1.0, side * 1.2), Point::new(3.0, side * 1.2))?;
            }
            // The master walks backward while leading it.
            world.add_person(Person::new(Motion::Path {
                start: Point::new(3.7, 0.1),
                waypoints: vec![Point::new(5.7, 0.1)],
                speed: 0.2,
                delay: 16.0,
                patrol: false,
            })?);
            let shows = |cue, lasts, gesture| Showing {
                person: 0,
                cue,
                lasts,
                gesture,
            };
            showings.push(shows(Cue::Asked(1, 1500), 2000, Gesture::MasterSelect));
            showings.push(shows(Cue::Asked(1, 4500), 13_000, Gesture::Forward));
            // The robot goes to its right, which is the left of whoever faces it.
            showings.push(shows(Cue::Asked(1, 18_500), 3000, Gesture::Left));
            (
                "fig8",
                "S3 Fig. 8: the master leads the robot forward, then sends it to one side",
            )
        }
        "fig9" => {
            world.add_person(standing(3.6, -0.35)?);
            world.add_person(standing(3.9, 1.75)?);
            (
                "fig9",
                "S3 Fig. 9: nobody interacts, and the robot chooses its own valley",
            )
        }
        "make-way" => {
            let motion = Motion::Path {
                start: Point::new(3.4, 0.0),
                waypoints: vec![Point::new(3.6, 2.6)],
                speed: 0.6,
                delay: 11.0,
                patrol: false,
            };
            world.add_person(Person::new(motion)?);
            ("make-way", "somebody in the way makes way for the robot")
        }
        other => {
            return Err(format!("no story is called {other:?}: {}", STORIES.join(", ")).into());
        }
    };
    Ok(Encounter {
        scenario: Scenario {
            name,
            description: description.to_owned(),
            world,
            start: Pose::new(0.0, 0.0, 0.0),
            goal,
            time_limit_ms: 120_000,
            robot: robot::Parameters::default(),
            sonar_faults: sonar::Faults::default(),
            seed,
        },
        showings,
        camera: depth_camera::Parameters::default(),
        camera_fails: None,
        link: link::Faults::default(),
    })
}

/// The kinds of people in a random meeting.
pub const KINDS: [&str; 4] = ["standing", "crossing", "walking", "crowd"];

/// A random meeting: one to six people up to `speed` (m/s) about the way, who stand, walk about, or
/// cross it before and while the robot passes; some of them lead the robot, some show Stop, and the
/// camera loses people and gestures or fails.
///
/// # Errors
/// If `speed` is out of range.
pub fn random(seed: u64, speed: f64, config: &RobotConfig) -> Result<Encounter, Box<dyn Error>> {
    let mut random = Random(seed ^ 0x5333);
    let kind = random.below(KINDS.len() as u64) as usize;
    let mut world = World::new();
    if random.below(3) == 0 {
        let half = random.between(1.5, 2.6);
        for y in [-half, half] {
            world.add_wall(Point::new(-2.0, y), Point::new(9.0, y))?;
        }
    }
    let count = match kind {
        3 => random.below(3) + 4,
        _ => random.below(4) + 1,
    };
    let mut showings = Vec::new();
    let mut places: Vec<Point> = Vec::new();
    for _ in 0..count {
        let spread = if kind == 3 { 2.2 } else { 1.4 };
        let place = Point::new(random.between(2.4, 5.0), random.between(-spread, spread));
        let clear = |other: &Point| (other - place).norm() >= 2.0 * RADIUS + 0.05;
        let walled = world
            .nearest(place)
            .is_some_and(|nearest| nearest.distance < RADIUS + 0.01);
        if walled || !places.iter().all(clear) {
            continue;
        }
        let pace = speed * random.between(0.3, 1.0);
        let across = Point::new(
            place.x + random.between(-1.5, 1.0),
            -place.y.signum() * random.between(0.3, 2.0),
        );
        let delay = random.between(4.0, 45.0);
        let moves = match kind {
            0 => 0,
            1 => random.below(2),
            _ => random.below(4),
        };
        let motion = match moves {
            1 => Motion::Path {
                start: place,
                waypoints: vec![across],
                speed: pace,
                delay,
                patrol: random.below(3) == 0,
            },
            2 => Motion::Walk {
                start: place,
                speed: pace,
                acceleration: random.between(0.5, 4.0),
                delay: if random.below(2) == 0 { 0.0 } else { delay },
                habit: Habit::Wander,
                seed: random.bits(),
            },
            _ => Motion::Line {
                start: place,
                heading: 0.0,
                speed: 0.0,
                delay: 0.0,
            },
        };
        let mut person = Person::new(motion)?.stopped_by_walls();
        if random.below(2) == 0 {
            person = person.courteous(sidestep_sim::person::COURTESY_GAP)?;
        }
        world.add_person(person);
        places.push(place);
    }
    let people = places.len() as u64;
    if people > 0 && random.below(2) == 0 {
        // Somebody leads the robot.
        let master = random.below(people) as usize;
        let asked = 1 + random.below(2) as u32;
        let mut after = 500 + random.below(3000);
        let mut show = |random: &mut Random, gesture, least, more| {
            let lasts = least + random.below(more);
            showings.push(Showing {
                person: master,
                cue: Cue::Asked(asked, after),
                lasts,
                gesture,
            });
            after += lasts + 300 + random.below(1500);
        };
        show(&mut random, Gesture::MasterSelect, 1200, 1500);
        for _ in 0..=random.below(3) {
            let gesture = [
                Gesture::Forward,
                Gesture::Backward,
                Gesture::Stop,
                Gesture::Right,
                Gesture::Left,
            ][random.below(5) as usize];
            show(&mut random, gesture, 800, 4000);
        }
        show(
            &mut random,
            [Gesture::Right, Gesture::Left][(seed % 2) as usize],
            1500,
            2000,
        );
    }
    // Anybody may show anything at any time.
    for person in 0..people as usize {
        if random.below(4) == 0 {
            let cue = if random.below(2) == 0 {
                Cue::Traverses(1, random.below(8000))
            } else {
                Cue::At(random.below(50_000))
            };
            let gesture = if random.below(2) == 0 {
                Gesture::Stop
            } else {
                Gesture::ALL[random.below(Gesture::COUNT as u64) as usize]
            };
            showings.push(Showing {
                person,
                cue,
                lasts: 600 + random.below(3000),
                gesture,
            });
        }
    }
    let mut robot = robot::Parameters::default();
    robot.base.radius = config.core.robot_radius.into();
    robot.base.delay_ms = 10 * (2 + random.below(4));
    Ok(Encounter {
        scenario: Scenario {
            name: KINDS[kind],
            description: format!("meeting {seed}, {people} people up to {speed:.2} m/s"),
            world,
            start: Pose::new(0.0, 0.0, random.between(-0.3, 0.3)),
            goal: Point::new(6.5, random.between(-0.5, 0.5)),
            time_limit_ms: 70_000,
            robot,
            sonar_faults: sonar::Faults {
                dropout: random.between(0.0, 0.1),
                ..sonar::Faults::default()
            },
            seed,
        },
        showings,
        camera: depth_camera::Parameters {
            noise: random.between(0.0, 0.04),
            dropout: random.between(0.0, 0.2),
            wrong_gesture: if random.below(3) == 0 {
                random.between(0.0, 0.01)
            } else {
                0.0
            },
            ..depth_camera::Parameters::default()
        },
        camera_fails: (random.below(20) == 0).then(|| random.below(50_000)),
        link: link::Faults {
            delay_ms: random.below(21),
            ..link::Faults::default()
        },
    })
}

/// What came of many meetings, beyond contacts.
#[derive(Clone, Debug, Default)]
pub struct Conduct {
    /// How often each state was entered.
    pub entered: BTreeMap<&'static str, u64>,
    /// Meetings in which the robot drove through a valley, and those in which it got through one.
    pub valleys: [u64; 2],
}

impl Conduct {
    /// Adds a meeting.
    pub fn add(&mut self, met: &Met) {
        let states: Vec<&str> = met
            .happenings
            .iter()
            .filter_map(|happening| match happening.event {
                Event::Entered(state) => Some(state.name()),
                _ => None,
            })
            .collect();
        self.valleys[0] += u64::from(states.contains(&"traverse"));
        let through = |pair: &[&str]| pair == ["traverse", "resume"];
        self.valleys[1] += u64::from(states.windows(2).any(through));
        for state in states {
            *self.entered.entry(state).or_default() += 1;
        }
    }

    /// Adds others.
    pub fn merge(&mut self, other: Self) {
        for (name, count) in other.entered {
            *self.entered.entry(name).or_default() += count;
        }
        for (mine, theirs) in self.valleys.iter_mut().zip(other.valleys) {
            *mine += theirs;
        }
    }
}
