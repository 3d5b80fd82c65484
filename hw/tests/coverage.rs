//! Chapter `coverage`: plans of random roadmaps and floors, and a floor of twenty edges.

use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;
use rustworkx_core::petgraph::graph::{EdgeIndex, NodeIndex, UnGraph};
use sidestep_hw::coverage::{
    Floor, Passage, PassageId, Progress, Roadmap, Rules, Step, drive, roadmap, route, trial,
    voronoi,
};
use sidestep_hw::edge::corridor_base;
use sidestep_sim::geometry::{Point, Vector, direction, heading_of};
use sidestep_spec::coverage as law;
use std::cell::Cell;
use std::collections::BTreeSet;

/// The floor of the demonstration.
const CORRIDORS: &str = include_str!("../floors/corridors.toml");

/// A roadmap of edges whose lengths are whole metres, with the robot at `home`.
fn roadmap_of(edges: &[law::Edge], home: usize) -> Roadmap {
    let places = edges.iter().map(|(a, b, _)| *a.max(b)).max().unwrap_or(0);
    let mut graph = UnGraph::new_undirected();
    for place in 0..=places.max(home) {
        graph.add_node(Point::new(place as f64, 0.0));
    }
    let mut passages = Vec::new();
    for (a, b, length) in edges {
        let id = PassageId(passages.len());
        graph.add_edge(NodeIndex::new(*a), NodeIndex::new(*b), id);
        passages.push(Passage {
            points: vec![graph[NodeIndex::new(*a)], graph[NodeIndex::new(*b)]],
            length: *length as f64,
            too_near: Vec::new(),
        });
    }
    Roadmap {
        graph,
        passages,
        home: NodeIndex::new(home),
        cut_off: 0.0,
    }
}

/// A roadmap as the law book has it, lengths in micrometres.
fn edges_of(roadmap: &Roadmap) -> Vec<law::Edge> {
    let edge = |i: usize| {
        let (a, b) = roadmap
            .graph
            .edge_endpoints(EdgeIndex::new(i))
            .expect("an edge");
        let length = (roadmap.passages[i].length * 1e6).round() as u64;
        (a.index(), b.index(), length)
    };
    (0..roadmap.passages.len()).map(edge).collect()
}

fn steps_of(steps: impl IntoIterator<Item = Step>) -> Vec<law::Step> {
    let step = |step: Step| (step.passage.0, step.reversed);
    steps.into_iter().map(step).collect()
}

fn ids(set: &BTreeSet<usize>) -> BTreeSet<PassageId> {
    set.iter().copied().map(PassageId).collect()
}

fn numbers(set: impl IntoIterator<Item = PassageId>) -> BTreeSet<usize> {
    set.into_iter().map(|id| id.0).collect()
}

/// Edges between few places: parallel ones and rings among them, and not all connected.
fn any_edges(most: usize) -> impl Strategy<Value = Vec<law::Edge>> {
    vec((0_usize..7, 0_usize..7, 1_u64..30), 1..=most)
}

/// The same, each edge beginning at an end of an earlier one.
fn connected_edges(most: usize) -> impl Strategy<Value = Vec<law::Edge>> {
    vec((any::<Index>(), 0_usize..7, 1_u64..30), 1..=most).prop_map(|list| {
        let mut places = vec![0];
        list.into_iter()
            .map(|(from, to, length)| {
                let from = places[from.index(places.len())];
                places.push(to);
                (from, to, length)
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, ..ProptestConfig::default() })]

    //= coverage.INV-1
    //= coverage.INV-2
    //= coverage.INV-3
    //= coverage.INV-4
    #[test]
    fn routes_are_routes(
        edges in any_edges(12),
        wanted in btree_set(0_usize..12, 0..12),
        blocked in btree_set(0_usize..12, 0..5),
        from in 0_usize..7,
        to in 0_usize..7,
    ) {
        let roadmap = roadmap_of(&edges, from.max(to));
        let edges = edges_of(&roadmap);
        let wanted = wanted.into_iter().filter(|i| *i < edges.len()).collect();
        let walk = steps_of(route::route(
            &roadmap, NodeIndex::new(from), NodeIndex::new(to), &ids(&wanted), &ids(&blocked)
        ));
        let end = if law::reached(&edges, &blocked, from).contains(&to) { to } else { from };
        prop_assert!(law::is_walk(&edges, &walk, from, end), "{walk:?}");
        prop_assert!(law::covers(&edges, &walk, &wanted, &blocked, from), "{walk:?}");
        prop_assert!(law::avoids(&walk, &blocked), "{walk:?}");
        prop_assert!(law::is_at_most_twice(&edges, &walk, &blocked, from), "{walk:?}");
    }

    //= coverage.INV-5
    #[test]
    fn first_route_is_shortest(edges in connected_edges(11)) {
        let home = edges[0].0;
        let roadmap = roadmap_of(&edges, home);
        let edges = edges_of(&roadmap);
        let progress = Progress::new(&roadmap);
        let walk = steps_of(progress.plan());
        let all = (0..edges.len()).collect();
        prop_assert!(law::is_walk(&edges, &walk, home, home), "{walk:?}");
        prop_assert!(law::covers(&edges, &walk, &all, &BTreeSet::new(), home), "{walk:?}");
        prop_assert!(law::is_shortest(&edges, &walk), "{walk:?}");
    }

    /// Some passages are blocked from the beginning, and one more becomes so on the way.
    //= coverage.INV-1
    //= coverage.INV-2
    //= coverage.INV-3
    //= coverage.INV-4
    //= coverage.INV-6
    #[test]
    fn what_is_blocked_is_driven_round(
        edges in connected_edges(14),
        really in btree_set(0_usize..14, 0..5),
        late in (0_usize..14, 0_usize..20),
    ) {
        let home = edges[0].0;
        let roadmap = roadmap_of(&edges, home);
        let edges = edges_of(&roadmap);
        let mut really = really;
        let mut progress = Progress::new(&roadmap);
        let mut steps = 0;
        while let Some(step) = progress.next() {
            prop_assert!(steps < 1_000, "it never ends");
            steps += 1;
            if steps == late.1 {
                really.insert(late.0);
            }
            if !really.contains(&step.passage.0) {
                progress.done();
                continue;
            }
            progress.blocked();
            let report = progress.report();
            let (at, walk) = (progress.at().index(), steps_of(progress.plan()));
            let blocked = numbers(report.blocked.into_keys());
            let covered = numbers(report.covered);
            let wanted = (0..edges.len()).filter(|i| !covered.contains(i)).collect();
            let reached = law::reached(&edges, &blocked, at);
            let end = if reached.contains(&home) { home } else { at };
            prop_assert!(law::is_walk(&edges, &walk, at, end), "{walk:?}");
            prop_assert!(law::covers(&edges, &walk, &wanted, &blocked, at), "{walk:?}");
            prop_assert!(law::avoids(&walk, &blocked), "{walk:?}");
            prop_assert!(law::is_at_most_twice(&edges, &walk, &blocked, at), "{walk:?}");
        }
        let report = progress.report();
        prop_assert!(law::is_walk(
            &edges, &steps_of(progress.driven().iter().copied()), home, progress.at().index()
        ));
        prop_assert!(law::is_accounted_for(
            &edges,
            &steps_of(progress.driven().iter().copied()),
            &numbers(report.covered.clone()),
            &numbers(report.blocked.keys().copied()),
            &numbers(report.unreachable.clone()),
            progress.at().index()
        ), "{report:?}");
    }
}

/// A room with boxes and walls in it, any way round.
fn any_floor() -> impl Strategy<Value = Floor> {
    let boxes = vec((0_u32..80, 0_u32..60, 2_u32..30, 2_u32..30), 0..7);
    let lines = vec((0_u32..120, 0_u32..90, 0_u32..120, 0_u32..90), 0..4);
    (boxes, lines, 5_u32..115, 5_u32..85).prop_map(|(boxes, lines, x, y)| {
        let mut walls = vec![
            [0, 0, 120, 0],
            [120, 0, 120, 90],
            [120, 90, 0, 90],
            [0, 90, 0, 0],
        ];
        for (x, y, width, height) in boxes {
            let (right, up) = ((x + width).min(120), (y + height).min(90));
            walls.extend([
                [x, y, right, y],
                [right, y, right, up],
                [right, up, x, up],
                [x, up, x, y],
            ]);
        }
        for (x1, y1, x2, y2) in lines {
            if (x1, y1) != (x2, y2) {
                walls.push([x1, y1, x2, y2]);
            }
        }
        let tenth = |tenths: u32| f64::from(tenths) / 10.0;
        let list: Vec<String> = walls
            .iter()
            .map(|wall| format!("{:?}", wall.map(tenth)))
            .collect();
        let text = format!(
            "start = [{:?}, {:?}, 0.0]\nwalls = [{}]",
            tenth(x),
            tenth(y),
            list.join(", ")
        );
        Floor::parse(&text, None).expect("a floor")
    })
}

/// From `place` to a wall in direction `heading`, m.
fn cast(floor: &Floor, place: Point, heading: f64) -> f64 {
    let ray = direction(heading);
    let mut least = f64::INFINITY;
    for wall in &floor.walls {
        let from = wall.from_point() - place;
        let along = wall.to_point() - wall.from_point();
        let turn = ray.perp(&along);
        if turn.abs() > 1e-12 {
            let (distance, part) = (from.perp(&along) / turn, from.perp(&ray) / turn);
            if distance >= 0.0 && (0.0..=1.0).contains(&part) {
                least = least.min(distance);
            }
        }
    }
    least
}

/// Checks a roadmap of a floor against its walls.
fn check(floor: &Floor, roadmap: &Roadmap, rules: &Rules) -> Result<(), TestCaseError> {
    for passage in &roadmap.passages {
        prop_assert!(passage.points.len() >= 2 && passage.length > 0.0);
        for reversed in [false, true] {
            for pair in passage.course(reversed).windows(2) {
                for i in 0..=10 {
                    let place = pair[0] + (pair[1] - pair[0]) * (f64::from(i) / 10.0);
                    let clearance = floor.clearance(place);
                    prop_assert!(law::is_clear(
                        clearance,
                        clearance,
                        rules.clearance_min,
                        rules.deviation_max + 0.003
                    ));
                }
                let arrival = heading_of(&(pair[1] - pair[0]));
                let ahead = (-130..=130)
                    .map(|i| arrival + f64::from(i) * rules.ahead_angle / 130.0)
                    .map(|heading| cast(floor, pair[1], heading))
                    .fold(f64::INFINITY, f64::min);
                let is_flagged = passage
                    .too_near
                    .iter()
                    .any(|near| near.at == pair[1] && near.reversed == reversed);
                prop_assert!(law::is_far_or_flagged(
                    ahead + 1e-6,
                    rules.ahead_min,
                    is_flagged
                ));
            }
        }
    }
    // Each passage ends where its junctions are.
    for edge in roadmap.graph.edge_indices() {
        let (a, b) = roadmap.graph.edge_endpoints(edge).expect("an edge");
        let points = &roadmap.passage(roadmap.graph[edge]).points;
        let ends = [points[0], points[points.len() - 1]];
        prop_assert_eq!(ends, [roadmap.graph[a], roadmap.graph[b]]);
    }
    Ok(())
}

//= coverage.INV-7
//= coverage.INV-8
#[test]
fn floors_have_roadmaps() {
    let rules = Rules::default();
    let with_roadmap = Cell::new(0);
    let mut runner = TestRunner::new(ProptestConfig {
        cases: 60,
        ..ProptestConfig::default()
    });
    let result = runner.run(&any_floor(), |floor| {
        let skeleton = voronoi::skeleton(&floor.walls).expect("a diagram");
        for vertex in &skeleton.vertices {
            // Where a wall ends nothing but walls meet, and no piece that is wanted.
            if vertex.clearance.is_finite() {
                let distance = floor.clearance(vertex.place);
                prop_assert!(
                    law::is_clear(distance, vertex.clearance, 0.0, 0.004),
                    "{vertex:?}: {distance}"
                );
            }
        }
        if let Ok(roadmap) = Roadmap::new(&floor, &rules) {
            with_roadmap.set(with_roadmap.get() + 1);
            check(&floor, &roadmap, &rules)?;
            // The robot can see where it begins to drive.
            let home = roadmap.graph[roadmap.home];
            prop_assert!(!floor.is_hidden(floor.start.position, home));
        }
        Ok(())
    });
    result.expect("as the law book says");
    // The others begin inside a box, or where it is too narrow.
    println!("{} of 60 floors have a roadmap", with_roadmap.get());
    assert!(with_roadmap.get() >= 20, "{}", with_roadmap.get());
}

#[test]
fn corridors_have_twenty_edges() {
    let floor = Floor::parse(CORRIDORS, None).expect("a floor");
    let rules = Rules::default();
    let roadmap = Roadmap::new(&floor, &rules).expect("a roadmap");
    assert_eq!(roadmap.passages.len(), 20);
    // The inside of the block in the middle, 3 m by 6.4 m.
    assert!((roadmap.cut_off - 3.4).abs() < 0.01, "{}", roadmap.cut_off);
    check(&floor, &roadmap, &rules).expect("as the law book says");
    // Corridors 1.2 m wide, rooms of 2 m: nothing is too near anywhere.
    let flagged: Vec<_> = roadmap
        .passages
        .iter()
        .flat_map(|passage| &passage.too_near)
        .collect();
    assert_eq!(flagged, [] as [&roadmap::TooNear; 0]);
    // Four rooms, each a dead end.
    let dead_ends = roadmap
        .graph
        .node_indices()
        .filter(|place| roadmap.graph.edges(*place).count() == 1);
    assert_eq!(dead_ends.count(), 4);
}

/// An image of the same floor has the same passages.
#[test]
fn an_image_has_the_same_edges() {
    let floor = Floor::parse(CORRIDORS, None).expect("a floor");
    let drawn = Roadmap::new(&floor, &Rules::default()).expect("a roadmap");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    for (name, pixels_per_metre) in [("floor.pgm", 10), ("floor.png", 20)] {
        let (width, height) = (140 * pixels_per_metre / 10, 90 * pixels_per_metre / 10);
        let image = image::GrayImage::from_fn(width, height, |x, y| {
            let scale = f64::from(pixels_per_metre);
            let place = Point::new(
                (f64::from(x) + 0.5) / scale,
                (f64::from(height - 1 - y) + 0.5) / scale,
            );
            // Walls to the right: one from the free floor, two from within a block.
            let beyond = floor.walls.iter().filter(|wall| {
                let (from, to) = (wall.from_point(), wall.to_point());
                from.x > place.x && (from.y > place.y) != (to.y > place.y)
            });
            let free = beyond.count() % 2 == 1;
            image::Luma([if free { 254 } else { 0 }])
        });
        image.save(folder.join(name)).expect("written");
        let file = folder.join("floor.toml");
        let text = format!(
            "start = [4.8, 0.75, 0.0]\n[image]\nfile = {name:?}\nresolution = {}",
            1.0 / f64::from(pixels_per_metre)
        );
        std::fs::write(&file, text).expect("written");
        let floor = Floor::read(&file).expect("a floor");
        let roadmap = Roadmap::new(&floor, &Rules::default()).expect("a roadmap");
        assert_eq!(roadmap.passages.len(), drawn.passages.len());
        assert!((roadmap.length() - drawn.length()).abs() < 0.1);
    }
}

/// A slanted corridor, as an image has it: its outline is steps, and they are no side ways.
#[test]
fn steps_of_an_image_are_no_passages() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let along = direction(0.35);
    let image = image::GrayImage::from_fn(200, 160, |x, y| {
        let place = Vector::new(f64::from(x) * 0.05 - 1.0, f64::from(159 - y) * 0.05 - 1.5);
        let (on, beside) = (place.dot(&along), along.perp(&place));
        let free = (0.0..=8.0).contains(&on) && beside.abs() <= 0.7;
        image::Luma([if free { 254 } else { 0 }])
    });
    image.save(folder.join("slanted.png")).expect("written");
    let file = folder.join("slanted.toml");
    let text = "start = [2.0, 1.84, 0.0]\n[image]\nfile = \"slanted.png\"\nresolution = 0.05";
    std::fs::write(&file, text).expect("written");
    let floor = Floor::read(&file).expect("a floor");
    let roadmap = Roadmap::new(&floor, &Rules::default()).expect("a roadmap");
    // The corridor, cut where the robot starts.
    assert_eq!(roadmap.passages.len(), 2, "{:#?}", roadmap.passages);
    assert!(
        (6.0..7.5).contains(&roadmap.length()),
        "{}",
        roadmap.length()
    );
}

/// Twenty edges, five boxes that the map does not have: two that can be passed, three that cannot.
#[test]
fn twenty_edges_and_five_boxes() {
    let floor = Floor::parse(CORRIDORS, None).expect("a floor");
    assert_eq!(floor.surprises.len(), 5);
    let roadmap = Roadmap::new(&floor, &Rules::default()).expect("a roadmap");
    let job = drive::Job {
        floor: &floor,
        roadmap: &roadmap,
        config: corridor_base().expect("a configuration"),
        edge: sidestep::edge::PAPER,
        seed: 1,
        sonar_faults: sidestep_sim::sonar::Faults::default(),
        time_limit_ms: 3_600_000,
    };
    let run = drive::run(&job, |t, happening| {
        println!("{:.1} s: {happening:?}", t as f64 / 1000.0);
    })
    .expect("a run");
    println!("{}", run.report);
    // The passages that a box leaves less than 600 mm of.
    let truly_blocked: BTreeSet<PassageId> = roadmap
        .passages
        .iter()
        .enumerate()
        .filter(|(_, passage)| {
            floor.surprises.iter().any(|surprise| {
                let near = |pair: &[Point]| {
                    (0..=200).any(|i| {
                        let place = pair[0] + (pair[1] - pair[0]) * (f64::from(i) / 200.0);
                        (surprise.pose.position - place).norm() < 0.25
                    })
                };
                surprise.length.max(surprise.width) > 0.6 && passage.points.windows(2).any(near)
            })
        })
        .map(|(i, _)| PassageId(i))
        .collect();
    assert_eq!(truly_blocked.len(), 3);
    let report = &run.report;
    assert_eq!(
        report.blocked.keys().copied().collect::<BTreeSet<_>>(),
        truly_blocked
    );
    assert_eq!(report.covered.len(), 17);
    assert_eq!(report.unreachable, BTreeSet::new());
    assert!(run.is_home);
    let outcome = run.simulation.outcome();
    assert_eq!(run.summary.contacts_while_moving(), 0, "{outcome:?}");
    assert!(!run.scans.is_empty());
}

/// Boxes at random places of the same floor, away from where passages meet: everything is named as
/// what it is, and the robot comes home. Where the box leaves 550 to 750 mm, either is right.
#[test]
fn boxes_at_random_places() {
    let mut floor = Floor::parse(CORRIDORS, None).expect("a floor");
    let roadmap = Roadmap::new(&floor, &Rules::default()).expect("a roadmap");
    for seed in 0..20 {
        let trials = trial::boxes(&floor, &roadmap, 5, 0.9, seed);
        assert_eq!(trials.len(), 5);
        floor.surprises = trials.iter().map(|trial| trial.surprise).collect();
        let job = drive::Job {
            floor: &floor,
            roadmap: &roadmap,
            config: corridor_base().expect("a configuration"),
            edge: sidestep::edge::PAPER,
            seed,
            sonar_faults: sidestep_sim::sonar::Faults::default(),
            time_limit_ms: 3_600_000,
        };
        let run = drive::run(&job, |_, _| {}).expect("a run");
        let report = &run.report;
        assert_eq!(run.summary.contacts_while_moving(), 0, "seed {seed}");
        assert!(run.is_home, "seed {seed}: {report}");
        assert!(report.left.is_empty(), "seed {seed}: {report}");
        for (i, _) in roadmap.passages.iter().enumerate() {
            let id = PassageId(i);
            let trial = trials.iter().find(|trial| trial.passage == id);
            let free = trial.map_or(f64::INFINITY, |trial| trial.free);
            let is_blocked = report.blocked.contains_key(&id);
            let is_reached = is_blocked || report.covered.contains(&id);
            if is_reached && free < 0.55 {
                assert!(is_blocked, "seed {seed}: {id}, {free} m are free");
            }
            if is_reached && free > 0.75 {
                assert!(!is_blocked, "seed {seed}: {id}, {free} m are free");
            }
        }
    }
}
