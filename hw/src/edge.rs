//! S4 in simulation: a route through corridors, a laser that is asked when the robot stands, and
//! who was right about what the sonars heard.

use crate::config::{HeadingSource, RobotConfig, Sonars};
use crate::demo::{Summary, run_watched};
use crate::pilot::Pilot;
use sidestep::config::Config;
use sidestep::edge::{self, Edge, EdgeConfig, Event, PlannedEdge, Scan};
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use sidestep::view::View;
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::laser::{self, Laser};
use sidestep_sim::scenario::Scenario;
use sidestep_sim::simulation::Simulation;
use sidestep_sim::world::{Body, Cone, World};
use std::error::Error;

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
    /// World, start and robot. Its goal is not looked at.
    pub scenario: Scenario,
    /// The corners of the way, m.
    pub corners: Vec<Point>,
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
}

impl Course {
    /// Drives it, in virtual time.
    ///
    /// # Errors
    /// If something in it is out of range.
    pub fn run(&self) -> Result<Run, Box<dyn Error>> {
        let scenario = &self.scenario;
        let start = scenario.start;
        let ring: Ring<8> = crate::base::ring(&self.config)?;
        let law: Driver = Edge::new(
            self.config.core,
            EdgeConfig::new(self.edge)?,
            ring,
            route(&start, &self.corners)?,
        )?;
        let mut scanner = match self.laser {
            Some(parameters) => Some(Laser::new(parameters, scenario.seed)?),
            None => None,
        };
        let mut happenings = Vec::new();
        let mut classical = Vec::new();
        let mut warned: Option<Body> = None;
        let mut looked_at = None;
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
                let mut ends = false;
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
