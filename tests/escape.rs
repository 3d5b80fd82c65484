//! The way out of where a law is stuck: advice like any other, and none where it is not wanted.

mod common;

use common::{in_order, pioneer_with, settings, usual_or_any_config, view};
use proptest::prelude::*;
use sidestep::config::Config;
use sidestep::controller::Controller;
use sidestep::escape::Escape;
use sidestep::failsafe::StopReason;
use sidestep::law::{Advice, Law};
use sidestep::quantity::{Angle, Instant};
use sidestep::ring::Ring;
use sidestep::view::{Memory, View};
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

// ------------------------------------------------------------- an attempt, step by step

/// An escape round a stubborn law, and a robot at rest whose sonars hold what a test says.
#[derive(Clone)]
struct Attempting {
    config: Config,
    ring: Ring<16>,
    escape: Escape<Stubborn, 16>,
    view: View<16>,
}

/// How long the robot has to have rested.
const PATIENCE: u64 = 14_000;

impl Attempting {
    /// With so much room in every direction, m, where less than 2 m count.
    fn with_room(room: f32) -> Self {
        let (config, ring) = pioneer_with::<16>();
        let free = in_order(10_000, [5.0; 16]);
        let view = Memory::default().update(&free, [9.0, 0.0].into(), &ring, &config);
        let mut attempting = Self {
            config,
            ring,
            escape: Escape::new(Stubborn(STUBBORN), config, ring),
            view: view.expect("odometry"),
        };
        attempting.view.pose.position = [3.0, -2.0].into();
        for i in 0..16 {
            attempting.set_room(i, room);
        }
        attempting
    }

    fn set_room(&mut self, sonar: usize, room: f32) {
        let hazard = &mut self.view.hazard[sonar];
        hazard.range = (1000.0 * room) as i32 + 500;
        hazard.clearance = (1000.0 * room) as i32;
    }

    /// Sonars that look within an angle of a direction.
    fn near(&self, heading: f32, within: f32) -> Vec<usize> {
        let off = |i: &usize| {
            let off = f64::from(self.ring.sonars()[*i].heading.get() - heading);
            sidestep_spec::avoid::wrap(off).abs() as f32
        };
        (0..16).filter(|i| off(i) <= within).collect()
    }

    fn heading(&self, sonar: usize) -> f32 {
        self.ring.sonars()[sonar].heading.get()
    }

    /// What is advised after some milliseconds more, and whether that is the way out's.
    fn after(&mut self, ms: u64) -> Option<Advice> {
        self.view.now.0 += ms;
        let advice = self.escape.advise(&self.view);
        (Law::<16>::mode(&self.escape) == "escape").then_some(advice)
    }

    fn turn_to(&mut self, heading: f32) {
        self.view.pose.heading = Angle::radians(heading).expect("an angle");
    }

    /// The direction of the attempt that is under way: the sonar's, of the robot as it began it at heading
    /// 0, in which it drives at once.
    fn direction(&self) -> Option<usize> {
        (0..16).find(|sonar| {
            let mut turned = self.clone();
            turned.turn_to(self.heading(*sonar));
            turned
                .after(1)
                .is_some_and(|advice| advice.speed > 0.0 && advice.turn_rate == 0.0)
        })
    }

    /// The direction of the first attempt.
    fn first_direction(mut self) -> usize {
        assert_eq!(self.after(0), None);
        assert!(self.after(PATIENCE).is_some());
        self.direction().expect("a sonar's direction")
    }
}

/// A robot that has rested for long enough tries to get away, not before, and not if it moved meanwhile.
#[test]
fn patience_is_as_long_as_it_is() {
    let mut resting = Attempting::with_room(2.0);
    assert_eq!(resting.after(0), None);
    assert_eq!(resting.after(PATIENCE - 1), None);
    assert!(resting.after(1).is_some());
    for (moved, escapes) in [(0.09, true), (0.11, false)] {
        let mut moving = Attempting::with_room(2.0);
        moving.after(0);
        moving.view.pose.position.x += moved;
        assert_eq!(moving.after(PATIENCE).is_some(), escapes, "{moved} m");
    }
}

/// It turns to where there is most room in all of a cone of 30° to either side, nothing within 60° being
/// so near that driving would begin with a stop.
#[test]
fn it_turns_to_where_there_is_most_room() {
    for sonar in [1, 6, 9, 12] {
        let mut room = Attempting::with_room(0.5);
        for i in room.near(room.heading(sonar), 0.55) {
            room.set_room(i, 1.5);
        }
        assert_eq!(room.clone().first_direction(), sonar);
        // One beside it with less, and the cone is not free.
        let beside = room.near(room.heading(sonar), 0.55);
        let beside = beside.into_iter().find(|i| *i != sonar).expect("another");
        let mut blocked = room.clone();
        blocked.set_room(beside, 0.4);
        assert_ne!(blocked.first_direction(), sonar);
        // 10 cm beyond a stop are not enough 60° aside, 11 are.
        let stop = room.config.min_distance + room.config.resume_clearance;
        let aside = room.near(room.heading(sonar), 1.04);
        let aside = aside
            .into_iter()
            .find(|i| !room.near(room.heading(sonar), 0.55).contains(i));
        let aside = aside.expect("a sonar 40° or 50° aside");
        for (beyond, same) in [(0.099, false), (0.105, true)] {
            let mut near = room.clone();
            near.view.hazard[aside].range = (1000.0 * (stop + beyond)) as i32;
            assert_eq!(near.first_direction() == sonar, same, "{beyond} m");
        }
    }
}

/// Where there is room everywhere, it turns towards the goal; when that was in vain, elsewhere, and back
/// only when all else was tried as well.
#[test]
fn it_does_not_try_the_same_again() {
    for goal in [2, 5, 10] {
        let mut attempting = Attempting::with_room(2.0);
        attempting.view.goal.heading = attempting.ring.sonars()[goal].heading;
        assert_eq!(attempting.clone().first_direction(), goal);
        attempting.after(0);
        let mut directions = Vec::new();
        for _ in 0..3 {
            attempting.after(PATIENCE);
            directions.push(attempting.heading(attempting.direction().expect("a direction")));
            // In vain: it is over after six seconds.
            attempting.after(6_000);
        }
        let off = |one: f32, other: f32| sidestep_spec::avoid::wrap(f64::from(one - other)).abs();
        for (i, one) in directions.iter().enumerate() {
            for other in &directions[i + 1..] {
                assert!(off(*one, *other) > 0.78, "{directions:?}");
            }
        }
        // No farther from the goal's direction than it must be.
        assert!(off(directions[0], directions[1]) < 1.5, "{directions:?}");
    }
}

/// It turns towards its direction, as fast as it may or as the error asks for, and then drives.
#[test]
fn it_turns_and_then_drives() {
    for sonar in [2, 5] {
        let mut attempting = Attempting::with_room(2.0);
        attempting.view.goal.heading = attempting.ring.sonars()[sonar].heading;
        attempting.after(0);
        let config = attempting.config;
        let direction = attempting.heading(sonar);
        let turn = |error: f32| {
            let mut turned = attempting.clone();
            turned.after(PATIENCE);
            turned.turn_to(direction - error);
            turned.after(100).expect("under way")
        };
        for error in [0.11, -0.11, 0.5, -0.5] {
            let advice = turn(error);
            assert_eq!(advice.speed, 0.0);
            assert!(
                (advice.turn_rate - config.heading_gain * error).abs() < 1e-5,
                "{error}"
            );
        }
        assert_eq!(turn(1.2).turn_rate, config.turn_rate_max);
        assert_eq!(turn(-1.2).turn_rate, -config.turn_rate_max);
        for error in [0.09, -0.09] {
            let advice = turn(error);
            assert_eq!(advice.speed, config.cruise_speed / 2.0);
            assert!((advice.turn_rate - config.heading_gain * error / 2.0).abs() < 1e-5);
        }
    }
}

/// An attempt is over after six seconds, after 60 cm, or when the way to the goal has opened while it turns.
#[test]
fn attempts_end() {
    let begun = || {
        let mut attempting = Attempting::with_room(0.5);
        for i in attempting.near(0.0, 3.2) {
            if attempting.heading(i) > 1.0 {
                attempting.set_room(i, 1.5);
            }
        }
        attempting.after(0);
        attempting.after(PATIENCE).expect("under way");
        attempting
    };
    assert!(begun().after(5_999).is_some());
    assert!(begun().after(6_000).is_none());
    for (way, over) in [(0.59, false), (0.61, true)] {
        let mut attempting = begun();
        attempting.view.pose.position.y -= way;
        assert_eq!(attempting.after(100).is_none(), over, "{way} m");
    }
    // The goal is straight ahead, and there were 50 cm.
    for (room, over) in [(0.99, false), (1.01, true)] {
        let mut attempting = begun();
        for i in attempting.near(0.0, 0.55) {
            attempting.set_room(i, room);
        }
        assert_eq!(attempting.after(100).is_none(), over, "{room} m");
    }
    // Where there was more, it has to be more by half a metre.
    for (room, over) in [(1.39, false), (1.41, true)] {
        let mut attempting = Attempting::with_room(0.9);
        for i in attempting.near(1.57, 0.6) {
            attempting.set_room(i, 1.9);
        }
        attempting.after(0);
        attempting.after(PATIENCE).expect("under way");
        for i in attempting.near(0.0, 0.55) {
            attempting.set_room(i, room);
        }
        assert_eq!(attempting.after(100).is_none(), over, "{room} m");
    }
}

/// Where there is no room to turn, it backs off from what is nearest ahead, and drives on from what is behind.
#[test]
fn where_it_cannot_turn_it_makes_room() {
    for (heading, ahead) in [(0.17, true), (-0.87, true), (2.6, false), (-2.6, false)] {
        let mut attempting = Attempting::with_room(1.5);
        // Something lies on the other side as well, less near.
        let other = sidestep_spec::avoid::wrap(f64::from(heading) + std::f64::consts::PI) as f32;
        for i in attempting.near(other, 0.2) {
            attempting.view.hazard[i].clearance = 20;
        }
        for i in attempting.near(heading, 0.2) {
            attempting.view.hazard[i].clearance = 10;
        }
        attempting.after(0);
        let advice = attempting.after(PATIENCE).expect("under way");
        let config = attempting.config;
        let speed = if ahead {
            -config.reverse_speed_max
        } else {
            config.cruise_speed / 4.0
        };
        assert_eq!((advice.speed, advice.turn_rate), (speed, 0.0), "{heading}");
    }
    let mut free = Attempting::with_room(1.5);
    free.after(0);
    free.turn_to(1.0);
    assert!(
        free.after(PATIENCE)
            .is_some_and(|advice| advice.speed == 0.0)
    );
}
