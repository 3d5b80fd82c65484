//! Bytes as arguments of every public function of `edge`, and as what S4's law gets to see.

use super::bytes::Bytes;
use nalgebra::Vector2;
use sidestep::arcos::BaseParameters;
use sidestep::config::Config;
use sidestep::edge::{
    self, ActualEdge, Detection, Edge, EdgeConfig, Finding, PAPER, Parameters, PlannedEdge, Scan,
    Situation, State,
};
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarReading, SonarSample};
use sidestep::preset;
use sidestep::quantity::{Instant, Length};
use sidestep::ring::{Placement, Ring};
use sidestep::view::{Memory, Pose};
use sidestep_spec::edge as law;

/// Ticks of the law at most.
const TICKS: usize = 64;

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let parameters = if bytes.truth() {
        Parameters {
            range_max: bytes.number(),
            distance_max: bytes.number(),
            threshold: bytes.number(),
            corridor_width: bytes.number(),
            safe_path_width: bytes.number(),
            heading_error_max: bytes.number(),
            end_distance: bytes.number(),
            look_ahead: bytes.number(),
            speed: bytes.number(),
            slow_speed: bytes.number(),
            held_time: bytes.number(),
        }
    } else {
        PAPER
    };
    let config = EdgeConfig::new(parameters)
        .unwrap_or_else(|_| EdgeConfig::new(PAPER).expect("the paper's numbers"));
    match bytes.u8() % 4 {
        0 => equations(&config, &mut bytes),
        1 => machine(&mut bytes),
        2 => free_way(&config, &mut bytes),
        _ => drive(&config, &mut bytes),
    }
}

fn base() -> Config {
    Config::new(preset::CORRIDOR_BASE).expect("the preset is good")
}

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

fn point(bytes: &mut Bytes) -> Vector2<f32> {
    Vector2::new(bytes.number(), bytes.number())
}

fn reading(bytes: &mut Bytes) -> SonarReading {
    match bytes.u8() {
        0..=0xBF => SonarReading::Echo(bytes.length()),
        0xC0..=0xDF => SonarReading::NoEcho(bytes.length()),
        0xE0..=0xEF => SonarReading::TooNear,
        0xF0..=0xF7 => SonarReading::Stale,
        0xF8..=0xFF => SonarReading::Invalid,
    }
}

/// The range of what a sonar hears, none if it hears nothing.
fn heard(reading: &SonarReading) -> Option<Length> {
    match reading {
        SonarReading::Echo(range) => Some(*range),
        SonarReading::TooNear => Some(Length::ZERO),
        _ => None,
    }
}

/// E1 to E4 and the detector.
fn equations(config: &EdgeConfig, bytes: &mut Bytes) {
    let (sonar, cosines): ([SonarReading; 4], [f32; 4]) = (
        std::array::from_fn(|_| reading(bytes)),
        std::array::from_fn(|_| bytes.number()),
    );
    let distance = bytes.number();
    let closeness = edge::closeness(distance, config);
    assert!(law::closeness_in_range(
        closeness,
        distance,
        config.distance_max
    ));
    let mut projections = Vec::new();
    for (reading, cosine) in sonar.iter().zip(&cosines) {
        let Some(range) = heard(reading) else {
            continue;
        };
        let nearness = edge::nearness(range, config);
        assert!(law::nearness_in_range(
            nearness,
            range.get(),
            config.range_max
        ));
        if let Some(closeness) = closeness {
            let projection = edge::projection(nearness, closeness, *cosine);
            assert!(law::projection_in_range(projection, closeness));
            assert!(law::far_is_harmless(
                projection,
                range.get(),
                config.range_max,
                config.threshold
            ));
            projections.push(projection);
        }
    }
    let detection = edge::detect(&sonar, &cosines, distance, config);
    let silent =
        |reading: &SonarReading| matches!(reading, SonarReading::Stale | SonarReading::Invalid);
    assert!(law::blind_is_not_clear(
        matches!(detection, Detection::Clear { .. }),
        distance,
        config.distance_max,
        !sonar.iter().any(silent)
    ));
    let reported = match detection {
        Detection::Obstacle { greatest, .. } => Some(greatest),
        _ => None,
    };
    assert!(
        closeness.is_none() || law::obstacle_is_greatest(reported, &projections, config.threshold)
    );
    let inside: [SonarReading; 4] = std::array::from_fn(|_| reading(bytes));
    let on_the_edge: [f32; 4] = std::array::from_fn(|i| {
        heard(&inside[i]).map_or(0.0, |range| {
            edge::projection(edge::nearness(range, config), 1.0, cosines[i])
        })
    });
    let detection = edge::detect_inside(&sonar, &inside, &cosines, distance, config);
    let obstacle = matches!(detection, Detection::Obstacle { .. });
    assert!(law::inside_counts_in_full(
        obstacle,
        &on_the_edge,
        config.threshold
    ));
    let base = base();
    let advice = edge::steer(
        bytes.number(),
        bytes.number(),
        config.heading_error_max,
        &base,
    );
    assert!(law::advice_in_range(
        advice.speed,
        advice.turn_rate,
        base.speed_max,
        base.turn_rate_max
    ));
}

/// M3 through any sequence of situations.
fn machine(bytes: &mut Bytes) {
    let mut state = State::EACH[usize::from(bytes.u8() % 9)];
    for _ in 0..TICKS {
        if bytes.is_empty() {
            break;
        }
        let flags = bytes.u8();
        let finding = match bytes.u8() % 4 {
            0 => Some(Finding::Passable),
            1 => Some(Finding::Closed),
            2 => Some(Finding::Gone),
            _ => None,
        };
        let situation = Situation {
            obstacle: flags & 1 != 0,
            standing: flags & 2 != 0,
            finding,
            past: flags & 4 != 0,
            following: flags & 8 != 0,
            on_edge: flags & 16 != 0,
            at_end: flags & 0xE0 == 0xE0,
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
        let wish = Advice {
            speed: bytes.number(),
            turn_rate: bytes.number(),
        };
        let advice = edge::permitted(next, true, wish);
        assert!(law::rests(next.at_rest(), advice.speed, advice.turn_rate));
        state = next;
    }
}

/// Any scan, at any pose, on any edge.
fn free_way(config: &EdgeConfig, bytes: &mut Bytes) {
    let (Ok(along), here) = (
        PlannedEdge::new(point(bytes), point(bytes)),
        Pose {
            position: Vector2::new(bytes.length().get(), -bytes.length().get()),
            heading: bytes.angle(),
        },
    ) else {
        return;
    };
    let heard = here.to_world(Vector2::new(bytes.share(), bytes.share() - 0.5));
    let placement = Placement {
        x: bytes.number(),
        y: bytes.number(),
        heading: bytes.number(),
    };
    let (first, step, reach) = (bytes.number(), 0.2 * bytes.share(), 10.0 * bytes.share());
    let ranges: Vec<f32> = (0..64).map(|_| bytes.number()).collect();
    let Ok(scan) = Scan::new(placement, first, step, reach, &ranges, Instant(0)) else {
        return;
    };
    if let Some(actual) = ActualEdge::new(&here, &along) {
        assert!(actual.distance.is_finite() && actual.length >= 0.0);
    }
    let found = edge::free_way(&scan, &here, &along, heard, config.safe_path_width);
    let gap = found.gap.map_or([0.0; 2], |gap| [gap.right, gap.left]);
    assert!(law::gap_is_free(
        gap[0],
        gap[1],
        found.passable,
        config.safe_path_width,
        &[]
    ));
}

/// The law behind the view, with observations, scans and routes as the bytes have them.
fn drive(config: &EdgeConfig, bytes: &mut Bytes) {
    let (base, ring) = (base(), ring());
    let mut corner = || Vector2::new(4.0 * bytes.share(), 4.0 * bytes.share());
    let corners = [corner(), corner(), corner()];
    let route: Vec<PlannedEdge> = corners
        .windows(2)
        .filter_map(|pair| PlannedEdge::new(pair[0], pair[1]).ok())
        .collect();
    let Ok(mut driver) = Edge::<_, 8>::new(base, *config, ring, route.clone()) else {
        return;
    };
    let mut memory = Memory::<8>::default();
    let mut now = 0;
    for _ in 0..TICKS {
        if bytes.is_empty() {
            break;
        }
        now += u64::from(bytes.u8()) * 8;
        let observation = Observation {
            now: Instant(now),
            sonar: std::array::from_fn(|_| {
                let range = 5.0 * bytes.share();
                Some(SonarSample {
                    range: if bytes.u8() == 0xFF {
                        bytes.number()
                    } else {
                        range
                    },
                    taken_at: Instant(now),
                })
            }),
            odometry: Some(OdometrySample {
                x: 4.0 * bytes.share(),
                y: 4.0 * bytes.share(),
                heading: bytes.number(),
                speed: if bytes.truth() { 0.0 } else { bytes.number() },
                turn_rate: 0.0,
                taken_at: Instant(now),
            }),
            sighting: None,
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
        };
        let Ok(view) = memory.update(&observation, Vector2::new(1.0, 0.0), &ring, &base) else {
            continue;
        };
        let advice = driver.advise(&view);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            base.speed_max,
            base.turn_rate_max
        ));
        assert!(law::rests(
            driver.state().at_rest(),
            advice.speed,
            advice.turn_rate
        ));
        if driver.wants_scan() {
            let ranges: [f32; 32] = std::array::from_fn(|_| bytes.number());
            let placement = Placement {
                x: 0.0,
                y: 0.0,
                heading: 0.0,
            };
            let scan = Scan::new(placement, -1.5, 0.1, 8.0, &ranges, Instant(now));
            driver.take_scan(&scan.expect("a scan"));
        }
        if driver.state() == State::Blocked {
            driver.reroute(route.clone()).expect("the same route");
        }
        while driver.next_event().is_some() {}
    }
}
