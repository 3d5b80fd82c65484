//! Arc routing: a shortest walk over all passages that are still to be driven.
//!
//! Where every passage is to be driven and the walk ends where it began, this is the Chinese
//! postman's problem, and the walk is a shortest one (Edmonds and Johnson, 1973): the junctions where
//! an odd number of passages meet are paired so that the ways between the pairs are shortest in
//! all, these ways are driven a second time, and the rest is a walk of Euler's. Where some have been
//! driven already it is the rural postman's, for which nobody knows a quick way to the shortest; what
//! is still to be driven is then joined by shortest ways first (Frederickson, 1979).

use super::roadmap::{PassageId, Roadmap};
use rustworkx_core::max_weight_matching::max_weight_matching;
use rustworkx_core::petgraph::algo::{astar, min_spanning_tree};
use rustworkx_core::petgraph::data::Element;
use rustworkx_core::petgraph::graph::{EdgeIndex, NodeIndex, UnGraph};
use rustworkx_core::petgraph::unionfind::UnionFind;
use rustworkx_core::petgraph::visit::{Dfs, EdgeFiltered, EdgeRef};
use std::collections::BTreeSet;

/// One passage to drive, and in which direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Step {
    /// Which.
    pub passage: PassageId,
    /// From its last point to its first.
    pub reversed: bool,
}

/// A length in whole micrometres, in which lengths add up exactly.
fn micrometres(metres: f64) -> u64 {
    (metres * 1e6).round() as u64
}

/// What can be used of a roadmap.
struct Usable<'a> {
    roadmap: &'a Roadmap,
    blocked: &'a BTreeSet<PassageId>,
}

impl Usable<'_> {
    fn id(&self, edge: EdgeIndex) -> PassageId {
        self.roadmap.graph[edge]
    }

    fn length(&self, edge: EdgeIndex) -> u64 {
        micrometres(self.roadmap.passage(self.id(edge)).length)
    }

    fn is_usable(&self, edge: EdgeIndex) -> bool {
        !self.blocked.contains(&self.id(edge))
    }

    /// The shortest way between two places: its passages and their length. None if there is none.
    fn way(&self, from: NodeIndex, to: NodeIndex) -> Option<(u64, Vec<EdgeIndex>)> {
        let graph = &self.roadmap.graph;
        let usable = EdgeFiltered::from_fn(graph, |edge| self.is_usable(edge.id()));
        let (length, places) = astar(
            &usable,
            from,
            |place| place == to,
            |edge| self.length(edge.id()),
            |_| 0,
        )?;
        let passages = places
            .windows(2)
            .filter_map(|pair| {
                graph
                    .edges_connecting(pair[0], pair[1])
                    .map(|edge| edge.id())
                    .filter(|edge| self.is_usable(*edge))
                    .min_by_key(|edge| (self.length(*edge), edge.index()))
            })
            .collect();
        Some((length, passages))
    }

    /// Where one can get to.
    fn reached(&self, from: NodeIndex) -> BTreeSet<NodeIndex> {
        let usable = EdgeFiltered::from_fn(&self.roadmap.graph, |edge| self.is_usable(edge.id()));
        let mut search = Dfs::new(&usable, from);
        let mut reached = BTreeSet::new();
        while let Some(place) = search.next(&usable) {
            reached.insert(place);
        }
        reached
    }
}

/// A walk from `from` over every passage of `wanted` that can be reached without a blocked one, each
/// at least once, and to `to` where that can be reached, or else back. Nothing if nothing is wanted
/// that can be reached and the robot is there already.
///
/// It is never longer than all usable passages twice.
//= coverage.INV-1
//= coverage.INV-2
//= coverage.INV-3
//= coverage.INV-4
#[must_use]
pub fn route(
    roadmap: &Roadmap,
    from: NodeIndex,
    to: NodeIndex,
    wanted: &BTreeSet<PassageId>,
    blocked: &BTreeSet<PassageId>,
) -> Vec<Step> {
    let usable = Usable { roadmap, blocked };
    let reached = usable.reached(from);
    let to = if reached.contains(&to) { to } else { from };
    let reachable: Vec<EdgeIndex> = roadmap
        .graph
        .edge_indices()
        .filter(|edge| {
            let ends = roadmap.graph.edge_endpoints(*edge);
            usable.is_usable(*edge) && ends.is_some_and(|(place, _)| reached.contains(&place))
        })
        .collect();
    let required: Vec<EdgeIndex> = reachable
        .iter()
        .copied()
        .filter(|edge| wanted.contains(&usable.id(*edge)))
        .collect();
    let shortest = connect(&usable, from, to, required);
    let shortest = even(&usable, from, to, shortest);
    // What is always possible: everything there and back, but for one way from `from` to `to`.
    let mut twice: Vec<EdgeIndex> = [&reachable[..], &reachable[..]].concat();
    if let Some((_, way)) = usable.way(from, to) {
        for edge in way {
            if let Some(i) = twice.iter().position(|other| *other == edge) {
                twice.swap_remove(i);
            }
        }
    }
    let length = |edges: &[EdgeIndex]| edges.iter().map(|edge| usable.length(*edge)).sum::<u64>();
    if length(&shortest) <= length(&twice) {
        walk(roadmap, from, &shortest)
    } else {
        walk(roadmap, from, &twice)
    }
}

/// The passages of `edges`, and shortest ways between them until all hang together, `from` and `to`
/// with them.
fn connect(
    usable: &Usable<'_>,
    from: NodeIndex,
    to: NodeIndex,
    mut edges: Vec<EdgeIndex>,
) -> Vec<EdgeIndex> {
    let graph = &usable.roadmap.graph;
    let mut parts = UnionFind::<usize>::new(graph.node_count());
    let mut places = BTreeSet::from([from, to]);
    for edge in &edges {
        if let Some((a, b)) = graph.edge_endpoints(*edge) {
            parts.union(a.index(), b.index());
            places.extend([a, b]);
        }
    }
    let places: Vec<NodeIndex> = places.into_iter().collect();
    // Every two places of different parts, with the way between them.
    let mut between = UnGraph::<NodeIndex, u64>::new_undirected();
    let nodes: Vec<NodeIndex> = places
        .iter()
        .map(|place| between.add_node(*place))
        .collect();
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places.iter().enumerate().skip(i + 1) {
            if parts.equiv(a.index(), b.index()) {
                between.add_edge(nodes[i], nodes[j], 0);
            } else if let Some((length, _)) = usable.way(*a, *b) {
                between.add_edge(nodes[i], nodes[j], length + 1);
            }
        }
    }
    for element in min_spanning_tree(&between) {
        if let Element::Edge {
            source,
            target,
            weight,
        } = element
            && weight > 0
            && let Some((_, way)) = usable.way(places[source], places[target])
        {
            edges.extend(way);
        }
    }
    edges
}

/// The same passages, and shortest ways once more, so that from `from` to `to` there is a walk over
/// each exactly as often as it is there.
//= coverage.INV-5
fn even(
    usable: &Usable<'_>,
    from: NodeIndex,
    to: NodeIndex,
    mut edges: Vec<EdgeIndex>,
) -> Vec<EdgeIndex> {
    let graph = &usable.roadmap.graph;
    let mut is_odd = vec![false; graph.node_count()];
    for edge in &edges {
        if let Some((a, b)) = graph.edge_endpoints(*edge) {
            is_odd[a.index()] ^= true;
            is_odd[b.index()] ^= true;
        }
    }
    is_odd[from.index()] ^= true;
    is_odd[to.index()] ^= true;
    let odd: Vec<NodeIndex> = graph
        .node_indices()
        .filter(|place| is_odd[place.index()])
        .collect();
    let mut pairs = UnGraph::<(), u64>::new_undirected();
    let nodes: Vec<NodeIndex> = odd.iter().map(|_| pairs.add_node(())).collect();
    for i in 0..odd.len() {
        for j in i + 1..odd.len() {
            if let Some((length, _)) = usable.way(odd[i], odd[j]) {
                pairs.add_edge(nodes[i], nodes[j], length);
            }
        }
    }
    // The least sum of lengths is the greatest of what is left of a number above them all.
    let above = pairs.edge_weights().max().copied().unwrap_or(0) + 1;
    let weight = |length: u64| i128::from(above) - i128::from(length);
    let matching = max_weight_matching(
        &pairs,
        true,
        |edge| Ok::<_, std::convert::Infallible>(weight(*edge.weight())),
        false,
    );
    let Ok(matching) = matching;
    // In an order that does not depend on hashes.
    let matching: BTreeSet<(usize, usize)> = matching
        .into_iter()
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    for (a, b) in matching {
        if let Some((_, way)) = usable.way(odd[a], odd[b]) {
            edges.extend(way);
        }
    }
    edges
}

/// Euler's walk from `from` over each of `edges` as often as it is there (Hierholzer, 1873).
fn walk(roadmap: &Roadmap, from: NodeIndex, edges: &[EdgeIndex]) -> Vec<Step> {
    let graph = &roadmap.graph;
    let mut left: Vec<Vec<usize>> = vec![Vec::new(); graph.node_count()];
    // Those entered last are taken first: in the order of their ids.
    for (i, edge) in edges.iter().enumerate().rev() {
        if let Some((a, b)) = graph.edge_endpoints(*edge) {
            left[a.index()].push(i);
            if a != b {
                left[b.index()].push(i);
            }
        }
    }
    let mut driven = vec![false; edges.len()];
    let mut open: Vec<(NodeIndex, Option<Step>)> = vec![(from, None)];
    let mut steps = Vec::new();
    while let Some((place, arrived_by)) = open.last().copied() {
        let next = loop {
            match left[place.index()].pop() {
                Some(i) if driven[i] => {}
                next => break next,
            }
        };
        match next {
            Some(i) => {
                driven[i] = true;
                let (source, target) = graph.edge_endpoints(edges[i]).unwrap_or((place, place));
                let reversed = source != place;
                let step = Step {
                    passage: graph[edges[i]],
                    reversed,
                };
                open.push((if reversed { source } else { target }, Some(step)));
            }
            None => {
                open.pop();
                steps.extend(arrived_by);
            }
        }
    }
    steps.reverse();
    steps
}

/// Length of a walk, m.
#[must_use]
pub fn length(roadmap: &Roadmap, steps: &[Step]) -> f64 {
    steps
        .iter()
        .map(|step| roadmap.passage(step.passage).length)
        .sum()
}
