//! Reader of cluttered worlds in the form of the BARN data set, as a table `world,x_m,y_m` of
//! occupied cells.
//!
//! Source: D. Perille, A. Truong, X. Xiao, P. Stone, *Benchmarking Metric Ground Navigation*, SSRR
//! 2020. Its worlds are grids of 0.15 m cells, each filled by a cylinder as wide as the cell.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::Error;
use crate::geometry::Point;
use crate::table;
use crate::world::World;

/// Width of a cell (m).
pub const CELL: f64 = 0.15;

/// The centres of the occupied cells of each world in the file at `path` (m), by the number of the
/// world.
pub fn read(path: &Path) -> Result<BTreeMap<u32, Vec<Point>>, Error> {
    parse(&table::load(path)?, path)
}

/// The same from text already read; `path` only names it in errors.
pub fn parse(text: &str, path: &Path) -> Result<BTreeMap<u32, Vec<Point>>, Error> {
    let mut rows = table::rows(text);
    let header = rows.next().map_or("", |(_, row)| row);
    if header != "world,x_m,y_m" {
        let reason = format!("expected the header world,x_m,y_m, found {header:?}");
        return Err(table::malformed(path, 1, reason));
    }
    let mut worlds: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    for (line, row) in rows {
        let fields: Vec<&str> = row.split(',').collect();
        let [world, x, y] = table::numbers(&fields, path, line)?;
        let world = table::whole("world", world, path, line)?;
        worlds.entry(world).or_default().push(Point::new(x, y));
    }
    Ok(worlds)
}

/// A world with a disc as wide as a cell at each of `cells` (m).
pub fn world(cells: &[Point]) -> Result<World, Error> {
    let mut world = World::new();
    for cell in cells {
        world.add_disc(*cell, CELL / 2.0)?;
    }
    Ok(world)
}
