//! Gestures shown: a stream of skeletons recognised, and a meeting seen through skeletons, drawn.

use crate::announce::Announcer;
use crate::config::RobotConfig;
use crate::demo::{Options, run_folder};
use crate::drive::{Clock, Signals};
use crate::encounter::{self, Camera, Cue, Encounter, Happening, Met, Showing};
use crate::skeletons::{self, CameraClock};
use serde_json::{Value, json};
use sidestep::gesture::{
    Frame, Gesture, Model, PEOPLE_MAX, Person, Recognizer, Rejection, Settings, Skeleton,
};
use sidestep::interact::{Event, People, USUAL};
use sidestep_sim::geometry::Pose;
use sidestep_sim::skeleton::{CameraErrors, SkeletonCamera};
use sidestep_sim::world::World;
use std::error::Error;
use std::fs;
use std::io::Write;
use std::sync::atomic::Ordering;
use std::time::Duration;
use svg::Document;
use svg::node::element::{Circle, Group, Line, Polyline, Rectangle, Text};

/// Recognises gestures in frames and writes what changes as lines of JSON:
///
/// `{"t":1200,"id":7,"pose":"stop","gesture":"stop"}`: `pose` is what this frame shows, `gesture` what
/// counts; instead of a pose there is why none was recognised, `"rejected":"…"`. Whoever is seen no
/// more is `{"t":…,"id":…,"gone":true}`. A bad line is `{"error":"…"}`. A frame that took longer to
/// arrive than frames may be apart is `{"t":…,"late":…}`, in ms, and the first that is not
/// `{"t":…,"late":0}`. `now` gives the time of arrival, ms.
///
/// # Errors
/// If a setting is out of range, or nothing can be written.
pub fn watch(
    frames: impl Iterator<Item = Result<Frame, String>>,
    model: Model,
    settings: Settings,
    mut now: impl FnMut() -> u64,
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let mut clock = CameraClock::default();
    let mut late = false;
    let mut recognizer = Recognizer::new(model, settings)?;
    let mut known: Vec<(u64, Value)> = Vec::new();
    for frame in frames {
        let frame = match frame {
            Ok(frame) => frame,
            Err(error) => {
                writeln!(out, "{}", json!({"error": error}))?;
                continue;
            }
        };
        let t = frame.taken_at.0;
        let arrived = now();
        let age = arrived.saturating_sub(clock.taken(frame.taken_at, arrived).0);
        if (age > settings.frame_age_max) != late {
            late = !late;
            let age = if late { age } else { 0 };
            writeln!(out, "{}", json!({"t": t, "late": age}))?;
        }
        let mut seen = Vec::new();
        for person in recognizer.update(&frame).iter().flatten() {
            let shown = told(person);
            if !known.contains(&(person.id, shown.clone())) {
                let mut line = json!({"t": t, "id": person.id});
                if let (Some(line), Some(shown)) = (line.as_object_mut(), shown.as_object()) {
                    line.extend(shown.clone());
                }
                writeln!(out, "{line}")?;
            }
            seen.push((person.id, shown));
        }
        for (id, _) in &known {
            if !seen.iter().any(|(other, _)| other == id) {
                writeln!(out, "{}", json!({"t": t, "id": id, "gone": true}))?;
            }
        }
        known = seen;
        out.flush()?;
    }
    Ok(())
}

/// What is told of a person.
fn told(person: &Person) -> Value {
    let gesture = person.gesture.map(Gesture::name);
    match &person.pose {
        Ok(pose) => json!({"pose": pose.name(), "gesture": gesture}),
        // The number that is out of range differs from frame to frame: it is not news.
        Err(Rejection::OutOfRange(error)) => {
            json!({"rejected": format!("{} is out of range", error.field), "gesture": gesture})
        }
        Err(rejection) => json!({"rejected": rejection.to_string(), "gesture": gesture}),
    }
}

/// A frame as it was understood.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// When it was taken, ms.
    pub t: u64,
    /// The person watched.
    pub skeleton: Option<Skeleton>,
    /// What was made of it.
    pub person: Option<Person>,
    /// What the person showed, or began to.
    pub shown: Option<Gesture>,
}

/// Time between two frames of the simulated camera, ms.
const FRAME_MS: u64 = 30;

/// A camera that gives skeletons, and what recognises gestures in them.
pub struct Watcher {
    camera: SkeletonCamera,
    recognizer: Recognizer,
    /// Frames so far, as the camera gave them.
    pub frames: Vec<Frame>,
    /// Frames so far, as understood of the first person of the world.
    pub looks: Vec<Look>,
    /// What the first person shows.
    shown: Option<Gesture>,
}

impl Watcher {
    /// Thirty frames a second, with the errors of a depth camera.
    ///
    /// # Errors
    /// If a parameter is out of range.
    pub fn new(
        parameters: sidestep_sim::depth_camera::Parameters,
        model: Model,
        seed: u64,
    ) -> Result<Self, Box<dyn Error>> {
        let parameters = sidestep_sim::depth_camera::Parameters {
            period_ms: FRAME_MS,
            // Of whole people; joints get lost besides.
            dropout: 0.005,
            ..parameters
        };
        Ok(Self {
            camera: SkeletonCamera::new(parameters, CameraErrors::default(), seed)?,
            recognizer: Recognizer::new(model, Settings::default())?,
            frames: Vec::new(),
            looks: Vec::new(),
            shown: None,
        })
    }
}

impl Camera for Watcher {
    fn look(
        &mut self,
        now_ms: u64,
        world: &World,
        pose: &Pose,
        shows: &dyn Fn(usize) -> Option<Gesture>,
    ) {
        self.shown = shows(0);
        self.camera.look(now_ms, world, pose, shows);
    }

    fn arrival(&mut self, now_ms: u64) -> Option<People> {
        let frame = self.camera.arrival(now_ms)?;
        let seen = self.recognizer.update(&frame);
        let first = self.camera.number_of(0);
        let place = (0..PEOPLE_MAX).find(|i| frame.people[*i].map(|person| person.id) == first);
        self.looks.push(Look {
            t: frame.taken_at.0,
            skeleton: place.and_then(|i| frame.people[i]),
            person: place.and_then(|i| seen[i]),
            shown: self.shown,
        });
        self.frames.push(frame);
        let gestures = seen.map(|person| person.and_then(|person| person.gesture));
        Some(People::of(&frame, &gestures))
    }
}

/// S3's Figure 8 with a stop in it: somebody makes themselves master, leads the robot forward, stops
/// it, leads it on, and sends it past on one side.
///
/// # Errors
/// If a parameter is out of range.
pub fn story(seed: u64) -> Result<Encounter, Box<dyn Error>> {
    let mut story = encounter::story("fig8", seed)?;
    let shows = |from, lasts, gesture| Showing {
        person: 0,
        cue: Cue::Asked(1, from),
        lasts,
        gesture,
    };
    story.showings = vec![
        shows(1_500, 2_500, Gesture::MasterSelect),
        shows(4_500, 5_000, Gesture::Forward),
        shows(9_600, 2_500, Gesture::Stop),
        shows(12_600, 8_000, Gesture::Forward),
        // The robot goes to its right, which is the left of whoever faces it.
        shows(21_500, 4_000, Gesture::Left),
    ];
    story.scenario.name = "gesture";
    story.scenario.description =
        "S3 Fig. 8: somebody becomes master, leads the robot forward, stops it, and sends it past"
            .to_owned();
    Ok(story)
}

/// Plays a story through skeletons and gestures.
///
/// # Errors
/// If a parameter is out of range.
pub fn play(
    story: &Encounter,
    config: &RobotConfig,
    model: Model,
) -> Result<(Met, Watcher), Box<dyn Error>> {
    let mut watcher = Watcher::new(story.camera, model, story.scenario.seed)?;
    let met = encounter::run_with(story, config, USUAL, &mut watcher, None)?;
    Ok((met, watcher))
}

/// The frames as lines of JSON; see [`skeletons`].
///
/// # Errors
/// If a coordinate is not finite.
pub fn lines(frames: &[Frame]) -> Result<String, String> {
    frames
        .iter()
        .map(|frame| skeletons::to_line(frame).map(|line| line + "\n"))
        .collect()
}

/// What the demonstration is called.
pub const DEMO: &str = "gesture";

/// Plays the story of [`story`], tells what happens as it does, speaks what the robot says, and
/// leaves a folder with `gestures.svg` (skeletons over time, and what the robot did), `picture.svg`
/// (where everybody went) and `skeletons.jsonl` (what the camera saw, for `sidestep gestures`).
///
/// # Errors
/// If a parameter is out of range, nothing can be written, or the robot touched somebody while it
/// moved.
pub fn demo(
    options: &Options,
    speech: Option<&str>,
    signals: &Signals,
) -> Result<(), Box<dyn Error>> {
    let story = story(options.knobs.seed)?;
    let (met, watcher) = play(&story, &options.config, Model::default())?;
    let folder = run_folder(&options.out, story.scenario.name)?;
    fs::write(folder.join("gestures.svg"), draw(&met, &watcher.looks))?;
    fs::write(folder.join("picture.svg"), met.picture())?;
    fs::write(folder.join("skeletons.jsonl"), lines(&watcher.frames)?)?;
    println!("== {}: {}", story.scenario.name, story.scenario.description);

    let mut announcer = Announcer::new(speech);
    let clock = Clock::new(options.speed);
    let mut happenings = tellings(&met, &watcher.looks).into_iter().peekable();
    while let Some((t, telling)) = happenings.peek() {
        let beep = if clock.now() < *t {
            std::thread::sleep(Duration::from_millis(10));
            announcer.poll()
        } else {
            println!("{:8.1} s  {}", *t as f64 / 1000.0, telling.text());
            let beep = match telling {
                Telling::Robot(Happening {
                    event: Event::Say(announcement),
                    ..
                }) => announcer.say(*announcement, *t, &mut std::io::stdout()),
                _ => None,
            };
            happenings.next();
            beep
        };
        if beep.is_some() {
            println!("            the base beeps");
        }
        if signals.interrupted.load(Ordering::Relaxed) {
            break;
        }
    }
    let moving = met.report.contacts.len();
    println!(
        "{}; {moving} contacts while moving; {} frames\npicture: {}",
        if met.report.arrived {
            "arrived"
        } else {
            "did not arrive"
        },
        watcher.frames.len(),
        folder.join("gestures.svg").display()
    );
    if moving > 0 {
        return Err(format!("the robot touched somebody {moving} times while it moved").into());
    }
    Ok(())
}

/// Something to tell.
enum Telling {
    Robot(Happening),
    /// A gesture begins to count, or none does any more.
    Person(Option<Gesture>),
}

impl Telling {
    fn text(&self) -> String {
        match self {
            Self::Robot(happening) => format!("robot   {}", happening.text()),
            Self::Person(Some(gesture)) => format!("person  {gesture}"),
            Self::Person(None) => "person  no gesture".to_owned(),
        }
    }
}

/// What happened, in order.
fn tellings(met: &Met, looks: &[Look]) -> Vec<(u64, Telling)> {
    let mut all: Vec<(u64, Telling)> = met
        .happenings
        .iter()
        .map(|happening| (happening.t, Telling::Robot(happening.clone())))
        .collect();
    let mut last = None;
    for look in looks {
        let counts = look.person.and_then(|person| person.gesture);
        if counts != last {
            all.push((look.t, Telling::Person(counts)));
            last = counts;
        }
    }
    all.sort_by_key(|(t, _)| *t);
    all
}

const WIDTH: f64 = 1120.0;
const MARGIN: f64 = 120.0;
const CELL: f64 = 140.0;
/// Cells in a row, and the pixels of a metre in them.
const CELLS: usize = 8;
const METRE: f64 = 62.0;
const LANE: f64 = 26.0;
const COUNTS: &str = "#2b8a3e";
const PENDING: &str = "#e8590c";
const REJECTED: &str = "#adb5bd";
const INK: &str = "#343a40";

fn text(x: f64, y: f64, size: f64, content: &str) -> Text {
    Text::new(content)
        .set("x", x)
        .set("y", y)
        .set("font-size", size)
        .set("font-family", "sans-serif")
        .set("fill", INK)
}

/// A colour for each gesture.
const fn colour(gesture: Gesture) -> &'static str {
    match gesture {
        Gesture::Rest => "#dee2e6",
        Gesture::Stop => "#e03131",
        Gesture::Right => "#1971c2",
        Gesture::Left => "#0c8599",
        Gesture::Forward => "#2f9e44",
        Gesture::Backward => "#f08c00",
        Gesture::MasterSelect => "#9c36b5",
    }
}

/// Frames worth a picture: a second's rest at the beginning, and each moment in which what counts
/// changes, with one a little later while it lasts.
fn chosen(looks: &[Look]) -> Vec<&Look> {
    let counts = |look: &Look| look.person.and_then(|person| person.gesture);
    let mut chosen: Vec<&Look> = Vec::new();
    let mut last: Option<Gesture> = None;
    let mut candidates = looks.iter().filter(|look| look.skeleton.is_some());
    chosen.extend(candidates.next());
    for look in looks.iter().filter(|look| look.skeleton.is_some()) {
        let now = counts(look);
        if now.is_some() && now != last {
            chosen.push(look);
            last = now;
        }
    }
    chosen
}

/// A stick figure with its head up, seen by the camera, about the neck.
fn figure(skeleton: &Skeleton, ink: &str) -> Group {
    let mut group = Group::new();
    let Some(neck) = skeleton.neck else {
        return group;
    };
    // The camera's left is on the left of its picture.
    let at = |joint: nalgebra::Vector3<f32>| {
        (
            -f64::from(joint.x - neck.x) * METRE,
            -f64::from(joint.y - neck.y) * METRE,
        )
    };
    let bone = |from, to| {
        let ((x1, y1), (x2, y2)) = (from, to);
        Line::new()
            .set("x1", x1)
            .set("y1", y1)
            .set("x2", x2)
            .set("y2", y2)
            .set("stroke", ink)
            .set("stroke-width", 4)
            .set("stroke-linecap", "round")
    };
    let head: f64 = 0.17 * METRE;
    group = group
        .add(
            Circle::new()
                .set("cx", 0)
                .set("cy", -head - 2.0)
                .set("r", head)
                .set("fill", "none")
                .set("stroke", ink)
                .set("stroke-width", 3),
        )
        .add(bone((0.0, 0.0), (0.0, 0.55 * METRE)));
    for arm in [
        [
            skeleton.left_shoulder,
            skeleton.left_elbow,
            skeleton.left_wrist,
        ],
        [
            skeleton.right_shoulder,
            skeleton.right_elbow,
            skeleton.right_wrist,
        ],
    ] {
        let points: Vec<(f64, f64)> = arm.into_iter().flatten().map(at).collect();
        if let Some(shoulder) = points.first() {
            group = group.add(bone((0.0, 0.0), *shoulder));
        }
        for pair in points.windows(2) {
            group = group.add(bone(pair[0], pair[1]));
        }
    }
    group
}

/// Draws skeletons as they were understood, over time, above what the robot did.
#[must_use]
pub fn draw(met: &Met, looks: &[Look]) -> String {
    let chosen = chosen(looks);
    let rows = chosen.len().div_ceil(CELLS);
    let strip = rows as f64 * 175.0;
    let end = met
        .simulation
        .trace()
        .last()
        .map_or(1, |sample| sample.time_ms)
        .max(1) as f64;
    let x = |t: u64| MARGIN + (WIDTH - MARGIN - 20.0) * t as f64 / end;
    let top = 50.0 + strip;
    let height = top + 6.0 * LANE + 130.0;
    let mut document = Document::new()
        .set("viewBox", (0.0, 0.0, WIDTH, height))
        .set("width", WIDTH)
        .set("height", height)
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(
            text(
                8.0,
                24.0,
                17.0,
                &format!("{}: {}", met.scenario.name, met.scenario.description),
            )
            .set("font-weight", "bold"),
        );

    for (i, look) in chosen.iter().enumerate() {
        let left = (i % CELLS) as f64 * CELL;
        let upper = 40.0 + (i / CELLS) as f64 * 175.0;
        let counting = look.person.and_then(|person| person.gesture);
        let (ink, words) = match (counting, look.person.map(|person| person.pose)) {
            (Some(gesture), _) => (COUNTS, gesture.to_string()),
            (None, Some(Ok(pose))) => (PENDING, format!("({pose})")),
            (None, Some(Err(rejection))) => (REJECTED, rejection.to_string()),
            (None, None) => (REJECTED, "not seen".to_owned()),
        };
        if let Some(skeleton) = &look.skeleton {
            document = document.add(figure(skeleton, ink).set(
                "transform",
                format!("translate({},{})", left + CELL / 2.0, upper + 70.0),
            ));
        }
        document = document
            .add(text(left + 18.0, upper + 140.0, 12.0, &words).set("font-weight", "bold"))
            .add(text(
                left + 18.0,
                upper + 155.0,
                11.0,
                &format!("{:.1} s", look.t as f64 / 1000.0),
            ));
    }

    let lane = |number: f64| top + number * LANE;
    let bar = |number: f64, from: u64, to: u64, fill: &str| {
        Rectangle::new()
            .set("x", x(from))
            .set("y", lane(number))
            .set("width", (x(to) - x(from)).max(0.6))
            .set("height", LANE - 6.0)
            .set("fill", fill)
    };
    for (number, name) in ["shown", "recognised", "counts", "robot"]
        .iter()
        .enumerate()
    {
        document = document.add(text(8.0, lane(number as f64) + 15.0, 13.0, name));
    }
    let lanes: [fn(&Look) -> Option<Gesture>; 3] = [
        |look| Some(look.shown.unwrap_or(Gesture::Rest)),
        |look| look.person.and_then(|person| person.pose.ok()),
        |look| look.person.and_then(|person| person.gesture),
    ];
    for (number, of) in lanes.into_iter().enumerate() {
        for run in looks.chunk_by(|one, other| of(one) == of(other)) {
            if let (Some(first), Some(last)) = (run.first(), run.last())
                && let Some(gesture) = of(first)
            {
                let end = last.t + FRAME_MS;
                document = document.add(bar(number as f64, first.t, end, colour(gesture)));
            }
        }
    }
    // What the robot was about, from one change to the next.
    let states: Vec<(u64, &str)> = met
        .happenings
        .iter()
        .filter_map(|happening| match &happening.event {
            Event::Entered(state) => Some((happening.t, state.name())),
            _ => None,
        })
        .collect();
    for (i, (from, name)) in states.iter().enumerate() {
        let to = states.get(i + 1).map_or(end as u64, |next| next.0);
        let fill = if i % 2 == 0 { "#e7f5ff" } else { "#d0ebff" };
        document = document.add(bar(3.0, *from, to, fill));
        if x(to) - x(*from) > 7.0 * name.len() as f64 {
            document = document.add(text(x(*from) + 3.0, lane(3.0) + 15.0, 11.0, name));
        }
    }
    let mut said = 0;
    for happening in &met.happenings {
        if let Event::Say(announcement) = happening.event {
            // Words that follow closely stand one below the other.
            let below = 12.0 * f64::from(said % 3);
            said += 1;
            document = document
                .add(
                    Line::new()
                        .set("x1", x(happening.t))
                        .set("x2", x(happening.t))
                        .set("y1", lane(3.0))
                        .set("y2", lane(4.0) + 8.0 + below)
                        .set("stroke", INK),
                )
                .add(text(
                    x(happening.t) + 3.0,
                    lane(4.0) + 10.0 + below,
                    10.0,
                    &format!("“{}”", announcement.text()),
                ));
        }
    }
    document = document.add(speeds(met, &x, lane(6.0)));
    for second in (0..=(end as u64 / 1000)).step_by(5) {
        document = document.add(text(
            x(second * 1000) - 4.0,
            lane(6.0) + 85.0,
            11.0,
            &format!("{second} s"),
        ));
    }
    let mut left = MARGIN;
    for gesture in Gesture::ALL {
        document = document
            .add(
                Rectangle::new()
                    .set("x", left)
                    .set("y", lane(6.0) + 100.0)
                    .set("width", 14)
                    .set("height", 14)
                    .set("fill", colour(gesture)),
            )
            .add(text(left + 18.0, lane(6.0) + 112.0, 12.0, gesture.name()));
        left += 120.0;
    }
    document
        .add(text(left, lane(6.0) + 112.0, 12.0, "white: none"))
        .to_string()
}

/// The robot's forward speed over time, in a box whose height is 0.4 m/s.
fn speeds(met: &Met, x: &dyn Fn(u64) -> f64, top: f64) -> Group {
    const HEIGHT: f64 = 70.0;
    const FULL: f64 = 0.4;
    let points: Vec<String> = met
        .simulation
        .trace()
        .iter()
        .map(|sample| {
            let share = (sample.speed / FULL).clamp(-0.2, 1.0);
            format!(
                "{:.1},{:.1}",
                x(sample.time_ms),
                top + HEIGHT * (1.0 - share)
            )
        })
        .collect();
    Group::new()
        .add(text(8.0, top + 14.0, 13.0, "robot's speed"))
        .add(text(8.0, top + 30.0, 11.0, "0 to 0.4 m/s"))
        .add(
            Line::new()
                .set("x1", MARGIN)
                .set("x2", WIDTH - 20.0)
                .set("y1", top + HEIGHT)
                .set("y2", top + HEIGHT)
                .set("stroke", REJECTED),
        )
        .add(
            Polyline::new()
                .set("points", points.join(" "))
                .set("fill", "none")
                .set("stroke", "#1f5fbf")
                .set("stroke-width", 1.5),
        )
}
