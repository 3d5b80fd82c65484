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

/// The front ring of a P3-DX.
fn ring() -> Ring<8> {
    let mut placements = [Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    }; 8];
    for (placement, at) in placements.iter_mut().zip(BaseParameters::P3DX.sonars) {
        *placement = Placement::from_mm_deg(at.x_mm, at.y_mm, at.heading_deg);
    }
    Ring::new(&placements, &base()).expect("the ring is good")
}

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

fn echo(range: f32) -> SonarReading {
    Length::metres(range).map_or(SonarReading::Invalid, SonarReading::Echo)
}

/// A view in which nothing is wrong and nothing near.
fn quiet_view() -> View<8> {
    let observation = common::in_order(0, [5.0; 8]);
    sidestep::view::Memory::default()
        .update(&observation, point(3.0, 0.0), &ring(), &base())
        .expect("nothing is wrong")
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

    //= edge.INV-15
    #[test]
    fn sides_are_explained_wherever_they_are_heard(
        (x, y, degrees) in (0.0_f32..3.0, -0.5_f32..0.5, -180.0_f32..180.0),
        ranges in prop::array::uniform8(0.05_f32..1.5),
        (right, left) in (-1.0_f32..-0.2, 0.2_f32..1.0),
        half_angle in 0.02_f32..0.5,
    ) {
        let along = edge([0.0, 0.0], [3.0, 0.0]);
        let here = pose(x, y, degrees);
        let ring = ring();
        let rest = edge::unexplained(
            &ranges.map(echo),
            &ring,
            &here,
            &along,
            &Gap { right, left },
            half_angle,
        );
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
                    Placement { x: 0.0, y: 0.0, heading: 0.0 },
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
            Placement { x: 0.0, y: 0.0, heading: 0.0 },
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
        let beams = 721;
        let ranges: Vec<f32> = (0..beams)
            .map(|i| {
                let angle = heading.to_radians() - FRAC_PI_2 + f64::from(i) * step;
                cast([0.0, lateral], angle, &world).map_or(f32::INFINITY, |mm| (mm / 1000.0) as f32)
            })
            .collect();
        let scan = Scan::new(
            Placement { x: 0.0, y: 0.0, heading: 0.0 },
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
        1 => Just(SonarReading::NoEcho(Length::MAX)),
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
    let mut placements = [Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    }; 16];
    for (placement, at) in placements.iter_mut().zip(BaseParameters::P3DX.sonars) {
        *placement = Placement::from_mm_deg(at.x_mm, at.y_mm, at.heading_deg);
    }
    let all = Ring::new(&placements, &base()).expect("the ring is good");
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
                    range.map_or(SonarReading::NoEcho(Length::MAX), |mm| {
                        echo((mm / 1000.0) as f32)
                    })
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
        let mut sonar = [SonarReading::NoEcho(Length::MAX); 8];
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
                range.map_or(SonarReading::NoEcho(Length::MAX), |mm| {
                    echo((mm / 1000.0) as f32)
                })
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
    (0..beams)
        .map(|i| {
            let angle = -FRAC_PI_2 + f64::from(i) * step;
            cast([0.0, 0.0], angle, &world).map_or(f32::INFINITY, |mm| (mm / 1000.0) as f32)
        })
        .collect()
}

fn measure(free: f64, step_deg: f64) -> FreeWay {
    let step = step_deg.to_radians();
    let ranges = corridor_scan(free, step);
    let placement = Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(placement, first, step as f32, 8.0, &ranges, Instant(0)).expect("a scan");
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
    let placement = Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let look = |ranges: &[f32], first: f64| {
        let scan = Scan::new(
            placement,
            first as f32,
            step as f32,
            8.0,
            ranges,
            Instant(0),
        );
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
        let ranges: Vec<f32> = (0..beams)
            .map(|i| {
                let angle = -half.to_radians() + f64::from(i) * step;
                let hit = cast([0.0, 1000.0 * aside], angle, &world);
                hit.map_or(f32::INFINITY, |mm| (mm / 1000.0) as f32)
            })
            .collect();
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
    let ranges: Vec<f32> = (0..361)
        .map(|i| {
            let angle = -FRAC_PI_2 + f64::from(i) * step;
            cast([0.0, 0.0], angle, &world).map_or(f32::INFINITY, |mm| (mm / 1000.0) as f32)
        })
        .collect();
    let placement = Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(placement, first, step as f32, 8.0, &ranges, Instant(0)).expect("a scan");
    let along = edge([0.0, 0.0], [3.0, 0.0]);
    let found = edge::free_way(&scan, &pose(0.0, 0.0, 0.0), &along, point(0.5, 0.0), 0.6);
    assert_eq!(found.obstacle, None);
    assert!(!found.passable, "{found:?}");
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
        view.sonar = [SonarReading::NoEcho(Length::MAX); 8];
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
        let placement = Placement {
            x: 0.0,
            y: 0.0,
            heading: 0.0,
        };
        let scan = |taken_at| {
            let first = -FRAC_PI_2 as f32;
            let step = 0.5_f32.to_radians();
            Scan::new(placement, first, step, 8.0, &ranges, Instant(taken_at)).expect("a scan")
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
    view.sonar = [SonarReading::NoEcho(Length::MAX); 8];
    driver.advise(&view);
    view.sonar[4] = echo(0.35);
    for now in [100, 200, 300] {
        view.now = Instant(now);
        driver.advise(&view);
    }
    assert_eq!(driver.state(), State::Measure);
    let ranges = vec![f32::INFINITY; 361];
    let placement = Placement {
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };
    let first = -FRAC_PI_2 as f32;
    let scan = Scan::new(placement, first, 0.0087, 8.0, &ranges, Instant(350)).expect("a scan");
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
    view.sonar[4] = SonarReading::NoEcho(Length::MAX);
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
        view.sonar = [SonarReading::NoEcho(Length::MAX); 8];
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
