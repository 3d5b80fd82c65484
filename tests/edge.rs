//! Chapter `edge`: properties, the wall theorems over their whole domain, the paper's Table 1.

use nalgebra::Vector2;
use proptest::prelude::*;
use sidestep::arcos::BaseParameters;
use sidestep::config::Config;
use sidestep::edge::{
    self, ActualEdge, Blindness, Detection, Edge, EdgeConfig, Event, Finding, FreeWay, Gap, PAPER,
    Parameters, PlannedEdge, Scan, Situation, State,
};
use sidestep::failsafe::StopReason;
use sidestep::law::Law;
use sidestep::observation::SonarReading;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length};
use sidestep::ring::{Placement, Ring};
use sidestep::view::{Pose, View};
use sidestep_spec::edge as law;
use std::f64::consts::FRAC_PI_2;

mod common;

fn paper() -> EdgeConfig {
    EdgeConfig::new(PAPER).expect("the paper's numbers")
}

fn base() -> Config {
    Config::new(preset::CORRIDOR_BASE).expect("the preset is good")
}

/// The first `N` sonars of a P3-DX.
fn ring_of<const N: usize>() -> Ring<N> {
    let mut placements = [CENTRE; N];
    for (placement, at) in placements.iter_mut().zip(BaseParameters::P3DX.sonars) {
        *placement = Placement::from_mm_deg(at.x_mm, at.y_mm, at.heading_deg);
    }
    Ring::new(&placements, &base()).expect("the ring is good")
}

/// Its front ring.
fn ring() -> Ring<8> {
    ring_of()
}

/// At the robot's centre, looking ahead.
const CENTRE: Placement = Placement {
    x: 0.0,
    y: 0.0,
    heading: 0.0,
};

fn point(x: f32, y: f32) -> Vector2<f32> {
    Vector2::new(x, y)
}

fn edge(from: [f32; 2], to: [f32; 2]) -> PlannedEdge {
    PlannedEdge::new(point(from[0], from[1]), point(to[0], to[1])).expect("an edge")
}

fn pose(x: f32, y: f32, degrees: f32) -> Pose {
    Pose {
        position: point(x, y),
        heading: Angle::radians(degrees.to_radians()).expect("an angle"),
    }
}

const NOTHING: SonarReading = SonarReading::NoEcho(Length::MAX);

fn echo(range: f32) -> SonarReading {
    Length::metres(range).map_or(SonarReading::Invalid, SonarReading::Echo)
}

/// A view in which nothing is wrong and nothing near.
fn quiet_view_of<const N: usize>() -> View<N> {
    let observation = common::in_order(0, [5.0; N]);
    sidestep::view::Memory::default()
        .update(&observation, point(3.0, 0.0), &ring_of(), &base())
        .expect("nothing is wrong")
}

fn quiet_view() -> View<8> {
    quiet_view_of()
}

// ------------------------------------------------------------------------- a world of segments

/// A wall or a side of a box, mm.
type Segment = [[f64; 2]; 2];

/// The sides of a box between two corners.
fn sides(low: [f64; 2], high: [f64; 2]) -> Vec<Segment> {
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect()
}

/// Range of a ray to the nearest segment, mm.
fn cast(from: [f64; 2], angle: f64, segments: &[Segment]) -> Option<f64> {
    let (dy, dx) = angle.sin_cos();
    let hits = segments.iter().filter_map(|[a, b]| {
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        let cross = dx * ey - dy * ex;
        let (ox, oy) = (a[0] - from[0], a[1] - from[1]);
        let along = (ox * ey - oy * ex) / cross;
        let part = (ox * dy - oy * dx) / cross;
        (cross != 0.0 && along >= 0.0 && (0.0..=1.0).contains(&part)).then_some(along)
    });
    hits.reduce(f64::min)
}

/// What so many beams see from a place, the first in this direction (rad) and each a step on: ranges in
/// metres, and infinity where they meet nothing.
fn scanned(from: [f64; 2], first: f64, step: f64, beams: u32, world: &[Segment]) -> Vec<f32> {
    let seen = |i: u32| cast(from, first + f64::from(i) * step, world);
    let metres = |mm: Option<f64>| mm.map_or(f32::INFINITY, |mm| (mm / 1000.0) as f32);
    (0..beams).map(|i| metres(seen(i))).collect()
}

/// What sonar `i` at a pose (mm, degrees) hears: the nearest of rays across its cone.
fn listen(i: usize, at: [f64; 3], half_angle: f64, segments: &[Segment]) -> Option<f64> {
    let sonar = &BaseParameters::P3DX.sonars[i];
    let heading = at[2].to_radians();
    let (sin, cos) = heading.sin_cos();
    let (x, y) = (f64::from(sonar.x_mm), f64::from(sonar.y_mm));
    let face = [at[0] + cos * x - sin * y, at[1] + sin * x + cos * y];
    let axis = heading + f64::from(sonar.heading_deg).to_radians();
    let rays = if half_angle == 0.0 { 0 } else { 60 };
    (-rays..=rays)
        .filter_map(|k| {
            let off = half_angle.to_radians() * f64::from(k) / f64::from(rays.max(1));
            cast(face, axis + off, segments)
        })
        .reduce(f64::min)
}

/// The projections of the front ring by the core, on the paper's desired edge.
fn projections(at: [f64; 3], half_angle: f64, segments: &[Segment]) -> [f32; 8] {
    let (ring, config) = (ring(), paper());
    let here = pose(
        (at[0] / 1000.0) as f32,
        (at[1] / 1000.0) as f32,
        at[2] as f32,
    );
    let actual = ActualEdge::new(&here, &edge([1.0, 3.0], [3.0, 3.0])).expect("an actual edge");
    let closeness = edge::closeness(actual.distance, &config).expect("within d_max");
    let cosines = actual.cosines(&ring);
    std::array::from_fn(|i| {
        let range = listen(i, at, half_angle, segments).map_or(5.0, |mm| mm / 1000.0);
        let range = Length::metres(range.min(5.0) as f32).expect("a range");
        edge::projection(edge::nearness(range, &config), closeness, cosines[i])
    })
}

// --------------------------------------------------------------------------------- properties

proptest! {
    #![proptest_config(common::cases(4096))]

    //= edge.INV-1
    //= edge.INV-2
    //= edge.INV-3
    //= edge.INV-4
    #[test]
    fn equations_are_bounded_and_as_specified(
        range in common::length(), distance in common::any_f32(), cosine in common::any_f32(),
    ) {
        let config = paper();
        let nearness = edge::nearness(range, &config);
        prop_assert!(law::nearness_in_range(nearness, range.get(), config.range_max));
        let closeness = edge::closeness(distance, &config);
        prop_assert!(law::closeness_in_range(closeness, distance, config.distance_max));
        let mm = f64::from(range.get()) * 1000.0;
        let exact = law::e1(mm, 600.0).expect("a range");
        prop_assert!((f64::from(nearness) - exact).abs() < 2e-5);
        if let Some(closeness) = closeness {
            let projection = edge::projection(nearness, closeness, cosine);
            prop_assert!(law::projection_in_range(projection, closeness));
            prop_assert!(law::far_is_harmless(
                projection, range.get(), config.range_max, config.threshold
            ));
            let exact = law::e2(f64::from(distance) * 1000.0, 300.0);
            prop_assert!(exact.is_none_or(|n2| (f64::from(closeness) - n2).abs() < 1e-5));
        }
    }

    /// Any parameters that are a configuration keep the bounds, W2 for their own threshold too.
    //= edge.INV-3
    //= edge.INV-4
    #[test]
    fn any_parameters_keep_the_bounds(
        range in common::length(), range_max in 0.1_f32..5.0, threshold in 0.1_f32..10.0,
        distance_max in 0.05_f32..2.0, part in 0.0_f32..1.2, cosine in common::any_f32(),
    ) {
        let parameters = Parameters { range_max, threshold, distance_max, ..PAPER };
        let config = EdgeConfig::new(parameters).expect("in range");
        let nearness = edge::nearness(range, &config);
        if let Some(closeness) = edge::closeness(part * distance_max, &config) {
            let projection = edge::projection(nearness, closeness, cosine);
            prop_assert!(law::projection_in_range(projection, closeness));
            prop_assert!(law::far_is_harmless(projection, range.get(), range_max, threshold));
        }
    }

    /// Nearer, closer to the edge and more along it never projects less.
    //= edge.INV-3
    #[test]
    fn projection_is_monotone(
        r in 0.0_f32..0.7, dr in 0.0_f32..0.1, d in 0.0_f32..0.3, dd in 0.0_f32..0.1,
        c in -1.0_f32..1.0, dc in 0.0_f32..0.3,
    ) {
        let config = paper();
        let value = |r: f32, d: f32, c: f32| {
            let range = Length::metres(r).expect("a length");
            edge::closeness(d, &config)
                .map(|n2| edge::projection(edge::nearness(range, &config), n2, c))
        };
        if let (Some(more), Some(less)) =
            (value(r, d, (c + dc).min(1.0)), value(r + dr, d + dd, c))
        {
            prop_assert!(more >= less);
        }
    }

    //= edge.INV-6
    //= edge.INV-7
    #[test]
    fn detector_says_what_it_hears(
        readings in prop::collection::vec(any_reading(), 8),
        cosines in prop::array::uniform8(common::any_f32()),
        distance in prop_oneof![4 => -0.35_f32..0.35, 1 => common::any_f32()],
    ) {
        let config = paper();
        let sonar: [SonarReading; 8] = std::array::from_fn(|i| readings[i]);
        let detection = edge::detect(&sonar, &cosines, distance, &config);
        let clear = matches!(detection, Detection::Clear { .. });
        let heard = !sonar.iter().any(is_silent);
        prop_assert!(law::blind_is_not_clear(clear, distance, config.distance_max, heard));
        let Some(closeness) = edge::closeness(distance, &config) else {
            prop_assert_eq!(detection, Detection::Blind(Blindness::OffEdge));
            return Ok(());
        };
        let projections = projected(&sonar, closeness, &cosines, &config);
        let reported = match detection {
            Detection::Obstacle { sonar, greatest } => {
                prop_assert_eq!(projections[sonar], greatest);
                Some(greatest)
            }
            _ => None,
        };
        prop_assert!(law::obstacle_is_greatest(reported, &projections, config.threshold));
    }

    //= edge.INV-6
    //= edge.INV-14
    #[test]
    fn what_no_wall_gives_counts_in_full(
        readings in prop::collection::vec(any_reading(), 16),
        cosines in prop::array::uniform8(-1.0_f32..1.0),
        distance in prop_oneof![4 => -0.35_f32..0.35, 1 => common::any_f32()],
    ) {
        let config = paper();
        let sonar: [SonarReading; 8] = std::array::from_fn(|i| readings[i]);
        let inside: [SonarReading; 8] = std::array::from_fn(|i| readings[8 + i]);
        let detection = edge::detect_inside(&sonar, &inside, &cosines, distance, &config);
        let on_the_edge = projected(&inside, 1.0, &cosines, &config);
        let obstacle = matches!(detection, Detection::Obstacle { .. });
        prop_assert!(law::inside_counts_in_full(obstacle, &on_the_edge, config.threshold));
        // Otherwise it is S4's.
        let alone = edge::detect(&sonar, &cosines, distance, &config);
        let found = matches!(alone, Detection::Obstacle { .. });
        prop_assert!(detection == alone || (obstacle && !found));
        let clear = matches!(detection, Detection::Clear { .. });
        let heard = !sonar.iter().any(is_silent);
        prop_assert!(law::blind_is_not_clear(clear, distance, config.distance_max, heard));
    }

    /// An echo is left where every ray of its cone ends between the sides, 50 mm from either, and only
    /// there, whatever way the edge leads.
    //= edge.INV-15
    #[test]
    fn sides_are_explained_wherever_they_are_heard(
        (x, y, degrees) in (0.0_f32..3.0, -0.5_f32..0.5, -180.0_f32..180.0),
        course in -180.0_f32..180.0,
        ranges in prop::array::uniform8(0.05_f32..1.5),
        (right, left) in (-1.0_f32..-0.2, 0.2_f32..1.0),
        half_angle in 0.02_f32..0.5,
    ) {
        let stage = Stage { start: [0.5, -1.0], course, side: 1.0 };
        let ring = ring();
        let rest = edge::unexplained(
            &ranges.map(echo),
            &ring,
            &stage.pose([x, y, degrees]),
            &stage.line([0.0, 0.0], [3.0, 0.0]),
            &Gap { right, left },
            half_angle,
        );
        let here = pose(x, y, degrees);
        for (i, sonar) in ring.sonars().iter().enumerate() {
            let face = f64::from(here.to_world(sonar.position).y);
            let axis = f64::from(here.heading.get() + sonar.heading.get());
            // Where every ray of the cone ends, across the edge.
            let places: Vec<f64> = (-50..=50)
                .map(|k| axis + f64::from(half_angle) * f64::from(k) / 50.0)
                .map(|ray| face + f64::from(ranges[i]) * ray.sin())
                .collect();
            let is_left = matches!(rest[i], SonarReading::Echo(_));
            prop_assert!(law::left_is_inside(is_left, &places, right.into(), left.into()));
            // What floats round, and what is between the rays, is less than a tenth of a millimetre.
            let clear = |margin: f64| {
                let (right, left) = (f64::from(right) + margin, f64::from(left) - margin);
                places.iter().all(|y| (right..=left).contains(y))
            };
            prop_assert!(is_left || !clear(0.0501));
            prop_assert!(!is_left || clear(0.0499));
        }
    }

    //= edge.INV-8
    #[test]
    fn steering_is_bounded(
        error in common::any_f32(), speed in common::any_f32(), error_max in 0.1_f32..1.5,
    ) {
        let config = base();
        let advice = edge::steer(error, speed, error_max, &config);
        prop_assert!(law::advice_in_range(
            advice.speed, advice.turn_rate, config.speed_max, config.turn_rate_max
        ));
        prop_assert!(error.abs() < error_max || advice.speed == 0.0);
    }

    /// The law, shown any views one after the other, and given scans and routes when it waits.
    //= edge.INV-8
    //= edge.INV-9
    #[test]
    fn any_views_are_driven_within_limits(
        views in prop::collection::vec(scene(), 1..60),
    ) {
        let config = base();
        let route = || vec![edge([0.0, 0.0], [2.0, 0.0]), edge([2.0, 0.0], [2.0, 2.0])];
        let mut driver =
            Edge::<_, 8>::new(config, paper(), ring(), route()).expect("a law");
        for (k, scene) in views.iter().enumerate() {
            let view = scene.view(k as u64 * 400);
            let advice = driver.advise(&view);
            prop_assert!(law::advice_in_range(
                advice.speed, advice.turn_rate, config.speed_max, config.turn_rate_max
            ));
            prop_assert!(law::rests(driver.state().at_rest(), advice.speed, advice.turn_rate));
            // Nothing moves while a sonar is not heard.
            let silent = view.sonar.iter().any(is_silent);
            prop_assert!(!silent || advice.speed == 0.0);
            if driver.wants_scan() {
                let scan = Scan::new(
                    CENTRE,
                    -1.5, 0.1, 8.0, &scene.scan, view.now,
                );
                driver.take_scan(&scan.expect("a scan"));
            }
            if driver.state() == State::Blocked {
                driver.reroute(route()).expect("a route");
            }
            let mut events = 0;
            while driver.next_event().is_some() {
                events += 1;
            }
            prop_assert!(events <= 4);
        }
    }

    //= edge.INV-13
    #[test]
    fn gap_is_free_of_hits(scene in scene(), point_at in (0.2_f32..1.5, -0.6_f32..0.6)) {
        let scan = Scan::new(
            CENTRE,
            -1.5, 0.1, 8.0, &scene.scan, Instant(0),
        )
        .expect("a scan");
        let along = edge([0.0, 0.0], [3.0, 0.0]);
        let here = pose(scene.x, 0.1 * scene.y, scene.heading);
        let found = edge::free_way(&scan, &here, &along, point(point_at.0, point_at.1), 0.6);
        check_gap(&found, &scan, &here, point_at.0)?;
    }

    /// A box in a corridor: the gap that is found is never wider than what is truly free, and hardly
    /// narrower.
    //= edge.INV-13
    #[test]
    fn gap_is_no_wider_than_it_is(
        half_width in 500_f64..1200.0, front in 450_f64..700.0, depth in 100_f64..600.0,
        right in -400_f64..0.0, left in 0_f64..400.0, heading in -20_f64..20.0,
        lateral in -100_f64..100.0,
    ) {
        let mut world = vec![
            [[-1000.0, -half_width], [5000.0, -half_width]],
            [[-1000.0, half_width], [5000.0, half_width]],
        ];
        world.extend(sides([front, right], [front + depth, left]));
        let step = 0.25_f64.to_radians();
        let first = heading.to_radians() - FRAC_PI_2;
        let ranges = scanned([0.0, lateral], first, step, 721, &world);
        let scan = Scan::new(
            CENTRE,
            -FRAC_PI_2 as f32, step as f32, 8.0, &ranges, Instant(0),
        )
        .expect("a scan");
        let along = edge([0.0, 0.0], [3.0, 0.0]);
        let here = pose(0.0, lateral as f32 / 1000.0, heading as f32);
        let heard = point(front as f32 / 1000.0, ((right + left) / 2.0).clamp(-100.0, 100.0) as f32 / 1000.0);
        let found = edge::free_way(&scan, &here, &along, heard, 0.6);
        let free = ((half_width - left).max(right + half_width) / 1000.0) as f32;
        let gap = found.gap.expect("a gap").width();
        prop_assert!(gap <= free + 1e-3, "{gap} of {free}");
        prop_assert!(gap >= free - 0.02, "{gap} of {free}");
        // Its front, and its width as far as it is seen.
        let seen = found.obstacle.expect("it is seen");
        prop_assert!((seen.along[0] - (front / 1000.0) as f32).abs() < 0.005, "{seen:?}");
        prop_assert!((seen.across[0] - (right / 1000.0) as f32).abs() < 0.01, "{seen:?}");
        prop_assert!((seen.across[1] - (left / 1000.0) as f32).abs() < 0.01, "{seen:?}");
        prop_assert_eq!(found.passable, found.gap.expect("a gap").is_passable(0.6));
        prop_assert!(law::gap_is_free(0.0, gap, found.passable, 0.6, &[]));
    }
}

/// edge.INV-13 for what was found in a scan of a scanner at the robot's centre.
fn check_gap(
    found: &FreeWay,
    scan: &Scan<'_>,
    here: &Pose,
    heard: f32,
) -> Result<(), TestCaseError> {
    let Some(gap) = found.gap else {
        prop_assert!(!found.passable);
        return Ok(());
    };
    let far = found.obstacle.map_or(heard, |seen| seen.along[1]) + 0.3;
    let hits: Vec<f32> = scan
        .ranges()
        .iter()
        .enumerate()
        .filter(|(_, range)| (0.0..8.0).contains(*range))
        .map(|(i, range)| {
            let angle = -1.5 + 0.1 * i as f32;
            here.to_world(point(angle.cos(), angle.sin()) * *range)
        })
        // Those at either end of the way may be rounded in or out.
        .filter(|hit| hit.x > here.position.x + 1e-3 && hit.x < far - 1e-3)
        .map(|hit| hit.y)
        .collect();
    prop_assert!(
        law::gap_is_free(gap.right, gap.left, found.passable, 0.6, &hits),
        "{hits:?} in {gap:?}"
    );
    Ok(())
}

/// It does not say what is there.
fn is_silent(reading: &SonarReading) -> bool {
    matches!(reading, SonarReading::Stale | SonarReading::Invalid)
}

/// E1 to E4, sonar by sonar.
fn projected(
    sonar: &[SonarReading; 8],
    closeness: f32,
    cosines: &[f32; 8],
    config: &EdgeConfig,
) -> [f32; 8] {
    std::array::from_fn(|i| match sonar[i] {
        SonarReading::Echo(range) => {
            edge::projection(edge::nearness(range, config), closeness, cosines[i])
        }
        SonarReading::TooNear => edge::projection(10.0, closeness, cosines[i]),
        _ => 0.0,
    })
}

fn any_reading() -> impl Strategy<Value = SonarReading> {
    prop_oneof![
        6 => (0.0_f32..0.7).prop_map(echo),
        2 => common::length().prop_map(SonarReading::Echo),
        1 => Just(NOTHING),
        1 => Just(SonarReading::TooNear),
        1 => Just(SonarReading::Stale),
        1 => Just(SonarReading::Invalid),
    ]
}

/// A view of the law, and a scan for it.
#[derive(Clone, Debug)]
struct Scene {
    x: f32,
    y: f32,
    heading: f32,
    moving: bool,
    sonar: Vec<SonarReading>,
    scan: Vec<f32>,
}

impl Scene {
    fn view(&self, now: u64) -> View<8> {
        let mut view = quiet_view();
        view.now = Instant(now);
        view.pose = pose(self.x, self.y, self.heading);
        view.speed = if self.moving { 0.1 } else { 0.0 };
        view.sonar = std::array::from_fn(|i| self.sonar[i]);
        view
    }
}

fn scene() -> impl Strategy<Value = Scene> {
    let reading = prop_oneof![
        12 => (0.3_f32..3.0).prop_map(echo),
        1 => any_reading(),
    ];
    let range = prop_oneof![
        8 => 0.2_f32..3.0,
        1 => Just(f32::INFINITY),
        1 => Just(f32::NAN),
    ];
    (
        -0.5_f32..2.5,
        -0.5_f32..2.5,
        -180.0_f32..180.0,
        any::<bool>(),
        prop::collection::vec(reading, 8),
        prop::collection::vec(range, 31),
    )
        .prop_map(|(x, y, heading, moving, sonar, scan)| Scene {
            x,
            y,
            heading,
            moving,
            sonar,
            scan,
        })
}

/// M3, every state in every situation.
//= edge.INV-9
//= edge.INV-10
//= edge.INV-11
//= edge.INV-12
#[test]
fn machine_is_total() {
    let findings = [
        None,
        Some(Finding::Passable),
        Some(Finding::Closed),
        Some(Finding::Gone),
    ];
    let mut reached = std::collections::BTreeSet::new();
    for state in State::EACH {
        for bits in 0..64_u8 {
            for finding in findings {
                let bit = |k: u8| bits & (1 << k) != 0;
                let situation = Situation {
                    obstacle: bit(0),
                    standing: bit(1),
                    finding,
                    past: bit(2),
                    following: bit(3),
                    on_edge: bit(4),
                    at_end: bit(5),
                };
                let next = edge::next_state(state, &situation);
                assert!(law::obstacle_stops(
                    !state.at_rest(),
                    situation.obstacle,
                    next == State::Stopped
                ));
                let waits = matches!(state, State::Stopped | State::Measure);
                assert!(law::looks_before_going(waits, next.at_rest()));
                if state == State::FreeWay {
                    let passable = finding == Some(Finding::Passable);
                    assert!(law::finding_decides(passable, next == State::SubRoute));
                }
                reached.insert(format!("{state:?} to {next:?}"));
            }
        }
    }
    // As the book's table has it: so many arrows, and none from the two that only a route leaves.
    assert_eq!(reached.len(), 26, "{reached:#?}");
    assert!(reached.contains("Blocked to Blocked") && reached.contains("Done to Done"));
}

// ---------------------------------------------------------------------------- the wall theorems

/// W1 over its whole domain: the bound by subdivision, for every distance up to 300 mm, every
/// heading, every sonar within ρ of the centre, and a cone of 30° either way.
//= edge.INV-5
#[test]
fn no_side_wall_is_an_obstacle() {
    let bound = law::PAPER_CORRIDOR.wall_bound(1000);
    println!("W1: no side wall gives more than {bound:.4}");
    assert!(law::wall_is_harmless(bound));
    for half_angle in [7.5_f64, 15.0] {
        let corridor = law::Corridor {
            half_angle: half_angle.to_radians(),
            ..law::PAPER_CORRIDOR
        };
        println!(
            "    half cone {half_angle}°: {:.4}",
            corridor.wall_bound(400)
        );
    }
    // The check can fail: in a corridor of 1100 mm the theorem is not true.
    let narrow = law::Corridor {
        half_width: 550.0,
        ..law::PAPER_CORRIDOR
    };
    assert!(!law::wall_is_harmless(narrow.wall_bound(400)));
}

/// Of sixteen sonars the eight in front take part, whichever way the robot looks.
#[test]
fn rear_sonars_take_no_part() {
    let all = ring_of::<16>();
    for degrees in (-180..180).step_by(10) {
        let here = pose(0.0, 0.1, degrees as f32);
        let actual = ActualEdge::new(&here, &edge([0.0, 0.0], [3.0, 0.0])).expect("an edge");
        let cosines = actual.cosines(&all);
        assert_eq!(cosines[..8], actual.cosines(&ring())[..]);
        assert_eq!(cosines[8..], [0.0; 8]);
    }
}

/// The bound is one: what the P3-DX's ring hears of walls, by ray casting and the core, stays under
/// it, and comes near it.
//= edge.INV-5
#[test]
fn walls_stay_under_their_bound() {
    let walls = [
        [[-20_000.0, -600.0], [20_000.0, -600.0]],
        [[-20_000.0, 600.0], [20_000.0, 600.0]],
    ];
    let (ring, config) = (ring(), paper());
    let mut greatest: f32 = 0.0;
    for offset in (-300..=300).step_by(20) {
        for heading in (-180..180).step_by(3) {
            for end in [60.0_f32, 300.0, 1000.0, 5000.0] {
                let at = [0.0, f64::from(offset), f64::from(heading)];
                let here = pose(0.0, offset as f32 / 1000.0, heading as f32);
                let along = edge([-1.0, 0.0], [end / 1000.0, 0.0]);
                let actual = ActualEdge::new(&here, &along).expect("an actual edge");
                let sonar: [SonarReading; 8] = std::array::from_fn(|i| {
                    let range = listen(i, at, 15.0, &walls);
                    range.map_or(NOTHING, |mm| echo((mm / 1000.0) as f32))
                });
                let found = edge::detect(&sonar, &actual.cosines(&ring), actual.distance, &config);
                let Detection::Clear { greatest: p } = found else {
                    panic!("{found:?} at {offset} mm, {heading}°, end {end} mm");
                };
                // None of them passes for something else.
                let sides = config.corridor();
                let inside = edge::unexplained(&sonar, &ring, &here, &along, &sides, 0.2618);
                let heard = |reading: &SonarReading| matches!(reading, SonarReading::Echo(_));
                assert!(!inside.iter().any(heard), "{offset} mm, {heading}°");
                greatest = greatest.max(p);
            }
        }
    }
    println!("the greatest projection of a side wall, P3-DX, 15° cones: {greatest:.3}");
    assert!(law::wall_is_harmless(f64::from(greatest)));
    assert!(greatest > 2.0, "the scan of the domain is too coarse");
}

/// W2: whatever is 588.2 mm or more from the centre gives no more than 3, wherever and however the
/// robot looks; a little nearer it can.
//= edge.INV-4
#[test]
fn nothing_is_an_obstacle_from_588_mm_on() {
    let harmless = law::harmless_distance(600.0, 3.0, 168.2);
    assert!((harmless - 588.2).abs() < 1e-9);
    for sonar in BaseParameters::P3DX.sonars {
        let (x, y) = (f64::from(sonar.x_mm), f64::from(sonar.y_mm));
        assert!(
            x.hypot(y) < 168.25 || sonar.x_mm < 0,
            "ρ covers the front ring"
        );
    }
    let config = paper();
    let at_least = |mm: f64| {
        // The face may be ρ nearer to the thing than the centre is.
        let range = Length::metres(((mm - 168.2) / 1000.0) as f32).expect("a range");
        edge::projection(edge::nearness(range, &config), 1.0, 1.0)
    };
    assert!(at_least(harmless + 0.01) <= config.threshold);
    assert!(at_least(harmless - 1.0) > config.threshold);
}

// ----------------------------------------------------------------------- what is not detected

/// ER-S4-07 and ER-S4-08: detection shortens off the edge, and ends.
#[test]
fn detection_shortens_off_the_edge() {
    let range = |d: f64, alpha: f64| law::detection_range(d, alpha, 3.0, 600.0, 300.0);
    let expected = [
        (0.0, 417.0),
        (100.0, 372.0),
        (200.0, 295.0),
        (250.0, 234.0),
        (300.0, 143.0),
    ];
    for (d, mm) in expected {
        assert!((range(d, 10.0).expect("a range") - mm).abs() < 0.8, "{d}");
    }
    assert!(range(266.7, 50.0).is_none() && range(266.5, 50.0).is_some());
    assert!(range(301.0, 10.0).is_none());
}

/// ER-S4-08, mended: what no wall can give is detected beside the edge from as far away as on it, what
/// may be a wall as S4 has it.
//= edge.INV-14
#[test]
fn beside_the_edge_only_walls_count_less() {
    let (ring, config) = (ring(), paper());
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let sides = config.corridor();
    // 300 mm beside the edge, looking towards it or away from it; 400 mm to what the middle sonars hear.
    let found = |degrees: f32| {
        let here = pose(1.0, 0.3, degrees);
        let mut sonar = [NOTHING; 8];
        (sonar[3], sonar[4]) = (echo(0.4), echo(0.4));
        let inside = edge::unexplained(&sonar, &ring, &here, &along, &sides, 0.2618);
        let actual = ActualEdge::new(&here, &along).expect("an actual edge");
        let cosines = actual.cosines(&ring);
        let alone = edge::detect(&sonar, &cosines, 0.3, &config);
        assert!(matches!(alone, Detection::Clear { .. }), "{alone:?}");
        edge::detect_inside(&sonar, &inside, &cosines, 0.3, &config)
    };
    assert!(matches!(found(-10.0), Detection::Obstacle { .. }));
    assert!(matches!(found(45.0), Detection::Clear { .. }));
}

/// ER-S4-09: no sonar looks straight ahead. A thin thing there is not detected with cones of 10°
/// either way, and with 15° only near the edge.
#[test]
fn thin_things_dead_ahead_are_missed() {
    let (ring, config) = (ring(), paper());
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let detected = |distance: f64, half_angle: f64| {
        (250..600).rev().any(|x| {
            let x = f64::from(x);
            let pole = sides([x, distance - 1.0], [x + 2.0, distance + 1.0]);
            let sonar: [SonarReading; 8] = std::array::from_fn(|i| {
                let range = listen(i, [0.0, distance, 0.0], half_angle, &pole);
                range.map_or(NOTHING, |mm| echo((mm / 1000.0) as f32))
            });
            let here = pose(0.0, distance as f32 / 1000.0, 0.0);
            let actual = ActualEdge::new(&here, &along).expect("an actual edge");
            let found = edge::detect(&sonar, &actual.cosines(&ring), actual.distance, &config);
            matches!(found, Detection::Obstacle { .. })
        })
    };
    assert!(!detected(0.0, 10.0));
    assert!(detected(0.0, 15.0));
    assert!(!detected(200.0, 15.0));
}

// ----------------------------------------------------------------------------------- the table

/// S4 Table 1: printed, with the printed geometry, and with the geometry that reproduces it.
#[test]
fn table_1() {
    let scene = |top: f64, upper_wall: bool| {
        let mut world = vec![[[-5000.0, 2400.0], [9000.0, 2400.0]]];
        if upper_wall {
            world.push([[-5000.0, 3600.0], [9000.0, 3600.0]]);
        }
        world.extend(sides([1800.0, 2400.0], [2050.0, top]));
        world
    };
    let printed = [
        ("Fig. 4", [0.1, 0.0, 0.0, 0.0, 4.0, 2.6, 0.0, 0.1]),
        ("Fig. 5", [0.0, 0.0, 0.0, 0.0, 7.1, 5.9, 3.3, 0.2]),
        ("Fig. 6", [0.0; 8]),
    ];
    let as_printed = [
        projections([1300.0, 3000.0, 0.0], 0.0, &scene(2850.0, true)),
        projections([1500.0, 3000.0, 0.0], 0.0, &scene(2850.0, true)),
        projections([1900.0, 3250.0, 0.0], 0.0, &scene(2850.0, false)),
    ];
    let fitted = [
        projections([1300.0, 3000.0, -1.25], 0.0, &scene(2900.0, true)),
        projections([1532.0, 2960.0, -1.5], 2.0, &scene(2900.0, false)),
        projections([1900.0, 3250.0, -12.8], 0.0, &scene(2900.0, false)),
    ];
    println!("S4 Table 1, P0 to P7: printed / printed geometry / geometry that reproduces it");
    for (k, (figure, row)) in printed.iter().enumerate() {
        println!(
            "{figure}  {row:5.2?}\n        {:5.2?}\n        {:5.2?}",
            as_printed[k], fitted[k]
        );
    }
    for (k, (figure, row)) in printed.iter().enumerate() {
        for i in 0..8 {
            // The printed ±90° entries are |cos|; the reading counts only what looks ahead.
            let side = i == 0 || i == 7;
            let miss = (f64::from(fitted[k][i]) - row[i]).abs();
            assert!(
                miss <= if side { 0.21 } else { 0.06 },
                "{figure} P{i}: {}",
                fitted[k][i]
            );
        }
    }
    // The printed geometry gives neither of the P4: the corner is off the sonar's axis.
    assert_eq!([as_printed[0][4], as_printed[1][4]], [0.0, 0.0]);
    let near = |value: f32, expected: f32| (value - expected).abs() < 0.01;
    assert!(near(as_printed[0][5], 2.79) && near(as_printed[1][5], 6.13));
    assert!(near(as_printed[1][6], 3.33));
    // What is certain: in the first two figures the obstacle is detected, in the third nothing is.
    assert!(fitted[0][4] > 3.0 && fitted[1][4] > 3.0 && fitted[2].iter().all(|p| *p <= 3.0));
}

// -------------------------------------------------------------------------------- the free way

/// A scan of a corridor from its middle, with a box that leaves `free` mm on the left.
fn corridor_scan(free: f64, step: f64) -> Vec<f32> {
    let mut world = vec![
        [[-1000.0, -600.0], [5000.0, -600.0]],
        [[-1000.0, 600.0], [5000.0, 600.0]],
    ];
    world.extend(sides([500.0, -600.0], [750.0, 600.0 - free]));
    let beams = (std::f64::consts::PI / step).round() as u32 + 1;
    scanned([0.0, 0.0], -FRAC_PI_2, step, beams, &world)
}

fn measure(free: f64, step_deg: f64) -> FreeWay {
    let step = step_deg.to_radians();
    let ranges = corridor_scan(free, step);
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(CENTRE, first, step as f32, 8.0, &ranges, Instant(0)).expect("a scan");
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    edge::free_way(&scan, &pose(0.0, 0.0, 0.0), &along, point(0.5, -0.06), 0.6)
}

/// 599 mm are never a way, 601 mm are one for a scanner that resolves them; a coarse one errs to
/// the safe side.
//= edge.INV-13
#[test]
fn a_way_is_600_mm_wide() {
    for step in [1.0, 0.5, 0.25, 0.1] {
        assert!(!measure(599.0, step).passable, "{step}°");
        let least = (600..640).find(|free| measure(f64::from(*free), step).passable);
        println!("steps of {step}°: the narrowest way found is {least:?} mm");
        assert!(least.is_some_and(|mm| mm <= 610));
    }
    assert!(measure(601.0, 0.1).passable);
    let found = measure(750.0, 0.5);
    let (gap, seen) = (
        found.gap.expect("a gap"),
        found.obstacle.expect("it is seen"),
    );
    assert!((gap.middle() - 0.225).abs() < 0.005, "{gap:?}");
    assert!((seen.along[0] - 0.5).abs() < 1e-3 && (seen.across[0] + 0.6).abs() < 0.01);
}

/// What the laser does not show is not free.
//= edge.INV-13
#[test]
fn unseen_is_not_free() {
    let step = 0.5_f64.to_radians();
    let mut ranges = corridor_scan(750.0, step);
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let look = |ranges: &[f32], first: f64| {
        let scan = Scan::new(CENTRE, first as f32, step as f32, 8.0, ranges, Instant(0));
        let scan = scan.expect("a scan");
        edge::free_way(&scan, &pose(0.0, 0.0, 0.0), &along, point(0.5, -0.1), 0.6)
    };
    let first = -FRAC_PI_2;
    assert!(look(&ranges, first).passable);
    // A scanner that looks only 40° to the left sees 0.42 m there.
    let part = &ranges[..=260];
    let found = look(part, first);
    assert!(!found.passable, "{found:?}");
    // A beam into the gap that was dazzled.
    ranges[240] = f32::NAN;
    let found = look(&ranges, first);
    assert!(!found.passable, "{found:?}");
}

/// What a scanner sees of the way past a box, which is all that is there, is free as far across as it looks:
/// up to `half` degrees to either side from where it sits, and no farther than a metre and a half.
//= edge.INV-13
#[test]
fn the_field_of_view_bounds_the_way() {
    let across = |half: f64, aside: f64, left: bool| {
        let step = 0.5_f64.to_radians();
        let low = if left { -0.2 } else { 0.0 };
        let world = sides([1000.0, 1000.0 * low], [1200.0, 1000.0 * low + 200.0]);
        // All round it ends a step before it began.
        let beams = (2.0 * half / 0.5) as u32 + u32::from(half < 180.0);
        let from = [0.0, 1000.0 * aside];
        let ranges = scanned(from, -half.to_radians(), step, beams, &world);
        let placement = Placement {
            x: 0.0,
            y: aside as f32,
            heading: 0.0,
        };
        let first = -half.to_radians() as f32;
        let scan = Scan::new(placement, first, step as f32, 8.0, &ranges, Instant(0));
        let along = edge([0.0, 0.0], [3.0, 0.0]);
        let seen = point(1.0, low as f32 + 0.1);
        let scan = scan.expect("a scan");
        let found = edge::free_way(&scan, &pose(0.0, 0.0, 0.0), &along, seen, 0.6);
        found.gap.expect("a gap")
    };
    for half in [25.0_f64, 40.0, 60.0, 89.0, 100.0, 120.0, 180.0] {
        for aside in [0.0, 0.05, -0.05] {
            let reach = if half < 90.0 {
                half.to_radians().tan()
            } else {
                9.0
            };
            let [gap, other] = [true, false].map(|left| across(half, aside, left));
            let close = |found: f32, expected: f64| (f64::from(found) - expected).abs() < 0.02;
            // Left of the box, which reaches to the edge's middle, and right of the other.
            assert!(
                close(gap.right, 0.0) && close(other.left, 0.0),
                "{half}: {gap:?} {other:?}"
            );
            assert!(
                close(gap.left, (aside + reach).min(1.5)),
                "{half}, {aside}: {gap:?}"
            );
            assert!(
                close(other.right, (aside - reach).max(-1.5)),
                "{half}, {aside}: {other:?}"
            );
        }
    }
}

/// Nothing to be seen where a sonar heard something: the point itself is in the way.
#[test]
fn what_only_a_sonar_hears_counts() {
    let step = 0.5_f64.to_radians();
    let world = [
        [[-1000.0, -600.0], [5000.0, -600.0]],
        [[-1000.0, 600.0], [5000.0, 600.0]],
    ];
    let ranges = scanned([0.0, 0.0], -FRAC_PI_2, step, 361, &world);
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(CENTRE, first, step as f32, 8.0, &ranges, Instant(0)).expect("a scan");
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let found = edge::free_way(&scan, &pose(0.0, 0.0, 0.0), &along, point(0.5, 0.0), 0.6);
    assert_eq!(found.obstacle, None);
    assert!(!found.passable, "{found:?}");
}

// ------------------------------------------------------------- every place, and its mirror image

/// Where an edge lies in the world, and whether right is taken for left. What is so on one is so on all.
#[derive(Clone, Copy, Debug)]
struct Stage {
    start: [f32; 2],
    /// Direction of the edge, degrees.
    course: f32,
    /// 1, or −1 for the mirror image.
    side: f32,
}

fn stages() -> impl Iterator<Item = Stage> {
    let places = [
        ([0.0, 0.0], 0.0),
        ([-2.5, 1.5], 37.0),
        ([1.0, -3.0], -128.0),
    ];
    places.into_iter().flat_map(|(start, course)| {
        [1.0, -1.0].map(|side| Stage {
            start,
            course,
            side,
        })
    })
}

impl Stage {
    /// A point of the edge's frame in the world.
    fn point(&self, [x, y]: [f32; 2]) -> Vector2<f32> {
        let [start_x, start_y] = self.start;
        pose(start_x, start_y, self.course).to_world(point(x, self.side * y))
    }

    fn line(&self, from: [f32; 2], to: [f32; 2]) -> PlannedEdge {
        PlannedEdge::new(self.point(from), self.point(to)).expect("an edge")
    }

    /// A pose from the place in the edge's frame and the direction to the edge, degrees.
    fn pose(&self, [x, y, degrees]: [f32; 3]) -> Pose {
        let at = self.point([x, y]);
        pose(at.x, at.y, self.course + self.side * degrees)
    }

    /// The sonar that is heard here where `i` is on the other side: the ring is its own mirror image.
    fn sonar(&self, i: usize) -> usize {
        if self.side > 0.0 { i } else { 7 - i }
    }

    /// Where the vector of a sonar ends, in the world: from its face along its axis.
    fn vector_end(&self, [x, y, degrees]: [f32; 3], sonar: usize, range: f32) -> Vector2<f32> {
        let at = BaseParameters::P3DX.sonars[sonar];
        let [face_x, face_y] = [at.x_mm, at.y_mm].map(|mm| f32::from(mm) / 1000.0);
        let heading = degrees.to_radians();
        let axis = heading + f32::from(at.heading_deg).to_radians();
        self.point([
            x + face_x * heading.cos() - face_y * heading.sin() + range * axis.cos(),
            y + face_x * heading.sin() + face_y * heading.cos() + range * axis.sin(),
        ])
    }

    /// From one side across to the other, as it is in the mirror.
    fn across(&self, [from, to]: [f32; 2]) -> [f32; 2] {
        if self.side > 0.0 {
            [from, to]
        } else {
            [-to, -from]
        }
    }

    /// The free way past what is heard at a point of the edge's frame, in that frame.
    fn free_way(&self, look: &Look, here: [f32; 3], heard: [f32; 2]) -> FreeWay {
        let (look, along) = (look.on(self), self.line([0.0, 0.0], [3.0, 0.0]));
        let here = self.pose(here);
        let found = edge::free_way(&look.scan(0), &here, &along, self.point(heard), 0.6);
        FreeWay {
            gap: found.gap.map(|gap| {
                let [right, left] = self.across([gap.right, gap.left]);
                Gap { right, left }
            }),
            obstacle: found.obstacle.map(|seen| edge::Extent {
                across: self.across(seen.across),
                ..seen
            }),
            ..found
        }
    }
}

/// Directions, radians, and what is seen in them, metres away.
type Seen<'a> = &'a [(f32, f32)];

/// What a scanner shows, and how it sits on the robot.
#[derive(Clone, Debug)]
struct Look {
    placement: Placement,
    first: f32,
    step: f32,
    reach: f32,
    ranges: Vec<f32>,
}

impl Look {
    /// From the robot's centre, in the directions `first` to `last`, radians: these ranges in some of
    /// them, and nothing in the others.
    fn of([first, last]: [f32; 2], step: f32, seen: Seen) -> Self {
        let beam = |direction: f32| ((direction - first) / step).round() as usize;
        let mut ranges = vec![f32::INFINITY; beam(last) + 1];
        for (direction, range) in seen {
            ranges[beam(*direction)] = *range;
        }
        Self {
            placement: CENTRE,
            first,
            step,
            reach: 8.0,
            ranges,
        }
    }

    /// Half a circle ahead, in quarters of a degree, of a world of segments (mm): what a scanner sees
    /// that sits like this on a robot at this place, metres and degrees.
    fn around([x, y, degrees]: [f32; 3], placement: Placement, world: &[Segment]) -> Self {
        let here = pose(x, y, degrees);
        let at = here.to_world(point(placement.x, placement.y)) * 1000.0;
        let course = f64::from(here.heading.get() + placement.heading);
        let step = 0.25_f64.to_radians();
        let from = [at.x.into(), at.y.into()];
        Self {
            placement,
            first: -FRAC_PI_2 as f32,
            step: step as f32,
            reach: 8.0,
            ranges: scanned(from, course - FRAC_PI_2, step, 721, world),
        }
    }

    /// The same on a stage, where it may have to be its mirror image.
    fn on(&self, stage: &Stage) -> Self {
        let mut look = self.clone();
        if stage.side < 0.0 {
            look.placement.y *= -1.0;
            look.placement.heading *= -1.0;
            look.first = -(self.first + (self.ranges.len() - 1) as f32 * self.step);
            look.ranges.reverse();
        }
        look
    }

    fn scan(&self, taken_at: u64) -> Scan<'_> {
        let Self {
            placement,
            first,
            step,
            reach,
            ..
        } = *self;
        Scan::new(
            placement,
            first,
            step,
            reach,
            &self.ranges,
            Instant(taken_at),
        )
        .expect("a scan")
    }
}

fn close(found: f32, expected: f32, within: f32) -> bool {
    (found - expected).abs() <= within
}

/// From the right to the left across the edge, metres, if anything is free.
type Free = Option<[f32; 2]>;

/// The gap is what is expected, or nothing is free.
#[track_caller]
fn assert_gap(found: &FreeWay, expected: Free, within: f32, what: &str) {
    let ok = match (found.gap, expected) {
        (Some(gap), Some([right, left])) => {
            close(gap.right, right, within) && close(gap.left, left, within)
        }
        (gap, None) => gap.is_none_or(|gap| gap.width() < within),
        (None, Some(_)) => false,
    };
    assert!(ok, "{what}: {found:?}, expected {expected:?}");
    let is_free = |gap: Gap| law::gap_is_free(gap.right, gap.left, found.passable, 0.6, &[]);
    assert!(found.gap.is_none_or(is_free), "{what}: {found:?}");
}

/// What it is, the directions of the first and the last beam, what they see, where something is heard, and
/// what is free.
type Case<'a> = (&'a str, [f32; 2], Seen<'a>, [f32; 2], Free);

/// What a scan of a few beams leaves free. A thing that is seen by a beam blocks the rest up to the
/// beams that pass it: at its range, or square across, whichever is farther from it. What is not the
/// obstacle hides what is behind it, up to 0.3 m past the obstacle.
//= edge.INV-13
#[test]
fn beams_block_what_they_leave_open() {
    let (nan, tan, sin) = (f32::NAN, f32::tan, f32::sin);
    // The obstacle of most: 1 m away, 0.3 rad to the right; the beams beside it pass it.
    let post = (-0.3, 1.0);
    let depth = 0.3_f32.cos();
    let end = depth + 0.3;
    let at = |bearing: f32, range: f32| [range * bearing.cos(), range * bearing.sin()];
    let behind = |x: f32| tan(0.2) * x;
    let table: [Case; 17] = [
        // 0.2 rad to the left: from the field's right end to the beam at 0.1.
        (
            "alone",
            [-0.3, 0.3],
            &[(0.2, 1.0)],
            at(0.2, 1.0),
            Some([-0.2_f32.cos() * tan(0.3), 0.2_f32.cos() * tan(0.1)]),
        ),
        (
            "beside, no farther than a tenth more than its range",
            [1.0, 1.7],
            &[(1.2, 1.0)],
            at(1.2, 1.0),
            Some([1.1 * sin(1.3), 1.5]),
        ),
        (
            "across, at its range",
            [1.2, 1.8],
            &[(1.4, 1.0)],
            at(1.4, 1.0),
            Some([sin(1.5), 1.5]),
        ),
        (
            "across, passed behind the robot",
            [1.4, 1.8],
            &[(1.5, 1.0)],
            at(1.5, 1.0),
            Some([sin(1.6), 1.5]),
        ),
        (
            "behind the robot, passed before it",
            [0.0, 1.7],
            &[(1.6, 1.0)],
            [0.9, -1.0],
            Some([0.0, sin(1.5)]),
        ),
        (
            "behind the robot altogether",
            [0.0, 2.2],
            &[(2.0, 0.5)],
            [0.9, -1.0],
            Some([0.0, 1.5]),
        ),
        // Two beams: what is hardly farther goes on, what is much farther is another thing.
        (
            "the same thing, a bit farther",
            [0.2, 0.3],
            &[(0.2, 1.0), (0.3, 1.05)],
            at(0.2, 1.0),
            Some([sin(0.2), 0.2_f32.cos() * tan(0.3)]),
        ),
        (
            "the same thing, a bit nearer",
            [0.2, 0.3],
            &[(0.2, 1.0), (0.3, 0.95)],
            at(0.2, 1.0),
            Some([sin(0.2), 0.95 * sin(0.3)]),
        ),
        (
            "another thing, farther",
            [0.2, 0.3],
            &[(0.2, 1.0), (0.3, 1.2)],
            at(0.2, 1.0),
            None,
        ),
        // Left of the obstacle another post.
        (
            "what a second post hides",
            [-0.4, 0.6],
            &[post, (0.2, 0.8)],
            at(-0.3, 1.0),
            Some([behind(end), depth * tan(0.6)]),
        ),
        (
            "what the obstacle hides is found out later",
            [-0.4, 0.6],
            &[post, (0.2, 0.8)],
            at(0.2, 0.8),
            Some([
                0.8 * 0.2_f32.cos() * tan(0.3),
                0.8 * 0.2_f32.cos() * tan(0.6),
            ]),
        ),
        (
            "a beam that is not usable",
            [-0.4, 0.6],
            &[post, (0.2, nan)],
            at(-0.3, 1.0),
            Some([behind(end), depth * tan(0.6)]),
        ),
        (
            "a range below zero",
            [-0.4, 0.6],
            &[post, (0.2, -1.0)],
            at(-0.3, 1.0),
            Some([behind(end), depth * tan(0.6)]),
        ),
        (
            "within the way past, 0.3 m",
            [-0.4, 0.6],
            &[post, (0.0, 1.25)],
            at(-0.3, 1.0),
            Some([1.25 * tan(0.1), depth * tan(0.6)]),
        ),
        (
            "beyond it",
            [-0.4, 0.6],
            &[post, (0.0, 1.4)],
            at(-0.3, 1.0),
            Some([-depth * tan(0.2), depth * tan(0.6)]),
        ),
        (
            "heard, not seen: 0.2 m to either side",
            [-0.3, 0.6],
            &[],
            [1.0, 0.1],
            Some([0.3, tan(0.6)]),
        ),
        (
            "heard, not seen, the other way",
            [-0.6, 0.3],
            &[],
            [1.0, 0.05],
            Some([-tan(0.6), -0.15]),
        ),
    ];
    for stage in stages() {
        for (what, field, seen, heard, expected) in &table {
            let look = Look::of(*field, 0.1, seen);
            let found = stage.free_way(&look, [0.0; 3], *heard);
            assert_gap(&found, *expected, 1e-3, &format!("{what}, {stage:?}"));
        }
    }
}

/// A beam that is not usable hides what is along it, for a scanner anywhere: straight across it leaves
/// nothing; looking back, what is between it and the robot's centre.
//= edge.INV-13
#[test]
fn beams_that_are_not_usable_hide_what_is_along_them() {
    let eighth = std::f32::consts::FRAC_PI_4;
    let table = [
        // Straight across, from half a metre to the right of the edge on.
        (0.0, [0.0, -0.5, 0.0], 2.0 * eighth, None),
        // 0.2 m ahead of the centre: 0.2 m to the left where it is level with the centre.
        (0.2, [0.0, 0.0, 0.0], 3.0 * eighth, Some([0.2, 1.5])),
    ];
    for stage in stages() {
        for (x, here, last, expected) in table {
            let mut look = Look::of([0.0, last], eighth / 20.0, &[(last, f32::NAN)]);
            look.placement.x = x;
            let found = stage.free_way(&look, here, [1.0, here[1] - 1.0]);
            assert_gap(&found, expected, 1e-3, &format!("{last}, {stage:?}"));
        }
    }
}

/// Only the faces of the obstacle are known to end where they are seen to. What stands before it, beside
/// it or far behind its front is something else, and hides what is behind it.
//= edge.INV-13
#[test]
fn only_the_faces_of_the_obstacle_end() {
    // A front square across at `depth`, in twentieths of a radian.
    let front = |depth: f32, from: i8, to: i8| {
        (from..=to).map(move |k| (0.05 * f32::from(k), depth / (0.05 * f32::from(k)).cos()))
    };
    let field = [-0.3, 1.0];
    let table = [
        // The front of the obstacle alone: up to the beam that passes it.
        (
            front(1.0, -6, 10).collect::<Vec<_>>(),
            0.55_f32.tan(),
            1.0_f32.tan(),
        ),
        // A pole at 0.15 rad and 0.6 m before a front that ends at 0.1 rad: 0.09 m to the left, which is
        // level with the front. It hides what is up to 1.3 m ahead.
        (
            front(1.0, -6, 2).chain([(0.15, 0.6)]).collect(),
            1.3 * 0.15_f32.tan(),
            1.0_f32.tan(),
        ),
        // Another front beside it, 0.2 m nearer: hides.
        (
            front(1.0, -6, 2).chain(front(0.8, 3, 10)).collect(),
            1.3 * 0.5_f32.tan(),
            1.0_f32.tan(),
        ),
    ];
    for stage in stages() {
        for (k, (seen, right, left)) in table.iter().enumerate() {
            let look = Look::of(field, 0.05, seen);
            let found = stage.free_way(&look, [0.0; 3], [1.0, 0.0]);
            let left = left.min(1.5);
            assert_gap(
                &found,
                Some([*right, left]),
                1e-3,
                &format!("{k}, {stage:?}"),
            );
        }
    }
}

/// The obstacle is what is joined, from the nearest of it within half a safe path of the edge on, and no
/// more than a metre of it. A wall that it stands against is not its front, unless that is as near the
/// edge.
#[test]
fn the_obstacle_is_what_is_joined() {
    let walled = |wall: f64, from: f64, right: f64| {
        vec![
            [[1000.0 * from, 1000.0 * wall], [1000.0, 1000.0 * wall]],
            [[1000.0, 1000.0 * right], [1000.0, 1000.0 * wall]],
        ]
    };
    // World, robot, place heard; along and across.
    let table = [
        // The wall is not within half a safe path of the edge, or not of what is heard.
        (
            walled(0.5, 0.3, 0.1),
            [0.0; 3],
            [1.0, 0.25],
            [1.0, 1.0],
            [0.1, 0.5],
        ),
        (
            walled(0.28, 0.3, -0.5),
            [0.0; 3],
            [1.0, -0.25],
            [1.0, 1.0],
            [-0.5, 0.28],
        ),
        // It is.
        (
            walled(0.28, 0.5, -0.1),
            [0.0; 3],
            [1.0, 0.1],
            [0.5, 1.0],
            [-0.1, 0.28],
        ),
        // A side 2 m long.
        (
            vec![[[1000.0, 0.0], [3000.0, 0.0]]],
            [0.0, -0.4, 0.0],
            [1.1, 0.0],
            [1.0, 2.0],
            [0.0, 0.0],
        ),
        // Slanted away, half a right angle: it ends where it is farthest.
        (
            vec![[[1000.0, 0.0], [1500.0, 500.0]]],
            [0.0, 0.0, 12.0],
            [1.05, 0.0],
            [1.0, 1.5],
            [0.0, 0.5],
        ),
        // 0.09 m behind each other: one thing. 0.11 m: two.
        (
            vec![
                [[1000.0, -200.0], [1000.0, 0.0]],
                [[1090.0, 0.0], [1090.0, 200.0]],
            ],
            [0.0; 3],
            [1.0, -0.1],
            [1.0, 1.09],
            [-0.2, 0.2],
        ),
        (
            vec![
                [[1000.0, -200.0], [1000.0, 0.0]],
                [[1110.0, 0.0], [1110.0, 200.0]],
            ],
            [0.0; 3],
            [1.0, -0.1],
            [1.0, 1.0],
            [-0.2, 0.0],
        ),
        // Of two that are near, the nearer to what is heard.
        (
            vec![
                [[1000.0, -200.0], [1000.0, -50.0]],
                [[1000.0, 150.0], [1000.0, 300.0]],
            ],
            [0.0; 3],
            [1.0, 0.04],
            [1.0, 1.0],
            [-0.2, -0.05],
        ),
    ];
    // How the scanner sits does not matter: m, m, rad.
    let placements = [[0.0; 3], [0.12, -0.03, 0.25]];
    for stage in stages() {
        for (k, (world, here, heard, along, across)) in table.iter().enumerate() {
            for [x, y, heading] in placements {
                let look = Look::around(*here, Placement { x, y, heading }, world);
                let seen = stage.free_way(&look, *here, *heard).obstacle;
                let seen = seen.unwrap_or_else(|| panic!("{k} is seen, {stage:?}"));
                let found = [seen.along, seen.across].concat();
                for (found, expected) in found.iter().zip([along, across].into_iter().flatten()) {
                    assert!(close(*found, *expected, 0.015), "{k}: {seen:?}, {stage:?}");
                }
            }
        }
    }
}

/// It is seen if it is within 0.2 m of what is heard, and so is a thing that touches the scanner.
#[test]
fn what_is_heard_is_seen_within_a_fifth_of_a_metre() {
    for (range, reach, heard, seen) in [
        (0.4, 8.0, 0.2, true),
        (0.4, 8.0, 0.19, false),
        (0.4, 8.0, 0.59, true),
        (0.4, 8.0, 0.61, false),
        (0.0, 8.0, 0.1, true),
        // From where the scanner reaches to, nothing comes back.
        (0.6, 0.61, 0.6, true),
        (0.6, 0.6, 0.6, false),
    ] {
        let mut look = Look::of([0.0, 0.5], 0.1, &[(0.0, range)]);
        look.reach = reach;
        let along = edge([0.0, 0.0], [3.0, 0.0]);
        let found = edge::free_way(
            &look.scan(0),
            &pose(0.0, 0.0, 0.0),
            &along,
            point(heard, 0.0),
            0.6,
        );
        assert_eq!(found.obstacle.is_some(), seen, "{range} {heard}");
    }
}

/// The widest of several stretches is the gap, wherever it is among them, and however what lies between
/// them overlaps.
//= edge.INV-13
#[test]
fn the_widest_stretch_is_the_gap() {
    // Plates square across at 1 m, from and to, mm; the obstacle is the first.
    let wall = |from: f64, to: f64, depth: f64| [[depth, from], [depth, to]];
    let table = [
        (
            vec![wall(-1500.0, -200.0, 1000.0), wall(300.0, 1500.0, 1000.0)],
            [-0.2, 0.3],
        ),
        // To the right of all.
        (
            vec![wall(-200.0, -100.0, 1000.0), wall(200.0, 1400.0, 1000.0)],
            [-1.5, -0.2],
        ),
        // Narrow, wide, middling: 0.2 m, 0.6 m, 0.4 m.
        (
            vec![
                wall(-400.0, -300.0, 1000.0),
                wall(-1500.0, -600.0, 1000.0),
                wall(300.0, 400.0, 1000.0),
                wall(800.0, 1500.0, 1000.0),
            ],
            [-0.3, 0.3],
        ),
        // Middling, narrow, wide: 0.4 m, 0.1 m, 0.57 m; what is left of the narrow one hides up to 1.3 m
        // ahead.
        (
            vec![
                wall(-200.0, -100.0, 1000.0),
                wall(-1500.0, -600.0, 1000.0),
                wall(0.0, 100.0, 1000.0),
                wall(700.0, 1500.0, 1000.0),
            ],
            [0.13, 0.7],
        ),
        // The same, what lies between the narrow and the wide of two plates that overlap, one nearer.
        (
            vec![
                wall(-200.0, -100.0, 1000.0),
                wall(-1500.0, -600.0, 1000.0),
                wall(0.0, 60.0, 1000.0),
                wall(40.0, 100.0, 1150.0),
                wall(700.0, 1500.0, 1000.0),
            ],
            [0.1 * 1.3 / 1.15, 0.7],
        ),
    ];
    for stage in stages() {
        for (k, (world, expected)) in table.iter().enumerate() {
            let look = Look::around([0.0; 3], CENTRE, world);
            let heard = [1.0, (world[0][0][1] / 1000.0) as f32 + 0.05];
            let found = stage.free_way(&look, [0.0; 3], heard);
            assert_gap(&found, Some(*expected), 0.015, &format!("{k}, {stage:?}"));
        }
    }
}

/// A scanner sees as far across as its outermost beams get at the front, wherever it sits and however it
/// is turned; one that looks all round sees everything, one that misses a beam does not.
//= edge.INV-13
#[test]
fn outermost_beams_bound_the_field() {
    let degrees = |d: f32| d.to_radians();
    // Degrees: first and last beam; then where the scanner sits, m, m, degrees; the field at 1 m.
    let table = [
        (
            [-40.0, 52.0],
            [0.0, 0.0, 0.0],
            [-degrees(40.0).tan(), degrees(52.0).tan()],
        ),
        (
            [-40.0, 52.0],
            [0.2, 0.05, 0.0],
            [
                0.05 - 0.8 * degrees(40.0).tan(),
                0.05 + 0.8 * degrees(52.0).tan(),
            ],
        ),
        (
            [-40.0, 52.0],
            [0.2, 0.05, -7.0],
            [
                0.05 - 0.8 * degrees(47.0).tan(),
                0.05 + 0.8 * degrees(45.0).tan(),
            ],
        ),
        // Turned to the left, and all but 80° round: those are ahead, to the right.
        (
            [-140.0, 140.0],
            [0.0, 0.0, 90.0],
            [-degrees(50.0).tan(), 1.5],
        ),
        // Nearly round, from straight ahead on.
        ([0.0, 356.0], [0.0, 0.0, 0.0], [0.0, 1.5]),
        ([0.0, 358.0], [0.0, 0.0, 0.0], [-1.5, 1.5]),
    ];
    for stage in stages() {
        for ([first, last], [x, y, heading], [right, left]) in table {
            let mut look = Look::of([degrees(first), degrees(last)], degrees(2.0), &[]);
            let heading = degrees(heading);
            look.placement = Placement { x, y, heading };
            // What is heard is in the way on one side, then on the other.
            for (heard, gap) in [(left, [right, left - 0.2]), (right, [right + 0.2, left])] {
                let found = stage.free_way(&look, [0.0; 3], [1.0, heard]);
                assert_gap(
                    &found,
                    Some(gap),
                    2e-3,
                    &format!("{first} {last}, {stage:?}"),
                );
            }
        }
        // From 100° to 143° nothing is to be seen of the way, and nothing is free.
        let look = Look::of([1.75, 2.5], 0.05, &[]);
        assert_eq!(stage.free_way(&look, [0.0; 3], [1.0, 0.0]).gap, None);
    }
}

/// Scans that go round more than once are refused, and what is given is what is kept.
#[test]
fn scans_go_round_once() {
    let ranges = [1.0; 65];
    let scan = |beams: usize| Scan::new(CENTRE, 0.0, 0.1, 8.0, &ranges[..beams], Instant(7));
    // 63 steps of 0.1 are 6.3, a step more than once round are 6.38.
    let round = scan(64).expect("once round");
    assert_eq!(
        (round.taken_at(), round.ranges()),
        (Instant(7), &ranges[..64])
    );
    assert_eq!(scan(65).expect_err("more").field, "angle of scan");
    assert_eq!(scan(1).expect_err("one").field, "beams");
}

/// A safe path fits where the gap is as wide, to a tenth of a millimetre that floats round.
#[test]
fn a_gap_is_passable_from_the_width_of_a_safe_path_on() {
    for (right, left, passable) in [
        (-0.2, 0.4, true),
        (-0.2, 0.39995, true),
        (-0.2, 0.3998, false),
        (0.1, 0.9, true),
        (0.5, 0.9, false),
    ] {
        let gap = Gap { right, left };
        assert_eq!(gap.is_passable(0.6), passable, "{gap:?}");
    }
}

// ------------------------------------------------------------------------------------- the law

/// A point of an edge's frame, taken to the world and back, is itself; along the edge is along it, and
/// left is left.
#[test]
fn frames_of_an_edge_agree() {
    let same = |one: Vector2<f32>, other: Vector2<f32>| (one - other).amax() < 1e-5;
    let along = edge([1.0, 2.0], [1.0, 5.0]);
    for (on, world) in [
        ([0.0, 0.0], [1.0, 2.0]),
        ([2.0, 0.0], [1.0, 4.0]),
        ([2.0, 0.5], [0.5, 4.0]),
    ] {
        let [on, world] = [on, world].map(|[x, y]: [f32; 2]| point(x, y));
        assert!(same(along.to_world(on), world));
        assert!(same(along.to_edge(world), on));
    }
    let slanted = edge([-1.0, 0.5], [2.0, 4.5]);
    let on = point(1.25, -0.75);
    assert!(same(slanted.to_edge(slanted.to_world(on)), on));
    assert!(same(slanted.to_world(point(5.0, 0.0)), point(2.0, 4.5)));
}

/// Detection, stop, scan, way round, and back; and a way that is too narrow.
#[test]
fn law_goes_through_its_states() {
    for (free, ends) in [(750.0, State::SubRoute), (590.0, State::Blocked)] {
        let route = vec![edge([0.0, 0.0], [3.0, 0.0])];
        let mut driver = Edge::<_, 8>::new(base(), paper(), ring(), route).expect("a law");
        let mut view = quiet_view();
        view.pose = pose(0.0, 0.0, 0.0);
        view.speed = 0.0;
        view.sonar = [NOTHING; 8];
        assert!(driver.advise(&view).speed > 0.0);
        assert_eq!(driver.state(), State::FollowEdge);
        assert_eq!(Law::<8>::mode(&driver), "follow edge");
        view.sonar[4] = echo(0.35);
        view.speed = 0.2;
        view.now = Instant(100);
        assert_eq!(driver.advise(&view).speed, 0.0);
        assert_eq!(driver.state(), State::Stopped);
        assert_eq!(Law::<8>::mode(&driver), "stopped");
        assert!(matches!(driver.next_event(), Some(Event::Detected(0, _))));
        assert!(!driver.wants_scan());
        view.speed = 0.0;
        view.now = Instant(600);
        driver.advise(&view);
        assert_eq!(driver.state(), State::Measure);
        assert_eq!(Law::<8>::mode(&driver), "measure");
        let ranges = corridor_scan(free, 0.5_f64.to_radians());
        let scan = |taken_at| {
            let first = -FRAC_PI_2 as f32;
            let step = 0.5_f32.to_radians();
            Scan::new(CENTRE, first, step, 8.0, &ranges, Instant(taken_at)).expect("a scan")
        };
        // One from before it stood is not looked at.
        driver.take_scan(&scan(599));
        assert!(driver.wants_scan());
        driver.take_scan(&scan(650));
        assert!(!driver.wants_scan());
        assert!(matches!(driver.next_event(), Some(Event::Measured(0, _))));
        view.now = Instant(700);
        driver.advise(&view);
        assert_eq!(driver.state(), State::FreeWay);
        assert_eq!(Law::<8>::mode(&driver), "free way");
        view.now = Instant(800);
        driver.advise(&view);
        assert_eq!(driver.state(), ends);
        let name = match ends {
            State::SubRoute => "sub-route",
            _ => "blocked",
        };
        assert_eq!(Law::<8>::mode(&driver), name);
        if ends == State::Blocked {
            assert_eq!(driver.next_event(), Some(Event::Blocked(0)));
            driver
                .reroute(vec![edge([0.0, 0.0], [-3.0, 0.0])])
                .expect("a route");
            view.now = Instant(900);
            let advice = driver.advise(&view);
            assert_eq!(driver.state(), State::OffEdge, "it looks the other way");
            assert!(advice.speed == 0.0);
            view.now = Instant(1000);
            assert!(driver.advise(&view).turn_rate != 0.0);
        }
    }
}

/// Something that was there and has left: the robot follows the edge again.
#[test]
fn what_has_left_is_forgotten() {
    let route = vec![edge([0.0, 0.0], [3.0, 0.0])];
    let mut driver = Edge::<_, 8>::new(base(), paper(), ring(), route).expect("a law");
    let mut view = quiet_view();
    view.pose = pose(0.0, 0.0, 0.0);
    view.sonar = [NOTHING; 8];
    driver.advise(&view);
    view.sonar[4] = echo(0.35);
    for now in [100, 200, 300] {
        view.now = Instant(now);
        driver.advise(&view);
    }
    assert_eq!(driver.state(), State::Measure);
    let ranges = vec![f32::INFINITY; 361];
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(CENTRE, first, 0.0087, 8.0, &ranges, Instant(350)).expect("a scan");
    // As long as the sonar hears it, it is there, whatever the laser says.
    driver.take_scan(&scan);
    let mut still_there = driver.clone();
    let mut states = Vec::new();
    for now in [400, 500, 600, 700] {
        view.now = Instant(now);
        still_there.advise(&view);
        states.push(still_there.state());
    }
    assert!(!states.contains(&State::FollowEdge), "{states:?}");
    view.sonar[4] = NOTHING;
    for now in [400, 500, 600] {
        view.now = Instant(now);
        driver.advise(&view);
    }
    assert_eq!(driver.state(), State::FollowEdge);
}

/// Whoever is told to go and stands is held up, but not by what has nothing to do with distance.
#[test]
fn who_is_held_up_measures() {
    for (guard, state) in [
        (None, State::Stopped),
        (Some(StopReason::MotorsDisabled), State::FollowEdge),
    ] {
        let route = vec![edge([0.0, 0.0], [3.0, 0.0])];
        let mut driver = Edge::<_, 8>::new(base(), paper(), ring(), route).expect("a law");
        let mut view = quiet_view();
        view.pose = pose(0.0, 0.0, 0.0);
        view.sonar = [NOTHING; 8];
        view.sonar[1] = echo(0.5);
        view.guard = guard;
        for now in (0..3000).step_by(100) {
            view.now = Instant(now);
            driver.advise(&view);
            assert_eq!(driver.state(), State::FollowEdge);
        }
        view.now = Instant(3100);
        driver.advise(&view);
        assert_eq!(driver.state(), state);
        // What kept it is over: the time before does not count.
        view.guard = None;
        view.now = Instant(3200);
        driver.advise(&view);
        let expected = if state == State::Stopped {
            State::Measure
        } else {
            State::FollowEdge
        };
        assert_eq!(driver.state(), expected);
    }
}

/// Routes with holes are refused, with the number.
#[test]
fn routes_are_checked() {
    let law = |route: Vec<PlannedEdge>| Edge::<_, 8>::new(base(), paper(), ring(), route);
    assert_eq!(
        law(Vec::new()).err().map(|error| error.field),
        Some("edges of the route")
    );
    let holed = vec![edge([0.0, 0.0], [1.0, 0.0]), edge([1.4, 0.0], [2.0, 0.0])];
    let error = law(holed).expect_err("a hole");
    assert_eq!((error.field, error.max), ("step to next edge", 0.3));
    assert!(PlannedEdge::new(point(f32::NAN, 0.0), point(1.0, 0.0)).is_err());
    assert!(PlannedEdge::new(point(0.0, 0.0), point(0.001, 0.0)).is_err());
    let refused = EdgeConfig::new(Parameters {
        slow_speed: 0.3,
        ..PAPER
    });
    assert_eq!(refused.expect_err("faster than fast").field, "slow_speed");
}

/// The gap's sides are no obstacles on the sub-route; what is inside it is one.
#[test]
fn sides_of_the_gap_are_explained() {
    let (ring, half_angle) = (ring(), base().sonar_half_angle);
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let gap = Gap {
        right: -0.3,
        left: 0.3,
    };
    let sonar: [SonarReading; 8] =
        std::array::from_fn(|i| echo([0.17, 0.2, 0.32, 0.4, 0.4, 0.32, 0.2, 0.17][i]));
    let left = edge::unexplained(
        &sonar,
        &ring,
        &pose(1.0, 0.0, 0.0),
        &along,
        &gap,
        half_angle,
    );
    let heard = |i: usize| matches!(left[i], SonarReading::Echo(_));
    assert!(heard(3) && heard(4), "dead ahead is inside");
    assert!(![0, 1, 2, 5, 6, 7].into_iter().any(heard), "{left:?}");
}

// ------------------------------------------------------------------------- the law, tick by tick

/// A law that is shown one view after the other, all in the frame of its first edge.
#[derive(Clone)]
struct Drive {
    stage: Stage,
    law: Edge<Vec<PlannedEdge>, 8>,
    view: View<8>,
}

/// Sonars, and what they hear.
type Heard<'a> = &'a [(usize, SonarReading)];

impl Drive {
    /// Along edges from corner to corner, hearing nothing, moving.
    fn new(stage: Stage, corners: &[[f32; 2]]) -> Self {
        let route = corners.windows(2).map(|pair| stage.line(pair[0], pair[1]));
        let law = Edge::new(base(), paper(), ring(), route.collect()).expect("a law");
        let mut view = quiet_view();
        view.sonar = [NOTHING; 8];
        view.speed = 0.1;
        Self { stage, law, view }
    }

    /// On an edge of 3 m.
    fn on(stage: Stage) -> Self {
        Self::new(stage, &[[0.0, 0.0], [3.0, 0.0]])
    }

    fn hear(&mut self, sonar: usize, reading: SonarReading) {
        self.view.sonar[self.stage.sonar(sonar)] = reading;
    }

    /// What it advises a tenth of a second later: the speed, and the turn as if this were no mirror image.
    fn tick(&mut self, here: [f32; 3]) -> [f32; 2] {
        self.view.now.0 += 100;
        self.view.pose = self.stage.pose(here);
        let advice = self.law.advise(&self.view);
        [advice.speed, self.stage.side * advice.turn_rate]
    }

    fn state(&mut self, here: [f32; 3]) -> State {
        self.tick(here);
        self.law.state()
    }

    /// It advises this speed and a turn to the left by so many degrees, at twice that a second.
    #[track_caller]
    fn assert_advises(&mut self, here: [f32; 3], speed: f32, turn: f32) {
        let found = self.tick(here);
        let expected = [speed, 2.0 * turn.to_radians()];
        assert!(
            close(found[0], expected[0], 1e-3) && close(found[1], expected[1], 4e-3),
            "at {here:?}: {found:?}, expected {expected:?}; {:?}, {:?}",
            self.law.state(),
            self.stage,
        );
    }

    /// What it drives along leads in this direction, degrees, and at this speed. Off by 5° it turns back,
    /// and is slower by as much as that is of `error_max`, radians.
    #[track_caller]
    fn assert_leads(&mut self, at: [f32; 2], course: f32, speed: f32, error_max: f32) {
        let here = |off: f32| [at[0], at[1], course + off];
        let slower = speed * (1.0 - 5.0_f32.to_radians() / error_max);
        self.assert_advises(here(5.0), slower, -5.0);
        self.assert_advises(here(-5.0), slower, 5.0);
        self.assert_advises(here(0.0), speed, 0.0);
    }

    /// Stops for what a sonar hears at a range, stands, is given a scan, and hears `then` when it decides:
    /// the state that this leads to, and what was found.
    fn look(
        &mut self,
        here: [f32; 3],
        (sonar, range): (usize, f32),
        look: &Look,
        then: SonarReading,
    ) -> (State, FreeWay) {
        self.hear(sonar, echo(range));
        assert_eq!(
            self.state(here),
            State::Stopped,
            "{here:?} {:?}",
            self.stage
        );
        self.view.speed = 0.0;
        assert_eq!(self.state(here), State::Measure);
        self.law
            .take_scan(&look.on(&self.stage).scan(self.view.now.0));
        let Some(Event::Measured(0, found)) = self.events().pop() else {
            panic!("it has not measured");
        };
        assert_eq!(self.state(here), State::FreeWay);
        self.hear(sonar, then);
        // On another line than before it does not go on as it went.
        let moves = self.tick(here) != [0.0, 0.0];
        assert_eq!(moves, self.law.state() == State::OffEdge);
        self.hear(sonar, NOTHING);
        self.view.speed = 0.1;
        (self.law.state(), found)
    }

    fn events(&mut self) -> Vec<Event> {
        std::iter::from_fn(|| self.law.next_event()).collect()
    }
}

/// E1, E2 and E4 where something begins or ends: 0.6 m, either side 0.3 m, a threshold that has to be
/// exceeded, and never more than 10·N2.
//= edge.INV-3
#[test]
fn equations_at_their_limits() {
    let config = paper();
    let n1 = |range: f32| edge::nearness(Length::metres(range).expect("a range"), &config);
    for (range, expected) in [
        (0.0, 10.0),
        (0.15, 7.5),
        (0.42, 3.0),
        (0.6, 0.0),
        (0.7, 0.0),
    ] {
        assert!(close(n1(range), expected, 1e-5), "{range}");
    }
    for (distance, expected) in [(0.0, 1.0), (0.1, 0.8), (0.3, 0.4)] {
        for distance in [distance, -distance] {
            let n2 = edge::closeness(distance, &config).expect("within d_max");
            assert!(close(n2, expected, 1e-6), "{distance}");
        }
    }
    assert_eq!(edge::closeness(0.301, &config), None);
    for (cosine, expected) in [(1.0, 2.0), (0.5, 1.0), (0.0, 0.0), (-0.5, 0.0), (1.5, 2.0)] {
        assert!(close(edge::projection(4.0, 0.5, cosine), expected, 1e-6));
    }
    let most = edge::projection(12.0, 0.5, 1.0);
    assert!(most == 5.0 && law::projection_in_range(most, 0.5));
    let (greatest, sonar) = (3.0, 1);
    let judge = |threshold| edge::judge(&[1.0, 3.0, 3.0], None, threshold);
    assert_eq!(judge(3.0), Detection::Clear { greatest });
    // Of equal ones the first.
    assert_eq!(judge(2.999), Detection::Obstacle { sonar, greatest });
    let half = Gap {
        right: -0.65,
        left: 0.65,
    };
    let wide = Parameters {
        corridor_width: 1.3,
        ..PAPER
    };
    assert_eq!(EdgeConfig::new(wide).expect("in range").corridor(), half);
}

/// The actual edge leads from the robot to the edge's end, has no direction within a millimetre of it, and
/// is heard of by whoever sits ahead of the axle and does not look back.
#[test]
fn the_actual_edge_leads_to_the_end() {
    for stage in stages() {
        let along = stage.line([0.0, 0.0], [3.0, 0.0]);
        // 1 m before the end, 0.25 m beside: 14.04° to the right of the edge.
        let actual = ActualEdge::new(&stage.pose([2.0, 0.25, 20.0]), &along).expect("an edge");
        let turn = -(0.25_f32.atan2(1.0).to_degrees() + 20.0);
        let found = stage.side * actual.heading_error().get().to_degrees();
        assert!(close(found, turn, 1e-3), "{found}");
        assert!(close(actual.length, 1.0625_f32.sqrt(), 1e-5));
        assert!(close(stage.side * actual.distance, 0.25, 1e-5));
        let cosines = actual.cosines(&ring());
        for (i, at) in BaseParameters::P3DX.sonars.iter().take(8).enumerate() {
            let expected = (f32::from(at.heading_deg) - turn).to_radians().cos();
            assert!(close(cosines[stage.sonar(i)], expected, 1e-4), "{i}");
        }
    }
    let along = edge([-1.0, 0.0], [0.001, 0.0]);
    assert!(ActualEdge::new(&pose(0.0, 0.0, 0.0), &along).is_some());
    assert!(ActualEdge::new(&pose(0.0002, 0.0, 0.0), &along).is_none());
    // Sonars that sit or look elsewhere: x and y, mm, and degrees; whether they take part.
    let others = [
        (0, 150, 60, true),
        (-10, 150, 60, false),
        (100, 100, 100, false),
    ];
    let mut placements = [CENTRE; 11];
    let front = BaseParameters::P3DX.sonars.iter().take(8);
    let all = front.map(|at| (at.x_mm, at.y_mm, at.heading_deg));
    let all = all.chain(others.iter().map(|(x, y, degrees, _)| (*x, *y, *degrees)));
    for (placement, (x, y, degrees)) in placements.iter_mut().zip(all) {
        *placement = Placement::from_mm_deg(x, y, degrees);
    }
    let ring = Ring::new(&placements, &base()).expect("the ring is good");
    let actual = ActualEdge::new(&pose(0.0, 0.0, 0.0), &edge([0.0, 0.0], [1.0, 1.0]));
    let cosines = actual.expect("an edge").cosines(&ring);
    for ((_, _, degrees, takes_part), cosine) in others.iter().zip(&cosines[8..]) {
        let expected = (f32::from(*degrees) - 45.0).to_radians().cos();
        assert!(close(
            *cosine,
            if *takes_part { expected } else { 0.0 },
            1e-5
        ));
    }
}

/// A planned edge keeps what it was made of.
#[test]
fn an_edge_has_two_ends() {
    let along = edge([-1.0, 0.5], [2.0, 4.5]);
    assert_eq!(
        (along.start(), along.end()),
        (point(-1.0, 0.5), point(2.0, 4.5))
    );
    assert!(close(along.length(), 5.0, 1e-5));
    assert!((along.direction() - point(0.6, 0.8)).amax() < 1e-6);
}

/// M3 as the book's table has it: who moves, what is so, and what follows.
#[test]
fn machine_follows_its_table() {
    use State::{Blocked, Done, FollowEdge, FreeWay, Measure, OffEdge, Rejoin, Stopped, SubRoute};
    let nothing = Situation {
        obstacle: false,
        standing: false,
        finding: None,
        past: false,
        following: false,
        on_edge: false,
        at_end: false,
    };
    let found = |finding| Situation {
        finding: Some(finding),
        ..nothing
    };
    let standing = Situation {
        standing: true,
        ..nothing
    };
    let following = Situation {
        following: true,
        ..nothing
    };
    let on_edge = Situation {
        on_edge: true,
        ..following
    };
    let past = Situation {
        past: true,
        ..nothing
    };
    let at_end = Situation {
        at_end: true,
        ..on_edge
    };
    let table: [(&[State], Situation, State); 13] = [
        (&[Stopped], standing, Measure),
        (&[Measure], found(Finding::Closed), FreeWay),
        (&[FreeWay], found(Finding::Passable), SubRoute),
        (&[FreeWay], found(Finding::Closed), Blocked),
        (&[FreeWay], found(Finding::Gone), OffEdge),
        (&[FreeWay], nothing, Measure),
        (&[SubRoute], past, Rejoin),
        (&[FollowEdge, Rejoin, OffEdge], at_end, Done),
        (&[FollowEdge, Rejoin, OffEdge], on_edge, FollowEdge),
        (&[FollowEdge, Rejoin, OffEdge], nothing, OffEdge),
        (&[FollowEdge], following, FollowEdge),
        (&[Rejoin], following, Rejoin),
        (&[OffEdge], following, OffEdge),
    ];
    for (states, situation, next) in table {
        for state in states {
            assert_eq!(edge::next_state(*state, &situation), next, "{state:?}");
            // What is on the way goes first for whoever moves, and is nothing to whoever rests.
            let obstacle = Situation {
                obstacle: true,
                ..situation
            };
            let expected = if state.at_rest() { next } else { Stopped };
            assert_eq!(edge::next_state(*state, &obstacle), expected, "{state:?}");
        }
    }
    for state in [Stopped, Measure, SubRoute, Blocked, Done] {
        assert_eq!(edge::next_state(state, &following), state);
    }
    for state in [Blocked, Done] {
        for situation in [found(Finding::Passable), on_edge, past, standing] {
            assert_eq!(edge::next_state(state, &situation), state);
        }
    }
}

/// Steering: twice the error a second up to a quarter turn, the speed falls with the error, and whatever
/// is no number is no advice.
//= edge.INV-8
#[test]
fn steering_is_proportional() {
    let config = base();
    for (error, speed, expected) in [
        (0.0, 0.2, [0.2, 0.0]),
        (0.1, 0.2, [0.16, 0.2]),
        (-0.3, 0.2, [0.08, -0.6]),
        (0.5, 0.2, [0.0, 1.0]),
        (-2.0, 0.2, [0.0, -FRAC_PI_2 as f32]),
        (0.25, 5.0, [0.2, 0.5]),
        (0.25, -1.0, [0.0, 0.5]),
        (0.1, f32::NAN, [0.0, 0.0]),
        (f32::NAN, 0.2, [0.0, 0.0]),
        (f32::INFINITY, 0.2, [0.0, 0.0]),
    ] {
        let advice = edge::steer(error, speed, 0.5, &config);
        assert!(
            close(advice.speed, expected[0], 1e-6) && close(advice.turn_rate, expected[1], 1e-6),
            "{error} {speed}: {advice:?}"
        );
        let (speed_max, turn_rate_max) = (config.speed_max, config.turn_rate_max);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            speed_max,
            turn_rate_max
        ));
    }
}

/// On the edge, and while it rejoins it, the robot aims at the point 0.6 m ahead of where it is along it, or
/// at the end; slower where it looks elsewhere, and towards the end.
#[test]
fn the_edge_is_followed() {
    for stage in stages() {
        let mut drive = Drive::on(stage);
        // 0.28 m beside it is too far to follow it, and near enough to rejoin it.
        let aim = |y: f32, ahead: f32| -y.atan2(ahead).to_degrees();
        drive.assert_leads([1.0, 0.28], aim(0.28, 0.6), 0.1, PAPER.heading_error_max);
        assert_eq!(drive.law.state(), State::Rejoin);
        // Nor is it followed before the robot looks along it.
        drive.assert_advises(
            [1.0, 0.1, aim(0.1, 0.6) + 10.0],
            0.1 * (1.0 - 10.0 / 50.0),
            -10.0,
        );
        assert_eq!(drive.law.state(), State::Rejoin);
        drive.assert_advises(
            [1.0, 0.1, aim(0.1, 0.6) + 8.0],
            0.2 * (1.0 - 8.0 / 50.0),
            -8.0,
        );
        assert_eq!(drive.law.state(), State::FollowEdge);
        drive.assert_leads([1.0, 0.1], aim(0.1, 0.6), 0.2, PAPER.heading_error_max);
        drive.assert_leads([1.5, -0.2], aim(-0.2, 0.6), 0.2, PAPER.heading_error_max);
        drive.assert_leads([2.6, -0.1], aim(-0.1, 0.4), 0.2, PAPER.heading_error_max);
        // 0.12 m before the end.
        drive.assert_leads([2.88, 0.01], aim(0.01, 0.12), 0.15, PAPER.heading_error_max);
        assert_eq!(drive.law.state(), State::FollowEdge);
        assert_eq!(drive.state([2.91, 0.0, 0.0]), State::Done);
        assert_eq!(drive.events(), [Event::Covered(0)]);
    }
}

/// An edge ends 0.1 m before its end, and as much more as the robot is beside it, up to 0.3 m; then the next
/// one is followed, from the first place on.
#[test]
fn edges_end_near_their_end() {
    for stage in stages() {
        for (x, y, ended) in [
            (2.88, 0.0, false),
            (2.92, 0.0, true),
            (2.73, -0.15, false),
            (2.77, -0.15, true),
            (2.62, 0.29, true),
            (2.62, 0.31, false),
            (3.5, 0.31, false),
        ] {
            let what = format!("{x} {y} {stage:?}");
            let mut last = Drive::on(stage);
            let state = last.state([x, y, 0.0]);
            assert_eq!(state == State::Done, ended, "{what}");
            let mut drive = Drive::new(stage, &[[0.0, 0.0], [3.0, 0.0], [3.0, 2.0]]);
            drive.tick([x, y, 0.0]);
            assert_eq!(drive.law.current(), usize::from(ended), "{what}");
            let events: &[Event] = if ended { &[Event::Covered(0)] } else { &[] };
            assert_eq!(drive.events(), events, "{what}");
        }
        // Round the corner: the next edge is a quarter turn on, so the robot turns on the spot.
        let mut drive = Drive::new(stage, &[[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, 2.0]]);
        assert_eq!(drive.state([2.8, 0.0, 0.0]), State::FollowEdge);
        assert_eq!(drive.state([2.95, 0.0, 0.0]), State::OffEdge);
        let aim = 0.05_f32.atan2(0.6).to_degrees();
        drive.assert_advises([2.95, 0.0, 60.0], 0.0, 30.0 - aim);
        assert_eq!(drive.state([2.95, 0.0, 85.0]), State::FollowEdge);
        drive.assert_leads([2.95, 0.0], 90.0 - aim, 0.2, PAPER.heading_error_max);
        assert_eq!((drive.law.current(), drive.law.route().len()), (1, 3));
        assert_eq!(drive.state([3.0, 1.95, 90.0]), State::OffEdge);
        assert_eq!(drive.law.current(), 2);
        assert_eq!(drive.state([3.0, 1.95, 178.0]), State::FollowEdge);
        assert_eq!(drive.state([1.05, 2.0, 180.0]), State::Done);
        let covered = [0, 1, 2].map(Event::Covered);
        assert_eq!(drive.events(), covered);
        // Another route begins with its first edge, from where it is.
        let route = vec![stage.line([1.0, 2.0], [-1.0, 2.0])];
        drive.law.reroute(route.clone()).expect("a route");
        assert_eq!((drive.law.current(), drive.law.route()), (0, &route[..]));
        assert_eq!(drive.state([1.05, 2.0, 180.0]), State::FollowEdge);
        let holed = vec![route[0], route[0]];
        let error = drive.law.reroute(holed).expect_err("a hole");
        assert!(close(error.value, 2.0, 1e-5), "{error}");
    }
}

/// Of what has happened the last eight are kept, in order.
#[test]
fn the_last_eight_events_are_kept() {
    let corners: Vec<[f32; 2]> = (0..=10_u8).map(|k| [f32::from(k), 0.0]).collect();
    let stage = stages().next().expect("a stage");
    let mut drive = Drive::new(stage, &corners);
    for corner in &corners[1..] {
        drive.tick([corner[0], 0.0, 0.0]);
    }
    assert_eq!(drive.law.state(), State::Done);
    assert_eq!(drive.events(), [2, 3, 4, 5, 6, 7, 8, 9].map(Event::Covered));
    assert_eq!(drive.law.next_event(), None);
}

/// Off the edge the robot goes back along a leg of its own: half a right angle on, but not before the
/// edge's beginning or beyond its end. It aims 0.3 m ahead on it, and looks along it before it goes.
#[test]
fn the_way_back_is_half_a_right_angle_on() {
    let course =
        |from: [f32; 2], to: [f32; 2]| (to[1] - from[1]).atan2(to[0] - from[0]).to_degrees();
    for stage in stages() {
        for (from, to) in [
            ([1.0, 0.5], 1.5),
            ([1.3, -0.4], 1.7),
            ([-0.8, 0.4], 0.0),
            ([-0.2, 0.5], 0.3),
            ([2.9, 0.5], 3.0),
            ([2.4, -0.5], 2.9),
        ] {
            let mut drive = Drive::on(stage);
            let leads = course(from, [to, 0.0]);
            // Blind until it has a leg.
            assert_eq!(drive.tick([from[0], from[1], leads]), [0.0, 0.0]);
            assert_eq!(drive.law.state(), State::OffEdge);
            drive.assert_leads(from, leads, 0.1, edge::TURNED);
            drive.assert_advises([from[0], from[1], leads + 20.0], 0.0, -20.0);
        }
        // The leg from (1, 0.5) to (1.5, 0) stays the way, 0.0707 m beside it too.
        let mut drive = Drive::on(stage);
        let root = std::f32::consts::FRAC_1_SQRT_2;
        drive.tick([1.0, 0.5, -45.0]);
        drive.tick([1.0, 0.5, -45.0]);
        let ahead = 0.1 * root + 0.3;
        drive.assert_leads(
            [1.1, 0.5],
            course([1.1, 0.5], [1.0 + ahead * root, 0.5 - ahead * root]),
            0.1,
            edge::TURNED,
        );
        // 0.28 m beside it, still.
        let beside = [1.0 + 0.28 * root, 0.5 + 0.28 * root];
        drive.assert_advises(
            [beside[0], beside[1], -60.0],
            0.0,
            course(beside, [1.0 + 0.3 * root, 0.5 - 0.3 * root]) + 60.0,
        );
        // 0.35 m beside it there is a new one.
        drive.assert_leads([1.5, 0.5], -45.0, 0.1, edge::TURNED);
        drive.assert_leads([1.6, 0.4], -45.0, 0.1, edge::TURNED);
        // Near the edge it is left for the edge, which is aimed at 0.6 m ahead.
        drive.assert_advises(
            [1.7, 0.26, -45.0],
            0.0,
            45.0 + course([0.0, 0.26], [0.6, 0.0]),
        );
        assert_eq!(drive.law.state(), State::OffEdge);
        // From beside the beginning the leg is flat: level with its end the robot is still too far off.
        let mut drive = Drive::on(stage);
        drive.tick([-2.0, 0.4, 0.0]);
        drive.tick([-2.0, 0.4, 0.0]);
        let length = 0.4_f32.hypot(2.0);
        let (along, left) = ([2.0 / length, -0.4 / length], [0.4 / length, 2.0 / length]);
        let place = |before: f32| [0, 1].map(|k| 0.29 * left[k] - before * along[k]);
        let [early, late] = [place(0.05), place(0.02)];
        drive.assert_advises(
            [early[0], early[1], -80.0],
            0.0,
            course(early, [0.0, 0.0]) + 80.0,
        );
        drive.assert_leads(late, -45.0, 0.1, edge::TURNED);
    }
}

/// When the robot goes back to following: near the edge, turned along it, and hearing every sonar.
#[test]
fn the_edge_is_followed_from_near_it_on() {
    for stage in stages() {
        let off = |here: [f32; 3]| {
            let mut drive = Drive::on(stage);
            assert_eq!(drive.state(here), State::OffEdge);
            drive
        };
        // It looks 60° aside, or is 0.4 m beside.
        for beginning in [[1.0, 0.0, 60.0], [1.0, 0.4, 0.0]] {
            let drive = off(beginning);
            for (here, reading, state) in [
                ([1.0, 0.0, 0.0], NOTHING, State::FollowEdge),
                ([1.0, 0.26, -23.4], NOTHING, State::FollowEdge),
                ([1.0, 0.28, -25.0], NOTHING, State::OffEdge),
                ([1.0, 0.0, 8.0], NOTHING, State::FollowEdge),
                ([1.0, 0.0, 10.0], NOTHING, State::OffEdge),
                ([1.0, 0.0, 0.0], SonarReading::Stale, State::OffEdge),
                ([1.0, 0.0, 0.0], SonarReading::Invalid, State::OffEdge),
            ] {
                let mut drive = drive.clone();
                drive.hear(2, reading);
                assert_eq!(drive.state(here), state, "{here:?} {stage:?}");
                // Where a sonar is not heard not even a turn is advised.
                assert_eq!(drive.tick(here) != [0.0, 0.0], reading == NOTHING);
            }
        }
        // Following is left for being off the edge where the robot is too far off, looks too far aside,
        // or does not hear.
        for (here, reading, state) in [
            ([1.0, 0.29, 0.0], NOTHING, State::FollowEdge),
            ([1.0, 0.31, 0.0], NOTHING, State::OffEdge),
            ([1.0, 0.0, 49.0], NOTHING, State::FollowEdge),
            ([1.0, 0.0, 51.0], NOTHING, State::OffEdge),
            ([1.0, 0.0, 0.0], SonarReading::Stale, State::OffEdge),
        ] {
            let mut drive = Drive::on(stage);
            assert_eq!(drive.state([1.0, 0.0, 0.0]), State::FollowEdge);
            drive.hear(2, reading);
            assert_eq!(drive.state(here), state, "{here:?} {stage:?}");
        }
    }
}

/// What is detected is handed on as the place where the sonar's vector ends, from the face along the axis;
/// unless the robot looks more than 50° aside.
#[test]
fn the_biggest_valued_point_is_where_the_vector_ends() {
    for stage in stages() {
        for (degrees, sonar, reading, range) in [
            (0.0, 4, echo(0.35), 0.35),
            (25.0, 5, echo(0.3), 0.3),
            (45.0, 6, echo(0.2), 0.2),
            (-45.0, 1, echo(0.2), 0.2),
            (10.0, 3, SonarReading::TooNear, 0.0),
        ] {
            let mut drive = Drive::on(stage);
            drive.tick([1.0, 0.0, 0.0]);
            drive.hear(sonar, reading);
            drive.hear(0, echo(0.5));
            assert_eq!(
                drive.state([1.0, 0.0, degrees]),
                State::Stopped,
                "{degrees} {stage:?}"
            );
            let end = stage.vector_end([1.0, 0.0, degrees], sonar, range);
            let events = drive.events();
            let [Event::Detected(0, found)] = events[..] else {
                panic!("{events:?}");
            };
            assert!((found - end).amax() < 1e-4, "{found} {end} {stage:?}");
        }
        let mut drive = Drive::on(stage);
        drive.tick([1.0, 0.0, 0.0]);
        drive.hear(6, echo(0.2));
        assert_eq!(drive.state([1.0, 0.0, 55.0]), State::OffEdge);
    }
}

/// A corridor from 0.6 m to the right of its edge to `left`, m, and a box in it 1.5 m to 1.7 m along it,
/// from one place to the other across.
fn corridor_with_a_box(left: f64, [from, to]: [f64; 2]) -> Vec<Segment> {
    let wall = |y: f64| [[-1000.0, 1000.0 * y], [5000.0, 1000.0 * y]];
    let mut world = sides([1500.0, 1000.0 * from], [1700.0, 1000.0 * to]);
    world.extend([wall(-0.6), wall(left)]);
    world
}

/// A robot about to go round, and the middle of the gap, m from the edge.
fn on_sub_route(
    stage: Stage,
    length: f32,
    here: [f32; 3],
    heard: (usize, f32),
    world: &[Segment],
) -> (Drive, f32) {
    let mut drive = Drive::new(stage, &[[0.0, 0.0], [length, 0.0]]);
    let look = Look::around(here, CENTRE, world);
    let (state, found) = drive.look(here, heard, &look, echo(heard.1));
    assert!(law::finding_decides(
        found.passable,
        state == State::SubRoute
    ));
    assert_eq!(state, State::SubRoute, "{found:?}");
    let gap = found.gap.expect("a gap");
    (drive, stage.side * gap.middle())
}

/// The way round: to the middle of the gap, 0.3 m before the front, or where the robot is if that is farther;
/// along the middle to 0.3 m behind what is seen, or to the end of the edge. Each leg is left 0.03 m before
/// its end, and the robot slows down for it.
//= edge.INV-12
#[test]
fn the_sub_route_leads_through_the_gap() {
    // The gap is 0.1 to 0.8. Without the box there are the two walls.
    let world = corridor_with_a_box(0.8, [-0.6, 0.1]);
    let empty = &world[4..];
    let from = [1.0, 0.0, 0.0];
    let table = [
        // Length of the edge, place, what is heard, world; middle; along the edge: where the leg to the
        // middle ends, and the one along it.
        (3.0, from, (4, 0.35), &world[..], 0.45, 1.2, 1.8),
        (1.65, from, (4, 0.35), &world[..], 0.45, 1.2, 1.65),
        (3.0, [1.3, 0.0, 0.0], (4, 0.05), &world[..], 0.45, 1.3, 1.8),
        // Only heard, 0.51 m ahead and 0.088 m to the right: the gap begins 0.2 m from that.
        (3.0, from, (4, 0.35), empty, 0.456, 1.210_68, 1.810_68),
        (3.0, [1.0, -0.1, 0.0], (4, 0.35), &world[..], 0.45, 1.2, 1.8),
    ];
    for stage in stages() {
        for (length, here, heard, world, middle, enter, leave) in table {
            let (mut drive, lane) = on_sub_route(stage, length, here, heard, world);
            let what = format!("{length} {here:?} {stage:?}");
            assert!(close(lane, middle, 0.004), "{what}: {lane}");
            let [x, y, _] = here;
            let (dx, dy) = (enter - x, lane - y);
            let whole = dx.hypot(dy);
            let before = |left: f32| [enter - left * dx / whole, lane - left * dy / whole];
            let course = dy.atan2(dx).to_degrees();
            drive.assert_leads([x, y], course, 0.1, edge::TURNED);
            drive.assert_leads(before(0.2), course, 0.1, edge::TURNED);
            drive.assert_leads(before(0.05), course, 0.08, edge::TURNED);
            // It is now the other leg's turn, which is aimed at 0.3 m ahead.
            let [_, short] = before(0.02);
            let aim = (lane - short).atan2(0.3).to_degrees();
            drive.assert_leads(before(0.02), aim, 0.1, edge::TURNED);
            let aim = (-0.06_f32).atan2(0.3).to_degrees();
            drive.assert_leads([enter + 0.1, lane + 0.06], aim, 0.1, edge::TURNED);
            drive.assert_advises([leave - 0.04, lane, 0.0], 0.07, 0.0);
            assert_eq!(drive.law.state(), State::SubRoute, "{what}");
            assert_eq!(drive.tick([leave - 0.02, lane, 0.0]), [0.0, 0.0]);
            assert_eq!(drive.law.state(), State::Rejoin, "{what}");
            assert_eq!(drive.state([leave, lane, 0.0]), State::OffEdge, "{what}");
        }
        // An edge that ends before the front: what is beyond its end is not driven.
        let (mut drive, lane) = on_sub_route(stage, 1.15, from, (4, 0.35), &world);
        assert_eq!(drive.state([1.19, lane - 0.05, 66.0]), State::SubRoute);
        assert_eq!(drive.state([1.19, lane - 0.02, 66.0]), State::Rejoin);
        // The robot is 0.04 m from the middle: too little for a leg. The box's side is seen to 1.7 m.
        let world = corridor_with_a_box(0.56, [-0.6, -0.06]);
        let (mut drive, lane) = on_sub_route(stage, 3.0, [1.2, 0.21, 0.0], (4, 0.3), &world);
        assert!(close(lane, 0.25, 0.004), "{lane} {stage:?}");
        let aim = (lane - 0.21).atan2(0.3).to_degrees();
        drive.assert_leads([1.2, 0.21], aim, 0.1, edge::TURNED);
        assert_eq!(drive.state([1.95, lane, 0.0]), State::SubRoute);
        assert_eq!(drive.state([1.98, lane, 0.0]), State::Rejoin);
    }
}

/// The leg past an obstacle goes on for 0.3 m beyond the last place where a sonar that looks across hears
/// it, within 0.1 m of the gap's side that is the obstacle's.
#[test]
fn the_way_past_is_as_long_as_the_obstacle_is_heard() {
    // The box is left of the edge's middle, and right of the gap's, which is 0.3 to 1.
    let world = corridor_with_a_box(1.0, [-0.1, 0.3]);
    for stage in stages() {
        // The faces across are 0.136 m from the centre; so the side is 0.214 m from the right one.
        for (sonar, range, x, end) in [
            (7, 0.214, 1.6, 1.9),
            (7, 0.13, 1.6, 1.9),
            (7, 0.3, 1.6, 1.9),
            (7, 0.1, 1.6, 1.8),
            (7, 0.33, 1.6, 1.8),
            // The wall on the other side, which is as far.
            (0, 0.214, 1.6, 1.8),
            // The side as well, but not heard across.
            (6, 0.3, 1.6, 1.8),
            // Earlier it is no news.
            (7, 0.214, 1.3, 1.8),
        ] {
            let here = [1.0, 0.0, 0.0];
            let (mut drive, lane) = on_sub_route(stage, 3.0, here, (4, 0.35), &world);
            assert_eq!(drive.state([1.22, lane, 0.0]), State::SubRoute);
            drive.hear(sonar, echo(range));
            let what = format!("{sonar} {range} {stage:?}");
            assert_eq!(drive.state([x, lane, 0.0]), State::SubRoute, "{what}");
            drive.hear(sonar, NOTHING);
            assert_eq!(
                drive.state([end - 0.05, lane, 0.0]),
                State::SubRoute,
                "{what}"
            );
            drive.assert_advises([end - 0.05, lane, 0.0], 0.08, 0.0);
            assert_eq!(
                drive.state([end - 0.02, lane, 0.0]),
                State::Rejoin,
                "{what}"
            );
        }
        // A wide box on the left, up to the wall, of which the side is seen to 1.7 m.
        let world = corridor_with_a_box(2.4, [0.2, 2.4]);
        let (mut drive, lane) = on_sub_route(stage, 3.0, [1.0, 0.0, 0.0], (3, 0.35), &world);
        assert_eq!(drive.state([1.22, lane, 0.0]), State::SubRoute);
        // Its side is 0.4 m from the middle of the gap.
        drive.hear(0, echo(0.4 - 0.136));
        assert_eq!(drive.state([1.8, lane, 0.0]), State::SubRoute);
        drive.hear(0, NOTHING);
        assert_eq!(drive.state([2.05, lane, 0.0]), State::SubRoute);
        assert_eq!(drive.state([2.08, lane, 0.0]), State::Rejoin);
    }
}

/// On the way round the sides of the gap are known, and stop nobody; what is inside it does, and so does a
/// leg that is 0.3 m off.
#[test]
fn the_gap_is_watched_on_the_way_through() {
    let world = corridor_with_a_box(0.8, [-0.6, 0.1]);
    for stage in stages() {
        let here = [1.0, 0.0, 0.0];
        let (mut drive, lane) = on_sub_route(stage, 3.0, here, (4, 0.35), &world);
        assert_eq!(drive.state([1.22, lane, 0.0]), State::SubRoute);
        // The side is 0.23 m to the right of the face, as far as its cone reaches: a projection of 3.7.
        for (beside, sonar, range, state) in [
            (0.0, 6, 0.25, State::SubRoute),
            (0.0, 6, 0.15, State::Stopped),
            (0.0, 3, 0.35, State::Stopped),
            (0.29, 0, 1.0, State::SubRoute),
            (0.31, 0, 1.0, State::Stopped),
            (-0.29, 0, 1.0, State::SubRoute),
            (-0.31, 0, 1.0, State::Stopped),
        ] {
            let mut drive = drive.clone();
            drive.hear(sonar, echo(range));
            let found = drive.state([1.4, lane + beside, 0.0]);
            assert_eq!(found, state, "{beside} {sonar} {range} {stage:?}");
        }
    }
}

/// Whoever has looked at the same place four times, and has not got 0.3 m on, takes it for blocked, whatever
/// there is to be seen; on another route, or farther on, it counts anew.
#[test]
fn four_looks_are_enough() {
    let seen = Look::of([-1.5, 1.5], 0.1, &[]);
    for stage in stages() {
        for (on, first) in [(0.28, State::Blocked), (0.32, State::OffEdge)] {
            let mut drive = Drive::on(stage);
            let mut look = |x: f32| drive.look([x, 0.0, 0.0], (4, 0.35), &seen, NOTHING).0;
            for _ in 0..4 {
                assert_eq!(look(1.0), State::OffEdge);
            }
            assert_eq!(look(1.0 + on), first, "{stage:?}");
            if first == State::OffEdge {
                for _ in 0..3 {
                    assert_eq!(look(1.0), State::OffEdge);
                }
                assert_eq!(look(1.0), State::Blocked);
            }
            assert_eq!(drive.events(), [Event::Blocked(0)]);
            let route = vec![stage.line([0.0, 0.0], [3.0, 0.0])];
            drive.law.reroute(route).expect("a route");
            let (state, _) = drive.look([1.0, 0.0, 0.0], (4, 0.35), &seen, NOTHING);
            assert_eq!(state, State::OffEdge);
        }
        // A look at what is only heard: gone if no sonar hears it, and every sonar is heard.
        for (reading, state) in [
            (NOTHING, State::OffEdge),
            (echo(0.35), State::SubRoute),
            (SonarReading::Stale, State::SubRoute),
        ] {
            let mut drive = Drive::on(stage);
            let (found, _) = drive.look([1.0, 0.0, 0.0], (4, 0.35), &seen, reading);
            assert_eq!(found, state, "{reading:?} {stage:?}");
        }
    }
}

/// Held up is who was told to go and has stood for 3 s: by what is nearest and most along the way, a tenth of
/// a metre and the range over the cosine.
#[test]
fn what_holds_up_is_near_and_ahead() {
    let near = SonarReading::TooNear;
    let table: [(f32, Heard, Option<usize>); 6] = [
        // (0.1 + 0.5)/cos 50° = 0.93, (0.1 + 0.8)/cos 10° = 0.91.
        (0.0, &[(1, echo(0.5)), (3, echo(0.8))], Some(3)),
        (0.0, &[(3, echo(0.8)), (6, echo(0.5))], Some(3)),
        // 0.86 and 0.91.
        (0.0, &[(1, echo(0.45)), (3, echo(0.8))], Some(1)),
        // 0.1/cos 75° = 0.39, 0.6/cos 5° = 0.6.
        (-15.0, &[(0, near), (4, echo(0.5))], Some(0)),
        // It is not ahead.
        (5.0, &[(0, echo(0.3))], None),
        (0.0, &[], None),
    ];
    for stage in stages() {
        for (degrees, heard, expected) in table {
            let here = [1.0, 0.0, degrees];
            let mut drive = Drive::on(stage);
            for (sonar, reading) in heard {
                drive.hear(*sonar, *reading);
            }
            drive.view.speed = 0.0;
            // The first time it is told, then it is seen to stand.
            for _ in 0..31 {
                drive.tick(here);
                assert!(!drive.law.state().at_rest(), "{heard:?} {stage:?}");
            }
            let stopped = drive.state(here) == State::Stopped;
            assert_eq!(stopped, expected.is_some(), "{heard:?} {stage:?}");
            let Some(sonar) = expected else {
                continue;
            };
            let range = match drive.view.sonar[stage.sonar(sonar)] {
                SonarReading::Echo(range) => range.get(),
                _ => 0.0,
            };
            let end = stage.vector_end(here, sonar, range);
            let events = drive.events();
            let [Event::HeldUp(0, found)] = events[..] else {
                panic!("{events:?}");
            };
            assert!((found - end).amax() < 1e-4, "{found} {end} {stage:?}");
        }
        // Not who moves, or turns, or was not told to go.
        let here = [1.0, 0.0, 0.0];
        for (speed, turn_rate, held) in [
            (0.1, 0.0, false),
            (-0.1, 0.0, false),
            (0.0, 0.1, false),
            (0.0, -0.1, false),
            (0.004, -0.015, true),
        ] {
            let mut drive = Drive::on(stage);
            drive.hear(1, echo(0.5));
            (drive.view.speed, drive.view.turn_rate) = (speed, turn_rate);
            for _ in 0..32 {
                drive.tick(here);
            }
            assert_eq!(
                drive.law.state() == State::Stopped,
                held,
                "{speed} {turn_rate}"
            );
        }
        let mut drive = Drive::on(stage);
        drive.hear(1, echo(0.5));
        drive.hear(7, SonarReading::Stale);
        drive.view.speed = 0.0;
        for _ in 0..40 {
            drive.tick(here);
        }
        drive.hear(7, NOTHING);
        for _ in 0..31 {
            assert_eq!(drive.state(here), State::FollowEdge);
        }
        assert_eq!(drive.state(here), State::Stopped);
    }
    // Nor by what is behind, if there are sonars that hear it.
    let route = vec![edge([0.0, 0.0], [3.0, 0.0])];
    let mut law = Edge::<_, 16>::new(base(), paper(), ring_of(), route).expect("a law");
    let mut view = quiet_view_of();
    view.sonar = [NOTHING; 16];
    view.sonar[11] = echo(0.3);
    for now in (0..4000).step_by(100) {
        view.now = Instant(now);
        law.advise(&view);
        assert_eq!(law.state(), State::FollowEdge);
    }
}

/// A robot stands that neither drives nor turns, and is given a scan from since then, once.
#[test]
fn a_scan_is_from_since_the_robot_stands() {
    let seen = Look::of([-1.5, 1.5], 0.1, &[]);
    let here = [1.0, 0.0, 0.0];
    for (speed, turn_rate, next) in [
        (0.1, 0.0, State::Stopped),
        (-0.006, 0.0, State::Stopped),
        (0.0, 0.1, State::Stopped),
        (0.0, -0.03, State::Stopped),
        (0.004, 0.01, State::Measure),
    ] {
        let stage = stages().next().expect("a stage");
        let mut drive = Drive::on(stage);
        drive.hear(4, echo(0.35));
        assert_eq!(drive.state(here), State::Stopped);
        (drive.view.speed, drive.view.turn_rate) = (speed, turn_rate);
        assert_eq!(drive.state(here), next, "{speed} {turn_rate}");
    }
    let mut drive = Drive::on(stages().next().expect("a stage"));
    drive.hear(4, echo(0.35));
    drive.tick(here);
    drive.view.speed = 0.0;
    // It stands, is pushed, and stands again.
    assert_eq!(drive.state(here), State::Measure);
    let before = drive.view.now.0;
    drive.view.speed = 0.1;
    drive.tick(here);
    drive.view.speed = 0.0;
    drive.tick(here);
    let since = drive.view.now.0;
    drive.tick(here);
    for (taken_at, taken) in [
        (before, false),
        (since - 1, false),
        (since, true),
        (since, false),
    ] {
        assert_eq!(drive.law.wants_scan(), taken || taken_at < since);
        drive.law.take_scan(&seen.scan(taken_at));
        let measured = drive.events();
        let measured = measured
            .iter()
            .any(|event| matches!(event, Event::Measured(..)));
        assert_eq!(measured, taken, "{taken_at}");
    }
}
