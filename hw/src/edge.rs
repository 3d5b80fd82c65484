//! S4 in simulation: a route through corridors, a laser that is asked when the robot stands, and
//! who was right about what the sonars heard.

use crate::config::{HeadingSource, RobotConfig, Sonars};
use crate::demo::{Options, Summary, run_folder, run_watched};
use crate::draw::{Picture, Plan, Stop, draw_planned};
use crate::drive::Status;
use crate::pilot::Pilot;
use sidestep::config::Config;
use sidestep::edge::{self, Edge, EdgeConfig, Event, PlannedEdge, Scan};
use sidestep::failsafe::{Action, StopReason};
use sidestep::law::{Advice, Law};
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use sidestep::view::View;
use sidestep_sim::corridor::{self, Corridor};
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::laser::{self, Laser};
use sidestep_sim::scenario::Scenario;
use sidestep_sim::simulation::Simulation;
use sidestep_sim::world::{Body, Cone, World};
use std::error::Error;
use std::path::PathBuf;

/// The law of a run: the route is a vector, the sonars are the front array of a P3-DX.
pub type Driver = Edge<Vec<PlannedEdge>, 8>;

/// A small round base ([`preset::CORRIDOR_BASE`]) with the front sonars of a P3-DX.
///
/// # Errors
/// If the preset were not a configuration, which a test would show.
pub fn corridor_base() -> Result<RobotConfig, Box<dyn Error>> {
    Ok(RobotConfig {
        core: Config::new(preset::CORRIDOR_BASE)?,
        sonars: Sonars::Front8,
        heading: HeadingSource::Odometry,
    })
}

/// A simulated robot for a configuration.
#[must_use]
pub fn robot_for(config: &RobotConfig) -> sidestep_sim::robot::Parameters {
    let mut robot = sidestep_sim::robot::Parameters::default();
    robot.base.radius = f64::from(config.core.robot_radius);
    robot.sonars = match config.sonars {
        Sonars::Front8 => 8,
        Sonars::All16 => 16,
    };
    robot
}

/// The pieces of a polyline (m, in the world) as planned edges in the frame in which the robot
/// starts.
///
/// # Errors
/// If a piece is no edge.
pub fn route(start: &Pose, corners: &[Point]) -> Result<Vec<PlannedEdge>, Box<dyn Error>> {
    let local = |corner: &Point| {
        let offset = corner - start.position;
        let (sin, cos) = start.heading.sin_cos();
        nalgebra::Vector2::new(
            (cos * offset.x + sin * offset.y) as f32,
            (cos * offset.y - sin * offset.x) as f32,
        )
    };
    corners
        .windows(2)
        .map(|pair| Ok(PlannedEdge::new(local(&pair[0]), local(&pair[1]))?))
        .collect()
}

/// A point of the frame in which the robot starts, in the world (m).
#[must_use]
pub fn in_world(start: &Pose, point: nalgebra::Vector2<f32>) -> Point {
    start
        .compose(&Pose::new(f64::from(point.x), f64::from(point.y), 0.0))
        .position
}

/// Something that happened, for people to read and to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Happening {
    /// When, ms.
    pub t: u64,
    /// Where the robot truly was.
    pub pose: Pose,
    /// What the law says.
    pub event: Event,
    /// What the sonar that was decisive truly heard, and how far it was from its face (m).
    pub heard: Option<(Body, f64)>,
}

/// A moment at which a classical detector, a threshold on the range of every forward sonar, would
/// have stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassicalStop {
    /// When, ms.
    pub t: u64,
    /// Where the robot truly was.
    pub pose: Pose,
    /// What it truly heard.
    pub body: Body,
}

/// What is to be driven.
pub struct Course {
    /// Where, and which way.
    pub corridor: Corridor,
    /// The scanner; none if the robot has none, and then it waits for ever where it would look.
    pub laser: Option<laser::Parameters>,
    /// The robot's configuration.
    pub config: RobotConfig,
    /// S4's.
    pub edge: edge::Parameters,
    /// Range below which the classical detector stops, m.
    pub classical: f64,
    /// The run ends with the first event that this is true of.
    pub until: fn(&Event) -> bool,
}

/// What came of it.
pub struct Run {
    /// As of any run.
    pub summary: Summary,
    /// The simulation at its end.
    pub simulation: Simulation,
    /// What the law said.
    pub happenings: Vec<Happening>,
    /// The first moment, of each time that it begins, at which a classical detector would have
    /// stopped.
    pub classical: Vec<ClassicalStop>,
    /// What latched a stop of the shield, and ended the run, if anything did.
    pub latched: Option<StopReason>,
}

impl Course {
    /// A body is one of the walls.
    #[must_use]
    pub fn is_wall(&self, body: Body) -> bool {
        matches!(body, Body::Obstacle(i) if i < self.corridor.walls)
    }

    /// Drives it, in virtual time.
    ///
    /// # Errors
    /// If something in it is out of range.
    pub fn run(&self) -> Result<Run, Box<dyn Error>> {
        let scenario = &self.corridor.scenario;
        let start = scenario.start;
        let ring: Ring<8> = crate::base::ring(&self.config)?;
        let law: Driver = Edge::new(
            self.config.core,
            EdgeConfig::new(self.edge)?,
            ring,
            route(&start, &self.corridor.way)?,
        )?;
        let mut scanner = match self.laser {
            Some(parameters) => Some(Laser::new(parameters, scenario.seed)?),
            None => None,
        };
        let mut happenings = Vec::new();
        let mut classical = Vec::new();
        let mut warned: Option<Body> = None;
        let mut looked_at = None;
        let mut latched = None;
        let (summary, simulation) = run_watched(
            scenario,
            &self.config,
            law,
            |pilot: &mut Pilot<Driver, 8>, simulation: &Simulation, now| {
                let pose = simulation.robot().base().pose();
                let view = pilot.latest().and_then(|decision| decision.view);
                if let Some(view) = view
                    && looked_at != Some(view.now)
                {
                    looked_at = Some(view.now);
                    let found = self.classical_stop(&view, &ring, simulation.world(), &pose);
                    if let Some(body) = found
                        && warned != found
                    {
                        classical.push(ClassicalStop { t: now, pose, body });
                    }
                    warned = found;
                }
                latched = pilot
                    .latest()
                    .filter(|decision| decision.action == Action::LatchedStop)
                    .and_then(|decision| decision.stop);
                let mut ends = latched.is_some();
                while let Some(event) = pilot.law_mut().next_event() {
                    let heard = view.and_then(|view| {
                        decisive(
                            &event,
                            &view,
                            &ring,
                            &pose,
                            simulation.world(),
                            &self.config,
                        )
                    });
                    ends |= (self.until)(&event);
                    happenings.push(Happening {
                        t: now,
                        pose,
                        event,
                        heard,
                    });
                }
                if let Some(scanner) = &mut scanner
                    && pilot.law_mut().wants_scan()
                {
                    look(pilot.law_mut(), scanner, simulation.world(), &pose, now);
                }
                ends
            },
        )?;
        Ok(Run {
            summary,
            simulation,
            happenings,
            classical,
            latched,
        })
    }

    /// The nearest thing that makes the classical detector stop.
    fn classical_stop(
        &self,
        view: &View<8>,
        ring: &Ring<8>,
        world: &World,
        pose: &Pose,
    ) -> Option<Body> {
        let near = |reading: &SonarReading| match reading {
            SonarReading::Echo(range) => f64::from(range.get()) < self.classical,
            SonarReading::TooNear => true,
            _ => false,
        };
        (0..8)
            .filter(|&i| ring.sonars()[i].forward && near(&view.sonar[i]))
            .find_map(|i| Some(truth(i, ring, pose, world, &self.config)?.0))
    }
}

impl Course {
    /// What a robot that stands where the simulation ended has within the classical reach.
    fn blamed(&self, simulation: &Simulation) -> Result<Option<Body>, Box<dyn Error>> {
        let ring: Ring<8> = crate::base::ring(&self.config)?;
        let pose = simulation.robot().base().pose();
        Ok((0..8)
            .filter(|&i| ring.sonars()[i].forward)
            .filter_map(|i| truth(i, &ring, &pose, simulation.world(), &self.config))
            .find(|(_, distance)| *distance < self.classical + 0.02)
            .map(|(body, _)| body))
    }
}

/// Gives a scan to a law that wants one.
fn look(law: &mut Driver, scanner: &mut Laser, world: &World, pose: &Pose, now: u64) {
    let ranges = scanner.scan(world, pose);
    let p = *scanner.parameters();
    let placement = Placement {
        x: p.placement.position.x as f32,
        y: p.placement.position.y as f32,
        heading: p.placement.heading as f32,
    };
    // The scanner's parameters were checked, and stay within what a scan may have.
    if let Ok(scan) = Scan::new(
        placement,
        scanner.first_angle() as f32,
        p.step as f32,
        p.reach as f32,
        &ranges,
        Instant(now),
    ) {
        law.take_scan(&scan);
    }
}

/// What sonar `i` truly hears, and how far it is from its face (m).
fn truth(
    i: usize,
    ring: &Ring<8>,
    pose: &Pose,
    world: &World,
    config: &RobotConfig,
) -> Option<(Body, f64)> {
    let at = ring.sonars()[i];
    let face = Pose::new(
        f64::from(at.position.x),
        f64::from(at.position.y),
        f64::from(at.heading.get()),
    );
    let nearest = world.nearest_in_cone(&Cone {
        apex: pose.compose(&face),
        half_angle: f64::from(config.core.sonar_half_angle),
        range: 5.0,
    })?;
    Some((nearest.body, nearest.distance))
}

/// What the decisive sonar of an event truly hears: the one whose vector ends at the event's point.
fn decisive(
    event: &Event,
    view: &View<8>,
    ring: &Ring<8>,
    pose: &Pose,
    world: &World,
    config: &RobotConfig,
) -> Option<(Body, f64)> {
    let (Event::Detected(_, point) | Event::HeldUp(_, point)) = event else {
        return None;
    };
    let miss = |i: &usize| {
        let at = ring.sonars()[*i];
        let range = match view.sonar[*i] {
            SonarReading::Echo(range) => range.get(),
            _ => 0.0,
        };
        (view.pose.to_world(at.position + at.axis * range) - point).norm()
    };
    let sonar = (0..8).min_by(|a, b| miss(a).total_cmp(&miss(b)))?;
    truth(sonar, ring, pose, world, config)
}

// ------------------------------------------------------------------------- a classical detector

/// The same way with a classical detector: whatever any forward sonar hears nearer than `reach` is
/// in the way, and the robot stands as long as it is there.
struct Classical {
    /// Follows the edges, and detects nothing.
    follow: Driver,
    ring: Ring<8>,
    reach: f32,
    stopped: bool,
}

impl Law<8> for Classical {
    fn advise(&mut self, view: &View<8>) -> Advice {
        let advice = self.follow.advise(view);
        let near = |i: &usize| {
            self.ring.sonars()[*i].forward
                && match view.sonar[*i] {
                    SonarReading::Echo(range) => range.get() < self.reach,
                    SonarReading::TooNear => true,
                    _ => false,
                }
        };
        self.stopped = (0..8).any(|i| near(&i));
        if self.stopped { Advice::REST } else { advice }
    }

    fn mode(&self) -> &'static str {
        if self.stopped {
            "stopped"
        } else {
            self.follow.mode()
        }
    }
}

impl Course {
    /// Drives it with the classical detector, for a minute at most.
    ///
    /// # Errors
    /// If something in it is out of range.
    pub fn run_classical(&self) -> Result<(Summary, Simulation), Box<dyn Error>> {
        let scenario = Scenario {
            time_limit_ms: 60_000,
            ..self.corridor.scenario.clone()
        };
        let ring: Ring<8> = crate::base::ring(&self.config)?;
        // Nothing projects more than 10.
        let deaf = edge::Parameters {
            threshold: 10.0,
            held_time: 60.0,
            ..self.edge
        };
        let law = Classical {
            follow: Edge::new(
                self.config.core,
                EdgeConfig::new(deaf)?,
                ring,
                route(&scenario.start, &self.corridor.way)?,
            )?,
            ring,
            reach: self.classical as f32,
            stopped: false,
        };
        run_watched(&scenario, &self.config, law, |_, _, _| false)
    }
}

// ----------------------------------------------------------------------------- the demonstration

/// What the demonstration is called.
pub const NAME: &str = "edge";

/// What happened, in words; places in the world.
fn words(happening: &Happening, start: &Pose) -> String {
    let place = |point| {
        let at = in_world(start, point);
        format!("({:.2}, {:.2})", at.x, at.y)
    };
    match happening.event {
        Event::Covered(k) => format!("edge {}: covered", k + 1),
        Event::Detected(k, point) => format!("edge {}: an obstacle at {}", k + 1, place(point)),
        Event::HeldUp(k, point) => {
            format!("edge {}: held up by what is at {}", k + 1, place(point))
        }
        Event::Measured(k, found) => {
            let free = found.gap.map_or(0.0, |gap| gap.width());
            let size = found.obstacle.map_or_else(
                || "not seen by the laser".to_owned(),
                |seen| {
                    let [along, across] = [seen.along, seen.across]
                        .map(|[low, high]| format!("{:.0}", 1000.0 * (high - low)));
                    format!("{along} mm long as far as seen and {across} mm wide")
                },
            );
            let verdict = if found.passable {
                "it goes round"
            } else {
                "no way"
            };
            format!(
                "edge {}: the obstacle is {size}; {:.0} mm are free: {verdict}",
                k + 1,
                1000.0 * free
            )
        }
        Event::Blocked(k) => format!("edge {}: blocked", k + 1),
    }
}

/// The paper's corridors, three obstacles, and who gets through: S4's law, and the classical
/// detector on the same way. Leaves a folder with both pictures.
///
/// # Errors
/// If the folder cannot be written, if S4's robot does not cover every edge, or if anything was
/// touched.
pub fn demo(options: &Options, status: &mut Status) -> Result<PathBuf, Box<dyn Error>> {
    // Another base than the default is somebody's choice.
    let config = if options.config == RobotConfig::default() {
        corridor_base()?
    } else {
        options.config
    };
    let mut robot = robot_for(&config);
    robot.sonar.noise = options.knobs.sonar_noise;
    let mut corridor = corridor::paper(options.knobs.seed, &robot)?;
    corridor.scenario.sonar_faults = options.knobs.sonar_faults;
    let course = Course {
        corridor,
        laser: Some(laser::Parameters::default()),
        config,
        edge: edge::PAPER,
        classical: 0.42,
        until: |event| matches!(event, Event::Blocked(_)),
    };
    let scenario = &course.corridor.scenario;
    let folder = run_folder(&options.out, NAME)?;
    status.keep(&format!(
        "== {NAME}: {}\n   pictures in {}",
        scenario.description,
        folder.display()
    ));
    let run = course.run()?;
    let mut text = run.summary.text(scenario);
    let mut stops = Vec::new();
    for happening in &run.happenings {
        let reason = words(happening, &scenario.start);
        let line = format!("{:7.1} s  {reason}", happening.t as f64 / 1000.0);
        status.keep(&line);
        text += &line;
        text.push('\n');
        stops.push(Stop {
            t: happening.t,
            reason,
        });
    }
    let marks: Vec<(Point, String)> = run
        .classical
        .iter()
        .filter(|stop| course.is_wall(stop.body))
        .map(|stop| (stop.pose.position, String::new()))
        .collect();
    let said = format!(
        "on this run a classical detector ({:.0} mm on any forward sonar) would have taken a wall for \
         an obstacle {} times",
        1000.0 * course.classical,
        marks.len()
    );
    status.keep(&said);
    text += &said;
    text.push('\n');
    let mut notes: Vec<String> = run
        .summary
        .text(scenario)
        .lines()
        .skip(1)
        .map(str::to_owned)
        .collect();
    notes.push("dots: here a classical detector would have stopped for a wall".to_owned());
    let plan = |marks| Plan {
        way: &course.corridor.way,
        marks,
    };
    let picture =
        |simulation: &Simulation, title: &str, notes: &[String], stops: &[Stop], marks| {
            draw_planned(
                &Picture {
                    title,
                    notes,
                    world: simulation.world(),
                    trace: simulation.trace(),
                    goal: scenario.goal,
                    robot_radius: f64::from(config.core.robot_radius),
                    stops,
                },
                &plan(marks),
            )
        };
    let title = format!("S4's law: {}", scenario.description);
    let drawn = picture(&run.simulation, &title, &notes, &stops, &marks);
    std::fs::write(folder.join("picture.svg"), drawn)?;

    let (summary, simulation) = course.run_classical()?;
    let last = simulation.robot().base().pose();
    let near = course.blamed(&simulation)?;
    let outcome = match (summary.tally.arrived, near) {
        (Some(_), _) => "the classical detector gets through".to_owned(),
        (None, Some(body)) => format!(
            "the classical detector stops for good at ({:.2}, {:.2}), before {}",
            last.position.x,
            last.position.y,
            if course.is_wall(body) {
                "a wall"
            } else {
                "an obstacle"
            }
        ),
        (None, None) => "the classical detector does not get through in a minute".to_owned(),
    };
    status.keep(&outcome);
    text += &outcome;
    text.push('\n');
    let title = format!("Classical detector: {}", scenario.description);
    let stopped = simulation.trace().iter().rev();
    let since = stopped.take_while(|sample| sample.speed == 0.0).last();
    let stops = [Stop {
        t: since.map_or(0, |sample| sample.time_ms),
        reason: outcome.clone(),
    }];
    let drawn = picture(&simulation, &title, &[outcome], &stops, &[]);
    std::fs::write(folder.join("classical.svg"), drawn)?;
    std::fs::write(folder.join("summary.txt"), &text)?;
    status.keep(&format!(
        "pictures: {0}/picture.svg {0}/classical.svg",
        folder.display()
    ));
    if run.summary.contacts_while_moving() > 0 {
        return Err("the robot touched something while it moved".into());
    }
    if run.summary.tally.arrived.is_none() {
        return Err("the way was not covered".into());
    }
    Ok(folder)
}

// --------------------------------------------------------------------------- corridors by number

/// A robot before an obstacle that leaves `free` m, with a scanner without noise that resolves a
/// millimetre.
///
/// # Errors
/// If the simulation refuses something.
pub fn narrowed(free: f64, config: &RobotConfig, seed: u64) -> Result<Course, Box<dyn Error>> {
    Ok(Course {
        corridor: corridor::narrowed(free, seed, &robot_for(config))?,
        laser: Some(laser::Parameters {
            step: 0.1_f64.to_radians(),
            noise: 0.0,
            ..laser::Parameters::default()
        }),
        config: *config,
        edge: edge::PAPER,
        classical: 0.42,
        until: |event| matches!(event, Event::Blocked(_)),
    })
}

/// The narrowest way past an obstacle (mm, in steps of 10 from 600) that a robot gets through in a
/// corridor of 1200 mm, where that is the shield's decision; none if there is none.
///
/// # Errors
/// If the simulation refuses something.
pub fn narrowest(config: &RobotConfig) -> Result<Option<u32>, Box<dyn Error>> {
    for free in (601..1160).step_by(10) {
        let run = narrowed(f64::from(free) / 1000.0, config, 1)?.run()?;
        if run.summary.tally.arrived.is_some() {
            return Ok(Some(free));
        }
    }
    Ok(None)
}

/// A corridor made up from a seed, until something is detected, or holds the robot up.
///
/// # Errors
/// If the simulation refuses something.
pub fn random(seed: u64, with_box: bool, classical: f64) -> Result<Course, Box<dyn Error>> {
    let config = corridor_base()?;
    let mut corridor = corridor::random(seed, with_box, &robot_for(&config))?;
    corridor.scenario.time_limit_ms = 60_000;
    Ok(Course {
        corridor,
        laser: None,
        config,
        edge: edge::PAPER,
        classical,
        until: |event| matches!(event, Event::Detected(..) | Event::HeldUp(..)),
    })
}

/// What came of corridors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Corridors {
    /// Corridors driven.
    pub runs: u64,
    /// Runs to the end of the edge.
    pub covered: u64,
    /// A wall was taken for an obstacle.
    pub walls_detected: u64,
    /// The box was detected, with 300 mm or more before the sonar's face.
    pub boxes_before_300: u64,
    /// It was nearer when the robot began, which did not set off.
    pub boxes_at_start: u64,
    /// It was detected nearer than that by a robot that had driven there.
    pub boxes_nearer: u64,
    /// The shield had stopped the robot before the box was detected.
    pub boxes_by_shield: u64,
    /// The shield held the robot up for a wall.
    pub held_by_wall: u64,
    /// The shield latched a stop, taking a jump of a reading for somebody too fast, say.
    pub latched: u64,
    /// Runs that were over before anything happened.
    pub out_of_time: u64,
    /// Runs to the end of the edge although a box was on it.
    pub boxes_missed: u64,
    /// Contacts while the robot moved.
    pub contacts: u64,
    /// Runs in which the classical detector would have stopped for a wall.
    pub classical_false: u64,
}

impl Corridors {
    /// Adds a run of a course.
    pub fn add(&mut self, course: &Course, run: &Run, with_box: bool) {
        self.runs += 1;
        self.contacts += u64::from(run.summary.contacts_while_moving());
        let is_wall = |body| course.is_wall(body);
        self.classical_false += u64::from(run.classical.iter().any(|stop| is_wall(stop.body)));
        let decisive = run
            .happenings
            .iter()
            .find(|happening| !matches!(happening.event, Event::Covered(_)));
        let begun = course.corridor.scenario.start.position;
        let stood = |pose: &Pose| (pose.position - begun).norm() <= 0.001;
        match decisive.map(|happening| (happening.event, happening.heard, happening.pose)) {
            Some((Event::Detected(..), Some((body, distance)), pose)) => {
                if is_wall(body) {
                    self.walls_detected += 1;
                } else if distance >= 0.3 {
                    self.boxes_before_300 += 1;
                } else if stood(&pose) {
                    self.boxes_at_start += 1;
                } else {
                    self.boxes_nearer += 1;
                }
            }
            // Something was detected where nothing is: as bad as a wall.
            Some((Event::Detected(..), None, _)) => self.walls_detected += 1,
            Some((_, Some((body, _)), _)) if !is_wall(body) => self.boxes_by_shield += 1,
            Some(_) => self.held_by_wall += 1,
            None if run.summary.tally.arrived.is_some() => {
                self.covered += 1;
                self.boxes_missed += u64::from(with_box);
            }
            None if run.latched.is_some() => self.latched += 1,
            None => self.out_of_time += 1,
        }
    }

    /// The sum of two.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            runs: self.runs + other.runs,
            covered: self.covered + other.covered,
            walls_detected: self.walls_detected + other.walls_detected,
            boxes_before_300: self.boxes_before_300 + other.boxes_before_300,
            boxes_at_start: self.boxes_at_start + other.boxes_at_start,
            boxes_nearer: self.boxes_nearer + other.boxes_nearer,
            boxes_by_shield: self.boxes_by_shield + other.boxes_by_shield,
            held_by_wall: self.held_by_wall + other.held_by_wall,
            latched: self.latched + other.latched,
            out_of_time: self.out_of_time + other.out_of_time,
            boxes_missed: self.boxes_missed + other.boxes_missed,
            contacts: self.contacts + other.contacts,
            classical_false: self.classical_false + other.classical_false,
        }
    }
}
