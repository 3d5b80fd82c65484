//! Episodes by the hundred thousand: the program's own loop and a simulated robot in virtual time,
//! with a line between them, among people made up from a seed.

use crate::base;
use crate::config::RobotConfig;
use crate::demo::goal_from_start;
use crate::draw::{Picture, Stop, draw};
use crate::pilot::{Pilot, settings, usual_law};
use crate::session::{Output, Settings};
use sidestep::arcos::{BaseParameters, command};
use sidestep::law::{Advice, Law};
use sidestep::observation::SonarReading;
use sidestep::quantity::OutOfRange;
use sidestep::view::{Class, View};
use sidestep_sim::STEP_MS;
use sidestep_sim::episode::{Episode, Options};
use sidestep_sim::geometry::{heading_of, wrap};
use sidestep_sim::link::{self, Link, Packet};
use sidestep_sim::robot::Firing;
use sidestep_sim::scenario::Scenario;
use sidestep_sim::simulation::{ByKind, MovingContact, Outcome, Sample, Simulation};
use sidestep_sim::truth::{Assumptions, Broken};
use sidestep_sim::world::Body;
use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// Numbers out of a seed.
#[derive(Clone, Debug)]
pub(crate) struct Random(pub u64);

impl Random {
    /// Any bits (splitmix64).
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in [−1, 1).
    pub(crate) fn signed(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.bits() % end.max(1)
    }

    /// A number in [least, greatest).
    pub(crate) fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * f64::midpoint(1.0, f64::from(self.signed()))
    }
}

/// Full speed straight ahead, whatever is there.
#[derive(Clone, Copy, Debug)]
pub struct Reckless;

impl<const N: usize> Law<N> for Reckless {
    fn advise(&mut self, _view: &View<N>) -> Advice {
        Advice {
            speed: 10.0,
            turn_rate: 0.0,
        }
    }

    fn mode(&self) -> &'static str {
        "reckless"
    }
}

/// What [`Chaos`] is up to for a while.
#[derive(Clone, Copy, Debug)]
enum Whim {
    AnyBits,
    NotANumber,
    Infinite,
    AtTheNearest,
    Backwards,
    Ahead,
    Spin,
    Jerk,
}

/// Advice of every bad kind, each for a while: any bits, no numbers, infinities, full speed at
/// whatever is nearest, backwards, straight on, round and round, hither and thither.
#[derive(Clone, Debug)]
pub struct Chaos {
    random: Random,
    whim: Whim,
    /// Ticks for which it lasts.
    left: u64,
    strength: f32,
}

impl Chaos {
    /// The chaos that `seed` makes.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self {
            random: Random(seed),
            whim: Whim::Ahead,
            left: 0,
            strength: 0.0,
        }
    }

    fn choose(&mut self) {
        // What is no number stops the robot: seldom, and not for long.
        (self.whim, self.left) = match self.random.below(24) {
            0 => (Whim::NotANumber, 1),
            1 => (Whim::Infinite, 1),
            2..=4 => (Whim::AnyBits, 10),
            5..=12 => (Whim::AtTheNearest, 30),
            13..=14 => (Whim::Backwards, 15),
            15..=18 => (Whim::Ahead, 30),
            19..=20 => (Whim::Spin, 15),
            _ => (Whim::Jerk, 15),
        };
        self.left = 1 + self.random.below(self.left);
        self.strength = self.random.signed();
    }
}

impl<const N: usize> Law<N> for Chaos {
    fn advise(&mut self, view: &View<N>) -> Advice {
        if self.left == 0 {
            self.choose();
        }
        self.left -= 1;
        let any = |random: &mut Random| match random.below(4) {
            0 => f32::from_bits(random.bits() as u32),
            _ => random.signed(),
        };
        let (speed, turn_rate) = match self.whim {
            Whim::AnyBits => (any(&mut self.random), any(&mut self.random)),
            Whim::NotANumber => (f32::NAN, self.strength),
            Whim::Infinite => (f32::INFINITY, f32::NEG_INFINITY),
            Whim::AtTheNearest => (10.0, 4.0 * bearing_of_nearest(&view.sonar)),
            Whim::Backwards => (-10.0, self.strength),
            Whim::Ahead => (10.0, 0.2 * self.strength),
            Whim::Spin => (self.strength.abs(), 10.0 * self.strength),
            Whim::Jerk => (10.0, 10.0 * self.random.signed()),
        };
        Advice { speed, turn_rate }
    }

    fn mode(&self) -> &'static str {
        "chaos"
    }
}

/// Direction of the axis of the sonar with the nearest echo (rad), 0 without any.
fn bearing_of_nearest(readings: &[SonarReading]) -> f32 {
    let placements = BaseParameters::P3DX.sonars.iter();
    let echoes = readings.iter().zip(placements).filter_map(|(reading, at)| {
        let range = match reading {
            SonarReading::Echo(range) => range.get(),
            SonarReading::TooNear => 0.0,
            _ => return None,
        };
        Some((range, f32::from(at.heading_deg).to_radians()))
    });
    let nearest = echoes.min_by(|one, other| one.0.total_cmp(&other.0));
    nearest.map_or(0.0, |(_, bearing)| bearing)
}

/// The laws that episodes are run with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawKind {
    /// S1's.
    Avoid,
    /// [`Chaos`].
    Chaos,
    /// [`Reckless`].
    Reckless,
}

impl LawKind {
    /// The law of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "avoid" => Some(Self::Avoid),
            "chaos" => Some(Self::Chaos),
            "reckless" => Some(Self::Reckless),
            _ => None,
        }
    }
}

/// What a shield so configured counts on.
#[must_use]
pub fn assumptions(config: &RobotConfig) -> Assumptions {
    let core = &config.core;
    Assumptions {
        person_speed: core.obstacle_speed_max.into(),
        braking: core.braking.into(),
        acceleration: core.acceleration.into(),
        reaction_ms: (core.reaction_time * 1000.0).round() as u64,
    }
}

/// A pilot through `scenario` that leaves no log.
///
/// # Errors
/// If the goal is out of range, or the ring of sonars does not fit.
pub fn pilot<L: Law<16>>(
    scenario: &Scenario,
    config: &RobotConfig,
    settings: Settings,
    law: L,
) -> Result<Pilot<L, 16>, OutOfRange> {
    let goal = goal_from_start(scenario);
    Pilot::with_law(law, *config, goal, settings, Box::new(std::io::sink()))
}

/// The side of the line that decides, in virtual time.
pub trait Host {
    /// Takes in what arrived at `now` (ms).
    fn receive(&mut self, bytes: &[u8], now: u64);

    /// What is to be done with the transport next.
    fn poll(&mut self, now: u64) -> Option<Output>;

    /// What the law is doing, once it was asked.
    fn mode(&self) -> Option<&'static str>;
}

impl<L: Law<16>> Host for Pilot<L, 16> {
    fn receive(&mut self, bytes: &[u8], now: u64) {
        Self::receive(self, bytes, now);
    }

    fn poll(&mut self, now: u64) -> Option<Output> {
        let output = Self::poll(self, now);
        while self.next_event().is_some() {}
        output
    }

    fn mode(&self) -> Option<&'static str> {
        self.latest().map(|decision| decision.mode)
    }
}

/// A host and a simulated robot in virtual time, with a line between them that may be bad.
pub struct Ride<H> {
    /// World and robot.
    pub simulation: Simulation,
    /// The host.
    pub host: H,
    to_host: Link,
    to_robot: Link,
    now: u64,
    /// The host does nothing before this (ms).
    stalled_until: u64,
    /// When that was so which the host heard last (ms).
    heard: u64,
    /// Speeds and turn rates under way inside the base: when each takes effect, the command's number,
    /// and what it rests on (ms).
    effects: VecDeque<(u64, u8, u64)>,
    /// What the speed and the turn rate in force rest on (ms).
    in_force: [u64; 2],
    /// Age of the oldest reading of a packet when it is sent (ms).
    reading_age: u64,
}

impl<H: Host> Ride<H> {
    /// A ride of `host` in `simulation`; what goes wrong on `line` follows from `seed`.
    ///
    /// # Errors
    /// If a fault of the line is out of range.
    pub fn new(
        simulation: Simulation,
        host: H,
        line: link::Faults,
        seed: u64,
    ) -> Result<Self, sidestep_sim::Error> {
        let robot = simulation.robot().parameters();
        Ok(Self {
            host,
            to_host: Link::new(line, seed)?,
            to_robot: Link::new(line, !seed)?,
            now: 0,
            stalled_until: 0,
            heard: 0,
            effects: VecDeque::new(),
            in_force: [0; 2],
            reading_age: match robot.firing {
                Firing::All => 0,
                Firing::RoundRobin { .. } => robot.sip_cycle_ms.into(),
            },
            simulation,
        })
    }

    /// Time since the beginning (ms).
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Makes the line bad or good from now on.
    ///
    /// # Errors
    /// If a fault is out of range.
    pub fn set_line(
        &mut self,
        to_host: link::Faults,
        to_robot: link::Faults,
    ) -> Result<(), sidestep_sim::Error> {
        self.to_host.set_faults(to_host)?;
        self.to_robot.set_faults(to_robot)
    }

    /// The host does nothing for `ms` from now on; what it is sent meanwhile waits for it.
    pub const fn stall(&mut self, ms: u64) {
        self.stalled_until = self.now + ms;
    }

    /// Everything moves on by a step.
    pub fn step(&mut self) {
        self.now += STEP_MS;
        let now = self.now;
        self.simulation.advance_to(now);
        self.note_reaction();
        let robot = self.simulation.robot_mut();
        let described = now.saturating_sub(self.reading_age);
        self.to_host.send(&robot.transmit(), now, described);
        if now >= self.stalled_until {
            for Packet { bytes, basis_ms } in self.to_host.arrivals(now) {
                self.heard = basis_ms;
                self.host.receive(&bytes, now);
            }
            while let Some(output) = self.host.poll(now) {
                if let Output::Send(bytes) = output {
                    self.to_robot.send(&bytes, now, self.heard);
                }
            }
        }
        for Packet { bytes, basis_ms } in self.to_robot.arrivals(now) {
            let robot = self.simulation.robot_mut();
            // Header and length stand before a frame's number.
            if let Some(&number @ (command::VEL | command::RVEL)) = bytes.get(3) {
                let delay = robot.base().parameters().delay_ms;
                self.effects.push_back((now + delay, number, basis_ms));
            }
            robot.receive(&bytes);
        }
    }

    fn note_reaction(&mut self) {
        let now = self.now;
        while let Some((_, number, basis)) = self.effects.pop_front_if(|(due, ..)| *due < now) {
            self.in_force[usize::from(number == command::RVEL)] = basis;
        }
        let base = self.simulation.robot().base();
        let told = [base.speed_setpoint(), base.turn_rate_setpoint()];
        for (told, basis) in told.into_iter().zip(self.in_force) {
            if told != 0.0 {
                let age = now.saturating_sub(basis);
                self.simulation.truth_mut().note_reaction(age);
            }
        }
    }
}

/// What came of an episode.
#[derive(Clone, Debug)]
pub struct Report {
    /// Its seed.
    pub seed: u64,
    /// Its kind, one of [`sidestep_sim::episode::KINDS`].
    pub kind: &'static str,
    /// What happened in the world.
    pub outcome: Outcome,
    /// The contacts that were never to be.
    pub contacts: Vec<MovingContact>,
    /// The assumptions that did not hold.
    pub broken: Vec<Broken>,
    /// Stops begun, by the kind of reason.
    pub stops: BTreeMap<String, u64>,
    /// Ticks of the controller in which the robot was made to stand still.
    pub ticks_stopped: u64,
    /// Ticks of the controller.
    pub ticks: u64,
    /// Whether the goal was reached.
    pub arrived: bool,
}

/// An episode run to its end.
pub struct Run {
    /// What came of it.
    pub report: Report,
    /// What it was.
    pub scenario: Scenario,
    /// The world at the end.
    pub simulation: Simulation,
    /// The stops.
    pub stops: Vec<Stop>,
}

impl Run {
    /// The run as a picture (SVG).
    #[must_use]
    pub fn picture(&self) -> String {
        let broken = self.report.broken.iter().map(ToString::to_string);
        let contacts = self.report.contacts.iter().map(describe);
        let notes: Vec<String> = contacts.chain(broken).collect();
        draw(&Picture {
            title: &format!("{}: {}", self.scenario.name, self.scenario.description),
            notes: &notes,
            world: self.simulation.world(),
            trace: self.simulation.trace(),
            goal: self.scenario.goal,
            robot_radius: self.scenario.robot.base.radius,
            stops: &self.stops,
        })
    }
}

/// A contact in a line.
#[must_use]
pub fn describe(contact: &MovingContact) -> String {
    let touched = if contact.touched_before {
        ", touched at rest before"
    } else {
        ""
    };
    format!(
        "at {:.2} s {:?} at {:.0}°, {:.2} m/s; robot {:?} at {:.2} m/s{touched}",
        contact.time_ms as f64 / 1000.0,
        contact.body,
        contact.bearing.to_degrees(),
        contact.body_speed,
        contact.activity,
        contact.speed,
    )
}

/// Is told each decision in a line, to find out how something came about.
pub type Tell<'a> = Option<&'a mut dyn FnMut(String)>;

/// Runs the episode that `seed` makes up.
///
/// # Errors
/// If an option or the configuration is out of range.
pub fn run(
    seed: u64,
    options: &Options,
    config: &RobotConfig,
    law: LawKind,
    tell: Tell<'_>,
) -> Result<Run, Box<dyn Error>> {
    match law {
        LawKind::Avoid => {
            let law = usual_law(config.core, base::ring(config)?);
            run_with(seed, options, config, law, tell)
        }
        LawKind::Chaos => run_with(seed, options, config, Chaos::new(seed), tell),
        LawKind::Reckless => run_with(seed, options, config, Reckless, tell),
    }
}

fn run_with<L: Law<16>>(
    seed: u64,
    options: &Options,
    config: &RobotConfig,
    law: L,
    tell: Tell<'_>,
) -> Result<Run, Box<dyn Error>> {
    let episode = Episode::new(seed, options)?;
    let pilot = pilot(
        &episode.scenario,
        config,
        settings(config, false, None),
        law,
    )?;
    let ride = Ride::new(episode.simulate()?, pilot, episode.link, seed)?;
    Ok(record(ride, episode.scenario, config, tell, |_| {}))
}

/// Rides until the robot has arrived or the time of `scenario` is over, and reports. `after_step` is
/// for what else happens in each step.
pub(crate) fn record<L: Law<16>>(
    mut ride: Ride<Pilot<L, 16>>,
    scenario: Scenario,
    config: &RobotConfig,
    mut tell: Tell<'_>,
    mut after_step: impl FnMut(&mut Ride<Pilot<L, 16>>),
) -> Run {
    let (mut ticks, mut ticks_stopped) = (0, 0);
    let mut people = Vec::new();
    while ride.now() < scenario.time_limit_ms {
        ride.step();
        after_step(&mut ride);
        let tally = ride.host.tally();
        if tally.arrived.is_some() {
            break;
        }
        let stopped = ride.host.latest().is_some_and(|d| d.stop.is_some());
        ticks_stopped += if stopped { tally.ticks - ticks } else { 0 };
        if tally.ticks > ticks {
            note_people(&ride, &mut people);
            if let Some(tell) = &mut tell {
                tell(decided(&ride));
            }
        }
        ticks = tally.ticks;
    }
    let mut broken = ride.simulation.truth().broken(&assumptions(config));
    broken.extend(explained(
        ride.simulation.moving_contacts(),
        &people,
        config.core.still_speed_max.into(),
    ));
    let tally = ride.host.tally();
    let stops = ride.host.stops().iter().map(|stop| Stop {
        t: stop.t,
        reason: stop.reason.to_string(),
    });
    Run {
        report: Report {
            seed: scenario.seed,
            kind: scenario.name,
            outcome: ride.simulation.outcome(),
            contacts: ride.simulation.moving_contacts().to_vec(),
            broken,
            stops: tally.stops.clone(),
            ticks_stopped,
            ticks,
            arrived: tally.arrived.is_some(),
        },
        stops: stops.collect(),
        scenario,
        simulation: ride.simulation,
    }
}

/// Somebody at one moment, as far as it matters to the shield.
pub(crate) struct Seen {
    person: usize,
    time_ms: u64,
    /// m/s.
    speed: f64,
    /// The shield takes them for something that stands still.
    still: bool,
}

/// Notes how fast people are, and who is where the shield believes that something stands still.
fn note_people<L: Law<16>>(ride: &Ride<Pilot<L, 16>>, seen: &mut Vec<Seen>) {
    let Some(view) = ride.host.latest().and_then(|decision| decision.view) else {
        return;
    };
    let base = ride.simulation.robot().base();
    let pose = base.pose();
    for (i, person) in ride.simulation.world().people().iter().enumerate() {
        let Some(place) = person.position() else {
            continue;
        };
        let mut still = false;
        for (index, hazard) in view.hazard.iter().enumerate() {
            let Some(cone) = ride.simulation.robot().ring().cone(index, &pose) else {
                continue;
            };
            let offset = place - cone.apex.position;
            let aside = wrap(heading_of(&offset) - cone.apex.heading).abs();
            let width = (person.radius() / offset.norm()).min(1.0).asin();
            let range = f64::from(hazard.range) / 1000.0;
            let near = (offset.norm() - person.radius() - range).abs() <= 0.15;
            still |= hazard.class == Class::Still && near && aside <= cone.half_angle + width;
        }
        seen.push(Seen {
            person: i,
            time_ms: ride.now(),
            speed: person.speed(),
            still,
        });
    }
}

/// From when somebody begins to move to a contact, ms: it takes no longer to see that, to react and
/// to brake.
const BREACH_MS: u64 = 1000;

/// The class bound that was broken, if that explains every one of these contacts.
fn explained(contacts: &[MovingContact], seen: &[Seen], bound: f64) -> Option<Broken> {
    let mut was: f64 = 0.0;
    for contact in contacts {
        let Body::Person(person) = contact.body else {
            return None;
        };
        let before = |seen: &&Seen| {
            seen.person == person
                && (0..=BREACH_MS).contains(&contact.time_ms.wrapping_sub(seen.time_ms))
        };
        // Taken to stand still, and then faster than that.
        let taken = seen.iter().filter(before).find(|seen| seen.still)?;
        let after = |seen: &&Seen| seen.time_ms >= taken.time_ms;
        let speeds = seen
            .iter()
            .filter(before)
            .filter(after)
            .map(|seen| seen.speed);
        let fastest = speeds.fold(contact.body_speed, f64::max);
        if fastest <= bound {
            return None;
        }
        was = was.max(fastest);
    }
    (was > bound).then_some(Broken::StillSpeed { was, bound })
}

/// What was decided last, and how things truly are.
fn decided<L: Law<16>>(ride: &Ride<Pilot<L, 16>>) -> String {
    let base = ride.simulation.robot().base();
    let pose = base.pose();
    let mut line = format!(
        "{:6} ms at {:.2}, {:.2} m, {:.0}°: {:.3} m/s, {:.2} rad/s;",
        ride.now(),
        pose.position.x,
        pose.position.y,
        pose.heading.to_degrees(),
        base.speed(),
        base.turn_rate()
    );
    if let Some(decision) = ride.host.latest() {
        let (speed, turn) = (decision.command.speed(), decision.command.turn_rate());
        line += &format!(" told {speed} mm/s, {turn} mrad/s, {}", decision.mode);
        if let Some(stop) = decision.stop {
            line += &format!(", stop: {stop}");
        }
        if let Some(view) = &decision.view {
            for (sonar, hazard) in view.hazard.iter().enumerate() {
                if hazard.clearance < 600 {
                    let (class, age) = (hazard.class, hazard.age);
                    line += &format!("; sonar {sonar}: {} mm {class} {age} ms", hazard.clearance);
                }
            }
        }
    }
    for person in ride.simulation.world().people() {
        if let Some(place) = person.position() {
            let offset = place - pose.position;
            let gap = offset.norm() - person.radius() - base.parameters().radius;
            let bearing = wrap(heading_of(&offset) - pose.heading).to_degrees();
            line += &format!("; person {gap:.3} m off at {bearing:.0}°");
        }
    }
    line
}

/// How long after the last of the people had left its way the robot moved again, faster than
/// `speed` (m/s), in ms: 0 if it moved at that moment or had arrived. Nothing if it never did, or
/// if nobody left its way.
#[must_use]
pub fn moving_again_ms(scenario: &Scenario, trace: &[Sample], speed: f64) -> Option<u64> {
    let free = scenario.way_free_ms(trace)?;
    let mut after = trace.iter().skip_while(|sample| sample.time_ms < free);
    let moving = after.find(|sample| sample.speed.abs() > speed)?;
    Some(moving.time_ms - free)
}

/// Failures of which a [`Totals`] keeps the particulars.
const KEPT: usize = 20;

/// What came of many episodes.
#[derive(Clone, Debug, Default)]
pub struct Totals {
    /// Episodes.
    pub episodes: u64,
    /// Episodes in which the robot, moving, was in contact with anything: none if all assumptions
    /// held.
    pub failed: u64,
    /// Those of them in which every assumption held: what must not be.
    pub failed_unexplained: u64,
    /// Contacts while the robot drove.
    pub while_driving: ByKind<u32>,
    /// Contacts while it turned in place.
    pub while_turning: ByKind<u32>,
    /// Contacts while it stood.
    pub at_rest: ByKind<u32>,
    /// Way driven (m).
    pub travelled: f64,
    /// Simulated time (s).
    pub seconds: f64,
    /// Episodes in which the goal was reached.
    pub arrived: u64,
    /// Ticks, and those of them in which the robot was made to stand still.
    pub ticks: [u64; 2],
    /// Stops begun, by the kind of reason.
    pub stops: BTreeMap<String, u64>,
    /// Episodes in which an assumption did not hold, by its name.
    pub broken: BTreeMap<&'static str, u64>,
    /// Episodes, failures and way driven (m), by kind.
    pub kinds: BTreeMap<&'static str, (u64, u64, f64)>,
    /// The failures with the lowest seeds.
    pub failures: BTreeMap<u64, Report>,
}

impl Totals {
    /// Adds an episode.
    pub fn add(&mut self, report: Report) {
        let outcome = &report.outcome;
        let failed = u64::from(!report.contacts.is_empty());
        self.episodes += 1;
        self.failed += failed;
        self.failed_unexplained += if report.broken.is_empty() { failed } else { 0 };
        sum(&mut self.while_driving, outcome.contacts_while_driving);
        sum(&mut self.while_turning, outcome.contacts_while_turning);
        sum(&mut self.at_rest, outcome.contacts_at_rest);
        self.travelled += outcome.travelled;
        self.seconds += outcome.duration_ms as f64 / 1000.0;
        self.arrived += u64::from(report.arrived);
        self.ticks[0] += report.ticks;
        self.ticks[1] += report.ticks_stopped;
        for (reason, count) in &report.stops {
            *self.stops.entry(reason.clone()).or_default() += count;
        }
        for broken in &report.broken {
            *self.broken.entry(broken.name()).or_default() += 1;
        }
        let kind = self.kinds.entry(report.kind).or_default();
        *kind = (kind.0 + 1, kind.1 + failed, kind.2 + outcome.travelled);
        if failed > 0 {
            self.keep(report);
        }
    }

    fn keep(&mut self, report: Report) {
        self.failures.insert(report.seed, report);
        while self.failures.len() > KEPT {
            self.failures.pop_last();
        }
    }

    /// Adds other totals.
    pub fn merge(&mut self, other: Self) {
        self.episodes += other.episodes;
        self.failed += other.failed;
        self.failed_unexplained += other.failed_unexplained;
        sum(&mut self.while_driving, other.while_driving);
        sum(&mut self.while_turning, other.while_turning);
        sum(&mut self.at_rest, other.at_rest);
        self.travelled += other.travelled;
        self.seconds += other.seconds;
        self.arrived += other.arrived;
        for (mine, theirs) in self.ticks.iter_mut().zip(other.ticks) {
            *mine += theirs;
        }
        for (reason, count) in other.stops {
            *self.stops.entry(reason).or_default() += count;
        }
        for (name, count) in other.broken {
            *self.broken.entry(name).or_default() += count;
        }
        for (name, (episodes, failed, way)) in other.kinds {
            let kind = self.kinds.entry(name).or_default();
            *kind = (kind.0 + episodes, kind.1 + failed, kind.2 + way);
        }
        for (_, report) in other.failures {
            self.keep(report);
        }
    }
}

fn sum(total: &mut ByKind<u32>, more: ByKind<u32>) {
    total.people += more.people;
    total.obstacles += more.obstacles;
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let contacts = |c: ByKind<u32>| format!("people {}, obstacles {}", c.people, c.obstacles);
        writeln!(
            f,
            "episodes:                    {}\n\
             failed:                      {} ({} with every assumption held)\n\
             contacts while driving:      {}\n\
             contacts while turning:      {}\n\
             contacts at rest:            {}",
            self.episodes,
            self.failed,
            self.failed_unexplained,
            contacts(self.while_driving),
            contacts(self.while_turning),
            contacts(self.at_rest),
        )?;
        let [ticks, stopped] = self.ticks;
        writeln!(
            f,
            "driven:                      {:.0} m in {:.0} s, mean speed {:.3} m/s; arrived in {}",
            self.travelled,
            self.seconds,
            self.travelled / self.seconds.max(1.0),
            self.arrived,
        )?;
        writeln!(
            f,
            "made to stand still:         {:.1} % of the ticks",
            100.0 * stopped as f64 / ticks.max(1) as f64
        )?;
        let all: u64 = self.stops.values().sum();
        writeln!(f, "stops begun:                 {all}")?;
        for (reason, count) in &self.stops {
            let share = 100.0 * *count as f64 / all.max(1) as f64;
            writeln!(f, "  {reason:<18} {count:>9}  {share:5.1} %")?;
        }
        for (kind, (episodes, failed, way)) in &self.kinds {
            writeln!(
                f,
                "{kind:<16} {episodes:>8} episodes, {failed:>5} failed, {way:>8.0} m driven"
            )?;
        }
        if self.broken.is_empty() {
            writeln!(f, "broken assumptions:          none")?;
        }
        for (name, count) in &self.broken {
            writeln!(f, "broken assumption:           {name} in {count} episodes")?;
        }
        for report in self.failures.values() {
            writeln!(f, "seed {} ({}):", report.seed, report.kind)?;
            for contact in &report.contacts {
                writeln!(f, "  {}", describe(contact))?;
            }
            for broken in &report.broken {
                writeln!(f, "  broken: {broken}")?;
            }
        }
        Ok(())
    }
}

/// Runs `count` episodes with the seeds from `first` on, in `threads` threads; `progress` is told
/// from time to time how many are done.
///
/// # Errors
/// If an option or the configuration is out of range.
pub fn run_many(
    first: u64,
    count: u64,
    threads: usize,
    options: &Options,
    config: &RobotConfig,
    law: LawKind,
    progress: impl Fn(u64) + Sync,
) -> Result<Totals, Box<dyn Error>> {
    let next = AtomicU64::new(0);
    let work = || {
        let mut totals = Totals::default();
        loop {
            let done = next.fetch_add(1, Ordering::Relaxed);
            if done >= count {
                return Ok(totals);
            }
            progress(done);
            let run = run(first + done, options, config, law, None).map_err(|e| e.to_string())?;
            totals.add(run.report);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        let mut totals = Totals::default();
        for worker in workers {
            let part: Result<Totals, String> =
                worker.join().map_err(|_| "an episode could not be run")?;
            totals.merge(part?);
        }
        Ok(totals)
    })
}
