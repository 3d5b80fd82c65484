//! Chapter `edge`: S4's equations, the detector and the machine M3.

use super::avoid::any_length;
#[cfg(not(kani))]
use super::kani;
use super::view::{PIONEER, any_reading};
use sidestep::edge::{self, Detection, EdgeConfig, Finding, PAPER, Situation, State};
use sidestep::law::Advice;
use sidestep::observation::SonarReading;
use sidestep_spec::edge as law;

/// The paper's numbers: checked as this is compiled.
const CONFIG: EdgeConfig = match EdgeConfig::new(PAPER) {
    Ok(config) => config,
    Err(_) => panic!("the paper's numbers are out of range"),
};

/// E1 for any range.
//= edge.INV-1
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn nearness_is_bounded() {
    let range = any_length();
    let nearness = edge::nearness(range, &CONFIG);
    assert!(law::nearness_in_range(
        nearness,
        range.get(),
        CONFIG.range_max
    ));
    kani::cover!(nearness > 9.0, "near");
    kani::cover!(nearness == 0.0, "far");
}

/// E2 for any bits as distance.
//= edge.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn closeness_is_bounded() {
    let distance: f32 = kani::any();
    let closeness = edge::closeness(distance, &CONFIG);
    assert!(law::closeness_in_range(
        closeness,
        distance,
        CONFIG.distance_max
    ));
    kani::cover!(closeness.is_some() && distance < 0.0, "on the right");
    kani::cover!(closeness.is_none() && distance.is_nan(), "no distance");
}

/// Any value of E2, as far as `closeness_is_bounded` shows it.
fn any_closeness() -> f32 {
    let closeness = kani::any();
    kani::assume(law::closeness_in_range(
        Some(closeness),
        0.0,
        CONFIG.distance_max,
    ));
    closeness
}

/// E4 for any values of E1 and E2 and any bits as cosine.
//= edge.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn projection_is_bounded() {
    let nearness: f32 = kani::any();
    kani::assume(law::nearness_in_range(nearness, 0.0, CONFIG.range_max));
    let closeness = any_closeness();
    let projection = edge::projection(nearness, closeness, kani::any());
    assert!(law::projection_in_range(projection, closeness));
    kani::cover!(projection > CONFIG.threshold, "above the threshold");
    kani::cover!(projection == 0.0 && nearness > 9.0, "near, and behind");
}

/// W2's arithmetic: any echo from far enough, any value of E2, any bits as cosine.
//= edge.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn far_is_harmless() {
    let range = any_length();
    let nearness = edge::nearness(range, &CONFIG);
    let projection = edge::projection(nearness, any_closeness(), kani::any());
    assert!(law::far_is_harmless(
        projection,
        range.get(),
        CONFIG.range_max,
        CONFIG.threshold
    ));
    kani::cover!(projection > CONFIG.threshold, "nearer than that");
    kani::cover!(
        projection > 0.0 && range.get() > 0.5,
        "farther, and it counts"
    );
}

/// The detector on two sonars with any readings, any bits as cosines, at any distance.
//= edge.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(4))]
pub fn blind_is_never_clear() {
    let sonar = [any_reading(), any_reading()];
    let (cosines, distance): ([f32; 2], f32) = (kani::any(), kani::any());
    let detection = edge::detect(&sonar, &cosines, distance, &CONFIG);
    let heard = |reading| !matches!(reading, SonarReading::Stale | SonarReading::Invalid);
    let clear = matches!(detection, Detection::Clear { .. });
    assert!(law::blind_is_not_clear(
        clear,
        distance,
        CONFIG.distance_max,
        heard(sonar[0]) && heard(sonar[1])
    ));
    let obstacle = matches!(detection, Detection::Obstacle { .. });
    kani::cover!(clear, "clear");
    kani::cover!(obstacle && !heard(sonar[0]), "one is heard, and near");
    kani::cover!(
        matches!(detection, Detection::Blind(_)) && distance == 0.0,
        "blind on the edge"
    );
}

/// What is reported of any three projections.
//= edge.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(5))]
pub fn greatest_projection_decides() {
    let projections: [f32; 3] = kani::any();
    for projection in projections {
        kani::assume((0.0..=10.0).contains(&projection));
    }
    let silent = if kani::any() { Some(0) } else { None };
    let detection = edge::judge(&projections, silent, CONFIG.threshold);
    let (reported, at) = match detection {
        Detection::Obstacle { sonar, greatest } => (Some(greatest), sonar),
        _ => (None, 0),
    };
    assert!(at < 3);
    assert!(law::obstacle_is_greatest(
        reported,
        &projections,
        CONFIG.threshold
    ));
    kani::cover!(reported.is_some() && at == 2, "the last sonar is decisive");
    kani::cover!(
        reported.is_none() && projections[1] == CONFIG.threshold,
        "at the threshold"
    );
}

/// Steering is bounded for any bits as error and speed, on an edge and on a leg.
//= edge.INV-8
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn steering_is_bounded() {
    let (error, speed): (f32, f32) = (kani::any(), kani::any());
    let error_max = if kani::any() {
        CONFIG.heading_error_max
    } else {
        edge::TURNED
    };
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
/// the look decides, and who rests is not let move, whatever is wished for.
//= edge.INV-9
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
    let (sees, wish) = (
        kani::any(),
        Advice {
            speed: kani::any(),
            turn_rate: kani::any(),
        },
    );
    let advice = edge::permitted(next, sees, wish);
    assert!(law::rests(
        next.at_rest() || !sees,
        advice.speed,
        advice.turn_rate
    ));
    // Only another route leads out of these.
    assert!(!matches!(state, State::Blocked | State::Done) || next == state);
    kani::cover!(next == State::Blocked && state != next, "blocked");
    kani::cover!(next == State::SubRoute && state != next, "round it");
    kani::cover!(next == State::Done && state != next, "done");
    kani::cover!(advice.speed > 0.1, "it moves");
}
