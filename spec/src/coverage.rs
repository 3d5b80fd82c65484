//! Chapter `coverage`: what a planner of coverage must keep. See `spec/coverage.md`.
//!
//! A roadmap is a list of edges: its two ends and its length in any whole unit. Edges may be
//! parallel, and both ends of one may be the same. A step of a walk is the place of an edge in that
//! list and whether it is driven from its second end to its first.

use std::collections::BTreeSet;

/// Two ends and a length.
pub type Edge = (usize, usize, u64);

/// An edge's place in the list, and whether it is driven backwards.
pub type Step = (usize, bool);

/// coverage.INV-1: whether each step of a walk begins where the one before ends, the first at `from`,
/// and the last ends at `to`.
#[must_use]
pub fn is_walk(edges: &[Edge], walk: &[Step], from: usize, to: usize) -> bool {
    let mut at = from;
    for (edge, reversed) in walk {
        let Some((source, target, _)) = edges.get(*edge) else {
            return false;
        };
        let (begin, end) = if *reversed {
            (*target, *source)
        } else {
            (*source, *target)
        };
        if begin != at {
            return false;
        }
        at = end;
    }
    at == to
}

/// The places that edges lead to from `from`, without the blocked ones.
#[must_use]
pub fn reached(edges: &[Edge], blocked: &BTreeSet<usize>, from: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::from([from]);
    let mut grows = true;
    while grows {
        grows = false;
        for (i, (source, target, _)) in edges.iter().enumerate() {
            if !blocked.contains(&i) && reached.contains(source) != reached.contains(target) {
                reached.extend([*source, *target]);
                grows = true;
            }
        }
    }
    reached
}

/// coverage.INV-2: whether a walk that begins at `from` has every wanted edge that is not blocked and
/// can be reached without a blocked one.
#[must_use]
pub fn covers(
    edges: &[Edge],
    walk: &[Step],
    wanted: &BTreeSet<usize>,
    blocked: &BTreeSet<usize>,
    from: usize,
) -> bool {
    let reached = reached(edges, blocked, from);
    wanted.iter().all(|edge| {
        blocked.contains(edge)
            || !reached.contains(&edges[*edge].0)
            || walk.iter().any(|(driven, _)| driven == edge)
    })
}

/// coverage.INV-3: whether a walk has no blocked edge.
#[must_use]
pub fn avoids(walk: &[Step], blocked: &BTreeSet<usize>) -> bool {
    walk.iter().all(|(edge, _)| !blocked.contains(edge))
}

/// Length of a walk.
#[must_use]
pub fn length(edges: &[Edge], walk: &[Step]) -> u64 {
    walk.iter().map(|(edge, _)| edges[*edge].2).sum()
}

/// coverage.INV-4: whether a walk that begins at `from` is no longer than all that can be reached
/// without a blocked edge, twice.
#[must_use]
pub fn is_at_most_twice(
    edges: &[Edge],
    walk: &[Step],
    blocked: &BTreeSet<usize>,
    from: usize,
) -> bool {
    let reached = reached(edges, blocked, from);
    let mut all = 0;
    for (i, (source, _, length)) in edges.iter().enumerate() {
        if !blocked.contains(&i) && reached.contains(source) {
            all += length;
        }
    }
    length(edges, walk) <= 2 * all
}

/// Length of a shortest closed walk over all of a connected list of edges, at most 20: of all choices
/// of edges to drive a second time that leave an even number at every place, the shortest.
#[must_use]
pub fn postman_length(edges: &[Edge]) -> u64 {
    let places = edges.iter().map(|(a, b, _)| *a.max(b) + 1).max();
    let once: u64 = edges.iter().map(|edge| edge.2).sum();
    let mut least = u64::MAX;
    for choice in 0_u32..1 << edges.len() {
        let mut is_odd = vec![false; places.unwrap_or(0)];
        let mut again = 0;
        for (i, (a, b, length)) in edges.iter().enumerate() {
            let is_twice = choice >> i & 1 == 1;
            again += if is_twice { *length } else { 0 };
            is_odd[*a] ^= !is_twice;
            is_odd[*b] ^= !is_twice;
        }
        if !is_odd.contains(&true) {
            least = least.min(again);
        }
    }
    once + least
}

/// coverage.INV-5: whether a closed walk over all of a connected list of edges is a shortest one.
#[must_use]
pub fn is_shortest(edges: &[Edge], walk: &[Step]) -> bool {
    length(edges, walk) == postman_length(edges)
}

/// coverage.INV-6: whether every edge is named at the end: covered, or blocked, or, exactly if it is
/// neither, out of reach from `at`, where the robot is, because of what is blocked; and what is covered
/// was driven.
#[must_use]
pub fn is_accounted_for(
    edges: &[Edge],
    driven: &[Step],
    covered: &BTreeSet<usize>,
    blocked: &BTreeSet<usize>,
    cut_off: &BTreeSet<usize>,
    at: usize,
) -> bool {
    let reached = reached(edges, blocked, at);
    (0..edges.len()).all(|edge| {
        let is_done = covered.contains(&edge) || blocked.contains(&edge);
        cut_off.contains(&edge) != is_done
            && (is_done || !reached.contains(&edges[edge].0))
            && covered.contains(&edge) == driven.iter().any(|(driven, _)| *driven == edge)
    })
}

/// coverage.INV-7: whether a point of the diagram is as far from the nearest of all walls as is said
/// of it, and one of a passage farther than the least clearance, to within `tolerance` (m).
#[must_use]
pub fn is_clear(distance: f64, said: f64, least: f64, tolerance: f64) -> bool {
    (distance - said).abs() <= tolerance && distance >= least - tolerance
}

/// coverage.INV-8: whether an end of a leg has walls ahead no nearer than `least` (m), or is flagged.
#[must_use]
pub fn is_far_or_flagged(ahead: f64, least: f64, is_flagged: bool) -> bool {
    ahead >= least || is_flagged
}
