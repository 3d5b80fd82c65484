//! Coverage: every edge of a floor's generalised Voronoi diagram, driven once.
//!
//! ```text
//! Floor ──voronoi──► Skeleton ──roadmap──► Roadmap ──route──► Step, Step, … ──S4──► Report
//! (walls)            (every edge)          (passages)  (arc routing)         (driven, blocked)
//! ```
//!
//! - [`floor`]: walls as segments, from a TOML file or an occupancy image.
//! - [`voronoi`]: what is equally far from two walls.
//! - [`roadmap`]: of that, what a robot can drive: passages between junctions, with names.
//! - [`route`]: a shortest closed walk over all passages, and over what is left of them.
//! - [`progress`]: what has been driven, what turned out to be blocked, and what is next.
//! - [`drive`]: S4 on that route, in simulation; [`draw`] and [`demo`]: to look at.
//!
//! The chapter `coverage` of the law book says what each must keep.

pub mod demo;
pub mod draw;
pub mod drive;
pub mod floor;
pub mod progress;
pub mod roadmap;
pub mod route;
pub mod trial;
pub mod voronoi;

pub use floor::{Floor, FloorError};
pub use progress::{Progress, Report};
pub use roadmap::{Passage, PassageId, Roadmap, Rules};
pub use route::Step;
