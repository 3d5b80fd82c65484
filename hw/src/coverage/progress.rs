//! What has been driven, what is blocked, and what is next.

use super::roadmap::{PassageId, Roadmap};
use super::route::{self, Step};
use rustworkx_core::petgraph::graph::{EdgeIndex, NodeIndex};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;

/// A coverage of a roadmap under way.
///
/// Whoever drives asks for the [`next`](Self::next) step, drives it, and says whether it is
/// [`done`](Self::done) or [`blocked`](Self::blocked). After a block the robot goes back to where the
/// step began, which is where the next one does.
#[derive(Clone, Debug)]
pub struct Progress<'a> {
    roadmap: &'a Roadmap,
    at: NodeIndex,
    covered: BTreeSet<PassageId>,
    blocked: BTreeMap<PassageId, Step>,
    plan: VecDeque<Step>,
    planned: f64,
    driven: Vec<Step>,
    plans: u32,
}

/// What came of a coverage.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Driven from one end to the other.
    pub covered: BTreeSet<PassageId>,
    /// Found blocked, and from which side.
    pub blocked: BTreeMap<PassageId, Step>,
    /// Not blocked, and out of reach because of what is.
    pub unreachable: BTreeSet<PassageId>,
    /// Still to be driven.
    pub left: BTreeSet<PassageId>,
    /// Length of the roadmap, m.
    pub length: f64,
    /// Length of the first plan, m.
    pub planned: f64,
    /// Length of the steps driven to their end, m.
    pub driven: f64,
    /// How many plans were made.
    pub plans: u32,
}

impl<'a> Progress<'a> {
    /// Everything is still to be driven, and the robot at home.
    #[must_use]
    pub fn new(roadmap: &'a Roadmap) -> Self {
        let mut progress = Self {
            roadmap,
            at: roadmap.home,
            covered: BTreeSet::new(),
            blocked: BTreeMap::new(),
            plan: VecDeque::new(),
            planned: 0.0,
            driven: Vec::new(),
            plans: 0,
        };
        progress.replan();
        let steps: Vec<Step> = progress.plan.iter().copied().collect();
        progress.planned = route::length(roadmap, &steps);
        progress
    }

    fn replan(&mut self) {
        let all = (0..self.roadmap.passages.len()).map(PassageId);
        let wanted = all.filter(|id| !self.covered.contains(id)).collect();
        let blocked = self.blocked.keys().copied().collect();
        let home = self.roadmap.home;
        self.plan = route::route(self.roadmap, self.at, home, &wanted, &blocked).into();
        self.plans += 1;
    }

    /// Where the next step begins.
    #[must_use]
    pub const fn at(&self) -> NodeIndex {
        self.at
    }

    /// What is to be driven next: nothing when all that can be reached has been, and the robot is
    /// home again or cannot get there.
    #[must_use]
    pub fn next(&self) -> Option<Step> {
        self.plan.front().copied()
    }

    /// The steps to come.
    pub fn plan(&self) -> impl ExactSizeIterator<Item = Step> {
        self.plan.iter().copied()
    }

    /// The steps driven to their end.
    #[must_use]
    pub fn driven(&self) -> &[Step] {
        &self.driven
    }

    /// The next step has been driven to its end.
    pub fn done(&mut self) {
        let Some(step) = self.plan.pop_front() else {
            return;
        };
        self.covered.insert(step.passage);
        self.driven.push(step);
        let edge = EdgeIndex::new(step.passage.0);
        if let Some((source, target)) = self.roadmap.graph.edge_endpoints(edge) {
            self.at = if step.reversed { source } else { target };
        }
    }

    /// The next step cannot be driven: there is another plan, without its passage.
    pub fn blocked(&mut self) {
        if let Some(step) = self.plan.pop_front() {
            self.blocked.entry(step.passage).or_insert(step);
            self.replan();
        }
    }

    /// What has come of it so far.
    //= coverage.INV-6
    #[must_use]
    pub fn report(&self) -> Report {
        let all = (0..self.roadmap.passages.len()).map(PassageId);
        let planned = self.plan.iter().map(|step| step.passage);
        let left: BTreeSet<_> = planned.filter(|id| !self.covered.contains(id)).collect();
        Report {
            covered: self.covered.clone(),
            blocked: self.blocked.clone(),
            unreachable: all
                .filter(|id| {
                    !self.covered.contains(id)
                        && !self.blocked.contains_key(id)
                        && !left.contains(id)
                })
                .collect(),
            left,
            length: self.roadmap.length(),
            planned: self.planned,
            driven: route::length(self.roadmap, &self.driven),
            plans: self.plans,
        }
    }
}

/// How many, and their names.
struct Names<I>(I);

impl<I: Iterator<Item = PassageId> + Clone> fmt::Display for Names<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} edges", self.0.clone().count())?;
        let mut between = ": ";
        for id in self.0.clone() {
            write!(f, "{between}{id}")?;
            between = ", ";
        }
        Ok(())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "covered: {}", Names(self.covered.iter().copied()))?;
        writeln!(f, "blocked: {}", Names(self.blocked.keys().copied()))?;
        writeln!(
            f,
            "cut off by what is blocked: {}",
            Names(self.unreachable.iter().copied())
        )?;
        if !self.left.is_empty() {
            writeln!(f, "NOT DRIVEN: {}", Names(self.left.iter().copied()))?;
        }
        write!(
            f,
            "edges {:.1} m; first route {:.1} m; driven {:.1} m over {} plans",
            self.length, self.planned, self.driven, self.plans
        )
    }
}
