//! A coverage driven by S4, under the shield, in simulation.
//!
//! The law of the chapter `edge` gets the legs of the whole route. Where it reports one as blocked,
//! the robot goes back to where it entered the passage, and from there along a new route. The laser
//! is a simulated LMS200: its scans come as telegrams, and go through the codec.

use super::floor::Floor;
use super::progress::{Progress, Report};
use super::roadmap::{self, PassageId, Roadmap};
use crate::config::RobotConfig;
use crate::demo::{Summary, run_watched};
use crate::edge::{Driver, in_world, robot_for, route};
use crate::laser::LaserScan;
use crate::pilot::Pilot;
use nalgebra::Vector2;
use sidestep::edge::{Edge, EdgeConfig, Event, PlannedEdge, State};
use sidestep::laser::{MAX_TELEGRAM, MeasuringMode, Receiver, Scan, Status, Unit, Variant};
use sidestep::quantity::OutOfRange;
use sidestep::ring::Placement;
use sidestep_sim::geometry::{Point, Pose};
use sidestep_sim::laser::{self, Laser};
use sidestep_sim::scenario::Scenario;
use sidestep_sim::simulation::Simulation;
use sidestep_sim::sonar::Faults;
use sidestep_sim::world::World;
use std::error::Error;

/// A place nearer than this is where the robot is, m.
const THERE: f64 = 0.05;
/// A corner nearer than this is not driven to on the way back, m: less than S4's d_max, so that the next
/// leg can be joined from there.
const BESIDE: f64 = 0.25;
/// A robot that went round something and past the end of a leg has driven it if it is no farther than
/// this from the end, m.
const PASSED: f32 = 0.7;
/// How often a blocked robot tries to get away from where it stands before it is given up as stuck.
const TRIES: u32 = 6;
/// Within this of where the next passage begins the robot may cut the corner, m.
const NEAR: f64 = 1.2;
/// How far into the next passage it goes when it cuts the corner, m.
const CUT: f64 = 0.6;
/// The LMS200 in its usual mode sees as far as this, mm.
const REACH: u32 = 8000;

/// What is to be covered, by what robot.
pub struct Job<'a> {
    /// The floor, with what its map does not have.
    pub floor: &'a Floor,
    /// Its roadmap.
    pub roadmap: &'a Roadmap,
    /// The robot's configuration.
    pub config: RobotConfig,
    /// S4's parameters.
    pub edge: sidestep::edge::Parameters,
    /// Seed of all noise.
    pub seed: u64,
    /// Faults of every sonar.
    pub sonar_faults: Faults,
    /// When to give up, ms.
    pub time_limit_ms: u64,
}

/// Something that happened on the way.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// A passage was driven to its end.
    Covered(PassageId),
    /// Something is on the edge, here (m).
    Detected(Point),
    /// There is room to pass it.
    Passable,
    /// A passage is blocked, by something here (m).
    Blocked(PassageId, Point),
    /// The robot cannot even get back to where it came from.
    Stuck,
}

/// What came of it.
pub struct Run {
    /// Who was covered, who blocked.
    pub report: Report,
    /// How the run went otherwise.
    pub summary: Summary,
    /// The simulation at its end.
    pub simulation: Simulation,
    /// What happened, and when (ms).
    pub happenings: Vec<(u64, Happening)>,
    /// Every scan that was asked for.
    pub scans: Vec<LaserScan>,
    /// The robot came to the end of its last route.
    pub is_home: bool,
}

/// The walls of a floor and the boxes that its map does not have.
///
/// # Errors
/// If the world refuses one of them.
pub fn world(floor: &Floor) -> Result<World, sidestep_sim::Error> {
    let mut world = World::new();
    for wall in &floor.walls {
        world.add_wall(wall.from_point(), wall.to_point())?;
    }
    for surprise in &floor.surprises {
        world.add_box(surprise.pose, surprise.length, surprise.width)?;
    }
    Ok(world)
}

/// The legs of a route, and which of them ends a passage.
struct Legs {
    edges: Vec<PlannedEdge>,
    /// Of each leg: it is part of a step of the plan, and that step's last.
    ends: Vec<Option<bool>>,
}

/// The legs of what is planned, for a robot at `from` that first goes by `back` to where the plan
/// begins, or, if it cuts the corner, straight to a little way into the first passage. None if there is
/// nothing to drive.
fn legs(
    floor: &Floor,
    progress: &Progress<'_>,
    roadmap: &Roadmap,
    from: Point,
    back: &[Point],
    cuts_corner: bool,
) -> Result<Option<Legs>, Box<dyn Error>> {
    let mut edges = Vec::new();
    let mut ends = Vec::new();
    let mut at = from;
    for corner in back {
        if (corner - at).norm() > THERE {
            edges.extend(route(&floor.start, &[at, *corner])?);
            ends.push(None);
            at = *corner;
        }
    }
    for (i, step) in progress.plan().enumerate() {
        let mut course = roadmap.passage(step.passage).course(step.reversed);
        if i == 0 && !cuts_corner && (course[0] - at).norm() > BESIDE {
            edges.extend(route(&floor.start, &[at, course[0]])?);
            ends.push(None);
        }
        if i == 0 && cuts_corner {
            course = behind(&course, CUT);
            edges.extend(route(&floor.start, &[at, course[0]])?);
            ends.push(None);
        }
        let pieces = route(&floor.start, &course)?;
        let count = pieces.len();
        ends.extend((1..=count).map(|i| Some(i == count)));
        edges.extend(pieces);
    }
    Ok((!edges.is_empty()).then_some(Legs { edges, ends }))
}

/// What is left of a course behind its first `length` metres, or its last leg's end half.
fn behind(course: &[Point], length: f64) -> Vec<Point> {
    let mut left = length;
    for (i, pair) in course.windows(2).enumerate() {
        let leg = pair[1] - pair[0];
        let is_last = i + 2 == course.len();
        if leg.norm() > left + THERE || is_last {
            let part = (left / leg.norm()).min(0.5_f64.max(1.0 - THERE / leg.norm()));
            let mut rest = vec![pair[0] + leg * part];
            rest.extend_from_slice(&course[i + 1..]);
            return rest;
        }
        left -= leg.norm();
    }
    course.to_vec()
}

/// A simulated LMS200 on the robot.
struct Scanner {
    laser: Laser,
    receiver: Receiver,
}

impl Scanner {
    /// What the scanner sees, over its line and through the codec.
    fn scan(&mut self, world: &World, robot: &Pose, t: u64) -> Result<LaserScan, Box<dyn Error>> {
        let ranges = self.laser.scan(world, robot);
        let word = |index: u16| match ranges.get(usize::from(index)) {
            // All that cannot be written in 13 bits is "farther than the largest range".
            Some(range) if range.is_finite() && *range < 8.18 => (range * 1000.0).round() as u16,
            _ => 0x1FF7,
        };
        let mut buffer = [0; MAX_TELEGRAM];
        let telegram = Scan::encode(
            &mut buffer,
            0,
            Variant::Degrees180StepHalf,
            Unit::Millimetre,
            Status(0x10),
            word,
        )?;
        let mut bytes = telegram.as_bytes();
        let telegram = self
            .receiver
            .next_frame(&mut bytes)
            .ok_or("the scanner's telegram got lost")?;
        let scan = Scan::new_checked(telegram, MeasuringMode::default())?;
        Ok(LaserScan::of_lms200(&scan, t, REACH))
    }

    /// Where it sits on the robot.
    fn placement(&self) -> Placement {
        let at = self.laser.parameters().placement;
        Placement {
            x: at.position.x as f32,
            y: at.position.y as f32,
            heading: at.heading as f32,
        }
    }
}

/// Gives a scan to a law that wants one.
fn look(
    law: &mut Driver,
    scanner: &mut Scanner,
    world: &World,
    robot: &Pose,
    now: u64,
) -> Result<LaserScan, Box<dyn Error>> {
    let scan = scanner.scan(world, robot, now)?;
    let metres = scan.metres();
    law.take_scan(&scan.view(scanner.placement(), &metres)?);
    Ok(scan)
}

/// Where the robot believes to be (m); where it started, as long as it does not know.
fn believed(pilot: &Pilot<Driver, 8>, floor: &Floor) -> Point {
    let view = pilot.latest().and_then(|decision| decision.view);
    view.map_or(floor.start.position, |view| {
        in_world(&floor.start, view.pose.position)
    })
}

/// The legs that are left for a robot at `at` (m, odometry frame) that a sub-route has taken past the
/// end of leg `leg`, so that it need not go back to what it has just gone round. None if it is not
/// past it.
fn rest(legs: &Legs, leg: usize, at: Vector2<f32>) -> Result<Option<Legs>, OutOfRange> {
    let (Some(now), Some(Some(_))) = (legs.edges.get(leg), legs.ends.get(leg)) else {
        return Ok(None);
    };
    if now.to_edge(at).x < now.length() || (at - now.end()).norm() > PASSED {
        return Ok(None);
    }
    let mut edges = legs.edges[leg + 1..].to_vec();
    let mut ends = legs.ends[leg + 1..].to_vec();
    if let Some(next) = edges.first().copied() {
        // Where the next leg is nearest, but not at its very end.
        let along = next
            .to_edge(at)
            .x
            .clamp(0.0, (next.length() - 0.05).max(0.0));
        let joins = next.to_world(Vector2::new(along, 0.0));
        edges[0] = PlannedEdge::new(joins, next.end())?;
        if f64::from((joins - at).norm()) > BESIDE {
            edges.insert(0, PlannedEdge::new(at, joins)?);
            ends.insert(0, None);
        }
    }
    Ok(Some(Legs { edges, ends }))
}

/// Where the robot believes to have been since it was last at a junction, m.
struct Track(Vec<Point>);

impl Track {
    /// The robot is at a junction.
    fn begin(&mut self, at: Point) {
        self.0 = vec![at];
    }

    fn go_on(&mut self, at: Point) {
        let near = |place: &Point| (at - place).norm() < 2.0 * THERE;
        match self.0.iter().position(near) {
            // It has been here before: what was in between is no way to anywhere.
            Some(before) => self.0.truncate(before + 1),
            None => self.0.push(at),
        }
    }

    /// The way back by which it came, which can be driven since it has been; without what is right
    /// beside the robot.
    fn back(&mut self, at: Point) -> Vec<Point> {
        let nearest = self.0.iter().position(|place| (place - at).norm() < BESIDE);
        if let Some(nearest) = nearest {
            self.0.truncate(nearest.max(1));
        }
        let mut back = roadmap::legs(&self.0, THERE);
        back.reverse();
        back.retain(|place| (place - at).norm() > BESIDE);
        back
    }
}

/// Drives a coverage in virtual time; `tell` hears of everything as it happens, with the time in ms.
///
/// # Errors
/// If something in the job is out of range.
pub fn run(job: &Job<'_>, mut tell: impl FnMut(u64, &Happening)) -> Result<Run, Box<dyn Error>> {
    let (floor, roadmap) = (job.floor, job.roadmap);
    let scenario = Scenario {
        name: "coverage",
        description: floor.name.clone(),
        world: world(floor)?,
        start: floor.start,
        goal: roadmap.graph[roadmap.home],
        time_limit_ms: job.time_limit_ms,
        robot: robot_for(&job.config),
        sonar_faults: job.sonar_faults,
        seed: job.seed,
    };
    let mut progress = Progress::new(roadmap);
    let home = [roadmap.graph[roadmap.home]];
    let mut legs_now = legs(
        floor,
        &progress,
        roadmap,
        floor.start.position,
        &home,
        false,
    )?
    .ok_or("there is nothing to drive")?;
    let law: Driver = Edge::new(
        job.config.core,
        EdgeConfig::new(job.edge)?,
        crate::base::ring(&job.config)?,
        legs_now.edges.clone(),
    )?;
    let parameters = laser::Parameters::default();
    let mut scanner = Scanner {
        laser: Laser::new(parameters, job.seed)?,
        receiver: Receiver::new(),
    };
    let mut happenings = Vec::new();
    let mut scans = Vec::new();
    let mut point = floor.start.position;
    let mut track = Track(vec![floor.start.position]);
    let mut tries = 0;
    let mut failure: Option<Box<dyn Error>> = None;
    let (summary, simulation) =
        run_watched(&scenario, &job.config, law, |pilot, simulation, now| {
            let mut happens = |happening: Happening| {
                tell(now, &happening);
                happenings.push((now, happening));
            };
            let pose = simulation.robot().base().pose();
            if pilot.law_mut().wants_scan() {
                match look(
                    pilot.law_mut(),
                    &mut scanner,
                    simulation.world(),
                    &pose,
                    now,
                ) {
                    Ok(scan) => scans.push(scan),
                    Err(error) => {
                        failure = Some(error);
                        return true;
                    }
                }
            }
            track.go_on(believed(pilot, floor));
            while let Some(event) = pilot.law_mut().next_event() {
                match event {
                    Event::Covered(leg) => {
                        if let Some(Some(true)) = legs_now.ends.get(leg) {
                            if let Some(step) = progress.next() {
                                happens(Happening::Covered(step.passage));
                            }
                            progress.done();
                            track.begin(believed(pilot, floor));
                            tries = 0;
                        }
                    }
                    Event::Detected(_, at) | Event::HeldUp(_, at) => {
                        point = in_world(&floor.start, at);
                        happens(Happening::Detected(point));
                    }
                    Event::Measured(_, free) => {
                        if free.passable {
                            happens(Happening::Passable);
                        }
                    }
                    Event::Blocked(leg) => {
                        let step = progress.next();
                        let on_step = legs_now.ends.get(leg).is_some_and(Option::is_some);
                        let from = believed(pilot, floor);
                        let is_near = (roadmap.graph[progress.at()] - from).norm() < NEAR;
                        let mut back = Vec::new();
                        if on_step && let Some(step) = step {
                            happens(Happening::Blocked(step.passage, point));
                            back = track.back(from);
                            progress.blocked();
                            tries = 0;
                        } else if is_near {
                            // Straight on to the next passage instead; and if that fails as well, it
                            // cannot be entered.
                            tries += 1;
                            if tries > 1
                                && let Some(step) = step
                            {
                                happens(Happening::Blocked(step.passage, point));
                                progress.blocked();
                            }
                        } else {
                            // The rest of the way back once more.
                            tries += 1;
                            back = track.back(from);
                        }
                        let cuts_corner = !on_step && is_near;
                        let next = legs(floor, &progress, roadmap, from, &back, cuts_corner);
                        let next = match next {
                            Ok(Some(next)) if tries <= TRIES => next,
                            Ok(Some(_)) => {
                                happens(Happening::Stuck);
                                return true;
                            }
                            Ok(None) => return true,
                            Err(error) => {
                                failure = Some(error);
                                return true;
                            }
                        };
                        if let Err(error) = pilot.law_mut().reroute(next.edges.clone()) {
                            failure = Some(error.into());
                            return true;
                        }
                        legs_now = next;
                    }
                }
            }
            // After what has happened, which names legs of the route so far.
            let leg = pilot.law_mut().current();
            if pilot.law_mut().state() == State::OffEdge
                && let Some(view) = pilot.latest().and_then(|decision| decision.view)
            {
                let view_point = in_world(&floor.start, view.pose.position);
                match rest(&legs_now, leg, view.pose.position) {
                    Ok(None) => {}
                    Ok(Some(next)) => {
                        if legs_now.ends.get(leg) == Some(&Some(true)) {
                            if let Some(step) = progress.next() {
                                happens(Happening::Covered(step.passage));
                            }
                            progress.done();
                            track.begin(view_point);
                            tries = 0;
                        }
                        legs_now = next;
                        if legs_now.edges.is_empty() {
                            return true;
                        }
                        if let Err(error) = pilot.law_mut().reroute(legs_now.edges.clone()) {
                            failure = Some(error.into());
                            return true;
                        }
                    }
                    Err(error) => {
                        failure = Some(error.into());
                        return true;
                    }
                }
            }
            false
        })?;
    if let Some(failure) = failure {
        return Err(failure);
    }
    let stuck = |(_, happening): &(u64, Happening)| *happening == Happening::Stuck;
    let is_stuck = happenings.iter().any(stuck);
    Ok(Run {
        report: progress.report(),
        is_home: progress.next().is_none() && !is_stuck,
        summary,
        simulation,
        happenings,
        scans,
    })
}
