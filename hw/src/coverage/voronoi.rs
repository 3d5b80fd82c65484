//! The generalised Voronoi diagram of walls: what is equally far from the two nearest of them.
//!
//! Computed by `boostvoronoi` in whole millimetres. What is wanted here is the geometry: pieces of
//! the diagram with how far the walls are and how far they lie apart as seen from there.

use super::floor::{FloorError, Millimetres, Wall, metres};
use boostvoronoi::prelude::{Builder, Cell, Diagram, SourceCategory};
use boostvoronoi::utils::visual_utils::{SimpleAffine, VoronoiVisualUtils};
use sidestep_sim::geometry::Point;

/// Longest piece, m. Where something is cut off, it is so to within this.
pub const PIECE: f64 = 0.05;
/// A piece of a parabola and its chord are no farther apart than this, mm.
const SAG: f64 = 2.0;

/// A point of the diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Where, m.
    pub place: Point,
    /// Distance to the nearest wall, m.
    pub clearance: f64,
}

/// A short straight piece between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Indices of its ends.
    pub ends: [usize; 2],
    /// The angle between the directions to the two walls that it runs between, in [0, π] (rad): π
    /// where it runs right between them, little where both are on one side.
    pub opening: f64,
}

/// The diagram, without what goes to infinity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Points.
    pub vertices: Vec<Vertex>,
    /// Pieces between them.
    pub pieces: Vec<Piece>,
}

/// What a cell of the diagram is nearest to.
#[derive(Clone, Copy)]
enum Site {
    End(Millimetres),
    Side(Wall),
}

impl Site {
    fn of(cell: &Cell, walls: &[Wall]) -> Option<Self> {
        let wall = walls.get(cell.source_index().usize())?;
        // The library has turned each wall so that it begins at its lesser end, as they are here.
        Some(match cell.source_category() {
            SourceCategory::SinglePoint | SourceCategory::SegmentStart => Self::End(wall.from),
            SourceCategory::SegmentEnd => Self::End(wall.to),
            SourceCategory::Segment => Self::Side(*wall),
        })
    }

    fn nearest(self, place: Point) -> Point {
        match self {
            Self::End(end) => metres(end),
            Self::Side(wall) => wall.nearest(place),
        }
    }
}

/// The diagram of walls that meet at their ends alone.
///
/// # Errors
/// If the library refuses the walls.
//= coverage.INV-7
pub fn skeleton(walls: &[Wall]) -> Result<Skeleton, FloorError> {
    let refused = |reason: &dyn std::fmt::Display| {
        FloorError::from(format!("no Voronoi diagram of these walls: {reason}"))
    };
    let segments: Vec<[i32; 4]> = walls
        .iter()
        .map(|wall| [wall.from[0], wall.from[1], wall.to[0], wall.to[1]])
        .collect();
    let diagram = Builder::<i32>::default()
        .with_segments(segments.iter())
        .and_then(Builder::build)
        .map_err(|reason| refused(&reason))?;
    trace(&diagram, walls).map_err(|reason| refused(&reason))
}

fn trace(diagram: &Diagram, walls: &[Wall]) -> Result<Skeleton, boostvoronoi::BvError> {
    let mut skeleton = Skeleton {
        vertices: diagram
            .vertices()
            .iter()
            .map(|vertex| Vertex {
                place: Point::new(vertex.x() / 1000.0, vertex.y() / 1000.0),
                clearance: f64::INFINITY,
            })
            .collect(),
        pieces: Vec::new(),
    };
    for edge in diagram.edges() {
        let twin = edge.twin()?;
        // Each edge is there twice, once in each direction. A secondary one is between a wall and
        // its own end, where the robot has no business.
        if !edge.is_primary() || edge.id() > twin {
            continue;
        }
        let twin = diagram.edge(twin)?;
        let (Some(first), Some(last)) = (edge.vertex0(), twin.vertex0()) else {
            continue;
        };
        let (first, last) = (first.usize(), last.usize());
        let sites = (
            Site::of(diagram.cell(edge.cell()?)?, walls),
            Site::of(diagram.cell(twin.cell()?)?, walls),
        );
        let (Some(left), Some(right)) = sites else {
            continue;
        };
        let places = course(
            [
                skeleton.vertices[first].place,
                skeleton.vertices[last].place,
            ],
            left,
            right,
        );
        let mut before = first;
        for (i, place) in places.iter().enumerate() {
            let here = if i + 1 == places.len() {
                last
            } else {
                skeleton.vertices.push(Vertex {
                    place: *place,
                    clearance: f64::INFINITY,
                });
                skeleton.vertices.len() - 1
            };
            for end in [before, here] {
                let vertex = &mut skeleton.vertices[end];
                let to_wall = (left.nearest(vertex.place) - vertex.place).norm();
                vertex.clearance = vertex.clearance.min(to_wall);
            }
            let [from, to] = [before, here].map(|end| skeleton.vertices[end].place);
            let middle = from + (to - from) * 0.5;
            let opening = (left.nearest(middle) - middle).angle(&(right.nearest(middle) - middle));
            skeleton.pieces.push(Piece {
                ends: [before, here],
                opening,
            });
            before = here;
        }
    }
    Ok(skeleton)
}

/// Points of an edge behind its first end, to its last, no farther apart than [`PIECE`], m.
fn course(ends: [Point; 2], left: Site, right: Site) -> Vec<Point> {
    let mut corners: Vec<[f64; 2]> = ends.iter().map(|p| [p.x * 1000.0, p.y * 1000.0]).collect();
    if let (Site::End(end), Site::Side(wall)) | (Site::Side(wall), Site::End(end)) = (left, right) {
        VoronoiVisualUtils::discretize::<i32>(
            &end.into(),
            &[wall.from[0], wall.from[1], wall.to[0], wall.to[1]].into(),
            SAG,
            &SimpleAffine::default(),
            &mut corners,
        );
    }
    let mut places = Vec::new();
    for pair in corners.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(|[x, y]| Point::new(x / 1000.0, y / 1000.0));
        let pieces = ((to - from).norm() / PIECE).ceil().max(1.0);
        for i in 1..=pieces as u32 {
            places.push(from + (to - from) * (f64::from(i) / pieces));
        }
    }
    places
}
