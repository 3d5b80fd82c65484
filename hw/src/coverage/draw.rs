//! A coverage as a picture: floor, passages, route, what was driven, and what was in the way.

use super::drive::{Happening, Run};
use super::floor::Floor;
use super::roadmap::{PassageId, Roadmap};
use super::route::Step;
use crate::draw::{cross, round, text};
use sidestep_sim::geometry::{Point, Pose, Vector};
use std::collections::BTreeMap;
use svg::Document;
use svg::node::element::{Circle, Group, Line, Polygon, Polyline, Rectangle, Title};

/// Pixels per metre.
const SCALE: f64 = 70.0;
/// Around the floor, m.
const MARGIN: f64 = 0.4;
/// How far the lines of a route are drawn beside a passage, m.
const BESIDE: f64 = 0.09;
const WALL: &str = "#495057";
const DIAGRAM: &str = "#adb5bd";
const ROUTE: &str = "#f08c00";
const TRACK: &str = "#1f5fbf";
const BLOCKED: &str = "#d6336c";
const COVERED: &str = "#2b8a3e";

/// What a picture shows.
pub struct Picture<'a> {
    /// Above the picture.
    pub title: &'a str,
    /// Under the title, a line each.
    pub notes: &'a [String],
    /// The floor.
    pub floor: &'a Floor,
    /// Its roadmap.
    pub roadmap: &'a Roadmap,
    /// The route that was planned first.
    pub planned: &'a [Step],
    /// What came of it; none if nothing was driven.
    pub run: Option<&'a Run>,
}

/// Where things are on the picture.
struct Sheet {
    low: Point,
    high: Point,
    header: f64,
}

impl Sheet {
    fn at(&self, place: Point) -> (f64, f64) {
        (
            round((place.x - self.low.x) * SCALE),
            round(self.header + (self.high.y - place.y) * SCALE),
        )
    }

    fn line(&self, points: &[Point], colour: &str, width: f64) -> Polyline {
        let points: Vec<String> = points
            .iter()
            .map(|point| {
                let (x, y) = self.at(*point);
                format!("{x},{y}")
            })
            .collect();
        Polyline::new()
            .set("points", points.join(" "))
            .set("fill", "none")
            .set("stroke", colour)
            .set("stroke-width", width)
    }

    fn disc(&self, place: Point, radius: f64, colour: &str) -> Circle {
        let (x, y) = self.at(place);
        Circle::new()
            .set("cx", x)
            .set("cy", y)
            .set("r", radius)
            .set("fill", colour)
    }
}

/// Draws the picture as SVG.
#[must_use]
pub fn draw(picture: &Picture) -> String {
    let floor = picture.floor;
    let margin = Vector::new(MARGIN, MARGIN);
    let mut low = floor.start.position;
    let mut high = floor.start.position;
    for wall in &floor.walls {
        for end in [wall.from_point(), wall.to_point()] {
            (low, high) = (low.inf(&end), high.sup(&end));
        }
    }
    let sheet = Sheet {
        low: low - margin,
        high: high + margin,
        header: 34.0 + 18.0 * picture.notes.len() as f64,
    };
    let mut scene = Group::new();
    for wall in &floor.walls {
        let ends = [wall.from_point(), wall.to_point()];
        scene = scene.add(sheet.line(&ends, WALL, 3.0));
    }
    scene = scene
        .add(passages(&sheet, picture))
        .add(route(&sheet, picture));
    for surprise in &floor.surprises {
        let corners = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)].map(|(x, y)| {
            let corner = Pose::new(x * surprise.length, y * surprise.width, 0.0);
            let (x, y) = sheet.at(surprise.pose.compose(&corner).position);
            format!("{x},{y}")
        });
        scene = scene.add(
            Polygon::new()
                .set("points", corners.join(" "))
                .set("fill", "#ffd8a8")
                .set("stroke", "#d9480f")
                .set("stroke-width", 1.5),
        );
    }
    if let Some(run) = picture.run {
        let track: Vec<Point> = run
            .simulation
            .trace()
            .iter()
            .map(|s| s.pose.position)
            .collect();
        scene = scene.add(sheet.line(&track, TRACK, 1.6).set("stroke-opacity", 0.8));
        for (t, happening) in &run.happenings {
            if let Happening::Blocked(id, place) = happening {
                let (x, y) = sheet.at(*place);
                scene = scene.add(
                    Group::new()
                        .add(Title::new(format!(
                            "{:.1} s: {id} is blocked here",
                            *t as f64 / 1000.0
                        )))
                        .add(cross(x, y, 7.0, BLOCKED)),
                );
            }
        }
    }
    let home = picture.roadmap.graph[picture.roadmap.home];
    let (x, y) = sheet.at(home);
    scene = scene
        .add(sheet.disc(home, 6.0, TRACK))
        .add(text(x + 9.0, y + 14.0, 12.0, "home").set("fill", TRACK));

    let width = ((sheet.high.x - sheet.low.x) * SCALE).max(760.0);
    let height = (sheet.high.y - sheet.low.y) * SCALE;
    let below = sheet.header + height;
    let mut document = Document::new()
        .set("viewBox", (0.0, 0.0, round(width), round(below + 44.0)))
        .set("width", round(width))
        .set("height", round(below + 44.0))
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
    document.add(scene).add(legend(below + 18.0)).to_string()
}

/// The passages with their names, coloured by what came of them.
fn passages(sheet: &Sheet, picture: &Picture) -> Group {
    let mut group = Group::new();
    for (i, passage) in picture.roadmap.passages.iter().enumerate() {
        let id = PassageId(i);
        let colour = match picture.run.map(|run| &run.report) {
            Some(report) if report.blocked.contains_key(&id) => BLOCKED,
            Some(report) if report.covered.contains(&id) => COVERED,
            _ => DIAGRAM,
        };
        group = group.add(
            sheet
                .line(&passage.points, colour, 7.0)
                .set("stroke-opacity", 0.35)
                .set("stroke-linecap", "round"),
        );
        let (x, y) = sheet.at(middle(&passage.points));
        group = group.add(
            text(x - 8.0, y - 9.0, 12.0, &id.to_string())
                .set("fill", WALL)
                .set("font-weight", "bold"),
        );
        for near in &passage.too_near {
            let flag = format!("{id}: a wall {:.0} mm ahead", near.distance * 1000.0);
            let (x, y) = sheet.at(near.at);
            group = group.add(
                Group::new()
                    .add(Title::new(flag))
                    .add(text(x + 4.0, y - 4.0, 13.0, "!").set("fill", BLOCKED)),
            );
        }
    }
    for place in picture.roadmap.graph.node_weights() {
        group = group.add(sheet.disc(*place, 3.5, WALL));
    }
    group
}

/// The route planned first, beside the passages where they are driven more than once.
fn route(sheet: &Sheet, picture: &Picture) -> Group {
    let mut group = Group::new();
    let mut times: BTreeMap<PassageId, u32> = BTreeMap::new();
    for step in picture.planned {
        let time = times.entry(step.passage).or_default();
        *time += 1;
        let course = picture.roadmap.passage(step.passage).course(step.reversed);
        // To the right of the direction of driving, so that there and back are two lines.
        let aside: Vec<Point> = course
            .windows(2)
            .flat_map(|pair| {
                let along = (pair[1] - pair[0]).try_normalize(1e-9).unwrap_or_default();
                let right = Vector::new(along.y, -along.x) * (BESIDE * f64::from(*time));
                [pair[0] + right, pair[1] + right]
            })
            .collect();
        group = group.add(
            sheet
                .line(&aside, ROUTE, 1.2)
                .set("stroke-dasharray", "5 3"),
        );
    }
    group
}

/// The place half way along a course.
fn middle(points: &[Point]) -> Point {
    let length: f64 = points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum();
    let mut left = length / 2.0;
    for pair in points.windows(2) {
        let leg = pair[1] - pair[0];
        if leg.norm() >= left && leg.norm() > 0.0 {
            return pair[0] + leg * (left / leg.norm());
        }
        left -= leg.norm();
    }
    points.first().copied().unwrap_or_default()
}

fn legend(y: f64) -> Group {
    let entries = [
        ("covered", COVERED, 7.0),
        ("blocked, × where", BLOCKED, 7.0),
        ("first route", ROUTE, 1.2),
        ("driven", TRACK, 1.6),
        ("box that the map does not have", "#d9480f", 7.0),
    ];
    let mut group = Group::new();
    let mut x = 8.0;
    for (name, colour, width) in entries {
        group = group
            .add(
                Line::new()
                    .set("x1", x)
                    .set("y1", y)
                    .set("x2", x + 22.0)
                    .set("y2", y)
                    .set("stroke", colour)
                    .set("stroke-width", width)
                    .set("stroke-opacity", 0.6),
            )
            .add(text(x + 28.0, y + 4.0, 12.0, name));
        x += 46.0 + 6.6 * name.len() as f64;
    }
    group
}
