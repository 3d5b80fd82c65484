//! The way out of where a law is stuck: advice like any other, and none where it is not wanted.

mod common;

use common::{in_order, pioneer_with, settings, usual_or_any_config, view};
use proptest::prelude::*;
use sidestep::config::Config;
use sidestep::controller::Controller;
use sidestep::escape::Escape;
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::quantity::Instant;
use sidestep::ring::Ring;
use sidestep::view::View;
use std::f32::consts::TAU;

/// A law that always advises the same.
#[derive(Clone, Copy, Debug)]
struct Stubborn(Advice);

impl<const N: usize> Law<N> for Stubborn {
    fn advise(&mut self, _view: &View<N>) -> Advice {
        self.0
    }

    fn mode(&self) -> &'static str {
        "stubborn"
    }
}

/// What no way out would ask for.
const STUBBORN: Advice = Advice {
    speed: 0.123,
    turn_rate: -0.321,
};

fn guard() -> impl Strategy<Value = Option<StopReason>> {
    let any = proptest::sample::select(StopReason::EACH.to_vec());
    prop_oneof![3 => Just(None), 2 => any.prop_map(Some)]
}

proptest! {
    #![proptest_config(common::cases(500))]

    /// Wherever the shield lets the robot not even turn, or the goal is reached, the law is left
    /// alone, and whatever the way out asks for is a number within the limits.
    #[test]
    fn the_law_is_left_alone_where_nothing_moves(
        config in usual_or_any_config(),
        ticks in proptest::collection::vec((view::<16>(), guard(), 0..3_000_u64, any::<bool>()), 1..40),
    ) {
        let (config, ring) = settings::fitted::<16>(&config);
        let mut escape = Escape::new(Stubborn(STUBBORN), config, ring);
        let mut now = 10_000;
        let mut place = None;
        for (mut view, guard, later, stays) in ticks {
            now += later;
            view.now = Instant(now);
            view.guard = guard;
            // It mostly stays where it is.
            let at = *place.get_or_insert(view.pose.position);
            if stays {
                view.pose.position = at;
            }
            let advice = escape.advise(&view);
            let mode = Law::<16>::mode(&escape);
            let arrived = view.goal.distance <= config.goal_tolerance;
            let held = view.guard.is_some_and(|reason| !reason.may_turn());
            if arrived || held || mode != "escape" {
                prop_assert_eq!(advice, STUBBORN);
                prop_assert_eq!(mode, "stubborn");
            } else {
                let speed_max = config.speed_max.max(config.reverse_speed_max);
                prop_assert!(advice.speed.abs() <= speed_max, "{advice:?}");
                prop_assert!(advice.turn_rate.abs() <= config.turn_rate_max, "{advice:?}");
            }
        }
    }
}

/// A robot with a law that is stuck, and posts round it: it does what it is told at once.
struct Stuck {
    config: Config,
    ring: Ring<16>,
    controller: Controller<Escape<Stubborn, 16>, 16>,
    posts: Vec<[f32; 2]>,
    now: u64,
    at: [f32; 2],
    heading: f32,
    twist: [f32; 2],
    modes: Vec<&'static str>,
}

impl Stuck {
    fn new(advice: Advice, posts: Vec<[f32; 2]>) -> Self {
        let (config, ring) = pioneer_with::<16>();
        let law = Escape::new(Stubborn(advice), config, ring);
        let goal = [6.0, 0.0].into();
        Self {
            config,
            ring,
            controller: Controller::new(config, ring, law, goal).expect("a goal in range"),
            posts,
            now: 10_000,
            at: [0.0; 2],
            heading: 0.0,
            twist: [0.0; 2],
            modes: Vec::new(),
        }
    }

    /// What the sonars hear.
    fn ranges(&self) -> [f32; 16] {
        let (sin, cos) = self.heading.sin_cos();
        self.ring.sonars().map(|sonar| {
            let face = [
                self.at[0] + cos * sonar.position.x - sin * sonar.position.y,
                self.at[1] + sin * sonar.position.x + cos * sonar.position.y,
            ];
            let axis = self.heading + sonar.heading.get();
            self.posts
                .iter()
                .map(|post| [post[0] - face[0], post[1] - face[1]])
                .filter(|to| {
                    let off = f64::from(to[1].atan2(to[0]) - axis);
                    sidestep_spec::avoid::wrap(off).abs() <= f64::from(self.config.sonar_half_angle)
                })
                .map(|to| to[0].hypot(to[1]))
                .fold(5.0, f32::min)
        })
    }

    fn tick(&mut self) {
        let mut observation = in_order(self.now, self.ranges());
        let odometry = observation.odometry.as_mut().expect("odometry");
        (odometry.x, odometry.y, odometry.heading) = (self.at[0], self.at[1], self.heading);
        (odometry.speed, odometry.turn_rate) = (self.twist[0], self.twist[1]);
        let decision = self.controller.tick(&observation);
        self.modes.push(decision.mode);
        self.twist = [
            decision.command.speed() as f32 / 1000.0,
            decision.command.turn_rate() as f32 / 1000.0,
        ];
        self.now += 100;
        self.heading =
            (self.heading + self.twist[1] / 10.0 + 3.0 * TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        self.at[0] += self.twist[0] / 10.0 * self.heading.cos();
        self.at[1] += self.twist[0] / 10.0 * self.heading.sin();
    }

    fn gone(&self) -> f32 {
        self.at[0].hypot(self.at[1])
    }

    /// How far it got at the farthest in some seconds.
    fn farthest(&mut self, seconds: usize) -> f32 {
        let mut farthest: f32 = 0.0;
        for _ in 0..10 * seconds {
            self.tick();
            farthest = farthest.max(self.gone());
        }
        farthest
    }
}

/// A law that does nothing gets away all the same, in attempts that end.
#[test]
fn a_law_that_rests_gets_away() {
    let mut stuck = Stuck::new(Advice::REST, Vec::new());
    for _ in 0..75 {
        stuck.tick();
    }
    assert!(
        stuck.modes.iter().all(|mode| *mode == "stubborn"),
        "patience"
    );
    let farthest = stuck.farthest(30);
    assert!(farthest > 0.5, "got {farthest} m");
    assert!(stuck.modes.contains(&"escape"));
    // An attempt takes 8 s at most, and then the law has its say.
    let longest = stuck
        .modes
        .split(|mode| *mode == "stubborn")
        .map(<[_]>::len)
        .max();
    assert!(longest <= Some(81), "{longest:?} ticks");
}

/// A law that wants to go on into what stops it: there is room elsewhere.
#[test]
fn a_law_that_insists_gets_away() {
    let ahead = Advice {
        speed: 0.3,
        turn_rate: 0.0,
    };
    // A wall across the way, 60 cm ahead.
    let wall: Vec<_> = (-10..=10).map(|i| [0.6, i as f32 * 0.1]).collect();
    let mut stuck = Stuck::new(ahead, wall);
    // Beside a wall it turns slowly: what a sonar has just lost is held, and may be anyone.
    let farthest = stuck.farthest(60);
    assert!(stuck.modes.contains(&"escape"));
    assert!(farthest > 0.4, "got {farthest} m");
}

/// A law that moves is not interfered with.
#[test]
fn a_law_that_moves_is_left_alone() {
    let ahead = Advice {
        speed: 0.2,
        turn_rate: 0.0,
    };
    let mut stuck = Stuck::new(ahead, Vec::new());
    for _ in 0..200 {
        stuck.tick();
    }
    assert!(stuck.modes.iter().all(|mode| *mode == "stubborn"));
    assert!(stuck.at[0] > 3.0);
}

/// A robot that is held by what no turning helps against is not said to escape, however long.
#[test]
fn who_is_held_does_not_escape() {
    let mut stuck = Stuck::new(Advice::REST, Vec::new());
    for _ in 0..300 {
        stuck
            .controller
            .halt(StopReason::LinkLost, Instant(stuck.now));
        stuck.tick();
    }
    assert!(stuck.modes.iter().all(|mode| *mode == "stubborn"));
    assert_eq!(stuck.at, [0.0; 2]);
}
