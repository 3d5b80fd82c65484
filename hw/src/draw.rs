//! A run as a picture: robot, people, walls, and every stop with its reason.

use sidestep_sim::geometry::{Point, Pose, Vector};
use sidestep_sim::simulation::Sample;
use sidestep_sim::world::{Shape, World};
use std::collections::BTreeMap;
use svg::Document;
use svg::node::element::{Circle, Group, Line, Polygon, Polyline, Rectangle, Text, Title};

/// A stop to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// When it began, ms.
    pub t: u64,
    /// Why.
    pub reason: String,
}

/// What a picture shows.
pub struct Picture<'a> {
    /// Above the picture.
    pub title: &'a str,
    /// Under the title, a line each.
    pub notes: &'a [String],
    /// The world.
    pub world: &'a World,
    /// Where everyone was.
    pub trace: &'a [Sample],
    /// The goal.
    pub goal: Point,
    /// Radius of the robot, m.
    pub robot_radius: f64,
    /// Stops in order.
    pub stops: &'a [Stop],
}

/// What a picture shows besides, of a planned way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan<'a> {
    /// The corners of the way.
    pub way: &'a [Point],
    /// Places with a word to each.
    pub marks: &'a [(Point, String)],
}

/// Pixels per metre.
const SCALE: f64 = 110.0;
/// Everyone is drawn as a disc this often, ms.
const INTERVAL: u64 = 3000;
const ROBOT: &str = "#1f5fbf";
const PERSON: &str = "#2b8a3e";
const STOP: &str = "#d6336c";
const EVENT: &str = "#7048e8";
const WALL: &str = "#495057";
const PLAN: &str = "#e8590c";

pub(crate) fn text(x: f64, y: f64, size: f64, content: &str) -> Text {
    Text::new(content)
        .set("x", round(x))
        .set("y", round(y))
        .set("font-size", size)
        .set("font-family", "sans-serif")
}

pub(crate) fn round(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

/// Draws the picture as SVG.
#[must_use]
pub fn draw(picture: &Picture) -> String {
    compose(picture, &Plan::default(), &[])
}

/// Draws the picture and a plan as SVG.
#[must_use]
pub fn draw_planned(picture: &Picture, plan: &Plan) -> String {
    compose(picture, plan, &[])
}

/// Draws the picture as SVG, with what was said and done marked where the robot was, and listed.
#[must_use]
pub fn draw_with_events(picture: &Picture, events: &[Stop]) -> String {
    compose(picture, &Plan::default(), events)
}

fn compose(picture: &Picture, plan: &Plan, events: &[Stop]) -> String {
    // What is to be seen: the robot's way, the goal, and some room around.
    let mut low = picture.goal;
    let mut high = picture.goal;
    for place in picture.trace.iter().map(|sample| &sample.pose.position) {
        low = low.inf(place);
        high = high.sup(place);
    }
    for corner in plan.way {
        low = low.inf(corner);
        high = high.sup(corner);
    }
    let margin = Vector::new(1.6, 1.6);
    let (low, high) = (low - margin, high + margin);
    let header = 34.0 + 18.0 * picture.notes.len() as f64;
    let rows = picture.stops.len() + events.len() + usize::from(!events.is_empty());
    let legend = 22.0 + 16.0 * rows as f64;
    let width = ((high.x - low.x) * SCALE).max(640.0);
    let height = (high.y - low.y) * SCALE;
    let at = |p: Point| {
        (
            round((p.x - low.x) * SCALE),
            round(header + (high.y - p.y) * SCALE),
        )
    };

    let mut scene = Group::new();
    for shape in picture.world.obstacles() {
        scene = scene.add(obstacle(shape, &at));
    }
    scene = metres(scene, low, high, &at);
    scene = scene.add(planned(plan, &at));

    let mut ways: BTreeMap<usize, Vec<(u64, Point)>> = BTreeMap::new();
    for sample in picture.trace {
        for (person, position) in &sample.people {
            ways.entry(*person)
                .or_default()
                .push((sample.time_ms, *position));
        }
    }
    for (person, way) in &ways {
        let radius = picture
            .world
            .people()
            .get(*person)
            .map_or(0.25, |person| person.radius());
        scene = scene.add(walk(way, radius, PERSON, &at));
    }
    let way: Vec<(u64, Point)> = picture
        .trace
        .iter()
        .map(|sample| (sample.time_ms, sample.pose.position))
        .collect();
    scene = scene.add(walk(&way, picture.robot_radius, ROBOT, &at));
    let (x, y) = at(picture.goal);
    scene = scene
        .add(cross(x, y, 9.0, "#e8590c"))
        .add(text(x + 12.0, y + 4.0, 13.0, "goal"));

    let first = if picture.stops.is_empty() {
        "no stops"
    } else {
        "stops, in order:"
    };
    let mut list = Group::new().add(text(8.0, header + height + 16.0, 13.0, first));
    let mut row = header + height + 18.0;
    let stops = picture.stops.iter().map(|stop| (stop, STOP));
    let events = events.iter().map(|event| (event, EVENT));
    let (mut number, mut kind) = (0, STOP);
    for (mark, colour) in stops.chain(events) {
        row += 16.0;
        if kind != colour {
            (number, kind) = (0, colour);
            list = list.add(text(8.0, row, 13.0, "said and done, in order:"));
            row += 16.0;
        }
        number += 1;
        let here = way
            .iter()
            .min_by_key(|(t, _)| t.abs_diff(mark.t))
            .map_or(picture.goal, |(_, position)| *position);
        let (x, y) = at(here);
        // Stops above the way, the rest below it.
        let beside = if colour == STOP { -6.0 } else { 14.0 };
        let seconds = mark.t as f64 / 1000.0;
        let line = format!("{number}. {seconds:.1} s: {}", mark.reason);
        let label = text(x + 6.0, y + beside, 11.0, &number.to_string());
        scene = scene.add(
            Group::new()
                .add(Title::new(line.clone()))
                .add(cross(x, y, 5.0, colour))
                .add(label.set("fill", colour)),
        );
        list = list.add(text(16.0, row, 12.0, &line).set("fill", colour));
    }

    let mut document = Document::new()
        .set(
            "viewBox",
            (0.0, 0.0, round(width), round(header + height + legend)),
        )
        .set("width", round(width))
        .set("height", round(header + height + legend))
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(text(8.0, 22.0, 17.0, picture.title).set("font-weight", "bold"));
    for (i, note) in picture.notes.iter().enumerate() {
        document = document.add(text(8.0, 42.0 + 18.0 * i as f64, 13.0, note));
    }
    document.add(scene).add(list).to_string()
}

pub(crate) fn cross(x: f64, y: f64, size: f64, colour: &str) -> Group {
    let stroke = |x1: f64, y1: f64, x2: f64, y2: f64| {
        Line::new()
            .set("x1", x + x1)
            .set("y1", y + y1)
            .set("x2", x + x2)
            .set("y2", y + y2)
            .set("stroke", colour)
            .set("stroke-width", 2)
    };
    Group::new()
        .add(stroke(-size, -size, size, size))
        .add(stroke(-size, size, size, -size))
}

fn obstacle(shape: &Shape, at: &dyn Fn(Point) -> (f64, f64)) -> Group {
    let polygon = |corners: &[Point]| {
        let points: Vec<String> = corners
            .iter()
            .map(|corner| {
                let (x, y) = at(*corner);
                format!("{x},{y}")
            })
            .collect();
        Polygon::new()
            .set("points", points.join(" "))
            .set("fill", "#ced4da")
            .set("stroke", WALL)
            .set("stroke-width", 3)
    };
    match *shape {
        Shape::Wall { from, to } => Group::new().add(polygon(&[from, to])),
        Shape::Box {
            pose,
            length,
            width,
        } => {
            let corners = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)];
            let corners = corners.map(|(x, y)| {
                pose.compose(&Pose::new(x * length, y * width, 0.0))
                    .position
            });
            Group::new().add(polygon(&corners))
        }
        Shape::Disc { centre, radius } => {
            let (x, y) = at(centre);
            Group::new().add(
                Circle::new()
                    .set("cx", x)
                    .set("cy", y)
                    .set("r", round(radius * SCALE))
                    .set("fill", "#ced4da")
                    .set("stroke", WALL),
            )
        }
    }
}

/// A planned way, dashed, and the marks.
fn planned(plan: &Plan, at: &dyn Fn(Point) -> (f64, f64)) -> Group {
    let mut group = Group::new();
    for pair in plan.way.windows(2) {
        let ((x1, y1), (x2, y2)) = (at(pair[0]), at(pair[1]));
        group = group.add(
            Line::new()
                .set("x1", x1)
                .set("y1", y1)
                .set("x2", x2)
                .set("y2", y2)
                .set("stroke", PLAN)
                .set("stroke-width", 1.5)
                .set("stroke-dasharray", "7 5"),
        );
    }
    for (place, word) in plan.marks {
        let (x, y) = at(*place);
        group = group
            .add(
                Circle::new()
                    .set("cx", x)
                    .set("cy", y)
                    .set("r", 4)
                    .set("fill", PLAN),
            )
            .add(text(x + 6.0, y + 14.0, 10.0, word).set("fill", PLAN));
    }
    group
}

/// A grid of metres, faint.
fn metres(mut scene: Group, low: Point, high: Point, at: &dyn Fn(Point) -> (f64, f64)) -> Group {
    let line = |from: Point, to: Point| {
        let ((x1, y1), (x2, y2)) = (at(from), at(to));
        Line::new()
            .set("x1", x1)
            .set("y1", y1)
            .set("x2", x2)
            .set("y2", y2)
            .set("stroke", "#dee2e6")
            .set("stroke-width", 0.6)
    };
    for i in low.x.ceil() as i64..=high.x.floor() as i64 {
        let x = i as f64;
        scene = scene.add(line(Point::new(x, low.y), Point::new(x, high.y)));
    }
    for i in low.y.ceil() as i64..=high.y.floor() as i64 {
        let y = i as f64;
        scene = scene.add(line(Point::new(low.x, y), Point::new(high.x, y)));
    }
    scene
}

/// Someone's way, with a disc and the time in seconds now and then.
fn walk(
    way: &[(u64, Point)],
    radius: f64,
    colour: &str,
    at: &dyn Fn(Point) -> (f64, f64),
) -> Group {
    let points: Vec<String> = way
        .iter()
        .map(|(_, position)| {
            let (x, y) = at(*position);
            format!("{x},{y}")
        })
        .collect();
    let mut group = Group::new().add(
        Polyline::new()
            .set("points", points.join(" "))
            .set("fill", "none")
            .set("stroke", colour)
            .set("stroke-width", 2),
    );
    for (t, position) in way.iter().filter(|(t, _)| t % INTERVAL == 0) {
        let (x, y) = at(*position);
        group = group
            .add(
                Circle::new()
                    .set("cx", x)
                    .set("cy", y)
                    .set("r", round(radius * SCALE))
                    .set("fill", colour)
                    .set("fill-opacity", 0.08)
                    .set("stroke", colour)
                    .set("stroke-opacity", 0.5),
            )
            .add(text(x - 6.0, y + 4.0, 10.0, &format!("{}", t / 1000)).set("fill", colour));
    }
    group
}
