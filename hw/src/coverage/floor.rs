//! A floor: walls as segments, from a file that lists them or from an occupancy image.
//!
//! The file is TOML, lengths in metres, angles in degrees:
//!
//! ```toml
//! name = "ground floor"
//! start = [0.6, 0.6, 0.0]              # where the robot starts: x, y, heading
//! walls = [[0.0, 0.0, 8.0, 0.0]]       # x and y of one end, x and y of the other
//!
//! [image]                              # instead of walls, or besides
//! file = "floor.pgm"                   # beside this file; PGM or PNG
//! resolution = 0.05                    # metres of a pixel
//! origin = [0.0, 0.0]                  # x and y of the lower left corner
//!
//! [[surprise]]                         # a box that the map does not have, for simulations
//! at = [3.0, 0.4]                      # its middle
//! size = [0.4, 0.3]
//! heading = 0.0                        # of its first side; 0 if left out
//! ```
//!
//! A pixel is free if it is lighter than [`FREE`]. So is the floor in maps by the usual mapping
//! programs, while what they know nothing of is a wall.

use serde::Deserialize;
use sidestep_sim::geometry::{Point, Pose};
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// Pixels lighter than this, of 255, are free: the grey that mapping programs write for unknown.
pub const FREE: u8 = 205;
/// Farthest that a wall may be from the origin, m.
const FARTHEST: f64 = 1000.0;
/// Most walls that a floor may have, once cut where they meet.
const MOST_WALLS: usize = 100_000;

/// A place in whole millimetres, in which the diagram is computed.
pub type Millimetres = [i32; 2];

/// A wall in whole millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Wall {
    /// One end.
    pub from: Millimetres,
    /// The other; not the same.
    pub to: Millimetres,
}

impl Wall {
    /// One end, m.
    #[must_use]
    pub fn from_point(&self) -> Point {
        metres(self.from)
    }

    /// The other, m.
    #[must_use]
    pub fn to_point(&self) -> Point {
        metres(self.to)
    }

    /// The point of the wall that is nearest to `place`, m.
    #[must_use]
    pub fn nearest(&self, place: Point) -> Point {
        let (from, to) = (self.from_point(), self.to_point());
        let along = to - from;
        let part = (place - from).dot(&along) / along.norm_squared();
        from + along * part.clamp(0.0, 1.0)
    }
}

/// A place in metres.
#[must_use]
pub fn metres(place: Millimetres) -> Point {
    Point::new(f64::from(place[0]) / 1000.0, f64::from(place[1]) / 1000.0)
}

/// A box that the map does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surprise {
    /// Its middle, and the direction of its length.
    pub pose: Pose,
    /// Extent along the heading, m.
    pub length: f64,
    /// Extent across it, m.
    pub width: f64,
}

/// Walls that meet at their ends alone, and where the robot starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// What it is called.
    pub name: String,
    /// Where the robot starts.
    pub start: Pose,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// What the map does not show.
    pub surprises: Vec<Surprise>,
}

/// Why there is no floor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FloorError(String);

impl fmt::Display for FloorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FloorError {}

impl From<String> for FloorError {
    fn from(text: String) -> Self {
        Self(text)
    }
}

fn error(text: impl Into<String>) -> FloorError {
    FloorError(text.into())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    name: String,
    start: [f64; 3],
    #[serde(default)]
    walls: Vec<[f64; 4]>,
    image: Option<ImageFile>,
    #[serde(default)]
    surprise: Vec<SurpriseFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageFile {
    file: String,
    resolution: f64,
    #[serde(default)]
    origin: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurpriseFile {
    at: [f64; 2],
    size: [f64; 2],
    #[serde(default)]
    heading: f64,
}

/// A number of a file within its range, or an error that names field, value and range.
fn within(field: &str, value: f64, min: f64, max: f64, unit: &str) -> Result<f64, FloorError> {
    if value >= min && value <= max {
        Ok(value)
    } else {
        Err(error(format!(
            "{field} is {value} {unit}, allowed is {min} {unit} to {max} {unit}"
        )))
    }
}

fn coordinate(field: &str, value: f64) -> Result<f64, FloorError> {
    within(field, value, -FARTHEST, FARTHEST, "m")
}

impl Floor {
    /// Reads a floor's file, and the image that it names, if any, from beside it.
    ///
    /// # Errors
    /// If a file cannot be read, or what it says is out of range: see [`FloorError`].
    pub fn read(path: &Path) -> Result<Self, FloorError> {
        let at = |reason: &dyn fmt::Display| error(format!("{}: {reason}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|reason| at(&reason))?;
        Self::parse(&text, path.parent()).map_err(|reason| at(&reason))
    }

    /// The floor that `text` describes; images are looked for in `folder`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, folder: Option<&Path>) -> Result<Self, FloorError> {
        let file: File = toml::from_str(text).map_err(|reason| error(reason.to_string()))?;
        let [x, y, heading] = file.start;
        let start = Pose::new(
            coordinate("start x", x)?,
            coordinate("start y", y)?,
            within("start heading", heading, -360.0, 360.0, "°")?.to_radians(),
        );
        let mut walls = Vec::new();
        for (i, ends) in file.walls.iter().enumerate() {
            let mut whole = [0; 4];
            for (whole, value) in whole.iter_mut().zip(ends) {
                *whole = (coordinate(&format!("walls[{i}]"), *value)? * 1000.0).round() as i32;
            }
            let [x1, y1, x2, y2] = whole;
            if (x1, y1) == (x2, y2) {
                return Err(error(format!("walls[{i}] is shorter than a millimetre")));
            }
            walls.push(Wall {
                from: [x1, y1],
                to: [x2, y2],
            });
        }
        if let Some(image) = file.image {
            let path = folder.unwrap_or(Path::new("")).join(&image.file);
            let picture = image::open(&path)
                .map_err(|reason| error(format!("{}: {reason}", path.display())))?
                .into_luma8();
            let resolution = within("image resolution", image.resolution, 0.005, 1.0, "m")?;
            let [x, y] = image.origin;
            let origin = [
                coordinate("image origin x", x)?,
                coordinate("image origin y", y)?,
            ];
            walls.extend(outlines(&picture, resolution, origin)?);
        }
        let mut surprises = Vec::new();
        for surprise in file.surprise {
            let [x, y] = surprise.at;
            surprises.push(Surprise {
                pose: Pose::new(
                    coordinate("surprise x", x)?,
                    coordinate("surprise y", y)?,
                    within("surprise heading", surprise.heading, -360.0, 360.0, "°")?.to_radians(),
                ),
                length: within("surprise length", surprise.size[0], 0.01, 10.0, "m")?,
                width: within("surprise width", surprise.size[1], 0.01, 10.0, "m")?,
            });
        }
        Ok(Self {
            name: file.name,
            start,
            walls: cut(walls)?,
            surprises,
        })
    }

    /// Whether a wall lies between two places (m), or touches the line between them.
    #[must_use]
    pub fn is_hidden(&self, from: Point, to: Point) -> bool {
        let along = to - from;
        self.walls.iter().any(|wall| {
            let ends = [wall.from_point(), wall.to_point()];
            let side = |base: Point, along: &nalgebra::Vector2<f64>, place: Point| {
                along.perp(&(place - base))
            };
            let wall_along = ends[1] - ends[0];
            side(from, &along, ends[0]) * side(from, &along, ends[1]) <= 0.0
                && side(ends[0], &wall_along, from) * side(ends[0], &wall_along, to) <= 0.0
        })
    }

    /// From `place` to the nearest wall, m; infinite on a floor without any.
    #[must_use]
    pub fn clearance(&self, place: Point) -> f64 {
        self.walls
            .iter()
            .map(|wall| (wall.nearest(place) - place).norm())
            .fold(f64::INFINITY, f64::min)
    }
}

/// The borders between free pixels and others, as segments as long as they go. What is outside of the
/// image is not free.
fn outlines(
    image: &image::GrayImage,
    resolution: f64,
    origin: [f64; 2],
) -> Result<Vec<Wall>, FloorError> {
    let (width, height) = (i64::from(image.width()), i64::from(image.height()));
    if width == 0 || height == 0 {
        return Err(error("the image is empty"));
    }
    let far = |pixels: i64, from: f64| from.abs() + pixels as f64 * resolution > FARTHEST;
    if far(width, origin[0]) || far(height, origin[1]) {
        return Err(error(format!(
            "the image reaches farther than {FARTHEST} m from the origin"
        )));
    }
    // Row 0 of an image is its uppermost; here y points up.
    let free = |x: i64, y: i64| {
        (0..width).contains(&x)
            && (0..height).contains(&y)
            && image.get_pixel(x as u32, (height - 1 - y) as u32).0[0] > FREE
    };
    let place = |x: i64, y: i64| -> Millimetres {
        let whole =
            |pixels: i64, from: f64| ((from + pixels as f64 * resolution) * 1000.0).round() as i32;
        [whole(x, origin[0]), whole(y, origin[1])]
    };
    let mut walls = Vec::new();
    // A border is between two pixels of which one is free; which of them is tells two borders that
    // meet at a corner of two free pixels apart.
    for y in 0..=height {
        runs(
            width,
            |x| (free(x, y - 1), free(x, y)),
            |from, to| {
                walls.push(Wall {
                    from: place(from, y),
                    to: place(to, y),
                });
            },
        );
    }
    for x in 0..=width {
        runs(
            height,
            |y| (free(x - 1, y), free(x, y)),
            |from, to| {
                walls.push(Wall {
                    from: place(x, from),
                    to: place(x, to),
                });
            },
        );
    }
    Ok(walls)
}

/// Calls `found` with each longest run of places in 0..`count` whose two sides are the same and
/// differ from each other.
fn runs(count: i64, sides: impl Fn(i64) -> (bool, bool), mut found: impl FnMut(i64, i64)) {
    let mut begun: Option<(i64, (bool, bool))> = None;
    for i in 0..=count {
        let here = (i < count).then(|| sides(i)).filter(|(a, b)| a != b);
        if let Some((from, before)) = begun
            && here != Some(before)
        {
            found(from, i);
            begun = None;
        }
        if let (None, Some(here)) = (begun, here) {
            begun = Some((i, here));
        }
    }
}

fn cross(a: [i64; 2], b: [i64; 2]) -> i64 {
    a[0] * b[1] - a[1] * b[0]
}

fn between(from: Millimetres, to: Millimetres) -> [i64; 2] {
    [
        i64::from(to[0]) - i64::from(from[0]),
        i64::from(to[1]) - i64::from(from[1]),
    ]
}

/// Where `wall` has to be cut because of `other`: at the ends of the other that lie on it, and where
/// the two cross, rounded to a millimetre.
fn cuts(wall: &Wall, other: &Wall) -> Vec<Millimetres> {
    let along = between(wall.from, wall.to);
    let length = along[0] * along[0] + along[1] * along[1];
    let mut places = Vec::new();
    for end in [other.from, other.to] {
        let to_end = between(wall.from, end);
        let part = along[0] * to_end[0] + along[1] * to_end[1];
        if cross(along, to_end) == 0 && 0 < part && part < length {
            places.push(end);
        }
    }
    let across = between(other.from, other.to);
    let apart = between(wall.from, other.from);
    let turn = cross(along, across);
    if turn != 0 {
        let (here, there) = (cross(apart, across), cross(apart, along));
        let inside = |part: i64| 0 < part * turn.signum() && part * turn.signum() < turn.abs();
        if inside(here) && inside(there) {
            let part = here as f64 / turn as f64;
            places.push([0, 1].map(|axis| {
                (f64::from(wall.from[axis]) + part * along[axis] as f64).round() as i32
            }));
        }
    }
    places.retain(|place| *place != wall.from && *place != wall.to);
    places
}

/// The same walls, cut so that none meets another but at its ends, each once.
///
/// A crossing is rounded to a millimetre, which bends the two walls there and may make them cross
/// others: it is done until nothing is left to cut.
fn cut(walls: Vec<Wall>) -> Result<Vec<Wall>, FloorError> {
    let ordered = |wall: Wall| Wall {
        from: wall.from.min(wall.to),
        to: wall.from.max(wall.to),
    };
    let mut walls: BTreeSet<Wall> = walls.into_iter().map(ordered).collect();
    for _ in 0..20 {
        if walls.len() > MOST_WALLS {
            return Err(error(format!("more than {MOST_WALLS} walls")));
        }
        // By their left ends, so that only what overlaps in x need be compared.
        let list: Vec<Wall> = walls.iter().copied().collect();
        let mut places: Vec<Vec<Millimetres>> = vec![Vec::new(); list.len()];
        for (i, wall) in list.iter().enumerate() {
            for (j, other) in list.iter().enumerate().skip(i + 1) {
                if other.from[0] > wall.to[0] {
                    break;
                }
                let low = |wall: &Wall| wall.from[1].min(wall.to[1]);
                let high = |wall: &Wall| wall.from[1].max(wall.to[1]);
                if low(wall) <= high(other) && low(other) <= high(wall) {
                    places[i].extend(cuts(wall, other));
                    places[j].extend(cuts(other, wall));
                }
            }
        }
        let mut changed = false;
        walls.clear();
        for (wall, mut places) in list.into_iter().zip(places) {
            changed |= !places.is_empty();
            let far = |place: &Millimetres| {
                let [x, y] = between(wall.from, *place);
                x * x + y * y
            };
            places.sort_by_key(far);
            places.push(wall.to);
            let mut from = wall.from;
            for to in places {
                if to != from {
                    walls.insert(ordered(Wall { from, to }));
                }
                from = to;
            }
        }
        if !changed {
            return Ok(walls.into_iter().collect());
        }
    }
    Err(error(
        "the walls cross each other too closely to be told apart at a millimetre",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walls(list: &[[i32; 4]]) -> Vec<Wall> {
        list.iter()
            .map(|[x1, y1, x2, y2]| Wall {
                from: [*x1, *y1],
                to: [*x2, *y2],
            })
            .collect()
    }

    #[test]
    fn walls_are_cut_where_they_meet() {
        let cross = cut(walls(&[[0, 0, 10, 0], [5, -5, 5, 5]])).expect("walls");
        assert_eq!(cross.len(), 4);
        let tee = cut(walls(&[[0, 0, 10, 0], [5, 5, 5, 0]])).expect("walls");
        assert_eq!(tee.len(), 3);
        let overlap = cut(walls(&[[0, 0, 10, 0], [15, 0, 5, 0], [3, 0, 4, 0]])).expect("walls");
        assert_eq!(
            overlap,
            walls(&[
                [0, 0, 3, 0],
                [3, 0, 4, 0],
                [4, 0, 5, 0],
                [5, 0, 10, 0],
                [10, 0, 15, 0]
            ])
        );
        let corner = walls(&[[0, 0, 0, 10], [0, 0, 10, 0]]);
        assert_eq!(cut(corner.clone()), Ok(corner));
    }

    #[test]
    fn an_image_becomes_its_outlines() {
        // Free are two rooms that touch at a corner.
        let mut image = image::GrayImage::new(4, 4);
        for (x, y) in [
            (0, 0),
            (1, 0),
            (0, 1),
            (1, 1),
            (2, 2),
            (3, 2),
            (2, 3),
            (3, 3),
        ] {
            image.put_pixel(x, y, image::Luma([255]));
        }
        let found = cut(outlines(&image, 0.1, [1.0, 2.0]).expect("walls")).expect("walls");
        assert_eq!(found.len(), 8);
        assert!(found.contains(&Wall {
            from: [1000, 2200],
            to: [1200, 2200]
        }));
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let refused = |text: &str| Floor::parse(text, None).expect_err("refused").to_string();
        assert_eq!(
            refused("start = [0.0, 2000.0, 0.0]"),
            "start y is 2000 m, allowed is -1000 m to 1000 m"
        );
        assert_eq!(
            refused("start = [0.0, 0.0, nan]"),
            "start heading is NaN °, allowed is -360 ° to 360 °"
        );
        assert_eq!(
            refused("start = [0.0, 0.0, 0.0]\nwalls = [[1.0, 1.0, 1.0, 1.0001]]"),
            "walls[0] is shorter than a millimetre"
        );
        assert!(refused("start = [0.0, 0.0, 0.0]\ncolour = 3").contains("colour"));
    }
}
