//! What of the diagram a robot can drive: passages between junctions.

use super::floor::{Floor, FloorError};
use super::voronoi::{self, Skeleton, Vertex};
use rustworkx_core::petgraph::graph::{NodeIndex, UnGraph};
use rustworkx_core::petgraph::stable_graph::{self, StableUnGraph};
use rustworkx_core::petgraph::visit::{EdgeRef, IntoEdgeReferences};
use sidestep_sim::geometry::{Point, Vector};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fmt;

/// What can be driven, and how exactly it is drawn. Lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Where the walls are nearer than this, there is no way: half of S4's safe path.
    pub clearance_min: f64,
    /// From the end of an edge, walls ahead are at least this far, or it is flagged: W2 of the
    /// chapter `edge`.
    pub ahead_min: f64,
    /// Ahead is what lies within this angle of the direction of arrival (rad): what the front
    /// sonars of a P3-DX cover.
    pub ahead_angle: f64,
    /// A passage that leads nowhere and adds less than this to what is seen from where it begins
    /// is not driven.
    pub protrusion_min: f64,
    /// Junctions nearer to each other than this are one.
    pub junction_min: f64,
    /// A passage is drawn by straight legs that are no farther from it than this.
    pub deviation_max: f64,
}

impl Default for Rules {
    /// The paper's robot and parameters.
    fn default() -> Self {
        Self {
            clearance_min: 0.3,
            ahead_min: 0.5882,
            ahead_angle: 65_f64.to_radians(),
            protrusion_min: 0.3,
            junction_min: 0.1,
            deviation_max: 0.03,
        }
    }
}

/// Shortest leg, m.
const SHORTEST_LEG: f64 = 0.02;

/// Which passage: its place in [`Roadmap::passages`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PassageId(pub usize);

impl fmt::Display for PassageId {
    /// E1 is the first.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "E{}", self.0 + 1)
    }
}

/// A wall that is too near ahead of the end of a leg, for one who drives the passage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooNear {
    /// The end of the leg, m.
    pub at: Point,
    /// Driven from the passage's last point to its first.
    pub reversed: bool,
    /// How far the wall is, m.
    pub distance: f64,
}

/// A way between two junctions, or from one to a dead end.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// From its first end to its last by straight legs, at least two points, m.
    pub points: Vec<Point>,
    /// Its length, m.
    pub length: f64,
    /// Where a wall ahead is nearer than [`Rules::ahead_min`]: S4 may take it for an obstacle.
    pub too_near: Vec<TooNear>,
}

impl Passage {
    /// The points in the order of driving, m.
    #[must_use]
    pub fn course(&self, reversed: bool) -> Vec<Point> {
        let mut points = self.points.clone();
        if reversed {
            points.reverse();
        }
        points
    }
}

/// Passages and where they meet.
#[derive(Clone, Debug)]
pub struct Roadmap {
    /// Junctions and dead ends (m), and passages by their id between them: an edge's source is at
    /// the passage's first point.
    pub graph: UnGraph<Point, PassageId>,
    /// The passages.
    pub passages: Vec<Passage>,
    /// Where on the roadmap the robot starts.
    pub home: NodeIndex,
    /// Length of what is wide enough but no way leads to, m: rooms behind doors too narrow, and the
    /// insides of whatever is drawn as its outline.
    pub cut_off: f64,
}

/// The diagram while it is being pruned: places, and chains of places between them.
type Web = StableUnGraph<Vertex, Chain>;

/// A way through places, both ends among them.
#[derive(Clone, Debug)]
struct Chain {
    /// From the end that is the edge's source.
    places: Vec<Vertex>,
    /// Openings of the pieces at the two ends.
    openings: [f64; 2],
}

impl Chain {
    fn length(&self) -> f64 {
        self.places
            .windows(2)
            .map(|pair| (pair[1].place - pair[0].place).norm())
            .sum()
    }

    fn reversed(mut self) -> Self {
        self.places.reverse();
        self.openings.reverse();
        self
    }
}

impl Roadmap {
    /// What can be driven of a floor.
    ///
    /// # Errors
    /// If the diagram cannot be computed, or the robot starts where no way leads to any of it.
    pub fn new(floor: &Floor, rules: &Rules) -> Result<Self, FloorError> {
        let skeleton = voronoi::skeleton(&floor.walls)?;
        let mut web = wide_enough(&skeleton, rules.clearance_min);
        prune(&mut web, rules);
        contract(&mut web, rules.junction_min);
        let home = begin(&mut web, floor)?;
        let whole: f64 = web.edge_weights().map(Chain::length).sum();
        let reached = reach(&web, home);
        web.retain_nodes(|_, node| reached.contains(&node));
        let driven: f64 = web.edge_weights().map(Chain::length).sum();
        let mut roadmap = Self::of(&web, home);
        roadmap.cut_off = whole - driven;
        roadmap.finish(floor, rules);
        Ok(roadmap)
    }

    /// Names what is left, from left to right and from bottom to top.
    fn of(web: &Web, home: stable_graph::NodeIndex) -> Self {
        let mut graph = UnGraph::new_undirected();
        let mut places: Vec<_> = web.node_indices().collect();
        let order = |a: Point, b: Point| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
        places.sort_by(|a, b| order(web[*a].place, web[*b].place));
        let node = |old: stable_graph::NodeIndex| {
            NodeIndex::new(
                places
                    .iter()
                    .position(|place| *place == old)
                    .unwrap_or_default(),
            )
        };
        for place in &places {
            graph.add_node(web[*place].place);
        }
        let mut chains: Vec<_> = web.edge_references().collect();
        let middle = |chain: &Chain| chain.places[chain.places.len() / 2].place;
        chains.sort_by(|a, b| order(middle(a.weight()), middle(b.weight())));
        let mut passages = Vec::new();
        for chain in chains {
            graph.add_edge(
                node(chain.source()),
                node(chain.target()),
                PassageId(passages.len()),
            );
            passages.push(Passage {
                points: chain.weight().places.iter().map(|v| v.place).collect(),
                length: 0.0,
                too_near: Vec::new(),
            });
        }
        let home = node(home);
        Self {
            graph,
            passages,
            home,
            cut_off: 0.0,
        }
    }

    /// Draws the passages by legs, keeps dead ends off the walls ahead, and flags the rest.
    //= coverage.INV-8
    fn finish(&mut self, floor: &Floor, rules: &Rules) {
        for edge in self.graph.edge_indices() {
            let Some((source, target)) = self.graph.edge_endpoints(edge) else {
                continue;
            };
            // A place where a ring begins and nothing else does is not the end of anything.
            let is_dead = |node| source != target && self.graph.edges(node).count() == 1;
            let dead = [is_dead(source), is_dead(target)];
            let passage = &mut self.passages[self.graph[edge].0];
            if dead[0] && source != self.home {
                passage.points.reverse();
                self.graph[source] = shorten(&mut passage.points, floor, rules);
                passage.points.reverse();
            }
            if dead[1] && target != self.home {
                self.graph[target] = shorten(&mut passage.points, floor, rules);
            }
            passage.points = spaced(&legs(&passage.points, rules.deviation_max));
            passage.length = passage
                .points
                .windows(2)
                .map(|pair| (pair[1] - pair[0]).norm())
                .sum();
            for reversed in [false, true] {
                for pair in passage.course(reversed).windows(2) {
                    let distance = ahead(floor, pair[1], pair[1] - pair[0], rules);
                    if distance < rules.ahead_min {
                        passage.too_near.push(TooNear {
                            at: pair[1],
                            reversed,
                            distance,
                        });
                    }
                }
            }
        }
    }

    /// The passage of an id.
    #[must_use]
    pub fn passage(&self, id: PassageId) -> &Passage {
        &self.passages[id.0]
    }

    /// Length of all passages, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.passages.iter().map(|passage| passage.length).sum()
    }
}

/// The pieces of a diagram that are wide enough throughout.
fn wide_enough(skeleton: &Skeleton, clearance_min: f64) -> Web {
    let mut web = Web::default();
    let mut nodes = vec![None; skeleton.vertices.len()];
    for piece in &skeleton.pieces {
        let ends = piece.ends.map(|end| skeleton.vertices[end]);
        if ends.iter().any(|end| end.clearance < clearance_min) {
            continue;
        }
        let [from, to] = piece
            .ends
            .map(|end| *nodes[end].get_or_insert_with(|| web.add_node(skeleton.vertices[end])));
        if from != to {
            web.add_edge(
                from,
                to,
                Chain {
                    places: ends.to_vec(),
                    openings: [piece.opening; 2],
                },
            );
        }
    }
    web
}

/// How many chains end at a place; a ring does so twice.
fn degree(web: &Web, node: stable_graph::NodeIndex) -> usize {
    let ends = |edge: stable_graph::EdgeReference<'_, Chain>| {
        if edge.source() == edge.target() { 2 } else { 1 }
    };
    web.edges(node).map(ends).sum()
}

/// Joins chains at every place where two of them meet and no third. A ring keeps one place.
fn join(web: &mut Web) {
    let nodes: Vec<_> = web.node_indices().collect();
    for node in nodes {
        let edges: Vec<_> = web.edges(node).map(|edge| edge.id()).collect();
        let [first, second] = edges[..] else { continue };
        let ends = |edge| web.edge_endpoints(edge).unwrap_or((node, node));
        let (before, after) = (ends(first), ends(second));
        if before.0 == before.1 || after.0 == after.1 {
            continue;
        }
        let from = if before.1 == node { before.0 } else { before.1 };
        let to = if after.0 == node { after.1 } else { after.0 };
        let (Some(incoming), Some(outgoing)) = (web.remove_edge(first), web.remove_edge(second))
        else {
            continue;
        };
        let incoming = if before.1 == node {
            incoming
        } else {
            incoming.reversed()
        };
        let outgoing = if after.0 == node {
            outgoing
        } else {
            outgoing.reversed()
        };
        let mut places = incoming.places;
        places.extend_from_slice(&outgoing.places[1..]);
        web.remove_node(node);
        web.add_edge(
            from,
            to,
            Chain {
                places,
                openings: [incoming.openings[0], outgoing.openings[1]],
            },
        );
    }
}

/// Takes away what leads nowhere: into corners, and where nothing new is seen.
fn prune(web: &mut Web, rules: &Rules) {
    loop {
        join(web);
        let spurs: Vec<_> = web
            .edge_indices()
            .filter(|edge| {
                let Some((source, target)) = web.edge_endpoints(*edge) else {
                    return false;
                };
                let chain = &web[*edge];
                match (degree(web, source), degree(web, target)) {
                    // A way of its own is no spur of anything.
                    (1, 1) => false,
                    (1, _) => is_spur(&chain.clone().reversed(), rules),
                    (_, 1) => is_spur(chain, rules),
                    _ => false,
                }
            })
            .collect();
        if spurs.is_empty() {
            break;
        }
        for spur in spurs {
            let ends = web.edge_endpoints(spur);
            web.remove_edge(spur);
            if let Some((source, target)) = ends {
                for node in [source, target] {
                    if web.edges(node).next().is_none() {
                        web.remove_node(node);
                    }
                }
            }
        }
    }
    web.retain_nodes(|web, node| web.edges(node).next().is_some());
}

/// Makes one of two junctions that a chain shorter than `shortest` joins; the others of the second now
/// lead on over it to the first.
fn contract(web: &mut Web, shortest: f64) {
    loop {
        let short = web
            .edge_references()
            .find(|edge| edge.source() != edge.target() && edge.weight().length() < shortest);
        let Some(short) = short else {
            break;
        };
        let (first, second) = (short.source(), short.target());
        let Some(link) = web.remove_edge(short.id()) else {
            break;
        };
        let link = link.reversed();
        // A ring at the second junction has two ends there.
        while let Some(edge) = web.edges(second).next().map(|edge| edge.id()) {
            let (source, target) = web.edge_endpoints(edge).unwrap_or_default();
            let Some(chain) = web.remove_edge(edge) else {
                break;
            };
            let (other, mut chain) = if target == second {
                (source, chain)
            } else {
                (target, chain.reversed())
            };
            chain.places.extend_from_slice(&link.places[1..]);
            chain.openings[1] = link.openings[1];
            web.add_edge(other, first, chain);
        }
        web.remove_node(second);
    }
    join(web);
}

/// Whether a chain that ends at its last place is no way to anywhere.
fn is_spur(chain: &Chain, rules: &Rules) -> bool {
    let (Some(first), Some(last)) = (chain.places.first(), chain.places.last()) else {
        return true;
    };
    // It ends where the walls come too near. If they do so from both sides it leads to a gap too
    // narrow; if not, into a corner.
    let ends_narrow = last.clearance < rules.clearance_min + voronoi::PIECE;
    let into_corner = ends_narrow && chain.openings[1] < 5.0 / 6.0 * PI;
    let protrusion = chain.length() + last.clearance - first.clearance;
    into_corner || protrusion < rules.protrusion_min
}

/// The place of the web that is nearest to the robot's start, of those which no wall hides from it;
/// where that is within a chain, the chain is cut there.
fn begin(web: &mut Web, floor: &Floor) -> Result<stable_graph::NodeIndex, FloorError> {
    let start = floor.start.position;
    let mut places: Vec<(f64, stable_graph::EdgeIndex, usize)> = Vec::new();
    for edge in web.edge_references() {
        for (i, place) in edge.weight().places.iter().enumerate() {
            places.push(((place.place - start).norm(), edge.id(), i));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (_, edge, i) = places
        .into_iter()
        .find(|(_, edge, i)| !floor.is_hidden(start, web[*edge].places[*i].place))
        .ok_or_else(|| {
            FloorError::from("there is no way to drive from where the robot starts".to_owned())
        })?;
    let (source, target) = web.edge_endpoints(edge).unwrap_or_default();
    let last = web[edge].places.len() - 1;
    if i == 0 {
        return Ok(source);
    }
    if i == last {
        return Ok(target);
    }
    let home = web.add_node(web[edge].places[i]);
    if let Some(chain) = web.remove_edge(edge) {
        let half = |places: &[Vertex], openings| Chain {
            places: places.to_vec(),
            openings,
        };
        let [first, second] = chain.openings;
        web.add_edge(source, home, half(&chain.places[..=i], [first, PI]));
        web.add_edge(home, target, half(&chain.places[i..], [PI, second]));
    }
    Ok(home)
}

/// All places that chains lead to from `start`.
fn reach(web: &Web, start: stable_graph::NodeIndex) -> BTreeSet<stable_graph::NodeIndex> {
    let mut reached = BTreeSet::from([start]);
    let mut next = vec![start];
    while let Some(node) = next.pop() {
        for neighbour in web.neighbors(node) {
            if reached.insert(neighbour) {
                next.push(neighbour);
            }
        }
    }
    reached
}

/// From `place` to the nearest wall within [`Rules::ahead_angle`] of `direction`, m.
fn ahead(floor: &Floor, place: Point, direction: Vector, rules: &Rules) -> f64 {
    let Some(forward) = direction.try_normalize(1e-9) else {
        return f64::INFINITY;
    };
    let left = Vector::new(-forward.y, forward.x);
    // In the frame of the robot the sector's two edges are rays; a wall's nearest point inside is
    // its own nearest point, or one where it crosses an edge.
    let (sin, cos) = rules.ahead_angle.sin_cos();
    let within = |offset: Vector| {
        let (x, y) = (offset.dot(&forward), offset.dot(&left));
        x * sin >= y.abs() * cos - 1e-9
    };
    let mut least = f64::INFINITY;
    for wall in &floor.walls {
        let nearest = wall.nearest(place) - place;
        if nearest.norm() >= least {
            continue;
        }
        if within(nearest) {
            least = nearest.norm();
            continue;
        }
        let (from, to) = (wall.from_point() - place, wall.to_point() - place);
        for edge in [forward * cos + left * sin, forward * cos - left * sin] {
            // from + part·(to − from) = distance·edge
            let along = to - from;
            let turn = along.perp(&edge);
            if turn.abs() < 1e-12 {
                continue;
            }
            let part = -from.perp(&edge) / turn;
            let distance = (from + along * part).dot(&edge);
            if (0.0..=1.0).contains(&part) && distance >= 0.0 {
                least = least.min(distance);
            }
        }
    }
    least
}

/// Takes points from the end of a dead end until the wall ahead is far enough, if it ever is; where it
/// then ends.
fn shorten(points: &mut Vec<Point>, floor: &Floor, rules: &Rules) -> Point {
    let mut kept = points.len();
    while let [.., before, end] = points[..kept] {
        if ahead(floor, end, end - before, rules) >= rules.ahead_min {
            points.truncate(kept);
            break;
        }
        kept -= 1;
    }
    points.last().copied().unwrap_or_default()
}

/// The same way without corners that are hardly apart from the one before or from the last.
fn spaced(points: &[Point]) -> Vec<Point> {
    let [first, corners @ .., last] = points else {
        return points.to_vec();
    };
    let apart = |a: &Point, b: &Point| (a - b).norm() >= SHORTEST_LEG;
    let mut kept = vec![*first];
    for corner in corners {
        if kept.last().is_some_and(|before| apart(before, corner)) && apart(corner, last) {
            kept.push(*corner);
        }
    }
    kept.push(*last);
    kept
}

/// The fewest points of a way, its ends among them, whose legs pass all others within `deviation`
/// (Ramer, Douglas and Peucker).
pub(super) fn legs(points: &[Point], deviation: f64) -> Vec<Point> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let along = last - first;
    let far = |point: &Point| {
        let offset = point - first;
        let part = if along.norm_squared() > 0.0 {
            (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (offset - along * part).norm()
    };
    let farthest = (1..points.len().saturating_sub(1))
        .map(|i| (i, far(&points[i])))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    match farthest {
        Some((i, distance)) if distance > deviation => {
            let mut way = legs(&points[..=i], deviation);
            way.pop();
            way.extend(legs(&points[i..], deviation));
            way
        }
        _ => vec![*first, *last],
    }
}
