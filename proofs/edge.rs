//! Chapter `edge`: S4's equations, the detector and the machine M3.

use super::avoid::any_length;
#[cfg(not(kani))]
use super::kani;
use super::view::{BLIND_PIONEER, PIONEER, any_reading, any_view, one_sonar};
use nalgebra::Vector2;
use sidestep::edge::{
    self, Detection, Edge, EdgeConfig, Finding, PAPER, PlannedEdge, Situation, State,
};
use sidestep::failsafe::StopReason;
use sidestep::law::Law;
use sidestep::observation::SonarReading;
use sidestep_spec::edge as law;

/// The paper's numbers: checked as this is compiled.
const CONFIG: EdgeConfig = match EdgeConfig::new(PAPER) {
    Ok(config) => config,
    Err(_) => panic!("the paper's numbers are out of range"),
};

/// E1 to E4 for any range, and any bits as distance and cosine; W2's arithmetic.
//= edge.INV-1
//= edge.INV-2
//= edge.INV-3
//= edge.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn projections_are_bounded() {
    let range = any_length();
    let nearness = edge::nearness(range, &CONFIG);
    assert!(law::nearness_in_range(
        nearness,
        range.get(),
        CONFIG.range_max
    ));
    let distance: f32 = kani::any();
    let closeness = edge::closeness(distance, &CONFIG);
    assert!(law::closeness_in_range(
        closeness,
        distance,
        CONFIG.distance_max
    ));
    if let Some(closeness) = closeness {
        let projection = edge::projection(nearness, closeness, kani::any());
        assert!(law::projection_in_range(projection, closeness));
        assert!(law::far_is_harmless(
            projection,
            range.get(),
            CONFIG.range_max,
            CONFIG.threshold
        ));
        kani::cover!(projection > CONFIG.threshold, "above the threshold");
        kani::cover!(projection == 0.0 && nearness > 9.0, "near, and behind");
    }
    kani::cover!(closeness.is_none() && distance.is_nan(), "no distance");
}

/// The detector on two sonars with any readings, any bits as cosines, at any distance.
//= edge.INV-6
//= edge.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn blind_is_never_clear() {
    let sonar = [any_reading(), any_reading()];
    let (cosines, distance): ([f32; 2], f32) = (kani::any(), kani::any());
    let detection = edge::detect(&sonar, &cosines, distance, &CONFIG);
    let heard = |reading| !matches!(reading, SonarReading::Stale | SonarReading::Invalid);
    assert!(law::blind_is_not_clear(
        matches!(detection, Detection::Clear { .. }),
        distance,
        CONFIG.distance_max,
        heard(sonar[0]) && heard(sonar[1])
    ));
    match detection {
        Detection::Obstacle {
            sonar: at,
            greatest,
        } => {
            assert!(at < 2 && greatest > CONFIG.threshold && greatest <= 10.0);
            kani::cover!(at == 1, "the second sonar is decisive");
            kani::cover!(!heard(sonar[0]), "although the first is not heard");
        }
        Detection::Clear { greatest } => assert!(greatest <= CONFIG.threshold),
        Detection::Blind(_) => kani::cover!(distance == 0.0, "blind on the edge"),
    }
}

/// Steering is bounded, whatever comes in.
//= edge.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn steering_is_bounded() {
    let (error, speed, error_max): (f32, f32, f32) = (kani::any(), kani::any(), kani::any());
    kani::assume((0.1..=1.5).contains(&error_max));
    let advice = edge::steer(error, speed, error_max, &PIONEER);
    assert!(law::advice_in_range(
        advice.speed,
        advice.turn_rate,
        PIONEER.speed_max,
        PIONEER.turn_rate_max
    ));
    // A robot that looks elsewhere turns on the spot.
    assert!(error.abs() < error_max || advice.speed == 0.0);
    kani::cover!(advice.speed > 0.1, "it drives");
    kani::cover!(
        advice.turn_rate < 0.0 && advice.speed == 0.0,
        "it turns on the spot"
    );
}

/// Any state.
fn any_state() -> State {
    State::EACH[usize::from(kani::any::<u8>() % 9)]
}

/// Any situation.
fn any_situation() -> Situation {
    Situation {
        obstacle: kani::any(),
        standing: kani::any(),
        finding: match kani::any::<u8>() % 4 {
            0 => Some(Finding::Passable),
            1 => Some(Finding::Closed),
            2 => Some(Finding::Gone),
            _ => None,
        },
        past: kani::any(),
        following: kani::any(),
        on_edge: kani::any(),
        at_end: kani::any(),
    }
}

/// M3 for every state and every situation: what is on the way stops, nobody goes on without a look,
/// and the look decides.
//= edge.INV-10
//= edge.INV-11
//= edge.INV-12
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn machine_stops_and_looks() {
    let (state, situation) = (any_state(), any_situation());
    let next = edge::next_state(state, &situation);
    assert!(law::obstacle_stops(
        !state.at_rest(),
        situation.obstacle,
        next == State::Stopped
    ));
    assert!(law::looks_before_going(
        matches!(state, State::Stopped | State::Measure),
        next.at_rest()
    ));
    if state == State::FreeWay {
        assert!(law::finding_decides(
            situation.finding == Some(Finding::Passable),
            next == State::SubRoute
        ));
    } else {
        assert!(state == State::SubRoute || next != State::SubRoute);
    }
    // Only another route leads out of these.
    assert!(!matches!(state, State::Blocked | State::Done) || next == state);
    kani::cover!(next == State::Blocked && state != next, "blocked");
    kani::cover!(next == State::SubRoute && state != next, "round it");
    kani::cover!(next == State::Done && state != next, "done");
}

/// The law under any view: two ticks from the start, with one sonar and one edge.
//= edge.INV-8
//= edge.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::stub(crate::math::atan2, crate::proofs::math::any_atan2))]
pub fn any_view_is_driven_within_limits() {
    let (start, end) = (Vector2::new(0.0, 0.0), Vector2::new(4.0, 0.0));
    let route = PlannedEdge::new(start, end);
    kani::assume(route.is_ok());
    let Ok(route) = route else { unreachable!() };
    let ring = one_sonar(&BLIND_PIONEER);
    let law = Edge::<_, 1>::new(BLIND_PIONEER, CONFIG, ring, [route]);
    let Ok(mut driver) = law else { unreachable!() };
    for _ in 0..2 {
        let mut view = any_view();
        view.guard = if kani::any() {
            Some(StopReason::Operator)
        } else {
            None
        };
        let advice = driver.advise(&view);
        assert!(law::advice_in_range(
            advice.speed,
            advice.turn_rate,
            BLIND_PIONEER.speed_max,
            BLIND_PIONEER.turn_rate_max
        ));
        assert!(law::rests(
            driver.state().at_rest(),
            advice.speed,
            advice.turn_rate
        ));
        kani::cover!(driver.state() == State::Stopped, "stopped");
        kani::cover!(advice.speed > 0.0, "it drives");
    }
}
