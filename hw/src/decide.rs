//! S2's decision driving a simulated robot: the law, a demonstration with its timeline, and S1 alone
//! against S1 with S2 under bad sonars.

use crate::base;
use crate::config::{self, RobotConfig};
use crate::demo::{self, Options, Ran};
use crate::draw::{round, text};
use crate::drive::{Signals, Status};
use crate::pilot::{Pilot, settings as base_settings};
use crate::session::Output;
use sidestep::avoid::Avoid;
use sidestep::config::{Config, Parameters};
use sidestep::controller::Decision;
use sidestep::decide::{BadSettings, Decide, Response, Settings, Verdict};
use sidestep::escape::Escape;
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::quantity::OutOfRange;
use sidestep::ring::Ring;
use sidestep::track::Obstacle;
use sidestep::view::View;
use sidestep_sim::geometry::{Pose, heading_of, wrap};
use sidestep_sim::scenario::{APPROACH, Knobs, Scenario};
use sidestep_sim::{STEP_MS, Simulation};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use svg::Document;
use svg::node::element::{Circle, Group, Line, Polyline, Rectangle, Title};

/// What the law and its demonstration are called.
pub const NAME: &str = "decide";

/// S1's law with S2's decision round it, and round both a way out of where they are stuck.
pub type DecideLaw<const N: usize> = Escape<Decide<Avoid, N>, N>;

/// The law for a ring of sonars.
#[must_use]
pub fn law<const N: usize>(config: Config, ring: Ring<N>, settings: Settings) -> DecideLaw<N> {
    let decide = Decide::new(Avoid::new(config), config, ring, settings);
    Escape::new(decide, config, ring)
}

/// The usual settings of the decision for a robot.
///
/// # Errors
/// [`BadSettings`] if they do not fit the robot's distances.
pub fn settings(config: &RobotConfig) -> Result<Settings, BadSettings> {
    Settings::usual(&config.core)
}

/// S2's Table 1 (speeds of robot and people up to 0.3 m/s, d_safe 120 cm, d_n 90 cm) on a P3-DX.
pub const TABLE_1: &str = "\
near_distance = \"90 cm\"
speed_max = \"30 cm/s\"
cruise_speed = \"15 cm/s\"
obstacle_speed_max = \"30 cm/s\"
still_speed_max = \"20 cm/s\"
still_speed_max_turning = \"30 cm/s\"
";

/// The robot of [`TABLE_1`].
///
/// # Errors
/// Never, as long as the table is what it is.
pub fn table_1() -> Result<RobotConfig, Box<dyn Error>> {
    Ok(config::parse(TABLE_1, "S2 Table 1")?)
}

// ------------------------------------------------------------ the demonstration

/// A tick of the decision.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment {
    /// ms.
    t: u64,
    verdict: Verdict,
    /// Distance of what the view takes for the obstacle, m.
    seen: Option<f32>,
    /// The shield holds the robot.
    held: bool,
}

/// The law, with a note of every tick.
struct Watched<const N: usize> {
    law: DecideLaw<N>,
    moments: Vec<Moment>,
}

impl<const N: usize> Law<N> for Watched<N> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        let advice = self.law.advise(view);
        self.moments.push(Moment {
            t: view.now.0,
            verdict: *self.law.law().verdict(),
            seen: view.obstacle.map(|obstacle| obstacle.distance.get()),
            held: view.guard.is_some(),
        });
        advice
    }

    fn mode(&self) -> &'static str {
        self.law.mode()
    }
}

/// Runs S2's experiment and leaves, beside what every demonstration leaves, `timeline.svg`: belief,
/// decision and distance over time. Gives the folder and the contacts while the robot moved.
///
/// # Errors
/// If the pseudo-terminal, the port or the folder cannot be used.
pub fn demonstrate(
    options: &Options,
    signals: &Signals,
    status: &mut Status,
) -> Result<(PathBuf, u32), Box<dyn Error>> {
    let scenario = Scenario::named(APPROACH, &options.knobs)?;
    let config = &options.config;
    let watched = Watched::<16> {
        law: law(config.core, base::ring(config)?, settings(config)?),
        moments: Vec::new(),
    };
    let ran: Ran<_> = demo::run_with(watched, NAME, &scenario, options, signals, status)?;
    let timeline = timeline(
        &scenario.description,
        &ran.pilot.law().moments,
        &config.core,
    );
    fs::write(ran.folder.join("timeline.svg"), timeline)?;
    status.keep(&format!(
        "timeline: {}",
        ran.folder.join("timeline.svg").display()
    ));
    Ok((ran.folder, ran.summary.contacts_while_moving()))
}

/// Width of the plot and of what stands to the left of it, pixels.
const WIDTH: f64 = 1000.0;
const LEFT: f64 = 90.0;
const SEEN: &str = "#adb5bd";
const BELIEVED: &str = "#1f5fbf";
const DOUBTED: &str = "#e8590c";

const fn colour(response: Response) -> &'static str {
    match response {
        Response::Continue => "#d3f9d8",
        Response::Maneuver => "#a5d8ff",
        Response::Stop => "#ff8787",
    }
}

/// A plot with its axis: values from 0 to `most`, drawn between two heights.
struct Plot {
    top: f64,
    bottom: f64,
    most: f64,
    /// Seconds.
    from: f64,
    to: f64,
}

impl Plot {
    fn at(&self, t: u64, value: f64) -> (f64, f64) {
        let along = (t as f64 / 1000.0 - self.from) / (self.to - self.from).max(0.1);
        let up = value.clamp(0.0, self.most) / self.most;
        (
            round(LEFT + along * WIDTH),
            round(self.bottom - up * (self.bottom - self.top)),
        )
    }

    /// A level across the plot, with its name.
    fn level(&self, value: f64, name: &str) -> Group {
        let (_, y) = self.at(0, value);
        Group::new()
            .add(line((LEFT, y), (LEFT + WIDTH, y), "#dee2e6", 1.0))
            .add(text(4.0, y + 4.0, 11.0, name))
    }

    /// A curve that is broken where there is no value.
    fn curve(
        &self,
        moments: &[Moment],
        value: impl Fn(&Moment) -> Option<f32>,
        colour: &str,
    ) -> Group {
        let mut group = Group::new();
        let mut points: Vec<String> = Vec::new();
        let mut flush = |points: &mut Vec<String>| {
            let line = Polyline::new()
                .set("points", points.join(" "))
                .set("fill", "none")
                .set("stroke", colour)
                .set("stroke-width", 2);
            group = std::mem::take(&mut group).add(line);
            points.clear();
        };
        for moment in moments {
            match value(moment) {
                Some(value) => {
                    let (x, y) = self.at(moment.t, value.into());
                    points.push(format!("{x},{y}"));
                }
                None if points.is_empty() => {}
                None => flush(&mut points),
            }
        }
        if !points.is_empty() {
            flush(&mut points);
        }
        group
    }

    fn dots(
        &self,
        moments: &[Moment],
        value: impl Fn(&Moment) -> Option<f32>,
        colour: &str,
    ) -> Group {
        moments.iter().fold(Group::new(), |group, moment| {
            let Some(value) = value(moment) else {
                return group;
            };
            let (x, y) = self.at(moment.t, value.into());
            let dot = Circle::new().set("cx", x).set("cy", y).set("r", 2);
            group.add(dot.set("fill", colour))
        })
    }

    /// A strip from one moment to the next wherever there is a colour.
    fn strip(
        &self,
        moments: &[Moment],
        fill: impl Fn(&Moment) -> Option<(&'static str, String)>,
    ) -> Group {
        let mut group = Group::new();
        let mut rest = moments;
        while let [first, ..] = rest {
            let kind = fill(first);
            let same = rest
                .iter()
                .take_while(|moment| fill(moment) == kind)
                .count();
            let end = rest.get(same).map_or(rest[same - 1].t, |next| next.t);
            if let Some((colour, name)) = kind {
                let ((x, _), (to, _)) = (self.at(first.t, 0.0), self.at(end, 0.0));
                group = group.add(
                    Rectangle::new()
                        .set("x", x)
                        .set("y", self.top)
                        .set("width", round((to - x).max(1.0)))
                        .set("height", self.bottom - self.top)
                        .set("fill", colour)
                        .add(Title::new(name)),
                );
            }
            rest = &rest[same..];
        }
        group
    }
}

fn line(from: (f64, f64), to: (f64, f64), colour: &str, width: f64) -> Line {
    Line::new()
        .set("x1", from.0)
        .set("y1", from.1)
        .set("x2", to.0)
        .set("y2", to.1)
        .set("stroke", colour)
        .set("stroke-width", width)
}

/// Belief, decision and distance over time, as SVG.
fn timeline(title: &str, moments: &[Moment], config: &Config) -> String {
    let seconds = |moment: Option<&Moment>| moment.map_or(0.0, |moment| moment.t as f64 / 1000.0);
    let (from, to) = (seconds(moments.first()), seconds(moments.last()));
    let plot = |top: f64, bottom: f64, most: f64| Plot {
        top,
        bottom,
        most,
        from,
        to,
    };
    let (distance, belief) = (plot(60.0, 260.0, 2.0), plot(300.0, 440.0, 1.0));
    let (decision, shield) = (plot(470.0, 490.0, 1.0), plot(510.0, 530.0, 1.0));
    let mut drawing = Group::new();
    for (value, name) in [
        (0.0, "0 m".to_owned()),
        (config.min_distance.into(), "d_min".to_owned()),
        (config.near_distance.into(), "d_n".to_owned()),
        (config.safe_distance.into(), "d_safe".to_owned()),
        (2.0, "2 m".to_owned()),
    ] {
        drawing = drawing.add(distance.level(value, &name));
    }
    for value in [0.0, 0.5, 1.0] {
        drawing = drawing.add(belief.level(value, &format!("p = {value}")));
    }
    for second in (from.ceil() as u64..=to as u64).filter(|second| second.is_multiple_of(5)) {
        let (x, y) = shield.at(second * 1000, 0.0);
        drawing = drawing
            .add(line((x, distance.top), (x, y), "#f1f3f5", 1.0))
            .add(text(x - 6.0, y + 16.0, 11.0, &format!("{second} s")));
    }
    let decided = |moment: &Moment| {
        let response = moment.verdict.response;
        let name = if moment.verdict.blind {
            "stop: no evidence".to_owned()
        } else {
            format!("{response:?}").to_lowercase()
        };
        Some((colour(response), name))
    };
    let held = |moment: &Moment| {
        moment
            .held
            .then(|| ("#d6336c", "held by the shield".to_owned()))
    };
    drawing = drawing
        .add(distance.dots(moments, |moment| moment.seen, SEEN))
        .add(distance.curve(
            moments,
            |moment| moment.verdict.distance.map(|distance| distance.get()),
            BELIEVED,
        ))
        .add(belief.dots(moments, |moment| moment.verdict.doubted, DOUBTED))
        .add(belief.curve(moments, |moment| moment.verdict.probability, BELIEVED))
        .add(decision.strip(moments, decided))
        .add(text(4.0, 484.0, 11.0, "decision"))
        .add(shield.strip(moments, held))
        .add(text(4.0, 524.0, 11.0, "shield"));
    let mut legend = Group::new();
    for (i, (fill, words)) in [
        (
            SEEN,
            "distance of the nearest echo ahead: what S1 alone goes by",
        ),
        (
            BELIEVED,
            "distance of the obstacle believed in, and its probability",
        ),
        (DOUBTED, "probability of an echo that is doubted"),
        (colour(Response::Continue), "continue"),
        (colour(Response::Maneuver), "maneuver"),
        (colour(Response::Stop), "stop"),
        ("#d6336c", "held by the shield, whatever is believed"),
    ]
    .into_iter()
    .enumerate()
    {
        let (x, y) = (LEFT + 380.0 * (i / 3) as f64, 566.0 + 18.0 * (i % 3) as f64);
        let mark = Rectangle::new().set("x", x).set("y", y - 9.0);
        legend = legend
            .add(mark.set("width", 12).set("height", 10).set("fill", fill))
            .add(text(x + 18.0, y, 12.0, words));
    }
    Document::new()
        .set("viewBox", (0.0, 0.0, LEFT + WIDTH + 20.0, 620.0))
        .set("width", LEFT + WIDTH + 20.0)
        .set("height", 620.0)
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(text(8.0, 22.0, 17.0, title).set("font-weight", "bold"))
        .add(text(
            8.0,
            44.0,
            13.0,
            "distance, belief and decision over time",
        ))
        .add(drawing)
        .add(legend)
        .to_string()
}

// --------------------------------------------------------------- the comparison

/// How near something real must be to where something is believed to be, m.
const THERE: f64 = 0.4;

/// A law, with a note of the obstacle that it was shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown<L> {
    law: L,
    obstacle: Option<Obstacle>,
}

impl<L> Shown<L> {
    const fn new(law: L) -> Self {
        Self {
            law,
            obstacle: None,
        }
    }
}

impl<L: Law<N>, const N: usize> Law<N> for Shown<L> {
    fn advise(&mut self, view: &View<N>) -> Advice {
        self.obstacle = view.obstacle;
        self.law.advise(view)
    }

    fn mode(&self) -> &'static str {
        self.law.mode()
    }
}

/// What is counted over many runs.
///
/// What the law does is *unnecessary* if nothing real is within 0.4 m of the obstacle that it is
/// shown; a stop of the shield, if nothing real is within 0.4 m of the range that its reason names, in
/// that sonar's cone, or of the view's obstacle where it names no sonar. The simulator knows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Count {
    /// Runs.
    pub runs: u32,
    /// Contacts while the robot moved: must be none.
    pub contacts: u32,
    /// Goals reached.
    pub arrived: u32,
    /// Time until then, or until the run was over, s.
    pub seconds: f64,
    /// Way of the robot, m.
    pub travelled: f64,
    /// Maneuvers that the law began.
    pub maneuvers: u32,
    /// Those that were unnecessary.
    pub unnecessary_maneuvers: u32,
    /// Radians by which the robot turned aside for nothing, driving or held by the shield.
    pub unnecessary_turn: f64,
    /// Stops that the decision began, where the shield had not begun one already.
    pub decided: u32,
    /// Those that were unnecessary.
    pub unnecessary_decided: u32,
    /// Attempts to get away that were begun, of a robot that had not moved for a while.
    pub escapes: u32,
    /// Stops that the shield began.
    pub shield: u32,
    /// Those that were unnecessary, by cause.
    pub unnecessary_shield: BTreeMap<&'static str, u32>,
    /// Ticks.
    pub ticks: u64,
    /// Ticks in which the shield held the robot.
    pub held: u64,
    /// Ticks with a person in the law's angle of view, nearer than `near_distance`, and the robot free
    /// to move.
    pub needed: u64,
    /// Those in which the law drove on as if there were nobody.
    pub unheeded: u64,
}

impl Count {
    /// Unnecessary maneuvers and stops of the law's own.
    #[must_use]
    pub const fn unnecessary_by_law(&self) -> u32 {
        self.unnecessary_maneuvers + self.unnecessary_decided
    }

    /// Unnecessary stops of the shield.
    #[must_use]
    pub fn unnecessary_by_shield(&self) -> u32 {
        self.unnecessary_shield.values().sum()
    }

    /// Unnecessary maneuvers and stops, whoever began them.
    #[must_use]
    pub fn unnecessary(&self) -> u32 {
        self.unnecessary_by_law() + self.unnecessary_by_shield()
    }

    /// Adds a run of `law` through `scenario`; `shown` says what obstacle it was shown.
    ///
    /// # Errors
    /// If the scenario makes no simulation, or its goal is out of range.
    pub fn add<L: Law<16>>(
        &mut self,
        scenario: &Scenario,
        config: &RobotConfig,
        law: L,
        shown: impl Fn(&L) -> Option<Obstacle>,
    ) -> Result<(), Box<dyn Error>> {
        let mut simulation = scenario.simulate()?;
        let mut pilot = Pilot::<L, 16>::with_law(
            law,
            *config,
            demo::goal_from_start(scenario),
            base_settings(config, false, None),
            Box::new(std::io::sink()),
        )?;
        let (mut now, mut ticks) = (0, 0);
        let mut before = Tick::default();
        while now < scenario.time_limit_ms && pilot.tally().arrived.is_none() {
            now += STEP_MS;
            simulation.advance_to(now);
            let bytes = simulation.robot_mut().transmit();
            if !bytes.is_empty() {
                pilot.receive(&bytes, now);
            }
            while let Some(output) = pilot.poll(now) {
                if let Output::Send(bytes) = output {
                    simulation.robot_mut().receive(&bytes);
                }
            }
            while pilot.next_event().is_some() {}
            if pilot.tally().ticks == ticks {
                continue;
            }
            ticks = pilot.tally().ticks;
            if let Some(Decision {
                mode,
                stop,
                view: Some(view),
                ..
            }) = pilot.latest()
            {
                let tick = Tick {
                    mode,
                    held: stop.is_some(),
                    heading: simulation.robot().base().pose().heading,
                };
                self.count(
                    &before,
                    &tick,
                    *stop,
                    view,
                    shown(pilot.law()),
                    &simulation,
                    config,
                );
                before = tick;
            }
        }
        let outcome = simulation.outcome();
        let (driving, turning) = (
            outcome.contacts_while_driving,
            outcome.contacts_while_turning,
        );
        self.runs += 1;
        self.contacts += driving.people + driving.obstacles + turning.people + turning.obstacles;
        self.arrived += u32::from(pilot.tally().arrived.is_some());
        self.seconds += now as f64 / 1000.0;
        self.travelled += outcome.travelled;
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "one tick from all sides")]
    fn count(
        &mut self,
        before: &Tick,
        tick: &Tick,
        stop: Option<StopReason>,
        view: &View<16>,
        shown: Option<Obstacle>,
        simulation: &Simulation,
        config: &RobotConfig,
    ) {
        let phantom = |obstacle: Option<Obstacle>| {
            obstacle.is_some_and(|obstacle| !is_real(&obstacle, view, simulation))
        };
        let begins = |mode: &str| tick.mode == mode && before.mode != mode;
        self.ticks += 1;
        self.held += u64::from(tick.held);
        if begins("maneuver") {
            self.maneuvers += 1;
            self.unnecessary_maneuvers += u32::from(phantom(shown));
        }
        if !tick.held && (begins("decided to stop") || begins("no evidence")) {
            self.decided += 1;
            self.unnecessary_decided += u32::from(phantom(shown));
        }
        self.escapes += u32::from(begins("escape"));
        if matches!(tick.mode, "maneuver" | "stop") && phantom(shown) {
            self.unnecessary_turn += wrap(tick.heading - before.heading).abs();
        }
        if let Some(reason) = stop.filter(|_| !before.held) {
            // Before the motors are on there is nothing to avoid.
            if !matches!(reason, StopReason::Starting | StopReason::MotorsDisabled) {
                self.shield += 1;
                let unnecessary = match reason {
                    StopReason::TooNear { sonar }
                    | StopReason::MinDistance { sonar, .. }
                    | StopReason::Clearance { sonar, .. } => {
                        !is_heard(sonar, view.hazard[sonar].range, simulation)
                    }
                    _ => phantom(view.obstacle),
                };
                if unnecessary {
                    let cause = reason.row().cause;
                    *self.unnecessary_shield.entry(cause).or_default() += 1;
                }
            }
        }
        if !tick.held && person_ahead(simulation, config) {
            self.needed += 1;
            self.unheeded += u64::from(tick.mode == "cruise");
        }
    }
}

/// What is compared from one tick to the next.
#[derive(Clone, Copy, Debug, Default)]
struct Tick {
    mode: &'static str,
    held: bool,
    /// The robot's true heading, rad.
    heading: f64,
}

/// Something real is where the obstacle is believed to be.
fn is_real(obstacle: &Obstacle, view: &View<16>, simulation: &Simulation) -> bool {
    let offset = view.pose.to_robot(obstacle.position);
    let place = Pose::new(offset.x.into(), offset.y.into(), 0.0);
    let place = simulation.robot().base().pose().compose(&place).position;
    let nearest = simulation.world().nearest(place);
    nearest.is_some_and(|nearest| nearest.distance <= THERE)
}

/// Something real is in the cone of a sonar, no farther away than `range` (mm) and a little.
fn is_heard(sonar: usize, range: i32, simulation: &Simulation) -> bool {
    let robot = simulation.robot();
    let Some(cone) = robot.ring().cone(sonar, &robot.base().pose()) else {
        return false;
    };
    let echo = simulation.world().nearest_in_cone(&cone);
    echo.is_some_and(|echo| echo.distance <= f64::from(range) / 1000.0 + THERE)
}

/// A person is within the law's angle of view, nearer to the robot's hull than `near_distance`.
fn person_ahead(simulation: &Simulation, config: &RobotConfig) -> bool {
    let pose = simulation.robot().base().pose();
    let reach = f64::from(config.core.near_distance + config.core.robot_radius);
    let half = f64::from(config.core.view_half_angle);
    simulation.world().people().iter().any(|person| {
        person.position().is_some_and(|place| {
            let offset = place - pose.position;
            let bearing = wrap(heading_of(&offset) - pose.heading);
            offset.norm() - person.radius() <= reach && bearing.abs() <= half
        })
    })
}

/// S1 alone and S1 with S2, on the same seeds. The config's `appear_samples` is not looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// S1 alone.
    pub alone: Count,
    /// S1 with S2's decision.
    pub decided: Count,
    /// The same where what appears has to be heard twice: `appear_samples` is 2.
    pub heard_twice: Count,
}

/// Runs `seeds` seeds of a scenario with each.
///
/// # Errors
/// If the scenario is unknown or something is out of range.
pub fn compare(
    scenario: &str,
    seeds: u64,
    knobs: &Knobs,
    config: &RobotConfig,
    mut progress: impl FnMut(u64),
) -> Result<Comparison, Box<dyn Error>> {
    let ring = base::ring::<16>(config)?;
    let settings = settings(config)?;
    let [once, twice] = [1.0, 2.0].map(|appear_samples| {
        let parameters = *config.core.parameters();
        let core = Config::new(Parameters {
            appear_samples,
            ..parameters
        })?;
        Ok::<_, OutOfRange>(RobotConfig { core, ..*config })
    });
    let (once, twice) = (once?, twice?);
    let core = once.core;
    let mut comparison = Comparison::default();
    for seed in 0..seeds {
        let scenario = Scenario::named(scenario, &Knobs { seed, ..*knobs })?
            .randomised(seed, core.obstacle_speed_max.into())?;
        let avoid = Shown::new(Avoid::new(core));
        let alone = Escape::new(avoid, core, ring);
        let shown = |law: &Escape<Shown<Avoid>, 16>| law.law().obstacle;
        comparison.alone.add(&scenario, &once, alone, shown)?;
        let decide = Decide::new(avoid, core, ring, settings);
        let decided = Escape::new(decide, core, ring);
        let shown = |law: &Escape<Decide<Shown<Avoid>, 16>, 16>| law.law().law().obstacle;
        comparison.decided.add(&scenario, &once, decided, shown)?;
        let counted = &mut comparison.heard_twice;
        counted.add(&scenario, &twice, decided, shown)?;
        progress(seed + 1);
    }
    Ok(comparison)
}

impl Comparison {
    /// The comparison as a table.
    #[must_use]
    pub fn table(&self) -> String {
        let columns = [&self.alone, &self.decided, &self.heard_twice];
        let mut table = format!("{:<58} {:>10} {:>10} {:>10}\n", "", "S1", "S1+S2", "twice");
        let mut row = |name: &str, value: &dyn Fn(&Count) -> String| {
            let [one, two, three] = columns.map(value);
            let _ = writeln!(table, "{name:<58} {one:>10} {two:>10} {three:>10}");
        };
        let each = |sum: f64, count: &Count| format!("{:.2}", sum / f64::from(count.runs.max(1)));
        let percent =
            |part: u64, of: u64| format!("{:.1} %", 100.0 * part as f64 / of.max(1) as f64);
        row("runs", &|c| c.runs.to_string());
        row("contacts while moving", &|c| c.contacts.to_string());
        row("goals reached", &|c| c.arrived.to_string());
        row("seconds per run", &|c| each(c.seconds, c));
        row("metres per run", &|c| each(c.travelled, c));
        row("by the law: maneuvers begun", &|c| c.maneuvers.to_string());
        row("  unnecessary", &|c| c.unnecessary_maneuvers.to_string());
        row("by the law: stops decided", &|c| c.decided.to_string());
        row("  unnecessary", &|c| c.unnecessary_decided.to_string());
        row("by the law: unnecessary, both", &|c| {
            c.unnecessary_by_law().to_string()
        });
        row("  radians turned aside for nothing, per run", &|c| {
            each(c.unnecessary_turn, c)
        });
        row("  somebody near ahead, and driven on: ticks", &|c| {
            percent(c.unheeded, c.needed)
        });
        row("attempts to get away", &|c| c.escapes.to_string());
        row("by the shield: stops begun", &|c| c.shield.to_string());
        row("  unnecessary", &|c| c.unnecessary_by_shield().to_string());
        let causes: BTreeSet<&str> = columns
            .iter()
            .flat_map(|count| count.unnecessary_shield.keys().copied())
            .collect();
        for cause in causes {
            row(&format!("    {cause}"), &|c| {
                c.unnecessary_shield.get(cause).unwrap_or(&0).to_string()
            });
        }
        row("unnecessary altogether", &|c| c.unnecessary().to_string());
        row("ticks in which the shield holds the robot", &|c| {
            percent(c.held, c.ticks)
        });
        table
    }
}
